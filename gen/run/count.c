/* SPDX-License-Identifier: GPL-3.0-or-later */
/* C that counts what it does: where a sum or a product stands in a function of a model's C, what is behind its sign is
 * evaluated after a count: a * b as a * (PL_MULTIPLIES(a * b), b), which keeps every bit and counts no branch that is
 * not taken. What is whole costs nothing: counts.h asks the compiler. The C is as emitters and the runtime's headers
 * write it: a sign between two operands has blanks on both sides, no other has. */
#include "run/run.h"

#include <ctype.h>
#include <string.h>

struct piece { const char *at, *end; };         /* of the text; end NULL: there is none */

static bool is_blank(const char *at)
{
	return isspace((unsigned char)*at);
}

static void copy(FILE *to, const char *at, const char *end)
{
	put(to, at, (size_t)(end - at));
}

/* Behind blanks and comments */
static const char *behind_blanks(const char *at)
{
	while (is_blank(at) || strncmp(at, "/*", 2) == 0)
		at = is_blank(at) ? at + 1 : behind_quoted(at, false);
	return at;
}

/* Behind the bracket that closes the one here */
static const char *behind_bracket(const char *at)
{
	int depth = 0;
	do {
		const char *quoted = behind_quoted(at, false);
		depth += quoted ? 0 : strchr("([{", *at) ? 1 : strchr(")]}", *at) ? -1 : 0;
		at = quoted ? quoted : at + 1;
	} while (depth > 0 && *at);
	return at;
}

/* A minus, a star, ... before an operand: -x, *p, &x, !x */
static bool is_prefix(const char *at)
{
	return *at && strchr("-+*&!~", *at) && !is_blank(at + 1) && at[1] != '=';
}

/* Of an operand that is longer: at its [i], (x), .name, ->name, ++, --; NULL: it is whole. Macros leave blanks before
 * some of them. */
static const char *continued(const char *at)
{
	const char *next = at + strspn(at, " ");
	if (*next == '[' || (*next == '.' && in_name(next[1])) || strncmp(next, "->", 2) == 0)
		return next;
	return *at == '(' || strncmp(at, "++", 2) == 0 || strncmp(at, "--", 2) == 0 ? at : NULL;
}

/* Behind the operand that begins here, with a cast before it and all that it is called with */
static const char *behind_operand(const char *at)
{
	while (is_prefix(at))
		at++;
	const bool bracket = *at == '(';
	at = bracket ? behind_bracket(at) : isdigit((unsigned char)*at) ? behind_number(at) : at + name_length(at);
	if (bracket && (in_name(*at) || *at == '(' || is_prefix(at)))
		return behind_operand(at);              /* it was a cast */
	for (const char *next; (next = continued(at)) != NULL;) {
		at = *next == '(' || *next == '[' ? behind_bracket(next) : next + (*next == '.' ? 1 : 2);
		at += name_length(at);
	}
	return at;
}

/* The length of the sign of a sum or a product between two operands, or of an assignment of one; 0: none is here */
static size_t sign_length(const char *at, const char *text)
{
	if (!*at || !strchr("+-*/", *at) || at == text || !is_blank(at - 1))
		return 0;
	return is_blank(at + 1) ? 1 : at[1] == '=' && is_blank(at + 2) ? 2 : 0;
}

/* What is assigned by += and the like: up to the end of the expression */
static const char *behind_assigned(const char *at, const char *end)
{
	while (at < end && *at != ';' && *at != ',')
		at = strchr("([", *at) ? behind_bracket(at) : at + 1;
	return at;
}

static void print_counted(FILE *to, const char *at, const char *end);

/* From a bracket to the one that closes it */
static void print_within(FILE *to, const char *at, const char *end)
{
	put(to, at, 1);
	print_counted(to, at + 1, end - 1);
	put(to, end - 1, 1);
}

/* An operand as it is, but for what stands in its round brackets */
static void print_operand(FILE *to, const char *at, const char *end)
{
	for (const char *next; at < end; at = next) {
		next = *at == '[' || *at == '(' ? behind_bracket(at) : at + strcspn(at, "[(");
		next = next < end ? next : end;
		if (*at == '(')
			print_within(to, at, next);
		else
			copy(to, at, next);
	}
}

/* From the sign on; what is behind it is returned */
static struct piece print_sign(FILE *to, struct piece left, const char *at, size_t length, const char *end)
{
	struct piece right = { .at = behind_blanks(at + length) };
	right.end = length == 1 ? behind_operand(right.at) : behind_assigned(right.at, end);
	copy(to, at, right.at);
	fprintf(to, "(%s(", strchr("*/", *at) ? "PL_MULTIPLIES" : "PL_ADDS");
	copy(to, left.end ? left.at : right.at, right.end);
	fputs("), ", to);
	(length == 1 ? print_operand : print_counted)(to, right.at, right.end);
	putc(')', to);
	return right;
}

/* Behind what is to be constant; NULL: it is something else */
static const char *behind_constant(const char *at)
{
	const size_t length = name_length(at);
	return is_named(at, length, "static") || is_named(at, length, "enum") ? behind(at, ';')
	       : is_named(at, length, "case")				       ? behind(at, ':')
									       : NULL;
}

/* Statements, or a part of an expression */
static void print_counted(FILE *to, const char *at, const char *end)
{
	struct piece left = { 0 };
	for (const char *text = at; at < end;) {
		const char *next = behind_quoted(at, at[-1] == '\n');
		const size_t sign = next ? 0 : sign_length(at, text);
		if (sign) {
			left = print_sign(to, left, at, sign, end);
			at = left.end;
			continue;
		}
		const bool operand = !next && (in_name(*at) || *at == '(' || is_prefix(at));
		next = next ? next : operand ? behind_constant(at) : at + 1;
		if (operand && !next) {
			left = (struct piece){ at, behind_operand(at) };
			print_operand(to, at, left.end);
			at = left.end;
			continue;
		}
		if (!is_blank(at))
			left.end = NULL;
		while (next < end && is_blank(at) && is_blank(next) && is_blank(next + 1))
			next++;
		copy(to, at, next);
		at = next;
	}
}

/* What stands outside of functions stays: a function's body is the brace behind a bracket. */
void print_counts(FILE *to, const char *text, const char *name)
{
	(void)name;
	bool bracket = false;
	const char *from = text;
	for (const char *at = text; *at;) {
		const char *next = behind_quoted(at, at == text || at[-1] == '\n');
		if (!next && *at == '{' && bracket) {
			copy(to, from, at);
			from = next = behind_bracket(at);
			print_within(to, at, next);
		} else if (!next && !is_blank(at)) {
			bracket = *at == ')';
		}
		at = next ? next : at + 1;
	}
	copy(to, from, from + strlen(from));
}
