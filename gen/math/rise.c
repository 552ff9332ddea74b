/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where an enclosed polynomial first rises through 0: isolated by bisection, by the ranges of its value and its slope,
 * then enclosed by Newton's method for intervals. */
#include "math/math.h"

struct rising {
	int degree;
	const mpfi_t *value, *slope;        /* coefficients in s */
	int deepest;
	mpfi_ptr s, g, d;
	mpfr_ptr middle;
};

static void horner(int degree, const mpfi_t *c, mpfi_srcptr s, mpfi_ptr sum)
{
	mpfi_set(sum, c[degree]);
	for (int m = degree - 1; m >= 0; m--) {
		mpfi_mul(sum, sum, s);
		mpfi_add(sum, sum, c[m]);
	}
}

static void horner_at(int degree, const mpfi_t *c, mpfr_srcptr s, mpfi_ptr sum)
{
	mpfi_set(sum, c[degree]);
	for (int m = degree - 1; m >= 0; m--) {
		mpfi_mul_fr(sum, sum, s);
		mpfi_add(sum, sum, c[m]);
	}
}

/* The value over [a, b] by its middle and the range of the slope, which stands in r->d */
static void value_over(struct rising *r, mpfr_srcptr a, mpfr_srcptr b)
{
	mpfi_interv_fr(r->s, a, b);
	horner(r->degree, r->slope, r->s, r->d);
	mpfr_add(r->middle, a, b, MPFR_RNDN);
	mpfr_div_2ui(r->middle, r->middle, 1, MPFR_RNDN);
	horner_at(r->degree, r->value, r->middle, r->g);
	mpfi_sub_fr(r->s, r->s, r->middle);
	mpfi_mul(r->s, r->s, r->d);
	mpfi_add(r->g, r->g, r->s);
}

/* at = [a, b] holds one root, and the slope is above 0 there */
static void enclose_root(struct rising *r, mpfi_ptr at)
{
	REAL width = WITH_BITS(64), old = WITH_BITS(64);
	mpfi_diam_abs(old, at);
	for (int round = 0; round < 64; round++) {
		mpfi_mid(r->middle, at);
		horner_at(r->degree, r->value, r->middle, r->g);
		horner(r->degree, r->slope, at, r->d);
		if (mpfr_sgn(&r->d->left) <= 0)
			break;
		mpfi_div(r->g, r->g, r->d);
		mpfi_fr_sub(r->g, r->middle, r->g);
		mpfi_intersect(r->s, at, r->g);
		if (mpfi_is_empty(r->s)) {              /* it lay before the start, by what that is not known */
			mpfi_set_fr(at, &at->left);
			break;
		}
		mpfi_set(at, r->s);
		mpfi_diam_abs(width, at);
		mpfr_mul_2ui(old, old, 1, MPFR_RNDN);
		mpfr_div_ui(old, old, 3, MPFR_RNDN);
		if (mpfr_cmp(width, old) >= 0)
			break;
		mpfr_set(old, width, MPFR_RNDU);
	}
}

/* On [a, b], where nothing has risen before a */
static enum rise look(struct rising *r, mpfr_srcptr a, mpfr_srcptr b, int depth, mpfi_ptr at)
{
	enum rise found = RISE_NONE;
	value_over(r, a, b);
	if (mpfr_sgn(&r->g->right) <= 0 || mpfr_sgn(&r->d->right) < 0)
		return RISE_NONE;
	if (mpfr_sgn(&r->d->left) > 0) {
		horner_at(r->degree, r->value, b, r->g);
		if (mpfr_sgn(&r->g->right) <= 0)
			return RISE_NONE;
		if (mpfr_sgn(&r->g->left) > 0) {
			mpfi_interv_fr(at, a, b);
			enclose_root(r, at);
			return RISE_AT;
		}
	}
	if (depth == r->deepest)
		return RISE_UNKNOWN;
	REAL split = WITH_BITS(mpfr_get_prec(r->middle));
	mpfr_sub(split, b, a, MPFR_RNDN);
	mpfr_mul_ui(split, split, 499, MPFR_RNDN);      /* not the middle, where a root may be */
	mpfr_div_2ui(split, split, 10, MPFR_RNDN);
	mpfr_add(split, split, a, MPFR_RNDN);
	found = look(r, a, split, depth + 1, at);
	if (found == RISE_NONE)
		found = look(r, split, b, depth + 1, at);
	return found;
}

enum rise first_rise(int degree, const mpfi_t *value, const mpfi_t *slope, mpfr_srcptr end, mpfi_ptr at)
{
	int precision = (int)mpfi_get_prec(value[0]);
	REAL start = WITH_BITS(precision), middle = WITH_BITS(precision);
	INTERVAL s = OVER_BITS(precision), g = OVER_BITS(precision), d = OVER_BITS(precision);
	struct rising r = { degree, value, slope, precision / 2, s, g, d, middle };
	mpfr_set_zero(start, 1);
	return look(&r, start, end, 0, at);
}
