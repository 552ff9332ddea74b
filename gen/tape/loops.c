/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statements that wait for nothing of one another as loops: over tables of what differs in them; or, of what stands
 * side by side, over lanes. Such loops are one as long as each turn reads of the others what they make in it, which
 * then needs no place. Each does what its line would do, so the bits stay. */
#include "tape/print.h"

#include <limits.h>
#include <stdlib.h>
#include <string.h>

enum { FEW = 4, WIDTH = 100, NO_SHIFT = INT_MIN };
enum { WORTH = 8 };                     /* loops become one where all but one turn of so many are in both */

struct loop { const struct statement **turn; int turns; };

/* Loops of the same turns, one after the other in each; not of lanes: one, maybe of one turn */
struct block { int loops; bool lanes; struct loop *loop; };

/* ---- one loop ---- */

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
		same = same && strcmp(l->turn[0]->leaf[leaf].number, l->turn[i]->leaf[leaf].number) == 0;
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

static void print_loop(const struct printing *p, const struct loop *l)
{
	const struct statement *first = l->turn[0];
	SCRATCH const char **text = ARRAY(const char *, first->leaves);
	int tables = 0;
	fprintf(p->out, "%*s{\n", p->indent, "");
	for (int k = 0; k < first->leaves; k++)
		text[k] = leaf_text(p, l, k, &tables);
	fprintf(p->out, "%*sfor (turn_by_0 = 0; turn_by_0 < %d; turn_by_0++) {\n", p->indent + 4, "", l->turns);
	print_folded(p, p->indent + 8, filled(first->shape, text), NULL);
	fprintf(p->out, "%*s}\n%*s}\n", p->indent + 4, "", p->indent, "");
}

static void print_alone(const struct printing *p, const struct statement *s)
{
	SCRATCH const char **text = ARRAY(const char *, s->leaves);
	const struct loop twice = { (const struct statement *[]){ s, s }, 2 };          /* all of it is the same */
	int tables = 0;
	for (int k = 0; k < s->leaves; k++)
		text[k] = leaf_text(p, &twice, k, &tables);
	print_folded(p, p->indent, filled(s->shape, text), s->value == TAPE_NONE ? tape_out(p->t, s->out)->note : NULL);
}

/* ---- which places turns have ---- */

/* A leaf of all turns: the least and the largest of each number in brackets */
static void find_range(const struct loop *l, int leaf, int *least, int *most)
{
	for (int i = 0; i < PLACES; i++)
		least[i] = most[i] = l->turn[0]->leaf[leaf].place[i];
	for (int t = 1; t < l->turns; t++)
		for (int i = 0; i < PLACES; i++) {
			const int at = l->turn[t]->leaf[leaf].place[i];
			least[i] = at < least[i] ? at : least[i];
			most[i] = at > most[i] ? at : most[i];
		}
}

/* May a turn of one have there what a turn of the other has? Sums of products are of what turns before have made. */
static bool overlaps(const struct loop *a, int i, const struct loop *b, int k)
{
	int least[2][PLACES], most[2][PLACES];
	if (strcmp(a->turn[0]->leaf[i].pattern, b->turn[0]->leaf[k].pattern) != 0)
		return false;
	find_range(a, i, least[0], most[0]);
	find_range(b, k, least[1], most[1]);
	for (int m = 0; m < PLACES; m++)
		if (most[0][m] < least[1][m] || most[1][m] < least[0][m])
			return false;
	return true;
}

/* ---- loops of lanes, side by side as long as none reads what another turn of them sets ---- */

enum { MAY_FOLLOW = 3 };                /* that are tried as the second of a chain */

static bool is_lane_place(const struct leaf *a, const struct leaf *b)
{
	const size_t length = strlen(a->pattern);
	int last = -1, other = 0, depth = 0;
	for (const char *c = a->pattern; *c; c++) {
		last += *c == '#';
		depth += (*c == '[') - (*c == ']');
		other += *c == '(' || (*c == ' ' && depth == 0);
	}
	for (int i = 0; i < PLACES; i++)
		other += i != last && a->place[i] != b->place[i];
	return other == 0 && last >= 0 && b->place[last] == a->place[last] + 1 &&
	       strcmp(a->pattern + length - 2, "#]") == 0;
}

static bool is_same_place(const struct leaf *a, const struct leaf *b)
{
	return memcmp(a->place, b->place, sizeof a->place) == 0;
}

