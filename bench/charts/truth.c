/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the charts compare with, by two roads.
 *
 *   linear         e^{A t} in quadruple precision (33 digits), loads carried as states: no error that a double could
 *                  see.
 *   not linear     the equations by hand, by extrapolation in quadruple precision (gragg.h), whose steps shrink at the
 *                  kinks of the half car.
 *   the beams      by Taylor series on their matrices' decimals (quad_beam.c).
 *   clearances     the equations by hand, by Taylor series between crossings in long double (tests/switching/hand.c).
 *   what has none of these: NAME_rhs, in double, by such extrapolation.
 *
 * The second road is another method on NAME_rhs in double; how far the two are apart is the truth's `agreement`, and
 * says how good that method is as much as how good the truth is. */
#include "charts.h"
#include "gears.h"
#include "quad_beam.h"

#include "../../tests/remainder/elliptic.h"

#include <math.h>
#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

#define EXPONENTIAL_REAL quad
#include "taylor_exponential.h"

enum { MOST = 64 };                 /* entries of a state, load states included */

/* ---- linear: closed form ---- */

struct flow { int size; quad A[MOST * MOST]; };

void quad_exponential(int n, const quad *A, quad tau, quad *E)
{
	taylor_exponential(n, A, tau, E);
}

/* y' = A y + b0 z0 + b1 z1 + b2 z2, z = 1, cos w t, sin w t */
static void flow_of_asked(const struct problem *p, struct flow *f, quad w)
{
	const int size = 2 * p->n, n = f->size = size + 3;
	memset(f->A, 0, sizeof f->A);
	for (int i = 0; i < size; i++) {
		for (int j = 0; j < size; j++)
			f->A[i * n + j] = exactly(p->A[i * size + j]);
		f->A[i * n + size] = exactly(p->b0[i]);
		f->A[i * n + size + 1] = exactly(p->b1[i]);
		f->A[i * n + size + 2] = exactly(p->b2[i]);
	}
	f->A[(size + 1) * n + size + 2] = -w;
	f->A[(size + 2) * n + size + 1] = w;
}

/* models/tuned_floor.spec: its numbers are irrational, so no decimal that was asked for will do. */
static quad floor_by_hand(struct flow *f)
{
	const quad m = 20000, mu = 0.02Q, w0 = 4 * M_PIq, md = mu * m, wd = w0 / (1 + mu);
	const quad k = m * w0 * w0, c = 2 * 0.01Q * w0 * m, kd = md * wd * wd,
		cd = 2 * md * wd * sqrtq(3 * mu / (8 * (1 + mu) * (1 + mu) * (1 + mu)));
	const int n = f->size;
	quad *a = f->A + 2 * n, *b = f->A + 3 * n;
	a[0] = -(k + kd) / m, a[1] = kd / m, a[2] = -(c + cd) / m, a[3] = cd / m, a[6] = 400 / m;
	b[0] = kd / md, b[1] = -kd / md, b[2] = cd / md, b[3] = -cd / md;
	return w0;
}

/* What was asked must be it, rounded. */
static void compare_asked(const struct problem *p, const struct flow *f)
{
	const int size = 2 * p->n;
	for (int i = 0; i < size; i++) {
		quad most = 0;
		for (int j = 0; j < size; j++)
			most = fmaxq(most, fabsq(f->A[i * f->size + j]));
		for (int j = 0; j < size; j++)
			if (fabsq(f->A[i * f->size + j] - (quad)p->A[i * size + j]) > 1e-15Q * most)
				leave(p->name, "its right-hand side has another matrix");
	}
}

static void apply(int n, const quad *E, const quad *x, quad *y)
{
	for (int i = 0; i < n; i++) {
		y[i] = 0;
		for (int j = 0; j < n; j++)
			y[i] += E[i * n + j] * x[j];
	}
}

