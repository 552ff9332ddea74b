/* SPDX-License-Identifier: MIT-0 */
/* Impacts, contacts at rest and dry friction beside a Taylor series: from event to event, each found on the series of
 * the region before it.  What holds, what slips and what flies behind an event is found by looking at all combinations
 * of those that are at rest; the series of a combination says whether it can be. */
#include "strikes.h"

/* How many at rest are looked at together: 3^MOST combinations */
enum { MOST = 4 };

/* ---- events at the start, and in a piece ---- */

static void set_event(const pl_events *m, pl_instant *at, int expression, int breakpoint, int upward)
{
    at->next.expression = expression;
    at->next.breakpoint = breakpoint;
    at->next.upward = upward;
    at->strike = strike_at(m, expression, breakpoint, upward);
    at->freed = -1;
}

static void set_freed(const pl_events *m, pl_instant *at, int hold, int up)
{
    at->next.expression = m->hold[hold].expression;
    at->next.breakpoint = m->hold[hold].interval - !up;
    at->next.upward = up;
    at->strike = -1;
    at->freed = hold;
}

/* An expression outside of its interval, or what is held beyond what can */
static int has_left(const pl_events *m, pl_instant *at)
{
    const pl_divided *d = m->divided;
    const real *b = d->at;
    int i, up;
    for (i = 0; i < d->expressions; b += d->breaks[i++]) {
        const column e = column_of(d, at->c, at->terms, i);
        const int hold = hold_of(m, i, at->interval[i]);
        for (up = 0; up < 2; up++) {
            const int k = at->interval[i] - !up;
            real off, noise;
            if (hold >= 0 && (up ? m->hold[hold].up : m->hold[hold].down) >= 0) {
                const column w = watched(m, at, up ? m->hold[hold].up : m->hold[hold].down);
                if (certain(&w) > 0) {
                    set_freed(m, at, hold, up);
                    return 1;
                }
            }
            if (hold >= 0 || k < 0 || k == d->breaks[i] || (at->last->expression == i && at->last->breakpoint == k)) {
                continue;
            }
            off = off_start(&e, b[k], &noise);
            if ((up ? off : -off) > noise) {
                set_event(m, at, i, k, up);
                return 1;
            }
        }
    }
    return 0;
}

/* The sizes of what the first two derivatives of a guard are summed from, over a piece */
static real terms_behind(const pl_events *m, const pl_instant *at, const pl_strike *p, real end)
{
    const pl_hold *h = &m->hold[p->hold];
    const column speed = watched(m, at, p->speed), pull = watched(m, at, p->upward ? h->down : h->up);
    return m->h * end * (speed.terms + m->h * end * pull.terms);
}

/* What has just been let go at this breakpoint may be driven back by what the time of that is off: no sticking if it
 * turns by itself within a part of h, no impact of a speed that is but rounding */
static void pass_brief(beyond *f, real behind, real end)
{
    const int turns = f->coefficient[2] < 0 && f->coefficient[1] * end <= -NEAR * f->coefficient[2];
    if (f->coefficient[0] <= f->noise && f->coefficient[1] > 0 &&
        (turns || (behind >= 0 && f->coefficient[1] <= noise_of(behind)))) {
        f->coefficient[1] = 0;
    }
}

/* Where a column first rises beyond b, or with sign -1 falls below it, before *first; last: that was the last event;
 * behind: where it has just left it the sizes of what its first two derivatives are summed from; else below 0 */
static int look(const column *e, real b, int sign, int last, real behind, real end, real *first, int *splits,
                real *work)
{
    beyond f;
    real s;
    int rises;
    f.degree = e->m->degree < 3 ? 3 : e->m->degree;
    f.coefficient = work + f.degree + 1;
    rescale(e, end, work);
    if (behind >= 0 && (real)sign * work[1] < 0 &&
        magnitude(work[0] - b) <= noise_of(e->terms + magnitude(b) + behind)) {
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
        pass_brief(&f, behind, end);
    }
    s = first_root(&f, *first, splits);
    if (s < 0) {
        return 0;
    }
    *first = s;
    return 1;
}

