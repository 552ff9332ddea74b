/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What goes with what: the facts of a model, and the rows of capability.def that they make true. */
#include "capability.h"
#include "model/contacts/contacts.h"
#include "reads.h"
#include "model/tunable/tuning.h"

#include <string.h>

/* ---- what there is ---- */

enum flow flow_of(const struct model *model)
{
	const struct scheme_row *row = scheme_row(model->scheme);
	if (model->switching || model->params.tuning || (model->remainder.force_columns == 0 && !has_contacts(model)))
		return FLOW_LINEAR;
	return row->modes ? FLOW_NORMAL : row->collocates ? FLOW_COLLOCATION : row->expands ? FLOW_SERIES : FLOW_RECIPE;
}

bool steps_exactly(const struct model *model)
{
	return model->scheme == SCHEME_EXACT ||
	       (model->remainder.force_columns == 0 && !has_contacts(model) &&
		!scheme_row(model->scheme)->holds_coupling);
}

int output_named(const struct model *model, const char *name)
{
	for (int i = 0; i < model->outputs; i++)
		if (strcmp(model->output[i].name, name) == 0)
			return i;
	return -1;
}

/* Of what is not linear, or piecewise linear, no bound is known: it is measured. */
bool goes_by_events(const struct model *model)
{
	return has_contacts(model) || (model->switching && has_events(model->switching));
}

bool is_measured(const struct model *model)
{
	bool measured = model->switching || model->nonlinear.obstacle || model->remainder.force_columns > 0 ||
			goes_by_events(model);
	for (int i = 0; i < model->spec->required.needs && !measured; i++) {
		const int o = output_named(model, model->spec->required.need[i].output);
		const struct output *output = o < 0 ? NULL : &model->output[o];
		measured = output && !output->peak && (output->left || !output->state);
	}
	return measured;
}

/* The first that is not linear; NULL: all are */
static const struct output *bent_output(const struct model *model)
{
	for (int i = 0; i < model->outputs; i++)
		if (model->output[i].left)
			return &model->output[i];
	return NULL;
}

/* One that reads what friction bears, which no slope has */
static const struct output *output_of_friction(const struct model *model)
{
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		if ((output->reads_slider_force && output->slopes) ||
		    (output->left && reads_friction(model, output->left)))
			return output;
	}
	return NULL;
}

bool has_peak(const struct model *model)
{
	bool any = false;
	for (int i = 0; i < model->outputs; i++)
		any = any || model->output[i].peak;
	return any;
}

/* Does an input that is held, or a slope, enter an output for some values of the params? */
static bool jumps(const struct model *model, const struct output *output)
{
	const struct tuning *t = model->params.tuning;
	int row = t && t->output ? t->output[output - model->output] : -1;
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

static const struct output *jumping_peak(const struct model *model)
{
	for (int i = 0; i < model->outputs; i++) {
		const struct output *output = &model->output[i];
		if (output->peak && !output->left && output->input[0] && jumps(model, output))
			return output;
	}
	return NULL;
}

static const char *first_order_coordinate(const struct model *model)
{
	for (int i = 0; i < model->n && model->system.velocity; i++)
		if (model->system.velocity[i] < 0)
			return model->names.coord[i];
	return NULL;
}

/* Of e^{A tau}, with the forces' polynomials, beyond what a target makes */
static bool has_large_tables(const struct model *model)
{
	if (!is_event_split(model->scheme) || model->remainder.force_columns == 0 || model->schedule.operators == 0)
		return false;
	const struct linear system = operator_system(model, 0);
	return layout_of(&system, SPLIT_POWERS).size > LIMIT_TUNED_BLOCK;
}

struct facts facts_of_model(const struct model *model)
{
	return (struct facts){
#define FACT(name, is) .name = (is),
#include "model/capability.def"
	};
}

/* ---- what stands against it ---- */

struct objection objection_to(enum capability requested, const struct facts *f, const struct model *model)
{
	struct objection o = { NULL, NULL };
	bool now = false;
#define AGAINST(name, when, ...) \
	now = !o.why && requested == CAN_##name && (when); \
	if (now) \
		o.why = format(__VA_ARGS__);
#define WAY_OUT(words) \
	if (now) \
		o.way = words;
#include "model/capability.def"
	return o;
}

const char *words_before(enum capability requested)
{
	static const char *const words[CAPABILITIES] = {
#define REQUESTED(name, words) [CAN_##name] = words,
#include "model/capability.def"
	};
	return words[requested];
}

void refuse(enum capability requested, const struct model *model, struct place at)
{
	const struct facts facts = facts_of_model(model);
	const struct objection o = objection_to(requested, &facts, model);
	if (o.why)
		error(at, o.way, "%s%s", words_before(requested), o.why);
}
