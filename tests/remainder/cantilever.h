/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The rotating beam by hand: five elements, every matrix by quadrature of its definition (its spec has them from closed
 * formulas).
 *     M q'' + 2 w G q' + (K + w^2 (D - M) + w' G) q = w^2 fu - w' fw
 * States: q (u, v, dv/dx of nodes 1 .. 5), then q'. */
#ifndef CANTILEVER_H
#define CANTILEVER_H

#include "hand.h"

enum { CANTILEVER_DOF = 15, CANTILEVER_STATES = 30, CANTILEVER_TIP = 13, CANTILEVER_STRETCH = 12 };

/* w(t) of the spin-up to Om within 15 s, and its slope. */
real cantilever_speed(real Om, real t, real *slope);

/* dydt at the speed w with slope dw. */
void cantilever_slopes(real w, real dw, const real *y, real *dydt);
void cantilever_slopes_double(double w, double dw, const double *y, double *dydt);

#endif
