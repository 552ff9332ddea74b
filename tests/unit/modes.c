/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What steps in normal modes are made of, by other roads: eigenvalues by traces and determinants in rationals, weights
 * by quadrature of the response to an impulse in closed form, nodes by their own closed forms. */
#include "draw.h"
#include "step/collocation/collocation.h"
#include "step/exponential/inner.h"

enum { BITS = 400, GOOD = 170 };

/* |a - b| <= 2^-bits |b|, or both are as small as that */
static bool agree(mpfr_srcptr a, mpfr_srcptr b, int bits)
{
	mpfr_t gap, size;
	mpfr_inits2(BITS, gap, size, NULL);
	mpfr_sub(gap, a, b, MPFR_RNDN);
	mpfr_abs(size, b, MPFR_RNDN);
	mpfr_add_d(size, size, 0x1p-40, MPFR_RNDN);
	mpfr_div(gap, gap, size, MPFR_RNDN);
	const bool good = mpfr_zero_p(gap) || mpfr_get_exp(gap) <= -bits;
	if (!good)
		mpfr_printf("# found %.40Rg, expected %.40Rg\n", a, b);
	mpfr_clears(gap, size, NULL);
	return good;
}

/* ---- eigenvalues ---- */

/* det X and tr(X^-1 Y) */
static void invariants(int n, const mpq_t *X, const mpq_t *Y, mpq_ptr det, mpq_ptr trace)
{
	const size_t cells = (size_t)(n * n);
	mpq_t *left = rationals(cells), *inverse = rationals(cells), part;
	int column;
	mpq_init(part);
	assert_true(rational_inverse(n, X, inverse, &column));
	mpq_set_ui(trace, 0, 1);
	for (int i = 0; i < n; i++)
		for (int k = 0; k < n; k++) {
			mpq_mul(part, inverse[i * n + k], Y[k * n + i]);
			mpq_add(trace, trace, part);
		}
	for (size_t i = 0; i < cells; i++)
		mpq_set(left[i], X[i]);
	mpq_set_ui(det, 1, 1);
	for (int k = 0; k < n; k++) {               /* X is positive definite: no pivots of 0 */
		mpq_mul(det, det, left[k * n + k]);
		for (int i = k + 1; i < n; i++) {
			mpq_div(part, left[i * n + k], left[k * n + k]);
			rational_subtract_row(n, left + i * n, (const mpq_t *)left + k * n, part);
		}
	}
	mpq_clear(part);
}

/* Symmetric, block diagonal where `first` coordinates are apart, diagonally dominant */
static mpq_t *draw_stiff(int n, int first)
{
	mpq_t *K = rationals((size_t)(n * n));
	for (int i = 0; i < n; i++)
		for (int j = 0; j < i; j++) {
			if ((i < first) != (j < first))
				continue;
			mpq_set_si(K[i * n + j], draw_integer(20), 1 + (unsigned long)draw(7));
			mpq_canonicalize(K[i * n + j]);
			mpq_set(K[j * n + i], K[i * n + j]);
		}
	for (int i = 0; i < n; i++)
		mpq_set_ui(K[i * n + i], 30 * (unsigned long)n + (unsigned long)draw(5) * (unsigned long)(i + 1), 1);
	return K;
}

static void eigenvalues_of_pairs(void **state)
{
	(void)state;
	for (int run = 0; run < 20; run++) {
		const int n = 2 + (int)draw(5), first = (int)draw(n);
		const mpq_t *M = (const mpq_t *)draw_stiff(n, first), *K = (const mpq_t *)draw_stiff(n, first);
		struct eigenpairs pairs;
		mpq_t det[2], trace, unused;
		mpfr_t sum, product, exact;
		mpq_inits(det[0], det[1], trace, unused, NULL);
		mpfr_inits2(BITS, sum, product, exact, NULL);
		assert_true(symmetric_eigenpairs(n, M, K, 192, &pairs));
		invariants(n, M, K, det[0], trace);
		invariants(n, K, M, det[1], unused);
		mpfr_set_zero(sum, 1);
		mpfr_set_ui(product, 1, MPFR_RNDN);
		for (int j = 0; j < n; j++) {
			mpfr_add(sum, sum, pairs.value[j], MPFR_RNDN);
			mpfr_mul(product, product, pairs.value[j], MPFR_RNDN);
			int sides[2] = {0, 0};      /* entries of the vector that are not 0, before `first` and after */
			for (int i = 0; i < n; i++)
				sides[i >= first] += !mpfr_zero_p(pairs.vector[i * n + j]);
			assert_true((sides[0] == 0) != (sides[1] == 0));
		}
		mpfr_set_q(exact, trace, MPFR_RNDN);
		assert_true(agree(sum, exact, GOOD));
		mpq_div(det[1], det[1], det[0]);
		mpfr_set_q(exact, det[1], MPFR_RNDN);
		assert_true(agree(product, exact, GOOD));
		mpq_clears(det[0], det[1], trace, unused, NULL);
		mpfr_clears(sum, product, exact, NULL);
	}
}

