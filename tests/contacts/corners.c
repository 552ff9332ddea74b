/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Where random scenes seldom get: jumps that read what nothing else reads, several impacts at one instant, more
 * impacts in a step than there is room for, forces that are just what friction can hold. */
#include "at_limit.h"
#include "at_limit_float.h"
#include "counted.h"
#include "four_balls.h"
#include "high_ball.h"
#include "landed.h"
#include "landed_series.h"
#include "late_ball.h"
#include "late_series.h"
#include "lively_ball.h"
#include "slopes.h"
#include "thrown.h"
#include "tight.h"
#include "wall.h"
#include "tap.h"
#include "worse.h"

#include <math.h>

/* ---- y and z are what the jumps make of them; x' goes up by 1 each second, from 0.7 back to 0.2 ---- */

static double sample(int step)
{
	return 1 + step % 7;
}

static void counted_jumps(void)
{
	const double h = COUNTED_H, end = 5;
	double y = 0, z = 0, found[COUNTED_STATES], next = 0.3;
	counted s;
	bool low = true;
	int jumps = 0;
	for (; next < end; jumps++, low = !low)
		if (low) {
			y = 2 * y + 1 + 3 * cos(5 * next);
			z += sample((int)(next / h + 1e-9));
			next += 0.4;
		} else {
			const double before = y;
			y = z;
			z = before + next;
			next += 0.1;
		}
	counted_init(&s);
	for (int k = 0; k * h < end; k++)
		counted_step(&s, (double[]){ sample(k) });
	counted_get(&s, found);
	is_close(found[1], y, 1e-11 * fabs(y), "counted: y after %d jumps", jumps);
	is_close(found[2], z, 1e-11 * fabs(z), "counted: z after %d jumps", jumps);
}

/* ---- what a jump or an input takes out of its interval moves by what acts where it then is ---- */

static void out_of_intervals(void)
{
	thrown s;
	double y[6], off;
	thrown_init(&s);
	for (int k = 0; k < 5; k++) {
		thrown_step(&s, (double[]){ k < 4 ? 0 : 1 });
		thrown_get(&s, y);
		if (k == 1)
			is_close(y[1], 1 + cos(0.6), 1e-14, "thrown: y in its stop, 0.2 s behind the jump");
	}
	off = 8 / 9.0 * (1 - cos(0.75));
	is_close(y[2], off, 1e-14, "thrown: z, a step behind the input's jump");
	is_close(thrown_status(&s), 0, 0, "thrown: status");
}

/* ---- balls: in the order of statements, again from the first after each impact ---- */

struct pair {
	int a, b;
	double e;
};

static void balls(void)
{
	static const struct pair pair[3] = { { 1, 2, 0.6 }, { 0, 1, 0.5 }, { 2, 3, 0.7 } };
	static const double mass[4] = { 1, 2, 1.5, 3 };
	double v[4] = { 1, 0, 0, -1 }, y[FOUR_BALLS_STATES];
	bool good = true;
	int impacts = 0;
	for (int k = 0; k < 3; k++) {
		const struct pair *p = &pair[k];
		const double closing = v[p->a] - v[p->b];
		if (closing < 1e-14)
			continue;
		const double push = (1 + p->e) * closing / (1 / mass[p->a] + 1 / mass[p->b]);
		v[p->a] -= push / mass[p->a];
		v[p->b] += push / mass[p->b];
		impacts++;
		k = -1;
	}
	four_balls s;
	four_balls_init(&s);
	for (int k = 0; k < 5; k++)
		four_balls_step(&s);
	four_balls_get(&s, y);
	for (int i = 0; i < 4; i++) {
		good = close_to(y[4 + i], v[i], 1e-13, "four balls: velocity %d", i) && good;
		good = close_to(y[i], v[i], 1e-13, "four balls: place %d, a second after", i) && good;
	}
	ok(good && impacts > 4, "four balls: struck from both sides, %d impacts", impacts);
	is_close((double)four_balls_crossed(&s), impacts, 0, "four balls: impacts counted");
}

/* ---- a ball: bounce n at t0 (1 + 2 (e + ... + e^n)), t0 = sqrt(2 drop/g), rest at t0 (1 + e)/(1 - e). What rounding
 * does to the place at a step's end, 1e-13, is more than that in time for what is slow. ---- */

