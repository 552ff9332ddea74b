/* SPDX-License-Identifier: MIT-0 */
/* runtime/retune.c: increments against Taylor's series in MPFR, equations against exact fractions. */
#include "runtime.h"
#include "../emitted/worse.h"

/* BOUND: of an increment, in units in the last place of the largest entry.  FARTHEST: log2 of the largest |A| tau.
 * SMALLEST: below it underflow may take bits.  LOSS: of an equation, in parts of all its terms. */
enum { BITS = 400, LARGEST = 12, BOUND = 16 };
#ifdef REAL_IS_FLOAT
#define SMALLEST 0x1p-100
enum { FARTHEST = 12 };
#define LOSS 0x1p-43
#else
#define SMALLEST 0x1p-900
enum { FARTHEST = 20 };
#define LOSS 0x1p-101
#endif

/* ---- random numbers ---- */

static uint64_t drawn;

static uint64_t random_bits(void) /* splitmix64 */
{
    uint64_t z = drawn += 0x9e3779b97f4a7c15u;
    z = (z ^ z >> 30) * 0xbf58476d1ce4e5b9u;
    z = (z ^ z >> 27) * 0x94d049bb133111ebu;
    return z ^ z >> 31;
}

static double between(double a, double b)
{
    return a + (b - a) * (double)(random_bits() >> 11) * 0x1p-53;
}

static int below(int n)
{
    return (int)(random_bits() % (unsigned)n);
}

/* e^u, u even between the logarithms */
static double scattered(double a, double b)
{
    return exp(between(log(a), log(b)));
}

/* v or -v */
static double either(double v)
{
    return below(2) ? v : -v;
}

/* v and a random second word */
static pl_two about(double v)
{
    pl_two t;
    t.hi = (real)v;
    t.lo = t.hi * (real)between(-0.25 * REAL_EPSILON, 0.25 * REAL_EPSILON);
    return t;
}

/* ---- increments ---- */

typedef struct system {
    int size, states;
    pl_two A[LARGEST * LARGEST];
} system_of;

static pl_two *entry(system_of *s, int i, int j)
{
    return s->A + i * s->size + j;
}

static void clear(system_of *s, int states, int loads)
{
    int i;
    s->size = states + loads;
    s->states = states;
    for (i = 0; i < LARGEST * LARGEST; i++)
        s->A[i] = word_of(0.0);
}

static mpfr_t exact_A[LARGEST * LARGEST], exact_D[LARGEST * LARGEST], power[LARGEST * LARGEST], room[LARGEST * LARGEST],
    temporary;

/* room <- a b */
static void exact_product(int n, mpfr_t *a, mpfr_t *b)
{
    int i, j, k;
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++) {
            mpfr_set_zero(room[i * n + j], 1);
            for (k = 0; k < n; k++)
                if (!mpfr_zero_p(a[i * n + k]) && !mpfr_zero_p(b[k * n + j])) {
                    mpfr_mul(temporary, a[i * n + k], b[k * n + j], MPFR_RNDN);
                    mpfr_add(room[i * n + j], room[i * n + j], temporary, MPFR_RNDN);
                }
        }
}

/* exact_D <- e^{A tau} - I: the series on 2^-halvings of tau, term by term until they are small, then e^X itself
 * squared, all to BITS */
static void exact_increment(const system_of *s, real tau)
{
    const int n = s->size;
    double most = 0;
    int i, m, halvings = 0, small = 0;
    for (i = 0; i < n * n; i++) {
        set_two(exact_A[i], s->A[i]);
        mpfr_mul_d(exact_A[i], exact_A[i], tau, MPFR_RNDN);
        most = fmax(most, fabs(mpfr_get_d(exact_A[i], MPFR_RNDN)));
    }
    if (most > 0)
        halvings = ilogb(most * n) + 9;
    if (halvings < 0)
        halvings = 0;
    for (i = 0; i < n * n; i++) {
        mpfr_div_2si(exact_A[i], exact_A[i], halvings, MPFR_RNDN);
        mpfr_set(exact_D[i], exact_A[i], MPFR_RNDN);
        mpfr_set(power[i], exact_A[i], MPFR_RNDN);
    }
    for (m = 2; !small; m++) {
        exact_product(n, power, exact_A);
        small = m > n; /* what is reached in n steps has been */
        for (i = 0; i < n * n; i++) {
            mpfr_div_ui(power[i], room[i], (unsigned long)m, MPFR_RNDN);
            mpfr_add(exact_D[i], exact_D[i], power[i], MPFR_RNDN);
            if (!mpfr_zero_p(power[i]) && mpfr_get_exp(power[i]) > mpfr_get_exp(exact_D[i]) - BITS / 2 - 60)
                small = 0;
        }
    }
    for (i = 0; i < n; i++)
        mpfr_add_ui(exact_D[i * n + i], exact_D[i * n + i], 1, MPFR_RNDN);
    for (; halvings > 0; halvings--) {
        exact_product(n, exact_D, exact_D);
        for (i = 0; i < n * n; i++)
            mpfr_swap(exact_D[i], room[i]);
    }
    for (i = 0; i < n; i++)
        mpfr_sub_ui(exact_D[i * n + i], exact_D[i * n + i], 1, MPFR_RNDN);
}

static double worst; /* error of the family in units in the last place */

