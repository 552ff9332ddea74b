/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Expressions that run: each operation of C is one of these, with the conversions that C makes written out. Sums and
 * products are single calls, so no compiler can join them, and each is rounded to the type that it has in the text. */
#include "run/run.h"

#include <string.h>

const struct ctype ctype_void = { .kind = CTYPE_VOID, .size = 1, .align = 1 };
const struct ctype ctype_char = { .kind = CTYPE_WHOLE, .size = 1, .align = 1 };
const struct ctype ctype_short = { .kind = CTYPE_WHOLE, .size = 2, .align = 2 };
const struct ctype ctype_int = { .kind = CTYPE_WHOLE, .size = 4, .align = 4 };
const struct ctype ctype_unsigned = { .kind = CTYPE_WHOLE, .size = 4, .align = 4, .positive = true };
const struct ctype ctype_long = { .kind = CTYPE_WHOLE, .size = 8, .align = 8 };
const struct ctype ctype_wide = { .kind = CTYPE_WHOLE, .size = 8, .align = 8, .positive = true };
const struct ctype ctype_double = { .kind = CTYPE_REAL, .size = 8, .align = 8 };
const struct ctype ctype_float = { .kind = CTYPE_REAL, .size = 4, .align = 4 };

const struct ctype *pointer_to(const struct ctype *type)
{
	struct ctype *t = NEW(struct ctype);
	*t = (struct ctype){ .kind = CTYPE_POINTER, .size = sizeof(void *), .align = _Alignof(void *), .of = type };
	return t;
}

const struct ctype *array_of(const struct ctype *type, int count)
{
	struct ctype *t = NEW(struct ctype);
	*t = (struct ctype){ .kind = CTYPE_ARRAY, .align = type->align, .of = type, .count = count };
	t->size = count > 0 ? type->size * (size_t)count : 0;
	return t;
}

static struct operation *new_operation(struct operation o)
{
	struct operation *copy = NEW(struct operation);
	*copy = o;
	return copy;
}

/* ---- numbers, and what is stored ---- */

static int64_t run_number(const struct operation *o)
{
	return o->n;
}

static double run_real_number(const struct operation *o)
{
	return o->x;
}

static void *run_place(const struct operation *o)
{
	return o->at;
}

static void *run_offset(const struct operation *o)
{
	return (char *)o->a->go.place(o->a) + o->n;
}

/* Of an array at a fixed place, n bytes each */
static void *run_element(const struct operation *o)
{
	return (char *)o->at + o->b->go.whole(o->b) * o->n;
}

static void *run_element_where(const struct operation *o)
{
	return (char *)o->a->go.place(o->a) + o->b->go.whole(o->b) * o->n;
}

struct operation *number_whole(const struct ctype *type, int64_t n)
{
	return new_operation((struct operation){ .go.whole = run_number, .type = type, .n = n });
}

struct operation *number_real(const struct ctype *type, double x)
{
	return new_operation((struct operation){ .go.real = run_real_number, .type = type, .x = x });
}

struct operation *stored_at(const struct ctype *type, void *at)
{
	return new_operation((struct operation){ .go.place = run_place, .type = type, .stored = true, .at = at });
}

struct operation *stored_where(const struct ctype *type, const struct operation *place, size_t offset)
{
	if (place->go.place == run_place)
		return stored_at(type, (char *)place->at + offset);
	return new_operation((struct operation){
		.go.place = run_offset, .type = type, .stored = true, .a = place, .n = (int64_t)offset });
}

static bool is_constant_whole(const struct operation *o)
{
	return o->type && o->type->kind == CTYPE_WHOLE && !o->stored && o->go.whole == run_number;
}

const struct operation *element_of(const struct operation *a, const struct operation *index)
{
	if (a->type->kind != CTYPE_POINTER || index->type->kind != CTYPE_WHOLE)
		return NULL;
	const struct ctype *type = a->type->of;
	if (is_constant_whole(index)) {
		ptrdiff_t offset = (ptrdiff_t)(index->n * (int64_t)type->size);
		if (a->go.place == run_place)
			return stored_at(type, (char *)a->at + offset);
		return new_operation((struct operation){
			.go.place = run_offset, .type = type, .stored = true, .a = a, .n = offset });
	}
	bool fixed = a->go.place == run_place;
	return new_operation((struct operation){ .go.place = fixed ? run_element : run_element_where, .type = type,
						 .stored = true, .a = a, .b = index, .at = fixed ? a->at : NULL,
						 .n = (int64_t)type->size });
}

