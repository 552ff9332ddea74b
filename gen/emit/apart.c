/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Locals apart from the model's type: a model called s or tau has functions whose parameters and locals would hide
 * the type's name. In its C they get another name; the C of every other model stays as it is. What reads the C here
 * knows how the emitter writes: `NAME *s`, `NAME s`, `struct NAME` are the type, products have blanks on both sides. */
#include "printed.h"

#include <string.h>

/* Behind a typedef, or the tag and the members of a struct or union: `text` is at the word, of that length. NULL: it is
 * neither. */
static const char *behind_type(const char *text, size_t length)
{
	if (is_named(text, length, "typedef"))
		return behind(text, ';');
	if (!is_named(text, length, "struct") && !is_named(text, length, "union"))
		return NULL;
	const char *tag = text + length + strspn(text + length, " "), *end = tag + name_length(tag);
	return end[strspn(end, " ")] == '{' ? behind(end, '}') : end;
}

/* NAME ident or NAME *ident */
static bool is_type(const char *end)
{
	size_t blanks = strspn(end, " ");
	return blanks > 0 && (in_name(end[blanks]) || (end[blanks] == '*' && in_name(end[blanks + 1])));
}

void print_apart(FILE *to, const char *text, const char *name)
{
	const char *other = format("the_%s", name), *from = text;
	while (strstr(text, other))
		other = format("the_%s", other);
	for (const char *at = text; *at; ) {
		const char *end = behind_quoted(at, at == text || at[-1] == '\n');
		size_t length = end ? 0 : name_length(at);
		if (length)
			end = behind_type(at, length);
		if (length && !end && is_named(at, length, name) && !is_member(at, text) && !is_type(at + length)) {
			put(to, from, (size_t)(at - from));
			put(to, other, strlen(other));
			from = at + length;
		}
		at = end ? end : at + (length ? length : 1);
	}
	put(to, from, strlen(from));
}
