/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models of these tests by hand: their equations with the formulas that hold in given intervals, and the
 * expressions whose breakpoints divide them. */
#ifndef DIVIDED_SYSTEMS_H
#define DIVIDED_SYSTEMS_H

#include "gragg.h"

enum { MOST_EXPRESSIONS = 12, MOST_BREAKS = 3, MOST_OF_STATES = 6 };

struct switched_system {
	const char *name;
	int states, expressions;
	real start[MOST_OF_STATES];
	equations *f;                           /* reads `interval_of` */
	void (*e)(real t, const real *y, real *e);
	int breaks[MOST_EXPRESSIONS];
	real at[MOST_EXPRESSIONS][MOST_BREAKS];
	real change;                            /* when a load changes its formula; 0: none does */
	real piece;                             /* in which an expression passes no two breakpoints; 0: 1/64 */
};

extern const struct switched_system switched_systems[];
extern const int switched_count;
extern const struct switched_system switched_stiff[];   /* in pieces so short that an explicit method follows them */
extern const int switched_stiff_count;
extern int interval_of[MOST_EXPRESSIONS];   /* which formulas hold */
extern int after_change;

/* y from `from` to `to`, from crossing to crossing; at time `from` expressions may stand on a breakpoint only after a
 * crossing there. Returns how many breakpoints were passed; their times into crossed[], up to `room`. */
int follow_switched(const struct switched_system *s, real from, real to, real *y, real *crossed, int room);
/* The intervals where y is, clear of every breakpoint */
void place_switched(const struct switched_system *s, real t, const real *y);

#endif
