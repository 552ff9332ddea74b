/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Every number that the generator finds by poles and residues, against the judge, bit for bit: the transfer matrix and the load
 * columns of schemes exact and pl (both words of each), and the closed-form solution.
 *
 *     bitwise [-n RANDOM] [-s SEED] [-v] exponentials.txt MODEL.spec ...
 *
 * Shared with the generator: its parser and the matrices M, C, K and loads that it reads from a spec.  From there on the judge has
 * its own algebra: the augmented matrix A of y' = A y is made here.  Each case runs in a process of its own, so that a crash or an
 * endless loop is one failed case.
 */
#include <stdio.h>                      /* before gmp.h, which then declares gmp_fscanf */

#include "bitwise_specs.h"
#include "evaluator.h"
#include "plgen.h"
#include "random_spec.h"
#include "rationals.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/wait.h>
#include <time.h>
#include <unistd.h>

enum { LONGEST_CASE = 300, MISMATCHES_SHOWN = 10 };     /* seconds; lines */

static const char *const STEPS[] = { "1e-9", "1e-3", "0.01", "1", "1e3" };
enum { STEP_COUNT = sizeof STEPS / sizeof *STEPS };

static bool verbose;

/* ---- one case: what is compared now, and what went wrong so far ---- */

static struct {
    const char *spec, *scheme, *time;   /* text of the spec; time: the step, or t of a solution */
    int compared, failed, beyond;       /* beyond: times at which the judge gave up */
} trial = { .spec = "", .scheme = "exact", .time = "none" };

static void complain(const char *what, const char *message)
{
    if (trial.failed++ < MISMATCHES_SHOWN)
        printf("# scheme %s, time %s, %s: %s\n", trial.scheme, trial.time, what, message);
}

static void compare(const char *what, double found, double expected)
{
    trial.compared++;
    if (memcmp(&found, &expected, sizeof found) != 0)
        complain(what, format("found %a = %.17g, expected %a = %.17g", found, found, expected, expected));
}

static void show_spec(void)
{
    for (const char *line = trial.spec; *line;) {
        const size_t length = strcspn(line, "\n");
        printf("# | %.*s\n", (int)length, line);
        line += length + (line[length] == '\n');
    }
}

/* ---- the augmented matrix ---- */

/* y = states, [held states,] loads; y' = A y, and e^{A h} X has the factors of one step in its first rows */
struct augmented {
    size_t states, size, columns;       /* of A and of X */
    mpq_t *A, *X;
};

static void add_product(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b, bool subtract)
{
    mpq_t product;
    mpq_init(product);
    mpq_mul(product, a, b);
    (subtract ? mpq_sub : mpq_add)(sum, sum, product);
    mpq_clear(product);
}

/* rows x width, its left square part made the identity */
static void eliminate(size_t rows, size_t width, mpq_t *W)
{
    mpq_t factor;
    mpq_init(factor);
    for (size_t k = 0; k < rows; k++) {
        size_t pivot = k;
        while (mpq_sgn(W[pivot * width + k]) == 0)
            pivot++;
        for (size_t j = 0; j < width; j++)
            mpq_swap(W[pivot * width + j], W[k * width + j]);
        for (size_t j = width; j-- > k;)
            mpq_div(W[k * width + j], W[k * width + j], W[k * width + k]);
        for (size_t i = 0; i < rows; i++) {
            mpq_set(factor, W[i * width + k]);
            for (size_t j = k; i != k && j < width; j++)
                add_product(W[i * width + j], factor, W[k * width + j], true);
        }
    }
    mpq_clear(factor);
}

