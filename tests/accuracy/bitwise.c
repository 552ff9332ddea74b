/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Every number that the generator finds, by poles and residues or by Taylor series, against the judge, bit for bit: the
 * transfer matrix, the load columns of every segment of time and the input columns of schemes exact and pl (both words
 * of each), the closed-form solution, and the models that --reduce makes.
 *
 *     bitwise [-n RANDOM] [-r REDUCED] [-e EVERY] [-s SEED] [-q] [-v] exponentials.txt MODEL.spec ...
 *
 * Shared with the generator: its parser and the matrices M, C, K and loads that it reads from a spec.  From there on
 * the judge has its own algebra: the augmented matrix A of y' = A y is made here.  Each case runs in a process of its
 * own, so that a crash or an endless loop is one failed case.
 */
#include <stdio.h>                      /* before gmp.h, which then declares gmp_fscanf */

#include "bitwise_specs.h"
#include "algebra.h"
#include "cases.h"
#include "random_spec.h"
#include "rationals.h"
#include "model/linear/modal_truncation.h"
#include "report/report.h"
#include "step/linear/images.h"
#include "step/linear/inner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

enum { LONGEST_CASE = 300, MISMATCHES_SHOWN = 10 };     /* seconds; lines */

static const char *const STEPS[] = { "1e-12", "1e-9", "1e-3", "0.01", "1", "1e3" };
enum { STEP_COUNT = sizeof STEPS / sizeof *STEPS };

/* With -q a model of so many states at three steps only: its own, the shortest and one in the middle */
enum { LARGE_STATES = 4, SHORTEST = 0, MIDDLE = 3 };

static bool verbose, quick;

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

/* ---- the augmented matrix ---- */

/* y = states, [held states,] loads, inputs (with their slopes); y' = A y in one segment of time, and e^{A h} X has the
 * factors of one step in its first rows: of the states, of the load columns, of the input columns */
struct augmented {
    size_t states, loads, inputs;       /* columns of X of each kind */
    size_t first_load, size, columns;   /* of A and of X */
    mpq_t *A, *X;
};

/* The highest derivative of each coordinate as a row: over the states (without sign), the load columns of one segment,
 * u and u' of every input.  Columns of M multiply accelerations; of a coordinate of first order the column of C
 * multiplies what is solved for. */
static mpq_t *highest_rows(const struct linear *system, int segment, size_t *width)
{
    const size_t n = (size_t)system->n, states = (size_t)system->states;
    const size_t all = states + (size_t)load_columns(system) + 2 * (size_t)system->inputs;
    mpq_t *W = rationals(n * (n + all)), *R = rationals(n * all);
    for (size_t i = 0; i < n; i++) {
        mpq_t *row = W + i * (n + all), *right = row + n;
        for (size_t j = 0; j < n; j++) {
            const int velocity = system->velocity[j];
            mpq_set(row[j], velocity < 0 ? system->C[i * n + j] : system->M[i * n + j]);
            mpq_set(right[j], system->K[i * n + j]);
            if (velocity >= 0)
                mpq_set(right[velocity], system->C[i * n + j]);
        }
        right += states;
        for (int l = 0; l < system->loads; l++)
            for (int k = 0; k < system->load[l].columns; k++)
                mpq_set(*right++, system->load[l].force[k][(size_t)segment * n + i]);
        for (int u = 0; u < system->inputs; u++)
            for (int k = 0; k < 2; k++)
                mpq_set(*right++, system->input[u].force[k][i]);
    }
    if (!eliminate(n, n + all, W))
        complain("masses", "the matrix of highest derivatives is singular");
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < all; j++)
            mpq_set(R[i * all + j], W[i * (n + all) + n + j]);
    *width = all;
    return R;
}

static size_t input_states(const struct linear *system)
{
    size_t count = 0;
    for (int u = 0; u < system->inputs; u++)
        count += system->input[u].hold ? 2 : 1;
    return count;
}

/* A held input is u' = 0; a ramp from u0 to u1 is u0 (u - slope/h) + u1 slope/h. */
static void fill_inputs(const struct linear *system, mpq_srcptr h, const struct augmented *a)
{
    size_t at = a->size - a->inputs, column = a->columns - a->inputs;
    for (int u = 0; u < system->inputs; u++) {
        mpq_set_ui(a->X[at * a->columns + column], 1, 1);
        if (system->input[u].hold) {
            mpq_set_ui(a->A[at * a->size + at + 1], 1, 1);
            mpq_inv(a->X[(at + 1) * a->columns + column + 1], h);
            mpq_neg(a->X[(at + 1) * a->columns + column], a->X[(at + 1) * a->columns + column + 1]);
        }
        at += system->input[u].hold ? 2 : 1;
        column += system->input[u].hold ? 2 : 1;
    }
}

