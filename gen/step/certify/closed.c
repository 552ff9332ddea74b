/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States for the target's self-test to step to: of a linear model in closed form. */
#include "inner.h"
#include "model/regions/regions.h"
#include "step/linear/images.h"

#include <math.h>

struct closed_form {                /* of one state */
	int count;
	struct started *list;
};

static struct closed_form closed_form_of(const struct step *step, int state, const mpq_t *start)
{
	const struct linear *system = &step->branch->system;
	struct resolvent *resolvent = step->branch->resolvent;
	struct output output = state_as_output(system, state);
	struct closed_form form;
	form.count = responses_of_output(resolvent, system, start, &output, &form.list);
	ENLARGE(form.list, (size_t)form.count + (size_t)system->inputs);
	for (int i = 0; i < system->inputs; i++) {
		form.list[form.count] = (struct started){
			.response = response_of_input(resolvent, system, state, i, 0, step->model->h)
		};
		mpq_init(form.list[form.count++].start);
	}
	return form;
}

static struct closed_form *closed_forms(const struct step *step, struct reference *r)
{
	int n = r->states;
	mpq_t *start = rationals(n);
	struct closed_form *form = ARRAY(struct closed_form, n);
	for (int i = 0; i < n; i++) {
		reference_start(i, start[i]);
		r->start[i] = round_rational(start[i]);
	}
	for (int i = 0; i < n; i++)
		form[i] = closed_form_of(step, i, start);
	return form;
}

static bool fill_row(const struct step *step, const struct closed_form *form, mpq_srcptr t, double *row)
{
	struct place at = step->model->request.at.step;
	bool finite = true;
	for (int i = 0; i < step->branch->system.states; i++) {
		row[i] = started_value(form[i].count, form[i].list, t, false, at, "a value of the self-test").value;
		finite = finite && isfinite(row[i]);
	}
	return finite;
}

static void fill_rows(const struct step *step, const struct closed_form *form, struct reference *r)
{
	RATIONAL t = ZERO;
	for (r->rows = 0; r->rows < FEW_ROWS; r->rows++) {
		mpq_set_ui(t, r->steps[r->rows], 1);
		mpq_mul(t, t, step->model->h);
		if (!fill_row(step, form, t, r->value + r->rows * r->states))
			break;                  /* what grows leaves the range: shorter */
	}
	mpq_div_2exp(t, step->model->h, 1);
	if (step->series.emitted)
		fill_row(step, form, t, r->between);
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
	/* the enclosed trajectory walks through tables of all regions */
	const bool cached = step->model->switching && step->model->switching->cached;
	return step->is.flow == FLOW_LINEAR && steps_exactly(step->model) && !step->model->delays && !cached &&
	       !further_samples(&step->model->system);
}

struct reference reference_of(const struct step *step)
{
	if (step->model->switching)
		return reference_of_trajectory(step);
	struct reference r = new_reference(step->branch->system.states);
	fill_rows(step, closed_forms(step, &r), &r);
	reference_units(&r, step->model->request.single);
	return r;
}
