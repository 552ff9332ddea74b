/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of regions whose tables an instance has: what of x stays from step to step, 1 and held params, and what is never
 * above 1 is folded beforehand, so that an event-free step has sums over the rest alone. */
#include "inner.h"
#include "model/regions/switching_functions.h"
#include "model/regions/regions.h"
#include "model/tunable/tuning.h"

#include <math.h>

/* 1, or cos and sin of one angle: never above 1 */
bool is_bounded_load(const struct step *step, int load)
{
	const struct load *l = &step->branch->system.load[load];
	return step->layout.load[load] >= 0 && l->powers == 1 && mpq_sgn(l->forcing->a) == 0;
}

int *staying_columns(const struct step *step, int *count)
{
	const struct linear *system = &step->branch->system;
	const struct layout *layout = &step->layout;
	int *column = ARRAY(int, layout->size);
	*count = 0;
	for (int l = 0; l < system->loads; l++)
		if (layout->load[l] >= 0 && is_polynomial(system->load[l].forcing))
			column[(*count)++] = layout->load[l];
	for (int i = step->model->spec->count.inputs; i < system->inputs; i++)
		column[(*count)++] = layout->input[i];
	return column;
}

bool any_stays(const struct step *step)
{
	int count;
	discard(staying_columns(step, &count));
	return count > 0;
}

bool any_still(const struct step *step)
{
	bool any = any_stays(step);
	for (int l = 0; l < step->branch->system.loads; l++)
		any = any || is_bounded_load(step, l);
	return any;
}

int param_of_column(const struct step *step, int column)
{
	int i = step->model->spec->count.inputs;
	while (i < step->branch->system.inputs && step->layout.input[i] != column)
		i++;
	return i < step->branch->system.inputs ? param_of_input(step->model->spec, i) : -1;
}

static double value_of_column(const struct step *step, int column)
{
	int param = param_of_column(step, column);
	return param < 0 ? 1 : equation_number(step->model, step->model->params.held->nominal[param]).value;
}

/* Over a pair of bounded load states, cos and sin: at least sqrt(a^2 + b^2) */
static double fold_pair(double a, double b)
{
	return fmax(a, b) + FOLDED * fmin(a, b);
}

static void gather_piece(const struct step *step, struct region_piece *piece)
{
	const struct linear *system = &step->branch->system;
	const struct layout *layout = &step->layout;
	int size = layout->size, functions = step->model->switching->functions, stays;
	const int *column = staying_columns(step, &stays);
	piece->added = ARRAY(double, system->states);
	for (int i = 0; i < system->states; i++)
		for (int k = 0; k < stays; k++)
			piece->added[i] += piece->Phi[i * size + column[k]] * value_of_column(step, column[k]);
	for (int i = 0; i < functions; i++) {
		const double *off = piece->off + i * size;
		double still = 0;
		for (int k = 0; k < stays; k++)
			still += off[column[k]] * fabs(value_of_column(step, column[k]));
		for (int l = 0; l < system->loads; l++)
			if (is_bounded_load(step, l) && system->load[l].columns == 2)
				still += fold_pair(off[layout->load[l]], off[layout->load[l] + 1]);
		piece->still[i] = still * (1 + 1e-9);
	}
}

/* Of each switching function its breakpoints between open ends, less what stays of its row */
static double *edges_of(const struct step *step, const struct pieces *pieces)
{
	const struct switching *s = step->model->switching;
	double *edge = ARRAY(double, edges_of_regions(s)), *next = edge;
	const double *at = pieces->breakpoint;
	int stays;
	const int *column = staying_columns(step, &stays);
	for (int i = 0; i < s->functions; i++) {
		double shift = 0;
		for (int k = 0; k < stays; k++)
			shift += pieces->row[i * step->layout.size + column[k]] * value_of_column(step, column[k]);
		*next++ = -OPEN_END;
		for (int k = 0; k < s->function[i].breaks; k++)
			*next++ = *at++ - shift;
		*next++ = OPEN_END;
	}
	return edge;
}

int edges_of_regions(const struct switching *s)
{
	int edges = 0;
	for (int i = 0; i < s->functions; i++)
		edges += s->function[i].breaks + 2;
	return edges;
}

void gather(const struct step *step, struct pieces *pieces)
{
	for (int k = 0; k < step->branches; k++)
		gather_piece(step, &pieces->piece[k]);
	pieces->edge = edges_of(step, pieces);
}
