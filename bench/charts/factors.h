/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Systems of linear equations for the implicit methods: Gauss elimination with partial pivoting, in place, of real
 * numbers or of others by ELIMINATION. Inlined into a method's own loop. */
#ifndef FACTORS_H
#define FACTORS_H

#include <math.h>
#include <stdbool.h>

#ifndef INLINE
#define INLINE static inline __attribute__((always_inline))
#endif

/* a: n x n, row-major: the matrix, then its factors L (diagonal of ones) and U, whose diagonal keeps reciprocals; row i
 * of L U is row row[i] of the matrix. A singular matrix gives infinite reciprocals, and with them a state that is not
 * finite. x must not be the right side. */
#define ELIMINATION(KIND, number, size_of) \
INLINE void factor_##KIND(const int n, number *a, int *row) \
{ \
	for (int i = 0; i < n; i++) \
		row[i] = i; \
	for (int k = 0; k < n; k++) { \
		int pivot = k; \
		for (int i = k + 1; i < n; i++) \
			if (size_of(a[i * n + k]) > size_of(a[pivot * n + k])) \
				pivot = i; \
		for (int j = 0; j < n && pivot != k; j++) { \
			const number entry = a[k * n + j]; \
			a[k * n + j] = a[pivot * n + j]; \
			a[pivot * n + j] = entry; \
		} \
		const int kept = row[k]; \
		row[k] = row[pivot]; \
		row[pivot] = kept; \
		a[k * n + k] = 1.0 / a[k * n + k]; \
		for (int i = k + 1; i < n; i++) { \
			const number multiple = a[i * n + k] *= a[k * n + k]; \
			for (int j = k + 1; j < n; j++) \
				a[i * n + j] -= multiple * a[k * n + j]; \
		} \
	} \
} \
INLINE void solve_##KIND(const int n, const number *restrict a, const int *row, const number *restrict right, \
						 number *restrict x) \
{ \
	_Pragma("GCC unroll 4") for (int i = 0; i < n; i++) { \
		number sum = right[n == 1 ? 0 : row[i]]; \
		for (int j = 0; j < i; j++) \
			sum -= a[i * n + j] * x[j]; \
		x[i] = sum; \
	} \
	_Pragma("GCC unroll 4") for (int i = n - 1; i >= 0; i--) { \
		number sum = x[i]; \
		for (int j = i + 1; j < n; j++) \
			sum -= a[i * n + j] * x[j]; \
		x[i] = sum * a[i * n + i]; \
	} \
}
ELIMINATION(real, double, fabs)

struct factors {
	int size;
	double *matrix;             /* then its factors */
	int *row;
	bool stale;                 /* Newton: to be made anew */
};

static inline void factor(struct factors *s)
{
	factor_real(s->size, s->matrix, s->row);
}

INLINE void solve(const struct factors *s, const double *restrict right, double *restrict x)
{
	solve_real(s->size, s->matrix, s->row, right, x);
}

#endif
