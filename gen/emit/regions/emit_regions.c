/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A piecewise-linear model as C: tables of its regions, and a step that leaves finding crossings to the runtime. */
#include "inner.h"
#include "emit/steps.h"
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "step/regions/guards.h"

#include <string.h>

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

static const char **function_names_of_regions(const struct emitter *e)
{
	const struct switching *s = regions_of(e), *shown = e->step->shown->model->switching;
	const char **name = ARRAY(const char *, (size_t)s->functions);
	for (int i = 0; i < s->functions; i++)
		name[i] = form_text(e->step->shown->model,
				    shown->function[e->part ? e->part->function[i] : i].form);
	return name;
}

/* A matrix of each region */
struct matrices {
	const char *name, *note;
	int rows;
	const char **row_name;
	size_t of;
};

#define EVENT_FUNCTIONS "Switching functions, e = row . x; where one passes a breakpoint the equations change"

static void emit_rows(const struct emitter *e, const struct pieces *pieces)
{
	const struct switching *s = regions_of(e);
	int size = e->step->layout.size;
	if (regions_change(e))
		put_matrices(e, "row", EVENT_FUNCTIONS ", in each segment of time", s->segments,
			      s->functions, size, pieces->rows, function_names_of_regions(e));
	else
		put_matrix(e, "row", EVENT_FUNCTIONS, s->functions, size, pieces->row,
			    function_names_of_regions(e));
}

static int breaks_of(const struct emitter *e, int *breaks)
{
	const struct switching *s = regions_of(e);
	int all = 0;
	for (int i = 0; i < s->functions; i++)
		all += breaks[i] = s->function[i].breaks;
	return all;
}

static void emit_breaks(const struct emitter *e, const struct pieces *pieces, bool own)
{
	int *breaks = ARRAY(int, (size_t)functions_of(e)), all = breaks_of(e, breaks);
	if (!own)
		put_wholes(e, false, "breaks",
			     "How many breakpoints each switching function has", functions_of(e), breaks);
	if (own || !e->model->params.retuned)
		put_numbers(e, "breakpoint",
			     "The breakpoints, in rising order, of one switching function after the other",
			     all, pieces->breakpoint);
}

static void emit_halvings(const struct emitter *e)
{
	int *halvings = ARRAY(int, (size_t)e->step->branches);
	for (int k = 0; k < e->step->branches; k++)
		halvings[k] = e->step->branch[k].halvings;
	put_wholes(e, e->model->params.retuned, "halvings",
		     "Events are looked for in pieces of d = h/2^halvings, so short that the fastest pole of each "
		   "linear system does not turn far", e->step->branches, halvings);
}

static void emit_region_numbers(const struct emitter *e)
{
	const struct switching *s = regions_of(e);
	int *matrix = ARRAY(int, (size_t)s->regions);
	for (int r = 0; r < s->regions; r++)
		matrix[r] = s->region[r].possible ? s->region[r].system : -1;
	put_wholes(e, false, "matrix",
		     "Linear system of each region; -1: its inequalities cannot hold together",
		     s->regions, matrix);
}

/* By which a step sees over the whole of h that it is event-free */
static void emit_own_check(const struct emitter *e, const struct pieces *pieces, const char **function)
{
	int n = functions_of(e);
	double *large = ARRAY(double, (size_t)e->step->branches);
	for (int k = 0; k < e->step->branches; k++)
		large[k] = pieces->large;
	put_matrices(e, "chord_off", CHORD_NOTE,
		      e->step->branches, n, e->step->layout.size, of_branches(e, pieces, OF_PIECE(off)), function);
	if (any_stays(e->step))
		emit_of_branches(e, pieces, "added",
			     "What the constant entries of x add to each state over h", e->system->states,
				 OF_PIECE(added));
	if (any_still(e->step))
		emit_of_branches(e, pieces, "still",
			     "What these, and entries of x that are never above 1, add to chord_off", n,
				 OF_PIECE(still));
	put_numbers(e, "edge", "Breakpoints of each switching function less what constant entries of x add to it, "
		     "between open ends",
		     edges_of_regions(regions_of(e)), pieces->edge);
	put_numbers(e, "large", "Limit of |x|, below which no bound overflows", e->step->branches, large);
}

