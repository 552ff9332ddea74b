/* SPDX-License-Identifier: MIT-0 */
/* radau.h: steps by Radau IIA collocation (Hairer and Wanner 1996, IV.8), as long as a tolerance allows: several h, at
 * which its polynomial is evaluated, or a part of h.  Unknown are the highest derivatives k of the coordinates at the
 * nodes.  Included by the file of each model, which defines before it, and has no more of it behind:
 *
 *     PL(name), PL_TYPE          the model's prefix before a name; its type, with the members start, poly, gain, at,
 *                                at_low, size, per, want, scale, unit, back, stop, ready beside y, rest, t0, k, status
 *     PL_STATES, PL_COORDS       coordinates are of first or second order: states are these, then the velocities
 *     PL_STAGES, PL_MODES        of the collocation; by how many modes of its stages they are solved, 0: all at once
 *     PL_BLOCK                   so many coordinates are solved for at once: all, or those that others derive from
 *     PL_ENTRIES                 of their Jacobian that are not 0; PL_DIFFERENCES: all are, row by row, of differences
 *     PL_INPUTS, PL_KNOWN        samples; numbers that the equations read beside the state
 *     PL_SEGMENTS                of time, in each of which the loads have a formula: member leg; 1: just one
 *     PL_SWITCHING_FUNCTIONS     that choose formulas, with passage.h; PL_MAX_EVENTS, PL_MAX_SPLITS, PL_CHANGES,
 *                                PL_WATCH_READS: known numbers
 *     PL_CONTACTS                1: impacts, contacts at rest, friction, as passage.h says
 *     PL_CHOICES                 of formulas by t, of a series
 *     PL_ORDER                   of a series that takes turns with the collocation, with switches.h; 0: none
 *     PL_COLUMNS                 of poly and scale: states, then what stands beside them in a series
 *     PL_ARGUMENTS               of functions that a polynomial may not show, with PL_TRACE_READS, PL_RISE
 *     PL_ALIGNED                 1: in models of derivatives: an internal step ends with step `until` of h
 *     PL_FOLLOWED                1: models of derivatives begin where it is now: PL(exactly)
 *     PL_CROWDED                 an internal step is at most so long, in h; 0: as long as it will
 *     PL_H, PL_TOLERANCE, PL_SOLVED, PL_TRIES   [s]; relative; what Newton's method may leave; internal steps within h
 *
 *     PL(node), PL(once), PL(twice), PL(monomial)   nodes, integrals up to each of what is 1 at one of them, integrals
 *                                of these, coefficients of the former
 *     PL(entry)                  row, column, whether it is by the coordinate and not by what is one below its highest
 *                                derivative
 *     PL(highest_of), PL(coord_of)   where orders differ: of a coordinate, of a state
 *     PL(inputs_now)(s, u, start, slope)                        samples at the start of this step, their slopes
 *     PL(known)(s, tau, inside, segment, start, slope, known)   tau after now; conditions on t hold as at inside
 *     PL(linearize)(known, interval, y, left, jacobian)         highest derivatives at y; and with modes PL(forces)
 *     PL_KIND(i), PL_FLOORS                                     as measure.h
 *     PL_CONSTRAINTS                                            some hold: PL(misses) of constraints.h
 *
 * Each is a copy of its own, whose numbers of states are constants; no function is called by a pointer. */
#include "numbers.h"

#ifndef PLRT_RADAU_H
#define PLRT_RADAU_H
/* Why there is no step, beside what a status says: a series should do it; nothing moves; what is next has changed */
enum { PL_BY_SERIES = -1, PL_NO_MOVE = -2, PL_ANOTHER = -3 };
/* What ends an internal step: its error, the step of h, a change of the loads, a crossing */
enum { PL_AT_ERROR, PL_AT_STEP, PL_AT_CHANGE, PL_AT_CROSSING };
#endif

