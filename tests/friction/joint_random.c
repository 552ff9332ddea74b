/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random chains with elements of Jenkins, at steps far apart, against their equations in long double: every event in
 * order, and the end states.
 *
 * The models are in the header VARIANTS and in TABLE, their seeds in FIRST and COUNT. */
#include "drive.h"
#include "joint.h"
#include VARIANTS
#include "tap.h"
#include "worse.h"

#include <math.h>

enum { STEPS = 3, SECONDS = 20 };
static const double tolerance = 1e-12;      /* of end states, over the largest value, or 0.1 */
static const double late = 1e-10;           /* of the time of an event [s] */

static struct sums { long events; double state, time; } sums;

static bool at_step(const struct joint *s, const struct joint_state *truth, unsigned seed, int step)
{
	static double time[JOINT_EVENTS];
	static pl_crossing crossing[JOINT_EVENTS];
	double y[2 * JOINT_MASSES + JOINT_SLIDERS], worst = 0, size = 0.1, off = 0;
	struct run r = run_new(variant_of(TABLE, "joint%u_%d", seed, step));
	int count = run_crossings(&r, SECONDS, JOINT_EVENTS, time, crossing), all = 2 * s->n + s->sliders;
	run_state(&r, y);
	for (int i = 0; i < all; i++)
		size = fmax(size, fabs(y[i]));
	for (int i = 0; i < all; i++) {         /* places, sliders, velocities */
		wide exact = i < s->n ? truth->x[i] : i < s->n + s->sliders ? truth->z[i - s->n]
									     : truth->v[i - s->n - s->sliders];
		worst = worse(worst, fabs(y[i] - (double)exact) / size);
	}
	for (int i = 0; i < count && i < truth->events; i++)
		off = worse(off, fabs(time[i] - truth->time[i]));
	int status = r.of->model->status ? r.of->model->status(r.state) : 0;
	run_free(&r);
	sums.state = worse(sums.state, worst);
	sums.time = worse(sums.time, off);
	bool good = count == truth->events && worst <= tolerance && off <= late && status == 0;
	if (!good)
		note("seed %u, step %d: %d events, true are %d; off by %.3g, tolerance %g; times by %.3g; status %d",
		     seed, step, count, truth->events, worst, tolerance, off, status);
	return good;
}

int main(void)
{
	for (unsigned seed = FIRST; seed < FIRST + COUNT; seed++) {
		struct joint s = joint_system(seed);
		struct joint_state truth;
		bool good = true;
		joint_start(&s, &truth);
		joint_until(&s, &truth, SECONDS);
		sums.events += truth.events;
		for (int step = 0; step < STEPS; step++)
			good = at_step(&s, &truth, seed, step) && good;
		ok(good, "joint %u: %d masses, %d sliders, %d stop: %d events", seed, s.n, s.sliders, s.stopped,
		   truth.events);
	}
	note("%ld events; states off by %.3g, times by %.3g s at most", sums.events, sums.state, sums.time);
	return tap_end();
}