/* Columns from .. to - 1 of D against exact_D, in units in the last place of the largest of them. */
static void assert_columns(const system_of *s, real tau, const real *D, int from, int to, const char *family)
{
    double unit = 0;
    int i, j;
    for (i = 0; i < s->states; i++)
        for (j = from; j < to; j++)
            unit = fmax(unit, fabs(mpfr_get_d(exact_D[i * s->size + j], MPFR_RNDN)));
    unit = unit > 0 ? ldexp(REAL_EPSILON, unit > SMALLEST ? ilogb(unit) : ilogb(SMALLEST)) : 0;
    for (i = 0; i < s->states; i++)
        for (j = from; j < to; j++) {
            double off;
            mpfr_sub_d(temporary, exact_D[i * s->size + j], D[i * s->size + j], MPFR_RNDN);
            off = fabs(mpfr_get_d(temporary, MPFR_RNDN));
            if (unit > 0)
                worst = worse(worst, off / unit);
            if (!(off <= BOUND * unit)) {
                int row, column;
                for (row = 0; row < s->size; row++)
                    for (column = 0; column < s->size; column++)
                        if (s->A[row * s->size + column].hi != 0)
                            print_message("# A[%d][%d] = %.17g + %.17g\n", row, column, s->A[row * s->size + column].hi,
                                          s->A[row * s->size + column].lo);
                fail_msg(
                    "%s, %d states, size %d, tau = %.17g, D[%d][%d]: found %.17g, expected %.17g; off by %g "
                    "units, bound %d",
                    family, s->states, s->size, (double)tau, i, j, (double)D[i * s->size + j],
                    mpfr_get_d(exact_D[i * s->size + j], MPFR_RNDN), unit > 0 ? off / unit : (double)INFINITY, BOUND);
            }
        }
}

static void assert_increment(const system_of *s, real tau, const char *family)
{
    pl_two in_two_words[LARGEST * LARGEST];
    real D[LARGEST * LARGEST];
    pl_two work[PL_INCREMENT_WORK(LARGEST)];
    const int status = pl_increment(s->size, s->states, s->A, tau, 1, in_two_words, work);
    int j, fits = 1;
    exact_increment(s, tau);
    for (j = 0; j < s->size * s->size; j++)
        fits &= mpfr_zero_p(exact_D[j]) || mpfr_get_exp(exact_D[j]) < REAL_EXPONENTS - 10;
    if (!fits && status == PL_NOT_FINITE)
        return;
    if (status != 0)
        fail_msg("%s, tau = %.17g: found status %d, expected 0", family, (double)tau, status);
    for (j = 0; j < s->states * s->size; j++)
        D[j] = in_two_words[j].hi;
    assert_columns(s, tau, D, 0, s->states, family);
    for (j = s->states; j < s->size; j++)
        assert_columns(s, tau, D, j, j + 1, family);
}

static void report(const char *family)
{
    print_message("# %s: off by %.2f units at most, bound %d\n", family, worst, BOUND);
    worst = 0;
}

/* One mass: x'' = -k/m x - c/m x'.  How fast it goes. */
static double one_mass(system_of *s, double m, double c, double k)
{
    *entry(s, 0, 1) = word_of(1.0);
    *entry(s, 1, 0) = about(-k / m);
    *entry(s, 1, 1) = about(-c / m);
    return fmax(sqrt(k / m), c / m);
}

/* Two masses: k1, c1 to the ground, k2, c2 between them */
static double two_masses(system_of *s, const double *m, const double *c, const double *k)
{
    double most = 0;
    int i;
    for (i = 0; i < 2; i++) {
        const double ks = k[1] + (i == 0 ? k[0] : 0), cs = c[1] + (i == 0 ? c[0] : 0);
        *entry(s, i, 2 + i) = word_of(1.0);
        *entry(s, 2 + i, i) = about(-ks / m[i]);
        *entry(s, 2 + i, 1 - i) = about(k[1] / m[i]);
        *entry(s, 2 + i, 2 + i) = about(-cs / m[i]);
        *entry(s, 2 + i, 3 - i) = about(c[1] / m[i]);
        most = fmax(most, fmax(sqrt(ks / m[i]), cs / m[i]));
    }
    return most;
}

/* A tau for |A| tau between 2^from and 2^to */
static real tau_of(double fastest, double from, double to)
{
    return (real)(exp2(between(from, to)) / fastest);
}

static double random_masses(system_of *s, int masses, double least_damping, double most_damping)
{
    double m[2], c[2], k[2];
    int i;
    for (i = 0; i < 2; i++) {
        m[i] = scattered(1e-3, 1e3);
        k[i] = scattered(1.0, 1e9);
        c[i] = most_damping == 0 ? 0 : 2 * sqrt(k[i] * m[i]) * scattered(least_damping, most_damping);
    }
    return masses == 1 ? one_mass(s, m[0], c[0], k[0]) : two_masses(s, m, c, k);
}

static void masses_without_loads(int count, double least_damping, double most_damping, double from, double to,
                                 const char *family)
{
    int i;
    for (i = 0; i < samples(count); i++) {
        const int masses = 1 + (i % 4 != 0);
        system_of s;
        double fastest;
        clear(&s, 2 * masses, 0);
        fastest = random_masses(&s, masses, least_damping, most_damping);
        assert_increment(&s, tau_of(fastest, from, to), family);
    }
    report(family);
}

static void damped(void **state)
{
    (void)state;
    drawn = 1;
    masses_without_loads(600, 1e-4, 3.0, -20.0, -2.0, "damped, short");
    masses_without_loads(1000, 1e-4, 3.0, -2.0, 3.0, "damped, |A| tau about 1");
    masses_without_loads(500, 1e-4, 3.0, 3.0, FARTHEST, "damped, long");
}

static void undamped(void **state)
{
    (void)state;
    drawn = 2;
    masses_without_loads(300, 0, 0, -20.0, -2.0, "undamped, short");
    masses_without_loads(1000, 0, 0, -2.0, 3.0, "undamped, |A| tau about 1");
    masses_without_loads(500, 0, 0, 3.0, FARTHEST, "undamped, long");
}

