/* SPDX-License-Identifier: MIT-0 */
/* From crossing to crossing: closed forms, states between steps, inputs that are held and ramps. */
#include "figures_variants.h"
#include "nested_etdrk4_pl.h"
#include "stop_float_pl.h"
#include "circle_float_pl.h"
#include "nested_float_pl.h"
#include "stop_radau_pl.h"
#include "stop_auto_pl.h"
#include "nested_radau_pl.h"
#include "circle_auto_pl.h"
#include "quadrant.h"
#include "systems.h"
#include "tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static const struct variant *variant_called(const char *name)
{
	const struct variant *v = figures_table;
	while (v->model && strcmp(v->model->name, name) != 0)
		v++;
	return v;
}

/* ---- x'' + x + b x' |x'| = 0: between two turns x'^2 = C e^{2 b x} + (2 b x + 1)/(2 b^2), for x' < 0 ---- */

/* (1 + 2 b x) e^{-2 b x} is the same at both turns; the second, by Newton's method */
static real next_turn(real from)
{
	const real b = 0.3L;
	real x = -from;
	for (int k = 0; k < 200; k++) {
		const real f = (1 + 2 * b * x) * expl(-2 * b * x) - (1 + 2 * b * from) * expl(-2 * b * from);
		const real slope = -4 * b * b * x * expl(-2 * b * x);
		x -= f / slope;
	}
	return x;
}

static void check_drag(const char *name)
{
	const struct variant *v = variant_called(name);
	const pl_model *m = v->model;
	pl_crossing crossing[MOST_EVENTS];
	double y[2], worst = 0, slowest = 0;
	real turn = 2;
	int turns = 0;
	void *state = calloc(1, m->size), *before = calloc(1, m->size);
	m->init(state);
	while (turns < 40) {
		memcpy(before, state, m->size);
		m->step(state, NULL);
		for (int i = 0; i < v->crossings(state, crossing); i++) {
			m->at(before, NULL, crossing[i].time, y);
			turn = -next_turn(turn);        /* mirrored, so that it always starts at x > 0 */
			worst = worse(worst, (double)fabsl(fabsl((real)y[0]) - turn));
			slowest = worse(slowest, fabs(y[1]));
			turns++;
		}
	}
	is_close(worst, 0, 1e-13, "%s: 40 turning points", name);
	is_close(slowest, 0, 1e-13, "%s: at rest there", name);
	ok(v->crossed(state) == 40 && m->status(state) == 0, "%s: no other crossing", name);
	free(state);
	free(before);
}

/* ---- x'' + x |x| = 0 from 1: a period is 4 sqrt(3/2)/3 Beta(1/3, 1/2) ---- */

/* `bound`: of the energy at the ends of steps of h, for radau inside its own, to ten times the tolerance */
static void check_odd_square(const char *name, double bound)
{
	const struct variant *v = variant_called(name);
	const pl_model *m = v->model;
	const real period = 4 * sqrtl(1.5L) / 3 * expl(lgammal(1 / 3.0L) + lgammal(0.5L) - lgammal(5 / 6.0L));
	pl_crossing crossing[MOST_EVENTS];
	double y[2], worst = 0, energy = 0;
	int count = 0;
	void *state = calloc(1, m->size);
	m->init(state);
	for (int k = 0; count < 100; k++) {
		m->step(state, NULL);
		for (int i = 0; i < v->crossings(state, crossing); i++, count++)
			worst = worse(worst, (double)fabsl((k * (real)m->h + crossing[i].time) - period * (2 * count
					+ 1) / 4));
		m->get(state, y);
		energy = worse(energy, fabs(y[1] * y[1] / 2 + fabs(y[0] * y[0] * y[0]) / 3 - 1.0 / 3));
	}
	is_close(worst, 0, 2e-12, "%s: 100 passages", name);
	is_close(energy, 0, bound, "%s: energy", name);
	free(state);
}

/* ---- inputs ---- */

static real held_u[4];                  /* u, w at the start of a step, and their slopes */
static real held_from;

static void driven(real t, const real *y, const real *u, real *d)
{
	const real now = held_u[0] + (t - held_from) * held_u[2];
	(void)u;
	d[0] = y[1];
	d[1] = cos_of(1.7L * t) - 0.1L * y[1] - y[0] - y[0] * y[0] * y[0] -
		(interval_of[0] ? 20 * (y[0] - 0.3L - now) : 0) - (interval_of[1] ? y[0] * y[0] : 0);
}

