/* SPDX-License-Identifier: MIT-0 */
/* A part of a step of any length, of equations whose linear terms are exact and whose other forces are not: the fourth
 * order scheme of Cox and Matthews 2002, (26)-(29), its tables made on the way.  There is no subtraction of what the
 * step multiplies: the forces of its last stage are a polynomial, and e^{A tau} of states and polynomial together is
 * made as one. */
#include "two.h"

int pl_cut_table(const pl_cut *m, const real *A, real tau, real *D, pl_two *work)
{
    const int n = m->states, size = m->size;
    pl_two *const exact = work, *const increment = exact + size * size;
    int i, status;
    for (i = 0; i < size * size; i++) {
        exact[i] = two(A[i], 0);
    }
    status = pl_increment(size, n, exact, tau, 1, increment, increment + n * size);
    for (i = 0; i < n * size; i++) {
        D[i] = increment[i].hi;
    }
    return status;
}

/* out <- y + D x, x made of y, what acts and forces that do not change, or three entries each; NULL: 0.  x: work */
static void flow(const pl_cut *m, const real *D, const real *y, const real *acting, const real *force, int powers,
                 real *x, real *out)
{
    const int n = m->states, from = m->size - 3 * m->forces;
    int i, k;
    for (i = 0; i < n; i++) {
        x[i] = y ? y[i] : 0;
    }
    for (; i < from; i++) {
        x[i] = acting ? acting[i - n] : 0;
    }
    for (i = 0; i < m->forces; i++) {
        for (k = 0; k < 3; k++) {
            x[from + 3 * i + k] = force && k < powers ? force[powers * i + k] : 0;
        }
    }
    pl_multiply(n, m->size, D, x, out);
    for (i = 0; i < n && y; i++) {
        out[i] += y[i];
    }
}

static void add_to(int n, const real *a, real *sum)
{
    int i;
    for (i = 0; i < n; i++) {
        sum[i] += a[i];
    }
}

int pl_cut_advance(const pl_cut *m, const real *A, const real *acting, const void *from, real at, real tau,
                   const real *y, real *next, real *work, pl_two *room)
{
    const int n = m->states, c = m->forces;
    real *const half = work, *const whole = half + n * m->size, *const x = whole + n * m->size;
    real *const half_driven = x + m->size, *const whole_driven = half_driven + n, *const a = whole_driven + n;
    real *const b = a + n, *const first = b + n, *const r = first + n, *const ra = r + c, *const rb = ra + c;
    real *const rest = rb + c; /* 3 c */
    int i, status = pl_cut_table(m, A, tau / 2, half, room);
    status = status ? status : pl_cut_table(m, A, tau, whole, room);
    if (status) {
        return status;
    }
    flow(m, half, NULL, acting, NULL, 0, x, half_driven);
    flow(m, whole, NULL, acting, NULL, 0, x, whole_driven);
    m->force(from, at, y, r);
    flow(m, half, y, NULL, r, 1, x, first);                        /* a = F y + q1 r, without what drives */
    for (i = 0; i < n; i++) {
        a[i] = first[i] + half_driven[i];
    }
    m->force(from, at + tau / 2, a, ra);
    for (i = 0; i < c; i++) {
        rest[i] = ra[i] - r[i];
    }
    flow(m, half, NULL, NULL, rest, 1, x, b);                      /* b = F y + q1 r(a) */
    add_to(n, a, b);
    m->force(from, at + tau / 2, b, rb);
    for (i = 0; i < c; i++) {
        rest[i] = 2 * rb[i] - r[i];
    }
    flow(m, half, first, NULL, rest, 1, x, b);                     /* c = F a + q1 (2 r(b) - r) */
    add_to(n, whole_driven, b);
    m->force(from, at + tau, b, a);                                /* c forces, in the room of a */
    for (i = 0; i < c; i++) {                                      /* a parabola through r, the mean and the last */
        const real middle = (ra[i] + rb[i]) / 2;
        rest[3 * i] = r[i];
        rest[3 * i + 1] = (4 * middle - 3 * r[i] - a[i]) / tau;
        rest[3 * i + 2] = 4 * ((r[i] - middle) + (a[i] - middle)) / tau / tau;
    }
    flow(m, whole, y, acting, rest, 3, x, next);
    return 0;
}
