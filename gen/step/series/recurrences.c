/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The coefficients of a series as nodes of a tape, each from those before it (Griewank and Walther, Evaluating
 * Derivatives, 2008, chapter 13). The next one waits for the highest coefficients, so these are added last, and enter
 * by their gains (implicit.c). */
#include "recurrences.h"
#include "step/tapes.h"

#include <math.h>

struct tape *tape_of_recurrences(const struct recurrences *r)
{
	return r->t;
}

void recurrences_begin_turn(struct recurrences *r)
{
	if (r->lines->across && r->names.turn)
		tape_statement(r->t, r->names.turn);
}

/* ---- sums ---- */

/* a_i b_j */
static tape_ref pair(struct recurrences *r, int a, int i, int b, int j)
{
	tape_ref first = recurrence(r, a, i);
	return first == TAPE_NONE ? first : times(r->t, first, recurrence(r, b, j));
}

/* The highest coefficient of one sequence, times the first of another with its factor */
static tape_ref highest(struct recurrences *r, tape_ref latest, struct multiplier factor, int other)
{
	if (latest == TAPE_NONE)
		return latest;
	return times(r->t, latest, recurrence_scaled(r, factor, recurrence(r, other, 0)));
}

/* Has it coefficients of the orders that the loop makes? */
static bool goes_on(const struct recurrences *r, int sequence)
{
	return sequence_of(r, sequence)->top > 0;
}

/* A sum of products of what stands in the table, by a function of the target */
static tape_ref summed(struct recurrences *r, enum stage_kind kind, int a, int b, int k, double exponent)
{
	if (!goes_on(r, a) || !goes_on(r, b))
		return TAPE_NONE;
	tape_ref ref = recurrence_staged(r, kind, a, b, k, exponent);
	if (r->names.name)
		tape_name(r->t, ref, format("%s_%s_old_%s", r->names.name(r->names.context, a),
					    r->names.name(r->names.context, b), recurrence_turn_text(k)));
	return ref;
}

/* factor (a_1 b_{k-1} + ... + a_{k-1} b_1) */
static void add_old(struct recurrences *r, struct list *sum, int a, int b, int k, struct multiplier factor)
{
	struct tape *t = r->t;
	struct list old = { 0 };
	const bool square = a == b;
	if (in_loop(k)) {
		add(sum, recurrence_scaled(r, factor, summed(r, square ? STAGE_SQUARE : STAGE_INNER, a, b, k, 0)));
		return;
	}
	for (int gap = k % 2 ? 1 : 0; gap <= k - 2; gap += 2) {        /* those in the middle are the oldest */
		int i = (k - gap) / 2, j = k - i;
		if (i != j || !square)
			add(&old, pair(r, a, i, b, j));
		if (i != j && !square)
			add(&old, pair(r, a, j, b, i));
	}
	tape_ref middle = square && k % 2 == 0 ? pair(r, a, k / 2, a, k / 2) : TAPE_NONE;
	tape_ref rest = tape_scaled(t, square ? 2 : 1, recurrence_chain(t, &old));
	if (factor.number == 1 && middle != TAPE_NONE)
		add_two(sum, middle, rest);
	else
		add(sum, recurrence_scaled(r, factor, plus(t, middle, rest)));
}

static tape_ref column_ref(const struct recurrences *r, int column)
{
	return tape_of_column(r->t, &r->step->branch->system, column);
}

/* What at k follows from time, loads and inputs; true: it is that */
static bool add_known(struct recurrences *r, struct list *sum, const struct sequence_term *term, int k)
{
	struct tape *t = r->t;
	struct multiplier factor = recurrence_factor_at(r, term, k);
	if (term->kind == TERM_SEQUENCE || term->kind == TERM_PRODUCT)
		return factor.number == 0;
	if (term->slot >= 0) {
		tape_ref entry = !in_loop(k) ? tape_operand(t, TAPE_TABLE, term->slot, k)
					   : recurrence_staged(r, STAGE_FORCE, term->slot, NONE, k, 0);
		tape_ref column = column_ref(r, term->a);
		add(sum, column == TAPE_NONE ? entry : times(t, entry, column));
	} else if (factor.number != 0) {
		bool slope = term->kind == TERM_SLOPE;
		tape_ref x = term->kind == TERM_TIME    ? tape_power_of_time(t, term->a)
			     : term->kind == TERM_PARAM ? tape_operand(t, TAPE_PARAM, term->a, 0)
			     : term->kind == TERM_LOAD  ? column_ref(r, term->a)
							: tape_operand(t, TAPE_INPUT, term->a, slope);
		tape_ref alone = factor.table == TAPE_NONE ? tape_double(t, factor.number) : factor.table;
		add(sum, x == TAPE_NONE ? alone : recurrence_scaled(r, factor, x));
	}
	return true;
}

