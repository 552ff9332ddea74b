/* SPDX-License-Identifier: MIT-0 */
/* runtime/turns.c against MPFR. */
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

static pl_turn turn(uint64_t hi, uint64_t lo)
{
    pl_turn a;
    a.hi = hi;
    a.lo = lo;
    return a;
}

static pl_turn minus(pl_turn a)
{
    return turn(~a.hi + (a.lo == 0), ~a.lo + 1);
}

static void assert_turn(pl_turn found, pl_turn expected, const char *what)
{
    if (found.hi != expected.hi || found.lo != expected.lo)
        fail_msg("%s: found %016" PRIx64 " %016" PRIx64 ", expected %016" PRIx64 " %016" PRIx64 ", exactly", what,
                 found.hi, found.lo, expected.hi, expected.lo);
}

/* a in turns */
static void set_turn(mpfr_t x, pl_turn a)
{
    const uint64_t words[2] = {a.hi, a.lo};
    mpz_t z;
    mpz_init(z);
    mpz_import(z, 2, 1, sizeof words[0], 0, 0, words);
    mpfr_set_z(x, z, MPFR_RNDN);
    mpfr_div_2ui(x, x, 128, MPFR_RNDN);
    mpz_clear(z);
}

/* x mod 1 turn in units of 2^-128 turn, rounded to nearest, halves away from 0 */
static pl_turn turn_of(mpfr_t x)
{
    mpfr_t y;
    mpz_t z, word;
    pl_turn a = {0, 0};
    mpfr_init2(y, mpfr_get_prec(x));
    mpz_inits(z, word, NULL);
    mpfr_mul_2ui(y, x, 128, MPFR_RNDN);
    mpfr_round(y, y);
    mpfr_get_z(z, y, MPFR_RNDN);
    mpz_fdiv_r_2exp(z, z, 128);
    mpz_fdiv_q_2exp(word, z, 64);
    mpz_export(&a.hi, NULL, 1, sizeof a.hi, 0, 0, word);
    mpz_fdiv_r_2exp(word, z, 64);
    mpz_export(&a.lo, NULL, 1, sizeof a.lo, 0, 0, word);
    mpz_clears(z, word, NULL);
    mpfr_clear(y);
    return a;
}

static void addition_wraps(void **state)
{
    const uint64_t ones = UINT64_MAX;
    (void)state;
    assert_turn(pl_turn_add(turn(0, ones), turn(0, 1)), turn(1, 0), "carry");
    assert_turn(pl_turn_add(turn(ones, ones), turn(0, 1)), turn(0, 0), "wrap");
    assert_turn(pl_turn_add(turn(ones, ones), turn(ones, ones)), turn(ones, ones - 1), "wrap with carry");
    assert_turn(pl_turn_add(turn((uint64_t)3 << 62, 5), turn((uint64_t)1 << 62, 6)), turn(0, 11), "3/4 + 1/4");
}

static void multiples_are_repeated_additions(void **state)
{
    int i, n;
    (void)state;
    for (i = 0; i < 200; i++) {
        const pl_turn a = turn(random_word(), random_word());
        pl_turn sum = turn(0, 0);
        for (n = 0; n < 100; n++, sum = pl_turn_add(sum, a))
            assert_turn(pl_turn_times(a, (uint64_t)n), sum, "n a");
    }
    assert_turn(pl_turn_times(turn(UINT64_MAX, UINT64_MAX), UINT64_MAX), turn(UINT64_MAX, 1), "(-1)(2^64 - 1)");
}

static void multiples_are_exact(void **state)
{
    mpfr_t x, n;
    int i;
    (void)state;
    mpfr_init2(x, 200);
    mpfr_init2(n, 64);
    for (i = 0; i < 20000; i++) {
        const pl_turn a = turn(random_word(), random_word());
        const uint64_t times = random_word() >> (random_word() & 63);
        set_turn(x, a);
        mpfr_set_uj(n, times, MPFR_RNDN);
        mpfr_mul(x, x, n, MPFR_RNDN); /* 192 bits: exact */
        assert_turn(pl_turn_times(a, times), turn_of(x), "n a");
    }
    mpfr_clears(x, n, (mpfr_ptr)0);
}

