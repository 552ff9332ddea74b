/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tokens to nodes and declarations. The production stands above each function that reads it; names are resolved as
 * they are read, since they are declared before use. */
#include "read/parser.h"

#include <string.h>

static const char WORD[] = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ_0123456789";

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

/* A word between the parts of an element of a sketch. */
static bool is_place(struct token token)
{
	static const char *const word[] = { "at", "between", "on", "ground" };
	for (int i = 0; i < 4; i++)
		if (strcmp(token.name, word[i]) == 0)
			return true;
	return false;
}

static bool goes_on(const struct parser *p);

/* What usually stands behind a token that fits nowhere. */
static const char *stray_note(const struct parser *p)
{
	bool after_operand = p->operand_end > 0 && p->operand_end == p->end.offset;
	bool word = after_operand && p->token.kind == TOKEN_NAME && !find_symbol(p, p->token.name);
	const char *unit = word ? stray_unit_note(p) : NULL;
	if (decimal_comma(p))
		return "the decimal mark is the point: 1.5";
	if (goes_on(p))
		return "a statement ends at the end of its line, unless a bracket is open there";
	if (opens_comment(p))
		return "a comment starts with #";
	if (unit)
		return unit;
	if (is_op(p, ";") && p->nesting == 0)
		return "each statement has its own line; the parts of one are separated by commas";
	if (starts_definition(p))
		return "definitions are separated by commas";
	if (after_operand &&
	    ((p->token.kind == TOKEN_NAME && !is_place(p->token)) || p->token.kind == TOKEN_NUMBER || is_op(p, "(")))
		return "multiplication is written with *";
	if (is_op(p, "=="))
		return "an equation has a single =";
	return NULL;
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

static void nest(struct parser *p, struct place at)
{
	if (++p->nesting > LIMIT_NESTING)
		error(at, NULL, "nesting over the limit of %d", LIMIT_NESTING);
}

/* ---- names ---- */

enum { BUCKETS = 1 << 14 };

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
static void add_symbol(struct spec *spec, struct symbol *symbol)
{
	symbol->number = ++spec->symbols;
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
	static const char *const text[] = { "param", "coordinate", "let", "output", "input", "matrix", "output",
					    "part" };
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

static _Noreturn void peak_inside(struct place at)
{
	error(at, "it is the largest |EXPR| so far, and no part of an expression",
	      "peak stands alone: output NAME = peak(EXPR)");
}

/* Then it was told what is wrong. */
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
	if (p->spec->coords > 0 || p->part)
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

/* Told once, at the first of them */
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

static _Noreturn void unknown_name(struct parser *p, struct token token)
{
	if (declared_later(p, token.name))
		error(token.at, "names are declared before use; this one is declared further down", "unknown name '%s'",
		      token.name);
	if (strcmp(token.name, "peak") == 0 && token.primes == 0 && is_op(p, "("))
		peak_inside(token.at);
	/* by itself a part was without error: this one follows from another */
	if (is_of_broken_part(p, token.name) || (p->part && diagnostics_errors()))
		abandon();
	const char *note = part_note(p, token.name), *habit = habit_note(p, token, names_coordinate);
	if (!note && !habit && lacks_coordinates(p, token))
		missing_coordinates(p, token);
	error(token.at, note ? note : habit ? habit : spec_suggestion(p->spec, token.name), "unknown name '%s'",
	      token.name);
}

/* component: [ NUMBER ] { ' }; *primes grows by those behind the bracket */
int read_component(struct parser *p, int *primes, bool declared)
{
	if (!is_op(p, "[") || p->token.at.offset != p->end.offset)
		return 0;
	struct place opening = take(p).at;
	if (*primes > 0)
		error(opening, "q[1]' is the velocity of a component", "a component stands before the primes");
	if (p->token.kind != TOKEN_NUMBER)
		unexpected(p, declared ? "the number of components" : "the number of a component");
	mpq_t number;
	mpq_init(number);
	struct token token = take(p);
	lex_number(token, number);
	if (mpz_cmp_ui(mpq_denref(number), 1) != 0 || mpq_sgn(number) <= 0)
		error(token.at, NULL,
		      declared ? "a vector has a whole number of components, at least 1"
			       : "components are numbered from 1");
	if (declared && mpq_cmp_ui(number, LIMIT_STATES, 1) > 0)
		error(token.at, NULL, "more states than the limit of %d", LIMIT_STATES);
	int component =
		mpq_cmp_ui(number, LIMIT_STATES, 1) > 0 ? LIMIT_STATES + 1 : (int)mpz_get_ui(mpq_numref(number));
	mpq_clear(number);
	expect_op(p, "]", "']'");
	if (p->token.kind == TOKEN_OPERATOR && p->token.op[0] == '\'')
		*primes = (int)take(p).length;
	return component;
}

void check_component(const struct symbol *symbol, int component, struct place at)
{
	if (component == 0)
		return;
	if (symbol->kind != SYMBOL_COORD || symbol->length == 0)
		error(at, "only vector coordinates have components", "'%s' is not a vector", symbol->name);
	if (component > symbol->length)
		error(at, NULL, "'%s' has %d components", symbol->name, symbol->length);
}

/* What a name stands for, where that is an expression: an output of a part, the slope of a connected input */
static struct node *read_inlined(struct parser *p, const struct symbol *symbol, struct token token)
{
	if (symbol->kind == SYMBOL_LET)
		return inlined(slope_of(symbol->value, symbol->value->start), token.at, p->end);
	if (token.primes > 0)
		error(token.at, "only coordinates have derivatives", "output '%s' has no derivative", token.name);
	if (symbol->peak)
		error(token.at, format("it is one by itself: output %s", token.name),
		      "a peak is an output, and no part of an expression");
	if (p->no_acceleration && has_acceleration(symbol->value))
		error(token.at, "a let may use coordinates and their first derivatives", "an acceleration in a let");
	return inlined(symbol->value, token.at, p->end);
}

/* name: NAME { ' } | NAME [ NUMBER ] { ' } */
static struct node *resolve_name(struct parser *p, struct token token)
{
	int component = read_component(p, &token.primes, false);
	struct symbol *symbol = find_symbol(p, token.name);
	if (!symbol)
		unknown_name(p, token);
	if (symbol->broken)
		abandon();
	symbol->used = true;
	if (symbol->kind == SYMBOL_PART)
		error(token.at, format("what belongs to it has its name: %s.NAME", token.name),
		      "'%s' is a part, and stands for no value", token.name);
	if (symbol->kind == SYMBOL_PART_OUTPUT || (symbol->connected && token.primes == 1 && symbol->hold))
		return read_inlined(p, symbol, token);
	if (symbol->kind == SYMBOL_OUTPUT)
		error(token.at, "a shorthand for use in expressions is a let",
		      "output '%s' cannot be used in an expression", token.name);
	if (token.primes > 0 && symbol->kind != SYMBOL_COORD && symbol->kind != SYMBOL_INPUT)
		error(token.at, "only coordinates have derivatives", "%s '%s' has no derivative", symbol_kind(symbol),
		      token.name);
	if (token.primes > 0 && symbol->kind == SYMBOL_INPUT && !symbol->hold)
		error(token.at, format("input %s hold first ramps between samples and has one", token.name),
		      "input '%s' is held over a step: it has no slope", token.name);
	if (token.primes > 1 && symbol->kind == SYMBOL_INPUT)
		error(token.at, NULL, "input '%s' has no second derivative", token.name);
	check_component(symbol, component, token.at);
	if (p->no_acceleration && symbol->kind == SYMBOL_COORD && token.primes > 1)
		error(token.at, "a let may use coordinates and their first derivatives", "an acceleration in a let");
	struct node *node = node_new(NODE_NAME, token.at);
	node->symbol = symbol;
	node->depth = symbol->value ? symbol->value->depth + 1 : 0;
	node->primes = token.primes;
	node->component = component;
	node->end = p->end;
	return node;
}

struct node *read_state(struct parser *p)
{
	return resolve_name(p, take(p));
}

static void check_arguments(const struct node *call)
{
	bool three = call->function == FN_DEADZONE || call->function == FN_CLIP;
	int wanted = call->function == FN_ATAN2 ? 2 : three ? 3 : 1;
	if (call->function == FN_FRICTION && (call->children < 2 || call->children > 3))
		error(call->at, "friction(v, F), or friction(v, F, S) where S is what it holds up to",
		      "friction takes a velocity and a force, found %d argument%s", call->children,
		      call->children == 1 ? "" : "s");
	bool open_ended = call->function == FN_MIN || call->function == FN_MAX || call->function == FN_TABLE;
	if (call->function == FN_TABLE && call->children < 5)
		error(call->at, "table(x; x0, y0; x1, y1; ...)", "a table needs at least two points");
	if (call->function != FN_FRICTION && (open_ended ? call->children < 2 : call->children != wanted))
		error(call->at, NULL, "%s takes %s%d argument%s, found %d", function_name(call->function),
		      open_ended ? "at least " : "", open_ended ? 2 : wanted, wanted == 1 && !open_ended ? "" : "s",
		      call->children);
}

/* call: FUNCTION ( expression { , expression } )   |   table ( expression { ; expression , expression } ) */
static struct node *read_call(struct parser *p, struct token name, enum function function)
{
	struct node *call = node_new(NODE_CALL, name.at);
	call->function = function;
	if (name.primes > 0)
		error(name.at, NULL, "a function has no derivative here: '%s'", name.name);
	if (!is_op(p, "("))
		error(name.at, NULL, "'%s' is a function: expected '(' after it, found %s", name.name,
		      token_text(p->token));
	nest(p, name.at);
	struct place separator = take(p).at;
	add_child(call, read_expression(p), false, separator);
	while (is_op(p, ",") || is_op(p, ";")) {
		bool semicolon = is_op(p, ";");
		if (semicolon != (function == FN_TABLE && call->children % 2 == 1))
			unexpected(p,
				   function == FN_TABLE ? "the points of a table as x; x0, y0; x1, y1" : "',' or ')'");
		separator = take(p).at;
		add_child(call, read_expression(p), false, separator);
	}
	expect_op(p, ")", "',' or ')'");
	p->nesting--;
	call->end = p->end;
	if (function == FN_TABLE && call->children % 2 == 0)
		error(call->at, "table(x; x0, y0; x1, y1; ...)", "the last point of the table has no y");
	check_arguments(call);
	return call;
}

static struct node *read_bracket(struct parser *p)
{
	struct place opening = take(p).at;
	nest(p, opening);
	struct node *inner = read_expression(p);
	expect_op(p, ")", "')' or an operator");
	p->nesting--;
	if (p->token.kind == TOKEN_OPERATOR && p->token.op[0] == '\'')
		unexpected(p, "an operator");
	inner->start = opening;
	inner->end = p->end;
	return inner;
}

/* matrix: [ expression { , expression } { ; expression { , expression } } ] */
static struct node *read_matrix(struct parser *p)
{
	struct place separator = p->token.at;
	struct node *node = node_new(NODE_MATRIX, separator);
	nest(p, separator);
	for (int column = 0;;) {
		take(p);
		add_child(node, read_expression(p), false, separator);
		column++;
		separator = p->token.at;
		if (is_op(p, ","))
			continue;
		if (node->columns == 0)
			node->columns = column;
		if (column != node->columns)
			error(separator, NULL, "row of %d in a matrix with rows of %d", column, node->columns);
		column = 0;
		if (!is_op(p, ";"))
			break;
	}
	expect_op(p, "]", "',', ';' or ']'");
	p->nesting--;
	node->end = p->end;
	return node;
}

/* operand: NUMBER | pi | t | name | call | ( expression ) | matrix */
static struct node *read_operand(struct parser *p)
{
	if (is_op(p, "("))
		return read_bracket(p);
	if (is_op(p, "["))
		return read_matrix(p);
	if (p->token.kind == TOKEN_NUMBER) {
		struct token token = take(p);
		struct node *node = node_new(NODE_NUMBER, token.at);
		lex_number(token, node->number);
		node->end = p->end;
		return node;
	}
	if (p->token.kind != TOKEN_NAME)
		unexpected(p, "a number, a name or '('");
	struct token name = take(p);
	enum function function = function_of(name.name);
	if (function != FN_NONE && (function != FN_FRICTION || (is_op(p, "(") && !find_symbol(p, name.name))))
		return read_call(p, name, function);
	bool time = strcmp(name.name, "t") == 0;
	if (time || strcmp(name.name, "pi") == 0) {
		if (name.primes > 0)
			error(name.at, NULL, "'%s' has no derivative", name.name);
		struct node *node = node_new(time ? NODE_TIME : NODE_PI, name.at);
		node->end = p->end;
		return node;
	}
	if (is_reserved(name.name) && !find_symbol(p, name.name))   /* else broken: told where it is declared */
		error(name.at, NULL, "'%s' is a reserved word", name.name);
	return resolve_name(p, name);
}

/* primary: NUMBER | pi | t | name | call | ( expression ) */
static struct node *read_primary(struct parser *p)
{
	struct node *operand = read_operand(p);
	p->operand_end = p->end.offset;
	return operand;
}

static struct node *read_unary(struct parser *p);

/* power: primary [ ^ ( power | sign power ) ] */
static struct node *read_power(struct parser *p)
{
	struct node *base = read_primary(p);
	if (!is_op(p, "^")) {
		if (is_op(p, "*") && p->lexer.source->text[p->token.at.offset + 1] == '*')
			error(p->token.at, "a power is written with ^", "unexpected '**'");
		return base;
	}
	struct node *power = node_new(NODE_POWER, p->token.at);
	struct place caret = take(p).at;
	nest(p, caret);
	struct node *exponent = is_op(p, "+") || is_op(p, "-") ? read_unary(p) : read_power(p);
	p->nesting--;
	add_child(power, base, false, caret);
	add_child(power, exponent, false, caret);
	power->start = base->start;
	return power;
}

/* unary: ( + | - ) unary | power */
static struct node *read_unary(struct parser *p)
{
	if (!is_op(p, "+") && !is_op(p, "-"))
		return read_power(p);
	struct token sign = take(p);
	nest(p, sign.at);
	struct node *operand = read_unary(p);
	p->nesting--;
	struct node *node = node_new(NODE_SUM, sign.at);
	add_child(node, operand, sign.op[0] == '-', sign.at);
	return node;
}

/* One level of left-associative operators, as one node with many children: long sums stay flat. */
static struct node *read_chain(struct parser *p, enum node_kind kind, const char *plain, const char *inverse,
			       struct node *(*read)(struct parser *))
{
	struct node *first = read(p);
	if (!is_op(p, plain) && !is_op(p, inverse))
		return first;
	struct node *chain = node_new(kind, p->token.at);
	chain->start = first->start;
	add_child(chain, first, false, first->start);
	while (is_op(p, plain) || is_op(p, inverse)) {
		struct token operator = take(p);
		add_child(chain, read(p), strcmp(operator.op, inverse) == 0, operator.at);
	}
	return chain;
}

/* product: unary { ( * | / ) unary } */
static struct node *read_product(struct parser *p)
{
	return read_chain(p, NODE_PRODUCT, "*", "/", read_unary);
}

/* sum: product { ( + | - ) product } */
static struct node *read_sum(struct parser *p)
{
	return read_chain(p, NODE_SUM, "+", "-", read_product);
}

static bool comparison_of(const struct parser *p, enum comparison *comparison)
{
	static const char *const text[] = { "<", "<=", ">", ">=", "==", "!=" };
	for (int i = 0; i < 6; i++)
		if (is_op(p, text[i])) {
			*comparison = (enum comparison)i;
			return true;
		}
	return false;
}

/* comparison: sum [ ( < | <= | > | >= | == | != ) sum ] */
struct node *read_condition(struct parser *p)
{
	struct node *left = read_sum(p);
	enum comparison comparison;
	if (!comparison_of(p, &comparison))
		return left;
	struct node *node = node_new(NODE_COMPARE, p->token.at);
	struct place operator = take(p).at;
	node->comparison = comparison;
	node->start = left->start;
	add_child(node, left, false, operator);
	add_child(node, read_sum(p), false, operator);
	if (comparison_of(p, &comparison))
		unexpected(p, "a single comparison");
	return node;
}

/* expression: comparison [ ? expression : expression ] */
struct node *read_expression(struct parser *p)
{
	struct node *condition = read_condition(p);
	if (!is_op(p, "?"))
		return condition;
	struct node *node = node_new(NODE_CHOOSE, p->token.at);
	struct place mark = take(p).at;
	nest(p, mark);
	node->start = condition->start;
	add_child(node, condition, false, mark);
	add_child(node, read_expression(p), false, mark);
	expect_op(p, ":", "':' of the condition");
	add_child(node, read_expression(p), false, mark);
	p->nesting--;
	return node;
}

/* ---- statements ---- */

struct token expect_new_name(struct parser *p, const char *what)
{
	if (p->token.kind != TOKEN_NAME)
		unexpected(p, what);
	if (p->token.primes > 0)
		error(p->token.at, NULL, "a name is declared without primes: '%s'", p->token.name);
	if (is_reserved(p->token.name))
		error(p->token.at, NULL, "'%s' is a reserved word", p->token.name);
	return take(p);
}

/* Names that differ in a point for a _ are one in C. Told where the scene makes them meet. */
static void check_name_in_c(const struct parser *p, const char *name, struct place at)
{
	for (const struct symbol *s = p->spec->bucket[name_hash(name) % BUCKETS]; s; s = s->next_alike) {
		size_t same = 0;
		while (s->name[same] && (s->name[same] == name[same] || (strchr("._", s->name[same]) && name[same] &&
									 strchr("._", name[same]))))
			same++;
		if (!s->name[same] && !name[same] && strcmp(s->name, name) != 0 && s->kind != SYMBOL_PART)
			error(p->part ? p->part->at : at, "names of parts have a _ for the point there",
			      "'%s' and '%s' are one name in C", s->name, name);
	}
}

static struct place last_token(const struct parser *p, size_t length)
{
	return (struct place){ p->end.source, p->end.offset - length };
}

struct symbol *declare(struct parser *p, struct token name, enum symbol_kind kind, bool broken)
{
	struct spec *spec = p->spec;
	struct symbol *known = find_symbol(p, name.name);
	if (strchr(name.name, '.'))
		error(name.at, "names with a point are those of parts", "'%s' is no name to declare", name.name);
	if (known && known->broken)
		abandon();
	if (known)
		error(name.at, NULL, "'%s' is declared already, as %s %s", name.name,
		      known->kind == SYMBOL_OUTPUT || known->kind == SYMBOL_INPUT ? "an" : "a", symbol_kind(known));
	int *counts[] = { &spec->params, &spec->coords, &spec->lets, &spec->outputs, &spec->inputs, &spec->matrices,
			  &spec->part_outputs, &spec->part_names };
	const char *whole = p->part ? format("%s.%s", p->part->name, name.name) : name.name;
	if (kind != SYMBOL_PART && !broken)
		check_name_in_c(p, whole, name.at);
	struct symbol *symbol = NEW(struct symbol);
	*symbol = (struct symbol){
		.kind = kind, .name = whole, .at = name.at, .statement = p->statement, .broken = broken, .part = p->part
	};
	symbol->index = broken ? -1 : (*counts[kind])++;
	add_symbol(spec, symbol);
	return symbol;
}

/* What the scene gives to the part that is read; or NULL */
static const struct binding *binding_of(const struct parser *p, const char *name)
{
	const struct binding *found = NULL;
	for (const struct scene_part *part = p->part; part; part = part->inside) {
		for (int i = 0; i < part->bindings; i++) {
			struct binding *binding = &part->binding[i];
			if (strcmp(binding->name.name, name) != 0 || binding->name.primes || binding->component)
				continue;
			binding->taken = true;
			found = binding;        /* that of the outermost */
		}
		const char *point = strrchr(part->name, '.');
		name = format("%s.%s", point ? point + 1 : part->name, name);
	}
	return found;
}

/* In a part: what the scene gives instead */
static struct node *given_value(struct parser *p, const char *name, struct node *value)
{
	const struct binding *binding = binding_of(p, name);
	return binding ? binding->value : value;
}

/* param: param NAME = expression { , NAME = expression };   let: let NAME = expression */
static void read_definitions(struct parser *p, enum symbol_kind kind)
{
	do {
		struct token name = expect_new_name(p, "a name");
		expect_op(p, "=", "'='");
		struct node *value = read_expression(p);
		value = kind == SYMBOL_PARAM ? given_value(p, name.name, value) : value;
		declare(p, name, kind, false)->value = value;
	} while (take_op(p, ","));
	expect_end(p);
}

static void read_param(struct parser *p)
{
	read_definitions(p, SYMBOL_PARAM);
}

static void read_let(struct parser *p)
{
	p->no_acceleration = true;
	read_definitions(p, SYMBOL_LET);
}

void add_file(struct spec *spec, const char *path)
{
	for (int i = 0; i < spec->files; i++)
		if (strcmp(spec->file[i], path) == 0)
			return;
	ENLARGE(spec->file, (size_t)spec->files + 1);
	spec->file[spec->files++] = path;
}

/* A file that a text names stands beside it unless its path is absolute. */
const char *beside(const struct source *source, const char *name)
{
	const char *slash = strrchr(source->name, '/');
	return name[0] == '/' || !slash ? name : format("%.*s/%s", (int)(slash - source->name), source->name, name);
}

struct node *read_file_name(struct parser *p)
{
	struct token token = take(p);
	const char *name = format("%.*s", (int)token.length - 2, token.at.source->text + token.at.offset + 1);
	struct node *node = node_new(NODE_FILE, token.at);
	node->end = p->end;
	node->path = beside(token.at.source, name);
	add_file(p->spec, node->path);
	return node;
}

/* matrix: matrix NAME = ( STRING | expression ) { , ... } */
static void read_matrix_statement(struct parser *p)
{
	do {
		struct token name = expect_new_name(p, "the name of a matrix");
		expect_op(p, "=", "'='");
		struct node *value = p->token.kind == TOKEN_STRING ? read_file_name(p) : read_expression(p);
		value = given_value(p, name.name, value);
		declare(p, name, SYMBOL_MATRIX, false)->value = value;
	} while (take_op(p, ","));
	expect_end(p);
}

/* two-mass as two_mass */
static const char *joined_name(struct token name)
{
	const char *text = name.at.source->text + name.at.offset;
	char *joined = format("%.*s", (int)strcspn(text, " \t\r\n#"), text);
	for (char *c = joined; *c; c++)
		*c = strchr(WORD, *c) ? *c : '_';
	return joined;
}

/* model: model NAME */
static void read_model(struct parser *p)
{
	if (p->own->name && *p->own->name)
		error(last_token(p, 5), NULL, "the model is named already: '%s'", p->own->name);
	if (p->token.kind != TOKEN_NAME || p->token.primes > 0 || strchr(p->token.name, '.'))
		unexpected(p, "the model's name");
	struct token name = take(p);
	if (is_op(p, "-") || is_op(p, "+") || is_op(p, "/"))
		error(p->token.at, format("names are made of the letters a to z, digits and _: %s", joined_name(name)),
		      "a model's name has no '%s'", p->token.op);
	expect_end(p);
	p->own->name = name.name;
	p->own->name_at = name.at;
}

/* coord: coord NAME [ '[' NUMBER ']' ] { , ... } */
static void read_coord(struct parser *p)
{
	do {
		struct token name = expect_new_name(p, "the name of a coordinate");
		int primes = 0, length = read_component(p, &primes, true);
		if (primes)
			error(name.at, NULL, "a coordinate is declared without primes");
		struct symbol *symbol = declare(p, name, SYMBOL_COORD, false);
		symbol->length = length;
		symbol->index = p->spec->components;
		p->spec->components += length ? length : 1;
	} while (take_op(p, ","));
	expect_end(p);
}

bool take_word(struct parser *p, const char *word)
{
	if (p->token.kind != TOKEN_NAME || p->token.primes > 0 || strcmp(p->token.name, word) != 0)
		return false;
	take(p);
	return true;
}

/* `hold first` at the end of a list, and nowhere else in it, holds for the whole list. Else it holds for the name
 * before it, and whoever has none is held: after the ramps only, where that cannot be taken for the other. `last`: of
 * the list */
static void apply_hold(struct parser *p, const struct symbol *last, int phrases)
{
	const struct symbol *held = NULL;
	bool whole = phrases == 1 && last->hold;
	for (struct symbol *s = p->spec->first; s && phrases > 0; s = s->next) {
		if (s->statement != p->statement || s->part != p->part)
			continue;
		if (s->hold && held && !whole)
			error(held->at,
			      format("what is held goes last, or has a statement of its own: input %s", held->name),
			      "is '%s' held, or a ramp as '%s' is?", held->name, s->name);
		held = s->hold || held ? held : s;
		s->hold = whole ? last->hold : s->hold;
	}
}

/* The degree that follows `hold` */
static int take_hold(struct parser *p)
{
	static const struct { const char *word; int degree; } known[] = {
		{ "first", 1 }, { "third", 3 }, { "fifth", 5 }, { "seventh", 7 }
	};
	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		if (take_word(p, known[i].word))
			return known[i].degree;
	error(p->token.at, "without 'hold first' an input is held from sample to sample",
	      "expected 'first', 'third', 'fifth' or 'seventh', found %s", token_text(p->token));
}

/* input: input NAME [ hold DEGREE ] { , NAME [ hold DEGREE ] } */
static void read_input(struct parser *p)
{
	struct symbol *input;
	int phrases = 0;
	do {
		struct token name = expect_new_name(p, "the name of an input");
		struct node *connected = given_value(p, name.name, NULL);
		input = declare(p, name, connected ? SYMBOL_LET : SYMBOL_INPUT, false);
		input->value = connected;
		input->connected = connected;
		if (!take_word(p, "hold"))
			continue;
		input->hold = take_hold(p);
		phrases++;
	} while (take_op(p, ","));
	expect_end(p);
	apply_hold(p, input, phrases);
}

/* What a part has of its own the scene may give again: the later one counts. */
void add_initial(struct parser *p, struct token name, struct symbol *coord, int component, struct node *value)
{
	struct spec *spec = p->spec;
	for (int i = 0; i < spec->initials; i++)
		if (spec->initial[i].coord == coord && spec->initial[i].primes == name.primes &&
		    spec->initial[i].part == p->part &&
		    (!component || !spec->initial[i].component || spec->initial[i].component == component))
			error(name.at, NULL, "the initial value of %s is given already", token_text(name));
	ENLARGE(spec->initial, (size_t)spec->initials + 1);
	spec->initial[spec->initials++] =
		(struct initial){ name.at, p->part, p->statement, coord, name.primes, component, value };
}

/* init: init NAME [ ' ] = expression { , ... } */
static void read_init(struct parser *p)
{
	do {
		if (p->token.kind != TOKEN_NAME)
			unexpected(p, "a coordinate");
		struct token name = take(p);
		int component = read_component(p, &name.primes, false);
		name.length = p->end.offset - name.at.offset;
		struct symbol *coord = find_symbol(p, name.name);
		if (coord && coord->broken)
			abandon();
		if (!coord && !is_reserved(name.name))
			unknown_name(p, name);
		if (!coord || coord->kind != SYMBOL_COORD)
			error(name.at, "initial values are for coordinates and their velocities",
			      "'%s' is not a coordinate", name.name);
		check_component(coord, component, name.at);
		if (name.primes > 1)
			error(name.at, NULL, "an acceleration has no initial value: it follows from the equations");
		expect_op(p, "=", "'='");
		add_initial(p, name, coord, component, read_expression(p));
	} while (take_op(p, ","));
	expect_end(p);
}

/* An output that only names something: x1, x2', x1'', a let. */
static void read_plain_output(struct parser *p, struct token name)
{
	const struct symbol *known = find_symbol(p, name.name);
	const bool peak = known && known->kind == SYMBOL_PART_OUTPUT && known->peak;
	struct node *value = strcmp(name.name, "t") == 0 ? node_new(NODE_TIME, name.at)
			     : peak                      ? inlined(known->value, name.at, p->end)
							 : resolve_name(p, name);
	const char *shown = value->component ? format("%s[%d]%.*s", name.name, value->component, value->primes, "''")
					     : format("%s%.*s", name.name, value->primes, "''");
	if (p->token.kind != TOKEN_END && !is_op(p, ","))
		unexpected(p, "'=' or ','");
	if (p->part)                            /* the scene names it as it is */
		return;
	for (struct symbol *s = p->spec->first; s; s = s->next)
		if (s->kind == SYMBOL_OUTPUT && strcmp(s->name, shown) == 0)
			error(name.at, NULL, "output '%s' is declared already", shown);
	struct symbol *symbol = NEW(struct symbol);
	*symbol = (struct symbol){
		.kind = SYMBOL_OUTPUT, .name = shown, .at = name.at, .statement = p->statement, .value = value
	};
	symbol->index = p->spec->outputs++;
	symbol->peak = peak;
	value->end = p->end;
	add_symbol(p->spec, symbol);
}

/* `peak(`, unless that is a name of the spec's own */
static bool take_peak(struct parser *p)
{
	if (find_symbol(p, "peak") || !take_word(p, "peak"))
		return false;
	expect_op(p, "(", "'(': peak(x) is the largest |x| so far");
	return true;
}

/* output: output ( NAME = expression | NAME = peak ( expression ) | name ) { , ... } */
static void read_output(struct parser *p)
{
	do {
		if (p->token.kind != TOKEN_NAME)
			unexpected(p, "the name of an output");
		struct token name = take(p);
		if (!is_op(p, "=")) {
			read_plain_output(p, name);
			continue;
		}
		if (name.primes > 0 || is_reserved(name.name))
			error(name.at, NULL, "'%s' cannot be the name of an output", name.name);
		take(p);
		struct place at = p->token.at;
		bool peak = take_peak(p);
		struct node *value = read_expression(p);
		if (peak)
			expect_op(p, ")", "')' or an operator");
		if (peak && p->token.kind == TOKEN_OPERATOR && strchr("+-*/^<>=!?", p->token.op[0]))
			peak_inside(at);
		struct symbol *output = declare(p, name, p->part ? SYMBOL_PART_OUTPUT : SYMBOL_OUTPUT, false);
		output->value = value;
		output->peak = peak;
	} while (take_op(p, ","));
	expect_end(p);
}

/* step: step expression */
static void read_step(struct parser *p)
{
	struct place at = last_token(p, 4);
	if (p->own->step)
		error(at, NULL, "the step is given already");
	p->own->step_at = p->token.at;
	p->own->step = read_expression(p);
	expect_end(p);
}

/* order or stages [ over steps ] */
static struct node *take_order(struct parser *p, struct node **over)
{
	struct place at = p->token.at;
	if (!find_symbol(p, "over") && take_word(p, "over"))
		error(at, "scheme taylor N over K", "an expansion over several steps is of fixed order");
	struct node *order = read_expression(p);
	*over = take_word(p, "over") ? read_expression(p) : NULL;
	return order;
}

/* scheme: scheme NAME [ order or stages [ over steps ] ] */
static void read_scheme(struct parser *p)
{
	struct place at = last_token(p, 6);
	if (p->own->scheme)
		error(at, NULL, "the scheme is given already");
	if (p->token.kind != TOKEN_NAME || p->token.primes > 0)
		unexpected(p, "the name of a scheme");
	struct token name = take(p);
	p->own->scheme_at = name.at;
	enum scheme scheme;
	bool counts = scheme_of(name.name, &scheme) && (scheme_row(scheme)->expands || scheme_row(scheme)->stages);
	if (p->token.kind == TOKEN_NUMBER || (counts && p->token.kind != TOKEN_END))
		/* a number behind another scheme is told later */
		p->own->scheme_order = take_order(p, &p->own->scheme_over);
	expect_end(p);
	p->own->scheme = name.name;
}

/* tolerance: tolerance expression; substeps: substeps expression */
static void read_bound(struct parser *p, const char *word, struct node **bound)
{
	struct place at = last_token(p, strlen(word));
	if (*bound)
		error(at, NULL, "the %s given already",
		      strcmp(word, "substeps") == 0 ? "substeps are" : "tolerance is");
	*bound = read_expression(p);
	expect_end(p);
}

static void read_tolerance(struct parser *p) { read_bound(p, "tolerance", &p->own->tolerance); }
static void read_substeps(struct parser *p) { read_bound(p, "substeps", &p->own->substeps); }

/* expression { , expression } [ , ] [ without static ] */
static struct mode_list take_modes(struct parser *p)
{
	struct mode_list list = { .at = p->token.at };
	do {
		if (list.count > 0 && (p->token.kind == TOKEN_END || p->token.kind == TOKEN_NAME))
			break;                  /* a comma at the end makes a list of one */
		ENLARGE(list.number, (size_t)list.count + 1);
		list.number[list.count++] = read_expression(p);
		list.each = list.each || is_op(p, ",");
	} while (take_op(p, ","));
	list.without_static = take_word(p, "without");
	if (list.without_static && !take_word(p, "static"))
		unexpected(p, "'static'");
	expect_end(p);
	return list;
}

/* modes: modes expression { , expression } [ without static ] */
static void read_modes(struct parser *p)
{
	struct place at = last_token(p, 5);
	if (p->own->modes.at.source)
		error(at, NULL, "the modes are given already");
	p->own->modes = take_modes(p);
}

void expect_word(struct parser *p, const char *word)
{
	if (!take_word(p, word))
		unexpected(p, format("'%s'", word));
}

/* NAME = or q[3]' =: the next name of a list of definitions */
static bool names_definition(const struct parser *p)
{
	const char *text = p->lexer.source->text + p->token.at.offset + p->token.length;
	if (p->token.kind == TOKEN_NAME && *text == '[')
		text += strcspn(text, "]\n") + (text[strcspn(text, "]\n")] == ']');
	text += strspn(text, "' \t");
	return p->token.kind == TOKEN_NAME && text[0] == '=' && text[1] != '=';
}

/* What an operator can fix: t, a coordinate, its first derivative, a let */
static struct fixed *read_fixed_name(struct parser *p)
{
	struct spec *spec = p->own;
	if (p->token.kind != TOKEN_NAME)
		unexpected(p, "a name to fix");
	struct token token = take(p);
	bool time = strcmp(token.name, "t") == 0 && token.primes == 0;
	struct node *name = time ? NULL : resolve_name(p, token);
	struct symbol *symbol = time ? NULL : name->symbol;
	if (!time && !symbol)
		error(token.at, "an operator fixes t, coordinates, their first derivatives and lets",
		      "'%s' cannot be fixed", token.name);
	if (symbol && symbol->kind != SYMBOL_COORD && symbol->kind != SYMBOL_LET)
		error(token.at, "an operator fixes t, coordinates, their first derivatives and lets",
		      "%s '%s' cannot be fixed", symbol_kind(symbol), symbol->name);
	if (token.primes > 1 || (name && name->primes > 1))
		error(token.at, "an operator fixes t, coordinates, their first derivatives and lets",
		      "an acceleration cannot be fixed");
	for (int i = 0; i < spec->fixeds; i++) {
		const struct fixed *other = &spec->fixed[i];
		bool same = other->symbol == symbol && (!name || (other->primes == name->primes &&
			    (!other->component || !name->component || other->component == name->component)));
		if (same)
			error(token.at, NULL, "%s is fixed already", text_between(token.at, p->end));
	}
	ENLARGE(spec->fixed, (size_t)spec->fixeds + 1);
	struct fixed *fixed = &spec->fixed[spec->fixeds++];
	*fixed = (struct fixed){ .at = token.at, .end = p->end, .symbol = symbol };
	fixed->primes = name ? name->primes : 0;
	fixed->component = name ? name->component : 0;
	return fixed;
}

/* operator: operator [ number ] at NAME = expression { , ( NAME = expression | expression ) } */
static void read_operator(struct parser *p)
{
	struct spec *spec = p->own;
	struct place at = last_token(p, 8);
	struct fixed *fixed = NULL;
	if (spec->has_operator)
		error(at, NULL, "the operator is given already");
	spec->has_operator = true;
	spec->operator_at = at;
	if (p->token.kind == TOKEN_NUMBER)
		spec->operator_count = read_expression(p);
	expect_word(p, "at");
	do {
		if (!fixed || names_definition(p)) {
			fixed = read_fixed_name(p);
			expect_op(p, "=", "'='");
		}
		ENLARGE(fixed->value, (size_t)fixed->values + 1);
		fixed->value[fixed->values++] = read_expression(p);
	} while (take_op(p, ","));
	expect_end(p);
}

/* ---- params that the target may change ---- */

/* tunable: tunable NAME { , NAME } */
static void read_tunable(struct parser *p)
{
	struct spec *spec = p->spec;
	do {
		if (p->token.kind != TOKEN_NAME || is_reserved(p->token.name))
			unexpected(p, "a param");
		struct token token = take(p);
		struct symbol *symbol = find_symbol(p, token.name);
		if (!symbol || symbol->broken || symbol->kind == SYMBOL_PARAM || symbol->kind == SYMBOL_PART)
			symbol = resolve_name(p, token)->symbol;
		if (symbol->kind != SYMBOL_PARAM)
			error(token.at, "a param is tunable, and nothing else", "%s '%s' is not a param",
			      symbol_kind(symbol), symbol->name);
		if (symbol->tuned)
			error(token.at, NULL, "'%s' is tunable already", symbol->name);
		if (spec->tunables == LIMIT_TUNABLES)
			error(token.at, NULL, "more tunable params than the limit of %d", LIMIT_TUNABLES);
		symbol->tuned = true;
		symbol->tunable = spec->tunables + 1;
		ENLARGE(spec->tunable, (size_t)spec->tunables + 1);
		spec->tunable[spec->tunables++] = (struct tunable){ token.at, symbol };
	} while (take_op(p, ","));
	expect_end(p);
}

/* ---- how exact outputs have to be, and what a step may cost ---- */

/* An output as it is named, primes and component included */
static const char *read_output_name(struct parser *p)
{
	if (p->token.kind != TOKEN_NAME || is_reserved(p->token.name))
		unexpected(p, "the name of an output");
	struct token name = take(p);
	int component = read_component(p, &name.primes, false);
	return component ? format("%s[%d]%.*s", name.name, component, name.primes, "''")
			 : format("%s%.*s", name.name, name.primes, "''");
}

/* | NAME | <= expression */
static struct need_input read_need_input(struct parser *p)
{
	expect_op(p, "|", "'|': the bound of an input, as in for |u| <= 3");
	if (p->token.kind != TOKEN_NAME || p->token.primes > 0)
		unexpected(p, "the name of an input");
	struct token name = take(p);
	struct need_input input = { .at = name.at, .name = name.name };
	expect_op(p, "|", "'|'");
	expect_op(p, "<=", "'<='");
	input.most = read_expression(p);
	return input;
}

/* need: need output within expression [ % ] until expression [ for |NAME| <= expression { , ... } ] */
static void read_need(struct parser *p)
{
	struct need need = { .at = last_token(p, 4), .output_at = p->token.at };
	p->lexer.needs = true;
	need.output = read_output_name(p);
	expect_word(p, "within");
	need.bound = read_expression(p);
	need.percent = take_op(p, "%");
	expect_word(p, "until");
	need.until = read_expression(p);
	if (p->token.kind != TOKEN_END) {
		expect_word(p, "for");
		do {
			struct need_input input = read_need_input(p);
			for (int i = 0; i < need.inputs; i++)
				if (strcmp(need.input[i].name, input.name) == 0)
					error(input.at, NULL, "'%s' is bounded already", input.name);
			ENLARGE(need.input, (size_t)need.inputs + 1);
			need.input[need.inputs++] = input;
		} while (take_op(p, ","));
	}
	expect_end(p);
	ENLARGE(p->own->need, (size_t)p->own->needs + 1);
	p->own->need[p->own->needs++] = need;
}

/* budget: budget expression instructions on TARGET; a target has hyphens in its name */
static void read_budget(struct parser *p)
{
	struct budget *budget = &p->own->budget;
	struct place at = last_token(p, 6);
	if (budget->instructions)
		error(at, NULL, "the budget is given already");
	struct node *instructions = read_expression(p);
	expect_word(p, "instructions");
	expect_word(p, "on");
	if (p->token.kind != TOKEN_NAME || p->token.primes > 0)
		unexpected(p, "a target: cortex-m4 or cortex-m0");
	*budget = (struct budget){ at, instructions, p->token };
	size_t from = p->token.at.offset;
	while (p->token.kind != TOKEN_END)
		take(p);
	budget->target.name = text_between(budget->target.at, p->end);
	budget->target.length = p->end.offset - from;
}

/* ---- sketches ---- */

struct node *read_coordinate(struct parser *p, bool ground)
{
	if (ground && take_word(p, "ground"))
		return NULL;
	if (p->token.kind != TOKEN_NAME || is_reserved(p->token.name))
		unexpected(p, ground ? "a coordinate or ground" : "a coordinate");
	struct node *node = resolve_name(p, take(p));
	const struct symbol *symbol = node->symbol;
	if (!symbol || symbol->kind != SYMBOL_COORD || node->primes > 0 || (symbol->length && !node->component))
		error(node->at, NULL, "expected a scalar coordinate or a component, found '%s'",
		      text_between(node->start, node->end));
	return node;
}

/* The velocity of a coordinate that has been read */
static struct node *velocity_of(const struct node *coordinate)
{
	struct node *velocity = node_new(NODE_NAME, coordinate->at);
	*velocity = *coordinate;
	velocity->primes = 1;
	return velocity;
}

/* friction F between x, y: friction(x' - y', F) */
static struct node *friction_between(const struct element *element)
{
	struct node *call = node_new(NODE_CALL, element->value->at), *slide = velocity_of(element->from);
	call->function = FN_FRICTION;
	call->start = element->at;
	call->end = element->end;
	if (element->to) {
		struct node *sum = node_new(NODE_SUM, element->from->at);
		sum->start = element->from->start;
		sum->end = element->to->end;
		add_child(sum, slide, false, element->from->at);
		add_child(sum, velocity_of(element->to), true, element->to->at);
		slide = sum;
	}
	add_child(call, slide, false, element->value->at);
	add_child(call, element->value, false, element->value->at);
	return call;
}

/* mass: mass expression at coordinate;  spring, damper, friction: ... expression between coordinate , coordinate;
 * force: force expression on coordinate */
static void read_element(struct parser *p, int kind)
{
	struct spec *spec = p->spec;
	struct element element = { .kind = kind, .part = p->part };
	element.at = (struct place){ p->lexer.source, p->statement };
	element.value = read_expression(p);
	expect_word(p, kind == ELEMENT_MASS ? "at" : kind == ELEMENT_FORCE ? "on" : "between");
	bool two = kind == ELEMENT_SPRING || kind == ELEMENT_DAMPER || kind == ELEMENT_FRICTION;
	struct token first = p->token;
	element.from = read_coordinate(p, two);
	if (two) {
		expect_op(p, ",", "','");
		element.to = read_coordinate(p, true);
	}
	if (two && !element.from) {
		element.from = element.to;
		element.to = NULL;
	}
	if (!element.from || (element.to && element.from->symbol == element.to->symbol &&
			      element.from->component == element.to->component))
		error(first.at, NULL, "it acts between a coordinate and itself");
	expect_end(p);
	element.end = p->end;
	if (kind == ELEMENT_FRICTION)
		element.value = friction_between(&element);
	ENLARGE(spec->element, (size_t)spec->elements + 1);
	spec->element[spec->elements++] = element;
}

static void read_mass(struct parser *p) { read_element(p, ELEMENT_MASS); }
static void read_spring(struct parser *p) { read_element(p, ELEMENT_SPRING); }
static void read_damper(struct parser *p) { read_element(p, ELEMENT_DAMPER); }
static void read_force(struct parser *p) { read_element(p, ELEMENT_FORCE); }
static void read_friction(struct parser *p) { read_element(p, ELEMENT_FRICTION); }

/* By a file that stands on this one */
static void read_part(struct parser *p)
{
	p->spec->uses = p->lexer.points = true;
	p->spec->reader->read(p);
}

static const struct statement {
	const char *word;
	void (*read)(struct parser *);
} statements[] = {
	{ "model", read_model }, { "param", read_param }, { "coord", read_coord }, { "init", read_init },
	{ "let", read_let }, { "output", read_output }, { "step", read_step }, { "scheme", read_scheme },
	{ "input", read_input }, { "matrix", read_matrix_statement }, { "mass", read_mass }, { "spring", read_spring },
	{ "damper", read_damper }, { "force", read_force }, { "operator", read_operator }, { "tunable", read_tunable },
	{ "tolerance", read_tolerance }, { "substeps", read_substeps }, { "modes", read_modes }, { "use", read_part },
	{ "need", read_need }, { "budget", read_budget }, { "friction", read_friction },
	{ "when", read_when }, { "stop", read_stop }
};

/* tolerance, substeps, modes, use, need, budget, when and stop may be names of a spec's own: in an equation an operator
 * or a prime follows; a sign is that of a number where the line has no =; an = is no equation where there is no such name. */
static bool opens_statement(const struct parser *p, const struct statement *statement, struct token token)
{
	const char *next = token.at.source->text + token.at.offset + token.length;
	next += strspn(next, " \t");
	bool sign = *next == '-' || *next == '+';
	if (strcmp(statement->word, "when") == 0 && next[strcspn(next, ":\n")] == ':' && sign)
		return true;                    /* when -x > 0: x' = 0 */
	if (strcmp(statement->word, "friction") == 0 && *next == '(') {     /* friction(v, F) of an equation */
		const char *between = strstr(next, " between ");
		return between && between < next + strcspn(next, "\n#");
	}
	return is_reserved(statement->word) || strspn(next, WORD) > 0 || strchr(".\"", *next) || *next == '(' ||
	       *next == '\n' || *next == '#' || (sign && next[strcspn(next, "=\n")] != '=') ||
	       (*next == '=' && !find_symbol(p, statement->word));
}

static const struct statement *statement_of(const struct parser *p, struct token token)
{
	for (size_t i = 0; token.kind == TOKEN_NAME && token.primes == 0 && i < sizeof statements / sizeof *statements;
	     i++)
		if (strcmp(token.name, statements[i].word) == 0 && opens_statement(p, &statements[i], token))
			return &statements[i];
	return NULL;
}

static const char *nearest_statement(const char *word)
{
	const char *known[sizeof statements / sizeof *statements], *habit = statement_habit(word);
	if (habit)
		return habit;
	for (size_t i = 0; i < sizeof statements / sizeof *statements; i++)
		known[i] = statements[i].word;
	return nearest_name(word, (int)(sizeof statements / sizeof *statements), known);
}

/* A line such as `parm m = 1` or `stpe 0.01`: no expression starts with a name and a name or number. */
static bool resembles_statement(const struct parser *p, struct token token)
{
	const char *text = token.at.source->text + token.at.offset + token.length;
	size_t space = strspn(text, " \t");
	return token.kind == TOKEN_NAME && token.primes == 0 && space > 0 && strspn(text + space, WORD) > 0 &&
	       !find_symbol(p, token.name) && (!is_reserved(token.name) || statement_habit(token.name));
}

/* It is meant as a statement: say so rather than that its first word is unknown. */
static void check_statement_word(const struct parser *p)
{
	struct token token = p->token;
	if (!resembles_statement(p, token))
		return;
	const char *nearest = nearest_statement(token.name);
	error(token.at, nearest ? format("did you mean '%s'?", nearest) : NULL, "unknown statement '%s'", token.name);
}

/* equation: expression = expression */
static void read_equation(struct parser *p)
{
	check_statement_word(p);
	struct spec *spec = p->spec;
	struct equation equation = { .at = p->token.at, .part = p->part };
	spec->equations++;                      /* counted even if broken: its absence is not to be told as well */
	ENLARGE(spec->equation, (size_t)spec->equations);
	spec->equation[spec->equations - 1] = equation;
	equation.left = read_expression(p);
	if (p->token.kind == TOKEN_END && equation.left->kind == NODE_COMPARE && equation.left->comparison == CMP_EQ)
		error(equation.left->at, "an equation has a single =",
		      "expected an operator or the '=' of the equation, found '=='");
	if (!is_op(p, "="))
		unexpected(p, "an operator or the '=' of the equation");
	take(p);
	equation.right = read_expression(p);
	equation.end = p->end;
	if (is_op(p, "="))
		error(p->token.at, NULL, "an equation has a single =");
	expect_end(p);
	spec->equation[spec->equations - 1] = equation;
}

static void read_statement(void *context)
{
	struct parser *p = context;
	p->token = lex_next(&p->lexer);
	p->end = p->token.at;
	const struct statement *statement = statement_of(p, p->token);
	if (!p->own->name && !(statement && statement->read == read_model)) {
		p->own->name = "";              /* told once */
		error(p->token.at, "a spec begins with its name: model NAME",
		      "expected the statement 'model', found %s", token_text(p->token));
	}
	if (!p->own->name)
		p->own->name = "";              /* should its statement fail, that is told */
	if (!statement) {
		read_equation(p);
	} else {
		take(p);
		statement->read(p);
	}
}

/* ---- after an error ---- */

struct quiet { struct parser *parser; struct token name; enum symbol_kind kind; };

static void declare_broken(void *context)
{
	struct quiet *quiet = context;
	if (!find_symbol(quiet->parser, quiet->name.name))
		declare(quiet->parser, quiet->name, quiet->kind, true);
}

void declare_quietly(struct parser *p, struct token name, enum symbol_kind kind)
{
	statement_guard(declare_broken, &(struct quiet){ p, name, kind });
}

/* The statement that starts at `from`, or that its misspelt first word is meant for. Nothing is lexed: what cannot be
 * has been told, and no guard stands around this. */
static const struct statement *failed_statement(const struct parser *p, size_t from, size_t *after)
{
	const char *text = p->lexer.source->text + from;
	size_t length = strspn(text, WORD);
	struct token token = { TOKEN_NAME, { p->lexer.source, from }, length, "", format("%.*s", (int)length, text),
			       text[length] == '\'' };
	const struct statement *statement = statement_of(p, token);
	*after = from + length;
	if (statement || !resembles_statement(p, token))
		return statement;
	const char *nearest = nearest_statement(token.name);
	for (size_t i = 0; nearest && i < sizeof statements / sizeof *statements; i++)
		if (strcmp(nearest, statements[i].word) == 0)
			return &statements[i];
	return NULL;
}

/* The names that a failed statement would have declared are known but broken, so that their use is not told as well. */
static void declare_what_failed(struct parser *p, size_t from)
{
	const char *text = p->lexer.source->text;
	size_t after;
	const struct statement *statement = failed_statement(p, from, &after);
	for (struct symbol *s = p->spec->first; s; s = s->next)
		if (s->statement == p->statement && s->part == p->part &&
		    (s->kind == SYMBOL_PARAM || s->kind == SYMBOL_MATRIX))
			s->broken = true;
	if (statement && statement->read == read_part)
		p->spec->reader->failed(p, after);
	bool all = statement && (statement->read == read_coord || statement->read == read_input);
	if (!statement || (!all && statement->read != read_param && statement->read != read_let &&
			   statement->read != read_output && statement->read != read_matrix_statement))
		return;
	bool listed = true;                     /* here a definition starts, even one without its = */
	int depth = 0;
	for (size_t i = after; i < p->lexer.end; i++) {
		if (text[i] == '#')
			i += strcspn(text + i, "\n");
		if (i >= p->lexer.end)
			break;
		size_t length = strspn(text + i, WORD);
		if (length == 0) {
			depth += strchr("([{", text[i]) ? 1 : strchr(")]}", text[i]) ? -1 : 0;
			listed = depth == 0 && (text[i] == ',' || (listed && strchr(" \t\r\n", text[i])));
			continue;
		}
		const char *next = text + i + length + strspn(text + i + length, " \t");
		bool defined = listed || (next[0] == '=' && next[1] != '=');
		listed = false;
		if ((all || defined) && !strchr("0123456789", text[i])) {
			struct token token = {
				TOKEN_NAME, { p->lexer.source, i }, length, "", format("%.*s", (int)length, text + i), 0
			};
			declare_quietly(p, token, SYMBOL_PARAM);
		}
		i += length - 1;
	}
}

/* Whether the line from `from` to `end` can be the rest of an unfinished statement: one that opens a statement cannot,
 * one that is not set in where it goes on with a list: k = 100 */
static bool is_rest(const struct parser *p, size_t from, size_t end)
{
	const char *text = p->lexer.source->text;
	size_t first = from + strspn(text + from, " \t"), after;
	size_t word = first + strspn(text + first, WORD);
	word += strspn(text + word, " \t");
	bool listed = failed_statement(p, p->statement, &after) && strchr("=,#\r\n", text[word]);
	return first < end && (first > from || listed) && !failed_statement(p, first, &after);
}

static bool goes_on(const struct parser *p)
{
	const struct source *source = p->lexer.source;
	size_t unclosed, from = p->lexer.end + 1;
	return is_unfinished(p) && from < source->length &&
	       is_rest(p, from, lex_statement_end(source, from, &unclosed));
}

/* The lines that go on with an unfinished statement: what it declares there is known, and they are no equations. */
static void take_unfinished_lines(struct parser *p)
{
	const struct source *source = p->lexer.source;
	bool more = is_unfinished(p);
	while (more && p->lexer.end + 1 < source->length) {
		size_t unclosed, from = p->lexer.end + 1, end = lex_statement_end(source, from, &unclosed);
		if (!is_rest(p, from, end))
			break;
		p->lexer.end = end;
		size_t last = from + strcspn(source->text + from, "#\n");
		while (last > from && strchr(" \t\r", source->text[last - 1]))
			last--;
		more = last > from && strchr(",+-*/^=", source->text[last - 1]);
	}
}

/* spec: { statement line-end } */
void parse_statements(struct spec *spec, struct spec *own, struct scene_part *part, const struct source *source)
{
	size_t position = strncmp(source->text, "\xef\xbb\xbf", 3) == 0 ? 3 : 0;
	while (position < source->length) {
		size_t unclosed, from = position;
		struct parser p = { .spec = spec, .own = own, .part = part };
		p.lexer = (struct lexer){ source, from, lex_statement_end(source, from, &unclosed), spec->uses, false };
		position = p.lexer.end + 1;
		for (size_t i = from; strchr(" \t\r\f\v", source->text[i]) && i < p.lexer.end;)
			from = ++i;
		if (from >= p.lexer.end || source->text[from] == '#')
			continue;
		p.statement = from;
		bool good = false;
		if (unclosed != SIZE_MAX)
			say_error((struct place){ source, unclosed }, NULL, "'%c' is not closed",
				  source->text[unclosed]);
		else
			good = statement_guard(read_statement, &p);
		if (good)
			continue;
		if (unclosed == SIZE_MAX)
			take_unfinished_lines(&p);
		position = p.lexer.end + 1;
		declare_what_failed(&p, from);
	}
	struct place end = place_end(source);
	if (!own->name)
		say_error(end.offset ? end : (struct place){ source, 0 }, "a spec begins with its name: model NAME",
			  source->length ? "there is no statement in this file" : "the file is empty");
}

struct spec *parse_whole(const struct source *source, const struct part_reader *reader)
{
	struct spec *spec = NEW(struct spec);
	spec->source = source;
	spec->reader = reader;
	spec->last = &spec->first;
	spec->bucket = ARRAY(struct symbol *, BUCKETS);
	spec->end = place_end(source);
	parse_statements(spec, spec, NULL, source);
	return spec;
}

struct argument {
	struct parser parser;
	struct node *value, **over; /* over: behind the name of a scheme */
};

static void read_argument(void *context)
{
	struct argument *argument = context;
	struct parser *p = &argument->parser;
	p->token = lex_next(&p->lexer);
	p->end = p->token.at;
	struct node *value = argument->over ? take_order(p, argument->over) : read_expression(p);
	expect_end(p);
	argument->value = value;
}

struct node *parse_scheme_order(struct spec *spec, const struct source *source, size_t from, struct node **over)
{
	struct argument argument = { .parser = { .spec = spec, .own = spec }, .over = over };
	argument.parser.lexer = (struct lexer){ source, from, source->length, spec->uses, false };
	statement_guard(read_argument, &argument);
	return argument.value;
}

struct node *parse_argument(struct spec *spec, const struct source *source, size_t from)
{
	return parse_scheme_order(spec, source, from, NULL);
}

struct listing {
	struct parser parser;
	struct mode_list list;
};

static void read_listing(void *context)
{
	struct listing *listing = context;
	take(&listing->parser);                 /* the first token, before which there is none */
	listing->list = take_modes(&listing->parser);
}

struct mode_list parse_mode_list(struct spec *spec, const struct source *source)
{
	struct listing listing = { .parser = { .spec = spec, .lexer = { source, 0, source->length } } };
	const struct mode_list none = { .count = 0 };
	return statement_guard(read_listing, &listing) ? listing.list : none;
}
