/* SPDX-License-Identifier: MIT-0 */
/* impacts.h: a state of a piecewise-linear model at one instant, and what contacts.h asks of its impacts and of those
 * at rest; for the runtime's own use: by guards.c. */
#ifndef PLRT_IMPACTS_H
#define PLRT_IMPACTS_H

typedef pl_guards searched, contacts;
#define AMPLITUDE(m, i) (m)->amplitude[i]
#include "regions.h"

/* How many at rest are looked at together: 3^MOST combinations */
enum { MOST = 6 };

#include "contacts.h"
#include "agree.h"

/* ---- regions ---- */

/* The guards of a region are from the first to before the last; the set that it holds, -1: none */
static int first_guard(const pl_guards *m, int region)
{
	return m->cached != NULL ? matrix_in(m, region) * m->cached->guards->most : m->first[region];
}

static int last_guard(const pl_guards *m, int region)
{
	const int slot = m->cached != NULL ? matrix_in(m, region) : -1;
	return slot >= 0 ? slot * m->cached->guards->most + m->cached->guards->count[slot] : m->first[region + 1];
}

static int hold_in(const pl_guards *m, int region)
{
	const int slot = m->cached != NULL ? matrix_in(m, region) : -1;
	return slot < 0 ? m->hold[region] : m->set[2 * slot] < m->set[2 * slot + 1] ? 2 * slot : -1;
}

/* x[state] = value . x, all of a set from the same x */
static void assign(const pl_guards *m, int set, real *x, real *work)
{
	const int n = m->size;
	int k;
	if (set < 0) {
		return;
	}
	for (k = m->set[set]; k < m->set[set + 1]; k++) {
		value_of(n, m->value, k, x, work + WORDS * (k - m->set[set]));
	}
	for (k = m->set[set]; k < m->set[set + 1]; k++) {
		put_value(n, m->state[k], work + WORDS * (k - m->set[set]), x);
	}
}

/* ---- derivatives ---- */

#ifdef WITH_DERIVATIVES

static int is_hold(const pl_guards *m, int expression, int interval);

/* The derivative of the assignments of a set; before x has them */
static void vary_set(const pl_guards *m, instant *at, int set)
{
	pl_variation *v = at->v;
	const int n = m->size;
	int p, k;
	if (v == NULL || set < 0) {
		return;
	}
	for (p = 0; p < v->columns + v->pending; p++) {
		real *S = v->S + (ptrdiff_t)p * n;
		for (k = m->set[set]; k < m->set[set + 1]; k++) {
			real value = dot(n, m->value + (ptrdiff_t)k * WORDS * n, S);
			if (p < v->columns) {
				value += varied_row(v, p, v->matrices + OF_ASSIGNMENTS, k, n, at->x);
			}
			v->work[k - m->set[set]] = value;
		}
		for (k = m->set[set]; k < m->set[set + 1]; k++) {
			S[m->state[k]] = v->work[k - m->set[set]];
		}
	}
}

/* Of x - (e - b) back, put on the guard of an impact */
static void vary_place(const pl_guards *m, instant *at, const pl_impact *impact, const real *back)
{
	pl_variation *v = at->v;
	const int n = m->size, function = impact->expression;
	int p, i;
	for (p = 0; v != NULL && p < v->columns + v->pending; p++) {
		real *S = v->S + (ptrdiff_t)p * n, off = dot(n, m->row + (ptrdiff_t)function * n, S);
		if (p < v->columns) {
			off += off_breakpoint(m, v, p, function, impact->breakpoint, at->x);
		}
		for (i = 0; i < n; i++) {
			S[i] -= back[i] * off;
		}
	}
}

/* Impacts at one instant on each other: another order would leave another derivative. */
static void vary_jump(const pl_guards *m, instant *at, int k)
{
	pl_variation *v = at->v;
	const real *back = m->back, *row = m->row + (ptrdiff_t)m->impact[k].expression * m->size;
	int i;
	for (i = 0; v != NULL && i < m->impacts; i++, back += m->size) {
		if (i != k && v->acted >> i & 1 && (m->impact[k].rest < 0 || magnitude(dot(m->size, row, back)) > 0)) {
			pl_doubt_add(&v->doubt, PL_D_ONE_SIDED, m->impact[k].expression, at->time);
		}
	}
	if (v != NULL) {
		v->acted |= (uint32_t)1 << k;
		vary_set(m, at, m->impact[k].jump);
	}
}

