/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions whose matrices tunable params change: an instance has the tables of its search, and NAME_retune computes them
 * anew: rows of numbers by sums of products of params, e^{A d} of each region, bounds. */
#include "emit/emit.h"

static const struct retuned *retuned_of(const struct emitter *e)
{
	return e->model->retuned;
}

static bool has_guards(const struct emitter *e)
{
	return has_events(e->model->switching);
}

static struct guards own_guards(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	return guards_of(e->step, &pieces);
}

/* ---- the struct ---- */

static void member(const struct emitter *e, const char *type, const char *name, const char *shape, const char *comment)
{
	say(e, "    %-46s /* %s */\n", format("%s %s%s;", type, name, shape), comment);
}

static const char *table_shape(int rows, int columns)
{
	return format("[%d][%d]", rows, columns);
}

static void guard_members(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	const struct guards g = own_guards(e);
	int size = e->step->layout.size;
	int values = g.assignments > 0 ? g.assignments : 1, all = g.impacts > 0 ? s->segments * g.impacts : 1;
	member(e, "double", "limit", format("[%d]", g.guards), "of each guard");
	member(e, "double", "play", format("[%d]", s->segments * s->expressions),
	       "factors of cos and sin in each expression");
	member(e, "double", "gate_play", format("[%d]", g.rows), "in each row of guards");
	member(e, "double", "gate", table_shape(g.rows, size), "rows of guards");
	member(e, "double", "gate_lean", table_shape(g.rows, size), "d/3 times the slope of each");
	member(e, "double", "gate_sag", table_shape(g.rows, size), "d^2/8 times its second derivative, at most");
	member(e, "double", "gate_sway", table_shape(g.rows, size), "d^4/384 times its fourth derivative, at most");
	member(e, "double", "value", table_shape(values, size), "x[held] = value . x");
	member(e, "pl_impact", "impact", format("[%d]", all), "what each does");
	member(e, "double", "speed", table_shape(all, size), "of what bounces");
	member(e, "double", "back", table_shape(all, size), "from beyond a guard onto it");
	if (s->felts > 0)
		member(e, "double", "grips", format("[%d][%d][%d]", s->regions, s->felts, size),
		       "what friction carries");
}

void emit_retuned_members(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	int size = e->step->layout.size, systems = e->step->branches, breaks = 0;
	const char *segments = s->segments > 1 ? format("[%d]", s->segments) : "";
	const char *matrices = format("[%d][%d][%d]", systems, size, size);
	const char *rows = format("[%d][%d][%d]", systems, s->expressions, size);
	for (int i = 0; i < s->expressions; i++)
		breaks += s->expression[i].breaks;
	member(e, "int", "halvings", format("[%d]", systems), "of h, to a piece d of a step in each region");
	member(e, "int", "spacing", format("[%d]", systems), "between lengths of longer pieces");
	member(e, "double", "row", format("%s[%d][%d]", segments, s->expressions, size), "expressions, over x");
	member(e, "double", "breakpoint", format("[%d]", breaks), "that divide them");
	member(e, "double", "slopes", matrices, "x' = A x");
	member(e, "double", "pieces", matrices, "e^{A h}");
	member(e, "double", "lean", rows, "d/3 times the slope of each expression");
	if (!has_guards(e)) {
		member(e, "double", "sag", rows, "d^2/8 times its second derivative, at most");
		member(e, "double", "sway", rows, "d^4/384 times its fourth derivative, at most");
	}
	const struct guards g = has_guards(e) ? own_guards(e) : (struct guards){ 0 };
	member(e, "double", "rungs", format("[%d][%d][%d]", rungs_of_all(e), rows_of_rung(e), size),
	       "e^{A d} of shorter pieces");
	if (rows_of_reach(e, has_guards(e) ? &g : NULL) > 0)
		member(e, "double", "bend", table_shape(rows_of_reach(e, has_guards(e) ? &g : NULL), size),
		       "times |x''|: off a chord over the next longer one, at most");
	if (has_guards(e)) {
		guard_members(e);
		return;
	}
	if (!e->step->clears)
		return;
	member(e, "double", "chord_off", rows, "how far each expression is off its chord over h, at most");
	if (any_stays(e->step))
		member(e, "double", "added", format("[%d][%d]", systems, e->system->states),
		       "to each state, by what stays of x");
	if (any_still(e->step))
		member(e, "double", "still", format("[%d][%d]", systems, s->expressions),
		       "to chord_off, by that and by what is never above 1");
	member(e, "double", "edge", format("[%d]", edges_of_regions(s)),
	       "breakpoints less what stays of x, between open ends");
	member(e, "double", "large", format("[%d]", systems), "|x| below which nothing of that overflows");
}

