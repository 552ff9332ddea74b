/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gains: derivatives of the k-th coefficient by the k-th of another, k >= 1: a number, or what follows from the first
 * coefficients. Of an integral, times k + 1. What is newest enters by them (implicit.c). */
#include "recurrences.h"

static int place_of_gain(const struct sequence *s, int other)
{
	int place = 0;
	while (place < s->gains && s->gain[place] != other)
		place++;
	return place < s->gains ? place : NONE;
}

static tape_ref gain_ref(struct recurrences *r, int sequence, int other);

static tape_ref own_gain(struct recurrences *r, int sequence, int place)
{
	tape_ref *made = &r->gain[sequence][place];
	int other = sequence_of(r, sequence)->gain[place];
	if (*made == TAPE_NONE) {
		*made = gain_ref(r, sequence, other);
		if (r->names.name)
			recurrence_named(r, *made, sequence, format("by_%s", r->names.name(r->names.context, other)));
	}
	return *made;
}

/* In what reads it; TAPE_NONE: it is 0 */
static tape_ref gain(struct recurrences *r, int sequence, int other)
{
	const struct sequence *s = sequence_of(r, sequence);
	if (!s->split)
		return sequence == other ? tape_number(r->t, 1) : TAPE_NONE;
	int place = place_of_gain(s, other);
	return place == NONE ? TAPE_NONE : own_gain(r, sequence, place);
}

/* times the first of a sequence */
static tape_ref gain_times(struct recurrences *r, tape_ref gain, double factor, int sequence)
{
	return tape_scaled(r->t, factor, times(r->t, recurrence(r, sequence, 0), gain));
}

/* Of a sum */
static tape_ref gain_of_sum(struct recurrences *r, const struct sequence *s, int other)
{
	struct list sum = { 0 };
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *term = &s->term[i];
		const bool square = term->a == term->b;
		if (term->kind == TERM_SEQUENCE)
			add(&sum, tape_scaled(r->t, term->factor[0], gain(r, term->a, other)));
		if (term->kind != TERM_PRODUCT)
			continue;
		add(&sum, gain_times(r, gain(r, term->a, other), (square ? 2 : 1) * term->factor[0], term->b));
		if (!square)
			add(&sum, gain_times(r, gain(r, term->b, other), term->factor[0], term->a));
	}
	return sum.terms ? recurrence_chain(r->t, &sum) : tape_number(r->t, 0);
}

static tape_ref gain_ref(struct recurrences *r, int sequence, int other)
{
	struct tape *t = r->t;
	const struct sequence *s = sequence_of(r, sequence);
	if (s->kind == SEQUENCE_SUM || s->kind == SEQUENCE_INTEGRAL)
		return gain_of_sum(r, s, other);
	tape_ref a = s->a == NONE ? TAPE_NONE : gain(r, s->a, other);
	if (s->kind == SEQUENCE_POWER)
		a = times(t, a, recurrence(r, sequence, 0));
	if (s->kind == SEQUENCE_QUOTIENT)
		a = less(t, a, gain_times(r, gain(r, s->b, other), 1, sequence));
	a = times(t, a, recurrence_helper(r, sequence));
	return s->kind == SEQUENCE_POWER ? tape_scaled(t, recurrence_rounded(s->exponent), a) : a;
}

/* Some of the newest of a term is that of another */
static bool reads(const struct recurrences *r, const struct sequence_term *term, int other)
{
	bool product = term->kind == TERM_PRODUCT, found = false;
	for (int i = 0; i < (product ? 2 : term->kind == TERM_SEQUENCE); i++) {
		int operand = i ? term->b : term->a;
		const struct sequence *s = sequence_of(r, operand);
		found = found || (s->split ? place_of_gain(s, other) != NONE : operand == other);
	}
	return found;
}

/* The only term with this other is itself, with a number: its factor at each k */
static const struct sequence_term *plain_term(const struct recurrences *r, const struct sequence *s, int other)
{
	const struct sequence_term *only = NULL;
	if (s->kind != SEQUENCE_SUM && s->kind != SEQUENCE_INTEGRAL)
		return NULL;
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *term = &s->term[i];
		bool itself = term->kind == TERM_SEQUENCE && term->a == other && !sequence_of(r, other)->split;
		if (!reads(r, term, other))
			continue;
		if (!itself || only)
			return NULL;
		only = term;
	}
	return only;
}

/* 1/(k + 1) */
static struct multiplier part_at(struct recurrences *r, int k)
{
	SCRATCH double *part = ARRAY(double, r->x->order + 1);
	for (int i = 0; i <= r->x->order; i++)
		part[i] = recurrence_rounded(1.0 / (i + 1));
	return recurrence_factor_among(r, part, k);
}

/* early part + sum of gains times the k-th of the others, over k + 1 of an integral */
tape_ref recurrence_joined(struct recurrences *r, int sequence, const struct sequence *s, int k)
{
	struct tape *t = r->t;
	tape_ref all = s->split ? recurrence_early(r, sequence, k)
				: recurrence_made_of(r, sequence, s, k, recurrence_early);
	for (int i = 0; i < s->gains; i++) {
		const struct sequence_term *only = plain_term(r, s, s->gain[i]);
		tape_ref latest = recurrence(r, s->gain[i], k);
		if (latest == TAPE_NONE)
			continue;
		struct multiplier factor = s->kind == SEQUENCE_INTEGRAL ? part_at(r, k) : plain(1);
		all = plus(t, all, only ? recurrence_scaled(r, recurrence_factor_at(r, only, k), latest)
					: times(t, latest, recurrence_scaled(r, factor, own_gain(r, sequence, i))));
	}
	return all;
}
