/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exact numbers that follow from some that are given: a record of the sums, products and quotients that made them, as
 * taping by overloading makes one (Griewank and Walther, Evaluating Derivatives, 2008, chapter 6). A number is known by
 * its size: where what is given was drawn at random, two that are equal are the same function of it (Schwartz, Journal
 * of the ACM 27, 1980), so copies need no mark. Each is followed at a second place, where what has the same value is a
 * constant, and at the spec's values, by which pivots are chosen. */
#include <gmp.h>

typedef void plain_operation(mpq_ptr result, mpq_srcptr a, mpq_srcptr b);
static plain_operation *const plain[] = { mpq_add, mpq_sub, mpq_mul, mpq_div };

#include "base/base.h"

#include <string.h>

enum operation { ADD, SUB, MUL, DIV };
enum { BUCKETS = 1 << 16 };
enum { THERE, SPEC, ELSEWHERE };
struct followed {
	mpq_t here, *elsewhere;     /* above 0 here */
	int next;                   /* of the same hash, + 1; 0: none */
};
static struct {
	bool records;
	int count, bucket[BUCKETS];
	struct traced *number;
	struct followed *value;
} trace;

/* ---- which number is it? ---- */

static int *bucket_of(mpz_srcptr numerator, mpz_srcptr denominator)
{
	const uint64_t hash = (uint64_t)mpz_get_ui(numerator) * UINT64_C(0x9e3779b97f4a7c15) +
			      (uint64_t)mpz_get_ui(denominator) * 3;
	return &trace.bucket[(hash ^ hash >> 29) % BUCKETS];
}

static int find_size(mpz_srcptr numerator, mpz_srcptr denominator)
{
	int i = *bucket_of(numerator, denominator) - 1;
	while (i >= 0 && (mpz_cmpabs(mpq_numref(trace.value[i].here), numerator) != 0 ||
			  mpz_cmpabs(mpq_denref(trace.value[i].here), denominator) != 0))
		i = trace.value[i].next - 1;
	return i;
}

/* Its values become the number's. */
static int enter(struct traced n, mpq_t here, const mpq_t *elsewhere)
{
	*MORE(trace.number, trace.count) = n;
	ENLARGE(trace.value, (size_t)trace.count);
	struct followed *value = &trace.value[trace.count - 1];
	mpq_init(value->here);
	mpq_swap(value->here, here);
	value->elsewhere = rationals_copied(ELSEWHERE, elsewhere);
	int *bucket = bucket_of(mpq_numref(value->here), mpq_denref(value->here));
	value->next = *bucket;
	return (*bucket = trace.count) - 1;
}

static struct traced_part constant_part(long value)
{
	struct traced_part part = { -1, false, NULL };
	mpq_t *constant = rationals(1);
	mpq_set_si(*constant, value, 1);
	part.constant = *constant;
	return part;
}

/* That of this size, or 1 over one; -1: none is */
static int find(mpq_srcptr x)
{
	const int found = find_size(mpq_numref(x), mpq_denref(x));
	if (found >= 0 || mpq_sgn(x) == 0)
		return found;
	const int inverse = find_size(mpq_denref(x), mpq_numref(x));
	if (inverse < 0 || mpq_sgn(trace.value[inverse].elsewhere[THERE]) == 0)
		return -1;
	RATIONAL here = ZERO;
	RATIONALS *elsewhere = rationals(ELSEWHERE);
	mpq_inv(here, trace.value[inverse].here);
	for (int i = 0; i < ELSEWHERE; i++)
		if (mpq_sgn(trace.value[inverse].elsewhere[i]) != 0)
			mpq_inv(elsewhere[i], trace.value[inverse].elsewhere[i]);
	return enter((struct traced){ TRACED_QUOTIENT, constant_part(1), { inverse, false, NULL } }, here, elsewhere);
}

/* ---- what is done ---- */

/* `elsewhere`: its values there */
static struct traced_part part_of(mpq_srcptr x, int number, mpq_t *elsewhere)
{
	struct traced_part part = { number, mpq_sgn(x) < 0, NULL };
	if (number < 0) {
		mpq_t *constant = rationals(1);
		mpq_abs(*constant, x);
		part.constant = *constant;
	}
	for (int i = 0; i < ELSEWHERE; i++)
		(number >= 0 && part.negative ? mpq_neg : mpq_set)(
			elsewhere[i], number < 0 ? x : trace.value[number].elsewhere[i]);
	return part;
}

