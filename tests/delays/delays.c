/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Delayed inputs: an oscillator against the closed form of what its input is, jump by jump and corner by corner, at
 * step ends and inside of steps; beside a stop and beside a remainder against the model without a delay whose input is
 * given late, in steps of the common part. */
#include "models.h"
#include "tap.h"
#include "worse.h"

#include <math.h>
#include <stdlib.h>

enum { SAMPLES = 80 };
static const double tolerance = 1e-13;

static double sample(int k)
{
	return k < 0 ? 0 : sin(0.7 * k) + (k % 5 == 2) - 0.3;
}

/* Sample k acts from k h on, or is reached at (k + 1) h from 0 */
static long double held(long double t, long double w, double h)
{
	long double x = 0;
	for (int k = 0; k < SAMPLES && k * (long double)h < t; k++)
		x += ((long double)sample(k) - sample(k - 1)) * (1 - cosl(w * (t - k * (long double)h))) / (w * w);
	return x;
}

static long double ramped(long double t, long double w, double h)
{
	long double x = 0;
	for (int k = 0; k < SAMPLES && k * (long double)h < t; k++) {
		const long double slope = ((long double)sample(k) - sample(k - 1)) / h;
		const long double before = k ? ((long double)sample(k - 1) - sample(k - 2)) / h : 0;
		const long double s = t - k * (long double)h;
		x += (slope - before) * (s - sinl(w * s) / w) / (w * w);
	}
	return x;
}

/* Another frequency at the spec's step, and at no other */
static void retune(const pl_model *m, void *s, double h)
{
	const double w = 3;
	ok(m->retune(s, &w, h / 2) == PL_NO_STEP, "%s: another step is refused", m->name);
	ok(m->retune(s, &w, h) == 0, "%s: retuned", m->name);
}

/* h and d as decimals */
static void oscillator(const pl_model *m, bool ramp, long double h, long double d)
{
	void *s = calloc(1, m->size);
	double worst = 0, y[2];
	bool good = true;
	m->init(s);
	if (m->retune)
		retune(m, s, (double)h);
	for (int k = 0; k < SAMPLES; k++) {
		const double u = sample(k);
		for (int part = 1; part <= 4; part++) {
			const long double t = k * h + part * h / 4;
			const long double expected = ramp ? ramped(t, 3, (double)h) - 2 * ramped(t - d, 3, (double)h)
							  : held(t, 3, (double)h) - 2 * held(t - d, 3, (double)h);
			m->at(s, &u, (double)(part * h / 4), y);
			worst = worse(worst, fabs(y[0] - (double)expected));
			good = close_to(y[0], (double)expected, tolerance, "%s, t = %Lg", m->name, t) && good;
		}
		double end[2];
		m->step(s, &u);
		m->get(s, end);
		worst = worse(worst, fabs(end[0] - y[0]));
		good = close_to(end[0], y[0], tolerance, "%s, step %d", m->name, k) && good;
	}
	good = close_to(m->time(s), (double)(SAMPLES * h), 1e-14, "%s: time", m->name) && good;
	ok(good, "%s, d = %Lg: the closed form, to %.2g", m->name, d, worst);
	free(s);
}

/* x' = u(t - d), where u begins with row 0 at once, and begins anew, with a jump, at t = 1: x is the area below it. A
 * held input beside the ramp, v, acts from its own step on, and delayed by 0.1 s no sooner. */
