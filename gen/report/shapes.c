/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mode shapes: for each pole p the vectors v with (M p^2 + C p + K) v = 0, by elimination with complete pivoting over
 * complex numbers of SHAPE_BITS bits. Their largest entry is 1. Of a pole of multiplicity m there are m of them, or
 * fewer where the model has not more (a rigid body, which drifts, has one shape for two poles). */
#include "report/report.h"

#include <limits.h>

enum { SHAPE_BITS = 256, GONE = -SHAPE_BITS / 3 };  /* below 2^GONE of the largest, a pivot is 0 */

struct number { mpfr_t re, im; };
struct elimination {
	int n, rank;
	struct number *cell;            /* n x n */
	int *column;                    /* per place: which coordinate stands there */
	struct number t, u;
};

static void number_init(struct number *x)
{
	mpfr_inits2(SHAPE_BITS, x->re, x->im, NULL);
	mpfr_set_zero(x->re, 1);
	mpfr_set_zero(x->im, 1);
}

/* z <- a b; z is neither */
static void multiply(struct number *z, const struct number *a, const struct number *b)
{
	mpfr_fmms(z->re, a->re, b->re, a->im, b->im, MPFR_RNDN);
	mpfr_fmma(z->im, a->re, b->im, a->im, b->re, MPFR_RNDN);
}

/* z <- a / b; z is neither */
static void divide(struct number *z, const struct number *a, const struct number *b)
{
	REAL norm = WITH_BITS(SHAPE_BITS);
	mpfr_fmma(norm, b->re, b->re, b->im, b->im, MPFR_RNDN);
	mpfr_fmma(z->re, a->re, b->re, a->im, b->im, MPFR_RNDN);
	mpfr_fmms(z->im, a->im, b->re, a->re, b->im, MPFR_RNDN);
	mpfr_div(z->re, z->re, norm, MPFR_RNDN);
	mpfr_div(z->im, z->im, norm, MPFR_RNDN);
}

/* Order of size, of numbers that are not 0 */
static long order_of(const struct number *x)
{
	long re = mpfr_zero_p(x->re) ? LONG_MIN : mpfr_get_exp(x->re);
	long im = mpfr_zero_p(x->im) ? LONG_MIN : mpfr_get_exp(x->im);
	return re > im ? re : im;
}

static bool is_larger(const struct number *a, const struct number *b)
{
	REAL x = WITH_BITS(64), y = WITH_BITS(64);
	mpfr_hypot(x, a->re, a->im, MPFR_RNDN);
	mpfr_hypot(y, b->re, b->im, MPFR_RNDN);
	return mpfr_greater_p(x, y);
}

/* M p^2 + C p + K; rows scaled to one size, which leaves v */
static void fill(struct elimination *e, const struct linear *system, const struct pole_report *pole)
{
	struct number square, p;
	number_init(&square);
	number_init(&p);
	mpfr_set(p.re, pole->re, MPFR_RNDN);
	mpfr_set(p.im, pole->im, MPFR_RNDN);
	multiply(&square, &p, &p);
	for (int i = 0; i < e->n * e->n; i++) {
		struct number *x = &e->cell[i];
		number_init(x);
		mpfr_set_q(x->re, system->K[i], MPFR_RNDN);
		mpfr_mul_q(e->t.re, p.re, system->C[i], MPFR_RNDN);
		mpfr_mul_q(x->im, p.im, system->C[i], MPFR_RNDN);
		mpfr_add(x->re, x->re, e->t.re, MPFR_RNDN);
		mpfr_mul_q(e->t.re, square.re, system->M[i], MPFR_RNDN);
		mpfr_mul_q(e->t.im, square.im, system->M[i], MPFR_RNDN);
		mpfr_add(x->re, x->re, e->t.re, MPFR_RNDN);
		mpfr_add(x->im, x->im, e->t.im, MPFR_RNDN);
	}
	mpfr_clears(square.re, square.im, p.re, p.im, NULL);
}

/* What each row's terms are of, before they cancel: a row that is smaller by 2^GONE is 0 */
static void scale_rows(struct elimination *e, const struct linear *system, const struct pole_report *pole)
{
	REAL size = WITH_BITS(64), term = WITH_BITS(64), p = WITH_BITS(64);
	mpfr_hypot(p, pole->re, pole->im, MPFR_RNDN);
	for (int i = 0; i < e->n; i++) {
		mpfr_set_zero(size, 1);
		for (int j = 0; j < e->n; j++) {
			const mpq_t *of[] = { system->K, system->C, system->M };
			for (int k = 0; k < 3; k++) {
				mpfr_set_q(term, of[k][i * e->n + j], MPFR_RNDN);
				for (int power = 0; power < k; power++)
					mpfr_mul(term, term, p, MPFR_RNDN);
				mpfr_abs(term, term, MPFR_RNDN);
				mpfr_max(size, size, term, MPFR_RNDN);
			}
		}
		for (int j = 0; j < e->n && !mpfr_zero_p(size); j++) {
			struct number *x = &e->cell[i * e->n + j];
			mpfr_div(x->re, x->re, size, MPFR_RNDN);
			mpfr_div(x->im, x->im, size, MPFR_RNDN);
		}
	}
}

static void swap_rows(struct elimination *e, int a, int b)
{
	for (int j = 0; j < e->n && a != b; j++) {
		mpfr_swap(e->cell[a * e->n + j].re, e->cell[b * e->n + j].re);
		mpfr_swap(e->cell[a * e->n + j].im, e->cell[b * e->n + j].im);
	}
}

