/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Methods with a fixed step on the right-hand side: a row of the table at the end and a step function each. A step is
 * unit/k for an integer k. Implicit ones factor their matrix once where the problem is linear, since then f(t, y + d) =
 * f(t, y) + A d; elsewhere they solve by Newton's method. Where forces jump in slope Newton may find nothing: the run
 * has then failed, as it has when the state is no longer finite. Beside the textbooks' methods those of structural
 * dynamics, for linear problems M a + C v + K x = F(t), of which problem.c has M^-1 K and M^-1 C in A, from their
 * papers:
 *
 *   HHT-alpha         Hilber, Hughes, Taylor, Earthq. Eng. Struct. Dyn. 5 (1977) 283
 *   generalized-alpha Chung, Hulbert, J. Applied Mechanics 60 (1993) 371
 *   Bathe             Bathe, Computers and Structures 85 (2007) 437: two substeps of h/2
 *   rho-Bathe         Noh, Bathe, Computers and Structures 212 (2019) 299
 *   CR                Chen, Ricles, J. Eng. Mech. 134 (2008) 676
 *   KR-alpha          Kolay, Ricles, Earthq. Eng. Struct. Dyn. 43 (2014) 1361
 *
 * Loads between steps are asked at the time that a method weighs its ends to. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fixed.h"

#define DORMAND_TYPE struct fixed
#define DORMAND_SLOPES slope
#include "dormand_step.h"

#define EXPLICIT_TYPE struct fixed
#define EXPLICIT_MOST MOST_ENTRIES
#define EXPLICIT_SLOPES slope
#include "explicit_step.h"

/* ---- explicit methods ---- */

INLINE bool euler(struct fixed *f, struct part *p, double t, double *state)
{
	double *restrict k1 = f->work[0];
	slope(f, t, state, k1);
	for (int i = 0; i < 2 * f->n; i++)
		state[i] += p->h * k1[i];
	return true;
}
MARCH(euler)

#define EXPLICIT(NAME) \
	INLINE bool NAME(struct fixed *f, struct part *p, double t, double *state) \
	{ \
		NAME##_step(2 * f->n, f, t, p->h, state); \
		return true; \
	} \
	MARCH(NAME)
EXPLICIT(heun)
EXPLICIT(rk4)
EXPLICIT(verlet)

/* Dormand and Prince, of order 5: the slope at the end is the first of the next step */
INLINE bool dormand_prince(struct fixed *f, struct part *p, double t, double *state)
{
	const int n = f->n, size = 2 * n;
	double *x = f->work[7];
	memcpy(f->work[0], state + n, sizeof *x * (size_t)size);
	dormand_stages(f, size, t, p->h, state, f->work, x);
	memcpy(state, x, sizeof *x * (size_t)size);
	memcpy(state + size, f->work[6] + n, sizeof *x * (size_t)n);
	return true;
}
MARCH(dormand_prince)

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
	const struct newmark *c;
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

static void trapezoid_prepare(const struct scheme *scheme, const struct problem *p, struct part *part)
{
	const int m = 2 * p->n;
	(void)scheme;
	for (int i = 0; i < m * m; i++)
		part->first.matrix[i] = (i % (m + 1) == 0) - 0.5 * part->h * p->A[i];
	factor(&part->first);
}

INLINE bool trapezoid_linear(struct fixed *f, struct part *p, double t, double *state)
{
	const int size = 2 * f->n;
	const double h = p->h;
	double *restrict now = f->work[0], *restrict next = f->work[1], *restrict d = f->work[2];
	slope(f, t, state, now);
	if (f->run.problem->w == 0.0) {         /* autonomous */
		for (int i = 0; i < size; i++)
			now[i] *= h;
	} else {
		slope(f, t + h, state, next);
		for (int i = 0; i < size; i++)
			now[i] = 0.5 * h * (now[i] + next[i]);
	}
	solve(&p->first, now, d);
	for (int i = 0; i < size; i++)
		state[i] += d[i];
	return true;
}
MARCH(trapezoid_linear)

INLINE void trapezoid_residual(struct fixed *f, const struct equation *e, const double *z, double *r)
{
	slope(f, e->t + e->h, z, r);
	for (int i = 0; i < 2 * f->n; i++)
		r[i] = z[i] - e->state[i] - 0.5 * e->h * (e->slope[i] + r[i]);
}

