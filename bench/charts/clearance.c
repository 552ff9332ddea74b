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

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "charts.h"
#include "gears.h"

enum { REGIONS = 1 << HAND_STOPS, SIZE = 2 * HAND_MASSES + 3, LEVELS = 28, MOST_STEPS = 200000 };

struct clearance {
	struct run run;
	int n, size, stops;             /* size: of z = y, 1, cos w t, sin w t */
	double row[HAND_STOPS][HAND_MASSES], gap[HAND_STOPS];
	double generator[REGIONS][SIZE * SIZE];         /* z' = generator z, row-major, size x size */
	double w;
	long units, evaluations;
	bool failed;
	int region;
	/* exact in regions: exponentials of h 2^-level, made when they are first wanted */
	int steps;
	double h, z[SIZE];
	double *Phi[REGIONS][LEVELS];
	/* CVODE; `between` goes on with it, since it looks ahead within a unit */
	SUNContext context;
	N_Vector y, tolerances;
	SUNNonlinearSolver fixed_point;
	void *memory;
	double start[2 * HAND_MASSES];
};

/* ---- the system as matrices ---- */

static void fill(struct clearance *r, const struct hand_system *s)
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

static double distance(const struct clearance *r, int stop, const double *y)
{
	double sum = -r->gap[stop];
	for (int j = 0; j < r->n; j++)
		sum += r->row[stop][j] * y[j];
	return sum;
}

static int region_of(const struct clearance *r, const double *y)
{
	int region = 0;
	for (int k = 0; k < r->stops; k++)
		region |= (distance(r, k, y) > 0.0) << k;
	return region;
}

static void clearance_get(const struct run *run, double *y)
{
	const struct clearance *r = (const struct clearance *)run;
	memcpy(y, r->y ? NV_DATA_S(r->y) : r->z, 2 * (size_t)r->n * sizeof *y);
}

static long clearance_evaluations(const struct run *run)
{
	const struct clearance *r = (const struct clearance *)run;
	return r->y ? r->evaluations : -1;
}

static void clearance_close(struct run *run)
{
	struct clearance *r = (struct clearance *)run;
	for (int region = 0; region < REGIONS; region++)
		for (int level = 0; level < LEVELS; level++)
			free(r->Phi[region][level]);
	if (r->memory)
		CVodeFree(&r->memory);
	if (r->fixed_point)
		SUNNonlinSolFree(r->fixed_point);
	if (r->y)
		N_VDestroy(r->y);
	if (r->tolerances)
		N_VDestroy(r->tolerances);
	if (r->context)
		SUNContext_Free(&r->context);
	free(r);
}

static struct clearance *clearance_new(const struct method *method, const struct problem *problem, double setting)
{
	static struct hand_system s;
	void (*make)(struct hand_system *s) = problem->rhs_of ? NULL : gears_of(problem->name);
	struct clearance *r = make ? calloc(1, sizeof *r) : NULL;
	if (!r)
		return NULL;
	make(&s);
	fill(r, &s);
	r->run = (struct run){.method = method, .problem = problem, .setting = setting, .get = clearance_get,
	                      .evaluations = clearance_evaluations, .close = clearance_close};
	memcpy(r->start, problem->start, 2 * (size_t)r->n * sizeof *r->start);
	return r;
}

/* ---- exact in regions ---- */

static void exact_restart(struct run *run)
{
	struct clearance *r = (struct clearance *)run;
	memset(r->z, 0, sizeof r->z);
	memcpy(r->z, r->start, 2 * (size_t)r->n * sizeof *r->z);
	r->z[2 * r->n] = r->z[2 * r->n + 1] = 1.0;
	r->units = 0;
	r->region = region_of(r, r->z);
	r->failed = false;
}

static const double *exponential_of(struct clearance *r, int region, int level)
{
	double **Phi = &r->Phi[region][level];
	if (!*Phi) {
		*Phi = calloc((size_t)(r->size * r->size), sizeof **Phi);
		if (!*Phi)
			exit(1);
		rounded_exponential(r->size, r->generator[region], ldexp(r->h, -level), *Phi);
	}
	return *Phi;
}

