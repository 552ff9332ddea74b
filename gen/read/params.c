/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Other values of params than the spec's: of -D, and of files.
 *
 *     JSON = { "NAME": value, ... }, value = a number | "EXPR" | an object, whose names are those of the part NAME
 *     CSV  = [ name,value ] { NAME,EXPR }, a line each; lines that are blank or begin with # between them
 *
 * Nothing needs escapes but the quotes of a unit, \" in JSON, "" in CSV; of these the first character becomes a space,
 * so a value is read where it stands, and messages show that place. */
#include "read/read.h"

#include <string.h>

struct reader {
	struct definitions *to;
	const struct source *source;
	char *text;                 /* that of the source, a copy */
	size_t position;
	int depth;
	char escape;                /* before the quotes of a unit */
};

static struct place here(const struct reader *r)
{
	return (struct place){ r->source, r->position };
}

static void add(struct reader *r, const char *name, size_t at, size_t from, size_t until)
{
	*MORE(r->to->definition, r->to->count) = (struct definition){ name, { r->source, at }, from, until };
}

static bool take_character(struct reader *r, char c)
{
	r->position += strspn(r->text + r->position, " \t\r\n");
	if (r->text[r->position] != c)
		return false;
	r->position++;
	return true;
}

static _Noreturn void expected(const struct reader *r, const char *what)
{
	const char c = r->text[r->position];
	error(here(r), "for example: {\"k\": 18000, \"front\": {\"c\": \"2*c0\"}}", "expected %s, found %s", what,
	      c ? format("'%.1s'", (unsigned char)c < ' ' || (unsigned char)c > '~' ? "?" : r->text + r->position)
		: "the end of the file");
}

/* What is between quotes, the first of which is taken: its end */
static size_t read_quoted(struct reader *r, bool value)
{
	const size_t from = r->position;
	size_t until = from + strcspn(r->text + from, "\"\\\n");
	while (value && r->text[until] == r->escape && r->text[until + 1] == '"') {
		r->text[until] = ' ';
		until += 2 + strcspn(r->text + until + 2, "\"\\\n");
	}
	if (r->text[until] == '\\')
		error((struct place){ r->source, until }, "the quotes of a unit may be \\\"",
		      "names and expressions have no escapes");
	if (r->text[until] != '"')
		error((struct place){ r->source, from - 1 }, NULL, "the string has no end in this line");
	r->position = until + 1;
	return until;
}

static void read_object(struct reader *r, const char *part);

static void read_value(struct reader *r, const char *name, size_t at)
{
	if (take_character(r, '{')) {
		read_object(r, format("%s.", name));
		return;
	}
	const bool quoted = take_character(r, '"');
	const size_t from = r->position;
	if (!quoted && !strchr("-0123456789", r->text[from]))
		expected(r, "a number, an expression in quotes or an object");
	if (!quoted)
		r->position += strcspn(r->text + from, ",}] \t\r\n");
	add(r, name, at, from, quoted ? read_quoted(r, true) : r->position);
}

/* Behind its brace */
static void read_object(struct reader *r, const char *part)
{
	if (++r->depth > LIMIT_NESTING)
		error(here(r), NULL, "nesting over the limit of %d", LIMIT_NESTING);
	if (take_character(r, '}'))
		return;
	do {
		if (!take_character(r, '"'))
			expected(r, "the name of a param in quotes");
		const size_t at = r->position, until = read_quoted(r, false);
		const char *name = format("%s%.*s", part, (int)(until - at), r->text + at);
		if (!take_character(r, ':'))
			expected(r, "':'");
		read_value(r, name, at);
	} while (take_character(r, ','));
	if (!take_character(r, '}'))
		expected(r, "',' or '}'");
	r->depth--;
}

static void read_json(void *context)
{
	struct reader *r = context;
	if (!take_character(r, '{'))
		expected(r, "'{'");
	read_object(r, "");
	r->position += strspn(r->text + r->position, " \t\r\n");
	if (r->text[r->position])
		expected(r, "the end of the file");
}

/* A cell without the white space around it, or what its quotes hold; the position is then just behind it. */
static size_t read_cell(struct reader *r, const char *end, size_t *from)
{
	const char *text = r->text;
	r->position += strspn(text + r->position, " \t");
	*from = r->position;
	if (text[*from] == '"') {
		*from = ++r->position;
		const size_t until = read_quoted(r, true);
		r->position += strspn(text + r->position, " \t\r");
		return until;
	}
	r->position += strcspn(text + *from, end);
	size_t until = r->position;
	while (until > *from && strchr(" \t\r", text[until - 1]))
		until--;
	return until;
}

static void read_row(struct reader *r)
{
	static const char note[] = "a row is NAME,VALUE; of many runs, a row each, is plrun --sweep FILE.csv";
	size_t at, from;
	const size_t name_end = read_cell(r, ",\n", &at);
	const char *name = format("%.*s", (int)(name_end - at), r->text + at);
	if (strchr("+-.0123456789", *name) || r->text[r->position] != ',')
		error((struct place){ r->source, at }, note, "a row without a name and a value of a param");
	r->position++;
	const size_t until = read_cell(r, "\n", &from);
	if (r->text[r->position] && r->text[r->position] != '\n')
		error(here(r), note, "unexpected text behind the value");
	if (until == from)
		error((struct place){ r->source, from }, note, "expected a value of '%s'", name);
	const bool head = strcmp(name, "name") == 0 && until - from == 5 && strncmp(r->text + from, "value", 5) == 0;
	if (!head || r->to->count > 0)
		add(r, name, at, from, until);
}

static void read_csv(void *context)
{
	struct reader *r = context;
	while (r->position += strspn(r->text + r->position, " \t\r\n"), r->text[r->position])
		if (r->text[r->position] == '#')
			r->position += strcspn(r->text + r->position, "\n");
		else
			read_row(r);
}

bool definitions_read(const char *path, struct definitions *to)
{
	const struct source *read = source_read(path, (struct place){ 0 });
	if (!read)
		return false;
	struct source *source = NEW(struct source);
	char *text = ARRAY(char, read->length + 1);
	memcpy(text, read->text, read->length);
	*source = *read;
	source->text = text;
	const bool csv = strcmp(path + strlen(path) - 4, ".csv") == 0;
	struct reader r = { .to = to, .source = source, .text = text, .escape = csv ? '"' : '\\' };
	r.position = strncmp(text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
	return statement_guard(csv ? read_csv : read_json, &r);
}

void definitions_add(const char *text, struct definitions *to)
{
	const size_t equals = strcspn(text, "=");
	const struct source *source = source_argument(text);
	*MORE(to->definition, to->count) = (struct definition){ format("%.*s", (int)equals, text), { source, 0 },
								equals + 1, source->length };
}