/* ---- the equations ---- */

static const char *name_of_row(const struct emitter *e, const struct retuned_row *row)
{
	const struct model *model = e->model;
	const struct switching *s = model->switching;
	const struct strike *strike;
	switch (row->kind) {
	case RETUNED_SLOPE:
		return format("system %d: %s%s", row->of, model->coord_name[row->index],
			      model->system.velocity[row->index] >= 0 ? "''" : "'");
	case RETUNED_EXPRESSION:  return form_text(model, s->expression[row->index].form);
	case RETUNED_BREAK:       return format("breakpoint %d of %s", row->index,
						form_text(model, s->expression[row->of].form));
	case RETUNED_HOLD:        return format("region %d: %s", row->of,
						model->state_name[s->region[row->of].hold[row->index].state]);
	case RETUNED_RELEASE:     return format("region %d: release %d", row->of, row->index);
	case RETUNED_GRIP:        return format("region %d: friction %d", row->of, row->index);
	case RETUNED_JUMP:
	case RETUNED_STILL:
		strike = &s->impact[row->of % s->impacts].in[row->of / s->impacts];
		return format("impact %d: %s", row->of, model->state_name[strike->jump[row->index].state]);
	case RETUNED_SPEED:       return format("impact %d: speed", row->of);
	case RETUNED_BACK:        return format("impact %d: back", row->of);
	case RETUNED_RESTITUTION: return format("impact %d: restitution", row->of);
	case RETUNED_LEAST:       return "at least 0";
	default:                  return row->positive ? "stays above 0" : "stays below 0";
	}
}

static bool is_number(const struct retuned_row *row)
{
	return row->kind == RETUNED_BREAK || row->kind == RETUNED_RESTITUTION || row->kind == RETUNED_LEAST ||
	       row->kind == RETUNED_SIGN;
}

static const struct retuned_row *row_at(const struct emitter *e, int place)
{
	const struct retuned *r = retuned_of(e);
	int i = 0;
	while (r->row[i].place != place)
		i++;
	return &r->row[i];
}

/* W a = R x, or a = R x; rows from `place` on */
static void emit_terms(const struct emitter *e, const struct tuning *t, int place, const char *suffix)
{
	const char **column = layout_names(&e->step->layout, e->system, e->model);
	emit_monomials(e, t, suffix);
	emit_term_start(e, t, suffix);
	for (const struct tuned_term *term = t->term; term < t->term + t->terms; term++) {
		const struct retuned_row *row = row_at(e, place + term->row);
		bool left = term->column >= t->x.size;
		const char *of = is_number(row) ? ""
				 : left ? format(" row %d", term->column - t->x.size)
					: format(" %s", column[term->column]);
		say(e, "    {%d, %d, %d, %s},  /* %s%s: %s%s */\n", term->row, term->column, term->monomial,
		    two_words(equation_number(e->model, term->factor)), name_of_row(e, row), left ? ", left" : "",
		    tuned_product(t, term), of);
	}
	say(e, "};\n"
	       "\n"
	       "static const pl_equations $n_equations%s = {%d, %d, %d, $N_PARAMS, %d, %d, %s, $n_term%s};\n", suffix,
	    t->rows, t->x.size, t->solves, t->monomials, t->terms,
	    t->monomials ? spell(e, "$n_monomial%s", suffix) : "NULL", suffix);
}

