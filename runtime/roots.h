/* SPDX-License-Identifier: MIT-0 */
/* roots.h: where a polynomial first rises through 0, for the runtime's own use: by crossings.c, guards.c and
 * events.c.  A root is isolated by bounds on derivatives before it is computed, so none is stepped over. */
#ifndef PLRT_ROOTS_H
#define PLRT_ROOTS_H

#include "real.h"

/* SHORT: a length of s, which goes from 0 to 1 over a piece.  SOON: one in which what starts is under way.  REST: what
 * rounding may leave of a step, in parts of it.  SCALE: that of switching functions near the end of the range. */
#ifdef REAL_IS_FLOAT
#define SHORT 0x1p-18f
#define SOON 0x1p-7f
#define REST 5e-6f
#define SCALE 0x1p-48f
#else
#define SHORT 0x1p-40
#define SOON 0x1p-10
#define REST 1e-14
#define SCALE 0x1p-48
#endif

static real magnitude(real a)
{
    return a < 0 ? -a : a;
}

static real larger(real a, real b)
{
    return a > b ? a : b;
}

static real smaller(real a, real b)
{
    return a < b ? a : b;
}

/* sum |a_j b_j| */
static real sizes(int n, const real *a, const real *b)
{
    real sum = 0;
    int j;
    for (j = 0; j < n; j++) {
        sum += magnitude(a[j] * b[j]);
    }
    return sum;
}

/* What rounding may have done to a sum of terms of this size */
static real noise_of(real terms)
{
    return 8 * REAL_EPSILON * terms;
}

/* 1, -1 or 0: the sign of the first of e', e'', e''' that is not zero but for rounding.  work: 4 n */
static inline int heading(int n, const real *A, const real *row, const real *x, real *work)
{
    real *y = work, *next = work + n, *terms = work + 2 * n, *next_terms = work + 3 * n, e, noise;
    int order, i;
    for (i = 0; i < n; i++) {
        y[i] = terms[i] = x[i];
    }
    for (order = 1; order <= 3; order++) {
        pl_multiply(n, n, A, y, next);
        for (i = 0; i < n; i++) {
            next_terms[i] = sizes(n, A + i * n, terms);
        }
        for (i = 0; i < n; i++) {
            y[i] = next[i];
            terms[i] = next_terms[i];
        }
        pl_multiply(1, n, row, y, &e);
        noise = noise_of(sizes(n, row, terms));
        if (e > noise || e < -noise) {
            return e > 0 ? 1 : -1;
        }
    }
    return 0;
}

/* The coefficients of x(s) = e^{A dt s} x */
static inline void expand(int n, int degree, const real *A, real dt, const real *x, real *coefficients)
{
    int i, k;
    for (i = 0; i < n; i++) {
        coefficients[i] = x[i];
    }
    for (k = 1; k <= degree; k++, coefficients += n) {
        const real factor = dt / (real)k;
        pl_multiply(n, n, A, coefficients, coefficients + n);
        for (i = 0; i < n; i++) {
            coefficients[n + i] *= factor;
        }
    }
}

static inline void sum_up(int n, int degree, const real *coefficients, real s, real *x)
{
    const real *row = coefficients + degree * n;
    int i, k;
    for (i = 0; i < n; i++) {
        x[i] = row[i];
    }
    for (k = degree; k > 0; k--) {
        row -= n;
        for (i = 0; i < n; i++) {
            x[i] = x[i] * s + row[i];
        }
    }
}

/* How far a switching function is beyond a breakpoint: g(s), 0 <= s <= 1 over the piece, negative inside */
typedef struct beyond {
    int degree;
    real *coefficient;
    real noise;                /* of g */
    real reach, fourth, fifth; /* bounds of |g - g(0)| and of the fourth and fifth derivative */
} beyond;

typedef struct point {
    real s, g, slope, second, third; /* g and its derivatives */
} point;

static point point_of(const beyond *f, real s)
{
    point p;
    int k;
    p.s = s;
    p.g = p.slope = p.second = p.third = 0;
    for (k = f->degree; k >= 0; k--) { /* four chains side by side take no longer than one */
        p.third = p.third * s + p.second;
        p.second = p.second * s + p.slope;
        p.slope = p.slope * s + p.g;
        p.g = p.g * s + f->coefficient[k];
    }
    p.second *= 2;
    p.third *= 6;
    return p;
}

