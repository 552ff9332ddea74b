/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model with a need for any input within a bound, beside the same of all modes: the difference of their responses to
 * one sample tells what the worst input is. Driven by it, the output is as wrong as was certified, and not more.
 * worst STEPS MOST CERTIFIED */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "chosen_pl.h"
#include "whole_pl.h"

enum { ROOM = 100000 };

/* Both with these samples; the difference of the outputs after each step */
static void run(long steps, const double *u, double *difference)
{
	static chosen a;
	static whole b;
	double out[2];
	chosen_init(&a);
	whole_init(&b);
	for (long k = 0; k < steps; k++) {
		chosen_step(&a, &u[k]);
		whole_step(&b, &u[k]);
		chosen_out(&a, &out[0]);
		whole_out(&b, &out[1]);
		difference[k] = out[0] - out[1];
	}
}

int main(int argc, char **argv)
{
	static double u[ROOM], h[ROOM], e[ROOM];
	const long steps = argc > 3 ? atol(argv[1]) : 0;
	const double most = argc > 3 ? atof(argv[2]) : 0, certified = argc > 3 ? atof(argv[3]) : 0;
	double sum = 0, worst = 0;
	if (steps < 1 || steps > ROOM)
		return 1;
	u[0] = 1;
	run(steps, u, h);
	for (long k = 0; k < steps; k++) {
		u[steps - 1 - k] = h[k] < 0 ? -most : most;
		sum += most * fabs(h[k]);
	}
	run(steps, u, e);
	for (long k = 0; k < steps; k++)
		worst = e[k] == e[k] ? fmax(worst, fabs(e[k])) : INFINITY;
	const int good = worst <= certified && worst >= 0.999 * certified && fabs(sum - worst) <= 1e-9 * worst;
	printf("%s - %s: certified %.9g, worst input %.9g, sum over samples %.9g\n", good ? "ok" : "not ok",
	       argv[0], certified, worst, sum);
	return !good;
}
