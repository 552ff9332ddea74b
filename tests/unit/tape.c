/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tapes by hand: their invariants, values at two precisions, derivatives beside differences in MPFR, their C. */
#include "tape/tape.h"

#include <math.h>
#include <setjmp.h>
#include <stdarg.h>
#include <stddef.h>
#include <stdlib.h>
#include <string.h>

#include <cmocka.h>

#include "draw.h"

enum { BITS = 300, OPERANDS = 3 };

/* ---- operands: the coordinates x0, x1, x2 ---- */

struct point {
	mpfr_t x[OPERANDS];
};

static void wide_operand(const void *context, const struct tape_node *n, mpfr_ptr value)
{
	mpfr_set(value, ((const struct point *)context)->x[n->index], MPFR_RNDN);
}

static void point_init(struct point *p)
{
	static const double at[OPERANDS] = { 0.3, 0.7, -1.25 };
	for (int i = 0; i < OPERANDS; i++) {
		mpfr_init2(p->x[i], BITS);
		mpfr_set_d(p->x[i], at[i], MPFR_RNDN);
	}
}

static void run_wide(const struct tape *t, const struct point *p, tape_ref ref, mpfr_ptr value)
{
	struct tape_values from = { wide_operand, p };
	int length = tape_length(t);
	mpfr_t *all = ARRAY(mpfr_t, (size_t)length);
	for (int i = 0; i < length; i++)
		mpfr_init2(all[i], BITS);
	tape_run_mpfr(t, &from, all);
	mpfr_set(value, all[ref], MPFR_RNDN);
	for (int i = 0; i < length; i++)
		mpfr_clear(all[i]);
}

static tape_ref x(struct tape *t, int index)
{
	return tape_operand(t, TAPE_COORD, index, 0);
}

/* (f(x + d) - f(x - d)) / 2d: with d = 2^-90 as good as 1e-50 */
static double difference(const struct tape *t, tape_ref ref, int index)
{
	struct point p;
	mpfr_t above, below, d;
	mpfr_inits2(BITS, above, below, d, NULL);
	mpfr_set_ui_2exp(d, 1, -90, MPFR_RNDN);
	point_init(&p);
	mpfr_add(p.x[index], p.x[index], d, MPFR_RNDN);
	run_wide(t, &p, ref, above);
	mpfr_sub(p.x[index], p.x[index], d, MPFR_RNDN);
	mpfr_sub(p.x[index], p.x[index], d, MPFR_RNDN);
	run_wide(t, &p, ref, below);
	mpfr_sub(above, above, below, MPFR_RNDN);
	mpfr_div(above, above, d, MPFR_RNDN);
	mpfr_div_2ui(above, above, 1, MPFR_RNDN);
	return mpfr_get_d(above, MPFR_RNDN);
}

static double value_at(const struct tape *t, tape_ref ref)
{
	struct point p;
	mpfr_t value;
	point_init(&p);
	mpfr_init2(value, BITS);
	run_wide(t, &p, ref, value);
	return mpfr_get_d(value, MPFR_RNDN);
}

static void assert_near(const char *what, double got, double wanted)
{
	if (!(fabs(got - wanted) <= 4e-16 * fmax(fabs(wanted), 1e-3)))
		fail_msg("%s: %.17g, and by differences %.17g", what, got, wanted);
}

static void check_slopes(const char *what, struct tape *t, tape_ref ref)
{
	tape_ref slope[OPERANDS];
	tape_reverse(t, ref, TAPE_COORD, OPERANDS, slope);
	for (int i = 0; i < OPERANDS; i++) {
		double wanted = difference(t, ref, i);
		assert_near(what, value_at(t, tape_forward(t, ref, TAPE_COORD, i, 0)), wanted);
		assert_near(what, value_at(t, slope[i]), wanted);
	}
	assert_null(tape_check(t));
}

/* ---- derivatives ---- */

