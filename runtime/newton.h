/* SPDX-License-Identifier: MIT-0 */
/* newton.h: Newton's method on the highest derivatives k at the nodes, part of radau.h.  A few unknowns are eliminated
 * as they stand, in loops that are written out; more with pivots; those of many coordinates by the modes of the stages,
 * systems of the size of the coordinates, with the Jacobian of the step's start and one factorization for it. */

#ifndef PL_BLOCK
#define PL_BLOCK PL_COORDS
#endif

#if PL_DIFFERENCES
/* The highest derivatives at y and their Jacobian: each state is moved by half the digits of the largest of its kind.
 * Newton's method takes it for what it is, so that its error is none of the step. */
static void PL(linearize)(const real known[], const int interval[], const real y[PL_STATES], real left[], real slope[])
{
    real moved[PL_STATES], other[PL_COORDS], largest[3] = {0, 0, 0};
    int i, j, place = 0;
    for (j = 0; j < PL_STATES; j++) {
        const real size = pl_magnitude(moved[j] = y[j]);
        largest[PL_KIND(j)] = PL_COUNTS(j) && size > largest[PL_KIND(j)] ? size : largest[PL_KIND(j)];
    }
    PL(forces)(known, interval, y, left);
    for (j = 0; j < PL_STATES; j++) {
        const real size = largest[PL_KIND(j)];
        if (!PL_COUNTS(j)) {
            continue;
        }
        moved[j] = y[j] + PL_HALF_DIGITS * (size > 0 ? size : 1);
        PL(forces)(known, interval, moved, other);
        for (i = 0; i < PL_BLOCK; i++) {
            slope[i * (PL_ENTRIES / PL_BLOCK) + place] = (other[i] - left[i]) / (moved[j] - y[j]);
        }
        moved[j] = y[j];
        place++;
    }
}
#endif

/* The sum over the nodes of row[j] k_j, `stride` apart: pairs first, the shortest chain of additions */
#if PL_UNKNOWNS <= 10
#define PL_WRITTEN_OUT PL_UNROLL
static inline real PL(sum)(const real row[PL_STAGES], const real *k)
{
    const real two = row[0] * k[0] + row[1] * k[PL_COORDS];
#if PL_STAGES == 3
    return two + row[2] * k[2 * PL_COORDS];
#else
    const real four = two + (row[2] * k[2 * PL_COORDS] + row[3] * k[3 * PL_COORDS]);
#if PL_STAGES == 5
    return four + row[4] * k[4 * PL_COORDS];
#else
    const real pair = row[4] * k[4 * PL_COORDS] + row[5] * k[5 * PL_COORDS];
#if PL_STAGES == 7
    return four + (pair + row[6] * k[6 * PL_COORDS]);
#else
    return (four + pair) + ((row[6] * k[6 * PL_COORDS] + row[7] * k[7 * PL_COORDS]) + row[8] * k[8 * PL_COORDS]);
#endif
#endif
#endif
}
#else
#define PL_WRITTEN_OUT
static inline real PL(sum)(const real row[PL_STAGES], const real *k)
{
    real sum = 0;
    int j;
    for (j = 0; j < PL_STAGES; j++) {
        sum += row[j] * k[j * PL_COORDS];
    }
    return sum;
}
#endif

/* The state at node i of a step of dt [s] */
static inline void PL(stage)(const real y[PL_STATES], real dt, int i, const real k[PL_UNKNOWNS], real stage[PL_STATES])
{
    int c;
    PL_WRITTEN_OUT
    for (c = 0; c < PL_COORDS; c++) {
        const int state = PL(highest)(c);
        stage[state] = y[state] + dt * PL(sum)(PL(once)[i], k + c);
        if (state != c) {
            stage[c] = y[c] + dt * (PL(node)[i] * y[state] + dt * PL(sum)(PL(twice)[i], k + c));
        }
    }
}

/* k changes by d: the largest change that this makes of the states, relative to their sizes */
static inline real PL(corrected)(real dt, const real unit[PL_STATES], const real d[PL_UNKNOWNS], real k[PL_UNKNOWNS])
{
    real change = 0;
    int i, c;
    PL_WRITTEN_OUT
    for (c = 0; c < PL_COORDS; c++) {
        const int state = PL(highest)(c);
        real weight = dt * unit[state];
        if (state != c && dt * dt * unit[c] > weight) {
            weight = dt * dt * unit[c];
        }
        PL_WRITTEN_OUT
        for (i = 0; i < PL_STAGES; i++) {
            const real size = pl_magnitude(d[i * PL_COORDS + c]) * weight;
            k[i * PL_COORDS + c] += d[i * PL_COORDS + c];
            change = size > change || size != size ? size : change;
        }
    }
    return change;
}

