/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The orders that are left where something is not smooth, as plgen states them: fitted over sixteen steps, as a single
 * crossing errs by where it falls in its step. Against scheme exact, which finds the crossings of what is piecewise
 * linear, or CVODE at 1e-12. */
#include "smooth_variants.h"
#include "tap.h"
#include "truth.h"

#include <math.h>

enum { STEPS = 16, END = 4 };

static void bowed(const void *of, double t, const double *y, const double *u, double *dydt)
{
	(void)of, (void)u;
	dydt[0] = y[1];
	dydt[1] = cos(2 * t) - 4 * y[0] - 6 * y[0] * fabs(y[0]);
}

static void hertz(const void *of, double t, const double *y, const double *u, double *dydt)
{
	(void)of, (void)u;
	dydt[0] = y[1];
	dydt[1] = cos(2 * t) - 4 * y[0] - 40 * pow(fmax(y[0], 0), 1.5);
}

static void early(const void *of, double t, const double *y, const double *u, double *dydt)
{
	(void)of, (void)t, (void)u;
	dydt[0] = y[1];
	dydt[1] = -4 * y[0] - 8 * pow(y[0], 3);
}

static void late(const void *of, double t, const double *y, const double *u, double *dydt)
{
	(void)of, (void)t, (void)u;
	dydt[0] = y[1];
	dydt[1] = -4 * y[0] - 2 * pow(y[0], 3);
}

static bool follow(slopes *f, double from, double to, double *y)
{
	static const double scale[] = {1e-3, 1e-3};
	struct truth *solver = truth_new(2, f, NULL, CVODE_ADAMS, 1e-12, scale);
	const bool good = truth_advance(solver, from, to, 0, NULL, y);
	truth_free(solver);
	return good;
}

static void end_of(const pl_model *m, double *y)
{
	void *state = calloc(1, m->size);
	m->init(state);
	m->run(state, (size_t)lround(END / m->h), NULL, NULL);
	m->get(state, y);
	free(state);
}

/* Least squares of log2 of the errors over log2 of the steps */
static double fitted_order(const char *name, const char *scheme, const double *truth, double *first, double *last)
{
	double n = 0, sx = 0, sy = 0, sxx = 0, sxy = 0;
	for (int i = 0; i < STEPS; i++) {
		const pl_model *m = variant_of(smooth, "%s_%s_%d", name, scheme, i)->model;
		double y[2];
		end_of(m, y);
		const double error = hypot(y[0] - truth[0], y[1] - truth[1]), a = log2(m->h), b = log2(error);
		*(i == 0 ? first : last) = error;
		n++, sx += a, sy += b, sxx += a * a, sxy += a * b;
	}
	return (n * sxy - sx * sy) / (n * sxx - sx * sx);
}

/* first: of two schemes that step across; etdrk4 does where it cannot go from crossing to crossing */
static void judge(const char *name, const char *first_scheme, const double *truth, double order)
{
	const char *const schemes[] = {first_scheme, "bm3"};
	for (int k = 0; k < 2; k++) {
		double first = 0, last = 0;
		const double found = fitted_order(name, schemes[k], truth, &first, &last);
		ok(fabs(found - order) < 0.5, "%s, %s: order %.3g, fitted %.3g (errors %.3g ... %.3g)", name,
				schemes[k], order,
			found, first, last);
	}
}

int main(void)
{
	static const struct { const char *name; double order; } switched[] = {{"kinked", 2}, {"jumping", 1},
			{"rates", 2}};
	static const struct { const char *name; slopes *early, *late; double start[2], order; } solved[] = {
		{"bowed", bowed, bowed, {1, 0}, 3}, {"hertz", hertz, hertz, {0, 1}, 2.5},
				{"timed", early, late, {1, 0}, 1}};
	for (size_t i = 0; i < sizeof switched / sizeof *switched; i++) {
		double y[2];
		end_of(variant_of(smooth, "%s_exact_0", switched[i].name)->model, y);
		judge(switched[i].name, "nc2", y, switched[i].order);
	}
	for (size_t i = 0; i < sizeof solved / sizeof *solved; i++) {
		double y[2] = {solved[i].start[0], solved[i].start[1]};
		ok(follow(solved[i].early, 0, 1.2345678, y) && follow(solved[i].late, 1.2345678, END, y),
			"%s: a solution to compare with", solved[i].name);
		judge(solved[i].name, i == 0 ? "nc2" : "etdrk4", y, solved[i].order);
	}
	return tap_end();
}
