/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The time integrators of structural dynamics beyond those of classic.c, for linear problems M a + C v + K x = F(t), of
 * which problem.c has M^-1 K and M^-1 C in A. Written from their papers:
 *
 *   HHT-alpha         Hilber, Hughes, Taylor, Earthq. Eng. Struct. Dyn. 5 (1977) 283
 *   generalized-alpha Chung, Hulbert, J. Applied Mechanics 60 (1993) 371
 *   Bathe             Bathe, Computers and Structures 85 (2007) 437: two substeps of h/2
 *   rho-Bathe         Noh, Bathe, Computers and Structures 212 (2019) 299
 *   CR                Chen, Ricles, J. Eng. Mech. 134 (2008) 676
 *   KR-alpha          Kolay, Ricles, Earthq. Eng. Struct. Dyn. 43 (2014) 1361
 *
 * Loads between steps are asked at the time that a method weighs its ends to. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "charts.h"
#include "factors.h"

enum kind { ALPHA, COMPOSITE, EXPLICIT };

struct scheme {
	struct method method;       /* first: a pointer to it is a pointer to this */
	enum kind kind;
	double hht;                 /* HHT: its alpha, -1/3 to 0; else 0 */
	double rho;                 /* the others: the spectral radius for large steps, 0 to 1 */
	double substep;             /* COMPOSITE: the first one, over h; 0: the best one of rho */
	bool plain;                 /* EXPLICIT: CR */
};

/* What a step of one length needs */
struct part {
	double h;
	double alpha_m, alpha_f, beta, gamma;           /* ALPHA, EXPLICIT */
	double substep, q0, q1, q2;                     /* COMPOSITE */
	struct factors first, second;                   /* EXPLICIT: none kept */
	double *to_velocity, *to_place, *loads, *before;/* EXPLICIT: n x n, see explicit_step */
	double *memory;
	int *rows;
};

struct structural {
	struct run run;
	void (*rhs)(double t, const double y[], double dydt[]);
	void (*rhs_of)(const void *of, double t, const double y[], double dydt[]);
	const void *of;
	int n;
	int steps;                  /* in a unit */
	double h;
	long units, evaluations;
	bool failed;
	double *state, *ahead;      /* 3n each: coordinates, velocities, accelerations; ahead: of `between` */
	double *work[5];            /* 2n each */
	struct part every, rest;
};

typedef void step_function(struct structural *s, const struct part *p, double t, double *state);

INLINE void slope(struct structural *s, double t, const double *y, double *dydt)
{
	s->evaluations++;
	if (s->rhs)
		s->rhs(t, y, dydt);
	else
		s->rhs_of(s->of, t, y, dydt);
}

static const struct scheme *scheme_of(const struct structural *s)
{
	return (const struct scheme *)s->run.method;
}

/* ---- constants and matrices of a step ---- */

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

static void alpha_constants(const struct scheme *scheme, struct part *p)
{
	const double rho = scheme->rho;
	const bool weighted = scheme->hht == 0.0 && !scheme->plain;
	p->alpha_m = weighted ? (2.0 * rho - 1.0) / (rho + 1.0) : 0.0;
	p->alpha_f = weighted ? rho / (rho + 1.0) : -scheme->hht;
	p->gamma = 0.5 - p->alpha_m + p->alpha_f;
	p->beta = 0.25 * (1.0 - p->alpha_m + p->alpha_f) * (1.0 - p->alpha_m + p->alpha_f);
}

