/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The smallest real invariant subspaces of a matrix, right and left: eigenvectors in double precision (QR: Golub and
 * Van Loan 2013, 7.5 and 8.3), of which those of eigenvalues that lie together have one subspace. subspace.c has more
 * digits. All is done on the balanced matrix D^-1 A D, D of powers of two.
 */
#include "math/invariant.h"

#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>

#define TOGETHER_NEAR 1e-6          /* of their size: eigenvalues that share a subspace */
#define TOGETHER_FAR 1e-12          /* of the largest, of a symmetric matrix */
#define TOGETHER_SPLIT 3e-8         /* of any other: a double one is split by the root of what rounding does */

/* ---- eigenvectors in double precision ---- */

static struct invariants *invariants_new(int n, const mpq_t *A)
{
	struct invariants *of = NEW(struct invariants);
	const size_t cells = (size_t)n * (size_t)n;
	*of = (struct invariants){ .n = n, .A = A };
	of->scale = ARRAY(double, n);
	of->re = ARRAY(double, n);
	of->im = ARRAY(double, n);
	of->V_re = ARRAY(double, cells);
	of->V_im = ARRAY(double, cells);
	of->W_re = ARRAY(double, cells);
	of->W_im = ARRAY(double, cells);
	for (int i = 0; i < n * n; i++)
		of->cells += mpq_sgn(A[i]) != 0;
	of->cell = ARRAY(struct cell, of->cells + 1);
	for (int i = 0, c = 0; i < n * n; i++)
		if (mpq_sgn(A[i]) != 0)
			of->cell[c++] = (struct cell){ i / n, i % n };
	return of;
}

static gsl_matrix *matrix_of(int n, const mpq_t *A, bool *finite)
{
	gsl_matrix *m = need_memory(gsl_matrix_alloc((size_t)n, (size_t)n));
	for (int i = 0; i < n * n; i++) {
		const double value = nearest_double(A[i]);
		*finite = *finite && isfinite(value);
		gsl_matrix_set(m, (size_t)(i / n), (size_t)(i % n), value);
	}
	return m;
}

static void measure(struct invariants *of, const gsl_matrix *A)
{
	for (int i = 0; i < of->n; i++) {
		double sum = 0;
		for (int j = 0; j < of->n; j++)
			sum += fabs(gsl_matrix_get(A, (size_t)i, (size_t)j));
		of->size = sum > of->size ? sum : of->size;
	}
}

static bool general_vectors(struct invariants *of)
{
	const size_t n = (size_t)of->n;
	bool found = true;
	gsl_matrix *A = matrix_of(of->n, of->A, &found);
	gsl_vector *D = need_memory(gsl_vector_alloc(n));
	gsl_vector_complex *eigen = need_memory(gsl_vector_complex_alloc(n));
	gsl_matrix_complex *V = need_memory(gsl_matrix_complex_alloc(n, n));
	gsl_eigen_nonsymmv_workspace *work = need_memory(gsl_eigen_nonsymmv_alloc(n));
	found = found && gsl_linalg_balance_matrix(A, D) == GSL_SUCCESS;
	measure(of, A);
	found = found && gsl_eigen_nonsymmv(A, eigen, V, work) == GSL_SUCCESS;
	for (size_t i = 0; i < n && found; i++) {
		const gsl_complex z = gsl_vector_complex_get(eigen, i);
		of->re[i] = GSL_REAL(z);
		of->im[i] = GSL_IMAG(z);
		of->scale[i] = gsl_vector_get(D, i);
		for (size_t j = 0; j < n; j++) {
			const gsl_complex v = gsl_matrix_complex_get(V, i, j);
			of->V_re[i * n + j] = GSL_REAL(v);
			of->V_im[i * n + j] = GSL_IMAG(v);
			found = found && isfinite(GSL_REAL(v)) && isfinite(GSL_IMAG(v));
		}
	}
	gsl_eigen_nonsymmv_free(work);
	gsl_matrix_complex_free(V);
	gsl_vector_complex_free(eigen);
	gsl_vector_free(D);
	gsl_matrix_free(A);
	return found;
}

