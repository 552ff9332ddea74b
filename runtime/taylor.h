/* SPDX-License-Identifier: MIT-0 */
/* taylor.h: steps by the Taylor series of the solution, of fixed order or as long as a tolerance allows: a series may
 * serve several steps of h, or a part of one, after which it is expanded again.  Included by the file of each model,
 * which defines before it what reach.h asks, where there is a tolerance, and
 *
 *     PL_TYPE                    with members y, rest, t0, k, status, and by what follows
 *     PL_ADAPTIVE                a tolerance says how long a series serves: series, base, next, left, served, valid,
 *                                most
 *     PL_WATCHED                 of fixed order, with a tolerance: PL_INACCURATE where it is not met
 *     PL_OVER                    one series of fixed order is over so many steps: series, next, left, served; 1: no
 *     PL_PARTS                   whether steps may go in parts: with between.h
 *     PL_STRAIGHT                whether one of fixed order is no array, and its sum the model's: PL(full_step)
 *     PL_WRITTEN_OUT             whether sums of a series are the model's: PL(ahead), PL(end), PL(within)
 *     PL_INPUTS, PL_SEGMENTS     samples; in how many spans of time loads have a formula each: segment; 1: just one
 *     PL_SWITCHING_FUNCTIONS, PL_TERMS   that choose formulas: contact; these and what contacts watch; PL_CHANGES at
 *                                one time
 *     PL_CHOICES                 of formulas by t
 *     PL_CONTACTS                impacts, contacts at rest, friction: PL(events)
 *     PL_MAX_EVENTS, PL_MAX_SPLITS, PL_TRIES     in a step: crossings, halvings in the search of one, series
 *     PL_SERVES                  steps that a series serves at most; PL(last)[], PL(before_last)[]: the tolerance over
 *                                each number of steps to the last power, and to the one before
 *
 *     PL(inputs_now)(s, u, start, slope)   samples at the start of this step, and their slopes
 *     PL(expand_from)(s, start, slope, tau, when, segment, interval, y, c, terms)
 *                                the series from y, tau after now: c[k] is h^k/k! times the k-th derivative; conditions
 *                                on t hold as they do at `when`; terms: of what is watched the sizes of its terms
 *     PL(ahead)(c, theta, gain)  what a series gains from its start, theta of its unit of time later
 *     PL(end)(c, m, y, rest)     the state then, as exactly as can be, and what rounding takes from it
 *     PL(within)(s, theta)       s->y then, of s->series
 *     PL(total)(c, y, end, rest) the sum of a series of fixed order, in the same way
 *     PL(pass_time)(s, u)        what else takes part in a step moves on
 *     PL_CONSTRAINTS             some hold: PL(misses) of constraints.h
 *
 * Each model has a copy of its own, in which the numbers of states and orders are constants. */
#include "numbers.h"

#if PL_SINGLE
#define PL_STATE_ROUNDED ((real)1e-6) /* of the largest state: what rounding may do to slopes, times h */
#else
#define PL_STATE_ROUNDED 1e-15
#endif

/* What a step tells that is not kept */
#define PL_LOST ((int)PL_NOT_FINITE | (PL_WATCHED ? (int)PL_INACCURATE : 0))

#if PL_INPUTS == 0
static inline void PL(inputs_now)(const PL_TYPE *s, const real u[], real start[], real slope[])
{
	start[0] = slope[0] = 0; /* there are none */
	(void)s;
	(void)u;
}
#endif

#include "constraints.h"

/* ---- the sum of a series ---- */

#if !PL_WRITTEN_OUT && (PL_PARTS || PL_OVER > 1 || PL_AT)
static void PL(ahead)(const real c[PL_ORDER + 1][PL_COLUMNS], real theta, real gain[PL_STATES])
{
	int i, k;
	for (i = 0; i < PL_STATES; i++) {
		gain[i] = c[PL_ORDER][i];
	}
	for (k = PL_ORDER - 1; k > 0; k--) {
		for (i = 0; i < PL_STATES; i++) {
			gain[i] = gain[i] * theta + c[k][i];
		}
	}
	for (i = 0; i < PL_STATES; i++) {
		gain[i] *= theta;
	}
}
#endif

#if !PL_WRITTEN_OUT && PL_ADAPTIVE
static void PL(end)(const real c[PL_ORDER + 1][PL_COLUMNS], real m, real end[PL_STATES], real low[PL_STATES])
{
	real gain[PL_STATES];
	int i;
	PL(ahead)(c, m, gain);
	for (i = 0; i < PL_STATES; i++) {
		end[i] = pl_accumulate(c[0][i], gain[i], 0, &low[i]);
	}
}
#endif

