/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of recurrences have from one another: turns.c, recurrences.c and sizes.c. */
#ifndef PLGEN_STEP_SERIES_RECURRENCES_H
#define PLGEN_STEP_SERIES_RECURRENCES_H

#include "inner.h"

enum { UNKNOWN = -2 };                  /* beside TAPE_NONE: nothing */
struct recurrences {
	const struct step *step;
	const struct expansion *x;
	struct series_names names;
	struct tape *t;
	struct lines *lines;        /* NULL: straight code */
	tape_ref *made, *early, *update; /* [sequence][k], behind them that of the loop */
	tape_ref *helper, *size;    /* per sequence: its inverse or half; of what its value is summed from */
	tape_ref **gain;            /* [sequence][gain] */
	struct solved *solved;      /* per system of linear equations */
};

struct solved {                     /* factors of the matrix at the start, which serve all k */
	struct tape_factors *factors;
	bool listed;                /* they are an array of the target, by lists */
	tape_ref *x;                /* [k][component], likewise; UNKNOWN: not made yet */
};

static inline const struct sequence *sequence_of(const struct recurrences *r, int sequence)
{
	return &r->x->sequence[sequence];
}

static inline bool in_loop(int k)
{
	return k > STAGE / 2;
}

/* A factor at k: a number, or one of a table times it */
struct multiplier { double number; tape_ref table; };

static inline struct multiplier plain(double number)
{
	return (struct multiplier){ number, TAPE_NONE };
}

static inline struct multiplier twice(struct multiplier f)
{
	return (struct multiplier){ 2 * f.number, f.table };
}

struct addend { tape_ref first, then; };       /* then TAPE_NONE, or added behind it */
struct list {
	int terms;
	struct addend *term;
};

static inline void add_two(struct list *list, tape_ref first, tape_ref then)
{
	if (first == TAPE_NONE)
		return;
	*MORE(list->term, list->terms) = (struct addend){ first, then };
}

static inline void add(struct list *list, tape_ref ref)
{
	add_two(list, ref, TAPE_NONE);
}

static inline tape_ref plus(struct tape *t, tape_ref sum, tape_ref term)
{
	return sum == TAPE_NONE ? term : term == TAPE_NONE ? sum : tape_binary(t, TAPE_ADD, sum, term);
}

static inline tape_ref less(struct tape *t, tape_ref a, tape_ref b)
{
	return b == TAPE_NONE ? a : plus(t, a, tape_unary(t, TAPE_NEG, b));
}

static inline tape_ref times(struct tape *t, tape_ref a, tape_ref b)
{
	return a == TAPE_NONE || b == TAPE_NONE ? TAPE_NONE : tape_binary(t, TAPE_MUL, a, b);
}

/* Of another sequence the k-th, or its early part */
typedef tape_ref part_of(struct recurrences *r, int sequence, int k);

/* ---- turns.c: what depends on k alone ---- */

const char *recurrence_turn_text(int k);
tape_ref recurrence_named(struct recurrences *r, tape_ref ref, int sequence, const char *what);
void recurrence_check_turn(const struct recurrences *r, int sequence, int k);
int recurrence_column(const struct recurrences *r, int k);     /* of k in lists of coefficients */
tape_ref *recurrence_place(const struct recurrences *r, tape_ref *list, int sequence, int k);
tape_ref recurrence_staged(const struct recurrences *r, enum stage_kind kind, int a, int b, int k, double exponent);
tape_ref recurrence_scaled(const struct recurrences *r, struct multiplier f, tape_ref ref);
struct multiplier recurrence_factor_at(const struct recurrences *r, const struct sequence_term *term, int k);
tape_ref recurrence_chain(struct tape *t, const struct list *list);
struct multiplier recurrence_number_at(const struct recurrences *r, int k);    /* k */
struct multiplier recurrence_part_at(struct recurrences *r, int k);            /* 1/(k + 1) */
double recurrence_rounded(double value);

/* ---- recurrences.c ---- */

void recurrence_add_term(struct recurrences *r, struct list *sum, struct list *last, const struct sequence_term *term,
			 int k, part_of *part);
tape_ref recurrence_condition(struct recurrences *r, const struct sequence *s);

#endif
