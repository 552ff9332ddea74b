/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is true in quadruple precision (33 digits), which the charts hold errors of 1e-12 against: truth.c. */
#ifndef QUAD_H
#define QUAD_H

#include <quadmath.h>
#include <stdlib.h>

#include "charts.h"

typedef __float128 quad;

/* A decimal of at most 13 digits for the double next to it: 0.01 means 1/100. */
static inline quad exactly(double x)
{
	char text[40];
	snprintf(text, sizeof text, "%.12e", x);
	return strtod(text, NULL) == x ? strtoflt128(text, NULL) : (quad)x;
}

/* e^{A length}, n x n, row-major, n at most 64 */
void quad_exponential(int n, const quad *A, quad length, quad *E);

#endif
