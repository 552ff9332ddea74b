/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The runtime's algorithms in the text of a model, in the place of the lines that include them: for what is bundled,
 * what runs inside the generator, and models whose name an algorithm uses. What a compiler's preprocessor would decide
 * by the model alone is decided here: macros are put in, and of #if what holds is left. */
#include "printed.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NESTED = 24, MOST_PARAMETERS = 4, MOST_DEEP = 32 };

struct macro { const char *name, *body; int parameters; const char *parameter[MOST_PARAMETERS]; }; /* -1: without */
struct condition { bool kept, holds, held; };   /* left to the compiler; its lines count; one before it held */
struct including {
	FILE *to;
	int macros, conditions;
	struct macro *macro;
	struct condition condition[MOST_NESTED];
};

/* ---- macros ---- */

static const char *slice(const char *text, size_t length)
{
	return format("%.*s", (int)length, text);
}

static const struct macro *macro_at(const struct including *in, const char *text, size_t length)
{
	for (int i = in->macros; i-- > 0;)
		if (*in->macro[i].name == *text && is_named(text, length, in->macro[i].name))
			return &in->macro[i];
	return NULL;
}

static const struct macro *macro_of(const struct including *in, const char *name)
{
	return macro_at(in, name, strlen(name));
}

static void undefine(struct including *in, const char *name)
{
	for (int i = 0; i < in->macros; i++)
		if (strcmp(in->macro[i].name, name) == 0)
			in->macro[i--] = in->macro[--in->macros];
}

/* Of "name(a, b) body" */
static void define(struct including *in, const char *text)
{
	struct macro m = { .parameters = -1 };
	size_t length = name_length(text);
	m.name = slice(text, length);
	text += length;
	if (*text == '(') {
		m.parameters = 0;
		for (text++; *text && *text != ')'; text += strspn(text, " ,")) {
			length = name_length(text);
			if (length == 0 || m.parameters == MOST_PARAMETERS)
				return;
			m.parameter[m.parameters++] = slice(text, length);
			text += length;
		}
		text += *text == ')';
	}
	text += strspn(text, " ");
	const char *note = strstr(text, "/*");
	length = note ? (size_t)(note - text) : strlen(text);
	while (length > 0 && isspace((unsigned char)text[length - 1]))
		length--;
	m.body = slice(text, length);
	undefine(in, m.name);
	ENLARGE(in->macro, (size_t)in->macros + 1);
	in->macro[in->macros++] = m;
}

/* Behind the bracket that closes the one at `text`; argument[]: what stands between its commas */
static const char *read_arguments(const char *text, int count, const char **argument)
{
	const char *from = text + 1, *at = from;
	int depth = 0, got = 0;
	for (; *at && !(*at == ')' && depth == 0); at++) {
		depth += (*at == '(') - (*at == ')');
		if (*at == ',' && depth == 0 && got < count - 1) {
			argument[got++] = slice(from, (size_t)(at - from));
			from = at + 1;
			from += strspn(from, " ");
		}
	}
	if (got < count)
		argument[got] = slice(from, (size_t)(at - from));
	return at + (*at == ')');
}

/* The body with the arguments put in, and what stands on both sides of ## as one word */
static const char *with_arguments(const struct macro *m, const char *const *argument)
{
	char *text = NULL;
	size_t size = 0;
	FILE *to = need_memory(open_memstream(&text, &size));
	for (const char *at = m->body, *end; *at; at = end) {
		const char *joint = at + strspn(at, " ");
		const size_t length = name_length(at);
		end = at + (length ? length : 1);
		int place = 0;
		while (place < m->parameters && !(length && is_named(at, length, m->parameter[place])))
			place++;
		if (strncmp(joint, "##", 2) == 0)
			end = joint + 2 + strspn(joint + 2, " ");
		else if (place < m->parameters)
			fputs(argument[place], to);
		else
			put(to, at, (size_t)(end - at));
	}
	fclose(to);
	const char *copy = format("%s", (char *)need_memory(text));
	free(text);
	return copy;
}

static void put_words(const struct including *in, FILE *to, const char *text, int depth);

/* A word of an algorithm, and what stands in brackets behind it where it takes that; returns behind it */
static const char *put_word(const struct including *in, FILE *to, const char *text, int depth)
{
	size_t length = name_length(text);
	const char *end = text + length;
	const struct macro *m = depth == MOST_DEEP ? NULL : macro_at(in, text, length);
	const char *argument[MOST_PARAMETERS] = { "", "", "", "" };
	if (!m || (m->parameters >= 0 && *end != '(')) {
		put(to, text, length);
		return end;
	}
	if (m->parameters >= 0)
		end = read_arguments(end, m->parameters, argument);
	if (strcmp(m->name, "PL_TYPE") == 0)
		fputs(m->body, to);     /* a model may be called `real`, too */
	else
		put_words(in, to, with_arguments(m, argument), depth + 1);
	return end;
}

/* No word begins in it */
static const char *put_digits(FILE *to, const char *text)
{
	const char *end = behind_number(text);
	put(to, text, (size_t)(end - text));
	return end;
}

