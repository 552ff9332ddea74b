/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dimensions as vectors over base units and what is not known yet, and those of expressions. */
#include "collect/dimensions.h"

#include <string.h>

/* ---- dimensions as vectors ---- */

struct dimension dimension_in(const mpq_t *base)
{
	struct dimension d = { .kind = GIVEN, .base = rationals(UNIT_BASES) };
	for (int i = 0; base && i < UNIT_BASES; i++)
		mpq_set(d.base[i], base[i]);
	return d;
}

struct dimension dimension_without(int kind)
{
	struct dimension d = dimension_in(NULL);
	d.kind = kind;
	return d;
}

struct dimension dimension_of_time(void)
{
	struct dimension d = dimension_in(NULL);
	mpq_set_si(d.base[SECOND], 1, 1);
	return d;
}

static void add_part(struct dimension *d, int variable, mpq_srcptr factor)
{
	for (int i = 0; i < d->parts; i++)
		if (d->part[i].variable == variable) {
			mpq_add(d->part[i].factor, d->part[i].factor, factor);
			return;
		}
	struct part *part = MORE(d->part, d->parts);
	part->variable = variable;
	mpq_init(part->factor);
	mpq_set(part->factor, factor);
}

void add_dimension(const struct dimensions *w, struct dimension *d, const struct dimension *other,
			  mpq_srcptr factor)
{
	RATIONAL product = ZERO;
	for (int i = 0; i < UNIT_BASES; i++)
		rational_addmul(d->base[i], other->base[i], factor);
	for (int i = 0; i < other->parts; i++) {
		const struct dimension *solution = &w->solution[other->part[i].variable];
		mpq_mul(product, other->part[i].factor, factor);
		if (solution->base)
			add_dimension(w, d, solution, product);
		else
			add_part(d, other->part[i].variable, product);
	}
}

struct dimension dimension_difference(const struct dimensions *w, const struct dimension *a, const struct dimension *b)
{
	RATIONAL one = RATIO(1, 1), minus = RATIO(-1, 1);
	struct dimension d = dimension_in(NULL);
	add_dimension(w, &d, a, one);
	if (b)
		add_dimension(w, &d, b, minus);
	int kept = 0;
	for (int i = 0; i < d.parts; i++)
		if (mpq_sgn(d.part[i].factor) != 0)
			d.part[kept++] = d.part[i];
	d.parts = kept;
	return d;
}

struct dimension dimension_resolved(const struct dimensions *w, const struct dimension *d)
{
	return dimension_difference(w, d, NULL);
}

bool is_number_dimension(const struct dimension *d)
{
	return d->parts == 0 && rationals_zero(UNIT_BASES, (const mpq_t *)d->base);
}

/* ---- names ---- */

int count_variables(const struct symbol *s)
{
	return s->kind == SYMBOL_COORD && s->length && !s->unit_written ? s->length : 1;
}

struct dimension of_variable(int variable)
{
	RATIONAL one = RATIO(1, 1);
	struct dimension d = dimension_in(NULL);
	add_part(&d, variable, one);
	return d;
}

struct dimension of_symbol(const struct dimensions *w, const struct symbol *s, int component)
{
	const bool several = s->kind == SYMBOL_COORD && s->length;
	if ((s->kind == SYMBOL_MATRIX || (several && !component)) && !s->unit_written)
		return dimension_without(SILENT);
	if (s->delayed)
		return of_symbol(w, s->delayed, 0);
	struct dimension d = of_variable(w->first[s->number] + (several && !s->unit_written ? component - 1 : 0));
	return dimension_resolved(w, &d);
}

struct dimension of_name(const struct dimensions *w, const struct node *node)
{
	struct dimension d = of_symbol(w, node->let ? node->let : node->symbol, node->component);
	RATIONAL primes = RATIO(node->primes, 1);
	if (d.kind == GIVEN)
		mpq_sub(d.base[SECOND], d.base[SECOND], primes);
	return d;
}

/* ---- groups ---- */

