/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The runtime's text in pieces, each of which can be left out. */
#include "command.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* ---- words ---- */

static bool begins_word(char c) { return in_name(c) && !isdigit((unsigned char)c); }

/* Past what begins at `from`: a comment, a string, a character, a number, a word or a sign */
static const char *token_end(const char *from)
{
	const char *at = from + 1;
	if (from[0] == '/' && from[1] == '*') {
		const char *end = strstr(from + 2, "*/");
		return end ? end + 2 : from + strlen(from);
	}
	if (*from == '"' || *from == '\'') {
		for (; *at && *at != *from; at++)
			at += *at == '\\' && at[1];
		return *at ? at + 1 : at;
	}
	while (in_name(*from) && (in_name(*at) || (*at == '.' && isdigit((unsigned char)*from))))
		at++;
	return at;
}

const char *next_word(const char **at, size_t *length)
{
	while (**at) {
		const char *from = *at;
		*at = token_end(from);
		*length = (size_t)(*at - from);
		if (begins_word(*from))
			return from;
	}
	return NULL;
}

static const char *first_sign(const char *text, const char *signs)
{
	for (; *text; text = token_end(text))
		if (strchr(signs, *text) && !(text[0] == '/' && text[1] == '*'))
			return text;
	return NULL;
}

/* ---- a piece and what it declares ---- */

static void add_name(struct piece *p, const char *word, size_t length)
{
	*MORE(p->name, p->names) = format("%.*s", (int)length, word);
}

/* The last word before `end` */
static void add_last(struct piece *p, const char *text, const char *end)
{
	const char *word, *last = NULL;
	size_t length, of_last = 0;
	while ((word = next_word(&text, &length)) && word < end) {
		last = word;
		of_last = length;
	}
	if (last)
		add_name(p, last, of_last);
}

static void add_macros(struct piece *p)
{
	for (const char *line = p->text; line; line = strchr(line, '\n') ? strchr(line, '\n') + 1 : NULL)
		if (strncmp(line, "#define ", 8) == 0)
			add_name(p, line + 8, (size_t)(token_end(line + 8) - line - 8));
}

static void add_constants(struct piece *p)
{
	const char *at = strchr(p->text, '{');
	for (bool expected = true; at && *at != '}'; at = token_end(at))
		if (*at == ',' || *at == '{') {
			expected = true;
		} else if (begins_word(*at) && expected) {
			add_name(p, at, (size_t)(token_end(at) - at));
			expected = false;
		}
}

static void name_piece(struct piece *p)
{
	if (*p->text == '#') {
		add_macros(p);
	} else if (strncmp(p->text, "typedef ", 8) == 0) {
		add_last(p, p->text, p->text + strlen(p->text));
	} else if (strncmp(p->text, "enum ", 5) == 0) {
		add_constants(p);
	} else if (strncmp(p->text, "PL_ASSERT(", 10) != 0) {
		const char *end = first_sign(p->text, "([=;");
		p->function = end && *end == '(';
		p->local = strncmp(p->text, "static ", 7) == 0;
		add_last(p, p->text, end ? end : p->text);
	}
}

static void add_piece(struct runtime *r, const char *file, const char *comment, const char *text)
{
	struct piece *p = MORE(r->piece, r->pieces);
	*p = (struct piece){ .file = file, .comment = comment, .text = text };
	p->typed = strcmp(file, "plreal") == 0;
	p->shared = p->typed || strcmp(file, "plrt") == 0;
	name_piece(p);
}

/* ---- a file: what the preprocessor would leave out for one type of numbers, and the rest in pieces ---- */

struct reader {
	struct runtime *runtime;
	const char *file;               /* its name without the ending */
	const char *comment, *text;     /* of the piece that is being read; the text in the file, from its first line */
	const char *read, *end;         /* so far by is_complete(); behind its last line */
	int depth;                      /* open brackets there, and the last sign */
	char last;
	int conditions;                 /* open #if of the piece */
	int known, left_out;            /* open #if that are decided here; the outermost that is not taken, 0: none */
	int opaque_inside[8];           /* other #if inside each of them */
};

static void read_file(struct runtime *r, const char *name);
static void read_lines(struct reader *f, const char *rest);

/* A header without a guard is a part of the file that includes it, but for the types of plrt.h. */
static bool stands_alone(const char *name)
{
	return strncmp(name, "pl", 2) == 0 || strstr(runtime_text(name), "#ifndef PL");
}

static const char *without_ending(const char *name)
{
	return format("%.*s", (int)(strlen(name) - 2), name);
}

