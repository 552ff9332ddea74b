/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Laplace images N/D of what a step is made of. From M q'' + C q' + K q = force - heldC v(0) - heldK q(0):
 *     P(s) Q(s) = (M s + C) q(0) + M v(0) + F(s) - (heldK q(0) + heldC v(0))/s,      V(s) = s Q(s) - q(0)
 * and P^-1 = adj P / B. Rows are scaled by integers so that all of this stays in Z[s]. */
#include "plgen.h"

struct resolvent {
	const struct linear *system;
	struct polymat adj;         /* of the row-scaled P(s) */
	struct poly B;              /* its determinant */
	mpz_t *row;                 /* scale of each row */
};

/* ---- scaling ---- */

static void common_denominator(mpz_ptr common, size_t count, const mpq_t *q)
{
	for (size_t i = 0; i < count && q; i++)
		mpz_lcm(common, common, mpq_denref(q[i]));
}

/* factor * q, which is an integer */
static void scaled_integer(mpz_ptr z, mpz_srcptr factor, mpq_srcptr q)
{
	mpz_divexact(z, factor, mpq_denref(q));
	mpz_mul(z, z, mpq_numref(q));
}

static struct poly linear_poly(mpz_srcptr constant, mpz_srcptr slope)
{
	struct poly p = poly_new(2);
	mpz_set(p.c[0], constant);
	mpz_set(p.c[1], slope);
	poly_trim(&p);
	return p;
}

struct resolvent *resolvent_of(const struct linear *system)
{
	int n = system->n;
	struct resolvent *r = NEW(struct resolvent);
	struct polymat P = { n, ARRAY(struct poly, (size_t)(n * n)) };
	r->system = system;
	r->row = ARRAY(mpz_t, (size_t)n);
	for (int i = 0; i < n; i++) {
		const mpq_t *rows[] = { system->M, system->C, system->K, system->heldC, system->heldK };
		mpz_init_set_ui(r->row[i], 1);
		for (int k = 0; k < 5; k++)
			common_denominator(r->row[i], (size_t)n, rows[k] ? rows[k] + i * n : NULL);
		for (int j = 0; j < n; j++) {
			struct poly *cell = &P.cell[i * n + j];
			*cell = poly_new(3);
			for (int k = 0; k < 3; k++)
				scaled_integer(cell->c[k], r->row[i], rows[2 - k][i * n + j]);
			poly_trim(cell);
		}
	}
	r->adj = (struct polymat){ n, ARRAY(struct poly, (size_t)(n * n)) };
	polymat_adjugate(P, &r->B, &r->adj);
	return r;
}

void characteristic_polynomial(const struct resolvent *r, mpq_t *coefficient)
{
	mpz_t scale;
	mpz_init_set_ui(scale, 1);
	for (int i = 0; i < r->system->n; i++)
		mpz_mul(scale, scale, r->row[i]);
	for (int k = 0; k < r->B.length; k++) {
		mpz_set(mpq_numref(coefficient[k]), r->B.c[k]);
		mpz_set(mpq_denref(coefficient[k]), scale);
		mpq_canonicalize(coefficient[k]);
	}
	mpz_clear(scale);
}

const struct poly *resolvent_determinant(const struct resolvent *r)
{
	return &r->B;
}

/* row i of adj P times a vector of polynomials */
static struct poly adjugate_row(const struct resolvent *r, int i, const struct poly *x)
{
	struct poly sum = poly_new(0);
	for (int k = 0; k < r->adj.n; k++)
		if (x[k].length > 0)
			sum = poly_add(sum, poly_mul(r->adj.cell[i * r->adj.n + k], x[k]));
	return sum;
}

/* ---- Phi ---- */

