/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Poles and polynomials as a reader wants to see them: good to the printed digits, in a fixed order. */
#include "plgen.h"

#include <stdlib.h>
#include <string.h>

enum { REPORT_BITS = 256 };

static void add_report(struct pole_report *r, const struct rectangle *at, int multiplicity, bool pair)
{
	mpfr_t size;
	mpfr_inits2(REPORT_BITS, r->re, r->im, r->hertz, r->damping_ratio, size, NULL);
	r->multiplicity = multiplicity;
	r->pair = pair;
	mpfr_set_zero(r->re, 1);
	mpfr_set_zero(r->im, 1);
	if (at) {
		mpfi_mid(r->re, at->re);
		mpfi_mid(r->im, at->im);
	}
	mpfr_hypot(size, r->re, r->im, MPFR_RNDN);
	mpfr_set_zero(r->damping_ratio, 1);
	if (!mpfr_zero_p(size) && !mpfr_zero_p(r->re)) {
		mpfr_div(r->damping_ratio, r->re, size, MPFR_RNDN);
		mpfr_neg(r->damping_ratio, r->damping_ratio, MPFR_RNDN);
	}
	mpfr_const_pi(r->hertz, MPFR_RNDN);
	mpfr_mul_ui(r->hertz, r->hertz, 2, MPFR_RNDN);
	mpfr_div(r->hertz, size, r->hertz, MPFR_RNDN);
	mpfr_clear(size);
}

/* by |p|, then real part, then imaginary part */
static int by_size(const void *left, const void *right)
{
	const struct pole_report *a = left, *b = right;
	double x = mpfr_get_d(a->hertz, MPFR_RNDN), y = mpfr_get_d(b->hertz, MPFR_RNDN);
	if (x != y)
		return x < y ? -1 : 1;
	int order = mpfr_cmp(a->re, b->re);
	return order ? order : mpfr_cmp(a->im, b->im);
}

int poles_of(const struct resolvent *resolvent, struct pole_report **report)
{
	mpz_t content;
	mpz_init(content);
	struct spectrum *spectrum = spectrum_of(poly_primitive(*resolvent_determinant(resolvent), content));
	mpz_clear(content);
	int count = 0;
	if (!spectrum_refine(spectrum, REPORT_BITS))
		abandon();
	*report = ARRAY(struct pole_report, (size_t)spectrum->D.length);
	if (spectrum->zero)
		add_report(&(*report)[count++], NULL, spectrum->zero, false);
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			add_report(&(*report)[count++], &spectrum->pole[f][i].at, spectrum->factor[f].multiplicity, !spectrum->pole[f][i].real);
	qsort(*report, (size_t)count, sizeof **report, by_size);
	return count;
}

static const char *digits(mpfr_srcptr x)
{
	return format("%.8g", mpfr_get_d(x, MPFR_RNDN));
}

const char *pole_text(const struct pole_report *r)
{
	const char *text = digits(r->re);
	if (r->pair)
		text = format("%s +- %s i", text, digits(r->im));
	return r->multiplicity > 1 ? format("%s  (%d-fold)", text, r->multiplicity) : text;
}

const char *polynomial_text(int length, const mpq_t *c)
{
	const char *text = "";
	for (int k = length - 1; k >= 0; k--) {
		if (mpq_sgn(c[k]) == 0)
			continue;
		bool negative = mpq_sgn(c[k]) < 0, first = *text == 0;
		mpq_t size;
		mpq_init(size);
		mpq_abs(size, c[k]);
		const char *factor = k > 0 && mpq_cmp_ui(size, 1, 1) == 0 ? "" : readable_text(size);
		const char *power = k == 0 ? "" : k == 1 ? "s" : format("s^%d", k);
		text = format("%s%s%s%s%s", text, first ? (negative ? "-" : "") : negative ? " - " : " + ", factor, *factor && k ? " " : "", power);
		mpq_clear(size);
	}
	return text;
}

const char *wave_text(const struct wave *wave, bool sine)
{
	const char *w = mpq_cmp_ui(wave->w, 1, 1) == 0 ? "t" : format("%s*t", readable_text(wave->w));
	mpq_t size;
	mpq_init(size);
	mpq_abs(size, wave->p);
	const char *text = format("%s(%s", sine ? "sin" : "cos", w);
	if (mpq_sgn(wave->p) != 0)
		text = format("%s %c %s", text, mpq_sgn(wave->p) < 0 ? '-' : '+', readable_text(size));
	mpq_clear(size);
	return format("%s)", text);
}

const char *irrationals_text(const struct irrationals *used)
{
	const char *text = used->pi ? "pi" : "";
	for (int f = FN_SIN; f <= FN_TABLE; f++)
		if (used->used[f])
			text = format("%s%s%s", text, *text ? ", " : "", function_name((enum function)f));
	if (used->root)
		text = format("%s%s%s", text, *text ? ", " : "", "roots");
	return text;
}
