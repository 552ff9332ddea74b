/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coefficients of a series as nodes of a tape, each from those before it (Griewank and Walther, Evaluating
 * Derivatives, 2008, chapter 13). What is newest decides how long the next one waits, so it is added last, and enters
 * by its gains (newest.c). */
#include "divided.h"
#include "expansion.h"
#include "step/tapes.h"

#include <math.h>

enum { UNKNOWN = -2 };                  /* beside TAPE_NONE: nothing */

struct recurrences {
	const struct step *step;
	const struct expansion *x;
	struct series_names names;
	struct tape *t;
	tape_ref *made, *early;     /* [sequence][k] */
	tape_ref *helper, *size;    /* per sequence: its inverse or half; of what its value is summed from */
	tape_ref **gain;            /* [sequence][gain] */
};

static const struct sequence *sequence_of(const struct recurrences *r, int sequence)
{
	return &r->x->sequence[sequence];
}

struct tape *tape_of_recurrences(const struct recurrences *r)
{
	return r->t;
}

/* ---- names ---- */

/* The node under the sequence's name, with a number or a word behind it */
static tape_ref named(struct recurrences *r, tape_ref ref, int sequence, const char *what)
{
	if (r->names.name && ref != TAPE_NONE)
		tape_name(r->t, ref, format("%s_%s", r->names.name(r->names.context, sequence), what));
	return ref;
}

/* ---- sums ---- */

struct addend { tape_ref first, then; };       /* then TAPE_NONE, or added behind it */
struct list {
	int terms;
	struct addend *term;
};

static void add_two(struct list *list, tape_ref first, tape_ref then)
{
	if (first == TAPE_NONE)
		return;
	*MORE(list->term, list->terms) = (struct addend){ first, then };
}

static void add(struct list *list, tape_ref ref)
{
	add_two(list, ref, TAPE_NONE);
}

static tape_ref plus(struct tape *t, tape_ref sum, tape_ref term)
{
	return sum == TAPE_NONE ? term : term == TAPE_NONE ? sum : tape_binary(t, TAPE_ADD, sum, term);
}

static tape_ref minus(struct tape *t, tape_ref a, tape_ref b)
{
	return tape_binary(t, TAPE_ADD, a, tape_unary(t, TAPE_NEG, b));
}

static tape_ref times(struct tape *t, tape_ref a, tape_ref b)
{
	return tape_binary(t, TAPE_MUL, a, b);
}

/* Oldest first, the newest added last, in two chains where it is long; of nothing TAPE_NONE */
static tape_ref chain(struct tape *t, const struct list *list)
{
	tape_ref sum[2] = { TAPE_NONE, TAPE_NONE };
	int chains = list->terms > 4 ? 2 : 1;
	for (int i = 0; i < list->terms; i++) {
		tape_ref *own = &sum[i % chains];
		*own = plus(t, plus(t, *own, list->term[i].first), list->term[i].then);
	}
	return plus(t, sum[0], sum[1]);
}

static tape_ref early_and_last(struct tape *t, const struct list *sum, const struct list *last)
{
	tape_ref all = chain(t, sum);
	for (int i = 0; i < last->terms; i++)
		all = plus(t, all, last->term[i].first);
	return all;
}

/* a_i b_j */
static tape_ref pair(struct recurrences *r, int a, int i, int b, int j)
{
	tape_ref first = recurrence(r, a, i), second = first == TAPE_NONE ? TAPE_NONE : recurrence(r, b, j);
	return second == TAPE_NONE ? TAPE_NONE : times(r->t, first, second);
}

/* What is new of one sequence, times the first of another with its factor */
static tape_ref newest(struct recurrences *r, tape_ref latest, double factor, int other)
{
	return latest == TAPE_NONE ? latest : times(r->t, latest, tape_scaled(r->t, factor, recurrence(r, other, 0)));
}

