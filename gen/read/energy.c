/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energies: statements from which equations of motion follow. Each coordinate that they name gets an element, whose
 * force is what Lagrange's equation of that coordinate says. Outputs may read their totals. */
#include "read/parser.h"

#include <string.h>

/* energy: energy ( T | V ) = expression { , ... };   dissipation: dissipation D = expression */
static void read_functions(struct parser *p, const char *names)
{
	struct spec *spec = p->spec;
	const int first = spec->lagrange.energies;
	do {
		struct energy energy = { .part = p->part, .at = { p->lexer.source, p->statement } };
		struct token name = p->token;
		if (name.kind != TOKEN_NAME || name.primes || strlen(name.name) != 1 || !strchr(names, name.name[0]))
			unexpected(p, names[1] ? "T or V, the kinetic or the potential energy"
					       : "D, half the power that is dissipated");
		take(p);
		expect_op(p, "=", "'='");
		energy.kind = name.name[0];
		energy.value = read_quantity(p);
		*MORE(spec->lagrange.energy, spec->lagrange.energies) = energy;
	} while (take_op(p, ","));
	expect_end(p);
	for (int i = first; i < spec->lagrange.energies; i++)
		spec->lagrange.energy[i].end = p->end;
}

void read_energy(struct parser *p) { read_functions(p, "TV"); }
void read_dissipation(struct parser *p) { read_functions(p, "D"); }

/* Behind `force` and its first expression: { , expression } at expression { , expression } */
void read_point_force(struct parser *p, struct node *first)
{
	struct energy force = { .kind = 'Q', .part = p->part, .at = { p->lexer.source, p->statement },
				.value = node_new(NODE_MATRIX, first->at), .point = node_new(NODE_MATRIX, first->at) };
	add_child(force.value, first, false, first->at);
	while (take_op(p, ","))
		add_child(force.value, read_quantity(p), false, p->token.at);
	expect_word(p, "at");
	do
		add_child(force.point, read_expression(p), false, p->token.at);
	while (take_op(p, ","));
	if (force.value->children != force.point->children)
		error(force.point->child[0]->start, "force FX, FY at X, Y",
		      "a force of %d component%s at a point of %d", force.value->children,
		      force.value->children == 1 ? "" : "s", force.point->children);
	expect_end(p);
	force.end = p->end;
	*MORE(p->spec->lagrange.energy, p->spec->lagrange.energies) = force;
}

/* constraint: constraint NAME : expression = expression. Its left side minus its right side is 0. */
void read_constraint(struct parser *p)
{
	struct energy constraint = { .kind = 'G', .part = p->part, .at = { p->lexer.source, p->statement } };
	const struct token name = expect_new_name(p, "the name of the constraint, which is its multiplier's");
	expect_op(p, ":", "':' before the equation");
	struct node *left = read_quantity(p);
	const struct place at = p->token.at;
	expect_op(p, "=", "'='");
	constraint.value = node_new(NODE_SUM, at);
	add_child(constraint.value, left, false, left->start);
	add_child(constraint.value, read_quantity(p), true, at);
	expect_end(p);
	constraint.value->start = left->start;
	constraint.value->end = constraint.end = p->end;
	constraint.multiplier = declare(p, name, SYMBOL_MULTIPLIER, false);
	*MORE(p->spec->lagrange.energy, p->spec->lagrange.energies) = constraint;
}

/* ---- which coordinates stand in them ---- */

static void mark(const struct node *node, bool *named, bool *seen)
{
	const struct symbol *s = node->kind == NODE_NAME ? node->symbol : NULL;
	if (s && s->kind == SYMBOL_COORD)
		for (int i = 0; i < (s->length && !node->component ? s->length : 1); i++)
			named[s->index + i + (node->component ? node->component - 1 : 0)] = true;
	if (s && s->kind == SYMBOL_LET && s->value && !seen[s->number]) {
		seen[s->number] = true;
		mark(s->value, named, seen);
	}
	for (int i = 0; !s && i < node->children; i++)
		mark(node->child[i], named, seen);
}

/* In those of this kind; 0: in any */
static bool *coordinates_in(const struct spec *spec, char kind)
{
	bool *named = ARRAY(bool, (size_t)spec->count.components + 1);
	bool *seen = ARRAY(bool, (size_t)spec->count.symbols + 1);
	for (int i = 0; i < spec->lagrange.energies; i++) {
		const struct energy *energy = &spec->lagrange.energy[i];
		if (!kind || energy->kind == kind)
			mark(energy->point ? energy->point : energy->value, named, seen);
	}
	return named;
}

