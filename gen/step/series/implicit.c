/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How the highest coefficients enter the next ones. The k-th of a sum, product, quotient or root is linear in the k-th
 * of what it is made of, with factors that are the same for all k >= 1: the derivatives at the start. So the k-th of
 * what follows from a few others is an early part, of coefficients before k, and these factors, its gains, times their
 * k-th. The next coefficient of a state then waits for a multiplication and an addition, however deep the switching
 * function is: latency decides what a series costs. */
#include "inner.h"

enum { FEW = 2, ENOUGH = 4 };           /* others that a split sequence follows from; that a sum has anyway */

/* What its k-th is made of, the terms of a sum first; of an integral that is what its derivative is */
int sequence_operands(const struct sequence *s, int **operand)
{
	const struct linear_equations *e = s->equations;
	int count = 0;
	*operand = ARRAY(int, 2 * s->terms + 2 + (e ? e->n : 0));
	for (int i = 0; e && i < e->n; i++)
		(*operand)[count++] = e->residual[i];
	for (int k = 0; k < s->terms; k++) {
		const struct sequence_term *t = &s->term[k];
		if (t->kind == TERM_SEQUENCE || t->kind == TERM_PRODUCT)
			(*operand)[count++] = t->a;
		if (t->kind == TERM_PRODUCT && t->b != t->a)
			(*operand)[count++] = t->b;
	}
	if (s->kind != SEQUENCE_INTEGRAL && s->a != NONE)
		(*operand)[count++] = s->a;
	if (s->kind != SEQUENCE_INTEGRAL && s->b != NONE)
		(*operand)[count++] = s->b;
	return count;
}

static bool is_any(const bool *flag, const struct sequence *s)
{
	bool any = false;
	SCRATCH int *operand = NULL;
	for (int i = sequence_operands(s, &operand) - 1; i >= 0; i--)
		any = any || flag[operand[i]];
	return any;
}

static bool is_state(const struct sequence *s)
{
	return s->state != NONE;
}

/* Its k-th stands where others have their (k+1)-th. */
static bool is_late(const struct sequence *s)
{
	return s->kind == SEQUENCE_RATE;
}

/* Those too that have what a solution adds to the velocities */
static bool is_solution(const struct sequence *s)
{
	return s->kind == SEQUENCE_SOLUTION || s->shifts;
}

/* The k-th of a function is what its derivative has at k - 1. */
static bool follows_solution(const struct sequence *s, const bool *solved, const bool *behind)
{
	return s->kind != SEQUENCE_INTEGRAL ? is_solution(s) || is_any(solved, s)
					    : s->state == NONE && is_any(behind, s);
}

static void find_solved(const struct expansion *x, bool *solved, bool *behind)
{
	for (bool changed = true; changed;) {
		changed = false;
		for (int i = 0; i < x->count; i++) {
			const struct sequence *s = &x->sequence[i];
			const bool rate = s->kind == SEQUENCE_RATE && !s->shifts;
			const bool now = follows_solution(s, solved, behind);
			const bool late = rate ? solved[s->a] : s->kind != SEQUENCE_INTEGRAL && is_any(behind, s);
			changed = changed || now != solved[i] || late != behind[i];
			solved[i] = now;
			behind[i] = late;
		}
	}
}

/* Whether velocities are in it whose k-th has the one before of solutions */
static bool mark_ahead(const struct expansion *x, const bool *solved, int index)
{
	struct sequence *s = &x->sequence[index];
	SCRATCH int *operand = NULL;
	if (s->kind == SEQUENCE_INTEGRAL && s->state != NONE)
		s->ahead = is_any(solved, s);
	for (int i = sequence_operands(s, &operand) - 1; i >= 0 && s->kind == SEQUENCE_SUM; i--)
		s->ahead |= mark_ahead(x, solved, operand[i]);
	return s->ahead;
}

/* What shifted rates read */
static void find_ahead(const struct expansion *x, const bool *solved)
{
	for (int i = 0; i < x->count; i++)
		if (x->sequence[i].shifts)
			mark_ahead(x, solved, x->sequence[i].a);
}

/* Those that are so, and those made of them; through integrals or not */
static bool *made_of(const struct expansion *x, bool (*is_so)(const struct sequence *s), bool trajectory)
{
	bool *so = ARRAY(bool, x->count);
	for (bool changed = true; changed;) {
		changed = false;
		for (int i = 0; i < x->count; i++) {
			const struct sequence *s = &x->sequence[i];
			bool enters = trajectory || s->kind != SEQUENCE_INTEGRAL;
			bool now = is_so(s) || (enters && is_any(so, s));
			changed = changed || now != so[i];
			so[i] = now;
		}
	}
	return so;
}

static void include(struct sequence *s, int other)
{
	for (int i = 0; i < s->gains; i++)
		if (s->gain[i] == other)
			return;
	*MORE(s->gain, s->gains) = other;
}

static void include_operand(const struct expansion *x, const bool *depends, struct sequence *s, int operand)
{
	const struct sequence *o = &x->sequence[operand];
	if (!depends[operand])
		return;
	if (!o->split)
		include(s, operand);
	for (int i = 0; o->split && i < o->gains; i++)
		include(s, o->gain[i]);
}

static bool has_product(const struct sequence *s)
{
	for (int k = 0; k < s->terms; k++)
		if (s->term[k].kind == TERM_PRODUCT)
			return true;
	return false;
}

