/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A piecewise-linear model of independent parts as C: each part's tables and functions as if it were alone, and what
 * makes one model of them. */
#include "inner.h"
#include "emit/steps.h"
#include "model/regions/regions.h"
#include "step/regions/guards.h"

static const struct switching *regions_of(const struct emitter *part)
{
	return part->model->switching;
}

static bool is_linear_step(const struct step *part)
{
	return part->model->switching->functions == 0;
}

static bool is_linear_part(const struct emitter *part)
{
	return is_linear_step(part->step);
}

static int first_of_degree(const struct emitter *e, int index)
{
	struct step **part = e->step->regions.part;
	int first = 0;
	while (is_linear_step(part[first]) || !part[first]->regions.event_check.fast_path ||
	       part[first]->regions.event_check.degree != part[index]->regions.event_check.degree)
		if (first++ == index)
			return index;
	return first;
}

static struct emitter part_of(const struct emitter *e, int index)
{
	struct emitter part = *e;
	part.part = &e->model->switching->part[index];
	part.model = part.part->model;
	part.step = e->step->regions.part[index];
	part.system = &part.step->branch->system;
	part.spelled.own = format("%s_part%d", e->name, index);
	part.spelled.place = format("[%d]", index);
	part.spelled.degree = format("%s_part%d", e->name, first_of_degree(e, index));
	part.local = ARRAY(const char *, (size_t)part.system->states);
	for (int i = 0; i < part.system->states; i++)
		part.local[i] = e->local[part.part->state[i]];
	return part;
}

/* The linear part, the last, has none. */
static int switched_parts(const struct emitter *e)
{
	int parts = e->step->regions.parts;
	return parts - is_linear_step(e->step->regions.part[parts - 1]);
}

void for_parts(const struct emitter *e, int count, void (*emit)(const struct emitter *part))
{
	for (int p = 0; p < count; p++) {
		const struct emitter part = part_of(e, p);
		emit(&part);
	}
}

void emit_event_note_of_parts(const struct emitter *e)
{
	for_parts(e, 1, emit_event_note);
}

/* ---- tables ---- */

/* What each region of the part adds to the number of the model's */
static void emit_shares(const struct emitter *part, const struct switching *full)
{
	const struct switching *s = regions_of(part);
	int *share = ARRAY(int, (size_t)s->regions);
	for (int r = 0; r < s->regions; r++)
		share[r] = share_of_region(part->part, full, r);
	put_wholes(part, false, "share",
		     "What each region of the part adds to the number of the model's region", s->regions, share);
	put_wholes(part, false, "number",
		     "Numbers of its switching functions among the model's", s->functions, part->part->function);
}

/* Of a state in two words each matrix has second ones behind the first */
static const char **names_of_rows(const struct emitter *part)
{
	const char **name = layout_names(&part->step->layout, part->system, part->model);
	return is_compensated(part) ? listed_twice(part->step->layout.size, name) : name;
}

static const char *note_of_slopes(const struct emitter *part)
{
	return is_compensated(part) ? "A of the linear system, x' = A x in two words; x = states, load states, inputs"
				: "A of the linear system, x' = A x; x = states, load states, inputs";
}

/* Regions without switching functions, one in each segment of time: what the search has of those is not read. */
void emit_linear_tables(const struct emitter *part)
{
	const struct switching *s = regions_of(part);
	struct pieces pieces = pieces_of(part->step);
	int branches = part->step->branches, size = part->step->layout.size, rows = size_of_vector(part);
	int *matrix = ARRAY(int, (size_t)s->segments), *halvings = ARRAY(int, (size_t)branches);
	for (int k = 0; k < s->segments; k++)
		matrix[k] = s->region[k].system;
	for (int k = 0; k < branches; k++)
		halvings[k] = part->step->branch[k].halvings;
	put_matrices(part, "slopes", note_of_slopes(part), branches, rows, size,
		     of_branches(part, &pieces, OF_PIECE(slopes)), names_of_rows(part));
	put_matrices(part, "pieces",
		     is_compensated(part) ? "Transfer matrix e^{A h} - I in two words" : "Transfer matrix e^{A h}",
		     branches, rows, size,
		     of_branches(part, &pieces, is_compensated(part) ? OF_PIECE(gain) : OF_PIECE(Phi)),
		     names_of_rows(part));
	put_wholes(part, false, "matrix", "Which linear system holds in each segment of time", s->segments, matrix);
	put_wholes(part, false, "halvings",
		     "Into how many pieces a step may be split, as a power of 2", branches, halvings);
	emit_ladder_places(part, NULL);
	emit_spacing(part);
	emit_ladder(part, &pieces, NULL);
	emit_variation(part, NULL);
	emit_search(part, ladder_text(part, NULL));
	say_include(part, "search.h");
}

