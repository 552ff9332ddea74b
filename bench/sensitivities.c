/* SPDX-License-Identifier: GPL-3.0-or-later */
/* sensitivities.sh compiles this for one model: derivatives of the first state after 100 steps of 0.1 by its params, by
 * plgen's step with OURS, else by CVODES: Adams' methods, fixed-point iteration, exact right-hand sides. `measured` is
 * what callgrind counts. With GAP and RESTITUTION the first coordinate bounces there; CVODES, whose derivatives know no
 * events, is stopped at the root, and what the bounce does to them is written out before it starts again.
 *
 *     sensitivities forward | adjoint TOLERANCE */
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
enum { STEPS = 100, SNAPSHOTS = 20 };
/* so that zeros of the Jacobian leave no trace */
#define UNROLLED _Pragma("GCC unroll 16")

#ifdef OURS
#include "subject_pl.h"
enum { P = SUBJECT_D };

static void forward(double tolerance, double *slope)
{
	static subject s;
	static subject_d ds;
	double S[SUBJECT_D][SUBJECT_STATES];
	(void)tolerance;
	subject_init_d(&s, &ds);
	subject_run_d(&s, &ds, STEPS, NULL, NULL);
	subject_get_d(&s, &ds, S);
	for (int p = 0; p < P; p++)
		slope[p] = S[p][0];
}

static void adjoint(double tolerance, double *slope)
{
	static subject s, snapshot[SNAPSHOTS];
	static subject_d ds;
	double lam[SUBJECT_STATES] = { 1 };
	(void)tolerance;
	subject_init_d(&s, &ds);
	subject_gradient(&s, &ds, STEPS, NULL, lam, slope, snapshot, SNAPSHOTS);
}
#else
#include "equations.h"
#include <cvodes/cvodes.h>
#include <nvector/nvector_serial.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>
/* The peer's spec has the params as coordinates behind its own, so that their columns stand in the Jacobian. */
enum { ALL = peer_coordinates, P = PARAMS, N = ALL - P };
static const double start[2 * ALL] = { START };

static void extend(const N_Vector y, double z[2 * ALL])
{
	memcpy(z, start, sizeof start);
	memcpy(z, N_VGetArrayPointer(y), N * sizeof *z);
	memcpy(z + ALL, N_VGetArrayPointer(y) + N, N * sizeof *z);
}

static int slopes(realtype t, N_Vector y, N_Vector f, void *context)
{
	double z[2 * ALL], all[2 * ALL];
	(void)context;
	extend(y, z);
	peer_slopes(t, z, all);
	memcpy(N_VGetArrayPointer(f), all, N * sizeof *z);
	memcpy(N_VGetArrayPointer(f) + N, all + ALL, N * sizeof *z);
	return 0;
}

/* s' = J s + f_p, all columns from one Jacobian */
static int sensitivities(int columns, realtype t, N_Vector y, N_Vector f, N_Vector *s, N_Vector *g, void *context,
						 N_Vector more, N_Vector most)
{
	double z[2 * ALL], Jq[ALL * ALL], Jv[ALL * ALL];
	(void)f, (void)context, (void)more, (void)most;
	extend(y, z);
	peer_jacobian(t, z, Jq, Jv);
	for (int p = 0; p < columns; p++) {
		const double *x = N_VGetArrayPointer(s[p]);
		double *slope = N_VGetArrayPointer(g[p]);
		UNROLLED
		for (int i = 0; i < N; i++) {
			double sum = Jq[i * ALL + N + p];
			UNROLLED
			for (int j = 0; j < N; j++)
				sum += Jq[i * ALL + j] * x[j] + Jv[i * ALL + j] * x[N + j];
			slope[i] = x[N + i];
			slope[N + i] = sum;
		}
	}
	return 0;
}

/* l' = -J^T l */
static int backwards(realtype t, N_Vector y, N_Vector l, N_Vector g, void *context)
{
	double z[2 * ALL], Jq[ALL * ALL], Jv[ALL * ALL], *slope = N_VGetArrayPointer(g);
	const double *lam = N_VGetArrayPointer(l);
	(void)context;
	extend(y, z);
	peer_jacobian(t, z, Jq, Jv);
	UNROLLED
	for (int j = 0; j < N; j++) {
		double q = 0, v = lam[j];
		UNROLLED
		for (int i = 0; i < N; i++) {
			q += Jq[i * ALL + j] * lam[N + i];
			v += Jv[i * ALL + j] * lam[N + i];
		}
		slope[j] = -q;
		slope[N + j] = -v;
	}
	return 0;
}

static int integrand(realtype t, N_Vector y, N_Vector l, N_Vector g, void *context)
{
	double z[2 * ALL], Jq[ALL * ALL], Jv[ALL * ALL];
	(void)context;
	extend(y, z);
	peer_jacobian(t, z, Jq, Jv);
	for (int p = 0; p < P; p++) {
		double sum = 0;
		UNROLLED
		for (int i = 0; i < N; i++)
			sum += Jq[i * ALL + N + p] * N_VGetArrayPointer(l)[N + i];
		N_VGetArrayPointer(g)[p] = -sum;
	}
	return 0;
}