static void fill_dynamics(const struct linear *system, int segment, bool pl, const struct augmented *a)
{
    const size_t n = (size_t)system->n, states = a->states;
    size_t width;
    mpq_t *R = highest_rows(system, segment, &width);
    for (size_t i = 0; i < n; i++) {
        const bool second = system->velocity[i] >= 0;
        mpq_t *row = a->A + (second ? (size_t)system->velocity[i] : i) * a->size;
        const mpq_t *right = (const mpq_t *)R + i * width;
        if (second)
            mpq_set_ui(a->A[i * a->size + (size_t)system->velocity[i]], 1, 1);
        for (size_t j = 0; j < states; j++)
            mpq_neg(row[(pl && (size_t)system->coord[j] != i ? states : 0) + j], right[j]);
        for (size_t j = 0; j < a->loads; j++)
            mpq_set(row[a->first_load + j], right[states + j]);
        size_t at = a->first_load + a->loads;
        right += states + a->loads;
        for (int u = 0; u < system->inputs; u++)
            for (int k = 0; k <= system->input[u].hold; k++)
                mpq_set(row[at++], right[2 * u + k]);
    }
}

/* Scheme pl: after division by the masses, the terms of other coordinates act through a constant copy of the state. */
static struct augmented augment(const struct linear *system, int segment, bool pl, mpq_srcptr h)
{
    const size_t states = (size_t)system->states, copies = pl ? states : 0;
    struct augmented a = { .states = states, .loads = (size_t)load_columns(system), .inputs = input_states(system) };
    a.first_load = states + copies;
    a.size = a.first_load + a.loads + a.inputs;
    a.columns = states + a.loads + a.inputs;
    a.A = rationals(a.size * a.size);
    a.X = rationals(a.size * a.columns);
    fill_dynamics(system, segment, pl, &a);
    for (size_t at = a.first_load, l = 0; l < (size_t)system->loads; at += (size_t)system->load[l++].columns)
        fill_load_states(&system->load[l], a.size, a.A + at * a.size + at);
    for (size_t j = 0; j < states + a.loads; j++) {
        mpq_set_ui(a.X[(j < states ? j : j + copies) * a.columns + j], 1, 1);
        if (j < copies)
            mpq_set_ui(a.X[(states + j) * a.columns + j], 1, 1);
    }
    fill_inputs(system, h, &a);
    return a;
}

/* ---- zero at every tau: (A^k X)_ij = 0 for k < size (Cayley and Hamilton), modulo a prime of 61 bits ---- */

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

static bool rounded(mpfi_ptr x, double *d)
{
    const double high = mpfr_get_d(&x->right, MPFR_RNDN);
    *d = mpfr_get_d(&x->left, MPFR_RNDN);
    if (*d != high)
        return false;
    if (*d == 0)
        *d = 0;                         /* no sign */
    return true;
}

/* (e^{A h} X)_ij - subtract, rounded: true if this enclosure decides it. */
static bool rounded_difference(const struct augmented *a, const evaluator_enclosure *E, size_t i, size_t j,
                               double subtract, double *d)
{
    mpfi_t sum;
    size_t bits = mpz_sizeinbase(E->radius, 2);
    for (size_t l = 0; l < a->size; l++)
        if (mpz_sizeinbase(E->mid[i * a->size + l], 2) > bits)
            bits = mpz_sizeinbase(E->mid[i * a->size + l], 2);
    mpfi_init2(sum, (mpfr_prec_t)bits + 64);
    mpfi_set_ui(sum, 0);
    for (size_t l = 0; l < a->size; l++)
        if (mpq_sgn(a->X[l * a->columns + j]) != 0)
            add_entry(sum, E, i * a->size + l, a->X[l * a->columns + j]);
    mpfi_sub_d(sum, sum, subtract);
    const bool decided = rounded(sum, d);
    mpfi_clear(sum);
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
        return format("factor of %s in %s", model->names.state[j], model->names.state[i]);
    return format("factor of load or input column %zu in %s", j - (size_t)model->system.states, model->names.state[i]);
}

/* A flag says 0 at this tau: either 0 at every tau, or the judge finds nothing there with 4096 bits. */
static void compare_flag(const char *what, struct enclosures *e, size_t i, size_t j, const struct coefficient *found,
                         bool always)
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

static const struct coefficient *found_entry(const struct table *table, int segment, size_t i, size_t j)
{
    const size_t states = (size_t)table->states, loads = (size_t)table->columns;
    if (j < states)
        return &table->Phi[i * states + j];
    if (j < states + loads)
        return &table->load[((size_t)segment * states + i) * loads + j - states];
    return &table->input[i * (size_t)table->inputs + j - states - loads];
}

