/* SPDX-License-Identifier: MIT-0 */
/* runtime/phases.c against MPFR. */
#include "runtime.h"

/* turn(hi, lo) is hi 2^-64 + lo 2^-128 of a turn; a float's ends with hi */
#ifdef REAL_IS_FLOAT
#define pl_phase pl_phasef
#define pl_phase_add pl_phasef_add
#define pl_phase_times pl_phasef_times
#define pl_phase_at pl_phasef_at
#define pl_cossin pl_cossinf
enum { TURN_BITS = 64, ANGLES = 200000 };
#define TOLERANCE 0.52 /* of a cosine, in units of the last place */
#else
enum { TURN_BITS = 128, ANGLES = 50000 };
#define TOLERANCE 0.6
#endif
#define TURN "%016" PRIx64 " %016" PRIx64

#ifdef REAL_IS_FLOAT
static pl_phase turn(uint64_t hi, uint64_t lo)
{
	(void)lo;
	return hi;
}

static uint64_t high_word(pl_phase a)
{
	return a;
}

static uint64_t low_word(pl_phase a)
{
	(void)a;
	return 0;
}
#else
static pl_phase turn(uint64_t hi, uint64_t lo)
{
	pl_phase a;
	a.hi = hi;
	a.lo = lo;
	return a;
}

static uint64_t high_word(pl_phase a)
{
	return a.hi;
}

static uint64_t low_word(pl_phase a)
{
	return a.lo;
}
#endif

/* k of the smallest part of a turn, which k = -1 has all bits of */
static pl_phase units(int k)
{
	const uint64_t least = (uint64_t)(int64_t)k;
	return TURN_BITS == 64 ? turn(least, 0) : turn(k < 0 ? UINT64_MAX : 0, least);
}

static pl_phase minus(pl_phase a)
{
	const uint64_t lo = 0u - low_word(a);
	return turn(~high_word(a) + (lo == 0), lo);
}

static pl_phase random_turn(void)
{
	const uint64_t hi = random_word();
	return turn(hi, random_word());
}

/* 2^-shift of a turn or less */
static pl_phase small_turn(int shift)
{
	return shift < 64 ? turn(random_word() >> shift, random_word()) : turn(0, random_word() >> (shift - 64));
}

static int same_turn(pl_phase a, pl_phase b)
{
	return high_word(a) == high_word(b) && low_word(a) == low_word(b);
}

static void assert_turn(pl_phase found, pl_phase expected, const char *what)
{
	if (!same_turn(found, expected))
		fail_msg("%s: found " TURN ", expected " TURN ", exactly", what, high_word(found), low_word(found),
				 high_word(expected), low_word(expected));
}

/* a in turns */
static void set_turn(mpfr_t x, pl_phase a)
{
	const uint64_t words[2] = {high_word(a), low_word(a)};
	mpz_t z;
	mpz_init(z);
	mpz_import(z, 2, 1, sizeof words[0], 0, 0, words);
	mpfr_set_z(x, z, MPFR_RNDN);
	mpfr_div_2ui(x, x, 128, MPFR_RNDN);
	mpz_clear(z);
}

/* x mod 1 turn in units of 2^-TURN_BITS turn, rounded to nearest, halves away from 0 */
static pl_phase turn_of(mpfr_t x)
{
	mpfr_t y;
	mpz_t z, word;
	uint64_t words[2] = {0, 0};
	mpfr_init2(y, mpfr_get_prec(x));
	mpz_inits(z, word, NULL);
	mpfr_mul_2ui(y, x, TURN_BITS, MPFR_RNDN);
	mpfr_round(y, y);
	mpfr_get_z(z, y, MPFR_RNDN);
	mpz_mul_2exp(z, z, 128 - TURN_BITS);
	mpz_fdiv_r_2exp(z, z, 128);
	mpz_fdiv_q_2exp(word, z, 64);
	mpz_export(&words[0], NULL, 1, sizeof words[0], 0, 0, word);
	mpz_fdiv_r_2exp(word, z, 64);
	mpz_export(&words[1], NULL, 1, sizeof words[1], 0, 0, word);
	mpz_clears(z, word, NULL);
	mpfr_clear(y);
	return turn(words[0], words[1]);
}

