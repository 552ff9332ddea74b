/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What gen/math/walk.c bounds, against powers of the same matrices in 320 bits. */
#include "math/math.h"

#include <math.h>
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>

enum { N = 4, STEPS = 700, CASES = 60, BITS = 320 };

static uint64_t seed = 7;

static double uniform(double least, double most)
{
	seed = seed * 6364136223846793005u + 1442695040888963407u;
	return least + (most - least) * (double)(seed >> 11) * 0x1p-53;
}

/* T [two turns, damped] T^-1 with T = I + small, rows and columns of quite different sizes */
static void draw_matrix(double *A, double damping)
{
	double turn[2][2], units[N];
	for (int k = 0; k < 2; k++) {
		const double angle = uniform(0.01, 1.5), size = 1 - damping * uniform(0, 1);
		turn[k][0] = size * cos(angle);
		turn[k][1] = size * sin(angle);
	}
	for (int i = 0; i < N; i++)
		units[i] = pow(10, uniform(-4, 4));
	for (int i = 0; i < N; i++)
		for (int j = 0; j < N; j++) {
			A[i * N + j] = i / 2 != j / 2 ? (j > i ? 0.01 : 0) : i == j ? turn[i / 2][0]
						   : (i < j ? -1 : 1) * turn[i / 2][1];
			A[i * N + j] *= units[i] / units[j];
		}
}

struct truth { mpfr_t power[N * N], next[N * N], sum[N * N], most[N * N]; };

static void follow(const double *A, long steps, struct truth *t)
{
	mpfr_t size;
	mpfr_init2(size, BITS);
	for (int i = 0; i < N * N; i++) {
		mpfr_inits2(BITS, t->power[i], t->next[i], t->sum[i], t->most[i], NULL);
		mpfr_set_ui(t->power[i], i / N == i % N, MPFR_RNDN);
		mpfr_set_zero(t->sum[i], 1);
		mpfr_set_zero(t->most[i], 1);
	}
	for (long m = 0; m < steps; m++) {
		for (int i = 0; i < N * N; i++) {
			mpfr_abs(size, t->power[i], MPFR_RNDN);
			mpfr_add(t->sum[i], t->sum[i], size, MPFR_RNDN);
			mpfr_max(t->most[i], t->most[i], size, MPFR_RNDN);
			mpfr_set_zero(t->next[i], 1);
			for (int k = 0; k < N; k++) {
				mpfr_mul_d(size, t->power[k * N + i % N], A[i / N * N + k], MPFR_RNDN);
				mpfr_add(t->next[i], t->next[i], size, MPFR_RNDN);
			}
		}
		for (int i = 0; i < N * N; i++)
			mpfr_swap(t->power[i], t->next[i]);
	}
	mpfr_clear(size);
}

static void forget(struct truth *t)
{
	for (int i = 0; i < N * N; i++)
		mpfr_clears(t->power[i], t->next[i], t->sum[i], t->most[i], NULL);
}

static void balancing_is_exact(void **state)
{
	(void)state;
	for (int c = 0; c < CASES; c++) {
		double A[N * N], B[N * N], scale[N];
		draw_matrix(A, 0.01);
		for (int i = 0; i < N * N; i++)
			B[i] = A[i];
		balance_map(N, B, scale);
		double least = INFINITY, most = 0;
		for (int i = 0; i < N * N; i++) {
			assert_true(B[i] * scale[i / N] / scale[i % N] == A[i]);
			if (i / N != i % N && i / N / 2 == i % N / 2) {
				least = fmin(least, fabs(B[i]));
				most = fmax(most, fabs(B[i]));
			}
		}
		assert_true(most < 2000 * least);       /* 1e16 before */
	}
}

/* Sums of two levels are bounds; those of a row hold within what their walk may round. */
static void sums_are_bounds(void **state)
{
	(void)state;
	for (int c = 0; c < CASES; c++) {
		struct truth t;
		double A[N * N], scale[N];
		draw_matrix(A, c % 3 == 0 ? 0 : c % 3 == 1 ? 0.01 : 0.5);
		balance_map(N, A, scale);
		follow(A, STEPS, &t);
		const struct spread s = spread_of(N, A, STEPS);
		assert_true(s.known);
		for (int i = 0; i < N * N; i++) {
			assert_true(s.sum[i] >= mpfr_get_d(t.sum[i], MPFR_RNDU));
			assert_true(s.most[i] >= mpfr_get_d(t.most[i], MPFR_RNDU));
		}
		for (int i = 0; i < N; i++)
			for (int columns = 0; columns < 2; columns++) {
				double unit[N] = { 0 }, sum[N], most[N];
				unit[i] = 1;
				reach_of_row(&s, A, unit, columns, sum, most);
				for (int j = 0; j < N; j++) {
					const int cell = columns ? j * N + i : i * N + j;
					const double truth = mpfr_get_d(t.sum[cell], MPFR_RNDU);
					assert_true(sum[j] >= truth);
					assert_true(sum[j] <= truth * (1 + 1e-5) + 1e-6);
					assert_true(most[j] >= mpfr_get_d(t.most[cell], MPFR_RNDU));
				}
			}
		forget(&t);
	}
}

/* What has died away is not walked through: a billion steps are as 3000. */
static void a_walk_ends_where_all_is_decayed(void **state)
{
	double A[N * N], scale[N], unit[N] = { 1 }, sum[2][N], most[2][N];
	(void)state;
	draw_matrix(A, 0);
	for (int i = 0; i < N * N; i++)
		A[i] *= 0.95;
	balance_map(N, A, scale);
	for (int k = 0; k < 2; k++) {
		const struct spread s = spread_of(N, A, k ? 1000000000 : 3000);
		assert_true(s.known);
		reach_of_row(&s, A, unit, false, sum[k], most[k]);
	}
	for (int i = 0; i < N; i++)
		assert_true(fabs(sum[1][i] - sum[0][i]) <= 1e-5 * sum[0][i] + 1e-9);
}

static void growth_is_not_known(void **state)
{
	double A[N * N], scale[N];
	(void)state;
	draw_matrix(A, 0);
	for (int i = 0; i < N * N; i++)
		A[i] *= 1.1;
	balance_map(N, A, scale);
	assert_false(spread_of(N, A, STEPS).known);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(balancing_is_exact),
		cmocka_unit_test(sums_are_bounds),
		cmocka_unit_test(a_walk_ends_where_all_is_decayed),
		cmocka_unit_test(growth_is_not_known),
	};
	memory_open();
	int failed = cmocka_run_group_tests(tests, NULL, NULL);
	memory_close();
	return failed;
}
