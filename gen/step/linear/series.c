/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Taylor series behind NAME_at: how many terms and halvings of the time it takes.
 * x holds the states, then what a scheme holds, then the load states, then the inputs (with their slopes). */
#include "inner.h"

enum { LIMIT_RADIANS = 8, LIMIT_PARTS = 1 << 20, LIMIT_DEGREE = 80, BITS = 64, POLE_BITS = 128 };

static void larger_pole(mpfr_ptr largest, const struct rectangle *at)
{
	INTERVAL size = OVER_BITS(BITS);
	REAL right = WITH_BITS(BITS);
	mpfi_hypot(size, at->re, at->im);
	mpfi_get_right(right, size);
	mpfr_max(largest, largest, right, MPFR_RNDU);
}

static void larger_forcing(mpfr_ptr largest, const struct forcing *forcing)
{
	REAL a = WITH_BITS(BITS), w = WITH_BITS(BITS);
	mpfr_set_q(a, forcing->a, MPFR_RNDA);
	mpfr_set_q(w, forcing->w, MPFR_RNDA);
	mpfr_hypot(a, a, w, MPFR_RNDU);
	mpfr_max(largest, largest, a, MPFR_RNDU);
}

static void larger_poles(mpfr_ptr largest, const struct resolvent *resolvent)
{
	struct spectrum *spectrum = resolvent_spectrum(resolvent);
	/* as the residues begin: fewer bits may bring two iterates of a cluster together for good */
	if (!spectrum_refine(spectrum, POLE_BITS)) {
		mpfr_set_inf(largest, 1);
		return;
	}
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			larger_pole(largest, &spectrum->pole[f][i].at);
}

/* max|p| h over the poles of the operators and of the loads */
/* Of the operators from `from` to before `to`, and of loads */
static void largest_angle(const struct step *step, int from, int to, mpfr_ptr angle)
{
	mpfr_set_zero(angle, 1);
	for (int k = from; k < to; k++)
		larger_poles(angle, step->branch[k].resolvent);
	for (int l = 0; l < step->branch->system.loads; l++)
		if (step->layout.load[l] >= 0)
			larger_forcing(angle, step->branch->system.load[l].forcing);
	mpfr_mul_q(angle, angle, step->model->h, MPFR_RNDU);
}

double largest_pole_angle(const struct step *step)
{
	REAL angle = WITH_BITS(BITS);
	mpfr_set_zero(angle, 1);
	larger_poles(angle, step->branch->resolvent);
	mpfr_mul_q(angle, angle, step->model->h, MPFR_RNDU);
	return mpfr_get_d(angle, MPFR_RNDU);
}

/* next = |A| dt term / k, entrywise: bounds the k-th term of the series by the (k-1)-th */
static void next_term(int size, const mpfr_t *A, const mpfr_t *term, mpfr_t *next, int k)
{
	REAL product = WITH_BITS(BITS);
	for (int i = 0; i < size * size; i++)
		mpfr_set_zero(next[i], 1);
	for (int i = 0; i < size; i++)
		for (int l = 0; l < size; l++) {
			if (mpfr_zero_p(A[i * size + l]))
				continue;
			for (int j = 0; j < size; j++) {
				if (mpfr_zero_p(term[l * size + j]))
					continue;
				mpfr_mul(product, A[i * size + l], term[l * size + j], MPFR_RNDU);
				mpfr_add(next[i * size + j], next[i * size + j], product, MPFR_RNDU);
			}
		}
	for (int i = 0; i < size * size; i++)
		if (!mpfr_zero_p(next[i]))
			mpfr_div_ui(next[i], next[i], (unsigned long)k, MPFR_RNDU);
}

/* Is every entry of the term below 2^-56 of the first term that its entry has? */
static bool negligible(int cells, const mpfr_t *term, mpfr_t *first)
{
	bool small = true;
	REAL limit = WITH_BITS(BITS);
	for (int i = 0; i < cells; i++) {
		if (mpfr_zero_p(first[i])) {
			mpfr_set(first[i], term[i], MPFR_RNDD);
			small = small && mpfr_zero_p(term[i]);
			continue;
		}
		mpfr_mul_2si(limit, first[i], -56, MPFR_RNDD);
		small = small && mpfr_lessequal_p(term[i], limit);
	}
	return small;
}

/* The largest size that each entry has in any segment of time */
static void add_envelope(mpfr_t *A, int cells, const mpq_t *segment)
{
	REAL size = WITH_BITS(BITS);
	for (int i = 0; i < cells; i++) {
		mpfr_set_q(size, segment[i], MPFR_RNDU);
		mpfr_abs(size, size, MPFR_RNDU);
		mpfr_max(A[i], A[i], size, MPFR_RNDU);
	}
}

/* The first degree after which two terms in a row are negligible, for any of the operators from `first` to before
 * `last`. */
int series_degree(const struct step *step, int from, int to, int halvings)
{
	int size = step->layout.size, cells = size * size, quiet = 0, k = 0;
	REALS *A = reals(cells, BITS), *term = reals(cells, BITS), *next = reals(cells, BITS),
	      *first = reals(cells, BITS);
	for (int o = from; o < to; o++)
		for (int s = 0; s < step->branch->system.segments; s++) {
			RATIONALS *matrix = augmented_matrix(&step->layout, &step->branch[o].system, s);
			add_envelope(A, cells, matrix);
		}
	for (int i = 0; i < cells; i++) {
		mpfr_mul_q(A[i], A[i], step->model->h, MPFR_RNDN);
		mpfr_div_2ui(A[i], A[i], (unsigned long)halvings, MPFR_RNDN);
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

int series_halvings(const struct step *step, int operator)
{
	int halvings = 0;
	REAL angle = WITH_BITS(BITS);
	largest_angle(step, operator, operator + 1, angle);
	for (; mpfr_cmp_ui(angle, 1) > 0 && halvings <= 30; halvings++)
		mpfr_div_2ui(angle, angle, 1, MPFR_RNDU);
	return halvings;
}

void series_plan(struct step *step)
{
	struct series *series = &step->series;
	REAL angle = WITH_BITS(BITS);
	largest_angle(step, 0, step->branches, angle);
	/* the remainder is a polynomial in the step, or there is none */
	bool known = !has_remainder(step) || step->layout.powers > 0;
	series->emitted = known && mpfr_cmp_ui(angle, LIMIT_RADIANS) <= 0;
	if (series->emitted || (loads_change(&step->branch->system) && mpfr_cmp_ui(angle, LIMIT_PARTS) <= 0)) {
		for (series->halvings = 0; mpfr_cmp_ui(angle, 1) > 0; series->halvings++)
			mpfr_div_2ui(angle, angle, 1, MPFR_RNDU);
		series->degree = series_degree(step, 0, step->branches, series->halvings);
	}
}
