/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is piecewise linear, and products with what is constant but for comparisons: choices among multiples. */
#include "collect/collect.h"

static bool is_comparison(const struct form *form)
{
	const struct form_term *only = form->terms == 1 ? form->term : NULL;
	const struct atom *atom = only ? only->basis.atom : NULL;
	return atom && atom->kind == ATOM_COMPARE && atom->comparison <= CMP_GE && mpq_cmp_ui(only->factor, 1, 1) == 0;
}

static bool is_piecewise_atom(const struct atom *a)
{
	bool function = a->kind == ATOM_CALL && a->function >= FN_ABS;
	bool choice = a->kind == ATOM_CHOOSE && is_comparison(a->operand[0]);
	bool comparison = a->kind == ATOM_COMPARE && a->comparison <= CMP_GE;
	bool all = function || choice || comparison;
	for (int i = 0; i < a->operands && all; i++)
		all = is_piecewise_form(a->operand[i]);
	return all;
}

bool is_piecewise_form(const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (a && a->judged->piecewise == 0)
			a->judged->piecewise = is_piecewise_atom(a) ? 1 : -1;
		if (a && a->judged->piecewise < 0)
			return false;
	}
	return true;
}

bool is_stepwise(const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (!a && form->term[i].basis.kind > BASIS_PI)
			return false;
		if (a && a->judged->stepwise == 0) {
			bool step = a->kind == ATOM_COMPARE || (a->kind == ATOM_CALL && a->function == FN_SGN);
			step = step ||
			       (a->kind == ATOM_CHOOSE && is_stepwise(a->operand[1]) && is_stepwise(a->operand[2]));
			a->judged->stepwise = step ? 1 : -1;
		}
		if (a && a->judged->stepwise < 0)
			return false;
	}
	return true;
}

/* Then a product with it is a choice among multiples; conditions on time alone stay factors. */
static bool is_switch(const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (a && !a->state && !a->input)
			return false;
	}
	return is_stepwise(form);
}

static struct form *switched_atom(struct collector *c, const struct node *node, const struct atom *a,
				  const struct form *x);

static struct form *switched_form(struct collector *c, const struct node *node, const struct form *form,
				  const struct form *x)
{
	struct form *total = form_number(0);
	for (int i = 0; i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		struct form *product = term->basis.atom
					       ? form_scale(switched_atom(c, node, term->basis.atom, x), term->factor)
					       : form_product(c, form_single(term->basis, term->factor), x);
		total = form_sum(total, product, false);
	}
	return total;
}

/* sgn(g) x: abs(g) times k where x = k g */
static struct form *signed_product(struct collector *c, const struct node *node, const struct form *g,
				   const struct form *x)
{
	const struct form *zero = form_number(0), *none = form_number(0);
	RATIONAL ratio = ZERO;
	if (g->terms == x->terms)
		mpq_div(ratio, x->term[0].factor, g->term[0].factor);
	struct form *form, *argument = form_sum(g, zero, false);
	if (mpq_sgn(ratio) != 0 && same_form(x, form_scale(g, ratio))) {
		form = form_scale(kept_call(c, call_at(node, FN_ABS, 1), FN_ABS, 1, &argument), ratio);
	} else {
		form = kept_choice(c, node, kept_comparison(c, node, CMP_LT, g, zero), form_difference(zero, x), none);
		form = kept_choice(c, node, kept_comparison(c, node, CMP_GT, g, zero), x, form);
	}
	return form;
}

static struct form *switched_atom(struct collector *c, const struct node *node, const struct atom *a,
				  const struct form *x)
{
	const struct form *itself = form_unit((struct basis){ .kind = BASIS_ATOM, .index = a->index, .atom = a });
	if (a->kind == ATOM_COMPARE)
		return kept_choice(c, node, itself, x, form_number(0));
	if (a->kind == ATOM_CALL)
		return signed_product(c, node, a->operand[0], x);
	return kept_choice(c, node, a->operand[0], switched_form(c, node, a->operand[1], x),
			   switched_form(c, node, a->operand[2], x));
}

struct form *kept_switched(struct collector *c, const struct node *node, const struct form *a, const struct form *b)
{
	bool first = is_switch(a);
	if ((!first && !is_switch(b)) || is_constant(a) || is_constant(b) || !is_piecewise_form(a) ||
	    !is_piecewise_form(b))
		return NULL;
	return switched_form(c, node, first ? a : b, first ? b : a);
}
