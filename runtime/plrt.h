/* SPDX-License-Identifier: MIT-0 */
/* plrt.h: the runtime that every model made by plgen shares.
 *
 * Freestanding C99 (and C++17): no libm, no allocation, no recursion, no mutable globals, every loop bounded.  The
 * caller owns all memory; no function allocates, waits or prints.  The files are independent, so the linker takes only
 * those that a model uses:
 *
 *     phases.c        phases of loads as 128-bit fractions of a cycle, their cosine and sine
 *     envelope.c       exponents of growing and decaying loads as 128-bit numbers, their exponential envelopes
 *     series.c       x(tau) for 0 <= tau <= h: NAME_at
 *     power.c        the state after n steps in log n time: NAME_jump
 *     until.c        the time until a load changes its formula
 *     apply.c        matrices times vectors, and a test for finite numbers: schemes with a nonlinear remainder
 *     crossings.c    steps of piecewise-linear models; every crossing of a breakpoint is found
 *     guards.c       such steps with dry friction and impacts, whose events differ from region to region
 *     crossings_compensated.c, guards_compensated.c
 *                    such steps of a double-double state: --accuracy compensated
 *     crossings_d.c, guards_d.c, crossings_compensated_d.c, guards_compensated_d.c
 *                    such steps with derivatives, in one word and in two: sensitivity
 *     retune.c       coefficients of a step from other params: NAME_retune
 *     event_split.c  event-split steps: schemes with a nonlinear remainder, from event to event
 *     rate.c         the frequency of a load from other params; its phase stays continuous
 *     root.c         n-th roots within 6 %, for step sizes from error estimates
 *     dense.c        systems of linear equations, for Newton's method of implicit schemes
 *     functions.c    sin, exp, pow and their kin with the same bits on every target: --math own
 *
 * phasesf.c, envelopef.c, ... are these files for models in float, which use no double.  Their names have an f:
 * pl_phasef_at is to pl_phase_at as sinf is to sin.  Declarations that differ by the type alone are in plreal.h, under
 * the names for double.
 *
 * Compile it with the compiler's default flags: contraction to fused multiply-adds is harmless, and flags that reorder
 * sums are refused below. */
#ifndef PLRT_H
#define PLRT_H

#ifdef PL_BUNDLED /* a bundle defines these types where they are not defined yet */
#error "plrt.h, or a header that includes it, goes before headers of bundles (plgen --bundle)"
#endif

#include <stddef.h>
#include <stdint.h>

#ifdef __cplusplus
extern "C" {
#endif

/* ---- what the arithmetic needs of the compiler --------------------------------------------------------------- */

/* A compiler that takes additions for associative may replace y + (Phi - I) y by Phi y, and the error of a sum by 0. */
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

/* The object of such a pointer is reached through no other pointer. */
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
          "1.0 has to be a double of 64 bits: compile it without -fsingle-precision-constant; where double has 32 "
          "bits, make models with --real float, and leave out the files of the runtime for double");
#endif

/* 1: sums are evaluated with more bits than a double, or a float, has, so double-double arithmetic misjudges their
 * rounding errors. */
#ifdef __FLT_EVAL_METHOD__
#define PL_EXCESS_PRECISION (__FLT_EVAL_METHOD__ < 0 || __FLT_EVAL_METHOD__ == 2 || __FLT_EVAL_METHOD__ > 64)
#define PL_EXCESS_PRECISIONF (__FLT_EVAL_METHOD__ != 0 && __FLT_EVAL_METHOD__ != 16 && __FLT_EVAL_METHOD__ != 32)
#else
#define PL_EXCESS_PRECISION 0 /* two.h asks <float.h> */
#define PL_EXCESS_PRECISIONF 0
#endif

/* ---- phases.c: phases ------------------------------------------------------------------------------------- */

/* An angle, in units of 2^-128 turn: (hi 2^64 + lo) 2^-128 turn.  It wraps as a phase should, so adding a step's
 * angle n times is as good as multiplying it by n: off by n 2^-129 turn, 2^-99 turn after 10^9 steps. */
