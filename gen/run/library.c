/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What generated C calls and does not define: the runtime, which is linked into the generator, and <math.h>. */
#include "run/run.h"

#include <math.h>
#include <string.h>

enum { MOST_ARGUMENTS = 8 };

/* Checked against the header's own by a test */
const char library_types[] =
	"typedef struct pl_turn { uint64_t hi, lo; } pl_turn;\n"
	"typedef struct pl_rate { uint64_t word[3]; int exponent; } pl_rate;\n"
	"typedef uint64_t pl_turnf;\n"
	"typedef struct pl_ratef { uint64_t word[2]; int exponent; } pl_ratef;\n"
	"typedef struct pl_growth { int64_t hi; uint64_t lo; } pl_growth;\n"
	"typedef int64_t pl_growthf;\n"
	"typedef struct pl_series { int size; int states; int degree; int halvings; const double *A; } pl_series;\n"
	"typedef struct pl_seriesf { int size, states, degree, halvings; const float *A; } pl_seriesf;\n"
	"typedef struct pl_lead { pl_turn turn; double angle; } pl_lead;\n"
	"typedef struct pl_leadf { pl_turnf turn; float angle; } pl_leadf;\n"
	"typedef struct pl_two { double hi, lo; } pl_two;\n"
	"typedef struct pl_twof { float hi, lo; } pl_twof;\n"
	"typedef struct pl_ladder { const int *first, *spacing; const double *pieces, *reach; const int *gates; }\n"
	"pl_ladder;\n"
	"typedef struct pl_ladderf { const int *first, *spacing; const float *pieces, *reach; const int *gates; }\n"
	"pl_ladderf;\n"
	"typedef struct pl_switching { int size; double h; int switches; const double *row; const int *breaks;\n"
	"const double *at; const int *matrix; const int *halvings; const double *A; const double *Phi;\n"
	"pl_ladder ladder; const double *tangent; const double *chord_error, *cubic_error; int degree;\n"
	"int max_events, max_splits; }\n"
	"pl_switching;\n"
	"typedef struct pl_crossing { double time; int expression, breakpoint, upward; } pl_crossing;\n"
	"typedef struct pl_contact { uint64_t total; int crossings; int region; int matrix; int status; } pl_contact;\n"
	"typedef struct pl_switchingf { int size; float h; int switches; const float *row; const int *breaks;\n"
	"const float *at; const int *matrix, *halvings; const float *A, *Phi; pl_ladderf ladder;\n"
	"const float *tangent, *chord_error, *cubic_error;\n"
	"int degree, max_events, max_splits; } pl_switchingf;\n"
	"typedef struct pl_crossingf { float time; int expression, breakpoint, upward; } pl_crossingf;\n"
	"typedef struct pl_divided { int expressions, columns, degree; const int *column, *breaks;\n"
	"const double *at; } pl_divided;\n"
	"typedef struct pl_dividedf { int expressions, columns, degree; const int *column, *breaks;\n"
	"const float *at; } pl_dividedf;\n"
	"enum { PL_NOT_FINITE = 1, PL_TOO_MANY_EVENTS = 2, PL_TOO_MANY_STEPS = 4, PL_INACCURATE = 8,\n"
	"       PL_LEFT_RANGE = 32 };\n";

/* ---- calls ---- */

#define W(i) ((int)a[i].whole)
#define U(i) ((uint64_t)a[i].whole)
#define R(i) (a[i].real)
#define F(i) ((float)a[i].real)
#define P(i) (a[i].place)
#define S(i, type) (*(const type *)a[i].place)
#define CALL(name, to, call)                                                    \
	static void call_##name(union word *r, const union word *a)             \
	{                                                                       \
		to call;                                                        \
	}
#define NOTHING (void)r;
#define WHOLE r->whole =
#define REAL r->real = (double)
#define STRUCT(type) *(type *)r->place =