static void alpha_prepare(const struct scheme *scheme, const struct problem *problem, struct part *p)
{
	alpha_constants(scheme, p);
	const double share = 1.0 - p->alpha_f;
	effective(problem, 1.0 - p->alpha_m, share * p->gamma * p->h, share * p->beta * p->h * p->h, p->first.matrix);
	factor(&p->first);
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

/* With D = M + gamma h C + beta h^2 K, M = 1, and E = (1 - alpha_f) D + alpha_f - alpha_m:
 *   v+ = v + h A1 a, A1 = D^-1                  x+ = x + h v + h^2 (1/2 + gamma) A1 a
 *   (1 - A3) a+ = f - A3 a, A3 = D^-1 (alpha_f D + alpha_m - alpha_f), so (1 - A3)^-1 = E^-1 D
 * f: the acceleration that loads and forces give in between. CR: alpha_m = alpha_f = 0, beta = 1/4, so A3 = 0. */
static void explicit_prepare(const struct scheme *scheme, const struct problem *problem, struct part *p)
{
	const int n = problem->n;
	const double h = p->h;
	double right[n], column[n], D[n * n];
	alpha_constants(scheme, p);
	const double share = 1.0 - p->alpha_f, velocity = p->gamma * h, place = p->beta * h * h;
	effective(problem, 1.0, velocity, place, D);
	effective(problem, 1.0 - p->alpha_m, share * velocity, share * place, p->second.matrix);
	memcpy(p->first.matrix, D, sizeof D);
	factor(&p->first);
	factor(&p->second);
	for (int j = 0; j < n; j++) {
		for (int i = 0; i < n; i++)
			right[i] = i == j;
		solve(&p->first, right, column);
		for (int i = 0; i < n; i++) {
			p->to_velocity[i * n + j] = h * column[i];
			p->to_place[i * n + j] = h * h * (0.5 + p->gamma) * column[i];
			right[i] = D[i * n + j];
		}
		solve(&p->second, right, column);
		for (int i = 0; i < n; i++) {
			p->loads[i * n + j] = column[i];
			p->before[i * n + j] = column[i] - (i == j);    /* (1 - A3)^-1 A3 */
		}
	}
}

static void prepare(const struct scheme *scheme, const struct problem *problem, struct part *p, double h)
{
	p->h = h;
	if (scheme->kind == ALPHA)
		alpha_prepare(scheme, problem, p);
	else if (scheme->kind == COMPOSITE)
		composite_prepare(scheme, problem, p);
	else
		explicit_prepare(scheme, problem, p);
}

/* ---- the steps ---- */

INLINE void alpha_step(struct structural *s, const struct part *p, double t, double *state)
{
	const int n = s->n;
	const double h = p->h, share = 1.0 - p->alpha_f;
	double *q = state, *v = state + n, *a = state + 2 * n;
	double *restrict y = s->work[0], *restrict f = s->work[1], *restrict end = s->work[2];
	for (int i = 0; i < n; i++) {
		y[i] = q[i] + share * h * (v[i] + h * (0.5 - p->beta) * a[i]);
		y[n + i] = v[i] + share * h * (1.0 - p->gamma) * a[i];
	}
	slope(s, t + share * h, y, f);
	for (int i = 0; i < n; i++)
		f[n + i] -= p->alpha_m * a[i];
	solve(&p->first, f + n, end);
	for (int i = 0; i < n; i++) {
		q[i] += h * (v[i] + h * ((0.5 - p->beta) * a[i] + p->beta * end[i]));
		v[i] += h * ((1.0 - p->gamma) * a[i] + p->gamma * end[i]);
		a[i] = end[i];
	}
}

INLINE void composite_step(struct structural *s, const struct part *p, double t, double *state)
{
	const int n = s->n;
	const double h = p->h, g = p->substep * h, half = 0.5 * g, share = p->q2 * h;
	double *q = state, *v = state + n, *a = state + 2 * n;
	double *restrict y = s->work[0], *restrict f = s->work[1], *restrict middle = s->work[2];
	double *restrict vm = s->work[3], *restrict end = s->work[4];
	for (int i = 0; i < n; i++) {
		y[i] = q[i] + g * v[i] + half * half * a[i];
		y[n + i] = v[i] + half * a[i];
	}
	slope(s, t + g, y, f);
	solve(&p->first, f + n, middle);
	for (int i = 0; i < n; i++) {
		vm[i] = v[i] + half * (a[i] + middle[i]);
		const double known = v[i] + h * (p->q0 * a[i] + p->q1 * middle[i]);
		y[n + i] = known;
		y[i] = q[i] + h * (p->q0 * v[i] + p->q1 * vm[i] + p->q2 * known);
	}
	slope(s, t + h, y, f);
	solve(&p->second, f + n, end);
	for (int i = 0; i < n; i++) {
		q[i] = y[i] + share * share * end[i];
		v[i] = y[n + i] + share * end[i];
		a[i] = end[i];
	}
}

/* No equations are solved: products with matrices of the step */
INLINE void explicit_step(struct structural *s, const struct part *p, double t, double *state)
{
	const int n = s->n;
	const double h = p->h, share = 1.0 - p->alpha_f;
	double *q = state, *v = state + n, *a = state + 2 * n;
	double *restrict y = s->work[0], *restrict f = s->work[1], *restrict dv = s->work[2], *restrict dq = s->work[3];
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
	slope(s, t + share * h, y, f);
	for (int i = 0; i < n; i++) {
		double sum = 0.0;
		for (int j = 0; j < n; j++)
			sum += p->loads[i * n + j] * f[n + j] - p->before[i * n + j] * a[j];
		y[i] = sum;
	}
	for (int i = 0; i < n; i++) {
		q[i] += dq[i];
		v[i] += dv[i];
		a[i] = y[i];
	}
}

/* ---- the run as charts.h has it ---- */

static bool all_finite(int size, const double *y)
{
	double zero = 0.0;
	for (int i = 0; i < size; i++)
		zero += 0.0 * y[i];
	return zero == 0.0;
}

INLINE bool march(struct run *run, int units, double *rows, step_function *step)
{
	struct structural *s = (struct structural *)run;
	const int size = 2 * s->n;
	for (int u = 0; u < units && !s->failed; u++) {
		const double t = (double)s->units * run->problem->unit, h = s->h;
		for (int k = 0; k < s->steps; k++)
			step(s, &s->every, t + k * h, s->state);
		s->units++;
		s->failed = !all_finite(size, s->state);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * size, s->state, sizeof *rows * (size_t)size);
	}
	return !s->failed;
}

