/* SPDX-License-Identifier: MIT-0 */
/* plreal.h: the declarations of plrt.h that differ by the type of numbers.  plrt.h includes it twice: for PL_REAL
 * double, and for float with the names of floats.h.  In the second, DBL_EPSILON stands for FLT_EPSILON.  Matrices are
 * row-major; `work` is an array for intermediate results, whose contents mean nothing before and after. */

/* ---- series.c: between two steps ------------------------------------------------------------------------- */

/* x' = A x, advanced by a Taylor polynomial of e^{A tau} on 2^halvings equal parts of tau.  The generator chooses
 * degree and halvings for 0 <= tau <= h: |pole| h / 2^halvings <= 1 for every pole, those of loads included, and a
 * degree of 15 + d, in floats 8 + d, where d is the longest path from one entry to another along nonzero entries of A.
 * The error of x_i is then below 8 DBL_EPSILON sum_j most_ij |x_j|, most_ij being the largest |Phi_ij| of e^{A tau} on
 * 0 .. h (measured for |pole| h up to 8: 7.4 in 200 chains, half of them below 1.7; in floats 6.7 in 11). */
typedef struct pl_series {
    int size;        /* entries of x */
    int states;      /* the first `states` entries are the model's states, the others load states and inputs */
    int degree;      /* degree of the Taylor polynomial, >= 1 */
    int halvings;    /* 0 .. 30 */
    const PL_REAL *A; /* size x size, row-major, [1/s] */
} pl_series;

/* Replaces x, `size` entries, by e^{A tau} x; tau in seconds.  work: 2 size numbers. */
void pl_series_advance(const pl_series *p, PL_REAL tau, PL_REAL *x, PL_REAL *work);

/* ---- power.c: many steps at once ------------------------------------------------------------------------- */

/* A double-double number hi + lo, |lo| <= half a unit in the last place of hi (106 bits, in floats 48). */
typedef struct pl_two { PL_REAL hi, lo; } pl_two;

/* Replaces x, n entries, by P^k x, by binary powering in double-double arithmetic; k = 0 leaves it unchanged.  The
 * relative error is about k 2^-104, in floats k 2^-46, where a term below 2^-102 loses bits of its low part to
 * underflow.  P, n x n, is overwritten; W and w are work of n x n and n entries.  A result beyond the range of double
 * is an infinity with lo = 0, of any sign where a power of P has overflowed; finite arguments give no NaN. */
void pl_power_apply(int n, pl_two *P, pl_two *W, pl_two *x, pl_two *w, uint64_t k);

/* ---- compensated sums, for --accuracy compensated -------------------------------------------------------------- */

/* Returns sum + term + (small + *low), rounded; *low, the low part of the sum, becomes the error of that rounding.
 * The error of the first sum is exact (Knuth's TwoSum: no condition on sizes); `small` and *low, which are as small as
 * rounding errors, are added to it, since they would be lost in `term`. */
static inline PL_REAL pl_accumulate(PL_REAL sum, PL_REAL term, PL_REAL small, PL_REAL *low)
{
    const PL_REAL whole = sum + term, part = whole - sum;
    const PL_REAL error = ((sum - (whole - part)) + (term - part)) + (small + *low), result = whole + error;
    *low = error - (result - whole);
    return result;
}

/* Adds value^2 to sum[0], of which sum[apart] is what rounding took; value goes to sum[2 apart]. */
static inline void pl_sum_squares(PL_REAL *sum, size_t apart, PL_REAL value)
{
    const PL_REAL square = value * value, whole = sum[0] + square, part = whole - sum[0];
    sum[apart] += (sum[0] - (whole - part)) + (square - part);
    sum[0] = whole;
    sum[2 * apart] = value;
}

/* ---- root.c: lengths of steps --------------------------------------------------------------------------- */

/* Returns the n-th root of a within 6 %, the same bits on every target; a > 0 is a normal number, n >= 1. */
PL_REAL pl_root(PL_REAL a, int n);

/* ---- dense.c: linear equations -------------------------------------------------------------------------- */

/* Factors A, n x n, in place by Gaussian elimination with partial pivoting.  Returns 1, or 0 if A is singular or a
 * result is not finite.  Of a complex matrix the real and imaginary part of an entry are adjacent. */
