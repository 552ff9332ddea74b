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

enum { ROWS = 4, COLUMNS = 6, PARAMS = 5, MONOMIALS = 8, TERMS = 64, OPERATIONS = MONOMIALS + 2 * TERMS };

/* Entries are sums of factors times products of params: an earlier one times a param, or divided by it; product 0 is 1.
 */
typedef struct case_of {
	pl_formulas formulas;
	pl_entries entries;
	int monomials, terms;
	struct { int from, param, divides; } monomial[MONOMIALS];
	struct { int row, column, monomial; pl_two factor; } term[TERMS];
	pl_two constant[TERMS + 1];
	pl_operation operation[OPERATIONS];
	pl_place place[TERMS];
	real params[PARAMS];
} case_of;

/* The number that it makes */
static int add_operation(case_of *c, int what, int a, int b)
{
	pl_operation *const o = c->operation + c->formulas.operations;
	o->what = (unsigned short)what;
	o->a = (unsigned short)a;
	o->b = (unsigned short)b;
	return PARAMS + c->formulas.constants + c->formulas.operations++;
}

/* Into its entry, which may have some before; sums, differences and opposites in turn */
static void add_to_entry(case_of *c, int term, int number, int negative)
{
	pl_place *p = c->place;
	for (; p < c->place + c->entries.places; p++)
		if (p->row == c->term[term].row && p->column == c->term[term].column) {
			const int differ = negative != p->negative;
			p->number = (unsigned short)add_operation(c, differ ? PL_DIFFERENCE : PL_SUM, p->number,
					number);
			return;
		}
	c->entries.places++;
	p->row = (unsigned short)c->term[term].row;
	p->column = (unsigned short)c->term[term].column;
	p->number = (unsigned short)number;
	p->negative = (unsigned short)negative;
}

static int evaluate(const case_of *c, pl_two *value, pl_two *work)
{
	const int status = pl_formulas_at(&c->formulas, c->params, work);
	return status != 0 ? status : pl_entries_at(&c->entries, &c->formulas, c->params, work, value);
}

