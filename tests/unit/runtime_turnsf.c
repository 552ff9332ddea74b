/* SPDX-License-Identifier: MIT-0 */
/* runtime/turnsf.c against MPFR. */
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

static void assert_turn(pl_turnf found, pl_turnf expected, const char *what)
{
    if (found != expected)
        fail_msg("%s: found %016" PRIx64 ", expected %016" PRIx64 ", exactly", what, found, expected);
}

/* a in turns */
static void set_turn(mpfr_t x, pl_turnf a)
{
    mpfr_set_uj_2exp(x, a, -64, MPFR_RNDN);
}

/* x mod 1 turn in units of 2^-64 turn, rounded to nearest, halves away from 0 */
static pl_turnf turn_of(mpfr_t x)
{
    mpfr_t y;
    mpz_t z;
    pl_turnf a = 0;
    mpfr_init2(y, mpfr_get_prec(x));
    mpz_init(z);
    mpfr_mul_2ui(y, x, 64, MPFR_RNDN);
    mpfr_round(y, y);
    mpfr_get_z(z, y, MPFR_RNDN);
    mpz_fdiv_r_2exp(z, z, 64);
    mpz_export(&a, NULL, 1, sizeof a, 0, 0, z);
    mpz_clear(z);
    mpfr_clear(y);
    return a;
}

static void addition_wraps(void **state)
{
    (void)state;
    assert_turn(pl_turnf_add(UINT64_MAX, 1), 0, "wrap");
    assert_turn(pl_turnf_add(UINT64_MAX, UINT64_MAX), UINT64_MAX - 1, "wrap with carry");
    assert_turn(pl_turnf_add(((uint64_t)3 << 62) + 5, ((uint64_t)1 << 62) + 6), 11, "3/4 + 1/4");
}

static void multiples_are_repeated_additions(void **state)
{
    int i, n;
    (void)state;
    for (i = 0; i < 200; i++) {
        const pl_turnf a = random_word();
        pl_turnf sum = 0;
        for (n = 0; n < 100; n++, sum = pl_turnf_add(sum, a))
            assert_turn(pl_turnf_times(a, (uint64_t)n), sum, "n a");
    }
    assert_turn(pl_turnf_times(UINT64_MAX, UINT64_MAX), 1, "(-1)(-1)");
}

static void multiples_are_exact(void **state)
{
    mpfr_t x, n;
    int i;
    (void)state;
    mpfr_init2(x, 200);
    mpfr_init2(n, 64);
    for (i = 0; i < 20000; i++) {
        const pl_turnf a = random_word();
        const uint64_t times = random_word() >> (random_word() & 63);
        set_turn(x, a);
        mpfr_set_uj(n, times, MPFR_RNDN);
        mpfr_mul(x, x, n, MPFR_RNDN); /* 128 bits: exact */
        assert_turn(pl_turnf_times(a, times), turn_of(x), "n a");
    }
    mpfr_clears(x, n, (mpfr_ptr)0);
}

/* An irrational angle a step, 10^9 steps on, one by one: the only error is that of the step's angle, 2^-65 turn, times
 * n. */
