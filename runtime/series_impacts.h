/* SPDX-License-Identifier: MIT-0 */
/* series_impacts.h: watches, what is held beside a series, and what contacts.h asks of its impacts and of those at
 * rest; for the runtime's own use: by events.c. */
#ifndef PLRT_SERIES_IMPACTS_H
#define PLRT_SERIES_IMPACTS_H

#include "columns.h"

typedef pl_events contacts;
typedef pl_instant instant;

/* How many at rest are looked at together: 3^MOST combinations, each with a series of its own; how many there may be */
enum { MOST = 4 };
#define RESTING 64

#include "contacts.h"

#ifdef REAL_IS_FLOAT
#define NEAR 0x1p-10f
#else
#define NEAR 0x1p-20
#endif

/* ---- watches ---- */

static column watched(const pl_events *m, const pl_instant *at, int watch)
{
	column w;
	w.m = m->switching;
	w.first = at->c + m->watch[watch];
	w.terms = at->terms[m->switching->expressions + watch];
	return w;
}

static real value_of(const pl_events *m, const pl_instant *at, int watch)
{
	return at->c[m->watch[watch]];
}

/* Its value, 0 where that is but rounding */
static real certain(const column *w)
{
	const real value = column_at(w, 0);
	return magnitude(value) <= noise_of(w->terms) + TINY ? 0 : value;
}

static real speed_terms(const pl_events *m, const pl_instant *at, int k, real along)
{
	const pl_event_impact *p = &m->impact[k];
	const pl_hold *h = &m->hold[p->hold];
	const column speed = watched(m, at, p->speed), pull = watched(m, at, p->upward ? h->down : h->up);
	return speed.terms + along * pull.terms;
}

/* What lets go of a hold to this side; of a contact what over h does not show in its speed is rounding, too: where
 * states pass 0 it is that of the way there. */
static column pull_of(const pl_events *m, const pl_instant *at, int hold, int up)
{
	const int impact = m->hold[hold].impact;
	column w = watched(m, at, up ? m->hold[hold].up : m->hold[hold].down);
	w.terms += impact < 0 ? 0 : speed_terms(m, at, impact, 0) / m->h;
	return w;
}

static int is_still(const pl_events *m, const pl_instant *at, int watch)
{
	const column w = watched(m, at, watch);
	real noise;
	return magnitude(off_start(&w, 0, &noise)) <= noise;
}

static void renew(const pl_events *m, pl_instant *at)
{
	(void)m;
	at->expand(at->from, at->interval, at->y, at->c, at->terms);
}

/* ---- intervals ---- */

/* The hold of an interval, or -1 */
static int hold_of(const pl_events *m, int expression, int interval)
{
	int i;
	for (i = m->holds - 1; i >= 0; i--) {
		if (m->hold[i].expression == expression && m->hold[i].interval == interval) {
			break;
		}
	}
	return i;
}

static int holds_now(const pl_events *m, const pl_instant *at, int hold)
{
	return at->interval[m->hold[hold].expression] == m->hold[hold].interval;
}

/* All that is held, as bits */
static uint64_t held_now(const pl_events *m, const pl_instant *at)
{
	uint64_t held = 0;
	int i;
	for (i = 0; i < m->holds; i++) {
		held |= (uint64_t)holds_now(m, at, i) << i;
	}
	return held;
}

static int interval_of(const pl_events *m, const pl_instant *at, int expression)
{
	(void)m;
	return at->interval[expression];
}

static int interval_before(const pl_events *m, const pl_instant *at, int expression)
{
	(void)m;
	return expression == at->crossed ? at->was : at->interval[expression];
}

static void go_to(const pl_events *m, pl_instant *at, int expression, int interval)
{
	(void)m;
	at->interval[expression] = interval;
}

static int can_be(const pl_events *m, const pl_instant *at)
{
	const uint64_t held = held_now(m, at);
	int i;
	for (i = 0; i < m->conflicts && (held & m->conflict[i].set) != m->conflict[i].set; i++) {
		;
	}
	return i == m->conflicts;
}