/* M^-1 [K, C, force of every column], n rows */
static mpq_t *accelerations(const struct linear *system, size_t columns)
{
    const size_t n = (size_t)system->n, width = 3 * n + columns;
    mpq_t *W = rationals(n * width), *R = rationals(n * (width - n));
    for (size_t i = 0; i < n; i++) {
        for (size_t j = 0; j < n; j++) {
            mpq_set(W[i * width + j], system->M[i * n + j]);
            mpq_set(W[i * width + n + j], system->K[i * n + j]);
            mpq_set(W[i * width + 2 * n + j], system->C[i * n + j]);
        }
        size_t at = 3 * n;
        for (int l = 0; l < system->loads; l++)
            for (int k = 0; k < system->load[l].columns; k++)
                mpq_set(W[i * width + at++], system->load[l].force[k][i]);
    }
    eliminate(n, width, W);
    for (size_t i = 0; i < n; i++)
        for (size_t j = n; j < width; j++)
            mpq_set(R[i * (width - n) + j - n], W[i * width + j]);
    return R;
}

/* z = t^k e^{at} cos(wt+p) and sin, or t^k e^{at} alone: z' = a z + k (z of k - 1) -+ w (its partner) */
static void fill_load_states(const struct load *load, size_t size, mpq_t *A)
{
    const bool turns = mpq_sgn(load->wave->w) != 0;
    const size_t trig = turns ? 2 : 1;
    for (size_t c = 0; c < (size_t)load->columns; c++) {
        mpq_set(A[c * size + c], load->wave->a);
        if (c >= trig)
            mpq_set_ui(A[c * size + c - trig], c / trig, 1);
        if (turns && c % 2 == 0)
            mpq_neg(A[c * size + c + 1], load->wave->w);
        if (turns && c % 2 == 1)
            mpq_set(A[c * size + c - 1], load->wave->w);
    }
}

/* Scheme pl: after division by the masses, the terms of other coordinates act through a constant copy of the state. */
static struct augmented augment(const struct linear *system, bool pl)
{
    const size_t n = (size_t)system->n, loads = (size_t)load_columns(system), copies = pl ? 2 * n : 0;
    struct augmented a = { .states = 2 * n, .size = 2 * n + copies + loads, .columns = 2 * n + loads };
    const size_t size = a.size, first_load = 2 * n + copies;
    mpq_t *R = accelerations(system, loads);
    a.A = rationals(size * size);
    a.X = rationals(size * a.columns);
    for (size_t i = 0; i < n; i++) {
        mpq_set_ui(a.A[i * size + n + i], 1, 1);
        for (size_t j = 0; j < 2 * n; j++) {
            const bool held = pl && j % n != i;
            mpq_neg(a.A[(n + i) * size + (held ? 2 * n : 0) + j], R[i * a.columns + j]);
        }
        for (size_t j = 0; j < loads; j++)
            mpq_set(a.A[(n + i) * size + first_load + j], R[i * a.columns + 2 * n + j]);
    }
    for (size_t at = first_load, l = 0; l < (size_t)system->loads; at += (size_t)system->load[l++].columns)
        fill_load_states(&system->load[l], size, a.A + at * size + at);
    for (size_t j = 0; j < a.columns; j++) {
        mpq_set_ui(a.X[(j < 2 * n ? j : j + copies) * a.columns + j], 1, 1);
        if (j < copies)
            mpq_set_ui(a.X[(2 * n + j) * a.columns + j], 1, 1);
    }
    return a;
}

/* ---- zero at every tau: (A^k X)_ij = 0 for k < size (Cayley and Hamilton), modulo a prime of 61 bits ---- */

static const uint64_t PRIME = (UINT64_C(1) << 61) - 1;

static uint64_t times(uint64_t a, uint64_t b)
{
    return (uint64_t)((unsigned __int128)a * b % PRIME);
}

static uint64_t residue(mpq_srcptr q)
{
    uint64_t inverse = 1, power = mpz_fdiv_ui(mpq_denref(q), PRIME);
    for (uint64_t e = PRIME - 2; e; e >>= 1, power = times(power, power))
        if (e & 1)
            inverse = times(inverse, power);
    return times(mpz_fdiv_ui(mpq_numref(q), PRIME), inverse);
}

