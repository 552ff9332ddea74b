/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Names and start values of what the importer sees. */
#include "fmu/fmu.h"
#include "model/tunable/tuning.h"
#include "step/step.h"

#include <string.h>

static bool is_taken(const struct fmu_variables *v, const char *name)
{
	for (int i = 0; i < v->count; i++)
		if (strcmp(v->variable[i].name, name) == 0)
			return true;
	return false;
}

/* As it is; `otherwise` where that is another's, with _ as often as it takes */
static void add(struct fmu_variables *v, enum fmu_kind kind, const char *name, const char *otherwise, double start)
{
	const char *own = is_taken(v, name) ? otherwise : name;
	while (is_taken(v, own))
		own = format("%s_", own);
	v->variable[v->count++] = (struct fmu_variable){ kind, own, start, NULL };
}

struct fmu_variables variables_of(const struct step *step)
{
	const struct model *model = step->model, *shown = step->shown->model;
	const struct linear *system = &step->branch->system;
	const struct tuning *tuning = tunables_of(model);
	const int params = tuning ? tuning->given : 0;
	const int all = 1 + model->spec->count.inputs + model->outputs + params + system->states;
	struct fmu_variables v = { 0, ARRAY(struct fmu_variable, all) };
	add(&v, FMU_TIME, "time", "time", 0);
	for (int i = 0; i < model->spec->count.inputs; i++)
		add(&v, FMU_INPUT, system->input[i].name, format("input.%s", system->input[i].name), 0);
	for (int i = 0; i < model->outputs; i++)
		add(&v, FMU_OUTPUT, model->output[i].name, format("output.%s", model->output[i].name), 0);
	for (int i = 0; i < params; i++) {
		add(&v, FMU_PARAM, tuning->param[i].symbol->name, format("param.%s", tuning->param[i].symbol->name),
		    round_rational(tuning->nominal[i]));
		v.variable[v.count - 1].range = model->params.range[i];
	}
	/* most outputs are named like the state that they are */
	for (int i = 0; i < system->states; i++)
		add(&v, FMU_STATE, format("state.%s", shown->names.state[i]), format("state.%s", shown->names.state[i]),
		    round_rational(shown->initial[i]));
	return v;
}