static struct group *add_group(struct dimensions *w, const char *what)
{
	struct group *group = MORE(w->group, w->groups);
	*group = (struct group){ .what = what, .statement = w->statement, .depth = w->depth, .place = w->groups };
	return group;
}

void add_term(struct group *group, const struct node *node, const char *text, struct place at,
		     struct dimension dimension)
{
	if (dimension.kind == GIVEN)
		*MORE(group->term, group->terms) = (struct term){ node, text, at, dimension };
}

/* The terms of a sum, those of brackets in it among them */
void add_terms(struct dimensions *w, int group, const struct node *node)
{
	if (node->kind == NODE_SUM && !node->unit && !node->let) {
		for (int i = 0; i < node->children; i++)
			add_terms(w, group, node->child[i]);
		return;
	}
	struct dimension d = dimension_of(w, node);
	const bool behind = node->unit && node->unit->at.offset >= node->end.offset;    /* else in the bracket */
	const char *text = node->unit && node->counted ? format(behind ? "%s \"%s\"" : "%s",
								 text_between(node->start, node->end),
								 node->unit->text) : NULL;
	add_term(&w->group[group], node, text, text ? node->unit->at : node->start, d);
}

int new_group(struct dimensions *w, const char *what)
{
	add_group(w, what);
	return w->groups - 1;
}

/* A group's dimension: of its first term; a bare one where all are; without any, that of numbers */
static struct dimension of_group(const struct dimensions *w, int index, int silent)
{
	const struct group *group = &w->group[index];
	for (int i = 0; i < group->terms; i++)
		if (!group->term[i].dimension.bare)
			return group->term[i].dimension;
	return group->terms ? group->term[0].dimension : dimension_without(silent);
}

static bool holds_silent(struct dimensions *w, const struct node *node)
{
	bool silent = node->kind == NODE_MATRIX || node->kind == NODE_FILE ||
		      (node->kind == NODE_NAME && of_name(w, node).kind == SILENT);
	for (int i = 0; i < node->children && !silent; i++)
		silent = holds_silent(w, node->child[i]);
	return silent;
}

static struct dimension of_alike(struct dimensions *w, const char *what, int count, struct node *const *child)
{
	int group = new_group(w, what), silent = NUMBERS;
	for (int i = 0; i < count; i++) {
		add_terms(w, group, child[i]);
		silent = holds_silent(w, child[i]) ? SILENT : silent;
	}
	return of_group(w, group, silent);
}

/* ---- expressions ---- */

/* A rational exponent, as far as it is made of numbers and params that are */
static bool constant_of(const struct node *node, mpq_ptr value)
{
	RATIONAL part = ZERO;
	if (node->kind == NODE_NUMBER)
		mpq_set(value, node->number);
	else if (node->kind == NODE_NAME && node->symbol->kind == SYMBOL_PARAM && node->symbol->value)
		return constant_of(node->symbol->value, value);
	else if (node->kind == NODE_SUM || node->kind == NODE_PRODUCT)
		mpq_set_ui(value, node->kind == NODE_PRODUCT, 1);
	else
		return false;
	for (int i = 0; i < node->children; i++) {
		if (!constant_of(node->child[i], part))
			return false;
		if (node->kind == NODE_PRODUCT && node->inverse[i] && mpq_sgn(part) == 0)
			return false;
		if (node->kind == NODE_SUM)
			(node->inverse[i] ? mpq_sub : mpq_add)(value, value, part);
		else
			(node->inverse[i] ? mpq_div : mpq_mul)(value, value, part);
	}
	return true;
}

/* A group of what has to be a plain number */
void need_number(struct dimensions *w, const char *what, const struct node *node, struct dimension d)
{
	if (d.kind != GIVEN || d.bare)
		return;
	int group = new_group(w, what);
	add_term(&w->group[group], NULL, NULL, node->start, dimension_in(NULL));
	add_term(&w->group[group], node, NULL, node->start, d);
}