static void addition_wraps(void **state)
{
	const pl_phase quarter = turn((uint64_t)1 << 62, 0), three_quarters = turn((uint64_t)3 << 62, 0);
	(void)state;
#ifndef REAL_IS_FLOAT
	assert_turn(pl_phase_add(turn(0, UINT64_MAX), turn(0, 1)), turn(1, 0), "carry");
#endif
	assert_turn(pl_phase_add(units(-1), units(1)), units(0), "wrap");
	assert_turn(pl_phase_add(units(-1), units(-1)), units(-2), "wrap with carry");
	assert_turn(pl_phase_add(pl_phase_add(three_quarters, units(5)), pl_phase_add(quarter, units(6))), units(11),
				"3/4 + 1/4");
}

static void multiples_are_repeated_additions(void **state)
{
	int i, n;
	(void)state;
	for (i = 0; i < 200; i++) {
		const pl_phase a = random_turn();
		pl_phase sum = units(0);
		for (n = 0; n < 100; n++, sum = pl_phase_add(sum, a))
			assert_turn(pl_phase_times(a, (uint64_t)n), sum, "n a");
	}
	assert_turn(pl_phase_times(units(-1), UINT64_MAX), TURN_BITS == 64 ? units(1) : turn(UINT64_MAX, 1),
				"(-1)(2^64 - 1)");
}

static void multiples_are_exact(void **state)
{
	mpfr_t x, n;
	int i;
	(void)state;
	mpfr_init2(x, 200);
	mpfr_init2(n, 64);
	for (i = 0; i < 20000; i++) {
		const pl_phase a = random_turn();
		const uint64_t times = random_word() >> (random_word() & 63);
		set_turn(x, a);
		mpfr_set_uj(n, times, MPFR_RNDN);
		mpfr_mul(x, x, n, MPFR_RNDN); /* at most 192 bits: exact */
		assert_turn(pl_phase_times(a, times), turn_of(x), "n a");
	}
	mpfr_clears(x, n, (mpfr_ptr)0);
}

/* An irrational angle a step, 10^9 steps on: the only error is that of the step's angle, half a unit, times n. Floats,
 * which are the quicker ones, go one by one too: as far in the long form, a tenth of the way in the short one. */
static void phase_after_a_thousand_million_steps(void **state)
{
	const uint64_t steps = 1000000000;
	const double tolerance = ldexp(1.0, 29 - TURN_BITS);
	mpfr_t step, exact, found;
	volatile pl_phase turn_of_step; /* read anew each time: no compiler multiplies instead */
	pl_phase a;
	(void)state;
	mpfr_inits2(400, step, exact, found, (mpfr_ptr)0);
	mpfr_const_pi(step, MPFR_RNDN);
	mpfr_mul_2ui(step, step, 1, MPFR_RNDN);
	mpfr_d_div(step, 0.05, step, MPFR_RNDN); /* w h = 0.05 */
	turn_of_step = turn_of(step);
	a = pl_phase_times(turn_of_step, steps);
#ifdef REAL_IS_FLOAT
	{
		const uint64_t additions = (uint64_t)samples((long)steps);
		pl_phase sum = 0;
		uint64_t n;
		for (n = 0; n < additions; n++)
			sum = pl_phase_add(sum, turn_of_step);
		assert_turn(sum, pl_phase_times(turn_of_step, additions), "so many additions");
	}
#endif
	mpfr_mul_ui(exact, step, (unsigned long)steps, MPFR_RNDN);
	mpfr_frac(exact, exact, MPFR_RNDN);
	set_turn(found, a);
	mpfr_sub(found, found, exact, MPFR_RNDN);
	if (!(fabs(mpfr_get_d(found, MPFR_RNDN)) <= tolerance))
		fail_msg("phase after 1e9 steps off by %.17g turn, tolerance %.17g", mpfr_get_d(found, MPFR_RNDN),
				tolerance);
	mpfr_clears(step, exact, found, (mpfr_ptr)0);
}

