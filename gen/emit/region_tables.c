/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of regions: tables that there is one of for each matrix, and sums over their rows as text. */
#include "emit/emit.h"

int expressions_of(const struct emitter *e)
{
	return e->model->switching->expressions;
}

/* ---- what stands at an entry of tables that there are one of for each matrix ---- */

bool acts_at(const struct region_tables *t, int row, int column)
{
	bool any = t->own && t->own[row * t->columns + column];
	for (int k = t->from; k < t->to; k++)
		any = any || t->value[k][row * t->columns + column] != 0;
	return any;
}

bool agree_at(const struct region_tables *t, int row, int column)
{
	int at = row * t->columns + column;
	bool same = !t->own || !t->own[at];
	for (int k = t->from; k < t->to; k++)
		same = same && t->value[k][at] == t->value[t->from][at];
	return same;
}

/* A number where all agree */
static const char *entry_times(const struct region_tables *t, int row, int column, const char *operand)
{
	if (agree_at(t, row, column))
		return scaled(t->value[t->from][row * t->columns + column], operand);
	const char *text = format("%s[%d][%d]", t->text, row, column);
	return operand ? format("%s * %s", text, operand) : text;
}

const char *row_text(const struct region_tables *t, int row, const char *const *operand,
			    const char *further, int indent)
{
	const char **term = ARRAY(const char *, (size_t)t->columns + 1);
	int terms = 0;
	for (int j = 0; j < t->columns; j++)
		if (operand[j] && acts_at(t, row, j))
			term[terms++] = entry_times(t, row, j, *operand[j] ? operand[j] : NULL);
	if (further)
		term[terms++] = further;
	return terms ? tree(terms, term, indent) : "0.0";
}

struct region_tables tables_of_regions(const struct emitter *e, const struct pieces *p, const char *text, int rows,
				      double *(*of)(const struct region_piece *))
{
	struct region_tables t = { text, rows, e->step->layout.size, 0, e->step->branches,
			    ARRAY(double *, (size_t)e->step->branches), NULL };
	for (int k = 0; k < e->step->branches; k++)
		t.value[k] = of(&p->piece[k]);
	return t;
}

static double *whole_of(const struct region_piece *piece)  { return piece->Phi; }
static double *gain_over_h(const struct region_piece *piece)   { return piece->gain; }
double *off_of(const struct region_piece *piece)    { return piece->off; }
static double *still_of(const struct region_piece *piece)  { return piece->still; }
static double *slack_of(const struct region_piece *piece)  { return piece->slack; }
static double *turn_of(const struct region_piece *piece)   { return piece->turn; }
static double *third_of(const struct region_piece *piece)  { return piece->third; }
static double *bend_of(const struct region_piece *piece)   { return piece->bend; }

struct region_tables steps_of_regions(const struct emitter *e, const struct pieces *p, const char *text)
{
	int size = e->step->layout.size;
	return keeps_rest(e) ? tables_of_regions(e, p, text, 2 * size, gain_over_h)
			     : tables_of_regions(e, p, text, size, whole_of);
}

bool is_table(const struct region_tables *t)
{
	bool differs = false;
	for (int i = 0; i < t->rows; i++)
		for (int j = 0; j < t->columns; j++)
			differs = differs || !agree_at(t, i, j);
	return differs;
}

struct region_tables of_branch(struct region_tables t, int branch)
{
	t.from = branch;
	t.to = branch + 1;
	return t;
}

const char *off_text(const struct emitter *e, const struct pieces *p, int branch, int expression,
			    const char *const *size, int indent)
{
	int n = expressions_of(e);
	struct region_tables off = tables_of_regions(e, p, spell(e, "$o_chord_off[which]"), n, off_of),
		      still = tables_of_regions(e, p, spell(e, "$o_still[which]"), 1, still_of);
	still.columns = n;
	if (branch >= 0) {
		off = of_branch(off, branch);
		still = of_branch(still, branch);
	}
	const char *further = NULL;
	if (acts_at(&still, 0, expression))
		further = agree_at(&still, 0, expression) ? shortest(still.value[still.from][expression])
							  : spell(e, "$o_still[which][%d]", expression);
	return row_text(&off, expression, size, further, indent);
}

