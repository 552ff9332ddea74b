/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The format of cases.c, read: a text is a piece of the file, which stays in memory. */
#define _GNU_SOURCE     /* vasprintf, open_memstream */
#include "cases.h"

#include <ctype.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

_Noreturn void bail_out(const char *format, ...)
{
	va_list arguments;
	va_start(arguments, format);
	printf("Bail out! ");
	vprintf(format, arguments);
	putchar('\n');
	exit(99);
}

void *more(void *array, int count, size_t size)
{
	if ((count & (count - 1)) == 0)         /* none, or a power of 2: it is full */
		array = realloc(array, (count ? 2 * (size_t)count : 1) * size);
	if (!array)
		bail_out("out of memory");
	memset((char *)array + (size_t)count * size, 0, size);
	return array;
}

char *print(const char *format, ...)
{
	char *text;
	va_list arguments;
	va_start(arguments, format);
	if (vasprintf(&text, format, arguments) < 0)
		bail_out("out of memory");
	va_end(arguments);
	return text;
}

static struct text whole(const char *path)
{
	FILE *from = fopen(path, "rb");
	if (!from || fseek(from, 0, SEEK_END) != 0)
		bail_out("%s cannot be read", path);
	size_t length = (size_t)ftell(from);
	char *text = calloc(length + 1, 1);
	rewind(from);
	if (!text || fread(text, 1, length, from) != length)
		bail_out("%s cannot be read", path);
	fclose(from);           /* before anything is forked: a child that ends would move the place in it */
	return (struct text){ text, length };
}

struct reader {
	const char *path;
	int line;
	struct topic *topic;
	struct cases *cases;
	struct one *one;        /* NULL: before the first */
	struct text *open;      /* the lines that come belong to it; NULL: comments */
};

static _Noreturn void wrong(const struct reader *r, const char *what)
{
	bail_out("%s:%d: %s", r->path, r->line, what);
}

/* ---- the line of a case ---- */

/* The next word of a line, which ends with a 0: blanks may stand in quotes. NULL: no more */
static char *next_word(const struct reader *r, char **at)
{
	char *from = *at + strspn(*at, " "), *to = from, *word = from;
	bool quoted = false;
	if (!*from)
		return NULL;
	for (; *from && (quoted || *from != ' '); from++)
		if (*from == '\'')
			quoted = !quoted;
		else
			*to++ = *from;
	if (quoted)
		wrong(r, "a quote is not closed");
	*at = *from ? from + 1 : from;
	*to = 0;
	return word;
}

static void read_status(const struct reader *r, char **at)
{
	const char *word = next_word(r, at);
	if (!word || strspn(word, "0123456789") != strlen(word) || next_word(r, at))
		wrong(r, "an exit status ends the line: -> 0");
	r->one->status = atoi(word);
}

static void end_case(const struct reader *r)
{
	if (r->one && !r->one->said.at)
		wrong(r, print("%s has no line --- with what is said after it", r->one->name));
}

static void begin_case(struct reader *r, char *line)
{
	end_case(r);
	struct cases *cases = r->cases;
	char *name = next_word(r, &line), *word;
	if (!name)
		wrong(r, "a case has a name: === NAME");
	for (int i = 0; i < cases->count; i++)
		if (cases->one[i].topic == r->topic && strcmp(cases->one[i].name, name) == 0)
			wrong(r, print("two cases are called %s", name));
	cases->one = more(cases->one, cases->count, sizeof *cases->one);
	struct one *c = r->one = &cases->one[cases->count++];
	*c = (struct one){ .topic = r->topic, .name = name, .status = 1 };
	r->open = &c->spec;
	while ((word = next_word(r, &line)) && strcmp(word, "->") != 0) {
		c->argument = more(c->argument, c->arguments, sizeof *c->argument);
		c->argument[c->arguments++] = word;
	}
	if (word)
		read_status(r, &line);
}

/* ---- the other lines ---- */

static void begin_file(struct reader *r, char *line)
{
	if (r->one && r->one->said.at)
		wrong(r, "a file stands before the --- of its case");
	struct files *files = r->one ? &r->one->beside : &r->topic->shared;
	files->file = more(files->file, files->count, sizeof *files->file);
	struct file *f = &files->file[files->count++];
	f->name = next_word(r, &line);
	if (!f->name || next_word(r, &line))
		wrong(r, "a file has one name: +++ FILE");
	r->open = &f->text;
	f->text.at = "";
}