CALL(turn_add, STRUCT(pl_turn), pl_turn_add(S(0, pl_turn), S(1, pl_turn)))
CALL(turn_times, STRUCT(pl_turn), pl_turn_times(S(0, pl_turn), U(1)))
CALL(turn_at, STRUCT(pl_turn), pl_turn_at(P(0), R(1)))
CALL(cossin, NOTHING, pl_cossin(S(0, pl_turn), P(1)))
CALL(lead_start, NOTHING, pl_lead_start(P(0)))
CALL(leadf_start, NOTHING, pl_leadf_start(P(0)))
CALL(turnf_add, WHOLE, (int64_t)pl_turnf_add(U(0), U(1)))
CALL(turnf_times, WHOLE, (int64_t)pl_turnf_times(U(0), U(1)))
CALL(turnf_at, WHOLE, (int64_t)pl_turnf_at(P(0), F(1)))
CALL(cossinf, NOTHING, pl_cossinf(U(0), P(1)))
CALL(growth_add, STRUCT(pl_growth), pl_growth_add(S(0, pl_growth), S(1, pl_growth)))
CALL(growth_times, STRUCT(pl_growth), pl_growth_times(S(0, pl_growth), U(1)))
CALL(growth_at, STRUCT(pl_growth), pl_growth_at(P(0), W(1), R(2)))
CALL(growth_value, REAL, pl_growth_value(S(0, pl_growth)))
CALL(growthf_add, WHOLE, pl_growthf_add(a[0].whole, a[1].whole))
CALL(growthf_times, WHOLE, pl_growthf_times(a[0].whole, U(1)))
CALL(growthf_at, WHOLE, pl_growthf_at(P(0), W(1), F(2)))
CALL(growthf_value, REAL, pl_growthf_value(a[0].whole))
CALL(series_advance, NOTHING, pl_series_advance(P(0), R(1), P(2), P(3)))
CALL(seriesf_advance, NOTHING, pl_seriesf_advance(P(0), F(1), P(2), P(3)))
CALL(accumulate, REAL, pl_accumulate(R(0), R(1), R(2), P(3)))
CALL(accumulatef, REAL, pl_accumulatef(F(0), F(1), F(2), P(3)))
CALL(root, REAL, pl_root(R(0), W(1)))
CALL(rootf, REAL, pl_rootf(F(0), W(1)))
CALL(factor, WHOLE, pl_factor(W(0), P(1), P(2)))
CALL(factor_complex, WHOLE, pl_factor_complex(W(0), P(1), P(2)))
CALL(solve, NOTHING, pl_solve(W(0), P(1), P(2), P(3)))
CALL(solve_complex, NOTHING, pl_solve_complex(W(0), P(1), P(2), P(3)))
CALL(factorf, WHOLE, pl_factorf(W(0), P(1), P(2)))
CALL(factorf_complex, WHOLE, pl_factorf_complex(W(0), P(1), P(2)))
CALL(solvef, NOTHING, pl_solvef(W(0), P(1), P(2), P(3)))
CALL(solvef_complex, NOTHING, pl_solvef_complex(W(0), P(1), P(2), P(3)))
CALL(until, REAL, pl_until(R(0), U(1), S(2, pl_two), S(3, pl_two)))
CALL(untilf, REAL, pl_untilf(F(0), U(1), S(2, pl_twof), S(3, pl_twof)))
CALL(multiply, NOTHING, pl_multiply(W(0), W(1), P(2), P(3), P(4)))
CALL(multiply_add, NOTHING, pl_multiply_add(W(0), W(1), P(2), P(3), P(4)))
CALL(multiplyf, NOTHING, pl_multiplyf(W(0), W(1), P(2), P(3), P(4)))
CALL(multiplyf_add, NOTHING, pl_multiplyf_add(W(0), W(1), P(2), P(3), P(4)))
CALL(not_finite, WHOLE, pl_not_finite(P(0), W(1)))
CALL(not_finitef, WHOLE, pl_not_finitef(P(0), W(1)))
CALL(magnitudef, REAL, pl_magnitudef(F(0)))
CALL(switching_start, NOTHING, pl_switching_start(P(0), P(1), P(2), P(3)))
CALL(switching_step, NOTHING, pl_switching_step(P(0), P(1), P(2), P(3), P(4)))
CALL(switching_advance, NOTHING, pl_switching_advance(P(0), R(1), P(2), P(3), P(4), P(5)))
CALL(switchingf_start, NOTHING, pl_switchingf_start(P(0), P(1), P(2), P(3)))
CALL(switchingf_step, NOTHING, pl_switchingf_step(P(0), P(1), P(2), P(3), P(4)))
CALL(switchingf_advance, NOTHING, pl_switchingf_advance(P(0), F(1), P(2), P(3), P(4), P(5)))
CALL(switching_kept_start, NOTHING, pl_switching_kept_start(P(0), P(1), P(2), P(3)))
CALL(switching_kept_step, NOTHING, pl_switching_kept_step(P(0), P(1), P(2), P(3), P(4)))
CALL(switching_kept_advance, NOTHING, pl_switching_kept_advance(P(0), R(1), P(2), P(3), P(4), P(5)))
CALL(switching_kept_move, NOTHING, pl_switching_kept_move(P(0), W(1), W(2), R(3), P(4), P(5)))
CALL(switchingf_kept_start, NOTHING, pl_switchingf_kept_start(P(0), P(1), P(2), P(3)))
CALL(switchingf_kept_step, NOTHING, pl_switchingf_kept_step(P(0), P(1), P(2), P(3), P(4)))
CALL(switchingf_kept_advance, NOTHING, pl_switchingf_kept_advance(P(0), F(1), P(2), P(3), P(4), P(5)))
CALL(divided_place, WHOLE, pl_divided_place(P(0), P(1), P(2), P(3)))
CALL(divided_rises, WHOLE, pl_divided_rises(P(0), P(1), P(2), P(3)))
CALL(divided_left, WHOLE, pl_divided_left(P(0), P(1), P(2), P(3), P(4)))
CALL(divided_next, REAL, pl_divided_next(P(0), P(1), P(2), P(3), R(4), P(5), P(6), P(7)))
CALL(dividedf_place, WHOLE, pl_dividedf_place(P(0), P(1), P(2), P(3)))
CALL(dividedf_rises, WHOLE, pl_dividedf_rises(P(0), P(1), P(2), P(3)))
CALL(dividedf_left, WHOLE, pl_dividedf_left(P(0), P(1), P(2), P(3), P(4)))
CALL(dividedf_next, REAL, pl_dividedf_next(P(0), P(1), P(2), P(3), F(4), P(5), P(6), P(7)))
CALL(atan2, REAL, atan2(R(0), R(1)))
CALL(pow, REAL, pow(R(0), R(1)))
CALL(fmin, REAL, fmin(R(0), R(1)))
CALL(fmax, REAL, fmax(R(0), R(1)))
CALL(atan2f, REAL, atan2f(F(0), F(1)))
CALL(powf, REAL, powf(F(0), F(1)))
CALL(fminf, REAL, fminf(F(0), F(1)))
CALL(fmaxf, REAL, fmaxf(F(0), F(1)))
CALL(work, WHOLE, PL_SWITCHING_WORK(W(0), W(1), W(2)))
CALL(kept_work, WHOLE, PL_SWITCHING_KEPT_WORK(W(0), W(1), W(2)))
CALL(divided_work, WHOLE, PL_DIVIDED_WORK(W(0)))

