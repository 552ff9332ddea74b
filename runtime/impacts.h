/* SPDX-License-Identifier: MIT-0 */
/* impacts.h: where x is between breakpoints and guards, and impacts at one instant, which act one after the other; for
 * the runtime's own use: by guards.c. */
#ifndef PLRT_IMPACTS_H
#define PLRT_IMPACTS_H

#include "chain.h"
#include "kept.h"
#include "regions.h"

static const real *matrix_of(const real *all, const pl_guards *m, int matrix)
{
    return all + WORDS * (ptrdiff_t)matrix * m->size * m->size;
}

/* ---- regions ---- */

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

static real excess(const pl_guards *m, const pl_contact *c, const walk *w, int breakpoint, const real *x, real *noise)
{
    const real *row = m->row + w->i * m->size;
    const real *tangent = m->tangent + ((ptrdiff_t)c->matrix * m->switches + w->i) * m->size;
    const real b = w->at[breakpoint];
    real e;
    e = dot(m->size, row, x);
    *noise = noise_of(sizes(m->size, row, x) + 3 * sizes(m->size, tangent, x) + magnitude(b) + m->play[w->i]);
    return e - b;
}

/* 1 or -1 where e is above or below its interval by more than rounding, else 0 */
static int outside(const pl_guards *m, const pl_contact *c, const walk *w, const real *x)
{
    real noise;
    if (w->interval < w->breaks && excess(m, c, w, w->interval, x, &noise) > noise) {
        return 1;
    }
    if (w->interval > 0 && -excess(m, c, w, w->interval - 1, x, &noise) > noise) {
        return -1;
    }
    return 0;
}

/* What follows from an event is listed where there is room, and counted. */
static void tell(int max_events, pl_contact *c, pl_crossing *crossing, real time, int expression, int breakpoint,
                 int upward)
{
    if (c->crossings < max_events) {
        (void)list(max_events, c, crossing, time, expression, breakpoint, upward);
    } else {
        c->total++;
    }
}

/* The interval before the guard of a bounce */
static int free_of(const pl_impact *p)
{
    return p->rest + (p->upward ? -1 : 1);
}

/* Whether a bounce stops an expression that would go this way */
static int is_stopped(const pl_guards *m, const walk *w, int way)
{
    int k;
    for (k = 0; k < m->impacts; k++) {
        const pl_impact *p = &m->impact[k];
        if (p->expression == w->i && p->rest >= 0 && p->upward == (way > 0) &&
            (w->interval == p->rest || w->interval == free_of(p))) {
            return 1;
        }
    }
    return 0;
}

/* An expression that has left its interval other than by an event: by an input, a load or a jump.  Past a bounce a jump
 * alone leads (`jumped`): what rounding has taken beyond one is still before it. */
static void follow(const pl_guards *m, int jumped, const real *x, pl_contact *c, pl_crossing *crossing, real time)
{
    walk w;
    int way;
    for (w = first_switch(m->at); arrive(m->switches, m->breaks, c->region, &w); leave(&w)) {
        for (; (way = outside(m, c, &w, x)) != 0 && (jumped || !is_stopped(m, &w, way)); w.interval += way) {
            if (crossing) {
                tell(m->max_events, c, crossing, time, w.i, w.interval - (way < 0), way > 0);
            }
            enter(m->matrix, c, c->region + way * w.stride);
        }
    }
}

/* ---- impacts ---- */

static walk switch_of(const pl_guards *m, int region, int expression)
{
    walk w;
    for (w = first_switch(m->at); arrive(m->switches, m->breaks, region, &w) && w.i < expression; leave(&w)) {
        ;
    }
    return w;
}

/* The speed at which impact k comes closer, 0 where that is but rounding */
static real speed_of(const pl_guards *m, int k, const real *x)
{
    const real *row = m->speed + (ptrdiff_t)k * m->size;
    real speed;
    speed = dot(m->size, row, x);
    return magnitude(speed) <= noise_of(sizes(m->size, row, x) + m->impact[k].play) ? 0 : speed;
}

/* Whether a bounce is on its guard, but for so much at least, flying or at rest, or where rounding has taken it */
static int touches_by(const pl_guards *m, const pl_contact *c, const pl_impact *p, const real *x, real least)
{
    const walk w = switch_of(m, c->region, p->expression);
    real noise, e;
    if (p->rest < 0 || (w.interval != p->rest && w.interval != free_of(p))) {
        return 0;
    }
    e = excess(m, c, &w, p->breakpoint, x, &noise);
    return (p->upward ? e : -e) >= -larger(noise, least);
}

static int touches(const pl_guards *m, const pl_contact *c, const pl_impact *p, const real *x)
{
    return touches_by(m, c, p, x, 0);
}

static int rests(const pl_guards *m, const pl_contact *c, const pl_impact *p)
{
    return switch_of(m, c->region, p->expression).interval == p->rest;
}

