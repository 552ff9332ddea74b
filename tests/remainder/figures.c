/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The precise-integration schemes on two systems of their source: the largest errors over 10 s, and bm3 the best of
 * its four. */
#include "elliptic.h"
#include "figures_variants.h"
#include "tap.h"

#include <math.h>

enum { SECONDS = 10, FOUR = 4 };

static const char *const schemes[FOUR] = {"nc2", "nc3", "dq4", "bm3"};

typedef double solution(double t);

/* diag(2, 1) x'' + [6, -2; -2, 4] x = [0; 10] from rest */
static double linear2dof_x1(double t)
{
	return 1 - 5.0 / 3 * cos(sqrt(2) * t) + 2.0 / 3 * cos(sqrt(5) * t);
}

static double pendulum_x(double t)
{
	double y[2];
	pendulum_swing(1.0472, t, y);
	return y[0];
}

static double largest_error(const pl_model *m, solution *x)
{
	const int steps = (int)lround(SECONDS / m->h);
	double y[8], worst = 0;
	void *state = calloc(1, m->size);
	m->init(state);
	for (int k = 1; k <= steps; k++) {
		m->step(state, NULL);
		m->get(state, y);
		worst = worse(worst, fabs(y[0] - x(SECONDS * (double)k / steps)));
	}
	free(state);
	return worst;
}

/* unit: half a unit in the last known digit, over the power of ten of the figure */
static void judge(const char *name, int variant, solution *x, const double figure[FOUR], double unit)
{
	double error[FOUR];
	for (int i = 0; i < FOUR; i++) {
		const double half_unit = pow(10, floor(log10(figure[i])) + log10(unit));
		error[i] = largest_error(variant_of(figures, "%s_%s_%d", name, schemes[i], variant)->model, x);
		ok(close_to(error[i], figure[i], half_unit, "%s, %s", name, schemes[i]),
			"%s, %s: largest error %.3e, known %.2e", name, schemes[i],
		   error[i], figure[i]);
	}
	ok(error[3] < error[0] && error[3] < error[1] && error[3] < error[2],
		"%s: bm3 is the best of its four (%.3g, %.3g, %.3g, %.3g)", name,
	   error[0], error[1], error[2], error[3]);
}

int main(void)
{
	judge("linear2dof", 0, linear2dof_x1, (double[]){1.84e-5, 8.2e-6, 1.61e-5, 4.6e-6}, 0.06);
	judge("pendulum", 0, pendulum_x, (double[]){6.9e-8, 3.2e-8, 5.4e-8, 1.4e-8}, 0.06);
	/* at a tenth of the step, by the schemes in long double */
	judge("pendulum", 1, pendulum_x, (double[]){6.15e-12, 2.75e-12, 5.33e-12, 1.50e-12}, 0.06);
	return tap_end();
}
