/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exponentials of matrices by Taylor's series: their inverses, sums, known eigenvalues, few bits. */
#include "math_cases.h"

/* ---- exponentials of matrices ---- */

enum { PRECISION = 120 };

static mpfi_t *entries_of(struct taylor *t, int n, int precision)
{
	mpfi_t *E = ARRAY(mpfi_t, (size_t)(n * n));
	assert_true(taylor_enclose(t, precision));
	for (int i = 0; i < n * n; i++) {
		mpfi_init(E[i]);
		taylor_entry(t, i / n, i % n, E[i]);
	}
	return E;
}

static void entries_free(int n, mpfi_t *E)
{
	for (int i = 0; i < n * n; i++)
		mpfi_clear(E[i]);
}

static mpfi_t *entries_product(int n, const mpfi_t *X, const mpfi_t *Y)
{
	mpfi_t *Z = ARRAY(mpfi_t, (size_t)(n * n)), term;
	mpfi_init2(term, TRUE_BITS);
	for (int i = 0; i < n * n; i++) {
		mpfi_init2(Z[i], TRUE_BITS);
		mpfi_set_ui(Z[i], 0);
		for (int k = 0; k < n; k++) {
			mpfi_mul(term, X[i / n * n + k], Y[k * n + i % n]);
			mpfi_add(Z[i], Z[i], term);
		}
	}
	mpfi_clear(term);
	return Z;
}

/* Two enclosures of one number meet, and each is narrow. */
static void assert_meet(const char *what, int n, int order, const mpfi_t *X, const mpfi_t *Y, long bits)
{
	for (int i = 0; i < order * order; i++) {
		if (mpfr_cmp(&X[i]->left, &Y[i]->right) > 0 || mpfr_cmp(&Y[i]->left, &X[i]->right) > 0)
			fail_msg("%s, case %d, entry (%d, %d): [%.17g, %.17g] and [%.17g, %.17g] do not meet", what, n,
					i / order,
					 i % order, mpfr_get_d(&X[i]->left, MPFR_RNDD),
							mpfr_get_d(&X[i]->right, MPFR_RNDU),
					 mpfr_get_d(&Y[i]->left, MPFR_RNDD), mpfr_get_d(&Y[i]->right, MPFR_RNDU));
		assert_narrow(what, n, X[i], bits);
		assert_narrow(what, n, Y[i], bits);
	}
}

/* |A tau| is a few at the most: no entry is beyond 2^ROOM */
enum { ROOM = 60 };

static mpq_t *draw_slow_matrix(int n)
{
	mpq_t *A = rationals((size_t)(n * n));
	for (int i = 0; i < n * n; i++)
		if (draw(3))
			draw_fraction(A[i], 6, 5);
	return A;
}

void taylor_times_its_inverse(void **state)
{
	mpq_t tau;
	mpq_init(tau);
	(void)state;
	for (int n = 0; n < 60; n++) {
		int order = 1 + (int)draw(5);
		mpq_t *A = draw_slow_matrix(order), *minus = rationals((size_t)(order * order));
		mpfi_t *I = ARRAY(mpfi_t, (size_t)(order * order));
		for (int i = 0; i < order * order; i++) {
			mpq_neg(minus[i], A[i]);
			mpfi_init2(I[i], 64);
			mpfi_set_ui(I[i], i / order == i % order);
		}
		mpq_set_ui(tau, 1 + draw(12), 8);
		mpq_canonicalize(tau);
		mpfi_t *E = entries_of(taylor_of(order, (const mpq_t *)A, tau), order, PRECISION);
		mpfi_t *back = entries_of(taylor_of(order, (const mpq_t *)minus, tau), order, PRECISION);
		mpfi_t *product = entries_product(order, (const mpfi_t *)E, (const mpfi_t *)back);
		assert_meet("e^A e^-A", n, order, (const mpfi_t *)product, (const mpfi_t *)I, ROOM - PRECISION);
		entries_free(order, E);
		entries_free(order, back);
		entries_free(order, product);
		entries_free(order, I);
	}
	mpq_clear(tau);
}

