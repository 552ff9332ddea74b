/* SPDX-License-Identifier: MIT-0 */
/* Steps of piecewise-linear models with dry friction and jumps, from event to event.  Event-free pieces go by
 * e^{A d}; others, short ones, by Taylor polynomials, on which the first event is isolated.  What sticks and what slips
 * after an event is found among all combinations of those that are at rest. */
#include "ladder.h"
#include "impacts.h"

/* ---- the start ---- */

/* Puts what is on a plain breakpoint above or below, where it is heading; what rests counts as below. */
static void decide(const pl_guards *m, const real *x, pl_contact *c, real *work)
{
	real noise;
	walk w;
	for (w = first_switch(m->at); arrive(m->switches, m->breaks, c->region, &w); leave(&w)) {
		if (w.interval == w.breaks || is_hold(m, w.i, w.interval) || is_hold(m, w.i, w.interval + 1) ||
			-excess(m, c, w.i, w.at[w.interval], x, &noise) > noise) {
			continue;
		}
		if (heading(m->size, matrix_of(m->A, m, c->matrix), m->row + w.i * m->size, x, work) > 0) {
			enter(m, c, c->region + w.stride);
		}
	}
}

/* A state with nothing listed; before the first impact of a step */
static instant instant_of(const pl_guards *m, real *x, pl_contact *c, pl_crossing *crossing, real *work)
{
	instant at;
	at.x = x;
	at.c = c;
	at.crossing = crossing;
	at.work = work;
	at.time = 0;
	at.before = c->region;
	at.only = -1;
	at.chain = no_impact(m->h);
	VARIED(at.v = (pl_variation *)0;)
	return at;
}

/* Where matrices are sums, each sticks or slips whatever others do. */
static void resolve_all(const pl_guards *m, instant *at, int turned)
{
	int i, sweep, before = -1;
	if (m->cached == NULL) {
		resolve(m, at, turned);
		return;
	}
	for (sweep = 0; sweep <= m->switches && at->c->region != before; sweep++) {
		before = at->c->region;
		for (i = 0; i < m->switches; i++) {
			at->only = i;
			resolve(m, at, turned);
		}
	}
	at->only = -1;
}

/* What is on a breakpoint that stands twice is held first, but for what flies off. */
static void hold_first(const pl_guards *m, instant *at)
{
	walk w;
	for (w = first_switch(m->at); arrive(m->switches, m->breaks, at->c->region, &w); leave(&w)) {
		if (is_hold(m, w.i, w.interval + 1)) {
			const int impact = impact_of(m, w.i, w.interval + 1);
			real noise;
			if (magnitude(excess(m, at->c, w.i, w.at[w.interval], at->x, &noise)) > noise) {
				continue;
			}
			enter(m, at->c, at->c->region + w.stride);
			if (impact >= 0 && magnitude(speed_of(m, at, impact)) > 0) {
				go_to(m, at, w.i, free_of(m, impact));
			}
		}
	}
}

void pl_guards_start(const pl_guards *m, const real *x, pl_contact *c, real *work)
{
	instant at;
	int first = 0, i;
	while (matrix_in(m, first) < 0) {
		first++;
	}
	c->total = 0;
	c->crossings = c->status = c->rested = 0;
	c->matrix = matrix_in(m, first);
	enter(m, c, 0);
	for (i = 0; i < WORDS * m->size; i++) {
		work[i] = x[i];
	}
	at = instant_of(m, work, c, (pl_crossing *)0, work + WORDS * m->size);
	follow(m, &at, 1);
	hold_first(m, &at);
	resolve_all(m, &at, 0);
	decide(m, at.x, c, at.work);
	resolve_all(m, &at, 0);
}

/* ---- a piece ---- */

