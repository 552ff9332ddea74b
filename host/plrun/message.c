/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is wrong, and where; memory; a line that says how far a run is. */
#define _GNU_SOURCE
#include "plrun.h"

#include <stdarg.h>
#include <stdlib.h>
#include <time.h>
#include <unistd.h>

static bool shown;                      /* a line that says how far a run is */

char *format(const char *pattern, ...)
{
	va_list arguments;
	char *text = NULL;
	va_start(arguments, pattern);
	int length = vasprintf(&text, pattern, arguments);
	va_end(arguments);
	return length < 0 ? need(NULL) : text;
}

void fail(int status, const char *message)
{
	progress_end();
	fprintf(stderr, "plrun: error: %s\n", message);
	exit(status);
}

void wrong_usage(const char *message)
{
	fprintf(stderr, "plrun: error: %s\nnote: plrun --help lists the options\n", message);
	exit(WRONG_USAGE);
}

static bool quiet;

void leave_notes_to_first(void)
{
	quiet = true;
}

void say_note(const char *message)
{
	if (quiet)
		return;
	progress_end();
	fprintf(stderr, "note: %s\n", message);
}

void say_text(const char *text)
{
	if (!quiet)
		fputs(text, stderr);
}

void *need(void *memory)
{
	if (!memory)
		fail(WRONG_DATA, "out of memory");
	return memory;
}

void *grown(void *array, size_t count, size_t *room, size_t item)
{
	if (count < *room)
		return array;
	*room = count < 8 ? 8 : 2 * count;
	return need(reallocarray(array, *room, item));
}

/* ---- places ---- */

/* The line, what is no text in it as '?', and a caret; of a very long line the surroundings */
static void print_line(struct place at)
{
	enum { BEFORE = 100, SHOWN = 160 };
	size_t from = at.column > BEFORE ? at.column - BEFORE : 0;
	while (from < at.column && ((unsigned char)at.line[from] & 0xC0) == 0x80)
		from++;
	for (size_t i = from; i < at.length && i < from + SHOWN; i++)
		putc((unsigned char)at.line[i] >= ' ' || at.line[i] == '\t' ? at.line[i] : '?', stderr);
	putc('\n', stderr);
	for (size_t i = from; i < at.column; i++)
		if (i >= at.length || ((unsigned char)at.line[i] & 0xC0) != 0x80)
			putc(i < at.length && at.line[i] == '\t' ? '\t' : ' ', stderr);
	fputs("^\n", stderr);
}

void say_at(struct place at, const char *message)
{
	progress_end();
	fprintf(stderr, "%s:%lu:%zu: error: %s\n", at.path, at.number, at.column + 1, message);
	if (at.length)
		print_line(at);
}

void fail_at(struct place at, const char *note, const char *message)
{
	say_at(at, message);
	if (note)
		fprintf(stderr, "note: %s\n", note);
	exit(WRONG_DATA);
}

/* ---- how far a run is ---- */

static long milliseconds(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return 1000 * (long)t.tv_sec + t.tv_nsec / 1000000;
}

static bool always;                    /* lines, also where no terminal is: in a log, one in two seconds */

void progress_always(void)
{
	always = true;
}

bool progress_wanted(void)
{
	static int terminal = -1;
	static long last;
	if (terminal < 0) {
		terminal = isatty(STDERR_FILENO);
		last = milliseconds() + (always ? -10000 : 800);   /* what takes less than a second needs no line */
	}
	if (!(terminal || always) || milliseconds() - last < (terminal ? 200 : 2000))
		return false;
	last = milliseconds();
	return true;
}

void progress(const char *line)
{
	const bool terminal = isatty(STDERR_FILENO);
	fprintf(stderr, terminal ? "\rplrun: %s\033[K" : "plrun: %s\n", line);
	fflush(stderr);
	shown = terminal;
}

void progress_end(void)
{
	if (shown)
		fputs("\r\033[K", stderr);
	shown = false;
}