void taylor_doubled_twice(void **state)
{
	mpq_t tau, exact, other;
	mpq_inits(tau, exact, other, NULL);
	(void)state;
	for (int n = 0; n < 60; n++) {
		int order = 1 + (int)draw(6);
		mpq_t *A = draw_slow_matrix(order);
		mpq_set_ui(tau, 1 + draw(12), 32);
		mpq_canonicalize(tau);
		struct taylor *twice = taylor_doubled(taylor_of(order, (const mpq_t *)A, tau)),
				*again = taylor_doubled(twice);
		mpq_mul_2exp(tau, tau, 2);
		struct taylor *direct = taylor_of(order, (const mpq_t *)A, tau);
		mpfi_t *E = entries_of(again, order, PRECISION), *D = entries_of(direct, order, PRECISION);
		assert_meet("doubled twice", n, order, (const mpfi_t *)E, (const mpfi_t *)D, ROOM - PRECISION);
		for (int i = 0; i < order * order; i++) {
			bool known = taylor_exact(again, i / order, i % order, exact);
			if (known != taylor_exact(direct, i / order, i % order, other)
					|| (known && !mpq_equal(exact, other)))
				fail_msg("case %d, entry %d: exact as doubled %d, %g; directly %g", n, i, known,
						mpq_get_d(exact),
						 mpq_get_d(other));
		}
		entries_free(order, E);
		entries_free(order, D);
	}
	mpq_clears(tau, exact, other, NULL);
}

/* e^{A(s+t)} = e^{As} e^{At}, and e^{A+B} = e^A e^B for B = x + y A + z A^2 */
void taylor_of_sums(void **state)
{
	mpq_t s, t, one, factor[3];
	mpq_inits(s, t, one, factor[0], factor[1], factor[2], NULL);
	mpq_set_ui(one, 1, 1);
	(void)state;
	for (int n = 0; n < 60; n++) {
		int order = 1 + (int)draw(5);
		mpq_t *A = draw_slow_matrix(order), *B = rationals((size_t)(order * order)),
			  *sum = rationals((size_t)(order * order));
		mpq_set_ui(s, 1 + draw(8), 8);
		mpq_set_ui(t, 1 + draw(8), 16);
		mpq_canonicalize(s);
		mpq_canonicalize(t);
		mpfi_t *first = entries_of(taylor_of(order, (const mpq_t *)A, s), order, PRECISION);
		mpfi_t *second = entries_of(taylor_of(order, (const mpq_t *)A, t), order, PRECISION);
		mpfi_t *product = entries_product(order, (const mpfi_t *)first, (const mpfi_t *)second);
		mpq_add(s, s, t);
		mpfi_t *both = entries_of(taylor_of(order, (const mpq_t *)A, s), order, PRECISION);
		assert_meet("e^{A(s+t)}", n, order, (const mpfi_t *)product, (const mpfi_t *)both, ROOM - PRECISION);
		entries_free(order, first);
		entries_free(order, second);
		entries_free(order, product);
		entries_free(order, both);
		for (int k = 0; k < 3; k++)
			draw_fraction(factor[k], 3, 16);
		rational_product(order, order, order, (const mpq_t *)A, (const mpq_t *)A, sum);
		for (int i = 0; i < order * order; i++) {
			mpq_mul(B[i], sum[i], factor[2]);
			add_product(B[i], A[i], factor[1]);
			if (i / order == i % order)
				mpq_add(B[i], B[i], factor[0]);
			mpq_add(sum[i], A[i], B[i]);
		}
		first = entries_of(taylor_of(order, (const mpq_t *)A, one), order, 2 * PRECISION);
		second = entries_of(taylor_of(order, (const mpq_t *)B, one), order, 2 * PRECISION);
		both = entries_of(taylor_of(order, (const mpq_t *)sum, one), order, 2 * PRECISION);
		product = entries_product(order, (const mpfi_t *)first, (const mpfi_t *)second);
		assert_meet("e^{A+B}", n, order, (const mpfi_t *)product, (const mpfi_t *)both,
				3 * ROOM - 2 * PRECISION);
		entries_free(order, first);
		entries_free(order, second);
		entries_free(order, product);
		entries_free(order, both);
	}
	mpq_clears(s, t, one, factor[0], factor[1], factor[2], NULL);
}

