/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random systems with dry friction, stops and loads, as a spec and as what is true of them: another road to the same
 * motion, by Taylor series of the equations in long double, short steps and bisection. */
#ifndef SLIDING_H
#define SLIDING_H

#include <stdio.h>

typedef long double wide;

enum { MOST_COORDS = 4, MOST_FRICTION = 3, MOST_STOPS = 2, SLIDING_EVENTS = 4096 };

struct rubbing {                    /* friction(direction . x' - belt - swing cos(w t), force + mu max(x_at, 0)) */
	int direction[MOST_COORDS];
	double belt, swing, w, force, mu;
	int at;
};
struct sliding_stop {               /* stiffness max(x_at - gap, 0) */
	int at;
	double gap, stiffness;
};
struct sliding {
	int n, rubs, stops;
	double m[MOST_COORDS], k[MOST_COORDS + 1], c[MOST_COORDS + 1]; /* of springs and dampers between neighbours */
	double f[MOST_COORDS], w[MOST_COORDS], p[MOST_COORDS];         /* loads f cos(w t + p) */
	struct rubbing rub[MOST_FRICTION];
	struct sliding_stop stop[MOST_STOPS];
	double start[2 * MOST_COORDS];
};
struct sliding_state {
	wide y[2 * MOST_COORDS], t;
	int rub[MOST_FRICTION];         /* -1, 0, 1: slips down, sticks, slips up */
	int stop[MOST_STOPS], normal[MOST_FRICTION];   /* whether what max takes is above 0 */
	int events, undecided;
	double time[SLIDING_EVENTS];    /* of every change, passing from slip to slip being two */
	int sticks;                     /* how often something came to stick */
};
struct sliding sliding_system(unsigned seed);
void print_sliding(FILE *to, const char *name, const struct sliding *s);
void sliding_start(const struct sliding *s, struct sliding_state *now);
void sliding_until(const struct sliding *s, struct sliding_state *now, double end);

#endif