int pl_factor(int n, PL_REAL *A, int *pivot);
int pl_factor_complex(int n, PL_REAL *A, int *pivot);

/* Replaces x, n entries, by A^-1 x; A and pivot are results of pl_factor, or pl_factor_complex. */
void pl_solve(int n, const PL_REAL *A, const int *pivot, PL_REAL *x);
void pl_solve_complex(int n, const PL_REAL *A, const int *pivot, PL_REAL *x);

/* ---- until.c: when a load changes ------------------------------------------------------------------------- */

/* Returns change - (t0 + k h) [s], rounded from a value whose error is below 2^-100 of the largest of change, t0 and
 * k h, in floats below 2^-45 (2^-46.5 measured over 9 10^5 arguments).  k may be up to 2^63. */
PL_REAL pl_until(PL_REAL t0, uint64_t k, pl_two h, pl_two change);

/* ---- peak.c: the largest size of an output --------------------------------------------------------------- */

/* Returns the larger of `peak` and the maximum of |row . x(tau)| on 0 <= tau <= h, where x' = A x starts from x, of
 * `size` entries, and `end` is row . x(h).  bend . |x| bounds the distance of row . x(tau) from its chord, which
 * settles most steps at once; otherwise every extremum of its Taylor polynomial is found.  *when: where it is above
 * `peak`, at which part of h.  Returns not a number if the output is not a number. */
PL_REAL pl_peak(int size, const PL_REAL *A, const PL_REAL *row, const PL_REAL *bend, PL_REAL h, const PL_REAL *x,
                PL_REAL end, PL_REAL peak, PL_REAL *when, PL_REAL *work);

/* Computes that bound, `size` entries: h^2/8 times the maximum of |row A^2 e^{A tau}| on 0 .. h, entry by entry. */
void pl_peak_bend(int size, const PL_REAL *A, const PL_REAL *row, PL_REAL h, PL_REAL *bend, PL_REAL *work);

/* The peak of an output that is known by its values alone, which the caller computes at the times asked for.  The step
 * is divided into 2, 4, ... PL_PEAK_TIMES parts, until second differences show that no value passes the peak, or that a
 * parabola represents the output between three of them; Brent's method then finds each maximum that may pass the peak.
 * Kinks and jumps only make it slower. */
#define PL_PEAK_TIMES 64
typedef struct pl_peak_values {
    PL_REAL peak, when;                /* largest size so far; its time in h, if it is of this step */
    PL_REAL value[PL_PEAK_TIMES + 1];
    PL_REAL at;                        /* time of the value asked for, in h */
    PL_REAL a, b, s[3], size[3];       /* a maximum is between a and b; the best three times there and their sizes */
    PL_REAL moved, before;
    int apart, time, top, tries;
} pl_peak_values;

/* Both return the time of the next value, 0 to 1 of the step, or a negative number once l->peak is final.  begin and
 * end are the values at both ends of the step; `value` is the value at the time returned last. */
PL_REAL pl_peak_begin(pl_peak_values *l, PL_REAL begin, PL_REAL end, PL_REAL peak);
PL_REAL pl_peak_next(pl_peak_values *l, PL_REAL value);

/* ---- apply.c: matrices times vectors ----------------------------------------------------------------------- */

/* Sets y, `rows` entries, to table x; table is rows x columns, x has `columns` entries, and y overlaps neither.
 * Without columns y is 0.  The order of summation is the same for all rows and sizes: four sums s_m over the columns m,
 * m + 4, m + 8, ..., m = 0 .. 3, then (s_0 + s_2) + (s_1 + s_3).  Without overflow and underflow the error of an entry
 * is below (columns/4 + 4) DBL_EPSILON/2 sum_j |a_j x_j|. */
void pl_multiply(int rows, int columns, const PL_REAL *table, const PL_REAL *x, PL_REAL *y);

/* Adds table x to y: each row is summed as above, then added. */
void pl_multiply_add(int rows, int columns, const PL_REAL *table, const PL_REAL *x, PL_REAL *y);

