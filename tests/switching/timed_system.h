/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random masses and stops beside loads, and stops that move, by formulas that change in time: as a spec and by hand. */
#ifndef TIMED_SYSTEM_H
#define TIMED_SYSTEM_H

#include "hand.h"

#include <stdio.h>

enum { TIMED_SEGMENTS = 6 };

struct timed_system {
	int segments;
	real change[TIMED_SEGMENTS];        /* [s]: from it on the system is in[s + 1] */
	struct hand_system in[TIMED_SEGMENTS];
};

/* Changes of all kinds: inside of steps of 0.5 .. 4, at their ends, several in one; loads and stops that go on, that
 * turn (by table()), that jump */
struct timed_system timed_system(unsigned seed);

void print_timed(FILE *to, const char *name, const struct timed_system *s, unsigned seed);

/* By hand from change to change, to t; the times of crossings go to the log of each */
void timed_reference(const struct timed_system *s, struct hand_state *now, real t);

#endif
