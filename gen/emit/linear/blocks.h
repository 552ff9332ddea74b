/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of large models by their independent blocks, and of modes. */
#ifndef PLGEN_EMIT_BLOCKS_H
#define PLGEN_EMIT_BLOCKS_H

#include "emit/state.h"

/* ---- emit_large.c: the step of a large model ---- */

struct group_shape {                /* of its numbers, where they are a table or stand in the instance */
	const char *name;           /* columns */
	int rows, columns;
	int changing;               /* rows of what it has in each segment of time beside them */
};
struct group_shape shape_of_group(const struct emitter *e, const struct group *g);
void emit_group_numbers(const struct emitter *e, const struct group *g, bool changing);
const char *group_note(const struct emitter *e, const struct group *g);
/* Which row and column of its blocks a row of numbers of blocks alike is of; columns: states, loads, inputs */
int  alike_entry(const struct emitter *e, const struct group *g, bool changing, int index, int *column);

/* ---- blockwise.c: the independent blocks of a large model, one after the other between steps and many at once ---- */

bool is_blockwise(const struct emitter *e);
void emit_block_list(const struct emitter *e);

#endif
