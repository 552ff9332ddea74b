/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts against closed forms: a ball until it rests, an oscillator that strikes once a period, a ball on a shaken
 * table, balls that touch, a stop that is touched within a step; and that no impact adds energy. */
#include "bouncing_ball.h"
#include "clatter.h"
#include "cradle.h"
#include "coarse.h"
#include "hung_radau_0.h"
#include "hung_radau_1.h"
#include "hung_radau_half.h"
#include "hung_taylor_0.h"
#include "hung_taylor_1.h"
#include "hung_taylor_half.h"
#include "impact_oscillator.h"
#include "shaken_table.h"
#include "strung.h"
#include "strung_together.h"
#include "tap.h"
#include "touched.h"

#include <math.h>

/* ---- the ball: bounce n at t0 (1 + 2 (e + ... + e^n)), t0 = sqrt(2 drop/g), rest at t0 (1 + e)/(1 - e) ---- */

static void bounces(void)
{
	const double e = 0.8, t0 = sqrt(2 / 9.81);
	bouncing_ball s;
	pl_crossing crossing[BOUNCING_BALL_MAX_EVENTS];
	double due = t0, flight = 2 * t0, worst = 0, last = 0, y[2];
	int count = 0;
	bouncing_ball_init(&s);
	for (int k = 0; k < 500; k++) {
		bouncing_ball_step(&s);
		const int here = bouncing_ball_crossings(&s, crossing);
		for (int i = 0; i < here; i++) {
			last = k * BOUNCING_BALL_H + crossing[i].time;
			if (flight > 1e-7) {
				worst = worse(worst, fabs(last - due));
				flight *= e;
				due += flight;
				count++;
			}
		}
	}
	ok(worst <= 2e-13 && count > 60, "ball: %d bounces, times off by %.3g s at most", count, worst);
	is_close(last, t0 * (1 + e) / (1 - e), 1e-12, "ball: rests [s]");
	bouncing_ball_get(&s, y);
	ok(y[0] == 0 && y[1] == 0, "ball: rests at 0, velocity 0 (%g, %g)", y[0], y[1]);
	is_close(bouncing_ball_status(&s), 0, 0, "ball: status");
	is_close((double)bouncing_ball_rested(&s), 1, 0, "ball: contacts that came to rest");
}

/* ---- x'' + x = cos(w t), stop at 0: one impact in each period T = 2 pi/w. With time from an impact, load
 * cos(w t + p): x = A (cos t + tan(T/2) sin t) - A/cos p cos(w t + p), A = -cos p/(1 - w^2),
 * tan p = -tan(T/2)/w (1 - e)/(1 + e). It is what the motion from rest goes to. ---- */

static void oscillator(void)
{
	const double w = 2.2, e = 0.7, T = 2 * 3.14159265358979323846 / w, C = 1 / (1 - w * w);
	double phase = atan(-tan(T / 2) / w * (1 - e) / (1 + e)), worst = 0, y[2];
	double A = -C * cos(phase);
	if (A * tan(T / 2) - C * w * sin(phase) > 0) { /* away from the stop */
		phase += 3.14159265358979323846;
		A = -A;
	}
	impact_oscillator s;
	impact_oscillator_init(&s);
	for (int k = 0; k < 100000; k++)
		impact_oscillator_step(&s);
	for (int k = 0; k < 1000; k++) {
		impact_oscillator_step(&s);
		impact_oscillator_get(&s, y);
		const double t = fmod(impact_oscillator_time(&s) - phase / w + 4 * T, T);
		if (t < 1e-9 || T - t < 1e-9)
			continue;
		worst = worse(worst, fabs(y[0] - A * (cos(t) + tan(T / 2) * sin(t)) - C * cos(w * t + phase)));
		worst = worse(worst,
			      fabs(y[1] - A * (tan(T / 2) * cos(t) - sin(t)) + C * w * sin(w * t + phase)));
	}
	ok(worst <= 1e-11, "oscillator: the orbit with one impact a period, off by %.3g at most", worst);
}

/* Pressed onto the stop until t0 = pi/(2 w), in the middle of a step; then x = C (cos(w t) + w sin(t - t0)). What lets
 * go has no acceleration yet. */
