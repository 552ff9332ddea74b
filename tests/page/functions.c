/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The runtime's elementary functions against MPFR: the largest error in units in the last place, over arguments of all
 * sizes, is at most what plrt.h says; where C99 gives a value exactly it is that one. */
#include "plrt.h"

#include <float.h>
#include <math.h>
#include <mpfr.h>
#include <stdio.h>
#include <string.h>

enum { SAMPLES = 4000, BITS = 200 };

static int count, failed;
static uint64_t seed = 88172645463325252u;

/* From 0 to 1, Marsaglia's xorshift */
static double uniform(void)
{
	seed ^= seed << 13;
	seed ^= seed >> 7;
	seed ^= seed << 17;
	return (double)(seed >> 11) * 0x1p-53;
}

static void result(int good, const char *name)
{
	printf("%sok %d - %s\n", good ? "" : "not ", ++count, name);
	failed |= !good;
}

static double error_of(double got, mpfr_srcptr true_value)
{
	const double near = mpfr_get_d(true_value, MPFR_RNDN);
	double error = INFINITY;
	int exponent;
	mpfr_t off;
	if (got == near && (got == 0 || isinf(got)))
		return 0;
	if (!isfinite(got) || !isfinite(near))
		return INFINITY;
	frexp(near, &exponent);
	mpfr_init2(off, BITS);
	mpfr_sub_d(off, true_value, got, MPFR_RNDN);
	error = fabs(mpfr_get_d(off, MPFR_RNDN)) / ldexp(1, (exponent < DBL_MIN_EXP ? DBL_MIN_EXP : exponent) - 53);
	mpfr_clear(off);
	return error;
}

/* Arguments: of one range evenly, and by their logarithm of all sizes, with either sign or positive; what is beyond
 * `most` is 1 */
struct range { double low, high, log_low, log_high, most; int positive; };

static double argument(const struct range *r, int sample)
{
	double x = r->low + (r->high - r->low) * uniform();
	if (sample % 2)
		x = exp(r->log_low + (r->log_high - r->log_low) * uniform()) * (uniform() < 0.5 ? -1 : 1);
	x = r->positive ? fabs(x) : x;
	return fabs(x) > r->most ? 1 : x;
}

typedef int true_function(mpfr_ptr value, mpfr_srcptr x, mpfr_rnd_t rounding);

static void test_one(const char *name, double (*own)(double), true_function *true_one, struct range r, double bound)
{
	double worst = 0, at = 0;
	char text[120];
	mpfr_t x, value;
	mpfr_inits2(BITS, x, value, (mpfr_ptr)0);
	for (int i = 0; i < SAMPLES; i++) {
		const double a = argument(&r, i);
		mpfr_set_d(x, a, MPFR_RNDN);
		true_one(value, x, MPFR_RNDN);
		const double error = error_of(own(a), value);
		if (!(error <= worst)) {
			worst = error;
			at = a;
		}
	}
	snprintf(text, sizeof text, "%s: error %.4f ulp at %a, bound %g", name, worst, at, bound);
	result(worst <= bound, text);
	mpfr_clears(x, value, (mpfr_ptr)0);
}

typedef int true_function_of_two(mpfr_ptr value, mpfr_srcptr x, mpfr_srcptr y, mpfr_rnd_t rounding);

static void test_two(const char *name, double (*own)(double, double), true_function_of_two *true_one, double size,
		     double other, double bound)
{
	double worst = 0;
	char text[120];
	mpfr_t x, y, value;
	mpfr_inits2(BITS, x, y, value, (mpfr_ptr)0);
	for (int i = 0; i < SAMPLES; i++) {
		const double sign = own == pl_atan2 && i % 2 ? -1 : 1;
		const double a = sign * exp(size * (2 * uniform() - 1)), b = other * (2 * uniform() - 1);
		mpfr_set_d(x, a, MPFR_RNDN);
		mpfr_set_d(y, b, MPFR_RNDN);
		true_one(value, x, y, MPFR_RNDN);
		const double error = error_of(own(a, b), value);
		worst = error <= worst ? worst : error;
	}
	snprintf(text, sizeof text, "%s: error %.4f ulp, bound %g", name, worst, bound);
	result(worst <= bound, text);
	mpfr_clears(x, y, value, (mpfr_ptr)0);
}

