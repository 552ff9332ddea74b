/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * near > DOUBLE, near DOUBLE: models with a remainder and with switching in float beside the same in double.  Without a
 * file this writes the states of the one, as hexadecimal fractions; the other compares its own with them.
 *
 * u is half a unit in the last place of 1 in float, W_i the largest |y_i|, Phi the transfer matrix of a step (of the
 * linear operator). A step rounds sums of Phi_ij y_j, and the next carries that on: with S = |Phi| |Phi| W, at least W,
 * (8 + 2 k) u S_i after k steps. At the stop of two_masses what is early or late by little hits a spring 50 times as
 * stiff: 20 times that.
 */
#include VARIANTS_H
#include "tap.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 600, LARGEST = 32, ROOM = 4096 };

union object {
	double align;
	unsigned char byte[ROOM];
};

static double history[STEPS + 1][LARGEST];

static void fill(const real_model *m)
{
	static const real bump[] = { 0, (real)0.03125 };    /* of the road, where a model has one */
	union object s;
	real y[LARGEST];
	m->init(&s);
	for (int k = 0; k <= STEPS; k++) {
		m->get(&s, y);
		for (int i = 0; i < m->states; i++)
			history[k][i] = (double)y[i];
		m->step(&s, &bump[k % 50 < 10]);
	}
}

/* scale <- max(scale, |Phi| scale) */
static void carry(const struct variant *v, double *scale)
{
	double carried[LARGEST];
	const int n = v->model->states;
	for (int i = 0; i < n; i++) {
		carried[i] = 0;
		for (int j = 0; j < n; j++)
			carried[i] += fabs((double)v->Phi[i * n + j]) * scale[j];
	}
	for (int i = 0; i < n; i++)
		scale[i] = fmax(scale[i], carried[i]);
}

static void compare(const struct variant *v, FILE *f)
{
	const real_model *m = v->model;
	double expected[STEPS + 1][LARGEST], widest[LARGEST] = { 0 }, worst = 0;
	bool good = true;
	char name[100];
	if (fscanf(f, "%99s", name) != 1 || strcmp(name, m->name) != 0) {
		printf("Bail out! expected %s\n", m->name);
		exit(99);
	}
	for (int k = 0; k <= STEPS; k++)
		for (int i = 0; i < m->states; i++) {
			if (fscanf(f, "%la", &expected[k][i]) != 1) {
				puts("Bail out! too few numbers");
				exit(99);
			}
			widest[i] = fmax(widest[i], fabs(expected[k][i]));
		}
	carry(v, widest);
	carry(v, widest);
	for (int k = 0; k <= STEPS; k++)
		for (int i = 0; i < m->states; i++) {
			const double tolerance = FLT_EPSILON / 2 * widest[i] * (8 + 2 * k) * (strncmp(name,
					"two_masses", 10) == 0
				? 20 : 1);
			good = close_to(history[k][i], expected[k][i], tolerance, "%s, %s, step %d", m->name,
					m->state_names[i],
				k) && good;
			worst = worse(worst, fabs(history[k][i] - expected[k][i]) / tolerance);
		}
	ok(good, "%s: %d steps in float beside double, %.2f of the tolerance", m->name, STEPS, worst);
}

int main(int argc, char **argv)
{
	FILE *f = argc > 1 ? fopen(argv[1], "r") : NULL;
	if (argc > 1 && !f)
		return 99;
	for (const struct variant *v = VARIANTS; v->model; v++) {
		fill(v->model);
		if (f) {
			compare(v, f);
			continue;
		}
		puts(v->model->name);
		for (int k = 0; k <= STEPS; k++)
			for (int i = 0; i < v->model->states; i++)
				printf("%a%c", history[k][i], i + 1 < v->model->states ? ' ' : '\n');
	}
	return f ? tap_end() : 0;
}