/* All that an instance has where params are tunable, in the order of its struct; else each a table */
static void emit_numbers_of_regions(const struct emitter *e, const struct pieces *pieces, const struct guards *g)
{
	int size = e->step->layout.size, functions = regions_of(e)->functions;
	const char **entry = layout_names(&e->step->layout, e->system, e->model),
		**function = function_names_of_regions(e);
	const bool rest = is_compensated(e);
	const char *words = rest ? " in two words" : "";
	if (rest)
		entry = listed_twice(size, entry);
	const struct matrices all[] = {
		{ "slopes", format("A of each linear system, x' = A x%s; x = states, load states, inputs", words),
		  size_of_vector(e), entry, OF_PIECE(slopes) },
		{ "pieces", format("Transfer matrix of each linear system over a step: e^{A h}%s%s",
				   rest ? " - I" : "", words),
		  size_of_vector(e), entry, rest ? OF_PIECE(gain) : OF_PIECE(Phi) },
		{ "tangent", "Slope of each switching function along the solution: this row times x is d/3 e', "
			  "d = h/2^halvings", functions, function, OF_PIECE(slope) },
		{ "chord_error", "Bound of its curvature: within d, e leaves its chord by at most d^2/8 |e''|, "
			 "this row times |x|", functions, function, OF_PIECE(second) },
		{ "cubic_error", "Bound of its fourth derivative: e leaves the cubic through its ends and slopes by at "
			  "most d^4/384 |e''''|, this row times |x|", functions, function, OF_PIECE(fourth) }
	};
	emit_halvings(e);
	emit_spacing(e);
	if (e->model->params.retuned) {
		emit_rows(e, pieces);
		emit_breaks(e, pieces, true);
	}
	for (size_t i = 0; i < sizeof all / sizeof *all - (g ? 2 : 0); i++)
		put_matrices(e, all[i].name, all[i].note, e->step->branches, all[i].rows, size,
			      of_branches(e, pieces, all[i].of), all[i].row_name);
	emit_ladder(e, pieces, g);
	if (e->model->params.retuned && e->step->regions.event_check.is_made)
		emit_own_check(e, pieces, function);
	if (g)
		emit_numbers_of_guards(e, g);
	if (e->model->params.retuned && regions_of(e)->transmitted_forces > 0)
		emit_friction_forces(e);
	if (e->model->params.retuned)
		emit_own_variation(e, g);
}

void emit_retuned_numbers(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	const struct guards g = has_guards(e) ? guards_of(e->step, &pieces) : (struct guards){ 0 };
	emit_nominal_params(e);
	emit_numbers_of_regions(e, &pieces, has_guards(e) ? &g : NULL);
}

void emit_regions(const struct emitter *e)
{
	struct pieces pieces = pieces_of(e->step);
	struct guards *g = has_guards(e) ? NEW(struct guards) : NULL;
	if (g)
		*g = guards_of(e->step, &pieces);
	if (!e->model->params.retuned)
		emit_rows(e, &pieces);
	emit_breaks(e, &pieces, false);
	if (regions_of(e)->cached) {
		emit_cached(e, g);
		emit_search(e, cached_ladder);
		say_include(e, "search.h");
		return;
	}
	emit_region_numbers(e);
	emit_ladder_places(e, g);
	if (g && e->model->params.retuned)
		emit_guards(e, g);
	if (e->model->params.retuned)
		emit_nominal_of(e, emit_retuned_numbers);
	else
		emit_numbers_of_regions(e, &pieces, g);
	if (g && !e->model->params.retuned)
		emit_guards(e, g);
	if (e->step->regions.event_check.fast_path) {
		emit_fast_path_tables(e, &pieces, function_names_of_regions(e));
		emit_crossing(e, &pieces);
	} else if (e->step->regions.event_check.is_made && !g && is_checked_by_tables(e->step)) {
		emit_spans(e);
	}
	emit_variation(e, g);
	emit_search(e, ladder_text(e, g));
	if (e->step->regions.event_check.fast_path)
		emit_crossing_macros(e, &pieces);
	say_include(e, "search.h");
}

/* ---- in the model's own functions ---- */

void emit_region_members(const struct emitter *e)
{
	say(e, "    pl_contact contact;   /* region, crossings */\n"
	       "    pl_crossing crossing[$N_MAX_EVENTS];  /* of the last step */\n");
	emit_cached_member(e);
}