static void find_gains(const struct expansion *x, const bool *depends, const bool *late, int index)
{
	struct sequence *s = &x->sequence[index];
	SCRATCH int *operand = NULL;
	bool sum = s->kind == SEQUENCE_SUM || s->kind == SEQUENCE_INTEGRAL;
	bool made = sum || s->kind == SEQUENCE_QUOTIENT || s->kind == SEQUENCE_ROOT || s->kind == SEQUENCE_POWER;
	if (!made || !depends[index] || late[index] || is_any(late, s) || s->solved || s->behind || s->ahead)
		return;
	int operands = sequence_operands(s, &operand);
	for (int i = 0; i < operands; i++)
		include_operand(x, depends, s, operand[i]);
	int most = !sum ? FEW : operands > ENOUGH ? operands : ENOUGH;
	s->split = s->kind != SEQUENCE_INTEGRAL && s->gains > 0 && s->gains <= FEW;
	if (s->gains > most || (s->kind == SEQUENCE_INTEGRAL && !has_product(s) && s->gains == operands))
		s->gains = 0;
}

/* When a coefficient is there, in cycles: 4 for a multiplication, or an addition. What comes last is added last. */
struct schedule {
	const struct expansion *x;
	double *ready;              /* [sequence][k] */
	int at;
};

static double *ready_at(const struct schedule *w, int sequence, int k)
{
	return &w->ready[sequence * (w->x->order + 2) + k];
}

static void follow(const struct schedule *w, const struct sequence *s, int index, int k)
{
	bool integral = s->kind == SEQUENCE_INTEGRAL;
	double time = k && s->gains ? 12 : 0, *mine = ready_at(w, index, integral ? k + 1 : k);
	for (int i = 0; i < s->gains && k; i++)
		time = *ready_at(w, s->gain[i], k - 1) + 12 > time ? *ready_at(w, s->gain[i], k - 1) + 12 : time;
	for (int i = 0; i < s->gains; i++) {
		double term = *ready_at(w, s->gain[i], k) + 4;
		time = (term > time ? term : time) + 4;
	}
	for (int i = 0; i < s->terms && !s->gains; i++) {
		const struct sequence_term *t = &s->term[i];
		bool pair = t->kind == TERM_PRODUCT;
		double first = pair || t->kind == TERM_SEQUENCE ? *ready_at(w, t->a, k) : 0;
		double second = pair ? *ready_at(w, t->b, k) : 0, term = (first > second ? first : second) + 4;
		time = term > time ? term : time;
	}
	*mine = time;
}

/* A short list: by insertion, so that equal ones stay in order everywhere */
static void order_gains(const struct schedule *w, struct sequence *s)
{
	for (int i = 1; i < s->gains; i++)
		for (int j = i; j > 0 && *ready_at(w, s->gain[j - 1], w->at) > *ready_at(w, s->gain[j], w->at); j--) {
			int other = s->gain[j];
			s->gain[j] = s->gain[j - 1];
			s->gain[j - 1] = other;
		}
}

static void schedule(const struct expansion *x)
{
	enum { STEADY = 3 };
	struct schedule w = { .x = x, .ready = ARRAY(double, (size_t)(x->count * (x->order + 2))) };
	for (int k = 0; k < STEADY; k++) {
		w.at = k;
		for (int i = 0; i < x->count; i++)
			if (x->sequence[i].kind != SEQUENCE_INTEGRAL)
				follow(&w, &x->sequence[i], i, k);
		for (int i = 0; i < x->count; i++)
			if (x->sequence[i].kind == SEQUENCE_INTEGRAL)
				follow(&w, &x->sequence[i], i, k);
		for (int i = 0; i < x->count; i++)
			order_gains(&w, &x->sequence[i]);
	}
}

/* Sums before what they are in come first: operands are made before what is made of them, but for integrals. */
void find_implicit(struct expansion *x)
{
	const bool *depends = made_of(x, is_state, true), *late = made_of(x, is_late, false);
	SCRATCH bool *solved = ARRAY(bool, x->count), *behind = ARRAY(bool, x->count);
	find_solved(x, solved, behind);
	find_ahead(x, solved);
	for (int i = 0; i < x->count; i++) {
		x->sequence[i].known = !depends[i];
		x->sequence[i].behind = behind[i];
		x->sequence[i].solved = solved[i] && !behind[i] && x->sequence[i].kind != SEQUENCE_SOLUTION;
		if (x->sequence[i].kind != SEQUENCE_INTEGRAL)
			find_gains(x, depends, late, i);
	}
	for (int i = 0; i < x->count; i++)
		if (x->sequence[i].kind == SEQUENCE_INTEGRAL)
			find_gains(x, depends, late, i);
	schedule(x);
}

/* ---- what a gain is of ---- */

int place_of_gain(const struct sequence *s, int other)
{
	int place = 0;
	while (place < s->gains && s->gain[place] != other)
		place++;
	return place < s->gains ? place : NONE;
}

/* Whether the highest coefficient of a term reads that of another sequence */
static bool reads(const struct expansion *x, const struct sequence_term *term, int other)
{
	bool product = term->kind == TERM_PRODUCT, found = false;
	for (int i = 0; i < (product ? 2 : term->kind == TERM_SEQUENCE); i++) {
		int operand = i ? term->b : term->a;
		const struct sequence *s = &x->sequence[operand];
		found = found || (s->split ? place_of_gain(s, other) != NONE : operand == other);
	}
	return found;
}

const struct sequence_term *plain_term(const struct expansion *x, const struct sequence *s, int other)
{
	const struct sequence_term *only = NULL;
	if (s->kind != SEQUENCE_SUM && s->kind != SEQUENCE_INTEGRAL)
		return NULL;
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *term = &s->term[i];
		bool itself = term->kind == TERM_SEQUENCE && term->a == other && !x->sequence[other].split;
		if (!reads(x, term, other))
			continue;
		if (!itself || only)
			return NULL;
		only = term;
	}
	return only;
}