/* of M^-1 K, M with a diagonal of ones after scaling */
static bool symmetric_vectors(struct invariants *of, const mpq_t *mass, const mpq_t *stiffness)
{
	const size_t n = (size_t)of->n;
	bool found = true;
	gsl_matrix *M = matrix_of(of->n, mass, &found), *K = matrix_of(of->n, stiffness, &found);
	gsl_matrix *V = need_memory(gsl_matrix_alloc(n, n)), *whole = NULL;
	gsl_vector *eigen = need_memory(gsl_vector_alloc(n));
	gsl_eigen_gensymmv_workspace *work = need_memory(gsl_eigen_gensymmv_alloc(n));
	for (size_t i = 0; i < n; i++) {
		const double d = gsl_matrix_get(M, i, i);
		found = found && d > 0;
		of->scale[i] = found ? ldexp(1, -(int)lround(log2(d) / 2)) : 1;
	}
	for (size_t i = 0; i < n * n; i++) {
		const double both = of->scale[i / n] * of->scale[i % n];
		gsl_matrix_set(M, i / n, i % n, both * gsl_matrix_get(M, i / n, i % n));
		gsl_matrix_set(K, i / n, i % n, both * gsl_matrix_get(K, i / n, i % n));
	}
	whole = need_memory(gsl_matrix_alloc(n, n));
	gsl_matrix_memcpy(whole, M);
	found = found && gsl_eigen_gensymmv(K, M, eigen, V, work) == GSL_SUCCESS;
	for (size_t j = 0; j < n && found; j++) {
		double norm = 0;
		of->re[j] = gsl_vector_get(eigen, j);
		of->size = fabs(of->re[j]) > of->size ? fabs(of->re[j]) : of->size;
		for (size_t i = 0; i < n; i++) {
			double sum = 0;
			for (size_t k = 0; k < n; k++)
				sum += gsl_matrix_get(whole, i, k) * gsl_matrix_get(V, k, j);
			of->V_re[i * n + j] = gsl_matrix_get(V, i, j);
			of->W_re[j * n + i] = sum;
			norm += sum * of->V_re[i * n + j];
		}
		found = norm > 0 && isfinite(norm);
		for (size_t i = 0; i < n; i++)
			of->W_re[j * n + i] /= norm;
	}
	gsl_eigen_gensymmv_free(work);
	gsl_vector_free(eigen);
	gsl_matrix_free(whole);
	gsl_matrix_free(V);
	gsl_matrix_free(K);
	gsl_matrix_free(M);
	return found;
}

/* ---- which eigenvalues lie together ---- */

static bool lie_together(const struct invariants *of, int i, int j, double far)
{
	const double a = hypot(of->re[i], of->im[i]), b = hypot(of->re[j], of->im[j]);
	const double apart = hypot(of->re[i] - of->re[j], of->im[i] - of->im[j]);
	return apart <= TOGETHER_NEAR * (a > b ? a : b) + far;
}

/* A part whose eigenvalues include conjugates of each other is real; else its conjugate is left out. */
static void add_part(struct invariants *of, int *parent, int root)
{
	struct invariant part = { .first = of->parts ? of->part[of->parts - 1].first : 0, .real = true };
	int upper = 0, lower = 0, count = 0;
	if (of->parts)
		part.first += of->part[of->parts - 1].members;
	for (int i = 0; i < of->n; i++)
		if (root_of_node(parent, i) == root) {
			of->member[part.first + count++] = i;
			upper += of->im[i] > 0;
			lower += of->im[i] < 0;
			part.re += of->re[i];
			part.im += of->im[i];
		}
	if (lower == count)
		return;
	part.real = upper != count;
	part.members = count;
	part.columns = part.real ? count : 2 * count;
	part.re /= count;
	part.im = part.real ? 0 : part.im / count;
	of->part[of->parts++] = part;
}

static int by_size(const void *a, const void *b)
{
	const struct invariant *p = a, *q = b;
	const double x = hypot(p->re, p->im), y = hypot(q->re, q->im);
	return x < y ? -1 : x > y ? 1 : p->first - q->first;
}

static void find_parts(struct invariants *of, bool symmetric)
{
	SCRATCH int *parent = numbers_up_to(of->n);
	double largest = 0;
	of->part = ARRAY(struct invariant, of->n);
	of->member = ARRAY(int, of->n);
	for (int i = 0; i < of->n; i++)
		largest = hypot(of->re[i], of->im[i]) > largest ? hypot(of->re[i], of->im[i]) : largest;
	const double far = largest * (symmetric ? TOGETHER_FAR : TOGETHER_SPLIT);
	for (int i = 0; i < of->n; i++)
		for (int j = 0; j < i; j++)
			if (lie_together(of, i, j, far))
				join_nodes(parent, i, j);
	for (int i = 0; i < of->n; i++)
		if (root_of_node(parent, i) == i)
			add_part(of, parent, i);
	qsort(of->part, (size_t)of->parts, sizeof *of->part, by_size);
}

