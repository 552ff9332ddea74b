/* SPDX-License-Identifier: MIT-0 */
/* Steps of piecewise-linear models with dry friction and jumps, from event to event.  Pieces that stay clear of every
 * guard of their region go by e^{A d}; others, short ones, by Taylor polynomials, on which the first event is isolated.
 * What is to stick and what is to slip after an event is found by looking at all combinations of those that are at
 * rest. */
#include "ladder.h"
#include "sticking.h"

/* ---- the start ---- */

/* Puts what is on a plain breakpoint above or below, where it is heading; what rests counts as below. */
static void decide(const pl_guards *m, const real *x, pl_contact *c, real *work)
{
    real noise;
    walk w;
    for (w = first_switch(m->at); arrive(m->switches, m->breaks, c->region, &w); leave(&w)) {
        const int twice = w.interval + 1 < w.breaks && !(w.at[w.interval + 1] > w.at[w.interval]);
        if (w.interval == w.breaks || twice || -excess(m, c, &w, w.interval, x, &noise) > noise) {
            continue;
        }
        if (w.interval > 0 && !(w.at[w.interval] > w.at[w.interval - 1])) {
            continue;
        }
        if (heading(m->size, matrix_of(m->A, m, c->matrix), m->row + w.i * m->size, x, work) > 0) {
            enter(m->matrix, c, c->region + w.stride);
        }
    }
}

void pl_guards_start(const pl_guards *m, const real *x, pl_contact *c, real *work)
{
    walk w;
    int first = 0;
    while (m->matrix[first] < 0) {
        first++;
    }
    c->total = 0;
    c->crossings = c->status = c->rested = 0;
    c->matrix = m->matrix[first];
    enter(m->matrix, c, 0);
    follow(m, 1, x, c, (pl_crossing *)0, 0);
    /* at rest: let it stick first */
    for (w = first_switch(m->at); arrive(m->switches, m->breaks, c->region, &w); leave(&w)) {
        if (w.interval + 1 < w.breaks && !(w.at[w.interval + 1] > w.at[w.interval])) {
            const int impact = impact_of(m, w.i, w.interval + 1);
            real noise;
            if (magnitude(excess(m, c, &w, w.interval, x, &noise)) > noise) {
                continue;
            }
            enter(m->matrix, c, c->region + w.stride);
            if (impact >= 0 && magnitude(speed_of(m, impact, x)) > 0) {
                go_to(m, c, &m->impact[impact], free_of(&m->impact[impact]));
            }
        }
    }
    settle(m, c->region, x, c, (pl_crossing *)0, 0, work);
    decide(m, x, c, work);
    settle(m, c->region, x, c, (pl_crossing *)0, 0, work);
}

/* ---- a piece ---- */

/* Whether it is certain that no guard becomes greater than its limit between x and y, a piece on.  work: size */
static int stays_clear(const pl_guards *m, const pl_contact *c, const real *x, const real *y, real *work)
{
    const int n = m->size;
    int i, k;
    for (i = 0; i < n; i++) {
        work[i] = magnitude(x[i]);
    }
    for (k = m->first[c->region]; k < m->first[c->region + 1]; k++) {
        const ptrdiff_t at = (ptrdiff_t)m->guard[k].row * n;
        real from, to, off, leaving, arriving;
        from = dot(n, m->gate + at, x);
        to = dot(n, m->gate + at, y);
        off = dot(n, m->chord_error + at, work);
        if (larger(from, to) + off < m->limit[k]) {
            continue;
        }
        off = dot(n, m->cubic_error + at, work);
        leaving = dot(n, m->gate_tangent + at, x);
        arriving = dot(n, m->gate_tangent + at, y);
        if (!(larger(larger(from, to), larger(from + leaving, to - arriving)) + off < m->limit[k])) {
            return 0;
        }
    }
    return 1;
}

