/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A linear step and rows of outputs as nodes of a tape. */
#ifndef PLGEN_STEP_TAPES_H
#define PLGEN_STEP_TAPES_H

#include "step.h"
#include "tape/tape.h"

/* ---- tapes.c: what forms read, a linear step and rows of outputs as nodes of a tape ---- */

int load_of_forcing(const struct linear *system, const struct forcing *forcing); /* the number of loads: of none */
/* What a form reads of a coordinate, an input, a load now */
tape_ref tape_of_basis(struct tape *t, const struct linear *system, const struct basis *basis);

/* What TAPE_TABLE is an entry of: */
enum linear_table {
	TABLE_ROTATED,              /* factors of load states at a refresh, second words behind them */
	TABLE_OWN,                  /* the instance's, of a step: state x states, then loads, then inputs */
	TABLE_OWN_OUT,              /* the same, of outputs: row x column of tuning->x */
	TABLE_FACTOR,               /* of load states that change their formula: state x column */
	TABLE_DIRECT,               /* likewise of outputs: place of an output x column */
	TABLE_FORCED,               /* likewise of what the step leaves out: state x column */
	TABLE_LEFT,                 /* the remainder: force column */
	TABLE_SEEN,                 /* what an output sees of the modes */
	LINEAR_TABLES
};
enum { PLACE_REST, PLACE_CARRY };   /* `part` of TAPE_ACCUMULATE */
const struct linear *system_of_outputs(const struct step *step); /* of regions one with all segments of time */
/* Column of the loads; TAPE_NONE: the constant 1 */
tape_ref tape_of_column(struct tape *t, const struct linear *system, int column);
/* What loads sustain by themselves of the states as they are kept */
void tape_of_forced(struct tape *t, const struct step *step, const char *vector);
/* Rows of outputs read the state as it is kept, and what loads sustain of it by the factors of the load states */
bool rows_sustained(const struct step *step);
/* Per segment of time, what a row of outputs takes of a load state, by itself and so */
const mpq_t *direct_factors(const struct step *step, const struct output *output, int load, int column);
/* Sets vector[i], or its place, to state i after a step, of those that are stepped; NULL: all */
void tape_of_step(struct tape *t, const struct step *step, const bool *stepped, const char *vector,
		  const char *const *place);
bool has_second_word(const struct product *p, const struct step *step);
tape_ref tape_of_row(struct tape *t, const struct step *step, const struct output *output); /* not the remainder */
int own_row(const struct step *step, const struct output *output); /* of tuning, where params change it; else -1 */
int place_of_output(const struct model *model, const struct output *output); /* highest derivatives stand behind */
bool differs_in_time(const mpq_t *factor, int segments);

/* ---- written.c: the equations as written, for NAME_rhs ---- */

const struct form *without_highest(const struct model *model, const struct form *form);
/* -W^-1, n x n: the highest derivatives are it times the residuals */
struct coefficient *derivatives_of_residuals(const struct model *model);

#endif