/* What a term has at k, of parts of its operands: the highest coefficients into `last` */
void recurrence_add_term(struct recurrences *r, struct list *sum, struct list *last, const struct sequence_term *term,
		     int k, part_of *part)
{
	struct multiplier factor = recurrence_factor_at(r, term, k);
	const bool square = term->a == term->b;
	if (add_known(r, sum, term, k))
		return;
	if (term->kind == TERM_SEQUENCE) {
		add(last, recurrence_scaled(r, factor, part(r, term->a, k)));
	} else if (k == 0) {
		tape_ref first = part(r, term->a, 0);
		first = first == TAPE_NONE ? first : times(r->t, first, part(r, term->b, 0));
		add(sum, recurrence_scaled(r, factor, first));
	} else {
		add_old(r, sum, term->a, term->b, k, factor);
		add(last, highest(r, part(r, term->a, k), square ? twice(factor) : factor, term->b));
		if (!square)
			add(last, highest(r, part(r, term->b, k), factor, term->a));
	}
}

/* ---- choices ---- */

/* By interval[], or by the numbers themselves */
tape_ref recurrence_condition(struct recurrences *r, const struct sequence *s)
{
	struct tape *t = r->t;
	if (s->choice == CHOICE_BY_TIME) {
		tape_ref left = tape_form_in_time(t, s->left);
		return tape_compare(t, s->comparison, left, tape_form_in_time(t, s->right));
	}
	if (s->choice == CHOICE_BY_SEQUENCE)
		return tape_binary(t, TAPE_UNEQUAL, recurrence(r, s->test, 0), tape_number(t, 0));
	bool held = s->choice == CHOICE_BY_HOLD;
	const struct series_switching *d = &r->x->function[s->switching];
	if (r->names.by_numbers) {
		tape_ref at = tape_constant(t, d->at[s->breakpoint]);
		return tape_compare(t, held ? CMP_EQ : CMP_GT, recurrence(r, d->sequence, 0), at);
	}
	return held ? tape_operand(t, TAPE_HELD, s->switching, breakpoint_rank(r->x, s->switching, s->breakpoint) + 1)
		    : tape_operand(t, TAPE_ABOVE, s->switching, upper_rank(r->x, s->switching, s->breakpoint));
}

static tape_ref choice(struct recurrences *r, const struct sequence *s, int k, part_of *part)
{
	struct tape *t = r->t;
	tape_ref a = part(r, s->a, k), b = part(r, s->b, k), zero = tape_number(t, 0);
	if (a == TAPE_NONE && b == TAPE_NONE)
		return TAPE_NONE;
	return tape_select(t, recurrence_condition(r, s), a == TAPE_NONE ? zero : a, b == TAPE_NONE ? zero : b);
}

/* ---- of each kind, k >= 1; of a sum k >= 0 ---- */

/* 1/b_0 of a quotient by b, 1/a_0 of a power of a, 1/(2 c_0) of a root c */
static tape_ref helper(struct recurrences *r, int sequence)
{
	const struct sequence *s = sequence_of(r, sequence);
	bool root = s->kind == SEQUENCE_ROOT;
	if (r->helper[sequence] != TAPE_NONE)
		return r->helper[sequence];
	int below = root ? sequence : s->kind == SEQUENCE_POWER ? s->a : s->b;
	tape_ref ref = tape_binary(r->t, TAPE_DIV, tape_double(r->t, root ? 0.5 : 1), recurrence(r, below, 0));
	return r->helper[sequence] = recurrence_named(r, ref, sequence, root ? "half" : "inverse");
}