/* factor (a_1 b_{k-1} + ... + a_{k-1} b_1) */
static struct addend old_part(struct recurrences *r, int a, int b, int k, double factor)
{
	struct tape *t = r->t;
	struct list old = { 0 };
	struct addend none = { TAPE_NONE, TAPE_NONE };
	bool square = a == b;
	for (int gap = k % 2 ? 1 : 0; gap <= k - 2; gap += 2) {        /* those in the middle are the oldest */
		int i = (k - gap) / 2, j = k - i;
		add(&old, pair(r, a, i, b, j));
		if (i != j && !square)
			add(&old, pair(r, a, j, b, i));
	}
	if (old.terms == 0)
		return none;
	if (!square)
		return (struct addend){ tape_scaled(t, factor, chain(t, &old)), TAPE_NONE };
	tape_ref middle = k % 2 == 0 ? pair(r, a, k / 2, a, k / 2) : TAPE_NONE;
	bool with = middle != TAPE_NONE;
	struct list twice = { old.terms - with, old.term + with };
	tape_ref rest = twice.terms ? tape_scaled(t, 2, chain(t, &twice)) : TAPE_NONE;
	if (factor == 1)
		return with ? (struct addend){ middle, rest } : (struct addend){ rest, TAPE_NONE };
	return (struct addend){ tape_scaled(t, factor, plus(t, with ? middle : TAPE_NONE, rest)), TAPE_NONE };
}

static void add_addend(struct list *list, struct addend s)
{
	add_two(list, s.first, s.then);
}

static tape_ref whole(struct tape *t, struct addend s)
{
	return s.then == TAPE_NONE ? s.first : plus(t, s.first, s.then);
}

/* factor times the k-th of a b, its newest terms into `last` */
static void add_product(struct recurrences *r, struct list *sum, struct list *last, int a, int b, int k, double factor)
{
	if (k == 0) {
		add(sum, tape_scaled(r->t, factor, pair(r, a, 0, b, 0)));
		return;
	}
	add_addend(sum, old_part(r, a, b, k, factor));
	add(last, newest(r, recurrence(r, a, k), a == b ? 2 * factor : factor, b));
	if (a != b)
		add(last, newest(r, recurrence(r, b, k), factor, a));
}

static tape_ref column_ref(const struct recurrences *r, int column)
{
	return tape_of_column(r->t, &r->step->branch->system, column);
}

/* What at k follows from time, loads and inputs; true: it is that */
static bool add_known(struct recurrences *r, struct list *sum, const struct sequence_term *term, int k)
{
	struct tape *t = r->t;
	double factor = term->factor ? term->factor[k] : 1;
	if (term->kind == TERM_SEQUENCE || term->kind == TERM_PRODUCT)
		return factor == 0;
	if (term->slot >= 0) {
		tape_ref place = tape_operand(t, TAPE_TABLE, term->slot, k), column = column_ref(r, term->a);
		add(sum, column == TAPE_NONE ? place : times(t, place, column));
	} else if (factor != 0) {
		bool slope = term->kind == TERM_SLOPE;
		tape_ref x = term->kind == TERM_TIME    ? tape_power_of_time(t, term->a)
			     : term->kind == TERM_PARAM ? tape_operand(t, TAPE_PARAM, term->a, 0)
			     : term->kind == TERM_LOAD  ? column_ref(r, term->a)
							: tape_operand(t, TAPE_INPUT, term->a, slope);
		add(sum, x == TAPE_NONE ? tape_double(t, factor) : tape_scaled(t, factor, x));
	}
	return true;
}

static void add_term(struct recurrences *r, struct list *sum, struct list *last, const struct sequence_term *term,
		     int k)
{
	double factor = term->factor ? term->factor[k] : 1;
	if (add_known(r, sum, term, k))
		return;
	if (term->kind == TERM_PRODUCT)
		add_product(r, sum, last, term->a, term->b, k, factor);
	else
		add(last, tape_scaled(r->t, factor, recurrence(r, term->a, k)));
}

/* What stands in a sum at k, from the coefficients themselves */
static tape_ref sum_at(struct recurrences *r, const struct sequence *s, int k)
{
	struct list sum = { 0 }, last = { 0 };
	for (int i = 0; i < s->terms; i++)
		add_term(r, &sum, &last, &s->term[i], k);
	return early_and_last(r->t, &sum, &last);
}

