/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps by series of the solution and by collocation as C; part of emit.h. */
#ifndef PLGEN_EMIT_SERIES_H
#define PLGEN_EMIT_SERIES_H

#include "base/base.h"

struct expansion;
struct tape;

/* ---- emit_sequences.c: the coefficients of a series ---- */

/* The same emitter, whose series is this one */
const struct emitter *by_series(const struct emitter *e, struct expansion *x);
void emit_expand_from(const struct emitter *e);                   /* all that is kept */
bool has_switching(const struct emitter *e);                      /* the state chooses formulas */
const char *driven_parameter(const struct emitter *e);            /* const double u[N_INPUTS], or "" */
void emit_inputs_now(const struct emitter *e);                    /* NAME_inputs_now: samples, their slopes */
void emit_force_table(const struct emitter *e);                   /* of loads that change their formula */
struct recurrences *series_new(const struct emitter *e);          /* under the names that they have in C */
/* What the values are summed from of what the search of events looks at, into target[] */
void series_set_sizes(struct recurrences *r, const struct expansion *x, const char *target);
void emit_series_tape(const struct emitter *e, const struct recurrences *r);
struct tape *tape_of_series(const struct emitter *e);             /* all that is kept, into c[][] */
void emit_expansion_locals(const struct emitter *e);              /* what it reads of loads, inputs and time */
bool spans_steps(const struct emitter *e);                        /* one expansion of fixed order is over several */
/* gain_term: a coefficient of a state, as C; NULL: it is 0 */
typedef const char *gain_term(const struct emitter *e, int state, int k);

/* ---- emit_reach.c: how far a series holds ---- */

void emit_floors(const struct emitter *e);      /* which, over the tolerance: what counts beside their size now */

/* ---- emit_reach.c: how far what coefficients do not show is followed ---- */

bool has_unresolved(const struct emitter *e);
bool traces(const struct emitter *e);                            /* some of it by its argument */
bool crowds(const struct emitter *e);                            /* there are loads that may cancel each other */
bool holds_lengths(const struct emitter *e);                     /* of derivatives, which do not choose its steps */
void emit_counting(const struct emitter *e);
void emit_counts_macro(const struct emitter *e);                 /* in models of derivatives: PL_COUNTS(i) */
void emit_unresolved_sizes(const struct emitter *e);             /* of what a series may not show, for reach.h */
void emit_hidden_table(const struct emitter *e);
void emit_arguments(const struct emitter *e);                    /* what shows those along a step by collocation */
double crowded_steps(const struct emitter *e);                    /* how long, in h, such a step is at most */

/* ---- emit_expansion.c: steps by the Taylor series of the solution ---- */

bool expansion_places(const struct emitter *e);
void emit_expansion_place(const struct emitter *e);
void emit_pass_time(const struct emitter *e);                    /* NAME_pass_time: what else takes part in a step */
void emit_expansion_members(const struct emitter *e);
/* Of steps by collocation too, where there is a series beside it */
void emit_series_ahead(const struct emitter *e);                         /* NAME_ahead: the sum of the series */
void emit_series_functions(const struct emitter *e);                     /* NAME_expand_from, NAME_slopes_at */
void emit_serving_step(const struct emitter *e);                         /* NAME_step, by NAME_serve */
void emit_expansion_step(const struct emitter *e);
void emit_expansion_at(const struct emitter *e);
void emit_lanes_total(const struct emitter *e);                  /* NAME_lanes_total */
/* Whether $n_inside is there, for the steps that a series serves before its last */
bool serves_rows(const struct emitter *e);

int  motion_numbers(const struct emitter *e);                     /* beside contacts, for outputs; 0: none are read */
void emit_frozen_function(const struct emitter *e);               /* NAME_forces_at: the remainder, alone */
void emit_ends_function(const struct emitter *e);                 /* NAME_ends_at: expressions, alone */
bool has_choices(const struct emitter *e);                        /* of formulas, by t */

/* ---- emit_event_split.c: schemes with a remainder, from crossing to crossing ---- */

void emit_event_split_members(const struct emitter *e);
void emit_event_split_place(const struct emitter *e);
void emit_event_split_step(const struct emitter *e);

/* ---- emit_switching.c: formulas that the state chooses, from one crossing to the next ---- */

void emit_switching_types(const struct emitter *e);               /* NAME_contact; nothing where there are none */
void emit_switching_members(const struct emitter *e);
void emit_switching_declarations(const struct emitter *e);
void emit_crossing_declarations(const struct emitter *e);         /* NAME_region, NAME_crossed, NAME_crossings */
void emit_switching_tables(const struct emitter *e);             /* of the breakpoints, of the series */
void emit_passing_table(const struct emitter *e, int order);      /* the same, of polynomials of each and of watches */
void emit_switching_macros(const struct emitter *e);             /* what chosen.h asks of them */

/* ---- emit_events.c: impacts and friction beside a series ---- */

bool meets_contacts(const struct emitter *e);
bool moves_derivatives(const struct emitter *e); /* of their states, through events */
void emit_moved_columns(const struct emitter *e);
int  terms_of_events(const struct emitter *e);                   /* expressions and watches */
void emit_event_tables(const struct emitter *e);
void emit_events_along(const struct emitter *e);                 /* the same, of polynomials of each */

/* ---- emit_over.c: a series of fixed order over several steps ---- */

bool runs_in_blocks(const struct emitter *e);                     /* NAME_run takes all steps of an expansion at once */
void emit_over_block(const struct emitter *e);                    /* NAME_block, where there is one */

/* ---- emit_motion.c: the highest derivatives and their Jacobian ---- */

/* So many coordinates that stages are solved by their modes, with the Jacobian of the step's start */
bool splits(const struct emitter *e);
bool motion_reads_load(const struct emitter *e, int load);
void emit_motion(const struct emitter *e);      /* NAME_known, NAME_linearize, NAME_forces, NAME_watch, NAME_trace */
int  known_values(const struct emitter *e);                       /* what is known of a time; 0: nothing is read */
struct reads reads_of_choices(const struct emitter *e);          /* what chooses formulas, what is watched */
bool watch_reads_known(const struct emitter *e);                 /* more than the state; */
bool trace_reads_known(const struct emitter *e);
const char *kind_text(const struct emitter *e, const char *i);   /* C: 0 .. 2, which are measured together */
void emit_state_table(const struct emitter *e);                   /* that it reads, where there is no formula */

/* ---- emit_collocation.c: steps by collocation ---- */

void emit_collocation_place(const struct emitter *e);
void emit_collocation_members(const struct emitter *e);
void emit_collocation_step(const struct emitter *e);
void emit_collocation_at(const struct emitter *e);
void emit_over_table(const struct emitter *e);                   /* NAME_part_of, of a series over several steps */

#endif
