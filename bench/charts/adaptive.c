/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Integrators that choose their steps, each configured as its manual advises: the Dormand-Prince pair written plainly
 * here, GSL's odeiv2, SUNDIALS' CVODE and ARKODE. The setting is the relative tolerance e. The absolute tolerance of
 * every coordinate is e times the largest coordinate of the history, of every velocity e times the largest velocity:
 * what a user who knows the problem would give, and here taken from what is true (truth_of; hard.c: its closed forms).
 * So the weight of an error is between e and 2 e of the scale for everyone, and no work is lost where something passes
 * through zero.
 *
 * Where an integrator has an interpolant it walks as it likes and output is read from it; one that has none (GSL), or
 * whose own is too coarse for its order, is stopped at each output time. The first kind looks ahead for `between`; for
 * the second a fresh solution at the same tolerance goes there from the end of the last unit. Neither changes the run.
 */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <arkode/arkode_arkstep.h>
#include <cvode/cvode.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "charts.h"

enum { MOST_STEPS = 200000 };       /* of its own, in a unit: then it has failed */
#define TOLERANCES "rtol = setting, atol = rtol times largest coordinate, velocity; "

struct adaptive {
	struct run run;
	void (*rhs)(double t, const double y[], double dydt[]);
	void (*rhs_of)(const void *of, double t, const double y[], double dydt[]);
	const void *of;
	int n, size;
	double *scale;              /* size: largest coordinate, or velocity, of the history */
	long units;                 /* gone since the start */
	long evaluations;
	bool failed;
	double *now;                /* at the end of the last unit */
	struct adaptive *aside;     /* `between`: a second one, made when it is first wanted */
};

/* What each integrator does in its own way */
struct solver {
	size_t bytes;               /* of its struct, which begins with a struct adaptive */
	bool (*make)(struct adaptive *a);
	bool (*begin)(struct adaptive *a, double t, const double *y);
	/* the solution at `end`, not before what was asked last */
	bool (*reach)(struct adaptive *a, double end, double *y);
	/* `reach` may be asked for a time inside a unit, and the run goes on as if it had not been */
	bool looks_ahead;
	void (*discard)(struct adaptive *a);
};

struct kind {
	struct method method;       /* first: a pointer to it is a pointer to this */
	const struct solver *solver;
	const gsl_odeiv2_step_type *const *gsl;     /* GSL: which */
	int formula;                /* CVODE: CV_ADAMS, CV_BDF */
};

static const struct kind *kind_of(const struct adaptive *a)
{
	return (const struct kind *)a->run.method;
}

static inline void slope(struct adaptive *a, double t, const double *y, double *dydt)
{
	a->evaluations++;
	if (a->rhs)
		a->rhs(t, y, dydt);
	else
		a->rhs_of(a->of, t, y, dydt);
}

/* ---- Dormand-Prince 5(4): Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, table II.5.2 ---- */

struct dormand {
	struct adaptive adaptive;
	double tolerance;
	double t, h;                /* the end of the last step, and the step to try next */
	double from, last;          /* where the last step began, and its length */
	double before;              /* size of the error before, for the controller */
	double *start, *y, *next;   /* of the last step; its end; of the one that is tried */
	double *k[7];
	double *spare;              /* the slope that the next step begins with */
};

static bool dormand_make(struct adaptive *a)
{
	struct dormand *d = (struct dormand *)a;
	const size_t size = (size_t)a->size;
	double *next = d->start = calloc(11 * size, sizeof *next);
	if (!next)
		return false;
	d->tolerance = a->run.setting;
	d->y = next += size;
	d->next = next += size;
	for (int i = 0; i < 7; i++)
		d->k[i] = next += size;
	d->spare = next + size;
	return true;
}

static double weighted(const struct dormand *d, const double *x)
{
	const struct adaptive *a = &d->adaptive;
	double sum = 0.0;
	for (int i = 0; i < a->size; i++) {
		const double share = x[i] / (d->tolerance * (a->scale[i] + fabs(d->y[i])));
		sum += share * share;
	}
	return sqrt(sum / a->size);
}

