/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Laplace images N/D of what a step is made of. From M q'' + C q' + K q = f(tau):
 *     P(s) Q(s) = (M s + C) q(0) + M v(0) + F(s),      V(s) = s Q(s) - q(0),      P^-1 = adj P / B
 * Whatever acts during a step is an excitation: a sum of tau^m e^{a tau} cos(w tau) and sin(w tau). With u = s - a
 * their images are m! Re (u + iw)^{m+1} / (u^2 + w^2)^{m+1}, and the same with Im. Everything is scaled into Z[s]. */
#include "inner.h"

struct resolvent {
	const struct linear *system;
	struct polymat P, adj;      /* the row-scaled P(s); its adjugate, when it was asked for */
	struct poly B;              /* its determinant: the product of its blocks' */
	int parts;
	struct poly *part;
	mpz_t *row;                 /* scale of each row */
	struct linear requested;    /* whose responses are kept */
	struct response **kept, *none;
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

static struct poly constant_poly(unsigned long value)
{
	struct poly p = poly_new(1);
	mpz_set_ui(p.c[0], value);
	return p;
}

/* The images of high powers are long, and there are many: what nobody else holds is given back. */
static void replace(struct poly *p, struct poly by)
{
	clear_integers(&p->c);
	*p = by;
}

static void multiply(struct poly *p, struct poly by)
{
	replace(p, poly_mul(*p, by));
}

static void add(struct poly *p, struct poly term)
{
	replace(p, poly_add(*p, term));
	clear_integers(&term.c);
}

static struct poly poly_power(struct poly p, int exponent)
{
	struct poly power = constant_poly(1);
	for (int i = 0; i < exponent; i++)
		multiply(&power, p);
	return power;
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

struct response **response_kept(struct resolvent *r, const struct linear *system, int number)
{
	if (system->states > LIMIT_RESIDUE_STATES) {
		r->none = NULL;
		return &r->none;
	}
	if (!r->kept || r->requested.load != system->load || r->requested.heldK != system->heldK ||
			r->requested.heldC != system->heldC) {
		const int columns = system->states + system->segments * load_columns(system);
		r->requested = *system;
		r->kept = ARRAY(struct response *, (size_t)(system->states * columns));
	}
	return &r->kept[number];
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
	if (r->system->states > LIMIT_RESIDUE_STATES && spectrum->precision == 0)
		expect_eigenvalues(r, spectrum);
	return spectrum;
}

/* ---- excitations ---- */

struct oscillation {                /* u = s - a, scaled by the common denominator q of a and w */
	mpz_t q, W;                 /* W = q w */
	struct poly U, D;           /* U = q u; D = q^2 (u^2 + w^2), or U itself where w = 0 */
};

static struct oscillation oscillation_of(const struct excitation *e)
{
	struct oscillation o;
	mpz_init(o.q);
	mpz_init(o.W);
	mpz_lcm(o.q, mpq_denref(e->a), mpq_denref(e->w));
	scaled_integer(o.W, o.q, e->w);
	o.U = poly_new(2);
	scaled_integer(o.U.c[0], o.q, e->a);
	mpz_neg(o.U.c[0], o.U.c[0]);
	mpz_set(o.U.c[1], o.q);
	o.D = o.U;
	if (mpz_sgn(o.W) != 0) {
		o.D = poly_mul(o.U, o.U);
		mpz_addmul(o.D.c[0], o.W, o.W);
	}
	return o;
}

/* p = a p + b r */
static void replace_by_sum(struct poly *p, struct poly a, mpz_srcptr b, struct poly r)
{
	struct poly product = poly_mul(*p, a), scaled = poly_scale(r, b);
	replace(p, poly_add(product, scaled));
	clear_integers(&product.c);
	clear_integers(&scaled.c);
}

/* (U + iW) (re + i im) */
static void turn(const struct oscillation *o, struct poly *re, struct poly *im)
{
	INTEGER minus = INTEGER_ZERO;
	mpz_neg(minus, o->W);
	struct poly before = poly_shift(*re, 0);
	replace_by_sum(re, o->U, minus, *im);
	replace_by_sum(im, o->U, o->W, before);
	clear_integers(&before.c);
}

/* scale * (numerator over D^powers) of sum_m factor[m][0] cos + factor[m][1] sin; `stride` apart in `factor`. Over
 * D^{m+1} the numerators are m! q^{m+1} times Re and Im (U + iW)^{m+1}, or 1 where w = 0; Horner's rule adds them. */
static struct poly excitation_image(const struct excitation *e, const struct oscillation *o, const mpq_t *factor,
				    int stride, mpz_srcptr scale)
{
	struct poly sum = poly_new(0), re = constant_poly(1), im = poly_new(0), one = constant_poly(1);
	INTEGER z = INTEGER_ZERO, common = INTEGER_ZERO;
	mpz_set(common, scale);
	for (int m = 0; m < e->powers; m++) {
		mpz_mul(common, common, o->q);
		mpz_mul_ui(common, common, m > 0 ? (unsigned long)m : 1);
		if (mpz_sgn(o->W) != 0)
			turn(o, &re, &im);
		scaled_integer(z, common, factor[2 * m * stride]);
		replace_by_sum(&sum, o->D, z, re);
		scaled_integer(z, common, factor[(2 * m + 1) * stride]);
		replace_by_sum(&sum, one, z, im);
	}
	clear_integers(&re.c);
	clear_integers(&im.c);
	clear_integers(&one.c);
	return sum;
}

struct excitation excitation_new(int n, mpq_srcptr a, mpq_srcptr w, int powers)
{
	mpq_srcptr zero = a && w ? NULL : rationals(1)[0];
	struct excitation e = { a ? a : zero, w ? w : zero, powers, NULL, NULL };
	e.force = rationals(2 * (size_t)powers * (size_t)n);
	e.direct = rationals(2 * (size_t)powers);
	return e;
}

/* ---- one image ---- */

struct denominators {               /* of the denominators of all excitations */
	struct oscillation *o;
	struct poly all, *without;  /* ... and of all but one */
};

static struct denominators find_denominators(const struct question *ask)
{
	size_t count = (size_t)ask->excitations;
	struct denominators p = { ARRAY(struct oscillation, count), constant_poly(1), ARRAY(struct poly, count) };
	for (int l = 0; l < ask->excitations; l++) {
		p.o[l] = oscillation_of(&ask->excitation[l]);
		p.without[l] = constant_poly(1);
	}
	for (int l = 0; l < ask->excitations; l++) {
		struct poly power = poly_power(p.o[l].D, ask->excitation[l].powers);
		multiply(&p.all, power);
		for (int other = 0; other < ask->excitations; other++)
			if (other != l)
				multiply(&p.without[other], power);
		clear_integers(&power.c);
	}
	return p;
}

static void question_scale(const struct question *ask, const struct linear *system, mpz_ptr scale)
{
	mpz_set_ui(scale, 1);
	common_denominator(scale, system->states, ask->initial);
	for (int l = 0; l < ask->excitations; l++) {
		const struct excitation *e = &ask->excitation[l];
		common_denominator(scale, 2 * e->powers * system->n, e->force);
		common_denominator(scale, 2 * e->powers, e->direct);
	}
}

/* row k of (M s + C) q(0) + M v(0), row-scaled, for a unit value of one state */
static struct poly unit_state(const struct resolvent *r, int k, int state)
{
	const struct linear *system = r->system;
	int cell = k * system->n + system->coord[state];
	bool velocity = state >= system->n;
	struct poly x = poly_new(2);
	scaled_integer(x.c[0], r->row[k], velocity ? system->M[cell] : system->C[cell]);
	if (!velocity)
		scaled_integer(x.c[1], r->row[k], system->M[cell]);
	poly_trim(&x);
	return x;
}

/* scale * (all denominators) * row k of the right-hand side */
static struct poly right_side(const struct resolvent *r, const struct question *ask, const struct denominators *p,
			      mpz_srcptr scale, int k)
{
	struct poly start = poly_new(0), sum = poly_new(0);
	INTEGER factor = INTEGER_ZERO;
	for (int j = 0; ask->initial && j < r->system->states; j++) {
		if (mpq_sgn(ask->initial[j]) == 0)
			continue;
		scaled_integer(factor, scale, ask->initial[j]);
		start = poly_add(start, poly_scale(unit_state(r, k, j), factor));
	}
	for (int l = 0; l < ask->excitations; l++) {
		const struct excitation *e = &ask->excitation[l];
		struct poly image = excitation_image(e, &p->o[l], e->force + k, r->system->n, scale);
		replace(&image, poly_scale(image, r->row[k]));
		multiply(&image, p->without[l]);
		add(&sum, image);
	}
	multiply(&start, p->all);
	add(&sum, start);
	return sum;
}

/* row i of adj P times a vector of polynomials */
static struct poly adjugate_row(const struct resolvent *r, int i, const struct poly *x)
{
	struct poly sum = poly_new(0);
	for (int k = 0; k < r->adj.n; k++)
		if (x[k].length > 0)
			add(&sum, poly_mul(r->adj.cell[i * r->adj.n + k], x[k]));
	return sum;
}

/* Without the powers that have no factors: a load state has but a few of those of its load. */
static struct question least_powers(const struct question *ask, int n)
{
	struct question least = *ask;
	struct excitation *e = ARRAY(struct excitation, ask->excitations);
	for (int l = 0; l < ask->excitations; l++) {
		e[l] = ask->excitation[l];
		while (e[l].powers > 0 && rationals_zero(2 * (size_t)n, e[l].force + 2 * (e[l].powers - 1) * n) &&
		       rationals_zero(2, e[l].direct + 2 * (e[l].powers - 1)))
			e[l].powers--;
	}
	least.excitation = e;
	return least;
}

struct response *image_of(struct resolvent *r, const struct question *whole)
{
	const struct linear *system = r->system;
	int n = system->n;
	const struct question least = least_powers(whole, n), *ask = &least;
	need_adjugate(r);
	INTEGER scale = INTEGER_ZERO, factor = INTEGER_ZERO, rows = INTEGER_ZERO;
	mpz_set_ui(rows, 1);
	question_scale(ask, system, scale);
	common_denominator(rows, system->states, ask->row);
	struct denominators p = find_denominators(ask);
	struct poly *x = ARRAY(struct poly, n), N = poly_new(0), D = poly_mul(r->B, p.all), direct = poly_new(0);
	for (int k = 0; k < n; k++)
		x[k] = right_side(r, ask, &p, scale, k);
	for (int i = 0; i < system->states; i++) {
		if (mpq_sgn(ask->row[i]) == 0)
			continue;
		int coord = system->coord[i];
		struct poly image = adjugate_row(r, coord, x);
		if (i >= n)                     /* s Q - q(0) */
			image = poly_shift(image, 1);
		if (i >= n && ask->initial) {
			scaled_integer(factor, scale, ask->initial[coord]);
			mpz_neg(factor, factor);
			add(&image, poly_scale(D, factor));
		}
		scaled_integer(factor, rows, ask->row[i]);
		add(&N, poly_scale(image, factor));
		clear_integers(&image.c);
	}
	for (int l = 0; l < ask->excitations; l++) {
		const struct excitation *e = &ask->excitation[l];
		struct poly image = excitation_image(e, &p.o[l], e->direct, 1, scale);
		multiply(&image, p.without[l]);
		add(&direct, image);
	}
	multiply(&direct, r->B);
	add(&N, poly_scale(direct, rows));
	clear_integers(&direct.c);
	for (int k = 0; k < n; k++)
		clear_integers(&x[k].c);
	RATIONAL unit = ZERO;
	mpz_set_ui(mpq_numref(unit), 1);
	mpz_mul(mpq_denref(unit), scale, rows);
	return response_of(unit, N, D);
}

struct response *transient_of(const struct resolvent *r, const struct response *whole, const struct excitation *e)
{
	struct poly pole = oscillation_of(e).D;
	return poly_divides(pole, r->B) ? NULL : response_without(whole, pole, e->a, e->w);
}
