/* SPDX-License-Identifier: MIT-0 */
/* runtime/until.c against MPFR. */
#include "runtime.h"

enum { BITS = 400 };

#ifdef REAL_IS_FLOAT
#define LARGEST_ERROR 0x1p-45 /* of the largest of what is added up */
#else
#define LARGEST_ERROR 0x1p-100
#endif

/* 2^low .. 2^high, about */
static double random_number(int low, int high)
{
	return ldexp((double)(random_word() >> 11 | (uint64_t)1 << 52),
				 low - 52 + (int)(random_word() % (uint64_t)(high - low)));
}

static double worst; /* error, of the largest */

/* found = change - (t0 + k h) but for the documented error, and half a unit in the last place of the result */
static void assert_until(real t0, uint64_t k, pl_two h, pl_two change)
{
	const double found = pl_until(t0, k, h, change);
	mpfr_t exact, steps, t;
	double largest, off, expected;
	mpfr_inits2(BITS, exact, steps, t, (mpfr_ptr)0);
	set_two(steps, h);
	mpfr_set_uj(t, k, MPFR_RNDN);
	mpfr_mul(steps, steps, t, MPFR_RNDN);
	set_two(exact, change);
	largest = fmax(fabs((double)t0), fmax(fabs(mpfr_get_d(exact, MPFR_RNDN)), fabs(mpfr_get_d(steps, MPFR_RNDN))));
	mpfr_sub(exact, exact, steps, MPFR_RNDN);
	mpfr_sub_d(exact, exact, t0, MPFR_RNDN);
	expected = mpfr_get_d(exact, MPFR_RNDN);
	mpfr_sub_d(exact, exact, found, MPFR_RNDN);
	off = fabs(mpfr_get_d(exact, MPFR_RNDN)) - 0.5001 * (double)REAL_EPSILON * fabs(expected);
	mpfr_clears(exact, steps, t, (mpfr_ptr)0);
	if (off / largest > worst)
		worst = off / largest;
	if (!(off <= LARGEST_ERROR * largest))
		fail_msg("t0 = %.17g, k = %" PRIu64
				 ", h = %.17g + %.17g, change = %.17g + %.17g: found %.17g, expected %.17g; off by "
					"%.3g, "
				 "tolerance %.3g",
				 (double)t0, k, (double)h.hi, (double)h.lo, (double)change.hi, (double)change.lo,
						found, expected, off,
				 LARGEST_ERROR * largest);
}

/* A change in the middle of a step, which comes after as many as 2^63 */
static void changes_inside_a_step(void **state)
{
	mpfr_t v, t;
	int i, sign;
	(void)state;
	mpfr_inits2(BITS, v, t, (mpfr_ptr)0);
	for (i = 0; i < samples(300000); i++) {
		const uint64_t k = random_word() >> 1 >> (random_word() % 63);
		const real t0 = i % 3 ? (real)(random_number(-20, 20) * (i % 3 - 1.5)) : 0;
		pl_two h, change;
		mpfr_set_d(v, random_number(-20, 4), MPFR_RNDN);
		mpfr_div_ui(v, v, 1000, MPFR_RNDN);
		h = two_of(v);
		for (sign = -1; sign <= 1; sign++) {
			mpfr_set_uj(t, k, MPFR_RNDN);
			mpfr_add_d(t, t, sign * random_number(-30, 2), MPFR_RNDN);
			mpfr_mul(t, t, v, MPFR_RNDN);
			mpfr_add_d(t, t, t0, MPFR_RNDN);
			change = two_of(t);
			assert_until(t0, k, h, change);
		}
	}
	print_message("# largest error of pl_until: 2^%.2f of the largest\n", log2(worst));
	mpfr_clears(v, t, (mpfr_ptr)0);
}

static void assert_exactly(double found, double expected, const char *what)
{
	if (found != expected)
		fail_msg("%s: found %.17g, expected %.17g, exactly", what, found, expected);
}

static void counts_are_exact(void **state)
{
	const pl_two second = {1, 0}, none = {0, 0};
	uint64_t k;
	int i;
	(void)state;
	for (i = 0; i < 63; i++) {
		const pl_two change = {(real)ldexp(1.0, i), 0};
		assert_exactly(pl_until(0, ((uint64_t)1 << i) - 1, second, change), 1.0, "the step before");
		assert_exactly(pl_until(0, (uint64_t)1 << i, second, change), 0.0, "that step");
		if (i > 0)
			assert_exactly(pl_until(0, ((uint64_t)1 << i) + 1, second, change), -1.0, "the step after");
	}
	for (k = 0; k < 1000; k++)
		assert_exactly(pl_until((real)0.25, k, second, none), -0.25 - (double)k, "since 0");
	assert_exactly(pl_until(5, 0, second, none), -5.0, "no steps");
}

ROOM(until,
	cmocka_unit_test(changes_inside_a_step),
	cmocka_unit_test(counts_are_exact))
