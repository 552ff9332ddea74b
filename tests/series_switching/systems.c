/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "systems.h"
#include "quadrant.h"

#include <math.h>
#include <string.h>

int interval_of[MOST_EXPRESSIONS], after_change;

/* ---- equations: I(k) is the interval of expression k ---- */

#define I(k) (interval_of[k])
#define SIGN(k) (I(k) ? 1 : -1)
#define FIELD(name) static void name(real t, const real *y, const real *u, real *d)
#define EXPRESSIONS(name) static void name(real t, const real *y, real *e)
#define UNUSED (void)t, (void)u

FIELD(drag)
{
	UNUSED;
	d[0] = y[1];
	d[1] = -y[0] - 0.3L * SIGN(0) * y[1] * y[1];
}

FIELD(pushed_drag)
{
	UNUSED;
	d[0] = y[1];
	d[1] = cos_of(1.3L * t) - 0.1L * y[1] - y[0] - 0.2L * SIGN(0) * y[1] * y[1];
}

FIELD(odd_square)
{
	UNUSED;
	d[0] = y[1];
	d[1] = -SIGN(0) * y[0] * y[0];
}

FIELD(half_square)
{
	UNUSED;
	d[0] = y[1];
	d[1] = 0.5L * cos_of(2 * t) - y[0] - (I(0) ? 5 * (y[0] - 0.3L) * (y[0] - 0.3L) : 0);
}

FIELD(stop_cubic)
{
	UNUSED;
	d[0] = y[1];
	d[1] = 1.5L * cos_of(1.7L * t) - 0.1L * y[1] - y[0] - y[0] * y[0] * y[0] - (I(0) ? 50 * (y[0] - 0.5L) : 0);
}

FIELD(gap_cubic)
{
	UNUSED;
	d[0] = y[1];
	d[1] = 2 * cos_of(1.1L * t) - 0.05L * y[1] - y[0] * y[0] * y[0] -
		20 * (I(0) == 0 ? y[0] + 0.1L : I(0) == 2 ? y[0] - 0.2L : 0);
}

FIELD(two_gap)
{
	const real force = I(0) ? 0 : 30 * (y[0] - y[1] - 0.1L);
	UNUSED;
	d[0] = y[2];
	d[1] = y[3];
	d[2] = -sin_of(y[0]) - force;
	d[3] = -2 * y[1] - 0.1L * y[1] * y[1] * y[1] + force;
}

FIELD(clipped)
{
	UNUSED;
	d[0] = y[1];
	d[1] = cos_of(t) - y[0] * y[0] * y[0] - 0.5L * (I(0) == 0 ? -1 : I(0) == 2 ? 1 : 3 * y[1]);
}

FIELD(relaxing)
{
	UNUSED;
	d[0] = y[1];
	d[1] = (1 - y[0] * y[0]) * y[1] - y[0] - 10 * (I(0) ? 0 : y[0] + 1.5L);
}

FIELD(table_drag)
{
	const real force = I(0) == 0 ? 3 * y[0] : I(0) == 1 ? y[0] : 3 * y[0] - 2;
	UNUSED;
	d[0] = y[1];
	d[1] = 0.5L * cos_of(2 * t) - force - 0.2L * SIGN(1) * y[1] * y[1];
}

FIELD(jumping)
{
	UNUSED;
	d[0] = y[1];
	d[1] = 2 * cos_of(1.3L * t) - 0.1L * y[1] - y[0] - y[0] * y[0] * y[0] - 0.5L * SIGN(0);
}

FIELD(product)
{
	const real size = SIGN(0) * y[0] * y[1];
	UNUSED;
	d[0] = y[2];
	d[1] = y[3];
	d[2] = -y[0] - 0.5L * size * y[0];
	d[3] = -2 * y[1] - 0.5L * size * y[1];
}

FIELD(nested)
{
	UNUSED;
	d[0] = y[1];
	d[1] = 0.3L * cos_of(0.7L * t) - sin_of(y[0]) - (I(1) ? 4 * (y[0] - 0.5L * SIGN(0)) : 0);
}

FIELD(moving)
{
	UNUSED;
	d[0] = y[1];
	d[1] = cos_of(t) - y[0] * y[0] * y[0] - (I(0) ? 20 * (y[0] - 0.5L - 0.1L * sin_of(3 * t)) : 0);
}

FIELD(switched_load)
{
	UNUSED;
	d[0] = y[1];
	d[1] = (after_change ? 0.3L : 1.5L * cos_of(2 * t)) - y[0] - y[0] * y[0] * y[0] +
		(I(0) ? 0 : 20 * (-y[0] - 0.4L));
}

FIELD(circle)
{
	const real more = I(0) ? 3 * (y[0] * y[0] + y[1] * y[1] - 1) : 0;
	UNUSED;
	d[0] = y[2];
	d[1] = y[3];
	d[2] = -y[0] * (1 + more);
	d[3] = -y[1] * (2 + more);
}

