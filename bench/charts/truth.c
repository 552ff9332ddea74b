/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the charts compare with, by two roads.
 *
 *   linear         e^{A t} in quadruple precision (33 digits), loads carried as states: no error that a double could
 *                  see.
 *   nonlinear      the equations by hand, by Taylor series in quadruple precision (quad_taylor.c); beside it
 *                  (truth_by_extrapolation, which tests hold against it) by extrapolation (Gragg, Bulirsch, Stoer) in
 *                  long double (19 digits).
 *   the beams      the same on their matrices' decimals (quad_beam.c); beside it on matrices found by quadrature of
 *                  their definition (tests/remainder/cantilever.c).
 *   clearances     the equations by hand, by Taylor series between crossings in long double (tests/switching/hand.c).
 *   the half car   the equations by hand, by extrapolation in long double, whose steps shrink at its kinks.
 *   what has none of these: NAME_rhs, in double, by extrapolation in long double.
 *
 * The second road is another method on NAME_rhs in double; how far the two are apart is the truth's `agreement`, and
 * says how good that method is as much as how good the truth is. */
#include "charts.h"
#include "gears.h"
#include "quad_taylor.h"

#include "../../tests/remainder/elliptic.h"

#include <math.h>
#include <quadmath.h>
#include <stdlib.h>
#include <string.h>

#define NUMBER long double
#include "equations.h"

typedef __float128 quad;
#define EXPONENTIAL_REAL quad
#include "taylor_exponential.h"

enum { MOST = 64 };                 /* entries of a state, load states included */

/* 0.01 means 1/100, not the double next to it: a decimal of at most 13 digits is taken as such. */
static quad exactly(double x)
{
	return quad_of_decimal(x);
}

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

/* ---- nonlinear: extrapolation in long double ---- */

struct equations {
	const char *name;
	void (*slopes)(const struct problem *p, real t, const real *y, real *dydt);
	/* relative to the scales; the beams' stiffness (1e8 /s^2) leaves no more to long double */
	real tolerance;
	/* second road: GSL rk8pd with this many fixed steps a unit (the beams: where steps end on stability, not on
	 * accuracy, its control lets errors of 1e-9 pass); 0: by tolerances */
	int parts;
};

#define SMOOTH(NAME, N) \
static void NAME##_of(const struct problem *p, real t, const real *y, real *dydt) \
{ \
	(void)p; \
	NAME##_slopes(t, y, dydt); \
}
EQUATIONS(SMOOTH)

/* tests/remainder/cantilever.h, whose folder has a hand.h of its own */
real cantilever_speed(real Om, real t, real *slope);
void cantilever_slopes(real w, real dw, const real *y, real *dydt);

static void beam(const struct problem *p, real t, const real *y, real *dydt)
{
	real dw, w = cantilever_speed(strcmp(p->name, "beam4") == 0 ? 4 : 15, t, &dw);
	cantilever_slopes(w, dw, y, dydt);
}

/* bench/charts/specs/half_car_lifting.spec: its ramp is met by the rear axle 0.26 s after the front one */
static real half_car_strut(real stiffness, real top, real speed, real wheel, real wheel_speed)
{
	const real draw = speed - wheel_speed;
	return stiffness * (top - wheel) + (draw > 0 ? 2400 : 800) * draw;
}

static real half_car_tyre(real since, real wheel)
{
	const real road = since < 0 ? 0 : since < 0.04L ? 3.75L * since : 0.15L;
	return 180000 * fmaxl(road - wheel, 0);
}

static void half_car_lifting(const struct problem *p, real t, const real *y, real *dydt)
{
	(void)p;
	const real g = 9.81L, heave = y[0], pitch = y[1], *v = y + 4,
		front = half_car_strut(18000, heave - 1.1L * pitch, v[0] - 1.1L * v[1], y[2], v[2]),
		rear = half_car_strut(20000, heave + 1.5L * pitch, v[0] + 1.5L * v[1], y[3], v[3]);
	for (int i = 0; i < 4; i++)
		dydt[i] = v[i];
	dydt[4] = -(front + rear) / 600 - g;
	dydt[5] = (1.1L * front - 1.5L * rear) / 900;
	dydt[6] = (front + half_car_tyre(t, y[2])) / 40 - g;
	dydt[7] = (rear + half_car_tyre(t - 0.26L, y[3])) / 40 - g;
}

static void as_emitted(const struct problem *p, real t, const real *y, real *dydt)
{
	double narrow[MOST], slope[MOST];
	for (int i = 0; i < 2 * p->n; i++)
		narrow[i] = (double)y[i];
	problem_slope(p, (double)t, narrow, slope);
	for (int i = 0; i < 2 * p->n; i++)
		dydt[i] = slope[i];
}

#define SMOOTH_ROW(NAME, N) { #NAME, NAME##_of, 1e-16L, 0 },
static const struct equations by_hand[] = {
	EQUATIONS(SMOOTH_ROW)
	{ "half_car_lifting", half_car_lifting, 1e-16L, 0 },
	{ "beam4", beam, 1e-13L, 40 },
	{ "beam15", beam, 1e-13L, 40 },
	{ NULL, as_emitted, 1e-16L, 0 }
};

struct extrapolation {
	const struct problem *p;
	const struct equations *e;
	int size;
	real step;                      /* proposed [s] */
	real scale_q, scale_v;          /* over the history so far */
};

#define GRAGG_TYPE const struct extrapolation
#define GRAGG_SLOPES(x, t, y, f) (x)->e->slopes((x)->p, t, y, f)
#include "gragg.h"

