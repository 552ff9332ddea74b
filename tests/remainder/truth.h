/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solutions by SUNDIALS of equations written by hand. */
#ifndef TRUTH_H
#define TRUTH_H

#include "hand.h"

#include <stdbool.h>

enum solver {
    ARKODE_EXPLICIT,        /* order 8 (Fehlberg) */
    ARKODE_AFFINE,          /* implicit, order 5, L-stable (Kennedy and Carpenter), of equations that are affine in y */
    CVODE_ADAMS,
    CVODE_BDF,
};

/* dydt of a system of n states; u as in struct system. */
typedef void slopes(const void *of, double t, const double *y, const double *u, double *dydt);

struct truth;

/* scale: the size of each state, for the absolute tolerances: relative times scale. */
struct truth *truth_new(int n, slopes *f, const void *of, enum solver solver, double relative, const double *scale);
void truth_free(struct truth *t);

/* y <- the state at the time `to`, from y at the time `from`.  Without inputs all but ARKODE_EXPLICIT go on from their
 * own last state where `from` is the last `to`; else the solver begins anew, so nothing need be smooth at `from`.
 * u0: inputs at `from`, then their slopes. */
bool truth_advance(struct truth *t, double from, double to, int inputs, const double *u0, double *y);

/* `slopes` of a struct system. */
void system_slopes(const void *system, double t, const double *y, const double *u, double *dydt);

#endif