/* How long it flies that leaves the guard of this impact, in the unit of time of c; -1: for good */
static real flight(const pl_events *m, const pl_instant *at, const pl_strike *p)
{
    column w;
    real speed, press;
    if (p->hold < 0) {
        return -1;
    }
    w = watched(m, at, p->speed);
    speed = certain(&w);
    press = column_at(&w, 1);
    return speed <= 0 && press > 0 ? -2 * speed / press : -1;
}

static real first_event(const pl_events *m, pl_instant *at, real end, int *splits)
{
    const pl_divided *d = m->divided;
    const real *b = d->at;
    real first = 1;
    int i, up, any = 0;
    for (i = 0; i < d->expressions && *splits >= 0; b += d->breaks[i++]) {
        const column e = column_of(d, at->c, at->terms, i);
        const int hold = hold_of(m, i, at->interval[i]);
        for (up = 0; up < 2; up++) {
            const int k = at->interval[i] - !up;
            const int watch = hold < 0 ? -1 : up ? m->hold[hold].up : m->hold[hold].down;
            int strike, last;
            real behind;
            if (watch >= 0) {
                const column w = watched(m, at, watch);
                if (look(&w, 0, 1, 0, -1, end, &first, splits, at->work)) {
                    any = 1;
                    set_freed(m, at, hold, up);
                }
            }
            if (hold >= 0 || k < 0 || k == d->breaks[i]) {
                continue;
            }
            strike = strike_at(m, i, k, up);
            behind = strike >= 0 && m->strike[strike].hold >= 0
                         ? m->strike[strike].per * terms_behind(m, at, &m->strike[strike], end)
                         : -1;
            last = at->last->expression == i && at->last->breakpoint == k;
            if (look(&e, b[k], up ? 1 : -1, last, behind, end, &first, splits, at->work)) {
                any = 1;
                set_event(m, at, i, k, up);
            }
        }
    }
    return any ? first * end : -1;
}

real pl_events_next(const pl_events *m, pl_instant *at, real *size, int *splits)
{
    int k;
    for (k = 0; k < m->strikes; k++) {
        const pl_strike *p = &m->strike[k];
        const real along = p->hold >= 0 && touches(m, at, p) ? flight(m, at, p) : -1;
        if (along > 0 && at->interval[p->expression] == free_of(m, p)) {
            *size = smaller(*size, 2 * along);
        }
    }
    return first_event(m, at, *size, splits);
}

/* ---- what is held, and what is not ---- */

/* Those at rest: held, or next to where they would be and with no velocity */
static int find_resting(const pl_events *m, const pl_instant *at, int *resting)
{
    int count = 0, i;
    for (i = 0; i < m->holds && count < MOST; i++) {
        const pl_hold *h = &m->hold[i];
        const int side = at->interval[h->expression] - h->interval;
        if (side < -1 || side > 1) {
            continue;
        }
        if (side != 0 && i != at->freed && !is_near(m, at, h->velocity)) {
            continue;
        }
        if (side != 0 && i != at->freed && h->strike >= 0 && !touches(m, at, &m->strike[h->strike])) {
            continue;
        }
        resting[count++] = i;
    }
    return count;
}

/* Where friction slips of what a contact holds, by bits of all that is held: 1 or -1; 0: it is free to move */
static int side_beside(const pl_events *m, uint32_t held, int hold)
{
    int i;
    for (i = 0; i < m->conflicts; i++) {
        if (m->conflict[i].hold == hold && ((held | (uint32_t)1 << hold) & m->conflict[i].set) == m->conflict[i].set) {
            return m->conflict[i].side;
        }
    }
    return 0;
}

/* Whether the intervals agree with what they make of the motion: what is held is not let go, what is not is: 2; 1: it
 * hangs in the balance.  Leaves the series of them. */
