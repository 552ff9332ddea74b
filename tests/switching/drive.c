/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "drive.h"

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
