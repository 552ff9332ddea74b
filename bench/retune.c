/* SPDX-License-Identifier: GPL-3.0-or-later */
/* retune NAME DAMPING STEP ...: time of NAME_retune for two masses at each of these steps of h, beside that of GSL's
 * exponential of the same matrix in double: in short samples that take turns so that both meet the same machine; prints
 * medians and ratios, and how far both exponentials are apart. */
#include "tuned_pl.h"
#include "timing.h"

#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#ifdef REAL_FLOAT
typedef float real;
#define REAL_NAME "float"
#else
typedef double real;
#define REAL_NAME "double"
#endif

enum { SAMPLES = 301, RETUNES = 20, STATES = TUNED_STATES };
enum { COLUMNS = sizeof tuned_nominal.step[0] / sizeof(real) };

/* Masses and springs of the models, and what drives sdcsf */
static void slopes(double damping, double A[COLUMNS][COLUMNS])
{
	for (int i = 0; i < 2; i++) {
		A[i][2 + i] = 1.0;
		for (int j = 0; j < 2; j++) {
			A[2 + i][j] = i == j ? -200.0 : 100.0;
			A[2 + i][2 + j] = damping * (i == j ? -2.0 : 1.0);
		}
	}
	if (COLUMNS == 6) {
		A[2][4] = 1.0;
		A[4][COLUMNS - 1] = -5.0;
		A[COLUMNS - 1][4] = 5.0;
	}
}

/* Each with other params */
static double sample_retune(tuned_coeffs *coeffs, double h)
{
	real params[TUNED_PARAMS];
	double start = nanoseconds();
	for (int k = 0; k < RETUNES; k++) {
		for (int i = 0; i < TUNED_PARAMS; i++)
			params[i] = tuned_nominal.params[i] * (1 + (real)1e-3 * (real)(RETUNES - 1 - k));
		if (tuned_retune(coeffs, params, (real)h) != 0)
			exit(1);
	}
	return (nanoseconds() - start) / RETUNES;
}

static double sample_gsl(double A[COLUMNS][COLUMNS], double h, double E[COLUMNS][COLUMNS])
{
	double scaled[COLUMNS][COLUMNS];
	gsl_matrix_view from = gsl_matrix_view_array(scaled[0], COLUMNS, COLUMNS),
		to = gsl_matrix_view_array(E[0], COLUMNS, COLUMNS);
	double start = nanoseconds();
	for (int k = 0; k < RETUNES; k++) {
		for (int i = 0; i < COLUMNS * COLUMNS; i++)
			scaled[i / COLUMNS][i % COLUMNS] = h * A[i / COLUMNS][i % COLUMNS];
		if (gsl_linalg_exponential_ss(&from.matrix, &to.matrix, GSL_PREC_DOUBLE) != 0)
			exit(1);
	}
	return (nanoseconds() - start) / RETUNES;
}

/* The largest difference, as part of the largest entry of its column's block: states, loads */
static double apart(const tuned_coeffs *coeffs, double E[COLUMNS][COLUMNS])
{
	double most = 0.0;
	for (int from = 0; from < COLUMNS; from += STATES) {
		double off = 0.0, largest = 0.0;
		for (int i = 0; i < STATES; i++)
			for (int j = from; j < from + STATES && j < COLUMNS; j++) {
				double D = E[i][j] - (i == j);
				off = fmax(off, fabs(coeffs->step[i][j] - D));
				largest = fmax(largest, fabs(D));
			}
		most = fmax(most, off / largest);
	}
	return most;
}

int main(int argc, char **argv)
{
	static double retune[SAMPLES], gsl[SAMPLES], A[COLUMNS][COLUMNS], E[COLUMNS][COLUMNS];
	tuned_coeffs coeffs = tuned_nominal;
	if (argc < 4)
		return 2;
	slopes(atof(argv[2]), A);
	for (int a = 3; a < argc; a++) {
		double h = atof(argv[a]);
		for (int k = 0; k < SAMPLES; k++) {
			retune[k] = sample_retune(&coeffs, h);
			gsl[k] = sample_gsl(A, h, E);
		}
		double ours = median(retune), theirs = median(gsl);
		printf("%-6s %-6s |pole| h %6.3g: retune %7.0f ns; gsl_linalg_exponential_ss %7.0f ns, %5.1f times "
		       "that; they differ by %.1e\n", argv[1], REAL_NAME, sqrt(300.0) * h, ours, theirs, theirs / ours,
		       apart(&coeffs, E));
	}
	return 0;
}
