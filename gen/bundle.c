/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model with the runtime inside: of the runtime's pieces those that it uses. What the header needs stands in it, each
 * type under a guard of its own, so that headers of several bundles go together; the functions are static in the C, and
 * what has no name of the runtime's gets one, so that they meet no name of a model. */
#define _GNU_SOURCE     /* strchrnul, open_memstream */
#include "command.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

/* ---- names ---- */

/* A name that no other file and no model has: a model's never begins with pl_. */
static const char *own_name(const struct piece *p, const char *name)
{
	bool upper = true;
	for (const char *c = name; *c; c++)
		upper = upper && !islower((unsigned char)*c);
	char *own = format("%s_in_%s_%s", "pl", p->file, name);
	for (char *c = own; upper && *c; c++)
		*c = (char)toupper((unsigned char)*c);
	return own;
}

static int by_name(const void *a, const void *b)
{
	const struct owner *one = a, *other = b;
	int order = strcmp(one->name, other->name);
	return order ? order : one->piece - other->piece;
}

static void list_owners(struct runtime *r)
{
	r->owners = 0;
	for (int i = 0; i < r->pieces; i++)
		for (int k = 0; k < r->piece[i].names; k++)
			*MORE(r->owner, r->owners) = (struct owner){ r->piece[i].name[k], i };
	qsort(r->owner, (size_t)r->owners, sizeof *r->owner, by_name);
}

/* The piece number `place` of those that have this name; NULL: there are not so many */
static struct piece *owner_of(const struct runtime *r, const char *word, size_t length, int place)
{
	int low = 0;
	for (int high = r->owners; low < high;) {
		int middle = (low + high) / 2;
		if (strncmp(r->owner[middle].name, word, length) < 0)
			low = middle + 1;
		else
			high = middle;
	}
	low += place;
	return low < r->owners && is_named(word, length, r->owner[low].name) ? &r->piece[r->owner[low].piece] : NULL;
}

/* Does a file include another, itself or through one that it includes? */
static bool includes(const struct runtime *r, const char *file, const char *header)
{
	for (int i = 0; i < r->includes; i++)
		if (strcmp(r->include[i].file, file) == 0 &&
		    (strcmp(r->include[i].header, header) == 0 || includes(r, r->include[i].header, header)))
			return true;
	return false;
}

/* Names of a file are seen in it, those of a header in every file that includes it and has none of its own. */
static bool is_seen(const struct runtime *r, const struct piece *p, const struct piece *from, bool header)
{
	return header ? includes(r, from->file, p->file) : strcmp(p->file, from->file) == 0;
}

/* As the last of these #define says, and then that of what it makes of it */
static const char *other_name(const struct runtime *r, int aliases, const char *name)
{
	for (int i = aliases; i-- > 0;)
		if (strcmp(r->from[i], name) == 0)
			return other_name(r, aliases, r->to[i]);
	return name;
}

static const char *new_name(const struct runtime *r, const struct piece *from, const char *word, size_t length)
{
	const char *name = other_name(r, from->typed ? r->floats : r->aliases, format("%.*s", (int)length, word));
	if (strcmp(name, "PL_REAL") == 0)
		return r->single ? "float" : "double";
	if (strncmp(name, "pl_", 3) == 0 || strncmp(name, "PL_", 3) == 0)
		return name;
	const struct piece *p;
	for (int header = 0; header < 2; header++)
		for (int i = 0; (p = owner_of(r, word, length, i)); i++)
			if (!p->shared && is_seen(r, p, from, header))
				return own_name(p, name);
	return name;
}

static const char *renamed(const struct runtime *r, const struct piece *p)
{
	char *text = NULL;
	size_t size, length;
	FILE *to = open_memstream(&text, &size);
	const char *at = p->text, *done = p->text, *word;
	need_memory(to);
	while ((word = next_word(&at, &length))) {
		fprintf(to, "%.*s", (int)(word - done), done);
		fputs(is_member(word, p->text) ? format("%.*s", (int)length, word) : new_name(r, p, word, length), to);
		done = at;
	}
	fputs(done, to);
	fclose(to);
	const char *kept = format("%s", (char *)need_memory(text));
	free(text);
	return kept;
}

static void rename_all(struct runtime *r)
{
	const char **text = ARRAY(const char *, r->pieces);
	const char ***name = ARRAY(const char **, r->pieces);
	for (int i = 0; i < r->pieces; i++) {
		const struct piece *p = &r->piece[i];
		if (p->shared && !p->typed)
			continue;
		text[i] = renamed(r, p);
		name[i] = ARRAY(const char *, p->names + 1);
		for (int k = 0; k < p->names; k++)
			name[i][k] = new_name(r, p, p->name[k], strlen(p->name[k]));
	}
	for (int i = 0; i < r->pieces; i++)
		if (text[i]) {
			r->piece[i].text = text[i];
			r->piece[i].name = name[i];
		}
}

/* ---- what is used ---- */

enum side { IN_CODE, IN_HEADER };

static void use_words(struct runtime *r, const char *text, enum side side);

static void use(struct runtime *r, struct piece *p, enum side side)
{
	bool *used = side == IN_HEADER ? &p->in_header : &p->in_code;
	if (*used || (side == IN_HEADER && (!p->shared || p->function)))
		return;
	*used = true;
	use_words(r, p->text, side);
}

static void use_words(struct runtime *r, const char *text, enum side side)
{
	const char *word;
	size_t length;
	while ((word = next_word(&text, &length))) {
		struct piece *p;
		for (int i = 0; (p = owner_of(r, word, length, i)); i++)
			use(r, p, side);
	}
}

