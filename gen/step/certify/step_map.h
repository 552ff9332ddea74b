/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What bounds of rounding share: the step as a map over the state as it is kept, in double, and the model's exact
 * course. */
#ifndef PLGEN_STEP_MAP_H
#define PLGEN_STEP_MAP_H

#include "base/base.h"

struct forcing_of_column {          /* t^power e^{a t} cos or sin(w t + p); without forcing terms cos(p) = 1 */
	int power;
	bool turns, sine;
	double a, w, p;
};
struct step_map {                   /* the step over the state as it is kept: y+ = Phi y + load z + input u */
	int n, columns, inputs;
	double *Phi, *load, *input, *start;
	double *row, *direct, *feed[2]; /* of the output: y; z; u and u' */
	double *scale;              /* the state is in these units, powers of 2: those in which it is balanced */
	struct forcing_of_column *forcing; /* per load column */
	double *amplitude;          /* per load column: its largest size, of cosine and sine together */
	double *most;               /* per input column */
	double *size;               /* per state: the largest that it may become */
};
struct extent {                     /* of an output, over all samples */
	double most, last, slack;   /* by the loads and from the start, as walked through; how far that may be off */
	double lower;               /* of the largest, inputs counted */
};
/* The exact course of the model from the spec's initial values, inputs 0: rows are the states as they are kept; where
 * these are not as written, then those */
struct course {
	int steps, rows;
	const mpfr_t *written;      /* of each state as written: factors of those kept, and a constant */
	double *y, *z;              /* [steps + 1][row], [steps + 1][load columns] */
	int *segment;               /* [steps + 1] */
	double *largest;            /* per row */
	double *sum, *peak;         /* rows x states: sum and largest of |what it reads of Phi^m| */
};
struct errors {
	const struct step *step;
	const struct step_map *step_map;
	const struct requirement *r;
	long steps;
	/* of rounding, relative; where numbers leave the range below, or what has decayed is set to rest */
	double unit, tiny;
	double *size, *err;         /* per state, while a step is reckoned */
};

/* ---- kept.c ---- */

/* Followed in 320 bits, and how far errors reach in it; false: the model is too large, or leaves the range */
bool make_course(const struct step *step, struct course *c);
double written_factor(const struct course *c, int states, int written, int step_map); /* of a state as written */

/* ---- rounding.c ---- */

int levels(int terms);                                        /* additions above each of so many terms, in pairs */

#endif
