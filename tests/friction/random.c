/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random systems with dry friction, stops and moving ground, at steps far apart, against their equations in long
 * double: every event in order, and the end states.
 *
 * The models are in the header VARIANTS and in TABLE, their seeds in FIRST and COUNT. */
#include "against.h"
#include "drive.h"
#include "sliding.h"
#include VARIANTS
#include "tap.h"

enum { STEPS = 3 };

static struct sums { long events, sticks; } sums;

int main(void)
{
	struct off off = { 0, 0 };
	for (unsigned seed = FIRST; seed < FIRST + COUNT; seed++) {
		struct sliding s = sliding_system(seed);
		struct sliding_state truth;
		bool good = true;
		sliding_start(&s, &truth);
		sliding_until(&s, &truth, SECONDS);
		sums.events += truth.events;
		sums.sticks += truth.sticks;
		struct motion_end end = { .states = 2 * s.n, .events = truth.events, .time = truth.time };
		for (int i = 0; i < end.states; i++)
			end.y[i] = truth.y[i];
		for (int step = 0; step < STEPS; step++)
			good = ends_as(variant_of(TABLE, "sliding%u_%d", seed, step), &end, seed, step, &off) && good;
		ok(good && truth.undecided == 0,
		   "system %u: %d coordinates, friction %d times, %d stops: %d events, %d of sticking", seed,
		   s.n, s.rubs, s.stops, truth.events, truth.sticks);
	}
	note("%ld events, %ld of sticking; states off by %.3g, times by %.3g s at most", sums.events, sums.sticks,
	     off.state, off.time);
	return tap_end();
}
