/* SPDX-License-Identifier: MIT-0 */
/* sticking.h: what sticks and what slips where several are at rest, by all their combinations; for the runtime's own
 * use: by guards.c. */
#ifndef PLRT_STICKING_H
#define PLRT_STICKING_H

#include "impacts.h"

/* How many at rest are looked at together: 3^MOST combinations */
enum { MOST = 6 };

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

#endif
