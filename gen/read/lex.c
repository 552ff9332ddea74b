/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Text to tokens. A lexer reads one statement, whose extent lex_statement_end finds first: so an error inside a
 * statement never hides the statements after it. */
#include "read/read.h"

#include <string.h>

static bool is_digit(char c) { return c >= '0' && c <= '9'; }
static bool is_letter(char c) { return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || c == '_'; }

size_t lex_statement_end(const struct source *source, size_t from, size_t *unclosed)
{
	const char *text = source->text;
	size_t depth = 0, outermost = SIZE_MAX;
	bool comment = false, string = false;
	for (size_t i = from; i < source->length; i++) {
		char c = text[i];
		if (c == '\n') {
			comment = string = false;
			if (depth == 0) {
				*unclosed = SIZE_MAX;
				return i;
			}
		} else if (comment) {
			continue;
		} else if (c == '"') {
			string = !string;
		} else if (string) {
			continue;
		} else if (c == '#') {
			comment = true;
		} else if (strchr("([{", c)) {
			outermost = depth++ == 0 ? i : outermost;
		} else if (strchr(")]}", c) && depth > 0) {
			depth--;
		}
	}
	*unclosed = depth > 0 ? outermost : SIZE_MAX;
	if (depth == 0)
		return source->length;
	const char *line = memchr(text + outermost, '\n', source->length - outermost);
	return line ? (size_t)(line - text) : source->length;
}

static void skip_space(struct lexer *lexer)
{
	const char *text = lexer->source->text;
	while (lexer->position < lexer->end) {
		char c = text[lexer->position];
		if (c == '#')
			while (lexer->position < lexer->end && text[lexer->position] != '\n')
				lexer->position++;
		else if (strchr(" \t\r\n\f\v", c))
			lexer->position++;
		else
			return;
	}
}

/* Everything that could belong to a number is taken, so that 1.2.3 and 2x are reported as what they are. */
static size_t number_extent(const char *text)
{
	size_t length = 0;
	while (is_digit(text[length]) || is_letter(text[length]) || text[length] == '.' ||
	       ((text[length] == '+' || text[length] == '-') && length > 0 && strchr("eE", text[length - 1])))
		length++;
	return length;
}

size_t number_length(const char *s)
{
	size_t i = 0, digits = 0;
	for (; is_digit(s[i]); i++)
		digits++;
	if (s[i] == '.')
		for (i++; is_digit(s[i]); i++)
			digits++;
	if (digits == 0)
		return 0;
	if (s[i] == 'e' || s[i] == 'E') {
		size_t exponent = i + 1 + (s[i + 1] == '+' || s[i + 1] == '-');
		if (is_digit(s[exponent]))
			for (i = exponent; is_digit(s[i]);)
				i++;
	}
	return i;
}

static void check_number(struct token token)
{
	const char *text = token.at.source->text + token.at.offset;
	size_t good = number_length(text);
	if (good == token.length)
		return;
	const char *note = "a number is written 12, 0.5, .5, 1. or 2e-3";
	bool exponent = (text[good] == 'e' || text[good] == 'E') && !is_letter(text[good + 1]);
	bool hexadecimal = text[0] == '0' && (text[good] == 'x' || text[good] == 'X');
	if (good > 0 && is_letter(text[good]) && text[good] != '_' && !exponent && !hexadecimal)
		note = format("multiplication is written with *: %.*s*%.*s", (int)good, text,
			      (int)(token.length - good), text + good);
	if (token.at.offset >= 6 && strncmp(text - 6, "model ", 6) == 0)
		note = "a name begins with a letter";
	const char *unit = good > 0 ? unit_note(text, good, text + good, token.length - good) : NULL;
	if (unit)
		note = format("%s; %s", unit, note);
	error(token.at, note, "malformed number '%.*s'", token.length > 60 ? 60 : (int)token.length, text);
}

static void lex_name(struct token *token, const char *text, bool points)
{
	while (is_letter(text[token->length]) || is_digit(text[token->length]) ||
	       (points && text[token->length] == '.' && is_letter(text[token->length + 1])))
		token->length++;
	token->kind = TOKEN_NAME;
	token->name = format("%.*s", (int)token->length, text);
	while (text[token->length] == '\'') {
		token->length++;
		token->primes++;
	}
	if (token->primes > 2)
		error(token->at, NULL, "'%s' has %d primes; at most two, the acceleration", token->name, token->primes);
}

