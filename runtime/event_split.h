/* SPDX-License-Identifier: MIT-0 */
/* event_split.h: steps of a scheme with a nonlinear remainder that has switching functions.  A whole step goes by the
 * scheme's own tables with the formulas of given intervals, and is looked at from both ends; one that crosses a
 * breakpoint is made again in parts, from crossing to crossing, each with e^{A tau} of its own length.  Included by the
 * file of each model, which defines before it what chosen.h asks, and
 *
 *     PL_STATES, PL_ACTING, PL_FORCES   of x, which is the states, what acts on them (load states, inputs, slopes of
 *                                inputs), and each force of the remainder with two derivatives
 *     PL_FASTEST                 the sizes |A| have no larger pole [1/s]
 *     PL_CERTAIN, PL_FAST_PATH   the longest part [h] in which cubics follow the fastest pole; 1: it is below a step
 *     PL_CARRIES                 entries of the member carry, which a step changes
 *     PL_MAX_SPLITS              halvings in the search of a crossing
 *     PL_TERMS                   what is watched: switching functions, and behind them what the search of events looks
 *                                at
 *
 *     PL(column)[]               of each switching function: where it stands in the series, of order 2
 *     PL(passing)                a pl_series_switching of cubics of each
 *     PL(slope_matrix)[][][]     of each segment: A [1/s], x' = A x where no force changes but by its derivatives
 *     PL(acting)(s, start, slope, tau, acting)       what acts, tau [s] after now
 *     PL(forces_at)(s, start, slope, tau, when, segment, interval, y, force)      the remainder
 *     PL(ends_at)(s, start, slope, tau, when, segment, interval, y, e, terms)     of all that is watched the value and
 *                                h times the slope; the sizes of the terms of the value
 *     PL(full_step)(s, u, start, slope, when, interval)  s->y one step on, by the scheme; PL_IN_MODES: of normal.h
 *     PL(pass_time)(s, u)        what else takes part in a step moves on
 *     PL(events), PL(along)      where there are contacts: a pl_events of the series; of polynomials along a part
 *
 * and members contact, status; and end, terms, ended where there are no inputs and formulas do not change in time. */
#define PL_AT_BREAKPOINTS 1
#define PL_IN_PARTS 1
#define PL_WAY (3 + PL_CONTACTS) /* the degree of polynomials: a guard has one more */
#include "chosen.h"

#define PL_SIZE (PL_STATES + PL_ACTING + 3 * PL_FORCES)
#define PL_KEEPS_CHECK (PL_INPUTS == 0 && PL_SEGMENTS == 1) /* what a step ends with the next begins with */
#define PL_SHORTER (-1)                                    /* a part is to be tried again over a shorter time */

#if PL_SINGLE
#define PL_LEAST_PART ((real)1e-6) /* of a step, above what its end is rounded to: shorter ones are not tried */
#define PL_NOISE ((real)1e-6)      /* of the sizes that are summed: what rests on its breakpoint does not leave it */
#else
#define PL_LEAST_PART 1e-9
#define PL_NOISE 1e-14
#endif

#if PL_IN_MODES
#define PL_LONGEST ((real)0.25) /* [h] of a part, whose scheme is of lower order than the step's */
#else
#define PL_LONGEST 1
#endif

typedef struct PL(piece) { /* a part of a step */
	const struct PL_TYPE *s;
	PL(contact) *contact;         /* whose intervals hold */
	real met;                     /* known: what a step over all of h meets is found already, there */
	int known;
	real start[PL_ROOM(PL_INPUTS)], slope[PL_ROOM(PL_INPUTS)];
	real done, limit;             /* where it begins; where the loads change, or the step ends [h] */
	real longest;                 /* that is tried [h] */
	int segment, splits;
#if PL_CONTACTS
	real low[PL_STATES], law[PL_ORDER + 1][PL_COLUMNS], terms[PL_TERMS];
	real work[PL_EVENT_WORK(PL_ORDER, PL_HELD, PL_STATES)];
	pl_instant at;                /* what happens where it begins; law: the series from there */
#if PL_MOVED
	real moved[PL_MOVED_WORK(PL_STATES, PL_MOVED)];
#endif
#else
	pl_crossing found;            /* what it meets */
#endif
} PL(piece);

