/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Derivatives of a problem's accelerations by its coordinates (Jq) and velocities (Jv), n x n, row-major, in closed
 * form: smooth models (equations.h), the beams, linear problems. */
#ifndef JACOBIAN_H
#define JACOBIAN_H

#include "charts.h"

typedef void jacobian_function(const struct problem *p, double t, const double *y, double *Jq, double *Jv);
/* NULL: none is known in closed form. Of a problem with a right-hand side of its own (rhs_of) its own
 * or a matrix is. */
jacobian_function *jacobian_of(const struct problem *p);

/* a = -M^-1 (K + w^2 (D - M) + w' G) q - 2 w M^-1 G q' + loads, w spun up to Om */
void beam_jacobian(double Om, double t, double *Jq, double *Jv);

#endif