/* In a model of derivatives each column has the Jacobian of the coordinates themselves: they are solved block by block.
 * How columns follow the coordinates is left to one more iteration, where those are found. */
#define PL_ALIKE (PL_COORDS / PL_BLOCK)
#define PL_EQUATIONS (PL_STAGES * PL_BLOCK)

/* Where equation i of a block stands among the unknowns */
static inline int PL(unknown)(int block, int i)
{
    return i / PL_BLOCK * PL_COORDS + block * PL_BLOCK + i % PL_BLOCK;
}

#if PL_MODES == 0

#if PL_EQUATIONS <= 10
/* Row i less what the rows before take, and its factors in their place.  Without pivots: of a step that is short enough
 * the diagonal is near 1. */
static inline void PL(reduce)(int i, real matrix[PL_EQUATIONS][PL_EQUATIONS], real pivot[PL_EQUATIONS],
                              real right[PL_UNKNOWNS])
{
    int j, k;
    PL_UNROLL
    for (j = 0; j < PL_EQUATIONS; j++) {
        const int most = i < j ? i : j;
        real sum = matrix[i][j];
        PL_UNROLL
        for (k = 0; k < most; k++) {
            sum -= matrix[i][k] * matrix[k][j];
        }
        matrix[i][j] = j < i ? sum * pivot[j] : sum;
        for (k = 0; k < PL_ALIKE && j < i; k++) {
            right[PL(unknown)(k, i)] -= matrix[i][j] * right[PL(unknown)(k, j)];
        }
    }
    pivot[i] = 1 / matrix[i][i];
}

/* right becomes the solution. */
static inline void PL(substitute)(real matrix[PL_EQUATIONS][PL_EQUATIONS], const real pivot[PL_EQUATIONS],
                                  int block, real right[PL_UNKNOWNS])
{
    int i, j;
    PL_UNROLL
    for (i = PL_EQUATIONS - 1; i >= 0; i--) {
        real *const value = &right[PL(unknown)(block, i)];
        PL_UNROLL
        for (j = PL_EQUATIONS - 1; j > i; j--) {
            *value -= matrix[i][j] * right[PL(unknown)(block, j)];
        }
        *value *= pivot[i];
    }
}
#else
static inline void PL(substitute)(real matrix[PL_EQUATIONS][PL_EQUATIONS], const int pivot[PL_EQUATIONS], int block,
                                  real right[PL_UNKNOWNS])
{
    real part[PL_EQUATIONS];
    int i;
    for (i = 0; i < PL_EQUATIONS; i++) {
        part[i] = right[PL(unknown)(block, i)];
    }
    pl_solve(PL_EQUATIONS, matrix[0], pivot, part);
    for (i = 0; i < PL_EQUATIONS; i++) {
        right[PL(unknown)(block, i)] = part[i];
    }
}
#endif

/* One iteration for a step of dt [s]: the largest change that it makes of the states, relative to their sizes */
static real PL(iterate)(const real y[PL_STATES], const real known[PL_STAGES][PL_ROOM(PL_KNOWN)], const int interval[],
                        real dt, const real unit[PL_STATES], real k[PL_UNKNOWNS])
{
    real matrix[PL_EQUATIONS][PL_EQUATIONS], right[PL_UNKNOWNS];
#if PL_EQUATIONS <= 10
    real pivot[PL_EQUATIONS];
#else
    int pivot[PL_EQUATIONS];
#endif
    int i, j, c;
    PL_WRITTEN_OUT
    for (i = 0; i < PL_STAGES; i++) {
        real stage[PL_STATES], left[PL_COORDS], jacobian[PL_ROOM(PL_ENTRIES)];
        PL(stage)(y, dt, i, k, stage);
        PL(linearize)(known[i], interval, stage, left, jacobian);
        PL_WRITTEN_OUT
        for (c = 0; c < PL_COORDS; c++) {
            right[i * PL_COORDS + c] = left[c] - k[i * PL_COORDS + c];
        }
        PL_WRITTEN_OUT
        for (c = 0; c < PL_BLOCK; c++) {
            const int row = i * PL_BLOCK + c;
            PL_WRITTEN_OUT
            for (j = 0; j < PL_EQUATIONS; j++) {
                matrix[row][j] = j == row ? 1 : 0;
            }
        }
        PL_WRITTEN_OUT
        for (c = 0; c < PL_ENTRIES; c++) {
            const int row = i * PL_BLOCK + PL(entry)[c][0], of = PL(entry)[c][1], twice = PL(entry)[c][2];
            const real factor = jacobian[c] * (twice ? dt * dt : dt);
            PL_WRITTEN_OUT
            for (j = 0; j < PL_STAGES; j++) {
                matrix[row][j * PL_BLOCK + of] -= factor * (twice ? PL(twice)[i][j] : PL(once)[i][j]);
            }
        }
#if PL_EQUATIONS <= 10
        PL_UNROLL
        for (c = 0; c < PL_BLOCK; c++) {
            PL(reduce)(i * PL_BLOCK + c, matrix, pivot, right);
        }
#endif
    }
#if PL_EQUATIONS > 10
    if (!pl_factor(PL_EQUATIONS, matrix[0], pivot)) {
        return (real)1e30;
    }
#endif
    for (i = 0; i < PL_ALIKE; i++) {
        PL(substitute)(matrix, pivot, i, right);
    }
    return PL(corrected)(dt, unit, right, k);
}

