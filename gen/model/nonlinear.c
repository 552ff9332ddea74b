/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The terms of the equations that no M, C and K have: what poles, frequency responses and static gains know nothing of.
 * A known load in time is none of them, whatever its formula: all these are the same without it. */
#include "model/building.h"

#include <string.h>

static bool is_after(struct place a, struct place b)
{
	return a.source == b.source && a.offset > b.offset;
}

/* By place; what stands at several is named once */
static void add_term(struct model *model, struct place at, const char *text)
{
	int place = model->nonlinear.terms;
	for (int i = 0; i < model->nonlinear.terms; i++)
		if (strcmp(model->nonlinear.term[i].text, text) == 0)
			return;
	ENLARGE(model->nonlinear.term, (size_t)model->nonlinear.terms + 1);
	for (; place > 0 && is_after(model->nonlinear.term[place - 1].at, at); place--)
		model->nonlinear.term[place] = model->nonlinear.term[place - 1];
	model->nonlinear.term[place] = (struct nonlinear_term){ at, text };
	model->nonlinear.terms++;
}

static void add_form(struct model *model, const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (a && (a->state || a->velocity || a->input))
			add_term(model, a->node->start, text_between(a->node->start, a->node->end));
	}
}

void find_nonlinear(void *building)
{
	struct building *b = building;
	struct model *model = b->model;
	const struct spec *spec = b->spec;
	const struct segment_equations *s = b->nominal ? b->nominal : b->segment_equations;
	const int segments = b->nominal ? b->nominals : model->system.segments;
	for (int k = 0; k < segments; k++) {
		for (int i = 0; i < s[k].residuals; i++)
			add_form(model, s[k].residual[i].form);
		for (int i = 0; i < spec->elements; i++)
			add_form(model, s[k].element[i]);
	}
	for (int i = 0; i < spec->whens; i++)
		add_term(model, spec->when[i].at,
			 written_text(spec->when[i].part, spec->when[i].at, spec->when[i].end));
	for (int k = 1; k < model->system.segments; k++) {
		const struct node *term = changing_factor(b, k);
		if (term)
			add_term(model, term->start, text_between(term->start, term->end));
	}
}
