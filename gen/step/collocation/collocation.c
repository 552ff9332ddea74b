/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Radau IIA collocation with s stages (Hairer and Wanner 1996, IV.5): its nodes, the integrals of the polynomials that
 * are 1 at one of them, and the modes of those, all enclosed and rounded once; nodes of Lobatto. */
#include "collocation.h"
#include "step/exponential/recipe.h"

enum { BITS = 512 };                /* far beyond what rounding needs: entries have no more than 40 bits before it */

static bool is_tiny(mpfr_srcptr x)
{
	return mpfr_zero_p(x) || mpfr_get_exp(x) < -BITS / 2;
}

/* Some of them are 0, of which an enclosure knows the size only: b_j (1 - c_j) in the last row of A^2 is. */
static double rounded(const struct step *step, mpfi_srcptr x)
{
	double value;
	if (mpfi_has_zero(x) && is_tiny(&x->left) && is_tiny(&x->right))
		return 0;
	if (!round_enclosure(x, &value))
		internal_error(step, "a number of the collocation is not enclosed closely enough");
	return value;
}

/* ---- its polynomial ---- */

/* sign (-1)^s times the Legendre polynomial of degree n on 0 .. 1 */
static void add_legendre(mpz_t *c, int n, long sign)
{
	INTEGER term = INTEGER_ZERO, other = INTEGER_ZERO;
	for (int k = 0; k <= n; k++) {
		mpz_bin_uiui(term, (unsigned long)n, (unsigned long)k);
		mpz_bin_uiui(other, (unsigned long)(n + k), (unsigned long)k);
		mpz_mul(term, term, other);
		mpz_mul_si(term, term, (n + k) % 2 ? -sign : sign);
		mpz_add(c[k], c[k], term);
	}
}

/* P_s - P_{s-1}: its zeros are the nodes, 1 among them */
static struct poly polynomial_of_nodes(int stages)
{
	struct poly p = poly_new(stages + 1);
	add_legendre(p.c, stages, 1);
	add_legendre(p.c, stages - 1, -1);
	poly_trim(&p);
	return p;
}

/* sum over k of k! n_k z^k: its zeros are the modes of A. A polynomial p of which the integral from 0 is z p at the
 * nodes has z p = integral - a N, N vanishing there, so p = a (N' + z N'' + z^2 N''' + ...); at 0 that is N + z N' +
 * ... = 0. */
static struct poly polynomial_of_modes(struct poly nodes)
{
	struct poly p = poly_new(nodes.length);
	INTEGER factorial = INTEGER_ZERO;
	for (int k = 0; k < nodes.length; k++) {
		mpz_fac_ui(factorial, (unsigned long)k);
		mpz_mul(p.c[k], nodes.c[k], factorial);
	}
	poly_trim(&p);
	return p;
}

/* Every zero once, of pairs the one above the real axis; 0: they are not found */
static int zeros_of(struct poly p, struct rectangle *zero, int most)
{
	INTEGER content = INTEGER_ZERO;
	struct spectrum *spectrum = spectrum_of(poly_primitive(p, content));
	int count = 0;
	for (int f = 0; spectrum_refine(spectrum, BITS) && f < spectrum->factors; f++)
		for (int k = 0; k < spectrum->poles[f] && count < most; k++)
			rectangle_set(&zero[count++], &spectrum->pole[f][k].at);
	return count;
}

static void sort_real(struct rectangle *zero, int count)
{
	for (int i = 1; i < count; i++)
		for (int k = i; k > 0 && mpfi_cmp(zero[k].re, zero[k - 1].re) < 0; k--)
			mpfi_swap(zero[k].re, zero[k - 1].re);
}

