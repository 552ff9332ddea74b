/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Peers that know where a model with clearances changes (gears.h), as its user could write them:
 *
 *   CVODE Adams, roots      stopped by its root finding at each border, begun anew behind it
 *   exact in regions        the exponential of each region's matrix, loads as states; where a step ends in another
 *                           region it is halved until the crossing is known to 2^-27 of a step: forces have no jump
 *                           there, so what that leaves off is below rounding. What enters a region and leaves it
 *                           within a step is not seen.
 *
 * A region is the set of stops that are touched, as a mask. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "gears.h"
#include "sundials.h"

enum { REGIONS = 1 << HAND_STOPS, SIZE = 2 * HAND_MASSES + 3, LEVELS = 28 };

/* What both have of a system */
struct regions {
	int n, size, stops;             /* size: of z = y, 1, cos w t, sin w t */
	double row[HAND_STOPS][HAND_MASSES], gap[HAND_STOPS];
	double generator[REGIONS][SIZE * SIZE];         /* z' = generator z, row-major, size x size */
	double w;
	int now;                        /* the region of the state */
};

/* ---- the system as matrices ---- */

static void fill(struct regions *r, const struct hand_system *s)
{
	const int n = r->n = s->n, size = r->size = 2 * n + 3;
	r->stops = s->stops;
	r->w = (double)s->w;
	for (int i = 0; i < s->stops; i++) {
		r->gap[i] = (double)s->stop[i].gap;
		for (int j = 0; j < n; j++)
			r->row[i][j] = (double)s->stop[i].row[j];
	}
	for (int region = 0; region < 1 << s->stops; region++) {
		double *A = r->generator[region];
		for (int i = 0; i < n; i++) {
			double *row = A + (n + i) * size;
			A[i * size + n + i] = 1.0;
			row[2 * n] = (double)s->f0[i];
			row[2 * n + 1] = (double)s->fa[i];
			for (int j = 0; j < n; j++) {
				row[j] = (double)-s->K[i][j];
				row[n + j] = (double)-s->C[i][j];
			}
			for (int k = 0; k < s->stops; k++) {
				const struct hand_stop *stop = &s->stop[k];
				if (!(region >> k & 1))
					continue;
				row[2 * n] += (double)(stop->push[i] * stop->k * stop->gap);
				for (int j = 0; j < n; j++)
					row[j] -= (double)(stop->push[i] * stop->k * stop->row[j]);
			}
		}
		A[(2 * n + 1) * size + 2 * n + 2] = -r->w;
		A[(2 * n + 2) * size + 2 * n + 1] = r->w;
	}
}

static double distance(const struct regions *r, int stop, const double *y)
{
	double sum = -r->gap[stop];
	for (int j = 0; j < r->n; j++)
		sum += r->row[stop][j] * y[j];
	return sum;
}

static int region_of(const struct regions *r, const double *y)
{
	int region = 0;
	for (int k = 0; k < r->stops; k++)
		region |= (distance(r, k, y) > 0.0) << k;
	return region;
}

/* false: the problem has no clearances that are known here */
static bool find_regions(const struct problem *p, struct regions *r)
{
	static struct hand_system s;
	if (p->rhs_of || !gears_of(p->name, &s))
		return false;
	fill(r, &s);
	return true;
}

/* ---- exact in regions ---- */

struct exact {
	struct run run;
	struct regions regions;
	int steps;                      /* in a unit */
	double h, z[SIZE];
	double *Phi[REGIONS][LEVELS];   /* exponentials of h 2^-level, made when they are first wanted */
};

static void exact_restart(struct run *run)
{
	struct exact *r = (struct exact *)run;
	const int own = 2 * r->regions.n;
	memset(r->z, 0, sizeof r->z);
	memcpy(r->z, run->problem->start, (size_t)own * sizeof *r->z);
	r->z[own] = r->z[own + 1] = 1.0;
	r->regions.now = region_of(&r->regions, r->z);
}

static const double *exponential_of(struct exact *r, int level)
{
	const struct regions *of = &r->regions;
	double **Phi = &r->Phi[of->now][level];
	if (!*Phi) {
		*Phi = room_for((size_t)(of->size * of->size), sizeof **Phi);
		rounded_exponential(of->size, of->generator[of->now], ldexp(r->h, -level), *Phi);
	}
	return *Phi;
}

/* h 2^-level on: at once where it ends in the same region, else in halves; the least part may end in another */
static void exact_part(struct exact *r, int level)
{
	const int size = r->regions.size;
	const double *Phi = exponential_of(r, level);
	double next[SIZE];
	for (int i = 0; i < size; i++) {
		double sum = 0.0;
		for (int j = 0; j < size; j++)
			sum += Phi[i * size + j] * r->z[j];
		next[i] = sum;
	}
	const int region = region_of(&r->regions, next);
	if (region == r->regions.now || level == LEVELS - 1) {
		memcpy(r->z, next, sizeof next);
		r->regions.now = region;
		return;
	}
	exact_part(r, level + 1);
	exact_part(r, level + 1);
}

