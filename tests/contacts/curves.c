/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts and friction beside curves: a pendulum at a stop against elliptic integrals, where a spring that stiffens
 * turns and stays on ground that rubs by its energy; and that neither friction nor impacts add any. */
#include "caged.h"
#include "pendulum.h"
#include "pendulum_float.h"
#include "rubbed.h"
#include "rubbed_float.h"
#include "tap.h"

#include <math.h>

/* ---- the pendulum ---- */

/* Integral from 0 to `to` of 1/sqrt(1 - k^2 sin^2), by Simpson's rule: the integrand is smooth */
static double elliptic(double to, double k)
{
	enum { PARTS = 4000 };
	double sum = 0;
	for (int i = 0; i <= PARTS; i++) {
		const double s = k * sin(to * i / PARTS);
		sum += (i == 0 || i == PARTS ? 1 : i % 2 ? 4 : 2) / sqrt(1 - s * s);
	}
	return sum * to / (3 * PARTS);
}

/* x'' + w^2 sin x = 0 leaves a with the speed v downwards and is back: x = 2 asin(k sin u), k = sin(turning point/2) */
static double there_and_back(double w, double a, double v)
{
	const double k = sqrt(v * v / (4 * w * w) + sin(a / 2) * sin(a / 2));
	return 2 / w * (elliptic(acos(-1) / 2, k) + elliptic(asin(sin(a / 2) / k), k));
}

static double first_strike(double w, double a, double v)
{
	const double k = v / (2 * w);
	return elliptic(asin(sin(a / 2) / k), k) / w;
}

#define STRIKES_OF(model, MODEL, crossing_of) \
	static int strikes_of_##model(double *time, int most) \
	{ \
		static model s; \
		crossing_of crossing[MODEL##_MAX_EVENTS]; \
		int count = 0; \
		model##_init(&s); \
		for (int k = 0; k < 400 && count < most; k++) { \
			model##_step(&s); \
			const int here = model##_crossings(&s, crossing); \
			for (int i = 0; i < here && count < most; i++) \
				time[count++] = k * 0.1 + (double)crossing[i].time; \
		} \
		return model##_status(&s) ? -1 : count; \
	}
STRIKES_OF(pendulum, PENDULUM, pl_crossing)
STRIKES_OF(pendulum_float, PENDULUM_FLOAT, pl_crossingf)

enum { STRIKES = 15 };

static void compare_strikes(const char *name, int found, const double *time, double tolerance)
{
	const double w = 3, a = 0.4, e = 0.9;
	double due = first_strike(w, a, 2.4), v = sqrt(2.4 * 2.4 - 2 * w * w * (1 - cos(a))), worst = 0;
	for (int i = 0; i < found; i++) {
		worst = worse(worst, fabs(time[i] - due));
		v *= e;
		due += there_and_back(w, a, v);
	}
	ok(found == STRIKES && worst <= tolerance, "%s: %d strikes of %d, times off by %.3g s at most (%g)", name,
			found,
	   STRIKES, worst, tolerance);
}

static void pendulums(void)
{
	double time[STRIKES];
	int found = strikes_of_pendulum(time, STRIKES);
	compare_strikes("pendulum", found, time, 1e-12);
	found = strikes_of_pendulum_float(time, STRIKES);
	compare_strikes("pendulum, float", found, time, 2e-5);
}

/* ---- a spring that stiffens, on ground that rubs ---- */

/* (x0^2 - x1^2)/2 + (x0^4 - x1^4)/4 = F |x0 - x1| of turning points x0, x1: divided by x0 - x1 */
static double turning_point(double x0, double force)
{
	const double f = x0 > 0 ? force : -force;
	double near = x0, far = -x0;            /* between them it is */
	for (int i = 0; i < 200; i++) {
		const double x = (near + far) / 2;
		const double left = (x0 + x) / 2 + (x0 + x) * (x0 * x0 + x * x) / 4 - f;
		if ((left > 0) == (x0 > 0))
			near = x;
		else
			far = x;
	}
	return near;
}

static void rubs(void)
{
	const double force = 0.3;
	double stays = 2, y[2];
	float z[2];
	int turns = 0, found = 0;
	rubbed s;
	rubbed_float f;
	pl_crossing crossing[RUBBED_MAX_EVENTS];
	while (fabs(stays + stays * stays * stays) > force) {
		stays = turning_point(stays, force);
		turns++;
	}
	rubbed_init(&s);
	rubbed_float_init(&f);
	for (int k = 0; k < 400; k++) {
		rubbed_step(&s);
		rubbed_float_step(&f);
		const int here = rubbed_crossings(&s, crossing);
		for (int i = 0; i < here; i++)
			found += i == 0 || crossing[i].time - crossing[i - 1].time > 1e-6;
	}
	rubbed_get(&s, y);
	rubbed_float_get(&f, z);
	ok(found == turns, "rubbed: turns %d times of %d", found, turns);
	is_close(y[0], stays, 1e-11, "rubbed: stays at");
	ok(y[1] == 0, "rubbed: without velocity (%g)", y[1]);
	is_close((double)z[0], stays, 1e-5, "rubbed, float: stays at");
	const double there = y[0];
	for (int k = 0; k < 1000; k++)
		rubbed_step(&s);
	rubbed_get(&s, y);
	ok(y[0] == there && y[1] == 0 && rubbed_status(&s) == 0, "rubbed: to the last bit, for 100 s");
}

/* ---- energy ---- */

static double energy(const double *y)
{
	const double x = y[0], z = y[1], d = z - x;
	return y[2] * y[2] + y[3] * y[3] / 2 + x * x / 2 + x * x * x * x / 4 + z * z * z * z / 4 + 1.5 * d * d;
}

static void loses(void)
{
	caged s;
	double y[4], before, gained = 0, first;
	int knocks = 0;
	pl_crossing crossing[CAGED_MAX_EVENTS];
	caged_init(&s);
	caged_get(&s, y);
	first = before = energy(y);
	for (int k = 0; k < 2000; k++) {
		caged_step(&s);
		caged_get(&s, y);
		knocks += caged_crossings(&s, crossing);
		gained = worse(gained, energy(y) - before);
		before = energy(y);
	}
	ok(gained <= 1e-12 * first && knocks > 20 && before < first / 10 && caged_status(&s) == 0,
	   "caged: %d crossings, energy %g of %g, gains %.3g in a step at most", knocks, before, first, gained);
	ok(y[0] < 0.5 + 1e-12 && y[1] > -0.4 - 1e-12 && y[0] - y[1] < 0.6 + 1e-12, "caged: stays between its stops");
}

int main(void)
{
	pendulums();
	rubs();
	loses();
	return tap_end();
}