/* The same of a piece that is longer than the shortest, by x'' where it begins.  work: 2 size */
static int stays_clear_far(const pl_guards *m, const pl_contact *c, climb *at, const real *x, const real *y, real *bend,
                           real *work)
{
    const int n = m->size;
    int k;
    look_at_bend(at, n, matrix_of(m->A, m, c->matrix), x, bend, work);
    for (k = m->first[c->region]; k < m->first[c->region + 1]; k++) {
        const int row = m->guard[k].row;
        const real *gate = m->gate + (ptrdiff_t)row * n;
        real from, to, off;
        from = dot(n, gate, x);
        to = dot(n, gate, y);
        off = dot(n, m->ladder.reach + ((ptrdiff_t)m->ladder.gates[row] + at->rung - 1) * n, bend);
        if (!(larger(from, to) + off < m->limit[k])) {
            return 0;
        }
    }
    return 1;
}

typedef struct event {
    real s;    /* 1 without one */
    int guard; /* -1: none */
} event;

/* What a force that is at its limit but for rounding has let go moves with a slope that is rounding, too: where that
 * points back it is no event. */
static void level(const pl_guards *m, int region, const pl_guard *g, const real *x, beyond *f, real *work)
{
    const int side = g->leads < 0 ? 1 : -1;
    walk w;
    resting r;
    if (magnitude(f->coefficient[0]) > f->noise || !(f->coefficient[1] > 0)) {
        return;
    }
    w = switch_of(m, region, g->expression);
    r.expression = g->expression;
    r.stick = w.interval - side;
    r.stride = w.stride;
    r.impact = -1;
    if (r.stick > 0 && r.stick < w.breaks && !(w.at[r.stick] > w.at[r.stick - 1]) &&
        is_let_go(m, region, &r, side, x, work)) {
        f->coefficient[1] = 0;
    }
}

/* Whether a slider without mass has been turned round where this begins: the guard that lets it go, no end of its
 * interval, is passed already, also if it comes back. */
static int is_turned(const pl_guards *m, int region, const pl_guard *g, const beyond *f)
{
    const real *gate = m->gate + (ptrdiff_t)g->row * m->size, *row = m->row + g->expression * m->size;
    real apart = 0;
    walk w;
    int i;
    if (g->impact >= 0 || !(f->coefficient[0] > f->noise) || !(f->coefficient[1] < 0)) {
        return 0;
    }
    w = switch_of(m, region, g->expression);
    if (w.interval > 0 && w.interval < w.breaks && !(w.at[w.interval] > w.at[w.interval - 1])) {
        return 0; /* it sticks: what lets it go is decided with others that rest */
    }
    for (i = 0; i < m->size; i++) {
        apart = larger(apart, magnitude(gate[i] - (g->upward ? row[i] : -row[i])));
    }
    return apart > 0;
}

/* coefficients: (degree + 1) x size, of x(s); after them 2 (degree + 1) + 4 size for work */
static event first_event(const pl_guards *m, int region, real *coefficients, int *splits)
{
    const int terms = m->degree + 1, n = m->size;
    real *e = coefficients + terms * n;
    event first = {1, -1};
    beyond f;
    int k;
    f.degree = m->degree;
    f.coefficient = e + terms;
    for (k = m->first[region]; k < m->first[region + 1]; k++) {
        const real *row = m->gate + (ptrdiff_t)m->guard[k].row * n, size = sizes(n, row, coefficients);
        real s, next;
        int has_left;
        pl_multiply(terms, n, coefficients, row, e);
        next = m->guard[k].impact >= 0 && e[1] < 0 ? sizes(n, row, coefficients + n) : -1;
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
        first.guard = k;
    }
    return first;
}