static bool *always_zero(const struct augmented *a)
{
    const size_t n = a->size, m = a->columns;
    uint64_t *A = ARRAY(uint64_t, n * n), *v = ARRAY(uint64_t, n * m), *next = ARRAY(uint64_t, n * m);
    bool *zero = ARRAY(bool, n * m);
    for (size_t i = 0; i < n * n; i++)
        A[i] = residue(a->A[i]);
    for (size_t i = 0; i < n * m; i++) {
        v[i] = residue(a->X[i]);
        zero[i] = true;
    }
    for (size_t k = 0; k < n; k++) {
        for (size_t i = 0; i < n * m; i++) {
            zero[i] = zero[i] && v[i] == 0;
            next[i] = 0;
            for (size_t l = 0; l < n; l++)
                next[i] = (next[i] + times(A[i / m * n + l], v[l * m + i % m])) % PRIME;
        }
        uint64_t *swap = v;
        v = next;
        next = swap;
    }
    return zero;
}

/* ---- second words ---- */

enum { LEVELS = 6 };                    /* 512, 1024, ... 16384 bits */

struct enclosures {
    const struct augmented *a;
    mpq_srcptr h;
    evaluator_enclosure *level[LEVELS];
    bool given_up[LEVELS];
};

static const evaluator_enclosure *enclosure(struct enclosures *e, int level)
{
    if (!e->level[level]) {
        e->level[level] = NEW(evaluator_enclosure);
        evaluator_enclosure_init(e->level[level], e->a->size);
        e->given_up[level] = evaluator_enclose((const mpq_t *)e->a->A, e->h, 512ul << level, e->level[level]) != 0;
    }
    return e->given_up[level] ? NULL : e->level[level];
}

static double nearest(mpz_srcptr z, long exponent, double subtract, mpfr_rnd_t outwards)
{
    mpfr_t x;
    mpfr_init2(x, (mpfr_prec_t)mpz_sizeinbase(z, 2) + 64);
    mpfr_set_z_2exp(x, z, exponent, MPFR_RNDN);         /* exact */
    mpfr_sub_d(x, x, subtract, outwards);
    const double d = mpfr_get_d(x, MPFR_RNDN);
    mpfr_clear(x);
    return d == 0 ? 0 : d;
}

/* (e^{A h} X)_ij - subtract, rounded: true if this enclosure decides it.  X holds nothing but 0 and 1. */
static bool rounded_difference(const struct augmented *a, const evaluator_enclosure *E, size_t i, size_t j, double subtract, double *d)
{
    mpz_t sum, radius, end;
    mpz_inits(sum, radius, end, NULL);
    for (size_t l = 0; l < a->size; l++)
        if (mpq_sgn(a->X[l * a->columns + j]) != 0) {
            mpz_add(sum, sum, E->mid[i * a->size + l]);
            mpz_add(radius, radius, E->radius);
        }
    mpz_sub(end, sum, radius);
    *d = nearest(end, E->exponent, subtract, MPFR_RNDD);
    mpz_add(end, sum, radius);
    const bool decided = *d == nearest(end, E->exponent, subtract, MPFR_RNDU);
    mpz_clears(sum, radius, end, NULL);
    return decided;
}

static void compare_low(const char *what, struct enclosures *e, size_t i, size_t j, const struct coefficient *found)
{
    double low;
    for (int level = 0; level < LEVELS; level++) {
        const evaluator_enclosure *E = enclosure(e, level);
        if (E && rounded_difference(e->a, E, i, j, found->value, &low)) {
            compare(format("second word of %s", what), found->low, low);
            return;
        }
    }
    complain(what, "the judge cannot decide the second word");
}

/* ---- one step ---- */

static const char *entry_name(const struct model *model, size_t i, size_t j)
{
    if (j < (size_t)model->system.states)
        return format("factor of %s in %s", model->state_name[j], model->state_name[i]);
    return format("factor of load column %zu in %s", j - (size_t)model->system.states, model->state_name[i]);
}