static void lex_string(struct token *token, const char *text)
{
	const char *end = strpbrk(text + 1, "\"\n");
	if (!end || *end == '\n')
		error(token->at,
		      token->at.offset > 0 && (is_letter(text[-1]) || is_digit(text[-1]))
			      ? "derivatives are written with single quotes: x', x''"
			      : NULL,
		      "string without its closing quote");
	token->kind = TOKEN_STRING;
	token->length = (size_t)(end - text) + 1;
}

/* Omega and omega: U+0391 to U+03C9 in UTF-8, by their names; NULL: it is no Greek letter */
static const char *greek_name(const char *text)
{
	static const char *const names[] = {
		"alpha", "beta", "gamma", "delta", "epsilon", "zeta", "eta", "theta", "iota", "kappa", "lambda", "mu",
		"nu", "xi", "omicron", "pi", "rho", "sigma", "sigma", "tau", "upsilon", "phi", "chi", "psi", "omega"
	};
	const unsigned char *u = (const unsigned char *)text;
	unsigned code = u[0] == 0xce || u[0] == 0xcf ? (u[0] & 0x1fu) << 6 | (u[1] & 0x3fu) : 0, first = 0x391;
	if (code < first || code > 0x3c9 || (code > 0x3a9 && code < 0x3b1) || code == 0x3a2)
		return NULL;
	return code > 0x3a9 ? names[code - 0x3b1]
			    : format("%c%s", names[code - first][0] - 'a' + 'A', names[code - first] + 1);
}

/* A letter that stands in many places is reported at the first of them; comments are not looked into. */
static bool stands_before(const struct token *token, int bytes)
{
	const char *text = token->at.source->text, *at = text + token->at.offset;
	for (const char *c = text; c < at; c++) {
		if (*c == '#')
			c += strcspn(c, "\n");
		else if (strncmp(c, at, (size_t)bytes) == 0)
			return true;
	}
	return false;
}

/* Of x^2' and of (m*x)' */
static const char *prime_note(const char *start, const char *text)
{
	const char *power = text;
	while (power > start && strchr("0123456789", power[-1]))
		power--;
	if (power < text && power > start && power[-1] == '^')
		return "a power of a derivative: x'^2";
	if (text > start && text[-1] == ')')
		return "an expression that is derived is a let: let f = ..., and f'";
	return "a prime follows the name of a coordinate without space: x'";
}

static const char *character_note(const char *start, const char *text)
{
	if (strncmp(text, "\xe2\x80\x99", 3) == 0 || strncmp(text, "\xe2\x80\xb2", 3) == 0 ||
	    strncmp(text, "\xc2\xb4", 2) == 0 || text[0] == '`')
		return "the derivative is written with the plain quote: x'";
	if (strncmp(text, "\xe2\x80\x9d", 3) == 0 || strncmp(text, "\xe2\x80\xb3", 3) == 0)
		return "the second derivative is written with two plain quotes: x''";
	if (strncmp(text, "\xc2\xb2", 2) == 0 || strncmp(text, "\xc2\xb3", 2) == 0)
		return "a power is written with ^: x^2";
	if (strncmp(text, "\xc2\xa0", 2) == 0 || strncmp(text, "\xe2\x80\xaf", 3) == 0)
		return "this is a no-break space; a plain one is needed";
	if (strncmp(text, "\xe2\x88\x92", 3) == 0 || strncmp(text, "\xe2\x80\x93", 3) == 0)
		return "the minus sign is the plain -";
	if (strncmp(text, "\xc2\xb7", 2) == 0 || strncmp(text, "\xc3\x97", 2) == 0)
		return "multiplication is written with *";
	if (text[0] == '\'')
		return prime_note(start, text);
	if (text[0] == '|')
		return text[1] == '|' ? "conditions stand inside each other: x < 0 ? 1 : (x > 2 ? 1 : 0)"
				      : "the size of a value is written abs(x)";
	if (text[0] == '&')
		return "conditions stand inside each other: x > 0 ? (x < 2 ? 1 : 0) : 0";
	if (text[0] == '%' && text > start && strchr("0123456789", text[-1]))
		return "5 % is 0.05";
	if (text[0] == '%')
		return "a comment starts with #";
	if (strncmp(text, "\xcf\x80", 2) == 0)
		return "it is written pi";
	if (greek_name(text))
		return format("names are made of the letters a to z, digits and _: %s", greek_name(text));
	if ((unsigned char)text[0] >= 0x80)
		return "names are made of the letters a to z, digits and _";
	return NULL;
}

