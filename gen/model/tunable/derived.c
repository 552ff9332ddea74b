/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Params that are made of tunable ones by more than sums, products and quotients: sin(p), sqrt(k/m), p > 1 ? a : b.
 * Each is a tunable param of its own, behind those of the spec, which the target finds from these by its expression. */
#include "inner.h"

/* ---- what is no sum, product or quotient ---- */

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

/* A power that is a few products, or one over them */
static bool is_few_products(struct node *exponent)
{
	enum { MOST = 16 };
	RATIONAL value = ZERO;
	return !first_tuned(exponent) && silent_guard(find_exponent, &(struct exponent){ exponent, value }) &&
	       mpz_cmp_ui(mpq_denref(value), 1) == 0 && mpz_cmpabs_ui(mpq_numref(value), MOST) <= 0;
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

static bool is_other(const struct node *node)
{
	return node->kind == NODE_CALL || node->kind == NODE_CHOOSE || node->kind == NODE_COMPARE ||
	       (node->kind == NODE_POWER && !is_few_products(node->child[1]));
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
	for (int k = spec->tuned.count - spec->tuned.derived; k < spec->tuned.count; k++)
		if (same_node(spec->tuned.tunable[k].symbol->value, node))
			return spec->tuned.tunable[k].symbol;
	struct symbol *symbol = NEW(struct symbol);
	*symbol = (struct symbol){ .kind = SYMBOL_PARAM,
				   .name = format("derived%d", ++spec->tuned.derived),
				   .at = node->at,
				   .value = node,
				   .used = true,
				   .tuning.tuned = true,
				   .tuning.derived = true,
				   .tuning.number = spec->tuned.count + 1 };
	add_symbol(spec, symbol);
	*MORE(spec->tuned.tunable, spec->tuned.count) = (struct tunable){ node->start, symbol, NULL, NULL };
	return symbol;
}

static struct node *derived_name(struct spec *spec, struct node *node)
{
	struct node *name = NEW(struct node);
	*name = (struct node){ .kind = NODE_NAME, .at = node->at, .start = node->start, .end = node->end,
			       .symbol = derived_symbol(spec, node) };
	return name;
}

static void derive_in(struct spec *spec, struct node **place)
{
	struct node *node = *place;
	struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	if (!first_tuned(node) || (s && s->tuning.number))
		return;
	if (is_number(node) && is_other(node)) {
		*place = derived_name(spec, node);
		return;
	}
	if (s && s->value && !s->tuning.derived) {
		s->tuning.derived = true;
		derive_in(spec, &s->value);
	}
	for (int i = 0; i < node->children; i++)
		derive_in(spec, &node->child[i]);
}

/* ---- what the target reads ---- */

/* All expressions of the spec but values of params, initial values and what holds for plgen alone */
static void each_function(struct spec *spec, void (*visit)(void *context, struct node **place), void *context)
{
	for (int i = 0; i < spec->equations; i++) {
		visit(context, &spec->equation[i].left);
		visit(context, &spec->equation[i].right);
	}
	for (int i = 0; i < spec->elements; i++)
		visit(context, &spec->element[i].value);
	for (int i = 0; i < spec->whens; i++) {
		struct when *when = &spec->when[i];
		struct node **place[] = { &when->guard, &when->gap, &when->restitution };
		for (int k = 0; k < 3; k++)
			if (*place[k])
				visit(context, place[k]);
		for (int k = 0; k < when->jumps; k++)
			visit(context, &when->jump[k].value);
	}
	for (struct symbol *s = spec->first; s; s = s->next)
		if (s->kind == SYMBOL_OUTPUT && s->value)
			visit(context, &s->value);
}

static void derive_here(void *context, struct node **place)
{
	derive_in(context, place);
}

void derive_params(struct spec *spec)
{
	spread_tuned(spec);
	for (struct symbol *s = spec->first; s; s = s->next)
		s->tuning.derived = s->tuning.derived && s->tuning.number;  /* -D gives it another value */
	each_function(spec, derive_here, spec);
}

static void add_read(void *context, struct node **place)
{
	*(unsigned *)context |= params_read(*place);
}

void warn_of_unread(const struct model *model)
{
	const struct spec *spec = model->spec;
	unsigned read = 0;
	each_function(model->spec, add_read, &read);
	for (int i = 0; i < spec->lagrange.energies; i++) {
		const struct energy *e = &spec->lagrange.energy[i];
		read |= params_read(e->value) | (e->point ? params_read(e->point) : 0);
	}
	for (int k = 0; k < spec->tuned.count - spec->tuned.derived && !model->relative; k++)
		if (!(read >> k & 1))
			say_warning(spec->tuned.tunable[k].at, NULL,
				    "tunable '%s' changes nothing that the target computes",
				    spec->tuned.tunable[k].symbol->name);
}

/* ---- what cannot be found there ---- */

/* What seems to be a sum of products of its i-th operand, and is none. A load's frequency may be tunable, its phase is
 * looked at with the model. */
static bool stays_here(const struct node *node, int i)
{
	const bool forcing = node->function == FN_SIN || node->function == FN_COS;
	return node->kind == NODE_COMPARE || (node->kind == NODE_CHOOSE && i == 0) ||
	       (node->kind == NODE_POWER && i == 1) ||
	       (node->kind == NODE_CALL && (!forcing || is_number(node->child[i])));
}

static _Noreturn void refuse_decided(const struct node *node, const struct node *name)
{
	const bool call = node->kind == NODE_CALL, power = node->kind == NODE_POWER;
	error(name->at,
	      call ? "what tunables alone make is found on the target; make what it gives a tunable of its own"
		     : "which way it goes is decided when plgen runs: where formulas change is fixed",
	      "'%s' is tunable, or made of what is, and stands inside %s", name->symbol->name,
	      call ? format("%s()", function_name(node->function)) : power ? "an exponent" : "a condition");
}

/* Of what moves in regions the sign is one of those that have to stay. */
static void check_in(void *context, struct node **place)
{
	const bool *regions = context;
	struct node *node = *place;
	struct symbol *symbol = node->kind == NODE_NAME ? node->symbol : NULL;
	if (symbol && symbol->tuning.tuned && !symbol->tuning.number && symbol->value && !symbol->tuning.checked) {
		symbol->tuning.checked = true;
		check_in(context, &symbol->value);
	}
	for (int i = 0; i < node->children; i++) {
		const struct node *name = first_tuned(node->child[i]);
		if (name && stays_here(node, i) && !*regions)
			refuse_decided(node, name);
		check_in(context, &node->child[i]);
	}
}

void check_tuned(const struct model *model)
{
	bool regions = model->switching;
	each_function(model->spec, check_in, &regions);
}
