/* SPDX-License-Identifier: MIT-0 */
/* regions.h: regions as intervals of expressions between breakpoints, for the runtime's own use: by crossings.c and
 * guards.c. */
#ifndef PLRT_REGIONS_H
#define PLRT_REGIONS_H

#include "real.h"

/* One switch after the other, and where a region has it:
 *     for (w = first_switch(at); arrive(switches, breaks, region, &w); leave(&w)) */
typedef struct walk {
    int i, breaks, interval;
    int stride;     /* between the numbers of regions one interval of this switch apart */
    const real *at; /* its breakpoints */
} walk;

static walk first_switch(const real *at)
{
    walk w;
    w.i = w.breaks = w.interval = 0;
    w.stride = 1;
    w.at = at;
    return w;
}

static int arrive(int switches, const int *breaks, int region, walk *w)
{
    if (w->i == switches)
        return 0;
    w->breaks = breaks[w->i];
    w->interval = region / w->stride % (w->breaks + 1);
    return 1;
}

static void leave(walk *w)
{
    w->stride *= w->breaks + 1;
    w->at += w->breaks;
    w->i++;
}

/* matrix: of each region; -1: it cannot be, and the one before stays in use */
static void enter(const int *matrix, pl_contact *c, int region)
{
    c->region = region;
    if (matrix[region] >= 0)
        c->matrix = matrix[region];
}

/* Lists a crossing, or says that there is no more room. */
static int list(int max_events, pl_contact *c, pl_crossing *crossing, real time, int expression, int breakpoint,
                int upward)
{
    if (c->crossings == max_events) {
        c->status |= PL_TOO_MANY_EVENTS;
        return 0;
    }
    crossing += c->crossings++;
    crossing->time = time;
    crossing->expression = expression;
    crossing->breakpoint = breakpoint;
    crossing->upward = upward;
    c->total++;
    return 1;
}

#endif
