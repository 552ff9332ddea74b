/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Solutions of the equations as written, for comparison. Two solvers: Prince and Dormand's Runge-Kutta pair of order 8
 * (GSL), and Gragg's modified midpoint rule extrapolated by Bulirsch and Stoer (Hairer, Norsett, Wanner I, II.9);
 * where stiffness makes them slow, Gear's backward differentiation formulas and Bader and Deuflhard's implicit midpoint
 * rule (both GSL). What they have in common is NAME_rhs, and that they start anew where a formula in time changes. */
#include "run/run.h"

#include <gsl/gsl_errno.h>
#include <gsl/gsl_odeiv2.h>
#include <math.h>
#include <string.h>

enum { COLUMNS = 8 };               /* of the extrapolation: order 16 */

struct journey {                    /* one solution from start to end */
	struct solvers *solvers;
	int states;
	double *y;
	double t, step;             /* [s]; the step that the method would take */
	double first, last;         /* of the interval in which time has one formula */
	double *u;                  /* inputs, then their slopes */
	long sample;                /* at which the step of the inputs began */
	uint64_t before;            /* operations when it began */
	double *work;
	gsl_odeiv2_system system;
	gsl_odeiv2_driver *driver;
};

static uint64_t operations_so_far(const struct solvers *solvers)
{
	const struct counted counted = running_counted(solvers->r);
	return counted.multiplications + counted.additions + 20 * counted.calls;
}

static bool is_spent(const struct journey *j)
{
	return operations_so_far(j->solvers) - j->before > j->solvers->most;
}

/* At the ends of an interval its own formula counts, not that of the next. */
static int slopes(double t, const double *y, double *slope, void *context)
{
	const struct journey *j = context;
	double inside = t >= j->last ? nextafter(j->last, -HUGE_VAL) : t <= j->first ? j->first : t;
	if (j->solvers->drive)
		drive_at(j->solvers->drive, j->sample, t, j->u);
	running_rhs(j->solvers->r, inside, y, j->u, slope);
	for (int i = 0; i < j->states; i++)
		if (!isfinite(slope[i]))
			return GSL_FAILURE;             /* a shorter step may do */
	return is_spent(j) ? GSL_EBADFUNC : GSL_SUCCESS; /* which ends it */
}

/* By differences: the methods bear an approximate one */
static int jacobian(double t, const double *y, double *dfdy, double *dfdt, void *context)
{
	const struct journey *j = context;
	int n = j->states;
	SCRATCH double *at = ARRAY(double, 3 * (size_t)n);
	double *here = at + n, *there = here + n;
	memcpy(at, y, (size_t)n * sizeof *at);
	int status = slopes(t, at, here, context);
	for (int k = 0; k < n && status == GSL_SUCCESS; k++) {
		double size = j->solvers->size ? j->solvers->size[k] : 0, by = 1e-8 * (size + fabs(y[k]) + 1e-12);
		at[k] = y[k] + by;
		by = at[k] - y[k];
		status = slopes(t, at, there, context);
		for (int i = 0; i < n; i++)
			dfdy[i * n + k] = (there[i] - here[i]) / by;
		at[k] = y[k];
	}
	double dt = 1e-7 * (j->solvers->h + fabs(t) * 1e-6);
	if (status == GSL_SUCCESS)
		status = slopes(t + dt, at, there, context);
	for (int i = 0; i < n; i++)
		dfdt[i] = (there[i] - here[i]) / dt;
	return status;
}

/* ---- extrapolation ---- */

/* From y over `step` by 2 k substeps of the modified midpoint rule: end */
static int midpoint(struct journey *j, const double *slope, double step, int substeps, double *end)
{
	int n = j->states, status = GSL_SUCCESS;
	double *before = j->work, *now = before + n, *f = now + n, h = step / substeps;
	memcpy(before, j->y, (size_t)n * sizeof *before);
	for (int i = 0; i < n; i++)
		now[i] = before[i] + h * slope[i];
	for (int k = 1; k < substeps && status == GSL_SUCCESS; k++) {
		status = slopes(j->t + k * h, now, f, j);
		for (int i = 0; i < n; i++) {
			const double next = before[i] + 2 * h * f[i];
			before[i] = now[i];
			now[i] = next;
		}
	}
	if (status == GSL_SUCCESS)
		status = slopes(j->t + step, now, f, j);
	for (int i = 0; i < n; i++)
		end[i] = 0.5 * (before[i] + now[i] + h * f[i]);
	return status;
}

