/* SPDX-License-Identifier: MIT-0 */
/* The largest size of an output within a step: a bound that most steps stay below, else its Taylor polynomial. */
#include "real.h"

enum { MOST_TERMS = 48, MOST_HALVINGS = 20, BEND_PARTS = 4, MOST_ENTRIES = 96 };

static real size_of(real a)
{
    return a < 0 ? -a : a;
}

/* Not a number stays none. */
static real larger(real a, real b)
{
    return a > b ? a : b;
}

static real product(int n, const real *a, const real *b)
{
    real sum = 0;
    int i;
    for (i = 0; i < n; i++)
        sum += a[i] * b[i];
    return sum;
}

/* ---- a polynomial in s = 0 .. 1 ---- */

typedef struct taylor {
    int degree;
    real c[MOST_TERMS + 1];
    real second, third; /* bounds of the derivatives */
} taylor;

static void bound_derivatives(taylor *p)
{
    int k;
    p->second = p->third = 0;
    for (k = 2; k <= p->degree; k++) {
        const real size = (real)(k * (k - 1)) * size_of(p->c[k]);
        p->second += size;
        p->third += size * (real)(k - 2);
    }
}

/* value[0], [1], [2]: p, p', p'' at s */
static void values_at(const taylor *p, real s, real *value)
{
    int k;
    value[0] = value[1] = value[2] = 0;
    for (k = p->degree; k >= 0; k--) {
        value[2] = value[2] * s + 2 * value[1];
        value[1] = value[1] * s + value[0];
        value[0] = value[0] * s + p->c[k];
    }
}

/* |p| at the root of p' in a .. b, where p'' has one sign: Newton's method from where the chord of p' is 0.  Off by
 * `off` p is off by off^2/2 p''. */
static real extreme(const taylor *p, real a, real b, real slope_a, real slope_b)
{
    real s = a + (b - a) * (slope_a / (slope_a - slope_b)), value[3];
    int k;
    for (k = 0; k < 6; k++) {
        real next, off;
        values_at(p, s, value);
        next = s - value[1] / value[2];
        next = next > a ? (next < b ? next : b) : a;
        off = size_of(next - s);
        if (off * off * size_of(value[2]) <= REAL_EPSILON / 4 * size_of(value[0]))
            break;
        s = next;
    }
    return size_of(value[0]);
}

/* Between two points p is off its chord by at most (b - a)^2/8 max|p''|.  Where that may pass `peak`: one sign of p''
 * in between leaves one extreme at most; else half the interval. */
static real largest(const taylor *p, real peak)
{
    const real least = REAL_DIGITS > 30 ? (real)1 / (1 << 26) : (real)1 / (1 << 12);
    real a = 0, width = 1, at_a[3], at_b[3], middle[3];
    values_at(p, a, at_a);
    while (a < 1) {
        const real b = a + width, bend = width * width / 8 * p->second;
        values_at(p, b, at_b);
        if (width > least && !(larger(size_of(at_a[0]), size_of(at_b[0])) + bend <= peak)) {
            values_at(p, a + width / 2, middle);
            if (size_of(middle[2]) < p->third * width / 2) {
                width /= 2;
                continue;
            }
            if ((at_a[1] < 0) != (at_b[1] < 0))
                peak = larger(peak, extreme(p, a, b, at_a[1], at_b[1]));
        }
        a = b;
        width = 2 * width < 1 - a ? 2 * width : 1 - a;
        at_a[0] = at_b[0];
        at_a[1] = at_b[1];
    }
    return peak;
}

/* ---- the output as a polynomial ---- */

/* A where it is not 0, row by row: mostly chains of derivatives.  Too many entries: all of A, none listed */
typedef struct slopes {
    int size, entries;
    const real *A;
    int row[MOST_ENTRIES], column[MOST_ENTRIES];
    real value[MOST_ENTRIES];
} slopes;

static void list_entries(int size, const real *A, slopes *s)
{
    int i, j;
    s->size = size;
    s->A = A;
    s->entries = 0;
    for (i = 0; i < size; i++)
        for (j = 0; j < size; j++)
            if (A[i * size + j] < 0 || A[i * size + j] > 0) {
                if (s->entries == MOST_ENTRIES) {
                    s->entries = -1;
                    return;
                }
                s->row[s->entries] = i;
                s->column[s->entries] = j;
                s->value[s->entries++] = A[i * size + j];
            }
}

static void slope_of(const slopes *s, const real *x, real *slope)
{
    int i;
    if (s->entries < 0) {
        for (i = 0; i < s->size; i++)
            slope[i] = product(s->size, s->A + i * s->size, x);
        return;
    }
    for (i = 0; i < s->size; i++)
        slope[i] = 0;
    for (i = 0; i < s->entries; i++)
        slope[s->row[i]] += s->value[i] * x[s->column[i]];
}

