/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions: what the few crossings of a step are found by, in the runtime (few.h, which the model's file includes): the
 * switching functions, their bounds, x over the whole step and over a part of it. */
#include "inner.h"
#include "emit/text.h"
#include "step/regions/guards.h"

#include <string.h>

/* ---- switching functions, bounds ---- */

static void emit_switching_function(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size, n = functions_of(e);
	open_function(e, "Switching function i", "static double $o_switching_function(int i, const double x[%d])",
		      size);
	if (n == 1) {
		say(e, "    (void)i;\n"
		       "    return %s;\n", text_of_switching(e, p, 0, places(e, "x[%d]"), 11));
	} else {
		struct region_tables rows = { spell(e, "$o_row"), n, size, 0, 0, NULL, NULL };
		struct summands s = { 0 };
		for (int j = 0; j < size; j++) {
			bool any = false;
			for (int i = 0; i < n; i++)
				any = any || p->row[i * size + j] != 0;
			if (any)
				add_summand(&s, format("%s[i][%d] * x[%d]", rows.text, j, j));
		}
		say(e, "    return %s;\n", sum_of(&s, 11));
	}
	close_function(e, "");
}

/* `what` of the entries of x that `row` reads, summed */
static void emit_product(const struct emitter *e, const char *name, const char *note, const char *const *what,
			 const bool *reads)
{
	const int size = e->step->layout.size;
	struct summands s = { 0 };
	bool any = false;
	for (int j = 0; j < size; j++)
		if (reads[j]) {
			add_summand(&s, *what[j] ? format("row[%d] * %s", j, what[j]) : format("row[%d]", j));
			any = any || *what[j];
		}
	open_function(e, note, "static double $o_%s(const double row[%d], const double x[%d])", name, size, size);
	say(e, "%s%s    return %s;\n", s.terms ? "" : "    (void)row;\n", any ? "" : "    (void)x;\n", sum_of(&s, 11));
	close_function(e, "");
}

/* Of tables of slopes; of bounds, in which what is never above 1 stands at the first of that; of other bounds */
static void emit_products(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size;
	struct region_tables slopes = tables_of_regions(e, p, "", functions_of(e), OF_PIECE(turn));
	bool *reads = ARRAY(bool, (size_t)size), *all = ARRAY(bool, (size_t)size), bounded = false;
	const char **most = places(e, "pl_magnitude(x[%d])");
	for (int j = 0; j < size; j++) {
		all[j] = true;
		for (int i = 0; i < slopes.rows; i++)
			reads[j] = reads[j] || acts_at(&slopes, i, j);
	}
	emit_product(e, "along", "row . x, of slopes", places(e, "x[%d]"), reads);
	emit_product(e, "sizes", "row . |x|", most, all);
	for (int j = 0; j < size; j++) {
		all[j] = !p->bounded[j] || !bounded;
		bounded = bounded || p->bounded[j];
		if (p->bounded[j])
			most[j] = "";
	}
	emit_product(e, "most", "The same where entries that are never above 1 count as 1", most, all);
}

/* off[i], from x */
static void emit_bounds(const struct emitter *e, const struct pieces *p)
{
	int n = functions_of(e), size = e->step->layout.size;
	const char **magnitude = entries(e, "pl_magnitude(x[%d])");
	open_function(e, "How far each switching function leaves its chord over h, at most",
		      "static void $o_bounds(int which, const double x[%d], double off[%d])", size, n);
	for (int i = 0; i < n; i++)
		say(e, "    off[%d] = %s;\n", i,
		    any_pieces(e) ? off_text(e, p, -1, i, magnitude, 13)
				  : spell(e, "$o_sizes($o_chord_error[which][%d], x)", i));
	close_function(e, any_pieces(e) ? "which x" : "");
}

/* ---- x(s) ---- */

/* Into end[]: Phi x over h */
static void emit_full(const struct emitter *e, const struct pieces *p)
{
	int size = e->step->layout.size;
	struct region_tables full = steps_of_regions(e, p, "factor");
	const char **x = entries(e, "x[%d]");
	open_function(e, "end = e^{A h} x",
		      "static void $o_advance(int which, const double x[%d], double end[%d])", size,
		      size);
	say(e, "    const double (*const factor)[%d] = $o_pieces[which];\n", size);
	for (int i = 0; i < size; i++)
		if (is_compensated(e))
			say(e, "    end[%d] = x[%d] + (%s);\n", i, i, row_text(&full, i, x, NULL, 21));
		else
			say(e, "    end[%d] = %s;\n", i, row_text(&full, i, x, NULL, 13));
	close_function(e, is_table(&full) && !is_compensated(e) ? "" : "factor");
}

static bool moves(const struct region_tables *t, int row)
{
	bool any = false;
	for (int j = 0; j < t->columns; j++)
		any = any || acts_at(t, row, j);
	return any;
}

/* Entries of h A that differ from matrix to matrix: locals, and their text */
static void emit_turns(const struct emitter *e, const struct region_tables *t)
{
	bool any = false;
	for (int i = 0; i < t->rows; i++)
		for (int j = 0; j < t->columns; j++)
			if (acts_at(t, i, j) && !agree_at(t, i, j)) {
				say(e, "    const double h%d_%d = $N_H * $o_slopes[which][%d][%d];\n", i, j, i, j);
				any = true;
			}
	if (!any)
		say(e, "    (void)which;\n");
}

static const char *turn_times(const struct region_tables *t, int i, int j, const char *operand)
{
	return agree_at(t, i, j) ? scaled(t->value[0][i * t->columns + j], operand)
				 : format("h%d_%d * %s", i, j, operand);
}

/* Velocities are added last: positions and loads are there before them, so that a chain has one product and one sum an
 * order.  From the second derivative on what is constant is 0. */
static const char *rotated_row(const struct emitter *e, const struct region_tables *t, int row, const char *layout,
			      bool first)
{
	struct summands early = { 0 }, late = { 0 };
	for (int j = 0; j < t->columns; j++)
		if (acts_at(t, row, j) && (first || moves(t, j)))
			add_summand(j >= e->system->n && j < e->system->states ? &late : &early,
				    turn_times(t, row, j, format(layout, j)));
	if (early.terms && late.terms)
		return format("(%s)\n%26s+ (%s)", sum_of(&early, 26), "", sum_of(&late, 28));
	return sum_of(early.terms ? &early : &late, 25);
}

static void emit_turn(const struct emitter *e, const struct region_tables *t)
{
	int size = e->step->layout.size;
	open_function(e, "d = h A x", "static void $o_turn_once(int which, const double x[%d], double d[%d])",
		   size, size);
	emit_turns(e, t);
	for (int i = 0; i < size; i++)
		say(e, "    d[%d] = %s;\n", i, rotated_row(e, t, i, "x[%d]", true));
	close_function(e, "");
}

static void emit_weights(const struct emitter *e, const struct pieces *p)
{
	say(e, "\n"
	       "static const double $d_weight[%d] = {  /* 1/k!: weights of the Taylor polynomial */\n"
	       "    1.0", p->degree + 1);
	for (int k = 1; k <= p->degree; k++)
		say(e, "%s%s", k % 4 ? ", " : ",\n    ", shortest(p->weight[k]));
	say(e, "\n"
	       "};\n");
}

/* What is added to x, so that little of it is lost beside x */
static void emit_move(const struct emitter *e, const struct pieces *p, const struct region_tables *t)
{
	int size = e->step->layout.size;
	open_function(e, "gain = e^{A h s} x - x, by a Taylor polynomial",
		   "static void $o_move(int which, const double x[%d], double s, double gain[%d])",
		      size, size);
	say(e, "    double power = s;\n"
	       "    int k;\n");
	emit_turns(e, t);
	for (int i = 0; i < size; i++)
		if (moves(t, i))
			say(e, "    double a%d = %s, sum%d = s * a%d;\n", i, rotated_row(e, t, i, "x[%d]", true), i, i);
	say(e, "    for (k = 2; k <= %d; k++) {\n", p->degree);
	for (int i = 0; i < size; i++)
		if (moves(t, i))
			say(e, "        const double b%d = %s;\n", i, rotated_row(e, t, i, "a%d", false));
	say(e, "        double weight;\n"
	       "        power *= s;\n"
	       "        weight = power * $d_weight[k];\n");
	for (int i = 0; i < size; i++)
		if (moves(t, i))
			say(e, "        a%d = b%d;\n"
			       "        sum%d += weight * b%d;\n", i, i, i, i);
	say(e, "    }\n");
	for (int i = 0; i < size; i++)
		say(e, moves(t, i) ? "    gain[%d] = sum%d;\n" : "    gain[%d] = 0.0;\n", i, i);
	close_function(e, "");
}

/* ---- what few.h asks beside ---- */

static void emit_size_of_x(const struct emitter *e, const struct pieces *p)
{
	open_function(e, "The sum of |x|", "static double $o_size_of(const double x[%d])", e->step->layout.size);
	say(e, "    return %s;\n", size_of_x(e, p, places(e, "pl_magnitude(x[%d])"), 11));
	close_function(e, "");
}

void emit_crossing_macros(const struct emitter *e, const struct pieces *p)
{
	const char *step = any_pieces(e) ? "step_" : "";
	say_macro(e, "FEW", integer_text(fast_path_events(e->model)));
	say_macro(e, "EVENT_CHECKS", integer_text(event_checks(e->model)));
	say_macro(e, "LARGE", shortest(p->large));
	say_macro(e, "OPEN_END", shortest(OPEN_END));
	say_macro(e, "MOVES", integer_text(e->step->regions.event_check.degree));
	say_macro(e, "TANGENT", format("PL(%stangent)", step));
	say_macro(e, "CUBIC_ERROR", format("PL(%scubic_error)", step));
}

void emit_crossing(const struct emitter *e, const struct pieces *p)
{
	struct region_tables turns = tables_of_regions(e, p, "", e->step->layout.size, OF_PIECE(turns));
	emit_switching_function(e, p);
	emit_products(e, p);
	emit_bounds(e, p);
	emit_full(e, p);
	emit_turn(e, &turns);
	if (strcmp(e->spelled.degree, e->spelled.own) == 0) /* else they are there already */
		emit_weights(e, p);
	emit_move(e, p, &turns);
	emit_size_of_x(e, p);
}
