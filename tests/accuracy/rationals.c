/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Decimals and fractions as exact rationals.
 */
#include "rationals.h"

#include <ctype.h>
#include <stdlib.h>

enum { LARGEST_EXPONENT = 100000 };

/* q <- q * 10^exponent */
static void scale_by_ten(mpq_t q, long exponent)
{
	mpz_t power;
	mpz_init(power);
	mpz_ui_pow_ui(power, 10, (unsigned long)labs(exponent));
	if (exponent >= 0)
		mpz_mul(mpq_numref(q), mpq_numref(q), power);
	else
		mpz_mul(mpq_denref(q), mpq_denref(q), power);
	mpz_clear(power);
	mpq_canonicalize(q);
}

/* number = ("+" | "-")? (digit+ ("." digit*)? | "." digit+) (("e" | "E") ("+" | "-")? digit+)? */
static int parse_decimal(mpq_t q, const char **text)
{
	const char *s = *text;
	const int negative = *s == '-';
	int digits = 0, fraction = 0;
	long exponent = 0;

	if (*s == '-' || *s == '+')
		s++;
	mpq_set_ui(q, 0, 1);
	for (; isdigit((unsigned char)*s) || (*s == '.' && !fraction); s++) {
		if (*s == '.') {
			fraction = 1;
			continue;
		}
		mpz_mul_ui(mpq_numref(q), mpq_numref(q), 10);
		mpz_add_ui(mpq_numref(q), mpq_numref(q), (unsigned long)(*s - '0'));
		exponent -= fraction;
		digits++;
	}
	if (!digits)
		return -1;
	if (*s == 'e' || *s == 'E') {
		char *end;
		const char *first = s + 1 + (s[1] == '-' || s[1] == '+');
		if (!isdigit((unsigned char)*first))
			return -1;
		long written = strtol(s + 1, &end, 10);
		if (written > LARGEST_EXPONENT || written < -LARGEST_EXPONENT)
			return -1;
		exponent += written;
		s = end;
	}
	scale_by_ten(q, exponent);
	if (negative)
		mpq_neg(q, q);
	*text = s;
	return 0;
}

/* rational = number ("/" number)? */
int rational_parse(mpq_t q, const char *text)
{
	if (parse_decimal(q, &text))
		return -1;
	if (*text == '/') {
		mpq_t below;
		mpq_init(below);
		text++;
		int bad = parse_decimal(below, &text) || mpq_sgn(below) == 0;
		if (!bad)
			mpq_div(q, q, below);
		mpq_clear(below);
		if (bad)
			return -1;
	}
	return *text ? -1 : 0;
}
