/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The function that expands the solution: what it is given, what of loads and inputs it reads, its coefficients. */
#include "emit/emit.h"

#include <string.h>

static const struct expansion *expansion(const struct emitter *e)
{
	return e->step->expansion;
}

static bool changes(const struct emitter *e)
{
	return e->system->segments > 1;
}

bool is_divided(const struct emitter *e)
{
	return e->step->divided != NULL;
}

bool has_offset(const struct emitter *e)
{
	return e->model->truncation.adaptive || changes(e) || is_divided(e);
}

bool spans_steps(const struct emitter *e)
{
	return e->step->expansion && !e->step->collocation && e->model->truncation.over > 1;
}

bool has_choices(const struct emitter *e)
{
	for (int i = 0; i < expansion(e)->count; i++)
		if (expansion(e)->sequence[i].kind == SEQUENCE_CHOICE &&
		    expansion(e)->sequence[i].choice == CHOICE_BY_TIME && expansion(e)->sequence[i].top >= 0)
			return true;
	return false;
}

/* ---- the expansion ---- */

static const char *input_parameters(const struct emitter *e, enum input_names names)
{
	const struct expansion *x = expansion(e);
	bool input = any_of(x->input, e->system->inputs), slope = any_of(x->slope, e->system->inputs);
	bool typed = names == AS_PARAMETERS, started = names == AS_SAMPLES && e->ramps;
	return format("%s%s", !input ? "" : typed ? "const double u[], " : started ? "start, " : "u, ",
		      !slope && !(input && e->ramps) ? "" : typed ? "const double slope[], " : "slope, ");
}

const char *driven_parameter(const struct emitter *e)
{
	return e->system->inputs ? format("const double u[%s_INPUTS], ", e->upper) : "";
}

void emit_input_samples(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	int inputs = e->system->inputs;
	const char *start = "", *slope = "";
	bool input = any_of(x->input, inputs), any = any_of(x->slope, inputs) || (input && e->ramps);
	for (int i = 0; i < inputs; i++) {
		bool ramp = e->system->input[i].hold;
		start = format("%s%s%s[%d]", start, i ? ", " : "", ramp ? "s->u" : "u", i);
		slope = format("%s%s%s", slope, i ? ", " : "", ramp ? ramp_slope(e, i) : "0.0");
	}
	if (input && e->ramps)
		say(e, "    const double start[$N_INPUTS] = {%s};\n", start);
	if (any)
		say(e, "    const double slope[$N_INPUTS] = {%s};\n", slope);
}

