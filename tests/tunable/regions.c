/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model with regions, or contacts beside a series, whose tunable params take other values, beside the model with
 * these values written; and what it refuses. VALUES, INPUTS, PARAMS, bad[]: from regions.sh */
#include "retuned.h"
#include "plain.h"
#include "refused.h"
#include "tap.h"
#include "worse.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>
#include <string.h>

#ifdef REAL_FLOAT
enum { STEPS = 300, HALF = STEPS / 2 };
typedef float real;
typedef pl_crossingf crossing;
#define MODEL pl_modelf
static const double tolerance = 3e-2, late = 3e-3;
#else
enum { STEPS = 1500, HALF = STEPS / 2 };
typedef double real;
typedef pl_crossing crossing;
#define MODEL pl_model
static const double tolerance = 1e-9, late = 1e-9; /* contacts multiply what rounding did */
#endif

static const real values[RETUNED_PARAMS] = {VALUES};
static const MODEL *const model = &retuned_model, *const written = &plain_model;
static real state[RETUNED_STATES];

static const real *sample(int k)
{
	static real u[RETUNED_INPUTS + 1];
	for (int i = 0; i < RETUNED_INPUTS; i++)
		u[i] = (real)(0.5 * sin(0.05 * k + i) + 0.3 * cos(0.031 * k));
	return u;
}

/* Both on by so many steps from where they are; what lies farthest apart, of the largest; crossings */
static double apart(retuned *a, plain *b, int steps, int first, int *crossed, int *other)
{
	double worst = 0, most = 0;
	for (int k = first; k < first + steps; k++) {
		crossing here[RETUNED_MAX_EVENTS], there[PLAIN_MAX_EVENTS];
		real x[RETUNED_OUTPUTS], y[RETUNED_OUTPUTS];
		model->step(a, sample(k));
		written->step(b, sample(k));
		model->out(a, x);
		written->out(b, y);
		const int count = retuned_crossings(a, here), expected = plain_crossings(b, there);
		*crossed += count;
		*other += count != expected;
		for (int i = 0; i < count && i < expected; i++)
			*other += !(fabs((double)here[i].time - (double)there[i].time) <= late);
		for (int i = 0; i < RETUNED_OUTPUTS; i++) {
			worst = worse(worst, fabs((double)x[i] - (double)y[i]));
			most = fmax(most, fabs((double)y[i]));
		}
		real z[RETUNED_STATES], w[RETUNED_STATES], tau = (real)(0.37 * RETUNED_H);
		if (model->at && k % 50 == 0) {
			model->at(a, sample(k + 1), tau, z);
			written->at(b, sample(k + 1), tau, w);
			for (int i = 0; i < RETUNED_STATES; i++)
				worst = worse(worst, fabs((double)z[i] - (double)w[i]) / fmax(1, fabs((double)w[i])));
		}
	}
	return worst / most;
}

static void compare(retuned *a, plain *b, const char *when, int first)
{
	int crossed = 0, other = 0;
	const double worst = apart(a, b, STEPS, first, &crossed, &other);
	ok(worst <= tolerance, "%s: as with the values written within %.0e (%.2g)", when, tolerance, worst);
	ok(crossed > 0 && other == 0, "%s: the same %d crossings (%d others)", when, crossed, other);
	ok(retuned_status(a) == plain_status(b), "%s: the same status (%d, %d)", when, retuned_status(a),
			plain_status(b));
}

/* In the middle of a run: as after set */
static void later(retuned *a, plain *b, const retuned_coeffs *fresh)
{
	retuned *moved = malloc(sizeof *moved);
	retuned_init(a);
	for (int k = 0; k < HALF; k++)
		model->step(a, sample(k));
	retuned_use(a, fresh);
	model->get(a, state);
	*moved = *a;
	model->set(moved, model->time(a), state);
	ok(retuned_region(a) == retuned_region(moved), "the region is that of the state (%d, %d)", retuned_region(a),
		retuned_region(moved));
	plain_init(b);
	written->set(b, model->time(a), state);
	if (written->hold)
		written->hold(b, sample(HALF - 1));
	compare(a, b, "from the middle on", HALF);
	free(moved);
}

