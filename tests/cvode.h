/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A solution by CVODE with dense Newton, as the tests that compare with one begin and end it. */
#ifndef TESTS_CVODE_H
#define TESTS_CVODE_H

#include <cvode/cvode.h>
#include <nvector/nvector_serial.h>
#include <stdbool.h>
#include <string.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

struct cvode {
	void *memory;
	N_Vector y, absolute;
	SUNMatrix J;
	SUNLinearSolver linear;
	SUNContext context;
};

/* From y at t = 0; method: CV_ADAMS or CV_BDF. Absolute tolerances: `absolute`, times the size of each entry where
 * sizes are given. `slopes` gets `of`. */
static inline bool cvode_open(struct cvode *c, int method, int n, const double *y, CVRhsFn slopes, void *of,
	double relative, double absolute, const double *size)
{
	SUNContext_Create(NULL, &c->context);
	c->y = N_VNew_Serial(n, c->context);
	c->absolute = N_VNew_Serial(n, c->context);
	memcpy(N_VGetArrayPointer(c->y), y, (size_t)n * sizeof *y);
	for (int i = 0; i < n; i++)
		N_VGetArrayPointer(c->absolute)[i] = absolute * (size ? size[i] : 1);
	c->J = SUNDenseMatrix(n, n, c->context);
	c->linear = SUNLinSol_Dense(c->y, c->J, c->context);
	c->memory = CVodeCreate(method, c->context);
	return CVodeInit(c->memory, slopes, 0, c->y) == CV_SUCCESS && CVodeSetUserData(c->memory, of) == CV_SUCCESS &&
		CVodeSVtolerances(c->memory, relative, c->absolute) == CV_SUCCESS &&
		CVodeSetLinearSolver(c->memory, c->linear, c->J) == CV_SUCCESS &&
		CVodeSetMaxNumSteps(c->memory, 10000000) == CV_SUCCESS;
}

/* On to the time `to`, where its polynomial lands and is not interpolated */
static inline bool cvode_until(struct cvode *c, double to)
{
	double t;
	return CVodeSetStopTime(c->memory, to) == CV_SUCCESS && CVode(c->memory, to, c->y, &t, CV_NORMAL) >= 0;
}

static inline void cvode_close(struct cvode *c)
{
	CVodeFree(&c->memory);
	SUNLinSolFree(c->linear);
	SUNMatDestroy(c->J);
	N_VDestroy(c->y);
	N_VDestroy(c->absolute);
	SUNContext_Free(&c->context);
}

#endif
