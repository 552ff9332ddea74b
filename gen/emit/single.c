/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The target float: what is printed for double, with every type, literal and function under its name for float. The
 * numbers are floats already: number.c rounds straight to the target's type. */
#include "emit/emit.h"

#include <ctype.h>
#include <string.h>

/* Of the runtime and of <math.h>, with the name's part before the f; a function of <math.h> counts only where it is
 * called. */
static const struct name { const char *name, *stem; bool called; } names[] = {
	{ "double", "", false }, { "pl_turn", "pl_turn", false }, { "pl_turn_add", "pl_turn", false },
	{ "pl_turn_times", "pl_turn", false }, { "pl_turn_at", "pl_turn", false }, { "pl_rate", "pl_rate", false },
	{ "pl_rate_of", "pl_rate", false }, { "pl_lead", "pl_lead", false }, { "pl_lead_start", "pl_lead", false },
	{ "pl_lead_change", "pl_lead", false },
	{ "pl_cossin", "pl_cossin", false }, { "pl_growth", "pl_growth", false },
	{ "pl_growth_add", "pl_growth", false }, { "pl_growth_times", "pl_growth", false },
	{ "pl_growth_at", "pl_growth", false }, { "pl_growth_value", "pl_growth", false },
	{ "pl_series", "pl_series", false }, { "pl_series_advance", "pl_series", false },
	{ "pl_two", "pl_two", false }, { "pl_power_apply", "pl_power", false }, { "pl_until", "pl_until", false },
	{ "pl_accumulate", "pl_accumulate", false }, { "pl_multiply", "pl_multiply", false },
	{ "pl_multiply_add", "pl_multiply", false }, { "pl_not_finite", "pl_not_finite", false },
	{ "pl_magnitude", "pl_magnitude", false }, { "pl_root", "pl_root", false },
	{ "pl_factor", "pl_factor", false }, { "pl_factor_complex", "pl_factor", false },
	{ "pl_solve", "pl_solve", false }, { "pl_solve_complex", "pl_solve", false },
	{ "pl_term", "pl_term", false }, { "pl_equations", "pl_equations", false },
	{ "pl_equations_at", "pl_equations", false }, { "pl_increment", "pl_increment", false },
	{ "pl_ramp_before", "pl_ramp", false }, { "pl_ramp_cancels", "pl_ramp", false },
	{ "pl_entry", "pl_entry", false }, { "pl_block", "pl_block", false },
	{ "pl_block_increment", "pl_block", false }, { "pl_block_advance", "pl_block", false },
	{ "pl_region_of", "pl_region", false }, { "pl_region_bounds", "pl_region", false },
	{ "pl_cut", "pl_cut", false }, { "pl_cut_advance", "pl_cut", false },
	{ "pl_region_large", "pl_region", false }, { "pl_region_reach", "pl_region", false },
	{ "pl_impact", "pl_impact", false },
	{ "pl_guards", "pl_guards", false }, { "pl_guards_start", "pl_guards", false },
	{ "pl_guards_step", "pl_guards", false }, { "pl_guards_advance", "pl_guards", false },
	{ "pl_guards_change", "pl_guards", false },
	{ "pl_guards_kept_start", "pl_guards", false }, { "pl_guards_kept_step", "pl_guards", false },
	{ "pl_guards_kept_advance", "pl_guards", false }, { "pl_guards_kept_change", "pl_guards", false },
	{ "pl_switching_kept_start", "pl_switching", false }, { "pl_switching_kept_step", "pl_switching", false },
	{ "pl_switching_kept_advance", "pl_switching", false }, { "pl_switching_kept_move", "pl_switching", false },
	{ "pl_switching", "pl_switching", false }, { "pl_switching_start", "pl_switching", false },
	{ "pl_switching_step", "pl_switching", false }, { "pl_switching_advance", "pl_switching", false },
	{ "pl_crossing", "pl_crossing", false }, { "pl_divided", "pl_divided", false },
	{ "pl_divided_place", "pl_divided", false }, { "pl_divided_left", "pl_divided", false },
	{ "pl_divided_rises", "pl_divided", false },
	{ "pl_divided_next", "pl_divided", false }, { "pl_strike", "pl_strike", false },
	{ "pl_instant", "pl_instant", false }, { "pl_chain", "pl_chain", false }, { "pl_events", "pl_events", false },
	{ "pl_events_place", "pl_events", false }, { "pl_events_begin", "pl_events", false },
	{ "pl_events_next", "pl_events", false }, { "pl_events_pass", "pl_events", false },
	{ "pl_events_end", "pl_events", false }, { "pl_events_places", "pl_events", false },
	{ "pl_peak", "pl_peak", false }, { "pl_peak_bend", "pl_peak", false },
	{ "pl_lanes", "pl_lanes", false }, { "pl_lanes_load", "pl_lanes", false },
	{ "pl_lanes_store", "pl_lanes", false },
	{ "pl_lanes_above", "pl_lanes", false }, { "pl_lanes_all", "pl_lanes", false },
	{ "pl_larger_size", "pl_larger_size", false },
	{ "pl_lanes_peak", "pl_lanes", false }, { "pl_lanes_accumulate", "pl_lanes", false },
	{ "pl_model", "pl_model", false },
#define REAL_FUNCTION(NAME, name, argument, value, low, high) { #name, #name, true },
#include "read/functions.def"
#undef REAL_FUNCTION
	{ "fabs", "fabs", true }, { "atan2", "atan2", true },
	{ "pow", "pow", true }, { "fmin", "fmin", true }, { "fmax", "fmax", true },
	{ "copysign", "copysign", true }
};

