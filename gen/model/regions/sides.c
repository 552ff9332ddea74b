/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What decides on the sign of a form, and forms as they are on one side of where it is 0. */
#include "inner.h"

enum { LIMIT_EXTREMES = 32 };       /* of min and max: beyond, pairs are not looked at */

/* ---- what decides ---- */

static const struct atom *product_of(const struct form *form)
{
	const struct atom *a = form->terms == 1 ? form->term[0].basis.atom : NULL;
	return a && a->kind == ATOM_PRODUCT ? a : NULL;
}

void visit_surfaces(const struct form *d, void (*visit)(void *context, const struct form *g), void *context)
{
	const struct atom *product = product_of(d);
	/* what is constant but for steps passes 0 only where another surface lies */
	if (is_constant(d) || is_stepwise(d))
		return;
	for (int i = 0; product && i < product->operands; i++)
		if (product->exponent[i] % 2)
			visit_surfaces(product->operand[i], visit, context);
	if (!product)
		visit(context, d);
}

static const struct atom *comparison_of(const struct form *condition)
{
	const struct atom *a = condition->terms == 1 ? condition->term[0].basis.atom : NULL;
	return a && a->kind == ATOM_COMPARE ? a : NULL;
}

/* sqrt(x^2) is abs(x). */
static const struct form *root_of_square(const struct atom *a)
{
	const struct atom *square = a->kind == ATOM_CALL && a->function == FN_SQRT ? product_of(a->operand[0]) : NULL;
	return square && square->operands == 1 && square->exponent[0] == 2 ? square->operand[0] : NULL;
}

void visit_decisions(const struct atom *a, void (*visit)(void *context, const struct form *d), void *context)
{
	const struct form *const *x = a->operand;
	if (root_of_square(a))
		visit(context, root_of_square(a));
	if (a->kind == ATOM_COMPARE)
		visit(context, form_difference(x[0], x[1]));
	if (a->kind == ATOM_CHOOSE && !comparison_of(x[0]))
		visit(context, x[0]);
	if (a->kind != ATOM_CALL)
		return;
	if (a->function == FN_ABS || a->function == FN_SGN)
		visit(context, x[0]);
	for (int i = 0; (a->function == FN_MIN || a->function == FN_MAX) && i < a->operands && i < LIMIT_EXTREMES; i++)
		for (int j = i + 1; j < a->operands && j < LIMIT_EXTREMES; j++)
			visit(context, form_difference(x[i], x[j]));
	for (int i = 1; (a->function == FN_CLIP || a->function == FN_DEADZONE) && i < 3; i++)
		visit(context, form_difference(x[0], x[i]));
	for (int k = 3; a->function == FN_TABLE && k + 2 < a->operands; k += 2)
		visit(context, form_difference(x[0], x[k]));
}

/* ---- forms on one side of a surface ---- */

/* d as a multiple of g: the sign of the multiple; 0: it is none */
static int multiple_of(const struct form *d, const struct form *g)
{
	RATIONAL ratio = ZERO;
	return is_form_multiple(d, g, ratio) ? mpq_sgn(ratio) : 0;
}

struct looking_for { const struct form *g; bool found; };

static void compare_surface(void *context, const struct form *g)
{
	struct looking_for *l = context;
	l->found = l->found || multiple_of(g, l->g) != 0;
}

static void compare_decision(void *context, const struct form *d)
{
	visit_surfaces(d, compare_surface, context);
}

static bool touches(struct side *s, const struct form *form);

static bool atom_touches(struct side *s, const struct atom *a)
{
	if (a->index >= s->count)
		return false;
	if (s->touched[a->index] == 0) {
		struct looking_for l = { s->g, false };
		visit_decisions(a, compare_decision, &l);
		for (int k = 0; k < a->operands && !l.found; k++)
			l.found = touches(s, a->operand[k]);
		s->touched[a->index] = l.found ? 1 : -1;
	}
	return s->touched[a->index] > 0;
}

static bool touches(struct side *s, const struct form *form)
{
	for (int i = 0; i < form->terms; i++)
		if (form->term[i].basis.atom && atom_touches(s, form->term[i].basis.atom))
			return true;
	return false;
}

/* The sign of a form as far as g decides on it: sign times that of `rest`, NULL: 1 */
struct decided {
	bool known;
	int sign;
	const struct form *rest;
};

static struct decided decide(const struct side *s, const struct form *d)
{
	mpq_t value;
	const struct atom *product = product_of(d);
	if (is_constant(d)) {
		mpq_init(value);
		constant_value(s->c, d, value);
		struct decided result = { true, mpq_sgn(value), NULL };
		mpq_clear(value);
		return result;
	}
	int multiple = multiple_of(d, s->g);
	if (multiple)
		return (struct decided){ true, multiple * s->sign, NULL };
	for (int i = 0; product && i < product->operands; i++) {
		multiple = multiple_of(product->operand[i], s->g);
		if (!multiple)
			continue;
		const struct form *rest = form_number(mpq_sgn(d->term[0].factor));
		for (int k = 0; k < product->operands; k++)
			if (k != i)
				rest = kept_product(s->c, product->node, rest,
						    kept_whole_power(s->c, product->node, product->operand[k],
								     product->exponent[k]));
		return (struct decided){ true, product->exponent[i] % 2 ? multiple * s->sign : s->sign != 0,
					 is_constant(rest) ? NULL : rest };
	}
	return (struct decided){ false, 0, NULL };
}

static struct form *copy(const struct form *form)
{
	return form_sum(form, form_number(0), false);
}

/* sgn(rest) times the sign found */
static struct form *sign_form(const struct side *s, const struct atom *a, struct decided d)
{
	struct form *rest = d.rest ? copy(d.rest) : NULL;
	return rest ? kept_product(s->c, a->node, form_number(d.sign), kept_call(s->c, a->node, FN_SGN, 1, &rest))
		    : form_number(d.sign);
}

