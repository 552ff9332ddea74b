/* SPDX-License-Identifier: MIT-0 */
/* Two-word arithmetic, for the runtime's own use: power.c, until.c, retune.c and rate.c. */
#ifndef PL_TWO_H
#define PL_TWO_H

#include "real.h"

#if defined __FINITE_MATH_ONLY__ && __FINITE_MATH_ONLY__ > 0
#error "overflow shows as an infinity: compile it without -ffinite-math-only"
#endif

#ifdef REAL_IS_FLOAT
#define TWO_EXCESS (PL_EXCESS_PRECISIONF || FLT_EVAL_METHOD == 1 || FLT_EVAL_METHOD == 2)
#else
#define TWO_EXCESS (PL_EXCESS_PRECISION || FLT_EVAL_METHOD == 2)
#endif
#if TWO_EXCESS
#error "two-word arithmetic needs sums that have the bits of their type: on x86 compile it with -msse2 -mfpmath=sse"
#endif

static inline int is_finite(real a)
{
	return a - a == 0;
}

/* a as a number that was rounded and stored.  Without this a compiler that contracts could put an exact product where
 * the error term below needs the rounded one, and a wide register could keep more of a sum than its type. */
static inline real rounded(real a)
{
	volatile real stored = a;
	return stored;
}

static inline pl_two two(real hi, real lo)
{
	pl_two t;
	t.hi = hi;
	t.lo = lo;
	return t;
}

/* a + b, exactly (Knuth's TwoSum: no condition on sizes).  Infinities come without a low word. */
static inline pl_two two_sum(real a, real b)
{
	const real s = rounded(a + b), b_part = s - a, a_part = s - b_part;
	return two(s, is_finite(s) ? (a - a_part) + (b - b_part) : 0);
}

/* a rounded to 26 bits of 53, or 12 of 24, so that it and what remains both have products without rounding error.  By
 * its bits: this does not overflow below the last binade, and no compiler can rewrite it. */
static inline real top_half(real a)
{
	const real_bits unit = (real_bits)1 << (REAL_DIGITS + 1) / 2;
	real_parts u;
	u.value = a;
	u.bits = (u.bits + unit / 2) & ~(unit - 1);
	return u.value;
}

/* a b, exactly while it is above 2^-969, or 2^-102.  Every product in the error term is exact, so contraction changes
 * nothing. */
static inline pl_two two_product(real a, real b)
{
	const real p = rounded(a * b);
	const real ah = top_half(a), al = a - ah, bh = top_half(b), bl = b - bh;
	const real lost = ((ah * bh - p) + ah * bl + al * bh) + al * bl;
	return two(p, is_finite(lost) ? lost : 0);
}

/* a + b within 2^-104, or 2^-46, of |a| + |b|.  An infinity stays, and the first one wins: no NaN from infinities that
 * meet. */
static inline pl_two add(pl_two a, pl_two b)
{
	pl_two s, t;
	if (!is_finite(a.hi)) {
		return a;
	}
	s = two_sum(a.hi, b.hi);
	if (!is_finite(s.hi)) {
		return s;
	}
	t = two_sum(a.lo, b.lo);
	s = two_sum(s.hi, s.lo + t.hi);
	return two_sum(s.hi, s.lo + t.lo);
}

/* a b within 2^-104, or 2^-46, of itself.  0 times infinity is 0: what is decoupled stays so when its neighbour
 * overflows. */
static inline pl_two multiply(pl_two a, pl_two b)
{
	pl_two p;
	if (a.hi == 0 || b.hi == 0) {
		return two(0, 0);
	}
	p = two_product(a.hi, b.hi);
	if (!is_finite(p.hi)) {
		return two(p.hi, 0);
	}
	return two_sum(p.hi, p.lo + (a.hi * b.lo + a.lo * b.hi));
}

#endif