static int agrees(const pl_events *m, pl_instant *at, const int *resting, int count)
{
    uint32_t held = 0;
    int i, agreed = 2;
    for (i = 0; i < m->holds; i++) {
        held |= (uint32_t)holds_now(m, at, i) << i;
    }
    for (i = 0; i < m->conflicts; i++) {
        if ((held & m->conflict[i].set) == m->conflict[i].set) {
            return 0;
        }
    }
    refresh(at);
    for (i = 0; i < count; i++) {
        const pl_hold *h = &m->hold[resting[i]];
        const int side = at->interval[h->expression] - h->interval;
        const int beside = side_beside(m, held, resting[i]);
        if (beside != 0) {
            if (side != beside) {
                return 0;
            }
            continue;
        }
        /* Another impact has parted it; without one, a speed is what rounding has left. */
        if (at->strike >= 0 && h->strike >= 0 && speed_of(m, at, &m->strike[h->strike]) < 0) {
            if (at->interval[h->expression] != free_of(m, &m->strike[h->strike])) {
                return 0;
            }
            continue;
        }
        if (side == 0 && (lets_go(m, at, resting[i], 0) > 0 || lets_go(m, at, resting[i], 1) > 0)) {
            return 0;
        }
        if (side != 0 && (side > 0 ? h->up : h->down) < 0) {
            return 0;
        }
        if (side != 0 && lets_go(m, at, resting[i], side > 0) < 0) {
            return 0;
        }
        if (side != 0 && lets_go(m, at, resting[i], side > 0) == 0) {
            agreed = 1;
        }
    }
    return agreed;
}

/* Those at rest in the combination of this number, three ways each; returns how many are elsewhere than before */
static int set_combination(const pl_events *m, const pl_instant *at, const int *resting, const int *before, int count,
                           int number)
{
    int i, moved = 0;
    for (i = 0; i < count; i++, number /= 3) {
        const pl_hold *h = &m->hold[resting[i]];
        at->interval[h->expression] = h->interval + number % 3 - 1;
        moved += at->interval[h->expression] != before[i];
    }
    return moved;
}

static int slipping(const pl_events *m, const pl_instant *at, const int *resting, int count)
{
    int i, slips = 0;
    for (i = 0; i < count; i++) {
        slips += !holds_now(m, at, resting[i]);
    }
    return slips;
}

/* Lists what changes from these intervals to those that it has now. */
static void list_changes(const pl_events *m, pl_instant *at, const int *resting, const int *now, int count)
{
    int i, k;
    for (i = 0; i < count; i++) {
        const int expression = m->hold[resting[i]].expression, then = at->interval[expression];
        for (k = now[i]; k < then; k++) {
            (void)list(m, at, at->time, expression, k, 1);
        }
        for (k = now[i]; k > then; k--) {
            (void)list(m, at, at->time, expression, k - 1, 0);
        }
    }
}

/* What is at rest: the combination in which all agree, with fewest changes, then most that is held.  Changes count from
 * where things were before the instant, as the expression `crossed` was (-1: none was elsewhere): what turns round
 * changes once. */
static void settle(const pl_events *m, pl_instant *at, int listed, int crossed, int was)
{
    int resting[MOST], now[MOST], before[MOST], best = -1, least = 0, all = 1, number, i;
    const int count = find_resting(m, at, resting);
    for (i = 0; i < count; i++) {
        const int expression = m->hold[resting[i]].expression;
        now[i] = at->interval[expression];
        before[i] = expression == crossed ? was : now[i];
        all *= 3;
    }
    if (count == 0 || agrees(m, at, resting, count) == 2) {
        return;
    }
    for (number = 0; number < all; number++) {
        const int moved = set_combination(m, at, resting, before, count, number);
        const int score = moved * 2 * MOST + slipping(m, at, resting, count);
        const int agreed = agrees(m, at, resting, count), worth = score + (agreed == 1 ? 8 * MOST * MOST : 0);
        if (agreed == 0 || (best >= 0 && worth >= least)) {
            continue;
        }
        best = number;
        least = worth;
    }
    if (best < 0) {
        for (i = 0; i < count; i++) {
            at->interval[m->hold[resting[i]].expression] = now[i];
        }
        at->status |= PL_UNDECIDED;
    } else {
        (void)set_combination(m, at, resting, before, count, best);
        if (listed) {
            list_changes(m, at, resting, now, count);
        }
    }
    refresh(at);
}

/* Several contacts that are as good as at rest together, those of them that fly as bits: all that any of them could
 * still do is over within BRIEF of h under the force that presses one of them, or lower than rounding. */
