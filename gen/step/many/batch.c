/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of which models many instances step as lanes: those whose instances share all but state and factors. Of others each
 * takes its steps by itself. */
#include "model/tunable/tuning.h"
#include "step/linear/rows.h"

static const char *objection_of_kind(const struct step *step)
{
	static const char *const of_kind[KINDS] = {
		[KIND_REGIONS] = "where it crosses a breakpoint is a matter of its own",
		[KIND_PARTS] = "where it crosses a breakpoint is a matter of its own",
		[KIND_LEFTOVER] = "what is left over is not linear in the state",
		[KIND_CUT] = "what is left over is not linear in the state",
		[KIND_EXPANDED] = "what is left over is not linear in the state",
		[KIND_COLLOCATED] = "what is left over is not linear in the state",
		[KIND_NORMAL] = "it keeps the forces of its last steps"
	};
	const struct model *model = step->model;
	return model->delays			    ? "it keeps its samples of delayed inputs"
	       : of_kind[step->kind]		    ? of_kind[step->kind]
	       : step->branch->system.segments > 1  ? "loads change their formula inside a step"
	       : model->tuning && model->tuning->frequencies > 0 ? "its loads may have a frequency of its own"
	       : peaks_by_values(step)		    ? "peaks are looked for inside its steps"
	       : model->written->ranges > 0	    ? "ranges are looked at in its steps"
	       : step->program->loops		    ? format("beyond %d states a step loops over its tables",
							     LIMIT_UNROLLED_STATES)
						    : NULL;
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
	return model->relative && !model->declared_outputs ? "its states are kept as differences" : NULL;
}

void find_lanes(struct step *step)
{
	const char *why = objection_of_kind(step);
	step->no_lanes = why ? why : objection_of_outputs(step->model);
	if (!step->no_lanes && scheme_row(step->model->scheme)->holds_coupling && peak_outputs(step->model) > 0)
		step->no_lanes = "peaks inside its steps depend on terms that its scheme holds";
}