/* The states and the inputs have the same factors in every segment. */
static void compare_step(const struct model *model, int segment, const struct augmented *a, const struct table *table,
                         const double *expected)
{
    struct enclosures e = { .a = a, .h = model->h };
    const bool *always = always_zero(a);
    if ((size_t)table->states != a->states || (size_t)table->columns != a->loads ||
        (size_t)table->inputs != a->inputs) {
        complain("table", "wrong size");
        return;
    }
    for (size_t i = 0; i < a->states; i++)
        for (size_t j = segment ? a->states : 0; j < (segment ? a->states + a->loads : a->columns); j++) {
            const char *what = entry_name(model, i, j);
            const struct coefficient *c = found_entry(table, segment, i, j);
            compare(what, c->value, expected[i * a->columns + j]);
            compare_low(what, &e, i, j, c);
            compare_flag(what, &e, i, j, c, always[i * a->columns + j]);
        }
    for (int level = 0; level < LEVELS; level++)
        if (e.level[level])
            evaluator_enclosure_clear(e.level[level]);
}

/* One entry of e^{A h} by Taylor series, against what residues found */
static void compare_road(struct taylor *taylor, int i, int j, const char *what, double expected)
{
    double value = 0;
    mpfi_t x;
    mpq_t exact;
    mpq_init(exact);
    mpfi_init(x);
    bool decided = taylor_exact(taylor, i, j, exact);
    if (decided)
        value = round_rational(exact);
    for (int precision = 256; precision <= 4096 && !decided && taylor_enclose(taylor, precision); precision *= 2) {
        taylor_entry(taylor, i, j, x);
        decided = rounded(x, &value);
    }
    if (decided)
        compare(format("by Taylor series, %s", what), value, expected);
    mpfi_clear(x);
    mpq_clear(exact);
}

/* Small models come by residues, large ones by Taylor series: here the small ones by the second road too. */
static void compare_roads(const struct step *step)
{
    const struct linear *system = &step->branch->system;
    const struct layout *layout = &step->layout;
    const int n = system->states, columns = step->branch->whole->columns;
    if (n > LIMIT_RESIDUE_STATES || system->heldK)
        return;
    struct taylor *taylor = taylor_of(layout->size, (const mpq_t *)augmented_matrix(layout, system, 0), step->model->h);
    for (int i = 0; i < n; i++) {
        for (int j = 0; j < n; j++)
            compare_road(taylor, i, j, entry_name(step->model, (size_t)i, (size_t)j),
                         step->branch->whole->Phi[i * n + j].value);
        for (int l = 0, column = 0; l < system->loads; l++)
            for (int k = 0; k < system->load[l].columns; k++, column++)
                if (layout->load[l] >= 0)
                    compare_road(taylor, i, layout->load[l] + k,
                                 entry_name(step->model, (size_t)i, (size_t)(n + column)),
                                 step->branch->whole->load[i * columns + column].value);
    }
}

/* A refused step is right if a factor is out of range, and if that is what was said. */
static void compare_refusal(bool overflow)
{
    const char *said = diagnostics();
    trial.compared++;
    if (!overflow || !strstr(said, "is beyond the range of double"))
        complain("step refused", first_line(said));
}

static void compare_scheme(const struct model *model, bool both_roads)
{
    const struct step *step = step_build(model);
    bool overflow = false;
    for (int s = 0; s < model->system.segments; s++) {
        const struct augmented a = augment(&model->system, s, model->scheme == SCHEME_PL, model->h);
        double *expected = ARRAY(double, a.size * a.columns);
        const int undecided =
            evaluator_round(a.size, (const mpq_t *)a.A, model->h, a.columns, (const mpq_t *)a.X, 0, expected);
        for (size_t i = 0; i < a.states * a.columns; i++)
            overflow = overflow || isinf(expected[i]);
        if (step && undecided)
            complain(format("entry %d of %zu x %zu", -1 - undecided, a.size, a.columns), "the judge cannot decide");
        else if (step)
            compare_step(model, s, &a, step->branch->whole, expected);
    }
    if (!step)
        compare_refusal(overflow);
    else if (both_roads)
        compare_roads(step);
}

/* ---- the closed-form solution ---- */

/* x = states, loads, 1, t, outputs: an output o = c x, c constant, has o' = c A x */
struct solution {
    size_t size, outputs;               /* the outputs come last */
    mpq_t *A, *start;
};

/* exp, cos or sin of q as the generator takes it: to 256 bits, from a number of so many that it need not be looked at
 * twice */
