/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Residues as one would type them in from the page (Fang, Wang, Dai and Zhang 2020), in double: the poles from GSL's
 * polynomial solver, every pole taken for a simple one, A(s)/B'(s) e^{sh} summed into the matrix of a step. For one or
 * two coordinates. It shows what plgen's exact multiplicities and correct rounding are for; nobody need write it like
 * this. */
#include "propagator.h"

#include <complex.h>
#include <gsl/gsl_poly.h>
#include <math.h>
#include <string.h>

enum { MOST = 4 + MOST_LOADS };

/* det(s^2 + C s + K), rising powers */
static void characteristic(int size, int n, const double *G, double B[5])
{
	double P[2][2][3] = { { { 0 } } };
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			const double *row = G + (n + i) * size, entry[3] = { -row[j], -row[n + j], i == j };
			memcpy(P[i][j], entry, sizeof entry);
		}
	for (int i = 0; i <= 2; i++) {
		B[i] += n == 1 ? P[0][0][i] : 0;
		for (int j = 0; j <= 2 && n == 2; j++)
			B[i + j] += P[0][0][i] * P[1][1][j] - P[0][1][i] * P[1][0][j];
	}
}

/* Its roots, then the poles of the loads that there are */
static bool find_poles(int size, int own, const double *G, const double *B, double complex *s)
{
	double root[8];
	gsl_poly_complex_workspace *work = gsl_poly_complex_workspace_alloc((size_t)own + 1);
	const int status = gsl_poly_complex_solve(B, (size_t)own + 1, work, root);
	gsl_poly_complex_workspace_free(work);
	for (int k = 0; k < own; k++)
		s[k] = CMPLX(root[2 * k], root[2 * k + 1]);
	if ((size - own) % 2 == 1)
		s[own] = 0;
	if (size - own >= 2) {
		s[size - 2] = CMPLX(0, G[(size - 1) * size + size - 2]);
		s[size - 1] = conj(s[size - 2]);
	}
	return status == 0;
}

/* B'(s_k), B with the poles of loads up to `poles` */
static double complex slope_at(int k, int own, int poles, const double *B, const double complex *s)
{
	double complex value = 0, slope = 0;
	for (int i = own; i >= 0; i--) {
		slope = slope * s[k] + value;
		value = value * s[k] + B[i];
	}
	if (k < own && poles - own >= 2)
		slope *= s[k] * s[k] + cimag(s[poles - 2]) * cimag(s[poles - 2]);
	if (k < own)
		return (poles - own) % 2 == 1 ? slope * s[k] : slope;
	for (int j = own; j < poles; j++)
		value *= j == k ? 1 : s[k] - s[j];
	return value;
}

/* Columns from `from` on, of the leading `poles`, by that many simple poles s_k: A(s_k) is the product of G - s_j over
 * the others */
static void add_residues(int size, int own, int from, int poles, const double *G, const double *B,
						 const double complex *s, double h, double *result)
{
	double complex A[MOST][MOST], next[MOST][MOST];
	for (int k = 0; k < poles; k++) {
		for (int i = 0; i < poles; i++)
			for (int j = from; j < poles; j++)
				A[i][j] = i == j ? cexp(s[k] * h) / slope_at(k, own, poles, B, s) : 0;
		for (int other = 0; other < poles; other++) {
			for (int i = 0; i < poles && other != k; i++)
				for (int j = from; j < poles; j++) {
					next[i][j] = -s[other] * A[i][j];
					for (int m = 0; m < poles; m++)
						next[i][j] += G[i * size + m] * A[m][j];
				}
			memcpy(A, other == k ? A : next, sizeof A);
		}
		for (int i = 0; i < own; i++)
			for (int j = from; j < poles; j++)
				result[i * size + j] += creal(A[i][j]);
	}
}

/* What acts on the loads are they alone: they go on as one would write them */
void naive_exponential(int size, const double *G, double h, double *result)
{
	const int own = G[1] == 1 ? 2 : 4;              /* q1' = v1, which stands behind the coordinates */
	double B[5] = { 0 };
	double complex s[MOST];
	characteristic(size, own / 2, G, B);
	const bool good = size <= MOST && find_poles(size, own, G, B, s);
	for (int i = 0; i < size * size; i++)
		result[i] = good ? 0 : NAN;
	if (!good)
		return;
	add_residues(size, own, 0, own, G, B, s, h, result);
	add_residues(size, own, own, size, G, B, s, h, result);
	for (int i = own; i < size; i++)
		for (int j = own; j < size; j++)
			result[i * size + j] = i == j ? creal(cexp(s[i] * h)) : G[i * size + j] == 0 ? 0
				: copysign(fabs(cimag(cexp(s[i] * h))), G[i * size + j]);
}
