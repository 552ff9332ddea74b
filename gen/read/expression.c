/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tokens to nodes: names and expressions. The production stands above each function that reads it; names are resolved
 * as they are read, since they are declared before use. */
#include "read/parser.h"

#include <string.h>

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
	RATIONAL number = ZERO;
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
	expect_op(p, "]", "']'");
	if (p->token.kind == TOKEN_OPERATOR && p->token.op[0] == '\'')
		*primes = (int)take(p).length;
	return component;
}

void check_component(const struct symbol *symbol, int component, struct place at)
{
	if (component == 0)
		return;
	if (symbol->kind == SYMBOL_LET || symbol->kind == SYMBOL_MATRIX)
		error(at, format("dot([0; 1], %s) is the second of two", symbol->name),
		      "only vector coordinates have components, and '%s' is a %s", symbol->name, symbol_kind(symbol));
	if (symbol->kind != SYMBOL_COORD || symbol->length == 0)
		error(at, "only vector coordinates have components", "'%s' is not a vector", symbol->name);
	if (component > symbol->length)
		error(at, NULL, "'%s' has %d components", symbol->name, symbol->length);
}

/* ---- units ---- */

/* x - 2 "mm": of the 2 or of all? Both may be; of a factor or a power only the one can be. */
static void check_last_number(const struct node *value, struct place at)
{
	const struct node *last = value;
	while ((last->kind == NODE_SUM || last->kind == NODE_CHOOSE) &&
	       last->child[last->children - 1]->end.offset == last->end.offset)
		last = last->child[last->children - 1];
	if (last->kind != NODE_NUMBER || last == value || is_plain_number(value))
		return;
	const char *number = text_between(last->start, last->end);
	size_t length = strcspn(at.source->text + at.offset + 1, "\"");
	const char *unit = format("\"%.*s\"", (int)length, at.source->text + at.offset + 1);
	const char *all = text_between(value->start, value->end);
	error(at, format("brackets say which: (%s %s), or (%s) %s", number, unit, all, unit),
	      "is this the unit of '%s' or of all before it?", number);
}

const struct unit *take_unit(struct parser *p, const struct node *value)
{
	if (p->token.kind != TOKEN_STRING)
		return NULL;
	if (value)
		check_last_number(value, p->token.at);
	struct token token = take(p);
	struct place inside = { token.at.source, token.at.offset + 1 };
	p->spec->units.written = true;
	return unit_parse(inside, token.at.source->text + inside.offset, token.length - 2);
}

/* quantity: expression [ unit ] */
struct node *read_quantity(struct parser *p)
{
	struct node *value = read_expression(p);
	return with_unit(value, take_unit(p, value));
}

/* ---- names ---- */

#define NO_ACCELERATION "what a component is given may use coordinates and their first derivatives"

/* Its primes give it the dimension of the let's over time: a number in a factor of t has none. */
static struct node *inlined_derivative(struct node *derivative, const struct symbol *let, int primes, struct place at,
				       struct place end)
{
	struct node *node = inlined(derivative, at, end);
	node->let = let;
	node->primes = primes;
	return node;
}

/* What a name stands for, where that is an expression: an output of a part, the slope of a connected input */
static struct node *read_inlined(struct parser *p, const struct symbol *symbol, struct token token)
{
	if (symbol->kind == SYMBOL_LET) {
		struct node *slope = slope_of(symbol->value, symbol->value->start);
		if (has_acceleration(slope))
			error(symbol->value->start, NULL, "its slope is read, and holds an acceleration");
		return inlined_derivative(slope, symbol, 1, token.at, p->end);
	}
	if (token.primes > 0)
		error(token.at, "only coordinates have derivatives", "output '%s' has no derivative", token.name);
	if (symbol->peak)
		error(token.at, format("it is one by itself: output %s", token.name),
		      "a peak is an output, and no part of an expression");
	if (p->no_acceleration && has_acceleration(symbol->value))
		error(token.at, NO_ACCELERATION, "an acceleration is given to a component");
	return inlined(symbol->value, token.at, p->end);
}

/* x(0) = 2 in a statement by itself, as textbooks give an initial value */
static bool is_initial_value(const struct parser *p, struct token token)
{
	const char *text = p->lexer.source->text, *at = text + p->token.at.offset;
	size_t zero = 1 + strspn(at + 1, " \t0.");
	return token.at.offset == p->statement && at[zero] == ')' && zero > 1 &&
	       at[zero + 1 + strspn(at + zero + 1, " \t")] == '=';
}

