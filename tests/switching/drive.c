/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drive.h"
#include "tap.h"
#include "worse.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct variant *variant_of(const struct variant *table, const char *format, ...)
{
	char name[200];
	va_list arguments;
	va_start(arguments, format);
	vsnprintf(name, sizeof name, format, arguments);
	va_end(arguments);
	for (; table->model; table++)
		if (strcmp(table->model->name, name) == 0)
			return table;
	printf("Bail out! no variant %s\n", name);
	exit(99);
}

struct run run_new(const struct variant *of)
{
	struct run r = { of, calloc(1, of->model->size), 0 };
	of->model->init(r.state);
	return r;
}

void run_free(struct run *r)
{
	free(r->state);
}

void run_set(struct run *r, const double *y)
{
	r->of->model->set(r->state, 0, y);
	r->steps = 0;
}

void run_step(struct run *r, const double *u)
{
	r->of->model->step(r->state, u);
	r->steps++;
}

void run_until(struct run *r, double t)
{
	const long last = lround(t / r->of->model->h);
	while (r->steps < last)
		run_step(r, NULL);
}

void run_state(const struct run *r, double *y)
{
	r->of->model->get(r->state, y);
}

int run_crossings(struct run *r, double t, int most, double *time, pl_crossing *crossing)
{
	const long last = lround(t / r->of->model->h);
	pl_crossing now[MOST_EVENTS];
	int count = 0;
	while (r->steps < last) {
		const double begun = r->of->model->time(r->state);
		run_step(r, NULL);
		const int found = r->of->crossings(r->state, now);
		for (int i = 0; i < found && count < most; i++, count++) {
			crossing[count] = now[i];
			time[count] = begun + now[i].time;
		}
	}
	return count;
}

bool same_numbers(const double *a, const double *b, int count, double tolerance, double *worst, const char *name,
		  double t)
{
	bool good = true;
	for (int i = 0; i < count; i++) {
		*worst = worse(*worst, fabs(a[i] - b[i]));
		good = close_to(a[i], b[i], tolerance, "%s, t = %g: number %d", name, t, i) && good;
	}
	return good;
}

void goes_on_when_set(const struct variant *of, int steps)
{
	struct run came = run_new(of), set = run_new(of);
	const pl_model *model = of->model;
	double y[MOST_STATES], z[MOST_STATES], worst = 0;
	const double u = 0.3;
	bool good = true;
	for (int k = 0; k < steps; k++)
		run_step(&came, &u);
	run_step(&set, &u);
	run_state(&came, y);
	model->set(set.state, model->time(came.state), y);
	for (int k = 0; k < 200; k++) {
		run_step(&came, &u);
		run_step(&set, &u);
		run_state(&came, y);
		run_state(&set, z);
		good = same_numbers(z, y, model->states, 1e-13, &worst, "set", model->time(came.state)) && good;
	}
	ok(good, "set to t = %g: goes on, to %.2g", steps * model->h, worst);
	run_free(&came);
	run_free(&set);
}
