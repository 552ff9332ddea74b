/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Whether a sum of powers, exponentials and forcing terms of time stays at 0 or above: by bisection with the ranges of
 * its value and its slope, and to no end by what its parts are at least. */
#include "math/math.h"

enum {
	BITS = 192,
	SMALL = 80,                 /* below 0 by 2^-SMALL of its terms' sizes: where it comes to 0 and turns */
	MOST_NODES = 20000,
	MOST_DOUBLINGS = 30         /* of the time from which on it is known for good */
};

struct bounding {
	int summands;
	const struct summand *summand;
	int nodes;
	mpfi_ptr value, slope, at, power, lower, forcing, turn, part;
	mpfr_ptr tiny;              /* below 0 */
};

static void find_tiny(struct bounding *b)
{
	REAL size = WITH_BITS(BITS);
	mpfr_set_zero(b->tiny, 1);
	for (int i = 0; i < b->summands; i++) {
		mpfr_set_q(size, b->summand[i].factor, MPFR_RNDU);
		mpfr_abs(size, size, MPFR_RNDU);
		mpfr_add(b->tiny, b->tiny, size, MPFR_RNDU);
	}
	mpfr_div_2ui(b->tiny, b->tiny, SMALL, MPFR_RNDU);
	mpfr_neg(b->tiny, b->tiny, MPFR_RNDU);
}

/* One summand over b->at, into value and slope: t^n e^{a t} times cos or sin */
static void add_summand(struct bounding *b, const struct summand *s)
{
	mpfi_set_ui(b->power, 1);
	mpfi_set_ui(b->lower, 0);
	for (int k = 0; k < s->power; k++) {
		mpfi_set(b->lower, b->power);
		mpfi_mul(b->power, b->power, b->at);
	}
	mpfi_mul_ui(b->lower, b->lower, (unsigned long)s->power);       /* n t^(n-1) */
	mpfi_mul_q(b->part, b->at, s->w);
	mpfi_add_q(b->part, b->part, s->p);
	(s->sine ? mpfi_sin : mpfi_cos)(b->forcing, b->part);
	(s->sine ? mpfi_cos : mpfi_sin)(b->turn, b->part);
	mpfi_mul_q(b->turn, b->turn, s->w);
	if (!s->sine)
		mpfi_neg(b->turn, b->turn);
	mpfi_mul_q(b->part, b->forcing, s->a);
	mpfi_add(b->turn, b->turn, b->part);            /* d/dt e^{a t} forcing term = e^{a t} turn */
	mpfi_mul(b->turn, b->turn, b->power);
	mpfi_mul(b->lower, b->lower, b->forcing);
	mpfi_add(b->turn, b->turn, b->lower);
	mpfi_mul(b->forcing, b->forcing, b->power);
	mpfi_mul_q(b->part, b->at, s->a);
	mpfi_exp(b->part, b->part);
	mpfi_mul_q(b->part, b->part, s->factor);
	mpfi_mul(b->forcing, b->forcing, b->part);
	mpfi_mul(b->turn, b->turn, b->part);
	mpfi_add(b->value, b->value, b->forcing);
	mpfi_add(b->slope, b->slope, b->turn);
}

static void value_over(struct bounding *b, mpfr_srcptr from, mpfr_srcptr to)
{
	mpfi_interv_fr(b->at, from, to);
	mpfi_set_ui(b->value, 0);
	mpfi_set_ui(b->slope, 0);
	for (int i = 0; i < b->summands; i++)
		add_summand(b, &b->summand[i]);
}

static bool above(const struct bounding *b, mpfr_srcptr value)
{
	return mpfr_cmp(value, b->tiny) >= 0;
}

static bool above_at(struct bounding *b, mpfr_srcptr time)
{
	value_over(b, time, time);
	return above(b, &b->value->left);
}

/* By the value at the middle and the range of the slope, which stands in b->slope */
static bool above_by_slope(struct bounding *b, mpfr_srcptr from, mpfr_srcptr to, mpfr_srcptr middle)
{
	REAL reach = WITH_BITS(BITS), rise = WITH_BITS(BITS);
	mpfi_mag(rise, b->slope);
	mpfr_sub(reach, to, from, MPFR_RNDU);
	mpfr_mul(rise, rise, reach, MPFR_RNDU);
	value_over(b, middle, middle);
	mpfr_sub(rise, &b->value->left, rise, MPFR_RNDD);
	return above(b, rise);
}

