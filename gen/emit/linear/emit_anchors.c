/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads by anchors: NAME_anchor evaluates their functions every so many steps; the step reads its factors from a table,
 * and outputs turn the load states of the anchor into those of now. */
#include "inner.h"
#include "emit/steps.h"
#include "model/reads.h"
#include "step/linear/forms.h"

/* ---- tables ---- */

/* 0, 1, ...: steps since the anchor */
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
	const struct anchors *anchors = e->step->anchors;
	int words = e->step->program->compensated ? 2 : 1, columns = words * anchors->terms;
	double *value = ARRAY(double, (size_t)(anchors->steps * columns));
	for (int l = 0; l < anchors->steps; l++)
		for (int k = 0; k < columns; k++) {
			const struct coefficient *c = &anchors->factor[l * anchors->terms + k % anchors->terms];
			value[l * columns + k] = k < anchors->terms ? c->value : c->low;
		}
	emit_array(e, format("What a step adds for each load state of the last anchor%s, so many steps after it",
			     words == 2 ? ", then the second words of that" : ""), "turned", 2,
		   (const int[]){ anchors->steps, columns }, value, step_names(anchors->steps));
}

static bool are_turned(const struct emitter *e)
{
	bool any = e->step->anchors->turned;
	for (int l = 0; l < e->system->loads; l++)
		any = any || (e->anchor[l] >= 0 &&
			      (outputs_read(e, l) || (e->step->forced && e->step->forced->load[l])));
	return any;
}

/* Places of a load in a row of NAME_turn: as many as its functions, which stand in the order of the anchor's */
static int turn_place(const struct emitter *e, int load)
{
	int place = 0;
	for (int l = 0; l < load; l++)
		place += e->anchor[l] < 0 ? 0 : oscillates(e->system->load[l].wave) ? 2 : 1;
	return place;
}

static void emit_turns(const struct emitter *e)
{
	const struct anchors *anchors = e->step->anchors;
	int columns = turn_place(e, e->system->loads);
	double *value = ARRAY(double, (size_t)(anchors->steps * columns));
	const char *list = "";
	for (int l = 0; l < e->system->loads; l++) {
		int place = turn_place(e, l);
		if (e->anchor[l] < 0)
			continue;
		list = format("%s%s%s", list, *list ? "; " : "", column_text(&e->system->load[l], 0));
		for (int k = 0; k < anchors->steps; k++)
			for (int f = 0; f <= oscillates(e->system->load[l].wave); f++)
				value[k * columns + place + f] = anchors->turn[2 * (l * anchors->steps + k) + f];
	}
	emit_array(e, format("How loads have turned and grown so many steps after the anchor: e^{a t} cos(w t),\n"
			     " * and sin, of %s", list), "turn", 2, (const int[]){ anchors->steps, columns }, value,
		   step_names(anchors->steps));
}

/* ---- at the anchor ---- */

static void emit_catch_up(const struct emitter *e, const char *what, const char *type, int count)
{
	for (int i = 0; i < count; i++)
		say(e, "    s->%s[%d] = %s_add(s->%s[%d], %s_times($n_%s_step[%d], s->since));\n", what, i, type, what,
		    i, type, what, i);
}

static void emit_anchor(const struct emitter *e)
{
	struct emitter there = *e;
	bool time = false, growth = false;
	there.at_anchor = true;
	for (int l = 0; l < e->system->loads; l++) {
		time = time || (e->anchor[l] >= 0 && e->system->load[l].powers > 1);
		growth = growth || (e->anchor[l] >= 0 && e->growth[l] >= 0 && e->phase[l] >= 0);
	}
	open_function(e, "An anchor now: functions of the loads, from phases that lose nothing however long a run is",
		      "static void $n_drop_anchor($n *s)");
	if (time)
		say(e, "    const double t = $n_time(s);\n");
	if (growth)
		say(e, "    double growth;\n");
	emit_catch_up(e, "phase", "pl_turn", e->phases);
	emit_catch_up(e, "growth", "pl_growth", e->growths);
	for (int l = 0; l < e->system->loads; l++)
		if (e->anchor[l] >= 0)
			emit_load_functions(&there, l);
	say(e, "    s->since = 0;\n");
	close_function(e, "");
}

