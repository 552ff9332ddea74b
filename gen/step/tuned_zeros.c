/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which factors of a step are 0 whatever the tunable params are: the others may not be left out of the code. */
#include "step/step.h"

/* x_i' reads x_j, for some values of the params: states, load states, inputs as in the series of `step` */
static bool *couplings(const struct step *step)
{
	const struct tuning *t = step->model->tuning;
	const struct linear *system = &step->branch->system;
	int size = step->layout.size, states = system->states;
	mpq_t *A = augmented_matrix(&step->layout, system, 0);
	bool *reads = ARRAY(bool, (size_t)(size * size));
	for (int i = 0; i < size * size; i++)
		reads[i] = mpq_sgn(A[i]) != 0;
	for (int k = 0; k < system->n; k++) {
		bool *row = reads + (system->velocity[k] >= 0 ? system->velocity[k] : k) * size;
		for (int j = 0; j < t->x.size; j++) {
			bool load = j >= states && j < states + system->segments * t->x.loads;
			int at = load         ? states + (j - states) % t->x.loads
				 : j < states ? j
					      : j - (system->segments - 1) * t->x.loads;
			row[at] = row[at] || t->acts[k * t->x.size + j];
		}
	}
	return reads;
}

/* Reaching over any number of couplings */
static bool *reach(int size, bool *reads)
{
	for (int k = 0; k < size; k++)
		for (int i = 0; i < size; i++)
			for (int j = 0; j < size; j++)
				reads[i * size + j] = reads[i * size + j] ||
						      (reads[i * size + k] && reads[k * size + j]);
	return reads;
}

/* Does an input act on a state, by itself or by one of its derivatives? */
static bool reaches(const bool *row, int hold)
{
	bool any = false;
	for (int m = 0; m <= hold; m++)
		any = any || row[m];
	return any;
}

void mark_tuned_zeros(struct step *step)
{
	struct table *table = step->branch->whole;
	const struct linear *system = &step->branch->system;
	int n = table->states, size = step->layout.size;
	const bool *reached = reach(size, couplings(step));
	for (int i = 0; i < n; i++) {
		const bool *row = reached + i * size;
		for (int j = 0; j < n; j++) {
			table->Phi[i * n + j].zero = !row[j] && i != j;
			if (table->increment)
				table->increment[i * n + j].zero = !row[j];
		}
		for (int s = 0; s < system->segments; s++)
			for (int k = 0; k < table->columns; k++)
				table->load[(s * n + i) * table->columns + k].zero = !row[n + k];
		for (int input = 0, column = 0; input < system->inputs; input++)
			for (int k = 0; k <= system->input[input].hold; k++, column++)
				table->input[i * table->inputs + column].zero =
					!reaches(row + step->layout.input[input], system->input[input].hold);
	}
}

/* What the columns of a retuned row are, x has too, in the same places. */
bool *reached_in_regions(const struct step *step, int branch)
{
	const struct tuning *r = step->model->retuned;
	int size = step->layout.size;
	bool *reads = ARRAY(bool, (size_t)(size * size));
	for (int k = 0; k < step->branches; k++) {
		if (branch >= 0 && k != branch)
			continue;
		const struct linear *system = &step->branch[k].system;
		mpq_t *A = augmented_matrix(&step->layout, system, 0);
		for (int i = 0; i < size * size; i++)
			reads[i] = reads[i] || mpq_sgn(A[i]) != 0;
		rationals_free(A, (size_t)(size * size));
		for (int i = 0; i < system->n; i++) {
			int place = retuned_place(r, RETUNED_SLOPE, k, i);
			bool *row = reads + (system->velocity[i] >= 0 ? system->velocity[i] : i) * size;
			for (int j = 0; j < size && place >= 0; j++)
				row[j] = row[j] || retuned_reads(r, place, j);
		}
	}
	return reach(size, reads);
}
