/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Phases that go on where a frequency changes. cos(w t + p) with a tunable w takes as a further term what its phase has
 * gained over w t where the instance's w was changed: its lead, which the instance holds, a number like a param. */
#include "collect/collect.h"

struct contents { bool time, tuned, other; };

static struct contents contents_of(const struct collector *c, const struct form *form)
{
	struct contents found = { 0 };
	SCRATCH bool *seen = ARRAY(bool, atoms_count(c->atoms));
	for (const struct form_term **term = terms_within(form, seen); *term; term++) {
		const struct basis *basis = &(*term)->basis;
		bool acting = basis->kind == BASIS_INPUT && c->params == PARAMS_INPUTS && basis->index >= c->inputs;
		found.time = found.time || basis->kind == BASIS_FORCING;
		found.tuned = found.tuned || acting || (basis->atom && basis->atom->kind == ATOM_PARAM);
		found.other = found.other || basis->kind == BASIS_COORD || (basis->kind == BASIS_INPUT && !acting);
	}
	return found;
}

/* The terms that read t and tunable params */
static struct form *tuned_part(const struct collector *c, const struct form *x)
{
	struct form *part = NEW(struct form);
	for (int i = 0; i < x->terms; i++) {
		if (!x->term[i].basis.atom)
			continue;
		const struct form *term = form_single(x->term[i].basis, x->term[i].factor);
		const struct contents found = contents_of(c, term);
		if (found.time && found.tuned)
			form_add_to(part, term, NULL);
	}
	return part;
}

static struct form *rate_of(struct collector *c, const struct form *x);

/* A product with one factor that is linear in t, and others without t; else NULL */
static struct form *rate_of_product(struct collector *c, const struct atom *a)
{
	int moving = -1;
	for (int i = 0; i < a->operands; i++) {
		if (!contents_of(c, a->operand[i]).time)
			continue;
		if (moving >= 0 || a->exponent[i] > 1)
			return NULL;
		moving = i;
	}
	struct form *rate = rate_of(c, a->operand[moving]);
	return rate ? kept_product(c, a->node, rate, kept_others(c, a->node, a, moving)) : NULL;
}

/* The coefficient of t; NULL: it is not linear in t */
static struct form *rate_of(struct collector *c, const struct form *x)
{
	struct form *rate = NEW(struct form);
	for (int i = 0; i < x->terms; i++) {
		const struct form_term *term = &x->term[i];
		const struct atom *a = term->basis.atom;
		const struct form *slope = NULL;
		if (!contents_of(c, form_unit(term->basis)).time)
			continue;
		if (term->basis.kind == BASIS_FORCING && is_polynomial(term->basis.forcing) && term->basis.power < 2)
			slope = form_number(term->basis.power);
		else if (a && a->kind == ATOM_PRODUCT)
			slope = rate_of_product(c, a);
		if (!slope)
			return NULL;
		form_add_to(rate, slope, term->factor);
	}
	return rate;
}

static const struct symbol *lead_of(struct leads *leads, const struct form *rate)
{
	for (int k = 0; k < leads->count; k++)
		if (same_form(leads->lead[k].rate, rate))
			return leads->lead[k].symbol;
	struct value *none = NEW(struct value);
	*none = (struct value){ 1, 1, ARRAY(struct form *, 1) };
	none->cell[0] = form_number(0);
	struct symbol *symbol = NEW(struct symbol);
	*symbol = (struct symbol){ .kind = SYMBOL_PARAM,
				   .name = format("lead%d", leads->count + 1),
				   .tuning.number = leads->params + leads->count + 1,
				   .made.value = none };
	*MORE(leads->lead, leads->count) = (struct lead){ rate, symbol };
	return symbol;
}

struct form *with_lead(struct collector *c, const struct node *node, struct form *x)
{
	if (c->params == PARAMS_VALUES || !c->whole_time)       /* of intervals of time the loads count alone */
		return x;
	const struct form *part = tuned_part(c, x);
	if (part->terms == 0)
		return x;
	struct form *rate = rate_of(c, part);
	if (rate && !contents_of(c, rate).other)
		return form_sum(x, kept_param(c, node, lead_of(c->leads, rate)), false);
	if (!c->leads->jumps)
		c->leads->jumps = node;
	return x;
}