typedef struct pl_phase {
    uint64_t hi, lo;
} pl_phase;

/* A frequency in turns per second [Hz]: (word[0] 2^128 + word[1] 2^64 + word[2]) 2^-exponent, with the top bit of
 * word[0] set, or all words 0. */
typedef struct pl_rate {
    uint64_t word[3];
    int exponent;
} pl_rate;

/* a + b mod 1 turn. */
static inline pl_phase pl_phase_add(pl_phase a, pl_phase b)
{
    pl_phase sum;
    sum.lo = a.lo + b.lo;
    sum.hi = a.hi + b.hi + (sum.lo < a.lo);
    return sum;
}

/* n a mod 1 turn, exactly. */
pl_phase pl_phase_times(pl_phase a, uint64_t n);

/* rate t mod 1 turn, t in seconds, any sign: the product is exact, then rounded once to 2^-128 turn.  The rate itself
 * is known to 192 bits, so beyond 2^64 turns the last bits of the angle are its rounding's, and beyond 2^192
 * turns nothing of the angle is known.  An infinite t, or not a number, gives 0. */
pl_phase pl_phase_at(const pl_rate *rate, double t);

/* z[0] = cos a, z[1] = sin a.  Off by less than 0.6 units in the last place (0.576 measured over 5 10^6 angles: 2^-53.8
 * at most), small angles included; exactly 0, 1 or -1 at quarter turns; mirror images about a quarter turn
 * agree to the last bit but for sign, and no zero is negative. */
void pl_cossin(pl_phase a, double z[2]);

/* What one pl_cossin costs: 19 multiplications of doubles and four products of 64-bit integers; 15 additions of
 * doubles, five conversions of integers to doubles, which take as long, and two additions of those integers. */
enum { PL_COSSIN_MUL = 23, PL_COSSIN_ADD = 22 };

/* ---- phasesf.c: phases of models in float ------------------------------------------------------------------- */

/* An angle in units of 2^-64 turn, which wraps as a phase should.  Adding a step's angle n times is off by n 2^-65
 * turn: 2^-35 turn after 10^9 steps. */
typedef uint64_t pl_phasef;

/* A frequency in turns per second [Hz], or another rate: (word[0] 2^64 + word[1]) 2^-exponent, with the top bit of
 * word[0] set, or both words 0. */
typedef struct pl_ratef {
    uint64_t word[2];
    int exponent;
} pl_ratef;

/* a + b mod 1 turn. */
static inline pl_phasef pl_phasef_add(pl_phasef a, pl_phasef b)
{
    return a + b;
}

/* n a mod 1 turn, exactly. */
pl_phasef pl_phasef_times(pl_phasef a, uint64_t n);

/* rate t mod 1 turn, t in seconds, any sign: the product is exact, then rounded once to 2^-64 turn.  The rate itself is
 * known to 128 bits, so beyond 2^64 turns the last bits of the angle are its rounding's, and beyond 2^128 turns nothing
 * of the angle is known.  An infinite t, or not a number, gives 0. */
pl_phasef pl_phasef_at(const pl_ratef *rate, float t);

/* z[0] = cos a, z[1] = sin a.  Off by less than 0.52 units in the last place (0.515 measured over 2 10^7 angles), small
 * angles included; exactly 0, 1 or -1 at quarter turns; mirror images about a quarter turn agree to the last bit but
 * for sign, and no zero is negative. */
void pl_cossinf(pl_phasef a, float z[2]);

/* What one pl_cossinf costs: twelve products of 32-bit integers and two multiplications of floats; ten additions of
 * integers. */
enum { PL_COSSINF_MUL = 14, PL_COSSINF_ADD = 10 };

/* ---- envelope.c: exponential loads -------------------------------------------------------------------------- */

