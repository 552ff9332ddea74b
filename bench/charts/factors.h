/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Systems of linear equations for the implicit methods: Gauss elimination with partial pivoting, in place. In a header,
 * so that a method's loop has its solution inlined. */
#ifndef FACTORS_H
#define FACTORS_H

#include <math.h>
#include <stdbool.h>

#define INLINE static inline __attribute__((always_inline))

struct factors {
	int size;
	/* size x size, row-major: the matrix, then its factors L (diagonal of ones) and U */
	double *matrix;
	double *reciprocal;         /* 1 / U_ii */
	int *row;                   /* row i of L U is row row[i] of the matrix */
	bool stale;                 /* Newton: to be made anew */
};

static inline void swap_rows(struct factors *s, int i, int j)
{
	int row = s->row[i];
	s->row[i] = s->row[j];
	s->row[j] = row;
	for (int k = 0; k < s->size; k++) {
		double entry = s->matrix[i * s->size + k];
		s->matrix[i * s->size + k] = s->matrix[j * s->size + k];
		s->matrix[j * s->size + k] = entry;
	}
}

/* A singular matrix gives infinite reciprocals, and with them a state that is not finite */
static inline void factor(struct factors *s)
{
	int m = s->size;
	double *a = s->matrix;
	for (int i = 0; i < m; i++)
		s->row[i] = i;
	for (int k = 0; k < m; k++) {
		int pivot = k;
		for (int i = k + 1; i < m; i++)
			if (fabs(a[i * m + k]) > fabs(a[pivot * m + k]))
				pivot = i;
		if (pivot != k)
			swap_rows(s, k, pivot);
		s->reciprocal[k] = 1.0 / a[k * m + k];
		for (int i = k + 1; i < m; i++) {
			double multiple = a[i * m + k] *= s->reciprocal[k];
			for (int j = k + 1; j < m; j++)
				a[i * m + j] -= multiple * a[k * m + j];
		}
	}
}

INLINE void solve(const struct factors *s, const double *restrict right, double *restrict x)
{
	const int m = s->size;
	const double *restrict a = s->matrix;
	for (int i = 0; i < m; i++) {
		double sum = right[s->row[i]];
		for (int j = 0; j < i; j++)
			sum -= a[i * m + j] * x[j];
		x[i] = sum;
	}
	for (int i = m - 1; i >= 0; i--) {
		double sum = x[i];
		for (int j = i + 1; j < m; j++)
			sum -= a[i * m + j] * x[j];
		x[i] = sum * s->reciprocal[i];
	}
}

#endif