INLINE bool trapezoid(struct fixed *f, struct part *p, double t, double *state)
{
	const int n = f->n;
	double *now = f->work[0], *z = f->work[1];
	const struct equation e = {t, p->h, state, now, NULL};
	slope(f, t, state, now);
	weigh(f, p->h, state, now + n);
	for (int i = 0; i < n; i++) {
		f->weight[i] = over(f->scale_q);
		f->weight[n + i] = over(f->scale_v);
	}
	for (int i = 0; i < 2 * n; i++)
		z[i] = state[i] + p->h * now[i];
	if (!newton(f, &p->first, &e, z, trapezoid_residual))
		return false;
	memcpy(state, z, sizeof *z * 2 * (size_t)n);
	return true;
}
MARCH(trapezoid)

/* ---- Newmark's family and generalized-alpha ---- */

static void newmark_prepare(const struct scheme *scheme, const struct problem *p, struct part *part)
{
	const int n = p->n;
	const double h = part->h;
	const struct newmark *c = &scheme->c;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			const double *row = p->A + (n + i) * 2 * n;
			part->first.matrix[i * n + j] = (1.0 - c->alpha_m) * (i == j) - (1.0 - c->alpha_f) *
			                                (c->beta * h * h * row[j] + c->gamma * h * row[n + j]);
		}
	factor(&part->first);
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

INLINE bool newmark_linear(struct fixed *f, struct part *p, double t, double *state)
{
	const int n = f->n;
	const struct newmark c = p->c;
	double *restrict x = f->work[0], *restrict right = f->work[1], *restrict end = f->work[2];
	newmark_between(&c, n, p->h, state, NULL, x);
	slope(f, t + (1.0 - c.alpha_f) * p->h, x, right);
	for (int i = 0; i < n; i++)
		right[n + i] -= c.alpha_m * state[2 * n + i];
	solve(&p->first, right + n, end);
	newmark_end(&c, n, p->h, state, end);
	return true;
}
MARCH(newmark_linear)

INLINE void newmark_residual(struct fixed *f, const struct equation *e, const double *z, double *r)
{
	const int n = f->n;
	const struct newmark *c = e->c;
	double *x = f->work[1], *dxdt = f->work[2];
	newmark_between(c, n, e->h, e->state, z, x);
	slope(f, e->t + (1.0 - c->alpha_f) * e->h, x, dxdt);
	for (int i = 0; i < n; i++)
		r[i] = (1.0 - c->alpha_m) * z[i] + c->alpha_m * e->state[2 * n + i] - dxdt[n + i];
}

INLINE bool newmark(struct fixed *f, struct part *p, double t, double *state)
{
	const int n = f->n;
	const double h = p->h;
	const struct newmark *c = &p->c;
	double *z = f->work[0];
	const struct equation e = {t, h, state, NULL, c};
	weigh(f, h, state, state + 2 * n);
	for (int i = 0; i < n; i++) {
		f->weight[i] = fmax(c->gamma * h * over(f->scale_v), c->beta * h * h * over(f->scale_q));
		z[i] = state[2 * n + i];
	}
	if (!newton(f, &p->first, &e, z, newmark_residual))
		return false;
	newmark_end(c, n, h, state, z);
	return true;
}
MARCH(newmark)

static bool is_damped(const struct problem *p)
{
	const int n = p->n;
	for (int i = n; i < 2 * n && has_matrix(p); i++)
		for (int j = n; j < 2 * n; j++)
			if (p->A[i * 2 * n + j] != 0.0)
				return true;
	return false;
}

/* ---- two substeps, and explicit steps ---- */

/* of a: 1; of v: `velocity`, of x: `place`; n x n into `matrix` */
static void effective(const struct problem *p, double mass, double velocity, double place, double *matrix)
{
	const int n = p->n;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			const double *row = p->A + (n + i) * 2 * n;
			matrix[i * n + j] = mass * (i == j) - velocity * row[n + j] - place * row[j];
		}
}

