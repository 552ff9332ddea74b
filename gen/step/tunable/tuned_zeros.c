/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which factors of a step are 0 whatever the tunable params are: the others may not be left out of the code. What the
 * equations are for values that are related by nothing tells it. */
#include "model/regions/regions.h"
#include "tuned.h"

static void add_couplings(const struct step *step, const struct linear *system, bool *reads)
{
	const int size = step->layout.size;
	for (int s = 0; s < system->segments; s++) {
		RATIONALS *A = augmented_matrix(&step->layout, system, s);
		for (int i = 0; i < size * size; i++)
			reads[i] = reads[i] || mpq_sgn(A[i]) != 0;
	}
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

bool *reached_elsewhere(const struct step *step, int branch)
{
	const struct model *other = model_elsewhere(step->model);
	const struct switching *own = step->model->switching;
	bool *reads = ARRAY(bool, (size_t)(step->layout.size * step->layout.size));
	if (!own)
		add_couplings(step, &other->system, reads);
	for (int r = 0; own && r < own->regions; r++)   /* systems that are equal for all values are one here */
		if (own->region[r].possible && (branch < 0 || own->region[r].system == branch))
			add_couplings(step, &other->switching->system[other->switching->region[r].system], reads);
	return reach(step->layout.size, reads);
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
	struct table *table = step->branch->full;
	const struct linear *system = &step->branch->system;
	int n = table->states, size = step->layout.size;
	const bool *reached = reached_elsewhere(step, -1);
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