bool has_kinetic_energy(const struct spec *spec, int component)
{
	return spec->lagrange.energies > 0 && coordinates_in(spec, 'T')[component];
}

bool is_constrained(const struct spec *spec, int component)
{
	return spec->count.multipliers > 0 && coordinates_in(spec, 'G')[component];
}

static void add_element(struct spec *spec, struct symbol *coord, int component)
{
	const struct energy *first = &spec->lagrange.energy[0];
	struct node *from = node_new(NODE_NAME, coord->at);
	from->symbol = coord;
	from->component = component;
	*MORE(spec->element, spec->elements) = (struct element){
		.kind = ELEMENT_ENERGY, .part = first->part, .at = first->at, .end = first->end, .value = first->value,
		.from = from
	};
}

void add_energy_elements(struct spec *spec)
{
	const bool *named = spec->lagrange.energies ? coordinates_in(spec, 0) : NULL;
	for (struct symbol *s = spec->first; s && named; s = s->next)
		for (int i = 0; s->kind == SYMBOL_COORD && !s->broken && i < (s->length ? s->length : 1); i++)
			if (named[s->index + i])
				add_element(spec, s, s->length ? i + 1 : 0);
}

/* ---- totals: energy, power and momentum(q) in outputs ---- */

/* factor, or factor * base, or factor * base^power; `half`: half of it */
static struct node *product_of(struct node *factor, struct node *base, int power, bool half)
{
	struct node *product = node_new(NODE_PRODUCT, factor->at), *two = node_new(NODE_NUMBER, factor->at);
	mpq_set_ui(two->number, 2, 1);
	add_child(product, factor, false, factor->at);
	for (int i = 0; i < power; i++)
		add_child(product, base, false, factor->at);
	if (half)
		add_child(product, two, true, factor->at);
	return product;
}

/* x - y, or x; their velocities */
static struct node *difference(const struct element *element, int primes)
{
	struct node *sum = node_new(NODE_SUM, element->from->at);
	for (int i = 0; i < (element->to ? 2 : 1); i++) {
		struct node *state = node_new(NODE_NAME, element->from->at);
		*state = *(i ? element->to : element->from);
		state->primes = primes;
		add_child(sum, state, i, element->from->at);
	}
	return sum;
}

/* The energy of a mass or a spring; NULL: it is another element */
static struct node *energy_of_element(const struct element *element)
{
	if (element->kind != ELEMENT_MASS && element->kind != ELEMENT_SPRING)
		return NULL;
	return product_of(element->value, difference(element, element->kind == ELEMENT_MASS), 2, true);
}

static struct node *total_energy(const struct spec *spec, bool kinetic, struct place at)
{
	struct node *sum = node_new(NODE_SUM, at);
	for (int i = 0; i < spec->lagrange.energies; i++)
		if (spec->lagrange.energy[i].kind == 'T' || (spec->lagrange.energy[i].kind == 'V' && !kinetic))
			add_child(sum, spec->lagrange.energy[i].value, false, at);
	for (int i = 0; i < spec->elements; i++) {
		const struct element *element = &spec->element[i];
		struct node *energy = kinetic && element->kind != ELEMENT_MASS ? NULL : energy_of_element(element);
		if (energy)
			add_child(sum, energy, false, at);
	}
	return sum;
}

static bool is_zero_number(const struct node *node)
{
	return node->kind == NODE_NUMBER && mpq_sgn(node->number) == 0;
}

/* In each term of it, of velocities; MIXED: not the same in all */
enum { MIXED = -1 };
static int degree_in_velocities(const struct node *node)
{
	const bool name = node->kind == NODE_NAME, product = node->kind == NODE_PRODUCT, sum = node->kind == NODE_SUM;
	int degree = 0, terms = 0;
	if (name && node->symbol->kind == SYMBOL_LET && node->symbol->value)
		return degree_in_velocities(node->symbol->value);
	if (name)
		return node->symbol->kind == SYMBOL_COORD ? node->primes : 0;
	for (int i = 0; i < node->children && degree != MIXED; i++) {
		if (sum && is_zero_number(node->child[i]))
			continue;
		const int own = degree_in_velocities(node->child[i]);
		const bool fits = product ? own != MIXED && (own == 0 || !node->inverse[i])
				  : sum   ? terms++ == 0 || own == degree
					  : own == 0;
		degree = !fits ? MIXED : product ? degree + own : own;
	}
	return degree;
}