static void set_function(mpq_ptr value, mpq_srcptr q, int (*function)(mpfr_t, const mpfr_t, mpfr_rnd_t))
{
    mpfr_t wide, rounded;
    mpfr_init2(wide, 4096);
    mpfr_init2(rounded, IRRATIONAL_BITS);
    mpfr_set_q(wide, q, MPFR_RNDN);
    function(wide, wide, MPFR_RNDN);
    mpfr_set(rounded, wide, MPFR_RNDN);
    mpfr_get_q(value, rounded);
    mpfr_clears(wide, rounded, (mpfr_ptr)NULL);
}

/* The load states at time t as the generator takes them: functions to 256 bits, powers exact */
static void set_load_states(const struct linear *system, mpq_srcptr t, mpq_t *z)
{
    mpq_t angle;
    mpq_init(angle);
    for (size_t at = 0, l = 0; l < (size_t)system->loads; at += (size_t)system->load[l++].columns) {
        const struct wave *wave = system->load[l].wave;
        const size_t trig = mpq_sgn(wave->w) != 0 ? 2 : 1;
        for (size_t c = 0; c < (size_t)system->load[l].columns; c++) {
            mpq_mul(angle, wave->a, t);
            set_function(z[at + c], angle, mpfr_exp);
            for (size_t k = 0; k < c / trig; k++)
                mpq_mul(z[at + c], z[at + c], t);
            if (trig == 1)
                continue;
            mpq_mul(angle, wave->w, t);
            mpq_add(angle, angle, wave->p);
            set_function(angle, angle, c % 2 ? mpfr_sin : mpfr_cos);
            mpq_mul(z[at + c], z[at + c], angle);
        }
    }
    mpq_clear(angle);
}

static mpq_t *output_row(const struct model *model, const struct augmented *a, int segment, const struct output *output)
{
    mpq_t *row = rationals(a->size);
    for (size_t i = 0; i < a->states; i++)
        mpq_set(row[i], output->state[i]);
    for (size_t at = a->first_load, l = 0; l < (size_t)model->system.loads; l++)
        for (int k = 0; k < model->system.load[l].columns; k++, at++)
            mpq_set(row[at], output->load[l][k * model->system.segments + segment]);
    return row;
}

/* In one segment of time; `segment` is that which holds t = 0. */
static struct solution solution_of(const struct model *model, const struct augmented *a, int segment)
{
    const size_t first = a->size, outputs = (size_t)model->outputs, size = first + outputs;
    struct solution s = { size, outputs, rationals(size * size), rationals(size) };
    mpq_t zero;
    mpq_init(zero);
    for (size_t i = 0; i < a->size; i++)
        for (size_t j = 0; j < a->size; j++)
            mpq_set(s.A[i * size + j], a->A[i * a->size + j]);
    for (size_t i = 0; i < a->states; i++)
        mpq_set(s.start[i], model->initial[i]);
    set_load_states(&model->system, zero, s.start + a->first_load);
    for (size_t o = 0; o < outputs; o++) {
        const mpq_t *factors = (const mpq_t *)output_row(model, a, segment, &model->output[o]);
        for (size_t i = 0; i < first; i++) {
            add_product(s.start[first + o], factors[i], s.start[i], false);
            for (size_t j = 0; j < first; j++)
                add_product(s.A[(first + o) * size + j], factors[i], s.A[i * size + j], false);
        }
    }
    mpq_clear(zero);
    return s;
}

static int first_segment(const struct linear *system)
{
    int first = 0;
    while (first < system->segments - 1 && mpq_sgn(system->change[first]) <= 0)
        first++;
    return first;
}

struct solution_work {
    const struct model *model;
    const struct solution *solution;
    double *expected;
};

/* False: the judge cannot decide.  That is no failure where another value is out of range: e^{1e5} beside 1 is beyond
 * its 16384 bits. */
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
            const int count =
                responses_of_output(resolvent, &model->system, (const mpq_t *)model->initial, &model->output[o], &list);
            const struct coefficient c = started_value(count, list, t, false, model->asked.step_at,
                                                       model->output[o].name);
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

/* ---- the same across changes of formula in time ---- */

enum { MIDPOINT_BITS = 1500 };

/* target (prec MIDPOINT_BITS) += a b */
static void add_real(mpfr_ptr target, mpfr_srcptr a, mpq_srcptr b)
{
    mpfr_t product;
    mpfr_init2(product, MIDPOINT_BITS);
    mpfr_mul_q(product, a, b, MPFR_RNDN);
    mpfr_add(target, target, product, MPFR_RNDN);
    mpfr_clear(product);
}

