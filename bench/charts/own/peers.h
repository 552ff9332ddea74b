/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Peers on any model that are not of the kept charts. Where a model has inputs, integrators stop at every output:
 * inputs have corners, or jumps, there. */
#ifndef PEERS_H
#define PEERS_H

#include <limits.h>

#include "own.h"

/* ---- RK4 ---- */

#define EXPLICIT_TYPE void
#define EXPLICIT_MOST N
#define EXPLICIT_SLOPES(of, t, y, f) slope(t, y, f)
#include "../explicit_step.h"

static bool rk4(double setting, double *rows)
{
	const int steps = (int)setting;
	const double h = history.every / steps;
	double y[N];
	memcpy(y, history.start, sizeof y);
	for (int k = 0; k < history.units; k++, rows += N) {
		const double from = k * history.every;
		history.unit = k;
		for (int j = 0; j < steps; j++)
			rk4_step(N, NULL, from + j * h, h, y);
		if (!own_finite(y))
			return false;
		memcpy(rows, y, sizeof y);
	}
	return true;
}

/* ---- e^{A h} of y' = A y + b, found once; applied by a loop whose length is known ---- */

static struct { double A[N + 1][N + 1], E[N + 1][N + 1]; bool made; } propagator;

/* Are the equations that?  A and b from rest and unit states; then they have to agree with what is asked at states of
 * the history's size, of either sign, at other times */
static bool is_affine(void)
{
	double y[N] = {0}, f[N], b[N];
	uint64_t seed = 1;
	history.evaluations = 0, history.most = LONG_MAX;
	slope(0.0, y, b);
	for (int j = 0; j < N; j++) {
		y[j] = 1.0;
		slope(0.0, y, f);
		y[j] = 0.0;
		for (int i = 0; i < N; i++)
			propagator.A[i][j] = f[i] - b[i];
	}
	for (int k = 1; k <= 40; k++) {
		for (int j = 0; j < N; j++) {
			seed = seed * 6364136223846793005u + 1442695040888963407u;
			y[j] = 2.0 * history.scale[j] * ((double)(seed >> 40) / 8388608.0 - 1.0);
		}
		slope(k / 41.0 * history.units * history.every, y, f);
		for (int i = 0; i < N; i++) {
			double sum = b[i], sizes = fabs(b[i]);
			for (int j = 0; j < N; j++) {
				sum += propagator.A[i][j] * y[j];
				sizes += fabs(propagator.A[i][j] * y[j]);
			}
			if (!(fabs(f[i] - sum) <= 1e-12 * sizes))
				return false;
		}
	}
	for (int i = 0; i < N; i++)
		propagator.A[i][N] = b[i];
	return INPUTS == 0;
}

/* What is timed is its use */
static void make_exponential(void)
{
	if (!propagator.made)
		rounded_exponential(N + 1, *propagator.A, history.every, *propagator.E);
	propagator.made = true;
}

static bool exponential_loop(double setting, double *rows)
{
	(void)setting;
	double E[N][N], add[N], y[N], next[N];
	make_exponential();
	for (int i = 0; i < N; i++) {
		memcpy(E[i], propagator.E[i], sizeof E[i]);
		add[i] = propagator.E[i][N];
	}
	memcpy(y, history.start, sizeof y);
	for (int k = 0; k < history.units; k++, rows += N) {
		for (int i = 0; i < N; i++) {
			double sum = add[i];
			for (int j = 0; j < N; j++)
				sum += E[i][j] * y[j];
			next[i] = sum;
		}
		memcpy(y, next, sizeof y);
		memcpy(rows, y, sizeof y);
	}
	return own_finite(y);
}

/* ---- the same as constants in code: made once, too ---- */

static void (*advance)(double *z, long units, double *rows);

static bool has_literals(void)
{
	void *code;
	if (!is_affine())
		return false;
	make_exponential();
	code = own_literals(N, *propagator.E);
	memcpy(&advance, &code, sizeof code);
	return advance;
}

static bool exponential_literals(double setting, double *rows)
{
	(void)setting;
	double z[N + 1];
	memcpy(z, history.start, sizeof history.start);
	z[N] = 1.0;
	advance(z, history.units, rows);
	return own_finite(z);
}

#endif
