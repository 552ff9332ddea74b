/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params as C. */
#ifndef PLGEN_EMIT_TUNABLE_H
#define PLGEN_EMIT_TUNABLE_H

#include "emit/state.h"

struct fixed_slope;
struct tuned_equations;

/* ---- emit_tuned_blocks.c: linear models with tunable params ---- */

void emit_tuned_members(const struct emitter *e);                 /* of NAME_coeffs */

/* ---- emit_entries.c: how entries follow from params ---- */

void emit_entries(const struct emitter *e, int count, const struct fixed_slope *fixed);
/* Operations by which all of the list follow from params; of each what a pl_equations has */
const char **emit_equations(const struct emitter *e, const struct tuning *t, int count,
			    const struct tuned_equations *const *list);

/* ---- emit_retuned.c: regions whose matrices tunable params change ---- */

void emit_retuned(const struct emitter *e);                       /* the equations, NAME_retune */
int  retuned_numbers(const struct emitter *e);                    /* of matrices, in NAME_coeffs */
int  retuned_kilobytes(const struct emitter *e);                  /* of stack, beside a NAME_coeffs */

/* ---- emit_held.c: params that an instance holds; of models without, nothing is printed ---- */

void emit_held_types(const struct emitter *e);
void emit_held_member(const struct emitter *e);
int  held_leads(const struct emitter *e);
void emit_nominal_factors(const struct emitter *e);              /* those that an instance begins with */
void emit_held_declarations(const struct emitter *e);
void banner_held(const struct emitter *e);
void emit_held_retune(const struct emitter *e);
/* the generator's own coefficients, of the spec's values */
void emit_nominal(const struct emitter *e);
void emit_retune(const struct emitter *e);                        /* the equations, retune, use */
void emit_tuned_at(const struct emitter *e);                      /* pass, from change to change of the loads; at */
void emit_node_times(const struct emitter *e);                     /* NAME_node */
/* phases and growths from the start of the step to each node */
void emit_node_phases(const struct emitter *e, const bool *loads);

#endif
