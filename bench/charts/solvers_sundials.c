/* SPDX-License-Identifier: GPL-3.0-or-later */
/* SUNDIALS' CVODE and ARKODE, as their manuals advise. */
#include <stdlib.h>
#include <string.h>

#include <arkode/arkode_arkstep.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "jacobian.h"
#include "sundials.h"

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

/* f = (v, a): the upper half of its Jacobian is known */
static int sundials_jacobian(realtype t, N_Vector y, N_Vector dydt, SUNMatrix J, void *of, N_Vector w1, N_Vector w2,
							 N_Vector w3)
{
	const struct adaptive *a = of;
	const struct problem *p = a->run.problem;
	const int n = a->n;
	double Jq[n * n], Jv[n * n];
	(void)dydt, (void)w1, (void)w2, (void)w3;
	jacobian_of(p)(p, t, NV_DATA_S(y), Jq, Jv);
	for (int j = 0; j < n; j++)
		for (int i = 0; i < n; i++) {
			SM_COLUMN_D(J, j)[i] = 0.0;
			SM_COLUMN_D(J, n + j)[i] = i == j;
			SM_COLUMN_D(J, j)[n + i] = Jq[i * n + j];
			SM_COLUMN_D(J, n + j)[n + i] = Jv[i * n + j];
		}
	return 0;
}

static bool make_dense(struct sundials *s)
{
	const struct adaptive *a = &s->adaptive;
	s->jacobian = SUNDenseMatrix(a->size, a->size, s->context);
	s->dense = s->jacobian ? SUNLinSol_Dense(s->y, s->jacobian, s->context) : NULL;
	return s->dense;
}

static bool cvode_iteration(struct sundials *s)
{
	const struct adaptive *a = &s->adaptive;
	if (kind_of(a)->formula == CV_ADAMS) {
		s->fixed_point = SUNNonlinSol_FixedPoint(s->y, 0, s->context);
		return s->fixed_point && CVodeSetNonlinearSolver(s->memory, s->fixed_point) == 0;
	}
	if (!make_dense(s) || CVodeSetLinearSolver(s->memory, s->dense, s->jacobian) != 0)
		return false;
	return !jacobian_of(a->run.problem) || CVodeSetJacFn(s->memory, sundials_jacobian) == 0;
}

bool cvode_make(struct adaptive *a)
{
	struct sundials *s = (struct sundials *)a;
	if (!sundials_vectors(s) || !(s->memory = CVodeCreate(kind_of(a)->formula, s->context)))
		return false;
	return CVodeSetErrHandlerFn(s->memory, sundials_silent, NULL) == 0 &&
	       CVodeInit(s->memory, sundials_slope, 0.0, s->y) == 0 &&
	       CVodeSVtolerances(s->memory, a->run.setting, s->tolerances) == 0 &&
	       CVodeSetUserData(s->memory, a) == 0 && CVodeSetMaxNumSteps(s->memory, MOST_STEPS) == 0 &&
	       cvode_iteration(s) && (s->roots == 0 || CVodeRootInit(s->memory, s->roots, s->distance) == 0);
}

bool cvode_begin(struct adaptive *a, double t, const double *y)
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

bool roots_reach(struct adaptive *a, double end, double *y)
{
	struct sundials *s = (struct sundials *)a;
	int found[MOST_ROOTS], said = CV_ROOT_RETURN;
	double t = -HUGE_VAL;
	for (int roots = 0; roots < MOST_STEPS && said == CV_ROOT_RETURN && t < end; roots++) {
		said = CVode(s->memory, end, s->y, &t, CV_NORMAL);
		if (said == CV_ROOT_RETURN && CVodeGetRootInfo(s->memory, found) == 0) {
			s->crossed(s, t, found);
			if (CVodeReInit(s->memory, t, s->y) != 0)
				return false;
		}
	}
	memcpy(y, NV_DATA_S(s->y), (size_t)a->size * sizeof *y);
	return said >= 0 && (said != CV_ROOT_RETURN || t >= end);
}

void cvode_discard(struct adaptive *a)
{
	CVodeFree(&((struct sundials *)a)->memory);
	sundials_discard(a);
}

const struct solver cvode_solver = {
	.bytes = sizeof(struct sundials), .make = cvode_make, .begin = cvode_begin, .reach = cvode_reach,
	.looks_ahead = true,
	.discard = cvode_discard,
};

static bool arkode_settings(struct sundials *s)
{
	struct adaptive *a = &s->adaptive;
	return ARKStepSetErrHandlerFn(s->memory, sundials_silent, NULL) == 0 &&
	       ARKStepSVtolerances(s->memory, a->run.setting, s->tolerances) == 0 &&
	       ARKStepSetUserData(s->memory, a) == 0 && ARKStepSetMaxNumSteps(s->memory, MOST_STEPS) == 0;
}

/* By ARKStep: ERKStep of SUNDIALS 6.4 takes the last stage of this table for the first of the next step, which it is
 * not, and so loses accuracy (SUNDIALS issue 311, mended since). Its interpolants, of degree 5 at most, spoil what is
 * below 1e-5 between its long steps: stopped at the output times it reaches 1e-9 with less than half the evaluations,
 * though 1e-4 with twice as many. */
static bool arkode_make(struct adaptive *a)
{
	struct sundials *s = (struct sundials *)a;
	if (!sundials_vectors(s) || !(s->memory = ARKStepCreate(sundials_slope, NULL, 0.0, s->y, s->context)))
		return false;
	return ARKStepSetTableNum(s->memory, ARKODE_DIRK_NONE, ARKODE_FEHLBERG_13_7_8) == 0 && arkode_settings(s);
}

/* Diagonally implicit, as its manual advises for stiff problems: Newton, dense. Its interpolants are of degree 5 at
 * most, so it is stopped at the output times. By default Newton ends at a tenth of the tolerance with a Jacobian that
 * lags, which damps what swings: 0.2 of an undamped oscillation in 30 s, whatever the tolerance. So linear problems are
 * said to be linear, and of others it is taken to a thousandth. */
static bool dirk_make(struct adaptive *a)
{
	struct sundials *s = (struct sundials *)a;
	if (!sundials_vectors(s) || !(s->memory = ARKStepCreate(NULL, sundials_slope, 0.0, s->y, s->context)))
		return false;
	return ARKStepSetOrder(s->memory, kind_of(a)->formula) == 0 && arkode_settings(s) &&
	       (a->run.problem->linear ? ARKStepSetLinear(s->memory, 0)
	                               : ARKStepSetNonlinConvCoef(s->memory, 1e-3)) == 0 &&
	       make_dense(s) && ARKStepSetLinearSolver(s->memory, s->dense, s->jacobian) == 0 &&
	       (!jacobian_of(a->run.problem) || ARKStepSetJacFn(s->memory, sundials_jacobian) == 0);
}

/* dense: of the implicit one alone */
static bool arkode_begin(struct adaptive *a, double t, const double *y)
{
	struct sundials *s = (struct sundials *)a;
	memcpy(NV_DATA_S(s->y), y, (size_t)a->size * sizeof *y);
	return ARKStepReInit(s->memory, s->dense ? NULL : sundials_slope, s->dense ? sundials_slope : NULL, t,
	                     s->y) == 0;
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

const struct solver arkode_solver = {
	.bytes = sizeof(struct sundials), .make = arkode_make, .begin = arkode_begin, .reach = arkode_reach,
	.discard = arkode_discard,
};
const struct solver dirk_solver = {
	.bytes = sizeof(struct sundials), .make = dirk_make, .begin = arkode_begin, .reach = arkode_reach,
	.discard = arkode_discard,
};
