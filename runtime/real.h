/* SPDX-License-Identifier: MIT-0 */
/* real.h: one text for doubles and floats, for the runtime's own use.  series.c, power.c, until.c, apply.c,
 * crossings.c and retune.c are written over `real`, a double with the names of plrt.h; seriesf.c and so on
 * define REAL_IS_FLOAT and include them, and then the same names stand for those that end in f.  Constants are
 * integers there, which are of either type: no float is promoted.  Names that models' files use, too, are in numbers.h.
 */
#ifndef PLRT_REAL_H
#define PLRT_REAL_H

#ifdef REAL_IS_FLOAT
#define PL_FLOAT_ONLY
#define PL_SINGLE 1
#else
#define PL_SINGLE 0
#endif
#include "numbers.h"
#undef real /* a type here, which undef.h leaves */

#include <float.h>

#ifdef REAL_IS_FLOAT

typedef float real;
typedef uint32_t real_bits;
enum { REAL_DIGITS = FLT_MANT_DIG, REAL_EXPONENTS = FLT_MAX_EXP };
#define REAL_EPSILON FLT_EPSILON
#define REAL_LARGE 0x1p72f /* products of any two numbers, divided by its square, can be summed */

#else

typedef double real;
typedef uint64_t real_bits;
enum { REAL_DIGITS = DBL_MANT_DIG, REAL_EXPONENTS = DBL_MAX_EXP };
#define REAL_EPSILON DBL_EPSILON
#define REAL_LARGE 0x1p520

#endif

/* With what rounding takes kept, in either type */
#ifdef STATE_IS_COMPENSATED
#undef pl_switching_start
#define pl_switching_start pl_switching_compensated_start
#undef pl_switching_step
#define pl_switching_step pl_switching_compensated_step
#undef pl_switching_advance
#define pl_switching_advance pl_switching_compensated_advance
#define pl_switching_move pl_switching_compensated_move
#undef pl_guards_start
#define pl_guards_start pl_guards_compensated_start
#undef pl_guards_advance
#define pl_guards_advance pl_guards_compensated_advance
#undef pl_guards_change
#define pl_guards_change pl_guards_compensated_change
#endif

/* With derivatives beside the state, in either type */
#ifdef WITH_DERIVATIVES
#undef pl_switching_start
#undef pl_switching_advance
#undef pl_guards_start
#undef pl_guards_advance
#undef pl_guards_change
#ifdef STATE_IS_COMPENSATED
#define pl_switching_start pl_switching_compensated_start_d
#define pl_switching_advance pl_switching_compensated_advance_d
#define pl_switching_follow pl_switching_compensated_follow_d
#define pl_guards_start pl_guards_compensated_start_d
#define pl_guards_advance pl_guards_compensated_advance_d
#define pl_guards_change pl_guards_compensated_change_d
#else
#define pl_switching_start pl_switching_start_d
#define pl_switching_advance pl_switching_advance_d
#define pl_switching_follow pl_switching_follow_d
#define pl_guards_start pl_guards_start_d
#define pl_guards_advance pl_guards_advance_d
#define pl_guards_change pl_guards_change_d
#define pl_guards_meet pl_guards_meet_d
#endif
#endif

/* row . x, of n entries.  Four sums, so that an addition need not wait for the one before it: as fast as several rows
 * at a time, in one order for all.  Inline: of many rows a call for each costs a fifth of the time. */
static inline real dot_product(int n, const real *row, const real *x)
{
	const int whole = n - n % 4;
	real s0 = 0, s1 = 0, s2 = 0, s3 = 0;
	int j;
	for (j = 0; j < whole; j += 4) {
		s0 += row[j] * x[j];
		s1 += row[j + 1] * x[j + 1];
		s2 += row[j + 2] * x[j + 2];
		s3 += row[j + 3] * x[j + 3];
	}
	if (j < n) {
		s0 += row[j] * x[j];
	}
	if (j + 1 < n) {
		s1 += row[j + 1] * x[j + 1];
	}
	if (j + 2 < n) {
		s2 += row[j + 2] * x[j + 2];
	}
	return (s0 + s2) + (s1 + s3);
}

/* A number and its bits, IEEE 754: sign, exponent + REAL_EXPONENTS - 1, then REAL_DIGITS - 1 bits of the fraction */
typedef union real_parts {
	real value;
	real_bits bits;
} real_parts;

#define REAL_FRACTION (((real_bits)1 << (REAL_DIGITS - 1)) - 1)

#endif
