/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a subject's steps are held against: CVODE on NAME_rhs, through impacts and changes of its loads; and NAME_rhs
 * against the spec's second writing. */
#include "driving.h"
#include "truth.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- the truth ---- */

static void slopes_of(const void *nothing, double t, const double *y, const double *u, double *dydt)
{
	(void)nothing;
	of->slopes(t, y, u, dydt);
}

/* Where positions are large, what is between them is as small beside them as it must be known better. Behind a force
 * that jumps a step by 1e-10 was 2e-6 off: its estimate is of a derivative that is not there. */
struct truth *new_truth(void)
{
	const bool closer = size > 1e3 || is(of->class, "piecewise") || is(of->class, "kinked");
	double scale[MOST];
	for (int i = 0; i < of->whole->states; i++)
		scale[i] = 1;
	return truth_new(of->whole->states, slopes_of, NULL, CVODE_ADAMS, closer ? 1e-13 : 1e-10, scale);
}

static bool fly_anew(double from, double to, const double *u, double *y)
{
	struct truth *const solver = new_truth();
	const bool good = to <= from || truth_advance(solver, from, to, of->whole->inputs, u, y);
	truth_free(solver);
	return good;
}

int place_of(const char *name)
{
	int i = 0;
	while (i < of->whole->states - 1 && !is(of->whole->state_names[i], name))
		i++;
	return i;
}

/* From impact to impact, in parts of which none holds two */
static bool fly(struct truth *solver, double from, double to, const double *u, double *y)
{
	char *end;
	const double gap = strtod(of->impact, &end), restitution = strtod(end, NULL);
	const int x = place_of("b"), v = place_of("b'");
	if (!*of->impact)
		return truth_advance(solver, from, to, of->whole->inputs, u, y);
	for (int part = 0; part < 8; part++) {
		const double start = from + part * (to - from) / 8, stop = part == 7 ? to : start + (to - from) / 8;
		double moved[2 * MOST] = {0}, before[MOST], low = start, high = stop;
		const int all = of->whole->inputs;
		memcpy(before, y, sizeof before);
		for (int i = 0; i < 2 * all; i++)
			moved[i] = u[i] + (i < all ? (start - from) * u[all + i] : 0);
		if (!fly_anew(start, stop, moved, y))
			return false;
		if (!(before[x] < gap && y[x] >= gap))
			continue;
		while (high - low > 1e-13) {
			const double middle = low + (high - low) / 2;
			memcpy(y, before, sizeof before);
			if (!fly_anew(start, middle, moved, y))
				return false;
			*(y[x] >= gap ? &high : &low) = middle;
			if (middle - start < 1e-13 || stop - middle < 1e-13)
				break;
		}
		y[x] = nextafter(gap, -1);
		y[v] *= -restitution;
		for (int i = 0; i < all; i++)
			moved[i] += (low - start) * moved[all + i];
		if (!fly_anew(low, stop, moved, y))
			return false;
	}
	return true;
}

/* Over a step, with a stop where a load changes, behind which the truth starts anew: past slopes would be of another
 * formula. A change at the step's start, but for rounding, has been; of one at its end the step has none. */
bool advance(struct truth *solver, double from, double to, const double *u, double *y)
{
	const char *p = of->changes;
	double now = from, moved[2 * MOST];
	memcpy(moved, u, sizeof *u * 2 * (size_t)of->whole->inputs);
	for (;;) {
		double next = to;
		bool changes = false;
		const char *list = p;
		char *end;
		for (double change = strtod(list, &end); end != list; list = end, change = strtod(list, &end))
			if (change > now && change <= now + 1e-14)
				now = change;           /* the first slope is already that of the next formula */
			else if (change > now + 1e-14 && change < next + 1e-14)
				next = fmin(change, to), changes = true;
		for (int i = 0; i < of->whole->inputs; i++)
			moved[i] = u[i] + (now - from) * u[of->whole->inputs + i];
		if (!fly(solver, now, changes ? nextafter(next, 0) : to, moved, y))
			return false;
		if (next > to - 1e-14)
			return true;
		now = next;
	}
}

/* The model's states of the whole one's, where all are there; or a model with fewer says only its outputs. */
bool whole(void)
{
	bool all = of->whole->states == states;
	for (int i = 0; i < states && all; i++)
		all = is(state_name(i), of->whole->state_names[i]);
	return all;
}

/* ---- the spec's second writing ---- */

/* Highest derivatives, by elimination: the residual is linear in them. */
bool highest(double t, const double *y, const double *u, double *top)
{
	const int n = of->coords[0];
	double M[MOST][MOST], r0[MOST], r[MOST];
	memset(top, 0, sizeof *top * (size_t)n);
	of->residual(t, y, u, top, r0);
	for (int j = 0; j < n; j++) {
		top[j] = 1;
		of->residual(t, y, u, top, r);
		top[j] = 0;
		for (int i = 0; i < n; i++)
			M[i][j] = r[i] - r0[i];
	}
	for (int j = 0; j < n; j++) {
		int p = j;
		for (int i = j; i < n; i++)
			if (fabs(M[i][j]) > fabs(M[p][j]))
				p = i;
		if (M[p][j] == 0)
			return false;
		for (int k = 0; k < n; k++) {
			const double swap = M[p][k];
			M[p][k] = M[j][k];
			M[j][k] = swap;
		}
		const double swap = r0[p];
		r0[p] = r0[j];
		r0[j] = swap;
		for (int i = j + 1; i < n; i++) {
			const double f = M[i][j] / M[j][j];
			for (int k = j; k < n; k++)
				M[i][k] -= f * M[j][k];
			r0[i] -= f * r0[j];
		}
	}
	for (int j = n - 1; j >= 0; j--) {
		top[j] = -r0[j];
		for (int k = j + 1; k < n; k++)
			top[j] -= M[j][k] * top[k];
		top[j] /= M[j][j];
	}
	return true;
}

bool at_a_change(double t)
{
	char *end;
	const char *p = of->changes;
	for (double change = strtod(p, &end); end != p; p = end, change = strtod(p, &end))
		if (fabs(t - change) < 1e-6)
			return true;
	return false;
}

void judge_rhs(void)
{
	unsigned seed = 1;
	if (!of->residual || !of->slopes)
		return;
	for (int point = 0; point < 40; point++) {
		double y[MOST], u[2 * MOST], top[MOST], found[MOST], largest = 1;
		for (int i = 0; i < of->whole->states; i++)
			seed = seed * 1103515245u + 12345u, y[i] = (double)(seed >> 8) / 8388608 - 1;
		for (int i = 0; i < 2 * inputs; i++)
			seed = seed * 1103515245u + 12345u, u[i] = i < inputs || ramps[i - inputs] ?
				(double)(seed >> 8) / 8388608 - 1 : 0;
		seed = seed * 1103515245u + 12345u;
		const double t = (double)(seed >> 8) / 33554432;
		if (at_a_change(t))
			continue;
		if (!highest(t, y, u, top)) {
			complain("the second writing has a singular mass matrix");
			return;
		}
		of->slopes(t, y, u, found);
		for (int i = 0; i < of->whole->states; i++)
			largest = fmax(largest, fabs(found[i]));
		for (int i = 0, velocity = of->coords[0]; i < of->coords[0]; i++)
		    near(found[of->coords[i + 1] == 2 ? velocity++ : i], top[i], 1e-10 * largest,
			 "rhs against the second writing", t, of->whole->state_names[i]);
	}
}