static void phase_after_a_thousand_million_steps(void **state)
{
    const uint64_t steps = 1000000000;
    mpfr_t step, exact, found;
    volatile pl_turnf turn_of_step; /* read anew each time: no compiler multiplies instead */
    pl_turnf a, sum = 0;
    uint64_t n;
    (void)state;
    mpfr_inits2(400, step, exact, found, (mpfr_ptr)0);
    mpfr_const_pi(step, MPFR_RNDN);
    mpfr_mul_2ui(step, step, 1, MPFR_RNDN);
    mpfr_d_div(step, 0.05, step, MPFR_RNDN); /* w h = 0.05 */
    turn_of_step = turn_of(step);
    a = pl_turnf_times(turn_of_step, steps);
    for (n = 0; n < steps; n++)
        sum = pl_turnf_add(sum, turn_of_step);
    assert_turn(sum, a, "10^9 additions");
    mpfr_mul_ui(exact, step, (unsigned long)steps, MPFR_RNDN);
    mpfr_frac(exact, exact, MPFR_RNDN);
    set_turn(found, a);
    mpfr_sub(found, found, exact, MPFR_RNDN);
    if (!(fabs(mpfr_get_d(found, MPFR_RNDN)) <= 0x1p-35))
        fail_msg("phase after 1e9 steps off by %.17g turn, tolerance 2^-35 = %.17g", mpfr_get_d(found, MPFR_RNDN),
                 0x1p-35);
    mpfr_clears(step, exact, found, (mpfr_ptr)0);
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

static void assert_turn_at(const pl_ratef *rate, mpfr_t value, mpfr_t scratch, float t)
{
    mpfr_mul_d(scratch, value, t, MPFR_RNDN); /* at most 152 bits: exact */
    {
        const pl_turnf found = pl_turnf_at(rate, t), expected = turn_of(scratch);
        if (found != expected)
            fail_msg("rate exponent %d, t = %.9g: found %016" PRIx64 ", expected %016" PRIx64 ", exactly",
                     rate->exponent, (double)t, found, expected);
    }
}

static void phase_at_any_time(void **state)
{
    static const float special[] = {0.0f, -0.0f, 1.0f, -1.0f, 0x1p-149f, -0x1p-149f, 0x1.fffffep127f, 0x1p-126f,
                                    0x0.fffffep-126f, 1e30f, -1e-30f, 0.01f, 30.0f};
    mpfr_t value, scratch;
    int i;
    (void)state;
    mpfr_init2(value, 128);
    mpfr_init2(scratch, 600);
    for (i = 0; i < 20000; i++) {
        const pl_ratef rate = random_rate(value, (int)(random_word() % 400) - 50);
        union {
            uint32_t bits;
            float t;
        } any;
        any.bits = (uint32_t)random_word();
        if (isfinite(any.t)) /* 1e-38 .. 1e38, either sign */
            assert_turn_at(&rate, value, scratch, any.t);
        assert_turn_at(&rate, value, scratch, ldexpf((float)(int64_t)random_word(), (int)(random_word() % 120) - 100));
        assert_turn_at(&rate, value, scratch, special[(size_t)i % (sizeof special / sizeof special[0])]);
    }
    mpfr_clears(value, scratch, (mpfr_ptr)0);
}

static void phase_at_no_time(void **state)
{
    const pl_ratef hertz = {{(uint64_t)1 << 63, 0}, 127}, none = {{0, 0}, 0};
    (void)state;
    assert_turn(pl_turnf_at(&hertz, INFINITY), 0, "infinite t");
    assert_turn(pl_turnf_at(&hertz, -INFINITY), 0, "infinite t");
    assert_turn(pl_turnf_at(&hertz, NAN), 0, "t not a number");
    assert_turn(pl_turnf_at(&none, 1e10f), 0, "rate 0");
    assert_turn(pl_turnf_at(&hertz, 7.25f), (uint64_t)1 << 62, "1 Hz after 7.25 s");
    assert_turn(pl_turnf_at(&hertz, -7.25f), (uint64_t)3 << 62, "1 Hz after -7.25 s");
    assert_turn(pl_turnf_at(&hertz, 0x1p-65f), 1, "half a unit");
    assert_turn(pl_turnf_at(&hertz, -0x1p-65f), UINT64_MAX, "half a unit, negative");
    assert_turn(pl_turnf_at(&hertz, 0x1.fffffep-66f), 0, "less than half a unit");
}

static void quarter_turns_are_exact(void **state)
{
    static const float circle[4][2] = {{1.0, 0.0}, {0.0, 1.0}, {-1.0, 0.0}, {0.0, -1.0}};
    uint64_t q;
    float z[2];
    int i;
    (void)state;
    for (q = 0; q < 4; q++) {
        pl_cossinf(q << 62, z);
        for (i = 0; i < 2; i++)
            if (z[i] != circle[q][i] || (z[i] == 0 && signbit(z[i])))
                fail_msg("%s of %d quarter turns: found %.17g, expected %.17g, exactly", i ? "sine" : "cosine", (int)q,
                         (double)z[i], (double)circle[q][i]);
    }
}

static void assert_pair(const float z[2], float c, float s, pl_turnf a, const char *what)
{
    if (z[0] != c || z[1] != s)
        fail_msg("%s of %016" PRIx64 ": found %.9g, %.9g, expected %.9g, %.9g, exactly", what, a, (double)z[0],
                 (double)z[1], (double)c, (double)s);
}

static void symmetric_to_the_last_bit(void **state)
{
    int i;
    (void)state;
    for (i = 0; i < 1000000; i++) {
        const uint64_t eighth = random_word() << 61, off = random_word() >> (random_word() & 63);
        const pl_turnf a = i & 1 ? eighth + off : eighth - off, quarter = (uint64_t)1 << 62;
        float z[2], y[2];
        pl_cossinf(a, z);
        pl_cossinf(0u - a, y);
        assert_pair(y, z[0], -z[1], a, "mirror image");
        pl_cossinf(quarter - a, y);
        assert_pair(y, z[1], z[0], a, "mirror image about an eighth");
        pl_cossinf(pl_turnf_add(a, quarter), y);
        assert_pair(y, -z[1], z[0], a, "a quarter turn more");
    }
}

static void one_eighth_is_symmetric(void **state)
{
    uint64_t i;
    (void)state;
    for (i = 1; i < 8; i += 2) {
        const float r = 0x1.6a09e6p-1f; /* sqrt(1/2), rounded */
        float z[2];
        pl_cossinf(i << 61, z);
        assert_pair(z, i == 3 || i == 5 ? -r : r, i >= 5 ? -r : r, i << 61, "odd eighths");
    }
}

static double worst_error; /* in units of the last place */

static void assert_cossin(pl_turnf a, mpfr_t angle, mpfr_t c, mpfr_t s, mpfr_t two_pi)
{
    float z[2];
    int i;
    pl_cossinf(a, z);
    mpfr_set_sj_2exp(angle, (int64_t)a, -64, MPFR_RNDN);
    mpfr_mul(angle, angle, two_pi, MPFR_RNDN);
    mpfr_sin_cos(s, c, angle, MPFR_RNDN);
    for (i = 0; i < 2; i++) {
        mpfr_ptr exact = i ? s : c;
        const float expected = mpfr_get_flt(exact, MPFR_RNDN);
        if (fabsf(expected) < 0x1p-70f) /* quarter turns: 2 pi is not known so well here */
            continue;
        mpfr_sub_d(angle, exact, z[i], MPFR_RNDN);
        {
            const double error = fabs(mpfr_get_d(angle, MPFR_RNDN)) / ldexp(1.0, ilogbf(expected) - 23);
            if (error > worst_error)
                worst_error = error;
            if (!(error < 0.52))
                fail_msg("%s of %016" PRIx64 ": found %.9g, expected %.9g; off by %.17g ulp, tolerance 0.52",
                         i ? "sine" : "cosine", a, (double)z[i], (double)expected, error);
        }
    }
}

static void cosine_and_sine(void **state)
{
    mpfr_t angle, c, s, two_pi;
    long i;
    (void)state;
    mpfr_inits2(160, angle, c, s, two_pi, (mpfr_ptr)0);
    mpfr_const_pi(two_pi, MPFR_RNDN);
    mpfr_mul_2ui(two_pi, two_pi, 1, MPFR_RNDN);
    for (i = 0; i < 200000; i++)
        assert_cossin(random_word(), angle, c, s, two_pi);
    for (i = 0; i < 200000; i++) { /* from 2^-3 to 2^-64 turn beside an eighth */
        const uint64_t small = random_word() >> (random_word() % 61 + 3);
        assert_cossin(pl_turnf_add(random_word() << 61, i & 1 ? small : 0u - small), angle, c, s, two_pi);
    }
    print_message("# largest error of pl_cossinf: %.4f ulp\n", worst_error);
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
