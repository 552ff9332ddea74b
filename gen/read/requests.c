/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statements that say how an assembly is stepped: bounds, tolerances, modes, the operator, tunable params, needs. */
#include "read/parser.h"

#include <string.h>

/* ---- bounds of states ---- */

/* One text gives a state one. What a part's own text gives, the assembly gives again. */
static struct state_bound read_bound_name(struct parser *p, int count, const struct state_bound *list, const char *what)
{
	struct state_bound bound = { .at = p->token.at, .part = p->part };
	struct token name = read_state_name(p, &bound.coord, &bound.component, what);
	bound.primes = name.primes;
	for (int i = 0; i < count; i++) {
		const struct state_bound *other = &list[i];
		if (other->coord == bound.coord && other->primes == bound.primes && other->part == bound.part &&
		    (!other->component || !bound.component || other->component == bound.component))
			error(bound.at, NULL, "the %s of %s is given already", what,
			      text_between(bound.at, p->end));
	}
	return bound;
}

static void add_bound(struct state_bound **list, int *count, struct state_bound bound)
{
	*MORE(*list, *count) = bound;
}

/* interval: [ expression , expression ]; `example` stands before one in messages */
static void read_interval(struct parser *p, const char *example, struct node **low, struct node **high)
{
	expect_op(p, "[", format("'[': %s in [0, 1]", example));
	*low = read_quantity(p);
	expect_op(p, ",", format("',': %s in [0, 1]", example));
	*high = read_quantity(p);
	expect_op(p, "]", "']'");
}

/* range: range NAME [ ' ] in [ expression , expression ] { , ... } */
void read_range(struct parser *p)
{
	do {
		struct state_bound range = read_bound_name(p, p->spec->states.ranges, p->spec->states.range, "range");
		expect_word(p, "in");
		read_interval(p, "range x", &range.low, &range.high);
		add_bound(&p->spec->states.range, &p->spec->states.ranges, range);
	} while (take_op(p, ","));
	expect_end(p);
}

/* tolerance of NAME [ ' ] = expression { , ... } */
static void read_absolutes(struct parser *p)
{
	do {
		struct state_bound absolute = read_bound_name(p, p->own->request.absolutes, p->own->request.absolute_of,
							      "tolerance");
		expect_op(p, "=", "'='");
		absolute.low = read_quantity(p);
		add_bound(&p->own->request.absolute_of, &p->own->request.absolutes, absolute);
	} while (take_op(p, ","));
	expect_end(p);
}

/* tolerance: tolerance expression [ , absolute expression ] */
void read_tolerance(struct parser *p)
{
	struct place at = last_token(p, strlen("tolerance"));
	if (!find_symbol(p, "of") && take_word(p, "of")) {
		read_absolutes(p);
		return;
	}
	if (p->own->request.tolerance)
		error(at, NULL, "the tolerance is given already");
	p->own->request.tolerance = read_expression(p);
	if (take_op(p, ",")) {
		expect_word(p, "absolute");
		p->own->request.absolute = read_quantity(p);
	}
	expect_end(p);
}

/* substeps: substeps expression */
void read_substeps(struct parser *p)
{
	struct place at = last_token(p, strlen("substeps"));
	if (p->own->request.substeps)
		error(at, NULL, "the substeps are given already");
	p->own->request.substeps = read_expression(p);
	expect_end(p);
}

/* regions: regions cached expression */
void read_cached(struct parser *p)
{
	struct place at = last_token(p, strlen("regions"));
	if (p->own->request.cached)
		error(at, NULL, "how many regions are cached is given already");
	expect_word(p, "cached");
	p->own->request.cached = read_expression(p);
	expect_end(p);
}

/* events: events at most expression a step */
void read_events(struct parser *p)
{
	struct place at = last_token(p, strlen("events"));
	if (p->own->request.events)
		error(at, NULL, "the most events are given already");
	expect_word(p, "at");
	expect_word(p, "most");
	p->own->request.events = read_expression(p);
	expect_word(p, "a");
	expect_word(p, "step");
	expect_end(p);
}

/* expression { , expression } [ , ] [ without static ] */
struct mode_list take_modes(struct parser *p)
{
	struct mode_list list = { .at = p->token.at };
	do {
		if (list.count > 0 && (p->token.kind == TOKEN_END || p->token.kind == TOKEN_NAME))
			break;                  /* a comma at the end makes a list of one */
		*MORE(list.number, list.count) = read_expression(p);
		list.each = list.each || is_op(p, ",");
	} while (take_op(p, ","));
	list.without_static = take_word(p, "without");
	if (list.without_static && !take_word(p, "static"))
		unexpected(p, "'static'");
	expect_end(p);
	return list;
}

