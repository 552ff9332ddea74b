/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions: a step that stays clear of every breakpoint as sums with a bound for each expression, and a crossing that is
 * the only one of a step by the Taylor polynomials of the entries of x. All else is left to the runtime's search. */
#include "emit/emit.h"

#include <string.h>

static int expressions_of(const struct emitter *e)
{
	return e->model->switching->expressions;
}

/* ---- what stands at an entry of tables that there are one of for each matrix ---- */

struct tables {
	const char *text;           /* of one of them: [row][column] follows */
	int rows, columns;
	int from, to;               /* of branches from .. to - 1 */
	double **value;             /* per branch */
};

static bool acts_at(const struct tables *t, int row, int column)
{
	bool any = false;
	for (int k = t->from; k < t->to; k++)
		any = any || t->value[k][row * t->columns + column] != 0;
	return any;
}

static bool agree_at(const struct tables *t, int row, int column)
{
	int at = row * t->columns + column;
	bool same = true;
	for (int k = t->from; k < t->to; k++)
		same = same && t->value[k][at] == t->value[t->from][at];
	return same;
}

/* A number where all agree */
static const char *entry_times(const struct tables *t, int row, int column, const char *operand)
{
	if (agree_at(t, row, column))
		return scaled(t->value[t->from][row * t->columns + column], operand);
	const char *text = format("%s[%d][%d]", t->text, row, column);
	return operand ? format("%s * %s", text, operand) : text;
}

