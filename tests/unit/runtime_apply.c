/* SPDX-License-Identifier: MIT-0 */
/* runtime/apply.c against MPFR, and against its documented order of sums.  Every block is as long as it says, so that
 * valgrind and the sanitizers see what is read beyond. */
#include "runtime.h"

#include <fenv.h>

/* BITS: products of numbers from 2^-WIDE to 2^WIDE and their sums, exactly */
#ifdef REAL_IS_FLOAT
enum { BITS = 500, LARGEST = 41, WIDE = 20, WIDEST = 37 };
#else
enum { BITS = 2400, LARGEST = 41, WIDE = 200, WIDEST = 300 };
#endif

/* `bits` significant bits, either sign, sizes spread over 2^-spread .. 2^spread */
static real random_number(int bits, int spread)
{
	const double m = (double)((random_word() >> (65 - bits)) | ((uint64_t)1 << (bits - 1)));
	const int e = spread ? (int)(random_word() % (uint64_t)(2 * spread + 1)) - spread : 0;
	return (real)ldexp(random_word() & 1 ? -m : m, e - bits);
}

static real *numbers(int count, int bits, int spread)
{
	real *x = (real *)malloc(sizeof *x * (size_t)count + (count == 0));
	int i;
	assert_non_null(x);
	for (i = 0; i < count; i++)
		x[i] = random_number(bits, spread);
	return x;
}

static void assert_bits(real found, real expected, const char *what, int rows, int columns, int row)
{
	if (memcmp(&found, &expected, sizeof found) != 0)
		fail_msg("%s, %d x %d, row %d: found %.17g, expected %.17g, to the last bit", what, rows, columns, row,
				found,
				 expected);
}

/* |found - (start + row x)| against the documented bound, and one more rounding where there is a start */
static void assert_row(int columns, const real *row, const real *x, const real *start, real found, int rows, int i)
{
	mpfr_t sum, term, sizes;
	double off, tolerance, expected;
	int j;
	mpfr_inits2(BITS, sum, term, sizes, (mpfr_ptr)0);
	mpfr_set_zero(sum, 1);
	mpfr_set_zero(sizes, 1);
	for (j = 0; j < columns; j++) {
		mpfr_set_d(term, row[j], MPFR_RNDN);
		mpfr_mul_d(term, term, x[j], MPFR_RNDN);
		mpfr_add(sum, sum, term, MPFR_RNDN);
		mpfr_abs(term, term, MPFR_RNDN);
		mpfr_add(sizes, sizes, term, MPFR_RNDN);
	}
	tolerance = (columns / 4.0 + 4.0) * ((double)REAL_EPSILON / 2) * mpfr_get_d(sizes, MPFR_RNDU);
	if (start) {
		mpfr_add_d(sum, sum, *start, MPFR_RNDN);
		tolerance += (double)REAL_EPSILON / 2 * fabs((double)found);
	}
	expected = mpfr_get_d(sum, MPFR_RNDN);
	mpfr_sub_d(sum, sum, found, MPFR_RNDN);
	off = fabs(mpfr_get_d(sum, MPFR_RNDA));
	mpfr_clears(sum, term, sizes, (mpfr_ptr)0);
	if (!(off <= tolerance))
		fail_msg("%d x %d, row %d: found %.17g, expected %.17g; off by %.17g, tolerance %.17g", rows, columns,
				i, found,
				 expected, off, tolerance);
}

static void check_products(int rows, int columns, int spread)
{
	real *table = numbers(rows * columns, REAL_DIGITS, spread), *x = numbers(columns, REAL_DIGITS, spread);
	real *y = numbers(rows, REAL_DIGITS, spread), *z = numbers(rows, REAL_DIGITS, spread);
	real *start = numbers(rows, REAL_DIGITS, spread);
	int i;
	memcpy(z, start, sizeof *z * (size_t)rows);
	pl_multiply(rows, columns, table, x, y);
	pl_multiply_add(rows, columns, table, x, z);
	for (i = 0; i < rows; i++) {
		assert_row(columns, table + i * columns, x, NULL, y[i], rows, i);
		assert_row(columns, table + i * columns, x, &start[i], z[i], rows, i);
		assert_bits(z[i], start[i] + y[i], "y + product", rows, columns, i);
	}
	free(table);
	free(x);
	free(y);
	free(z);
	free(start);
}

