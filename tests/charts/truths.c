/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truths VARIANTS: what the charts hold errors against. It must be the same with outputs twice as often, which its
 * steps end at; the equations by hand and NAME_rhs must be the same model, and its motion by another method on that.
 * VARIANTS: what truths.sh made. With LONG in the environment over all of the time, else the first part of what takes
 * long; of stiff motion what is left has a jump. */
#include <math.h>
#include <stdlib.h>

#include "charts.h"
#include "tap.h"

static const struct { const char *name; double unit; int units, few; } models[] = {
	{ "pendulum", 0.1, 100, 100 }, { "vanderpol", 0.1, 200, 100 }, { "vanderpol_stiff", 0.1, 1000, 1000 },
	{ "vanderpol_stiffer", 1, 820, 40 }, { "quad2dof", 0.1, 300, 100 }, { "duffing", 0.1, 300, 100 },
	{ "mathieu", 0.1, 300, 100 }, { "beam4", 0.01, 100, 10 }, { "beam15", 0.01, 100, 10 },
	{ "henon_heiles", 0.1, 300, 100 }, { "coupled_vanderpol", 0.1, 300, 100 }, { "double_pendulum", 0.1, 300, 100 },
	{ "rayleigh", 0.1, 300, 100 }, { "duffing_pair", 0.1, 300, 100 }, { "spherical_pendulum", 0.1, 300, 100 },
};

/* The largest difference of the equations, over a motion */
static double slopes_off(const struct problem *p, const struct truth *t)
{
	double most = 0;
	for (int k = 0; k < p->units; k++)
		most = fmax(most, truth_slopes_off(p, (k + 1) * p->unit, t->at_end + k * 2 * p->n));
	return most;
}

int main(int argc, char **argv)
{
	char file[4096];
	if (argc != 2) {
		fputs("usage: truths VARIANTS\n", stderr);
		return 2;
	}
	const bool whole = getenv("LONG") != NULL;
	for (size_t k = 0; k < sizeof models / sizeof *models; k++) {
		const char *name = models[k].name;
		const double unit = models[k].unit;
		const int units = whole ? models[k].units : models[k].few;
		snprintf(file, sizeof file, "%s/%s.so", argv[1], name);
		struct problem *p = problem_load(file, name, unit, units, false, 0),
			*finer = problem_load(file, name, unit / 2, 2 * units, false, 0);
		struct truth *t = truth_of(p), *other = truth_of(finer);
		double apart = 0;
		for (int i = 0; i < units; i++)
			apart = truth_farther(apart, t, i, other->at_end + (2 * i + 1) * 2 * p->n);
		ok(close_to(apart, 0, 2.3e-16, "difference by outputs twice as often"),
		   "%s: with outputs twice as often it is %.2g off", name, apart);
		ok(close_to(slopes_off(p, t), 0, 1e-12, "difference of equations"), "%s: NAME_rhs is the model", name);
		ok(close_to(t->agreement, 0, 3e-11, "difference of NAME_rhs by GSL rk8pd"),
		   "%s: the generated right-hand side in double is %.2g off it", name, t->agreement);
		truth_free(t);
		truth_free(other);
		problem_free(p);
		problem_free(finer);
	}
	return tap_end();
}
