/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of emit/linear have from one another, and nobody else. */
#ifndef PLGEN_EMIT_LINEAR_INNER_H
#define PLGEN_EMIT_LINEAR_INNER_H

#include "blocks.h"

void emit_group_steps(const struct emitter *e, const char *const *acting_text); /* but rows; loads, then inputs */

/* ---- blockwise.c: the independent blocks of a large model, one after the other between steps and many at once ---- */

int  count_blocks(const struct emitter *e);
int  states_of_largest_block(const struct emitter *e);

/* ---- emit_modal.c: a step of modes ---- */

void emit_modal_step(const struct emitter *e, const char *const *acting_text);

/* ---- emit_loads.c, emit_refresh.c, emit_time.c, emit_step.c ---- */

void emit_load_array(const struct emitter *e, int load);          /* load1[2], what its states are called */
void emit_load_functions(const struct emitter *e, int load);      /* its states, from its phase and envelope */
void emit_load_powers(const struct emitter *e, int load);         /* those with t, from those without */
/* as emit_load_states, in a step: at the refresh, to be multiplied with rotated[...]; elsewhere: of now */
void emit_refreshed_loads(const struct emitter *e, const bool *loads);
/* declares load states, and i where one is `looped` over; x[...] = what the series advances */
void emit_series_vector(const struct emitter *e, bool looped);
/* x[...] = load states, from index[l] on, and inputs; which loads have an index */
void store_loads(const struct emitter *e, const int *index);
bool *wanted_loads(const struct emitter *e, const int *index);
void store_inputs(const struct emitter *e, const int *index);
void emit_series_slopes(const struct emitter *e);                  /* A, of x' = A x */

#endif
