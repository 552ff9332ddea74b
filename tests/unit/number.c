/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The border to rounded numbers: what is rounded is held against the target's neighbouring numbers, exactly in
 * rationals; texts against what the C library reads, and against all that are shorter. The last case turns to float for
 * good. */
#include "draw.h"
#include "base/base.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { CASES = 2000 };

static struct type {
	bool single;
	int bits, least;            /* of the significand; log2 of the smallest subnormal number */
	double largest;
} type = { false, 53, -1074, DBL_MAX };

static double next_number(double d, bool up)
{
	double to = up ? HUGE_VAL : -HUGE_VAL;
	return type.single ? (double)nextafterf((float)d, (float)to) : nextafter(d, to);
}

/* Any finite number of the type, by its bits */
static double draw_number(void)
{
	for (;;) {
		uint32_t word[2] = { draw(65536) << 16 | draw(65536), draw(65536) << 16 | draw(65536) };
		uint64_t bits = (uint64_t)word[0] << 32 | word[1];
		double d;
		float f;
		memcpy(&f, word, sizeof f);
		memcpy(&d, &bits, sizeof d);
		if (isfinite(type.single ? (double)f : d))
			return type.single ? (double)f : d;
	}
}

/* Subnormal, about 1, a power of two, the largest: where the distance of numbers changes */
static double draw_special(void)
{
	switch (draw(6)) {
	case 0:  return ldexp((double)draw_integer(100), type.least);
	case 1:  return ldexp(draw(2) ? 1 : -1, type.least + (int)draw((uint32_t)(type.bits - 2 * type.least) / 2));
	case 2:  return next_number(ldexp(1, (int)draw_integer(100)), draw(2));
	case 3:  return draw(2) ? type.largest : -type.largest;
	case 4:  return (double)draw_integer(1000);
	default: return ldexp(1, type.least + type.bits - 1) * (1 + ldexp((double)draw_integer(8), -4));
	}
}

static const char *exponent_text(double d)
{
	return format("%.17g (%a)", d, d);
}

/* |q - found| is at most |q - neighbour|; where the same, found is even. */
static void assert_nearest(const char *what, int n, mpq_srcptr q, double found)
{
	mpq_t near, far, ulp;
	if (isinf(found)) {
		fail_msg("%s, case %d: %s becomes %g", what, n, mpq_get_str(NULL, 10, q), found);
		return;
	}
	mpq_inits(near, far, ulp, NULL);
	mpq_set_d(near, found);
	mpq_sub(near, near, q);
	mpq_abs(near, near);
	for (int up = 0; up < 2; up++) {
		double other = next_number(found, up);
		if (isinf(other))
			continue;
		mpq_set_d(far, other);
		mpq_sub(far, far, q);
		mpq_abs(far, far);
		int order = mpq_cmp(near, far);
		bool odd = fmod(ldexp(found, -(isnormal(type.single ? (float)found : found) ? ilogb(found) - type.bits
				+ 1
													: type.least)),
						2) != 0;
		if (order > 0 || (order == 0 && odd))
			fail_msg("%s, case %d: %s becomes %s, but %s is %s", what, n, mpq_get_str(NULL, 10, q),
					 exponent_text(found), exponent_text(other), order ? "nearer" : "as near, and "
						"even");
	}
	if (found == 0 && signbit(found))
		fail_msg("%s, case %d: becomes -0, expected 0", what, n);
	mpq_clears(near, far, ulp, NULL);
}

/* q <- d + part (next - d) */
static void between(mpq_ptr q, double d, bool up, long part, unsigned long parts)
{
	mpq_t gap;
	mpq_init(gap);
	mpq_set_d(gap, next_number(d, up));
	mpq_set_d(q, d);
	mpq_sub(gap, gap, q);
	mpz_mul_si(mpq_numref(gap), mpq_numref(gap), part);
	mpz_mul_ui(mpq_denref(gap), mpq_denref(gap), parts);
	mpq_canonicalize(gap);
	mpq_add(q, q, gap);
	mpq_clear(gap);
}