#if PL_SINGLE
#define PL_SHORTEST ((real)1e-12)     /* internal step, in h */
#define PL_FIRST ((real)1e-10)        /* the shortest that is tried at first, far above it */
#define PL_HERE ((real)1e-8)          /* how near in h a crossing is one where the internal step starts */
#define PL_NEAR ((real)0x1p-7)        /* how far from 1 a step may end at a crossing that its polynomial finds */
#define PL_CORRECTION ((real)0x1p-10) /* the largest of that end */
#define PL_NO_CHANGE ((real)1e-12)    /* of the states by an iteration */
#define PL_NOTHING ((real)1e-35)      /* what may be divided by */
#define PL_HUGE ((real)1e37)
#define PL_HALF_DIGITS ((real)0x1p-12)
#else
#define PL_SHORTEST 1e-18
#define PL_FIRST 1e-15
#define PL_HERE 1e-15
#define PL_NEAR 0x1p-10
#define PL_CORRECTION 0x1p-20
#define PL_NO_CHANGE 1e-17
#define PL_NOTHING 1e-290
#define PL_HUGE 1e300
#define PL_HALF_DIGITS 0x1p-26
#endif

#define PL_UNKNOWNS (PL_STAGES * PL_COORDS)

/* The size of a state is that where an internal step starts. */
#define PL_NOW start
#define PL_KINDS 1
#if PL_ORDER > 0
#define PL_REMAINDERS 3
#include "reach.h"
#else
#include "measure.h"
#if PL_ARGUMENTS > 0
#include "unresolved.h"
#endif
#endif

/* ---- states and coordinates ---- */

/* The state whose derivative is the highest of coordinate j */
static inline int PL(highest)(int j)
{
#if PL_STATES == PL_COORDS
    return j;
#elif PL_STATES == 2 * PL_COORDS
    return PL_COORDS + j;
#else
    return PL(highest_of)[j];
#endif
}

/* The coordinate of state i */
static inline int PL(coord)(int i)
{
#if PL_STATES == PL_COORDS
    return i;
#elif PL_STATES == 2 * PL_COORDS
    return i % PL_COORDS;
#else
    return PL(coord_of)[i];
#endif
}

/* Whether the derivative of state i is another state */
static inline int PL(is_moved)(int i)
{
#if PL_STATES == PL_COORDS
    (void)i;
    return 0;
#elif PL_STATES == 2 * PL_COORDS
    return i < PL_COORDS;
#else
    return PL(highest_of)[PL(coord_of)[i]] != i;
#endif
}

#if PL_DIFFERENCES
static void PL(linearize)(const real known[], const int interval[], const real y[PL_STATES], real left[], real slope[]);
#endif

#define PL_AT_BREAKPOINTS 1
#define PL_IN_PARTS 0
#define PL_WAY (PL_STAGES + PL_CONTACTS) /* the degree of what is watched along a step: guards have one more */
#include "chosen.h"

/* ---- where an internal step stands ---- */

/* An internal step starts at the state now. */
static void PL(anew)(PL_TYPE *s)
{
    int i;
    for (i = 0; i < PL_STATES; i++) {
        s->start[i] = s->y[i];
        s->gain[i] = 0; /* what NAME_at reads before there is one */
    }
    s->at = s->at_low = s->size = 0;
    s->per = 1;
    s->back = s->stop = s->ready = 0;
#if PL_SEGMENTS > 1
    s->leg = s->segment;
#endif
}

/* What follows from a state that was set */
static void PL(place)(PL_TYPE *s)
{
    int i;
    PL(anew)(s);
    for (i = 0; i < PL_COLUMNS; i++) {
        s->scale[i] = s->unit[i] = 0;
    }
    PL(measure)(s);
    s->want = 0;
#if PL_ORDER > 0
    s->product = 0;
    s->series = s->stiff = s->bounds = s->run = 0;
    s->patience = 2;
#endif
#if PL_SWITCHING_FUNCTIONS > 0
    PL(forget)(&s->contact);
#endif
}

/* How far after now it starts, in h */
static inline real PL(since)(const PL_TYPE *s)
{
    return s->at - (real)s->back;
}

