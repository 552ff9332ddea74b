/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads by refreshes: NAME_refresh evaluates their functions every so many steps; the step reads its factors from a
 * table, and outputs turn the load states of the refresh into those of now. */
#include "inner.h"
#include "emit/steps.h"
#include "model/reads.h"
#include "step/linear/forms.h"

/* ---- tables ---- */

/* 0, 1, ...: steps since the refresh */
static const char **step_names(int steps)
{
	const char **name = ARRAY(const char *, (size_t)steps);
	for (int l = 0; l < steps; l++)
		name[l] = format("%d", l);
	return name;
}

/* Second words behind all first ones */
static void emit_factors(const struct emitter *e)
{
	const struct refresh *refresh = e->step->refresh;
	int words = e->step->program->compensated ? 2 : 1, columns = words * refresh->terms;
	double *value = ARRAY(double, (size_t)(refresh->steps * columns));
	for (int l = 0; l < refresh->steps; l++)
		for (int k = 0; k < columns; k++) {
			const struct coefficient *c = &refresh->factor[l * refresh->terms + k % refresh->terms];
			value[l * columns + k] = k < refresh->terms ? c->value : c->low;
		}
	emit_array(e, format("What a step adds for each load state of the last refresh%s, so many steps after it",
			     words == 2 ? ", then the second words of that" : ""), "rotated", 2,
		   (const int[]){ refresh->steps, columns }, value, step_names(refresh->steps));
}

static bool are_rotated(const struct emitter *e)
{
	bool any = e->step->refresh->rotated;
	for (int l = 0; l < e->system->loads; l++)
		any = any || (e->refresh.phasor[l] >= 0 &&
			      (outputs_read(e, l) || (e->step->forced && e->step->forced->load[l])));
	return any;
}

/* Places of a load in a row of NAME_turn: as many as its functions, which stand in the order of the refresh's */
static int turn_place(const struct emitter *e, int load)
{
	int place = 0;
	for (int l = 0; l < load; l++)
		place += e->refresh.phasor[l] < 0 ? 0 : oscillates(e->system->load[l].forcing) ? 2 : 1;
	return place;
}

static void emit_turns(const struct emitter *e)
{
	const struct refresh *refresh = e->step->refresh;
	int columns = turn_place(e, e->system->loads);
	double *value = ARRAY(double, (size_t)(refresh->steps * columns));
	const char *list = "";
	for (int l = 0; l < e->system->loads; l++) {
		int place = turn_place(e, l);
		if (e->refresh.phasor[l] < 0)
			continue;
		list = format("%s%s%s", list, *list ? "; " : "", column_text(&e->system->load[l], 0));
		for (int k = 0; k < refresh->steps; k++)
			for (int f = 0; f <= oscillates(e->system->load[l].forcing); f++)
				value[k * columns + place + f] = refresh->turn[2 * (l * refresh->steps + k) + f];
	}
	emit_array(e, format("How loads have rotated and grown so many steps after the refresh: e^{a t} cos(w t),\n"
			     " * and sin, of %s", list), "turn", 2, (const int[]){ refresh->steps, columns }, value,
		   step_names(refresh->steps));
}

/* ---- at the refresh ---- */

static void emit_catch_up(const struct emitter *e, const char *what, const char *type, int count)
{
	for (int i = 0; i < count; i++)
		say(e, "    s->%s[%d] = %s_add(s->%s[%d], %s_times($n_%s_step[%d], s->since));\n", what, i, type, what,
		    i, type, what, i);
}

static void emit_refresh(const struct emitter *e)
{
	struct emitter there = *e;
	bool time = false, envelope = false;
	there.refresh.keeps = true;
	for (int l = 0; l < e->system->loads; l++) {
		time = time || (e->refresh.phasor[l] >= 0 && e->system->load[l].powers > 1);
		envelope = envelope || (e->refresh.phasor[l] >= 0 && e->envelope[l] >= 0 && e->phase[l] >= 0);
	}
	open_function(e, "A refresh now: functions of the loads, from phases that lose nothing however long a run is",
		      "static void $n_refresh_phasors($n *s)");
	if (time)
		say(e, "    const double t = $n_time(s);\n");
	if (envelope)
		say(e, "    double envelope;\n");
	emit_catch_up(e, "phase", "pl_phase", e->phases);
	emit_catch_up(e, "envelope", "pl_envelope", e->envelopes);
	for (int l = 0; l < e->system->loads; l++)
		if (e->refresh.phasor[l] >= 0)
			emit_load_functions(&there, l);
	say(e, "    s->since = 0;\n");
	close_function(e, "");
}