/* ---- sizes of what a value is summed from ---- */

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
		add_term(r, &sum, &last, &s->term[i], 0);
	tape_ref all = add_sizes(r, add_sizes(r, TAPE_NONE, &sum), &last);
	return all == TAPE_NONE ? size_of_value(r, sequence) : all;
}

static bool has_parts(const struct recurrences *r, int sequence)
{
	const struct sequence *s = sequence_of(r, sequence);
	return s->state == NONE && (s->kind == SEQUENCE_CHOICE || (s->kind == SEQUENCE_SUM && s->terms > 0));
}

static tape_ref condition(struct recurrences *r, const struct sequence *s);

tape_ref recurrence_whole_size(struct recurrences *r, int sequence)
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
						 recurrence_whole_size(r, term->a)));
		else
			add_term(r, &sum, &last, term, 0);
	}
	all = add_sizes(r, add_sizes(r, all, &sum), &last);
	if (s->kind == SEQUENCE_CHOICE) {
		tape_ref a = recurrence_whole_size(r, s->a), b = recurrence_whole_size(r, s->b);
		all = tape_select(t, condition(r, s), a, b);
	}
	all = all == TAPE_NONE ? tape_number(t, 0) : all;
	return r->size[sequence] = named(r, all, sequence, "size");
}

/* ---- early parts, k >= 1 ---- */

static tape_ref early_ref(struct recurrences *r, int sequence, int k);

/* The part of the k-th that the newest of other sequences are not in; TAPE_NONE: there is none */
static tape_ref early(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	if (s->known)
		return recurrence(r, sequence, k);
	if (!s->split)
		return TAPE_NONE;
	int place = sequence * (r->x->order + 1) + k;
	if (r->early[place] == UNKNOWN) {
		tape_ref ref = early_ref(r, sequence, k);
		r->early[place] = ref == TAPE_NONE ? ref : named(r, ref, sequence, format("early_%d", k));
	}
	return r->early[place];
}

/* Of a sum: old terms of its products, and early parts of what is in it */
static void add_early_terms(struct recurrences *r, struct list *sum, const struct sequence *s, int k)
{
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *term = &s->term[i];
		double factor = term->factor ? term->factor[k] : 1;
		if (add_known(r, sum, term, k))
			continue;
		tape_ref a = early(r, term->a, k);
		if (term->kind == TERM_SEQUENCE) {
			add(sum, tape_scaled(r->t, factor, a));
			continue;
		}
		add_addend(sum, old_part(r, term->a, term->b, k, factor));
		tape_ref b = term->a == term->b ? TAPE_NONE : early(r, term->b, k);
		add(sum, newest(r, a, term->a == term->b ? 2 * factor : factor, term->b));
		add(sum, newest(r, b, factor, term->a));
	}
}

/* 1/b_0 of a quotient by b, 1/a_0 of a power of a, 1/(2 c_0) of a root c */
static tape_ref helper(struct recurrences *r, int sequence)
{
	const struct sequence *s = sequence_of(r, sequence);
	bool root = s->kind == SEQUENCE_ROOT;
	if (r->helper[sequence] != TAPE_NONE)
		return r->helper[sequence];
	int below = root ? sequence : s->kind == SEQUENCE_POWER ? s->a : s->b;
	tape_ref ref = tape_binary(r->t, TAPE_DIV, tape_double(r->t, root ? 0.5 : 1), recurrence(r, below, 0));
	return r->helper[sequence] = named(r, ref, sequence, root ? "half" : "inverse");
}

static tape_ref negative(struct tape *t, tape_ref ref)
{
	return tape_unary(t, TAPE_NEG, ref);
}

/* Of another sequence the k-th, or its early part */
typedef tape_ref part_of(struct recurrences *r, int sequence, int k);

/* (a_k - c_0 b_k - sum over 0 < j < k of c_j b_{k-j}) / b_0 */
static tape_ref quotient(struct recurrences *r, int sequence, const struct sequence *s, int k, part_of *part)
{
	struct tape *t = r->t;
	tape_ref above = s->a == NONE ? TAPE_NONE : part(r, s->a, k), below = part(r, s->b, k);
	struct list sum = { 0 };
	if (below != TAPE_NONE)
		add(&sum, times(t, recurrence(r, sequence, 0), below));
	for (int j = 1; j < k; j++)
		add(&sum, pair(r, sequence, j, s->b, k - j));
	if (above == TAPE_NONE && sum.terms == 0)
		return TAPE_NONE;
	if (sum.terms)
		above = above == TAPE_NONE ? negative(t, chain(t, &sum)) : minus(t, above, chain(t, &sum));
	return times(t, above, helper(r, sequence));
}