static void eigenvalues_of_no_mass(void **state)
{
	const mpq_t *K = (const mpq_t *)draw_stiff(3, 0);
	mpq_t *M = rationals(9);
	struct eigenpairs pairs;
	(void)state;
	for (int i = 0; i < 9; i++)
		mpq_set_ui(M[i], 1, 1);                 /* of rank 1 */
	assert_false(symmetric_eigenpairs(3, (const mpq_t *)M, K, 192, &pairs));
}

/* ---- nodes ---- */

static void nodes_in_closed_form(void **state)
{
	mpfr_t found, root, expected;
	(void)state;
	mpfr_inits2(BITS, found, root, expected, NULL);
	static const int known[][3] = { { 2, 0, 1 }, { 3, 5, 10 }, { 4, 21, 14 } };    /* 1/2 - sqrt(b)/c: the second */
	for (int k = 0; k < 3; k++) {
		const mpq_t *node = (const mpq_t *)lobatto_nodes(known[k][0]);
		mpfr_sqrt_ui(root, (unsigned long)known[k][1], MPFR_RNDN);
		mpfr_div_si(root, root, known[k][2], MPFR_RNDN);
		mpfr_set_d(expected, 0.5, MPFR_RNDN);
		mpfr_sub(expected, expected, root, MPFR_RNDN);
		mpfr_set_q(found, node[1], MPFR_RNDN);
		assert_true(agree(found, expected, GOOD));
		assert_int_equal(mpq_sgn(node[0]), 0);
		assert_int_equal(mpq_cmp_ui(node[known[k][0]], 1, 1), 0);
	}
	mpfr_clears(found, root, expected, NULL);
}

/* ---- weights ---- */

struct integral {                               /* of g(theta h - s) L(s/h) over s; g: impulse response, or its slope */
	mpfr_t omega, delta, h, end;                /* omega^2 = lambda - delta^2, above 0 */
	const struct lagrange *l;
	int basis;
	bool slope;
};

static void integrand(const struct integral *f, mpfr_srcptr s, mpfr_ptr value)
{
	mpfr_t left, angle, sine, cosine, polynomial;
	mpfr_inits2(BITS, left, angle, sine, cosine, polynomial, NULL);
	mpfr_sub(left, f->end, s, MPFR_RNDN);
	mpfr_mul(angle, f->omega, left, MPFR_RNDN);
	mpfr_sin_cos(sine, cosine, angle, MPFR_RNDN);
	mpfr_div(sine, sine, f->omega, MPFR_RNDN);
	mpfr_mul(value, sine, f->delta, MPFR_RNDN);
	mpfr_sub(cosine, cosine, value, MPFR_RNDN); /* e^{-delta t} (cos - delta sin/omega) is the slope */
	mpfr_mul(left, left, f->delta, MPFR_RNDN);
	mpfr_neg(left, left, MPFR_RNDN);
	mpfr_exp(left, left, MPFR_RNDN);
	mpfr_mul(value, left, f->slope ? cosine : sine, MPFR_RNDN);
	mpfr_div(angle, s, f->h, MPFR_RNDN);
	mpfr_set_ui(polynomial, 1, MPFR_RNDN);
	for (int k = 0; k < f->l->nodes; k++) {
		if (k == f->basis)
			continue;
		mpfr_sub(left, angle, f->l->node[k], MPFR_RNDN);
		mpfr_mul(polynomial, polynomial, left, MPFR_RNDN);
		mpfr_sub(left, f->l->node[f->basis], f->l->node[k], MPFR_RNDN);
		mpfr_div(polynomial, polynomial, left, MPFR_RNDN);
	}
	mpfr_mul(value, value, polynomial, MPFR_RNDN);
	mpfr_clears(left, angle, sine, cosine, polynomial, NULL);
}