void emit_refresh_tables(const struct emitter *e)
{
	if (!e->step->refresh)
		return;
	if (e->step->refresh->terms)
		emit_factors(e);
	if (are_rotated(e))
		emit_turns(e);
	emit_refresh(e);
}

void emit_refresh_members(const struct emitter *e)
{
	const char *list = "";
	if (!e->step->refresh)
		return;
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && e->refresh.phasor[l] >= 0; k++)
			list = format("%s%s%s", list, *list ? ", " : "", column_text(&e->system->load[l], k));
	say(e, "    double phasor[%d];     /* %s at the refresh */\n"
	       "    uint32_t since;       /* steps since then, at most %d */\n",
	    e->refresh.states, list, e->step->refresh->steps - 1);
}

/* ---- load states from a refresh ---- */

/* Declares those of the refresh, and all others; returns whether there are any of the first */
static bool emit_values_at_refresh(const struct emitter *e, const bool *loads)
{
	bool *others = ARRAY(bool, (size_t)e->system->loads), any = false;
	for (int l = 0; l < e->system->loads; l++) {
		const struct load *load = &e->system->load[l];
		const char *cells = "", *names = "";
		for (int k = 0; k < load->columns; k++) {
			cells = format("%s%ss->phasor[%d]", cells, k ? ", " : "", e->refresh.phasor[l] + k);
			names = format("%s%s%s", names, k ? ", " : "", column_text(load, k));
		}
		others[l] = loads[l] && !is_refreshed(e->step, l);
		any = any || (loads[l] && !others[l]);
		if (loads[l] && !others[l])
			say(e, "    const double load%d[%d] = {%s};  /* %s at the refresh */\n", l + 1, load->columns,
			    cells, names);
	}
	emit_load_states(e, others, false);
	return any;
}

void emit_loads_at_refresh(const struct emitter *e, const bool *loads)
{
	emit_values_at_refresh(e, loads);
}

void emit_refreshed_loads(const struct emitter *e, const bool *loads)
{
	if (emit_values_at_refresh(e, loads))
		say(e, "    const double *const rotated = $n_rotated[s->since];\n");
}

/* e^{a tau} cos(x + w tau), sin likewise, from those at the refresh */
static void emit_rotated_load(const struct emitter *e, int l)
{
	int turn = turn_place(e, l), at = e->refresh.phasor[l], number = l + 1;
	emit_load_array(e, l);
	if (oscillates(e->system->load[l].forcing))
		say(e, "    load%d[0] = turn[%d] * s->phasor[%d] - turn[%d] * s->phasor[%d];\n"
		       "    load%d[1] = turn[%d] * s->phasor[%d] + turn[%d] * s->phasor[%d];\n",
		    number, turn, at, turn + 1, at + 1, number, turn + 1, at, turn, at + 1);
	else
		say(e, "    load%d[0] = turn[%d] * s->phasor[%d];\n", number, turn, at);
	emit_load_powers(e, l);
}

void emit_rotated_loads(const struct emitter *e, const bool *loads, bool time_is_there)
{
	bool *others = ARRAY(bool, (size_t)e->system->loads), any = false, time = time_is_there;
	for (int l = 0; l < e->system->loads; l++) {
		bool rotated = loads[l] && e->refresh.phasor[l] >= 0;
		any = any || rotated;
		others[l] = loads[l] && !rotated;
		if (rotated && e->system->load[l].powers > 1 && !time) {
			say(e, "    const double t = $n_time(s);\n");
			time = true;
		}
	}
	if (any)
		say(e, "    const double *const turn = $n_turn[s->since];\n");
	for (int l = 0; l < e->system->loads; l++)
		if (loads[l] && !others[l])
			emit_rotated_load(e, l);
	emit_load_states(e, others, time);
}