static void pressed(void)
{
	const double w = 2.2, C = 1 / (1 - w * w), t0 = 3.14159265358979323846 / 2 / w;
	double worst = 0, y[2];
	coarse s;
	coarse_init(&s);
	for (int k = 1; k <= 30; k++) {
		coarse_step(&s);
		coarse_get(&s, y);
		const double t = coarse_time(&s);
		worst = worse(worst, fabs(y[0] - (t > t0 ? C * (cos(w * t) + w * sin(t - t0)) : 0)));
		worst = worse(worst, fabs(y[1] - (t > t0 ? C * w * (cos(t - t0) - sin(w * t)) : 0)));
	}
	ok(worst <= 1e-13, "oscillator: pressed, then let go, off by %.3g at most", worst);
	ok(coarse_status(&s) == 0, "oscillator: status 0, found %d", coarse_status(&s));
}

/* ---- the table b sin(w t): the ball leaves where b w^2 sin(w t) = g, and lands where its parabola meets it ---- */

static long double above(long double leaves, long double t)
{
	const long double b = 0.005L, w = 60, d = t - leaves;
	return b * sinl(w * leaves) + b * w * cosl(w * leaves) * d - 9.81L / 2 * d * d - b * sinl(w * t);
}

static long double lands(long double leaves)
{
	long double low = leaves + 1e-3L, high = low;
	while (above(leaves, high) > 0)
		high += 1e-4L;
	for (int i = 0; i < 80; i++) {
		const long double middle = (low + high) / 2;
		*(above(leaves, middle) > 0 ? &low : &high) = middle;
	}
	return low;
}

static void table(void)
{
	const long double w = 60, turn = 2 * 3.14159265358979323846264338L / w;
	const long double first = asinl(9.81L / 0.005L / w / w) / w;
	shaken_table s;
	pl_crossing crossing[SHAKEN_TABLE_MAX_EVENTS];
	long double due = first;
	double worst = 0, most = 0, out[SHAKEN_TABLE_OUTPUTS];
	int count = 0, flies = 0;
	shaken_table_init(&s);
	for (int k = 0; k < 400; k++) {
		shaken_table_step(&s);
		const int here = shaken_table_crossings(&s, crossing);
		for (int i = 0; i < here; i++) {
			const double time = k * SHAKEN_TABLE_H + crossing[i].time;
			if (flies && time - (double)due < -1e-6)
				continue;
			if (fabs(time - (double)due) > 1e-6)
				continue;
			worst = worse(worst, fabs(time - (double)due));
			count++;
			if (!flies) {
				due = lands(due);
			} else {
				long double next = first;
				while (next < due)
					next += turn;
				due = next;
			}
			flies = !flies;
		}
		shaken_table_out(&s, out);
		most = worse(most, -out[1]);
	}
	ok(worst <= 1e-12 && count > 60, "table: leaves and lands, %d times, off by %.3g s at most", count, worst);
	ok(most <= 1e-17, "table: never below it (%g)", most);
}

static void cradle_of_three(void)
{
	cradle s;
	double y[6];
	cradle_init(&s);
	for (int k = 0; k < 10; k++)
		cradle_step(&s);
	cradle_get(&s, y);
	const double expected[6] = { 0, 0, 2, 0, 0, 1 };
	bool good = true;
	for (int i = 0; i < 6; i++)
		good = close_to(y[i], expected[i], 1e-14, "cradle: state %d at 3 s", i) && good;
	ok(good, "cradle: at 3 s");
}

/* ---- Newton's cradle: -0.1 cos(w t) is the first ball's place where it is below 0, the last one's where it is above,
 * and the others hang still; with less restitution all of them swing together sooner or later ---- */

static void cradle_on_strings(const pl_model *m, double together, double tolerance)
{
	static double s[1 << 14];
	const double w = sqrt(9.81);
	const int n = m->states / 2;
	double apart = 0, y[40];
	if (m->size > sizeof s && !ok(false, "%s: %zu bytes", m->name, m->size))
		return;
	m->init(s);
	for (int k = 1; k <= 10000; k++) {
		const double t = k * m->h, place = -0.1 * cos(w * t);
		m->step(s, NULL);
		m->get(s, y);
		for (int i = 0; i < n && (together > 10 || t > together); i++)
			apart = worse(apart, fabs(y[i] - (t > together ? place / n : i == 0 ? fmin(place, 0) :
			    i == n - 1 ? fmax(place, 0) : 0)));
	}
	ok(apart <= tolerance && m->status(s) == 0, "%s: on strings for 100 s: off by %.3g, tolerance %.3g, status %d",
	   m->name, apart, tolerance, m->status(s));
}

