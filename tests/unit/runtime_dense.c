/* SPDX-License-Identifier: MIT-0 */
/* runtime/dense.c by what it leaves of the equations, runtime/root.c against pow. */
#include "runtime.h"
#include "../emitted/worse.h"

enum { MOST = 12 };

static double one_number(void)
{
	return (double)(random_word() >> 11) * 0x1p-52 - 1;
}

/* A row in four begins with zeros, so that rows have to change places. */
static void draw(int n, int parts, real *A)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n * parts; j++)
			A[i * n * parts + j] = (real)(i % 4 == 0 && j < n * parts / 2 ? 0 : one_number());
}

/* max |A x - b| over max |A| |x|, in units of rounding: some n, since no growth of elements is to be seen */
static void assert_small(double off, double size, int n, const char *what)
{
	if (!(off <= 4 * n * (double)REAL_EPSILON * size))
		fail_msg("%s of %d: A x - b is %.3g, tolerance %.3g", what, n, off,
				4 * n * (double)REAL_EPSILON * size);
}

static void solves_real(void **state)
{
	(void)state;
	for (int run = 0; run < 2000; run++) {
		const int n = 1 + run % MOST;
		real A[MOST * MOST], factors[MOST * MOST], b[MOST], x[MOST];
		int pivot[MOST];
		double off = 0, size = 0;
		draw(n, 1, A);
		for (int i = 0; i < n; i++)
			x[i] = b[i] = (real)one_number();
		memcpy(factors, A, sizeof A);
		if (!pl_factor(n, factors, pivot))
			continue;
		pl_solve(n, factors, pivot, x);
		for (int i = 0; i < n; i++) {
			double sum = 0, sizes = fabs((double)b[i]);
			for (int j = 0; j < n; j++) {
				sum += (double)A[i * n + j] * (double)x[j];
				sizes += fabs((double)A[i * n + j] * (double)x[j]);
			}
			off = worse(off, fabs(sum - (double)b[i]));
			size = fmax(size, sizes);
		}
		assert_small(off, size, n, "real");
	}
}

static void solves_complex(void **state)
{
	(void)state;
	for (int run = 0; run < 2000; run++) {
		const int n = 1 + run % MOST;
		real A[2 * MOST * MOST], factors[2 * MOST * MOST], b[2 * MOST], x[2 * MOST];
		int pivot[MOST];
		double off = 0, size = 0;
		draw(n, 2, A);
		for (int i = 0; i < 2 * n; i++)
			x[i] = b[i] = (real)one_number();
		memcpy(factors, A, sizeof A);
		if (!pl_factor_complex(n, factors, pivot))
			continue;
		pl_solve_complex(n, factors, pivot, x);
		for (int i = 0; i < n; i++) {
			double re = -(double)b[2 * i], im = -(double)b[2 * i + 1], sizes = fabs(re) + fabs(im);
			for (int j = 0; j < n; j++) {
				const double p = (double)A[2 * (i * n + j)], q = (double)A[2 * (i * n + j) + 1];
				const double a = (double)x[2 * j], c = (double)x[2 * j + 1];
				re += p * a - q * c;
				im += p * c + q * a;
				sizes += (fabs(p) + fabs(q)) * (fabs(a) + fabs(c));
			}
			off = worse(off, fabs(re) + fabs(im));
			size = fmax(size, sizes);
		}
		assert_small(off, size, n, "complex");
	}
}

/* Of matrices with a row twice, or with what is not a number, nothing is divided by 0 */
static void tells_singular(void **state)
{
	real none[4] = {0, 0, 0, 0}, zero[8] = {0}, odd[4] = {(real)NAN, 1, 1, 1}, pair[8] = {2, 2, 2, 2, 2, 2, 2, 2};
	real same[4] = {2, 3, 2, 3};
	int pivot[2];
	(void)state;
	assert_int_equal(pl_factor(2, none, pivot), 0);
	assert_int_equal(pl_factor(2, same, pivot), 0);
	assert_int_equal(pl_factor_complex(2, zero, pivot), 0);
	assert_int_equal(pl_factor_complex(2, pair, pivot), 0);
	assert_int_equal(pl_factor(2, odd, pivot), 0);
}

/* Within 6 %, and exactly 1 and 2^k where n divides */
static void rough_roots(void **state)
{
	double worst = 0;
	(void)state;
	for (int run = 0; run < 200000; run++) {
		const int n = 1 + run % 30;
		const real a = (real)ldexp(1 + fabs(one_number()), (int)(random_word() % 200) - 100);
		worst = worse(worst, fabs((double)pl_root(a, n) / pow((double)a, 1.0 / n) - 1));
	}
	if (!(worst <= 0.0615))
		fail_msg("pl_root is off by %.4g, tolerance 0.0615", worst);
	assert_true(pl_root(1, 7) == 1);
	assert_true(pl_root((real)ldexp(1, 60), 20) == 8);
	assert_true(pl_root((real)ldexp(1, -60), 20) == (real)0.125);
	assert_true(pl_root(3, 1) == 3);
}

ROOM(dense, cmocka_unit_test(solves_real), cmocka_unit_test(solves_complex), cmocka_unit_test(tells_singular),
	 cmocka_unit_test(rough_roots))
