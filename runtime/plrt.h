/* SPDX-License-Identifier: MIT-0 */
/* plrt.h: the runtime that every model made by plgen shares.
 *
 * Freestanding C99 (and C++17): no libm, no allocation, no recursion, no mutable globals, every loop bounded.
 * The caller owns all memory; nothing here fails, waits or prints.  Each piece stands alone, so the linker
 * takes only what a model uses:
 *
 *     turns.c     phases as 128-bit fractions of a turn, and their cosine and sine
 *     growth.c    exponents of growing and decaying loads as 128-bit numbers, and their powers
 *     series.c    x(tau) for 0 <= tau <= h: NAME_at
 *     power.c     the state n steps on in log n time: NAME_jump
 *     until.c     the time to a change of the loads
 *     apply.c     matrices times vectors, and whether all is finite: schemes with a leftover
 *     crossings.c steps of piecewise-linear models, with every crossing of a breakpoint found
 *     guards.c    the same with dry friction and jumps: events that each region has its own of
 *     crossings_kept.c, guards_kept.c
 *                 the same with what rounding takes from the state kept: --accuracy compensated
 *     retune.c    coefficients of a step from other params: NAME_retune
 *     cut.c       a part of a step: schemes with a leftover, from crossing to crossing
 *     rate.c      the rate of a load's phase from another frequency; phases that go on where one changes
 *     root.c      rough roots: the length of a step by its error
 *     dense.c     linear equations: Newton's method of implicit schemes
 *
 * turnsf.c, growthf.c, ... are the same for models in float, which never touch a double.  Their names end in f where
 * the others have pl_turn, pl_growth, ...: pl_turnf_at is to pl_turn_at as sinf is to sin.
 *
 * Compile it as the compiler comes: contraction to fused multiply-adds does no harm; flags that do are refused below.
 */
#ifndef PLRT_H
#define PLRT_H

#ifdef PL_BUNDLED /* they define its types where they are not there yet */
#error "plrt.h, or a header that includes it, goes before headers of bundles (plgen --bundle)"
#endif

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- what the arithmetic needs of the compiler --------------------------------------------------------------- */

/* y + (Phi - I) y as Phi y, or the error of a sum as 0: a compiler that takes additions for associative may read so. */
#if defined __FAST_MATH__ || defined __ASSOCIATIVE_MATH__ || defined __RECIPROCAL_MATH__ || defined _M_FP_FAST
#error "sums and quotients have to stay as they are written: compile it without -ffast-math, -Ofast, \
-funsafe-math-optimizations, -fassociative-math, -freciprocal-math, /fp:fast"
#endif

#if defined __cplusplus && __cplusplus >= 201103L
#define PL_ASSERT(condition, name, text) static_assert(condition, text)
#elif defined __STDC_VERSION__ && __STDC_VERSION__ >= 201112L
#define PL_ASSERT(condition, name, text) _Static_assert(condition, text)
#elif defined __GNUC__ && !defined __cplusplus && !defined _Static_assert /* a macro of glibc in C99: without words */
#define PL_ASSERT(condition, name, text) __extension__ _Static_assert(condition, text)
#else
#define PL_ASSERT(condition, name, text) extern char name[(condition) ? 1 : -1] /* `name` says what `text` does */
#endif

/* What this points at is reached in no other way. */
#if defined __GNUC__ || defined _MSC_VER
#define PL_RESTRICT __restrict
#elif defined __cplusplus
#define PL_RESTRICT
#else
#define PL_RESTRICT restrict
#endif

/* Compilers that know the flags but have no macro for them.  clang sees it when it optimizes, which is when it matters;
 * the function is empty otherwise. */
#if defined __clang__ && defined __OPTIMIZE__ && defined __has_attribute
#if __has_attribute(error)
void pl_refused_flag(void) __attribute__((error("sums have to stay as they are written: compile it without "
                                                "-funsafe-math-optimizations, -fassociative-math")));
__attribute__((used)) static void pl_look_at_flags(float a)
{
    if (__builtin_constant_p((a + 1.0f) - a)) {
        pl_refused_flag();
    }
}
#endif
#elif defined __GNUC__ && !defined __clang__ && __GNUC__ < 12
extern float pl_any_number;
PL_ASSERT(!__builtin_constant_p((pl_any_number + 1.0f) - pl_any_number),
          pl_refuses_fassociative_math_and_funsafe_math_optimizations,
          "sums have to stay as they are written: compile it without -funsafe-math-optimizations, -fassociative-math");
#endif

/* Code for float defines this before: no constant such as 1.0 occurs there, so what becomes of it does not matter. */
#ifndef PL_FLOAT_ONLY
PL_ASSERT(sizeof(1.0) == 8, pl_refuses_fsingle_precision_constant_and_doubles_of_32_bits,
          "1.0 has to be a double of 64 bits: compile it without -fsingle-precision-constant; where double has "
          "32 bits, make "
          "models with --real float, and leave out the files of the runtime for double");
#endif

/* 1: sums are kept in more bits than a double, or a float, has, so rounding is not what two-word arithmetic takes it
 * for */
#ifdef __FLT_EVAL_METHOD__
#define PL_EXCESS_PRECISION (__FLT_EVAL_METHOD__ < 0 || __FLT_EVAL_METHOD__ == 2 || __FLT_EVAL_METHOD__ > 64)
#define PL_EXCESS_PRECISIONF (__FLT_EVAL_METHOD__ != 0 && __FLT_EVAL_METHOD__ != 16 && __FLT_EVAL_METHOD__ != 32)
#else
#define PL_EXCESS_PRECISION 0 /* two.h asks <float.h> */
#define PL_EXCESS_PRECISIONF 0
#endif

/* ---- turns.c: phases ------------------------------------------------------------------------------------- */

/* An angle, in units of 2^-128 turn: (hi 2^64 + lo) 2^-128 turn.  It wraps as a phase should, so adding a step's
 * angle n times is as good as multiplying it by n: off by n 2^-129 turn, 2^-99 turn after 10^9 steps. */
typedef struct pl_turn {
    uint64_t hi, lo;
} pl_turn;

/* A frequency in turns per second [Hz]: (word[0] 2^128 + word[1] 2^64 + word[2]) 2^-exponent, with the top bit of
 * word[0] set, or all words 0. */
typedef struct pl_rate {
    uint64_t word[3];
    int exponent;
} pl_rate;

/* a + b mod 1 turn. */
static inline pl_turn pl_turn_add(pl_turn a, pl_turn b)
{
    pl_turn sum;
    sum.lo = a.lo + b.lo;
    sum.hi = a.hi + b.hi + (sum.lo < a.lo);
    return sum;
}

/* n a mod 1 turn, exactly. */
pl_turn pl_turn_times(pl_turn a, uint64_t n);

/* rate t mod 1 turn, t in seconds, any sign: the product is exact, then rounded once to 2^-128 turn.  The rate itself
 * is known to 192 bits, so beyond 2^64 turns the last bits of the angle are its rounding's, and beyond 2^192
 * turns nothing of the angle is known.  An infinite t, or not a number, gives 0. */
pl_turn pl_turn_at(const pl_rate *rate, double t);

/* z[0] = cos a, z[1] = sin a.  Off by less than 0.6 units in the last place (0.576 measured over 5 10^6 angles: 2^-53.8
 * at most), small angles included; exactly 0, 1 or -1 at quarter turns; mirror images about a quarter turn
 * agree to the last bit but for sign, and no zero is negative. */
void pl_cossin(pl_turn a, double z[2]);

/* What one pl_cossin costs: 19 multiplications of doubles and four products of 64-bit integers; 15 additions of
 * doubles, five conversions of integers to doubles, which take as long, and two additions of those integers. */
enum { PL_COSSIN_MUL = 23, PL_COSSIN_ADD = 22 };

/* ---- turnsf.c: phases of models in float ------------------------------------------------------------------- */

/* An angle in units of 2^-64 turn, which wraps as a phase should.  Adding a step's angle n times is off by n 2^-65
 * turn: 2^-35 turn after 10^9 steps. */
typedef uint64_t pl_turnf;

/* A frequency in turns per second [Hz], or another rate: (word[0] 2^64 + word[1]) 2^-exponent, with the top bit of
 * word[0] set, or both words 0. */
