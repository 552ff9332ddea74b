/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How a scene moves, in multiprecision: Taylor series of 191 bits from one event to the next, each event halved in on
 * a short piece of the series. Which contacts stick, slide, rest and are open behind an event is found by trying all
 * combinations: the one that keeps to all laws from there on. */
#ifndef TRUTH_H
#define TRUTH_H

#include "masses.h"

/* What a contact does. Of a stop: OPEN or CLOSED. Of friction: what the velocity v - belt is. Of an impact: OPEN or
 * RESTING. */
enum mode { OPEN, CLOSED, RESTING, BACKWARD, STICKING, FORWARD };
struct event {
	double time;
	int contact;
	enum mode from, to;     /* of a bounce: OPEN and OPEN */
};
enum { MOST_FOUND = 4000, MOST_VIEWS = 8 };
struct truth {
	int events;
	struct event event[MOST_FOUND];
	double q[MOST_MASSES], v[MOST_MASSES];
	double slowest;         /* at which a stop or an impact was met, before it bounces in short; what is off there
				 * grows by its inverse */
	/* no combination keeps to the laws, or more than one; or an event that is near to none: this scene decides
	 * nothing */
	bool doubtful;
	const char *doubt;
};

/* until: a whole number of thousandths [s]. brief: for each of the views, bounces that would all be over within this
 * time [s] are not listed; their contact rests, at the time when the last of them would be over. The state does not
 * know of it, so that all views are of one run. nudge: what is added to all positions at the start, and to velocities
 * that are not 0. */
void truth_run(const struct scene *s, double until, int views, const double *brief, double nudge, struct truth *found);

#endif