FIELD(lagging)
{
	UNUSED;
	d[0] = cos_of(t) - SIGN(0) * y[0] * y[0];
}

FIELD(gated)
{
	UNUSED;
	d[0] = y[2];
	d[1] = y[3];
	d[2] = -y[0] - (I(0) && I(1) ? (y[0] - 0.2L) * (y[1] - 0.1L) : 0);
	d[3] = -2 * y[1] - 0.1L * y[1] * y[1] * y[1];
}

/* 0: x1 - x2, 1: x1 - 0.2, 2: x2 - 0.2 */
FIELD(largest)
{
	const real larger = I(0) ? y[0] : y[1], smaller = I(0) ? y[1] : y[0], most = I(I(0) ? 1 : 2) ? larger : 0.2L;
	UNUSED;
	d[0] = y[2];
	d[1] = y[3];
	d[2] = -y[0] - 0.5L * most * most;
	d[3] = -2.3L * y[1] + 0.2L * smaller;
}

FIELD(parametric)
{
	UNUSED;
	d[0] = y[1];
	d[1] = -(1 + (I(0) ? 0.5L * sin_of(3 * t) : 0)) * y[0] - 0.1L * y[0] * y[0] * y[0];
}

/* ---- expressions ---- */

FIELD(pressed)
{
	UNUSED;
	d[0] = y[1];
	d[1] = 3 * cos_of(2 * t) - 0.1L * y[1] - y[0] - y[0] * y[0] * y[0] -
		(I(0) ? 1e8L * (y[0] - 0.5L) + 2e4L * y[1] : 0);
}

FIELD(flipping)
{
	UNUSED;
	d[0] = y[1];
	d[1] = 1000 * (1 - SIGN(0) * y[0]) * y[1] - 1000 * y[0];
}

FIELD(braked)
{
	UNUSED;
	d[0] = y[1];
	d[1] = 5000 * cos_of(2 * t) - 1e4L * SIGN(0) * y[1] * y[1] - 5000 * y[0] - 100 * y[0] * y[0] * y[0];
}

EXPRESSIONS(of_position)       { (void)t; e[0] = y[0]; }
EXPRESSIONS(of_velocity)       { (void)t; e[0] = y[1]; }
EXPRESSIONS(of_both)           { (void)t; e[0] = y[0]; e[1] = y[1]; }
EXPRESSIONS(of_distance)       { (void)t; e[0] = y[1] - y[0]; }
EXPRESSIONS(of_product)        { (void)t; e[0] = y[0] * y[1]; }
EXPRESSIONS(of_size)           { (void)t; e[0] = y[0]; e[1] = I(0) ? y[0] : -y[0]; }
EXPRESSIONS(of_moving)         { e[0] = y[0] - 0.1L * sin_of(3 * t); }
EXPRESSIONS(of_radius)         { (void)t; e[0] = y[0] * y[0] + y[1] * y[1]; }
EXPRESSIONS(of_three)          { (void)t; e[0] = y[0] - y[1]; e[1] = y[0]; e[2] = y[1]; }
EXPRESSIONS(of_time)           { (void)y; e[0] = sin_of(3 * t); }

const struct switched_system switched_systems[] = {
	{"drag", 2, 1, {2}, drag, of_velocity, {1}, {{0}}, 0, 0},
	{"pushed_drag", 2, 1, {0.5L}, pushed_drag, of_velocity, {1}, {{0}}, 0, 0},
	{"odd_square", 2, 1, {1}, odd_square, of_position, {1}, {{0}}, 0, 0},
	{"half_square", 2, 1, {1}, half_square, of_position, {1}, {{0.3L}}, 0, 0},
	{"stop_cubic", 2, 1, {0.25L}, stop_cubic, of_position, {1}, {{0.5L}}, 0, 0},
	{"gap_cubic", 2, 1, {1.5L}, gap_cubic, of_position, {2}, {{-0.1L, 0.2L}}, 0, 0},
	{"two_gap", 4, 1, {1, -0.5L}, two_gap, of_distance, {1}, {{-0.1L}}, 0, 0},
	{"clipped", 2, 1, {1}, clipped, of_velocity, {2}, {{-1 / 3.0L, 1 / 3.0L}}, 0, 0},
	{"relaxing", 2, 1, {1}, relaxing, of_position, {1}, {{-1.5L}}, 0, 0},
	{"table_drag", 2, 2, {1.7L, 0}, table_drag, of_both, {2, 1}, {{0, 1}, {0}}, 0, 0},
	{"jumping", 2, 1, {1}, jumping, of_position, {1}, {{0.2L}}, 0, 0},
	{"product", 4, 1, {1, 0.5L}, product, of_product, {1}, {{0}}, 0, 0},
	{"nested", 2, 2, {1}, nested, of_size, {1, 1}, {{0}, {0.5L}}, 0, 0},
	{"moving", 2, 1, {0}, moving, of_moving, {1}, {{0.5L}}, 0, 0},
	{"switched_load", 2, 1, {1}, switched_load, of_position, {1}, {{-0.4L}}, 1.7L, 0},
	{"circle", 4, 1, {1, 0.25L, 0.5L, 1}, circle, of_radius, {1}, {{1}}, 0, 0},
	{"lagging", 1, 1, {0.5L}, lagging, of_position, {1}, {{0}}, 0, 0},
	{"gated", 4, 2, {1, 0.5L}, gated, of_both, {1, 1}, {{0.2L}, {0.1L}}, 0, 0},
	{"largest", 4, 3, {1, 0.5L}, largest, of_three, {1, 1, 1}, {{0}, {0.2L}, {0.2L}}, 0, 0},
	{"parametric", 2, 1, {1}, parametric, of_time, {1}, {{0}}, 0, 0},
};
const int switched_count = sizeof switched_systems / sizeof *switched_systems;

