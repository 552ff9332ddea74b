/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Texts, places in them, and what is said about a place. */
#include "base/base.h"

#include <errno.h>
#ifndef __wasm__
#include <setjmp.h>
#endif
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

enum { LIMIT_TEXT = 1 << 26 };      /* bytes of a whole spec: an endless device is not read forever */

struct diagnostic {
	struct place at;
	const char *severity, *message, *note;
	int number;                 /* order in which they were said */
};

static struct diagnostic *said;
static int said_count, error_count;
static const char *context_note;
static bool unheard;               /* warnings are forgotten */
static bool guarded;                /* a statement is under way, which `abandon` leaves */
static struct place working;

static void say(struct place at, const char *severity, const char *note, const char *fmt, va_list args)
{
	va_list again;
	va_copy(again, args);
	int length = vsnprintf(NULL, 0, fmt, args);
	char *message = ARRAY(char, length + 1);
	vsnprintf(message, (size_t)length + 1, fmt, again);
	va_end(again);
	for (int i = 0; i < said_count; i++)    /* a let that two equations use is reported once */
		if (said[i].at.offset == at.offset && strcmp(said[i].at.source->name, at.source->name) == 0 &&
		    (strcmp(said[i].message, message) == 0 ||
		     (at.source->repeats && strcmp(said[i].severity, severity) == 0)))
			return;
	if (said_count == LIMIT_ERRORS && strcmp(severity, "error") == 0) {
		message = format("more errors than the limit of %d: what comes after them is not looked at",
				 LIMIT_ERRORS);
		guarded = false;                   /* the end */
		note = NULL;
	}
	const int order = said_count;
	*MORE(said, said_count) = (struct diagnostic){ at, severity, message, note ? note : context_note, order };
}

void say_error(struct place at, const char *note, const char *fmt, ...)
{
	va_list args;
	va_start(args, fmt);
	error_count++;
	say(at, "error", note, fmt, args);
	va_end(args);
	if (said_count > LIMIT_ERRORS)
		abandon();
}

void error(struct place at, const char *note, const char *fmt, ...)
{
	va_list args;
	va_start(args, fmt);
	say(at, "error", note, fmt, args);
	va_end(args);
	error_count++;
	abandon();
}

void say_warning(struct place at, const char *note, const char *fmt, ...)
{
	va_list args;
	va_start(args, fmt);
	say(at, "warning", note, fmt, args);
	va_end(args);
}

void say_note(struct place at, const char *fmt, ...)
{
	va_list args;
	va_start(args, fmt);
	say(at, "note", NULL, fmt, args);
	va_end(args);
}

void stand_aside(struct place at, const char *option, const char *why)
{
	say_note(at, "%s stands aside: %s", option, why);
}

const char *next_aside(int *from)
{
	while (*from < said_count && !strstr(said[*from].message, " stands aside: "))
		++*from;
	return *from < said_count ? said[(*from)++].message : NULL;
}

void work_at(struct place at)
{
	working = at;
}

struct place working_at(void)
{
	return working;
}

void give_up(const char *message)
{
	guarded = false;
	if (working.source) {
		error(working, NULL, "%s", message);
	} else {
		fprintf(stderr, "plgen: error: %s\n", message);
		exit(1);
	}
}

/* ---- out of a statement ---- */

#ifdef __wasm__                     /* which has no setjmp: the page catches what is thrown */
#define FROM_PAGE(name) __attribute__((import_module("page"), import_name(name)))
_Noreturn FROM_PAGE("leave") void leave(void);
FROM_PAGE("ends") bool ends(void (*work)(void *), void *context);
#else
static jmp_buf *mark;

static _Noreturn void leave(void)
{
	longjmp(*mark, 1);
}

/* false: it was left */
static bool ends(void (*work)(void *), void *context)
{
	jmp_buf here, *outer = mark;
	mark = &here;
	if (setjmp(here) == 0) {
		work(context);
		mark = outer;
		return true;
	}
	mark = outer;
	return false;
}
#endif

void abandon(void)
{
	if (guarded)
		leave();
	diagnostics_print(stderr);
	exit(1);
}

bool statement_guard(void (*work)(void *), void *context)
{
	const bool outer = guarded;
	guarded = true;
	const bool done = ends(work, context);
	guarded = outer;
	return done;
}

const char *refusal_of(void (*work)(void *), void *context)
{
	int known = said_count, errors = error_count, first = known;
	if (statement_guard(work, context))
		return NULL;
	while (first < said_count && strcmp(said[first].severity, "error") != 0)
		first++;
	const char *message = first < said_count ? said[first].message : "";
	said_count = known;
	error_count = errors;
	return message;
}