/* Whether it is certain that no guard becomes greater than its limit between x and y, a piece on.  work: size */
static int stays_event_free(const pl_guards *m, const pl_contact *c, const real *x, const real *y, real *work)
{
	const int n = m->size;
	int i, k;
	for (i = 0; i < n; i++) {
		work[i] = magnitude(x[i]);
	}
	for (k = first_guard(m, c->region); k < last_guard(m, c->region); k++) {
		const ptrdiff_t at = (ptrdiff_t)m->guard[k].row * n;
		real from, to, off, leaving, arriving;
		from = dot(n, m->guards.row + at, x);
		to = dot(n, m->guards.row + at, y);
		off = dot(n, m->guards.chord_error + at, work);
		if (larger(from, to) + off < m->limit[k]) {
			continue;
		}
		off = dot(n, m->guards.cubic_error + at, work);
		leaving = dot(n, m->guards.tangent + at, x);
		arriving = dot(n, m->guards.tangent + at, y);
		if (!(larger(larger(from, to), larger(from + leaving, to - arriving)) + off < m->limit[k])) {
			return 0;
		}
	}
	return 1;
}

/* The same of a piece that is longer than the shortest, by x'' where it begins.  work: 2 size */
static int stays_event_free_far(const pl_guards *m, const pl_contact *c, climb *at, const real *x, const real *y,
								real *bend,
						   real *work)
{
	const int n = m->size;
	int k;
	look_at_bend(at, n, matrix_of(m->A, m, c->matrix), x, bend, work);
	for (k = first_guard(m, c->region); k < last_guard(m, c->region); k++) {
		const int row = m->guard[k].row;
		const real *guard_row = m->guards.row + (ptrdiff_t)row * n;
		real from, to, off;
		from = dot(n, guard_row, x);
		to = dot(n, guard_row, y);
		off = dot(n, m->ladder.reach + ((ptrdiff_t)m->ladder.guard_rows[row] + at->rung - 1) * n, bend);
		if (!(larger(from, to) + off < m->limit[k])) {
			return 0;
		}
	}
	return 1;
}

typedef struct event {
	real s;
	int any, guard;
} event;

static const event no_event = {1, 0, -1};

/* What a force that is at its limit but for rounding has let go moves with a slope that is rounding, too: where that
 * points back it is no event. */
static void level(const pl_guards *m, int region, const pl_guard *g, const real *x, beyond *f, real *work)
{
	const int side = g->leads < 0 ? 1 : -1;
	if (magnitude(f->coefficient[0]) > f->noise || !(f->coefficient[1] > 0)) {
		return;
	}
	if (is_hold(m, g->expression, interval_in(m, region, g->expression) - side) &&
		is_let_go(m, region, g->expression, side, x, work)) {
		f->coefficient[1] = 0;
	}
}

/* Whether a slider without mass has been turned round where this begins: the guard that lets it go, no end of its
 * interval, is passed already, also if it comes back. */
static int is_turned(const pl_guards *m, int region, const pl_guard *g, const beyond *f)
{
	const real *guard_row = m->guards.row + (ptrdiff_t)g->row * m->size, *row = m->row + g->expression * m->size;
	real apart = 0;
	int i;
	if (g->impact >= 0 || !(f->coefficient[0] > f->noise) || !(f->coefficient[1] < 0)) {
		return 0;
	}
	if (is_hold(m, g->expression, interval_in(m, region, g->expression))) {
		return 0; /* it sticks: what lets it go is decided with others that rest */
	}
	for (i = 0; i < m->size; i++) {
		apart = larger(apart, magnitude(guard_row[i] - (g->upward ? row[i] : -row[i])));
	}
	return apart > 0;
}

/* coefficients: (degree + 1) x size; after them 2 (degree + 1) + 4 size for work */
static event first_event(const pl_guards *m, const instant *at, real *coefficients, int *splits)
{
	const int terms = m->degree + 1, n = m->size, region = at->c->region;
	real *e = coefficients + terms * n;
	event first = no_event;
	beyond f;
	int k;
	if (!can_be(m, at)) {
		return no_event;
	}
	f.degree = m->degree;
	f.coefficient = e + terms;
	for (k = first_guard(m, region); k < last_guard(m, region); k++) {
		const real *row = m->guards.row + (ptrdiff_t)m->guard[k].row * n,
				moves = sizes(n, row, coefficients + n);
		const real size = sizes(n, row, coefficients) + (m->guard[k].impact < 0 ? moves : 0);
		real s, next;
		int has_left;
		expand_row(n, terms, row, coefficients, e);
		VARIED(miss(m, at, k, e);)
		next = m->guard[k].impact >= 0 && e[1] < 0 ? moves : -1;
		has_left = next >= 0 && magnitude(e[0] - m->limit[k]) <= noise_of(magnitude(m->limit[k]) + size + next);
		if (!(has_left ? look_behind(&f, e, next) : look_beyond(&f, e, 1, m->limit[k], size))) {
			continue;
		}
		if (m->guard[k].impact < 0) {
			level(m, region, &m->guard[k], coefficients, &f, e + 2 * terms);
		}
		s = is_turned(m, region, &m->guard[k], &f) ? 0 : first_root(&f, first.s, splits);
		if (s < 0) {
			continue;
		}
		first.s = s;
		first.any = 1;
		first.guard = k;
	}
	return first;
}

