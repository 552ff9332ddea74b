/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Shared by the files of the collector: messages about terms that cannot be treated, and functions of constants. */
#include "collect/collect.h"

static bool holds_acceleration(const struct node *node)
{
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD)
		return node->primes > 0 && node->primes >= node->symbol->highest;
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET) {
		if (node->symbol->highest == 0)         /* not known yet; a let has no order of its own */
			node->symbol->highest = holds_acceleration(node->symbol->value) ? 1 : -1;
		return node->symbol->highest > 0;
	}
	if (node->kind == NODE_NAME)
		return false;
	for (int i = 0; i < node->children; i++)
		if (holds_acceleration(node->child[i]))
			return true;
	return false;
}

struct contents {                   /* of a term, lets looked through */
	const struct node *coordinate; /* the first */
	bool several, time, input, equality, compound;
	int nodes;
};

static void look_into(struct contents *found, const struct node *node)
{
	enum { LOOKED_AT = 10000 };
	const struct node *known = found->coordinate;
	if (++found->nodes > LOOKED_AT) {       /* lets that name each other twice, and so on */
		found->several = true;
		return;
	}
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD) {
		bool same = known && known->symbol == node->symbol && known->primes == node->primes &&
			    known->component == node->component;
		found->several = found->several || (known && !same) || (node->symbol->length && !node->component);
		found->coordinate = known ? known : node;
	}
	if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET && node->symbol->value && !node->symbol->broken)
		look_into(found, node->symbol->value);
	found->input = found->input || (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_INPUT);
	found->time = found->time || node->kind == NODE_TIME;
	found->equality = found->equality || (node->kind == NODE_COMPARE && node->comparison >= CMP_EQ);
	found->compound = found->compound || (node->kind == NODE_CHOOSE && node->child[0]->kind != NODE_COMPARE);
	for (int i = 0; node->kind != NODE_NAME && i < node->children; i++)
		look_into(found, node->child[i]);
}

const char *rewrite_of(const struct node *term, bool force)
{
	struct contents found = { 0 };
	look_into(&found, term);
	if (found.equality)
		return "== and != hold at single points: what < and > divide is exact";
	if (found.compound)
		return "conditions of one comparison each, one inside the other, are exact";
	if (found.input && found.coordinate)
		return "a tunable param in place of the input is exact";
	if (found.input)
		return "an input that brings the whole term is exact";
	if (force && found.coordinate && !found.several && !found.time && !holds_acceleration(term))
		return format("straight pieces in its place, table(%s; ...), are exact",
			      text_between(found.coordinate->start, found.coordinate->end));
	return "";
}

_Noreturn void not_linear(const struct collector *c, const struct node *node, const char *why)
{
	if (c->tolerant)
		abandon();
	const struct node *term = c->term ? c->term : node;
	if (holds_acceleration(term) && (keeps(c) || !c->equation))
		error(term->start,
		      "highest derivatives stand in equations alone, which are linear in them for all time",
		      "term '%s' %s", text_between(term->start, term->end), why);
	if (c->closed)
		error(term->start, NULL, "term '%s' %s: there is no closed form", text_between(term->start, term->end),
		      why);
	const char *rewrite = rewrite_of(term, true);
	error(term->start, format("%s%s%s and %s are the schemes that could", rewrite, *rewrite ? "; " : "",
				  leaving_schemes(", "), holding_schemes()),
	      "term '%s' %s: scheme %s cannot treat it", text_between(term->start, term->end), why, c->scheme);
}

_Noreturn void not_built(const struct collector *c, struct place at, const char *what)
{
	if (c->tolerant)
		abandon();
	if (c->argument)                        /* not even then */
		not_linear(c, c->argument, "is not linear");
	if (c->closed)
		error(at, NULL, "%s not linear: there is no closed form", what);
	error(at, NULL, "%s not built yet", what);
}

/* Is x q pi, a whole number k of 1/parts of pi? */
static bool is_part_of_pi(const struct form *x, unsigned long parts, mpz_ptr k)
{
	mpq_srcptr pi = factor_of(x, BASIS_PI);
	if (x->terms != 1 || !pi || mpz_cmp_ui(mpq_denref(pi), parts) > 0 || parts % mpz_get_ui(mpq_denref(pi)) != 0)
		return false;
	mpz_mul_ui(k, mpq_numref(pi), parts);
	mpz_divexact(k, k, mpq_denref(pi));
	return true;
}

/* sin, cos of q pi are rational at multiples of pi/6 only where it shows here: 0, +-1/2, +-1 (Niven). */
static bool niven(bool sine, const struct form *x, mpq_ptr value)
{
	/* 2 cos(k pi/6); 99: irrational */
	static const int halves[12] = { 2, 99, 1, 0, -1, 99, -2, 99, -1, 0, 1, 99 };
	INTEGER k = INTEGER_ZERO;
	if (!is_part_of_pi(x, 6, k))
		return false;
	unsigned long sixth = (mpz_fdiv_ui(k, 12) + (sine ? 9 : 0)) % 12;
	if (halves[sixth] == 99)
		return false;
	mpq_set_si(value, halves[sixth], 2);
	mpq_canonicalize(value);
	return true;
}

/* tan of q pi is rational at multiples of pi/4 only. */
static bool tangent(const struct node *node, const struct form *x, mpq_ptr value)
{
	INTEGER k = INTEGER_ZERO;
	if (!is_part_of_pi(x, 4, k))
		return false;
	unsigned long eighth = mpz_fdiv_ui(k, 4);
	if (eighth == 2)
		error(node->at, NULL, "tan of an odd number of quarter turns");
	mpq_set_si(value, eighth == 0 ? 0 : eighth == 1 ? 1 : -1, 1);
	return true;
}

struct form *constant_call(struct collector *c, const struct node *node, enum function function, const struct form *x)
{
	RATIONAL value = ZERO;
	bool trigonometric = function == FN_SIN || function == FN_COS;
	bool rational = function == FN_TAN ? tangent(node, x, value)
					   : trigonometric && niven(function == FN_SIN, x, value);
	if (!rational) {
		constant_value(c, x, value);
		if (!constant_function(node->at, function, value, value))
			met_irrational(c, &c->irrationals.used[function]);
	}
	check_bits(node->at, value);
	return form_constant(value);
}

bool compare_values(enum comparison comparison, int order)
{
	switch (comparison) {
	case CMP_LT: return order < 0;
	case CMP_LE: return order <= 0;
	case CMP_GT: return order > 0;
	case CMP_GE: return order >= 0;
	case CMP_EQ: return order == 0;
	default:     return order != 0;
	}
}

bool keeps(const struct collector *c)
{
	return c->vanishes || (c->keep == KEEP_ALL && !c->tolerant);
}

bool keeps_piecewise(const struct collector *c)
{
	return c->vanishes || (c->keep != KEEP_NOTHING && !c->tolerant);
}
