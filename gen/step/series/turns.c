/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What depends on k alone: names, places and factors of a coefficient, k a number or that of a loop. */
#include "recurrences.h"
#include "step/exponential/recipe.h"

/* ---- names ---- */

/* Of the loop x_by_1k: no coordinate is called so, since no name begins with a digit */
const char *recurrence_turn_text(int k)
{
	const int offset = k - STAGE;
	return !in_loop(k) ? format("%d", k) : format("by_%dk", offset < 0 ? 10 - offset : offset);
}

/* The node under the sequence's name, with a number or a word behind it */
tape_ref recurrence_named(struct recurrences *r, tape_ref ref, int sequence, const char *what)
{
	if (r->names.name && ref != TAPE_NONE)
		tape_name(r->t, ref, format("%s_%s", r->names.name(r->names.context, sequence), what));
	return ref;
}

/* ---- in a loop over k ---- */

/* Parts of a coefficient are made with it. */
void recurrence_check_turn(const struct recurrences *r, int sequence, int k)
{
	if (in_loop(k) && k - STAGE != r->lines->offset[sequence])
		internal_error(r->step, "a part of a coefficient is wanted in another turn of the loop");
}

int recurrence_column(const struct recurrences *r, int k)
{
	return !in_loop(k) ? k : r->x->order + 1;
}

tape_ref *recurrence_place(const struct recurrences *r, tape_ref *list, int sequence, int k)
{
	return &list[sequence * (r->x->order + 2) + recurrence_column(r, k)];
}

/* What depends on the k of the loop and is no number of a node */
tape_ref recurrence_staged(const struct recurrences *r, enum stage_kind kind, int a, int b, int k, double exponent)
{
	const struct stage_value value = { kind, a, b, k - STAGE, exponent };
	return tape_operand(r->t, TAPE_TABLE, stage_value(r->lines, value), STAGED);
}

tape_ref recurrence_scaled(const struct recurrences *r, struct multiplier f, tape_ref ref)
{
	if (f.table == TAPE_NONE || ref == TAPE_NONE || f.number == 0)
		return tape_scaled(r->t, f.number, ref);
	return tape_scaled(r->t, f.number, tape_times_each(r->t, f.table, ref));
}

/* factor[k], of all k >= 1 the same or in a table */
static struct multiplier factor_among(const struct recurrences *r, const double *factor, int k)
{
	const int order = r->x->order;
	bool same = true;
	if (!in_loop(k))
		return plain(factor[k]);
	for (int i = 2; i <= order; i++)
		same = same && factor[i] == factor[1];
	if (same)
		return plain(factor[1]);
	const int table = stage_factors(r->lines, factor, order + 1);
	return (struct multiplier){ 1, recurrence_staged(r, STAGE_FACTOR, table, NONE, k, 0) };
}

struct multiplier recurrence_factor_at(const struct recurrences *r, const struct sequence_term *term, int k)
{
	return term->factor ? factor_among(r, term->factor, k) : plain(1);
}

/* ---- sums ---- */

/* Lowest order first, the highest added last, in two chains where it is long; of nothing TAPE_NONE */
tape_ref recurrence_chain(struct tape *t, const struct list *list)
{
	tape_ref sum[2] = { TAPE_NONE, TAPE_NONE };
	int chains = list->terms > 4 ? 2 : 1;
	for (int i = 0; i < list->terms; i++) {
		tape_ref *own = &sum[i % chains];
		*own = plus(t, plus(t, *own, list->term[i].first), list->term[i].then);
	}
	return plus(t, sum[0], sum[1]);
}

/* In the target's type */
double recurrence_rounded(double value)
{
	RATIONAL exact = ZERO;
	mpq_set_d(exact, value);
	value = round_rational(exact);
	return value;
}

struct multiplier recurrence_number_at(const struct recurrences *r, int k)
{
	return !in_loop(k) ? plain(k) : (struct multiplier){ 1, recurrence_staged(r, STAGE_NUMBER, NONE, NONE, k, 0) };
}

struct multiplier recurrence_part_at(struct recurrences *r, int k)
{
	SCRATCH double *part = ARRAY(double, r->x->order + 1);
	for (int i = 0; i <= r->x->order; i++)
		part[i] = recurrence_rounded(1.0 / (i + 1));
	return factor_among(r, part, k);
}