typedef struct pl_ratef {
    uint64_t word[2];
    int exponent;
} pl_ratef;

/* a + b mod 1 turn. */
static inline pl_turnf pl_turnf_add(pl_turnf a, pl_turnf b)
{
    return a + b;
}

/* n a mod 1 turn, exactly. */
pl_turnf pl_turnf_times(pl_turnf a, uint64_t n);

/* rate t mod 1 turn, t in seconds, any sign: the product is exact, then rounded once to 2^-64 turn.  The rate itself is
 * known to 128 bits, so beyond 2^64 turns the last bits of the angle are its rounding's, and beyond 2^128 turns nothing
 * of the angle is known.  An infinite t, or not a number, gives 0. */
pl_turnf pl_turnf_at(const pl_ratef *rate, float t);

/* z[0] = cos a, z[1] = sin a.  Off by less than 0.52 units in the last place (0.515 measured over 2 10^7 angles), small
 * angles included; exactly 0, 1 or -1 at quarter turns; mirror images about a quarter turn agree to the last bit but
 * for sign, and no zero is negative. */
void pl_cossinf(pl_turnf a, float z[2]);

/* What one pl_cossinf costs: twelve products of 32-bit integers and two multiplications of floats; ten additions of
 * integers. */
enum { PL_COSSINF_MUL = 14, PL_COSSINF_ADD = 10 };

/* ---- growth.c: exponential loads -------------------------------------------------------------------------- */

/* An exponent of 2, a t / ln 2 for e^{a t}: (hi 2^64 + lo) 2^-112, from -2^15 to just below 2^15.  What is beyond stays
 * at the end of this range, where the power has long been 0 or infinite.  Adding a step's exponent n times is as good
 * as multiplying it by n: the power is off by a factor of 1 + n 2^-113, 1 + 2^-83 after 10^9 steps. */
typedef struct pl_growth {
    int64_t hi;
    uint64_t lo;
} pl_growth;

/* The number that has these bits in two's complement. */
static inline int64_t pl_growth_signed(uint64_t bits)
{
    return bits >> 63 ? -(int64_t)~bits - 1 : (int64_t)bits;
}

/* a + b. */
static inline pl_growth pl_growth_add(pl_growth a, pl_growth b)
{
    const uint64_t x = (uint64_t)a.hi, y = (uint64_t)b.hi, lo = a.lo + b.lo, hi = x + y + (lo < a.lo);
    const int beyond = (int)((~(x ^ y) & (x ^ hi)) >> 63); /* equal signs, but not that of the sum */
    pl_growth sum;
    sum.hi = !beyond ? pl_growth_signed(hi) : a.hi < 0 ? INT64_MIN : INT64_MAX;
    sum.lo = !beyond ? lo : a.hi < 0 ? 0 : UINT64_MAX;
    return sum;
}

/* n a. */
pl_growth pl_growth_times(pl_growth a, uint64_t n);

/* rate t, or -rate t where `negative` is not 0; rate in powers of 2 per second, t in seconds, any sign: the product is
 * exact, then rounded once to 2^-112.  An infinite t counts as the largest finite one, and not a number as 0. */
pl_growth pl_growth_at(const pl_rate *rate, int negative, double t);

/* 2^a, off by less than 0.53 units in the last place (0.526 measured over 2 10^7 arguments; 0.508 where the result is
 * subnormal); exactly 2^k at an integer k; 0 from 2^-1075 down, infinite from 2^1024 up. */
double pl_growth_value(pl_growth a);

/* What one pl_growth_value costs: 14 multiplications of doubles and two products of 64-bit integers; nine additions of
 * doubles, a conversion of an integer to a double, which takes as long, and three additions of those integers. */
enum { PL_GROWTH_MUL = 16, PL_GROWTH_ADD = 13 };

/* ---- growthf.c: exponential loads of models in float -------------------------------------------------------- */

/* An exponent of 2, a t / ln 2 for e^{a t}, in units of 2^-48: from -2^15 to just below 2^15, where what is beyond
 * stays.  Adding a step's exponent n times is off by n 2^-49, and the power by a factor of 1 + n 2^-49: 1 + 2^-19 after
 * 10^9 steps. */
typedef int64_t pl_growthf;

/* a + b. */
static inline pl_growthf pl_growthf_add(pl_growthf a, pl_growthf b)
{
    if (b > 0 && a > INT64_MAX - b) {
        return INT64_MAX;
    }
    if (b < 0 && a < INT64_MIN - b) {
        return INT64_MIN;
    }
    return a + b;
}

/* n a. */
pl_growthf pl_growthf_times(pl_growthf a, uint64_t n);

/* rate t, or -rate t where `negative` is not 0; rate in powers of 2 per second, t in seconds, any sign: the product is
 * exact, then rounded once to 2^-48.  An infinite t counts as the largest finite one, and not a number as 0. */
pl_growthf pl_growthf_at(const pl_ratef *rate, int negative, float t);

/* 2^a, off by less than 0.52 units in the last place (0.513 measured over 2 10^7 arguments), subnormal results
 * included; exactly 2^k at an integer k; 0 from 2^-150 down, infinite from 2^128 up. */
float pl_growthf_value(pl_growthf a);

/* What one pl_growthf_value costs: seven products of 32-bit integers and nine additions of integers; no floats. */
enum { PL_GROWTHF_MUL = 7, PL_GROWTHF_ADD = 9 };

/* ---- series.c: between two steps ------------------------------------------------------------------------- */

/* x' = A x, to be advanced by a Taylor polynomial of e^{A tau} on 2^halvings equal parts of tau.  The generator chooses
 * degree and halvings for 0 <= tau <= h.  With |pole| h / 2^halvings <= 1 for every
 * pole, those of loads included, and degree 15 + d, d the longest way from one entry to another along nonzero entries
 * of A, the error of x_i stays below 8 DBL_EPSILON sum_j most_ij |x_j|, most_ij the largest |Phi_ij| of e^{A tau} on 0
 * .. h (measured for |pole| h up to 8: 7.4 in 200 damped and undamped chains, half of them below 1.7). */
typedef struct pl_series {
    int size;        /* entries of x */
    int states;      /* of which the first are the model's own states; the others carry loads and inputs */
    int degree;      /* of the Taylor polynomial, >= 1 */
    int halvings;    /* 0 .. 30 */
    const double *A; /* size x size, row-major, [1/s] */
} pl_series;

/* x <- e^{A tau} x, tau in seconds; all `size` entries.  work: 2 size doubles, contents of no meaning. */
void pl_series_advance(const pl_series *p, double tau, double *x, double *work);

/* The same for floats: with degree 8 + d the error stays below 8 FLT_EPSILON sum_j most_ij |x_j| (measured for |pole| h
 * up to 8: 6.7 in eleven damped and undamped chains). */
typedef struct pl_seriesf {
    int size, states, degree, halvings;
    const float *A;
} pl_seriesf;

void pl_seriesf_advance(const pl_seriesf *p, float tau, float *x, float *work);

/* ---- power.c: many steps at once ------------------------------------------------------------------------- */

/* A number in two words: the unevaluated sum hi + lo, |lo| <= half a unit in the last place of hi (106 bits). */
typedef struct pl_two {
    double hi, lo;
} pl_two;

/* x <- P^k x by binary powering in two-word arithmetic; P is n x n, row-major.  The relative error is about k 2^-104.
 *     P     destroyed
 *     x     n entries, in and out; k = 0 leaves them as they are
 *     W, w  work: n x n and n entries
 * A result beyond the range of double is an infinity with lo = 0; no NaN comes out of finite arguments.  Once an entry
 * of a power of P has itself overflowed, what it reaches is infinite, and its sign means nothing. */
void pl_power_apply(int n, pl_two *P, pl_two *W, pl_two *x, pl_two *w, uint64_t k);

/* The same in floats: 48 bits, and the relative error is about k 2^-46.  A term below 2^-102 loses bits of its low word
 * to underflow. */
typedef struct pl_twof {
    float hi, lo;
} pl_twof;

void pl_powerf_apply(int n, pl_twof *P, pl_twof *W, pl_twof *x, pl_twof *w, uint64_t k);