/* Sum of a row over the operands of its columns; further: a term more, or NULL */
static const char *row_text(const struct tables *t, int row, const char *const *operand,
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

static struct tables tables_of_pieces(const struct emitter *e, const struct pieces *p, const char *text, int rows,
				      double *(*of)(const struct region_piece *))
{
	struct tables t = { text, rows, e->step->layout.size, 0, e->step->branches,
			    ARRAY(double *, (size_t)e->step->branches) };
	for (int k = 0; k < e->step->branches; k++)
		t.value[k] = of(&p->piece[k]);
	return t;
}

static double *whole_of(const struct region_piece *piece)  { return piece->whole; }
static double *off_of(const struct region_piece *piece)    { return piece->off; }
static double *still_of(const struct region_piece *piece)  { return piece->still; }
static double *slack_of(const struct region_piece *piece)  { return piece->slack; }
static double *turn_of(const struct region_piece *piece)   { return piece->turn; }
static double *bend_of(const struct region_piece *piece)   { return piece->bend; }
static double *turns_of(const struct region_piece *piece)  { return piece->turns; }

/* Else all its entries are numbers in the text */
static bool is_table(const struct tables *t)
{
	bool differs = false;
	for (int i = 0; i < t->rows; i++)
		for (int j = 0; j < t->columns; j++)
			differs = differs || !agree_at(t, i, j);
	return differs;
}

static struct tables of_branch(struct tables t, int branch)
{
	t.from = branch;
	t.to = branch + 1;
	return t;
}

/* The largest that an expression may be off its chord: `size` of the entries of x that are not bounded.  branch -1: of
 * all */
static const char *off_text(const struct emitter *e, const struct pieces *p, int branch, int expression,
			    const char *const *size, int indent)
{
	int n = expressions_of(e);
	struct tables off = tables_of_pieces(e, p, spell(e, "$o_chord_off[which]"), n, off_of),
		      still = tables_of_pieces(e, p, spell(e, "$o_still[which]"), 1, still_of);
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

static void emit_of_each(const struct emitter *e, const struct tables *t, const char *name, const char *note,
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

static bool any_pieces(const struct emitter *e)
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
	say(e, "};\n"
	       "\n"
	       "static const int $o_stride[] = {");
	for (int i = 0; i < n; i++)
		say(e, "%s%d", i ? ", " : "", s->expression[i].stride);
	say(e, "};\n");
}

void emit_swift_tables(const struct emitter *e, const struct pieces *p, const char *const *expression)
{
	int n = expressions_of(e);
	struct tables whole = tables_of_pieces(e, p, "", e->step->layout.size, whole_of),
		      off = tables_of_pieces(e, p, "", n, off_of), slack = tables_of_pieces(e, p, "", n, slack_of),
		      still = tables_of_pieces(e, p, "", 1, still_of);
	still.columns = n;
	if (any_pieces(e)) {
		struct tables turn = tables_of_pieces(e, p, "", n, turn_of),
			      bend = tables_of_pieces(e, p, "", n, bend_of);
		emit_of_each(e, &whole, "whole", "e^{A h}",
			     layout_names(&e->step->layout, e->system, e->model));
		emit_of_each(e, &turn, "whole_lean", "lean over h", expression);
		emit_of_each(e, &bend, "whole_sway", "sway over h", expression);
	}
	if (is_table(&off))
		emit_of_each(e, &off, "chord_off",
			     "times |x|: how far each expression is off its chord over h, at most", expression);
	if (is_table(&still))
		emit_still(e, p);
	emit_of_each(e, &slack, "slack", "times |x|: what h e' is off the slope of its polynomial, at most",
		     expression);
	emit_neighbours(e, p);
}

/* ---- one crossing ---- */

static const char **places(const struct emitter *e, const char *layout)
{
	const char **text = ARRAY(const char *, (size_t)e->step->layout.size);
	for (int j = 0; j < e->step->layout.size; j++)
		text[j] = format(layout, j);
	return text;
}

/* "" where x is 1 */
static const char **entries(const struct emitter *e, const char *layout)
{
	const char **text = places(e, layout);
	for (int l = 0; l < e->system->loads; l++)
		if (e->step->layout.load[l] >= 0 && !load_operand(e, l, 0))
			text[e->step->layout.load[l]] = "";
	return text;
}

static const char *expression_text(const struct emitter *e, const struct pieces *p, int expression,
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

static void emit_expression(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, n = expressions_of(e);
	say(e, "\n"
	       "static double $o_expression(int i, const double x[%d])\n"
	       "{\n", size);
	if (n == 1) {
		say(e, "    (void)i;\n"
		       "    return %s;\n", expression_text(e, p, 0, places(e, "x[%d]"), 11));
	} else {
		struct tables rows = { spell(e, "$o_row"), n, size, 0, 0, NULL };
		const char **term = ARRAY(const char *, (size_t)size);
		int terms = 0;
		for (int j = 0; j < size; j++) {
			bool any = false;
			for (int i = 0; i < n; i++)
				any = any || p->row[i * size + j] != 0;
			if (any)
				term[terms++] = format("%s[i][%d] * x[%d]", rows.text, j, j);
		}
		say(e, "    return %s;\n", terms ? tree(terms, term, 11) : "0.0");
	}
	say(e, "}\n");
}

/* Entries of h A that differ from matrix to matrix: locals, and their text */
static void emit_turns(const struct emitter *e, const struct tables *t)
{
	for (int i = 0; i < t->rows; i++)
		for (int j = 0; j < t->columns; j++)
			if (acts_at(t, i, j) && !agree_at(t, i, j))
				say(e, "    const double h%d_%d = $N_H * $o_slopes[which][%d][%d];\n", i, j, i, j);
}

static const char *turn_times(const struct tables *t, int i, int j)
{
	const char *a = format("a%d", j);
	return agree_at(t, i, j) ? scaled(t->value[0][i * t->columns + j], a) : format("h%d_%d * %s", i, j, a);
}

/* Velocities are added last: positions and loads are there before them, so that a chain has one product and one sum an
 * order. */
static const char *turned_row(const struct emitter *e, const struct tables *t, int row)
{
	const char **early = ARRAY(const char *, (size_t)t->columns), **late = ARRAY(const char *, (size_t)t->columns);
	int earlies = 0, lates = 0;
	for (int j = 0; j < t->columns; j++) {
		if (!acts_at(t, row, j))
			continue;
		bool velocity = j >= e->system->n && j < e->system->states;
		if (velocity)
			late[lates++] = turn_times(t, row, j);
		else
			early[earlies++] = turn_times(t, row, j);
	}
	if (earlies && lates)
		return format("(%s)\n%26s+ (%s)", tree(earlies, early, 26), "", tree(lates, late, 28));
	return earlies ? tree(earlies, early, 25) : lates ? tree(lates, late, 25) : "0.0";
}

static void emit_weights(const struct emitter *e, const struct pieces *p)
{
	int terms = p->degree + 1;
	say(e, "\n"
	       "static const double $d_weight[%d] = {  /* 1/k! */\n"
	       "    1.0", terms);
	for (int k = 1; k < terms; k++)
		say(e, "%s%s", k % 4 ? ", " : ",\n    ", shortest(p->weight[k]));
	say(e, "\n"
	       "};\n"
	       "static const double $d_orders[%d] = {", terms);
	for (int k = 0; k < terms; k++)
		say(e, "%s%d.0", k ? ", " : "", k);
	say(e, "};\n");
}

static void emit_expand(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, terms = p->degree + 1;
	struct tables turns = tables_of_pieces(e, p, "", size, turns_of);
	say(e, "\n"
	       "/* The coefficients of x(s) = e^{A h s} x: its derivatives, times 1/k! */\n"
	       "static void $o_expand(int which, const double x[%d], double c[%d][%d])\n"
	       "{\n", size, terms, size);
	emit_turns(e, &turns);
	for (int j = 0; j < size; j++)
		say(e, "%sa%d = x[%d]%s", j ? ", " : "    double ", j, j, j == size - 1 ? ";\n" : "");
	say(e, "    int k;\n");
	for (int j = 0; j < size; j++)
		say(e, "    c[0][%d] = a%d;\n", j, j);
	say(e, "    for (k = 1; k < %d; k++) {\n"
	       "        const double weight = $d_weight[k];\n", terms);
	for (int i = 0; i < size; i++)
		say(e, "        const double b%d = %s;\n", i, turned_row(e, &turns, i));
	for (int i = 0; i < size; i++)
		say(e, "        a%d = b%d;\n"
		       "        c[k][%d] = weight * b%d;\n", i, i, i, i);
	say(e, "    }\n"
	       "    (void)which;\n"
	       "}\n");
}

/* x(s): of `count` of its entries */
static void emit_polynomial(const struct emitter *e, const struct pieces *p, const char *name, int count)
{
	int size = e->step->layout.size, terms = p->degree + 1;
	say(e, "\n"
	       "/* x(s)%s */\n"
	       "static void $o_%s(double c[%d][%d], double s, double x[%d])\n"
	       "{\n"
	       "    const double ss = s * s;\n", count < size ? ", the states" : "", name, terms, size, size);
	for (int i = 0; i < count; i++)
		say(e, "    double even%d = c[%d][%d], odd%d = c[%d][%d];\n", i, terms - 2, i, i, terms - 1, i);
	say(e, "    int k;\n"
	       "    for (k = %d; k >= 0; k -= 2) {\n", terms - 4);
	for (int i = 0; i < count; i++)
		say(e, "        even%d = even%d * ss + c[k][%d];\n"
		       "        odd%d = odd%d * ss + c[k + 1][%d];\n", i, i, i, i, i, i);
	say(e, "    }\n");
	for (int i = 0; i < count; i++)
		say(e, "    x[%d] = even%d + s * odd%d;\n", i, i, i);
	say(e, "}\n");
}

/* sum of |g[k + 2]| r^k, of k + 2 times that for `slopes`; lines of a function */
static void emit_sizes(const struct emitter *e, int terms, const char *sum, const char *r, bool slopes)
{
	const char *factor = slopes ? spell(e, "$d_orders[k + 2] * ") : "",
		   *next = slopes ? spell(e, "$d_orders[k + 3] * ") : "";
	say(e, "    for (k = %d; k >= 0; k -= 2) {\n"
	       "        even = even * (%s * %s) + %spl_magnitude(g[k + 2]);\n"
	       "        odd = odd * (%s * %s) + %spl_magnitude(g[k + 3]);\n"
	       "    }\n"
	       "    %s = even + %s * odd;\n",
	    terms - 4, r, r, factor, r, r, next, sum, r);
}

static void emit_root(const struct emitter *e, const struct pieces *p)
{
	int terms = p->degree + 1;
	say(e, "\n"
	       "/* Where g rises through 0 for 0 < s < 1 first; 2: that is not certain.  Up to `most` its slope "
	       "is above `least`\n"
	       " * by the sizes of its other coefficients, and |g''| below `bend`: there is one root.  Two steps "
	       "of Newton's\n"
	       " * method from the series of the inverse.  slack: what g' may be off by; g > 0 at 1 is known. */\n"
	       "static double $d_root(const double g[%d], double slack)\n"
	       "{\n"
	       "    const double q = g[2] / g[1], w = -g[0] / g[1];\n"
	       "    const double guess = w * (1.0 - q * w * (1.0 - 2.0 * q * w)), most = guess < 0.99 ? guess + "
	       "0.01 : 1.0;\n"
	       "    double z = guess, last = guess, miss = 0.0, even = 0.0, odd = 0.0, least, bend = 0.0;\n"
	       "    int i, k;\n", terms);
	emit_sizes(e, terms, "least", "most", true);
	say(e, "    least = g[1] - slack - most * least;\n"
	       "    for (k = 2; k < %d; k++)\n"
	       "        bend += $d_orders[k] * $d_orders[k - 1] * pl_magnitude(g[k]);\n"
	       "    for (i = 0; i < 2; i++) {\n"
	       "        const double zz = z * z;\n"
	       "        double even_slope = %d.0 * g[%d], odd_slope = 0.0;\n"
	       "        even = g[%d];\n"
	       "        odd = g[%d];\n"
	       "        for (k = %d; k >= 0; k -= 2) {\n"
	       "            even = even * zz + g[k];\n"
	       "            odd = odd * zz + g[k + 1];\n"
	       "            even_slope = even_slope * zz + $d_orders[k + 1] * g[k + 1];\n"
	       "            odd_slope = odd_slope * zz + $d_orders[k + 2] * g[k + 2];\n"
	       "        }\n"
	       "        miss = even + z * odd;\n"
	       "        last = z;\n"
	       "        z -= miss / (even_slope + z * odd_slope);\n"
	       "    }\n",
	    terms, terms - 1, terms - 1, terms - 2, terms - 1, terms - 4);
	say(e, "    if (!(least > 0.0 && last > 0.0 && last <= most && z > 0.0 && z < 1.0))\n"
	       "        return 2.0;\n"
	       "    if (most < 1.0 && !(least * (most - last) > -miss))\n"
	       "        return 2.0;\n"
	       "    /* the root is within |miss|/least of the last but one, and z within bend/(2 least) times "
	       "that squared */\n"
	       "    return bend * (miss * miss) < least * least * least * 2.220446049250313e-16 ? z : 2.0;\n"
	       "}\n");
}

/* off[i], from x */
static void emit_bounds(const struct emitter *e, const struct pieces *p)
{
	int n = expressions_of(e);
	const char **size = entries(e, "pl_magnitude(x[%d])");
	say(e, "\n"
	       "/* How far each expression is off its chord over h or less, at most */\n"
	       "static void $o_bounds(int which, const double x[%d], double off[%d])\n"
	       "{\n", e->step->layout.size, n);
	for (int i = 0; i < n; i++)
		say(e, "    off[%d] = %s;\n", i, off_text(e, p, -1, i, size, 13));
	say(e, "    (void)which;\n"
	       "    (void)x;\n"
	       "}\n"
	       "\n"
	       "static int $o_stays(int region, int i, double from, double to, double off)\n"
	       "{\n"
	       "    return (from < to ? from : to) - off > $o_within[region][i][0] &&\n"
	       "           (from > to ? from : to) + off < $o_within[region][i][1];\n"
	       "}\n");
}

/* Into end[]: Phi x over h */
static void emit_whole(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size;
	struct tables whole = tables_of_pieces(e, p, "factor", size, whole_of);
	const char **x = entries(e, "x[%d]");
	say(e, "\n"
	       "/* e^{A h} x */\n"
	       "static void $o_advance(int which, const double x[%d], double end[%d])\n"
	       "{\n"
	       "    const double (*const factor)[%d] = $o_%s[which];\n",
	    size, size, size, any_pieces(e) ? "whole" : "pieces");
	for (int i = 0; i < size; i++)
		say(e, "    end[%d] = %s;\n", i, row_text(&whole, i, x, NULL, 13));
	say(e, "    (void)factor;\n"
	       "}\n");
}

static const char *size_of_x(const struct emitter *e, const struct pieces *p, const char *const *size, int indent)
{
	const char **term = ARRAY(const char *, (size_t)e->step->layout.size);
	int terms = 0;
	for (int j = 0; j < e->step->layout.size; j++)
		if (!p->bounded[j] && *size[j])         /* 1 counts for nothing */
			term[terms++] = size[j];
	return tree(terms, term, indent);
}

/* Which expressions are not seen to be clear */
static void emit_near(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, n = expressions_of(e);
	const char *whole = any_pieces(e) ? "whole_" : "";
	say(e, "\n"
	       "/* How many expressions are not seen to be clear over h, from x to end; the last of them.  By "
	       "chords, then by\n"
	       " * cubics, which lie within their Bezier points */\n"
	       "static int $o_near(int region, int which, const double x[%d], const double end[%d], int *last)\n"
	       "{\n"
	       "    double off[%d];\n"
	       "    int i, j, near = 0;\n"
	       "    $o_bounds(which, x, off);\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        const double from = $o_expression(i, x), to = $o_expression(i, end);\n"
	       "        double leaving = from, arriving = to, sway = 0.0;\n"
	       "        if ($o_stays(region, i, from, to, off[i]))\n"
	       "            continue;\n",
	    size, size, n, n);
	say(e, "        for (j = 0; j < %d; j++) {\n"
	       "            leaving += $o_%slean[which][i][j] * x[j];\n"
	       "            arriving -= $o_%slean[which][i][j] * end[j];\n"
	       "            sway += $o_%ssway[which][i][j] * pl_magnitude(x[j]);\n"
	       "        }\n"
	       "        if ($o_stays(region, i, from, to, sway) && $o_stays(region, i, leaving, arriving, sway))\n"
	       "            continue;\n"
	       "        *last = i;\n"
	       "        near++;\n"
	       "    }\n"
	       "    return near;\n"
	       "}\n",
	    size, whole, whole, whole);
	(void)p;
}

/* Where one expression leaves its interval */
static void emit_leaves(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, terms = p->degree + 1;
	say(e, "\n"
	       "/* Where expression i, which is `to` after h, first passes the upper or the lower end of its "
	       "interval; 2: that is\n"
	       " * not certain.  c: the coefficients of x(s) */\n"
	       "static double $o_leaves(int region, int which, int i, int up, const double x[%d], double "
	       "c[%d][%d], double to)\n"
	       "{\n"
	       "    const double sign = up ? 1.0 : -1.0, b = $o_within[region][i][up], from = $o_expression(i, x);\n"
	       "    double g[%d], noise = pl_magnitude(b), slack = 0.0;\n"
	       "    int k;\n"
	       "    if ($o_beyond[region][i][up] < 0 ||\n"
	       "        !(up ? from > $o_within[region][i][0] : from < $o_within[region][i][1]))\n"
	       "        return 2.0;\n"
	       "    g[0] = sign * (from - b);\n"
	       "    for (k = 1; k < %d; k++) {\n"
	       "        g[k] = sign * $o_expression(i, c[k]);\n"
	       "        noise += pl_magnitude(g[k]);\n"
	       "    }\n",
	    size, terms, size, terms, terms);
	say(e, "    for (k = 0; k < %d; k++) {\n"
	       "        slack += $o_slack[which][i][k] * pl_magnitude(x[k]);\n"
	       "        noise += pl_magnitude($o_row[i][k] * x[k]);\n"
	       "    }\n"
	       "    noise *= 1.7763568394002505e-15;  /* 8 DBL_EPSILON, as in the search */\n"
	       "    return g[0] < -noise && sign * (to - b) > noise && g[1] > 0.0 ? $d_root(g, slack) : 2.0;\n"
	       "}\n", size);
}

/* Behind a crossing */
static void emit_moves_on(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, terms = p->degree + 1, n = expressions_of(e);
	say(e, "\n"
	       "/* Whether it is certain that nothing is passed from x on over h times `rest`: not what was "
	       "passed just now, since\n"
	       " * (e - b)/s stays beside 0, and nothing else.  c: the coefficients of x(s) */\n"
	       "static int $o_moves_on(int region, int which, int passed, int up, const double x[%d], double "
	       "c[%d][%d],\n"
	       "                       double rest, const double end[%d])\n"
	       "{\n"
	       "    double g[%d], off[%d], slack = 0.0, even = 0.0, odd = 0.0, more;\n"
	       "    int i, k;\n"
	       "    for (k = 1; k < %d; k++)\n"
	       "        g[k] = $o_expression(passed, c[k]);\n"
	       "    for (k = 0; k < %d; k++)\n"
	       "        slack += $o_slack[which][passed][k] * pl_magnitude(x[k]);\n",
	    size, terms, size, size, terms, n, terms, size);
	emit_sizes(e, terms, "more", "rest", false);
	say(e, "    if (!((up ? g[1] : -g[1]) > rest * more + slack))\n"
	       "        return 0;\n"
	       "    $o_bounds(which, x, off);\n"
	       "    for (i = 0; i < %d; i++) {\n"
	       "        const double from = $o_expression(i, x), to = $o_expression(i, end), sag = off[i] * "
	       "(rest * rest);\n"
	       "        if (i == passed ? !(up ? (from > to ? from : to) + sag < $o_within[region][i][1]\n"
	       "                               : (from < to ? from : to) - sag > $o_within[region][i][0])\n"
	       "                        : !$o_stays(region, i, from, to, sag))\n"
	       "            return 0;\n"
	       "    }\n"
	       "    return %s < %s;\n"
	       "}\n",
	    n, size_of_x(e, p, places(e, "pl_magnitude(end[%d])"), 12), shortest(p->large));
}

static void emit_cross(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, terms = p->degree + 1;
	say(e, "\n"
	       "/* s over h from x where it is certain that nothing is passed, or one breakpoint once: 1.  Else 0, and "
	       "nothing has\n"
	       " * changed. */\n"
	       "static PL_APART int $o_cross($n *s, const double x[%d])\n"
	       "{\n"
	       "    const int region = s->contact$p.region, which = s->contact$p.matrix;\n"
	       "    double c[%d][%d], y[%d], end[%d], z, to;\n"
	       "    int i, passed = 0, up, next, near;\n"
	       "    if (!(%s < %s))\n"
	       "        return 0;\n"
	       "    $o_advance(which, x, end);\n"
	       "    near = $o_near(region, which, x, end, &passed);\n"
	       "    if (near > 1)\n"
	       "        return 0;\n",
	    size, terms, size, size, size, size_of_x(e, p, places(e, "pl_magnitude(x[%d])"), 10),
	    shortest(p->large));
	say(e, "    if (near) {\n"
	       "        to = $o_expression(passed, end);\n"
	       "        up = to > $o_within[region][passed][1];\n"
	       "        $o_expand(which, x, c);\n"
	       "        z = $o_leaves(region, which, passed, up, x, c, to);\n"
	       "        if (z > 1.0)\n"
	       "            return 0;\n"
	       "        $o_sum_up(c, z, y);\n"
	       "        next = $o_beyond[region][passed][up];\n"
	       "        $o_expand($o_matrix[next], y, c);\n"
	       "        $o_sum_up(c, 1.0 - z, end);\n"
	       "        if (!$o_moves_on(next, $o_matrix[next], passed, up, y, c, 1.0 - z, end))\n"
	       "            return 0;\n");
	say(e, "        s->crossing$p[0].time = z * $N_H;\n"
	       "        s->crossing$p[0].expression = passed;\n"
	       "        s->crossing$p[0].breakpoint = next / $o_stride[passed] %% ($o_breaks[passed] + 1) - up;\n"
	       "        s->crossing$p[0].upward = up;\n"
	       "        s->contact$p.total++;\n"
	       "        s->contact$p.region = next;\n"
	       "        s->contact$p.matrix = $o_matrix[next];\n"
	       "    }\n"
	       "    s->contact$p.crossings = near;\n"
	       "    for (i = 0; i < %s; i++)\n"
	       "        s->y[%s] = end[i];\n"
	       "    return 1;\n"
	       "}\n", own_states(e), place_in_loop(e));
}

void emit_swift_functions(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	bool shares = strcmp(e->degree, e->own) != 0;   /* what depends on the degree alone is there already */
	emit_expression(e, &pieces);
	if (!shares)
		emit_weights(e, &pieces);
	emit_expand(e, &pieces);
	emit_polynomial(e, &pieces, "sum_up", e->step->layout.size);
	if (!shares)
		emit_root(e, &pieces);
	emit_bounds(e, &pieces);
	emit_whole(e, &pieces);
	emit_near(e, &pieces);
	emit_leaves(e, &pieces);
	emit_moves_on(e, &pieces);
	emit_cross(e, &pieces);
}

/* ---- the step ---- */

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
		text[layout->input[i]] = format(ramp ? "s->u[%d]" : "u[%d]", of);
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

static bool goes_by_tables(const struct emitter *e)
{
	enum { TERMS = 200 };
	const struct layout *layout = &e->step->layout;
	return possible_regions(e->model->switching) * layout->states * layout->size > TERMS;
}

static void emit_ends(const struct emitter *e, const struct pieces *p, const struct tables *whole,
		      const char *const *x, const char *before)
{
	int size = e->step->layout.size;
	const char **name = layout_names(&e->step->layout, e->system, e->model);
	for (int i = 0; i < size; i++)
		if (i < e->system->states || is_read_at_end(p, size, expressions_of(e), i))
			say(e, "    %send%d = %s;  /* %s */\n", before, i, row_text(whole, i, x, NULL, 22), name[i]);
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
	struct tables whole = tables_of_pieces(e, p, "factor", e->step->layout.size, whole_of);
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
	struct tables whole = of_branch(tables_of_pieces(e, p, "", e->step->layout.size, whole_of), branch);
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

void emit_swift_step(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	const struct layout *layout = &e->step->layout;
	const char **x = operands(e);
	for (int i = 0; i < e->system->inputs; i++) {
		int of = place_of_input(e, i);
		if (e->system->input[i].hold)
			say(e, "    const double part%d = (u[%d] - s->u[%d]) / $N_H;  /* its slope */\n", of, of, of);
	}
	if (goes_by_tables(e))
		emit_table_step(e, &pieces, x);
	else
		emit_cases(e, &pieces, x);
	say(e, "%s < %s) {\n", size_of_x(e, &pieces, magnitudes(e, x), 12), shortest(pieces.large));
	for (int i = 0; i < e->system->states; i++)
		say(e, "        s->y[%d] = end%d;\n", place_of_state(e, i), i);
	say(e, "        s->contact$p.crossings = 0;\n"
	       "    } else {\n"
	       "        double now[%d];\n", layout->size);
	for (int j = 0; j < layout->size; j++)
		say(e, "        now[%d] = %s;\n", j, *x[j] ? x[j] : "1.0");
	say(e, "        if (!$o_cross(s, now))\n"
	       "            $o_seek(s, now);\n"
	       "    }\n");
}
