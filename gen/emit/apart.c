/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Locals apart from the model's type: a model called s or tau has functions whose parameters and locals would hide
 * the type's name. In its C they get another name; the C of every other model stays as it is. What reads the C here
 * knows how the emitter writes: `NAME *s`, `NAME s`, `struct NAME` are the type, products have blanks on both sides. */
#include "emit/emit.h"

#include <ctype.h>
#include <string.h>

static bool in_name(char c)
{
	return isalnum((unsigned char)c) || c == '_';
}

static size_t name_length(const char *text)
{
	size_t length = 0;
	while (in_name(text[length]))
		length++;
	return length;
}

static bool is_word(const char *text, size_t length, const char *word)
{
	return strlen(word) == length && memcmp(text, word, length) == 0;
}

/* Behind a comment, a string, or a line of the preprocessor that starts here; NULL: none does */
static const char *behind_quoted(const char *text, bool line_start)
{
	const char *end = NULL;
	if (strncmp(text, "/*", 2) == 0) {
		end = strstr(text + 2, "*/");
		return end ? end + 2 : text + strlen(text);
	}
	if (*text == '"') {
		end = strchr(text + 1, '"');            /* names of states, outputs, files: no escapes */
		return end ? end + 1 : text + strlen(text);
	}
	return line_start && *text == '#' ? text + strcspn(text, "\n") : NULL;
}

/* Behind the first `last` that is in no braces */
static const char *behind(const char *text, char last)
{
	for (int depth = 0; *text; text++) {
		const char *quoted = behind_quoted(text, false);
		if (quoted)
			text = quoted - 1;
		else if (*text == '{')
			depth++;
		else if (*text == '}')
			depth--;
		if (!quoted && depth == 0 && *text == last)
			return text + 1;
	}
	return text;
}

/* Behind a typedef, or the tag and the members of a struct: `text` is at the word, of that length. NULL: it is
 * neither. */
static const char *behind_type(const char *text, size_t length)
{
	if (is_word(text, length, "typedef"))
		return behind(text, ';');
	if (!is_word(text, length, "struct"))
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

static bool is_member(const char *start, const char *text)
{
	return start > text && (start[-1] == '.' || (start[-1] == '>' && start - 1 > text && start[-2] == '-'));
}

void print_apart(FILE *to, const char *text, const char *name)
{
	const char *other = format("the_%s", name);
	while (strstr(text, other))
		other = format("the_%s", other);
	for (const char *at = text; *at; ) {
		const char *end = behind_quoted(at, at == text || at[-1] == '\n');
		size_t length = end ? 0 : name_length(at);
		if (length)
			end = behind_type(at, length);
		if (length && !end && is_word(at, length, name) && !is_member(at, text) && !is_type(at + length))
			put(to, other, strlen(other));
		else
			put(to, at, (size_t)((end ? end : at + (length ? length : 1)) - at));
		at = end ? end : at + (length ? length : 1);
	}
}