static void cradles(void)
{
	cradle_on_strings(&strung_model, 1000, 1e-13);
	cradle_on_strings(&strung_together_model, 0.6, 1e-13);
	cradle_on_strings(&hung_taylor_1_model, 1000, 1e-10);
	cradle_on_strings(&hung_taylor_half_model, 9.9, 1e-10);
	cradle_on_strings(&hung_taylor_0_model, 0.6, 1e-10);
	cradle_on_strings(&hung_radau_1_model, 1000, 1e-10);
	cradle_on_strings(&hung_radau_half_model, 9.9, 1e-10);
	cradle_on_strings(&hung_radau_0_model, 0.6, 1e-10);
}

static void energy(void)
{
	clatter s;
	double out[1], before = 1e9, grown = 0;
	uint64_t struck;
	clatter_init(&s);
	for (int k = 0; k < 20000; k++) {
		clatter_step(&s);
		clatter_out(&s, out);
		grown = worse(grown, out[0] - before);
		before = out[0];
	}
	struck = clatter_crossed(&s);
	ok(grown <= 1e-15, "clatter: energy grows by %.3g at most", grown);
	ok(struck > 40, "clatter: %d impacts", (int)struck);
	is_close(clatter_status(&s), 0, 0, "clatter: status");
}

/* ---- x'' + x = cos(2 t) between stops at 1 and -1: what is farthest in the middle of a step is nowhere near the line
 * between its ends. There spring and load bend its way by as much each. ---- */

struct motion { long double x, v; };

static struct motion swung(struct motion from, long double t, long double d)
{
	const long double a = from.x + cosl(2 * t) / 3, b = from.v - 2 * sinl(2 * t) / 3, then = 2 * (t + d);
	return (struct motion){ a * cosl(d) + b * sinl(d) - cosl(then) / 3, b * cosl(d) - a * sinl(d) +
				2 * sinl(then) / 3 };
}

/* A step from `from`, from 0.5 of its speed on where it strikes before the middle of it */
static struct motion struck(struct motion from, long double t, int side, bool strikes)
{
	const long double h = (long double)TOUCHED_H;
	long double low = 0, high = h / 2;
	for (int i = 0; i < 80 && strikes; i++) {
		const long double middle = (low + high) / 2;
		*(side * swung(from, t, middle).x > 1 ? &high : &low) = middle;
	}
	struct motion at = swung(from, t, low);
	return strikes ? swung((struct motion){ at.x, -at.v / 2 }, t + low, h - low) : swung(from, t, h);
}

static void touches(void)
{
	const long double h = (long double)TOUCHED_H, quarter = 3.14159265358979323846264338L / 2;
	double worst = 0, y[2];
	pl_crossing crossing[TOUCHED_MAX_EVENTS];
	int strikes = 0, wrong = 0;
	for (int k = 0; k < 80; k++) {
		const int side = k % 2 ? 1 : -1;
		const long double over = (k / 2 - 19.5L) / 20 * h * h / 4, top = side > 0 ? quarter : 2 * quarter;
		touched s;
		struct motion from = swung((struct motion){ side * (1 + over), 0 }, top, -h / 2), to;
		touched_set(&s, (double)(top - h / 2), (double[]){ (double)from.x, (double)from.v });
		touched_step(&s);
		touched_get(&s, y);
		to = struck(from, top - h / 2, side, over > 0);
		worst = worse(worst, fmax(fabs(y[0] - (double)to.x), fabs(y[1] - (double)to.v)));
		strikes += over > 0;
		wrong += touched_crossings(&s, crossing) != (over > 0);
	}
	ok(worst <= 1e-13 && wrong == 0, "touched: struck in %d steps of 80, off by %.3g, wrong %d times", strikes,
	   worst, wrong);
}

int main(void)
{
	touches();
	bounces();
	oscillator();
	pressed();
	table();
	cradle_of_three();
	cradles();
	energy();
	return tap_end();
}