/* Its force does -NAME dg/dq q' = NAME dg/dt, that of velocities -NAME dg/dq' q', which is -NAME g = 0 where no term
 * of g is without them */
static void add_power_of_constraint(struct node *sum, const struct energy *energy, struct place at)
{
	const struct slope by_velocities = { .at = at, .kind = SLOPE_VELOCITIES };
	const struct slope by_time = { .at = at, .kind = SLOPE_LOADS };
	struct node *moved = slope_by(energy->value, by_velocities), *name = node_new(NODE_NAME, at);
	const bool velocities = !is_zero_number(moved);
	if (velocities && degree_in_velocities(energy->value) == 1)
		return;
	name->symbol = energy->multiplier;
	moved = velocities ? moved : slope_by(energy->value, by_time);
	if (!is_zero_number(moved))
		add_child(sum, product_of(name, moved, 1, false), velocities, at);
}

/* What a force at a point, a dissipation, or an energy that loads and inputs change, brings in */
static void add_power(struct node *sum, const struct energy *energy, struct place at)
{
	for (int i = 0; energy->kind == 'Q' && i < energy->value->children; i++)
		add_child(sum, product_of(energy->value->child[i], slope_of(energy->point->child[i], at), 1, false),
			  false, at);
	if (energy->kind == 'G')
		add_power_of_constraint(sum, energy, at);
	if (energy->kind == 'Q' || energy->kind == 'G')
		return;
	const struct slope by = { .at = at, .kind = energy->kind == 'D' ? SLOPE_VELOCITIES : SLOPE_LOADS };
	struct node *power = slope_by(energy->value, by);
	const bool none = is_zero_number(power);
	if (energy->kind == 'T' && !none)
		error(at, "output NAME = ... writes it",
		      "the kinetic energy depends on time: the power of what moves it is not known");
	if (!none)
		add_child(sum, power, energy->kind == 'D', at);
}

static struct node *total_power(const struct spec *spec, struct place at)
{
	struct node *sum = node_new(NODE_SUM, at), *zero = node_new(NODE_NUMBER, at);
	add_child(sum, zero, false, at);
	for (int i = 0; i < spec->lagrange.energies; i++)
		add_power(sum, &spec->lagrange.energy[i], at);
	for (int i = 0; i < spec->elements; i++) {
		const struct element *e = &spec->element[i];
		struct node *energy = energy_of_element(e), *slide = difference(e, 1);
		const struct energy of = { .kind = e->kind == ELEMENT_MASS ? 'T' : 'V', .value = energy };
		if (energy)
			add_power(sum, &of, at);
		else if (e->kind != ELEMENT_ENERGY)
			add_child(sum, product_of(e->value, slide, e->kind == ELEMENT_DAMPER ? 2 : 1, false),
				  e->kind != ELEMENT_FORCE, at);
	}
	return sum;
}

struct filling { struct spec *spec; const struct total *total; };

static void fill_total(void *context)
{
	const struct filling *f = context;
	const struct spec *spec = f->spec;
	const struct total *total = f->total;
	const struct place at = total->let->at;
	if (spec->equations > 0)
		error(at, format("output NAME = ... writes it; the first of them: %s",
				 text_between(spec->equation[0].at, spec->equation[0].end)),
		      "the %s of written equations is not known", total->let->name);
	if (spec->lagrange.energies + spec->elements == 0)
		error(at, NULL, "there are no energies, masses and springs of which this is the %s", total->let->name);
	struct node *value = total->kind == TOTAL_POWER ? total_power(spec, at)
							: total_energy(spec, total->kind == TOTAL_MOMENTUM, at);
	if (total->kind == TOTAL_MOMENTUM)
		value = slope_by(value, (struct slope){ .at = at, .kind = SLOPE_VELOCITY, .of = total->coord });
	total->let->value = value;
}

void fill_totals(struct spec *spec)
{
	for (int i = 0; i < spec->lagrange.totals; i++)
		if (!statement_guard(fill_total, &(struct filling){ spec, &spec->lagrange.total[i] }))
			spec->lagrange.total[i].let->broken = true;
}
