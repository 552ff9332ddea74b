/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random values of params for coefficients.c. */
#ifndef FAMILIES_H
#define FAMILIES_H

#include "tuned.h"

#ifdef REAL_FLOAT
enum { BITS = 24 };
#else
enum { BITS = 53 };
#endif

/* Of pair.spec; `draw` returns h */
extern const struct family {
	const char *name;
	real (*draw)(real *p);
} families[];
extern const int family_count;

/* Of any model; returns h */
real draw_near(const struct tuned *m, real *p);

#endif