/* Pieces that declare nothing check the arithmetic: those of plrt.h always, those of a file that is used */
static void use_checks(struct runtime *r)
{
	for (bool more = true; more;) {
		more = false;
		for (int i = 0; i < r->pieces; i++) {
			struct piece *p = &r->piece[i];
			bool needed = p->shared;
			for (int k = 0; k < r->pieces && !needed; k++)
				needed = r->piece[k].in_code && strcmp(r->piece[k].file, p->file) == 0;
			if (p->names > 0 || p->in_code || !needed)
				continue;
			use(r, p, IN_CODE);
			more = true;
		}
	}
}

/* ---- printing ---- */

static const char guards[] = "PL_HAS";

/* FNV-1a of what the bundles' types are taken from: headers of one program have them from one plrt.h. */
static unsigned long long mark(void)
{
	unsigned long long hash = 0xcbf29ce484222325;
	static const char *const file[] = { "plrt.h", "plreal.h", "events.h" };
	for (int i = 0; i < 3; i++)
		for (const char *c = runtime_text(file[i]); *c; c++)
			hash = (hash ^ (unsigned char)*c) * 0x100000001b3;
	return hash & 0xfffffffffffffff;
}

static void print_types(FILE *to, const struct runtime *r)
{
	fprintf(to, "#include <stddef.h>\n#include <stdint.h>\n\n"
		"/* ---- of the runtime, plrt.h: types that this header needs ---- */\n\n"
		"#if defined PL_BUNDLED && PL_BUNDLED != 0x%015llx\n"
		"#error \"headers of bundles by plgen of different versions do not go together\"\n#endif\n"
		"#ifndef PLRT_H\n#ifndef PL_BUNDLED\n#define PL_BUNDLED 0x%015llx\n#endif\n", mark(), mark());
	for (int i = 0; i < r->pieces; i++) {
		const struct piece *p = &r->piece[i];
		if (p->in_header)
			fprintf(to, "\n#ifndef %s_%s\n#define %s_%s\n%s%s#endif\n", guards, p->name[0], guards,
				p->name[0], p->comment, p->text);
	}
	fprintf(to, "#endif /* PLRT_H */\n");
}

/* Before the model's own header, so that no local of the runtime hides a name of the model */
static void print_runtime(FILE *to, const struct runtime *r)
{
	const char *file = "";
	fprintf(to, "#include <float.h>\n#include <stddef.h>\n#include <stdint.h>\n\n"
		"#ifdef __cplusplus\nextern \"C\" {\n#endif\n");
	for (int i = 0; i < r->pieces; i++) {
		const struct piece *p = &r->piece[i];
		if (!p->in_code)
			continue;
		if (strcmp(p->file, file) != 0)
			fprintf(to, "\n/* ---- of the runtime: %s ---- */\n", p->file);
		file = p->file;
		fprintf(to, "\n%s", p->comment);
		if (p->in_header)
			fprintf(to, "#define %s_%s\n", guards, p->name[0]);
		fprintf(to, "%s%s", p->function && !p->local ? "static " : "", p->text);
	}
	fprintf(to, "\n#ifdef __cplusplus\n}\n#endif\n\n/* ---- the model ---- */\n\n");
}

static bool is_line(const char *line, const char *words)
{
	size_t length = strlen(words);
	return strncmp(line, words, length) == 0 && (line[length] == '\n' || !line[length]);
}

/* The model's text line by line, with what its lines name in their place; `front`: before the first of the
 * preprocessor's */
static void print_with(FILE *to, const struct runtime *r, const char *text, bool header)
{
	bool begun = header;
	for (const char *line = text, *end; *line; line = end) {
		end = strchrnul(line, '\n');
		end += *end == '\n';
		if (*line == '#' && !begun) {
			print_runtime(to, r);
			begun = true;
		}
		if (is_line(line, "#define PL_FLOAT_ONLY"))
			continue;
		if (!is_line(line, "#include \"plrt.h\""))
			fprintf(to, "%.*s", (int)(end - line), line);
		else if (header)
			print_types(to, r);
	}
}

struct bundled { const struct runtime *runtime; bool header; };

static void print_bundled(FILE *to, const char *text, const void *context)
{
	const struct bundled *b = context;
	print_with(to, b->runtime, text, b->header);
}

void bundle(struct file *code, struct file *header, const char *more, bool single, const char *variant)
{
	struct runtime *r = runtime_read(single, variant);
	list_owners(r);
	rename_all(r);
	list_owners(r);
	/* what a program asks of a model */
	if (header) {
		use_words(r, "PL_NOT_FINITE PL_TOO_MANY_STEPS PL_TOO_MANY_EVENTS PL_UNDECIDED", IN_HEADER);
		use_words(r, "PL_PENETRATED PL_SINGULAR_MASS PL_LEFT_RANGE PL_SINGULAR PL_MODEL_VERSION", IN_HEADER);
		use_words(r, header->text, IN_HEADER);
		use_words(r, more ? more : "", IN_HEADER);
	}
	for (int i = 0; i < r->pieces; i++)
		if (r->piece[i].in_header)
			use(r, &r->piece[i], IN_CODE);
	use_words(r, code->text, IN_CODE);
	use_checks(r);
	file_replace(code, print_bundled, &(struct bundled){ r, false });
	if (header)
		file_replace(header, print_bundled, &(struct bundled){ r, true });
}
