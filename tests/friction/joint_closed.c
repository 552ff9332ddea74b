/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sliders without mass beside closed forms: the loop of Masing, an Iwan joint and two sliders in series on a record of
 * ramps, where what each bears after a ramp follows from what it bore before (the play operator). */
#include "drive.h"
#include "joint_closed_variants.h"
#include "quadrant.h"
#include "tap.h"
#include "worse.h"

#include <math.h>

typedef long double wide;

enum { MOST = 256, RAMPS = 2000 };
static const wide pi = 3.141592653589793238462643383279502884L;

/* x = 0.3 cos(3 t) on a spring of 50 and a slider of 2: it slides from 2 F/k behind each end on, to the next */
static void masing(int step)
{
	static double time[MOST];
	static pl_crossing crossing[MOST];
	struct run r = run_new(variant_of(joint_closed_table, "masing_%d", step));
	int count = run_crossings(&r, 20, MOST, time, crossing), expected = 0;
	double out[2], off = 0, y;
	wide begins = acosl(0.26L / 0.3L), z;
	for (int end = 0; end * pi / 3 < 20; end++) {
		wide slide = (end * pi + (end ? acosl(0.22L / 0.3L) : begins)) / 3, stick = (end + 1) * pi / 3;
		for (int k = 0; k < 2; k++) {
			wide t = k ? stick : slide;
			if (t < 20 && expected < count)
				off = worse(off, (double)fabsl(time[expected] - t));
			expected += t < 20;
		}
	}
	ok(count == expected, "masing %d: %d changes, expected %d", step, count, expected);
	is_close(off, 0, 1e-13, "masing %d: their times", step);
	run_state(&r, &y);
	r.of->model->out(r.state, out);
	z = -0.26L;                             /* the last end before t = 20 is at 19 pi/3: x = -0.3 */
	if (0.3L * cos_of(60) - z > 0.04L)
		z = 0.3L * cos_of(60) - 0.04L;
	is_close(y, (double)z, 1e-14, "masing %d: where the slider is", step);
	is_close(out[0], (double)(50 * (0.3L * cos_of(60) - z)), 1e-12, "masing %d: what it bears", step);
	run_free(&r);
}

/* A slider that is set where it cannot be goes at once to where it bears F. */
static void placed(int step)
{
	struct run r = run_new(variant_of(joint_closed_table, "masing_%d", step));
	double y = 0, h = r.of->model->h;
	wide x = 0.3L * cos_of(3 * (wide)h);
	run_set(&r, &y);
	run_step(&r, NULL);
	run_state(&r, &y);
	is_close(y, (double)(0.26L < x + 0.04L ? 0.26L : x + 0.04L), 1e-15, "masing %d: set too far away", step);
	run_free(&r);
}

/* Inside steps of 0.5 s what steps of 0.01 s find there */
static void inside(void)
{
	struct run large = run_new(variant_of(joint_closed_table, "knock_2")),
		   small = run_new(variant_of(joint_closed_table, "knock_0"));
	double off = 0, y[3], at[3];
	for (int n = 0; n < 500; n++) {
		large.of->model->at(large.state, NULL, n % 50 * 0.01, at);
		run_state(&small, y);
		for (int i = 0; i < 3; i++)
			off = worse(off, fabs(at[i] - y[i]));
		run_step(&small, NULL);
		if (n % 50 == 49)
			run_step(&large, NULL);
	}
	is_close(off, 0, 1e-12, "knock: inside long steps");
	run_free(&large);
	run_free(&small);
}

static double next_sample(unsigned *state, double u)
{
	*state = *state * 1664525u + 1013904223u;
	double to = ((double)(*state >> 8) / 16777216.0 - 0.5) * 0.8;
	return *state >> 28 < 3 ? u : to;       /* now and then it rests */
}

static wide held_to(wide force, wide limit)
{
	return force > limit ? limit : force < -limit ? -limit : force;
}