static void tape_slopes_of_functions(void **state)
{
	static const enum function of[] = { FN_SIN, FN_COS, FN_TAN, FN_EXP, FN_LOG, FN_SQRT, FN_SINH, FN_COSH, FN_TANH,
					    FN_ASIN, FN_ACOS, FN_ATAN };
	for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
		struct tape *t = tape_new();
		check_slopes(function_name(of[i]), t,
			     tape_call(t, of[i], tape_binary(t, TAPE_MUL, x(t, 0), x(t, 1))));
	}
	(void)state;
}

static void tape_slopes_of_operations(void **state)
{
	static const enum tape_op of[] = { TAPE_ADD, TAPE_MUL, TAPE_DIV, TAPE_POWER, TAPE_ATAN2 };
	for (size_t i = 0; i < sizeof of / sizeof *of; i++) {
		struct tape *t = tape_new();
		tape_ref a = tape_binary(t, TAPE_MUL, x(t, 0), x(t, 1)), b = tape_binary(t, TAPE_ADD, x(t, 1), x(t, 2));
		tape_ref c = tape_binary(t, of[i], a, b);
		check_slopes("an operation", t, tape_binary(t, TAPE_MUL, c, tape_unary(t, TAPE_NEG, c)));
		check_slopes("accumulated", t, tape_binary(t, TAPE_MUL, tape_accumulate(t, a, b, c, 0, 0), c));
	}
	(void)state;
}

static void tape_slopes_of_choices(void **state)
{
	for (int turned = 0; turned < 2; turned++) {
		struct tape *t = tape_new();
		tape_ref less = tape_compare(t, turned ? CMP_GT : CMP_LT, x(t, 0), x(t, 1));
		tape_ref cube = tape_power(t, x(t, 2), 3), size = tape_unary(t, TAPE_SIZE, x(t, 2));
		check_slopes("a choice", t, tape_select(t, less, tape_binary(t, TAPE_MUL, cube, x(t, 0)), size));
	}
	(void)state;
}

/* One sweep backwards makes fewer nodes than one forward for each operand. */
static void tape_reverse_is_short(void **state)
{
	enum { MANY = 40 };
	struct tape *forward = tape_new(), *reverse = tape_new();
	struct tape *both[] = { forward, reverse };
	tape_ref product[2], slope[MANY];
	for (int k = 0; k < 2; k++) {
		product[k] = x(both[k], 0);
		for (int i = 1; i < MANY; i++)
			product[k] = tape_binary(both[k], TAPE_MUL, product[k], x(both[k], i));
	}
	int before = tape_length(reverse);
	for (int i = 0; i < MANY; i++)
		tape_forward(forward, product[0], TAPE_COORD, i, 0);
	tape_reverse(reverse, product[1], TAPE_COORD, MANY, slope);
	assert_in_range(tape_length(reverse) - before, 1, 4 * MANY);
	assert_true(tape_length(forward) - before > 10 * MANY);
	(void)state;
}

/* ---- values ---- */

static void tape_values_agree(void **state)
{
	struct tape *t = tape_new();
	tape_ref term[5];
	for (int i = 0; i < 5; i++)
		term[i] = tape_binary(t, TAPE_MUL, tape_power(t, x(t, i % 3), (unsigned)i + 1), tape_number(t, i - 2));
	tape_ref sum = tape_sum(t, 5, term);
	tape_ref sign = tape_accumulate(t, sum, tape_unary(t, TAPE_SIGN, x(t, 2)), tape_scaled(t, 0.5, x(t, 0)), 0, 0);
	double wanted = -2 * 0.3 - 0.7 * 0.7 + 0.3 * 0.3 * 0.3 * 0.3 + 2 * pow(0.7, 5) - 1 + 0.15;
	assert_near("by MPFR", value_at(t, sign), wanted);
	(void)state;
}

