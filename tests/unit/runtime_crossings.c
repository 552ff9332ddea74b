/* SPDX-License-Identifier: GPL-3.0-or-later */
/* runtime/crossings.c against closed forms, published values, and small steps in long double with crossings by
 * bisection. */
#include "runtime.h"

/* Tolerances below are those for doubles; a float's are COARSER times as large. */
#define COARSER ((double)REAL_EPSILON / DBL_EPSILON)

/* What is near enough to level, to a breakpoint or to another crossing to be hard, and yet above rounding */
#ifdef REAL_IS_FLOAT
enum { LEAST_GRAZING = 4, FIRST_APART = 1, LAST_APART = 2, LEAST_HIDDEN = 2 }; /* powers of 1/10 */
enum { DEGREE = 14 };
#define JUST 1e-5
#define NEAR 1e-4
#define ALIKE 1e-3
#define NARROW 1e-4
#define LARGE 1e30
#define LARGEST -1e38
#else
enum { LEAST_GRAZING = 10, FIRST_APART = 3, LAST_APART = 6, LEAST_HIDDEN = 10 };
enum { DEGREE = 21 };
#define JUST 1e-12
#define NEAR 1e-8
#define ALIKE 1e-9
#define NARROW 1e-9
#define LARGE 1e300
#define LARGEST -1e308
#endif

enum { N = 10, S = 3, B = 2, R = 27, RUNGS = 16, LARGEST_DEGREE = 24, EVENTS = 64, SPLITS = 4000 };

/* A model as the generator would emit it.  A of a region is base plus what each switch adds in its interval. */
typedef struct model {
    pl_switching m;
    double base[N * N], add[S][B + 1][N * N];
    real row[S * N], at[S * B], *A, *Phi, *tangent, *chord_error, *cubic_error, *rungs, *reach;
    int states, breaks[S], matrix[R], halvings[R], rung[R], spacing[R]; /* states: the model's own, coordinates first */
    int regions;
    real x[N], *work;
    pl_contact c;
    pl_crossing *crossing;
} model;

static double uniform(double lo, double hi)
{
    return lo + (hi - lo) * (double)(random_word() >> 11) * 0x1p-53;
}

static int below(int n)
{
    return (int)uniform(0.0, n);
}

/* Memory of just the size used, for the sanitizers and valgrind */
static real *reals(int count)
{
    real *x = (real *)malloc(sizeof *x * (size_t)count);
    assert_non_null(x);
    memset(x, 0xFF, sizeof *x * (size_t)count);
    return x;
}

static model *new_model(int states, int size, int switches)
{
    model *s = (model *)calloc(1, sizeof *s);
    assert_non_null(s);
    s->m.size = size;
    s->states = states;
    s->m.switches = switches;
    return s;
}

static void unbuild(model *s)
{
    free(s->A);
    free(s->Phi);
    free(s->tangent);
    free(s->chord_error);
    free(s->cubic_error);
    free(s->rungs);
    free(s->reach);
    free(s->work);
    free(s->crossing);
}

static void free_model(model *s)
{
    unbuild(s);
    free(s);
}

/* ---- tables, by the Taylor series in long double ---- */

static void product(int n, const long double *a, const long double *b, long double *c)
{
    int i, j, k;
    for (i = 0; i < n; i++)
        for (j = 0; j < n; j++)
            for (c[i * n + j] = 0.0L, k = 0; k < n; k++)
                c[i * n + j] += a[i * n + k] * b[k * n + j];
}

/* e^{A tau}, or e^{|A| tau} */
static void exponential(int n, const real *A, long double tau, int absolute, long double *E)
{
    long double P[N * N], Q[N * N], T[N * N];
    int i, k, squarings = 0, r;
    long double norm = 0.0L;
    for (i = 0; i < n * n; i++)
        norm += fabsl(A[i] * tau);
    while (norm > 0.5L)
        norm /= 2.0L, squarings++;
    for (i = 0; i < n * n; i++) {
        P[i] = (absolute ? fabsl((long double)A[i]) : A[i]) * tau / powl(2.0L, squarings);
        T[i] = E[i] = i % (n + 1) == 0;
    }
    for (k = 1; k <= 22; k++) {
        product(n, T, P, Q);
        for (i = 0; i < n * n; i++)
            E[i] += T[i] = Q[i] / k;
    }
    for (r = 0; r < squarings; r++) {
        product(n, E, E, Q);
        memcpy(E, Q, sizeof *E * (size_t)(n * n));
    }
}

/* max |pole| from above, to a few percent: |A^64|^(1/64) */
static double fastest(int n, const real *A)
{
    long double P[N * N], Q[N * N], norm, log_scale = 0.0L;
    int i, k;
    for (i = 0; i < n * n; i++)
        P[i] = A[i];
    for (k = 0; k <= 6; k++) {
        norm = 0.0L;
        for (i = 0; i < n * n; i++)
            norm += fabsl(P[i]);
        if (norm < 1e-300L)
            return 0.0; /* nilpotent */
        log_scale += logl(norm) / powl(2.0L, k);
        for (i = 0; i < n * n; i++)
            P[i] /= norm;
        product(n, P, P, Q);
        memcpy(P, Q, sizeof *P * (size_t)(n * n));
    }
    return (double)expl(log_scale);
}

/* row A^k e^{|A| h}, entrywise absolute, times factor */
static void bound(int n, const real *row, const real *A, int k, const long double *growth, double factor, real *found)
{
    long double v[N], w[N];
    int i, j;
    for (i = 0; i < n; i++)
        v[i] = row[i];
    for (; k > 0; k--) {
        for (j = 0; j < n; j++)
            for (w[j] = 0.0L, i = 0; i < n; i++)
                w[j] += v[i] * A[i * n + j];
        memcpy(v, w, sizeof v);
    }
    for (j = 0; j < n; j++) {
        w[j] = 0.0L;
        for (i = 0; i < n; i++)
            w[j] += fabsl(v[i]) * growth[i * n + j];
        found[j] = (real)(w[j] * factor * (1.0L + 8.0L * REAL_EPSILON));
    }
}

/* Pieces by e^{A d} - I where that is the smaller number, and what is off their chords as retuned models have it */
static void ladder_of(model *s, int r, double step)
{
    const int n = s->m.size, switches = s->m.switches;
    const real *A = s->A + r * n * n;
    real *rung = s->rungs + r * RUNGS * (n + 1) * n, *work = reals(PL_REACH_WORK(n, switches));
    long double E[N * N];
    int down, i, j;
    s->rung[r] = r * RUNGS;
    s->spacing[r] = s->halvings[r] > RUNGS ? (s->halvings[r] + RUNGS - 1) / RUNGS : 1 + r % 3;
    for (down = s->halvings[r]; down > 0; down -= s->spacing[r], rung += (n + 1) * n) {
        exponential(n, A, ldexp(step, -down), 0, E);
        for (i = 0; i < n; i++) {
            rung[n * n + i] = E[i * n + i] > 0.5L;
            E[i * n + i] -= rung[n * n + i];
            for (j = 0; j < n; j++)
                rung[i * n + j] = (real)E[i * n + j];
        }
    }
    pl_region_reach(n, s->m.h, s->halvings[r], s->spacing[r], A, switches, s->row,
                    s->reach + r * RUNGS * switches * n, work);
    free(work);
}

