/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Taylor series behind NAME_at: its matrix, and how many terms and halvings of the time it takes.
 * x holds the states, then what a scheme holds, then 1 for a constant load and cos and sin of each wave. */
#include "plgen.h"

enum { LIMIT_RADIANS = 8, LIMIT_DEGREE = 80, BITS = 64 };

static bool acts(const struct linear *system, const struct load *load)
{
	for (int k = 0; k < load->columns; k++)
		for (int i = 0; i < system->n; i++)
			if (mpq_sgn(load->force[k][i]) != 0)
				return true;
	return false;
}

/* ---- the matrix ---- */

static void place_extras(struct series *series, const struct linear *system)
{
	series->size = 2 * system->n;
	series->held = -1;
	if (system->heldK) {
		series->held = series->size;
		series->size += system->n;
	}
	series->load = ARRAY(int, (size_t)system->loads);
	for (int l = 0; l < system->loads; l++) {
		bool active = acts(system, &system->load[l]);
		series->load[l] = active ? series->size : -1;
		series->size += active ? system->load[l].columns : 0;
	}
}

static void fill_matrix(struct series *series, const struct linear *system)
{
	int n = system->n, size = series->size, column;
	mpq_t *A = series->A = rationals((size_t)size * (size_t)size), *inverse = rationals((size_t)(n * n)), *product = rationals((size_t)(n * n));
	rational_inverse(n, (const mpq_t *)system->M, inverse, &column);
	const mpq_t *parts[] = { system->K, system->C };
	for (int k = 0; k < 2; k++) {
		rational_product(n, n, n, (const mpq_t *)inverse, parts[k], product);
		for (int i = 0; i < n; i++)
			for (int j = 0; j < n; j++)
				mpq_neg(A[(n + i) * size + k * n + j], product[i * n + j]);
	}
	for (int i = 0; i < n; i++) {
		mpq_set_ui(A[i * size + n + i], 1, 1);
		if (series->held >= 0)
			mpq_set_ui(A[(n + i) * size + series->held + i], 1, 1);
	}
	for (int l = 0; l < system->loads; l++) {
		const struct load *load = &system->load[l];
		int at = series->load[l];
		if (at < 0)
			continue;
		for (int k = 0; k < load->columns; k++) {
			rational_product(n, n, 1, (const mpq_t *)inverse, (const mpq_t *)load->force[k], product);
			for (int i = 0; i < n; i++)
				mpq_set(A[(n + i) * size + at + k], product[i]);
		}
		if (load->wave) {               /* cos' = -w sin, sin' = w cos */
			mpq_neg(A[at * size + at + 1], load->wave->w);
			mpq_set(A[(at + 1) * size + at], load->wave->w);
		}
	}
}

/* ---- its length ---- */

static void larger_pole(mpfr_ptr largest, const struct rectangle *at)
{
	mpfi_t size;
	mpfr_t right;
	mpfi_init2(size, BITS);
	mpfr_init2(right, BITS);
	mpfi_hypot(size, at->re, at->im);
	mpfi_get_right(right, size);
	mpfr_max(largest, largest, right, MPFR_RNDU);
	mpfi_clear(size);
	mpfr_clear(right);
}

/* max|p| h over the poles of the system and of its loads */
static void largest_angle(const struct step *step, mpfr_ptr angle)
{
	mpz_t content;
	mpz_init(content);
	struct spectrum *spectrum = spectrum_of(poly_primitive(*resolvent_determinant(step->solved), content));
	mpz_clear(content);
	mpfr_init2(angle, BITS);
	mpfr_set_zero(angle, 1);
	if (!spectrum_refine(spectrum, BITS)) {
		mpfr_set_inf(angle, 1);
		return;
	}
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			larger_pole(angle, &spectrum->pole[f][i].at);
	for (int l = 0; l < step->system.loads; l++)
		if (step->series.load[l] >= 0 && step->system.load[l].wave && mpfr_cmp_q(angle, step->system.load[l].wave->w) < 0)
			mpfr_set_q(angle, step->system.load[l].wave->w, MPFR_RNDU);
	mpfr_mul_q(angle, angle, step->model->h, MPFR_RNDU);
}