/* over b_0, a_0 or 2 c_0 */
static tape_ref over(struct recurrences *r, int sequence, tape_ref above)
{
	return above == TAPE_NONE ? above : times(r->t, above, helper(r, sequence));
}

/* (a_k - c_0 b_k - sum over 0 < j < k of c_j b_{k-j}) / b_0 */
static tape_ref quotient(struct recurrences *r, int sequence, const struct sequence *s, int k, part_of *part)
{
	struct list sum = { 0 };
	tape_ref above = s->a == NONE ? TAPE_NONE : part(r, s->a, k);
	if (k == 0)
		return over(r, sequence, above);
	add(&sum, times(r->t, recurrence(r, sequence, 0), part(r, s->b, k)));
	if (in_loop(k))
		add(&sum, summed(r, STAGE_QUOTIENT, sequence, s->b, k, 0));
	for (int j = 1; j < k && !in_loop(k); j++)
		add(&sum, pair(r, sequence, j, s->b, k - j));
	return over(r, sequence, less(r->t, above, recurrence_chain(r->t, &sum)));
}

/* (a_k - sum over 0 < j < k of c_j c_{k-j}) / (2 c_0) */
static tape_ref root(struct recurrences *r, int sequence, const struct sequence *s, int k, part_of *part)
{
	struct list old = { 0 };
	add_old(r, &old, sequence, sequence, k, plain(1));
	return over(r, sequence, less(r->t, part(r, s->a, k), recurrence_chain(r->t, &old)));
}

/* sum over j < k of (exponent (k-j) - j)/k a_{k-j} c_j, over a_0 */
static tape_ref power(struct recurrences *r, int sequence, const struct sequence *s, int k, part_of *part)
{
	struct list sum = { 0 };
	tape_ref last = times(r->t, part(r, s->a, k), recurrence(r, sequence, 0));
	add(&sum, tape_scaled(r->t, recurrence_rounded(s->exponent), last));
	if (in_loop(k))
		add(&sum, summed(r, STAGE_POWER, s->a, sequence, k, recurrence_rounded(s->exponent)));
	for (int j = 1; j < k && !in_loop(k); j++) {
		double factor = recurrence_rounded((s->exponent * (k - j) - j) / k);
		add(&sum, factor == 0 ? TAPE_NONE : tape_scaled(r->t, factor, pair(r, s->a, k - j, sequence, j)));
	}
	return over(r, sequence, recurrence_chain(r->t, &sum));
}

/* The k-th, or its early part: old terms of products, and early parts of what it is made of */
static tape_ref made_of(struct recurrences *r, int sequence, const struct sequence *s, int k, part_of *part)
{
	struct list sum = { 0 }, last = { 0 };
	switch (s->kind) {
	case SEQUENCE_QUOTIENT: return quotient(r, sequence, s, k, part);
	case SEQUENCE_ROOT:     return root(r, sequence, s, k, part);
	case SEQUENCE_POWER:    return power(r, sequence, s, k, part);
	default:                break;
	}
	for (int i = 0; i < s->terms; i++)
		recurrence_add_term(r, &sum, part == recurrence ? &last : &sum, &s->term[i], k, part);
	tape_ref all = recurrence_chain(r->t, &sum);
	for (int i = 0; i < last.terms; i++)
		all = plus(r->t, all, last.term[i].first);
	return all;
}

/* The part of the k-th that the highest coefficients of other sequences are not in; TAPE_NONE: there is none */
static tape_ref early(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	tape_ref *ref = recurrence_place(r, r->early, sequence, k);
	if (s->known)
		return recurrence(r, sequence, k);
	if (!s->split)
		return TAPE_NONE;
	recurrence_check_turn(r, sequence, k);
	if (*ref == UNKNOWN)
		*ref = recurrence_named(r, made_of(r, sequence, s, k, early), sequence,
					format("early_%s", recurrence_turn_text(k)));
	return *ref;
}

/* ---- linear equations, M_0 factored once ---- */

static tape_ref provisional_ahead(struct recurrences *r, int sequence, int k);
static tape_ref provisional_behind(struct recurrences *r, int sequence, int k);

