/* SPDX-License-Identifier: GPL-3.0-or-later */
/* C that was printed, read again: what the rewriters (float, locals apart) have in common. They know how
 * emitters write: strings have no escapes, and a line of the preprocessor begins in its first column. */
#include "printed.h"

#include <ctype.h>
#include <string.h>

bool in_name(char c)
{
	return isalnum((unsigned char)c) || c == '_';
}

size_t name_length(const char *text)
{
	size_t length = 0;
	while (in_name(text[length]))
		length++;
	return length;
}

bool is_named(const char *text, size_t length, const char *name)
{
	return strlen(name) == length && memcmp(text, name, length) == 0;
}

bool is_member(const char *word, const char *text)
{
	return word > text && (word[-1] == '.' || (word - text > 1 && word[-2] == '-' && word[-1] == '>'));
}

bool is_hexadecimal(const char *text)
{
	return text[0] == '0' && (text[1] == 'x' || text[1] == 'X');
}

const char *behind_number(const char *text)
{
	const char *exponent = is_hexadecimal(text) ? "pP" : "eE";
	while (in_name(*text) || *text == '.' || (*text && strchr("+-", *text) && strchr(exponent, text[-1])))
		text++;
	return text;
}

/* A character, and all up to a word, a string, a / */
static const char *behind_plain(const char *text)
{
	text++;
	while (*text && *text != '/' && *text != '"' && !in_name(*text))
		text++;
	return text;
}

const char *put_other(FILE *to, const char *text)
{
	const char *quoted = behind_quoted(text, false), *end = quoted ? quoted : behind_plain(text);
	put(to, text, (size_t)(end - text));
	return end;
}

/* Behind a line of the preprocessor, and those that continue it */
static const char *behind_directive(const char *text)
{
	const char *end = text + strcspn(text, "\n");
	while (*end && end[-1] == '\\')
		end += 1 + strcspn(end + 1, "\n");
	return end;
}

const char *behind_quoted(const char *text, bool line_start)
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
	return line_start && *text == '#' ? behind_directive(text) : NULL;
}

const char *behind(const char *text, char last)
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