/* The segment of time that it is in */
static inline int PL(leg_of)(const PL_TYPE *s)
{
#if PL_SEGMENTS > 1
    return s->leg;
#else
    (void)s;
    return 0;
#endif
}

static inline const int *PL(intervals)(const PL_TYPE *s)
{
#if PL_SWITCHING_FUNCTIONS > 0
    return s->contact.interval;
#else
    (void)s;
    return NULL;
#endif
}

/* What is known `ahead` h after its start, if it is wanted, where conditions on t hold as they do at `inside` */
static inline void PL(known_at)(const PL_TYPE *s, int wanted, const real start[], const real slope[], real ahead,
                                real inside, real known[])
{
    if (!wanted) {
        known[0] = 0; /* not read */
        return;
    }
    PL(known)(s, (PL(since)(s) + ahead) * PL_H, (PL(since)(s) + inside) * PL_H, PL(leg_of)(s), start, slope,
              known);
}

#if PL_ORDER > 0 || PL_CONTACTS
/* A time at which conditions on it hold as they do just behind the start of the internal step */
static inline real PL(when)(const PL_TYPE *s)
{
#if PL_CHOICES
    return PL(time)(s) + (PL(since)(s) + (real)1e-9) * PL_H;
#else
    (void)s;
    return 0; /* there are none */
#endif
}
#endif

/* The highest derivatives and their Jacobian where it starts */
static inline void PL(here)(const PL_TYPE *s, const real start[], const real slope[], real left[], real jacobian[])
{
    real known[PL_ROOM(PL_KNOWN)];
    PL(known_at)(s, PL_KNOWN, start, slope, 0, (real)1e-9, known);
    PL(linearize)(known, PL(intervals)(s), s->start, left, jacobian);
}

/* Whether it ends at numbers */
static int PL(ends)(const real y[PL_STATES], const real gain[PL_STATES])
{
    real end[PL_STATES];
    int i;
    for (i = 0; i < PL_STATES; i++) {
        end[i] = y[i] + gain[i];
    }
    return !pl_not_finite(end, PL_STATES);
}

#include "interpolant.h"
#include "constraints.h"

/* ---- the next internal step ---- */

#if PL_ARGUMENTS > 0
/* Whether the nodes of a step of `size` h show what the arguments do between them: where one moves by less than would
 * pass over it.  An exponent of (3 stages / 2)^2 is one of exp(-z^2) for z from -3 stages / 2 on, whose nodes are 3
 * apart. */
static int PL(shows_along)(const PL_TYPE *s, const real start[], const real slope[], real size,
                           const real poly[PL_STAGES + 1][PL_COLUMNS])
{
    real c[PL_STAGES + 1][PL_ARGUMENTS], y[PL_STATES], value[PL_ARGUMENTS], known[PL_ROOM(PL_KNOWN)];
    int i, k;
    PL(no_slopes)(PL_STAGES, PL_ARGUMENTS, c[0]);
    PL(known_at)(s, PL_TRACE_READS, start, slope, 0, size / 2, known);
    PL(trace)(known, PL(intervals)(s), s->start, c[0]);
    for (k = 0; k < PL_STAGES; k++) {
        PL(known_at)(s, PL_TRACE_READS, start, slope, PL(node)[k] * size, size / 2, known);
        PL(at_node)(s, poly, k, y);
        PL(trace)(known, PL(intervals)(s), y, value);
        PL(add_node)(PL_ARGUMENTS, PL_ARGUMENTS, k, value, c[0]);
    }
    for (i = 0; i < PL_ARGUMENTS; i++) {
        if (!PL(follows)(&c[0][i], PL_ARGUMENTS, PL_STAGES, 1, PL(argument)[i][1], PL_RISE / (real)PL(argument)[i][2],
                         PL_RISE_FACTOR)) {
            return 0;
        }
    }
    return 1;
}
#endif

