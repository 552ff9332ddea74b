/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A piecewise-linear model as C: tables of its regions, and a step that leaves finding crossings to the runtime. */
#include "emit/emit.h"

static const struct switching *regions_of(const struct emitter *e)
{
	return e->model->switching;
}

/* Regions have events of their own: friction, impacts */
static bool has_guards(const struct emitter *e)
{
	return has_events(regions_of(e));
}

/* ---- tables: of the file, or where params are tunable of an instance ---- */

static const char **expression_names(const struct emitter *e)
{
	const struct switching *s = regions_of(e), *shown = e->step->shown->model->switching;
	const char **name = ARRAY(const char *, (size_t)s->expressions);
	for (int i = 0; i < s->expressions; i++)
		name[i] = form_text(e->step->shown->model,
				    shown->expression[e->part ? e->part->expression[i] : i].form);
	return name;
}

/* A matrix of each region */
struct matrices {
	const char *name, *note;
	int rows;
	const char **row_name;
	double *(*of)(const struct region_piece *piece);
};

static double *slopes_of_piece(const struct region_piece *piece) { return piece->slopes; }
static double *Phi_of_piece(const struct region_piece *piece)    { return piece->Phi; }
static double *gain_of_piece(const struct region_piece *piece)   { return piece->gain; }
static double *slope_of_piece(const struct region_piece *piece)  { return piece->slope; }
static double *second_of_piece(const struct region_piece *piece) { return piece->second; }
static double *fourth_of_piece(const struct region_piece *piece) { return piece->fourth; }

static void emit_matrices(const struct emitter *e, const struct pieces *pieces, const struct matrices *m)
{
	int size = e->step->layout.size;
	open_table(e, m->name, format("[%d][%d][%d]", e->step->branches, m->rows, size), m->note);
	for (int k = 0; k < e->step->branches; k++) {
		say(e, "  {\n");
		emit_number_rows(e, m->rows, size, m->of(&pieces->piece[k]), m->row_name);
		say(e, "  },\n");
	}
	close_table(e);
}

static void emit_rows(const struct emitter *e, const struct pieces *pieces)
{
	const struct switching *s = regions_of(e);
	int size = e->step->layout.size;
	bool several = regions_change(e);
	const char *shape = format("%s[%d][%d]", several ? format("[%d]", s->segments) : "", s->expressions, size);
	open_table(e, "row", shape, format("expressions that breakpoints divide%s",
					   several ? ", in each segment of time" : ""));
	for (int k = 0; k < s->segments; k++) {
		say(e, several ? "  {\n" : "");
		emit_number_rows(e, s->expressions, size, pieces->rows[k], expression_names(e));
		say(e, several ? "  },\n" : "");
	}
	close_table(e);
}

static void emit_break_counts(const struct emitter *e)
{
	const struct switching *s = regions_of(e);
	say(e, "\nstatic const int $o_breaks[] = {");
	for (int i = 0; i < s->expressions; i++)
		say(e, "%s%d", i ? ", " : "", s->expression[i].breaks);
	say(e, "};\n");
}

static void emit_breakpoints(const struct emitter *e, const struct pieces *pieces)
{
	const struct switching *s = regions_of(e);
	int shown = 0;
	say(e, e->model->retuned ? "    {" : "static const double $o_breakpoint[] = {");
	for (int i = 0; i < s->expressions; i++)
		for (int k = 0; k < s->expression[i].breaks; k++, shown++)
			say(e, "%s%s", shown ? ", " : "", shortest(pieces->breakpoint[shown]));
	say(e, e->model->retuned ? "},  /* breakpoint */\n" : "};\n");
}

static void emit_halvings(const struct emitter *e)
{
	say(e, e->model->retuned ? "    {" : "\nstatic const int $o_halvings[] = {");
	for (int k = 0; k < e->step->branches; k++)
		say(e, "%s%d", k ? ", " : "", e->step->branch[k].halvings);
	say(e, e->model->retuned ? "},  /* halvings */\n" : "};\n");
}

