/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions of generated C to operations. */
#include "run/run.h"

#include <string.h>

static const struct operation *read_unary(struct code *c);
static const struct operation *read_conditional(struct code *c);

static const struct operation *sure(const struct code *c, const struct operation *o)
{
	if (!o)
		not_run(c, "an operation of an unknown kind");
	return o;
}

/* ---- names and calls ---- */

/* A table is filled when it is first named; what fills it is constant, and runs at once. */
static const struct operation *named_variable(struct code *c, struct entity *e)
{
	if (!e->at || e->filled) {
		struct acts acts = { true, 0, NULL };
		int here = c->here, filled = e->filled;
		struct entity *newest = c->newest;
		e->filled = 0;
		if (e->type->count != -1)
			e->at = allocate(1, e->type->size + 1);
		if (filled) {
			c->here = filled;
			c->newest = c->outside;
			e->at = read_filling(c, &acts, &e->type, e->at);
			c->newest = newest;
		}
		c->here = here;
		for (int i = 0; i < acts.count; i++)
			acts.list[i]->go.act(acts.list[i]);
	}
	return stored_at(e->type, e->at);
}

struct called { int count; bool calls; const struct operation *argument[16]; };

static struct called read_arguments(struct code *c)
{
	struct called called = { 0 };
	int before = c->calls;
	need(c, '(');
	while (!take_mark(c, ')')) {
		if (called.count == 16)
			not_run(c, "too many arguments");
		called.argument[called.count++] = read_assignment(c);
		take_mark(c, ',');
	}
	called.calls = c->calls != before;
	c->calls++;
	return called;
}

/* Arguments are stored where the parameters are, the body runs, and its result is where that is. Where one of them is a
 * call too, all are found before one is stored: f(x, f(y)) has one place for both. */
static void store_arguments(struct code *c, struct acts *acts, const struct entity *e, const struct called *called)
{
	for (int i = 0; i < called->count; i++) {
		struct entity *p = e->parameter[i];
		p->shared = called->calls ? allocate(1, p->type->size) : p->at;
		add_act(acts, act_evaluate(sure(c, assigned(stored_at(p->type, p->shared), called->argument[i]))));
	}
	for (int i = 0; i < called->count && called->calls; i++) {
		const struct entity *p = e->parameter[i];
		const struct operation *from = value_of(stored_at(p->type, p->shared));
		add_act(acts, act_evaluate(assigned(stored_at(p->type, p->at), from)));
	}
}

static const struct operation *call_function(struct code *c, struct entity *e, const struct called *called)
{
	struct acts acts = { false, 0, NULL };
	if (!e->body || called->count != e->parameters)
		not_run(c, "a call of what is not there");
	if (!e->act)
		e->act = c->body(c, e);
	store_arguments(c, &acts, e, called);
	add_act(&acts, e->act);
	const struct operation *act = act_list(acts.count, acts.list);
	if (e->type->kind == CTYPE_VOID)
		return act_body(act);
	return in_sequence(act, value_of(stored_at(e->type, e->result)));
}

static const struct operation *call(struct code *c, const char *name)
{
	struct entity *e = entity_find(c, name);
	const struct library_function *f = library_function(name);
	const struct called called = read_arguments(c);
	if (strcmp(name, "UINT64_C") == 0 && called.count == 1)
		return converted(called.argument[0], &ctype_wide);
	if (strcmp(name, "INT64_C") == 0 && called.count == 1)
		return converted(called.argument[0], &ctype_long);
	if (e && e->kind == ENTITY_FUNCTION)
		return call_function(c, e, &called);
	if (!f)
		not_run(c, format("%s is called, which is not known", name));
	const struct entity *structure = f->structure ? entity_find(c, f->structure) : NULL;
	return sure(c, library_call(f, structure ? structure->type : NULL, called.count, called.argument));
}

static const struct operation *read_name(struct code *c)
{
	const char *name = take_name(c);
	if (is_next(c, '('))
		return call(c, name);
	if (strcmp(name, "NULL") == 0)
		return converted(number_whole(&ctype_int, 0), pointer_to(&ctype_void));
	struct entity *e = entity_find(c, name);
	if (e && e->kind == ENTITY_NUMBER)
		return number_whole(&ctype_int, e->number);
	if (!e || e->kind != ENTITY_VARIABLE)
		not_run(c, format("%s is not known", name));
	return named_variable(c, e);
}

static const struct operation *read_number(struct code *c)
{
	const struct lexeme *l = peek(c);
	c->here++;
	if (l->real)
		return number_real(l->single ? &ctype_float : &ctype_double, l->x);
	return number_whole(l->wide ? (l->positive ? &ctype_wide : &ctype_long) : l->positive ? &ctype_unsigned
											       : &ctype_int,
			    (int64_t)l->n);
}

/* ---- from the innermost out ---- */