/* Is a declaration or a group of lines complete, with its last line? */
static bool is_complete(struct reader *f)
{
	if (*f->text == '#')
		return f->conditions == 0 && f->end[-2] != '\\';
	for (const char *end; f->read < f->end; f->read = end) {
		end = token_end(f->read);
		if (f->read[0] == '/' && f->read[1] == '*') {
			if (end > f->end)
				return false;
			continue;
		}
		f->depth += (strchr("({[", *f->read) != NULL) - (strchr(")}]", *f->read) != NULL);
		f->last = isspace((unsigned char)*f->read) ? f->last : *f->read;
	}
	return f->depth == 0 && (f->last == ';' || f->last == '}');
}

/* `end`: behind it in the file */
static void take_line(struct reader *f, const char *line, const char *end)
{
	bool comment_open = *f->comment && !strstr(f->comment, "*/");
	if (!*f->text && (comment_open || strncmp(line, "/*", 2) == 0)) {
		f->comment = format("%s%s\n", comment_open ? f->comment : "", line);
		return;
	}
	if (!*f->text && !*line) {
		f->comment = "";
		return;
	}
	f->conditions += strncmp(line, "#if", 3) == 0;
	f->conditions -= strncmp(line, "#endif", 6) == 0;
	if (!*f->text) {
		f->text = f->read = end - strlen(line) - 1;
		f->depth = f->last = 0;
	}
	f->end = end;
	if (!is_complete(f))
		return;
	add_piece(f->runtime, f->file, f->comment, format("%.*s", (int)(end - f->text), f->text));
	f->comment = f->text = "";
}

static bool is_variant(const struct runtime *r, const char *variant)
{
	return r->variant && strcmp(r->variant, variant) == 0;
}

/* Of derivatives */
static bool has_columns(const struct runtime *r)
{
	return is_variant(r, "_d") || is_variant(r, "_compensated_d");
}

/* Names that are decided here: 1 defined, 0 not, -1 another name */
static int decided(const struct runtime *r, const char *name)
{
	size_t length = strlen(name);
	if (strcmp(name, "REAL_IS_FLOAT") == 0 || strcmp(name, "PL_FLOAT_ONLY") == 0 || strcmp(name, "PL_SINGLE") == 0)
		return r->single;
	if (strcmp(name, "STATE_IS_COMPENSATED") == 0)
		return is_variant(r, "_compensated") || is_variant(r, "_compensated_d");
	if (strcmp(name, "WITH_DERIVATIVES") == 0)
		return has_columns(r);
	if (strcmp(name, "__cplusplus") == 0)
		return 0;
	return length > 2 && strncmp(name, "PL", 2) == 0 && strcmp(name + length - 2, "_H") == 0 ? 0 : -1;
}

/* #if, #else and #endif of what is decided; false: the line is another one */
static bool take_condition(struct reader *f, const char *line)
{
	char word[64] = "", name[64] = "";
	sscanf(line, "#%63s %63s", word, name);
	bool asks = strcmp(word, "ifdef") == 0 || strcmp(word, "ifndef") == 0 || strcmp(line, "#if PL_SINGLE") == 0;
	int is = asks ? decided(f->runtime, name) : -1;
	if (is >= 0) {
		f->opaque_inside[++f->known] = 0;
		if (!f->left_out && (is == 1) == (word[2] == 'n'))
			f->left_out = f->known;
		return true;
	}
	if (strncmp(word, "if", 2) == 0)
		f->opaque_inside[f->known]++;
	bool own = f->known > 0 && f->opaque_inside[f->known] == 0;
	if (strcmp(word, "else") == 0 && own) {
		f->left_out = f->left_out == f->known ? 0 : f->left_out ? f->left_out : f->known;
		return true;
	}
	if (strcmp(word, "endif") != 0)
		return false;
	if (!own) {
		f->opaque_inside[f->known]--;
		return false;
	}
	f->left_out = f->left_out == f->known ? 0 : f->left_out;
	f->known--;
	return true;
}

/* Hooks for derivatives, empty where there are none: lines of VARIED and SET_VARIATION, the word AND_VARIATION */
static const char *without_hooks(const struct runtime *r, const char *text)
{
	if (has_columns(r) || !strstr(text, "VARI"))
		return text;
	char *copy = ARRAY(char, strlen(text) + 1), *to = copy;
	for (const char *line = text, *end; *line; line = end) {
		end = strchr(line, '\n') ? strchr(line, '\n') + 1 : line + strlen(line);
		const char *word = line + strspn(line, " "), *last = strstr(line, " AND_VARIATION)");
		if (strncmp(word, "VARIED(", 7) == 0 || strncmp(word, "SET_VARIATION(", 14) == 0)
			continue;
		for (; line < end; line++)
			if (line == last)
				line += strlen(" AND_VARIATION") - 1;
			else
				*to++ = *line;
	}
	return copy;
}