/* A first step: II.4 (4.14) there */
static double first_step(struct dormand *d)
{
	struct adaptive *a = &d->adaptive;
	const double size0 = weighted(d, d->y), size1 = weighted(d, d->spare);
	const double guess = size0 < 1e-5 || size1 < 1e-5 ? 1e-6 * a->run.problem->unit : 0.01 * size0 / size1;
	for (int i = 0; i < a->size; i++)
		d->next[i] = d->y[i] + guess * d->spare[i];
	slope(a, d->t + guess, d->next, d->k[1]);
	for (int i = 0; i < a->size; i++)
		d->k[2][i] = d->k[1][i] - d->spare[i];
	const double size2 = weighted(d, d->k[2]) / guess, most = fmax(size1, size2);
	const double h = most <= 1e-15 ? fmax(1e-6 * a->run.problem->unit, 1e-3 * guess) : pow(0.01 / most, 0.2);
	return fmin(100.0 * guess, h);
}

static bool dormand_begin(struct adaptive *a, double t, const double *y)
{
	struct dormand *d = (struct dormand *)a;
	memcpy(d->y, y, (size_t)a->size * sizeof *y);
	memcpy(d->start, y, (size_t)a->size * sizeof *y);
	d->t = d->from = t;
	d->last = 0.0;
	d->before = 1e-4;
	slope(a, t, d->y, d->spare);
	d->h = first_step(d);
	return d->h > 0.0 && isfinite(d->h);
}

/* From d->y with the slope k1 there to d->next, whose slope is k7; returns the weighted error */
static double dormand_try(struct dormand *d, double h)
{
	struct adaptive *a = &d->adaptive;
	const int size = a->size;
	const double t = d->t, *restrict y = d->y;
	double *restrict k1 = d->k[0], *restrict k2 = d->k[1], *restrict k3 = d->k[2], *restrict k4 = d->k[3],
		*restrict k5 = d->k[4];
	double *restrict k6 = d->k[5], *restrict k7 = d->k[6], *restrict x = d->next;
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (1.0 / 5.0 * k1[i]);
	slope(a, t + h * (1.0 / 5.0), x, k2);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (3.0 / 40.0 * k1[i] + 9.0 / 40.0 * k2[i]);
	slope(a, t + h * (3.0 / 10.0), x, k3);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i] + 32.0 / 9.0 * k3[i]);
	slope(a, t + h * (4.0 / 5.0), x, k4);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (19372.0 / 6561.0 * k1[i] - 25360.0 / 2187.0 * k2[i] + 64448.0 / 6561.0 * k3[i] -
		                   212.0 / 729.0 * k4[i]);
	slope(a, t + h * (8.0 / 9.0), x, k5);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (9017.0 / 3168.0 * k1[i] - 355.0 / 33.0 * k2[i] + 46732.0 / 5247.0 * k3[i] +
		                   49.0 / 176.0 * k4[i] - 5103.0 / 18656.0 * k5[i]);
	slope(a, t + h, x, k6);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (35.0 / 384.0 * k1[i] + 500.0 / 1113.0 * k3[i] + 125.0 / 192.0 * k4[i] -
		                   2187.0 / 6784.0 * k5[i] + 11.0 / 84.0 * k6[i]);
	slope(a, t + h, x, k7);
	double sum = 0.0;
	for (int i = 0; i < size; i++) {
		const double error = h * (71.0 / 57600.0 * k1[i] - 71.0 / 16695.0 * k3[i] + 71.0 / 1920.0 * k4[i] -
		                          17253.0 / 339200.0 * k5[i] + 22.0 / 525.0 * k6[i] - 1.0 / 40.0 * k7[i]);
		const double share = error / (d->tolerance * (a->scale[i] + fmax(fabs(y[i]), fabs(x[i]))));
		sum += share * share;
	}
	return sqrt(sum / size);
}

/* The end of the step becomes the start of the next; the first slope too (first same as last), but k7 stays for the
 * interpolant */
static void dormand_accept(struct dormand *d, double h)
{
	double *start = d->start;
	d->start = d->y;
	d->y = d->next;
	d->next = start;
	d->from = d->t;
	d->last = h;
	d->t += h;
	memcpy(d->spare, d->k[6], (size_t)d->adaptive.size * sizeof *d->spare);
}

/* Until a step is accepted, of at most `tries`; the controller is IV.2 (2.43c) of volume II, with its constants */
static bool dormand_step(struct dormand *d, int *tries)
{
	bool rejected = false;
	memcpy(d->k[0], d->spare, (size_t)d->adaptive.size * sizeof *d->spare);
	while ((*tries)-- > 0) {
		const double h = d->h, error = dormand_try(d, h);
		if (!isfinite(error) || d->t + 0.1 * h == d->t)
			return false;
		const double grow = 0.9 * pow(error, -0.17);
		if (error <= 1.0) {
			const double factor = fmin(10.0, fmax(0.2, grow * pow(d->before, 0.04)));
			d->h = h * (rejected ? fmin(1.0, factor) : factor);
			d->before = fmax(error, 1e-4);
			dormand_accept(d, h);
			return true;
		}
		rejected = true;
		d->h = h * fmax(0.2, grow);
	}
	return false;
}

