/* SPDX-License-Identifier: MIT-0 */
/* Linear equations with real and with complex matrices: elimination with partial pivoting. */
#include "real.h"

int pl_factor(int n, real *A, int *pivot)
{
	int i, j, k;
	for (k = 0; k < n; k++) {
		int best = k;
		real inverse;
		for (i = k + 1; i < n; i++) {
			if (pl_magnitude(A[i * n + k]) > pl_magnitude(A[best * n + k])) {
				best = i;
			}
		}
		pivot[k] = best;
		for (j = 0; best != k && j < n; j++) {
			const real kept = A[k * n + j];
			A[k * n + j] = A[best * n + j];
			A[best * n + j] = kept;
		}
		if (!(pl_magnitude(A[k * n + k]) > 0)) {
			return 0;
		}
		inverse = 1 / A[k * n + k];
		for (i = k + 1; i < n; i++) {
			const real factor = A[i * n + k] *= inverse;
			if (factor != 0) {
				for (j = k + 1; j < n; j++) {
					A[i * n + j] -= factor * A[k * n + j];
				}
			}
		}
		A[k * n + k] = inverse;
	}
	return 1;
}

void pl_solve(int n, const real *A, const int *pivot, real *x)
{
	int i, j;
	for (i = 0; i < n; i++) {
		const real kept = x[pivot[i]];
		x[pivot[i]] = x[i];
		x[i] = kept;
	}
	for (i = 0; i < n; i++) {
		for (j = 0; j < i; j++) {
			x[i] -= A[i * n + j] * x[j];
		}
	}
	for (i = n - 1; i >= 0; i--) {
		for (j = i + 1; j < n; j++) {
			x[i] -= A[i * n + j] * x[j];
		}
		x[i] *= A[i * n + i];
	}
}

/* a - b c, of real and imaginary parts */
static void subtract_product(real *a, const real *b, const real *c)
{
	a[0] -= b[0] * c[0] - b[1] * c[1];
	a[1] -= b[0] * c[1] + b[1] * c[0];
}

static void multiply_by(real *a, const real *b)
{
	const real re = a[0] * b[0] - a[1] * b[1];
	a[1] = a[0] * b[1] + a[1] * b[0];
	a[0] = re;
}

static real complex_size(const real *a)
{
	return pl_magnitude(a[0]) + pl_magnitude(a[1]);
}

/* 1/a, scaled so that no square leaves the range */
static void invert(real *a)
{
	const real size = complex_size(a), re = a[0] / size, im = a[1] / size, square = (re * re + im * im) * size;
	a[0] = re / square;
	a[1] = -im / square;
}

int pl_factor_complex(int n, real *A, int *pivot)
{
	int i, j, k;
	for (k = 0; k < n; k++) {
		real *const row = A + 2 * k * n;
		int best = k;
		for (i = k + 1; i < n; i++) {
			if (complex_size(A + 2 * (i * n + k)) > complex_size(A + 2 * (best * n + k))) {
				best = i;
			}
		}
		pivot[k] = best;
		for (j = 0; best != k && j < 2 * n; j++) {
			const real kept = row[j];
			row[j] = A[2 * best * n + j];
			A[2 * best * n + j] = kept;
		}
		if (!(complex_size(row + 2 * k) > 0)) {
			return 0;
		}
		invert(row + 2 * k);
		for (i = k + 1; i < n; i++) {
			real *const target = A + 2 * i * n;
			multiply_by(target + 2 * k, row + 2 * k);
			for (j = k + 1; j < n; j++) {
				subtract_product(target + 2 * j, target + 2 * k, row + 2 * j);
			}
		}
	}
	return 1;
}

void pl_solve_complex(int n, const real *A, const int *pivot, real *x)
{
	int i, j, part;
	for (i = 0; i < n; i++) {
		for (part = 0; part < 2; part++) {
			const real kept = x[2 * pivot[i] + part];
			x[2 * pivot[i] + part] = x[2 * i + part];
			x[2 * i + part] = kept;
		}
	}
	for (i = 0; i < n; i++) {
		for (j = 0; j < i; j++) {
			subtract_product(x + 2 * i, A + 2 * (i * n + j), x + 2 * j);
		}
	}
	for (i = n - 1; i >= 0; i--) {
		for (j = i + 1; j < n; j++) {
			subtract_product(x + 2 * i, A + 2 * (i * n + j), x + 2 * j);
		}
		multiply_by(x + 2 * i, A + 2 * (i * n + i));
	}
}
