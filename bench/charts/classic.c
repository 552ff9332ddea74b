/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The fixed-step methods of the textbooks, written plainly on the right-hand side. A step is unit/k for an integer k.
 * Explicit ones need nothing else. Implicit ones factor their matrix once where the problem is linear, since then
 * f(t, y + d) = f(t, y) + A d; elsewhere they solve by Newton's method. Where forces jump in slope Newton may find
 * nothing: the run has then failed, as it has when the state is no longer finite.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "charts.h"
#include "factors.h"

/* ---- a run ---- */

enum { WORK = 8 }; /* vectors of 2n to work in */

struct fixed {
	struct run run;
	void (*rhs)(double t, const double y[], double dydt[]);
	void (*rhs_of)(const void *of, double t, const double y[], double dydt[]);
	const void *of;
	int n;
	int steps;                  /* in a unit */
	double h;
	long units;                 /* gone since the start */
	long evaluations;
	bool failed;
	double *state;              /* 3n: coordinates, velocities, and the accelerations that some methods keep */
	double *work[WORK];
	struct factors every;       /* of a whole step */
	double scale_q, scale_v;    /* Newton: largest |coordinate| and |velocity| so far */
	double *weight;             /* Newton: 1 over the scale of each unknown */
	double *ahead;              /* `between`: its state and factors, so that the run stays as it is */
	struct factors part;
};

/* One step from t to t + h; false: it cannot */
typedef bool step_function(struct fixed *f, struct factors *s, double t, double h, double *state);

struct way {
	step_function *step;
	bool (*advance)(struct run *run, int units, double *rows);
};

struct classic {
	struct method method;       /* first: a pointer to it is a pointer to this */
	struct way plain, linear;
	bool (*wants_linear)(const struct problem *p); /* NULL: never */
	int unknowns;               /* implicit: 1 for n accelerations, 2 for 2n states; explicit: 0 */
	void (*fill)(const struct problem *p, double h, double *matrix); /* of the linear way */
	bool keeps_acceleration;
};

INLINE void slope(struct fixed *f, double t, const double *y, double *dydt)
{
	f->evaluations++;
	if (f->rhs)
		f->rhs(t, y, dydt);
	else
		f->rhs_of(f->of, t, y, dydt);
}

static const struct classic *classic_of(const struct fixed *f)
{
	return (const struct classic *)f->run.method;
}

static bool is_linear_way(const struct fixed *f)
{
	const struct classic *c = classic_of(f);
	return c->wants_linear && c->wants_linear(f->run.problem);
}

static const struct way *way_of(const struct fixed *f)
{
	return is_linear_way(f) ? &classic_of(f)->linear : &classic_of(f)->plain;
}

static bool all_finite(int size, const double *y)
{
	double zero = 0.0;
	for (int i = 0; i < size; i++)
		zero += 0.0 * y[i];
	return zero == 0.0;
}

/* Inlined into each method's own loop: `step` is then no call */
INLINE bool march(struct run *run, int units, double *rows, step_function *step)
{
	struct fixed *f = (struct fixed *)run;
	const int size = 2 * f->n;
	for (int u = 0; u < units && !f->failed; u++) {
		const double t = (double)f->units * run->problem->unit, h = f->h;
		for (int k = 0; k < f->steps && !f->failed; k++)
			f->failed = !step(f, &f->every, t + k * h, h, f->state);
		f->units++;
		f->failed = f->failed || !all_finite(size, f->state);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * size, f->state, sizeof *rows * (size_t)size);
	}
	return !f->failed;
}

/* ---- explicit methods ---- */

INLINE bool euler_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	const int size = 2 * f->n;
	double *restrict k1 = f->work[0];
	(void)s;
	slope(f, t, state, k1);
	for (int i = 0; i < size; i++)
		state[i] += h * k1[i];
	return true;
}

static bool euler_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, euler_step);
}

INLINE bool heun_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	const int size = 2 * f->n;
	double *restrict k1 = f->work[0], *restrict k2 = f->work[1], *restrict x = f->work[2];
	(void)s;
	slope(f, t, state, k1);
	for (int i = 0; i < size; i++)
		x[i] = state[i] + h * k1[i];
	slope(f, t + h, x, k2);
	for (int i = 0; i < size; i++)
		state[i] += 0.5 * h * (k1[i] + k2[i]);
	return true;
}

