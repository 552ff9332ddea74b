/* SPDX-License-Identifier: MIT-0 */
/* runtime/growth.c against GMP and MPFR. */
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

static pl_growth growth(int64_t hi, uint64_t lo)
{
    pl_growth a;
    a.hi = hi;
    a.lo = lo;
    return a;
}

static const pl_growth most = {INT64_MAX, UINT64_MAX}, least = {INT64_MIN, 0};

static pl_growth integer(int k)
{
    return growth((int64_t)k * ((int64_t)1 << 48), 0);
}

/* any size from 2^-112 up, either sign */
static pl_growth random_growth(void)
{
    const int shift = (int)(random_word() % 127);
    const uint64_t hi = random_word() >> 1, lo = random_word();
    const pl_growth a = shift < 64 ? growth((int64_t)(hi >> shift), lo) : growth(0, lo >> (shift - 64));
    return random_word() & 1 ? growth(-a.hi - (a.lo != 0), 0u - a.lo) : a;
}

static void assert_growth(pl_growth found, pl_growth expected, const char *what)
{
    if (found.hi != expected.hi || found.lo != expected.lo)
        fail_msg("%s: found %016" PRIx64 " %016" PRIx64 ", expected %016" PRIx64 " %016" PRIx64 ", exactly", what,
                 (uint64_t)found.hi, found.lo, (uint64_t)expected.hi, expected.lo);
}

static void set_words(mpz_t z, pl_growth a)
{
    mpz_set_si(z, a.hi);
    mpz_mul_2exp(z, z, 64);
    mpz_add_ui(z, z, a.lo);
}