static bool exact_advance(struct run *run, int units, double *rows)
{
	struct exact *r = (struct exact *)run;
	const int own = 2 * r->regions.n;
	for (int u = 0; u < units; u++) {
		for (int k = 0; k < r->steps; k++)
			exact_part(r, 0);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * own, r->z, (size_t)own * sizeof *rows);
	}
	return all_finite(own, r->z);
}

/* Whole steps, then the binary digits of what is left */
static void exact_between(struct run *run, double fraction, double *y)
{
	struct exact *r = (struct exact *)run;
	const int region = r->regions.now;
	double kept[SIZE], left = fraction * r->steps;
	memcpy(kept, r->z, sizeof kept);
	for (int level = 0; level < LEVELS; level++)
		for (; left >= ldexp(1.0, -level); left -= ldexp(1.0, -level))
			exact_part(r, level);
	run_get(run, y);
	memcpy(r->z, kept, sizeof kept);
	r->regions.now = region;
}

static void exact_close(struct run *run)
{
	struct exact *r = (struct exact *)run;
	for (int k = 0; k < REGIONS * LEVELS; k++)
		free(r->Phi[k / LEVELS][k % LEVELS]);
	free(r);
}

static struct run *exact_open(const struct method *method, const struct problem *problem, double setting)
{
	const int steps = steps_of(problem, setting);
	struct exact *r = steps > 0 ? calloc(1, sizeof *r) : NULL;
	if (!r || !find_regions(problem, &r->regions)) {
		free(r);
		return NULL;
	}
	r->steps = steps;
	r->h = problem->unit / steps;
	r->run = (struct run){.method = method, .problem = problem, .setting = r->h, .restart = exact_restart,
	                      .advance = exact_advance, .between = exact_between, .get = run_get,
	                      .evaluations = run_evaluations, .close = exact_close, .now = r->z, .asked = -1};
	exact_restart(&r->run);
	return &r->run;
}

/* ---- CVODE with root finding ---- */

struct roots {
	struct sundials sundials;
	struct regions regions;
};

static void roots_slope(const void *of, double t, const double *x, double *f)
{
	const struct regions *r = of;
	const int n = r->n, size = r->size;
	const double *A = r->generator[r->now], c = cos(r->w * t);
	for (int i = 0; i < n; i++) {
		const double *row = A + (n + i) * size;
		double sum = row[2 * n] + row[2 * n + 1] * c;
		for (int j = 0; j < 2 * n; j++)
			sum += row[j] * x[j];
		f[i] = x[n + i];
		f[n + i] = sum;
	}
}

static int roots_distance(realtype t, N_Vector y, realtype *g, void *of)
{
	const struct regions *r = &((const struct roots *)of)->regions;
	(void)t;
	for (int k = 0; k < r->stops; k++)
		g[k] = distance(r, k, NV_DATA_S(y));
	return 0;
}

static void roots_crossed(struct sundials *s, double t, const int *found)
{
	struct regions *r = &((struct roots *)s)->regions;
	(void)t;
	for (int k = 0; k < r->stops; k++)
		if (found[k] != 0)
			r->now = found[k] > 0 ? r->now | 1 << k : r->now & ~(1 << k);
}

static bool roots_make(struct adaptive *a)
{
	struct roots *r = (struct roots *)a;
	if (!find_regions(a->run.problem, &r->regions))
		return false;
	a->rhs = (struct asked){NULL, roots_slope, &r->regions};
	r->sundials.roots = r->regions.stops;
	r->sundials.distance = roots_distance;
	r->sundials.crossed = roots_crossed;
	return cvode_make(a);
}

static bool roots_begin(struct adaptive *a, double t, const double *y)
{
	struct regions *r = &((struct roots *)a)->regions;
	r->now = region_of(r, y);
	return cvode_begin(a, t, y);
}

static const struct solver roots_solver = {
	.bytes = sizeof(struct roots), .make = roots_make, .begin = roots_begin, .reach = roots_reach,
	.looks_ahead = true, .discard = cvode_discard,
};

/* ---- the list ---- */

static const struct kind cvode_roots = {
	.method = BY_TOLERANCE("CVODE Adams, roots", 0,
	                       "order 1 to 12, fixed-point iteration, the matrix of each region, CVodeRootInit at its "
	                       "borders, CVodeReInit behind them; output from its interpolant"),
	.solver = &roots_solver, .formula = CV_ADAMS,
};
static const struct method exact_bisection = {
	.name = "exact in regions, bisection", .family = FIXED, .open = exact_open,
	.settings = "fixed step; e^{Ah} of each region in long double, rounded; a step that ends in another region is "
	            "halved until the crossing is known to 2^-27 of it",
};

const struct method *const clearance_methods[] = { &cvode_roots.method, &exact_bisection, NULL };