/* h 2^-level on: at once where it ends in the same region, else in halves; the least part may end in another */
static void exact_part(struct clearance *r, int level)
{
	const int size = r->size;
	const double *Phi = exponential_of(r, r->region, level);
	double next[SIZE];
	for (int i = 0; i < size; i++) {
		double sum = 0.0;
		for (int j = 0; j < size; j++)
			sum += Phi[i * size + j] * r->z[j];
		next[i] = sum;
	}
	const int region = region_of(r, next);
	if (region == r->region || level == LEVELS - 1) {
		memcpy(r->z, next, sizeof next);
		r->region = region;
		return;
	}
	exact_part(r, level + 1);
	exact_part(r, level + 1);
}

static bool exact_advance(struct run *run, int units, double *rows)
{
	struct clearance *r = (struct clearance *)run;
	const int own = 2 * r->n;
	for (int u = 0; u < units; u++) {
		for (int k = 0; k < r->steps; k++)
			exact_part(r, 0);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * own, r->z, (size_t)own * sizeof *rows);
	}
	r->units += units;
	return all_finite(2 * r->n, r->z);
}

/* Whole steps, then the binary digits of what is left */
static void exact_between(struct run *run, double fraction, double *y)
{
	struct clearance *r = (struct clearance *)run;
	const int region = r->region;
	double kept[SIZE], left = fraction * r->steps;
	memcpy(kept, r->z, sizeof kept);
	for (int level = 0; level < LEVELS; level++)
		for (; left >= ldexp(1.0, -level); left -= ldexp(1.0, -level))
			exact_part(r, level);
	memcpy(y, r->z, 2 * (size_t)r->n * sizeof *y);
	memcpy(r->z, kept, sizeof kept);
	r->region = region;
}

static struct run *exact_open(const struct method *method, const struct problem *problem, double setting)
{
	const int steps = steps_of(problem, setting);
	struct clearance *r = steps > 0 ? clearance_new(method, problem, setting) : NULL;
	if (!r)
		return NULL;
	r->steps = steps;
	r->run.setting = r->h = problem->unit / steps;
	r->run.restart = exact_restart;
	r->run.advance = exact_advance;
	r->run.between = exact_between;
	exact_restart(&r->run);
	return &r->run;
}

/* ---- CVODE with root finding ---- */

static int roots_slope(realtype t, N_Vector y, N_Vector dydt, void *of)
{
	struct clearance *r = of;
	const int n = r->n, size = r->size;
	const double *A = r->generator[r->region], *x = NV_DATA_S(y), c = cos(r->w * t);
	double *f = NV_DATA_S(dydt);
	r->evaluations++;
	for (int i = 0; i < n; i++) {
		const double *row = A + (n + i) * size;
		double sum = row[2 * n] + row[2 * n + 1] * c;
		for (int j = 0; j < 2 * n; j++)
			sum += row[j] * x[j];
		f[i] = x[n + i];
		f[n + i] = sum;
	}
	return 0;
}

static int roots_distance(realtype t, N_Vector y, realtype *g, void *of)
{
	const struct clearance *r = of;
	(void)t;
	for (int k = 0; k < r->stops; k++)
		g[k] = distance(r, k, NV_DATA_S(y));
	return 0;
}

static void roots_silent(int code, const char *module, const char *function, char *message, void *of)
{
	(void)code, (void)module, (void)function, (void)message, (void)of;
}

static void roots_restart(struct run *run)
{
	struct clearance *r = (struct clearance *)run;
	memcpy(NV_DATA_S(r->y), r->start, 2 * (size_t)r->n * sizeof *r->start);
	r->units = r->evaluations = 0;
	r->region = region_of(r, r->start);
	r->failed = CVodeReInit(r->memory, 0.0, r->y) != 0;
}

