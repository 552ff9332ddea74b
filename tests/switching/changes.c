/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads that change their formula beside clearances, where a random system seldom gets: a crossing and a change at one
 * instant, by closed form; inputs that are held or ramps across changes, and NAME_at there, by steps of other lengths;
 * what stands in NAME_set to a time behind a change; outputs at a change. */
#include "drive.h"
#include "changes_variants.h"
#include "tap.h"
#include "worse.h"

#include <math.h>

/* A free mass that reaches x = 2 at t = 2, with speed 1; then the stop is at `at` */
static double meets(double t, double at)
{
	const double w = 3, met = fmax(2, at), depth = met - at, left = t - met;
	const double size = hypot(depth, 1 / w), contact = (acos(-1) - atan2(depth * w, 1)) / w;
	if (left < 0)
		return t;
	if (left < contact)
		return at + depth * cos(w * left) + sin(w * left) / w;
	return at - size * w * (left - contact);    /* it leaves with what it had in the stop */
}

static void closed_form(const char *name, double at, int step)
{
	const struct variant *of = variant_of(changes_table, "%s_%d", name, step);
	struct run r = run_new(of);
	double worst = 0, y[MOST_STATES];
	bool good = true;
	while (of->model->time(r.state) < 7.9) {
		run_step(&r, NULL);
		run_state(&r, y);
		const double t = of->model->time(r.state), off = fabs(y[0] - meets(t, at));
		worst = worse(worst, off);
		good = close_to(y[0], meets(t, at), 2e-14 * 10, "%s, h = %g, t = %g", name, of->model->h, t) && good;
	}
	ok(good, "%s, h = %g: the closed form, to %.2g", name, of->model->h, worst);
	run_free(&r);
}

/* ---- an input beside: steps of one length against those of another ---- */

static double sample(double t)
{
	return sin(2 * t) + 0.5 * cos(5 * t + 1);
}

/* What a long step makes of it: held from its start, or a ramp to its end */
static double within(double t, double h, bool ramp)
{
	const double from = h * floor(t / h + 1e-9), part = (t - from) / h;
	if (!ramp)
		return sample(from);
	return (from > 0 ? sample(from) : 0) * (1 - part) + sample(from + h) * part;
}

static void long_and_short(const char *name, int step, bool ramp)
{
	const struct variant *of = variant_of(changes_table, "%s_%d", name, step),
			     *fine = variant_of(changes_table, "%s_2", name);
	struct run r = run_new(of), f = run_new(fine);
	const double h = of->model->h;
	const int parts = (int)lround(h / fine->model->h);
	double worst = 0, y[MOST_STATES], z[MOST_STATES];
	bool good = true;
	for (int k = 0; k < 4 / h; k++) {
		const double from = k * h, u = sample(ramp ? from + h : from);
		for (int part = 1; part <= parts; part++) {
			const double now = from + part * fine->model->h;
			const double at = ramp ? now - (part == parts ? 1e-12 : 0) : now - fine->model->h;
			const double v = within(at, h, ramp);
			run_step(&f, &v);
			run_state(&f, z);
			of->model->at(r.state, &u, part * fine->model->h, y);
			good = same_numbers(y, z, of->model->states, 1e-11, &worst, name, now) && good;
		}
		run_step(&r, &u);
		run_state(&r, y);
		good = same_numbers(y, z, of->model->states, 1e-11, &worst, name, from + h) && good;
	}
	ok(good, "%s, h = %g: steps and times inside of them as steps of %g, to %.2g", name, h, fine->model->h, worst);
	ok(close_to((double)of->crossed(r.state), (double)fine->crossed(f.state), 0, "%s: crossings", name) &&
	   of->crossed(r.state) > 4, "%s, h = %g: %d crossings", name, h, (int)of->crossed(r.state));
	run_free(&r);
	run_free(&f);
}

/* The region of a state that is set is that of its time, and nothing is crossed to come there; what is told after a
 * step that ends at a change is what acts from there on. */
static void region_of_time(void)
{
	const struct variant *of = variant_of(changes_table, "gap_leaves_0");
	struct run r = run_new(of);
	const double y[2] = { 0.15, 0 };
	double out[2], worst = 0;
	run_set(&r, y);
	is_close(of->region(r.state), 1, 0, "set before the change: in the stop");
	for (int k = 1; k <= 8; k++) {
		run_step(&r, NULL);
		of->model->out(r.state, out);
		worst = worse(worst, fabs(out[1] - (0.5 * k < 2 ? 0.1 : 0.2)));
	}
	is_close(worst, 0, 0, "outputs at steps' ends: where the stop is from there on");
	of->model->set(r.state, 3, y);
	is_close(of->region(r.state), 0, 0, "set behind the change: clear of the stop");
	for (int k = 0; k < 20; k++)
		run_step(&r, NULL);
	is_close((double)of->crossed(r.state), 0, 0, "set behind the change: nothing is crossed");
	run_free(&r);
}

/* What an output alone reads changes too. */
static void only_told(int step)
{
	const struct variant *of = variant_of(changes_table, "told_%d", step);
	struct run r = run_new(of);
	double worst = 0;
	while (of->model->time(r.state) < 1) {
		double out[1];
		run_step(&r, NULL);
		of->model->out(r.state, out);
		const double t = of->model->time(r.state);
		worst = worse(worst, fabs(out[0] - (t < 0.344 ? 0.9 * t : t)));
	}
	is_close(worst, 0, 1e-15, "an output whose formula changes, h = %g", of->model->h);
	run_free(&r);
}

int main(void)
{
	for (int step = 0; step < 4; step++) {
		closed_form("meets", 2.5, step);
		closed_form("comes", 1, step);
	}
	for (int step = 0; step < 2; step++) {
		long_and_short("held", step, false);
		long_and_short("shaken", step, true);
	}
	goes_on_when_set(variant_of(changes_table, "held_2"), 145);
	region_of_time();
	for (int step = 0; step < 2; step++)
		only_told(step);
	return tap_end();
}
