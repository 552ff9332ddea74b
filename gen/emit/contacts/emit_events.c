/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts, contacts at rest and dry friction beside a series: their tables, and how the search of events makes the
 * series anew. */
#include "emit/series/series.h"
#include "emit/text.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "step/contacts/series_contacts.h"
#include "step/regions/guards.h"

#include <string.h>

static const struct contacts *contacts(const struct emitter *e)
{
	return e->step->taylor.switching->contacts;
}

bool meets_contacts(const struct emitter *e)
{
	return e->step->taylor.switching && contacts(e);
}

/* ---- tables ---- */

static int watch_or_none(int watch)
{
	return watch == NONE ? -1 : watch;
}

static int rank_in(const struct emitter *e, int function, int breakpoint)
{
	return e->step->taylor.switching->function[function].rank[breakpoint];
}

/* Their columns in the series, or one behind the other */
static void emit_watches(const struct emitter *e, const char *name, int first)
{
	const struct contacts *c = contacts(e);
	int *column = ARRAY(int, (size_t)c->watches);
	for (int i = 0; i < c->watches; i++)
		column[i] = first == NONE ? c->watch[i].column : first + i;
	say(e, "\n/* What the search of events watches beside switching functions: the column of each */\n");
	emit_int_list(e, name, c->watches, column);
}

static void emit_rows(const struct emitter *e, const char *name, const char *note, int rows, int kind)
{
	const struct contacts *c = contacts(e);
	const int size[] = { rows > 0 ? rows : 1, e->system->states };
	double *value = ARRAY(double, (size_t)(size[0] * size[1]));
	for (int i = 0; i < rows; i++)
		memcpy(value + i * size[1], kind ? c->series_impact[i].back : c->hold[i].back,
		       (size_t)size[1] * sizeof *value);
	emit_array(e, note, name, 2, size, value, NULL);
}

/* What of these rows the state changes: watches, -1 for the numbers; kind as there */
static void emit_row_watches(const struct emitter *e, const char *name, int rows, int kind)
{
	const struct contacts *c = contacts(e);
	const int states = e->system->states;
	int *row = ARRAY(int, (size_t)((rows > 0 ? rows : 1) * states));
	if (!c->moves)
		return;
	for (int i = 0; i < rows * states; i++)
		row[i] = watch_or_none((kind ? c->series_impact[i / states].back_watch
					     : c->hold[i / states].back_watch)[i % states]);
	say(e, "\n/* The same where the state changes it: watches, -1: the numbers above */\n");
	emit_int_list(e, name, rows * states, row);
}

static void emit_holds(const struct emitter *e)
{
	const struct contacts *c = contacts(e);
	const int rows = c->holds > 0 ? c->holds : 1;
	int *row = ARRAY(int, 6 * (size_t)rows), none[] = { 0, 0, 0, -1, -1, -1 };
	for (int i = 0; i < c->holds; i++) {
		const struct series_hold *h = &c->hold[i];
		const int of[] = { h->function, rank_in(e, h->function, h->breakpoint) + 1, h->velocity,
				   watch_or_none(h->pull[0]), watch_or_none(h->pull[1]), watch_or_none(h->impact) };
		memcpy(row + 6 * i, of, sizeof of);
	}
	say(e, "\n/* Constraints: switching function, interval; watches: velocity, what ends it down, up; impact */\n");
	emit_integer_rows(e, "pl_hold", format("event_hold[%d]", rows), rows, 6, c->holds ? row : none);
	emit_rows(e, "event_back", "Of each: what is taken from the states for a velocity of 1", c->holds, 0);
	emit_row_watches(e, "event_back_watch", c->holds, 0);
}