/* One step from each of many states as large as those of a run: among them are some that touch a breakpoint within the
 * step, and leave it */
static void scattered(retuned *a, plain *b)
{
	enum { STATES = 4000 };
	real most[RETUNED_STATES] = {0}, y[RETUNED_STATES], z[RETUNED_STATES];
	uint32_t random = 1;
	int crossed = 0, twice = 0, other = 0;
	double worst = 0;
	for (int k = 0; k < STEPS; k++) {
		model->step(a, sample(k));
		model->get(a, y);
		for (int i = 0; i < RETUNED_STATES; i++)
			most[i] = (real)fmax((double)most[i], fabs((double)y[i]));
	}
	for (int k = 0; k < STATES; k++) {
		for (int i = 0; i < RETUNED_STATES; i++) {
			random = random * 1664525 + 1013904223;
			y[i] = (real)(((double)random / 2147483648.0 - 1) * (double)most[i]);
		}
		model->set(a, 0.001 * k, y);
		written->set(b, 0.001 * k, y);
		if (model->hold) {
			model->hold(a, sample(k));
			written->hold(b, sample(k));
		}
		const uint64_t before = retuned_crossed(a), first = plain_crossed(b);
		model->step(a, sample(k + 1));
		written->step(b, sample(k + 1));
		const int count = (int)(retuned_crossed(a) - before), expected = (int)(plain_crossed(b) - first);
		crossed += expected > 0;
		twice += expected > 1;
		other += count != expected;
		model->get(a, y);
		written->get(b, z);
		for (int i = 0; i < RETUNED_STATES; i++)
			worst = worse(worst,
					fabs((double)y[i] - (double)z[i]) / fmax((double)most[i], fabs((double)z[i])));
	}
	ok(crossed > 0 && other == 0, "of %d scattered states as many cross (%d, %d of them twice or more; %d others)",
		STATES, crossed, twice, other);
	ok(worst <= tolerance, "and go where those with the values written go within %.0e (%.2g)", tolerance, worst);
}

#ifdef HAS_DERIVATIVES
/* Column by column what lies farthest apart, of the largest, after use in the middle of a run too */
static void derivatives(retuned *a, plain *b, const retuned_coeffs *fresh)
{
	static real S[RETUNED_D][RETUNED_STATES], T[RETUNED_D][RETUNED_STATES];
	double worst[RETUNED_D] = {0}, most[RETUNED_D] = {0};
	retuned_d *da = malloc(sizeof *da);
	plain_d *db = malloc(sizeof *db);
	retuned_init_d(a, da);
	retuned_use(a, fresh);
	plain_init_d(b, db);
	for (int k = 0; k < STEPS; k++) {
		retuned_derivatives.step(a, da, sample(k), NULL);
		plain_derivatives.step(b, db, sample(k), NULL);
		retuned_get_d(a, da, S);
		plain_get_d(b, db, T);
		for (int p = 0; p < RETUNED_D; p++)
			for (int i = 0; i < RETUNED_STATES; i++) {
				worst[p] = worse(worst[p], fabs((double)S[p][i] - (double)T[p][i]));
				most[p] = fmax(most[p], fabs((double)T[p][i]));
			}
	}
	for (int p = 0; p < RETUNED_D; p++)
		ok(most[p] > 0 && worst[p] <= tolerance * most[p], "derivatives by %s: as with the values written "
			"(%.2g of %.2g)", retuned_derivatives.names[p], worst[p], most[p]);
	ok(da->status == db->status, "with the same status (%u, %u)", da->status, db->status);
	free(da);
	free(db);
}
#endif

