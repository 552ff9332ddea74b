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

/* Is this entry of A w or -w of a load whose frequency depends on params? */
static bool is_tuned_frequency(const struct step *step, int row, int column)
{
	const struct linear *system = &step->branch->system;
	for (int l = 0; l < system->loads && step->model->tuning; l++) {
		int from = step->layout.load[l];
		bool inside = row >= from && row < from + system->load[l].columns;
		bool pair = row != column && (row - from) / 2 == (column - from) / 2;
		if (step->model->tuning->frequency[l] >= 0 && inside && pair)
			return true;
	}
	return false;
}

int fixed_slopes(const struct step *step, struct fixed_slope **list)
{
	const struct linear *system = &step->branch->system;
	int size = step->layout.size, count = 0;
	mpq_t *A = augmented_matrix(&step->layout, system, 0);
	*list = ARRAY(struct fixed_slope, (size_t)(size * size));
	for (int i = 0; i < size; i++)
		for (int j = 0; j < size; j++) {
			bool derivative = i < system->states && (i >= system->n || system->velocity[i] < 0);
			if (derivative || mpq_sgn(A[i * size + j]) == 0 || is_tuned_frequency(step, i, j))
				continue;
			struct coefficient value = equation_number(step->model, A[i * size + j]);
			(*list)[count++] = (struct fixed_slope){ i, j, value };
		}
	rationals_free(A, (size_t)size * (size_t)size);
	return count;
}