/* y <- e^{A tau} y */
static mpfr_t *advance(const struct augmented *a, mpq_srcptr tau, const mpfr_t *y)
{
    const size_t n = a->size;
    mpfr_t *E = reals(n * n, MIDPOINT_BITS), *next = reals(n, MIDPOINT_BITS), product;
    if (evaluator_midpoints(n, (const mpq_t *)a->A, tau, MIDPOINT_BITS, E) != 0)
        return NULL;
    mpfr_init2(product, MIDPOINT_BITS);
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < n; j++) {
            mpfr_mul(product, E[i * n + j], y[j], MPFR_RNDN);
            mpfr_add(next[i], next[i], product, MPFR_RNDN);
        }
    mpfr_clear(product);
    return next;
}

/* All states at t, driven from change to change; the loads are states that run on.  Phases are 256-bit numbers at t = 0
 * here and at the changes there: the two differ by about 2^-256 of what they are summed from.  `segment` becomes that
 * of t. */
static mpfr_t *driven(const struct model *model, mpq_srcptr t, int *segment)
{
    const struct linear *system = &model->system;
    const int first = first_segment(system);
    mpq_t now, tau;
    mpq_inits(now, tau, NULL);
    struct augmented a = augment(system, first, false, model->h);
    mpfr_t *y = reals(a.size, MIDPOINT_BITS);
    mpq_t *z = rationals(a.loads);
    set_load_states(system, now, z);
    for (size_t i = 0; i < a.states; i++)
        mpfr_set_q(y[i], model->initial[i], MPFR_RNDN);
    for (size_t i = 0; i < a.loads; i++)
        mpfr_set_q(y[a.first_load + i], z[i], MPFR_RNDN);
    for (*segment = first; *segment < system->segments - 1 && mpq_cmp(system->change[*segment], t) <= 0; ++*segment) {
        a = augment(system, *segment, false, model->h);
        mpq_sub(tau, system->change[*segment], now);
        mpq_set(now, system->change[*segment]);
        if (!(y = advance(&a, tau, (const mpfr_t *)y)))
            return NULL;
    }
    a = augment(system, *segment, false, model->h);
    mpq_sub(tau, t, now);
    return advance(&a, tau, (const mpfr_t *)y);
}

/* |found - sum| is to be half a unit in the last place, or 2^-200 of the largest term. */
static void compare_driven(const struct model *model, const struct augmented *a, int segment,
                           const struct output *output, const mpfr_t *y, double found)
{
    const mpq_t *row = (const mpq_t *)output_row(model, a, segment, output);
    mpfr_t sum, size, error;
    mpfr_inits2(MIDPOINT_BITS, sum, size, error, (mpfr_ptr)NULL);
    mpfr_set_zero(sum, 1);
    mpfr_set_zero(size, 1);
    for (size_t i = 0; i < a->size; i++) {
        add_real(sum, y[i], row[i]);
        mpfr_mul_q(error, y[i], row[i], MPFR_RNDN);
        mpfr_abs(error, error, MPFR_RNDN);
        mpfr_max(size, size, error, MPFR_RNDN);
        mpfr_abs(error, y[i], MPFR_RNDN);
        mpfr_max(size, size, error, MPFR_RNDN);
    }
    trial.compared++;
    const double expected = mpfr_get_d(sum, MPFR_RNDN);
    if (expected != found) {            /* it may have lain next to a tie, or near 0 */
        mpfr_sub_d(error, sum, found, MPFR_RNDN);
        mpfr_abs(error, error, MPFR_RNDN);
        mpfr_mul_2si(size, size, -200, MPFR_RNDN);
        const double spacing = nextafter(fabs(found), HUGE_VAL) - fabs(found);
        mpfr_sub_d(error, error, found == 0 ? 0 : spacing / 2, MPFR_RNDN);
        if (!(mpfr_cmp(error, size) <= 0))
            complain(output->name,
                     format("found %a = %.17g, expected %a = %.17g (driven)", found, found, expected, expected));
    }
    mpfr_clears(sum, size, error, (mpfr_ptr)NULL);
}

static void compare_changes(void *context)
{
    static const unsigned long multiples[] = { 0, 1, 17, 60, 101, 3000 };
    const struct model *model = ((struct solution_work *)context)->model;
    const struct augmented a = augment(&model->system, 0, false, model->h);
    struct resolvent *resolvent = resolvent_of(&model->system);
    mpq_t t;
    mpq_init(t);
    for (size_t k = 0; k < sizeof multiples / sizeof *multiples; k++) {
        int segment;
        mpq_set_ui(t, multiples[k], 1);
        mpq_mul(t, t, model->h);
        trial.time = format("%lu h", multiples[k]);
        const mpfr_t *y = (const mpfr_t *)driven(model, t, &segment);
        if (!y) {
            trial.beyond++;
            continue;
        }
        for (int o = 0; o < model->outputs; o++) {
            struct started *list;
            const int count =
                responses_of_output(resolvent, &model->system, (const mpq_t *)model->initial, &model->output[o], &list);
            const struct coefficient c = started_value(count, list, t, false, model->asked.step_at,
                                                       model->output[o].name);
            compare_driven(model, &a, segment, &model->output[o], y, c.value);
        }
    }
    mpq_clear(t);
}

