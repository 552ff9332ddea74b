/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A step of extrapolation in long double (Gragg, Bulirsch, Stoer; Hairer, Norsett, Wanner, Solving Ordinary
 * Differential Equations I, II.9). Who includes it names GRAGG_SLOPES(x, t, y, f), the slopes f of what x, a
 * GRAGG_TYPE, is about. */
#ifndef GRAGG_H
#define GRAGG_H

#include <string.h>

enum { COLUMNS = 9 };               /* of the extrapolation: order 18 */

/* Gragg 1965: the modified midpoint rule with `parts` substeps; its error has even powers only. The last slope is asked
 * for, too: without it no column would see a kink in the last eighteenth of a step. */
static void midpoint(GRAGG_TYPE *x, int size, long double t, long double H, int parts, const long double *y,
					 const long double *slope, long double *result)
{
	long double before[size], now[size], f[size], h = H / parts;
	for (int i = 0; i < size; i++) {
		before[i] = y[i];
		now[i] = y[i] + h * slope[i];
	}
	for (int k = 1; k < parts; k++) {
		GRAGG_SLOPES(x, t + k * h, now, f);
		for (int i = 0; i < size; i++) {
			const long double next = before[i] + 2 * h * f[i];
			before[i] = now[i];
			now[i] = next;
		}
	}
	GRAGG_SLOPES(x, t + H, now, f);
	for (int i = 0; i < size; i++)
		result[i] = (before[i] + now[i] + h * f[i]) / 2;
}

/* y(t + H) into `result`, and what one column fewer gives */
static void extrapolate(GRAGG_TYPE *x, int size, long double t, long double H, const long double *y,
						long double *result, long double *fewer)
{
	long double table[COLUMNS][size], slope[size];
	GRAGG_SLOPES(x, t, y, slope);
	for (int k = 0; k < COLUMNS; k++) {
		if (k > 0)
			memcpy(fewer, table[0], sizeof table[0]);
		midpoint(x, size, t, H, 2 * (k + 1), y, slope, table[k]);
		for (int m = k - 1; m >= 0; m--) {      /* Aitken, Neville */
			const long double ratio = (long double)(k + 1) / (m + 1), factor = 1 / (ratio * ratio - 1);
			for (int i = 0; i < size; i++)
				table[m][i] = table[m + 1][i] + (table[m + 1][i] - table[m][i]) * factor;
		}
	}
	memcpy(result, table[0], sizeof table[0]);
}

#endif