/* ---- reading ---- */

#define READ(name, member, result, type)                                                       \
	static result read_##name(const struct operation *o)                                   \
	{                                                                                      \
		return (result)*(const type *)o->a->go.place(o->a);                            \
	}                                                                                      \
	static result read_##name##_fixed(const struct operation *o)                           \
	{                                                                                      \
		return (result)*(const type *)o->at;                                           \
	}                                                                                      \
	static result read_##name##_element(const struct operation *o)                         \
	{                                                                                      \
		return (result)((const type *)o->at)[o->b->go.whole(o->b)];                    \
	}                                                                                      \
	static void read_from_##name(struct operation *r, const struct operation *o)           \
	{                                                                                      \
		bool element = o->go.place == run_element && o->n == (int64_t)sizeof(type);     \
		r->go.member = o->go.place == run_place ? read_##name##_fixed                  \
			       : element	       ? read_##name##_element                 \
						       : read_##name;                          \
	}
READ(char, whole, int64_t, char)
READ(short, whole, int64_t, int16_t)
READ(int, whole, int64_t, int32_t)
READ(unsigned, whole, int64_t, uint32_t)
READ(long, whole, int64_t, int64_t)
READ(double, real, double, double)
READ(float, real, double, float)

static void *read_pointer(const struct operation *o)
{
	return *(void *const *)o->a->go.place(o->a);
}

const struct operation *value_of(const struct operation *o)
{
	if (!o->stored)
		return o;
	struct operation *r = new_operation(*o);
	r->stored = false;
	if (o->type->kind == CTYPE_ARRAY) {
		r->type = pointer_to(o->type->of);
		return r;
	}
	if (o->type->kind == CTYPE_STRUCT || o->type->kind == CTYPE_VOID)
		return r;
	*r = (struct operation){ .type = o->type, .a = o, .b = o->b, .at = o->at };
	if (o->type->kind == CTYPE_POINTER)
		r->go.place = read_pointer;
	else if (o->type->kind == CTYPE_REAL)
		(o->type->size == sizeof(float) ? read_from_float : read_from_double)(r, o);
	else if (o->type->size == 1)
		read_from_char(r, o);
	else if (o->type->size == 2)
		read_from_short(r, o);
	else if (o->type->size == 8)
		read_from_long(r, o);
	else
		(o->type->positive ? read_from_unsigned : read_from_int)(r, o);
	return r;
}

const struct operation *place_of(const struct operation *o)
{
	struct operation *r = new_operation(*o);
	r->stored = false;
	r->type = pointer_to(o->type);
	return r;
}

/* ---- conversions ---- */

static int64_t narrowed(const struct ctype *type, int64_t n)
{
	return type->size == 8	 ? n
	       : type->size == 1 ? (int64_t)(char)n
	       : type->size == 2 ? (int64_t)(int16_t)n
	       : type->positive	 ? (int64_t)(uint32_t)n
				 : (int64_t)(int32_t)n;
}

static int64_t run_narrow(const struct operation *o)
{
	return narrowed(o->type, o->a->go.whole(o->a));
}

static int64_t run_truncate(const struct operation *o)
{
	double x = o->a->go.real(o->a);
	return o->type->size == 8 && o->type->positive ? (int64_t)(uint64_t)x : narrowed(o->type, (int64_t)x);
}

static double run_real_of(const struct operation *o)
{
	int64_t n = o->a->go.whole(o->a);
	bool positive = o->a->type->positive && o->a->type->size == 8;
	if (o->type->size == sizeof(float))
		return (double)(positive ? (float)(uint64_t)n : (float)n);
	return positive ? (double)(uint64_t)n : (double)n;
}

static double run_single(const struct operation *o)
{
	return (double)(float)o->a->go.real(o->a);
}

