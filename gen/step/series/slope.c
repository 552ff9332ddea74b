/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The derivative of a state as a sum of sequences, without friction and contacts. */
#include "inner.h"

/* y' of a state: its row of A, loads, inputs, and the remainder, whose linear terms may cancel */
struct sum slope_of_state(struct sequencing *w, int state)
{
	const struct model *model = w->step->model;
	const struct layout *layout = &w->layout;
	mpq_t *row = w->slopes[0] + state * layout->size;
	struct sum sum = { 0 };
	for (int j = 0; j < layout->states; j++)
		if (mpq_sgn(row[j]) != 0)
			sum_add(&sum, TERM_SEQUENCE, j, 0, row[j]);
	for (int i = 0; i < w->system->inputs; i++) {
		if (mpq_sgn(row[layout->input[i]]) != 0)
			sum_add(&sum, TERM_INPUT, i, 0, row[layout->input[i]]);
		if (w->system->input[i].hold && mpq_sgn(row[layout->input[i] + 1]) != 0)
			sum_add(&sum, TERM_SLOPE, i, 0, row[layout->input[i] + 1]);
	}
	for (int l = 0, column = 0; l < w->system->loads; column += w->system->load[l++].columns)
		for (int j = 0; j < w->system->load[l].columns && layout->load[l] >= 0; j++) {
			mpq_srcptr factor = row[layout->load[l] + j];
			if (mpq_sgn(factor) == 0 || loads_change(w->system))
				continue;
			bool power = is_polynomial(w->system->load[l].forcing);
			sum_add(&sum, power ? TERM_TIME : TERM_LOAD, power ? j : column + j, 0, factor);
		}
	for (int e = 0; e < w->system->force_columns; e++)
		if (mpq_sgn(row[layout->force_column + e]) != 0 && w->x->force)
			sum_add(&sum, TERM_SEQUENCE, w->x->force[e], 0, row[layout->force_column + e]);
		else if (mpq_sgn(row[layout->force_column + e]) != 0)
			sum_add_form(w, &sum, model->schedule.operator[0].left[e], row[layout->force_column + e]);
	return sum;
}
