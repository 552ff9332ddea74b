/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Every number of the schemes that leave something over, against the judge, bit for bit: the transfer matrices e^{A h}
 * and e^{A h/2}, the load columns of every segment of time and the input columns at every fraction of the step, and
 * what multiplies the remainder, each combination rounded once.  A number carries the mark of zero if and only if it is
 * zero.
 *
 *     kernels [-n RANDOM] [-l LARGE] [-e EVERY] [-s SEED] [-w] [-v] MODEL.spec ...
 *
 * EVERY: of the specs that stand here, each so many-th.
 * Shared with the generator: its parser, the matrices M, C, K, loads and inputs that it reads from a spec, the C and K
 * of each operator, and which equations have a remainder.  From there on the judge has its own algebra and its own list
 * of what each scheme needs, after Cox and Matthews 2002 and Liu, Wang, Li and Yi 2022.  Each case runs in a process of
 * its own.
 */
#include "algebra.h"
#include "cases.h"
#include "drawn.h"
#include "random_spec.h"
#include "measuring.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>
#include <sys/resource.h>
#include <time.h>
#include <unistd.h>

enum { LONGEST_CASE = 300, MISMATCHES_SHOWN = 10, LARGE_STATES = 20, LARGE_STRIDE = 7 };

static const rlim_t LARGEST_CASE = (rlim_t)4 << 30;     /* bytes */

static bool verbose, whole;             /* whole: large models too are compared whole */

/* ---- one case: what is compared now, and what went wrong so far ---- */

static struct {
    const char *spec, *path;            /* text of the spec, and where it stands */
    const char *scheme, *table, *name;  /* table: full, half, part3; name: of the columns being compared */
    bool loads_left;                    /* known loads are left to the scheme */
    int operator, segment;
    int compared, failed, refused, unsettled; /* unsettled: too small for the judge to tell from 0 */
} trial = { .scheme = "none", .table = "none", .name = "none" };

static void complain(const char *what, const char *message)
{
    if (trial.failed++ < MISMATCHES_SHOWN)
        printf("# %s%s, operator %d, segment %d, table %s, %s%s: %s\n", trial.scheme,
               trial.loads_left ? ", loads left" : "", trial.operator, trial.segment, trial.table, trial.name, what,
               message);
}

/* ---- the plant: one operator in one segment of time, as x' = A x ---- */

/* x = states, [held states,] loads, inputs (with their slopes), then for each channel a chain u0' = u1, u1' = u2, u2' =
 * 0, whose u0 is the force on its equation: the response to a unit u2 is tau^3 phi3(A tau) B, B what a unit force gives
 * the derivatives. */
struct plant {
    size_t states, held, loads, inputs, force_columns;
    size_t load_at, input_at, force_column_at, size;
    mpq_t *A, *B;                       /* B: channels x size, 0 beyond the states */
};

/* The highest derivative of each coordinate: over the states, without sign, the load columns, u and u' of every input,
 * the channels. A coordinate of first order is solved for its derivative, whose factor stands in C and is no part of an
 * operator. */
static mpq_t *highest_rows(const struct model *model, int which, int segment, size_t *width)
{
    const struct linear *system = &model->system;
    const struct operator *operator = &model->schedule.operator[which];
    const size_t n = (size_t)system->n, states = (size_t)system->states;
    const size_t all = states + (size_t)load_columns(system) + 2 * (size_t)system->inputs +
		       (size_t)model->remainder.force_columns;
    mpq_t *W = rationals(n * (n + all)), *R = rationals(n * all);
    for (size_t i = 0; i < n; i++) {
        mpq_t *right = W + i * (n + all) + n;
        for (size_t j = 0; j < n; j++) {
            const int velocity = system->velocity[j];
            mpq_set(W[i * (n + all) + j], velocity < 0 ? system->C[i * n + j] : system->M[i * n + j]);
            mpq_set(right[j], operator->K[i * n + j]);
            if (velocity >= 0)
                mpq_set(right[velocity], operator->C[i * n + j]);
        }
        right += states;
        for (int l = 0; l < system->loads; l++)
            for (int k = 0; k < system->load[l].columns; k++)
                mpq_set(*right++, system->load[l].force[k][(size_t)segment * n + i]);
        for (int u = 0; u < system->inputs; u++)
            for (int k = 0; k < 2; k++)
                mpq_set(*right++, system->input[u].force[k][i]);
        for (int e = 0; e < model->remainder.force_columns; e++)
            mpq_set_ui(*right++, (size_t)model->remainder.row[e] == i, 1);
    }
    if (!eliminate(n, n + all, W)) {
        complain("", "the matrix of highest derivatives is singular");
        return NULL;
    }
    for (size_t i = 0; i < n; i++)
        for (size_t j = 0; j < all; j++)
            mpq_set(R[i * all + j], W[i * (n + all) + n + j]);
    *width = all;
    return R;
}

static void fill_row(const struct model *model, const struct plant *p, size_t i, const mpq_t *right)
{
    const struct linear *system = &model->system;
    const size_t target = system->velocity[i] >= 0 ? (size_t)system->velocity[i] : i;
    mpq_t *row = p->A + target * p->size;
    if (target != i)
        mpq_set_ui(p->A[i * p->size + target], 1, 1);
    for (size_t j = 0; j < p->states; j++)
        mpq_neg(row[(p->held && (size_t)system->coord[j] != i ? p->states : 0) + j], right[j]);
    for (size_t j = 0; j < p->loads; j++)
        mpq_set(row[p->load_at + j], right[p->states + j]);
    right += p->states + p->loads;
    for (size_t u = 0, at = p->input_at; u < (size_t)system->inputs; u++)
        for (int k = 0; k <= system->input[u].hold; k++)
            mpq_set(row[at++], right[2 * u + (size_t)k]);
    right += 2 * (size_t)system->inputs;
    for (size_t e = 0; e < p->force_columns; e++) {
        mpq_set(row[p->force_column_at + 3 * e], right[e]);
        mpq_set(p->B[e * p->size + target], right[e]);
    }
}

