/* SPDX-License-Identifier: GPL-3.0-or-later */
/* truths VARIANTS: what the charts hold errors against, Taylor series in quadruple precision, beside the other road,
 * extrapolation in long double on equations written a second time (equations.h, which peers have in double). Their
 * difference is stated; it is what long double loses, so its bound is each model's own. And NAME_rhs must be the same
 * model: agreement. VARIANTS: what truths.sh made. With LONG in the environment over all of the time, else the first
 * part of what takes long; of stiff motion what is left has a jump. */
#include <math.h>
#include <stdlib.h>

#include "charts.h"
#include "tap.h"

static const struct { const char *name; double unit; int units, few; double apart; } models[] = {
	{ "pendulum", 0.1, 100, 100, 1e-15 }, { "vanderpol", 0.1, 200, 100, 1e-15 },
	{ "vanderpol_stiff", 0.1, 1000, 1000, 1e-11 }, { "vanderpol_stiffer", 1, 820, 40, 1e-11 },
	{ "quad2dof", 0.1, 300, 100, 1e-15 }, { "duffing", 0.1, 300, 100, 1e-15 }, { "mathieu", 0.1, 300, 100, 1e-15 },
	{ "beam4", 0.01, 100, 10, 2e-11 }, { "beam15", 0.01, 100, 10, 2e-11 },
	{ "henon_heiles", 0.1, 300, 100, 1e-14 }, { "coupled_vanderpol", 0.1, 300, 100, 1e-14 },
	{ "double_pendulum", 0.1, 300, 100, 1e-14 }, { "rayleigh", 0.1, 300, 100, 1e-14 },
	{ "duffing_pair", 0.1, 300, 100, 1e-14 }, { "spherical_pendulum", 0.1, 300, 100, 1e-14 },
};

int main(int argc, char **argv)
{
	char file[4096];
	if (argc != 2) {
		fputs("usage: truths VARIANTS\n", stderr);
		return 2;
	}
	const bool whole = getenv("LONG") != NULL;
	for (size_t k = 0; k < sizeof models / sizeof *models; k++) {
		snprintf(file, sizeof file, "%s/%s.so", argv[1], models[k].name);
		struct problem *p = problem_load(file, models[k].name, models[k].unit,
		                                 whole ? models[k].units : models[k].few, false, 0);
		struct truth *t = truth_of(p), *other = truth_by_extrapolation(p);
		const double apart = truth_error(t, other->at_end);
		ok(close_to(apart, 0, models[k].apart, "difference of two roads"),
		   "%s: extrapolation in long double is %.2g off quadruple precision", models[k].name, apart);
		ok(close_to(t->agreement, 0, 3e-11, "difference of NAME_rhs by GSL rk8pd"),
		   "%s: the generated right-hand side in double is %.2g off it", models[k].name, t->agreement);
		truth_free(t);
		truth_free(other);
		problem_free(p);
	}
	return tap_end();
}