static bool heun_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, heun_step);
}

INLINE bool rk4_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	const int size = 2 * f->n;
	const double half = 0.5 * h, sixth = h / 6.0;
	double *restrict k1 = f->work[0], *restrict k2 = f->work[1], *restrict k3 = f->work[2],
		*restrict k4 = f->work[3];
	double *restrict x = f->work[4];
	(void)s;
	slope(f, t, state, k1);
	for (int i = 0; i < size; i++)
		x[i] = state[i] + half * k1[i];
	slope(f, t + half, x, k2);
	for (int i = 0; i < size; i++)
		x[i] = state[i] + half * k2[i];
	slope(f, t + half, x, k3);
	for (int i = 0; i < size; i++)
		x[i] = state[i] + h * k3[i];
	slope(f, t + h, x, k4);
	for (int i = 0; i < size; i++)
		state[i] += sixth * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
	return true;
}

static bool rk4_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, rk4_step);
}

/* Velocity Verlet: the accelerations are those at t. Forces that depend on velocity see v + h a, which is of second
 * order */
INLINE bool verlet_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	const int n = f->n;
	double *restrict x = f->work[0], *restrict dxdt = f->work[1];
	double *q = state, *v = state + n, *a = state + 2 * n;
	(void)s;
	for (int i = 0; i < n; i++) {
		x[i] = q[i] + h * (v[i] + 0.5 * h * a[i]);
		x[n + i] = v[i] + h * a[i];
	}
	slope(f, t + h, x, dxdt);
	for (int i = 0; i < n; i++) {
		q[i] = x[i];
		v[i] += 0.5 * h * (a[i] + dxdt[n + i]);
		a[i] = dxdt[n + i];
	}
	return true;
}

static bool verlet_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, verlet_step);
}

/* ---- Newton's method ----
 *
 * The factors are kept from step to step while an iteration shrinks the correction to a fifth, and made anew, by
 * forward differences of the residual, where it does not. It ends when the correction still to come, judged by the
 * last two, is below 1e-12 of the largest coordinate or velocity so far, and fails after 25 iterations. */

#define NEWTON_SETTINGS \
	"Newton, Jacobian by differences, kept while corrections shrink to 1/5; to 1e-12 of the largest coordinate " \
	"and velocity; fails after 25 iterations"
enum { NEWTON_ITERATIONS = 25 };
static const double newton_tolerance = 1e-12;

struct equation {               /* of one step, in its unknowns z */
	double t, h;
	const double *state, *slope;
};
typedef void residual_function(struct fixed *f, const struct equation *e, const double *z, double *r);

INLINE void difference(struct fixed *f, struct factors *s, const struct equation *e, double *z, const double *r,
                       residual_function *residual)
{
	const int m = s->size;
	double *moved = f->work[7];
	for (int j = 0; j < m; j++) {
		const double kept = z[j];
		/* so that the difference is what is moved */
		volatile double sum = kept + sqrt(DBL_EPSILON) * fmax(fabs(kept), 1.0 / f->weight[j]);
		z[j] = sum;
		residual(f, e, z, moved);
		for (int i = 0; i < m; i++)
			s->matrix[i * m + j] = (moved[i] - r[i]) / (z[j] - kept);
		z[j] = kept;
	}
	factor(s);
	s->stale = false;
}

INLINE bool newton(struct fixed *f, struct factors *s, const struct equation *e, double *z, residual_function *residual)
{
	const int m = s->size;
	double *r = f->work[5], *d = f->work[6], before = 0.0;
	for (int k = 0; k < NEWTON_ITERATIONS; k++) {
		double now = 0.0;
		residual(f, e, z, r);
		if (s->stale)
			difference(f, s, e, z, r, residual);
		solve(s, r, d);
		for (int i = 0; i < m; i++) {
			z[i] -= d[i];
			now = fmax(now, fabs(d[i]) * f->weight[i]);
		}
		if (!all_finite(m, d))
			return false;
		if (now <= newton_tolerance ||
		    (k > 0 && now < before && now * now / (before - now) <= newton_tolerance))
			return true;
		s->stale = k > 0 && now > 0.2 * before;
		before = now;
	}
	return false;
}

