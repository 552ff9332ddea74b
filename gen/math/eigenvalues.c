/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Eigenvalues, and equations solved, in double precision: to begin with, to choose by, or to report. */
#include "math/math.h"
#include "plrt.h"

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

bool solve_complex(int n, double complex *A, double complex *b)
{
	SCRATCH int *pivot = ARRAY(int, n);
	double most = 0;
	for (int i = 0; i < n * n; i++)
		most = fmax(most, cabs(A[i]));
	bool regular = pl_factor_complex(n, (double *)A, pivot);
	if (regular)
		pl_solve_complex(n, (double *)A, pivot, (double *)b);
	for (int i = 0; i < n && !regular; i++)
		b[i] = HUGE_VAL;
	for (int i = 0; i < n; i++)             /* factors have 1 over each pivot */
		regular = regular && cabs(A[i * n + i]) * most < 1e14;
	return regular;
}