/* The next internal step starts where the last ends. */
static void PL(commit)(PL_TYPE *s)
{
    int i;
    if (s->size == 0) {
        return;
    }
    for (i = 0; i < PL_STATES; i++) {
        s->start[i] = pl_accumulate(s->start[i], s->gain[i], 0, &s->low[i]);
    }
    if (s->stop == PL_AT_STEP) {
        s->at = s->at_low = 0;
        s->back = 0;
    } else {
        const int whole = (int)(s->at = pl_accumulate(s->at, s->size, 0, &s->at_low));
        s->at -= (real)whole;
        s->back -= whole;
    }
#if PL_SEGMENTS > 1
    s->leg += s->stop == PL_AT_CHANGE;
#endif
    s->size = 0;
#if PL_CONSTRAINTS
    s->status |= PL(project)(s, PL(since)(s) * PL_H, s->start, s->low);
#endif
    PL(measure)(s);
}

/* How long the next internal step may be at most, in h; s->stop says what ends it there */
static real PL(limit)(PL_TYPE *s)
{
    real limit = 65536;
    s->stop = PL_AT_ERROR;
#if PL_INPUTS > 0
    limit = ((real)(s->back + 1) - s->at) - s->at_low; /* the samples to come are not known */
    s->stop = PL_AT_STEP;
#elif PL_ALIGNED
    if ((real)(int64_t)(s->until - s->k) > PL(since)(s)) {
        limit = ((real)(int64_t)(s->until - s->k) - PL(since)(s)) - s->at_low;
        s->stop = PL_AT_STEP;
    }
#endif
#if PL_SEGMENTS > 1
    for (; s->leg < PL_SEGMENTS - 1; s->leg++) {
        const real change = PL(until)(s, s->leg) / PL_H - PL(since)(s);
        if (change > (real)1e-12) {
            if (change < limit) {
                limit = change;
                s->stop = PL_AT_CHANGE;
            }
            break;
        }
    }
#endif
    return limit;
}

#if PL_SWITCHING_FUNCTIONS > 0
#include "passage.h"
#endif

/* A first length, in h: the states move by a hundredth of what they are, at their speed */
static real PL(first)(const PL_TYPE *s, const real start[], const real slope[])
{
    real left[PL_COORDS], jacobian[PL_ROOM(PL_ENTRIES)], most = 1;
    int i;
    PL(here)(s, start, slope, left, jacobian);
    for (i = 0; i < PL_STATES; i++) {
        const real rate = PL(is_moved)(i) ? s->start[PL(highest)(PL(coord)(i))] : left[PL(coord)(i)];
        const real speed = pl_magnitude(rate) * s->unit[i] * (100 * PL_H);
        most = speed > most ? speed : most;
    }
    return most < 1 / PL_FIRST ? 1 / most : PL_FIRST;
}

/* Whether something may hide between the nodes of a step */
static inline int PL(is_hidden)(const PL_TYPE *s, const real start[], const real slope[], real size,
                                const real poly[PL_STAGES + 1][PL_COLUMNS])
{
    if (PL_CROWDED > 0 && size > PL_CROWDED) {
        return 1;
    }
#if PL_ARGUMENTS > 0
    return !PL(shows_along)(s, start, slope, size, poly);
#else
    (void)s;
    (void)start;
    (void)slope;
    (void)poly;
    return 0;
#endif
}

/* Whether a step of `size` h is as exact as it has to be; by what factor the next may be longer, or this has to be
 * shorter */