/* c = 2 sqrt(k m) (1 + 10^-e): a double pole, and those close to one */
static void near_confluence(void **state)
{
    int i;
    (void)state;
    drawn = 3;
    for (i = 0; i < 400; i++) {
        const double m = scattered(1e-3, 1e3), w = i % 2 ? ldexp(1.0, below(20)) : scattered(1.0, 1e6),
                     gap = scattered(1e-16, 1e-10);
        const double exact = i % 4 == 3;
        double fastest;
        system_of s;
        clear(&s, 2, 0);
        fastest = one_mass(&s, m, 2 * m * w * (1 + (i % 8 < 4 ? gap : -gap)), m * w * w);
        if (exact) {
            *entry(&s, 1, 0) = word_of(-w * w);
            *entry(&s, 1, 1) = word_of(-2 * w);
        }
        assert_increment(&s, tau_of(fastest, i % 3 == 0 ? -10.0 : -2.0, i % 3 == 0 ? FARTHEST : 5.0),
                         "near confluence");
    }
    report("near confluence");
    for (i = 0; i < 200; i++) { /* two equal oscillators, nearly or not at all coupled, one way or both */
        const double w = scattered(1.0, 1e6), coupling = w * w * scattered(1e-16, 1e-2);
        system_of s;
        clear(&s, 4, 0);
        *entry(&s, 0, 2) = *entry(&s, 1, 3) = word_of(1.0);
        *entry(&s, 2, 0) = *entry(&s, 3, 1) = about(-w * w);
        *entry(&s, 2, 1) = about(coupling);
        if (i % 2)
            *entry(&s, 3, 0) = about(coupling * between(-1.0, 1.0));
        assert_increment(&s, tau_of(w, i % 3 == 0 ? -10.0 : -2.0, i % 3 == 0 ? FARTHEST : 5.0), "equal oscillators");
    }
    report("equal oscillators");
}

/* Poles near -10^6 and -10^-3, in one mass and in two that are coupled */
static void stiff(void **state)
{
    int i;
    (void)state;
    drawn = 4;
    for (i = 0; i < 300; i++) {
        const double fast = scattered(1e5, 1e7), slow = scattered(1e-4, 1e-2), unit = scattered(1e-6, 1e6);
        double m[2], c[2], k[2], fastest;
        system_of s;
        if (i % 3 == 0) { /* x' = -slow x + ..., y' = -fast y + ... */
            clear(&s, 2, 0);
            *entry(&s, 0, 0) = about(-slow);
            *entry(&s, 0, 1) = about(unit * between(-1.0, 1.0));
            *entry(&s, 1, 0) = about(slow / unit * between(-1.0, 1.0));
            *entry(&s, 1, 1) = about(-fast);
            fastest = fast;
        } else if (i % 3 == 1) {
            clear(&s, 2, 0);
            fastest = one_mass(&s, 1.0, fast + slow, fast * slow);
        } else {
            m[0] = 1;
            m[1] = scattered(1e-3, 1e3);
            c[0] = fast;
            c[1] = m[1] * slow;
            k[0] = fast * slow;
            k[1] = scattered(1e-3, 1e3);
            clear(&s, 4, 0);
            fastest = two_masses(&s, m, c, k);
        }
        assert_increment(&s, tau_of(fastest, -10.0, FARTHEST), "stiff");
    }
    report("stiff");
}

static void rigid_body(void **state)
{
    int i, j;
    (void)state;
    drawn = 5;
    for (i = 0; i < 200; i++) {
        const double m[2] = {scattered(1e-3, 1e3), scattered(1e-3, 1e3)};
        double c[2] = {0, i % 2 ? scattered(1e-3, 1e3) : 0}, k[2] = {0, scattered(1.0, 1e6)}, fastest;
        system_of s;
        clear(&s, 4, 0);
        fastest = two_masses(&s, m, c, k);
        assert_increment(&s, tau_of(fastest, -10.0, FARTHEST), "two free masses");
    }
    report("two free masses");
    for (i = 0; i < 200; i++) { /* integrators behind one another: x_j' = a x_{j + 1}, in any order; nilpotent */
        const int n = 2 + below(7);
        int order[LARGEST];
        system_of s;
        clear(&s, n, 0);
        for (j = 0; j < n; j++)
            order[j] = j;
        for (j = n - 1; j > 0; j--) {
            const int other = below(j + 1), swapped = order[j];
            order[j] = order[other];
            order[other] = swapped;
        }
        for (j = 0; j < n - 1; j++)
            *entry(&s, order[j], order[j + 1]) = i % 2 ? word_of(1.0) : about(scattered(0.1, 10.0));
        assert_increment(&s, (real)scattered(1e-3, 1e3), "nilpotent");
    }
    report("nilpotent");
    for (i = 0; i < 200; i++) { /* an oscillator that drives integrators */
        const int n = 2 + 1 + below(5);
        double fastest;
        system_of s;
        clear(&s, n, 0);
        fastest = one_mass(&s, 1.0, i % 2 ? between(0.0, 3.0) : 0.0, 1.0);
        for (j = 2; j < n; j++)
            *entry(&s, j, j - 1) = about(scattered(1.0, 1e3));
        assert_increment(&s, tau_of(fastest, -3.0, 5.0), "driven integrators");
    }
    report("driven integrators");
}

enum { CONSTANT, HARMONIC, MONOMIAL, EXPONENTIAL, RAMP, SEVERAL, LOADS };