/* A = V diag(d) V^-1: e^{A tau} = V diag(e^{d tau}) V^-1, each exponential by MPFR; and as narrow as promised */
void taylor_of_known_eigenvalues(void **state)
{
	mpfr_t e[5], sum, term, largest;
	mpq_t tau, factor;
	mpq_inits(tau, factor, NULL);
	mpfr_inits2(TRUE_BITS, sum, term, largest, NULL);
	for (int k = 0; k < 5; k++)
		mpfr_init2(e[k], TRUE_BITS);
	(void)state;
	for (int n = 0; n < 60; n++) {
		int order = 1 + (int)draw(5), column, precision = 10 + (int)draw(200);
		size_t cells = (size_t)(order * order);
		mpq_t *V, *inverse = rationals(cells), *d = draw_matrix(order, 1), *A = rationals(cells),
				  *scaled = rationals(cells);
		do
			V = draw_matrix(order, order);
		while (!rational_inverse(order, (const mpq_t *)V, inverse, &column));
		draw_fraction(tau, 30, 20);
		mpq_abs(tau, tau);
		for (int i = 0; i < order * order; i++)
			mpq_mul(scaled[i], V[i], d[i % order]);
		rational_product(order, order, order, (const mpq_t *)scaled, (const mpq_t *)inverse, A);
		for (int k = 0; k < order; k++) {
			mpq_mul(factor, d[k], tau);
			mpfr_set_q(e[k], factor, MPFR_RNDN);
			mpfr_exp(e[k], e[k], MPFR_RNDN);
		}
		mpfi_t *E = entries_of(taylor_of(order, (const mpq_t *)A, tau), order, precision);
		mpfr_set_zero(largest, 1);
		for (int round = 0; round < 2; round++)         /* the largest entry, then all */
			for (int i = 0; i < order * order; i++) {
				mpfr_set_zero(sum, 1);
				for (int k = 0; k < order; k++) {
					mpq_mul(factor, V[i / order * order + k], inverse[k * order + i % order]);
					mpfr_mul_q(term, e[k], factor, MPFR_RNDN);
					mpfr_add(sum, sum, term, MPFR_RNDN);
				}
				if (round)
					assert_interval("e^{A tau}", n, E[i], sum);
				if (round)
					assert_narrow("e^{A tau}", n, E[i], mpfr_get_exp(largest) - precision + 1);
				else if (mpfr_cmpabs(sum, largest) > 0)
					mpfr_abs(largest, sum, MPFR_RNDN);
			}
		entries_free(order, E);
	}
	mpq_clears(tau, factor, NULL);
	mpfr_clears(sum, term, largest, NULL);
	for (int k = 0; k < 5; k++)
		mpfr_clear(e[k]);
}

/* Of x' = [[0, 2^g], [-a b 2^-g, a + b]] x, a and b below 0 and rational, with few bits: there what the series leaves
 * out is more than what rounding does. With E the exponentials E11 = (a e^{b t} - b e^{a t})/(a - b) and
 * E12 = 2^g (e^{a t} - e^{b t})/(a - b), in states whose units differ by 2^g. */