void truth_of_linear(const struct problem *p, struct truth *t)
{
	static struct flow f;
	static quad whole[MOST * MOST], part[MOST * MOST];
	const int size = 2 * p->n;
	quad x[MOST] = { 0 }, y[MOST];
	flow_of_asked(p, &f, exactly(p->w));
	if (strcmp(p->name, "tuned_floor") == 0) {
		const quad w = floor_by_hand(&f);
		f.A[(size + 1) * f.size + size + 2] = -w;
		f.A[(size + 2) * f.size + size + 1] = w;
	}
	compare_asked(p, &f);
	quad_exponential(f.size, f.A, exactly(p->unit), whole);
	quad_exponential(f.size, f.A, exactly(p->unit) * TRUTH_BETWEEN, part);
	for (int i = 0; i < size; i++)
		x[i] = exactly(p->start[i]);
	x[size] = x[size + 1] = 1;
	for (int k = 0; k < p->units; k++) {
		apply(f.size, part, x, y);
		for (int i = 0; i < size; i++)
			t->between[k * size + i] = (double)y[i];
		apply(f.size, whole, x, y);
		memcpy(x, y, sizeof x);
		for (int i = 0; i < size; i++)
			t->at_end[k * size + i] = (double)x[i];
	}
}

/* ---- what is not linear: extrapolation ---- */

/* The equations a second time, as they are written in the models' specs: they share nothing with plgen or NAME_rhs.
 * x, z: coordinates; v, w: their velocities; a: the accelerations */
#define BY_HAND(NAME, N, ...) \
static void NAME(const struct problem *of, quad t, const quad *y, quad *f) \
{ \
	const quad x = y[0], z = y[(N) - 1], v = y[N], w = y[2 * (N) - 1]; \
	quad *a = f + (N); \
	(void)of, (void)t, (void)x, (void)z, (void)v, (void)w; \
	memcpy(f, y + (N), (N) * sizeof *f); \
	__VA_ARGS__; \
}
#define DRAGGED(q, v) (0.1Q * v * sqrtq(v * v + 0.01Q) + q + q * q * q)
BY_HAND(pendulum, 1, a[0] = -sinq(x))
BY_HAND(vanderpol, 1, a[0] = (1 - x * x) * v - x)
BY_HAND(vanderpol_stiff, 1, a[0] = 100 * (1 - x * x) * v - x)
BY_HAND(vanderpol_stiffer, 1, a[0] = 1000 * (1 - x * x) * v - x)
BY_HAND(rayleigh, 1, a[0] = (1 - v * v) * v - x)
BY_HAND(duffing, 1, a[0] = 0.5Q * cosq(1.4Q * t) - 0.2Q * v - x - x * x * x)
BY_HAND(mathieu, 1, a[0] = (0.4Q * cosq(2 * t) - 1) * x - 0.1Q * v)
BY_HAND(henon_heiles, 2, a[0] = -x - 2 * x * z; a[1] = z * z - x * x - z)
BY_HAND(coupled_vanderpol, 2, const quad p = 0.3Q * (z - x); a[0] = (1 - x * x) * v - x + p;
        a[1] = (1 - z * z) * w - 1.2Q * z - p)
BY_HAND(double_pendulum, 2, const quad s = sinq(x - z), c = cosq(x - z), p = s * w * w + 2 * sinq(x),
        q = s * v * v - sinq(z), m = 2 - c * c; a[0] = -(p + c * q) / m; a[1] = (2 * q + c * p) / m)
BY_HAND(duffing_pair, 2, const quad p = 0.5Q * (z - x); a[0] = 0.5Q * cosq(1.2Q * t) + p - DRAGGED(x, v);
        a[1] = -p - DRAGGED(z, w))
BY_HAND(spherical_pendulum, 2, const quad s = sinq(x), c = cosq(x); a[0] = s * c * w * w - s;
        a[1] = -2 * v * w * c / s)

/* bench/charts/specs/half_car_lifting.spec: its ramp is met by the rear axle 0.26 s after the front one */
static quad half_car_strut(quad stiffness, quad top, quad speed, quad wheel, quad wheel_speed)
{
	const quad draw = speed - wheel_speed;
	return stiffness * (top - wheel) + (draw > 0 ? 2400 : 800) * draw;
}