/* ---- a step ---- */

#define limited shortened
#define hold(m, at, y, work) assign(m, hold_in(m, (at)->c->region), y, work)

static int is_event_free(const pl_guards *m, const instant *at, climb *up, const real *y, real *bend, real *work)
{
	return can_be(m, at) && (up->rung > 0 ? stays_event_free_far(m, at->c, up, at->x, y, bend, work)
									  : stays_event_free(m, at->c, at->x, y, work));
}

/* Into the region to which a guard leads, or by the impact that begins there */
static int pass(const pl_guards *m, instant *at, const event *e, real time)
{
	const pl_guard *g = &m->guard[e->guard];
	const int rest = impact_of(m, g->expression, interval_of(m, at, g->expression));
	pl_chain *chain = &at->chain;
	uint32_t acted = 0;
	at->time = time;
	at->before = at->c->region;
	VARIED(meet_guard(m, at, e->guard);)
	if (g->impact < 0) {
		chain->full = !has_time(m, chain) || !has_listed(m, at, rest >= 0 && m->impact[rest].restitution < 1,
				at->time,
									  g->expression, g->breakpoint, g->upward);
		say(at, chain->full ? PL_TOO_MANY_EVENTS : 0);
	}
	if (g->impact < 0 || m->impact[g->impact].rest < 0) {
		enter(m, at->c, at->c->region + g->leads);
	}
	keep(m, at);
	if (g->impact >= 0) {
		acted = apply_impacts(m, at, g->impact);
		follow(m, at, 0);
	}
	resolve_all(m, at, 1);
	come_to_rest(m, at, acted);
	keep(m, at);
	if (!chain->full) {
		return GO_ON;
	}
	return g->impact >= 0 ? STAY : SEARCH_NO_MORE; /* beyond its guard an impact would not come any more */
}

/* At the start, or behind a change of the loads: what holds may have moved, and what moves may have jumped. */
static void decide_anew(const pl_guards *m, instant *at, int jumped)
{
	follow(m, at, jumped);
	(void)apply_impacts(m, at, -1);
	resolve_all(m, at, 0);
	keep(m, at);
}

static void take_up(const pl_guards *m, instant *at, real time)
{
	at->time = time;
	decide_anew(m, at, 0);
}

#include "pieces.h"

/* Whether what is held is where it is held.  work: WORDS */
static int is_in_place(const pl_guards *m, const pl_contact *c, const real *x, real *work)
{
	const int n = m->size, set = hold_in(m, c->region);
	int i, k;
	for (k = set < 0 ? 0 : m->set[set]; set >= 0 && k < m->set[set + 1]; k++) {
		value_of(n, m->value, k, x, work);
		for (i = 0; i < WORDS; i++) {
			if (!(magnitude(x[i * n + m->state[k]] - work[i]) <= 0)) {
				return 0;
			}
		}
	}
	return 1;
}

/* Whether there is nothing to take up: what is held is in place, and every guard is below its limit by more than
 * rounding, so that nothing touches, leaves its interval or is let go.  work: WORDS */
static int is_taken_up(const pl_guards *m, const pl_contact *c, const real *x, real *work)
{
	int k;
	if (!is_in_place(m, c, x, work)) {
		return 0;
	}
	for (k = first_guard(m, c->region); k < last_guard(m, c->region); k++) {
		if (!(pull_of(m, k, x) < 0)) {
			return 0;
		}
	}
	return 1;
}

