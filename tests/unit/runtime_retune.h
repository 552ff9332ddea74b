/* SPDX-License-Identifier: MIT-0 */
/* What the tests of runtime/retune.c draw: numbers over many powers of ten, in two words. */
#ifndef TESTS_RETUNE_H
#define TESTS_RETUNE_H

#include "runtime.h"
#include "../emitted/worse.h"

static uint64_t drawn;

static uint64_t random_bits(void) /* splitmix64 */
{
	uint64_t z = drawn += 0x9e3779b97f4a7c15u;
	z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
	z = (z ^ z >> 27) * 0x94d049bb133111ebu;
	return z ^ z >> 31;
}

static inline double between(double a, double b)
{
	return a + (b - a) * (double)(random_bits() >> 11) * 0x1p-53;
}

static inline int below(int n)
{
	return (int)(random_bits() % (unsigned)n);
}

/* e^u, u even between the logarithms */
static inline double scattered(double a, double b)
{
	return exp(between(log(a), log(b)));
}

/* v or -v */
static inline double either(double v)
{
	return below(2) ? v : -v;
}

/* v and a random second word */
static inline pl_two about(double v)
{
	pl_two t;
	t.hi = (real)v;
	t.lo = t.hi * (real)between(-0.25 * REAL_EPSILON, 0.25 * REAL_EPSILON);
	return t;
}

static inline void assert_status(int found, int expected, const char *what)
{
	if (found != expected)
		fail_msg("%s: found status %d, expected %d", what, found, expected);
}

#endif
