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

/* The descriptor of the search: static, or `tables` */
static const char *descriptor_of(const struct emitter *e)
{
	return e->model->retuned ? "&tables" : spell(e, "&$o_switching");
}

static void declare_descriptor(const struct emitter *e)
{
	if (e->model->retuned && !regions_change(e))
		say(e, "    const %s tables = $o_switching(&s->coeffs);\n", search_of(e));
}

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

/* In a segment of time, or always */
static void emit_switching_in(const struct emitter *e, const char *row, const char *indent)
{
	const char *of = prefix_of_tables(e);
	say(e, "%s    %d, $N_H, %d, %s, $o_breaks, %sbreakpoint, $o_matrix, %shalvings,\n"
	       "%s    %sslopes[0][0], %spieces[0][0],\n"
	       "%s    %s,\n"
	       "%s    %slean[0][0], %ssag[0][0], %ssway[0][0], %d, $N_MAX_EVENTS, %d\n",
	    indent, e->step->layout.size, regions_of(e)->expressions, row, of, of, indent, of, of, indent,
	    ladder_text(e, NULL, format("%sslopes[0][0]", of)), indent, of, of, of, e->step->series.degree, MAX_SPLITS);
}

/* Of tunable tables it is made anew for each call: an instance that is copied would have to point into itself. */
static void emit_switching(const struct emitter *e)
{
	bool several = regions_change(e), own = e->model->retuned;
	const char *of = prefix_of_tables(e);
	if (own)
		say(e, "\n/* What the search goes by%s */\n"
		       "static pl_switching $o_switching(const $n_coeffs *c%s)\n"
		       "{\n"
		       "    const pl_switching tables = {\n",
		    several ? ", in a segment of time" : "", several ? ", int segment" : "");
	else
		say(e, "\nstatic const pl_switching $o_switching%s = {\n",
		    several ? format("[%d]", regions_of(e)->segments) : "");
	if (own || !several)
		emit_switching_in(e, format("%srow%s[0]", of, several ? "[segment]" : ""), own ? "    " : "");
	for (int k = 0; k < regions_of(e)->segments && several && !own; k++) {
		say(e, "  {\n");
		emit_switching_in(e, spell(e, "$o_row[%d][0]", k), "");
		say(e, "  },\n");
	}
	say(e, own ? "    };\n"
		     "    return tables;\n"
		     "}\n"
		   : "};\n");
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
	if (g)
		emit_guards_descriptor(e, g);
	else
		emit_switching(e);
	if (regions_change(e))
		emit_region_changes(e);
	if (e->step->swift)
		emit_swift_tables(e, &pieces, expression_names(e));
	else if (e->step->clears && !g && is_cleared_by_tables(e->step))
		emit_spans(e);
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
	int size = e->step->layout.size, degree = e->step->series.degree;
	const char *kept = keeps_rest(e) ? "KEPT_" : "";
	return has_guards(e) ? format("PL_GUARDS_%sWORK(%d, %d)", kept, size, degree)
			     : format("PL_SWITCHING_%sWORK(%d, %d, %d)", kept, size, regions_of(e)->expressions, degree);
}