/* A guard of an impact that is all but met, where it turns back: e, its polynomial over a piece */
static void miss(const pl_guards *m, const instant *at, int k, const real *e)
{
	pl_variation *v = at->v;
	const real *row = m->guards.row + (ptrdiff_t)m->guard[k].row * m->size;
	real s, peak, size = 0;
	int i;
	if (v == NULL || m->guard[k].impact < 0 || !turns_back(m->degree, e, 1, &s, &peak)) {
		return;
	}
	for (i = 0; i < m->size; i++) {
		size += magnitude(row[i]) * larger(v->scale[i], magnitude(at->x[i]));
	}
	if (pl_saltation_misses(size, m->limit[k] - peak)) {
		pl_doubt_add(&v->doubt, PL_D_GRAZING, m->impact[m->guard[k].impact].expression, at->time);
	}
}

/* Of what is held in its place */
static void vary_held(const pl_guards *m, instant *at)
{
	if (at->v != NULL) {
		vary_set(m, at, hold_in(m, at->c->region));
	}
}

static void meet_guard(const pl_guards *m, instant *at, int k)
{
	pl_variation *v = at->v;
	const pl_guard *g = &m->guard[k];
	int p;
	if (v == NULL) {
		return;
	}
	leave_field(m, at);
	v->acted = 0;
	for (p = 0; p < v->columns; p++) {
		v->dg[p] = varied_row(v, p, v->matrices + OF_GUARDS, k, m->size, at->x);
	}
	meet(m, at, m->guards.row + (ptrdiff_t)g->row * m->size, g->expression);
	v->sticks = g->impact < 0;
	v->upward = g->upward;
}

/* Friction that comes to stick: S+ = S- - b (g_x S- + g_p)/(g_x b), with the direction b of its force, which is what
 * the fields differ by on either side.  No small deceleration divides: rate and q are those of b.  0: it does not */
static int projects(const pl_guards *m, instant *at)
{
	pl_variation *v = at->v;
	const int n = m->size;
	const real *row = m->row + (ptrdiff_t)v->function * n;
	real *q = column_of_time(m, v), rate;
	const int stride = stride_of(m, v->function), up = at->c->region + stride, down = at->c->region - stride;
	const int held = is_hold(m, v->function, interval_in(m, at->c->region, v->function));
	int i, p;
	if (!held || (v->before != up && v->before != down) || matrix_in(m, up) < 0 || matrix_in(m, down) < 0) {
		return 0;
	}
	pl_multiply(n, n, matrix_of(m->A, m, matrix_in(m, up)), at->x, q);
	pl_multiply(n, n, matrix_of(m->A, m, matrix_in(m, down)), at->x, v->work);
	for (i = 0; i < n; i++) {
		q[i] -= v->work[i];
	}
	rate = dot(n, row, q);
	if (!(magnitude(rate) > noise_of(sizes(n, row, q)))) {
		return 0;
	}
	for (p = 0; p < v->columns; p++) {
		const real dg = v->upward ? v->dg[p] : -v->dg[p];
		pl_saltation_pass(n, q, pl_saltation_time(dg, rate), v->S + (ptrdiff_t)p * n);
	}
	return 1;
}

#endif

/* ---- numbers of regions ---- */

static PL_APART int stride_of(const pl_guards *m, int expression)
{
	int stride = 1, i;
	for (i = 0; i < expression; i++) {
		stride *= m->breaks[i] + 1;
	}
	return stride;
}

static PL_APART int interval_in(const pl_guards *m, int region, int expression)
{
	return region / stride_of(m, expression) % (m->breaks[expression] + 1);
}

static int is_possible(const pl_guards *m, int region)
{
	return matrix_in(m, region) >= 0;
}

static int region_now(const instant *at)
{
	return at->c->region;
}

static const real *breakpoints_of(const pl_guards *m, int expression)
{
	const real *at = m->at;
	int i;
	for (i = 0; i < expression; i++) {
		at += m->breaks[i];
	}
	return at;
}

/* Whether an interval is a breakpoint that stands twice, in which a switching function is held */
static int is_hold(const pl_guards *m, int expression, int interval)
{
	const real *b = breakpoints_of(m, expression) + interval;
	return interval > 0 && interval < m->breaks[expression] && !(b[0] > b[-1]);
}

static int interval_of(const pl_guards *m, const instant *at, int expression)
{
	return interval_in(m, at->c->region, expression);
}

static int interval_before(const pl_guards *m, const instant *at, int expression)
{
	return interval_in(m, at->before, expression);
}

static void go_to(const pl_guards *m, instant *at, int expression, int interval)
{
	const int by = interval - interval_of(m, at, expression);
	enter(m, at->c, at->c->region + by * stride_of(m, expression));
}

static void renew(const pl_guards *m, instant *at)
{
	(void)m; /* all is read of x, when it is asked for */
	(void)at;
}

static int can_be(const pl_guards *m, const instant *at)
{
	return is_possible(m, at->c->region);
}

static void keep(const pl_guards *m, instant *at)
{
	VARIED(vary_set(m, at, hold_in(m, at->c->region));)
	assign(m, hold_in(m, at->c->region), at->x, at->work);
}

