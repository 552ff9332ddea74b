/* SPDX-License-Identifier: GPL-3.0-or-later */
/* CSV as spreadsheets and loggers write it: separated by ; or tabs or commas, quoted or not, with a decimal comma where
 * that separates nothing, a byte order mark, CRLF, "sep=;" on a line of its own, lines of comment (#) before all. */
#define _GNU_SOURCE
#include "plrun.h"

#include <errno.h>
#include <stdlib.h>
#include <string.h>

struct place table_place(const struct table *t, size_t column)
{
	struct place at = t->at;
	at.column = column;
	return at;
}

struct place header_place(const struct table *t, size_t column)
{
	struct place at = t->header_at;
	at.column = t->header ? t->header[column].column : 0;
	return at;
}

/* The next line into `at`, as bytes */
static bool next_line(struct table *t)
{
	if (t->next >= t->length)
		return false;
	const char *line = t->text + t->next, *end = memchr(line, t->line_end, t->length - t->next);
	size_t length = end ? (size_t)(end - line) : t->length - t->next;
	t->next += length + 1;
	t->at.number++;
	t->at.line = line;
	t->at.length = length && line[length - 1] == '\r' ? length - 1 : length;
	t->at.column = 0;
	if (memchr(line, 0, t->at.length))
		fail_at(t->at, "save it as text, UTF-8", "this is no text: it has bytes that are 0");
	return true;
}

static bool is_blank(const struct table *t)
{
	for (size_t i = 0; i < t->at.length; i++)
		if (t->at.line[i] != ' ' && t->at.line[i] != '\t')
			return false;
	return true;
}

static bool is_comment(const struct table *t)
{
	return t->at.length > 0 && t->at.line[0] == '#';
}

/* ; before tabs before commas, whichever the line has outside quotes */
static char separator_of(struct place line)
{
	bool quoted = false, tab = false;
	for (size_t i = 0; i < line.length; i++) {
		if (line.line[i] == '"')
			quoted = !quoted;
		else if (!quoted && line.line[i] == ';')
			return ';';
		else if (!quoted && line.line[i] == '\t')
			tab = true;
	}
	return tab ? '\t' : ',';
}

/* A cell in quotes that begins at `from`: its text to `to`; returns where it ends */
static size_t take_quoted(struct table *t, size_t from, char **to)
{
	for (size_t i = from + 1; i < t->at.length; i++) {
		if (t->at.line[i] != '"') {
			*(*to)++ = t->at.line[i];
		} else if (i + 1 < t->at.length && t->at.line[i + 1] == '"') {
			*(*to)++ = '"';
			i++;
		} else {
			return i + 1;
		}
	}
	fail_at(table_place(t, from), NULL, "this quote is not closed");
}

static bool is_space(const struct table *t, size_t i)
{
	return t->at.line[i] == ' ' || (t->at.line[i] == '\t' && t->separator != '\t');
}

/* The cell that begins at `from`, its text to `to`; returns where it ends: at a separator or the end of the line */
static size_t take_cell(struct table *t, size_t from, struct cell *cell, char **to)
{
	size_t i = from, end;
	while (i < t->at.length && is_space(t, i))
		i++;
	cell->column = i;
	cell->text = *to;
	cell->quoted = i < t->at.length && t->at.line[i] == '"';
	if (cell->quoted) {
		i = take_quoted(t, i, to);
		while (i < t->at.length && is_space(t, i))
			i++;
		if (i < t->at.length && t->at.line[i] != t->separator)
			fail_at(table_place(t, i), NULL, "expected a separator behind the quote");
	} else {
		while (i < t->at.length && t->at.line[i] != t->separator)
			*(*to)++ = t->at.line[i++];
		for (end = i; *to > cell->text && is_space(t, end - 1); end--)
			(*to)--;
	}
	*(*to)++ = 0;
	return i;
}

static void split(struct table *t)
{
	if (t->words_room < 2 * t->at.length + 2)
		t->words = need(realloc(t->words, t->words_room = 4 * t->at.length + 64));
	char *to = t->words;
	t->cells = 0;
	for (size_t i = 0; ; i++) {
		t->cell = grown(t->cell, t->cells, &t->cell_room, sizeof *t->cell);
		i = take_cell(t, i, &t->cell[t->cells++], &to);
		if (i >= t->at.length)
			return;
	}
}

/* ---- the first lines ---- */

/* Of the separator that a line of its own names, "sep=;"; 0: it does not */
static char named_separator(struct place line)
{
	return line.length == 5 && strncmp(line.line, "sep=", 4) == 0 ? line.line[4] : 0;
}

