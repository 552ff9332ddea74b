/* SPDX-License-Identifier: MIT-0 */
/* The rate of a load's phase from an angular frequency that is known on the target only, and phases that go on where
 * such a frequency changes. */
#include "two.h"
#include "words.h"

enum { INVERSE = 4, WIDE = 6, RATE = sizeof ((pl_rate *)0)->word / sizeof(uint64_t) };

/* 1/(2 pi) 2^258, least significant word first */
static const uint64_t inverse_of_turn[INVERSE] = { UINT64_C(0xfe5163abdebbc562), UINT64_C(0xdb6295993c439041),
							   UINT64_C(0xfc2757d1f534ddc0), UINT64_C(0xa2f9836e4e441529) };

/* |a| as an integer times 2^*exponent */
static uint64_t digits_of(real a, int *exponent)
{
	enum { OF_NO_NUMBER = 2 * REAL_EXPONENTS - 1 };
	real_parts u;
	int e;
	u.value = a;
	e = (int)(u.bits >> (REAL_DIGITS - 1)) & OF_NO_NUMBER;
	*exponent = (e == 0 ? 1 : e) - (REAL_EXPONENTS + REAL_DIGITS - 2);
	return (u.bits & REAL_FRACTION) | (e == 0 ? 0 : REAL_FRACTION + 1);
}

/* w 2^(64 - e), e the exponent of its high word, to an integer: *m, least significant word first.  The low word is at
 * most half a unit of the high one, so it is moved up by 11 bits at most. */
static void in_integers(pl_two w, uint64_t m[2], int *e)
{
	int lower, up;
	uint64_t low = digits_of(w.lo, &lower);
	m[1] = digits_of(w.hi, e);
	up = lower - *e + 64;
	low = up >= 64 || up <= -64 ? 0 : up >= 0 ? low << up : low >> -up;
	m[0] = w.lo < 0 ? 0u - low : low;
	if (w.lo < 0 && low != 0) {
		m[1]--;
	}
}

/* product[from] ... += p */
static void add_pair(uint64_t *product, int from, words_pair p)
{
	uint64_t carry;
	int i;
	product[from] += p.lo;
	carry = product[from] < p.lo; /* p.hi + 1 does not overflow: it is at most 2^64 - 2 */
	p.hi += carry;
	product[from + 1] += p.hi;
	carry = product[from + 1] < p.hi;
	for (i = from + 2; carry != 0 && i < WIDE; i++) {
		carry = ++product[i] == 0;
	}
}

pl_rate pl_rate_of(pl_two w)
{
	uint64_t m[2], product[WIDE] = {0, 0, 0, 0, 0, 0};
	pl_rate rate;
	int i, j, e, shift = 0, top = WIDE - 1;

	in_integers(w, m, &e);
	for (i = 0; i < 2; i++) {
		for (j = 0; j < INVERSE; j++) {
			add_pair(product, i + j, words_product(m[i], inverse_of_turn[j]));
		}
	}
	while (top > 0 && product[top] == 0) {
		top--;
	}
	if (product[top] != 0) {
		while (product[top] << shift >> 63 == 0) {
			shift++;
		}
	}
	for (i = 0; i < RATE; i++) {
		const uint64_t here = top - i >= 0 ? product[top - i] : 0, below = top - i > 0
				? product[top - i - 1] : 0;
		rate.word[i] = shift == 0 ? here : here << shift | below >> (64 - shift);
	}
	rate.exponent = product[top] == 0 ? 0 : 64 + 258 - e - 64 * (top - RATE + 1) + shift;
	return rate;
}

/* In the top 64 bits of a turn an angle has all digits that a number of radians can show. */
#ifdef REAL_IS_FLOAT
#define TOP(phase) (phase)
#define RADIANS 0x1.921fb6p-62f
#else
#define TOP(phase) ((phase).hi)
#define RADIANS 0x1.921fb54442d18p-62
#endif

void pl_lead_change(pl_lead *lead, real before, real after, real t)
{
	const pl_two less = two_sum(before, -after);
	const int falls = less.hi > 0;
	const pl_rate rate = pl_rate_of(falls ? less : two(-less.hi, -less.lo));
	lead->phase = pl_phase_add(lead->phase, pl_phase_at(&rate, falls ? t : -t));
	lead->angle = (real)(int64_t)TOP(lead->phase) * RADIANS;
}