static void emit_region_numbers(const struct emitter *e)
{
	const struct switching *s = regions_of(e);
	say(e, "\n"
	       "static const int $o_matrix[%d] = {  /* of each region%s; -1: its inequalities cannot hold together */\n"
	       "    ",
	    s->regions, regions_change(e) ? ", segment of time by segment" : "");
	for (int r = 0; r < s->regions; r++) {
		int matrix = s->region[r].possible ? s->region[r].system : -1;
		say(e, "%s%d", r == 0 ? "" : r % 20 ? ", " : ",\n    ", matrix);
	}
	say(e, "\n"
	       "};\n");
}

static double *added_of(const struct region_piece *piece) { return piece->added; }
static double *still_of(const struct region_piece *piece) { return piece->still; }

static void emit_own_rows(const struct emitter *e, const struct pieces *pieces, const char *note, int columns,
			  double *(*of)(const struct region_piece *))
{
	say(e, "    {  /* %s */\n", note);
	for (int k = 0; k < e->step->branches; k++)
		for (int i = 0; i < columns; i++)
			say(e, "%s%s%s", i ? ", " : "    {", shortest(of(&pieces->piece[k])[i]),
			    i == columns - 1 ? "},\n" : "");
	say(e, "    },\n");
}

/* By which a step sees over the whole of h that it stays clear */
static void emit_own_look(const struct emitter *e, const struct pieces *pieces, const char **expression)
{
	const struct matrices off = { "chord_off",
				      "times |x|: how far each expression is off its chord over h, at most",
				      regions_of(e)->expressions, expression, off_of };
	emit_matrices(e, pieces, &off);
	if (any_stays(e->step))
		emit_own_rows(e, pieces, "added: over h to each state, by what stays of x", e->system->states,
			      added_of);
	if (any_still(e->step))
		emit_own_rows(e, pieces, "still: to chord_off, by that and by what is never above 1",
			      regions_of(e)->expressions, still_of);
	say(e, "    {");
	for (int i = 0; i < edges_of_regions(regions_of(e)); i++)
		say(e, "%s%s", i ? ", " : "", shortest(pieces->edge[i]));
	say(e, "},  /* edge: breakpoints of each expression less what stays of x, between open ends */\n"
	       "    {");
	for (int k = 0; k < e->step->branches; k++)
		say(e, "%s%s", k ? ", " : "", shortest(pieces->large));
	say(e, "},  /* large: |x| that it has to be below */\n");
}

/* All that an instance has where params are tunable, in the order of its struct; else each a table */
static void emit_numbers_of_regions(const struct emitter *e, const struct pieces *pieces, const struct guards *g)
{
	int size = e->step->layout.size, expressions = regions_of(e)->expressions;
	const char **entry = layout_names(&e->step->layout, e->system, e->model), **expression = expression_names(e);
	const bool rest = keeps_rest(e);
	const char *words = rest ? " in two words" : "";
	if (rest)
		entry = listed_twice(size, entry);
	const struct matrices all[] = {
		{ "slopes", format("x' = A x%s; x = states, load states, inputs", words), size_of_vector(e), entry,
		  slopes_of_piece },
		{ "pieces", format("e^{A h}%s%s", rest ? " - I" : "", words), size_of_vector(e), entry,
		  rest ? gain_of_piece : Phi_of_piece },
		{ "lean", "d/3 times the slope of each expression, d = h 2^-halvings", expressions, expression,
		  slope_of_piece },
		{ "sag", "d^2/8 times its second derivative, at most", expressions, expression, second_of_piece },
		{ "sway", "d^4/384 times its fourth derivative, at most", expressions, expression, fourth_of_piece }
	};
	emit_halvings(e);
	emit_spacing(e);
	if (e->model->retuned) {
		emit_rows(e, pieces);
		emit_breakpoints(e, pieces);
	}
	for (size_t i = 0; i < sizeof all / sizeof *all - (g ? 2 : 0); i++)
		emit_matrices(e, pieces, &all[i]);
	emit_ladder(e, pieces, g);
	if (e->model->retuned && e->step->clears)
		emit_own_look(e, pieces, expression);
	if (g)
		emit_numbers_of_guards(e, g);
}