/* ---- sums whose rounding is kept: the forms of --accuracy compensated ------------------------------------------ */

/* sum + term + (small + *rest), rounded; *rest becomes what that rounding took.  The first sum's error is exact
 * (Knuth's TwoSum: no condition on sizes); `small` and *rest, of the size of roundings, are added to it and not to
 * `term`, where they would be lost. */
static inline double pl_accumulate(double sum, double term, double small, double *rest)
{
    const double whole = sum + term, part = whole - sum;
    const double error = ((sum - (whole - part)) + (term - part)) + (small + *rest), result = whole + error;
    *rest = error - (result - whole);
    return result;
}
static inline float pl_accumulatef(float sum, float term, float small, float *rest)
{
    const float whole = sum + term, part = whole - sum;
    const float error = ((sum - (whole - part)) + (term - part)) + (small + *rest), result = whole + error;
    *rest = error - (result - whole);
    return result;
}
enum { PL_ACCUMULATE_ADD = 11 };

/* ---- root.c: lengths of steps --------------------------------------------------------------------------- */

/* The n-th root of a, a normal number above 0, n >= 1, within 6 %: without pow, and the same bits on every target. */
double pl_root(double a, int n);
float pl_rootf(float a, int n);

/* ---- dense.c: linear equations -------------------------------------------------------------------------- */

/* A, n x n, row-major, by Gauss' elimination with partial pivoting, in place: 1, or 0 where it is singular or not a
 * number comes out.  Complex: real and imaginary part side by side. */
int pl_factor(int n, double *A, int *pivot);
int pl_factor_complex(int n, double *A, int *pivot);
/* x <- A^-1 x, A and pivot as the other has left them. */
void pl_solve(int n, const double *A, const int *pivot, double *x);
void pl_solve_complex(int n, const double *A, const int *pivot, double *x);
int pl_factorf(int n, float *A, int *pivot);
int pl_factorf_complex(int n, float *A, int *pivot);
void pl_solvef(int n, const float *A, const int *pivot, float *x);
void pl_solvef_complex(int n, const float *A, const int *pivot, float *x);

/* ---- until.c: when a load changes ------------------------------------------------------------------------- */

/* change - (t0 + k h) [s], off by less than 2^-100 of the largest of change, t0 and k h, and rounded: so a change
 * inside a step is met where it is, however late the step.  k counts in full up to 2^63. */
double pl_until(double t0, uint64_t k, pl_two h, pl_two change);

/* The same in floats, off by less than 2^-45 of the largest (2^-46.5 measured over 9 10^5). */
float pl_untilf(float t0, uint64_t k, pl_twof h, pl_twof change);

/* ---- peak.c: the largest size of an output --------------------------------------------------------------- */

enum { PL_PEAK_SPACE = 6 };
#define PL_PEAK_WORK(size) (PL_PEAK_SPACE * (size)) /* reals that these work in */

/* The larger of `peak` and |row . x(tau)|, 0 <= tau <= h, where x' = A x from x on, of `size` entries, and row . x(h)
 * is known to be `end`.  bend . |x| bounds how far row . x(tau) is off its chord, so most steps are clear at once; else
 * every extreme of its Taylor polynomial is found.  Not a number once the output is none. */
double pl_peak(int size, const double *A, const double *row, const double *bend, double h, const double *x, double end,
               double peak, double *work);
float pl_peakf(int size, const float *A, const float *row, const float *bend, float h, const float *x, float end,
               float peak, float *work);

/* That bound: h^2/8 times what |row A^2 e^{A tau}| is at most, entry by entry */
void pl_peak_bend(int size, const double *A, const double *row, double h, double *bend, double *work);
void pl_peakf_bend(int size, const float *A, const float *row, float h, float *bend, float *work);

/* ---- apply.c: matrices times vectors ----------------------------------------------------------------------- */

/* y = table x; table is rows x columns, row-major; x has `columns` entries, y `rows`.  y overlaps neither x nor table.
 * Without columns y is 0.  Each row is summed in one order, whatever the sizes and the row's place: four sums, of the
 * columns m, m + 4, m + 8, ... upwards from 0 for m = 0 .. 3, then (s_0 + s_2) + (s_1 + s_3).  Off by less than
 * (columns/4 + 4) DBL_EPSILON/2 sum_j |a_j x_j| where nothing overflows or underflows. */
void pl_multiply(int rows, int columns, const double *table, const double *x, double *y);

/* y += table x: that sum of each row first, then y and it. */
void pl_multiply_add(int rows, int columns, const double *table, const double *x, double *y);

/* What the status of a model says: 0, or */
enum { PL_TOO_MANY_STEPS = 4, PL_INACCURATE = 8 }; /* of steps by series: more substeps within h than allowed, and the
                                                    * state is the last good one; last terms above the tolerance */
enum { PL_LEFT_RANGE = 32 }; /* at the end of a step a state was outside of the range that the spec gives it */
enum { PL_NOT_FINITE = 1 }; /* a step has left the finite numbers: of linear models, while it shows in the state */

/* PL_NOT_FINITE if an entry of y is infinite or not a number, else 0; n entries.  By their bits: no compiler that takes
 * all numbers for finite can leave it out, and it raises no exception. */
int pl_not_finite(const double *y, int n);

/* The same for floats; with FLT_EPSILON. */
void pl_multiplyf(int rows, int columns, const float *table, const float *x, float *y);
void pl_multiplyf_add(int rows, int columns, const float *table, const float *x, float *y);
int pl_not_finitef(const float *y, int n);

/* |a| */
static inline double pl_magnitude(double a)
{
#ifdef __GNUC__
    return __builtin_fabs(a);
#else
    return a < 0.0 ? -a : a;
#endif
}
static inline float pl_magnitudef(float a)
{
#ifdef __GNUC__
    return __builtin_fabsf(a);
#else
    return a < 0 ? -a : a;
#endif
}

/* Of a function that is called rarely: apart from its caller, which is not to keep registers for it */
#ifdef __GNUC__
#define PL_APART __attribute__((noinline))
#else
#define PL_APART
#endif

/* Of a function that is a part of its caller, in which its arguments are numbers */
#ifdef __GNUC__
#define PL_INLINE inline __attribute__((always_inline))
#else
#define PL_INLINE inline
#endif

/* Whether a sum is shorter and hardly slower as a call: code is to be small, or products of doubles are calls, too. A
 * function that is rare where that is not so, is written out where it is. */
#if defined __OPTIMIZE_SIZE__ || (defined __arm__ && !(defined __ARM_FP && (__ARM_FP & 8)))
#define PL_SOFT 1
#define PL_APART_HARD
#else
#define PL_SOFT 0
#define PL_APART_HARD PL_APART
#endif

/* The loop that follows is of constant length, and is written out unless code is to be small. */
#if defined __OPTIMIZE_SIZE__
#define PL_UNROLL
#elif defined __clang__
#define PL_UNROLL _Pragma("clang loop unroll(full)")
#elif defined __GNUC__ && __GNUC__ >= 8
#define PL_UNROLL _Pragma("GCC unroll 16")
#else
#define PL_UNROLL
#endif

/* No array is empty. */
#define PL_ROOM(n) ((n) > 0 ? (n) : 1)

/* ---- crossings.c: piecewise-linear models ------------------------------------------------------------------- */

/* x' = A x with another constant A in each region.  x holds the model's own states, then what carries its loads (1, t,
 * cos w t,
 * ...) and inputs, so that between two crossings nothing is approximated.  Switching expressions e_i = row_i . x, each
 * with breakpoints b_i0 < b_i1 < ..., are in interval 0 below b_i0, in 1 between b_i0 and b_i1, ...; a region is one
 * interval for each expression, its number interval_0 + (breaks_0 + 1) (interval_1 + (breaks_1 + 1) (interval_2 +
 * ...)).
 *
 * A rounding error of e against a breakpoint b is taken to be 8 DBL_EPSILON (sum_j |row_j x_j| + |b| + how far e moves
 * in the time looked at).  What passes b by less is no crossing; what passes by more is found, whatever the step. */