static void check_rounding(void)
{
	mpq_t q, little;
	mpq_inits(q, little, NULL);
	for (int n = 0; n < CASES; n++) {
		double d = n % 2 ? draw_special() : draw_number();
		bool up = draw(2);
		mpq_set_d(q, d);
		if (round_rational(q) != d)
			fail_msg("case %d: %s becomes %s", n, exponent_text(d), exponent_text(round_rational(q)));
		if (isinf(next_number(d, up)))
			continue;
		between(q, d, up, 1, 2);
		assert_nearest("half way", n, q, round_rational(q));
		mpq_set_ui(little, 1, 1);
		mpq_div_2exp(little, little, 1200 + draw(200));
		(draw(2) ? mpq_add : mpq_sub)(q, q, little);
		assert_nearest("beside half way", n, q, round_rational(q));
		between(q, d, up, (long)draw(1000), 1000);
		assert_nearest("between", n, q, round_rational(q));
		draw_fraction(q, 1000000, 1000000);
		(draw(2) ? mpq_mul_2exp : mpq_div_2exp)(q, q, draw(type.single ? 100 : 1000));
		assert_nearest("fraction", n, q, round_rational(q));
	}
	mpq_clears(q, little, NULL);
}

/* Half a unit beyond the largest number, and half of the smallest: what is below, at and above */
static void check_ends(void)
{
	mpq_t q, little;
	mpq_inits(q, little, NULL);
	for (int sign = -1; sign <= 1; sign += 2)
		for (int side = -1; side <= 1; side++) {
			mpq_set_d(q, type.largest);
			mpq_set_ui(little, 1, 1);
			mpq_mul_2exp(little, little, (mp_bitcnt_t)(ilogb(type.largest) - type.bits)); /* half a unit */
			mpq_add(q, q, little);
			mpq_set_si(little, side, 1);
			mpq_add(q, q, little);
			if (sign < 0)
				mpq_neg(q, q);
			double expected = sign * (side < 0 ? type.largest : HUGE_VAL), found = round_rational(q);
			if (found != expected || beyond_range(q) != (side >= 0))
				fail_msg("half a unit beyond the largest %+d: found %g, expected %g; beyond the "
					"range: %d, expected %d",
						 side, found, expected, beyond_range(q), side >= 0);
			mpq_set_si(q, sign, 1);
			mpq_div_2exp(q, q, (mp_bitcnt_t)(1 - type.least));
			mpq_set_si(little, side * sign, 1);
			mpq_div_2exp(little, little, 3000);
			mpq_add(q, q, little);
			expected = side > 0 ? sign * ldexp(1, type.least) : 0;
			found = round_rational(q);
			if (found != expected || signbit(found) != signbit(expected) || beyond_range(q))
				fail_msg("half of the smallest %+d: found %g, expected %g", side, found, expected);
		}
	mpq_clears(q, little, NULL);
}

/* Both ends round to one number, or they do not. */
static void check_enclosures(void)
{
	mpq_t q;
	mpfi_t x;
	int kept[2] = { 0, 0 };
	mpq_init(q);
	mpfi_init2(x, 1300);
	for (int n = 0; n < CASES; n++) {
		double d = n % 2 ? draw_special() : draw_number(), found;
		bool up = draw(2), middle = draw(2);
		if (isinf(next_number(d, true)) || isinf(next_number(d, false)))
			continue;
		between(q, d, up, middle ? 1 : 0, 2);           /* around a number, or half way: two numbers */
		mpfi_set_q(x, q);
		mpfr_set_prec(&x->left, 1300);
		mpfr_set_q(&x->left, q, MPFR_RNDN);             /* exact: at most 1,075 bits */
		mpfr_set(&x->right, &x->left, MPFR_RNDN);
		for (int k = 1 + (int)draw(3); k > 0; k--) {
			mpfr_nextbelow(&x->left);
			mpfr_nextabove(&x->right);
		}
		bool one = round_enclosure(x, &found);
		kept[one]++;
		if (one == middle || (one && found != d))
			fail_msg("case %d, %s %s: found %s, %s", n, middle ? "half way "
				"beside" : "around", exponent_text(d),
				one ? "one number" : "two", exponent_text(found));
	}
	assert_true(kept[0] > CASES / 4 && kept[1] > CASES / 4);
	mpq_clear(q);
	mpfi_clear(x);
}

