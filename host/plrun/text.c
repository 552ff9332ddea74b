/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Numbers as text, as plmain.c prints them; t = k h as a person writes it. */
#include "plrun.h"
#include "host/digits.h"

#include <stdlib.h>
#include <string.h>

char *put_shortest(char *to, double value, bool single)
{
	if (value - value != 0)
		return to + sprintf(to, "%g", value);
	if (value < 0) {
		*to++ = '-';
		value = -value;
	} else if (value == 0) {
		value = 0; /* not -0 */
	}
	return digits_text(to, digits_shortest(value, single), single ? 6 : 15);
}

/* What the type prints h as is what the spec says, unless that is no short decimal (1/3): then k h has the digits of
 * its own. */
char *put_time(char *to, uint64_t k, double h, bool single)
{
	digits_decimal step = digits_shortest(h, single);
	uint64_t longest = single ? 1000000 : 1000000000000000;
	if (step.digits == 0 || step.digits >= longest || k > UINT64_C(9000000000000000000) / step.digits)
		return put_shortest(to, single ? (double)(float)((double)k * h) : (double)k * h, single);
	uint64_t digits = k * step.digits;
	if (digits < 1000000000000000)          /* no other number of so few digits reads back the same */
		return digits_text(to, digits ? digits_stripped(digits, step.exponent) : (digits_decimal){ 0, 0 }, 15);
	char text[LONGEST * 2];
	snprintf(text, sizeof text, "%llue%d", (unsigned long long)digits, step.exponent);
	return put_shortest(to, strtod(text, NULL), false);
}

/* The quotient of two numbers that doubles hold is what its decimal reads back as. */
double time_number(uint64_t k, double h, bool single)
{
	digits_decimal step = digits_shortest(h, single);
	const uint64_t whole = UINT64_C(1) << 53;
	if (step.exponent <= 0 && step.exponent >= -22 && step.digits > 0 &&
	    step.digits < (single ? 1000000u : whole) && k < whole / step.digits) {
		double ten = 1;
		for (int i = step.exponent; i < 0; i++)
			ten *= 10;
		return (double)(k * step.digits) / ten;
	}
	char text[LONGEST];
	*put_time(text, k, h, single) = 0;
	return strtod(text, NULL);
}

const char *shortest(double value, bool single)
{
	char text[LONGEST];
	*put_shortest(text, value, single) = 0;
	return format("%s", text);
}

bool read_number(const char *text, double *value)
{
	char *end;
	if (strspn(text, "+-.0123456789eE") != strlen(text))
		return false;
	double read = digits_read(text, &end);
	if (end == text || *end || read - read != 0)
		return false;
	*value = read;
	return true;
}
