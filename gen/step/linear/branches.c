/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems that a step is made of; of scheme pl what it solves exactly and holds over a step, and how that
 * errs. */
#include "model/regions/regions.h"
#include "images.h"

struct normalizing { int n; const mpq_t *inverse; };

static void normalize(const void *context, const mpq_t *force, mpq_t *acceleration)
{
	const struct normalizing *w = context;
	rational_product(w->n, w->n, 1, w->inverse, force, acceleration);
}

/* Fang, Wang, Dai, Zhang 2020: after division by the mass matrix the other coordinates and their velocities are held
 * at their value at the step's start; a coordinate's own terms, loads and inputs stay exact. */
static struct linear piecewise_laplace(const struct linear *written)
{
	int n = written->n, states = written->states;
	struct linear split = linear_like(written);
	mpq_t *inverse = inverse_of_leading(written), *highest = rationals((size_t)(n * states));
	highest_derivatives(written, inverse, false, highest);
	split.heldC = rationals((size_t)(n * n));
	split.heldK = rationals((size_t)(n * n));
	for (int i = 0; i < n; i++) {
		mpq_set_ui((written->velocity[i] >= 0 ? split.M : split.C)[i * n + i], 1, 1);
		for (int j = 0; j < states; j++) {
			bool own = written->coord[j] == i;
			mpq_t *matrix = j < n ? (own ? split.K : split.heldK) : own ? split.C : split.heldC;
			mpq_neg(matrix[i * n + written->coord[j]], highest[i * states + j]);
		}
	}
	take_forces(&split, written, n, normalize, &(struct normalizing){ n, inverse });
	return split;
}

/* The modified equation of y+ = E y + h phi1 R y is y' = L y - (h/2) R L y + O(h^2), L = A + R: what is held lags by
 * half a step. */
struct linear modified_equation(const struct linear *written, const struct linear *split, mpq_srcptr h)
{
	int states = split->states;
	mpq_t *L = state_matrix(written, false), *R = state_matrix(split, true),
	      *RL = rationals((size_t)(states * states));
	rational_product(states, states, states, R, L, RL);
	RATIONAL half = ZERO;
	mpq_div_2exp(half, h, 1);
	for (int i = 0; i < states * states; i++) {
		mpq_mul(RL[i], RL[i], half);
		mpq_sub(L[i], L[i], RL[i]);
	}
	return first_order_system(states, L);
}

/* The ramps of inputs as force columns: u', held and as the slope of u */
static struct linear driven_system(const struct linear *region)
{
	struct linear system = *region;
	system.force_columns = 2 * region->inputs;
	system.force_column = ARRAY(mpq_t *, system.force_columns);
	for (int i = 0; i < system.force_columns; i++)
		system.force_column[i] = region->input[i / 2].force[i % 2];
	return system;
}

/* The linear system of each operator, and what of it a step takes */
void take_operators(struct step *step)
{
	const struct model *model = step->model;
	const struct switching *regions = model->switching;
	bool holds = scheme_row(model->scheme)->holds_coupling;
	/* in normal modes, what else reads a branch is content with the first operator's */
	int operators = step->is.flow == FLOW_NORMAL && step->is.events == EVENTS_NONE ? 1 : model->schedule.operators;
	/* where the target makes the matrices of regions it has that of the first from nowhere else */
	step->branches = !regions ? (operators ? operators : 1) : regions->cached ? 1 : regions->systems;
	step->branch = ARRAY(struct branch, step->branches);
	for (int k = 0; k < step->branches; k++) {
		struct linear system = regions		  ? driven_system(&regions->system[k])
				       : model->schedule.operators ? operator_system(model, k)
							  : model->system;
		bool as_written = !regions && !model->schedule.operators && model->written == model && !holds;
		step->branch[k].system = holds ? piecewise_laplace(&system) : system;
		step->branch[k].resolvent = as_written ? step->written : resolvent_of(&step->branch[k].system);
		check_pole_size(model, step->branch[k].resolvent);
	}
}