static uint32_t near_rest(const pl_events *m, const pl_instant *at)
{
    uint32_t set = 0;
    real most = 0, rounding = 0, noise, fastest;
    int k, together = 0;
    for (k = 0; k < m->strikes; k++) {
        if (touches(m, at, &m->strike[k])) {
            const column place = watched(m, at, m->strike[k].place);
            (void)off_start(&place, 0, &noise);
            rounding = larger(rounding, noise);
        }
    }
    for (k = 0; k < m->strikes; k++) { /* what rounding takes one by moves those that it lies on */
        if (touches_by(m, at, &m->strike[k], rounding)) {
            const column speed = watched(m, at, m->strike[k].speed);
            most = larger(most, column_at(&speed, 1));
        }
    }
    fastest = most * BRIEF / 2;
    for (k = 0; k < m->strikes; k++) {
        const pl_strike *p = &m->strike[k];
        const real e = 1 - p->restitution;
        real speed;
        if (p->hold < 0 || (!holds_now(m, at, p->hold) && at->interval[p->expression] != free_of(m, p)) ||
            value_of(m, at, p->place) < -larger(rounding, fastest * BRIEF * m->h)) {
            continue;
        }
        speed = magnitude(speed_of(m, at, p));
        if (holds_now(m, at, p->hold)) {
            together++;
        } else if (speed <= fastest * e || m->h * speed * speed <= 2 * most * rounding * e * e) {
            set |= (uint32_t)1 << k;
            together++;
        }
    }
    return together > 1 ? set : 0;
}

/* Whether what rests there is pressed, by more than rounding */
static int is_pressed(const pl_events *m, const pl_instant *at, int hold)
{
    int up, any = 0;
    for (up = 0; up < 2; up++) {
        const int watch = up ? m->hold[hold].up : m->hold[hold].down;
        if (watch >= 0) {
            const column w = watched(m, at, watch);
            if (!(certain(&w) < 0)) {
                return 0;
            }
            any = 1;
        }
    }
    return any;
}

/* Several that strike each other come to rest together if all of them are pressed then. */
static void rest_together(const pl_events *m, uint32_t struck, pl_instant *at)
{
    const uint32_t set = struck != 0 ? near_rest(m, at) : 0, laid = set != 0 ? seat(m, set, at) : 0;
    int k, pressed = 1;
    for (k = 0; k < m->strikes; k++) {
        pressed = pressed && (!(laid >> k & 1) || is_pressed(m, at, m->strike[k].hold));
    }
    for (k = 0; k < m->strikes; k++) {
        if (laid >> k & 1) {
            at->interval[m->strike[k].expression] = free_of(m, &m->strike[k]);
        }
    }
    if (laid != 0) {
        refresh(at);
    }
    if (laid != 0 && pressed) {
        tell_rests(m, lay(m, laid, at), at);
        settle(m, at, 1, -1, 0);
    }
}

/* Behind impacts: which of them rest, after infinitely many more in no time to speak of */
static void come_to_rest(const pl_events *m, uint32_t struck, pl_instant *at)
{
    int k;
    for (k = 0; k < m->strikes; k++) {
        const pl_strike *p = &m->strike[k];
        const real e = p->restitution, along = struck >> k & 1 && e < 1 ? flight(m, at, p) : -1;
        const real left = along / (1 - e);
        const int full = *at->crossings > m->max_events - 2 * MOST;
        if (!(left >= 0 && left <= (full ? SPAN : BRIEF)) || !touches(m, at, p) || holds_now(m, at, p->hold)) {
            continue;
        }
        if (lay(m, (uint32_t)1 << k, at) != 0) {
            (void)list(m, at, at->time + left * m->h, p->expression, p->breakpoint, p->upward);
            (*at->rested)++;
        }
        settle(m, at, 1, -1, 0);
    }
    rest_together(m, struck, at);
}

/* ---- one event ---- */

int pl_events_pass(const pl_events *m, pl_instant *at)
{
    const pl_crossing e = at->next;
    const int begins = at->strike, loses = begins >= 0 && m->strike[begins].restitution < 1;
    const int full = *at->crossings == m->max_events && !loses;
    int *interval = &at->interval[e.expression];
    const int was = *interval;
    uint32_t struck = 0;
    if (full) {
        return 0;
    }
    if (begins < 0) {
        (void)list(m, at, at->time, e.expression, e.breakpoint, e.upward);
    }
    if (begins < 0 || m->strike[begins].hold < 0) {
        const int hold = hold_of(m, e.expression, *interval + (e.upward ? 1 : -1));
        const int past = hold >= 0 && m->hold[hold].strike >= 0 && begins < 0 ? 2 : 1;
        *interval += e.upward ? past : -past; /* past a contact at rest, which impacts alone lead to */
    }
    *at->last = e;
    refresh(at);
    if (hold_of(m, e.expression, *interval) >= 0) {
        put_back(m, at, hold_of(m, e.expression, *interval));
    }
    if (begins >= 0) {
        struck = collide(m, begins, at);
        follow(m, at, 0);
    }
    settle(m, at, 1, begins < 0 ? e.expression : -1, was);
    at->freed = -1;
    come_to_rest(m, struck, at);
    keep(m, at);
    return !at->chain.full;
}

