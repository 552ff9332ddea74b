/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What forms read, and how they are printed. */
#ifndef PLGEN_MODEL_READS_H
#define PLGEN_MODEL_READS_H

#include "model.h"

/* ---- spell.c: loads, forms and equations for a reader ---- */

const char *column_text(const struct load *load, int column); /* t*exp(-2*t)*cos(5*t) */
const char *equation_text(const struct model *model, const struct form *residual); /* coordinates = loads */
/* atoms spelled out, long ones cut short */
const char *form_text(const struct model *model, const struct form *form);

/* ---- reads.c: what forms read ---- */

int held_values(const struct model *model);     /* that an instance has: tunable params, then leads */
const struct symbol *held_symbol(const struct model *model, int held);
struct reads {                    /* what forms read */
	bool *state, *input, *load; /* inputs, then their slopes */
	bool *highest;              /* per coordinate its highest derivative, then multipliers */
	bool *param;                /* of held_values, where the instance has the spec's params */
	bool time, math;            /* t itself; <math.h> */
};
bool reads_input_slope(const struct model *model, int input);      /* does an output? */
bool reads_friction(const struct model *model, const struct form *form); /* what friction or a slider bears */
bool has_steady_outputs(const struct model *model);      /* is what outputs have of the state the same all along? */
struct reads reads_of(const struct model *model, int count, const struct form *const *form);
int  coordinate_of_row(const struct model *model, int row);       /* whose equation it is */

#endif
