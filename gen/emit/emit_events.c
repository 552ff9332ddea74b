/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts, contacts at rest and dry friction beside a series: their tables, and how the search of events makes the
 * series anew. */
#include "emit/emit.h"

static const struct contacts *contacts(const struct emitter *e)
{
	return e->step->expansion->contacts;
}

bool meets_contacts(const struct emitter *e)
{
	return e->step->expansion && contacts(e);
}

/* ---- tables ---- */

static int watch_or_none(int watch)
{
	return watch == NONE ? -1 : watch;
}

static int rank_in(const struct emitter *e, int expression, int breakpoint)
{
	return e->step->expansion->expression[expression].rank[breakpoint];
}

static void emit_watches(const struct emitter *e)
{
	const struct contacts *c = contacts(e);
	say(e, "\n/* What the search of events watches beside expressions: the column of each */\n"
	       "static const int $n_event_watch[%d] = {", c->watches);
	for (int i = 0; i < c->watches; i++)
		say(e, "%s%d", i ? ", " : "", c->watch[i].column);
	say(e, "};\n");
}

static void emit_rows(const struct emitter *e, const char *name, const char *note, int rows, int kind)
{
	const struct contacts *c = contacts(e);
	int states = e->system->states;
	say(e, "static const double $n_%s[%d][$N_STATES] = {  /* %s */\n", name, rows > 0 ? rows : 1, note);
	for (int i = 0; i < rows; i++) {
		const double *row = kind ? c->strike[i].back : c->hold[i].back;
		say(e, "    {");
		for (int j = 0; j < states; j++)
			say(e, "%s%s", j ? ", " : "", shortest(row[j]));
		say(e, "},\n");
	}
	say(e, "%s};\n", rows > 0 ? "" : "    {0.0}\n");
}

static void emit_holds(const struct emitter *e)
{
	const struct contacts *c = contacts(e);
	say(e, "\n/* What is held: expression, interval; watches: its velocity, what lets it go down, up; impact */\n"
	       "static const pl_hold $n_event_hold[%d] = {\n", c->holds > 0 ? c->holds : 1);
	for (int i = 0; i < c->holds; i++) {
		const struct series_hold *h = &c->hold[i];
		say(e, "    {%d, %d, %d, %d, %d, %d},\n", h->expression, rank_in(e, h->expression, h->breakpoint) + 1,
		    h->velocity, watch_or_none(h->pull[0]), watch_or_none(h->pull[1]), watch_or_none(h->impact));
	}
	say(e, "%s};\n", c->holds > 0 ? "" : "    {0, 0, 0, -1, -1, -1}\n");
	emit_rows(e, "event_back", "of each: what is taken from the states for a velocity of 1", c->holds, 0);
}

static void emit_strikes(const struct emitter *e)
{
	const struct contacts *c = contacts(e);
	say(e, "\n/* Impacts: expression, breakpoint, upward, hold; watches: guard, speed; assignments: its own, "
	       "without restitution, how many; restitution; of the expression for a guard of 1 */\n"
	       "static const pl_strike $n_event_strike[%d] = {\n", c->strikes > 0 ? c->strikes : 1);
	for (int i = 0; i < c->strikes; i++) {
		const struct series_strike *s = &c->strike[i];
		int rank = rank_in(e, s->expression, s->breakpoint) + (s->hold != NONE && !s->upward);
		say(e, "    {%d, %d, %d, %d, %d, %d, %d, %d, %d, %s, %s},\n", s->expression, rank, s->upward,
		    watch_or_none(s->hold), s->place, s->speed, s->jump, s->still, s->jumps,
		    shortest(s->restitution), shortest(s->per));
	}
	say(e, "%s};\n", c->strikes > 0 ? "" : "    {0, 0, 0, -1, 0, 0, 0, 0, 0, 0.0, 1.0}\n");
	emit_rows(e, "event_place", "of each: what is taken from the states for a guard of 1", c->strikes, 1);
	const char *state = "", *value = "";
	for (int i = 0; i < c->assignments; i++) {
		state = format("%s%s%d", state, i ? ", " : "", c->assignment[i].state);
		value = format("%s%s%d", value, i ? ", " : "", c->assignment[i].watch);
	}
	say(e, "static const int $n_event_jumps[] = {%s}, $n_event_after[] = {%s};  /* states, watches */\n",
	    *state ? state : "0", *value ? value : "0");
}

