/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The exact course of a model over its first steps. */
#ifndef PLGEN_STEP_COURSE_H
#define PLGEN_STEP_COURSE_H

#include "step/step.h"

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

/* ---- course.c ---- */

/* Followed in 320 bits, and how far errors reach in it; false: the model is too large, or leaves the range */
bool make_course(const struct step *step, struct course *c);
double written_factor(const struct course *c, int states, int written, int kept); /* of a state as written */

#endif