static tape_ref shifted(struct recurrences *r, const struct sequence *s, int k, part_of *part)
{
	struct multiplier factor = recurrence_number_at(r, k + 1);
	factor.number *= s->shifts ? s->exponent : 1;
	return recurrence_scaled(r, factor, part(r, s->a, k + 1));
}

/* The k-th where that of solutions is 0 */
static tape_ref provisional(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	tape_ref *ref = recurrence_place(r, r->early, sequence, k);
	if (s->kind == SEQUENCE_SOLUTION)
		return TAPE_NONE;
	if (!s->solved)
		return recurrence(r, sequence, k);
	recurrence_check_turn(r, sequence, k);
	if (*ref == UNKNOWN)
		*ref = s->kind == SEQUENCE_RATE       ? shifted(r, s, k, provisional_ahead)
		       : s->kind == SEQUENCE_CHOICE   ? choice(r, s, k, provisional)
		       : s->kind == SEQUENCE_INTEGRAL ? made_of(r, sequence, s, k - 1, provisional_behind)
						      : made_of(r, sequence, s, k, provisional);
	return *ref;
}

/* The k-th where the next of solutions is 0 */
static tape_ref provisional_behind(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	tape_ref *ref = recurrence_place(r, r->early, sequence, k);
	if (!s->behind)
		return recurrence(r, sequence, k);
	recurrence_check_turn(r, sequence, k);
	if (*ref == UNKNOWN)
		*ref = s->kind == SEQUENCE_RATE ? shifted(r, s, k, provisional)
						: made_of(r, sequence, s, k, provisional_behind);
	return *ref;
}

/* The k-th where the one before of solutions is 0 */
static tape_ref provisional_ahead(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	tape_ref *ref = recurrence_place(r, r->early, sequence, k);
	if (!s->ahead)
		return recurrence(r, sequence, k);
	recurrence_check_turn(r, sequence, k);
	if (*ref == UNKNOWN)
		*ref = s->kind == SEQUENCE_INTEGRAL ? made_of(r, sequence, s, k - 1, provisional)
						    : made_of(r, sequence, s, k, provisional_ahead);
	return *ref;
}

/* What the k-th of solutions adds to it: it is linear in them, with factors that the first coefficients make. */
static tape_ref update(struct recurrences *r, int sequence, int k);

static tape_ref update_times(struct recurrences *r, int sequence, int k, struct multiplier factor, int other,
			     part_of *change_of)
{
	tape_ref change = change_of(r, sequence, k);
	return change == TAPE_NONE ? change : highest(r, change, factor, other);
}

static tape_ref update_of_sum(struct recurrences *r, const struct sequence *s, int k, part_of *change_of)
{
	struct list sum = { 0 };
	for (int i = 0; i < s->terms; i++) {
		const struct sequence_term *term = &s->term[i];
		struct multiplier factor = recurrence_factor_at(r, term, k);
		if (term->kind == TERM_SEQUENCE)
			add(&sum, recurrence_scaled(r, factor, change_of(r, term->a, k)));
		if (term->kind != TERM_PRODUCT)
			continue;
		add(&sum, update_times(r, term->a, k, factor, term->b, change_of));
		add(&sum, update_times(r, term->b, k, factor, term->a, change_of));
	}
	return recurrence_chain(r->t, &sum);
}

/* What the one before of solutions adds to the k-th */
static tape_ref update_ahead(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	if (!s->ahead)
		return TAPE_NONE;
	return s->kind == SEQUENCE_INTEGRAL ? update_of_sum(r, s, k - 1, update) : update_of_sum(r, s, k, update_ahead);
}

/* (a - c_0 b)/b_0, a/(2 c_0), exponent c_0 a/a_0, of what changes by a and b */
static tape_ref update_of_ratio(struct recurrences *r, int sequence, const struct sequence *s, int k,
				part_of *change_of)
{
	tape_ref a = s->a == NONE ? TAPE_NONE : change_of(r, s->a, k);
	if (s->kind == SEQUENCE_QUOTIENT)
		a = less(r->t, a, times(r->t, recurrence(r, sequence, 0), change_of(r, s->b, k)));
	if (s->kind == SEQUENCE_POWER)
		a = tape_scaled(r->t, recurrence_rounded(s->exponent), times(r->t, a, recurrence(r, sequence, 0)));
	return over(r, sequence, a);
}

