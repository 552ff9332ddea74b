/* SPDX-License-Identifier: GPL-3.0-or-later */
/* crossings: time of a step of a piecewise-linear model that stays clear of its stops, comes near one, and crosses
 * one, and of the plain product Phi x; in short samples that take turns so that all meet the same machine; prints
 * medians and ratios. */
#include "plrt.h"
#include "timing.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { SAMPLES = 301, REPEATS = 100, CASES = 5, N = 9, S = 3, R = 8, DEGREE = 30, RUNGS = 4 };

/* `dof` masses side by side, each with a stop 1 away: x'' = -x + 0.1 cos t, and -8 (x - 1) more beyond 1 */
typedef struct bench {
	pl_switching m;
	double row[S * N], at[S], A[R * N * N], Phi[R * N * N];
	double tangent[R * S * N], chord_error[R * S * N], cubic_error[R * S * N];
	double rungs[R * RUNGS * (N + 1) * N], reach[R * RUNGS * S * N];
	int breaks[S], matrix[R], halvings[R], first[R], spacing[R];
	double work[PL_SWITCHING_WORK(N, S, DEGREE)];
	pl_crossing crossing[16];
} bench;

static void fill_A(int dof, int region, double *A)
{
	int n = 2 * dof + 3;
	for (int i = 0; i < dof; i++) {
		double k = region >> i & 1 ? 8.0 : 0.0;
		A[i * n + dof + i] = 1.0;
		A[(dof + i) * n + i] = -1.0 - k;
		A[(dof + i) * n + 2 * dof] = k;
		A[(dof + i) * n + 2 * dof + 1] = 0.1;
	}
	A[(n - 2) * n + n - 1] = -1.0;
	A[(n - 1) * n + n - 2] = 1.0;
}

static void multiply(int n, const double *a, const double *b, double *c)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			c[i * n + j] = 0.0;
			for (int k = 0; k < n; k++)
				c[i * n + j] += a[i * n + k] * b[k * n + j];
		}
}

/* e^{A h}, or e^{|A| h} */
static void exponential(int n, const double *A, double h, int absolute, double *E)
{
	double P[N * N], T[N * N], Q[N * N];
	for (int i = 0; i < n * n; i++) {
		P[i] = h * (absolute ? fabs(A[i]) : A[i]);
		E[i] = T[i] = i % (n + 1) == 0;
	}
	for (int k = 1; k < 40; k++) {
		multiply(n, T, P, Q);
		for (int i = 0; i < n * n; i++)
			E[i] += T[i] = Q[i] / k;
	}
}

static void fill_ladder(bench *b, int r, double h)
{
	double work[PL_REACH_WORK(N, S)];
	int n = b->m.size, dof = b->m.switches;
	b->first[r] = r * RUNGS;
	b->spacing[r] = 2;
	double *rung = b->rungs + b->first[r] * (n + 1) * n;
	for (int down = b->halvings[r]; down > 0; down -= 2, rung += (n + 1) * n) {
		exponential(n, b->A + r * n * n, ldexp(h, -down), 0, rung);
		for (int i = 0; i < n; i++)
			rung[n * n + i] = 0.0;
	}
	pl_region_reach(n, h, b->halvings[r], 2, b->A + r * n * n, dof, b->row, b->reach + b->first[r] * dof * n, work);
}

static void fill_tables(bench *b, int r, double h)
{
	int n = b->m.size, dof = b->m.switches;
	double *A = b->A + r * n * n, A2[N * N], A4[N * N], growth[N * N];
	fill_A(dof, r, A);
	multiply(n, A, A, A2);
	multiply(n, A2, A2, A4);
	exponential(n, A, h, 0, b->Phi + r * n * n);
	fill_ladder(b, r, h);
	h = ldexp(h, -b->halvings[r]);
	exponential(n, A, h, 1, growth);
	for (int i = 0; i < dof; i++)
		for (int j = 0; j < n; j++) {
			int at = (r * dof + i) * n + j;
			b->tangent[at] = h / 3.0 * A[i * n + j];
			for (int k = 0; k < n; k++) {
				b->chord_error[at] += h * h / 8.0 * fabs(A2[i * n + k]) * growth[k * n + j];
				b->cubic_error[at] += h * h * h * h / 384.0 * fabs(A4[i * n + k]) * growth[k * n + j];
			}
		}
}

