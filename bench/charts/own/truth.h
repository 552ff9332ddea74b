/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is true of any model: NAME_rhs in long double by extrapolation, from output to output. Where forces have corners
 * or jumps its steps shrink until what is lost there is below the tolerance. plgen's step has no part in it. */
#ifndef TRUTH_H
#define TRUTH_H

#include "own.h"

struct extrapolation {
	quad tolerance;
	quad scale[2];                  /* largest coordinate, velocity so far, or of the history */
	quad h;
	long evaluations, most;
	bool velocity[N];
};

INLINE void slope_long(struct extrapolation *x, quad t, const quad *y, quad *f)
{
	x->evaluations++;
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

#define GRAGG_TYPE struct extrapolation
#define GRAGG_SLOPES(x, t, y, f) slope_long(x, t, y, f)
#include "../gragg.h"

/* One step to `end`; the size of its error over the tolerance. The error is that of one column fewer with the same
 * substeps: by Neville's rule COLUMNS^2 times less than the distance to that with fewer substeps, which rounding keeps
 * above 1e-16. */
static quad error_of_step(struct extrapolation *x, quad t, quad h, const quad *y, quad *end)
{
	quad fewer[N], worst = 0;
	extrapolate(x, N, t, h, y, end, fewer);
	for (int i = 0; i < N; i++) {
		const quad off = fabsl(end[i] - fewer[i]) / (COLUMNS * COLUMNS);
		const quad scale = fmaxl(x->scale[x->velocity[i]], fmaxl(fabsl(y[i]), fabsl(end[i])));
		if (!(off == 0))
			worst = fmaxl(worst, off / (x->tolerance * scale));
		if (!(off >= 0))
			worst = HUGE_VALL;
	}
	return worst;
}

/* rows: of all outputs. false: it did not come to the end */
static bool go_through(struct extrapolation *x, double *rows)
{
	const quad every = history.every, least = 1e-15L * every;
	quad y[N], end[N];
	for (int i = 0; i < N; i++)
		y[i] = history.start[i];
	x->h = every / 8;
	for (int k = 0; k < history.units; k++, rows += N) {
		quad t = k * every;
		const quad to = (k + 1) * every;
		history.unit = k;
		for (bool there = false; !there;) {
			const quad h = (there = t + x->h * 1.0001L >= to) ? to - t : x->h;
			const quad error = error_of_step(x, t, h, y, end);
			const quad change = 0.9L * powl(1 / fmaxl(error, 1e-9L), 1.0L / (2 * COLUMNS - 1));
			if (x->evaluations > x->most)
				return false;
			if (error > 1 && h > least) {
				there = false;
				x->h = fmaxl(least, h * fminl(0.5L, fmaxl(0.05L, change)));
				continue;
			}
			t += h;
			memcpy(y, end, sizeof y);
			for (int i = 0; i < N; i++)
				x->scale[x->velocity[i]] = fmaxl(x->scale[x->velocity[i]], fabsl(y[i]));
			const quad next = h * (error > 1 ? 4 : fminl(4, change));       /* > 1: across a jump */
			x->h = there ? fmaxl(x->h, next) : next;
		}
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
static bool find_truth(struct extrapolation *x, double *rows)
{
	x->tolerance = 1e-6L;
	if (!go_through(x, rows))
		return false;
	x->tolerance = 1e-16L;
	return go_through(x, rows);
}

#endif
