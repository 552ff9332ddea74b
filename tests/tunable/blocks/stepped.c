/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stepped TRUTH: steps a random model that was retuned, and compares with what chains.c found. -DREAL_FLOAT for float.
 * Off by at most 8 units of rounding of the largest of states before and after the step; outputs by 64 of their
 * largest, since an acceleration is a difference of larger forces. */
#include "chained_pl.h"
#include "../../emitted/worse.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

#ifdef REAL_FLOAT
typedef float real;
static const double unit = FLT_EPSILON;
#else
typedef double real;
static const double unit = DBL_EPSILON;
#endif
enum { STATES = 64, OUTPUTS = 2 };

static void read_numbers(FILE *from, int count, double *value)
{
	for (int i = 0; i < count; i++)
		if (fscanf(from, "%lf", &value[i]) != 1)
			value[i] = NAN;
}

static double largest(int count, const double *value)
{
	double most = 0;
	for (int i = 0; i < count; i++)
		most = fmax(most, fabs(value[i]));
	return most;
}

static double apart(int count, const real *found, const double *expected, double size)
{
	double most = 0;
	for (int i = 0; i < count; i++)
		most = worse(most, fabs((double)found[i] - expected[i]) / (size * unit));
	return most;
}

int main(int argc, char **argv)
{
	FILE *truth = fopen(argc > 1 ? argv[1] : "", "r");
	int params = 0, states = 0, cases = 0;
	double value[CHAINED_PARAMS], start[STATES], after[STATES], out[OUTPUTS], given[4], off = 0, outs = 0;
	real param[CHAINED_PARAMS], y[CHAINED_STATES], o[OUTPUTS], u[2], before[2] = { 0 };
	static chained s;
	chained_coeffs fresh;
	if (!truth || fscanf(truth, "%d %d %d", &params, &states, &cases) != 3 || params != CHAINED_PARAMS ||
		states != CHAINED_STATES || states > STATES)
		return puts("no truth"), 1;
	read_numbers(truth, params, value);
	for (int p = 0; p < params; p++)
		param[p] = (real)value[p];
	chained_init(&s);
	if (chained_retune(&fresh, param, CHAINED_H) != 0)
		return puts("not retuned"), 1;
	chained_use(&s, &fresh);
	for (int c = 0; c < cases; c++) {
		read_numbers(truth, 4, given);
		read_numbers(truth, states, start);
		read_numbers(truth, states, after);
		read_numbers(truth, OUTPUTS, out);
		for (int i = 0; i < states; i++)
			y[i] = (real)start[i];
		u[0] = (real)given[1];
		before[1] = (real)given[2];
		u[1] = (real)given[3];
		chained_set(&s, (real)given[0], y);
		chained_hold(&s, before);
		chained_step(&s, u);
		chained_get(&s, y);
		chained_out(&s, o);
		off = worse(off, apart(states, y, after, fmax(largest(states, start), largest(states, after))));
		outs = worse(outs, apart(OUTPUTS, o, out, largest(OUTPUTS, out)));
	}
	printf("in units of rounding: states off by %.3g, outputs by %.3g; expected at most 8, 64\n", off, outs);
	return !(off <= 8 && outs <= 64);
}
