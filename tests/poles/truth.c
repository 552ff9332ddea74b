/* SPDX-License-Identifier: GPL-3.0-or-later */
/* y1 and y2 are sums of two exponentials and a constant on either side of the kink; what they push is linear, too.
 * Each next event is bracketed by small steps and then bisected. */
#include "truth.h"

#include <math.h>
#include <stdbool.h>

static const long double a = 3.5651205L, gravity = 9.81L, limit = 2, restitution = 0.8L;

/* ---- y1, y2 since a start ---- */

struct pair {
	long double level1, level2;     /* where they rest */
	long double pole[2], part[2], ratio[2]; /* y1 - level1 = sum of part e^{pole t}; y2's is ratio times it */
};

/* Below the kink, or above: y2' = a (5.5 - y2) - k (y1 - 3) */
static struct pair pair_from(long double L, bool above, long double y1, long double y2)
{
	const long double k = above ? 3 : 0, sum = L + a, product = L * (a + k);
	struct pair p;
	p.level2 = (5.5L * a + k * 2.6L) / (a + k);
	p.level1 = p.level2 + 0.4L;
	p.pole[1] = -(sum + sqrtl(sum * sum - 4 * product)) / 2;
	p.pole[0] = product / p.pole[1];
	p.ratio[0] = (p.pole[0] + L) / L;               /* of the slow one, by the first equation; */
	p.ratio[1] = -k / (p.pole[1] + a);              /* of the fast one, by the second: no sum that cancels */
	p.part[0] = (y2 - p.level2 - p.ratio[1] * (y1 - p.level1)) / (p.ratio[0] - p.ratio[1]);
	p.part[1] = y1 - p.level1 - p.part[0];
	return p;
}

/* ---- all of it since an event ---- */

struct motion {
	struct pair pair;
	bool above;
	int side;                       /* x slips so; 0: it sticks */
	long double from[TRUTH_STATES];
};

static long double drive(const struct motion *m, int which, long double t)
{
	return m->pair.part[which] * expl(m->pair.pole[which] * t);
}

static void slip(const struct motion *m, long double t, long double *x, long double *v)
{
	const long double level = (m->pair.level1 - limit * m->side) / 4;
	long double A = m->from[2] - level, B = m->from[4];
	*x = level;
	*v = 0;
	for (int i = 0; i < 2; i++) {
		const long double p = m->pair.pole[i], share = 1 / (p * p + 4);
		A -= m->pair.part[i] * share;
		B -= m->pair.part[i] * share * p;
		*x += drive(m, i, t) * share;
		*v += drive(m, i, t) * share * p;
	}
	*x += A * cosl(2 * t) + B / 2 * sinl(2 * t);
	*v += B * cosl(2 * t) - 2 * A * sinl(2 * t);
}

static void move(const struct motion *m, long double t, long double *y)
{
	const long double pull = m->pair.level1 - gravity;
	y[0] = m->pair.level1 + drive(m, 0, t) + drive(m, 1, t);
	y[1] = m->pair.level2 + m->pair.ratio[0] * drive(m, 0, t) + m->pair.ratio[1] * drive(m, 1, t);
	y[2] = m->from[2];
	y[4] = 0;
	if (m->side)
		slip(m, t, &y[2], &y[4]);
	y[3] = m->from[3] + m->from[5] * t + pull / 2 * t * t;
	y[5] = m->from[5] + pull * t;
	for (int i = 0; i < 2; i++) {
		const long double p = m->pair.pole[i], gone = m->pair.part[i] * expm1l(p * t) / p;
		y[5] += gone;
		y[3] += (gone - m->pair.part[i] * t) / p;
	}
}

/* ---- events ---- */

/* Rises through 0 where body 0, 1, 2 has its next event */
static long double beyond(const struct motion *m, int body, const long double *y)
{
	return body == 0 ? (m->above ? 3 - y[0] : y[0] - 3)
	     : body == 2 ? -y[3]
	     : m->side   ? -m->side * y[4]
			 : fabsl(y[0] - 4 * y[2]) - limit;
}

static long double bisect(const struct motion *m, int body, long double low, long double high)
{
	long double y[TRUTH_STATES];
	for (int i = 0; i < 80; i++) {
		const long double middle = (low + high) / 2;
		move(m, middle, y);
		*(beyond(m, body, y) > 0 ? &high : &low) = middle;
	}
	return high;
}

/* Before `end`, or that; *body -1: none */
static long double next_event(const struct motion *m, long double end, int *body)
{
	const long double stride = 1.0L / 1024;
	long double y[TRUTH_STATES], before[3] = { 1, 1, 1 };
	for (long double t = stride / 64; t < end + stride; t += stride) {
		const long double now = t < end ? t : end;
		long double first = now;
		*body = -1;
		move(m, now, y);
		for (int i = 0; i < 3; i++) {
			const long double g = beyond(m, i, y);
			if (before[i] <= 0 && g > 0) {
				const long double at = bisect(m, i, now - stride > 0 ? now - stride : 0, now);
				*body = at < first || *body < 0 ? i : *body;
				first = at < first ? at : first;
			}
			before[i] = g;
		}
		if (*body >= 0)
			return first;
	}
	return end;
}

static void pass(struct motion *m, int body)
{
	m->above = body == 0 ? !m->above : m->above;
	if (body == 1)
		m->side = m->side ? 0 : m->from[0] - 4 * m->from[2] > 0 ? 1 : -1;
	if (body == 2)
		m->from[5] *= -restitution;
}

struct truth truth_at(long double L, long double end)
{
	struct motion m = { .from = { 0, 0, 0, 1, 0, 0 } };
	struct truth truth = { .events = 0 };
	long double t = 0;
	int body;
	for (;;) {
		m.pair = pair_from(L, m.above, m.from[0], m.from[1]);
		const long double along = next_event(&m, end - t, &body);
		long double y[TRUTH_STATES];
		move(&m, along, y);
		for (int i = 0; i < TRUTH_STATES; i++)
			truth.y[i] = m.from[i] = y[i];
		t += along;
		if (body < 0 || truth.events == TRUTH_EVENTS)
			return truth;
		truth.event[truth.events].time = t;
		truth.event[truth.events++].body = body;
		pass(&m, body);
	}
}