static double read_text(const char *text)
{
	return type.single ? (double)strtof(text, NULL) : strtod(text, NULL);
}

/* Digits from the first that is not 0 to the last: of 1200 two */
static int digits_of(const char *text)
{
	int digits = 0, zeros = 0;
	for (; *text && *text != 'e'; text++) {
		if (*text < '0' || *text > '9' || (digits == 0 && *text == '0'))
			continue;
		zeros = *text == '0' ? zeros + 1 : 0;
		digits++;
	}
	return digits - zeros;
}

/* A decimal of so many digits, the nearest or one beside it, that reads back as d; NULL: there is none */
static const char *shorter_text(double d, int digits)
{
	char text[64];
	if (digits < 1)
		return NULL;
	snprintf(text, sizeof text, "%.*e", digits - 1, d);
	for (long step = -1; step <= 1; step++) {
		char *e = strchr(text, 'e'), mantissa[64] = "";
		for (const char *at = text; at < e; at++)
			if (*at != '.')
				strncat(mantissa, at, 1);
		const char *other =
			format("%llde%ld", strtoll(mantissa, NULL, 10) + step, strtol(e + 1, NULL, 10) - digits + 1);
		if (read_text(other) == d)
			return other;
	}
	return NULL;
}

static void check_texts(void)
{
	for (int n = 0; n < CASES; n++) {
		double d = n % 2 ? draw_special() : draw_number();
		if (n % 5 == 0)
			d = read_text(format("%ld.%ue%ld", draw_integer(999), draw(1000),
					draw_integer(type.single ? 30 : 290)));
		const char *text = shortest(d), *shorter = NULL;
		char *end;
		double plain = strtod(text, &end);
		if (strlen(text) < 3 || strcmp(end - 2, ".0") != 0)
			shorter = shorter_text(d, digits_of(text) - 1);
		else if (strlen(text) > strlen("-12345678901234567.0"))
			fail_msg("case %d: '%s' is longer than with an exponent", n, text);
		else if (plain != d)                            /* a whole number has all of its digits */
			fail_msg("case %d: '%s' for %s; expected this number exactly", n, text, exponent_text(d));
		if (*end || !strpbrk(text, ".e"))
			fail_msg("case %d: '%s' for %s is no floating constant", n, text, exponent_text(d));
		if (read_text(text) != d)
			fail_msg("case %d: '%s' reads back as %s, expected %s", n, text, exponent_text(read_text(text)),
					 exponent_text(d));
		if (shorter)
			fail_msg("case %d: found '%s' for %s, but '%s' reads back "
				"too", n, text, exponent_text(d), shorter);
	}
}

static void rounded_to_nearest(void **state)
{
	(void)state;
	check_rounding();
}

static void ends_of_the_range(void **state)
{
	(void)state;
	check_ends();
}

static void enclosures_of_one_number(void **state)
{
	(void)state;
	check_enclosures();
}

static void shortest_texts(void **state)
{
	(void)state;
	check_texts();
}

/* A decimal or a fraction, read back in whole numbers */
static void read_exact(const char *text, mpq_ptr q)
{
	const char *point = strchr(text, '.');
	if (!point) {
		if (mpq_set_str(q, text, 10) != 0)
			fail_msg("'%s' is no number", text);
		return;
	}
	const char *digits = format("%.*s%s", (int)(point - text), text, point + 1);
	if (mpz_set_str(mpq_numref(q), digits, 10) != 0)
		fail_msg("'%s' is no number", text);
	mpz_ui_pow_ui(mpq_denref(q), 10, strlen(point + 1));
	mpq_canonicalize(q);
}

