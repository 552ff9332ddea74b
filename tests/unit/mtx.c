/* SPDX-License-Identifier: GPL-3.0-or-later */
/* gen/read/mtx.c: what it reads, exactly, and what it says about files that are wrong. */
#include <stdarg.h>
#include <stddef.h>
#include <setjmp.h>
#include <stdint.h>
#include <cmocka.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>
#include "read/read.h"

#define BANNER(rest) "%%MatrixMarket matrix " rest "\n"

static char folder[] = "/tmp/plgen-mtx-XXXXXX";

static int enter_folder(void **state)
{
	(void)state;
	return mkdtemp(folder) && chdir(folder) == 0 ? 0 : -1;
}

static int leave_folder(void **state)
{
	(void)state;
	unlink("M.mtx");
	return chdir("/") == 0 && rmdir(folder) == 0 ? 0 : -1;
}

static void write_file(const char *text, size_t length)
{
	FILE *file = fopen("M.mtx", "wb");
	assert_non_null(file);
	assert_int_equal(fwrite(text, 1, length, file), length);
	assert_int_equal(fclose(file), 0);
}

struct reading {
	const char *path;
	struct place at;
	struct mtx *matrix;
};

static void read_matrix(void *context)
{
	struct reading *reading = context;
	reading->matrix = mtx_read(reading->path, reading->at);
}

/* The matrix, or NULL and in *said what was said. */
static struct mtx *reading_of(const char *path, char **said)
{
	static const char spec[] = "model m\nmatrix M = \"M.mtx\"\n";
	struct source *source = NEW(struct source);
	*source = (struct source){ .name = "m.spec", .base = "m.spec", .text = spec, .length = sizeof spec - 1 };
	struct reading reading = { path, { source, 19 }, NULL };
	bool done = statement_guard(read_matrix, &reading);
	size_t length;
	FILE *to = open_memstream(said, &length);
	assert_non_null(to);
	if (!done)
		diagnostics_print(to);
	fclose(to);
	return done ? reading.matrix : NULL;
}

/* rows of cells as text: "1 0; 1/2 -3" */
static const char *matrix_text(const struct mtx *matrix)
{
	char *text = "";
	for (int i = 0; i < matrix->rows; i++)
		for (int j = 0; j < matrix->columns; j++) {
			char *cell = mpq_get_str(NULL, 10, matrix->cell[i * matrix->columns + j]);
			text = format("%s%s%s", text, j > 0 ? " " : i > 0 ? "; " : "", cell);
		}
	return text;
}

struct well_formed {
	const char *file, *matrix;
};
static const struct well_formed well_formed[] = {
	{ BANNER("array real general") "2 3\n1\n4\n2\n5\n3\n6\n", "1 2 3; 4 5 6" },
	{ BANNER("array integer general") "2 2\n1\n-4\n+2\n0\n", "1 2; -4 0" },
	{ BANNER("array real symmetric") "3 3\n1\n2\n3\n4\n5\n6\n", "1 2 3; 2 4 5; 3 5 6" },
	{ BANNER("array real skew-symmetric") "3 3\n1\n2\n3\n", "0 -1 -2; 1 0 -3; 2 3 0" },
	{ BANNER("array real skew-symmetric") "1 1\n", "0" },
	{ BANNER("coordinate real general") "2 3 3\n1 3 0.5\n2 1 -2\n1 1 7\n", "7 0 1/2; -2 0 0" },
	{ BANNER("coordinate integer general") "2 2 1\n2 2 12345678901234567890123\n", "0 0; 0 "
		"12345678901234567890123" },
	{ BANNER("coordinate real symmetric") "2 2 2\n1 1 200\n2 1 -100\n", "200 -100; -100 0" },
	{ BANNER("coordinate real skew-symmetric") "2 2 1\n2 1 3\n", "0 -3; 3 0" },
	{ BANNER("coordinate real general") "2 2 0\n", "0 0; 0 0" },
	{ BANNER("array real general") "6 1\n.1\n1.\n-2e-3\n+1E+2\n1.25e0\n0.1000\n", "1/10; 1; -1/500; 100; 5/4; "
		"1/10" },
	{ "%%mAtRiXmArKeT MATRIX Array Real GENERAL\n1 1\n5\n", "5" },
	{ BANNER("array real general") "% a comment\n\n%another\n  1 1  \n\n% and here\n \t5\n\n% end\n\n", "5" },
	{ "%%MatrixMarket matrix array real general\r\n% c\r\n2 1\r\n5\r\n6\r\n", "5; 6" },
	{ BANNER("coordinate real general") "1 2 1\n\t1\t2   8  ", "0 8" },
	{ BANNER("array real general") "% \xe4 in Latin-1\n1 1\n5", "5" },
};

