/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run, as charts.h has it, of a scheme with a fixed step (fixed.h). */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "fixed.h"

static void prepare(struct fixed *f, struct part *p, double h)
{
	if (f->linear && p->h != h) {
		p->h = h;
		scheme_of(f)->prepare(scheme_of(f), f->run.problem, p);
	}
	p->h = h;
	p->first.stale = true;
}

static void fixed_restart(struct run *run)
{
	struct fixed *f = (struct fixed *)run;
	const size_t n = (size_t)f->n;
	memcpy(f->state, run->problem->start, 2 * n * sizeof *f->state);
	f->units = f->run.asked = 0;
	f->failed = false;
	f->scale_q = f->scale_v = 0.0;
	if (scheme_of(f)->keeps_acceleration) {
		slope(f, 0.0, f->state, f->work[0]);
		memcpy(f->state + 2 * n, f->work[0] + n, n * sizeof *f->state);
	}
	f->every.first.stale = true;
}

/* Whole steps, then one of what is left of `fraction` */
static void fixed_between(struct run *run, double fraction, double *y)
{
	struct fixed *f = (struct fixed *)run;
	const struct fixed kept = *f;
	const double t = (double)f->units * run->problem->unit;
	const int whole = (int)floor(fraction * f->steps + 1e-9);
	const double rest = fraction * run->problem->unit - whole * f->h;
	step_function *step = f->linear ? scheme_of(f)->linear.step : scheme_of(f)->plain.step;
	struct part *part = f->linear ? &f->every : &f->rest;
	bool good = !f->failed;
	memcpy(f->ahead, f->state, 3 * (size_t)f->n * sizeof *f->state);
	if (whole > 0)
		prepare(f, part, f->h);
	for (int k = 0; k < whole && good; k++)
		good = step(f, part, t + k * f->h, f->ahead);
	if (good && rest > 1e-9 * f->h) {
		prepare(f, &f->rest, rest);
		good = step(f, &f->rest, t + whole * f->h, f->ahead);
	}
	f->run.asked = kept.run.asked;
	f->scale_q = kept.scale_q;
	f->scale_v = kept.scale_v;
	for (int i = 0; i < 2 * f->n; i++)
		y[i] = good ? f->ahead[i] : NAN;
}

static void fixed_close(struct run *run)
{
	struct fixed *f = (struct fixed *)run;
	free(f->memory);
	free(f->rows);
	free(f);
}

/* Vectors and matrices stand in one block of memory */
static double *take(double **next, size_t count)
{
	double *room = *next;
	*next += count;
	return room;
}

static void allot_part(struct fixed *f, struct part *p, double **next, int *rows)
{
	const size_t n = (size_t)f->n, m = (size_t)scheme_of(f)->unknowns * n;
	struct factors *each[] = {&p->first, &p->second};
	for (int i = 0; i < 2; i++)
		*each[i] = (struct factors){.size = (int)m, .matrix = take(next, m * m), .row = rows + i * (int)m};
	p->to_velocity = take(next, n * n);
	p->to_place = take(next, n * n);
	p->loads = take(next, n * n);
	p->before = take(next, n * n);
	p->c = scheme_of(f)->c;
}

static bool allot(struct fixed *f)
{
	const size_t n = (size_t)f->n, m = (size_t)scheme_of(f)->unknowns * n;
	double *next = f->memory = calloc((3 + 3 + 2 * WORK + 2) * n + 4 * m * m + 8 * n * n, sizeof *next);
	f->rows = calloc(4 * m + 1, sizeof *f->rows);
	if (!f->memory || !f->rows)
		return false;
	f->state = take(&next, 3 * n);
	f->ahead = take(&next, 3 * n);
	for (int i = 0; i < WORK; i++)
		f->work[i] = take(&next, 2 * n);
	f->weight = take(&next, 2 * n);
	allot_part(f, &f->every, &next, f->rows);
	allot_part(f, &f->rest, &next, f->rows + 2 * m);
	return true;
}

struct run *fixed_open(const struct method *method, const struct problem *problem, double setting)
{
	const struct scheme *scheme = (const struct scheme *)method;
	const int steps = steps_of(problem, setting);
	const bool linear = scheme->wants_linear && scheme->wants_linear(problem);
	const struct way *way = linear ? &scheme->linear : &scheme->plain;
	struct fixed *f = steps > 0 && way->step && 2 * problem->n <= MOST_ENTRIES ? calloc(1, sizeof *f) : NULL;
	if (!f)
		return NULL;
	f->run = (struct run){.method = method, .problem = problem, .restart = fixed_restart, .advance = way->advance,
	                      .between = fixed_between, .get = run_get, .evaluations = run_evaluations,
	                      .close = fixed_close};
	f->rhs = asked_of(problem);
	f->n = problem->n;
	f->linear = linear;
	f->steps = steps;
	f->run.setting = f->h = problem->unit / steps;
	if (!allot(f)) {
		fixed_close(&f->run);
		return NULL;
	}
	f->run.now = f->state;
	prepare(f, &f->every, f->h);
	fixed_restart(&f->run);
	return &f->run;
}