static int impact_at(const pl_events *m, int expression, int breakpoint, int upward)
{
	int i;
	for (i = m->impacts - 1; i >= 0; i--) {
		if (m->impact[i].expression == expression && m->impact[i].breakpoint == breakpoint &&
			m->impact[i].upward == upward) {
			break;
		}
	}
	return i;
}

/* ---- the list ---- */

static int listed(const pl_instant *at)
{
	return *at->crossings;
}

static void count_rest(pl_instant *at)
{
	(*at->rested)++;
}

static void say(pl_instant *at, int status)
{
	at->status |= status;
}

static int has_listed(const pl_events *m, pl_instant *at, int loses, real time, int expression, int breakpoint,
					  int upward)
{
	pl_crossing *crossing = at->crossing + *at->crossings;
	if (at->unlisted) {
		return 1;
	}
	if (*at->crossings == m->max_events) {
		return loses;
	}
	crossing->time = time;
	crossing->expression = expression;
	crossing->breakpoint = breakpoint;
	crossing->upward = upward;
	(*at->crossings)++;
	(*at->total)++;
	return 1;
}

/* ---- what is held ---- */

/* From the states: `times` the numbers of a row, or what is watched in their place. What no force moves has none. */
static void take(const pl_events *m, pl_instant *at, int row, const real *back, const int *moving, real times)
{
	const ptrdiff_t first = (ptrdiff_t)row * m->states;
	int i;
	for (i = 0; i < m->states; i++) {
		const int watch = moving ? moving[first + i] : -1;
		const real taken = times * (watch < 0 ? back[first + i] : value_of(m, at, watch));
		if ((taken < 0 || taken > 0) && !pl_not_finite(&taken, 1)) {
			at->y[i] -= taken;
			at->low[i] = 0;
		}
	}
}

static void put_on(const pl_events *m, pl_instant *at, int k)
{
	take(m, at, k, m->place_back, m->place_watch, value_of(m, at, m->impact[k].place));
	renew(m, at);
}

/* Whether a watch is 0 but for rounding */
static int is_none(const pl_events *m, const pl_instant *at, int watch)
{
	const column w = watched(m, at, watch);
	return certain(&w) >= 0 && certain(&w) <= 0;
}

/* What is 0 of a hold, but for rounding: its velocity, or the place of its contact; less so much of it */
static int watch_of(const pl_events *m, int hold, int place)
{
	return place ? m->impact[m->hold[hold].impact].place : m->hold[hold].velocity;
}

static void take_hold(const pl_events *m, pl_instant *at, int hold, int place, real times)
{
	if (place) {
		take(m, at, m->hold[hold].impact, m->place_back, m->place_watch, times);
	} else {
		take(m, at, hold, m->back, m->back_watch, times);
	}
}

/* Whether what is held has moved by more than rounding */
static int is_slack(const pl_events *m, const pl_instant *at, int hold)
{
	return !is_none(m, at, watch_of(m, hold, 0)) ||
		   (m->hold[hold].impact >= 0 && !is_none(m, at, watch_of(m, hold, 1)));
}

static int is_in(const pl_events *m, uint64_t set, int place, int hold)
{
	return (set >> hold & 1) && !(place && m->hold[hold].impact < 0);
}

/* By what each of a set changes when one of them is taken away, as a matrix; others a little less, for some may say the
 * same.  size: so much is tried */
static void answer(const pl_events *m, pl_instant *at, uint64_t set, int place, real size)
{
	const int n = m->holds;
	real *matrix = at->work, *before = matrix + n * n, *y = before + n;
	int i, k;
	for (i = 0; i < m->states; i++) {
		y[i] = at->y[i];
	}
	for (i = 0; i < n; i++) {
		before[i] = is_in(m, set, place, i) ? value_of(m, at, watch_of(m, i, place)) : 0;
	}
	for (k = 0; k < n; k++) {
		if (is_in(m, set, place, k)) {
			take_hold(m, at, k, place, size);
			renew(m, at);
		}
		for (i = 0; i < n; i++) {
			const int both = i != k && is_in(m, set, place, k) && is_in(m, set, place, i);
			const real more = both ? before[i] - value_of(m, at, watch_of(m, i, place)) : 0;
			matrix[i * n + k] = i == k ? 1 : more / size * (1 - NEAR * NEAR);
		}
		for (i = 0; i < m->states; i++) {
			at->y[i] = y[i];
		}
	}
	renew(m, at);
}