/* What rounding had taken where the series of several steps begins */
#if PL_ADAPTIVE
#define PL_BASE base
#else
#define PL_BASE low
#endif

#if (PL_ADAPTIVE || PL_OVER > 1) && (PL_AT || !PL_WRITTEN_OUT)
/* y: theta after the start of the series that the instance has */
static inline void PL(state_within)(const PL_TYPE *s, real theta, real y[PL_STATES])
{
	real gain[PL_STATES];
	int i;
	PL(ahead)((const real (*)[PL_COLUMNS])s->series, theta, gain);
	for (i = 0; i < PL_STATES; i++) {
		y[i] = s->series[0][i] + (gain[i] + s->PL_BASE[i]);
	}
}
#if !PL_WRITTEN_OUT && PL_INPUTS == 0
static void PL(within)(PL_TYPE *s, real theta)
{
	PL(state_within)(s, theta, s->y);
}
#endif

#endif

#if PL_ADAPTIVE || PL_OVER > 1
/* Where the series ends that the instance has */
static inline void PL(take_end)(PL_TYPE *s)
{
	int i;
	for (i = 0; i < PL_STATES; i++) {
		s->y[i] = s->next[i];
		s->low[i] = s->left[i];
	}
}
#endif

#if PL_ADAPTIVE || PL_OVER > 1 || !(PL_PARTS || PL_STRAIGHT)
/* Whether one of them is not finite: its difference from itself is not 0 */
static inline int PL(is_lost)(const real y[PL_STATES])
{
	real sum = 0;
	int i;
	for (i = 0; i < PL_STATES; i++) {
		sum += y[i] - y[i];
	}
	return !(sum == 0);
}
#endif

/* ---- how far it holds ---- */

#if PL_REMAINDERS > 0
#include "reach.h"
#endif

#include "served.h"

/* ---- parts of a step ---- */

#if PL_PARTS
#define PL_AT_BREAKPOINTS 0
#define PL_IN_PARTS 1
#include "chosen.h"
#include "between.h"
#endif

/* ---- the step ---- */

#if PL_ADAPTIVE

#if PL_SWITCHING_FUNCTIONS > 0
/* Up to the first event that the series meets */
static inline void PL(end_before_event)(PL_TYPE *s, const real u[], real terms[])
{
#if PL_CONTACTS
	PL(piece) p;
	PL(inputs_now)(s, u, p.start, p.slope);
	p.s = s;
	p.y = s->y;
	p.low = s->low;
	p.segment = PL(segment_of)(s);
	p.splits = PL_MAX_SPLITS;
	PL(watch)(&p, &s->contact);
	p.at.c = s->series[0];
	p.at.terms = terms;
	s->valid = (int)pl_events_end(&PL(events), &p.at, (real)s->valid, &p.splits);
#else
	real work[PL_SERIES_SWITCHING_WORK(PL_ORDER)], next;
	pl_crossing crossing = s->contact.last;
	int splits = PL_MAX_SPLITS;
	if (pl_series_switching_left(&PL(series_switching), s->series[0], terms, s->contact.interval, &crossing)) {
		s->valid = 0;
		return;
	}
	next = pl_series_switching_next(&PL(series_switching), s->series[0], terms, s->contact.interval, (real)s->valid,
									&splits, &crossing,
						   work);
	if (splits < 0 || (next >= 0 && next < (real)s->valid)) {
		s->valid = splits < 0 ? 0 : (int)next;
	}
	(void)u;
#endif
}
#endif

/* A new series from here, and how many steps it serves */
static void PL(renew)(PL_TYPE *s, const real u[])
{
#if PL_SEGMENTS > 1
	const real change = PL(change_after)(s, PL_SERVES * PL_H);
#endif
	const real when = PL(middle)(s);
	const int *interval = NULL;
	real terms[PL_ROOM(PL_TERMS)], start[PL_ROOM(PL_INPUTS)], slope[PL_ROOM(PL_INPUTS)];
	int i;
	PL(inputs_now)(s, u, start, slope);
#if PL_SWITCHING_FUNCTIONS > 0
	interval = s->contact.interval;
#endif
	PL(measure)(s);
	PL(expand_from)(s, start, slope, 0, when, PL(segment_of)(s), interval, s->y, s->series, terms);
	for (i = PL_STATES; i < PL_STATES + PL_MEASURED; i++) {
		if (pl_magnitude(s->series[0][i]) > s->scale[i]) {
			s->scale[i] = pl_magnitude(s->series[0][i]);
			s->unit[i] = 1 / s->scale[i];
		}
	}
	i = s->most ? PL(reach)(s) : 0;
	s->valid = i < s->most ? i : s->most;
	s->most = s->valid ? 2 * s->valid : s->most;
#if PL_SEGMENTS > 1
	if (change < (real)s->valid * PL_H) {
		s->valid = (int)(change / PL_H);
	}
#endif
#if PL_SWITCHING_FUNCTIONS > 0
	if (s->valid) {
		PL(end_before_event)(s, u, terms);
		if (s->valid) {
			s->contact.last.expression = -1;
		}
	}
#endif
#if PL_SLOPES
	while (s->valid && !PL(meets)(s, start, slope, 0, when, PL(segment_of)(s), interval,
							  (const real (*)[PL_COLUMNS])s->series, (real)s->valid)) {
		s->valid /= 2;
	}
#endif
	s->served = 0;
	for (i = 0; i < PL_STATES; i++) {
		s->base[i] = s->left[i] = s->low[i];
	}
	if (s->valid) {
		PL(end)((const real (*)[PL_COLUMNS])s->series, (real)s->valid, s->next, s->left);
		if (PL(is_lost)(s->next)) {
			s->valid = s->most = 0;
		}
#if PL_PROJECTS
		if (s->valid && PL(project)(s, (real)s->valid * PL_H, s->next, s->left)) {
			s->valid = s->most = 0;
		}
#endif
	}
}