/* An exponent of 2, a t / ln 2 for e^{a t}: (hi 2^64 + lo) 2^-112, from -2^15 to just below 2^15.  What is beyond stays
 * at the end of this range, where the power has long been 0 or infinite.  Adding a step's exponent n times is as good
 * as multiplying it by n: the power is off by a factor of 1 + n 2^-113, 1 + 2^-83 after 10^9 steps. */
typedef struct pl_envelope {
    int64_t hi;
    uint64_t lo;
} pl_envelope;

/* The number that has these bits in two's complement. */
static inline int64_t pl_envelope_signed(uint64_t bits)
{
    return bits >> 63 ? -(int64_t)~bits - 1 : (int64_t)bits;
}

/* a + b. */
static inline pl_envelope pl_envelope_add(pl_envelope a, pl_envelope b)
{
    const uint64_t x = (uint64_t)a.hi, y = (uint64_t)b.hi, lo = a.lo + b.lo, hi = x + y + (lo < a.lo);
    const int beyond = (int)((~(x ^ y) & (x ^ hi)) >> 63); /* equal signs, but not that of the sum */
    pl_envelope sum;
    sum.hi = !beyond ? pl_envelope_signed(hi) : a.hi < 0 ? INT64_MIN : INT64_MAX;
    sum.lo = !beyond ? lo : a.hi < 0 ? 0 : UINT64_MAX;
    return sum;
}

/* n a. */
pl_envelope pl_envelope_times(pl_envelope a, uint64_t n);

/* rate t, or -rate t where `negative` is not 0; rate in powers of 2 per second, t in seconds, any sign: the product is
 * exact, then rounded once to 2^-112.  An infinite t counts as the largest finite one, and not a number as 0. */
pl_envelope pl_envelope_at(const pl_rate *rate, int negative, double t);

/* 2^a, off by less than 0.53 units in the last place (0.526 measured over 2 10^7 arguments; 0.508 where the result is
 * subnormal); exactly 2^k at an integer k; 0 from 2^-1075 down, infinite from 2^1024 up. */
double pl_envelope_value(pl_envelope a);

/* What one pl_envelope_value costs: 14 multiplications of doubles, two products of 64-bit integers; nine additions of
 * doubles, a conversion of an integer to a double, which takes as long, and three additions of those integers. */
enum { PL_ENVELOPE_MUL = 16, PL_ENVELOPE_ADD = 13 };

/* ---- envelopef.c: exponential loads of models in float -------------------------------------------------------- */

/* An exponent of 2, a t / ln 2 for e^{a t}, in units of 2^-48: from -2^15 to just below 2^15, where what is beyond
 * stays.  Adding a step's exponent n times is off by n 2^-49, and the power by a factor of 1 + n 2^-49: 1 + 2^-19 after
 * 10^9 steps. */
typedef int64_t pl_envelopef;

/* a + b. */
static inline pl_envelopef pl_envelopef_add(pl_envelopef a, pl_envelopef b)
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
pl_envelopef pl_envelopef_times(pl_envelopef a, uint64_t n);

/* rate t, or -rate t where `negative` is not 0; rate in powers of 2 per second, t in seconds, any sign: the product is
 * exact, then rounded once to 2^-48.  An infinite t counts as the largest finite one, and not a number as 0. */
pl_envelopef pl_envelopef_at(const pl_ratef *rate, int negative, float t);

/* 2^a, off by less than 0.52 units in the last place (0.513 measured over 2 10^7 arguments), subnormal results
 * included; exactly 2^k at an integer k; 0 from 2^-150 down, infinite from 2^128 up. */
float pl_envelopef_value(pl_envelopef a);

/* What one pl_envelopef_value costs: seven products of 32-bit integers and nine additions of integers; no floats. */
enum { PL_ENVELOPEF_MUL = 7, PL_ENVELOPEF_ADD = 9 };

/* ---- functions.c: elementary functions, for --math own ------------------------------------------------------- */