/* Columns from `at` on carry a load that acts on the accelerations; how many they are, and how fast in *fastest. */
static int put_load(system_of *s, int load, int at, double own, double *fastest)
{
    const int masses = s->states / 2;
    double rate;
    int i, j, used = 1;
    switch (load) {
    case HARMONIC:
        rate = own * scattered(1e-3, 4.0);
        *entry(s, at, at + 1) = about(-rate);
        *entry(s, at + 1, at) = *entry(s, at, at + 1);
        entry(s, at + 1, at)->hi *= -1;
        entry(s, at + 1, at)->lo *= -1;
        *fastest = fmax(*fastest, rate);
        used = 2;
        break;
    case MONOMIAL: /* t^d, ..., t, 1: (t^j)' = j t^{j - 1} */
        used = 2 + below(5);
        for (j = 0; j < used - 1; j++)
            *entry(s, at + j, at + j + 1) = word_of(used - 1 - j);
        break;
    case EXPONENTIAL:
        rate = own * scattered(1e-3, 1.0);
        *entry(s, at, at) = about(below(4) ? -rate : rate * 1e-2);
        *fastest = fmax(*fastest, rate);
        break;
    case RAMP: /* u and u', by a spring and maybe a damper */
        *entry(s, at, at + 1) = word_of(1.0);
        used = 2;
        break;
    default:
        break;
    }
    for (i = 0; i < masses; i++)
        if (i == 0 || below(2)) {
            *entry(s, masses + i, at) = about(either(scattered(1e-3, 1e6)));
            if ((load == HARMONIC || load == RAMP) && below(2))
                *entry(s, masses + i, at + 1) = about(either(scattered(1e-3, 1e6)));
        }
    return used;
}

static void loads(void **state)
{
    static const char *const names[LOADS] = {"constant loads",    "harmonic loads", "powers of t",
                                             "exponential loads", "ramps",          "several loads"};
    int i, load;
    (void)state;
    drawn = 6;
    for (load = 0; load < LOADS; load++) {
        for (i = 0; i < samples(300); i++) {
            const int masses = 1 + below(2);
            const double from = i % 3 == 0 ? -20.0 : -2.0, to = i % 3 == 0 ? -2.0 : i % 3 == 1 ? 3.0 : FARTHEST;
            int used;
            double fastest, own;
            system_of s;
            clear(&s, 2 * masses, LARGEST - 2 * masses); /* the width comes first */
            s.size = 2 * masses + (load == CONSTANT || load == EXPONENTIAL ? 1
                                   : load == MONOMIAL                      ? 6
                                   : load == SEVERAL                       ? 6
                                                                           : 2);
            own = fastest = random_masses(&s, masses, 1e-4, i % 4 == 0 ? 0 : 3.0);
            if (load == SEVERAL) {
                used = put_load(&s, HARMONIC, s.states, own, &fastest);
                used += put_load(&s, CONSTANT, s.states + used, own, &fastest);
                used += put_load(&s, EXPONENTIAL, s.states + used, own, &fastest);
                put_load(&s, RAMP, s.states + used, own, &fastest);
            } else
                put_load(&s, load, s.states, own, &fastest);
            assert_increment(&s, tau_of(fastest, from, to), names[load]);
        }
        report(names[load]);
    }
}

/* Masses on the ground by nothing, pushed by a power of t: columns far from the states */
static void far_columns(void **state)
{
    int i, j;
    (void)state;
    drawn = 7;
    for (i = 0; i < 300; i++) {
        const int length = 1 + below(9);
        double damping;
        system_of s;
        clear(&s, 2, length);
        damping = i % 3 ? between(0.0, 2.0) : 0;
        one_mass(&s, 1.0, damping, i % 3 == 1 ? between(0.0, 1.0) : 0);
        *entry(&s, 1, 2) = about(scattered(1e-3, 1e3));
        for (j = 0; j < length - 1; j++)
            *entry(&s, 2 + j, 3 + j) = word_of(length - 1 - j);
        assert_increment(&s, (real)scattered(1e-3, 4.0), "far columns");
    }
    report("far columns");
}

/* Two ways to a load's column that all but cancel at tau: what acts at once, and what comes by way of the other column
 */
static void cancelling_loads(void **state)
{
    int i, j;
    (void)state;
    drawn = 10;
    for (i = 0; i < 300; i++) {
        const int masses = below(3),
                  all = i % 3 == 0; /* masses 0: x' = -a x; all: to the next order of tau, else a tenth is left */
        double fastest, rate, force;
        real tau;
        system_of s;
        clear(&s, masses > 0 ? 2 * masses : 1, 2);
        if (masses > 0)
            fastest = random_masses(&s, masses, 1e-4, i % 2 ? 1.0 : 0.0);
        else {
            fastest = scattered(1.0, 1e6);
            *entry(&s, 0, 0) = about(-fastest);
        }
        rate = fastest * scattered(1e-3, 1.0);
        tau = tau_of(fastest, all ? -10.0 : -30.0, 1.0);
        force = scattered(1e-3, 1e3);
        *entry(&s, s.states, s.states + 1) = word_of(rate);
        *entry(&s, s.states + 1, s.states) = word_of(-rate);
        for (j = masses; j < s.states; j++) {
            *entry(&s, j, s.states) = about(force);
            *entry(&s, j, s.states + 1) = about(-force * rate * (double)tau / 2 * (all ? 1 : between(0.8, 0.9)));
        }
        assert_increment(&s, tau, "cancelling loads");
    }
    report("cancelling loads");
}

/* Matrices of no meaning, in units of no meaning */
static void random_matrices(void **state)
{
    int i, j, k;
    (void)state;
    drawn = 11;
    for (i = 0; i < 1000; i++) {
        const int states = 1 + below(4), others = below(3), n = states + others, dense = below(2);
        double unit[LARGEST];
        system_of s;
        clear(&s, states, others);
        for (j = 0; j < n; j++)
            unit[j] = scattered(1e-4, 1e4);
        for (j = 0; j < n; j++)
            for (k = j < states ? 0 : states; k < n; k++)
                if (dense || below(2))
                    *entry(&s, j, k) = about(either(scattered(1e-2, 1.0)) * unit[j] / unit[k]);
        assert_increment(&s, tau_of(1.0, -10.0, 5.0), "random matrices");
    }
    report("random matrices");
}