static void matrices_are_read_exactly(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof well_formed / sizeof *well_formed; i++) {
		char *said;
		write_file(well_formed[i].file, strlen(well_formed[i].file));
		const struct mtx *matrix = reading_of("M.mtx", &said);
		if (!matrix)
			fail_msg("%s\nis refused: %s", well_formed[i].file, said);
		assert_string_equal(said, "");
		free(said);
		if (strcmp(matrix_text(matrix), well_formed[i].matrix) != 0)
			fail_msg("%s\nfound %s, expected %s, exactly", well_formed[i].file, matrix_text(matrix),
					 well_formed[i].matrix);
	}
}

struct malformed {
	const char *file, *said;    /* said: how the message begins, line and column first */
	const char *note;           /* or NULL */
};
#define R_GENERAL BANNER("coordinate real general")
#define R_SYMMETRIC BANNER("coordinate real symmetric")
#define A_GENERAL BANNER("array real general")
static const struct malformed malformed[] = {
	/* the first line */
	{ "", "1:1: error: not a Matrix Market file", "the first line is" },
	{ "1 1\n5\n", "1:1: error: not a Matrix Market file", "the first line is" },
	{ "%MatrixMarket matrix array real general\n1 1\n5\n", "1:1: error: not a Matrix Market file",
	  "the first line is" },
	{ "\n%%MatrixMarket matrix array real general\n1 1\n5\n", "1:1: error: not a Matrix Market file",
	  "the first line is" },
	{ "%%MatrixMarket vector array real general\n1\n5\n", "1:16: error: unsupported object 'vector'", "only "
		"'matrix'" },
	{ BANNER("dense real general") "1 1\n5\n", "1:23: error: unsupported format 'dense'", "'coordinate' or "
		"'array'" },
	{ BANNER("array complex general") "1 1\n5 0\n", "1:29: error: unsupported field 'complex'", "'real' or "
		"'integer'" },
	{ BANNER("coordinate pattern general") "1 1 1\n1 1\n", "1:34: error: unsupported field 'pattern'",
	  "'real' or 'integer'" },
	{ BANNER("array real hermitian") "1 1\n5\n", "1:34: error: unsupported symmetry 'hermitian'", "'symmetric'" },
	{ BANNER("array real") "1 1\n5\n", "1:33: error: expected the symmetry, found the end of the "
		"line", "'symmetric'" },
	{ "%%MatrixMarket", "1:15: error: expected the object, found the end of the line", NULL },
	{ BANNER("array real general dense") "1 1\n5\n", "1:42: error: unexpected 'dense' after the symmetry", NULL },
	/* the size line */
	{ A_GENERAL, "1:41: error: expected the size line, found the end of the file", "rows columns" },
	{ A_GENERAL "% only\n", "2:7: error: expected the size line, found the end of the file", "rows columns" },
	{ A_GENERAL "2\n1\n2\n", "2:2: error: expected the number of columns, found the end of the line", "rows "
		"columns" },
	{ A_GENERAL "2 2 4\n", "2:5: error: unexpected '4' after the sizes", "rows columns" },
	{ R_GENERAL "2 2\n", "2:4: error: expected the number of entries, found the end of the line",
	  "rows columns entries" },
	{ R_GENERAL "2 2 x\n", "2:5: error: expected the number of entries, found 'x'", "rows columns entries" },
	{ R_GENERAL "2 2 1 1\n", "2:7: error: unexpected '1' after the sizes", "rows columns entries" },
	{ R_GENERAL "-2 2 1\n", "2:1: error: expected the number of rows, found '-2'", NULL },
	{ R_GENERAL "2 2.0 1\n", "2:3: error: expected the number of columns, found '2.0'", NULL },
	{ R_GENERAL "0 2 0\n", "2:1: error: a matrix has at least 1 of its rows", NULL },
	{ R_GENERAL "2 0 0\n", "2:3: error: a matrix has at least 1 of its columns", NULL },
	{ A_GENERAL "513 1\n", "2:1: error: '513': over the limit of 512 rows", NULL },
	{ A_GENERAL "1 99999999999999999999999999\n",
	  "2:3: error: '99999999999999999999999999': over the limit of 512 columns", NULL },
	{ R_GENERAL "2 2 5\n", "2:5: error: '5' entries, but at most 4 have a place in this matrix", NULL },
	{ R_SYMMETRIC "2 2 4\n", "2:5: error: '4' entries, but at most 3 have a place in this matrix", NULL },
	{ R_SYMMETRIC "2 3 1\n1 1 5\n", "2:3: error: a symmetric matrix is square, but this one is 2 x 3", NULL },
	{ BANNER("array real skew-symmetric") "3 2\n1\n",
	  "2:3: error: a skew-symmetric matrix is square, but this one is 3 x 2", NULL },
	/* the count of entries */
	{ A_GENERAL "2 2\n1\n2\n3\n", "5:2: error: 1 of 4 entries are missing", NULL },
	{ A_GENERAL "2 2", "2:4: error: 4 of 4 entries are missing", NULL },
	{ R_GENERAL "2 2 3\n1 1 5\n2 2 5\n\n% end", "6:6: error: 1 of 3 entries are missing", NULL },
	{ A_GENERAL "1 2\n1\n2\n% c\n\n  3\n4\n", "7:3: error: more entries than the 2 that the size line announces",
	  NULL },
	{ R_GENERAL "2 2 1\n1 1 5\n2 2 5\n", "4:1: error: more entries than the 1 that the size line announces", NULL },
	{ BANNER("array real symmetric") "2 2\n1\n2\n2\n3\n", "6:1: error: more entries than the 3", "the lower "
		"triangle" },
	{ A_GENERAL "1 2\n1 2\n", "3:3: error: unexpected '2' after the value", "column by column" },
	{ R_GENERAL "2 2 1\n1 1 5 0\n", "3:7: error: unexpected '0' after the value", "row column value" },
	{ R_GENERAL "2 2 2\n1 1\n2 2 5\n", "3:4: error: expected a value, found the end of the line", NULL },
	{ R_GENERAL "2 2 2\n1\n2 2 5\n", "3:2: error: expected a column, found the end of the line", "row column "
		"value" },
	/* where an entry stands */
	{ R_GENERAL "2 3 1\n3 1 5\n", "3:1: error: row '3' is outside of 1 .. 2", NULL },
	{ R_GENERAL "2 3 1\n1 4 5\n", "3:3: error: column '4' is outside of 1 .. 3", NULL },
	{ R_GENERAL "2 3 1\n0 1 5\n", "3:1: error: row '0' is outside of 1 .. 2", "count from 1" },
	{ R_GENERAL "2 3 1\n1 -1 5\n", "3:3: error: expected a column, found '-1'", NULL },
	{ R_GENERAL "2 3 1\n1 18446744073709551617 5\n", "3:3: error: column '18446744073709551617' is outside of 1 "
		".. 3",
	  NULL },
	{ R_GENERAL "2 2 3\n1 2 5\n% c\n1 1 5\n1 2 6\n", "6:1: error: second entry (1, 2)", "the first is in line 3" },
	{ R_SYMMETRIC "2 2 1\n 1 2 5\n", "3:2: error: entry (1, 2) is above the diagonal", "the lower triangle is "
		"wanted" },
	{ BANNER("coordinate real skew-symmetric") "2 2 1\n1 2 5\n", "3:1: error: entry (1, 2) is above the diagonal",
	  "the lower triangle" },
	{ BANNER("coordinate real skew-symmetric") "2 2 1\n2 2 5\n", "3:1: error: entry (2, 2) is on the diagonal",
	  "is 0" },
	/* values */
	{ A_GENERAL "1 1\nnan\n", "3:1: error: malformed number 'nan'", "a number is written" },
	{ A_GENERAL "1 1\n-inf\n", "3:1: error: malformed number '-inf'", "a number is written" },
	{ R_GENERAL "1 1 1\n1 1 Infinity\n", "3:5: error: malformed number 'Infinity'", NULL },
	{ A_GENERAL "1 1\n1,5\n", "3:1: error: malformed number '1,5'", "a point" },
	{ A_GENERAL "1 1\n1.0D+00\n", "3:1: error: malformed number '1.0D+00'", "with e" },
	{ A_GENERAL "1 1\n.\n", "3:1: error: malformed number '.'", NULL },
	{ A_GENERAL "1 1\n1e\n", "3:1: error: malformed number '1e'", NULL },
	{ A_GENERAL "1 1\n1e+\n", "3:1: error: malformed number '1e+'", NULL },
	{ A_GENERAL "1 1\n--1\n", "3:1: error: malformed number '--1'", NULL },
	{ A_GENERAL "1 1\n-\n", "3:1: error: malformed number '-'", NULL },
	{ A_GENERAL "1 1\n0x10\n", "3:1: error: malformed number '0x10'", NULL },
	{ A_GENERAL "1 1\n1.2.3\n", "3:1: error: malformed number '1.2.3'", NULL },
	{ A_GENERAL "1 1\n1e10000\n", "3:1: error: literal exponent beyond the limit of 9999", NULL },
	{ BANNER("array integer general") "1 1\n1.5\n", "3:1: error: expected an integer, found '1.5'", "real" },
	{ BANNER("array integer general") "1 1\n1e2\n", "3:1: error: expected an integer, found '1e2'", "real" },
	{ BANNER("array integer general") "1 1\nx\n", "3:1: error: malformed number 'x'", NULL },
	{ A_GENERAL "1 1\n\x01\xff\n", "3:1: error: malformed number '?\?'", NULL },
};