/* (a_k - sum over 0 < j < k of c_j c_{k-j}) / (2 c_0) */
static tape_ref root(struct recurrences *r, int sequence, const struct sequence *s, int k, part_of *part)
{
	struct tape *t = r->t;
	tape_ref above = part(r, s->a, k), old = whole(t, old_part(r, sequence, sequence, k, 1));
	if (above == TAPE_NONE && old == TAPE_NONE)
		return TAPE_NONE;
	if (old != TAPE_NONE)
		above = above == TAPE_NONE ? negative(t, old) : minus(t, above, old);
	return times(t, above, helper(r, sequence));
}

/* In the target's type */
static double rounded_double(double value)
{
	RATIONAL exact = ZERO;
	mpq_set_d(exact, value);
	value = round_rational(exact);
	return value;
}

static void add_power_terms(struct recurrences *r, struct list *sum, int sequence, const struct sequence *s, int first,
			    int k)
{
	for (int j = first; j < k; j++) {
		double factor = rounded_double((s->exponent * (k - j) - j) / k);
		add(sum, factor == 0 ? TAPE_NONE : tape_scaled(r->t, factor, pair(r, s->a, k - j, sequence, j)));
	}
}

static tape_ref over_base(struct recurrences *r, int sequence, const struct list *sum)
{
	return sum->terms ? times(r->t, chain(r->t, sum), helper(r, sequence)) : TAPE_NONE;
}

static tape_ref early_power(struct recurrences *r, int sequence, const struct sequence *s, int k)
{
	struct tape *t = r->t;
	tape_ref base = early(r, s->a, k);
	struct list sum = { 0 };
	if (base != TAPE_NONE)
		add(&sum, tape_scaled(t, rounded_double(s->exponent), times(t, base, recurrence(r, sequence, 0))));
	add_power_terms(r, &sum, sequence, s, 1, k);
	return over_base(r, sequence, &sum);
}

static tape_ref early_ref(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	struct list sum = { 0 };
	if (s->kind == SEQUENCE_QUOTIENT)
		return quotient(r, sequence, s, k, early);
	if (s->kind == SEQUENCE_ROOT)
		return root(r, sequence, s, k, early);
	if (s->kind == SEQUENCE_POWER)
		return early_power(r, sequence, s, k);
	add_early_terms(r, &sum, s, k);
	return chain(r->t, &sum);
}

/* ---- gains: derivatives of the k-th by the k-th of another, k >= 1: a number, or what follows from the first
 * coefficients. Of an integral, times k + 1 ---- */

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
			named(r, *made, sequence, format("by_%s", r->names.name(r->names.context, other)));
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

static bool is_unit(const struct recurrences *r, tape_ref ref)
{
	const struct tape_node *n = tape_node(r->t, ref);
	return n->op == TAPE_CONSTANT && mpq_cmp_ui(n->value, 1, 1) == 0;
}

/* times the first of a sequence */
static tape_ref gain_times(struct recurrences *r, tape_ref gain, double factor, int sequence)
{
	if (gain == TAPE_NONE)
		return TAPE_NONE;
	tape_ref first = recurrence(r, sequence, 0);
	return tape_scaled(r->t, factor, is_unit(r, gain) ? first : times(r->t, first, gain));
}

/* Of a sum */
static tape_ref gain_of_sum(struct recurrences *r, const struct sequence *s, int other)
{
	struct list sum = { 0 };
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *term = &s->term[i];
		if (term->kind != TERM_SEQUENCE && term->kind != TERM_PRODUCT)
			continue;
		bool product = term->kind == TERM_PRODUCT;
		tape_ref a = gain(r, term->a, other), b = product ? gain(r, term->b, other) : TAPE_NONE;
		double factor = term->factor[0];
		if (term->kind == TERM_SEQUENCE) {
			bool unit = a != TAPE_NONE && is_unit(r, a);
			add(&sum, unit ? tape_double(r->t, factor) : tape_scaled(r->t, factor, a));
		} else if (term->a == term->b) {
			add(&sum, gain_times(r, a, 2 * factor, term->a));
		} else {
			add(&sum, gain_times(r, a, factor, term->b));
			add(&sum, gain_times(r, b, factor, term->a));
		}
	}
	return sum.terms ? chain(r->t, &sum) : tape_number(r->t, 0);
}

