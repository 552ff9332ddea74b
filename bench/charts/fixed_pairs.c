/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * The higher formula of two embedded pairs at a fixed step: what an adaptive solver does while its error estimate does
 * not bind.
 */
#include "amplification.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct pair {
	struct run run;
	int steps;                      /* in a unit */
	double h;
	long units, evaluations;
	double *y, *k[7], *work;        /* 2n each */
	gsl_odeiv2_step *gsl;           /* NULL: Dormand and Prince */
};

static struct pair *of(struct run *run)
{
	return (struct pair *)run;
}

/* Dormand and Prince, J. Computational and Applied Mathematics 6 (1980) 19-26, of order 5; its row 7 is the step */
static const double nodes[7] = {0, 1 / 5.0, 3 / 10.0, 4 / 5.0, 8 / 9.0, 1, 1};
static const double rows_of[7][6] = {
	{0},
	{1 / 5.0},
	{3 / 40.0, 9 / 40.0},
	{44 / 45.0, -56 / 15.0, 32 / 9.0},
	{19372 / 6561.0, -25360 / 2187.0, 64448 / 6561.0, -212 / 729.0},
	{9017 / 3168.0, -355 / 33.0, 46732 / 5247.0, 49 / 176.0, -5103 / 18656.0},
	{35 / 384.0, 0, 500 / 1113.0, 125 / 192.0, -2187 / 6784.0, 11 / 84.0},
};

/* k[0] is the slope at y: the last one of the step before (first same as last) */
static bool dormand_prince_step(struct pair *p, double t)
{
	const int size = 2 * p->run.problem->n;
	for (int stage = 1; stage < 7; stage++) {
		for (int i = 0; i < size; i++) {
			double sum = 0;
			for (int j = 0; j < stage; j++)
				sum += rows_of[stage][j] * p->k[j][i];
			p->work[i] = p->y[i] + p->h * sum;
		}
		problem_slope(p->run.problem, t + nodes[stage] * p->h, p->work, p->k[stage]);
	}
	memcpy(p->y, p->work, (size_t)size * sizeof *p->y);
	memcpy(p->k[0], p->k[6], (size_t)size * sizeof *p->y);
	return true;
}

static int gsl_slope(double t, const double y[], double dydt[], void *of_run)
{
	struct pair *p = of_run;
	p->evaluations++;
	problem_slope(p->run.problem, t, y, dydt);
	return GSL_SUCCESS;
}

static bool gsl_pair_step(struct pair *p, double t)
{
	const gsl_odeiv2_system system = {gsl_slope, NULL, 2 * (size_t)p->run.problem->n, p};
	return gsl_odeiv2_step_apply(p->gsl, t, p->h, p->y, p->work, NULL, NULL, &system) == GSL_SUCCESS;
}

static bool is_finite(const struct pair *p)
{
	for (int i = 0; i < 2 * p->run.problem->n; i++)
		if (!isfinite(p->y[i]))
			return false;
	return true;
}

static bool advance(struct run *run, int units, double *rows)
{
	struct pair *p = of(run);
	const int size = 2 * run->problem->n;
	bool good = true;
	for (int u = 0; u < units && good; u++) {
		const double t = (double)p->units * run->problem->unit;
		for (int i = 0; i < p->steps && good; i++)
			good = p->gsl ? gsl_pair_step(p, t + i * p->h) : dormand_prince_step(p, t + i * p->h);
		p->units++;
		good = good && is_finite(p);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * size, p->y, sizeof *rows * (size_t)size);
	}
	return good;
}

static void restart(struct run *run)
{
	struct pair *p = of(run);
	memcpy(p->y, run->problem->start, 2 * sizeof *p->y * (size_t)run->problem->n);
	p->units = p->evaluations = 0;
	if (p->gsl)
		gsl_odeiv2_step_reset(p->gsl);
	else
		problem_slope(run->problem, 0, p->y, p->k[0]);
}

static void get(const struct run *run, double *y)
{
	memcpy(y, ((const struct pair *)run)->y, 2 * sizeof *y * (size_t)run->problem->n);
}

static long evaluations(const struct run *run)
{
	const struct pair *p = (const struct pair *)run;
	return p->gsl ? p->evaluations : 6 * p->units * p->steps + 1;
}

static void close_run(struct run *run)
{
	struct pair *p = of(run);
	if (p->gsl)
		gsl_odeiv2_step_free(p->gsl);
	free(p->y);
	free(p);
}

static struct run *open_run(const struct method *method, const struct problem *problem, double setting)
{
	const size_t size = 2 * (size_t)problem->n;
	struct pair *p = calloc(1, sizeof *p);
	double *next = calloc(9 * size, sizeof *next);
	if (!p || !next)
		abort();
	p->run = (struct run){.method = method, .problem = problem, .setting = setting, .restart = restart,
	                      .advance = advance, .get = get,
	                      .evaluations = evaluations, .close = close_run};
	p->steps = (int)round(problem->unit / setting);
	p->h = problem->unit / p->steps;
	p->y = next;
	p->work = next + size;
	for (size_t i = 0; i < 7; i++)
		p->k[i] = next + (2 + i) * size;
	if (method == &rk8pd_fixed)
		p->gsl = gsl_odeiv2_step_alloc(gsl_odeiv2_step_rk8pd, size);
	restart(&p->run);
	return &p->run;
}

const struct method dormand_prince_fixed = {.name = "Dormand-Prince 5 (fixed step)", .family = FIXED, .order = 5,
	.settings = "the formula of order 5 at a fixed step", .open = open_run};
const struct method rk8pd_fixed = {.name = "GSL rk8pd (fixed step)", .family = FIXED, .order = 8,
	.settings = "gsl_odeiv2_step_apply at a fixed step", .open = open_run};