static void composite_prepare(const struct scheme *scheme, const struct problem *problem, struct part *p)
{
	const double rho = scheme->rho, h = p->h;
	const double best = rho < 1.0 ? (2.0 - sqrt(2.0 + 2.0 * rho)) / (1.0 - rho) : 0.5;
	p->substep = scheme->substep > 0.0 ? scheme->substep : best;
	p->q1 = (rho + 1.0) / (2.0 * p->substep * (rho - 1.0) + 4.0);
	p->q0 = (p->substep - 1.0) * p->q1 + 0.5;
	p->q2 = 0.5 - p->substep * p->q1;
	const double half = 0.5 * p->substep * h, share = p->q2 * h;
	effective(problem, 1.0, half, half * half, p->first.matrix);
	effective(problem, 1.0, share, share * share, p->second.matrix);
	factor(&p->first);
	factor(&p->second);
}

INLINE bool composite(struct fixed *f, struct part *p, double t, double *state)
{
	const int n = f->n;
	const double h = p->h, g = p->substep * h, half = 0.5 * g, share = p->q2 * h;
	double *q = state, *v = state + n, *a = state + 2 * n;
	double *restrict y = f->work[0], *restrict force = f->work[1], *restrict middle = f->work[2];
	double *restrict vm = f->work[3], *restrict end = f->work[4];
	for (int i = 0; i < n; i++) {
		y[i] = q[i] + g * v[i] + half * half * a[i];
		y[n + i] = v[i] + half * a[i];
	}
	slope(f, t + g, y, force);
	solve(&p->first, force + n, middle);
	for (int i = 0; i < n; i++) {
		vm[i] = v[i] + half * (a[i] + middle[i]);
		const double known = v[i] + h * (p->q0 * a[i] + p->q1 * middle[i]);
		y[n + i] = known;
		y[i] = q[i] + h * (p->q0 * v[i] + p->q1 * vm[i] + p->q2 * known);
	}
	slope(f, t + h, y, force);
	solve(&p->second, force + n, end);
	for (int i = 0; i < n; i++) {
		q[i] = y[i] + share * share * end[i];
		v[i] = y[n + i] + share * end[i];
		a[i] = end[i];
	}
	return true;
}
MARCH(composite)

/* With D = M + gamma h C + beta h^2 K, M = 1, and E = (1 - alpha_f) D + alpha_f - alpha_m:
 *   v+ = v + h A1 a, A1 = D^-1                  x+ = x + h v + h^2 (1/2 + gamma) A1 a
 *   (1 - A3) a+ = f - A3 a, A3 = D^-1 (alpha_f D + alpha_m - alpha_f), so (1 - A3)^-1 = E^-1 D
 * f: the acceleration that loads and forces give in between. CR: alpha_m = alpha_f = 0, beta = 1/4, so A3 = 0. */
static void explicit_prepare(const struct scheme *scheme, const struct problem *problem, struct part *p)
{
	const int n = problem->n;
	const double h = p->h;
	double right[n], column[n], D[n * n];
	const struct newmark *c = &scheme->c;
	const double share = 1.0 - c->alpha_f, velocity = c->gamma * h, place = c->beta * h * h;
	effective(problem, 1.0, velocity, place, D);
	effective(problem, 1.0 - c->alpha_m, share * velocity, share * place, p->second.matrix);
	memcpy(p->first.matrix, D, sizeof D);
	factor(&p->first);
	factor(&p->second);
	for (int j = 0; j < n; j++) {
		for (int i = 0; i < n; i++)
			right[i] = i == j;
		solve(&p->first, right, column);
		for (int i = 0; i < n; i++) {
			p->to_velocity[i * n + j] = h * column[i];
			p->to_place[i * n + j] = h * h * (0.5 + c->gamma) * column[i];
			right[i] = D[i * n + j];
		}
		solve(&p->second, right, column);
		for (int i = 0; i < n; i++) {
			p->loads[i * n + j] = column[i];
			p->before[i * n + j] = column[i] - (i == j);    /* (1 - A3)^-1 A3 */
		}
	}
}