static bool *needed_loads(const struct emitter *e)
{
	bool *needed = ARRAY(bool, (size_t)e->system->loads);
	for (int l = 0; l < e->system->loads; l++)
		needed[l] = e->step->layout.load[l] >= 0;
	return needed;
}

/* The inputs in x: in a step the samples that it is given, and the slopes of ramps; else the last ones */
static void emit_inputs_in_x(const struct emitter *e, bool step)
{
	for (int i = 0; i < e->system->inputs; i++) {
		bool ramp = e->system->input[i].hold;
		int at = e->step->layout.input[i], of = place_of_input(e, i);
		say(e, "    x[%d] = %s;\n", at, step && !ramp ? sample_now(e, of) : sample_kept(e, of));
		if (ramp && step)
			say(e, "    x[%d] = %s;\n", at + 1, ramp_slope(e, of));
		else if (ramp)
			say(e, "    x[%d] = s->slope[%d];\n", at + 1, of);
	}
}

/* Behind x what rounding has taken from it */
static void emit_rests_in_x(const struct emitter *e)
{
	int size = e->step->layout.size;
	say(e, "    for (i = 0; i < %s; i++) { x[%d + i] = s->low[%s]; }\n", own_states(e), size, place_in_loop(e));
	if (size > e->system->states)
		say(e, "    for (i = %d; i < %d; i++) { x[%d + i] = 0.0; }\n", e->system->states, size, size);
}

void emit_region_vector(const struct emitter *e, bool step)
{
	const struct layout *layout = &e->step->layout;
	say(e, "    for (i = 0; i < %s; i++) { x[i] = s->y[%s]; }\n", own_states(e), place_in_loop(e));
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && layout->load[l] >= 0; k++) {
			const char *operand = load_operand(e, l, k);
			say(e, "    x[%d] = %s;\n", layout->load[l] + k, operand ? operand : "1.0");
		}
	emit_inputs_in_x(e, step);
	if (is_compensated(e))
		emit_rests_in_x(e);
}

/* How much the search has to have for work */
static const char *room_text(const struct emitter *e)
{
	int size = e->step->layout.size, degree = e->step->series.degree, n = regions_of(e)->functions;
	const char *kept = is_compensated(e) ? "COMPENSATED_" : "";
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

void begin_macros(const struct emitter *e, const char *algorithm, const char *own)
{
	say_purpose(e, algorithm);
	say(e, "#define PL(name) %s_##name\n", own);
	say_macro(e, "TYPE", e->name);
	say_macro(e, "SINGLE", integer_text(e->model->request.single));
}

/* Bit i where entry i of x is never above 1; none in a long x, whose sums are loops */
static int capped_entries(const struct emitter *e)
{
	int bits = 0;
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && is_bounded_load(e->step, l); k++)
			bits |= e->step->layout.size <= 16 ? 1 << (e->step->layout.load[l] + k) : 0;
	return bits;
}

/* What search.h and few.h have in common, as numbers */
static void emit_search_sizes(const struct emitter *e)
{
	const struct switching *s = regions_of(e);
	const bool switches = s->functions > 0;
	const struct size all[] = {
		{ "COMPENSATED", is_compensated(e) }, { "SIZE", e->step->layout.size }, { "VECTOR", size_of_vector(e) },
		{ "DEGREE", e->step->series.degree }, { "SWITCHING_FUNCTIONS", s->functions },
		{ "IMPACTS", s->impacts },
		{ "MAX_SPLITS", switches || has_guards(e) ? max_splits(e->model) : 0 },
		{ "MOST_EVENTS", most_in_step(e->model) }, { "GUARDS", has_guards(e) },
		{ "OWN", e->model->params.retuned != NULL }, { "SEGMENTS", s->segments },
		{ "REGIONS", region_numbers(s) }, { "LOST", any_lost(e) },
		{ "ALONE", !e->step->shown->regions.parts && switches },
		{ "BOUNCES", has_bounces(e->model) }, { "EVENT_FREE", e->step->regions.event_check.is_made },
		{ "CAPPED", capped_entries(e) }
	};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		say_macro(e, all[i].name, integer_text(all[i].value));
}

