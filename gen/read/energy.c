/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Energies: statements from which equations of motion follow. Each coordinate that they name gets an element, whose
 * force is what Lagrange's equation of that coordinate says. */
#include "read/parser.h"

#include <string.h>

/* energy: energy ( T | V ) = expression { , ... };   dissipation: dissipation D = expression */
static void read_functions(struct parser *p, const char *names)
{
	struct spec *spec = p->spec;
	const int first = spec->energies;
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
		*MORE(spec->energy, spec->energies) = energy;
	} while (take_op(p, ","));
	expect_end(p);
	for (int i = first; i < spec->energies; i++)
		spec->energy[i].end = p->end;
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
	*MORE(p->spec->energy, p->spec->energies) = force;
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

static bool *coordinates_in(const struct spec *spec, bool kinetic)
{
	bool *named = ARRAY(bool, (size_t)spec->count.components + 1);
	bool *seen = ARRAY(bool, (size_t)spec->count.symbols + 1);
	for (int i = 0; i < spec->energies; i++) {
		const struct energy *energy = &spec->energy[i];
		if (!kinetic || energy->kind == 'T')
			mark(energy->point ? energy->point : energy->value, named, seen);
	}
	return named;
}

bool has_kinetic_energy(const struct spec *spec, int component)
{
	return spec->energies > 0 && coordinates_in(spec, true)[component];
}

static void add_element(struct spec *spec, struct symbol *coord, int component)
{
	const struct energy *first = &spec->energy[0];
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
	const bool *named = spec->energies ? coordinates_in(spec, false) : NULL;
	for (struct symbol *s = spec->first; s && named; s = s->next)
		for (int i = 0; s->kind == SYMBOL_COORD && !s->broken && i < (s->length ? s->length : 1); i++)
			if (named[s->index + i])
				add_element(spec, s, s->length ? i + 1 : 0);
}
