/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The highest derivatives of the coordinates and their Jacobian as C: what depends on time alone once for a time, the
 * rest for a state. */
#include "emit/emit.h"

#include <stdlib.h>
#include <string.h>

static const struct motion *motion(const struct emitter *e)
{
	return e->step->motion;
}

bool splits(const struct emitter *e)
{
	return motion(e)->apart;
}

/* What chooses formulas: forms without their constants */
static const struct form **dividing_forms(const struct emitter *e, int *count)
{
	const struct expansion *x = e->step->divided;
	const struct form **form = ARRAY(const struct form *, x ? (size_t)x->expressions : 1);
	*count = x ? x->expressions : 0;
	for (int i = 0; i < *count; i++)
		form[i] = x->expression[i].form;
	return form;
}

/* The arguments of what polynomials may not show */
static const struct form **unseen_forms(const struct emitter *e, int *count)
{
	const struct expansion *x = e->step->unseen;
	const struct form **form = ARRAY(const struct form *, x ? (size_t)x->unseens : 1);
	*count = x ? x->unseens : 0;
	for (int i = 0; i < *count; i++)
		form[i] = x->unseen[i].form;
	return form;
}

/* The forces and their slopes, then what chooses formulas, and what bounds the polynomials. These are read too. */
static const struct form **all_forms(const struct emitter *e, int *count)
{
	const struct motion *m = motion(e);
	int dividing, unseen;
	const struct form **choosing = dividing_forms(e, &dividing), **bounding = unseen_forms(e, &unseen);
	const struct form **form = ARRAY(const struct form *, (size_t)(m->coords + m->entries + dividing + unseen));
	for (int i = 0; i < m->coords; i++)
		form[i] = m->force[i];
	for (int k = 0; k < m->entries; k++)
		form[m->coords + k] = m->entry[k].slope;
	for (int i = 0; i < dividing; i++)
		form[m->coords + m->entries + i] = choosing[i];
	for (int i = 0; i < unseen; i++)
		form[m->coords + m->entries + dividing + i] = bounding[i];
	*count = m->coords + m->entries + dividing + unseen;
	return form;
}

