/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Matrix Market files (Boisvert, Pozo, Remington: The Matrix Market Exchange Formats, NISTIR 5935, 1996): array or
 * coordinate; general, symmetric or skew-symmetric; real or integer.
 *
 *     file = banner, size line, entries; one a line, lines that are blank or begin with % between them.
 *
 * Stricter than most readers where leniency would hide a mistake: one entry a line (an array written row by row would
 * come out transposed), no entry twice, and of a symmetric matrix the lower triangle only. */
#include "read/read.h"

#include <errno.h>
#include <string.h>

enum { LIMIT_FILE = 1 << 26 };      /* bytes */

enum symmetry { GENERAL, SYMMETRIC, SKEW };
static const char *const symmetry_name[] = { "general", "symmetric", "skew-symmetric" };

struct word {                       /* what stands between white space; at the end of the line length 0 */
	struct place at;
	size_t length;
};

struct reader {
	const struct source *source;
	size_t position, end;       /* what is left of the line */
	bool array, integer;
	enum symmetry symmetry;
	struct mtx *matrix;
	size_t *given;              /* per cell: 1 + offset of its entry, 0 while there is none */
	size_t expected, count;     /* entries */
};

/* ---- the text ---- */

static struct source *load(const char *path, struct place at)
{
	FILE *file = fopen(path, "rb");
	if (!file)
		error(at, NULL, "cannot read '%s': %s", path, strerror(errno));
	char *text = NULL;
	size_t length = 0, room = 0, got;
	errno = 0;
	do {
		if (room - length < 4096)
			ENLARGE(text, room = 2 * room + 8192);
		got = fread(text + length, 1, room - length - 1, file);
		length += got;
	} while (got > 0 && length <= LIMIT_FILE);
	int failed = ferror(file) ? errno : 0;
	fclose(file);
	if (failed)
		error(at, NULL, "cannot read '%s': %s", path, strerror(failed));
	if (length > LIMIT_FILE)
		error(at, NULL, "'%s' is longer than the limit of %d bytes", path, LIMIT_FILE);
	text[length] = 0;
	const char *slash = strrchr(path, '/');
	struct source *source = NEW(struct source);
	*source = (struct source){ .name = format("%s", path),
				   .base = format("%s", slash ? slash + 1 : path),
				   .text = text,
				   .length = length,
				   .order = 1 };
	return source;
}

static bool is_space(char c)
{
	return c == ' ' || c == '\t' || c == '\r' || c == '\f' || c == '\v';
}

static bool is_digit(char c)
{
	return c >= '0' && c <= '9';
}

static char lower(char c)
{
	return c >= 'A' && c <= 'Z' ? (char)(c + ('a' - 'A')) : c;
}

/* The line that starts at `from`. */
static void enter_line(struct reader *r, size_t from)
{
	const char *text = r->source->text, *newline = memchr(text + from, '\n', r->source->length - from);
	r->position = from;
	r->end = newline ? (size_t)(newline - text) : r->source->length;
}

static struct word next_word(struct reader *r)
{
	const char *text = r->source->text;
	struct word word = { { r->source, r->position }, 0 };
	while (r->position < r->end && is_space(text[r->position]))
		r->position++;
	if (r->position == r->end)
		return word;        /* its place is just after the last word */
	word.at.offset = r->position;
	while (r->position < r->end && !is_space(text[r->position]))
		r->position++;
	word.length = r->position - word.at.offset;
	return word;
}

/* On to the next line that says something; false at the end of the file. */
static bool next_line(struct reader *r)
{
	while (r->end < r->source->length) {
		enter_line(r, r->end + 1);
		size_t start = r->position;
		struct word word = next_word(r);
		r->position = start;
		if (word.length > 0 && r->source->text[word.at.offset] != '%')
			return true;
	}
	return false;
}

static const char *word_start(struct word word)
{
	return word.at.source->text + word.at.offset;
}

static bool is_word(struct word word, const char *expected)
{
	if (word.length != strlen(expected))
		return false;
	for (size_t i = 0; i < word.length; i++)
		if (lower(word_start(word)[i]) != lower(expected[i]))
			return false;
	return true;
}

static const char *shown(struct word word)
{
	if (word.length == 0)
		return "the end of the line";
	char *text = format("'%.*s'", word.length > 60 ? 60 : (int)word.length, word_start(word));
	for (char *c = text; *c; c++)
		*c = *c < ' ' || *c > '~' ? '?' : *c;
	return text;
}

static void expect_end(struct reader *r, const char *note, const char *after)
{
	struct word word = next_word(r);
	if (word.length > 0)
		error(word.at, note, "unexpected %s after %s", shown(word), after);
}