static mpfr_t *positive_numbers(int count)
{
	mpfr_t *x = ARRAY(mpfr_t, (size_t)count);
	for (int i = 0; i < count; i++) {
		mpfr_init2(x[i], BITS);
		mpfr_set_zero(x[i], 1);
	}
	return x;
}

/* next = |A| dt term / k, entrywise: bounds the k-th term of the series by the (k-1)-th */
static void next_term(int size, const mpfr_t *A, const mpfr_t *term, mpfr_t *next, int k)
{
	mpfr_t product;
	mpfr_init2(product, BITS);
	for (int i = 0; i < size * size; i++)
		mpfr_set_zero(next[i], 1);
	for (int i = 0; i < size; i++)
		for (int l = 0; l < size; l++) {
			if (mpfr_zero_p(A[i * size + l]))
				continue;
			for (int j = 0; j < size; j++) {
				mpfr_mul(product, A[i * size + l], term[l * size + j], MPFR_RNDU);
				mpfr_add(next[i * size + j], next[i * size + j], product, MPFR_RNDU);
			}
		}
	for (int i = 0; i < size * size; i++)
		mpfr_div_ui(next[i], next[i], (unsigned long)k, MPFR_RNDU);
	mpfr_clear(product);
}

/* Is every entry of the term below 2^-56 of the first term that its entry has? */
static bool negligible(int cells, const mpfr_t *term, mpfr_t *first)
{
	bool small = true;
	mpfr_t limit;
	mpfr_init2(limit, BITS);
	for (int i = 0; i < cells; i++) {
		if (mpfr_zero_p(first[i])) {
			mpfr_set(first[i], term[i], MPFR_RNDD);
			small = small && mpfr_zero_p(term[i]);
			continue;
		}
		mpfr_mul_2si(limit, first[i], -56, MPFR_RNDD);
		small = small && mpfr_lessequal_p(term[i], limit);
	}
	mpfr_clear(limit);
	return small;
}

/* The first degree after which two terms in a row are negligible. */
static int series_degree(const struct series *series, mpq_srcptr h)
{
	int size = series->size, cells = size * size, quiet = 0, k = 0;
	mpfr_t *A = positive_numbers(cells), *term = positive_numbers(cells), *next = positive_numbers(cells), *first = positive_numbers(cells);
	for (int i = 0; i < cells; i++) {
		mpfr_set_q(A[i], series->A[i], MPFR_RNDN);
		mpfr_mul_q(A[i], A[i], h, MPFR_RNDN);
		mpfr_div_2ui(A[i], A[i], (unsigned long)series->halvings, MPFR_RNDN);
		mpfr_abs(A[i], A[i], MPFR_RNDU);
		mpfr_set_ui(term[i], i % size == i / size, MPFR_RNDN);
		mpfr_set(first[i], term[i], MPFR_RNDN);
	}
	while (quiet < 2 && k < LIMIT_DEGREE) {
		next_term(size, (const mpfr_t *)A, (const mpfr_t *)term, next, ++k);
		quiet = negligible(cells, (const mpfr_t *)next, first) && k >= size / 2 ? quiet + 1 : 0;
		mpfr_t *swap = term;
		term = next;
		next = swap;
	}
	return k - quiet > 0 ? k - quiet : 1;
}

void series_plan(struct step *step)
{
	struct series *series = &step->series;
	mpfr_t angle;
	place_extras(series, &step->system);
	largest_angle(step, angle);
	series->emitted = mpfr_cmp_ui(angle, LIMIT_RADIANS) <= 0;
	if (series->emitted) {
		fill_matrix(series, &step->system);
		for (series->halvings = 0; mpfr_cmp_ui(angle, 1) > 0; series->halvings++)
			mpfr_div_2ui(angle, angle, 1, MPFR_RNDU);
		series->degree = series_degree(series, step->model->h);
	}
	mpfr_clear(angle);
}