static quad half_car_tyre(quad since, quad wheel)
{
	const quad road = since < 0 ? 0 : since < 0.04Q ? 3.75Q * since : 0.15Q;
	return 180000 * fmaxq(road - wheel, 0);
}

static void half_car_lifting(const struct problem *p, quad t, const quad *y, quad *dydt)
{
	(void)p;
	const quad g = 9.81Q, heave = y[0], pitch = y[1], *v = y + 4,
		front = half_car_strut(18000, heave - 1.1Q * pitch, v[0] - 1.1Q * v[1], y[2], v[2]),
		rear = half_car_strut(20000, heave + 1.5Q * pitch, v[0] + 1.5Q * v[1], y[3], v[3]);
	memcpy(dydt, v, 4 * sizeof *v);
	dydt[4] = -(front + rear) / 600 - g;
	dydt[5] = (1.1Q * front - 1.5Q * rear) / 900;
	dydt[6] = (front + half_car_tyre(t, y[2])) / 40 - g;
	dydt[7] = (rear + half_car_tyre(t - 0.26Q, y[3])) / 40 - g;
}

static void as_emitted(const struct problem *p, quad t, const quad *y, quad *dydt)
{
	double narrow[MOST], slope[MOST];
	for (int i = 0; i < 2 * p->n; i++)
		narrow[i] = (double)y[i];
	problem_slope(p, (double)t, narrow, slope);
	for (int i = 0; i < 2 * p->n; i++)
		dydt[i] = slope[i];
}

typedef void equations(const struct problem *p, quad t, const quad *y, quad *dydt);

#define ROW(NAME) { #NAME, NAME }
static const struct by_hand { const char *name; equations *slopes; } by_hand[] = {
	ROW(pendulum), ROW(vanderpol), ROW(vanderpol_stiff), ROW(vanderpol_stiffer), ROW(rayleigh), ROW(duffing),
	ROW(mathieu), { "quad2dof", henon_heiles }, ROW(henon_heiles), ROW(coupled_vanderpol), ROW(double_pendulum),
	ROW(duffing_pair), ROW(spherical_pendulum), ROW(half_car_lifting),
};

/* NULL: it is not here */
static equations *equations_of(const struct problem *p)
{
	for (size_t i = 0; i < sizeof by_hand / sizeof *by_hand; i++)
		if (strcmp(by_hand[i].name, p->name) == 0)
			return by_hand[i].slopes;
	return NULL;
}

double truth_slopes_off(const struct problem *p, double t, const double *y)
{
	quad wide[MOST], f[MOST];
	double slope[MOST], most = 0, size = 0;
	equations *slopes = equations_of(p);
	if (!slopes)
		return 0;
	for (int i = 0; i < 2 * p->n; i++)
		wide[i] = y[i];
	slopes(p, t, wide, f);
	problem_slope(p, t, y, slope);
	for (int i = 0; i < 2 * p->n; i++) {
		most = fmax(most, fabs((double)(f[i] - slope[i])));
		size = fmax(size, fabs(slope[i]));
	}
	return most / size;
}

struct road { const struct problem *p; equations *slopes; };
#define GRAGG_REAL quad
#define GRAGG_TYPE const struct road
#define GRAGG_SLOPES(x, t, y, f) (x)->slopes((x)->p, t, y, f)
#include "gragg.h"

