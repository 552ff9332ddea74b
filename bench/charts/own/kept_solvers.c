/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solvers of the kept charts that go through a right-hand side, with the model's equations as that. */
#include <cvode/cvode.h>
#include <gsl/gsl_odeiv2.h>

#define INLINED_SLOPE(t, y, f) model_slope(t, y, f)
#include "kept.h"
#define JACOBIAN_H                      /* none is known in closed form */
#define jacobian_of(p) ((void (*)(const struct problem *, double, const double *, double *, double *))((void)(p), NULL))
enum { MOST_ENTRIES = N };
#include "../dormand.c"
#include "../solvers_gsl.c"
#include "../solvers_sundials.c"

static bool kept(struct adaptive *a, double *length, const struct kind *kind, double setting, double *rows)
{
	*a = (struct adaptive){.n = N / 2, .size = N, .scale = history.scale};
	return kept_history(a, kind, setting, length, as_it_is, 0, rows);
}

bool own_dormand(double setting, double *rows)
{
	static const struct kind kind = {.method = {.tolerance = true}, .solver = &dormand_solver};
	static struct dormand d;
	memset(&d, 0, sizeof d);
	return kept(&d.adaptive, &d.h, &kind, setting, rows);
}

bool own_rk8pd(double setting, double *rows)
{
	static const struct kind kind = {.method = {.tolerance = true}, .solver = &gsl_solver,
	                                 .gsl = &gsl_odeiv2_step_rk8pd};
	struct gsl g = {.t = 0.0};
	return kept(&g.adaptive, NULL, &kind, setting, rows);
}

static bool cvode(int formula, double setting, double *rows)
{
	const struct kind kind = {.method = {.tolerance = true}, .solver = &cvode_solver, .formula = formula};
	struct sundials s = {.start = 0.0};
	return kept(&s.adaptive, NULL, &kind, setting, rows);
}

bool own_adams(double setting, double *rows)
{
	return cvode(CV_ADAMS, setting, rows);
}

bool own_bdf(double setting, double *rows)
{
	return cvode(CV_BDF, setting, rows);
}
