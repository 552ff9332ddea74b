/* SPDX-License-Identifier: MIT-0 */
/* runtime/growthf.c against GMP and MPFR. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <inttypes.h>
#include <math.h>
#include <mpfr.h>
#include "plrt.h"

static uint64_t seed = 0x9E3779B97F4A7C15u;

static uint64_t random_word(void)
{
    seed ^= seed << 13;
    seed ^= seed >> 7;
    seed ^= seed << 17;
    return seed * 0x2545F4914F6CDD1Du;
}

static const pl_growthf most = INT64_MAX, least = INT64_MIN;

static pl_growthf integer(int k)
{
    return (pl_growthf)k * ((int64_t)1 << 48);
}

/* any size from 2^-48 up, either sign */
static pl_growthf random_growth(void)
{
    const int64_t a = (int64_t)(random_word() >> 1 >> (random_word() % 63));
    return random_word() & 1 ? -a : a;
}

static void assert_growth(pl_growthf found, pl_growthf expected, const char *what)
{
    if (found != expected)
        fail_msg("%s: found %016" PRIx64 ", expected %016" PRIx64 ", exactly", what, (uint64_t)found,
                 (uint64_t)expected);
}

/* z 2^-48, kept to the range */
static pl_growthf saturated(mpz_t z)
{
    mpz_t high;
    int above;
    mpz_init(high);
    mpz_fdiv_q_2exp(high, z, 63); /* 0 or -1 within the range */
    above = mpz_sgn(high) > 0 ? 1 : mpz_cmp_si(high, -1) < 0 ? -1 : 0;
    mpz_clear(high);
    return above > 0 ? most : above < 0 ? least : mpz_get_si(z);
}

static void sums_are_exact_or_saturate(void **state)
{
    mpz_t x, y;
    int i;
    (void)state;
    mpz_inits(x, y, NULL);
    for (i = 0; i < 100000; i++) {
        const pl_growthf a = random_growth(), b = random_growth();
        mpz_set_si(x, a);
        mpz_set_si(y, b);
        mpz_add(x, x, y);
        assert_growth(pl_growthf_add(a, b), saturated(x), "a + b");
    }
    assert_growth(pl_growthf_add(most, 1), most, "most + smallest");
    assert_growth(pl_growthf_add(least, -1), least, "least - smallest");
    assert_growth(pl_growthf_add(most, most), most, "most + most");
    assert_growth(pl_growthf_add(least, least), least, "least + least");
    assert_growth(pl_growthf_add(most, least), -1, "most + least");
    assert_growth(pl_growthf_add(INT64_MAX - 1, 1), most, "up to the end");
    assert_growth(pl_growthf_add(INT64_MIN + 1, -1), least, "down to the end");
    mpz_clears(x, y, NULL);
}

static void multiples_are_exact_or_saturate(void **state)
{
    mpz_t x;
    int i;
    (void)state;
    mpz_init(x);
    for (i = 0; i < 100000; i++) {
        const pl_growthf a = random_growth();
        const uint64_t n = random_word() >> (random_word() & 63);
        mpz_set_si(x, a);
        mpz_mul_ui(x, x, n);
        assert_growth(pl_growthf_times(a, n), saturated(x), "n a");
    }
    assert_growth(pl_growthf_times(most, 1), most, "1 most");
    assert_growth(pl_growthf_times(least, 1), least, "1 least");
    assert_growth(pl_growthf_times(most, 0), integer(0), "0 most");
    assert_growth(pl_growthf_times(least, 0), integer(0), "0 least");
    assert_growth(pl_growthf_times(most, UINT64_MAX), most, "(2^64 - 1) most");
    assert_growth(pl_growthf_times(least, UINT64_MAX), least, "(2^64 - 1) least");
    assert_growth(pl_growthf_times(integer(-1), 32768), least, "-2^15, which there is");
    assert_growth(pl_growthf_times(integer(1), 32768), most, "2^15, which there is not");
    assert_growth(pl_growthf_times(integer(1), (uint64_t)1 << 48), most, "2^48: the lower word alone would be 0");
    mpz_clear(x);
}

