/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Smooth models solved by Taylor series in quadruple precision (33 digits): what the charts hold errors of 1e-12
 * against. The equations stand here a second time, as they are written in the models' specs, and share nothing with
 * plgen or NAME_rhs. */
#ifndef QUAD_TAYLOR_H
#define QUAD_TAYLOR_H

#include "charts.h"

/* Has this problem its equations here? By its name. */
bool quad_taylor_has(const struct problem *p);

/* Fills t->at_end, t->between (at TRUTH_BETWEEN), and the scales, which see the inside of every step too. Every step
 * leaves off less than 1e-29 of the scales; a history of 200 s keeps 25 digits where the problem's own conditioning
 * does. Start: the decimals of p->start. Where a value is not finite, or the steps vanish, the program is left. */
void quad_taylor(const struct problem *p, struct truth *t);

/* A decimal of at most 13 digits for the double next to it: 0.01 means 1/100. */
__float128 quad_of_decimal(double x);

/* e^{A length}, n x n, row-major, n at most 64 (truth.c) */
void quad_exponential(int n, const __float128 *A, __float128 length, __float128 *E);

#endif
