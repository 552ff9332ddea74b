/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same for the target float, to the digits of a float: its time is a multiple of the step, rounded. */
#include "float100.h"
#include "float2700000.h"
#include "float100000000.h"
#include "tap.h"
#include "truth.h"

#include <math.h>
#include <stdlib.h>

enum { STEPS = 200 };

static void run(const pl_modelf *m, double L)
{
	const struct truth truth = truth_at((long double)L, (long double)STEPS * (long double)m->h);
	void *s = calloc(1, m->size);
	float y[TRUTH_STATES];
	bool good = true;
	m->init(s);
	for (int k = 0; k < STEPS; k++)
		m->step(s, NULL);
	m->get(s, y);
	for (int i = 0; i < TRUTH_STATES; i++)
		good = close_to((double)y[i], (double)truth.y[i], 2e-5, "L = %g: state %d", L, i) && good;
	ok(m->status(s) == 0, "float, L = %g: it runs", L);
	ok(good, "float, L = %g: states after %d steps", L, STEPS);
	free(s);
}

int main(void)
{
	run(&float100_model, 1e2);
	run(&float2700000_model, 2.7e6);
	run(&float100000000_model, 1e8);
	return tap_end();
}