static void assert_turn_at(const pl_rate *rate, mpfr_t value, mpfr_t scratch, real t)
{
	pl_phase found, expected;
	mpfr_mul_d(scratch, value, t, MPFR_RNDN); /* at most 245 bits: exact */
	found = pl_phase_at(rate, t);
	expected = turn_of(scratch);
	if (!same_turn(found, expected))
		fail_msg("rate exponent %d, t = " NUMBER ": found " TURN ", expected " TURN ", exactly", rate->exponent,
				 (double)t, high_word(found), low_word(found), high_word(expected), low_word(expected));
}

static void phase_at_any_time(void **state)
{
	static const real special[] = SPECIAL_TIMES;
	mpfr_t value, scratch;
	int i;
	(void)state;
	mpfr_init2(value, 64 * RATE_WORDS);
	mpfr_init2(scratch, LONGEST);
	for (i = 0; i < 20000; i++) {
		const pl_rate rate = random_rate(value, (int)(random_word() % EXPONENTS) - 50);
		real_parts any;
		real t;
		any.bits = (real_bits)random_word();
		if (isfinite(any.value)) /* of any size, either sign */
			assert_turn_at(&rate, value, scratch, any.value);
		t = (real)(int64_t)random_word();
		assert_turn_at(&rate, value, scratch, (real)ldexp(t, (int)(random_word() % SCALES) + LEAST_SCALE));
		assert_turn_at(&rate, value, scratch, special[(size_t)i % (sizeof special / sizeof special[0])]);
	}
	mpfr_clears(value, scratch, (mpfr_ptr)0);
}

static void phase_at_no_time(void **state)
{
	const pl_rate hertz = {{(uint64_t)1 << 63}, 64 * RATE_WORDS - 1}, none = {{0}, 0};
	const real half = (real)ldexp(1, -TURN_BITS - 1);
	(void)state;
	assert_turn(pl_phase_at(&hertz, (real)INFINITY), units(0), "infinite t");
	assert_turn(pl_phase_at(&hertz, -(real)INFINITY), units(0), "infinite t");
	assert_turn(pl_phase_at(&hertz, (real)NAN), units(0), "t not a number");
	assert_turn(pl_phase_at(&none, (real)1e10), units(0), "rate 0");
	assert_turn(pl_phase_at(&hertz, (real)7.25), turn((uint64_t)1 << 62, 0), "1 Hz after 7.25 s");
	assert_turn(pl_phase_at(&hertz, -(real)7.25), turn((uint64_t)3 << 62, 0), "1 Hz after -7.25 s");
	assert_turn(pl_phase_at(&hertz, half), units(1), "half a unit");
	assert_turn(pl_phase_at(&hertz, -half), units(-1), "half a unit, negative");
	assert_turn(pl_phase_at(&hertz, half * (1 - REAL_EPSILON / 2)), units(0), "less than half a unit");
}

static void quarter_turns_are_exact(void **state)
{
	static const real circle[4][2] = {{1, 0}, {0, 1}, {-1, 0}, {0, -1}};
	uint64_t q;
	real z[2];
	int i;
	(void)state;
	for (q = 0; q < 4; q++) {
		pl_cossin(turn(q << 62, 0), z);
		for (i = 0; i < 2; i++)
			if (z[i] != circle[q][i] || (z[i] == 0 && signbit(z[i])))
				fail_msg("%s of %d quarter turns: found " NUMBER ", expected " NUMBER ", exactly",
						 i ? "sine" : "cosine", (int)q, (double)z[i], (double)circle[q][i]);
	}
}

static void assert_pair(const real z[2], real c, real s, pl_phase a, const char *what)
{
	if (z[0] != c || z[1] != s)
		fail_msg("%s of " TURN ": found " NUMBER ", " NUMBER ", expected " NUMBER ", " NUMBER ", exactly", what,
				 high_word(a), low_word(a), (double)z[0], (double)z[1], (double)c, (double)s);
}

static void symmetric_to_the_last_bit(void **state)
{
	int i;
	(void)state;
	for (i = 0; i < samples(1000000); i++) { /* anywhere, and beside an eighth */
		const pl_phase eighth = turn(random_word() << 61, 0),
				off = small_turn((int)(random_word() % (TURN_BITS - 1)));
		const pl_phase a = i % 3 == 0 ? random_turn() : pl_phase_add(eighth, i & 1 ? off : minus(off));
		const pl_phase quarter = turn((uint64_t)1 << 62, 0);
		real z[2], y[2];
		pl_cossin(a, z);
		pl_cossin(minus(a), y);
		assert_pair(y, z[0], -z[1], a, "mirror image");
		pl_cossin(pl_phase_add(a, quarter), y);
		assert_pair(y, -z[1], z[0], a, "a quarter turn more");
#ifdef REAL_IS_FLOAT /* doubles are mirrored about eighths but for the last bit */
		pl_cossin(pl_phase_add(quarter, minus(a)), y);
		assert_pair(y, z[1], z[0], a, "mirror image about an eighth");
#endif
	}
}