static void emit_equations(const struct emitter *e)
{
	const struct retuned *r = retuned_of(e);
	emit_terms(e, r->tuning, 0, "");
	for (int b = 0; b < r->blocks; b++)
		emit_terms(e, r->block[b].tuning, r->block[b].place, format("%d", b + 1));
}

/* What the target solves, into its rows among the others */
static void emit_solved(const struct emitter *e)
{
	const struct retuned *r = retuned_of(e);
	for (int b = 0; b < r->blocks; b++) {
		const struct tuning *t = r->block[b].tuning;
		int size = e->step->layout.size, width = size + t->rows;
		say(e, "    status = pl_equations_at(&$n_equations%d, params, wide, work);\n"
		       "    if (status != 0)\n"
		       "        return status;\n"
		       "    for (i = 0; i < %d; i++)\n"
		       "        for (k = 0; k < %d; k++)\n"
		       "            value[%d + i][k] = wide[%d * i + k];\n", b + 1, t->rows, size, r->block[b].place,
		       width);
	}
}

static int widest_block(const struct emitter *e)
{
	const struct retuned *r = retuned_of(e);
	int most = 0;
	for (int b = 0; b < r->blocks; b++) {
		int rows = r->block[b].tuning->rows, cells = rows * (rows + e->step->layout.size);
		most = cells > most ? cells : most;
	}
	return most;
}

static int most_products(const struct emitter *e)
{
	const struct retuned *r = retuned_of(e);
	int most = r->tuning->monomials;
	for (int b = 0; b < r->blocks; b++)
		most = r->block[b].tuning->monomials > most ? r->block[b].tuning->monomials : most;
	return most + 1;
}

static void emit_fixed_slopes(const struct emitter *e, int count, const struct fixed_slope *fixed)
{
	if (count == 0)
		return;
	say(e, "    static const struct {\n"
	       "        int row, column;\n"
	       "        pl_two value;\n"
	       "    } fixed[] = {");
	for (int k = 0; k < count; k++)
		say(e, "%s{%d, %d, %s}", k ? ", " : "", fixed[k].row, fixed[k].column, two_words(fixed[k].value));
	say(e, "};\n");
}

static void emit_slopes_begin(const struct emitter *e)
{
	const struct linear *system = e->system;
	struct fixed_slope *list;
	int size = e->step->layout.size, fixed = fixed_slopes(e->step, &list);
	emit_fixed_slopes(e, fixed, list);
	say(e, "    static const int row[%d] = {", system->n);
	for (int i = 0; i < system->n; i++)
		say(e, "%s%d", i ? ", " : "", system->velocity[i] >= 0 ? system->velocity[i] : i);
	say(e, "};  /* of the highest derivatives */\n"
	       "    int i, j;\n"
	       "    for (i = 0; i < %d; i++)\n"
	       "        for (j = 0; j < %d; j++) {\n"
	       "            A[i][j].hi = 0.0;\n"
	       "            A[i][j].lo = 0.0;\n"
	       "        }\n", size, size);
	if (fixed)
		say(e, "    for (i = 0; i < %d; i++)\n"
		       "        A[fixed[i].row][fixed[i].column] = fixed[i].value;\n", fixed);
}

static void emit_own_slopes(const struct emitter *e)
{
	int size = e->step->layout.size;
	say(e, "\n/* x' = A x of one system, from its rows of highest derivatives */\n"
	       "static void $n_own_slopes(pl_two value[][%d], pl_two A[%d][%d])\n"
	       "{\n", size, size, size);
	emit_slopes_begin(e);
	say(e, "    for (i = 0; i < %d; i++)\n"
	       "        for (j = 0; j < %d; j++)\n"
	       "            A[row[i]][j] = value[i][j];\n"
	       "}\n", e->system->n, size);
}

