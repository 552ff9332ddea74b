/* SPDX-License-Identifier: GPL-3.0-or-later */
/* x' = A x, enclosed: x(tau) as a Taylor polynomial with its remainder, and over pieces by powers of e^{A d}. */
#include "math/math.h"

#include <math.h>
#include <string.h>

enum { SWEEPS = 30, FARTHEST = 200 };

/* ---- scales: ||D^-1 |A| D|| small, D powers of two ---- */

static double row_sum(const struct stream *f, const double *A, int i, bool column)
{
	double sum = 0;
	for (int j = 0; j < f->n; j++)
		if (j != i)
			sum += column ? A[j * f->n + i] * f->scale[i] / f->scale[j]
				      : A[i * f->n + j] * f->scale[j] / f->scale[i];
	return sum;
}

static void scale_by(struct stream *f, int i, int power)
{
	double scale = ldexp(f->scale[i], power);
	if (fabs(log2(scale)) <= FARTHEST)
		f->scale[i] = scale;
}

/* Osborne's balancing. What nothing acts on, or what acts on nothing, is scaled until it is no more than `least`. */
static void balance(struct stream *f, const double *A, double least)
{
	for (int sweep = 0; sweep < SWEEPS; sweep++)
		for (int i = 0; i < f->n; i++) {
			double row = row_sum(f, A, i, false), column = row_sum(f, A, i, true);
			if (row > 0 && column > 0)
				scale_by(f, i, (int)rint(log2(row / column) / 2));
			else if (row > least)
				scale_by(f, i, (int)ceil(log2(row / least)));
			else if (column > least)
				scale_by(f, i, -(int)ceil(log2(column / least)));
		}
}

static double largest_row(const struct stream *f, const double *A)
{
	double largest = 0;
	for (int i = 0; i < f->n; i++)
		largest = fmax(largest, row_sum(f, A, i, false) + A[i * f->n + i]);
	return largest * (1 + 1e-9);
}

/* ---- the matrix ---- */

static void take_entries(struct stream *f, const mpq_t *A)
{
	int count = 0;
	f->first = ARRAY(int, f->n + 1);
	f->column = ARRAY(int, (size_t)(f->n * f->n));
	for (int i = 0; i < f->n; i++) {
		for (int j = 0; j < f->n; j++)
			if (mpq_sgn(A[i * f->n + j]) != 0)
				f->column[count++] = j;
		f->first[i + 1] = count;
	}
	f->entry = enclosures(count, f->precision);
	for (int i = 0; i < f->n; i++)
		for (int k = f->first[i]; k < f->first[i + 1]; k++)
			mpfi_set_q(f->entry[k], A[i * f->n + f->column[k]]);
}

struct stream *stream_of(int n, const mpq_t *A, mpq_srcptr h, int precision)
{
	struct stream *f = NEW(struct stream);
	double *size = ARRAY(double, (size_t)(n * n)), whole = mpq_get_d(h);
	f->n = n;
	f->precision = precision;
	f->scale = ARRAY(double, n);
	for (int i = 0; i < n * n; i++)
		size[i] = fabs(mpq_get_d(A[i])) * (1 + 1e-15);
	for (int i = 0; i < n; i++)
		f->scale[i] = 1;
	balance(f, size, 0.25 / whole);
	f->rate = largest_row(f, size);
	f->size = size;
	take_entries(f, A);
	mpq_init(f->piece);
	mpq_set(f->piece, h);
	while (f->rate * mpq_get_d(f->piece) > 1 && f->halvings < STREAM_HALVINGS) {
		mpq_div_2exp(f->piece, f->piece, 1);
		f->halvings++;
	}
	return f;
}

void stream_free(struct stream *f)
{
	clear_intervals(&f->entry);
	for (int p = 0; p < f->powers; p++)
		clear_intervals(&f->power[p]);
	mpq_clear(f->piece);
}

/* ---- the Taylor polynomial ---- */

/* ||D^-1 x||, rounded up */
static void scaled_size(const struct stream *f, const mpfi_t *x, mpfr_ptr size)
{
	REAL one = WITH_BITS(64);
	mpfr_set_zero(size, 1);
	for (int i = 0; i < f->n; i++) {
		mpfi_mag(one, x[i]);
		mpfr_div_d(one, one, f->scale[i], MPFR_RNDU);
		mpfr_max(size, size, one, MPFR_RNDU);
	}
}

void stream_slope(const struct stream *f, const mpfi_t *x, mpfi_t *y)
{
	INTERVAL part = OVER_BITS(f->precision);
	for (int i = 0; i < f->n; i++) {
		mpfi_set_ui(y[i], 0);
		for (int k = f->first[i]; k < f->first[i + 1]; k++) {
			mpfi_mul(part, f->entry[k], x[f->column[k]]);
			mpfi_add(y[i], y[i], part);
		}
	}
}