#if PL_INPUTS == 0
/* A step whose end lies inside of what the series serves */
static PL_APART void PL(inside)(PL_TYPE *s)
{
	PL(within)(s, (real)(s->served + 1));
	s->served++;
#if PL_CONSTRAINTS
	s->status |= PL(project_rounded)(s, PL_H, s->y);
#endif
#if PL_SWITCHING_FUNCTIONS > 0
	s->contact.crossings = 0;
#endif
	PL(pass_time)(s, NULL);
}
#endif

/* The last step that a series serves, the first of the next one, or one that none serves */
static PL_APART void PL(border)(PL_TYPE *s, const real u[])
{
	if (s->served == s->valid) {
#if PL_SWITCHING_FUNCTIONS > 0
		if (!s->contact.placed) {
			PL(locate)(s, u, &s->contact);
		}
#endif
		PL(renew)(s, u);
	}
#if PL_SWITCHING_FUNCTIONS > 0
	s->contact.crossings = 0;
#endif
#if PL_INPUTS == 0
	if (s->served + 1 < s->valid) {
		PL(inside)(s);
		return;
	}
#endif
	if (s->valid == 0) {
		s->status |= PL(between)(s, u, !s->most, 1, s->y, s->low, PL_MET_BY(s));
		s->most = 1;
	} else {
		s->served = s->valid;
		PL(take_end)(s);
	}
	PL(pass_time)(s, u);
	if (PL(change_loads)(s)) {
		s->most = 0;
	}
}

static inline void PL(serve)(PL_TYPE *s, const real u[])
{
#if PL_INPUTS == 0
	if (s->served + 1 < s->valid) {
		PL(inside)(s);
		return;
	}
#endif
	PL(border)(s, u);
}

#elif PL_OVER > 1 || !(PL_PARTS || PL_STRAIGHT)

/* A series from here, over PL_OVER steps, and where it ends; 0: that is not finite */
static inline int PL(go_over)(PL_TYPE *s, const real u[], real c[PL_ORDER + 1][PL_COLUMNS], real next[PL_STATES],
							  real low[PL_STATES])
{
	real start[PL_ROOM(PL_INPUTS)], slope[PL_ROOM(PL_INPUTS)];
	int i;
	PL(inputs_now)(s, u, start, slope);
	PL(expand_from)(s, start, slope, 0, 0, 0, NULL, s->y, c, NULL);
	for (i = 0; i < PL_STATES; i++) {
		low[i] = s->low[i];
	}
	PL(total)((const real (*)[PL_COLUMNS])c, s->y, next, low);
#if PL_PROJECTS
	s->status |= PL(project)(s, PL_OVER > 1 ? PL_OVER * PL_H : PL_H, next, low);
#endif
#if PL_WATCHED
	if (!PL(is_accurate)(s, (const real (*)[PL_COLUMNS])c, 1)) {
		s->status |= PL_INACCURATE;
	}
#endif
	if (PL(is_lost)(next)) {
		s->status |= PL_CAUSE(s, 0, s->y, PL_LOST);
		return 0;
	}
	return 1;
}

#if PL_OVER > 1

/* One that is not finite is not kept: all its steps leave the state as it is. */
static void PL(renew)(PL_TYPE *s, const real u[])
{
	int i, k;
	if (PL(go_over)(s, u, s->series, s->next, s->left)) {
		return;
	}
	for (i = 0; i < PL_STATES; i++) {
		s->next[i] = s->y[i];
		s->left[i] = s->low[i];
		for (k = 1; k <= PL_ORDER; k++) {
			s->series[k][i] = 0;
		}
	}
}

