/* SPDX-License-Identifier: GPL-3.0-or-later */
/* plgen's own code as a method: a shared object of one variant, driven through its descriptor as a user would drive
 * it. */
#include "charts.h"

#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

struct generated {
	struct run run;             /* first: a struct run is this */
	void *handle;
	const pl_model *model;      /* one of the two */
	const pl_modelf *single;
	void *state, *copy;         /* copy: for what lies between */
	size_t size;
	double h;                   /* step [s] as the model has it */
	int steps;                  /* in a unit */
	bool rows_are_states;       /* NAME_run then writes what is wanted */
	float *row;                 /* of a float: rows on their way to double */
	int rows;                   /* room in row */
	int evaluations;            /* of the remainder in a step, or -1 */
	long taken;                 /* steps since the start */
};

/* etd1 and pl: r0. etdrk2: r at two states, etdrk4: at four. The quadratures: r at each node, and at those after the
 * first three more right-hand sides of an RK4 step that begins at r0. */
int remainder_evaluations(const char *scheme)
{
	static const struct { const char *name; int evaluations; } schemes[] = {
		{ "pl", 1 }, { "etd1", 1 }, { "etdrk2", 2 }, { "etdrk4", 4 }, { "nc2", 3 + 2 * 3 },
		{ "nc3", 4 + 3 * 3 }, { "dq4", 4 + 3 * 3 },
		{ "bm3", 4 + 3 * 3 }
	};
	for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++)
		if (strcmp(schemes[i].name, scheme) == 0)
			return schemes[i].evaluations;
	return -1;
}

/* What both kinds of descriptor have under one name */
#define OF(g, member) ((g)->single ? (g)->single->member : (g)->model->member)

static struct generated *of(struct run *run)
{
	return (struct generated *)run;
}

static const struct generated *of_const(const struct run *run)
{
	return (const struct generated *)run;
}

static void restart(struct run *run)
{
	struct generated *g = of(run);
	OF(g, init)(g->state);
	g->taken = 0;
}

static void widen(const float *from, double *to, size_t count)
{
	for (size_t i = 0; i < count; i++)
		to[i] = from[i];
}

static void get_state(const struct generated *g, const void *state, double *y)
{
	float narrow[2 * g->run.problem->n];
	if (g->model) {
		g->model->get(state, y);
		return;
	}
	g->single->get(state, narrow);
	widen(narrow, y, (size_t)(2 * g->run.problem->n));
}

static void get(const struct run *run, double *y)
{
	get_state(of_const(run), of_const(run)->state, y);
}

static bool good(const struct generated *g)
{
	int (*status)(const void *s) = OF(g, status);
	return !status || status(g->state) == 0;
}

static void take_steps(const struct generated *g, void *state, int steps)
{
	if (g->single)
		g->single->run(state, (size_t)steps, NULL, NULL);
	else
		g->model->run(state, (size_t)steps, NULL, NULL);
}

static void make_room(struct generated *g, int units)
{
	if (units <= g->rows)
		return;
	free(g->row);
	g->rows = units;
	g->row = room_for((size_t)units * 2 * (size_t)g->run.problem->n, sizeof *g->row);
}

/* One unit is one step and a row is the state: one call. */
static void run_rows(struct generated *g, int units, double *rows)
{
	if (g->model) {
		g->model->run(g->state, (size_t)units, NULL, rows);
		return;
	}
	make_room(g, units);
	g->single->run(g->state, (size_t)units, NULL, g->row);
	widen(g->row, rows, (size_t)units * 2 * (size_t)g->run.problem->n);
}

static bool advance(struct run *run, int units, double *rows)
{
	struct generated *g = of(run);
	g->taken += (long)units * g->steps;
	if (!rows) {
		take_steps(g, g->state, units * g->steps);
	} else if (g->steps == 1 && g->rows_are_states) {
		run_rows(g, units, rows);
	} else {
		for (int i = 0; i < units; i++, rows += 2 * run->problem->n) {
			take_steps(g, g->state, g->steps);
			get(run, rows);
		}
	}
	return good(g);
}

/* Of a float, rows stay as its user has them. */
static bool advance_single(struct run *run, int units)
{
	struct generated *g = of(run);
	make_room(g, units);
	g->taken += (long)units * g->steps;
	if (g->steps == 1 && g->rows_are_states) {
		g->single->run(g->state, (size_t)units, NULL, g->row);
	} else {
		for (int i = 0; i < units; i++) {
			take_steps(g, g->state, g->steps);
			g->single->get(g->state, g->row + i * 2 * run->problem->n);
		}
	}
	return good(g);
}

/* Where a scheme has nothing for the inside of a step: the polynomial of degree 5 through the coordinates at its ends
 * with their velocities and accelerations (Hermite), and its slope for the velocities. */
