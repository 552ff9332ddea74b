/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models against CVODE with its root finding, on equations by hand: the solver stops at each root of the switching
 * functions, and where an input has a corner or a jump, and begins anew. */
#include "../cvode.h"
#include "drive.h"
#include "solvers_variants.h"
#include "tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { MOST_ROOTS = 4 };
static const double relative = 1e-13;       /* tolerance of CVODE */

/* side[j]: on which side of the root j it is, fixed until the next stop */
struct equations {
	int n, roots;
	void (*slopes)(double t, const double *y, double u, const bool *side, double *dydt);
	void (*distance)(double t, const double *y, double u, double *g);
};

struct solver {
	const struct equations *of;
	double u0, slope, begun;                /* input: u0 + slope (t - begun) */
	bool side[MOST_ROOTS];
	long roots;
	struct cvode cvode;
};

/* ---- by hand ---- */

static void gear1_slopes(double t, const double *y, double u, const bool *side, double *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = 0.1 + 0.05 * cos(0.8 * t) - 0.1 * y[1] - (side[0] ? y[0] - 1 : side[1] ? y[0] + 1 : 0);
}

static void gear1_distance(double t, const double *y, double u, double *g)
{
	(void)t, (void)u;
	g[0] = y[0] - 1;
	g[1] = -y[0] - 1;
}

static void two_masses_slopes(double t, const double *y, double u, const bool *side, double *dydt)
{
	const double push = side[0] ? 1e4 * (y[0] - y[1] - 0.02) + 5 * (y[2] - y[3]) : 0;
	(void)u;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = 6 * cos(8 * t) - 0.5 * y[2] - 100 * y[0] - push;
	dydt[3] = (push - 0.3 * y[3] - 200 * y[1]) / 0.5;
}

static void two_masses_distance(double t, const double *y, double u, double *g)
{
	(void)t, (void)u;
	g[0] = y[0] - y[1] - 0.02;
}

static void car_slopes(double t, const double *y, double u, const bool *side, double *dydt)
{
	const double travel = y[1] - y[0], weight = (300 + 40) * 9.81;
	const double bump = side[0] ? 90000 * (travel - 0.06) : side[1] ? 90000 * (travel + 0.05) : 0;
		const double suspension = 18000 * travel + 1200 * (y[3] - y[2]) + bump,
					 tyre = side[2] ? -weight : 180000 * (u - y[1]);
		(void)t;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = suspension / 300;
	dydt[3] = (tyre - suspension) / 40;
}

static void car_distance(double t, const double *y, double u, double *g)
{
	(void)t;
	g[0] = y[1] - y[0] - 0.06;
	g[1] = y[0] - y[1] - 0.05;
	g[2] = y[1] - u - (300 + 40) * 9.81 / 180000;
}

static void gear3_slopes(double t, const double *y, double u, const bool *side, double *dydt)
{
	const double q1 = y[0] - y[1], q2 = y[1] - y[2];
	const double F1 = 0.4 * (y[3] - y[4]) + 100 * (side[0] ? q1 - 0.01 : side[1] ? q1 + 0.01 : 0);
	const double F2 = 0.3 * (y[4] - y[5]) + 80 * (side[2] ? q2 - 0.02 : side[3] ? q2 + 0.02 : 0);
	(void)u;
	for (int i = 0; i < 3; i++)
		dydt[i] = y[3 + i];
	dydt[3] = 1 + 0.8 * cos(7 * t) - F1;
	dydt[4] = (F1 - F2) / 0.5;
	dydt[5] = (F2 - 1) / 2;
}

static void gear3_distance(double t, const double *y, double u, double *g)
{
	(void)t, (void)u;
	g[0] = y[0] - y[1] - 0.01;
	g[1] = y[1] - y[0] - 0.01;
	g[2] = y[1] - y[2] - 0.02;
	g[3] = y[2] - y[1] - 0.02;
}

