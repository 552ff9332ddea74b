/* SPDX-License-Identifier: MIT-0 */
/* Steps of piecewise-linear models, in pieces, most of which a bound shows to be event-free; the
 * others are so short that the fastest pole does not turn far, and go by Taylor polynomials, on which the first
 * crossing is isolated before it is computed, so none is stepped over. */
#ifndef STATE_IS_COMPENSATED
#ifndef WITH_DERIVATIVES
#include "columns.h"
#endif
#endif
#include "ladder.h"
#include "roots.h"

typedef pl_switching searched;
#define AMPLITUDE(m, i) 0
#include "regions.h"

static const real *rows_of(const real *all, const pl_switching *m, const pl_contact *c)
{
	return all + (ptrdiff_t)c->matrix * m->switches * m->size;
}

/* ---- the start ---- */

/* Puts what is on its upper breakpoint in region `below` above or below that: where it is heading or, with `possible`,
 * so that the region can occur. */
static void decide(const pl_switching *m, const real *x, pl_contact *c, int below, int possible, real *work)
{
	real noise;
	walk w;
	for (w = first_switch(m->at); arrive(m->switches, m->breaks, below, &w); leave(&w)) {
		const int above = c->region / w.stride % (w.breaks + 1) - w.interval;
		int sign;
		if (w.interval == w.breaks || -excess(m, c, w.i, w.at[w.interval], x, &noise) > noise) {
			continue;
		}
		if (!possible) {
			sign = heading(m->size, matrix_of(m->A, m, c->matrix), m->row + w.i * m->size, x, work);
			if (sign != 0) {
				enter(m, c, c->region + ((sign > 0) - above) * w.stride);
			}
		} else if (matrix_in(m, c->region) < 0 && !above && matrix_in(m, c->region + w.stride) >= 0) {
			enter(m, c, c->region + w.stride);
		}
	}
}

void pl_switching_start(const pl_switching *m, const real *x, pl_contact *c, real *work)
{
	int i, below;
	walk w;
	c->total = 0;
	c->crossings = c->status = c->matrix = c->rested = 0;
	enter(m, c, 0);
	for (w = first_switch(m->at); arrive(m->switches, m->breaks, c->region, &w); leave(&w)) {
		for (; outside(m, c, &w, x) > 0; w.interval++) {
			enter(m, c, c->region + w.stride);
		}
	}
	below = c->region;
	for (i = 0; i < m->switches; i++) { /* again: where one goes may change where another one is heading */
		decide(m, x, c, below, 0, work);
	}
	decide(m, x, c, below, 1, work);
}

/* ---- an event-free piece ---- */

/* Whether every switching function, known to be within low .. high, keeps off the breakpoints beside it */
static int event_free(const pl_switching *m, int region, const real *low, const real *high)
{
	walk w;
	for (w = first_switch(m->at); arrive(m->switches, m->breaks, region, &w); leave(&w)) {
		if (w.interval > 0 && !(low[w.i] > w.at[w.interval - 1])) {
			return 0;
		}
		if (w.interval < w.breaks && !(high[w.i] < w.at[w.interval])) {
			return 0;
		}
	}
	return 1;
}

/* What e may do beside the chord from x to y: within low .. high.  off: as far from it at most */
static void span(int switches, const real *from, const real *to, const real *off, real *low, real *high)
{
	int i;
	for (i = 0; i < switches; i++) {
		low[i] = smaller(from[i], to[i]) - off[i];
		high[i] = larger(from[i], to[i]) + off[i];
	}
}

/* Whether it is certain that nothing is crossed between x and y, a shortest piece on.  work: size + 5 switches */
static int stays_event_free(const pl_switching *m, const pl_contact *c, const real *x, const real *y, real *work)
{
	const int n = m->size, s = m->switches;
	real *size = work, *from = size + n, *to = from + s, *off = to + s, *low = off + s, *high = low + s;
	const real *tangent = rows_of(m->tangent, m, c);
	int i;
	for (i = 0; i < n; i++) {
		size[i] = magnitude(x[i]);
	}
	pl_multiply(s, n, m->row, x, from);
	pl_multiply(s, n, m->row, y, to);
	pl_multiply(s, n, rows_of(m->chord_error, m, c), size, off);
	span(s, from, to, off, low, high);
	if (event_free(m, c->region, low, high)) {
		return 1;
	}
	pl_multiply(s, n, rows_of(m->cubic_error, m, c), size, off);
	for (i = 0; i < s; i++, tangent += n) { /* a cubic lies within its Bezier points */
		real leaving, arriving;
		leaving = dot(n, tangent, x);
		arriving = dot(n, tangent, y);
		leaving = from[i] + leaving;
		arriving = to[i] - arriving;
		low[i] = smaller(smaller(from[i], to[i]), smaller(leaving, arriving)) - off[i];
		high[i] = larger(larger(from[i], to[i]), larger(leaving, arriving)) + off[i];
	}
	return event_free(m, c->region, low, high);
}