static inline void PL(begin)(PL(piece) *p, const PL_TYPE *s, const real u[], PL(contact) *contact)
{
	p->s = s;
	p->contact = contact;
	p->known = 0;
	PL(inputs_now)(s, u, p->start, p->slope);
	p->done = 0;
	p->limit = 1;
	p->longest = PL_LONGEST;
	p->segment = PL(segment_of)(s);
	p->splits = PL_MAX_SPLITS;
}

static inline real PL(when)(const PL(piece) *p)
{
	return PL(time_between)(p->s, p->done, p->limit);
}

/* ---- a part of any length ---- */

static PL_APART void PL(forces)(const PL(piece) *p, real tau, const real y[], real force[PL_FORCES])
{
	PL(forces_at)(p->s, p->start, p->slope, tau, PL(when)(p), p->segment, p->contact->interval, y, force);
}

/* x <- states, what acts on them, and forces that do not change */
static PL_APART void PL(gather)(const real states[], const real acting[], const real force[PL_FORCES], real x[PL_SIZE])
{
	int i;
	for (i = 0; i < PL_STATES; i++) {
		x[i] = states[i];
	}
	for (i = 0; i < PL_ACTING; i++) {
		x[PL_STATES + i] = acting[i];
	}
	for (i = 0; i < PL_FORCES; i++) {
		real *const of = x + PL_STATES + PL_ACTING + 3 * i;
		of[0] = force[i];
		of[1] = of[2] = 0;
	}
}

/* The derivatives of forces that are a parabola through r, the mean of ra and rb, and rc */
static void PL(bend)(const real r[], const real ra[], const real rb[], const real rc[], real tau, real x[PL_SIZE])
{
	int i;
	for (i = 0; i < PL_FORCES; i++) {
		real *const of = x + PL_STATES + PL_ACTING + 3 * i;
		const real middle = (ra[i] + rb[i]) / 2;
		of[1] = (4 * middle - 3 * r[i] - rc[i]) / tau;
		of[2] = 4 * ((r[i] - middle) + (rc[i] - middle)) / tau / tau;
	}
}

/* next: y `size` later [h], by the scheme of Cox and Matthews 2002, (26)-(29): 0, or it is not finite.  Each stage is
 * e^{A tau} x, and no function is divided by what may be 0. */
static PL_APART int PL(advance)(const PL(piece) *p, real size, const real y[PL_STATES], real next[PL_STATES])
{
	const real at = p->done * PL_H, tau = size * PL_H;
	real acting[PL_ROOM(PL_ACTING)], x[PL_SIZE], a[PL_SIZE], b[PL_SIZE];
	real r[PL_FORCES], ra[PL_FORCES], rb[PL_FORCES], rc[PL_FORCES], work[PL_EVENT_SPLIT_WORK(PL_SIZE)];
	pl_two room[PL_EVENT_SPLIT_ROOM(PL_SIZE)];
	pl_event_split split;
	int i, status = pl_event_split_begin(&split, PL_SIZE, PL(slope_matrix)[p->segment][0], PL_FASTEST, tau, work,
			room);
	if (status != 0) {
		return status;
	}
	PL(acting)(p->s, p->start, p->slope, at, acting);
	PL(forces)(p, at, y, r);
	PL(gather)(y, acting, r, x);
	pl_event_split_flow(&split, 1, x, a); /* a = F y + q1 r */
	PL(forces)(p, at + tau / 2, a, ra);
	for (i = 0; i < PL_FORCES; i++) {
		rc[i] = ra[i] - r[i];
	}
	PL(gather)(a, a + PL_STATES, rc, x);
	for (i = 0; i < PL_STATES + PL_ACTING; i++) {
		x[i] = 0;
	}
	pl_event_split_flow(&split, 1, x, b); /* b = F y + q1 r(a) */
	for (i = 0; i < PL_STATES; i++) {
		b[i] += a[i];
	}
	PL(forces)(p, at + tau / 2, b, rb);
	for (i = 0; i < PL_FORCES; i++) {
		rc[i] = 2 * rb[i] - r[i];
	}
	PL(gather)(a, a + PL_STATES, rc, x);
	pl_event_split_flow(&split, 1, x, b); /* c = F a + q1 (2 r(b) - r) */
	PL(forces)(p, at + tau, b, rc);
	PL(gather)(y, acting, r, x);
	PL(bend)(r, ra, rb, rc, tau, x);
	pl_event_split_flow(&split, 0, x, b);
	for (i = 0; i < PL_STATES; i++) {
		next[i] = b[i];
	}
	return pl_not_finite(next, PL_STATES);
}