static void copies(retuned *a)
{
	retuned *saved = malloc(sizeof *saved), *again = malloc(sizeof *again);
	real x[RETUNED_STATES], y[RETUNED_STATES];
	*saved = *a;
	for (int k = 0; k < 200; k++)
		model->step(a, sample(k));
	model->get(a, x);
	*again = *saved;
	for (int k = 0; k < 200; k++)
		model->step(again, sample(k));
	model->get(again, y);
	ok(memcmp(x, y, sizeof x) == 0, "a copy goes on bit by bit");
	free(saved);
	free(again);
}

static void refuse(const retuned_coeffs *before, const real *params, real h, int status, const char *what)
{
	retuned_coeffs *c = malloc(sizeof *c);
	*c = *before;
	const int said = retuned_retune(c, params, h);
	ok(said == status && memcmp(c->params, before->params, sizeof c->params) == 0,
		"refused: %s (%d, expected %d)", what, said, status);
#ifdef HAS_MATRICES
	ok(memcmp(c->slopes, before->slopes, sizeof c->slopes) == 0, "and its matrices stay");
#endif
	free(c);
}

static void refusals(const retuned_coeffs *fresh)
{
	real params[RETUNED_PARAMS];
	for (int k = 0; k < RETUNED_PARAMS; k++) {
		memcpy(params, values, sizeof params);
		params[k] = (real)NAN;
		refuse(fresh, params, RETUNED_H, PL_NOT_FINITE, "not a number");
		params[k] = -(real)INFINITY;
		refuse(fresh, params, RETUNED_H, PL_NOT_FINITE, "infinite");
	}
	refuse(fresh, values, RETUNED_H / 2, PL_NO_STEP, "another step");
	for (size_t i = 0; i < sizeof refused / sizeof *refused; i++) {
		memcpy(params, values, sizeof params);
		for (int k = 0; k < refused[i].count; k++)
			for (int p = 0; p < RETUNED_PARAMS; p++)
				if (strcmp(model->param_names[p], refused[i].name[k]) == 0)
					params[p] = (real)refused[i].value[k];
		refuse(fresh, params, RETUNED_H, refused[i].status, refused[i].text);
	}
}

int main(void)
{
	retuned *a = malloc(sizeof *a);
	plain *b = malloc(sizeof *b);
	retuned_coeffs *fresh = malloc(sizeof *fresh);
	ok(retuned_retune(fresh, values, RETUNED_H) == 0, "%s takes other values", retuned_model.name);
	retuned_init(a);
	retuned_use(a, fresh);
	plain_init(b);
	compare(a, b, "from the start", 0);
	copies(a);
	later(a, b, fresh);
#ifndef REAL_FLOAT          /* what floats round may be a touch more or less */
	retuned_init(a);
	retuned_use(a, fresh);
	scattered(a, b);
#endif
#ifdef HAS_DERIVATIVES
	derivatives(a, b, fresh);
#endif
	refusals(fresh);
	retuned_init(a);
	ok(retuned_retune(fresh, retuned_model.param_values, RETUNED_H) == 0, "and those of the spec");
	retuned *same = malloc(sizeof *same);
	retuned_init(same);
	retuned_use(same, fresh);
	double worst = 0, most = 0;
	for (int k = 0; k < HALF; k++) {
		real x[RETUNED_OUTPUTS], y[RETUNED_OUTPUTS];
		model->step(a, sample(k));
		model->step(same, sample(k));
		model->out(a, x);
		model->out(same, y);
		for (int i = 0; i < RETUNED_OUTPUTS; i++) {
			worst = worse(worst, fabs((double)x[i] - (double)y[i]));
			most = fmax(most, fabs((double)x[i]));
		}
	}
	ok(worst <= tolerance * most, "which give the steps of the generator's own (%.2g of %.2g)", worst, most);
	free(a);
	free(b);
	free(same);
	free(fresh);
	return tap_end();
}
