/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions of a series: what they are handed, what of loads and inputs they read, its coefficients. */
#include "inner.h"
#include "emit/steps.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "step/contacts/series_contacts.h"

/* ---- one of several series ---- */

struct view {
	struct step step;
	struct emitter e;
};

const struct emitter *by_series(const struct emitter *e, struct expansion *x)
{
	struct view *view = NEW(struct view);
	view->step = *e->step;
	view->step.taylor.expansion = x;
	view->e = *e;
	view->e.step = &view->step;
	view->e.spelled.columns =
		format(x->columns && !x->alone ? "%s_STATES + %d" : "%s_STATES", e->upper, x->columns);
	return &view->e;
}

/* ---- what is asked of it ---- */

bool has_switching(const struct emitter *e)
{
	return e->step->taylor.switching != NULL;
}

bool has_offset(const struct emitter *e)
{
	return e->model->truncation.adaptive || loads_change(e->system) || has_switching(e);
}

bool spans_steps(const struct emitter *e)
{
	return e->step->taylor.expansion && !e->step->collocation && e->model->truncation.over > 1;
}

bool has_choices(const struct emitter *e)
{
	return own_expansion(e)->choices;
}

/* ---- the expansion ---- */

const char *driven_parameter(const struct emitter *e)
{
	return e->system->inputs ? format("const double u[%s_INPUTS], ", e->upper) : "";
}

void emit_inputs_now(const struct emitter *e)
{
	int inputs = e->system->inputs;
	open_function(e, "Input samples at the start of this step, and their change over h",
		      "static inline void $n_inputs_now(const $n *s, const double u[], double start[], "
		      "double slope[])");
	for (int i = 0; i < inputs; i++) {
		bool ramp = e->system->input[i].hold;
		say(e, "    start[%d] = %s[%d];\n"
		       "    slope[%d] = %s;\n", i, ramp ? "s->u" : "u", i, i, ramp ? ramp_slope(e, i) : "0.0");
	}
	if (!inputs)
		say(e, "    start[0] = slope[0] = 0.0;  /* there are none */\n");
	close_function(e, "s u");
}

void emit_expansion_locals(const struct emitter *e)
{
	const struct expansion *x = own_expansion(e);
	bool offset = has_offset(e);
	for (int i = 0; i < e->system->inputs; i++) {
		if (x->input[i])
			say(e, "    const double %s = u[%d]%s;\n", input_name(e, i, 0), i,
			    e->system->input[i].hold && offset ? format(" + tau * slope[%d]", i) : "");
		if (x->slope[i])
			say(e, "    const double %s = slope[%d];\n", input_name(e, i, 1), i);
	}
	bool time = x->time;
	for (int l = 0; l < e->system->loads; l++)
		time = time || (x->load[l] && e->system->load[l].powers > 1);
	if (time)
		say(e, "    const double t = $n_time(s)%s;\n", offset ? " + tau" : "");
	struct emitter here = *e;
	here.after = offset ? "tau" : NULL;
	emit_load_states(&here, x->load, true);
	if (x->slots)
		say(e, "    const double (*const force)[%d] = $n_force[segment];\n", x->slots);
}

void emit_force_table(const struct emitter *e)
{
	const struct expansion *x = own_expansion(e);
	int segments = e->system->segments, stride = x->order + 1;
	int rows = x->contacts ? stride : x->order;     /* slopes are sequences of their own there */
	if (!x->slots)
		return;
	const char **note = ARRAY(const char *, (size_t)rows);
	for (int k = 0; k < rows; k++)
		note[k] = format("of coefficient %d", k + 1);
	double *value = ARRAY(double, (size_t)(segments * rows * x->slots)), *to = value;
	for (int s = 0; s < segments; s++)
		for (int k = 0; k < rows; k++)
			for (int j = 0; j < x->slots; j++)
				*to++ = x->changing[(j * segments + s) * stride + k];
	emit_array(e, "What the load states add to each coefficient, in each segment of time", "force", 3,
		   (const int[]){ segments, rows, x->slots }, value, note);
}