/* No equations are solved: products with matrices of the step */
INLINE bool explicit_step(struct fixed *f, struct part *p, double t, double *state)
{
	const int n = f->n;
	const double h = p->h, share = 1.0 - p->c.alpha_f;
	double *q = state, *v = state + n, *a = state + 2 * n;
	double *restrict y = f->work[0], *restrict force = f->work[1], *restrict dv = f->work[2],
		*restrict dq = f->work[3];
	for (int i = 0; i < n; i++) {
		double velocity = 0.0, place = 0.0;
		for (int j = 0; j < n; j++) {
			velocity += p->to_velocity[i * n + j] * a[j];
			place += p->to_place[i * n + j] * a[j];
		}
		dv[i] = velocity;
		dq[i] = h * v[i] + place;
		y[i] = q[i] + share * dq[i];
		y[n + i] = v[i] + share * velocity;
	}
	slope(f, t + share * h, y, force);
	for (int i = 0; i < n; i++) {
		double sum = 0.0;
		for (int j = 0; j < n; j++)
			sum += p->loads[i * n + j] * force[n + j] - p->before[i * n + j] * a[j];
		y[i] = sum;
	}
	for (int i = 0; i < n; i++) {
		q[i] += dq[i];
		v[i] += dv[i];
		a[i] = y[i];
	}
	return true;
}
MARCH(explicit_step)

/* ---- the list ---- */

#define FIXED(NAME, ORDER, SETTINGS) \
	.method = {.name = NAME, .family = FIXED, .order = ORDER, .settings = "fixed step; " SETTINGS, \
	           .open = fixed_open}
#define STRUCTURAL(NAME, SETTINGS) \
	.method = {.name = NAME, .family = FIXED, .linear_only = true, .order = 2, \
	           .settings = "fixed step; " SETTINGS, \
	           .open = fixed_open}, .wants_linear = has_matrix, .unknowns = 1, .keeps_acceleration = true
#define WAY(NAME) {NAME, NAME##_march}
#define NEWMARK(WANTED, ...) \
	.linear = WAY(newmark_linear), .wants_linear = WANTED, .prepare = newmark_prepare, .unknowns = 1, \
	.keeps_acceleration = true, .c = {__VA_ARGS__}
#define COMPOSITE .linear = WAY(composite), .prepare = composite_prepare
#define ALPHA .linear = WAY(newmark_linear), .prepare = newmark_prepare
#define BY_PRODUCTS .linear = WAY(explicit_step), .prepare = explicit_prepare
/* Of the spectral radius for large steps */
#define ALPHA_OF(M, F) {M, F, 0.25 * (1.0 - (M) + (F)) * (1.0 - (M) + (F)), 0.5 - (M) + (F)}
#define OF_RHO(RHO) ALPHA_OF((2.0 * RHO - 1.0) / (RHO + 1.0), RHO / (RHO + 1.0))
#define ONE_SOLUTION "matrix factored once, 1 evaluation and 1 solution a step; "
#define TWO_SOLUTIONS "two substeps, each with its matrix factored once: 2 evaluations and 2 solutions a step; "
#define NO_SOLUTION \
	"explicit: products with matrices of the step, 1 evaluation a step; first order after a load that " \
	"sets in at once; "
#define CHUNG "Chung and Hulbert 1993, spectral radius at infinity "
#define NOH "Noh and Bathe 2019, spectral radius at infinity "
#define KOLAY "Kolay and Ricles 2014, spectral radius at infinity "