const struct switched_system switched_stiff[] = {
	{"pressed", 2, 1, {0.4L}, pressed, of_position, {1}, {{0.5L}}, 0, 1 / 8192.0L},
	{"flipping", 2, 1, {2}, flipping, of_position, {1}, {{0}}, 0, 1 / 2048.0L},
	{"braked", 2, 1, {0.9L}, braked, of_velocity, {1}, {{0}}, 0, 1 / 8192.0L},
};
const int switched_stiff_count = sizeof switched_stiff / sizeof *switched_stiff;

/* ---- from crossing to crossing ---- */

/* How far the first expression that leaves its interval is beyond it, at most; which, and where it goes */
static real beyond(const struct switched_system *s, real t, const real *y, int but, int *which, int *way)
{
	real e[MOST_EXPRESSIONS], most = -1e9L;
	s->e(t, y, e);
	for (int i = 0; i < s->expressions; i++)
		for (int up = 0; up < 2; up++) {
			const int b = interval_of[i] - !up;
			if (b < 0 || b == s->breaks[i] || but == 4 * i + b)
				continue;
			const real off = (up ? 1 : -1) * (e[i] - s->at[i][b]);
			if (off > most) {
				most = off;
				*which = i;
				*way = up ? 1 : -1;
			}
		}
	return most;
}

void place_switched(const struct switched_system *s, real t, const real *y)
{
	for (int again = 0; again < MOST_EXPRESSIONS; again++) {
		real e[MOST_EXPRESSIONS];
		s->e(t, y, e);
		for (int i = 0; i < s->expressions; i++)
			for (int k = interval_of[i] = 0; k < s->breaks[i]; k++)
				interval_of[i] += e[i] > s->at[i][k];
	}
}

/* To the first crossing of a piece in which there is one: by halving its length; the state there, just behind */
static real cut(const struct switched_system *s, real from, real to, int but, real *y, int *which, int *way)
{
	real low = 0, high = to - from, end[HAND_MOST];
	for (int k = 0; k < 70; k++) {
		const real middle = (low + high) / 2;
		memcpy(end, y, sizeof(real) * MOST_OF_STATES);
		gragg(s->f, s->states, from, from + middle, 1, 0, NULL, end);
		if (beyond(s, from + middle, end, but, which, way) > 0)
			high = middle;
		else
			low = middle;
	}
	gragg(s->f, s->states, from, from + high, 1, 0, NULL, y);
	(void)beyond(s, from + high, y, but, which, way);
	return from + high;
}

int follow_switched(const struct switched_system *s, real from, real to, real *y, real *crossed, int room)
{
	const real piece = s->piece > 0 ? s->piece : 1 / 64.0L;
	static int last = -1;                   /* which breakpoint was passed at `from` */
	int count = 0, which, way;
	if (s->change > 0 && from < s->change && to > s->change) {
		count = follow_switched(s, from, s->change, y, crossed, room);
		after_change = 1;
		return count + follow_switched(s, s->change, to, y, crossed + count, room - count);
	}
	after_change = s->change > 0 && from >= s->change;
	for (real t = from; t < to;) {
		const real end = to - t < piece * 1.01L ? to : t + piece;
		real next[HAND_MOST] = {0};
		memcpy(next, y, sizeof(real) * MOST_OF_STATES);
		gragg(s->f, s->states, t, end, 1, 0, NULL, next);
		if (beyond(s, end, next, last, &which, &way) <= 0) {
			memcpy(y, next, sizeof(real) * MOST_OF_STATES);
			t = end;
			last = -1;
			continue;
		}
		t = cut(s, t, end, last, y, &which, &way);
		if (count < room)
			crossed[count] = t;
		count++;
		last = 4 * which + interval_of[which] - (way < 0);
		interval_of[which] += way;
	}
	return count;
}