static void emit_series_impacts(const struct emitter *e)
{
	const struct contacts *c = contacts(e);
	say(e, "\n/* Impacts: switching function, breakpoint, upward, hold; watches: guard, speed; assignments: its "
	       "own, without restitution, how many; restitution; of that function for a guard of 1 */\n"
	       "static const pl_event_impact $n_event_impacts[%d] = {\n",
		       c->series_impacts > 0 ? c->series_impacts : 1);
	for (int i = 0; i < c->series_impacts; i++) {
		const struct series_impact *s = &c->series_impact[i];
		int rank = rank_in(e, s->function, s->breakpoint) + (s->hold != NONE && !s->upward);
		say(e, "    {%d, %d, %d, %d, %d, %d, %d, %d, %d, %s, %s},\n", s->function, rank, s->upward,
		    watch_or_none(s->hold), s->place, s->speed, s->jump, s->still, s->jumps,
		    shortest(s->restitution), shortest(s->per));
	}
	say(e, "%s};\n", c->series_impacts > 0 ? "" : "    {0, 0, 0, -1, 0, 0, 0, 0, 0, 0.0, 1.0}\n");
	emit_rows(e, "event_place", "Of each: what is taken from the states for a guard of 1", c->series_impacts, 1);
	emit_row_watches(e, "event_place_watch", c->series_impacts, 1);
	int *state = ARRAY(int, (size_t)c->assignments), *value = ARRAY(int, (size_t)c->assignments);
	for (int i = 0; i < c->assignments; i++) {
		state[i] = c->assignment[i].state;
		value[i] = c->assignment[i].watch;
	}
	emit_int_list(e, "event_jumps", c->assignments, state);
	emit_int_list(e, "event_after", c->assignments, value);
}

static void emit_events(const struct emitter *e, const char *name, const char *switching, const char *watch)
{
	const struct contacts *c = contacts(e);
	say(e, "static const pl_events $n_%s = {\n"
	       "    &$n_%s, $N_STATES, $n_%s, %d, $n_event_hold, $n_event_back[0], %d, $n_event_impacts,\n"
	       "    $n_event_place[0],\n"
	       "    $n_event_jumps, $n_event_after, %d, $n_event_conflict, $N_H, $N_MAX_EVENTS, %d,\n",
	    name, switching, watch, c->holds, c->series_impacts, c->conflicts, most_in_step(e->model));
	say(e, "    %s, %s\n};\n", c->moves ? spell(e, "$n_event_back_watch, $n_event_place_watch") : "NULL, NULL",
	    c->columns > 0 ? spell(e, "&$n_moved") : "NULL");
}

/* ---- derivatives among the states ---- */

static int state_of_own(const struct emitter *e, int own, int state)
{
	return state < e->model->n ? own : e->system->velocity[own];
}

static void emit_places_of_moved(const struct emitter *e)
{
	const int own = e->model->spec->joined.own, stride = e->model->spec->joined.stride;
	const int states = e->system->states, columns = contacts(e)->columns;
	int *column = ARRAY(int, (size_t)states), *of = ARRAY(int, (size_t)states);
	int *time = ARRAY(int, (size_t)columns);
	for (int k = 0; k < columns; k++)
		time[k] = -1;
	for (int i = 0; i < states; i++) {
		const int coord = e->system->coord[i], k = coord < own ? -1 : (coord - own) / stride;
		const int j = k < 0 ? coord : (coord - own) % stride;
		column[i] = j < own ? k : -1;
		of[i] = j < own ? state_of_own(e, j, i) : i;
		if (j == own)
			time[k] = i;
	}
	say(e, "\n/* Derivatives: of each state the column that it is of, -1: of none; the state that it is of; of "
	       "each column that of t */\n");
	emit_int_list(e, "moved_column_of", states, column);
	emit_int_list(e, "moved_from", states, of);
	emit_int_list(e, "moved_time", columns, time);
}

static const struct series_hold *moved_hold(const struct contacts *c, int row)
{
	return &c->hold[c->holds + row];
}

