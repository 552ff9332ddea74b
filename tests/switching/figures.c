/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Values that do not depend on the step: of the gears, to ten digits and by hand; of a bilinear oscillator and of a
 * mass against a stop, in closed form. */
#include "drive.h"
#include "figures_variants.h"
#include "hand.h"
#include "tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* deadzone(x, -b, b) is two stops. */
static struct hand_system gear1(real eta)
{
	return (struct hand_system){ .n = 1, .stops = 2, .C = { { 0.1L } }, .f0 = { 0.1L }, .fa = { 0.05L }, .w = eta,
		.start = { 1.1L },
		.stop = { { { 1 }, { 1 }, 1, 0, 1, 0, 0 }, { { -1 }, { -1 }, 1, 0, 1, 0, 0 } } };
}

static struct hand_system gear2(void)
{
	return (struct hand_system){ .n = 2, .stops = 2, .K = { { 0, -0.5L }, { 0, 1 } },
		.C = { { 0.1L, -0.05L }, { -0.05L, 0.1L } },
		.f0 = { 0.1L, 0.05L }, .fa = { 0.05L, 0 }, .w = 0.8L, .start = { 1.2L, 0.1L },
		.stop = { { { 1, 0 }, { 1, -0.5L }, 1, 0, 1, 0, 0 }, { { -1, 0 }, { -1, 0.5L }, 1, 0, 1, 0, 0 } } };
}

static const real m3[3] = { 1, 0.5L, 2 };

static void add_stop3(struct hand_system *s, int a, real side, real k, real gap)
{
	struct hand_stop *p = &s->stop[s->stops++];
	p->row[a] = side;
	p->row[a + 1] = -side;
	p->push[a] = side / m3[a];
	p->push[a + 1] = -side / m3[a + 1];
	p->k = k;
	p->gap = gap;
}

static struct hand_system gear3(void)
{
	struct hand_system s = { .n = 3, .start = { 0.03L, 0, -0.03L }, .w = 7, .fa = { 0.8L }, .f0 = { 1, 0, -0.5L } };
	const real c1 = 0.4L, c2 = 0.3L, C[3][3] = { { c1, -c1, 0 }, { -c1, c1 + c2, -c2 }, { 0, -c2, c2 } };
	for (int i = 0; i < 3; i++)
		for (int j = 0; j < 3; j++)
			s.C[i][j] = C[i][j] / m3[i];
	for (int side = -1; side <= 1; side += 2) {
		add_stop3(&s, 0, side, 100, 0.01L);
		add_stop3(&s, 1, side, 80, 0.02L);
	}
	return s;
}

struct gear {
	const char *name;
	double seconds, value[4];
	int values;
	long crossings;             /* -1: not known beforehand */
	double tolerance;           /* over 1, of what is known */
};

static void gear_at(const struct gear *g, const struct hand_system *system, int step)
{
	const struct variant *of = variant_of(figures_table, "%s_%d", g->name, step);
	const pl_model *m = of->model;
	struct run r = run_new(of);
	struct hand_state by_hand;
	double y[MOST_STATES], worst = 0;
	bool good = true;
	run_until(&r, g->seconds);
	run_state(&r, y);
	for (int i = 0; i < g->values; i++)
		good = close_to(y[i], g->value[i], g->tolerance * fabs(g->value[i]), "%s, h = %g, %s", g->name, m->h,
			m->state_names[i]) && good;
	if (g->values)
		ok(good, "%s, h = %g: ten digits of the known values at t = %g", g->name, m->h, g->seconds);
	if (g->crossings >= 0)
		ok(close_to((double)of->crossed(r.state), (double)g->crossings, 0, "changes of region"),
			"%s, h = %g: %ld changes of region", g->name, m->h,
		   g->crossings);
	hand_start(system, &by_hand);
	hand_reference(system, &by_hand, g->seconds);
	good = true;
	for (int i = 0; i < m->states; i++) {
		const double size = i < system->n ? 1 : 0.5;
		good = close_to(y[i], (double)by_hand.y[i], 2e-12 * size, "%s, h = %g, %s by hand", g->name, m->h,
			m->state_names[i]) && good;
		worst = worse(worst, fabs(y[i] - (double)by_hand.y[i]));
	}
		good = close_to((double)of->crossed(r.state), (double)by_hand.crossings, 0,
				"changes of region by hand") &&
			   good;
		ok(good, "%s, h = %g: by hand, %ld changes of region (largest difference %.2g)", g->name, m->h,
		   by_hand.crossings, worst);
		ok(m->status(r.state) == 0, "%s, h = %g: status 0", g->name, m->h);
	run_free(&r);
}

static void gears(void)
{
	static const struct gear all[] = {
		{ "gear1", 50, { 1.3462716421777, .0182023595639939 }, 2, 12, 1e-10 },
		{ "gear1_resonant", 50, { .9044965191187, .0052437460534 }, 2, 15, 1e-10 },
		{ "gear2", 20, { 1.255478222291, .278107931790, -.141334496941, -.146319581244 }, 4, 2, 1e-10 },
		{ "gear3", 5, { 0 }, 0, -1, 0 },
	};
	const struct hand_system system[] = { gear1(0.8L), gear1(1), gear2(), gear3() };
	for (int g = 0; g < 4; g++)
		for (int step = 0; step < 3; step++)
			gear_at(&all[g], &system[g], step);
}

