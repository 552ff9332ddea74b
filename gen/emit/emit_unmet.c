/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions with friction and impacts: a step that meets none of the guards of its region, as sums with a bound for each
 * of them. The search would take the same step, to the last bit: the sums have the order that its products have, and
 * no bound is below its own and what it leaves to rounding there. */
#include "emit/emit.h"

#include <math.h>
#include <string.h>

struct local { const char *text, *name; };
struct unmet {
	const struct pieces *pieces;
	const struct guards *guards;
	int columns;
	const char **x, **end, **size; /* of each entry of x: now, at the end; its size, "" where a bound has it */
	int locals;                 /* of a region */
	struct local *local;
};

/* a + b; NULL: nothing */
static const char *sum_of(const char *a, const char *b, int indent)
{
	const char *both[] = { a, b };
	return !b ? a : !a ? b : tree(2, both, indent);
}

static const char *in_brackets(const char *a, const char *b, int indent)
{
	const char *sum = sum_of(a, b, indent);
	return a && b ? format("(%s)", sum) : sum;
}

/* row . operand in the order of the runtime's sums: every fourth term, one after the other, then these */
static const char *dot_text(int columns, const double *row, const char *const *operand, int indent)
{
	const char *sum[4] = { NULL, NULL, NULL, NULL };
	for (int j = 0; j < columns; j++)
		if (row[j] != 0)
			sum[j % 4] = in_brackets(sum[j % 4], scaled(row[j], *operand[j] ? operand[j] : NULL), indent);
	if (!sum[1] && !sum[3])
		return sum[0] || sum[2] ? sum_of(sum[0], sum[2], indent) : "0.0";
	if (!sum[0] && !sum[2])
		return sum_of(sum[1], sum[3], indent);
	return sum_of(in_brackets(sum[0], sum[2], indent), in_brackets(sum[1], sum[3], indent), indent);
}

/* Of a bound: with a number of its own */
static const char *bound_text(int columns, const double *row, const char *const *size, double still, int indent)
{
	const char **term = ARRAY(const char *, (size_t)columns + 1);
	int terms = 0;
	for (int j = 0; j < columns; j++)
		if (row[j] != 0 && *size[j])
			term[terms++] = scaled(row[j], size[j]);
	if (still != 0 || terms == 0)
		term[terms++] = shortest(still);
	return tree(terms, term, indent);
}

/* ---- what is held ---- */

static int set_of(const struct unmet *u, int region, int *end)
{
	const struct guards *g = u->guards;
	int set = g->hold[region];
	*end = set < 0 ? 0 : g->set[set + 1];
	return set < 0 ? 0 : g->set[set];
}

/* What holds a state in a region, over x; NULL: nothing */
static const double *holding(const struct unmet *u, int region, int state)
{
	int end, k = set_of(u, region, &end);
	while (k < end && u->guards->assignment[k].state != state)
		k++;
	return k < end ? u->guards->assignment[k].value : NULL;
}

/* Whether a region asks where an entry is after the step */
static bool reads(const struct unmet *u, int region, int entry)
{
	const struct guards *g = u->guards;
	int end;
	bool any = false;
	for (int k = set_of(u, region, &end); k < end; k++)
		any = any || g->assignment[k].value[entry] != 0;
	for (int k = g->first[region]; k < g->first[region + 1]; k++)
		any = any || g->row[g->guard[k].row * u->columns + entry] != 0;
	return any;
}

/* ---- a region ---- */

static void emit_end(const struct emitter *e, const struct unmet *u, int entry, const double *row,
		     const char *const *x)
{
	say(e, "        %send%d = %s;  /* %s */\n", entry < e->system->states ? "" : "const double ", entry,
	    dot_text(u->columns, row, x, 14), layout_names(&e->step->layout, e->system, e->model)[entry]);
}

/* What is held is put there from where all else is. */
static void emit_ends(const struct emitter *e, const struct unmet *u, int region)
{
	const double *Phi = u->pieces->piece[e->model->switching->region[region].system].Phi;
	int states = e->system->states;
	for (int i = 0; i < u->columns; i++)
		if (i < states ? !holding(u, region, i) : *u->end[i] && reads(u, region, i))
			emit_end(e, u, i, Phi + i * u->columns, u->x);
	for (int i = 0; i < states; i++)
		if (holding(u, region, i))
			emit_end(e, u, i, holding(u, region, i), u->end);
}

/* Text that is short stands where it is read, other in a local: once */
static const char *local_text(const struct emitter *e, struct unmet *u, const char *text, const char *name)
{
	if (!strchr(text, ' '))
		return text;
	for (int i = 0; i < u->locals; i++)
		if (strcmp(u->local[i].text, text) == 0)
			return u->local[i].name;
	name = format("%s%d", name, u->locals);
	say(e, "        const double %s = %s;\n", name, text);
	ENLARGE(u->local, (size_t)u->locals + 1);
	u->local[u->locals++] = (struct local){ text, name };
	return name;
}

static const char *both(const char *condition, const char *further)
{
	return *condition ? format("%s &&\n                %s", condition, further) : further;
}