void pl_guards_change(const pl_guards *m, real time, real *x, pl_contact *c, pl_crossing *crossing,
					  real *work AND_VARIATION)
{
	instant at = instant_of(m, x, c, crossing, work);
	SET_VARIATION(at);
	at.time = time;
	c->crossings = 0;
	enter_again(m, c);
	decide_anew(m, &at, 1);
}

/* What is beyond the guard of a bounce by more than rounding is reported. */
static void check_places(const pl_guards *m, const instant *at)
{
	int k;
	for (k = 0; k < m->impacts; k++) {
		real noise;
		if (is_before(m, at, k) && depth(m, at, k, &noise) > DEEP * noise &&
			depth(m, at, k, &noise) > DEEP * rounding_of_places(m, at)) {
			at->c->status |= PL_PENETRATED;
		}
	}
}

void pl_guards_advance(const pl_guards *m, real tau, real *x, pl_contact *c, pl_crossing *crossing,
					   real *work AND_VARIATION)
{
	instant at = instant_of(m, x, c, crossing, work);
	const int holds = hold_in(m, c->region) >= 0;
	SET_VARIATION(at);
	c->crossings = 0;
	enter_again(m, c);
	if (holds && !is_taken_up(m, c, x, work)) {
		take_up(m, &at, 0);
	}
	if (!go(m, &at, tau, !holds)) {
		check_places(m, &at);
	}
}

#ifndef STATE_IS_COMPENSATED
#ifndef REAL_IS_FLOAT

int pl_guards_meet(const pl_guards *m, int guard, double time, double *x, pl_contact *c, pl_crossing *crossing,
				   double *work AND_VARIATION)
{
	instant at = instant_of(m, x, c, crossing, work);
	event met = no_event;
	SET_VARIATION(at);
	met.guard = guard;
	c->crossings = 0;
	keep(m, &at);
	return pass(m, &at, &met, time) == GO_ON;
}

#ifdef WITH_DERIVATIVES

void pl_guards_vary_d(const pl_guards *m, double length, double *x, double *end, pl_contact *c, pl_variation *v)
{
	instant at = instant_of(m, x, c, (pl_crossing *)0, v->work);
	at.v = v;
	vary_piece(m, &at, length);
	at.x = end;
	vary_held(m, &at);
}

#else

/* row . x as dot, but for what is 0 in the row: where products are calls, a look at the row costs less. */
static PL_APART double sum_of(int n, const double *row, const double *x)
{
	double sum[4] = {-0.0, -0.0, -0.0, -0.0};
	int j;
	for (j = 0; j < n; j++) {
		real_parts u;
		u.value = row[j];
		if (u.bits << 1 != 0) {
			sum[j % 4] += row[j] * x[j];
		}
	}
	return (sum[0] + sum[2]) + (sum[1] + sum[3]);
}

/* Of a step that meets one guard; bundles have macros up to the text that they are for. */
enum { MET_SIZE = 8, MET_TERMS = 17 };

#define PL(name) unmet_##name
#define PL_SIZE m->size
#define PL_CAPPED 0
#define PL_FEW_REGIONS 0
#define PL_SUM(row, x) sum_of(m->size, row, x)
#define PL_EACH
#define PL_MEETS 1
#define PL_ENTRIES
#define PL_PAIRED m->size
#define PL_MOST_SIZE MET_SIZE
#define PL_MOST_TERMS MET_TERMS
#define PL_DOT(row, x) sum_of(m->size, row, x)
#define PL_ACTS(i, j) 1
#define PL_AND_VARIATION
#include "unmet.h"

void pl_guards_step(const pl_guards *m, double tau, double *x, pl_contact *c, pl_crossing *crossing, double *work)
{
	double *const size = work + m->size;
	int i;
	if (tau < m->h || !unmet_keeps_all(m, c->region, x, work, size, size + m->size)) {
		if (tau < m->h || m->size > MET_SIZE || m->degree >= MET_TERMS ||
			!unmet_meets_one(m, x, c, crossing, work)) {
			pl_guards_advance(m, tau, x, c, crossing, work);
		}
		return;
	}
	for (i = 0; i < m->size; i++) {
		x[i] = work[i];
	}
	c->crossings = 0;
}

#endif
#endif
#endif