/* An irrational angle a step, 10^9 steps on: the only error is that of the step's angle, 2^-129 turn, times n. */
static void phase_after_a_thousand_million_steps(void **state)
{
    const uint64_t steps = 1000000000;
    mpfr_t step, exact, found;
    pl_turn a;
    (void)state;
    mpfr_inits2(400, step, exact, found, (mpfr_ptr)0);
    mpfr_const_pi(step, MPFR_RNDN);
    mpfr_mul_2ui(step, step, 1, MPFR_RNDN);
    mpfr_d_div(step, 0.05, step, MPFR_RNDN); /* w h = 0.05 */
    a = pl_turn_times(turn_of(step), steps);
    mpfr_mul_ui(exact, step, (unsigned long)steps, MPFR_RNDN);
    mpfr_frac(exact, exact, MPFR_RNDN);
    set_turn(found, a);
    mpfr_sub(found, found, exact, MPFR_RNDN);
    if (!(fabs(mpfr_get_d(found, MPFR_RNDN)) <= 0x1p-99))
        fail_msg("phase after 1e9 steps off by %.17g turn, tolerance 2^-99 = %.17g", mpfr_get_d(found, MPFR_RNDN),
                 0x1p-99);
    mpfr_clears(step, exact, found, (mpfr_ptr)0);
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

static void assert_turn_at(const pl_rate *rate, mpfr_t value, mpfr_t scratch, double t)
{
    mpfr_mul_d(scratch, value, t, MPFR_RNDN); /* at most 245 bits: exact */
    {
        const pl_turn found = pl_turn_at(rate, t), expected = turn_of(scratch);
        if (found.hi != expected.hi || found.lo != expected.lo)
            fail_msg("rate exponent %d, t = %.17g: found %016" PRIx64 " %016" PRIx64 ", expected %016" PRIx64
                     " %016" PRIx64 ", exactly",
                     rate->exponent, t, found.hi, found.lo, expected.hi, expected.lo);
    }
}

static void phase_at_any_time(void **state)
{
    static const double special[] = {0.0, -0.0, 1.0, -1.0, 0x1p-1074, -0x1p-1074, 0x1.fffffffffffffp1023, 0x1p-1022,
                                     0x0.fffffffffffffp-1022, 1e300, -1e-300, 0.01, 30.0};
    mpfr_t value, scratch;
    int i;
    (void)state;
    mpfr_init2(value, 192);
    mpfr_init2(scratch, 2600);
    for (i = 0; i < 20000; i++) {
        const pl_rate rate = random_rate(value, (int)(random_word() % 500) - 50);
        union {
            uint64_t bits;
            double t;
        } any;
        any.bits = random_word();
        if (isfinite(any.t)) /* 1e-308 .. 1e308, either sign */
            assert_turn_at(&rate, value, scratch, any.t);
        assert_turn_at(&rate, value, scratch, ldexp((double)(int64_t)random_word(), (int)(random_word() % 240) - 140));
        assert_turn_at(&rate, value, scratch, special[(size_t)i % (sizeof special / sizeof special[0])]);
    }
    mpfr_clears(value, scratch, (mpfr_ptr)0);
}

static void phase_at_no_time(void **state)
{
    const pl_rate hertz = {{(uint64_t)1 << 63, 0, 0}, 191}, none = {{0, 0, 0}, 0};
    (void)state;
    assert_turn(pl_turn_at(&hertz, (double)INFINITY), turn(0, 0), "infinite t");
    assert_turn(pl_turn_at(&hertz, -(double)INFINITY), turn(0, 0), "infinite t");
    assert_turn(pl_turn_at(&hertz, (double)NAN), turn(0, 0), "t not a number");
    assert_turn(pl_turn_at(&none, 1e10), turn(0, 0), "rate 0");
    assert_turn(pl_turn_at(&hertz, 7.25), turn((uint64_t)1 << 62, 0), "1 Hz after 7.25 s");
    assert_turn(pl_turn_at(&hertz, -7.25), turn((uint64_t)3 << 62, 0), "1 Hz after -7.25 s");
    assert_turn(pl_turn_at(&hertz, 0x1p-129), turn(0, 1), "half a unit");
    assert_turn(pl_turn_at(&hertz, -0x1p-129), turn(UINT64_MAX, UINT64_MAX), "half a unit, negative");
    assert_turn(pl_turn_at(&hertz, 0x1.fffffffffffffp-130), turn(0, 0), "less than half a unit");
}

static void quarter_turns_are_exact(void **state)
{
    static const double circle[4][2] = {{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
    uint64_t q;
    double z[2];
    int i;
    (void)state;
    for (q = 0; q < 4; q++) {
        pl_cossin(turn(q << 62, 0), z);
        for (i = 0; i < 2; i++)
            if (z[i] != circle[q][i] || (z[i] == 0.0 && signbit(z[i])))
                fail_msg("%s of %d quarter turns: found %.17g, expected %.17g, exactly", i ? "sine" : "cosine", (int)q,
                         z[i], circle[q][i]);
    }
}

static void assert_pair(const double z[2], double c, double s, pl_turn a, const char *what)
{
    if (z[0] != c || z[1] != s)
        fail_msg("%s of %016" PRIx64 " %016" PRIx64 ": found %.17g, %.17g, expected %.17g, %.17g, exactly", what, a.hi,
                 a.lo, z[0], z[1], c, s);
}

static void symmetric_to_the_last_bit(void **state)
{
    int i;
    (void)state;
    for (i = 0; i < 100000; i++) {
        const pl_turn a = turn(random_word(), i == 0 ? 0 : random_word()), quarter = turn((uint64_t)1 << 62, 0);
        double z[2], y[2];
        pl_cossin(a, z);
        pl_cossin(minus(a), y);
        assert_pair(y, z[0], -z[1], a, "mirror image");
        pl_cossin(pl_turn_add(a, quarter), y);
        assert_pair(y, -z[1], z[0], a, "a quarter turn more");
    }
}

static void one_eighth_is_symmetric(void **state)
{
    uint64_t i;
    (void)state;
    for (i = 1; i < 8; i += 2) {
        const double r = 0x1.6a09e667f3bcdp-1; /* sqrt(1/2), rounded */
        double z[2];
        pl_cossin(turn(i << 61, 0), z);
        assert_pair(z, i == 3 || i == 5 ? -r : r, i >= 5 ? -r : r, turn(i << 61, 0), "odd eighths");
    }
}

static double worst_error; /* in units of the last place */

static void assert_cossin(pl_turn a, mpfr_t angle, mpfr_t c, mpfr_t s, mpfr_t two_pi)
{
    double z[2];
    int i;
    pl_cossin(a, z);
    set_turn(angle, a);
    mpfr_mul(angle, angle, two_pi, MPFR_RNDN);
    mpfr_sin_cos(s, c, angle, MPFR_RNDN);
    for (i = 0; i < 2; i++) {
        mpfr_ptr exact = i ? s : c;
        const double expected = mpfr_get_d(exact, MPFR_RNDN);
        if (expected == 0.0 || fabs(expected) < 0x1p-130) /* quarter turns: 2 pi is not known so well here */
            continue;
        mpfr_sub_d(angle, exact, z[i], MPFR_RNDN);
        {
            const double error = fabs(mpfr_get_d(angle, MPFR_RNDN)) / ldexp(1.0, ilogb(expected) - 52);
            if (error > worst_error)
                worst_error = error;
            if (!(error < 0.6))
                fail_msg("%s of %016" PRIx64 " %016" PRIx64
                         ": found %.17g, expected %.17g; off by %.17g ulp, tolerance 0.6",
                         i ? "sine" : "cosine", a.hi, a.lo, z[i], expected, error);
        }
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
    for (i = 0; i < 60000; i++)
        assert_cossin(turn(random_word(), random_word()), angle, c, s, two_pi);
    for (i = 0; i < 30000; i++) { /* from 2^-3 to 2^-128 turn beside an eighth */
        const int shift = (int)(random_word() % 125) + 3;
        const pl_turn small = shift < 64 ? turn(random_word() >> shift, random_word())
                                         : turn(0, random_word() >> (shift - 64));
        assert_cossin(pl_turn_add(turn(random_word() << 61, 0), i & 1 ? small : minus(small)), angle, c, s, two_pi);
    }
    print_message("# largest error of pl_cossin: %.4f ulp\n", worst_error);
    mpfr_clears(angle, c, s, two_pi, (mpfr_ptr)0);
}

int main(void)
{
    const struct CMUnitTest tests[] = {
        cmocka_unit_test(addition_wraps),
        cmocka_unit_test(multiples_are_repeated_additions),
        cmocka_unit_test(multiples_are_exact),
        cmocka_unit_test(phase_after_a_thousand_million_steps),
        cmocka_unit_test(phase_at_any_time),
        cmocka_unit_test(phase_at_no_time),
        cmocka_unit_test(quarter_turns_are_exact),
        cmocka_unit_test(symmetric_to_the_last_bit),
        cmocka_unit_test(one_eighth_is_symmetric),
        cmocka_unit_test(cosine_and_sine),
    };
    const int status = cmocka_run_group_tests(tests, NULL, NULL);
    mpfr_free_cache();
    return status;
}