static void go_to(const pl_guards *m, pl_contact *c, const pl_impact *p, int interval)
{
    const walk w = switch_of(m, c->region, p->expression);
    enter(m->matrix, c, c->region + (interval - w.interval) * w.stride);
}

/* What rounding has left of the way to the guard goes. */
static void put_on(const pl_guards *m, const pl_contact *c, int k, real *x)
{
    const walk w = switch_of(m, c->region, m->impact[k].expression);
    const real *back = m->back + (ptrdiff_t)k * m->size;
    real noise;
    const real e = excess(m, c, &w, m->impact[k].breakpoint, x, &noise);
    int i;
    for (i = 0; i < m->size; i++) {
        take_from(m->size, i, back[i] * e, x);
    }
}

/* Into the intervals in which those of a set rest, as far as they all can.  Returns those that do now. */
static uint32_t seat(const pl_guards *m, uint32_t set, pl_contact *c)
{
    uint32_t laid = 0;
    int k;
    for (k = 0; k < m->impacts; k++) {
        const int before = c->region;
        if (!(set >> k & 1) || rests(m, c, &m->impact[k])) {
            continue;
        }
        go_to(m, c, &m->impact[k], m->impact[k].rest);
        if (m->matrix[c->region] < 0) {
            enter(m->matrix, c, before); /* others hold it already */
        } else {
            laid |= (uint32_t)1 << k;
        }
    }
    return laid;
}

/* Those of a set, as bits, come to rest together and with those that do, as far as they all can: by impacts with
 * restitution 0, which keep momentum, until what is left of their speeds is nothing to speak of.  Returns those that
 * rest now. */
static uint32_t lay(const pl_guards *m, uint32_t set, real *x, pl_contact *c, real *work)
{
    uint32_t laid;
    int k, sweeps, moving = 1;
    for (k = 0; k < m->impacts; k++) {
        set |= (uint32_t)(m->impact[k].rest >= 0 && rests(m, c, &m->impact[k])) << k;
    }
    for (sweeps = 0; sweeps < MOST_SWEEPS && moving; sweeps++) {
        moving = 0;
        for (k = 0; k < m->impacts; k++) {
            if (set >> k & 1) {
                moving |= magnitude(speed_of(m, k, x)) > 0;
                assign(m, m->impact[k].still, x, work);
                put_on(m, c, k, x);
            }
        }
    }
    laid = seat(m, set, c);
    assign(m, m->hold[c->region], x, work);
    return laid;
}

static void list_rests(const pl_guards *m, uint32_t laid, pl_contact *c, pl_crossing *crossing, real time)
{
    int k;
    for (k = 0; k < m->impacts; k++) {
        const pl_impact *p = &m->impact[k];
        if (laid >> k & 1) {
            c->rested++;
            tell(m->max_events, c, crossing, time, p->expression, p->breakpoint, p->upward);
        }
    }
}

/* Impacts without an end become slower and slower: what touches with less than `slow` comes to rest together. */
static void calm(const pl_guards *m, real slow, uint32_t met, real *x, pl_contact *c, pl_crossing *crossing,
                 const pl_chain *chain, real *work)
{
    uint32_t set = 0;
    int k;
    for (k = 0; k < m->impacts; k++) {
        if ((met >> k & 1 || touches(m, c, &m->impact[k], x)) && magnitude(speed_of(m, k, x)) <= slow &&
            !rests(m, c, &m->impact[k])) {
            set |= (uint32_t)1 << k;
        }
    }
    list_rests(m, lay(m, set, x, c, work), c, crossing, chain->last);
}

/* Where impacts go on and on, those that act and lose speed come to rest, and so does what they press against: but for
 * what has been parted for good.  0: nothing does. */
static int give_up(const pl_guards *m, uint32_t met, real *x, pl_contact *c, pl_crossing *crossing, pl_chain *chain,
                   real *work)
{
    uint32_t set = 0;
    real fastest = 0;
    int k;
    for (k = 0; k < m->impacts; k++) {
        fastest = met >> k & 1 ? larger(fastest, speed_of(m, k, x)) : fastest;
    }
    for (k = 0; k < m->impacts; k++) {
        const real speed = met >> k & 1 && m->impact[k].restitution < 1 ? speed_of(m, k, x) : -16 * fastest;
        if (speed > 0 || (chain->acting >> k & 1 && speed > -16 * fastest)) {
            set |= (uint32_t)1 << k;
        }
    }
    list_rests(m, lay(m, set, x, c, work), c, crossing, chain->last);
    chain->impacts = MOST_AT_ONCE - SOME;
    chain->ended++;
    return set != 0;
}