/* It begins anew at every end of a step of 0.01: there loads change their formula. */
static double moving_stop(double t)
{
	return t < 1.37 ? 0.1 : t < 1.41 ? 0.1 + 5 * (t - 1.37) : t < 2.2 ? 0.3 - 0.35 / 0.79 * (t - 1.41)
								     : -0.05 + 0.1875 * (t - 2.2);
}

static double step_begun;                   /* behind it, what changes there has changed */

static void shaken_slopes(double t, const double *y, double u, const bool *side, double *dydt)
{
	const double push = side[0] ? 200 * (y[0] - moving_stop(t)) : 0, q = y[0] - y[1];
	const double shared = 4 * (side[1] ? q - 0.2 : side[2] ? q + 0.2 : 0);
	const double now = step_begun + 1e-6;
	for (int i = 0; i < 3; i++)
		dydt[i] = y[3 + i];
	dydt[3] = u + (now < 0.77 ? 2 * cos(3 * t) : -1) - 0.2 * y[3] - 9 * y[0] - push - shared;
	dydt[4] = 0.5 * u + (now < 1.39 ? 0 : 3 * exp(-t)) - 0.3 * y[4] - 4 * y[1] + shared;
	dydt[5] = u + (now < 1.5 ? 1 : now < 1.6 ? 50 : 0) - 0.1 * y[5] - 2 * y[2];
}

static void shaken_distance(double t, const double *y, double u, double *g)
{
	(void)u;
	g[0] = y[0] - moving_stop(t);
	g[1] = y[0] - y[1] - 0.2;
	g[2] = y[1] - y[0] - 0.2;
}

static const struct equations gear1 = { 2, 2, gear1_slopes, gear1_distance },
	two_masses = { 4, 1, two_masses_slopes, two_masses_distance },
	car = { 4, 3, car_slopes, car_distance }, gear3 = { 6, 4, gear3_slopes, gear3_distance },
	shaken = { 6, 3, shaken_slopes, shaken_distance };

/* ---- the solver ---- */

static double input_of(const struct solver *s, double t)
{
	return s->u0 + s->slope * (t - s->begun);
}

static int slopes(realtype t, N_Vector y, N_Vector dydt, void *from)
{
	const struct solver *s = from;
	s->of->slopes(t, N_VGetArrayPointer(y), input_of(s, t), s->side, N_VGetArrayPointer(dydt));
	return 0;
}

static int distances(realtype t, N_Vector y, realtype *g, void *from)
{
	const struct solver *s = from;
	s->of->distance(t, N_VGetArrayPointer(y), input_of(s, t), g);
	return 0;
}

static void find_sides(struct solver *s, double t)
{
	double g[MOST_ROOTS];
	s->of->distance(t, N_VGetArrayPointer(s->cvode.y), input_of(s, t), g);
	for (int j = 0; j < s->of->roots; j++)
		s->side[j] = g[j] > 0;
}

static struct solver *solver_new(const struct equations *of, const double *y, double scale)
{
	struct solver *s = calloc(1, sizeof *s);
	s->of = of;
	cvode_open(&s->cvode, CV_ADAMS, of->n, y, slopes, s, relative, relative * scale, NULL);
	CVodeRootInit(s->cvode.memory, of->roots, distances);
	find_sides(s, 0);
	return s;
}

static void solver_free(struct solver *s)
{
	cvode_close(&s->cvode);
	free(s);
}

/* An input that jumps or turns at t; counts the sides that change by it. */
static void set_input(struct solver *s, double t, double u, double slope)
{
	bool before[MOST_ROOTS];
	memcpy(before, s->side, sizeof before);
	s->begun = step_begun = t;
	s->u0 = u;
	s->slope = slope;
	CVodeReInit(s->cvode.memory, t, s->cvode.y);
	find_sides(s, t);
	for (int j = 0; j < s->of->roots; j++)
		s->roots += before[j] != s->side[j];
}

