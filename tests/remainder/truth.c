/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "truth.h"

#include <arkode/arkode_arkstep.h>
#include <arkode/arkode_erkstep.h>
#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdlib.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

enum { MOST_STEPS = 50000000, MOST_INPUTS = 4 };

struct truth {
	int n;
	slopes *f;
	const void *of;
	enum solver solver;
	bool going;
	double begun, to;                       /* the solver's time is 0 at `begun` */
	int inputs;
	const double *u0;
	void *memory;
	double size;                            /* of the last step, 0 before the first */
	N_Vector y, tolerance;
	SUNMatrix J;
	SUNLinearSolver linear;
	SUNContext context;
};

static int slope(realtype tau, N_Vector y, N_Vector dydt, void *from)
{
	const struct truth *t = from;
	double u[2 * MOST_INPUTS];
	for (int i = 0; i < t->inputs; i++) {
		u[t->inputs + i] = t->u0[t->inputs + i];
		u[i] = t->u0[i] + tau * u[t->inputs + i];
	}
	t->f(t->of, fmin(t->begun + tau, t->to), N_VGetArrayPointer(y), u, N_VGetArrayPointer(dydt));
	return 0;
}

/* Of a system that is affine in y: its columns are differences of slopes, but for rounding exact. */
static int affine_jacobian(realtype tau, N_Vector at, N_Vector f_at, SUNMatrix J, void *from, N_Vector y, N_Vector f0,
	N_Vector f)
{
	const struct truth *t = from;
	(void)at, (void)f_at;
	N_VConst(0, y);
	slope(tau, y, f0, from);
	for (int j = 0; j < t->n; j++) {
		N_VGetArrayPointer(y)[j] = 1;
		slope(tau, y, f, from);
		N_VGetArrayPointer(y)[j] = 0;
		for (int i = 0; i < t->n; i++)
			SM_ELEMENT_D(J, i, j) = N_VGetArrayPointer(f)[i] - N_VGetArrayPointer(f0)[i];
	}
	return 0;
}

static void set_up_implicit(struct truth *t, double relative)
{
	t->memory = ARKStepCreate(NULL, slope, 0, t->y, t->context);
	ARKStepSetUserData(t->memory, t);
	ARKStepSVtolerances(t->memory, relative, t->tolerance);
	ARKStepSetLinearSolver(t->memory, t->linear, t->J);
	ARKStepSetJacFn(t->memory, affine_jacobian);
	ARKStepSetLinear(t->memory, 1);
	ARKStepSetTableNum(t->memory, ARKODE_ESDIRK547L2SA_7_4_5, ARKODE_ERK_NONE);
	ARKStepSetMaxNumSteps(t->memory, MOST_STEPS);
}

struct truth *truth_new(int n, slopes *f, const void *of, enum solver solver, double relative, const double *scale)
{
	struct truth *t = calloc(1, sizeof *t);
	t->n = n;
	t->f = f;
	t->of = of;
	t->solver = solver;
	SUNContext_Create(NULL, &t->context);
	t->y = N_VNew_Serial(n, t->context);
	N_VConst(0, t->y);
	t->tolerance = N_VNew_Serial(n, t->context);
	for (int i = 0; i < n; i++)
		N_VGetArrayPointer(t->tolerance)[i] = relative * scale[i];
	t->J = SUNDenseMatrix(n, n, t->context);
	t->linear = SUNLinSol_Dense(t->y, t->J, t->context);
	if (solver == ARKODE_AFFINE) {
		set_up_implicit(t, relative);
	} else if (solver == ARKODE_EXPLICIT) {
		t->memory = ERKStepCreate(slope, 0, t->y, t->context);
		ERKStepSetUserData(t->memory, t);
		ERKStepSVtolerances(t->memory, relative, t->tolerance);
		ERKStepSetTableNum(t->memory, ARKODE_FEHLBERG_13_7_8);
		ERKStepSetMaxNumSteps(t->memory, MOST_STEPS);
	} else {
		t->memory = CVodeCreate(solver == CVODE_BDF ? CV_BDF : CV_ADAMS, t->context);
		CVodeInit(t->memory, slope, 0, t->y);
		CVodeSetUserData(t->memory, t);
		CVodeSVtolerances(t->memory, relative, t->tolerance);
		CVodeSetLinearSolver(t->memory, t->linear, t->J);
		CVodeSetMaxNumSteps(t->memory, MOST_STEPS);
	}
	return t;
}

void truth_free(struct truth *t)
{
	if (t->solver == ARKODE_EXPLICIT)
		ERKStepFree(&t->memory);
	else if (t->solver == ARKODE_AFFINE)
		ARKStepFree(&t->memory);
	else
		CVodeFree(&t->memory);
	SUNLinSolFree(t->linear);
	SUNMatDestroy(t->J);
	N_VDestroy(t->y);
	N_VDestroy(t->tolerance);
	SUNContext_Free(&t->context);
	free(t);
}

static bool by_arkode(struct truth *t, double stretch, double *reached)
{
	bool good = ERKStepReset(t->memory, 0, t->y) == ARK_SUCCESS;
	if (t->size > 0)
		good = good && ERKStepSetInitStep(t->memory, t->size) == ARK_SUCCESS;
	good = good && ERKStepSetStopTime(t->memory, stretch) == ARK_SUCCESS &&
		   ERKStepEvolve(t->memory, stretch, t->y, reached, ARK_NORMAL) >= 0;
	ERKStepGetCurrentStep(t->memory, &t->size);
	return good;
}

/* The others go on where they are, and begin anew only behind a gap or with inputs, which jump. */
static bool by_others(struct truth *t, bool anew, double *reached)
{
	const double goal = t->to - t->begun;
	if (t->solver == ARKODE_AFFINE)
		return (!anew || ARKStepReset(t->memory, 0, t->y) == ARK_SUCCESS) &&
			ARKStepSetStopTime(t->memory, goal) == ARK_SUCCESS &&
			   ARKStepEvolve(t->memory, goal, t->y, reached, ARK_NORMAL) >= 0;
	return (!anew || CVodeReInit(t->memory, 0, t->y) == CV_SUCCESS) &&
		CVodeSetStopTime(t->memory, goal) == CV_SUCCESS &&
		   CVode(t->memory, goal, t->y, reached, CV_NORMAL) >= 0;
}

bool truth_advance(struct truth *t, double from, double to, int inputs, const double *u0, double *y)
{
	const bool anew = t->solver == ARKODE_EXPLICIT || inputs > 0 || !t->going || from != t->to;
	const size_t size = (size_t)t->n * sizeof *y;
	double reached = 0;
	if (anew) {
		t->begun = from;
		memcpy(N_VGetArrayPointer(t->y), y, size);
	}
	t->going = true;
	t->to = to;
	t->inputs = inputs;
	t->u0 = u0;
	const bool good = t->solver == ARKODE_EXPLICIT ? by_arkode(t, to - from, &reached)
					   : by_others(t, anew, &reached);
	memcpy(y, N_VGetArrayPointer(t->y), size);
	return good;
}

void system_slopes(const void *system, double t, const double *y, const double *u, double *dydt)
{
	const struct system *s = system;
	real wide[HAND_MOST], inputs[HAND_MOST] = {0}, f[HAND_MOST];
	for (int i = 0; i < s->states; i++)
		wide[i] = y[i];
	for (int i = 0; i < 2 * s->inputs; i++)
		inputs[i] = u[i];
	s->equations(t, wide, inputs, f);
	for (int i = 0; i < s->states; i++)
		dydt[i] = (double)f[i];
}