/* g = sign (e - b) from the coefficients of e, whose terms have this size at s = 0; both are scaled by a power of 2
 * where the derivatives of g could overflow and g does not.  0: by these sizes alone g does not rise through 0, as
 * first_root would find, and f is not made. */
static int look_beyond(beyond *f, const real *e, real sign, real b, real terms)
{
    real reach = 0;
    int k;
    for (k = 1; k <= f->degree; k++) {
        reach += magnitude(e[k]);
    }
    if (reach + terms > REAL_LARGE) {
        sign *= SCALE;
        terms *= SCALE;
    } else if (sign * (e[0] - b) + reach <= noise_of(terms + magnitude(b) + reach)) {
        return 0;
    }
    f->coefficient[0] = sign * (e[0] - b);
    f->reach = f->fourth = f->fifth = 0;
    for (k = 1; k <= f->degree; k++) {
        const real a = magnitude(sign * e[k]), fourths = (real)(k * (k - 1) * (k - 2) * (k - 3));
        f->coefficient[k] = sign * e[k];
        f->fourth += fourths * a;
        f->fifth += fourths * (real)(k - 4) * a;
        f->reach += a;
    }
    f->noise = noise_of(terms + magnitude(sign * b) + f->reach);
    return 1;
}

/* What has left its guard at the start comes back where g(s)/s rises through 0: that is known to more digits. */
static inline int look_behind(beyond *f, const real *e, real terms)
{
    int rises;
    f->degree--;
    rises = look_beyond(f, e + 1, 1, 0, terms);
    f->coefficient[++f->degree] = 0;
    return rises;
}

/* The root between a, where g < 0, and z, where g > 0; g rises all the way.  Newton's method, kept safe by halving. */
static real root_between(const beyond *f, point a, point z)
{
    const real enough = SHORT; /* the step after that would be below rounding */
    real s = a.s + (z.s - a.s) * (a.g / (a.g - z.g));
    int i;
    for (i = 0; i < 64; i++) {
        const point p = point_of(f, s);
        const real newton = s - p.g / p.slope;
        if (p.g > 0) {
            z = p;
        } else {
            a = p;
        }
        if (magnitude(newton - s) <= enough && newton >= a.s && newton <= z.s) {
            return newton;
        }
        s = newton > a.s && newton < z.s ? newton : (a.s + z.s) / 2;
    }
    return s;
}

enum { NO_CROSSING, RISES, UNKNOWN }; /* what is known of g between two points */

static int between(const beyond *f, point a, point z)
{
    const real w = (z.s - a.s) * (z.s - a.s) / 8; /* a chord is off by at most w times the second derivative */
    const real second = larger(magnitude(a.second), magnitude(z.second)) + w * f->fourth;
    const real third = larger(magnitude(a.third), magnitude(z.third)) + w * f->fifth;
    if (larger(a.g, z.g) + w * second <= f->noise) {
        return NO_CROSSING;
    }
    if (larger(a.slope, z.slope) + w * third < 0) {
        return NO_CROSSING;
    }
    return smaller(a.slope, z.slope) - w * third > 0 ? RISES : UNKNOWN;
}

/* Where g first rises through 0 before `end`, or -1.  Walks from the left, by intervals that are halved until it is
 * known what g does in them, and doubled again after that. */
static real first_root(const beyond *f, real end, int *splits)
{
    const real shortest = SHORT; /* what g does in less is below its noise */
    real width = end;
    point a, inside; /* inside: the last point where g < 0, so that what noise hides loses no time */
    if (f->coefficient[0] + f->reach <= f->noise) {
        return -1;
    }
    a.s = 0;
    a.g = f->coefficient[0];
    a.slope = f->coefficient[1];
    a.second = 2 * f->coefficient[2];
    a.third = 6 * f->coefficient[3];
    inside = a;
    while (a.s < end) {
        const point z = point_of(f, a.s + width < end ? a.s + width : end);
        const int known = between(f, a, z);
        if (known == UNKNOWN && width > shortest) {
            if (--*splits < 0) {
                return -1;
            }
            width /= 2;
            continue;
        }
        if (known != NO_CROSSING && z.g > f->noise) {
            return inside.g < 0 ? root_between(f, inside, z) : inside.s;
        }
        if (z.g < 0 || inside.g >= 0) {
            inside = z;
        }
        a = z;
        width *= 2;
    }
    return -1;
}

#endif