void emit_search(const struct emitter *e, const char *ladder)
{
	const char *search =
		format("%s%s", has_guards(e) ? "pl_guards" : "pl_switching", is_compensated(e) ? "_compensated" : "");
	const char *varied = has_variation(e) ? "_d" : "";
	begin_macros(e, "search.h", e->spelled.own);
	emit_search_sizes(e);
	say_macro(e, "STATES", own_states(e));
	say_macro(e, "ALL", spell(e, "$N_STATES"));
	say_macro(e, "WORK", room_text(e));
	say_macro(e, "H", spell(e, "$N_H"));
	/* each part lists its own */
	say_macro(e, "MAX_EVENTS", functions_of(e) == 0 ? "0" : e->step->shown->regions.parts
		  ? integer_text(max_events(e->model)) : spell(e, "$N_MAX_EVENTS"));
	say_macro(e, "PLACE(i)", place_in_loop(e));
	say_macro(e, "PART", e->spelled.place);
	say_macro(e, "LADDER", ladder);
	say_macro(e, "SEARCH", has_guards(e) ? "pl_guards" : "pl_switching");
	say_macro(e, "START", format("%s_start%s", search, varied));
	say_macro(e, "ADVANCE", format("%s_advance%s", search, varied));
	emit_variation_macros(e);
	if (has_variation(e) && e->step->regions.event_check.fast_path)
		say_macro(e, "FOLLOW", format("%s_follow_d", search));
	if (regions_of(e)->cached)
		emit_cached_macros(e);
	if (!regions_change(e))
		return;
	say_macro(e, "CHANGE", format("%s_change%s", search, varied));
	say_macro(e, "UNTIL(s, k)", spell(e, "$n_until(s, k)"));
}

void declare_region_vector(const struct emitter *e)
{
	say(e, "    double x[%d];\n"
	       "    int i;\n", size_of_vector(e));
}

/* What friction carries now */
static void emit_friction_force(const struct emitter *e)
{
	if (!e->model->params.retuned)
		emit_friction_forces(e);
	open_function(e, NULL, "static double $n_friction_force(const $n *s, int which)");
	say(e, "    double force;\n");
	declare_region_vector(e);
	emit_load_states(e, needed_loads(e), false);
	emit_region_vector(e, false);
	say(e, "    pl_multiply(1, %d, %s[s->contact.region][which], x, &force);\n"
	       "    return force;\n", e->step->layout.size,
	    e->model->params.retuned ? "s->coeffs.friction_forces" : spell(e, "$o_friction_forces"));
	close_function(e, "");
}

void declare_region_room(const struct emitter *e)
{
	declare_region_vector(e);
	say(e, "    double work[%s];\n", room_text(e));
}

void emit_region_start_call(const struct emitter *e)
{
	say(e, "    $o_begin_contact(s, %s, x, &s->contact$p, work);\n", regions_change(e) ? "s->segment" : "0");
}

void emit_region_start(const struct emitter *e)
{
	open_function(e, "The region of a state", "static void $n_place($n *s)");
	declare_region_room(e);
	emit_rotated_loads(e, needed_loads(e), false);
	emit_region_vector(e, false);
	emit_cached_start(e);
	emit_region_start_call(e);
	close_function(e, "");
	if (regions_of(e)->transmitted_forces > 0)
		emit_friction_force(e);
}

static void emit_region_status(const struct emitter *e)
{
	say(e, "    s->status |= s->contact$p.status | pl_not_finite(s->y, $N_STATES);\n");
}

/* After a step's end: the segment of time that outputs are in. What sticks and bounces is decided in it already. */
void emit_segment_end(const struct emitter *e)
{
	if (!e->step->regions.parts && has_guards(e) && regions_change(e))
		say(e, "    s->segment = s->contact.region / %d;\n", regions_at_once(regions_of(e)));
	else if (loads_change(e->system))
		say(e, "    $n_pass_segments(s);\n");
}

void emit_seek(const struct emitter *e)
{
	if (!shares_step(e)) {
		say(e, "    $o_seek(s, x);\n");
	} else if (has_guards(e) && e->step->regions.event_check.is_made) {
		say(e, "    if ($o_unmet_here(s, x)) {\n");
		emit_shared_call(e, "vary_clear", "x");
		say(e, "    } else {\n");
		emit_shared_search(e, "x", "seek_again");
		say(e, "    }\n");
	} else {
		emit_shared_search(e, "x", "seek");
	}
}

