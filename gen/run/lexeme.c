/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Generated C to lexemes. Of the preprocessor: macros without arguments, and what stands under a name that is defined
 * or is not; under any other condition is what other compilers than the one at hand get, and it is left out. */
#include "run/run.h"

#include <ctype.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_NESTED = 16 };

struct macro { const char *name; int count; struct lexeme *list; }; /* lexemes that stand for it */
struct lexing {
	struct place at;
	const char *text;
	bool line_start;
	int count, room;
	struct lexeme *list;
	int macros;
	struct macro *macro;
	int nested;
	bool left_out[MOST_NESTED]; /* under each condition that is open */
	/* a macro whose lexemes are read: from which on they stand in the list, to be taken out of it; -1: none */
	int defining;
};

static void push(struct lexing *l, struct lexeme lexeme)
{
	if (l->count == l->room) {
		l->room = 2 * l->room + 1024;
		ENLARGE(l->list, (size_t)l->room);
	}
	l->list[l->count++] = lexeme;
}

static const struct macro *macro_of(const struct lexing *l, const char *name)
{
	for (int i = l->macros; i-- > 0;)
		if (l->macro[i].name[0] == name[0] && strcmp(l->macro[i].name, name) == 0)
			return &l->macro[i];
	return NULL;
}

static char *slice(const char *text, size_t length)
{
	char *copy = ARRAY(char, length + 1);
	memcpy(copy, text, length);
	return copy;
}

static void lex_name(struct lexing *l)
{
	size_t length = name_length(l->text);
	const char *name = slice(l->text, length);
	const struct macro *macro = macro_of(l, name);
	l->text += length;
	if (!macro) {
		push(l, (struct lexeme){ .kind = LEXEME_NAME, .text = name });
		return;
	}
	for (int i = 0; i < macro->count; i++)
		push(l, macro->list[i]);
}

static bool is_real(const char *text, size_t length)
{
	bool hexadecimal = length > 1 && (text[1] == 'x' || text[1] == 'X');
	for (size_t i = 0; i < length; i++)
		if (strchr(hexadecimal ? ".pP" : ".eE", text[i]))
			return true;
	return false;
}

static void read_number(struct lexing *l)
{
	size_t length = 0;
	while (in_name(l->text[length]) || l->text[length] == '.' ||
	       (length > 0 && strchr("+-", l->text[length]) && strchr("eEpP", l->text[length - 1])))
		length++;
	const char *text = slice(l->text, length);
	char *end;
	struct lexeme lexeme = { .kind = LEXEME_NUMBER, .text = text, .real = is_real(text, length) };
	if (lexeme.real) {
		lexeme.x = strtod(text, &end);
		lexeme.single = *end == 'f';
		if (lexeme.single)
			lexeme.x = (double)strtof(text, &end);
	} else {
		lexeme.n = strtoull(text, &end, 0);
		lexeme.positive = strpbrk(end, "uU") != NULL;
		lexeme.wide = strpbrk(end, "lL") != NULL || lexeme.n > (lexeme.positive ? UINT32_MAX : INT32_MAX);
	}
	push(l, lexeme);
	l->text += length;
}

static void lex_string(struct lexing *l)
{
	size_t length = 1;
	while (l->text[length] && l->text[length] != l->text[0])
		length += l->text[length] == '\\' ? 2 : 1;
	push(l, (struct lexeme){ .kind = LEXEME_STRING, .text = slice(l->text + 1, length - 1) });
	l->text += length + 1;
}

static void lex_mark(struct lexing *l)
{
	static const char *const longer[] = { "<<=", ">>=", "->", "++", "--", "<<", ">>", "<=", ">=", "==", "!=", "&&",
					      "||", "+=", "-=", "*=", "/=", "%=", "&=", "|=", "^=" };
	size_t length = 1;
	for (size_t i = 0; i < sizeof longer / sizeof *longer && length == 1; i++)
		if (l->text[0] == longer[i][0] && strncmp(l->text, longer[i], strlen(longer[i])) == 0)
			length = strlen(longer[i]);
	struct lexeme lexeme = { .kind = LEXEME_MARK, .text = slice(l->text, length) };
	for (size_t i = 0; i < length; i++)
		lexeme.mark |= (unsigned)(unsigned char)l->text[i] << (8 * i);
	push(l, lexeme);
	l->text += length;
}

