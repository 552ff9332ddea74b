/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads that change their formula beside friction and impacts, by closed form: what a change tears off, stops, lifts
 * and pushes, also where it falls on an event, on a step's end, and far from t = 0; then an input that is held or a
 * ramp across changes, NAME_at and NAME_set there, and a state that is put back, by steps of other lengths. */
#include "drive.h"
#include "changes_variants.h"
#include "tap.h"
#include "worse.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

typedef long double wide;

struct motion { wide x, v, rub, a; };

/* ---- ramped: m x'' + friction(x', 2, 2.3) = load ---- */

static wide ramped_load(wide t)
{
	return t < 1 ? 1 : t < 3 ? t : t < 3.2L ? 3 : 0;
}

static struct motion ramped(wide t)
{
	const wide m = 1.5L, F = 2, load = ramped_load(t);
	const wide v3 = (1 - 0.09L) / 2 / m, x3 = (1 - 0.027L) / 6 / m - 0.09L / 2 / m * 0.7L;
	const wide v4 = v3 + 0.2L / m, x4 = x3 + 0.2L * v3 + 0.02L / m, stops = v4 * m / F;
	if (t < 2.3L)
		return (struct motion){ 0, 0, load, 0 };
	if (t < 3)
		return (struct motion){ ((t - 2) * (t - 2) * (t - 2) - 0.027L) / 6 / m - 0.09L / 2 / m * (t - 2.3L),
					((t - 2) * (t - 2) - 0.09L) / 2 / m, F, (load - F) / m };
	if (t < 3.2L)
		return (struct motion){ x3 + v3 * (t - 3) + (t - 3) * (t - 3) / 2 / m, v3 + (t - 3) / m, F,
				(load - F) / m };
	if (t < 3.2L + stops)
		return (struct motion){ x4 + v4 * (t - 3.2L) - F / m / 2 * (t - 3.2L) * (t - 3.2L),
					v4 - F / m * (t - 3.2L), F, -F / m };
	return (struct motion){ x4 + v4 * stops / 2, 0, 0, 0 };
}

/* ---- carried: m x'' + friction(x' - belt, 2) = 0 ---- */

static wide belt(wide t)
{
	return t < 1 ? 0.2L : t < 2 ? 0.2L + 0.3L * (t - 1) : t < 3 ? 0.5L : 0;
}

/* m = 1: it sticks to the belt until that stops, and slides for 1/4 s. */
static struct motion carried(wide t)
{
	const wide s = t < 1 ? 0 : t < 2 ? t - 1 : 1, x2 = 0.2L * 2 + 0.15L, x3 = x2 + 0.5L, left = t - 3;
	if (t < 2)
		return (struct motion){ 0.2L * t + 0.15L * s * s, belt(t), t < 1 ? 0 : -0.3L, t < 1 ? 0 : 0.3L };
	if (t < 3)
		return (struct motion){ x2 + 0.5L * (t - 2), 0.5L, 0, 0 };
	if (left < 0.25L)
		return (struct motion){ x3 + 0.5L * left - left * left, 0.5L - 2 * left, 2, -2 };
	return (struct motion){ x3 + 0.0625L, 0, 0, 0 };
}

/* m = 10: the belt draws away at t = 1, and it catches up at t = 2.5; it slides for 5/2 s. */
static struct motion slow(wide t)
{
	const wide x1 = 0.2L, d = t - 1, x5 = x1 + 0.2L * 1.5L + 0.1L * 2.25L, left = t - 3;
	if (t < 1)
		return (struct motion){ 0.2L * t, 0.2L, 0, 0 };
	if (t < 2.5L)
		return (struct motion){ x1 + 0.2L * d + 0.1L * d * d, 0.2L + 0.2L * d, -2, 0.2L };
	if (t < 3)
		return (struct motion){ x5 + 0.5L * (t - 2.5L), 0.5L, 0, 0 };
	if (left < 2.5L)
		return (struct motion){ x5 + 0.25L + 0.5L * left - 0.1L * left * left, 0.5L - 0.2L * left, 2, -0.2L };
	return (struct motion){ x5 + 0.25L + 0.625L, 0, 0, 0 };
}

/* ---- walled: x'' + friction(x', 1) = 5 onto a wall at 0.5, which comes from t = 1 to 2, from t = 3 on at 1 ---- */

static struct motion walled(wide t)
{
	const wide out = t - 3, far = sqrtl(0.6L / 2);
	/* thrown back by the wall that stops, until friction turns with it and it comes again */
	const wide d = t - 2, turn = 0.1L / 6, back = t - 2 - turn, flight = sqrtl(0.05L * turn / 2);
	if (t < 0.5L)
		return (struct motion){ 2 * t * t, 4 * t, 0, 4 };
	if (t < 1)
		return (struct motion){ 0.5L, 0, 0, 0 };
	if (t < 2)
		return (struct motion){ 0.5L - 0.1L * (t - 1), -0.1L, 0, 0 };
	if (d < turn)
		return (struct motion){ 0.4L - 0.1L * d + 3 * d * d, -0.1L + 6 * d, 0, 6 };
	if (back < flight)
		return (struct motion){ 0.4L - 0.05L * turn + 2 * back * back, 4 * back, 0, 4 };
	if (t < 3)
		return (struct motion){ 0.4L, 0, 0, 0 };
	if (out < far)
		return (struct motion){ 0.4L + 2 * out * out, 4 * out, 0, 4 };
	return (struct motion){ 1, 0, 0, 0 };
}