/* Of each matrix whose poles turn far in h: the lengths that pieces of a step have, rung by rung.  Rung 0 is as short
 * as h / 2^halvings, the next ones are 2^spacing times as long each, and beyond the last of them, which is shorter than
 * h, comes h itself.  A step goes by the longest that are seen to stay clear, so that few pieces round what is slow. */
typedef struct pl_ladder {
    const int *first;   /* the number of its rung 0 among those of all */
    const int *spacing; /* 1 .. 30 */
    /* Of each rung size + 1 rows of `size`: x_i goes on to row_i . x, and where the last row has 1 at i, not 0, x_i is
     * added: there row_i is of e^{A d} - I, each entry rounded relative to itself. */
    const double *pieces;
    /* In a piece of the rung after this one an expression, or a row of guards, is off the chord through its ends by at
     * most reach . |x''(0)|: of each matrix its rungs for the first expression, for the second; ... */
    const double *reach;
    const int *gates;   /* of each row of guards: the number of the first of its rows of reach; else not read */
} pl_ladder;

typedef struct pl_switching {
    int size;           /* entries of x */
    double h;           /* step [s] */
    int switches;       /* expressions */
    const double *row;  /* switches x size: e = row . x */
    const int *breaks;  /* of each switch: how many breakpoints, >= 1 */
    const double *at;   /* the breakpoints: those of switch 0, rising; those of switch 1; ... */
    const int *matrix;  /* of each region: the number of its A; -1: cannot occur, and passed through in no time */
    /* Of each matrix: crossings are looked for in pieces d = h / 2^halvings or shorter.  Tables for switches are
     * switches x size. */
    const int *halvings; /* 0 .. 30: |pole| d is about 1 or below */
    const double *A;     /* size x size, row-major [1/s] */
    const double *Phi;   /* e^{A h}: the step where nothing is crossed */
    pl_ladder ladder;    /* shorter pieces; not read where halvings are 0 */
    const double *tangent; /* d/3 row . A, so that tangent . x = d/3 e' */
    /* On 0 .. d, e is off the chord through its ends by at most chord_error . |x(0)|: d^2/8 max|e''|, and off the cubic
     * through its ends with its slopes there by at most cubic_error . |x(0)|: d^4/384 max|e''''| */
    const double *chord_error, *cubic_error;
    /* of Taylor polynomials of e^{A tau} on 0 .. d, >= 3: as for pl_series, less where |pole| d is small */
    int degree;
    int max_events, max_splits; /* per step: crossings, and halvings of an interval in search of them */
} pl_switching;

typedef struct pl_crossing {
    double time;                       /* after the start of the step [s] */
    int expression, breakpoint, upward; /* upward: e rises through it */
} pl_crossing;

/* What a model's state keeps. */
typedef struct pl_contact {
    uint64_t total; /* crossings since the start */
    int crossings;  /* in the last step; the first max_events of them are listed */
    int region;
    int matrix;     /* in use: that of the region, or where it cannot occur that of the one before */
    int status;     /* 0 or PL_TOO_MANY_EVENTS, sticky until the next start */
    int rested;     /* contacts that came to rest by infinitely many bounces since the start */
} pl_contact;

/* a step has met more crossings, or needed more splits, than its bound: chatter, as a rule */
enum { PL_TOO_MANY_EVENTS = 2 };

/* How many doubles, or floats, of work the functions below need; contents of no meaning. */
#define PL_SWITCHING_WORK(size, switches, degree) (((degree) + 1) * ((size) + 2) + 5 * (size) + 5 * (switches))

/* The region of x, no crossings, status 0.  Exactly on a breakpoint the sign of e' decides, then of e'', then of e''';
 * what rests there counts as below. */
void pl_switching_start(const pl_switching *m, const double *x, pl_contact *c, double *work);

/* x over h, with every crossing on the way, in order.  A step that is seen to have none is Phi x, to the last bit.
 *     x         `size` entries, in and out.  Loads may be set anew before each step, and inputs may jump: an expression
 * that has left its interval by that passes its breakpoints at time 0 crossing  max_events entries work
 * PL_SWITCHING_WORK(size, switches, degree) Beyond max_events or max_splits: PL_TOO_MANY_EVENTS.  Then a last crossing
 * is passed but not listed; pieces that are seen to stay clear go on as ever; the first other one goes by e^{A d} of
 * the region where x is, without looking, d = h / 2^halvings or what is left, and behind it x is held to the end of the
 * step.  As |pole| d is about 1 or below, no mode has grown by more than about e where its region was not the true one;
 * from there on x is off by at most how far the true motion goes.  The next step starts in the region of x.  An x that
 * is not finite sets no bit here: ask pl_not_finite. */
void pl_switching_step(const pl_switching *m, double *x, pl_contact *c, pl_crossing *crossing, double *work);

/* The same over tau, 0 <= tau <= h. */
void pl_switching_advance(const pl_switching *m, double tau, double *x, pl_contact *c, pl_crossing *crossing,
                          double *work);

/* The same with what rounding takes from x kept: x is `size` entries and then their rests, so that x + rest is what is
 * meant.  m->A, m->Phi and the rungs, which are e^{A d} - I, have two words: of each size x size first ones and then as
 * many second ones.  Of what a piece adds rounding takes a unit in the last place or a few; crossings are those of
 * x. */
#define PL_SWITCHING_KEPT_WORK(size, switches, degree) (PL_SWITCHING_WORK(size, switches, degree) + 2 * (size))
void pl_switching_kept_start(const pl_switching *m, const double *x, pl_contact *c, double *work);
void pl_switching_kept_step(const pl_switching *m, double *x, pl_contact *c, pl_crossing *crossing, double *work);
void pl_switching_kept_advance(const pl_switching *m, double tau, double *x, pl_contact *c, pl_crossing *crossing,
                               double *work);
/* x on by dt, 0 <= dt <= h, with one of its matrices by a Taylor polynomial of this degree, whatever it passes. */
void pl_switching_kept_move(const pl_switching *m, int matrix, int degree, double dt, double *x, double *work);

/* The same for floats; rounding errors are taken to be 8 FLT_EPSILON (...).  A pl_contact serves both. */
typedef struct pl_ladderf {
    const int *first, *spacing;
    const float *pieces, *reach;
    const int *gates;
} pl_ladderf;

typedef struct pl_switchingf {
    int size;
    float h;
    int switches;
    const float *row;
    const int *breaks;
    const float *at;
    const int *matrix, *halvings;
    const float *A, *Phi;
    pl_ladderf ladder;
    const float *tangent, *chord_error, *cubic_error;
    int degree, max_events, max_splits;
} pl_switchingf;

typedef struct pl_crossingf {
    float time;
    int expression, breakpoint, upward;
} pl_crossingf;

void pl_switchingf_start(const pl_switchingf *m, const float *x, pl_contact *c, float *work);
void pl_switchingf_step(const pl_switchingf *m, float *x, pl_contact *c, pl_crossingf *crossing, float *work);
void pl_switchingf_advance(const pl_switchingf *m, float tau, float *x, pl_contact *c, pl_crossingf *crossing,
                           float *work);
void pl_switchingf_kept_start(const pl_switchingf *m, const float *x, pl_contact *c, float *work);
void pl_switchingf_kept_step(const pl_switchingf *m, float *x, pl_contact *c, pl_crossingf *crossing, float *work);
void pl_switchingf_kept_advance(const pl_switchingf *m, float tau, float *x, pl_contact *c, pl_crossingf *crossing,
                                float *work);
void pl_switchingf_kept_move(const pl_switchingf *m, int matrix, int degree, float dt, float *x, float *work);

/* Formulas that the state chooses beside a Taylor series: expressions e_i, each with breakpoints as above, whose series
 * stand in columns of its coefficients c, (degree + 1) x columns, in powers of time.  Between two crossings the
 * formulas are those of the intervals; c is made with them.  terms: of each expression the sizes of what its value at
 * the start is summed from, which bound what rounding may have done to it; as above what passes b by less is no
 * crossing. */
typedef struct pl_divided {
    int expressions, columns, degree;
    const int *column;  /* of each expression */
    const int *breaks;  /* of each how many breakpoints, >= 1 */
    const double *at;   /* those of expression 0, rising; of expression 1; ... */
} pl_divided;

