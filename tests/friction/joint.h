/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random chains of masses with elements of Jenkins: springs in series with sliders that have no mass, some with a
 * damper beside them. As a spec, and as what is true of them by another road: Taylor series in long
 * double, bisection. */
#ifndef JOINT_H
#define JOINT_H

#include <stdio.h>

typedef long double wide;

enum { JOINT_MASSES = 3, JOINT_SLIDERS = 4, JOINT_EVENTS = 4096 };

struct jenkins {                    /* stiffness (x_at - z), held up to `force` on x_to, or on the ground */
	int at, to;                 /* to -1: the ground */
	double stiffness, force, damping; /* damping (z' - x_to') beside the friction */
};
struct joint {
	int n, sliders, stopped;    /* stopped: x1 meets a spring at `gap` */
	double m[JOINT_MASSES], k[JOINT_MASSES], c[JOINT_MASSES]; /* to the one before, of the first to the ground */
	double f[JOINT_MASSES], w[JOINT_MASSES], start[JOINT_MASSES], speed[JOINT_MASSES];
	double gap, stop;
	struct jenkins slider[JOINT_SLIDERS];
};
struct joint_state {
	wide x[JOINT_MASSES], v[JOINT_MASSES], z[JOINT_SLIDERS], t;
	int slides[JOINT_SLIDERS];  /* -1, 0, 1 */
	int meets;                  /* whether the stop is touched */
	int events;
	double time[JOINT_EVENTS];
};
struct joint joint_system(unsigned seed);
void print_joint(FILE *to, const char *name, const struct joint *s);
void joint_start(const struct joint *s, struct joint_state *now);
void joint_until(const struct joint *s, struct joint_state *now, double end);

#endif