static void begin_said(struct reader *r)
{
	if (!r->one || r->one->said.at)
		wrong(r, "--- without a case");
	r->open = &r->one->said;
	r->open->at = "";
}

static void add_line(struct reader *r, const char *line, size_t length)
{
	if (!r->open && length > 1 && *line != '#')
		wrong(r, "before the first case there are files and comments only");
	if (!r->open)
		return;
	if (r->open->length == 0)
		r->open->at = line;
	r->open->length += length;
}

static char *copy(const char *line, size_t length)
{
	return print("%.*s", (int)length, line);
}

static void read_line(struct reader *r, const char *line, size_t length)
{
	r->line++;
	if (line[length - 1] != '\n')
		wrong(r, "the last line has no end");
	if (length > 4 && memcmp(line, "=== ", 4) == 0)
		begin_case(r, copy(line + 4, length - 5));
	else if (length > 4 && memcmp(line, "+++ ", 4) == 0)
		begin_file(r, copy(line + 4, length - 5));
	else if (length == 4 && memcmp(line, "---", 3) == 0)
		begin_said(r);
	else
		add_line(r, line, length);
}

/* Empty lines stand between cases. */
static void trim(struct text *said)
{
	while (said->length > 0 && said->at[said->length - 1] == '\n' &&
	       (said->length == 1 || said->at[said->length - 2] == '\n'))
		said->length--;
}

/* ---- what is shown of a place ---- */

/* The line of that number, without its end */
static struct text line_of(const struct one *c, int number)
{
	const char *line = c->spec.at, *end = line + c->spec.length;
	while (line && line < end && --number > 0)
		line = (const char *)memchr(line, '\n', (size_t)(end - line)) + 1;
	if (!line || line >= end)
		bail_out("%s says something of a line that it does not have", c->name);
	return (struct text){ line, (size_t)((const char *)memchr(line, '\n', (size_t)(end - line)) - line) };
}

/* The line, and a caret below its character `column` */
static void show_place(FILE *to, struct text line, int column)
{
	fprintf(to, "%.*s\n", (int)line.length, line.at);
	for (size_t i = 0, characters = 0; i < line.length && characters < (size_t)column; i++) {
		const bool begins = ((unsigned char)line.at[i] & 0xc0) != 0x80;
		characters += begins;
		if (begins && characters < (size_t)column)
			putc(line.at[i] == '\t' ? '\t' : ' ', to);
	}
	fputs("^\n", to);
}

/* A line that begins with a place stands for what is said of that place of the spec. */
static void complete(struct one *c)
{
	size_t length;
	char *text;
	FILE *to = open_memstream(&text, &length);
	if (!to)
		bail_out("out of memory");
	const char *end = c->said.at + c->said.length;
	for (const char *line = c->said.at, *next; line < end; line = next) {
		int number, column, after = 0;
		next = (const char *)memchr(line, '\n', (size_t)(end - line)) + 1;
		const bool placed = isdigit((unsigned char)*line) &&
				    sscanf(line, "%d:%d:%n", &number, &column, &after) == 2 && line[after] == ' ';
		if (placed)
			fprintf(to, "%s.spec:", c->name);
		fwrite(line, 1, (size_t)(next - line), to);
		if (placed)
			show_place(to, line_of(c, number), column);
	}
	fclose(to);
	c->said = (struct text){ text, length };
}

/* parts of /a/b/parts.cases */
static struct topic *topic_of(const char *path)
{
	const char *name = strrchr(path, '/') + 1;
	struct topic *topic = more(NULL, 0, sizeof *topic);
	topic->name = copy(name, strcspn(name, "."));
	return topic;
}

void read_topic(const char *path, struct cases *cases)
{
	const struct text text = whole(path);
	const char *end = text.at + text.length;
	struct reader r = { .path = path, .topic = topic_of(path), .cases = cases };
	int first = cases->count;
	for (const char *line = text.at, *next; line < end; line = next) {
		const char *stop = memchr(line, '\n', (size_t)(end - line));
		next = stop ? stop + 1 : end;
		read_line(&r, line, (size_t)(next - line));
	}
	end_case(&r);
	for (int i = first; i < cases->count; i++) {
		trim(&cases->one[i].said);
		complete(&cases->one[i]);
	}
}
