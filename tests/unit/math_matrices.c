/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matrices of rationals, linear systems, and numbers that are recorded by what made them: exactly. */
#include "math_cases.h"

/* ---- rational matrices ---- */

mpq_t *draw_matrix(int rows, int columns)
{
	mpq_t *A = rationals((size_t)(rows * columns));
	for (int i = 0; i < rows * columns; i++)
		if (draw(4))
			draw_fraction(A[i], 50, 9);
	return A;
}

void assert_rational(const char *what, int n, int i, int j, mpq_srcptr found, mpq_srcptr expected)
{
	if (!mpq_equal(found, expected))
		fail_msg("%s, case %d, (%d, %d): found %s, expected %s, exactly", what, n, i, j,
				mpq_get_str(NULL, 10, found),
			mpq_get_str(NULL, 10, expected));
}

/* Each entry by its sum */
static void assert_product(const char *what, int n, int rows, int inner, int columns, const mpq_t *A, const mpq_t *B,
						   const mpq_t *AB)
{
	mpq_t sum, term;
	mpq_inits(sum, term, NULL);
	for (int i = 0; i < rows; i++)
		for (int j = 0; j < columns; j++) {
			mpq_set_ui(sum, 0, 1);
			for (int k = 0; k < inner; k++) {
				mpq_mul(term, A[i * inner + k], B[k * columns + j]);
				mpq_add(sum, sum, term);
			}
			assert_rational(what, n, i, j, AB[i * columns + j], sum);
		}
	mpq_clears(sum, term, NULL);
}

mpq_t *unit_matrix(int n)
{
	mpq_t *I = rationals((size_t)(n * n));
	for (int i = 0; i < n; i++)
		mpq_set_ui(I[i * n + i], 1, 1);
	return I;
}

void matrix_products(void **state)
{
	mpq_t factor;
	mpq_init(factor);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		int rows = 1 + (int)draw(5), inner = 1 + (int)draw(5), columns = 1 + (int)draw(5);
		mpq_t *A = draw_matrix(rows, inner), *B = draw_matrix(inner, columns), *AB = draw_matrix(rows, columns);
		rational_product(rows, inner, columns, (const mpq_t *)A, (const mpq_t *)B, AB);
		assert_product("product", n, rows, inner, columns, (const mpq_t *)A, (const mpq_t *)B,
				(const mpq_t *)AB);
		/* row 0 less factor times row 1, which back gives row 0 */
		mpq_t *pair = draw_matrix(2, columns), *row = rationals((size_t)columns);
		draw_fraction(factor, 30, 7);
		for (int j = 0; j < columns; j++)
			mpq_set(row[j], pair[j]);
		rational_subtract_row(columns, row, (const mpq_t *)pair + columns, factor);
		for (int j = 0; j < columns; j++) {
			mpq_mul(AB[0], pair[columns + j], factor);
			mpq_add(AB[0], AB[0], row[j]);
			assert_rational("row and what was taken from it", n, 0, j, AB[0], pair[j]);
		}
	}
	mpq_clear(factor);
}

void matrix_inverse(void **state)
{
	int regular = 0;
	(void)state;
	for (int n = 0; n < CASES; n++) {
		int order = 1 + (int)draw(6), column;
		mpq_t *A = draw_matrix(order, order), *inverse = draw_matrix(order, order), *I = unit_matrix(order);
		if (!rational_inverse(order, (const mpq_t *)A, inverse, &column))
			continue;
		regular++;
		assert_product("A A^-1", n, order, order, order, (const mpq_t *)A, (const mpq_t *)inverse,
				(const mpq_t *)I);
		assert_product("A^-1 A", n, order, order, order, (const mpq_t *)inverse, (const mpq_t *)A,
				(const mpq_t *)I);
	}
	assert_true(regular > CASES / 2);
}

