/* SPDX-License-Identifier: GPL-3.0-or-later */
/* chains: a random model of 18 to 40 states, and what steps of it come to with other values of its tunable params.
 *
 *     chains SEED SPEC TRUTH
 *
 * Chains of masses, some with a coordinate of first order at their end, their coordinates in any order; params stand
 * in the masses, springs, dampers, loads, inputs of some chains and not of others. The truth knows the equations alone:
 * the Taylor series of their solution in long double, over 32 parts of a step. TRUTH has the new values and cases:
 * time, states, samples before and of the step, states and outputs after it; all that plgen is given has few bits.
 */
#include "drawn.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { COORDS = 24, MOST = 40, PARAMS = 5, SIZE = 2 * COORDS + 5, CASES = 8, TEXT = 4000 };
static const long double h = 1.0L / 64;

struct factor { char text[40]; long double value; };

static long double new_value[PARAMS], nominal[PARAMS];
static int n, states, order[COORDS], place[COORDS], summed;
static long double M[COORDS], C[COORDS][COORDS], K[COORDS][COORDS], wave[COORDS], held[COORDS], ramp[COORDS],
	slope[COORDS];
static int first_order[COORDS];
static char left[COORDS][TEXT], right[COORDS][TEXT];

static void append(char *text, const char *form, ...)
{
	va_list args;
	const size_t length = strlen(text);
	va_start(args, form);
	vsnprintf(text + length, TEXT - length, form, args);
	va_end(args);
}

/* An eighth, from `least` eighths on */
static long double eighths(int least, int more)
{
	return (long double)(least + (int)below((unsigned)more)) / 8;
}

/* A number, or where params touch the chain now and then a param times one */
static struct factor draw(int touched, int least, int more)
{
	struct factor f = { "", eighths(least, more) };
	if (touched && below(2)) {
		const int p = (int)below(PARAMS);
		snprintf(f.text, sizeof f.text, "%.10Lg*p%d", f.value, p);
		f.value *= new_value[p];
	} else {
		snprintf(f.text, sizeof f.text, "%.10Lg", f.value);
	}
	return f;
}

/* A spring and a damper between i and j, or the ground: j < 0 */
static void link(int i, int j, int touched)
{
	const struct factor k = draw(touched, 80, 400), c = draw(touched, 1, 6);
	const int end[2] = { i, j };
	for (int a = 0; a < 2; a++) {
		const int at = end[a], other = end[1 - a];
		if (at < 0)
			continue;
		K[at][at] += k.value;
		C[at][at] += c.value;
		if (other >= 0) {
			K[at][other] -= k.value;
			C[at][other] -= c.value;
			append(left[at], " + %s*(x%d - x%d) + %s*(x%d' - x%d')", k.text, at, other, c.text, at, other);
		} else {
			append(left[at], " + %s*x%d + %s*x%d'", k.text, at, c.text, at);
		}
	}
}

static void drive(int i, int touched)
{
	struct factor f;
	if (below(2)) {
		f = draw(touched, 4, 40);
		wave[i] = f.value;
		append(right[i], " + %s*cos(3*t)", f.text);
	}
	if (below(2)) {
		f = draw(touched, 4, 40);
		held[i] = f.value;
		append(right[i], " + %s*u", f.text);
	}
	if (below(2)) {
		f = draw(touched, 4, 40);
		ramp[i] = f.value;
		append(right[i], " + %s*r", f.text);
		f = draw(touched, 4, 10);
		slope[i] = f.value;
		append(right[i], " + %s*r'", f.text);
	}
}

static void add_mass(int i, int touched)
{
	struct factor m = draw(touched, 4, 12);
	if (touched && summed && below(2)) {
		snprintf(m.text, sizeof m.text, "(p0 + p1)");
		m.value = new_value[0] + new_value[1];
	}
	M[i] = m.value;
	append(left[i], "%s*x%d''", m.text, i);
	drive(i, touched);
	n++;
	states += 2;
}

/* z' + a z = b x, z acts back on x */
static void add_lag(int i, int of, int touched)
{
	const struct factor a = draw(touched, 4, 16), b = draw(touched, 4, 40), back = draw(touched, 4, 40);
	M[i] = 1;
	first_order[i] = 1;
	K[i][i] = a.value;
	K[i][of] = -b.value;
	K[of][i] -= back.value;
	append(left[i], "x%d' + %s*x%d - %s*x%d", i, a.text, i, b.text, of);
	append(left[of], " - %s*x%d", back.text, i);
	n++;
	states++;
}

static void add_chain(int masses, int touched)
{
	const int from = n;
	for (int k = 0; k < masses; k++) {
		add_mass(n, touched);
		link(n - 1, k ? n - 2 : -1, touched);
	}
	if (below(4) == 0)
		add_lag(n, from, touched);
}