/* A flag says 0 at this tau: either 0 at every tau, or the judge finds nothing there with 4096 bits. */
static void compare_flag(const char *what, struct enclosures *e, size_t i, size_t j, const struct coefficient *found, bool always)
{
    double value;
    if (always && !found->zero)
        complain(what, "zero at every step, and not marked so");
    if (always || !found->zero)
        return;
    const evaluator_enclosure *E = enclosure(e, 3);
    if (E && rounded_difference(e->a, E, i, j, 0, &value) && value != 0)
        complain(what, "marked as zero, but it is not");
}

static void compare_step(const struct model *model, const struct augmented *a, const struct table *table, const double *expected,
                         const bool *always)
{
    struct enclosures e = { .a = a, .h = model->h };
    if ((size_t)table->states != a->states || (size_t)(table->states + table->columns) != a->columns) {
        complain("table", "wrong size");
        return;
    }
    for (size_t i = 0; i < a->states; i++)
        for (size_t j = 0; j < a->columns; j++) {
            const char *what = entry_name(model, i, j);
            const struct coefficient *c = j < a->states ? &table->Phi[i * a->states + j]
                                                        : &table->load[i * (a->columns - a->states) + j - a->states];
            compare(what, c->value, expected[i * a->columns + j]);
            compare_low(what, &e, i, j, c);
            compare_flag(what, &e, i, j, c, always[i * a->columns + j]);
        }
    for (int level = 0; level < LEVELS; level++)
        if (e.level[level])
            evaluator_enclosure_clear(e.level[level]);
}

static const char *diagnostics(void)
{
    char *text = NULL;
    size_t length;
    FILE *to = open_memstream(&text, &length);
    diagnostics_print(to);
    fclose(to);
    const char *copy = format("%s", text);
    free(text);
    return copy;
}

static const char *first_line(const char *text)
{
    return format("%.*s", (int)strcspn(text, "\n"), text);
}

/* A refused step is right if a factor is out of range, and if that is what was said. */
static void compare_refusal(const struct augmented *a, const double *expected)
{
    const char *said = diagnostics();
    bool overflow = false;
    for (size_t i = 0; i < a->states * a->columns; i++)
        overflow = overflow || isinf(expected[i]);
    trial.compared++;
    if (!overflow || !strstr(said, "is beyond the range of double"))
        complain("step refused", first_line(said));
}

static void compare_scheme(struct model *model, const struct augmented *a, const bool *always)
{
    double *expected = ARRAY(double, a->size * a->columns);
    const int undecided = evaluator_round(a->size, (const mpq_t *)a->A, model->h, a->columns, (const mpq_t *)a->X, 0, expected);
    const struct step *step = step_build(model);
    if (!step)
        compare_refusal(a, expected);
    else if (undecided)
        complain(format("entry %d of %zu x %zu", -1 - undecided, a->size, a->columns), "the judge cannot decide");
    else
        compare_step(model, a, step->table, expected, always);
}

/* ---- the closed-form solution ---- */

/* x = states, loads, 1, t, outputs: an output o = c x, c constant, has o' = c A x */
struct solution {
    size_t size, outputs;               /* the outputs come last */
    mpq_t *A, *start;
};

/* cos p or sin p as the generator takes it: to 256 bits, from a number of so many that it need not be looked at twice */
static void set_phase(mpq_ptr value, const struct wave *wave, int (*function)(mpfr_t, const mpfr_t, mpfr_rnd_t))
{
    mpfr_t wide, rounded;
    mpfr_init2(wide, 4096);
    mpfr_init2(rounded, IRRATIONAL_BITS);
    mpfr_set_q(wide, wave->p, MPFR_RNDN);
    function(wide, wide, MPFR_RNDN);
    mpfr_set(rounded, wide, MPFR_RNDN);
    mpfr_get_q(value, rounded);
    mpfr_clears(wide, rounded, (mpfr_ptr)NULL);
}

