/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Functions of constants: exact where the value is rational and known to be, else the nearest rational of 256 bits. */
#include "collect/collect.h"

enum { GUARD_BITS = 128, LIMIT_ARGUMENT = 1 << 16 };    /* bits before the point of an argument of sin, exp, ... */

static void set_irrational(mpq_ptr value, struct place at, mpfr_srcptr wide)
{
	if (mpfr_nan_p(wide))
		error(at, NULL, "the value is not a number");
	/* infinite or 0: beyond even the range of MPFR */
	if (!mpfr_regular_p(wide) || (mpfr_get_exp(wide) > LIMIT_BITS || mpfr_get_exp(wide) < -LIMIT_BITS))
		error(at, NULL, "exact value over the limit of %d bits", LIMIT_BITS);
	REAL rounded = WITH_BITS(IRRATIONAL_BITS);
	mpfr_set(rounded, wide, MPFR_RNDN);
	mpfr_get_q(value, rounded);
}

void constant_pi(mpq_ptr value)
{
	REAL pi = WITH_BITS(IRRATIONAL_BITS);
	mpfr_const_pi(pi, MPFR_RNDN);
	mpfr_get_q(value, pi);
}

/* The exact n-th root of a non-negative rational, if it has one. */
static bool exact_root(mpq_srcptr q, unsigned long n, mpq_ptr root)
{
	INTEGER numerator = INTEGER_ZERO, denominator = INTEGER_ZERO;
	bool exact = mpz_root(numerator, mpq_numref(q), n) && mpz_root(denominator, mpq_denref(q), n);
	if (exact) {
		mpz_set(mpq_numref(root), numerator);
		mpz_set(mpq_denref(root), denominator);
	}
	return exact;
}

static void domain(struct place at, enum function function, bool outside, const char *where)
{
	if (outside)
		error(at, NULL, "%s of a number %s", function_name(function), where);
}

static bool outside_unit(mpq_srcptr x)
{
	return mpz_cmpabs(mpq_numref(x), mpq_denref(x)) > 0;
}

/* Values of the real functions that are rational at a rational argument (all of them, by Lindemann). */
static bool exact_value(struct place at, enum function function, mpq_srcptr x, mpq_ptr value)
{
	domain(at, function, (function == FN_ASIN || function == FN_ACOS) && outside_unit(x), "outside -1 to 1");
	domain(at, function, function == FN_LOG && mpq_sgn(x) <= 0, "that is not positive");
	domain(at, function, function == FN_SQRT && mpq_sgn(x) < 0, "below 0");
	if (function == FN_SQRT)
		return exact_root(x, 2, value);
	switch (function) {
#define REAL_FUNCTION(NAME, name, argument, value_there, low, high) \
	case FN_##NAME: mpq_set_ui(value, value_there, 1); return mpq_cmp_ui(x, argument, 1) == 0;
#include "read/functions.def"
#undef REAL_FUNCTION
	default: return false;
	}
}

void wide_value(enum function function, mpfr_ptr x)
{
	switch (function) {
#define REAL_FUNCTION(NAME, name, argument, value, low, high) case FN_##NAME: mpfr_##name(x, x, MPFR_RNDN); break;
#include "read/functions.def"
#undef REAL_FUNCTION
	default: break;
	}
}

/* A rational at enough bits that the function's value keeps 256 good ones. */
static __mpfr_struct new_wide(struct place at, mpq_srcptr x)
{
	long bits = rational_bits(x);
	if (bits > LIMIT_ARGUMENT)
		error(at, NULL, "the argument has more than %d bits before its point", LIMIT_ARGUMENT);
	long size = bits < 0 ? -bits : bits;
	mpfr_t wide;
	mpfr_init2(wide, IRRATIONAL_BITS + GUARD_BITS + (size < 4096 ? size : LIMIT_ARGUMENT));
	mpfr_set_q(wide, x, MPFR_RNDN);
	return *wide;
}

bool constant_function(struct place at, enum function function, mpq_srcptr x, mpq_ptr value)
{
	RATIONAL result = ZERO;
	bool exact = exact_value(at, function, x, result);
	if (!exact) {
		REAL wide = { new_wide(at, x) };
		wide_value(function, wide);
		set_irrational(result, at, wide);
	}
	mpq_set(value, result);
	return exact;
}

bool constant_atan2(struct place at, mpq_srcptr y, mpq_srcptr x, mpq_ptr value)
{
	if (mpq_sgn(y) == 0 && mpq_sgn(x) >= 0) {
		mpq_set_ui(value, 0, 1);
		return true;
	}
	REAL wide = { new_wide(at, y) }, other = { new_wide(at, x) };
	mpfr_atan2(wide, wide, other, MPFR_RNDN);
	set_irrational(value, at, wide);
	return false;
}

static void by_products(mpq_srcptr base, unsigned long n, bool divides, mpq_ptr value)
{
	RATIONAL power = RATIO(1, 1);
	for (; n > 0; n--)
		(divides ? mpq_div : mpq_mul)(power, power, base);
	mpq_swap(value, power);
}

static void integer_power(struct place at, mpq_srcptr base, mpz_srcptr exponent, mpq_ptr value)
{
	bool trivial = mpz_cmpabs_ui(mpq_numref(base), 1) <= 0 && mpz_cmp_ui(mpq_denref(base), 1) == 0;
	unsigned long n = mpz_get_ui(exponent);
	if (trivial)
		n = mpz_odd_p(exponent) ? 1 : mpz_sgn(exponent) ? 2 : 0;
	else if (!mpz_fits_slong_p(exponent))
		error(at, NULL, "exact value over the limit of %d bits", LIMIT_BITS);
	check_power(at, base, n);
	if (is_traced(1, base)) {
		by_products(base, n, mpz_sgn(exponent) < 0, value);
		return;
	}
	INTEGER numerator = INTEGER_ZERO, denominator = INTEGER_ZERO;
	mpz_pow_ui(numerator, mpq_numref(base), n);
	mpz_pow_ui(denominator, mpq_denref(base), n);
	bool negative = mpz_sgn(exponent) < 0;
	mpq_set_num(value, negative ? denominator : numerator);
	mpq_set_den(value, negative ? numerator : denominator);
	mpq_canonicalize(value);
}

bool constant_power(struct place at, mpq_srcptr base, mpq_srcptr exponent, mpq_ptr value)
{
	if (mpq_sgn(base) == 0 && mpq_sgn(exponent) < 0)
		error(at, NULL, "division by zero: 0 to a negative power");
	if (mpz_cmp_ui(mpq_denref(exponent), 1) == 0) {
		integer_power(at, base, mpq_numref(exponent), value);
		return true;
	}
	if (mpq_sgn(base) < 0)
		error(at, NULL, "a number below 0 to a power that is no integer");
	RATIONAL root = ZERO;
	bool exact = mpz_fits_ulong_p(mpq_denref(exponent)) && exact_root(base, mpz_get_ui(mpq_denref(exponent)), root);
	if (exact) {
		integer_power(at, root, mpq_numref(exponent), value);
	} else {
		REAL wide = { new_wide(at, base) }, power = { new_wide(at, exponent) };
		mpfr_pow(wide, wide, power, MPFR_RNDN);
		set_irrational(value, at, wide);
	}
	return exact;
}
