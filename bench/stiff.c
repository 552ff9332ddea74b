/* SPDX-License-Identifier: MIT-0 */
/* stiff: runs of tests/series_switching's stiff models, whose state chooses formulas, by radau and auto and by CVODE's
 * BDF with root finding, which begins anew at each crossing: medians of runs that take turns, and the largest error of
 * their outputs every 1/8 s, over the largest state. */
#include "stiff_models.h"
#include "timing.h"

#include <cvode/cvode.h>
#include <math.h>
#include <nvector/nvector_serial.h>
#include <stdio.h>
#include <stdlib.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>

enum { OUTPUTS = 48, RUNS = 31 };

static int above;                       /* is the expression above its breakpoint? */

static void pressed(double t, const double *y, double *d)
{
	const double x = y[0];
	d[1] = 3 * cos(2 * t) - 0.1 * y[1] - x - x * x * x - (above ? 1e8 * (x - 0.5) + 2e4 * y[1] : 0);
}

static void flipping(double t, const double *y, double *d)
{
	(void)t;
	d[1] = 1000 * (1 - (above ? y[0] : -y[0])) * y[1] - 1000 * y[0];
}

static void braked(double t, const double *y, double *d)
{
	d[1] = 5000 * cos(2 * t) - (above ? 1e4 : -1e4) * y[1] * y[1] - 5000 * y[0] - 100 * y[0] * y[0] * y[0];
}

static const struct equations {
	const char *name;
	void (*slopes)(double t, const double *y, double *d);
	int expression;                 /* the state that is compared */
	double at, start;
} equations[] = {{"pressed", pressed, 0, 0.5, 0.4}, {"flipping", flipping, 0, 0, 2}, {"braked", braked, 1, 0, 0.9}};

static int slopes(sunrealtype t, N_Vector y, N_Vector dydt, void *context)
{
	const struct equations *e = context;
	NV_Ith_S(dydt, 0) = NV_Ith_S(y, 1);
	e->slopes(t, NV_DATA_S(y), NV_DATA_S(dydt));
	return 0;
}

static int distance(sunrealtype t, N_Vector y, sunrealtype *g, void *context)
{
	const struct equations *e = context;
	(void)t;
	g[0] = NV_Ith_S(y, e->expression) - e->at;
	return 0;
}

/* ns; states at the outputs */
static double by_cvode(const struct equations *e, double tolerance, double (*out)[2])
{
	SUNContext context;
	int found[1];
	double t = 0;
	SUNContext_Create(NULL, &context);
	N_Vector y = N_VNew_Serial(2, context);
	SUNMatrix J = SUNDenseMatrix(2, 2, context);
	SUNLinearSolver linear = SUNLinSol_Dense(y, J, context);
	void *memory = CVodeCreate(CV_BDF, context);
	NV_Ith_S(y, 0) = e->start;
	NV_Ith_S(y, 1) = 0;
	above = e->expression == 1 || e->start > e->at;       /* what starts at rest rises */
	CVodeInit(memory, slopes, 0, y);
	CVodeSetUserData(memory, (void *)(size_t)e);
	CVodeSStolerances(memory, tolerance, tolerance * 1e-3);
	CVodeSetLinearSolver(memory, linear, J);
	CVodeSetMaxNumSteps(memory, 10000000);
	CVodeRootInit(memory, 1, distance);
	const double start = nanoseconds();
	for (int k = 1; k <= OUTPUTS; k++) {
		while (t < k * 0.125) {
			if (CVode(memory, k * 0.125, y, &t, CV_NORMAL) != CV_ROOT_RETURN)
				break;
			CVodeGetRootInfo(memory, found);
			above = found[0] > 0;
			CVodeReInit(memory, t, y);
		}
		out[k - 1][0] = NV_Ith_S(y, 0);
		out[k - 1][1] = NV_Ith_S(y, 1);
	}
	const double took = nanoseconds() - start;
	CVodeFree(&memory);
	SUNLinSolFree(linear);
	SUNMatDestroy(J);
	N_VDestroy(y);
	SUNContext_Free(&context);
	return took;
}

static double by_model(const pl_model *m, double (*out)[2])
{
	void *state = calloc(1, m->size);
	m->init(state);
	const double start = nanoseconds();
	for (int k = 0; k < OUTPUTS; k++) {
		m->step(state, NULL);
		m->get(state, out[k]);
	}
	const double took = nanoseconds() - start;
	free(state);
	return took;
}

static double error_of(double (*out)[2], double (*truth)[2])
{
	double worst = 0, most = 0;
	for (int k = 0; k < OUTPUTS; k++)
		for (int i = 0; i < 2; i++) {
			worst = fmax(worst, fabs(out[k][i] - truth[k][i]));
			most = fmax(most, fabs(truth[k][i]));
		}
	return worst / most;
}

static void report(const struct equations *e, const char *what, double tolerance, double *took, double error)
{
	printf("| `%s` | %.0e | %s | %.0f | %.1e |\n", e->name, tolerance, what, middle(RUNS, took) / 1000, error);
}

int main(void)
{
	static double took[4][RUNS], out[4][OUTPUTS][2], truth[OUTPUTS][2];
	puts("| model | tolerance | by | microseconds | error |");
	for (int i = 0; i < 3; i++) {
		const struct equations *e = &equations[i];
		by_model(stiff_model(e->name, "radau", 13), truth);
		for (int digits = 4; digits <= 10; digits += 3) {
			const double tolerance = pow(10, -digits);
			for (int run = 0; run < RUNS; run++) {
				took[0][run] = by_model(stiff_model(e->name, "radau", digits), out[0]);
				took[1][run] = by_model(stiff_model(e->name, "auto", digits), out[1]);
				took[2][run] = by_cvode(e, tolerance, out[2]);
				took[3][run] = by_cvode(e, tolerance / 100, out[3]);
			}
			report(e, "radau", tolerance, took[0], error_of(out[0], truth));
			report(e, "auto", tolerance, took[1], error_of(out[1], truth));
			report(e, "CVODE BDF", tolerance, took[2], error_of(out[2], truth));
			report(e, "CVODE BDF", tolerance / 100, took[3], error_of(out[3], truth));
		}
	}
	return 0;
}