/* The right-hand side for a unit initial state j, times s if something is held; true if so. */
static bool unit_state(const struct resolvent *r, int j, struct poly *x)
{
	const struct linear *system = r->system;
	int n = system->n, c = j % n;
	bool velocity = j >= n, any = false;
	const mpq_t *held = velocity ? system->heldC : system->heldK;
	for (int k = 0; k < n; k++)
		any = any || (held && mpq_sgn(held[k * n + c]) != 0);
	mpz_t a, b;
	mpz_inits(a, b, NULL);
	for (int k = 0; k < n; k++) {
		scaled_integer(a, r->row[k], velocity ? system->M[k * n + c] : system->C[k * n + c]);
		if (velocity)
			mpz_set_ui(b, 0);
		else
			scaled_integer(b, r->row[k], system->M[k * n + c]);
		x[k] = linear_poly(a, b);
		if (any) {
			scaled_integer(a, r->row[k], held[k * n + c]);
			mpz_neg(a, a);
			mpz_set_ui(b, 0);
			x[k] = poly_add(poly_shift(x[k], 1), linear_poly(a, b));
		}
	}
	mpz_clears(a, b, NULL);
	return any;
}

struct response *image_of_state(struct resolvent *r, int i, int j)
{
	int n = r->system->n;
	struct poly *x = ARRAY(struct poly, (size_t)n);
	bool held = unit_state(r, j, x);
	struct poly D = held ? poly_shift(r->B, 1) : r->B, N = adjugate_row(r, i % n, x);
	if (i >= n) {
		N = poly_shift(N, 1);
		if (i - n == j)
			N = poly_sub(N, D);
	}
	mpq_t one;
	mpq_init(one);
	mpq_set_ui(one, 1, 1);
	struct response *response = response_of(one, N, D);
	mpq_clear(one);
	return response;
}

/* ---- loads ---- */

/* den(w)^2 (s^2 + w^2) */
static struct poly wave_denominator(const struct wave *wave)
{
	struct poly D = poly_new(3);
	mpz_mul(D.c[0], mpq_numref(wave->w), mpq_numref(wave->w));
	mpz_mul(D.c[2], mpq_denref(wave->w), mpq_denref(wave->w));
	return D;
}

/* den(w)^2 (c s + d w), times the integer `factor`; c and d rational, factor c and factor d w integers */
static struct poly wave_numerator(const struct wave *wave, mpq_srcptr c, mpq_srcptr d, mpz_srcptr factor)
{
	mpz_t slope, constant, square;
	mpq_t product;
	mpz_inits(slope, constant, square, NULL);
	mpq_init(product);
	mpz_mul(square, mpq_denref(wave->w), mpq_denref(wave->w));
	scaled_integer(slope, factor, c);
	mpz_mul(slope, slope, square);
	mpq_mul(product, d, wave->w);
	mpz_mul(square, square, factor);
	scaled_integer(constant, square, product);
	struct poly N = linear_poly(constant, slope);
	mpz_clears(slope, constant, square, NULL);
	mpq_clear(product);
	return N;
}

/* Force of one load in row k when z = (1, 0) (column 0) or (0, 1) (column 1) at the start:
 * cos(wt): c s/(s^2+w^2) + d w/(s^2+w^2) with (c, d) = (cos factor, sin factor), or (sin factor, -cos factor). */
static void wave_factors(const struct load *load, int column, int k, mpq_ptr c, mpq_ptr d)
{
	mpq_set(c, load->force[column][k]);
	mpq_set(d, load->force[1 - column][k]);
	if (column == 1)
		mpq_neg(d, d);
}

struct response *image_of_load(struct resolvent *r, int i, int l, int column)
{
	const struct load *load = &r->system->load[l];
	int n = r->system->n;
	struct poly *x = ARRAY(struct poly, (size_t)n), D = poly_shift(r->B, 1);
	mpz_t factor, scaled, zero;
	mpq_t c, d, scale;
	mpz_init_set_ui(factor, 1);
	mpz_inits(scaled, zero, NULL);
	mpq_inits(c, d, scale, NULL);
	for (int k = 0; k < load->columns; k++)
		common_denominator(factor, (size_t)n, load->force[k]);
	for (int k = 0; k < n; k++) {
		if (load->wave) {
			wave_factors(load, column, k, c, d);
			x[k] = poly_scale(wave_numerator(load->wave, c, d, factor), r->row[k]);
		} else {
			scaled_integer(scaled, factor, load->force[0][k]);
			mpz_mul(scaled, scaled, r->row[k]);
			x[k] = linear_poly(scaled, zero);
		}
	}
	if (load->wave)
		D = poly_mul(r->B, wave_denominator(load->wave));
	struct poly N = adjugate_row(r, i % n, x);
	if (i >= n)
		N = poly_shift(N, 1);
	mpz_set(mpq_denref(scale), factor);
	mpz_set_ui(mpq_numref(scale), 1);
	struct response *response = response_of(scale, N, D);
	mpz_clears(factor, scaled, zero, NULL);
	mpq_clears(c, d, scale, NULL);
	return response;
}

