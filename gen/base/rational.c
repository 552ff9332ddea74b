/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rationals: a product added; as text, a decimal where there is one. */
#include "base/base.h"

#include <string.h>

void rational_addmul(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b)
{
	RATIONAL product = ZERO;
	mpq_mul(product, a, b);
	mpq_add(sum, sum, product);
}

void rational_submul(mpq_ptr sum, mpq_srcptr a, mpq_srcptr b)
{
	RATIONAL product = ZERO;
	mpq_mul(product, a, b);
	mpq_sub(sum, sum, product);
}

bool rationals_multiple(size_t count, const mpq_t *x, const mpq_t *of, mpq_ptr ratio)
{
	size_t first = 0;
	while (first < count && mpq_sgn(of[first]) == 0)
		first++;
	if (first == count)
		return false;
	RATIONAL product = ZERO;
	mpq_div(ratio, x[first], of[first]);
	bool multiple = true;
	for (size_t i = 0; i < count && multiple; i++) {
		mpq_mul(product, ratio, of[i]);
		multiple = mpq_equal(product, x[i]);
	}
	return multiple;
}

/* q = digits / 10^places if its denominator allows */
static bool decimal_places(mpq_srcptr q, unsigned long *places)
{
	INTEGER rest = INTEGER_ZERO, five = INTEGER_ZERO;
	mpz_set_ui(five, 5);
	unsigned long twos = mpz_scan1(mpq_denref(q), 0);
	mpz_fdiv_q_2exp(rest, mpq_denref(q), twos);
	unsigned long fives = mpz_remove(rest, rest, five);
	bool decimal = mpz_cmp_ui(rest, 1) == 0;
	*places = twos > fives ? twos : fives;
	return decimal;
}

long rational_bits(mpq_srcptr q)
{
	return (long)mpz_sizeinbase(mpq_numref(q), 2) - (long)mpz_sizeinbase(mpq_denref(q), 2);
}

const char *exact_text(mpq_srcptr q)
{
	enum { LONGEST_DECIMAL = 40 };
	unsigned long places;
	if (!decimal_places(q, &places) || places > LONGEST_DECIMAL) {
		char *text = ARRAY(char, mpz_sizeinbase(mpq_numref(q), 10) + mpz_sizeinbase(mpq_denref(q), 10) + 3);
		return mpq_get_str(text, 10, q);
	}
	INTEGER digits = INTEGER_ZERO;
	mpz_ui_pow_ui(digits, 10, places);
	mpz_mul(digits, digits, mpq_numref(q));
	mpz_divexact(digits, digits, mpq_denref(q));
	mpz_abs(digits, digits);
	char *all = ARRAY(char, mpz_sizeinbase(digits, 10) + 2);
	mpz_get_str(all, 10, digits);
	const char *sign = mpq_sgn(q) < 0 ? "-" : "";
	if (places == 0)
		return format("%s%s", sign, all);
	while (strlen(all) <= places)
		all = format("0%s", all);
	size_t whole = strlen(all) - places;
	return format("%s%.*s.%s", sign, (int)whole, all, all + whole);
}

const char *readable_text(mpq_srcptr q)
{
	enum { LONGEST_READABLE = 18 };
	const char *exact = exact_text(q);
	return strlen(exact) <= LONGEST_READABLE ? exact : format("%.12g", nearest_double(q));
}