const struct operation *converted(const struct operation *o, const struct ctype *type)
{
	const struct ctype *from = o->type;
	struct operation r = { .type = type, .a = o };
	if (from->kind == CTYPE_WHOLE && type->kind == CTYPE_WHOLE) {
		if (is_constant_whole(o))
			return number_whole(type, narrowed(type, o->n));
		r.go.whole = run_narrow;
	} else if (from->kind == CTYPE_REAL && type->kind == CTYPE_WHOLE) {
		r.go.whole = run_truncate;
	} else if (from->kind == CTYPE_WHOLE && type->kind == CTYPE_REAL) {
		r.go.real = run_real_of;
		if (is_constant_whole(o))
			return number_real(type, run_real_of(&r));
	} else if (from->kind == CTYPE_REAL && type->kind == CTYPE_REAL && type->size < from->size) {
		r.go.real = run_single;
		if (o->go.real == run_real_number)
			return number_real(type, run_single(&r));
	} else if (from->kind == CTYPE_WHOLE && type->kind == CTYPE_POINTER && is_constant_whole(o) && o->n == 0) {
		r.go.place = run_place;
	} else if (from->kind == type->kind || type->kind == CTYPE_VOID) {
		r = *o;
		r.type = type;
	} else {
		return NULL;
	}
	return new_operation(r);
}

/* ---- arithmetic ---- */

struct counted counted;

#define REAL(name, kind, expression)                                              \
	static double name(const struct operation *o)                             \
	{                                                                         \
		const double a = o->a->go.real(o->a), b = o->b->go.real(o->b);    \
		counted.kind++;                                                   \
		return expression;                                                \
	}                                                                         \
	static double name##_single(const struct operation *o)                    \
	{                                                                         \
		const double a = o->a->go.real(o->a), b = o->b->go.real(o->b);    \
		counted.kind++;                                                   \
		return (double)(float)(expression);                               \
	}
/* Two roundings, to double and then to float, are one: 53 >= 2 24 + 2 (Figueroa 1995). */
REAL(run_add, additions, a + b)
REAL(run_subtract, additions, a - b)
REAL(run_multiply, multiplications, a * b)
REAL(run_divide, multiplications, a / b)

#define COMPARE(name, sign)                                                       \
	static int64_t name##_real(const struct operation *o)                     \
	{                                                                         \
		return o->a->go.real(o->a) sign o->b->go.real(o->b);              \
	}                                                                         \
	static int64_t name##_whole(const struct operation *o)                    \
	{                                                                         \
		return o->a->go.whole(o->a) sign o->b->go.whole(o->b);            \
	}                                                                         \
	static int64_t name##_positive(const struct operation *o)                 \
	{                                                                         \
		return (uint64_t)o->a->go.whole(o->a) sign (uint64_t)o->b->go.whole(o->b); \
	}                                                                         \
	static int64_t name##_place(const struct operation *o)                    \
	{                                                                         \
		return (uintptr_t)o->a->go.place(o->a) sign (uintptr_t)o->b->go.place(o->b); \
	}
COMPARE(run_less, <)
COMPARE(run_at_most, <=)
COMPARE(run_greater, >)
COMPARE(run_at_least, >=)
COMPARE(run_equal, ==)
COMPARE(run_unequal, !=)

static int64_t run_whole(const struct operation *o)
{
	const int64_t a = o->a->go.whole(o->a), b = o->b->go.whole(o->b);
	const uint64_t p = (uint64_t)a, q = (uint64_t)b;
	bool positive = o->type->positive;
	uint64_t r = 0;
	switch (o->n) {
	case '+': r = p + q; break;
	case '-': r = p - q; break;
	case '*': r = p * q; break;
	case '/': r = q == 0 ? 0 : positive ? p / q : (uint64_t)(a / b); break;
	case '%': r = q == 0 ? 0 : positive ? p % q : (uint64_t)(a % b); break;
	case '&': r = p & q; break;
	case '|': r = p | q; break;
	case '^': r = p ^ q; break;
	case MARK2('<', '<'): r = p << (q & 63); break;
	case MARK2('>', '>'): r = positive ? p >> (q & 63) : (uint64_t)(a >> (q & 63)); break;
	default: break;
	}
	return narrowed(o->type, (int64_t)r);
}