static void multiples_are_repeated_additions(void **state)
{
    int i, n;
    (void)state;
    for (i = 0; i < 1000; i++) {
        const pl_growthf a = random_growth();
        pl_growthf sum = integer(0);
        for (n = 0; n < 100; n++, sum = pl_growthf_add(sum, a))
            assert_growth(pl_growthf_times(a, (uint64_t)n), sum, "n a");
    }
}

/* value in units of 2^-48, rounded to nearest, halves away from 0 */
static pl_growthf growth_of(mpfr_t value)
{
    mpfr_t y;
    mpz_t z;
    pl_growthf a;
    mpfr_init2(y, mpfr_get_prec(value));
    mpz_init(z);
    mpfr_mul_2ui(y, value, 48, MPFR_RNDN);
    mpfr_round(y, y);
    mpfr_get_z(z, y, MPFR_RNDN);
    a = saturated(z);
    mpz_clear(z);
    mpfr_clear(y);
    return a;
}

/* words 2^-exponent, with a random significand */
static pl_ratef random_rate(mpfr_t value, int exponent)
{
    pl_ratef rate;
    mpz_t z;
    int i;
    for (i = 0; i < 2; i++)
        rate.word[i] = random_word();
    rate.word[0] |= (uint64_t)1 << 63;
    rate.exponent = exponent;
    mpz_init(z);
    mpz_import(z, 2, 1, sizeof rate.word[0], 0, 0, rate.word);
    mpfr_set_z(value, z, MPFR_RNDN);
    mpfr_mul_2si(value, value, -(long)exponent, MPFR_RNDN);
    mpz_clear(z);
    return rate;
}

static long inside, beyond; /* how many of the exponents below are not, and are, saturated */

static void assert_growth_at(const pl_ratef *rate, mpfr_t value, mpfr_t scratch, float t)
{
    const int negative = (int)(random_word() & 1);
    pl_growthf found = pl_growthf_at(rate, negative, t), expected;
    mpfr_mul_d(scratch, value, t, MPFR_RNDN); /* at most 152 bits: exact */
    if (negative)
        mpfr_neg(scratch, scratch, MPFR_RNDN);
    expected = growth_of(scratch);
    if (found != expected)
        fail_msg("rate exponent %d, %s, t = %.9g: found %016" PRIx64 ", expected %016" PRIx64 ", exactly",
                 rate->exponent, negative ? "negative" : "positive", (double)t, (uint64_t)found, (uint64_t)expected);
    if (expected == most || expected == least)
        beyond++;
    else if (expected != 0)
        inside++;
}

static void exponent_at_any_time(void **state)
{
    static const float special[] = {0.0f, -0.0f, 1.0f, -1.0f, 0x1p-149f, -0x1p-149f, 0x1.fffffep127f, 0x1p-126f,
                                    0x0.fffffep-126f, 1e30f, -1e-30f, 0.01f, 30.0f};
    mpfr_t value, scratch;
    int i;
    (void)state;
    mpfr_init2(value, 128);
    mpfr_init2(scratch, 600);
    for (i = 0; i < 20000; i++) {
        pl_ratef rate = random_rate(value, (int)(random_word() % 400) - 50);
        union {
            uint32_t bits;
            float t;
        } any;
        any.bits = (uint32_t)random_word();
        if (isfinite(any.t)) /* 1e-38 .. 1e38, either sign */
            assert_growth_at(&rate, value, scratch, any.t);
        assert_growth_at(&rate, value, scratch,
                         ldexpf((float)(int64_t)random_word(), (int)(random_word() % 120) - 100));
        assert_growth_at(&rate, value, scratch, special[(size_t)i % (sizeof special / sizeof special[0])]);
        rate = random_rate(value, (int)(random_word() % 40) + 116); /* about the end of the range and down to 2^-60 */
        assert_growth_at(&rate, value, scratch, ldexpf((float)(int64_t)random_word(), (int)(random_word() % 40) - 65));
        rate = random_rate(value, (int)(random_word() % 140) + 40); /* far from it, but the product is not */
        assert_growth_at(&rate, value, scratch,
                         ldexpf((float)(int64_t)random_word(), rate.exponent - 190 + (int)(random_word() % 20)));
    }
    print_message("# exponents tested: %ld of ordinary size, %ld beyond the range\n", inside, beyond);
    assert_true(inside > 10000 && beyond > 10000);
    mpfr_clears(value, scratch, (mpfr_ptr)0);
}