/* The time for which x > 0 is pi/w2, that for which x < 0 is pi/w1. */
static void bilinear(int step)
{
	enum { PERIODS = 20, MOST = 2 * PERIODS + 4 };
	const double pi = acos(-1), up = pi / 5, down = pi / 2, period = up + down;
	const struct variant *of = variant_of(figures_table, "bilinear_%d", step);
	double time[MOST], y[2];
	pl_crossing crossing[MOST];
	struct run r = run_new(of);
	const int count = run_crossings(&r, ceil(PERIODS * period), MOST, time, crossing);
	bool good = close_to(count, 2 * PERIODS, 0, "crossings");
	double worst = 0;
	for (int i = 0; i + 2 < count; i++) {
			good = close_to(time[i + 2] - time[i], period, 1e-12 * period,
					"h = %g, period from crossing %d",
							of->model->h, i) &&
				   good;
			good = close_to(time[i + 1] - time[i], crossing[i].upward ? up : down, 1e-12 * period,
							"h = %g, crossing %d to the next", of->model->h, i) &&
				   good;
			worst = worse(worst, fabs(time[i + 2] - time[i] - period));
	}
		ok(good, "bilinear, h = %g: period pi/w1 + pi/w2 over %d periods (largest difference %.2g)",
				of->model->h,
		   PERIODS, worst);
		good = close_to(time[0], up, 1e-13, "first crossing") &&
				close_to(crossing[0].upward, 0, 0, "its direction");
	for (int i = 1; i < count; i++)
		good = close_to(crossing[i].upward, !crossing[i - 1].upward, 0, "direction of crossing %d", i) && good;
	ok(good, "bilinear, h = %g: up and down in turn", of->model->h);
	run_state(&r, y);                       /* after 20 periods: x = sin(w2 (t - 20 T))/w2 */
	const double t = of->model->time(r.state) - PERIODS * period;
	ok(close_to(y[0], sin(5 * t) / 5, 1e-12, "x") && close_to(y[1], cos(5 * t), 1e-12, "x'"),
		"bilinear, h = %g: state after %d periods", of->model->h,
	   PERIODS);
	run_free(&r);
}

/* m = 100, k = 1e4, stop 1e6: contact pi/w, w^2 = (k + ks)/m; largest force ks v0/w */
static void stop(int step)
{
	const struct variant *of = variant_of(figures_table, "stop_%d", step);
	const pl_model *m = of->model;
	const double w = sqrt(10100.0), lasts = 0.03126001526812332, most = 9950.371902;
	struct run r = run_new(of);
	double y[2], out[3], time[4];
	pl_crossing crossing[4];
	void *at = calloc(1, m->size);
	memcpy(at, r.state, m->size);
	const double peak = acos(-1) / 2 / w;
	const double whole = floor(peak / m->h);
	m->run(at, (size_t)whole, NULL, NULL);
	m->at(at, NULL, peak - whole * m->h, y);
	ok(close_to(1e6 * y[0], most, 1e-9 * most, "h = %g, force", m->h), "stop, h = %g: largest force %.10g N", m->h,
		1e6 * y[0]);
	ok(close_to(1e6 * y[0], 1e6 / w, 1e-13 * most, "force") && close_to(y[1], 0, 1e-13, "speed there"),
		"stop, h = %g: where the speed is 0", m->h);
	m->set(at, 0, y);
	m->out(at, out);
	ok(close_to(out[2], 1e6 * y[0], 1e-15 * most, "output push"), "stop, h = %g: the force as an output", m->h);
	ok(close_to(of->region(r.state), 1, 0, "region"), "stop, h = %g: it starts in touch, since it moves in", m->h);
	const int count = run_crossings(&r, 0.1, 4, time, crossing);
	ok(close_to(count, 1, 0, "crossings") && close_to(crossing[0].upward, 0, 0, "direction") &&
	   close_to(time[0], lasts, 1e-15, "h = %g, contact lasts", m->h), "stop, h = %g: contact lasts %.17g s", m->h,
	   	time[0]);
	run_state(&r, y);
	const double tau = 0.1 - acos(-1) / w;
	ok(close_to(y[0], -sin(10 * tau) / 10, 1e-13, "x") && close_to(y[1], -cos(10 * tau), 1e-13, "x'"),
		"stop, h = %g: the speed is kept", m->h);
	/* ten contacts, still at that speed: energy */
	const int more = run_crossings(&r, 10, 0, time, crossing);
	(void)more;
	run_state(&r, y);
	const double energy = y[1] * y[1] + (y[0] > 0 ? 10100 : 100) * y[0] * y[0];
	ok(close_to(energy, 1, 1e-12, "h = %g, energy over that of the start", m->h),
		"stop, h = %g: energy kept over %d changes", m->h, (int)of->crossed(r.state));
	free(at);
	run_free(&r);
}

int main(void)
{
	gears();
	for (int step = 0; step < 3; step++)
		bilinear(step);
	for (int step = 0; step < 3; step++)
		stop(step);
	return tap_end();
}