const char *unheard_refusal_of(void (*work)(void *), void *context)
{
	const int known = said_count;
	const bool outside = unheard;
	unheard = true;
	const char *message = refusal_of(work, context);
	unheard = outside;
	said_count = known;
	return message;
}

bool warnings_are_heard(void)
{
	return !unheard;
}

bool silent_guard(void (*work)(void *), void *context)
{
	return !refusal_of(work, context);
}

void diagnostics_context(const char *note)
{
	context_note = note;
}

int diagnostics_errors(void)
{
	return error_count;
}

bool diagnostics_harden(void)
{
	bool hardened = false;
	for (int i = 0; i < said_count; i++) {
		if (strcmp(said[i].severity, "warning") != 0)
			continue;
		said[i].severity = "error";
		error_count++;
		hardened = true;
	}
	return hardened;
}

static size_t line_start(const struct source *source, size_t offset)
{
	size_t from = offset;
	while (offset > 0 && source->text[offset - 1] != '\n')
		offset--;
	/* the mark is no column */
	return offset == 0 && from >= 3 && strncmp(source->text, "\xef\xbb\xbf", 3) == 0 ? 3 : offset;
}

static bool is_continuation(char c)
{
	return ((unsigned char)c & 0xc0) == 0x80;
}

static size_t count_characters(const char *text, size_t length)
{
	size_t count = 0;
	for (size_t i = 0; i < length; i++)
		count += !is_continuation(text[i]);
	return count;
}

/* Length of the well-formed UTF-8 character at `s`, 0 if there is none (s ends with a 0 byte). */
static size_t character_length(const unsigned char *s)
{
	size_t length = s[0] < 0x80                   ? 1
			: s[0] >= 0xc2 && s[0] < 0xe0 ? 2
			: (s[0] & 0xf0) == 0xe0       ? 3
			: s[0] >= 0xf0 && s[0] < 0xf5 ? 4
						      : 0;
	for (size_t i = 1; i < length; i++)
		if ((s[i] & 0xc0) != 0x80)
			return 0;
	bool overlong = (s[0] == 0xe0 && s[1] < 0xa0) || (s[0] == 0xf0 && s[1] < 0x90);
	bool no_character = (s[0] == 0xed && s[1] > 0x9f) || (s[0] == 0xf4 && s[1] > 0x8f);
	return overlong || no_character ? 0 : length;
}

/* The source line and a caret under the place; of a very long line the surroundings of the place. */
static void print_line(FILE *to, struct place at)
{
	enum { BEFORE = 100, SHOWN = 160 };
	const struct source *source = at.source;
	size_t from = line_start(source, at.offset);
	if (!source->text || source->length == 0)
		return;
	if (at.offset - from > BEFORE)
		for (from = at.offset - BEFORE; is_continuation(source->text[from]);)
			from++;
	size_t until = from;
	while (until < source->length && source->text[until] != '\n' && until - from < SHOWN)
		until++;
	while (until > from &&
	       (source->text[until - 1] == '\r' || (until < source->length && is_continuation(source->text[until]))))
		until--;
	for (size_t i = from, length; i < until; i += length) {
		unsigned char c = (unsigned char)source->text[i];
		length = character_length((const unsigned char *)source->text + i);
		if (length == 0 || (c < ' ' && c != '\t') || c == 127)
			length = (size_t)fprintf(to, "?");
		else
			fwrite(source->text + i, 1, length, to);
	}
	putc('\n', to);
	for (size_t i = from; i < at.offset && i < until; i++)
		if (!is_continuation(source->text[i]))
			putc(source->text[i] == '\t' ? '\t' : ' ', to);
	fputs("^\n", to);
}

/* Where the counting of lines stands: places come in order. */
struct count {
	const struct source *source;
	size_t offset, line;
};

static void print_one(FILE *to, const struct diagnostic *d, struct count *count)
{
	const struct source *source = d->at.source;
	size_t start = line_start(source, d->at.offset);
	if (count->source != source)
		*count = (struct count){ source, 0, 1 };
	for (; count->offset < start; count->offset++)
		count->line += source->text[count->offset] == '\n';
	size_t column = 1 + count_characters(source->text + start, d->at.offset - start);
	fprintf(to, "%s:%zu:%zu: %s: %s\n", source->name, count->line, column, d->severity, d->message);
	print_line(to, d->at);
	if (d->note)
		fprintf(to, "note: %s\n", d->note);
}

static int by_place(const void *left, const void *right)
{
	const struct diagnostic *a = left, *b = right;
	if (a->at.source != b->at.source)
		return a->at.source->order - b->at.source->order;
	if (a->at.offset != b->at.offset)
		return a->at.offset < b->at.offset ? -1 : 1;
	return a->number - b->number;
}

