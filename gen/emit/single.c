/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The target float: what is printed for double, with every type, literal and function under its name for float. The
 * numbers are floats already: number.c rounds straight to the target's type. Before that, the runtime's functions in
 * the place of those of <math.h>. */
#include "printed.h"

#include <ctype.h>
#include <string.h>

/* Of the runtime: a name that is one of these, or begins so before a _, has an f behind that; longer ones first. */
static const char *const stems[] = {
	"pl_phase", "pl_rate", "pl_lead", "pl_cossin", "pl_envelope", "pl_series_switching", "pl_series", "pl_two",
	"pl_power", "pl_until", "pl_accumulate", "pl_multiply", "pl_not_finite", "pl_magnitude", "pl_root",
	"pl_factor", "pl_solve", "pl_formulas", "pl_increment", "pl_ramp", "pl_entries", "pl_block",
	"pl_group", "pl_cached", "pl_region", "pl_event_split", "pl_impact", "pl_guards", "pl_switching", "pl_crossing",
	"pl_event_impact", "pl_instant", "pl_chain", "pl_events", "pl_peak", "pl_lanes", "pl_larger_size", "pl_model",
	"pl_many", "pl_derivatives", "pl_variation", "pl_varied", "pl_moved", "pl_doubt"
};
/* Of <math.h>, where they are called */
static const char *const functions[] = {
#define REAL_FUNCTION(NAME, name, argument, value, low, high) #name,
#include "read/functions.def"
#undef REAL_FUNCTION
	"fabs", "atan2", "pow", "fmin", "fmax", "copysign"
};

static bool is_function(const char *text, size_t length)
{
	for (size_t i = 0; i < sizeof functions / sizeof *functions && text[length] == '('; i++)
		if (is_named(text, length, functions[i]))
			return true;
	return false;
}

/* Of a name up to where its f goes; 0: it has none */
static size_t stem_of(const char *text, size_t length)
{
	for (size_t i = 0; i < sizeof stems / sizeof *stems; i++) {
		size_t stem = strlen(stems[i]);
		if (length >= stem && memcmp(text, stems[i], stem) == 0 && (length == stem || text[stem] == '_'))
			return stem;
	}
	return is_function(text, length) ? length : 0;
}

static const char *print_name(FILE *to, const char *text)
{
	size_t length = name_length(text), stem = stem_of(text, length);
	bool type = is_named(text, length, "double");
	put(to, type ? "float" : text, type ? strlen("float") : stem);
	put(to, "f", stem > 0);
	put(to, text + stem, type ? 0 : length - stem);
	return text + length;
}

/* 0x1f has no exponent, 1e-5 has one */
static const char *print_number(FILE *to, const char *text)
{
	const char *end = behind_number(text);
	put(to, text, (size_t)(end - text));
	put(to, "f", text + strcspn(text, is_hexadecimal(text) ? "." : ".e") < end);
	return end;
}

void print_single(FILE *to, const char *text, const char *name)
{
	(void)name;
	while (*text)
		text = isdigit((unsigned char)*text) ? print_number(to, text)
		       : in_name(*text)		     ? print_name(to, text)
						     : put_other(to, text);
}

void print_own_functions(FILE *to, const char *text, const char *name)
{
	(void)name;
	while (*text) {
		const size_t length = name_length(text);
		put(to, "pl_", is_function(text, length) ? 3 : 0);
		put(to, text, length);
		text = length > 0 ? text + length : put_other(to, text);
	}
}