static struct reads reads_of_motion(const struct emitter *e)
{
	int count;
	const struct form **form = all_forms(e, &count);
	return reads_of(e->model, count, form);
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
	int first = 0;
	for (int l = 0; l < load; l++)
		first += e->system->load[l].columns;
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

/* ---- what is known of a time before the state is ---- */

struct place_of_known { int driven, time, when, load, value, slope, param, count; };

static bool ramps(const struct emitter *e, int input)
{
	return e->system->input[input].hold > 0;
}

/* Does a form jump where a condition on time changes? Then all nodes of a step stand on the same side. */
static bool form_decides(const struct form *form, bool *seen)
{
	bool any = false;
	for (int i = 0; i < form->terms; i++) {
		const struct atom *a = form->term[i].basis.atom;
		if (!a || seen[a->index])
			continue;
		seen[a->index] = true;
		any = any || a->kind == ATOM_COMPARE || (a->kind == ATOM_CALL && a->function == FN_SGN);
		for (int k = 0; k < a->operands; k++)
			any = form_decides(a->operand[k], seen) || any;
	}
	return any;
}

static bool decides(const struct emitter *e)
{
	int count;
	const struct form **form = all_forms(e, &count);
	bool any = false, *seen = ARRAY(bool, (size_t)atoms_count(e->model->atoms));
	for (int i = 0; i < count; i++)
		any = form_decides(form[i], seen) || any;
	return any;
}

/* Where each kind begins: driven coordinates, t, the time at which conditions on it hold, the load states that are
 * read, inputs, their slopes, tunable params */
static struct place_of_known known_places(const struct emitter *e, const struct reads *r)
{
	struct place_of_known p = { 0 };
	for (int i = 0; i < motion(e)->coords; i++)
		p.count += motion(e)->driven[i];
	p.time = p.count;
	p.count += r->time;
	p.when = p.count;
	p.count += decides(e);
	p.load = p.count;
	for (int l = 0; l < e->system->loads; l++)
		p.count += r->load[l] ? e->system->load[l].columns : 0;
	p.value = p.count;
	for (int i = 0; i < e->system->inputs; i++)
		p.count += r->input[i];
	p.slope = p.count;
	for (int i = 0; i < e->system->inputs; i++)
		p.count += r->input[e->system->inputs + i];
	p.param = p.count;
	for (int k = 0; k < held_values(e->model); k++)
		p.count += r->param[k];
	return p;
}

int known_values(const struct emitter *e)
{
	struct reads r = reads_of_motion(e);
	return known_places(e, &r).count;
}

static bool changes(const struct emitter *e)
{
	return e->system->segments > 1;
}

static void emit_drive_table(const struct emitter *e)
{
	const struct motion *m = motion(e);
	const int size[] = { e->system->segments, m->coords, m->columns };
	emit_array(e, "What the load states give each highest derivative, in each segment of time", "drive", 3, size,
		   m->load, e->model->coord_name);
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
	int inputs = e->system->inputs, terms = 0;
	const char **term = ARRAY(const char *, (size_t)(m->columns + 2 * inputs) + 1);
	for (int k = 0; k < m->columns; k++) {
		const char *operand = column_operand(e, k);
		double factor = m->load[coord * m->columns + k];
		if (changes(e) && drives(e, k))
			term[terms++] = format("drive[%d][%d]%s", coord, k, operand ? format(" * %s", operand) : "");
		else if (factor != 0)
			term[terms++] = scaled(factor, operand);
	}
	for (int i = 0; i < inputs; i++) {
		const double *factor = m->input + 2 * (coord * inputs + i);
		if (factor[0] != 0)
			term[terms++] = scaled(factor[0], ramps(e, i) ? format("(u[%d] + tau * slope[%d])", i, i)
								      : format("u[%d]", i));
		if (factor[1] != 0)
			term[terms++] = scaled(factor[1], format("slope[%d]", i));
	}
	return terms ? tree(terms, term, 18) : "0.0";
}

static void emit_known_loads(const struct emitter *e, const struct reads *r)
{
	bool *wanted = ARRAY(bool, (size_t)e->system->loads), time = r->time;
	for (int l = 0; l < e->system->loads; l++) {
		const struct load *load = &e->system->load[l];
		/* of a constant and t, the constant alone may drive */
		const bool constant = is_polynomial(load->wave) && load->columns == 2 && !load_drives(e, l, 1);
		wanted[l] = r->load[l] || load_drives(e, l, 0);
		time = time || (wanted[l] && load->powers > 1 && (r->load[l] || !constant));
	}
	if (time)
		say(e, "    const double t = $n_time(s) + tau;\n");
	struct emitter here = *e;
	here.after = "tau";
	emit_load_states(&here, wanted, true);
}

static void emit_known_values(const struct emitter *e, const struct reads *r)
{
	struct place_of_known p = known_places(e, r);
	int inputs = e->system->inputs;
	for (int i = 0; i < motion(e)->coords; i++)
		if (motion(e)->driven[i])
			say(e, "    node[%d] = %s;  /* of %s */\n", p.driven++, drive_text(e, i),
			    e->model->coord_name[i]);
	if (r->time)
		say(e, "    node[%d] = t;\n", p.time);
	if (decides(e))
		say(e, "    node[%d] = $n_time(s) + inside;  /* where conditions on t hold as they do over the step "
		       "*/\n",
		    p.when);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && r->load[l]; k++) {
			const char *operand = load_operand(e, l, k);
			say(e, "    node[%d] = %s;\n", p.load++, operand ? operand : "1.0");
		}
	for (int i = 0; i < inputs; i++)
		if (r->input[i])
			say(e, ramps(e, i) ? "    node[%d] = u[%d] + tau * slope[%d];\n" : "    node[%d] = u[%d];\n",
			    p.value++, i, i);
	for (int i = 0; i < inputs; i++)
		if (r->input[inputs + i])
			say(e, "    node[%d] = slope[%d];\n", p.slope++, i);
	for (int k = 0; k < held_values(e->model); k++)
		if (r->param[k])
			say(e, "    node[%d] = %s;\n", p.param++, param_text(e, k));
}