static bool make_plant(struct plant *p, const struct model *model, int which, int segment, bool split)
{
    const struct linear *system = &model->system;
    size_t width;
    *p = (struct plant){ .states = (size_t)system->states,
                         .held = split ? (size_t)system->states : 0,
                         .loads = (size_t)load_columns(system),
                         .force_columns = (size_t)model->remainder.force_columns };
    for (int u = 0; u < system->inputs; u++)
        p->inputs += system->input[u].hold ? 2 : 1;
    p->load_at = p->states + p->held;
    p->input_at = p->load_at + p->loads;
    p->force_column_at = p->input_at + p->inputs;
    p->size = p->force_column_at + 3 * p->force_columns;
    p->A = rationals(p->size * p->size);
    p->B = rationals(p->force_columns * p->size);
    const mpq_t *R = (const mpq_t *)highest_rows(model, which, segment, &width);
    if (!R)
        return false;
    for (size_t i = 0; i < (size_t)system->n; i++)
        fill_row(model, p, i, R + i * width);
    for (size_t at = p->load_at, l = 0; l < (size_t)system->loads; at += (size_t)system->load[l++].columns)
        fill_load_states(&system->load[l], p->size, p->A + at * p->size + at);
    for (size_t u = 0, at = p->input_at; u < (size_t)system->inputs; at += system->input[u++].hold ? 2 : 1)
        if (system->input[u].hold)
            mpq_set_ui(p->A[at * p->size + at + 1], 1, 1);
    for (size_t e = 0; e < p->force_columns; e++)
        for (size_t k = 0; k < 2; k++)
            mpq_set_ui(p->A[(p->force_column_at + 3 * e + k) * p->size + p->force_column_at + 3 * e + k + 1], 1, 1);
    return true;
}

/* ---- e^{A tau} at the times that are asked for ---- */

enum { LEVELS = 7, MOMENTS = 16, ZERO_LEVEL = 4 };

static const unsigned long LEVEL_BITS[LEVELS] = { 200, 450, 950, 1950, 3950, 7900, 15800 };

struct moment {
    mpq_t fraction, tau;
    evaluator_enclosure *level[LEVELS];
    bool given_up[LEVELS];
};
struct judge {
    struct plant plant;
    uint64_t *residue;                  /* of A, modulo PRIME */
    mpq_t h;
    int moments;
    struct moment moment[MOMENTS];
};

static struct moment *moment_at(struct judge *judge, mpq_srcptr fraction)
{
    for (int i = 0; i < judge->moments; i++)
        if (mpq_equal(judge->moment[i].fraction, fraction))
            return &judge->moment[i];
    if (judge->moments == MOMENTS)
        abort();
    struct moment *m = &judge->moment[judge->moments++];
    mpq_inits(m->fraction, m->tau, NULL);
    mpq_set(m->fraction, fraction);
    mpq_mul(m->tau, fraction, judge->h);
    return m;
}

static const evaluator_enclosure *enclosure(const struct judge *judge, struct moment *m, int level)
{
    if (!m->level[level]) {
        m->level[level] = NEW(evaluator_enclosure);
        evaluator_enclosure_init(m->level[level], judge->plant.size);
        m->given_up[level] =
            evaluator_enclose((const mpq_t *)judge->plant.A, m->tau, LEVEL_BITS[level], m->level[level]) != 0;
    }
    return m->given_up[level] ? NULL : m->level[level];
}

/* ---- one number per state: a sum over times of e^{A tau} w ---- */

struct part {
    struct moment *moment;
    mpq_t *w;                           /* one per entry of x */
    bool *zero, *polynomial;            /* per state, at every tau; see screen */
    mpq_t *value;                       /* per state, where polynomial; NULL: not asked for yet */
};
struct column {
    int parts;
    struct part part[2];
};

static struct part *add_part(struct judge *judge, struct column *column, mpq_srcptr fraction)
{
    struct part *part = &column->part[column->parts++];
    *part = (struct part){ .moment = moment_at(judge, fraction), .w = rationals(judge->plant.size) };
    return part;
}

/* By Cayley and Hamilton (e^{A tau} w)_i is zero at every tau if (A^k w)_i = 0 for k < n, a polynomial in tau if for n
 * <= k < 2n. */
static void screen(const struct judge *judge, struct part *part)
{
    const size_t n = judge->plant.size, states = judge->plant.states;
    uint64_t *v = ARRAY(uint64_t, n), *next = ARRAY(uint64_t, n);
    part->zero = ARRAY(bool, states);
    part->polynomial = ARRAY(bool, states);
    for (size_t i = 0; i < n; i++)
        v[i] = residue(part->w[i]);
    for (size_t i = 0; i < states; i++)
        part->zero[i] = part->polynomial[i] = true;
    for (size_t k = 0; k < 2 * n; k++) {
        for (size_t i = 0; i < states; i++)
            if (v[i])
                (k < n ? part->zero : part->polynomial)[i] = false;
        for (size_t i = 0; i < n; i++) {
            next[i] = 0;
            for (size_t l = 0; l < n; l++)
                if (v[l] && judge->residue[i * n + l])
                    next[i] = (next[i] + times(judge->residue[i * n + l], v[l])) % PRIME;
        }
        uint64_t *swap = v;
        v = next;
        next = swap;
    }
    for (size_t i = 0; i < states; i++)
        part->polynomial[i] = part->polynomial[i] || mpq_sgn(part->moment->fraction) == 0;
}

/* Which entries take part in those that are polynomial and not zero */
static bool *needed_rows(const struct judge *judge, const struct part *part)
{
    const size_t n = judge->plant.size;
    bool *needed = ARRAY(bool, n);
    for (size_t i = 0; i < judge->plant.states; i++)
        needed[i] = part->polynomial[i] && !part->zero[i];
    for (bool grown = true; grown;) {
        grown = false;
        for (size_t i = 0; i < n; i++)
            for (size_t l = 0; needed[i] && l < n; l++)
                if (!needed[l] && mpq_sgn(judge->plant.A[i * n + l])) {
                    needed[l] = true;
                    grown = true;
                }
    }
    return needed;
}

/* sum over k < n of A^k w tau^k / k! */
static void find_polynomials(const struct judge *judge, struct part *part)
{
    const size_t n = judge->plant.size, states = judge->plant.states;
    const bool *needed = needed_rows(judge, part);
    mpq_t *v = rationals(n), *next = rationals(n), weight;
    mpq_init(weight);
    mpq_set_ui(weight, 1, 1);
    part->value = rationals(states);
    for (size_t i = 0; i < n; i++)
        mpq_set(v[i], part->w[i]);
    for (unsigned long k = 0; k < n && mpq_sgn(weight); k++) {
        for (size_t i = 0; i < states; i++)
            if (part->polynomial[i] && !part->zero[i])
                add_product(part->value[i], v[i], weight, false);
        for (size_t i = 0; i < n; i++) {
            mpq_set_ui(next[i], 0, 1);
            for (size_t l = 0; needed[i] && l < n; l++)
                if (mpq_sgn(judge->plant.A[i * n + l]) && mpq_sgn(v[l]))
                    add_product(next[i], judge->plant.A[i * n + l], v[l], false);
        }
        for (size_t i = 0; i < n; i++)
            mpq_swap(v[i], next[i]);
        mpq_mul(weight, weight, part->moment->tau);
        mpq_set_ui(next[0], 1, k + 1);
        mpq_mul(weight, weight, next[0]);
    }
    mpq_clear(weight);
}

