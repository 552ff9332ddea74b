/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "gragg.h"

#include <math.h>
#include <string.h>

enum { COLUMNS = 10 };              /* order 20 */

struct problem {
	equations *f;
	int n, inputs;
	real begun;
	const real *u;
};

static void slope(const struct problem *p, real t, const real *y, real *dydt)
{
	real u[HAND_MOST];
	for (int i = 0; i < p->inputs; i++) {
		u[p->inputs + i] = p->u[p->inputs + i];
		u[i] = p->u[i] + (t - p->begun) * u[p->inputs + i];
	}
	p->f(t, y, u, dydt);
}

/* 2 * `half` midpoint steps, smoothed at the end: the error has even powers of the step alone */
static void midpoints(const struct problem *p, real t, real size, int half, const real *y, real *end)
{
	const real h = size / (2 * half);
	real before[HAND_MOST], now[HAND_MOST], d[HAND_MOST];
	memcpy(before, y, sizeof before);
	slope(p, t, y, d);
	for (int i = 0; i < p->n; i++)
		now[i] = y[i] + h * d[i];
	for (int k = 1; k < 2 * half; k++) {
		slope(p, t + k * h, now, d);
		for (int i = 0; i < p->n; i++) {
			const real next = before[i] + 2 * h * d[i];
			before[i] = now[i];
			now[i] = next;
		}
	}
	slope(p, t + size, now, d);
	for (int i = 0; i < p->n; i++)
		end[i] = (now[i] + before[i] + h * d[i]) / 2;
}

static void one_piece(const struct problem *p, real t, real size, real *y)
{
	real table[COLUMNS][HAND_MOST];
	for (int j = 0; j < COLUMNS; j++) {
		midpoints(p, t, size, j + 1, y, table[j]);
		for (int k = j - 1; k >= 0; k--) {          /* Aitken and Neville in 1/n^2 */
			const real ratio = (real)(j + 1) / (k + 1), factor = 1 / (ratio * ratio - 1);
			for (int i = 0; i < p->n; i++)
				table[k][i] = table[k + 1][i] + (table[k + 1][i] - table[k][i]) * factor;
		}
	}
	memcpy(y, table[0], sizeof(real) * (size_t)p->n);
}

void gragg(equations *f, int n, real from, real to, real piece, int inputs, const real *u, real *y)
{
	const struct problem p = { .f = f, .n = n, .inputs = inputs, .begun = from, .u = u };
	const int pieces = (int)ceill((to - from) / piece);
	real padded[HAND_MOST] = { 0 };
	memcpy(padded, y, sizeof(real) * (size_t)n);
	for (int k = 0; k < pieces; k++)
		one_piece(&p, from + (to - from) * k / pieces, (to - from) / pieces, padded);
	memcpy(y, padded, sizeof(real) * (size_t)n);
}