static void driven_by(real t, const real *y, real *e)
{
	e[0] = y[0] - (held_u[0] + (t - held_from) * held_u[2]);
	e[1] = held_u[1] + (t - held_from) * held_u[3];
}

static const struct switched_system driven_system = {
	"driven", 2, 2, {0.25L}, driven, driven_by, {1, 1}, {{0.3L}, {0.5L}}, 0, 0
};

static double sample(int k, int which)
{
	return which ? 0.5 + 0.4 * sin(0.9 * k) : 0.2 * cos(0.37 * k) + (k % 7 == 0 ? 0.15 : 0);
}

/* After k of `each` parts of the time between samples: held, or on the line from one to the next */
static double input_at(int k, int each, int which, bool ramps)
{
	const double here = sample(k / each, which), next = sample(k / each + 1, which);
	return ramps ? here + (next - here) * (k % each) / each : here;
}

static void check_inputs(const char *name, bool ramps, double allowed)
{
	const pl_model *m = variant_called(name)->model;
	const int each = (int)lround(1 / (20 * m->h));      /* steps */
	double y[2], u[2], between[2], worst = 0, inside = 0;
	real truth[HAND_MOST] = {0.25L}, crossed[64];
	void *state = calloc(1, m->size);
	m->init(state);
	if (ramps) {
		u[0] = sample(0, 0);
		u[1] = sample(0, 1);
		m->hold(state, u);
	}
	for (int k = 0; k < 240 * each; k++) {
		for (int i = 0; i < 2; i++) {
			u[i] = input_at(ramps ? k + 1 : k, each, i, ramps);
			held_u[i] = input_at(k, each, i, ramps);
			held_u[2 + i] = ramps ? (u[i] - held_u[i]) / (real)m->h : 0;
		}
		held_from = k * (real)m->h;
		if (!ramps || k == 0)
			place_switched(&driven_system, held_from, truth);
		m->at(state, u, 0.4 * m->h, between);
		for (int part = 0; part < 2; part++) {
			const real from = held_from + (part ? 0.4L * m->h : 0), to = held_from
					+ (part ? 1 : 0.4L) * m->h;
			(void)follow_switched(&driven_system, from, to, truth, crossed, 64);
			for (int i = 0; i < 2 && !part; i++)
				inside = worse(inside, (double)fabsl(between[i] - truth[i]));
		}
		m->step(state, u);
		m->get(state, y);
		for (int i = 0; i < 2; i++)
			worst = worse(worst, (double)fabsl(y[i] - truth[i]));
	}
	is_close(worst, 0, allowed, "%s: 240 samples", name);
	is_close(inside, 0, allowed, "%s: between them", name);
	ok(m->status(state) == 0, "%s: status", name);
	free(state);
}

/* ---- thousands of crossings, beside those of the series; then too many in some steps ---- */

static void check_ringing(const char *name, int steps, int status)
{
	const struct variant *one = variant_called("ringing_0"), *other = variant_called(name);
	double y[2], z[2], worst = 0;
	int apart = 0;
	void *series = calloc(1, one->model->size), *state = calloc(1, other->model->size);
	one->model->init(series);
	other->model->init(state);
	for (int k = 0; k < steps; k++) {
		one->model->step(series, NULL);
		other->model->step(state, NULL);
		one->model->get(series, y);
		other->model->get(state, z);
		worst = worse(worst, fmax(fabs(y[0] - z[0]), fabs(y[1] - z[1])));
		apart += one->crossed(series) != other->crossed(state);
	}
	is_close(worst, 0, 1e-8, "%s: %d steps", name, steps);
	ok(apart == 0 && one->crossed(series) > 7000 && one->model->status(series) == status &&
		   other->model->status(state) == status,
	   "%s: %lu crossings", name, (unsigned long)one->crossed(series));
	free(series);
	free(state);
}

/* ---- x' = max(sin(40 t) - 0.9, 0): each tooth adds its area ---- */

static void check_teeth(const char *name)
{
	enum { SECONDS = 20 };
	const struct variant *v = variant_called(name);
	const double rise = asin(0.9), area = (2 * cos(rise) - 0.9 * (M_PI - 2 * rise)) / 40;
	const int teeth = (int)floor((40 * SECONDS - (M_PI - rise)) / (2 * M_PI)) + 1;
	double y[2];
	void *state = calloc(1, v->model->size);
	v->model->init(state);
	for (int k = 0; k < (int)lround(SECONDS / v->model->h); k++)
		v->model->step(state, NULL);
	v->model->get(state, y);
	is_close(y[0], teeth * area, 1e-12, "%s: %d teeth", name, teeth);
	ok(v->crossed(state) == 2 * (uint64_t)teeth && v->model->status(state) == 0, "%s: %lu crossings", name,
	   (unsigned long)v->crossed(state));
	free(state);
}

