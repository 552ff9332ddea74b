/* SPDX-License-Identifier: MIT-0 */
/* Exponential time differencing from crossing to crossing, beside the equations by hand, located in long double: the
 * order that is stated, by a line through errors at a geometric series of steps, and every crossing. TABLE=1:
 * figures. */
#include "etd_variants.h"
#include "followed.h"
#include "tap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 5 };

/* Of log(error) over log(h), by least squares */
static double slope_of(const double *h, const double *error)
{
	double x = 0, y = 0, xx = 0, xy = 0;
	for (int k = 0; k < STEPS; k++) {
		const double u = log(h[k]), v = log(error[k]);
		x += u / STEPS;
		y += v / STEPS;
		xx += u * u / STEPS;
		xy += u * v / STEPS;
	}
	return (xy - x * y) / (xx - x * x);
}

static void check_scheme(const struct switched_system *s, const struct truth *truth, const char *scheme, int order)
{
	double h[STEPS], error[STEPS], time = 0;
	bool counted = true;
	for (int k = 0; k < STEPS; k++) {
		char name[64];
		(void)snprintf(name, sizeof name, "%s_%s_%d", s->name, scheme, k);
		const struct variant *v = variant_in(etd_table, name);
		const struct found found = follow(v, s, truth);
		h[k] = v->model->h;
		error[k] = found.error;
		time = found.time;
		counted = counted && found.count == truth->count && found.status == 0;
		if (found.count != truth->count || found.status)
			note("%s: %d crossings, status %d", name, found.count, found.status);
	}
	const double measured = slope_of(h, error);
	if (!ok(fabs(measured - order) < 0.15, "%s, %s: order %d", s->name, scheme, order)) {
		note("measured %.3f, from errors", measured);
		for (int k = 0; k < STEPS; k++)
			note("    %.3g at h = %.5g", error[k], h[k]);
	}
	ok(counted, "%s, %s: %d crossings", s->name, scheme, truth->count);
	if (getenv("TABLE"))
		printf("| %s | %s | %.2f | %.2g | %.2g | %.2g | %d |\n", s->name, scheme, measured, error[0],
			   error[STEPS - 1], time, truth->count);
}

/* How far an expression is from its nearest breakpoint, but for its sign */
static double off_breakpoints(const struct switched_system *s, double t, const double *state)
{
	real y[HAND_MOST] = { 0 }, e[MOST_EXPRESSIONS];
	double least = 1;
	for (int i = 0; i < s->states; i++)
		y[i] = state[i];
	s->e(t, y, e);
	for (int i = 0; i < s->expressions; i++)
		for (int k = 0; k < s->breaks[i]; k++)
			least = fmin(least, (double)fabsl(fabsl(e[i]) - fabsl(s->at[i][k])));
	return least;
}

/* Where a step first crosses a breakpoint, as NAME_at has it, an expression is on one */
static void check_places(const struct switched_system *s, const char *name)
{
	const struct variant *v = variant_in(etd_table, name);
	const pl_model *m = v->model;
	pl_crossing crossing[MOST_EVENTS];
	double y[MOST_STATES], worst = 0;
	void *state = calloc(1, m->size), *before = calloc(1, m->size);
	m->init(state);
	for (int k = 0; k < lround(SECONDS / m->h); k++) {
		memcpy(before, state, m->size);
		m->step(state, NULL);
		if (v->crossings(state, crossing) == 0)
			continue;
		m->at(before, NULL, crossing[0].time, y);
		worst = worse(worst, off_breakpoints(s, k * m->h + crossing[0].time, y));
	}
	is_close(worst, 0, 1e-12, "%s: breakpoints at crossings", name);
	free(state);
	free(before);
}

int main(void)
{
	char name[64];
	for (int i = 0; i < switched_count; i++) {
		const struct switched_system *s = &switched_systems[i];
		const struct truth truth = truth_of(s);
		check_scheme(s, &truth, "etd1", 1);
		check_scheme(s, &truth, "etdrk2", 2);
		check_scheme(s, &truth, "etdrk4", 4);
		(void)snprintf(name, sizeof name, "%s_etdrk4_0", s->name);
		check_places(s, name);
	}
	return tap_end();
}