static int equations_at(case_of *c, pl_two *value, pl_two *work)
{
	int number[MONOMIALS + 1], i;
	c->formulas.operations = c->entries.places = 0;
	c->formulas.constants = (unsigned short)(c->terms + 1);
	c->constant[0] = word_of(1.0);
	number[0] = PARAMS;
	for (i = 0; i < c->monomials; i++)
		number[i + 1] = add_operation(c, c->monomial[i].divides ? PL_QUOTIENT : PL_PRODUCT,
									  number[c->monomial[i].from],
											c->monomial[i].param);
	for (i = 0; i < c->terms; i++) {
		const pl_two factor = c->term[i].factor;
		pl_two *const constant = c->constant + i + 1;
		constant->hi = i % 2 ? -factor.hi : factor.hi;
		constant->lo = i % 2 ? -factor.lo : factor.lo;
		add_to_entry(c, i, c->term[i].monomial == 0
						   ? PARAMS + i + 1
						   : add_operation(c, PL_PRODUCT, number[c->term[i].monomial], PARAMS
								+ i + 1), i % 2);
	}
	c->formulas.constant = c->constant;
	c->formulas.operation = c->operation;
	c->entries.place = c->place;
	return evaluate(c, value, work);
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

/* Of each entry at most LOSS times the sizes of its terms */
static void assert_equations(case_of *c, const char *family)
{
	const int entries = c->entries.rows * c->entries.columns;
	mpq_t exact[ROWS * COLUMNS], sizes[ROWS * COLUMNS], monomial[MONOMIALS + 1], t;
	pl_two value[ROWS * COLUMNS], work[OPERATIONS];
	int i;
	mpq_init(t);
	for (i = 0; i < entries; i++)
		mpq_inits(exact[i], sizes[i], (mpq_ptr)0);
	for (i = 0; i <= c->monomials; i++)
		mpq_init(monomial[i]);
	mpq_set_ui(monomial[0], 1, 1);
	for (i = 0; i < c->monomials; i++) {
		mpq_set_d(t, c->params[c->monomial[i].param]);
		(c->monomial[i].divides ? mpq_div : mpq_mul)(monomial[i + 1], monomial[c->monomial[i].from], t);
	}
	for (i = 0; i < c->terms; i++) {
		const int at = c->term[i].row * c->entries.columns + c->term[i].column;
		set_fraction(t, c->term[i].factor);
		mpq_mul(t, t, monomial[c->term[i].monomial]);
		mpq_add(exact[at], exact[at], t);
		mpq_abs(t, t);
		mpq_add(sizes[at], sizes[at], t);
	}
	assert_status(equations_at(c, value, work), 0, family);
	for (i = 0; i < entries; i++) {
		const double terms = mpq_get_d(sizes[i]);
		double off;
		set_fraction(t, value[i]);
		mpq_sub(t, t, exact[i]);
		off = fabs(mpq_get_d(t));
		if (terms > 0)
			worst = worse(worst, off / terms);
		if (!(off <= LOSS * terms))
			fail_msg("%s, entry %d: found %.17g + %.17g, expected %.17g; off by %g, bound %g", family, i,
					 (double)value[i].hi, (double)value[i].lo, mpq_get_d(exact[i]), off,
							LOSS * terms);
	}
	for (i = 0; i < entries; i++)
		mpq_clears(exact[i], sizes[i], (mpq_ptr)0);
	for (i = 0; i <= c->monomials; i++)
		mpq_clear(monomial[i]);
	mpq_clear(t);
}

static void report_equations(const char *family)
{
	print_message("# %s: off by 2^%.1f of all terms at most, bound 2^%.0f\n", family, log2(worst), log2(LOSS));
	worst = 0;
}

/* No more than a term for each entry, and no monomials yet */
static void start_case(case_of *c, int rows, int columns)
{
	memset(c, 0, sizeof *c);
	c->entries.rows = (unsigned short)rows;
	c->entries.columns = (unsigned short)columns;
	c->formulas.params = PARAMS;
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
	int i, cell;
	(void)state;
	drawn = 8;
	for (i = 0; i < samples(2000); i++) {
		case_of c;
		start_case(&c, 1 + below(ROWS), 1 + below(COLUMNS));
		random_products(&c);
		for (cell = 0; cell < c.entries.rows * c.entries.columns; cell++)
			if (below(3)) {
				int terms = 1 + (c.terms < TERMS - 40 ? below(3) : 0);
				for (; terms > 0; terms--) {
					const pl_two factor = below(3)
							? about(either(scattered(1e-3, 1e3))) : word_of(either(1.0));
					put_term(&c, cell / c.entries.columns, cell % c.entries.columns,
							below(c.monomials + 1), factor);
				}
			}
		assert_equations(&c, "equations");
	}
	report_equations("equations");
}

/* m on an arm: m L^2 a + m L b = ..., m L a + m b = x. The pivot m - (m L)/(m L^2) (m L) is 0 but for rounding. */
static void singular(void **state)
{
	pl_two value[1], work[OPERATIONS];
	int n;
	(void)state;
	drawn = 12;
	for (n = 0; n < 100; n++) {
		case_of c;
		start_case(&c, 1, 1);
		c.params[0] = (real)scattered(0.1, 10.0);
		c.params[1] = (real)scattered(0.1, 10.0);
		c.formulas.constant = c.constant;
		c.formulas.operation = c.operation;
		c.entries.place = c.place;
		const int arm = add_operation(&c, PL_PRODUCT, 0, 1), square = add_operation(&c, PL_PRODUCT, arm, 1);
		const int factor = add_operation(&c, PL_QUOTIENT, arm, square);
		const int pivot = add_operation(&c, PL_DIFFERENCE, 0, add_operation(&c, PL_PRODUCT, factor, arm));
		add_operation(&c, PL_QUOTIENT, 0, pivot);
		assert_status(evaluate(&c, value, work), PL_SINGULAR, "singular but for rounding");
	}
}

static void not_finite(void **state)
{
	static const real special[] = {(real)INFINITY, (real)-INFINITY, (real)NAN};
	pl_two value[1], work[OPERATIONS];
	case_of c;
	int i, k;
	(void)state; /* (1 - p1/p2) x */
	start_case(&c, 1, 1);
	c.monomials = 2;
	c.monomial[0].param = 1;
	c.monomial[1].from = 1;
	c.monomial[1].param = 2;
	c.monomial[1].divides = 1;
	put_term(&c, 0, 0, 2, word_of(-1.0));
	put_term(&c, 0, 0, 0, word_of(1.0)); /* behind what overflows */
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
}

/* What a ramp's value before the step is multiplied with, u - u'/h: is less than two fifths of the larger left? */
static void ramps_that_cancel(void **state)
{
	static const struct {
		double u, slope;
		int cancels;
	} cases[] = {{1, 0.25, 0}, {1, 0.49, 1}, {1, 0.5, 1}, {-1, -0.45, 1}, {1, -0.5, 0}, {0.5, 0.5, 0},
			{1, 0.26, 0}};
	size_t k;
	(void)state;
	for (k = 0; k < sizeof cases / sizeof *cases; k++) {
		pl_two D[3] = {{3, 0}, {0, 0}, {0, 0}};
		int found;
		D[1].hi = (real)cases[k].u;
		D[2].hi = (real)cases[k].slope;
		found = pl_ramp_cancels(3, 1, D, 1, (real)0.5);
		if (found != cases[k].cancels)
			fail_msg("u %g, u' %g, h 0.5: %d, expected %d", cases[k].u, cases[k].slope, found,
					cases[k].cancels);
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

#define PL_SINGLE SINGLE
#define PL(name) swung_##name
#define PL_TYPE swung
#define PL_PARAMS 2
#define PL_H ((real)0.25)
#define PL_RETUNED 0
#define PL_LEADS 1
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
	cmocka_unit_test(singular),
	cmocka_unit_test(ramps_that_cancel),
	cmocka_unit_test(not_finite),
	cmocka_unit_test(held_by_an_instance))