/* ---- the list ---- */

static int listed(const instant *at)
{
	return at->c->crossings;
}

static void count_rest(instant *at)
{
	at->c->rested++;
}

static void say(instant *at, int status)
{
	at->c->status |= status;
}

/* What loses speed in contacts, or follows from an event, goes on beyond the list, and is counted. */
static int has_listed(const pl_guards *m, instant *at, int loses, real time, int expression, int breakpoint, int upward)
{
	if (!at->crossing) {
		return 1;
	}
	if (!loses || at->c->crossings < m->max_events) {
		return list(m->max_events, at->c, at->crossing, time, expression, breakpoint, upward);
	}
	at->c->total++;
	return 1;
}

/* A switching function that has left its interval other than by an event: by an input, a load or a jump.  Past a bounce
 * a jump alone leads: what rounding has taken beyond one is still before it. */
static void follow(const pl_guards *m, instant *at, int jumped)
{
	walk w;
	int way;
	for (w = first_switch(m->at); arrive(m->switches, m->breaks, at->c->region, &w); leave(&w)) {
		for (; (way = outside(m, at->c, &w, at->x)) != 0 && (jumped || !is_stopped(m, at, w.i, way));
			 w.interval += way) {
			(void)has_listed(m, at, 1, at->time, w.i, w.interval - (way < 0), way > 0);
			enter(m, at->c, at->c->region + way * w.stride);
		}
	}
}

/* ---- impacts ---- */

static real unit(const pl_guards *m)
{
	(void)m;
	return 1;
}

static real step_of(const pl_guards *m)
{
	return m->h;
}

static int rest_of(const pl_guards *m, int k)
{
	return m->impact[k].rest;
}

/* How far the switching function of impact k is off its guard */
static PL_APART real off_guard(const pl_guards *m, const instant *at, int k, real *noise)
{
	const pl_impact *p = &m->impact[k];
	return excess(m, at->c, p->expression, breakpoints_of(m, p->expression)[p->breakpoint], at->x, noise);
}

static real depth(const pl_guards *m, const instant *at, int k, real *noise)
{
	const real e = off_guard(m, at, k, noise);
	return m->impact[k].upward ? e : -e;
}

static real speed_of(const pl_guards *m, const instant *at, int k)
{
	const real *row = m->speed + (ptrdiff_t)k * m->size;
	real speed;
	speed = dot(m->size, row, at->x);
	return magnitude(speed) <= noise_of(sizes(m->size, row, at->x) + m->impact[k].amplitude) ? 0 : speed;
}

static real speed_terms(const pl_guards *m, const instant *at, int k, real along)
{
	const real *row = m->speed + (ptrdiff_t)k * m->size;
	pl_multiply(m->size, m->size, matrix_now(m, at), at->x, at->work);
	return sizes(m->size, row, at->x) + along * sizes(m->size, row, at->work);
}

static real speed_of_met(const pl_guards *m, instant *at, int k)
{
	return speed_of(m, at, k);
}

static real press_of(const pl_guards *m, const instant *at, int k)
{
	real press;
	pl_multiply(m->size, m->size, matrix_now(m, at), at->x, at->work);
	press = dot(m->size, m->speed + (ptrdiff_t)k * m->size, at->work);
	return press;
}

static real least_speed(const pl_guards *m, const instant *at, real least)
{
	const int n = m->size;
	pl_contact flying = *at->c;
	instant then = *at;
	real most = 0;
	int k;
	if (least >= 0) {
		return least;
	}
	then.c = &flying;
	for (k = 0; k < m->impacts; k++) {
		if (touches(m, at, k)) {
			go_to(m, &then, m->impact[k].expression, free_of(m, k));
		}
	}
	for (k = 0; k < n; k++) {
		at->work[k] = sizes(n, matrix_now(m, &then) + k * n, at->x);
	}
	for (k = 0; k < m->impacts; k++) {
		if (touches(m, at, k)) {
			most = larger(most, sizes(n, m->speed + (ptrdiff_t)k * n, at->work));
		}
	}
	return m->h * noise_of(most);
}

static void jump(const pl_guards *m, instant *at, int k)
{
	VARIED(vary_jump(m, at, k);)
	assign(m, m->impact[k].jump, at->x, at->work);
}

static void stop(const pl_guards *m, instant *at, int k)
{
	VARIED(vary_set(m, at, m->impact[k].still);)
	assign(m, m->impact[k].still, at->x, at->work);
}

static void put_on(const pl_guards *m, instant *at, int k)
{
	const real *back = m->back + (ptrdiff_t)k * m->size;
	real noise;
	const real e = off_guard(m, at, k, &noise);
	int i;
	VARIED(vary_place(m, at, &m->impact[k], back);)
	for (i = 0; i < m->size; i++) {
		take_from(m->size, i, back[i] * e, at->x);
	}
}