/* Of fourth order, from the stages that there are: II.6 of volume I; the same as that of ode45 */
static void dormand_interpolate(const struct dormand *d, double t, double *y)
{
	const double x = d->last > 0.0 ? (t - d->from) / d->last : 0.0, h = d->last * x;
	const double b1 = h * (1.0 + x * (-183.0 / 64.0 + x * (37.0 / 12.0 - x * (145.0 / 128.0))));
	const double b3 = h * x * (1500.0 / 371.0 + x * (-1000.0 / 159.0 + x * (1000.0 / 371.0)));
	const double b4 = h * x * (-125.0 / 32.0 + x * (125.0 / 12.0 - x * (375.0 / 64.0)));
	const double b5 = h * x * (9477.0 / 3392.0 + x * (-729.0 / 106.0 + x * (25515.0 / 6784.0)));
	const double b6 = h * x * (-11.0 / 7.0 + x * (11.0 / 3.0 - x * (55.0 / 28.0)));
	const double b7 = h * x * (3.0 / 2.0 + x * (-4.0 + x * (5.0 / 2.0)));
	for (int i = 0; i < d->adaptive.size; i++)
		y[i] = d->start[i] + (b1 * d->k[0][i] + b3 * d->k[2][i] + b4 * d->k[3][i] + b5 * d->k[4][i] +
		                      b6 * d->k[5][i] + b7 * d->k[6][i]);
}

static bool dormand_reach(struct adaptive *a, double end, double *y)
{
	struct dormand *d = (struct dormand *)a;
	int tries = MOST_STEPS;
	if (end < d->from)
		return false;
	while (d->t < end)
		if (!dormand_step(d, &tries))
			return false;
	dormand_interpolate(d, end, y);
	return true;
}

static void dormand_discard(struct adaptive *a)
{
	struct dormand *d = (struct dormand *)a;
	double *block = d->start;   /* the three states change places */
	if (d->y && d->y < block)
		block = d->y;
	if (d->next && d->next < block)
		block = d->next;
	free(block);
}

static const struct solver dormand_solver = {
	.bytes = sizeof(struct dormand), .make = dormand_make, .begin = dormand_begin, .reach = dormand_reach,
	.looks_ahead = true,
	.discard = dormand_discard,
};

/* ---- the scales: what is true says them ---- */

/* A coordinate that never moves has no scale of its own: 1 */
static void set_scales(struct adaptive *a)
{
	const struct problem *p = a->run.problem;
	if (!isfinite(p->scale_q + p->scale_v) || !(p->scale_q + p->scale_v > 0.0)) {
		fprintf(stderr, "%s: %s before its scales are known\n", p->name, a->run.method->name);
		exit(1);
	}
	for (int i = 0; i < a->n; i++) {
		a->scale[i] = p->scale_q > 0.0 ? p->scale_q : 1.0;
		a->scale[a->n + i] = p->scale_v > 0.0 ? p->scale_v : 1.0;
	}
}

/* ---- GSL odeiv2 ---- */

struct gsl {
	struct adaptive adaptive;
	gsl_odeiv2_system system;
	gsl_odeiv2_driver *driver;
	double first;               /* its first step */
	double t;
	double *y;
};

static int gsl_slope(double t, const double y[], double dydt[], void *of)
{
	slope(of, t, y, dydt);
	return GSL_SUCCESS;
}

static bool gsl_make(struct adaptive *a)
{
	struct gsl *g = (struct gsl *)a;
	const gsl_odeiv2_step_type *type = *kind_of(a)->gsl;
	const bool fixed = !a->run.method->tolerance;
	gsl_set_error_handler_off();
	g->system = (gsl_odeiv2_system){.function = gsl_slope, .dimension = (size_t)a->size, .params = a};
	g->first = fixed ? a->run.setting : 1e-3 * a->run.problem->unit;
	g->y = calloc((size_t)a->size, sizeof *g->y);
	if (fixed)                  /* tolerances so open that the control never rejects a step */
		g->driver = gsl_odeiv2_driver_alloc_y_new(&g->system, type, g->first, DBL_MAX, 0.0);
	else
		g->driver = gsl_odeiv2_driver_alloc_scaled_new(&g->system, type, g->first, a->run.setting,
		                                               a->run.setting, 1.0, 0.0, a->scale);
	return g->y && g->driver && gsl_odeiv2_driver_set_nmax(g->driver, fixed ? 0 : MOST_STEPS) == GSL_SUCCESS;
}