static void high(void)
{
	const double e = 0.8, t0 = sqrt(2 / 9.81);
	double due = t0, flight = 2 * t0, worst = 0, last = 0, y[2];
	pl_crossing crossing[HIGH_BALL_MAX_EVENTS];
	int count = 0, down = 0;
	high_ball s;
	high_ball_init(&s);
	for (int k = 0; k < 500; k++) {
		high_ball_step(&s);
		const int here = high_ball_crossings(&s, crossing);
		for (int i = 0; i < here; i++, count++) {
			last = k * HIGH_BALL_H + crossing[i].time;
			down += crossing[i].breakpoint == 1 && !crossing[i].upward;
			if (flight > 1e-8)
				worst = worse(worst, fabs(last - due));
			flight *= e;
			due += flight;
		}
	}
	ok(worst <= 1e-9 && flight < 1e-8, "high ball: %d bounces, times off by %.3g s at most", count, worst);
	ok(down == count, "high ball: all come down to the upper of its two breakpoints (%d of %d)", down, count);
	is_close(last, t0 * (1 + e) / (1 - e), 1e-9, "high ball: rests [s]");
	high_ball_get(&s, y);
	ok(y[0] == 1000 && y[1] == 0, "high ball: rests at 1000, velocity 0 (%.17g, %g)", y[0], y[1]);
}

/* ---- more bounces than the list has room for, and it rests behind them ---- */

static void lively(void)
{
	double y[2];
	lively_ball s;
	lively_ball_init(&s);
	lively_ball_step(&s);
	lively_ball_get(&s, y);
	ok(y[0] == 0 && y[1] == 0, "lively ball: rests at 0 (%g, %g)", y[0], y[1]);
	is_close(lively_ball_rested(&s), 1, 0, "lively ball: contacts that came to rest");
	is_close(lively_ball_status(&s), 0, 0, "lively ball: status");
}

/* ---- a list that is all but full lays down what ends within 2^-10 h alone: 0.2 s of bounces are left, and 0.1 s
 * later the ball is at the top of the first of them, 0.002^2/(2 0.02) high ---- */

static void late(void)
{
	double y[4];
	late_ball s;
	late_series by_series;
	pl_crossing crossing[LATE_BALL_MAX_EVENTS];
	late_ball_init(&s);
	late_ball_step(&s);
	late_ball_get(&s, y);
	const int listed = late_ball_crossings(&s, crossing);
	ok(listed > LATE_BALL_MAX_EVENTS - 4 && listed <= LATE_BALL_MAX_EVENTS, "late ball: %d crossings of %d", listed,
	   LATE_BALL_MAX_EVENTS);
	is_close(y[0], 1e-4, 1e-15, "late ball: at the top of a bounce");
	late_series_init(&by_series);
	late_series_step(&by_series);
	late_series_get(&by_series, y);
	is_close(y[0], 1e-4, 1e-12, "late ball: at the top of a bounce, by series");
	is_close(late_ball_status(&s) + late_series_status(&by_series), 0, 0, "late ball: status");
}

/* ---- too many: time is lost, but neither speed nor place ---- */

static void too_many(void)
{
	tight s;
	double y[2], worst = 0, most = 0;
	tight_init(&s);
	for (int k = 0; k < 50; k++) {
		tight_step(&s);
		tight_get(&s, y);
		worst = worse(worst, fabs(fabs(y[1]) - 1));
		most = worse(most, fabs(y[0]) - 0.001);
	}
	is_close(tight_status(&s), PL_TOO_MANY_EVENTS, 0, "tight: status");
	ok(worst <= 1e-14 && most <= 1e-17, "tight: energy off by %.3g, outside by %.3g at most", worst, most);
}

/* ---- each impact on the ball leaves half of the speed, and the wall takes what the ball has ---- */

static void dead_wall(void)
{
	wall s;
	double y[4], worst = 0;
	wall_init(&s);
	for (int k = 0; k < 10; k++)
		wall_step(&s);
	wall_get(&s, y);
	for (int i = 0; i < 4; i++)
		worst = worse(worst, fabs(y[i]));
	ok(worst <= 1e-15, "wall: all of it rests there (%g)", worst);
	is_close(wall_status(&s), 0, 0, "wall: status");
	is_close(wall_rested(&s), 2, 0, "wall: contacts that came to rest");
}