/* modes: modes expression { , expression } [ without static ] */
void read_modes(struct parser *p)
{
	struct place at = last_token(p, 5);
	if (p->own->modes.at.source)
		error(at, NULL, "the modes are given already");
	p->own->modes = take_modes(p);
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

static _Noreturn void refuse_fixed(struct place at, const char *what)
{
	error(at, "an operator fixes t, coordinates, their first derivatives and lets", "%s cannot be fixed", what);
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
		refuse_fixed(token.at, format("'%s'", token.name));
	if (symbol && symbol->kind != SYMBOL_COORD && symbol->kind != SYMBOL_LET)
		refuse_fixed(token.at, format("%s '%s'", symbol_kind(symbol), symbol->name));
	if (token.primes > 1 || (name && name->primes > 1))
		refuse_fixed(token.at, "an acceleration");
	for (int i = 0; i < spec->operators.fixeds; i++) {
		const struct fixed *other = &spec->operators.fixed[i];
		bool same = other->symbol == symbol && (!name || (other->primes == name->primes &&
			    (!other->component || !name->component || other->component == name->component)));
		if (same)
			error(token.at, NULL, "%s is fixed already", text_between(token.at, p->end));
	}
	struct fixed *fixed = MORE(spec->operators.fixed, spec->operators.fixeds);
	*fixed = (struct fixed){ .at = token.at, .end = p->end, .symbol = symbol };
	fixed->primes = name ? name->primes : 0;
	fixed->component = name ? name->component : 0;
	return fixed;
}

/* operator: operator [ number ] at NAME = expression { , ( NAME = expression | expression ) } */
void read_operator(struct parser *p)
{
	struct spec *spec = p->own;
	struct place at = last_token(p, 8);
	struct fixed *fixed = NULL;
	if (spec->operators.given)
		error(at, NULL, "the operator is given already");
	spec->operators.given = true;
	spec->operators.at = at;
	if (p->token.kind == TOKEN_NUMBER)
		spec->operators.count = read_expression(p);
	expect_word(p, "at");
	do {
		if (!fixed || names_definition(p)) {
			fixed = read_fixed_name(p);
			expect_op(p, "=", "'='");
		}
		*MORE(fixed->value, fixed->values) = read_quantity(p);
	} while (take_op(p, ","));
	expect_end(p);
}

/* ---- params that the target may change ---- */

/* tunable: tunable NAME { , NAME } */
void read_tunable(struct parser *p)
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
		if (symbol->tuning.tuned)
			error(token.at, NULL, "'%s' is tunable already", symbol->name);
		if (spec->tuned.count == LIMIT_TUNABLES)
			error(token.at, NULL, "more tunable params than the limit of %d", LIMIT_TUNABLES);
		struct tunable tunable = { token.at, symbol, NULL, NULL };
		if (take_word(p, "in"))
			read_interval(p, "tunable k", &tunable.low, &tunable.high);
		symbol->tuning.tuned = true;
		symbol->tuning.number = spec->tuned.count + 1;
		*MORE(spec->tuned.tunable, spec->tuned.count) = tunable;
	} while (take_op(p, ","));
	expect_end(p);
}

bool parse_tunables(struct spec *spec, const struct source *source)
{
	return parse_list(spec, source, read_tunable);
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
	input.most = read_quantity(p);
	return input;
}

/* need: need output within expression [ % ] until expression [ for |NAME| <= expression { , ... } ] */
void read_need(struct parser *p)
{
	enum { LIMIT_NEEDS = 1000 };
	struct need need = { .at = last_token(p, 4), .output_at = p->token.at };
	p->lexer.needs = true;
	need.output = read_output_name(p);
	expect_word(p, "within");
	need.bound = read_quantity(p);
	need.percent = take_op(p, "%");
	expect_word(p, "until");
	need.until = read_quantity(p);
	if (p->token.kind != TOKEN_END) {
		expect_word(p, "for");
		do {
			struct need_input input = read_need_input(p);
			for (int i = 0; i < need.inputs; i++)
				if (strcmp(need.input[i].name, input.name) == 0)
					error(input.at, NULL, "'%s' is bounded already", input.name);
			*MORE(need.input, need.inputs) = input;
		} while (take_op(p, ","));
	}
	expect_end(p);
	*MORE(p->own->required.need, p->own->required.needs) = need;
	if (p->own->required.needs == LIMIT_NEEDS + 1)
		error(need.at, "the strictest of an output is enough", "needs over the limit of %d", LIMIT_NEEDS);
	if (p->own->required.needs > LIMIT_NEEDS)
		abandon();                      /* reported once */
}

/* budget: budget expression instructions on TARGET [for the worst step]; a target has hyphens in its name */
void read_budget(struct parser *p)
{
	struct budget *budget = &p->own->required.budget;
	struct place at = last_token(p, 6);
	if (budget->instructions)
		error(at, NULL, "the budget is given already");
	struct node *instructions = read_expression(p);
	expect_word(p, "instructions");
	expect_word(p, "on");
	if (p->token.kind != TOKEN_NAME || p->token.primes > 0)
		unexpected(p, "a target: cortex-m4 or cortex-m0");
	*budget = (struct budget){ .at = at, .instructions = instructions, .target = p->token };
	const size_t from = p->token.at.offset;
	while (p->token.kind != TOKEN_END && !(p->token.kind == TOKEN_NAME && strcmp(p->token.name, "for") == 0))
		take(p);
	budget->target.name = text_between(budget->target.at, p->end);
	budget->target.length = p->end.offset - from;
	budget->worst = take_word(p, "for");
	if (budget->worst) {
		expect_word(p, "the");
		expect_word(p, "worst");
		expect_word(p, "step");
		expect_end(p);
	}
}