static inline int PL(attempt)(PL_TYPE *s, const real start[], const real slope[], const real jacobian[], real size,
                              int rejected, real made[PL_STATES], real known[PL_STAGES][PL_ROOM(PL_KNOWN)],
                              real unit[PL_STATES], real poly[PL_STAGES + 1][PL_COLUMNS], real *factor)
{
    real k[PL_UNKNOWNS], error;
    int i, found, good;
    for (i = 0; i < PL_UNKNOWNS && !s->ready; i++) {
        k[i] = 0;
    }
    if (s->ready) {
        PL(continue)((const real (*)[PL_COLUMNS])s->poly, 1, size * s->per, s->per / PL_H, k);
    }
    found = PL(solve)(s, start, slope, jacobian, size, known, unit, k);
    if (!found && s->ready && rejected > 3) { /* what an event has cut short says nothing of what is far behind it */
        for (i = 0; i < PL_UNKNOWNS; i++) {
            k[i] = 0;
        }
        s->ready = 0;
        found = PL(solve)(s, start, slope, jacobian, size, known, unit, k);
        s->ready = 1;
    }
    if (!found) {
        return 0;
    }
    error = PL(finish)(s->start, size * PL_H, unit, k, poly, s->gain) + PL_NOTHING;
    good = error <= 2 * PL_TOLERANCE;
    PL(leave_rest)(s, rejected, unit, made);
    if (error < (real)1e30) {
        *factor = (real)0.9 * pl_root(PL_TOLERANCE / error, PL_STAGES + 1);
    }
    *factor = *factor > 5 ? 5 : *factor > (real)0.15 ? *factor : (real)0.15;
    if (good && PL(is_hidden)(s, start, slope, size, (const real (*)[PL_COLUMNS])poly)) {
        good = 0;
        *factor = (real)0.5;
    }
    return good;
}

/* An internal step of the collocation, at most `limit` h long: 0, or what went wrong.  rates: what bounds a series
 * beside it */
static int PL(collocate)(PL_TYPE *s, const real start[], const real slope[], real limit, const real rates[2],
                         int *tried)
{
    real jacobian[PL_ROOM(PL_ENTRIES)], made[PL_STATES] = {0};
    const int stop = s->stop;
    int rejected = 0, wrong = 0, i, j;
#if PL_MODES > 0
    real left[PL_COORDS];
    PL(here)(s, start, slope, left, jacobian);
#else
    jacobian[0] = 0; /* that of each node counts */
#endif
    for (;;) {
        real known[PL_STAGES][PL_ROOM(PL_KNOWN)];
        real poly[PL_STAGES + 1][PL_COLUMNS], unit[PL_STATES], factor = rejected < 3 ? (real)0.25 : (real)0.0625;
        const real size = PL(wanted)(s->want, limit);
        if ((*tried)++ == PL_TRIES) {
            return PL_TOO_MANY_STEPS;
        }
        if (!(size > PL_SHORTEST)) {
            return PL_NOT_FINITE;
        }
        if (!PL(attempt)(s, start, slope, jacobian, size, rejected, made, known, unit, poly, &factor)) {
            s->want = size * (rejected++ < 3 || factor < (real)0.1 ? factor : (real)0.1);
#if PL_ORDER > 0
            if (PL(product)(rates, s->want) < (real)0.5) {
                return PL_BY_SERIES;
            }
#endif
            continue;
        }
        s->want = size < limit || s->want < size * factor ? size * factor : s->want;
        s->stop = size < limit ? PL_AT_ERROR : stop;
        s->size = size;
        s->per = 1 / size;
        s->ready = 1;
#if PL_ORDER > 0
        s->series = 0;
        s->run++;
#endif
#if PL_SWITCHING_FUNCTIONS > 0
        wrong = PL(pass)(s, start, slope, jacobian, limit, known, unit, poly);
#endif
#if PL_CONTACTS
        *tried -= s->stop == PL_AT_CROSSING; /* events have a limit of their own */
#endif
        for (i = 1; i <= PL_STAGES; i++) {
            for (j = 0; j < PL_STATES; j++) {
                s->poly[i][j] = poly[i][j];
            }
        }
        (void)rates;
        return wrong;
    }
}

