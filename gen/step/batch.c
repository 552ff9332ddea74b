/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Which models many instances of can be stepped in one call: those whose instances share all but state and factors. */
#include "step/step.h"

static const char *objection_of_kind(const struct step *step)
{
	static const char *const of_kind[KINDS] = {
		[KIND_REGIONS] = "where an instance crosses a breakpoint is a matter of its own",
		[KIND_LEFTOVER] = "what is left over is not linear in the state"
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

static const char *objection_of_outputs(const struct model *model)
{
	for (int i = 0; i < model->outputs; i++)
		if (model->output[i].left)
			return format("output %s is not linear", model->output[i].name);
		else if (model->output[i].peak)
			return format("output %s is a peak: those of a batch are in its array `peak`",
				      model->output[i].name);
	if (model->relative && !model->declared_outputs)
		return "its states are kept as differences: declare outputs";
	return NULL;
}

void need_batch(const struct step *step)
{
	const char *why = objection_of_kind(step);
	why = why ? why : objection_of_loads(step);
	why = why ? why : objection_of_outputs(step->model);
	if (!why && step->program->loops)
		why = format("beyond %d states a step loops over its tables", LIMIT_UNROLLED_STATES);
	if (why)
		error((struct place){ source_argument("--batch"), 0 }, NULL,
		      "--batch cannot step many instances of this model: %s", why);
}
