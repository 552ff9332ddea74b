/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sizes of what a value of a series is summed from: what rounding may be measured by. */
#include "recurrences.h"

#include <math.h>

static tape_ref add_sizes(struct recurrences *r, tape_ref all, const struct list *list)
{
	for (int i = 0; i < list->terms; i++)
		all = plus(r->t, all, tape_unary(r->t, TAPE_SIZE, list->term[i].first));
	return all;
}

static tape_ref size_of_value(struct recurrences *r, int sequence)
{
	return tape_unary(r->t, TAPE_SIZE, recurrence(r, sequence, 0));
}

tape_ref recurrence_size(struct recurrences *r, int sequence)
{
	const struct sequence *s = sequence_of(r, sequence);
	struct list sum = { 0 }, last = { 0 };
	for (int i = 0; i < s->terms && s->kind == SEQUENCE_SUM; i++)
		recurrence_add_term(r, &sum, &last, &s->term[i], 0, recurrence);
	tape_ref all = add_sizes(r, add_sizes(r, TAPE_NONE, &sum), &last);
	return all == TAPE_NONE ? size_of_value(r, sequence) : all;
}

static bool has_parts(const struct recurrences *r, int sequence)
{
	const struct sequence *s = sequence_of(r, sequence);
	return s->state == NONE && (s->kind == SEQUENCE_CHOICE || s->kind == SEQUENCE_SOLUTION ||
				    (s->kind == SEQUENCE_SUM && s->terms > 0));
}

static tape_ref times_size(struct recurrences *r, tape_ref size, int sequence)
{
	return times(r->t, size, size_of_value(r, sequence));
}

/* Whether a diagonal divides whatever is chosen */
static bool divides(const struct recurrences *r, int sequence)
{
	const struct sequence *s = sequence == NONE ? NULL : sequence_of(r, sequence);
	if (s && s->kind == SEQUENCE_CHOICE)
		return divides(r, s->a) && divides(r, s->b);
	return s && (s->kind != SEQUENCE_SUM || (s->terms > 0 && s->term[0].factor[0] != 0));
}

/* By its own row: what M_jj x_j is the sum of, over M_jj. Where that may be 0 it is a force. */
static tape_ref size_of_solution(struct recurrences *r, int sequence)
{
	const struct linear_equations *e = sequence_of(r, sequence)->equations;
	const int j = sequence_of(r, sequence)->component, *row = e->matrix + j * e->n;
	tape_ref all = e->right[j] == NONE ? TAPE_NONE : recurrence_full_size(r, e->right[j]);
	if (!divides(r, row[j]))
		return size_of_value(r, sequence);
	for (int k = 0; k < e->n; k++)
		if (k != j && row[k] != NONE)
			all = plus(r->t, all, times_size(r, size_of_value(r, e->first + k), row[k]));
	return all == TAPE_NONE ? size_of_value(r, sequence)
				: tape_binary(r->t, TAPE_DIV, all, size_of_value(r, row[j]));
}

static bool is_solved(const struct recurrences *r, int sequence)
{
	return sequence_of(r, sequence)->solved || sequence_of(r, sequence)->kind == SEQUENCE_SOLUTION;
}

/* A product with what a solution stands in; TAPE_NONE: it is none */
static tape_ref size_of_product(struct recurrences *r, const struct sequence_term *term)
{
	if (term->kind != TERM_PRODUCT || (!is_solved(r, term->a) && !is_solved(r, term->b)))
		return TAPE_NONE;
	const bool first = is_solved(r, term->a);
	tape_ref size = recurrence_full_size(r, first ? term->a : term->b);
	return times(r->t, tape_double(r->t, fabs(term->factor[0])), times_size(r, size, first ? term->b : term->a));
}

tape_ref recurrence_full_size(struct recurrences *r, int sequence)
{
	struct tape *t = r->t;
	const struct sequence *s = sequence_of(r, sequence);
	if (!has_parts(r, sequence))
		return size_of_value(r, sequence);
	if (r->size[sequence] != TAPE_NONE)
		return r->size[sequence];
	struct list sum = { 0 }, last = { 0 };
	tape_ref all = TAPE_NONE;
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *term = &s->term[i];
		if (term->kind == TERM_SEQUENCE && has_parts(r, term->a))
			all = plus(t, all, times(t, tape_double(t, fabs(term->factor[0])),
						 recurrence_full_size(r, term->a)));
		else if (size_of_product(r, term) != TAPE_NONE)
			all = plus(t, all, size_of_product(r, term));
		else
			recurrence_add_term(r, &sum, &last, term, 0, recurrence);
	}
	all = add_sizes(r, add_sizes(r, all, &sum), &last);
	if (s->kind == SEQUENCE_SOLUTION)
		all = size_of_solution(r, sequence);
	if (s->kind == SEQUENCE_CHOICE) {
		tape_ref a = recurrence_full_size(r, s->a), b = recurrence_full_size(r, s->b);
		all = tape_select(t, recurrence_condition(r, s), a, b);
	}
	all = all == TAPE_NONE ? tape_number(t, 0) : all;
	return r->size[sequence] = recurrence_named(r, all, sequence, "size");
}

/* ---- what is set; all of them, none made yet ---- */

tape_ref recurrence_number(struct recurrences *r, int sequence, int k)
{
	tape_ref ref = recurrence(r, sequence, k);
	return ref == TAPE_NONE ? tape_number(r->t, 0) : ref;
}

void recurrence_set(struct recurrences *r, const char *target, int sequence, int k)
{
	tape_set(r->t, target, recurrence_number(r, sequence, k), 10, NULL);
}

static tape_ref *unmade(int count, tape_ref what)
{
	tape_ref *list = ARRAY(tape_ref, count + 1);
	for (int i = 0; i < count; i++)
		list[i] = what;
	return list;
}

struct recurrences *recurrences_new(const struct step *step, const struct expansion *x, struct series_names names)
{
	struct recurrences *r = NEW(struct recurrences);
	int all = x->count * (x->order + 2);
	*r = (struct recurrences){ .step = step, .x = x, .names = names, .t = tape_new(),
				   .lines = names.looped ? x->lines : NULL,
				   .made = unmade(all, UNKNOWN), .early = unmade(all, UNKNOWN),
				   .update = unmade(all, UNKNOWN),
				   .helper = unmade(x->count, TAPE_NONE), .size = unmade(x->count, TAPE_NONE) };
	r->gain = ARRAY(tape_ref *, x->count);
	r->solved = ARRAY(struct solved, x->equations + 1);
	for (int i = 0; i < x->count; i++) {
		const struct linear_equations *e = x->sequence[i].equations;
		r->gain[i] = unmade(x->sequence[i].gains, TAPE_NONE);
		if (e)
			r->solved[e->number].x = unmade(e->n * (x->order + 2), UNKNOWN);
	}
	return r;
}
