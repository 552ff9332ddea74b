/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Errors of scheme taylor by steps: each row of variants.h (orders.sh) beside the motion of the first one, from STARTS
 * starts along it. Prints for each of the others its order, its steps, the error (root of the mean of squares over
 * starts, states and whole seconds, over the largest state), the events from the first start, and whether all runs met
 * those of the first row with no status. */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include "variants.h"

#ifndef STARTS
#define STARTS 48
#endif
enum { MOST = 16 };

struct run {
	double y[STARTS][SECONDS][MOST];
	unsigned long events[STARTS];
	int status;
};

/* The first row's motion, step by step. Start j is 7 j steps along it, so that events fall elsewhere in steps. */
enum { APART = 7 };
static double (*motion)[MOST];
static unsigned long *met;          /* events so far */

static void follow(const struct variant *v)
{
	const int steps = APART * (STARTS - 1) + v->steps;
	void *s = calloc(1, v->size);
	motion = calloc((size_t)steps + 1, sizeof *motion);
	met = calloc((size_t)steps + 1, sizeof *met);
	if (!s || !motion || !met || v->states > MOST)
		exit(1);
	v->init(s);
	for (int k = 0; k <= steps; k++) {
		v->get(s, motion[k]);
		met[k] = v->crossed(s);
		if (k < steps)
			v->step(s);
	}
	if (v->status(s) != 0)
		exit(1);
	free(s);
}

/* What runs from each start have to come to */
static void find_exact(const struct variant *v, struct run *run)
{
	const int second = v->steps / SECONDS;
	follow(v);
	for (int j = 0; j < STARTS; j++) {
		for (int k = 0; k < SECONDS; k++)
			memcpy(run->y[j][k], motion[APART * j + (k + 1) * second], sizeof run->y[j][k]);
		run->events[j] = met[APART * j + v->steps] - met[APART * j];
	}
}

static void run_from(const struct variant *v, void *s, int j, double y[SECONDS][MOST])
{
	v->init(s);
	v->set(s, (double)APART * j * SECONDS / variant[0].steps, motion[APART * j]);
	for (int k = 1; k <= v->steps; k++) {
		v->step(s);
		if (k * SECONDS % v->steps == 0)
			v->get(s, y[k * SECONDS / v->steps - 1]);
	}
}

static void run_all(const struct variant *v, struct run *run)
{
	void *s = calloc(1, v->size);
	if (!s || v->states > MOST)
		exit(1);
	for (int j = 0; j < STARTS; j++) {
		run_from(v, s, j, run->y[j]);
		run->events[j] = v->crossed(s);
		run->status |= v->status(s);
	}
	free(s);
}

int main(void)
{
	static struct run exact, run, none;
	const int states = variant[0].states;
	double largest = 0;
	find_exact(&variant[0], &exact);
	for (int j = 0; j < STARTS; j++)
		for (int k = 0; k < SECONDS; k++)
			for (int i = 0; i < states; i++)
				largest = fmax(largest, fabs(exact.y[j][k][i]));
	for (size_t v = 1; v < sizeof variant / sizeof *variant; v++) {
		double sum = 0;
		int same = 1;
		run = none;
		run_all(&variant[v], &run);
		for (int j = 0; j < STARTS; j++) {
			for (int k = 0; k < SECONDS; k++)
				for (int i = 0; i < states; i++)
					sum += pow((run.y[j][k][i] - exact.y[j][k][i]) / largest, 2);
			same = same && run.events[j] == exact.events[j];
		}
		printf("%d %d %.4g %lu %s\n", variant[v].order, variant[v].steps,
		       sqrt(sum / (STARTS * SECONDS * states)), exact.events[0],
		       same && run.status == 0 ? "yes" : "no");
	}
	return 0;
}
