/* SPDX-License-Identifier: MIT-0 */
/* runtime/host/digits.h, in exact whole numbers: what is written reads back, nothing shorter does, and nothing as long
 * that does is nearer.  Random numbers of both types, the ends of their ranges, powers of two, and for every exponent
 * those that come closest to a decision: their continued fractions say which.  Texts against printf, and what is read
 * against strtod. */
#include "draw.h"
#include "host/digits.h"

#include <float.h>
#include <math.h>
#include <stdio.h>

static mpz_t ten[DIGITS_MOST_POWER + 1];

static void powers_of_ten(void)
{
	for (unsigned long k = 0; k <= DIGITS_MOST_POWER; k++) {
		mpz_init(ten[k]);
		mpz_ui_pow_ui(ten[k], 10, k);
	}
}

/* How many of them in the short form */
static int cases(int all)
{
	return getenv("LONG") ? 20 * all : all;
}

static uint64_t draw_word(void)
{
	const uint64_t high = draw(1u << 31), middle = draw(1u << 31);
	return high << 33 ^ middle << 11 ^ draw(1u << 31);
}

/* ---- the powers ---- */

/* Is 10^k 2^-(digits_log2 - 127) in (power - 1, power)?  By their ratio. */
static void powers_are_enclosed(void **state)
{
	mpz_t number, least, unit;
	(void)state;
	mpz_inits(number, least, unit, NULL);
	for (int k = DIGITS_LEAST_POWER; k <= DIGITS_MOST_POWER; k++) {
		const digits_pair power = digits_power_of_ten(k);
		const int shift = digits_log2(k) - 127;
		mpz_set_ui(number, power.hi);
		mpz_mul_2exp(number, number, 64);
		mpz_add_ui(number, number, power.lo);
		mpz_sub_ui(least, number, 1);
		mpz_set(unit, ten[k < 0 ? 0 : k]);              /* 10^k = unit / 10^-k, all times 2^-shift */
		if (k < 0) {
			mpz_mul(number, number, ten[-k]);
			mpz_mul(least, least, ten[-k]);
		}
		if (shift > 0) {
			mpz_mul_2exp(number, number, (mp_bitcnt_t)shift);
			mpz_mul_2exp(least, least, (mp_bitcnt_t)shift);
		} else {
			mpz_mul_2exp(unit, unit, (mp_bitcnt_t)-shift);
		}
		if (!(power.hi >> 63) || mpz_cmp(unit, number) >= 0 || mpz_cmp(unit, least) < 0)
			fail_msg("10^%d: found %016llx %016llx 2^%d, expected a number just above it", k,
					 (unsigned long long)power.hi, (unsigned long long)power.lo, shift);
	}
	mpz_clears(number, least, unit, NULL);
}

/* floor(log10 2^q), floor(log10 3/4 2^q), floor(log2 10^k) by whole numbers: 10^a <= 2^q < 10^(a + 1) */
static void logarithms(void **state)
{
	mpz_t x, y;
	(void)state;
	mpz_inits(x, y, NULL);
	for (int q = -1074; q <= 971; q++)
		for (int three = 0; three < 2; three++) {
			const int found = digits_log10(q, three);
			for (int up = 0; up < 2; up++) {            /* x = (3 or 4) 2^q against y = 4 10^(found + up) */
				const int k = found + up;
				mpz_set_ui(x, three ? 3 : 4);
				mpz_set_ui(y, 4);
				mpz_mul_2exp(q > 0 ? x : y, q > 0 ? x : y, (mp_bitcnt_t)abs(q));
				mpz_mul(k < 0 ? x : y, k < 0 ? x : y, ten[k < 0 ? -k : k]);
				if (up ? mpz_cmp(x, y) >= 0 : mpz_cmp(x, y) < 0)
					fail_msg("floor(log10 %s2^%d): found %d, expected %s", three ? "3/4 " : "", q,
							found,
							 up ? "more" : "less");
			}
		}
	for (int k = -DIGITS_MOST_POWER; k <= DIGITS_MOST_POWER; k++) {
		const int bits = (int)mpz_sizeinbase(ten[abs(k)], 2), expected = k == 0 ? 0 : k > 0 ? bits - 1 : -bits;
		if (digits_log2(k) != expected)
			fail_msg("floor(log2 10^%d): found %d, expected %d", k, digits_log2(k), expected);
	}
	mpz_clears(x, y, NULL);
}