/* Is `s` turn `turns` of a loop with these as its first? With `numbers` these are the same, too. */
static bool goes_on(const struct statement *first, const struct statement *second, const struct statement *s, int turns,
		    bool numbers)
{
	for (int k = 0; k < s->leaves; k++) {
		const struct leaf *a = &first->leaf[k], *b = &second->leaf[k], *now = &s->leaf[k];
		if (numbers && a->number && strcmp(a->number, now->number) != 0)
			return false;
		for (int i = 0; i < PLACES; i++)
			if (now->place[i] != a->place[i] + turns * (b->place[i] - a->place[i]))
				return false;
		if (!is_same_place(a, b) && !is_lane_place(a, b))
			return false;
	}
	return true;
}

/* From member `from` of the group on, those that are left */
static struct loop chain_from(const struct group *g, int from, int second, bool numbers)
{
	struct loop l = { NULL, 0 };
	*MORE(l.turn, l.turns) = g->member[from];
	for (int i = second; i < g->count; i++)
		if (g->member[i] && goes_on(g->member[from], g->member[second], g->member[i], l.turns, numbers))
			*MORE(l.turn, l.turns) = g->member[i];
	return l;
}

/* Lanes know + - * / alone; something of what is read differs. */
static bool is_of_lanes(const struct loop *l)
{
	const struct statement *a = l->turn[0], *b = l->turn[1];
	bool lanes = false;
	if (a->shape[strspn(a->shape, "@0123456789. =+-*/()\n")] || strstr(a->shape + 1, "@0."))
		return false;
	for (int k = 1; k < a->leaves; k++) {
		lanes = lanes || a->leaf[k].number ? lanes || !is_same_number(l, k)
						   : !is_same_place(&a->leaf[k], &b->leaf[k]);
		if (strcmp(a->leaf[k].pattern, a->leaf[0].pattern) == 0 && overlaps(l, k, l, 0))
			return false;
	}
	return lanes && (a->value != TAPE_NONE || !is_same_place(&a->leaf[0], &b->leaf[0]));
}

static struct loop take_chain(const struct printing *p, struct group *g, int from, bool numbers)
{
	struct loop best = { NULL, 0 };
	int tried = 0;
	for (int i = from + 1; i < g->count && tried < MAY_FOLLOW && best.turns < p->to->across; i++)
		if (g->member[i] && goes_on(g->member[from], g->member[i], g->member[i], 1, numbers)) {
			best = chain_from(g, from, i, numbers);
			tried++;
		}
	if (best.turns < p->to->across || !is_of_lanes(&best))
		return (struct loop){ NULL, 0 };
	for (int i = from, k = 0; k < best.turns; i++)
		if (g->member[i] == best.turn[k]) {
			g->member[i] = NULL;
			k++;
		}
	return best;
}

/* ---- which blocks ---- */

/* Does the later one read what the first sets, or set what that reads or sets? */
static bool waits_for(const struct loop *first, const struct loop *later)
{
	bool waits = false;
	for (int k = 0; k < later->turn[0]->leaves && !waits; k++)
		waits = overlaps(first, 0, later, k);
	for (int k = 1; k < first->turn[0]->leaves && !waits; k++)
		waits = overlaps(first, k, later, 0);
	return waits;
}

static bool waits_for_block(const struct block *u, const struct loop *l)
{
	bool waits = false;
	for (int i = 0; i < u->loops && !waits; i++)
		waits = waits_for(&u->loop[i], l);
	return waits;
}

/* Turn t of `l` reads of turn t + shift of the first what that makes; false: also of another, or it sets what that has.
 * A shift of NO_SHIFT is not known yet. */
static bool find_shift(const struct loop *first, const struct loop *l, int *shift)
{
	for (int k = 1; k < first->turn[0]->leaves; k++)
		if (overlaps(first, k, l, 0))
			return false;
	for (int k = 0; k < l->turn[0]->leaves; k++) {
		if (!overlaps(first, 0, l, k))
			continue;
		const struct leaf *a = &l->turn[0]->leaf[k], *set = &first->turn[0]->leaf[0];
		const int own = a->place[0] - set->place[0];
		if (k == 0 || first->turn[0]->value == TAPE_NONE || is_same_place(a, &l->turn[1]->leaf[k]) ||
		    (*shift != NO_SHIFT && *shift != own))
			return false;
		*shift = own;
	}
	return true;
}