static tape_ref times_gain(struct recurrences *r, tape_ref gain, tape_ref x)
{
	return is_unit(r, gain) ? x : times(r->t, gain, x);
}

static tape_ref gain_ref(struct recurrences *r, int sequence, int other)
{
	struct tape *t = r->t;
	const struct sequence *s = sequence_of(r, sequence);
	if (s->kind == SEQUENCE_SUM || s->kind == SEQUENCE_INTEGRAL)
		return gain_of_sum(r, s, other);
	tape_ref a = s->a == NONE ? TAPE_NONE : gain(r, s->a, other), by = helper(r, sequence);
	if (s->kind == SEQUENCE_ROOT)
		return times_gain(r, a, by);
	if (s->kind == SEQUENCE_POWER) {
		tape_ref product = times(t, times_gain(r, a, recurrence(r, sequence, 0)), by);
		return tape_scaled(t, rounded_double(s->exponent), product);
	}
	tape_ref below = gain_times(r, gain(r, s->b, other), 1, sequence);
	if (below == TAPE_NONE)
		return times_gain(r, a, by);
	return times(t, a == TAPE_NONE ? negative(t, below) : minus(t, a, below), by);
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

/* early part + sum of gains times the k-th of the others, over k + 1 of an integral */
static tape_ref joined(struct recurrences *r, int sequence, int k)
{
	struct tape *t = r->t;
	const struct sequence *s = sequence_of(r, sequence);
	struct list sum = { 0 }, last = { 0 };
	if (s->split)
		add(&sum, early(r, sequence, k));
	else
		add_early_terms(r, &sum, s, k);
	for (int i = 0; i < s->gains; i++) {
		const struct sequence_term *plain = plain_term(r, s, s->gain[i]);
		tape_ref latest = recurrence(r, s->gain[i], k);
		if (latest == TAPE_NONE)
			continue;
		double factor = s->kind == SEQUENCE_INTEGRAL ? rounded_double(1.0 / (k + 1)) : 1;
		add(&last, plain ? tape_scaled(t, plain->factor[k], latest)
				 : times(t, latest, tape_scaled(t, factor, own_gain(r, sequence, i))));
	}
	return early_and_last(t, &sum, &last);
}

/* ---- coefficients ---- */

static tape_ref value_at_start(struct recurrences *r, const struct sequence *s)
{
	if (s->state != NONE)
		return tape_operand(r->t, TAPE_STATE, s->state, 0);
	tape_ref a = recurrence(r, s->a, 0);
	if (s->function == FN_ATAN2)
		return tape_binary(r->t, TAPE_ATAN2, a, recurrence(r, s->b, 0));
	return tape_call(r->t, s->function, a);
}

/* At k = 0 */
static tape_ref first(struct recurrences *r, const struct sequence *s)
{
	struct tape *t = r->t;
	tape_ref a = s->a == NONE ? tape_number(t, 1) : recurrence(r, s->a, 0);
	return s->kind == SEQUENCE_ROOT	   ? tape_call(t, FN_SQRT, a)
	       : s->kind == SEQUENCE_POWER ? tape_binary(t, TAPE_POWER, a, tape_double(t, s->exponent))
					   : tape_binary(t, TAPE_DIV, a, recurrence(r, s->b, 0));
}

/* sum over j < k of (exponent (k-j) - j)/k a_{k-j} c_j / a_0 */
static tape_ref power(struct recurrences *r, int sequence, const struct sequence *s, int k)
{
	struct list sum = { 0 };
	add_power_terms(r, &sum, sequence, s, 0, k);
	return over_base(r, sequence, &sum);
}

/* By interval[], or by the numbers themselves */
static tape_ref condition(struct recurrences *r, const struct sequence *s)
{
	struct tape *t = r->t;
	if (s->choice == CHOICE_BY_TIME) {
		tape_ref left = tape_form_in_time(t, s->left);
		return tape_compare(t, s->comparison, left, tape_form_in_time(t, s->right));
	}
	if (s->choice == CHOICE_BY_SEQUENCE)
		return tape_binary(t, TAPE_UNEQUAL, recurrence(r, s->test, 0), tape_number(t, 0));
	bool held = s->choice == CHOICE_BY_HOLD;
	const struct divided *d = &r->x->expression[s->expression];
	if (r->names.by_numbers) {
		tape_ref at = tape_constant(t, d->at[s->breakpoint]);
		return tape_compare(t, held ? CMP_EQ : CMP_GT, recurrence(r, d->sequence, 0), at);
	}
	return held ? tape_operand(t, TAPE_HELD, s->expression, breakpoint_rank(r->x, s->expression, s->breakpoint) + 1)
		    : tape_operand(t, TAPE_ABOVE, s->expression, upper_rank(r->x, s->expression, s->breakpoint));
}

static tape_ref choice(struct recurrences *r, const struct sequence *s, int k)
{
	struct tape *t = r->t;
	tape_ref a = recurrence(r, s->a, k), b = recurrence(r, s->b, k), zero = tape_number(t, 0);
	if (a == TAPE_NONE && b == TAPE_NONE)
		return TAPE_NONE;
	return tape_select(t, condition(r, s), a == TAPE_NONE ? zero : a, b == TAPE_NONE ? zero : b);
}

static bool is_constant_sequence(struct recurrences *r, int sequence)
{
	return sequence == NONE || recurrence(r, sequence, 1) == TAPE_NONE;
}

static tape_ref made(struct recurrences *r, int sequence, const struct sequence *s, int k)
{
	int from = s->kind == SEQUENCE_INTEGRAL ? k - 1 : k;
	bool function = s->kind == SEQUENCE_INTEGRAL && s->state == NONE;
	if (function && k > 0 && is_constant_sequence(r, s->a) && is_constant_sequence(r, s->b))
		return TAPE_NONE;
	if (s->gains && from > 0)
		return joined(r, sequence, from);
	switch (s->kind) {
	case SEQUENCE_SUM:
	case SEQUENCE_INTEGRAL: return from < 0 ? value_at_start(r, s) : sum_at(r, s, from);
	case SEQUENCE_QUOTIENT: return k ? quotient(r, sequence, s, k, recurrence) : first(r, s);
	case SEQUENCE_ROOT:     return k ? root(r, sequence, s, k, recurrence) : first(r, s);
	case SEQUENCE_POWER:    return k ? power(r, sequence, s, k) : first(r, s);
	case SEQUENCE_CHOICE:   return choice(r, s, k);
	default:                break;
	}
	return tape_scaled(r->t, k + 1, recurrence(r, s->a, k + 1));
}

tape_ref recurrence(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	tape_ref *ref = &r->made[sequence * (r->x->order + 1) + k];
	if (*ref == UNKNOWN)
		*ref = named(r, made(r, sequence, s, k), sequence, format("%d", k));
	if (*ref == TAPE_NONE && k == 0)
		*ref = tape_number(r->t, 0);
	return *ref;
}

void recurrence_set(struct recurrences *r, const char *target, int sequence, int k)
{
	tape_ref ref = recurrence(r, sequence, k);
	tape_set(r->t, target, ref == TAPE_NONE ? tape_number(r->t, 0) : ref, 10, NULL);
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
	int all = x->count * (x->order + 1);
	*r = (struct recurrences){ .step = step, .x = x, .names = names, .t = tape_new(),
				   .made = unmade(all, UNKNOWN), .early = unmade(all, UNKNOWN),
				   .helper = unmade(x->count, TAPE_NONE), .size = unmade(x->count, TAPE_NONE) };
	r->gain = ARRAY(tape_ref *, x->count);
	for (int i = 0; i < x->count; i++)
		r->gain[i] = unmade(x->sequence[i].gains, TAPE_NONE);
	return r;
}
