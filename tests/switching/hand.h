/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Masses, springs and stops by hand, in long double: x'' = -K x - C x' + f0 + f1 t + fa cos(w t) - stops, stepped by
 * Taylor series between crossings that are sought the way others do it, by signs at the ends of steps, which shows what
 * that test misses. With short steps, cut where a stop is nearest, nothing is missed: the reference. */
#ifndef HAND_H
#define HAND_H

typedef long double real;

enum { HAND_MASSES = 3, HAND_STOPS = 4 };

/* While d = row . x - gap - rate t - a sin(w t) > 0 the accelerations have -push (k d + c row . x') */
struct hand_stop {
	real row[HAND_MASSES], push[HAND_MASSES];
	real k, c, gap, rate, a, w;
};

enum { HAND_LOGGED = 1000 };
struct hand_log {
	int count;
	real time[HAND_LOGGED];     /* of the first crossings */
};

struct hand_system {
	int n, stops;
	real K[HAND_MASSES][HAND_MASSES], C[HAND_MASSES][HAND_MASSES];
	real f0[HAND_MASSES], f1[HAND_MASSES], fa[HAND_MASSES], w;
	real start[2 * HAND_MASSES];
	struct hand_stop stop[HAND_STOPS];
	struct hand_log *log;       /* NULL: none */
};

struct hand_state {
	real t, y[2 * HAND_MASSES];
	int touches[HAND_STOPS];
	long crossings;
	real last;                  /* time of the last crossing */
};

void hand_start(const struct hand_system *s, struct hand_state *now);
/* From now on it is another system, with the same coordinates and stops: what has jumped by that crosses. */
void hand_change(const struct hand_system *s, struct hand_state *now);
void hand_step(const struct hand_system *s, struct hand_state *now, real h);
void hand_until(const struct hand_system *s, struct hand_state *now, real t, real h);    /* equal steps of at most h */
/* short steps, cut where a stop is nearest */
void hand_reference(const struct hand_system *s, struct hand_state *now, real t);
real hand_distance(const struct hand_system *s, int stop, const real *y, real t);

#endif