static void assert_status(int found, int expected, const char *what)
{
    if (found != expected)
        fail_msg("%s: found status %d, expected %d", what, found, expected);
}

static void ends_of_the_range(void **state)
{
    static const real special[] = {(real)INFINITY, (real)-INFINITY, (real)NAN};
    pl_two work[PL_INCREMENT_WORK(4)];
    pl_two D[16];
    system_of s;
    int i, j;
    (void)state;
    clear(&s, 2, 2);
    one_mass(&s, 1.0, 0.1, 4.0);
    *entry(&s, 1, 2) = *entry(&s, 2, 3) = word_of(1.0);
    assert_status(pl_increment(4, 2, s.A, 0, 1, D, work), 0, "tau = 0");
    for (i = 0; i < 8; i++)
        if (D[i].hi != 0)
            fail_msg("tau = 0, entry %d: found %.17g, expected 0", i, (double)D[i].hi);
    for (i = 0; i < 3; i++) {
        assert_status(pl_increment(4, 2, s.A, special[i], 1, D, work), PL_NOT_FINITE, "tau not finite");
        for (j = 0; j < 4; j++) {
            const pl_two kept = *entry(&s, 1, j);
            *entry(&s, 1, j) = word_of(special[i]);
            assert_status(pl_increment(4, 2, s.A, (real)0x1p-10, 1, D, work), PL_NOT_FINITE, "A not finite");
            assert_status(pl_increment(4, 2, s.A, (real)0.5, 1, D, work), PL_NOT_FINITE, "A not finite");
            assert_status(pl_increment(4, 2, s.A, (real)100, 1, D, work), PL_NOT_FINITE, "A not finite");
            *entry(&s, 1, j) = kept;
        }
        *entry(&s, 2, 3) = word_of(special[i]);
        assert_status(pl_increment(4, 2, s.A, (real)0.5, 1, D, work), PL_NOT_FINITE, "a load not finite");
        *entry(&s, 2, 3) = word_of(1.0);
    }
    assert_status(pl_increment(4, 2, s.A, (real)1e20, 1, D, work), PL_NOT_FINITE, "a norm beyond what is taken");
    assert_status(pl_increment(4, 2, s.A, REAL_LARGE, 1, D, work), PL_NOT_FINITE, "a norm beyond what is taken");
    *entry(&s, 1, 1) = word_of(1.0);
    assert_status(pl_increment(4, 2, s.A, 20, 1, D, work), 0, "a growing state, a short time");
    assert_status(pl_increment(4, 2, s.A, 1e5, 1, D, work), PL_NOT_FINITE, "a growing state, a long time");
    *entry(&s, 1, 1) = word_of(0.0);
    *entry(&s, 2, 2) = word_of(1.0);
    assert_status(pl_increment(4, 2, s.A, 1e5, 1, D, work), PL_NOT_FINITE, "a growing load");
    clear(&s, 1, 0);
    *entry(&s, 0, 0) = word_of(-1e6);
    assert_status(pl_increment(1, 1, s.A, 1e3, 1, D, work), 0, "a state that decays at once");
    if (D[0].hi != -1)
        fail_msg("a state that decays at once: found %.17g, expected -1", (double)D[0].hi);
}

/* ---- equations ---- */

enum { ROWS = 4, COLUMNS = 6, PARAMS = 5, MONOMIALS = 8, TERMS = 64, WIDEST = COLUMNS + ROWS };

/* Entries are sums of factors times products of params: an earlier one times a param, or divided by it; product 0 is 1.
 */
typedef struct case_of {
    pl_equations e;
    int monomials, terms;
    struct { int from, param, divides; } monomial[MONOMIALS];
    struct { int row, column, monomial; pl_two factor; } term[TERMS];
    pl_two constant[TERMS + 1];
    pl_operation operation[MONOMIALS + 2 * TERMS];
    pl_place place[TERMS];
    real params[PARAMS];
} case_of;

/* The number that it makes */
static int add_operation(case_of *c, int what, int a, int b)
{
    pl_operation *const o = c->operation + c->e.operations;
    o->what = (unsigned short)what;
    o->a = (unsigned short)a;
    o->b = (unsigned short)b;
    return PARAMS + c->e.constants + c->e.operations++;
}

/* Into its entry, which may have some before; sums, differences and opposites in turn */
static void add_to_entry(case_of *c, int term, int number, int negative)
{
    pl_place *p = c->place;
    for (; p < c->place + c->e.places; p++)
        if (p->row == c->term[term].row && p->column == c->term[term].column) {
            const int differ = negative != p->negative;
            p->number = (unsigned short)add_operation(c, differ ? PL_DIFFERENCE : PL_SUM, p->number, number);
            return;
        }
    c->e.places++;
    p->row = (unsigned short)c->term[term].row;
    p->column = (unsigned short)c->term[term].column;
    p->number = (unsigned short)number;
    p->negative = (unsigned short)negative;
}