void taylor_of_few_bits(void **state)
{
	mpq_t a, b, tau, factor, none;
	mpfr_t truth;
	(void)state;
	mpq_inits(a, b, tau, factor, none, NULL);
	mpfr_init2(truth, TRUE_BITS);
	for (int n = 0; n < 300; n++) {
		int g = 2 * (int)draw(50) - 50;
		mpq_t *A = rationals(4);
		mpq_set_si(a, -1 - (long)draw(40), 1 + draw(40));
		mpq_canonicalize(a);
		mpq_set_si(b, -1 - (long)draw(20), 41 + draw(20));
		mpq_canonicalize(b);
		mpq_set_ui(tau, 1 + draw(20), 1 + draw(20));
		mpq_canonicalize(tau);
		mpq_sub(factor, a, b);
		if (mpq_sgn(factor) == 0)
			continue;
		mpq_set_ui(A[1], 1, 1);
		mpq_mul(A[2], a, b);
		mpq_neg(A[2], A[2]);
		mpq_add(A[3], a, b);
		for (int k = 0; k < (g < 0 ? -g : g); k++) {
			(g < 0 ? mpq_div_2exp : mpq_mul_2exp)(A[1], A[1], 1);
			(g < 0 ? mpq_mul_2exp : mpq_div_2exp)(A[2], A[2], 1);
		}
		mpfi_t *E = entries_of(taylor_of(2, (const mpq_t *)A, tau), 2, 2 + (int)draw(46));
		mpfr_set_zero(truth, 1);
		mpq_div(factor, A[1], factor);
		add_wave(truth, a, none, tau, factor, 0, false);
		mpq_neg(factor, factor);
		add_wave(truth, b, none, tau, factor, 0, false);
		assert_interval("E12", n, E[1], truth);
		mpfr_set_zero(truth, 1);
		mpq_div(factor, factor, A[1]);
		mpq_mul(none, factor, b);
		mpq_mul(factor, factor, a);
		mpq_neg(factor, factor);
		mpq_swap(none, factor);
		mpq_t zero;
		mpq_init(zero);
		add_wave(truth, a, zero, tau, factor, 0, false);
		add_wave(truth, b, zero, tau, none, 0, false);
		mpq_clear(zero);
		mpq_set_ui(none, 0, 1);
		assert_interval("E11", n, E[0], truth);
		entries_free(2, E);
	}
	mpq_clears(a, b, tau, factor, none, NULL);
	mpfr_clear(truth);
}

/* Where no circle is on the way entries are polynomials in tau: here in a triangle without diagonal, all are. */
void taylor_of_a_chain(void **state)
{
	mpq_t tau, found;
	mpq_inits(tau, found, NULL);
	(void)state;
	for (int n = 0; n < 100; n++) {
		int order = 1 + (int)draw(6);
		mpq_t *A = draw_matrix(order, order), *sum = unit_matrix(order), *power = unit_matrix(order);
		mpq_t *next = draw_matrix(order, order);
		for (int i = 0; i < order * order; i++)
			if (i / order >= i % order)
				mpq_set_ui(A[i], 0, 1);
		mpq_set_ui(tau, 1 + draw(50), 1 + draw(50));
		mpq_canonicalize(tau);
		for (int k = 1; k < order; k++) {
			rational_product(order, order, order, (const mpq_t *)power, (const mpq_t *)A, next);
			for (int i = 0; i < order * order; i++) {
				mpq_mul(power[i], next[i], tau);
				mpq_set_ui(found, 1, (unsigned long)k);
				mpq_mul(power[i], power[i], found);
				mpq_add(sum[i], sum[i], power[i]);
			}
		}
		struct taylor *t = taylor_of(order, (const mpq_t *)A, tau);
		for (int i = 0; i < order * order; i++) {
			if (!taylor_exact(t, i / order, i % order, found))
				fail_msg("case %d: entry (%d, %d) of a chain is not found to be exact", n, i / order,
						i % order);
			assert_rational("polynomial in tau", n, i / order, i % order, found, sum[i]);
		}
		/* with a circle through one state, what leads from it or to it is none */
		int at = (int)draw((uint32_t)order);
		mpq_set_si(A[at * order + at], -1, 1);
		t = taylor_of(order, (const mpq_t *)A, tau);
		for (int i = 0; i < order; i++) {
			if (taylor_exact(t, i, at, found) && (i == at || mpq_sgn(A[i * order + at]) != 0))
				fail_msg("case %d: entry (%d, %d) holds an exponential and is found exact: %s", n, i,
						at,
					mpq_get_str(NULL, 10, found));
		}
	}
	mpq_clears(tau, found, NULL);
}
