/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The highest derivatives of the coordinates and their Jacobian as C: terms of time alone are computed once for each
 * time, the others for each state. */
#include "emit/series/series.h"
#include "emit/steps.h"
#include "model/reads.h"
#include "step/collocation/collocation.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "step/contacts/series_contacts.h"

#include <stdlib.h>
#include <string.h>

static const struct motion *motion(const struct emitter *e)
{
	return e->step->collocation->motion;
}

bool splits(const struct emitter *e)
{
	return motion(e)->apart;
}

/* What functions of the state are printed of: */
enum motion_part { THE_FORCES, THE_SLOPES_TOO, THE_SWITCHING, THE_ARGUMENTS };

/* The forces and their slopes, what chooses formulas (without its constants), or the arguments of what polynomials may
 * not show; beside contacts there are only the latter */
static const struct form **forms_of(const struct emitter *e, enum motion_part part, int *count)
{
	const struct motion *m = motion(e);
	const struct expansion *d = e->step->taylor.switching, *u = e->step->taylor.unresolved;
	const int entries = part == THE_SLOPES_TOO && !m->differences ? m->entries : 0;
	const bool by_series = meets_contacts(e) && part != THE_ARGUMENTS;
	*count = by_series ? 0 : part == THE_SWITCHING ? (d ? d->functions : 0)
		 : part == THE_ARGUMENTS ? (u ? u->unresolved_functions : 0) : m->coords + entries;
	const struct form **form = ARRAY(const struct form *, (size_t)*count + 1);
	for (int i = 0; i < *count; i++)
		form[i] = part == THE_SWITCHING ? d->function[i].form
			  : part == THE_ARGUMENTS ? u->unresolved[i].form
			  : i < m->coords	  ? m->force[i] : m->entry[i - m->coords].slope;
	return form;
}

static const struct form **all_forms(const struct emitter *e, int *count)
{
	const struct form **form = NULL;
	*count = 0;
	for (enum motion_part part = THE_SLOPES_TOO; part <= THE_ARGUMENTS; part++) {
		int more;
		const struct form **own = forms_of(e, part, &more);
		ENLARGE(form, (size_t)(*count + more) + 1);
		memcpy(form + *count, own, (size_t)more * sizeof *form);
		*count += more;
	}
	return form;
}

/* Beside contacts what a part sets, from what the series of events has */
static const struct tape *set_part(const struct emitter *e, struct recurrences *r, enum motion_part part)
{
	const struct expansion *x = e->step->taylor.switching;
	if (part != THE_SWITCHING) {
		set_motion(e->step, r, part == THE_SLOPES_TOO && !motion(e)->differences);
		return tape_of_recurrences(r);
	}
	for (int i = 0; i < terms_of_events(e); i++)
		recurrence_set(r, format("left[%d]", i), i < x->functions ? x->function[i].sequence
					: x->contacts->watch[i - x->functions].sequence, 0);
	series_set_sizes(r, x, "excess");
	return tape_of_recurrences(r);
}

static const struct tape *tape_of_part(const struct emitter *e, enum motion_part part)
{
	return set_part(e, motion_recurrences(e->step), part);
}

static struct reads reads_of_motion(const struct emitter *e)
{
	int count;
	const struct form **form = all_forms(e, &count);
	struct reads r = reads_of(e->model, count, form);
	for (enum motion_part part = THE_SLOPES_TOO; part <= THE_SWITCHING && meets_contacts(e); part++)
		note_reads(&r, e, tape_of_part(e, part));
	return r;
}

/* Is a column of the loads in the linear part of some coordinate? */
static bool drives(const struct emitter *e, int column)
{
	const struct motion *m = motion(e);
	bool any = false;
	for (int i = 0; i < e->system->segments * m->coords; i++)
		any = any || m->load[i * m->columns + column] != 0;
	return any;
}

/* By its columns from `from` on */
static bool load_drives(const struct emitter *e, int load, int from)
{
	bool any = false;
	int first = column_of_load(e->system, load);
	for (int j = from; j < e->system->load[load].columns; j++)
		any = any || drives(e, first + j);
	return any;
}

bool motion_reads_load(const struct emitter *e, int load)
{
	return load_drives(e, load, 0) || reads_of_motion(e).load[load];
}

/* ---- states and coordinates ---- */