static void *opened(SUNContext context, N_Vector y, double tolerance)
{
	void *cvode = CVodeCreate(CV_ADAMS, context);
	memcpy(N_VGetArrayPointer(y), start, N * sizeof *start);
	memcpy(N_VGetArrayPointer(y) + N, start + ALL, N * sizeof *start);
	CVodeInit(cvode, slopes, 0, y);
	CVodeSStolerances(cvode, tolerance, tolerance);
	CVodeSetNonlinearSolver(cvode, SUNNonlinSol_FixedPoint(y, 0, context));
	CVodeSetMaxNumSteps(cvode, 10000000);
	return cvode;
}

#ifdef GAP
static int beyond(realtype t, N_Vector y, realtype *g, void *context)
{
	(void)t, (void)context;
	*g = N_VGetArrayPointer(y)[0] - GAP;
	return 0;
}

/* x+ = R(x), and S+ = R_x S + (f+ - R_x f-) x_p/x' of each column */
static void bounce(realtype t, N_Vector y, N_Vector *s)
{
	double *x = N_VGetArrayPointer(y);
	const double speed = x[N];
	N_Vector before = N_VClone(y), behind = N_VClone(y);
	slopes(t, y, before, NULL);
	x[N] *= -RESTITUTION;
	slopes(t, y, behind, NULL);
	const double *was = N_VGetArrayPointer(before), *is = N_VGetArrayPointer(behind);
	for (int p = 0; p < P; p++) {
		double *S = N_VGetArrayPointer(s[p]);
		const double when = S[0] / speed;
		S[N] *= -RESTITUTION;
		for (int i = 0; i < 2 * N; i++)
			S[i] += (is[i] - (i == N ? -RESTITUTION : 1) * was[i]) * when;
	}
	N_VDestroy(before), N_VDestroy(behind);
}
#endif

static void forward(double tolerance, double *slope)
{
	SUNContext context;
	realtype t, absolute[P];
	SUNContext_Create(NULL, &context);
	N_Vector y = N_VNew_Serial(2 * N, context), *s = N_VCloneVectorArray(P, y);
	void *cvode = opened(context, y, tolerance);
	for (int p = 0; p < P; p++) {
		N_VConst(0, s[p]);
		absolute[p] = tolerance;
	}
	CVodeSensInit(cvode, P, CV_STAGGERED, sensitivities, s);
	CVodeSensSStolerances(cvode, tolerance, absolute);
	CVodeSetSensErrCon(cvode, 1);
	CVodeSetNonlinearSolverSensStg(cvode, SUNNonlinSol_FixedPointSens(P, y, 0, context));
#ifdef GAP
	int up = 1;
	CVodeRootInit(cvode, 1, beyond);
	CVodeSetRootDirection(cvode, &up);
	while (CVode(cvode, STEPS * 0.1, y, &t, CV_NORMAL) == CV_ROOT_RETURN) {
		realtype at;
		CVodeGetSens(cvode, &at, s);
		bounce(t, y, s);
		CVodeReInit(cvode, t, y);
		CVodeSensReInit(cvode, CV_STAGGERED, s);
	}
#else
	CVode(cvode, STEPS * 0.1, y, &t, CV_NORMAL);
#endif
	CVodeGetSens(cvode, &t, s);
	for (int p = 0; p < P; p++)
		slope[p] = N_VGetArrayPointer(s[p])[0];
}

static void adjoint(double tolerance, double *slope)
{
	SUNContext context;
	realtype t;
	int steps, which;
	SUNContext_Create(NULL, &context);
	N_Vector y = N_VNew_Serial(2 * N, context), l = N_VClone(y), q = N_VNew_Serial(P, context);
	void *cvode = opened(context, y, tolerance);
	CVodeAdjInit(cvode, 150, CV_POLYNOMIAL);
	CVodeF(cvode, STEPS * 0.1, y, &t, CV_NORMAL, &steps);
	N_VConst(0, l);
	N_VConst(0, q);
	N_VGetArrayPointer(l)[0] = 1;
	CVodeCreateB(cvode, CV_ADAMS, &which);
	CVodeInitB(cvode, which, backwards, STEPS * 0.1, l);
	CVodeSStolerancesB(cvode, which, tolerance, tolerance);
	CVodeSetNonlinearSolverB(cvode, which, SUNNonlinSol_FixedPoint(l, 0, context));
	CVodeSetMaxNumStepsB(cvode, which, 10000000);
	CVodeQuadInitB(cvode, which, integrand, q);
	CVodeSetQuadErrConB(cvode, which, 1);
	CVodeQuadSStolerancesB(cvode, which, tolerance, tolerance);
	CVodeB(cvode, 0, CV_NORMAL);
	CVodeGetQuadB(cvode, which, &t, q);
	memcpy(slope, N_VGetArrayPointer(q), P * sizeof *slope);
}
#endif

__attribute__((noinline)) void measured(const char *way, double tolerance, double *slope)
{
	(strcmp(way, "forward") == 0 ? forward : adjoint)(tolerance, slope);
}

int main(int argc, char **argv)
{
	double slope[P] = { 0 };
	measured(argv[1], argc > 2 ? atof(argv[2]) : 0, slope);
	for (int p = 0; p < P; p++)
		printf("%.17g%s", slope[p], p + 1 < P ? " " : "\n");
	return 0;
}
