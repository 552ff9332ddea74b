/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear systems that a step is made of. */
#include "model/regions/regions.h"
#include "images.h"

/* The ramps of inputs as channels: u', held and as the slope of u */
static struct linear driven_system(const struct linear *region)
{
	struct linear system = *region;
	system.channels = 2 * region->inputs;
	system.channel = ARRAY(mpq_t *, system.channels);
	for (int i = 0; i < system.channels; i++)
		system.channel[i] = region->input[i / 2].force[i % 2];
	return system;
}

/* The linear system of each operator, and what of it a step takes */
void take_operators(struct step *step)
{
	const struct model *model = step->model;
	const struct switching *regions = model->switching;
	bool holds = scheme_row(model->scheme)->holds_coupling;
	/* in normal modes, what else reads a branch is content with the first operator's */
	int operators = step->kind == KIND_NORMAL ? 1 : model->operators;
	step->branches = regions ? regions->systems : operators ? operators : 1;
	step->branch = ARRAY(struct branch, step->branches);
	for (int k = 0; k < step->branches; k++) {
		struct linear system = regions		  ? driven_system(&regions->system[k])
				       : model->operators ? operator_system(model, k)
							  : model->system;
		bool as_written = !regions && !model->operators && model->written == model && !holds;
		step->branch[k].system = holds ? piecewise_laplace(&system) : system;
		step->branch[k].resolvent = as_written ? step->written : resolvent_of(&step->branch[k].system);
		check_pole_size(model, step->branch[k].resolvent);
	}
}