/* ---- a basis of each part ---- */

/* Column j less its part along column k, k of length 1 */
static void project_out(struct invariants *of, int j, int k)
{
	const int n = of->n;
	double re = 0, im = 0;
	for (int i = 0; i < n; i++) {
		re += of->V_re[i * n + k] * of->V_re[i * n + j] + of->V_im[i * n + k] * of->V_im[i * n + j];
		im += of->V_re[i * n + k] * of->V_im[i * n + j] - of->V_im[i * n + k] * of->V_re[i * n + j];
	}
	for (int i = 0; i < n; i++) {
		const double v_re = of->V_re[i * n + k], v_im = of->V_im[i * n + k];
		of->V_re[i * n + j] -= re * v_re - im * v_im;
		of->V_im[i * n + j] -= re * v_im + im * v_re;
	}
}

static double column_length(const struct invariants *of, int j)
{
	double sum = 0;
	for (int i = 0; i < of->n; i++)
		sum = hypot(sum, hypot(of->V_re[i * of->n + j], of->V_im[i * of->n + j]));
	return sum;
}

static void scale_column(struct invariants *of, int j, double re, double im)
{
	for (int i = 0; i < of->n; i++) {
		const double v_re = of->V_re[i * of->n + j], v_im = of->V_im[i * of->n + j];
		of->V_re[i * of->n + j] = re * v_re - im * v_im;
		of->V_im[i * of->n + j] = re * v_im + im * v_re;
	}
}

/* The largest of the first `leading` entries, as written, becomes 1. */
static void scale_to_largest(struct invariants *of, int j, int leading)
{
	int at = 0;
	double most = 0;
	for (int i = 0; i < leading; i++) {
		const double size = of->scale[i] * hypot(of->V_re[i * of->n + j], of->V_im[i * of->n + j]);
		if (size > most * (1 + 1e-9)) {         /* the first of those that are alike */
			most = size;
			at = i;
		}
	}
	const double re = of->V_re[at * of->n + j], im = of->V_im[at * of->n + j], square = re * re + im * im;
	if (square > 0)
		scale_column(of, j, re / square / of->scale[at], -im / square / of->scale[at]);
}

/* Of a real part with conjugate eigenvectors: their real and imaginary parts */
static void make_real(struct invariants *of, const struct invariant *part)
{
	const int n = of->n;
	for (int a = 0; a < part->members; a++) {
		const int j = of->member[part->first + a];
		const bool imaginary = of->im[j] < 0;
		for (int i = 0; i < n; i++) {
			if (imaginary)
				of->V_re[i * n + j] = of->V_im[i * n + j];
			of->V_im[i * n + j] = 0;
		}
	}
}

static bool orthonormalize(struct invariants *of, const struct invariant *part)
{
	bool good = true;
	if (part->real)
		make_real(of, part);
	for (int a = 0; a < part->members; a++) {
		const int j = of->member[part->first + a];
		double length = column_length(of, j);
		for (int again = 0; again < 2; again++)
			for (int b = 0; b < a; b++)
				project_out(of, j, of->member[part->first + b]);
		good = good && column_length(of, j) > 1e-12 * length;
		length = column_length(of, j);
		if (length > 0)
			scale_column(of, j, 1 / length, 0);
	}
	return good;
}

static bool complete_inverse(struct invariants *of)
{
	const size_t n = (size_t)of->n;
	gsl_matrix_complex *V = need_memory(gsl_matrix_complex_alloc(n, n)),
			   *W = need_memory(gsl_matrix_complex_alloc(n, n));
	gsl_permutation *order = need_memory(gsl_permutation_alloc(n));
	int sign;
	for (size_t i = 0; i < n * n; i++)
		gsl_matrix_complex_set(V, i / n, i % n, gsl_complex_rect(of->V_re[i], of->V_im[i]));
	bool good = gsl_linalg_complex_LU_decomp(V, order, &sign) == GSL_SUCCESS;
	for (size_t i = 0; i < n && good; i++) {
		const gsl_complex pivot = gsl_matrix_complex_get(V, i, i);
		good = GSL_REAL(pivot) != 0 || GSL_IMAG(pivot) != 0;
	}
	good = good && gsl_linalg_complex_LU_invert(V, order, W) == GSL_SUCCESS;
	for (size_t i = 0; i < n * n && good; i++) {
		const gsl_complex z = gsl_matrix_complex_get(W, i / n, i % n);
		of->W_re[i] = GSL_REAL(z);
		of->W_im[i] = GSL_IMAG(z);
		good = isfinite(of->W_re[i]) && isfinite(of->W_im[i]);
	}
	gsl_permutation_free(order);
	gsl_matrix_complex_free(W);
	gsl_matrix_complex_free(V);
	return good;
}