/* ---- what it meets ---- */

/* The switching functions at y, `at` h after now, by the formulas that hold over the part */
static PL_APART void PL(look)(const PL(piece) *p, real at, const real y[PL_STATES], real e[][PL_TERMS],
							real terms[PL_TERMS])
{
	PL(ends_at)(p->s, p->start, p->slope, at * PL_H, PL(when)(p), p->segment, p->contact->interval, y, e, terms);
}

/* How far off its breakpoint a switching function still is on it */
static inline real PL(slack)(real noise, real terms)
{
#if PL_FAST_PATH
	return noise * terms;
#else
	(void)noise;
	(void)terms;
	return 0;
#endif
}

static inline int PL(is_above)(real value, real bound)
{
	return PL_FAST_PATH ? value >= bound : value > bound;
}

#if PL_CONTACTS
/* Whether nothing that is held comes near being let go in a part of this size, as PL(stays) */
static int PL(is_held_on)(const real c[PL_WAY + 1][PL_TERMS], const real d[2][PL_TERMS], const int interval[],
						  real size)
{
	int i, up;
	for (i = 0; i < PL(along).holds; i++) {
		const pl_hold *const h = &PL(along).hold[i];
		for (up = 0; up < 2 && interval[h->expression] == h->interval; up++) {
			const int watch = up ? h->up : h->down, k = PL_SWITCHING_FUNCTIONS + watch;
			if (watch >= 0 && !(c[0][k] < 0 && c[0][k] + size * c[1][k] / 3 < 0 && d[0][k] < 0 &&
								d[0][k] - size * d[1][k] / 3 < 0)) {
				return 0;
			}
		}
	}
	return 1;
}
#endif

/* Whether no switching function comes near the end of its interval, but for `noise` of its terms, in a part of this
 * size.  c: values and slopes [1/h] at its start, d: at its end: the cubic that has them is as exact as the step, and
 * lies within its Bezier points. */
static int PL(stays)(const real c[PL_WAY + 1][PL_TERMS], const real d[2][PL_TERMS], const int interval[],
					 real size, const real terms[PL_TERMS], real noise)
{
	const real *at = PL(breakpoint);
	int i;
#if PL_CONTACTS
	if (!PL(is_held_on)(c, d, interval, size)) {
		return 0;
	}
#endif
	for (i = 0; i < PL_SWITCHING_FUNCTIONS; at += PL(breaks)[i++]) {
		const real a = c[0][i], b = a + size * c[1][i] / 3, z = d[0][i], y = z - size * d[1][i] / 3;
		const real slack = PL(slack)(noise, terms[i]);
		if (PL_CONTACTS && interval[i] > 0 && interval[i] < PL(breaks)[i] &&
			!(at[interval[i] - 1] < at[interval[i]])) {
			continue; /* it is held there */
		}
		if (interval[i] > 0) {
			const real low = at[interval[i] - 1] - slack;
			if (!(PL(is_above)(a, low) && PL(is_above)(b, low) && PL(is_above)(y, low)
					&& PL(is_above)(z, low))) {
				return 0;
			}
		}
		if (interval[i] < PL(breaks)[i]) {
			const real high = at[interval[i]] + slack;
			if (!(PL(is_above)(high, a) && PL(is_above)(high, b) && PL(is_above)(high, y)
					&& PL(is_above)(high, z))) {
				return 0;
			}
		}
	}
	return 1;
}

