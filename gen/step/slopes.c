/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A of x' = A x as the target's numbers: of each operator, of each segment of time, and what a scheme holds. */
#include "step/linear/forms.h"
#include "slopes.h"

#include <math.h>

void report_range(const struct step *step)
{
	error(step->model->request.at.step, NULL, "a number of the equations is beyond the range of %s", target_name());
}

/* Does this entry of x belong to a load that the step leaves out? */
static bool is_left_out(const struct step *step, int entry)
{
	const struct linear *system = &step->branch->system;
	for (int l = 0; step->forced && l < system->loads; l++) {
		int from = step->layout.load[l];
		if (step->forced->load[l] && entry >= from && entry < from + system->load[l].columns)
			return true;
	}
	return false;
}

/* Where differences are kept, what the step leaves out is added to the states as written. */
double *slopes_of(const struct step *step, int branch)
{
	size_t cells = (size_t)step->layout.size * (size_t)step->layout.size;
	RATIONALS *exact = augmented_matrix(&step->layout, &step->branch[branch].system, 0);
	double *A = ARRAY(double, 2 * cells);
	const size_t size = (size_t)step->layout.size, states = (size_t)step->branch[branch].system.states;
	for (size_t i = 0; i < cells; i++) {
		if (step->model->relative && i / size < states && is_left_out(step, (int)(i % size)))
			continue;
		A[i] = round_rational(exact[i]);
		A[cells + i] = isfinite(A[i]) ? rounding_rest(exact[i]) : 0;
	}
	return A;
}

/* The entries of x that are load states; they stand together. */
static struct load_slopes place_of_loads(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	struct load_slopes place = { .first = -1 };
	for (int l = 0; l < system->loads; l++) {
		int at = step->layout.load[l];
		if (at < 0)
			continue;
		place.first = place.first < 0 ? at : place.first;
		place.columns += system->load[l].columns;
	}
	return place;
}

static double *load_slopes_in(const struct step *step, const struct load_slopes *place, int segment)
{
	int states = step->branch->system.states, size = step->layout.size;
	RATIONALS *exact = augmented_matrix(&step->layout, &step->branch->system, segment);
	double *value = ARRAY(double, (size_t)states * (size_t)place->columns);
	for (int j = 0; j < place->columns; j++)
		for (int i = 0; i < states && !is_left_out(step, place->first + j); i++)
			value[i * place->columns + j] = round_rational(exact[i * size + place->first + j]);
	return value;
}

struct load_slopes load_slopes_of(const struct step *step)
{
	struct load_slopes slopes = place_of_loads(step);
	int segments = step->branch->system.segments;
	slopes.segment = ARRAY(double *, segments);
	for (int s = 0; s < segments && slopes.first >= 0; s++)
		slopes.segment[s] = load_slopes_in(step, &slopes, s);
	return slopes;
}

/* -heldK q - heldC v */
struct coefficient *held_forces_of(const struct step *step)
{
	const struct linear *system = &step->branch->system;
	int n = system->n;
	struct coefficient *force = ARRAY(struct coefficient, (size_t)n * (size_t)system->states);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < system->states; j++) {
			mpq_srcptr held = (j < n ? system->heldK : system->heldC)[i * n + system->coord[j]];
			struct coefficient *c = &force[i * system->states + j];
			c->zero = mpq_sgn(held) == 0;
			c->value = c->zero ? 0 : -equation_number(step->model, held).value;
		}
	return force;
}
