/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Methods of fixed step compiled together with the right-hand sides of the smooth models (equations.h), as plgen's step
 * is; fixed.c's go through NAME_rhs, a pointer. Symplectic Runge-Kutta-Nystrom methods of high order too, for models
 * whose forces depend on coordinates alone. Any other problem: they cannot.
 *
 * A step is a part of a unit, or several units: then rows inside it are read from the polynomial of degree 5 through
 * coordinates, velocities and accelerations at its ends (Hermite), and the velocities from its slope. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "charts.h"
#include "equations.h"

enum { MOST_COORDINATES = 2, BLANES_MOAN = 11, KAHAN_LI = 17 };

/* SRKN_11^b, order 6: Blanes and Moan, Journal of Computational and Applied Mathematics 142 (2002), table 3; the first
 * half, the middle ones by their sums */
#define BM_A (0.123229775946271 + 0.290553797799558 - 0.127049212625417 - 0.246331761062075 + 0.357208872795928)
#define BM_B (0.0414649985182624 + 0.198128671918067 - 0.0400061921041533 + 0.0752539843015807 - 0.0115113874206879)
static const double blanes_moan_drift[] = { 0.123229775946271, 0.290553797799558, -0.127049212625417,
	-0.246331761062075, 0.357208872795928, 1.0 - 2.0 * BM_A };
static const double blanes_moan_kick[] = { 0.0414649985182624, 0.198128671918067, -0.0400061921041533,
	0.0752539843015807, -0.0115113874206879, 0.5 - BM_B };

/* Order 8, 17 velocity Verlets: Kahan and Li, Mathematics of Computation 66 (1997), s17odr8a */
#define KL1 0.13020248308889008087881763
#define KL2 0.56116298177510838456196441
#define KL3 -0.38947496264484728640807860
#define KL4 0.15884190655515560089621075
#define KL5 -0.39590389413323757733623154
#define KL6 0.18453964097831570709183254
#define KL7 0.25837438768632204729397911
#define KL8 0.29501172360931029887096624
#define KL9 -0.60550853383003451169892108
static const double kahan_li_drift[] = { KL1, KL2, KL3, KL4, KL5, KL6, KL7, KL8, KL9 };
static const double kahan_li_kick[] = { KL1 / 2, (KL1 + KL2) / 2, (KL2 + KL3) / 2, (KL3 + KL4) / 2, (KL4 + KL5) / 2,
	(KL5 + KL6) / 2, (KL6 + KL7) / 2, (KL7 + KL8) / 2, (KL8 + KL9) / 2 };

typedef void march_function(double t0, double unit, int units, int steps, double h, double *state, double *rows);

enum which { RK4, HEUN, VERLET, ALL_FORCES, BLANES_MOAN_6 = ALL_FORCES, KAHAN_LI_8, METHODS };
struct inlined;
typedef void stride_function(struct inlined *r, int units, double fraction, double *rows);
struct instance {
	const char *name;
	march_function *march[METHODS];
	stride_function *stride[METHODS];       /* NULL: none */
	void (*slopes)(double t, const double *y, double *f);
};
struct kind {
	struct method method;           /* first: a pointer to it is a pointer to this */
	enum which which;
	int evaluations;                /* a step */
};

struct inlined {
	struct run run;
	const struct instance *instance;
	march_function *march;
	stride_function *stride;
	int steps, span;                /* in a unit; or 0, and units in a step */
	double h;
	long units;                     /* gone since the start */
	double state[3 * MOST_COORDINATES];     /* at the end of the last step */
	/* of a step over several units: its start, its polynomial, how many of them are gone, and the state there */
	double from[3 * MOST_COORDINATES], bend[MOST_COORDINATES][4], now[2 * MOST_COORDINATES];
	int inside;
};

/* ---- steps for one right-hand side, which an instance below compiles into them ---- */

enum { MOST_SIZE = 2 * MOST_COORDINATES };
typedef void slopes_function(double t, const double *y, double *f);
typedef void step_function(const int size, slopes_function *slopes, double t, double h, double *state);

#define EXPLICIT_UNROLLED
#define EXPLICIT_TYPE slopes_function
#define EXPLICIT_MOST MOST_SIZE
#define EXPLICIT_SLOPES(slopes, t, y, f) slopes(t, y, f)
#include "explicit_step.h"

