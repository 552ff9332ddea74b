/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of emit/many have from one another, and nobody else. */
#ifndef PLGEN_EMIT_MANY_INNER_H
#define PLGEN_EMIT_MANY_INNER_H

#include "many.h"

struct batch plan_batch(const struct emitter *e);
int batch_stepped_rows(const struct emitter *e);                  /* of an instance's memory: those a step changes */
int batch_groups(const struct emitter *e);                        /* of lanes that step in turns */
void emit_lanes_step(struct batch *b);
void emit_lanes_out(struct batch *b);
void emit_lanes_bend(struct batch *b);                            /* how far outputs may be off their chords */

#endif