static struct solution solution_of(const struct model *model, const struct augmented *a)
{
    const struct linear *system = &model->system;
    const size_t first = a->size, outputs = (size_t)model->outputs, size = first + outputs;
    struct solution s = { size, outputs, rationals(size * size), rationals(size) };
    mpq_t *factors = rationals(first);
    for (size_t i = 0; i < a->size; i++)
        for (size_t j = 0; j < a->size; j++)
            mpq_set(s.A[i * size + j], a->A[i * a->size + j]);
    for (size_t i = 0; i < a->states; i++)
        mpq_set(s.start[i], model->initial[i]);
    for (size_t at = a->states, l = 0; l < (size_t)system->loads; at += (size_t)system->load[l++].columns) {
        mpq_set_ui(s.start[at], 1, 1);
        if (mpq_sgn(system->load[l].wave->w) != 0) {
            set_phase(s.start[at], system->load[l].wave, mpfr_cos);
            set_phase(s.start[at + 1], system->load[l].wave, mpfr_sin);
        }
    }
    for (size_t o = 0; o < outputs; o++) {
        const struct output *output = &model->output[o];
        for (size_t i = 0; i < a->states; i++)
            mpq_set(factors[i], output->state[i]);
        for (size_t at = a->states, l = 0; l < (size_t)system->loads; l++)
            for (int k = 0; k < system->load[l].columns; k++, at++)
                mpq_set(factors[at], output->load[l][k]);
        for (size_t i = 0; i < first; i++) {
            add_product(s.start[first + o], factors[i], s.start[i], false);
            for (size_t j = 0; j < first; j++)
                add_product(s.A[(first + o) * size + j], factors[i], s.A[i * size + j], false);
        }
    }
    return s;
}

struct solution_work {
    const struct model *model;
    const struct solution *solution;
    double *expected;
};

/* False: the judge cannot decide.  That is no failure where another value is out of range: e^{1e5} beside 1 is beyond its 16384 bits. */
static bool expected_outputs(const struct solution *s, mpq_srcptr t, double *expected)
{
    const int undecided = evaluator_apply(s->size, (const mpq_t *)s->A, t, (const mpq_t *)s->start, expected);
    bool overflow = false;
    for (size_t i = 0; i < s->size; i++)
        overflow = overflow || isinf(expected[i]);
    if (undecided && !overflow)
        complain("solution", "the judge cannot decide");
    trial.beyond += undecided && overflow;
    return !undecided;
}

static void compare_solution_values(void *context)
{
    static const unsigned long multiples[] = { 0, 1, 17, 3000 };
    struct solution_work *work = context;
    const struct model *model = work->model;
    const size_t first = work->solution->size - work->solution->outputs;
    struct resolvent *resolvent = resolvent_of(&model->system);
    mpq_t t;
    mpq_init(t);
    for (int k = 0; k < 4; k++) {
        mpq_set_ui(t, multiples[k], 1);
        mpq_mul(t, t, model->h);
        trial.time = format("%lu h", multiples[k]);
        if (!expected_outputs(work->solution, t, work->expected))
            continue;
        for (int o = 0; o < model->outputs; o++) {
            struct started *list;
            const int count = responses_of_output(resolvent, &model->system, (const mpq_t *)model->initial, &model->output[o], &list);
            const struct coefficient c = started_value(count, list, t, model->step_at, model->output[o].name);
            compare(model->output[o].name, c.value, work->expected[first + (size_t)o]);
        }
    }
    mpq_clear(t);
}

enum { TEXT_ROWS = 4 };

