/* SPDX-License-Identifier: GPL-3.0-or-later */
/* run: nanoseconds a row of NAME_run, of several builds of one model, which builds.h names: minima of short samples in
 * turn, so that all meet the same machine. To memory: rows that go out of every cache, beside memset of as many
 * bytes. */
#include "plrt.h"
#include "timing.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { ROWS = 512, ROUNDS = 400, LARGE = 1 << 23 };      /* numbers: 64 MB */

struct build {
	const char *name;
	const pl_model *model;
	double target;          /* ns a row; 0: none */
	double least[2];        /* to the nearest cache, to memory */
	void *state;
};

#define X(name, label, target) extern const pl_model name##_model;
#include "builds.h"
#undef X
#define X(name, label, target) { label, &name##_model, target, { INFINITY, INFINITY }, NULL },
static struct build build[] = {
#include "builds.h"
};
#undef X
enum { BUILDS = sizeof build / sizeof *build };

static double *near, *far, *samples;
static size_t at;

static double *next_far(size_t numbers)
{
	if (at + numbers > LARGE)
		at = 0;
	at += numbers;
	return far + at - numbers;
}

static void sample(struct build *b, int where, int calls)
{
	size_t numbers = (size_t)ROWS * (size_t)b->model->outputs;
	b->model->init(b->state);               /* before what is free has decayed to nothing */
	double start = own_nanoseconds();
	for (int i = 0; i < calls; i++)
		b->model->run(b->state, ROWS, samples, where ? next_far(numbers) : near);
	double each = (own_nanoseconds() - start) / calls / ROWS;
	b->least[where] = fmin(b->least[where], each);
}

static double sample_memset(size_t bytes, int calls)
{
	double start = own_nanoseconds();
	for (int i = 0; i < calls; i++)
		memset(next_far(bytes / sizeof *far), i, bytes);
	return (own_nanoseconds() - start) / calls / ROWS;
}

int main(void)
{
	size_t widest = (size_t)build[0].model->outputs;
	double cleared = INFINITY;
	near = aligned_alloc(64, ROWS * widest * sizeof *near);
	far = aligned_alloc(64, LARGE * sizeof *far);
	samples = calloc((size_t)ROWS * 16, sizeof *samples);
	if (!near || !far || !samples)
		return 1;
	memset(far, 1, LARGE * sizeof *far);
	uint32_t z = 1;
	for (int i = 0; i < ROWS * 16; i++) {
		z = z * 1664525u + 1013904223u;
		samples[i] = 1e-2 * ((double)z / 4294967296.0 - 0.5);
	}
	for (int i = 0; i < BUILDS; i++) {
		build[i].state = calloc(1, build[i].model->size);
		if (!build[i].state)
			return 1;
		build[i].model->init(build[i].state);
	}
	for (int round = 0; round < ROUNDS; round++) {
		for (int i = 0; i < BUILDS; i++) {
			sample(&build[i], 0, 40);
			sample(&build[i], 1, 8);
		}
		cleared = fmin(cleared, sample_memset(ROWS * widest * sizeof *far, 8));
	}
	for (int i = 0; i < BUILDS; i++) {
		printf("  %-58s %7.2f ns a row", build[i].name, build[i].least[0]);
		if (build[i].target > 0)
			printf("   (target %.1f)", build[i].target);
		printf("%*s to memory %6.2f, %.2f of memset\n", build[i].target > 0 ? 0 : 15, "", build[i].least[1],
		       build[i].least[1] / cleared);
	}
	return 0;
}
