/* SPDX-License-Identifier: MIT-0 */
/* runtime/envelope.c against GMP and MPFR. */
#include "runtime.h"

/* envelope(hi, lo) is hi 2^-48 + lo 2^-112; a float's ends with hi */
#ifdef REAL_IS_FLOAT
#define pl_envelope pl_envelopef
#define pl_envelope_add pl_envelopef_add
#define pl_envelope_times pl_envelopef_times
#define pl_envelope_at pl_envelopef_at
#define pl_envelope_value pl_envelopef_value
enum { GROWTH_BITS = 48, FAR_LEAST = 40, FAR_EXPONENTS = 140, STEPS = 1000000000, START = 90 };
#define TOLERANCE 0.52 /* of a power of 2, in units of the last place */
#define OVERFLOW_SLACK 0x1p-29
#else
enum { GROWTH_BITS = 112, FAR_LEAST = -900, FAR_EXPONENTS = 2000, STEPS = 10000000, START = 900 };
#define TOLERANCE 0.53
#define OVERFLOW_SLACK 0
#endif
#define ENVELOPE "%016" PRIx64 " %016" PRIx64

/* Exponents of the smallest number, the smallest normal one, and of what is beyond the largest */
#ifdef REAL_IS_FLOAT
enum { NORMAL = FLT_MIN_EXP - 1, LEAST = NORMAL - FLT_MANT_DIG + 1, BEYOND = FLT_MAX_EXP };
#else
enum { NORMAL = DBL_MIN_EXP - 1, LEAST = NORMAL - DBL_MANT_DIG + 1, BEYOND = DBL_MAX_EXP };
#endif

#ifdef REAL_IS_FLOAT
static pl_envelope envelope(int64_t hi, uint64_t lo)
{
	(void)lo;
	return hi;
}

static int64_t high_word(pl_envelope a)
{
	return a;
}

static uint64_t low_word(pl_envelope a)
{
	(void)a;
	return 0;
}

static const pl_envelope most = INT64_MAX, least = INT64_MIN;
#else
static pl_envelope envelope(int64_t hi, uint64_t lo)
{
	pl_envelope a;
	a.hi = hi;
	a.lo = lo;
	return a;
}

static int64_t high_word(pl_envelope a)
{
	return a.hi;
}

static uint64_t low_word(pl_envelope a)
{
	return a.lo;
}

static const pl_envelope most = {INT64_MAX, UINT64_MAX}, least = {INT64_MIN, 0};
#endif

static pl_envelope integer(int k)
{
	return envelope((int64_t)k * ((int64_t)1 << 48), 0);
}

/* k of the smallest part */
static pl_envelope units(int k)
{
	return GROWTH_BITS == 48 ? envelope(k, 0) : envelope(k < 0 ? -1 : 0, (uint64_t)(int64_t)k);
}

static pl_envelope negated(pl_envelope a)
{
	return envelope(-high_word(a) - (low_word(a) != 0), 0u - low_word(a));
}

/* any size from the smallest part up, either sign */
static pl_envelope random_envelope(void)
{
	const int shift = (int)(random_word() % (GROWTH_BITS + 15));
	const uint64_t hi = random_word() >> 1, lo = random_word();
	const pl_envelope a = shift < 64 ? envelope((int64_t)(hi >> shift), lo) : envelope(0, lo >> (shift - 64));
	return random_word() & 1 ? negated(a) : a;
}

static int same_envelope(pl_envelope a, pl_envelope b)
{
	return high_word(a) == high_word(b) && low_word(a) == low_word(b);
}

static void assert_envelope(pl_envelope found, pl_envelope expected, const char *what)
{
	if (!same_envelope(found, expected))
		fail_msg("%s: found " ENVELOPE ", expected " ENVELOPE ", exactly", what, (uint64_t)high_word(found),
				 low_word(found), (uint64_t)high_word(expected), low_word(expected));
}

/* a in units of 2^-GROWTH_BITS */
static void set_words(mpz_t z, pl_envelope a)
{
	mpz_set_si(z, high_word(a));
	if (GROWTH_BITS > 48) {
		mpz_mul_2exp(z, z, 64);
		mpz_add_ui(z, z, low_word(a));
	}
}