static bool solve_until(struct solver *s, double to)
{
	double t = s->begun;
	int flag = CV_ROOT_RETURN, found[MOST_ROOTS];
	while (flag == CV_ROOT_RETURN) {
		CVodeSetStopTime(s->cvode.memory, to);
		flag = CVode(s->cvode.memory, to, s->cvode.y, &t, CV_NORMAL);
		if (flag != CV_ROOT_RETURN)
			break;
		CVodeGetRootInfo(s->cvode.memory, found);
		for (int j = 0; j < s->of->roots; j++)
			if (found[j] != 0 && (found[j] > 0) != s->side[j]) {
				s->side[j] = found[j] > 0;
				s->roots++;
			}
		CVodeReInit(s->cvode.memory, t, s->cvode.y);
	}
	return flag >= 0;
}

/* ---- both ---- */

/* A road of bumps that the wheel flies off and the suspension bottoms on */
static double road(double t)
{
	return 0.09 * sin(9 * t) + 0.05 * sin(23 * t + 1);
}

struct subject {
	const char *name;
	const struct equations *of;
	int step;
	double seconds, tolerance;
	bool ramp;
};

static void compare(const struct subject *p)
{
	const struct variant *of = variant_of(solvers_table, "%s_%d", p->name, p->step);
	const pl_model *m = of->model;
	struct run r = run_new(of);
	double x[MOST_STATES], most[MOST_STATES], worst = 0, before = 0;
	bool good = true;
	run_state(&r, x);
	for (int i = 0; i < m->states; i++)
		most[i] = 1e-3;                     /* some start at 0 */
	struct solver *s = solver_new(p->of, x, 0.1);
	while (r.steps < lround(p->seconds / m->h) && good) {
			const double from = (double)r.steps * m->h, to = (double)(r.steps + 1) * m->h,
						 u = road(p->ramp ? to : from);
			if (m->inputs)
				set_input(s, from, p->ramp ? before : u, p->ramp ? (u - before) / m->h : 0);
			before = u;
			run_step(&r, m->inputs ? &u : NULL);
			good = solve_until(s, to);
			run_state(&r, x);
			for (int i = 0; i < m->states; i++) {
				const double expected = N_VGetArrayPointer(s->cvode.y)[i];
				most[i] = fmax(most[i], fabs(expected));
				good = close_to(x[i], expected, p->tolerance * most[i], "%s, h = %g, t = %g, %s",
					p->name, m->h, to,
								m->state_names[i]) &&
					   good;
				worst = worse(worst, fabs(x[i] - expected) / most[i]);
		}
	}
		ok(good, "%s, h = %g: CVODE with roots agrees over %g s (largest difference %.2g, tolerance %.0e)",
			p->name,
		   m->h, p->seconds, worst, p->tolerance);
		ok(close_to((double)of->crossed(r.state), (double)s->roots, 0, "%s, h = %g: crossings and roots",
			p->name,
					m->h),
		   "%s, h = %g: %ld crossings", p->name, m->h, s->roots);
		solver_free(s);
	run_free(&r);
}

int main(void)
{
	static const struct subject all[] = {
		{ "gear1", &gear1, 0, 50, 1e-9, false },
		{ "gear1", &gear1, 1, 50, 1e-9, false },
		{ "two_masses", &two_masses, 0, 10, 1e-8, false },
		{ "two_masses", &two_masses, 1, 10, 1e-8, false },
		{ "gear3", &gear3, 0, 5, 1e-9, false },
		{ "gear3", &gear3, 1, 5, 1e-9, false },
		{ "quarter_car_bumps", &car, 0, 3, 1e-8, true },
		{ "quarter_car_bumps", &car, 1, 3, 1e-8, true },
		{ "quarter_car_bumps", &car, 2, 3, 1e-8, true },
		{ "held", &car, 0, 3, 1e-8, false },
		{ "held", &car, 1, 3, 1e-8, false },
		{ "held", &car, 2, 3, 1e-8, false },
		{ "shaken", &shaken, 0, 4, 1e-9, false },
	};
	for (size_t i = 0; i < sizeof all / sizeof *all; i++)
		compare(&all[i]);
	return tap_end();
}