/* The terms that matter at |pole| h / 2^halvings = z: z^k/k! above rounding, and one for the way through v */
static int degree_for(double z)
{
	int k = 1;
	for (double term = z; term > 1e-17; term *= z / ++k)
		;
	return k + 1;
}

static void fill(bench *b, int dof, double h)
{
	memset(b, 0, sizeof *b);
	b->m = (pl_switching){.size = 2 * dof + 3, .h = h, .switches = dof, .row = b->row,
	                      .breaks = b->breaks, .at = b->at, .matrix = b->matrix, .A = b->A, .Phi = b->Phi,
	                      .tangent = b->tangent, .chord_error = b->chord_error, .cubic_error = b->cubic_error,
	                      .halvings = b->halvings, .ladder = {b->first, b->spacing, b->rungs, b->reach, b->first},
	                      .max_events = 16, .max_splits = 500};
	for (int i = 0; i < dof; i++) {
		b->row[i * b->m.size + i] = b->at[i] = 1.0;
		b->breaks[i] = 1;
	}
	int halvings = 3.0 * h > 1.0 ? (int)ceil(log2(3.0 * h)) : 0;
	b->m.degree = degree_for(ldexp(3.0 * h, -halvings));
	for (int r = 0; r < 1 << dof; r++) {
		b->matrix[r] = r;
		b->halvings[r] = halvings;
		fill_tables(b, r, h);
	}
}

/* One step from x, again and again; each waits for the one before it. */
static double sample(bench *b, const double *from, int plain, int *crossings)
{
	double x[N], y[N], last = 0.0;
	int n = b->m.size;
	pl_contact start, c;
	pl_switching_start(&b->m, from, &start, b->work);
	double begin = nanoseconds();
	for (int k = 0; k < REPEATS; k++) {
		memcpy(x, from, sizeof *x * (size_t)n);
		x[0] += 1e-300 * last;
		c = start;
		if (plain)
			pl_multiply(n, n, b->Phi, x, y), memcpy(x, y, sizeof *x * (size_t)n);
		else
			pl_switching_step(&b->m, x, &c, b->crossing, b->work);
		last = x[0];
	}
	*crossings = plain ? 0 : c.crossings;
	return (nanoseconds() - begin) / REPEATS;
}

static void measure(int dof, double h)
{
	static const char *const what[CASES] = {"Phi x", "clear", "near, by a cubic", "near, by a Taylor polynomial",
	                                        "one crossing"};
	static bench b;
	static double time[CASES][SAMPLES];
	/* of the first mass; the others are at rest at 0.1 */
	double position[CASES] = {0.1, 0.1, 0.999, 1.0 - 1e-9, 1.0 - 0.3 * h},
		speed[CASES] = {0.1, 0.1, -0.5, 0.0, 0.6};
	int crossings[CASES];
	fill(&b, dof, h);
	for (int k = 0; k < SAMPLES; k++)
		for (int i = 0; i < CASES; i++) {
			double from[N] = {0.1, 0.1, 0.1}; /* not 0: subnormal numbers take their time */
			for (int j = dof; j < N; j++)
				from[j] = 0.0;
			from[0] = position[i];
			from[dof] = speed[i];
			from[2 * dof] = from[2 * dof + 1] = 1.0;
			time[i][k] = sample(&b, from, i == 0, &crossings[i]);
		}
	printf("%d masses and stops, size %d, h = %g, degree %d, %d halvings\n", dof, b.m.size, h, b.m.degree,
	       b.halvings[0]);
	for (int i = 0; i < CASES; i++) {
		double one = median(time[i]), plain = median(time[0]);
		printf("    %-30s %8.1f ns   %6.2f   %d crossings\n", what[i], one, one / plain, crossings[i]);
	}
}

int main(void)
{
	measure(1, 0.01);
	measure(1, 0.1);
	measure(1, 0.33);
	measure(2, 0.1);
	measure(3, 0.01);
	measure(3, 0.1);
	measure(3, 0.33);
	measure(1, 1.0);
	measure(1, 4.0);
	return 0;
}
