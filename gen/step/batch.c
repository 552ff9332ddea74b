/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which models many instances of can be stepped in one call: those whose instances share all but state and factors. */
#include "step/step.h"

static const char *objection_of_kind(const struct step *step)
{
	static const char *const of_kind[KINDS] = {
		[KIND_REGIONS] = "where an instance crosses a breakpoint is a matter of its own",
		[KIND_PARTS] = "where an instance crosses a breakpoint is a matter of its own",
		[KIND_LEFTOVER] = "what is left over is not linear in the state",
		[KIND_CUT] = "what is left over is not linear in the state",
		[KIND_EXPANDED] = "what is left over is not linear in the state",
		[KIND_COLLOCATED] = "what is left over is not linear in the state",
		[KIND_NORMAL] = "each instance would keep the forces of its last steps"
	};
	return of_kind[step->kind];
}

static const char *objection_of_loads(const struct step *step)
{
	if (step->branch->system.segments > 1)
		return "its loads change their formula inside a step";
	if (step->model->tuning && step->model->tuning->frequencies > 0)
		return "each instance would have loads of its own frequency";
	return NULL;
}

/* Does an input that is held, or a slope, enter an output for some values of the params? */
static bool jumps(const struct model *model, const struct output *output)
{
	const struct tuning *t = model->tuning;
	int row = t ? t->output[output - model->output] : -1;
	bool any = false;
	for (int i = 0; i < model->system.inputs; i++) {
		int hold = model->system.input[i].hold;
		bool value = mpq_sgn(output->input[0][i]) != 0, slope = mpq_sgn(output->input[1][i]) != 0;
		if (row >= 0)
			value = value || t->acts[row * t->x.size + t->x.input[i]];
		if (row >= 0 && hold)
			slope = slope || t->acts[row * t->x.size + t->x.input[i] + 1];
		any = any || (hold == 0 && value) || slope;
	}
	return any;
}

static const char *objection_of_outputs(const struct model *model)
{
	for (int i = 0; i < model->outputs; i++)
		if (model->output[i].left)
			return format("output %s is not linear", model->output[i].name);
		else if (model->output[i].peak && jumps(model, &model->output[i]))
			return format("output %s is the peak of what jumps with the samples", model->output[i].name);
	if (model->relative && !model->declared_outputs)
		return "its states are kept as differences: declare outputs";
	return NULL;
}

void need_batch(const struct step *step)
{
	const char *why = objection_of_kind(step);
	why = why ? why : objection_of_loads(step);
	why = why ? why : objection_of_outputs(step->model);
	if (!why && scheme_row(step->model->scheme)->holds_coupling && peak_outputs(step->model) > 0)
		why = "peaks inside its steps depend on terms that its scheme holds";
	if (!why && step->model->written->ranges > 0)
		why = "ranges are looked at in the steps of one instance";
	if (!why && step->program->loops)
		why = format("beyond %d states a step loops over its tables", LIMIT_UNROLLED_STATES);
	if (why)
		error((struct place){ source_argument("--batch"), 0 }, NULL,
		      "--batch cannot step many instances of this model: %s", why);
}