static void tables_of(model *s, int r, double step)
{
    const int n = s->m.size;
    real *A = s->A + r * n * n;
    double most, h;
    long double E[N * N], growth[N * N];
    int i, j, k, code;
    for (j = 0; j < n * n; j++) {
        double sum = s->base[j];
        for (code = r, i = 0; i < s->m.switches; code /= s->breaks[i] + 1, i++)
            sum += s->add[i][code % (s->breaks[i] + 1)][j];
        A[j] = (real)sum;
    }
    most = fastest(n, A) * step;
    s->halvings[r] = most > 1.0 ? (int)ceil(log2(most)) : 0;
    h = ldexp(step, -s->halvings[r]);
    exponential(n, A, step, 0, E);
    for (j = 0; j < n * n; j++)
        s->Phi[r * n * n + j] = (real)E[j];
    ladder_of(s, r, step);
    exponential(n, A, h, 1, growth);
    for (i = 0; i < s->m.switches; i++) {
        const int at = (r * s->m.switches + i) * n;
        const real *row = s->row + i * n;
        for (j = 0; j < n; j++) {
            double sum = 0.0;
            for (k = 0; k < n; k++)
                sum += h / 3.0 * row[k] * A[k * n + j];
            s->tangent[at + j] = (real)sum;
        }
        bound(n, row, A, 2, growth, h * h / 8.0, s->chord_error + at);
        bound(n, row, A, 4, growth, h * h * h * h / 384.0, s->cubic_error + at);
    }
}

static void build(model *s, double h)
{
    const int n = s->m.size, switches = s->m.switches;
    int i;
    unbuild(s);
    for (s->regions = 1, i = 0; i < switches; i++)
        s->regions *= s->breaks[i] + 1;
    s->A = reals(s->regions * n * n);
    s->Phi = reals(s->regions * n * n);
    s->tangent = reals(s->regions * n * switches);
    s->chord_error = reals(s->regions * n * switches);
    s->cubic_error = reals(s->regions * n * switches);
    s->rungs = reals(s->regions * RUNGS * (n + 1) * n);
    s->reach = reals(s->regions * RUNGS * switches * n);
    s->m.h = (real)h;
    for (i = 0; i < s->regions; i++) {
        s->matrix[i] = i;
        tables_of(s, i, (double)(real)h);
    }
    s->m.degree = DEGREE;
    s->m.row = s->row;
    s->m.breaks = s->breaks;
    s->m.at = s->at;
    s->m.matrix = s->matrix;
    s->m.A = s->A;
    s->m.Phi = s->Phi;
    s->m.tangent = s->tangent;
    s->m.chord_error = s->chord_error;
    s->m.cubic_error = s->cubic_error;
    s->m.halvings = s->halvings;
    s->m.ladder.first = s->rung;
    s->m.ladder.spacing = s->spacing;
    s->m.ladder.pieces = s->rungs;
    s->m.ladder.reach = s->reach;
    s->m.max_events = EVENTS;
    s->m.max_splits = SPLITS;
    s->work = reals(PL_SWITCHING_WORK(n, switches, s->m.degree));
    s->crossing = (pl_crossing *)malloc(sizeof *s->crossing * EVENTS);
    assert_non_null(s->crossing);
}

static void start_here(model *s)
{
    memset(&s->c, 0xFF, sizeof s->c);
    pl_switching_start(&s->m, s->x, &s->c, s->work);
}

static void start(model *s, const double *x)
{
    int i;
    for (i = 0; i < s->m.size; i++)
        s->x[i] = (real)x[i];
    start_here(s);
}

static void step(model *s)
{
    pl_switching_step(&s->m, s->x, &s->c, s->crossing, s->work);
}

static void steps(model *s, int n)
{
    while (n-- > 0)
        step(s);
}

static void assert_near(double found, double expected, double tolerance, const char *what, double h)
{
    if (!(fabs(found - expected) <= COARSER * tolerance))
        fail_msg("%s, h = %g: found %.17g, expected %.17g, off by %.3g, tolerance %.3g", what, h, found, expected,
                 found - expected, COARSER * tolerance);
}

static void assert_count(const model *s, uint64_t expected, const char *what, double at)
{
    if (s->c.total != expected || s->c.status != 0)
        fail_msg("%s at %g: %d crossings, status %d; expected %d and 0", what, at, (int)s->c.total, s->c.status,
                 (int)expected);
}

/* ---- models ---- */

/* q' = v; then 1, and cos w t, sin w t */
static model *oscillator(int dof, int switches, double w)
{
    model *s = new_model(2 * dof, 2 * dof + 3, switches);
    const int n = s->m.size, one = 2 * dof;
    int i;
    for (i = 0; i < dof; i++)
        s->base[i * n + dof + i] = 1.0;
    s->base[(one + 1) * n + one + 2] = -w;
    s->base[(one + 2) * n + one + 1] = w;
    return s;
}

/* dof x dof entries of -M^-1 K or -M^-1 C into the rows of v' */
static void couple(model *s, int column, int i, int j, double value)
{
    const int dof = s->states / 2;
    s->base[(dof + i) * s->m.size + column + j] += value;
}

/* In `interval` of switch i: v'_j -= k (e - b) */
static void spring(model *s, int i, int interval, int j, double k, double b)
{
    const int dof = s->states / 2, n = s->m.size;
    double *to = s->add[i][interval] + (dof + j) * n;
    int l;
    for (l = 0; l < n; l++)
        to[l] -= k * s->row[i * n + l];
    to[2 * dof] += k * b;
}

/* One degree of freedom with a switch on q - a cos w t at the breakpoints */
static model *single(double k, double c, double force, double w, double shaken, int breaks, double lo, double hi)
{
    model *s = oscillator(1, 1, w);
    couple(s, 0, 0, 0, -k);
    couple(s, 1, 0, 0, -c);
    couple(s, 2, 0, 0, force);
    s->row[0] = 1;
    s->row[3] = (real)-shaken;
    s->breaks[0] = breaks;
    s->at[0] = (real)lo;
    s->at[1] = (real)hi;
    return s;
}

/* ---- closed forms ---- */

