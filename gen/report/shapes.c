/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Mode shapes: for each pole p the vectors v with (M p^2 + C p + K) v = 0, by elimination with complete pivoting over
 * complex numbers of SHAPE_BITS bits. Their largest entry is 1. Of a pole of multiplicity m there are m of them, or
 * fewer where the model has not more (a rigid body, which drifts, has one shape for two poles). */
#include "report/report.h"
#include "step/linear/images.h"

#include <mpc.h>

enum { SHAPE_BITS = 256, GONE = -SHAPE_BITS / 3 };  /* below 2^GONE of the largest, a pivot is 0 */

struct elimination {
	int n, rank;
	mpc_t *cell;                    /* n x n */
	int *column;                    /* per place: which coordinate stands there */
	mpc_t t;
};

static mpc_t *numbers(int count)
{
	mpc_t *x = ARRAY(mpc_t, count);
	for (int i = 0; i < count; i++) {
		mpc_init2(x[i], SHAPE_BITS);
		mpc_set_ui(x[i], 0, MPC_RNDNN);
	}
	return x;
}

static void numbers_free(mpc_t *x, int count)
{
	for (int i = 0; i < count; i++)
		mpc_clear(x[i]);
	discard(x);
}

static bool is_gone(mpfr_srcptr x)
{
	return mpfr_zero_p(x) || mpfr_get_exp(x) < GONE;
}

static bool is_larger(mpc_srcptr a, mpc_srcptr b)
{
	REAL x = WITH_BITS(64), y = WITH_BITS(64);
	mpc_abs(x, a, MPFR_RNDN);
	mpc_abs(y, b, MPFR_RNDN);
	return mpfr_greater_p(x, y);
}

/* M p^2 + C p + K; rows scaled to one size, which leaves v */
static void fill(struct elimination *e, const struct linear *system, const struct pole_report *pole)
{
	mpc_t *p = numbers(2);
	REAL factor = WITH_BITS(SHAPE_BITS);
	mpc_set_fr_fr(p[0], pole->re, pole->im, MPC_RNDNN);
	mpc_sqr(p[1], p[0], MPC_RNDNN);
	for (int i = 0; i < e->n * e->n; i++) {
		mpc_set_q(e->cell[i], system->K[i], MPC_RNDNN);
		for (int k = 0; k < 2; k++) {
			mpfr_set_q(factor, (k ? system->M : system->C)[i], MPFR_RNDN);
			mpc_mul_fr(e->t, p[k], factor, MPC_RNDNN);
			mpc_add(e->cell[i], e->cell[i], e->t, MPC_RNDNN);
		}
	}
	numbers_free(p, 2);
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
		for (int j = 0; j < e->n && !mpfr_zero_p(size); j++)
			mpc_div_fr(e->cell[i * e->n + j], e->cell[i * e->n + j], size, MPC_RNDNN);
	}
}

/* The largest of what is left comes to (at, at); false: nothing is left */
static bool choose_pivot(struct elimination *e, int at)
{
	int n = e->n, best = at * n + at;
	for (int i = at; i < n; i++)
		for (int j = at; j < n; j++)
			if (is_larger(e->cell[i * n + j], e->cell[best]))
				best = i * n + j;
	const int row = best / n, column = best % n, kept = e->column[at];
	if (is_gone(mpc_realref(e->cell[best])) && is_gone(mpc_imagref(e->cell[best])))
		return false;
	for (int j = 0; j < n && row != at; j++)
		mpc_swap(e->cell[at * n + j], e->cell[row * n + j]);
	for (int i = 0; i < n && column != at; i++)
		mpc_swap(e->cell[i * n + at], e->cell[i * n + column]);
	e->column[at] = e->column[column];
	e->column[column] = kept;
	return true;
}

/* row <- row - (its entry at `at`) row `at`, which is 1 there */
static void clear_row(struct elimination *e, int row, int at)
{
	mpc_t *pivot = e->cell + at * e->n, *x = e->cell + row * e->n;
	for (int j = e->n - 1; j >= at; j--) {  /* that entry last */
		mpc_mul(e->t, x[at], pivot[j], MPC_RNDNN);
		mpc_sub(x[j], x[j], e->t, MPC_RNDNN);
	}
}

/* [I X; 0 0] */
static void eliminate(struct elimination *e)
{
	for (e->rank = 0; e->rank < e->n && choose_pivot(e, e->rank); e->rank++) {
		mpc_t *row = e->cell + e->rank * e->n;
		for (int j = e->n - 1; j >= e->rank; j--)       /* the pivot last */
			mpc_div(row[j], row[j], row[e->rank], MPC_RNDNN);
		for (int i = 0; i < e->n; i++)
			if (i != e->rank)
				clear_row(e, i, e->rank);
	}
}

/* The solution with a 1 at place `free` of those behind the rank: -X there; largest entry 1 */
static struct mode_shape take_shape(const struct elimination *e, const struct pole_report *pole, int place)
{
	int n = e->n, largest = 0;
	struct mode_shape shape = { pole, ARRAY(double, n), ARRAY(double, n) };
	mpc_t *v = numbers(n + 1);
	mpc_ptr z = v[n];
	for (int i = 0; i < e->rank; i++)
		mpc_neg(v[e->column[i]], e->cell[i * n + place], MPC_RNDNN);
	mpc_set_ui(v[e->column[place]], 1, MPC_RNDNN);
	for (int i = 1; i < n; i++)
		if (is_larger(v[i], v[largest]))
			largest = i;
	for (int i = 0; i < n; i++) {
		mpc_div(z, v[i], v[largest], MPC_RNDNN);
		shape.re[i] = is_gone(mpc_realref(z)) ? 0 : mpfr_get_d(mpc_realref(z), MPFR_RNDN);
		shape.im[i] = is_gone(mpc_imagref(z)) ? 0 : mpfr_get_d(mpc_imagref(z), MPFR_RNDN);
	}
	numbers_free(v, n + 1);
	return shape;
}

static int shapes_of_pole(const struct linear *system, const struct pole_report *pole, struct mode_shape *list)
{
	int n = system->n, count = 0;
	struct elimination e = { .n = n, .cell = numbers(n * n), .column = ARRAY(int, n) };
	mpc_init2(e.t, SHAPE_BITS);
	for (int i = 0; i < n; i++)
		e.column[i] = i;
	fill(&e, system, pole);
	scale_rows(&e, system, pole);
	eliminate(&e);
	for (int place = e.rank; place < n && count < pole->multiplicity; place++)
		list[count++] = take_shape(&e, pole, place);
	numbers_free(e.cell, n * n);
	mpc_clear(e.t);
	return count;
}

int shapes_of(const struct linear *system, int count, const struct pole_report *pole, struct mode_shape **list)
{
	int shapes = 0, most = 0;
	for (int i = 0; i < count; i++)
		most += pole[i].multiplicity;
	*list = ARRAY(struct mode_shape, most + 1);
	for (int i = 0; i < count && system->n <= LIMIT_SHAPES; i++)
		shapes += shapes_of_pole(system, &pole[i], *list + shapes);
	return shapes;
}