/* ---- the same over lanes of a batch ---- */

void emit_shared_of_regions(const struct emitter *e)
{
	const struct layout *layout = &e->step->layout;
	const char **x = operands_of_x(e);
	open_function(e, "now receives what all instances share in this step; time then advances by h",
		      "static void $n_share_step($n *s, const double *u, double *now)");
	for (int i = 0; i < e->system->inputs && has_guards(e); i++)
		if (e->system->input[i].hold)
			x[layout->input[i] + 1] = ramp_slope(e, place_of_input(e, i));
	if (!has_guards(e))
		emit_slopes_of_ramps(e);
	emit_rotated_loads(e, needed_loads(e), false);
	for (int j = e->system->states; j < layout->size; j++)
		say(e, "    now[%d] = %s;\n", j - e->system->states, *x[j] ? x[j] : "1.0");
	emit_step_end(e);
	close_function(e, "u now");
}

void emit_lanes_of_regions(const struct emitter *e)
{
	if (!has_guards(e)) {
		emit_lanes_check(e);
		return;
	}
	int params;
	params_in_x(e, &params);
	emit_sizes(e, "unmet_lanes.h", { "STATES", e->system->states }, { "SIZE", e->step->layout.size },
		   { "LANES", params }, { "REGIONS", regions_of(e)->regions }, { "CAPPED", capped_entries(e) });
	say(e, "#include \"unmet_lanes.h\"\n");
}

/* ---- how an event is found ---- */

#define note(e, ...) say_words(e, spell(e, __VA_ARGS__))

/* Of the file, or of an instance */
static const char *table(const struct emitter *e, const char *name)
{
	return e->model->params.retuned ? format("s->coeffs.%s", name)
	       : regions_of(e)->cached && !strstr("row breakpoint", name) ? format("s->cached.%s", name)
		       : format("%s_%s", e->spelled.own, name);
}

/* What ends a region */
static const char *event_text(const struct emitter *e)
{
	if (!has_guards(e))
		return "An event is a crossing of a breakpoint.";
	return spell(e, "Between two equal ones friction sticks or a contact rests, and states are held (%s). Each "
		    "region has guards ($o_guard): an event is where a guard function g = guard_row . x (%s) rises to "
		    "its limit (%s): what slips comes to rest, what sticks is pulled by more than it can hold, a stop "
		    "is reached, a contact lets go.", table(e, "value"), table(e, "guard_row"), table(e, "limit"));
}

/* How most steps are seen to have none, and what else there is before the search */
static void note_event_free_steps(const struct emitter *e, const char *function, const char *second)
{
	if (e->step->regions.event_check.is_made)
		note(e,
		     "1. The whole step is tried: x becomes e^{A h} x. Within it %s leaves the chord through its "
			"ends by at most h^2/8 times its largest second derivative, which a row times |x| bounds (as "
			"%s does). Where the chord keeps further than that from %s, nothing happens: that is the step.",
		     function, second, has_guards(e) ? "the limit" : "the breakpoints");
	else
		note(e, "1. Every step goes by the search.");
	if (e->step->regions.event_check.fast_path)
		note(e, "2. $o_cross: up to %d crossings by the Taylor polynomial of x in time, of degree %d "
			"($o_move). A root of e - b is taken where bounds of the third and fourth derivative ($o_jerk, "
			"$o_cubic_error) and of rounding ($o_slack) show that it is the first; else nothing is "
			"changed, and 3 follows.", fast_path_events(e->model), e->step->regions.event_check.degree);
}

static void note_search(const struct emitter *e, const char *function, const char *of)
{
	note(e, "%d. $o_seek, the search (%s): the step goes in pieces of d = h/2^halvings or longer ones. A bound "
		"shows a piece to be event-free: of the chord, d^2/8 |%s''| (%s), or of the cubic through its ends "
		"and slopes (%s), d^4/384 |%s''''| (%s). In any other piece %s is a Taylor polynomial in time: "
		"intervals are halved until bounds of its derivatives show that there is no root or one, so none is "
		"stepped over, and the first is computed to rounding.",
	     e->step->regions.event_check.fast_path ? 3 : 2, has_guards(e) ? "guards.c" : "crossings.c", function,
	     table(e, format("%schord_error", of)), table(e, format("%stangent", of)), function,
	     table(e, format("%scubic_error", of)), function);
}

