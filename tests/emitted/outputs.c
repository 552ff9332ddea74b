/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs against their definitions, evaluated here from the states and from NAME_rhs: 1e-12 of the terms that they
 * are sums of. */
#include "quarter_car_pl.h"
#include "tap.h"
#include "tuned_floor_pl.h"
#include "two_waves_pl.h"

#include <math.h>

enum { STEPS = 3000 };

static double worst;

static bool is(double found, double expected, double terms, const char *what, int k)
{
	if (terms > 0)
		worst = worse(worst, fabs(found - expected) / terms);
	return close_to(found, expected, 1e-12 * terms, "%s, step %d", what, k);
}

static void tell(bool good, const char *name)
{
	note("%s: largest difference %.3g of the terms", name, worst);
	worst = 0;
	ok(good, "%s", name);
}

static void car(void)
{
	bool good = true;
	quarter_car s;
	quarter_car_init(&s);
	for (int k = 0; k <= STEPS; k++, quarter_car_step(&s)) {
		double y[4], out[5], slope[4];
		quarter_car_get(&s, y);
		quarter_car_out(&s, out);
		quarter_car_rhs(quarter_car_time(&s), y, slope);
		const double body = y[0], wheel = y[1], body_dot = y[2], wheel_dot = y[3];
		const double terms = (18000 * (fabs(body) + fabs(wheel))
				+ 1200 * (fabs(body_dot) + fabs(wheel_dot))) / 300;
		good = is(out[0], body, 0, "body", k) && good;
		good = is(out[1], wheel, 0, "wheel", k) && good;
		good = is(out[2], 1000 * (wheel - body), 1000 * (fabs(wheel) + fabs(body)), "travel_mm", k) && good;
		good = is(out[3], slope[2], terms, "comfort, from rhs", k) && good;
		good = is(out[3], (18000 * (wheel - body) + 1200 * (wheel_dot - body_dot)) / 300, terms, "comfort", k)
				&& good;
		good = is(out[4], 180000 * (0.05 - wheel), 180000 * (0.05 + fabs(wheel)), "tyre_force", k) && good;
		good = is(slope[0], body_dot, 0, "rhs of body", k) && good;
		good = is(slope[1], wheel_dot, 0, "rhs of wheel", k) && good;
		good = is(slope[3], (-18000 * (wheel - body) - 1200 * (wheel_dot - body_dot)
				+ 180000 * (0.05 - wheel)) / 40,
				  terms * 300 / 40 + 180000 * (0.05 + fabs(wheel)) / 40, "rhs of wheel'", k) && good;
	}
	tell(good, "quarter_car: travel, comfort and tyre force, and rhs");
}

static void floor_and_absorber(void)
{
	const double pi = 3.14159265358979323846, m = 20000, mu = 0.02, w0 = 4 * pi, wd = w0 / 1.02,
		zd = sqrt(3 * mu / (8 * 1.02 * 1.02 * 1.02));
	const double k0 = m * w0 * w0, c0 = 2 * 0.01 * w0 * m, kd = mu * m * wd * wd, cd = 2 * mu * m * wd * zd;
	bool good = true;
	tuned_floor s;
	tuned_floor_init(&s);
	for (int k = 0; k <= STEPS; k++, tuned_floor_step(&s)) {
		double y[4], out[3], slope[4];
		tuned_floor_get(&s, y);
		tuned_floor_out(&s, out);
		tuned_floor_rhs(tuned_floor_time(&s), y, slope);
		/* two turns a second: 100 steps are whole turns */
		const double force = 400 * sin(2 * pi * ((2 * k) % 100 / 100.0));
		const double relative = kd * (y[0] - y[1]) + cd * (y[2] - y[3]);
		const double terms = (400 + k0 * fabs(y[0]) + c0 * fabs(y[2]) + kd * (fabs(y[0]) + fabs(y[1])) +
			cd * (fabs(y[2]) + fabs(y[3]))) / m;
		good = is(out[0], 1000 * y[0], 1000 * fabs(y[0]), "floor_mm", k) && good;
		good = is(out[1], 1000 * (y[1] - y[0]), 1000 * (fabs(y[1]) + fabs(y[0])), "stroke_mm", k) && good;
		good = is(out[2], slope[2], terms, "acceleration, from rhs", k) && good;
		good = is(out[2], (force - k0 * y[0] - c0 * y[2] - relative) / m, terms, "acceleration", k) && good;
		good = is(slope[3], relative / (mu * m), terms / mu, "rhs of absorber'", k) && good;
	}
	tell(good, "tuned_floor: millimetres and acceleration, and rhs");
}

/* Each load keeps its own factor, whatever else it is part of; k steps are k/100 s. */
static void waves(void)
{
	bool good = true;
	two_waves s;
	two_waves_init(&s);
	for (int k = 0; k <= STEPS; k++, two_waves_step(&s)) {
		double y[2], out[2];
		two_waves_get(&s, y);
		two_waves_out(&s, out);
		const double slow = cos(3 * (k / 100.0)), fast = cos(5 * (k / 100.0));
		good = is(out[0], y[0] * slow, 1 + fabs(y[0]), "gated", k) && good;
		good = is(out[1], slow + 10 * fast, 11, "sum", k) && good;
	}
	tell(good, "two_waves: loads with a factor each");
}

int main(void)
{
	car();
	waves();
	floor_and_absorber();
	return tap_end();
}