static int is_same(double own, double libm)
{
	return (isnan(own) && isnan(libm)) || (own == libm && signbit(own) == signbit(libm)) ||
	       (fabs(own - libm) <= 4 * DBL_EPSILON * fabs(libm) && signbit(own) == signbit(libm));
}

/* As appendix F of C99 says, which the library here does */
static void test_ends(void)
{
	static const double end[] = { 0.0, -0.0, 1, -1, 0.5, -0.5, 2, -2, 3, -3, INFINITY, -INFINITY, NAN, 1e308,
				      -1e308, 5e-324, -5e-324, DBL_MIN, 0x1p53 - 1, 1 - 0x1p53, 4503599627370497.5 };
	enum { ENDS = sizeof end / sizeof *end };
	static const struct { const char *name; double (*own)(double), (*libm)(double); } one[] = {
		{ "sin", pl_sin, sin }, { "cos", pl_cos, cos }, { "tan", pl_tan, tan }, { "exp", pl_exp, exp },
		{ "log", pl_log, log }, { "sqrt", pl_sqrt, sqrt }, { "sinh", pl_sinh, sinh }, { "cosh", pl_cosh, cosh },
		{ "tanh", pl_tanh, tanh }, { "asin", pl_asin, asin }, { "acos", pl_acos, acos },
		{ "atan", pl_atan, atan }
	};
	int good = 1;
	for (size_t k = 0; k < sizeof one / sizeof *one; k++)
		for (int i = 0; i < ENDS; i++)
			if (!is_same(one[k].own(end[i]), one[k].libm(end[i]))) {
				printf("# %s(%g) = %a, expected %a\n", one[k].name, end[i], one[k].own(end[i]),
				       one[k].libm(end[i]));
				good = 0;
			}
	for (int i = 0; i < ENDS * ENDS; i++) {
		const double x = end[i / ENDS], y = end[i % ENDS];
		if (!is_same(pl_pow(x, y), pow(x, y)) || !is_same(pl_atan2(x, y), atan2(x, y))) {
			printf("# pow(%g, %g) = %a, expected %a; atan2: %a, %a\n", x, y, pl_pow(x, y), pow(x, y),
			       pl_atan2(x, y), atan2(x, y));
			good = 0;
		}
	}
	result(good, "infinities, zeros, NaN, the smallest and the largest numbers");
}

int main(void)
{
	const struct range angles = { -10, 10, -60, 709, 1e308, 0 }, exponents = { -750, 710, -60, 3, 1e308, 0 };
	const struct range all = { 0.5, 2, -740, 709, 1e308, 1 }, ratios = { -1, 1, -700, 0, 1, 0 };
	const struct range any = { -10, 10, -700, 700, 1e308, 0 }, hyperbolic = { -3, 3, -60, 6.5, 1e308, 0 };
	test_one("sin", pl_sin, mpfr_sin, angles, 0.6);
	test_one("cos", pl_cos, mpfr_cos, angles, 0.6);
	test_one("tan", pl_tan, mpfr_tan, angles, 2);
	test_one("exp", pl_exp, mpfr_exp, exponents, 0.52);
	test_one("log", pl_log, mpfr_log, all, 0.52);
	test_one("sqrt", pl_sqrt, mpfr_sqrt, all, 0.5);
	test_one("sinh", pl_sinh, mpfr_sinh, hyperbolic, 2);
	test_one("cosh", pl_cosh, mpfr_cosh, hyperbolic, 1.2);
	test_one("tanh", pl_tanh, mpfr_tanh, hyperbolic, 2.5);
	test_one("asin", pl_asin, mpfr_asin, ratios, 0.52);
	test_one("acos", pl_acos, mpfr_acos, ratios, 0.52);
	test_one("atan", pl_atan, mpfr_atan, any, 0.52);
	test_two("pow", pl_pow, mpfr_pow, 3, 200, 0.52);
	test_two("atan2", pl_atan2, mpfr_atan2, 100, 10, 0.52);
	test_ends();
	printf("1..%d\n", count);
	return failed;
}