/* With errors of a step below the tolerance, relative to the scales */
static void extrapolated(const struct problem *p, equations *slopes, quad tolerance, struct truth *t)
{
	const struct road road = { p, slopes };
	const quad unit = exactly(p->unit);
	bool velocity[MOST];
	struct gragg g = { .size = 2 * p->n, .velocity = velocity, .tolerance = tolerance, .h = unit / 10,
	                   .least = 1e-12Q, .scale = { 1e-3Q, 1e-3Q }, .parts = 16, .most = 1000000000 };
	quad y[MOST] = { 0 };
	for (int i = 0; i < g.size; i++) {
		velocity[i] = i >= p->n;
		y[i] = exactly(p->start[i]);
	}
	keep_scales(&g, y);
	for (int k = 0; k < p->units; k++) {
		const quad inside = (k + (quad)TRUTH_BETWEEN) * unit;
		bool good = walk_to(&road, &g, k * unit, inside, y);
		for (int i = 0; i < g.size; i++)
			t->between[k * g.size + i] = (double)y[i];
		good = good && walk_to(&road, &g, inside, (k + 1) * unit, y);
		if (!good)
			leave(p->name, "the extrapolation gives up");
		for (int i = 0; i < g.size; i++)
			t->at_end[k * g.size + i] = (double)y[i];
	}
	/* over all steps: a jump's peak lies between the ends of units */
	t->scale_q = (double)g.scale[0];
	t->scale_v = (double)g.scale[1];
}

/* ---- clearances: Taylor series between crossings, in long double ---- */

static void between_crossings(const struct problem *p, struct truth *t)
{
	const int size = 2 * p->n;
	const real unit = (real)exactly(p->unit);
	struct hand_system s;
	struct hand_state now;
	gears_of(p->name, &s);
	hand_start(&s, &now);
	for (int k = 0; k < p->units; k++) {
		hand_reference(&s, &now, (k + (real)TRUTH_BETWEEN) * unit);
		for (int i = 0; i < size; i++)
			t->between[k * size + i] = (double)now.y[i];
		hand_reference(&s, &now, (k + 1) * unit);
		for (int i = 0; i < size; i++)
			t->at_end[k * size + i] = (double)now.y[i];
	}
}

/* ---- the two roads ---- */

struct truth *truth_new(const struct problem *p)
{
	const size_t size = (size_t)p->units * 2 * (size_t)p->n;
	struct truth *t = room_for(1, sizeof *t);
	t->n = p->n;
	t->units = p->units;
	t->at_end = room_for(size, sizeof *t->at_end);
	t->between = room_for(size, sizeof *t->between);
	return t;
}

/* The problem learns them too: the second road is an integrator whose tolerances stand on them. */
void truth_scales(struct problem *p, struct truth *t)
{
	for (int k = -1; k < p->units; k++)
		for (int i = 0; i < 2 * p->n; i++) {
			const double now = fabs(k < 0 ? p->start[i] : t->at_end[k * 2 * p->n + i]);
			double *scale = i < p->n ? &t->scale_q : &t->scale_v;
			*scale = fmax(*scale, now);
		}
	p->scale_q = t->scale_q;
	p->scale_v = t->scale_v;
}

double truth_farther(double most, const struct truth *t, int k, const double *y)
{
	for (int i = 0; i < 2 * t->n; i++) {
		const double off = fabs(y[i] - t->at_end[k * 2 * t->n + i]) / (i < t->n ? t->scale_q : t->scale_v);
		most = off <= most ? most : off;
	}
	return most;
}

static double elliptic_difference(const struct problem *p, const struct truth *t)
{
	double most = 0, y[2];
	for (int k = 0; k < p->units; k++) {
		pendulum_swing(p->start[0], (k + 1) * p->unit, y);
		most = truth_farther(most, t, k, y);
	}
	return most;
}

static double difference_at(const struct problem *p, const struct truth *t, const struct method *method,
							double tolerance)
{
	struct run *run = method->open(method, p, tolerance);
	double row[MOST], most = 0;
	bool good = run;
	for (int k = 0; k < p->units && good; k++) {
		good = run->advance(run, 1, row);
		most = truth_farther(most, t, k, row);
	}
	if (run)
		run->close(run);
	return good ? most : NAN;
}

/* Another integrator in double: where tolerances are that tight, rounding decides which of them is best, and the best
 * is taken. fixed: with so many steps a unit, where they end on stability, not on accuracy, and its control lets errors
 * of 1e-9 pass. */