static void errors_name_their_place(void **state)
{
	(void)state;
	for (size_t i = 0; i < sizeof malformed / sizeof *malformed; i++) {
		const struct malformed *m = &malformed[i];
		char *said;
		write_file(m->file, strlen(m->file));
		if (reading_of("M.mtx", &said))
			fail_msg("%s\nis read, expected %s", m->file, m->said);
		const char *expected = format("M.mtx:%s", m->said), *note = strstr(said, "\nnote: ");
		if (strncmp(said, expected, strlen(expected)) != 0)
			fail_msg("%s\nfound %sexpected %s", m->file, said, expected);
		if (m->note && !(note && strstr(note, m->note)))
			fail_msg("%s\nfound %sexpected in a note: %s", m->file, said, m->note);
		free(said);
	}
}

static void long_numbers(void **state)
{
	(void)state;
	const size_t digits = 400000;       /* 1.3 million bits */
	char *text = format("%s1 1\n%*s\n", A_GENERAL, (int)digits, ""), *said;
	memset(strchr(strchr(text, '\n') + 1, '\n') + 1, '7', digits);
	write_file(text, strlen(text));
	assert_null(reading_of("M.mtx", &said));
	if (strncmp(said, "M.mtx:3:1: error: exact value over the limit of 1000000 bits\n", 61) != 0)
		fail_msg("found %s", said);
	free(said);
}