static void put_words(const struct including *in, FILE *to, const char *text, int depth)
{
	while (*text)
		text = isdigit((unsigned char)*text) ? put_digits(to, text)
		       : in_name(*text)		     ? put_word(in, to, text, depth)
						     : put_other(to, text);
}

/* ---- conditions ---- */

struct query { const struct including *in; const char *at; bool known; };

static long value_of(struct query *v, int level);

static void skip_blanks(struct query *v)
{
	v->at += strspn(v->at, " ");
}

static bool takes(struct query *v, const char *sign)
{
	skip_blanks(v);
	if (strncmp(v->at, sign, strlen(sign)) != 0)
		return false;
	v->at += strlen(sign);
	return true;
}

/* What the generator knows of: names of the model and of the runtime; others are a compiler's. */
static bool is_ours(const char *name)
{
	return strncmp(name, "PL", 2) == 0 || strncmp(name, "REAL_", 5) == 0 ||
		strcmp(name, "STATE_IS_COMPENSATED") == 0;
}

static long value_of_name(struct query *v)
{
	const char *name = slice(v->at, name_length(v->at));
	v->at += strlen(name);
	if (strcmp(name, "defined") == 0) {
		bool bracket = takes(v, "(");
		skip_blanks(v);
		name = slice(v->at, name_length(v->at));
		v->at += strlen(name);
		if (bracket)
			takes(v, ")");
		v->known = v->known && (macro_of(v->in, name) || is_ours(name));
		return macro_of(v->in, name) != NULL;
	}
	const struct macro *m = macro_of(v->in, name);
	v->known = v->known && (m || is_ours(name));
	if (!m || m->parameters >= 0)
		return 0;
	struct query body = { v->in, m->body, v->known };
	long value = value_of(&body, 0);
	v->known = body.known;
	return value;
}

static long unit_of(struct query *v)
{
	char *end;
	if (takes(v, "!"))
		return !unit_of(v);
	if (takes(v, "-"))
		return -unit_of(v);
	if (takes(v, "(")) {
		long value = value_of(v, 0);
		takes(v, ")");
		return value;
	}
	skip_blanks(v);
	if (in_name(*v->at) && !isdigit((unsigned char)*v->at))
		return value_of_name(v);
	long value = strtol(v->at, &end, 0);
	v->known = v->known && end > v->at && *end != '.';
	v->at = end;
	return value;
}

/* Operators of this level and those that bind more closely */
static long value_of(struct query *v, int level)
{
	static const struct { const char *sign; int level; } operators[] = {
		{ "||", 0 }, { "&&", 1 }, { "==", 2 }, { "!=", 2 }, { "<=", 3 }, { ">=", 3 }, { "<", 3 }, { ">", 3 },
		{ "+", 4 }, { "-", 4 }, { "*", 5 }
	};
	enum { OPERATORS = sizeof operators / sizeof *operators, UNIT = 6 };
	if (level == UNIT)
		return unit_of(v);
	long a = value_of(v, level + 1);
	for (int i = 0; i < OPERATORS; i++) {
		if (operators[i].level != level || !takes(v, operators[i].sign))
			continue;
		const long b = value_of(v, level + 1);
		const long result[OPERATORS] = { a || b, a && b, a == b, a != b, a <= b, a >= b, a < b, a > b, a + b,
						 a - b, a * b };
		a = result[i];
		i = -1;
	}
	return a;
}

static bool is_taken(const struct including *in)
{
	for (int i = 0; i < in->conditions; i++)
		if (!in->condition[i].kept && !in->condition[i].holds)
			return false;
	return true;
}

static bool leaves_some(const struct including *in)
{
	bool kept = false;
	for (int i = 0; i < in->conditions; i++)
		kept = kept || in->condition[i].kept;
	return kept;
}

static void open_condition(struct including *in, const char *word, const char *rest)
{
	const char *text = word[2] == 0 ? rest : format("%sdefined %s", word[2] == 'n' ? "!" : "", rest);
	struct query v = { in, text, true };
	bool taken = is_taken(in), holds = value_of(&v, 0) != 0;
	if (in->conditions == MOST_NESTED)
		return;
	in->condition[in->conditions++] = (struct condition){ taken && !v.known, !taken || holds, !taken || holds };
}

/* #elif, #else: whether its lines count now */
static void turn(struct including *in, const char *word, const char *rest)
{
	struct condition *c = &in->condition[in->conditions - 1];
	struct query v = { in, rest, true };
	bool holds = !c->held && (word[2] == 's' || value_of(&v, 0) != 0);
	c->holds = holds;
	c->held = c->held || holds;
}

/* ---- an algorithm's text ---- */

static void include(struct including *in, const char *name);

/* Numbers of its type, and the header of what is bundled, are here already. */
static bool is_there(const char *name)
{
	return strcmp(name, "plrt.h") == 0 || strcmp(name, "real.h") == 0 || strcmp(name, "numbers.h") == 0;
}

