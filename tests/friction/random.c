/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random systems with dry friction, stops and moving ground, at steps far apart, against their equations in long
 * double: every event in order, and the end states.
 *
 * The models are in the header VARIANTS and in TABLE, their seeds in FIRST and COUNT. */
#include "drive.h"
#include "sliding.h"
#include VARIANTS
#include "tap.h"

#include <math.h>

enum { STEPS = 3, SECONDS = 20 };
static const double tolerance = 1e-12;      /* of end states, over the largest value of the kind */
static const double late = 1e-10;           /* of the time of an event [s] */

static struct sums { long events, sticks; int worse_order; double state, time; } sums;

static double sizes(const struct sliding *s, const double *y)
{
	double size = 0.1;
	for (int i = 0; i < 2 * s->n; i++)
		size = fmax(size, fabs(y[i]));
	return size;
}

static bool at_step(const struct sliding *s, const struct sliding_state *truth, unsigned seed, int step)
{
	static double time[SLIDING_EVENTS];
	static pl_crossing crossing[SLIDING_EVENTS];
	double y[MOST_STATES], worst = 0, size, off = 0;
	struct run r = run_new(variant_of(TABLE, "sliding%u_%d", seed, step));
	int count = run_crossings(&r, SECONDS, SLIDING_EVENTS, time, crossing);
	run_state(&r, y);
	size = sizes(s, y);
	for (int i = 0; i < 2 * s->n; i++)
		worst = worse(worst, fabs(y[i] - (double)truth->y[i]) / size);
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
		struct sliding s = sliding_system(seed);
		struct sliding_state truth;
		bool good = true;
		sliding_start(&s, &truth);
		sliding_until(&s, &truth, SECONDS);
		sums.events += truth.events;
		sums.sticks += truth.sticks;
		for (int step = 0; step < STEPS; step++)
			good = at_step(&s, &truth, seed, step) && good;
		ok(good && truth.undecided == 0,
		   "system %u: %d coordinates, friction %d times, %d stops: %d events, %d of sticking", seed,
		   s.n, s.rubs, s.stops, truth.events, truth.sticks);
	}
	note("%ld events, %ld of sticking; states off by %.3g, times by %.3g s at most", sums.events, sums.sticks,
	     sums.state, sums.time);
	return tap_end();
}
