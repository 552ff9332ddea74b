/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is so of a step, and what stands against what is asked of it. */
#include "step/linear/rows.h"
#include "step/series/expansion.h"
#include "step/tunable/tuned.h"

/* One matrix over all of a step, of all of x, and outputs that are rows over it? */
static bool is_one_flow(const struct step *step)
{
	bool rows = true;
	for (int i = 0; i < step->model->outputs; i++)
		rows = rows && !(step->model->output[i].peak && step->model->output[i].left);
	return rows && !loads_change(&step->model->system) &&
	       is_linear_alone(step) && (!step->is.tuned || (step->blocks && step->blocks->solved));
}

bool peaks_by_values(const struct step *step)
{
	return has_peak(step->model) && !is_one_flow(step);
}

/* The polynomials of a series and of nodes have values at any time. */
static bool lacks_values(const struct step *step)
{
	return !step->series.emitted && !step->event_split && !step->taylor.expansion && !step->collocation;
}

/* A series of fixed order is one text for all instances, and for all steps. */
static bool adapts(const struct step *step)
{
	const struct model *model = step->model;
	const struct expansion *x = step->taylor.expansion;
	return flow_of(model) == FLOW_SERIES &&
	       (!x || x->columns || x->choices || x->slots || step->taylor.switching || model->truncation.adaptive ||
		mpq_sgn(model->truncation.tolerance) != 0);
}

static bool sums_columns(const struct step *step)
{
	bool any = false;
	for (int k = 0; step->program && k < step->program->groups; k++)
		any = any || step->program->group[k].kind == GROUP_COLUMNS;
	return any;
}

struct facts facts_of_step(const struct step *step)
{
	struct facts facts = facts_of_model(step->model);
	facts.far = lacks_values(step);
	facts.sought = peaks_by_values(step);
	facts.columns = sums_columns(step);
	facts.modal = step->modal != NULL;
	facts.adapts = adapts(step);
	facts.staged = step->taylor.expansion && step->taylor.expansion->lines;
	facts.checked = step->regions.event_check.by_region && !step->model->params.retuned && !step->is.two_words &&
			!step->carried.count && !step->model->relative;
	return facts;
}

const char *step_objection(const struct step *step, enum capability requested)
{
	const struct facts facts = facts_of_step(step);
	return objection_to(requested, &facts, step->model).why;
}

bool has_remainder(const struct step *step)
{
	return flow_of(step->model) != FLOW_LINEAR;
}