static void swap_columns(struct elimination *e, int a, int b)
{
	for (int i = 0; i < e->n && a != b; i++) {
		mpfr_swap(e->cell[i * e->n + a].re, e->cell[i * e->n + b].re);
		mpfr_swap(e->cell[i * e->n + a].im, e->cell[i * e->n + b].im);
	}
	int kept = e->column[a];
	e->column[a] = e->column[b];
	e->column[b] = kept;
}

/* The largest of what is left comes to (at, at); false: nothing is left */
static bool choose_pivot(struct elimination *e, int at)
{
	int n = e->n, best = at * n + at;
	for (int i = at; i < n; i++)
		for (int j = at; j < n; j++)
			if (is_larger(&e->cell[i * n + j], &e->cell[best]))
				best = i * n + j;
	if (order_of(&e->cell[best]) < GONE)
		return false;
	swap_rows(e, at, best / n);
	swap_columns(e, at, best % n);
	return true;
}

/* row <- row - (its entry at `at`) row `at`, which is 1 there */
static void clear_row(struct elimination *e, int row, int at)
{
	const struct number *pivot = &e->cell[at * e->n];
	struct number *x = &e->cell[row * e->n];
	mpfr_set(e->t.re, x[at].re, MPFR_RNDN);
	mpfr_set(e->t.im, x[at].im, MPFR_RNDN);
	if (mpfr_zero_p(e->t.re) && mpfr_zero_p(e->t.im))
		return;
	for (int j = at; j < e->n; j++) {
		multiply(&e->u, &e->t, &pivot[j]);
		mpfr_sub(x[j].re, x[j].re, e->u.re, MPFR_RNDN);
		mpfr_sub(x[j].im, x[j].im, e->u.im, MPFR_RNDN);
	}
}

/* [I X; 0 0] */
static void eliminate(struct elimination *e)
{
	struct number pivot;
	number_init(&pivot);
	for (e->rank = 0; e->rank < e->n && choose_pivot(e, e->rank); e->rank++) {
		struct number *row = &e->cell[e->rank * e->n];
		mpfr_set(pivot.re, row[e->rank].re, MPFR_RNDN);
		mpfr_set(pivot.im, row[e->rank].im, MPFR_RNDN);
		for (int j = e->rank; j < e->n; j++) {
			divide(&e->u, &row[j], &pivot);
			mpfr_swap(row[j].re, e->u.re);
			mpfr_swap(row[j].im, e->u.im);
		}
		for (int i = 0; i < e->n; i++)
			if (i != e->rank)
				clear_row(e, i, e->rank);
	}
	mpfr_clears(pivot.re, pivot.im, NULL);
}

/* The solution with a 1 at place `free` of those behind the rank: -X there; largest entry 1 */
static struct mode_shape take_shape(const struct elimination *e, const struct pole_report *pole, int place)
{
	int n = e->n, largest = 0;
	struct mode_shape shape = { pole, ARRAY(double, (size_t)n), ARRAY(double, (size_t)n) };
	struct number *v = ARRAY(struct number, (size_t)n), z;
	number_init(&z);
	for (int i = 0; i < n; i++)
		number_init(&v[i]);
	for (int i = 0; i < e->rank; i++) {
		mpfr_neg(v[e->column[i]].re, e->cell[i * n + place].re, MPFR_RNDN);
		mpfr_neg(v[e->column[i]].im, e->cell[i * n + place].im, MPFR_RNDN);
	}
	mpfr_set_ui(v[e->column[place]].re, 1, MPFR_RNDN);
	for (int i = 1; i < n; i++)
		if (is_larger(&v[i], &v[largest]))
			largest = i;
	for (int i = 0; i < n; i++) {
		divide(&z, &v[i], &v[largest]);
		bool gone_re = mpfr_zero_p(z.re) || mpfr_get_exp(z.re) < GONE;
		bool gone_im = mpfr_zero_p(z.im) || mpfr_get_exp(z.im) < GONE;
		shape.re[i] = gone_re ? 0 : mpfr_get_d(z.re, MPFR_RNDN);
		shape.im[i] = gone_im ? 0 : mpfr_get_d(z.im, MPFR_RNDN);
	}
	for (int i = 0; i < n; i++)
		mpfr_clears(v[i].re, v[i].im, NULL);
	mpfr_clears(z.re, z.im, NULL);
	return shape;
}

static int shapes_of_pole(const struct linear *system, const struct pole_report *pole, struct mode_shape *list)
{
	int n = system->n, count = 0;
	struct elimination e = { .n = n, .cell = ARRAY(struct number, (size_t)(n * n)),
				 .column = ARRAY(int, (size_t)n) };
	number_init(&e.t);
	number_init(&e.u);
	for (int i = 0; i < n; i++)
		e.column[i] = i;
	fill(&e, system, pole);
	scale_rows(&e, system, pole);
	eliminate(&e);
	for (int place = e.rank; place < n && count < pole->multiplicity; place++)
		list[count++] = take_shape(&e, pole, place);
	for (int i = 0; i < n * n; i++)
		mpfr_clears(e.cell[i].re, e.cell[i].im, NULL);
	discard(e.cell);
	return count;
}

int shapes_of(const struct linear *system, int count, const struct pole_report *pole, struct mode_shape **list)
{
	int shapes = 0, most = 0;
	for (int i = 0; i < count; i++)
		most += pole[i].multiplicity;
	*list = ARRAY(struct mode_shape, (size_t)most + 1);
	for (int i = 0; i < count && system->n <= LIMIT_SHAPES; i++)
		shapes += shapes_of_pole(system, &pole[i], *list + shapes);
	return shapes;
}
