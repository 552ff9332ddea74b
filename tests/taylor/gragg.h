/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Gragg's modified midpoint rule with extrapolation (Bulirsch and Stoer; Hairer, Norsett and Wanner, II.9) in long
 * double, for smooth equations written by hand. */
#ifndef GRAGG_H
#define GRAGG_H

#include "hand.h"

typedef void equations(real t, const real *y, const real *u, real *dydt);

/* y <- n states at `to`, from those at `from`, in pieces no longer than `piece`. u: inputs at `from`, then their
 * slopes; NULL where there are none. */
void gragg(equations *f, int n, real from, real to, real piece, int inputs, const real *u, real *y);

#endif