/* How many doubles, or floats, of work pl_divided_next needs */
#define PL_DIVIDED_WORK(degree) (2 * ((degree) < 3 ? 4 : (degree) + 1))

/* The interval of each expression at the start, exactly on a breakpoint by the first derivative that is not 0; what
 * rests there counts as below.  1: some are others than before, and c may be another one. */
int pl_divided_place(const pl_divided *m, const double *c, const double *terms, int *interval);

/* What starts on the breakpoint above its interval and soon is beyond it by more than rounding, along c of which the
 * unit of time is the step, goes there: 1, some does */
int pl_divided_rises(const pl_divided *m, const double *c, const double *terms, int *interval);

/* Whether an expression is outside of its interval by more than rounding: crossing receives which, and where; before
 * that the last crossing, expression -1: none, which need not be left behind yet. */
int pl_divided_left(const pl_divided *m, const double *c, const double *terms, const int *interval,
                    pl_crossing *crossing);

/* When, until `end`, in the unit of time of c, an expression first leaves its interval; -1: none does.  Searched as
 * above: no root of a polynomial is stepped over; *splits < 0 afterwards: it took too many halvings. */
double pl_divided_next(const pl_divided *m, const double *c, const double *terms, const int *interval, double end,
                       int *splits, pl_crossing *crossing, double *work);

typedef struct pl_dividedf {
    int expressions, columns, degree;
    const int *column, *breaks;
    const float *at;
} pl_dividedf;

int pl_dividedf_place(const pl_dividedf *m, const float *c, const float *terms, int *interval);
int pl_dividedf_rises(const pl_dividedf *m, const float *c, const float *terms, int *interval);
int pl_dividedf_left(const pl_dividedf *m, const float *c, const float *terms, const int *interval,
                     pl_crossingf *crossing);
float pl_dividedf_next(const pl_dividedf *m, const float *c, const float *terms, const int *interval, float end,
                       int *splits, pl_crossingf *crossing, float *work);

/* ---- events.c: impacts, contacts at rest and dry friction beside a Taylor series ------------------------------- */

/* As pl_divided; an expression may have the same breakpoint twice, and in the interval between it is held: by friction
 * that sticks, by a contact at rest.  Beside the expressions stand watches, columns of c too, of which each has its
 * entry of terms behind those of the expressions: velocities, what would let go, what a state is after a jump. */
typedef struct pl_hold {
    int expression, interval; /* held there */
    int velocity;             /* a watch: kept at 0 */
    int down, up;             /* watches: beyond 0 it is let go to the interval below, above; -1: it is not */
    int strike;               /* the impact whose contact rests; -1: friction sticks */
} pl_hold;

/* An impact, where an expression passes a breakpoint.  One with a hold is a bounce: it turns the speed of its guard, s
 * to -restitution s. */
typedef struct pl_strike {
    int expression, breakpoint, upward;
    int hold;               /* in which its contact rests; -1: it is no bounce */
    int place, speed;       /* watches: how far the guard is beyond 0, its rate */
    int jump, still, jumps; /* assignments, so many from there on: its own; those with restitution 0 */
    double restitution;
    double per; /* of the expression for a guard of 1 */
} pl_strike;

/* Holds that cannot be all at once, as bits.  Of friction of what a contact at rest holds: it brakes what presses
 * there, and while it does not stick slips to that side, 1 or -1 interval on, whatever its velocity is. */
typedef struct pl_conflict {
    uint32_t set;
    int hold, side; /* that friction; -1: it is others */
} pl_conflict;

typedef struct pl_events {
    const pl_divided *divided;
    int states;
    const int *watch; /* the column of each */
    int holds;        /* at most 32 */
    const pl_hold *hold;
    const double *back; /* holds x states: what is taken from a state for a velocity of 1 */
    int strikes;        /* at most 32, in the order in which they act at one instant */
    const pl_strike *strike;
    const double *place_back; /* strikes x states: likewise for a guard of 1 */
    const int *state, *value; /* assignments: a state is set to a watch */
    int conflicts;
    const pl_conflict *conflict;
    double h;                 /* step [s], the unit of time of c */
    int max_events;
} pl_events;

/* Impacts that follow each other in a step.  last: when the last one was; most: the fastest of those that follow each
 * other in no time to speak of, close: so many they are; least: a speed that is but rounding of forces over a step;
 * impacts: at this instant, acting: those that acted of late, as bits, ended: how often they were ended; all: events of
 * the step; full: there is no more room */
typedef struct pl_chain {
    double last, most, least;
    uint32_t acting;
    int close, impacts, ended, all, full;
} pl_chain;

/* Where a series begins, and how it is made anew. */
typedef struct pl_instant {
    void (*expand)(const void *from, const int *interval, const double *y, double *c, double *terms);
    const void *from;
    double *y, *rest;   /* the states, what rounding took from them; one that is set has no rest */
    double *c, *terms;
    double *work;       /* PL_DIVIDED_WORK */
    int *interval;      /* of each expression */
    uint64_t *total;    /* crossings */
    int *crossings;     /* in this step */
    int *rested;        /* contacts that came to rest by infinitely many bounces */
    pl_crossing *crossing, *last;
    double time;        /* after the start of the step [s] */
    pl_crossing next;   /* the event that pl_events_next has found, */
    int strike, freed;  /* the impact that begins there, the hold that lets go; -1: none */
    int status;         /* 0, PL_UNDECIDED, PL_TOO_MANY_EVENTS, PL_PENETRATED */
    pl_chain chain;     /* none yet: last is -h, else 0 */
} pl_instant;

/* The intervals of a state that was set.  What is on a breakpoint that stands twice is held where that can be, else
 * goes where it is heading. */
void pl_events_place(const pl_events *m, pl_instant *at);

/* The series from here.  1: an expression or what is held has left its interval, and that has been passed; -1: there
 * were too many; 0: neither.  What is held and has moved by rounding is put back. */
int pl_events_begin(const pl_events *m, pl_instant *at);

/* When, until `end`, the first event comes, as pl_divided_next; size, in and out: how far the series goes without one,
 * shorter behind a bounce that comes back soon. */
double pl_events_next(const pl_events *m, pl_instant *at, double *size, int *splits);

/* That event: at->y is the state there.  0: there were too many.  Several at one instant as pl_guards_step says. */
int pl_events_pass(const pl_events *m, pl_instant *at);

/* How far the series at->c, which is made, serves without an event, at most until `end`; 0: not even from here */
double pl_events_end(const pl_events *m, pl_instant *at, double end, int *splits);

/* PL_PENETRATED where the series is beyond the guard of a bounce by more than rounding, s [h] on; else 0 */
int pl_events_places(const pl_events *m, const pl_instant *at, double s);

typedef struct pl_strikef {
    int expression, breakpoint, upward;
    int hold, place, speed, jump, still, jumps;
    float restitution, per;
} pl_strikef;

typedef struct pl_eventsf {
    const pl_dividedf *divided;
    int states;
    const int *watch;
    int holds;
    const pl_hold *hold;
    const float *back;
    int strikes;
    const pl_strikef *strike;
    const float *place_back;
    const int *state, *value;
    int conflicts;
    const pl_conflict *conflict;
    float h;
    int max_events;
} pl_eventsf;

typedef struct pl_chainf {
    float last, most, least;
    uint32_t acting;
    int close, impacts, ended, all, full;
} pl_chainf;

typedef struct pl_instantf {
    void (*expand)(const void *from, const int *interval, const float *y, float *c, float *terms);
    const void *from;
    float *y, *rest, *c, *terms, *work;
    int *interval;
    uint64_t *total;
    int *crossings, *rested;
    pl_crossingf *crossing, *last;
    float time;
    pl_crossingf next;
    int strike, freed, status;
    pl_chainf chain;
} pl_instantf;

void pl_eventsf_place(const pl_eventsf *m, pl_instantf *at);
int pl_eventsf_begin(const pl_eventsf *m, pl_instantf *at);
float pl_eventsf_next(const pl_eventsf *m, pl_instantf *at, float *size, int *splits);
int pl_eventsf_pass(const pl_eventsf *m, pl_instantf *at);
float pl_eventsf_end(const pl_eventsf *m, pl_instantf *at, float end, int *splits);
int pl_eventsf_places(const pl_eventsf *m, const pl_instantf *at, float s);