/* ---- what sticks, rests or slips ---- */

static int impact_of(const pl_guards *m, int expression, int interval)
{
	int k;
	for (k = m->impacts - 1; k >= 0; k--) {
		if (m->impact[k].rest == interval && m->impact[k].expression == expression) {
			break;
		}
	}
	return k;
}

/* Whether a switching function is on a breakpoint that stands twice, and does not fly off; a contact that does: there
 * was no room for its impact */
static int is_there(const pl_guards *m, const instant *at, const walk *w, int breakpoint, int impact)
{
	real noise;
	if (impact >= 0) {
		return touches(m, at, impact) && (w->interval == breakpoint
				|| !(magnitude(speed_of(m, at, impact)) > 0));
	}
	return !(magnitude(excess(m, at->c, w->i, w->at[breakpoint], at->x, &noise)) > noise);
}

static int find_resting(const pl_guards *m, const instant *at, resting *found)
{
	int count = 0, k;
	walk w;
	for (w = first_switch(m->at); arrive(m->switches, m->breaks, at->c->region, &w); leave(&w)) {
		for (k = 1; k < w.breaks && (at->only < 0 || at->only == w.i); k++) {
			if (w.at[k] - w.at[k - 1] > 0 || w.interval < k - 1 || w.interval > k + 1 || count == MOST) {
				continue;
			}
			found[count].impact = impact_of(m, w.i, k);
			if (!is_there(m, at, &w, k, found[count].impact)) {
				continue;
			}
			found[count].expression = w.i;
			found[count++].held = k;
		}
	}
	return count;
}

/* The force of a guard of what sticks, less its limit: above 0 where it lets go, 0 where that is but rounding */
static real pull_of(const pl_guards *m, int k, const real *x)
{
	const int n = m->size, guard_row = m->guard[k].row;
	const real *row = m->guards.row + (ptrdiff_t)guard_row * n, *tangent = m->guards.tangent
			+ (ptrdiff_t)guard_row * n;
	real e, noise;
	e = dot(n, row, x);
	e -= m->limit[k];
	noise =
		noise_of(sizes(n, row, x) + 3 * sizes(n, tangent, x) + magnitude(m->limit[k])
				+ m->guards.amplitude[guard_row]);
	return e > noise || e < -noise ? e : 0;
}

static int rises(const pl_guards *m, int region, int k, const real *x, real *work)
{
	const int n = m->size;
	return heading(n, matrix_of(m->A, m, matrix_in(m, region)), m->guards.row + (ptrdiff_t)m->guard[k].row * n, x,
				   work) > 0;
}

static int holds_in(const pl_guards *m, instant *at, int region, int expression)
{
	int k;
	for (k = first_guard(m, region); k < last_guard(m, region); k++) {
		const real pull = m->guard[k].expression == expression ? pull_of(m, k, at->x) : -1;
		if (pull > 0 || (pull >= 0 && rises(m, region, k, at->x, at->work))) {
			return 0;
		}
	}
	return 2;
}

/* Whether what would be held there is let go to this side at this instant, by a force that is at its limit but for
 * rounding: e'' is then rounding, too, and does not say where e is heading. */
static int is_let_go(const pl_guards *m, int region, int expression, int side, const real *x, real *work)
{
	const int stuck = region - side * stride_of(m, expression);
	int k;
	if (matrix_in(m, stuck) < 0) {
		return 0;
	}
	for (k = first_guard(m, stuck); k < last_guard(m, stuck); k++) {
		if (m->guard[k].expression == expression && m->guard[k].leads * side > 0 && !(pull_of(m, k, x) > 0) &&
			!(pull_of(m, k, x) < 0) && rises(m, stuck, k, x, work)) {
			return 1;
		}
	}
	return 0;
}

static int is_freed(const pl_guards *m, const instant *at, int region, const resting *one, int side, int known)
{
	(void)known;
	return is_let_go(m, region, one->expression, side, at->x, at->work);
}

static int heading_in(const pl_guards *m, instant *at, int region, const resting *one, int *known)
{
	(void)known;
	return heading(m->size, matrix_of(m->A, m, matrix_in(m, region)), m->row + one->expression * m->size, at->x,
				   at->work);
}

static int is_pressed(const pl_guards *m, const instant *at, int impact)
{
	const int region = at->c->region;
	int k, any = 0;
	for (k = first_guard(m, region); k < last_guard(m, region); k++) {
		if (m->guard[k].expression == m->impact[impact].expression) {
			if (!(pull_of(m, k, at->x) < 0)) {
				return 0;
			}
			any = 1;
		}
	}
	return any;
}

#endif