static void compare_solution(struct model *model, mpq_srcptr written_step)
{
    mpq_set(model->h, written_step);
    const int first = first_segment(&model->system);
    const struct augmented a = augment(&model->system, first, false, model->h);
    const struct solution s = solution_of(model, &a, first);
    struct solution_work work = { model, &s, ARRAY(double, s.size) };
    trial.scheme = "exact (solution)";
    if (model->system.segments > 1) {
        if (!statement_guard(compare_changes, &work))
            complain("solution", first_line(diagnostics()));
        return;
    }
    if (!statement_guard(compare_solution_values, &work))
        complain("solution", first_line(diagnostics()));
    else if (model->system.inputs)
        return;                         /* --solution does not know their samples */
    else if (!statement_guard(compare_solution_text, &work))
        compare_solution_refusal(&work);
}

/* ---- one spec ---- */

static struct model *model_of(const char *text)
{
    static const struct request none;
    struct model *model = model_build(spec_of("spec", text), &none);
    if (!model)
        complain("spec", format("not accepted: %s", first_line(diagnostics())));
    return model;
}

static void try_model(struct model *model, bool both_roads)
{
    static const char *const schemes[] = { "exact", "pl" };
    mpq_t written;
    mpq_init(written);
    mpq_set(written, model->h);
    for (int pl = 0; pl < 2; pl++) {
        if (pl && model->n == 1)
            continue;                   /* nothing to hold: the same as exact */
        trial.scheme = schemes[pl];
        model->scheme = pl ? SCHEME_PL : SCHEME_EXACT;
        for (int k = -1; k < STEP_COUNT; k++) {
            if (quick && model->system.states >= LARGE_STATES && k >= 0 && k != SHORTEST && k != MIDDLE)
                continue;
            trial.time = k < 0 ? "as written" : STEPS[k];
            if (k >= 0)
                rational_parse(model->h, STEPS[k]);
            else
                mpq_set(model->h, written);
            compare_scheme(model, both_roads && k != STEP_COUNT - 1);
        }
        if (!pl)
            compare_solution(model, written);
    }
    mpq_set(model->h, written);
    mpq_clear(written);
}

static void try_spec(const char *text, bool both_roads)
{
    trial.spec = text;
    struct model *model = model_of(text);
    if (model)
        try_model(model, both_roads);
}

/* ---- --reduce ---- */

/* Rank of c, c A, c A^2, ... of all outputs, by elimination in rationals */
static size_t observable_rank(const struct model *model)
{
    const struct augmented a = augment(&model->system, 0, false, model->h);
    const size_t n = a.states, rows = n * (size_t)model->outputs;
    mpq_t *R = rationals(rows * n), factor;
    size_t rank = 0;
    mpq_init(factor);
    for (size_t o = 0; o < (size_t)model->outputs; o++)
        for (size_t k = 0; k < n; k++)
            for (size_t j = 0; j < n; j++) {
                mpq_t *cell = &R[(o * n + k) * n + j];
                if (k == 0)
                    mpq_set(*cell, model->output[o].state[j]);
                for (size_t l = 0; l < n && k; l++)
                    add_product(*cell, R[(o * n + k - 1) * n + l], a.A[l * a.size + j], false);
            }
    for (size_t j = 0; j < n; j++) {
        size_t pivot = rank;
        while (pivot < rows && mpq_sgn(R[pivot * n + j]) == 0)
            pivot++;
        if (pivot == rows)
            continue;
        for (size_t l = 0; l < n; l++)
            mpq_swap(R[pivot * n + l], R[rank * n + l]);
        for (size_t i = rank + 1; i < rows; i++) {
            mpq_div(factor, R[i * n + j], R[rank * n + j]);
            for (size_t l = j; l < n && mpq_sgn(factor); l++)
                add_product(R[i * n + l], factor, R[rank * n + l], true);
        }
        rank++;
    }
    mpq_clear(factor);
    return rank;
}

struct reduced_case {
    const struct model *full, *reduced;
};