/* z 2^-112, kept to the range */
static pl_growth saturated(mpz_t z)
{
    mpz_t bound, word;
    pl_growth a = least;
    mpz_inits(bound, word, NULL);
    set_words(bound, most);
    if (mpz_cmp(z, bound) > 0) {
        a = most;
    } else {
        set_words(bound, least);
        if (mpz_cmp(z, bound) > 0) {
            mpz_fdiv_q_2exp(word, z, 64);
            a.hi = mpz_get_si(word);
            mpz_fdiv_r_2exp(word, z, 64);
            a.lo = mpz_get_ui(word);
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
    for (i = 0; i < 100000; i++) {
        const pl_growth a = random_growth(), b = random_growth();
        set_words(x, a);
        set_words(y, b);
        mpz_add(x, x, y);
        assert_growth(pl_growth_add(a, b), saturated(x), "a + b");
    }
    assert_growth(pl_growth_add(most, growth(0, 1)), most, "most + smallest");
    assert_growth(pl_growth_add(least, growth(-1, UINT64_MAX)), least, "least - smallest");
    assert_growth(pl_growth_add(most, most), most, "most + most");
    assert_growth(pl_growth_add(least, least), least, "least + least");
    assert_growth(pl_growth_add(most, least), growth(-1, UINT64_MAX), "most + least");
    assert_growth(pl_growth_add(growth(INT64_MAX, UINT64_MAX - 1), growth(0, 1)), most, "up to the end");
    assert_growth(pl_growth_add(growth(INT64_MIN, 1), growth(-1, UINT64_MAX)), least, "down to the end");
    mpz_clears(x, y, NULL);
}

static void multiples_are_exact_or_saturate(void **state)
{
    mpz_t x;
    int i;
    (void)state;
    mpz_init(x);
    for (i = 0; i < 100000; i++) {
        const pl_growth a = random_growth();
        const uint64_t n = random_word() >> (random_word() & 63);
        set_words(x, a);
        mpz_mul_ui(x, x, n);
        assert_growth(pl_growth_times(a, n), saturated(x), "n a");
    }
    assert_growth(pl_growth_times(most, 1), most, "1 most");
    assert_growth(pl_growth_times(least, 1), least, "1 least");
    assert_growth(pl_growth_times(most, 0), integer(0), "0 most");
    assert_growth(pl_growth_times(least, 0), integer(0), "0 least");
    assert_growth(pl_growth_times(most, UINT64_MAX), most, "(2^64 - 1) most");
    assert_growth(pl_growth_times(least, UINT64_MAX), least, "(2^64 - 1) least");
    assert_growth(pl_growth_times(integer(-1), 32768), least, "-2^15, which there is");
    assert_growth(pl_growth_times(integer(1), 32768), most, "2^15, which there is not");
    assert_growth(pl_growth_times(integer(1), (uint64_t)1 << 48), most, "2^48: the upper word alone would be 0");
    mpz_clear(x);
}

static void multiples_are_repeated_additions(void **state)
{
    int i, n;
    (void)state;
    for (i = 0; i < 1000; i++) {
        const pl_growth a = random_growth();
        pl_growth sum = integer(0);
        for (n = 0; n < 100; n++, sum = pl_growth_add(sum, a))
            assert_growth(pl_growth_times(a, (uint64_t)n), sum, "n a");
    }
}

/* value in units of 2^-112, rounded to nearest, halves away from 0 */
static pl_growth growth_of(mpfr_t value)
{
    mpfr_t y;
    mpz_t z;
    pl_growth a;
    mpfr_init2(y, mpfr_get_prec(value));
    mpz_init(z);
    mpfr_mul_2ui(y, value, 112, MPFR_RNDN);
    mpfr_round(y, y);
    mpfr_get_z(z, y, MPFR_RNDN);
    a = saturated(z);
    mpz_clear(z);
    mpfr_clear(y);
    return a;
}

/* words 2^-exponent, with a random significand */
static pl_rate random_rate(mpfr_t value, int exponent)
{
    pl_rate rate;
    mpz_t z;
    int i;
    for (i = 0; i < 3; i++)
        rate.word[i] = random_word();
    rate.word[0] |= (uint64_t)1 << 63;
    rate.exponent = exponent;
    mpz_init(z);
    mpz_import(z, 3, 1, sizeof rate.word[0], 0, 0, rate.word);
    mpfr_set_z(value, z, MPFR_RNDN);
    mpfr_mul_2si(value, value, -(long)exponent, MPFR_RNDN);
    mpz_clear(z);
    return rate;
}

static long inside, beyond; /* how many of the exponents below are not, and are, saturated */

static void assert_growth_at(const pl_rate *rate, mpfr_t value, mpfr_t scratch, double t)
{
    const int negative = (int)(random_word() & 1);
    pl_growth found = pl_growth_at(rate, negative, t), expected;
    mpfr_mul_d(scratch, value, t, MPFR_RNDN); /* at most 245 bits: exact */
    if (negative)
        mpfr_neg(scratch, scratch, MPFR_RNDN);
    expected = growth_of(scratch);
    if (found.hi != expected.hi || found.lo != expected.lo)
        fail_msg("rate exponent %d, %s, t = %.17g: found %016" PRIx64 " %016" PRIx64 ", expected %016" PRIx64
                 " %016" PRIx64 ", exactly",
                 rate->exponent, negative ? "negative" : "positive", t, (uint64_t)found.hi, found.lo,
                 (uint64_t)expected.hi, expected.lo);
    if (expected.hi == INT64_MAX || expected.hi == INT64_MIN)
        beyond++;
    else if (expected.hi != 0 && expected.hi != -1)
        inside++;
}

static void exponent_at_any_time(void **state)
{
    static const double special[] = {0.0, -0.0, 1.0, -1.0, 0x1p-1074, -0x1p-1074, 0x1.fffffffffffffp1023, 0x1p-1022,
                                     0x0.fffffffffffffp-1022, 1e300, -1e-300, 0.01, 30.0};
    mpfr_t value, scratch;
    int i;
    (void)state;
    mpfr_init2(value, 192);
    mpfr_init2(scratch, 2600);
    for (i = 0; i < 20000; i++) {
        pl_rate rate = random_rate(value, (int)(random_word() % 500) - 50);
        union {
            uint64_t bits;
            double t;
        } any;
        any.bits = random_word();
        if (isfinite(any.t)) /* 1e-308 .. 1e308, either sign */
            assert_growth_at(&rate, value, scratch, any.t);
        assert_growth_at(&rate, value, scratch,
                         ldexp((double)(int64_t)random_word(), (int)(random_word() % 240) - 140));
        assert_growth_at(&rate, value, scratch, special[(size_t)i % (sizeof special / sizeof special[0])]);
        rate = random_rate(value, (int)(random_word() % 40) + 180); /* about the end of the range and down to 2^-60 */
        assert_growth_at(&rate, value, scratch, ldexp((double)(int64_t)random_word(), (int)(random_word() % 40) - 65));
        rate = random_rate(value, (int)(random_word() % 2000) - 900); /* far from it, but the product is not */
        assert_growth_at(&rate, value, scratch,
                         ldexp((double)(int64_t)random_word(), rate.exponent - 254 + (int)(random_word() % 20)));
    }
    print_message("# exponents tested: %ld of ordinary size, %ld beyond the range\n", inside, beyond);
    assert_true(inside > 10000 && beyond > 10000);
    mpfr_clears(value, scratch, (mpfr_ptr)0);
}

static void exponent_at_special_times(void **state)
{
    const pl_rate one = {{(uint64_t)1 << 63, 0, 0}, 191}, none = {{0, 0, 0}, 0};
    const pl_rate ones = {{UINT64_MAX, UINT64_MAX, UINT64_MAX}, 177};
    (void)state;
    assert_growth(pl_growth_at(&one, 0, (double)INFINITY), most, "infinite t");
    assert_growth(pl_growth_at(&one, 1, (double)INFINITY), least, "infinite t, negative rate");
    assert_growth(pl_growth_at(&one, 0, -(double)INFINITY), least, "t = -infinity");
    assert_growth(pl_growth_at(&none, 0, (double)INFINITY), integer(0), "infinite t, rate 0");
    assert_growth(pl_growth_at(&one, 0, (double)NAN), integer(0), "t not a number");
    assert_growth(pl_growth_at(&one, 1, (double)NAN), integer(0), "t not a number, negative rate");
    assert_growth(pl_growth_at(&none, 1, 1e10), integer(0), "rate 0");
    assert_growth(pl_growth_at(&one, 0, 7.25), growth((int64_t)29 << 46, 0), "7.25");
    assert_growth(pl_growth_at(&one, 1, 7.25), growth(-((int64_t)29 << 46), 0), "-7.25");
    assert_growth(pl_growth_at(&one, 1, -7.25), growth((int64_t)29 << 46, 0), "7.25 from two signs");
    assert_growth(pl_growth_at(&one, 0, 0x1p-113), growth(0, 1), "half a unit");
    assert_growth(pl_growth_at(&one, 0, -0x1p-113), growth(-1, UINT64_MAX), "half a unit, negative");
    assert_growth(pl_growth_at(&one, 0, 0x1.fffffffffffffp-114), integer(0), "less than half a unit");
    assert_growth(pl_growth_at(&one, 0, 32767.0), integer(32767), "the largest integer");
    assert_growth(pl_growth_at(&one, 0, 32768.0), most, "2^15");
    assert_growth(pl_growth_at(&one, 0, -32768.0), least, "-2^15");
    assert_growth(pl_growth_at(&ones, 0, 1.0), most, "rounded up beyond the range");
    assert_growth(pl_growth_at(&ones, 1, 1.0), least, "rounded down to its end");
}

/* e^{a t} after 10^9 steps: the only error of the exponent is that of the step's, 2^-113, times n. */
static void exponent_after_a_thousand_million_steps(void **state)
{
    static const double rates[] = {-0.7, 0.3, -1e-9, 1e-300, -0.0001};
    const uint64_t steps = 1000000000;
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
        set_words(z, pl_growth_times(growth_of(step), steps));
        mpfr_set_z(found, z, MPFR_RNDN);
        mpfr_div_2ui(found, found, 112, MPFR_RNDN);
        mpfr_mul_ui(exact, step, (unsigned long)steps, MPFR_RNDN);
        mpfr_sub(found, found, exact, MPFR_RNDN);
        off = mpfr_get_d(found, MPFR_RNDN);
        if (!(fabs(off) <= 0x1p-83))
            fail_msg("exponent after 1e9 steps of rate %.17g off by %.17g, tolerance 2^-83 = %.17g", rates[i], off,
                     0x1p-83);
    }
    mpz_clear(z);
    mpfr_clears(step, exact, found, (mpfr_ptr)0);
}

/* The same, step by step as generated code goes: the sum after every step is the multiple. */
static void additions_do_not_drift(void **state)
{
    const pl_growth step = growth(-1, 0xFFFFFFFF00000001u);
    pl_growth a = integer(900);
    long n;
    (void)state;
    for (n = 0; n < 10000000; n++)
        a = pl_growth_add(a, step);
    assert_growth(a, pl_growth_add(integer(900), pl_growth_times(step, 10000000)), "10^7 additions");
}

static void integers_are_exact(void **state)
{
    int k;
    (void)state;
    for (k = -32768; k < 32768; k++) {
        const double found = pl_growth_value(integer(k)), expected = ldexp(1.0, k);
        if (found != expected || signbit(found))
            fail_msg("2^%d: found %.17g, expected %.17g, exactly", k, found, expected);
    }
    assert_true(pl_growth_value(most) == (double)INFINITY);
    assert_true(pl_growth_value(least) == 0.0);
}

static double worst_error; /* in units of the last place of the result, subnormal or not */

static void assert_value(pl_growth a, mpfr_t x, mpfr_t exact)
{
    const double found = pl_growth_value(a);
    double expected, unit, error;
    mpz_t z;
    mpz_init(z);
    set_words(z, a);
    mpfr_set_z(x, z, MPFR_RNDN); /* 128 bits: exact */
    mpfr_div_2ui(x, x, 112, MPFR_RNDN);
    mpz_clear(z);
    mpfr_exp2(exact, x, MPFR_RNDN);
    expected = mpfr_get_d(exact, MPFR_RNDN);
    if (isinf(expected)) {
        if (!isinf(found) || found < 0.0)
            fail_msg("2^(%016" PRIx64 " %016" PRIx64 "): found %.17g, expected infinity", (uint64_t)a.hi, a.lo, found);
        return;
    }
    unit = ldexp(1.0, (expected < 0x1p-1022 ? -1022 : ilogb(expected)) - 52);
    mpfr_sub_d(x, exact, found, MPFR_RNDN);
    mpfr_div_d(x, x, unit, MPFR_RNDN);
    error = fabs(mpfr_get_d(x, MPFR_RNDN));
    if (error > worst_error)
        worst_error = error;
    if (!(error < 0.53) || signbit(found))
        fail_msg("2^(%016" PRIx64 " %016" PRIx64 "): found %.17g, expected %.17g; off by %.17g ulp, tolerance 0.53",
                 (uint64_t)a.hi, a.lo, found, expected, error);
}

static pl_growth between(int low, int high)
{
    const uint64_t span = (uint64_t)(high - low) << 48;
    const uint64_t hi = random_word() % span;
    return pl_growth_add(integer(low), growth((int64_t)hi, random_word()));
}

static void powers_of_2(void **state)
{
    static const int edges[] = {-1076, -1075, -1074, -1073, -1023, -1022, -1021, -1, 0, 1, 1023, 1024, 1025};
    mpfr_t x, exact;
    long i;
    (void)state;
    mpfr_inits2(160, x, exact, (mpfr_ptr)0);
    for (i = 0; i < 400000; i++)
        assert_value(between(-1080, 1026), x, exact);
    for (i = 0; i < 300000; i++)
        assert_value(between(-1, 1), x, exact);
    for (i = 0; i < 200000; i++)
        assert_value(between(-1077, -1021), x, exact); /* subnormal results */
    for (i = 0; i < 100000; i++) {
        const pl_growth edge = integer(edges[(size_t)i % (sizeof edges / sizeof edges[0])]);
        const uint64_t off = random_word() >> (random_word() % 49 + 15);
        const pl_growth beside = growth((int64_t)off, random_word()), half = growth((int64_t)1 << 47, 0);
        assert_value(pl_growth_add(edge, beside), x, exact);
        assert_value(pl_growth_add(edge, growth(-1 - beside.hi, beside.lo)), x, exact);
        assert_value(pl_growth_add(pl_growth_add(edge, half), beside), x,
                     exact); /* where the nearest integer changes */
        assert_value(pl_growth_add(pl_growth_add(edge, half), growth(-1 - beside.hi, beside.lo)), x, exact);
    }
    print_message("# largest error of pl_growth_value: %.5f ulp\n", worst_error);
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