static double largest(double so_far, int n, const double *x, double factor)
{
	for (int i = 0; i < n; i++)
		so_far = fmax(so_far, factor * fabs(x[i]));
	return so_far;
}

/* a: accelerations at the start of the step, so that a start at rest has a scale too */
static void weigh(struct fixed *f, double h, const double *state, const double *a)
{
	const int n = f->n;
	f->scale_v = largest(largest(f->scale_v, n, state + n, 1.0), n, a, h);
	f->scale_q = largest(largest(f->scale_q, n, state, 1.0), n, state + n, h);
}

static double over(double scale)
{
	return scale > 0.0 ? 1.0 / scale : 1.0;
}

/* ---- implicit trapezoid: y+ = y + h/2 (f(t, y) + f(t + h, y+)) ---- */

static bool has_matrix(const struct problem *p)
{
	return p->linear && p->A;
}

static void trapezoid_fill(const struct problem *p, double h, double *matrix)
{
	const int m = 2 * p->n;
	for (int i = 0; i < m * m; i++)
		matrix[i] = (i % (m + 1) == 0) - 0.5 * h * p->A[i];
}

INLINE bool trapezoid_linear_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	const int size = 2 * f->n;
	const bool autonomous = f->run.problem->w == 0.0;
	double *restrict now = f->work[0], *restrict next = f->work[1], *restrict d = f->work[2];
	slope(f, t, state, now);
	if (autonomous) {
		for (int i = 0; i < size; i++)
			now[i] *= h;
	} else {
		slope(f, t + h, state, next);
		for (int i = 0; i < size; i++)
			now[i] = 0.5 * h * (now[i] + next[i]);
	}
	solve(s, now, d);
	for (int i = 0; i < size; i++)
		state[i] += d[i];
	return true;
}

static bool trapezoid_linear_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, trapezoid_linear_step);
}

INLINE void trapezoid_residual(struct fixed *f, const struct equation *e, const double *z, double *r)
{
	slope(f, e->t + e->h, z, r);
	for (int i = 0; i < 2 * f->n; i++)
		r[i] = z[i] - e->state[i] - 0.5 * e->h * (e->slope[i] + r[i]);
}

INLINE bool trapezoid_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	const int n = f->n;
	double *now = f->work[0], *z = f->work[1];
	const struct equation e = {t, h, state, now};
	slope(f, t, state, now);
	weigh(f, h, state, now + n);
	for (int i = 0; i < n; i++) {
		f->weight[i] = over(f->scale_q);
		f->weight[n + i] = over(f->scale_v);
	}
	for (int i = 0; i < 2 * n; i++)
		z[i] = state[i] + h * now[i];
	if (!newton(f, s, &e, z, trapezoid_residual))
		return false;
	memcpy(state, z, sizeof *z * 2 * (size_t)n);
	return true;
}

static bool trapezoid_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, trapezoid_step);
}

/* ---- Newmark's family and generalized-alpha: Chung and Hulbert, J. Applied Mechanics 60 (1993) 371-375 ----
 *
 *     q+ = q + h v + h^2 ((1/2 - beta) a + beta a+)        v+ = v + h ((1 - gamma) a + gamma a+)
 *     (1 - alpha_m) a+ + alpha_m a = acceleration at t + (1 - alpha_f) h, (1 - alpha_f) q+ + alpha_f q,
 *                                    (1 - alpha_f) v+ + alpha_f v
 */
struct newmark {
	double alpha_m, alpha_f, beta, gamma;
};
static const struct newmark central = {0.0, 0.0, 0.0, 0.5};     /* explicit in q, implicit in v: Bathe's (M + h/2 C) */
static const struct newmark average = {0.0, 0.0, 0.25, 0.5};
/* rho = 0.8: alpha_m = (2 rho - 1)/(rho + 1), alpha_f = rho/(rho + 1), gamma = 1/2 - alpha_m + alpha_f, beta = (1 -
 * alpha_m + alpha_f)^2/4 */
static const struct newmark alpha = {1.0 / 3.0, 4.0 / 9.0, 25.0 / 81.0, 11.0 / 18.0};

INLINE void newmark_fill(const struct problem *p, double h, double *matrix, const struct newmark *c)
{
	const int n = p->n;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			const double *row = p->A + (n + i) * 2 * n;
			matrix[i * n + j] = (1.0 - c->alpha_m) * (i == j) - (1.0 - c->alpha_f) *
			                    (c->beta * h * h * row[j] + c->gamma * h * row[n + j]);
		}
}