static int equations_at(case_of *c, pl_two *value, pl_two *work)
{
    int number[MONOMIALS + 1], i;
    c->e.operations = c->e.places = 0;
    c->e.constants = (unsigned short)(c->terms + 1);
    c->constant[0] = word_of(1.0);
    number[0] = PARAMS;
    for (i = 0; i < c->monomials; i++)
        number[i + 1] = add_operation(c, c->monomial[i].divides ? PL_QUOTIENT : PL_PRODUCT,
                                      number[c->monomial[i].from], c->monomial[i].param);
    for (i = 0; i < c->terms; i++) {
        const pl_two factor = c->term[i].factor;
        pl_two *const constant = c->constant + i + 1;
        constant->hi = i % 2 ? -factor.hi : factor.hi;
        constant->lo = i % 2 ? -factor.lo : factor.lo;
        add_to_entry(c, i, c->term[i].monomial == 0
                           ? PARAMS + i + 1
                           : add_operation(c, PL_PRODUCT, number[c->term[i].monomial], PARAMS + i + 1), i % 2);
    }
    c->e.constant = c->constant;
    c->e.operation = c->operation;
    c->e.place = c->place;
    return pl_equations_at(&c->e, c->params, value, work);
}

static void set_fraction(mpq_t v, pl_two t)
{
    mpq_t low;
    mpq_init(low);
    mpq_set_d(v, t.hi);
    mpq_set_d(low, t.lo);
    mpq_add(v, v, low);
    mpq_clear(low);
}

/* Row i divided by its entry k, and taken off all others: [R | W] -> [W^-1 R | I], n x width with W from `first` on. 0:
 * singular */
static int exact_solve(int n, int first, int width, mpq_t *value)
{
    int i, j, k;
    mpq_t t, factor;
    mpq_inits(t, factor, (mpq_ptr)0);
    for (k = 0; k < n; k++) {
        for (i = k; i < n && mpq_sgn(value[i * width + first + k]) == 0; i++)
            ;
        if (i == n)
            break;
        for (j = 0; j < width; j++)
            mpq_swap(value[i * width + j], value[k * width + j]);
        mpq_inv(factor, value[k * width + first + k]);
        for (j = 0; j < width; j++)
            mpq_mul(value[k * width + j], value[k * width + j], factor);
        for (i = 0; i < n; i++)
            if (i != k) {
                mpq_set(factor, value[i * width + first + k]);
                for (j = 0; j < width; j++) {
                    mpq_mul(t, factor, value[k * width + j]);
                    mpq_sub(value[i * width + j], value[i * width + j], t);
                }
            }
    }
    mpq_clears(t, factor, (mpq_ptr)0);
    return k == n;
}

/* Of each entry at most LOSS sum_k |W^-1|_ik, times the largest in that column of R' + W' |W^-1 R|, where R' and W' are
 * sums of the sizes of terms; without W LOSS R'. */
static void assert_equations(case_of *c, const char *family)
{
    const pl_equations *e = &c->e;
    const int n = e->rows, width = e->columns + (e->solves ? n : 0),
              wide = width + n; /* and the unit matrix, for W^-1 */
    mpq_t exact[ROWS * (WIDEST + ROWS)], sizes[ROWS * (WIDEST + ROWS)], monomial[MONOMIALS + 1], t, u, sum, inverse;
    pl_two value[ROWS * WIDEST], work[MONOMIALS + 2 * TERMS];
    int i, j, k, l, status;
    mpq_inits(t, u, sum, inverse, (mpq_ptr)0);
    for (i = 0; i < n * wide; i++)
        mpq_inits(exact[i], sizes[i], (mpq_ptr)0);
    for (i = 0; i <= c->monomials; i++)
        mpq_init(monomial[i]);
    mpq_set_ui(monomial[0], 1, 1);
    for (i = 0; i < c->monomials; i++) {
        mpq_set_d(t, c->params[c->monomial[i].param]);
        (c->monomial[i].divides ? mpq_div : mpq_mul)(monomial[i + 1], monomial[c->monomial[i].from], t);
    }
    for (i = 0; i < c->terms; i++) {
        const int at = c->term[i].row * wide + c->term[i].column;
        set_fraction(t, c->term[i].factor);
        mpq_mul(t, t, monomial[c->term[i].monomial]);
        mpq_add(exact[at], exact[at], t);
        mpq_abs(t, t);
        mpq_add(sizes[at], sizes[at], t);
    }
    for (i = 0; i < n; i++)
        mpq_set_ui(exact[i * wide + width + i], 1, 1);
    status = e->solves && !exact_solve(n, e->columns, wide, exact) ? PL_SINGULAR : 0;
    assert_status(equations_at(c, value, work), status, family);
    for (i = 0; i < n && status == 0; i++)
        for (j = 0; j < e->columns; j++) {
            double off, terms;
            mpq_set_ui(u, 0, 1);
            mpq_set_ui(inverse, 0, 1);
            for (k = 0; k < n; k++) {
                mpq_set(sum, sizes[k * wide + j]);
                for (l = 0; l < n && e->solves; l++) {
                    mpq_abs(t, exact[l * wide + j]);
                    mpq_mul(t, t, sizes[k * wide + e->columns + l]);
                    mpq_add(sum, sum, t);
                }
                mpq_abs(t, exact[i * wide + width + k]);
                mpq_add(inverse, inverse, t);
                if (e->solves ? mpq_cmp(sum, u) > 0 : k == i)
                    mpq_set(u, sum);
            }
            mpq_mul(u, u, inverse);
            terms = mpq_get_d(u);
            set_fraction(t, value[i * width + j]);
            mpq_sub(t, t, exact[i * wide + j]);
            off = fabs(mpq_get_d(t));
            if (terms > 0)
                worst = worse(worst, off / terms);
            if (!(off <= LOSS * terms))
                fail_msg("%s, row %d, column %d: found %.17g + %.17g, expected %.17g; off by %g, bound %g", family, i,
                         j, (double)value[i * width + j].hi, (double)value[i * width + j].lo,
                         mpq_get_d(exact[i * wide + j]), off, LOSS * terms);
        }
    for (i = 0; i < n * wide; i++)
        mpq_clears(exact[i], sizes[i], (mpq_ptr)0);
    for (i = 0; i <= c->monomials; i++)
        mpq_clear(monomial[i]);
    mpq_clears(t, u, sum, inverse, (mpq_ptr)0);
}