/* Returns PL_NOT_FINITE if one of the n entries of y is infinite or not a number, else 0.  It tests bits, so that a
 * compiler that assumes finite numbers cannot remove it, and raises no exception. */
int pl_not_finite(const PL_REAL *y, int n);

/* ---- crossings.c: piecewise-linear models ------------------------------------------------------------------- */

/* x' = A x with a constant A in each region.  x consists of the model's states, its load states (1, t, cos w t, ...)
 * and its inputs, so that nothing is approximated between two crossings.  A switching function e_i = row_i . x with
 * breakpoints b_i0 < b_i1 < ... is in interval 0 below b_i0, in interval 1 between b_i0 and b_i1, ...; the number of a
 * region is interval_0 + (breaks_0 + 1) (interval_1 + (breaks_1 + 1) (interval_2 + ...)).
 *
 * The rounding error of e at a breakpoint b is taken to be 8 DBL_EPSILON (sum_j |row_j x_j| + |b| + |change of e in the
 * time examined|).  Smaller excursions past b are ignored; all larger ones are found, whatever the step. */

/* Transfer matrices over parts of a step, for each linear system whose poles turn far in h.  Rung 0 is h / 2^halvings
 * long, each next one 2^spacing times as long, and h itself comes after the last one, which is shorter than h.  A step
 * takes the longest pieces that are event-free, so that slow motions are rounded few times. */
typedef struct pl_ladder {
    const int *first;   /* of each linear system the number of its rung 0 */
    const int *spacing; /* 1 .. 30 */
    /* size + 1 rows of `size` for each rung: x_i becomes row_i . x, or x_i + row_i . x where entry i of the last row is
     * 1 and not 0; row_i is then of e^{A d} - I, each entry rounded relative to itself. */
    const PL_REAL *pieces;
    /* In a piece of the next rung a switching or guard function leaves the chord through its ends by at most
     * reach . |x''(0)|.  For each linear system: rows of its rungs for the first function, for the second, ... */
    const PL_REAL *reach;
    const int *guard_rows; /* of each guard function the number of its first row of reach; read by pl_guards alone */
} pl_ladder;

/* Numbers that follow from params: these come first, then constants, then results of the operations. */
typedef struct pl_formulas {
    unsigned short params, constants;
    int operations;
    const pl_two *constant;
    const pl_operation *operation;
} pl_formulas;

/* A matrix of such numbers. */
typedef struct pl_entries {
    unsigned short rows, columns;
    int places;
    const pl_place *place; /* of the entries that are not 0 */
} pl_entries;

/* Regions whose matrices are made when they are met, and kept in slots: the number of a region's A is that of its slot.
 * A is that of the region with the lowest interval of each switching function, and what the interval of each adds. */
typedef struct pl_cached_guards {
    int most, holds;    /* guards, and assignments, of a region at most */
    /* Of the lowest region and of those beside it, as pl_guards has them of all; owner: of each assignment its
     * switching function.  A region has the guards of each switching function, and what it holds, in its interval. */
    const int *first;
    const pl_guard *guard;
    const PL_REAL *limit, *row, *amplitude;
    const int *hold, *set, *state, *owner;
    const PL_REAL *value;
    /* Of each slot, as pl_guards reads them; `most` guards and rows, two sets, `holds` assignments of each */
    int *count;
    pl_guard *own_guard;
    PL_REAL *own_limit, *own_row, *tangent, *chord_error, *cubic_error, *own_amplitude, *reach;
    int *own_set, *own_state;
    PL_REAL *own_value;
} pl_cached_guards;

typedef struct pl_cached {
    int (*matrix)(struct pl_cached *m, int region); /* pl_cached_matrix */
    int size, switches, slots;
    int rungs, most;    /* of a ladder; as for pl_region_of */
    int regions, first; /* in a segment of time; added to a region's number, which is region + regions segment */
    PL_REAL h;          /* step [s] */
    const int *breaks;  /* of each switching function */
    const PL_REAL *row; /* switches x size; in each segment */
    /* In each segment: A of the first region, then what interval 1, 2, ... of each switching function adds; the number
     * of an entry is that of its constant, in double-double [1/s]. */
    const pl_entries *sum;
    const pl_two *constant;
    pl_slot *slot;
    uint32_t *clock;
    /* Of each slot, as pl_switching has them of each matrix; rungs and rows of reach of one after the other */
    int *halvings, *spacing;
    PL_REAL *A, *Phi, *pieces, *tangent, *chord_error, *cubic_error, *reach;
    pl_two *work;       /* PL_CACHED_WORK(size, switches) entries */
    int pinned;         /* the slot in use, -1: none */
    const pl_cached_guards *guards; /* NULL: crossings alone */
} pl_cached;

