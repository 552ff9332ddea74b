/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps in normal modes and of modes. */
#ifndef PLGEN_EMIT_MODES_H
#define PLGEN_EMIT_MODES_H

#include "emit/state.h"

/* ---- emit_forces.c: tables of modes, and forces on them ---- */

const struct normal *normal_of_step(const struct emitter *e);
int  functions_of_time(const struct emitter *e);                  /* beside the constant one */
bool has_bank(const struct emitter *e);                           /* of several operators */
/* target[i] = sum for so many i, in as many loops as its terms ask for */
void say_row_sum(const struct emitter *e, const char *target, int rows, const struct summands *s);
void emit_to_modes(const struct emitter *e);                      /* NAME_modes_of */
void emit_from_modes(const struct emitter *e);                    /* NAME_of_modes */
void emit_function_values(const struct emitter *e);               /* NAME_functions */
void emit_forces(const struct emitter *e);                        /* NAME_forces */

/* ---- emit_normal.c: steps in normal modes ---- */

void emit_normal_members(const struct emitter *e);
void emit_normal_tables(const struct emitter *e);

/* ---- emit_modal.c: a step of modes ---- */

void emit_modes(const struct emitter *e);                         /* tables; nothing of other forms */

#endif