static bool gsl_begin(struct adaptive *a, double t, const double *y)
{
	struct gsl *g = (struct gsl *)a;
	g->t = t;
	memcpy(g->y, y, (size_t)a->size * sizeof *y);
	return gsl_odeiv2_driver_reset_hstart(g->driver, g->first) == GSL_SUCCESS;
}

static bool gsl_reach(struct adaptive *a, double end, double *y)
{
	struct gsl *g = (struct gsl *)a;
	if (gsl_odeiv2_driver_apply(g->driver, &g->t, end, g->y) != GSL_SUCCESS)
		return false;
	memcpy(y, g->y, (size_t)a->size * sizeof *y);
	return true;
}

/* Equal steps, no longer than the setting: of a whole unit they are the setting */
static bool gsl_reach_fixed(struct adaptive *a, double end, double *y)
{
	struct gsl *g = (struct gsl *)a;
	const double length = end - g->t, steps = fmax(1.0, ceil(length / a->run.setting - 1e-6));
	if (gsl_odeiv2_driver_apply_fixed_step(g->driver, &g->t, length / steps, (unsigned long)steps, g->y) !=
	    GSL_SUCCESS)
		return false;
	g->t = end;
	memcpy(y, g->y, (size_t)a->size * sizeof *y);
	return true;
}

static void gsl_discard(struct adaptive *a)
{
	struct gsl *g = (struct gsl *)a;
	if (g->driver)
		gsl_odeiv2_driver_free(g->driver);
	free(g->y);
}

static const struct solver gsl_solver = {
	.bytes = sizeof(struct gsl), .make = gsl_make, .begin = gsl_begin, .reach = gsl_reach, .discard = gsl_discard,
};
static const struct solver gsl_fixed_solver = {
	.bytes = sizeof(struct gsl), .make = gsl_make, .begin = gsl_begin, .reach = gsl_reach_fixed,
	.discard = gsl_discard,
};

/* ---- SUNDIALS ---- */

struct sundials {
	struct adaptive adaptive;
	SUNContext context;
	void *memory;               /* of CVODE or ARKODE */
	N_Vector y, tolerances;
	SUNNonlinearSolver fixed_point;
	SUNMatrix jacobian;
	SUNLinearSolver dense;
	double start;               /* CVODE: time, and has it taken the first step since */
	bool begun;
};

static int sundials_slope(realtype t, N_Vector y, N_Vector dydt, void *of)
{
	slope(of, t, NV_DATA_S(y), NV_DATA_S(dydt));
	return 0;
}

static void sundials_silent(int code, const char *module, const char *function, char *message, void *of)
{
	(void)code, (void)module, (void)function, (void)message, (void)of;
}

static bool sundials_vectors(struct sundials *s)
{
	const struct adaptive *a = &s->adaptive;
	if (SUNContext_Create(NULL, &s->context) != 0)
		return false;
	s->y = N_VNew_Serial(a->size, s->context);
	s->tolerances = N_VNew_Serial(a->size, s->context);
	if (!s->y || !s->tolerances)
		return false;
	memcpy(NV_DATA_S(s->y), a->run.problem->start, (size_t)a->size * sizeof(double));
	for (int i = 0; i < a->size; i++)
		NV_Ith_S(s->tolerances, i) = a->run.setting * a->scale[i];
	return true;
}

static void sundials_discard(struct adaptive *a)
{
	struct sundials *s = (struct sundials *)a;
	if (s->fixed_point)
		SUNNonlinSolFree(s->fixed_point);
	if (s->dense)
		SUNLinSolFree(s->dense);
	if (s->jacobian)
		SUNMatDestroy(s->jacobian);
	if (s->y)
		N_VDestroy(s->y);
	if (s->tolerances)
		N_VDestroy(s->tolerances);
	if (s->context)
		SUNContext_Free(&s->context);
}