static void put_directive(struct including *in, const char *line)
{
	const char *word = slice(line + 1, name_length(line + 1)), *rest = line + 1 + strlen(word);
	bool taken = is_taken(in), keeps = false;
	rest += strspn(rest, " ");
	if (strncmp(word, "if", 2) == 0) {
		open_condition(in, word, rest);
		keeps = in->condition[in->conditions - 1].kept;
	} else if (strcmp(word, "elif") == 0 || strcmp(word, "else") == 0) {
		keeps = in->condition[in->conditions - 1].kept;
		if (!keeps)
			turn(in, word, rest);
	} else if (strcmp(word, "endif") == 0) {
		keeps = in->condition[--in->conditions].kept;
		taken = is_taken(in);
	} else if (taken && strcmp(word, "include") == 0 && *rest == '"') {
		const char *name = slice(rest + 1, strcspn(rest + 1, "\""));
		if (!is_there(name))
			include(in, name);
	} else if (taken && strcmp(word, "define") == 0 && !leaves_some(in)) {
		define(in, rest);
	} else if (taken && strcmp(word, "undef") == 0 && !leaves_some(in)) {
		undefine(in, slice(rest, name_length(rest)));
	} else {
		keeps = true;
	}
	if (keeps && taken)
		fprintf(in->to, "%s\n", line);
}

/* Behind the line that begins there */
static const char *next_line(const char *text)
{
	text += strcspn(text, "\n");
	return text + (*text == '\n');
}

/* To the next line of the preprocessor: brackets of macros may go over several lines */
static const char *put_block(struct including *in, const char *text)
{
	const char *end = text;
	while (*end && *end != '#')
		end = strncmp(end, "/*", 2) == 0 ? next_line(behind_quoted(end, false)) : next_line(end);
	if (is_taken(in))
		put_words(in, in->to, slice(text, (size_t)(end - text)), 0);
	return end;
}

static void include(struct including *in, const char *name)
{
	for (const char *text = runtime_text(name); *text;) {
		if (*text == '#') {
			put_directive(in, slice(text, strcspn(text, "\n")));
			text = next_line(text);
		} else {
			text = put_block(in, text);
		}
	}
}

/* ---- a model's ---- */

static bool begins(const char *line, const char *with)
{
	return strncmp(line, with, strlen(with)) == 0;
}

/* NULL: the line includes no algorithm. Before the model has said what it has (PL), it is its own header, which may be
 * called as one of the runtime's. */
static const char *included_by(const char *line)
{
	static const char include_text[] = "#include \"";
	if (!begins(line, include_text))
		return NULL;
	const char *name = line + strlen(include_text);
	name = slice(name, strcspn(name, "\"\n"));
	return begins(name, "pl") || !runtime_text(name) ? NULL : name;
}

/* What numbers.h says of what the file did not */
static void define_defaults(struct including *in)
{
	static const char before[] = "#ifndef ";
	for (const char *text = runtime_text("numbers.h"); *text; text = next_line(text))
		if (begins(text, before) && !macro_at(in, text + strlen(before), name_length(text + strlen(before)))) {
			const char *line = next_line(text) + strlen("#define ");
			define(in, slice(line, strcspn(line, "\n")));
		}
}

void print_included(FILE *to, const char *text, const char *model)
{
	struct including in = { .to = to };
	(void)model;
	for (const char *end; *text; text = end) {
		const char *name = macro_of(&in, "PL") ? included_by(text) : NULL;
		end = next_line(text);
		if (begins(text, "#define PL(") ||
		    (begins(text, "#define PL_") && !begins(text, "#define PL_FLOAT_ONLY"))) {
			define(&in, slice(text + strlen("#define "), strcspn(text, "\n") - strlen("#define ")));
		} else if (name) {
			define(&in, "real double");     /* what is of float is made of it */
			define_defaults(&in);
			include(&in, name);
		} else {
			put(to, text, (size_t)(end - text));
		}
	}
}

/* ---- names ---- */

static bool uses(const char *text, const char *name)
{
	for (const char *at = strstr(text, name) ? text : ""; *at;) {  /* most models are called otherwise */
		size_t length = name_length(at);
		const char *quoted = behind_quoted(at, false);
		if (length && is_named(at, length, name))
			return true;
		at = quoted ? quoted : at + (length ? length : 1);
	}
	return false;
}

bool algorithms_use(const char *text, const char *name)
{
	bool used = false, reported = false, looked = false;    /* looked: through all of them, which one time does */
	const char *own = NULL;         /* which a compiler would find in the place of the runtime's */
	for (; *text && !used; text = next_line(text)) {
		reported = reported || begins(text, "#define PL(");
		const char *header = included_by(text);
		if (header && !reported)
			own = header;
		header = reported ? header : NULL;
		used = header && own && strcmp(own, header) == 0;
		for (int i = 0; header && !looked && runtime_name(i) && !used; i++)
			used = !begins(runtime_name(i), "pl") && strstr(runtime_name(i), ".h") &&
			       uses(runtime_text(runtime_name(i)), name);
		looked = looked || header;
	}
	return used;
}
