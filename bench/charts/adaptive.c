/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Integrators that choose their steps (adaptive.h): the run that all of them share, and their list. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <cvode/cvode.h>

#include "adaptive.h"

/* ---- the scales: what is true says them ---- */

/* A coordinate that never moves has no scale of its own: 1 */
static void set_scales(struct adaptive *a)
{
	const struct problem *p = a->run.problem;
	if (!isfinite(p->scale_q + p->scale_v) || !(p->scale_q + p->scale_v > 0.0)) {
		fprintf(stderr, "%s: %s before its scales are known\n", p->name, a->run.method->name);
		exit(1);
	}
	for (int i = 0; i < a->n; i++) {
		a->scale[i] = p->scale_q > 0.0 ? p->scale_q : 1.0;
		a->scale[a->n + i] = p->scale_v > 0.0 ? p->scale_v : 1.0;
	}
}

/* ---- the run as charts.h has it ---- */

static void adaptive_restart(struct run *run)
{
	struct adaptive *a = (struct adaptive *)run;
	a->units = a->run.asked = 0;
	memcpy(a->now, run->problem->start, (size_t)a->size * sizeof *a->now);
	a->failed = !kind_of(a)->solver->begin(a, 0.0, a->now);
}

static bool adaptive_advance(struct run *run, int units, double *rows)
{
	struct adaptive *a = (struct adaptive *)run;
	const struct solver *solver = kind_of(a)->solver;
	if (a->walk && !a->failed) {
		a->failed = !a->walk(a, units, rows);
		return !a->failed;
	}
	for (int u = 0; u < units && !a->failed; u++) {
		a->units++;
		a->failed = !solver->reach(a, (double)a->units * run->problem->unit, a->now) ||
		            !all_finite(a->size, a->now);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * a->size, a->now, (size_t)a->size * sizeof *rows);
	}
	return !a->failed;
}

static struct adaptive *adaptive_new(const struct method *method, const struct problem *problem, double setting);

static bool go_aside(struct adaptive *a, double end, double *y)
{
	const struct solver *solver = kind_of(a)->solver;
	if (!a->aside)
		a->aside = adaptive_new(a->run.method, a->run.problem, a->run.setting);
	if (!a->aside)
		return false;
	return solver->begin(a->aside, (double)a->units * a->run.problem->unit, a->now) &&
	       solver->reach(a->aside, end, y);
}

/* What looks ahead cannot look back behind its last step: then it goes aside as the others do */
static void adaptive_between(struct run *run, double fraction, double *y)
{
	struct adaptive *a = (struct adaptive *)run;
	const struct solver *solver = kind_of(a)->solver;
	const double end = ((double)a->units + fraction) * run->problem->unit;
	bool good = !a->failed && ((solver->looks_ahead && solver->reach(a, end, y)) || go_aside(a, end, y));
	for (int i = 0; i < a->size && !good; i++)
		y[i] = NAN;
}

static void adaptive_close(struct run *run)
{
	struct adaptive *a = (struct adaptive *)run;
	if (a->aside)
		adaptive_close(&a->aside->run);
	if (kind_of(a)->solver->discard)
		kind_of(a)->solver->discard(a);
	free(a->scale);
	free(a->now);
	free(a);
}

static struct adaptive *adaptive_new(const struct method *method, const struct problem *problem, double setting)
{
	const struct kind *kind = (const struct kind *)method;
	struct adaptive *a = calloc(1, kind->solver->bytes);
	if (!a)
		return NULL;
	a->run = (struct run){.method = method, .problem = problem, .setting = setting, .restart = adaptive_restart,
	                      .advance = adaptive_advance,
	                      .between = adaptive_between, .get = run_get, .evaluations = run_evaluations,
	                      .close = adaptive_close};
	a->rhs = asked_of(problem);
	a->n = problem->n;
	a->size = 2 * problem->n;
	a->scale = calloc((size_t)a->size, sizeof *a->scale);
	a->now = calloc((size_t)a->size, sizeof *a->now);
	a->run.now = a->now;
	if (a->scale && a->now) {
		if (method->tolerance)
			set_scales(a);
		if (kind->solver->make(a))
			return a;
	}
	adaptive_close(&a->run);
	return NULL;
}

struct run *adaptive_open(const struct method *method, const struct problem *problem, double setting)
{
	if (!(setting > 0.0) || (method->tolerance && setting > 1.0))
		return NULL;
	struct adaptive *a = adaptive_new(method, problem, setting);
	if (!a)
		return NULL;
	adaptive_restart(&a->run);
	return &a->run;
}

