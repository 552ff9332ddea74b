/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions: a step that stays clear of every breakpoint, as sums with a bound for each expression. */
#include "emit/emit.h"

#include <string.h>

/* Of each entry of x, "" of 1; slopes of ramps in locals */
static const char **operands(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	const char **text = entries(e, "x[%d]");
	for (int i = 0; i < e->system->states; i++)
		text[i] = e->local[i];
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && layout->load[l] >= 0; k++)
			if (load_operand(e, l, k))
				text[layout->load[l] + k] = load_operand(e, l, k);
	for (int i = 0; i < e->system->inputs; i++) {
		bool ramp = e->system->input[i].hold;
		int of = place_of_input(e, i);
		text[layout->input[i]] = ramp ? sample_kept(e, of) : sample_now(e, of);
		if (ramp)
			text[layout->input[i] + 1] = format("part%d", of);
	}
	return text;
}

static bool is_read_at_end(const struct pieces *p, int size, int expressions, int entry)
{
	bool read = false;
	for (int i = 0; i < expressions; i++)
		read = read || p->row[i * size + entry] != 0;
	return read;
}

/* ---- by tables of all regions, or region by region ---- */

/* What a row's second words add, and its first ones of what rounding has taken */
static const char *small_text(const struct emitter *e, const struct region_tables *whole, int row,
			      const char *const *x, int indent)
{
	const char **rest = ARRAY(const char *, (size_t)whole->columns);
	for (int i = 0; i < e->system->states; i++)
		rest[i] = format("s->rest[%d]", place_of_state(e, i));
	const char *of_rest = row_text(whole, row, rest, NULL, indent + 1), *further = NULL;
	if (strcmp(of_rest, "0.0") != 0)
		further = format("(%s)", of_rest);
	return row_text(whole, e->step->layout.size + row, x, further, indent);
}

static void emit_end(const struct emitter *e, const struct region_tables *whole, int row, const char *const *x,
		     const char *before, const char *name)
{
	int indent = 24 + (int)strlen(before);
	if (!keeps_rest(e))
		say(e, "    %send%d = %s;  /* %s */\n", before, row, row_text(whole, row, x, NULL, 22), name);
	else if (row >= e->system->states)
		say(e, "    %send%d = %s + (%s);  /* %s */\n", before, row, *x[row] ? x[row] : "1.0",
		    row_text(whole, row, x, NULL, indent), name);
	else
		say(e, "    %send%d = pl_accumulate(%s,  /* %s */\n"
		       "%*s%s,\n"
		       "%*s%s, &rest%d);\n", before, row, x[row], name, indent, "",
		    row_text(whole, row, x, NULL, indent), indent, "", small_text(e, whole, row, x, indent), row);
}

static void emit_ends(const struct emitter *e, const struct pieces *p, const struct region_tables *whole,
		      const char *const *x, const char *before)
{
	int size = e->step->layout.size;
	const char **name = layout_names(&e->step->layout, e->system, e->model);
	for (int i = 0; i < size; i++)
		if (i < e->system->states || is_read_at_end(p, size, expressions_of(e), i))
			emit_end(e, whole, i, x, before, name[i]);
}

static const char **magnitudes(const struct emitter *e, const char *const *x)
{
	const char **text = ARRAY(const char *, (size_t)e->step->layout.size);
	for (int j = 0; j < e->step->layout.size; j++)
		text[j] = *x[j] ? format("pl_magnitude(%s)", x[j]) : "";
	return text;
}

/* Each expression at the start, at the end, and how far it may be off the chord between */
static void emit_chords(const struct emitter *e, const struct pieces *p, const char *const *x)
{
	const char **end = entries(e, "end%d");
	for (int i = 0; i < expressions_of(e); i++) {
		say(e, "    const double from%d = %s;\n", i, expression_text(e, p, i, x, 24));
		say(e, "    const double to%d = %s;\n", i, expression_text(e, p, i, end, 24));
		say(e, "    const double off%d = %s;\n", i, off_text(e, p, -1, i, magnitudes(e, x), 24));
	}
	say(e, "    if (");
	for (int i = 0; i < expressions_of(e); i++)
		say(e, "(from%d < to%d ? from%d : to%d) - off%d > $o_within[s->contact$p.region][%d][0] &&\n"
		       "        (from%d > to%d ? from%d : to%d) + off%d < $o_within[s->contact$p.region][%d][1] &&\n"
		       "        ", i, i, i, i, i, i, i, i, i, i, i, i);
}

static void emit_table_step(const struct emitter *e, const struct pieces *p, const char *const *x)
{
	struct region_tables whole = steps_of_regions(e, p, "factor");
	say(e, "    const int which = s->contact$p.matrix;\n"
	       "    const double (*const factor)[%d] = $o_%s[which];\n", e->step->layout.size,
	    any_pieces(e) ? "whole" : "pieces");
	emit_ends(e, p, &whole, x, "const double ");
	emit_chords(e, p, x);
}

/* Of an expression at the start and at the end: the state itself, or a local */
static const char *short_text(const char *text, const char *local, int expression)
{
	return strchr(text, ' ') ? format("%s%d", local, expression) : text;
}

