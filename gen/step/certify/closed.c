/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States for the target's self-test to step to: of a linear model in closed form. */
#include "inner.h"
#include "step/linear/images.h"

#include <math.h>

static bool fill_row(const struct linear *system, struct closed_form *form, mpq_srcptr t, double *row)
{
	bool finite = true;
	for (int i = 0; i < system->states; i++) {
		const struct output output = state_as_output(system, i);
		row[i] = closed_form_value(form, &output, t, false, "a value of the self-test").value;
		finite = finite && isfinite(row[i]);
	}
	return finite;
}

static void fill_rows(const struct step *step, struct reference *r)
{
	const struct linear *system = &step->branch->system;
	mpq_t *start = rationals(r->states);
	RATIONAL t = ZERO;
	for (int i = 0; i < r->states; i++) {
		reference_start(i, start[i]);
		r->start[i] = round_rational(start[i]);
	}
	struct closed_form *form = closed_form_new(step->model->request.step_at, system, start, step->model->h, true);
	for (r->rows = 0; r->rows < FEW_ROWS; r->rows++) {
		mpq_set_ui(t, r->steps[r->rows], 1);
		mpq_mul(t, t, step->model->h);
		if (!fill_row(system, form, t, r->value + r->rows * r->states))
			break;                  /* what grows leaves the range: shorter */
	}
	mpq_div_2exp(t, step->model->h, 1);
	if (step->series.emitted)
		fill_row(system, form, t, r->between);
}

void reference_units(struct reference *r, bool single)
{
	for (int i = 0; i < r->states; i++) {
		double largest = fabs(r->start[i]);
		for (int k = 0; k < r->rows; k++)
			largest = fmax(largest, fabs(r->value[k * r->states + i]));
		r->unit[i] = ulp_of(largest, single);
	}
}

bool has_closed_form(const struct step *step)
{
	return step->is.flow == FLOW_LINEAR && steps_exactly(step->model) && !step->model->delays &&
	       !further_samples(&step->model->system);
}

struct reference reference_of(const struct step *step)
{
	if (step->model->switching)
		return reference_of_trajectory(step);
	struct reference r = new_reference(step->branch->system.states);
	fill_rows(step, &r);
	reference_units(&r, step->model->request.single);
	return r;
}
