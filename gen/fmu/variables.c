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

/* The comment at the end of a line: without # and white space; NULL: there is none */
static const char *comment_behind(struct place at)
{
	const char *text = at.source->text + at.offset, *end = text + strcspn(text, "\r\n");
	for (bool quoted = false; text < end && (*text != '#' || quoted); text++)
		quoted = quoted != (*text == '"');
	while (text < end && strchr("# \t", *text))
		text++;
	while (end > text && strchr(" \t", end[-1]))
		end--;
	return end > text ? format("%.*s", (int)(end - text), text) : NULL;
}

/* What the spec says of a name where it is declared; of an output that is called like a coordinate, either */
static const char *description_of(const struct spec *spec, const char *name)
{
	const char *text = NULL;
	for (const struct symbol *s = spec->first; s; s = s->next)
		if (s->number > 0 && strcmp(s->name, name) == 0 && comment_behind(s->at))
			text = comment_behind(s->at);
	return text;
}

/* Inputs and outputs are in their units, all else is in SI units and may be shown in others. */
static void set_unit(struct fmu_variable *v, const struct unit *unit)
{
	const bool kept = v->kind == FMU_INPUT || v->kind == FMU_OUTPUT;
	v->unit = !unit || kept ? unit : unit_in_si(unit);
	v->shown = !unit || kept || is_coherent(unit) ? NULL : unit;
}

static const struct symbol *symbol_named(const struct spec *spec, const char *name, enum symbol_kind kind)
{
	const struct symbol *s = spec->first;
	while (s && (s->kind != kind || strcmp(s->name, name) != 0))
		s = s->next;
	return s;
}

/* The unit of a state, as its coordinate is written */
static const struct unit *unit_of_shown_state(const struct model *shown, int state)
{
	const struct symbol *coord = shown->frame.coord[shown->system.coord[state]];
	return unit_of_state(shown, state) ? unit_of_derivative(coord->unit, state >= shown->n) : NULL;
}

/* As it is; `otherwise` where that is another's, with _ as often as it takes */
static void add(struct fmu_variables *v, enum fmu_kind kind, const char *name, const char *otherwise, double start)
{
	const char *own = is_taken(v, name) ? otherwise : name;
	while (is_taken(v, own))
		own = format("%s_", own);
	v->variable[v->count++] = (struct fmu_variable){ .kind = kind, .name = own, .start = start };
}

/* Params that are numbers of the model, and follow from no tunable one */
static void add_constants(struct fmu_variables *v, const struct spec *spec)
{
	RATIONAL value = ZERO;
	for (const struct symbol *s = spec->first; s; s = s->next) {
		if (s->kind != SYMBOL_PARAM || s->tuning.tuned)
			continue;
		param_value(s, value);
		add(v, FMU_CONSTANT, s->name, format("param.%s", s->name), round_rational(value));
		set_unit(&v->variable[v->count - 1], s->unit);
		v->constants++;
	}
}

struct fmu_variables variables_of(const struct step *step)
{
	const struct model *model = step->model, *shown = step->shown->model;
	const struct linear *system = &step->branch->system;
	const struct tuning *tuning = tunables_of(model);
	const int params = tuning ? tuning->given : 0;
	const int all = 1 + outer_inputs(model) + model->outputs + params + system->states +
			model->spec->count.params;
	struct fmu_variables v = { 0, 0, ARRAY(struct fmu_variable, all) };
	add(&v, FMU_TIME, "time", "time", 0);
	v.variable[0].unit = model->spec->units.written ? unit_parse((struct place){ NULL, 1 }, "s", 1) : NULL;
	for (int i = 0; i < outer_inputs(model); i++) {
		add(&v, FMU_INPUT, system->input[i].name, format("input.%s", system->input[i].name), 0);
		set_unit(&v.variable[v.count - 1],
			 symbol_named(model->spec, system->input[i].name, SYMBOL_INPUT)->unit);
	}
	for (int i = 0; i < model->outputs; i++) {
		add(&v, FMU_OUTPUT, model->output[i].name, format("output.%s", model->output[i].name), 0);
		set_unit(&v.variable[v.count - 1], model->output[i].unit);
	}
	for (int i = 0; i < params; i++) {
		add(&v, FMU_PARAM, tuning->param[i].symbol->name, format("param.%s", tuning->param[i].symbol->name),
		    round_rational(tuning->nominal[i]));
		v.variable[v.count - 1].range = model->params.range[i];
		set_unit(&v.variable[v.count - 1], tuning->param[i].symbol->unit);
	}
	/* most outputs are named like the state that they are */
	for (int i = 0; i < system->states; i++) {
		add(&v, FMU_STATE, format("state.%s", shown->names.state[i]), format("state.%s", shown->names.state[i]),
		    round_rational(shown->initial[i]));
		if (!shown->reduction.truncated)
			set_unit(&v.variable[v.count - 1], unit_of_shown_state(shown, i));
	}
	add_constants(&v, model->spec);
	for (int i = 0; i < v.count; i++) {
		const size_t before = v.variable[i].kind == FMU_STATE ? strlen("state.") : 0;
		v.variable[i].description = description_of(model->spec, v.variable[i].name + before);
	}
	return v;
}