/* One column is a sum of those before, which are independent: those of a regular triangle with rows exchanged */
void matrix_free_column(void **state)
{
	mpq_t factor, term;
	mpq_inits(factor, term, NULL);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		int order = 1 + (int)draw(6), free_column = (int)draw((uint32_t)order), column = -1,
				turn = (int)draw(6);
		mpq_t *A = draw_matrix(order, order), *inverse = draw_matrix(order, order);
		for (int i = 0; i < order; i++)
			for (int j = 0; j <= i; j++)
				mpq_set_si(A[((i + turn) % order) * order + j], i == j ? 1 + (long)draw(9) : 0, 1);
		for (int i = 0; i < order; i++)
			mpq_set_ui(A[i * order + free_column], 0, 1);
		for (int j = 0; j < free_column; j++) {
			draw_fraction(factor, 9, 5);
			for (int i = 0; i < order; i++) {
				mpq_mul(term, factor, A[i * order + j]);
				mpq_add(A[i * order + free_column], A[i * order + free_column], term);
			}
		}
		if (rational_inverse(order, (const mpq_t *)A, inverse, &column) || column != free_column)
			fail_msg("case %d, order %d: free column found %d, expected %d", n, order, column, free_column);
	}
	mpq_clears(factor, term, NULL);
}

/* ---- systems: M q'' + C q' + K q = -heldC q' - heldK q holds for what the state's derivatives are ---- */

static struct linear draw_system(void)
{
	int n = 1 + (int)draw(4), column;
	struct linear shape = {
		.n = n, .states = n, .segments = 1, .velocity = ARRAY(int, (size_t)n), .coord = ARRAY(int, 8)
	};
	for (int i = 0; i < n; i++)
		shape.coord[i] = i;
	for (int i = 0; i < n; i++) {
		shape.velocity[i] = draw(3) ? shape.states : -1;
		if (shape.velocity[i] >= 0)
			shape.coord[shape.states++] = i;
	}
	struct linear s = linear_like(&shape);
	mpq_t *inverse = rationals((size_t)(n * n));
	do {
		s.C = draw_matrix(n, n);
		s.K = draw_matrix(n, n);
		s.M = draw_matrix(n, n);
		for (int i = 0; i < n * n; i++)
			if (s.velocity[i % n] < 0)
				mpq_set_ui(s.M[i], 0, 1);
	} while (!leading_inverse(&s, inverse, &column));
	s.heldC = draw_matrix(n, n);
	s.heldK = draw_matrix(n, n);
	for (int i = 0; i < n * n; i++)
		if (s.velocity[i % n] < 0)
			mpq_set_ui(s.heldC[i], 0, 1);   /* a held derivative of first order is none of the states */
	return s;
}

void add_product(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b)
{
	mpq_t term;
	mpq_init(term);
	mpq_mul(term, a, b);
	mpq_add(sum, sum, term);
	mpq_clear(term);
}

/* Row i of what the equations leave at y with its slope */
static void residual_of(const struct linear *s, int i, const mpq_t *y, const mpq_t *slope, bool held, mpq_ptr sum)
{
	mpq_set_ui(sum, 0, 1);
	for (int j = 0; j < s->n; j++) {
		int v = s->velocity[j], at = i * s->n + j;
		add_product(sum, v >= 0 ? s->M[at] : s->C[at], slope[v >= 0 ? v : j]);
		add_product(sum, held ? s->heldK[at] : s->K[at], y[j]);
		if (v >= 0)
			add_product(sum, held ? s->heldC[at] : s->C[at], y[v]);
	}
}