void emit_regions(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	struct guards *g = has_guards(e) ? NEW(struct guards) : NULL;
	if (g)
		*g = guards_of(e->step, &pieces);
	if (!e->model->retuned)
		emit_rows(e, &pieces);
	emit_break_counts(e);
	if (!e->model->retuned)
		emit_breakpoints(e, &pieces);
	emit_region_numbers(e);
	emit_ladder_places(e, g);
	if (g && e->model->retuned)
		emit_guards(e, g);
	if (e->model->retuned)
		say(e, "\nconst $n_coeffs $n_nominal = {\n    ");
	if (e->model->retuned)
		emit_nominal_params(e);
	emit_numbers_of_regions(e, &pieces, g);
	if (e->model->retuned)
		say(e, "};\n");
	else if (g)
		emit_guards(e, g);
	if (e->step->swift) {
		emit_swift_tables(e, &pieces, expression_names(e));
		emit_crossing(e, &pieces);
	} else if (e->step->clears && !g && is_cleared_by_tables(e->step)) {
		emit_spans(e);
	}
	emit_search(e, ladder_text(e, g));
	if (e->step->swift)
		emit_crossing_macros(e, &pieces);
	say(e, "#include \"search.h\"\n");
}

/* ---- in the model's own functions ---- */

void emit_region_declarations(const struct emitter *e)
{
	say(e, "int    $n_region(const $n *s);           "
	       "/* its number: an interval of each expression, see the source */\n"
	       "uint64_t $n_crossed(const $n *s);        /* breakpoints crossed since init or set */\n"
	       "int    $n_crossings(const $n *s, pl_crossing crossing[$N_MAX_EVENTS]);  "
	       "/* those of the last step; how many */\n");
	if (has_bounces(e->model))
		say(e, "int    $n_rested(const $n *s);           "
		       "/* contacts that came to rest since then, after infinitely many bounces */\n");
}

void emit_region_members(const struct emitter *e)
{
	say(e, "    pl_contact contact;   /* region, crossings */\n"
	       "    pl_crossing crossing[$N_MAX_EVENTS];  /* of the last step */\n");
}

static bool *needed_loads(const struct emitter *e)
{
	bool *needed = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0; l < e->system->loads; l++)
		needed[l] = e->step->layout.load[l] >= 0;
	return needed;
}

/* The inputs in x: in a step the samples that it is given, and the slopes of ramps */
static void emit_inputs_in_x(const struct emitter *e, bool step)
{
	for (int i = 0; i < e->system->inputs; i++) {
		bool ramp = e->system->input[i].hold;
		int at = e->step->layout.input[i], of = place_of_input(e, i);
		say(e, "    x[%d] = %s;\n", at, step && !ramp ? sample_now(e, of) : sample_kept(e, of));
		if (ramp && step)
			say(e, "    x[%d] = %s;\n", at + 1, ramp_slope(e, of));
		else if (ramp)
			say(e, "    x[%d] = 0.0;\n", at + 1);
	}
}

/* Behind x what rounding has taken from it */
static void emit_rests_in_x(const struct emitter *e)
{
	int size = e->step->layout.size;
	say(e, "    for (i = 0; i < %s; i++)\n"
	       "        x[%d + i] = s->rest[%s];\n", own_states(e), size, place_in_loop(e));
	if (size > e->system->states)
		say(e, "    for (i = %d; i < %d; i++)\n"
		       "        x[%d + i] = 0.0;\n", e->system->states, size, size);
}