/* All of second order: then state n + j is the velocity of coordinate j. */
static bool all_second(const struct emitter *e)
{
	return e->system->states == 2 * e->system->n;
}

static bool all_first(const struct emitter *e)
{
	return e->system->states == e->system->n;
}

/* Is a state's derivative another state? */
static const char *is_moved(const struct emitter *e, const char *i)
{
	return all_second(e) ? format("%s < %d", i, e->system->n)
			     : spell(e, "$n_highest_of[$n_coord_of[%s]] != %s", i, i);
}

/* Coordinates of second order, velocities, coordinates of first order */
const char *kind_text(const struct emitter *e, const char *i)
{
	return all_first(e) ? "0" : all_second(e) ? format("%s >= %d", i, e->system->n)
						   : format("%s ? 0 : %s < %d ? 2 : "
							    "1", is_moved(e, i), i, e->system->n);
}

void emit_state_table(const struct emitter *e)
{
	if (all_first(e) || all_second(e))
		return;
	int *highest = ARRAY(int, (size_t)e->system->n);
	for (int j = 0; j < e->system->n; j++)
		highest[j] = highest_state(e->system, j);
	say(e, "\n/* The state whose derivative is a coordinate's highest; the coordinate of a state */\n");
	emit_integers(e, "short", "highest_of", e->system->n, highest);
	emit_integers(e, "short", "coord_of", e->system->states, e->system->coord);
}

/* ---- numbers that depend on time alone ---- */

enum known_kind { KNOWN_DRIVEN, KNOWN_TIME, KNOWN_WHEN, KNOWN_SLOT, KNOWN_LOAD, KNOWN_INPUT, KNOWN_PARAM };
struct known { enum known_kind kind; int index, part; }; /* column of a load, order of an input's derivative */
struct knowns { int count; struct known *of; };

static bool ramps(const struct emitter *e, int input)
{
	return e->system->input[input].hold > 0;
}

/* Does a form jump where a condition on time changes? Then all nodes of a step stand on the same side. */
static bool form_decides(const struct form *form, bool *seen)
{
	bool any = false;
	for (const struct form_term **term = terms_within(form, seen); *term; term++) {
		const struct atom *a = (*term)->basis.atom;
		any = any || (a && (a->kind == ATOM_COMPARE || (a->kind == ATOM_CALL && a->function == FN_SGN)));
	}
	return any;
}

static bool decides(const struct emitter *e)
{
	int count;
	const struct form **form = all_forms(e, &count);
	bool any = false, *seen = ARRAY(bool, (size_t)atoms_count(e->model->equations.atoms));
	for (int i = 0; i < count; i++)
		any = form_decides(form[i], seen) || any;
	for (enum motion_part part = THE_SLOPES_TOO; part <= THE_SWITCHING && meets_contacts(e); part++)
		any = any || tape_reads(tape_of_part(e, part), TAPE_TIME, -1, 1);
	return any;
}

static void add_known(struct knowns *list, enum known_kind kind, int index, int part)
{
	ENLARGE(list->of, (size_t)list->count + 1);
	list->of[list->count++] = (struct known){ kind, index, part };
}

/* Driven coordinates, t, the time at which conditions on it hold, the load states that are read, inputs, their slopes,
 * tunable params */
static struct knowns knowns_of(const struct emitter *e, const struct reads *r)
{
	const int inputs = e->system->inputs;
	struct knowns list = { 0, NULL };
	for (int i = 0; i < motion(e)->coords; i++)
		if (motion(e)->driven[i])
			add_known(&list, KNOWN_DRIVEN, i, 0);
	if (r->time)
		add_known(&list, KNOWN_TIME, 0, 0);
	if (decides(e))
		add_known(&list, KNOWN_WHEN, 0, 0);
	for (int j = 0; meets_contacts(e) && j < e->step->taylor.switching->slots; j++)
		add_known(&list, KNOWN_SLOT, j, 0);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && r->load[l]; k++)
			add_known(&list, KNOWN_LOAD, l, k);
	for (int i = 0; i < 2 * inputs; i++)
		if (r->input[i])
			add_known(&list, KNOWN_INPUT, i % inputs, i / inputs);
	for (int k = 0; k < held_values(e->model); k++)
		if (r->param[k])
			add_known(&list, KNOWN_PARAM, k, 0);
	return list;
}