static void emit_known(const struct emitter *e, const struct reads *r)
{
	bool drive = changes(e) && any_drive(e);
	int known = known_places(e, r).count;
	if (drive)
		emit_drive_table(e);
	say(e, "\n/* What the equations read beside the state, tau after now; conditions on t hold as at inside */\n"
	       "static void $n_known(const $n *s, double tau, double inside, int segment, const double u[],\n"
	       "    const double slope[], double node[%d])\n"
	       "{\n", known ? known : 1);
	if (drive)
		say(e, "    const double (*const drive)[%d] = $n_drive[segment];\n", motion(e)->columns);
	emit_known_loads(e, r);
	emit_known_values(e, r);
	if (!known)
		say(e, "    node[0] = 0.0;  /* nothing */\n");
	static const char *const parameter[] = { "s", "tau", "inside", "segment", "u", "slope" };
	for (size_t i = 0; i < sizeof parameter / sizeof *parameter; i++)
		say(e, "    (void)%s;\n", parameter[i]);
	say(e, "}\n");
}

/* ---- the highest derivatives, and their Jacobian ---- */

/* Of what is known under the names that forms read, those of `read` */
static void emit_motion_locals(const struct emitter *e, const struct reads *r, const struct reads *read)
{
	struct place_of_known p = known_places(e, r);
	int inputs = e->system->inputs;
	emit_locals_of(e, read->state, "y");
	if (read->time)
		say(e, "    const double t = node[%d];\n", p.time);
	for (int l = 0; l < e->system->loads; l++)
		if (r->load[l]) {
			if (read->load[l])
				say(e, "    const double *const load%d = node + %d;\n", l + 1, p.load);
			p.load += e->system->load[l].columns;
		}
	for (int i = 0; i < 2 * inputs; i++) {
		bool slope = i >= inputs;
		if (read->input[i])
			say(e, "    const double %s = node[%d];\n", input_name(e, slope ? i - inputs : i, slope),
			    slope ? p.slope : p.value);
		if (r->input[i])
			(*(slope ? &p.slope : &p.value))++;
	}
	for (int k = 0; k < held_values(e->model); k++)
		if (r->param[k]) {
			if (read->param[k])
				say(e, "    const double %s = node[%d];\n", param_local(e, k), p.param);
			p.param++;
		}
}

static bool any_known(const struct emitter *e, const struct reads *read)
{
	return read->time || any_of(read->load, e->system->loads) || any_of(read->input, 2 * e->system->inputs) ||
	       any_of(read->param, held_values(e->model));
}

static bool read_known(const struct emitter *e, int count, const struct form *const *form)
{
	struct reads read = reads_of(e->model, count, form);
	bool any = any_known(e, &read), *seen = ARRAY(bool, (size_t)atoms_count(e->model->atoms));
	for (int i = 0; i < count; i++)
		any = form_decides(form[i], seen) || any;
	return any;
}

bool watch_reads_known(const struct emitter *e)
{
	int count;
	const struct form **form = dividing_forms(e, &count);
	return read_known(e, count, form);
}

bool trace_reads_known(const struct emitter *e)
{
	int count;
	const struct form **form = unseen_forms(e, &count);
	return read_known(e, count, form);
}

static struct formulas *motion_formulas(const struct emitter *e, const struct reads *r, int count,
					const struct form *const *form)
{
	struct reading how = { .by_intervals = is_divided(e),
			       .when = decides(e) ? format("node[%d]", known_places(e, r).when) : NULL };
	return formulas_new(e, how, count, form);
}

/* The highest derivatives, and where they are wanted the entries of their Jacobian */
static struct formulas *force_formulas(const struct emitter *e, const struct reads *r, int entries)
{
	const struct motion *m = motion(e);
	int driven = 0;
	const struct form **form = ARRAY(const struct form *, (size_t)(m->coords + entries));
	for (int i = 0; i < m->coords; i++)
		form[i] = m->force[i];
	for (int k = 0; k < entries; k++)
		form[m->coords + k] = m->entry[k].slope;
	struct formulas *f = motion_formulas(e, r, m->coords + entries, form);
	struct tape *t = formulas_tape(f);
	for (int i = 0; i < m->coords; i++) {
		tape_ref force = formula(f, form[i]);
		if (m->driven[i])
			force = tape_binary(t, TAPE_ADD, force, tape_operand(t, TAPE_TABLE, driven++, TABLE_NODE));
		tape_set(t, format("left[%d]", i), force, 15, e->model->coord_name[i]);
	}
	for (int k = 0; k < entries; k++)
		tape_set(t, format("slope[%d]", k), formula(f, form[m->coords + k]), 15, NULL);
	return f;
}