void emit_coefficients(const struct emitter *e)
{
	emit_expansion_locals(e);
	emit_series_locals(e);
}

bool expands_in_step(const struct emitter *e)
{
	enum { MOST = 1000 };           /* multiplications, which then stand twice: NAME_at makes the series too */
	return !has_offset(e) && !has_choices(e) && !e->ramps && own_expansion(e)->multiplications <= MOST;
}

void series_set_sizes(struct recurrences *r, const struct expansion *x, const char *target)
{
	struct tape *t = tape_of_recurrences(r);
	for (int i = 0; i < x->functions; i++)
		tape_set(t, format("%s[%d]", target, i), recurrence_size(r, x->function[i].sequence), 10, NULL);
	for (int i = 0; x->contacts && i < x->contacts->watches; i++)
		tape_set(t, format("%s[%d]", target, x->functions + i),
			 recurrence_full_size(r, x->contacts->watch[i].sequence), 10, NULL);
}

/* The coefficients that are kept, of states and beside them, into c[][]; sizes for the search of events into terms[] */
static void set_kept_coefficients(const struct emitter *e, struct recurrences *r)
{
	const struct expansion *x = own_expansion(e);
	struct tape *t = tape_of_recurrences(r);
	int states = e->system->states;
	for (int k = 0; k <= x->order; k++)
		for (int i = 0; i < states + x->columns; i++) {
			const char *target = format("c[%d][%d]", k, i);
			if (i < states || k <= x->column_top[i - states])
				recurrence_set(r, target, i < states ? i : x->column[i - states], k);
			else
				tape_set(t, target, tape_number(t, 0), 10, NULL);
		}
	series_set_sizes(r, x, "terms");
}

struct tape *tape_of_series(const struct emitter *e)
{
	struct recurrences *r = series_new(e);
	set_kept_coefficients(e, r);
	return tape_of_recurrences(r);
}

/* ---- functions of them: the series of the solution, or some sequences alone ---- */

/* Whatever they read, they are handed the same: samples at the start of the step, their slopes in h; the time after
 * now; a time by which conditions on t are decided; the segment of the loads; intervals; the state then. */
static void begin_function(const struct emitter *e, const char *note, const char *name, const char *result)
{
	open_function(e, note, "static void $n_%s(const $n *s, const double u[], const double slope[], double tau,\n"
			       "    double when, int segment, const int interval[], const double y[$N_STATES],\n"
			       "    %s)", name, result);
	emit_expansion_locals(e);
}

static void end_function(const struct emitter *e, const struct recurrences *r)
{
	emit_series_tape(e, r);
	close_function(e, "s u slope tau when segment interval y");
}

void emit_expand_from(const struct emitter *e)
{
	const struct expansion *x = own_expansion(e);
	struct recurrences *r = x->lines ? series_in_loop(e) : series_new(e);
	if (x->lines) {
		series_set_sizes(r, x, "terms");
		set_lines(r, x);
		emit_series_loop_tables(e);
	} else {
		set_kept_coefficients(e, r);
	}
	begin_function(e, format("The series of the solution from %s on: c[k] = %s^k/k! times the k-th derivative of "
				 "y%s", has_offset(e) ? "tau after now" : "now",
				 spans_steps(e) ? format("(%d h)", e->model->truncation.over) : "h",
				 x->lines ? "" : ";\n * x_3, a1_3, p1_3: c[3] of state x, function a1, product p1"),
		       "expand_from", spell(e, "double c[%d][$c], double terms[]", own_expansion(e)->order + 1));
	(x->lines ? emit_series_loop : emit_series_tape)(e, r);
	close_function(e, "s u slope tau when segment interval terms");
}

void emit_slopes_function(const struct emitter *e)
{
	struct recurrences *r = series_new(e);
	begin_function(e, "h times the slopes", "slopes_at", spell(e, "double left[$N_STATES]"));
	for (int i = 0; i < e->system->states; i++)
		recurrence_set(r, format("left[%d]", i), i, 1);
	end_function(e, r);
}