void emit_event_tables(const struct emitter *e)
{
	const struct contacts *c = contacts(e);
	const char *conflict = "";
	emit_watches(e);
	emit_holds(e);
	emit_strikes(e);
	for (int i = 0; i < c->conflicts; i++)
		conflict = format("%s%s{%luu, %d, %d}", conflict, i ? ", " : "", c->conflict[i].set,
				  watch_or_none(c->conflict[i].hold), c->conflict[i].side);
	say(e, "static const pl_conflict $n_event_conflict[] = {%s};  /* what cannot be held all at once */\n"
	       "static const pl_events $n_events = {\n"
	       "    &$n_divided, $N_STATES, $n_event_watch, %d, $n_event_hold, $n_event_back[0], %d, $n_event_strike,\n"
	       "    $n_event_place[0],\n"
	       "    $n_event_jumps, $n_event_after, %d, $n_event_conflict, $N_H, $N_MAX_EVENTS\n"
	       "};\n", *conflict ? conflict : "{0u, -1, 0}", c->holds, c->strikes, c->conflicts);
}

/* ---- the series anew ---- */

void emit_event_functions(const struct emitter *e)
{
	const char *u = e->system->inputs ? "    const double *const u = f->u;\n" : "";
	say(e, "\ntypedef struct $n_from {  /* from where a series goes */\n"
	       "    const $n *s;\n"
	       "    double tau, when;     /* after now; between then and its end */\n"
	       "%s"
	       "} $n_from;\n"
	       "\nstatic void $n_again(const void *from, const int *interval, const double *y, double *c, "
	       "double *terms)\n"
	       "{\n"
	       "    const $n_from *const f = (const $n_from *)from;\n"
	       "    const $n *const s = f->s;\n"
	       "%s", e->system->inputs ? "    const double *u;\n" : "", u);
	emit_input_samples(e);
	say(e, "    ");
	say_wrapped(e, format("%s\n", expand_call(e, "f->tau", "f->when", "s->segment", "", "y",
						  spell(e, "(double (*)[$c])c"))));
	if (e->system->inputs)
		say(e, "    (void)u;\n");
	say(e, "}\n"
	       "\n/* A series from there, in these intervals; terms and work: room */\n"
	       "static pl_instant $n_instant(const $n_from *from, double *y, double *rest, double *c, double *terms,\n"
	       "    double *work, $n_contact *contact)\n"
	       "{\n"
	       "    static const pl_chain none = {-$N_H, 0.0, 0.0, 0u, 0, 0, 0, 0, 0};\n"
	       "    pl_instant at;\n"
	       "    at.expand = $n_again;\n"
	       "    at.from = from;\n"
	       "    at.y = y;\n"
	       "    at.rest = rest;\n"
	       "    at.c = c;\n"
	       "    at.terms = terms;\n"
	       "    at.work = work;\n"
	       "    at.interval = contact->interval;\n"
	       "    at.total = &contact->total;\n"
	       "    at.crossings = &contact->crossings;\n"
	       "    at.rested = &contact->rested;\n"
	       "    at.crossing = contact->crossing;\n"
	       "    at.last = &contact->last;\n"
	       "    at.time = 0.0;\n"
	       "    at.next = contact->last;\n"
	       "    at.strike = at.freed = -1;\n"
	       "    at.status = 0;\n"
	       "    at.chain = none;\n"
	       "    return at;\n"
	       "}\n");
}

void emit_event_room(const struct emitter *e, const char *indent, const char *y, const char *rest, const char *c,
		     const char *contact)
{
	say(e, "%sdouble work[PL_DIVIDED_WORK(%d)];\n"
	       "%sint splits = %d;\n"
	       "%s$n_from from = {s, 0.0, $n_time(s) + 0.5 * $N_H%s};\n"
	       "%spl_instant at = $n_instant(&from, %s, %s, %s, terms, work, %s);\n",
	    indent, e->step->expansion->order, indent, max_splits(e->model), indent, e->system->inputs ? ", u" : "",
	    indent, y, rest, c, contact);
}

void emit_event_locate(const struct emitter *e)
{
	say(e, "\n/* The intervals of a state that was set */\n"
	       "static void $n_locate(const $n *s, %s$n_contact *contact)\n"
	       "{\n"
	       "    double c[%d][$c], terms[%d], y[$N_STATES], rest[$N_STATES];\n",
	    driven_parameter(e), e->step->expansion->order + 1, terms_of_events(e));
	emit_event_room(e, "    ", "y", "rest", "c[0]", "contact");
	say(e, "    int i;\n"
	       "    for (i = 0; i < $N_STATES; i++) {\n"
	       "        y[i] = s->y[i];\n"
	       "        rest[i] = 0.0;\n"
	       "    }\n"
	       "    contact->placed = 1;\n"
	       "    pl_events_place(&$n_events, &at);\n"
	       "    (void)splits;\n"
	       "}\n");
}