/* #include, and #define of what is decided or of another name in float; false: the line is another one */
static bool take_directive(struct reader *f, const char *line)
{
	struct runtime *r = f->runtime;
	char name[64], other[64], end;
	if (strncmp(line, "#undef ", strlen("#undef ")) == 0 ||
	    (!r->single && strcmp(line, "#include \"floats.h\"") == 0))
		return true;
	if (sscanf(line, "#include \"%63[^\"]\"", name) == 1) {
		if (!stands_alone(name)) {
			read_lines(f, without_hooks(r, runtime_text(name)));
			return true;
		}
		*MORE(r->include, r->includes) = (struct include){ f->file, without_ending(name) };
		read_file(r, name);
		return true;
	}
	if (sscanf(line, "#include <%63[^>]>", name) == 1)
		return true;
	int words = sscanf(line, "#define %63s %63s %c", name, other, &end);
	if (words == 1 && decided(r, name) >= 0)
		return true;
	if (words == 2 && (strcmp(name, "real") == 0 || strcmp(name, "PL_REAL") == 0))
		return true;                    /* a type of real.h here, the one of all */
	if (words != 2 || strncmp(name, "pl_", 3) != 0 || strncmp(other, "pl_", 3) != 0)
		return false;
	ENLARGE(r->from, (size_t)r->aliases + 1);
	ENLARGE(r->to, (size_t)r->aliases + 1);
	r->from[r->aliases] = format("%s", name);
	r->to[r->aliases++] = format("%s", other);
	return true;
}

/* With the algorithms in it that a file includes, as a model's does */
static const char *full_text(const char *name)
{
	char *full = NULL;
	size_t size;
	FILE *to = need_memory(open_memstream(&full, &size));
	print_included(to, runtime_text(name), "");
	fclose(to);
	const char *kept = format("%s", (char *)need_memory(full));
	free(full);
	return kept;
}

static void read_lines(struct reader *f, const char *rest)
{
	while (*rest) {
		const char *line = format("%.*s", (int)strcspn(rest, "\n"), rest);
		rest += strlen(line) + 1;
		if (*line == '#' && !*f->text && take_condition(f, line))
			continue;
		if (f->left_out || (*line == '#' && !*f->text && take_directive(f, line)))
			continue;
		take_line(f, line, rest);
	}
}

static void read_file(struct runtime *r, const char *name)
{
	struct reader f = { .runtime = r, .file = without_ending(name), .comment = "", .text = "" };
	for (int i = 0; i < r->pieces; i++)
		if (strcmp(r->piece[i].file, f.file) == 0)
			return;
	const char *rest = strstr(runtime_text(name), "#define PL(") ? full_text(name) : runtime_text(name);
	read_lines(&f, without_hooks(r, rest));
}

/* ---- all of it ---- */

/* Files of one type: envelopef.c beside envelope.c is of floats, guards_compensated.c beside guards.c of states in two
 * words, guards_d.c of states with derivatives. Not those of FMUs: they have a model inside. */
static bool serves(const struct runtime *r, const char *name)
{
	size_t length = strlen(name);
	if (length < 3 || strcmp(name + length - 2, ".c") != 0 || strncmp(name, "fmi", 3) == 0)
		return false;
	int stem = (int)length - 2;
	bool single = name[stem - 1] == 'f' && runtime_text(format("%.*s.c", stem - 1, name));
	stem -= single;
	static const char *const variants[] = { "_compensated", "_d", "_compensated_d" };   /* the last that fits */
	const char *own = NULL;
	bool other = false;
	for (size_t i = 0; i < sizeof variants / sizeof *variants; i++) {
		const int behind = (int)strlen(variants[i]);
		if (stem > behind && strncmp(name + stem - behind, variants[i], (size_t)behind) == 0)
			own = variants[i];
		other = other || (is_variant(r, variants[i]) &&
				  runtime_text(format("%.*s%s.c", stem, name, variants[i])));
	}
	return single == r->single && (own ? is_variant(r, own) : !other);
}

struct runtime *runtime_read(bool single, const char *variant)
{
	struct runtime *r = NEW(struct runtime);
	r->single = single;
	r->variant = variant;
	read_file(r, "plrt.h");
	r->floats = r->aliases;
	for (int i = 0; runtime_name(i); i++)
		if (serves(r, runtime_name(i)))
			read_file(r, runtime_name(i));
	return r;
}
