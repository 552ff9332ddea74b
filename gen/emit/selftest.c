/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_selftest: states in closed form, or that the same steps come to where there is none, for the target to step
 * to, by selftest.h. Inputs follow u = 1 - t/h, which
 * every factor of a sample has a part in; held, u = 1. */
#include "declarations.h"
#include "emit/tunable/tunable.h"
#include "step/certify/certify.h"

static void emit_table(const struct emitter *e, const char *note, const char *name, int rows, int columns,
		       const double *value)
{
	emit_array(e, note, name, rows ? 2 : 1, rows ? (const int[]){ rows, columns } : &columns, value, NULL);
}

static void emit_step_counts(const struct emitter *e, const char *name, int count, const unsigned long *value)
{
	say(e, "static const uint64_t $n_%s[%d] = {", name, count);
	for (int i = 0; i < count; i++)
		say(e, i ? ", %lu" : "%lu", value[i]);
	say(e, "};\n");
}

static void emit_crossings(const struct emitter *e, const struct reference *r)
{
	double *when = ARRAY(double, 2 * (size_t)r->crossings);
	unsigned long *step = ARRAY(unsigned long, (size_t)r->crossings);
	for (int k = 0; k < r->crossings; k++) {
		step[k] = r->crossing[k].step;
		when[2 * k] = r->crossing[k].after;
		when[2 * k + 1] = r->crossing[k].unit;
	}
	emit_table(e, "Crossings: how long after so many steps, and what rounding makes of that", "known_crossing",
		   r->crossings, 2, when);
	emit_step_counts(e, "known_crossing_step", r->crossings, step);
}

static void emit_tables(const struct emitter *e, const struct reference *r)
{
	const struct model *written = e->model->relative ? e->model->written : e->model;
	double *initial = ARRAY(double, (size_t)r->states);
	for (int i = 0; i < r->states; i++)
		initial[i] = e->step->replayed ? r->start[i] : round_rational(written->initial[i]);
	emit_table(e, "The spec's initial values", "known_initial", 0, r->states, initial);
	emit_table(e, "Where the states begin that are known", "known_start", 0, r->states, r->start);
	emit_table(e, "Those after so many steps", "known_states", r->rows, r->states, r->value);
	emit_step_counts(e, "known_steps", r->rows, r->steps);
	if (e->step->series.emitted)
		emit_table(e, "At h/2", "known_between", 0, r->states, r->between);
	emit_table(e, "A unit in the last place of the largest value that each state takes", "known_unit", 0, r->states,
		   r->unit);
	if (r->crossings)
		emit_crossings(e, r);
}

static void emit_sample(const struct emitter *e)
{
	open_function(e, NULL, "static void $n_known_sample(double ramp, double u[$N_INPUTS])");
	for (int i = 0; i < outer_inputs(e->model); i++)
		say(e, "    u[%d] = %s;\n", i, e->system->input[i].hold ? "ramp" : "1.0");
	close_function(e, e->ramps ? "" : "ramp");
}

static void emit_begin(const struct emitter *e)
{
	open_function(e, NULL, "static void $n_begin_again($n *s)");
	if (e->ramps)
		say(e, "    double u[$N_INPUTS];\n");
	if (e->step->replayed)
		say(e, "    $n_init(s);\n");
	else
		emit_nominal_factors(e);
	say(e, "    $n_set(s, 0.0, $n_known_start);\n");
	if (e->ramps)
		say(e, "    $n_known_sample(1.0, u);\n"
		       "    $n_hold(s, u);\n");
	close_function(e, "");
}

void emit_selftest(const struct emitter *e, bool jumps)
{
	const struct reference r = e->step->replayed ? *e->step->replayed : reference_of(e->step->shown);
	emit_tables(e, &r);
	if (outer_inputs(e->model))
		emit_sample(e);
	emit_begin(e);
	emit_sizes(e, "selftest.h", { "STATES", r.states }, { "INPUTS", outer_inputs(e->model) }, { "ROWS", r.rows },
		   { "CROSSED", r.crossings },
		   { "JUMPS", jumps }, { "AT", e->step->series.emitted });
	say_macro(e, "KNOWN_H", format("%s_H", e->upper));
	if (r.crossings)
		say_macro(e, "MAX_EVENTS", format("%s_MAX_EVENTS", e->upper));
	say_include(e, "selftest.h");
}