static void emit_watches_of_moved(const struct emitter *e)
{
	const struct contacts *c = contacts(e);
	const int rows = c->forces - c->holds, impacts = c->series_impacts * c->columns;
	int *velocity = ARRAY(int, (size_t)rows + 1), *pull = ARRAY(int, 2 * (size_t)rows + 1);
	int *place = ARRAY(int, (size_t)impacts + 1);
	for (int i = 0; i < rows; i++) {
		velocity[i] = moved_hold(c, i)->velocity;
		for (int up = 0; up < 2; up++)
			pull[2 * i + up] = watch_or_none(moved_hold(c, i)->pull[up]);
	}
	for (int i = 0; i < impacts; i++)
		place[i] = c->series_impact[i / c->columns].slope[i % c->columns];
	say(e, "\n/* Watches of what is held, column by column, and of what lets it go; of guards */\n");
	emit_int_list(e, "moved_velocity", rows, velocity);
	emit_int_list(e, "moved_pull", 2 * rows, pull);
	emit_int_list(e, "moved_place", impacts, place);
}

/* Places are put back along the direction of velocities. */
static void emit_back_of_moved(const struct emitter *e)
{
	const struct contacts *c = contacts(e);
	const int states = e->system->states, rows = c->forces - c->holds;
	const int size[] = { rows > 0 ? 2 * rows : 1, states };
	double *back = ARRAY(double, (size_t)(size[0] * states));
	int *watch = ARRAY(int, (size_t)(size[0] * states));
	for (int i = 0; i < size[0] * states; i++)
		watch[i] = -1;
	for (int i = 0; i < 2 * rows * states; i++) {
		const struct series_hold *hold = moved_hold(c, i / states / 2);
		const int state = i % states, coord = e->system->coord[state];
		const int from = i / states % 2 == 0                                       ? state
				 : state < e->model->n && e->system->velocity[coord] >= 0 ? e->system->velocity[coord]
											  : -1;
		back[i] = from >= 0 ? hold->back[from] : 0;
		watch[i] = from >= 0 ? watch_or_none(hold->back_watch[from]) : -1;
	}
	emit_array(e, "Of each what is taken from the states for a velocity of 1, for a place of 1", "moved_back", 2,
		   size, back, NULL);
	emit_int_list(e, "moved_back_watch", size[0] * states, watch);
}

static void emit_moved(const struct emitter *e)
{
	if (contacts(e)->columns == 0)
		return;
	emit_places_of_moved(e);
	emit_watches_of_moved(e);
	emit_back_of_moved(e);
	say(e, "static const pl_moved $n_moved = {\n"
	       "    %d, $n_moved_column_of, $n_moved_from, $n_moved_time, $n_moved_velocity, $n_moved_pull,\n"
	       "    $n_moved_place, $n_moved_back[0], $n_moved_back_watch\n};\n", contacts(e)->columns);
}

bool moves_derivatives(const struct emitter *e)
{
	return meets_contacts(e) && contacts(e)->columns > 0;
}

void emit_moved_columns(const struct emitter *e)
{
	if (moves_derivatives(e))
		say_macro(e, "MOVED", integer_text(contacts(e)->columns));
}

void emit_event_tables(const struct emitter *e)
{
	const struct contacts *c = contacts(e);
	const char *conflict = "";
	emit_watches(e, "event_watch", NONE);
	emit_holds(e);
	emit_series_impacts(e);
	for (int i = 0; i < c->conflicts; i++)
		conflict = format("%s%s{%lluu, %d, %d, %d}", conflict, i ? ", " : "",
				  (unsigned long long)c->conflict[i].set, watch_or_none(c->conflict[i].hold),
				  c->conflict[i].side, watch_or_none(c->conflict[i].watch));
	say(e, "static const pl_conflict $n_event_conflict[] = {%s};  /* what cannot be held all at once */\n",
	    *conflict ? conflict : "{0u, -1, 0, -1}");
	emit_moved(e);
	emit_events(e, "events", "series_switching", "event_watch");
}

void emit_events_along(const struct emitter *e)
{
	emit_watches(e, "along_watch", e->step->taylor.switching->functions);
	emit_events(e, "along", "passing", "along_watch");
}
