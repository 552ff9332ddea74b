/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dormand-Prince 5(4), with its own step control. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adaptive.h"

#define DORMAND_TYPE struct adaptive
#define DORMAND_SLOPES slope
#include "dormand_step.h"

#ifndef ONE_MODEL
enum { MOST_ENTRIES = 64 };
#endif

struct dormand {
	struct adaptive adaptive;
	double tolerance;
	double t, h;                /* the end of the last step, and the step to try next */
	double from, last;          /* where the last step began, and its length */
	double before;              /* size of the error before, for the controller */
	/* of the last step; its end; of the one that is tried */
	double start[MOST_ENTRIES], y[MOST_ENTRIES], next[MOST_ENTRIES];
	double stage[7][MOST_ENTRIES], *k[7];
	double spare[MOST_ENTRIES]; /* the slope that the next step begins with */
};

static bool dormand_make(struct adaptive *a)
{
	struct dormand *d = (struct dormand *)a;
	d->tolerance = a->run.setting;
	for (int i = 0; i < 7; i++)
		d->k[i] = d->stage[i];
	return a->size <= MOST_ENTRIES;
}

static bool dormand_begin(struct adaptive *a, double t, const double *y)
{
	struct dormand *d = (struct dormand *)a;
	memcpy(d->y, y, (size_t)a->size * sizeof *y);
	memcpy(d->start, y, (size_t)a->size * sizeof *y);
	d->t = d->from = t;
	d->last = 0.0;
	d->before = 1e-4;
	slope(a, t, d->y, d->spare);
	d->h = first_step(a, 5, t, d->y, d->spare);
	return d->h > 0.0 && isfinite(d->h);
}

/* From d->y with the slope k1 there to d->next, whose slope is k7; returns the weighted error */
static double dormand_try(struct dormand *d, double h)
{
	struct adaptive *a = &d->adaptive;
	const double *y = d->y, *x = d->next;
	double sum = 0.0;
	dormand_stages(a, a->size, d->t, h, y, d->k, d->next);
	for (int i = 0; i < a->size; i++) {
		const double share = dormand_error(h, d->k, i) /
		                     (d->tolerance * (a->scale[i] + fmax(fabs(y[i]), fabs(x[i]))));
		sum += share * share;
	}
	return sqrt(sum / a->size);
}

/* The end of the step becomes the start of the next; the first slope too (first same as last), but k7 stays for the
 * interpolant */
static void dormand_accept(struct dormand *d, double h)
{
	const size_t bytes = (size_t)d->adaptive.size * sizeof *d->y;
	memcpy(d->start, d->y, bytes);
	memcpy(d->y, d->next, bytes);
	memcpy(d->spare, d->k[6], bytes);
	d->from = d->t;
	d->last = h;
	d->t += h;
}

/* Until a step is accepted, of at most `tries`; the controller is IV.2 (2.43c) of volume II, with its constants */
static bool dormand_step(struct dormand *d, int *tries)
{
	bool rejected = false;
	memcpy(d->k[0], d->spare, (size_t)d->adaptive.size * sizeof *d->spare);
	while ((*tries)-- > 0) {
		const double h = d->h, error = dormand_try(d, h);
		if (!isfinite(error) || d->t + 0.1 * h == d->t)
			return false;
		const double grow = 0.9 * pow(error, -0.17);
		if (error <= 1.0) {
			const double factor = fmin(10.0, fmax(0.2, grow * pow(d->before, 0.04)));
			d->h = h * (rejected ? fmin(1.0, factor) : factor);
			d->before = fmax(error, 1e-4);
			dormand_accept(d, h);
			return true;
		}
		rejected = true;
		d->h = h * fmax(0.2, grow);
	}
	return false;
}

static bool dormand_reach(struct adaptive *a, double end, double *y)
{
	struct dormand *d = (struct dormand *)a;
	int tries = MOST_STEPS;
	if (end < d->from)
		return false;
	while (d->t < end)
		if (!dormand_step(d, &tries))
			return false;
	dormand_inside(a->size, d->last, d->last > 0.0 ? (end - d->from) / d->last : 0.0, d->start, d->k, y);
	return true;
}

const struct solver dormand_solver = {
	.bytes = sizeof(struct dormand), .make = dormand_make, .begin = dormand_begin, .reach = dormand_reach,
	.looks_ahead = true,
};