static double scale_of(const struct journey *j, int i)
{
	const double size = j->solvers->size ? j->solvers->size[i] : fabs(j->y[i]);
	return size > 0 ? size : 1;
}

/* The polynomial in the square of the substep at 0 (Aitken, Neville); the last difference over the tolerance */
static double extrapolate(const struct journey *j, double (*row)[COLUMNS], int columns)
{
	double error = 0;
	for (int i = 0; i < j->states; i++) {
		double *p = row[i], before = 0;
		for (int m = 1; m < columns; m++)
			for (int k = columns - 1; k >= m; k--) {
				const double ratio = (double)(k + 1) / (k + 1 - m);
				before = p[k];
				p[k] += (p[k] - p[k - 1]) / (ratio * ratio - 1);
			}
		error = fmax(error, fabs(p[columns - 1] - before) / (scale_of(j, i) * j->solvers->tolerance));
	}
	return error;
}

/* One step of at most `most`; GSL_SUCCESS, and t, y and the next step are set */
static int extrapolated_step(struct journey *j, double most)
{
	int n = j->states;
	double *slope = j->work + 3 * n, *end = slope + n;
	double (*row)[COLUMNS] = (double (*)[COLUMNS])(void *)(end + n);
	int status = slopes(j->t, j->y, slope, j);
	while (status == GSL_SUCCESS) {
		const double step = fmin(j->step, most);
		for (int k = 0; k < COLUMNS && status == GSL_SUCCESS; k++) {
			status = midpoint(j, slope, step, 2 * (k + 1), end);
			for (int i = 0; i < n; i++)
				row[i][k] = end[i];
		}
		if (status == GSL_EBADFUNC)
			return status;
		const double error = status == GSL_SUCCESS ? extrapolate(j, row, COLUMNS) : 1e30;
		const double factor = 0.9 * pow(fmax(error, 1e-30), -1.0 / (2 * COLUMNS - 1));
		if (!(step > 1e-15 * j->solvers->until))
			return GSL_FAILURE;
		status = GSL_SUCCESS;
		if (error <= 1) {
			j->t = step < most ? j->t + step : j->t + most;
			for (int i = 0; i < n; i++)
				j->y[i] = row[i][COLUMNS - 1];
			j->step = step < j->step ? j->step : step * fmin(factor, 4);
			return GSL_SUCCESS;
		}
		j->step = step * fmax(fmin(factor, 0.7), 0.1);
	}
	return status;
}

static int extrapolate_to(struct journey *j, double end)
{
	int status = GSL_SUCCESS;
	while (j->t < end && status == GSL_SUCCESS) {
		const double rest = end - j->t;
		const bool whole = rest <= j->step;
		status = extrapolated_step(j, rest);
		if (whole && status == GSL_SUCCESS && end - j->t < 1e-12 * rest)
			j->t = end;
	}
	return status;
}

/* ---- GSL ---- */

static void open_driver(struct journey *j, int which)
{
	const gsl_odeiv2_step_type *type = !j->solvers->stiff ? gsl_odeiv2_step_rk8pd
					   : which == 0	    ? gsl_odeiv2_step_msbdf
							    : gsl_odeiv2_step_bsimp;
	double *scale = ARRAY(double, j->states);
	for (int i = 0; i < j->states; i++)
		scale[i] = scale_of(j, i);
	j->system = (gsl_odeiv2_system){ slopes, jacobian, (size_t)j->states, j };
	j->driver = need_memory(gsl_odeiv2_driver_alloc_scaled_new(&j->system, type, j->step, j->solvers->tolerance, 0,
								   1, 0, scale));
	gsl_odeiv2_driver_set_hmin(j->driver, 1e-16 * j->solvers->until);
}

/* ---- a solver ---- */

static double next_change(const struct solvers *r, double t)
{
	for (int k = 0; k < r->changes; k++)
		if (r->change[k] > t)
			return r->change[k];
	return HUGE_VAL;
}