static void record(int step)
{
	static const double k[] = { 20, 30, 40, 50 }, F[] = { 0.5, 1, 2, 4 };
	struct run r = run_new(variant_of(joint_closed_table, "record_%d", step));
	wide f[4] = { 0 };
	double u = 0, off = 0, first = 0, out[2];
	unsigned state = 7;
	for (int n = 0; n < RAMPS; n++) {
		double to = next_sample(&state, u);
		wide sum = 0;
		for (int i = 0; i < 4; i++)
			sum += f[i] = held_to(f[i] + k[i] * ((wide)to - u), F[i]);
		run_step(&r, &to);
		r.of->model->out(r.state, out);
		off = worse(off, fabs(out[0] - (double)sum));
		first = worse(first, fabs(out[1] - (double)f[0]));
		u = to;
	}
	is_close(off, 0, 1e-12, "record %d: the joint's force after each of %d ramps", step, RAMPS);
	is_close(first, 0, 1e-12, "record %d: that of its first slider", step);
	is_close(r.of->model->status(r.state), 0, 0, "record %d: status", step);
	run_free(&r);
}

/* The second slider bears what is above its spring's 10 z2; s = z1 - z2 stays while the first sticks. */
static void series(int step)
{
	struct run r = run_new(variant_of(joint_closed_table, "series_%d", step));
	wide s = 0, z = 0;
	double u = 0, off = 0, bears = 0, y[2], out[1];
	unsigned state = 11;
	for (int n = 0; n < RAMPS; n++) {
		double to = next_sample(&state, u);
		wide f = 40 * (to - s - z), over = f - 10 * z;
		if (fabsl(over) > 1.5L) {
			z = (40 * (to - s) - (over > 0 ? 1.5L : -1.5L)) / 50;
			f = 10 * z + (over > 0 ? 1.5L : -1.5L);
		}
		if (fabsl(f) > 2) {
			f = f > 0 ? 2 : -2;
			z = f / 40;
			s = to - f / 40 - z;
		}
		run_step(&r, &to);
		run_state(&r, y);
		r.of->model->out(r.state, out);
		off = worse(off, worse(fabs(y[0] - (double)(s + z)), fabs(y[1] - (double)z)));
		bears = worse(bears, fabs(out[0] - (double)f));
		u = to;
	}
	is_close(off, 0, 1e-13, "series %d: where both are after each of %d ramps", step, RAMPS);
	is_close(bears, 0, 1e-12, "series %d: what the first bears", step);
	is_close(r.of->model->status(r.state), 0, 0, "series %d: status", step);
	run_free(&r);
}

/* Beside the same equations by Runge and Kutta's method of order 4, steps of 1e-4 or 2e-4, events by bisection */
static void beside_small_steps(const char *name, int step, const double *end, const double *x, const double *z)
{
	struct run r = run_new(variant_of(joint_closed_table, "%s_%d", name, step));
	double y[3];
	for (int k = 0; k < 2; k++) {
		run_until(&r, end[k]);
		run_state(&r, y);
		is_close(y[0], x[k], 1e-11, "%s %d: x at t = %g", name, step, end[k]);
		is_close(y[1], z[k], 1e-11, "%s %d: z at t = %g", name, step, end[k]);
	}
	run_free(&r);
}

static void changing(int step)
{
	static const double x[] = { 0.19252550863128992, 0.027190718697498926 },
			    z[] = { 0.17068733309656522, 0.01127468202942375 }, end[] = { 1.5, 5 };
	beside_small_steps("changing", step, end, x, z);
}

/* Bounces turn the slider round, too */
static void knock(int step)
{
	static const double x[] = { -0.04332399699557494, 0.007281524427625416 },
			    z[] = { -0.023323996995574938, 0.027281524427625416 }, end[] = { 2.5, 5 };
	beside_small_steps("knock", step, end, x, z);
}

/* z sticks behind each end of x = 0.3 cos(3 t), then bears F(x), on the way down and up */
static wide leaning_place(wide t)
{
	int half = (int)(3 * t / pi);
	wide x = 0.3L * cos_of(3 * t), F = 2 + 3 * (x > 0 ? x : 0), end = half % 2 ? -0.26L : 0.3L - 2.9L / 50;
	if (half % 2)
		return x - F / 50 > end ? x - F / 50 : end;
	if (half == 0)
		end = 0.3L;
	return x + F / 50 < end ? x + F / 50 : end;
}

/* What is crossed names expressions and breakpoints that there are. */
static bool is_known(const struct run *r, const pl_crossing *crossing, int count)
{
	static const int breaks[] = { 1, 2, 1, 1 };     /* x; q; q - F; -q - F */
	bool known = true;
	for (int i = 0; i < count; i++)
		known = known && crossing[i].expression >= 0 && crossing[i].expression < 4 &&
			crossing[i].breakpoint >= 0 && crossing[i].breakpoint < breaks[crossing[i].expression];
	return known && r->of->model->status(r->state) == 0;
}