/* Over borders, each of which changes the region by the stops found there */
static bool roots_reach(struct clearance *r, double end)
{
	int found[HAND_STOPS];
	double t = 0.0;
	for (int roots = 0; roots < MOST_STEPS; roots++) {
		const int said = CVode(r->memory, end, r->y, &t, CV_NORMAL);
		if (said < 0)
			return false;
		if (said != CV_ROOT_RETURN)
			return true;
		if (CVodeGetRootInfo(r->memory, found) != 0)
			return false;
		for (int k = 0; k < r->stops; k++)
			if (found[k] != 0)
				r->region = found[k] > 0 ? r->region | 1 << k : r->region & ~(1 << k);
		if (CVodeReInit(r->memory, t, r->y) != 0)
			return false;
		if (t >= end)
			return true;
	}
	return false;
}

static bool roots_advance(struct run *run, int units, double *rows)
{
	struct clearance *r = (struct clearance *)run;
	const int own = 2 * r->n;
	for (int u = 0; u < units && !r->failed; u++) {
		r->failed = !roots_reach(r, (double)++r->units * run->problem->unit);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * own, NV_DATA_S(r->y), (size_t)own * sizeof *rows);
	}
	r->failed = r->failed || !all_finite(2 * r->n, NV_DATA_S(r->y));
	return !r->failed;
}

static void roots_between(struct run *run, double fraction, double *y)
{
	struct clearance *r = (struct clearance *)run;
	const bool good = !r->failed && roots_reach(r, ((double)r->units + fraction) * run->problem->unit);
	for (int i = 0; i < 2 * r->n; i++)
		y[i] = good ? NV_Ith_S(r->y, i) : NAN;
}

static bool roots_make(struct clearance *r)
{
	const struct problem *p = r->run.problem;
	if (SUNContext_Create(NULL, &r->context) != 0)
		return false;
	r->y = N_VNew_Serial(2 * r->n, r->context);
	r->tolerances = N_VNew_Serial(2 * r->n, r->context);
	r->memory = CVodeCreate(CV_ADAMS, r->context);
	if (!r->y || !r->tolerances || !r->memory)
		return false;
	memcpy(NV_DATA_S(r->y), r->start, 2 * (size_t)r->n * sizeof *r->start);
	for (int i = 0; i < 2 * r->n; i++)
		NV_Ith_S(r->tolerances, i) = r->run.setting * (i < r->n ? p->scale_q : p->scale_v);
	r->fixed_point = SUNNonlinSol_FixedPoint(r->y, 0, r->context);
	return CVodeSetErrHandlerFn(r->memory, roots_silent, NULL) == 0 &&
	       CVodeInit(r->memory, roots_slope, 0.0, r->y) == 0 &&
	       CVodeSVtolerances(r->memory, r->run.setting, r->tolerances) == 0 &&
	       CVodeSetUserData(r->memory, r) == 0 && CVodeSetMaxNumSteps(r->memory, MOST_STEPS) == 0 &&
	       r->fixed_point && CVodeSetNonlinearSolver(r->memory, r->fixed_point) == 0 &&
	       CVodeRootInit(r->memory, r->stops, roots_distance) == 0;
}

static struct run *roots_open(const struct method *method, const struct problem *problem, double setting)
{
	struct clearance *r = setting > 0.0 && setting <= 1.0 && problem->scale_q > 0.0 && problem->scale_v > 0.0
		? clearance_new(method, problem, setting) : NULL;
	if (!r)
		return NULL;
	r->run.restart = roots_restart;
	r->run.advance = roots_advance;
	r->run.between = roots_between;
	if (!roots_make(r)) {
		clearance_close(&r->run);
		return NULL;
	}
	roots_restart(&r->run);
	return &r->run;
}

/* ---- the list ---- */

static const struct method cvode_roots = {
	.name = "CVODE Adams, roots", .family = ADAPTIVE, .tolerance = true, .open = roots_open,
	.settings = "rtol = setting, atol = rtol times largest coordinate, velocity; order 1 to 12, fixed-point "
	            "iteration, the matrix of each region, CVodeRootInit at its borders, CVodeReInit behind them; "
	            "output from its interpolant",
};
static const struct method exact_bisection = {
	.name = "exact in regions, bisection", .family = FIXED, .open = exact_open,
	.settings = "fixed step; e^{Ah} of each region in long double, rounded; a step that ends in another region is "
	            "halved until the crossing is known to 2^-27 of it",
};

const struct method *const clearance_methods[] = { &cvode_roots, &exact_bisection, NULL };
