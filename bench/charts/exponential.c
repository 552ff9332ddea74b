/* SPDX-License-Identifier: GPL-3.0-or-later */
/* e^{A h} without the error of scaling and squaring in double: Taylor's series of a 2^-k part, squared k times, in long
 * double, and rounded once. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "charts.h"

void rounded_exponential(int size, const double *generator, double length, double *result)
{
	enum { TERMS = 24 };
	const size_t entries = (size_t)size * (size_t)size;
	long double *block = calloc(3 * entries, sizeof *block), *part = block, *sum = block + entries,
		*product = block + 2 * entries;
	long double norm = 0;
	int halvings = 0;
	if (!block)
		return;
	for (int i = 0; i < size; i++) {
		long double row = 0;
		for (int j = 0; j < size; j++)
			row += fabsl((long double)generator[i * size + j] * length);
		norm = fmaxl(norm, row);
	}
	while (halvings < 60 && ldexpl(norm, -halvings) > 0.5L)
		halvings++;
	for (size_t i = 0; i < entries; i++)
		part[i] = ldexpl((long double)generator[i] * length, -halvings);
	for (int k = TERMS; k >= 0; k--) {              /* Horner's rule: sum <- I + part sum / k */
		for (int i = 0; i < size; i++)
			for (int j = 0; j < size; j++) {
				long double entry = 0;
				for (int m = 0; m < size && k < TERMS; m++)
					entry += part[i * size + m] * sum[m * size + j];
				product[i * size + j] = entry / (k + 1) + (i == j);
			}
		memcpy(sum, product, entries * sizeof *sum);
	}
	for (; halvings > 0; halvings--) {
		for (int i = 0; i < size; i++)
			for (int j = 0; j < size; j++) {
				product[i * size + j] = 0;
				for (int m = 0; m < size; m++)
					product[i * size + j] += sum[i * size + m] * sum[m * size + j];
			}
		memcpy(sum, product, entries * sizeof *sum);
	}
	for (size_t i = 0; i < entries; i++)
		result[i] = (double)sum[i];
	free(block);
}
