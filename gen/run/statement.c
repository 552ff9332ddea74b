/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statements of generated C to acts. */
#include "run/run.h"

static const struct operation *read_statement(struct code *c);

static const struct operation *condition_of(struct code *c, const struct operation *o)
{
	const struct operation *condition = as_condition(value_of(o));
	if (!condition)
		not_run(c, "a condition of an unknown kind");
	return condition;
}

static const struct operation *in_brackets(struct code *c)
{
	need(c, '(');
	const struct operation *o = condition_of(c, read_operation(c));
	need(c, ')');
	return o;
}

static const struct operation *nothing(void)
{
	return act_list(0, NULL);
}

/* ---- declarations ---- */

static void read_local(struct code *c, struct acts *acts, struct declared d, bool once)
{
	struct acts at_once = { true, 0, NULL };
	if (!d.name || d.function)
		not_run(c, "a declaration of an unknown kind");
	struct entity *e = entity_new(c, ENTITY_VARIABLE, d.name, d.type);
	if (d.type->count != -1)
		e->at = allocate(1, d.type->size + 1);
	if (!take_mark(c, '='))
		return;
	e->at = read_filling(c, once ? &at_once : acts, &e->type, e->at);
	for (int i = 0; i < at_once.count; i++)
		at_once.list[i]->go.act(at_once.list[i]);
}

static const struct operation *read_locals(struct code *c)
{
	struct acts acts = { false, 0, NULL };
	bool once = is_word_next(c, "static");
	const struct ctype *type = read_type(c);
	do
		read_local(c, &acts, read_declarator(c, type), once);
	while (take_mark(c, ','));
	need(c, ';');
	return act_list(acts.count, acts.list);
}

/* ---- statements ---- */

static const struct operation *read_block(struct code *c)
{
	struct acts acts = { false, 0, NULL };
	struct entity *newest = c->newest;
	need(c, '{');
	while (!take_mark(c, '}'))
		add_act(&acts, read_statement(c));
	c->newest = newest;
	return act_list(acts.count, acts.list);
}

static const struct operation *read_if(struct code *c)
{
	const struct operation *condition = in_brackets(c), *yes = read_statement(c);
	return act_if(condition, yes, take_keyword(c, "else") ? read_statement(c) : NULL);
}

static const struct operation *read_while(struct code *c)
{
	const struct operation *condition = in_brackets(c);
	return act_loop(condition, NULL, read_statement(c), false);
}

static const struct operation *read_do(struct code *c)
{
	const struct operation *body = read_statement(c);
	if (!take_keyword(c, "while"))
		not_run(c, "no while");
	const struct operation *condition = in_brackets(c);
	need(c, ';');
	return act_loop(condition, NULL, body, true);
}

static const struct operation *read_for(struct code *c)
{
	struct entity *newest = c->newest;
	const struct operation *first = nothing(), *condition = NULL, *next = NULL;
	need(c, '(');
	if (is_type_next(c)) {
		first = read_locals(c);
	} else {
		if (!is_next(c, ';'))
			first = act_evaluate(read_assignment(c));
		while (take_mark(c, ',')) {
			const struct operation *two[] = { first, act_evaluate(read_assignment(c)) };
			struct acts both = { false, 0, NULL };
			add_act(&both, two[0]);
			add_act(&both, two[1]);
			first = act_list(both.count, both.list);
		}
		need(c, ';');
	}
	if (!is_next(c, ';'))
		condition = condition_of(c, read_operation(c));
	need(c, ';');
	if (!is_next(c, ')'))
		next = act_evaluate(value_of(read_operation(c)));
	need(c, ')');
	struct acts acts = { false, 0, NULL };
	add_act(&acts, first);
	add_act(&acts, act_loop(condition, next, read_statement(c), false));
	c->newest = newest;
	return act_list(acts.count, acts.list);
}

static const struct operation *read_switch(struct code *c)
{
	struct acts acts = { false, 0, NULL };
	struct switch_case *of = NULL;
	int cases = 0;
	struct entity *newest = c->newest;
	const struct operation *value = in_brackets(c);
	need(c, '{');
	while (!take_mark(c, '}')) {
		bool others = take_keyword(c, "default");
		if (!others && !take_keyword(c, "case")) {
			add_act(&acts, read_statement(c));
			continue;
		}
		ENLARGE(of, (size_t)cases + 1);
		of[cases++] = (struct switch_case){ others, others ? 0 : read_constant(c), acts.count };
		need(c, ':');
	}
	c->newest = newest;
	return act_switch(value, act_list(acts.count, acts.list), cases, of);
}

static const struct operation *read_return(struct code *c)
{
	if (take_mark(c, ';'))
		return act_leave(RETURNS);
	const struct operation *value = read_assignment(c);
	need(c, ';');
	if (!value->type || c->result->kind == CTYPE_VOID)
		return act_return(act_evaluate(value));
	const struct operation *store = assigned(stored_at(c->result, c->result_at), value);
	if (!store)
		not_run(c, "a result of an unknown kind");
	return act_return(act_evaluate(store));
}

static const struct operation *read_statement(struct code *c)
{
	if (is_next(c, '{'))
		return read_block(c);
	if (take_mark(c, ';'))
		return nothing();
	if (take_keyword(c, "if"))
		return read_if(c);
	if (take_keyword(c, "for"))
		return read_for(c);
	if (take_keyword(c, "while"))
		return read_while(c);
	if (take_keyword(c, "do"))
		return read_do(c);
	if (take_keyword(c, "switch"))
		return read_switch(c);
	if (take_keyword(c, "return"))
		return read_return(c);
	if (is_type_next(c))
		return read_locals(c);
	bool breaks = take_keyword(c, "break"), continues = !breaks && take_keyword(c, "continue");
	const struct operation *act = breaks	  ? act_leave(BREAKS)
				      : continues ? act_leave(CONTINUES)
						  : act_evaluate(read_assignment(c));
	if (!breaks && !continues)
		while (take_mark(c, ',')) {
			struct acts both = { false, 0, NULL };
			add_act(&both, act);
			add_act(&both, act_evaluate(read_assignment(c)));
			act = act_list(both.count, both.list);
		}
	need(c, ';');
	return act;
}

const struct operation *read_body(struct code *c, struct entity *function)
{
	struct entity *newest = c->newest;
	const struct ctype *result = c->result;
	void *result_at = c->result_at;
	int here = c->here;
	c->newest = c->outside;
	for (int i = 0; i < function->parameters; i++) {
		function->parameter[i]->next = c->newest;
		c->newest = function->parameter[i];
	}
	c->result = function->type;
	c->result_at = function->result = allocate(1, function->type->size + 1);
	c->here = function->body;
	const struct operation *act = read_block(c);
	c->here = here;
	c->result = result;
	c->result_at = result_at;
	c->newest = newest;
	return act;
}