/* The state in which the acceleration is asked, for accelerations z at the end of the step */
INLINE void newmark_between(const struct newmark *c, int n, double h, const double *state, const double *z, double *x)
{
	const double *q = state, *v = state + n, *a = state + 2 * n;
	const double share = 1.0 - c->alpha_f;
	for (int i = 0; i < n; i++) {
		const double end = z ? z[i] : 0.0;
		x[i] = q[i] + share * h * (v[i] + h * ((0.5 - c->beta) * a[i] + c->beta * end));
		x[n + i] = v[i] + share * h * ((1.0 - c->gamma) * a[i] + c->gamma * end);
	}
}

INLINE void newmark_end(const struct newmark *c, int n, double h, double *state, const double *end)
{
	double *q = state, *v = state + n, *a = state + 2 * n;
	for (int i = 0; i < n; i++) {
		q[i] += h * (v[i] + h * ((0.5 - c->beta) * a[i] + c->beta * end[i]));
		v[i] += h * ((1.0 - c->gamma) * a[i] + c->gamma * end[i]);
		a[i] = end[i];
	}
}

INLINE bool newmark_linear(struct fixed *f, struct factors *s, double t, double h, double *state,
                           const struct newmark *c)
{
	const int n = f->n;
	double *restrict x = f->work[0], *restrict right = f->work[1], *restrict end = f->work[2];
	newmark_between(c, n, h, state, NULL, x);
	slope(f, t + (1.0 - c->alpha_f) * h, x, right);
	for (int i = 0; i < n; i++)
		right[n + i] -= c->alpha_m * state[2 * n + i];
	solve(s, right + n, end);
	newmark_end(c, n, h, state, end);
	return true;
}

INLINE void newmark_residual(struct fixed *f, const struct equation *e, const double *z, double *r,
                             const struct newmark *c)
{
	const int n = f->n;
	double *x = f->work[1], *dxdt = f->work[2];
	newmark_between(c, n, e->h, e->state, z, x);
	slope(f, e->t + (1.0 - c->alpha_f) * e->h, x, dxdt);
	for (int i = 0; i < n; i++)
		r[i] = (1.0 - c->alpha_m) * z[i] + c->alpha_m * e->state[2 * n + i] - dxdt[n + i];
}

INLINE bool newmark_newton(struct fixed *f, struct factors *s, double t, double h, double *state,
                           const struct newmark *c, residual_function *residual)
{
	const int n = f->n;
	double *z = f->work[0];
	const struct equation e = {t, h, state, NULL};
	weigh(f, h, state, state + 2 * n);
	for (int i = 0; i < n; i++) {
		f->weight[i] = fmax(c->gamma * h * over(f->scale_v), c->beta * h * h * over(f->scale_q));
		z[i] = state[2 * n + i];
	}
	if (!newton(f, s, &e, z, residual))
		return false;
	newmark_end(c, n, h, state, z);
	return true;
}

static bool is_damped(const struct problem *p)
{
	const int n = p->n;
	if (!has_matrix(p))
		return false;
	for (int i = n; i < 2 * n; i++)
		for (int j = n; j < 2 * n; j++)
			if (p->A[i * 2 * n + j] != 0.0)
				return true;
	return false;
}

static void central_fill(const struct problem *p, double h, double *matrix)
{
	newmark_fill(p, h, matrix, &central);
}

INLINE bool central_linear_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	return newmark_linear(f, s, t, h, state, &central);
}

static bool central_linear_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, central_linear_step);
}

static void average_fill(const struct problem *p, double h, double *matrix)
{
	newmark_fill(p, h, matrix, &average);
}

INLINE bool average_linear_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	return newmark_linear(f, s, t, h, state, &average);
}

static bool average_linear_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, average_linear_step);
}

INLINE void average_residual(struct fixed *f, const struct equation *e, const double *z, double *r)
{
	newmark_residual(f, e, z, r, &average);
}

INLINE bool average_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	return newmark_newton(f, s, t, h, state, &average, average_residual);
}

static bool average_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, average_step);
}