void emit_inputs_now(const struct emitter *e)
{
	int inputs = e->system->inputs;
	open_function(e, "Samples at the start of this step, their slopes in h",
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

static void emit_expansion_locals(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
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
	const struct expansion *x = expansion(e);
	int segments = e->system->segments, stride = x->order + 1;
	if (!x->slots)
		return;
	const char **note = ARRAY(const char *, (size_t)x->order);
	for (int k = 0; k < x->order; k++)
		note[k] = format("of coefficient %d", k + 1);
	double *value = ARRAY(double, (size_t)(segments * x->order * x->slots)), *to = value;
	for (int s = 0; s < segments; s++)
		for (int k = 0; k < x->order; k++)
			for (int j = 0; j < x->slots; j++)
				*to++ = x->changing[(j * segments + s) * stride + k];
	emit_array(e, "What the load states add to each coefficient, in each segment of time", "force", 3,
		   (const int[]){ segments, x->order, x->slots }, value, note);
}

void emit_coefficients(const struct emitter *e)
{
	emit_expansion_locals(e);
	emit_series_locals(e);
}

bool expands_in_step(const struct emitter *e)
{
	enum { MOST = 1000 };           /* multiplications, which then stand twice: NAME_at makes the series too */
	return !has_offset(e) && !has_choices(e) && !e->ramps && expansion(e)->multiplications <= MOST;
}

/* What of its parameters an expansion, or a part of one, may not read */
static const char *unread(const struct emitter *e, const struct recurrences *r, bool part)
{
	const struct expansion *x = expansion(e);
	const int inputs = e->system->inputs;
	const bool slope = any_of(x->slope, inputs) || (any_of(x->input, inputs) && e->ramps);
	const bool when = has_choices(e) && !part && !tape_reads(tape_of_recurrences(r), TAPE_TIME, -1, 1);
	return format("s %s%s%s%s%s", has_offset(e) || part ? "tau " : "", changes(e) && !part ? "segment " : "",
		      slope ? "slope " : "", when ? "when " : "", part ? "interval " : "");
}

static const char *series_parameters(const struct emitter *e)
{
	return format("%s%s%s%s%s", has_offset(e) ? "double tau, " : "", has_choices(e) ? "double when, " : "",
		      changes(e) ? "int segment, " : "", input_parameters(e, AS_PARAMETERS),
		      is_divided(e) ? format("const int interval[%d], ", expansion(e)->expressions) : "");
}

/* The coefficients that are kept, of states and beside them, into c[][]; sizes for the search of events into terms[] */
static void set_kept_coefficients(const struct emitter *e, struct recurrences *r)
{
	const struct expansion *x = expansion(e);
	struct tape *t = tape_of_recurrences(r);
	int states = e->system->states;
	for (int k = 0; k <= x->order; k++)
		for (int i = 0; i < states + x->columns; i++) {
			const char *target = format("c[%d][%d]", k, i);
			if (i < states || k <= x->column_top[i - states])
				series_set(r, target, i < states ? i : x->column[i - states], k);
			else
				tape_set(t, target, tape_number(t, 0), 10, NULL);
		}
	for (int i = 0; i < x->expressions; i++)
		tape_set(t, format("terms[%d]", i), recurrence_size(r, x->expression[i].sequence), 10, NULL);
	for (int i = 0; x->contacts && i < x->contacts->watches; i++)
		tape_set(t, format("terms[%d]", x->expressions + i),
			 recurrence_whole_size(r, x->contacts->watch[i].sequence), 10, NULL);
}

void emit_expand_function(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	struct recurrences *r = series_new(e);
	open_function(e, format("The series of the solution from %s on: c[k] = %s^k/k! times y's k-th derivative",
				has_offset(e) ? "tau after now" : "now",
				spans_steps(e) ? format("(%d h)", e->model->truncation.over) : "h"),
		      "static void $n_expand(const $n *s, %sconst double y[$N_STATES], double c[%d][$c]%s)",
		      series_parameters(e), x->order + 1,
		      is_divided(e) ? format(",\n    double terms[%d]", terms_of_events(e)) : "");
	emit_expansion_locals(e);
	set_kept_coefficients(e, r);
	emit_series_tape(e, r);
	close_function(e, unread(e, r, false));
}

/* ---- some sequences alone: what is left over, or expressions at the ends of a step ---- */

/* Of such a function, behind the instance and tau */
static const char *part_parameters(const struct emitter *e)
{
	return format("%s%s%sconst int interval[%d], const double y[%s_STATES]", has_choices(e) ? "double when, " : "",
		      expansion(e)->slots ? "int segment, " : "", input_parameters(e, AS_PARAMETERS),
		      expansion(e)->expressions,
		      e->upper);
}

void emit_frozen_function(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	open_function(e, "What is left over at state y, tau after now, with the formulas of these intervals: a\n"
		      " * force on each equation that has some",
		      "static void $n_within(const $n *s, double tau, %s,\n"
		      "    double left[%d])", part_parameters(e), x->columns);
	struct recurrences *r = series_new(e);
	emit_expansion_locals(e);
	for (int c = 0; c < x->columns; c++)
		series_set(r, format("left[%d]", c), x->column[c], 0);
	emit_series_tape(e, r);
	close_function(e, unread(e, r, true));
}

void emit_ends_function(const struct emitter *e)
{
	const struct expansion *x = expansion(e);
	open_function(e, "Of each expression at state y, tau after now, its value and h times its slope; the sizes\n"
		      " * of the terms of the value",
		      "static void $n_end(const $n *s, double tau, %s,\n"
		      "    double e[][%d], double terms[%d])", part_parameters(e), x->columns, x->columns);
	struct recurrences *r = series_new(e);
	emit_expansion_locals(e);
	for (int k = 0; k <= 1; k++)
		for (int c = 0; c < x->columns; c++)
			series_set(r, format("e[%d][%d]", k, c), x->column[c], k);
	for (int c = 0; c < x->columns; c++)
		tape_set(tape_of_recurrences(r), format("terms[%d]", c), recurrence_size(r, x->column[c]), 10, NULL);
	emit_series_tape(e, r);
	close_function(e, unread(e, r, true));
}

/* from: p->, of a part of a step */
const char *frozen_call(const struct emitter *e, const char *function, const char *s, const char *tau,
			const char *from, const char *y, const char *result)
{
	const struct expansion *x = expansion(e);
	bool input = any_of(x->input, e->system->inputs), slope = any_of(x->slope, e->system->inputs);
	const char *u = !input ? "" : format("%su, ", from);
	const char *rate = !slope && !(input && e->ramps) ? "" : format("%sslope, ", from);
	return format("%s_%s(%s, %s, %s%s%s%s%sinterval, %s, %s);", e->name, function, s, tau,
		      has_choices(e) ? format("%swhen, ", from) : "",
		      x->slots ? format("%ssegment, ", from) : "", u, rate, from, y, result);
}

const char *series_arguments(const struct emitter *e, const char *tau, const char *when, const char *segment,
			     enum input_names names, const char *contact)
{
	return format("%s%s%s%s%s", has_offset(e) ? format("%s, ", tau) : "",
		      has_choices(e) ? format("%s, ", when) : "", changes(e) ? format("%s, ", segment) : "",
		      input_parameters(e, names), is_divided(e) ? format("%sinterval, ", contact) : "");
}

const char *expand_call(const struct emitter *e, const char *tau, const char *when, const char *segment,
			const char *contact, const char *y, const char *c)
{
	const char *arguments = series_arguments(e, tau, when, segment, AS_SAMPLES, contact);
	return format("%s_expand(s, %s%s, %s%s);", e->name, arguments, y, c,
		      !is_divided(e) ? "" : strcmp(c, "d") == 0 ? ", spare" : ", terms");
}

/* ---- slopes further on ---- */

void emit_slopes_function(const struct emitter *e)
{
	struct recurrences *r = series_new(e);
	open_function(e, "h times the slopes at state y, tau after now",
		      "static void $n_slopes(const $n *s, %sconst double y[$N_STATES], double left[$N_STATES])",
		      series_parameters(e));
	emit_expansion_locals(e);
	for (int i = 0; i < e->system->states; i++)
		series_set(r, format("left[%d]", i), i, 1);
	emit_series_tape(e, r);
	close_function(e, format("%s%sy", unread(e, r, false), is_divided(e) ? "interval " : ""));
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
const char *whole_gain(const struct emitter *e, int state, gain_term *term)
{
	enum { LATE = 3 };
	int order = expansion(e)->order;
	const char *text = "", *late = "";
	for (int k = order; k > order - LATE; k--)
		late = plus(late, term(e, state, k));
	for (int k = order - LATE; k > 0; k--)
		text = plus(text, term(e, state, k));
	return format("%s, %s", *text ? text : "0.0", *late ? late : "0.0");
}

/* Whether one of what is called so, with the number of a state, is not finite: its difference from itself is not 0 */
const char *is_not_finite(const struct emitter *e, const char *before, const char *after)
{
	const char *sum = "";
	for (int i = 0; i < e->system->states; i++)
		sum = format("%s%s(%s%d%s - %s%d%s)", sum, i ? " + " : "", before, i, after, before, i, after);
	return format("%s != 0.0", sum);
}

int terms_of_events(const struct emitter *e)
{
	const struct expansion *x = e->step->expansion;
	return x->expressions + (x->contacts ? x->contacts->watches : 0);
}