/* Both are correctly rounded, so they are equal to the last bit. */
static void compare_outputs(void *context)
{
    static const unsigned long multiples[] = { 0, 1, 17, 60, 3000 };
    const struct reduced_case *r = context;
    struct resolvent *full = resolvent_of(&r->full->system), *reduced = resolvent_of(&r->reduced->system);
    mpq_t t;
    mpq_init(t);
    for (int o = 0; o < r->full->outputs; o++) {
        const char *name = r->full->output[o].name;
        struct started *f, *g;
        const int fs =
            responses_of_output(full, &r->full->system, (const mpq_t *)r->full->initial, &r->full->output[o], &f);
        const int gs = responses_of_output(reduced, &r->reduced->system, (const mpq_t *)r->reduced->initial,
                                           &r->reduced->output[o], &g);
        for (size_t k = 0; k < sizeof multiples / sizeof *multiples; k++) {
            mpq_set_ui(t, multiples[k], 1);
            mpq_mul(t, t, r->full->h);
            trial.time = format("%lu h", multiples[k]);
            const double expected = started_value(fs, f, t, false, r->full->asked.step_at, name).value;
            compare(name, started_value(gs, g, t, false, r->full->asked.step_at, name).value, expected);
        }
    }
    mpq_clear(t);
}

/* The reduced model has the same outputs, as many states as are needed, and numbers as right as any model's. */
static void try_reduction(const char *text)
{
    trial.spec = text;
    struct model *full = model_of(text);
    if (!full)
        return;
    full->asked.reduce = true;
    struct model *reduced = model_reduce(full);
    const size_t rank = observable_rank(full);
    trial.scheme = "exact (reduced)";
    trial.compared++;
    if ((size_t)reduced->system.states != rank)
        complain("states", format("found %d, expected %zu of %d", reduced->system.states, rank, full->system.states));
    if (rank == (size_t)full->system.states)
        complain("states", "nothing was hidden");
    if (!statement_guard(compare_outputs, &(struct reduced_case){ full, reduced }))
        complain("outputs", first_line(diagnostics()));
    trial.scheme = "exact (reduced)";
    trial.time = "as written";
    compare_scheme(reduced, false);
    compare_solution(reduced, reduced->h);
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
    struct augmented a = { .states = n, .size = n, .columns = n, .A = c->A, .X = rationals(n * n) };
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
    if (!step || !step->branch->whole->Phi[3].zero || step->branch->whole->Phi[3].value != 0)
        complain("Phi_22", "not found to be zero");
    if (!step)
        return;
    rational_parse(model->h, "0.0100000000000000000000000000001");
    step = step_build(model);
    if (!step || step->branch->whole->Phi[3].zero || !(step->branch->whole->Phi[3].value < -3e-30))
        complain("Phi_22", "1e-31 beside its zero: found to be zero");
}

/* ---- rational at every step ---- */

/* A^k X = 0 from k = size on, so e^{A h} X is a finite sum. */
static mpq_t *nilpotent_exponential(const struct augmented *a, mpq_srcptr h)
{
    const size_t n = a->size, m = a->columns;
    mpq_t *sum = rationals(n * m), *term = rationals(n * m), factor;
    mpq_init(factor);
    for (size_t i = 0; i < n * m; i++) {
        mpq_set(sum[i], a->X[i]);
        mpq_set(term[i], a->X[i]);
    }
    for (unsigned long k = 1; k <= n; k++) {
        mpq_t *next = rationals(n * m);
        mpq_set_ui(factor, k, 1);
        mpq_div(factor, h, factor);
        for (size_t i = 0; i < n * m; i++) {
            for (size_t l = 0; l < n; l++)
                add_product(next[i], a->A[i / m * n + l], term[l * m + i % m], false);
            mpq_mul(next[i], next[i], factor);
            mpq_add(sum[i], sum[i], next[i]);
        }
        term = next;
    }
    for (size_t i = 0; i < n * m; i++)
        if (mpq_sgn(term[i]) != 0)
            complain("spec", "not nilpotent");
    mpq_clear(factor);
    return sum;
}

static void compare_exact(const char *what, struct response *response, mpq_srcptr h, mpq_srcptr expected)
{
    mpq_t found;
    mpq_init(found);
    trial.compared++;
    if (!response_exact(response, h, found))
        complain(what, "not found to be rational");
    else if (!mpq_equal(found, expected))
        complain(what, format("found %s, expected %s", exact_text(found), exact_text(expected)));
    mpq_clear(found);
}

static void compare_exact_row(const struct model *model, int segment, const struct augmented *a, const mpq_t *expected,
                              int i)
{
    const struct linear *system = &model->system;
    struct resolvent *resolvent = resolvent_of(system);
    const mpq_t *row = expected + (size_t)i * a->columns;
    size_t at = 0;
    for (int j = 0; j < system->states; j++, at++)
        compare_exact(entry_name(model, (size_t)i, at), response_of_state(resolvent, system, i, j), model->h, row[at]);
    for (int l = 0; l < system->loads; l++)
        for (int k = 0; k < system->load[l].columns; k++, at++)
            compare_exact(entry_name(model, (size_t)i, at), response_of_load(resolvent, system, segment, i, l, k),
                          model->h, row[at]);
    for (int u = 0; u < system->inputs; u++)
        for (int k = 0; k <= system->input[u].hold; k++, at++)
            compare_exact(entry_name(model, (size_t)i, at), response_of_input(resolvent, system, i, u, k, model->h),
                          model->h, row[at]);
}