/* The number of row i; false: the judge has no enclosure so narrow */
static bool enclose(const struct judge *judge, const struct column *column, size_t i, int level, mpfi_ptr sum)
{
    mpfi_set_prec(sum, (mpfr_prec_t)(3 * LEVEL_BITS[level] + 256));
    mpfi_set_ui(sum, 0);
    for (int k = 0; k < column->parts; k++) {
        const struct part *part = &column->part[k];
        const evaluator_enclosure *E = enclosure(judge, part->moment, level);
        if (!E)
            return false;
        for (size_t l = 0; l < judge->plant.size; l++)
            if (mpq_sgn(part->w[l]))
                add_entry(sum, E, i * judge->plant.size + l, part->w[l]);
    }
    return true;
}

static double rounded(mpfr_srcptr x)
{
    const double d = mpfr_get_d(x, MPFR_RNDN);
    return d == 0 ? 0 : d;              /* no sign */
}

/* ---- found and expected ---- */

static void compare(const char *what, double found, double expected)
{
    trial.compared++;
    if (memcmp(&found, &expected, sizeof found) != 0)
        complain(what, format("found %a = %.17g, expected %a = %.17g", found, found, expected, expected));
}

/* A polynomial in tau: rational, so its zeros are known */
static void compare_rational(const char *what, const struct judge *judge, struct column *column, size_t i,
                             const struct coefficient *found)
{
    mpq_t sum;
    mpfr_t value;
    mpq_init(sum);
    mpfr_init2(value, 8192);
    for (int k = 0; k < column->parts; k++) {
        if (!column->part[k].zero[i] && !column->part[k].value)
            find_polynomials(judge, &column->part[k]);
        if (!column->part[k].zero[i])
            mpq_add(sum, sum, column->part[k].value[i]);
    }
    mpfr_set_q(value, sum, MPFR_RNDN);
    compare(what, found->value, rounded(value));
    if (found->zero != (mpq_sgn(sum) == 0))
        complain(what,
                 found->zero ? format("marked as zero, but it is %s", readable_text(sum)) : "zero, and not marked so");
    mpq_clear(sum);
    mpfr_clear(value);
}

/* Marked as zero: nothing is found there with 3950 bits.  Not marked, and rounded to zero: it can be told from zero. */
static void compare_mark(const char *what, const struct judge *judge, const struct column *column, size_t i,
                         const struct coefficient *found)
{
    mpfi_t sum;
    bool apart = false;
    mpfi_init(sum);
    for (int level = 0; level <= (found->zero ? ZERO_LEVEL : LEVELS - 1) && !apart; level++)
        apart = enclose(judge, column, i, level, sum) && !mpfi_has_zero(sum);
    if (found->zero && apart)
        complain(what, "marked as zero, but it is not");
    trial.unsettled += !found->zero && !apart;
    mpfi_clear(sum);
}

static void compare_enclosed(const char *what, const struct judge *judge, const struct column *column, size_t i,
                             const struct coefficient *found)
{
    mpfi_t sum;
    bool decided = false;
    double value = 0;
    mpfi_init(sum);
    for (int level = 0; level < LEVELS && !decided; level++)
        if (enclose(judge, column, i, level, sum)) {
            value = rounded(&sum->left);
            decided = value == rounded(&sum->right);
        }
    if (decided)
        compare(what, found->value, value);
    else
        complain(what, "the judge cannot decide");
    if (decided && (found->zero || value == 0))
        compare_mark(what, judge, column, i, found);
    mpfi_clear(sum);
}

/* `found` has one number per state, `stride` apart. */
static void compare_column(const struct model *model, const struct judge *judge, struct column *column,
                           const struct coefficient *found, size_t stride)
{
    const size_t states = judge->plant.states;
    for (int k = 0; k < column->parts; k++)
        screen(judge, &column->part[k]);
    for (size_t i = 0; i < states; i++) {
        const char *what = format(" in %s", model->names.state[i]);
        bool polynomial = true;
        for (int k = 0; k < column->parts; k++)
            polynomial = polynomial && (column->part[k].polynomial[i] || column->part[k].zero[i]);
        if (polynomial)
            compare_rational(what, judge, column, i, &found[i * stride]);
        else
            compare_enclosed(what, judge, column, i, &found[i * stride]);
    }
}

/* ---- what each scheme needs, written from the papers ---- */

struct fraction { long p; unsigned long q; };
struct phi_weight_term { /* tau = f h: tau phi1(A tau), and where f = 1 also h phi2(A h), h phi3(A h), times these */
    struct fraction f;
    long phi[3];
};
struct definition {
    enum scheme scheme;
    struct fraction table;              /* at which time it stands */
    const char *name;
    int terms;
    struct phi_weight_term term[2];
};

static const struct definition definitions[] = {
    { SCHEME_PL, { 1, 1 }, "p1", 1, { { { 1, 1 }, { 1, 0, 0 } } } },
    { SCHEME_ETD1, { 1, 1 }, "p1", 1, { { { 1, 1 }, { 1, 0, 0 } } } },
    { SCHEME_ETDRK2, { 1, 1 }, "p1", 1, { { { 1, 1 }, { 1, 0, 0 } } } },
    { SCHEME_ETDRK2, { 1, 1 }, "p2", 1, { { { 1, 1 }, { 0, 1, 0 } } } },
    { SCHEME_ETDRK4, { 1, 2 }, "q1", 1, { { { 1, 2 }, { 1, 0, 0 } } } },
    { SCHEME_ETDRK4, { 1, 1 }, "c0", 2, { { { 1, 1 }, { 1, 0, 0 } }, { { 1, 2 }, { -2, 0, 0 } } } },
    { SCHEME_ETDRK4, { 1, 1 }, "b1", 1, { { { 1, 1 }, { 1, -3, 4 } } } },
    { SCHEME_ETDRK4, { 1, 1 }, "b2", 1, { { { 1, 1 }, { 0, 2, -4 } } } },
    { SCHEME_ETDRK4, { 1, 1 }, "b3", 1, { { { 1, 1 }, { 0, -1, 4 } } } },
};
enum { DEFINITIONS = sizeof definitions / sizeof *definitions };

/* Nodes and weights; those of weight 0 are not computed. */
static const struct { int nodes; struct fraction c[4], weight[4]; } quadratures[SCHEMES] = {
    [SCHEME_NC2] = { 3, { { 0, 1 }, { 1, 2 }, { 1, 1 } }, { { 1, 6 }, { 2, 3 }, { 1, 6 } } },
    [SCHEME_NC3] = { 4, { { 0, 1 }, { 1, 3 }, { 2, 3 }, { 1, 1 } }, { { 1, 8 }, { 3, 8 }, { 3, 8 }, { 1, 8 } } },
    [SCHEME_DQ4] = { 4, { { 1, 4 }, { 1, 2 }, { 3, 4 }, { 1, 1 } }, { { 2, 3 }, { -1, 3 }, { 2, 3 }, { 0, 1 } } },
    [SCHEME_BM3] = { 4, { { 0, 1 }, { 1, 4 }, { 3, 4 }, { 1, 1 } }, { { 1, 18 }, { 4, 9 }, { 4, 9 }, { 1, 18 } } },
};