static void leaning(int step)
{
	static double time[MOST];
	static pl_crossing crossing[MOST];
	struct run r = run_new(variant_of(joint_closed_table, "leaning_%d", step));
	double off = 0, bears = 0, y[3], out[1], h = r.of->model->h;
	for (int n = 1; n * h < 20; n++) {
		run_step(&r, NULL);
		run_state(&r, y);
		r.of->model->out(r.state, out);
		wide z = leaning_place(n * (wide)h);
		off = worse(off, fabs(y[1] - (double)z));
		bears = worse(bears, fabs(out[0] - (double)(50 * (0.3L * cos_of(3 * n * (wide)h) - z))));
	}
	is_close(off, 0, 1e-13, "leaning %d: where the slider is", step);
	is_close(bears, 0, 1e-11, "leaning %d: what it bears", step);
	run_free(&r);
	r = run_new(variant_of(joint_closed_table, "leaning_%d", step));
	int count = run_crossings(&r, 20, MOST, time, crossing);
	ok(count <= MOST && is_known(&r, crossing, count), "leaning %d: %d crossings, status 0", step, count);
	run_free(&r);
}

/* The same equations by Runge and Kutta's method of order 4 in long double; the forces of friction */
static void pressed_slopes(wide t, const wide *z, wide *slope, wide *force)
{
	wide x = 0.3L * cos_of(3 * t), v = -0.9L * sin_of(3 * t), q = 50 * (x - z[0]), p = 40 * (x - z[1]) + 0.4L * v;
	wide F = 1 + 5 * x > 0 ? 1 + 5 * x : 0;
	force[0] = held_to(q, 2 + cos_of(5 * t));
	force[1] = held_to(p, F);
	slope[0] = (q - force[0]) / 0.3L;
	slope[1] = (p - force[1]) / 0.4L;
}

static void pressed_step(wide t, wide h, wide *z)
{
	wide k[4][2], at[2], force[2];
	for (int s = 0; s < 4; s++) {
		wide c = s == 3 ? h : s > 0 ? h / 2 : 0;
		for (int i = 0; i < 2; i++)
			at[i] = z[i] + (s > 0 ? c * k[s - 1][i] : 0);
		pressed_slopes(t + c, at, k[s], force);
	}
	for (int i = 0; i < 2; i++)
		z[i] += h / 6 * (k[0][i] + 2 * k[1][i] + 2 * k[2][i] + k[3][i]);
}

static void pressed(int step)
{
	struct run r = run_new(variant_of(joint_closed_table, "pressed_%d", step));
	double off = 0, bears = 0, y[4], out[2], h = r.of->model->h;
	wide z[2] = { 0, 0 }, slope[2], force[2];
	int parts = (int)lround(h / 2e-5);
	for (int n = 0; n * h < 3.95; n++) {
		for (int k = 0; k < parts; k++)
			pressed_step(n * (wide)h + k * (wide)h / parts, (wide)h / parts, z);
		run_step(&r, NULL);
		run_state(&r, y);
		off = worse(off, worse(fabs(y[1] - (double)z[0]), fabs(y[2] - (double)z[1])));
		r.of->model->out(r.state, out);
		pressed_slopes((n + 1) * (wide)h, z, slope, force);
		for (int i = 0; i < 2; i++)
			bears = worse(bears, fabs(out[i] - (double)force[i]));
	}
	is_close(off, 0, 1e-8, "pressed %d: where both are, beside steps of 2e-5 s", step);
	is_close(bears, 0, 5e-7, "pressed %d: what both bear", step);
	is_close(r.of->model->status(r.state), 0, 0, "pressed %d: status", step);
	run_free(&r);
}

int main(void)
{
	for (int step = 0; step < 3; step++)
		masing(step);
	for (int step = 0; step < 2; step++)
		placed(step);
	for (int step = 0; step < 3; step++) {
		changing(step);
		knock(step);
		leaning(step);
	}
	for (int step = 0; step < 2; step++)
		pressed(step);
	inside();
	for (int step = 0; step < 2; step++) {
		record(step);
		series(step);
	}
	return tap_end();
}
