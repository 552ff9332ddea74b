/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same stop in all its forms; dampers that switch with the velocity; stops whose force jumps; and what never stops
 * switching. Beside them the equations as written, in long double, by the classical Runge-Kutta method cut at the
 * crossings that the model found. */
#include "drive.h"
#include "forms_variants.h"
#include "tap.h"

#include <math.h>

typedef long double real;

enum { MOST = 4000 };

static void same_forms(void)
{
	static const char *const forms[] = { "deadzone", "clip", "abs", "minmax", "choice", "nested", "idle" };
	for (int step = 0; step < 3; step++) {
		struct run plain = run_new(variant_of(forms_table, "form_table_%d", step));
		double expected[4], found[4];
		run_until(&plain, 40);
		run_state(&plain, expected);
		for (size_t f = 0; f < sizeof forms / sizeof *forms; f++) {
			struct run r = run_new(variant_of(forms_table, "form_%s_%d", forms[f], step));
			double worst = 0;
			run_until(&r, 40);
			run_state(&r, found);
			bool good = true;
			for (int i = 0; i < 4; i++) {
                            good = close_to(found[i], expected[i], 1e-11, "form_%s, h = %g, %s", forms[f],
                                            r.of->model->h, r.of->model->state_names[i]) &&
								   good;
							worst = worse(worst, fabs(found[i] - expected[i]));
			}
			good = close_to((double)r.of->crossed(r.state), (double)plain.of->crossed(plain.state), 0,
				"form_%s: crossings", forms[f]) && good;
			good = close_to(r.of->model->status(r.state), 0, 0, "form_%s: status", forms[f]) && good;
                        ok(good, "form_%s, h = %g: as the table, %d crossings (largest difference %.2g)", forms[f],
						   r.of->model->h, (int)plain.of->crossed(plain.state), worst);
						run_free(&r);
		}
		run_free(&plain);
	}
}

/* ---- equations of one mass by hand ---- */

typedef real force(real t, real x, real v, bool in);

static real table_of(real v)
{
	return v < -0.5L ? -0.2L + 0.2L * (v + 0.5L) : v < 0 ? 0.4L * v : v < 0.25L ? v : 0.25L + (v - 0.25L) / 3;
}

static real two_rate(real t, real x, real v, bool in)
{
	(void)in;
	return 0.8L * sinl(1.7L * t) - 4 * x - table_of(v);
}

static real preload(real t, real x, real v, bool in)
{
	return 0.7L * sinl(2 * t) - x - (in ? 1.5L + 20 * (x - 0.5L) + 0.6L * v : 0);
}

static void runge_kutta(force *f, real *t, real *y, real to, bool in)
{
	const long steps = 1 + (long)((to - *t) / 0.0005L);
	const real h = (to - *t) / steps;
	for (long k = 0; k < steps; k++) {
		const real x = y[0], v = y[1], now = *t + k * h;
		const real a1 = f(now, x, v, in), v2 = v + h / 2 * a1, a2 = f(now + h / 2, x + h / 2 * v, v2, in);
		const real v3 = v + h / 2 * a2, a3 = f(now + h / 2, x + h / 2 * v2, v3, in), v4 = v + h * a3,
			a4 = f(now + h, x + h * v3, v4, in);
		y[0] = x + h / 6 * (v + 2 * v2 + 2 * v3 + v4);
		y[1] = v + h / 6 * (a1 + 2 * a2 + 2 * a3 + a4);
	}
	*t = to;
}

/* Cut where the model says; that it has found all is seen by where the switch stands. */
static void by_hand(const char *name, int step, force *f, bool velocity, double at)
{
	static double time[MOST];
	static pl_crossing crossing[MOST];
	const double end = 30, start[2] = { velocity ? 1 : 0, velocity ? 0 : 2 };
	struct run r = run_new(variant_of(forms_table, "%s_%d", name, step));
	const int count = run_crossings(&r, end, MOST, time, crossing);
	real t = 0, y[2] = { start[0], start[1] };
	double found[2];
	bool in = false, good = true;
	for (int i = 0; i < count; i++) {
		runge_kutta(f, &t, y, time[i], in);
		in = crossing[i].upward;
		if (!velocity)
                    good = close_to((double)y[0], at, 1e-10, "%s, h = %g: x at crossing %d", name, r.of->model->h, i) &&
						   good;
		}
	runge_kutta(f, &t, y, end, in);
	run_state(&r, found);
	for (int i = 0; i < 2; i++)
		good = close_to(found[i], (double)y[i], 1e-9, "%s, h = %g: %s", name, r.of->model->h,
			r.of->model->state_names[i]) && good;
	if (!velocity)
		good = close_to(in, y[0] > at, 0, "%s: in touch at the end", name) && good;
	good = close_to(r.of->model->status(r.state), 0, 0, "%s: status", name) && good;
	ok(good, "%s, h = %g: by hand, %d crossings (off by %.2g and %.2g)", name, r.of->model->h, count,
		fabs(found[0] - (double)y[0]),
	   fabs(found[1] - (double)y[1]));
	run_free(&r);
}

static void dampers(void)
{
	for (int step = 0; step < 3; step++) {
		by_hand("two_rate", step, two_rate, true, 0);
		by_hand("two_rate_choice", step, two_rate, true, 0);
		by_hand("preload", step, preload, false, 0.5);
	}
}

/* ---- what switches for ever ---- */

static void chatter(int step)
{
	const struct variant *of = variant_of(forms_table, "chatter_%d", step);
	const pl_model *m = of->model;
	struct run r = run_new(of);
	pl_crossing crossing[MOST_EVENTS];
	double y[2];
	bool finite = true, counted = true;
	int longest = 0;
	while (r.steps * m->h < 100) {
		run_step(&r, NULL);
		run_state(&r, y);
		finite = finite && isfinite(y[0]) && isfinite(y[1]) && fabs(y[0]) < 2 && fabs(y[1]) < 2;
		const int found = of->crossings(r.state, crossing);
		counted = counted && found >= 0 && found <= MOST_EVENTS;
		for (int i = 0; i < found && counted; i++)
			counted = crossing[i].time >= (i ? crossing[i - 1].time : 0) && crossing[i].time <= m->h;
		longest = found > longest ? found : longest;
	}
	note("chatter, h = %g: %d crossings, at most %d in a step, ends at x = %.3g, x' = %.3g", m->h,
		(int)of->crossed(r.state), longest, y[0], y[1]);
	ok(close_to(m->status(r.state) & PL_TOO_MANY_EVENTS, PL_TOO_MANY_EVENTS, 0, "status"),
		"chatter, h = %g: the status says so, and stays", m->h);
	ok(!(m->status(r.state) & PL_NOT_FINITE), "chatter, h = %g: but it is finite", m->h);
	ok(finite, "chatter, h = %g: all is finite and bounded", m->h);
	ok(counted, "chatter, h = %g: no more crossings in a step than there is room for, in order", m->h);
	m->init(r.state);
	ok(m->status(r.state) == 0 && of->crossed(r.state) == 0, "chatter, h = %g: init clears status and count", m->h);
	for (int k = 0; k < 1000; k++)
		m->step(r.state, NULL);
	const int before = m->status(r.state);
	m->set(r.state, 3, (double[]){ 1, 0 });
	ok(before != 0 && m->status(r.state) == 0 && of->crossed(r.state) == 0, "chatter, h = %g: so does set", m->h);
	run_free(&r);
}

int main(void)
{
	same_forms();
	dampers();
	for (int step = 0; step < 3; step++)
		chatter(step);
	return tap_end();
}
