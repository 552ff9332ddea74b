/* SPDX-License-Identifier: GPL-3.0-or-later */
/* rest: what has decayed below 2^-963 (2^-116 in float) is 0 after 64 steps, what has not goes on, and what is no
 * number stays none. -DMODEL=pl_model -DREAL=double: `decaying_model` is one whose states all decay; of `mixed_model`
 * those called a... do, those called b... do not. With the argument `run`, by that function, else by steps. */
#include "plrt.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = 64, STEPS = 64 };
extern const MODEL decaying_model, mixed_model;
static union {
	double align;
	uint64_t word;
	unsigned char bytes[1 << 14];
} s;
static REAL y[STATES], none[8];
static int failed;

/* The states after so many steps from where all have this value */
static void go(const MODEL *model, REAL value, int run)
{
	for (int i = 0; i < model->states; i++)
		y[i] = value;
	model->init(&s);
	model->set(&s, 0, y);
	if (run)
		model->run(&s, STEPS, none, NULL);
	for (int k = 0; k < STEPS && !run; k++)
		model->step(&s, none);
	model->get(&s, y);
}

static void expect(int good, const char *what, REAL found)
{
	if (!good) {
		printf("%s: found %g\n", what, (double)found);
		failed = 1;
	}
}

/* b3'' + 23 b3 = 0, from value, value; to 1e-12 of it */
static int on_its_way(const char *name, REAL found, REAL value)
{
	const double w = sqrt(20 + strtod(name + 1, NULL)), t = STEPS * (double)mixed_model.h;
	const double expected = cos(w * t) + sin(w * t) / w, off = (double)found / (double)value - expected;
	if (!(fabs(off) < 1e-12))
		printf("%s: %.17g times the first value, expected %.17g, tolerance 1e-12\n", name,
			   (double)found / (double)value, expected);
	return fabs(off) < 1e-12;
}

int main(int argc, char **argv)
{
	const REAL least = sizeof(REAL) == 4 ? (REAL)0x1p-116 : (REAL)0x1p-963;
	const int run = argc > 1 && strcmp(argv[1], "run") == 0;
	go(&decaying_model, least / 1000, run);
	for (int i = 0; i < decaying_model.states; i++)
		expect(y[i] == 0, "what has decayed is at rest", y[i]);
	go(&decaying_model, least * 1000, run);
	for (int i = 0; i < decaying_model.states; i++)
		expect(y[i] != 0, "what has not moves on", y[i]);
	go(&decaying_model, (REAL)NAN, run);
	for (int i = 0; i < decaying_model.states; i++)
		expect(y[i] != y[i], "no number stays none", y[i]);
	go(&mixed_model, least / 1000, run);
	for (int i = 0; i < mixed_model.states; i++) {
		const int decays = mixed_model.state_names[i][0] == 'a';
		expect((y[i] == 0) == decays, mixed_model.state_names[i], y[i]);
		if (!decays && sizeof(REAL) == 8 && i < mixed_model.states / 2)
			expect(on_its_way(mixed_model.state_names[i], y[i], least / 1000),
					"an oscillator in closed form", y[i]);
	}
	return failed;
}
