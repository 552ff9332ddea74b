/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The same for the target float, to the digits of a float: its h is rounded. What friction lets go is told from what it
 * holds while rounding does not move the force by more than its slope does: not at L = 1e8. */
#include "kink_float.h"
#include "stiff_float100.h"
#include "stiff_float2700000.h"
#include "tap.h"
#include "truth.h"

#include <stdlib.h>

enum { STEPS = 200 };

static void run(const pl_modelf *m, double L)
{
	const struct truth truth = truth_at((long double)L, (long double)STEPS * (long double)m->h);
	void *s = calloc(1, m->size);
	float y[TRUTH_STATES];
	bool good = true;
	m->init(s);
	for (int k = 0; k < STEPS && m->status(s) == 0; k++)
		m->step(s, NULL);
	m->get(s, y);
	for (int i = 0; i < m->states; i++)
		good = close_to((double)y[i], (double)truth.y[i], 2e-5, "%s, L = %g: state %d", m->name, L, i) && good;
	ok(m->status(s) == 0, "%s, L = %g: it runs", m->name, L);
	ok(good, "%s, L = %g: states after %d steps", m->name, L, STEPS);
	free(s);
}

int main(void)
{
	run(&kink_float_model, 1e8);
	run(&stiff_float100_model, 1e2);
	run(&stiff_float2700000_model, 2.7e6);
	return tap_end();
}
