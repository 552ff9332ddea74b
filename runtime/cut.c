/* SPDX-License-Identifier: MIT-0 */
/* A part of a step of any length, of equations whose linear terms are exact and whose other forces are not: the fourth
 * order scheme of Cox and Matthews 2002, (26)-(29).  States, what drives them and forces that are polynomials in time
 * are one vector x, x' = A x; so each stage is e^{A tau} x, and no function is divided by what may be 0. */
#include "two.h"

/* ---- x <- e^{A tau} x ---- */

/* TURN: below this bound of |A| tau the series itself, which loses no more than e^TURN units in the last place */
enum { TURN = 2, MOST_TERMS = 64, CHAIN = 3 };

/* So that what is left out is below a unit in the last place; chains of integrators come late */
static int terms_of(real turn)
{
    real term = 1;
    int k;
    for (k = 1; k < MOST_TERMS && term > REAL_EPSILON / 16; k++) {
        term *= turn / (real)k;
    }
    return k + CHAIN;
}

/* next: work */
static void by_series(int size, const real *A, real tau, int terms, const real *x, real *out, real *term, real *next)
{
    int i, k;
    for (i = 0; i < size; i++) {
        out[i] = term[i] = x[i];
    }
    for (k = 1; k <= terms; k++) {
        const real factor = tau / (real)k;
        pl_multiply(size, size, A, term, next);
        for (i = 0; i < size; i++) {
            term[i] = factor * next[i];
            out[i] += term[i];
        }
    }
}

/* D <- e^{A tau} - I for half of tau and, behind it, for all of it.  work: PL_CUT_ROOM */
static int make_tables(int size, const real *A, real tau, real *D, pl_two *work)
{
    const int cells = size * size;
    pl_two *const exact = work, *const increment = exact + cells;
    real *const whole = D + cells;
    int i, j, k, status;
    for (i = 0; i < cells; i++) {
        exact[i] = two(A[i], 0);
    }
    status = pl_increment(size, size, exact, tau / 2, 1, increment, increment + cells);
    for (i = 0; i < cells; i++) {
        D[i] = increment[i].hi;
    }
    for (i = 0; i < size && status == 0; i++) {
        for (j = 0; j < size; j++) {
            real sum = 2 * D[i * size + j];
            for (k = 0; k < size; k++) {
                sum += D[i * size + k] * D[k * size + j];
            }
            whole[i * size + j] = sum;
        }
    }
    return status;
}

typedef struct flow {
    int size, terms;  /* 0: by tables */
    const real *A, *D;
    real tau;
    real *room; /* 2 size */
} flow;

/* Over half of tau, or all of it */
static void flow_on(const flow *f, int half, const real *x, real *out)
{
    int i;
    if (f->terms) {
        by_series(f->size, f->A, half ? f->tau / 2 : f->tau, f->terms, x, out, f->room, f->room + f->size);
        return;
    }
    pl_multiply(f->size, f->size, f->D + (half ? 0 : f->size * f->size), x, out);
    for (i = 0; i < f->size; i++) {
        out[i] += x[i];
    }
}

/* ---- the part ---- */

/* x <- states and what drives them, and forces that do not change */
static void gather(const pl_cut *m, const real *states, const real *acting, const real *force, real *x)
{
    const int first = m->size - 3 * m->forces;
    int i;
    for (i = 0; i < m->size; i++) {
        x[i] = i < m->states ? states[i] : i < first ? acting[i - m->states] : 0;
    }
    for (i = 0; i < m->forces; i++) {
        x[first + 3 * i] = force[i];
    }
}

int pl_cut_advance(const pl_cut *m, const real *A, const real *acting, const void *from, real at, real tau,
                   const real *y, real *next, real *work, pl_two *room)
{
    const int n = m->states, c = m->forces, size = m->size, first = size - 3 * c;
    real *const D = work, *const x = D + 2 * size * size, *const a = x + size, *const b = a + size;
    real *const r = b + size, *const ra = r + c, *const rb = ra + c, *const rest = rb + c;
    flow f;
    int i;
    f.size = size;
    f.terms = m->fastest * tau <= (real)TURN ? terms_of(m->fastest * tau) : 0;
    f.A = A;
    f.D = D;
    f.tau = tau;
    f.room = rest + c;
    if (!f.terms) {
        const int status = make_tables(size, A, tau, D, room);
        if (status) {
            return status;
        }
    }
    m->force(from, at, y, r);
    gather(m, y, acting, r, x);
    flow_on(&f, 1, x, a); /* a = F y + q1 r */
    m->force(from, at + tau / 2, a, ra);
    for (i = 0; i < c; i++) {
        rest[i] = ra[i] - r[i];
    }
    gather(m, a, a + n, rest, x);
    for (i = 0; i < first; i++) {
        x[i] = 0;
    }
    flow_on(&f, 1, x, b); /* b = F y + q1 r(a) */
    for (i = 0; i < n; i++) {
        b[i] += a[i];
    }
    m->force(from, at + tau / 2, b, rb);
    for (i = 0; i < c; i++) {
        rest[i] = 2 * rb[i] - r[i];
    }
    gather(m, a, a + n, rest, x);
    flow_on(&f, 1, x, b); /* c = F a + q1 (2 r(b) - r) */
    m->force(from, at + tau, b, rest);
    gather(m, y, acting, r, x);
    for (i = 0; i < c; i++) { /* a parabola through r, the mean of r(a) and r(b), r(c) */
        const real middle = (ra[i] + rb[i]) / 2;
        x[first + 3 * i + 1] = (4 * middle - 3 * r[i] - rest[i]) / tau;
        x[first + 3 * i + 2] = 4 * ((r[i] - middle) + (rest[i] - middle)) / tau / tau;
    }
    flow_on(&f, 0, x, b);
    for (i = 0; i < n; i++) {
        next[i] = b[i];
    }
    return 0;
}