/* What is not chosen may be undefined; what an undefined condition chooses is not defined. */
static void tape_undefined(void **state)
{
	struct tape *t = tape_new();
	tape_ref log = tape_call(t, FN_LOG, x(t, 2)), positive = tape_compare(t, CMP_GT, x(t, 2), tape_number(t, 0));
	tape_ref safe = tape_select(t, positive, log, x(t, 0));
	tape_ref above = tape_compare(t, CMP_GT, log, x(t, 0)), lost = tape_select(t, above, x(t, 0), x(t, 1));
	tape_ref turned = tape_select(t, tape_unary(t, TAPE_NOT, above), x(t, 0), x(t, 1));
	assert_true(value_at(t, safe) == 0.3);
	assert_true(isnan(value_at(t, lost)));
	assert_true(isnan(value_at(t, turned)));
	(void)state;
}

/* ---- nodes ---- */

static void tape_makes_each_once(void **state)
{
	struct tape *t = tape_new();
	tape_ref a = tape_binary(t, TAPE_ADD, x(t, 0), tape_number(t, 2));
	int length = tape_length(t);
	assert_int_equal(tape_binary(t, TAPE_ADD, x(t, 0), tape_number(t, 2)), a);
	assert_int_equal(tape_unary(t, TAPE_NEG, tape_unary(t, TAPE_NEG, a)), a);
	assert_int_equal(tape_length(t), length + 1);
	for (int i = 0; i < 3000; i++)          /* more than there are buckets */
		tape_number(t, i % 1500);
	assert_int_equal(tape_length(t), length + 1 + 1499);
	assert_null(tape_check(t));
	(void)state;
}

static void tape_check_notices(void **state)
{
	struct tape *t = tape_new();
	tape_ref less = tape_compare(t, CMP_LT, x(t, 0), x(t, 1));
	tape_binary(t, TAPE_ADD, less, x(t, 0));
	assert_non_null(tape_check(t));         /* a condition is no number */
	t = tape_new();
	tape_select(t, x(t, 0), x(t, 1), x(t, 2));
	assert_non_null(tape_check(t));         /* nor a number a condition */
	t = tape_new();
	tape_set(t, "y", tape_compare(t, CMP_LT, x(t, 0), x(t, 1)), 4, NULL);
	assert_non_null(tape_check(t));
	(void)state;
}

static void tape_counts_what_lives(void **state)
{
	struct tape *t = tape_new();
	tape_ref product = tape_binary(t, TAPE_MUL, x(t, 0), x(t, 1)), sine = tape_call(t, FN_SIN, product);
	tape_binary(t, TAPE_DIV, sine, x(t, 2));        /* nothing reads it */
	tape_ref half = tape_scaled(t, 0.5, x(t, 0));   /* is made anew where it is read */
	tape_set(t, "y", tape_binary(t, TAPE_ADD, sine, product), 4, NULL);
	tape_set(t, "z", tape_binary(t, TAPE_ADD, half, tape_binary(t, TAPE_ADD, half, x(t, 1))), 4, NULL);
	struct tape_cost cost = tape_cost(t);
	assert_int_equal(cost.multiplications, 3);
	assert_int_equal(cost.additions, 3);
	assert_int_equal(cost.divisions, 0);
	assert_int_equal(cost.calls, 1);
	assert_true(tape_reads(t, TAPE_COORD, 1, 0));
	assert_false(tape_reads(t, TAPE_COORD, 2, 0));
	(void)state;
}

/* ---- text ---- */

static const char *number_text(const void *context, mpq_srcptr value)
{
	(void)context;
	return shortest(round_rational(value));
}

static const char *name_text(const void *context, const struct tape_node *n)
{
	(void)context;
	return n->op == TAPE_ABOVE	  ? format("above[%d]", n->index)
	       : n->op == TAPE_ACCUMULATE ? format("rest[%d]", n->index)
					  : format("x%d", n->index);
}

static const struct tape_target c_text = { .real = "double", .number = number_text, .operand = name_text,
					  .size = "fabs", .accumulate = "accumulate", .indent = 4 };