/* ---- float ---- */

static void check_float(const pl_modelf *m, const char *name, uint64_t (*crossed)(const void *s))
{
	const struct switched_system *s = switched_systems;
	float y[4];
	double worst = 0, most = 0;
	real truth[HAND_MOST] = {0}, times[64];
	int count = 0, steps = (int)lround(6 / (double)m->h);
	void *state = calloc(1, m->size);
	while (strcmp(s->name, name) != 0)
		s++;
	memcpy(truth, s->start, sizeof s->start);
	place_switched(s, 0, truth);
	m->init(state);
	for (int k = 0; k < steps; k++) {
		m->step(state, NULL);
		m->get(state, y);
		count += follow_switched(s, (real)k * 6 / steps, (real)(k + 1) * 6 / steps, truth, times, 64);
		for (int i = 0; i < s->states; i++) {
			most = fmax(most, (double)fabsl(truth[i]));
			worst = worse(worst, (double)fabsl((real)y[i] - truth[i]));
		}
	}
	is_close(worst / most, 0, 2e-5, "%s in float", name);
	ok((int)crossed(state) == count && m->status(state) == 0, "%s in float: %d crossings", name, count);
	free(state);
}

static uint64_t etd_crossed(const void *s)    { return nested_etdrk4_crossed((const nested_etdrk4 *)s); }
static uint64_t stop_crossed(const void *s)   { return stop_float_crossed((const stop_float *)s); }
static uint64_t circle_crossed(const void *s) { return circle_float_crossed((const circle_float *)s); }
static uint64_t nested_crossed(const void *s) { return nested_float_crossed((const nested_float *)s); }
static uint64_t stop_radau_crosses(const void *s)   { return stop_radau_crossed((const stop_radau *)s); }
static uint64_t stop_auto_crosses(const void *s)    { return stop_auto_crossed((const stop_auto *)s); }
static uint64_t nested_radau_crosses(const void *s) { return nested_radau_crossed((const nested_radau *)s); }
static uint64_t circle_auto_crosses(const void *s)  { return circle_auto_crossed((const circle_auto *)s); }

int main(void)
{
	check_float(&nested_etdrk4_model, "nested", etd_crossed);
	check_float(&stop_float_model, "stop_cubic", stop_crossed);
	check_float(&circle_float_model, "circle", circle_crossed);
	check_float(&nested_float_model, "nested", nested_crossed);
	check_float(&stop_radau_model, "stop_cubic", stop_radau_crosses);
	check_float(&stop_auto_model, "stop_cubic", stop_auto_crosses);
	check_float(&nested_radau_model, "nested", nested_radau_crosses);
	check_float(&circle_auto_model, "circle", circle_auto_crosses);
	check_drag("drag_0");
	check_drag("drag_fixed_0");
	check_drag("drag_radau_0");
	check_drag("drag_auto_0");
	check_odd_square("odd_square_0", 1e-14);
	check_odd_square("odd_square_fixed_0", 1e-14);
	check_odd_square("odd_square_radau_0", 1e-12);
	check_odd_square("odd_square_auto_0", 1e-14);
	check_inputs("held_0", false, 1e-11);
	check_inputs("ramped_0", true, 1e-11);
	check_inputs("held_etd_0", false, 1e-6);
	check_inputs("ramped_etd_0", true, 1e-6);
	check_inputs("held_radau_0", false, 1e-11);
	check_inputs("ramped_radau_0", true, 1e-11);
	check_inputs("held_auto_0", false, 1e-11);
	check_inputs("ramped_auto_0", true, 1e-11);
	check_ringing("ringing_radau_0", 700, 0);
	check_ringing("ringing_auto_0", 700, 0);
	check_ringing("ringing_radau_0", 1500, PL_TOO_MANY_EVENTS);
	check_ringing("ringing_auto_0", 1500, PL_TOO_MANY_EVENTS);
	check_teeth("teeth_0");
	check_teeth("teeth_radau_0");
	check_teeth("teeth_auto_0");
	return tap_end();
}