/* delayed: NAME { ' } ( expression ), an input as it was: an input by itself, which the text does not declare */
static struct symbol *read_delay(struct parser *p, const struct symbol *symbol, struct token token)
{
	struct spec *spec = p->spec;
	if (symbol->kind == SYMBOL_COORD && is_initial_value(p, token))
		error(token.at, init_note(p, token),
		      "an initial value stands in a statement 'init'");
	if (symbol->kind == SYMBOL_COORD)
		error(token.at,
		      format("an input can take its place, to which the caller gives what %s was", token.name),
		      "a delay of a coordinate is not built: '%s'", token.name);
	nest(p, token.at);
	take(p);
	struct symbol *delayed = NEW(struct symbol);
	*delayed = (struct symbol){ .kind = SYMBOL_INPUT,
				    .at = token.at,
				    .statement = p->statement,
				    .part = p->part,
				    .used = true,
				    .hold = symbol->hold,
				    .delayed = symbol,
				    .unit = symbol->unit,
				    .unit_written = symbol->unit_written,
				    .when = read_quantity(p) };
	expect_op(p, ")", "')' or an operator");
	p->nesting--;
	delayed->index = spec->count.inputs++;
	delayed->name = format("%s.delayed%d", symbol->name, ++spec->count.delays);
	add_symbol(spec, delayed);
	return delayed;
}

/* f', f'' of a let f: derivatives by its coordinates */
static struct node *read_derivative(const struct parser *p, const struct symbol *let, struct token token)
{
	struct node *derivative = let->value;
	for (int i = 0; i < token.primes; i++)
		derivative = slope_of(derivative, token.at);
	if (p->no_acceleration && has_acceleration(derivative))
		error(token.at, NO_ACCELERATION, "an acceleration is given to a component");
	return inlined_derivative(derivative, let, token.primes, token.at, p->end);
}

/* ---- energy, power and momentum(q) in outputs: lets, whose values fill_totals() gives ---- */

static struct symbol *total_symbol(struct parser *p, int kind, struct token name, struct node *coord)
{
	struct spec *spec = p->spec;
	const struct symbol *of = coord ? coord->symbol : NULL;
	const char *component = coord && coord->component ? format("[%d]", coord->component) : "";
	struct symbol *let = NEW(struct symbol);
	*let = (struct symbol){ .kind = SYMBOL_LET, .at = name.at, .statement = p->statement,
				.name = of ? format("momentum(%s%s)", of->name, component) : name.name,
				.index = spec->count.lets++, .number = ++spec->count.symbols };
	*spec->last = let;                      /* no other statement finds it by its name */
	spec->last = &let->next;
	*MORE(spec->lagrange.total, spec->lagrange.totals) = (struct total){ kind, let, coord };
	return let;
}

static struct symbol *read_total(struct parser *p, struct token name)
{
	static const char *const known[] = { "energy", "power", "momentum" };
	int kind = 0;
	struct node *coord = NULL;
	while (kind <= TOTAL_MOMENTUM && strcmp(name.name, known[kind]) != 0)
		kind++;
	if (!p->output || kind > TOTAL_MOMENTUM || name.primes || is_op(p, "(") != (kind == TOTAL_MOMENTUM))
		return NULL;
	if (p->part)
		error(name.at, "the assembly has such outputs", "the %s is that of all components together", name.name);
	if (kind == TOTAL_MOMENTUM) {
		take(p);
		coord = read_coordinate(p, false);
		expect_op(p, ")", "')'");
	}
	return total_symbol(p, kind, name, coord);
}

/* An output that is nothing but one of them */
static bool is_total(const struct symbol *symbol)
{
	const struct node *node = symbol->kind == SYMBOL_OUTPUT ? symbol->value : NULL;
	while (node && node->kind == NODE_PRODUCT)      /* in another unit */
		node = node->child[0];
	return node && node->kind == NODE_NAME && node->symbol->kind == SYMBOL_LET && !node->symbol->value;
}