static struct dimension of_product(struct dimensions *w, const struct node *node)
{
	struct dimension product = dimension_in(NULL);
	RATIONAL plus = RATIO(1, 1), minus = RATIO(-1, 1);
	bool bare = true, literal = false, silent = false, any = false;
	for (int i = 0; i < node->children; i++) {
		struct dimension d = dimension_of(w, node->child[i]);
		silent = silent || d.kind == SILENT;
		literal = literal || d.kind == NUMBERS;
		if (d.kind != GIVEN)
			continue;
		any = true;
		bare = bare && d.bare;
		add_dimension(w, &product, &d, node->inverse[i] ? minus : plus);
	}
	product.kind = silent ? SILENT : !any || (literal && bare) ? NUMBERS : GIVEN;
	product.bare = bare;
	return product;
}

static struct dimension to_power(struct dimensions *w, const struct node *node, const struct node *exponent,
				 mpq_srcptr power)
{
	struct dimension base = dimension_of(w, node), result = dimension_in(NULL);
	RATIONAL value = ZERO;
	result.kind = base.kind;
	result.bare = base.bare;
	if (base.kind != GIVEN)
		return result;
	if (power || constant_of(exponent, value)) {
		add_dimension(w, &result, &base, power ? power : value);
		return result;
	}
	need_number(w, "the base of a power that is no constant", node, base);
	return result;
}

static struct dimension of_power(struct dimensions *w, const struct node *node)
{
	need_number(w, "an exponent", node->child[1], dimension_of(w, node->child[1]));
	return to_power(w, node->child[0], node->child[1], NULL);
}

/* table(x; x0, y0; ...) */
static struct dimension of_table(struct dimensions *w, const struct node *node)
{
	int x = new_group(w, "the argument of a table"), y = new_group(w, "the values of a table");
	add_terms(w, x, node->child[0]);
	for (int i = 1; i < node->children; i++)
		add_terms(w, i % 2 ? x : y, node->child[i]);
	struct dimension d = of_group(w, y, NUMBERS);
	d.bare = d.kind == NUMBERS;
	return d;
}

static struct dimension of_call(struct dimensions *w, const struct node *node)
{
	RATIONAL half = RATIO(1, 2);
	struct dimension d, number = dimension_in(NULL);
	number.bare = true;
	switch (node->function) {
	case FN_SUM:
	case FN_CUMSUM: return dimension_of(w, node->child[0]);
	case FN_DOT:  return of_product(w, node);
	case FN_SQRT: return to_power(w, node->child[0], NULL, half);
	case FN_ABS:  return dimension_of(w, node->child[0]);
	case FN_MIN:
	case FN_MAX:
	case FN_CLIP:
	case FN_DEADZONE:
		return of_alike(w, format("the arguments of %s", function_name(node->function)), node->children,
				node->child);
	case FN_TABLE:    return of_table(w, node);
	case FN_FRICTION:
		dimension_of(w, node->child[0]);
		return of_alike(w, "the forces of a friction", node->children - 1, node->child + 1);
	case FN_ATAN2:
		of_alike(w, "the arguments of atan2", 2, node->child);
		return number;
	default:
		d = dimension_of(w, node->child[0]);
		if (node->function != FN_SGN)
			need_number(w, format("the argument of %s", function_name(node->function)), node->child[0], d);
		number.kind = d.kind == GIVEN ? GIVEN : d.kind;
		return number;
	}
}

/* What a unit stands behind: so many of it; or what comes out in it, which has to be known without it where a factor
 * could be meant. */
static struct dimension of_quantity(struct dimensions *w, const struct node *node)
{
	struct dimension d = dimension_in((const mpq_t *)node->unit->base);
	if (node->counted)
		return d;
	if (!is_coherent(node->unit)) {
		*MORE(w->assertion, w->assertions) = (struct assertion){ node, dimension_of(w, node->child[0]) };
		return d;
	}
	int group = new_group(w, "its unit");
	add_term(&w->group[group], NULL, format("\"%s\"", node->unit->text), node->unit->at, d);
	add_terms(w, group, node->child[0]);
	return d;
}