int pl_events_begin(const pl_events *m, pl_instant *at)
{
    refresh(at);
    at->freed = -1;
    keep(m, at);
    if (!has_left(m, at)) {
        return 0;
    }
    return pl_events_pass(m, at) ? 1 : -1;
}

real pl_events_end(const pl_events *m, pl_instant *at, real end, int *splits)
{
    real next;
    int i;
    at->freed = -1;
    for (i = 0; i < m->holds; i++) {
        if (holds_now(m, at, i) && is_slack(m, at, i)) {
            return 0;
        }
    }
    if (has_left(m, at)) {
        return 0;
    }
    next = first_event(m, at, end, splits);
    return *splits < 0 ? 0 : next >= 0 ? next : end;
}

static real breakpoint_of(const pl_events *m, const pl_strike *p)
{
    const real *b = m->divided->at;
    int i;
    for (i = 0; i < p->expression; i++) {
        b += m->divided->breaks[i];
    }
    return b[p->breakpoint];
}

/* Whether an expression is beyond the guard of this bounce, s on, by more than rounding */
static int is_beyond(const pl_events *m, const pl_instant *at, const pl_strike *p, real s)
{
    const column e = column_of(m->divided, at->c, at->terms, p->expression);
    const real b = breakpoint_of(m, p);
    real value = 0, terms = 0;
    int k;
    for (k = m->divided->degree; k >= 0; k--) {
        value = value * s + column_at(&e, k);
        terms = terms * s + magnitude(column_at(&e, k));
    }
    terms += e.terms + magnitude(b) + p->per * terms_behind(m, at, p, s);
    return (p->upward ? value - b : b - value) > DEEP * noise_of(terms) + TINY;
}

int pl_events_places(const pl_events *m, const pl_instant *at, real s)
{
    int k, status = 0;
    for (k = 0; k < m->strikes; k++) {
        const pl_strike *p = &m->strike[k];
        const int near = p->hold >= 0 && (holds_now(m, at, p->hold) || at->interval[p->expression] == free_of(m, p));
        status |= near && is_beyond(m, at, p, s) ? PL_PENETRATED : 0;
    }
    return status;
}

/* ---- the start ---- */

static int starting_interval(const pl_events *m, const pl_instant *at, int expression, const real *b)
{
    const pl_divided *d = m->divided;
    const column e = column_of(d, at->c, at->terms, expression);
    int above = 0, k;
    for (k = 0; k < d->breaks[expression]; k++) {
        const int hold = hold_of(m, expression, k + 1);
        real noise;
        above += starts_above(&e, b[k]);
        if (hold < 0 || magnitude(off_start(&e, b[k], &noise)) > noise) {
            continue;
        }
        if (m->hold[hold].strike < 0 || !(speed_of(m, at, &m->strike[m->hold[hold].strike]) < 0 ||
                                          speed_of(m, at, &m->strike[m->hold[hold].strike]) > 0)) {
            return k + 1;
        }
        return free_of(m, &m->strike[m->hold[hold].strike]);
    }
    return above;
}

void pl_events_place(const pl_events *m, pl_instant *at)
{
    const pl_divided *d = m->divided;
    int again = 1, rounds, i;
    for (i = 0; i < d->expressions; i++) {
        at->interval[i] = 0;
        again += d->breaks[i] + 1;
    }
    at->last->expression = -1;
    at->freed = -1;
    for (rounds = 0; rounds < again; rounds++) {
        const real *b = d->at;
        int changed = 0;
        refresh(at);
        for (i = 0; i < d->expressions; b += d->breaks[i++]) {
            const int interval = starting_interval(m, at, i, b);
            changed |= interval != at->interval[i];
            at->interval[i] = interval;
        }
        if (!changed) {
            break;
        }
    }
    refresh(at);
    settle(m, at, 0, -1, 0);
}