/* Over several units, with the slope that the next one begins with */
INLINE void rk4_long(const int size, slopes_function *slopes, double t, double h, double *state)
{
	const int n = size / 2;
	double k1[MOST_SIZE];
	EACH(size)
		k1[m] = state[n + m];
	rk4_from(size, slopes, t, h, state, k1);
	slopes(t + h, state, k1);
	EACH(n)
		state[size + m] = k1[n + m];
}

/* Kicks b h and drifts a h in turns, symmetric: a kick first and last, so that its force is kept */
INLINE void turns(const int size, slopes_function *slopes, double t, double h, double *state, const int drifts,
				  const double *drift, const double *kick)
{
	const int n = size / 2;
	double *q = state, *v = state + n, *a = state + size, f[MOST_SIZE];
	_Pragma("GCC unroll 20") for (int i = 0; i < drifts; i++) {
		const double kick_now = kick[i <= drifts / 2 ? i : drifts - i];
		const double drift_now = drift[i <= drifts / 2 ? i : drifts - 1 - i];
		EACH(n) {
			v[m] += kick_now * h * a[m];
			q[m] += drift_now * h * v[m];
		}
		slopes(t, state, f);
		EACH(n)
			a[m] = f[n + m];
	}
	EACH(n)
		v[m] += kick[0] * h * a[m];
}

INLINE void blanes_moan_step(const int size, slopes_function *slopes, double t, double h, double *state)
{
	turns(size, slopes, t, h, state, BLANES_MOAN, blanes_moan_drift, blanes_moan_kick);
}

INLINE void kahan_li_step(const int size, slopes_function *slopes, double t, double h, double *state)
{
	turns(size, slopes, t, h, state, KAHAN_LI, kahan_li_drift, kahan_li_kick);
}

/* The coordinates' polynomial of degree 5 through both ends of a step, their velocities and accelerations, in the part
 * of the step */
INLINE void join(const int n, double h, const double *from, const double *to, double bend[][4])
{
	EACH(n) {
		const double v = h * from[n + m], a = 0.5 * h * h * from[2 * n + m];
		const double end = to[m] - from[m] - v - a, end_v = h * to[n + m] - v - 2.0 * a,
			end_a = h * h * to[2 * n + m] - 2.0 * a;
		bend[m][0] = a;
		bend[m][1] = 10.0 * end - 4.0 * end_v + 0.5 * end_a;
		bend[m][2] = -15.0 * end + 7.0 * end_v - end_a;
		bend[m][3] = 6.0 * end - 3.0 * end_v + 0.5 * end_a;
	}
}

INLINE void join_at(const int n, const struct inlined *r, double s, double *y)
{
	const double over = 1.0 / r->h;
	EACH(n) {
		const double *b = r->bend[m], v = r->h * r->from[n + m];
		y[m] = r->from[m] + s * (v + s * (b[0] + s * (b[1] + s * (b[2] + s * b[3]))));
		y[n + m] = over * (v + s * (2.0 * b[0] + s * (3.0 * b[1] + s * (4.0 * b[2] + s * 5.0 * b[3]))));
	}
}

INLINE void march(const int n, slopes_function *slopes, step_function *step, double t0, double unit, int units,
				  int steps, double h, double *state, double *rows)
{
	double s[3 * MOST_COORDINATES];
	_Pragma("GCC unroll 8") for (int m = 0; m < 3 * n; m++)
		s[m] = state[m];
	for (int u = 0; u < units; u++) {
		const double t = t0 + u * unit;
		for (int k = 0; k < steps; k++)
			step(2 * n, slopes, t + k * h, h, s);
		for (int m = 0; m < 2 * n && rows; m++)
			rows[(ptrdiff_t)u * 2 * n + m] = s[m];
	}
	_Pragma("GCC unroll 8") for (int m = 0; m < 3 * n; m++)
		state[m] = s[m];
}

/* A step of `span` units; rows inside it from its polynomial, at its end the state. `fraction` of the next unit if
 * units is 0 */