/* ---- halted: x'' + friction(x', 2) = L from t = 1 on, where it comes to rest ---- */

static struct motion halted_by(wide t, wide L)
{
	const wide d = t - 1, a = L > 2 ? L - 2 : L < -2 ? L + 2 : 0;
	if (t < 1)
		return (struct motion){ 2 * t - t * t, 2 - 2 * t, 2, -2 };
	return (struct motion){ 1 + a * d * d / 2, a * d, L > 2 ? 2 : L < -2 ? -2 : L, a };
}

static struct motion halted(wide t) { return halted_by(t, 1); }
static struct motion onward(wide t) { return halted_by(t, 3); }
static struct motion back(wide t)   { return halted_by(t, -3); }
static struct motion just(wide t)   { return halted_by(t, 2); }

/* ---- dropped: parabolas from bounce to bounce, of which infinitely many end in rest ---- */

static wide gravity(wide t, wide *until)
{
	static const struct { wide until, g; } of[] = {
		{ 1, -2 }, { 2.35L, 3 }, { 4, -9.81L }, { 4.5L, 1 }, { 18, -20 }, { 18.37L, 5 }, { 1e9L, -10 }
	};
	int k = 0;
	while (t >= of[k].until)
		k++;
	*until = of[k].until;
	return of[k].g;
}

/* When it lands within `left`; else -1 */
static wide landing(wide z, wide v, wide g, wide left)
{
	const wide root = v * v - 2 * g * z;
	const wide at = g >= 0 || root < 0 ? (v < 0 && root >= 0 ? 2 * z / (-v + sqrtl(root)) : -1)
					   : (v + sqrtl(root)) / -g;
	return at >= 0 && at <= left ? at : -1;
}

static struct motion dropped(wide end)
{
	wide t = 0, z = 1, v = 0, until;
	while (t < end) {
		const wide g = gravity(t, &until), left = fminl(until, end) - t;
		const bool rests = z == 0 && (v == 0 || (g < 0 && -v / g < 1e-17L));
		const wide land = rests ? -1 : landing(z, v, g, left);
		if (rests && g < 0) {
			v = 0;
			t += left;
			continue;
		}
		const wide by = land >= 0 ? land : left;
		z = land >= 0 ? 0 : z + by * (v + by * g / 2);
		v = land >= 0 ? -(v + by * g) / 2 : v + by * g;
		t = land >= 0 ? t + by : fminl(until, end);
	}
	return (struct motion){ z, v, 0, 0 };
}

/* ---- outputs on a step's end where the load changes, beside a clearance ---- */

static void outputs_at_changes(int step)
{
	struct run r = run_new(variant_of(changes_table, "pushed_%d", step));
	double out[2], worst = 0;
	for (long k = 1; k * r.of->model->h < 5; k++) {
		run_step(&r, NULL);
		r.of->model->out(r.state, out);
		const double t = round((double)k * r.of->model->h * 1e6) / 1e6;
		const double load = t < 1 ? 1 : t < 2 ? 3 : t < 3.2 ? -2 : cos(t);
		worst = worse(worst, fabs(out[0] - load));
		worst = worse(worst, fabs(out[1] - load));
	}
	ok(worst <= 1e-14, "pushed, h = %g: load and x'' at the ends of steps, off by %.2g at most", r.of->model->h,
	   worst);
	run_free(&r);
}

/* ---- beside the model ---- */

struct form {
	const char *name;
	struct motion (*at)(wide t);
	double until, tolerance;
	bool feels;                     /* its outputs are what friction carries, and x'' */
	double jumps[3];                /* where velocities or outputs may be on either side: of events, not changes */
};

static bool near_jump(const struct form *form, wide t)
{
	bool near = false;
	for (int i = 0; i < 3; i++)
		near = near || fabsl(t - (wide)form->jumps[i]) < 1e-9L;
	return near;
}