/* Takes away what a set is off, all at once, for each moves those that it meets.  0: there is nothing */
static int take_away(const pl_events *m, pl_instant *at, uint64_t set, int place)
{
	const int n = m->holds;
	real *off = at->work + n * n, size = 0;
	int pivot[64], slack = 0, i;
	for (i = 0; i < n; i++) {
		if (is_in(m, set, place, i)) {
			size = larger(size, watched(m, at, watch_of(m, i, place)).terms);
			slack |= !is_none(m, at, watch_of(m, i, place));
		}
	}
	if (!slack) {
		return 0;
	}
	answer(m, at, set, place, NEAR * size);
	for (i = 0; i < n; i++) {
		const int watch = is_in(m, set, place, i) ? watch_of(m, i, place) : -1;
		off[i] = watch < 0 || is_none(m, at, watch) ? 0 : value_of(m, at, watch);
	}
	if (pl_factor(n, at->work, pivot)) {
		pl_solve(n, at->work, pivot, off);
		for (i = 0; i < n; i++) {
			if (is_in(m, set, place, i)) {
				take_hold(m, at, i, place, off[i]);
			}
		}
		renew(m, at);
	}
	return 1;
}

/* Puts a set where it is held, but for rounding: a place that is there stays, for others are held by it. */
static void put_back(const pl_events *m, pl_instant *at, uint64_t set)
{
	int again;
	for (again = 0; again < 4 && (take_away(m, at, set, 0) | take_away(m, at, set, 1)); again++) {
		;
	}
}

static void stop_all(const pl_events *m, pl_instant *at, uint32_t set)
{
	uint64_t holds = 0;
	int k;
	for (k = 0; k < m->impacts; k++) {
		holds |= set >> k & 1 ? (uint64_t)1 << m->impact[k].hold : 0;
	}
	put_back(m, at, holds);
}

/* Takes away by row `row` of the derivatives what this watch is more than rounding off 0; whether it is */
static int take_moved(const pl_events *m, pl_instant *at, int watch, int row)
{
	const column off = watched(m, at, watch);
	if (!(magnitude(certain(&off)) > 0)) {
		return 0;
	}
	take(m, at, row, m->moved->back, m->moved->back_watch, column_at(&off, 0));
	renew(m, at);
	return 1;
}

/* The derivatives of what is held are held with it: by oblique projections, until nothing moves any more. */
static void keep_moved(const pl_events *m, pl_instant *at)
{
	const pl_moved *d = m->moved;
	int sweeps, moving = 1, i, k;
	for (sweeps = 0; d != NULL && sweeps < MOST_SWEEPS && moving; sweeps++) {
		moving = 0;
		for (i = 0; i < m->holds; i++) {
			for (k = 0; k < d->columns && holds_now(m, at, i); k++) {
				const int row = i * d->columns + k, impact = m->hold[i].impact;
				moving |= take_moved(m, at, d->velocity[row], 2 * row);
				moving |= impact >= 0 && take_moved(m, at, d->place[impact * d->columns + k], 2 * row
						+ 1);
			}
		}
	}
}

static void keep(const pl_events *m, pl_instant *at)
{
	put_back(m, at, held_now(m, at));
	keep_moved(m, at);
}

/* 1 or -1: its first derivative that is not 0 but for rounding */
static int way_of(const column *w)
{
	int k;
	for (k = 1; k <= 3 && k <= w->m->degree; k++) {
		if (magnitude(column_at(w, k)) > noise_of(w->terms)) {
			return column_at(w, k) > 0 ? 1 : -1;
		}
	}
	return 0;
}

/* What a column is at most over h */
static real most_of(const column *w)
{
	real most = w->terms;
	int k;
	for (k = 1; k <= w->m->degree; k++) {
		most += magnitude(column_at(w, k));
	}
	return most;
}

/* Whether a slipping contact is driven to this side: where the static limit is above the sliding force, a force below
 * the limit may do so. */
