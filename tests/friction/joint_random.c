/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random chains with elements of Jenkins, at steps far apart, against their equations in long double: every event in
 * order, and the end states.
 *
 * The models are in the header VARIANTS and in TABLE, their seeds in FIRST and COUNT. */
#include "against.h"
#include "drive.h"
#include "joint.h"
#include VARIANTS
#include "tap.h"

enum { STEPS = 3 };

/* Places, sliders, velocities */
static struct motion_end end_of(const struct joint *s, const struct joint_state *truth)
{
	struct motion_end end = { .events = truth->events, .time = truth->time };
	for (int i = 0; i < s->n; i++)
		end.y[end.states++] = truth->x[i];
	for (int i = 0; i < s->sliders; i++)
		end.y[end.states++] = truth->z[i];
	for (int i = 0; i < s->n; i++)
		end.y[end.states++] = truth->v[i];
	return end;
}

int main(void)
{
	struct off off = { 0, 0 };
	long events = 0;
	for (unsigned seed = FIRST; seed < FIRST + COUNT; seed++) {
		struct joint s = joint_system(seed);
		struct joint_state truth;
		bool good = true;
		joint_start(&s, &truth);
		joint_until(&s, &truth, SECONDS);
		events += truth.events;
		const struct motion_end end = end_of(&s, &truth);
		for (int step = 0; step < STEPS; step++)
			good = ends_as(variant_of(TABLE, "joint%u_%d", seed, step), &end, seed, step, &off) && good;
		ok(good, "joint %u: %d masses, %d sliders, %d stop: %d events", seed, s.n, s.sliders, s.stopped,
		   truth.events);
	}
	note("%ld events; states off by %.3g, times by %.3g s at most", events, off.state, off.time);
	return tap_end();
}
