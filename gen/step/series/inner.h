/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of step/series have from one another, and nobody else. */
#ifndef PLGEN_STEP_SERIES_INNER_H
#define PLGEN_STEP_SERIES_INNER_H

#include "switching.h"
#include "expansion.h"
#include "sequences.h"

/* ---- switching.c: formulas that the state chooses ---- */

/* Of a - b. The sequence of a switching function that is new is to be made. */
struct division divide_forms(struct sequencing *w, const struct form *a, const struct form *b);
int  column_of_sequence(struct expansion *x, int sequence, int top);  /* kept up to this coefficient */
void rank_breakpoints(struct sequencing *w);                 /* once all are there */
/* That of the series, or one less where it reads what equations are solved for, which has so many coefficients */
int  order_of_form(const struct sequencing *w, const struct form *form);
int  breakpoint_rank(const struct expansion *x, int function, int breakpoint);    /* how many are below it */

/* ---- recurrences.c: the coefficients as nodes of a tape ---- */

tape_ref recurrence(struct recurrences *r, int sequence, int k);     /* TAPE_NONE: 0, of k > 0 */
int sequence_operands(const struct sequence *s, int **operand);
void recurrences_begin_turn(struct recurrences *r);                  /* of the loop */

/* ---- lines.c: a long series as a loop over k ---- */

/* Multiplications, beyond which a series is a loop: where straight code leaves the cache of instructions; k of the
 * loop, in the place of a number */
enum { LOOPED_SERIES = 5000, STAGE = 1 << 16 };
struct lines *lines_of(const struct expansion *x, int states);
int stage_value(struct lines *l, struct stage_value value);              /* its number, made once */
int stage_factors(struct lines *l, const double *factor, int count);     /* likewise; behind `count` they are 0 */

/* ---- implicit.c: how the highest coefficients enter the next ones ---- */

void find_implicit(struct expansion *x);
int  place_of_gain(const struct sequence *s, int other);     /* NONE: there is no such gain */
/* The only term with this other is itself, with a number: its factor at each k; NULL: it is not so */
const struct sequence_term *plain_term(const struct expansion *x, const struct sequence *s, int other);

/* ---- sums.c: what is added up exactly, and its factors as numbers ---- */

/* Its terms into s, at k times scale[k] */
void sum_numbers(struct sequencing *w, struct sequence *s, const struct sum *sum, const mpq_t *scale);
int single_sequence(struct sequencing *w, enum term_kind kind, int a, int b, long sign);
int product_sequence(struct sequencing *w, int a, int b);
mpq_t *integral_scale(const struct sequencing *w, bool times_unit);  /* 1/(k+1), or D/(k+1) */

/* ---- rates.c: second derivatives of sines ---- */

void shift_rates(struct sequencing *w, struct sum *sum);

/* *looks: there is what no argument bounds, or what is steep: the slope inside and at the end is looked at too */
struct unresolved *unresolved_of(const struct model *model, int *count, bool *looks);
double crowded_frequency(const struct linear *system);      /* 1/s: the highest of loads that may cancel; 0: of few */

#endif
