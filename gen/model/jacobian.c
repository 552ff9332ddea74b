/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Jacobian of the equations, where the states and the time are fixed, and its eigenvalues. Nothing here reaches
 * the numbers of the generated code, so eigenvalues in double will do. */
#include "building.h"
#include "checks.h"

#include <math.h>
#include <stdlib.h>

void jacobian_of_rows(struct jacobian *j, const struct form *const *row)
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

void constant_of(struct collector *c, const struct form *form, mpq_ptr value)
{
	mpq_set_ui(value, 0, 1);
	if (is_constant(form))                  /* what still depends on inputs is left out */
		constant_value(c, form, value);
}

void jacobian_at(struct jacobian *j, struct point *point)
{
	const struct model *model = j->b->model;
	struct collector *c = &j->b->collector;
	int n = model->n;
	point_at_values(point);
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
