/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms with atoms as C, and the nonlinear remainder. */
#ifndef PLGEN_EMIT_FORMULAS_H
#define PLGEN_EMIT_FORMULAS_H

#include "state.h"
#include "step/tapes.h"
#include "tape/tape.h"

/* ---- formulas.c: forms with atoms as C, by a tape ---- */

struct formulas;
/* of TAPE_TABLE too: node[], excess[]; from the last on what was solved */
enum formula_table { TABLE_NODE = LINEAR_TABLES, TABLE_EXCESS, TABLE_SOLVED };
/* How forms are read: over y[], u[] and t as the equations are written, else by the locals of the step; what the state
 * chooses as interval[] says, the intervals of the step's expressions, else as the state is; conditions on time alone
 * as at the time that the C `when` is, NULL: at t */
struct reading { bool written, by_intervals; const char *when; };
/* What is to be formulas, all of it: what several read is computed once, under the name of a let where it has one. */
struct formulas *formulas_new(const struct emitter *e, struct reading how, int count, const struct form *const *form);
struct tape *formulas_tape(const struct formulas *f);             /* to set targets in */
tape_ref formula(struct formulas *f, const struct form *form);
tape_ref formula_sizes(struct formulas *f, const struct form *form); /* the sum of the sizes of its terms */
/* Many equations in these by functions of lines.h, before any is set: what is declared before its C, and the tables */
void solve_formulas_by_lists(struct formulas *f, int count, const struct form *const *form);
void emit_solved_locals(const struct formulas *f);
void emit_solved_tables(const struct formulas *f);
/* One such matrix: the columns of its factors' rows are in first_LISTS_NUMBER and before_LISTS_NUMBER */
struct listed_matrix { int n; bool symmetric; const char *lists; int number; };
const char *factor_by_lists(const struct emitter *e, struct listed_matrix m);
const char *solve_by_lists(const struct emitter *e, struct listed_matrix m, int rights, int solved);
void emit_factor_lists(const struct emitter *e, struct listed_matrix m, const int *first, const int *before);
void formulas_finish(struct formulas *f);                         /* once all is set */
struct reads reads_of_formulas(const struct formulas *f);         /* of what is finished, but for <math.h> */
void note_reads(struct reads *r, const struct emitter *e, const struct tape *t); /* what it reads, too */
void emit_formulas(struct formulas *f, int indent);

/* ---- remainder.c: the nonlinear remainder, as a function ---- */

bool any_of(const bool *flag, int count);
/* What a remainder, an operator, is handed in a step: samples at its start, their slopes [1/s] */
const char *samples_of_step(const struct emitter *e);
/* A call at a node of the step, and one in the outputs, into `left` */
const char *remainder_of_step(const struct emitter *e, int node, const char *state, const char *remainder);
const char *remainder_of_outputs(const struct emitter *e);
bool is_row_of_regions(const struct model *model, int coord); /* its highest derivative, where a contact may rest */
/* Does an output read an acceleration that the remainder acts on? */
bool reads_force_columns(const struct model *model);
void emit_remainder(const struct emitter *e);                      /* and of a schedule the choice of an operator */

const char *selection_call(const struct emitter *e);              /* of a schedule: which operator serves now */

/* ---- actions.c: the step of a scheme with a remainder ---- */

void emit_remainder_step(const struct emitter *e);
void emit_samples(const struct emitter *e);                       /* start, slope: what remainders read of ramps */

/* ---- tuned_terms.c: factors that the instance has ---- */

bool is_tuned_output(const struct emitter *e, const struct output *output); /* params change it */
/* Entry of an enum linear_table in a step, in outputs */
const char *linear_entry(const struct emitter *e, const struct tape_node *n);
/* Its row of factors, in struct NAME_coeffs */
const char *tuned_output_row(const struct emitter *e, const struct output *output);

#endif
