/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Friction and impacts beside loads that change their formula, in float: as in double, to rounding. */
#include "carried_float.h"
#include "changes_variants.h"
#include "drive.h"
#include "dropped_float.h"
#include "ramped_float.h"
#include "tap.h"
#include "walled_float.h"
#include "worse.h"

#include <math.h>
#include <stdlib.h>

static void compare(const pl_modelf *single, const char *name, long steps, double tolerance)
{
	struct run r = run_new(variant_of(changes_table, "%s_0", name));
	void *s = calloc(1, single->size);
	double y[2], worst = 0;
	float x[2];
	single->init(s);
	for (long k = 0; k < steps; k++) {
		run_step(&r, NULL);
		single->step(s, NULL);
		run_state(&r, y);
		single->get(s, x);
		worst = worse(worst, fabs(y[0] - (double)x[0]));
	}
	ok(worst <= tolerance, "%s in float: places off by %.2g at most", name, worst);
	is_close(single->status(s), 0, 0, "%s in float: status", name);
	free(s);
	run_free(&r);
}

int main(void)
{
	compare(&ramped_float_model, "ramped", 60, 1e-6);
	compare(&carried_float_model, "carried", 60, 1e-6);
	compare(&walled_float_model, "walled", 60, 1e-6);
	compare(&dropped_float_model, "dropped", 200, 2e-5);
	return tap_end();
}
