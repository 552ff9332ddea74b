/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of a linear step's C, in the order in which they stand there. */
#include "constants.h"
#include "model/linear/inner.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

void append(struct list *list, double value, const char *what)
{
	if (list->count == list->room) {
		list->room = 2 * list->room + 64;
		ENLARGE(list->value, (size_t)list->room);
		ENLARGE(list->what, (size_t)list->room);
	}
	list->value[list->count] = value;
	list->what[list->count++] = what;
}

static bool starts_with(const char *text, const char *start)
{
	return strncmp(text, start, strlen(start)) == 0;
}

/* A sum that stands apart, by its number: its numbers are read wherever another one has it as a term */
static struct list shared[LIMIT_STATES];

static unsigned long part_number(const char *name)
{
	const unsigned long part = starts_with(name, "part") ? strtoul(name + strlen("part"), NULL, 10) : 0;
	return part < LIMIT_STATES ? part : 0;
}

static void use_part(const char *name, struct list *list)
{
	const struct list *part = &shared[part_number(name)];
	for (int i = 0; i < part->count; i++)
		append(list, part->value[i], "");
}

/* Numbers with a point or an exponent from `text` to `end`, in their order; not those in comments.  A minus before one
 * is its sign, whether it subtracts or not: no sum here is subtracted as a whole. */
static void read_numbers(const char *text, const char *end, bool single, struct list *list)
{
	for (bool minus = false; text < end;) {
		if (strncmp(text, "/*", 2) == 0) {
			text = strstr(text, "*/") + 2;
		} else if (isalpha((unsigned char)*text) || *text == '_') {
			use_part(text, list);
			while (isalnum((unsigned char)*text) || *text == '_')
				text++;
			minus = false;
		} else if (isdigit((unsigned char)*text)) {
			char *after;
			const double value = single ? (double)strtof(text, &after) : strtod(text, &after);
			const bool real = strcspn(text, ".e") < (size_t)(after - text);
			if (real && single != (*after == 'f'))
				complain(format("%.*s %s suffix f", (int)(after - text), text, single ? "lacks a"
						: "has a"));
			if (real)
				append(list, minus && value != 0 ? -value : value, "");
			text = after + (*after == 'f');
			minus = false;
		} else {
			if (!isspace((unsigned char)*text))
				minus = *text == '-';
			text++;
		}
	}
}

/* Is this statement one of the step's sums?  The others compute loads and time, or store. */
static bool is_sum(const char *text, const char *end)
{
	static const char *const sums[] = { "part", "kicked", "drifted" };
	for (int i = 0; i < 3; i++)
		if (starts_with(text, format("const double %s", sums[i])) ||
			starts_with(text, format("const float %s", sums[i])))
			return true;
	if (starts_with(text, "s->y["))
		return true;
	while (isalnum((unsigned char)*text) || *text == '_')
		text++;
	return text < end && (starts_with(text, " += ") || starts_with(text, " = pl_accumulate"));
}

static void read_sum(const char *text, const char *end, bool single, struct list *list)
{
	const char *type = single ? "const float " : "const double ";
	const unsigned long part = starts_with(text, type) ? part_number(text + strlen(type)) : 0;
	read_numbers(part ? strchr(text, '=') : text, end, single, part ? &shared[part] : list);
}

void numbers_of_step(const char *code, const char *name, bool single, struct list *list)
{
	const char *body = strstr(code, format("\nstatic void %s_plain_step(%s *s", name, name));
	for (const char *next = code; !body && (next = strstr(next, format("\nvoid %s_step(%s *s", name, name)));
			next++)
		if (strchr(next, '{') < strchr(next, ';'))
			body = next;
	if (!body) {
		complain("no step function");
		return;
	}
	const char *end = strstr(body, "\n}");
	memset(shared, 0, sizeof shared);
	for (const char *at = strchr(body, '{') + 1; at < end;) {
		while (isspace((unsigned char)*at))
			at++;
		if (strncmp(at, "/*", 2) == 0) {
			at = strstr(at, "*/") + 2;
			continue;
		}
		const char *stop = strchr(at, ';');
		if (!stop || stop > end)
			break;
		if (is_sum(at, stop))
			read_sum(at, stop, single, list);
		at = stop + 1;
	}
}

void numbers_of_table(const char *code, const char *name, const char *table, bool single, struct list *list)
{
	const char *at = strstr(code, format(" %s_%s[", name, table));
	while (at && strchr(at, ';') < strchr(at, '='))
		at = strstr(at + 1, format(" %s_%s[", name, table));
	if (!at) {
		complain(format("no table %s", table));
		return;
	}
	read_numbers(strchr(at, '='), strstr(at, "\n};"), single, list);
}