static bool alpha_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, alpha_step);
}

static bool composite_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, composite_step);
}

static bool explicit_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, explicit_step);
}

static void one_step(struct structural *s, const struct part *p, double t, double *state)
{
	const enum kind kind = scheme_of(s)->kind;
	if (kind == ALPHA)
		alpha_step(s, p, t, state);
	else if (kind == COMPOSITE)
		composite_step(s, p, t, state);
	else
		explicit_step(s, p, t, state);
}

static void structural_restart(struct run *run)
{
	struct structural *s = (struct structural *)run;
	const size_t n = (size_t)s->n;
	memcpy(s->state, run->problem->start, 2 * n * sizeof *s->state);
	s->units = s->evaluations = 0;
	s->failed = false;
	slope(s, 0.0, s->state, s->work[0]);
	memcpy(s->state + 2 * n, s->work[0] + n, n * sizeof *s->state);
}

/* Whole steps, then one of what is left of `fraction`, which has matrices of its own */
static void structural_between(struct run *run, double fraction, double *y)
{
	struct structural *s = (struct structural *)run;
	const double t = (double)s->units * run->problem->unit;
	const int whole = (int)floor(fraction * s->steps + 1e-9);
	const double rest = fraction * run->problem->unit - whole * s->h;
	const long evaluations = s->evaluations;
	memcpy(s->ahead, s->state, 3 * (size_t)s->n * sizeof *s->state);
	for (int k = 0; k < whole; k++)
		one_step(s, &s->every, t + k * s->h, s->ahead);
	if (rest > 1e-9 * s->h) {
		if (s->rest.h != rest)
			prepare(scheme_of(s), run->problem, &s->rest, rest);
		one_step(s, &s->rest, t + whole * s->h, s->ahead);
	}
	s->evaluations = evaluations;
	for (int i = 0; i < 2 * s->n; i++)
		y[i] = s->failed ? NAN : s->ahead[i];
}

static void structural_get(const struct run *run, double *y)
{
	const struct structural *s = (const struct structural *)run;
	memcpy(y, s->state, 2 * (size_t)s->n * sizeof *y);
}

static long structural_evaluations(const struct run *run)
{
	return ((const struct structural *)run)->evaluations;
}

static void structural_close(struct run *run)
{
	struct structural *s = (struct structural *)run;
	free(s->state);
	free(s->every.memory);
	free(s->every.rows);
	free(s->rest.memory);
	free(s->rest.rows);
	free(s);
}

static bool allot_part(struct part *p, int size)
{
	const size_t n = (size_t)size;
	double *next = p->memory = calloc(6 * n * n + 2 * n, sizeof *next);
	p->rows = calloc(2 * n, sizeof *p->rows);
	if (!next || !p->rows)
		return false;
	p->first = (struct factors){.size = size, .matrix = next, .reciprocal = next + n * n, .row = p->rows};
	next += n * n + n;
	p->second = (struct factors){.size = size, .matrix = next, .reciprocal = next + n * n, .row = p->rows + n};
	p->to_velocity = next += n * n + n;
	p->to_place = next += n * n;
	p->loads = next += n * n;
	p->before = next + n * n;
	return true;
}

static bool allot(struct structural *s)
{
	const size_t n = (size_t)s->n;
	double *next = s->state = calloc((3 + 3 + 5 * 2) * n, sizeof *next);
	if (!next || !allot_part(&s->every, s->n) || !allot_part(&s->rest, s->n))
		return false;
	s->ahead = next += 3 * n;
	next += 3 * n;
	for (int i = 0; i < 5; i++, next += 2 * n)
		s->work[i] = next;
	return true;
}

