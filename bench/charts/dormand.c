/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dormand-Prince 5(4): Hairer, Norsett, Wanner, Solving Ordinary Differential Equations I, table II.5.2, written
 * plainly. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adaptive.h"

struct dormand {
	struct adaptive adaptive;
	double tolerance;
	double t, h;                /* the end of the last step, and the step to try next */
	double from, last;          /* where the last step began, and its length */
	double before;              /* size of the error before, for the controller */
	double *start, *y, *next;   /* of the last step; its end; of the one that is tried */
	double *k[7];
	double *spare;              /* the slope that the next step begins with */
};

static bool dormand_make(struct adaptive *a)
{
	struct dormand *d = (struct dormand *)a;
	const size_t size = (size_t)a->size;
	double *next = d->start = calloc(11 * size, sizeof *next);
	if (!next)
		return false;
	d->tolerance = a->run.setting;
	d->y = next += size;
	d->next = next += size;
	for (int i = 0; i < 7; i++)
		d->k[i] = next += size;
	d->spare = next + size;
	return true;
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
	const int size = a->size;
	const double t = d->t, *restrict y = d->y;
	double *restrict k1 = d->k[0], *restrict k2 = d->k[1], *restrict k3 = d->k[2], *restrict k4 = d->k[3],
		*restrict k5 = d->k[4];
	double *restrict k6 = d->k[5], *restrict k7 = d->k[6], *restrict x = d->next;
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (1.0 / 5.0 * k1[i]);
	slope(a, t + h * (1.0 / 5.0), x, k2);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (3.0 / 40.0 * k1[i] + 9.0 / 40.0 * k2[i]);
	slope(a, t + h * (3.0 / 10.0), x, k3);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (44.0 / 45.0 * k1[i] - 56.0 / 15.0 * k2[i] + 32.0 / 9.0 * k3[i]);
	slope(a, t + h * (4.0 / 5.0), x, k4);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (19372.0 / 6561.0 * k1[i] - 25360.0 / 2187.0 * k2[i] + 64448.0 / 6561.0 * k3[i] -
		                   212.0 / 729.0 * k4[i]);
	slope(a, t + h * (8.0 / 9.0), x, k5);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (9017.0 / 3168.0 * k1[i] - 355.0 / 33.0 * k2[i] + 46732.0 / 5247.0 * k3[i] +
		                   49.0 / 176.0 * k4[i] - 5103.0 / 18656.0 * k5[i]);
	slope(a, t + h, x, k6);
	for (int i = 0; i < size; i++)
		x[i] = y[i] + h * (35.0 / 384.0 * k1[i] + 500.0 / 1113.0 * k3[i] + 125.0 / 192.0 * k4[i] -
		                   2187.0 / 6784.0 * k5[i] + 11.0 / 84.0 * k6[i]);
	slope(a, t + h, x, k7);
	double sum = 0.0;
	for (int i = 0; i < size; i++) {
		const double error = h * (71.0 / 57600.0 * k1[i] - 71.0 / 16695.0 * k3[i] + 71.0 / 1920.0 * k4[i] -
		                          17253.0 / 339200.0 * k5[i] + 22.0 / 525.0 * k6[i] - 1.0 / 40.0 * k7[i]);
		const double share = error / (d->tolerance * (a->scale[i] + fmax(fabs(y[i]), fabs(x[i]))));
		sum += share * share;
	}
	return sqrt(sum / size);
}

/* The end of the step becomes the start of the next; the first slope too (first same as last), but k7 stays for the
 * interpolant */
static void dormand_accept(struct dormand *d, double h)
{
	double *start = d->start;
	d->start = d->y;
	d->y = d->next;
	d->next = start;
	d->from = d->t;
	d->last = h;
	d->t += h;
	memcpy(d->spare, d->k[6], (size_t)d->adaptive.size * sizeof *d->spare);
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

/* Of fourth order, from the stages that there are: II.6 of volume I; the same as that of ode45 */
static void dormand_interpolate(const struct dormand *d, double t, double *y)
{
	const double x = d->last > 0.0 ? (t - d->from) / d->last : 0.0, h = d->last * x;
	const double b1 = h * (1.0 + x * (-183.0 / 64.0 + x * (37.0 / 12.0 - x * (145.0 / 128.0))));
	const double b3 = h * x * (1500.0 / 371.0 + x * (-1000.0 / 159.0 + x * (1000.0 / 371.0)));
	const double b4 = h * x * (-125.0 / 32.0 + x * (125.0 / 12.0 - x * (375.0 / 64.0)));
	const double b5 = h * x * (9477.0 / 3392.0 + x * (-729.0 / 106.0 + x * (25515.0 / 6784.0)));
	const double b6 = h * x * (-11.0 / 7.0 + x * (11.0 / 3.0 - x * (55.0 / 28.0)));
	const double b7 = h * x * (3.0 / 2.0 + x * (-4.0 + x * (5.0 / 2.0)));
	for (int i = 0; i < d->adaptive.size; i++)
		y[i] = d->start[i] + (b1 * d->k[0][i] + b3 * d->k[2][i] + b4 * d->k[3][i] + b5 * d->k[4][i] +
		                      b6 * d->k[5][i] + b7 * d->k[6][i]);
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
	dormand_interpolate(d, end, y);
	return true;
}

static void dormand_discard(struct adaptive *a)
{
	struct dormand *d = (struct dormand *)a;
	double *block = d->start;   /* the three states change places */
	if (d->y && d->y < block)
		block = d->y;
	if (d->next && d->next < block)
		block = d->next;
	free(block);
}

const struct solver dormand_solver = {
	.bytes = sizeof(struct dormand), .make = dormand_make, .begin = dormand_begin, .reach = dormand_reach,
	.looks_ahead = true,
	.discard = dormand_discard,
};
