/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Near a point constraints leave fewer motions than there are coordinates: of as many coordinates as there are
 * constraints, deviations follow from those of the others. G dq = 0 holds of positions; its derivatives in time, of
 * which slopes are taken as well, hold of velocities and accelerations, so also where the point moves. Equations are
 * combined so that no multiplier stands in them, N^T F with G N = 0, and dependent deviations are put in: what is left
 * are the linear equations of the independent coordinates, with M, C and K as symmetric as they were. A constraint on
 * velocities leaves its coordinate as a state of first order. */
#include "checks.h"
#include "linearise.h"

#include <math.h>
#include <string.h>

enum { SHORT = 24 };               /* digits of a number that is meant as it stands */

static int column_of(const struct linearising *l, int coord, int level)
{
	return level == 2 ? l->states + coord : level == 1 ? l->b->model->system.velocity[coord] : coord;
}

/* What is left where functions of BITS bits cancel: below 1e-60 of the largest slope, and no short number */
static void drop_noise(int count, mpq_t *slope)
{
	double largest = 0;
	for (int i = 0; i < count; i++)
		largest = fmax(largest, fabs(mpq_get_d(slope[i])));
	for (int i = 0; i < count; i++)
		if (fabs(mpq_get_d(slope[i])) < 1e-60 * largest && strlen(exact_text(slope[i])) > SHORT)
			mpq_set_ui(slope[i], 0, 1);
}

/* By all that is fixed but time. Functions of time that the state multiplies are loads, too, as it is at the point;
 * where a time is given they are coefficients of that time. */
struct tangent_row *rows_at(struct linearising *l, int count, const struct form *const *form)
{
	struct tangent_row *row = ARRAY(struct tangent_row, count);
	RATIONALS *slope = rationals((size_t)(form ? count : l->rows));
	for (int i = 0; i < count; i++) {
		const struct form *of = form ? form[i] : residual_as_written(l->b->full, l->b->owner, i);
		of = l->timed ? of : form_at(l->always, of);
		row[i] = (struct tangent_row){ rationals((size_t)l->fixings), terms_of_kinds(of, 1u << BASIS_FORCING) };
	}
	for (int f = 0; f < l->fixings - 1; f++) {
		slopes_at(l, form ? count : l->rows, form, f, slope);
		drop_noise(count, slope);
		for (int i = 0; i < count; i++)
			mpq_set(row[i].slope[f], slope[i]);
	}
	return row;
}

/* row += factor * other */
static void add_row(const struct linearising *l, struct tangent_row *row, const struct tangent_row *other,
		    mpq_srcptr factor)
{
	for (int f = 0; f < l->fixings; f++)
		if (mpq_sgn(other->slope[f]) != 0)
			rational_addmul(row->slope[f], factor, other->slope[f]);
	form_add_to(row->load, other->load, factor);
}

static void scale_row(const struct linearising *l, struct tangent_row *row, mpq_srcptr factor)
{
	for (int f = 0; f < l->fixings; f++)
		mpq_mul(row->slope[f], row->slope[f], factor);
	row->load = form_scale(row->load, factor);
}

/* What is left where numbers of 256 bits cancel, of a row whose entries were as large as `size` */
static void drop_rest(const struct linearising *l, struct tangent_row *row, double size)
{
	for (int f = 0; f < l->fixings; f++)
		if (fabs(mpq_get_d(row->slope[f])) < 1e-60 * size)
			mpq_set_ui(row->slope[f], 0, 1);
}

static double size_of_row(const struct linearising *l, const struct tangent_row *row)
{
	double size = 0;
	for (int f = 0; f < l->fixings; f++)
		size = fmax(size, fabs(mpq_get_d(row->slope[f])));
	return size;
}

/* Column by column 1 in one of the first `pivots` rows, 0 in all others; the rows are put in the order of columns. */
static void eliminate_columns(const struct linearising *l, int count, struct tangent_row *row, int pivots, int columns,
			      const int *column)
{
	RATIONAL factor = ZERO;
	for (int k = 0; k < columns; k++) {
		int best = k;
		for (int i = k + 1; i < pivots; i++)
			if (fabs(mpq_get_d(row[i].slope[column[k]])) > fabs(mpq_get_d(row[best].slope[column[k]])))
				best = i;
		const struct tangent_row pivot = row[best];
		row[best] = row[k];
		row[k] = pivot;
		if (mpq_sgn(pivot.slope[column[k]]) == 0)
			error(l->b->spec->name_at, "another point",
			      "the constraints are singular at the point where the model is linearised");
		mpq_inv(factor, pivot.slope[column[k]]);
		scale_row(l, &row[k], factor);
		for (int i = 0; i < count; i++) {
			const double size = size_of_row(l, &row[i]);
			mpq_neg(factor, row[i].slope[column[k]]);
			if (i == k || mpq_sgn(factor) == 0)
				continue;
			add_row(l, &row[i], &row[k], factor);
			drop_rest(l, &row[i], size);
		}
	}
}

/* ---- which coordinates depend on others ---- */

/* By pivots in double, relative to rows: those of constraints on positions first, and of coordinates the last, where
 * its pivot is no less than a quarter of the largest. `column`: per constraint the coordinate */