static void widen(mpfi_ptr x, mpfr_srcptr radius)
{
	mpfr_sub(&x->left, &x->left, radius, MPFR_RNDD);
	mpfr_add(&x->right, &x->right, radius, MPFR_RNDU);
}

static void widen_all(const struct stream *f, mpfi_t *x, mpfr_srcptr size)
{
	REAL radius = WITH_BITS(64);
	for (int i = 0; i < f->n && !mpfr_zero_p(size); i++) {
		mpfr_mul_d(radius, size, f->scale[i], MPFR_RNDU);
		widen(x[i], radius);
	}
}

struct taylor_terms {
	mpfr_t size, largest;
	mpfi_t tau;
	double angle;               /* ||D^-1 |A| D|| tau, and a thousandth more */
};

/* Whether what follows the term m is nothing; then its size bounds it */
static bool is_done(const struct stream *f, const struct series_room *room, struct taylor_terms *t, int m)
{
	double shrinks = t->angle / (m + 1);
	scaled_size(f, room->term[m], t->size);
	if (mpfr_cmp(t->size, t->largest) > 0)
		mpfr_set(t->largest, t->size, MPFR_RNDU);
	if (mpfr_zero_p(t->size))
		return true;
	if (shrinks > 0.5 || mpfr_get_exp(t->size) > mpfr_get_exp(t->largest) - f->precision)
		return false;
	mpfr_mul_d(t->size, t->size, 4 * shrinks, MPFR_RNDU);
	return true;
}

static mpfi_t *term_at(const struct stream *f, struct series_room *room, int m)
{
	if (m >= room->terms) {
		ENLARGE(room->term, (size_t)m + 1);
		room->term[m] = enclosures(f->n, f->precision);
		room->terms = m + 1;
	}
	return room->term[m];
}

int stream_expand(const struct stream *f, const mpfi_t *x, mpq_srcptr tau, struct series_room *room)
{
	struct taylor_terms t = { .angle = f->rate * mpq_get_d(tau) * 1.001 };
	int m = 0;
	mpfr_inits2(64, t.size, t.largest, NULL);
	mpfr_set_zero(t.largest, 1);
	mpfi_init2(t.tau, f->precision);
	mpfi_set_q(t.tau, tau);
	for (int i = 0; i < f->n; i++)
		mpfi_set(term_at(f, room, 0)[i], x[i]);
	while (!is_done(f, room, &t, m)) {
		mpfi_t *next = term_at(f, room, m + 1);
		stream_slope(f, room->term[m], next);
		m++;
		for (int i = 0; i < f->n; i++) {
			mpfi_mul(next[i], next[i], t.tau);
			mpfi_div_ui(next[i], next[i], (unsigned long)m);
		}
	}
	widen_all(f, room->term[0], t.size);
	mpfr_clears(t.size, t.largest, NULL);
	mpfi_clear(t.tau);
	return m;
}

static void take_term(const struct stream *f, const struct series_room *core, int m, const double *width,
		      long unit, struct series_room *room)
{
	REAL radius = WITH_BITS(64);
	mpfi_t *term = term_at(f, room, m);
	for (int i = 0; i < f->n; i++) {
		mpfr_set_d(radius, width[i], MPFR_RNDU);
		mpfr_mul_2si(radius, radius, unit, MPFR_RNDU);
		mpfi_set(term[i], core->term[m][i]);
		mpfi_increase(term[i], radius);
	}
}

/* What follows the last term shrinks by half at least, as stream_expand has seen to. */
void stream_widen(const struct stream *f, const struct series_room *core, int degree, const double *width,
		  long unit, mpq_srcptr tau, struct series_room *room)
{
	SCRATCH double *term = ARRAY(double, f->n), *next = ARRAY(double, f->n), *first = ARRAY(double, f->n);
	const double time = mpq_get_d(tau) * (1 + 1e-9);
	double size = 0;
	memcpy(term, width, (size_t)f->n * sizeof *term);
	(void)term_at(f, room, 0);
	for (int m = 1; m <= degree + 1; m++) {
		for (int i = 0; i < f->n; i++) {
			next[i] = 0;
			for (int k = f->first[i]; k < f->first[i + 1]; k++)
				next[i] += f->size[i * f->n + f->column[k]] * term[f->column[k]] * time / m;
		}
		memcpy(term, next, (size_t)f->n * sizeof *term);
		if (m <= degree)
			take_term(f, core, m, term, unit, room);
	}
	for (int i = 0; i < f->n; i++)
		size = fmax(size, 2.5 * term[i] / f->scale[i]);
	for (int i = 0; i < f->n; i++)
		first[i] = (width[i] + size * f->scale[i]) * (1 + 1e-9);
	take_term(f, core, 0, first, unit, room);
}

