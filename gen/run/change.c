/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions that change something, and those of which one part runs. */
#include "run/run.h"

#include <string.h>

static const struct operation *new_operation(struct operation o)
{
	struct operation *copy = NEW(struct operation);
	*copy = o;
	return copy;
}

/* ---- what is stored ---- */

#define STORE(name, member, result, type)                                       \
	static result store_##name(const struct operation *o)                   \
	{                                                                       \
		const result value = o->b->go.member(o->b);                     \
		*(type *)o->a->go.place(o->a) = (type)value;                    \
		return value;                                                   \
	}
STORE(char, whole, int64_t, char)
STORE(short, whole, int64_t, int16_t)
STORE(int, whole, int64_t, int32_t)
STORE(long, whole, int64_t, int64_t)
STORE(double, real, double, double)
STORE(float, real, double, float)

/* At a place that is known: most are locals */
static double store_double_fixed(const struct operation *o)
{
	return *(double *)o->at = o->b->go.real(o->b);
}

static void *store_pointer(const struct operation *o)
{
	void *value = o->b->go.place(o->b);
	*(void **)o->a->go.place(o->a) = value;
	return value;
}

static void *store_struct(const struct operation *o)
{
	void *to = o->a->go.place(o->a);
	memmove(to, o->b->go.place(o->b), o->type->size);
	return to;
}

const struct operation *assigned(const struct operation *to, const struct operation *value)
{
	const struct ctype *type = to->type;
	if (!to->stored || type->kind == CTYPE_ARRAY || type->kind == CTYPE_VOID)
		return NULL;
	struct operation r = { .type = type, .a = to, .b = converted(value, type), .at = to->at };
	if (!r.b || (type->kind == CTYPE_STRUCT && type->size != value->type->size))
		return NULL;
	if (type->kind == CTYPE_STRUCT)
		r.go.place = store_struct;
	else if (type->kind == CTYPE_POINTER)
		r.go.place = store_pointer;
	else if (type->kind == CTYPE_REAL && type->size == sizeof(double))
		r.go.real = !to->a && !to->b ? store_double_fixed : store_double;
	else if (type->kind == CTYPE_REAL)
		r.go.real = store_float;
	else
		r.go.whole = type->size == 8   ? store_long
			     : type->size == 4 ? store_int
			     : type->size == 2 ? store_short
					       : store_char;
	return new_operation(r);
}

#define STEP(name, type)                                                        \
	static int64_t step_##name(const struct operation *o)                   \
	{                                                                       \
		type *p = o->a->go.place(o->a), before = *p;                    \
		*p = (type)(before + (type)o->n);                               \
		return (int64_t)(o->count ? before : *p);                       \
	}
STEP(int, int32_t)
STEP(unsigned, uint32_t)
STEP(wide, uint64_t)

static void *step_pointer(const struct operation *o)
{
	char **p = o->a->go.place(o->a), *before = *p;
	*p += o->n;
	return o->count ? before : *p;
}

const struct operation *stepped(const struct operation *o, int by, bool after)
{
	const struct ctype *type = o->type;
	struct operation r = { .type = type, .a = o, .n = by, .count = after };
	if (!o->stored || (type->kind != CTYPE_POINTER && type->kind != CTYPE_WHOLE) || type->size < 4)
		return NULL;
	if (type->kind == CTYPE_POINTER) {
		r.n = by * (int64_t)type->of->size;
		r.go.place = step_pointer;
	} else {
		r.go.whole = type->size == 8 ? step_wide : type->positive ? step_unsigned : step_int;
	}
	return new_operation(r);
}

/* ---- one of two, one after the other ---- */

static int64_t choose_whole(const struct operation *o)
{
	return o->a->go.whole(o->a) ? o->b->go.whole(o->b) : o->c->go.whole(o->c);
}

static double choose_real(const struct operation *o)
{
	return o->a->go.whole(o->a) ? o->b->go.real(o->b) : o->c->go.real(o->c);
}

static void *choose_place(const struct operation *o)
{
	return o->a->go.whole(o->a) ? o->b->go.place(o->b) : o->c->go.place(o->c);
}

const struct operation *chosen(const struct operation *condition, const struct operation *a, const struct operation *b)
{
	struct operation r = { .type = a->type, .a = as_condition(condition), .b = a, .c = b };
	bool numbers = a->type->kind <= CTYPE_REAL && b->type->kind <= CTYPE_REAL;
	if (!r.a || (!numbers && a->type->kind != b->type->kind))
		return NULL;
	if (numbers && (a->type != b->type)) {          /* their common type is that of their sum */
		r.type = combined('+', a, b)->type;
		r.b = converted(a, r.type);
		r.c = converted(b, r.type);
	}
	if (r.type->kind == CTYPE_REAL)
		r.go.real = choose_real;
	else if (r.type->kind == CTYPE_WHOLE)
		r.go.whole = choose_whole;
	else
		r.go.place = choose_place;
	return new_operation(r);
}

static int64_t sequence_whole(const struct operation *o)
{
	o->c->go.act(o->c);
	return o->b->go.whole(o->b);
}

static double sequence_real(const struct operation *o)
{
	o->c->go.act(o->c);
	return o->b->go.real(o->b);
}

static void *sequence_place(const struct operation *o)
{
	o->c->go.act(o->c);
	return o->b->go.place(o->b);
}

const struct operation *in_sequence(const struct operation *a, const struct operation *b)
{
	struct operation r = { .type = b->type, .b = b, .c = a };
	if (b->type->kind == CTYPE_REAL)
		r.go.real = sequence_real;
	else if (b->type->kind == CTYPE_WHOLE)
		r.go.whole = sequence_whole;
	else
		r.go.place = sequence_place;
	return new_operation(r);
}
