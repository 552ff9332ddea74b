/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs after several steps at once, and the largest sizes of outputs. */
#ifndef PLGEN_STEP_ROWS_H
#define PLGEN_STEP_ROWS_H

#include "step/step.h"

/* ---- rows.c: outputs after several steps, from what stands at the start of a block of them ---- */

struct row_column {                 /* of a block: what this gives every number of it */
	struct operand operand;     /* a state, a load state; an input: the sample before the block */
	double *value;              /* [row][output] */
};
struct rows {
	int count, outputs;         /* rows in a block; numbers in a row */
	int columns;                /* those that give something */
	struct row_column *column;
	int group;                  /* rows summed side by side: samples after all of them are left out */
	/* per input, what a sample gives the outputs at the end of its step, after one more, ...: [row][output] */
	double **sample;
	/* The step of `count` h. Columns of inputs: those of ramps before the block, then each of its samples */
	struct step *block;
};
int  held_columns(const struct linear *system);              /* ramps: the samples before the block */
void plan_rows(struct step *step);                           /* step->rows; last, since it is a step of its own */
int row_numbers(const struct step *step);                   /* of the tables of a block of rows */

/* ---- peaks.c: outputs of which the largest size is asked for ---- */

struct peaks {                      /* of each of them, over x */
	double *row, *bend;         /* the output; bend . |x| bounds how far it is off its chord in a step */
};
int peak_outputs(const struct model *model);                 /* how many */
int peak_place(const struct model *model, const struct output *output); /* among them */
bool peaks_by_values(const struct step *step);               /* and not from x at the start of a step */
void check_peaks(const struct step *step);                   /* leaves the statement where one cannot be found */
struct peaks peaks_of(const struct step *step);

#endif