/* name: NAME { ' } | NAME [ NUMBER ] { ' } */
struct node *resolve_name(struct parser *p, struct token token)
{
	int component = read_component(p, &token.primes, false);
	struct symbol *symbol = find_symbol(p, token.name);
	if (component == 0 && (!symbol || is_total(symbol)))
		symbol = read_total(p, token);
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
	if (token.primes > 0 && symbol->kind == SYMBOL_LET && symbol->value && component == 0)
		return read_derivative(p, symbol, token);
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
		error(token.at, NO_ACCELERATION, "an acceleration is given to a component");
	struct node *node = node_new(NODE_NAME, token.at);
	/* of others a bracket behind them is a missing operator */
	if (is_op(p, "(") && (symbol->kind == SYMBOL_COORD || symbol->kind == SYMBOL_INPUT))
		symbol = read_delay(p, symbol, token);
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
	int wanted = call->function == FN_ATAN2 || call->function == FN_DOT ? 2 : three ? 3 : 1;
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
		error(name.at, format("%s(3*t)", name.name), "'%s' is a function: expected '(' after it, found %s",
		      name.name, token_text(p->token));
	nest(p, name.at);
	struct place separator = take(p).at;
	add_child(call, read_quantity(p), false, separator);
	while (is_op(p, ",") || is_op(p, ";")) {
		bool semicolon = is_op(p, ";");
		if (semicolon != (function == FN_TABLE && call->children % 2 == 1))
			unexpected(p,
				   function == FN_TABLE ? "the points of a table as x; x0, y0; x1, y1" : "',' or ')'");
		separator = take(p).at;
		add_child(call, read_quantity(p), false, separator);
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
	struct node *inner = read_quantity(p);
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
		add_child(node, read_quantity(p), false, separator);
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
	if (p->token.kind == TOKEN_NUMBER || (p->token.kind == TOKEN_NAME && !stray_unit_note(p)))
		error(p->token.at, "the cells of a row are separated by commas, rows by semicolons: [1, 0; 0, 1]",
		      "expected ',', ';' or ']', found %s", token_text(p->token));
	expect_op(p, "]", "',', ';' or ']'");
	p->nesting--;
	node->end = p->end;
	return node;
}

/* At a bracket: dot(x) is meant for a derivative. */
bool has_two_arguments(const struct parser *p)
{
	const char *text = p->token.at.source->text + p->token.at.offset;
	int depth = 0;
	for (; *text && *text != '\n'; text++) {
		depth += (*text == '(' || *text == '[') - (*text == ')' || *text == ']');
		if (depth <= 1 && (depth == 0 || *text == ','))
			return depth == 1;
	}
	return false;
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
	function = vector_function_of(name.name);
	if (function != FN_NONE && is_op(p, "(") && !name.primes && !find_symbol(p, name.name) &&
	    (function != FN_DOT || has_two_arguments(p)))
		return read_call(p, name, function);
	bool time = strcmp(name.name, "t") == 0;
	if (time || strcmp(name.name, "pi") == 0) {
		if (name.primes > 0)
			error(name.at, NULL, "'%s' has no derivative", name.name);
		struct node *node = node_new(time ? NODE_TIME : NODE_PI, name.at);
		node->end = p->end;
		return node;
	}
	if (is_reserved(name.name) && !find_symbol(p, name.name))   /* else broken: reported where it is declared */
		error(name.at, NULL, "'%s' is a reserved word", name.name);
	struct node *node = resolve_name(p, name);
	bool input = node->symbol && node->symbol->kind == SYMBOL_INPUT;
	return input ? convert_unit(node, node->symbol->unit, false) : node;
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
	struct node *right = read_sum(p);
	add_child(node, with_unit(right, take_unit(p, right)), false, operator);
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

bool take_word(struct parser *p, const char *word)
{
	if (p->token.kind != TOKEN_NAME || p->token.primes > 0 || strcmp(p->token.name, word) != 0)
		return false;
	take(p);
	return true;
}

void expect_word(struct parser *p, const char *word)
{
	if (take_word(p, word))
		return;
	if (p->token.kind == TOKEN_NAME && p->token.primes == 0 && nearest_name(p->token.name, 1, &word))
		error(p->token.at, format("did you mean '%s'?", word), "expected '%s', found '%s'", word,
		      p->token.name);
	const char *form = statement_form(p);
	if (form)
		error(p->token.at, form, "expected '%s', found %s", word, token_text(p->token));
	unexpected(p, format("'%s'", word));
}

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
