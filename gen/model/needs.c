/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How exact outputs have to be, until when, for which inputs; what a step may cost on which target. */
#include "capability.h"
#include "checks.h"

#include <string.h>

/* Fitted to the instructions of doc/firmware.md, -O2: of each operation in soft float; where there is hardware, of the
 * whole step, within 10 % */
static const struct target targets[] = {
	{ "cortex-m4", { { 58, 78, 0, 0 }, { 1.5, 1.5, 110, 12 } } },
	{ "cortex-m0", { { 305, 147, 0, 0 }, { 126, 80, 0, 0 } } }
};
enum { TARGETS = sizeof targets / sizeof *targets };

struct finding {
	struct model *model;
	const struct need *need;
	struct requirement *found;
};

static void constant(const struct node *node, mpq_ptr value)
{
	struct collector collector = { .scheme = "exact" };
	collect_constant(&collector, (struct node *)(uintptr_t)node, value);
}

static const char *names_of_outputs(const struct model *model)
{
	enum { SHOWN = 8 };
	const char *list = "";
	for (int i = 0; i < model->outputs && i < SHOWN; i++)
		list = format("%s%s%s", list, i ? ", " : "", model->output[i].name);
	return format("outputs: %s%s", list, model->outputs > SHOWN ? ", ..." : "");
}

/* Inputs of a family are tried, the same for all needs. */
static void check_measured(const struct finding *f)
{
	const struct linear *system = &f->model->system;
	for (int i = 0; i < system->inputs; i++) {
		if (system->input[i].hold > 1)
			error(f->need->at, "hold zero or hold first",
			      "a need is measured with inputs that hold, or ramp from sample to sample: '%s' does "
			      "neither", system->input[i].name);
		if (f->found != f->model->needs.requirement && f->model->needs.requirement->most &&
		    !mpq_equal(f->found->most[i], f->model->needs.requirement->most[i]))
			error(f->need->at, NULL, "needs that are measured have one bound for '%s'",
			      system->input[i].name);
	}
}

static void find_output(const struct finding *f)
{
	const struct model *model = f->model;
	const struct need *need = f->need;
	f->found->output = output_named(model, need->output);
	if (f->found->output < 0)
		error(need->output_at, names_of_outputs(model), "'%s' is not an output", need->output);
	const struct output *output = &model->output[f->found->output];
	if (output->peak)
		error(need->output_at, "a need on what it is the peak of holds for every sample of it, the largest too",
		      "'%s' is a peak: needs are of outputs that follow the state", need->output);
}

static bool is_read(const struct spec *spec, const char *input)
{
	const struct symbol *s = spec->first;
	while (s && strcmp(s->name, input) != 0)
		s = s->next;
	return !s || s->used;
}

/* Of one that nothing reads it does not matter how large it is. */
static void find_inputs(const struct finding *f)
{
	const struct linear *system = &f->model->system;
	f->found->most = rationals(system->inputs);
	bool *bounded = ARRAY(bool, system->inputs);
	for (int k = 0; k < f->need->inputs; k++) {
		const struct need_input *given = &f->need->input[k];
		int i = 0;
		while (i < system->inputs && strcmp(system->input[i].name, given->name) != 0)
			i++;
		if (i == system->inputs)
			error(given->at, system->inputs ? NULL : "the model has none", "'%s' is not an input",
			      given->name);
		constant(convert_unit(given->most, system->input[i].unit, true), f->found->most[i]);
		if (mpq_sgn(f->found->most[i]) <= 0)
			error(given->most->start, NULL, "the bound of an input is above 0, found %s",
			      readable_text(f->found->most[i]));
		bounded[i] = true;
	}
	for (int i = 0; i < system->inputs; i++)
		if (!bounded[i] && is_read(f->model->spec, system->input[i].name))
			error(f->need->at, format("need %s within ... until ... for |%s| <= ...", f->need->output,
						  system->input[i].name),
			      "nothing says how large the input '%s' may be", system->input[i].name);
}

static void find_requirement(void *context)
{
	const struct finding *f = context;
	struct requirement *r = f->found;
	mpq_inits(r->bound, r->until, NULL);
	r->need = f->need;
	refuse(CAN_NEED, f->model, f->need->at);
	find_output(f);
	const struct unit *unit = f->need->percent ? NULL : f->model->output[r->output].unit;
	constant(convert_unit(f->need->bound, unit, true), r->bound);
	if (mpq_sgn(r->bound) <= 0)
		error(f->need->bound->start, NULL, "a need is above 0, found %s", readable_text(r->bound));
	if (f->need->percent) {
		RATIONAL hundred = ZERO;
		mpq_set_ui(hundred, 100, 1);
		mpq_div(r->bound, r->bound, hundred);
	}
	constant(f->need->until, r->until);
	if (mpq_sgn(r->until) < 0)
		error(f->need->until->start, NULL, "a need ends at 0 or later, found %s", readable_text(r->until));
	find_inputs(f);
	if (is_measured(f->model))
		check_measured(f);
}

static void find_budget(void *context)
{
	struct model *model = context;
	const struct budget *budget = &model->spec->required.budget;
	RATIONAL instructions = ZERO;
	if (budget->worst)                      /* step/worst.c */
		return;
	if (model->needs.requirements == 0)
		error(budget->at, "need OUTPUT within BOUND until END",
		      "a budget stands beside a need: there is none");
	for (int i = 0; i < TARGETS; i++)
		if (strcmp(budget->target.name, targets[i].name) == 0)
			model->needs.target = &targets[i];
	if (!model->needs.target)
		error(budget->target.at, "targets: cortex-m4, cortex-m0", "there is no target '%s'",
		      budget->target.name);
	constant(budget->instructions, instructions);
	if (mpq_sgn(instructions) <= 0)
		error(budget->instructions->start, NULL, "a budget is above 0, found %s", readable_text(instructions));
	model->needs.budget = nearest_double(instructions);
}

bool find_requirements(struct model *model)
{
	const struct spec *spec = model->spec;
	bool good = true;
	model->needs.requirement = ARRAY(struct requirement, spec->required.needs);
	model->needs.requirements = spec->required.needs;
	for (int i = 0; i < spec->required.needs; i++) {
		struct finding f = { model, &spec->required.need[i], &model->needs.requirement[i] };
		good = statement_guard(find_requirement, &f) && good;
	}
	if (spec->required.budget.instructions)
		good = statement_guard(find_budget, model) && good;
	return good;
}
