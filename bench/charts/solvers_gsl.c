/* SPDX-License-Identifier: GPL-3.0-or-later */
/* GSL's odeiv2, as it comes: it has no interpolant. */
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>

#include "adaptive.h"
#include "jacobian.h"

struct gsl {
	struct adaptive adaptive;
	gsl_odeiv2_system system;
	gsl_odeiv2_driver *driver;
	double first;               /* its first step */
	double t;
	double *y;
};

static int gsl_slope(double t, const double y[], double dydt[], void *of)
{
	slope(of, t, y, dydt);
	return GSL_SUCCESS;
}

/* For bsimp: f = (v, a), and slopes of f in time, by central differences where there is a load */
static int gsl_jacobian(double t, const double y[], double *dfdy, double dfdt[], void *of)
{
	struct adaptive *a = of;
	const struct problem *p = a->run.problem;
	const int n = a->n;
	const double move = 1e-5 * p->unit;
	double Jq[n * n], Jv[n * n], after[2 * n];
	jacobian_of(p)(p, t, y, Jq, Jv);
	memset(dfdy, 0, (size_t)(a->size * a->size) * sizeof *dfdy);
	for (int i = 0; i < n; i++) {
		dfdy[i * a->size + n + i] = 1.0;
		for (int j = 0; j < n; j++) {
			dfdy[(n + i) * a->size + j] = Jq[i * n + j];
			dfdy[(n + i) * a->size + n + j] = Jv[i * n + j];
		}
	}
	slope(a, t + move, y, after);
	slope(a, t - move, y, dfdt);
	for (int i = 0; i < a->size; i++)
		dfdt[i] = (after[i] - dfdt[i]) / (2.0 * move);
	return GSL_SUCCESS;
}

static bool gsl_make(struct adaptive *a)
{
	struct gsl *g = (struct gsl *)a;
	const gsl_odeiv2_step_type *type = *kind_of(a)->gsl;
	const bool fixed = !a->run.method->tolerance;
	gsl_set_error_handler_off();
	if (type == gsl_odeiv2_step_bsimp && !jacobian_of(a->run.problem))
		return false;
	g->system = (gsl_odeiv2_system){.function = gsl_slope, .jacobian = gsl_jacobian,
	                                .dimension = (size_t)a->size, .params = a};
	g->first = fixed ? a->run.setting : 1e-3 * a->run.problem->unit;
	g->y = calloc((size_t)a->size, sizeof *g->y);
	if (fixed)                  /* tolerances so open that the control never rejects a step */
		g->driver = gsl_odeiv2_driver_alloc_y_new(&g->system, type, g->first, DBL_MAX, 0.0);
	else
		g->driver = gsl_odeiv2_driver_alloc_scaled_new(&g->system, type, g->first, a->run.setting,
		                                               a->run.setting, 1.0, 0.0, a->scale);
	return g->y && g->driver && gsl_odeiv2_driver_set_nmax(g->driver, fixed ? 0 : MOST_STEPS) == GSL_SUCCESS;
}

static bool gsl_begin(struct adaptive *a, double t, const double *y)
{
	struct gsl *g = (struct gsl *)a;
	g->t = t;
	memcpy(g->y, y, (size_t)a->size * sizeof *y);
	return gsl_odeiv2_driver_reset_hstart(g->driver, g->first) == GSL_SUCCESS;
}

static bool gsl_reach(struct adaptive *a, double end, double *y)
{
	struct gsl *g = (struct gsl *)a;
	if (gsl_odeiv2_driver_apply(g->driver, &g->t, end, g->y) != GSL_SUCCESS)
		return false;
	memcpy(y, g->y, (size_t)a->size * sizeof *y);
	return true;
}

/* Equal steps, no longer than the setting: of a whole unit they are the setting */
static bool gsl_reach_fixed(struct adaptive *a, double end, double *y)
{
	struct gsl *g = (struct gsl *)a;
	const double length = end - g->t, steps = fmax(1.0, ceil(length / a->run.setting - 1e-6));
	if (gsl_odeiv2_driver_apply_fixed_step(g->driver, &g->t, length / steps, (unsigned long)steps, g->y) !=
	    GSL_SUCCESS)
		return false;
	g->t = end;
	memcpy(y, g->y, (size_t)a->size * sizeof *y);
	return true;
}

static void gsl_discard(struct adaptive *a)
{
	struct gsl *g = (struct gsl *)a;
	if (g->driver)
		gsl_odeiv2_driver_free(g->driver);
	free(g->y);
}

const struct solver gsl_solver = {
	.bytes = sizeof(struct gsl), .make = gsl_make, .begin = gsl_begin, .reach = gsl_reach, .discard = gsl_discard,
};
const struct solver gsl_fixed_solver = {
	.bytes = sizeof(struct gsl), .make = gsl_make, .begin = gsl_begin, .reach = gsl_reach_fixed,
	.discard = gsl_discard,
};