/* The expressions that choose formulas, and the sizes of what they are summed from */
static struct formulas *watched_formulas(const struct emitter *e, const struct reads *r)
{
	int count;
	const struct form **form = dividing_forms(e, &count);
	struct formulas *f = motion_formulas(e, r, count, form);
	for (int i = 0; i < count; i++) {
		tape_set(formulas_tape(f), format("left[%d]", i), formula(f, form[i]), 15, NULL);
		tape_set(formulas_tape(f), format("excess[%d]", i), formula_sizes(f, form[i]), 16, NULL);
	}
	return f;
}

static struct formulas *unseen_formulas(const struct emitter *e, const struct reads *r)
{
	int count;
	const struct form **form = unseen_forms(e, &count);
	struct formulas *f = motion_formulas(e, r, count, form);
	for (int i = 0; i < count; i++)
		tape_set(formulas_tape(f), format("left[%d]", i), formula(f, form[i]), 15, NULL);
	return f;
}

/* ---- functions of them: what an interval decides is not read ---- */

enum motion_part { THE_FORCES, THE_SLOPES_TOO, THE_EXPRESSIONS, THE_ARGUMENTS };

static void emit_motion_body(const struct emitter *e, const struct reads *r, enum motion_part part)
{
	struct formulas *f = part == THE_EXPRESSIONS ? watched_formulas(e, r)
			     : part == THE_ARGUMENTS ? unseen_formulas(e, r)
			     : force_formulas(e, r, part == THE_SLOPES_TOO ? motion(e)->entries : 0);
	const struct tape *t = formulas_tape(f);
	formulas_finish(f);
	struct reads read = reads_of_formulas(f);
	emit_motion_locals(e, r, &read);
	emit_formulas(f, 4);
	if (part == THE_SLOPES_TOO && motion(e)->entries == 0)
		say(e, "    slope[0] = 0.0;\n");
	if (!any_known(e, &read) && !tape_reads(t, TAPE_TABLE, -1, TABLE_NODE) && !tape_reads(t, TAPE_TIME, -1, 1))
		say(e, "    (void)node;\n");
	if (!tape_reads(t, TAPE_ABOVE, -1, -1))
		say(e, "    (void)interval;\n");
	if (!any_of(read.state, e->system->states))
		say(e, "    (void)y;\n");
	say(e, "}\n");
}

static void emit_part(const struct emitter *e, const struct reads *r, enum motion_part part)
{
	static const struct {
		const char *note, *name, *more;
	} of[] = {
		[THE_FORCES] = { "The highest derivatives at state y", "forces", "" },
		[THE_SLOPES_TOO] = { "The highest derivatives at state y, and their Jacobian where it is not 0",
				     "linearize", ", double slope[]" },
		[THE_EXPRESSIONS] = { "The expressions that choose formulas, at state y, and the size of what they are "
				      "summed from", "watch", ", double excess[]" },
		[THE_ARGUMENTS] = { "The arguments of functions that polynomials may not show, at state y", "trace",
				    "" }
	};
	bool within = part == THE_SLOPES_TOO && !splits(e);
	say(e, "\n/* %s */\n"
	       "static %svoid $n_%s(const double node[], const int interval[], const double y[$N_STATES],\n"
	       "    double left[]%s)\n"
	       "{\n", of[part].note, within ? "inline " : "", of[part].name, of[part].more);
	emit_motion_body(e, r, part);
}

void emit_motion(const struct emitter *e)
{
	struct reads r = reads_of_motion(e);
	emit_known(e, &r);
	emit_part(e, &r, THE_SLOPES_TOO);
	if (splits(e))
		emit_part(e, &r, THE_FORCES);
	if (is_divided(e))
		emit_part(e, &r, THE_EXPRESSIONS);
	if (traces(e))
		emit_part(e, &r, THE_ARGUMENTS);
}