static int cvode_jacobian(realtype t, N_Vector y, N_Vector dydt, SUNMatrix J, void *of, N_Vector w1, N_Vector w2,
                          N_Vector w3)
{
	const struct adaptive *a = of;
	(void)t, (void)y, (void)dydt, (void)w1, (void)w2, (void)w3;
	for (int j = 0; j < a->size; j++)
		for (int i = 0; i < a->size; i++)
			SM_COLUMN_D(J, j)[i] = a->run.problem->A[i * a->size + j];
	return 0;
}

static bool cvode_iteration(struct sundials *s)
{
	const struct adaptive *a = &s->adaptive;
	if (kind_of(a)->formula == CV_ADAMS) {
		s->fixed_point = SUNNonlinSol_FixedPoint(s->y, 0, s->context);
		return s->fixed_point && CVodeSetNonlinearSolver(s->memory, s->fixed_point) == 0;
	}
	s->jacobian = SUNDenseMatrix(a->size, a->size, s->context);
	s->dense = s->jacobian ? SUNLinSol_Dense(s->y, s->jacobian, s->context) : NULL;
	if (!s->dense || CVodeSetLinearSolver(s->memory, s->dense, s->jacobian) != 0)
		return false;
	return !(a->run.problem->linear && a->run.problem->A) || CVodeSetJacFn(s->memory, cvode_jacobian) == 0;
}

static bool cvode_make(struct adaptive *a)
{
	struct sundials *s = (struct sundials *)a;
	if (!sundials_vectors(s) || !(s->memory = CVodeCreate(kind_of(a)->formula, s->context)))
		return false;
	return CVodeSetErrHandlerFn(s->memory, sundials_silent, NULL) == 0 &&
	       CVodeInit(s->memory, sundials_slope, 0.0, s->y) == 0 &&
	       CVodeSVtolerances(s->memory, a->run.setting, s->tolerances) == 0 &&
	       CVodeSetUserData(s->memory, a) == 0 && CVodeSetMaxNumSteps(s->memory, MOST_STEPS) == 0 &&
	       cvode_iteration(s);
}

static bool cvode_begin(struct adaptive *a, double t, const double *y)
{
	struct sundials *s = (struct sundials *)a;
	memcpy(NV_DATA_S(s->y), y, (size_t)a->size * sizeof *y);
	s->start = t;
	s->begun = false;
	return CVodeReInit(s->memory, t, s->y) == 0;
}

/* The first call says how far the user means to go, by which the first step is chosen: always a unit, whatever is
 * asked first */
static bool cvode_reach(struct adaptive *a, double end, double *y)
{
	struct sundials *s = (struct sundials *)a;
	double t;
	if (!s->begun && CVode(s->memory, s->start + a->run.problem->unit, s->y, &t, CV_ONE_STEP) < 0)
		return false;
	s->begun = true;
	if (CVode(s->memory, end, s->y, &t, CV_NORMAL) < 0)
		return false;
	memcpy(y, NV_DATA_S(s->y), (size_t)a->size * sizeof *y);
	return true;
}

static void cvode_discard(struct adaptive *a)
{
	CVodeFree(&((struct sundials *)a)->memory);
	sundials_discard(a);
}

static const struct solver cvode_solver = {
	.bytes = sizeof(struct sundials), .make = cvode_make, .begin = cvode_begin, .reach = cvode_reach,
	.looks_ahead = true,
	.discard = cvode_discard,
};

/* By ARKStep: ERKStep of SUNDIALS 6.4 takes the last stage of this table for the first of the next step, which it is
 * not, and so loses accuracy (SUNDIALS issue 311, mended since). Its interpolants, of degree 5 at most, spoil what is
 * below 1e-5 between its long steps: stopped at the output times it reaches 1e-9 with less than half the evaluations,
 * though 1e-4 with twice as many. */
static bool arkode_make(struct adaptive *a)
{
	struct sundials *s = (struct sundials *)a;
	if (!sundials_vectors(s) || !(s->memory = ARKStepCreate(sundials_slope, NULL, 0.0, s->y, s->context)))
		return false;
	return ARKStepSetErrHandlerFn(s->memory, sundials_silent, NULL) == 0 &&
	       ARKStepSetTableNum(s->memory, ARKODE_DIRK_NONE, ARKODE_FEHLBERG_13_7_8) == 0 &&
	       ARKStepSVtolerances(s->memory, a->run.setting, s->tolerances) == 0 &&
	       ARKStepSetUserData(s->memory, a) == 0 && ARKStepSetMaxNumSteps(s->memory, MOST_STEPS) == 0;
}