void stream_sum(const struct stream *f, const struct series_room *room, int degree, mpfr_srcptr s, mpfi_t *x)
{
	for (int i = 0; i < f->n; i++) {
		mpfi_set(x[i], room->term[degree][i]);
		for (int m = degree - 1; m >= 0; m--) {
			mpfi_mul_fr(x[i], x[i], s);
			mpfi_add(x[i], x[i], room->term[m][i]);
		}
	}
}

double stream_rates(const struct stream *before, const struct stream *after)
{
	return (before->rate + (after ? largest_row(before, after->size) : 0)) * (1 + 1e-9);
}

/* To the time of the change and back, by Taylor: x + s (A_before - A_after) x and what is of second order in s. Where
 * both give x the same derivative but for its own width, nothing of first order is lost. */
bool stream_change_within(const struct stream *before, const struct stream *after, mpfi_srcptr time, mpfi_t *x)
{
	INTERVALS *old = enclosures(before->n, before->precision), *new = enclosures(before->n, before->precision);
	REAL angle = WITH_BITS(64), size = WITH_BITS(64);
	mpfi_mag(angle, time);
	mpfr_mul_d(angle, angle, stream_rates(before, after), MPFR_RNDU);
	scaled_size(before, x, size);
	mpfr_mul(size, size, angle, MPFR_RNDU);
	mpfr_mul(size, size, angle, MPFR_RNDU);
	mpfr_mul_2ui(size, size, 1, MPFR_RNDU);
	stream_slope(before, x, old);
	if (after)
		stream_slope(after, x, new);
	for (int i = 0; i < before->n; i++) {
		mpfi_sub(old[i], old[i], new[i]);
		mpfi_mul(old[i], old[i], time);
		mpfi_add(x[i], x[i], old[i]);
	}
	widen_all(before, x, size);
	bool short_enough = mpfr_cmp_d(angle, 0.5) <= 0;
	return short_enough;
}

bool stream_change(const struct stream *before, const struct stream *after, mpfr_srcptr delta, mpfi_t *x)
{
	INTERVAL time = OVER_BITS(64);
	mpfr_neg(&time->left, delta, MPFR_RNDD);
	mpfr_set(&time->right, delta, MPFR_RNDU);
	bool short_enough = stream_change_within(before, after, time, x);
	return short_enough;
}

/* ---- pieces ---- */

static void first_power(struct stream *f, mpfi_t *E)
{
	int n = f->n;
	struct series_room room = { 0 };
	INTERVALS *x = enclosures(n, f->precision);
	REAL one = WITH_BITS(2);
	mpfr_set_ui(one, 1, MPFR_RNDN);
	for (int j = 0; j < n; j++) {
		for (int i = 0; i < n; i++)
			mpfi_set_ui(x[i], i == j);
		int degree = stream_expand(f, x, f->piece, &room);
		stream_sum(f, &room, degree, one, x);
		for (int i = 0; i < n; i++)
			mpfi_set(E[i * n + j], x[i]);
	}
	series_room_free(&room);
}

static void times(int n, const mpfi_t *E, const mpfi_t *x, int stride, mpfi_t *y)
{
	INTERVAL part = OVER_BITS(mpfi_get_prec(y[0]));
	for (int i = 0; i < n; i++) {
		mpfi_set_ui(y[i * stride], 0);
		for (int k = 0; k < n; k++) {
			if (mpfr_zero_p(&E[i * n + k]->left) && mpfr_zero_p(&E[i * n + k]->right))
				continue;
			mpfi_mul(part, E[i * n + k], x[k * stride]);
			mpfi_add(y[i * stride], y[i * stride], part);
		}
	}
}

void stream_pieces(struct stream *f, int power, const mpfi_t *x, mpfi_t *y)
{
	int n = f->n;
	for (; f->powers <= power; f->powers++) {
		ENLARGE(f->power, (size_t)f->powers + 1);
		mpfi_t *E = f->power[f->powers] = enclosures(n * n, f->precision);
		if (f->powers == 0)
			first_power(f, E);
		for (int j = 0; j < n && f->powers > 0; j++)
			times(n, f->power[f->powers - 1], f->power[f->powers - 1] + j, n, E + j);
	}
	times(n, f->power[power], x, 1, y);
}

void series_room_free(struct series_room *room)
{
	for (int m = 0; m < room->terms; m++)
		clear_intervals(&room->term[m]);
	*room = (struct series_room){ 0 };
}
