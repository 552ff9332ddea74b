/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Poles and polynomials as a reader wants to see them: good to the printed digits, in a fixed order. */
#include "model/linear/relative.h"
#include "report/report.h"
#include "step/series/switching.h"
#include "step/linear/images.h"

#include <math.h>

#include <stdlib.h>
#include <string.h>

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

const char *pole_row(const struct pole_report *r)
{
	return format("%-36s %-16.8g %.8g", pole_text(r), mpfr_get_d(r->hertz, MPFR_RNDN),
		      mpfr_get_d(r->damping_ratio, MPFR_RNDN));
}

double growth_rate(const struct step *step)
{
	return mpfr_get_d(step->linear.growth, MPFR_RNDN);
}

static void json_pole(FILE *to, const struct pole_report *pole, bool conjugate, bool first)
{
	double im = mpfr_get_d(pole->im, MPFR_RNDN);
	fprintf(to, "%s\n    {\"re\": %s, \"im\": %s, \"multiplicity\": %d}", first ? "" : ",",
		json_number(mpfr_get_d(pole->re, MPFR_RNDN)), json_number(conjugate ? -im : im), pole->multiplicity);
}

void json_pole_list(FILE *to, int count, const struct pole_report *pole)
{
	fputs("  \"poles\": [", to);
	for (int i = 0; i < count; i++) {
		json_pole(to, &pole[i], false, i == 0);
		if (pole[i].pair)
			json_pole(to, &pole[i], true, false);
	}
	fputs("]", to);
}

static const char *power_text(mpq_srcptr c, int k, bool first)
{
	RATIONAL size = ZERO;
	mpq_abs(size, c);
	const char *factor = k > 0 && mpq_cmp_ui(size, 1, 1) == 0 ? "" : readable_text(size);
	const char *power = k == 0 ? "" : k == 1 ? "s" : format("s^%d", k);
	const char *sign = mpq_sgn(c) < 0 ? first ? "-" : " - " : first ? "" : " + ";
	return format("%s%s%s%s", sign, factor, *factor && k ? " " : "", power);
}

/* Lines of up to 100 columns, below what stands behind `B(s) = ` */
const char *polynomial_text(int length, const mpq_t *c)
{
	enum { INDENT = 11, COLUMNS = 100 };
	const char *text = "";
	size_t column = INDENT;
	for (int k = length - 1; k >= 0; k--) {
		if (mpq_sgn(c[k]) == 0)
			continue;
		const char *term = power_text(c[k], k, *text == 0);
		bool full = column + strlen(term) > COLUMNS;
		text = full ? format("%s\n%*s%s", text, INDENT - 1, "", term) : format("%s%s", text, term);
		column = (full ? INDENT - 1 : column) + strlen(term);
	}
	return text;
}

const char *irrationals_text(const struct irrationals *used)
{
	const char *text = used->pi ? "pi" : "";
	for (int f = FN_SIN; f <= FN_FRICTION; f++)
		if (used->used[f])
			text = format("%s%s%s", text, *text ? ", " : "", function_name((enum function)f));
	if (used->root)
		text = format("%s%s%s", text, *text ? ", " : "", "roots");
	return *text ? format("Irrational constants (%s) were taken as rationals of %d bits.", text, IRRATIONAL_BITS)
		     : NULL;
}

const char *relative_text(const struct model *model)
{
	const struct relative *r = model->relative;
	const char *list = "";
	for (int j = 0; j < r->written->n; j++)
		if (r->link[j].kind != LINK_NONE)
			list = format("%s%s%s", list, *list ? ", " : "", r->name[j]);
	return list;
}

const char *json_text(const char *name)
{
	const char *text = "";
	for (; *name; name++)
		text = (unsigned char)*name < ' '
			       ? format("%s\\u%04x", text, *name)
			       : format("%s%s%c", text, *name == '\\' || *name == '"' ? "\\" : "", *name);
	return text;
}

const char *json_number(double value)
{
	return isfinite(value) ? format("%.17g", value) : "null";
}

void json_numbers(FILE *to, int count, const double *value)
{
	for (int i = 0; i < count; i++)
		fprintf(to, "%s%s", i ? ", " : "[", json_number(value[i]));
	fputs(count ? "]" : "[]", to);
}

void json_names(FILE *to, const char *key, int count, const char *const *name)
{
	fprintf(to, "\"%s\": [", key);
	for (int i = 0; i < count; i++)
		fprintf(to, "%s\"%s\"", i ? ", " : "", name[i]);
	fputs("]", to);
}

void json_matrix(FILE *to, const char *indent, const char *key, int rows, int columns, int stride, const double *value)
{
	fprintf(to, "\"%s\": [", key);
	for (int i = 0; i < rows; i++) {
		fprintf(to, "%s\n%s", i ? "," : "", indent);
		json_numbers(to, columns, value + i * stride);
	}
	fputs("]", to);
}

void json_rationals(FILE *to, const char *indent, const char *key, int rows, int columns, const mpq_t *value)
{
	SCRATCH double *rounded = ARRAY(double, (size_t)(rows * columns) + 1);
	for (int i = 0; i < rows * columns; i++)
		rounded[i] = nearest_double(value[i]);
	json_matrix(to, indent, key, rows, columns, columns, rounded);
}

const char *breakpoints_text(int count, const mpq_t *at)
{
	const char *text = "";
	for (int k = 0; k < count; k++)
		text = format("%s%s%s", text, k ? ", " : "", readable_text(at[k]));
	return text;
}

const char *rising_text(const struct series_switching *d)
{
	return breakpoints_text(d->breaks, (const mpq_t *)rising_breakpoints(d));
}

const char *two_digits(double count)
{
	double unit = 1;
	while (count / unit >= 99.5)
		unit *= 10;
	return format("%.0f", floor(count / unit + 0.5) * unit);
}
