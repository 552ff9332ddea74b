/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model's run beside what is true of it: every event in order, its time, the end states. */
#ifndef AGAINST_H
#define AGAINST_H

#include "variant.h"

#include <stdbool.h>

enum { SECONDS = 20, MOST_OF_EVENTS = 4096 };

struct motion_end {                 /* at t = SECONDS */
	int states, events;
	long double y[MOST_STATES];
	const double *time;         /* of the events */
};
struct off { double state, time; };     /* the largest so far: over the largest value, or 0.1; seconds */

/* Within 1e-12 and 1e-10 s, and no status; else it is noted, as `seed` and `step` */
bool ends_as(const struct variant *of, const struct motion_end *truth, unsigned seed, int step, struct off *off);

#endif
