/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Braces around what an if, an else or a loop governs (MISRA C 2012, rule 15.6). Emitters print a body of one statement
 * without them, so that their layouts read well; here, in one place, every body gets them. */
#include "emit/emit.h"

#include <ctype.h>
#include <string.h>

struct braces {
	FILE *to;
	const char *text, *at;  /* printed up to `at` */
};

static void copy(struct braces *b, const char *end)
{
	put(b->to, b->at, (size_t)(end - b->at));
	b->at = end;
}

static bool starts_line(const struct braces *b, const char *at)
{
	return at == b->text || at[-1] == '\n';
}

/* Where the next word or sign is, behind blanks, comments and lines of the preprocessor */
static const char *next_of(const struct braces *b, const char *at)
{
	while (isspace((unsigned char)*at) || strncmp(at, "/*", 2) == 0 || *at == '#') {
		const char *quoted = behind_quoted(at, starts_line(b, at));
		at = quoted ? quoted : at + 1;
	}
	return at;
}

static bool is_keyword(const char *at, const char *word)
{
	return is_named(at, name_length(at), word);
}

/* Behind the brackets that follow */
static const char *behind_brackets(const struct braces *b, const char *at)
{
	int depth = 0;
	at = next_of(b, at);
	do {
		const char *quoted = behind_quoted(at, false);
		depth += quoted ? 0 : *at == '(' ? 1 : *at == ')' ? -1 : 0;
		at = quoted ? quoted : at + 1;
	} while (depth > 0 && *at);
	return at;
}

static void brace_statement(struct braces *b);

/* From a brace to the one that closes it */
static void brace_block(struct braces *b)
{
	copy(b, next_of(b, b->at + 1));
	while (*b->at && *b->at != '}') {
		brace_statement(b);
		copy(b, next_of(b, b->at));
	}
	copy(b, b->at + (*b->at == '}'));
}

/* A new line, as far in as the one that `head` is on, and further by so much */
static void start_line(const struct braces *b, const char *head, int further)
{
	const char *line = head;
	while (!starts_line(b, line))
		line--;
	fprintf(b->to, "\n%*s", (int)strspn(line, " ") + further, "");
}

/* true: it got braces */
static bool brace_body(struct braces *b, const char *head)
{
	const char *body = next_of(b, b->at);
	if (*body == '{') {
		copy(b, body);
		brace_block(b);
		return false;
	}
	fputs(" {", b->to);
	if (!memchr(b->at, '\n', (size_t)(body - b->at))) {
		start_line(b, head, 4);
		b->at = body;
	}
	copy(b, body);
	brace_statement(b);
	const char *note = b->at + strspn(b->at, " ");
	if (strncmp(note, "/*", 2) == 0)
		copy(b, behind_quoted(note, false));
	start_line(b, head, 0);
	fputs("}", b->to);
	return true;
}

static void brace_choice(struct braces *b)
{
	const char *head = b->at;
	copy(b, behind_brackets(b, b->at + strlen("if")));
	bool braced = brace_body(b, head);
	const char *other = next_of(b, b->at);
	if (!is_keyword(other, "else"))
		return;
	if (braced && strspn(b->at, " \n") == (size_t)(other - b->at)) {
		fputs(" ", b->to);
		b->at = other;
	}
	copy(b, other + strlen("else"));
	const char *next = next_of(b, b->at);
	if (!is_keyword(next, "if")) {
		brace_body(b, head);
		return;
	}
	copy(b, next);
	brace_choice(b);
}

static void brace_statement(struct braces *b)
{
	const char *head = b->at;
	if (*head == '{') {
		brace_block(b);
	} else if (is_keyword(head, "if")) {
		brace_choice(b);
	} else if (is_keyword(head, "for") || is_keyword(head, "while") || is_keyword(head, "switch")) {
		copy(b, behind_brackets(b, head + name_length(head)));
		brace_body(b, head);
	} else if (is_keyword(head, "do")) {
		copy(b, head + strlen("do"));
		brace_body(b, head);
		copy(b, behind(b->at, ';'));
	} else if (is_keyword(head, "case") || is_keyword(head, "default")) {
		copy(b, behind(head, ':'));
	} else {
		copy(b, behind(head, ';'));
	}
}

/* What stands outside of functions stays: a function's body is the brace behind a bracket. */
void print_braces(FILE *to, const char *text, const char *name)
{
	(void)name;
	struct braces b = { to, text, text };
	const char *at = text;
	while (*at) {
		const char *end = next_of(&b, at);
		bool function = *end == ')' && *next_of(&b, end + 1) == '{';
		at = *end == '"' ? behind_quoted(end, false) : end + (*end ? 1 : 0);
		if (function) {
			copy(&b, next_of(&b, at));
			brace_block(&b);
			at = b.at;
		}
	}
	copy(&b, at);
}