typedef struct pl_switching {
    int size;           /* entries of x */
    PL_REAL h;          /* step [s] */
    int switches;       /* number of switching functions */
    const PL_REAL *row; /* switches x size: e = row . x */
    const int *breaks;  /* of each switching function the number of breakpoints, >= 1 */
    const PL_REAL *at;  /* the breakpoints: those of function 0, rising; those of function 1; ... */
    const int *matrix;  /* of each region the number of its A; -1: it cannot occur, and is passed in no time */
    /* The following are of each linear system.  The search for crossings takes pieces of d = h / 2^halvings or shorter.
     * Tables of switching functions are switches x size. */
    const int *halvings; /* 0 .. 30: |pole| d is about 1 or below */
    const PL_REAL *A;    /* size x size [1/s] */
    const PL_REAL *Phi;  /* e^{A h}: an event-free step */
    pl_ladder ladder;    /* shorter pieces; not read where halvings are 0 */
    const PL_REAL *tangent; /* d/3 row . A, so that tangent . x = d/3 e' */
    /* On 0 .. d, e leaves the chord through its ends by at most chord_error . |x(0)|, a bound of d^2/8 max|e''|, and
     * the cubic through its ends and slopes by at most cubic_error . |x(0)|, a bound of d^4/384 max|e''''|. */
    const PL_REAL *chord_error, *cubic_error;
    /* degree of Taylor polynomials of e^{A tau} on 0 .. d, >= 3: as for pl_series, lower where |pole| d is small */
    int degree;
    int max_events, max_splits; /* bounds per step: crossings; looks of the search at a polynomial */
    pl_cached *cached; /* NULL: all matrices are there; else `matrix` is not read */
} pl_switching;

typedef struct pl_crossing {
    PL_REAL time;                       /* [s] after the start of the step */
    int expression, breakpoint, upward; /* switching function, its breakpoint; 1: it rises through it, 0: it falls */
} pl_crossing;

/* Sets *c to the region of x, no crossings and status 0.  Exactly on a breakpoint the sign of e' decides, then of e'',
 * then of e'''; if all are 0 the lower interval is taken. */
void pl_switching_start(const pl_switching *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);

/* Advances x, `size` entries, over h, and lists its crossings, at most max_events, in order.  An event-free step is Phi
 * x to the last bit.  Load states may be set and inputs may jump before each step: a switching function that has left
 * its interval thereby passes its breakpoints at time 0.  work: PL_SWITCHING_WORK(size, switches, degree)
 *
 * Beyond max_events or max_splits c->status receives PL_TOO_MANY_EVENTS.  A last crossing is then passed but not
 * listed; event-free pieces go on; the first other piece takes e^{A d} of the region of x, with d at most h /
 * 2^halvings, so that no mode of another region grows by more than about e in it, and then x is held to the end of the
 * step.  The next step starts in the region of x.  An x that is not finite sets no bit: see pl_not_finite. */
void pl_switching_step(const pl_switching *m, PL_REAL *x, pl_contact *c, pl_crossing *crossing, PL_REAL *work);

/* Advances x over tau [s], 0 <= tau <= h, as pl_switching_step does over h. */
void pl_switching_advance(const pl_switching *m, PL_REAL tau, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                          PL_REAL *work);

/* The same functions for a double-double x: `size` high parts, then as many low parts.  m->A, m->Phi and the rungs,
 * here e^{A d} - I, are double-double too: of each matrix size x size high parts, then as many low parts. */
void pl_switching_compensated_start(const pl_switching *m, const PL_REAL *x, pl_contact *c, PL_REAL *work);
void pl_switching_compensated_step(const pl_switching *m, PL_REAL *x, pl_contact *c, pl_crossing *crossing,
                                   PL_REAL *work);