static void assert_text_of(const struct tape_target *target, const struct tape *t, const char *wanted)
{
	char *text = NULL;
	size_t length;
	FILE *to = open_memstream(&text, &length);
	tape_print(t, target, to);
	fclose(to);
	assert_string_equal(text, wanted);
	free(text);
}

static void assert_text(const struct tape *t, const char *wanted)
{
	assert_text_of(&c_text, t, wanted);
}

static void tape_text_of_sums(void **state)
{
	struct tape *t = tape_new();
	tape_ref twice = tape_binary(t, TAPE_MUL, tape_number(t, -2), x(t, 1));
	tape_ref term[] = { x(t, 0), twice, tape_unary(t, TAPE_NEG, x(t, 2)) };
	tape_set(t, "y", tape_sum(t, 3, term), 4, "a sum");
	tape_set(t, "z", tape_unary(t, TAPE_NEG, twice), 4, NULL);
	assert_text(t, "    y = x0 - 2.0 * x1 - x2;  /* a sum */\n"
		       "    z = -(-2.0 * x1);\n");
	(void)state;
}

static void tape_text_of_locals(void **state)
{
	struct tape *t = tape_new();
	tape_ref sine = tape_call(t, FN_SIN, x(t, 0)), sum = tape_binary(t, TAPE_ADD, sine, x(t, 1));
	tape_name(t, sum, "push");
	tape_set(t, "y", tape_binary(t, TAPE_MUL, sine, sine), 4, NULL);
	tape_set(t, "z", tape_binary(t, TAPE_DIV, x(t, 2), tape_binary(t, TAPE_MUL, x(t, 1), x(t, 1))), 4, NULL);
	tape_set(t, "w", tape_select(t, tape_compare(t, CMP_GT, sum, tape_number(t, 0)), sum, tape_number(t, 0)), 4,
		 NULL);
	assert_text(t, "    const double part1 = sin(x0);\n"
		       "    y = part1 * part1;\n"
		       "    z = x2 / (x1 * x1);\n"
		       "    const double push = part1 + x1;\n"
		       "    w = (push > 0.0 ? push : 0.0);\n");
	(void)state;
}

static void tape_text_of_choices(void **state)
{
	struct tape *t = tape_new();
	tape_ref above = tape_operand(t, TAPE_ABOVE, 1, 0);
	tape_set(t, "y", tape_select(t, tape_unary(t, TAPE_NOT, above), x(t, 0), tape_unary(t, TAPE_SIZE, x(t, 1))), 4,
		 NULL);
	tape_set(t, "z", tape_unary(t, TAPE_SIGN, tape_binary(t, TAPE_ADD, x(t, 0), x(t, 1))), 4, NULL);
	assert_text(t, "    y = (!(above[1]) ? x0 : fabs(x1));\n"
		       "    const double part1 = x0 + x1;\n"
		       "    z = (double)((part1 > 0.0) - (part1 < 0.0));\n");
	(void)state;
}

static bool first_varies(const void *context, const struct tape_node *n)
{
	(void)context;
	return n->index == 0;
}

/* Of x0 there is one a lane; what all share is widened where it is set or accumulated. */
static void tape_text_of_lanes(void **state)
{
	static const struct tape_lanes lanes = { "wide", "all", "each_", first_varies };
	struct tape_target target = c_text;
	target.lanes = &lanes;
	struct tape *t = tape_new();
	tape_ref shared = tape_binary(t, TAPE_MUL, x(t, 1), x(t, 2)), own = tape_binary(t, TAPE_ADD, x(t, 0), shared);
	tape_set(t, "y", tape_accumulate(t, own, shared, tape_number(t, 0), 3, 0), 6, NULL);
	tape_set(t, "z", tape_scaled(t, -1, shared), 4, NULL);
	tape_set(t, "w", tape_scaled(t, 0.5, own), 4, NULL);
	assert_text_of(&target, t, "    const double part1 = x1 * x2;\n"
				   "    const wide part2 = x0 + part1;\n"
				   "    y = accumulate(part2, all(part1), all(0.0), &rest[3]);\n"
				   "    z = all(-part1);\n"
				   "    w = 0.5 * part2;\n");
	(void)state;
}

