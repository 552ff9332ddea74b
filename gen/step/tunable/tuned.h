/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear steps with tunable params. */
#ifndef PLGEN_STEP_TUNED_H
#define PLGEN_STEP_TUNED_H

#include "model/tunable/tuning.h"
#include "step/step.h"

/* ---- tuned_zeros.c: factors that are 0 whatever the tunable params are ---- */

/* in its table: what vanishes at these values only is no zero */
void mark_tuned_zeros(struct step *step);
/* size x size: x_i follows x_j in time, in a branch's region (-1: some), for some values of the params */
bool *reached_elsewhere(const struct step *step, int branch);

/* ---- tuned_blocks.c: a linear step with tunable params, a large one block by block ---- */

double *nominal_outputs(const struct step *step);   /* those that depend on params: x columns of struct tuning */
struct tuned_block {                /* an independent block; x: its states, load states and inputs that act on it */
	const struct group *group;
	int index, block;           /* of the group */
	struct tuned_equations A;   /* loads in each segment of time, rows for them in the first */
	unsigned params;            /* that it depends on, a bit each */
	int size, *from;            /* of x, and which of the whole each is */
};
struct tuned_blocks {
	int blocks, all, touched;   /* those that the code has, of all, of which params touch some */
	struct tuned_block *block;  /* in the order of groups; where NAME_at is not there, those that params touch */
	bool solved;                /* there is one, the whole model, and others follow from params by its operations */
	struct tuned_equations others;  /* outputs that depend on params; then frequencies, in column 0 */
	int *frequency;             /* per load: its entry there, or -1 */
	int operations;             /* by which others follow from params */
	int work, more;             /* numbers of two words: for NAME_retune, beside these; for NAME_at */
	bool full;                  /* params touch every block: any h will do */
	int kilobytes;              /* of stack */
};
/* Per state: tunable params touch its independent block. NULL: there are none */
bool *touched_states(const struct step *step);
/* Per state: a number that those whose equations hang together share. NULL: there are no tunable params */
int *tuned_components(const struct step *step);
/* step->blocks; leaves the statement where a block is too large */
void plan_tuned_blocks(struct step *step);

#endif