/* ---- tables ---- */

static void emit_of_each(const struct emitter *e, const struct region_tables *t, const char *name, const char *note,
			 const char *const *row_name)
{
	say(e, "\n"
	       "static const double $o_%s[%d][%d][%d] = {  /* %s */\n",
	    name, e->step->branches, t->rows, t->columns, note);
	for (int k = 0; k < e->step->branches; k++) {
		say(e, "  {\n");
		emit_number_rows(e, t->rows, t->columns, t->value[k], row_name);
		say(e, "  },\n");
	}
	say(e, "};\n");
}

bool any_pieces(const struct emitter *e)
{
	bool any = false;
	for (int k = 0; k < e->step->branches; k++)
		any = any || e->step->branch[k].halvings > 0;
	return any;
}

static void emit_still(const struct emitter *e, const struct pieces *p)
{
	int expressions = expressions_of(e);
	say(e, "\n"
	       "static const double $o_still[%d][%d] = {  /* what 1, cos and sin add to that, at most */\n",
	    e->step->branches, expressions);
	for (int k = 0; k < e->step->branches; k++)
		for (int i = 0; i < expressions; i++)
			say(e, "%s%s%s", i == 0 ? "    {" : ", ", shortest(p->piece[k].still[i]),
			    i == expressions - 1 ? "},\n" : "");
	say(e, "};\n");
}

void emit_spans(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	int n = s->expressions;
	say(e, "\n"
	       "static const int $o_span[%d][%d] = {  /* of each expression, from the lowest one */\n",
	    s->regions, n);
	for (int r = 0; r < s->regions; r++)
		for (int i = 0; i < n; i++)
			say(e, "%s%d%s", i == 0 ? "    {" : ", ", interval_of(s, r, i), i == n - 1 ? "},\n" : "");
	say(e, "};\n");
}

/* Region by region: what each expression is between, and the regions below and above; -1: none that can occur */
static void emit_neighbours(const struct emitter *e, const struct pieces *p)
{
	const struct switching *s = e->model->switching;
	int n = s->expressions;
	say(e, "\n"
	       "static const double $o_within[%d][%d][2] = {  /* what each expression is between in each region */\n",
	    s->regions, n);
	for (int r = 0; r < s->regions; r++)
		for (int i = 0; i < n; i++)
			say(e, "%s{%s, %s}%s", i == 0 ? "    {" : ", ", shortest(p->low[r * n + i]),
			    shortest(p->high[r * n + i]), i == n - 1 ? "},\n" : "");
	say(e, "};\n"
	       "\n"
	       "static const int $o_beyond[%d][%d][2] = {  /* regions below and above; -1: none that can occur */\n",
	    s->regions, n);
	for (int r = 0; r < s->regions; r++)
		for (int i = 0; i < n; i++) {
			int interval = interval_of(s, r, i), stride = s->expression[i].stride;
			bool below = interval > 0 && s->region[r - stride].possible,
			     above = interval < s->expression[i].breaks && s->region[r + stride].possible;
			say(e, "%s{%d, %d}%s", i == 0 ? "    {" : ", ", below ? r - stride : -1,
			    above ? r + stride : -1, i == n - 1 ? "},\n" : "");
		}
	say(e, "};\n");
	emit_spans(e);
}