static void report_equations(const char *family)
{
    print_message("# %s: off by 2^%.1f of all terms at most, bound 2^%.0f\n", family, log2(worst), log2(LOSS));
    worst = 0;
}

/* No more than a term for each entry, and no monomials yet */
static void start_case(case_of *c, int rows, int columns, int solves)
{
    memset(c, 0, sizeof *c);
    c->e.rows = rows;
    c->e.columns = columns;
    c->e.solves = solves;
    c->e.params = PARAMS;
}

static void random_products(case_of *c)
{
    int i;
    for (i = 0; i < PARAMS; i++)
        c->params[i] = (real)either(scattered(1e-2, 1e2));
    c->monomials = below(MONOMIALS + 1);
    for (i = 0; i < c->monomials; i++) {
        c->monomial[i].from = below(i + 1);
        c->monomial[i].param = below(PARAMS);
        c->monomial[i].divides = below(2);
    }
}

static void put_term(case_of *c, int row, int column, int monomial, pl_two factor)
{
    const int i = c->terms++;
    c->term[i].row = row;
    c->term[i].column = column;
    c->term[i].monomial = monomial;
    c->term[i].factor = factor;
}

static void equations(void **state)
{
    int i, row, column, solves;
    (void)state;
    drawn = 8;
    for (solves = 0; solves <= 1; solves++) {
        for (i = 0; i < samples(2000); i++) {
            case_of c;
            start_case(&c, 1 + below(ROWS), 1 + below(COLUMNS), solves);
            random_products(&c);
            for (row = 0; row < c.e.rows; row++)
                for (column = 0; column < c.e.columns + (solves ? c.e.rows : 0); column++)
                    if (below(3) || column == c.e.columns + row) {
                        int terms = 1 + (c.terms < TERMS - 40 ? below(3) : 0);
                        for (; terms > 0; terms--) {
                            const pl_two factor =
                                below(3) ? about(either(scattered(1e-3, 1e3))) : word_of(either(1.0));
                            put_term(&c, row, column, below(c.monomials + 1), factor);
                        }
                    }
            assert_equations(&c, solves ? "equations with a mass matrix" : "equations");
        }
        report_equations(solves ? "equations with a mass matrix" : "equations");
    }
}

/* W = L U with a small last pivot, in numbers of two words */
static void nearly_singular(void **state)
{
    int i, row, column;
    (void)state;
    drawn = 9;
    for (i = 0; i < samples(500); i++) {
        case_of c;
        const int n = 2 + below(ROWS - 1);
        start_case(&c, n, 3, 1);
        random_products(&c);
        c.monomials = 1;
        c.monomial[0].from = 0;
        for (row = 0; row < n; row++) {
            for (column = 0; column < 3; column++) {
                const pl_two factor = about(between(-1.0, 1.0));
                put_term(&c, row, column, below(2), factor);
            }
            for (column = 0; column < n; column++) { /* rank one, and a little */
                put_term(&c, row, 3 + column, 1, word_of((row + 1.0) * (column + 2.0)));
                put_term(&c, row, 3 + column, 0, about(either(scattered(REAL_EPSILON, 1e-3))));
            }
        }
        assert_equations(&c, "nearly singular");
    }
    report_equations("nearly singular");
}

static void singular(void **state)
{
    pl_two value[ROWS * WIDEST], work[MONOMIALS + 2 * TERMS];
    int row, column, n;
    (void)state;
    drawn = 12;
    for (n = 1; n <= ROWS; n++) {
        case_of c;
        start_case(&c, n, 2, 1);
        for (row = 0; row < n; row++) {
            put_term(&c, row, 0, 0, word_of(1.0));
            for (column = 0; column < n && n > 1; column++)
                put_term(&c, row, 2 + column, 0, word_of((row + 1.0) * (column + 2.0)));
        }
        assert_equations(&c, "singular"); /* by the same road: exactly singular there too */
        assert_status(equations_at(&c, value, work), PL_SINGULAR, "singular");
    }
    for (n = 0; n < 100;
         n++) { /* m on an arm: m L^2 a + m L b = ..., m L a + m b = ...; in no number of words exactly */
        case_of c;
        start_case(&c, 2, 1, 1);
        c.params[0] = (real)scattered(0.1, 10.0);
        c.params[1] = (real)scattered(0.1, 10.0);
        c.monomials = 3;
        for (row = 1; row < 3; row++) {
            c.monomial[row].from = row;
            c.monomial[row].param = 1;
        }
        put_term(&c, 0, 0, 0, word_of(1.0));
        put_term(&c, 0, 1, 3, word_of(1.0));
        put_term(&c, 0, 2, 2, word_of(1.0));
        put_term(&c, 1, 1, 2, word_of(1.0));
        put_term(&c, 1, 2, 1, word_of(1.0));
        assert_equations(&c, "singular but for rounding");
    }
}

