/* SPDX-License-Identifier: MIT-0 */
/* flush.h: decayed states become 0, before they are denormal: such numbers have fewer bits, and some processors take
 * many times as long; to look every 64 steps is often enough.  A part of a model is what no other state acts on.  In a
 * part that decays a state becomes 0 below 2^-963 (float: 2^-116), beside others of its part below 2^-900 (2^-120) of
 * the largest.  It is the exponent that is compared, without arithmetic.  Included by the file of the model before its
 * steps, which defines before it
 *
 *     PL_TYPE                    the model, with a member y, and low if compensated
 *     PL_FLUSHES, PL_DECAYING    parts; the first of them, which decay
 *     PL(flush_part)[]           of each state its part, where there is more than one
 *     PL_FLUSHES_BESIDE          1: states are compared with others, too
 *     PL_COMPENSATED             1: low parts of states become 0 with them
 *     PL_FLUSH_BITS, PL_FLUSH_FUNCTION    in a kernel: integers of a number's size, its functions' qualifier */
#include "numbers.h"

#ifndef PL_FLUSH_FUNCTION
#define PL_FLUSH_FUNCTION
#if PL_SINGLE
#define PL_FLUSH_BITS uint32_t
#else
#define PL_FLUSH_BITS uint64_t
#endif
#endif
#if PL_SINGLE
enum { PL(flush_shift) = 24, PL(flush_least) = 11, PL(flush_beside) = 120, PL(flush_one) = 127 };
#else
enum { PL(flush_shift) = 53, PL(flush_least) = 60, PL(flush_beside) = 900, PL(flush_one) = 1023 };
#endif
#if PL_FLUSHES > 1
#define PL_FLUSH_PART(i) PL(flush_part)[i]
#else
#define PL_FLUSH_PART(i) 0
#endif

static inline PL_FLUSH_FUNCTION int PL(flush_exponent)(real value)
{
	union {
		real value;
		PL_FLUSH_BITS bits;
	} of;
	of.value = value;
	return (int)((of.bits << 1) >> PL(flush_shift));
}

static PL_APART PL_FLUSH_FUNCTION void PL(flush)(PL_TYPE *s)
{
	int i;
#if PL_FLUSHES_BESIDE
	short most[PL_FLUSHES] = {0};
	for (i = 0; i < PL_STATES; i++) {
		const int exponent = PL(flush_exponent)(s->y[i]);
		short *const of_part = &most[PL_FLUSH_PART(i)];
		*of_part = exponent > *of_part ? (short)exponent : *of_part;
	}
#endif
	for (i = 0; i < PL_STATES; i++) {
		int least = PL_FLUSH_PART(i) < PL_DECAYING ? PL(flush_least) : 0;
#if PL_FLUSHES_BESIDE
		const int small = most[PL_FLUSH_PART(i)] - PL(flush_beside);
		least = small > least && small < PL(flush_one) ? small : least;
#endif
		if (PL(flush_exponent)(s->y[i]) < least) {
			s->y[i] = 0;
#if PL_COMPENSATED
			s->low[i] = 0;
#endif
		}
	}
}

#undef PL_FLUSH_BITS
#undef PL_FLUSH_FUNCTION
#undef PL_FLUSH_PART
#include "undef.h"
