/* SPDX-License-Identifier: GPL-3.0-or-later */
/* beside: a model that was retuned beside one of the same equations with the values written into its spec.
 * -DTUNED=NAME_model -DPLAIN=NAME_model, -DREAL_FLOAT for models in float, and -DSTARTS=40 for fewer starts.
 *
 *     beside STATUS TOLERANCE H VALUE ...    retunes to these values of its params, in their order, and to H [s], 0:
 *                                            its own step
 *
 * From random states at random times, under random samples, both step and are compared after each of a few steps:
 * states, outputs, states between steps; to TOLERANCE units of rounding of the largest state or output. Where STATUS is
 * not 0 NAME_retune has to return it, and to leave the instance as it is. */
#include "plrt.h"
#include "../../emitted/worse.h"

#include <float.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#ifdef REAL_FLOAT
typedef float real;
typedef pl_modelf model;
static const double unit = FLT_EPSILON;
#else
typedef double real;
typedef pl_model model;
static const double unit = DBL_EPSILON;
#endif
extern const model TUNED, PLAIN;

enum { STATES = 512, OUTPUTS = 64, INPUTS = 8, PARAMS = 16, BYTES = 1 << 17, STEPS = 4 };
#ifndef STARTS
#define STARTS 150
#endif
typedef union instance {
	double align;
	uint64_t word;
	unsigned char bytes[BYTES];
} instance;
static instance tuned, plain, kept;
static double worst_step, worst_at, worst_out;

static double drawn(void)
{
	static uint64_t state = 88172645463325252u;
	state ^= state << 13;
	state ^= state >> 7;
	state ^= state << 17;
	return (double)(state >> 11) / 0x1p52 - 1;
}

/* Largest difference, in units of rounding of the largest of b */
static double apart(int count, const real *a, const real *b)
{
	double size = 0, most = 0;
	for (int i = 0; i < count; i++)
		size = fmax(size, fabs((double)b[i]));
	for (int i = 0; i < count; i++)
		most = worse(most, a[i] == b[i] ? 0 : fabs((double)a[i] - (double)b[i]) / (size * unit));
	return most;
}

static void compare_between(const real *u, double h)
{
	real a[STATES], b[STATES];
	for (int k = 0; k <= 3; k++) {
		const real tau = (real)(h * k / 3);
		TUNED.at(&tuned, u, tau, a);
		PLAIN.at(&plain, u, tau, b);
		worst_at = worse(worst_at, apart(TUNED.states, a, b));
	}
}

static void compare_steps(const real *u, double h)
{
	real a[STATES], b[STATES];
	for (int k = 0; k < STEPS; k++) {
		if (TUNED.at && PLAIN.at)
			compare_between(u, h);
		TUNED.step(&tuned, u);
		PLAIN.step(&plain, u);
		TUNED.get(&tuned, a);
		PLAIN.get(&plain, b);
		worst_step = worse(worst_step, apart(TUNED.states, a, b));
		TUNED.out(&tuned, a);
		PLAIN.out(&plain, b);
		worst_out = worse(worst_out, apart(TUNED.outputs, a, b));
	}
}

static void draw(int count, real *value)
{
	for (int i = 0; i < count; i++)
		value[i] = (real)drawn();
}

static int refuse(int expected, const real *value, double h)
{
	memcpy(&kept, &tuned, TUNED.size);
	const int status = TUNED.retune(&tuned, value, (real)h);
	printf("retune returns %d, expected %d\n", status, expected);
	if (memcmp(&kept, &tuned, TUNED.size) != 0)
		puts("and the instance has changed");
	return status != expected || memcmp(&kept, &tuned, TUNED.size) != 0;
}

int main(int argc, char **argv)
{
	real value[PARAMS], y[STATES], u[INPUTS], before[INPUTS];
	const int params = argc - 4, expected = atoi(argv[1]);
	const double most = atof(argv[2]), h = atof(argv[3]) > 0 ? atof(argv[3]) : (double)TUNED.h;
	if (TUNED.size > BYTES || PLAIN.size > BYTES || params != TUNED.params || TUNED.states != PLAIN.states)
		return puts("the models do not fit"), 1;
	for (int i = 0; i < params; i++)
		value[i] = (real)strtod(argv[4 + i], NULL);
	TUNED.init(&tuned);
	PLAIN.init(&plain);
	if (expected != 0)
		return refuse(expected, value, atof(argv[3]) == 0 ? (double)TUNED.h : atof(argv[3]));
	if (TUNED.retune(&tuned, value, (real)h) != 0)
		return puts("not retuned"), 1;
	for (int k = 0; k < STARTS; k++) {
		draw(TUNED.states, y);
		draw(TUNED.inputs, u);
		draw(TUNED.inputs, before);
		TUNED.set(&tuned, (real)(k * 0.0178), y);
		PLAIN.set(&plain, (real)(k * 0.0178), y);
		if (TUNED.hold) {
			TUNED.hold(&tuned, before);
			PLAIN.hold(&plain, before);
		}
		compare_steps(u, h);
	}
	printf("in units of rounding: steps off by %.3g, between by %.3g%s, outputs by %.3g; expected at most %g, %g, "
		"%g\n",
		   worst_step, worst_at, TUNED.at && PLAIN.at ? "" : " (there is "
			"none)", worst_out, most, most, 200 * most);
	return !(worst_step <= most && worst_at <= most && worst_out <= 200 * most);
}