void diagnostics_print(FILE *to)
{
	progress_end();
	if (said_count == 0)
		return;
	struct count count = { NULL, 0, 1 };
	qsort(said, (size_t)said_count, sizeof *said, by_place);
	for (int i = 0; i < said_count; i++)
		print_one(to, &said[i], &count);
	said_count = 0;
}

static struct source *source_new(const char *name, const char *base, char *text, size_t length)
{
	struct source *source = NEW(struct source);
	static int sources;
	*source = (struct source){ .name = name, .base = base, .text = text, .length = length, .order = sources++ };
	return source;
}

struct source *source_text(const char *name, const char *text)
{
	return source_new(name, name, format("%s", text), strlen(text));
}

struct source *source_argument(const char *text)
{
	return source_new("<command line>", "command line", format("%s", text), strlen(text));
}

/* Text that is no text is reported at its first bad byte, before any statement is looked at. */
static bool check_text(const struct source *source)
{
	size_t line = 0;
	for (size_t i = 0, step; i < source->length; i += step) {
		struct place at = { source, i };
		unsigned char c = (unsigned char)source->text[i];
		step = character_length((const unsigned char *)source->text + i);
		if (c == 0 || step == 0) {
			say_error(at, "a spec is UTF-8 text", "this is not a text file: byte 0x%02x", c);
			return false;
		}
		if (c == '\n')
			line = i + 1;
		else if (i - line >= LIMIT_LINE) {
			say_error((struct place){ source, line }, NULL, "line longer than the limit of %d bytes",
				  LIMIT_LINE);
			return false;
		}
	}
	return true;
}

static char *read_all(FILE *file, size_t *length)
{
	char *text = NULL;
	size_t room = 0;
	*length = 0;
	for (;;) {
		if (room - *length < 4096)
			ENLARGE(text, room = 2 * room + 8192);
		size_t got = fread(text + *length, 1, room - *length - 1, file);
		*length += got;
		if (got == 0 || *length > LIMIT_TEXT)
			break;
	}
	text[*length] = 0;
	return text;
}

/* plgen two where there is a two.spec */
static const char *spec_beside(const char *path)
{
	const char *name = format("%s.spec", path);
	FILE *file = fopen(name, "rb");
	if (!file)
		return NULL;
	fclose(file);
	return format("did you mean '%s'?", name);
}

static void cannot_read(const struct source *source, struct place at, const char *why)
{
	if (at.source)
		say_error(at, NULL, "cannot read '%s': %s", source->name, why);
	else
		say_error((struct place){ source, 0 }, spec_beside(source->name), "cannot read the file: %s", why);
}

struct source *source_read(const char *path, struct place at)
{
	static struct source *input;            /* standard input: many models may be made of it, and it is read once */
	bool standard = !at.source && strcmp(path, "-") == 0;
	if (standard && input)
		return input;
	const char *slash = strrchr(path, '/');
	struct source *source = source_new(standard ? "<stdin>" : path,
					   standard ? "<stdin>"
					   : slash  ? slash + 1
						    : path,
					   "", 0);
	struct place start = { source, 0 };
	FILE *file = standard ? stdin : fopen(path, "rb");
	if (!file) {
		cannot_read(source, at, strerror(errno));
		return NULL;
	}
	size_t length;
	errno = 0;
	char *text = read_all(file, &length);
	int failed = ferror(file) ? errno : 0;
	if (!standard)
		fclose(file);
	if (failed) {
		cannot_read(source, at, strerror(failed));
		return NULL;
	}
	if (length > LIMIT_TEXT) {
		say_error(start, NULL, "file longer than the limit of %d bytes", LIMIT_TEXT);
		return NULL;
	}
	source->text = text;
	source->length = length;
	if (!check_text(source))
		return NULL;
	if (standard)
		input = source;
	return source;
}

struct place place_end(const struct source *source)
{
	size_t offset = source->length;
	while (offset > 0 && strchr(" \t\r\n", source->text[offset - 1]))
		offset--;
	return (struct place){ source, offset };
}

static bool too_long(mpz_srcptr z)
{
	return mpz_sizeinbase(z, 2) > LIMIT_BITS;
}

void check_bits(struct place at, mpq_srcptr value)
{
	if (too_long(mpq_numref(value)) || too_long(mpq_denref(value)))
		error(at, NULL, "exact value over the limit of %d bits", LIMIT_BITS);
}

void check_power(struct place at, mpq_srcptr base, unsigned long exponent)
{
	size_t bits = mpz_sizeinbase(mpq_numref(base), 2), below = mpz_sizeinbase(mpq_denref(base), 2);
	bits = bits > below ? bits : below;
	bool unit = bits == 1;
	if (!unit && exponent > 0 && bits - 1 > LIMIT_BITS / exponent)
		error(at, NULL, "exact value over the limit of %d bits", LIMIT_BITS);
}