/* Moves x on over a piece of length dt, or to the first event in it; splits < 0: without looking for one. */
static event move(const pl_guards *m, pl_contact *c, const climb *at, real dt, const real *y, int *splits, real *x,
                  real *rest, real *work)
{
    const event none = {1, -1};
    event first = none;
    real *const low = work, *const coefficients = work + (WORDS - 1) * m->size;
    expand_piece(m->size, m->degree, matrix_of(m->A, m, c->matrix), dt, x, coefficients, low);
    if (pl_not_finite(coefficients, (m->degree + 1) * m->size)) {
        part_of_piece(m->size, m->degree, coefficients, low, 1, x, (real *)0);
        return none;
    }
    if (*splits >= 0 && m->matrix[c->region] >= 0) {
        first = first_event(m, c->region, coefficients, splits);
    }
    if (*splits < 0) {
        c->status |= PL_TOO_MANY_EVENTS;
        first = none;
    }
    if (y && first.guard < 0) {
        keep_piece(m->size, at, y, x, rest);
    } else {
        part_of_piece(m->size, m->degree, coefficients, low, first.s, x, at->rungs > 0 ? rest : (real *)0);
    }
    return first;
}

/* ---- a step ---- */

/* Whether what rests there is pressed, by more than rounding */
static int is_pressed(const pl_guards *m, int region, int expression, const real *x)
{
    int k, any = 0;
    for (k = m->first[region]; k < m->first[region + 1]; k++) {
        if (m->guard[k].expression == expression) {
            if (!(pull_of(m, k, x) < 0)) {
                return 0;
            }
            any = 1;
        }
    }
    return any;
}

/* The largest acceleration by which one of those that touch is pressed, and the most that rounding does to their
 * places: they lie on each other, and what that takes one by moves another one.  work: size */
static real most_pressed(const pl_guards *m, const pl_contact *c, const real *x, real *rounding, real *work)
{
    const int n = m->size;
    real most = 0, press, noise;
    int k;
    for (k = 0; k < m->impacts; k++) {
        if (touches(m, c, &m->impact[k], x)) {
            const walk w = switch_of(m, c->region, m->impact[k].expression);
            (void)excess(m, c, &w, m->impact[k].breakpoint, x, &noise);
            *rounding = larger(*rounding, noise);
        }
    }
    pl_multiply(n, n, matrix_of(m->A, m, c->matrix), x, work);
    for (k = 0; k < m->impacts; k++) {
        if (touches_by(m, c, &m->impact[k], x, *rounding)) {
            press = dot(n, m->speed + (ptrdiff_t)k * n, work);
            most = larger(most, press);
        }
    }
    return most;
}

/* Several contacts that are as good as at rest together, those of them that fly as bits: all that any of them could
 * still do is over within `brief` [s] under the force that presses one of them, or lower than rounding.  work: size */
static uint32_t near_rest(const pl_guards *m, const pl_contact *c, real brief, const real *x, real *work)
{
    real noise = 0;
    const real most = most_pressed(m, c, x, &noise, work), fastest = most * brief / 2;
    uint32_t set = 0;
    int k, together = 0;
    for (k = 0; k < m->impacts; k++) {
        const pl_impact *p = &m->impact[k];
        const walk w = switch_of(m, c->region, p->expression);
        real unused, e, speed;
        if (p->rest < 0 || (w.interval != free_of(p) && w.interval != p->rest)) {
            continue;
        }
        e = excess(m, c, &w, p->breakpoint, x, &unused);
        speed = magnitude(speed_of(m, k, x));
        if ((p->upward ? e : -e) < -larger(noise, fastest * brief)) {
            continue;
        }
        e = 1 - p->restitution;
        if (w.interval == p->rest) {
            together++;
        } else if (speed <= fastest * e || speed * speed <= 2 * most * noise * e * e) {
            set |= (uint32_t)1 << k;
            together++;
        }
    }
    return together > 1 ? set : 0;
}

/* Several that strike each other come to rest together if all of them are pressed then. */
static void rest_together(const pl_guards *m, uint32_t set, real *x, pl_contact *c, pl_crossing *crossing, real time,
                          real *work)
{
    pl_contact then = *c;
    const uint32_t laid = seat(m, set, &then);
    int k;
    for (k = 0; k < m->impacts; k++) {
        if (laid >> k & 1 && !is_pressed(m, then.region, m->impact[k].expression, x)) {
            return;
        }
    }
    list_rests(m, lay(m, laid, x, c, work), c, crossing, time);
    settle(m, c->region, x, c, crossing, time, work);
}