static void emit_tables_of_part(const struct emitter *part)
{
	say(part, "\n/* ---- part %d: %s ---- */\n\n", (int)(part->part - part->step->shown->model->switching->part),
	    name_list(part->model->n, part->model->names.coord));
	put_wholes(part, false, "state",
		     "Where the states of the part are in y", part->system->states, part->part->state);
	if (is_linear_part(part)) {
		emit_linear_tables(part);
		return;
	}
	emit_shares(part, part->step->shown->model->switching);
	emit_regions(part);
}

void emit_part_tables(const struct emitter *e)
{
	for_parts(e, e->step->regions.parts, emit_tables_of_part);
}

/* ---- what functions of a part are given: inputs, and the load states that it reads ---- */

/* `as_parameters`, or as arguments */
static const char *loads_text(const struct emitter *part, bool as_parameters)
{
	const char *text = "";
	for (int l = 0; l < part->system->loads; l++) {
		const struct load *load = &part->system->load[l];
		bool polynomial = is_polynomial(load->forcing);
		if (part->step->layout.load[l] < 0)
			continue;
		if (polynomial && load->powers > 1)
			text = format("%s, %st", text, as_parameters ? "double " : "");
		if (!polynomial || load->powers > 2)
			text = as_parameters ? format("%s, const double load%d[%d]", text, l + 1, load->columns)
					     : format("%s, load%d", text, l + 1);
	}
	return text;
}

static const char *given_text(const struct emitter *part, bool as_parameters)
{
	const char *u = given_inputs(part) == 0   ? ""
			: as_parameters           ? spell(part, ", const double u[$N_INPUTS]")
						  : ", u";
	return format("%s%s", u, loads_text(part, as_parameters));
}

static bool *needed_loads(const struct emitter *e, bool linear_too)
{
	bool *needed = ARRAY(bool, (size_t)e->system->loads);
	for (int p = 0; p < (linear_too ? e->step->regions.parts : switched_parts(e)); p++)
		for (int l = 0; l < e->system->loads; l++)
			needed[l] = needed[l] || e->step->regions.part[p]->layout.load[l] >= 0;
	return needed;
}

/* ---- in the model's own functions ---- */

void emit_part_members(const struct emitter *e)
{
	say(e, "    pl_contact contact[%d];   /* of each part: region, crossings */\n"
	       "    pl_crossing crossing[%d][%d];  /* of each, in the last step */\n",
	    switched_parts(e), switched_parts(e), max_events(e->model));
}

static void emit_place_of_part(const struct emitter *part)
{
	open_function(part, NULL, "static void $o_place($n *s%s)", loads_text(part, true));
	declare_region_room(part);
	emit_region_vector(part, false);
	emit_region_start_call(part);
	close_function(part, "");
}

static void emit_place_call(const struct emitter *part)
{
	say(part, "    $o_place(s%s);\n", loads_text(part, false));
}

void emit_part_start(const struct emitter *e)
{
	for_parts(e, switched_parts(e), emit_place_of_part);
	open_function(e, "The regions of a state", "static void $n_place($n *s)");
	emit_rotated_loads(e, needed_loads(e, false), false);
	for_parts(e, switched_parts(e), emit_place_call);
	close_function(e, "");
}

/* ---- questions ---- */

