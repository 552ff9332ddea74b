/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "polynomial.h"

enum { DEEPEST = 80, HALVINGS = 190 };

static void start(mpfr_t *p)
{
	for (int k = 0; k <= DEGREE; k++)
		mpfr_init2(p[k], BITS);
}

static void stop(mpfr_t *p)
{
	for (int k = 0; k <= DEGREE; k++)
		mpfr_clear(p[k]);
}

void value_at(mpfr_t *coefficient, mpfr_srcptr s, mpfr_ptr value)
{
	mpfr_set(value, coefficient[DEGREE], MPFR_RNDN);
	for (int k = DEGREE - 1; k >= 0; k--) {         /* a third of the time of mpfr_fma */
		mpfr_mul(value, value, s, MPFR_RNDN);
		mpfr_add(value, value, coefficient[k], MPFR_RNDN);
	}
}

/* p(s) -> p(s + by), by Horner's scheme repeated */
static void shift(mpfr_t *p, mpfr_srcptr by)
{
	mpfr_t part;
	if (mpfr_zero_p(by))
		return;
	mpfr_init2(part, BITS);
	for (int i = 0; i < DEGREE; i++)
		for (int k = DEGREE - 1; k >= i; k--) {
			mpfr_mul(part, p[k + 1], by, MPFR_RNDN);
			mpfr_add(p[k], p[k], part, MPFR_RNDN);
		}
	mpfr_clear(part);
}

/* 1, -1: the sign of sum_{k >= from} k^(from) p_k s^(k - from) for all 0 <= s <= width; 0: it is not known */
static int sign_over(mpfr_t *p, int from, mpfr_srcptr width)
{
	mpfr_t rest, term, power;
	mpfr_inits2(BITS, rest, term, power, (mpfr_ptr)0);
	mpfr_set_zero(rest, 1);
	mpfr_set(power, width, MPFR_RNDN);
	for (int k = from + 1; k <= DEGREE; k++) {
		mpfr_mul(term, p[k], power, MPFR_RNDN);
		mpfr_abs(term, term, MPFR_RNDN);
		mpfr_mul_ui(term, term, from ? (unsigned long)k : 1, MPFR_RNDN);
		mpfr_add(rest, rest, term, MPFR_RNDU);
		mpfr_mul(power, power, width, MPFR_RNDN);
	}
	int sign = mpfr_cmpabs(p[from], rest) > 0 ? mpfr_sgn(p[from]) : 0;
	mpfr_clears(rest, term, power, (mpfr_ptr)0);
	return sign;
}

static void halve_in(mpfr_t *p, mpfr_srcptr width, mpfr_ptr at)
{
	mpfr_t low, high, value;
	mpfr_inits2(BITS, low, high, value, (mpfr_ptr)0);
	mpfr_set_zero(low, 1);
	mpfr_set(high, width, MPFR_RNDN);
	for (int i = 0; i < HALVINGS; i++) {
		mpfr_add(at, low, high, MPFR_RNDN);
		mpfr_div_2ui(at, at, 1, MPFR_RNDN);
		value_at(p, at, value);
		mpfr_set(mpfr_sgn(value) > 0 ? high : low, at, MPFR_RNDN);
	}
	mpfr_set(at, high, MPFR_RNDN);
	mpfr_clears(low, high, value, (mpfr_ptr)0);
}

static bool search(mpfr_t *given, mpfr_srcptr from, mpfr_srcptr width, mpfr_srcptr tiny, int depth, mpfr_ptr at)
{
	mpfr_t p[DEGREE + 1], end, half, middle;
	bool found = false;
	start(p);
	mpfr_inits2(BITS, end, half, middle, (mpfr_ptr)0);
	for (int k = 0; k <= DEGREE; k++)
		mpfr_set(p[k], given[k], MPFR_RNDN);
	shift(p, from);
	const bool may = sign_over(p, 0, width) == 0;   /* be 0 */
	const int slope = may ? sign_over(p, 1, width) : 0;
	if (may && slope > 0)
		value_at(p, width, end);
	if (may && slope > 0 && mpfr_sgn(end) > 0 && mpfr_cmp(p[0], tiny) <= 0) {
		if (mpfr_sgn(p[0]) >= 0)
			mpfr_set_zero(at, 1);
		else
			halve_in(p, width, at);
		mpfr_add(at, at, from, MPFR_RNDN);
		found = true;
	} else if (may && slope == 0 && depth < DEEPEST) {
		mpfr_div_2ui(half, width, 1, MPFR_RNDN);
		mpfr_add(middle, from, half, MPFR_RNDN);
		found = search(given, from, half, tiny, depth + 1, at) ||
			search(given, middle, half, tiny, depth + 1, at);
	}
	stop(p);
	mpfr_clears(end, half, middle, (mpfr_ptr)0);
	return found;
}

bool first_rise(mpfr_t *coefficient, mpfr_srcptr width, mpfr_srcptr tiny, mpfr_ptr at)
{
	mpfr_t zero;
	mpfr_init2(zero, BITS);
	mpfr_set_zero(zero, 1);
	bool found = search(coefficient, zero, width, tiny, 0, at);
	mpfr_clear(zero);
	return found;
}