/* Every number of the step is the very rational, before it is rounded. */
static void try_exact(const char *text)
{
    trial.spec = text;
    trial.scheme = "exact";
    struct model *model = model_of(text);
    for (int k = 0; k < STEP_COUNT && model; k++) {
        trial.time = STEPS[k];
        rational_parse(model->h, STEPS[k]);
        for (int s = 0; s < model->system.segments; s++) {
            const struct augmented a = augment(&model->system, s, false, model->h);
            const mpq_t *expected = (const mpq_t *)nilpotent_exponential(&a, model->h);
            for (int i = 0; i < model->system.states; i++)
                compare_exact_row(model, s, &a, expected, i);
        }
    }
}

/* ---- the whole ---- */

struct job {
    void (*work)(void *context);
    void *context;
};

static bool try_case(void *context)
{
    const struct job *job = context;
    job->work(job->context);
    if (trial.failed)
        show_spec(trial.spec);
    if (trial.failed > MISMATCHES_SHOWN)
        printf("# %d failures in all\n", trial.failed);
    if (trial.compared == 0)
        puts("# nothing was compared");
    if (trial.beyond)
        printf("# times beyond the judge: %d\n", trial.beyond);
    if (verbose)
        printf("# %d numbers compared in %.2f s\n", trial.compared, (double)clock() / CLOCKS_PER_SEC);
    return !trial.failed && trial.compared > 0;
}

static void run(const char *name, void (*work)(void *), void *context)
{
    struct job job = { work, context };
    run_case(name, LONGEST_CASE, try_case, &job);
}

static void run_spec(void *text)
{
    try_spec(text, true);
}

static void run_critical(void *text)
{
    try_critical(text);
    try_spec(text, true);
}

static void run_exact(void *text)
{
    try_exact(text);
    try_spec(text, true);
}

static void run_matrix(void *c)
{
    try_matrix(c);
}

static void run_random(void *seed)
{
    try_spec(random_spec(*(uint64_t *)seed), false);
}

static void run_reduction(void *seed)
{
    try_reduction(random_symmetric_spec(*(uint64_t *)seed));
}

int main(int argc, char **argv)
{
    unsigned long random_count = 200, reduced_count = 100, every = 1, seed = 1;
    for (int option; (option = getopt(argc, argv, "n:r:e:s:qv")) != -1;) {
        if (option == 'n')
            random_count = strtoul(optarg, NULL, 10);
        else if (option == 'r')
            reduced_count = strtoul(optarg, NULL, 10);
        else if (option == 'e')
            every = strtoul(optarg, NULL, 10);
        else if (option == 's')
            seed = strtoul(optarg, NULL, 10);
        else if (option == 'q')
            quick = true;
        else if (option == 'v')
            verbose = true;
        else
            return 2;
    }
    if (optind == argc) {
        fputs("usage: bitwise [-n RANDOM] [-r REDUCED] [-e EVERY] [-s SEED] [-q] [-v] exponentials.txt "
              "MODEL.spec ...\n", stderr);
        return 2;
    }
    memory_open();
    size_t matrices;
    struct matrix_case *matrix = read_matrices(argv[optind++], &matrices);
    printf("1..%zu\n", matrices + (size_t)(argc - optind) + (bitwise_spec_count + every - 1) / every + random_count +
           reduced_count);
    for (size_t i = 0; i < matrices; i++)
        run(format("matrix %s, tau = %s", matrix[i].name, exact_text(matrix[i].tau)), run_matrix, &matrix[i]);
    for (int i = optind; i < argc; i++)
        run(base_name(argv[i]), run_spec, read_text(argv[i]));
    static void (*const run_kind[])(void *) = { [PLAIN] = run_spec, [CRITICAL] = run_critical, [EXACT] = run_exact };
    for (size_t i = 0; i < bitwise_spec_count; i += every)
        run(bitwise_specs[i].name, run_kind[bitwise_specs[i].kind], (void *)bitwise_specs[i].text);
    for (unsigned long i = 0; i < random_count; i++) {
        uint64_t one = seed + i;
        run(format("random model %lu", seed + i), run_random, &one);
    }
    for (unsigned long i = 0; i < reduced_count; i++) {
        uint64_t one = seed + i;
        run(format("reduced random model %lu", seed + i), run_reduction, &one);
    }
    memory_close();
    return cases_failed() > 0;
}