/* A speed that is nothing but what rounding makes of forces over a step.  work: size */
static real least_speed(const pl_guards *m, const pl_contact *c, const real *x, real *work)
{
    const int n = m->size;
    pl_contact flying = *c;
    real most = 0;
    int k;
    for (k = 0; k < m->impacts; k++) {
        if (m->impact[k].rest >= 0 && touches(m, c, &m->impact[k], x)) {
            go_to(m, &flying, &m->impact[k], free_of(&m->impact[k]));
        }
    }
    for (k = 0; k < n; k++) {
        work[k] = sizes(n, matrix_of(m->A, m, flying.matrix) + k * n, x);
    }
    for (k = 0; k < m->impacts; k++) {
        if (m->impact[k].rest >= 0 && touches(m, c, &m->impact[k], x)) {
            most = larger(most, sizes(n, m->speed + (ptrdiff_t)k * n, work));
        }
    }
    return m->h * noise_of(most);
}

/* An event: what loses speed in contacts goes on beyond the list. */
static int has_listed(const pl_guards *m, int loses, pl_contact *c, pl_crossing *crossing, real time, int expression,
                      int breakpoint, int upward)
{
    if (!loses) {
        return list(m->max_events, c, crossing, time, expression, breakpoint, upward);
    }
    tell(m->max_events, c, crossing, time, expression, breakpoint, upward);
    return 1;
}

/* Whether there is room for one more impact */
static int has_room(const pl_guards *m, int k, pl_contact *c, pl_crossing *crossing, pl_chain *chain)
{
    const pl_impact *p = &m->impact[k];
    if (is_listed(chain, k, c->crossings, m->max_events)) {
        chain->full = !has_listed(m, p->restitution < 1, c, crossing, chain->last, p->expression, p->breakpoint,
                                  p->upward);
    }
    if (!chain->full && !has_time(chain)) {
        c->status |= PL_TOO_MANY_EVENTS;
    }
    return !chain->full;
}

/* All impacts at this instant; begins: the one whose guard was met, or -1.  Returns those that acted, as bits.  What
 * has met once stays together: what rounding makes of that while speeds go to 0 has no size to be held against. */
static uint32_t collide(const pl_guards *m, int begins, real *x, pl_contact *c, pl_crossing *crossing, real time,
                        pl_chain *chain, real *work)
{
    uint32_t struck = 0, met = 0;
    real slow = -1;
    int k, calms = 0;
    go_on(chain, time, m->h);
    for (k = 0; k < m->impacts && !chain->full; k++) {
        const pl_impact *p = &m->impact[k];
        real speed = 0;
        if (met >> k & 1 || touches(m, c, p, x)) {
            met |= (uint32_t)1 << k;
            speed = speed_of(m, k, x);
        }
        if (k != begins && !(speed > 0)) {
            continue;
        }
        if (slow < 0) {
            slow = least_speed(m, c, x, work);
        }
        slow = larger(slow, CALM * chain->most);
        if (k != begins && speed <= slow) {
            calms = 1;
            continue;
        }
        chain->most = larger(chain->most, speed);
        if (chain->impacts == MOST_AT_ONCE) {
            chain->full = !give_up(m, met, x, c, crossing, chain, work);
            c->status |= chain->full ? PL_TOO_MANY_EVENTS : 0;
            begins = k = -1;
            continue;
        }
        if (!has_room(m, k, c, crossing, chain)) {
            break;
        }
        assign(m, p->jump, x, work);
        if (p->rest >= 0) {
            go_to(m, c, p, free_of(p));
            put_on(m, c, k, x);
            met |= (uint32_t)1 << k;
        } else {
            follow(m, 1, x, c, crossing, chain->last);
            met = 0;
        }
        struck |= (uint32_t)1 << k;
        begins = k == begins ? -1 : begins;
        calms = 0;
        k = -1;
    }
    if (calms) {
        calm(m, slow, met, x, c, crossing, chain, work);
    }
    return struck;
}

/* How long it flies that leaves the guard of k, from how it is pressed back there; -1: for good.  work: size */
static real flight(const pl_guards *m, const pl_contact *c, int k, const real *x, real *work)
{
    const real speed = speed_of(m, k, x);
    real press;
    if (m->impact[k].rest < 0 || speed > 0) {
        return -1;
    }
    pl_multiply(m->size, m->size, matrix_of(m->A, m, c->matrix), x, work);
    press = dot(m->size, m->speed + (ptrdiff_t)k * m->size, work);
    return press > 0 ? -2 * speed / press : -1;
}

/* A piece not much longer than the shortest flight that begins there */
static real shortened(const pl_guards *m, const pl_contact *c, const real *x, real dt, real *work)
{
    int k;
    for (k = 0; k < m->impacts; k++) {
        const int flies = speed_of(m, k, x) < 0 && touches(m, c, &m->impact[k], x);
        const real along = flies ? flight(m, c, k, x, work) : 0;
        if (along > 0) {
            dt = smaller(dt, 2 * along);
        }
    }
    return dt;
}

#endif
