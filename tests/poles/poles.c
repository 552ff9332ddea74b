/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States and times of events beside a pole that is as fast as may be: kink.spec and stiff.spec against their closed
 * form. A variant is named after its L; a tuned one is retuned to each. */
#include "drive.h"
#include VARIANTS
#include "tap.h"
#include "truth.h"

#include <stdlib.h>
#include <string.h>

static const double end = 2;

/* etdrk4 leaves an error of h^4 behind the crossing */
static double enough(const pl_model *m)
{
	return strncmp(m->name, "etd", 3) == 0 ? 2e-9 : 1e-13;
}

static bool states_agree(const pl_model *m, double L, const double *y, const struct truth *truth)
{
	bool good = true;
	/* y1, y2, x, b, x', b': of a model of the pair alone the first two */
	for (int i = 0; i < m->states; i++)
		good = close_to(y[i], (double)truth->y[i], enough(m), "%s, h = %g, L = %g: state %d at %g", m->name,
				m->h, L, i, end) && good;
	return good;
}

/* Expressions in the order of the bodies: y1, x', b; of the pair alone the first */
static bool events_agree(const pl_model *m, double L, int found, const double *time, const struct truth *truth)
{
	bool good = true;
	int next = 0;
	for (int k = 0; k < truth->events; k++) {
		if (m->states == 2 && truth->event[k].body != 0)
			continue;
		if (next == found)
			return false;
		good = close_to(time[next++], (double)truth->event[k].time, enough(m),
				"%s, h = %g, L = %g: event %d", m->name, m->h, L, k) && good;
	}
	return good && next == found;
}

static void run(const struct variant *of, double L, bool retuned)
{
	const pl_model *m = of->model;
	const struct truth truth = truth_at((long double)L, (long double)end);
	double time[MOST_EVENTS], y[MOST_STATES];
	pl_crossing crossing[MOST_EVENTS];
	struct run r = run_new(of);
	const int status = retuned ? m->retune(r.state, &L, m->h) : 0;
	const int found = run_crossings(&r, end, MOST_EVENTS, time, crossing);
	run_state(&r, y);
	ok(status == 0 && m->status(r.state) == 0, "%s, h = %g, L = %g: it runs", m->name, m->h, L);
	ok(states_agree(m, L, y, &truth), "%s, h = %g, L = %g: states at %g", m->name, m->h, L, end);
	ok(events_agree(m, L, found, time, &truth), "%s, h = %g, L = %g: %d events", m->name, m->h, L, found);
	run_free(&r);
}

int main(void)
{
	static const double all[] = { 1e2, 2.7e3, 2.7e4, 2.7e5, 2.7e6, 1e8 };
	for (const struct variant *of = TABLE; of->model; of++) {
		const bool retuned = strncmp(of->model->name, "tuned", 5) == 0;
		for (size_t k = 0; k < sizeof all / sizeof *all && retuned; k++)
			run(of, all[k], true);
		if (!retuned)
			run(of, atof(strstr(of->model->name, "_L") + 2), false);
	}
	return tap_end();
}
