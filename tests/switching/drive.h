/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run of a variant, with what it crosses. */
#ifndef DRIVE_H
#define DRIVE_H

#include "variant.h"

#include <stdbool.h>

/* The variant of this name; a test that asks for one that was not made cannot go on. */
const struct variant *variant_of(const struct variant *table, const char *format, ...);

struct run {
	const struct variant *of;
	void *state;
	long steps;
};

struct run run_new(const struct variant *of);                           /* after init */
void run_free(struct run *r);
void run_set(struct run *r, const double *y);                           /* at t = 0 */
void run_step(struct run *r, const double *u);
void run_until(struct run *r, double t);                                /* no inputs; t: a multiple of the step */
void run_state(const struct run *r, double *y);

/* Steps without inputs up to t (a multiple of the step), noting the times of crossings since 0; how many. At most
 * `most`. */
int run_crossings(struct run *r, double t, int most, double *time, pl_crossing *crossing);

/* Are as many numbers the same to the tolerance? *worst: how far any are apart */
bool same_numbers(const double *a, const double *b, int count, double tolerance, double *worst, const char *name,
		  double t);

/* Set to the time after so many steps with an input, also from elsewhere, it goes on as if it had come there. */
void goes_on_when_set(const struct variant *of, int steps);

#endif
