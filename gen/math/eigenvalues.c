/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eigenvalues, and equations solved, in double precision: to begin with, to choose by, or to report. */
#include "math/math.h"

#include <complex.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <math.h>

static bool find(int n, const double *A, double *re, double *im)
{
	gsl_error_handler_t *handler = gsl_set_error_handler_off();
	gsl_matrix *m = need_memory(gsl_matrix_alloc((size_t)n, (size_t)n));
	gsl_vector_complex *eigen = need_memory(gsl_vector_complex_alloc((size_t)n));
	gsl_eigen_nonsymm_workspace *work = need_memory(gsl_eigen_nonsymm_alloc((size_t)n));
	bool finite = true;
	for (int i = 0; i < n * n; i++) {
		finite = finite && isfinite(A[i]);
		gsl_matrix_set(m, (size_t)(i / n), (size_t)(i % n), A[i]);
	}
	gsl_eigen_nonsymm_params(0, 1, work);
	bool found = finite && gsl_eigen_nonsymm(m, eigen, work) == GSL_SUCCESS;
	for (int i = 0; i < n && found; i++) {
		gsl_complex z = gsl_vector_complex_get(eigen, (size_t)i);
		re[i] = GSL_REAL(z);
		im[i] = GSL_IMAG(z);
	}
	gsl_set_error_handler(handler);
	gsl_eigen_nonsymm_free(work);
	gsl_vector_complex_free(eigen);
	gsl_matrix_free(m);
	return found;
}

bool eigenvalues(int n, const mpq_t *A, double *re, double *im)
{
	SCRATCH double *rounded = ARRAY(double, (size_t)n * (size_t)n);
	for (int i = 0; i < n * n; i++)
		rounded[i] = nearest_double(A[i]);
	return find(n, rounded, re, im);
}

double spectral_radius(int n, const double *A)
{
	SCRATCH double *re = ARRAY(double, n), *im = ARRAY(double, n);
	double radius = 0;
	bool found = find(n, A, re, im);
	for (int i = 0; i < n; i++)
		radius = hypot(re[i], im[i]) > radius ? hypot(re[i], im[i]) : radius;
	return found ? radius : HUGE_VAL;
}

/* Row c and the one with the largest entry in column c change places; false: that is nothing beside what is left */
static bool take_pivot(int n, int c, double complex *A, double complex *b)
{
	int pivot = c;
	double most = 0;
	for (int i = c; i < n; i++) {
		pivot = cabs(A[i * n + c]) > cabs(A[pivot * n + c]) ? i : pivot;
		for (int j = c; j < n; j++)
			most = fmax(most, cabs(A[i * n + j]));
	}
	for (int j = 0; j < n && pivot != c; j++) {
		const double complex swap = A[c * n + j];
		A[c * n + j] = A[pivot * n + j];
		A[pivot * n + j] = swap;
	}
	const double complex other = b[pivot];
	b[pivot] = b[c];
	b[c] = other;
	return cabs(A[c * n + c]) > 1e-14 * most;
}

bool solve_complex(int n, double complex *A, double complex *b)
{
	bool regular = true;
	for (int c = 0; c < n; c++) {
		regular = take_pivot(n, c, A, b) && regular;
		for (int i = c + 1; i < n; i++) {
			const double complex factor = A[i * n + c] / A[c * n + c];
			for (int j = c; j < n; j++)
				A[i * n + j] -= factor * A[c * n + j];
			b[i] -= factor * b[c];
		}
	}
	for (int i = n - 1; i >= 0; i--) {
		for (int j = i + 1; j < n; j++)
			b[i] -= A[i * n + j] * b[j];
		b[i] /= A[i * n + i];
	}
	return regular;
}