static void emit_list_of_parts(const struct emitter *e, const char *name, const char *table)
{
	const char *list = "";
	for (int p = 0; p < switched_parts(e); p++)
		list = format("%s%s%s_part%d_%s", list, p == 0 ? "" : p % 4 ? ", " : ",\n    ", e->name, p, table);
	say(e, "static const int *const $n_%s[] = {\n    %s\n};\n", name, list);
}

static void emit_questions(const struct emitter *e)
{
	say(e, "\n");
	emit_list_of_parts(e, "shares", "share");
	emit_list_of_parts(e, "numbers", "number");
	begin_macros(e, "parts.h", e->name);
	say_macro(e, "PARTS", integer_text(switched_parts(e)));
	say_macro(e, "MAX_EVENTS", spell(e, "$N_MAX_EVENTS"));
	say_include(e, "parts.h");
}

/* ---- a step ---- */

/* Derivatives, where they go on in the same step */
static const char *beside_text(const struct emitter *part, bool as_parameters)
{
	const bool seeded = shares_step(part) && part->step->shown->derivatives->seeded;
	if (!shares_step(part))
		return "";
	return as_parameters ? spell(part, seeded ? ", $n_d *ds, const double du[$N_INPUTS]" : ", $n_d *ds")
			     : seeded ? ", ds, du" : ", ds";
}

static void begin_step(const struct emitter *part)
{
	open_function(part, NULL, "static %svoid $o_step($n *s%s%s)", shares_step(part) ? "PL_INLINE " : "",
		      given_text(part, true), beside_text(part, true));
	if (!shares_step(part) || !is_linear_part(part))
		return;
	say(part, "    if (ds != NULL) {\n");
	declare_region_vector(part);
	emit_region_vector(part, true);
	say(part, "    $o_vary_met(s, ds%s, x);\n"
		  "    }\n", sample_arguments(part));
}

static void end_step(const struct emitter *part)
{
	close_function(part, format("%s%s", given_text(part, false), beside_text(part, false)));
}

static int acting_entries(const struct emitter *part, const double *full)
{
	int size = part->step->layout.size, count = 0;
	for (int i = 0; i < part->system->states * size; i++)
		count += full[i] != 0;
	return count;
}

static void emit_linear_loop(const struct emitter *part, const double *full)
{
	put_matrix(part, "full", "Transfer matrix e^{A h}", size_of_vector(part), part->step->layout.size, full,
		   names_of_rows(part));
	begin_step(part);
	say(part, "    double end[%d];\n", part->system->states);
	declare_region_vector(part);
	emit_region_vector(part, true);
	say(part, "    pl_multiply(%d, %d, $o_full[0], x, end);\n"
		  "    for (i = 0; i < %d; i++) { s->y[$o_state[i]] = end[i]; }\n", part->system->states,
	    part->step->layout.size, part->system->states);
}

static void emit_linear_rows(const struct emitter *part, const double *full)
{
	int size = part->step->layout.size, states = part->system->states;
	const char **x = operands_of_x(part);
	begin_step(part);
	emit_raw_locals(part, NULL);
	for (int i = 0; i < part->system->inputs; i++)
		if (part->system->input[i].hold)
			say(part, "    const double part%d = %s;\n", place_of_input(part, i),
			    ramp_slope(part, place_of_input(part, i)));
	for (int i = 0; i < states; i++) {
		struct summands s = { 0 };
		for (int j = 0; j < size; j++)
			if (full[i * size + j] != 0)
				add_summand(&s, scaled(full[i * size + j], *x[j] ? x[j] : NULL));
		say(part, "    s->y[%d] = %s;  /* %s */\n", place_of_state(part, i), sum_of(&s, 14),
		    part->model->names.state[i]);
	}
}

/* That of a step that leaves no trace; of the linear part, which has none: in a segment of time */
const char *start_of_search(const struct emitter *part)
{
	return !is_linear_part(part)  ? spell(part, "s->contact$p")
	       : regions_change(part) ? spell(part, "{0, 0, s->segment, $o_matrix[s->segment], 0, 0}")
				      : "{0, 0, 0, 0, 0, 0}";
}