/* An internal step, by one method or the other: 0, or what went wrong */
static inline int PL(next)(PL_TYPE *s, const real u[], const real start[], const real slope[], int *tried)
{
    const real limit = PL(limit)(s);
#if PL_ORDER > 0
    real rates[2];
#else
    const real *const rates = NULL;
#endif
    (void)u;
#if PL_CONTACTS
    const int changed = PL(begin)(s, start, slope);
    if (changed) {
        return changed;
    }
#elif PL_SWITCHING_FUNCTIONS > 0
    if (!s->contact.placed) {
#if PL_ORDER == 0
        PL(locate)(s, start, slope);
#else
        PL(locate)(s, u, &s->contact);
#endif
    }
    if (PL(left)(s, start, slope)) {
        if (!PL(pass_here)(s, start, slope)) {
            return PL_TOO_MANY_EVENTS;
        }
        return PL_ANOTHER;
    }
#endif
    if (s->want == 0) {
        s->want = PL_SHARE_OF_FIRST * PL(first)(s, start, slope);
    }
#if PL_ORDER > 0
    PL(find_rates)(s, start, slope, rates);
    return PL(choose)(s, start, slope, limit, rates, tried);
#else
    return PL(collocate)(s, start, slope, limit, rates, tried);
#endif
}

/* The next internal step, from the end of the last: 0, or what went wrong; *tried of them were tried */
static int PL(advance)(PL_TYPE *s, const real u[], int *tried)
{
    real start[PL_ROOM(PL_INPUTS)], slope[PL_ROOM(PL_INPUTS)];
#if PL_SWITCHING_FUNCTIONS > 0
    int passes = s->size > 0 && s->stop == PL_AT_CROSSING, wrong;
    PL(inputs_now)(s, u, start, slope);
    PL(commit)(s);
    do {
        if (passes && !PL(pass_here)(s, start, slope)) {
            return PL_TOO_MANY_EVENTS;
        }
        wrong = PL(next)(s, u, start, slope, tried);
        passes = wrong == PL_NO_MOVE && s->contact.last.expression >= 0;
    } while (wrong == PL_NO_MOVE || wrong == PL_ANOTHER);
    return wrong;
#else
    PL(inputs_now)(s, u, start, slope);
    PL(commit)(s);
    return PL(next)(s, u, start, slope, tried);
#endif
}

/* ---- the step ---- */

/* y `end` h after now, from as many internal steps as it takes: 0; or what went wrong, and the last good state */
static int PL(reach)(PL_TYPE *s, const real u[], real end, real y[PL_STATES])
{
    int i, tried = 0, wrong = 0;
    real ahead;
    while ((ahead = (((real)s->back + end) - s->at) - s->at_low) > s->size && !wrong) {
        wrong = PL(advance)(s, u, &tried);
    }
    if (!wrong) {
        PL(inside)(s, ahead, y);
        PL_PUT_BACK(s, end * PL_H, y);
        return 0;
    }
    for (i = 0; i < PL_STATES; i++) {
        y[i] = s->start[i];
    }
    return PL_CAUSE(s, PL(since)(s) * PL_H, y, wrong);
}

/* The states of a step of h; what else takes part in it moves on behind. */
static int PL(collocated)(PL_TYPE *s, const real u[])
{
    int wrong;
#if PL_SWITCHING_FUNCTIONS > 0
    s->contact.crossings = 0;
#endif
#if PL_CONTACTS
    s->contact.chain = PL(no_impact)();
#endif
    wrong = PL(reach)(s, u, 1, s->y);
    s->back++;
    return wrong;
}

/* At the end of the step */
static void PL(settle)(PL_TYPE *s, int wrong)
{
    (void)PL(change_loads)(s);
    if (wrong) {
        s->status |= wrong;
        PL(anew)(s);
    }
}

/* y tau after now; what it takes beyond the internal step is of a copy, and not kept. */
static void PL(between)(const PL_TYPE *s, const real u[], real tau, real y[PL_STATES])
{
    const real ahead = (((real)s->back + tau / PL_H) - s->at) - s->at_low;
    if (ahead <= s->size && s->size > 0) {
        PL(inside)(s, ahead, y);
        PL_PUT_BACK(s, tau, y);
    } else {
        PL_TYPE copy = *s;
        PL(reach)(&copy, u, tau / PL_H, y);
    }
}

#include "undef.h"
