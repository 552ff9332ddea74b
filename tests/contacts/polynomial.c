/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "polynomial.h"

#include <math.h>

/* Halvings at most, of these in doubles; the derivative from which on there are bounds alone; bits to which a root is
 * closed in on */
enum { DEEPEST = 80, BEYOND = 7, DOUBLES = 12, ALIKE = 180, MOST_TRIES = 400 };

static void value_and_slope(mpfr_t *p, mpfr_srcptr s, mpfr_ptr value, mpfr_ptr slope)
{
	mpfr_set(value, p[DEGREE], MPFR_RNDN);
	mpfr_set_zero(slope, 1);
	for (int k = DEGREE - 1; k >= 0; k--) {         /* a third of the time of mpfr_fma */
		mpfr_mul(slope, slope, s, MPFR_RNDN);
		mpfr_add(slope, slope, value, MPFR_RNDN);
		mpfr_mul(value, value, s, MPFR_RNDN);
		mpfr_add(value, value, p[k], MPFR_RNDN);
	}
}

/* About where p is 0, from `at` on, or `at` where doubles do not know: Newton's method in them */
static double guessed(mpfr_t *p, double at)
{
	double c[DEGREE + 1], start = at, step = at;
	for (int k = 0; k <= DEGREE; k++)
		c[k] = mpfr_get_d(p[k], MPFR_RNDN);
	for (int i = 0; i < DEEPEST && fabs(step) > 1e-15 * fabs(at); i++) {
		double value = c[DEGREE], slope = 0;
		for (int k = DEGREE - 1; k >= 0; k--) {
			slope = slope * at + value;
			value = value * at + c[k];
		}
		step = value / slope;
		at -= step;
	}
	return isfinite(at) ? at : start;
}

/* The root of a p that rises from below 0 at `from` to above it at `to`: by Newton's method from `at`, and halving
 * where that leaves what is known to hold the root */
static void close_in(mpfr_t *p, mpfr_srcptr from, mpfr_srcptr to, mpfr_ptr at)
{
	mpfr_t low, high, value, slope;
	mpfr_inits2(BITS, low, high, value, slope, (mpfr_ptr)0);
	mpfr_set(low, from, MPFR_RNDN);
	mpfr_set(high, to, MPFR_RNDN);
	mpfr_set_d(value, guessed(p, mpfr_get_d(at, MPFR_RNDN)), MPFR_RNDN);
	if (mpfr_cmp(value, low) > 0 && mpfr_cmp(value, high) < 0)
		mpfr_set(at, value, MPFR_RNDN);
	for (int i = 0; i < MOST_TRIES; i++) {
		value_and_slope(p, at, value, slope);
		mpfr_set(mpfr_sgn(value) > 0 ? high : low, at, MPFR_RNDN);
		mpfr_div(value, value, slope, MPFR_RNDN);
		const bool near = mpfr_zero_p(value) || mpfr_get_exp(value) < mpfr_get_exp(to) - ALIKE;
		mpfr_sub(at, at, value, MPFR_RNDN);
		if (near)
			break;
		if (mpfr_cmp(at, low) <= 0 || mpfr_cmp(at, high) >= 0) {
			mpfr_add(at, low, high, MPFR_RNDN);
			mpfr_div_2ui(at, at, 1, MPFR_RNDN);
		}
	}
	mpfr_clears(low, high, value, slope, (mpfr_ptr)0);
}

/* What is searched: p over the whole width, what counts as 0, and how large p^(k)/k! is at most for k = BEYOND */
struct sought {
	mpfr_t *p;
	mpfr_srcptr width, tiny;
	double beyond;
};

/* p(s + by) up to BEYOND, where it is a bound, by Horner's scheme repeated */
static mpfr_t *shifted(const struct sought *f, mpfr_srcptr by)
{
	static mpfr_t p[DEGREE + 1], part;      /* kept: to make them takes as long as a product */
	static bool made;
	for (int k = 0; k <= DEGREE && !made; k++)
		mpfr_init2(p[k], BITS);
	if (!made)
		mpfr_init2(part, BITS);
	made = true;
	for (int k = 0; k <= DEGREE; k++)
		mpfr_set(p[k], f->p[k], MPFR_RNDN);
	for (int i = 0; i < BEYOND && !mpfr_zero_p(by); i++)
		for (int k = DEGREE - 1; k >= i; k--) {
			mpfr_mul(part, p[k + 1], by, MPFR_RNDN);
			mpfr_add(p[k], p[k], part, MPFR_RNDN);
		}
	mpfr_set_d(p[BEYOND], f->beyond, MPFR_RNDU);
	return p;
}

/* 1, -1: the sign of p (from 0), p' (1) or p'' (2) for all 0 <= s <= width; 0: it is not known */
static int sign_over(mpfr_t *p, int from, mpfr_srcptr width)
{
	mpfr_t rest, term, power;
	mpfr_inits2(BITS, rest, term, power, (mpfr_ptr)0);
	mpfr_set_zero(rest, 1);
	mpfr_set(power, width, MPFR_RNDN);
	for (int k = from + 1; k <= BEYOND; k++) {
		mpfr_mul(term, p[k], power, MPFR_RNDN);
		mpfr_abs(term, term, MPFR_RNDN);
		const unsigned long factor[] = { 1, (unsigned long)k, (unsigned long)(k * (k - 1) / 2) };
		mpfr_mul_ui(term, term, factor[from], MPFR_RNDN);
		mpfr_add(rest, rest, term, MPFR_RNDU);
		mpfr_mul(power, power, width, MPFR_RNDN);
	}
	int sign = mpfr_cmpabs(p[from], rest) > 0 ? mpfr_sgn(p[from]) : 0;
	mpfr_clears(rest, term, power, (mpfr_ptr)0);
	return sign;
}