static void not_finite(void **state)
{
    static const real special[] = {(real)INFINITY, (real)-INFINITY, (real)NAN};
    pl_two value[ROWS * WIDEST], work[MONOMIALS + 2 * TERMS];
    case_of c;
    int i, k, solves;
    (void)state;
    for (solves = 0; solves <= 1; solves++) { /* p0^2 a = (1 - p1/p2) x, or without p0 */
        start_case(&c, 1, 1, solves);
        c.monomials = 4;
        c.monomial[0].param = 0;
        c.monomial[1].param = 1;
        c.monomial[2].from = 2;
        c.monomial[2].param = 2;
        c.monomial[2].divides = 1;
        c.monomial[3].from = 1;
        put_term(&c, 0, 0, 3, word_of(-1.0));
        put_term(&c, 0, 0, 0, word_of(1.0)); /* behind what overflows */
        if (solves)
            put_term(&c, 0, 1, 4, word_of(1.0));
        for (i = 0; i < PARAMS; i++)
            c.params[i] = (real)(i + 2);
        assert_status(equations_at(&c, value, work), 0, "all finite");
        for (i = 0; i < PARAMS; i++)
            for (k = 0; k < 3; k++) {
                const real kept = c.params[i];
                c.params[i] = special[k];
                assert_status(equations_at(&c, value, work), PL_NOT_FINITE, "a param not finite");
                c.params[i] = kept;
            }
        c.params[2] = 0;
        assert_status(equations_at(&c, value, work), PL_SINGULAR, "1 / 0");
        c.params[1] = 0;
        assert_status(equations_at(&c, value, work), PL_SINGULAR, "0 / 0");
        c.params[1] = REAL_LARGE;
        c.params[2] = 1 / REAL_LARGE / 16;
        assert_status(equations_at(&c, value, work), PL_NOT_FINITE, "overflow");
        c.params[1] = c.params[2] = 1;
        c.params[0] = REAL_LARGE;
        assert_status(equations_at(&c, value, work), solves ? PL_NOT_FINITE : 0, "overflow of a mass");
        c.params[0] = 0;
        assert_status(equations_at(&c, value, work), solves ? PL_SINGULAR : 0, "no mass");
    }
}

static void start(void)
{
    int i;
    for (i = 0; i < LARGEST * LARGEST; i++)
        mpfr_inits2(BITS, exact_A[i], exact_D[i], power[i], room[i], (mpfr_ptr)0);
    mpfr_init2(temporary, BITS);
}

static void end(void)
{
    int i;
    for (i = 0; i < LARGEST * LARGEST; i++)
        mpfr_clears(exact_A[i], exact_D[i], power[i], room[i], (mpfr_ptr)0);
    mpfr_clear(temporary);
}

/* What a ramp's value before the step is multiplied with, u - u'/h: is less than two fifths of the larger left? */
static void ramps_that_cancel(void **state)
{
    static const struct {
        double u, slope;
        int cancels;
    } cases[] = {{1, 0.25, 0}, {1, 0.49, 1}, {1, 0.5, 1}, {-1, -0.45, 1}, {1, -0.5, 0}, {0.5, 0.5, 0}, {1, 0.26, 0}};
    size_t k;
    (void)state;
    for (k = 0; k < sizeof cases / sizeof *cases; k++) {
        pl_two D[3] = {{3, 0}, {0, 0}, {0, 0}};
        int found;
        D[1].hi = (real)cases[k].u;
        D[2].hi = (real)cases[k].slope;
        found = pl_ramp_cancels(3, 1, D, 1, (real)0.5);
        if (found != cases[k].cancels)
            fail_msg("u %g, u' %g, h 0.5: %d, expected %d", cases[k].u, cases[k].slope, found, cases[k].cancels);
    }
}

/* sin(w t) of params w and c: held.h without the generator */
typedef struct swung_coeffs {
    real params[2];
} swung_coeffs;
typedef struct swung {
    swung_coeffs coeffs;
    pl_lead lead[1];
    real now;
    int placed;
} swung;
static real swung_time(const swung *s) { return s->now; }
static void swung_place(swung *s) { s->placed++; }
static void swung_frequencies(const swung *s, real w[]) { w[0] = s->coeffs.params[0]; }

#ifdef REAL_IS_FLOAT
#define PL_SINGLE 1
#else
#define PL_SINGLE 0
#endif
#define PL(name) swung_##name
#define PL_TYPE swung
#define PL_PARAMS 2
#define PL_H ((real)0.25)
#define PL_RETUNED 0
#define PL_LEADS 1
#define PL_MODES 0
#define PL_PLACES 1
int swung_retune(swung_coeffs *c, const real params[2], real h);
void swung_use(swung *s, const swung_coeffs *c);
#include "held.h"

static void held_by_an_instance(void **state)
{
    const real params[2] = {3, 5}, infinite[2] = {3, (real)INFINITY};
    swung s = {.coeffs = {{2, 5}}, .now = 4};
    swung_coeffs c = s.coeffs;
    (void)state;
    assert_int_equal(swung_retune(&c, params, (real)0.5), PL_NO_STEP);
    assert_int_equal(swung_retune(&c, infinite, (real)0.25), PL_NOT_FINITE);
    assert_memory_equal(&c, &s.coeffs, sizeof c);
    assert_int_equal(swung_retune(&c, params, (real)0.25), 0);
    swung_use(&s, &c);
    assert_memory_equal(s.coeffs.params, params, sizeof params);
    assert_int_equal(s.placed, 1);
    if (fabs(sin(2 * 4.0) - sin(3 * 4.0 + (double)s.lead[0].angle)) > 16 * (double)REAL_EPSILON)
        fail_msg("the phase jumps: a lead of %.17g", (double)s.lead[0].angle);
}

ROOM_WITH(retune, start, end,
    cmocka_unit_test(damped),
    cmocka_unit_test(undamped),
    cmocka_unit_test(near_confluence),
    cmocka_unit_test(stiff),
    cmocka_unit_test(rigid_body),
    cmocka_unit_test(loads),
    cmocka_unit_test(far_columns),
    cmocka_unit_test(cancelling_loads),
    cmocka_unit_test(random_matrices),
    cmocka_unit_test(ends_of_the_range),
    cmocka_unit_test(equations),
    cmocka_unit_test(nearly_singular),
    cmocka_unit_test(singular),
    cmocka_unit_test(ramps_that_cancel),
    cmocka_unit_test(not_finite),
    cmocka_unit_test(held_by_an_instance))
