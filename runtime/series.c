/* SPDX-License-Identifier: MIT-0 */
/* x(tau) from x' = A x by Taylor's series on equal parts of tau. */
#include "real.h"

/* x + dt A (x + dt/2 A (x + dt/3 A (...))): small terms are summed first, and each correction is small against x when
 * the generator keeps |pole| dt below 1.  y, w: n reals each. */
static void advance_part(const pl_series *p, real dt, real *x, real *w, real *y)
{
	const int n = p->size;
	int i, j, k;

	for (i = 0; i < n; i++) {
		w[i] = x[i];
	}
	for (k = p->degree; k > 0; k--) {
		const real *row = p->A;
		const real factor = dt / (real)k;
		for (i = 0; i < n; i++, row += n) {
			y[i] = 0;
			for (j = 0; j < n; j++) {
				y[i] += row[j] * w[j];
			}
		}
		for (i = 0; i < n; i++) {
			w[i] = x[i] + factor * y[i];
		}
	}
	for (i = 0; i < n; i++) {
		x[i] = w[i];
	}
}

void pl_series_advance(const pl_series *p, real tau, real *x, real *work)
{
	const uint32_t parts = (uint32_t)1 << p->halvings;
	const real dt = tau / (real)parts;
	uint32_t i;
	for (i = 0; i < parts; i++) {
		advance_part(p, dt, x, work, work + p->size);
	}
}