/* z 2^-GROWTH_BITS, kept to the range */
static pl_envelope saturated(mpz_t z)
{
	mpz_t bound, word;
	pl_envelope a = least;
	mpz_inits(bound, word, NULL);
	set_words(bound, most);
	if (mpz_cmp(z, bound) > 0) {
		a = most;
	} else {
		set_words(bound, least);
		if (mpz_cmp(z, bound) > 0) {
			mpz_mul_2exp(bound, z, 112 - GROWTH_BITS);
			mpz_fdiv_q_2exp(word, bound, 64);
			mpz_fdiv_r_2exp(bound, bound, 64);
			a = envelope(mpz_get_si(word), mpz_get_ui(bound));
		}
	}
	mpz_clears(bound, word, NULL);
	return a;
}

static void sums_are_exact_or_saturate(void **state)
{
	mpz_t x, y;
	int i;
	(void)state;
	mpz_inits(x, y, NULL);
	for (i = 0; i < samples(100000); i++) {
		const pl_envelope a = random_envelope(), b = random_envelope();
		set_words(x, a);
		set_words(y, b);
		mpz_add(x, x, y);
		assert_envelope(pl_envelope_add(a, b), saturated(x), "a + b");
	}
	assert_envelope(pl_envelope_add(most, units(1)), most, "most + smallest");
	assert_envelope(pl_envelope_add(least, units(-1)), least, "least - smallest");
	assert_envelope(pl_envelope_add(most, most), most, "most + most");
	assert_envelope(pl_envelope_add(least, least), least, "least + least");
	assert_envelope(pl_envelope_add(most, least), units(-1), "most + least");
	assert_envelope(pl_envelope_add(negated(pl_envelope_add(least, units(2))), units(1)), most, "up to the end");
	assert_envelope(pl_envelope_add(pl_envelope_add(least, units(1)), units(-1)), least, "down to the end");
	mpz_clears(x, y, NULL);
}

static void multiples_are_exact_or_saturate(void **state)
{
	mpz_t x;
	int i;
	(void)state;
	mpz_init(x);
	for (i = 0; i < samples(100000); i++) {
		const pl_envelope a = random_envelope();
		const uint64_t n = random_word() >> (random_word() & 63);
		set_words(x, a);
		mpz_mul_ui(x, x, n);
		assert_envelope(pl_envelope_times(a, n), saturated(x), "n a");
	}
	assert_envelope(pl_envelope_times(most, 1), most, "1 most");
	assert_envelope(pl_envelope_times(least, 1), least, "1 least");
	assert_envelope(pl_envelope_times(most, 0), integer(0), "0 most");
	assert_envelope(pl_envelope_times(least, 0), integer(0), "0 least");
	assert_envelope(pl_envelope_times(most, UINT64_MAX), most, "(2^64 - 1) most");
	assert_envelope(pl_envelope_times(least, UINT64_MAX), least, "(2^64 - 1) least");
	assert_envelope(pl_envelope_times(integer(-1), 32768), least, "-2^15, which there is");
	assert_envelope(pl_envelope_times(integer(1), 32768), most, "2^15, which there is not");
	assert_envelope(pl_envelope_times(integer(1), (uint64_t)1 << 48), most, "2^48: one word alone would be 0");
	mpz_clear(x);
}

static void multiples_are_repeated_additions(void **state)
{
	int i, n;
	(void)state;
	for (i = 0; i < 1000; i++) {
		const pl_envelope a = random_envelope();
		pl_envelope sum = integer(0);
		for (n = 0; n < 100; n++, sum = pl_envelope_add(sum, a))
			assert_envelope(pl_envelope_times(a, (uint64_t)n), sum, "n a");
	}
}

/* value in units of 2^-GROWTH_BITS, rounded to nearest, halves away from 0 */
static pl_envelope envelope_of(mpfr_t value)
{
	mpfr_t y;
	mpz_t z;
	pl_envelope a;
	mpfr_init2(y, mpfr_get_prec(value));
	mpz_init(z);
	mpfr_mul_2ui(y, value, GROWTH_BITS, MPFR_RNDN);
	mpfr_round(y, y);
	mpfr_get_z(z, y, MPFR_RNDN);
	a = saturated(z);
	mpz_clear(z);
	mpfr_clear(y);
	return a;
}

static long inside, beyond; /* how many of the exponents below are not, and are, saturated */

