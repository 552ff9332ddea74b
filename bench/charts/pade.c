/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The matrix exponential as MATLAB, Julia and SciPy have it: the diagonal Pade approximant of degree 13, scaling and
 * squaring (Higham, SIAM Journal on Matrix Analysis and Applications 26, 2005), in double. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_linalg.h>

#include "charts.h"

/* Coefficients of the numerator, over the last one: (26 - k)! 13!/(26! k! (13 - k)!), times 26!/13! */
static const double b[] = { 64764752532480000, 32382376266240000, 7771770303897600, 1187353796428800, 129060195264000,
	10559470521600, 670442572800, 33522128640, 1323241920, 40840800, 960960, 16380, 182, 1 };
static const double largest_norm = 5.371920351148152;   /* of which the approximant keeps double precision: theta_13 */

void matrix_product(int n, const double *x, const double *y, double *result)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			double sum = 0.0;
			for (int k = 0; k < n; k++)
				sum += x[i * n + k] * y[k * n + j];
			result[i * n + j] = sum;
		}
}

/* The largest sum of a column */
static double norm_of(int n, const double *x)
{
	double most = 0.0;
	for (int j = 0; j < n; j++) {
		double sum = 0.0;
		for (int i = 0; i < n; i++)
			sum += fabs(x[i * n + j]);
		most = fmax(most, sum);
	}
	return most;
}

/* (V - U) X = V + U, into X; A: three powers of the matrix, A^2, A^4, A^6 */
static bool approximant(int n, const double *x, double *const power[3], double *spare, double *result)
{
	const size_t entries = (size_t)(n * n);
	double *U = spare, *V = spare + entries, *inner = spare + 2 * entries;
	const double *A2 = power[0], *A4 = power[1], *A6 = power[2];
	for (int i = 0; i < n * n; i++)
		inner[i] = b[13] * A6[i] + b[11] * A4[i] + b[9] * A2[i];
	matrix_product(n, A6, inner, V);
	for (int i = 0; i < n * n; i++)
		V[i] += b[7] * A6[i] + b[5] * A4[i] + b[3] * A2[i] + (i % (n + 1) == 0 ? b[1] : 0.0);
	matrix_product(n, x, V, U);
	for (int i = 0; i < n * n; i++)
		inner[i] = b[12] * A6[i] + b[10] * A4[i] + b[8] * A2[i];
	matrix_product(n, A6, inner, V);
	for (int i = 0; i < n * n; i++)
		V[i] += b[6] * A6[i] + b[4] * A4[i] + b[2] * A2[i] + (i % (n + 1) == 0 ? b[0] : 0.0);
	for (int i = 0; i < n * n; i++) {
		inner[i] = V[i] - U[i];
		V[i] += U[i];
	}
	gsl_matrix_view matrix = gsl_matrix_view_array(inner, (size_t)n, (size_t)n);
	gsl_permutation *order = gsl_permutation_alloc((size_t)n);
	int sign;
	bool good = order && gsl_linalg_LU_decomp(&matrix.matrix, order, &sign) == 0;
	for (int j = 0; j < n && good; j++) {
		gsl_vector_view column = gsl_vector_view_array_with_stride(V + j, (size_t)n, (size_t)n);
		good = gsl_linalg_LU_svx(&matrix.matrix, order, &column.vector) == 0;
	}
	gsl_permutation_free(order);
	memcpy(result, V, entries * sizeof *result);
	return good;
}

bool pade_exponential(int n, const double *A, double length, double *result)
{
	const size_t entries = (size_t)(n * n);
	double *x = calloc(7 * entries + 1, sizeof *x);
	double *const power[3] = { x + entries, x + 2 * entries, x + 3 * entries };
	int squarings = 0;
	bool good = x;
	for (size_t i = 0; good && i < entries; i++)
		x[i] = length * A[i];
	const double norm = good ? norm_of(n, x) : NAN;
	good = isfinite(norm);
	if (good && norm > largest_norm)
		squarings = (int)ceil(log2(norm / largest_norm));
	for (size_t i = 0; good && i < entries; i++)
		x[i] = ldexp(x[i], -squarings);
	if (good) {
		matrix_product(n, x, x, power[0]);
		matrix_product(n, power[0], power[0], power[1]);
		matrix_product(n, power[0], power[1], power[2]);
		good = approximant(n, x, power, x + 4 * entries, result);
	}
	for (int k = 0; k < squarings && good; k++) {
		matrix_product(n, result, result, x);
		memcpy(result, x, entries * sizeof *result);
	}
	for (size_t i = 0; i < entries && !good; i++)
		result[i] = NAN;
	free(x);
	return good;
}