static void products(void **state)
{
	static const int spreads[] = {0, 3, WIDE / 7, WIDE};
	int rows, columns;
	(void)state;
	for (rows = 1; rows <= LARGEST; rows += rows < 9 ? 1 : 8)
		for (columns = 1; columns <= LARGEST; columns++)
			check_products(rows, columns, spreads[(rows + columns) % 4]);
	check_products(85, 300, WIDE / 7);
}

/* Large terms that cancel but for what a few small ones leave: the bound is about the sizes, not the sum. */
static void cancellation(void **state)
{
	int columns;
	(void)state;
	for (columns = 2; columns <= LARGEST; columns++) {
		real *row = numbers(columns, REAL_DIGITS, 10), *x = numbers(columns, REAL_DIGITS, 10), y;
		int j;
		for (j = 0; j + columns / 2 < columns; j++) {
			row[j + columns / 2] = -row[j] * (1 + 3 * REAL_EPSILON);
			x[j + columns / 2] = x[j];
		}
		pl_multiply(1, columns, row, x, &y);
		assert_row(columns, row, x, NULL, y, 1, 0);
		free(row);
		free(x);
	}
}

/* The order that plrt.h gives, with every sum stored.  Factors of half the bits: products are exact, so contraction
 * changes nothing. */
static real ordered(int columns, const real *row, const real *x)
{
	volatile real s[4] = {0, 0, 0, 0}, even, odd;
	int j;
	for (j = 0; j < columns; j++)
		s[j % 4] = s[j % 4] + row[j] * x[j];
	even = s[0] + s[2];
	odd = s[1] + s[3];
	return even + odd;
}

static void one_order_for_all(void **state)
{
	int rows, columns, i;
	(void)state;
	for (rows = 1; rows <= 9; rows++)
		for (columns = 0; columns <= LARGEST; columns++) {
			const int half = REAL_DIGITS / 2;
			real *table = numbers(rows * columns, half, 20), *x = numbers(columns, half, 20),
				 *y = numbers(rows, half, 0);
			pl_multiply(rows, columns, table, x, y);
			for (i = 0; i < rows; i++)
				assert_bits(y[i], ordered(columns, table + i * columns, x), "documented order", rows,
						columns, i);
			free(table);
			free(x);
			free(y);
		}
}

/* A row gives the same bits alone, in any table, and at any alignment; here with products that are not exact. */
static void a_row_is_as_if_alone(void **state)
{
	enum { ROWS = 11 };
	int columns, i, shift;
	(void)state;
	for (columns = 1; columns <= LARGEST; columns++) {
		real *table = numbers(ROWS * columns, REAL_DIGITS, 20), *x = numbers(columns, REAL_DIGITS, 20);
		real y[ROWS], alone;
		pl_multiply(ROWS, columns, table, x, y);
		for (i = 0; i < ROWS; i++)
			for (shift = 0; shift < 4; shift++) {
				real *row = numbers(columns + shift, REAL_DIGITS, 0);
				memcpy(row + shift, table + i * columns, sizeof *row * (size_t)columns);
				pl_multiply(1, columns, row + shift, x, &alone);
				assert_bits(y[i], alone, "a row alone", ROWS, columns, i);
				free(row);
			}
		free(table);
		free(x);
	}
}

static void nothing_to_do(void **state)
{
	real y[3] = {1.5, -2.5, 7};
	real *none = numbers(0, REAL_DIGITS, 0);
	(void)state;
	pl_multiply(0, 4, none, y, none);
	pl_multiply_add(0, 4, none, y, none);
	pl_multiply(0, 0, none, none, none);
	pl_multiply_add(2, 0, none, none, y);
	assert_bits(y[0], 1.5, "no columns, added", 2, 0, 0);
	assert_bits(y[1], -2.5, "no columns, added", 2, 0, 1);
	pl_multiply(2, 0, none, none, y);
	assert_bits(y[0], 0.0, "no columns", 2, 0, 0);
	assert_bits(y[1], 0.0, "no columns", 2, 0, 1);
	assert_bits(y[2], 7.0, "beyond the last row", 2, 0, 2);
	free(none);
}