/* The text of --solution at 0, h, 2 h, 3 h */
static void compare_solution_text(void *context)
{
    struct solution_work *work = context;
    const struct model *model = work->model;
    const size_t first = work->solution->size - work->solution->outputs;
    char *text = NULL, *at;
    size_t length;
    mpq_t t;
    mpq_init(t);
    mpq_set_ui(t, TEXT_ROWS - 1, 1);
    mpq_mul(t, t, model->h);
    FILE *to = open_memstream(&text, &length);
    print_solution(to, model, resolvent_of(&model->system), t);
    fclose(to);
    at = text + strcspn(text, "\n");
    for (unsigned long k = 0; k < TEXT_ROWS; k++) {
        mpq_set_ui(t, k, 1);
        mpq_mul(t, t, model->h);
        trial.time = format("row %lu of the text", k);
        if (!expected_outputs(work->solution, t, work->expected))
            return;
        strtod(at, &at);
        for (int o = 0; o < model->outputs; o++) {
            if (*at != ',')
                complain(model->output[o].name, "not in the text");
            else
                compare(model->output[o].name, strtod(at + 1, &at), work->expected[first + (size_t)o]);
        }
    }
    if (strcmp(at, "\n") != 0)
        complain("text", "more than the rows asked for");
    free(text);
    mpq_clear(t);
}

/* Refused as a whole is right if a value in it is out of range, and if that is what was said. */
static void compare_solution_refusal(const struct solution_work *work)
{
    const char *said = diagnostics();
    bool overflow = false;
    mpq_t t;
    mpq_init(t);
    for (unsigned long k = 0; k < TEXT_ROWS && !overflow; k++) {
        mpq_set_ui(t, k, 1);
        mpq_mul(t, t, work->model->h);
        if (!expected_outputs(work->solution, t, work->expected))
            return;
        for (size_t o = 0; o < work->solution->outputs; o++)
            overflow = overflow || isinf(work->expected[work->solution->size - 1 - o]);
    }
    trial.compared++;
    if (!overflow || !strstr(said, "leaves the range of double"))
        complain("solution refused", first_line(said));
    mpq_clear(t);
}

static void compare_solution(const struct model *model, const struct augmented *a, mpq_srcptr written_step)
{
    const struct solution s = solution_of(model, a);
    struct solution_work work = { model, &s, ARRAY(double, s.size) };
    trial.scheme = "exact (solution)";
    mpq_set(((struct model *)model)->h, written_step);
    if (!statement_guard(compare_solution_values, &work))
        complain("solution", first_line(diagnostics()));
    else if (!statement_guard(compare_solution_text, &work))
        compare_solution_refusal(&work);
}

/* ---- one spec ---- */

static struct model *model_of(const char *text)
{
    static const struct overrides none;
    struct source *source = NEW(struct source);
    *source = (struct source){ .name = "spec", .base = "spec", .text = text, .length = strlen(text) };
    struct model *model = model_build(parse_spec(source), &none);
    if (!model)
        complain("spec", format("not accepted: %s", first_line(diagnostics())));
    return model;
}

static void try_spec(const char *text)
{
    static const char *const schemes[] = { "exact", "pl" };
    mpq_t written;
    trial.spec = text;
    struct model *model = model_of(text);
    if (!model)
        return;
    mpq_init(written);
    mpq_set(written, model->h);
    for (int pl = 0; pl < 2; pl++) {
        if (pl && model->n == 1)
            continue;                   /* nothing to hold: the same as exact */
        const struct augmented a = augment(&model->system, pl);
        const bool *always = always_zero(&a);
        trial.scheme = schemes[pl];
        model->scheme = pl ? SCHEME_PL : SCHEME_EXACT;
        for (int k = -1; k < STEP_COUNT; k++) {
            trial.time = k < 0 ? "as written" : STEPS[k];
            if (k >= 0)
                rational_parse(model->h, STEPS[k]);
            else
                mpq_set(model->h, written);
            compare_scheme(model, &a, always);
        }
        if (!pl)
            compare_solution(model, &a, written);
    }
    mpq_clear(written);
}

/* ---- matrices that are no vibration: (s I - A)^-1 entry by entry ---- */

struct matrix_case {
    char name[100];
    size_t n;
    mpq_t tau, *A;
    double *expected;
};

