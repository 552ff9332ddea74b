/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The runtime's files that C needs: those that define a function which it names, and what these need in turn. Its
 * declarations all stand in plrt.h, so what a file needs does not show in its includes alone. */
#include "fmu/fmu.h"

#include <ctype.h>
#include <string.h>

#include "runtime_texts.h"

enum { TEXTS = sizeof texts / sizeof *texts };

const char *runtime_file(const char *name)
{
	for (int i = 0; i < TEXTS; i++)
		if (strcmp(texts[i].name, name) == 0)
			return texts[i].text;
	return NULL;
}

static bool is_word(char c)
{
	return isalnum((unsigned char)c) || c == '_';
}

static bool names(const char *text, const char *word)
{
	const size_t length = strlen(word);
	for (const char *at = strstr(text, word); at; at = strstr(at + 1, word))
		if ((at == text || !is_word(at[-1])) && !is_word(at[length]))
			return true;
	return false;
}

/* For float, seriesf.c is series.c with other names, those of real.h: #define pl_root pl_rootf */
static const char *name_in_float(const char *name)
{
	const char *line = strstr(runtime_file("real.h"), format("#define %s pl_", name));
	const char *value = line ? line + strlen("#define  ") + strlen(name) : NULL;
	return value ? format("%.*s", (int)strcspn(value, "\n"), value) : name;
}

/* series.c of seriesf.c; else NULL */
static const char *base_of(int file)
{
	const char *include = strstr(texts[file].text, "#include \""), *name = include ? include + 10 : "";
	const int length = (int)strcspn(name, "\"");
	return length > 2 && strncmp(name + length - 2, ".c", 2) == 0 ? format("%.*s", length, name) : NULL;
}

/* The function that a line of text defines: it starts in the first column and is no declaration */
static const char *defined_at(const char *line)
{
	const size_t length = strcspn(line, "\n");
	const char *bracket = memchr(line, '(', length), *name = bracket;
	if (!isalpha((unsigned char)*line) || !bracket || strncmp(line, "static", 6) == 0 || line[length - 1] == ';')
		return NULL;
	while (name > line && is_word(name[-1]))
		name--;
	return strncmp(name, "pl_", 3) == 0 ? format("%.*s", (int)(bracket - name), name) : NULL;
}

/* What the C of a model needs so far */
struct wants {
	const char *code;
	bool single;
	bool file[TEXTS];
};

static const char *text_of(int file)
{
	return base_of(file) ? runtime_file(base_of(file)) : texts[file].text;
}

static bool is_named(const struct wants *wants, const char *name)
{
	bool named = names(wants->code, name);
	for (int i = 0; i < TEXTS && !named; i++)
		named = wants->file[i] && names(text_of(i), name);
	return named;
}

/* Is a function named that the file defines? Of files for float under its name there, or in another of them as in the
 * one that it was made of. */
static bool serves(int file, const struct wants *wants)
{
	for (const char *line = text_of(file); line; line = strchr(line, '\n')) {
		line += *line == '\n';
		const char *name = defined_at(line);
		if (name && (is_named(wants, base_of(file) ? name_in_float(name) : name) ||
			     (wants->single && is_named(wants, name))))
			return true;
	}
	return false;
}

/* Of the type: seriesf.c for float, series.c else */
static bool is_of_type(int file, bool single)
{
	const char *name = texts[file].name;
	const size_t length = strlen(name);
	if (strncmp(name, "fmi", 3) == 0 || length < 4 || strcmp(name + length - 2, ".c") != 0)
		return false;
	const bool for_float = name[length - 3] == 'f' &&
			       runtime_file(format("%.*s.c", (int)length - 3, name));
	return for_float == single;
}

static void add_file(struct archive *to, const char *name);

static void add_includes(struct archive *to, const char *text)
{
	for (const char *at = text; (at = strstr(at, "#include \"")); at++) {
		const char *name = format("%.*s", (int)strcspn(at + 10, "\""), at + 10);
		if (runtime_file(name))
			add_file(to, name);
	}
}

static void add_file(struct archive *to, const char *name)
{
	const char *path = format("sources/%s", name), *text = runtime_file(name);
	if (archive_find(to, path))
		return;
	archive_add(to, path, text, strlen(text));
	add_includes(to, text);
}

void add_runtime(struct fmu *f, struct archive *to, const char *code)
{
	struct wants wants = { code, f->single, { false } };
	for (bool again = true; again;) {
		again = false;
		for (int i = 0; i < TEXTS; i++)
			if (!wants.file[i] && is_of_type(i, f->single) && serves(i, &wants))
				wants.file[i] = again = true;
	}
	for (int i = 0; i < TEXTS; i++)
		if (wants.file[i]) {
			ENLARGE(f->source, (size_t)f->sources + 1);
			f->source[f->sources++] = texts[i].name;
			add_file(to, texts[i].name);
		}
	add_file(to, f->version == 3 ? "fmi3.c" : "fmi2.c");
	add_file(to, "plrt.h");
}