static int64_t run_add_int(const struct operation *o)
{
	return (int32_t)(o->a->go.whole(o->a) + o->b->go.whole(o->b));
}

static void *run_move(const struct operation *o)
{
	return (char *)o->a->go.place(o->a) + o->b->go.whole(o->b) * o->n;
}

static int64_t run_distance(const struct operation *o)
{
	return ((char *)o->a->go.place(o->a) - (char *)o->b->go.place(o->b)) / o->n;
}

static int64_t run_and(const struct operation *o)
{
	return o->a->go.whole(o->a) && o->b->go.whole(o->b);
}

static int64_t run_or(const struct operation *o)
{
	return o->a->go.whole(o->a) || o->b->go.whole(o->b);
}

/* The type that both operands of an operation get (C11 6.3.1.8) */
static const struct ctype *common_type(const struct ctype *a, const struct ctype *b)
{
	if (a->kind == CTYPE_REAL || b->kind == CTYPE_REAL) {
		bool both = a->kind == b->kind;
		bool single = both ? a->size + b->size == 2 * sizeof(float)
				   : (a->kind == CTYPE_REAL ? a : b)->size == sizeof(float);
		return single ? &ctype_float : &ctype_double;
	}
	size_t size = a->size > b->size ? a->size : b->size;
	bool positive = (a->positive && a->size == size) || (b->positive && b->size == size);
	if (size == 8)
		return positive ? &ctype_wide : &ctype_long;
	return positive && size == 4 ? &ctype_unsigned : &ctype_int;
}

typedef int64_t whole_function(const struct operation *o);

static const struct comparing { unsigned mark; whole_function *real, *whole, *positive, *place; } comparing[] = {
	{ MARK('<'), run_less_real, run_less_whole, run_less_positive, run_less_place },
	{ MARK2('<', '='), run_at_most_real, run_at_most_whole, run_at_most_positive, run_at_most_place },
	{ MARK('>'), run_greater_real, run_greater_whole, run_greater_positive, run_greater_place },
	{ MARK2('>', '='), run_at_least_real, run_at_least_whole, run_at_least_positive, run_at_least_place },
	{ MARK2('=', '='), run_equal_real, run_equal_whole, run_equal_positive, run_equal_place },
	{ MARK2('!', '='), run_unequal_real, run_unequal_whole, run_unequal_positive, run_unequal_place },
};

static const struct operation *compared(const struct comparing *c, struct operation r)
{
	const struct ctype *type = r.a->type;
	r.type = &ctype_int;
	r.go.whole = type->kind == CTYPE_REAL	 ? c->real
		     : type->kind == CTYPE_POINTER ? c->place
		     : type->positive		 ? c->positive
						 : c->whole;
	return new_operation(r);
}

static const struct operation *real_combined(unsigned mark, struct operation r)
{
	static const struct { char mark; double (*run)(const struct operation *), (*single)(const struct operation *); }
	known[] = { { '+', run_add, run_add_single }, { '-', run_subtract, run_subtract_single },
		    { '*', run_multiply, run_multiply_single }, { '/', run_divide, run_divide_single } };
	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		if (mark == MARK(known[i].mark)) {
			r.go.real = r.type->size == sizeof(float) ? known[i].single : known[i].run;
			return new_operation(r);
		}
	return NULL;
}

static const struct operation *whole_combined(unsigned mark, struct operation r)
{
	r.n = mark;
	r.go.whole = mark == '+' && r.type == &ctype_int ? run_add_int : run_whole;
	if (is_constant_whole(r.a) && is_constant_whole(r.b))
		return number_whole(r.type, r.go.whole(&r));
	return new_operation(r);
}