void emit_swift_tables(const struct emitter *e, const struct pieces *p, const char *const *expression)
{
	int n = expressions_of(e);
	struct region_tables off = tables_of_regions(e, p, "", n, off_of),
			     slack = tables_of_regions(e, p, "", n, slack_of),
			     third = tables_of_regions(e, p, "", n, third_of),
		      still = tables_of_regions(e, p, "", 1, still_of);
	still.columns = n;
	if (any_pieces(e)) {
		struct region_tables turn = tables_of_regions(e, p, "", n, turn_of),
			      bend = tables_of_regions(e, p, "", n, bend_of);
		emit_of_each(e, &turn, "whole_lean", "lean over h", expression);
		emit_of_each(e, &bend, "whole_sway", "sway over h", expression);
	}
	bool reads = any_pieces(e) || is_cleared_by_tables(e->step);    /* what they are off their chords */
	if (reads && is_table(&off))
		emit_of_each(e, &off, "chord_off",
			     "times |x|: how far each expression is off its chord over h, at most", expression);
	if (reads && is_table(&still))
		emit_still(e, p);
	emit_of_each(e, &slack, "slack", "times |x|: what rounding may do to an expression and to h e'", expression);
	emit_of_each(e, &third, "jerk", "times |x|: h^3/24 e''', at most", expression);
	emit_neighbours(e, p);
}

/* ---- sums as text ---- */

const char **places(const struct emitter *e, const char *layout)
{
	const char **text = ARRAY(const char *, (size_t)e->step->layout.size);
	for (int j = 0; j < e->step->layout.size; j++)
		text[j] = format(layout, j);
	return text;
}

const char **entries(const struct emitter *e, const char *layout)
{
	const char **text = places(e, layout);
	for (int l = 0; l < e->system->loads; l++)
		if (e->step->layout.load[l] >= 0 && !load_operand(e, l, 0))
			text[e->step->layout.load[l]] = "";
	return text;
}

const char *expression_text(const struct emitter *e, const struct pieces *p, int expression,
				   const char *const *operand, int indent)
{
	int size = e->step->layout.size, terms = 0;
	const char **term = ARRAY(const char *, (size_t)size);
	for (int j = 0; j < size; j++) {
		double factor = p->row[expression * size + j];
		if (factor != 0)
			term[terms++] = scaled(factor, *operand[j] ? operand[j] : NULL);
	}
	return terms ? tree(terms, term, indent) : "0.0";
}

const char *size_of_x(const struct emitter *e, const struct pieces *p, const char *const *size, int indent)
{
	const char **term = ARRAY(const char *, (size_t)e->step->layout.size);
	int terms = 0;
	for (int j = 0; j < e->step->layout.size; j++)
		if (!p->bounded[j] && *size[j])         /* 1 counts for nothing */
			term[terms++] = size[j];
	return tree(terms, term, indent);
}

bool keeps_rest(const struct emitter *e)
{
	return e->step->program->compensated;
}

int size_of_vector(const struct emitter *e)
{
	return e->step->layout.size * (keeps_rest(e) ? 2 : 1);
}

void emit_state_of_x(const struct emitter *e)
{
	bool rest = keeps_rest(e);
	say(e, "    for (i = 0; i < %s; i++)%s\n"
	       "        s->y[%s] = x[i];\n", own_states(e), rest ? " {" : "", place_in_loop(e));
	if (rest)
		say(e, "        s->rest[%s] = x[%d + i];\n"
		       "    }\n", place_in_loop(e), e->step->layout.size);
}

const char **listed_twice(int count, const char *const *text)
{
	const char **both = ARRAY(const char *, 2 * (size_t)count);
	for (int i = 0; i < 2 * count; i++)
		both[i] = text[i % count];
	return both;
}

void open_table(const struct emitter *e, const char *name, const char *shape, const char *note)
{
	if (e->model->retuned)
		say(e, "    {  /* %s: %s */\n", name, note);
	else
		say(e, "\n"
		       "static const double $o_%s%s = {  /* %s */\n", name, shape, note);
}

void close_table(const struct emitter *e)
{
	say(e, e->model->retuned ? "    },\n" : "};\n");
}

const char *prefix_of_tables(const struct emitter *e)
{
	return e->model->retuned ? "c->" : spell(e, "$o_");
}

bool regions_change(const struct emitter *e)
{
	return e->model->switching->segments > 1;
}
