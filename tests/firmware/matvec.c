/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What plgen's steps are measured beside: y = Phi y as people write it.  It keeps no time. */
#include "variant.h"

/* Phi of scs with h = 0.01, rounded as usual */
static const real Phi[4][4] = {
	{(real)0.99002081, (real)0.00498335, (real)0.00996671, (real)0.00001663},
	{(real)0.00498335, (real)0.99002081, (real)0.00001663, (real)0.00996671},
	{(real)-1.99167842, (real)0.99334421, (real)0.99002081, (real)0.00498335},
	{(real)0.99334421, (real)-1.99167842, (real)0.00498335, (real)0.99002081}};

void OF_REAL(matvec)(void *s);

void OF_REAL(matvec)(void *s)
{
	real *const y = s, sum[4];
	int i, j;
	for (i = 0; i < 4; i++) {
		sum[i] = 0;
		for (j = 0; j < 4; j++)
			sum[i] += Phi[i][j] * y[j];
	}
	for (i = 0; i < 4; i++)
		y[i] = sum[i];
}
