/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is written from habit of paper and of other programs, and how it is written here: notes for messages. */
#include "read/parser.h"

#include <string.h>
#include <strings.h>

const char WORD[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";
static const char NUMBER[] = "0123456789.";

/* ---- units ---- */

const char *unit_note(const char *number, size_t digits, const char *unit, size_t length)
{
	if (!is_unit_name(unit, length))
		return NULL;
	if (unit[length] == '/' || unit[length] == '^')
		length += strspn(unit + length, "abcdefghijklmnopqrstuvwxyzACFHJKMNPTVW0123456789/^");
	return format("a unit stands in quotes: %.*s \"%.*s\"", (int)digits, number, (int)length, unit);
}

/* 100 N/m, 1 ms, 30 deg: a unit behind a number */
const char *stray_unit_note(const struct parser *p)
{
	const char *text = p->lexer.source->text, *end = text + p->end.offset, *start = end;
	while (start > text + p->statement &&
	       (strchr(NUMBER, start[-1]) ||
		(start > text + 1 && strchr("+-", start[-1]) && strchr("eE", start[-2])) ||
		(strchr("eE", start[-1]) && strchr("0123456789+-", start[0]))))
		start--;
	if (start == end || !strchr(NUMBER, *start))
		return NULL;
	return unit_note(start, (size_t)(end - start), text + p->token.at.offset, p->token.length);
}

/* ---- names ---- */

static bool is_sign(const struct parser *p, char sign)
{
	return p->token.kind == TOKEN_OPERATOR && p->token.op[0] == sign && p->token.op[1] == 0;
}

/* x1dot, x1_ddot, dx1, ddx1: a coordinate and how often it is derived; or NULL */
static const char *derived_coordinate(const struct parser *p, const char *name, is_coordinate *is, int *primes)
{
	static const struct { const char *before, *after; int primes; } habit[] = {
		{ "", "ddot", 2 }, { "", "_ddot", 2 }, { "", "dotdot", 2 }, { "", "_dot_dot", 2 }, { "", "_dd", 2 },
		{ "", "_tt", 2 }, { "dd", "", 2 }, { "d2", "", 2 }, { "", "dot", 1 }, { "", "_dot", 1 },
		{ "", "Dot", 1 }, { "", "_d", 1 }, { "", "_t", 1 }, { "", "p", 1 }, { "d", "", 1 }, { "D", "", 1 }
	};
	size_t length = strlen(name);
	for (size_t i = 0; i < sizeof habit / sizeof *habit; i++) {
		size_t before = strlen(habit[i].before), after = strlen(habit[i].after);
		if (length <= before + after || strncmp(name, habit[i].before, before) != 0 ||
		    strcmp(name + length - after, habit[i].after) != 0)
			continue;
		*primes = habit[i].primes;
		const char *coord = format("%.*s", (int)(length - before - after), name + before);
		if (is(p, coord))
			return coord;
	}
	return NULL;
}

/* der(x1), ddot(x1), diff(diff(x1)), diff(x1, t, 2): the argument, and how often it is derived; or NULL */
static const char *derived_argument(const struct parser *p, struct token name, is_coordinate *is, int *primes)
{
	static const char *const habit[] = {
		"ddot", "der2", "der", "diff", "d", "dot", "dt", "ddt", "deriv", "derivative", "D", "Dt"
	};
	enum { TWICE = 2 };         /* of these take the second derivative */
	const char *at = name.at.source->text + name.at.offset;
	for (*primes = 0; *primes < 2; ++*primes) {
		size_t word = strspn(at, WORD), i = 0, count = sizeof habit / sizeof *habit;
		while (i < count && (strlen(habit[i]) != word || strncmp(at, habit[i], word) != 0))
			i++;
		if (i == count || at[word] != '(')
			break;
		*primes += i < TWICE;
		at += word + 1;
	}
	const char *coord = format("%.*s", (int)strspn(at, WORD), at);
	if (!*primes || !is(p, coord))
		return NULL;
	if (strncmp(at + strspn(at, WORD), ", t, 2)", 7) == 0)
		*primes = 2;
	return coord;
}

/* The exponent of e^(-t), e^-t: up to the bracket's end, or the word's */
static const char *exponent_text(const char *caret)
{
	const char *from = caret + 1 + strspn(caret + 1, " \t"), *to = from + (*from == '-');
	int depth = 0;
	if (*to != '(')
		return format("%.*s", (int)((size_t)(to - from) + strspn(to, WORD)), from);
	for (; *to && *to != '\n'; to++) {
		depth += *to == '(' ? 1 : *to == ')' ? -1 : 0;
		if (depth == 0)
			break;
	}
	if (*from == '(')
		return format("%.*s", (int)(to - from) - 1, from + 1);
	return format("%.*s", (int)(to - from) + (*to == ')'), from);
}

#define INTEGRAL "an integral is a coordinate of first order: coord z, and the equation z' = x"

/* Words of other programs for what has another name here */
static const char *function_note(const char *name)
{
	static const struct { const char *name, *note; } habit[] = {
		{ "ln", "the natural logarithm is written log(x)" },
		{ "fabs", "the size of a value is written abs(x)" }, { "sign", "the sign is written sgn(x)" },
		{ "signum", "the sign is written sgn(x)" }, { "arctan", "it is written atan(x)" },
		{ "arcsin", "it is written asin(x)" }, { "arccos", "it is written acos(x)" },
		{ "pow", "a power is written with ^: x^2" }, { "sqr", "a power is written with ^: x^2" },
		{ "interp", "a curve through points is written table(x; x0, y0; x1, y1)" },
		{ "interp1", "a curve through points is written table(x; x0, y0; x1, y1)" },
		{ "lookup", "a curve through points is written table(x; x0, y0; x1, y1)" },
		{ "if", "a condition is written t < 1 ? 2 : 3" },
		{ "heaviside", "a step in time is a condition: t < 1 ? 0 : 2" },
		{ "stepfun", "a step in time is a condition: t < 1 ? 0 : 2" },
		{ "integral", INTEGRAL }, { "integrate", INTEGRAL }, { "int", INTEGRAL }, { "integ", INTEGRAL }
	};
	static const char *const records[] = { "csv", "file", "load", "read", "readcsv", "read_csv", "record", "wav" };
	for (size_t i = 0; i < sizeof habit / sizeof *habit; i++)
		if (strcasecmp(name, habit[i].name) == 0)
			return habit[i].note;
	if (place_among(sizeof records / sizeof *records, records, name, strlen(name)) >= 0)
		return "a recorded load is an input, whose samples the steps are given: input u hold first";
	return NULL;
}

const char *habit_note(const struct parser *p, struct token name, is_coordinate *is)
{
	int primes;
	const char *coord = derived_coordinate(p, name.name, is, &primes);
	bool call = is_sign(p, '(');
	if (!coord && call)
		coord = derived_argument(p, name, is, &primes);
	if (coord)
		return format("%s of a coordinate is written with %s: %s%.*s",
			      primes > 1 ? "the second derivative" : "the derivative",
			      primes > 1 ? "two primes" : "a prime", coord, primes, "''");
	if (strcasecmp(name.name, "pi") == 0 && strcmp(name.name, "pi") != 0)
		return "it is written small: pi";
	if (strcasecmp(name.name, "e") == 0)
		return is_sign(p, '^') ? format("the exponential is a function: exp(%s)",
					      exponent_text(p->token.at.source->text + p->token.at.offset))
				     : "the exponential is a function: exp(1) is this number";
	if (strcasecmp(name.name, "time") == 0 || strcmp(name.name, "T") == 0)
		return "time is t";
	if (is_sign(p, '=') && name.at.offset == p->statement)
		return format("a constant is a param: param %s = 1", name.name);
	return call ? function_note(name.name) : NULL;
}

const char *init_note(const struct parser *p, struct token name)
{
	const char *value = strchr(p->lexer.source->text + p->token.at.offset, '=');
	size_t blanks = value ? 1 + strspn(value + 1, " \t") : 0;
	int length = value ? (int)strcspn(value + blanks, " ,#\r\n") : 0;
	return format("init %s%.*s = %.*s", name.name, name.primes, "''", length > 0 ? length : 3,
		      length > 0 ? value + blanks : "...");
}

/* ---- statements ---- */

const char *statement_habit(const char *word)
{
	static const struct { const char *word, *statement; } habit[] = {
		{ "parameter", "param" }, { "parameters", "param" }, { "constant", "param" }, { "constants", "param" },
		{ "const", "param" }, { "real", "param" }, { "double", "param" }, { "float", "param" },
		{ "initial", "init" }, { "initially", "init" }, { "ic", "init" }, { "start", "init" },
		{ "var", "coord" }, { "vars", "coord" }, { "variable", "coord" }, { "variables", "coord" },
		{ "state", "coord" }, { "states", "coord" }, { "coordinate", "coord" }, { "coordinates", "coord" },
		{ "dof", "coord" }, { "dofs", "coord" }, { "unknown", "coord" }, { "unknowns", "coord" },
		{ "timestep", "step" }, { "dt", "step" }, { "system", "model" }, { "name", "model" },
		{ "method", "scheme" }, { "solver", "scheme" }, { "integrator", "scheme" }, { "import", "use" },
		{ "include", "use" }, { "observe", "output" }, { "print", "output" }, { "plot", "output" }
	};
	for (size_t i = 0; i < sizeof habit / sizeof *habit; i++)
		if (strcasecmp(word, habit[i].word) == 0)
			return habit[i].statement;
	return NULL;
}

const char *statement_form(const struct parser *p)
{
	static const struct { const char *word, *form; } habit[] = {
		{ "coord", "coord x, y, q[3]" }, { "step", "step 0.01" },
		{ "input", "input u, or input u hold first; a known load is a let: let f = sin(3*t)" },
		{ "mass", "mass m at x" }, { "force", "force F on x" }, { "spring", "spring k between x, y" },
		{ "damper", "damper c between x, ground" }, { "friction", "friction F between x, ground" },
		{ "stop", "stop between x, ground at 0.1 restitution 0.5" }, { "when", "when x >= 0.1: x' = -0.8*x'" },
		{ "need", "need x within 1e-3 until 10" }
	};
	const char *text = p->lexer.source->text + p->statement;
	size_t length = strspn(text, WORD);
	for (size_t i = 0; i < sizeof habit / sizeof *habit; i++)
		if (length == strlen(habit[i].word) && strncmp(text, habit[i].word, length) == 0)
			return habit[i].form;
	return NULL;
}

/* ---- ends of lines ---- */

bool is_unfinished(const struct parser *p)
{
	const char *text = p->lexer.source->text, *next = text + p->lexer.end;
	size_t end = p->end.offset;
	next += *next == '\n';
	next += strspn(next, " \t");
	return p->token.kind == TOKEN_END && end > p->statement && strchr(",+-*/^=<>?:", text[end - 1]) &&
	       *next && !strchr("\r\n#", *next) && p->lexer.end < p->lexer.source->length;
}

bool opens_comment(const struct parser *p)
{
	const char *text = p->lexer.source->text + p->token.at.offset;
	bool before = p->token.at.offset > 0 && text[-1] == '/';
	return (is_sign(p, '/') && (before || text[1] == '/' || text[1] == '*')) || (is_sign(p, '*') && before);
}
