/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef EIGEN_H
#define EIGEN_H

#include <complex.h>
#include <gsl/gsl_eigen.h>
#include <stdbool.h>
#include <string.h>

/* Of a real matrix, n x n, row-major, which is used up: vector k is column k, those of a pair follow one another, the
 * one above the real axis first. false: GSL finds none. */
static inline bool eigenvectors(int n, double *matrix, double complex *value, double complex *vector)
{
	const size_t size = (size_t)n;
	gsl_vector_complex *values = gsl_vector_complex_alloc(size);
	gsl_matrix_complex *vectors = gsl_matrix_complex_alloc(size, size);
	gsl_eigen_nonsymmv_workspace *work = gsl_eigen_nonsymmv_alloc(size);
	gsl_matrix_view view = gsl_matrix_view_array(matrix, size, size);
	const bool good = gsl_eigen_nonsymmv(&view.matrix, values, vectors, work) == 0;
	memcpy(value, values->data, size * sizeof *value);
	memcpy(vector, vectors->data, size * size * sizeof *vector);
	gsl_eigen_nonsymmv_free(work);
	gsl_matrix_complex_free(vectors);
	gsl_vector_complex_free(values);
	return good;
}

#endif