void emit_event_note(const struct emitter *e)
{
	const bool guards = has_guards(e);
	const char *function = guards ? "g" : "e", *of = guards ? "guard_" : "";
	say(e, "\n/* How an event is found\n *\n");
	note(e, "Between events the model is linear: x' = A x (%s), x being the states and the loads that act on them, "
		"so that a step is a product with e^{A h} (%s).", table(e, "slopes"), table(e, "pieces"));
	note(e, "Switching functions e = row . x (%s) divide the states into regions, by their breakpoints (%s). %s",
	     table(e, "row"), table(e, "breakpoint"), event_text(e));
	note_event_free_steps(e, function, table(e, format("%schord_error", of)));
	note_search(e, function, of);
	if (regions_of(e)->cached)
		note(e, "Matrices are made when their regions are met: A as a sum ($o_sum), e^{A h} and bounds of it, "
			"which s->cached keeps of the last %d.", slots_of(e->step));
	note(e, "At an event %s, and the step goes on in the region behind%s.",
	     !guards ? "the state is taken there" : e->model->switching->impacts > 0
			? "impacts turn the approach speed s to -restitution s, the combination of sticking and "
			  "slipping that contradicts no force is taken"
			: "the combination of sticking and slipping that contradicts no force is taken",
	     regions_of(e)->cached ? "" : spell(e, " ($o_matrix)"));
	note(e, "A breakpoint passed by less than rounding errors is no event. $n_crossings lists those of a step; "
		"more than $N_MAX_EVENTS set PL_TOO_MANY_EVENTS.");
	say(e, " */\n");
}

void declare_region_search(const struct emitter *e)
{
	say(e, "\n"
	       "/* The search for events over a step, or over its remaining part */\n"
	       "static void $o_seek($n *s, double x[%d]);\n", size_of_vector(e));
	if (shares_step(e) && has_guards(e) && e->step->regions.event_check.is_made)
		say(e, "static int $o_unmet_here($n *s, double x[%d]);\n"
		       "static void $o_seek_again($n *s, const double x[%d]);\n", size_of_vector(e), size_of_vector(e));
	if (e->step->regions.event_check.fast_path)
		say(e, "/* Follows the events of a step if they are few and certain: 1; else s is unchanged: 0 */\n"
		       "static int $o_cross($n *s, const double now[%d]);\n", size_of_vector(e));
}

void emit_region_step(const struct emitter *e)
{
	const bool checked = e->step->regions.event_check.is_made && !has_guards(e);
	if (shares_step(e)) {
		declare_shared_step(e);
		open_shared_step(e);
	} else {
		open_function(e, NULL, "%s", head_of_step(e));
	}
	if (!checked)
		declare_region_vector(e);
	emit_set_aside(e);
	if (checked)
		emit_raw_locals(e, NULL);
	emit_rotated_loads(e, needed_loads(e), false);
	if (checked) {
		emit_event_check(e);
	} else {
		emit_region_vector(e, true);
		emit_seek(e);
	}
	emit_take_back(e);
	emit_step_end(e);
	emit_segment_end(e);
	if (e->step->carried.count)           /* saved states are in no bound */
		emit_region_status(e);
	shares_step(e) ? close_shared_step(e) : close_function(e, "");
}

void emit_region_at(const struct emitter *e)
{
	const char *u = given_inputs(e) ? format("const double u[%s_INPUTS], ", e->upper) : "";
	open_function(e, NULL, "void $n_at(const $n *s, %sdouble tau, double y[$N_STATES])", u);
	say(e, "    pl_contact contact = s->contact;\n"
	       "    pl_crossing crossing[$N_MAX_EVENTS];\n");
	declare_region_vector(e);
	if (has_guards(e))              /* what is held is put back to its place, off by rounding, in no time too */
		emit_at_start(e);
	emit_load_states(e, needed_loads(e), false);
	emit_region_vector(e, true);
	say(e, "    $o_search_step(s, tau, x, &contact, crossing%s);\n", no_variation(e));
	emit_hand_over(e);
	close_function(e, "");
}
