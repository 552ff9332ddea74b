/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Extrapolation (Gragg, Bulirsch, Stoer; Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, II.9), and
 * a walk by such steps within a tolerance. Where forces have corners or jumps its steps shrink until what is lost there
 * is below the tolerance. Who includes it names GRAGG_REAL, the type of its numbers, and GRAGG_SLOPES(x, t, y, f), the
 * slopes f of what x, a GRAGG_TYPE, is about. */
#ifndef GRAGG_H
#define GRAGG_H

#include <math.h>
#include <stdbool.h>
#include <string.h>

enum { COLUMNS = 9, SLOPES_OF_STEP = COLUMNS * (COLUMNS + 1) + 1 };     /* of the extrapolation: order 18 */

struct gragg {
	int size;
	const bool *velocity;           /* which entries are: scale[1] is theirs */
	GRAGG_REAL tolerance, h, least; /* of a step, relative to the scales; the next step; the least: across a jump */
	GRAGG_REAL scale[2];            /* largest coordinate, velocity so far, or of the history */
	int parts;                      /* of a step in which an entry turns, where scales are looked at; 0: at ends */
	long evaluations, most;         /* of slopes; beyond `most` it has given up */
};

/* Gragg 1965: the modified midpoint rule with `parts` substeps; its error has even powers only. The last slope is asked
 * for, too: without it no column would see a kink in the last eighteenth of a step. */
static void midpoint(GRAGG_TYPE *x, int size, GRAGG_REAL t, GRAGG_REAL H, int parts, const GRAGG_REAL *y,
					 const GRAGG_REAL *slope, GRAGG_REAL *result)
{
	GRAGG_REAL before[size], now[size], f[size], h = H / parts;
	for (int i = 0; i < size; i++) {
		before[i] = y[i];
		now[i] = y[i] + h * slope[i];
	}
	for (int k = 1; k < parts; k++) {
		GRAGG_SLOPES(x, t + k * h, now, f);
		for (int i = 0; i < size; i++) {
			const GRAGG_REAL next = before[i] + 2 * h * f[i];
			before[i] = now[i];
			now[i] = next;
		}
	}
	GRAGG_SLOPES(x, t + H, now, f);
	for (int i = 0; i < size; i++)
		result[i] = (before[i] + now[i] + h * f[i]) / 2;
}

/* y(t + H) into `result`, and what one column fewer gives */
static void extrapolate(GRAGG_TYPE *x, int size, GRAGG_REAL t, GRAGG_REAL H, const GRAGG_REAL *y, GRAGG_REAL *result,
						GRAGG_REAL *fewer)
{
	GRAGG_REAL table[COLUMNS][size], slope[size];
	GRAGG_SLOPES(x, t, y, slope);
	for (int k = 0; k < COLUMNS; k++) {
		if (k > 0)
			memcpy(fewer, table[0], sizeof table[0]);
		midpoint(x, size, t, H, 2 * (k + 1), y, slope, table[k]);
		for (int m = k - 1; m >= 0; m--) {      /* Aitken, Neville */
			const GRAGG_REAL ratio = (GRAGG_REAL)(k + 1) / (m + 1), factor = 1 / (ratio * ratio - 1);
			for (int i = 0; i < size; i++)
				table[m][i] = table[m + 1][i] + (table[m + 1][i] - table[m][i]) * factor;
		}
	}
	memcpy(result, table[0], sizeof table[0]);
}

static GRAGG_REAL size_of(GRAGG_REAL a)
{
	return a < 0 ? -a : a;
}

static GRAGG_REAL larger_of(GRAGG_REAL a, GRAGG_REAL b)
{
	return a > b ? a : b;
}

/* One step to `end`; the size of its error over the tolerance. The error is that of one column fewer with the same
 * substeps: by Neville's rule COLUMNS^2 times less than the distance to that with fewer substeps, which rounding keeps
 * above some 1e3 units in the last place. */
static GRAGG_REAL error_of_step(GRAGG_TYPE *x, struct gragg *g, GRAGG_REAL t, GRAGG_REAL h, const GRAGG_REAL *y,
								GRAGG_REAL *end)
{
	GRAGG_REAL fewer[g->size], worst = 0;
	extrapolate(x, g->size, t, h, y, end, fewer);
	g->evaluations += SLOPES_OF_STEP;
	for (int i = 0; i < g->size; i++) {
		const GRAGG_REAL off = size_of(end[i] - fewer[i]) / (COLUMNS * COLUMNS);
		const GRAGG_REAL scale = larger_of(g->scale[g->velocity[i]], larger_of(size_of(y[i]), size_of(end[i])));
		if (!(off == 0))
			worst = larger_of(off / (g->tolerance * scale), worst);
		if (!(off >= 0))
			worst = (GRAGG_REAL)HUGE_VALL;
	}
	return worst;
}

static void keep_scales(struct gragg *g, const GRAGG_REAL *y)
{
	for (int i = 0; i < g->size; i++)
		g->scale[g->velocity[i]] = larger_of(g->scale[g->velocity[i]], size_of(y[i]));
}

/* The inside of a step in which an entry turns, where its largest value may be */
static void see_inside(GRAGG_TYPE *x, struct gragg *g, GRAGG_REAL t, GRAGG_REAL h, const GRAGG_REAL *y,
					   const GRAGG_REAL *end)
{
	GRAGG_REAL first[g->size], last[g->size];
	bool turns = false;
	if (g->parts == 0)
		return;
	GRAGG_SLOPES(x, t, y, first);
	GRAGG_SLOPES(x, t + h, end, last);
	for (int i = 0; i < g->size; i++)
		turns = turns || (first[i] < 0) != (last[i] < 0);
	for (int k = 1; k < g->parts && turns; k++) {
		extrapolate(x, g->size, t, h * k / g->parts, y, first, last);
		keep_scales(g, first);
	}
}

/* y at t into that at `to`; false: it has given up */
static bool walk_to(GRAGG_TYPE *x, struct gragg *g, GRAGG_REAL t, GRAGG_REAL to, GRAGG_REAL *y)
{
	GRAGG_REAL end[g->size];
	for (bool there = false; !there;) {
		const GRAGG_REAL h = (there = t + g->h * 1.0001L >= to) ? to - t : g->h;
		const GRAGG_REAL error = error_of_step(x, g, t, h, y, end);
		const GRAGG_REAL change = 0.9L * powl(1 / larger_of(error, 1e-9L), 1.0L / (2 * COLUMNS - 1));
		if (g->evaluations > g->most)
			return false;
		if (error > 1 && h > g->least) {
			there = false;
			g->h = larger_of(g->least, h * (change < 0.05L ? 0.05L : change > 0.5L ? 0.5L : change));
			continue;
		}
		see_inside(x, g, t, h, y, end);
		t += h;
		memcpy(y, end, sizeof end);
		keep_scales(g, y);
		const GRAGG_REAL next = h * (error > 1 || change > 4 ? 4 : change);     /* > 1: across a jump */
		g->h = there ? larger_of(g->h, next) : next;
	}
	return true;
}

#endif