void matrix_of_a_state(void **state)
{
	mpq_t sum, zero;
	mpq_inits(sum, zero, NULL);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		struct linear s = draw_system();
		mpq_t *y = draw_matrix(s.states, 1), *slope = rationals((size_t)s.states);
		for (int held = 0; held < 2; held++) {
			mpq_t *A = state_matrix(&s, held);
			rational_product(s.states, s.states, 1, (const mpq_t *)A, (const mpq_t *)y, slope);
			for (int i = 0; i < s.n; i++) {
				residual_of(&s, i, (const mpq_t *)y, (const mpq_t *)slope, held, sum);
				assert_rational(held ? "held terms" : "equations", n, i, 0, sum, zero);
				if (s.velocity[i] >= 0)
					assert_rational("q' is v", n, i, 0, slope[i], held ? zero : y[s.velocity[i]]);
			}
		}
		mpq_t *A = draw_matrix(s.n, s.n), *I = unit_matrix(s.n);
		struct linear first = first_order_system(s.n, (const mpq_t *)A);
		assert_product("x' = A x", n, s.n, s.n, s.n, (const mpq_t *)A, (const mpq_t *)I,
					   (const mpq_t *)state_matrix(&first, false));
	}
	mpq_clears(sum, zero, NULL);
}

/* ---- numbers that follow from others, by what made them ---- */

enum { GIVEN = 3, MADE = 40, PLACES = 3, SIDE = 3 };

static void draw_places(mpq_t *given)
{
	for (int i = 0; i < PLACES * GIVEN; i++) {
		mpq_set_si(given[i], (draw(2) ? 1 : -1) * (1000000 + (long)draw(1000000)), 1000 + draw(1000));
		mpq_canonicalize(given[i]);
	}
}

static void part_at(const struct traced_part *part, mpq_t *value, mpq_ptr result)
{
	mpq_set(result, part->number < 0 ? part->constant : value[part->number]);
	if (part->negative)
		mpq_neg(result, result);
}

/* Of all numbers of the record, where what is given has these values; false: something there is divided by 0 */
static bool record_at(const struct traced *number, int count, const mpq_t *given, mpq_t *value)
{
	mpq_t a, b;
	mpq_inits(a, b, NULL);
	bool defined = true;
	for (int i = 0; i < count && defined; i++) {
		const struct traced *n = &number[i];
		if (n->op == TRACED_GIVEN) {
			(n->a.negative ? mpq_neg : mpq_set)(value[i], given[n->a.number]);
			continue;
		}
		part_at(&n->a, value, a);
		part_at(&n->b, value, b);
		defined = n->op != TRACED_QUOTIENT || mpq_sgn(b) != 0;
		if (defined)
			(n->op == TRACED_SUM ? mpq_add : n->op == TRACED_PRODUCT ? mpq_mul : mpq_div)(value[i], a, b);
	}
	mpq_clears(a, b, NULL);
	return defined;
}

/* Numbers made at the first place, whose record was kept, and at two others: the record gives those of the last. */
static void assert_recorded(int n, int count, const mpq_t *given, mpq_t *const made[PLACES])
{
	int numbers;
	mpq_t expected;
	mpq_init(expected);
	for (int i = 0; i < count; i++)         /* 1 over a number of the record is entered where it is asked for */
		traced_as(made[0][i], made[1][i]);
	const struct traced *record = trace_record(&numbers);
	mpq_t *value = rationals((size_t)numbers);
	if (!record_at(record, numbers, given + (PLACES - 1) * GIVEN, value))
		return;
	for (int i = 0; i < count; i++) {
		const int number = traced_as(made[0][i], made[1][i]);
		if (number < 0)
			assert_rational("a constant", n, i, 0, made[PLACES - 1][i], made[0][i]);
		if (number < 0)
			continue;
		(mpq_sgn(made[0][i]) < 0 ? mpq_neg : mpq_set)(expected, value[number]);
		assert_rational("a number of the record", n, i, 0, made[PLACES - 1][i], expected);
	}
	mpq_clear(expected);
}

struct operation { int op, a, b; mpq_t constant; };