int motion_numbers(const struct emitter *e)
{
	return e->step->taylor.motion
		       ? e->model->n + e->model->spec->count.multipliers + e->model->contacts.drags : 0;
}

void emit_motion_function(const struct emitter *e)
{
	RATIONAL per = ZERO;
	mpq_inv(per, e->model->h);
	struct recurrences *r = series_new(e);
	struct tape *t = tape_of_recurrences(r);
	begin_function(e, "Highest derivatives, multipliers and forces of friction, with what holds", "motion_at",
		       format("double motion[%d]", motion_numbers(e)));
	for (int i = 0; i < motion_numbers(e); i++) {
		const int sequence = own_expansion(e)->motion[i];
		if (sequence == NONE)
			continue;
		tape_ref value = recurrence_number(r, sequence, i < e->model->n);
		tape_set(t, format("motion[%d]", i),
			 i < e->model->n ? tape_scaled(t, round_rational(per), value) : value, 15, NULL);
	}
	end_function(e, r);
}

void emit_frozen_function(const struct emitter *e)
{
	const struct expansion *x = own_expansion(e);
	struct recurrences *r = series_new(e);
	begin_function(e, "Nonlinear remainder: a force on each equation that has one", "forces_at",
		       format("double left[%d]", x->columns));
	for (int c = 0; c < x->columns; c++)
		recurrence_set(r, format("left[%d]", c), x->column[c], 0);
	end_function(e, r);
}

void emit_ends_function(const struct emitter *e)
{
	const struct expansion *x = own_expansion(e);
	struct recurrences *r = series_new(e);
	begin_function(e, "Watched functions: value and h times the slope; sum of sizes of the terms of the value",
		       "ends_at", format("double e[][%d], double terms[%d]", x->columns, x->columns));
	for (int k = 0; k <= 1; k++)
		for (int c = 0; c < x->columns; c++)
			recurrence_set(r, format("e[%d][%d]", k, c), x->column[c], k);
	series_set_sizes(r, e->step->taylor.switching, "terms");
	end_function(e, r);
}

/* ---- its sum ---- */

enum { WRITTEN_OUT = 400 };             /* terms; more are looped over */

bool is_written_out(const struct emitter *e, int degree)
{
	return e->system->states * degree <= WRITTEN_OUT;
}

const char *plus(const char *sum, const char *term)
{
	return !term ? sum : *sum ? format("(%s + %s)", sum, term) : term;
}

/* c_1 + ... + c_P as what is added and what is small beside it: the last three, which come late. Small ones first */
const char *full_gain(const struct emitter *e, int state, gain_term *term, const char *none)
{
	enum { LATE = 3 };
	int order = own_expansion(e)->order;
	const char *text = "", *late = "";
	for (int k = order; k > order - LATE; k--)
		late = plus(late, term(e, state, k));
	for (int k = order - LATE; k > 0; k--)
		text = plus(text, term(e, state, k));
	return format("%s, %s", *text ? text : none, *late ? late : none);
}

void emit_series_ends(const struct emitter *e)
{
	for (int i = 0; i < e->system->states; i++)
		say_wrapped(e, format("const double next%d = pl_accumulate(%s, %s, &low%d);\n", i,
				      coefficient(e, i, 0), full_gain(e, i, coefficient, "0.0"), i));
}

/* Whether the next value of a state is not finite: its difference from itself is not 0 */
const char *is_not_finite(const struct emitter *e)
{
	const char *sum = "";
	for (int i = 0; i < e->system->states; i++)
		sum = format("%s%s(next%d - next%d)", sum, i ? " + " : "", i, i);
	return format("%s != 0.0", sum);
}

int terms_of_events(const struct emitter *e)
{
	const struct expansion *x = e->step->taylor.switching;
	return x->functions + (x->contacts ? x->contacts->watches : 0);
}