/* An infinity reaches the rows that see it, and no others. */
static void infinities_go_where_the_table_leads(void **state)
{
	const real table[9] = {1, 2, 0.5, 1, 0, 0.5, -1, 2, 0.5}, x[3] = {3, 1, (real)INFINITY};
	const real narrow[6] = {1, 2, 1, 0, -1, 2};
	real y[3];
	int i;
	(void)state;
	pl_multiply(3, 3, table, x, y);
	for (i = 0; i < 3; i++)
		assert_bits(y[i], (real)INFINITY, "infinite column", 3, 3, i);
	assert_int_equal(pl_not_finite(y, 3), PL_NOT_FINITE);
	pl_multiply(3, 2, narrow, x, y);
	assert_int_equal(pl_not_finite(y, 3), 0);
}

static real of_bits(real_bits bits)
{
	real value;
	memcpy(&value, &bits, sizeof value);
	return value;
}

/* ---- not finite ---- */

#ifdef REAL_IS_FLOAT
static const real_bits infinite_or_nan[] = {
	0x7F800000u, 0xFF800000u, /* infinities */
	0x7FC00000u, 0xFFC00000u, 0x7FFFFFFFu, /* quiet */
	0x7F800001u, 0xFFBFFFFFu /* signalling */
};
static const real_bits finite_number[] = {
	0, 0x80000000u, 1, 0x807FFFFFu, 0x00800000u, 0x3F800000u, 0x7F7FFFFFu, 0xFF7FFFFFu
};
#else
static const real_bits infinite_or_nan[] = {
	0x7FF0000000000000u, 0xFFF0000000000000u, /* infinities */
	0x7FF8000000000000u, 0xFFF8000000000000u, 0x7FFFFFFFFFFFFFFFu, /* quiet */
	0x7FF0000000000001u, 0xFFF7FFFFFFFFFFFFu  /* signalling */
};
static const real_bits finite_number[] = {
	0, 0x8000000000000000u, 1, 0x800FFFFFFFFFFFFFu, 0x0010000000000000u, 0x3FF0000000000000u, 0x7FEFFFFFFFFFFFFFu,
	0xFFEFFFFFFFFFFFFFu
};
#endif
enum {
	NOT_FINITE = sizeof infinite_or_nan / sizeof *infinite_or_nan,
	FINITE = sizeof finite_number / sizeof *finite_number
};

static void assert_status(const real *y, int n, int expected, uint64_t bits, int place)
{
	int found;
	feclearexcept(FE_ALL_EXCEPT);
	found = pl_not_finite(y, n);
	if (found != expected)
		fail_msg("%016" PRIx64 " in place %d of %d: found %d, expected %d", bits, place, n, found, expected);
	if (fetestexcept(FE_ALL_EXCEPT) != 0)
		fail_msg("%016" PRIx64 " in place %d of %d raised exceptions %d", bits, place, n,
				fetestexcept(FE_ALL_EXCEPT));
}

static void status_by_the_bits(void **state)
{
	int n, i, k;
	(void)state;
	for (n = 1; n <= 9; n++) {
		real *y = numbers(n, REAL_DIGITS, WIDEST);
		for (i = 0; i < n; i++) {
			const real kept = y[i];
			for (k = 0; k < NOT_FINITE; k++) {
				memcpy(&y[i], &infinite_or_nan[k],
						sizeof *y); /* by bytes: a signalling one stays what it is */
				assert_status(y, n, PL_NOT_FINITE, infinite_or_nan[k], i);
				assert_status(y, i, 0, infinite_or_nan[k], i);
			}
			for (k = 0; k < FINITE; k++) {
				y[i] = of_bits(finite_number[k]);
				assert_status(y, n, 0, finite_number[k], i);
			}
			y[i] = kept;
		}
		free(y);
	}
	assert_status(NULL, 0, 0, 0, 0);
}

ROOM(apply,
	cmocka_unit_test(products),
	cmocka_unit_test(cancellation),
	cmocka_unit_test(one_order_for_all),
	cmocka_unit_test(a_row_is_as_if_alone),
	cmocka_unit_test(nothing_to_do),
	cmocka_unit_test(infinities_go_where_the_table_leads),
	cmocka_unit_test(status_by_the_bits))
