/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Peers on any model. Where a model has inputs, integrators stop at every output: inputs have corners, or jumps, there.
 * Absolute tolerances are the relative one times the largest coordinate, or velocity, of the history. */
#ifndef PEERS_H
#define PEERS_H

#include <cvode/cvode.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <limits.h>
#include <nvector/nvector_serial.h>
#include <sunlinsol/sunlinsol_dense.h>
#include <sunmatrix/sunmatrix_dense.h>
#include <sunnonlinsol/sunnonlinsol_fixedpoint.h>

#include "own.h"

/* ---- RK4 ---- */

static bool rk4(double setting, double *rows)
{
	const int steps = (int)setting;
	const double h = history.every / steps, half = 0.5 * h, sixth = h / 6.0;
	double y[N], x[N], k1[N], k2[N], k3[N], k4[N];
	memcpy(y, history.start, sizeof y);
	for (int k = 0; k < history.units; k++, rows += N) {
		const double from = k * history.every;
		history.unit = k;
		for (int j = 0; j < steps; j++) {
			const double t = from + j * h;
			slope(t, y, k1);
			for (int i = 0; i < N; i++)
				x[i] = y[i] + half * k1[i];
			slope(t + half, x, k2);
			for (int i = 0; i < N; i++)
				x[i] = y[i] + half * k2[i];
			slope(t + half, x, k3);
			for (int i = 0; i < N; i++)
				x[i] = y[i] + h * k3[i];
			slope(t + h, x, k4);
			for (int i = 0; i < N; i++)
				y[i] += sixth * (k1[i] + 2.0 * (k2[i] + k3[i]) + k4[i]);
		}
		if (!all_finite(y))
			return false;
		memcpy(rows, y, sizeof y);
	}
	return true;
}

/* ---- Dormand-Prince 5(4): Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, table II.5.2; its
 * interpolant of order 4: II.6, (6.12) ---- */

struct dormand { double t, h, before, y[N], next[N], k[7][N], tolerance; };

/* From y with the slope k[0] to next with the slope k[6]; the weighted error */
INLINE double dormand_try(struct dormand *d, double h)
{
	double (*k)[N] = d->k, x[N], *y = d->y, *next = d->next, sum = 0.0;
#define EACH for (int i = 0; i < N; i++)
	EACH x[i] = y[i] + h * (1.0 / 5.0 * k[0][i]);
	slope(d->t + h * (1.0 / 5.0), x, k[1]);
	EACH x[i] = y[i] + h * (3.0 / 40.0 * k[0][i] + 9.0 / 40.0 * k[1][i]);
	slope(d->t + h * (3.0 / 10.0), x, k[2]);
	EACH x[i] = y[i] + h * (44.0 / 45.0 * k[0][i] - 56.0 / 15.0 * k[1][i] + 32.0 / 9.0 * k[2][i]);
	slope(d->t + h * (4.0 / 5.0), x, k[3]);
	EACH x[i] = y[i] + h * (19372.0 / 6561.0 * k[0][i] - 25360.0 / 2187.0 * k[1][i] + 64448.0 / 6561.0 * k[2][i] -
	                        212.0 / 729.0 * k[3][i]);
	slope(d->t + h * (8.0 / 9.0), x, k[4]);
	EACH x[i] = y[i] + h * (9017.0 / 3168.0 * k[0][i] - 355.0 / 33.0 * k[1][i] + 46732.0 / 5247.0 * k[2][i] +
	                        49.0 / 176.0 * k[3][i] - 5103.0 / 18656.0 * k[4][i]);
	slope(d->t + h, x, k[5]);
	EACH next[i] = y[i] + h * (35.0 / 384.0 * k[0][i] + 500.0 / 1113.0 * k[2][i] + 125.0 / 192.0 * k[3][i] -
	                           2187.0 / 6784.0 * k[4][i] + 11.0 / 84.0 * k[5][i]);
	slope(d->t + h, next, k[6]);
	EACH {
		const double lost = h * (71.0 / 57600.0 * k[0][i] - 71.0 / 16695.0 * k[2][i] + 71.0 / 1920.0 * k[3][i] -
		                         17253.0 / 339200.0 * k[4][i] + 22.0 / 525.0 * k[5][i] - 1.0 / 40.0 * k[6][i]);
		const double share = lost / (d->tolerance * (history.scale[i] + fmax(fabs(y[i]), fabs(next[i]))));
		sum += share * share;
	}
	return sqrt(sum / N);
}