static void emit_take(const struct emitter *e)
{
	const struct retuned *r = retuned_of(e);
	int size = e->step->layout.size;
	bool any = false;
	for (int i = 0; i < r->rows; i++)
		any = any || (r->row[i].place >= 0 && r->row[i].kind != RETUNED_SLOPE && !is_number(&r->row[i]));
	if (!any)
		return;
	say(e, "\n"
	       "static void $n_take(double to[%d], const pl_two from[%d], double sign)\n"
	       "{\n"
	       "    int j;\n"
	       "    for (j = 0; j < %d; j++)\n"
	       "        to[j] = sign * from[j].hi + 0.0;  /* no -0 */\n"
	       "}\n", size, size, size);
}

/* ---- what goes where ---- */

static void emit_checks(const struct emitter *e)
{
	const struct retuned *r = retuned_of(e);
	for (int i = 0; i < r->rows; i++) {
		const struct retuned_row *row = &r->row[i];
		const char *value = format("value[%d][0].hi", row->place);
		const char *wrong = row->kind == RETUNED_SIGN ? format("!(%s %c 0.0)", value, row->positive ? '>' : '<')
				    : row->kind == RETUNED_LEAST ? format("%s < 0.0", value)
							       : NULL;
		if (row->kind == RETUNED_RESTITUTION)
			wrong = e->model->impact[row->of % e->model->impacts].when->restitution
					? format("%s < 0.0 || %s > 1.0", value, value)
									    : format("%s < 0.0", value);
		if (row->place >= 0 && wrong)
			say(e, "    if (%s)  /* %s */\n"
			       "        return PL_OUT_OF_RANGE;\n", wrong, name_of_row(e, row));
	}
}

static void take(const struct emitter *e, int place, const char *to, bool turned)
{
	if (place >= 0)
		say(e, "    $n_take(%s, value[%d], %s);\n", to, place, turned ? "-1.0" : "1.0");
}

static void take_number(const struct emitter *e, int place, const char *to, bool turned)
{
	if (place >= 0)
		say(e, "    %s = %svalue[%d][0].hi;\n", to, turned ? "0.0 - " : "", place);
}

static void emit_taken_expressions(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	const struct retuned *r = retuned_of(e);
	for (int segment = 0; segment < s->segments; segment++)
		for (int i = 0; i < s->expressions; i++)
			take(e, retuned_place(r, RETUNED_EXPRESSION, segment, i),
			     s->segments > 1 ? format("made.row[%d][%d]", segment, i) : format("made.row[%d]", i),
			     false);
	for (int i = 0, first = 0; i < s->expressions; first += s->expression[i++].breaks)
		for (int k = 0; k < s->expression[i].breaks; k++)
			take_number(e, retuned_place(r, RETUNED_BREAK, i, k), format("made.breakpoint[%d]", first + k),
				    false);
}

static void emit_taken_gates(const struct emitter *e, const struct guards *g)
{
	const struct retuned *r = retuned_of(e);
	for (int i = 0; i < g->rows; i++) {
		const struct gate_key *gate = &g->gate[i];
		int place = gate->expression >= 0
				    ? retuned_place(r, RETUNED_EXPRESSION, gate->segment, gate->expression)
				    : retuned_place(r, RETUNED_RELEASE, gate->region, gate->release);
		take(e, place, format("made.gate[%d]", i), gate->expression >= 0 && !gate->upward);
	}
	for (int i = 0; i < g->guards; i++) {
		const struct guard *guard = &g->guard[i];
		if (g->gate[guard->row].expression >= 0)
			take_number(e, retuned_place(r, RETUNED_BREAK, guard->expression, guard->breakpoint),
				    format("made.limit[%d]", i), !guard->upward);
	}
}