#define SINGLE(name) static double single_##name(double x) { return (double)name##f((float)x); }
SINGLE(fabs)
#define REAL_FUNCTION(NAME, name, argument, value, low, high) SINGLE(name)
#include "read/functions.def"
#undef REAL_FUNCTION

#define RUNTIME(name, types) { "pl_" #name, types, NULL, call_##name, NULL, 0, 0, TAKES_NO_MORE }
#define RUNTIME_OF(name, types, mul, add, takes) { "pl_" #name, types, NULL, call_##name, NULL, mul, add, takes }
#define RUNTIME_STRUCT(name, types, structure) \
	{ "pl_" #name, types, structure, call_##name, NULL, 0, 0, TAKES_NO_MORE }
#define MATH(name) \
	{ #name, "dd", NULL, NULL, name, 0, 0, TAKES_CALL },            \
	{ #name "f", "fd", NULL, NULL, single_##name, 0, 0, TAKES_CALL }
#define MATH_OF_TWO(name)                                               \
	{ #name, "ddd", NULL, call_##name, NULL, 0, 0, TAKES_CALL },    \
	{ #name "f", "fdd", NULL, call_##name##f, NULL, 0, 0, TAKES_CALL }

static const struct library_function functions[] = {
	RUNTIME_STRUCT(turn_add, "sss", "pl_turn"), RUNTIME_STRUCT(turn_times, "ssi", "pl_turn"),
	RUNTIME_STRUCT(turn_at, "spd", "pl_turn"), RUNTIME(lead_start, "vp"), RUNTIME(leadf_start, "vp"),
	RUNTIME_OF(cossin, "vsp", PL_COSSIN_MUL, PL_COSSIN_ADD, TAKES_NO_MORE), RUNTIME(turnf_add, "uuu"),
	RUNTIME(turnf_times, "uuu"), RUNTIME(turnf_at, "upd"),
	RUNTIME_OF(cossinf, "vup", PL_COSSINF_MUL, PL_COSSINF_ADD, TAKES_NO_MORE),
	RUNTIME_STRUCT(growth_add, "sss", "pl_growth"), RUNTIME_STRUCT(growth_times, "ssi", "pl_growth"),
	RUNTIME_STRUCT(growth_at, "spid", "pl_growth"),
	RUNTIME_OF(growth_value, "ds", PL_GROWTH_MUL, PL_GROWTH_ADD, TAKES_NO_MORE), RUNTIME(growthf_add, "lll"),
	RUNTIME(growthf_times, "llu"), RUNTIME(growthf_at, "lpid"),
	RUNTIME_OF(growthf_value, "fl", PL_GROWTHF_MUL, PL_GROWTHF_ADD, TAKES_NO_MORE),
	RUNTIME(series_advance, "vpdpp"), RUNTIME(seriesf_advance, "vpdpp"),
	RUNTIME_OF(accumulate, "ddddp", 0, PL_ACCUMULATE_ADD, TAKES_NO_MORE),
	RUNTIME_OF(accumulatef, "fdddp", 0, PL_ACCUMULATE_ADD, TAKES_NO_MORE), RUNTIME(root, "ddi"),
	RUNTIME(rootf, "fdi"), RUNTIME_OF(factor, "iipp", 1, 1, TAKES_FACTORS),
	RUNTIME_OF(factor_complex, "iipp", 4, 4, TAKES_FACTORS), RUNTIME_OF(solve, "vippp", 1, 1, TAKES_SOLUTION),
	RUNTIME_OF(solve_complex, "vippp", 4, 4, TAKES_SOLUTION), RUNTIME_OF(factorf, "iipp", 1, 1, TAKES_FACTORS),
	RUNTIME_OF(factorf_complex, "iipp", 4, 4, TAKES_FACTORS), RUNTIME_OF(solvef, "vippp", 1, 1, TAKES_SOLUTION),
	RUNTIME_OF(solvef_complex, "vippp", 4, 4, TAKES_SOLUTION), RUNTIME(until, "ddiss"), RUNTIME(untilf, "fdiss"),
	RUNTIME_OF(multiply, "viippp", 0, 0, TAKES_MATRIX), RUNTIME_OF(multiply_add, "viippp", 0, 0, TAKES_MATRIX),
	RUNTIME_OF(multiplyf, "viippp", 0, 0, TAKES_MATRIX), RUNTIME_OF(multiplyf_add, "viippp", 0, 0, TAKES_MATRIX),
	RUNTIME(not_finite, "ipi"), RUNTIME(not_finitef, "ipi"),
	{ "pl_magnitude", "dd", NULL, NULL, pl_magnitude, 0, 0, TAKES_NO_MORE }, RUNTIME(magnitudef, "fd"),
	RUNTIME(switching_start, "vpppp"), RUNTIME_OF(switching_step, "vppppp", 0, 0, TAKES_PIECES),
	RUNTIME_OF(switching_advance, "vpdpppp", 0, 0, TAKES_PIECES), RUNTIME(switchingf_start, "vpppp"),
	RUNTIME_OF(switchingf_step, "vppppp", 0, 0, TAKES_PIECES),
	RUNTIME_OF(switchingf_advance, "vpdpppp", 0, 0, TAKES_PIECES),
	RUNTIME(switching_kept_start, "vpppp"), RUNTIME_OF(switching_kept_step, "vppppp", 0, 0, TAKES_PIECES),
	RUNTIME_OF(switching_kept_advance, "vpdpppp", 0, 0, TAKES_PIECES), RUNTIME(switching_kept_move, "vpiidpp"),
	RUNTIME(switchingf_kept_start, "vpppp"), RUNTIME_OF(switchingf_kept_step, "vppppp", 0, 0, TAKES_PIECES),
	RUNTIME_OF(switchingf_kept_advance, "vpdpppp", 0, 0, TAKES_PIECES),
	RUNTIME(divided_place, "ipppp"), RUNTIME(divided_rises, "ipppp"),
	RUNTIME(divided_left, "ippppp"), RUNTIME(divided_next, "dppppdppp"),
	RUNTIME(dividedf_place, "ipppp"), RUNTIME(dividedf_rises, "ipppp"),
	RUNTIME(dividedf_left, "ippppp"), RUNTIME(dividedf_next, "fppppdppp"),
	{ "PL_DIVIDED_WORK", "ii", NULL, call_divided_work, NULL, 0, 0, TAKES_NO_MORE },
	{ "PL_SWITCHING_KEPT_WORK", "iiii", NULL, call_kept_work, NULL, 0, 0, TAKES_NO_MORE },
	{ "PL_SWITCHING_WORK", "iiii", NULL, call_work, NULL, 0, 0, TAKES_NO_MORE },
#define REAL_FUNCTION(NAME, name, argument, value, low, high) MATH(name),
#include "read/functions.def"
#undef REAL_FUNCTION
	MATH(fabs), MATH_OF_TWO(atan2), MATH_OF_TWO(pow), MATH_OF_TWO(fmin), MATH_OF_TWO(fmax),
};

const struct library_function *library_function(const char *name)
{
	for (size_t i = 0; i < sizeof functions / sizeof *functions; i++)
		if (strcmp(functions[i].name, name) == 0)
			return &functions[i];
	return NULL;
}

/* ---- what runs them ---- */

static void find_arguments(const struct operation *o, union word *word)
{
	for (int i = 0; i < o->count; i++) {
		const struct operation *a = o->list[i];
		if (a->type->kind == CTYPE_REAL)
			word[i].real = a->go.real(a);
		else if (a->type->kind == CTYPE_WHOLE)
			word[i].whole = a->go.whole(a);
		else
			word[i].place = a->go.place(a);
	}
}

static void count_call(const struct library_function *f, const union word *a)
{
	uint64_t size = (uint64_t)a[0].whole, products = 0;
	if (f->takes == TAKES_MATRIX)
		products = size * (uint64_t)a[1].whole;
	else if (f->takes == TAKES_FACTORS)
		products = (uint64_t)f->multiplications * size * size * size / 3;
	else if (f->takes == TAKES_SOLUTION)
		products = (uint64_t)f->multiplications * size * size;
	else if (f->takes == TAKES_PIECES) {            /* the step, and whether it is clear; both types begin so */
		const pl_contact *contact = a[f->type[2] == 'd' ? 3 : 2].place;
		const pl_switching *m = a[0].place;
		bool single = strncmp(f->name, "pl_switchingf", 13) == 0;
		uint64_t words = strstr(f->name, "_kept_") ? 3 : 1;
		size = (uint64_t)m->size;
		const int *halvings = single ? ((const pl_switchingf *)a[0].place)->halvings : m->halvings;
		products = size * (words * size + 3 + (halvings[contact->matrix] > 0 ? 4 * size : 0));
	}
	bool plain = f->takes <= TAKES_CALL;
	counted.calls += f->takes == TAKES_CALL;
	counted.multiplications += plain ? (uint64_t)f->multiplications : products;
	counted.additions += plain ? (uint64_t)f->additions : products;
}

static const struct library_function *function_of_call(const struct operation *o)
{
	return &functions[o->n];
}

static void run_call(const struct operation *o, union word *result)
{
	union word word[MOST_ARGUMENTS];
	const struct library_function *f = function_of_call(o);
	find_arguments(o, word);
	count_call(f, word);
	f->run(result, word);
}

static double run_real_call(const struct operation *o)
{
	union word result;
	run_call(o, &result);
	return result.real;
}

static double run_function(const struct operation *o)
{
	const struct library_function *f = function_of_call(o);
	counted.calls += f->takes == TAKES_CALL;
	return f->real(o->a->go.real(o->a));
}

static int64_t run_whole_call(const struct operation *o)
{
	union word result;
	run_call(o, &result);
	return result.whole;
}

static void *run_struct_call(const struct operation *o)
{
	union word result = { .place = o->at };
	run_call(o, &result);
	return o->at;
}

static enum going run_act_call(const struct operation *o)
{
	union word result;
	run_call(o, &result);
	return GOES_ON;
}

static const struct ctype *type_of(char letter)
{
	switch (letter) {
	case 'd': return &ctype_double;
	case 'f': return &ctype_float;
	case 'i': return &ctype_int;
	case 'l': return &ctype_long;
	case 'u': return &ctype_wide;
	default:  return NULL;
	}
}

/* As C does it: a number becomes the parameter's type; a count of steps counts as 64 bits. */
static const struct operation *as_parameter(const struct operation *a, char letter)
{
	if (letter == 'p' || letter == 's')
		return a->type->kind > CTYPE_REAL ? a : converted(a, pointer_to(&ctype_void));
	bool number = a->type->kind == CTYPE_WHOLE || a->type->kind == CTYPE_REAL;
	bool wide = letter == 'i' && a->type->size == 8;
	return !number ? NULL : wide ? a : converted(a, type_of(letter));
}

const struct operation *library_call(const struct library_function *f, const struct ctype *structure, int arguments,
				     const struct operation *const *argument)
{
	struct operation *o = NEW(struct operation);
	const struct operation **list = ARRAY(const struct operation *, (size_t)arguments + 1);
	if (strlen(f->type) != (size_t)arguments + 1 || arguments > MOST_ARGUMENTS || arguments == 0)
		return NULL;
	for (int i = 0; i < arguments; i++) {
		list[i] = as_parameter(argument[i], f->type[i + 1]);
		if (!list[i])
			return NULL;
	}
	*o = (struct operation){ .type = type_of(f->type[0]), .a = list[0], .list = list, .count = arguments,
				 .n = f - functions };
	if (f->type[0] == 'v') {
		o->go.act = run_act_call;
	} else if (f->type[0] == 's') {
		o->type = structure;
		o->at = allocate(1, structure->size);
		o->go.place = run_struct_call;
	} else if (o->type->kind == CTYPE_REAL) {
		o->go.real = f->real ? run_function : run_real_call;
	} else {
		o->go.whole = run_whole_call;
	}
	return o;
}
