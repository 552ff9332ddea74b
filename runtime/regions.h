/* SPDX-License-Identifier: MIT-0 */
/* regions.h: regions as intervals of switching functions between breakpoints, and a state in one of them, for the
 * runtime's own use: part of crossings.c and guards.c, which say first what `searched` is, their tables, and
 * AMPLITUDE(m, i), the size of what is never above 1 in switching function i.  With derivatives beside x, VARIED has
 * what is done to them: it is empty without.  It has no guard, for it is a part of
 * these. */
#include "compensated.h"

#ifdef WITH_DERIVATIVES
#define VARIED(hook) hook
#define AND_VARIATION , pl_variation *variation
#define SET_VARIATION(at) (at).v = variation
#else
#define VARIED(hook)
#define AND_VARIATION
#define SET_VARIATION(at) ((void)0)
#endif

typedef struct instant {
    real *x;
    pl_contact *c;
    pl_crossing *crossing; /* NULL: nothing is listed */
    real *work;            /* size, or as much as assignments of one set */
    /* Of contacts: */
    real time;             /* after the start of the step [s] */
    int before;            /* the region before what happens now */
    pl_chain chain;
    VARIED(pl_variation *v;) /* NULL: no derivatives are asked for */
} instant;

static const real *matrix_of(const real *all, const searched *m, int matrix)
{
    return all + WORDS * (ptrdiff_t)matrix * m->size * m->size;
}

static const real *matrix_now(const searched *m, const instant *at)
{
    return matrix_of(m->A, m, at->c->matrix);
}

#ifdef WITH_DERIVATIVES
#include "variational.h"
#endif

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
    if (w->i == switches) {
        return 0;
    }
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
    if (matrix[region] >= 0) {
        c->matrix = matrix[region];
    }
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

/* e - b of a switching function, and what rounding may have done to it.  A tangent is a third of a piece's e'. */
static real excess(const searched *m, const pl_contact *c, int expression, real b, const real *x, real *noise)
{
    const real *row = m->row + expression * m->size;
    const real *tangent = m->tangent + ((ptrdiff_t)c->matrix * m->switches + expression) * m->size;
    real e;
    e = dot(m->size, row, x);
    *noise =
        noise_of(sizes(m->size, row, x) + 3 * sizes(m->size, tangent, x) + magnitude(b) + AMPLITUDE(m, expression));
    return e - b;
}

/* 1 or -1 where e is above or below its interval by more than rounding, else 0 */
static int outside(const searched *m, const pl_contact *c, const walk *w, const real *x)
{
    real noise;
    if (w->interval < w->breaks && excess(m, c, w->i, w->at[w->interval], x, &noise) > noise) {
        return 1;
    }
    if (w->interval > 0 && -excess(m, c, w->i, w->at[w->interval - 1], x, &noise) > noise) {
        return -1;
    }
    return 0;
}