static void emit_taken_jumps(const struct emitter *e, const struct guards *g)
{
	const struct switching *s = e->model->switching;
	const struct retuned *r = retuned_of(e);
	for (int i = 0; i < g->assignments; i++)
		take(e, retuned_place(r, g->assignment[i].kind, g->assignment[i].of, g->assignment[i].index),
		     format("made.value[%d]", i), false);
	for (int i = 0; i < s->segments * g->impacts; i++) {
		take_number(e, retuned_place(r, RETUNED_RESTITUTION, i, 0), format("made.impact[%d].restitution", i),
			    false);
		take(e, retuned_place(r, RETUNED_SPEED, i, 0), format("made.speed[%d]", i), false);
		take(e, retuned_place(r, RETUNED_BACK, i, 0), format("made.back[%d]", i), false);
	}
	for (int k = 0; k < s->regions; k++)
		for (int i = 0; i < s->felts; i++)
			take(e, retuned_place(r, RETUNED_GRIP, k, i), format("made.grips[%d][%d]", k, i), false);
}

/* The sizes of a row's factors of what is never above 1 */
static void emit_play(const struct emitter *e, const struct guards *g)
{
	const char *list = "";
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && is_bounded_load(e->step, l); k++)
			list = format("%s%s%d", list, *list ? ", " : "", e->step->layout.load[l] + k);
	if (!*list)
		return;
	int count = 1;
	for (const char *c = list; *c; c++)
		count += *c == ',';
	const struct switching *s = e->model->switching;
	say(e, "    for (i = 0; i < %d; i++)\n"
	       "        made.play[i] = $n_play(made.row%s);\n"
	       "    for (i = 0; i < %d; i++)\n"
	       "        made.gate_play[i] = $n_play(made.gate[i]);\n", s->segments * s->expressions,
	    s->segments > 1 ? format("[i / %d][i %% %d]", s->expressions, s->expressions) : "[i]", g->rows);
	for (int i = 0; i < s->segments * g->impacts; i++)
		say(e, "    made.impact[%d].play = $n_play(made.speed[%d]);\n", i, i);
}

static void emit_play_function(const struct emitter *e)
{
	const char **term = ARRAY(const char *, (size_t)e->step->layout.size);
	int terms = 0;
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && is_bounded_load(e->step, l); k++)
			term[terms++] = format("pl_magnitude(row[%d])", e->step->layout.load[l] + k);
	if (terms)
		say(e, "\nstatic double $n_play(const double row[%d])\n"
		       "{\n"
		       "    return %s;\n"
		       "}\n", e->step->layout.size, tree(terms, term, 11));
}

/* ---- retune ---- */

static bool rows_change(const struct emitter *e)
{
	const struct retuned *r = retuned_of(e);
	bool change = false;
	for (int i = 0; i < r->rows; i++)
		change = change || (r->row[i].place >= 0 &&
				    (r->row[i].kind == RETUNED_EXPRESSION || r->row[i].kind == RETUNED_RELEASE));
	return change;
}

/* e^{A d} of each system that changes, and bounds of what changes with it */
static void emit_systems(const struct emitter *e)
{
	const struct retuned *r = retuned_of(e);
	int size = e->step->layout.size;
	say(e, "    for (k = 0; k < %d; k++) {\n"
	       "        static const int first[%d] = {", e->step->branches, e->step->branches);
	for (int k = 0; k < e->step->branches; k++)
		say(e, "%s%d", k ? ", " : "", retuned_place(r, RETUNED_SLOPE, k, 0));
	say(e, "};  /* its rows; -1: it stays */\n"
	       "        if (first[k] >= 0) {\n"
	       "            $n_own_slopes(&value[first[k]], A);\n"
	       "            status = pl_region_of(%d, A[0], h, %d, %d, &made.halvings[k], &made.spacing[k],\n"
	       "                                  made.slopes[k][0], made.pieces[k][0],\n"
	       "                                  made.rungs[$o_first_rung[k]][0], work);\n"
	       "            if (status != 0)\n"
	       "                return status;\n", size, LIMIT_PIECES, room_for_rungs(e->step));
	if (e->step->clears)
		say(e, "            made.large[k] = pl_region_large(%d, made.halvings[k], made.pieces[k][0], %s);\n",
		    size, shortest(LARGE_ENOUGH));
	say(e, "        }\n");
	if (!rows_change(e))
		say(e, "        if (first[k] < 0)\n"
		       "            continue;\n");
	say(e, "        d = h / (double)((uint32_t)1 << made.halvings[k]);\n");
}