static struct run *fixed_open(const struct method *method, const struct problem *problem, double setting)
{
	const int steps = steps_of(problem, setting);
	return steps > 0 ? adaptive_open(method, problem, problem->unit / steps) : NULL;
}

/* ---- the list ---- */

static const struct kind dormand_prince = {
	.method = BY_TOLERANCE("Dormand-Prince", 5,
	                       "5(4) pair as in ode45, PI controller (beta 0.04), output from its free interpolant of "
	                       "order 4"),
	.solver = &dormand_solver,
};
static const struct kind gsl_rk8pd = {
	.method = BY_TOLERANCE("GSL rk8pd", 8,
	                       "driver with scaled control, applied to each output time; it has no interpolant"),
	.solver = &gsl_solver, .gsl = &gsl_odeiv2_step_rk8pd,
};
static const struct kind gsl_msadams = {
	.method = BY_TOLERANCE("GSL msadams", 0,
	                       "order 1 to 12, driver with scaled control, applied to each output time; it has no "
	                       "interpolant"),
	.solver = &gsl_solver, .gsl = &gsl_odeiv2_step_msadams,
};
static const struct kind gsl_rk8pd_fixed = {
	.method = {.name = "GSL rk8pd (fixed step)", .family = FIXED, .order = 8, .open = fixed_open,
	           .settings = "gsl_odeiv2_driver_apply_fixed_step, tolerances open (epsabs = DBL_MAX): no step is "
	                       "ever rejected"},
	.solver = &gsl_fixed_solver, .gsl = &gsl_odeiv2_step_rk8pd,
};
static const struct kind cvode_adams = {
	.method = BY_TOLERANCE("CVODE Adams", 0,
	                       "order 1 to 12, fixed-point iteration (manual: for nonstiff), CV_NORMAL, output from "
	                       "its interpolant"),
	.solver = &cvode_solver, .formula = CV_ADAMS,
};
static const struct kind cvode_bdf = {
	.method = BY_TOLERANCE("CVODE BDF", 0,
	                       "order 1 to 5, Newton, dense; Jacobian exact for smooth models, beams and linear "
	                       "problems, else its own differences; CV_NORMAL, output from its interpolant"),
	.solver = &cvode_solver, .formula = CV_BDF,
};
static const struct kind arkode = {
	.method = BY_TOLERANCE("ARKODE order 8", 8,
	                       "ARKStep, explicit, Fehlberg 13-7-8, stopped at each output time (its interpolants are "
	                       "of degree 5 at most)"),
	.solver = &arkode_solver,
};
static const struct kind arkode_dirk = {
	.method = BY_TOLERANCE("ARKODE DIRK", 5,
	                       "ARKStep, implicit, its own table of order 5, Newton, dense, to 1e-3 of the tolerance; "
	                       "linear problems are said to be linear; Jacobian as of CVODE BDF; "
	                       "stopped at each output time (its interpolants are of degree 5 at most)"),
	.solver = &dirk_solver, .formula = 5,
};
static const struct kind gsl_bsimp = {
	.method = BY_TOLERANCE("GSL bsimp", 0,
	                       "Bader and Deuflhard's extrapolation, exact Jacobian (none: it cannot), driver with "
	                       "scaled control, applied to each output time; it has no interpolant"),
	.solver = &gsl_solver, .gsl = &gsl_odeiv2_step_bsimp,
};

/* A peer is added here (its name in tests/charts/methods.list, its group in series.awk) */
const struct method *const adaptive_methods[] = {
	&dormand_prince.method, &dop853.method, &gsl_rk8pd.method, &gsl_msadams.method, &gsl_rk8pd_fixed.method,
	&gsl_bsimp.method, &cvode_adams.method, &cvode_bdf.method, &arkode.method, &arkode_dirk.method, &radau5.method,
	&radau9.method, &radau13.method, NULL,
};

void put_scales(FILE *out, const struct problem *problem, const char *name, const char *file)
{
	struct adaptive *a = adaptive_new(&dormand_prince.method, problem, 1e-3);
	if (!a)
		leave(name, "no run");
	fprintf(out, "%s\t%s\t%.17g\t%d\t%.10g\t%.10g\n", name, file, problem->unit, problem->units, a->scale[0],
	        a->scale[a->n]);
	adaptive_close(&a->run);
}