static void one_eighth_is_symmetric(void **state)
{
	uint64_t i;
	(void)state;
	for (i = 1; i < 8; i += 2) {
		const real r = (real)0x1.6a09e667f3bcdp-1; /* sqrt(1/2), rounded */
		real z[2];
		pl_cossin(turn(i << 61, 0), z);
		assert_pair(z, i == 3 || i == 5 ? -r : r, i >= 5 ? -r : r, turn(i << 61, 0), "odd eighths");
	}
}

static double worst_error; /* in units of the last place */

static void assert_cossin(pl_phase a, mpfr_t angle, mpfr_t c, mpfr_t s, mpfr_t two_pi)
{
	real z[2];
	int i;
	pl_cossin(a, z);
	set_turn(angle, a);
	if (mpfr_cmp_d(angle, 0.5) > 0) /* the smaller angle keeps its bits */
		mpfr_sub_ui(angle, angle, 1, MPFR_RNDN);
	mpfr_mul(angle, angle, two_pi, MPFR_RNDN);
	mpfr_sin_cos(s, c, angle, MPFR_RNDN);
	for (i = 0; i < 2; i++) {
		mpfr_ptr exact = i ? s : c;
		const double expected = mpfr_get_d(exact, MPFR_RNDN);
		double error;
		if (fabs(expected) < ldexp(1.0, -TURN_BITS - 2)) /* quarter turns: 2 pi is not known so well here */
			continue;
		mpfr_sub_d(angle, exact, z[i], MPFR_RNDN);
		error = fabs(mpfr_get_d(angle, MPFR_RNDN)) / ldexp(1.0, ilogb((real)expected) - REAL_DIGITS + 1);
		if (error > worst_error)
			worst_error = error;
		if (!(error < TOLERANCE))
			fail_msg("%s of " TURN ": found " NUMBER ", expected %.17g; off by %.17g ulp, tolerance %.17g",
					 i ? "sine" : "cosine", high_word(a), low_word(a), (double)z[i], expected,
							error, TOLERANCE);
	}
}

static void cosine_and_sine(void **state)
{
	mpfr_t angle, c, s, two_pi;
	long i;
	(void)state;
	mpfr_inits2(320, angle, c, s, two_pi, (mpfr_ptr)0);
	mpfr_const_pi(two_pi, MPFR_RNDN);
	mpfr_mul_2ui(two_pi, two_pi, 1, MPFR_RNDN);
	for (i = 0; i < samples(ANGLES); i++)
		assert_cossin(random_turn(), angle, c, s, two_pi);
	for (i = 0; i < samples(ANGLES); i++) { /* from 2^-3 of a turn down to the smallest part beside an eighth */
		const pl_phase small = small_turn((int)(random_word() % (TURN_BITS - 3)) + 3);
		assert_cossin(pl_phase_add(turn(random_word() << 61, 0), i & 1 ? small : minus(small)), angle, c, s,
				two_pi);
	}
	print_message("# largest error of pl_cossin: %.4f ulp\n", worst_error);
	mpfr_clears(angle, c, s, two_pi, (mpfr_ptr)0);
}

ROOM(phases,
	cmocka_unit_test(addition_wraps),
	cmocka_unit_test(multiples_are_repeated_additions),
	cmocka_unit_test(multiples_are_exact),
	cmocka_unit_test(phase_after_a_thousand_million_steps),
	cmocka_unit_test(phase_at_any_time),
	cmocka_unit_test(phase_at_no_time),
	cmocka_unit_test(quarter_turns_are_exact),
	cmocka_unit_test(symmetric_to_the_last_bit),
	cmocka_unit_test(one_eighth_is_symmetric),
	cmocka_unit_test(cosine_and_sine))