/* ---- the whole solution from the start ---- */

/* cos p and sin p: irrational unless p = 0, then rationals of 256 bits */
static void wave_start(const struct wave *wave, mpq_ptr c, mpq_ptr s)
{
	struct place nowhere = { 0 };
	constant_function(nowhere, FN_COS, wave->p, c);
	constant_function(nowhere, FN_SIN, wave->p, s);
}

/* All denominators of the loads, with s^2 for constants and t: G; and G / (denominator of load l). */
static struct poly load_product(const struct linear *system, int without)
{
	struct poly G = poly_new(1);
	mpz_set_ui(G.c[0], 1);
	for (int l = 0; l < system->loads; l++)
		if (l != without && system->load[l].wave)
			G = poly_mul(G, wave_denominator(system->load[l].wave));
	return G;
}

/* Everything rational that enters the solution has a denominator that divides this. */
static void solution_scale(const struct resolvent *r, const mpq_t *initial, const struct output *output, mpz_ptr scale)
{
	const struct linear *system = r->system;
	mpq_t c, s;
	mpq_inits(c, s, NULL);
	mpz_set_ui(scale, 1);
	common_denominator(scale, 2 * (size_t)system->n, initial);
	mpz_t forces, phases, rows;
	mpz_init_set_ui(forces, 1);
	mpz_init_set_ui(phases, 1);
	mpz_init_set_ui(rows, 1);
	for (int l = 0; l < system->loads; l++) {
		for (int k = 0; k < system->load[l].columns; k++)
			common_denominator(forces, (size_t)system->n, system->load[l].force[k]);
		if (system->load[l].wave) {
			wave_start(system->load[l].wave, c, s);
			mpz_lcm(phases, phases, mpq_denref(c));
			mpz_lcm(phases, phases, mpq_denref(s));
		}
		mpz_lcm(rows, rows, mpq_denref(output->load[0][l]));
		mpz_lcm(rows, rows, mpq_denref(output->load[1][l]));
	}
	mpz_mul(forces, forces, phases);
	mpz_mul(phases, phases, rows);
	mpz_lcm(scale, scale, forces);
	mpz_lcm(scale, scale, phases);
	mpz_lcm(scale, scale, mpq_denref(output->constant));
	mpz_lcm(scale, scale, mpq_denref(output->time));
	mpz_clears(forces, phases, rows, NULL);
	mpq_clears(c, s, NULL);
}

/* scale * s^2 G * (image of a load's cos(wt+p) factor a + sin(wt+p) factor b) */
static struct poly wave_image(const struct linear *system, int l, mpq_srcptr a, mpq_srcptr b, mpz_srcptr scale)
{
	const struct wave *wave = system->load[l].wave;
	mpq_t c, s, slope, constant, product;
	mpq_inits(c, s, slope, constant, product, NULL);
	wave_start(wave, c, s);
	mpq_mul(slope, a, c);                   /* a cos(wt+p) + b sin(wt+p) = (a cos p + b sin p) cos wt + (b cos p - a sin p) sin wt */
	mpq_mul(product, b, s);
	mpq_add(slope, slope, product);
	mpq_mul(constant, b, c);
	mpq_mul(product, a, s);
	mpq_sub(constant, constant, product);
	struct poly image = poly_mul(wave_numerator(wave, slope, constant, scale), poly_shift(load_product(system, l), 2));
	mpq_clears(c, s, slope, constant, product, NULL);
	return image;
}