static bool above_between(struct bounding *b, mpfr_srcptr from, mpfr_srcptr to)
{
	if (++b->nodes > MOST_NODES)
		return false;
	value_over(b, from, to);
	if (above(b, &b->value->left))
		return true;
	if (!above(b, &b->value->right))
		return false;
	if (mpfr_sgn(&b->slope->left) >= 0)
		return above_at(b, from);
	if (mpfr_sgn(&b->slope->right) <= 0)
		return above_at(b, to);
	REAL middle = WITH_BITS(BITS);
	mpfr_add(middle, from, to, MPFR_RNDN);
	mpfr_div_2ui(middle, middle, 1, MPFR_RNDN);
	bool halves = mpfr_cmp(from, middle) < 0 && mpfr_cmp(middle, to) < 0;
	return above_by_slope(b, from, to, middle) ||
	       (halves && above_at(b, middle) && above_between(b, from, middle) && above_between(b, middle, to));
}

/* ---- to no end ---- */

/* The k-th derivative of t^n at `time`, times a factor, onto sum */
static void add_power(mpq_ptr sum, mpq_srcptr factor, int n, int k, mpq_srcptr time)
{
	RATIONAL part = ZERO, by = ZERO;
	mpq_set(part, factor);
	for (int i = 0; i < k; i++) {
		mpq_set_si(by, n - i, 1);
		mpq_mul(part, part, by);
	}
	for (int i = k; i < n; i++)
		mpq_mul(part, part, time);
	mpq_add(sum, sum, part);
}

/* What the summand is at least from `time` on, if a power of t: its factor; false: by no power */
static bool least_factor(const struct summand *s, mpq_ptr factor)
{
	mpq_set(factor, s->factor);
	if (mpq_sgn(s->w) == 0)
		return mpq_sgn(s->a) == 0;
	mpq_abs(factor, factor);
	mpq_neg(factor, factor);
	return mpq_sgn(s->a) == 0;
}

/* A decaying summand, of which at most its size at `time` is taken from then on: below 0, into `loss`; false: it still
 * grows there, or grows for good */
static bool least_decay(struct bounding *b, const struct summand *s, mpq_srcptr time, mpfr_ptr loss)
{
	if (mpq_sgn(s->w) == 0 && mpq_sgn(s->factor) > 0)
		return true;
	if (mpq_sgn(s->a) > 0)
		return false;
	RATIONAL turns = ZERO;
	mpq_set_si(turns, -s->power, 1);
	mpq_div(turns, turns, s->a);                    /* t^n e^{a t} falls from there on */
	bool falls = mpq_cmp(turns, time) <= 0;
	mpfi_set_q(b->at, time);
	mpfi_mul_q(b->part, b->at, s->a);
	mpfi_exp(b->part, b->part);
	for (int k = 0; k < s->power; k++)
		mpfi_mul(b->part, b->part, b->at);
	mpfi_mul_q(b->part, b->part, s->factor);
	mpfi_abs(b->part, b->part);
	mpfr_add(loss, loss, &b->part->right, MPFR_RNDU);
	return falls;
}

/* From `time` on: powers of t whose derivatives are all at least 0 there, more than all that decays */
static bool above_from(struct bounding *b, mpq_srcptr time)
{
	enum { MOST_POWER = 64 };
	bool is = true;
	RATIONAL sum = ZERO, factor = ZERO;
	REAL loss = WITH_BITS(BITS), least = WITH_BITS(BITS);
	mpfr_set_zero(loss, 1);
	for (int k = MOST_POWER; k >= 0 && is; k--) {
		mpq_set_ui(sum, 0, 1);
		for (int i = 0; i < b->summands; i++)
			if (b->summand[i].power >= k && least_factor(&b->summand[i], factor))
				add_power(sum, factor, b->summand[i].power, k, time);
		is = mpq_sgn(sum) >= 0 || k == 0;
	}
	for (int i = 0; i < b->summands && is; i++)
		is = b->summand[i].power <= MOST_POWER &&
		     (mpq_sgn(b->summand[i].a) == 0 || least_decay(b, &b->summand[i], time, loss));
	mpfr_set_q(least, sum, MPFR_RNDD);
	mpfr_sub(least, least, loss, MPFR_RNDD);
	is = is && above(b, least);
	return is;
}

bool sum_stays_positive(int summands, const struct summand *summand, mpq_srcptr from, mpq_srcptr to)
{
	INTERVALS *x = enclosures(8, BITS);
	REAL low = WITH_BITS(BITS), high = WITH_BITS(BITS), tiny = WITH_BITS(BITS);
	struct bounding b = { summands, summand, 0, x[0], x[1], x[2], x[3], x[4], x[5], x[6], x[7], tiny };
	find_tiny(&b);
	RATIONAL time = ZERO, step = RATIO(1, 1);
	mpq_set(time, to ? to : from);
	bool known = to || above_from(&b, time);
	for (int i = 0; i < MOST_DOUBLINGS && !known; i++) {
		mpq_add(time, time, step);
		mpq_mul_2exp(step, step, 1);
		known = above_from(&b, time);
	}
	mpfr_set_q(low, from, MPFR_RNDD);
	mpfr_set_q(high, time, MPFR_RNDU);
	return known && above_between(&b, low, high);
}