/* Every beginning of a file that is right, with a 0 byte or not: it is read or refused, and nothing else happens. */
static void beginnings(void **state)
{
	(void)state;
	static const char whole[] = R_SYMMETRIC "% c\r\n2 2 2\n1 1 2e2\n2 1 -1.5";
	for (size_t length = 0; length < sizeof whole - 1; length++)
		for (int zero = 0; zero < 2; zero++) {
			char *said, *text = malloc(length + (size_t)zero + 1);
			memcpy(text, whole, length);
			text[length] = 0;
			write_file(text, length + (size_t)zero);
			free(text);
			/* without its last digit, or last two, the last number is still one */
			bool readable = !zero && (length == sizeof whole - 2 || length == sizeof whole - 3);
			if ((reading_of("M.mtx", &said) != NULL) != readable)
				fail_msg("%zu bytes%s: %s", length, zero ? " and a 0" : "", readable ? said : "read");
			free(said);
		}
}

static void file_that_cannot_be_read(void **state)
{
	(void)state;
	char *said;
	assert_null(reading_of("none.mtx", &said));
	assert_string_equal(
		said,
		"m.spec:2:12: error: cannot read 'none.mtx': No such file or directory\nmatrix M = \"M.mtx\"\n        "
			"   ^\n");
	free(said);
	assert_null(reading_of(".", &said));
	assert_string_equal(said,
						"m.spec:2:12: error: cannot read '.': Is a directory\nmatrix M = "
							"\"M.mtx\"\n           ^\n");
	free(said);
	assert_null(reading_of("/dev/zero", &said));
	assert_string_equal(
		said,
		"m.spec:2:12: error: '/dev/zero' is longer than the limit of 67108864 bytes\n"
		"matrix M = \"M.mtx\"\n           ^\n");
	free(said);
}

int main(void)
{
	const struct CMUnitTest tests[] = {
		cmocka_unit_test(matrices_are_read_exactly),
		cmocka_unit_test(errors_name_their_place),
		cmocka_unit_test(long_numbers),
		cmocka_unit_test(beginnings),
		cmocka_unit_test(file_that_cannot_be_read),
	};
	memory_open();
	const int status = cmocka_run_group_tests(tests, enter_folder, leave_folder);
	memory_close();
	return status;
}
