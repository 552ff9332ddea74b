/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What happens at an instant: state jumps where a condition comes true, stops that bounce. */
#include "read/parser.h"

static struct when *add_when(struct parser *p, const struct when *when)
{
	struct when *added = MORE(p->spec->when, p->spec->whens);
	*added = *when;
	return added;
}

static bool same_state(const struct node *a, const struct node *b)
{
	return a->symbol == b->symbol && a->component == b->component && a->primes == b->primes;
}

/* x, x' or q[3]': what a jump gives a new value */
static struct node *read_target(struct parser *p)
{
	if (p->token.kind != TOKEN_NAME || (is_reserved(p->token.name) && !find_symbol(p, p->token.name)))
		unexpected(p, "a state to jump");
	struct node *node = read_state(p);
	const struct symbol *symbol = node->symbol;
	if (symbol && symbol->kind == SYMBOL_INPUT)
		error(node->at, "coordinates and their velocities jump",
		      "input '%s' is what its samples say: it cannot jump", symbol->name);
	if (!symbol || symbol->kind != SYMBOL_COORD)
		error(node->at, "coordinates and their velocities jump", "'%s' is no state: it cannot jump",
		      text_between(node->start, node->end));
	if (symbol->length && !node->component)
		error(node->at, format("by components: %s[1]%s = ...", symbol->name, node->primes ? "'" : ""),
		      "expected a scalar state, found '%s'", text_between(node->start, node->end));
	if (node->primes > 1)
		error(node->at, "velocities jump", "'%s' follows from the equations: it cannot jump",
		      text_between(node->start, node->end));
	return node;
}

/* assignment: name = expression */
static void read_assignment(struct parser *p, struct when *when)
{
	struct state_jump jump = { .target = read_target(p) };
	for (int i = 0; i < when->jumps; i++)
		if (same_state(when->jump[i].target, jump.target))
			error(jump.target->at, NULL, "'%s' jumps already in this statement",
			      text_between(jump.target->start, jump.target->end));
	expect_op(p, "=", "'='");
	jump.value = read_quantity(p);
	*MORE(when->jump, when->jumps) = jump;
}

/* when: when comparison : assignment { , assignment } */
void read_when(struct parser *p)
{
	struct when when = { .at = { p->lexer.source, p->statement }, .part = p->part };
	when.guard = read_condition(p);
	if (when.guard->kind != NODE_COMPARE)
		error(when.guard->start, "when x >= 0.1: x' = -0.8*x'", "expected a comparison, found '%s'",
		      text_between(when.guard->start, when.guard->end));
	if (when.guard->comparison >= CMP_EQ)
		error(when.guard->at, "it comes true by crossing: >= <= > <",
		      "a guard with %s comes true by no crossing", when.guard->comparison == CMP_EQ ? "==" : "!=");
	expect_op(p, ":", "':' before what jumps");
	do
		read_assignment(p, &when);
	while (take_op(p, ","));
	expect_end(p);
	when.end = p->end;
	add_when(p, &when);
}

static struct node *difference(struct node *a, struct node *b)
{
	struct place at = a ? a->at : b->at;
	if (a && !b)
		return a;
	struct node *sum = node_new(NODE_SUM, at);
	if (a)
		add_child(sum, a, false, at);
	add_child(sum, b, true, at);
	sum->start = a ? a->start : b->start;
	sum->end = b->end;
	return sum;
}

/* A coordinate or any expression of coordinates; NULL: the ground */
static struct node *read_end(struct parser *p)
{
	return take_word(p, "ground") ? NULL : read_expression(p);
}

static bool is_plain_coordinate(const struct node *node)
{
	const struct symbol *symbol = node->kind == NODE_NAME ? node->symbol : NULL;
	return symbol && symbol->kind == SYMBOL_COORD && node->primes == 0 && (!symbol->length || node->component);
}

static bool same_place(const struct node *a, const struct node *b)
{
	return a == b || (a && b && a->symbol == b->symbol && a->component == b->component);
}

/* stop: stop between expression , expression at expression restitution expression. What comes up to it is the first
 * less the second; coordinates alone are kept, whose equations the force acts on. */
void read_stop(struct parser *p)
{
	struct when when = { .at = { p->lexer.source, p->statement }, .part = p->part };
	expect_word(p, "between");
	struct token first = p->token;
	struct node *from = read_end(p);
	expect_op(p, ",", "','");
	struct node *to = read_end(p);
	const bool coordinates = (!from || is_plain_coordinate(from)) && (!to || is_plain_coordinate(to));
	if (coordinates && same_place(from, to))
		error(first.at, NULL, "it acts between a coordinate and itself");
	when.from = coordinates ? from : NULL;
	when.to = coordinates ? to : NULL;
	expect_word(p, "at");
	when.gap = read_quantity(p);
	expect_word(p, "restitution");
	when.restitution = read_expression(p);
	expect_end(p);
	when.end = p->end;
	when.guard = node_new(NODE_COMPARE, first.at);
	when.guard->comparison = CMP_GE;
	add_child(when.guard, difference(from, to), false, first.at);
	add_child(when.guard, when.gap, false, first.at);
	when.guard->start = first.at;
	when.guard->end = p->end;
	add_when(p, &when);
}
