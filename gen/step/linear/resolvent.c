/* SPDX-License-Identifier: GPL-3.0-or-later */
/* P(s) = M s^2 + C s + K of M q'' + C q' + K q = f, scaled into Z[s] row by row; B = det P, and P^-1 = adj P / B, which
 * transfer functions are made of. */
#include "inner.h"

struct resolvent {
	const struct linear *system;
	struct polymat P, adj;      /* the row-scaled P(s); its adjugate, when it was asked for */
	struct poly B;              /* its determinant: the product of its blocks' */
	int parts;
	struct poly *part;
	mpz_t *row;                 /* scale of each row */
};

/* ---- scaling ---- */

static void common_denominator(mpz_ptr common, int count, const mpq_t *q)
{
	for (int i = 0; i < count && q; i++)
		mpz_lcm(common, common, mpq_denref(q[i]));
}

/* factor * q, which is an integer */
static void scaled_integer(mpz_ptr z, mpz_srcptr factor, mpq_srcptr q)
{
	mpz_divexact(z, factor, mpq_denref(q));
	mpz_mul(z, z, mpq_numref(q));
}

struct resolvent *resolvent_of(const struct linear *system)
{
	int n = system->n;
	struct resolvent *r = NEW(struct resolvent);
	struct polymat P = { n, ARRAY(struct poly, (size_t)(n * n)) };
	r->system = system;
	r->row = ARRAY(mpz_t, n);
	for (int i = 0; i < n; i++) {
		const mpq_t *rows[] = { system->K, system->C, system->M };
		mpz_init_set_ui(r->row[i], 1);
		for (int k = 0; k < 3; k++)
			common_denominator(r->row[i], n, rows[k] + i * n);
		for (int j = 0; j < n; j++) {
			struct poly *cell = &P.cell[i * n + j];
			*cell = poly_new(3);
			for (int k = 0; k < 3; k++)
				scaled_integer(cell->c[k], r->row[i], rows[k][i * n + j]);
			poly_trim(cell);
		}
	}
	r->P = P;
	r->parts = polymat_determinants(P, &r->part);
	r->B = poly_product(r->parts, r->part);
	return r;
}

static void need_adjugate(struct resolvent *r)
{
	int n = r->P.n;
	if (r->adj.cell)
		return;
	r->adj = (struct polymat){ n, ARRAY(struct poly, (size_t)(n * n)) };
	polymat_adjugate(r->P, &r->B, &r->adj);
}

void characteristic_polynomial(const struct resolvent *r, mpq_t *coefficient)
{
	INTEGER scale = INTEGER_ZERO;
	mpz_set_ui(scale, 1);
	for (int i = 0; i < r->system->n; i++)
		mpz_mul(scale, scale, r->row[i]);
	for (int k = 0; k < r->B.length; k++) {
		mpz_set(mpq_numref(coefficient[k]), r->B.c[k]);
		mpz_set(mpq_denref(coefficient[k]), scale);
		mpq_canonicalize(coefficient[k]);
	}
}

const struct poly *resolvent_determinant(const struct resolvent *r)
{
	return &r->B;
}

/* A large polynomial tells its roots badly, and the matrix that it is of tells them well. */
static void expect_eigenvalues(const struct resolvent *r, struct spectrum *spectrum)
{
	size_t n = (size_t)r->system->states;
	RATIONALS *A = state_matrix(r->system, false);
	SCRATCH double *re = ARRAY(double, n), *im = ARRAY(double, n);
	if (eigenvalues((int)n, A, re, im))
		spectrum_expect(spectrum, (int)n, re, im);
}

struct spectrum *resolvent_spectrum(const struct resolvent *r)
{
	struct spectrum *spectrum = spectrum_of_product(r->parts, r->part);
	if (r->system->states > FEW_STATES && spectrum->precision == 0)
		expect_eigenvalues(r, spectrum);
	return spectrum;
}

/* ---- transfer functions ---- */

/* row i of adj P times a vector of polynomials */
static struct poly adjugate_row(const struct resolvent *r, int i, const struct poly *x)
{
	struct poly sum = poly_new(0);
	for (int k = 0; k < r->adj.n; k++)
		if (x[k].length > 0)
			sum = poly_add(sum, poly_mul(r->adj.cell[i * r->adj.n + k], x[k]));
	return sum;
}

/* scale times q_0 + q_1 s + ... */
static struct poly scaled_poly(int powers, const mpq_t *const *q, int at, mpz_srcptr scale)
{
	struct poly p = poly_new(powers);
	for (int m = 0; m < powers; m++)
		scaled_integer(p.c[m], scale, q[m][at]);
	poly_trim(&p);
	return p;
}

/* Without common factors, N and D primitive */
static struct transfer_function reduced(struct poly N, struct poly D, mpz_srcptr scale)
{
	struct transfer_function t = { .N = N, .D = poly_new(1) };
	RATIONAL content = ZERO;
	mpq_init(t.scale);
	mpz_set_ui(mpq_numref(t.scale), 1);
	mpz_set(mpq_denref(t.scale), scale);
	mpz_set_ui(t.D.c[0], 1);
	if (N.length == 0)
		return t;
	const struct poly common = poly_gcd(N, D);
	t.N = poly_primitive(poly_divide(N, common), mpq_numref(content));
	t.D = poly_primitive(poly_divide(D, common), mpq_denref(content));
	mpq_canonicalize(content);
	mpq_mul(t.scale, t.scale, content);
	return t;
}

struct transfer_function transfer_function_of(struct resolvent *r, const mpq_t *row, int powers,
					      const mpq_t *const *force, const mpq_t *const *direct)
{
	const struct linear *system = r->system;
	const int n = system->n;
	struct poly *x = ARRAY(struct poly, n), N = poly_new(0);
	INTEGER scale = INTEGER_ZERO, rows = INTEGER_ZERO, factor = INTEGER_ZERO;
	need_adjugate(r);
	mpz_set_ui(scale, 1);
	mpz_set_ui(rows, 1);
	for (int m = 0; m < powers; m++) {
		common_denominator(scale, n, force[m]);
		common_denominator(scale, 1, direct[m]);
	}
	common_denominator(rows, system->states, row);
	for (int k = 0; k < n; k++)
		x[k] = poly_scale(scaled_poly(powers, force, k, scale), r->row[k]);
	for (int i = 0; i < system->states; i++) {
		if (mpq_sgn(row[i]) == 0)
			continue;
		scaled_integer(factor, rows, row[i]);
		const struct poly image = adjugate_row(r, system->coord[i], x);
		N = poly_add(N, poly_scale(i >= n ? poly_shift(image, 1) : image, factor));
	}
	N = poly_add(N, poly_scale(poly_mul(scaled_poly(powers, direct, 0, scale), r->B), rows));
	mpz_mul(scale, scale, rows);
	return reduced(N, r->B, scale);
}
