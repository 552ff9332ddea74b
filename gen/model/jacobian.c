/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Jacobian of the equations, where the states and the time are fixed, and its eigenvalues. Nothing here reaches
 * the numbers of the generated code, so eigenvalues in double will do. */
#include "building.h"
#include "checks.h"

#include <math.h>
#include <stdlib.h>

/* Of other residuals than those of the equations */
static void jacobian_of_rows(struct jacobian *j, const struct form *const *row)
{
	struct collector *c = &j->b->collector;
	const struct model *model = j->b->model;
	j->C = ARRAY(struct form **, model->n);
	j->K = ARRAY(struct form **, model->n);
	for (int k = 0; k < model->n; k++) {
		j->C[k] = form_derivatives(c, model->n, row, false, k, 1);
		j->K[k] = form_derivatives(c, model->n, row, false, k, 0);
	}
	j->at = linear_like(&model->system);
	j->at.M = model->system.M;
}

void jacobian_forms(void *context)
{
	struct jacobian *j = context;
	const struct form **row = ARRAY(const struct form *, j->b->model->n);
	for (int i = 0; i < j->b->model->n; i++)
		row[i] = j->b->full->residual[i].form;
	jacobian_of_rows(j, row);
}

int jacobian_point(const struct jacobian *j, struct fixing *fixing)
{
	const struct model *model = j->b->model;
	for (int i = 0; i < model->system.states; i++) {
		int coord = model->system.coord[i];
		fixing[i] =
			(struct fixing){ .symbol = model->frame.coord[coord], .coord = coord, .order = i >= model->n };
		mpq_init(fixing[i].value);
		mpq_set(fixing[i].value, j->state[i]);
	}
	struct fixing *time = &fixing[model->system.states];
	*time = (struct fixing){ .at = model->spec->name_at };
	time->form = form_constant(j->t);
	return model->system.states + 1;
}

struct point *point_at_state(struct building *b, const mpq_t *state, mpq_srcptr t)
{
	struct jacobian j = { .b = b, .state = state };
	struct fixing *fixing = ARRAY(struct fixing, b->model->system.states + 1);
	mpq_init(j.t);
	if (t)
		mpq_set(j.t, t);
	struct point *point = point_new(&b->collector, jacobian_point(&j, fixing), fixing);
	point_at_values(point);
	mpq_clear(j.t);
	return point;
}

/* 0 where inputs are in it */
static void constant_of(struct collector *c, const struct form *form, mpq_ptr value)
{
	mpq_set_ui(value, 0, 1);
	if (is_constant(form))                  /* what still depends on inputs is left out */
		constant_value(c, form, value);
}

static void jacobian_at(struct jacobian *j, struct point *point)
{
	const struct model *model = j->b->model;
	struct collector *c = &j->b->collector;
	int n = model->n;
	point_at_values(point);
	point_rounded(point);
	for (int k = 0; k < n; k++)
		for (int i = 0; i < n; i++) {
			/* of first order: what multiplies the highest derivative */
			if (j->damped || model->system.velocity[k] < 0)
				constant_of(c, form_at(point, j->C[k][i]), j->at.C[i * n + k]);
			constant_of(c, form_at(point, j->K[k][i]), j->at.K[i * n + k]);
		}
}

void jacobian_evaluate(void *context)
{
	struct jacobian *j = context;
	struct fixing *fixing = ARRAY(struct fixing, j->b->model->system.states + 1);
	jacobian_at(j, point_new(&j->b->collector, jacobian_point(j, fixing), fixing));
}

/* ---- eigenvalues ---- */

static int ascending(const void *left, const void *right)
{
	const double *a = left, *b = right;
	return (*a > *b) - (*a < *b);
}

/* Sizes of the eigenvalues, or their real parts; false: not found. `value` receives n, sorted. */
static bool sorted_eigenvalues(int n, const mpq_t *A, bool sizes, double *value)
{
	SCRATCH double *im = ARRAY(double, n);
	bool found = eigenvalues(n, A, value, im);
	for (int i = 0; i < n && found && sizes; i++)
		value[i] = hypot(value[i], im[i]);
	qsort(value, (size_t)n, sizeof *value, ascending);
	return found;
}

/* Squared frequencies [1/s^2] of the coordinates' squared_frequencies alone: eigenvalues of W^-1 K */
bool squared_frequencies(const struct linear *system, double *value)
{
	int n = system->n, column;
	RATIONALS *inverse = rationals((size_t)(n * n)), *product = rationals((size_t)(n * n));
	if (!leading_inverse(system, inverse, &column))
		return false;
	unreduced_product(n, n, n, inverse, system->K, product);
	return sorted_eigenvalues(n, product, false, value);
}