#else

typedef struct PL(factors) { /* of the matrices of one step */
    real real_mode[PL_BLOCK][PL_BLOCK], pair[PL_MODES - 1][PL_BLOCK][PL_BLOCK][2];
    int pivot[PL_MODES][PL_BLOCK];
} PL(factors);

/* 1 - dt z J_v - dt^2 z^2 J_x for each z of a step of dt [s]: 1, or 0 where one is singular */
static int PL(factorize)(const real jacobian[PL_ROOM(PL_ENTRIES)], real dt, PL(factors) *f)
{
    int i, j, m, good;
    for (i = 0; i < PL_BLOCK; i++) {
        for (j = 0; j < PL_BLOCK; j++) {
            f->real_mode[i][j] = i == j ? 1 : 0;
            for (m = 0; m < PL_MODES - 1; m++) {
                f->pair[m][i][j][0] = i == j ? 1 : 0;
                f->pair[m][i][j][1] = 0;
            }
        }
    }
    for (i = 0; i < PL_ENTRIES; i++) {
        const int row = PL(entry)[i][0], column = PL(entry)[i][1], twice = PL(entry)[i][2];
        for (m = 0; m < PL_MODES; m++) {
            const real a = dt * PL(mode)[m][0], b = dt * PL(mode)[m][1];
            const real re = jacobian[i] * (twice ? a * a - b * b : a), im = jacobian[i] * (twice ? 2 * a * b : b);
            if (m == 0) {
                f->real_mode[row][column] -= re;
            } else {
                f->pair[m - 1][row][column][0] -= re;
                f->pair[m - 1][row][column][1] -= im;
            }
        }
    }
    good = pl_factor(PL_BLOCK, f->real_mode[0], f->pivot[0]);
    for (m = 1; m < PL_MODES; m++) {
        good = pl_factor_complex(PL_BLOCK, f->pair[m - 1][0][0], f->pivot[m]) && good;
    }
    return good;
}

/* What mode m gives of the correction d of a block, from coordinate `from` on, for this right side */
static inline void PL(add_mode)(const PL(factors) *f, int m, int from, const real right[PL_UNKNOWNS],
                                real d[PL_UNKNOWNS])
{
    real part[2 * PL_BLOCK];
    int i, c;
    for (c = 0; c < PL_BLOCK; c++) {
        real re = 0, im = 0;
        for (i = 0; i < PL_STAGES; i++) {
            re += PL(to_mode)[m][i][0] * right[i * PL_COORDS + from + c];
            im += PL(to_mode)[m][i][1] * right[i * PL_COORDS + from + c];
        }
        part[m ? 2 * c : c] = re;
        if (m) {
            part[2 * c + 1] = im;
        }
    }
    if (m) {
        pl_solve_complex(PL_BLOCK, f->pair[m - 1][0][0], f->pivot[m], part);
    } else {
        pl_solve(PL_BLOCK, f->real_mode[0], f->pivot[0], part);
    }
    for (i = 0; i < PL_STAGES; i++) {
        for (c = 0; c < PL_BLOCK; c++) {
            d[i * PL_COORDS + from + c] += m ? PL(from_mode)[m][i][0] * part[2 * c]
                                                   - PL(from_mode)[m][i][1] * part[2 * c + 1]
                                             : PL(from_mode)[m][i][0] * part[c];
        }
    }
}

static real PL(iterate)(const real y[PL_STATES], const real known[PL_STAGES][PL_ROOM(PL_KNOWN)], const int interval[],
                        real dt, const real unit[PL_STATES], const PL(factors) *f, real k[PL_UNKNOWNS])
{
    real right[PL_UNKNOWNS], d[PL_UNKNOWNS];
    int i, c, m;
    for (i = 0; i < PL_STAGES; i++) {
        real stage[PL_STATES], left[PL_COORDS];
        PL(stage)(y, dt, i, k, stage);
        PL(forces)(known[i], interval, stage, left);
        for (c = 0; c < PL_COORDS; c++) {
            right[i * PL_COORDS + c] = left[c] - k[i * PL_COORDS + c];
            d[i * PL_COORDS + c] = 0;
        }
    }
    for (m = 0; m < PL_MODES; m++) {
        for (c = 0; c < PL_COORDS; c += PL_BLOCK) {
            PL(add_mode)(f, m, c, right, d);
        }
    }
    return PL(corrected)(dt, unit, d, k);
}

