/* SPDX-License-Identifier: MIT-0 */
/* Impacts, contacts at rest and dry friction beside a Taylor series: from event to event, each found on the series of
 * the region before it.  What holds, what slips and what flies behind an event is found by looking at all combinations
 * of those that are at rest; the series of a combination says whether it can be. */
#include "series_impacts.h"
#include "moved.h"

/* ---- events at the start, and in a piece ---- */

static void set_event(const pl_events *m, pl_instant *at, int expression, int breakpoint, int upward)
{
	at->next.expression = expression;
	at->next.breakpoint = breakpoint;
	at->next.upward = upward;
	at->starting = impact_at(m, expression, breakpoint, upward);
	at->freed = -1;
}

static void set_freed(const pl_events *m, pl_instant *at, int hold, int up)
{
	at->next.expression = m->hold[hold].expression;
	at->next.breakpoint = m->hold[hold].interval - !up;
	at->next.upward = up;
	at->starting = -1;
	at->freed = hold;
}

/* Whether a bounce is beyond its guard by no more than what those that it touches have moved it, and on its way back */
static int is_parting(const pl_events *m, const pl_instant *at, int k)
{
	real noise;
	return k >= 0 && rest_of(m, k) >= 0 && speed_of(m, at, k) < 0 && depth(m, at, k, &noise) > noise &&
		   depth(m, at, k, &noise) <= DEEP * rounding_of_places(m, at);
}

/* Whether it is the velocity of friction that a contact at rest leaves none: then it is but rounding. */
static int is_braking(const pl_events *m, const pl_instant *at, int expression)
{
	int i;
	for (i = 0; i < m->conflicts; i++) {
		const int hold = m->conflict[i].hold;
		if (hold >= 0 && m->hold[hold].expression == expression && side_beside(m, at, hold) != 0) {
			return 1;
		}
	}
	return 0;
}

/* A switching function outside of its interval, or what is held beyond what can */
static int has_left(const pl_events *m, pl_instant *at)
{
	const pl_series_switching *d = m->switching;
	const real *b = d->at;
	int i, up;
	for (i = 0; i < d->expressions; b += d->breaks[i++]) {
		const column e = column_of(d, at->c, at->terms, i);
		const int hold = hold_of(m, i, at->interval[i]);
		for (up = 0; up < 2; up++) {
			const int k = at->interval[i] - !up;
			real off, noise;
			if (hold >= 0 && (up ? m->hold[hold].up : m->hold[hold].down) >= 0) {
				const column w = pull_of(m, at, hold, up);
				if (certain(&w) > 0) {
					set_freed(m, at, hold, up);
					return 1;
				}
			}
			if (hold >= 0 || k < 0 || k == d->breaks[i]
					|| (at->last->expression == i && at->last->breakpoint == k) ||
				is_braking(m, at, i)) {
				continue;
			}
			off = off_start(&e, b[k], &noise);
			if ((up ? off : -off) > noise && !is_parting(m, at, impact_at(m, i, k, up))) {
				set_event(m, at, i, k, up);
				return 1;
			}
		}
	}
	return 0;
}

/* What has just been let go at this breakpoint may be driven back by what the time of that is off: no sticking if it
 * turns by itself within a part of h, no impact of a speed that is but rounding */
static void pass_brief(beyond *f, real behind, real along)
{
	const int turns = f->coefficient[2] < 0 && f->coefficient[1] * along <= -NEAR * f->coefficient[2];
	if (f->coefficient[0] <= f->noise && f->coefficient[1] > 0 &&
		(turns || (behind >= 0 && f->coefficient[1] <= noise_of(behind)))) {
		f->coefficient[1] = 0;
	}
}

/* Where a column first rises beyond b, or with sign -1 falls below it, before *first; last: that was the last event;
 * behind: where it has just left it the sizes of what its first two derivatives are summed from; else below 0;
 * parting: it has; end, along: how far, in the unit of time of c and in h */
