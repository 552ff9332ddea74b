/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of emit/linear have from one another, and nobody else. */
#ifndef PLGEN_EMIT_LINEAR_INNER_H
#define PLGEN_EMIT_LINEAR_INNER_H

#include "blocks.h"
#include "modes.h"

void emit_groups(const struct emitter *e);                        /* tables and functions of its independent blocks */
void emit_group_steps(const struct emitter *e, const char *const *acting_text); /* but rows; loads, then inputs */

/* ---- blockwise.c: the independent blocks of a large model, one after the other between steps and many at once ---- */

int  count_blocks(const struct emitter *e);
int  states_of_largest_block(const struct emitter *e);

/* ---- emit_modal.c: a step of modes ---- */

void emit_modal_step(const struct emitter *e, const char *const *acting_text);

#endif