/* from: t = 0 of the closed form */
static void compare(const struct form *form, const char *name, int step, double from, double start, double tolerance)
{
	struct run r = run_new(variant_of(changes_table, "%s_%d", name, step));
	const pl_model *model = r.of->model;
	double y[2], out[3], worst = 0, of_outputs = 0;
	const struct motion first = form->at((wide)start);
	if (from + start > 0)
		model->set(r.state, from + start, (const double[]){ (double)first.x, (double)first.v });
	for (long k = 1; k * model->h + start < form->until; k++) {
		run_step(&r, NULL);
		run_state(&r, y);
		model->out(r.state, out);
		/* a step's end on a change is that of the decimals, and belongs to what comes then */
		const wide t = (wide)start + roundl((wide)k * model->h * 1e6L) / 1e6L;
		const struct motion due = form->at(t);
		worst = worse(worst, fabs(y[0] - (double)due.x));
		if (near_jump(form, t))
			continue;
		worst = worse(worst, fabs(y[1] - (double)due.v));
		if (!form->feels)
			continue;
		of_outputs = worse(of_outputs, fabs(out[0] - (double)due.rub));
		of_outputs = worse(of_outputs, fabs(out[1] - (double)due.a));
	}
	ok(worst <= tolerance, "%s from %.15g, h = %g: the closed form, to %.2g", name, from + start, model->h, worst);
	if (form->feels)
		ok(of_outputs <= tolerance, "%s from %.15g, h = %g: what friction carries, and x'', to %.2g", name,
		   from + start, model->h, of_outputs);
	is_close(model->status(r.state), 0, 0, "%s, h = %g: status", name, model->h);
	run_free(&r);
}

/* ---- an input beside: steps of one length against those of another ---- */

static double sample(double t)
{
	return sin(2 * t) + 0.5 * cos(5 * t + 1);
}

/* What short steps are given: a part of the ramp, or what is held */
static double within(double from, double h, double part, bool ramp)
{
	return ramp ? (from > 0 ? sample(from) : 0) * (1 - part) + sample(from + h) * part : sample(from);
}

static void long_and_short(const char *name, int step, bool ramp)
{
	struct run r = run_new(variant_of(changes_table, "%s_%d", name, step)),
		   f = run_new(variant_of(changes_table, "%s_2", name));
	const pl_model *model = r.of->model;
	const double h = model->h, fine = f.of->model->h;
	const int parts = (int)lround(h / fine);
	double worst = 0, y[4], z[4], out[4], fine_out[4];
	bool good = true;
	for (int k = 0; k < 4 / h; k++) {
		const double from = k * h, u = sample(ramp ? from + h : from);
		void *copy = malloc(model->size);
		for (int part = 1; part <= parts; part++) {
			const double v = within(from, h, (double)part / parts, ramp);
			run_step(&f, &v);
			run_state(&f, z);
			model->at(r.state, &u, part * fine, y);
			good = same_numbers(y, z, 4, 1e-11, &worst, name, from + part * fine) && good;
		}
		memcpy(copy, r.state, model->size);
		model->step(copy, &u);          /* put back, it goes the same way again */
		run_step(&r, &u);
		run_state(&r, y);
		model->get(copy, z);
		good = same_numbers(y, z, 4, 0, &worst, name, from + h) && good;
		run_state(&f, z);
		good = same_numbers(y, z, 4, 1e-11, &worst, name, from + h) && good;
		model->out(r.state, out);
		f.of->model->out(f.state, fine_out);
		good = same_numbers(out, fine_out, 4, 1e-9, &worst, name, from + h) && good;
		free(copy);
	}
	ok(good, "%s, h = %g: steps and times inside of them as steps of %g, to %.2g", name, h, fine, worst);
	is_close((double)r.of->crossed(r.state), (double)f.of->crossed(f.state), 0, "%s, h = %g: crossings", name, h);
	ok(r.of->crossed(r.state) > 5, "%s, h = %g: %d crossings", name, h, (int)r.of->crossed(r.state));
	is_close(model->status(r.state), 0, 0, "%s, h = %g: status", name, h);
	run_free(&r);
	run_free(&f);
}

int main(void)
{
	const struct form forms[] = {
		{ "ramped", ramped, 6, 2e-14, true, { 2.3 } },
		{ "carried", carried, 6, 2e-14, true, { 3.25 } },
		{ "slow", slow, 8, 2e-14, true, { 2.5, 5.5 } },
		{ "walled", walled, 5, 2e-14, false, { 0.5, 2.0370790 } },
		{ "dropped", dropped, 25, 2e-13, false, { 0 } },
		{ "halted", halted, 3, 2e-14, true, { 1 } },
		{ "onward", onward, 3, 2e-14, true, { 1 } },
		{ "back", back, 3, 2e-14, true, { 1 } },
		{ "just", just, 3, 2e-14, true, { 1 } },
	};
	for (int step = 0; step < 4; step++) {
		for (size_t i = 0; i < sizeof forms / sizeof *forms; i++)
			compare(&forms[i], forms[i].name, step, 0, 0, forms[i].tolerance);
		outputs_at_changes(step);
		compare(&forms[0], "ramped", step, 0, 0.123456789, 2e-14);
		compare(&forms[0], "late", step, 1e6, 0, 1e-9);
		compare(&forms[0], "late", step, 1e6, 0.123456789, 1e-9);
	}
	for (int step = 0; step < 2; step++) {
		long_and_short("joined", step, true);
		long_and_short("held", step, false);
	}
	for (int i = 0; i < 4; i++)
		goes_on_when_set(variant_of(changes_table, "held_2"), (const int[]){50, 113, 145, 200}[i]);
	return tap_end();
}
