/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What every topic's program does with files: its arguments, tables, variants, histories as rows, checks. */
#include <dlfcn.h>
#include <math.h>
#include <stdarg.h>
#include <stdlib.h>
#include <string.h>
#include <unistd.h>

#include "charts.h"

const char *const family_names[] = {"ours", "fixed", "adaptive", "propagator"};

unsigned flags_of(int argc, char ***argv, const char *flags, int least, int most, const char *usage)
{
	unsigned found = 0;
	char **next = *argv + 1;
	for (; next < *argv + argc && strncmp(*next, "--", 2) == 0; next++) {
		const char *at = strstr(flags, *next);
		unsigned bit = 1;
		for (const char *c = flags; at && c < at; c++)
			bit <<= *c == ' ';
		found |= at ? bit : 0;
	}
	const int left = (int)(*argv + argc - next);
	if (left < least || left > most) {
		fprintf(stderr, "usage: %s\n", usage);
		exit(2);
	}
	*argv = next;
	return found;
}

void say_progress(const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	if (isatty(2))
		fputs("\r\033[K", stderr);
	vfprintf(stderr, format, arguments);
	if (!isatty(2))
		fputc('\n', stderr);
	va_end(arguments);
	fflush(stderr);
}

void leave(const char *of, const char *why)
{
	fprintf(stderr, "%s: %s\n", of, why);
	exit(1);
}

void *room_for(size_t count, size_t size)
{
	void *room = calloc(count + 1, size);
	if (!room)
		leave("charts", "out of memory");
	return room;
}

/* Without a slash dlopen would look in the system's places */
void *object_open(const char *file)
{
	return dlopen(text("%s%s", strchr(file, '/') ? "" : "./", file), RTLD_NOW | RTLD_LOCAL);
}

FILE *file_in(const char *folder, const char *name, const char *mode)
{
	const char *path = text(*folder ? "%s/%s" : "%s%s", folder, name);
	FILE *f = fopen(path, mode);
	if (!f) {
		perror(path);
		exit(1);
	}
	return f;
}

FILE *table_open(const char *folder, const char *name, const char *head)
{
	FILE *csv = file_in(folder, name, "w");
	fprintf(csv, "%s\n", head);
	return csv;
}

void table_close(FILE *csv, const char *name)
{
	const bool bad = ferror(csv);
	if (fclose(csv) != 0 || bad) {
		perror(name);
		exit(1);
	}
}

double value_of(const char *fraction)
{
	const char *bar = strchr(fraction, '/');
	return bar ? atof(fraction) / atof(bar + 1) : atof(fraction);
}

void put_quoted(FILE *out, const char *text)
{
	putc('"', out);
	for (; text && *text; text++)
		putc(*text == '"' ? '\'' : *text, out);
	putc('"', out);
}

void put_number(FILE *out, const char *format, double x, const char *word)
{
	if (isfinite(x))
		fprintf(out, format, x);
	else
		fputs(word, out);
	putc(',', out);
}

const char *text(const char *format, ...)
{
	enum { KEPT = 16, LENGTH = 4096 };
	static char kept[KEPT][LENGTH];
	static int last;
	va_list arguments;
	last = (last + 1) % KEPT;
	va_start(arguments, format);
	vsnprintf(kept[last], LENGTH, format, arguments);
	va_end(arguments);
	return kept[last];
}

void split_line(const char *of, char *line, int count, char **field)
{
	int found = 0;
	line[strcspn(line, "\n")] = '\0';
	for (char *at = line; at && found < count; found++) {
		field[found] = at;
		at = strchr(at, '\t');
		if (at)
			*at++ = '\0';
	}
	if (found < count)
		leave(of, "a line of its list has too few fields");
}

void *variant_symbol(const char *folder, const char *file, const char *name)
{
	const char *path = text("%s/%s.so", folder, file);
	void *handle = object_open(path), *symbol = handle ? dlsym(handle, name) : NULL;
	if (!symbol)
		leave(path, dlerror());
	return symbol;
}

const pl_model *variant_model(const char *folder, const char *file)
{
	return variant_symbol(folder, file, "subject_model");
}

char *variant_refused(const char *file)
{
	char *line = NULL;
	size_t room = 0;
	FILE *f = fopen(text("%s.refused", file), "r");
	if (!f)
		return NULL;
	ssize_t length = getline(&line, &room, f);
	fclose(f);
	if (length < 0) {
		free(line);
		return strdup("refused");
	}
	line[strcspn(line, "\n")] = '\0';
	return line;
}

bool same_names(int states, int outputs, const char *const *state, const char *const *output)
{
	bool same = states == outputs;
	for (int i = 0; same && i < states; i++)
		same = strcmp(state[i], output[i]) == 0;
	return same;
}

/* ---- histories ---- */

double *history_rows(struct run *run, int units)
{
	const size_t entries = (size_t)units * 2 * (size_t)run->problem->n;
	double *rows = room_for(entries, sizeof *rows);
	for (size_t i = 0; i < entries; i++)
		rows[i] = NAN;
	run->restart(run);
	run->advance(run, units, rows);
	return rows;
}

double largest_off(int n, int judged, const double *rows, const double *than, int units)
{
	double worst = 0;
	for (int u = 0; u < units; u++)
		for (int i = 0; i < judged; i++) {
			const double off = fabs(rows[u * 2 * n + i] - than[u * 2 * n + i]);
			worst = off <= worst ? worst : isfinite(off) ? off : INFINITY;
		}
	return worst;
}

/* ---- checks ---- */

void checks_open(struct checks *c, const char *folder, const char *name)
{
	c->csv = table_open(folder, name, "what,known,measured,tolerance,result");
	c->off = 0;
}

void check(struct checks *c, double known, double measured, double tolerance, const char *format, ...)
{
	char what[200];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(what, sizeof what, format, arguments);
	va_end(arguments);
	const bool good = known == measured || fabs(measured - known) <= tolerance * (known == 0 ? 1 : fabs(known));
	c->off += !good;
	fprintf(c->csv, "\"%s\",%.9g,%.9g,%.2g,%s\n", what, known, measured, tolerance, good ? "ok" : "off");
	if (!good)
		say_progress("off: %s: known %.17g, measured %.17g, tolerance %.2g", what, known, measured, tolerance);
}

int checks_close(struct checks *c)
{
	table_close(c->csv, "checks");
	return c->off > 0;
}