static void assert_envelope_at(const pl_rate *rate, mpfr_t value, mpfr_t scratch, real t)
{
	const int negative = (int)(random_word() & 1);
	pl_envelope found = pl_envelope_at(rate, negative, t), expected;
	mpfr_mul_d(scratch, value, t, MPFR_RNDN); /* at most 245 bits: exact */
	if (negative)
		mpfr_neg(scratch, scratch, MPFR_RNDN);
	expected = envelope_of(scratch);
	if (!same_envelope(found, expected))
		fail_msg("rate exponent %d, %s, t = " NUMBER ": found " ENVELOPE ", expected " ENVELOPE ", exactly",
				 rate->exponent, negative ? "negative" : "positive", (double)t,
						(uint64_t)high_word(found),
				 low_word(found), (uint64_t)high_word(expected), low_word(expected));
	if (same_envelope(expected, most) || same_envelope(expected, least))
		beyond++;
	else if (high_word(expected) != 0 && high_word(expected) != -1)
		inside++;
}

/* 63 bits times 2^exponent */
static real random_time(int exponent)
{
	const real t = (real)(int64_t)random_word();
	return (real)ldexp(t, exponent);
}

static void exponent_at_any_time(void **state)
{
	static const real special[] = SPECIAL_TIMES;
	mpfr_t value, scratch;
	int i;
	(void)state;
	mpfr_init2(value, 64 * RATE_WORDS);
	mpfr_init2(scratch, LONGEST);
	for (i = 0; i < 20000; i++) {
		pl_rate rate = random_rate(value, (int)(random_word() % EXPONENTS) - 50);
		real_parts any;
		any.bits = (real_bits)random_word();
		if (isfinite(any.value)) /* of any size, either sign */
			assert_envelope_at(&rate, value, scratch, any.value);
		assert_envelope_at(&rate, value, scratch, random_time((int)(random_word() % SCALES) + LEAST_SCALE));
		assert_envelope_at(&rate, value, scratch, special[(size_t)i % (sizeof special / sizeof special[0])]);
		/* about the end of the range and down to 2^-60 */
		rate = random_rate(value, (int)(random_word() % 40) + 64 * RATE_WORDS - 12);
		assert_envelope_at(&rate, value, scratch, random_time((int)(random_word() % 40) - 65));
		/* far from it, but the product is not */
		rate = random_rate(value, (int)(random_word() % FAR_EXPONENTS) + FAR_LEAST);
		assert_envelope_at(&rate, value, scratch,
						 random_time(rate.exponent - 64 * RATE_WORDS - 62
								+ (int)(random_word() % 20)));
	}
	print_message("# exponents tested: %ld of ordinary size, %ld beyond the range\n", inside, beyond);
	assert_true(inside > 10000 && beyond > 10000);
	mpfr_clears(value, scratch, (mpfr_ptr)0);
}

static void exponent_at_special_times(void **state)
{
	const pl_rate one = {{(uint64_t)1 << 63}, 64 * RATE_WORDS - 1}, none = {{0}, 0};
	const real infinite = (real)INFINITY, half = (real)ldexp(1, -GROWTH_BITS - 1);
	pl_rate ones;
	memset(ones.word, 0xff, sizeof ones.word);
	ones.exponent = 64 * RATE_WORDS - 15;
	(void)state;
	assert_envelope(pl_envelope_at(&one, 0, infinite), most, "infinite t");
	assert_envelope(pl_envelope_at(&one, 1, infinite), least, "infinite t, negative rate");
	assert_envelope(pl_envelope_at(&one, 0, -infinite), least, "t = -infinity");
	assert_envelope(pl_envelope_at(&none, 0, infinite), integer(0), "infinite t, rate 0");
	assert_envelope(pl_envelope_at(&one, 0, (real)NAN), integer(0), "t not a number");
	assert_envelope(pl_envelope_at(&one, 1, (real)NAN), integer(0), "t not a number, negative rate");
	assert_envelope(pl_envelope_at(&none, 1, (real)1e10), integer(0), "rate 0");
	assert_envelope(pl_envelope_at(&one, 0, (real)7.25), envelope((int64_t)29 << 46, 0), "7.25");
	assert_envelope(pl_envelope_at(&one, 1, (real)7.25), envelope(-((int64_t)29 << 46), 0), "-7.25");
	assert_envelope(pl_envelope_at(&one, 1, -(real)7.25), envelope((int64_t)29 << 46, 0), "7.25 from two signs");
	assert_envelope(pl_envelope_at(&one, 0, half), units(1), "half a unit");
	assert_envelope(pl_envelope_at(&one, 0, -half), units(-1), "half a unit, negative");
	assert_envelope(pl_envelope_at(&one, 0, half * (1 - REAL_EPSILON / 2)), integer(0), "less than half a unit");
	assert_envelope(pl_envelope_at(&one, 0, 32767), integer(32767), "the largest integer");
	assert_envelope(pl_envelope_at(&one, 0, 32768), most, "2^15");
	assert_envelope(pl_envelope_at(&one, 0, -32768), least, "-2^15");
	assert_envelope(pl_envelope_at(&ones, 0, 1), most, "rounded up beyond the range");
	assert_envelope(pl_envelope_at(&ones, 1, 1), least, "rounded down to its end");
}