static void emit_bounds(const struct emitter *e)
{
	const struct switching *s = e->model->switching;
	int size = e->step->layout.size;
	const char *row = "made.row[0]";
	if (s->segments > 1) {
		say(e, "        {\n"
		       "            static const int segment[%d] = {", e->step->branches);
		for (int k = 0; k < e->step->branches; k++)
			say(e, "%s%d", k ? ", " : "", s->system_segment[k]);
		say(e, "};\n");
		row = "made.row[segment[k]][0]";
	}
	const char *indent = s->segments > 1 ? "    " : "";
	say(e, "%s        pl_region_bounds(%d, d, made.slopes[k][0], %d, %s,\n"
	       "%s                         made.lean[k][0], %s, %s, room);\n", indent, size, s->expressions, row,
	       indent,
	    has_guards(e) ? "spare[0]" : "made.sag[k][0]", has_guards(e) ? "spare[1]" : "made.sway[k][0]");
	if (!has_guards(e))
		say(e, "%s        pl_region_reach(%d, h, made.halvings[k], made.spacing[k], made.slopes[k][0], %d,\n"
		       "%s                        %s, made.bend[$o_first_rung[k] * %d], room);\n", indent, size,
		    s->expressions, indent, row, s->expressions);
	say(e, s->segments > 1 ? "        }\n" : "");
	if (e->step->clears)
		say(e, "        if (made.halvings[k] == 1)\n"
		       "            pl_region_bounds(%d, h, made.slopes[k][0], %d, made.row[0], spare[0],\n"
		       "                             made.chord_off[k][0], spare[1], room);\n"
		       "        for (i = 0; i < %d && made.halvings[k] == 0; i++)\n"
		       "            for (j = 0; j < %d; j++)\n"
		       "                made.chord_off[k][i][j] = made.sag[k][i][j];\n", size, s->expressions,
		    s->expressions, size);
}

static void emit_gate_bounds(const struct emitter *e, const struct guards *g)
{
	int size = e->step->layout.size;
	say(e, "        for (i = 0; i < %d; i++) {\n"
	       "            static const int system[%d] = {", g->rows, g->rows);
	for (int i = 0; i < g->rows; i++)
		say(e, "%s%d", i == 0 ? "" : i % 20 ? ", " : ",\n                ", g->branch[i]);
	say(e, "};  /* of each row of guards */\n"
	       "            for (j = 0; i + j < %d && system[i + j] == k; j++)\n"
	       "                ;\n"
	       "            if (j == 0)\n"
	       "                continue;\n"
	       "            pl_region_bounds(%d, d, made.slopes[k][0], j, made.gate[i],\n"
	       "                             made.gate_lean[i], made.gate_sag[i], made.gate_sway[i], room);\n"
	       "            for (j += i; i < j; i++)\n"
	       "                pl_region_reach(%d, h, made.halvings[k], made.spacing[k], made.slopes[k][0], 1,\n"
	       "                                made.gate[i], made.bend[$o_gate_rung[i]], room);\n"
	       "            i--;\n"
	       "        }\n", g->rows, size, size);
}