/* Behind impacts: which of them rest, after infinitely many more in no time to speak of */
static void come_to_rest(const pl_guards *m, uint32_t struck, real *x, pl_contact *c, pl_crossing *crossing, real time,
                         real *work)
{
    const real brief = (c->crossings > m->max_events - MOST ? SPAN : BRIEF) * m->h;
    uint32_t set;
    int k;
    for (k = 0; k < m->impacts; k++) {
        const pl_impact *p = &m->impact[k];
        const real e = p->restitution, along = struck >> k & 1 && e < 1 ? flight(m, c, k, x, work) : -1;
        const real left = along / (1 - e);
        if (!(left >= 0 && left <= brief) || !touches(m, c, p, x)) {
            continue;
        }
        list_rests(m, lay(m, (uint32_t)1 << k, x, c, work), c, crossing, time + left);
        settle(m, c->region, x, c, crossing, time, work);
    }
    set = near_rest(m, c, BRIEF * m->h, x, work);
    if (struck != 0 && set != 0) {
        rest_together(m, set, x, c, crossing, time, work);
    }
}

/* Into the region to which a guard leads, or by the impact that begins there */
static int pass(const pl_guards *m, pl_contact *c, const pl_guard *g, real *x, pl_crossing *crossing, real time,
                pl_chain *chain, real *work)
{
    const int rest = impact_of(m, g->expression, switch_of(m, c->region, g->expression).interval);
    const int before = c->region;
    uint32_t struck = 0;
    if (g->impact < 0) {
        chain->full = !has_time(chain) ||
                    !has_listed(m, rest >= 0 && m->impact[rest].restitution < 1, c, crossing, time, g->expression,
                                g->breakpoint, g->upward);
        c->status |= chain->full ? PL_TOO_MANY_EVENTS : 0;
    }
    if (g->impact < 0 || m->impact[g->impact].rest < 0) {
        enter(m->matrix, c, c->region + g->leads);
    }
    assign(m, m->hold[c->region], x, work);
    if (g->impact >= 0) {
        struck = collide(m, g->impact, x, c, crossing, time, chain, work);
        follow(m, 0, x, c, crossing, time);
    }
    settle(m, before, x, c, crossing, time, work);
    come_to_rest(m, struck, x, c, crossing, time, work);
    assign(m, m->hold[c->region], x, work);
    return !chain->full;
}

/* At the start, or behind a change of the loads: what holds may have moved, and what moves may have jumped. */
static void take_up(const pl_guards *m, int jumped, real *x, pl_contact *c, pl_crossing *crossing, real time,
                    pl_chain *chain, real *work)
{
    follow(m, jumped, x, c, crossing, time);
    (void)collide(m, -1, x, c, crossing, time, chain, work);
    settle(m, c->region, x, c, crossing, time, work);
    assign(m, m->hold[c->region], x, work);
}

/* Whether what is held is where it is held.  work: WORDS */
static int is_in_place(const pl_guards *m, const pl_contact *c, const real *x, real *work)
{
    const int n = m->size, set = m->hold[c->region];
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
    for (k = m->first[c->region]; k < m->first[c->region + 1]; k++) {
        if (!(pull_of(m, k, x) < 0)) {
            return 0;
        }
    }
    return 1;
}

void pl_guards_change(const pl_guards *m, real time, real *x, pl_contact *c, pl_crossing *crossing, real *work)
{
    pl_chain chain = no_impact(m->h);
    c->crossings = 0;
    take_up(m, 1, x, c, crossing, time, &chain, work);
}