static struct poly constant_image(const struct linear *system, mpq_srcptr value, mpz_srcptr scale, int power)
{
	mpz_t factor;
	mpz_init(factor);
	scaled_integer(factor, scale, value);
	struct poly image = poly_shift(poly_scale(load_product(system, -1), factor), power);
	mpz_clear(factor);
	return image;
}

/* scale * s^2 G * row k of (M s + C) q(0) + M v(0) + F(s), row-scaled */
static struct poly start_and_loads(const struct resolvent *r, const mpq_t *initial, mpz_srcptr scale, int k)
{
	const struct linear *system = r->system;
	int n = system->n;
	struct poly sum = poly_new(0), unit = poly_shift(load_product(system, -1), 2);
	struct poly *x = ARRAY(struct poly, (size_t)n);
	mpz_t factor;
	mpz_init(factor);
	for (int j = 0; j < 2 * n; j++) {
		if (mpq_sgn(initial[j]) == 0)
			continue;
		unit_state(r, j, x);
		scaled_integer(factor, scale, initial[j]);
		sum = poly_add(sum, poly_mul(poly_scale(x[k], factor), unit));
	}
	for (int l = 0; l < system->loads; l++) {
		const struct load *load = &system->load[l];
		struct poly image = load->wave ? wave_image(system, l, load->force[0][k], load->force[1][k], scale)
					       : constant_image(system, load->force[0][k], scale, 1);
		sum = poly_add(sum, poly_scale(image, r->row[k]));
	}
	mpz_clear(factor);
	return sum;
}

struct response *image_of_solution(struct resolvent *r, const mpq_t *initial, const struct output *output)
{
	const struct linear *system = r->system;
	int n = system->n;
	mpz_t scale, rows, factor;
	mpz_inits(scale, factor, NULL);
	mpz_init_set_ui(rows, 1);
	solution_scale(r, initial, output, scale);
	common_denominator(rows, 2 * (size_t)n, output->state);
	struct poly *x = ARRAY(struct poly, (size_t)n), N = poly_new(0), G = poly_shift(load_product(system, -1), 2), D = poly_mul(r->B, G);
	for (int k = 0; k < n; k++)
		x[k] = start_and_loads(r, initial, scale, k);
	for (int i = 0; i < 2 * n; i++) {
		if (mpq_sgn(output->state[i]) == 0)
			continue;
		struct poly image = adjugate_row(r, i % n, x);
		if (i >= n) {                   /* s Q - q(0) */
			scaled_integer(factor, scale, initial[i - n]);
			image = poly_sub(poly_shift(image, 1), poly_scale(D, factor));
		}
		scaled_integer(factor, rows, output->state[i]);
		N = poly_add(N, poly_scale(image, factor));
	}
	struct poly direct = poly_add(constant_image(system, output->constant, scale, 1), constant_image(system, output->time, scale, 0));
	for (int l = 0; l < system->loads; l++)
		if (system->load[l].wave)
			direct = poly_add(direct, wave_image(system, l, output->load[0][l], output->load[1][l], scale));
	N = poly_add(N, poly_scale(poly_mul(direct, r->B), rows));
	mpq_t unit;
	mpq_init(unit);
	mpz_mul(mpq_denref(unit), scale, rows);
	mpz_set_ui(mpq_numref(unit), 1);
	struct response *response = response_of(unit, N, D);
	mpz_clears(scale, rows, factor, NULL);
	mpq_clear(unit);
	return response;
}

/* cos(w t) or sin(w t) */
struct response *image_of_wave(const struct wave *wave, bool sine)
{
	mpq_t c, d;
	mpz_t one;
	mpq_inits(c, d, NULL);
	mpz_init_set_ui(one, 1);
	mpq_set_ui(sine ? d : c, 1, 1);
	struct poly N = wave_numerator(wave, c, d, one);
	mpq_set_ui(c, 1, 1);
	struct response *response = response_of(c, N, wave_denominator(wave));
	mpq_clears(c, d, NULL);
	mpz_clear(one);
	return response;
}