static void jumps(const pl_model *m, long double d)
{
	const long double h = 0.1L;
	void *s = calloc(1, m->size);
	double worst = 0, y[2], row[2] = { sample(1), 5 };
	bool good = true;
	m->init(s);
	m->hold(s, row);
	for (int k = 0; k < 20; k++) {
		const double next[2] = { sample(k + 2), 1 + k };
		const double again[2] = { 4, 0 };
		if (k == 10)
			m->hold(s, again);
		for (int part = 1; part <= 4; part++) {
			const long double t = k * h + part * h / 4;
			long double area = 0, held = 0;
			for (int j = 0; j < 20; j++) {      /* ramps from j h, as far as they have come by then */
				const long double from = j == 10 ? 4 : sample(j + 1), to = sample(j + 2);
				const long double w = fminl(fmaxl(t - d - j * h, 0), h);
				area += from * w + (to - from) * w * w / (2 * h);
				held += (1 + j) * fminl(fmaxl(t - h - j * h, 0), h);
			}
			m->at(s, next, (double)(part * h / 4), y);
			worst = worse(worst, worse(fabs(y[0] - (double)area), fabs(y[1] - (double)held)));
			good = close_to(y[0], (double)area, tolerance, "%s, t = %Lg", m->name, t) && good;
			good = close_to(y[1], (double)held, tolerance, "%s, held, t = %Lg", m->name, t) && good;
		}
		double end[2];
		m->step(s, next);
		m->get(s, end);
		good = close_to(end[0], y[0], tolerance, "%s, step %d", m->name, k) && good;
	}
	ok(good, "%s, d = %Lg: an input that jumps, and one that is held, to %.2g", m->name, d, worst);
	free(s);
}

/* Steps of 0.1 and a delay of 0.25 against steps of 0.05 and an input that is late by 5 of them */
static void late(const pl_model *m, const pl_model *plain, bool ramp)
{
	void *s = calloc(1, m->size), *p = calloc(1, plain->size);
	double worst = 0, y[2], z[2];
	bool good = true;
	m->init(s);
	plain->init(p);
	for (int k = 0; k < SAMPLES; k++) {
		const double u = 3 * sample(k);
		m->step(s, &u);
		for (int part = 0; part < 2; part++) {
			const int at = 2 * k + part - 5 + ramp;     /* in parts: its end, of a ramp */
			const int whole = at < 0 ? -1 : at / 2;
			const double now = 3 * sample(whole - ramp), next = 3 * sample(whole - ramp + 1);
			const double v = at < 0 ? 0 : ramp && at % 2 ? (now + next) / 2 : now;
			plain->step(p, &v);
		}
		m->get(s, y);
		plain->get(p, z);
		for (int i = 0; i < 2; i++) {
			worst = worse(worst, fabs(y[i] - z[i]));
			good = close_to(y[i], z[i], tolerance, "%s, step %d, state %d", m->name, k, i) && good;
		}
	}
	ok(good && fabs(y[0]) > 1e-6, "%s: as with an input that is given late, to %.2g", m->name, worst);
	free(s);
	free(p);
}

int main(void)
{
	oscillator(&held0_25_model, false, 0.1L, 0.25L);
	oscillator(&held0_3_model, false, 0.1L, 0.3L);
	oscillator(&held0_04_model, false, 0.1L, 0.04L);
	oscillator(&held0_1_model, false, 0.1L, 0.1L);
	oscillator(&held1_7_model, false, 0.1L, 1.7L);
	oscillator(&held0_model, false, 0.1L, 0);
	oscillator(&tuned_model, false, 0.1L, 0.25L);
	oscillator(&tuned_ramp_model, true, 0.1L, 0.04L);
	oscillator(&tuned_delay_model, false, 0.1L, 0.3L);      /* by the spec's value of w */
	oscillator(&other_step_model, false, 0.04L, 0.25L);
	oscillator(&ramp0_25_model, true, 0.1L, 0.25L);
	oscillator(&ramp0_3_model, true, 0.1L, 0.3L);
	oscillator(&ramp0_04_model, true, 0.1L, 0.04L);
	oscillator(&ramp0_1_model, true, 0.1L, 0.1L);
	oscillator(&ramp1_7_model, true, 0.1L, 1.7L);
	oscillator(&ramp0_model, true, 0.1L, 0);
	jumps(&jumps0_03_model, 0.03L);
	jumps(&jumps0_1_model, 0.1L);
	jumps(&jumps0_25_model, 0.25L);
	jumps(&jumps0_model, 0);
	late(&stopped_model, &stopped_plain_model, false);
	late(&stopped_ramp_model, &stopped_plain_ramp_model, true);
	late(&bent_model, &bent_plain_model, false);
	late(&bent_ramp_model, &bent_plain_ramp_model, true);
	return tap_end();
}
