/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model in float beside the same in double, of all modes: at none of so many samples they are further apart than is
 * certified of both, and somewhere a thousandth of that.
 * lasting STEPS CERTIFIED */
#include <math.h>
#include <stdio.h>
#include <stdlib.h>

#include "single_pl.h"
#include "whole_pl.h"

int main(int argc, char **argv)
{
	static single a;
	static whole b;
	const long steps = argc > 2 ? atol(argv[1]) : 0;
	const double certified = argc > 2 ? atof(argv[2]) : 0;
	double worst = 0;
	single_init(&a);
	whole_init(&b);
	for (long k = 0; k <= steps; k++) {
		float out;
		double exact;
		single_out(&a, &out);
		whole_out(&b, &exact);
		const double now = fabs((double)out - exact);
		worst = now <= worst ? worst : now;
		single_step(&a);
		whole_step(&b);
	}
	const int good = worst <= certified && worst >= 1e-3 * certified && steps > 0;
	printf("%s - %ld steps: certified %.3g, found %.3g\n", good ? "ok" : "not ok", steps, certified, worst);
	return !good;
}