double fastest_pole(const struct linear *system)
{
	double *value = ARRAY(double, system->states);
	bool found = sorted_eigenvalues(system->states, state_matrix(system, false), true, value);
	return found ? value[system->states - 1] : 0;
}

double fastest_decay(const struct linear *system)
{
	double *value = ARRAY(double, system->states);
	bool found = sorted_eigenvalues(system->states, state_matrix(system, false), false, value);
	return found ? fmax(-value[0], 0) : 0;
}

/* ---- where a mass matrix moves ---- */

const struct form *residual_as_written(const struct segment_equations *s, const int *owner, int row)
{
	for (int i = 0; i < s->masses; i++) {
		const struct written_system *written = s->mass[i].system.written;
		for (int k = 0; k < written->rows; k++)
			if (written->highest[k].index < s->residuals && owner[written->highest[k].index] == row)
				return written->residual[k];
	}
	return s->residual[row].form;
}

/* Values in double: their exact inverse would have as many digits as M has entries. */
static void evaluate_rounded(struct jacobian *j, struct point *at, int count, const struct form *const *form,
			     mpq_t *value)
{
	for (int i = 0; i < count; i++) {
		constant_of(&j->b->collector, form_at(at, form[i]), value[i]);
		round_roughly(value[i], value[i]);
	}
}

/* q'' of one block there, as further fixings; returns the inverse of its M */
static mpq_t *fix_highest(struct jacobian *j, struct point *at, const struct moving_mass *mass, struct fixing *fixing)
{
	const struct linear_system *e = &mass->system;
	const int n = e->n;
	int column;
	mpq_t *inverse = rationals((size_t)(n * n));
	RATIONALS *M = rationals((size_t)(n * n)), *f = rationals((size_t)n), *x = rationals((size_t)n);
	evaluate_rounded(j, at, n * n, e->M, M);
	evaluate_rounded(j, at, n, e->f, f);
	if (!rational_inverse(n, M, inverse, &column))
		abandon();
	unreduced_product(n, n, 1, inverse, f, x);
	for (int i = 0; i < n; i++) {
		const struct basis *highest = &e->written->highest[i];
		fixing[i] = (struct fixing){ .symbol = j->b->model->frame.coord[highest->index],
					     .coord = highest->index, .order = highest->order };
		mpq_init(fixing[i].value);
		round_roughly(fixing[i].value, x[i]);
	}
	return inverse;
}

/* Of all n columns of a block's rows, one after the other; below 0: of a constraint */
static int place_in_row(const struct jacobian *j, const struct moving_mass *mass, int i)
{
	const int all = j->b->model->n, coord = mass->system.written->highest[i / all].index;
	return coord < all ? j->b->owner[coord] * all + i % all : -1;
}

/* Rows of a block times the inverse of its M: accelerations along constraints, as if these had no curvature */
static void solve_rows(const struct jacobian *j, const struct moving_mass *mass, const mpq_t *inverse, mpq_t *rows)
{
	const int n = mass->system.n, all = j->b->model->n;
	RATIONALS *own = rationals((size_t)(n * all)), *solved = rationals((size_t)(n * all));
	for (int i = 0; i < n * all; i++)
		if (place_in_row(j, mass, i) >= 0)
			round_roughly(own[i], rows[place_in_row(j, mass, i)]);
	unreduced_product(n, n, all, inverse, own, solved);
	for (int i = 0; i < n * all; i++)
		if (place_in_row(j, mass, i) >= 0)
			round_roughly(rows[place_in_row(j, mass, i)], solved[i]);
}

/* With F = M q'' - f as written and q'' as it is there, M^-1 of F's derivatives: those of q'' - M^-1 f as forms would
 * be n^3 products. */
void jacobian_of_motion(void *context)
{
	struct jacobian *j = context;
	struct building *b = j->b;
	const int n = b->model->n, masses = b->full->masses;
	const struct form **row = ARRAY(const struct form *, n);
	for (int i = 0; i < n; i++)
		row[i] = residual_as_written(b->full, b->owner, i);
	jacobian_of_rows(j, row);
	struct fixing *fixing = ARRAY(struct fixing, b->model->system.states + 1 + n + b->spec->count.multipliers);
	int fixings = jacobian_point(j, fixing);
	struct point *start = point_new(&b->collector, fixings, fixing);
	point_at_values(start);
	mpq_t **inverse = ARRAY(mpq_t *, masses);
	for (int i = 0; i < masses; fixings += b->full->mass[i++].system.n)
		inverse[i] = fix_highest(j, start, &b->full->mass[i], fixing + fixings);
	jacobian_at(j, point_new(&b->collector, fixings, fixing));
	for (int i = 0; i < masses; i++) {
		solve_rows(j, &b->full->mass[i], inverse[i], j->at.C);
		solve_rows(j, &b->full->mass[i], inverse[i], j->at.K);
	}
}