static int look(const column *e, real b, int sign, int last, real behind, int parting, real end, real along,
				real *first, int *splits, real *work)
{
	beyond f;
	real s;
	int rises;
	f.degree = e->m->degree < 3 ? 3 : e->m->degree;
	f.coefficient = work + f.degree + 1;
	rescale(e, end, work);
	if (parting || (behind >= 0 && (real)sign * work[1] < 0 &&
					magnitude(work[0] - b) <= noise_of(e->terms + magnitude(b) + behind))) {
		int k;
		for (k = 0; k <= f.degree; k++) {
			work[k] *= (real)sign;
		}
		rises = look_behind(&f, work, behind);
	} else {
		rises = look_beyond(&f, work, (real)sign, b, e->terms);
	}
	if (!rises || !(f.reach - f.reach == 0)) { /* not finite: there is no step */
		return 0;
	}
	if (last) {
		pass_brief(&f, behind, along);
	}
	s = first_root(&f, *first, splits);
	if (s < 0) {
		return 0;
	}
	*first = s;
	return 1;
}

static real first_event(const pl_events *m, pl_instant *at, real end, int *splits)
{
	const pl_series_switching *d = m->switching;
	const real *b = d->at, along = end * at->unit;
	real first = 1;
	int i, up, any = 0;
	for (i = 0; i < d->expressions && *splits >= 0; b += d->breaks[i++]) {
		const column e = column_of(d, at->c, at->terms, i);
		const int hold = hold_of(m, i, at->interval[i]);
		for (up = 0; up < 2; up++) {
			const int k = at->interval[i] - !up;
			int starting, last;
			real behind;
			if (hold >= 0 && (up ? m->hold[hold].up : m->hold[hold].down) >= 0) {
				const column w = pull_of(m, at, hold, up);
				if (look(&w, 0, 1, 0, -1, 0, end, along, &first, splits, at->work)) {
					any = 1;
					set_freed(m, at, hold, up);
				}
			}
			if (hold >= 0 || k < 0 || k == d->breaks[i] || is_braking(m, at, i)) {
				continue;
			}
			starting = impact_at(m, i, k, up);
			behind = starting >= 0 && m->impact[starting].hold >= 0
				 ? m->impact[starting].per * m->h * end * speed_terms(m, at, starting, m->h * end)
						 : -1;
			last = at->last->expression == i && at->last->breakpoint == k;
			if (look(&e, b[k], up ? 1 : -1, last, behind, is_parting(m, at, starting), end, along, &first,
					splits,
					 at->work)) {
				any = 1;
				set_event(m, at, i, k, up);
			} else if (starting >= 0 && m->moved != NULL) {
				miss(m, at, &e, i, b[k], up ? 1 : -1, first * end);
			}
		}
	}
	return any ? first * end : -1;
}

real pl_events_next(const pl_events *m, pl_instant *at, real *size, int *splits)
{
	*size = shortened(m, at, *size);
	return first_event(m, at, *size, splits);
}

/* ---- one event ---- */

static int pass(const pl_events *m, pl_instant *at)
{
	const pl_crossing e = at->next;
	const int begins = at->starting, loses = begins >= 0 && m->impact[begins].restitution < 1;
	const int full = *at->crossings == m->max_events && !loses;
	int *interval = &at->interval[e.expression];
	uint32_t acted = 0;
	if (full) {
		return 0;
	}
	at->crossed = begins < 0 ? e.expression : -1;
	at->was = *interval;
	if (begins < 0) {
		(void)has_listed(m, at, 0, at->time, e.expression, e.breakpoint, e.upward);
	}
	if (begins < 0 || m->impact[begins].hold < 0) {
		const int hold = hold_of(m, e.expression, *interval + (e.upward ? 1 : -1));
		const int past = hold >= 0 && m->hold[hold].impact >= 0 && begins < 0 ? 2 : 1;
		*interval += e.upward ? past : -past; /* past a contact at rest, which impacts alone lead to */
	}
	*at->last = e;
	renew(m, at);
	if (hold_of(m, e.expression, *interval) >= 0) {
		keep(m, at); /* with what is held with it, before it is let go */
	}
	if (begins >= 0) {
		acted = apply_impacts(m, at, begins);
		follow(m, at, 0);
	}
	resolve(m, at, 1);
	at->freed = -1;
	come_to_rest(m, at, acted);
	keep(m, at);
	return !at->chain.full;
}

int pl_events_pass(const pl_events *m, pl_instant *at)
{
	leaving l;
	int passed;
	if (m->moved == NULL) {
		return pass(m, at);
	}
	l = leave(m, at);
	passed = pass(m, at);
	arrive(m, at, &l);
	return passed;
}

