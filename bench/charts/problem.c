/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A problem is what a model's own C says of itself: its equations as written (NAME_rhs), its start; and for a linear
 * one the matrices, found by asking the equations. */
#include "charts.h"

#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* C has no conversion from an object pointer to a function's; POSIX has, through memory. */
static void find_rhs(struct problem *p, const char *file)
{
	void *symbol = dlsym(p->handle, "subject_rhs");
	if (!symbol)
		leave(file, "no subject_rhs");
	memcpy(&p->rhs, &symbol, sizeof symbol);
}

/* y = n coordinates, then their velocities, in the same order */
static bool second_order(const pl_model *model)
{
	int n = model->states / 2;
	for (int i = 0; i < n; i++) {
		const char *q = model->state_names[i], *v = model->state_names[n + i];
		if (strncmp(q, v, strlen(q)) != 0 || strcmp(v + strlen(q), "'") != 0)
			return false;
	}
	return model->states == 2 * n;
}

static double *start_of(const pl_model *model)
{
	double *y = room_for((size_t)model->states, sizeof(double));
	void *state = room_for(1, model->size);
	model->init(state);
	model->get(state, y);
	free(state);
	return y;
}

struct problem *problem_load(const char *file, const char *name, double unit, int units, bool linear, double frequency)
{
	struct problem *p = room_for(1, sizeof *p);
	p->handle = object_open(file);
	if (!p->handle)
		leave(file, dlerror());
	p->model = dlsym(p->handle, "subject_model");
	if (!p->model)
		leave(file, "no subject_model");
	if (!second_order(p->model) || p->model->inputs > 0)
		leave(file, "its states are not coordinates and their velocities, or it has inputs");
	find_rhs(p, file);
	p->name = name;
	p->n = p->model->states / 2;
	p->start = start_of(p->model);
	p->unit = unit;
	p->units = units;
	p->w = frequency;
	if (linear)
		problem_linear(p);
	return p;
}

/* The loads: at rest the slope is b0 + b1 cos(w t) + b2 sin(w t). */
static void ask_loads(struct problem *p, const double *y)
{
	const double turn = p->w > 0 ? 2 * M_PI / p->w : 0;
	int size = 2 * p->n;
	double at_start[size], at_half[size], at_quarter[size];
	problem_slope(p, 0, y, at_start);
	problem_slope(p, turn / 2, y, at_half);
	problem_slope(p, turn / 4, y, at_quarter);
	for (int i = 0; i < size; i++) {
		p->b0[i] = (at_start[i] + at_half[i]) / 2;
		p->b1[i] = (at_start[i] - at_half[i]) / 2;
		p->b2[i] = at_quarter[i] - p->b0[i];
	}
}

/* What the cosine of a rounded quarter turn leaves where there is no load */
static void clean_loads(struct problem *p)
{
	double *const loads[] = { p->b0, p->b1, p->b2 };
	double most = 0;
	for (int i = 0; i < 6 * p->n; i++)
		most = fmax(most, fabs(loads[i % 3][i / 3]));
	for (int i = 0; i < 6 * p->n; i++)
		if (fabs(loads[i % 3][i / 3]) < 1e-14 * most)
			loads[i % 3][i / 3] = 0;
}

/* A column: the slope at a unit state, less that at rest. */
static void ask_matrix(struct problem *p, double *y)
{
	int size = 2 * p->n;
	double at_rest[size], slope[size];
	problem_slope(p, 0, y, at_rest);
	for (int j = 0; j < size; j++) {
		y[j] = 1;
		problem_slope(p, 0, y, slope);
		for (int i = 0; i < size; i++)
			p->A[i * size + j] = slope[i] - at_rest[i];
		y[j] = 0;
	}
}

void problem_linear(struct problem *p)
{
	int size = 2 * p->n;
	if (p->A)
		return;
	double *y = room_for((size_t)size, sizeof *y);
	p->linear = true;
	p->A = room_for((size_t)(size * size), sizeof(double));
	p->b0 = room_for((size_t)size, sizeof(double));
	p->b1 = room_for((size_t)size, sizeof(double));
	p->b2 = room_for((size_t)size, sizeof(double));
	ask_loads(p, y);
	clean_loads(p);
	ask_matrix(p, y);
	free(y);
}

void problem_free(struct problem *p)
{
	if (p->handle) {
		dlclose(p->handle);
		free((double *)p->start);
	}
	free(p->A);
	free(p->b0);
	free(p->b1);
	free(p->b2);
	free(p);
}
