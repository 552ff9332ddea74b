/* SPDX-License-Identifier: MIT-0 */
/* Models followed step by step beside the equations by hand in long double, through times at which formulas change. */
#ifndef FOLLOWED_H
#define FOLLOWED_H

#include "alike.h"
#include "gragg.h"

enum { STEPS = 60, MOST = 40, MOST_CHANGES = 5 };

struct subject {
	const char *name;
	equations *f;                       /* NULL: that of `systems` */
	real piece;                         /* of the second road: below 4 over the fastest rate; 0: 0.05 */
	int steps;                          /* 0: STEPS */
	double bound, between;              /* of errors, over the largest value of the state; 0: the test's own */
	int changes;
	real change[MOST_CHANGES];          /* when formulas change */
};

/* timed.spec, changing.spec and masses.spec */
equations timed, changing, masses;

equations *field(const struct subject *s);

/* y from `from` to `to`, through what changes: up to it the formula before, of what begins there nothing */
void solve(const struct subject *s, const pl_model *m, real from, real to, const real *u, real *y);

/* *worst <- the largest difference over `most`, if that is above it; what is not a number is */
void look(double *worst, const pl_model *m, const double *found, const real *expected, const double *most);

struct found {
	double step, middle, end;           /* largest differences, over the largest value of the state */
};

/* States after steps, NAME_at in the middle of each, and at its end beside the step, with random samples. What the
 * status says makes `step` infinite. */
struct found follow(const struct subject *s, const pl_model *m);

#endif
