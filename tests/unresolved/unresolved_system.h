/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random masses with what a Taylor series may not see before it is there: steep friction, soft contacts, forces narrow
 * in place, pulses narrow in time; the same system as a spec and by hand. */
#ifndef UNRESOLVED_SYSTEM_H
#define UNRESOLVED_SYSTEM_H

#include "gragg.h"

#include <stdio.h>

enum { UNRESOLVED_SECONDS = 12, UNRESOLVED_KINDS = 22, UNRESOLVED_FIRST_GIVEN = 1000000, UNRESOLVED_GIVEN = 5 };

struct unresolved {
	int kind, masses;
	double tolerance, step;
	double stiffness, damping, cubic, force, frequency; /* of the first mass and what drives it */
	double size, steep, at, until;                      /* of what is not seen */
	int power;
	double start[4];                                    /* x, y, x', y', or x, x' */
};

struct unresolved unresolved_of(unsigned seed);
void print_unresolved(FILE *to, const struct unresolved *u);

/* From `from` to `to`, in pieces short enough for what is steep */
void follow_unresolved(const struct unresolved *u, real from, real to, real *y);

#endif
