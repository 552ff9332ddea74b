/* SPDX-License-Identifier: MIT-0 */
/* words.h: integers of several words, for the runtime's own use.  A product with a rate is exact here; who needs it
 * takes out of it the bits that count. */
#ifndef PLRT_WORDS_H
#define PLRT_WORDS_H

#include "real.h"

/* A 128-bit integer. */
typedef struct words_pair {
	uint64_t hi, lo;
} words_pair;

/* A 256-bit integer, least significant word first. */
typedef struct words_wide {
	uint64_t word[4];
} words_wide;

/* a b in full, by 32-bit halves: what a Cortex-M0 multiplies, and no 128-bit type. */
static inline words_pair words_product(uint64_t a, uint64_t b)
{
	const uint64_t half = 0xFFFFFFFFu;
	const uint64_t al = a & half, ah = a >> 32, bl = b & half, bh = b >> 32;
	const uint64_t low = al * bl;
	const uint64_t middle = ah * bl + (low >> 32); /* at most (2^32 - 1) 2^32: no carry */
	const uint64_t cross = al * bh + (middle & half);
	words_pair p;
	p.lo = (cross << 32) | (low & half);
	p.hi = ah * bh + (middle >> 32) + (cross >> 32);
	return p;
}

/* a b 2^-64, rounded down: the product of two fractions in units of 2^-64. */
static inline uint64_t words_times(uint64_t a, uint64_t b)
{
	return words_product(a, b).hi;
}

/* The same in units of 2^-32: one instruction of a Cortex-M4. */
static inline uint32_t words_times32(uint32_t a, uint32_t b)
{
	return (uint32_t)((uint64_t)a * b >> 32);
}

static inline words_pair words_negative(words_pair a)
{
	words_pair n;
	n.lo = 0u - a.lo;
	n.hi = 0u - a.hi - (a.lo != 0);
	return n;
}

/* rate |t| = result 2^-*point, exactly.  An infinite t, or not a number, gives 0. */
static inline words_wide words_rate_times(const pl_rate *rate, real t, int *point)
{
	enum { WORDS = sizeof rate->word / sizeof rate->word[0], OF_NO_NUMBER = 2 * REAL_EXPONENTS - 1 };
	real_parts time;
	uint64_t significand, carry = 0;
	words_wide w = {{0, 0, 0, 0}};
	int exponent, i;

	time.value = t;
	significand = time.bits & REAL_FRACTION;
	exponent = (int)(time.bits >> (REAL_DIGITS - 1)) & OF_NO_NUMBER;
	if (exponent == OF_NO_NUMBER) {
		significand = 0;
	} else if (exponent != 0) {
		significand |= REAL_FRACTION + 1;
	} else {
		exponent = 1; /* subnormal: the same unit, no leading bit */
	}
	for (i = 0; i < WORDS; i++) {
		words_pair p = words_product(rate->word[WORDS - 1 - i], significand);
		p.lo += carry;
		p.hi += p.lo < carry;
		w.word[i] = p.lo;
		carry = p.hi;
	}
	w.word[WORDS] = carry;
	*point = rate->exponent - (exponent - (REAL_EXPONENTS + REAL_DIGITS - 2));
	return w;
}

/* The 64 bits of w from bit `from` upwards; bits outside w are 0. */
static inline uint64_t words_from(const words_wide *w, int from)
{
	uint64_t bits = 0;
	int i;
	for (i = 0; i < 4; i++) {
		const int shift = 64 * i - from; /* where word i comes to lie */
		if (shift >= 0 && shift < 64) {
			bits |= w->word[i] << shift;
		} else if (shift < 0 && shift > -64) {
			bits |= w->word[i] >> -shift;
		}
	}
	return bits;
}

/* w in units of bit `unit`, rounded to nearest (halves up), mod 2^128. */
static inline words_pair words_rounded(const words_wide *w, int unit)
{
	words_pair a;
	a.lo = words_from(w, unit);
	a.hi = words_from(w, unit + 64);
	if (words_from(w, unit - 1) & 1) { /* half a unit or more is dropped */
		a.lo++;
		a.hi += a.lo == 0;
	}
	return a;
}

#endif