static void alpha_fill(const struct problem *p, double h, double *matrix)
{
	newmark_fill(p, h, matrix, &alpha);
}

INLINE bool alpha_linear_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	return newmark_linear(f, s, t, h, state, &alpha);
}

static bool alpha_linear_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, alpha_linear_step);
}

INLINE void alpha_residual(struct fixed *f, const struct equation *e, const double *z, double *r)
{
	newmark_residual(f, e, z, r, &alpha);
}

INLINE bool alpha_step(struct fixed *f, struct factors *s, double t, double h, double *state)
{
	return newmark_newton(f, s, t, h, state, &alpha, alpha_residual);
}

static bool alpha_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, alpha_step);
}

/* ---- the run as charts.h has it ---- */

static void prepare(struct fixed *f, struct factors *s, double h)
{
	if (s->size && is_linear_way(f)) {
		classic_of(f)->fill(f->run.problem, h, s->matrix);
		factor(s);
	}
	s->stale = true;
}

static void fixed_restart(struct run *run)
{
	struct fixed *f = (struct fixed *)run;
	const size_t n = (size_t)f->n;
	memcpy(f->state, run->problem->start, 2 * n * sizeof *f->state);
	f->units = f->evaluations = 0;
	f->failed = false;
	f->scale_q = f->scale_v = 0.0;
	if (classic_of(f)->keeps_acceleration) {
		slope(f, 0.0, f->state, f->work[0]);
		memcpy(f->state + 2 * n, f->work[0] + n, n * sizeof *f->state);
	}
	f->every.stale = true;
}

/* Whole steps, then one of what is left of `fraction`, with a state and factors of its own */
static void fixed_between(struct run *run, double fraction, double *y)
{
	struct fixed *f = (struct fixed *)run;
	const struct fixed kept = *f;
	const double t = (double)f->units * run->problem->unit;
	const int whole = (int)floor(fraction * f->steps + 1e-9);
	const double rest = fraction * run->problem->unit - whole * f->h;
	bool good = !f->failed;
	step_function *step = way_of(f)->step;
	memcpy(f->ahead, f->state, 3 * (size_t)f->n * sizeof *f->state);
	if (whole > 0)
		prepare(f, &f->part, f->h);
	for (int k = 0; k < whole && good; k++)
		good = step(f, &f->part, t + k * f->h, f->h, f->ahead);
	if (good && rest > 1e-9 * f->h) {
		prepare(f, &f->part, rest);
		good = step(f, &f->part, t + whole * f->h, rest, f->ahead);
	}
	f->evaluations = kept.evaluations;
	f->scale_q = kept.scale_q;
	f->scale_v = kept.scale_v;
	for (int i = 0; i < 2 * f->n; i++)
		y[i] = good ? f->ahead[i] : NAN;
}

static void fixed_get(const struct run *run, double *y)
{
	const struct fixed *f = (const struct fixed *)run;
	memcpy(y, f->state, 2 * (size_t)f->n * sizeof *y);
}

static long fixed_evaluations(const struct run *run)
{
	return ((const struct fixed *)run)->evaluations;
}

static void fixed_close(struct run *run)
{
	struct fixed *f = (struct fixed *)run;
	free(f->state);
	free(f->every.row);
	free(f->part.row);
	free(f);
}

/* Vectors and matrices stand in one block of memory */
static bool allot(struct fixed *f, int unknowns)
{
	const size_t n = (size_t)f->n, m = (size_t)unknowns;
	double *next = calloc(3 * n + 3 * n + WORK * 2 * n + 2 * n + 2 * (m * m + m), sizeof *next);
	f->state = next;
	f->every.size = f->part.size = unknowns;
	f->every.row = calloc(m + 1, sizeof *f->every.row);
	f->part.row = calloc(m + 1, sizeof *f->part.row);
	if (!next || !f->every.row || !f->part.row)
		return false;
	next += 3 * n;
	for (int i = 0; i < WORK; i++, next += 2 * n)
		f->work[i] = next;
	f->weight = next;
	f->ahead = next += 2 * n;
	f->every.matrix = next += 3 * n;
	f->every.reciprocal = next += m * m;
	f->part.matrix = next += m;
	f->part.reciprocal = next + m * m;
	return true;
}