/* ---- guards.c: piecewise-linear models whose velocity is held at times, and that jump -------------------------- */

/* As pl_switching, with events of their own in each region.  x' = A x; a guard is a row that must not become greater
 * than its limit: where it does, x jumps, and goes on in another region.  An expression may have the same breakpoint
 * twice: in the interval between it is held there, as by friction that sticks, and states that follow from others are
 * set from them, exactly: x_i = row . x. */
typedef struct pl_guard {
    int row;                              /* among those of guards */
    int expression, breakpoint, upward;   /* as a crossing of it is listed */
    int leads;                            /* to the region of this number, less that where it stands */
    int impact;                           /* that begins there, by its number; -1: none */
} pl_guard;

/* The state jumps where the guard comes true.  One that turns the speed of its guard, s to -restitution s, is a bounce;
 * its contact may rest, in the interval between two equal breakpoints. */
typedef struct pl_impact {
    int expression, breakpoint, upward; /* as a crossing of it is listed */
    int rest;                           /* that interval; -1: it is no bounce */
    int jump, still;                    /* sets of assignments: its jump; of a bounce that with restitution 0 */
    double restitution;
    double play;                        /* the sizes of the factors of cos and sin in its speed */
} pl_impact;

typedef struct pl_guards {
    int size;          /* entries of x */
    double h;          /* step [s] */
    int switches;      /* expressions */
    const double *row; /* switches x size: e = row . x */
    const int *breaks; /* of each expression: how many breakpoints */
    const double *at;  /* the breakpoints: those of the first, not falling; those of the second; ... */
    const int *matrix; /* of each region: the number of its A; -1: it cannot be */
    /* Of each matrix, as for pl_switching: */
    const int *halvings;
    const double *A, *Phi;
    pl_ladder ladder;
    const double *tangent; /* switches x size */
    /* Of each region: its guards are guard[first[region]] to guard[first[region + 1] - 1]; hold is the set of
     * assignments that holds its states, or -1 */
    const int *first;
    const pl_guard *guard;
    const double *limit; /* of each guard */
    const int *hold;
    /* Rows of guards, of each: d/3 times its slope; bounds as for pl_switching.  All rows x size */
    const double *gate, *gate_tangent, *chord_error, *cubic_error;
    /* Of each expression and each row of guards: the sizes of its factors of cos and sin, to tell rounding from what
     * is more where these are evaluated anew */
    const double *play, *gate_play;
    /* Assignments: x[state] = value . x, those of a set from the same x: set[k] to set[k + 1] - 1 */
    const int *set, *state;
    const double *value;
    int impacts; /* at most 30, in the order in which they act at one instant */
    const pl_impact *impact;
    /* impacts x size, of those that bounce: the speed of the guard; what times e - b is taken from x to be on it */
    const double *speed, *back;
    int degree;
    int max_events, max_splits;
} pl_guards;

/* what is to stick and what is to slip at an event has no answer that holds: some that was nearest was kept */
enum { PL_UNDECIDED = 16 };

/* a step has ended beyond the guard of a bounce, by more than rounding: its contact is lost */
enum { PL_PENETRATED = 64 };

/* Bounces that would all be over within this part of h come to rest: their number is infinite, their time is not. */
#define PL_BRIEF 0x1p-23
#define PL_BRIEFF 0x1p-10f

#define PL_GUARDS_WORK(size, degree) (((degree) + 1) * ((size) + 2) + 11 * (size))

/* The region of x.  What is on a breakpoint that stands twice sticks where that can be, else goes where it is heading;
 * what is on another one goes as in pl_switching_start. */
void pl_guards_start(const pl_guards *m, const double *x, pl_contact *c, double *work);

/* x over tau, 0 <= tau <= h, as pl_switching_advance.  Where several stick or slip at
 * one event, the combination is taken in which all of them agree: none is held by more than its guard lets it, and each
 * that slips moves away in its direction; of several the one with the fewest changes, then with most that stick.
 *
 * Impacts at one instant act in their order, each from the state that the one before has left, and again from the
 * first, until none is on its guard and comes closer; what is slower than 2^-48 of the fastest (float: 2^-20) is over,
 * and rests; so does, with e < 1, what still acts after 1000 of them.  The first 12 are listed; once the list is half
 * full, of those within 2^-10 h (float: 2^-8).  Behind a bounce that leaves with the velocity v and is pressed back by
 * the acceleration a, all further ones take T = 2 v/(a (1 - e)): where T <= PL_BRIEF h, e < 1, it rests, listed T
 * later; where the list of crossings is full but for a few, where T <= 2^-10 h (float: 2^-8).  Several that touch
 * and strike each other rest together where that holds of each with the largest a, or their bounces are lower than
 * rounding, and all are pressed then.  Speeds of what comes to rest go by impacts with e = 0, so momentum stays.
 * What rests is held until it would have to be pulled.  Impacts with e < 1 go on beyond the list, to 65536 events in
 * a step.  What rounding has taken beyond a bounce is still before it; PL_PENETRATED: at the end of a step it is
 * there by more. */
void pl_guards_advance(const pl_guards *m, double tau, double *x, pl_contact *c, pl_crossing *crossing, double *work);

/* The same, but h sooner where it is sure that no guard is met: chord_error has 8 units in the last place of |gate| +
 * 3 |gate_tangent| more, for what rounding may hide where the step begins. */
void pl_guards_step(const pl_guards *m, double tau, double *x, pl_contact *c, pl_crossing *crossing, double *work);

/* At this time [s] of a step: behind loads that have changed their formula, in the region of the same intervals, which
 * m is of now.  What has left its interval by a jump of a load passes its breakpoints, in the order of expressions, and
 * no impact begins there; then what touches and comes closer bounces, and what is at rest is decided anew. */
void pl_guards_change(const pl_guards *m, double time, double *x, pl_contact *c, pl_crossing *crossing, double *work);

/* The same with what rounding takes from x kept, as pl_switching_kept_step: m->value is of each assignment `size` first
 * words and then as many second ones. */
#define PL_GUARDS_KEPT_WORK(size, degree) (PL_GUARDS_WORK(size, degree) + 2 * (size))
void pl_guards_kept_start(const pl_guards *m, const double *x, pl_contact *c, double *work);
void pl_guards_kept_advance(const pl_guards *m, double tau, double *x, pl_contact *c, pl_crossing *crossing,
                            double *work);
void pl_guards_kept_change(const pl_guards *m, double time, double *x, pl_contact *c, pl_crossing *crossing,
                           double *work);

typedef struct pl_impactf {
    int expression, breakpoint, upward;
    int rest, jump, still;
    float restitution, play;
} pl_impactf;

typedef struct pl_guardsf {
    int size;
    float h;
    int switches;
    const float *row;
    const int *breaks;
    const float *at;
    const int *matrix, *halvings;
    const float *A, *Phi;
    pl_ladderf ladder;
    const float *tangent;
    const int *first;
    const pl_guard *guard;
    const float *limit;
    const int *hold;
    const float *gate, *gate_tangent, *chord_error, *cubic_error, *play, *gate_play;
    const int *set, *state;
    const float *value;
    int impacts;
    const pl_impactf *impact;
    const float *speed, *back;
    int degree, max_events, max_splits;
} pl_guardsf;

void pl_guardsf_start(const pl_guardsf *m, const float *x, pl_contact *c, float *work);
void pl_guardsf_advance(const pl_guardsf *m, float tau, float *x, pl_contact *c, pl_crossingf *crossing, float *work);
void pl_guardsf_change(const pl_guardsf *m, float time, float *x, pl_contact *c, pl_crossingf *crossing, float *work);
void pl_guardsf_kept_start(const pl_guardsf *m, const float *x, pl_contact *c, float *work);
void pl_guardsf_kept_advance(const pl_guardsf *m, float tau, float *x, pl_contact *c, pl_crossingf *crossing,
                             float *work);
void pl_guardsf_kept_change(const pl_guardsf *m, float time, float *x, pl_contact *c, pl_crossingf *crossing,
                            float *work);

/* ---- retune.c: coefficients from other params --------------------------------------------------------------- */