/* At theta of the step just taken */
INLINE void dormand_inside(const struct dormand *d, double h, double theta, double *row)
{
	const double (*k)[N] = (const double (*)[N])d->k;
	const double rest = 1.0 - theta;
	EACH {
		const double across = d->next[i] - d->y[i], bend = h * k[0][i] - across;
		const double last = across - h * k[6][i] - bend;
		const double dense = h * (-12715105075.0 / 11282082432.0 * k[0][i] +
		                          87487479700.0 / 32700410799.0 * k[2][i] -
		                          10690763975.0 / 1880347072.0 * k[3][i] +
		                          701980252875.0 / 199316789632.0 * k[4][i] -
		                          1453857185.0 / 822651844.0 * k[5][i] + 69997945.0 / 29380423.0 * k[6][i]);
		row[i] = d->y[i] + theta * (across + rest * (bend + theta * (last + rest * dense)));
	}
}

/* The next step's length; PI controller, beta 0.04 */
INLINE double dormand_next(struct dormand *d, double h, double error, bool rejected)
{
	const double shrink = fmax(0.1, fmin(5.0, pow(error, 0.2 - 0.75 * 0.04) / pow(d->before, 0.04) / 0.9));
	d->before = fmax(error, 1e-4);
	return rejected ? fmin(h, h / shrink) : h / shrink;
}

static bool dormand_prince(double setting, double *rows)
{
	struct dormand d = {.before = 1e-4, .tolerance = setting, .h = 1e-3 * history.every};
	const bool stops = INPUTS > 0;
	bool rejected = false;
	memcpy(d.y, history.start, sizeof d.y);
	history.unit = 0;
	slope(0.0, d.y, d.k[0]);
	for (int k = 0; k < history.units;) {
		const double end = (k + 1) * history.every;
		const bool last = stops && d.t + d.h * (1.0 + 1e-10) >= end;
		const double h = last ? end - d.t : d.h, error = dormand_try(&d, h);
		if (!isfinite(error) || d.t + 0.1 * h == d.t)
			return false;
		if (error > 1.0) {
			rejected = true;
			d.h = h / fmin(10.0, pow(error, 0.2) / 0.9);
			continue;
		}
		const double next = dormand_next(&d, h, error, rejected);
		rejected = false;
		for (; !stops && k < history.units && (k + 1) * history.every <= d.t + h; k++, rows += N)
			dormand_inside(&d, h, ((k + 1) * history.every - d.t) / h, rows);
		d.h = last ? fmax(next, d.h) : next;
		d.t = last ? end : d.t + h;
		EACH {
			d.y[i] = d.next[i];
			d.k[0][i] = d.k[6][i];
		}
		if (last) {
			memcpy(rows, d.y, sizeof d.y);
			rows += N;
			history.unit = ++k;
			if (k < history.units)
				slope(d.t, d.y, d.k[0]);        /* held inputs have jumped */
		}
	}
	return all_finite(d.y);
}
#undef EACH

/* ---- GSL ---- */

static int gsl_slope(double t, const double y[], double f[], void *of)
{
	(void)of;
	slope(t, y, f);
	return GSL_SUCCESS;
}

static bool gsl_rk8pd(double setting, double *rows)
{
	gsl_odeiv2_system system = {gsl_slope, NULL, N, NULL};
	gsl_odeiv2_driver *driver = gsl_odeiv2_driver_alloc_scaled_new(
		&system, gsl_odeiv2_step_rk8pd, 1e-3 * history.every, setting, setting, 1.0, 0.0, history.scale);
	double y[N], t = 0.0;
	bool good = driver;
	memcpy(y, history.start, sizeof y);
	for (int k = 0; k < history.units && good; k++, rows += N) {
		history.unit = k;
		if (INPUTS > 0)
			gsl_odeiv2_driver_reset(driver);
		good = gsl_odeiv2_driver_apply(driver, &t, (k + 1) * history.every, y) == GSL_SUCCESS && all_finite(y);
		memcpy(rows, y, sizeof y);
	}
	if (driver)
		gsl_odeiv2_driver_free(driver);
	return good;
}

/* ---- CVODE ---- */

static int cvode_slope(realtype t, N_Vector y, N_Vector f, void *of)
{
	(void)of;
	slope(t, NV_DATA_S(y), NV_DATA_S(f));
	return 0;
}

static void silent(int code, const char *module, const char *function, char *message, void *of)
{
	(void)code, (void)module, (void)function, (void)message, (void)of;
}

static bool cvode_history(void *memory, N_Vector y, double *rows)
{
	bool good = true;
	double t = 0.0;
	for (int k = 0; k < history.units && good; k++, rows += N) {
		history.unit = k;
		if (INPUTS > 0)
			good = (k == 0 || CVodeReInit(memory, k * history.every, y) == 0) &&
			       CVodeSetStopTime(memory, (k + 1) * history.every) == 0;
		good = good && CVode(memory, (k + 1) * history.every, y, &t, CV_NORMAL) >= 0 &&
		       all_finite(NV_DATA_S(y));
		memcpy(rows, NV_DATA_S(y), N * sizeof *rows);
	}
	return good;
}