/* ---- numbers ---- */

/* A whole number without sign; what is too large for any use comes back as LIMIT_FILE. */
static size_t whole_number(struct word word, const char *note, const char *what)
{
	const char *text = word_start(word);
	size_t value = 0;
	for (size_t i = 0; i < word.length; i++) {
		if (!is_digit(text[i]))
			error(word.at, note, "expected %s, found %s", what, shown(word));
		value = 10 * value + (size_t)(text[i] - '0');
		value = value > LIMIT_FILE ? LIMIT_FILE : value;
	}
	if (word.length == 0)
		error(word.at, note, "expected %s, found %s", what, shown(word));
	return value;
}

static bool is_number(const char *s, size_t length, bool integer)
{
	return (integer ? strspn(s, "0123456789") : number_length(s)) == length && length > 0;
}

static const char *number_note(struct word word)
{
	const char *text = word_start(word);
	if (memchr(text, ',', word.length))
		return "the decimal sign is a point, and white space separates";
	if (is_digit(text[word.length - 1]) && (memchr(text, 'd', word.length) || memchr(text, 'D', word.length)))
		return "an exponent is written with e: 2e-3";
	return "a number is written 12, -0.5, .5, 1. or 2e-3";
}

/* The decimal, exactly. */
static void number(const struct reader *r, struct word word, mpq_ptr value)
{
	const char *text = word_start(word);
	size_t sign = word.length > 0 && (*text == '-' || *text == '+');
	if (word.length == 0)
		error(word.at, NULL, "expected a value, found the end of the line");
	if (!is_number(text + sign, word.length - sign, r->integer)) {
		if (r->integer && is_number(text + sign, word.length - sign, false))
			error(word.at, "the field in the first line should then be real",
			      "expected an integer, found %s", shown(word));
		error(word.at, number_note(word), "malformed number %s", shown(word));
	}
	struct token token = { .kind = TOKEN_NUMBER,
			       .at = { word.at.source, word.at.offset + sign },
			       .length = word.length - sign };
	lex_number(token, value);
	if (*text == '-')
		mpq_neg(value, value);
}

/* ---- banner = "%%MatrixMarket" "matrix" format field symmetry ---- */

/* One word out of `count`; returns which. */
static int choice(struct reader *r, const char *what, int count, const char *const *known, const char *note)
{
	struct word word = next_word(r);
	for (int i = 0; i < count; i++)
		if (is_word(word, known[i]))
			return i;
	if (word.length == 0)
		error(word.at, note, "expected the %s, found the end of the line", what);
	error(word.at, note, "unsupported %s %s", what, shown(word));
}

static void banner(struct reader *r)
{
	static const char *const objects[] = { "matrix" }, *const formats[] = { "coordinate", "array" };
	static const char *const fields[] = { "real", "integer" };
	enter_line(r, 0);
	if (!is_word(next_word(r), "%%MatrixMarket"))
		error((struct place){ r->source, 0 },
		      "the first line is, for example: %%MatrixMarket matrix coordinate real general",
		      "not a Matrix Market file");
	choice(r, "object", 1, objects, "only 'matrix' is read");
	r->array = choice(r, "format", 2, formats, "the format is 'coordinate' or 'array'") == 1;
	r->integer = choice(r, "field", 2, fields, "the field is 'real' or 'integer'") == 1;
	r->symmetry = (enum symmetry)choice(r, "symmetry", 3, symmetry_name,
					    "the symmetry is 'general', 'symmetric' or 'skew-symmetric'");
	expect_end(r, NULL, "the symmetry");
}

/* ---- size line = rows columns [entries] ---- */

static int size(struct reader *r, const char *what, const char *note, struct place *at)
{
	struct word word = next_word(r);
	size_t value = whole_number(word, note, format("the number of %s", what));
	if (value < 1)
		error(word.at, NULL, "a matrix has at least 1 of its %s", what);
	if (value > LIMIT_STATES)
		error(word.at, NULL, "%s: over the limit of %d %s", shown(word), LIMIT_STATES, what);
	*at = word.at;
	return (int)value;
}

