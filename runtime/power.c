/* SPDX-License-Identifier: MIT-0 */
/* P^k x by binary powering in two-word arithmetic. */
#include "two.h"

static pl_two scaled(pl_two a, real power_of_2)
{
	const real hi = a.hi * power_of_2;
	return two(hi, is_finite(hi) ? a.lo * power_of_2 : 0);
}

/* sum of a_j b_j scale^2; a is a row, b a column whose entries lie `stride` apart. */
static pl_two dot(int n, const pl_two *a, const pl_two *b, int stride, real scale)
{
	pl_two sum = two(0, 0);
	int j;
	for (j = 0; j < n; j++) {
		sum = add(sum, multiply(scaled(a[j], scale), scaled(b[j * stride], scale)));
	}
	return sum;
}

/* The same, with overflow only where the sum overflows, and with its sign: large terms of both signs may have met. */
static pl_two dot_any(int n, const pl_two *a, const pl_two *b, int stride)
{
	pl_two sum = dot(n, a, b, stride, 1);
	if (!is_finite(sum.hi)) {
		sum = scaled(scaled(dot(n, a, b, stride, 1 / REAL_LARGE), REAL_LARGE), REAL_LARGE);
	}
	return sum;
}

void pl_power_apply(int n, pl_two *P, pl_two *W, pl_two *x, pl_two *w, uint64_t k)
{
	int i, j;
	while (k != 0) { /* powers of one matrix commute: from the lowest bit on is as good */
		if (k & 1) {
			for (i = 0; i < n; i++) {
				w[i] = dot_any(n, P + i * n, x, 1);
			}
			for (i = 0; i < n; i++) {
				x[i] = w[i];
			}
		}
		k >>= 1;
		if (k != 0) {
			pl_two *const square = W;
			for (i = 0; i < n; i++) {
				for (j = 0; j < n; j++) {
					square[i * n + j] = dot_any(n, P + i * n, P + j, n);
				}
			}
			W = P;
			P = square;
		}
	}
}
