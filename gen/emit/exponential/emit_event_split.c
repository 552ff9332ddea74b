/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Schemes with a remainder from crossing to crossing: what the model's file defines for event_split.h of the runtime,
 * and a full step by the scheme's own tables. */
#include "inner.h"
#include "emit/series/series.h"
#include "emit/steps.h"
#include "step/regions/guards.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"

static const struct event_split *event_split_of(const struct emitter *e)
{
	return e->step->event_split;
}

/* ---- the header ---- */

void emit_event_split_members(const struct emitter *e)
{
	int count = terms_of_events(e);
	if (e->step->normal)
		emit_normal_members(e);
	emit_switching_members(e);
	if (e->system->inputs == 0 && !loads_change(e->system))
		say(e, "    double end[2][%d], terms[%d];  /* of what is watched at the end of the last step */\n"
		       "    int ended;            /* they are there */\n", count, count);
}

void emit_event_split_place(const struct emitter *e)
{
	say(e, "\nstatic void $n_place($n *s);  /* what follows from a state that was set */\n");
}

/* ---- a part of a step ---- */

static int acting_entries(const struct emitter *e)
{
	return event_split_of(e)->layout.size - e->system->states - SPLIT_POWERS * e->model->remainder.force_columns;
}

static void emit_flow_tables(const struct emitter *e)
{
	const struct layout *layout = &event_split_of(e)->layout;
	int size = layout->size, segments = e->system->segments;
	const char **name = layout_names(layout, e->system, e->model);
	double *value = ARRAY(double, (size_t)(segments * size * size));
	for (int i = 0; i < e->system->states; i++)
		name[i] = format("%s'", name[i]);
	for (int i = 0; i < segments * size * size; i++)
		value[i] = event_split_of(e)->slopes[i / (size * size)][i % (size * size)];
	emit_array(e, "x' = A x in each segment of time; x: y, what acts on it, each force with two derivatives",
		   "slope_matrix", 3, (const int[]){ segments, size, size }, value, name);
}

static void emit_acting_inputs(const struct emitter *e)
{
	const struct layout *layout = &event_split_of(e)->layout;
	for (int i = 0; i < e->system->inputs; i++) {
		int at = layout->input[i] - layout->states;
		bool ramp = e->system->input[i].hold;
		say(e, "    acting[%d] = start[%d]%s;\n", at, i, ramp ? format(" + tau * slope[%d]", i) : "");
		if (ramp)
			say(e, "    acting[%d] = slope[%d];\n", at + 1, i);
	}
}

/* The load states and inputs at a time of the step */
static void emit_acting(const struct emitter *e)
{
	const struct layout *layout = &event_split_of(e)->layout;
	bool *wanted = ARRAY(bool, (size_t)e->system->loads), time = false;
	for (int l = 0; l < e->system->loads; l++) {
		wanted[l] = layout->load[l] >= 0;
		time = time || (wanted[l] && e->system->load[l].powers > 1);
	}
	open_function(e, "Load states and inputs, tau after now",
		      "static void $n_acting(const $n *s, const double start[], const double slope[], double tau,\n"
		      "    double acting[])");
	if (time)
		say(e, "    const double t = $n_time(s) + tau;\n");
	struct emitter here = *e;
	here.after = "tau";
	emit_load_states(&here, wanted, true);
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && wanted[l]; k++) {
			const char *value = load_operand(e, l, k);
			say(e, "    acting[%d] = %s;\n", layout->load[l] + k - layout->states, value ? value : "1.0");
		}
	emit_acting_inputs(e);
	close_function(e, "s start slope tau acting");
}

/* ---- a whole step ---- */

static void emit_full(const struct emitter *e)
{
	if (e->step->normal) {
		emit_mode_tables(e);
		return;
	}
	if (e->step->program->loops)
		emit_loop_tables(e);
	if (e->step->program->predicts)
		emit_predictor(e);
	open_function(e, "The scheme's own step, with the formulas of these intervals",
		      "static void $n_full_step($n *s, const double u[], const double start[], const double slope[],\n"
		      "    double when, const int interval[])");
	emit_actions_of_step(e);
	close_function(e, "u start slope when interval");
}

static void emit_algorithm(const struct emitter *e)
{
	const struct expansion *x = event_split_of(e)->event_check;
	emit_sizes(e, "event_split.h", { "STATES", e->system->states }, { "ACTING", acting_entries(e) },
		   { "FORCES", e->model->remainder.force_columns }, { "CARRIES", e->step->carried.count },
		   { "ORDER", x->order }, { "COLUMNS", e->system->states + x->columns },
		   { "SWITCHING_FUNCTIONS", x->functions }, { "TERMS", terms_of_events(e) },
		   { "CONTACTS", meets_contacts(e) }, { "INPUTS", e->system->inputs },
		   { "SEGMENTS", e->system->segments },
		   { "CHOICES", has_choices(by_series(e, e->step->event_split->event_check)) },
		   { "MAX_SPLITS", max_splits(e->model) },
		   { "FAST_PATH", event_split_of(e)->certain < 1 }, { "IN_MODES", e->step->normal != NULL });
	if (e->step->normal)
		emit_mode_sizes(e);
	emit_switching_macros(by_series(e, e->step->event_split->event_check));
	emit_moved_columns(e);
	say(e, "#define PL_FASTEST %s\n"
	       "#define PL_CERTAIN %s\n"
	       "#include \"event_split.h\"\n", shortest(event_split_of(e)->fastest),
		       shortest(event_split_of(e)->certain));
}

void emit_event_split_step(const struct emitter *e)
{
	enum { CUBIC = 3 };
	const struct emitter *l = by_series(e, e->step->event_split->event_check);
	emit_force_table(l);
	emit_frozen_function(by_series(e, e->step->event_split->forces));
	emit_ends_function(by_series(e, e->step->event_split->ends));
	emit_expand_from(l);
	emit_switching_tables(l);
	emit_passing_table(e, CUBIC + meets_contacts(e));
	if (meets_contacts(e)) {
		emit_event_tables(e);
		emit_events_along(e);
	}
	emit_inputs_now(e);
	emit_flow_tables(e);
	emit_acting(e);
	emit_full(e);
	emit_pass_time(e);
	emit_algorithm(e);
	emit_serving_step(e);
}
