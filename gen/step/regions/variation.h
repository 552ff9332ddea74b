/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of the tables of regions. */
#ifndef PLGEN_STEP_VARIATION_H
#define PLGEN_STEP_VARIATION_H

#include "step/step.h"

struct guards;

/* ---- variation.c: derivatives of the tables of regions by params ---- */

struct varied_model {               /* a column: the model at two values of its param */
	const struct model *more, *less; /* themselves, where it is by no param */
	mpq_t apart;                /* by so much the params are */
};
struct varied_entry { int row, column; double value; };
struct variation {                  /* as pl_variation has it: of all columns the blocks in turn */
	int blocks, *first;
	int entries;
	struct varied_entry *entry;
};
struct varied_model *varied_models(const struct step *step); /* of each of step->derivatives; leaves the statement */
double varied_number(const struct varied_model *v, mpq_srcptr more, mpq_srcptr less); /* its derivative, rounded */
/* of outputs, rows over x of this layout: per column and segment of time a block */
struct variation variation_of_outputs(const struct step *step, const struct layout *x);
void vary_start(const struct step *step, int column, double *value); /* of its initial state */
/* of the tables of a step, or of one of its parts; g NULL: it has no guards */
struct variation variation_of(const struct step *step, int part, const struct guards *g);

#endif
