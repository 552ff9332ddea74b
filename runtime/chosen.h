/* SPDX-License-Identifier: MIT-0 */
/* chosen.h: the formulas that hold now: of loads, by the segment of time; those that the state chooses, by the interval
 * of each switching function, which a state that was set has yet to find, and which a crossing changes.  Part of what a
 * model's file includes for its steps, after
 *
 *     PL(name), PL_TYPE          the model's prefix before a name; its type, with member y, and segment of several
 *     PL(contact)                with members crossings, crossing, total, interval, last, placed
 *     PL_SWITCHING_FUNCTIONS, PL_ORDER   that choose formulas; of their series, 0: there is none, and no PL(locate)
 *     PL_CONTACTS                1: impacts, contacts at rest, friction have functions of their own
 *     PL_HELD                    so many of these may be held
 *     PL_REGIONS                 1: the regions are numbered
 *     PL_WAY                     beside contacts, if what is watched goes by polynomials: their degree, PL(along)
 *     PL_MOVED                   so many columns of derivatives are among the states: member doubt of PL(contact)
 *     PL_BOUNCES                 1: contacts may come to rest by bouncing: member rested of PL(contact)
 *     PL_COLUMNS, PL_INPUTS, PL_SEGMENTS, PL_CHOICES, PL_ADAPTIVE, PL_CHANGES, PL_MAX_EVENTS, PL_H,
 *     PL(expand_from), PL(inputs_now)   as taylor.h
 *     PL_AT_BREAKPOINTS          1: states are put onto them
 *     PL_IN_PARTS                1: a step goes from part to part, each within one segment; else as it likes
 *     PL(series_switching)                a pl_series_switching, of the series
 *     PL(breaks), PL(breakpoint)          of each switching function how many breakpoints; all of these in its order */
#include "numbers.h"

#define PL_LOCATES (PL_ORDER > 0 && PL_SWITCHING_FUNCTIONS > 0 && !PL_CONTACTS)

/* ---- by time ---- */

#if PL_LOCATES || (PL_ORDER > 0 && PL_IN_PARTS)
static inline int PL(segment_of)(const PL_TYPE *s)
{
#if PL_SEGMENTS > 1
	return s->segment;
#else
	(void)s;
	return 0;
#endif
}
#endif

#if PL_SEGMENTS > 1 && (PL_ADAPTIVE || (PL_CHOICES && (PL_LOCATES || (PL_CONTACTS && PL_IN_PARTS && !defined(PL_WAY)))))
/* How long the loads have the formulas that they have now [s]; `most`, where that does not end */
static inline real PL(change_after)(const PL_TYPE *s, real most)
{
	return s->segment < PL_SEGMENTS - 1 ? PL(until)(s, s->segment) : most;
}
#endif

#if PL_IN_PARTS
/* Up to which part of the step, of which `end` is asked, the loads have one formula behind `done`; *segment: its */
static inline real PL(limit_of)(const PL_TYPE *s, real done, real end, int *segment)
{
#if PL_SEGMENTS > 1
	for (; *segment < PL_SEGMENTS - 1; *segment += 1) {
		const real change = PL(until)(s, *segment) / PL_H;
		const real limit = change < end ? change : end;
		if (limit > done) {
			return limit;
		}
	}
#endif
	(void)s;
	(void)done;
	(void)segment;
	return end;
}
#endif

/* Those whose time is over have others; whether some have */
static inline int PL(change_loads)(PL_TYPE *s)
{
	int changed = 0;
#if PL_SEGMENTS > 1
	while (s->segment < PL_SEGMENTS - 1 && PL(until)(s, s->segment) <= (real)(PL_SINGLE ? 1e-8 : 1e-18) * PL_H) {
		s->segment++;
		changed = 1;
	}
#endif
	(void)s;
	return changed;
}

#if PL_IN_PARTS
/* A time between these two [h], by which conditions on t are decided */
static inline real PL(time_between)(const PL_TYPE *s, real from, real to)
{
#if PL_CHOICES
	return PL(time)(s) + (from + to) / 2 * PL_H;
#else
	(void)s;
	(void)from;
	(void)to;
	return 0;
#endif
}
#endif

#if PL_ADAPTIVE || PL_LOCATES || (PL_CONTACTS && PL_IN_PARTS && !defined(PL_WAY))
/* A time in the middle of the step, before the loads change: there it is on one side of conditions on t, also when it
 * is late, or float. */
static inline real PL(middle)(const PL_TYPE *s)
{
#if PL_CHOICES && PL_SEGMENTS > 1
	const real change = PL(change_after)(s, PL_H);
	return PL(time)(s) + (change < PL_H ? change : PL_H) / 2;
#elif PL_CHOICES
	return PL(time)(s) + PL_H / 2;
#else
	(void)s;
	return 0; /* there are none */
#endif
}
#endif

/* ---- by the state ---- */

#if PL_SWITCHING_FUNCTIONS > 0
/* Of a state that was set: its intervals the next step finds, which knows its samples; until then they are the
 * lowest. */
static inline void PL(forget)(PL(contact) *contact)
{
	int i;
	contact->placed = contact->crossings = 0;
	contact->total = 0;
#if PL_CONTACTS
	contact->rested = 0;
#endif
#if PL_MOVED
	contact->doubt.status = 0;
#endif
	for (i = 0; i < PL_SWITCHING_FUNCTIONS; i++) {
		contact->interval[i] = 0;
	}
}