static void set_fraction(mpq_ptr q, struct fraction f)
{
    mpq_set_si(q, f.p, f.q);
    mpq_canonicalize(q);
}

/* Unit chains: tau^{k+1} phi_{k+1}(A tau) B from u_k; at tau = h that is h^k times h phi_{k+1}. */
static struct column defined_column(struct judge *judge, const struct definition *d, size_t force_column)
{
    struct column column = { 0 };
    mpq_t q, power;
    mpq_inits(q, power, NULL);
    for (int t = 0; t < d->terms; t++) {
        set_fraction(q, d->term[t].f);
        struct part *part = add_part(judge, &column, q);
        mpq_set_ui(power, 1, 1);
        for (size_t k = 0; k < 3; k++) {
            mpq_set_si(q, d->term[t].phi[k], 1);
            mpq_div(part->w[judge->plant.force_column_at + 3 * force_column + k], q, power);
            mpq_mul(power, power, judge->h);
        }
    }
    mpq_clears(q, power, NULL);
    return column;
}

/* h weight e^{A (1 - c) h} B */
static struct column weighted_column(struct judge *judge, struct fraction c, struct fraction weight,
				     size_t force_column)
{
    const struct plant *p = &judge->plant;
    struct column column = { 0 };
    mpq_t q;
    mpq_init(q);
    set_fraction(q, (struct fraction){ (long)c.q - c.p, c.q });
    struct part *part = add_part(judge, &column, q);
    set_fraction(q, weight);
    mpq_mul(q, q, judge->h);
    for (size_t i = 0; i < p->states; i++)
        mpq_mul(part->w[i], p->B[force_column * p->size + i], q);
    mpq_clear(q);
    return column;
}

/* ---- tables ---- */

/* Of a large model every seventh column */
static bool is_sampled(const struct judge *judge, size_t column)
{
    return whole || judge->plant.states <= LARGE_STATES || column % LARGE_STRIDE == 0;
}

static void compare_Phi(const struct model *model, struct judge *judge, const struct table *table)
{
    const size_t states = judge->plant.states;
    for (size_t j = 0; j < states; j++) {
        struct column column = { 0 };
        if (!is_sampled(judge, j))
            continue;
        struct part *part = add_part(judge, &column, table->wanted->fraction);
        mpq_set_ui(part->w[j], 1, 1);
        if (judge->plant.held)
            mpq_set_ui(part->w[states + j], 1, 1);
        trial.name = format("factor of %s", model->names.state[j]);
        compare_column(model, judge, &column, table->Phi + j, states);
    }
}

static void compare_loads(const struct model *model, struct judge *judge, const struct table *table)
{
    const size_t loads = judge->plant.loads;
    for (size_t j = 0; j < loads; j++) {
        struct column column = { 0 };
        mpq_set_ui(add_part(judge, &column, table->wanted->fraction)->w[judge->plant.load_at + j], 1, 1);
        trial.name = format("factor of load column %zu", j);
        compare_column(model, judge, &column, table->load + (size_t)trial.segment * judge->plant.states * loads + j,
                       loads);
    }
}

/* A ramp over the whole step, u0 at its start and u1 at its end: u = u0, u' = (u1 - u0)/h */
static void compare_inputs(const struct model *model, struct judge *judge, const struct table *table)
{
    const size_t inputs = judge->plant.inputs;
    for (size_t u = 0, at = 0; u < (size_t)model->system.inputs; u++)
        for (int end = 0; end <= model->system.input[u].hold; end++, at++) {
            struct column column = { 0 };
            mpq_t *w = add_part(judge, &column, table->wanted->fraction)->w + judge->plant.input_at + at - (size_t)end;
            if (!end)
                mpq_set_ui(w[0], 1, 1);
            if (model->system.input[u].hold)
                mpq_inv(w[1], judge->h);
            if (model->system.input[u].hold && !end)
                mpq_neg(w[1], w[1]);
            trial.name = format("factor of input %s%s", model->system.input[u].name, end ? ", its end" : "");
            compare_column(model, judge, &column, table->input + at, inputs);
        }
}

static void compare_phi_weight(const struct model *model, const struct judge *judge, struct column *column,
                           const struct table *table, int phi_weight, size_t force_column)
{
    trial.name = format("%s of channel %zu", table->wanted->phi_weight[phi_weight].name, force_column + 1);
    compare_column(model, judge, column, table->phi_weight[phi_weight] + force_column, judge->plant.force_columns);
}

static const struct definition *definition_of(enum scheme scheme, const struct wanted *wanted, const char *name)
{
    for (int i = 0; i < DEFINITIONS; i++)
        if (definitions[i].scheme == scheme && strcmp(definitions[i].name, name) == 0 &&
            mpq_cmp_si(wanted->fraction, definitions[i].table.p, definitions[i].table.q) == 0)
            return &definitions[i];
    return NULL;
}

/* Kernels with a name of their own */
static void compare_defined(const struct model *model, struct judge *judge, const struct table *table)
{
    for (int k = 0; k < table->wanted->phi_weights; k++) {
        const struct definition *d = definition_of(model->scheme, table->wanted, table->wanted->phi_weight[k].name);
        if (!d)
            complain(table->wanted->phi_weight[k].name, "no such factor in this scheme");
        for (size_t e = 0; d && e < judge->plant.force_columns; e++) {
            if (!is_sampled(judge, e))
                continue;
            struct column column = defined_column(judge, d, e);
            compare_phi_weight(model, judge, &column, table, k, e);
        }
    }
}

/* ---- the remainder of each node meets the kernel of its node ---- */

static mpq_srcptr node_of_left(const struct program *program, int left)
{
    for (int i = 0; i < program->actions; i++)
        if (program->action[i].kind == ACTION_REMAINDER && program->action[i].target == left)
            return program->node[program->action[i].node];
    return NULL;
}

static const struct action *last_sum(const struct program *program)
{
    const struct action *sum = NULL;
    for (int i = 0; i < program->actions; i++)
        if (program->action[i].kind == ACTION_SUM && program->action[i].target == STAGE_STATE)
            sum = &program->action[i];
    return sum;
}

