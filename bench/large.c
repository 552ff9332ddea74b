/* SPDX-License-Identifier: GPL-3.0-or-later */
/* large: a step of masses in a row, the same with three outputs, and of oscillators, beside a loop over Phi written
 * by hand and, with -DDGEMV, beside dgemv of a BLAS. Short samples take turns, so that all meet the same machine;
 * prints the least of each [ns] and its ratio to the loop. */
#include "masses_pl.h"
#include "outputs_pl.h"
#include "oscillators_pl.h"
#include "timing.h"

#include <stdio.h>

enum { SAMPLES = 400, STEPS = 40, N = MASSES_STATES };
static masses all;
static outputs few;
static oscillators apart;
static double y[N], z[N], seen[OUTPUTS_OUTPUTS], u[1] = { 0.25 };

static void step_masses(void)
{
	masses_step(&all, u);
}

static void step_outputs(void)
{
	outputs_step(&few, u);
	outputs_out(&few, seen);
	__asm__ volatile("" : : "r"(seen) : "memory");
}

static void step_oscillators(void)
{
	oscillators_step(&apart, u);
}

static void loop(void)
{
	for (int i = 0; i < N; i++) {
		z[i] = 0;
		for (int j = 0; j < N; j++)
			z[i] += masses_Phi[i][j] * y[j];
	}
	for (int i = 0; i < N; i++)
		y[i] = z[i];
}

#ifdef DGEMV
void dgemv_(const char *trans, const int *m, const int *n, const double *alpha, const double *A, const int *lda,
			const double *x, const int *incx, const double *beta, double *out, const int *incy);

static void dgemv(void)
{
	const int n = N, one = 1;
	const double alpha = 1, beta = 0;
	dgemv_("T", &n, &n, &alpha, masses_Phi[0], &n, y, &one, &beta, z, &one);
	for (int i = 0; i < N; i++)
		y[i] = z[i];
}
#endif

static const struct {
	const char *name;
	void (*step)(void);
} rivals[] = {
	{ "loop by hand", loop },
#ifdef DGEMV
	{ "dgemv", dgemv },
#endif
	{ "masses", step_masses },
	{ "masses, 3 outputs", step_outputs },
	{ "oscillators", step_oscillators }
};
enum { RIVALS = sizeof rivals / sizeof *rivals };

int main(int argc, char **argv)
{
	double least[RIVALS];
	for (int r = 0; r < RIVALS; r++)
		least[r] = 1e300;
	for (int k = 0; k < SAMPLES; k++)
		for (int r = 0; r < RIVALS; r++) {
			masses_init(&all);
			outputs_init(&few);
			oscillators_init(&apart);
			masses_get(&all, y);
			const double start = own_nanoseconds();
			for (int i = 0; i < STEPS; i++)
				rivals[r].step();
			const double taken = (own_nanoseconds() - start) / STEPS;
			least[r] = taken < least[r] ? taken : least[r];
		}
	printf("%s:\n", argc > 1 ? argv[1] : "");
	for (int r = 0; r < RIVALS; r++)
		printf("  %-22s %7.0f ns  %6.3f of the loop\n", rivals[r].name, least[r], least[r] / least[0]);
	return 0;
}
