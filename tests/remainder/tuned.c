/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params of the remainder: an instance that takes other values against the model with these values written,
 * against CVODE on equations by hand, and what it refuses. */
#include "tap.h"
#include "truth.h"
#include "tuned_variants.h"
#include "worse.h"

#include <math.h>

enum { STATES = 6, OUTPUTS = 6, STEPS = 400, PARAMS = 5 };

static const double other[PARAMS] = {130, 40, 0.5, 1, -2};

static const struct variant *one(const char *name, const char *scheme)
{
	return variant_of(tuned, "%s_%s_0", name, scheme);
}

static double sample(int k)
{
	return 0.3 * sin(0.05 * k);
}

/* As both go on from here: the largest difference of outputs, each over its largest value */
static double largest_difference(const pl_model *a, void *s, const pl_model *b, void *r, int from)
{
	double most[OUTPUTS] = {0}, error[OUTPUTS] = {0}, worst = 0;
	for (int k = from; k < from + STEPS; k++) {
		const double u = sample(k);
		double x[OUTPUTS], y[OUTPUTS];
		a->step(s, &u);
		b->step(r, &u);
		a->out(s, x);
		b->out(r, y);
		for (int i = 0; i < a->outputs; i++) {
			most[i] = fmax(most[i], fabs(y[i]));
			error[i] = worse(error[i], fabs(x[i] - y[i]));
		}
	}
	for (int i = 0; i < a->outputs; i++)
		worst = worse(worst, error[i] / most[i]);
	return worst;
}

/* From the start, and from a state on its way: a takes values that are written in b. */
static void both_ways(const pl_model *a, const pl_model *b, const double *values, double tolerance)
{
	void *s = calloc(1, a->size), *r = calloc(1, b->size);
	double worst, y[STATES], before[STATES], moved = 0;
	a->init(s);
	b->init(r);
	ok(a->retune(s, values, a->h) == 0, "%s takes other values", a->name);
	worst = largest_difference(a, s, b, r, 0);
	ok(worst <= tolerance, "%s: as with the values written within %.0e (largest difference %.2g)", a->name,
			tolerance,
		worst);
	a->init(s);
	for (int k = 0; k < STEPS; k++)
		a->step(s, &(double){sample(k)});
	a->get(s, before);
	a->retune(s, values, a->h);
	a->get(s, y);
	for (int i = 0; i < a->states; i++)
		moved = worse(moved, fabs(y[i] - before[i]) / fmax(fabs(before[i]), 1e-3));
	ok(moved <= 1e-13, "%s: its state stays as it is (largest difference %.2g)", a->name, moved);
	b->set(r, a->time(s), y);
	worst = largest_difference(a, s, b, r, STEPS);
	ok(worst <= tolerance, "%s: on its way too (largest difference %.2g)", a->name, worst);
	free(s);
	free(r);
}

static void as_written(const char *name, const char *fixed, const char *scheme, double tolerance)
{
	both_ways(one(name, scheme)->model, one(fixed, scheme)->model, other, tolerance);
}

static void slopes_by_hand(const void *of, double t, const double *y, const double *u, double *dydt)
{
	const double *p = of, k = p[0], k3 = p[1], mu = p[2], F = p[3];
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = F * cos(3 * t) + F * u[0] - 0.4 * y[2] - k * y[0] - k3 * y[0] * y[0] * y[0] - k / 2 * (y[0] - y[1]);
	dydt[3] = sqrt(k) / 100 - 50 * (y[1] - y[0]) - mu * (y[1] * y[1] - 1) * y[3] - sin(mu) * y[1] * y[1];
}

/* The last state after so many seconds, of samples that are h = 0.01 apart whatever the step is */
static void go(const pl_model *m, double seconds, double y[4])
{
	const int within = (int)lround(0.01 / m->h), steps = (int)lround(seconds / m->h);
	void *s = calloc(1, m->size);
	m->init(s);
	m->retune(s, other, m->h);
	for (int k = 0; k < steps; k++)
		m->step(s, &(double){sample(k / within)});
	m->get(s, y);
	free(s);
}

static void by_solver(const char *scheme, double tolerance)
{
	const pl_model *m = one("tuned", scheme)->model;
	const double scale[4] = {0.5, 0.5, 5, 5};
	double x[4], y[4] = {0.5, 0, 0, 0.2}, worst = 0;
	struct truth *solver = truth_new(4, slopes_by_hand, other, CVODE_ADAMS, 1e-12, scale);
	bool good = true;
	for (int k = 0; k < STEPS && good; k++)
		good = truth_advance(solver, k * 0.01, (k + 1) * 0.01, 1, (double[2]){sample(k), 0}, y);
	go(m, STEPS * 0.01, x);
	for (int i = 0; i < 4; i++) {
		good = close_to(x[i], y[i], tolerance * scale[i], "%s, %s", m->name, m->state_names[i]) && good;
		worst = worse(worst, fabs(x[i] - y[i]) / scale[i]);
	}
	ok(good, "%s with other values: CVODE agrees within %.0e (largest difference %.2g)", m->name, tolerance, worst);
	truth_free(solver);
}

