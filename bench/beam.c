/* SPDX-License-Identifier: GPL-3.0-or-later */
/* beam: time of one step of the rotating beam, and of its linear part's plain loop, in short samples that take turns
 * so that both meet the same machine; prints medians, time per multiplication and their ratio. MULTIPLICATIONS is the
 * step's count in the generator's report. */
#include "plrt.h"
#include "timing.h"

#include <stdio.h>
#include <stdlib.h>

extern const pl_model beam_model;
extern const double beam_Phi[30][30];

enum { SAMPLES = 301, STEPS = 20, LOOPS = 100, STATES = 30 };

static void plain(double table[STATES][STATES], const double *x, double *y)
{
	for (int i = 0; i < STATES; i++) {
		y[i] = 0.0;
		for (int j = 0; j < STATES; j++)
			y[i] += table[i][j] * x[j];
	}
}

static double sample_steps(void *state)
{
	double start = nanoseconds();
	for (int k = 0; k < STEPS; k++)
		beam_model.step(state, NULL);
	return (nanoseconds() - start) / STEPS;
}

/* Each product waits for the one before it, as the products of a step do. */
static double sample_loops(double table[STATES][STATES], double *x, double *y)
{
	void (*volatile product)(double table[STATES][STATES], const double *, double *) = plain;
	double start = nanoseconds();
	for (int k = 0; k < LOOPS; k++) {
		product(table, x, y);
		x[0] = 1e-3 * y[STATES - 1];
	}
	return (nanoseconds() - start) / LOOPS;
}

int main(int argc, char **argv)
{
	static double steps[SAMPLES], loops[SAMPLES], table[STATES][STATES], x[STATES], y[STATES];
	void *state = malloc(beam_model.size);
	if (!state || argc != 2)
		return 2;
	for (int i = 0; i < STATES * STATES; i++)
		table[i / STATES][i % STATES] = beam_Phi[i / STATES][i % STATES];
	for (int j = 0; j < STATES; j++)
		x[j] = 1.0 / (j + 1);
	beam_model.init(state);
	for (int k = 0; k < SAMPLES; k++) {
		steps[k] = sample_steps(state);
		loops[k] = sample_loops(table, x, y);
	}
	double step = median(steps), loop = median(loops), count = MULTIPLICATIONS;
	printf("%-24s %8.0f ns a step of %5.0f multiplications: %.3f ns each; plain 30 x 30 loop: %.3f ns each; ratio "
	       "%.2f\n", argv[1], step, count, step / count, loop / (STATES * STATES),
	       step / count / (loop / (STATES * STATES)));
	free(state);
	return 0;
}