static bool arkode_begin(struct adaptive *a, double t, const double *y)
{
	struct sundials *s = (struct sundials *)a;
	memcpy(NV_DATA_S(s->y), y, (size_t)a->size * sizeof *y);
	return ARKStepReInit(s->memory, sundials_slope, NULL, t, s->y) == 0;
}

static bool arkode_reach(struct adaptive *a, double end, double *y)
{
	struct sundials *s = (struct sundials *)a;
	double t;
	if (ARKStepSetStopTime(s->memory, end) != 0 || ARKStepEvolve(s->memory, end, s->y, &t, ARK_NORMAL) < 0)
		return false;
	memcpy(y, NV_DATA_S(s->y), (size_t)a->size * sizeof *y);
	return true;
}

static void arkode_discard(struct adaptive *a)
{
	ARKStepFree(&((struct sundials *)a)->memory);
	sundials_discard(a);
}

static const struct solver arkode_solver = {
	.bytes = sizeof(struct sundials), .make = arkode_make, .begin = arkode_begin, .reach = arkode_reach,
	.discard = arkode_discard,
};

/* ---- the run as charts.h has it ---- */

static bool all_finite(int size, const double *y)
{
	double zero = 0.0;
	for (int i = 0; i < size; i++)
		zero += 0.0 * y[i];
	return zero == 0.0;
}

static void adaptive_restart(struct run *run)
{
	struct adaptive *a = (struct adaptive *)run;
	a->units = a->evaluations = 0;
	memcpy(a->now, run->problem->start, (size_t)a->size * sizeof *a->now);
	a->failed = !kind_of(a)->solver->begin(a, 0.0, a->now);
}

static bool adaptive_advance(struct run *run, int units, double *rows)
{
	struct adaptive *a = (struct adaptive *)run;
	const struct solver *solver = kind_of(a)->solver;
	for (int u = 0; u < units && !a->failed; u++) {
		a->units++;
		a->failed = !solver->reach(a, (double)a->units * run->problem->unit, a->now) ||
		            !all_finite(a->size, a->now);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * a->size, a->now, (size_t)a->size * sizeof *rows);
	}
	return !a->failed;
}

static struct adaptive *adaptive_new(const struct method *method, const struct problem *problem, double setting);

static bool go_aside(struct adaptive *a, double end, double *y)
{
	const struct solver *solver = kind_of(a)->solver;
	if (!a->aside)
		a->aside = adaptive_new(a->run.method, a->run.problem, a->run.setting);
	if (!a->aside)
		return false;
	return solver->begin(a->aside, (double)a->units * a->run.problem->unit, a->now) &&
	       solver->reach(a->aside, end, y);
}

/* What looks ahead cannot look back behind its last step: then it goes aside as the others do */
static void adaptive_between(struct run *run, double fraction, double *y)
{
	struct adaptive *a = (struct adaptive *)run;
	const struct solver *solver = kind_of(a)->solver;
	const double end = ((double)a->units + fraction) * run->problem->unit;
	bool good = !a->failed && ((solver->looks_ahead && solver->reach(a, end, y)) || go_aside(a, end, y));
	for (int i = 0; i < a->size && !good; i++)
		y[i] = NAN;
}

static void adaptive_get(const struct run *run, double *y)
{
	const struct adaptive *a = (const struct adaptive *)run;
	memcpy(y, a->now, (size_t)a->size * sizeof *y);
}

static long adaptive_evaluations(const struct run *run)
{
	return ((const struct adaptive *)run)->evaluations;
}

static void adaptive_close(struct run *run)
{
	struct adaptive *a = (struct adaptive *)run;
	if (a->aside)
		adaptive_close(&a->aside->run);
	kind_of(a)->solver->discard(a);
	free(a->scale);
	free(a->now);
	free(a);
}