static const struct operation *read_primary(struct code *c)
{
	if (peek(c)->kind == LEXEME_NUMBER)
		return read_number(c);
	if (peek(c)->kind == LEXEME_NAME)
		return read_name(c);
	need(c, '(');
	const struct operation *o = read_operation(c);
	need(c, ')');
	return o;
}

static const struct operation *member_of(struct code *c, const struct operation *where)
{
	const struct ctype *type = where->type->of;
	const char *name = take_name(c);
	for (int i = 0; type && i < type->members; i++)
		if (strcmp(type->member[i].name, name) == 0)
			return stored_where(type->member[i].type, where, type->member[i].offset);
	not_run(c, format("no member %s", name));
}

static const struct operation *read_postfix(struct code *c)
{
	const struct operation *o = read_primary(c);
	for (;;) {
		if (take_mark(c, '[')) {
			const struct operation *index = value_of(read_operation(c));
			need(c, ']');
			o = sure(c, element_of(value_of(o), index));
		} else if (take_mark(c, '.')) {
			o = member_of(c, place_of(o));
		} else if (take_mark(c, MARK2('-', '>'))) {
			o = member_of(c, value_of(o));
		} else if (is_next(c, MARK2('+', '+')) || is_next(c, MARK2('-', '-'))) {
			o = sure(c, stepped(o, is_next(c, MARK2('+', '+')) ? 1 : -1, true));
			c->here++;
		} else {
			return o;
		}
	}
}

static const struct operation *read_cast(struct code *c)
{
	struct declared d = read_declarator(c, read_type(c));
	need(c, ')');
	const struct operation *o = read_unary(c);
	if (!o->type)                                           /* (void) of a call that has no value */
		return o;
	return sure(c, converted(value_of(o), d.type));
}

static const struct operation *read_size(struct code *c)
{
	need(c, '(');
	if (!is_type_next(c))
		not_run(c, "sizeof something else than a type");
	struct declared d = read_declarator(c, read_type(c));
	need(c, ')');
	return number_whole(&ctype_wide, (int64_t)d.type->size);
}

static const struct operation *read_unary(struct code *c)
{
	static const char signs[] = "-+!~";
	for (const char *sign = signs; *sign; sign++)
		if (take_mark(c, MARK(*sign)))
			return sure(c, negated(MARK(*sign), value_of(read_unary(c))));
	if (take_mark(c, '*')) {
		const struct operation *o = value_of(read_unary(c));
		return sure(c, element_of(o, number_whole(&ctype_int, 0)));
	}
	if (take_mark(c, '&'))
		return place_of(read_unary(c));
	for (int by = -1; by <= 1; by += 2)
		if (take_mark(c, by > 0 ? MARK2('+', '+') : MARK2('-', '-')))
			return sure(c, stepped(read_unary(c), by, false));
	if (take_keyword(c, "sizeof"))
		return read_size(c);
	if (is_next(c, '(')) {
		c->here++;
		if (is_type_next(c))
			return read_cast(c);
		c->here--;
	}
	return read_postfix(c);
}

static int precedence(const struct lexeme *l)
{
	static const struct { unsigned mark; int precedence; } table[] = {
		{ MARK('*'), 10 }, { MARK('/'), 10 }, { MARK('%'), 10 }, { MARK('+'), 9 }, { MARK('-'), 9 },
		{ MARK2('<', '<'), 8 }, { MARK2('>', '>'), 8 }, { MARK('<'), 7 }, { MARK('>'), 7 },
		{ MARK2('<', '='), 7 }, { MARK2('>', '='), 7 }, { MARK2('=', '='), 6 }, { MARK2('!', '='), 6 },
		{ MARK('&'), 5 }, { MARK('^'), 4 }, { MARK('|'), 3 }, { MARK2('&', '&'), 2 }, { MARK2('|', '|'), 1 },
	};
	for (size_t i = 0; i < sizeof table / sizeof *table; i++)
		if (l->kind == LEXEME_MARK && l->mark == table[i].mark)
			return table[i].precedence;
	return 0;
}

static const struct operation *read_binary(struct code *c, int lowest)
{
	const struct operation *o = read_unary(c);
	for (int p = precedence(peek(c)); p >= lowest; p = precedence(peek(c))) {
		unsigned mark = peek(c)->mark;
		c->here++;
		const struct operation *b = value_of(read_binary(c, p + 1));
		o = sure(c, combined(mark, value_of(o), b));
	}
	return o;
}

static const struct operation *read_conditional(struct code *c)
{
	const struct operation *o = read_binary(c, 1);
	if (!take_mark(c, '?'))
		return o;
	const struct operation *a = value_of(read_operation(c));
	need(c, ':');
	return sure(c, chosen(value_of(o), a, value_of(read_conditional(c))));
}