/* Ends and zeros of P_n' */
mpq_t *lobatto_nodes(int stages)
{
	RECTANGLES *zero = rectangles(stages, BITS);
	struct poly legendre = poly_new(stages + 1);
	mpq_t *node = rationals(stages + 1);
	REAL x = WITH_BITS(IRRATIONAL_BITS);
	add_legendre(legendre.c, stages, 1);
	const int zeros = zeros_of(poly_derivative(legendre), zero, stages);
	sort_real(zero, zeros);
	for (int i = 0; i < zeros; i++) {
		mpfi_mid(x, zero[i].re);
		mpfr_get_q(node[i + 1], x);
	}
	mpq_set_ui(node[stages], 1, 1);
	return node;
}

static void put_real_first(struct rectangle *zero, int count)
{
	for (int i = 1; i < count; i++)
		if (mpfi_is_zero(zero[i].im)) {
			mpfi_swap(zero[0].re, zero[i].re);
			mpfi_swap(zero[0].im, zero[i].im);
		}
}

/* ---- the polynomials that are 1 at one node ---- */

/* W: [power][node], from N over x - c, synthetic division, over its value at c */
static void lagrange(struct poly nodes, const struct rectangle *c, int stages, mpfi_t *W)
{
	INTERVALS *quotient = enclosures(stages, BITS);
	INTERVAL value = OVER_BITS(BITS);
	for (int j = 0; j < stages; j++) {
		mpfi_set_z(quotient[stages - 1], nodes.c[stages]);
		for (int m = stages - 1; m > 0; m--) {
			mpfi_mul(quotient[m - 1], quotient[m], c[j].re);
			mpfi_add_z(quotient[m - 1], quotient[m - 1], nodes.c[m]);
		}
		mpfi_set_ui(value, 0);
		for (int m = stages - 1; m >= 0; m--) {
			mpfi_mul(value, value, c[j].re);
			mpfi_add(value, value, quotient[m]);
		}
		for (int m = 0; m < stages; m++)
			mpfi_div(W[m * stages + j], quotient[m], value);
	}
}

/* A: [node][node], integrals from 0 to a node */
static void integrate(const struct rectangle *c, int stages, mpfi_t *W, mpfi_t *A)
{
	INTERVAL power = OVER_BITS(BITS), part = OVER_BITS(BITS);
	for (int i = 0; i < stages; i++) {
		mpfi_set_ui(power, 1);
		for (int m = 0; m < stages; m++) {
			mpfi_mul(power, power, c[i].re);
			for (int j = 0; j < stages; j++) {
				mpfi_mul(part, power, W[m * stages + j]);
				mpfi_div_ui(part, part, (unsigned long)m + 1);
				mpfi_add(A[i * stages + j], A[i * stages + j], part);
			}
		}
	}
}

static void square(int stages, mpfi_t *A, mpfi_t *twice)
{
	INTERVAL part = OVER_BITS(BITS);
	for (int i = 0; i < stages; i++)
		for (int j = 0; j < stages; j++)
			for (int k = 0; k < stages; k++) {
				mpfi_mul(part, A[i * stages + k], A[k * stages + j]);
				mpfi_add(twice[i * stages + j], twice[i * stages + j], part);
			}
}

/* ---- its modes ---- */

/* v_i = sum over k of z^k N^(k+1)(c_i) */
static void right_of_mode(struct poly nodes, const struct rectangle *z, const struct rectangle *c,
			  struct rectangle *value)
{
	RECTANGLE power = new_rectangle(BITS), part = new_rectangle(BITS);
	mpfi_set_ui(power.re, 1);
	for (struct poly p = poly_derivative(nodes); p.length; p = poly_derivative(p)) {
		rectangle_evaluate(&part, p, c);
		rectangle_mul(&part, &part, &power);
		mpfi_add(value->re, value->re, part.re);
		mpfi_add(value->im, value->im, part.im);
		rectangle_mul(&power, &power, z);
	}
}

