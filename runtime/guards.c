/* SPDX-License-Identifier: MIT-0 */
/* Steps of piecewise-linear models with dry friction and jumps, from event to event.  Pieces that stay clear of every
 * guard of their region go by e^{A d}; others, short ones, by Taylor polynomials, on which the first event is isolated.
 * What is to stick and what is to slip after an event is found by looking at all combinations of those that are at
 * rest. */
#include "chain.h"
#include "ladder.h"
#include "regions.h"
#include "roots.h"

/* How many at rest are looked at together: 3^MOST combinations */
enum { MOST = 6 };

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

/* ---- what sticks and what slips ---- */

typedef struct resting { /* an expression on a breakpoint that stands twice */
    int expression, stick, stride; /* stick: the interval between */
    int impact;                    /* that rests there; -1: it is friction */
} resting;

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

/* Those at rest in the region, or slipping next to it */
static int find_resting(const pl_guards *m, const pl_contact *c, const real *x, resting *found)
{
    int count = 0, k;
    real noise = 0;
    walk w;
    for (w = first_switch(m->at); arrive(m->switches, m->breaks, c->region, &w); leave(&w)) {
        for (k = 1; k < w.breaks; k++) {
            const real e = w.at[k] - w.at[k - 1] <= 0 ? excess(m, c, &w, k, x, &noise) : 1;
            if (w.at[k] - w.at[k - 1] > 0 || w.interval < k - 1 || w.interval > k + 1 || count == MOST) {
                continue;
            }
            found[count].impact = impact_of(m, w.i, k);
            if (found[count].impact < 0 ? magnitude(e) > noise : !touches(m, c, &m->impact[found[count].impact], x)) {
                continue;
            }
            if (found[count].impact >= 0 && magnitude(speed_of(m, found[count].impact, x)) > 0 && w.interval != k) {
                continue; /* it flies off, or there was no room for its impact */
            }
            found[count].expression = w.i;
            found[count].stick = k;
            found[count++].stride = w.stride;
        }
    }
    return count;
}

static int interval_of(const pl_guards *m, const resting *r, int region)
{
    return region / r->stride % (m->breaks[r->expression] + 1);
}

/* The force of a guard of what sticks, less its limit: above 0 where it lets go, 0 where that is but rounding */
static real pull_of(const pl_guards *m, int k, const real *x)
{
    const int n = m->size, gate = m->guard[k].row;
    const real *row = m->gate + (ptrdiff_t)gate * n, *tangent = m->gate_tangent + (ptrdiff_t)gate * n;
    real e, noise;
    e = dot(n, row, x);
    e -= m->limit[k];
    noise = noise_of(sizes(n, row, x) + 3 * sizes(n, tangent, x) + magnitude(m->limit[k]) + m->gate_play[gate]);
    return e > noise || e < -noise ? e : 0;
}

static int rises(const pl_guards *m, int region, int k, const real *x, real *work)
{
    const int n = m->size;
    return heading(n, matrix_of(m->A, m, m->matrix[region]), m->gate + (ptrdiff_t)m->guard[k].row * n, x, work) > 0;
}

/* Whether a guard of what sticks lets it */
static int is_held(const pl_guards *m, int region, int expression, const real *x, real *work)
{
    int k;
    for (k = m->first[region]; k < m->first[region + 1]; k++) {
        const real pull = m->guard[k].expression == expression ? pull_of(m, k, x) : -1;
        if (pull > 0 || (pull >= 0 && rises(m, region, k, x, work))) {
            return 0;
        }
    }
    return 1;
}

/* Whether what would stick is let go to this side at this instant, by a force that is at its limit but for rounding:
 * e'' is then rounding, too, and does not say where e is heading. */
static int is_let_go(const pl_guards *m, int region, const resting *r, int side, const real *x, real *work)
{
    const int stuck = region - side * r->stride;
    int k;
    if (m->matrix[stuck] < 0) {
        return 0;
    }
    for (k = m->first[stuck]; k < m->first[stuck + 1]; k++) {
        if (m->guard[k].expression == r->expression && m->guard[k].leads * side > 0 && !(pull_of(m, k, x) > 0) &&
            !(pull_of(m, k, x) < 0) && rises(m, stuck, k, x, work)) {
            return 1;
        }
    }
    return 0;
}

