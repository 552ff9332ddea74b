/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A long run of a tape as loops: of statements that wait for nothing of one another those of one shape are turns of
 * one loop. Thousands of lines take compilers minutes, and leave the cache of instructions. */
#include "tape/print.h"

#include <stdlib.h>
#include <string.h>

struct roll {
	int *run, *depth;           /* per node: the run that makes it; how many values wait for one another in it */
	bool *value;                /* per node: it has a place of its own */
	bool *inner;                /* per node: the first terms of a longer sum */
	bool *far;                  /* per node: another run reads it */
	bool *fixed, *ahead;        /* per node: no turn changes it; so it is made before the first, for one that is */
	int *rolls;                 /* per out: the number of the long run that it begins; 0: none */
	struct statement *now;      /* is being made */
	struct blocks blocks;
};

/* ---- which nodes are values ---- */

/* An operand that is read again, maybe behind a line that makes it another: one that has a name, or is no place */
static bool is_kept_operand(struct printing *p, tape_ref ref)
{
	const struct tape_node *n = tape_node(p->t, ref);
	const bool kept = !n->choice && n->op != TAPE_CONSTANT && p->uses[ref] > 1 && !p->local[ref];
	return kept && (n->name || !strchr(tape_bare_text(p, ref, 0), '['));
}

/* A long sum goes on from a value each two terms: then its length is no part of its shape. */
static bool is_value(struct printing *p, tape_ref ref)
{
	const struct tape_node *n = tape_node(p->t, ref);
	if (tape_is_operand(p->t, ref))
		return is_kept_operand(p, ref);
	return !n->choice && (p->roll->inner[ref] || p->roll->ahead[ref] ||
			       (p->uses[ref] > 1 && (!tape_is_cheap(p->t, ref) || n->name)));
}

static void find_inner(const struct printing *p)
{
	for (int i = 0; i < tape_length(p->t); i++) {
		const struct tape_node *n = tape_node(p->t, i);
		const bool sum = p->uses[i] > 0 && n->op == TAPE_ADD;
		if (sum && tape_node(p->t, n->a)->op == TAPE_ADD)
			p->roll->inner[n->a] = true;
	}
}

static int operands_of(const struct tape_node *n, tape_ref operand[3])
{
	int count = 0;
	const tape_ref ref[3] = { n->a, n->b, n->c };
	for (int k = 0; k < 3; k++)
		if (ref[k] != TAPE_NONE)
			operand[count++] = ref[k];
	return count;
}

/* Nodes that no run before has made. Their readers stand behind them, so one walk down finds all. */
static int claim(struct printing *p, int first, int end, int run)
{
	struct roll *r = p->roll;
	int values = 0;
	tape_ref operand[3];
	for (int i = first; i < end; i++)
		if (!r->run[tape_out(p->t, i)->ref])
			r->run[tape_out(p->t, i)->ref] = run;
	for (int i = tape_length(p->t) - 1; i >= 0; i--) {
		if (r->run[i] != run)
			continue;
		values += is_value(p, i);
		for (int k = operands_of(tape_node(p->t, i), operand) - 1; k >= 0; k--)
			if (!r->run[operand[k]])
				r->run[operand[k]] = run;
	}
	return values;
}

/* What is the same in each turn of a loop is made before it. */
static void find_fixed(struct printing *p)
{
	struct roll *r = p->roll;
	tape_ref operand[3];
	for (int i = 0; i < tape_length(p->t) && p->to->across; i++) {
		const struct tape_node *n = tape_node(p->t, i);
		const int operands = operands_of(n, operand);
		r->fixed[i] = !n->choice && !(n->op == TAPE_TABLE && n->part < 0);
		for (int k = 0; k < operands; k++)
			r->fixed[i] = r->fixed[i] && r->fixed[operand[k]];
		for (int k = 0; k < operands && !r->fixed[i] && p->uses[i] > 0; k++)
			r->ahead[operand[k]] = r->fixed[operand[k]] && !tape_is_operand(p->t, operand[k]);
	}
}