/* tanh-sinh (Takahasi and Mori 1974): s = end (1 + tanh(pi/2 sinh x))/2 */
static void integrate(const struct integral *f, mpfr_ptr sum)
{
	enum { PER_UNIT = 48, REACH = 5 };
	mpfr_t x, half_pi, u, weight, value, s;
	mpfr_inits2(BITS, x, half_pi, u, weight, value, s, NULL);
	mpfr_const_pi(half_pi, MPFR_RNDN);
	mpfr_div_ui(half_pi, half_pi, 2, MPFR_RNDN);
	mpfr_set_zero(sum, 1);
	for (int k = -REACH * PER_UNIT; k <= REACH * PER_UNIT; k++) {
		mpfr_set_si(x, k, MPFR_RNDN);
		mpfr_div_ui(x, x, PER_UNIT, MPFR_RNDN);
		mpfr_sinh_cosh(u, weight, x, MPFR_RNDN);
		mpfr_mul(u, u, half_pi, MPFR_RNDN);
		mpfr_mul(weight, weight, half_pi, MPFR_RNDN);
		mpfr_tanh(s, u, MPFR_RNDN);
		mpfr_add_ui(s, s, 1, MPFR_RNDN);
		mpfr_mul(s, s, f->end, MPFR_RNDN);
		mpfr_div_ui(s, s, 2, MPFR_RNDN);
		mpfr_cosh(u, u, MPFR_RNDN);
		mpfr_sqr(u, u, MPFR_RNDN);
		mpfr_div(weight, weight, u, MPFR_RNDN);
		integrand(f, s, value);
		mpfr_mul(value, value, weight, MPFR_RNDN);
		mpfr_add(sum, sum, value, MPFR_RNDN);
	}
	mpfr_mul(sum, sum, f->end, MPFR_RNDN);
	mpfr_div_ui(sum, sum, 2 * PER_UNIT, MPFR_RNDN);
	mpfr_clears(x, half_pi, u, weight, value, s, NULL);
}

static void weights_by_quadrature(void **state)
{
	static const double omega[] = { 0.3, 7, 120, 900 }, delta[] = { 0, 0.5, 30, 2 };
	mpq_t h, theta, *node;
	(void)state;
	mpq_inits(h, theta, NULL);
	mpq_set_ui(h, 1, 100);
	for (int run = 0; run < 8; run++) {
		const int nodes = 2 + run % 4;
		node = run % 2 ? lobatto_nodes(nodes - 1) : rationals((size_t)nodes);
		for (int k = 0; k < nodes && run % 2 == 0; k++)
			mpq_set_si(node[k], 1 - k, 1);
		mpq_set_ui(theta, 2 + (unsigned long)run % 3, 4);
		mpq_canonicalize(theta);
		struct lagrange l = lagrange_of(nodes, (const mpq_t *)node);
		struct integral f = { .l = &l };
		struct normal_mode mode;
		mpfr_t sum;
		mpfr_inits2(BITS, f.omega, f.delta, f.h, f.end, mode.lambda, mode.delta, sum, NULL);
		mpfr_set_d(f.omega, omega[run % 4], MPFR_RNDN);
		mpfr_set_d(f.delta, delta[(run + run / 4) % 4], MPFR_RNDN);
		mpfr_set_q(f.h, h, MPFR_RNDN);
		mpfr_mul_q(f.end, f.h, theta, MPFR_RNDN);
		mpfr_set(mode.delta, f.delta, MPFR_RNDN);
		mpfr_sqr(mode.lambda, f.delta, MPFR_RNDN);
		mpfr_sqr(sum, f.omega, MPFR_RNDN);
		mpfr_add(mode.lambda, mode.lambda, sum, MPFR_RNDN);
		struct mode_flow flow = mode_flow_of(&mode, h, theta, &l);
		for (f.basis = 0; f.basis < nodes; f.basis++)
			for (int slope = 0; slope < 2; slope++) {
				f.slope = slope;
				integrate(&f, sum);
				assert_true(agree(slope ? flow.rate[f.basis] : flow.position[f.basis], sum, 120));
			}
		mode_flow_free(&flow);
		mpfr_clears(f.omega, f.delta, f.h, f.end, mode.lambda, mode.delta, sum, NULL);
	}
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(eigenvalues_of_pairs),
		cmocka_unit_test(eigenvalues_of_no_mass),
		cmocka_unit_test(nodes_in_closed_form),
		cmocka_unit_test(weights_by_quadrature),
	};
	choose_cases(argc, argv);
	memory_open();
	const int status = cmocka_run_group_tests(tests, NULL, NULL);
	memory_close();
	return status;
}