static struct adaptive *adaptive_new(const struct method *method, const struct problem *problem, double setting)
{
	const struct kind *kind = (const struct kind *)method;
	struct adaptive *a = calloc(1, kind->solver->bytes);
	if (!a)
		return NULL;
	a->run = (struct run){.method = method, .problem = problem, .setting = setting, .restart = adaptive_restart,
	                      .advance = adaptive_advance,
	                      .between = adaptive_between, .get = adaptive_get, .evaluations = adaptive_evaluations,
	                      .close = adaptive_close};
	a->rhs = problem->rhs_of ? NULL : problem->rhs;
	a->rhs_of = problem->rhs_of;
	a->of = problem->of;
	a->n = problem->n;
	a->size = 2 * problem->n;
	a->scale = calloc((size_t)a->size, sizeof *a->scale);
	a->now = calloc((size_t)a->size, sizeof *a->now);
	if (a->scale && a->now) {
		if (method->tolerance)
			set_scales(a);
		if (kind->solver->make(a))
			return a;
	}
	adaptive_close(&a->run);
	return NULL;
}

static struct run *adaptive_open(const struct method *method, const struct problem *problem, double setting)
{
	if (!(setting > 0.0) || (method->tolerance && setting > 1.0))
		return NULL;
	struct adaptive *a = adaptive_new(method, problem, setting);
	if (!a)
		return NULL;
	adaptive_restart(&a->run);
	return &a->run;
}

static struct run *fixed_open(const struct method *method, const struct problem *problem, double setting)
{
	const double steps = round(problem->unit / setting);
	if (!(steps >= 1.0 && steps <= 1e9) || setting > problem->unit * (1.0 + 1e-9))
		return NULL;
	return adaptive_open(method, problem, problem->unit / steps);
}

/* ---- the list ---- */

#define BY_TOLERANCE(NAME, ORDER, SETTINGS) \
	{.name = NAME, .family = ADAPTIVE, .tolerance = true, .order = ORDER, .settings = TOLERANCES SETTINGS, \
	 .open = adaptive_open}

static const struct kind dormand_prince = {
	.method = BY_TOLERANCE("Dormand-Prince", 5,
	                       "5(4) pair as in ode45, PI controller (beta 0.04), output from its free interpolant of "
	                       "order 4"),
	.solver = &dormand_solver,
};
static const struct kind gsl_rk8pd = {
	.method = BY_TOLERANCE("GSL rk8pd", 8,
	                       "driver with scaled control, applied to each output time; it has no interpolant"),
	.solver = &gsl_solver, .gsl = &gsl_odeiv2_step_rk8pd,
};
static const struct kind gsl_msadams = {
	.method = BY_TOLERANCE("GSL msadams", 0,
	                       "order 1 to 12, driver with scaled control, applied to each output time; it has no "
	                       "interpolant"),
	.solver = &gsl_solver, .gsl = &gsl_odeiv2_step_msadams,
};
static const struct kind gsl_rk8pd_fixed = {
	.method = {.name = "GSL rk8pd (fixed step)", .family = FIXED, .order = 8, .open = fixed_open,
	           .settings = "gsl_odeiv2_driver_apply_fixed_step, tolerances open (epsabs = DBL_MAX): no step is "
	                       "ever rejected"},
	.solver = &gsl_fixed_solver, .gsl = &gsl_odeiv2_step_rk8pd,
};
static const struct kind cvode_adams = {
	.method = BY_TOLERANCE("CVODE Adams", 0,
	                       "order 1 to 12, fixed-point iteration (manual: for nonstiff), CV_NORMAL, output from "
	                       "its interpolant"),
	.solver = &cvode_solver, .formula = CV_ADAMS,
};
static const struct kind cvode_bdf = {
	.method = BY_TOLERANCE("CVODE BDF", 0,
	                       "order 1 to 5, Newton, dense; Jacobian exact for linear problems, else its own "
	                       "differences; CV_NORMAL, output from its interpolant"),
	.solver = &cvode_solver, .formula = CV_BDF,
};
static const struct kind arkode = {
	.method = BY_TOLERANCE("ARKODE order 8", 8,
	                       "ARKStep, explicit, Fehlberg 13-7-8, stopped at each output time (its interpolants are "
	                       "of degree 5 at most)"),
	.solver = &arkode_solver,
};

const struct method *const adaptive_methods[] = {
	&dormand_prince.method, &gsl_rk8pd.method, &gsl_msadams.method, &gsl_rk8pd_fixed.method, &cvode_adams.method,
	&cvode_bdf.method,
	&arkode.method, NULL,
};

void adaptive_scales(const struct problem *problem, double *scale_q, double *scale_v)
{
	struct adaptive *a = adaptive_new(&dormand_prince.method, problem, 1e-3);
	if (!a)
		exit(1);
	*scale_q = a->scale[0];
	*scale_v = a->scale[a->n];
	adaptive_close(&a->run);
}