static void exponent_at_special_times(void **state)
{
    const pl_ratef one = {{(uint64_t)1 << 63, 0}, 127}, none = {{0, 0}, 0};
    const pl_ratef ones = {{UINT64_MAX, UINT64_MAX}, 113};
    (void)state;
    assert_growth(pl_growthf_at(&one, 0, INFINITY), most, "infinite t");
    assert_growth(pl_growthf_at(&one, 1, INFINITY), least, "infinite t, negative rate");
    assert_growth(pl_growthf_at(&one, 0, -INFINITY), least, "t = -infinity");
    assert_growth(pl_growthf_at(&none, 0, INFINITY), integer(0), "infinite t, rate 0");
    assert_growth(pl_growthf_at(&one, 0, NAN), integer(0), "t not a number");
    assert_growth(pl_growthf_at(&one, 1, NAN), integer(0), "t not a number, negative rate");
    assert_growth(pl_growthf_at(&none, 1, 1e10f), integer(0), "rate 0");
    assert_growth(pl_growthf_at(&one, 0, 7.25f), (int64_t)29 << 46, "7.25");
    assert_growth(pl_growthf_at(&one, 1, 7.25f), -((int64_t)29 << 46), "-7.25");
    assert_growth(pl_growthf_at(&one, 1, -7.25f), (int64_t)29 << 46, "7.25 from two signs");
    assert_growth(pl_growthf_at(&one, 0, 0x1p-49f), 1, "half a unit");
    assert_growth(pl_growthf_at(&one, 0, -0x1p-49f), -1, "half a unit, negative");
    assert_growth(pl_growthf_at(&one, 0, 0x1.fffffep-50f), integer(0), "less than half a unit");
    assert_growth(pl_growthf_at(&one, 0, 32767.0f), integer(32767), "the largest integer");
    assert_growth(pl_growthf_at(&one, 0, 32768.0f), most, "2^15");
    assert_growth(pl_growthf_at(&one, 0, -32768.0f), least, "-2^15");
    assert_growth(pl_growthf_at(&ones, 0, 1.0f), most, "rounded up beyond the range");
    assert_growth(pl_growthf_at(&ones, 1, 1.0f), least, "rounded down to its end");
}

/* e^{a t} after 10^9 steps: the only error of the exponent is that of the step's, 2^-49, times n. */
static void exponent_after_a_thousand_million_steps(void **state)
{
    static const double rates[] = {-0.7, 0.3, -1e-9, 1e-300, -0.0001};
    const uint64_t steps = 1000000000;
    mpfr_t step, exact, found;
    size_t i;
    (void)state;
    mpfr_inits2(400, step, exact, found, (mpfr_ptr)0);
    for (i = 0; i < sizeof rates / sizeof rates[0]; i++) {
        double off;
        mpfr_const_log2(step, MPFR_RNDN);
        mpfr_d_div(step, rates[i] * 1e-6, step, MPFR_RNDN); /* h = 1e-6 s */
        mpfr_set_sj_2exp(found, pl_growthf_times(growth_of(step), steps), -48, MPFR_RNDN);
        mpfr_mul_ui(exact, step, (unsigned long)steps, MPFR_RNDN);
        mpfr_sub(found, found, exact, MPFR_RNDN);
        off = mpfr_get_d(found, MPFR_RNDN);
        if (!(fabs(off) <= 0x1p-19))
            fail_msg("exponent after 1e9 steps of rate %.17g off by %.17g, tolerance 2^-19 = %.17g", rates[i], off,
                     0x1p-19);
    }
    mpfr_clears(step, exact, found, (mpfr_ptr)0);
}