/* Is the first cell that is not empty no number? */
static bool has_name(const struct table *t)
{
	double value;
	char first[64];
	size_t cell = 0;
	while (cell + 1 < t->cells && !*t->cell[cell].text)
		cell++;
	snprintf(first, sizeof first, "%s", t->cell[cell].text);
	for (char *comma = first; (comma = strchr(comma, ','));)
		*comma = '.';
	return !read_number(first, &value) && *first;
}

static void keep_header(struct table *t)
{
	t->header = t->cell;
	t->columns = t->cells;
	t->header_at = t->at;
	t->cell = NULL;
	t->words = NULL;
	t->cell_room = t->words_room = 0;
}

void table_open(struct table *t, const char *path)
{
	size_t length;
	char *text = read_whole(path, &length);
	if (!text)
		fail(WRONG_DATA, format("cannot read '%s': %s", path, strerror(errno)));
	table_begin(t, path, text, length);
}

void table_begin(struct table *t, const char *path, char *text, size_t length)
{
	*t = (struct table){ .path = path, .at = { .path = strcmp(path, "-") == 0 ? "<stdin>" : path } };
	t->text = text;
	t->length = length;
	t->line_end = memchr(text, '\n', length) ? '\n' : '\r';       /* which alone ends lines of old spreadsheets */
	if (t->length >= 2 && (memcmp(t->text, "\xFF\xFE", 2) == 0 || memcmp(t->text, "\xFE\xFF", 2) == 0))
		fail(WRONG_DATA, format("%s is UTF-16: save it as UTF-8", t->at.path));
	if (t->length >= 3 && memcmp(t->text, "\xEF\xBB\xBF", 3) == 0)
		t->next = 3;
	char named = 0;
	do {
		if (!next_line(t)) {
			t->at.length = 0;
			t->at.number += t->at.number == 0;
			fail_at(t->at, NULL, "expected rows of numbers, found the end of the file");
		}
		named = named ? named : named_separator(t->at);
	} while (is_blank(t) || is_comment(t) || named_separator(t->at));
	t->separator = named ? named : separator_of(t->at);
	split(t);
	t->columns = t->cells;
	if (has_name(t))
		keep_header(t);
	else
		t->next = (size_t)(t->at.line - t->text), t->at.number--;
}

/* ---- rows ---- */

/* Blank lines may stand at the end, and nowhere else. */
static bool skip_end(struct table *t)
{
	struct place gap = t->at;
	while (next_line(t))
		if (!is_blank(t) && !is_comment(t))
			fail_at(gap, NULL, "a row is missing: the line is empty, and others follow it");
	t->at = gap;
	return false;
}

bool table_next(struct table *t)
{
	do {
		if (!next_line(t))
			return false;
	} while (is_comment(t));
	if (is_blank(t) && (t->columns == 1 || t->separator != '\t' || t->at.length == 0))
		return skip_end(t);
	split(t);
	if (t->cells > t->columns)
		fail_at(table_place(t, t->cell[t->columns].column),
			t->separator == ',' && t->cells == 2 * t->columns
			? "numbers with a decimal comma go with ; between the columns" : NULL,
			format("a column too many: the first line has %zu", t->columns));
	if (t->cells < t->columns)
		fail_at(table_place(t, t->at.length), NULL,
			format("too few columns: the first line has %zu, this one %zu", t->columns, t->cells));
	return true;
}

/* A comma as the point; *mark: which of the two it has, 0: none */
static bool read_cell(const struct table *t, const char *text, double *value, char *mark)
{
	char copy[512];
	if (strlen(text) >= sizeof copy)
		return false;
	strcpy(copy, text);
	char *comma = strchr(copy, ',');
	*mark = comma ? ',' : strchr(copy, '.') ? '.' : 0;
	if (comma && (t->separator == ',' || strchr(copy, '.')))
		return false;
	if (comma)
		*comma = '.';
	return read_number(copy, value);
}

double table_number(struct table *t, size_t cell)
{
	const struct cell *c = &t->cell[cell];
	struct place at = table_place(t, c->column);
	double value;
	char mark;
	if (!*c->text)
		fail_at(at, NULL, "expected a number, found nothing: the row has a gap");
	if (!read_cell(t, c->text, &value, &mark))
		fail_at(at, strchr(c->text, ',') ? "a decimal comma goes with ; or tabs between the columns; thousands "
						   "have no mark" : NULL,
			format("expected a finite number, found '%.60s'", c->text));
	if (mark && t->point && mark != t->point)
		fail_at(at, NULL, format("numbers before have a decimal %s, and this one a %s",
					 mark == '.' ? "comma" : "point", mark == '.' ? "point" : "comma"));
	t->point = mark ? mark : t->point;
	return value;
}