void pl_switching_compensated_advance(const pl_switching *m, PL_REAL tau, PL_REAL *x, pl_contact *c,
                                      pl_crossing *crossing, PL_REAL *work);

/* Advances x over dt [s], 0 <= dt <= h, by a Taylor polynomial of one of its linear systems, without a search. */
void pl_switching_compensated_move(const pl_switching *m, int matrix, int degree, PL_REAL dt, PL_REAL *x,
                                   PL_REAL *work);

/* Taylor series of models with switching functions e_i, each with breakpoints as above.  Their series are columns of
 * the coefficients c, (degree + 1) x columns, in powers of time.  Between two crossings the formulas are those of the
 * intervals, for which c is computed.  terms: of each function the sum of sizes of the terms of its value at the start,
 * which bounds its rounding error; as above, smaller excursions past a breakpoint are ignored. */
typedef struct pl_series_switching {
    int expressions, columns, degree;
    const int *column;  /* of each switching function */
    const int *breaks;  /* of each the number of breakpoints, >= 1 */
    const PL_REAL *at;  /* the breakpoints: those of function 0, rising; of function 1; ... */
} pl_series_switching;

/* Sets the interval of each switching function at the start; exactly on a breakpoint the first derivative that is not 0
 * decides, or if there is none it is the lower interval.  Returns 1 if an interval changed: compute c again; else 0. */
int pl_series_switching_place(const pl_series_switching *m, const PL_REAL *c, const PL_REAL *terms, int *interval);

/* A function that starts on the breakpoint above its interval, and by c, whose unit of time is the step, soon exceeds
 * it by more than rounding, is assigned to the interval above.  Returns 1 if there is one, else 0. */
int pl_series_switching_rises(const pl_series_switching *m, const PL_REAL *c, const PL_REAL *terms, int *interval);

/* Returns 1 if a switching function is outside its interval by more than rounding, else 0; *crossing receives which,
 * and the breakpoint.  On entry it is the last crossing, on whose breakpoint it may still be; expression -1: none. */
int pl_series_switching_left(const pl_series_switching *m, const PL_REAL *c, const PL_REAL *terms, const int *interval,
                             pl_crossing *crossing);

/* Returns the time, at most `end`, in the unit of time of c, when a switching function first leaves its interval, or -1
 * if none does.  The search steps over no root of a polynomial; *splits < 0 afterwards: it needed too many halvings. */
PL_REAL pl_series_switching_next(const pl_series_switching *m, const PL_REAL *c, const PL_REAL *terms,
                                 const int *interval, PL_REAL end, int *splits, pl_crossing *crossing, PL_REAL *work);

#include "events.h"

/* ---- crossings_d.c, guards_d.c, and those in two words: the same steps with derivatives beside x --------------- */

#include "saltation.h"

/* ---- retune.c: coefficients from other params --------------------------------------------------------------- */

/* Sets `made` to the results of all operations at these params, in double-double.  Returns 0; PL_SINGULAR if a divisor
 * is 0, perhaps within rounding; PL_NOT_FINITE if a param is infinite or not a number.
 *
 * The error of an operation is below 2^-103 (in floats 2^-45) of its result, of a sum or difference 2^-103 of the sizes
 * of both numbers; a difference that may be rounding alone is set to 0.  So the error of a sum of products is below
 * 2^-101 (in floats 2^-43) of the sum of sizes of its terms. */
int pl_formulas_at(const pl_formulas *f, const PL_REAL *params, pl_two *made);
/* slope <- their derivatives, where those of the params are `by` */
void pl_formulas_slope(const pl_formulas *f, const PL_REAL *params, const pl_two *made, const PL_REAL *by,
                       pl_two *slope);
/* The derivative of the number at a place */
PL_REAL pl_entries_slope(const pl_place *p, const pl_formulas *f, const PL_REAL *by, const pl_two *slope);

/* Sets `value` to the entries, rows x columns; of a matrix with columns for several segments of time to those of one:
 * of `loads` columns behind the first `before` in each segment, and those behind them all; rows from `before` on are
 * those of every segment.  Returns 0, or PL_NOT_FINITE if an entry is infinite or not a number. */