static void exact_texts(void **state)
{
	mpq_t q, back;
	int decimals = 0;
	mpq_inits(q, back, NULL);
	(void)state;
	for (int n = 0; n < CASES; n++) {
		draw_fraction(q, 1000000, 1000);
		if (draw(2)) {                                  /* 2^a 5^b below: a decimal */
			mpz_ui_pow_ui(mpq_denref(q), 2, draw(30));
			mpz_ui_pow_ui(mpq_numref(back), 5, draw(30));
			mpz_mul(mpq_denref(q), mpq_denref(q), mpq_numref(back));
			mpq_canonicalize(q);
		}
		const char *text = exact_text(q), *readable = readable_text(q);
		mpz_t rest, prime;
		mpz_init_set(rest, mpq_denref(q));
		mpz_init_set_ui(prime, 2);
		mpz_remove(rest, rest, prime);
		mpz_set_ui(prime, 5);
		mpz_remove(rest, rest, prime);
		bool decimal = mpz_cmp_ui(rest, 1) == 0;
		mpz_clears(rest, prime, NULL);
		decimals += decimal;
		read_exact(text, back);
		if (!mpq_equal(q, back) || *strpbrk(text, ".0123456789") == '.')
			fail_msg("case %d: %s is written '%s'", n, mpq_get_str(NULL, 10, q), text);
		if (decimal == (strchr(text, '/') != NULL))
			fail_msg("case %d: %s is written '%s', expected %s", n, mpq_get_str(NULL, 10, q), text,
					 decimal ? "a decimal" : "a fraction");
		double expected = mpq_get_d(q), found = strtod(readable, NULL);
		if (strlen(text) <= 18 ? strcmp(text, readable) != 0
				   : strlen(readable) > 19 || !(fabs(found - expected) <= 5e-12 * fabs(expected)))
			fail_msg("case %d: %s is written '%s' for readers", n, text, readable);
	}
	assert_true(decimals > CASES / 4 && decimals < CASES);
	mpq_clears(q, back, NULL);
}

static void finite_or_told(void *context)
{
	static const struct source source = { .name = "m.spec", .base = "m.spec", .text = "step 1\n", .length = 7 };
	struct { mpq_t q; const char *text; } *asked = context;
	asked->text = finite_text((struct place){ &source, 5 }, asked->q);
}

static void beyond_the_range_is_told(void **state)
{
	struct { mpq_t q; const char *text; } asked = { .text = NULL };
	mpq_init(asked.q);
	(void)state;
	mpq_set_d(asked.q, DBL_MAX);
	assert_true(silent_guard(finite_or_told, &asked));
	assert_string_equal(asked.text, "1.7976931348623157e308");
	mpq_mul_2exp(asked.q, asked.q, 1);
	assert_false(silent_guard(finite_or_told, &asked));
	mpq_clear(asked.q);
}

static void all_of_it_for_float(void **state)
{
	mpq_t third;
	mpq_init(third);
	mpq_set_ui(third, 1, 3);
	(void)state;
	assert_string_equal(target_name(), "double");
	type = (struct type){ true, 24, -149, (double)FLT_MAX };
	target_float();
	assert_string_equal(target_name(), "float");
	check_rounding();
	check_ends();
	check_enclosures();
	check_texts();
	if (nearest_double(third) != 1.0 / 3 || round_rational(third) != (double)(1.0f / 3))
		fail_msg("1/3 becomes the double %.17g and the float %.17g; expected %.17g and "
			"%.17g", nearest_double(third),
			round_rational(third), 1.0 / 3, (double)(1.0f / 3));
	mpq_clear(third);
}

/* x encloses q by 2^-bits on either side */
static void enclose(mpq_srcptr q, long bits, mpfi_ptr x)
{
	mpq_t end, width;
	mpq_inits(end, width, NULL);
	mpq_set_ui(width, 1, 1);
	if (bits >= 0)
		mpq_div_2exp(width, width, (mp_bitcnt_t)bits);
	else
		mpq_mul_2exp(width, width, (mp_bitcnt_t)-bits);
	mpq_sub(end, q, width);
	mpfr_set_q(&x->left, end, MPFR_RNDD);
	mpq_add(end, q, width);
	mpfr_set_q(&x->right, end, MPFR_RNDU);
	mpq_clears(end, width, NULL);
}