void declare_region_room(const struct emitter *e)
{
	say(e, "    double x[%d], work[%s];\n", size_of_vector(e), room_text(e));
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

void emit_region_start(const struct emitter *e)
{
	say(e, "\n"
	       "/* The region of a state */\n"
	       "static void $n_place($n *s)\n"
	       "{\n"
	       "    int i;\n");
	declare_region_room(e);
	declare_descriptor(e);
	emit_turned_loads(e, needed_loads(e), false);
	emit_region_vector(e, false);
	emit_region_start_call(e);
	say(e, "}\n");
	if (regions_of(e)->felts > 0)
		emit_grip(e);
}

void emit_region_start_call(const struct emitter *e)
{
	if (regions_change(e))
		say(e, "    $o_start(%ss->segment, x, &s->contact$p, work);\n",
		    e->model->retuned ? "&s->coeffs, " : "");
	else
		say(e, "    %s_start(%s, x, &s->contact$p, work);\n", search_by(e), descriptor_of(e));
}

static void emit_region_questions(const struct emitter *e)
{
	say(e, "\n"
	       "int $n_region(const $n *s)\n"
	       "{\n"
	       "    return s->contact.region%s;\n"
	       "}\n"
	       "\n"
	       "uint64_t $n_crossed(const $n *s)\n"
	       "{\n"
	       "    return s->contact.total;\n"
	       "}\n"
	       "\n"
	       "int $n_crossings(const $n *s, pl_crossing crossing[$N_MAX_EVENTS])\n"
	       "{\n"
	       "    const int count = s->contact.crossings < $N_MAX_EVENTS ? s->contact.crossings : $N_MAX_EVENTS;\n"
	       "    int i;\n"
	       "    for (i = 0; i < count; i++)\n"
	       "        crossing[i] = s->crossing[i];\n"
	       "    return count;\n"
	       "}\n", regions_change(e) ? format(" %% %d", regions_at_once(e->model->switching)) : "");
	if (has_bounces(e->model))
		say(e, "\n"
		       "int $n_rested(const $n *s)\n"
		       "{\n"
		       "    return s->contact.rested;\n"
		       "}\n");
}

/* By the search, from x; `i` is declared */
void emit_search(const struct emitter *e)
{
	if (regions_change(e))
		say(e, "    $o_pass_changes(s, $N_H, x, &s->contact$p, s->crossing$p, work);\n");
	else
		say(e, "    %s_step(%s, x, &s->contact$p, s->crossing$p, work);\n", search_by(e), descriptor_of(e));
	emit_state_of_x(e);
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

static void emit_searched_step(const struct emitter *e)
{
	say(e, "    int i;\n");
	declare_region_room(e);
	declare_descriptor(e);
	emit_set_aside(e);
	emit_turned_loads(e, needed_loads(e), false);
	emit_region_vector(e, true);
	emit_search(e);
	emit_take_back(e);
	emit_step_end(e);
	emit_segment_end(e);
	emit_region_status(e);
}

/* What is not seen to be clear, or to cross as little as may be */
void emit_region_search(const struct emitter *e)
{
	say(e, "\n"
	       "static PL_APART void $o_seek($n *s, double x[%d])\n"
	       "{\n"
	       "    double work[%s];\n"
	       "    int i;\n", size_of_vector(e), room_text(e));
	declare_descriptor(e);
	emit_search(e);
	emit_region_status(e);
	say(e, "}\n");
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
	if (e->step->carries)           /* what was set aside is in no bound */
		emit_region_status(e);
}

void emit_region_step(const struct emitter *e)
{
	if (e->step->swift)
		emit_crossing(e);
	if (e->step->clears)
		emit_region_search(e);
	say(e, "\n"
	       "void $n_step(%s)\n"
	       "{\n",
	    step_parameters(e));
	if (e->step->clears)
		emit_whole_step(e);
	else
		emit_searched_step(e);
	say(e, "}\n");
	emit_region_questions(e);
}

/* x on by tau; `contact` and `crossing` are declared */
void emit_region_advance_call(const struct emitter *e)
{
	if (regions_change(e))
		say(e, "    $o_pass_changes(s, tau, x, &contact, crossing, work);\n");
	else
		say(e, "    %s_advance(%s, tau, x, &contact, crossing, work);\n", search_by(e), descriptor_of(e));
}

void emit_region_at(const struct emitter *e)
{
	const char *u = given_inputs(e) ? format("const double u[%s_INPUTS], ", e->upper) : "";
	say(e, "\n"
	       "void $n_at(const $n *s, %sdouble tau, double y[$N_STATES])\n"
	       "{\n"
	       "    pl_contact contact = s->contact;\n"
	       "    pl_crossing crossing[$N_MAX_EVENTS];\n"
	       "    int i;\n",
	    u);
	declare_region_room(e);
	declare_descriptor(e);
	if (has_guards(e))              /* what is held is put back to its place, off by rounding, in no time too */
		emit_at_start(e);
	emit_load_states(e, needed_loads(e), false);
	emit_region_vector(e, true);
	emit_region_advance_call(e);
	emit_hand_over(e);
	say(e, "}\n");
}
