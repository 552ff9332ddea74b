/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random masses with what a Taylor series may not see before it is there: steep friction, soft contacts, forces narrow
 * in place, pulses narrow in time; the same system as a spec and by hand. */
#ifndef UNSEEN_SYSTEM_H
#define UNSEEN_SYSTEM_H

#include "gragg.h"

#include <stdio.h>

enum { UNSEEN_SECONDS = 12, UNSEEN_KINDS = 22, UNSEEN_FIRST_GIVEN = 1000000, UNSEEN_GIVEN = 5 };

struct unseen {
    int kind, masses;
    double tolerance, step;
    double stiffness, damping, cubic, force, frequency; /* of the first mass and what drives it */
    double size, steep, at, until;                      /* of what is not seen */
    int power;
    double start[4];                                    /* x, y, x', y', or x, x' */
};

struct unseen unseen_of(unsigned seed);
void print_unseen(FILE *to, const struct unseen *u);

/* From `from` to `to`, in pieces short enough for what is steep */
void follow_unseen(const struct unseen *u, real from, real to, real *y);

#endif