static struct dimension of_node(struct dimensions *w, const struct node *node)
{
	if (node->unit)
		return of_quantity(w, node);
	if (node->let)
		return of_name(w, node);
	switch (node->kind) {
	case NODE_TIME: {
		struct dimension time = dimension_of_time();
		time.bare = true;
		return time;
	}
	case NODE_NAME:    return of_name(w, node);
	case NODE_SUM:     return of_alike(w, "the sum", 1, &(struct node *){ (struct node *)(uintptr_t)node });
	case NODE_PRODUCT: return of_product(w, node);
	case NODE_POWER:   return of_power(w, node);
	case NODE_CALL:    return of_call(w, node);
	case NODE_CHOOSE:
		dimension_of(w, node->child[0]);
		return of_alike(w, "the choice", 2, node->child + 1);
	case NODE_COMPARE:
		of_alike(w, "the comparison", 2, node->child);
		return dimension_without(NUMBERS);
	case NODE_MATRIX:
		for (int i = 0; i < node->children; i++)
			dimension_of(w, node->child[i]);
		return dimension_without(SILENT);
	case NODE_FILE:    return dimension_without(SILENT);
	default:           return dimension_without(NUMBERS);
	}
}

struct dimension dimension_of(struct dimensions *w, const struct node *node)
{
	w->depth++;
	struct dimension d = of_node(w, node);
	w->depth--;
	return d;
}

/* ---- statements of forces and energies ---- */

const struct energy *first_energy(const struct dimensions *w)
{
	const struct energy *all = w->spec->lagrange.energy;
	for (int i = 0; i < w->spec->lagrange.energies; i++)
		if (strchr("TVD", all[i].kind))
			return &all[i];
	return NULL;
}

struct dimension of_written_energy(struct dimensions *w)
{
	const struct energy *first = first_energy(w);
	RATIONAL one = RATIO(1, 1);
	struct dimension d = first ? dimension_of(w, first->value) : dimension_without(SILENT);
	struct dimension energy = dimension_in(NULL);
	energy.kind = d.kind;
	if (d.kind != GIVEN)
		return energy;
	add_dimension(w, &energy, &d, one);
	if (first->kind == 'D')                 /* half a power */
		mpq_add(energy.base[SECOND], energy.base[SECOND], one);
	return energy;
}

/* The force of an element, by the coordinates between which it acts */
struct dimension of_element(struct dimensions *w, const struct element *e)
{
	RATIONAL one = RATIO(1, 1);
	struct dimension d = e->kind == ELEMENT_ENERGY ? of_written_energy(w) : dimension_of(w, e->value);
	struct dimension at = of_name(w, e->from), force = dimension_in(NULL);
	if (d.kind == NUMBERS || d.kind == SILENT || at.kind == SILENT)
		return dimension_without(SILENT);
	add_dimension(w, &force, &d, one);
	if (e->kind == ELEMENT_FORCE || e->kind == ELEMENT_FRICTION)
		return force;
	if (e->kind == ELEMENT_ENERGY) {        /* over the coordinate */
		mpq_set_si(one, -1, 1);
		add_dimension(w, &force, &at, one);
		return force;
	}
	RATIONAL order = RATIO(e->kind == ELEMENT_MASS ? -2 : e->kind == ELEMENT_DAMPER ? -1 : 0, 1);
	add_dimension(w, &force, &at, one);
	mpq_add(force.base[SECOND], force.base[SECOND], order);
	return force;
}

struct dimension of_energies(struct dimensions *w)
{
	RATIONAL one = RATIO(1, 1);
	struct dimension energy = of_written_energy(w);
	for (int i = 0; i < w->spec->elements && energy.kind != GIVEN; i++) {
		const struct dimension way = of_name(w, w->spec->element[i].from);
		energy = of_element(w, &w->spec->element[i]);
		if (energy.kind == GIVEN)
			add_dimension(w, &energy, &way, one);
	}
	return energy;
}