void emit_region_vector(const struct emitter *e, bool step)
{
	const struct layout *layout = &e->step->layout;
	say(e, "    for (i = 0; i < %s; i++)\n"
	       "        x[i] = s->y[%s];\n", own_states(e), place_in_loop(e));
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && layout->load[l] >= 0; k++) {
			const char *operand = load_operand(e, l, k);
			say(e, "    x[%d] = %s;\n", layout->load[l] + k, operand ? operand : "1.0");
		}
	emit_inputs_in_x(e, step);
	if (keeps_rest(e))
		emit_rests_in_x(e);
}

/* How much the search has to have for work */
static const char *room_text(const struct emitter *e)
{
	int size = e->step->layout.size, degree = e->step->series.degree, n = regions_of(e)->expressions;
	const char *kept = keeps_rest(e) ? "KEPT_" : "";
	return has_guards(e) ? format("PL_GUARDS_%sWORK(%d, %d)", kept, size, degree)
			     : format("PL_SWITCHING_%sWORK(%d, %d, %d)", kept, size, n, degree);
}

/* Whether a region can occur before a change and, by its inequalities, not after it */
static bool any_lost(const struct emitter *e)
{
	const struct switching *s = regions_of(e);
	int in_one = regions_at_once(s);
	bool any = false;
	for (int r = 0; r + in_one < s->regions; r++)
		any = any || !s->region[r + in_one].possible;
	return any;
}

/* What search.h and few.h have in common */
void emit_search(const struct emitter *e, const char *ladder)
{
	const struct switching *s = regions_of(e);
	const char *search = has_guards(e) ? "pl_guards" : "pl_switching", *by = keeps_rest(e) ? "_kept" : "";
	const bool alone = !e->step->shown->parts;
	say(e, "\n#define PL(name) $o_##name\n");
	say_macro(e, "TYPE", spell(e, "$n"));
	say_macro(e, "SINGLE", whole_text(e->model->asked.single));
	say_macro(e, "KEPT", whole_text(keeps_rest(e)));
	say_macro(e, "SIZE", whole_text(e->step->layout.size));
	say_macro(e, "STATES", own_states(e));
	say_macro(e, "ALL", spell(e, "$N_STATES"));
	say_macro(e, "VECTOR", whole_text(size_of_vector(e)));
	say_macro(e, "WORK", room_text(e));
	say_macro(e, "H", spell(e, "$N_H"));
	say_macro(e, "DEGREE", whole_text(e->step->series.degree));
	say_macro(e, "EXPRESSIONS", whole_text(s->expressions));
	say_macro(e, "IMPACTS", whole_text(s->impacts));
	say_macro(e, "MAX_EVENTS", spell(e, s->expressions ? "$N_MAX_EVENTS" : "0"));
	say_macro(e, "MAX_SPLITS", whole_text(has_guards(e) ? max_splits(e->model) : s->expressions ? MAX_SPLITS : 0));
	say_macro(e, "PLACE(i)", place_in_loop(e));
	say_macro(e, "PART", e->place);
	say_macro(e, "SEARCH", search);
	say_macro(e, "START", format("%s%s_start", search, by));
	say_macro(e, "ADVANCE", format("%s%s_advance", search, by));
	say_macro(e, "GUARDS", whole_text(has_guards(e)));
	say_macro(e, "LADDER", ladder);
	say_macro(e, "OWN", whole_text(e->model->retuned != NULL));
	say_macro(e, "SEGMENTS", whole_text(s->segments));
	say_macro(e, "REGIONS", whole_text(regions_at_once(s)));
	if (s->segments > 1) {
		say_macro(e, "LOST", whole_text(any_lost(e)));
		say_macro(e, "UNTIL(s, k)", spell(e, "$n_until(s, k)"));
		say_macro(e, "CHANGE", format("%s%s_change", search, by));
	}
	say_macro(e, "ALONE", whole_text(alone));
	say_macro(e, "BOUNCES", whole_text(has_bounces(e->model)));
}

