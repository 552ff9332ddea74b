/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tokens that are taken or expected, and names that are found, or what may be meant by them. */
#include "read/parser.h"

#include <string.h>

/* ---- tokens ---- */

struct token take(struct parser *p)
{
	struct token token = p->token;
	p->end = token.at;
	p->end.offset += token.length;
	p->token = lex_next(&p->lexer);
	return token;
}

bool is_op(const struct parser *p, const char *op)
{
	return p->token.kind == TOKEN_OPERATOR && strcmp(p->token.op, op) == 0;
}

bool take_op(struct parser *p, const char *op)
{
	if (!is_op(p, op))
		return false;
	take(p);
	return true;
}

/* 1,5 */
static bool decimal_comma(const struct parser *p)
{
	const char *text = p->lexer.source->text + p->token.at.offset;
	size_t before = p->token.at.offset;
	bool number =
		p->token.kind == TOKEN_NUMBER && before > 1 && text[-1] == ',' && text[-2] >= '0' && text[-2] <= '9';
	return number ||
	       (is_op(p, ",") && before > 0 && text[-1] >= '0' && text[-1] <= '9' && text[1] >= '0' && text[1] <= '9');
}

/* A name before a single =: the next definition of a list, its comma forgotten. */
static bool starts_definition(const struct parser *p)
{
	const char *text = p->lexer.source->text + p->token.at.offset + p->token.length;
	text += strspn(text, " \t");
	return p->token.kind == TOKEN_NAME && text[0] == '=' && text[1] != '=';
}

/* A word between the parts of an element of a network. */
static bool is_place(struct token token)
{
	static const char *const word[] = { "at", "between", "on", "ground" };
	return place_among(4, word, token.name, strlen(token.name)) >= 0;
}

/* What usually stands behind a token that fits nowhere. */
static const char *stray_note(const struct parser *p)
{
	bool after_operand = p->operand_end > 0 && p->operand_end == p->end.offset;
	bool word = after_operand && p->token.kind == TOKEN_NAME && !find_symbol(p, p->token.name);
	const char *form = statement_form(p);
	const char *unit = word ? stray_unit_note(p) : NULL;
	if (p->token.kind == TOKEN_STRING && form && strncmp(form, "input", 5) == 0)
		return "a unit stands behind the name: input u \"N\" hold first";
	if (p->token.kind == TOKEN_STRING && p->lexer.source->text[p->end.offset - 1] == ']')
		return "a unit stands behind each number: [9 \"N\", 20 \"N\"]";
	if (p->token.kind == TOKEN_STRING && after_operand)
		return "a unit stands behind a whole value, at its end or in a bracket: (9.81 \"m/s^2\")";
	if (decimal_comma(p))
		return "the decimal mark is the point: 1.5";
	if (p->goes_on && p->goes_on(p))
		return "a statement ends at the end of its line, unless a bracket is open there";
	if (memchr(p->lexer.source->text + p->end.offset, '\r', p->token.at.offset - p->end.offset))
		return "lines end with a line feed: this one ends with a carriage return alone";
	if (opens_comment(p))
		return "a comment starts with #";
	if (unit)
		return unit;
	if (is_op(p, ";") && p->nesting == 0)
		return "each statement has its own line; the parts of one are separated by commas";
	if (starts_definition(p))
		return "definitions are separated by commas";
	if (word && form)
		return form;
	if (after_operand &&
	    ((p->token.kind == TOKEN_NAME && !is_place(p->token)) || p->token.kind == TOKEN_NUMBER || is_op(p, "(")))
		return "multiplication is written with *";
	if (is_op(p, "=="))
		return "an equation has a single =";
	return form;
}

_Noreturn void unexpected(const struct parser *p, const char *expected)
{
	error(p->token.at, stray_note(p), "expected %s, found %s", expected, token_text(p->token));
}

void expect_op(struct parser *p, const char *op, const char *expected)
{
	if (!take_op(p, op))
		unexpected(p, expected);
}

