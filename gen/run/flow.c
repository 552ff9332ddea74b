/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Statements that run. */
#include "run/run.h"

#include <string.h>

static const struct operation *new_act(struct operation o)
{
	struct operation *copy = NEW(struct operation);
	*copy = o;
	return copy;
}

static enum going evaluate_whole(const struct operation *o)
{
	o->a->go.whole(o->a);
	return GOES_ON;
}

static enum going evaluate_real(const struct operation *o)
{
	o->a->go.real(o->a);
	return GOES_ON;
}

static enum going evaluate_place(const struct operation *o)
{
	o->a->go.place(o->a);
	return GOES_ON;
}

/* A call of what returns nothing is an act already. */
const struct operation *act_evaluate(const struct operation *o)
{
	if (!o->type)
		return o;
	struct operation r = { .a = o };
	r.go.act = o->type->kind == CTYPE_REAL	  ? evaluate_real
		   : o->type->kind == CTYPE_WHOLE ? evaluate_whole
						  : evaluate_place;
	return new_act(r);
}

static enum going run_clear(const struct operation *o)
{
	memset(o->at, 0, (size_t)o->n);
	return GOES_ON;
}

const struct operation *act_clear(void *at, size_t size)
{
	return new_act((struct operation){ .go.act = run_clear, .at = at, .n = (int64_t)size });
}

static enum going run_list(const struct operation *o)
{
	for (int i = 0; i < o->count; i++) {
		enum going going = o->list[i]->go.act(o->list[i]);
		if (going != GOES_ON)
			return going;
	}
	return GOES_ON;
}

const struct operation *act_list(int count, const struct operation *const *list)
{
	return new_act((struct operation){ .go.act = run_list, .count = count, .list = list });
}

static enum going run_if(const struct operation *o)
{
	return o->a->go.whole(o->a) ? o->b->go.act(o->b) : o->c ? o->c->go.act(o->c) : GOES_ON;
}

const struct operation *act_if(const struct operation *condition, const struct operation *yes,
			       const struct operation *no)
{
	return new_act((struct operation){ .go.act = run_if, .a = condition, .b = yes, .c = no });
}

static enum going run_loop(const struct operation *o)
{
	for (bool first = o->n; first || !o->a || o->a->go.whole(o->a); first = false) {
		enum going going = o->b->go.act(o->b);
		if (going == BREAKS)
			break;
		if (going == RETURNS)
			return going;
		if (o->c)
			o->c->go.act(o->c);
	}
	return GOES_ON;
}

const struct operation *act_loop(const struct operation *condition, const struct operation *next,
				 const struct operation *body, bool late)
{
	return new_act((struct operation){ .go.act = run_loop, .a = condition, .b = body, .c = next, .n = late });
}

static enum going run_switch(const struct operation *o)
{
	const struct switch_case *of = o->at;
	const struct operation *list = o->b;
	int64_t value = o->a->go.whole(o->a);
	int from = list->count;
	for (int i = 0; i < o->count; i++)
		if (of[i].others)
			from = of[i].to;
	for (int i = 0; i < o->count; i++)
		if (!of[i].others && of[i].value == value)
			from = of[i].to;
	for (int i = from; i < list->count; i++) {
		enum going going = list->list[i]->go.act(list->list[i]);
		if (going != GOES_ON)
			return going == BREAKS ? GOES_ON : going;
	}
	return GOES_ON;
}

const struct operation *act_switch(const struct operation *value, const struct operation *list, int cases,
				   const struct switch_case *of)
{
	struct switch_case *copy = ARRAY(struct switch_case, (size_t)cases + 1);
	for (int i = 0; i < cases; i++)
		copy[i] = of[i];
	return new_act((struct operation){ .go.act = run_switch, .a = value, .b = list, .at = copy, .count = cases });
}

static enum going run_leave(const struct operation *o)
{
	return (enum going)o->n;
}

const struct operation *act_leave(enum going going)
{
	return new_act((struct operation){ .go.act = run_leave, .n = going });
}

static enum going run_return(const struct operation *o)
{
	o->a->go.act(o->a);
	return RETURNS;
}

const struct operation *act_return(const struct operation *store)
{
	return new_act((struct operation){ .go.act = run_return, .a = store });
}

static enum going run_body(const struct operation *o)
{
	o->a->go.act(o->a);
	return GOES_ON;
}

const struct operation *act_body(const struct operation *list)
{
	return new_act((struct operation){ .go.act = run_body, .a = list });
}