/* u_j = sum over m of m! z^m W_mj: in powers of time A shifts, x^m to x^(m+1)/(m+1) */
static void left_of_mode(int stages, mpfi_t *W, const struct rectangle *z, int j, struct rectangle *value)
{
	RECTANGLE power = new_rectangle(BITS);
	INTERVAL part = OVER_BITS(BITS);
	mpfi_set_ui(power.re, 1);
	for (int m = 0; m < stages; m++) {
		mpfi_mul(part, power.re, W[m * stages + j]);
		mpfi_add(value->re, value->re, part);
		mpfi_mul(part, power.im, W[m * stages + j]);
		mpfi_add(value->im, value->im, part);
		rectangle_mul(&power, &power, z);
		mpfi_mul_ui(power.re, power.re, (unsigned long)m + 1);
		mpfi_mul_ui(power.im, power.im, (unsigned long)m + 1);
	}
}

/* Both, their product 1; of a pair the right one twice, since the other half of it is the conjugate */
static struct stage_mode mode_of(const struct step *step, struct poly nodes, mpfi_t *W, const struct rectangle *c,
				 const struct rectangle *z)
{
	int stages = nodes.length - 1;
	bool pair = !mpfi_is_zero(z->im);
	RECTANGLES *left = rectangles(stages, BITS), *right = rectangles(stages, BITS);
	struct stage_mode mode = { .pair = pair, .re = rounded(step, z->re), .im = pair ? rounded(step, z->im) : 0 };
	mode.left = ARRAY(double, 2 * (size_t)stages);
	mode.right = ARRAY(double, 2 * (size_t)stages);
	RECTANGLE product = new_rectangle(BITS), part = new_rectangle(BITS);
	for (int i = 0; i < stages; i++) {
		left_of_mode(stages, W, z, i, &left[i]);
		right_of_mode(nodes, z, &c[i], &right[i]);
		rectangle_mul(&part, &left[i], &right[i]);
		mpfi_add(product.re, product.re, part.re);
		mpfi_add(product.im, product.im, part.im);
	}
	for (int i = 0; i < stages; i++) {
		rectangle_div(&left[i], &left[i], &product);
		mpfi_mul_ui(right[i].re, right[i].re, pair ? 2 : 1);
		mpfi_mul_ui(right[i].im, right[i].im, 2);
		mode.left[2 * i] = rounded(step, left[i].re);
		mode.left[2 * i + 1] = pair ? rounded(step, left[i].im) : 0;
		mode.right[2 * i] = rounded(step, right[i].re);
		mode.right[2 * i + 1] = pair ? rounded(step, right[i].im) : 0;
	}
	return mode;
}

/* ---- the whole ---- */

static double *rounded_all(const struct step *step, mpfi_t *x, int count)
{
	double *value = ARRAY(double, count);
	for (int i = 0; i < count; i++)
		value[i] = rounded(step, x[i]);
	return value;
}

struct collocation *collocation_of(const struct step *step)
{
	enum { MOST = 16 };
	int s = step->model->truncation.stages, modes;
	size_t cells = (size_t)(s * s);
	struct collocation *x = NEW(struct collocation);
	RECTANGLES *c = rectangles(MOST, BITS), *z = rectangles(MOST, BITS);
	struct poly nodes = polynomial_of_nodes(s);
	INTERVALS *W = enclosures(cells, BITS), *A = enclosures(cells, BITS), *twice = enclosures(cells, BITS);
	if (zeros_of(nodes, c, MOST) != s)
		internal_error(step, "a collocation without its nodes");
	sort_real(c, s);
	lagrange(nodes, c, s, W);
	integrate(c, s, W, A);
	square(s, A, twice);
	x->stages = s;
	x->node = ARRAY(double, s);
	for (int i = 0; i < s; i++)
		x->node[i] = rounded(step, c[i].re);
	x->once = rounded_all(step, A, s * s);
	x->twice = rounded_all(step, twice, s * s);
	x->monomial = rounded_all(step, W, s * s);
	modes = zeros_of(polynomial_of_modes(nodes), z, MOST);
	if (modes == 0)
		internal_error(step, "a collocation without its modes");
	put_real_first(z, modes);
	x->modes = modes;
	x->mode = ARRAY(struct stage_mode, modes);
	for (int k = 0; k < modes; k++)
		x->mode[k] = mode_of(step, nodes, W, c, &z[k]);
	return x;
}