void expect_end(struct parser *p)
{
	if (p->token.kind != TOKEN_END)
		unexpected(p, "the end of the statement");
}

void nest(struct parser *p, struct place at)
{
	if (++p->nesting > LIMIT_NESTING)
		error(at, NULL, "nesting over the limit of %d", LIMIT_NESTING);
}

/* ---- names ---- */

struct symbol *spec_find(const struct spec *spec, const char *name)
{
	for (struct symbol *s = spec->bucket[name_hash(name) % BUCKETS]; s; s = s->next_alike)
		if (strcmp(s->name, name) == 0)
			return s;
	return NULL;
}

struct symbol *find_symbol(const struct parser *p, const char *name)
{
	return spec_find(p->spec, p->part ? format("%s.%s", p->part->name, name) : name);
}

/* Behind all others: of equal names the first is found. */
void add_symbol(struct spec *spec, struct symbol *symbol)
{
	symbol->number = ++spec->count.symbols;
	*spec->last = symbol;
	spec->last = &symbol->next;
	struct symbol **link = &spec->bucket[name_hash(symbol->name) % BUCKETS];
	while (*link)
		link = &(*link)->next_alike;
	*link = symbol;
}

static bool begins(const char *line, const char *word)
{
	size_t length = strlen(word);
	return strncmp(line, word, length) == 0 && (line[length] == ' ' || line[length] == '\t');
}

const char *symbol_kind(const struct symbol *symbol)
{
	static const char *const text[] = { "param", "coordinate", "let", "output", "input", "matrix",
					    "constraint", "output", "part" };
	return text[symbol->kind];
}

/* Whether the rest of this statement or a later one declares it: then the order is what is wrong. */
static bool declared_later(const struct parser *p, const char *name)
{
	size_t length = strlen(name);
	const char *rest = p->lexer.source->text + p->lexer.position;
	for (const char *line = p->lexer.source->text + p->statement; line;
	     line = strchr(line, '\n'), line = line ? line + 1 : NULL) {
		line += strspn(line, " \t");
		bool coord = begins(line, "coord") || begins(line, "input");
		if (!coord && !begins(line, "param") && !begins(line, "let") && !begins(line, "matrix"))
			continue;
		for (const char *at = line + 3; *at && !strchr("\n#", *at); at++) {
			if (*at == '"')         /* a unit, a file */
				at += 1 + strcspn(at + 1, "\"\n");
			size_t word = strspn(at, WORD);
			const char *after = at + word + strspn(at + word, " \t");
			if (word == length && at >= rest && strncmp(at, name, word) == 0 &&
			    (coord || (after[0] == '=' && after[1] != '=')))
				return true;
			at += word > 0 ? word - 1 : 0;
		}
	}
	return false;
}

_Noreturn void peak_inside(struct place at)
{
	error(at, "it is the largest |EXPR| so far, and no part of an expression",
	      "peak stands alone: output NAME = peak(EXPR)");
}

/* Then what is wrong was reported. */
static bool is_of_broken_part(const struct parser *p, const char *name)
{
	for (const char *point = name; (point = strchr(point, '.')); point++) {
		const struct symbol *part = find_symbol(p, format("%.*s", (int)(point - name), name));
		if (part && part->kind == SYMBOL_PART && part->broken)
			return true;
	}
	return false;
}

/* A note on front.body where no part is named front; or NULL */
static const char *part_note(const struct parser *p, const char *name)
{
	const char *point = strchr(name, '.');
	if (!point)
		return NULL;
	const char *first = format("%.*s", (int)(point - name), name);
	const struct symbol *symbol = find_symbol(p, first);
	if (!symbol)
		return format("no part is named '%s': use \"FILE.spec\" as %s", first, first);
	return symbol->kind == SYMBOL_PART ? NULL : format("%s '%s' is no part", symbol_kind(symbol), first);
}

