/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Undamped models, and such of which rounding to double first would give another float. */
#include "constants.h"
#include "drawn.h"
#include "model/linear/inner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- undamped systems ---- */

/* A decimal with few or many digits and its value */
static double decimal(int least, int most, const char **text)
{
	const int exponent = least + (int)below((unsigned)(most - least + 1));
	*text = below(2) ? format("%.*fe%d", (int)below(3), 1 + (double)below(9000) / 1000, exponent)
					 : format("%.15ge%d", 1 + (double)below(1u << 30) / (double)(1u << 27),
							exponent);
	return strtod(*text, NULL);
}

char *undamped_spec(uint64_t seed)
{
	random_state = seed * UINT64_C(0x9e3779b97f4a7c15) + 7;
	below(2);
	const int n = seed % 15 == 0 ? 7 + (int)below(2) : 1 + (int)below(4);
	const bool equal = below(2), grounded = below(3) > 0, loaded = equal && below(3) == 0,
			   sampled = equal && below(4) == 0;
	double *mass = ARRAY(double, (size_t)n), *row = ARRAY(double, (size_t)n), bound = 1e-6;
	const char *text = "model any\ncoord x1", *value;
	for (int i = 1; i < n; i++)
		text = format("%s, x%d", text, i + 1);
	text = format("%s\n%s", text, sampled ? "input u\ninput v hold first\n" : "");
	for (int i = 0; i < n; i++) {
		if (i == 0 || !equal)
			mass[i] = decimal(-1, 1, &value);
		else
			mass[i] = mass[0];
		text = format("%smass %s at x%d\n", text, value, i + 1);
	}
	for (int i = 0; i < n; i++)
		for (int k = i; k < n; k++)
			if (k == i ? grounded && (i == 0 || below(3) == 0) : k == i + 1 ? below(12) > 0
					: below(5) == 0) {
				const double stiffness = decimal(0, 3, &value);
				row[i] += 2 * stiffness;
				row[k] += 2 * stiffness;
				text = format("%sspring %s between x%d, %s\n", text, value, i + 1,
							  k == i ? "ground" : format("x%d", k + 1));
			}
	for (int i = 0; i < n; i++) {
		bound = fmax(bound, row[i] / mass[i]);
		if (row[i] == 0)
			text = format("%sforce 0*x%d on x%d\n", text, i + 1, i + 1);
	}
	if (loaded)
		text = format("%sforce 3*cos(2.5*t) + 0.7*t on x1\nforce 1.25 on x%d\n", text, n);
	if (loaded && below(2))
		text = format("%sforce t < 0.4 ? 1 : exp(-t) on x1\n", text);
	if (sampled)
		text = format("%sforce 2*u - v on x1\nforce 0.5*v' on x%d\n", text, n);
	const double largest = 2.4 / sqrt(bound);
	return format("%sstep %.6g\n", text,
			largest * pow(10, -(double)below(7)) * (1 - 0.6 * (double)below(1000) / 1000));
}

/* ---- where rounding to double first would give another float ---- */

static int identity(mpfr_ptr y, mpfr_srcptr x, mpfr_rnd_t round)
{
	return mpfr_set(y, x, round);
}
static int cosine_increment(mpfr_ptr h, mpfr_srcptr T, mpfr_rnd_t round)        /* 1 - cos h = T */
{
	mpfr_ui_sub(h, 1, T, round);
	return mpfr_acos(h, h, round);
}
const struct twice twice[TWICE] = {
	{ "h as an entry of Phi, a drift", "x'' = 0", identity, 1 },
	{ "sin h", "x'' + x = 0", mpfr_asin, 1 },
	{ "cos h - 1", "x'' + x = 0", cosine_increment, 1 },
	{ "cos h", "x'' + x = 0", mpfr_acos, 1 },
	{ "-tan(h/2), a kick", "x'' + x = 0", mpfr_atan, 2 },
	{ "1 - cos h, a load", "x'' + x = 1", cosine_increment, 1 },
	{ "1 - cos h, an input", "x'' + x = u", cosine_increment, 1 }
};
char *twice_spec(const struct twice *t)
{
	mpfr_t T, h, shown;
	mpfr_inits2(400, T, h, shown, NULL);
	mpfr_set_ui_2exp(T, 1, -60, MPFR_RNDN);
	mpfr_add_ui(T, T, 1, MPFR_RNDN);
	mpfr_set_d(shown, 0.5 + 0x1p-25, MPFR_RNDN);
	mpfr_mul(T, T, shown, MPFR_RNDN);
	if ((float)mpfr_get_d(T, MPFR_RNDN) == mpfr_get_flt(T, MPFR_RNDN))
		complain("this number does not tell one rounding from two");
	t->angle(h, T, MPFR_RNDN);
	mpfr_mul_ui(h, h, (unsigned long)t->times, MPFR_RNDN);
	char *digits = NULL;
	if (mpfr_asprintf(&digits, "%.80Rf", h) < 0)
		exit(1);
	return format("model any\ncoord x\n%s%s\nstep %s\n", strchr(t->equation, 'u') ? "input u\n" : "", t->equation,
				  digits);
}
