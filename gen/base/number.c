/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The border: exact and enclosed numbers become the target's numbers here, and these and rationals become text. */
#include "base/base.h"
#include "host/digits.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* The target's numbers: exponents as MPFR counts them, significands in [1/2, 1) */
struct range {
	const char *name;
	int bits;
	mpfr_exp_t least, most;         /* of the smallest subnormal number, of the largest number */
};
static const struct range range_of_double = { "double", 53, -1073, 1024 },
			  range_of_float = { "float", 24, -148, 128 };
static const struct range *target = &range_of_double;

void target_float(void)
{
	target = &range_of_float;
}

void target_double(void)
{
	target = &range_of_double;
}

const char *target_name(void)
{
	return target->name;
}

/* Rounds once, subnormal numbers too: rounded_value then is one of the target's numbers. */
static double rounded_value(mpfr_ptr x, int inexact)
{
	mpfr_exp_t emin = mpfr_get_emin(), emax = mpfr_get_emax();
	mpfr_set_emin(target->least);
	mpfr_set_emax(target->most);
	inexact = mpfr_check_range(x, inexact, MPFR_RNDN);
	mpfr_subnormalize(x, inexact, MPFR_RNDN);
	double d = mpfr_get_d(x, MPFR_RNDN);
	mpfr_set_emin(emin);
	mpfr_set_emax(emax);
	return d == 0 ? 0 : d;          /* no negative zero */
}

double round_rational(mpq_srcptr q)
{
	REAL x = WITH_BITS(target->bits);
	int inexact = mpfr_set_q(x, q, MPFR_RNDN);
	return rounded_value(x, inexact);
}

double nearest_double(mpq_srcptr q)
{
	const struct range *kept = target;
	target = &range_of_double;
	double d = round_rational(q);
	target = kept;
	return d;
}

static double round_bound(mpfr_srcptr bound)
{
	REAL x = WITH_BITS(target->bits);
	int inexact = mpfr_set(x, bound, MPFR_RNDN);
	return rounded_value(x, inexact);
}

void round_roughly(mpq_ptr to, mpq_srcptr q)
{
	const double rough = mpq_get_d(q);
	if (isfinite(rough))
		mpq_set_d(to, rough);
	else
		mpq_set(to, q);
}

double rounding_rest(mpq_srcptr q)
{
	RATIONAL rest = ZERO;
	mpq_set_d(rest, round_rational(q));
	mpq_sub(rest, q, rest);
	return round_rational(rest);
}

bool beyond_range(mpq_srcptr q)
{
	return isinf(round_rational(q));
}

const char *finite_text(struct place at, mpq_srcptr q)
{
	if (beyond_range(q))
		error(at, NULL, "the value is beyond the range of %s", target->name);
	return shortest(round_rational(q));
}

bool round_enclosure(mpfi_srcptr x, double *d)
{
	double right = round_bound(&x->right);
	*d = round_bound(&x->left);
	return *d == right;
}

bool round_integer(mpfi_srcptr x, mpz_ptr n)
{
	INTEGER right = INTEGER_ZERO;
	mpfr_get_z(n, &x->left, MPFR_RNDN);
	mpfr_get_z(right, &x->right, MPFR_RNDN);
	return mpz_cmp(n, right) == 0;
}

bool round_bits(mpfi_srcptr x, int bits, mpz_ptr digits, long *exponent)
{
	REAL left = WITH_BITS(bits), right = WITH_BITS(bits);
	mpfr_set(left, &x->left, MPFR_RNDN);
	mpfr_set(right, &x->right, MPFR_RNDN);
	bool decided = !mpfr_zero_p(left) && mpfr_equal_p(left, right);
	if (decided)
		*exponent = mpfr_get_z_2exp(digits, left);
	return decided;
}

const char *shortest(double d)
{
	char text[32];
	if (d == 0 && !signbit(d))
		return "0.0";           /* most of what large models print */
	text[0] = '-';
	*digits_text(text + (signbit(d) != 0), digits_shortest(d, target == &range_of_float), 0) = 0;
	char *exponent = strchr(text, 'e');
	if (!exponent)
		return strchr(text, '.') ? format("%s", text) : format("%s.0", text);
	long power = strtol(exponent + 1, NULL, 10);    /* 1e-05 as 1e-5 */
	*exponent = 0;
	if (power >= 0 && power < 16)                   /* %g writes 100 as 1e+02 when one digit is enough */
		return format("%.0f.0", d);
	return format("%se%ld", text, power);
}