/* As the functions of <math.h> without pl_, with the same bits on every target that rounds products before it adds
 * them: arguments of any size, infinities and NaN as in C99's appendix F.  Off by less than, in units in the last
 * place: sqrt 0.5 (correctly rounded); log, asin, acos, atan, atan2, exp, pow 0.52; sin, cos 0.6; cosh 1.2; tan, sinh
 * 2; tanh 2.5. */
double pl_sin(double x);
double pl_cos(double x);
double pl_tan(double x);
double pl_exp(double x);
double pl_log(double x);
double pl_sqrt(double x);
double pl_sinh(double x);
double pl_cosh(double x);
double pl_tanh(double x);
double pl_asin(double x);
double pl_acos(double x);
double pl_atan(double x);
double pl_pow(double x, double y);
double pl_atan2(double y, double x);

/* ---- how functions and loops are compiled -------------------------------------------------------------------- */

/* A function that is called rarely stays out of line, so that its caller reserves no registers for it. */
#ifdef __GNUC__
#define PL_APART __attribute__((noinline))
#else
#define PL_APART
#endif

/* A function that is compiled into its caller, where some of its arguments are constants. */
#ifdef __GNUC__
#define PL_INLINE inline __attribute__((always_inline))
#else
#define PL_INLINE inline
#endif

/* 1: a sum is shorter and hardly slower as a call, because code has to be small or products of doubles are calls too.
 * PL_APART_HARD keeps rarely called functions out of line on other targets only. */
#if defined __OPTIMIZE_SIZE__ || (defined __arm__ && !(defined __ARM_FP && (__ARM_FP & 8)))
#define PL_SOFT 1
#define PL_APART_HARD
#else
#define PL_SOFT 0
#define PL_APART_HARD PL_APART
#endif

/* The loop that follows has a constant length; it is unrolled unless code has to be small. */
#if defined __OPTIMIZE_SIZE__
#define PL_UNROLL
#elif defined __clang__
#define PL_UNROLL _Pragma("clang loop unroll(full)")
#elif defined __GNUC__ && __GNUC__ >= 8
#define PL_UNROLL _Pragma("GCC unroll 16")
#else
#define PL_UNROLL
#endif

/* The loop that follows becomes vectors as it stands: gcc at -O3 would write it out before, and leave it as that. */
#if defined __GNUC__ && !defined __clang__ && __GNUC__ >= 8
#define PL_ROLLED _Pragma("GCC unroll 1")
#else
#define PL_ROLLED
#endif

/* The length of an array of n entries, at least 1, as C has no empty arrays. */
#define PL_ROOM(n) ((n) > 0 ? (n) : 1)

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

/* ---- status of a model ------------------------------------------------------------------------------------------- */

/* NAME_status returns 0 or a sum of these bits. */
enum {
    PL_NOT_FINITE = 1,      /* A state is infinite or not a number.  Linear models set it while that is so. */
    PL_TOO_MANY_EVENTS = 2, /* A step exceeded its bound of crossings, or of halvings in the search: mostly chatter. */
    PL_TOO_MANY_STEPS = 4,  /* A step of h needed more substeps than allowed; the state is the last accepted one. */
    PL_INACCURATE = 8,      /* The last terms of a Taylor series were above the tolerance. */
    PL_UNDECIDED = 16,      /* No combination of sticking and slipping met all conditions; the nearest was taken. */
    PL_LEFT_RANGE = 32,     /* At the end of a step a state was outside the range that the spec gives it. */
    PL_PENETRATED = 64,     /* A step ended beyond a stop by more than rounding: that contact is lost. */
    /* The mass matrix is singular, or gradients of constraints depend on each other: the state is the last good one. */
    PL_SINGULAR_MASS = 128
};