static void claim_ahead(const struct printing *p)
{
	struct roll *r = p->roll;
	tape_ref operand[3];
	for (int i = tape_length(p->t) - 1; i >= 0; i--)
		if (r->ahead[i] || (r->run[i] == 1 && r->fixed[i])) {
			r->run[i] = 1;
			for (int k = operands_of(tape_node(p->t, i), operand) - 1; k >= 0; k--)
				r->run[operand[k]] = r->run[operand[k]] ? r->run[operand[k]] : 1;
		}
}

static int end_of_run(const struct tape *t, int out)
{
	while (out < tape_outs(t) && tape_out(t, out)->target)
		out++;
	return out;
}

static void find_depths(const struct printing *p)
{
	const struct roll *r = p->roll;
	tape_ref operand[3];
	for (int i = 0; i < tape_length(p->t); i++)
		for (int k = operands_of(tape_node(p->t, i), operand) - 1; k >= 0; k--) {
			const int at = operand[k], depth = r->depth[at] + r->value[at];
			if (r->run[at] == r->run[i] && depth > r->depth[i])
				r->depth[i] = depth;
			r->far[at] = r->far[at] || r->run[at] != r->run[i];
		}
}

struct roll *roll_new(struct printing *p)
{
	const int nodes = tape_length(p->t);
	int values = 0, run = 0;
	bool any = false;
	struct roll *r = NEW(struct roll);
	*r = (struct roll){ .run = ARRAY(int, nodes + 1), .depth = ARRAY(int, nodes + 1),
			    .value = ARRAY(bool, nodes + 1), .inner = ARRAY(bool, nodes + 1),
			    .fixed = ARRAY(bool, nodes + 1), .ahead = ARRAY(bool, nodes + 1),
			    .far = ARRAY(bool, nodes + 1),
			    .rolls = ARRAY(int, tape_outs(p->t) + 1) };
	r->blocks.far = r->far;
	p->roll = r;
	find_inner(p);
	find_fixed(p);
	claim_ahead(p);
	for (int i = 0, end; i < tape_outs(p->t); i = end + 1) {
		end = end_of_run(p->t, i);
		const int more = claim(p, i, end, ++run);
		r->rolls[i] = end - i + more >= p->to->rolls ? run : 0;
		for (int k = i; k < end; k++)
			r->far[tape_out(p->t, k)->ref] |= r->run[tape_out(p->t, k)->ref] != run;
		any = any || r->rolls[i];
		values += r->rolls[i] ? more : 0;
		for (int k = 0; k < nodes && r->rolls[i]; k++)
			r->value[k] = r->value[k] || (r->run[k] == run && is_value(p, k));
	}
	p->roll = any ? r : NULL;
	if (!any)
		return NULL;
	find_depths(p);
	if (values)
		fprintf(p->out, "%*s%s values_by_0[%d];\n", p->indent, "", p->to->real, values);
	fprintf(p->out, "%*ssize_t turn_by_0;\n", p->indent, "");
	return r;
}

/* ---- leaves ---- */

static struct leaf leaf_of(const char *text)
{
	struct leaf leaf = { .pattern = "" };
	int places = 0;
	while (*text) {
		const size_t bracket = strcspn(text, "[");
		const size_t digits = text[bracket] ? strspn(text + bracket + 1, "0123456789") : 0;
		const bool number = digits > 0 && digits < 9 && text[bracket + 1 + digits] == ']' && places < PLACES;
		const size_t length = text[bracket] ? bracket + 1 : bracket;
		leaf.pattern = format("%s%.*s%s", leaf.pattern, (int)length, text, number ? "#" : "");
		if (number)
			leaf.place[places++] = (int)strtol(text + length, NULL, 10);
		text += length + (number ? digits : 0);
	}
	return leaf;
}

static bool is_same_leaf(const struct leaf *a, const struct leaf *b)
{
	return strcmp(a->pattern, b->pattern) == 0 && memcmp(a->place, b->place, sizeof a->place) == 0 &&
	       (!a->number || strcmp(a->number, b->number) == 0);
}