static void compare_quadrature(const struct model *model, struct judge *judge, const struct step *step,
                               struct table *const *tables)
{
    const struct action *sum = last_sum(step->program);
    int used = 0;
    for (int i = 0; i < quadratures[model->scheme].nodes; i++) {
        const struct fraction c = quadratures[model->scheme].c[i], weight = quadratures[model->scheme].weight[i];
        int found = 0;
        for (int k = 0; sum && k < sum->phi_weights; k++) {
            mpq_srcptr node = node_of_left(step->program, sum->phi_weight[k].left);
            if (!node || mpq_cmp_si(node, c.p, c.q) != 0)
                continue;
            found++;
            for (size_t e = 0; e < judge->plant.force_columns; e++) {
                if (!is_sampled(judge, e))
                    continue;
                struct column column = weighted_column(judge, c, weight, e);
                trial.table = tables[sum->phi_weight[k].table]->wanted->name;
                compare_phi_weight(model, judge, &column, tables[sum->phi_weight[k].table],
				   sum->phi_weight[k].phi_weight, e);
            }
        }
        used += found;
        if (found != (weight.p != 0))
            complain("", format("node %ld/%lu is used %d times", c.p, c.q, found));
    }
    if (!sum || used != sum->phi_weights)
        complain("", "a node that the scheme has not");
}

/* ---- which tables there are ---- */

static bool has_drive(const struct linear *system)
{
    for (int l = 0; l < system->loads; l++)
        for (int k = 0; k < system->load[l].columns; k++)
            for (int i = 0; i < system->segments * system->n; i++)
                if (mpq_sgn(system->load[l].force[k][i]))
                    return true;
    return system->inputs > 0;
}

struct expected_tables {
    int count;
    struct fraction at[8];
};

static void expect_table(struct expected_tables *e, struct fraction f)
{
    for (int i = 0; i < e->count; i++)
        if ((unsigned long)e->at[i].p * f.q == (unsigned long)f.p * e->at[i].q)
            return;
    e->at[e->count++] = f;
}

/* The whole step; its half where stages stand there; where a predictor passes, if there are loads to be carried along.
 */
static struct expected_tables expected_tables(const struct model *model)
{
    struct expected_tables e = { 1, { { 1, 1 } } };
    if (model->scheme == SCHEME_ETDRK4)
        expect_table(&e, (struct fraction){ 1, 2 });
    for (int i = 0; i < quadratures[model->scheme].nodes && has_drive(&model->system); i++) {
        const struct fraction c = quadratures[model->scheme].c[i];
        if (c.p == 0 || quadratures[model->scheme].weight[i].p == 0)
            continue;
        expect_table(&e, (struct fraction){ c.p, 2 * c.q });
        expect_table(&e, c);
    }
    return e;
}

static void check_tables(const struct model *model, const struct step *step, struct table *const *tables)
{
    const struct expected_tables e = expected_tables(model);
    int phi_weights = 0, defined = 0;
    for (int i = 0; i < e.count; i++) {
        int found = 0;
        for (int t = 0; t < step->tables; t++)
            found += mpq_cmp_si(tables[t]->wanted->fraction, e.at[i].p, e.at[i].q) == 0;
        if (found != 1)
            complain("", format("%d tables at %ld/%lu h", found, e.at[i].p, e.at[i].q));
    }
    if (step->tables != e.count)
        complain("", format("%d tables, expected %d", step->tables, e.count));
    for (int t = 0; t < step->tables; t++)
        phi_weights += tables[t]->wanted->phi_weights;
    for (int i = 0; i < DEFINITIONS; i++)
        defined += definitions[i].scheme == model->scheme;
    for (int i = 0; i < quadratures[model->scheme].nodes; i++)
        defined += quadratures[model->scheme].weight[i].p != 0;
    if (phi_weights != defined)
        complain("", format("%d factors of remainders, expected %d", phi_weights, defined));
    for (int i = 0; i < step->program->nodes; i++)
        if (step->program->node_table[i] != NONE &&
            !mpq_equal(step->program->node[i], tables[step->program->node_table[i]]->wanted->fraction))
            complain("", format("loads of node %d are those of another time", i));
}

/* ---- one step ---- */

enum { OPERATORS = 8, SEGMENTS = 8 };
static struct judge *judges[2][2][OPERATORS][SEGMENTS]; /* of this case; all schemes but pl have the same */

static struct judge *judge_of(const struct model *model, int which, int segment)
{
    const bool split = model->scheme == SCHEME_PL;
    struct judge **judge = &judges[trial.loads_left][split][which][segment];
    if (*judge)
        return *judge;
    struct judge *made = NEW(struct judge);
    if (!make_plant(&made->plant, model, which, segment, split))
        return NULL;
    const size_t cells = made->plant.size * made->plant.size;
    made->residue = ARRAY(uint64_t, cells);
    for (size_t i = 0; i < cells; i++)
        made->residue[i] = residue(made->plant.A[i]);
    mpq_init(made->h);
    mpq_set(made->h, model->h);
    return *judge = made;
}

static bool has_size(const struct table *table, const struct plant *p)
{
    return (size_t)table->states == p->states && (size_t)table->columns == p->loads &&
           (size_t)table->inputs == p->inputs && (size_t)table->force_columns == p->force_columns;
}

static void compare_segment(const struct model *model, const struct step *step, int which, int segment)
{
    struct judge *judge = judge_of(model, which, segment);
    trial.operator = which;
    trial.segment = segment;
    for (int t = 0; judge && t < step->tables; t++) {
        const struct table *table = step->branch[which].table[t];
        trial.table = table->wanted->name;
        trial.name = "";
        if (!has_size(table, &judge->plant)) {
            complain("", "wrong size");
            continue;
        }
        compare_loads(model, judge, table);
        if (segment > 0)
            continue;                   /* the rest is the same in every segment */
        if (table->Phi)
            compare_Phi(model, judge, table);
        compare_inputs(model, judge, table);
        if (!quadratures[model->scheme].nodes)
            compare_defined(model, judge, table);
    }
    if (judge && segment == 0 && quadratures[model->scheme].nodes)
        compare_quadrature(model, judge, step, step->branch[which].table);
}

/* The first error that was said; warnings come before it. */
/* What was the first error */
static const char *first_error(void)
{
    const char *error = strstr(diagnostics(), ": error: ");
    return error ? first_line(error + 2) : "no reason was given";
}

/* A step is refused rightly if e^{A h}, or what a load or an input gives, is beyond the range. */
static void check_refusal(const struct model *model)
{
    const char *said = first_error();
    bool overflow = false;
    mpq_t one;
    mpfi_t x;
    mpq_init(one);
    mpq_set_ui(one, 1, 1);
    mpfi_init2(x, 256);
    for (int k = 0; k < model->schedule.operators; k++)
        for (int s = 0; s < model->system.segments; s++) {
            struct judge *judge = judge_of(model, k, s);
            const evaluator_enclosure *E = judge ? enclosure(judge, moment_at(judge, one), 0) : NULL;
            for (size_t i = 0; E && i < judge->plant.states * judge->plant.size; i++) {
                mpfi_set_ui(x, 0);
                add_entry(x, E, i, one);
                overflow =
                    overflow || isinf(mpfr_get_d(&x->left, MPFR_RNDN)) || isinf(mpfr_get_d(&x->right, MPFR_RNDN));
            }
        }
    if (!overflow || !strstr(said, "is beyond the range of double"))
        complain("", said);
    trial.compared++;
    trial.refused++;
    mpq_clear(one);
    mpfi_clear(x);
}