static int travel_to(struct journey *j, int which, double end)
{
	int status = GSL_SUCCESS;
	bool own = which == 1 && !j->solvers->stiff;
	while (j->t < end && status == GSL_SUCCESS) {
		const double stop = fmin(end, j->last);
		status = own ? extrapolate_to(j, stop) : gsl_odeiv2_driver_apply(j->driver, &j->t, stop, j->y);
		if (status != GSL_SUCCESS || j->t < j->last)
			continue;
		j->first = j->t;
		j->last = next_change(j->solvers, j->t);
		j->step = 1e-3 * j->solvers->h;
		if (!own)
			gsl_odeiv2_driver_reset_hstart(j->driver, j->step);
	}
	return status;
}

/* With inputs the step after this sample begins. */
static void keep_sample(struct journey *j, struct course *course, long k)
{
	if (j->solvers->drive) {
		running_start(j->solvers->r, 0, NULL);
		running_drive(j->solvers->r, j->solvers->drive, k);
		j->sample = k;
		if (j->driver)
			gsl_odeiv2_driver_reset(j->driver);
	}
	running_start(j->solvers->r, j->t, j->y);
	running_needed(j->solvers->r, course->value + k * course->needs);
	for (int i = 0; i < j->states && j->solvers->size; i++)
		j->solvers->size[i] = fmax(j->solvers->size[i], fabs(j->y[i]));
}

static const char *reason_of(int status)
{
	return status == GSL_EBADFUNC ? "a reference would take too long"
				      : "a reference needs steps too short: the equations jump, or have no solution";
}

struct course *solved_course(struct solvers *solvers, int which, const double *start, const char **why)
{
	const struct step *step = running_step_of(solvers->r);
	size_t n = (size_t)step->model->written->system.states;
	struct journey j = { .solvers = solvers, .states = (int)n, .before = operations_so_far(solvers),
			     .step = 1e-3 * solvers->h, .last = next_change(solvers, 0) };
	struct course *course = course_of(step->model, solvers->h);
	j.y = ARRAY(double, n);
	j.u = ARRAY(double, 2 * (size_t)step->model->system.inputs + 1);
	j.work = ARRAY(double, n * (5 + COLUMNS));
	running_start(solvers->r, 0, start);
	running_state(solvers->r, j.y);
	gsl_error_handler_t *before = gsl_set_error_handler_off();
	if (which == 0 || solvers->stiff)
		open_driver(&j, which);
	int status = GSL_SUCCESS;
	keep_sample(&j, course, 0);
	for (long k = 1; k <= course->samples && status == GSL_SUCCESS; k++) {
		status = travel_to(&j, which, (double)k * solvers->h);
		keep_sample(&j, course, k);
	}
	if (j.driver)
		gsl_odeiv2_driver_free(j.driver);
	gsl_set_error_handler(before);
	if (status == GSL_SUCCESS)
		return course;
	*why = reason_of(status);
	course_free(course);
	return NULL;
}

/* ---- what solvers have found ---- */

double longest_need(const struct model *model)
{
	double until = 0;
	for (int i = 0; i < model->needs.requirements; i++)
		until = fmax(until, mpq_get_d(model->needs.requirement[i].until));
	return until;
}

struct course *course_of(const struct model *model, double h)
{
	struct course *course = NEW(struct course);
	*course = (struct course){ .needs = model->needs.requirements, .end = ARRAY(long, model->needs.requirements) };
	for (int i = 0; i < course->needs; i++) {
		course->end[i] = (long)floor(mpq_get_d(model->needs.requirement[i].until) / h * (1 + 1e-14));
		course->samples = course->end[i] > course->samples ? course->end[i] : course->samples;
	}
	course->value = ARRAY(double, (size_t)(course->samples + 1) * (size_t)course->needs);
	return course;
}

double apart(const struct course *a, const struct course *b, int need)
{
	double most = 0;
	for (long k = 0; k <= a->end[need]; k++) {
		const double d = fabs(a->value[k * a->needs + need] - b->value[k * b->needs + need]);
		most = d <= most ? most : d;
	}
	return most;
}

double largest_of(const struct course *a, int need)
{
	double most = 0;
	for (long k = 0; k <= a->end[need]; k++)
		most = fmax(most, fabs(a->value[k * a->needs + need]));
	return most;
}

void course_free(struct course *course)
{
	discard(course->value);
	discard(course->end);
	discard(course);
}