static void products(void **state)
{
	mpz_t x, y;
	(void)state;
	mpz_inits(x, y, NULL);
	for (int n = 0; n < cases(2000); n++) {
		const uint64_t a = draw_word() | (n % 3 ? 0 : UINT64_MAX << 20), b = draw_word() >> n % 60;
		const digits_pair found[2] = {digits_product(a, b), digits_by_halves(a, b)};
		mpz_set_ui(x, a);
		mpz_mul_ui(x, x, b);
		for (int i = 0; i < 2; i++) {
			mpz_set_ui(y, found[i].hi);
			mpz_mul_2exp(y, y, 64);
			mpz_add_ui(y, y, found[i].lo);
			if (mpz_cmp(x, y) != 0)
				fail_msg("%llu times %llu: found %s, expected %s", (unsigned long long)a,
						(unsigned long long)b,
						 mpz_get_str(NULL, 10, y), mpz_get_str(NULL, 10, x));
		}
	}
	mpz_clears(x, y, NULL);
}

/* ---- the decimal ---- */

/* All in the same unit: the number, the halfway points beside it, the decimal, and one in its last digit */
static struct exact {
	mpz_t value, low, high, decimal, unit, other, off, other_off;
	int even;
} x;

static int reads_back(mpz_srcptr decimal)
{
	const int above = mpz_cmp(decimal, x.low), below = mpz_cmp(x.high, decimal);
	return (above > 0 || (above == 0 && x.even)) && (below > 0 || (below == 0 && x.even));
}

static void set_exact(const digits_type *type, uint64_t c, int q, digits_decimal d)
{
	const int power_of_two = c == (uint64_t)1 << (type->bits - 1) && q > type->least, e = d.exponent;
	mpz_set_ui(x.value, 4 * c);
	mpz_sub_ui(x.low, x.value, power_of_two ? 1 : 2);
	mpz_add_ui(x.high, x.value, 2);
	mpz_set_ui(x.decimal, d.digits);
	mpz_set_ui(x.unit, 1);
	if (q - 2 < 0) {
		mpz_mul_2exp(x.decimal, x.decimal, (mp_bitcnt_t)(2 - q));
		mpz_mul_2exp(x.unit, x.unit, (mp_bitcnt_t)(2 - q));
	} else {
		mpz_mul_2exp(x.value, x.value, (mp_bitcnt_t)(q - 2));
		mpz_mul_2exp(x.low, x.low, (mp_bitcnt_t)(q - 2));
		mpz_mul_2exp(x.high, x.high, (mp_bitcnt_t)(q - 2));
	}
	if (e < 0) {
		mpz_mul(x.value, x.value, ten[-e]);
		mpz_mul(x.low, x.low, ten[-e]);
		mpz_mul(x.high, x.high, ten[-e]);
	} else {
		mpz_mul(x.decimal, x.decimal, ten[e]);
		mpz_mul(x.unit, x.unit, ten[e]);
	}
	x.even = c % 2 == 0;
}

/* A multiple of ten units between the halfway points: a decimal with fewer digits */
static int shorter_reads_back(void)
{
	mpz_mul_ui(x.off, x.unit, 10);
	mpz_cdiv_q(x.other, x.low, x.off);
	mpz_mul(x.other, x.other, x.off);
	if (!reads_back(x.other))
		mpz_add(x.other, x.other, x.off);
	return reads_back(x.other);
}

/* One unit up or down reads back too, and is nearer, or as near and even where this is odd */
static int nearer_reads_back(uint64_t digits)
{
	int found = 0;
	mpz_sub(x.off, x.decimal, x.value);
	for (int up = 0; up < 2; up++) {
		if (up)
			mpz_add(x.other, x.decimal, x.unit);
		else
			mpz_sub(x.other, x.decimal, x.unit);
		mpz_sub(x.other_off, x.other, x.value);
		const int nearer = mpz_cmpabs(x.off, x.other_off);
		found |= reads_back(x.other) && (nearer > 0 || (nearer == 0 && digits % 2));
	}
	return found;
}

static void check_decimal(const digits_type *type, uint64_t c, int q)
{
	const digits_decimal d = digits_between(type, c, q);
	const char *wrong = NULL;
	if (d.exponent < -DIGITS_MOST_POWER || d.exponent > DIGITS_MOST_POWER)
		fail_msg("%llu 2^%d: found an exponent of %d", (unsigned long long)c, q, d.exponent);
	set_exact(type, c, q, d);
	if (d.digits % 10 == 0)
		wrong = "its last digit is not 0";
	else if (!reads_back(x.decimal))
		wrong = "it reads back";
	else if (shorter_reads_back())
		wrong = "nothing shorter reads back";
	else if (nearer_reads_back(d.digits))
		wrong = "it is the nearest of its length";
	if (wrong)
		fail_msg("%llu 2^%d in %d bits: found %llu 10^%d, expected that %s", (unsigned long long)c, q,
				type->bits,
				 (unsigned long long)d.digits, d.exponent, wrong);
}