static bool cvode(int formula, double setting, double *rows)
{
	SUNContext context;
	if (SUNContext_Create(NULL, &context) != 0)
		return false;
	N_Vector y = N_VNew_Serial(N, context), tolerances = N_VNew_Serial(N, context);
	SUNMatrix jacobian = SUNDenseMatrix(N, N, context);
	SUNLinearSolver dense = SUNLinSol_Dense(y, jacobian, context);
	SUNNonlinearSolver fixed_point = SUNNonlinSol_FixedPoint(y, 0, context);
	void *memory = CVodeCreate(formula, context);
	memcpy(NV_DATA_S(y), history.start, sizeof history.start);
	for (int i = 0; i < N; i++)
		NV_Ith_S(tolerances, i) = setting * history.scale[i];
	const bool good = CVodeSetErrHandlerFn(memory, silent, NULL) == 0 &&
	                  CVodeInit(memory, cvode_slope, 0.0, y) == 0 &&
	                  CVodeSVtolerances(memory, setting, tolerances) == 0 && CVodeSetMaxNumSteps(memory, -1) == 0 &&
	                  (formula == CV_ADAMS ? CVodeSetNonlinearSolver(memory, fixed_point)
	                   : CVodeSetLinearSolver(memory, dense, jacobian)) == 0 && cvode_history(memory, y, rows);
	CVodeFree(&memory);
	SUNNonlinSolFree(fixed_point);
	SUNLinSolFree(dense);
	SUNMatDestroy(jacobian);
	N_VDestroy(tolerances);
	N_VDestroy(y);
	SUNContext_Free(&context);
	return good;
}

static bool cvode_adams(double setting, double *rows)
{
	return cvode(CV_ADAMS, setting, rows);
}

static bool cvode_bdf(double setting, double *rows)
{
	return cvode(CV_BDF, setting, rows);
}

/* ---- e^{A h} of y' = A y + b, found once; applied by a loop whose length is known ---- */

static struct { double A[N + 1][N + 1], E[N + 1][N + 1]; bool made; } propagator;

/* Are the equations that?  A and b from rest and unit states; then they have to agree with what is asked at states of
 * the history's size, of either sign, at other times */
static bool is_affine(void)
{
	double y[N] = {0}, f[N], b[N];
	uint64_t seed = 1;
	history.evaluations = 0, history.most = LONG_MAX;
	slope(0.0, y, b);
	for (int j = 0; j < N; j++) {
		y[j] = 1.0;
		slope(0.0, y, f);
		y[j] = 0.0;
		for (int i = 0; i < N; i++)
			propagator.A[i][j] = f[i] - b[i];
	}
	for (int k = 1; k <= 40; k++) {
		for (int j = 0; j < N; j++) {
			seed = seed * 6364136223846793005u + 1442695040888963407u;
			y[j] = 2.0 * history.scale[j] * ((double)(seed >> 40) / 8388608.0 - 1.0);
		}
		slope(k / 41.0 * history.units * history.every, y, f);
		for (int i = 0; i < N; i++) {
			double sum = b[i], sizes = fabs(b[i]);
			for (int j = 0; j < N; j++) {
				sum += propagator.A[i][j] * y[j];
				sizes += fabs(propagator.A[i][j] * y[j]);
			}
			if (!(fabs(f[i] - sum) <= 1e-12 * sizes))
				return false;
		}
	}
	for (int i = 0; i < N; i++)
		propagator.A[i][N] = b[i];
	return INPUTS == 0;
}

/* What is timed is its use */
static void make_exponential(void)
{
	if (!propagator.made)
		rounded_exponential(N + 1, *propagator.A, history.every, *propagator.E);
	propagator.made = true;
}

static bool exponential_loop(double setting, double *rows)
{
	(void)setting;
	double E[N][N], add[N], y[N], next[N];
	make_exponential();
	for (int i = 0; i < N; i++) {
		memcpy(E[i], propagator.E[i], sizeof E[i]);
		add[i] = propagator.E[i][N];
	}
	memcpy(y, history.start, sizeof y);
	for (int k = 0; k < history.units; k++, rows += N) {
		for (int i = 0; i < N; i++) {
			double sum = add[i];
			for (int j = 0; j < N; j++)
				sum += E[i][j] * y[j];
			next[i] = sum;
		}
		memcpy(y, next, sizeof y);
		memcpy(rows, y, sizeof y);
	}
	return all_finite(y);
}

/* ---- the same as constants in code: made once, too ---- */

static void (*advance)(double *z, long units, double *rows);

static bool has_literals(void)
{
	void *code;
	if (!is_affine())
		return false;
	make_exponential();
	code = own_literals(N, *propagator.E);
	memcpy(&advance, &code, sizeof code);
	return advance;
}

static bool exponential_literals(double setting, double *rows)
{
	(void)setting;
	double z[N + 1];
	memcpy(z, history.start, sizeof history.start);
	z[N] = 1.0;
	advance(z, history.units, rows);
	return all_finite(z);
}

#endif
