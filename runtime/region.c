/* SPDX-License-Identifier: MIT-0 */
/* Tables of a region of a piecewise-linear model from other params: e^{A d} of a piece of its step, and how fast rows
 * over x may change within one. */
#include "two.h"

static real magnitude(real a)
{
    return a < 0 ? -a : a;
}

/* ---- pieces ---- */

/* Above the size of every pole of A h: of a matrix B of sizes, max (B v)_i / v_i for any v above 0 is such a bound, and
 * a few products bring v near to that which makes it least.  v, next: work, n each */
static real largest_turn(int n, const pl_two *A, real h, real *v, real *next)
{
    enum { PRODUCTS = 40 };
    const real shift = 1 / (real)16, least = REAL_EPSILON * REAL_EPSILON;
    real most = 0;
    int i, j, k;
    for (i = 0; i < n; i++) {
        v[i] = 1;
    }
    for (k = 0; k < PRODUCTS; k++) {
        real largest = 0;
        most = 0;
        for (i = 0; i < n; i++) {
            real sum = shift * v[i];
            for (j = 0; j < n; j++) {
                sum += magnitude(A[i * n + j].hi * h) * v[j];
            }
            next[i] = sum;
            if (!is_finite(sum)) {
                return sum - sum;
            }
            if (sum > largest) {
                largest = sum;
            }
            if (sum / v[i] > most) {
                most = sum / v[i];
            }
        }
        for (i = 0; i < n; i++) {
            v[i] = next[i] > least * largest ? next[i] / largest : least;
        }
    }
    return most - shift;
}

/* Phi = I + D, rounded once */
static void from_increment(int n, const pl_two *D, real *Phi)
{
    int i;
    for (i = 0; i < n * n; i++) {
        Phi[i] = i % (n + 1) == 0 ? (1 + D[i].hi) + D[i].lo : D[i].hi;
    }
}

int pl_region_of(int size, const pl_two *A, real h, int most, int *halvings, real *slopes, real *Phi, pl_two *work)
{
    const int cells = size * size;
    pl_two *const D = work + PL_INCREMENT_WORK(size);
    real turn = largest_turn(size, A, h, slopes, Phi), d = h;
    int i, status;
    if (!is_finite(turn)) {
        return PL_NOT_FINITE;
    }
    for (*halvings = 0; turn > 1 && *halvings <= most; turn /= 2, d /= 2) {
        ++*halvings;
    }
    if (*halvings > most) {
        return PL_OUT_OF_RANGE;
    }
    status = pl_increment(size, size, A, d, 1, D, work);
    for (i = 0; i < cells && status == 0; i++) {
        slopes[i] = A[i].hi;
    }
    if (status == 0) {
        from_increment(size, D, Phi);
    }
    return status;
}

int pl_region_whole(int size, const pl_two *A, real h, int halvings, const real *Phi, real most, real *whole,
                    real *large, pl_two *work)
{
    pl_two *const D = work + PL_INCREMENT_WORK(size);
    const int cells = size * size;
    real largest = 1;
    int i, status = 0;
    *large = 0;
    for (i = 0; i < cells; i++) {
        whole[i] = Phi[i];
    }
    if (halvings > 1) {
        return 0;
    }
    if (halvings == 1) {
        status = pl_increment(size, size, A, h, 1, D, work);
        from_increment(size, D, whole);
    }
    for (i = 0; i < cells; i++) {
        largest = magnitude(whole[i]) > largest ? magnitude(whole[i]) : largest;
    }
    *large = most / largest;
    return status;
}

/* ---- bounds ---- */

/* E <- e^{A tau}, or e^{|A| tau}, whose poles times tau are below 1/4.  work: 2 n n */
static void exponential(int n, const real *A, real tau, int sizes, real *E, real *work)
{
    enum { TERMS = 14 };
    real *term = work, *next = work + n * n, *swap;
    int i, j, k, m;
    for (i = 0; i < n * n; i++) {
        E[i] = term[i] = (real)(i % (n + 1) == 0);
    }
    for (k = 1; k < TERMS + n; k++) {
        for (i = 0; i < n; i++) {
            for (j = 0; j < n; j++) {
                real sum = 0;
                for (m = 0; m < n; m++) {
                    sum += term[i * n + m] * (sizes ? magnitude(A[m * n + j]) : A[m * n + j]);
                }
                next[i * n + j] = sum * tau / (real)k;
            }
        }
        swap = term;
        term = next;
        next = swap;
        for (i = 0; i < n * n; i++) {
            E[i] += term[i];
        }
    }
}

/* row <- row B, B A or its sizes.  work: n */
static void times(int n, real *row, const real *A, int sizes, real *work)
{
    int i, j;
    for (j = 0; j < n; j++) {
        work[j] = 0;
        for (i = 0; i < n; i++) {
            work[j] += row[i] * (sizes ? magnitude(A[i * n + j]) : A[i * n + j]);
        }
    }
    for (j = 0; j < n; j++) {
        row[j] = work[j];
    }
}

/* A piece is looked at in so many parts: within one a derivative grows by e^{|A| d / PARTS} at most. */
enum { PARTS = 8 };

/* bound . |x(0)| is above factor |row e^{A tau} x(0)| for all tau of a piece.  lost: what rounding did to row, at most;
 * both are used up.  E, most: over a part.  work: n */
static void bound_row(int n, const real *E, const real *most, real *row, real *lost, real factor, real *bound,
                      real *work)
{
    int i, j, part;
    for (j = 0; j < n; j++) {
        bound[j] = 0;
    }
    for (part = 0; part < PARTS; part++) {
        for (j = 0; j < n; j++) {
            real sum = 0;
            for (i = 0; i < n; i++) {
                sum += (magnitude(row[i]) + lost[i]) * most[i * n + j];
            }
            sum *= factor * (1 + 64 * (real)n * REAL_EPSILON);
            if (!(sum <= bound[j])) {
                bound[j] = sum;
            }
        }
        times(n, row, E, 0, work);
        times(n, lost, most, 0, work);
    }
}

void pl_region_bounds(int size, real d, const real *A, int rows, const real *row, real *slope, real *second,
                      real *fourth, real *work)
{
    const int n = size;
    real *E = work, *most = E + n * n, *gone = most + n * n, *sizes = gone + n, *at = sizes + n, *lost = at + n;
    real *more = lost + n;
    int i, j, order;
    exponential(n, A, d / PARTS, 0, E, gone);
    exponential(n, A, d / PARTS, 1, most, gone);
    for (i = 0; i < rows; i++, row += n, slope += n) {
        for (j = 0; j < n; j++) {
            gone[j] = row[j];
            sizes[j] = magnitude(row[j]);
        }
        for (order = 1; order <= 4; order++) {
            times(n, gone, A, 0, more);
            times(n, sizes, A, 1, more);
            for (j = 0; j < n && order == 1; j++) {
                slope[j] = d / 3 * gone[j];
            }
            if (order % 2) {
                continue;
            }
            for (j = 0; j < n; j++) {
                at[j] = gone[j];
                lost[j] = 8 * (real)(n + order) * REAL_EPSILON * sizes[j];
            }
            if (order == 2) {
                bound_row(n, E, most, at, lost, d * d / 8, second + i * n, more);
            } else {
                bound_row(n, E, most, at, lost, d * d * d * d / 384, fourth + i * n, more);
            }
        }
    }
}