int known_values(const struct emitter *e)
{
	struct reads r = reads_of_motion(e);
	return knowns_of(e, &r).count;
}

static bool changes(const struct emitter *e)
{
	return loads_change(e->system);
}

static void emit_drive_table(const struct emitter *e)
{
	const struct motion *m = motion(e);
	const int size[] = { e->system->segments, m->coords, m->columns };
	emit_array(e, "What the load states give each highest derivative, in each segment of time", "drive", 3, size,
		   m->load, e->model->names.coord);
}

static bool any_drive(const struct emitter *e)
{
	bool any = false;
	for (int column = 0; column < motion(e)->columns; column++)
		any = any || drives(e, column);
	return any;
}

static const char *drive_text(const struct emitter *e, int coord)
{
	const struct motion *m = motion(e);
	int inputs = e->system->inputs;
	struct summands s = { 0 };
	for (int k = 0; k < m->columns; k++) {
		const char *operand = column_operand(e, k);
		double factor = m->load[coord * m->columns + k];
		if (changes(e) && drives(e, k))
			add_summand(&s, format("drive[%d][%d]%s", coord, k, operand ? format(" * %s", operand) : ""));
		else if (factor != 0)
			add_summand(&s, scaled(factor, operand));
	}
	for (int i = 0; i < inputs; i++) {
		const double *factor = m->input + 2 * (coord * inputs + i);
		if (factor[0] != 0)
			add_summand(&s, scaled(factor[0], ramps(e, i) ? format("(u[%d] + tau * slope[%d])", i, i)
								      : format("u[%d]", i)));
		if (factor[1] != 0)
			add_summand(&s, scaled(factor[1], format("slope[%d]", i)));
	}
	return sum_of(&s, 18);
}

static void emit_known_loads(const struct emitter *e, const struct reads *r)
{
	bool *wanted = ARRAY(bool, (size_t)e->system->loads), time = r->time;
	for (int l = 0; l < e->system->loads; l++) {
		const struct load *load = &e->system->load[l];
		/* of a constant and t, the constant alone may drive */
		const bool constant = is_polynomial(load->forcing) && load->columns == 2 && !load_drives(e, l, 1);
		wanted[l] = r->load[l] || load_drives(e, l, 0);
		time = time || (wanted[l] && load->powers > 1 && (r->load[l] || !constant));
	}
	if (time)
		say(e, "    const double t = $n_time(s) + tau;\n");
	struct emitter here = *e;
	here.after = "tau";
	emit_load_states(&here, wanted, true);
}

/* Its value, tau after now */
static const char *known_text(const struct emitter *e, const struct known *k)
{
	const char *operand;
	switch (k->kind) {
	case KNOWN_DRIVEN: return drive_text(e, k->index);
	case KNOWN_TIME:   return "t";
	case KNOWN_WHEN:   return spell(e, "$n_time(s) + inside");
	case KNOWN_SLOT:   return spell(e, "$n_force[segment][0][%d]", k->index);
	case KNOWN_LOAD:
		operand = load_operand(e, k->index, k->part);
		return operand ? operand : "1.0";
	case KNOWN_INPUT:
		return k->part		    ? format("slope[%d]", k->index)
		       : ramps(e, k->index) ? format("u[%d] + tau * slope[%d]", k->index, k->index)
					    : format("u[%d]", k->index);
	default:           return param_text(e, k->index);
	}
}

static void emit_known(const struct emitter *e, const struct reads *r)
{
	bool drive = changes(e) && any_drive(e);
	const struct knowns known = knowns_of(e, r);
	if (drive)
		emit_drive_table(e);
	open_function(e, "Loads, inputs and functions of time, tau after now; conditions on t are those of inside",
		      "static void $n_known(const $n *s, double tau, double inside, int segment, const double u[],\n"
		      "    const double slope[], double node[%d])", known.count ? known.count : 1);
	if (drive)
		say(e, "    const double (*const drive)[%d] = $n_drive[segment];\n", motion(e)->columns);
	emit_known_loads(e, r);
	for (int i = 0; i < known.count; i++)
		say(e, "    node[%d] = %s;\n", i, known_text(e, &known.of[i]));
	if (!known.count)
		say(e, "    node[0] = 0.0;  /* the equations read none of them */\n");
	close_function(e, "s tau inside segment u slope");
}

