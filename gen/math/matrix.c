/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rational matrices. */
#include "math/math.h"

/* Gauss and Jordan on [A | I]. */
bool rational_inverse(int n, const mpq_t *A, mpq_t *inverse, int *column)
{
	int width = 2 * n;
	mpq_t *W = rationals((size_t)(n * width)), pivot;
	mpq_init(pivot);
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			mpq_set(W[i * width + j], A[i * n + j]);
		mpq_set_ui(W[i * width + n + i], 1, 1);
	}
	for (int k = 0; k < n; k++) {
		int row = k;
		while (row < n && mpq_sgn(W[row * width + k]) == 0)
			row++;
		if (row == n) {
			*column = k;
			mpq_clear(pivot);
			rationals_free(W, (size_t)(n * width));
			return false;
		}
		for (int j = 0; j < width; j++)
			mpq_swap(W[row * width + j], W[k * width + j]);
		mpq_inv(pivot, W[k * width + k]);
		for (int j = 0; j < width; j++)
			mpq_mul(W[k * width + j], W[k * width + j], pivot);
		for (int i = 0; i < n; i++) {
			mpq_set(pivot, W[i * width + k]);
			if (i != k && mpq_sgn(pivot) != 0)
				rational_subtract_row(width, W + i * width, (const mpq_t *)W + k * width, pivot);
		}
	}
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			mpq_set(inverse[i * n + j], W[i * width + n + j]);
	mpq_clear(pivot);
	rationals_free(W, (size_t)(n * width));
	return true;
}

void rational_subtract_row(int n, mpq_t *target, const mpq_t *row, mpq_srcptr factor)
{
	mpq_t product;
	mpq_init(product);
	for (int j = 0; j < n; j++) {
		if (mpq_sgn(row[j]) == 0)
			continue;
		mpq_mul(product, row[j], factor);
		mpq_sub(target[j], target[j], product);
	}
	mpq_clear(product);
}

void rational_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB)
{
	mpq_t product;
	mpq_init(product);
	for (int i = 0; i < rows * columns; i++)
		mpq_set_ui(AB[i], 0, 1);
	for (int i = 0; i < rows; i++)
		for (int k = 0; k < inner; k++)         /* by rows: most factors of large matrices are 0 */
			for (int j = 0; j < columns && mpq_sgn(A[i * inner + k]) != 0; j++) {
				if (mpq_sgn(B[k * columns + j]) == 0)
					continue;
				mpq_mul(product, A[i * inner + k], B[k * columns + j]);
				mpq_add(AB[i * columns + j], AB[i * columns + j], product);
			}
	mpq_clear(product);
}