static void declare_contact(const struct emitter *part)
{
	say(part, "    pl_contact contact = %s;\n"
		  "    pl_crossing crossing[%d];\n", start_of_search(part),
	    is_linear_part(part) ? 1 : max_events(part->model));
}

/* By the pieces of the search, which has nothing to look for */
static void emit_linear_by_pieces(const struct emitter *part)
{
	begin_step(part);
	declare_contact(part);
	declare_region_vector(part);
	emit_region_vector(part, true);
	say(part, "    $o_search_step(s, $N_H, x, &contact, crossing%s);\n", no_variation(part));
	emit_state_of_x(part);
}

static void emit_linear_step(const struct emitter *part)
{
	enum { TERMS = 400 };
	const double *full = full_step_of(part->step, 0);
	struct summands size = { 0 };
	if (regions_change(part) || is_compensated(part))
		emit_linear_by_pieces(part);
	else
		(acting_entries(part, full) > TERMS ? emit_linear_loop : emit_linear_rows)(part, full);
	for (int i = 0; i < part->system->states; i++)
		add_summand(&size, format("pl_magnitude(s->y[%d])", place_of_state(part, i)));
	say(part, "    if (!(%s < %s)) { s->status |= pl_not_finite(s->y, $N_STATES); }\n",
	    sum_of(&size, 10), shortest(part->model->request.single ? 0x1p120 : 0x1p1000));
	end_step(part);
}

static void emit_switched_step(const struct emitter *part)
{
	begin_step(part);
	if (part->step->regions.event_check.fast_path) {
		emit_raw_locals(part, NULL);
		emit_event_check(part);
	} else {
		declare_region_vector(part);
		emit_region_vector(part, true);
		emit_seek(part);
	}
	end_step(part);
}

static void emit_step_of_part(const struct emitter *part)
{
	(is_linear_part(part) ? emit_linear_step : emit_switched_step)(part);
}

static void emit_step_call(const struct emitter *part)
{
	say(part, "    $o_step(s%s%s);\n", given_text(part, false), beside_text(part, false));
}

void emit_parts_step(const struct emitter *e)
{
	if (shares_step(e))
		for_parts(e, e->step->regions.parts, declare_shared_step);
	for_parts(e, e->step->regions.parts, emit_step_of_part);
	shares_step(e) ? open_shared_step(e) : open_function(e, NULL, "%s", head_of_step(e));
	emit_set_aside(e);
	emit_rotated_loads(e, needed_loads(e, true), false);
	for_parts(e, e->step->regions.parts, emit_step_call);
	emit_take_back(e);
	emit_step_end(e);
	emit_segment_end(e);
	if (e->step->carried.count)           /* saved states are in no bound */
		say(e, "    s->status |= pl_not_finite(s->y, $N_STATES);\n");
	shares_step(e) ? close_shared_step(e) : close_function(e, "");
	emit_questions(e);
}

/* ---- between steps ---- */

static void emit_at_of_part(const struct emitter *part)
{
	open_function(part, NULL, "static void $o_at(const $n *s%s, double tau, double y[$N_STATES])",
		      given_text(part, true));
	declare_contact(part);
	declare_region_vector(part);
	emit_region_vector(part, true);
	say(part, "    $o_search_step(s, tau, x, &contact, crossing%s);\n", no_variation(part));
	say(part, "    for (i = 0; i < %d; i++) { y[$o_state[i]] = x[i]; }\n", part->system->states);
	close_function(part, "");
}

static void emit_at_call(const struct emitter *part)
{
	say(part, "    $o_at(s%s, tau, y);\n", given_text(part, false));
}

void emit_parts_at(const struct emitter *e)
{
	const char *u = given_inputs(e) ? format("const double u[%s_INPUTS], ", e->upper) : "";
	for_parts(e, e->step->regions.parts, emit_at_of_part);
	open_function(e, NULL, "void $n_at(const $n *s, %sdouble tau, double y[$N_STATES])", u);
	emit_load_states(e, needed_loads(e, true), false);
	for_parts(e, e->step->regions.parts, emit_at_call);
	close_function(e, given_inputs(e) ? "u" : "");
}