/* The operator is that of the spec's values: what other ones add is left over, to the scheme's order */
static void of_order(const char *scheme, double order)
{
	double y[4], x[2][4], error[2] = {0, 0};
	go(one("tuned", "taylor")->model, 2, y);
	for (int k = 0; k < 2; k++) {
		go(variant_of(tuned, "fine_%s_%d", scheme, k)->model, 2, x[k]);
		for (int i = 0; i < 4; i++)
			error[k] = worse(error[k], fabs(x[k][i] - y[i]));
	}
	const double found = log2(error[0] / error[1]);
	ok(fabs(found - order) <= 0.15, "%s with other values is of order %.2f (errors %.2g, %.2g)", scheme, found,
		error[0], error[1]);
}

static void refuses(const pl_model *m)
{
	const double bad[PARAMS] = {130, HUGE_VAL, 1, 1, -2}, none[PARAMS] = {130, NAN, 1, 1, -2};
	void *s = calloc(1, m->size), *before = calloc(1, m->size);
	m->init(s);
	memcpy(before, s, m->size);
	ok(m->retune(s, other, 0.5 * m->h) == PL_NO_STEP, "%s has one step", m->name);
	ok(m->retune(s, bad, m->h) == PL_NOT_FINITE && m->retune(s, none, m->h) == PL_NOT_FINITE,
			"and params are finite");
	ok(memcmp(s, before, m->size) == 0, "what is refused changes nothing");
	free(s);
	free(before);
}

/* Rows at once and one step after the other have the same bits. */
static void in_rows(const char *name, const char *scheme)
{
	const pl_model *m = scheme ? one(name, scheme)->model : variant_of(tuned, "%s_0", name)->model;
	void *s = calloc(1, m->size), *r = calloc(1, m->size);
	double u[STEPS], rows[STEPS][OUTPUTS], out[OUTPUTS];
	bool same = true;
	for (int k = 0; k < STEPS; k++)
		u[k] = sample(k);
	m->init(s);
	m->init(r);
	m->retune(s, other, m->h);
	m->retune(r, other, m->h);
	m->run(r, STEPS, m->inputs ? u : NULL, rows[0]);
	for (int k = 0; k < STEPS; k++) {
		m->step(s, &u[k]);
		m->out(s, out);
		same = same && memcmp(out, rows[0] + k * m->outputs, (size_t)m->outputs * sizeof *out) == 0;
	}
	ok(same, "%s: NAME_run, same bits", m->name);
	free(s);
	free(r);
}

int main(void)
{
	static const char *const exact[] = {"taylor", "radau", "auto"};
	for (int i = 0; i < 3; i++) {
		as_written("tuned", "tuned_fixed", exact[i], 2e-14);
		by_solver(exact[i], 2e-9);
		in_rows("tuned", exact[i]);
	}
	as_written("tuned_free", "tuned_free_fixed", "taylor", 2e-14);
	as_written("tuned_free", "tuned_free_fixed", "etdcol", 1e-12);
	in_rows("tuned_free", "taylor");
	in_rows("tuned_free", "etdam6");
	static const struct { const char *scheme; double tolerance; } left[] = {{"etdrk4", 1e-5}, {"etdrk2", 5e-2},
		{"nc2", 1e-5}, {"nc3", 1e-5}, {"dq4", 1e-5}, {"bm3", 1e-5}};
	for (size_t i = 0; i < sizeof left / sizeof *left; i++)
		as_written("tuned", "tuned_fixed", left[i].scheme, left[i].tolerance);
	as_written("tuned_free", "tuned_free_fixed", "etdam4", 2e-6);
	as_written("tuned_free", "tuned_free_fixed", "etdam6", 1e-8);
	static const double gaps[] = {0.15, -3, 0, 0, 0};
	both_ways(variant_of(tuned, "tuned_gaps_0")->model, variant_of(tuned, "tuned_gaps_fixed_0")->model, gaps,
			1e-12);
	in_rows("tuned_gaps", NULL);
	refuses(variant_of(tuned, "tuned_gaps_0")->model);
	of_order("etdrk4", 4);
	of_order("etd1", 1);
	refuses(one("tuned", "taylor")->model);
	refuses(one("tuned", "etdrk4")->model);
	refuses(one("tuned_free", "etdam4")->model);
	return tap_end();
}
