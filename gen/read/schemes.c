/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The schemes and the forms of a step, by name. */
#include "read/read.h"

#include <string.h>

#define SCHEME(id, recipe, ...) [SCHEME_##id] = { __VA_ARGS__ },
static const struct scheme_row rows[SCHEMES] = {
#include "read/schemes.def"
};
#undef SCHEME

const struct scheme_row *scheme_row(enum scheme scheme)
{
	return &rows[scheme];
}

bool chooses_operator(enum scheme scheme)
{
	return !rows[scheme].holds_coupling && !rows[scheme].expands;
}

const char *scheme_name(enum scheme scheme)
{
	return rows[scheme].name;
}

bool scheme_of(const char *name, enum scheme *scheme)
{
	for (int i = 0; i < SCHEMES; i++)
		if (strcmp(name, rows[i].name) == 0) {
			*scheme = (enum scheme)i;
			return true;
		}
	return false;
}

const char *nearest_scheme(const char *name)
{
	/* methods of other programs, which are meant as they stand: what there is instead is the whole list */
	static const char *const other[] = {
		"rk2", "rk3", "rk4", "rk45", "rkf45", "rk", "euler", "heun", "midpoint", "verlet", "leapfrog",
		"newmark", "hht", "ode23", "ode45", "ode15s", "dopri5", "bdf", "bdf2", "ab2", "ab4", "cvode", "lsoda"
	};
	const char *known[SCHEMES];
	if (place_among(sizeof other / sizeof *other, other, name, strlen(name)) >= 0)
		return NULL;
	for (int i = 0; i < SCHEMES; i++)
		known[i] = rows[i].name;
	return nearest_name(name, SCHEMES, known);
}

enum scheme default_scheme(void)
{
	int i = 0;
	while (!rows[i].by_default)
		i++;
	return (enum scheme)i;
}

/* ---- lists of them, in messages ---- */

static bool is_any(const struct scheme_row *row) { return row->name; }
static bool leaves(const struct scheme_row *row) { return row->leaves && !row->modes; }      /* anything */
/* At events, which end what a method knows of the steps behind it */
static bool stops(const struct scheme_row *row)
{
	return (row->leaves && row->points == 0) || row->holds_coupling;
}

static bool holds(const struct scheme_row *row) { return row->holds_coupling; }

/* a, b<last>c of those that are meant */
static const char *listed(bool (*meant)(const struct scheme_row *), const char *separator, const char *last)
{
	const char *text = "", *before = "";
	int left = 0;
	for (int i = 0; i < SCHEMES; i++)
		left += meant(&rows[i]);
	for (int i = 0; i < SCHEMES; i++) {
		if (!meant(&rows[i]))
			continue;
		text = format("%s%s%s", text, before, rows[i].name);
		before = --left == 1 ? last : separator;
	}
	return text;
}

const char *all_schemes(const char *separator)
{
	return listed(is_any, separator, separator);
}

const char *leaving_schemes(const char *last)
{
	return listed(leaves, ", ", last);
}

bool stops_at_events(enum scheme scheme)
{
	return stops(&rows[scheme]);
}

bool is_event_split(enum scheme scheme)
{
	return stops(&rows[scheme]) && !rows[scheme].expands;
}

const char *stopping_schemes(void)
{
	return listed(stops, ", ", " and ");
}

const char *holding_schemes(void)
{
	return listed(holds, ", ", " and ");
}

const char *scheme_note(enum scheme scheme, int order)
{
	enum { WORDS = 5 };
	static const char *const ordinal[WORDS] = { "zeroth", "first", "second", "third", "fourth" };
	const struct scheme_row *row = &rows[scheme];
	order = row->order ? row->order : order;
	return format("Scheme %s, of %s order in h: %s.", row->name,
		      order < WORDS ? ordinal[order] : format("%d%s", order, order > 20 && order % 10 == 1   ? "st"
									     : order > 20 && order % 10 == 2 ? "nd"
									     : order > 20 && order % 10 == 3 ? "rd"
													     : "th"),
		      row->method);
}

/* ---- forms ---- */

static const char *const names[STEP_FORMS] = { "auto", "direct", "delta", "kick-drift-kick", "modal" };

const char *step_form_name(enum step_form form)
{
	return names[form];
}

bool step_form_of(const char *name, enum step_form *form)
{
	const int place = place_among(STEP_FORMS, names, name, strlen(name));
	*form = place < 0 ? *form : (enum step_form)place;
	return place >= 0;
}
