/* SPDX-License-Identifier: MIT-0 */
/* runtime/retune.c: equations against exact fractions, ramps, and the coefficients that an instance holds. */
#include "runtime_retune.h"

/* Of an equation, in parts of all its terms */
#ifdef REAL_IS_FLOAT
#define LOSS 0x1p-43
#else
#define LOSS 0x1p-101
#endif

static double worst; /* of the family, in such parts */

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

ROOM(retune,
    cmocka_unit_test(equations),
    cmocka_unit_test(nearly_singular),
    cmocka_unit_test(singular),
    cmocka_unit_test(ramps_that_cancel),
    cmocka_unit_test(not_finite),
    cmocka_unit_test(held_by_an_instance))
