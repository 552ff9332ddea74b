/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Params that are made of tunable ones in another way than as sums of products: sin(p), sqrt(k/m), the 1 + p of
 * x/(1 + p), p > 1 ? a : b. Each is a tunable param of its own, behind those of the spec, which the target finds from
 * these by its expression. */
#include "model/model.h"

/* ---- what a sum of products is not ---- */

struct exponent {
	struct node *node;
	mpq_ptr value;
};

static void find_exponent(void *context)
{
	const struct exponent *e = context;
	struct collector collector = { .scheme = "exact", .constant_only = true };
	collect_constant(&collector, e->node, e->value);
}

/* One that a product of powers may have; 0: it is none */
static long whole_exponent(struct node *node)
{
	RATIONAL value = ZERO;
	const bool whole = !first_tuned(node) && silent_guard(find_exponent, &(struct exponent){ node, value }) &&
			   mpz_cmp_ui(mpq_denref(value), 1) == 0 &&
			   mpz_cmpabs_ui(mpq_numref(value), FIT_DEGREE) <= 0;
	return whole ? mpz_get_si(mpq_numref(value)) : 0;
}

/* One product of powers, by which a sum of them can be divided */
static bool is_product(const struct node *node)
{
	bool product = node->kind == NODE_PRODUCT || (node->kind == NODE_SUM && node->children == 1);
	if (!first_tuned(node))
		return true;
	if (node->kind == NODE_NAME)
		return node->symbol->tunable || is_product(node->symbol->value);
	if (node->kind == NODE_POWER)
		return whole_exponent(node->child[1]) != 0 && is_product(node->child[0]);
	for (int i = 0; i < node->children && product; i++)
		product = is_product(node->child[i]);
	return product;
}

/* One number, of params and numbers */
static bool is_number(const struct node *node)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	bool number = node->kind != NODE_TIME && node->kind != NODE_MATRIX && node->kind != NODE_FILE &&
		      node->function != FN_FRICTION;
	if (s)
		number = s->kind == SYMBOL_PARAM;
	for (int i = 0; i < node->children && number; i++)
		number = is_number(node->child[i]);
	return number;
}

static bool is_other(const struct node *node, bool divides)
{
	return node->kind == NODE_CALL || node->kind == NODE_CHOOSE || node->kind == NODE_COMPARE ||
	       (node->kind == NODE_POWER && whole_exponent(node->child[1]) == 0) || (divides && !is_product(node));
}

/* ---- in its place ---- */

static bool same_node(const struct node *a, const struct node *b)
{
	bool same = a->kind == b->kind && a->symbol == b->symbol && a->function == b->function &&
		    a->comparison == b->comparison && a->children == b->children &&
		    (a->kind != NODE_NUMBER || mpq_equal(a->number, b->number));
	for (int i = 0; i < a->children && same; i++)
		same = same_node(a->child[i], b->child[i]) && (!a->inverse || a->inverse[i] == b->inverse[i]);
	return same;
}

/* That of the same expression, where there is one */
static struct symbol *derived_symbol(struct spec *spec, struct node *node)
{
	for (int k = spec->tunables - spec->derived; k < spec->tunables; k++)
		if (same_node(spec->tunable[k].symbol->value, node))
			return spec->tunable[k].symbol;
	struct symbol *symbol = NEW(struct symbol);
	*symbol = (struct symbol){ .kind = SYMBOL_PARAM, .name = format("derived%d", ++spec->derived),
				   .at = node->at, .value = node, .used = true, .tuned = true, .derived = true,
				   .tunable = spec->tunables + 1 };
	add_symbol(spec, symbol);
	*MORE(spec->tunable, spec->tunables) = (struct tunable){ node->start, symbol };
	return symbol;
}

static struct node *derived_name(struct spec *spec, struct node *node)
{
	struct node *name = NEW(struct node);
	*name = (struct node){ .kind = NODE_NAME, .at = node->at, .start = node->start, .end = node->end,
			       .symbol = derived_symbol(spec, node) };
	return name;
}

static void derive_in(struct spec *spec, struct node **place, bool divides)
{
	struct node *node = *place;
	struct symbol *s = node && node->kind == NODE_NAME ? node->symbol : NULL;
	if (!node || !first_tuned(node) || (s && s->tunable) || spec->derived == LIMIT_DERIVED)
		return;
	if (is_number(node) && is_other(node, divides)) {
		*place = derived_name(spec, node);
		return;
	}
	if (s && s->value && !s->derived) {
		s->derived = true;
		derive_in(spec, &s->value, false);
	}
	for (int i = 0; i < node->children; i++) {
		const bool inverse = node->kind == NODE_PRODUCT && node->inverse[i];
		const bool power = node->kind == NODE_POWER && i == 0 && whole_exponent(node->child[1]) < 0;
		derive_in(spec, &node->child[i], inverse || power);
	}
}

void derive_params(struct spec *spec)
{
	spread_tuned(spec);
	for (int i = 0; i < spec->equations; i++) {
		derive_in(spec, &spec->equation[i].left, false);
		derive_in(spec, &spec->equation[i].right, false);
	}
	for (int i = 0; i < spec->elements; i++)
		derive_in(spec, &spec->element[i].value, false);
	for (int i = 0; i < spec->whens; i++) {
		derive_in(spec, &spec->when[i].guard, false);
		derive_in(spec, &spec->when[i].gap, false);
		derive_in(spec, &spec->when[i].restitution, false);
		for (int k = 0; k < spec->when[i].jumps; k++)
			derive_in(spec, &spec->when[i].jump[k].value, false);
	}
	for (struct symbol *s = spec->first; s; s = s->next)
		if (s->kind == SYMBOL_OUTPUT && s->value)
			derive_in(spec, &s->value, false);
}