/* e^{a t} after 10^9 steps: the only error of the exponent is that of the step's, half a unit, times n. */
static void exponent_after_a_thousand_million_steps(void **state)
{
	static const double rates[] = {-0.7, 0.3, -1e-9, 1e-300, -0.0001};
	const uint64_t steps = 1000000000;
	const double tolerance = ldexp(1.0, 29 - GROWTH_BITS);
	mpfr_t step, exact, found;
	mpz_t z;
	size_t i;
	(void)state;
	mpfr_inits2(400, step, exact, found, (mpfr_ptr)0);
	mpz_init(z);
	for (i = 0; i < sizeof rates / sizeof rates[0]; i++) {
		double off;
		mpfr_const_log2(step, MPFR_RNDN);
		mpfr_d_div(step, rates[i] * 1e-6, step, MPFR_RNDN); /* h = 1e-6 s */
		set_words(z, pl_envelope_times(envelope_of(step), steps));
		mpfr_set_z(found, z, MPFR_RNDN);
		mpfr_div_2ui(found, found, GROWTH_BITS, MPFR_RNDN);
		mpfr_mul_ui(exact, step, (unsigned long)steps, MPFR_RNDN);
		mpfr_sub(found, found, exact, MPFR_RNDN);
		off = mpfr_get_d(found, MPFR_RNDN);
		if (!(fabs(off) <= tolerance))
			fail_msg("exponent after 1e9 steps of rate %.17g off by %.17g, tolerance %.17g", rates[i], off,
					tolerance);
	}
	mpz_clear(z);
	mpfr_clears(step, exact, found, (mpfr_ptr)0);
}

/* The same, step by step as generated code goes: the sum after all steps is the multiple. */
static void additions_do_not_drift(void **state)
{
	const volatile pl_envelope step = GROWTH_BITS == 48 ? units(-123457) : envelope(-1, 0xFFFFFFFF00000001u);
	pl_envelope a = integer(START); /* `step` is read anew each time: no compiler multiplies instead */
	const long steps = samples(STEPS);
	long n;
	(void)state;
	for (n = 0; n < steps; n++)
		a = pl_envelope_add(a, step);
	assert_envelope(a, pl_envelope_add(integer(START), pl_envelope_times(step, (uint64_t)steps)),
			"sum of all steps");
}

static void integers_are_exact(void **state)
{
	int k;
	(void)state;
	for (k = -32768; k < 32768; k++) {
		const real found = pl_envelope_value(integer(k)), expected = (real)ldexp(1.0, k);
		if (found != expected || signbit(found))
			fail_msg("2^%d: found %.17g, expected %.17g, exactly", k, (double)found, (double)expected);
	}
	assert_true(isinf(pl_envelope_value(most)) && pl_envelope_value(most) > 0);
	assert_true(pl_envelope_value(least) == 0);
}

static double worst_error; /* in units of the last place of the result, subnormal or not */

/* Whether infinite is right where the value is: half a unit beyond the largest number */
static int overflows(mpfr_t exact, double slack)
{
	mpfr_t limit;
	int beyond_it;
	mpfr_init2(limit, 160);
	mpfr_set_ui_2exp(limit, 1, -REAL_DIGITS - 1, MPFR_RNDN);
	mpfr_ui_sub(limit, 1, limit, MPFR_RNDN);
	mpfr_mul_2si(limit, limit, BEYOND, MPFR_RNDN);
	mpfr_mul_d(limit, limit, 1 + slack, MPFR_RNDN);
	beyond_it = mpfr_cmp(exact, limit) >= 0;
	mpfr_clear(limit);
	return beyond_it;
}

