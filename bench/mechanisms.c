/* SPDX-License-Identifier: GPL-3.0-or-later */
/* mechanisms.sh compiles this for one model: a history by plgen's step, without OURS by DOP853 or RADAU5 of the kept
 * charts, or by IDA. `measured` is what callgrind counts; then the last state is printed.
 *
 *     mechanisms UNITS taylor | dop853 TOLERANCE | radau5 TOLERANCE | ida TOLERANCE */
#ifdef OURS
#include "subject_pl.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
enum { N = SUBJECT_STATES };
static subject model;
#else
#include "own.h"
#include <ida/ida.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
bool own_dop853(double setting, double *rows);          /* the files of the kept charts, of this model */
bool own_radau5(double setting, double *rows);
struct history history;
static double rows[100000];

/* y' - f(t, y): of constraints the equations that remain when they are differentiated twice */
static int residual(realtype t, N_Vector y, N_Vector slope, N_Vector r, void *context)
{
	(void)context;
	rhs_double(t, N_VGetArrayPointer(y), N_VGetArrayPointer(r));
	N_VLinearSum(1.0, slope, -1.0, r, r);
	return 0;
}

static bool own_ida(double setting, double *row)
{
	SUNContext context;
	SUNContext_Create(NULL, &context);
	N_Vector y = N_VNew_Serial(N, context), slope = N_VNew_Serial(N, context);
	SUNMatrix J = SUNDenseMatrix(N, N, context);
	void *ida = IDACreate(context);
	realtype t;
	memcpy(N_VGetArrayPointer(y), history.start, sizeof history.start);
	rhs_double(0.0, history.start, N_VGetArrayPointer(slope));
	bool good = IDAInit(ida, residual, 0.0, y, slope) == 0 && IDASStolerances(ida, setting, setting) == 0 &&
		    IDASetLinearSolver(ida, SUNLinSol_Dense(y, J, context), J) == 0 &&
		    IDASetMaxNumSteps(ida, 10000000) == 0;
	for (int k = 1; k <= history.units && good; k++) {
		good = IDASolve(ida, k * history.every, &t, y, slope, IDA_NORMAL) >= 0;
		memcpy(row + (k - 1) * N, N_VGetArrayPointer(y), sizeof history.start);
	}
	return good;
}
#endif

__attribute__((noinline)) void measured(int units, const char *method, double tolerance, double *last)
{
#ifdef OURS
	(void)method;
	(void)tolerance;
	subject_run(&model, (size_t)units, NULL);
	subject_get(&model, last);
#else
	const bool good = strcmp(method, "dop853") == 0 ? own_dop853(tolerance, rows)
		  : strcmp(method, "ida") == 0 ? own_ida(tolerance, rows) : own_radau5(tolerance, rows);
	for (int i = 0; i < N; i++)
		last[i] = good ? rows[(units - 1) * N + i] : NAN;
#endif
}

int main(int argc, char **argv)
{
	const int units = atoi(argv[1]);
	double last[N] = { 0 };
#ifdef OURS
	subject_init(&model);
#else
	const double start[N] = { START };
	history.every = EVERY;
	history.units = units;
	history.most = 1000000000;
	for (int i = 0; i < N; i++) {
		history.start[i] = start[i];
		history.scale[i] = i < N / 2 ? 1.0 : 5.0;
	}
#endif
	measured(units, argv[2], argc > 3 ? atof(argv[3]) : 0.0, last);
	for (int i = 0; i < N; i++)
		printf("%.17g%c", last[i], i < N - 1 ? ' ' : '\n');
	return 0;
}
