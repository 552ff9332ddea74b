/* SPDX-License-Identifier: MIT-0 */
/* runtime/rate.c against w / (2 pi), and sums of (before - after) t / (2 pi), of 400 bits. */
#include "runtime.h"

#ifdef REAL_IS_FLOAT
enum { WORDS = 2, LEAST = FLT_MIN_EXP, MOST = FLT_MAX_EXP, BOUND = -86 };
#else
enum { WORDS = 3, LEAST = DBL_MIN_EXP, MOST = DBL_MAX_EXP, BOUND = -115 };
#endif

enum { BITS = 400 };

static mpfr_t turn, expected, found;

static double uniform(void)
{
	static uint64_t state = 1;
	state = state * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	return (double)(state >> 11) / 0x1p53;
}

/* Error in bits, relative to the rate; least that a double tells where there is none */
static double error_of(pl_two w, const pl_rate *r)
{
	mpfr_set_zero(found, 1);
	for (int i = 0; i < WORDS; i++) {
		mpfr_mul_2ui(found, found, 64, MPFR_RNDN);
		mpfr_add_ui(found, found, r->word[i], MPFR_RNDN);
	}
	mpfr_mul_2si(found, found, -r->exponent, MPFR_RNDN);
	mpfr_set_d(expected, (double)w.hi, MPFR_RNDN);
	mpfr_add_d(expected, expected, (double)w.lo, MPFR_RNDN);
	mpfr_div(expected, expected, turn, MPFR_RNDN);
	mpfr_sub(found, found, expected, MPFR_RNDN);
	mpfr_div(found, found, expected, MPFR_RNDN);
	return mpfr_zero_p(found) ? -BITS : (double)mpfr_get_exp(found);
}

static void check(pl_two w, double bound, double *worst)
{
	const pl_rate r = pl_rate_of(w);
	const double error = error_of(w, &r);
	*worst = fmax(*worst, error);
	if (error > bound)
		fail_msg("w = %a + %a: off by 2^%g of the rate, bound 2^%g", (double)w.hi, (double)w.lo, error, bound);
	if (r.word[0] >> 63 == 0)
		fail_msg("w = %a + %a: the top bit of word[0] is 0", (double)w.hi, (double)w.lo);
}

/* A second word of any size up to half a unit of the first, 0 now and then */
static void any_frequency(void **state)
{
	double worst = -BITS;
	(void)state;
	for (int k = 0; k < 100000; k++) {
		const int exponent = LEAST + 2 * REAL_DIGITS + (int)(uniform() * (MOST - LEAST - 2 * REAL_DIGITS - 2));
		pl_two w;
		w.hi = (real)ldexp(1 + uniform(), exponent);
		w.lo = k % 4 == 0
				   ? 0
				   : (real)ldexp(2 * uniform() - 1,
						exponent - REAL_DIGITS - (k % 4 == 1 ? (int)(uniform() * 80) : 0));
		check(w, BOUND, &worst);
	}
	print_message("# off by 2^%g at most, bound 2^%d\n", worst, BOUND);
}

/* One word is exact, so only the rate's own bits are short: 2 pi, whole numbers, the ends of the range, subnormal
 * numbers */
static void one_word(void **state)
{
	const double some[] = { 1,
							2,
							5,
							314,
							6.283185307179586,
							1e-3,
							0x1p-20,
							ldexp(1, LEAST - 1),
							ldexp(1, LEAST - REAL_DIGITS),
							ldexp(3, LEAST - REAL_DIGITS),
							ldexp(2 - ldexp(1, 1 - REAL_DIGITS), MOST - 1) };
	double worst = -BITS;
	(void)state;
	for (size_t k = 0; k < sizeof some / sizeof *some; k++) {
		pl_two w = { (real)some[k], 0 };
		check(w, 1 - 64 * WORDS + 1, &worst);
	}
	pl_two pi = { (real)6.283185307179586476925286766559L, 0 };
	pi.lo = (real)(6.283185307179586476925286766559L - (long double)pi.hi);
	check(pi, BOUND, &worst);
}

static void none(void **state)
{
	const pl_two w = { 0, 0 };
	const pl_rate r = pl_rate_of(w);
	(void)state;
	for (int i = 0; i < WORDS; i++)
		assert_int_equal(r.word[i], 0);
}

