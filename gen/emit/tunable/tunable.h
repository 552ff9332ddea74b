/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params as C. */
#ifndef PLGEN_EMIT_TUNABLE_H
#define PLGEN_EMIT_TUNABLE_H

#include "emit/state.h"

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
void emit_tuned_at(const struct emitter *e);                      /* pass, from change to change of the loads; at */
void emit_node_times(const struct emitter *e);                     /* NAME_node */
/* phases and envelopes from the start of the step to each node */
void emit_node_phases(const struct emitter *e, const bool *loads);

#endif