/* What the next of solutions adds to the k-th */
static tape_ref update_behind(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	tape_ref *ref = recurrence_place(r, r->update, sequence, k);
	if (!s->behind)
		return TAPE_NONE;
	recurrence_check_turn(r, sequence, k);
	if (*ref == UNKNOWN)
		*ref = s->kind == SEQUENCE_RATE  ? shifted(r, s, k, update)
		       : s->kind == SEQUENCE_SUM ? update_of_sum(r, s, k, update_behind)
						 : update_of_ratio(r, sequence, s, k, update_behind);
	return *ref;
}

static tape_ref update(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	tape_ref *ref = recurrence_place(r, r->update, sequence, k);
	if (s->kind == SEQUENCE_SOLUTION)
		return recurrence(r, sequence, k);
	if (!s->solved)
		return TAPE_NONE;
	recurrence_check_turn(r, sequence, k);
	if (*ref == UNKNOWN)
		*ref = s->kind == SEQUENCE_RATE       ? shifted(r, s, k, update_ahead)
		       : s->kind == SEQUENCE_CHOICE   ? choice(r, s, k, update)
		       : s->kind == SEQUENCE_SUM      ? update_of_sum(r, s, k, update)
		       : s->kind == SEQUENCE_INTEGRAL ? update_of_sum(r, s, k - 1, update_behind)
						      : update_of_ratio(r, sequence, s, k, update);
	return *ref;
}

static tape_ref entry(struct recurrences *r, int sequence)
{
	return sequence == NONE ? TAPE_NONE : recurrence(r, sequence, 0);
}

static struct tape_factors *factors_of(struct recurrences *r, const struct linear_equations *e)
{
	struct solved *solved = &r->solved[e->number];
	SCRATCH tape_ref *matrix = ARRAY(tape_ref, e->n * e->n);
	for (int i = 0; i < e->n * e->n && !solved->factors; i++)
		matrix[i] = entry(r, e->matrix[i]);
	if (!solved->factors)
		solved->factors = tape_factors_new(r->t, e->n, matrix);
	return solved->factors;
}

static const char *solver_text(const struct recurrences *r, const struct linear_equations *e, bool factors)
{
	return r->names.solver ? r->names.solver(r->names.context, e, factors) : "";
}

/* Many equations: their matrix and right side as arrays, which functions of the target factor and solve. */
static void solve_by_lists(struct recurrences *r, const struct linear_equations *e, const tape_ref *right, int k,
			   tape_ref *x)
{
	struct solved *solved = &r->solved[e->number];
	struct tape *t = r->t;
	for (int i = 0; i < e->n * e->n && !solved->listed; i++)
		if (e->matrix[i] != NONE)
			tape_set(t, format("matrix_by_%d[%d]", e->number, i), entry(r, e->matrix[i]), 10, NULL);
	if (!solved->listed)
		tape_statement(t, solver_text(r, e, true));
	solved->listed = true;
	for (int i = 0; i < e->n; i++)
		tape_set(t, format("solved_by_%d[%d]", e->number, i),
			 right[i] == TAPE_NONE ? tape_number(t, 0) : right[i], 10, NULL);
	tape_statement(t, solver_text(r, e, false));
	for (int i = 0; i < e->n; i++)
		x[i] = recurrence_staged(r, STAGE_SOLVED, e->number, i, k, 0);
}

static tape_ref solution(struct recurrences *r, const struct sequence *s, int k)
{
	const struct linear_equations *e = s->equations;
	tape_ref *x = &r->solved[e->number].x[recurrence_column(r, k) * e->n];
	SCRATCH tape_ref *right = ARRAY(tape_ref, e->n);
	for (int i = 0; i < e->n && x[0] == UNKNOWN; i++)
		right[i] = k == 0 ? entry(r, e->right[i]) : less(r->t, TAPE_NONE, provisional(r, e->residual[i], k));
	if (x[0] == UNKNOWN && r->lines && is_listed(e))
		solve_by_lists(r, e, right, k, x);
	else if (x[0] == UNKNOWN)
		tape_solve(factors_of(r, e), right, x);
	return x[s->component];
}

