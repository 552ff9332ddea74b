/* SPDX-License-Identifier: MIT-0 */
/* strikes.h: watches, what is held, and impacts at one instant beside a series, for the runtime's own use: by
 * events.c. */
#ifndef PLRT_STRIKES_H
#define PLRT_STRIKES_H

#include "chain.h"
#include "columns.h"
#include "roots.h"

#ifdef REAL_IS_FLOAT
#define NEAR 0x1p-10f
#else
#define NEAR 0x1p-20
#endif

/* ---- watches ---- */

static column watched(const pl_events *m, const pl_instant *at, int watch)
{
    column w;
    w.m = m->divided;
    w.first = at->c + m->watch[watch];
    w.terms = at->terms[m->divided->expressions + watch];
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

static int is_near(const pl_events *m, const pl_instant *at, int watch)
{
    const column w = watched(m, at, watch);
    real noise;
    return magnitude(off_start(&w, 0, &noise)) <= noise;
}

static void refresh(const pl_instant *at)
{
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

static int free_of(const pl_events *m, const pl_strike *p)
{
    return m->hold[p->hold].interval + (p->upward ? -1 : 1);
}

static int strike_at(const pl_events *m, int expression, int breakpoint, int upward)
{
    int i;
    for (i = m->strikes - 1; i >= 0; i--) {
        if (m->strike[i].expression == expression && m->strike[i].breakpoint == breakpoint &&
            m->strike[i].upward == upward) {
            break;
        }
    }
    return i;
}

static int list(const pl_events *m, pl_instant *at, real time, int expression, int breakpoint, int upward)
{
    pl_crossing *crossing = at->crossing + *at->crossings;
    if (*at->crossings == m->max_events) {
        return 0;
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

static void take(const pl_instant *at, int states, const real *back, real times)
{
    int i;
    for (i = 0; i < states; i++) {
        if (back[i] < 0 || back[i] > 0) {
            at->y[i] -= back[i] * times;
            at->rest[i] = 0;
        }
    }
}

/* Puts what is held where it is held, but for rounding. */
static void put_back(const pl_events *m, pl_instant *at, int hold)
{
    const pl_hold *h = &m->hold[hold];
    take(at, m->states, m->back + (ptrdiff_t)hold * m->states, value_of(m, at, h->velocity));
    if (h->strike >= 0) {
        take(at, m->states, m->place_back + (ptrdiff_t)h->strike * m->states,
             value_of(m, at, m->strike[h->strike].place));
    }
    refresh(at);
}

/* Whether what is held has moved by more than rounding */
static int is_slack(const pl_events *m, const pl_instant *at, int hold)
{
    const pl_hold *h = &m->hold[hold];
    const column velocity = watched(m, at, h->velocity);
    column place;
    if (h->strike < 0) {
        return !(certain(&velocity) >= 0 && certain(&velocity) <= 0);
    }
    place = watched(m, at, m->strike[h->strike].place);
    return !(certain(&velocity) >= 0 && certain(&velocity) <= 0 && certain(&place) >= 0 && certain(&place) <= 0);
}

static void keep(const pl_events *m, pl_instant *at)
{
    int again, i;
    for (again = 0; again < 3; again++) {
        for (i = 0; i < m->holds; i++) {
            if (holds_now(m, at, i) && is_slack(m, at, i)) {
                put_back(m, at, i);
            }
        }
    }
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

/* Whether what is held would be let go to this side: 1; -1: it is held; 0: it hangs in the balance.  The root at which
 * it is let go may be off by what does not show beside the force over h, as one of third order is. */
static int lets_go(const pl_events *m, const pl_instant *at, int hold, int up)
{
    const int watch = up ? m->hold[hold].up : m->hold[hold].down;
    column w;
    real pull;
    if (watch < 0) {
        return -1;
    }
    w = watched(m, at, watch);
    pull = certain(&w);
    if (at->freed == hold && at->next.upward == up && magnitude(pull) <= NEAR * most_of(&w)) {
        return 1;
    }
    return pull > 0 ? 1 : pull < 0 ? -1 : way_of(&w);
}

/* ---- impacts ---- */

/* Whether a bounce is on its guard, but for so much at least, flying or at rest, or where rounding has taken it */
static int touches_by(const pl_events *m, const pl_instant *at, const pl_strike *p, real least)
{
    const int interval = at->interval[p->expression];
    column w;
    real noise;
    if (p->hold < 0 || (interval != m->hold[p->hold].interval && interval != free_of(m, p))) {
        return 0;
    }
    w = watched(m, at, p->place);
    return off_start(&w, 0, &noise) >= -larger(noise, least);
}

static int touches(const pl_events *m, const pl_instant *at, const pl_strike *p)
{
    return touches_by(m, at, p, 0);
}

static real speed_of(const pl_events *m, const pl_instant *at, const pl_strike *p)
{
    const column w = watched(m, at, p->speed);
    const real speed = certain(&w);
    return magnitude(speed) <= at->chain.least ? 0 : speed;
}

/* The states of these assignments, all from the same state */
static void assign(const pl_events *m, pl_instant *at, int first, int count)
{
    int k;
    for (k = first; k < first + count; k++) {
        at->y[m->state[k]] = value_of(m, at, m->value[k]);
        at->rest[m->state[k]] = 0;
    }
    refresh(at);
}

/* Whether a bounce stops an expression that would go this way */
static int is_stopped(const pl_events *m, const pl_instant *at, int expression, int way)
{
    int k;
    for (k = 0; k < m->strikes; k++) {
        const pl_strike *p = &m->strike[k];
        if (p->expression == expression && p->hold >= 0 && p->upward == (way > 0) &&
            (at->interval[expression] == m->hold[p->hold].interval || at->interval[expression] == free_of(m, p))) {
            return 1;
        }
    }
    return 0;
}

/* Into the intervals where a jump has put expressions.  Past a bounce a jump of a state alone leads (`jumped`): what
 * rounding has taken beyond one is still before it. */
static void follow(const pl_events *m, pl_instant *at, int jumped)
{
    const pl_divided *d = m->divided;
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
                (void)list(m, at, at->time, i, *interval - (way < 0), way > 0);
            }
            *interval += way;
        }
    }
    refresh(at);
}

static void tell_rests(const pl_events *m, uint32_t laid, pl_instant *at)
{
    int k;
    for (k = 0; k < m->strikes; k++) {
        if (laid >> k & 1) {
            (void)list(m, at, at->time, m->strike[k].expression, m->strike[k].breakpoint, m->strike[k].upward);
            (*at->rested)++;
        }
    }
}

static int conflicts_now(const pl_events *m, const pl_instant *at)
{
    uint32_t held = 0;
    int i;
    for (i = 0; i < m->holds; i++) {
        held |= (uint32_t)holds_now(m, at, i) << i;
    }
    for (i = 0; i < m->conflicts && (held & m->conflict[i].set) != m->conflict[i].set; i++) {
        ;
    }
    return i < m->conflicts;
}

/* Into the intervals in which those of a set rest, as far as they all can.  Returns those that do now. */
static uint32_t seat(const pl_events *m, uint32_t set, pl_instant *at)
{
    uint32_t laid = 0;
    int k;
    for (k = 0; k < m->strikes; k++) {
        const pl_strike *p = &m->strike[k];
        if (!(set >> k & 1) || holds_now(m, at, p->hold)) {
            continue;
        }
        at->interval[p->expression] = m->hold[p->hold].interval;
        if (conflicts_now(m, at)) {
            at->interval[p->expression] = free_of(m, p);
        } else {
            laid |= (uint32_t)1 << k;
        }
    }
    refresh(at);
    return laid;
}

/* Those of a set, as bits, come to rest together and with those that do, as far as they all can: by impacts with
 * restitution 0, which keep momentum, until what is left of their speeds is nothing to speak of.  Returns those that
 * rest now. */
static uint32_t lay(const pl_events *m, uint32_t set, pl_instant *at)
{
    uint32_t laid;
    int k, sweeps, moving = 1;
    for (k = 0; k < m->strikes; k++) {
        set |= (uint32_t)(m->strike[k].hold >= 0 && holds_now(m, at, m->strike[k].hold)) << k;
    }
    for (sweeps = 0; sweeps < MOST_SWEEPS && moving; sweeps++) {
        moving = 0;
        for (k = 0; k < m->strikes; k++) {
            if (set >> k & 1) {
                moving |= magnitude(speed_of(m, at, &m->strike[k])) > 0;
                assign(m, at, m->strike[k].still, m->strike[k].jumps);
                take(at, m->states, m->place_back + (ptrdiff_t)k * m->states, value_of(m, at, m->strike[k].place));
                refresh(at);
            }
        }
    }
    laid = seat(m, set, at);
    keep(m, at);
    return laid;
}

/* Impacts without an end become slower and slower: what has met and has at most this speed comes to rest together. */
static void calm(const pl_events *m, real slow, uint32_t met, pl_instant *at)
{
    uint32_t set = 0;
    int k;
    for (k = 0; k < m->strikes; k++) {
        if (met >> k & 1 && magnitude(speed_of(m, at, &m->strike[k])) <= slow) {
            set |= (uint32_t)1 << k;
        }
    }
    tell_rests(m, lay(m, set, at), at);
}

/* Where impacts go on and on, those that act and lose speed come to rest, and so does what they press against: but for
 * what has been parted for good.  0: nothing does. */
static int give_up(const pl_events *m, uint32_t met, pl_instant *at)
{
    uint32_t set = 0;
    real fastest = 0;
    int k;
    for (k = 0; k < m->strikes; k++) {
        fastest = met >> k & 1 ? larger(fastest, speed_of(m, at, &m->strike[k])) : fastest;
    }
    for (k = 0; k < m->strikes; k++) {
        const int loses = met >> k & 1 && m->strike[k].restitution < 1;
        const real speed = loses ? speed_of(m, at, &m->strike[k]) : -16 * fastest;
        if (speed > 0 || (at->chain.acting >> k & 1 && speed > -16 * fastest)) {
            set |= (uint32_t)1 << k;
        }
    }
    tell_rests(m, lay(m, set, at), at);
    at->chain.impacts = MOST_AT_ONCE - SOME;
    at->chain.ended++;
    return set != 0;
}

/* Whether there is room for one more impact: what loses speed goes on beyond the list. */
static int has_room(const pl_events *m, int k, pl_instant *at)
{
    const pl_strike *p = &m->strike[k];
    if (is_listed(&at->chain, k, *at->crossings, m->max_events) &&
        !list(m, at, at->time, p->expression, p->breakpoint, p->upward)) {
        at->chain.full = !(p->restitution < 1);
    }
    return !at->chain.full && has_time(&at->chain);
}

/* All impacts at this instant; begins: the one whose guard was met.  Returns those that acted, as bits.  What has met
 * once stays together: what rounding makes of that while speeds go to 0 has no size to be held against. */
static uint32_t collide(const pl_events *m, int begins, pl_instant *at)
{
    uint32_t struck = 0, met = 0;
    real slow = 0;
    int k, calms = 0;
    go_on(&at->chain, at->time, m->h);
    for (k = 0; k < m->strikes && !at->chain.full; k++) {
        const pl_strike *p = &m->strike[k];
        real speed = 0;
        if (met >> k & 1 || touches(m, at, p)) {
            const column w = watched(m, at, p->speed);
            met |= (uint32_t)1 << k;
            at->chain.least = larger(at->chain.least, noise_of(magnitude(column_at(&w, 1))));
            speed = speed_of(m, at, p);
            slow = larger(at->chain.least, CALM * at->chain.most);
        }
        if (k != begins && speed <= slow) {
            calms |= speed > 0;
            continue;
        }
        at->chain.most = larger(at->chain.most, speed);
        if (at->chain.impacts == MOST_AT_ONCE) {
            at->chain.full = !give_up(m, met, at);
            begins = k = -1;
            continue;
        }
        if (!has_room(m, k, at)) {
            break;
        }
        assign(m, at, p->jump, p->jumps);
        if (p->hold >= 0) {
            at->interval[p->expression] = free_of(m, p);
            take(at, m->states, m->place_back + (ptrdiff_t)k * m->states, value_of(m, at, p->place));
            refresh(at);
            met |= (uint32_t)1 << k;
        } else {
            follow(m, at, 1);
            met = 0;
        }
        struck |= (uint32_t)1 << k;
        begins = k == begins ? -1 : begins;
        calms = 0;
        k = -1;
    }
    if (calms) {
        calm(m, slow, met, at);
    }
    return struck;
}

#endif