int pl_entries_at(const pl_entries *m, const pl_formulas *f, const PL_REAL *params, const pl_two *made, pl_two *value);
int pl_entries_in(const pl_entries *m, const pl_formulas *f, const PL_REAL *params, const pl_two *made, int before,
                  int loads, int segments, int segment, pl_two *value);

/* Sets D to the first `states` rows of e^{A tau} - I, tau in seconds.
 *     A      size x size [1/s]; the entries below row `states` and left of column `states` are 0: loads and inputs do
 *            not depend on the states
 *     D      states x size; the low parts are 0 where high parts are enough, unless `words` is 2
 *     work   PL_INCREMENT_WORK(size) entries
 * Returns 0, or PL_NOT_FINITE, also if |A| tau is above 2^64, or 2^32 in floats; D then has no meaning.  |A| is a norm
 * that does not depend on units, as a rule at most twice the largest pole or frequency of a load.  In the first
 * `states` columns the error of an entry is at most 16 units in the last place of the largest entry of them all, in any
 * other column of the largest in it, for |A| tau up to 2^20 and if that largest is above 2^-900; in floats up to 2^10
 * and above 2^-100. */
int pl_increment(int size, int states, const pl_two *A, PL_REAL tau, int words, pl_two *D, pl_two *work);

/* A ramp input has the column D_u for its value, `column`, and D_{u'} for its slope, the next one.  Its sample after
 * the step acts with D_{u'} / h, that before the step with D_u - D_{u'} / h.  Returns 1 if that difference cancels so
 * much that the high parts of D, states x size, are not enough, else 0. */
int pl_ramp_cancels(int size, int states, const pl_two *D, int column, PL_REAL h);

/* Returns that difference, whole - slope / h, rounded. */
PL_REAL pl_ramp_before(pl_two whole, pl_two slope, PL_REAL h);

/* ---- retune.h: coefficients of a step, independent block by independent block --------------------------------- */

/* An independent block of the equations: no other state acts on it.  x consists of its states and the load states and
 * inputs that act on it. */
typedef struct pl_block {
    pl_formulas formulas;
    pl_entries entries;           /* of A in x' = A x [1/s], with columns for load states in each segment of time */
    unsigned short states, loads, inputs; /* entries of x */
    unsigned short segments;      /* number of time segments, each with its formulas of loads */
    const unsigned short *place;  /* of each entry of x its place in x of the full model */
} pl_block;

/* Blocks of equal structure, whose factors of a step are one table of an instance. */
typedef struct pl_group {
    int blocks;
    const pl_block *block;
    const unsigned short *reads;  /* of each block the params that it reads, as bits */
    int samples;                  /* number of inputs that are interpolated between samples */
    const unsigned short *sample; /* the place of each in x, and how many of its derivatives follow there */
    /* of inputs with several samples: weights of the samples in h^m times derivative m */
    const PL_REAL *sample_weight;
    int down, across;             /* strides of the table of one block, by row and by column; 0 for several blocks */
    int entries, changing;        /* entries of each of several blocks, and in each time segment; of one: columns */
    const unsigned char *entry, *load; /* row and column of each entry */
} pl_group;

/* ---- region.c: a region of a piecewise-linear model from other params ------------------------------------------ */

/* Computes the tables of pl_switching for x' = A x, A size x size in double-double [1/s], h in seconds: *halvings, such
 * that no pole times h 2^-halvings is above 1; slopes and Phi = e^{A h}, each entry within 16 units in the last place
 * of the largest one; and the pieces of a ladder of at most `rungs` rungs, *spacing halvings apart.  Returns 0,
 * PL_NOT_FINITE, or PL_OUT_OF_RANGE for more halvings than `most`.  work: PL_REGION_WORK(size) entries */
int pl_region_of(int size, const pl_two *A, PL_REAL h, int most, int rungs, int *halvings, int *spacing,
                 PL_REAL *slopes, PL_REAL *Phi, PL_REAL *ladder, pl_two *work);

/* Returns `most` over the largest entry of Phi, or over 1; 0 if there are halvings: no event check covers h then. */
PL_REAL pl_region_large(int size, int halvings, const PL_REAL *Phi, PL_REAL most);