#if PL_AT_BREAKPOINTS
/* Where a crossing is, of the switching function */
static inline real PL(breakpoint_of)(const pl_crossing *crossing)
{
	int i, place = crossing->breakpoint;
	for (i = 0; i < crossing->expression; i++) {
		place += PL(breaks)[i];
	}
	return PL(breakpoint)[place];
}
#endif
#endif

#if PL_SWITCHING_FUNCTIONS > 0 && !PL_CONTACTS
/* Passes the breakpoint of contact->last, so long after the start of the step; 0: there were too many */
static int PL(cross)(PL(contact) *contact, real time)
{
	pl_crossing *last = &contact->last;
	if (contact->crossings == PL_MAX_EVENTS) {
		return 0;
	}
	last->time = time;
	contact->crossing[contact->crossings++] = *last;
	contact->total++;
	contact->interval[last->expression] += last->upward ? 1 : -1;
	return 1;
}
#endif

#if PL_LOCATES
/* The intervals of a state that was set.  That of one switching function may choose what another is. */
static void PL(locate)(const PL_TYPE *s, const real u[], PL(contact) *contact)
{
	real c[PL_ORDER + 1][PL_COLUMNS], terms[PL_SWITCHING_FUNCTIONS];
	real start[PL_INPUTS + 1], slope[PL_INPUTS + 1]; /* no array is empty */
	int i, again = PL_CHANGES;
	PL(inputs_now)(s, u, start, slope);
	for (i = 0; i < PL_SWITCHING_FUNCTIONS; i++) {
		contact->interval[i] = 0;
	}
	contact->last.expression = -1;
	contact->placed = 1;
	do {
		PL(expand_from)(s, start, slope, 0, PL(middle)(s), PL(segment_of)(s), contact->interval, s->y, c,
				terms);
	} while (pl_series_switching_place(&PL(series_switching), c[0], terms, contact->interval) && again-- > 0);
}
#endif

#if PL_IN_PARTS && (PL_LOCATES || PL_CONTACTS)
#if PL_CONTACTS
static void PL(locate)(const PL_TYPE *s, const real u[], PL(contact) *contact);
#endif

/* So that its formulas are known; crossings are counted anew. */
static inline void PL(ready)(const PL_TYPE *s, const real u[], PL(contact) *contact)
{
	if (!contact->placed) {
		PL(locate)(s, u, contact);
	}
	contact->crossings = 0;
}
#endif

#if PL_CONTACTS
/* Before the first impact of a step */
static inline pl_chain PL(no_impact)(void)
{
	const pl_chain none = {-PL_H, 0, 0, 0u, 0, 0, 0, 0, 0};
	return none;
}

#if defined(PL_WAY)
/* A guard of a bounce is the integral of its speed, a watch, over a step of dt [s]: beside a place that is rounded the
 * way of a short flight would not show. */
static void PL(guards_along)(real dt, real c[PL_WAY + 1][PL_TERMS])
{
	int i, m;
	for (i = 0; i < PL(along).impacts; i++) {
		const pl_event_impact *const p = &PL(along).impact[i];
		const real per = (p->upward ? dt : -dt) * p->per;
		for (m = 0; m < PL_WAY && p->hold >= 0; m++) {
			c[m + 1][p->expression] = per * c[m][PL_SWITCHING_FUNCTIONS + p->speed] / (real)(m + 1);
		}
	}
}
#endif

/* An instant at which something is met, but for how the series is made anew there */
static PL_APART void PL(open)(pl_instant *at, PL(contact) *contact, real y[], real low[], real c[], real terms[],
							  real work[])
{
	at->y = y;
	at->low = low;
	at->c = c;
	at->terms = terms;
	at->work = work;
	at->interval = contact->interval;
	at->total = &contact->total;
	at->crossings = &contact->crossings;
	at->rested = &contact->rested;
	at->crossing = contact->crossing;
	at->last = &contact->last;
	at->unit = 1;
	at->time = 0;
	at->next = contact->last;
	at->starting = at->freed = -1;
	at->unlisted = 0;
	at->status = 0;
	at->chain = PL(no_impact)();
#if PL_MOVED
	at->doubt = &contact->doubt;
#else
	at->doubt = NULL;
#endif
	at->moved = NULL;
}
#endif

/* ---- what is asked about it ---- */

#if PL_SWITCHING_FUNCTIONS > 0
#if PL_REGIONS
int PL(region)(const PL_TYPE *s)
{
	int i, region = 0;
	for (i = PL_SWITCHING_FUNCTIONS - 1; i >= 0; i--) {
		region = s->contact.interval[i] + (PL(breaks)[i] + 1) * region;
	}
	return region;
}
#endif

uint64_t PL(crossed)(const PL_TYPE *s)
{
	return s->contact.total;
}

int PL(crossings)(const PL_TYPE *s, pl_crossing crossing[PL_MAX_EVENTS])
{
	int i;
	for (i = 0; i < s->contact.crossings; i++) {
		crossing[i] = s->contact.crossing[i];
	}
	return s->contact.crossings;
}

#if PL_BOUNCES
int PL(rested)(const PL_TYPE *s)
{
	return s->contact.rested;
}
#endif
#endif