/* ---- the highest derivatives, and their Jacobian ---- */

/* Of what is known under the names that forms read, those of `read` */
static void emit_motion_locals(const struct emitter *e, const struct reads *r, const struct reads *read)
{
	const struct knowns known = knowns_of(e, r);
	emit_locals_of(e, read->state, "y");
	for (int i = 0; i < known.count; i++) {
		const struct known *k = &known.of[i];
		const char *name = NULL;
		if (k->kind == KNOWN_LOAD && k->part == 0 && read->load[k->index])
			say(e, "    const double *const load%d = node + %d;\n", k->index + 1, i);
		if (k->kind == KNOWN_SLOT && k->index == 0 && e->at_state)
			say(e, "    const double *const force = node + %d;\n", i);
		if (k->kind == KNOWN_TIME && read->time)
			name = "t";
		else if (k->kind == KNOWN_WHEN && e->at_state)
			name = "when";
		else if (k->kind == KNOWN_INPUT && read->input[k->index + k->part * e->system->inputs])
			name = input_name(e, k->index, k->part);
		else if (k->kind == KNOWN_PARAM && read->param[k->index])
			name = param_local(e, k->index);
		if (name)
			say(e, "    const double %s = node[%d];\n", name, i);
	}
}

static bool any_known(const struct emitter *e, const struct reads *read)
{
	return read->time || any_of(read->load, e->system->loads) || any_of(read->input, 2 * e->system->inputs) ||
	       any_of(read->param, held_values(e->model));
}

struct reads reads_of_choices(const struct emitter *e)
{
	int count;
	const struct form **form = forms_of(e, THE_SWITCHING, &count);
	struct reads read = reads_of(e->model, count, form);
	if (meets_contacts(e))
		note_reads(&read, e, tape_of_part(e, THE_SWITCHING));
	return read;
}

static bool reads_known(const struct emitter *e, enum motion_part part)
{
	int count;
	const struct form **form = forms_of(e, part, &count);
	struct reads read = part == THE_SWITCHING ? reads_of_choices(e) : reads_of(e->model, count, form);
	bool any = any_known(e, &read), *seen = ARRAY(bool, (size_t)atoms_count(e->model->equations.atoms));
	for (int i = 0; i < count; i++)
		any = form_decides(form[i], seen) || any;
	const struct tape *t = meets_contacts(e) && part == THE_SWITCHING ? tape_of_part(e, part) : NULL;
	return any || (t && (tape_reads(t, TAPE_TIME, -1, 1) || tape_reads(t, TAPE_TABLE, -1, -1)));
}

bool watch_reads_known(const struct emitter *e)
{
	return reads_known(e, THE_SWITCHING);
}

bool trace_reads_known(const struct emitter *e)
{
	return reads_known(e, THE_ARGUMENTS);
}

static const char *when_text(const struct emitter *e, const struct reads *r)
{
	const struct knowns known = knowns_of(e, r);
	for (int i = 0; i < known.count; i++)
		if (known.of[i].kind == KNOWN_WHEN)
			return format("node[%d]", i);
	return NULL;
}

/* The highest derivatives with what drives them, and the entries of their Jacobian; expressions with the sizes of what
 * they are summed from; arguments */
static struct formulas *formulas_of_part(const struct emitter *e, const struct reads *r, enum motion_part part)
{
	const struct motion *m = motion(e);
	const bool forces = part <= THE_SLOPES_TOO;
	int count, driven = 0;
	const struct form **form = forms_of(e, part, &count);
	struct reading how = { .by_intervals = has_switching(e), .when = when_text(e, r) };
	struct formulas *f = formulas_new(e, how, count, form);
	struct tape *t = formulas_tape(f);
	if (m->listed && forces)
		solve_formulas_by_lists(f, count, form);
	for (int i = 0; i < count; i++) {
		const bool slope = forces && i >= m->coords;
		tape_ref value = formula(f, form[i]);
		if (forces && !slope && m->driven[i])
			value = tape_binary(t, TAPE_ADD, value, tape_operand(t, TAPE_TABLE, driven++, TABLE_NODE));
		tape_set(t, slope ? format("slope[%d]", i - m->coords) : format("left[%d]", i), value, 15,
			 forces && !slope ? e->model->names.coord[i] : NULL);
		if (part == THE_SWITCHING)
			tape_set(t, format("excess[%d]", i), formula_sizes(f, form[i]), 16, NULL);
	}
	return f;
}

