/* SPDX-License-Identifier: GPL-3.0-or-later */
/* e^{A tau} in the type EXPONENTIAL_REAL, which who includes it names: Taylor's series of a 2^-k part, by Horner's
 * rule, squared k times. A, E: n x n, row-major. */
#include <stdlib.h>
#include <string.h>

/* E <- I + X Y/divisor, or X Y where that is 0; product: room for it */
static void exponential_product(int n, const EXPONENTIAL_REAL *X, int divisor, EXPONENTIAL_REAL *E,
								const EXPONENTIAL_REAL *Y, EXPONENTIAL_REAL *product)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			EXPONENTIAL_REAL sum = 0;
			for (int m = 0; m < n; m++)
				sum += X[i * n + m] * Y[m * n + j];
			product[i * n + j] = divisor ? sum / divisor + (i == j) : sum;
		}
	memcpy(E, product, (size_t)(n * n) * sizeof *E);
}

static void taylor_exponential(int n, const EXPONENTIAL_REAL *A, EXPONENTIAL_REAL tau, EXPONENTIAL_REAL *E)
{
	enum { TERMS = 36, MOST_HALVINGS = 100 };
	const size_t entries = (size_t)(n * n);
	EXPONENTIAL_REAL *part = calloc(2 * entries + 1, sizeof *part), *product = part + entries, norm = 0;
	int halvings = 0;
	if (!part)
		abort();
	for (int i = 0; i < n; i++) {
		EXPONENTIAL_REAL row = 0;
		for (int j = 0; j < n; j++) {
			part[i * n + j] = A[i * n + j] * tau;
			row += part[i * n + j] < 0 ? -part[i * n + j] : part[i * n + j];
		}
		norm = row > norm ? row : norm;
	}
	for (; norm > 0.5 && halvings < MOST_HALVINGS; norm /= 2, halvings++)
		for (size_t i = 0; i < entries; i++)
			part[i] /= 2;
	for (size_t i = 0; i < entries; i++)
		E[i] = i % (size_t)(n + 1) == 0;
	for (int k = TERMS; k > 0; k--)
		exponential_product(n, part, k, E, E, product);
	for (; halvings > 0; halvings--)
		exponential_product(n, E, 0, E, E, product);
	free(part);
}
