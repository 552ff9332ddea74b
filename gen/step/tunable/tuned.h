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
struct fixed_slope {                /* an entry of A, x' = A x, that no param changes: velocities, how loads go on */
	int row, column;
	struct coefficient value;
};
int fixed_slopes(const struct step *step, struct fixed_slope **list);
struct tuned_part {                 /* some of the equations of struct tuning, which the target solves by themselves */
	struct tuned_equations all;
	int *row, *unknown;         /* of struct tuning: what row i is, and what is found in its place */
	unsigned params;            /* that it depends on, a bit each */
};
struct tuned_block {                /* an independent block; x: its states, load states and inputs that act on it */
	const struct group *group;
	int index, block;           /* of the group */
	struct tuned_part part;     /* its highest derivatives, then frequencies of its loads */
	int derivatives;            /* of the rows, */
	int *place;                 /* and of which state each is */
	int size, *from;            /* of x, and which of the whole each is */
	int slopes;
	struct fixed_slope *slope;  /* entries of A that no param changes */
	int turns, *turn;           /* pairs of load states whose frequency changes: row of the part, place in x */
};
struct tuned_blocks {
	int blocks, all, touched;   /* those that the code has, of all, of which params touch some */
	struct tuned_block *block;  /* in the order of groups; where NAME_at is not there, those that params touch */
	bool solved;                /* there is one, the whole model, whose equations have what others would */
	/* outputs and frequencies that depend on params, and what accelerations these read */
	struct tuned_part others;
	int first_output;           /* row there of the first output that does; the others follow */
	int *frequency;             /* per load: its row there, or -1 */
	int work, more;             /* numbers of two words: for NAME_retune, beside those rows; for NAME_at */
	bool full;                  /* params touch every block: any h will do */
	int kilobytes;              /* of stack */
};
int width_of_equations(const struct tuned_equations *all);        /* columns, W's among them */
/* Per state: tunable params touch its independent block. NULL: there are none */
bool *touched_states(const struct step *step);
/* Per state: a number that those whose equations hang together share. NULL: there are no tunable params */
int *tuned_components(const struct step *step);
/* step->blocks; leaves the statement where a block is too large */
void plan_tuned_blocks(struct step *step);

#endif