int pl_events_begin(const pl_events *m, pl_instant *at)
{
	renew(m, at);
	at->freed = -1;
	keep(m, at);
	if (!has_left(m, at)) {
		return 0;
	}
	return pl_events_pass(m, at) ? 1 : -1;
}

int pl_events_left(const pl_events *m, pl_instant *at)
{
	int i;
	at->freed = -1;
	for (i = 0; i < m->holds; i++) {
		if (holds_now(m, at, i) && is_slack(m, at, i)) {
			return 1;
		}
	}
	return has_left(m, at);
}

void pl_events_meet(const pl_events *m, pl_instant *at, const pl_crossing *event)
{
	const int hold = hold_of(m, event->expression, at->interval[event->expression]);
	if (hold >= 0) {
		set_freed(m, at, hold, event->upward);
	} else {
		set_event(m, at, event->expression, event->breakpoint, event->upward);
	}
}

real pl_events_end(const pl_events *m, pl_instant *at, real end, int *splits)
{
	real next;
	if (pl_events_left(m, at)) {
		return 0;
	}
	next = first_event(m, at, end, splits);
	return *splits < 0 ? 0 : next >= 0 ? next : end;
}

static real breakpoint_of(const pl_events *m, const pl_event_impact *p)
{
	const real *b = m->switching->at;
	int i;
	for (i = 0; i < p->expression; i++) {
		b += m->switching->breaks[i];
	}
	return b[p->breakpoint];
}

/* Whether a switching function is beyond the guard of this bounce, s on, by more than rounding and `least` */
static int is_beyond(const pl_events *m, const pl_instant *at, int bounce, real s, real least)
{
	const pl_event_impact *p = &m->impact[bounce];
	const column e = column_of(m->switching, at->c, at->terms, p->expression);
	const real b = breakpoint_of(m, p);
	real value = 0, terms = 0, off;
	int k;
	for (k = m->switching->degree; k >= 0; k--) {
		value = value * s + column_at(&e, k);
		terms = terms * s + magnitude(column_at(&e, k));
	}
	terms += e.terms + magnitude(b) + p->per * m->h * s * speed_terms(m, at, bounce, m->h * s);
	off = p->upward ? value - b : b - value;
	least *= p->per;
	return off > DEEP * noise_of(terms) + least + TINY && off > DEEP * p->per * rounding_of_places(m, at) + least;
}

int pl_events_places(const pl_events *m, const pl_instant *at, real s, real least)
{
	int k, status = 0;
	for (k = 0; k < m->impacts; k++) {
		status |= is_before(m, at, k) && is_beyond(m, at, k, s, least) ? PL_PENETRATED : 0;
	}
	return status;
}

/* ---- the start ---- */

static int starting_interval(const pl_events *m, const pl_instant *at, int expression, const real *b)
{
	const pl_series_switching *d = m->switching;
	const column e = column_of(d, at->c, at->terms, expression);
	int above = 0, k;
	for (k = 0; k < d->breaks[expression]; k++) {
		const int hold = hold_of(m, expression, k + 1);
		int impact;
		real noise;
		above += starts_above(&e, b[k]);
		if (hold < 0 || magnitude(off_start(&e, b[k], &noise)) > noise) {
			continue;
		}
		impact = m->hold[hold].impact;
		return impact >= 0 && magnitude(speed_of(m, at, impact)) > 0 ? free_of(m, impact) : k + 1;
	}
	return above;
}

void pl_events_place(const pl_events *m, pl_instant *at)
{
	const pl_series_switching *d = m->switching;
	int again = 1, rounds, i;
	for (i = 0; i < d->expressions; i++) {
		at->interval[i] = 0;
		again += d->breaks[i] + 1;
	}
	at->last->expression = -1;
	at->freed = -1;
	at->unlisted = 1;
	for (rounds = 0; rounds < again; rounds++) {
		const real *b = d->at;
		int changed = 0;
		renew(m, at);
		for (i = 0; i < d->expressions; b += d->breaks[i++]) {
			const int interval = starting_interval(m, at, i, b);
			changed |= interval != at->interval[i];
			at->interval[i] = interval;
		}
		if (!changed) {
			break;
		}
	}
	renew(m, at);
	resolve(m, at, 0);
	at->unlisted = 0;
}