/* Significand of so many bits, or fewer where the exponent is the least */
static void check_random(const digits_type *type, int most)
{
	const int q = type->least + (int)draw((uint32_t)(most - type->least + 1));
	uint64_t c = draw_word() >> (64 - type->bits) | (uint64_t)1 << (type->bits - 1);
	if (draw(4) == 0)                                   /* few bits: whole numbers, decimals that end */
		c &= UINT64_MAX << draw((uint32_t)type->bits);
	check_decimal(type, c, q);
	c >>= 1 + draw((uint32_t)type->bits - 1);
	if (c)
		check_decimal(type, c, type->least);
}

static void random_numbers(void **state)
{
	(void)state;
	for (int n = 0; n < cases(10000); n++) {
		check_random(&digits_of_double, 971);
		check_random(&digits_of_float, 104);
	}
}

static void ends_and_powers_of_two(void **state)
{
	const digits_type *const types[] = {&digits_of_double, &digits_of_float};
	const int most[] = {971, 104};
	(void)state;
	for (int t = 0; t < 2; t++) {
		const uint64_t first = (uint64_t)1 << (types[t]->bits - 1);
		for (int q = types[t]->least; q <= most[t]; q++) {
			check_decimal(types[t], first, q);
			check_decimal(types[t], first + 1, q);
			check_decimal(types[t], 2 * first - 1, q);
		}
		for (uint64_t c = 1; c < 1000; c++)
			check_decimal(types[t], c, types[t]->least);
		for (uint64_t c = 1; c < first; c *= 2) {
			check_decimal(types[t], c, types[t]->least);
			check_decimal(types[t], first - c, types[t]->least);
		}
	}
}

/* n 2^q/10^k close to a whole number, 2^54 <= n < 2^55: the decisions are made about such, n = 4 c or beside it */
static void check_close(uint64_t n, int q)
{
	const uint64_t first = (uint64_t)1 << 52;
	for (int i = -1; i <= 1; i++) {
		const uint64_t c = n / 4 + (uint64_t)i;
		if (c >= first && c < 2 * first)
			check_decimal(&digits_of_double, c, q);
	}
}

/* Convergents a/b of 2^q/10^k: b 2^q/10^k is closer to a whole number than that of anything below b */
static void closest_decisions(void **state)
{
	const uint64_t most = (uint64_t)1 << 55;
	mpz_t over, under, whole;
	(void)state;
	mpz_inits(over, under, whole, NULL);
	for (int q = -1074; q <= 971; q += getenv("LONG") ? 1 : 5) {
		const int k = digits_log10(q, 0);
		uint64_t b = 1, before = 0;
		mpz_set_ui(over, 1);
		mpz_set_ui(under, 1);
		mpz_mul_2exp(q > 0 ? over : under, q > 0 ? over : under, (mp_bitcnt_t)abs(q));
		mpz_mul(k < 0 ? over : under, k < 0 ? over : under, ten[abs(k)]);
		mpz_tdiv_qr(whole, over, over, under);
		while (mpz_sgn(over) != 0) {
			mpz_swap(over, under);
			mpz_tdiv_qr(whole, over, over, under);
			if (!mpz_fits_ulong_p(whole) || mpz_get_ui(whole) > (most - before) / b)
				break;
			const uint64_t next = mpz_get_ui(whole) * b + before;
			before = b;
			b = next;
			if (b < most >> 12)
				continue;
			check_close(most / b * b, q);
			check_close(most / b / 4 * 4 * b, q);
			check_close((most - before) / b * b + before, q);
			check_close((most / b * b) / 2 * 2 - 2, q);
		}
	}
	mpz_clears(over, under, whole, NULL);
}

/* ---- text ---- */

static double draw_double(int n)
{
	uint64_t bits = draw_word();
	double d;
	if (n % 2)
		return ldexp((double)(int64_t)bits, -64 - (int)draw(20)) * (n % 4 == 1 ? 1 : 1e6);
	memcpy(&d, &bits, sizeof d);
	return isfinite(d) ? d : 0;
}

/* printf's text, with 15 places (6) or as many as it takes, but where it has other digits: of subnormal numbers it
 * writes more, and at powers of two the nearest of a length, which may not read back where another does */