static void assert_value(pl_envelope a, mpfr_t x, mpfr_t exact)
{
	const double found = (double)pl_envelope_value(a);
	double error;
	long exponent;
	mpz_t z;
	mpz_init(z);
	set_words(z, a);
	mpfr_set_z(x, z, MPFR_RNDN); /* at most 128 bits: exact */
	mpfr_div_2ui(x, x, GROWTH_BITS, MPFR_RNDN);
	mpz_clear(z);
	mpfr_exp2(exact, x, MPFR_RNDN);
	if (isinf(found) ? found < 0 || !overflows(exact, -OVERFLOW_SLACK) : overflows(exact, OVERFLOW_SLACK))
		fail_msg("2^(" ENVELOPE "): found %.17g, expected %.17g or infinity beside it", (uint64_t)high_word(a),
				 low_word(a), found, mpfr_get_d(exact, MPFR_RNDN));
	if (isinf(found))
		return;
	exponent = (long)mpfr_get_exp(exact) - 1;
	exponent = exponent < NORMAL ? NORMAL : exponent >= BEYOND ? BEYOND - 1 : exponent;
	mpfr_sub_d(x, exact, found, MPFR_RNDN);
	mpfr_div_2si(x, x, exponent - REAL_DIGITS + 1, MPFR_RNDN);
	error = fabs(mpfr_get_d(x, MPFR_RNDN));
	if (error > worst_error)
		worst_error = error;
	if (!(error < TOLERANCE) || signbit(found))
		fail_msg("2^(" ENVELOPE "): found %.17g, expected %.17g; off by %.17g ulp, tolerance %.17g",
				 (uint64_t)high_word(a), low_word(a), found, mpfr_get_d(exact, MPFR_RNDN), error,
						TOLERANCE);
}

static pl_envelope between(int low, int high)
{
	const uint64_t span = (uint64_t)(high - low) << 48;
	const uint64_t hi = random_word() % span;
	return pl_envelope_add(integer(low), envelope((int64_t)hi, random_word()));
}

static void powers_of_2(void **state)
{
	static const int edges[] = {LEAST - 2, LEAST - 1, LEAST, LEAST + 1, NORMAL - 1, NORMAL, NORMAL + 1,
								-1, 0, 1, BEYOND - 1, BEYOND, BEYOND + 1};
	mpfr_t x, exact;
	long i;
	(void)state;
	mpfr_inits2(160, x, exact, (mpfr_ptr)0);
	for (i = 0; i < samples(400000); i++)
		assert_value(between(LEAST - 6, BEYOND + 2), x, exact);
	for (i = 0; i < samples(300000); i++)
		assert_value(between(-1, 1), x, exact);
	for (i = 0; i < samples(200000); i++)
		assert_value(between(LEAST - 3, NORMAL + 1), x, exact); /* subnormal results */
	for (i = 0; i < samples(100000); i++) {
		const pl_envelope edge = integer(edges[(size_t)i % (sizeof edges / sizeof edges[0])]);
		const uint64_t off = random_word() >> (random_word() % 49 + 15);
		const pl_envelope beside = envelope((int64_t)off, random_word());
		const pl_envelope below = pl_envelope_add(negated(beside), units(-1));
		const pl_envelope middle =
			pl_envelope_add(edge, envelope((int64_t)1 << 47, 0)); /* where the nearest integer changes */
		assert_value(pl_envelope_add(edge, beside), x, exact);
		assert_value(pl_envelope_add(edge, below), x, exact);
		assert_value(pl_envelope_add(middle, beside), x, exact);
		assert_value(pl_envelope_add(middle, below), x, exact);
	}
	print_message("# largest error of pl_envelope_value: %.5f ulp\n", worst_error);
	mpfr_clears(x, exact, (mpfr_ptr)0);
}

ROOM(envelope,
	cmocka_unit_test(sums_are_exact_or_saturate),
	cmocka_unit_test(multiples_are_exact_or_saturate),
	cmocka_unit_test(multiples_are_repeated_additions),
	cmocka_unit_test(exponent_at_any_time),
	cmocka_unit_test(exponent_at_special_times),
	cmocka_unit_test(exponent_after_a_thousand_million_steps),
	cmocka_unit_test(additions_do_not_drift),
	cmocka_unit_test(integers_are_exact),
	cmocka_unit_test(powers_of_2))