static struct loop part_of_loop(const struct loop *l, int first, int end)
{
	return (struct loop){ l->turn + first, end - first };
}

/* Turns [first, end) of the loop, less those at its ends that wait for the block; said is whether no other does. */
static bool trim(const struct block *u, const struct loop *l, int *first, int *end)
{
	struct loop part;
	while (*first < *end && (part = part_of_loop(l, *first, *first + 1), waits_for_block(u, &part)))
		++*first;
	while (*first < *end && (part = part_of_loop(l, *end - 1, *end), waits_for_block(u, &part)))
		--*end;
	part = part_of_loop(l, *first, *end);
	return *first < *end && !waits_for_block(u, &part);
}

/* Where turn t of the loop is turn t + shift of the block: which of them that has; block NULL: too few */
struct joint { struct block *block; int shift, first, end; bool reads; };

static struct joint joint_with(struct block *u, const struct loop *l, int first, int end)
{
	struct joint j = { .shift = NO_SHIFT };
	bool fits = u->lanes;
	const struct loop part = part_of_loop(l, first, end);
	for (int k = 0; k < u->loops && fits; k++)
		fits = find_shift(&u->loop[k], &part, &j.shift);
	j.reads = j.shift != NO_SHIFT;
	j.shift = j.reads ? j.shift - first : 0;
	const int turns = u->loop[0].turns, most = turns > l->turns ? turns : l->turns;
	j.first = first + j.shift < 0 ? -j.shift : first;
	j.end = end + j.shift > turns ? turns - j.shift : end;
	j.block = fits && WORTH * (j.end - j.first) >= (WORTH - 1) * most ? u : NULL;
	return j;
}

/* The last block that makes what it reads, or else the last one at all, that the loop can be part of */
static struct joint find_joint(const struct printing *p, const struct blocks *all, const struct loop *l)
{
	struct joint best = { NULL };
	int first = 0, end = l->turns;
	for (int i = all->count - 1; i >= 0 && !best.reads; i--) {
		const struct joint j = joint_with(&all->block[i], l, first, end);
		if (j.block && j.end - j.first >= p->to->across && (j.reads || !best.block))
			best = j;
		if (!best.reads && waits_for_block(&all->block[i], l) && !trim(&all->block[i], l, &first, &end))
			break;
	}
	return best;
}

static void add_block(struct blocks *all, int at, struct loop l, bool lanes)
{
	struct block u = { .lanes = lanes };
	*MORE(u.loop, u.loops) = l;
	(void)MORE(all->block, all->count);
	memmove(&all->block[at + 1], &all->block[at], (size_t)(all->count - 1 - at) * sizeof u);
	all->block[at] = u;
}

static void add_alone(struct blocks *all, int at, const struct loop *l, int turn)
{
	add_block(all, at, (struct loop){ l->turn + turn, 1 }, false);
}

/* Turns that not all of them have are statements before and behind. */
static void join(struct blocks *all, const struct joint *j, const struct loop *l)
{
	struct block *u = j->block;
	const int loops = u->loops, turns = u->loop[0].turns;
	int at = (int)(u - all->block);
	SCRATCH struct loop *before = ARRAY(struct loop, loops);
	for (int i = 0; i < loops; i++) {
		before[i] = u->loop[i];
		u->loop[i] = part_of_loop(&before[i], j->first + j->shift, j->end + j->shift);
	}
	*MORE(u->loop, u->loops) = part_of_loop(l, j->first, j->end);
	for (int t = 0; t < turns; t++)
		for (int i = 0; i < loops && (t < j->first + j->shift || t >= j->end + j->shift); i++)
			add_alone(all, at++, &before[i], t);
	for (int t = 0; t < l->turns; t++)
		if (t < j->first || t >= j->end)
			add_alone(all, all->count, l, t);
}

/* ---- their C ---- */

/* What an earlier loop of the block made in the same turn; NULL: none did */
static const char *made_before(const struct block *u, int loop, int leaf)
{
	for (int i = 0; i < loop; i++)
		if (overlaps(&u->loop[i], 0, &u->loop[loop], leaf))
			return format("lanes_by_%d", u->loop[i].turn[0]->leaf[0].place[0]);
	return NULL;
}

