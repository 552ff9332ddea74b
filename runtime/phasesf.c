/* SPDX-License-Identifier: MIT-0 */
/* Phases as 64-bit fractions of a turn, and their cosine and sine in integers of 32 bits: with eight bits more than a
 * float keeps there is nothing to gain from floating point, and much to lose where it is software. */
#define REAL_IS_FLOAT
#include "words.h"

pl_phasef pl_phasef_times(pl_phasef a, uint64_t n)
{
	return a * n;
}

pl_phasef pl_phasef_at(const pl_ratef *rate, float t)
{
	int point;
	const words_wide turns = words_rate_times(rate, t, &point);
	const pl_phasef a = words_rounded(&turns, point - 64).lo; /* bit `point` is worth a turn */
	return t < 0 ? 0u - a : a;
}

/* 1 - cos r and 1 - sin r / r in units of 2^-32, from rr = r^2 in the same, |r| <= pi/4.  Minimax by Remez exchange in
 * 50 digits, the coefficients rounded to 2^-32 in turn from the lowest on and the others fitted again each time: within
 * 2^-34 and 2^-36.7, before the products are rounded down. */
static uint32_t less_cosine(uint32_t rr)
{
	uint32_t sum = 0x005B0217 - words_times32(rr, 0x0001992C);
	sum = 0x0AAAA9EE - words_times32(rr, sum);
	sum = 0x7FFFFFF4 - words_times32(rr, sum);
	return words_times32(rr, sum);
}

static uint32_t less_sine(uint32_t rr)
{
	uint32_t sum = 0x000D0087 - words_times32(rr, 0x00002DA3);
	sum = 0x02222215 - words_times32(rr, sum);
	sum = 0x2AAAAAAA - words_times32(rr, sum);
	return words_times32(rr, sum);
}

/* m 2^-power, rounded once: 0 <= power <= 126 */
static float scaled(uint32_t m, int power)
{
	real_parts unit;
	unit.bits = (uint32_t)(127 - power) << 23;
	return (float)m * unit.value;
}

void pl_cossinf(pl_phasef a, float z[2])
{
	const uint32_t half_pi = 0xC90FDAA2; /* pi/2 2^31 */
	const int quarter = (int)((a + ((uint64_t)1 << 61)) >> 62); /* the nearest; 4 wraps to 0 */
	const int odd = quarter & 1;
	uint32_t r, rr;
	int below, power = 29;
	float c, s;

	a -= (uint64_t)quarter << 62; /* now -1/8 <= a < 1/8 turn */
	below = (int)(a >> 63);
	if (below) {
		a = 0u - a; /* at most 2^61 */
	}
	r = (uint32_t)((a >> 29) * half_pi >> 32); /* radians, in units of 2^-32 */
	rr = words_times32(r, r);
	c = scaled(((uint32_t)1 << 31) - (less_cosine(rr) >> 1), 31);

	for (; a >> 56 == 0 && power < 85; power += 8) { /* so that small angles keep their relative accuracy */
		a <<= 8;
	}
	for (; a >> 63 == 0 && power < 92; power++) {
		a <<= 1;
	}
	r = words_times32((uint32_t)(a >> 32), half_pi); /* radians again, in units of 2^-power */
	s = scaled(r - words_times32(r, less_sine(rr)), power);
	s = below ? -s : s;

	z[0] = odd ? s : c;
	z[1] = odd ? c : s;
	if (quarter == 1 || quarter == 2) {
		z[0] = 0 - z[0]; /* not -z[0]: no negative zero */
	}
	if (quarter == 2 || quarter == 3) {
		z[1] = 0 - z[1];
	}
}
