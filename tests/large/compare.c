/* SPDX-License-Identifier: GPL-3.0-or-later */
/* compare: steps one model and its equal, or its parts (B1, B2, ...), beside it under the same samples, and compares
 * states by name. -DWHOLE=NAME -DPARTS="X(b1) X(b2)" -DREAL=double -DMODEL=pl_model
 *
 *     compare STEPS TOLERANCE REST     tolerances are of the largest value of a state so far, 0: the same bits
 *
 * At the end the states go through at, jump, set and get, where both have them, to the tolerance REST. Prints what is
 * worst of either. */
#include "plrt.h"

#include <math.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = 512, INPUTS = 8, BYTES = 1 << 16 };
#define JOIN_(a, b) a##b
#define JOIN(a, b) JOIN_(a, b)
extern const MODEL JOIN(WHOLE, _model);
#define X(part) extern const MODEL JOIN(part, _model);
PARTS
#undef X

static struct instance {
	const MODEL *model;
	union {
		double align;
		uint64_t word;
		unsigned char bytes[BYTES];
	} s;
	REAL y[STATES], out[STATES];
} whole, part[8];
static int parts;
static double worst, scale[STATES], where_found, where_expected;
static const char *where = "", *what = "";

static void start(struct instance *i, const MODEL *model)
{
	i->model = model;
	if (model->size > BYTES || model->states > STATES || model->inputs > INPUTS) {
		puts("a model is larger than there is room for");
		exit(1);
	}
	model->init(&i->s);
}

static void compare(const char *of, const char *name, REAL found, REAL expected, double largest)
{
	const double size = largest > 0 ? largest : 1e-300;
	const double off = found == expected ? 0 : fabs((double)found - (double)expected) / size;
	if (off > worst || isnan(off)) {
		worst = isnan(off) ? HUGE_VAL : off;
		where = name;
		what = of;
		where_found = (double)found;
		where_expected = (double)expected;
	}
}

static void compare_states(const char *of)
{
	for (int p = 0; p < parts; p++)
		for (int i = 0; i < part[p].model->states; i++) {
			int k = 0;
			while (k < whole.model->states &&
					strcmp(whole.model->state_names[k], part[p].model->state_names[i]) != 0)
				k++;
			if (k == whole.model->states) {
				printf("no state %s\n", part[p].model->state_names[i]);
				exit(1);
			}
			scale[k] = fmax(scale[k], fabs((double)part[p].y[i]));
			compare(of, whole.model->state_names[k], whole.y[k], part[p].y[i], scale[k]);
		}
}

static void get_all(const char *of)
{
	whole.model->get(&whole.s, whole.y);
	for (int p = 0; p < parts; p++)
		part[p].model->get(&part[p].s, part[p].y);
	compare_states(of);
}

static void compare_outputs(void)
{
	static double largest[STATES];
	if (parts > 1 || whole.model->outputs == whole.model->states)
		return;
	whole.model->out(&whole.s, whole.out);
	part[0].model->out(&part[0].s, part[0].out);
	for (int i = 0; i < whole.model->outputs; i++) {
		largest[i] = fmax(largest[i], fabs((double)part[0].out[i]));
		compare("out", whole.model->output_names[i], whole.out[i], part[0].out[i], largest[i]);
	}
}

static void compare_functions(const REAL *u)
{
	const REAL tau = (REAL)0.375 * whole.model->h;
	if (whole.model->at) {
		whole.model->at(&whole.s, u, tau, whole.y);
		for (int p = 0; p < parts; p++)
			part[p].model->at(&part[p].s, u, tau, part[p].y);
		compare_states("at");
	}
	if (whole.model->jump) {
		whole.model->jump(&whole.s, 77);
		for (int p = 0; p < parts; p++)
			part[p].model->jump(&part[p].s, 77);
		get_all("jump");
	}
	for (int i = 0; i < whole.model->states; i++)
		whole.y[i] = (REAL)sin(i + 1.0);
	for (int p = 0; p < parts; p++)
		for (int i = 0; i < part[p].model->states; i++)
			for (int k = 0; k < whole.model->states; k++)
				if (strcmp(whole.model->state_names[k], part[p].model->state_names[i]) == 0)
					part[p].y[i] = whole.y[k];
	whole.model->set(&whole.s, 0, whole.y);
	for (int p = 0; p < parts; p++)
		part[p].model->set(&part[p].s, 0, part[p].y);
	get_all("set and get");
	whole.model->step(&whole.s, u);
	for (int p = 0; p < parts; p++)
		part[p].model->step(&part[p].s, u);
	get_all("a step from there");
}

static bool tell(double tolerance)
{
	printf("worst: %s, %s: %.17g, expected %.17g: off by %.3g of its size, tolerance %g\n", what, where,
			where_found,
		   where_expected, worst, tolerance);
	return worst <= tolerance;
}

int main(int argc, char **argv)
{
	const long steps = argc > 1 ? strtol(argv[1], NULL, 10) : 0;
	const double tolerance = argc > 2 ? strtod(argv[2], NULL) : 0, rest = argc > 3 ? strtod(argv[3], NULL) : 0;
	REAL u[INPUTS] = { 0 };
	start(&whole, &JOIN(WHOLE, _model));
#define X(b) start(&part[parts++], &JOIN(b, _model));
	PARTS
#undef X
	for (long k = 0; k < steps; k++) {
		for (int i = 0; i < whole.model->inputs; i++)
			u[i] = (REAL)(sin(0.37 * (double)k + i) + ((k / 40 + i) % 3 == 0));
		whole.model->step(&whole.s, u);
		for (int p = 0; p < parts; p++)
			part[p].model->step(&part[p].s, u);
		get_all("step");
		compare_outputs();
	}
	const bool good = tell(tolerance);
	worst = 0;
	compare_functions(u);
	return steps < 1 || !(tell(rest) && good);
}
