/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Measured orders: the largest error of a run when the step is halved three times, against elliptic functions
 * (pendulum) or ARKODE's order 8 at 1e-13 on the equations by hand; and of values inside a step half a second on. */
#include "elliptic.h"
#include "orders_variants.h"
#include "systems.h"
#include "tap.h"
#include "truth.h"

#include <math.h>

enum { MOST_ROWS = 40, HALVINGS = 4 };      /* a row is half a second */

/* Below this an error is the solver's, or of rounding. */
static double floor_of(const pl_model *m, int rows)
{
	return 1e-12 + 1e-15 * rows * 0.5 / m->h;
}

static double truth[MOST_ROWS + 1][HAND_MOST];

static bool solve(const struct system *s, int rows)
{
	double scale[HAND_MOST], y[HAND_MOST];
	bool good = true;
	for (int i = 0; i < s->states; i++) {
		truth[0][i] = y[i] = (double)s->start[i];
		scale[i] = 1e-3;
	}
	struct truth *solver = truth_new(s->states, system_slopes, s, ARKODE_EXPLICIT, 1e-13, scale);
	for (int row = 1; row <= rows; row++) {
		if (strcmp(s->name, "pendulum") == 0)
			pendulum_swing((double)s->start[0], row / 2.0, y);
		else
			good = truth_advance(solver, (row - 1) / 2.0, row / 2.0, 0, NULL, y) && good;
		memcpy(truth[row], y, sizeof truth[row]);
	}
	truth_free(solver);
	return good;
}

static double error_of(const pl_model *m, int rows)
{
	const int every = (int)lround(0.5 / m->h);
	double y[HAND_MOST], worst = 0;
	void *state = calloc(1, m->size);
	m->init(state);
	for (int row = 1; row <= rows; row++) {
		m->run(state, (size_t)every, NULL, NULL);
		m->get(state, y);
		for (int i = 0; i < m->states; i++)
			worst = worse(worst, fabs(y[i] - truth[row][i]));
	}
	free(state);
	return worst;
}

static double error_inside(const struct system *s, const pl_model *m)
{
	double y[HAND_MOST], expected[HAND_MOST], scale[HAND_MOST], worst = 0;
	void *state = calloc(1, m->size);
	for (int i = 0; i < s->states; i++)
		scale[i] = 1e-3;
	struct truth *solver = truth_new(s->states, system_slopes, s, ARKODE_EXPLICIT, 1e-13, scale);
	memcpy(expected, truth[1], sizeof expected);
	if (!truth_advance(solver, 0.5, 0.5 + 0.375 * m->h, 0, NULL, expected))
		worst = INFINITY;
	truth_free(solver);
	m->init(state);
	m->set(state, 0.5, truth[1]);
	m->at(state, NULL, 0.375 * m->h, y);
	for (int i = 0; i < m->states; i++)
		worst = worse(worst, fabs(y[i] - expected[i]));
	free(state);
	return worst;
}

/* Of one step: its error falls at least by one order more than that of many steps, but at most by four; the first
 * halving may be too coarse to show it. */
static void judge_inside(const struct system *s, const char *scheme, int order)
{
	double error[HALVINGS];
	const double least = fmin(order + 1, 4) - 0.35;
	bool good = true;
	int measured = 0;
	for (int i = 0; i < HALVINGS; i++)
		error[i] = error_inside(s, variant_of(orders, "%s_%s_%d", s->name, scheme, i)->model);
	for (int i = 2; i < HALVINGS; i++) {
		if (!(error[i] >= 2e-13))
			continue;
		good = good && log2(error[i - 1] / error[i]) >= least;
		measured++;
	}
	ok(good && measured >= 1, "%s, %s: order %g inside a step (errors %.3g, %.3g, %.3g, %.3g)", s->name, scheme,
		least + 0.35, error[0], error[1], error[2], error[3]);
}

static void judge(const struct system *s, int rows, const char *scheme, int order)
{
	double error[HALVINGS];
	bool good = true;
	int measured = 0;
	for (int i = 0; i < HALVINGS; i++)
		error[i] = error_of(variant_of(orders, "%s_%s_%d", s->name, scheme, i)->model, rows);
	for (int i = 1; i < HALVINGS; i++) {
		if (error[i] < floor_of(variant_of(orders, "%s_%s_%d", s->name, scheme, i)->model, rows))
			continue;
		good = close_to(log2(error[i - 1] / error[i]), order, 0.1, "%s, %s: slope from %.3g to %.3g", s->name,
				scheme,
			error[i - 1], error[i]) && good;
		measured++;
	}
	ok(good && measured >= 2, "%s, %s: order %d (errors %.3g, %.3g, %.3g, %.3g)", s->name, scheme, order, error[0],
		error[1], error[2], error[3]);
}

int main(void)
{
	static const struct { const char *name; int seconds; } runs[] = {{"pendulum", 10}, {"vanderpol", 20},
		{"quad2dof", 10}, {"duffing", 5}};
	static const struct { const char *scheme; int order; } schemes[] = {
		{"etd1", 1}, {"etdrk2", 2}, {"etdrk4", 4}, {"nc2", 4}, {"nc3", 4}, {"dq4", 4}, {"bm3", 4}};
	for (size_t i = 0; i < sizeof runs / sizeof *runs; i++) {
		const struct system *s = system_of(runs[i].name);
		const int rows = 2 * runs[i].seconds;
		ok(solve(s, rows), "%s: a solution to compare with", s->name);
		for (size_t j = 0; j < sizeof schemes / sizeof *schemes; j++)
			judge(s, rows, schemes[j].scheme, schemes[j].order);
		for (size_t j = 0; j < sizeof schemes / sizeof *schemes; j++)
			judge_inside(s, schemes[j].scheme, schemes[j].order);
	}
	return tap_end();
}
