/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random systems whose loads and stops change their formula in time, at steps so long that several crossings and
 * changes fall into one, against the system by hand in long double, from change to change: end states, and the times of
 * all crossings, those by a jump of a load among them.
 *
 * The models are in the header VARIANTS and in TABLE, their seeds in FIRST and COUNT. */
#include "drive.h"
#include "timed_system.h"
#include VARIANTS
#include "tap.h"
#include "worse.h"

#include <math.h>
#include <string.h>

enum { STEPS = 5, SECONDS = 24 };
static const double steps[STEPS] = { 0.5, 1, 2, 4, 0.005 };
static const double tolerance = 1e-12;      /* of end states and times, times what a change of the start grows by */

static long crossings, jumps;
static double worst_state, worst_time;

static double size_of(const struct hand_system *s, const real *y)
{
	double size = 0.1;
	for (int i = 0; i < 2 * s->n; i++)
		size = fmax(size, fabs((double)y[i]));
	return size;
}

/* How far a start that is a little off is off in the end, by hand; at least 1 */
static double growth(const struct timed_system *s, const struct hand_state *truth)
{
	const real little = 1e-9L;
	double most = 1;
	struct timed_system other = *s;
	for (int k = 0; k < s->segments; k++)
		other.in[k].log = NULL;
	for (int i = 0; i < 2 * s->in->n; i++) {
		struct hand_state end;
		other.in->start[i] = s->in->start[i] + little;
		timed_reference(&other, &end, SECONDS);
		for (int j = 0; j < 2 * s->in->n; j++)
			most = fmax(most, fabs((double)((end.y[j] - truth->y[j]) / little)));
		other.in->start[i] = s->in->start[i];
	}
	return most;
}

static bool compare_times(const char *name, const struct hand_log *log, int count, const double *time, double grown)
{
	bool good = close_to(count, log->count, 0, "%s: crossings", name);
	for (int i = 0; i < count && i < log->count; i++) {
		const double off = fabs(time[i] - (double)log->time[i]) / grown;
		worst_time = worse(worst_time, off);
		good = close_to(time[i], (double)log->time[i], tolerance * grown, "%s: time of crossing %d", name, i) &&
		       good;
	}
	return good;
}

static bool compare(const struct hand_system *s, const struct hand_state *truth, double grown, unsigned seed, int step)
{
	const struct variant *of = variant_of(TABLE, "timed%u_%d", seed, step);
	struct run r = run_new(of);
	static double time[HAND_LOGGED], y[MOST_STATES];
	static pl_crossing crossing[HAND_LOGGED];
	const int count = run_crossings(&r, SECONDS, HAND_LOGGED, time, crossing);
	char name[60];
	snprintf(name, sizeof name, "timed %u, h = %g", seed, steps[step]);
	bool good = compare_times(name, s->log, count, time, grown);
	good = close_to((double)of->crossed(r.state), (double)truth->crossings, 0, "%s: crossings in all", name) &&
	       good;
	good = close_to(of->model->status(r.state), 0, 0, "%s: status", name) && good;
	run_state(&r, y);
	for (int i = 0; i < 2 * s->n; i++) {
		const double size = size_of(s, truth->y), off = fabs(y[i] - (double)truth->y[i]) / size / grown;
		worst_state = worse(worst_state, off);
		good = close_to(y[i], (double)truth->y[i], tolerance * size * grown, "%s: state %d", name, i) && good;
	}
	run_free(&r);
	return good;
}

/* NAME_at inside of steps of 4 is what steps of 1 come to. */
static bool compare_inside(const struct hand_system *s, double grown, unsigned seed)
{
	const struct variant *of = variant_of(TABLE, "timed%u_3", seed), *fine = variant_of(TABLE, "timed%u_1", seed);
	struct run r = run_new(of), f = run_new(fine);
	double y[MOST_STATES], expected[MOST_STATES], size = 1;
	bool good = true;
	while (f.steps < SECONDS) {
		for (int part = 1; part <= 4; part++) {
			run_step(&f, NULL);
			run_state(&f, expected);
			of->model->at(r.state, NULL, part, y);
			for (int i = 0; i < 2 * s->n; i++) {
				size = fmax(size, fabs(expected[i]));
				good = close_to(y[i], expected[i], tolerance * size * grown,
						"timed %u, NAME_at, t = %ld: state %d", seed, f.steps, i) && good;
			}
		}
		run_step(&r, NULL);
	}
	run_free(&r);
	run_free(&f);
	return good;
}

static int crossed_at_changes(const struct timed_system *s, const struct hand_log *log)
{
	int count = 0;
	for (int i = 0; i < log->count; i++)
		for (int k = 0; k + 1 < s->segments; k++)
			count += log->time[i] == s->change[k];
	return count;
}

static void one(unsigned seed)
{
	struct timed_system s = timed_system(seed);
	struct hand_log log = { 0 };
	struct hand_state truth;
	for (int k = 0; k < s.segments; k++)
		s.in[k].log = &log;
	timed_reference(&s, &truth, SECONDS);
	const double grown = growth(&s, &truth);
	bool good = true;
	for (int step = 0; step < STEPS; step++)
		good = compare(s.in, &truth, grown, seed, step) && good;
	good = compare_inside(s.in, grown, seed) && good;
	crossings += truth.crossings;
	jumps += crossed_at_changes(&s, &log);
	ok(good, "timed %u: %d masses, %d stops, %d segments of time, %ld crossings, a start's error grows %.2g-fold",
	   seed, s.in[0].n, s.in[0].stops, s.segments, truth.crossings, grown);
}

int main(void)
{
	setvbuf(stdout, NULL, _IOLBF, 0);
	for (unsigned seed = FIRST; seed < FIRST + COUNT; seed++)
		one(seed);
	note("%d systems, %ld crossings, %ld of them by a load that jumps; end states off by at most %.2g, times by "
	     "%.2g", (int)COUNT, crossings, jumps, worst_state, worst_time);
	return tap_end();
}