/* A p that is 0 or below it at `from`, and bends one way, rises at most once: where it bends up, if it is above 0 in
 * the end, and there Newton's method comes down to the root; where it bends down, not if it is about to fall. 1, 0:
 * whether it does; -1: that is not known */
static int rises_bent(const struct sought *f, mpfr_t *p, mpfr_srcptr from, mpfr_srcptr width, mpfr_ptr at)
{
	const int bend = mpfr_cmp(p[0], f->tiny) <= 0 ? sign_over(p, 2, width) : 0;
	if (bend == 0)
		return -1;
	if (bend < 0)
		return mpfr_cmp(p[1], f->tiny) <= 0 ? 0 : -1;
	mpfr_t value, slope;
	mpfr_inits2(BITS, value, slope, (mpfr_ptr)0);
	mpfr_add(at, from, width, MPFR_RNDN);
	value_and_slope(f->p, at, value, slope);
	const int rises = mpfr_sgn(value) > 0;
	if (rises) {
		mpfr_set(value, at, MPFR_RNDN);
		close_in(f->p, from, value, at);
	}
	mpfr_clears(value, slope, (mpfr_ptr)0);
	return rises;
}

static bool search(const struct sought *f, mpfr_srcptr from, mpfr_srcptr width, int depth, mpfr_ptr at)
{
	mpfr_t *p = shifted(f, from), to, half, value, slope;
	const bool may = sign_over(p, 0, width) == 0;   /* be 0 */
	const int turn = may ? sign_over(p, 1, width) : 0;
	const int bent = may && turn == 0 ? rises_bent(f, p, from, width, at) : 0;
	bool found = bent == 1;
	mpfr_inits2(BITS, to, half, value, slope, (mpfr_ptr)0);
	if (may && turn > 0 && mpfr_cmp(p[0], f->tiny) <= 0) {
		mpfr_add(to, from, width, MPFR_RNDN);
		value_and_slope(f->p, to, value, slope);
		found = mpfr_sgn(value) > 0;
		mpfr_set(at, from, MPFR_RNDN);
		if (found && mpfr_sgn(p[0]) < 0)
			close_in(f->p, from, to, at);
	} else if (bent < 0 && depth < DEEPEST) {
		mpfr_div_2ui(half, width, 1, MPFR_RNDN);
		mpfr_add(to, from, half, MPFR_RNDN);
		found = search(f, from, half, depth + 1, at) || search(f, to, half, depth + 1, at);
	}
	mpfr_clears(to, half, value, slope, (mpfr_ptr)0);
	return found;
}

/* Whether sum_k c_k s^k is certain not to rise through 0 at 0 <= s <= 1, where `off` is more than doubles round: it, or
 * how much it falls, is larger at 0 than what that changes by */
static bool never_rises(const double *c, double off)
{
	double rest = off, bend = off;
	for (int k = 1; k <= DEGREE; k++) {
		rest += fabs(c[k]);
		bend += k > 1 ? k * fabs(c[k]) : 0;
	}
	return fabs(c[0]) > rest || -c[1] > bend;
}

/* The same in the place-th of the 2^depth parts of the width, where c is the polynomial over this part: halved in
 * doubles, as most pieces of a motion are done with so */
static bool seek(const struct sought *f, const double *c, double off, unsigned long place, int depth, mpfr_ptr at)
{
	double half[2][DEGREE + 1], scale = 1;
	if (never_rises(c, off))
		return false;
	if (depth == DOUBLES) {
		mpfr_t part, from;
		mpfr_inits2(BITS, part, from, (mpfr_ptr)0);
		mpfr_div_2ui(part, f->width, DOUBLES, MPFR_RNDN);
		mpfr_mul_ui(from, part, place, MPFR_RNDN);
		const bool found = search(f, from, part, depth, at);
		mpfr_clears(part, from, (mpfr_ptr)0);
		return found;
	}
	for (int k = 0; k <= DEGREE; k++, scale /= 2)
		half[0][k] = half[1][k] = c[k] * scale;
	for (int i = 0; i < DEGREE; i++)
		for (int k = DEGREE - 1; k >= i; k--)
			half[1][k] += half[1][k + 1];
	return seek(f, half[0], off, 2 * place, depth + 1, at) || seek(f, half[1], off, 2 * place + 1, depth + 1, at);
}

bool first_rise(mpfr_t *coefficient, mpfr_srcptr width, mpfr_srcptr tiny, mpfr_ptr at)
{
	struct sought f = { coefficient, width, tiny, 0 };
	const double whole = mpfr_get_d(width, MPFR_RNDN);
	double c[DEGREE + 1], power = 1, most = 0, off = 1e-39; /* above `tiny` */
	double choices = 1.0001;                /* of BEYOND from k */
	for (int k = 0; k <= DEGREE; k++, power *= whole) {
		c[k] = mpfr_get_d(coefficient[k], MPFR_RNDN) * power;
		most += fabs(c[k]);
		off += 1e-10 * fabs(c[k]);
		choices *= k > BEYOND ? k / (double)(k - BEYOND) : 1;
		f.beyond += k < BEYOND ? 0 : choices * fabs(c[k]) / pow(whole, BEYOND);
	}
	/* nothing rises that counts as 0 all along, and to halve that would have no end */
	return mpfr_cmp_d(tiny, most) < 0 && seek(&f, c, off, 0, 0, at);
}
