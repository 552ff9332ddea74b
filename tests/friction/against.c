/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "against.h"
#include "drive.h"
#include "tap.h"
#include "worse.h"

#include <math.h>

static const double tolerance = 1e-12;      /* of end states, over the largest value, or 0.1 */
static const double late = 1e-10;           /* of the time of an event [s] */

bool ends_as(const struct variant *of, const struct motion_end *truth, unsigned seed, int step, struct off *off)
{
	static double time[MOST_OF_EVENTS];
	static pl_crossing crossing[MOST_OF_EVENTS];
	double y[MOST_STATES], worst = 0, size = 0.1, apart = 0;
	struct run r = run_new(of);
	int count = run_crossings(&r, SECONDS, MOST_OF_EVENTS, time, crossing);
	run_state(&r, y);
	for (int i = 0; i < truth->states; i++)
		size = fmax(size, fabs(y[i]));
	for (int i = 0; i < truth->states; i++)
		worst = worse(worst, fabs(y[i] - (double)truth->y[i]) / size);
	for (int i = 0; i < count && i < truth->events; i++)
		apart = worse(apart, fabs(time[i] - truth->time[i]));
	int status = r.of->model->status ? r.of->model->status(r.state) : 0;
	run_free(&r);
	off->state = worse(off->state, worst);
	off->time = worse(off->time, apart);
	bool good = count == truth->events && worst <= tolerance && apart <= late && status == 0;
	if (!good)
		note("seed %u, step %d: %d events, true are %d; off by %.3g, tolerance %g; times by %.3g; status %d",
		     seed, step, count, truth->events, worst, tolerance, apart, status);
	return good;
}