/* min or max without those that another one beats for sure */
static struct form *extreme_on_side(const struct side *s, const struct atom *a, struct form *const *x)
{
	struct form **left = ARRAY(struct form *, a->operands);
	int count = 0, wanted = a->function == FN_MIN ? 1 : -1;
	for (int i = 0; i < a->operands; i++) {
		bool beaten = false;
		for (int j = 0; j < a->operands && i < LIMIT_EXTREMES && j < LIMIT_EXTREMES && !beaten; j++) {
			const struct decided d = i == j ? (struct decided){ false, 0, NULL }
							: decide(s, form_difference(x[i], x[j]));
			beaten = d.known && !d.rest && (d.sign == wanted || (d.sign == 0 && j < i));
		}
		if (!beaten)
			left[count++] = x[i];
	}
	return count == 1 ? left[0] : kept_call(s->c, a->node, a->function, count, left);
}

static struct form *clip_on_side(const struct side *s, const struct atom *a, struct form *const *x)
{
	struct decided low = decide(s, form_difference(x[0], x[1])), high = decide(s, form_difference(x[0], x[2]));
	struct form *clipped, *upper[] = { x[0], x[2] }, *lower[] = { x[0], x[1] };
	if (low.known && !low.rest)
		clipped = low.sign < 0                                ? x[1]
			  : high.known && !high.rest && high.sign > 0 ? x[2]
								      : kept_call(s->c, a->node, FN_MIN, 2, upper);
	else if (high.known && !high.rest)
		clipped = high.sign > 0 ? x[2] : kept_call(s->c, a->node, FN_MAX, 2, lower);
	else
		clipped = kept_call(s->c, a->node, FN_CLIP, 3, x);
	return a->function == FN_CLIP ? clipped : form_difference(x[0], clipped);
}

/* Near one of its points a table is one of the two pieces beside it. */
static struct form *table_on_side(const struct side *s, const struct atom *a, struct form *const *x)
{
	for (int k = 3; k + 2 < a->operands; k += 2) {
		struct decided d = decide(s, form_difference(x[0], x[k]));
		if (!d.known || d.rest)
			continue;
		int left = d.sign > 0 ? k : k - 2;
		struct form *rise = form_difference(x[left + 3], x[left + 1]),
			    *width = form_difference(x[left + 2], x[left]);
		struct form *slope = kept_product(s->c, a->node, rise, kept_reciprocal(s->c, a->node, width));
		return form_sum(x[k + 1], kept_product(s->c, a->node, slope, form_difference(x[0], x[k])), false);
	}
	return kept_call(s->c, a->node, FN_TABLE, a->operands, x);
}

static struct form *call_on_side(const struct side *s, const struct atom *a, struct form *const *x)
{
	struct decided d;
	switch (a->function) {
	case FN_ABS:
	case FN_SGN:
		d = decide(s, x[0]);
		if (!d.known)
			break;
		return a->function == FN_SGN ? sign_form(s, a, d)
					     : kept_product(s->c, a->node, sign_form(s, a, d), x[0]);
	case FN_SQRT:
		d = root_of_square(a) ? decide(s, root_of_square(a)) : (struct decided){ false, 0, NULL };
		if (!d.known || product_of(x[0]) != product_of(a->operand[0]))
			break;
		return kept_product(s->c, a->node, kept_product(s->c, a->node, sign_form(s, a, d), root_of_square(a)),
				    kept_power(s->c, a->node, form_constant(x[0]->term[0].factor),
					       kept_reciprocal(s->c, a->node, form_number(2))));
	case FN_MIN:
	case FN_MAX:      return extreme_on_side(s, a, x);
	case FN_CLIP:
	case FN_DEADZONE: return clip_on_side(s, a, x);
	case FN_TABLE:    return table_on_side(s, a, x);
	default:          break;
	}
	return kept_call(s->c, a->node, a->function, a->operands, x);
}

static struct form *comparison_on_side(const struct side *s, const struct atom *a, struct form *const *x)
{
	struct decided d = decide(s, form_difference(x[0], x[1]));
	if (!d.known)
		return kept_comparison(s->c, a->node, a->comparison, x[0], x[1]);
	if (d.rest && d.sign)
		return kept_comparison(s->c, a->node, a->comparison,
				       kept_product(s->c, a->node, form_number(d.sign), d.rest), form_number(0));
	return form_number(compare_values(a->comparison, d.sign));
}

static struct form *atom_on_side(struct side *s, const struct atom *a)
{
	struct form **x = ARRAY(struct form *, a->operands);
	for (int i = 0; i < a->operands; i++)
		x[i] = form_on_side(s, a->operand[i]);
	struct decided d = a->kind == ATOM_CHOOSE ? decide(s, x[0]) : (struct decided){ false, 0, NULL };
	return a->kind == ATOM_CALL      ? call_on_side(s, a, x)
	       : a->kind == ATOM_COMPARE ? comparison_on_side(s, a, x)
	       : d.known && !d.rest      ? x[d.sign ? 1 : 2]
					 : kept_again(s->c, a, x);
}

struct form *form_on_side(struct side *s, const struct form *form)
{
	struct form *total = form_number(0);
	for (int i = 0; i < form->terms; i++) {
		const struct form_term *term = &form->term[i];
		const struct atom *a = term->basis.atom;
		bool changes = a && atom_touches(s, a);
		if (changes && !s->known[a->index])
			s->known[a->index] = atom_on_side(s, a);
		if (changes)
			form_add_to(total, s->known[a->index], term->factor);
		else
			form_add_basis(total, term->basis, term->factor);
	}
	return total;
}