static void lex_operator(struct token *token, const char *text, bool needs)
{
	static const char *const operators[] = {
		"==", "!=", "<=", ">=", "+", "-", "*", "/", "^", "(", ")", "[", "]", ",", ";", "=", "<", ">", "?", ":"
	};
	if (needs && (text[0] == '%' || text[0] == '|')) {
		token->kind = TOKEN_OPERATOR;
		token->length = 1;
		token->op[0] = text[0];
		return;
	}
	for (size_t i = 0; i < sizeof operators / sizeof *operators; i++)
		if (strncmp(text, operators[i], strlen(operators[i])) == 0) {
			token->kind = TOKEN_OPERATOR;
			token->length = strlen(operators[i]);
			memcpy(token->op, operators[i], token->length + 1);
			return;
		}
	if (text[0] == '\'' && token->at.offset > 0 && text[-1] == ']') {     /* q[3]' and q[3]'' */
		token->kind = TOKEN_OPERATOR;
		token->length = strspn(text, "'");
		if (token->length > 2)
			error(token->at, NULL, "%zu primes; at most two, the acceleration", token->length);
		memcpy(token->op, text, token->length);
		return;
	}
	int bytes = 1;
	while (((unsigned char)text[bytes] & 0xc0) == 0x80)
		bytes++;
	if ((unsigned char)text[0] < ' ')
		error(token->at, NULL, "unexpected byte 0x%02x", (unsigned char)text[0]);
	if (greek_name(text) && stands_before(token, bytes))
		abandon();
	error(token->at, character_note(token->at.source->text, text), "unexpected character '%.*s'", bytes, text);
}

struct token lex_next(struct lexer *lexer)
{
	struct token token = { .kind = TOKEN_END, .at = { lexer->source, lexer->position } };
	skip_space(lexer);
	if (lexer->position >= lexer->end)
		return token;       /* its place is just after the last token, before any comment */
	token.at.offset = lexer->position;
	const char *text = lexer->source->text + lexer->position;
	if (is_letter(*text)) {
		lex_name(&token, text, lexer->points);
	} else if (is_digit(*text) || (*text == '.' && is_digit(text[1]))) {
		token.kind = TOKEN_NUMBER;
		token.length = number_extent(text);
		check_number(token);
	} else if (*text == '"') {
		lex_string(&token, text);
	} else {
		lex_operator(&token, text, lexer->needs);
	}
	lexer->position += token.length;
	return token;
}

const char *token_text(struct token token)
{
	if (token.kind == TOKEN_END)
		return "the end of the statement";
	int shown = token.length > 60 ? 60 : (int)token.length;
	return format("'%.*s'", shown, token.at.source->text + token.at.offset);
}

void lex_number(struct token token, mpq_ptr value)
{
	const char *text = token.at.source->text + token.at.offset;
	char *digits = ARRAY(char, token.length + 1);
	size_t count = 0, i = 0;
	long exponent = 0;
	bool point = false;
	for (; i < token.length && text[i] != 'e' && text[i] != 'E'; i++) {
		if (text[i] == '.') {
			point = true;
		} else {
			digits[count++] = text[i];
			exponent -= point;
		}
	}
	if (i < token.length) {
		long literal = 0;
		bool negative = text[i + 1] == '-';
		for (i += 1 + (text[i + 1] == '-' || text[i + 1] == '+'); i < token.length; i++) {
			literal = 10 * literal + (text[i] - '0');
			if (literal > LIMIT_EXPONENT)
				error(token.at, NULL, "literal exponent beyond the limit of %d", LIMIT_EXPONENT);
		}
		exponent += negative ? -literal : literal;
	}
	mpz_t power;
	mpz_init(power);
	mpz_ui_pow_ui(power, 10, (unsigned long)(exponent < 0 ? -exponent : exponent));
	mpq_set_ui(value, 0, 1);
	mpz_set_str(mpq_numref(value), digits, 10);
	if (exponent < 0)
		mpz_set(mpq_denref(value), power);
	else
		mpz_mul(mpq_numref(value), mpq_numref(value), power);
	mpq_canonicalize(value);
	check_bits(token.at, value);
}