/* NAME_d has a status of its own: 0 or a sum of these bits, until it is set anew. */
enum {
    PL_D_GRAZING = 1,   /* A guard was met, or all but met, so flatly that behind it no derivative is known. */
    PL_D_ONE_SIDED = 2, /* Events at one instant: their order, which a param may turn, decides on the derivative.  Or an
                         * output jumps at its peak: the derivative is at a fixed time. */
    PL_D_UNDECIDED = 4, /* PL_UNDECIDED: the derivative is that of what was taken. */
    PL_D_FAILED = 8     /* The step of the derivatives ended early: what NAME_status may say happened to it. */
};

/* NAME_retune returns 0, PL_NOT_FINITE or one of these; unless it returns 0 the coefficients are unchanged. */
enum {
    PL_SINGULAR = 4, /* The mass matrix is singular, or a divisor is 0. */
    PL_NO_STEP = 8,  /* The step is not above 0. */
    PL_NO_RATE = 16, /* A load's frequency is below 0. */
    /* Breakpoints are in another order, or a sign that the regions rest on has changed; a restitution is outside 0 to
     * 1; a gap or a friction force is below 0; a pole times h is above 2^30. */
    PL_OUT_OF_RANGE = 32
};

/* ---- types that the functions for double and for float share --------------------------------------------------- */

enum { PL_SNAPSHOTS = 64 }; /* as many as NAME_gradient uses */
enum { PL_ACCUMULATE_ADD = 11 };
enum { PL_PEAK_SPACE = 6 };

/* The number of entries of `work`, or `room`, that functions need for a model of this size. */
#define PL_PEAK_WORK(size) (PL_PEAK_SPACE * (size))
#define PL_SWITCHING_WORK(size, switches, degree) (((degree) + 1) * ((size) + 2) + 5 * (size) + 5 * (switches))
#define PL_SWITCHING_COMPENSATED_WORK(size, switches, degree) (PL_SWITCHING_WORK(size, switches, degree) + 2 * (size))
#define PL_MOVED_WORK(states, columns) (2 * (states) + 2 * (columns))
#define PL_SERIES_SWITCHING_WORK(degree) (2 * ((degree) < 3 ? 4 : (degree) + 1))
#define PL_EVENT_WORK(degree, holds, states) (PL_SERIES_SWITCHING_WORK(degree) + (holds) * ((holds) + 1) + (states))
#define PL_VARIATION_WORK(size, degree) (((degree) + 4) * (size))
#define PL_GUARDS_WORK(size, degree) (((degree) + 1) * ((size) + 2) + 11 * (size))
#define PL_GUARDS_COMPENSATED_WORK(size, degree) (PL_GUARDS_WORK(size, degree) + 2 * (size))
#define PL_INCREMENT_WORK(size) (6 * (size) * (size))
#define PL_REGION_WORK(size) (7 * (size) * (size))
#define PL_CACHED_WORK(size, switches) (8 * (size) * (size) + 2 * ((switches) + 1) * (size))
#define PL_BOUNDS_WORK(size) ((4 * (size) + 5) * (size))
#define PL_REACH_WORK(size, rows) ((5 * (size) + 3 * (rows) + 1) * (size))
#define PL_EVENT_SPLIT_ROOM(size) (8 * (size) * (size))
#define PL_EVENT_SPLIT_WORK(size) ((2 * (size) + 2) * (size))

/* Region and events of a model, a part of its state. */
typedef struct pl_contact {
    uint64_t total; /* number of crossings since the start */
    int crossings;  /* number in the last step; the first max_events of them are listed */
    int region;     /* number of the region */
    int matrix;     /* number of its linear system; in a region that cannot occur, that of the region before */
    int status;     /* 0 or PL_TOO_MANY_EVENTS, sticky until the next start */
    int rested;     /* number of contacts that came to rest after infinitely many bounces, since the start */
} pl_contact;

/* A constraint of pl_events: in an interval between equal breakpoints a switching function is held there, by friction
 * that sticks or by a contact at rest. */
typedef struct pl_hold {
    int expression, interval; /* number of the switching function, and the interval where it is held */
    int velocity;             /* number of the watch that is held at 0 */
    int down, up;             /* watches that release it to the interval below, above, once they exceed 0; -1: none */
    int impact;               /* number of the impact whose contact rests; -1: friction sticks */
} pl_hold;