static int is_driven(const pl_events *m, const pl_instant *at, int hold, int up)
{
	const column velocity = watched(m, at, m->hold[hold].velocity);
	const real slope = column_at(&velocity, 1);
	return m->hold[hold].impact < 0 && !holds_now(m, at, hold) && (up ? slope : -slope) > noise_of(velocity.terms);
}

/* Whether what is held would be let go to this side: 1; -1: it is held; 0: it hangs in the balance.  The root at which
 * it is let go may be off by what does not show beside the force over h, as one of third order is.  Where no force
 * holds it, as along x at (1, 0) of a circle, it is let go. */
static int lets_go(const pl_events *m, const pl_instant *at, int hold, int up)
{
	column w;
	real pull;
	if ((up ? m->hold[hold].up : m->hold[hold].down) < 0) {
		return -1;
	}
	w = pull_of(m, at, hold, up);
	pull = column_at(&w, 0);
	if (pl_not_finite(&pull, 1)) {
		return 1;
	}
	pull = certain(&w);
	if (at->freed == hold && at->next.upward == up && magnitude(pull) <= NEAR * most_of(&w)) {
		return 1;
	}
	if (pull > 0 || (pull < 0 && is_driven(m, at, hold, up))) {
		return 1;
	}
	return pull < 0 ? -1 : way_of(&w);
}

/* ---- impacts ---- */

static real unit(const pl_events *m)
{
	return m->h;
}

static real step_of(const pl_events *m)
{
	(void)m;
	return 1;
}

static int rest_of(const pl_events *m, int k)
{
	return m->impact[k].hold < 0 ? -1 : m->hold[m->impact[k].hold].interval;
}

static real depth(const pl_events *m, const pl_instant *at, int k, real *noise)
{
	const column place = watched(m, at, m->impact[k].place);
	return off_start(&place, 0, noise);
}

static real speed_of(const pl_events *m, const pl_instant *at, int k)
{
	const column w = watched(m, at, m->impact[k].speed);
	const real speed = certain(&w);
	return magnitude(speed) <= at->chain.least ? 0 : speed;
}

static real speed_of_met(const pl_events *m, pl_instant *at, int k)
{
	int i;
	for (i = 0; i < m->impacts; i++) {
		const real terms = rest_of(m, i) < 0 ? 0 : speed_terms(m, at, i, m->h);
		at->chain.least = larger(at->chain.least, noise_of(terms));
	}
	return speed_of(m, at, k);
}

static real press_of(const pl_events *m, const pl_instant *at, int k)
{
	const column w = watched(m, at, m->impact[k].speed);
	return column_at(&w, 1);
}

static real least_speed(const pl_events *m, const pl_instant *at, real least)
{
	(void)m;
	return larger(least, at->chain.least);
}

/* The states of so many assignments, all from the same state */
static void assign(const pl_events *m, pl_instant *at, int first, int count)
{
	int k;
	for (k = first; k < first + count; k++) {
		at->y[m->state[k]] = value_of(m, at, m->value[k]);
		at->low[m->state[k]] = 0;
	}
	renew(m, at);
}

static void jump(const pl_events *m, pl_instant *at, int k)
{
	assign(m, at, m->impact[k].jump, m->impact[k].jumps);
}

static void follow(const pl_events *m, pl_instant *at, int jumped)
{
	const pl_series_switching *d = m->switching;
	const real *b = d->at;
	int i;
	for (i = 0; i < d->expressions; b += d->breaks[i++]) {
		const column e = column_of(d, at->c, at->terms, i);
		int *interval = &at->interval[i], way = 1;
		while (way != 0) {
			real off, noise;
			way = 0;
			if (*interval < d->breaks[i]) {
				off = off_start(&e, b[*interval], &noise);
				way = off > noise;
			}
			if (way == 0 && *interval > 0) {
				off = off_start(&e, b[*interval - 1], &noise);
				way = -off > noise ? -1 : 0;
			}
			if (way != 0 && !jumped && is_stopped(m, at, i, way)) {
				way = 0;
			}
			if (way != 0) {
				(void)has_listed(m, at, 1, at->time, i, *interval - (way < 0), way > 0);
			}
			*interval += way;
		}
	}
	renew(m, at);
}

#include "series_rest.h"

#endif
