/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solvers of the kept charts, compiled for the model alone: a file that includes this says what an instance is made of,
 * then includes the solver's, and has `kept_history` to go through the history with it. */
#ifndef KEPT_H
#define KEPT_H

#include "own.h"

INLINE void model_slope(double t, const double *y, double *f)
{
	slope(t, y, f);
}

/* adaptive.h has its own function of this name */
#define slope adaptive_slope
#define ONE_MODEL
#include "../adaptive.h"
#define adaptive_open NULL

/* Inputs have corners at outputs, or jumps: it begins anew there with the length that it had, but ends a step at the
 * next one, where a step is better than what is read inside a longer one. length: h of its struct, or NULL; whole:
 * makes its state of the model's, which stands behind `skip` entries of it */
static inline bool kept_history(struct adaptive *a, const struct kind *kind, double setting, double *length,
								void (*whole)(const double *y, double *state), int skip,
								double *rows)
{
	const struct problem problem = {.name = "", .n = a->n, .unit = history.every, .start = history.start};
	const struct solver *solver = kind->solver;
	double state[2 * N], now[2 * N], none = history.every;
	a->run.method = &kind->method;
	a->run.problem = &problem;
	a->run.setting = setting;
	a->now = now;
	length = length ? length : &none;
	whole(history.start, state);
	history.unit = 0;
	bool good = solver->make(a) && solver->begin(a, 0.0, state);
	if (INPUTS == 0 && skip == 0 && a->walk)
		return good && a->walk(a, history.units, rows);
	for (int k = 0; k < history.units && good; k++, rows += N) {
		const double from = k * history.every, left = (k + 1) * history.every - from, last = *length;
		history.unit = k;
		if (INPUTS > 0 && k > 0) {
			good = solver->begin(a, from, state);
			*length = last;
		}
		if (INPUTS > 0)
			*length = left / ceil(left / *length);
		good = good && solver->reach(a, (k + 1) * history.every, state);
		memcpy(rows, state + skip, N * sizeof *rows);
	}
	if (solver->discard)
		solver->discard(a);
	return good && all_finite(a->size, state);
}

static inline void as_it_is(const double *y, double *state)
{
	memcpy(state, y, N * sizeof *y);
}

#endif