/* Of an eigenvalue of the lower half plane that is nobody's: the conjugate of an upper one that no other took */
static bool conjugate_column(struct invariants *of, int j, bool *taken)
{
	const int n = of->n;
	int k = 0;
	while (k < n && (taken[k] || of->re[k] != of->re[j] || of->im[k] != -of->im[j]))
		k++;
	if (k == n)
		return false;
	taken[k] = true;
	for (int i = 0; i < n; i++) {
		of->V_re[i * n + j] = of->V_re[i * n + k];
		of->V_im[i * n + j] = -of->V_im[i * n + k];
	}
	return true;
}

static bool find_bases(struct invariants *of, int leading)
{
	SCRATCH bool *taken = ARRAY(bool, of->n);
	bool good = true;
	for (int i = 0; i < of->n; i++)
		taken[i] = of->im[i] >= 0;      /* not one of those that are nobody's */
	for (int p = 0; p < of->parts && good; p++) {
		const struct invariant *part = &of->part[p];
		for (int a = 0; a < part->members; a++)
			taken[of->member[part->first + a]] = part->real;
		if (part->members > 1)
			good = orthonormalize(of, part);
		else
			scale_to_largest(of, of->member[part->first], leading);
	}
	SCRATCH bool *nobody = ARRAY(bool, of->n);
	for (int i = 0; i < of->n; i++)
		nobody[i] = of->im[i] < 0 && !taken[i];
	for (int i = 0; i < of->n && good; i++)
		good = !nobody[i] || conjugate_column(of, i, taken);
	return good && complete_inverse(of);
}

/* Rows of W stay as they are, but for the scale of their columns. */
static void scale_symmetric(struct invariants *of, int leading)
{
	for (int j = 0; j < of->n; j++) {
		double was = 0, is = 0;
		for (int i = 0; i < of->n; i++)
			was += of->V_re[i * of->n + j] * of->W_re[j * of->n + i];
		scale_to_largest(of, j, leading);
		for (int i = 0; i < of->n; i++)
			is += of->V_re[i * of->n + j] * of->W_re[j * of->n + i];
		for (int i = 0; i < of->n; i++)
			of->W_re[j * of->n + i] *= was / is;
	}
}

static struct invariants *sorted(struct invariants *of, bool found, bool symmetric, int leading)
{
	of->leading = leading;
	if (found)
		find_parts(of, symmetric);
	if (found && symmetric)
		scale_symmetric(of, leading);
	else if (found)
		found = find_bases(of, leading);
	return found ? of : NULL;
}

struct invariants *invariants_of(int n, const mpq_t *A, int leading)
{
	gsl_error_handler_t *handler = gsl_set_error_handler_off();
	struct invariants *of = invariants_new(n, A);
	of = sorted(of, general_vectors(of), false, leading);
	gsl_set_error_handler(handler);
	return of;
}

struct invariants *invariants_symmetric(int n, const mpq_t *A, const mpq_t *M, const mpq_t *K)
{
	gsl_error_handler_t *handler = gsl_set_error_handler_off();
	struct invariants *of = invariants_new(n, A);
	of = sorted(of, symmetric_vectors(of, M, K), true, n);
	gsl_set_error_handler(handler);
	return of;
}

int invariants_count(const struct invariants *of)
{
	return of->parts;
}

const struct invariant *invariant_part(const struct invariants *of, int part)
{
	return &of->part[part];
}

/* Pairs of columns are real and imaginary part; of V x, and of rows W, where y = y1 - i y2. */
void invariant_start(const struct invariants *of, int part, double *X, double *Y)
{
	const struct invariant *p = &of->part[part];
	const int n = of->n, k = p->columns;
	for (int a = 0; a < p->members; a++)
		for (int i = 0, j = of->member[p->first + a]; i < n; i++) {
			const int at = p->real ? a : 2 * a;
			X[i * k + at] = of->scale[i] * of->V_re[i * n + j];
			Y[i * k + at] = of->W_re[j * n + i] / of->scale[i] * (p->real ? 1 : 2);
			if (p->real)
				continue;
			X[i * k + at + 1] = of->scale[i] * of->V_im[i * n + j];
			Y[i * k + at + 1] = -2 * of->W_im[j * n + i] / of->scale[i];
		}
}
