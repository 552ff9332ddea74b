/* SPDX-License-Identifier: GPL-3.0-or-later */
/* switching NAME: times of a step of a piecewise-linear model without a crossing and with one, beside a step of the
 * same model without stops, in short samples that take turns so that all meet the same machine; prints medians and
 * ratios. */
#include "plrt.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

extern const pl_model plain_model, stops_model;
uint64_t crossed(const void *s);

enum { SAMPLES = 501, STEPS = 20, LOOKED_AT = 200000 };

static double nanoseconds(void)
{
	struct timespec t;
	clock_gettime(CLOCK_MONOTONIC, &t);
	return 1e9 * (double)t.tv_sec + (double)t.tv_nsec;
}

static double sample_run(const pl_model *m, void *state, const void *saved)
{
	memcpy(state, saved, m->size);
	double start = nanoseconds();
	for (int k = 0; k < STEPS; k++)
		m->step(state, NULL);
	return (nanoseconds() - start) / STEPS;
}

/* The same step again and again: the state is put back before each */
static double sample_again(const pl_model *m, void *state, const void *saved, int step)
{
	double start = nanoseconds();
	for (int k = 0; k < STEPS; k++) {
		memcpy(state, saved, m->size);
		__asm__ volatile("" : : "r"(state) : "memory");
		if (step)
			m->step(state, NULL);
	}
	return (nanoseconds() - start) / STEPS;
}

/* A state from which `steps` steps cross `crossings` breakpoints */
static int find(void *state, int steps, uint64_t crossings, void *saved)
{
	void *ahead = malloc(stops_model.size);
	int found = 0;
	stops_model.init(state);
	for (int k = 0; k < LOOKED_AT && !found; k++) {
		memcpy(ahead, state, stops_model.size);
		for (int i = 0; i < steps; i++)
			stops_model.step(ahead, NULL);
		found = crossed(ahead) - crossed(state) == crossings;
		memcpy(saved, state, stops_model.size);
		stops_model.step(state, NULL);
	}
	free(ahead);
	return found;
}

static int ascending(const void *a, const void *b)
{
	double x = *(const double *)a, y = *(const double *)b;
	return (x > y) - (x < y);
}

static double median(double *time)
{
	qsort(time, SAMPLES, sizeof *time, ascending);
	return time[SAMPLES / 2];
}

int main(int argc, char **argv)
{
	static double linear[SAMPLES], clear[SAMPLES], one[SAMPLES], copy[SAMPLES];
	void *state = malloc(stops_model.size), *between = malloc(stops_model.size), *before = malloc(stops_model.size);
	void *plain = malloc(plain_model.size), *begin = malloc(plain_model.size);
	if (argc != 2 || !find(state, STEPS, 0, between) || !find(state, 1, 1, before))
		return 2;
	plain_model.init(begin);
	for (int k = 0; k < SAMPLES; k++) {
		linear[k] = sample_run(&plain_model, plain, begin);
		clear[k] = sample_run(&stops_model, state, between);
		one[k] = sample_again(&stops_model, state, before, 1);
		copy[k] = sample_again(&stops_model, state, before, 0);
	}
	double step = median(linear), without = median(clear), with = median(one) - median(copy);
	printf("%-12s %2d states, h = %-6g linear %6.1f ns; no crossing %6.1f ns, %.2f times that; one crossing %7.0f "
	       "ns, %.1f times that\n", argv[1], stops_model.states, stops_model.h, step, without, without / step, with,
	       with / step);
	return 0;
}