/* ---- the preprocessor ---- */

static bool is_left_out(const struct lexing *l)
{
	for (int i = 0; i < l->nested; i++)
		if (l->left_out[i])
			return true;
	return false;
}

static const char *word_at(const char *text)
{
	text += strspn(text, " \t");
	size_t length = 0;
	while (in_name(text[length]))
		length++;
	return slice(text, length);
}

static void open_condition(struct lexing *l, bool left_out)
{
	if (l->nested == MOST_NESTED)
		error(l->at, NULL, "internal error: generated C has conditions too deep inside each other");
	l->left_out[l->nested++] = left_out;
}

static void begin_macro(struct lexing *l, const char *after)
{
	const char *name = word_at(after);
	const char *rest = after + strspn(after, " \t") + strlen(name);
	if (*rest == '(')
		return;                                         /* what uses it cannot be run */
	ENLARGE(l->macro, (size_t)l->macros + 1);
	l->macro[l->macros++] = (struct macro){ name, 0, NULL };
	l->defining = l->count;
	l->text = rest;
}

/* The rest of a line that continues where it ends with a backslash */
static const char *line_end(const char *text)
{
	const char *end = text + strcspn(text, "\n");
	while (*end && end > text && end[-1] == '\\')
		end += 1 + strcspn(end + 1, "\n");
	return end;
}

static void directive(struct lexing *l)
{
	const char *word = word_at(l->text + 1), *line = l->text;
	const char *after = l->text + 1 + strspn(l->text + 1, " \t") + strlen(word);
	l->text = line_end(line);
	if (strcmp(word, "ifdef") == 0 || strcmp(word, "ifndef") == 0)
		open_condition(l, (macro_of(l, word_at(after)) != NULL) != (word[2] == 'd'));
	else if (strcmp(word, "if") == 0)
		open_condition(l, true);
	else if (strcmp(word, "else") == 0 && l->nested > 0)
		l->left_out[l->nested - 1] = !l->left_out[l->nested - 1];
	else if (strcmp(word, "endif") == 0 && l->nested > 0)
		l->nested--;
	else if (strcmp(word, "define") == 0 && !is_left_out(l))
		begin_macro(l, after);
}

static void end_macro(struct lexing *l)
{
	struct macro *m = &l->macro[l->macros - 1];
	m->count = l->count - l->defining;
	m->list = ARRAY(struct lexeme, (size_t)m->count + 1);
	for (int i = 0; i < m->count; i++)
		m->list[i] = l->list[l->defining + i];
	l->count = l->defining;
	l->defining = -1;
}

/* ---- the whole ---- */

static void lex_next_one(struct lexing *l)
{
	char c = *l->text;
	if (is_left_out(l))
		l->text += strcspn(l->text, "\n");
	else if (in_name(c) && !isdigit((unsigned char)c))
		lex_name(l);
	else if (isdigit((unsigned char)c) || (c == '.' && isdigit((unsigned char)l->text[1])))
		read_number(l);
	else if (c == '"' || c == '\'')
		lex_string(l);
	else
		lex_mark(l);
}

struct lexemes lexemes_of(struct place at, const char *text)
{
	struct lexing l = { .at = at, .text = text, .line_start = true, .defining = -1 };
	while (*l.text) {
		if (*l.text == '\n') {
			if (l.defining >= 0)
				end_macro(&l);
			l.line_start = true;
			l.text++;
		} else if (isspace((unsigned char)*l.text)) {
			l.text++;
		} else if (strncmp(l.text, "/*", 2) == 0) {
			const char *end = strstr(l.text + 2, "*/");
			l.text = end ? end + 2 : l.text + strlen(l.text);
		} else if (*l.text == '#' && l.line_start) {
			directive(&l);
		} else {
			l.line_start = false;
			lex_next_one(&l);
		}
	}
	push(&l, (struct lexeme){ .kind = LEXEME_END, .text = "the end" });
	return (struct lexemes){ l.count, l.list };
}