static const double several_steps[] = {0.01, 0.1, 1.0, 4.0};
enum { SEVERAL = sizeof several_steps / sizeof *several_steps };

static void bilinear_period(void **state)
{
    static const double from[5] = {0.0, 1.0, 1.0, 1.0, 0.0};
    const double w1 = 1.0, w2 = 3.0, period = acos(-1.0) * (1.0 / w1 + 1.0 / w2);
    int i, k, n;
    (void)state;
    for (i = 0; i < SEVERAL; i++) {
        model *s = single(w1 * w1, 0.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
        spring(s, 0, 1, 0, w2 * w2 - w1 * w1, 0.0);
        build(s, several_steps[i]);
        start(s, from);
        assert_int_equal(s->c.region, 1);
        for (n = 0; s->c.total < 12; n++) {
            const uint64_t before = s->c.total;
            step(s);
            for (k = 0; k < s->c.crossings; k++) {
                const uint64_t count = before + (uint64_t)k + 1;
                const double expected = (double)(count / 2) * period + (count % 2 ? acos(-1.0) / w2 : 0.0);
                assert_int_equal(s->crossing[k].upward, count % 2 == 0);
                assert_near(n * s->m.h + s->crossing[k].time, expected, 1e-12, "crossing", s->m.h);
            }
        }
        free_model(s);
    }
}

static void stiff_stop(void **state)
{
    static const double from[5] = {0.0, 1.0, 1.0, 1.0, 0.0}, some[] = {0.001, 0.01, 0.1};
    const double contact = 0.03126001526812332;
    int i, n;
    (void)state;
    for (i = 0; i < 3; i++) {
        model *s = single(1e4 / 100.0, 0.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
        spring(s, 0, 1, 0, 1e6 / 100.0, 0.0);
        build(s, some[i]);
        start(s, from);
        for (n = 0; s->c.total == 0; n++)
            step(s);
        assert_near(n * s->m.h - s->m.h + s->crossing[0].time, contact, 1e-15, "contact", s->m.h);
        start(s, from);
        for (n = 0; (n + 1) * s->m.h < contact / 2.0; n++)
            step(s);
        pl_switching_advance(&s->m, (real)(contact / 2.0 - n * s->m.h), s->x, &s->c, s->crossing, s->work);
        assert_near(1e6 * s->x[0], 9950.371902, 1e-6, "largest force", s->m.h);
        start(s, from);
        steps(s, (int)(0.2 / s->m.h + 0.5)); /* half a period of 10 rad/s back, from the end of the contact */
        assert_near(10.0 * 10.0 * s->x[0] * s->x[0] + s->x[1] * s->x[1], 1.0, 1e-12, "speed kept", s->m.h);
        assert_near(s->x[0], -sin(10.0 * (0.2 - contact)) / 10.0, 1e-14, "after contact", s->m.h);
        free_model(s);
    }
}

/* ---- gear pairs with clearance ---- */

static model *gear1(double eta)
{
    model *s = single(0.0, 0.1, 0.1, eta, 0.0, 2, -1.0, 1.0);
    couple(s, 3, 0, 0, 0.05);
    spring(s, 0, 0, 0, 1.0, -1.0);
    spring(s, 0, 2, 0, 1.0, 1.0);
    return s;
}

static void gear_of_one(void **state)
{
    static const double from[5] = {1.1, 0.0, 1.0, 1.0, 0.0}, h[] = {0.01, 0.1, 1.0};
    int i;
    (void)state;
    for (i = 0; i < 3; i++) {
        model *s = gear1(0.8);
        build(s, h[i]);
        start(s, from);
        steps(s, (int)(50.0 / h[i] + 0.5));
        assert_near(s->x[0], 1.3462716421777, 1e-12, "eta 0.8, q", h[i]);
        assert_near(s->x[1], 0.0182023595639939, 1e-12, "eta 0.8, q'", h[i]);
        assert_count(s, 12, "eta 0.8", h[i]);
        free_model(s);
        s = gear1(1.0);
        build(s, h[i]);
        start(s, from);
        steps(s, (int)(50.0 / h[i] + 0.5));
        assert_near(s->x[0], 0.9044965191187, 1e-12, "eta 1, q", h[i]);
        assert_near(s->x[1], 0.0052437460534, 1e-12, "eta 1, q'", h[i]);
        assert_count(s, 15, "eta 1", h[i]);
        free_model(s);
    }
}

static void gear_of_two(void **state)
{
    static const double from[7] = {1.2, 0.1, 0.0, 0.0, 1.0, 1.0, 0.0}, h[] = {0.01, 0.1, 1.0};
    static const double expected[4] = {1.255478222291, 0.278107931790, -0.141334496941, -0.146319581244};
    static const double Om[2][2] = {{1.0, -0.5}, {-0.5, 1.0}};
    int i, j, r;
    (void)state;
    for (r = 0; r < 3; r++) {
        model *s = oscillator(2, 1, 0.8);
        s->row[0] = 1.0;
        s->breaks[0] = 2;
        s->at[0] = -1.0;
        s->at[1] = 1.0;
        for (i = 0; i < 2; i++) {
            couple(s, 0, i, 1, -Om[i][1]);
            for (j = 0; j < 2; j++)
                couple(s, 2, i, j, -0.1 * Om[i][j]);
            spring(s, 0, 0, i, Om[i][0], -1.0);
            spring(s, 0, 2, i, Om[i][0], 1.0);
        }
        couple(s, 4, 0, 0, 0.1);
        couple(s, 4, 1, 0, 0.05);
        couple(s, 5, 0, 0, 0.05);
        build(s, h[r]);
        start(s, from);
        steps(s, (int)(20.0 / h[r] + 0.5));
        for (i = 0; i < 4; i++)
            assert_near(s->x[i], expected[i], 2e-12, "gear2", h[r]);
        assert_count(s, 2, "gear2", h[r]);
        free_model(s);
    }
}

/* ---- crossings that are easily missed ---- */

/* x = (1 + d) sin t towards a breakpoint at 1 */
static void grazing(void **state)
{
    int i, power, sign;
    (void)state;
    for (i = 0; i < SEVERAL; i++)
        for (power = 2; power <= LEAST_GRAZING; power++)
            for (sign = -1; sign <= 1; sign++) {
                const double d = sign * pow(10.0, -power), h = several_steps[i],
                             from[5] = {0.0, 1.0 + d, 1.0, 1.0, 0.0};
                model *s = single(1.0, 0.0, 0.0, 1.0, 0.0, 1, 1.0, 0.0);
                int n;
                spring(s, 0, 1, 0, 5.0, 1.0);
                build(s, h);
                start(s, from);
                for (n = 0; n * h < 4.0 && s->c.total == 0; n++)
                    step(s);
                if (sign > 0) {
                    assert_near((n - 1) * h + s->crossing[0].time, asin(1.0 / (1.0 + d)), 4e-15 / sqrt(d), "grazing",
                                h);
                    for (; n * h < 4.0; n++)
                        step(s);
                }
                assert_count(s, sign > 0 ? 2 : 0, "grazing", d);
                free_model(s);
            }
}

/* Free flight, x = p + d^2/8 - (t - c)^2/2 with p the breakpoint: two crossings d apart around t = c in the one step of
 * 1 */
static void two_crossings_in_a_step(void **state)
{
    static const double when[] = {0.001, 0.1, 0.5, 0.50001, 0.77, 0.999};
    int i, power;
    (void)state;
    for (i = 0; i < 6; i++)
        for (power = FIRST_APART; power <= LAST_APART; power++) {
            const double c = when[i], d = pow(10.0, -power),
                         from[5] = {3.0 + d * d / 8.0 - c * c / 2.0, c, 1.0, 1.0, 0.0};
            model *s;
            if (c <= d / 2.0 || c >= 1.0 - d / 2.0) /* not both within the step */
                continue;
            s = single(0.0, 0.0, -1.0, 1.0, 0.0, 1, 3.0, 0.0);
            spring(s, 0, 1, 0, 1e-3, 3.0);
            build(s, 1.0);
            start(s, from);
            step(s);
            assert_count(s, 2, "two crossings", d);
            assert_near(s->crossing[0].time, c - d / 2.0, 8e-15 / d, "first", c);
            assert_near(s->crossing[1].time, c + d / 2.0, 8e-15 / d, "second", c);
            assert_near(s->x[1], c - 1.0, 1e-12, "velocity", c);
            free_model(s);
        }
}

/* A load that is a polynomial in t with the given roots, as a switch of its own: a step of 1 that meets them all, and
 * its slope at the ends need not tell.  In between the mass is pushed one way or the other. */
static model *polynomial(const double *root, int roots)
{
    model *s = new_model(2, 8, 1);
    const int n = s->m.size;
    double product[6] = {1.0}, factorial = 1.0;
    int i, k;
    s->base[1] = 1.0;
    for (i = 3; i < n; i++)
        s->base[i * n + i - 1] = 1.0; /* 1, t, t^2/2, ... */
    for (i = 0; i < roots; i++)
        for (k = i + 1; k >= 0; k--)
            product[k] = (k > 0 ? product[k - 1] : 0.0) - root[i] * product[k];
    for (k = 0; k <= roots; factorial *= ++k)
        s->row[2 + k] = (real)(product[k] * factorial);
    s->breaks[0] = 1;
    s->add[0][0][n + 2] = -1.0;
    s->add[0][1][n + 2] = 1.0;
    build(s, 1.0);
    return s;
}

static double slope_at(const double *root, int roots, int i)
{
    double slope = 1.0;
    int j;
    for (j = 0; j < roots; j++)
        slope *= j == i ? 1.0 : fabs(root[i] - root[j]);
    return slope;
}

/* Whether the load rises above noise between the roots */
static int told_apart(const double *root, int roots)
{
    int i;
    for (i = 1; i < roots; i++)
        if (slope_at(root, roots, i) * (root[i] - root[i - 1]) < 1e-12 * COARSER)
            return 0;
    return 1;
}

static void all_roots_of_a_load(void **state)
{
    static const double from[8] = {0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0};
    int trial, i;
    (void)state;
    for (trial = 0; trial < samples(3000); trial++) {
        const int roots = 1 + trial % 5;
        const double apart = pow(10.0, -uniform(1.0, 4.0));
        double root[5], v = 0.0, last = 0.0;
        model *s;
        root[0] = uniform(0.001, 0.5);
        for (i = 1; i < roots; i++)
            root[i] = root[i - 1] + (below(2) ? apart : uniform(0.01, 0.1));
        if (!told_apart(root, roots))
            continue;
        s = polynomial(root, roots);
        start(s, from);
        step(s);
        assert_count(s, (uint64_t)roots, "roots of a load", trial);
        for (i = 0; i < roots; i++) {
            const double sign = (roots - i) % 2 ? -1.0 : 1.0;
            assert_near(s->crossing[i].time, root[i], 4e-15 + 4e-15 / slope_at(root, roots, i), "root", trial);
            assert_int_equal(s->crossing[i].upward, sign < 0.0);
            v += sign * (s->crossing[i].time - last);
            last = s->crossing[i].time;
        }
        assert_near(s->x[1], v + (1.0 - last), 1e-14, "pushed", trial);
        free_model(s);
    }
}

/* e = 1 - 16 (1 + d) t^2 (1 - t)^2: 1 and level at both ends of the step, and below 0 in its middle */
static void hidden_in_the_middle(void **state)
{
    static const double from[8] = {0.0, 0.0, 1.0, 0.0, 0.0, 0.0, 0.0, 0.0}, root = 0.5;
    int power;
    (void)state;
    for (power = 1; power <= LEAST_HIDDEN; power++) {
        const double d = pow(10.0, -power), c = 16.0 * (1.0 + d), off = 0.5 * sqrt(1.0 - 1.0 / sqrt(1.0 + d));
        const real row[8] = {0, 0, 1, 0, (real)(-2.0 * c), (real)(12.0 * c), (real)(-24.0 * c), 0};
        model *s = polynomial(&root, 1);
        memcpy(s->row, row, sizeof row);
        build(s, 1.0);
        start(s, from);
        step(s);
        assert_count(s, 2, "hidden in the middle", d);
        assert_near(s->crossing[0].time, 0.5 - off, 1e-14 / sqrt(d), "down", d);
        assert_near(s->crossing[1].time, 0.5 + off, 1e-14 / sqrt(d), "up", d);
        free_model(s);
    }
}

/* Through a narrow interval, both ways, by x = 2 sin t */
static void narrow_interval(void **state)
{
    static const double from[5] = {0.0, 2.0, 1.0, 1.0, 0.0};
    int i, k;
    (void)state;
    for (i = 0; i < SEVERAL; i++) {
        const double h = several_steps[i];
        model *s = single(1.0, 0.0, 0.0, 1.0, 0.0, 2, 1.0, 1.0 + NARROW);
        int n;
        build(s, h);
        start(s, from);
        for (n = 0; n * h < 4.0; n++) {
            step(s);
            for (k = 1; k < s->c.crossings; k++)
                assert_true(s->crossing[k - 1].time <= s->crossing[k].time);
        }
        assert_count(s, 4, "narrow interval", h);
        assert_near(s->x[0], 2.0 * sin(n * h), 1e-12, "nothing changed", h);
        free_model(s);
    }
}

static model *one_stop(double h)
{
    model *s = single(1.0, 0.0, 0.0, 1.0, 0.0, 1, 1.0, 0.0);
    spring(s, 0, 1, 0, 8.0, 1.0);
    build(s, h);
    return s;
}

/* Two alike masses that meet their stops together */
static model *twins(double h)
{
    model *s = oscillator(2, 2, 1.0);
    int i;
    s->breaks[0] = s->breaks[1] = 1;
    s->at[0] = s->at[1] = 1.0;
    s->row[0] = s->row[s->m.size + 1] = 1.0;
    for (i = 0; i < 2; i++) {
        couple(s, 0, i, i, -1.0);
        spring(s, i, 1, i, 8.0, 1.0);
    }
    build(s, h);
    return s;
}

/* One stop said twice, x > 1 and -x < -1: two regions cannot occur. */
static model *said_twice(double h)
{
    model *s = single(1.0, 0.0, 0.0, 1.0, 0.0, 1, 1.0, 0.0);
    s->m.switches = 2;
    s->breaks[1] = 1;
    s->at[1] = -1.0;
    s->row[s->m.size] = -1.0;
    spring(s, 0, 1, 0, 3.0, 1.0);
    spring(s, 1, 0, 0, -5.0, -1.0);
    build(s, h);
    s->matrix[0] = s->matrix[3] = -1;
    return s;
}

static void together(void **state)
{
    static const double one[5] = {0.0, 2.0, 1.0, 1.0, 0.0}, two[7] = {0.0, 0.0, 2.0, 2.0, 1.0, 1.0, 0.0};
    int i, n;
    (void)state;
    for (i = 0; i < SEVERAL; i++) {
        const double h = several_steps[i];
        model *a = one_stop(h), *b = twins(h), *c = said_twice(h);
        start(a, one);
        start(b, two);
        start(c, one);
        assert_int_equal(c->c.region, 2);
        for (n = 0; n * h < 20.0; n++) {
            step(a);
            step(b);
            step(c);
            assert_near(b->x[0], a->x[0], 1e-12, "first twin", h);
            assert_near(b->x[1], a->x[0], 1e-12, "second twin", h);
            assert_near(c->x[0], a->x[0], 1e-12, "said twice", h);
        }
        assert_count(b, 2 * a->c.total, "twins", h);
        assert_count(c, 2 * a->c.total, "said twice", h);
        free_model(a);
        free_model(b);
        free_model(c);
    }
}

/* ---- starts and jumps ---- */

static void assert_region(model *s, double q, double v, double u, int expected, const char *what)
{
    const double x[5] = {q, v, 1.0, u, 0.0};
    start(s, x);
    if (s->c.region != expected || s->c.matrix != s->matrix[expected])
        fail_msg("%s, from %.17g, %.17g: region %d, matrix %d; expected %d", what, q, v, s->c.region, s->c.matrix,
                 expected);
    assert_count(s, 0, what, q);
}

static void starts_on_a_breakpoint(void **state)
{
    model *s = single(0.0, 0.0, 0.0, 0.0, 0.0, 2, -1.0, 1.0);
    (void)state;
    couple(s, 3, 0, 0, 1.0); /* x'' = u, held, and a soft stop above */
    spring(s, 0, 2, 0, 3.0, 1.0);
    build(s, 0.1);
    assert_region(s, 1.0, 1e-3, 0.0, 2, "moving up");
    assert_region(s, 1.0, -1e-3, 0.0, 1, "moving down");
    assert_region(s, 1.0, 0.0, 1e-3, 2, "pushed up");
    assert_region(s, 1.0, 0.0, -1e-3, 1, "pushed down");
    assert_region(s, 1.0, 0.0, 0.0, 1, "resting");
    assert_region(s, 1.0 + (double)REAL_EPSILON, 0.0, 0.0, 1, "resting, off by rounding");
    assert_region(s, 1.0 + JUST, 0.0, 0.0, 2, "just above");
    assert_region(s, 1.0 - JUST, 1.0, 0.0, 1, "just below");
    assert_region(s, -1.0, 0.0, 0.0, 0, "resting below");
    assert_region(s, -1.0, 1e-9, 0.0, 1, "moving up from below");
    assert_region(s, 0.0, 1e9, 0.0, 1, "in between");
    free_model(s);
}

/* From x where nothing else decides */
static void assert_start(model *s, const double *x, int expected, const char *what)
{
    start(s, x);
    if (s->c.region != expected)
        fail_msg("%s: region %d, expected %d", what, s->c.region, expected);
    free_model(s);
}

static void starts_by_higher_derivatives(void **state)
{
    static const double quarter[5] = {0.0, 0.0, 1.0, 0.0, 1.0}, top[5] = {1.0, 0.0, 1.0, 1.0, 0.0};
    static const double still[5] = {0.0, 0.0, 1.0, 1.0, 0.0}, off[5] = {1e-17, -1.0, 1.0, 1.0, 0.0};
    int i;
    (void)state;
    for (i = 0; i < 2; i++) {
        model *s = single(0.0, 0.0, 0.0, 1.0, 1.0, 1, 0.0, 0.0); /* q - cos t */
        build(s, 0.1);
        assert_start(s, i ? top : quarter, 1, i ? "cos t falls by its second derivative" : "cos t falls");
        s = single(0.0, 0.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
        couple(s, 4, 0, 0, i ? 1.0 : -1.0); /* q'' = +- sin t */
        build(s, 0.1);
        assert_start(s, still, i, "the third derivative");
    }
    {
        model *s = single(0.0, 0.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
        build(s, 0.1);
        assert_start(s, off, 0, "off by what rounding leaves of a moving mass");
    }
}

/* Where the region of all that is counted as below cannot occur; matrix 0 is of no use then. */
static void starts_where_regions_cannot_occur(void **state)
{
    static const double from[5] = {1.0, 0.0, 1.0, 1.0, 0.0};
    model *s = said_twice(0.1);
    int i;
    (void)state;
    for (i = 0; i < 25; i++)
        s->A[i] = -s->A[i];
    assert_start(s, from, 2, "pulled down");
    s = said_twice(0.1);
    for (i = 0; i < 4; i++)
        s->A[i * 25 + 5 + 2] += 1.0; /* a force that holds it where it is */
    start(s, from);
    assert_true(s->matrix[s->c.region] >= 0);
    free_model(s);
}

/* What rests on a breakpoint, or on one that presses without a gap, stays there without a crossing. */
static void resting(void **state)
{
    static const double from[5] = {1.0, 0.0, 1.0, 1.0, 0.0};
    int i;
    (void)state;
    for (i = 0; i < SEVERAL; i++) {
        model *s = single(1.0, 0.1, 1.0, 1.0, 0.0, 1, 1.0, 0.0); /* at equilibrium */
        spring(s, 0, 1, 0, 8.0, 1.0);
        build(s, several_steps[i]);
        start(s, from);
        steps(s, 200);
        assert_near(s->x[0], 1.0, 1e-14, "resting", several_steps[i]);
        assert_count(s, 0, "resting", several_steps[i]);
        free_model(s);
    }
}

/* The breakpoint moves with a held input: it jumps over the mass and back. */
static void input_jumps(void **state)
{
    static const double from[5] = {0.0, 0.1, 1.0, 0.0, 0.0};
    model *s = single(0.0, 0.0, 0.0, 0.0, 1.0, 2, 1.0, 1.5);
    (void)state;
    spring(s, 0, 2, 0, 1.0, 1.5);
    build(s, 0.1);
    start(s, from);
    step(s);
    assert_int_equal(s->c.crossings, 0);
    s->x[3] = -2.0; /* q - u: from 0.01 to 2.01, past both */
    step(s);
    assert_int_equal(s->c.crossings, 2);
    assert_int_equal(s->c.region, 2);
    assert_true(s->crossing[0].time == 0.0 && s->crossing[0].breakpoint == 0 && s->crossing[0].upward == 1);
    assert_true(s->crossing[1].time == 0.0 && s->crossing[1].breakpoint == 1 && s->crossing[1].upward == 1);
    assert_near(s->x[0], 0.01 + 0.1 * sin(0.1) - 0.51 * (1.0 - cos(0.1)), 1e-15, "pushed", 0.1);
    s->x[3] = 0.0;
    step(s);
    assert_int_equal(s->c.crossings, 2);
    assert_int_equal(s->c.region, 0);
    assert_true(s->crossing[1].breakpoint == 0 && s->crossing[1].upward == 0);
    assert_count(s, 4, "input jumps", 0.1);
    free_model(s);
}

/* ---- chatter ---- */

/* x'' = -x' + 1 below 0, -x' - 1 above: ever more crossings a second, without end */
static void chatter(void **state)
{
    static const double from[5] = {0.1, 0.0, 1.0, 1.0, 0.0};
    int i, n;
    (void)state;
    for (i = 0; i < SEVERAL; i++) {
        model *s = single(0.0, 1.0, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
        const int one = 2, v = s->m.size;
        s->add[0][0][v + one] = 1.0;
        s->add[0][1][v + one] = -1.0;
        build(s, several_steps[i]);
        start(s, from);
        for (n = 0; n * several_steps[i] < 40.0; n++) {
            step(s);
            assert_true(s->c.crossings <= EVENTS);
            assert_int_equal(pl_not_finite(s->x, s->m.size), 0);
            assert_true(fabs(s->x[0]) < 5.0);
        }
        assert_int_equal(s->c.status, PL_TOO_MANY_EVENTS);
        start(s, from);
        assert_int_equal(s->c.status, 0);
        free_model(s);
    }
}

/* x'' = 400 x - 0.5 x' + 1 below 0, - 1 above: comes to rest at 0, where it switches for ever.  Either region by itself
 * is unstable: e^20 in a step of 1.  What a step does behind its last crossing does not grow. */
static void held_behind_the_last(void **state)
{
    static const double from[5] = {0.001, 0.0, 1.0, 1.0, 0.0};
    const int one = 2, v = 2 + 3;
    double largest = 0;
    int n;
    model *s = single(-400.0, 0.5, 0.0, 1.0, 0.0, 1, 0.0, 0.0);
    (void)state;
    assert_int_equal(s->m.size, v);
    s->add[0][0][v + one] = 1.0;
    s->add[0][1][v + one] = -1.0;
    build(s, 1.0);
    start(s, from);
    for (n = 0; n < 100; n++) {
        step(s);
        largest = fmax(largest, fabs((double)s->x[0]));
    }
    assert_int_equal(s->c.status, PL_TOO_MANY_EVENTS);
    if (!(largest < 1.0 / 400))
        fail_msg("at most %.3g expected, found %.3g", 1.0 / 400, largest);
    free_model(s);
}

/* x'' = 4 x, twice as steep above 1, until it overflows: that, and nothing of crossings; likewise x'' = 0.5 x' - 100 x,
 * of which ever larger ones cross till the end. */
static void overflow_is_not_chatter(void **state)
{
    static const double from[5] = {0.5, 0.5, 1.0, 1.0, 0.0};
    static const double stiffness[2] = {-4.0, 100.0}, damping[2] = {0.0, -2.0};
    int kind, n, crossed = 0;
    (void)state;
    for (kind = 0; kind < 2; kind++) {
        model *s = single(stiffness[kind], damping[kind], 0.0, 1.0, 0.0, 1, 1.0, 0.0);
        build(s, 0.25);
        start(s, from);
        for (n = 0; n < 100000 && !pl_not_finite(s->x, 2); n++) {
            step(s);
            crossed += s->c.crossings;
            assert_int_equal(s->c.status, 0);
        }
        assert_true(n < 100000 && crossed > 0);
        steps(s, 3);
        assert_int_equal(s->c.status, 0);
        assert_int_equal(pl_not_finite(s->x, 2), PL_NOT_FINITE);
        free_model(s);
    }
}

/* Bounds of 1, and what is not finite: every loop ends. */
static void bounds_hold(void **state)
{
    static const double from[5] = {0.0, 2.0, 1.0, 1.0, 0.0}, almost[5] = {0.0, 1.0 - NEAR, 1.0, 1.0, 0.0};
    static const real bad[] = {(real)INFINITY, (real)NAN, (real)LARGE, (real)LARGEST};
    model *s = one_stop(4.0);
    int i;
    (void)state;
    s->m.max_events = 1;
    start(s, from);
    step(s); /* up and down again: the second is one too many, and passed but not listed */
    assert_int_equal(s->c.region, 0);
    assert_int_equal(s->c.crossings, 1);
    assert_int_equal(s->c.status, PL_TOO_MANY_EVENTS);
    steps(s, 3);
    assert_int_equal(pl_not_finite(s->x, 5), 0);
    s->m.max_events = EVENTS;
    s->m.max_splits = 3;
    start(s, almost);
    steps(s, 3);
    assert_int_equal(s->c.status, PL_TOO_MANY_EVENTS);
    assert_int_equal(pl_not_finite(s->x, 5), 0);
    s->m.max_splits = SPLITS;
    for (i = 0; i < 8; i++) {
        start(s, from);
        s->x[i / 4] = bad[i % 4];
        steps(s, 2);
        start_here(s);
    }
    free_model(s);
}

/* ---- random systems against small steps ---- */

/* A stop on coordinate j against ground, moving in one case of two, or against coordinate l */
static void random_stop(model *s, int i, const double *mass)
{
    const int dof = s->states / 2, n = s->m.size, j = below(dof), l = below(dof), side = below(3);
    const double k = uniform(0.5, 15.0), gap = uniform(0.2, 1.2);
    real *row = s->row + i * n;
    row[j] = 1.0;
    if (l != j)
        row[l] = -1.0;
    if (below(2))
        row[2 * dof + 1] = (real)-uniform(0.1, 0.5);
    s->breaks[i] = side == 2 ? 2 : 1;
    s->at[i * B] = (real)(side == 1 ? gap : -gap); /* packed later */
    s->at[i * B + 1] = (real)gap;
    if (side != 1)
        spring(s, i, 0, j, k / mass[j], -gap);
    if (side != 0)
        spring(s, i, s->breaks[i], j, k / mass[j], gap);
    if (l == j)
        return;
    if (side != 1)
        spring(s, i, 0, l, -k / mass[l], -gap);
    if (side != 0)
        spring(s, i, s->breaks[i], l, -k / mass[l], gap);
}

/* A damper of two rates: a switch on a speed, relative or not; the force is continuous. */
static void random_damper(model *s, int i, const double *mass)
{
    const int dof = s->states / 2, n = s->m.size, j = below(dof), l = below(dof);
    const double c = uniform(0.1, 1.0), b = uniform(-0.5, 0.5);
    s->row[i * n + dof + j] = 1.0;
    s->breaks[i] = 1;
    s->at[i * B] = (real)b;
    if (l != j)
        s->row[i * n + dof + l] = -1.0;
    spring(s, i, 1, j, c / mass[j], b);
    if (l != j)
        spring(s, i, 1, l, -c / mass[l], b);
}

/* Beyond its last breakpoint, a stop damps as well: the force jumps. */
static void damp_stop(model *s, int i)
{
    const int dof = s->states / 2, j = below(dof);
    s->add[i][s->breaks[i]][(dof + j) * s->m.size + dof + j] -= uniform(0.05, 0.5);
}

static model *random_model(double *x)
{
    const int dof = 1 + below(3), switches = 1 + below(3);
    model *s = oscillator(dof, switches, uniform(0.4, 2.0));
    double mass[3];
    real packed[S * B];
    int i, j, count = 0;
    for (i = 0; i < dof; i++)
        mass[i] = uniform(0.5, 2.0);
    for (i = 0; i < dof; i++) {
        const double k = uniform(0.2, 1.5), c = uniform(0.0, 0.1);
        couple(s, 0, i, i, -k / mass[i]);
        couple(s, dof, i, i, -c / mass[i]);
        if (i > 0) {
            couple(s, 0, i, i - 1, k / mass[i]);
            couple(s, dof, i, i - 1, c / mass[i]);
            couple(s, 0, i - 1, i, k / mass[i - 1]);
            couple(s, 0, i - 1, i - 1, -k / mass[i - 1]);
            couple(s, dof, i - 1, i, c / mass[i - 1]);
            couple(s, dof, i - 1, i - 1, -c / mass[i - 1]);
        }
        couple(s, 2 * dof + 1, i, 0, uniform(-1.0, 1.0) / mass[i]);
    }
    for (i = 0; i < switches; i++) {
        const int kind = below(5);
        if (kind == 4)
            random_damper(s, i, mass);
        else
            random_stop(s, i, mass);
        if (kind == 3)
            damp_stop(s, i);
    }
    for (i = 0; i < switches; i++)
        for (j = 0; j < s->breaks[i]; j++)
            packed[count++] = s->at[i * B + j];
    memcpy(s->at, packed, sizeof *packed * (size_t)count);
    for (i = 0; i < 2 * dof; i++)
        x[i] = uniform(-1.0, 1.0);
    x[2 * dof] = x[2 * dof + 1] = 1.0;
    x[2 * dof + 2] = 0.0;
    return s;
}

/* The other road: steps of `h`, e and e' looked at only at their ends */
typedef struct tracer {
    const model *s;
    long double h, Phi[R][N * N], x[N];
    int interval[S], extrema; /* extrema: whether a maximum inside a step is looked for too */
    int crossings;
} tracer;

static int region_of(const tracer *t)
{
    int i, region = 0;
    for (i = t->s->m.switches - 1; i >= 0; i--)
        region = region * (t->s->breaks[i] + 1) + t->interval[i];
    return region;
}

/* e^{A tau} x */
static void flow(const tracer *t, long double tau, const long double *x, long double *y)
{
    const int n = t->s->m.size;
    const real *A = t->s->A + region_of(t) * n * n;
    const int parts = 1 + (int)(tau * 12.0L);
    long double w[N], z[N];
    int i, j, k, p;
    memcpy(y, x, sizeof *y * (size_t)n);
    for (p = 0; p < parts; p++) {
        memcpy(w, y, sizeof w);
        for (k = 1; k <= 22; k++) {
            for (i = 0; i < n; i++)
                for (z[i] = 0.0L, j = 0; j < n; j++)
                    z[i] += A[i * n + j] * w[j];
            for (i = 0; i < n; i++)
                y[i] += w[i] = z[i] * (tau / parts) / k;
        }
    }
}

/* sign (e - b), or its derivative */
static long double beyond(const tracer *t, int i, int sign, double b, int derivative, const long double *x)
{
    const int n = t->s->m.size;
    const real *A = t->s->A + region_of(t) * n * n, *row = t->s->row + i * n;
    long double sum = derivative ? 0.0L : -(long double)b;
    int j, k;
    for (j = 0; j < n; j++)
        if (!derivative)
            sum += row[j] * x[j];
        else
            for (k = 0; k < n; k++)
                sum += (long double)row[j] * A[j * n + k] * x[k];
    return sign * sum;
}

/* Where g, or its derivative, changes sign between 0 and tau */
static long double bisect(const tracer *t, int i, int sign, double b, int derivative, long double tau)
{
    long double lo = 0.0L, hi = tau, y[N];
    const int up = !derivative;
    int k;
    for (k = 0; k < 64; k++) {
        const long double middle = (lo + hi) / 2.0L;
        flow(t, middle, t->x, y);
        if ((beyond(t, i, sign, b, derivative, y) > 0.0L) == up)
            hi = middle;
        else
            lo = middle;
    }
    return (lo + hi) / 2.0L;
}

/* The time of a crossing of this breakpoint in the next tau, or tau; y: x(tau) */
static long double crossing_of(const tracer *t, int i, int sign, double b, long double tau, const long double *y)
{
    long double peak, z[N];
    if (beyond(t, i, sign, b, 0, t->x) > 0.0L && beyond(t, i, sign, b, 1, t->x) <= 0.0L)
        return tau;
    if (beyond(t, i, sign, b, 0, y) > 0.0L)
        return bisect(t, i, sign, b, 0, tau);
    if (!t->extrema || beyond(t, i, sign, b, 1, t->x) <= 0.0L || beyond(t, i, sign, b, 1, y) >= 0.0L)
        return tau;
    peak = bisect(t, i, sign, b, 1, tau);
    flow(t, peak, t->x, z);
    return beyond(t, i, sign, b, 0, z) > 1e-15L ? bisect(t, i, sign, b, 0, peak) : tau;
}

static void trace_step(tracer *t)
{
    const int n = t->s->m.size;
    long double left = t->h, y[N];
    int i, j, sign;
    while (left > 0.0L) {
        long double first = left;
        int which = -1, direction = 0;
        const real *at = t->s->at;
        if (left == t->h) {
            const long double *Phi = t->Phi[region_of(t)];
            for (i = 0; i < n; i++)
                for (y[i] = 0.0L, j = 0; j < n; j++)
                    y[i] += Phi[i * n + j] * t->x[j];
        } else
            flow(t, left, t->x, y);
        for (i = 0; i < t->s->m.switches; at += t->s->breaks[i++])
            for (sign = -1; sign <= 1; sign += 2) {
                const int breakpoint = t->interval[i] - (sign < 0);
                long double when;
                if (breakpoint < 0 || breakpoint == t->s->breaks[i])
                    continue;
                when = crossing_of(t, i, sign, at[breakpoint], left, y);
                if (when < first) {
                    first = when;
                    which = i;
                    direction = sign;
                }
            }
        if (which >= 0) {
            flow(t, first, t->x, y);
            t->crossings++;
        }
        memcpy(t->x, y, sizeof y);
        if (which >= 0)
            t->interval[which] += direction;
        left -= first;
    }
}

/* n steps of h; the region to start in is that of s. */
static void trace(tracer *t, const model *s, const double *x, double h, int extrema, int n)
{
    const int size = s->m.size;
    int i, code = s->c.region;
    memset(t, 0, sizeof *t);
    t->s = s;
    t->h = h;
    t->extrema = extrema;
    for (i = 0; i < size; i++)
        t->x[i] = (real)x[i];
    for (i = 0; i < s->m.switches; i++) {
        t->interval[i] = code % (s->breaks[i] + 1);
        code /= s->breaks[i] + 1;
    }
    for (i = 0; i < s->regions; i++)
        exponential(size, s->A + i * size * size, h, 0, t->Phi[i]);
    while (n-- > 0)
        trace_step(t);
}

static int differs(const model *s, const tracer *t, double tolerance, double *worst)
{
    int i, wrong = 0;
    for (i = 0; i < s->states; i++) {
        const double off = fabs(s->x[i] - (double)t->x[i]);
        wrong |= !(off <= tolerance);
        if (off > *worst)
            *worst = off;
    }
    return wrong;
}

/* CROSSINGS_SYSTEMS: how many, unless told 100, in the short form 10 */
static void random_systems(void **state)
{
    static const double steps_of[] = {0.5, 1.0, 2.0, 4.0};
    const char *told = getenv("CROSSINGS_SYSTEMS");
    const int systems = told ? atoi(told) : (int)samples(100);
    int by_signs[4] = {0, 0, 0, 0}, i, k;
    double worst = 0.0;
    uint64_t crossings = 0;
    (void)state;
    for (i = 0; i < systems; i++) {
        double x[N], ignored = 0.0;
        static tracer fine, coarse;
        model *s = random_model(x);
        for (k = 0; k < 4; k++) {
            const double h = steps_of[k];
            build(s, h);
            start(s, x);
            if (k == 0)
                trace(&fine, s, x, 0.01, 1, 2000);
            fine.s = s;
            start(s, x);
            trace(&coarse, s, x, h, 0, (int)(20.0 / h));
            steps(s, (int)(20.0 / h));
            if (differs(s, &fine, ALIKE, &worst) || s->c.status != 0 || s->c.total != (uint64_t)fine.crossings)
                fail_msg("system %d (%d states, %d switches), h = %g: %d crossings, expected %d; status %d; x %.17g, "
                         "expected %.17g",
                         i, s->states, s->m.switches, h, (int)s->c.total, fine.crossings, s->c.status, s->x[0],
                         (double)fine.x[0]);
            by_signs[k] += coarse.crossings != fine.crossings || differs(s, &coarse, ALIKE, &ignored);
            crossings += s->c.total;
        }
        free_model(s);
    }
    printf(
        "# %d systems, %d crossings, worst end state off by %.2g; "
        "wrong by signs at step ends, h = 0.5, 1, 2, 4: %d %d %d %d\n",
        systems, (int)crossings, worst, by_signs[0], by_signs[1], by_signs[2], by_signs[3]);
}

/* Parts of a step come to where the step does: NAME_at. */
static void parts_of_a_step(void **state)
{
    double x[N];
    int i, j, n;
    (void)state;
    for (i = 0; i < 20; i++) {
        model *s = random_model(x), *parts;
        build(s, 1.0);
        start(s, x);
        parts = new_model(s->states, s->m.size, s->m.switches);
        memcpy(parts->x, s->x, sizeof s->x);
        parts->c = s->c;
        for (n = 0; n < 20; n++) {
            step(s);
            for (j = 0; j < 3; j++)
                pl_switching_advance(&s->m, (real)((j + 1) / 6.0), parts->x, &parts->c, s->crossing, s->work);
            for (j = 0; j < s->states; j++)
                assert_near(parts->x[j], s->x[j], 1e-11, "in parts", i);
        }
        assert_count(s, parts->c.total, "in parts", i);
        free_model(parts);
        free_model(s);
    }
}

ROOM(crossings,
    cmocka_unit_test(bilinear_period),
    cmocka_unit_test(stiff_stop),
    cmocka_unit_test(gear_of_one),
    cmocka_unit_test(gear_of_two),
    cmocka_unit_test(grazing),
    cmocka_unit_test(two_crossings_in_a_step),
    cmocka_unit_test(all_roots_of_a_load),
    cmocka_unit_test(hidden_in_the_middle),
    cmocka_unit_test(narrow_interval),
    cmocka_unit_test(together),
    cmocka_unit_test(starts_on_a_breakpoint),
    cmocka_unit_test(starts_by_higher_derivatives),
    cmocka_unit_test(starts_where_regions_cannot_occur),
    cmocka_unit_test(resting),
    cmocka_unit_test(input_jumps),
    cmocka_unit_test(chatter),
    cmocka_unit_test(held_behind_the_last),
    cmocka_unit_test(overflow_is_not_chatter),
    cmocka_unit_test(bounds_hold),
    cmocka_unit_test(random_systems),
    cmocka_unit_test(parts_of_a_step))