static const char *add_leaf(struct statement *s, struct leaf leaf)
{
	int k = 0;
	while (k < s->leaves && !is_same_leaf(&s->leaf[k], &leaf))
		k++;
	if (k == s->leaves)
		*MORE(s->leaf, s->leaves) = leaf;
	return format("@%d.", k);
}

static const char *leaf_in_statement(struct printing *p, tape_ref ref)
{
	const struct tape_node *n = tape_node(p->t, ref);
	struct statement *s = p->roll->now;
	if (p->local[ref])
		return add_leaf(s, leaf_of(p->local[ref]));
	if (!tape_is_operand(p->t, ref))
		return NULL;
	const char *text = tape_bare_text(p, ref, 0);
	return add_leaf(s, n->op == TAPE_CONSTANT ? (struct leaf){ .pattern = "#", .number = text } : leaf_of(text));
}

/* ---- statements that wait for nothing of one another ---- */

struct groups { int count; struct group *group; };

static bool is_alike(const struct statement *a, const struct statement *b)
{
	bool alike = a->leaves == b->leaves && strcmp(a->shape, b->shape) == 0;
	for (int k = 0; alike && k < a->leaves; k++)
		alike = strcmp(a->leaf[k].pattern, b->leaf[k].pattern) == 0;
	return alike;
}

static void sort_in(struct groups *g, const struct statement *s)
{
	int i = 0;
	while (i < g->count && !is_alike(g->group[i].member[0], s))
		i++;
	if (i == g->count)
		*MORE(g->group, g->count) = (struct group){ 0, NULL };
	*MORE(g->group[i].member, g->group[i].count) = s;
}

/* `set`: the leaf that it sets; ref: what that becomes */
static struct statement *statement_of(struct printing *p, struct leaf set, tape_ref ref)
{
	struct statement *s = NEW(struct statement);
	*s = (struct statement){ .value = TAPE_NONE, .out = TAPE_NONE };
	const char *target = add_leaf(s, set);
	p->roll->now = s;
	p->leaf = leaf_in_statement;
	const bool leaf = p->local[ref] || tape_is_operand(p->t, ref);
	const char *text = leaf ? leaf_in_statement(p, ref) : tape_bare_text(p, ref, p->indent + 8);
	p->leaf = NULL;
	s->shape = format("%s = %s", target, text);
	return s;
}

static void add_groups(struct printing *p, const struct groups *all)
{
	for (int i = 0; i < all->count; i++)
		loops_add(p, &p->roll->blocks, &all->group[i]);
}

static int add_depth(struct printing *p, int run, int depth)
{
	const struct roll *r = p->roll;
	struct groups made = { 0, NULL };
	int deeper = 0;
	for (int i = 0; i < tape_length(p->t); i++) {
		if (!r->value[i] || r->run[i] != run)
			continue;
		deeper += r->depth[i] > depth;
		if (r->depth[i] != depth)
			continue;
		const struct leaf place = { .pattern = "values_by_0[#]", .place = { TAPE_NONE } };
		struct statement *s = statement_of(p, place, i);
		s->value = i;
		sort_in(&made, s);
	}
	add_groups(p, &made);
	return deeper;
}

static void add_targets(struct printing *p, int out, int end)
{
	struct groups set = { 0, NULL };
	for (int i = out; i < end; i++) {
		const struct tape_out *o = tape_out(p->t, i);
		if (o->local) {
			loops_print(p, &p->roll->blocks);
			tape_set_text(p, o, tape_text(p, o->ref, CHOICE, o->indent));
			continue;
		}
		struct statement *s = statement_of(p, leaf_of(o->target), o->ref);
		s->out = i;
		sort_in(&set, s);
	}
	add_groups(p, &set);
}

int roll_run(struct printing *p, int out)
{
	if (!p->roll || !p->roll->rolls[out])
		return TAPE_NONE;
	const int end = end_of_run(p->t, out);
	for (int depth = 0; add_depth(p, p->roll->rolls[out], depth) > 0; depth++)
		;
	add_targets(p, out, end);
	loops_print(p, &p->roll->blocks);
	return end;
}
