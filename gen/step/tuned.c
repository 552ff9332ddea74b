/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a model with tunable params keeps: the coefficients of outputs at the spec's own values, and what no param
 * changes of x' = A x. */
#include "step/step.h"

double *nominal_outputs(const struct step *step)
{
	const struct model *model = step->model;
	const struct tuning *t = model->tuning;
	const struct linear *system = &step->branch->system;
	const int size = t->x.size;
	double *value = ARRAY(double, (size_t)(t->outputs * size));
	mpq_t *row = rationals((size_t)size);
	for (int o = 0; o < model->outputs; o++) {
		if (t->output[o] < 0)
			continue;
		double *to = value + (t->output[o] - model->n) * size;
		row_of_output(&t->x, system, &model->output[o], system->segments, 0, row);
		for (int j = 0; j < size; j++)
			to[j] = equation_number(model, row[j]).value;
	}
	return value;
}

int fixed_slopes(const struct step *step, struct fixed_slope **list)
{
	const struct linear *system = &step->branch->system;
	const struct model *other = step->model->tuning ? step->model->tuning->other : NULL;
	int size = step->layout.size, count = 0;
	RATIONALS *A = augmented_matrix(&step->layout, system, 0);
	RATIONALS *there = augmented_matrix(&step->layout, other ? &other->system : system, 0);
	*list = ARRAY(struct fixed_slope, (size_t)(size * size));
	for (int i = 0; i < size; i++)
		for (int j = 0; j < size; j++) {
			const bool derivative = i < system->states && (i >= system->n || system->velocity[i] < 0);
			mpq_srcptr entry = A[i * size + j];
			if (derivative || mpq_sgn(entry) == 0 || !mpq_equal(entry, there[i * size + j]))
				continue;
			(*list)[count++] = (struct fixed_slope){ i, j, equation_number(step->model, entry) };
		}
	return count;
}
