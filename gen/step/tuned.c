/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a model with tunable params keeps: the coefficients of outputs at the spec's own values, and what no param
 * changes of x' = A x. */
#include "step/step.h"

/* A row of an output over the columns */
static void fill_output(const struct step *step, const struct output *output, double *row)
{
	const struct linear *system = &step->branch->system;
	const struct model *model = step->model;
	int column = 0;
	for (int j = 0; j < system->states; j++)
		row[column++] = equation_number(model, output->state[j]).value;
	for (int s = 0; s < system->segments; s++)
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++)
				row[column++] = equation_number(model, output->load[l][k * system->segments + s]).value;
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k <= system->input[i].hold; k++)
			row[column++] = k < 2 ? equation_number(model, output->input[k][i]).value : 0;
}

double *nominal_outputs(const struct step *step)
{
	const struct tuning *t = step->model->tuning;
	double *value = ARRAY(double, (size_t)(t->outputs * t->x.size));
	for (int o = 0; o < step->model->outputs; o++) {
		int row = t->output[o] - step->model->n;
		if (row >= 0)
			fill_output(step, &step->model->output[o], value + row * t->x.size);
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