/* ---- gains: derivatives of the k-th by the k-th of another, k >= 1: a number, or what follows from the first
 * coefficients. Of an integral, times k + 1 ---- */

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
	a = times(t, a, helper(r, sequence));
	return s->kind == SEQUENCE_POWER ? tape_scaled(t, recurrence_rounded(s->exponent), a) : a;
}

/* early part + sum of gains times the k-th of the others, over k + 1 of an integral */
static tape_ref joined(struct recurrences *r, int sequence, const struct sequence *s, int k)
{
	struct tape *t = r->t;
	tape_ref all = s->split ? early(r, sequence, k)
				: made_of(r, sequence, s, k, early);
	for (int i = 0; i < s->gains; i++) {
		const struct sequence_term *only = plain_term(r->x, s, s->gain[i]);
		tape_ref latest = recurrence(r, s->gain[i], k);
		if (latest == TAPE_NONE)
			continue;
		struct multiplier factor = s->kind == SEQUENCE_INTEGRAL ? recurrence_part_at(r, k) : plain(1);
		all = plus(t, all, only ? recurrence_scaled(r, recurrence_factor_at(r, only, k), latest)
					: times(t, latest, recurrence_scaled(r, factor, own_gain(r, sequence, i))));
	}
	return all;
}

/* ---- coefficients ---- */

/* At k = 0 */
static tape_ref first(struct recurrences *r, const struct sequence *s)
{
	struct tape *t = r->t;
	if (s->state != NONE)
		return tape_operand(t, TAPE_STATE, s->state, 0);
	tape_ref a = s->a == NONE ? tape_number(t, 1) : recurrence(r, s->a, 0);
	switch (s->kind) {
	case SEQUENCE_ROOT:     return tape_call(t, FN_SQRT, a);
	case SEQUENCE_POWER:    return tape_binary(t, TAPE_POWER, a, tape_double(t, s->exponent));
	case SEQUENCE_QUOTIENT: return tape_binary(t, TAPE_DIV, a, recurrence(r, s->b, 0));
	default:                break;
	}
	return s->function == FN_ATAN2 ? tape_binary(t, TAPE_ATAN2, a, recurrence(r, s->b, 0))
				       : tape_call(t, s->function, a);
}

static bool is_constant_sequence(struct recurrences *r, int sequence)
{
	return sequence == NONE || recurrence(r, sequence, 1) == TAPE_NONE;
}

static tape_ref made(struct recurrences *r, int sequence, const struct sequence *s, int k)
{
	const bool integral = s->kind == SEQUENCE_INTEGRAL;
	if (s->kind == SEQUENCE_RATE)
		return shifted(r, s, k, recurrence);
	if (s->kind == SEQUENCE_CHOICE && !(s->solved && k > 0))
		return choice(r, s, k, recurrence);
	if (s->kind == SEQUENCE_SOLUTION)
		return solution(r, s, k);
	if (k == 0 && s->kind != SEQUENCE_SUM)
		return first(r, s);
	if (integral && s->state == NONE && is_constant_sequence(r, s->a) && is_constant_sequence(r, s->b))
		return TAPE_NONE;
	if (s->ahead && !integral && k > 1)
		return plus(r->t, provisional_ahead(r, sequence, k), update_ahead(r, sequence, k));
	if (s->solved && k > 0)
		return plus(r->t, provisional(r, sequence, k), update(r, sequence, k));
	return s->gains && k > integral ? joined(r, sequence, s, k - integral)
					: made_of(r, sequence, s, k - integral, recurrence);
}

tape_ref recurrence(struct recurrences *r, int sequence, int k)
{
	const struct sequence *s = sequence_of(r, sequence);
	tape_ref *ref = recurrence_place(r, r->made, sequence, k);
	if (in_loop(k) && !goes_on(r, sequence))
		return TAPE_NONE;
	if (in_loop(k) && k - STAGE < r->lines->offset[sequence])
		return recurrence_staged(r, STAGE_COEFFICIENT, sequence, NONE, k, 0);
	if (*ref == UNKNOWN)
		*ref = recurrence_named(r, made(r, sequence, s, k), sequence, recurrence_turn_text(k));
	if (*ref == TAPE_NONE && k == 0)
		*ref = tape_number(r->t, 0);
	return *ref;
}