void emit_anchor_tables(const struct emitter *e)
{
	if (!e->step->anchors)
		return;
	if (e->step->anchors->terms)
		emit_factors(e);
	if (are_turned(e))
		emit_turns(e);
	emit_anchor(e);
}

void emit_anchor_members(const struct emitter *e)
{
	const char *list = "";
	if (!e->step->anchors)
		return;
	for (int l = 0; l < e->system->loads; l++)
		for (int k = 0; k < e->system->load[l].columns && e->anchor[l] >= 0; k++)
			list = format("%s%s%s", list, *list ? ", " : "", column_text(&e->system->load[l], k));
	say(e, "    double anchor[%d];     /* %s at the anchor */\n"
	       "    uint32_t since;       /* steps since then, at most %d */\n",
	    e->anchored, list, e->step->anchors->steps - 1);
}

/* ---- load states from an anchor ---- */

/* Declares those of the anchor, and all others; returns whether there are any of the first */
static bool emit_values_at_anchor(const struct emitter *e, const bool *loads)
{
	bool *others = ARRAY(bool, (size_t)e->system->loads), any = false;
	for (int l = 0; l < e->system->loads; l++) {
		const struct load *load = &e->system->load[l];
		const char *cells = "", *names = "";
		for (int k = 0; k < load->columns; k++) {
			cells = format("%s%ss->anchor[%d]", cells, k ? ", " : "", e->anchor[l] + k);
			names = format("%s%s%s", names, k ? ", " : "", column_text(load, k));
		}
		others[l] = loads[l] && !is_anchored(e->step, l);
		any = any || (loads[l] && !others[l]);
		if (loads[l] && !others[l])
			say(e, "    const double load%d[%d] = {%s};  /* %s at the anchor */\n", l + 1, load->columns,
			    cells, names);
	}
	emit_load_states(e, others, false);
	return any;
}

void emit_loads_at_anchor(const struct emitter *e, const bool *loads)
{
	emit_values_at_anchor(e, loads);
}

void emit_anchored_loads(const struct emitter *e, const bool *loads)
{
	if (emit_values_at_anchor(e, loads))
		say(e, "    const double *const turned = $n_turned[s->since];\n");
}

/* e^{a tau} cos(x + w tau), sin likewise, from those at the anchor */
static void emit_turned_load(const struct emitter *e, int l)
{
	int turn = turn_place(e, l), at = e->anchor[l], number = l + 1;
	emit_load_array(e, l);
	if (oscillates(e->system->load[l].wave))
		say(e, "    load%d[0] = turn[%d] * s->anchor[%d] - turn[%d] * s->anchor[%d];\n"
		       "    load%d[1] = turn[%d] * s->anchor[%d] + turn[%d] * s->anchor[%d];\n",
		    number, turn, at, turn + 1, at + 1, number, turn + 1, at, turn, at + 1);
	else
		say(e, "    load%d[0] = turn[%d] * s->anchor[%d];\n", number, turn, at);
	emit_load_powers(e, l);
}

void emit_turned_loads(const struct emitter *e, const bool *loads, bool time_is_there)
{
	bool *others = ARRAY(bool, (size_t)e->system->loads), any = false, time = time_is_there;
	for (int l = 0; l < e->system->loads; l++) {
		bool turned = loads[l] && e->anchor[l] >= 0;
		any = any || turned;
		others[l] = loads[l] && !turned;
		if (turned && e->system->load[l].powers > 1 && !time) {
			say(e, "    const double t = $n_time(s);\n");
			time = true;
		}
	}
	if (any)
		say(e, "    const double *const turn = $n_turn[s->since];\n");
	for (int l = 0; l < e->system->loads; l++)
		if (loads[l] && !others[l])
			emit_turned_load(e, l);
	emit_load_states(e, others, time);
}
