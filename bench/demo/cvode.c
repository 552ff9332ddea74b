/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The demonstration's second opinion: CVODE integrates the equations as written (sdcsf_rhs) from output time to output
 * time, the generated step goes beside it, and the largest difference over all states is printed, relative to the
 * largest value of its component. The two share nothing but the spec. */
#include "plrt.h"

#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

enum { MOST_STATES = 16 };
extern const pl_model sdcsf_model;
void sdcsf_rhs(double t, const double y[], double dydt[]);

static int rhs(realtype t, N_Vector y, N_Vector dydt, void *unused)
{
	(void)unused;
	sdcsf_rhs(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dydt));
	return 0;
}

int main(int argc, char **argv)
{
	const pl_model *model = &sdcsf_model;
	double end = argc > 1 ? atof(argv[1]) : 30, start[MOST_STATES], y[MOST_STATES];
	double largest[MOST_STATES] = { 0 }, difference[MOST_STATES] = { 0 };
	void *state = malloc(model->size);
	SUNContext context;
	if (!state || SUNContext_Create(NULL, &context))
		return 1;
	model->init(state);
	model->get(state, start);
	N_Vector u = N_VMake_Serial(model->states, start, context);
	SUNMatrix jacobian = SUNDenseMatrix(model->states, model->states, context);
	SUNLinearSolver solver = SUNLinSol_Dense(u, jacobian, context);
	void *cvode = CVodeCreate(CV_ADAMS, context);
	if (CVodeInit(cvode, rhs, 0, u) || CVodeSStolerances(cvode, 1e-12, 1e-15) ||
	    CVodeSetLinearSolver(cvode, solver, jacobian) || CVodeSetMaxNumSteps(cvode, 1000000))
		return 1;
	long steps = lround(end / model->h);
	for (long k = 1; k <= steps; k++) {
		double t;
		model->step(state, NULL);
		model->get(state, y);
		if (CVodeSetStopTime(cvode, model->time(state)) || CVode(cvode, model->time(state), u, &t, CV_NORMAL) <
		    0)
			return 1;
		for (int i = 0; i < model->states; i++) {
			largest[i] = fmax(largest[i], fabs(y[i]));
			difference[i] = fmax(difference[i], fabs(y[i] - NV_Ith_S(u, i)));
		}
	}
	double worst = 0;
	for (int i = 0; i < model->states; i++)
		worst = fmax(worst, difference[i] / largest[i]);
	printf("%.2e\n", worst);
	CVodeFree(&cvode);
	SUNLinSolFree(solver);
	SUNMatDestroy(jacobian);
	N_VDestroy(u);
	SUNContext_Free(&context);
	free(state);
	return 0;
}