/* That there is nothing to put back: an input, a load or a jump may have moved what is held */
static const char *held_text(const struct emitter *e, const struct unmet *u, int region)
{
	const char *condition = "";
	for (int i = 0; i < e->system->states; i++) {
		const double *value = holding(u, region, i);
		const char *place = value ? dot_text(u->columns, value, u->x, 14) : NULL;
		if (value)
			condition = both(condition, strcmp(place, "0.0") == 0
				? format("pl_magnitude(%s) <= 0.0", u->x[i])
				: format("pl_magnitude(%s - (%s)) <= 0.0", u->x[i], place));
	}
	return condition;
}

/* The first row with the same bound: but for what rounding may do to limits */
static int first_off(const struct unmet *u, int row)
{
	int first = 0;
	size_t bytes = (size_t)u->columns * sizeof(double);
	while (memcmp(u->guards->off + first * u->columns, u->guards->off + row * u->columns, bytes) != 0)
		first++;
	return first;
}

static double most_still(const struct unmet *u, int region, int row)
{
	const struct guards *g = u->guards;
	double most = 0;
	for (int k = g->first[region]; k < g->first[region + 1]; k++)
		if (first_off(u, g->guard[k].row) == first_off(u, row))
			most = fmax(most, g->still[k]);
	return most;
}

/* That a guard keeps below its limit; of a row that begins with a minus the opposite keeps above. */
static const char *guard_text(const struct emitter *e, struct unmet *u, int region, const struct guard *guard)
{
	const struct guards *g = u->guards;
	const double *row = g->row + guard->row * u->columns, *off = g->off + guard->row * u->columns;
	double *turned = ARRAY(double, (size_t)u->columns), still = most_still(u, region, guard->row);
	int first = 0;
	while (first < u->columns - 1 && row[first] == 0)
		first++;
	bool below = row[first] >= 0;
	for (int j = 0; j < u->columns; j++)
		turned[j] = below || row[j] == 0 ? row[j] : -row[j];
	const char *limit = shortest(below || guard->limit == 0 ? guard->limit : -guard->limit);
	const char *from = local_text(e, u, dot_text(u->columns, turned, u->x, 30), "from");
	const char *to = local_text(e, u, dot_text(u->columns, turned, u->end, 28), "to");
	const char *most = local_text(e, u, bound_text(u->columns, off, u->size, still, 29), "off");
	const char *farther = strcmp(from, to) == 0 ? from
			      : format("(%s %c %s ? %s : %s)", from, below ? '>' : '<', to, from, to);
	return format("%s %c %s %c %s", farther, below ? '+' : '-', most, below ? '<' : '>', limit);
}

/* Of a guard without an entry of x that moves: 1 below its limit, -1 not so, 0 of another */
static int constant_sign(const struct unmet *u, const struct guard *guard)
{
	const struct guards *g = u->guards;
	const double *row = g->row + guard->row * u->columns, *off = g->off + guard->row * u->columns;
	double most = g->still[guard - g->guard];
	for (int j = 0; j < u->columns; j++) {
		if (*u->x[j] && (row[j] != 0 || (off[j] != 0 && *u->size[j])))
			return 0;
		most += row[j];
	}
	return most < guard->limit ? 1 : -1;
}

static void emit_region(const struct emitter *e, struct unmet *u, int region)
{
	const struct guards *g = u->guards;
	say(e, "    case %d: {\n", region);
	u->locals = 0;
	emit_ends(e, u, region);
	const char *condition = held_text(e, u, region);
	for (int k = g->first[region]; k < g->first[region + 1]; k++)
		if (constant_sign(u, &g->guard[k]) == 0)
			condition = both(condition, guard_text(e, u, region, &g->guard[k]));
	say(e, "        clear = %s;\n"
	       "        break;\n"
	       "    }\n", *condition ? condition : "1");
}

/* What holds a state reads none that is held: else all of them are from the same x, and it is left to the search. So is
 * a region in which no step is clear. */
static bool is_plain(const struct emitter *e, const struct unmet *u, int region)
{
	const struct guards *g = u->guards;
	bool plain = e->model->switching->region[region].possible;
	for (int i = 0; i < e->system->states; i++)
		for (int j = 0; j < e->system->states && holding(u, region, i); j++)
			plain = plain && !(holding(u, region, j) && holding(u, region, i)[j] != 0);
	for (int k = g->first[region]; k < g->first[region + 1]; k++)
		plain = plain && constant_sign(u, &g->guard[k]) >= 0;
	return plain;
}

void emit_unmet_cases(const struct emitter *e, const struct pieces *p, const char *const *x, const char *const *size)
{
	const struct guards g = guards_of(e->step, p);
	const struct switching *s = e->model->switching;
	struct unmet u = { p, &g, e->step->layout.size, ARRAY(const char *, (size_t)e->step->layout.size),
			   entries(e, "end%d"), ARRAY(const char *, (size_t)e->step->layout.size), 0, NULL };
	for (int j = 0; j < u.columns; j++) {
		u.x[j] = x[j];
		u.size[j] = p->bounded[j] ? "" : size[j];
	}
	for (int r = 0; r < s->regions; r++)
		if (is_plain(e, &u, r))
			emit_region(e, &u, r);
}
