/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of emit/series have from one another, and nobody else. */
#ifndef PLGEN_EMIT_SERIES_INNER_H
#define PLGEN_EMIT_SERIES_INNER_H

#include "series.h"

/* ---- emit_sequences.c: the coefficients of a series ---- */

void emit_slopes_function(const struct emitter *e);               /* NAME_slopes_at, beside an adaptive series */
void emit_motion_function(const struct emitter *e);               /* NAME_motion_at, for outputs beside contacts */
bool has_offset(const struct emitter *e);                         /* an expansion may start inside a step */
void emit_series_locals(const struct emitter *e);                 /* all that is kept, as locals */
const char *coefficient(const struct emitter *e, int sequence, int k); /* its k-th as a local; NULL: that is 0 */
void emit_coefficients(const struct emitter *e);                  /* locals: from y, now */
bool expands_in_step(const struct emitter *e);                    /* the step of fixed order does, without a call */
const char *plus(const char *sum, const char *term);                     /* in brackets; either may be nothing */
/* C: two arguments of pl_accumulate; `none` where there are no terms */
const char *full_gain(const struct emitter *e, int state, gain_term *term, const char *none);
void emit_series_ends(const struct emitter *e);                         /* next0, rest0, ...: where it ends */
const char *is_not_finite(const struct emitter *e);
bool is_written_out(const struct emitter *e, int degree);                /* else loops go over its sum */

/* ---- emit_series.c: the coefficients of a series as C ---- */

/* A long one as a loop over k: its tables, and what runs */
struct recurrences *series_in_loop(const struct emitter *e);
void emit_series_loop_tables(const struct emitter *e);
void emit_series_loop(const struct emitter *e, const struct recurrences *r);

/* ---- emit_reach.c: how far a series holds ---- */

bool shares_kinds(const struct emitter *e);     /* of states of an adaptive series */
bool looks_at_tolerance(const struct emitter *e);
bool watches(const struct emitter *e);          /* of fixed order: whether the last terms are above the tolerance */
int  most_served(const struct emitter *e);      /* steps, by one expansion; with inputs only one */
void emit_reach_tables(const struct emitter *e);                 /* NAME_last, NAME_before_last */
void emit_reach_sizes(const struct emitter *e);                  /* what reach.h is given */

/* ---- emit_over.c: a series of fixed order over several steps ---- */

void emit_over_members(const struct emitter *e);
/* s->y: the state `theta` after the start, by Horner's rule; what rounding took at the start is in `rest`, with %d */
void emit_value(const struct emitter *e, const char *theta, gain_term *term, const char *rest, const char *indent);

#endif