/* Whether others hold it already where it neither sticks nor rests, for no region holds it twice: friction slips there
 * as it would but for the contacts at rest. */
static int is_spared(const pl_guards *m, int region, const resting *r, int count, const resting *of, int side,
                     const real *x, real *work)
{
    int flying = region, i;
    if (m->matrix[region - side * of->stride] >= 0 || of->impact >= 0) {
        return m->matrix[region - side * of->stride] < 0;
    }
    for (i = 0; i < count; i++) {
        if (r[i].impact >= 0 && interval_of(m, &r[i], region) == r[i].stick) {
            flying += (free_of(&m->impact[r[i].impact]) - r[i].stick) * r[i].stride;
        }
    }
    return m->matrix[flying] >= 0 && heading(m->size, matrix_of(m->A, m, m->matrix[flying]),
                                             m->row + of->expression * m->size, x, work) == side;
}

/* Whether all of them agree with a region: what sticks is held, what slips moves away as it does there */
static int agrees(const pl_guards *m, int region, const resting *r, int count, const real *x, real *work)
{
    const int n = m->size;
    int i;
    if (m->matrix[region] < 0) {
        return 0;
    }
    for (i = 0; i < count; i++) {
        const int side = interval_of(m, &r[i], region) - r[i].stick;
        const real *row = m->row + r[i].expression * n;
        if (r[i].impact >= 0 && side == 0 && speed_of(m, r[i].impact, x) < 0) {
            return 0;
        }
        if (r[i].impact >= 0 && side == (m->impact[r[i].impact].upward ? 1 : -1)) {
            return 0;
        }
        if (side == 0 && !is_held(m, region, r[i].expression, x, work)) {
            return 0;
        }
        if (side != 0) {
            const int way = heading(n, matrix_of(m->A, m, m->matrix[region]), row, x, work);
            if (way != side && !(way == 0 && is_spared(m, region, r, count, &r[i], side, x, work)) &&
                !is_let_go(m, region, &r[i], side, x, work)) {
                return 0;
            }
        }
    }
    return 1;
}

static int combinations(int count)
{
    int all = 1;
    while (count-- > 0) {
        all *= 3;
    }
    return all;
}

/* The region in which all agree, with fewest changes, then most that stick; -1: there is none.  Changes count from the
 * region before the instant: what turns round changes once. */
static int best_region(const pl_guards *m, const pl_contact *c, int before, const resting *r, int count, const real *x,
                       real *work)
{
    int best = -1, least = 0, code;
    for (code = 0; code < combinations(count); code++) {
        int region = c->region, score = 0, rest = code, i;
        for (i = 0; i < count; i++, rest /= 3) {
            const int now = interval_of(m, &r[i], region), then = r[i].stick + rest % 3 - 1;
            region += (then - now) * r[i].stride;
            score += (then != interval_of(m, &r[i], before)) * 2 * MOST + (rest % 3 != 1);
        }
        if ((best < 0 || score < least) && agrees(m, region, r, count, x, work)) {
            best = region;
            least = score;
        }
    }
    return best;
}

/* Lists what changes from the region to another one, and goes there. */
static void change(const pl_guards *m, pl_contact *c, pl_crossing *crossing, real time, const resting *r, int count,
                   int region)
{
    int i, k;
    for (i = 0; i < count && crossing; i++) {
        const int now = interval_of(m, &r[i], c->region), then = interval_of(m, &r[i], region);
        for (k = now; k < then; k++) {
            tell(m->max_events, c, crossing, time, r[i].expression, k, 1);
        }
        for (k = now; k > then; k--) {
            tell(m->max_events, c, crossing, time, r[i].expression, k - 1, 0);
        }
    }
    enter(m->matrix, c, region);
}

/* What is at rest: whether it sticks, and where else it goes.  crossing NULL: nothing is listed. */
static void settle(const pl_guards *m, int before, const real *x, pl_contact *c, pl_crossing *crossing, real time,
                   real *work)
{
    resting r[MOST];
    const int count = find_resting(m, c, x, r);
    int region;
    if (count == 0 || agrees(m, c->region, r, count, x, work)) {
        return;
    }
    region = best_region(m, c, before, r, count, x, work);
    if (region < 0) {
        c->status |= PL_UNDECIDED;
    } else {
        change(m, c, crossing, time, r, count, region);
    }
}

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