static void size_line(struct reader *r)
{
	const char *note = r->array ? "the size line is: rows columns" : "the size line is: rows columns entries";
	if (!next_line(r))
		error(place_end(r->source), note, "expected the size line, found the end of the file");
	struct place at;
	int rows = size(r, "rows", note, &at);
	int columns = size(r, "columns", note, &at);
	if (r->symmetry != GENERAL && rows != columns)
		error(at, NULL, "a %s matrix is square, but this one is %d x %d", symmetry_name[r->symmetry], rows,
		      columns);

	size_t n = (size_t)rows, cells = n * (size_t)columns;
	r->expected = r->symmetry == GENERAL ? cells : r->symmetry == SYMMETRIC ? n * (n + 1) / 2 : n * (n - 1) / 2;
	if (!r->array) {
		struct word word = next_word(r);
		size_t entries = whole_number(word, note, "the number of entries");
		if (entries > r->expected)
			error(word.at, NULL, "%s entries, but at most %zu have a place in this matrix", shown(word),
			      r->expected);
		r->expected = entries;
	}
	expect_end(r, note, "the sizes");
	r->matrix = NEW(struct mtx);
	*r->matrix = (struct mtx){ rows, columns, rationals(cells) };
	r->given = ARRAY(size_t, cells);
}

/* ---- entry = row column value, or in an array the value alone, column by column ---- */

static size_t line_of(const struct reader *r, size_t offset)
{
	size_t line = 1;
	for (size_t i = 0; i < offset; i++)
		line += r->source->text[i] == '\n';
	return line;
}

static int index_within(struct reader *r, const char *what, int count, struct place *at)
{
	struct word word = next_word(r);
	size_t index = whole_number(word, "an entry is: row column value", format("a %s", what));
	if (index < 1 || index > (size_t)count)
		error(word.at, index < 1 ? "rows and columns count from 1" : NULL, "%s %s is outside of 1 .. %d", what,
		      shown(word), count);
	*at = word.at;
	return (int)index - 1;
}

static void check_triangle(const struct reader *r, int row, int column, struct place at)
{
	if (r->symmetry != GENERAL && row < column)
		error(at,
		      format("of a %s matrix the lower triangle is wanted, row >= column", symmetry_name[r->symmetry]),
		      "entry (%d, %d) is above the diagonal", row + 1, column + 1);
	if (r->symmetry == SKEW && row == column)
		error(at, "the diagonal of a skew-symmetric matrix is 0 and is not written",
		      "entry (%d, %d) is on the diagonal", row + 1, column + 1);
}

static void entry(struct reader *r, int row, int column, struct place at)
{
	int columns = r->matrix->columns;
	size_t cell = (size_t)row * (size_t)columns + (size_t)column,
	       mirror = (size_t)column * (size_t)columns + (size_t)row;
	mpq_t *value = r->matrix->cell;
	if (r->given[cell])
		error(at, format("the first is in line %zu", line_of(r, r->given[cell] - 1)), "second entry (%d, %d)",
		      row + 1, column + 1);
	r->given[cell] = at.offset + 1;
	number(r, next_word(r), value[cell]);
	if (r->symmetry != GENERAL && row != column) {
		mpq_set(value[mirror], value[cell]);
		if (r->symmetry == SKEW)
			mpq_neg(value[mirror], value[mirror]);
	}
	expect_end(r, r->array ? "one value a line, column by column" : "one entry a line: row column value",
		   "the value");
	r->count++;
}

/* To the next line with an entry. */
static void expect_entry(struct reader *r)
{
	if (!next_line(r))
		error(place_end(r->source), NULL, "%zu of %zu entries are missing", r->expected - r->count,
		      r->expected);
}

static void coordinate_entries(struct reader *r)
{
	while (r->count < r->expected) {
		struct place at, second;
		expect_entry(r);
		int row = index_within(r, "row", r->matrix->rows, &at);
		int column = index_within(r, "column", r->matrix->columns, &second);
		check_triangle(r, row, column, at);
		entry(r, row, column, at);
	}
}

static void array_entries(struct reader *r)
{
	for (int column = 0; column < r->matrix->columns; column++) {
		int first = r->symmetry == GENERAL ? 0 : r->symmetry == SYMMETRIC ? column : column + 1;
		for (int row = first; row < r->matrix->rows; row++) {
			expect_entry(r);
			entry(r, row, column, (struct place){ r->source, r->position });
		}
	}
}

struct mtx *mtx_read(const char *path, struct place at)
{
	struct reader reader = { .source = load(path, at) }, *r = &reader;
	banner(r);
	size_line(r);
	if (r->array)
		array_entries(r);
	else
		coordinate_entries(r);
	if (next_line(r))
		error(next_word(r).at,
		      r->symmetry == GENERAL
			      ? NULL
			      : format("of a %s matrix the lower triangle is wanted", symmetry_name[r->symmetry]),
		      "more entries than the %zu that the size line announces", r->expected);
	return r->matrix;
}
