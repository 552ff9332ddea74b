/* SPDX-License-Identifier: GPL-3.0-or-later */
/* DOP853: the explicit pair of order 8 with errors of order 5 and 3 and an interpolant of order 7 (Hairer, Norsett,
 * Wanner, Solving Ordinary Differential Equations I, II.5 and II.6), with its own step control. Outputs are read from
 * the interpolant, whose three stages are taken in steps that hold an output only. The smooth models have an instance
 * each with the right-hand side compiled in; all others go through NAME_rhs. The chart of any spec (own/kept.h)
 * includes this file for one model, with ONE_MODEL and what an instance is made of. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adaptive.h"
#include "dop853_table.h"

#ifndef ONE_MODEL
#include "equations.h"
enum { MOST_ENTRIES = 64 };
#endif

struct dop853 {
	struct adaptive adaptive;
	const struct instance *instance;
	double tolerance;
	double t, h;                            /* the end of the last step, and the step to try next */
	double from, last;                      /* where the last step began, and its length */
	double y[MOST_ENTRIES], slope[MOST_ENTRIES];            /* at t */
	double dense[8][MOST_ENTRIES];
};

/* ---- the instances ---- */

#ifdef ONE_MODEL
#define EQUATIONS(ROW)
#else
#define STEPPER "dop853_step.h"
#include "instances.h"

static inline void ask(struct adaptive *a, double t, const double *y, double *f)
{
	slope(a, t, y, f);
	a->run.asked--;               /* counted by the stepper */
}

#define SIZE d->adaptive.size
#define EXTENT (MOST_ENTRIES / 2)
#define SLOPES(t, y, f) ask(&d->adaptive, t, y, f)
#endif

#define INSTANCE(part) other_##part
#include "dop853_step.h"

struct instance {
	const char *name;
	bool (*reach)(struct adaptive *a, double end, double *y);
	bool (*walk)(struct adaptive *a, int units, double *rows);
};
#define ROW(NAME, COORDINATES) { #NAME, NAME##_reach, NAME##_walk },
static const struct instance instances[] = { EQUATIONS(ROW) { NULL, other_reach, other_walk } };

/* ---- as adaptive.h has it ---- */

/* A right-hand side that is counted, or has another name, is asked */
static const struct instance *instance_of(const struct problem *p)
{
	const struct instance *i = instances;
	while (i->name && (p->rhs_of || strcmp(i->name, p->name) != 0))
		i++;
	return i;
}

static bool dop853_make(struct adaptive *a)
{
	struct dop853 *d = (struct dop853 *)a;
	if (a->size > MOST_ENTRIES)
		return false;
	d->tolerance = a->run.setting;
	d->instance = instance_of(a->run.problem);
	a->walk = d->instance->walk;
	return true;
}

static bool dop853_begin(struct adaptive *a, double t, const double *y)
{
	struct dop853 *d = (struct dop853 *)a;
	memcpy(d->y, y, (size_t)a->size * sizeof *y);
	memcpy(d->dense[0], y, (size_t)a->size * sizeof *y);
	d->t = d->from = t;
	d->last = 0.0;
	slope(a, t, d->y, d->slope);
	d->h = first_step(a, 8, t, d->y, d->slope);
	return d->h > 0.0 && isfinite(d->h);
}

static bool dop853_reach(struct adaptive *a, double end, double *y)
{
	struct dop853 *d = (struct dop853 *)a;
	return end >= d->from && d->instance->reach(a, end, y);
}

static const struct solver dop853_solver = {
	.bytes = sizeof(struct dop853), .make = dop853_make, .begin = dop853_begin, .reach = dop853_reach,
	.looks_ahead = true,
};

const struct kind dop853 = {
	.method = BY_TOLERANCE("DOP853", 8,
	                       "8(5,3) pair of Hairer, Norsett and Wanner with their step control, output from its "
	                       "interpolant of order 7; on smooth models the right-hand side is compiled into it"),
	.solver = &dop853_solver,
};