/* c becomes the cubic of each over a part of this size [h]. */
static void PL(make_cubics)(real c[PL_WAY + 1][PL_TERMS], const real d[2][PL_TERMS], real size)
{
	int i;
	for (i = 0; i < PL_TERMS; i++) {
		const real rise = (d[0][i] - c[0][i]) / size;
		c[2][i] = (3 * rise - 2 * c[1][i] - d[1][i]) / size;
		c[3][i] = (c[1][i] + d[1][i] - 2 * rise) / (size * size);
		c[PL_WAY][i] = PL_CONTACTS ? 0 : c[PL_WAY][i];
	}
#if PL_CONTACTS
	PL(guards_along)(PL_H, c);
#endif
}

/* From `at` to where column k passes `to`, back by half of `size` or on by `left` at most; returns by how much,
 * all in h.  How far a part ends off the breakpoint that it was to meet is of the size of the error: a Taylor
 * polynomial bridges it. */
static PL_APART real PL(onto)(const PL(piece) *p, real at, real size, real left, int k, real to, int upward,
							  real y[PL_STATES])
{
	real c[PL_ORDER + 1][PL_COLUMNS], terms[PL_TERMS], moved = 0;
	int i, again;
	for (again = 0; again < 4; again++) {
		real theta;
		PL(expand_from)(p->s, p->start, p->slope, (at + moved) * PL_H, PL(when)(p), p->segment,
				p->contact->interval, y,
						c, terms);
		if (!(upward ? c[1][k] > 0 : c[1][k] < 0)) {
			break;
		}
		theta = (to - c[0][k]) / c[1][k];
		theta -= c[2][k] / c[1][k] * theta * theta;
		if (!(pl_magnitude(theta) <= size / 2) || moved + theta < -size / 2 || moved + theta > left) {
			break;
		}
		for (i = 0; i < PL_STATES; i++) {
			y[i] += theta * (c[1][i] + theta * c[2][i]);
		}
		moved += theta;
		if (pl_magnitude(theta) <= (real)1e-15) {
			break;
		}
	}
	return moved;
}

/* ---- from crossing to crossing ---- */

/* What is not finite is tried again over half of it, if that is not too short. */
static inline int PL(halve)(PL(piece) *p, real size)
{
	p->longest = size / 2;
	return p->longest < PL_LEAST_PART ? PL_NOT_FINITE : PL_SHORTER;
}

#include "met.h"

/* The part up to `to` [h]: next, where it ends; *met, how long after its start it meets something, or below 0; it then
 * is as long as *size: 0, PL_SHORTER, or what went wrong.  What a cubic says of a part that is too long for it is
 * believed where that stays within. */
static int PL(search_step)(PL(piece) *p, real to, real c[PL_WAY + 1][PL_TERMS], real d[2][PL_TERMS],
						   real terms[PL_TERMS], const real y[PL_STATES], real next[PL_STATES],
								real *size, real *met)
{
	const real full = *size;
	real spare[PL_TERMS];
	if (PL(advance)(p, full, y, next) != 0) {
		return PL(halve)(p, full);
	}
	PL(look)(p, to, next, d, spare);
	*met = PL(meets)(p, c, (const real (*)[PL_TERMS])d, terms, size);
	if (p->splits < 0) {
		return PL(gave_up)(p);
	}
#if PL_FAST_PATH
	if (full > PL_CERTAIN && (*met >= 0 || !PL(stays)((const real (*)[PL_TERMS])c, (const real (*)[PL_TERMS])d,
								  p->contact->interval, full, terms, PL_NOISE))) {
		p->longest = full / 2;
		return PL_SHORTER;
	}
#endif
	return 0;
}

