/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Regions of a piecewise-linear model as C; part of emit.h. */
#ifndef PLGEN_EMIT_REGIONS_H
#define PLGEN_EMIT_REGIONS_H

#include <stdbool.h>

struct emitter;

/* ---- emit_regions.c, emit_ladder.c: their tables, a step ---- */

void emit_regions(const struct emitter *e);                       /* tables of a piecewise-linear model */
int varies_params(const struct emitter *e);                       /* beside regions: NAME_vary_params is there */
void emit_retuned_numbers(const struct emitter *e);               /* NAME_coeffs, where it is these tables */
int rungs_of_all(const struct emitter *e);
void emit_region_members(const struct emitter *e);
void emit_region_start(const struct emitter *e);                  /* in set */
/* A comment: how an event is found, by the names of the tables; of independent parts by those of the first */
void emit_event_note(const struct emitter *e);
void emit_event_note_of_parts(const struct emitter *e);
void declare_region_search(const struct emitter *e);               /* what the step calls of it */
void emit_region_step(const struct emitter *e);
void emit_region_at(const struct emitter *e);
/* For batches: what instances share of a step, x but its states; a step over lanes that leaves those with events */
void emit_shared_of_regions(const struct emitter *e);
void emit_lanes_of_regions(const struct emitter *e);
/* The last entries of x that are params, which each instance has of its own: factors of a batch, in this order */
const char **params_in_x(const struct emitter *e, int *count);

/* emit_parts.c: of independent parts, each as it would be alone */
void emit_part_tables(const struct emitter *e);
void emit_part_members(const struct emitter *e);
void emit_part_start(const struct emitter *e);
void emit_parts_step(const struct emitter *e);
void emit_parts_at(const struct emitter *e);
/* NAME_vary_all(s, ds, [u, du,] tau): the derivatives go on by tau, from s */
void emit_all_varied(const struct emitter *e);
/* Whether a step and that of its derivatives are one, NAME_step_both, so that events are looked for once */
bool shares_step(const struct emitter *e);
/* What derivatives.h asks for those of outputs, rows over an x of so many entries */
int emit_varied_outputs(const struct emitter *e);

#endif