/* row . e^{A s d} x, and x at the end, s = 1; 0: it takes too many terms.  work: 3 size reals */
static int expand(const slopes *A, const real *row, real d, real *x, taylor *p, real *work)
{
    const int size = A->size;
    real *term = work, *next = work + size, *most = work + 2 * size;
    int i, k, small = 0;
    for (i = 0; i < size; i++) {
        term[i] = x[i];
        most[i] = size_of(x[i]);
    }
    p->c[0] = product(size, row, x);
    for (k = 1; k <= MOST_TERMS && small < 2; k++) {
        int all = 1;
        slope_of(A, term, next);
        for (i = 0; i < size; i++) {
            term[i] = next[i] * (d / (real)k);
            x[i] += term[i];
            most[i] = larger(most[i], size_of(term[i]));
            all = all && size_of(term[i]) <= REAL_EPSILON / 8 * most[i];
        }
        p->c[k] = product(size, row, term);
        p->degree = k;
        small = all ? small + 1 : 0;
    }
    return small == 2;
}

/* Part by part, of which there are 2^halvings; below 0: these are too long */
static real search(const slopes *A, const real *row, real h, int halvings, const real *start, real peak, real *work)
{
    const int size = A->size;
    const int32_t parts = (int32_t)1 << halvings;
    real *x = work + 3 * size;
    int32_t part;
    int i;
    taylor p;
    for (i = 0; i < size; i++)
        x[i] = start[i];
    for (part = 0; part < parts; part++) {
        if (!expand(A, row, h / (real)parts, x, &p, work))
            return -1;
        bound_derivatives(&p);
        peak = largest(&p, peak);
    }
    return peak;
}

real pl_peak(int size, const real *A, const real *row, const real *bend, real h, const real *x, real end, real peak,
             real *work)
{
    const real most = larger(size_of(product(size, row, x)), size_of(end));
    real off = 0, found = -1;
    slopes listed;
    int i;
    for (i = 0; i < size; i++)
        off += bend[i] * size_of(x[i]);
    if (most + off <= peak)
        return peak;
    if (!(most - most <= 0) || !(peak - peak <= 0))     /* not finite */
        return peak - peak <= 0 ? most : peak;
    peak = larger(peak, most);
    list_entries(size, A, &listed);
    for (i = 0; i <= MOST_HALVINGS && found < 0; i++)
        found = search(&listed, row, h, i, x, peak, work);
    return found < 0 ? peak : found;
}

/* ---- the bound ---- */

/* sum <- sum |A|^k d^k/k! of |row|, row <- row e^{A d}; 0: not in so many terms.  work: 3 size reals */
static int grow(int size, const real *A, real d, real *row, real *sum, real *work)
{
    real *term = work, *most = work + size, *next = work + 2 * size;
    int i, j, k, small = 0;
    for (i = 0; i < size; i++) {
        term[i] = row[i];
        sum[i] = most[i] = size_of(row[i]);
    }
    for (k = 1; k <= MOST_TERMS && small < 2; k++) {
        int all = 1;
        for (j = 0; j < size; j++)
            next[j] = 0;
        for (i = 0; i < size; i++)
            for (j = 0; j < size; j++)
                next[j] += term[i] * A[i * size + j];
        for (j = 0; j < size; j++)
            term[j] = next[j] * (d / (real)k);
        for (j = 0; j < size; j++)
            next[j] = 0;
        for (i = 0; i < size; i++)
            for (j = 0; j < size; j++)
                next[j] += most[i] * size_of(A[i * size + j]);
        for (j = 0; j < size; j++) {
            most[j] = next[j] * (d / (real)k);
            row[j] += term[j];
            sum[j] += most[j];
            all = all && most[j] <= REAL_EPSILON * sum[j];
        }
        small = all ? small + 1 : 0;
    }
    return small == 2;
}

void pl_peak_bend(int size, const real *A, const real *row, real h, real *bend, real *work)
{
    const real slack = 1 + 4096 * REAL_EPSILON;
    real *r = work, *sum = work + size, *first = work + 2 * size;
    int i, j, k;
    for (j = 0; j < size; j++)
        for (bend[j] = first[j] = 0, i = 0; i < size; i++)
            first[j] += row[i] * A[i * size + j];
    for (j = 0; j < size; j++)
        for (r[j] = 0, i = 0; i < size; i++)
            r[j] += first[i] * A[i * size + j];
    for (k = 0; k < BEND_PARTS; k++) {
        const int known = grow(size, A, h / (real)BEND_PARTS, r, sum, work + 2 * size);
        for (j = 0; j < size; j++)
            bend[j] = known ? larger(bend[j], slack * (h * h / 8) * sum[j]) : REAL_LARGE;
        if (!known)
            return;
    }
}