/* What is beyond the guard of a bounce by more than rounding is told. */
static void check_places(const pl_guards *m, const real *x, pl_contact *c, real *work)
{
    const int n = m->size;
    int k;
    for (k = 0; k < m->impacts; k++) {
        const pl_impact *p = &m->impact[k];
        const real *speed = m->speed + (ptrdiff_t)k * n;
        const walk w = switch_of(m, c->region, p->expression);
        real noise, e;
        if (p->rest < 0 || (w.interval != p->rest && w.interval != free_of(p))) {
            continue;
        }
        e = excess(m, c, &w, p->breakpoint, x, &noise);
        e = p->upward ? e : -e;
        if (!(e > DEEP * noise)) {
            continue;
        }
        pl_multiply(n, n, matrix_of(m->A, m, c->matrix), x, work);
        if (e > DEEP * (noise + m->h * noise_of(sizes(n, speed, x) + m->h * sizes(n, speed, work)))) {
            c->status |= PL_PENETRATED;
        }
    }
}

void pl_guards_advance(const pl_guards *m, real tau, real *x, pl_contact *c, pl_crossing *crossing, real *work)
{
    const int n = m->size;
    real left = tau, *y = work, *bend = y + WORDS * n, *rest = bend + n, *room = rest + 2 * n;
    int splits = m->max_splits, fresh = 1, clear = 1;
    climb at = at_top;
    pl_chain chain = no_impact(m->h);
    c->crossings = 0;
    if (m->hold[c->region] >= 0) {
        if (!is_taken_up(m, c, x, room)) {
            take_up(m, 0, x, c, crossing, 0, &chain, room);
        }
        fresh = 0;
    }
    while (left > REST * m->h) { /* nothing for what rounding leaves */
        const real longest = stand(&at, &m->ladder, m->halvings, c->matrix, m->h, left, n, rest);
        int whole = left > longest * (1 - REST);
        const real dt = shortened(m, c, x, whole ? longest : left, room);
        event first;
        whole = whole && dt >= longest;
        if (whole) {
            take_piece(n, &at, &m->ladder, m->Phi, c->matrix, x, y, rest);
            assign(m, m->hold[c->region], y, room);
            if (m->matrix[c->region] >= 0 && (at.rung > 0 ? stays_clear_far(m, c, &at, x, y, bend, room)
                                                          : stays_clear(m, c, x, y, room))) {
                keep_piece(n, &at, y, x, rest);
                left -= dt;
                fresh = 0;
                rise(&at);
                continue;
            }
        }
        if (fall(&at)) {
            continue;
        }
        clear = 0;
        if (fresh) { /* the region may be another one now */
            fresh = 0;
            take_up(m, 0, x, c, crossing, tau - left, &chain, room);
            at.bent = 0;
            continue;
        }
        first = move(m, c, &at, dt, whole ? y : (real *)0, &splits, x, rest, room);
        assign(m, m->hold[c->region], x, room);
        at.bent = 0;
        if (splits < 0 || is_lost(&at, n, x)) {
            break; /* x is held: this region may not be the one, and may be unstable */
        }
        left -= first.s * dt;
        if (first.guard < 0) {
            rise(&at);
            continue;
        }
        to_the_ground(&at);
        if (!pass(m, c, &m->guard[first.guard], x, crossing, tau - left, &chain, room)) {
            if (m->guard[first.guard].impact >= 0) {
                break; /* x is held on the guard: beyond it the impact would not come any more */
            }
            splits = -1; /* no further search */
        }
    }
    if (!clear) {
        check_places(m, x, c, room);
    }
}

#ifndef REST_IS_KEPT
#ifndef REAL_IS_FLOAT

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

#define PL(name) unmet_##name
#define PL_SIZE m->size
#define PL_SUM(row, x) sum_of(m->size, row, x)
#define PL_EACH
#include "unmet.h"

void pl_guards_step(const pl_guards *m, double tau, double *x, pl_contact *c, pl_crossing *crossing, double *work)
{
    double *const size = work + m->size;
    int i;
    if (tau < m->h || !unmet_keeps_all(m, c->region, x, work, size, size + m->size)) {
        pl_guards_advance(m, tau, x, c, crossing, work);
        return;
    }
    for (i = 0; i < m->size; i++) {
        x[i] = work[i];
    }
    c->crossings = 0;
}

#endif
#endif