/* Computes for the functions row . x, rows x size, in such a region slope, second and fourth: tangent, chord_error and
 * cubic_error of pl_switching, with an allowance for their rounding.  work: PL_BOUNDS_WORK(size) entries */
void pl_region_bounds(int size, PL_REAL d, const PL_REAL *A, int rows, const PL_REAL *row, PL_REAL *slope,
                      PL_REAL *second, PL_REAL *fourth, PL_REAL *work);

/* Sets halvings and spacing as pl_region_of does.  v, next: work, `size` entries */
int pl_region_halvings(int size, const pl_two *A, PL_REAL h, int most, int rungs, int *halvings, int *spacing,
                       PL_REAL *v, PL_REAL *next);

/* Returns the slot in which the matrix of a region is.  If it is in none, it is made by these functions in the place of
 * the one used longest ago; the numbers do not depend on what was met before.  What is not finite there makes x so. */
int pl_cached_matrix(pl_cached *m, int region);

/* Computes reach of a ladder for the same functions: for each, that of all rungs but the first, and of h.
 * work: PL_REACH_WORK(size, rows) entries */
void pl_region_reach(int size, PL_REAL h, int halvings, int spacing, const PL_REAL *A, int rows, const PL_REAL *row,
                     PL_REAL *reach, PL_REAL *work);

/* ---- event_split.c: event-split steps of a scheme with a nonlinear remainder ------------------------------------- */

/* e^{A tau} of x' = A x for one tau. */
typedef struct pl_event_split {
    int size, terms; /* entries of x; terms of the series, or 0 if D is used */
    PL_REAL tau;     /* [s] */
    const PL_REAL *A, *D;
    PL_REAL *room;
} pl_event_split;

/* Sets up m: by the series, or if fastest tau > 2 by matrices that it computes.  Returns 0, or PL_NOT_FINITE, and m
 * then has no meaning.
 *     A        size x size [1/s]; it has to exist as long as m
 *     fastest  a bound of the poles of |A|, entry by entry [1/s]
 *     work     PL_EVENT_SPLIT_WORK(size) entries, which have to exist as long as m
 *     room     PL_EVENT_SPLIT_ROOM(size) entries, needed in this call alone */
int pl_event_split_begin(pl_event_split *m, int size, const PL_REAL *A, PL_REAL fastest, PL_REAL tau, PL_REAL *work,
                         pl_two *room);

/* Sets out to e^{A tau} x, or to e^{A tau / 2} x if half is not 0. */
void pl_event_split_flow(const pl_event_split *m, int half, const PL_REAL *x, PL_REAL *out);

/* ---- rate.c: frequencies from other params -------------------------------------------------------------------- */

/* Returns w / (2 pi) [Hz] for an angular frequency w >= 0 [rad/s], with a relative error below 2^-115, in floats 2^-86,
 * in addition to that of w. */
pl_rate pl_rate_of(pl_two w);

/* The lead of the phase of a sine over w t: its phase stays continuous when its frequency w is changed. */
typedef struct pl_lead {
    pl_phase phase;
    PL_REAL angle; /* the same angle [rad], from -pi to pi */
} pl_lead;

/* Changes w from `before` to `after` [rad/s] at time t [s]: adds (before - after) t to the lead, with a relative error
 * below 2^-115, in floats 2^-86, and another of 2^-129 cycles, in floats 2^-65: many or late changes do no harm. */
void pl_lead_change(pl_lead *lead, PL_REAL before, PL_REAL after, PL_REAL t);

/* ---- descriptor of a model ------------------------------------------------------------------------------- */

/* The table by which a program runs any model.  s points to the model's state, `size` bytes, aligned as a double or a
 * uint64_t; copying the bytes saves and restores it.  u is one sample of the `inputs` inputs, or NULL for none. */
