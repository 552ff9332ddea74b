/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Units of what a model shows: those that are written, and those that follow from them. */
#include "model/tunable/tuning.h"
#include "report/report.h"
#include "step/step.h"

#include <string.h>

static const char *text_of(const struct unit *unit)
{
	return unit ? unit->text : "";
}

const char *unit_of_listed(const struct step *step, enum listed kind, int index)
{
	const struct model *model = step->shown->model, *written = model->written;
	switch (kind) {
	case LISTED_STATE:  return text_of(model->reduction.truncated ? NULL : unit_of_state(model, index));
	case LISTED_INPUT:  return text_of(written->system.input[index].unit);
	case LISTED_OUTPUT: return text_of(model->output[index].unit);
	default:            return text_of(tunables_of(step->model)->param[index].symbol->unit);
	}
}

const char *labelled(const struct model *model, const char *name)
{
	const char *unit = "";
	for (int i = 0; i < model->outputs && !*unit; i++)
		if (strcmp(model->output[i].name, name) == 0)
			unit = text_of(model->output[i].unit);
	for (int i = 0; i < model->spec->count.inputs && !*unit; i++)
		if (strcmp(model->system.input[i].name, name) == 0)
			unit = text_of(model->system.input[i].unit);
	return *unit ? format("%s [%s]", name, unit) : name;
}

static const char *list_of(const struct step *step, enum listed kind, int count, const char *what)
{
	const struct model *model = step->shown->model;
	const char *text = "";
	for (int i = 0; i < count; i++) {
		const char *unit = unit_of_listed(step, kind, i);
		const char *name = kind == LISTED_STATE   ? model->names.state[i]
				   : kind == LISTED_INPUT ? model->system.input[i].name
							  : model->output[i].name;
		if (*unit)
			text = format("%s%s%s [%s]", text, *text ? ", " : what, name, unit);
	}
	return text;
}

const char *units_text(const struct step *step)
{
	const struct model *model = step->shown->model;
	if (!model->spec->units.written)
		return NULL;
	const char *list[] = { list_of(step, LISTED_STATE, model->system.states, "states "),
			       list_of(step, LISTED_INPUT, model->spec->count.inputs, "inputs "),
			       list_of(step, LISTED_OUTPUT, model->outputs, "outputs ") };
	const char *text = "";
	for (int i = 0; i < 3; i++)
		if (*list[i])
			text = format("%s%s%s", text, *text ? "; " : "Units: ", list[i]);
	return *text ? format("%s.", text) : NULL;
}

static void json_list(FILE *to, const struct step *step, const char *key, enum listed kind, int count, bool last)
{
	fprintf(to, "\"%s\": [", key);
	for (int i = 0; i < count; i++) {
		const char *unit = unit_of_listed(step, kind, i);
		fprintf(to, *unit ? "%s\"%s\"" : "%snull", i ? ", " : "", unit);
	}
	fputs(last ? "]" : "], ", to);
}

void json_units(FILE *to, const struct step *step)
{
	const struct model *model = step->shown->model;
	const struct tuning *tuning = tunables_of(step->model);
	if (!model->spec->units.written)
		return;
	fputs("  \"units\": {", to);
	json_list(to, step, "states", LISTED_STATE, model->system.states, false);
	json_list(to, step, "outputs", LISTED_OUTPUT, model->outputs, false);
	json_list(to, step, "inputs", LISTED_INPUT, model->spec->count.inputs, !tuning);
	if (tuning)
		json_list(to, step, "params", LISTED_PARAM, tuning->given, true);
	fputs("},\n", to);
}