static const struct operation *pointer_combined(unsigned mark, const struct operation *a, const struct operation *b)
{
	struct operation r = { .type = a->type, .a = a, .b = b, .n = (int64_t)a->type->of->size };
	if (b->type->kind == CTYPE_WHOLE && mark == '+') {
		r.go.place = run_move;
	} else if (b->type->kind == CTYPE_WHOLE && mark == '-') {
		r.b = negated('-', converted(b, &ctype_long));
		r.go.place = run_move;
	} else if (b->type->kind == CTYPE_POINTER && mark == '-') {
		r.type = &ctype_long;
		r.go.whole = run_distance;
	} else {
		return NULL;
	}
	return new_operation(r);
}

const struct operation *combined(unsigned mark, const struct operation *a, const struct operation *b)
{
	bool pointers = a->type->kind == CTYPE_POINTER || b->type->kind == CTYPE_POINTER;
	bool numbers = a->type->kind <= CTYPE_REAL && b->type->kind <= CTYPE_REAL;
	bool shift = mark == MARK2('<', '<') || mark == MARK2('>', '>');
	if (mark == MARK2('&', '&') || mark == MARK2('|', '|')) {
		a = as_condition(a);
		b = as_condition(b);
		struct operation both = { .type = &ctype_int, .a = a, .b = b };
		both.go.whole = mark == MARK2('&', '&') ? run_and : run_or;
		return a && b ? new_operation(both) : NULL;
	}
	if (!pointers && !numbers)
		return NULL;
	const struct ctype *type = pointers ? NULL : shift ? common_type(a->type, &ctype_int)
							   : common_type(a->type, b->type);
	if (numbers && !pointers) {
		a = converted(a, type);
		b = shift ? b : converted(b, type);
	}
	for (size_t i = 0; i < sizeof comparing / sizeof *comparing; i++)
		if (comparing[i].mark == mark)
			return compared(&comparing[i], (struct operation){ .a = a, .b = b });
	if (pointers)
		return a->type->kind == CTYPE_POINTER ? pointer_combined(mark, a, b) : pointer_combined(mark, b, a);
	struct operation r = { .type = type, .a = a, .b = b };
	return type->kind == CTYPE_REAL ? real_combined(mark, r) : whole_combined(mark, r);
}

/* ---- one operand ---- */

static int64_t run_is_real(const struct operation *o)
{
	return o->a->go.real(o->a) != 0.0;
}

static int64_t run_is_place(const struct operation *o)
{
	return o->a->go.place(o->a) != NULL;
}

const struct operation *as_condition(const struct operation *o)
{
	struct operation r = { .type = &ctype_int, .a = o };
	if (o->type->kind == CTYPE_WHOLE)
		return o;
	if (o->type->kind != CTYPE_REAL && o->type->kind != CTYPE_POINTER)
		return NULL;
	r.go.whole = o->type->kind == CTYPE_REAL ? run_is_real : run_is_place;
	return new_operation(r);
}

static double run_negative(const struct operation *o)
{
	return -o->a->go.real(o->a);
}

static int64_t run_opposite(const struct operation *o)
{
	return narrowed(o->type, (int64_t)(0 - (uint64_t)o->a->go.whole(o->a)));
}

static int64_t run_complement(const struct operation *o)
{
	return narrowed(o->type, ~o->a->go.whole(o->a));
}

static int64_t run_not(const struct operation *o)
{
	return !o->a->go.whole(o->a);
}

const struct operation *negated(unsigned mark, const struct operation *a)
{
	struct operation r = { .type = a->type };
	if (mark == '!') {
		r = (struct operation){ .go.whole = run_not, .type = &ctype_int, .a = as_condition(a) };
		return r.a ? new_operation(r) : NULL;
	}
	if (a->type->kind == CTYPE_REAL && mark != '~') {
		r.go.real = run_negative;
		r.a = a;
		if (mark == '+')
			return a;
		return a->go.real == run_real_number ? number_real(a->type, -a->x) : new_operation(r);
	}
	if (a->type->kind != CTYPE_WHOLE)
		return NULL;
	r.type = common_type(a->type, &ctype_int);
	r.a = converted(a, r.type);
	r.go.whole = mark == '~' ? run_complement : run_opposite;
	if (mark == '+')
		return r.a;
	return is_constant_whole(r.a) ? number_whole(r.type, r.go.whole(&r)) : new_operation(r);
}