static struct run *structural_open(const struct method *method, const struct problem *problem, double setting)
{
	const double steps = round(problem->unit / setting);
	if (!problem->linear || !problem->A || !(setting > 0.0) || !(steps >= 1.0 && steps <= 1e9) ||
	    setting > problem->unit * (1.0 + 1e-9))
		return NULL;
	struct structural *s = calloc(1, sizeof *s);
	if (!s)
		return NULL;
	s->run = (struct run){.method = method, .problem = problem, .restart = structural_restart,
	                      .between = structural_between, .get = structural_get,
	                      .evaluations = structural_evaluations, .close = structural_close};
	s->rhs = problem->rhs_of ? NULL : problem->rhs;
	s->rhs_of = problem->rhs_of;
	s->of = problem->of;
	s->n = problem->n;
	s->steps = (int)steps;
	s->run.setting = s->h = problem->unit / steps;
	const enum kind kind = scheme_of(s)->kind;
	s->run.advance = kind == ALPHA ? alpha_advance : kind == COMPOSITE ? composite_advance : explicit_advance;
	if (!allot(s)) {
		structural_close(&s->run);
		return NULL;
	}
	prepare(scheme_of(s), problem, &s->every, s->h);
	structural_restart(&s->run);
	return &s->run;
}

/* ---- the list ---- */

#define STRUCTURAL(NAME, SETTINGS) \
	.method = {.name = NAME, .family = FIXED, .linear_only = true, .order = 2, .settings = SETTINGS, \
	           .open = structural_open}
#define ONE_SOLUTION "fixed step; matrix factored once, 1 evaluation and 1 solution a step"
#define TWO_SOLUTIONS \
	"fixed step; two substeps, each with its matrix factored once: 2 evaluations and 2 solutions a step"
#define NO_SOLUTION \
	"fixed step; explicit: products with matrices of the step, 1 evaluation a step; first order after a load " \
	"that sets in at once"

static const struct scheme hht = {
	STRUCTURAL("HHT-alpha", ONE_SOLUTION "; Hilber, Hughes and Taylor 1977, alpha = -0.1"),
	.kind = ALPHA, .hht = -0.1};
static const struct scheme alpha_5 = {
	STRUCTURAL("generalized-alpha 0.5", ONE_SOLUTION "; Chung and Hulbert 1993, spectral radius at infinity 0.5"),
	.kind = ALPHA, .rho = 0.5};
static const struct scheme bathe = {
	STRUCTURAL("Bathe", TWO_SOLUTIONS "; Bathe 2007, substeps h/2"),
	.kind = COMPOSITE, .rho = 0.0, .substep = 0.5};
static const struct scheme rho_bathe_0 = {
	STRUCTURAL("rho-Bathe 0", TWO_SOLUTIONS "; Noh and Bathe 2019, spectral radius at infinity 0"),
	.kind = COMPOSITE, .rho = 0.0};
static const struct scheme rho_bathe_5 = {
	STRUCTURAL("rho-Bathe 0.5", TWO_SOLUTIONS "; Noh and Bathe 2019, spectral radius at infinity 0.5"),
	.kind = COMPOSITE, .rho = 0.5};
static const struct scheme rho_bathe_1 = {
	STRUCTURAL("rho-Bathe 1", TWO_SOLUTIONS "; Noh and Bathe 2019, spectral radius at infinity 1"),
	.kind = COMPOSITE, .rho = 1.0};
static const struct scheme cr = {
	STRUCTURAL("CR", NO_SOLUTION "; Chen and Ricles 2008"),
	.kind = EXPLICIT, .rho = 1.0, .plain = true};
static const struct scheme kr_0 = {
	STRUCTURAL("KR-alpha 0", NO_SOLUTION "; Kolay and Ricles 2014, spectral radius at infinity 0"),
	.kind = EXPLICIT, .rho = 0.0};
static const struct scheme kr_5 = {
	STRUCTURAL("KR-alpha 0.5", NO_SOLUTION "; Kolay and Ricles 2014, spectral radius at infinity 0.5"),
	.kind = EXPLICIT, .rho = 0.5};
static const struct scheme kr_1 = {
	STRUCTURAL("KR-alpha 1", NO_SOLUTION "; Kolay and Ricles 2014, spectral radius at infinity 1"),
	.kind = EXPLICIT, .rho = 1.0};

const struct method *const structural_methods[] = {
	&hht.method, &bathe.method, &rho_bathe_5.method, &cr.method, &kr_5.method, NULL,
};
const struct method *const structural_others[] = {
	&alpha_5.method, &rho_bathe_0.method, &rho_bathe_1.method, &kr_0.method, &kr_1.method, NULL,
};