/* Is it in its place once the block is over? */
static bool is_stored(const struct blocks *all, const struct block *u, const struct loop *l)
{
	bool stored = l->turn[0]->value == TAPE_NONE;
	for (int i = 0; i < l->turns && !stored; i++)
		stored = all->far[l->turn[i]->value];
	for (int i = 0; i < all->count; i++)
		for (int k = 0; k < all->block[i].loops && &all->block[i] != u && !stored; k++)
			for (int m = 1; m < all->block[i].loop[k].turn[0]->leaves && !stored; m++)
				stored = overlaps(l, 0, &all->block[i].loop[k], m);
	return stored;
}

static const char *lanes_text(const struct printing *p, const struct block *u, int loop, int leaf, int *tables)
{
	const struct loop *l = &u->loop[loop];
	const struct leaf *a = &l->turn[0]->leaf[leaf], *b = &l->turn[1]->leaf[leaf];
	const char *made = leaf > 0 ? made_before(u, loop, leaf) : NULL;
	if (made)
		return made;
	const bool same = a->number ? is_same_number(l, leaf) : is_same_place(a, b);
	const char *text = leaf_text(p, l, leaf, tables);
	return same || leaf == 0 ? text : format("pl_lanes_at(&%s)", text);
}

static void print_lanes(const struct printing *p, const struct blocks *all, const struct block *u)
{
	SCRATCH const char ***text = ARRAY(const char **, u->loops);
	const int turns = u->loop[0].turns;
	int tables = 0;
	fprintf(p->out, "%*s{\n", p->indent, "");
	for (int i = 0; i < u->loops; i++) {
		text[i] = ARRAY(const char *, u->loop[i].turn[0]->leaves);
		for (int k = 0; k < u->loop[i].turn[0]->leaves; k++)
			text[i][k] = lanes_text(p, u, i, k, &tables);
	}
	fprintf(p->out, "%*sfor (turn_by_0 = 0; turn_by_0 < %d; turn_by_0 = pl_lanes_next(turn_by_0, %d)) {\n",
		p->indent + 4, "", turns, turns);
	for (int i = 0; i < u->loops; i++) {
		const struct statement *first = u->loop[i].turn[0];
		const char *name = format("lanes_by_%d", first->leaf[0].place[0]), *place = text[i][0];
		const char *right = strchr(first->shape, '=') + 2;
		if (first->value != TAPE_NONE)
			print_folded(p, p->indent + 8, format("const pl_lanes %s = %s", name, filled(right, text[i])),
				     NULL);
		if (is_stored(all, u, &u->loop[i]))
			print_folded(p, p->indent + 8, format("pl_lanes_put(&%s, %s)", place, first->value != TAPE_NONE
							      ? name : filled(right, text[i])), NULL);
	}
	fprintf(p->out, "%*s}\n%*s}\n", p->indent + 4, "", p->indent, "");
}

/* ---- the whole ---- */

/* Values have their places once it is known which of them are made together. */
static void place_values(struct printing *p, struct blocks *all, const struct loop *l)
{
	for (int i = 0; i < l->turns && l->turn[i]->value != TAPE_NONE; i++)
		p->local[l->turn[i]->value] = format(VALUES_PLACE, l->turn[i]->leaf[0].place[0] = all->places++);
}

void loops_add(struct printing *p, struct blocks *all, struct group *g)
{
	struct loop left = { NULL, 0 };
	for (int i = 0; i < 2 * g->count && p->to->across; i++) {
		const int from = i % g->count;
		const struct loop l = g->member[from] ? take_chain(p, g, from, i < g->count) : left;
		if (l.turns == 0)
			continue;
		place_values(p, all, &l);
		const struct joint j = find_joint(p, all, &l);
		if (j.block)
			join(all, &j, &l);
		else
			add_block(all, all->count, l, true);
	}
	for (int i = 0; i < g->count; i++)
		if (g->member[i])
			*MORE(left.turn, left.turns) = g->member[i];
	place_values(p, all, &left);
	if (left.turns >= FEW)
		add_block(all, all->count, left, false);
	for (int i = 0; i < left.turns && left.turns < FEW; i++)
		add_alone(all, all->count, &left, i);
}

void loops_print(struct printing *p, struct blocks *all)
{
	for (int i = 0; i < all->count; i++) {
		const struct block *u = &all->block[i];
		if (u->lanes)
			print_lanes(p, all, u);
		else if (u->loop[0].turns > 1)
			print_loop(p, &u->loop[0]);
		else
			print_alone(p, u->loop[0].turn[0]);
	}
	all->count = 0;
}