/* Operands of a place: as they are read, by arrays */
static const char *place_name(const void *context, const struct tape_node *n)
{
	(void)context;
	return format("y[%d]", n->index);
}

#define LOOP(tables, turn) \
	"    {\n" tables "        for (turn_by_0 = 0; turn_by_0 < 5; turn_by_0++) {\n" \
	"            " turn "\n        }\n    }\n"

/* What waits for nothing of one another and has one shape is a loop; numbers and places that differ are tables. */
static void tape_text_of_loops(void **state)
{
	static const int weight[] = { 2, 3, 5, -7, 11 }, other[] = { 3, 1, 4, 6, 5 };
	struct tape_target target = c_text;
	target.operand = place_name;
	target.rolls = 20;
	struct tape *t = tape_new();
	for (int i = 0; i < 5; i++) {
		tape_ref sine = tape_call(t, FN_SIN, x(t, 2 * i)), turn = tape_binary(t, TAPE_MUL, sine, x(t, 7));
		tape_ref product = tape_binary(t, TAPE_MUL, turn, tape_call(t, FN_COS, x(t, other[i])));
		tape_set(t, format("m[%d][2]", i), tape_scaled(t, weight[i], product), 4, NULL);
		tape_set(t, format("m[2][%d]", 10 + other[i]), tape_binary(t, TAPE_ADD, product, turn), 4, NULL);
	}
	tape_set(t, "last", tape_binary(t, TAPE_DIV, x(t, 1), tape_number(t, -3)), 4, NULL);
	tape_statement(t, "again();");
	tape_set(t, "m[0][0]", tape_call(t, FN_SIN, x(t, 0)), 4, NULL);
	assert_text_of(&target, t, "    double values_by_0[15];\n"
				   "    size_t turn_by_0;\n"
				   LOOP("", "values_by_0[turn_by_0] = sin(y[2 * turn_by_0]);")
				   LOOP("        static const short place_by_0[5] = {3, 1, 4, 6, 5};\n",
					"values_by_0[5 + turn_by_0] = cos(y[place_by_0[turn_by_0]]);")
				   LOOP("", "values_by_0[10 + turn_by_0] = values_by_0[turn_by_0] * y[7];")
				   LOOP("        static const double number_by_0[5] = {2.0, 3.0, 5.0, -7.0, 11.0};\n",
					"m[turn_by_0][2] = number_by_0[turn_by_0] * values_by_0[turn_by_0] * y[7] *\n"
					"                values_by_0[5 + turn_by_0];")
				   LOOP("        static const short place_by_0[5] = {13, 11, 14, 16, 15};\n",
					"m[2][place_by_0[turn_by_0]] = values_by_0[10 + turn_by_0] * "
					"values_by_0[5 + turn_by_0] +\n"
					"                values_by_0[10 + turn_by_0];")
				   "    last = y[1] / (-3.0);\n"
				   "    again();\n"
				   "    m[0][0] = values_by_0[0];\n");
	(void)state;
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(tape_slopes_of_functions), cmocka_unit_test(tape_slopes_of_operations),
		cmocka_unit_test(tape_slopes_of_choices),   cmocka_unit_test(tape_reverse_is_short),
		cmocka_unit_test(tape_values_agree),	    cmocka_unit_test(tape_undefined),
		cmocka_unit_test(tape_makes_each_once),	    cmocka_unit_test(tape_check_notices),
		cmocka_unit_test(tape_counts_what_lives),   cmocka_unit_test(tape_text_of_sums),
		cmocka_unit_test(tape_text_of_locals),	    cmocka_unit_test(tape_text_of_choices),
		cmocka_unit_test(tape_text_of_lanes),	    cmocka_unit_test(tape_text_of_loops),
	};
	choose_cases(argc, argv);
	memory_open();
	const int status = cmocka_run_group_tests(tests, NULL, NULL);
	memory_close();
	return status;
}