/* The same of a longer one, by x'' where it begins.  work: 2 size + 5 switches */
static int stays_event_free_far(const pl_switching *m, const pl_contact *c, climb *at, const real *x, const real *y,
						   real *bend, real *work)
{
	const int n = m->size, s = m->switches;
	real *from = work, *to = from + s, *off = to + s, *low = off + s, *high = low + s;
	const real *reach = m->ladder.reach + ((ptrdiff_t)m->ladder.first[c->matrix] * s + at->rung - 1) * n;
	int i;
	look_at_bend(at, n, matrix_of(m->A, m, c->matrix), x, bend, work);
	pl_multiply(s, n, m->row, x, from);
	pl_multiply(s, n, m->row, y, to);
	for (i = 0; i < s; i++, reach += (ptrdiff_t)at->rungs * n) {
		pl_multiply(1, n, reach, bend, &off[i]);
	}
	span(s, from, to, off, low, high);
	return event_free(m, c->region, low, high);
}

/* ---- the first crossing in a piece of a step ---- */

typedef struct event { /* a crossing */
	real s;
	int any;
	int expression, breakpoint, upward;
	int stride; /* of the switching function, between regions */
} event;

static const event no_event = {1, 0, -1, 0, 0, 0};

/* coefficients: (degree + 1) x size; after them 2 (degree + 1) for work */
static PL_APART event first_event(const pl_switching *m, const instant *at, real *coefficients, int *splits)
{
	const int terms = m->degree + 1, region = at->c->region;
	real *e = coefficients + terms * m->size;
	event first = no_event;
	beyond f;
	walk w;
	f.degree = m->degree;
	f.coefficient = e + terms;
	for (w = first_switch(m->at); arrive(m->switches, m->breaks, region, &w); leave(&w)) {
		const real *row = m->row + w.i * m->size;
		const real size = sizes(m->size, row, coefficients);
		int upward;
		expand_row(m->size, terms, row, coefficients, e);
		for (upward = 0; upward < 2; upward++) {
			const int breakpoint = w.interval - !upward;
			real s;
			if (breakpoint < 0 || breakpoint == w.breaks) {
				continue;
			}
			s = look_beyond(&f, e, upward ? 1 : -1, w.at[breakpoint], size)
					? first_root(&f, first.s, splits) : -1;
			if (s < 0) {
				continue;
			}
			first.s = s;
			first.any = 1;
			first.expression = w.i;
			first.breakpoint = breakpoint;
			first.upward = upward;
			first.stride = w.stride;
		}
	}
	return first;
}

/* ---- a step, piece by piece ---- */

#define limited(m, at, length) (length)
#define hold(m, at, y, work) ((void)0) /* nothing is */

static int is_event_free(const pl_switching *m, const instant *at, climb *up, const real *y, real *bend, real *work)
{
	return up->rung > 0 ? stays_event_free_far(m, at->c, up, at->x, y, bend, work)
		: stays_event_free(m, at->c, at->x, y, work);
}

/* A switching function that has left its interval, other than by a crossing, goes into that where it is. */
static void take_up(const pl_switching *m, instant *at, real time)
{
	walk w;
	int way;
	for (w = first_switch(m->at); arrive(m->switches, m->breaks, at->c->region, &w); leave(&w)) {
		for (; (way = outside(m, at->c, &w, at->x)) != 0; w.interval += way) {
			(void)list(m->max_events, at->c, at->crossing, time, w.i, w.interval - (way < 0), way > 0);
			enter(m, at->c, at->c->region + way * w.stride);
		}
	}
}

#ifdef WITH_DERIVATIVES

static void meet_breakpoint(const pl_switching *m, instant *at, int function, int breakpoint)
{
	pl_variation *v = at->v;
	int p;
	if (v == NULL) {
		return;
	}
	leave_field(m, at);
	for (p = 0; p < v->columns; p++) {
		v->dg[p] = off_breakpoint(m, v, p, function, breakpoint, at->x);
	}
	meet(m, at, m->row + (ptrdiff_t)function * m->size, function);
}

static int projects(const pl_switching *m, instant *at)
{
	(void)m;
	(void)at;
	return 0;
}

static void vary_held(const pl_switching *m, instant *at)
{
	(void)m;
	(void)at;
}

#endif

static int pass(const pl_switching *m, instant *at, const event *e, real time)
{
	VARIED(at->time = time;)
	VARIED(meet_breakpoint(m, at, e->expression, e->breakpoint);)
	const int listed = list(m->max_events, at->c, at->crossing, time, e->expression, e->breakpoint, e->upward);
	enter(m, at->c, at->c->region + (e->upward ? e->stride : -e->stride));
	return listed ? GO_ON : SEARCH_NO_MORE;
}

