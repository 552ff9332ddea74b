/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Nodes, and the text that they stand for. */
#include "read/parser.h"

#include <string.h>

struct node *node_new(enum node_kind kind, struct place at)
{
	struct node *node = NEW(struct node);
	node->kind = kind;
	node->at = node->start = node->end = at;
	mpq_init(node->number);
	return node;
}

void add_child(struct node *node, struct node *child, bool inverse, struct place operator)
{
	size_t count = (size_t)node->children;
	if ((count & (count - 1)) == 0) {       /* room grows by doubling */
		size_t room = count ? 2 * count : 1;
		ENLARGE(node->child, room);
		ENLARGE(node->inverse, room);
		ENLARGE(node->operator, room);
	}
	bool many = node->kind == NODE_CALL &&
		    (node->function == FN_MIN || node->function == FN_MAX || node->function == FN_TABLE);
	int inside = child->depth + 1 + (many ? node->children : 0);
	node->depth = inside > node->depth ? inside : node->depth;
	if (node->depth > LIMIT_DEPTH)
		error(child->start, NULL,
		      "operations and names inside each other, through params and lets, over the limit of %d",
		      LIMIT_DEPTH);
	node->child[count] = child;
	node->inverse[count] = inverse;
	node->operator[count] = operator;
	node->children++;
	node->end = child->end;
}

char *text_between(struct place start, struct place end)
{
	const char *text = start.source->text;
	char *folded = ARRAY(char, end.offset - start.offset + 1);
	size_t length = 0;
	for (size_t i = start.offset; i < end.offset; i++) {
		if (text[i] == '#')
			while (i < end.offset && text[i] != '\n')
				i++;
		bool space = i >= end.offset || strchr(" \t\r\n\f\v", text[i]);
		if (!space)
			folded[length++] = text[i];
		else if (length > 0 && folded[length - 1] != ' ')
			folded[length++] = ' ';
	}
	while (length > 0 && folded[length - 1] == ' ')
		length--;
	folded[length] = 0;
	return folded;
}

struct node *inlined(struct node *value, struct place at, struct place end)
{
	struct node *node = node_new(NODE_SUM, at);
	add_child(node, value, false, at);
	node->end = end;
	return node;
}

bool has_acceleration(const struct node *node)
{
	bool found = node->kind == NODE_NAME && node->symbol->kind == SYMBOL_COORD && node->primes > 1;
	for (int i = 0; i < node->children && !found; i++)
		found = has_acceleration(node->child[i]);
	return found;
}

/* ---- units of values ---- */

static void times_factor(struct node *product, const struct unit *unit, bool inverse)
{
	struct node *number = node_new(NODE_NUMBER, product->at), *pi = node_new(NODE_PI, product->at);
	struct place end = product->end;
	mpq_set(number->number, unit->factor);
	if (mpq_cmp_ui(unit->factor, 1, 1) != 0)
		add_child(product, number, inverse, product->at);
	for (int i = 0; i < (unit->pi < 0 ? -unit->pi : unit->pi); i++)
		add_child(product, pi, inverse != (unit->pi < 0), product->at);
	product->end = end;
}

struct node *convert_unit(struct node *value, const struct unit *unit, bool inverse)
{
	if (!unit || is_coherent(unit))
		return value;
	struct node *product = node_new(NODE_PRODUCT, value->at);
	product->start = value->start;
	add_child(product, value, false, value->start);
	times_factor(product, unit, inverse);
	return product;
}

/* Made of numbers alone, so that a unit behind it counts them */
bool is_plain_number(const struct node *node)
{
	bool plain = !node->unit && node->kind != NODE_NAME && node->kind != NODE_TIME;
	for (int i = 0; i < node->children && plain; i++)
		plain = is_plain_number(node->child[i]);
	return plain;
}

struct node *with_unit(struct node *value, const struct unit *unit)
{
	if (!unit)
		return value;
	struct node *node = node_new(NODE_SUM, value->at);
	bool counted = is_plain_number(value);
	node->start = value->start;
	add_child(node, counted ? convert_unit(value, unit, false) : value, false, value->start);
	node->unit = unit;
	node->counted = counted;
	return node;
}

struct node *state_node(struct symbol *coord, int component, int primes)
{
	struct node *node = node_new(NODE_NAME, coord->at);
	node->symbol = coord;
	node->component = component;
	node->primes = primes;
	node->end.offset += strlen(coord->name);
	return node;
}