/* part <- the turn of a lead, from 0 to 1 */
static void part_of_turn(const pl_lead *lead, mpfr_t part)
{
#ifdef REAL_IS_FLOAT
	mpfr_set_ui_2exp(part, lead->phase, -64, MPFR_RNDN);
#else
	mpfr_set_ui_2exp(part, lead->phase.hi, -64, MPFR_RNDN);
	mpfr_set_ui_2exp(found, lead->phase.lo, -128, MPFR_RNDN);
	mpfr_add(part, part, found, MPFR_RNDN);
#endif
}

/* a to the nearest of a + whole turns, from -1/2 to 1/2 */
static double nearest(mpfr_t a)
{
	mpfr_rint_round(found, a, MPFR_RNDN);
	mpfr_sub(found, a, found, MPFR_RNDN);
	return mpfr_get_d(found, MPFR_RNDN);
}

/* Frequencies and times of either sign, alike and far apart: the turn is off by what each product may be off by, and
 * nothing else adds up. */
static void leads(void **state)
{
	enum { MANY = 2000 };
	pl_lead lead;
	real w = 3;
	double worst = 0, bound = 0, angle = 0;
	mpfr_t sum, product, part;
	(void)state;
	mpfr_inits2(BITS, sum, product, part, (mpfr_ptr)0);
	mpfr_set_zero(sum, 1);
	pl_lead_start(&lead);
	for (int k = 0; k < MANY; k++) {
		const real next = (real)((uniform() - 0.3) * ldexp(1, (int)(uniform() * 30) - 10));
		const real t = (real)((uniform() - 0.1) * ldexp(1, (int)(uniform() * 30)));
		pl_lead_change(&lead, w, next, t);
		mpfr_set_d(product, (double)w, MPFR_RNDN);
		mpfr_sub_d(product, product, (double)next, MPFR_RNDN);
		mpfr_mul_d(product, product, (double)t, MPFR_RNDN);
		mpfr_div(product, product, turn, MPFR_RNDN);
		mpfr_add(sum, sum, product, MPFR_RNDN);
		bound += fabs(mpfr_get_d(product, MPFR_RNDN)) * ldexp(1, BOUND) + ldexp(1, -1 - 64 * (WORDS - 1));
		part_of_turn(&lead, part);
		angle = fmax(angle, fabs((double)lead.angle - 6.283185307179586 * nearest(part)));
		mpfr_sub(part, part, sum, MPFR_RNDN);
		const double off = fabs(nearest(part));
		if (off > bound)
			fail_msg("change %d: off by %g turns, bound %g", k, off, bound);
		worst = fmax(worst, off / bound);
		w = next;
	}
	if (angle > 4 * (double)REAL_EPSILON)
		fail_msg("the angle is off by %g", angle);
	print_message("# %d changes: off by %.2g of the bound, %g turns, at most; angles by %g\n", MANY, worst, bound,
				  angle);
	mpfr_clears(sum, product, part, (mpfr_ptr)0);
}

/* One that does not change leaves the lead as it is, and changes back take it away, to the last bit. */
static void leads_back(void **state)
{
	pl_lead lead;
	(void)state;
	pl_lead_start(&lead);
	pl_lead_change(&lead, 7, 7, 1000);
	assert_true(lead.angle == 0);
	pl_lead_change(&lead, 7, 11, 1000);
	assert_true(lead.angle != 0);
	pl_lead_change(&lead, 11, 7, 1000);
	assert_true(lead.angle == 0);
}

static void start(void)
{
	mpfr_inits2(BITS, turn, expected, found, (mpfr_ptr)0);
	mpfr_const_pi(turn, MPFR_RNDN);
	mpfr_mul_2ui(turn, turn, 1, MPFR_RNDN);
}

static void end(void)
{
	mpfr_clears(turn, expected, found, (mpfr_ptr)0);
}

ROOM_WITH(rate, start, end,
	cmocka_unit_test(any_frequency),
	cmocka_unit_test(one_word),
	cmocka_unit_test(none),
	cmocka_unit_test(leads),
	cmocka_unit_test(leads_back))
