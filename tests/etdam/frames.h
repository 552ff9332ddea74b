/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The frames of these tests and the turning beam, by hand in long double, and where their formulas change. */
#ifndef FRAMES_H
#define FRAMES_H

#include "gragg.h"

enum { MOST = 30, MOST_CHANGES = 3 };

struct subject {
	equations *f;
	int states, changes;
	real change[MOST_CHANGES];          /* when formulas change */
	real piece;                         /* of a step of the truth */
};
extern const struct subject gyro_frame, spun_frame, turned_frame, bent_frame, rotor_frame, turning_beam;

/* y from `from` to `to`, through what changes; up to that the formula before */
void solve(const struct subject *s, real from, real to, real *y);

#endif