#endif

/* 1 over the size of each state; where that was 0 so far, of what the step makes of it, or one of h.  Beside contacts
 * it is a millionth of that at least: what is let go starts at a rounding of 0.  And where it was 0, a millionth of the
 * largest of its kind, as in measure.h: far down a chain that starts at rest there is but rounding. */
static void PL(sizes)(const PL_TYPE *s, real dt, const real k[PL_UNKNOWNS], real unit[PL_STATES])
{
    real largest[3] = {0, 0, 0};
    int i, j;
    dt = dt > PL_H ? dt : PL_H;
    for (i = 0; i < PL_STATES; i++) {
        const int c = PL(coord)(i);
        real most = 0;
        unit[i] = s->unit[i];
        if (!PL_COUNTS(i)) {
            continue;
        }
        if (unit[i] * largest[PL_KIND(i)] < 1 && unit[i] > 0) {
            largest[PL_KIND(i)] = 1 / unit[i];
        }
        if (unit[i] != 0 && !PL_CONTACTS) {
            continue;
        }
        for (j = 0; j < PL_STAGES; j++) {
            if (pl_magnitude(k[j * PL_COORDS + c]) > most) {
                most = pl_magnitude(k[j * PL_COORDS + c]);
            }
        }
        most *= PL(is_moved)(i) ? dt * dt : dt;
        if (unit[i] != 0) {
            most *= (real)1e-6;
            unit[i] = most * unit[i] > 1 ? 1 / most : unit[i];
            continue;
        }
        unit[i] = most > 1 / PL_UNIT ? 1 / most : most > 0 ? PL_UNIT : 1;
        largest[PL_KIND(i)] = most > largest[PL_KIND(i)] ? most : largest[PL_KIND(i)];
    }
    for (i = 0; i < PL_STATES; i++) {
        if (PL_COUNTS(i) && s->unit[i] == 0 && unit[i] * largest[PL_KIND(i)] > 1048576) {
            unit[i] = 1048576 / largest[PL_KIND(i)];
        }
    }
}

/* The highest derivatives k at the nodes of a step of `size` h, from those that are given, and what is known there: 1,
 * or 0 where Newton's method does not find them */
static int PL(solve)(const PL_TYPE *s, const real start[], const real slope[], const real jacobian[], real size,
                     real known[PL_STAGES][PL_ROOM(PL_KNOWN)], real unit[PL_STATES], real k[PL_UNKNOWNS])
{
    const real dt = size * PL_H;
    const int *const interval = PL(intervals)(s);
    const int fresh = PL_CONTACTS && !s->ready; /* units are not known yet */
    real previous = 0;
    int i, found = 0;
#if PL_MODES > 0
    PL(factors) factors;
    if (!PL(factorize)(jacobian, dt, &factors)) {
        return 0;
    }
#endif
    (void)jacobian;
    for (i = 0; i < PL_STAGES; i++) {
        PL(known_at)(s, PL_KNOWN, start, slope, PL(node)[i] * size, size / 2, known[i]);
    }
    for (i = 0; i < 9 + found; i++) {
        real change;
        PL(sizes)(s, dt, k, unit);
#if PL_MODES > 0
        change = PL(iterate)(s->start, (const real (*)[PL_ROOM(PL_KNOWN)])known, interval, dt, unit, &factors, k);
        if (i > fresh && change >= previous && !found) {
            return 0;
        }
#else
        change = PL(iterate)(s->start, (const real (*)[PL_ROOM(PL_KNOWN)])known, interval, dt, unit, k);
#endif
        if (!(change < (fresh && i == 0 ? (real)1e29 : (real)1e10))) {
            return 0;
        }
        if (found) {
            return 1;
        }
        found = change <= PL_NO_CHANGE ||
                (i > fresh && (change <= PL_SOLVED
                               || (change < previous && change * change <= PL_SOLVED * (previous - change))));
        if (found && PL_ALIKE == 1) {
            return 1;
        }
        previous = change;
    }
    return 0;
}

/* States at rest so far: made: 1 over what the first that was tried makes of them.  Where several were too long that
 * counts until they are larger: relative to themselves they would grow by small steps for long. */
static inline void PL(leave_rest)(PL_TYPE *s, int rejected, const real unit[PL_STATES], real made[PL_STATES])
{
    int i;
    for (i = 0; i < PL_STATES; i++) {
        if (PL_COUNTS(i) && s->unit[i] == 0 && pl_magnitude(s->gain[i]) > 0) {
            made[i] = made[i] > 0 ? made[i] : unit[i];
            if (rejected > 3) {
                s->unit[i] = made[i];
                s->scale[i] = 1 / made[i];
            }
        }
    }
}