/* Constraints that exclude each other, as bits.  Friction on a body that a contact at rest holds brakes what presses
 * there; while it does not stick it slips to that side, 1 or -1 interval on, whatever its velocity. */
typedef struct pl_conflict {
    uint64_t set;
    int hold, side; /* number of that friction and its side; hold -1: no such friction */
    int watch;      /* of which the side has the sign, as the way in which they go together follows the state; -1: it
                     * does not */
} pl_conflict;

/* A guard of pl_guards: where row . x rises above its limit x jumps, and goes on in another region. */
typedef struct pl_guard {
    int row;                              /* number of its guard function */
    int expression, breakpoint, upward;   /* how its crossing is listed */
    int leads;                            /* number of the region behind it less that of the region before */
    int impact;                           /* number of the impact that begins there; -1: none */
} pl_guard;

/* Bounces that would all end within this fraction of h come to rest: there are infinitely many in a finite time. */
#define PL_BRIEF 0x1p-23
#define PL_BRIEFF 0x1p-10f

/* An operation on numbers a and b, whose result is the next number.  Params are numbered first, then constants, then
 * results in their order. */
enum { PL_SUM, PL_DIFFERENCE, PL_PRODUCT, PL_QUOTIENT };
typedef struct pl_operation {
    unsigned short what, a, b;
} pl_operation;

/* Number `number`, with the other sign where negative is 1, is one entry of a matrix. */
typedef struct pl_place {
    unsigned short row, column, number, negative;
} pl_place;

/* Of matrices of regions that are made when they are met, where one is kept */
typedef struct pl_slot {
    int region;         /* -1: none */
    uint32_t used;      /* when, by the clock */
} pl_slot;

/* The version of the two descriptors pl_model and pl_modelf.  A program that loads models compiled elsewhere checks the
 * first two entries before it reads any other; these two never move. */
enum { PL_MODEL_VERSION = 2 };

/* NAME_units, of a model that has some: texts, "" where one is not known.  A state is kept in its SI unit; an input is
 * given and an output comes out in the unit here; a param of NAME_retune is in SI units, and one of its own unit is so
 * many of those. */
typedef struct pl_units {
    const char *const *state, *const *input, *const *output, *const *param, *const *param_factor;
} pl_units;

#define PL_REAL double
#include "plreal.h"
#undef PL_REAL
#define PL_REAL float
#include "floats.h"
#include "plreal.h"
#include "doubles.h"
#undef PL_REAL

/* The same as pl_guards_advance over h, faster in an event-free step.  Its guards.chord_error is larger by 8 units in
 * the last place of |guards.row| + 3 |guards.tangent|, to cover rounding at the start of the step. */
void pl_guards_step(const pl_guards *m, double tau, double *x, pl_contact *c, pl_crossing *crossing, double *work);

/* What happens where the first guard of a step is met, at x, of matrices that are there: x behind it.  0: the step has
 * more of it than this. work: that of pl_guards_advance. */
int pl_guards_meet(const pl_guards *m, int guard, double time, double *x, pl_contact *c, pl_crossing *crossing,
                   double *work);
int pl_guards_meet_d(const pl_guards *m, int guard, double time, double *x, pl_contact *c, pl_crossing *crossing,
                     double *work, pl_variation *v);

/* Derivatives over a part of a step from x to `end`, in which nothing happens */
void pl_guards_vary_d(const pl_guards *m, double length, double *x, double *end, pl_contact *c, pl_variation *v);

/* Sets no lead: w has been the same since t = 0. */
static inline void pl_lead_start(pl_lead *lead)
{
    lead->phase.hi = lead->phase.lo = 0;
    lead->angle = 0.0;
}

static inline void pl_leadf_start(pl_leadf *lead)
{
    lead->phase = 0;
    lead->angle = 0.0f;
}

#ifdef __cplusplus
}
#endif

#endif