typedef struct pl_model {
    int version;                  /* PL_MODEL_VERSION of the plrt.h that the model was compiled with */
    int real_size;                /* sizeof(double); in its place a pl_modelf says sizeof(float) */
    const char *name;
    size_t size;                  /* size of the state [bytes] */
    int states, inputs, outputs;
    PL_REAL h;                    /* step [s] */
    const char *const *state_names, *const *input_names, *const *output_names;
    void (*init)(void *s);        /* sets t = 0 and the spec's initial values */
    void (*set)(void *s, PL_REAL t, const PL_REAL *y); /* y: `states` entries */
    void (*get)(const void *s, PL_REAL *y);
    PL_REAL (*time)(const void *s);                  /* [s] */
    void (*step)(void *s, const PL_REAL *u);
    void (*out)(const void *s, PL_REAL *out);        /* out: `outputs` entries */
    void (*run)(void *s, size_t n, const PL_REAL *u, PL_REAL *out); /* n steps; n rows of u; n rows of out, or NULL */
    void (*at)(const void *s, const PL_REAL *u, PL_REAL tau, PL_REAL *y); /* 0 <= tau <= h; NULL where it has none */
    void (*jump)(void *s, uint64_t n); /* n steps at once; NULL where it has none */
    int (*status)(const void *s); /* 0 or a sum of PL_... bits */
    int params;                   /* number of tunable params */
    const char *const *param_names;
    const PL_REAL *param_values;  /* their values in the spec */
    int (*retune)(void *s, const PL_REAL *params, PL_REAL h); /* state and time stay; NULL: nothing is tunable */
    void (*hold)(void *s, const PL_REAL *u); /* the samples before the first step; NULL where no input is a ramp */
    /* Of each input the number of samples before the first step.  0: held, row k of a record acts from k h to (k + 1)
     * h; 1: a ramp, `hold` takes row 0, the sample at t = 0, and step k row k + 1, that at its end; m > 1: `hold` takes
     * rows 0 to m - 1 in turn, step k row k + m.  NULL if there are no inputs. */
    const int *start_samples;
} pl_model;

/* NAME_many, by which programs step instances of any model side by side by NAME_batch: tunable params differ. b is a
 * NAME_instances; y has `rows`, factors `factors` and peak, NULL where no output is one, `outputs` times `count`. */
typedef struct pl_many {
    size_t size;       /* of NAME_instances [bytes] */
    int rows, factors; /* numbers of an instance */
    void (*init)(void *b, size_t count, PL_REAL *y, PL_REAL *factors, PL_REAL *peak); /* t = 0, as the spec says */
    void (*hold)(void *b, const PL_REAL *u); /* the samples before the first step; NULL where no input is a ramp */
    int (*retune)(void *b, size_t j, const PL_REAL *params, PL_REAL *out); /* instance j; out: its outputs now */
    /* n steps; out: n x outputs x count, or NULL; sum: as NAME_kernel has it behind the first, or NULL */
    void (*run)(void *b, size_t n, const PL_REAL *u, PL_REAL *out, PL_REAL *sum);
    int (*status)(const void *b, size_t j);
    int shared; /* numbers of a row that NAME_batch_share writes for NAME_kernel */
    void (*share)(void *b, size_t n, const PL_REAL *u, PL_REAL *now);
} pl_many;

/* NAME_derivatives, of a model that has some: how large a struct NAME_d is, and what its columns are by.  J has a row
 * for each output, in it an entry for each column; du may be NULL; status: 0 or PL_D_... bits. */
typedef struct pl_derivatives {
    size_t size;
    int columns;
    const char *const *names;
    void (*init)(void *s, void *ds);        /* both to t = 0 */
    void (*step)(void *s, void *ds, const PL_REAL *u, const PL_REAL *du);
    void (*out)(const void *s, const void *ds, PL_REAL *J);
    void (*hold)(void *ds, const PL_REAL *du);  /* before the first step; NULL where no seed is a ramp */
    unsigned (*status)(const void *ds);
    /* Of a column by a param its value, in SI units, one of its own unit in them, and its range; 0, 0: it has none */
    const PL_REAL (*by)[4];
    /* NAME_gradient; w, ub may be NULL */
    size_t (*gradient)(const void *s, void *ds, size_t n, const PL_REAL *u, const PL_REAL *w, PL_REAL *lam,
                       PL_REAL *pb, PL_REAL *ub, void *snapshot, size_t snapshots);
    const pl_doubt *(*doubt)(const void *ds);
} pl_derivatives;