/* Whether no line declares a coordinate, and the name has a prime somewhere: it is meant for one */
static bool lacks_coordinates(const struct parser *p, struct token name)
{
	const char *text = p->lexer.source->text;
	if (p->spec->count.coords > 0 || p->part)
		return false;
	for (const char *line = text; line; line = strchr(line, '\n'), line = line ? line + 1 : NULL)
		if (begins(line + strspn(line, " \t"), "coord"))
			return false;
	for (const char *at = text; (at = strstr(at, name.name)) != NULL; at++) {
		size_t length = strspn(at, WORD);
		if (length == strlen(name.name) && at[length] == '\'' && (at == text || !strchr(WORD, at[-1])))
			return true;
	}
	return false;
}

/* Reported once, at the first of them */
static _Noreturn void missing_coordinates(struct parser *p, struct token name)
{
	if (p->spec->lacks_coords)
		abandon();
	p->spec->lacks_coords = true;
	error(name.at, format("coord %s", name.name),
	      "unknown name '%s', and there is no statement 'coord', which declares the coordinates", name.name);
}

static bool names_coordinate(const struct parser *p, const char *name)
{
	const struct symbol *symbol = find_symbol(p, name);
	return symbol && symbol->kind == SYMBOL_COORD;
}

/* kx of k and x; or NULL */
static const char *product_note(const struct parser *p, const char *name)
{
	for (size_t i = 1; i < strlen(name); i++)
		if (find_symbol(p, format("%.*s", (int)i, name)) && find_symbol(p, name + i) &&
		    strncmp(name, name + i, i) != 0)
			return format("multiplication is written with *: %.*s*%s", (int)i, name, name + i);
	return NULL;
}

/* Is the unknown name in a line of a spec that begins as no statement does: with it, a known name, a number, a sign? */
static bool is_in_equation(const struct parser *p, struct token token)
{
	const char *text = p->lexer.source->text + p->statement;
	const size_t word = strspn(text, WORD);
	return p->goes_on && (token.at.offset == p->statement || word == 0 ||
			      find_symbol(p, format("%.*s", (int)word, text)));
}

_Noreturn void unknown_name(struct parser *p, struct token token)
{
	if (declared_later(p, token.name))
		error(token.at, "names are declared before use; this one is declared further down", "unknown name '%s'",
		      token.name);
	if (strcmp(token.name, "peak") == 0 && token.primes == 0 && is_op(p, "("))
		peak_inside(token.at);
	/* by itself a part was without error: this one follows from another */
	if (is_of_broken_part(p, token.name) || (p->part && diagnostics_errors()))
		abandon();
	if (is_op(p, "(") && function_of(token.name) != FN_NONE)
		error(token.at, "an output that is an expression has a name: output NAME = ...",
		      "'%s' is a function, and names stand here", token.name);
	const char *note = part_note(p, token.name), *habit = habit_note(p, token, names_coordinate);
	if (!note && !habit && lacks_coordinates(p, token))
		missing_coordinates(p, token);
	note = note ? note : habit ? habit : product_note(p, token.name);
	note = note ? note : spec_suggestion(p->spec, token.name);
	if (!note && is_in_equation(p, token) && token.primes == 0 && !is_op(p, "("))
		note = format("a constant is a param: param %s = 1", token.name);
	error(token.at, note, "unknown name '%s'", token.name);
}

struct list_line {
	struct parser parser;
	void (*read)(struct parser *p);
};

static void read_list(void *context)
{
	struct list_line *line = context;
	line->parser.token = lex_next(&line->parser.lexer);
	line->parser.end = line->parser.token.at;
	line->read(&line->parser);
}

bool parse_list(struct spec *spec, const struct source *source, void (*read)(struct parser *p))
{
	struct lexer lexer = { source, 0, source->length, true, false };
	return statement_guard(read_list, &(struct list_line){ { .spec = spec, .own = spec, .lexer = lexer }, read });
}