/* ---- forces at their limit ---- */

static void limits(void)
{
	at_limit s;
	at_limit_float f;
	double y[6], worst = 0;
	float z[6];
	at_limit_init(&s);
	at_limit_float_init(&f);
	for (int k = 0; k < 20000; k++) {
		at_limit_step(&s);
		at_limit_float_step(&f);
	}
	at_limit_get(&s, y);
	at_limit_float_get(&f, z);
	for (int i = 0; i < 6; i++)
		worst = worse(worst, fabs(y[i]));
	ok(worst <= 1e-15, "at the limit: nothing moves (%g)", worst);
	is_close(at_limit_status(&s), 0, 0, "at the limit: status");
	worst = 0;
	for (int i = 0; i < 6; i++)
		worst = worse(worst, (double)fabsf(z[i]));
	ok(worst <= 2e-8, "at the limit, in float: what rounding lets go comes no further than %.3g", worst);
	is_close(at_limit_float_status(&f), 0, 0, "at the limit, in float: status");
}

static void on_slopes(void)
{
	slopes s;
	double y[6];
	slopes_init(&s);
	for (int k = 0; k < 200; k++)
		slopes_step(&s);
	slopes_get(&s, y);
	is_close(y[0], 10, 1e-12, "slopes: slides on");
	ok(y[1] == 0 && y[4] == 0, "slopes: stays (%g, %g)", y[1], y[4]);
	is_close(y[2], -0.0625, 1e-15, "slopes: comes to rest");
	is_close(slopes_status(&s), 0, 0, "slopes: status");
}

/* ---- what rests on a breakpoint counts as below it, for conditions on the same expression too ---- */

static void landed_block(const char *name, const double *y)
{
	const double lies = 3 * sqrt(20 / 9.81), part = 3e-9;  /* what is left of the bouncing, up to 2^-23 h, is cut */
	is_close(y[2], lies, part, "%s: in the air until it lies", name);
	is_close(y[3], lies - (12 - lies), 2 * part, "%s: sgn is -1 where it lies", name);
	is_close(y[1], 5 * lies + 12.5, 5 * part, "%s: it slides to its stop", name);
	is_close(y[0], 0, 0, "%s: it lies on the ground", name);
}

static void landings(void)
{
	landed s;
	landed_series c;
	double y[LANDED_STATES];
	landed_init(&s);
	landed_series_init(&c);
	for (int k = 0; k < 1200; k++) {
		landed_step(&s);
		landed_series_step(&c);
	}
	landed_get(&s, y);
	landed_block("landed", y);
	landed_series_get(&c, y);
	landed_block("landed, by series", y);
}

/* ---- a search that overlooks what comes, which the linker puts in the place of pl_events_next ---- */

static bool overlooks;
double __real_pl_events_next(const pl_events *m, pl_instant *at, double *size, int *splits);
double __wrap_pl_events_next(const pl_events *m, pl_instant *at, double *size, int *splits);

double __wrap_pl_events_next(const pl_events *m, pl_instant *at, double *size, int *splits)
{
	return overlooks ? -1 : __real_pl_events_next(m, at, size, splits);
}

/* Status behind 1200 steps, and how deep it has been below the ground at the end of one */
static int falls(double *depth)
{
	double y[LANDED_STATES];
	landed_series s;
	landed_series_init(&s);
	*depth = 0;
	for (int k = 0; k < 1200; k++) {
		landed_series_step(&s);
		landed_series_get(&s, y);
		*depth = fmax(*depth, -y[0]);
	}
	return landed_series_status(&s);
}

static void penetrations(void)
{
	double depth;
	int status = falls(&depth);
	ok(status == 0 && depth <= 1e-15, "a stop is kept: status %d, %g deep", status, depth);
	overlooks = true;
	status = falls(&depth);
	overlooks = false;
	ok(status == PL_PENETRATED && depth > 1e-3, "a stop is penetrated: status %d, %g deep", status, depth);
}

int main(void)
{
	penetrations();
	counted_jumps();
	out_of_intervals();
	balls();
	too_many();
	dead_wall();
	high();
	lively();
	late();
	limits();
	on_slopes();
	landings();
	return tap_end();
}