/* What friction carries now */
static void emit_grip(const struct emitter *e)
{
	if (!e->model->retuned)
		emit_grips(e);
	say(e, "\n"
	       "static double $n_grip(const $n *s, int which)\n"
	       "{\n"
	       "    double x[%d], force;\n"
	       "    int i;\n", size_of_vector(e));
	emit_load_states(e, needed_loads(e), false);
	emit_region_vector(e, false);
	say(e, "    pl_multiply(1, %d, %s[s->contact.region][which], x, &force);\n"
	       "    return force;\n"
	       "}\n", e->step->layout.size, e->model->retuned ? "s->coeffs.grips" : spell(e, "$n_grips"));
}

void declare_region_room(const struct emitter *e)
{
	say(e, "    double x[%d], work[%s];\n", size_of_vector(e), room_text(e));
}

void emit_region_start_call(const struct emitter *e)
{
	say(e, "    $o_start(s, %s, x, &s->contact$p, work);\n", regions_change(e) ? "s->segment" : "0");
}

void emit_region_start(const struct emitter *e)
{
	say(e, "\n"
	       "/* The region of a state */\n"
	       "static void $n_place($n *s)\n"
	       "{\n"
	       "    int i;\n");
	declare_region_room(e);
	emit_turned_loads(e, needed_loads(e), false);
	emit_region_vector(e, false);
	emit_region_start_call(e);
	say(e, "}\n");
	if (regions_of(e)->felts > 0)
		emit_grip(e);
}

void emit_region_status(const struct emitter *e)
{
	say(e, "    s->status |= s->contact$p.status | pl_not_finite(s->y, $N_STATES);\n");
}

/* After a step's end: the segment of time that outputs are in. What sticks and bounces is decided in it already. */
void emit_segment_end(const struct emitter *e)
{
	if (!e->step->parts && has_guards(e) && regions_change(e))
		say(e, "    s->segment = s->contact.region / %d;\n", regions_at_once(regions_of(e)));
	else if (e->system->segments > 1)
		say(e, "    while (s->segment < %d && $n_until(s, s->segment) <= 1e-18 * $N_H)\n"
		       "        s->segment++;\n", e->system->segments - 1);
}

void declare_region_vector(const struct emitter *e)
{
	say(e, "    double x[%d];\n"
	       "    int i;\n", size_of_vector(e));
}

static void emit_searched_step(const struct emitter *e)
{
	declare_region_vector(e);
	emit_set_aside(e);
	emit_turned_loads(e, needed_loads(e), false);
	emit_region_vector(e, true);
	say(e, "    $o_seek(s, x);\n");
	emit_take_back(e);
	emit_step_end(e);
	emit_segment_end(e);
}

static void emit_whole_step(const struct emitter *e)
{
	bool *all = ARRAY(bool, (size_t)e->system->states);
	for (int i = 0; i < e->system->states; i++)
		all[i] = true;
	emit_set_aside(e);
	emit_raw_locals(e, all);
	emit_turned_loads(e, needed_loads(e), false);
	emit_clear_step(e);
	emit_take_back(e);
	emit_step_end(e);
	emit_segment_end(e);
}

void emit_region_step(const struct emitter *e)
{
	say(e, "\n"
	       "void $n_step(%s)\n"
	       "{\n",
	    step_parameters(e));
	if (e->step->clears)
		emit_whole_step(e);
	else
		emit_searched_step(e);
	if (e->step->carries)           /* what was set aside is in no bound */
		emit_region_status(e);
	say(e, "}\n");
}

void emit_region_at(const struct emitter *e)
{
	const char *u = given_inputs(e) ? format("const double u[%s_INPUTS], ", e->upper) : "";
	say(e, "\n"
	       "void $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n"
	       "    pl_contact contact = s->contact;\n"
	       "    pl_crossing crossing[$N_MAX_EVENTS];\n", u);
	declare_region_vector(e);
	if (has_guards(e))              /* what is held is put back to its place, off by rounding, in no time too */
		emit_at_start(e);
	emit_load_states(e, needed_loads(e), false);
	emit_region_vector(e, true);
	say(e, "    $o_search(s, tau, x, &contact, crossing);\n");
	emit_hand_over(e);
	say(e, "}\n");
}