static struct model *model_of(const char *scheme)
{
    const struct request request = { .scheme = scheme, .loads_left = trial.loads_left };
    struct model *model = model_build(spec_of(trial.path, trial.spec), &request);
    if (!model)
        complain("not accepted: ", first_error());
    else if (model->remainder.force_columns == 0)
        complain("", "there is no remainder");
    return model && model->remainder.force_columns ? model : NULL;
}

static void try_scheme(const char *scheme, bool loads_left)
{
    trial.scheme = scheme;
    trial.loads_left = loads_left;
    trial.table = "none";
    trial.name = "";
    const struct model *model = model_of(scheme);
    if (!model)
        return;
    if (model->schedule.operators > OPERATORS || model->system.segments > SEGMENTS)
        abort();
    const clock_t start = clock();
    const struct step *step = step_build(model);
    const clock_t built = clock();
    if (!step) {
        check_refusal(model);
        return;
    }
    for (int k = 0; k < model->schedule.operators; k++)
        check_tables(model, step, step->branch[k].table);
    for (int k = 0; k < model->schedule.operators; k++)
        for (int s = 0; s < model->system.segments; s++)
            compare_segment(model, step, k, s);
    if (verbose)
        printf("# %s%s: generator %.2f s, judge %.2f s\n", scheme, loads_left ? ", loads left" : "",
               (double)(built - start) / CLOCKS_PER_SEC, (double)(clock() - built) / CLOCKS_PER_SEC);
}

static int states_of(void)
{
    const struct model *model = model_of("etd1");
    return model ? model->system.states : 0;
}

/* Loads left over or not: another A has other columns.  Of a large model two schemes will do.  A refusal stays an error
 * for what follows in this process, so it ends the case; pl, whose own terms may grow where the operator does not,
 * comes last. */
static void try_spec(const char *text)
{
    static const struct { const char *scheme; bool loads_left, large;
    } tries[] = {
        { "etd1", false, false }, { "etdrk2", false, false }, { "etdrk4", false, true }, { "nc2", false, false },
        { "nc3", false, false },  { "dq4", false, false },    { "bm3", false, true },    { "etdrk4", true, false },
        { "bm3", true, false },   { "pl", false, false },
    };
    trial.spec = text;
    const bool large = states_of() > LARGE_STATES && !whole;
    for (size_t i = 0; i < sizeof tries / sizeof *tries && !trial.refused; i++)
        if (tries[i].large || !large)
            try_scheme(tries[i].scheme, tries[i].loads_left);
}

/* ---- specs that are hard ---- */

#define ONE "model m\ncoord x\ninit x = 0.3\n"
#define TWO "model m\ncoord x, y\ninit x = 0.3\n"
#define THREE "model m\ncoord x, y, z\ninit x = 0.3\n"