/* Rows times the least common denominator: what is in Z[s]. */
static struct polymat pencil(const struct matrix_case *c, mpz_t *row)
{
    const size_t n = c->n;
    struct polymat P = { (int)n, ARRAY(struct poly, n * n) };
    for (size_t i = 0; i < n; i++) {
        mpz_init_set_ui(row[i], 1);
        for (size_t j = 0; j < n; j++)
            mpz_lcm(row[i], row[i], mpq_denref(c->A[i * n + j]));
        for (size_t j = 0; j < n; j++) {
            struct poly *cell = &P.cell[i * n + j];
            *cell = poly_new(2);
            mpz_divexact(cell->c[0], row[i], mpq_denref(c->A[i * n + j]));
            mpz_mul(cell->c[0], cell->c[0], mpq_numref(c->A[i * n + j]));
            mpz_neg(cell->c[0], cell->c[0]);
            if (i == j)
                mpz_set(cell->c[1], row[i]);
            poly_trim(cell);
        }
    }
    return P;
}

static void compare_matrix(void *context)
{
    const struct matrix_case *c = context;
    const size_t n = c->n;
    mpz_t *row = ARRAY(mpz_t, n);
    struct polymat adj = { (int)n, ARRAY(struct poly, n * n) };
    struct poly det;
    struct augmented a = { n, n, n, c->A, rationals(n * n) };
    struct enclosures e = { .a = &a, .h = c->tau };
    mpq_t scale;
    mpq_init(scale);
    for (size_t i = 0; i < n; i++)
        mpq_set_ui(a.X[i * n + i], 1, 1);
    polymat_adjugate(pencil(c, row), &det, &adj);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            const char *what = format("entry %zu, %zu", i, j);
            mpq_set_z(scale, row[j]);
            struct response *response = response_of(scale, adj.cell[i * n + j], det);
            const struct coefficient found = response_value(response, c->tau, true, (struct place){ 0 }, what);
            compare(what, found.value, c->expected[i * n + j]);
            compare_low(what, &e, i, j, &found);
        }
}

static struct matrix_case *read_matrices(const char *path, size_t *count)
{
    struct matrix_case *all = NULL, c;
    FILE *f = fopen(path, "r");
    *count = 0;
    if (!f) {
        printf("Bail out! cannot read %s\n", path);
        exit(1);
    }
    for (int ch; (ch = getc(f)) == '#';)
        while (ch != '\n' && ch != EOF)
            ch = getc(f);
    while (fscanf(f, " %99[^\n]", c.name) == 1) {
        mpq_init(c.tau);
        int good = gmp_fscanf(f, "%zu %Qd", &c.n, c.tau) == 2;
        c.A = rationals(c.n * c.n);
        c.expected = ARRAY(double, c.n * c.n);
        for (size_t i = 0; i < c.n * c.n && good; i++)
            good = gmp_fscanf(f, "%Qd", c.A[i]) == 1;
        for (size_t i = 0; i < c.n * c.n && good; i++)
            good = fscanf(f, "%la", &c.expected[i]) == 1;
        if (!good) {
            printf("Bail out! %s: cannot read matrix %s\n", path, c.name);
            exit(1);
        }
        ENLARGE(all, *count + 1);
        all[(*count)++] = c;
    }
    fclose(f);
    return all;
}

static void try_matrix(struct matrix_case *c)
{
    trial.spec = "";
    trial.scheme = "matrix";
    trial.time = "as given";
    if (!statement_guard(compare_matrix, c))
        complain(c->name, first_line(diagnostics()));
}

/* ---- zero at one step only ---- */

/* Critically damped at w h = 1: Phi_22 = (1 - w h) e^{-w h} is 0 at this step and at no other. */
static void try_critical(const char *text)
{
    trial.spec = text;
    trial.scheme = "exact";
    trial.time = "as written, w h = 1";
    struct model *model = model_of(text);
    const struct step *step = model ? step_build(model) : NULL;
    if (!step || !step->table->Phi[3].zero || step->table->Phi[3].value != 0)
        complain("Phi_22", "not found to be zero");
    if (!step)
        return;
    rational_parse(model->h, "0.0100000000000000000000000000001");
    step = step_build(model);
    if (!step || step->table->Phi[3].zero || !(step->table->Phi[3].value < -3e-30))
        complain("Phi_22", "1e-31 beside its zero: found to be zero");
}

