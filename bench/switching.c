/* SPDX-License-Identifier: GPL-3.0-or-later */
/* switching NAME: times of a step of a piecewise-linear model without a crossing and with one, of many such, and of a
 * run as it comes, beside a step of the same model without stops, in short samples that take turns so that all meet the
 * same machine; prints medians and ratios. */
#include "plrt.h"
#include "timing.h"

#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern const pl_model plain_model, stops_model;
uint64_t crossed(const void *s);

enum { SAMPLES = 501, STEPS = 20, RUN = 200, LOOKED_AT = 400000 };

static double sample_run(const pl_model *m, void *state, const void *saved)
{
	memcpy(state, saved, m->size);
	double start = nanoseconds();
	for (int k = 0; k < STEPS; k++)
		m->step(state, NULL);
	return (nanoseconds() - start) / STEPS;
}

/* One step from each of STEPS states */
static double sample_each(const pl_model *m, void *state, const char *saved, int step)
{
	double start = nanoseconds();
	for (int k = 0; k < STEPS; k++) {
		memcpy(state, saved + (size_t)k * m->size, m->size);
		__asm__ volatile("" : : "r"(state) : "memory");
		if (step)
			m->step(state, NULL);
	}
	return (nanoseconds() - start) / STEPS;
}

/* `count` states from which `steps` steps cross `crossings` breakpoints; where there are fewer, the same again */
static int find(void *state, int steps, uint64_t crossings, int count, char *saved)
{
	void *ahead = malloc(stops_model.size);
	const size_t size = stops_model.size;
	int found = 0;
	stops_model.init(state);
	for (int k = 0; k < LOOKED_AT && found < count; k++) {
		memcpy(ahead, state, size);
		for (int i = 0; i < steps; i++)
			stops_model.step(ahead, NULL);
		if (crossed(ahead) - crossed(state) == crossings)
			memcpy(saved + (size_t)found++ * size, state, size);
		stops_model.step(state, NULL);
	}
	for (int k = found; k < count && found > 0; k++)
		memcpy(saved + (size_t)k * size, saved + (size_t)(k % found) * size, size);
	free(ahead);
	return found;
}

/* A run as it comes */
static double sample_on(const pl_model *m, void *state)
{
	double start = nanoseconds();
	for (int k = 0; k < RUN; k++)
		m->step(state, NULL);
	return (nanoseconds() - start) / RUN;
}

int main(int argc, char **argv)
{
	static double linear[SAMPLES], clear[SAMPLES], one[SAMPLES], copy[SAMPLES], level[SAMPLES], run[SAMPLES];
	char *state = malloc(stops_model.size), *between = malloc(stops_model.size), *on = malloc(stops_model.size);
	char *plain = malloc(plain_model.size), *begin = malloc(plain_model.size), *plain_on = malloc(plain_model.size);
	char *before = malloc(STEPS * stops_model.size);
	if (argc != 2 || !find(state, STEPS, 0, 1, between) || !find(state, 1, 1, STEPS, before))
		return 2;
	plain_model.init(begin);
	plain_model.init(plain_on);
	stops_model.init(on);
	for (int k = 0; k < SAMPLES; k++) {
		linear[k] = sample_run(&plain_model, plain, begin);
		clear[k] = sample_run(&stops_model, state, between);
		one[k] = sample_each(&stops_model, state, before, 1);
		copy[k] = sample_each(&stops_model, state, before, 0);
		level[k] = sample_on(&plain_model, plain_on);
		run[k] = sample_on(&stops_model, on);
	}
	double step = median(linear), without = median(clear), with = median(one) - median(copy);
	printf("%-12s %2d states, h = %-6g linear %6.1f ns; no crossing %6.1f ns, %.2f times that (aim: 1.45); one "
	       "crossing %5.0f ns, %.1f times that\n", argv[1], stops_model.states, stops_model.h, step, without,
	       without / step, with, with / step);
	step = median(level), with = median(run);
	printf("%31s run: linear %6.1f ns a step; with crossings %6.1f ns, %.2f times that\n", "", step, with,
	       with / step);
	return 0;
}