/* A product of params: an earlier one times a param, or divided by it.  Product 0 is 1; a list makes 1, 2, ... */
typedef struct pl_monomial {
    unsigned short from;    /* an earlier product */
    unsigned char param;
    unsigned char divides;  /* 1: divided by it */
} pl_monomial;

/* factor times a product of params, added to one entry of [R | W] */
typedef struct pl_term {
    unsigned short row, column, monomial;
    pl_two factor;
} pl_term;

/* W a = R x: equations of highest derivatives a over the states and what acts on them, x.  Where every mass is fixed
 * the generator has multiplied by the inverse of W, and there is no W. */
typedef struct pl_equations {
    unsigned short rows;    /* entries of a */
    unsigned short columns; /* entries of x */
    unsigned short solves;  /* 1: there is a W, rows x rows, its columns behind those of R; 0: it is the unit matrix */
    unsigned short params, monomials;
    int terms;
    const pl_monomial *monomial;
    const pl_term *term; /* the same entry's one after the other */
} pl_equations;

/* value <- W^-1 R at these params, in two words: row i from value[i width] on, width = columns + (solves ? rows : 0);
 * what is behind `columns` has no meaning.  By elimination with partial pivoting. value  rows x width work   monomials
 * + 1 entries, contents of no meaning 0; PL_SINGULAR: W has no inverse, or nothing but rounding says that it has one,
 * or a divisor is 0; PL_NOT_FINITE: a param or a result is infinite, or not a number.
 *
 * Without W an entry is off by less than 2^-101 (in floats 2^-43) of the sizes of its terms, summed (2^-103.7 and
 * 2^-45.9 measured over 6 10^4 equations).  With W that of row i, column j is off by less than 2^-101 of sum_k
 * |W^-1|_ik times the largest, over rows, of the sizes of all terms in W a - R x for column j (2^-104.2 and 2^-46.5
 * measured, nearly singular W included). */
int pl_equations_at(const pl_equations *e, const double *params, pl_two *value, pl_two *work);

/* D <- e^{A tau} - I, its first `states` rows, tau in seconds.
 *     A     size x size, row-major [1/s]; 0 below the first `states` rows and left of column `states`: what acts on the
 * states does not depend on them words 1, or 2: two words in any case D     states x size; the low words are 0 where
 * one word was enough work  PL_INCREMENT_WORK(size) entries, contents of no meaning 0, or PL_NOT_FINITE and D has no
 * meaning; so it ends too where |A| tau is beyond 2^64, or 2^32 in floats.  |A| is a norm that knows no units, as a
 * rule at most twice the largest pole or frequency of a load.
 *
 * In the first `states` columns no entry is off by more than 16 units in the last place of the largest of all these, in
 * each other column of the largest in it, for |A| tau up to 2^20 and where that largest is above 2^-900.  Measured: 7.2
 * units, over 2 10^5 models with and without damping, stiff, near confluence and free, with all kinds of loads; 0.5
 * where two words are used.  In floats for |A| tau up to 2^10 and above 2^-100: 11.5 units; up to 2^12 one in 2 10^4
 * damped models was off by 16.7 in units that are far apart.
 *
 * Taylor's series of A tau 2^-k, then k times D <- 2 D + D^2, which keeps small entries that I + D would lose.  In one
 * word where |A| tau is below 2.  In two beyond, and where terms of the series meet that leave little; there it is I +
 * D that is squared from |A| tau 2^-k = 1/2 on, which keeps what decays. */
int pl_increment(int size, int states, const pl_two *A, double tau, int words, pl_two *D, pl_two *work);

#define PL_INCREMENT_WORK(size) (6 * (size) * (size))

/* A ramp that is u in column `column` of D and u' in the next acts by its value after the step with D_{u'} / h, and by
 * that before with D_u - D_{u'} / h.  1: so much of that cancels that one word is not enough.  D: states x size */
int pl_ramp_cancels(int size, int states, const pl_two *D, int column, double h);

/* whole - slope / h, rounded: that difference */
double pl_ramp_before(pl_two whole, pl_two slope, double h);

/* What NAME_retune says, beside PL_NOT_FINITE; the coefficients are then as they were */
/* the step is not above 0 */
enum {
    PL_SINGULAR = 4,
    /* the mass matrix has no inverse, or a param that something is divided by is 0 */ PL_NO_STEP = 8,
    PL_NO_RATE = 16, /* a load's frequency is below 0 */
    /* of regions: breakpoints come in another order, or what decided about regions has another sign; a restitution is
     * not within 0 and 1; a gap or a force of friction is below 0; a pole times h is above 2^30 */
    PL_OUT_OF_RANGE = 32
};

/* The same in floats. */
typedef struct pl_termf {
    unsigned short row, column, monomial;
    pl_twof factor;
} pl_termf;

typedef struct pl_equationsf {
    unsigned short rows, columns, solves, params, monomials;
    int terms;
    const pl_monomial *monomial;
    const pl_termf *term;
} pl_equationsf;

int pl_equationsf_at(const pl_equationsf *e, const float *params, pl_twof *value, pl_twof *work);
int pl_incrementf(int size, int states, const pl_twof *A, float tau, int words, pl_twof *D, pl_twof *work);
int pl_rampf_cancels(int size, int states, const pl_twof *D, int column, float h);
float pl_rampf_before(pl_twof whole, pl_twof slope, float h);

/* ---- retune.h: coefficients of a step, independent block by independent block --------------------------------- */

/* An entry of A in x' = A x */
typedef struct pl_entry {
    unsigned short row, column;
    pl_two value;
} pl_entry;

/* A block that no state outside acts on: x is its states, the load states that act on it, the inputs that do. */
typedef struct pl_block {
    /* of its highest derivatives, and in further rows frequencies of its loads, in column 0; over its states, the load
     * states in each segment of time, the inputs */
    pl_equations equations;
    unsigned short states, loads, inputs; /* entries of x */
    unsigned short segments;      /* of time, in which loads have formulas of their own */
    unsigned short derivatives;   /* the first rows of the equations, */
    unsigned short entries;       /* of A that no param changes */
    unsigned short turns;         /* pairs of load states, cosine and sine, whose frequency params change */
    const unsigned short *row;    /* of A that the derivatives are */
    const pl_entry *entry;
    const unsigned short *turn;   /* a row of the equations, the place of the cosine in x */
    const unsigned short *place;  /* of each entry of x in that of the whole model */
} pl_block;

/* Blocks of one shape, whose factors of a step an instance has in one table */
typedef struct pl_group {
    int blocks;
    const pl_block *block;
    const unsigned short *reads;  /* of each block the params that it reads, a bit each */
    int samples;                  /* inputs that go from sample to sample: */
    const unsigned short *sample; /* the place of each in x, and how many of its derivatives follow there */
    const double *tap;            /* of those with more than one: parts of h^m times derivative m in each sample */
    int down, across;             /* of one block, in the table: from row to row, from column to column; of several 0 */
    int entries, changing;        /* of several, of each; and beside them in each segment of time; of one, columns */
    const unsigned char *entry, *load; /* row and column of each entry */
} pl_group;

/* The same in floats. */
typedef struct pl_entryf {
    unsigned short row, column;
    pl_twof value;
} pl_entryf;

typedef struct pl_blockf {
    pl_equationsf equations;
    unsigned short states, loads, inputs, segments, derivatives, entries, turns;
    const unsigned short *row;
    const pl_entryf *entry;
    const unsigned short *turn, *place;
} pl_blockf;

typedef struct pl_groupf {
    int blocks;
    const pl_blockf *block;
    const unsigned short *reads;
    int samples;
    const unsigned short *sample;
    const float *tap;
    int down, across, entries, changing;
    const unsigned char *entry, *load;
} pl_groupf;

/* ---- region.c: a region of a piecewise-linear model from other params ------------------------------------------ */

/* Of x' = A x, A size x size in two words: *halvings, so that no pole times h 2^-halvings is above 1; slopes and
 * Phi = e^{A h} as pl_switching has them, each entry within 16 units in the last place of the largest of all; and the
 * pieces of a ladder that has room for `rungs` of them, *spacing halvings apart.
 *     most  halvings that are allowed
 *     work  PL_REGION_WORK(size) entries, contents of no meaning
 * 0; PL_NOT_FINITE, PL_OUT_OF_RANGE: more halvings */