INLINE void stride(const int n, slopes_function *slopes, step_function *step, struct inlined *r, int units,
				   double fraction, double *rows)
{
	const double over = 1.0 / r->span;
	for (int u = 0; u < units || (units == 0 && u == 0); u++) {
		if (r->inside == 0) {
			memcpy(r->from, r->state, sizeof r->from);
			step(2 * n, slopes, (double)r->units * r->run.problem->unit, r->h, r->state);
			join(n, r->h, r->from, r->state, r->bend);
		}
		if (units > 0) {
			r->inside = r->inside + 1 == r->span ? 0 : r->inside + 1;
			r->units++;
		}
		double *row = rows ? rows + (ptrdiff_t)u * 2 * n : r->now;
		if (units > 0 && r->inside == 0)
			memcpy(row, r->state, 2 * (size_t)n * sizeof *row);
		else
			join_at(n, r, (r->inside + fraction) * over, row);
		if (rows && u == units - 1)
			memcpy(r->now, row, 2 * (size_t)n * sizeof *row);
	}
}

/* ---- the instances ---- */

#define MARCH(NAME, N, METHOD) \
static void NAME##_##METHOD(double t0, double unit, int units, int steps, double h, double *state, double *rows) \
{ \
	march(N, NAME##_slopes, METHOD##_step, t0, unit, units, steps, h, state, rows); \
}
#define STRIDE(NAME, N, METHOD, STEP) \
static void NAME##_##METHOD##_stride(struct inlined *r, int units, double fraction, double *rows) \
{ \
	stride(N, NAME##_slopes, STEP, r, units, fraction, rows); \
}
#define INSTANCE(NAME, N) \
MARCH(NAME, N, rk4) MARCH(NAME, N, heun) MARCH(NAME, N, verlet) MARCH(NAME, N, blanes_moan) MARCH(NAME, N, kahan_li) \
STRIDE(NAME, N, rk4, rk4_long) STRIDE(NAME, N, verlet, verlet_step) \
STRIDE(NAME, N, blanes_moan, blanes_moan_step) STRIDE(NAME, N, kahan_li, kahan_li_step) \
static void NAME##_at(double t, const double *y, double *f) \
{ \
	NAME##_slopes(t, y, f); \
}
EQUATIONS(INSTANCE)
#define ROW(NAME, N) { #NAME, { NAME##_rk4, NAME##_heun, NAME##_verlet, NAME##_blanes_moan, NAME##_kahan_li }, \
	               { NAME##_rk4_stride, NULL, NAME##_verlet_stride, NAME##_blanes_moan_stride, \
	                 NAME##_kahan_li_stride }, NAME##_at },
static const struct instance instances[] = { EQUATIONS(ROW) };
#define LISTED(NAME, N) #NAME,
static const char *const without_velocity[] = { EQUATIONS_WITHOUT_VELOCITY(LISTED) };

static const struct kind *kind_of(const struct run *run)
{
	return (const struct kind *)run->method;
}

static void inlined_restart(struct run *run)
{
	struct inlined *r = (struct inlined *)run;
	const int n = run->problem->n;
	double f[2 * MOST_COORDINATES];
	memcpy(r->state, run->problem->start, 2 * (size_t)n * sizeof *r->state);
	r->instance->slopes(0.0, r->state, f);
	memcpy(r->state + 2 * n, f + n, (size_t)n * sizeof *f);
	memcpy(r->now, r->state, sizeof r->now);
	r->units = r->inside = 0;
}

static bool inlined_advance(struct run *run, int units, double *rows)
{
	struct inlined *r = (struct inlined *)run;
	const double unit = run->problem->unit;
	if (r->stride) {
		r->stride(r, units, 0.0, rows);
		return all_finite(2 * run->problem->n, r->state);
	}
	r->march((double)r->units * unit, unit, units, r->steps, r->h, r->state, rows);
	r->units += units;
	return all_finite(2 * run->problem->n, r->state);
}

/* Whole steps, then one of what is left of `fraction` */
static void inlined_between(struct run *run, double fraction, double *y)
{
	const struct inlined *r = (const struct inlined *)run;
	const double t = (double)r->units * run->problem->unit, unit = run->problem->unit;
	const int whole = (int)floor(fraction * r->steps + 1e-9);
	const double rest = fraction * unit - whole * r->h;
	double ahead[3 * MOST_COORDINATES];
	if (r->stride) {
		struct inlined copy = *r;
		r->stride(&copy, 0, fraction, y);
		return;
	}
	memcpy(ahead, r->state, sizeof ahead);
	r->march(t, unit, 1, whole, r->h, ahead, NULL);
	if (rest > 1e-9 * r->h)
		r->march(t + whole * r->h, unit, 1, 1, rest, ahead, NULL);
	memcpy(y, ahead, 2 * (size_t)run->problem->n * sizeof *y);
}

static long inlined_evaluations(const struct run *run)
{
	const struct inlined *r = (const struct inlined *)run;
	const long steps = r->stride ? (r->units + r->span - 1) / r->span : r->units * r->steps;
	return steps * kind_of(run)->evaluations;
}

static void inlined_close(struct run *run)
{
	free(run);
}

static const struct instance *instance_of(const struct problem *p, enum which which)
{
	bool without = which < ALL_FORCES;
	for (size_t i = 0; i < sizeof without_velocity / sizeof *without_velocity; i++)
		without = without || strcmp(without_velocity[i], p->name) == 0;
	for (size_t i = 0; i < sizeof instances / sizeof *instances && without && !p->rhs_of; i++)
		if (strcmp(instances[i].name, p->name) == 0)
			return &instances[i];
	return NULL;
}

static struct run *inlined_open(const struct method *method, const struct problem *problem, double setting)
{
	const struct kind *kind = (const struct kind *)method;
	const struct instance *instance = instance_of(problem, kind->which);
	const double steps = round(problem->unit / setting), span = round(setting / problem->unit);
	if (!instance || !(setting > 0.0) || !(steps <= 1e9) || !(span <= 1e6) ||
	    (span > 1.0 && !instance->stride[kind->which]))
		return NULL;
	struct inlined *r = calloc(1, sizeof *r);
	if (!r)
		return NULL;
	r->run = (struct run){.method = method, .problem = problem, .restart = inlined_restart,
	                      .advance = inlined_advance, .between = inlined_between, .get = run_get,
	                      .evaluations = inlined_evaluations, .close = inlined_close};
	r->instance = instance;
	r->march = instance->march[kind->which];
	r->stride = span > 1.0 ? instance->stride[kind->which] : NULL;
	r->run.now = r->stride ? r->now : r->state;
	r->steps = span > 1.0 ? 0 : (int)steps;
	r->span = (int)span;
	r->run.setting = r->h = span > 1.0 ? span * problem->unit : problem->unit / steps;
	inlined_restart(&r->run);
	return &r->run;
}

/* ---- the list ---- */

#define INLINED_METHOD(NAME, ORDER, SETTINGS) \
	{.name = NAME, .family = FIXED, .order = ORDER, .open = inlined_open, \
	 .settings = "fixed step, also over several outputs, which Hermite's polynomial of degree 5 gives; compiled " \
	             "together with the right-hand side; " SETTINGS}

static const struct kind rk4 = {
	.method = INLINED_METHOD("RK4, inlined", 4, "the classical one; 4 evaluations a step"),
	.which = RK4, .evaluations = 4,
};
static const struct kind heun = {
	.method = INLINED_METHOD("explicit trapezoid, inlined", 2, "Heun; 2 evaluations a step"),
	.which = HEUN, .evaluations = 2,
};
static const struct kind verlet = {
	.method = INLINED_METHOD("central difference, inlined", 2,
	                         "velocity Verlet; forces of velocity are taken at v + h a; 1 evaluation a step"),
	.which = VERLET, .evaluations = 1,
};
static const struct kind blanes_moan = {
	.method = INLINED_METHOD("Blanes-Moan 6", 6,
	                         "symplectic Runge-Kutta-Nystrom, SRKN_11^b of 2002; 11 evaluations a step; where "
	                         "forces depend on coordinates alone"),
	.which = BLANES_MOAN_6, .evaluations = BLANES_MOAN,
};
static const struct kind kahan_li = {
	.method = INLINED_METHOD("Kahan-Li 8", 8,
	                         "symplectic composition of 17 velocity Verlets, s17odr8a of 1997; 17 evaluations a "
	                         "step; where forces depend on coordinates alone"),
	.which = KAHAN_LI_8, .evaluations = KAHAN_LI,
};

const struct method *const inlined_methods[] = {
	&rk4.method, &heun.method, &verlet.method, &blanes_moan.method, &kahan_li.method, NULL,
};