static const struct { const char *name, *text;
} specs[] = {
    { "undamped", ONE "x'' + 25*x + x^3 = 0\nstep 0.1\n" },
    { "undamped, two equal", TWO "x'' + 100*x + x^3 = 0\ny'' + 100*y + y^2 = 0\nstep 0.05\n" },
    { "no stiffness", ONE "x'' + sin(x) = 0\nstep 0.1\n" },
    { "no stiffness, a step that is a power of two", ONE "3*x'' + sin(x) = 7 + t\nstep 1/16\n" },
    { "rigid body",
      TWO "2*x'' + 50*(x - y) + 3*(x - y)^3 = 1\n3*y'' + 50*(y - x) + 3*(y - x)^3 = cos(4*t + 1)\nstep 0.02\n" },
    { "pole 0 four times", TWO "x'' + 0.1*y^3 = 1\ny'' = x + x^2\nstep 0.3\n" },
    { "drag alone", ONE "x'' + 3*x' + x'^3 = 2 + sin(t)\nstep 0.25\n" },
    { "coupled by velocity alone", TWO "x'' + 2*y' + x^3 = 0\ny'' - 2*x' + y^3 = 1\nstep 0.1\n" },
    { "critical damping, w h = 1", ONE "x'' + 200*x' + 10000*x + x^3 = 1 + cos(3*t)\nstep 0.01\n" },
    { "critical damping, w h/2 = 1", ONE "x'' + 200*x' + 10000*x + x^3 = 1\nstep 0.02\n" },
    { "critical damping, w h/4 = 1", ONE "x'' + 200*x' + 10000*x + x^3 = 1\nstep 0.04\n" },
    { "defective complex pair", TWO "x'' + 2*x' + 5*x + x^3 = 0\ny'' + 2*y' + 5*y = x + sin(y)\nstep 0.1\n" },
    { "defective pair at resonance", TWO "x'' + 100*x + x^3 = cos(10*t)\ny'' + 100*y = x\nstep 0.1\n" },
    { "poles 1e-10 apart", ONE "x'' + 2.0000000001*x' + 1.0000000001*x + x^2 = 1\nstep 0.1\n" },
    { "poles 1e-30 apart, as those of the load", ONE
      "x'' + 2.000000000000000000000000000001*x' + 1.000000000000000000000000000001*x + x^2 = exp(-t)\nstep 0.1\n" },
    { "complex pairs 1e-10 apart",
      TWO "x'' + 100*x + x^3 = 0\ny'' + 100.000000002*y + 1e-3*x*y = 1e-3*x + cos(10*t)\nstep 0.05\n" },
    { "poles -1 and -2: e^{-h} twice, and e^{-2 h/2}", ONE "x'' + 3*x' + 2*x + x^3 = 0\nstep 0.5\n" },
    { "stiff: mu = 1e6", ONE "x'' - 1e6*(1 - x^2)*x' + x = 0\noperator at x = 2, x' = 0\nstep 0.01\n" },
    { "stiff: mu = 1e6, the linear terms grow", ONE "x'' - 1e6*(1 - x^2)*x' + x = 0\nstep 1e-4\n" },
    { "stiff: 1e8 beside 1", TWO "x'' + 1e8*x + x^3 = 0\ny'' + 1e-4*y' + y + (y - x)^3 = 0\nstep 0.01\n" },
    { "a step of 1e-12", TWO "x'' + 25*x + x^3 - 3*y = sin(7*t)\ny'' + 0.3*y' + 4*y - 2*x = 0\nstep 1e-12\n" },
    { "a step of 1000", TWO "x'' + 25*x + 0.001*x' + x^3 - 3*y = sin(7*t)\ny'' + 0.3*y' + 4*y - 2*x = 0\nstep 1000\n" },
    { "first order", ONE "x' + 3*x + x^3 = cos(t)\nstep 0.1\n" },
    { "first order, pole 0", ONE "x' + x^3 = 1\nstep 0.1\n" },
    { "first order, three in a row", THREE "x' + x + x^2 = 0\n2*y' + y = x\nz' + z/2 - z*x = y\nstep 0.1\n" },
    { "first order beside a mass",
      "model m\ncoord x, f, T\ninit x = 0.1, f = 0.5, T = 0.3\n2*x'' + 30*x + f = 3*cos(4*t)\n"
      "f'/50 + f/4 + 0.05*f^3 = x'\n"
      "T' + 0.5*T = 0.2 + 0.1*f^2\nstep 0.02\n" },
    { "first order beside a mass, with an operator",
      "model m\ncoord x, f, T\ninit x = 0.1, f = 0.5, T = 0.3\n2*x'' + 30*x + f = 3*cos(4*t)\n"
      "f'/50 + f/4 + 0.05*f^3 = x'\n"
      "T' + 0.5*T = 0.2 + 0.1*f^2\noperator at x = 0.1, f = 0.5\nstep 0.02\n" },
    { "first order, mixed derivatives",
      TWO "3*x' + 2*y' + x + x^3 = sin(2*t)\nx' - 5*y' - y + 0.1*x*y = 0\nstep 0.1\n" },
    { "a spring shared by two equations",
      TWO "2*x'' + 30*x + 5*(x - y)^3 = 0\ny'' + 0.1*y' + 20*y - 5*(x - y)^3 = 0\nstep 0.02\n" },
    { "shared inertia",
      TWO "2*x'' + 0.5*y'' + 0.1*x' + 0.4*(x' - y')^3 + 30*x + 5*(x - y)^3 = sin(3*t)\n"
          "0.5*x'' + y'' + 0.2*y' - 0.4*(x' - y')^3 + 20*y - 5*(x - y)^3 + 0.3*x*y' = 0\nstep 0.02\n" },
    { "shared inertia, with an operator", TWO
      "2*x'' + 0.5*y'' + 0.1*x' + 0.4*(x' - y')^3 + 30*x + 5*(x - y)^3 = sin(3*t)\n"
      "0.5*x'' + y'' + 0.2*y' - 0.4*(x' - y')^3 + 20*y - 5*(x - y)^3 + 0.3*x*y' = 0\n"
      "operator at x = 0.5, y = -0.2, x' = 1, y' = 0\nstep 0.02\n" },
    { "independent blocks, coupled by the remainder alone",
      THREE "x'' + 4*x + x*y = 0\ny'' + 0.1*y' + 9*y + y*z = cos(2*t)\nz' + z = x^2\nstep 0.1\n" },
    { "independent blocks, one without a remainder",
      TWO "x'' + 4*x + x^3 = sin(t)\ny'' + 0.2*y' + 9*y = cos(2*t)\nstep 0.1\n" },
    { "one drives the other", TWO "x'' + 4*x + x^3 = 0\ny'' + 0.2*y' + 9*y = x\nstep 0.1\n" },
    { "a load that changes its formula",
      ONE "x'' + 0.2*x' + 4*x + x^3 = (t < 0.605 ? 10*sin(pi*t/0.605) : 0)\nstep 0.01\n" },
    { "loads in three segments of time", TWO
      "x'' + 0.2*x' + 4*x - y + x^3 = (t < 0.3 ? 2*t : t < 1 ? exp(-t) : cos(5*t))\ny'' + 9*y - x + y^3 = 1\n"
      "step 0.05\n" },
    { "powers, growths and waves",
      ONE "x'' + 0.2*x' + 4*x + x^3 = t^3 + t*exp(-0.2*t)*cos(2*t + 0.3) + exp(0.1*t) - 2\nstep 0.05\n" },
    { "waves that the remainder alone reads",
      TWO "x'' + x + x*cos(3*t) = 0\ny'' + 2*y - x + sin(y*exp(-t)) = 0\nstep 0.1\n" },
    { "held inputs",
      "model m\ncoord x, y\ninput u, v\ninit x = 0.3\n1.5*x'' + 0.3*x' + 40*x + 200*x^3 - 10*y = 2*u - v\n"
      "y'' + 0.2*y' + 25*y - 10*x + 30*(y - x)^3 = 3*v + 0.5*u + 0.2*u*y*y'\nstep 0.02\n" },
    { "ramped inputs and their slopes",
      "model m\ncoord x, y\ninput u hold first, v hold first\ninit x = 0.1\n"
      "20*x'' + 0.3*(x' - u') + 400*(x - u) + 2000*(x - u)^3 + 90*(x - y) = 0\n"
      "y'' + 0.2*(y' - v') + 25*(y - v) + 9*(y - x) + 0.1*u'*y^2 = 0.5*u\nstep 0.02\n" },
    { "a ramp on a free mass",
      "model m\ncoord x\ninput u hold first\ninit x = 0.1\n3*x'' + sin(x) = u + 0.1*u'\nstep 0.3\n" },
    { "held beside ramped, and a first order",
      "model m\ncoord x, T\ninput u\ninput v hold first\ninit x = 0.1\nx'' + 3*x + T*x = u - 2*v\n"
      "T' + 0.1*T + x*T = v + v'\nstep 0.1\n" },
    { "a bank of three",
      TWO "let w = 6*(1 - exp(-t))\nlet a = 6*exp(-t)\nx'' + 0.1*x' + (40 - w^2)*x - 2*w*y' - a*y = 0\n"
          "y'' + 0.1*y' + (60 - w^2)*y + 2*w*x' + a*x = 3*cos(2*t)\noperator at w = 0, 2, 4\nstep 0.02\n" },
    { "a bank through a repeated pole",
      ONE "x'' + 2*x' + (1 + t)*x = 1\noperator at t = -0.1, 0, 0.1, 1e-10 + 0.2\nstep 0.1\n" },
    { "seven coordinates, every one with a spring",
      "model m\ncoord q[7]\ninit q[1] = 0.3\n"
      "q[1]'' + 20*q[1] - 10*q[2] + q[1]^3 = cos(3*t)\nq[2]'' + 20*q[2] - 10*q[1] - 10*q[3] + q[2]^3 = 0\n"
      "q[3]'' + 20*q[3] - 10*q[2] - 10*q[4] + q[3]^3 = 0\nq[4]'' + 20*q[4] - 10*q[3] - 10*q[5] + q[4]^3 = 0\n"
      "q[5]'' + 20*q[5] - 10*q[4] - 10*q[6] + q[5]^3 = 0\nq[6]'' + 20*q[6] - 10*q[5] - 10*q[7] + q[6]^3 = 0\n"
      "q[7]'' + 10*q[7] - 10*q[6] + q[7]^3 = 1\nstep 0.1\n" },
    { "seven coordinates, free, held and ramped inputs",
      "model m\ncoord q[7]\ninput u\ninput v hold first\n"
      "q[1]'' + 10*q[1] - 10*q[2] + (q[1] - q[2])^3 = u\nq[2]'' + 20*q[2] - 10*q[1] - 10*q[3] - (q[1] - q[2])^3 = 0\n"
      "q[3]'' + 20*q[3] - 10*q[2] - 10*q[4] = v + v'\nq[4]'' + 20*q[4] - 10*q[3] - 10*q[5] = (t < 0.33 ? t : 0)\n"
      "q[5]'' + 20*q[5] - 10*q[4] - 10*q[6] = 0\nq[6]'' + 20*q[6] - 10*q[5] - 10*q[7] = 0\n"
      "q[7]'' + 10*q[7] - 10*q[6] = 1\nstep 0.1\n" },
};
enum { SPECS = sizeof specs / sizeof *specs };