/* The same, step by step as generated code goes: the sum after 10^9 steps is the multiple. */
static void additions_do_not_drift(void **state)
{
    const volatile pl_growthf step = -123457; /* read anew each time: no compiler multiplies instead */
    pl_growthf a = integer(90);
    long n;
    (void)state;
    for (n = 0; n < 1000000000; n++)
        a = pl_growthf_add(a, step);
    assert_growth(a, pl_growthf_add(integer(90), pl_growthf_times(step, 1000000000)), "10^9 additions");
}

static void integers_are_exact(void **state)
{
    int k;
    (void)state;
    for (k = -32768; k < 32768; k++) {
        const float found = pl_growthf_value(integer(k)), expected = ldexpf(1.0f, k);
        if (found != expected || signbit(found))
            fail_msg("2^%d: found %.17g, expected %.17g, exactly", k, (double)found, (double)expected);
    }
    assert_true(isinf(pl_growthf_value(most)));
    assert_true(pl_growthf_value(least) == 0);
}

static double worst_error; /* in units of the last place of the result, subnormal or not */

static void assert_value(pl_growthf a, mpfr_t x, mpfr_t exact)
{
    const double found = (double)pl_growthf_value(a);
    double expected, unit, error;
    mpfr_set_sj_2exp(x, a, -48, MPFR_RNDN);
    mpfr_exp2(exact, x, MPFR_RNDN);
    expected = mpfr_get_d(exact, MPFR_RNDN);
    if (isinf(found) && found > 0.0 && expected > 0x1.ffffffp127 * (1.0 - 0x1p-29)) /* what would round to 2^128 */
        return;
    unit = ldexp(1.0, (expected < 0x1p-126 ? -126 : ilogb(expected)) - 23);
    mpfr_sub_d(x, exact, found, MPFR_RNDN);
    mpfr_div_d(x, x, unit, MPFR_RNDN);
    error = fabs(mpfr_get_d(x, MPFR_RNDN));
    if (error > worst_error)
        worst_error = error;
    if (!(error < 0.52) || signbit(found))
        fail_msg("2^(%016" PRIx64 "): found %.9g, expected %.9g; off by %.17g ulp, tolerance 0.52", (uint64_t)a, found,
                 expected, error);
}

static pl_growthf between(int low, int high)
{
    const uint64_t span = (uint64_t)(high - low) << 48;
    return pl_growthf_add(integer(low), (int64_t)(random_word() % span));
}

static void powers_of_2(void **state)
{
    static const int edges[] = {-151, -150, -149, -148, -127, -126, -125, -1, 0, 1, 127, 128, 129};
    mpfr_t x, exact;
    long i;
    (void)state;
    mpfr_inits2(160, x, exact, (mpfr_ptr)0);
    for (i = 0; i < 400000; i++)
        assert_value(between(-153, 129), x, exact);
    for (i = 0; i < 300000; i++)
        assert_value(between(-1, 1), x, exact);
    for (i = 0; i < 200000; i++)
        assert_value(between(-152, -125), x, exact); /* subnormal results */
    for (i = 0; i < 200000; i++) {
        const pl_growthf edge = integer(edges[(size_t)i % (sizeof edges / sizeof edges[0])]);
        const pl_growthf beside = (int64_t)(random_word() >> (random_word() % 49 + 15));
        assert_value(pl_growthf_add(edge, beside), x, exact);
        assert_value(pl_growthf_add(edge, -1 - beside), x, exact);
    }
    print_message("# largest error of pl_growthf_value: %.5f ulp\n", worst_error);
    mpfr_clears(x, exact, (mpfr_ptr)0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(sums_are_exact_or_saturate),
        cmocka_unit_test(multiples_are_exact_or_saturate),
        cmocka_unit_test(multiples_are_repeated_additions),
        cmocka_unit_test(exponent_at_any_time),
        cmocka_unit_test(exponent_at_special_times),
        cmocka_unit_test(exponent_after_a_thousand_million_steps),
        cmocka_unit_test(additions_do_not_drift),
        cmocka_unit_test(integers_are_exact),
        cmocka_unit_test(powers_of_2),
    };
    const int status = cmocka_run_group_tests(tests, NULL, NULL);
    mpfr_free_cache();
    return status;
}