static inline void PL(serve)(PL_TYPE *s, const real u[])
{
	if (s->served == 0) {
		PL(renew)(s, u);
	}
	if (++s->served < PL_OVER) {
		PL(within)(s, PL(part_of)[s->served - 1]);
#if PL_CONSTRAINTS
		s->status |= PL(project_rounded)(s, PL_H, s->y);
#endif
	} else {
		s->served = 0;
		PL(take_end)(s);
#if PL_WATCHED
		PL(measure)(s);
#endif
	}
	PL(pass_time)(s, u);
}

#else

static inline void PL(serve)(PL_TYPE *s, const real u[])
{
	real c[PL_ORDER + 1][PL_COLUMNS], next[PL_STATES], low[PL_STATES];
	int i;
	if (PL(go_over)(s, u, c, next, low)) {
		for (i = 0; i < PL_STATES; i++) {
			s->y[i] = next[i];
			s->low[i] = low[i];
		}
#if PL_WATCHED
		PL(measure)(s);
#endif
	}
	PL(pass_time)(s, u);
}

#endif

#elif PL_PARTS

static inline void PL(serve)(PL_TYPE *s, const real u[])
{
#if PL_SWITCHING_FUNCTIONS > 0
	PL(ready)(s, u, PL_MET_BY(s));
#endif
	s->status |= PL(between)(s, u, 0, 1, s->y, s->low, PL_MET_BY(s));
#if PL_WATCHED
	PL(measure)(s);
#endif
	PL(pass_time)(s, u);
	PL(change_loads)(s);
}

#endif

/* ---- a state that was set ---- */

#if PL_REMAINDERS > 0 || PL_OVER > 1 || PL_SWITCHING_FUNCTIONS > 0
/* What follows from it */
static void PL(place)(PL_TYPE *s)
{
#if PL_REMAINDERS > 0
	int i;
#endif
#if PL_ADAPTIVE
	s->served = s->valid = s->most = 0;
#elif PL_OVER > 1
	s->served = 0;
#endif
#if PL_REMAINDERS > 0
	for (i = 0; i < PL_STATES + PL_MEASURED; i++) {
		s->scale[i] = PL_ADAPTIVE && !PL_KINDS && i < PL_STATES ? PL_TRACE : 0;
		s->unit[i] = 0;
	}
	PL(measure)(s);
#endif
#if PL_SWITCHING_FUNCTIONS > 0
	PL(forget)(&s->contact);
#endif
}
#endif

/* ---- between steps ---- */

#if PL_AT
/* y tau after now: of the series that serves this step, or of one that begins here */
static PL_APART void PL(state_at)(const PL_TYPE *s, const real u[], real tau, real y[PL_STATES])
{
#if PL_PARTS
	real low[PL_STATES];
#if PL_SWITCHING_FUNCTIONS > 0
	PL(contact) here = s->contact;
#endif
#else
	real c[PL_ORDER + 1][PL_COLUMNS], gain[PL_STATES], start[PL_ROOM(PL_INPUTS)], slope[PL_ROOM(PL_INPUTS)];
#endif
	int i;
#if PL_ADAPTIVE
	const int fresh = !s->most;
	if (s->served < s->valid) {
		PL(state_within)(s, (real)s->served + tau / PL_H, y);
		PL_PUT_BACK(s, tau, y);
		return;
	}
#else
	const int fresh = 0;
#endif
#if PL_OVER > 1
	if (s->served > 0) {
		PL(state_within)(s, ((real)s->served + tau / PL_H) / PL_OVER, y);
		PL_PUT_BACK(s, tau, y);
		return;
	}
#endif
#if PL_PARTS
	for (i = 0; i < PL_STATES; i++) {
		y[i] = s->y[i];
		low[i] = s->low[i];
	}
#if PL_SWITCHING_FUNCTIONS > 0
	PL(ready)(s, u, &here);
	PL(between)(s, u, fresh, tau / PL_H, y, low, &here);
#else
	PL(between)(s, u, fresh, tau / PL_H, y, low, NULL);
#endif
#else
	PL(inputs_now)(s, u, start, slope);
	PL(expand_from)(s, start, slope, 0, 0, 0, NULL, s->y, c, NULL);
	PL(ahead)((const real (*)[PL_COLUMNS])c, tau / (PL_OVER * PL_H), gain);
	for (i = 0; i < PL_STATES; i++) {
		y[i] = s->y[i] + (gain[i] + s->low[i]);
	}
	if (tau > 0) { /* now it is on them, and stays to the last bit */
		PL_PUT_BACK(s, tau, y);
	}
	(void)fresh;
#endif
}
#endif

#include "undef.h"