static const char *print_name(FILE *to, const char *text)
{
	size_t length = name_length(text);
	const char *end = text + length;
	for (size_t i = 0; i < sizeof names / sizeof names[0]; i++) {
		const struct name *n = &names[i];
		if (n->name[0] != text[0] || !is_named(text, length, n->name) || (n->called && *end != '('))
			continue;
		size_t stem = strlen(n->stem);
		put(to, stem ? n->stem : "float", stem ? stem : strlen("float"));
		if (stem) {
			put(to, "f", 1);
			put(to, text + stem, length - stem);
		}
		return end;
	}
	put(to, text, length);
	return end;
}

static bool is_exponent_sign(const char *c, const char *number)
{
	return (*c == '-' || *c == '+') && c > number && c[-1] == 'e';
}

/* 0x1f has no exponent, 1e-5 has one */
static const char *print_number(FILE *to, const char *text)
{
	bool hexadecimal = text[0] == '0' && (text[1] == 'x' || text[1] == 'X'), real = false;
	const char *end = text;
	for (; in_name(*end) || *end == '.' || (!hexadecimal && is_exponent_sign(end, text)); end++)
		real = real || *end == '.' || (!hexadecimal && *end == 'e');
	put(to, text, (size_t)(end - text));
	put(to, "f", real);
	return end;
}

static const char *print_until(FILE *to, const char *text, const char *close)
{
	const char *end = strstr(text + strlen(close), close);
	end = end ? end + strlen(close) : text + strlen(text);
	put(to, text, (size_t)(end - text));
	return end;
}

/* At least one character */
static const char *print_other(FILE *to, const char *text)
{
	const char *end = text + 1;
	while (*end && *end != '/' && *end != '"' && !in_name(*end))
		end++;
	put(to, text, (size_t)(end - text));
	return end;
}

void print_single(FILE *to, const char *text)
{
	while (*text)
		if (strncmp(text, "/*", 2) == 0)
			text = print_until(to, text, "*/");
		else if (*text == '"')
			text = print_until(to, text, "\"");     /* names of states, outputs, files: no escapes */
		else if (isdigit((unsigned char)*text))
			text = print_number(to, text);
		else if (in_name(*text))
			text = print_name(to, text);
		else
			text = print_other(to, text);
}