static double solver_difference(const struct problem *p, const struct truth *t, bool fixed)
{
	const struct method *method = method_find(fixed ? "GSL rk8pd (fixed step)" : "GSL rk8pd");
	double least = NAN;
	if (method && fixed)
		return difference_at(p, t, method, p->unit / 40);
	for (int digits = 12; method && digits <= 15; digits++)
		least = fmin(least, difference_at(p, t, method, pow(10, -digits)));
	return least;
}

/* NAME_rhs in double, its sums and times in quadruple precision: for what was solved in closed form */
static double extrapolation_difference(const struct problem *p, const struct truth *t)
{
	struct truth *other = truth_new(p);
	extrapolated(p, as_emitted, 1e-15Q, other);
	const double most = truth_error(t, other->at_end);
	truth_free(other);
	return most;
}

static void solve(struct problem *p, struct truth *t)
{
	equations *slopes = equations_of(p);
	if (p->linear) {
		t->roads = "closed form in quadruple precision; NAME_rhs by extrapolation in quadruple precision";
		truth_of_linear(p, t);
		truth_scales(p, t);
		t->agreement = extrapolation_difference(p, t);
		return;
	}
	if (gears_of(p->name, NULL)) {
		t->roads = "by hand: Taylor series between crossings in long double; NAME_rhs by GSL rk8pd";
		between_crossings(p, t);
	} else if (quad_beam_has(p)) {
		t->roads = "by hand: Taylor series in quadruple precision; NAME_rhs by GSL rk8pd";
		quad_beam(p, t);
	} else if (slopes) {
		t->roads = "by hand: extrapolation in quadruple precision; NAME_rhs by GSL rk8pd";
		extrapolated(p, slopes, slopes == half_car_lifting ? 1e-18Q : 1e-22Q, t);
	} else {
		t->roads = "NAME_rhs: extrapolation in quadruple precision; GSL rk8pd";
		extrapolated(p, as_emitted, 1e-16Q, t);
	}
	truth_scales(p, t);
	t->agreement = solver_difference(p, t, quad_beam_has(p));
	if (strcmp(p->name, "pendulum") == 0) {
		t->roads = "by hand: extrapolation in quadruple precision; NAME_rhs by GSL rk8pd; elliptic function";
		t->agreement = fmax(t->agreement, elliptic_difference(p, t));
	}
}

struct truth *truth_of(struct problem *p)
{
	if (2 * p->n + 3 > MOST)
		leave(p->name, "truth: too many coordinates");
	struct truth *t = truth_new(p);
	say_progress("%s: truth", p->name);
	solve(p, t);
	return t;
}

double truth_error(const struct truth *t, const double *rows)
{
	double most = 0;
	for (int k = 0; k < t->units; k++)
		most = truth_farther(most, t, k, rows + k * 2 * t->n);
	return most;
}

void truth_free(struct truth *t)
{
	free(t->at_end);
	free(t->between);
	free(t);
}

/* ---- errors ---- */

static void compare(const struct truth *t, const double *y, const double *with, double *q, double *v, bool *failed)
{
	for (int i = 0; i < 2 * t->n; i++) {
		const double off = fabs(y[i] - with[i]) / (i < t->n ? t->scale_q : t->scale_v);
		double *most = i < t->n ? q : v;
		if (!isfinite(off))
			*failed = true;
		else
			*most = fmax(*most, off);
	}
}

struct error error_of(struct run *run, const struct truth *t)
{
	struct error e = { 0 };
	const int size = 2 * t->n;
	/* what goes aside from each output anew takes as long as the history itself: of large models a part will do */
	const int every = size > 12 && t->units > 1000 ? 8 : 1;
	double y[MOST];
	run->restart(run);
	for (int k = 0; k < t->units && !e.failed; k++) {
		if (k % every == 0) {
			run->between(run, TRUTH_BETWEEN, y);
			compare(t, y, t->between + k * size, &e.q_between, &e.v_between, &e.failed);
		}
		if (!run->advance(run, 1, y))
			e.failed = true;
		compare(t, y, t->at_end + k * size, &e.q_end, &e.v_end, &e.failed);
	}
	e.largest = fmax(fmax(e.q_end, e.q_between), fmax(e.v_end, e.v_between));
	return e;
}