/* The next part, y at its start and then at its end: 0, PL_SHORTER, or what went wrong */
static int PL(go_on)(PL(piece) *p, real y[PL_STATES])
{
	real c[PL_WAY + 1][PL_TERMS], d[2][PL_TERMS], terms[PL_TERMS], next[PL_STATES], to, size, end, met;
	int i, known = p->known, wrong = PL(begin_part)(p, y, c, terms);
	if (wrong != 0) {
		return wrong > 0 ? 0 : PL(gave_up)(p);
	}
	to = p->limit - p->done < p->longest ? p->limit : p->done + p->longest;
	size = end = to - p->done;
	met = p->met;
	p->known = 0;
	if (!known) {
		wrong = PL(search_step)(p, to, c, d, terms, y, next, &end, &met);
		if (wrong != 0) {
			return wrong;
		}
	}
	end = met >= 0 ? met : end;
	if (end > 0 && (end < size || known)) {
#if PL_CONTACTS
		real spare[PL_TERMS];
#endif
		if (PL(advance)(p, end, y, next) != 0) {
			return PL(halve)(p, end);
		}
#if PL_CONTACTS
		PL(look)(p, p->done + end, next, d, spare);
#endif
	}
#if PL_CONTACTS
	(void)PL(put_back)(p->contact, (const real (*)[PL_TERMS])d, next);
#endif
	if (met > 0) {
		end += PL(onto_event)(p, p->done + end, end, size - end, next);
	}
	p->longest = PL_FAST_PATH && 2 * size < PL_LONGEST ? 2 * size : PL_LONGEST;
	for (i = 0; i < PL_STATES && end > 0; i++) {
		y[i] = next[i];
	}
	p->done = end < size ? p->done + end : to;
	return PL(end_part)(p, end, met >= 0) ? 0 : PL(gave_up)(p);
}

/* y, `end` h later: 0, or what went wrong, and y as far as it went */
static PL_APART int PL(between)(PL(piece) *p, real end, real y[PL_STATES])
{
	int wrong = 0;
	p->splits = PL_MAX_SPLITS;
#if PL_CONTACTS
	PL(watch)(p, y);
#endif
	while (p->done < end && wrong <= 0) {
		p->limit = PL(limit_of)(p->s, p->done, end, &p->segment);
		wrong = PL(go_on)(p, y);
	}
#if PL_CONTACTS
	return (wrong > 0 ? wrong : 0) | p->at.status;
#else
	return wrong > 0 ? wrong : 0;
#endif
}

/* ---- the step ---- */

#if PL_IN_MODES
#include "normal.h"
#endif

/* Whether a step over all of h stands that comes near an event.  c, d: of its ends */
static PL_APART int PL(is_event_free)(PL(piece) *p, real c[PL_WAY + 1][PL_TERMS], const real d[2][PL_TERMS],
									  real terms[PL_TERMS])
{
	real end = 1, met;
#if PL_CONTACTS
	real y[PL_STATES];
	PL(watch)(p, y);
#else
	p->found = p->contact->last;
	if (pl_series_switching_left(&PL(passing), c[0], terms, p->contact->interval, &p->found)) {
		return 0;
	}
#endif
	met = PL(meets)(p, c, d, terms, &end);
	p->known = !PL_FAST_PATH && !PL_CONTACTS && met >= 0;
	p->met = met;
#if PL_FAST_PATH
	if (!PL(stays)((const real (*)[PL_TERMS])c, d, p->contact->interval, 1, terms, PL_NOISE)) {
		return 0;
	}
#endif
	return met < 0 && !(end < 1) && p->splits >= 0 && !PL_LET_GO(p) && pl_not_finite(p->s->y, PL_STATES) == 0;
}

/* Whether the step that was made stands, as is_event_free: the loads have had one formula in it, too */
static inline int PL(stands)(PL(piece) *p, real c[PL_WAY + 1][PL_TERMS], const real d[2][PL_TERMS],
							 real terms[PL_TERMS])
{
#if PL_SEGMENTS > 1
	if (p->segment < PL_SEGMENTS - 1 && PL(until)(p->s, p->segment) < PL_H) {
		return 0;
	}
#endif
	return PL(stays)((const real (*)[PL_TERMS])c, d, p->contact->interval, 1, terms, 0) ||
		   PL(is_event_free)(p, c, d, terms);
}

