/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Contacts that are nearly none, and starts exactly on a breakpoint.
 *
 * graze: x = A sin t below the stop at b, so A = b (1 + p) goes p of the breakpoint's scale beyond it. */
#include "drive.h"
#include "grazing_variants.h"
#include "tap.h"

#include <math.h>

enum { SIZES = 5, PERIODS = 3, MOST = 2 * PERIODS + 10 };

/* Contacts at the speed v: x = b + v/w sin(w t) with w^2 = 1 + ks, about its own place of rest b/w^2: up to the
 * phase both parts are known */
static void graze(const char *name, double b, int step, double p)
{
	const struct variant *of = variant_of(grazing_table, "%s_%d", name, step);
	const double h = of->model->h, a = b * (1 + p), speed = b * sqrt(p * (2 + p));
	/* from leaving b to being back there: half a turn and what is beyond it */
	const double outside = acos(-1) + 2 * atan2(b, speed);
	const double from = asin(fmin(b / a, 1));
	/* inside: x = c + r cos(w s), c = 10/11 b, from x = b at the speed up to x = b again */
	const double w = sqrt(11), c = b - b / 11, inside = 2 * atan2(speed / w, b - c) / w, period = outside + inside;
	double y[2] = { 0, a }, time[MOST];
	pl_crossing crossing[MOST];
	struct run r = run_new(of);
	run_set(&r, y);
	/* what touches to rounding is watched at its first peak only: later on rounding has made it something else */
	const double end = ceil((fabs(p) < 1e-14 ? 2 : from + (PERIODS - 0.5) * period) / h) * h;
	const int count = run_crossings(&r, end, MOST, time, crossing), expected = p > 0 ? 2 * PERIODS : 0;
	bool good = close_to(count, expected, 0, "%s, h = %g, beyond by %g: crossings", name, h, p);
        /* at the root x is b to rounding; what rounding does to the state, in each step, moves it by that over the
		 * speed */
		for (int i = 0; i < count && i < expected; i++) {
			const double at = from + i / 2 * period + (i % 2 ? inside : 0),
						 off = (5e-15 + 1.2e-16 * end / h) * (1 + b / speed);
            good = close_to(time[i], at, off, "%s, h = %g, beyond by %g: crossing %d", name, h, p, i) && good;
            good = close_to(crossing[i].upward, i % 2 == 0, 0, "%s, h = %g, beyond by %g: direction of crossing %d",
							name, h, p, i) &&
				   good;
		}
	good = close_to(of->model->status(r.state), 0, 0, "status") && good;
	run_state(&r, y);
	/* energy: outside x'^2 + x^2 stays */
	const double in = y[0] > b ? y[0] - b : 0, energy = y[0] * y[0] + y[1] * y[1] + 10 * in * in;
	good = close_to(energy / (a * a), 1, 1e-13, "%s, h = %g, beyond by %g: energy", name, h, p) && good;
	ok(good, "%s, h = %g, beyond by %g: %d crossings", name, h, p, expected);
	run_free(&r);
}

/* x - a sin 2t = A sin t: the distance to the moving stop is that of the one at rest until the first crossing */
static void graze_moving(int step, double p)
{
	const struct variant *of = variant_of(grazing_table, "graze_moving_%d", step);
	const double h = of->model->h, a = 1 + p, quarter = acos(-1) / 2, reach = acos(1 / fmax(a, 1));
	double y[2] = { 0, a + 2 * 0.25 }, time[MOST];
	pl_crossing crossing[MOST];
	struct run r = run_new(of);
	run_set(&r, y);
	const int count = run_crossings(&r, ceil(4 / h) * h, MOST, time, crossing), expected = p > 0 ? 2 : 0;
	bool good = close_to(count, expected, 0, "moving, h = %g, beyond by %g: crossings", h, p);
	if (count && expected)
		good = close_to(time[0], quarter - reach, 1e-14 / sqrt(2 * p) + 1e-14,
			"moving, h = %g, beyond by %g: first crossing", h, p) && good;
	ok(good, "moving stop, h = %g, beyond by %g: %d crossings", h, p, expected);
	run_free(&r);
}

static void grazes(void)
{
	static const double beyond[] = { 1e-2, 1e-3,  1e-4, 1e-5,   1e-6,   1e-7,  1e-8,
                                     1e-9, 1e-10, 0,    -1e-16, -1e-10, -1e-6, -1e-2 };
	for (int step = 0; step < SIZES; step++)
		for (size_t i = 0; i < sizeof beyond / sizeof *beyond; i++) {
			graze("graze", 1, step, beyond[i]);
			graze("graze_large", 1000, step, beyond[i]);
			graze("graze_small", 0.001, step, beyond[i]);
			graze_moving(step, beyond[i]);
		}
}

/* x'' + x = 1 + f + j t outside, x'' + 11 x = 11 + f + j t inside; z = x - 1 from 0 at the speed v, while it stays
 * on its side */
static void start(const char *name, double v, double f, double j, int side)
{
	for (int step = 0; step < 2; step++) {
		const struct variant *of = variant_of(grazing_table, "%s_%d", name, step);
		const double w = side > 0 ? sqrt(11) : 1, t = 0.5;
		const double y[2] = { 1, v };
		double found[2];
		struct run r = run_new(of);
		run_set(&r, y);
		const int begun = of->region(r.state);
		bool good = close_to(begun, side > 0, 0, "%s, speed %g, h = %g: region", name, v, of->model->h);
		run_until(&r, t);
		run_state(&r, found);
		const double z = (f + j * t) / (w * w) - f / (w * w) * cos(w * t) + (v - j / (w * w)) / w * sin(w * t);
		good = close_to(found[0], 1 + z, 1e-14, "%s, speed %g, h = %g: x", name, v, of->model->h) && good;
                good = close_to((double)of->crossed(r.state), 0, 0, "%s, speed %g, h = %g: crossings", name, v,
								of->model->h) &&
					   good;
				ok(good, "%s, speed %g, h = %g: starts %s", name, v, of->model->h,
			side > 0 ? "in" : side < 0 ? "out" : "at rest, and stays");
		run_free(&r);
	}
}

int main(void)
{
	grazes();
	start("rest", 0.25, 0, 0, 1);
	start("rest", -0.25, 0, 0, -1);
	start("rest", 0, 0, 0, 0);
	start("rest_in", 0, 0.125, 0, 1);
	start("rest_out", 0, -0.125, 0, -1);
	start("rest_in", -0.25, 0.125, 0, -1);
	start("rest_jerk_in", 0, 0, 0.125, 1);
	start("rest_jerk_out", 0, 0, -0.125, -1);
	start("rest_jerk_in", 0.25, 0, 0.125, 1);
	return tap_end();
}
