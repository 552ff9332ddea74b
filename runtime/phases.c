/* SPDX-License-Identifier: MIT-0 */
/* Phases as 128-bit fractions of a turn.  An unsigned integer wraps where a phase does, so a phase that is counted in
 * turns does not lose accuracy with time, as w*t in radians does. */
#include "words.h"

pl_phase pl_phase_times(pl_phase a, uint64_t n)
{
	const words_pair p = words_product(a.lo, n);
	pl_phase m;
	m.lo = p.lo;
	m.hi = p.hi + a.hi * n;
	return m;
}

pl_phase pl_phase_at(const pl_rate *rate, double t)
{
	int point;
	const words_wide turns = words_rate_times(rate, t, &point);
	words_pair p = words_rounded(&turns, point - 128); /* bit `point` is worth a turn */
	pl_phase a;
	if (t < 0.0) {
		p = words_negative(p);
	}
	a.hi = p.hi;
	a.lo = p.lo;
	return a;
}

enum { TERMS = 7 };

/* (sin r - r + r^3/6)/r^5 and (cos r - 1 + r^2/2)/r^4 as polynomials of r^2, for |r| <= pi/4.  Minimax by Remez
 * exchange in 60 digits, the coefficients rounded in turn from the lowest on and the others fitted again each time. As
 * used, they are within 2^-56.8 |r| and 2^-63.6. */
static double sine_rest(double rr)
{
	return 0x1.1111111110ccdp-7
		+ rr * (-0x1.a01a019e8197ap-13
		+ rr * (0x1.71de3774e6136p-19
		+ rr * (-0x1.ae5fdc4955780p-26
		+ rr * 0x1.5df8f37803cb7p-33)));
}

static double cosine_rest(double rr)
{
	return 0x1.5555555555552p-5
		+ rr * (-0x1.6c16c16c15d3cp-10
		+ rr * (0x1.a01a019db4376p-16
		+ rr * (-0x1.27e4f8b1e9c37p-22
		+ rr * (0x1.1eea5435c92fdp-29
		+ rr * -0x1.8fe084d41baf8p-37))));
}

/* m unit + rest, the first product exact and the sum rounded once but for `rest`.  m < 2^63: signed conversions
 * are the cheaper ones, those of an int the cheapest, and with 52 and 11 bits nothing is lost in them. */
static double sum(uint64_t m, double unit, double rest)
{
	const uint64_t low = 0x7FF;
	return (double)(int64_t)(m & ~low) * unit + ((double)(int)(m & low) * unit + rest);
}

/* The large terms, r - r^3/6 and 1 - r^2/2, in integers of 63 bits; the small rest in doubles, where no rounding of
 * them can be seen. */
void pl_cossin(pl_phase a, double z[2])
{
	const uint64_t half_pi = 0xC90FDAA22168C235; /* pi/2 2^63 */
	const uint64_t sixth = 0x2AAAAAAAAAAAAAAB;   /* 2^64/6 */
	const int quarter = (int)(((uint32_t)(a.hi >> 32) + 0x20000000u) >> 30); /* the nearest; 4 wraps to 0 */
	uint64_t x, xx;
	double r, rr, r4, c, s;
	union {
		uint64_t bits;
		double value;
	} unit;
	int shift = 0, below, odd;

	a.hi -= (uint64_t)quarter << 62; /* now -1/8 <= a < 1/8 turn */
	below = (int)(a.hi >> 63);
	if (below) {
		a.lo = 0u - a.lo;
		a.hi = 0u - a.hi - (a.lo != 0);
	}
	a.hi = a.hi << 2 | a.lo >> 62; /* at most 2^63, in units of 2^-66 turn */
	a.lo <<= 2;
	/* So that small angles keep their relative accuracy; half a word at a time while that is empty: eleven rounds
	 * at
	 * most, however small */
	while (a.hi >> 59 == 0 && shift < 128) {
		if (a.hi >> 31 == 0) {
			a.hi = a.hi << 32 | a.lo >> 32;
			a.lo <<= 32;
			shift += 32;
		} else {
			a.hi = a.hi << 4 | a.lo >> 60;
			a.lo <<= 4;
			shift += 4;
		}
	}
	/* 2^-(63 + shift): made at once, since a target may multiply in software */
	unit.bits = (uint64_t)(1023 - 63 - shift) << 52;
	x = words_times(a.hi, half_pi); /* radians, in `unit`: less than 2^63 */
	xx = shift < 32 ? words_times(2 * x, 2 * x) >> 2 * shift : 0;

	r = (double)(int64_t)x * unit.value;
	rr = r * r;
	r4 = rr * rr;
	c = sum(((uint64_t)1 << 62) - (xx >> 3), 0x1p-62, r4 * cosine_rest(rr));
	s = sum(x - words_times(x, words_times(xx, sixth)), unit.value, r4 * r * sine_rest(rr));
	s = below ? -s : s;

	odd = quarter & 1;
	z[0] = odd ? s : c;
	z[1] = odd ? c : s;
	if (quarter == 1 || quarter == 2) {
		z[0] = 0.0 - z[0]; /* not -z[0]: no negative zero */
	}
	if (quarter == 2 || quarter == 3) {
		z[1] = 0.0 - z[1];
	}
}