static struct run *fixed_open(const struct method *method, const struct problem *problem, double setting)
{
	const double steps = round(problem->unit / setting);
	if (!(setting > 0.0) || !(steps >= 1.0 && steps <= 1e9) || setting > problem->unit * (1.0 + 1e-9))
		return NULL;
	struct fixed *f = calloc(1, sizeof *f);
	if (!f)
		return NULL;
	f->run = (struct run){.method = method, .problem = problem, .restart = fixed_restart, .between = fixed_between,
	                      .get = fixed_get, .evaluations = fixed_evaluations, .close = fixed_close};
	f->rhs = problem->rhs_of ? NULL : problem->rhs;
	f->rhs_of = problem->rhs_of;
	f->of = problem->of;
	f->n = problem->n;
	f->steps = (int)steps;
	f->run.setting = f->h = problem->unit / steps;
	f->run.advance = way_of(f)->advance;
	if (!allot(f, classic_of(f)->unknowns * f->n)) {
		fixed_close(&f->run);
		return NULL;
	}
	prepare(f, &f->every, f->h);
	fixed_restart(&f->run);
	return &f->run;
}

/* ---- the list ---- */

#define FIXED_METHOD(NAME, ORDER, SETTINGS) \
	{.name = NAME, .family = FIXED, .order = ORDER, .settings = SETTINGS, .open = fixed_open}

static const struct classic explicit_euler = {
	.method = FIXED_METHOD("explicit Euler", 1, "fixed step; 1 evaluation a step"),
	.plain = {euler_step, euler_advance},
};
static const struct classic explicit_trapezoid = {
	.method = FIXED_METHOD("explicit trapezoid", 2, "fixed step; Heun; 2 evaluations a step"),
	.plain = {heun_step, heun_advance},
};
static const struct classic implicit_trapezoid = {
	.method = FIXED_METHOD("implicit trapezoid", 2,
	                       "fixed step; linear: I - h/2 A factored once, 1 evaluation a step, 2 with a load in "
	                       "time; else " NEWTON_SETTINGS),
	.plain = {trapezoid_step, trapezoid_advance},
	.linear = {trapezoid_linear_step, trapezoid_linear_advance},
	.wants_linear = has_matrix, .unknowns = 2, .fill = trapezoid_fill,
};
static const struct classic rk4 = {
	.method = FIXED_METHOD("RK4", 4, "fixed step; the classical one; 4 evaluations a step"),
	.plain = {rk4_step, rk4_advance},
};
static const struct classic central_difference = {
	.method = FIXED_METHOD("central difference", 2,
	                       "fixed step; as velocity Verlet; linear damping implicit in the velocity: I + h/2 C "
	                       "factored once (Bathe); "
	                       "nonlinear forces of velocity are taken at v + h a; 1 evaluation a step"),
	.plain = {verlet_step, verlet_advance},
	.linear = {central_linear_step, central_linear_advance},
	.wants_linear = is_damped, .unknowns = 1, .fill = central_fill, .keeps_acceleration = true,
};
static const struct classic newmark_average = {
	.method = FIXED_METHOD("Newmark", 2,
	                       "fixed step; average acceleration, beta = 1/4, gamma = 1/2; linear: I + h/2 C + h^2/4 K "
	                       "factored once, 1 evaluation a step; else in the accelerations by " NEWTON_SETTINGS),
	.plain = {average_step, average_advance},
	.linear = {average_linear_step, average_linear_advance},
	.wants_linear = has_matrix, .unknowns = 1, .fill = average_fill, .keeps_acceleration = true,
};
static const struct classic generalized_alpha = {
	.method = FIXED_METHOD("generalized-alpha", 2,
	                       "fixed step; Chung and Hulbert 1993, spectral radius at infinity 0.8; linear: matrix "
	                       "factored once, 1 evaluation a step; else in the accelerations by " NEWTON_SETTINGS),
	.plain = {alpha_step, alpha_advance},
	.linear = {alpha_linear_step, alpha_linear_advance},
	.wants_linear = has_matrix, .unknowns = 1, .fill = alpha_fill, .keeps_acceleration = true,
};

const struct method *const fixed_methods[] = {
	&explicit_euler.method, &explicit_trapezoid.method, &implicit_trapezoid.method, &rk4.method,
	&central_difference.method, &newmark_average.method, &generalized_alpha.method, NULL,
};
