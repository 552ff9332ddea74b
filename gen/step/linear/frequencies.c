/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Natural frequencies and damping ratios: the poles as a reader wants to see them, in a fixed order. */
#include "inner.h"

#include <math.h>
#include <stdlib.h>

enum { REPORT_BITS = 256 };

static void add_report(struct pole_report *r, const struct rectangle *at, int multiplicity, bool pair)
{
	REAL size = WITH_BITS(REPORT_BITS);
	mpfr_inits2(REPORT_BITS, r->re, r->im, r->hertz, r->damping_ratio, NULL);
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

/* Where what misses eliminated constraints decays */
static mpq_t *pole_of_misses(const struct model *model)
{
	mpq_t *pole = rationals(1);
	mpq_set_si(*pole, -DECAY_OF_MISSES, 1);
	if (mpq_sgn(model->h) > 0)
		mpq_div(*pole, *pole, model->h);
	return pole;
}

/* Divides B by s - pole where that leaves 0 */
static bool divide_by_pole(int length, mpq_t *B, mpq_srcptr pole)
{
	RATIONAL carried = ZERO;
	mpq_t *quotient = rationals(length);
	for (int i = length - 1; i >= 0; i--) {         /* that of 0 is what is left */
		mpq_mul(carried, i + 1 < length ? quotient[i + 1] : carried, pole);
		mpq_add(quotient[i], B[i], carried);
	}
	if (mpq_sgn(quotient[0]) != 0)
		return false;
	for (int i = 0; i + 1 < length; i++)
		mpq_set(B[i], quotient[i + 1]);
	return true;
}

int characteristic_of(const struct model *model, const struct resolvent *resolvent, mpq_t **B)
{
	int length = resolvent_determinant(resolvent)->length;
	const mpq_t *pole = pole_of_misses(model);
	*B = rationals(length);
	characteristic_polynomial(resolvent, *B);
	for (int k = 0; k < model->equations.misses && divide_by_pole(length, *B, *pole); k++)
		length--;               /* of some modes alone it has none of them */
	return length;
}

static int leave_misses_out(const struct model *model, int count, struct pole_report *report)
{
	const mpq_t *pole = pole_of_misses(model);
	REAL off = WITH_BITS(REPORT_BITS);
	int kept = 0;
	for (int i = 0; i < count; i++) {
		mpfr_sub_q(off, report[i].re, *pole, MPFR_RNDN);
		if (mpfr_zero_p(report[i].im) && fabs(mpfr_get_d(off, MPFR_RNDN) / mpq_get_d(*pole)) < 1e-60)
			report[i].multiplicity -= model->equations.misses;
		if (report[i].multiplicity > 0)
			report[kept++] = report[i];
	}
	return kept;
}

int poles_of(const struct model *model, const struct resolvent *resolvent, struct pole_report **report)
{
	struct spectrum *spectrum = resolvent_spectrum(resolvent);
	int count = 0;
	if (!spectrum_refine(spectrum, REPORT_BITS))
		error(model->request.at.step, "do two parameters differ by less than their rounding?",
		      "two poles are too close to each other to be told apart");
	*report = ARRAY(struct pole_report, spectrum->D.length);
	if (spectrum->zero)
		add_report(&(*report)[count++], NULL, spectrum->zero, false);
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			add_report(&(*report)[count++], &spectrum->pole[f][i].at, spectrum->factor[f].multiplicity,
				   !spectrum->pole[f][i].real);
	if (model->equations.misses)
		count = leave_misses_out(model, count, *report);
	qsort(*report, (size_t)count, sizeof **report, by_size);
	return count;
}
