/* SPDX-License-Identifier: GPL-3.0-or-later */
/* e^{A h} without the error of scaling and squaring in double: in long double, and rounded once. */
#include "charts.h"

#define EXPONENTIAL_REAL long double
#include "taylor_exponential.h"

void rounded_exponential(int size, const double *generator, double length, double *result)
{
	const int entries = size * size;
	long double *A = room_for(2 * (size_t)entries, sizeof *A), *E = A + entries;
	for (int i = 0; i < entries; i++)
		A[i] = generator[i];
	taylor_exponential(size, A, length, E);
	for (int i = 0; i < entries; i++)
		result[i] = (double)E[i];
	free(A);
}