static void build(void)
{
	for (int p = 0; p < PARAMS; p++) {
		nominal[p] = eighths(6, 8);
		new_value[p] = eighths(5, 12);
	}
	summed = below(3) == 0;
	add_chain(1 + (int)below(3), 1);
	while (states < 18 || (states < 28 && below(2)))
		add_chain(1 + (int)below(states < 9 ? 8 : 5), (int)below(2));
	for (int i = 0; i < n; i++) {
		const int j = (int)below((unsigned)i + 1);
		order[i] = order[j];
		order[j] = i;
	}
	for (int i = 0, at = n; i < n; i++)
		place[order[i]] = first_order[order[i]] ? -1 : at++;
}

static void write_spec(FILE *to)
{
	fprintf(to, "model chained\n# %d coordinates, %d states%s\nparam ", n, states,
			summed ? ", masses that are sums" : "");
	for (int p = 0; p < PARAMS; p++)
		fprintf(to, "%sp%d = %.10Lg", p ? ", " : "", p, nominal[p]);
	fputs("\ntunable p0, p1, p2, p3, p4\ncoord ", to);
	for (int i = 0; i < n; i++)
		fprintf(to, "%sx%d", i ? ", " : "", order[i]);
	fputs("\ninput u\ninput r hold first\noutput s = p1*x0 + x1\noutput a = x0''\n", to);
	for (int i = 0; i < n; i++)
		fprintf(to, "%s =%s\n", left[order[i]], *right[order[i]] ? right[order[i]] : " 0");
	fputs("step 1/64\n", to);
}

/* ---- the truth: x = [coordinates, velocities, cos, sin, u, r, r'] ---- */

enum { WAVE = 2 * COORDS, U = WAVE + 2, R, SLOPE };

/* Accelerations, of first order rates */
static void rates(const long double *x, long double *rate)
{
	for (int i = 0; i < n; i++) {
		long double f = wave[i] * x[WAVE] + held[i] * x[U] + ramp[i] * x[R] + slope[i] * x[SLOPE];
		for (int j = 0; j < n; j++)
			f -= K[i][j] * x[j] + C[i][j] * x[COORDS + j];
		rate[i] = f / M[i];
	}
}

static void derive(const long double *x, long double *d)
{
	long double rate[COORDS];
	rates(x, rate);
	memset(d, 0, SIZE * sizeof *d);
	for (int i = 0; i < n; i++) {
		d[i] = first_order[i] ? rate[i] : x[COORDS + i];
		d[COORDS + i] = first_order[i] ? 0 : rate[i];
	}
	d[WAVE] = -3 * x[WAVE + 1];
	d[WAVE + 1] = 3 * x[WAVE];
	d[R] = x[SLOPE];
}

static void advance(long double *x)
{
	enum { PARTS = 32, DEGREE = 24 };
	long double term[SIZE], next[SIZE];
	for (int part = 0; part < PARTS; part++) {
		memcpy(term, x, sizeof term);
		for (int k = 1; k <= DEGREE; k++) {
			derive(term, next);
			for (int i = 0; i < SIZE; i++) {
				term[i] = next[i] * (h / PARTS) / k;
				x[i] += term[i];
			}
		}
	}
}

static void print_states(FILE *to, const long double *x)
{
	for (int i = 0; i < n; i++)
		fprintf(to, " %.21Lg", x[order[i]]);
	for (int i = 0; i < n; i++)
		if (place[order[i]] >= 0)
			fprintf(to, " %.21Lg", x[COORDS + order[i]]);
	fputc('\n', to);
}

static void write_case(FILE *to)
{
	long double x[SIZE] = { 0 }, rate[COORDS];
	const long double t = eighths(0, 400), before = eighths(-8, 17), after = eighths(-8, 17);
	for (int i = 0; i < n; i++) {
		x[i] = eighths(-8, 17);
		x[COORDS + i] = first_order[i] ? 0 : eighths(-40, 81);
	}
	x[WAVE] = cosl(3 * t);
	x[WAVE + 1] = sinl(3 * t);
	x[U] = eighths(-8, 17);
	x[R] = before;
	x[SLOPE] = (after - before) / h;
	fprintf(to, "%.21Lg %.21Lg %.21Lg %.21Lg\n", t, x[U], before, after);
	print_states(to, x);
	advance(x);
	print_states(to, x);
	rates(x, rate);
	fprintf(to, "%.21Lg %.21Lg\n", new_value[1] * x[0] + x[1], rate[0]);
}

int main(int argc, char **argv)
{
	if (argc != 4)
		return 1;
	random_state = strtoull(argv[1], NULL, 10) * 2654435761u;
	build();
	FILE *spec = fopen(argv[2], "w"), *truth = fopen(argv[3], "w");
	if (!spec || !truth)
		return 1;
	write_spec(spec);
	fprintf(truth, "%d %d %d\n", PARAMS, states, CASES);
	for (int p = 0; p < PARAMS; p++)
		fprintf(truth, "%.21Lg ", new_value[p]);
	fputc('\n', truth);
	for (int c = 0; c < CASES; c++)
		write_case(truth);
	return fclose(spec) != 0 || fclose(truth) != 0;
}