int pl_region_of(int size, const pl_two *A, double h, int most, int rungs, int *halvings, int *spacing, double *slopes,
                 double *Phi, double *ladder, pl_two *work);
#define PL_REGION_WORK(size) (7 * (size) * (size))

/* `most` over the largest entry of Phi, or over 1; 0 where there is more than one halving: no step looks over the whole
 * of h then. */
double pl_region_large(int size, int halvings, const double *Phi, double most);

/* Of rows over x, rows x size, in such a region: slope, second and fourth as tangent, chord_error and cubic_error of
 * pl_switching, with room for what rounding did to them.
 *     work  PL_BOUNDS_WORK(size) entries, contents of no meaning */
void pl_region_bounds(int size, double d, const double *A, int rows, const double *row, double *slope, double *second,
                      double *fourth, double *work);
#define PL_BOUNDS_WORK(size) ((4 * (size) + 5) * (size))

/* Of the same rows: reach as a ladder has it, for each row that of all rungs but the first, and of h.
 *     A     size x size [1/s]
 *     work  PL_REACH_WORK(size, rows) entries, contents of no meaning */
void pl_region_reach(int size, double h, int halvings, int spacing, const double *A, int rows, const double *row,
                     double *reach, double *work);
#define PL_REACH_WORK(size, rows) ((5 * (size) + 3 * (rows) + 1) * (size))

int pl_regionf_of(int size, const pl_twof *A, float h, int most, int rungs, int *halvings, int *spacing, float *slopes,
                  float *Phi, float *ladder, pl_twof *work);
float pl_regionf_large(int size, int halvings, const float *Phi, float most);
void pl_regionf_bounds(int size, float d, const float *A, int rows, const float *row, float *slope, float *second,
                       float *fourth, float *work);
void pl_regionf_reach(int size, float h, int halvings, int spacing, const float *A, int rows, const float *row,
                      float *reach, float *work);

/* ---- cut.c: a part of a step of a scheme with a leftover ------------------------------------------------------ */

/* e^{A tau} of x' = A x, of what is set up for one tau */
typedef struct pl_cut {
    int size, terms; /* entries of x; of the series, 0: there are tables */
    double tau;      /* [s] */
    const double *A, *D;
    double *room;
} pl_cut;

/* By the series, or where fastest times tau is above 2 by tables that are made here.
 *     A        size x size [1/s], kept as long as m is
 *     fastest  the sizes |A| have no larger pole [1/s]
 *     work     PL_CUT_WORK(size) entries, kept as long as m is
 *     room     PL_CUT_ROOM(size) entries
 * 0, or PL_NOT_FINITE and m has no meaning */
int pl_cut_begin(pl_cut *m, int size, const double *A, double fastest, double tau, double *work, pl_two *room);
/* out = e^{A tau} x, or where half is not 0 e^{A tau / 2} x */
void pl_cut_flow(const pl_cut *m, int half, const double *x, double *out);

#define PL_CUT_ROOM(size) (8 * (size) * (size))
#define PL_CUT_WORK(size) ((2 * (size) + 2) * (size))

typedef struct pl_cutf {
    int size, terms;
    float tau;
    const float *A, *D;
    float *room;
} pl_cutf;

int pl_cutf_begin(pl_cutf *m, int size, const float *A, float fastest, float tau, float *work, pl_twof *room);
void pl_cutf_flow(const pl_cutf *m, int half, const float *x, float *out);

/* ---- rate.c: frequencies from other params -------------------------------------------------------------------- */

/* w / (2 pi), w >= 0 an angular frequency [rad/s]: off by less than 2^-115 of itself, beside what two words
 * leave of w. */
pl_rate pl_rate_of(pl_two w);
pl_ratef pl_ratef_of(pl_twof w); /* 2^-86 */

/* What the phase of a sine has gained over w t where its frequency w was changed: it went on from where it was. */
typedef struct pl_lead {
    pl_turn turn;
    double angle; /* the same [rad], from -pi to pi */
} pl_lead;

typedef struct pl_leadf {
    pl_turnf turn;
    float angle;
} pl_leadf;

/* None: w has been the same since t = 0. */
static inline void pl_lead_start(pl_lead *lead)
{
    lead->turn.hi = lead->turn.lo = 0;
    lead->angle = 0.0;
}

static inline void pl_leadf_start(pl_leadf *lead)
{
    lead->turn = 0;
    lead->angle = 0.0f;
}

/* w was `before` and is `after` [rad/s] from t [s] on: the turn gains (before - after) t, which is off by less than
 * 2^-115 of it, or 2^-86, and 2^-129 turn, or 2^-65; so nothing adds up over many changes, however late. */
void pl_lead_change(pl_lead *lead, double before, double after, double t);
void pl_leadf_change(pl_leadf *lead, float before, float after, float t);

/* ---- a model, seen from outside -------------------------------------------------------------------------- */

/* The shape of the two descriptors below.  A program that loads models compiled apart from it looks at the first two
 * entries before it reads any other: they stay where they are, whatever comes. */
enum { PL_MODEL_VERSION = 2 };

/* What a program needs to drive a model that it was not written for.  s points to the model's state, `size` bytes,
 * aligned as any double or uint64_t; copy the bytes to save it, copy them back to restore it.
 * u holds one sample of the `inputs` inputs and is NULL where there are none. */
typedef struct pl_model {
    int version;                  /* PL_MODEL_VERSION, of the plrt.h that the model was compiled with */
    int real_size;                /* sizeof(double); in its place a pl_modelf says sizeof(float) */
    const char *name;
    size_t size;                  /* sizeof the state */
    int states, inputs, outputs;
    double h;                     /* step [s] */
    const char *const *state_names, *const *input_names, *const *output_names;
    void (*init)(void *s);        /* t = 0 and the spec's initial values */
    void (*set)(void *s, double t, const double *y); /* y: `states` entries */
    void (*get)(const void *s, double *y);
    double (*time)(const void *s);                   /* [s] */
    void (*step)(void *s, const double *u);
    void (*out)(const void *s, double *out);         /* out: `outputs` entries */
    void (*run)(void *s, size_t n, const double *u, double *out); /* n steps; n rows of u; n rows of out, or NULL */
    /* 0 <= tau <= h; NULL where the model has none */
    void (*at)(const void *s, const double *u, double tau, double *y);
    void (*jump)(void *s, uint64_t n);                                 /* n steps at once; NULL where it has none */
    int (*status)(const void *s); /* 0, or PL_... bits */
    int params;                   /* tunable ones */
    const char *const *param_names;
    const double *param_values;   /* the spec's */
    /* state and time stay; as NAME_retune says; NULL: nothing is tunable */
    int (*retune)(void *s, const double *params, double h);
    void (*hold)(void *s, const double *u); /* the samples before the first step; NULL where no input is a ramp */
    const int
        *start_samples; /* of each input: how many it has had when the first step comes.  0: held, so row k of a
                         * record acts from k h to (k + 1) h; 1: a ramp, so row 0 is the sample at t = 0, which
                         * `hold` takes, and row k + 1 that at the end of step k; m > 1: `hold` takes rows 0 to
                         * m - 1 one after the other, step k row k + m.  NULL where there are no inputs */
} pl_model;

/* The same of a model in float. */
typedef struct pl_modelf {
    int version, real_size;
    const char *name;
    size_t size;
    int states, inputs, outputs;
    float h;
    const char *const *state_names, *const *input_names, *const *output_names;
    void (*init)(void *s);
    void (*set)(void *s, float t, const float *y);
    void (*get)(const void *s, float *y);
    float (*time)(const void *s);
    void (*step)(void *s, const float *u);
    void (*out)(const void *s, float *out);
    void (*run)(void *s, size_t n, const float *u, float *out);
    void (*at)(const void *s, const float *u, float tau, float *y);
    void (*jump)(void *s, uint64_t n);
    int (*status)(const void *s);
    int params;
    const char *const *param_names;
    const float *param_values;
    int (*retune)(void *s, const float *params, float h);
    void (*hold)(void *s, const float *u);
    const int *start_samples;
} pl_modelf;

#ifdef __cplusplus
}
#endif

#endif