/* ---- random models: linear ones with springs, dampers and products added ---- */

/* 1 to 9 digits times 10^(low..high) */
static char *number(int low, int high)
{
    return format("%u.%0*ue%d", 1 + below(9), 1 + (int)below(8), below(10),
                  low + (int)below((unsigned)(high - low) + 1));
}

/* A force between i and j, or on i alone: `force` adds to the equations that stand there. */
static char *nonlinear_force(unsigned i, unsigned j)
{
    char *k = number(-2, 2);
    if (i == j)
        return chance(60) ? format("force -%s*x%u^3 on x%u\n", k, i, i) : format("force %s*sin(x%u) on x%u\n", k, i, i);
    if (chance(20))
        return format("force %s*x%u*x%u on x%u\n", k, i, j, i);
    return format("force -%s*(x%u - x%u)^3 on x%u\nforce %s*(x%u - x%u)^3 on x%u\n", k, i, j, i, k, i, j, j);
}

static char *remainders(unsigned n)
{
    char *text = "";
    for (unsigned k = 1 + below(n); k; k--)
        text = format("%s%s", text, nonlinear_force(1 + below(n), 1 + below(n)));
    return text;
}

static char *operator_at(unsigned n)
{
    char *text = format("operator at x1 = %s", number(-2, 0));
    for (unsigned i = 2; i <= n; i++)
        if (chance(60))
            text = format("%s, x%u = %s", text, i, number(-2, 0));
    return format("%s\n", text);
}

/* random_spec, whose last line is the step: another one, since e^{1e3 growth} has a limit and --step is no part of what
 * is shown */
static char *random_text(uint64_t seed)
{
    const char *linear = random_spec(seed), *step = strstr(linear, "\nstep ");
    unsigned n = 1;
    random_state = seed * UINT64_C(0x9e3779b97f4a7c15) + 5;
    below(2);
    while (strstr(linear, format(", x%u", n + 1)))
        n++;
    char *text = format("%.*s\n%s", (int)(step - linear), linear, remainders(n));
    return format("%s%sstep %s\n", text, chance(40) ? operator_at(n) : "", number(chance(10) ? -9 : -3, -1));
}

/* A chain of 7 or 8, beyond the residues, free or held, damped or not, with a load and an input */
static char *large_text(uint64_t seed)
{
    random_state = seed * UINT64_C(0xd1342543de82ef95) + 11;
    below(2);
    const unsigned n = 7 + below(2), first = chance(30) ? 1 + below(n) : 0;
    const bool damped = chance(50), free_ends = chance(40), ramp = chance(40), load = chance(60);
    char *text = "model made\ncoord x1";
    for (unsigned i = 2; i <= n; i++)
        text = format("%s, x%u", text, i);
    text = format("%s\n%s", text, ramp ? "input v hold first\n" : "");
    for (unsigned i = 1; i <= n; i++)
        text = format("%s%s*x%u%s = %s%s\n", text, number(-1, 1), i, i == first ? "'" : "''",
                      load && i == 1 ? "3*cos(2*t)" : "0", ramp && i == n ? " + 2*v - v'" : "");
    for (unsigned i = 1; i < n; i++) {
        text = format("%sspring %s between x%u, x%u\n", text, number(0, 2), i, i + 1);
        text = format("%s%s", text, damped ? format("damper %s between x%u, x%u\n", number(-2, 0), i, i + 1) : "");
    }
    text = format("%s%s%s", text, free_ends ? "" : "spring 3 between x1, ground\n", remainders(n));
    return format("%s%sstep %s\n", text, chance(40) ? operator_at(n) : "", number(-3, -1));
}

/* ---- the whole ---- */

static bool try_case(void *text)
{
    setrlimit(RLIMIT_AS, &(struct rlimit){ LARGEST_CASE, LARGEST_CASE });
    try_spec(text);
    if (trial.failed)
        show_spec(trial.spec);
    if (trial.failed > MISMATCHES_SHOWN)
        printf("# %d failures in all\n", trial.failed);
    if (trial.compared == 0)
        puts("# nothing was compared");
    if (verbose)
        printf("# %d numbers compared in %.2f s; steps refused %d, too small to be told from 0: %d\n", trial.compared,
               (double)clock() / CLOCKS_PER_SEC, trial.refused, trial.unsettled);
    return !trial.failed && trial.compared > 0;
}

static void run(const char *name, const char *path, const char *text)
{
    trial.path = path;
    run_case(name, LONGEST_CASE, try_case, (void *)text);
}

int main(int argc, char **argv)
{
    unsigned long random_count = 80, large_count = 5, every = 1, seed = 1;
    for (int option; (option = getopt(argc, argv, "n:l:e:s:wv")) != -1;) {
        if (option == 'n')
            random_count = strtoul(optarg, NULL, 10);
        else if (option == 'l')
            large_count = strtoul(optarg, NULL, 10);
        else if (option == 'e')
            every = strtoul(optarg, NULL, 10);
        else if (option == 's')
            seed = strtoul(optarg, NULL, 10);
        else if (option == 'w')
            whole = true;
        else if (option == 'v')
            verbose = true;
        else
            return 2;
    }
    memory_open();
    printf("1..%lu\n", (unsigned long)(argc - optind) + (SPECS + every - 1) / every + random_count + large_count);
    for (int i = optind; i < argc; i++)
        run(base_name(argv[i]), argv[i], read_text(argv[i]));
    for (unsigned long i = 0; i < SPECS; i += every)
        run(specs[i].name, "spec", specs[i].text);
    for (unsigned long i = 0; i < random_count; i++)
        run(format("random model %lu", seed + i), "spec", random_text(seed + i));
    for (unsigned long i = 0; i < large_count; i++)
        run(format("large random model %lu", seed + i), "spec", large_text(seed + i));
    memory_close();
    return cases_failed() > 0;
}