#include "pieces.h"

void pl_switching_advance(const pl_switching *m, real tau, real *x, pl_contact *c, pl_crossing *crossing,
						  real *work AND_VARIATION)
{
	instant at;
	at.x = x;
	at.c = c;
	at.crossing = crossing;
	at.work = work;
	SET_VARIATION(at);
	c->crossings = 0;
	enter_again(m, c);
	(void)go(m, &at, tau, 1);
}
#ifndef WITH_DERIVATIVES

void pl_switching_step(const pl_switching *m, real *x, pl_contact *c, pl_crossing *crossing, real *work)
{
	pl_switching_advance(m, m->h, x, c, crossing, work);
}

#ifdef STATE_IS_COMPENSATED

void pl_switching_move(const pl_switching *m, int matrix, int degree, real dt, real *x, real *work)
{
	const int n = m->size;
	real *const low = work, *const coefficients = work + n;
	expand_piece(n, degree, m->A + WORDS * (ptrdiff_t)matrix * n * n, dt, x, coefficients, low);
	part_of_piece(n, degree, coefficients, low, 1, x, (real *)0);
}

#else

/* ---- events of a series ---- */

int pl_series_switching_place(const pl_series_switching *m, const real *c, const real *terms, int *interval)
{
	const real *at = m->at;
	int i, k, changed = 0;
	for (i = 0; i < m->expressions; at += m->breaks[i++]) {
		const column e = column_of(m, c, terms, i);
		int above = 0;
		for (k = 0; k < m->breaks[i]; k++) {
			above += starts_above(&e, at[k]);
		}
		changed |= above != interval[i];
		interval[i] = above;
	}
	return changed;
}

int pl_series_switching_rises(const pl_series_switching *m, const real *c, const real *terms, int *interval)
{
	const real *at = m->at;
	int i, k, changed = 0;
	for (i = 0; i < m->expressions; at += m->breaks[i++]) {
		const column e = column_of(m, c, terms, i);
		real sum = column_at(&e, m->degree), size = magnitude(sum), noise, off;
		if (interval[i] == m->breaks[i]) {
			continue;
		}
		for (k = m->degree - 1; k > 0; k--) {
			sum = sum * SOON + column_at(&e, k);
			size += magnitude(column_at(&e, k));
		}
		off = off_start(&e, at[interval[i]], &noise);
		noise += noise_of(size);
		if (off >= -noise && off + sum * SOON > noise) {
			interval[i]++;
			changed = 1;
		}
	}
	return changed;
}

static void set_crossing(pl_crossing *crossing, int expression, int breakpoint, int upward)
{
	crossing->expression = expression;
	crossing->breakpoint = breakpoint;
	crossing->upward = upward;
}

int pl_series_switching_left(const pl_series_switching *m, const real *c, const real *terms, const int *interval,
							 pl_crossing *crossing)
{
	const pl_crossing last = *crossing;
	const real *at = m->at;
	int i, upward;
	for (i = 0; i < m->expressions; at += m->breaks[i++]) {
		const column e = column_of(m, c, terms, i);
		for (upward = 0; upward < 2; upward++) {
			const int b = interval[i] - !upward;
			real off, noise;
			if (b < 0 || b == m->breaks[i] || (last.expression == i && last.breakpoint == b)) {
				continue;
			}
			off = off_start(&e, at[b], &noise);
			if ((upward ? off : -off) > noise) {
				set_crossing(crossing, i, b, upward);
				return 1;
			}
		}
	}
	return 0;
}

real pl_series_switching_next(const pl_series_switching *m, const real *c, const real *terms, const int *interval,
							  real end,
					 int *splits, pl_crossing *crossing, real *work)
{
	const real *at = m->at;
	real first = 1;
	int i, upward, any = 0;
	beyond f;
	f.degree = m->degree < 3 ? 3 : m->degree;
	f.coefficient = work + f.degree + 1;
	for (i = 0; i < m->expressions && *splits >= 0; at += m->breaks[i++]) {
		const column e = column_of(m, c, terms, i);
		rescale(&e, end, work);
		for (upward = 0; upward < 2; upward++) {
			const int b = interval[i] - !upward;
			real s;
			if (b < 0 || b == m->breaks[i]) {
				continue;
			}
			if (!look_beyond(&f, work, upward ? 1 : -1, at[b], e.terms) ||
				!(f.reach - f.reach == 0)) { /* not finite: there is no step */
				continue;
			}
			s = first_root(&f, first, splits);
			if (s < 0) {
				continue;
			}
			any = 1;
			first = s;
			set_crossing(crossing, i, b, upward);
		}
	}
	return any ? first * end : -1;
}

#endif
#endif