/* ---- the whole ---- */

static char *read_text(const char *path)
{
    size_t length = 0, got;
    FILE *f = fopen(path, "r");
    if (!f) {
        printf("Bail out! cannot read %s\n", path);
        exit(1);
    }
    char *text = ARRAY(char, 4096);
    while ((got = fread(text + length, 1, 4095, f)) > 0) {
        length += got;
        ENLARGE(text, length + 4096);
    }
    text[length] = 0;
    fclose(f);
    return text;
}

static int number, failures;            /* of cases */

static void report(bool good, const char *name)
{
    failures += !good;
    printf("%sok %d - %s\n", good ? "" : "not ", ++number, name);
    fflush(stdout);
}

static void run(const char *name, void (*work)(void *), void *context)
{
    int status;
    fflush(stdout);
    const pid_t child = fork();
    if (child == 0) {
        alarm(LONGEST_CASE);
        work(context);
        if (trial.failed)
            show_spec();
        if (trial.failed > MISMATCHES_SHOWN)
            printf("# %d failures in all\n", trial.failed);
        if (trial.compared == 0)
            printf("# nothing was compared\n");
        if (trial.beyond)
            printf("# times beyond the judge: %d\n", trial.beyond);
        if (verbose)
            printf("# %d numbers compared in %.2f s\n", trial.compared, (double)clock() / CLOCKS_PER_SEC);
        fflush(stdout);
        _exit(trial.failed || trial.compared == 0);
    }
    if (child < 0 || waitpid(child, &status, 0) != child) {
        puts("Bail out! cannot start a process");
        exit(1);
    }
    if (WIFSIGNALED(status))
        printf("# ended by signal %d%s\n", WTERMSIG(status), WTERMSIG(status) == SIGALRM ? ": took too long" : "");
    report(WIFEXITED(status) && WEXITSTATUS(status) == 0, name);
}

static void run_spec(void *text)
{
    try_spec(text);
}

static void run_critical(void *text)
{
    try_critical(text);
    try_spec(text);
}

static void run_matrix(void *c)
{
    try_matrix(c);
}

static void run_random(void *seed)
{
    try_spec(random_spec(*(uint64_t *)seed));
}

int main(int argc, char **argv)
{
    unsigned long random_count = 200, seed = 1;
    for (int option; (option = getopt(argc, argv, "n:s:v")) != -1;) {
        if (option == 'n')
            random_count = strtoul(optarg, NULL, 10);
        else if (option == 's')
            seed = strtoul(optarg, NULL, 10);
        else if (option == 'v')
            verbose = true;
        else
            return 2;
    }
    if (optind == argc) {
        fputs("usage: bitwise [-n RANDOM] [-s SEED] [-v] exponentials.txt MODEL.spec ...\n", stderr);
        return 2;
    }
    memory_open();
    size_t matrices;
    struct matrix_case *matrix = read_matrices(argv[optind++], &matrices);
    printf("1..%zu\n", matrices + (size_t)(argc - optind) + bitwise_spec_count + random_count);
    for (size_t i = 0; i < matrices; i++)
        run(format("matrix %s, tau = %s", matrix[i].name, exact_text(matrix[i].tau)), run_matrix, &matrix[i]);
    for (int i = optind; i < argc; i++) {
        const char *slash = strrchr(argv[i], '/');
        run(slash ? slash + 1 : argv[i], run_spec, read_text(argv[i]));
    }
    for (size_t i = 0; i < bitwise_spec_count; i++)
        run(bitwise_specs[i].name, bitwise_specs[i].critical ? run_critical : run_spec, (void *)bitwise_specs[i].text);
    for (unsigned long i = 0; i < random_count; i++) {
        uint64_t one = seed + i;
        run(format("random model %lu", seed + i), run_random, &one);
    }
    memory_close();
    return failures > 0;
}
