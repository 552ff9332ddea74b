/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of step/certify have from one another, and nobody else. */
#ifndef PLGEN_STEP_CERTIFY_INNER_H
#define PLGEN_STEP_CERTIFY_INNER_H

#include "certify.h"

/* ---- trajectory.c: a piecewise-linear model through its crossings, enclosed ---- */

void trajectory_state(const struct trajectory *t, int state, mpfi_ptr value);  /* where it has got to */
void trajectory_limit(struct trajectory *t, int most);      /* crossings; what comes behind them is not decided */

/* ---- passing.c: the same through crossings ---- */

double ulp_of(double value, bool single);
void reference_start(int state, mpq_ptr value);              /* a start that has nothing special */
struct reference new_reference(const struct step *step);    /* room for its rows */
struct reference reference_of_trajectory(const struct step *step); /* leaves the statement where nothing is known */

#endif
