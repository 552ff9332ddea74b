/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of emit/exponential have from one another, and nobody else. */
#ifndef PLGEN_EMIT_EXPONENTIAL_INNER_H
#define PLGEN_EMIT_EXPONENTIAL_INNER_H

#include "emit/formulas.h"
#include "emit/state.h"

/* ---- emit_forces.c: tables of modes, and forces on them ---- */

const struct normal *normal_of_step(const struct emitter *e);
int  functions_of_time(const struct emitter *e);                  /* beside the constant one */
bool has_schedule(const struct emitter *e);                       /* of several operators */
/* target[i] = sum for so many i, in as many loops as its terms ask for */
void say_row_sum(const struct emitter *e, const char *target, int rows, const struct summands *s);
void emit_to_modes(const struct emitter *e);                      /* NAME_modes_of */
void emit_from_modes(const struct emitter *e);                    /* NAME_of_modes */
void emit_function_values(const struct emitter *e);               /* NAME_functions */
void emit_forces(const struct emitter *e);                        /* NAME_mode_forces */

void emit_forces_on_modes(const struct emitter *e);               /* NAME_on_modes */

/* ---- emit_normal.c: a step by collocation, part of an event-split step ---- */

void emit_mode_tables(const struct emitter *e);
void emit_mode_sizes(const struct emitter *e);

/* ---- remainder.c, loops.c: the nonlinear remainder; a step that loops over its tables ---- */

bool many_operators(const struct emitter *e);
void emit_loop_tables(const struct emitter *e);
const char *matrix_text(const struct emitter *e, const char *name); /* its first entry, of the operator that serves */
const char *vector_name(int stage);
bool flows_apart(const struct emitter *e);                        /* where a change of the loads may interrupt them */
void emit_operands(const struct emitter *e);                      /* declares load, input, which the tables multiply */
/* target = Phi y + loads + inputs over the time of table t; from rest: the loads and inputs alone */
void emit_flow_loop(const struct emitter *e, int t, bool from_rest, const char *target, const char *margin);
void emit_sum_loop(const struct emitter *e, const struct action *a);

/* ---- actions.c: the step of a scheme with a remainder ---- */

void emit_actions_of_step(const struct emitter *e);                /* its body, without time */
void emit_predictor(const struct emitter *e);                      /* NAME_predict: states at nodes */

#endif
