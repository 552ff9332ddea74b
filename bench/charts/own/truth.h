/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is true of any model: NAME_rhs in long double by extrapolation (gragg.h), from output to output. plgen's step
 * has no part in it. */
#ifndef TRUTH_H
#define TRUTH_H

#include "own.h"

INLINE void slope_long(quad t, const quad *y, quad *f)
{
#if INPUTS > 0
	const double *now = history.sample + (size_t)history.unit * INPUTS, *next = now + INPUTS;
	quad u[ROOM];
	for (int i = 0; i < INPUTS; i++) {
		const quad rise = history.ramp[i] ? ((quad)next[i] - now[i]) / history.every : 0;
		u[i] = now[i] + rise * (t - history.unit * (quad)history.every);
		u[INPUTS + i] = rise;
	}
	rhs_long(t, y, u, f);
#else
	rhs_long(t, y, f);
#endif
}

#define GRAGG_REAL quad
#define GRAGG_TYPE struct gragg
#define GRAGG_SLOPES(x, t, y, f) slope_long(t, y, f)
#include "../gragg.h"

/* rows: of all outputs. false: it did not come to the end */
static bool go_through(struct gragg *x, double *rows)
{
	const quad every = history.every;
	quad y[N];
	for (int i = 0; i < N; i++)
		y[i] = history.start[i];
	x->h = every / 8;
	x->least = 1e-15L * every;
	for (int k = 0; k < history.units; k++, rows += N) {
		history.unit = k;
		if (!walk_to(x, x, k * every, (k + 1) * every, y))
			return false;
		for (int i = 0; i < N; i++) {
			rows[i] = (double)y[i];
			if (!isfinite(rows[i]))
				return false;
		}
	}
	return true;
}

/* Roughly first, so that the scales are those of the whole history: near a start at rest nothing is known to 1e-16 of
 * itself */
static bool find_truth(struct gragg *x, double *rows)
{
	x->tolerance = 1e-6L;
	if (!go_through(x, rows))
		return false;
	x->tolerance = 1e-16L;
	return go_through(x, rows);
}

#endif
