/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a C program spends on a million steps with all outputs kept: ns per step, the least of 10 samples; by NAME_step
 * and NAME_out, and by NAME_run.  MODEL is the model's name; its header is model_pl.h. */
#include "model_pl.h"
#include "timing.h"

#include <stdio.h>

#define JOIN(a, b) a##b
#define NAME(a, b) JOIN(a, b)

enum { STEPS = 1000000, SAMPLES = 10 };

static NAME(MODEL, ) state;

static void by_steps(const double *u, double *out, size_t outputs)
{
	(void)u;
	for (size_t k = 0; k < STEPS; k++) {
#ifdef DRIVEN
		NAME(MODEL, _step)(&state, u + k);
#else
		NAME(MODEL, _step)(&state);
#endif
		NAME(MODEL, _out)(&state, out + k * outputs);
	}
}

static void by_run(const double *u, double *out)
{
	(void)u;
#ifdef DRIVEN
	NAME(MODEL, _run)(&state, STEPS, u, out);
#else
	NAME(MODEL, _run)(&state, STEPS, out);
#endif
}

int main(void)
{
	const size_t outputs = (size_t)NAME(MODEL, _model).outputs;
	double *u = calloc(STEPS, sizeof *u), *out = calloc(STEPS * outputs, sizeof *out), least[2] = { 1e300, 1e300 };
	if (!u || !out)
		return 1;
	for (int i = 0; i < 2 * SAMPLES; i++) {
		NAME(MODEL, _init)(&state);
		double start = nanoseconds();
		if (i % 2)
			by_run(u, out);
		else
			by_steps(u, out, outputs);
		double took = (nanoseconds() - start) / STEPS;
		if (took < least[i % 2])
			least[i % 2] = took;
	}
	printf("%.2f %.2f\n", least[0], least[1]);
	free(u);
	free(out);
	return 0;
}
