/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A long run of a tape as loops: of statements that wait for nothing of one another those of one shape are turns of
 * one loop, over tables of what differs in them, numbers and places in arrays. Each does what its line would do, so the
 * bits stay; but thousands of lines take compilers minutes, and leave the cache of instructions. */
#include "tape/print.h"

#include <stdlib.h>
#include <string.h>

enum { FEW = 4, PLACES = 4, WIDTH = 100, VECTORS = 8 };

/* An operand or a value where a statement reads it, or what it sets: a pattern with # for each number in brackets; of a
 * constant "#", and its text */
struct leaf { const char *pattern, *number; int place[PLACES]; };

struct statement {
	const char *shape;          /* C, leaf k as @k. */
	int leaves;
	struct leaf *leaf;          /* the first is what it sets: */
	tape_ref value;             /* TAPE_NONE: out `out` */
	int out;
};

struct roll {
	int *run, *depth;           /* per node: the run that makes it; how many values wait for one another in it */
	bool *value;                /* per node: it has a place of its own */
	bool *inner;                /* per node: the first terms of a longer sum */
	bool *fixed, *ahead;        /* per node: no turn changes it; so it is made before the first, for one that is */
	int *rolls;                 /* per out: the number of the long run that it begins; 0: none */
	int made;                   /* places so far */
	struct statement *now;      /* is being made */
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
			    .rolls = ARRAY(int, tape_outs(p->t) + 1) };
	p->roll = r;
	find_inner(p);
	find_fixed(p);
	claim_ahead(p);
	for (int i = 0, end; i < tape_outs(p->t); i = end + 1) {
		end = end_of_run(p->t, i);
		const int more = claim(p, i, end, ++run);
		r->rolls[i] = end - i + more >= p->to->rolls ? run : 0;
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
	fprintf(p->out, "%*sint turn_by_0;\n", p->indent, "");
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

/* ---- one loop ---- */

struct loop { const struct statement *const *turn; int turns; };

static void print_table(const struct printing *p, const struct loop *l, const char *head, int leaf, int place)
{
	const int indent = p->indent + 4;
	int column = fprintf(p->out, "%*sstatic const %s[%d] = {", indent, "", head, l->turns);
	for (int i = 0; i < l->turns; i++) {
		const struct leaf *f = &l->turn[i]->leaf[leaf];
		const char *entry = f->number ? f->number : format("%d", f->place[place]);
		const bool full = column + (int)strlen(entry) > WIDTH;
		column = full ? indent + 4 : column;
		column += fprintf(p->out, "%s", i > 0 ? full ? ",\n" : ", " : "");
		fprintf(p->out, "%*s%s", i > 0 && full ? indent + 4 : 0, "", entry);
		column += (int)strlen(entry);
	}
	fprintf(p->out, "};\n");
}

/* A place of a leaf as it depends on the turn */
static const char *place_text(const struct printing *p, const struct loop *l, int leaf, int place, int *tables)
{
	const int first = l->turn[0]->leaf[leaf].place[place], stride = l->turn[1]->leaf[leaf].place[place] - first;
	bool even = true, small = true;
	for (int i = 0; i < l->turns; i++) {
		const int at = l->turn[i]->leaf[leaf].place[place];
		even = even && at == first + i * stride;
		small = small && at < 32768;
	}
	if (even && stride == 0)
		return format("%d", first);
	if (even && stride > 0)
		return format("%s%sturn_by_0", first ? format("%d + ", first) : "",
			      stride > 1 ? format("%d * ", stride) : "");
	const char *name = format("place_by_%d", (*tables)++);
	print_table(p, l, format("%s %s", small ? "short" : "int", name), leaf, place);
	return format("%s[turn_by_0]", name);
}

static bool is_same_number(const struct loop *l, int leaf)
{
	bool same = true;
	for (int i = 1; i < l->turns; i++)
		same = same && is_same_leaf(&l->turn[0]->leaf[leaf], &l->turn[i]->leaf[leaf]);
	return same;
}

static const char *leaf_text(const struct printing *p, const struct loop *l, int leaf, int *tables)
{
	const struct leaf *f = &l->turn[0]->leaf[leaf];
	if (f->number && is_same_number(l, leaf))
		return *f->number == '-' ? format("(%s)", f->number) : f->number;
	if (f->number) {
		const char *name = format("number_by_%d", (*tables)++);
		print_table(p, l, format("%s %s", p->to->real, name), leaf, 0);
		return format("%s[turn_by_0]", name);
	}
	const char *text = "", *rest = f->pattern;
	for (int k = 0; *rest; k++) {
		const size_t length = strcspn(rest, "#");
		const char *place = rest[length] ? place_text(p, l, leaf, k, tables) : "";
		text = format("%s%.*s%s", text, (int)length, rest, place);
		rest += length + (rest[length] == '#');
	}
	return text;
}

/* The shape with each @k. as its text */
static const char *filled(const char *shape, const char *const *text)
{
	const char *all = "";
	while (*shape) {
		const size_t length = strcspn(shape, "@");
		all = format("%s%.*s", all, (int)length, shape);
		shape += length;
		if (*shape) {
			char *end;
			all = format("%s%s", all, text[strtol(shape + 1, &end, 10)]);
			shape = end + 1;
		}
	}
	return all;
}

/* Up to a blank that stands in no index */
static int word_length(const char *text)
{
	int length = 0, depth = 0;
	for (; text[length] && (depth > 0 || !strchr(" \n", text[length])); length++)
		depth += (text[length] == '[') - (text[length] == ']');
	return length;
}

static void print_folded(const struct printing *p, int indent, const char *text, const char *note)
{
	int column = fprintf(p->out, "%*s", indent, "");
	while (*text) {
		const int blanks = (int)strspn(text, " \n"), length = word_length(text + blanks);
		if (column + length > WIDTH && column > indent)
			column = fprintf(p->out, "\n%*s", indent + 4, "") - 1;
		else
			column += fprintf(p->out, "%s", blanks ? " " : "");
		column += fprintf(p->out, "%.*s", length, text + blanks);
		text += blanks + length;
	}
	fprintf(p->out, ";%s\n", note ? format("  /* %s */", note) : "");
}

/* Turns without tables read side by side: as many of them as fill vectors are a loop of their own, which compilers make
 * one of vectors also at -O2. */
static void print_loop(const struct printing *p, const struct loop *l)
{
	const struct statement *first = l->turn[0];
	SCRATCH const char **text = ARRAY(const char *, first->leaves);
	int tables = 0;
	fprintf(p->out, "%*s{\n", p->indent, "");
	for (int k = 0; k < first->leaves; k++)
		text[k] = leaf_text(p, l, k, &tables);
	const int vectors = tables || !p->to->across ? 0 : l->turns / VECTORS * VECTORS;
	for (int i = vectors > 0 ? 0 : 1; i < 2 && (i == 0 || vectors < l->turns); i++) {
		fprintf(p->out, "%*sfor (turn_by_0 = %d; turn_by_0 < %d; turn_by_0++) {\n", p->indent + 4, "",
			i > 0 ? vectors : 0, i > 0 ? l->turns : vectors);
		print_folded(p, p->indent + 8, filled(first->shape, text), NULL);
		fprintf(p->out, "%*s}\n", p->indent + 4, "");
	}
	fprintf(p->out, "%*s}\n", p->indent, "");
}

static void print_alone(const struct printing *p, const struct statement *s)
{
	SCRATCH const char **text = ARRAY(const char *, s->leaves);
	const struct loop twice = { (const struct statement *const[]){ s, s }, 2 };     /* all of it is the same */
	int tables = 0;
	for (int k = 0; k < s->leaves; k++)
		text[k] = leaf_text(p, &twice, k, &tables);
	print_folded(p, p->indent, filled(s->shape, text), s->value == TAPE_NONE ? tape_out(p->t, s->out)->note : NULL);
}

/* ---- statements that wait for nothing of one another ---- */

struct group { int count; const struct statement **member; };
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

/* Values have their places once it is known which of them are made together. */
static void place_values(struct printing *p, const struct group *g)
{
	for (int i = 0; i < g->count; i++) {
		const tape_ref ref = g->member[i]->value;
		if (ref == TAPE_NONE)
			return;
		g->member[i]->leaf[0].place[0] = p->roll->made;
		p->local[ref] = format("values_by_0[%d]", p->roll->made++);
	}
}

/* As many turns from this one on as differ by places that rise evenly */
static int even_turns(const struct group *g, int from)
{
	const struct statement *const *s = g->member + from;
	bool even = true;
	int turns = 1;
	for (; from + turns < g->count && even; turns += even)
		for (int k = 0; k < s[0]->leaves && even; k++) {
			const struct leaf *a = &s[0]->leaf[k], *b = &s[1]->leaf[k], *now = &s[turns]->leaf[k];
			even = !a->number || strcmp(a->number, now->number) == 0;
			for (int i = 0; i < PLACES; i++) {
				const int stride = b->place[i] - a->place[i];
				even = even && stride >= 0 && now->place[i] == a->place[i] + turns * stride;
			}
		}
	return turns;
}

/* Those that are even are loops of their own; said is what is left. */
static struct group print_even(const struct printing *p, const struct group *g)
{
	struct group left = { 0, NULL };
	for (int i = 0, turns; i < g->count; i += turns) {
		turns = p->to->across ? even_turns(g, i) : 1;
		if (turns >= VECTORS)
			print_loop(p, &(struct loop){ g->member + i, turns });
		else
			*MORE(left.member, left.count) = g->member[i];
		turns = turns >= VECTORS ? turns : 1;
	}
	return left;
}

static void print_groups(struct printing *p, const struct groups *all)
{
	for (int i = 0; i < all->count; i++) {
		place_values(p, &all->group[i]);
		const struct group g = print_even(p, &all->group[i]);
		if (g.count >= FEW)
			print_loop(p, &(struct loop){ g.member, g.count });
		for (int k = 0; k < g.count && g.count < FEW; k++)
			print_alone(p, g.member[k]);
	}
}

static int print_depth(struct printing *p, int run, int depth)
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
	print_groups(p, &made);
	return deeper;
}

static void print_targets(struct printing *p, int out, int end)
{
	struct groups set = { 0, NULL };
	for (int i = out; i < end; i++) {
		const struct tape_out *o = tape_out(p->t, i);
		if (o->local) {
			tape_set_text(p, o, tape_text(p, o->ref, CHOICE, o->indent));
			continue;
		}
		struct statement *s = statement_of(p, leaf_of(o->target), o->ref);
		s->out = i;
		sort_in(&set, s);
	}
	print_groups(p, &set);
}

int roll_run(struct printing *p, int out)
{
	if (!p->roll || !p->roll->rolls[out])
		return TAPE_NONE;
	const int end = end_of_run(p->t, out);
	for (int depth = 0; print_depth(p, p->roll->rolls[out], depth) > 0; depth++)
		;
	print_targets(p, out, end);
	return end;
}