/* result = a op b, and elsewhere; of its size, which no number has yet, signs of terms follow */
static void record(enum operation op, struct traced_part a, struct traced_part b, mpq_srcptr result, mpq_t *elsewhere)
{
	RATIONAL size = ZERO;
	const bool negative = mpq_sgn(result) < 0, sum = op <= SUB;
	mpq_abs(size, result);
	for (int i = 0; i < ELSEWHERE && negative; i++)
		mpq_neg(elsewhere[i], elsewhere[i]);
	if (mpq_equal(size, elsewhere[THERE]))
		return;
	a.negative = sum && a.negative != negative;
	b.negative = sum && b.negative != (negative != (op == SUB));
	enter((struct traced){ sum ? TRACED_SUM : op == MUL ? TRACED_PRODUCT : TRACED_QUOTIENT, a, b }, size,
	      elsewhere);
}

static void operate(enum operation op, mpq_ptr result, mpq_srcptr a, mpq_srcptr b)
{
	const int first = trace.records ? find(a) : -1, second = trace.records ? find(b) : -1;
	if (first < 0 && second < 0) {
		plain[op](result, a, b);
		return;
	}
	RATIONALS *of = rationals(ELSEWHERE), *by = rationals(ELSEWHERE);
	const struct traced_part x = part_of(a, first, of), y = part_of(b, second, by);
	plain[op](result, a, b);
	trace.records = op != DIV || mpq_sgn(by[THERE]) != 0;
	if (mpq_sgn(result) == 0 || !trace.records || find(result) >= 0)
		return;
	for (int i = 0; i < ELSEWHERE; i++)
		if (op != DIV || mpq_sgn(by[i]) != 0)
			plain[op](of[i], of[i], by[i]);
	record(op, x, y, result, of);
}

void traced_add(mpq_ptr result, mpq_srcptr a, mpq_srcptr b)
{
	operate(ADD, result, a, b);
}

void traced_sub(mpq_ptr result, mpq_srcptr a, mpq_srcptr b)
{
	operate(SUB, result, a, b);
}

void traced_mul(mpq_ptr result, mpq_srcptr a, mpq_srcptr b)
{
	operate(MUL, result, a, b);
}

void traced_div(mpq_ptr result, mpq_srcptr a, mpq_srcptr b)
{
	operate(DIV, result, a, b);
}

/* ---- the record ---- */

void trace_from(int count, const mpq_t *here, const mpq_t *there, const mpq_t *spec)
{
	memset(trace.bucket, 0, sizeof trace.bucket);
	trace.count = 0;
	trace.number = NULL;
	trace.value = NULL;
	trace.records = true;
	for (int i = 0; i < count; i++) {
		RATIONAL size = ZERO;
		RATIONALS *elsewhere = rationals(ELSEWHERE);
		mpq_abs(size, here[i]);
		(mpq_sgn(here[i]) < 0 ? mpq_neg : mpq_set)(elsewhere[THERE], there[i]);
		(mpq_sgn(here[i]) < 0 ? mpq_neg : mpq_set)(elsewhere[SPEC], spec[i]);
		enter((struct traced){ .op = TRACED_GIVEN, .a = { i, mpq_sgn(here[i]) < 0, NULL } }, size, elsewhere);
	}
}

void trace_pause(void)
{
	trace.records = false;
}

bool is_traced(size_t count, mpq_srcptr x)
{
	bool any = false;
	for (size_t i = 0; i < count && trace.records && !any; i++)
		any = find(x + i) >= 0;
	return any;
}

int traced_as(mpq_srcptr here, mpq_srcptr there)
{
	RATIONAL size = ZERO;
	const int number = mpq_equal(here, there) ? -1 : find(here);
	if (number < 0)
		return number;
	(mpq_sgn(here) < 0 ? mpq_neg : mpq_set)(size, trace.value[number].elsewhere[THERE]);
	return mpq_equal(size, there) ? number : -1;
}

void product_at_spec(mpq_ptr product, mpq_srcptr x, mpq_srcptr factor)
{
	RATIONALS *elsewhere = rationals(ELSEWHERE);
	part_of(x, find(x), elsewhere);
	plain[MUL](product, elsewhere[SPEC], factor);
}

const struct traced *trace_record(int *count)
{
	*count = trace.count;
	return trace.number;
}
