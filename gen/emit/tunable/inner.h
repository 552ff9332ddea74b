/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of emit/tunable have from one another, and nobody else. */
#ifndef PLGEN_EMIT_TUNABLE_INNER_H
#define PLGEN_EMIT_TUNABLE_INNER_H

#include "tunable.h"

struct tuned_equations;

/* ---- emit_tuned_blocks.c: linear models with tunable params ---- */

void emit_tuned_members(const struct emitter *e);                 /* of NAME_coeffs */

/* ---- emit_entries.c: how entries follow from params ---- */

struct equations_text { const char *formulas, *entries; };         /* what pl_formulas and pl_entries have */
/* together: all follow from params by the formulas of the first; else each by its own */
void emit_equations(const struct emitter *e, const struct tuning *t, bool together, int count,
		    const struct tuned_equations *const *list, struct equations_text *text);

/* ---- emit_retuned.c: regions whose matrices tunable params change ---- */

void emit_retuned(const struct emitter *e);                       /* the equations, NAME_retune */
int  retuned_numbers(const struct emitter *e);                    /* of matrices, in NAME_coeffs */
int  retuned_kilobytes(const struct emitter *e);                  /* of stack, beside a NAME_coeffs */

/* ---- emit_held.c: params that an instance holds; of models without, nothing is printed ---- */

void emit_retune(const struct emitter *e);                        /* the equations, retune, use */

/* ---- tuned_terms.c: factors that the instance has ---- */

int  place_in(int count, const int *list, int what);              /* count: it is not there */

#endif