/* The error is that of order 16, relative to the scales, of what is kept, of order 18. */
static real extrapolated_error(const struct extrapolation *x, real t, real H, const real *y, real *result)
{
	real fewer[MOST], error = 0;
	extrapolate(x, x->size, t, H, y, result, fewer);
	for (int i = 0; i < x->size && error == error; i++) {   /* until one is no number */
		const real off = fabsl(result[i] - fewer[i]) / (i < x->p->n ? x->scale_q : x->scale_v);
		error = off <= error ? error : off;
	}
	return error;
}

static void keep_scales(struct extrapolation *x, const real *y)
{
	for (int i = 0; i < x->p->n; i++) {
		x->scale_q = fmaxl(x->scale_q, fabsl(y[i]));
		x->scale_v = fmaxl(x->scale_v, fabsl(y[x->p->n + i]));
	}
}

static void follow(struct extrapolation *x, real from, real to, real *y)
{
	const real tolerance = x->e->tolerance;
	real result[MOST];
	for (real t = from; t < to;) {
		const bool last = t + 1.01L * x->step >= to;
		const real H = last ? to - t : x->step, error = extrapolated_error(x, t, H, y, result);
		const real factor = error > 0 ? 0.9L * powl(tolerance / error, 1.0L / (2 * COLUMNS - 1)) : 4;
		if (!(error <= tolerance)) {
			x->step = H * (factor > 0.2L && factor < 0.9L ? factor : 0.2L);
			if (x->step < 1e-12L)
				leave(x->p->name, "the extrapolation gives up");
			continue;
		}
		memcpy(y, result, sizeof result);
		keep_scales(x, y);
		t = last ? to : t + H;
		if (!last || factor * H > x->step)
			x->step = H * fminl(factor, 4);
	}
}

static void extrapolated(const struct problem *p, const struct equations *e, struct truth *t)
{
	struct extrapolation x = { .p = p, .e = e, .size = 2 * p->n, .step = (real)p->unit / 10, .scale_q = 1e-3L,
	                           .scale_v = 1e-3L };
	const real unit = (real)exactly(p->unit);
	real y[MOST] = { 0 };
	for (int i = 0; i < x.size; i++)
		y[i] = (real)exactly(p->start[i]);
	keep_scales(&x, y);
	for (int k = 0; k < p->units; k++) {
		const real inside = (k + (real)TRUTH_BETWEEN) * unit;
		follow(&x, k * unit, inside, y);
		for (int i = 0; i < x.size; i++)
			t->between[k * x.size + i] = (double)y[i];
		follow(&x, inside, (k + 1) * unit, y);
		for (int i = 0; i < x.size; i++)
			t->at_end[k * x.size + i] = (double)y[i];
	}
	/* over all steps: a jump's peak lies between the ends of units */
	t->scale_q = (double)x.scale_q;
	t->scale_v = (double)x.scale_v;
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
 * is taken. */
static double solver_difference(const struct problem *p, const struct truth *t, int parts)
{
	const struct method *method = method_find(parts > 0 ? "GSL rk8pd (fixed step)" : "GSL rk8pd");
	double least = NAN;
	if (method && parts > 0)
		return difference_at(p, t, method, p->unit / parts);
	for (int digits = 12; method && digits <= 15; digits++)
		least = fmin(least, difference_at(p, t, method, pow(10, -digits)));
	return least;
}

/* NAME_rhs in double, its sums and times in long double: for what was solved in closed form */
static double extrapolation_difference(const struct problem *p, const struct truth *t)
{
	static const struct equations emitted = { NULL, as_emitted, 1e-15L, 0 };
	struct truth *other = truth_new(p);
	extrapolated(p, &emitted, other);
	const double most = truth_error(t, other->at_end);
	truth_free(other);
	return most;
}

static const struct equations *equations_of(const struct problem *p)
{
	const struct equations *e = by_hand;
	while (e->name && strcmp(e->name, p->name) != 0)
		e++;
	return e;
}

static void solve(struct problem *p, struct truth *t)
{
	const struct equations *e = equations_of(p);
	if (p->linear) {
		t->roads = "closed form in quadruple precision; NAME_rhs by extrapolation in long double";
		truth_of_linear(p, t);
		truth_scales(p, t);
		t->agreement = extrapolation_difference(p, t);
		return;
	}
	if (gears_of(p->name, NULL)) {
		t->roads = "by hand: Taylor series between crossings in long double; NAME_rhs by GSL rk8pd";
		between_crossings(p, t);
	} else if (quad_taylor_has(p)) {
		t->roads = "by hand: Taylor series in quadruple precision; NAME_rhs by GSL rk8pd";
		quad_taylor(p, t);
	} else {
		t->roads = e->name ? "by hand: extrapolation in long double; NAME_rhs by GSL rk8pd"
			: "NAME_rhs: extrapolation in long double; GSL rk8pd";
		extrapolated(p, e, t);
	}
	truth_scales(p, t);
	t->agreement = solver_difference(p, t, gears_of(p->name, NULL) ? 0 : e->parts);
	if (strcmp(p->name, "pendulum") == 0) {
		t->roads = "by hand: Taylor series in quadruple precision; NAME_rhs by GSL rk8pd; elliptic function";
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

struct truth *truth_by_extrapolation(struct problem *p)
{
	struct truth *t = truth_new(p);
	extrapolated(p, equations_of(p), t);
	truth_scales(p, t);
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