static void hermite(const struct generated *g, void *state, double t, double tau, double *y)
{
	const int n = g->run.problem->n;
	const double h = g->h, s = tau / h;
	double from[2 * n], to[2 * n], from_slope[2 * n], to_slope[2 * n];
	get_state(g, state, from);
	take_steps(g, state, 1);
	get_state(g, state, to);
	problem_slope(g->run.problem, t, from, from_slope);
	problem_slope(g->run.problem, t + h, to, to_slope);
	for (int i = 0; i < n; i++) {
		/* Coefficients of s^3, s^4, s^5 from what the first three leave to be met at the end */
		const double v = h * from[n + i], a = h * h * from_slope[n + i] / 2;
		const double end = to[i] - from[i] - v - a, end_v = h * to[n + i] - v - 2 * a,
			end_a = h * h * to_slope[n + i] - 2 * a;
		const double c3 = 10 * end - 4 * end_v + end_a / 2, c4 = -15 * end + 7 * end_v - end_a,
			c5 = 6 * end - 3 * end_v + end_a / 2;
		y[i] = from[i] + s * (v + s * (a + s * (c3 + s * (c4 + s * c5))));
		y[n + i] = (v + s * (2 * a + s * (3 * c3 + s * (4 * c4 + s * 5 * c5)))) / h;
	}
}

/* As a part of a run's settings */
const char *generated_between(const struct run *run)
{
	const struct generated *g = of_const(run);
	return OF(g, at != NULL) ? "inside a step NAME_at"
	       : "inside a step Hermite's polynomial of degree 5 with NAME_rhs";
}

static void inside_step(const struct generated *g, void *state, double t, double tau, double *y)
{
	float narrow[2 * g->run.problem->n];
	if (tau <= 0) {
		get_state(g, state, y);
	} else if (g->model && g->model->at) {
		g->model->at(state, NULL, tau, y);
	} else if (g->single && g->single->at) {
		g->single->at(state, NULL, (float)tau, narrow);
		widen(narrow, y, (size_t)(2 * g->run.problem->n));
	} else {
		hermite(g, state, t, tau, y);
	}
}

static void between(struct run *run, double fraction, double *y)
{
	struct generated *g = of(run);
	double whole = floor(fraction * g->steps + 1e-9), rest = fraction * g->steps - whole;
	memcpy(g->copy, g->state, g->size);
	take_steps(g, g->copy, (int)whole);
	inside_step(g, g->copy, ((double)g->taken + whole) / g->steps * run->problem->unit,
	            rest < 1e-9 ? 0 : rest * g->h, y);
}

static long evaluations(const struct run *run)
{
	const struct generated *g = of_const(run);
	return g->evaluations < 0 ? -1 : g->evaluations * g->taken;
}

static void close_run(struct run *run)
{
	struct generated *g = of(run);
	free(g->state);
	free(g->copy);
	free(g->row);
	if (g->handle)
		dlclose(g->handle);
	free(g);
}

/* Among the options `--scheme NAME` */
static int evaluations_of(const char *options)
{
	char scheme[32] = "exact";
	const char *found = options ? strstr(options, "--scheme ") : NULL;
	if (found)
		sscanf(found, "--scheme %31s", scheme);
	return remainder_evaluations(scheme);
}

static bool load(struct generated *g, const char *file)
{
	g->handle = object_open(file);
	const void *model = g->handle ? dlsym(g->handle, "subject_model") : NULL;
	if (!model)
		return false;
	const char *options = dlsym(g->handle, "subject_options");
	g->evaluations = evaluations_of(options);
	if (options && strstr(options, "--real float")) {
		g->single = model;
		g->run.timed = advance_single;
	} else {
		g->model = model;
	}
	g->h = OF(g, h);
	g->size = OF(g, size);
	g->rows_are_states = same_names(OF(g, states), OF(g, outputs), OF(g, state_names), OF(g, output_names));
	return OF(g, states) == 2 * g->run.problem->n;
}

static bool divides(struct generated *g)
{
	g->steps = (int)lround(g->run.problem->unit / g->h);
	return g->steps >= 1 && fabs(g->steps * g->h / g->run.problem->unit - 1) < (g->single ? 1e-6 : 1e-14);
}

struct run *generated_open(const struct method *method, const struct problem *problem, const char *file)
{
	struct generated *g = room_for(1, sizeof *g);
	g->run = (struct run){ .method = method, .problem = problem, .restart = restart, .advance = advance,
	                       .between = between, .get = get,
	                       .evaluations = evaluations, .close = close_run };
	if (!load(g, file) || !divides(g)) {
		close_run(&g->run);
		return NULL;
	}
	g->run.setting = g->h;
	g->state = room_for(1, g->size);
	g->copy = room_for(1, g->size);
	restart(&g->run);
	return &g->run;
}
