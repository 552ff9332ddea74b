/* SPDX-License-Identifier: MIT-0 */
/* Sine and cosine in long double for the equations that tests write by hand. libm takes most of its time for the
 * quadrant of an argument, which it finds for any; up to 2^30 quadrants pi/2 in three parts finds it (Cody and Waite;
 * Muller, Elementary Functions, 11.2): the first two have 32 bits, and their multiples are exact. */
#ifndef QUADRANT_H
#define QUADRANT_H

#include <math.h>

/* r, up to about pi/4, with x = r + k pi/2; k mod 4, or -1: left to libm */
static inline int quadrant_of(long double x, long double *r)
{
	const long double k = rintl(x * 0.636619772367581343075535053490057448L);
	if (!(fabsl(k) < 0x1p30L))
		return -1;
	*r = x - k * 0x1.921fb544p+0L;
	*r -= k * 0x1.0b4611a6p-34L;
	*r -= k * 0x1.3198a2e03707344ap-69L;
	return (int)((long)k & 3);
}

static inline long double sin_of(long double x)
{
	long double r = x;
	switch (quadrant_of(x, &r)) {
	case 0: return sinl(r);
	case 1: return cosl(r);
	case 2: return -sinl(r);
	case 3: return -cosl(r);
	default: return sinl(x);
	}
}

static inline long double cos_of(long double x)
{
	long double r = x;
	switch (quadrant_of(x, &r)) {
	case 0: return cosl(r);
	case 1: return -sinl(r);
	case 2: return -cosl(r);
	case 3: return sinl(r);
	default: return cosl(x);
	}
}

#endif