static void texts_of_printf(void **state)
{
	static const double chosen[] = {0, 1, 10, 0.1, 0.001, 1e-4, 1e-5, 9.9999e-5, 1e14, 1e15, 1e16,
			123456789012345678.,
		999999999999999., 9999999999999998., 1234567890123456., 4.35, 0.3, 1. / 3, 2. / 3, 1e22, 1e23, 5e-324,
				2e-323,
		DBL_MAX, DBL_MIN, 1e100, 1e-100, 1e300, 999999, 1e6, 1234567, 16777216, 100, 20, 1048577};
	const int count = (int)(sizeof chosen / sizeof *chosen);
	(void)state;
	for (int n = 0; n < cases(20000); n++)
		for (int is_float = 0; is_float < 2; is_float++) {
			double d = fabs(n < count ? chosen[n] : draw_double(n));
			int exponent, places = is_float ? 6 : 15;
			char found[40], expected[40];
			if (is_float)
				d = d < FLT_MAX ? (double)(float)d : 1;
			*digits_text(found, digits_shortest(d, is_float), places) = 0;
			do
				snprintf(expected, sizeof expected, "%.*g", places, d);
			while ((is_float ? (double)strtof(expected, NULL) : strtod(expected, NULL)) != d
					&& places++ < 17);
			if (strlen(found) > 24 || (is_float ? (double)strtof(found, NULL) : strtod(found, NULL)) != d)
				fail_msg("%a: found '%s', expected 24 characters at most that read back", d, found);
			if (d >= (is_float ? (double)FLT_MIN : DBL_MIN) && frexp(d, &exponent) != 0.5 &&
				strcmp(found, expected) != 0)
				fail_msg("%a: found '%s', expected '%s'", d, found, expected);
		}
}

/* ---- reading ---- */

static void check_read(const char *text)
{
	char *found_end, *expected_end;
	const double found = digits_read(text, &found_end), expected = strtod(text, &expected_end);
	if (memcmp(&found, &expected, sizeof found) != 0 && !(found != found && expected != expected))
		fail_msg("'%s': found %a, expected %a", text, found, expected);
	if (found_end != expected_end)
		fail_msg("'%s': read to '%s', expected to '%s'", text, found_end, expected_end);
}

static void forms_of_numbers(void **state)
{
	static const char *const text[] = {"", "-", "+", ".", "-.", "e5", ".e5", "1e", "1e+", "1e-", "1e5", "1E5",
			"1e+5",
		"1.e5", ".5", "-.5e-3", "+5.", "1..2", "1.2.3", "0x10", "0X1p-3", "-0x.8", "00012", "0.000", "-0",
				"-0.0e99",
		"inf", "-inf", "nan", "Infinity", "1e400", "-1e400", "1e-400", "1e00005", "1e99999", "1e-99999", "1 2",
				"1,2",
		"12abc", "  7", "\t-7", "1e5e5", "0e5", "9007199254740993", "9007199254740993.0000000000000000001",
		"9007199254740992.99999999999999999", "1.7976931348623157e308", "1.7976931348623158e308",
		"1.7976931348623159e308", "2.2250738585072011e-308", "2.2250738585072014e-308", "5e-324",
		"2.4703282292062327e-324", "2.4703282292062328e-324", "18446744073709551615", "18446744073709551616",
		"9999999999999999999",
		"0.1000000000000000055511151231257827", "1e23", "8.5e22", "89255e-22", "4503599627370496.5",
		"4503599627370497.5", "00000000000000000000000000000001.5", "0.000000000000000000000000000000000015",
				"1e22",
		"123456789e-20", "1e-22", "6929495644600919.5", "3.7455744005952583e15"};
	(void)state;
	for (size_t i = 0; i < sizeof text / sizeof *text; i++)
		check_read(text[i]);
}

/* Of 1 to 25 digits, and just beside the halfway points between two numbers */
static void random_texts(void **state)
{
	char text[80];
	(void)state;
	for (int n = 0; n < cases(20000); n++) {
		const double d = draw_double(n);
		snprintf(text, sizeof text, "%.*e", (int)draw(25), d);
		check_read(text);
		snprintf(text, sizeof text, "%.*g", 1 + (int)draw(20), d);
		check_read(text);
		const long double half = ((long double)d + (long double)nextafter(d, DBL_MAX)) / 2;
		snprintf(text, sizeof text, "%.*Le", 17 + (int)draw(3), half);
		check_read(text);
		snprintf(text, sizeof text, "%u%u.%ue%d", draw(1u << 31), draw(1u << 31), draw(10),
				 (int)draw_integer(330));
		check_read(text);
	}
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(powers_are_enclosed), cmocka_unit_test(logarithms), cmocka_unit_test(products),
		cmocka_unit_test(random_numbers), cmocka_unit_test(ends_and_powers_of_two),
		cmocka_unit_test(closest_decisions), cmocka_unit_test(texts_of_printf),
				cmocka_unit_test(forms_of_numbers),
		cmocka_unit_test(random_texts)};
	choose_cases(argc, argv);
	powers_of_ten();
	mpz_inits(x.value, x.low, x.high, x.decimal, x.unit, x.other, x.off, x.other_off, NULL);
	return cmocka_run_group_tests(tests, NULL, NULL);
}
