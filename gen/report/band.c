/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What --response and --amplitude ask for: a band of frequencies, the size of the excitation. */
#include "report/report.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 200 };

static const char range_note[] = "--response takes F0:F1[:N], from and to in Hz, and how many";

bool read_number(const char *text, const char *end, double *number)
{
	char *stop;
	const char *copy = format("%.*s", (int)(end - text), text);
	if (strspn(copy, "0123456789.eE+-") != strlen(copy) || !*copy || *copy == '+' || *copy == '-')
		return false;
	*number = strtod(copy, &stop);
	return !*stop;
}

struct band band_of(const char *text)
{
	struct place at = { source_argument(text), 0 };
	struct band band = { .count = ROWS };
	const char *colon = strchr(text, ':'), *last = colon ? strchr(colon + 1, ':') : NULL,
		   *end = text + strlen(text);
	double rows = ROWS;
	if (!colon) {
		at.offset = strlen(text);
		error(at, range_note, "expected ':' and where the range ends");
	}
	if (!read_number(text, colon, &band.from) || !(band.from > 0 && isfinite(band.from)))
		error(at, range_note, "expected a frequency above 0");
	at.offset = (size_t)(colon + 1 - text);
	if (!read_number(colon + 1, last ? last : end, &band.to) || !(band.to > band.from && isfinite(band.to)))
		error(at, range_note, "expected a frequency above the first");
	at.offset = last ? (size_t)(last + 1 - text) : 0;
	if (last && (!read_number(last + 1, end, &rows) || rows != floor(rows) || rows < 2 ||
		     rows > LIMIT_FREQUENCIES))
		error(at, range_note, "expected a number of frequencies from 2 to %d", LIMIT_FREQUENCIES);
	band.count = (int)rows;
	return band;
}

/* f0 (f1/f0)^(k/(N-1)); the ends as they are given, others good to a double */
double frequency_of(const struct band *band, int row)
{
	if (row == 0 || row == band->count - 1)
		return row ? band->to : band->from;
	REAL f = WITH_BITS(128), ratio = WITH_BITS(128);
	mpfr_set_d(ratio, band->to, MPFR_RNDN);
	mpfr_div_d(ratio, ratio, band->from, MPFR_RNDN);
	mpfr_log(ratio, ratio, MPFR_RNDN);
	mpfr_mul_ui(ratio, ratio, (unsigned long)row, MPFR_RNDN);
	mpfr_div_ui(ratio, ratio, (unsigned long)(band->count - 1), MPFR_RNDN);
	mpfr_exp(ratio, ratio, MPFR_RNDN);
	mpfr_mul_d(f, ratio, band->from, MPFR_RNDN);
	return mpfr_get_d(f, MPFR_RNDN);
}

double amplitude_of(const char *text)
{
	struct place at = { source_argument(text), 0 };
	double amplitude;
	if (!read_number(text, text + strlen(text), &amplitude) || !(amplitude > 0 && isfinite(amplitude)))
		error(at, "--amplitude takes the size of the excitation, in the unit of the input; of a load 1 is as "
			  "it is written", "expected an amplitude above 0");
	return amplitude;
}