static bool perform(const struct operation *program, const mpq_t *given, mpq_t *x)
{
	for (int k = 0; k < GIVEN; k++)
		mpq_set(x[k], given[k]);
	for (int i = GIVEN; i < MADE; i++) {
		const struct operation *o = &program[i];
		mpq_srcptr b = o->b < 0 ? o->constant : x[o->b];
		if ((o->op == 3 && mpq_sgn(b) == 0) || (o->op == 4 && mpq_sgn(x[o->a]) == 0))
			return false;
		switch (o->op) {
		case 0:  mpq_add(x[i], x[o->a], b); break;
		case 1:  mpq_sub(x[i], x[o->a], b); break;
		case 2:  mpq_mul(x[i], x[o->a], b); break;
		case 3:  mpq_div(x[i], x[o->a], b); break;
		case 4:  mpq_inv(x[i], x[o->a]); break;
		default: mpq_neg(x[i], x[o->a]);
		}
	}
	return true;
}

void record_of_programs(void **state)
{
	(void)state;
	for (int n = 0; n < 200; n++) {
		struct operation program[MADE];
		mpq_t *given = rationals(PLACES * GIVEN), *made[PLACES];
		bool defined = true;
		draw_places(given);
		for (int i = GIVEN; i < MADE; i++) {
			program[i] = (struct operation){ .op = (int)draw(6) };
			program[i].a = (int)draw((unsigned)i);
			program[i].b = (int)draw((unsigned)i + 3);
			mpq_init(program[i].constant);
			draw_fraction(program[i].constant, 5, 3);
			program[i].b = program[i].b < i ? program[i].b : -1;
			if (i > 12)             /* what they are made of stays small */
				program[i].a = (int)draw(8);
		}
		trace_from(GIVEN, given, given + GIVEN, given + GIVEN);
		for (int p = 0; p < PLACES && defined; p++) {
			made[p] = rationals(MADE);
			defined = perform(program, given + p * GIVEN, made[p]);
			trace_pause();
		}
		if (defined)
			assert_recorded(n, MADE, given, made);
	}
}

void record_of_matrices(void **state)
{
	(void)state;
	for (int n = 0; n < 40; n++) {
		mpq_t *given = rationals(PLACES * GIVEN), *made[PLACES];
		int fixed[SIDE * SIDE], column;
		bool regular = true;
		draw_places(given);
		for (int i = 0; i < SIDE * SIDE; i++)
			fixed[i] = (int)draw(6) - 3;
		trace_from(GIVEN, given, given + GIVEN, given + GIVEN);
		for (int p = 0; p < PLACES && regular; p++) {
			mpq_t *A = rationals(SIDE * SIDE);
			made[p] = rationals(2 * SIDE * SIDE);
			for (int i = 0; i < SIDE * SIDE; i++)
				if (fixed[i] < 0)
					mpq_set(A[i], given[p * GIVEN - fixed[i] - 1]);
				else
					mpq_set_si(A[i], fixed[i], 1);
			regular = rational_inverse(SIDE, A, made[p], &column);
			rational_product(SIDE, SIDE, SIDE, A, A, made[p] + SIDE * SIDE);
			trace_pause();
		}
		if (regular)
			assert_recorded(n, 2 * SIDE * SIDE, given, made);
	}
}

/* Neither what was not made by what is recorded nor what differs elsewhere is one of its numbers. */
void record_of_others(void **state)
{
	(void)state;
	mpq_t *given = rationals(PLACES * GIVEN), *other = rationals(2);
	draw_places(given);
	trace_from(GIVEN, given, given + GIVEN, given + GIVEN);
	mpz_mul(mpq_numref(other[0]), mpq_numref(given[0]), mpq_numref(given[1]));
	mpq_mul(other[1], given[0], given[1]);
	trace_pause();
	assert_int_equal(traced_as(given[0], given[GIVEN]), 0);
	assert_int_equal(traced_as(given[0], given[GIVEN + 1]), -1);
	assert_int_equal(traced_as(other[0], given[GIVEN]), -1);
	assert_int_equal(traced_as(other[1], given[GIVEN]), -1);
}