static void choose_dependent(const struct linearising *l, const struct tangent_row *row, int held, double *G,
			     int *column)
{
	const int n = l->n, m = l->held;
	SCRATCH bool *taken = ARRAY(bool, n);
	for (int i = 0; i < m; i++) {
		const double size = size_of_row(l, &row[i]);
		for (int j = 0; j < n && size > 0; j++)
			G[i * n + j] = mpq_get_d(row[i].slope[column_of(l, j, 2)]) / size;
	}
	for (int k = 0; k < m; k++) {
		int pivot = k, at = 0;
		double largest = 0;
		for (int i = k; i < (k < held ? held : m); i++)
			for (int j = n - 1; j >= 0; j--)
				if (!taken[j] && fabs(G[i * n + j]) > largest * (largest > 1e-11 ? 4 : 1)) {
					largest = fabs(G[i * n + j]);
					pivot = i;
					at = j;
				}
		if (largest < 1e-11)
			error(l->b->spec->name_at, "another point",
			      "the constraints are singular at the point where the model is linearised: their "
			      "gradients depend on each other there");
		for (int j = 0; j < n; j++) {
			const double entry = G[pivot * n + j];
			G[pivot * n + j] = G[k * n + j];
			G[k * n + j] = entry;
		}
		for (int i = k + 1; i < m; i++) {
			const double factor = G[i * n + at] / G[k * n + at];
			for (int j = 0; j < n; j++)
				G[i * n + j] -= factor * G[k * n + j];
		}
		taken[column[k] = at] = true;
	}
}

/* ---- what they follow from ---- */

/* Constraints on positions first: returns how many */
static int order_constraints(const struct linearising *l, const struct constraint **order)
{
	int count = 0, held = 0;
	for (int velocities = 0; velocities < 2; velocities++)
		for (int i = l->n; i < l->rows; i++)
			if ((constraint_of(l, i)->by[0] == NULL) == (velocities == 1)) {
				order[count++] = constraint_of(l, i);
				held += !velocities;
			}
	return held;
}

static struct tangent_row *rows_of_level(struct linearising *l, const struct constraint *const *order, int count,
					 int level)
{
	const struct form **form = ARRAY(const struct form *, count);
	for (int i = 0; i < count; i++)
		form[i] = order[i]->by[level];
	return rows_at(l, count, form);
}

/* what + others = 0 to what = -others, in which what is known is put in */
static struct tangent_row solved_for(const struct linearising *l, const struct tangent *t, int column,
				     struct tangent_row row)
{
	RATIONAL minus = RATIO(-1, 1);
	mpq_set_ui(row.slope[column], 0, 1);
	scale_row(l, &row, minus);
	put_dependent(l, t, &row);
	return row;
}

static void take_level(const struct linearising *l, struct tangent *t, int level, int count, struct tangent_row *row,
		       const int *coord)
{
	SCRATCH int *column = ARRAY(int, count);
	for (int k = 0; k < count; k++)
		column[k] = column_of(l, coord[k], level);
	eliminate_columns(l, count, row, count, count, column);
	for (int k = 0; k < count; k++)
		t->follows[level][coord[k]] = solved_for(l, t, column[k], row[k]);
}

static void put_in(const struct linearising *l, struct tangent_row *row, int column, const struct tangent_row *other)
{
	RATIONAL factor = ZERO;
	if (column < 0 || !other->slope || mpq_sgn(row->slope[column]) == 0)
		return;
	mpq_set(factor, row->slope[column]);
	mpq_set_ui(row->slope[column], 0, 1);
	add_row(l, row, other, factor);
}

void put_dependent(const struct linearising *l, const struct tangent *t, struct tangent_row *row)
{
	const double size = size_of_row(l, row);
	for (int level = LEVELS_HELD - 1; t && level >= 0; level--)
		for (int j = 0; j < l->n; j++)
			put_in(l, row, column_of(l, j, level), &t->follows[level][j]);
	for (int k = 0; t && t->multiplier && k < l->held; k++)
		put_in(l, row, l->states + l->n + k, &t->multiplier[k]);
	drop_rest(l, row, size);
}

/* The equations of dependent coordinates come first: they determine the multipliers. */
static void take_equations(struct linearising *l, struct tangent *t, const int *coord)
{
	const int n = l->n, m = l->held;
	const int *owner = l->b->owner;
	SCRATCH int *column = ARRAY(int, m), *order = ARRAY(int, n);
	SCRATCH bool *first = ARRAY(bool, n);
	int count = m;
	for (int k = 0; k < m; k++) {
		column[k] = l->states + n + k;
		order[k] = owner[coord[k]];
		first[order[k]] = true;
	}
	for (int i = 0; i < n; i++)
		if (!first[i])
			order[count++] = i;
	const struct tangent_row *written = rows_at(l, n, NULL);
	struct tangent_row *row = ARRAY(struct tangent_row, n);
	for (int i = 0; i < n; i++)
		row[i] = written[order[i]];
	eliminate_columns(l, n, row, m, m, column);
	t->row = ARRAY(struct tangent_row, n);
	for (int i = m; i < n; i++) {
		t->row[order[i]] = row[i];
		put_dependent(l, t, &t->row[order[i]]);
	}
	struct tangent_row *multiplier = ARRAY(struct tangent_row, m);
	for (int k = 0; k < m; k++)
		multiplier[k] = solved_for(l, t, column[k], row[k]);
	t->multiplier = multiplier;
}

struct tangent *tangent_of(struct linearising *l)
{
	if (l->held == 0)
		return NULL;
	struct tangent *t = NEW(struct tangent);
	SCRATCH double *G = ARRAY(double, l->held * l->n);
	SCRATCH int *coord = ARRAY(int, l->held);
	const struct constraint **order = ARRAY(const struct constraint *, l->held);
	const int held = order_constraints(l, order);
	choose_dependent(l, rows_of_level(l, order, l->held, 2), held, G, coord);
	for (int level = 0; level < LEVELS_HELD; level++)
		t->follows[level] = ARRAY(struct tangent_row, l->n);
	for (int level = 0; level < LEVELS_HELD; level++) {
		const int count = level ? l->held : held;
		take_level(l, t, level, count, rows_of_level(l, order, count, level), coord);
	}
	take_equations(l, t, coord);
	return t;
}
