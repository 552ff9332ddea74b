/* SPDX-License-Identifier: GPL-3.0-or-later */
/* stiff.spec and kink.spec in closed form, from event to event, in long double. */
#ifndef TRUTH_H
#define TRUTH_H

enum { TRUTH_EVENTS = 8, TRUTH_STATES = 6 };

struct truth {
	long double y[TRUTH_STATES];    /* y1, y2, x, b, x', b' at the end */
	int events;
	struct {
		long double time;
		int body;               /* 0: the kink, 1: friction, 2: the ball */
	} event[TRUTH_EVENTS];
};

struct truth truth_at(long double L, long double end);

#endif
