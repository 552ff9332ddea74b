/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Balanced truncation: of all states those that the load moves much and the output sees much. Moore, IEEE Transactions
 * on Automatic Control 26 (1981) 17; by the square roots of both Gramians: Laub, Heath, Paige, Ward, ibid. 32 (1987)
 * 115. */
#include "eigen.h"
#include "factors.h"
#include "less.h"

#include <gsl/gsl_blas.h>
#include <gsl/gsl_linalg.h>

ELIMINATION(complex, double complex, cabs)

/* W = R R^T */
static void root_of(gsl_matrix *W, gsl_matrix *R)
{
	const size_t n = W->size1;
	gsl_vector *values = gsl_vector_alloc(n);
	gsl_eigen_symmv_workspace *work = gsl_eigen_symmv_alloc(n);
	gsl_eigen_symmv(W, values, R, work);
	for (size_t j = 0; j < n; j++) {
		gsl_vector_view column = gsl_matrix_column(R, j);
		gsl_vector_scale(&column.vector, sqrt(fmax(gsl_vector_get(values, j), 0)));
	}
	gsl_eigen_symmv_free(work);
	gsl_vector_free(values);
}

/* A mode in coordinates z of its poles: q = z + z*, z' = p z + beta u; x = (w q, v) = T z */
struct pair { double complex p[2], beta[2], T[2][2], inverse[2][2]; };

static struct pair pair_of(const struct modal *m, int mode)
{
	const double w = m->w[mode];
	const double complex p = w * (-m->zeta + I * sqrt(1 - m->zeta * m->zeta)), q = conj(p), det = w * (q - p);
	const double complex beta = m->b[mode] / (p - q);
	return (struct pair){.p = {p, q}, .beta = {beta, -beta}, .T = {{w, w}, {p, q}},
	                     .inverse = {{q / det, -w / det}, {-p / det, w / det}}};
}

/* In z the Gramians are W_ij = -b_i b_j* /(p_i + p_j*), of the output W_ij = -c_i* c_j/(p_i* + p_j); here of entry r of
 * x of one mode and c of another */
static double control_of(const struct pair *one, const struct pair *other, int r, int c)
{
	double complex sum = 0;
	for (int a = 0; a < 2; a++)
		for (int b = 0; b < 2; b++)
			sum -= one->T[r][a] * conj(other->T[c][b]) * one->beta[a] * conj(other->beta[b]) /
			       (one->p[a] + conj(other->p[b]));
	return creal(sum);
}

static double observe_of(const struct pair *one, const struct pair *other, int r, int c)
{
	double complex sum = 0;
	for (int a = 0; a < 2; a++)
		for (int b = 0; b < 2; b++)
			sum -= conj(one->inverse[a][r]) * other->inverse[b][c] / (conj(one->p[a]) + other->p[b]);
	return creal(sum);
}

static void gramians(const struct modal *m, gsl_matrix *control, gsl_matrix *observe)
{
	for (int i = 0; i < 2 * m->modes; i++)
		for (int j = 0; j < 2 * m->modes; j++) {
			const struct pair one = pair_of(m, i / 2), other = pair_of(m, j / 2);
			gsl_matrix_set(control, (size_t)i, (size_t)j, control_of(&one, &other, i % 2, j % 2));
			gsl_matrix_set(observe, (size_t)i, (size_t)j,
			               m->c[i / 2] * m->c[j / 2] * observe_of(&one, &other, i % 2, j % 2));
		}
}

/* x' = A x + b u of each mode, times a column of R or L */
static void times_A(const struct modal *m, const double *x, size_t stride, double *Ax)
{
	for (int i = 0; i < m->modes; i++) {
		const double w = m->w[i], wq = x[2 * (size_t)i * stride], v = x[(2 * (size_t)i + 1) * stride];
		Ax[2 * i] = w * v;
		Ax[2 * i + 1] = -w * wq - 2 * m->zeta * w * v;
	}
}

/* The reduced matrix's poles and what each gives to the output; A is used up */
static void decouple(int r, double *A, const double *b, const double *c, struct poles *out)
{
	double complex p[r], V[r * r], LU[r * r], right[r], share[r];
	int row[r];
	eigenvectors(r, A, p, V);
	memcpy(LU, V, sizeof LU);
	for (int i = 0; i < r; i++)
		right[i] = b[i];
	factor_complex(r, LU, row);
	solve_complex(r, LU, row, right, share);
	out->count = 0;
	for (int j = 0; j < r; j++) {
		double complex sum = 0;
		for (int i = 0; i < r; i++)
			sum += c[i] * V[i * r + j];
		if (cimag(p[j]) < 0)
			continue;
		out->p[out->count] = p[j];
		out->c[out->count++] = sum * share[j];
	}
}

/* With R R^T and L L^T the Gramians and L^T R = U S V^T, by the columns of R V S^-1/2 and L U S^-1/2 */
void balance(const struct modal *m, int r, struct poles *out)
{
	const size_t n = 2 * (size_t)m->modes;
	gsl_matrix *Wc = gsl_matrix_alloc(n, n), *Wo = gsl_matrix_alloc(n, n), *R = gsl_matrix_alloc(n, n),
		*L = gsl_matrix_alloc(n, n), *U = gsl_matrix_alloc(n, n), *V = gsl_matrix_alloc(n, n),
		*right = gsl_matrix_alloc(n, n), *left = gsl_matrix_alloc(n, n);
	gsl_vector *S = gsl_vector_alloc(n), *work = gsl_vector_alloc(n);
	double A[r * r], b[r], c[r], Ax[n];
	gramians(m, Wc, Wo);
	root_of(Wc, R);
	root_of(Wo, L);
	gsl_blas_dgemm(CblasTrans, CblasNoTrans, 1, L, R, 0, U);
	gsl_linalg_SV_decomp(U, V, S, work);
	gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, R, V, 0, right);
	gsl_blas_dgemm(CblasNoTrans, CblasNoTrans, 1, L, U, 0, left);
	for (int j = 0; j < r; j++) {
		times_A(m, right->data + j, n, Ax);
		b[j] = c[j] = 0;
		for (int i = 0; i < r; i++) {
			double sum = 0;
			for (size_t k = 0; k < n; k++)
				sum += gsl_matrix_get(left, k, (size_t)i) * Ax[k];
			A[i * r + j] = sum / sqrt(gsl_vector_get(S, (size_t)i) * gsl_vector_get(S, (size_t)j));
		}
		for (int k = 0; k < m->modes; k++) {
			const double scale = 1 / sqrt(gsl_vector_get(S, (size_t)j));
			b[j] += gsl_matrix_get(left, 2 * (size_t)k + 1, (size_t)j) * m->b[k] * scale;
			c[j] += gsl_matrix_get(right, 2 * (size_t)k, (size_t)j) * m->c[k] / m->w[k] * scale;
		}
	}
	decouple(r, A, b, c, out);
	gsl_vector_free(work);
	gsl_vector_free(S);
	gsl_matrix *all[] = {Wc, Wo, R, L, U, V, right, left};
	for (int i = 0; i < 8; i++)
		gsl_matrix_free(all[i]);
}