/* ---- functions of them: what an interval decides is not read ---- */

/* node: `part` of TAPE_TABLE that is known; negative: any */
static void close_motion(const struct emitter *e, const struct tape *t, const struct reads *read, int node, bool moves)
{
	close_function(e, spell(e, "%s%s%s",
				any_known(e, read) || tape_reads(t, TAPE_TABLE, -1, node) ||
					tape_reads(t, TAPE_TIME, -1, 1) ? "" : "node ",
				tape_reads(t, TAPE_ABOVE, -1, -1) || tape_reads(t, TAPE_HELD, -1, -1)
					? "" : "interval ",
				moves ? "" : "y"));
}

/* Beside contacts */
static void emit_series_body(const struct emitter *e, const struct reads *r, enum motion_part part)
{
	struct emitter here = *by_series(e, e->step->taylor.switching);
	here.at_state = true;
	struct recurrences *made = series_new(&here);
	const struct tape *t = set_part(e, made, part);
	struct reads read = reads_of(e->model, 0, NULL);
	note_reads(&read, e, t);
	emit_motion_locals(&here, r, &read);
	emit_series_tape(&here, made);
	say(e, "%s%s", tape_reads(t, TAPE_TIME, -1, 1) || !decides(e) ? "" : "    (void)when;\n",
	    tape_reads(t, TAPE_TABLE, -1, -1) || !e->step->taylor.switching->slots ? "" : "    (void)force;\n");
	close_motion(e, t, &read, -1, tape_reads(t, TAPE_STATE, -1, -1));
}

static void emit_motion_body(const struct emitter *e, const struct reads *r, enum motion_part part)
{
	struct formulas *f = formulas_of_part(e, r, part);
	const struct tape *t = formulas_tape(f);
	formulas_finish(f);
	struct reads read = reads_of_formulas(f);
	emit_motion_locals(e, r, &read);
	emit_solved_locals(f);
	emit_formulas(f, 4);
	if (part == THE_SLOPES_TOO && motion(e)->entries == 0)
		say(e, "    slope[0] = 0.0;\n");
	close_motion(e, t, &read, TABLE_NODE, any_of(read.state, e->system->states));
}

static void emit_part(const struct emitter *e, const struct reads *r, enum motion_part part)
{
	static const struct {
		const char *note, *name, *more;
	} of[] = {
		[THE_FORCES] = { "The highest derivatives at state y", "forces", "" },
		[THE_SLOPES_TOO] = { "The highest derivatives at state y, and their Jacobian where it is not 0",
				     "linearize", ", double slope[]" },
		[THE_SWITCHING] = { "The switching functions at state y, and the size of what they are "
				      "summed from", "watch", ", double excess[]" },
		[THE_ARGUMENTS] = { "The arguments of functions that polynomials may not show, at state y", "trace",
				    "" }
	};
	bool within = part == THE_SLOPES_TOO && !splits(e);
	open_function(e, of[part].note,
		      "static %svoid $n_%s(const double node[], const int interval[], const double y[$N_STATES],\n"
		      "    double left[]%s)", within ? "inline " : "", of[part].name, of[part].more);
	if (meets_contacts(e) && part != THE_ARGUMENTS)
		emit_series_body(e, r, part);
	else
		emit_motion_body(e, r, part);
}

void emit_motion(const struct emitter *e)
{
	struct reads r = reads_of_motion(e);
	emit_known(e, &r);
	if (motion(e)->listed) {
		emit_solved_tables(formulas_of_part(e, &r, THE_SLOPES_TOO));
		emit_sizes(e, "lines.h", { "SOLVES", 1 });
		say_include(e, "lines.h");
	}
	if (!motion(e)->differences)
		emit_part(e, &r, THE_SLOPES_TOO);
	if (splits(e))
		emit_part(e, &r, THE_FORCES);
	if (has_switching(e))
		emit_part(e, &r, THE_SWITCHING);
	if (traces(e))
		emit_part(e, &r, THE_ARGUMENTS);
}