/* Is |q - digits 2^exponent| at most half of 2^exponent? */
static bool is_nearest(mpq_srcptr q, mpz_srcptr digits, long exponent)
{
	mpq_t scaled, difference;
	mpq_inits(scaled, difference, NULL);
	if (exponent >= 0)
		mpq_div_2exp(scaled, q, (mp_bitcnt_t)exponent);
	else
		mpq_mul_2exp(scaled, q, (mp_bitcnt_t)-exponent);
	mpq_set_z(difference, digits);
	mpq_sub(difference, scaled, difference);
	mpq_mul_2exp(difference, difference, 1);
	mpq_abs(difference, difference);
	bool nearest = mpq_cmp_ui(difference, 1, 1) <= 0;
	mpq_clears(scaled, difference, NULL);
	return nearest;
}

/* Odd denominators: half way between two integers lies none of these, and a half added to an integer lies just there.
 */
static void enclosures_of_one_integer(void **state)
{
	(void)state;
	mpq_t q;
	mpz_t found;
	mpfi_t x;
	mpq_init(q);
	mpz_init(found);
	mpfi_init2(x, 200);
	for (int n = 0; n < CASES; n++) {
		bool middle = draw(3) == 0;
		mpq_set_si(q, middle ? 2 * draw_integer(1000000) + 1 : draw_integer(1000000), middle ? 2 : 1
				+ 2 * draw(500));
		mpq_canonicalize(q);
		enclose(q, 40, x);
		bool one = round_integer(x, found);
		if (one == middle || (one && !is_nearest(q, found, 0)))
			fail_msg("case %d, around %s: %s integer, %s; expected "
				"%s", n, mpq_get_str(NULL, 10, q), one ? "one" : "no",
				mpz_get_str(NULL, 10, found), middle ? "none" : "one, the nearest");
	}
	mpq_clear(q);
	mpz_clear(found);
	mpfi_clear(x);
}

/* An odd integer of one bit more than asked for lies half way; fractions of odd denominators do not. */
static void enclosures_of_so_many_bits(void **state)
{
	(void)state;
	mpq_t q;
	mpz_t found;
	mpfi_t x;
	mpq_init(q);
	mpz_init(found);
	mpfi_init2(x, 400);
	for (int n = 0; n < CASES; n++) {
		bool middle = draw(3) == 0;
		int bits = middle ? 20 : 64 * (2 + (int)draw(2)), shift = (int)draw(200);
		long exponent = 0;
		mpq_set_ui(q, middle ? 1048577 + 2 * draw(524288) : 1 + draw(1000000), middle ? 1 : 3 + 2 * draw(500));
		mpq_canonicalize(q);
		mpq_mul_2exp(q, q, (mp_bitcnt_t)shift);
		enclose(q, bits + 40 - shift, x);
		bool exact = mpz_cmp_ui(mpq_denref(q), 1) == 0, one = round_bits(x, bits, found, &exponent);
		bool full = one && mpz_sizeinbase(found, 2) == (size_t)bits;
		if (one == middle || (one && (!full || !is_nearest(q, found, exponent))))
			fail_msg("case %d, %d bits around %s (%s): %s 2^%ld; expected "
				"%s", n, bits, mpq_get_str(NULL, 10, q),
				exact ? "an integer" : "a fraction", one ? mpz_get_str(NULL, 10, found) : "none",
						exponent,
				middle ? "none" : "the nearest");
	}
	mpq_clear(q);
	mpz_clear(found);
	mpfi_clear(x);
}

int main(int argc, char **argv)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(rounded_to_nearest),
		cmocka_unit_test(ends_of_the_range),
		cmocka_unit_test(enclosures_of_one_number),
		cmocka_unit_test(enclosures_of_one_integer),
		cmocka_unit_test(enclosures_of_so_many_bits),
		cmocka_unit_test(shortest_texts),
		cmocka_unit_test(exact_texts),
		cmocka_unit_test(beyond_the_range_is_told),
		cmocka_unit_test(all_of_it_for_float),          /* the last: there is no way back */
	};
	choose_cases(argc, argv);
	memory_open();
	const int status = cmocka_run_group_tests(tests, NULL, NULL);
	memory_close();
	return status;
}