/* += and the like: a sum, then stored */
static unsigned mark_of_change(const struct lexeme *l)
{
	static const char signs[] = "+-*/%&|^";
	if (l->kind != LEXEME_MARK)
		return 0;
	for (const char *sign = signs; *sign; sign++)
		if (l->mark == MARK2(*sign, '='))
			return MARK(*sign);
	return l->mark == MARK3('<', '<', '=')	 ? MARK2('<', '<')
	       : l->mark == MARK3('>', '>', '=') ? MARK2('>', '>')
						 : 0;
}

static const struct operation *read_changing(struct code *c)
{
	const struct operation *o = read_conditional(c);
	unsigned mark = mark_of_change(peek(c));
	if (take_mark(c, '='))
		return sure(c, assigned(o, value_of(read_changing(c))));
	if (!mark)
		return o;
	c->here++;
	const struct operation *b = value_of(read_changing(c));
	return sure(c, assigned(o, sure(c, combined(mark, value_of(o), b))));
}

const struct operation *read_assignment(struct code *c)
{
	const struct operation *o = read_changing(c);
	return o->type ? value_of(o) : o;
}

const struct operation *read_operation(struct code *c)
{
	const struct operation *o = read_changing(c);
	while (take_mark(c, ',')) {
		const struct operation *a = o->type ? act_evaluate(value_of(o)) : o;
		o = read_changing(c);
		if (!o->type)
			not_run(c, "a comma before what has no value");
		o = in_sequence(a, value_of(o));
	}
	return o;
}

int64_t read_constant(struct code *c)
{
	const struct operation *o = value_of(read_conditional(c));
	if (!o->type || o->type->kind != CTYPE_WHOLE)
		not_run(c, "no whole number");
	return o->go.whole(o);
}

/* ---- what fills a variable ---- */

void add_act(struct acts *acts, const struct operation *act)
{
	ENLARGE(acts->list, (size_t)acts->count + 1);
	acts->list[acts->count++] = act;
}

static void fill_one(struct code *c, struct acts *acts, const struct ctype *type, char *to);

/* { a, b, ... }; a list without brackets fills what is inside it too */
static void fill_list(struct code *c, struct acts *acts, const struct ctype *type, char *to)
{
	bool bracket = take_mark(c, '{');
	int parts = type->kind == CTYPE_ARRAY ? type->count : type->members;
	for (int i = 0; i < parts && !is_next(c, '}'); i++) {
		bool array = type->kind == CTYPE_ARRAY;
		fill_one(c, acts, array ? type->of : type->member[i].type,
			 to + (array ? (size_t)i * type->of->size : type->member[i].offset));
		if (!bracket && i + 1 == parts)
			break;
		if (!take_mark(c, ','))
			break;
	}
	if (bracket)
		need(c, '}');
}

/* Most of what fills tables */
static bool fill_number(struct code *c, const struct ctype *type, char *to)
{
	bool minus = is_next(c, '-');
	const struct lexeme *l = peek(c) + minus;
	if (type->kind != CTYPE_REAL || l->kind != LEXEME_NUMBER || !l->real || !strchr(",}", l[1].text[0]))
		return false;
	c->here += 1 + minus;
	if (type->size == sizeof(double))
		*(double *)(void *)to = minus ? -l->x : l->x;
	else
		*(float *)(void *)to = (float)(minus ? -l->x : l->x);
	return true;
}

static void fill_one(struct code *c, struct acts *acts, const struct ctype *type, char *to)
{
	if (acts->now && fill_number(c, type, to))
		return;
	if (peek(c)->kind == LEXEME_STRING) {                   /* a name, which nothing here reads */
		c->here++;
		return;
	}
	if (type->kind == CTYPE_ARRAY || (type->kind == CTYPE_STRUCT && is_next(c, '{'))) {
		fill_list(c, acts, type, to);
		return;
	}
	bool bracket = take_mark(c, '{');
	add_act(acts, act_evaluate(sure(c, assigned(stored_at(type, to), read_assignment(c)))));
	if (bracket)
		need(c, '}');
}

/* How many parts a list in brackets has, from its outermost commas */
static int count_parts(const struct code *c)
{
	int depth = 0, parts = 0;
	for (int i = c->here; i < c->lexemes.count; i++) {
		const struct lexeme *l = &c->lexemes.list[i];
		bool mark = l->kind == LEXEME_MARK;
		if (mark && (l->mark == '}' || l->mark == ')') && --depth == 0)
			return parts + (c->lexemes.list[i - 1].mark != ',' && i > c->here + 1);
		if (mark && (l->mark == '{' || l->mark == '('))
			depth++;
		parts += mark && l->mark == ',' && depth == 1;
	}
	return parts;
}

void *read_filling(struct code *c, struct acts *acts, const struct ctype **type, void *to)
{
	if ((*type)->kind == CTYPE_ARRAY && (*type)->count == -1) {
		*type = array_of((*type)->of, count_parts(c));
		to = allocate(1, (*type)->size + 1);
	}
	if (is_next(c, '{') && !acts->now)
		add_act(acts, act_clear(to, (*type)->size));
	fill_one(c, acts, *type, to);
	return to;
}