/* The switching functions at the start of the step */
static inline void PL(look_first)(const PL(piece) *p, real c[PL_WAY + 1][PL_TERMS], real terms[PL_TERMS])
{
#if PL_KEEPS_CHECK
	if (p->s->ended) {
		int i;
		for (i = 0; i < PL_TERMS; i++) {
			c[0][i] = p->s->end[0][i];
			c[1][i] = p->s->end[1][i];
			terms[i] = p->s->terms[i];
		}
		return;
	}
#endif
	PL(look)(p, 0, p->s->y, c, terms);
}

/* They are kept for the step that follows; NULL: they are not. */
static inline void PL(keep_look)(PL_TYPE *s, const real d[2][PL_TERMS], const real terms[PL_TERMS])
{
#if PL_KEEPS_CHECK
	int i;
	s->ended = d != NULL;
	for (i = 0; i < PL_TERMS && d != NULL; i++) {
		s->end[0][i] = d[0][i];
		s->end[1][i] = d[1][i];
		s->terms[i] = terms[i];
	}
#else
	(void)s;
	(void)d;
	(void)terms;
#endif
}

/* Forces of the steps before are of no use any more. */
static inline void PL(begin_anew)(PL_TYPE *s)
{
#if PL_IN_MODES
	PL(take_modes)(s);
	s->known = 0;
#else
	(void)s;
#endif
}

/* Where no switching function comes near a breakpoint the step stands; else it is looked at closely, and made in parts
 * where one is passed. */
static inline void PL(serve)(PL_TYPE *s, const real u[])
{
	real c[PL_WAY + 1][PL_TERMS], d[2][PL_TERMS], terms[PL_TERMS], spare[PL_TERMS], y[PL_STATES];
	real carry[PL_ROOM(PL_CARRIES)];
	PL(piece) p;
	int i;
	PL(ready)(s, u, &s->contact);
	PL(begin)(&p, s, u, &s->contact);
	PL(look_first)(&p, c, terms);
	for (i = 0; i < PL_STATES; i++) {
		y[i] = s->y[i];
	}
#if PL_CARRIES > 0
	for (i = 0; i < PL_CARRIES; i++) {
		carry[i] = s->carry[i];
	}
#endif
#if PL_IN_MODES
	PL(full_step)(s);
#else
	PL(full_step)(s, u, p.start, p.slope, PL(when)(&p), s->contact.interval);
#endif
	PL(look)(&p, 1, s->y, d, spare);
	if (PL(stands)(&p, c, (const real (*)[PL_TERMS])d, terms)) {
		s->contact.last.expression = -1;
#if PL_CONTACTS
		if (PL(put_back)(&s->contact, (const real (*)[PL_TERMS])d, s->y)) {
			PL(look)(&p, 1, s->y, d, spare);
#if PL_IN_MODES
			PL(take_modes)(s);
#endif
		}
#endif
		PL(keep_look)(s, (const real (*)[PL_TERMS])d, spare);
	} else {
		for (i = 0; i < PL_STATES; i++) {
			s->y[i] = y[i];
		}
#if PL_CARRIES > 0
		for (i = 0; i < PL_CARRIES; i++) {
			s->carry[i] = carry[i];
		}
#endif
		PL(keep_look)(s, NULL, NULL);
		s->status |= p.splits < 0 ? PL_TOO_MANY_EVENTS : PL(between)(&p, 1, s->y);
		PL(begin_anew)(s);
	}
	(void)carry;
	PL(pass_time)(s, u);
	if (PL(change_loads)(s)) {
		PL(begin_anew)(s);
	}
}

/* What follows from a state that was set */
static void PL(place)(PL_TYPE *s)
{
	PL(forget)(&s->contact);
	PL(keep_look)(s, NULL, NULL);
	PL(begin_anew)(s);
}

/* y tau after now */
static PL_APART void PL(state_at)(const PL_TYPE *s, const real u[], real tau, real y[PL_STATES])
{
	PL(contact) here = s->contact;
	PL(piece) p;
	int i;
	PL(ready)(s, u, &here);
	PL(begin)(&p, s, u, &here);
	for (i = 0; i < PL_STATES; i++) {
		y[i] = s->y[i];
	}
	(void)PL(between)(&p, tau / PL_H, y);
}

#include "undef.h"