/* An end of an interval, with what comes before it in the condition: beyond it is `than` */
static void emit_side(const struct emitter *e, bool first, const char *from, const char *to, int expression, bool upper,
		      double than)
{
	say(e, "%s(%s %c %s ? %s : %s) %c off%d %c %s", first ? "" : " &&\n                ", from,
	    upper ? '>' : '<', to, from, to, upper ? '+' : '-', expression, upper ? '<' : '>', shortest(than));
}

/* Whether all expressions keep inside their intervals */
static void emit_inside(const struct emitter *e, const struct pieces *p, const char *const *x, int region)
{
	const struct switching *s = e->model->switching;
	const char **end = entries(e, "end%d");
	bool first = true;
	say(e, "        clear = ");
	for (int i = 0; i < s->expressions; i++) {
		const char *from = short_text(expression_text(e, p, i, x, 0), "from", i),
			   *to = short_text(expression_text(e, p, i, end, 0), "to", i);
		int interval = interval_of(s, region, i), at = region * s->expressions + i;
		if (interval > 0) {
			emit_side(e, first, from, to, i, false, p->low[at]);
			first = false;
		}
		if (interval < s->expression[i].breaks) {
			emit_side(e, first, from, to, i, true, p->high[at]);
			first = false;
		}
	}
	say(e, ";\n"
	       "        break;\n");
}

static void emit_region_case(const struct emitter *e, const struct pieces *p, const char *const *x, int region)
{
	int branch = e->model->switching->region[region].system, n = expressions_of(e);
	struct region_tables whole = of_branch(steps_of_regions(e, p, ""), branch);
	const char **end = entries(e, "end%d");
	say(e, "    case %d:\n", region);
	emit_ends(e, p, &whole, x, "    ");
	for (int i = 0; i < n; i++) {
		const char *from = expression_text(e, p, i, x, 15), *to = expression_text(e, p, i, end, 15);
		if (strchr(from, ' '))
			say(e, "        from%d = %s;\n", i, from);
		if (strchr(to, ' '))
			say(e, "        to%d = %s;\n", i, to);
		say(e, "        off%d = %s;\n", i, off_text(e, p, branch, i, magnitudes(e, x), 15));
	}
	emit_inside(e, p, x, region);
}

/* ends, and how far expressions may be off their chords: in each region its own numbers */
static void emit_cases(const struct emitter *e, const struct pieces *p, const char *const *x)
{
	const struct switching *s = e->model->switching;
	int size = e->step->layout.size;
	const char *list = "";
	for (int i = 0; i < size; i++)
		if (i < e->system->states || is_read_at_end(p, size, s->expressions, i))
			list = format("%s%send%d = 0.0", list, *list ? ", " : "", i);
	const char **end = entries(e, "end%d");
	for (int i = 0; i < s->expressions; i++) {
		list = format("%s, off%d", list, i);
		if (strchr(expression_text(e, p, i, x, 0), ' '))
			list = format("%s, from%d", list, i);
		if (strchr(expression_text(e, p, i, end, 0), ' '))
			list = format("%s, to%d", list, i);
	}
	say(e, "    double %s;\n"
	       "    int clear = 0;\n"
	       "    switch (s->contact$p.region) {\n", list);
	for (int r = 0; r < s->regions; r++)
		if (s->region[r].possible)
			emit_region_case(e, p, x, r);
	say(e, "    default:\n"
	       "        break;\n"
	       "    }\n"
	       "    if (clear && ");
}

void emit_clear_step(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	const struct layout *layout = &e->step->layout;
	const char **x = operands(e);
	for (int i = 0; i < e->system->inputs; i++) {
		int of = place_of_input(e, i);
		if (e->system->input[i].hold)
			say(e, "    const double part%d = (u[%d] - s->u[%d]) / $N_H;  /* its slope */\n", of, of, of);
	}
	for (int i = 0; i < e->system->states && keeps_rest(e); i++)
		say(e, "    double rest%d = s->rest[%d];\n", i, place_of_state(e, i));
	if (is_cleared_by_tables(e->step))
		emit_table_step(e, &pieces, x);
	else
		emit_cases(e, &pieces, x);
	say(e, "%s < %s) {\n", size_of_x(e, &pieces, magnitudes(e, x), 12), shortest(pieces.large));
	for (int i = 0; i < e->system->states; i++)
		say(e, "        s->y[%d] = end%d;\n", place_of_state(e, i), i);
	for (int i = 0; i < e->system->states && keeps_rest(e); i++)
		say(e, "        s->rest[%d] = rest%d;\n", place_of_state(e, i), i);
	say(e, "        s->contact$p.crossings = 0;\n"
	       "    } else {\n"
	       "        double now[%d];\n", size_of_vector(e));
	for (int j = 0; j < layout->size; j++)
		say(e, "        now[%d] = %s;\n", j, *x[j] ? x[j] : "1.0");
	for (int j = 0; j < layout->size && keeps_rest(e); j++)
		say(e, "        now[%d] = %s;\n", layout->size + j,
		    j < e->system->states ? format("s->rest[%d]", place_of_state(e, j)) : "0.0");
	say(e, "        if (!$o_cross(s, now))\n"
	       "            $o_seek(s, now);\n"
	       "    }\n");
}
