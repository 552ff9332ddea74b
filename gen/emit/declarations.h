/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The comment at the top, the header, and what is the same for every model. */
#ifndef PLGEN_EMIT_DECLARATIONS_H
#define PLGEN_EMIT_DECLARATIONS_H

#include "state.h"

/* ---- banner.c, declarations.c: what a header has ---- */

void emit_banner(const struct emitter *e);
const char **names_of_outputs(const struct emitter *e);             /* index_names.c: as the user knows them */
const char **names_of_inputs(const struct emitter *e);
const char **names_of_params(const struct tuning *tuning);
/* enum { NAME_KIND_..., ... } */
void emit_names_of(const struct emitter *e, const char *kind, const char *const *name, int count);
void emit_index_names(const struct emitter *e);                    /* NAME_OUT_TIP and the like */
void declare_model(const struct emitter *e);               /* the descriptor, and units where there are some */
void declare_selftest(const struct emitter *e);            /* where it is asked for */
void announce(const struct emitter *e, const char *text, const char *comment);     /* one declaration */
/* guard: GUARD_DECLARED, which keeps them from being read twice */
void open_declarations(const struct emitter *e, const char *guard, const char *included);
void close_declarations(const struct emitter *e);
void emit_counts(const struct emitter *e, int inputs);            /* NAME_STATES and the like */
void declare_reading(const struct emitter *e, const char *status_note);           /* get, time, status */
void declare_driven_step(const struct emitter *e, const char *note);              /* step, out, run, at */
void emit_declarations(const struct emitter *e, bool rhs);

/* ---- kept.c: states as written, and as they are kept ---- */

void emit_conversions(const struct emitter *e);

/* ---- access.c: init, set, get, time, status ---- */

void emit_access(const struct emitter *e);

/* ---- descriptor.c: tables for all to read, and the descriptor ---- */

void emit_kept_phi(const struct emitter *e);
/* Those of the header: transfer matrix, input matrix; of a model of some modes from and to all states */
void emit_declared_tables(const struct emitter *e);
void emit_descriptor(const struct emitter *e);
/* names, NAME_any_init and the like, NAME_model; `core`: with what only a whole model has */
void emit_model(const struct emitter *e, int inputs, bool core);

/* ---- selftest.c: reference states in closed form, for the target to step to ---- */

void emit_selftest(const struct emitter *e, bool jumps);

/* ---- emit_peaks.c: the largest sizes of outputs ---- */

void emit_peak_tables(const struct emitter *e);
void emit_peak_members(const struct emitter *e);
void emit_peak_step(const struct emitter *e);
/* Members of NAME_coeffs, of tunable models */
void emit_nominal_peaks(const struct emitter *e);

#endif