static const struct scheme schemes[] = {
	{FIXED("explicit Euler", 1, "1 evaluation a step"), .plain = WAY(euler)},
	{FIXED("explicit trapezoid", 2, "Heun; 2 evaluations a step"), .plain = WAY(heun)},
	{FIXED("implicit trapezoid", 2,
	       "linear: I - h/2 A factored once, 1 evaluation a step, 2 with a load in time; else " NEWTON_SETTINGS),
	 .plain = WAY(trapezoid), .linear = WAY(trapezoid_linear), .wants_linear = has_matrix, .unknowns = 2,
	 .prepare = trapezoid_prepare},
	{FIXED("RK4", 4, "the classical one; 4 evaluations a step"), .plain = WAY(rk4)},
	/* explicit in q, implicit in v: Bathe's (M + h/2 C) */
	{FIXED("central difference", 2,
	       "as velocity Verlet; linear damping implicit in the velocity: I + h/2 C factored once (Bathe); "
	       "nonlinear "
	       "forces of velocity are taken at v + h a; 1 evaluation a step"),
	 .plain = WAY(verlet), NEWMARK(is_damped, 0.0, 0.0, 0.0, 0.5)},
	{FIXED("Newmark", 2,
	       "average acceleration, beta = 1/4, gamma = 1/2; linear: I + h/2 C + h^2/4 K factored once, 1 "
	       "evaluation a "
	       "step; else in the accelerations by " NEWTON_SETTINGS),
	 .plain = WAY(newmark), NEWMARK(has_matrix, 0.0, 0.0, 0.25, 0.5)},
	{FIXED("generalized-alpha", 2,
	       "Chung and Hulbert 1993, spectral radius at infinity 0.8; linear: matrix factored once, 1 evaluation a "
	       "step; else in the accelerations by " NEWTON_SETTINGS),
	 .plain = WAY(newmark), NEWMARK(has_matrix, 1.0 / 3.0, 4.0 / 9.0, 25.0 / 81.0, 11.0 / 18.0)},
};
/* What an adaptive solver does while its error estimate does not bind */
static const struct scheme dormand_prince_5 = {
	.method = {.name = "Dormand-Prince 5 (fixed step)", .family = FIXED, .order = 5,
	           .settings = "the formula of order 5 at a fixed step", .open = fixed_open},
	.plain = WAY(dormand_prince), .keeps_acceleration = true};
/* Of structural dynamics; HHT-alpha by its alpha, -1/3 to 0 */
enum { HHT, BATHE, RHO_BATHE_5, CR, KR_5, ALPHA_5, RHO_BATHE_0, RHO_BATHE_1, KR_0, KR_1 };
static const struct scheme structural[] = {
	[HHT] = {STRUCTURAL("HHT-alpha", ONE_SOLUTION "Hilber, Hughes and Taylor 1977, alpha = -0.1"), ALPHA,
	         .c = ALPHA_OF(0.0, 0.1)},
	[ALPHA_5] = {STRUCTURAL("generalized-alpha 0.5", ONE_SOLUTION CHUNG "0.5"), ALPHA, .c = OF_RHO(0.5)},
	[BATHE] = {STRUCTURAL("Bathe", TWO_SOLUTIONS "Bathe 2007, substeps h/2"), COMPOSITE, .substep = 0.5},
	[RHO_BATHE_0] = {STRUCTURAL("rho-Bathe 0", TWO_SOLUTIONS NOH "0"), COMPOSITE, .rho = 0.0},
	[RHO_BATHE_5] = {STRUCTURAL("rho-Bathe 0.5", TWO_SOLUTIONS NOH "0.5"), COMPOSITE, .rho = 0.5},
	[RHO_BATHE_1] = {STRUCTURAL("rho-Bathe 1", TWO_SOLUTIONS NOH "1"), COMPOSITE, .rho = 1.0},
	[CR] = {STRUCTURAL("CR", NO_SOLUTION "Chen and Ricles 2008"), BY_PRODUCTS, .c = ALPHA_OF(0.0, 0.0)},
	[KR_0] = {STRUCTURAL("KR-alpha 0", NO_SOLUTION KOLAY "0"), BY_PRODUCTS, .c = OF_RHO(0.0)},
	[KR_5] = {STRUCTURAL("KR-alpha 0.5", NO_SOLUTION KOLAY "0.5"), BY_PRODUCTS, .c = OF_RHO(0.5)},
	[KR_1] = {STRUCTURAL("KR-alpha 1", NO_SOLUTION KOLAY "1"), BY_PRODUCTS, .c = OF_RHO(1.0)},
};

const struct method *const fixed_methods[] = {
	&schemes[0].method, &schemes[1].method, &schemes[2].method, &schemes[3].method, &schemes[4].method,
	&schemes[5].method, &schemes[6].method, NULL,
};
const struct method *const dormand_prince_fixed = &dormand_prince_5.method;
#define EACH_OF_FIVE(FIRST) \
	&structural[FIRST].method, &structural[FIRST + 1].method, &structural[FIRST + 2].method, \
	&structural[FIRST + 3].method, &structural[FIRST + 4].method
const struct method *const structural_methods[] = {EACH_OF_FIVE(HHT), NULL};
const struct method *const structural_others[] = {EACH_OF_FIVE(ALPHA_5), NULL};