static void emit_retuning(const struct emitter *e)
{
	const struct retuned *r = retuned_of(e);
	const struct guards g = has_guards(e) ? own_guards(e) : (struct guards){ 0 };
	int size = e->step->layout.size, products = most_products(e);
	const char *work = products > 7 * size * size ? format("%d", products) : format("PL_REGION_WORK(%d)", size);
	say(e, "\nint $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h)\n"
	       "{\n"
	       "    $n_coeffs made = $n_nominal;\n"
	       "    pl_two value[%d][%d], A[%d][%d], work[%s];\n"
	       "    double room[PL_REACH_WORK(%d, %d)], d;\n", r->tuning->rows, size, size, size, work, size,
	    e->model->switching->expressions > 0 ? e->model->switching->expressions : 1);
	if (r->blocks)
		say(e, "    pl_two wide[%d];\n", widest_block(e));
	if (has_guards(e) || e->step->clears)
		say(e, "    double spare[2][%d];\n", e->model->switching->expressions * size);
	say(e, "    int i, %sk, status;\n"
	       "    if (h != $N_H)\n"
	       "        return PL_NO_STEP;\n"
	       "    for (i = 0; i < $N_PARAMS; i++)\n"
	       "        if (params[i] - params[i] != 0.0)\n"
	       "            return PL_NOT_FINITE;\n"
	       "    for (i = 0; i < $N_PARAMS; i++)\n"
	       "        made.params[i] = params[i];\n"
	       "    status = pl_equations_at(&$n_equations, params, value[0], work);\n"
	       "    if (status != 0)\n"
	       "        return status;\n", has_guards(e) || e->step->clears ? "j, " : "");
	emit_solved(e);
	emit_checks(e);
	emit_taken_expressions(e);
	if (has_guards(e)) {
		emit_taken_gates(e, &g);
		emit_taken_jumps(e, &g);
		emit_play(e, &g);
	}
	emit_systems(e);
	emit_bounds(e);
	if (has_guards(e))
		emit_gate_bounds(e, &g);
	say(e, e->step->clears ? "    }\n"
				 "    $n_gather(&made);\n"
			       : "    }\n");
	say(e, "    *c = made;\n"
	       "    return 0;\n"
	       "}\n");
}

int retuned_numbers(const struct emitter *e)
{
	int size = e->step->layout.size;
	return 2 * e->step->branches * size * size + rungs_of_all(e) * (size + 1) * size;
}

int retuned_kilobytes(const struct emitter *e)
{
	int size = e->step->layout.size, cells = size * size, real = e->model->asked.single ? 4 : 8;
	int twos = retuned_of(e)->tuning->rows * size + 8 * cells + widest_block(e);
	return 1 + real * (2 * twos + 4 * cells + 5 * size) / 1024;
}

/* ---- steps that stay clear ---- */

static int pairs_of(const struct emitter *e, int *column)
{
	int count = 0;
	for (int l = 0; l < e->system->loads; l++)
		if (is_bounded_load(e->step, l) && e->system->load[l].columns == 2)
			column[count++] = e->step->layout.load[l];
	return count;
}

static void emit_gathering(const struct emitter *e)
{
	int stays, *column = staying_columns(e->step, &stays), *param = ARRAY(int, (size_t)stays);
	int *pair = ARRAY(int, (size_t)e->system->loads), pairs = pairs_of(e, pair);
	for (int k = 0; k < stays; k++)
		param[k] = param_of_column(e->step, column[k]);
	emit_int_list(e, "stays", stays, column);
	emit_int_list(e, "stay_param", stays, param);
	emit_int_list(e, "pair", pairs, pair);
	const struct size sizes[] = {
		{ "STATES", e->system->states }, { "EXPRESSIONS", e->model->switching->expressions },
		{ "BRANCHES", e->step->branches }, { "STAYS", stays }, { "PAIRS", pairs },
		{ "STILL", any_still(e->step) }
	};
	emit_sizes(e, sizeof sizes / sizeof *sizes, sizes);
	say_macro(e, "LARGE", shortest(LARGE_ENOUGH));
	say_macro(e, "FOLDED", shortest(FOLDED));
	say_macro(e, "OPEN_END", shortest(OPEN_END));
	say(e, "#include \"gather.h\"\n");
}

void emit_retuned(const struct emitter *e)
{
	emit_equations(e);
	emit_own_slopes(e);
	emit_take(e);
	if (has_guards(e))
		emit_play_function(e);
	if (e->step->clears)
		emit_gathering(e);
	emit_retuning(e);
}
