/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear models leave nothing over: every scheme does what `exact` does, with loads and inputs, over 1000 steps. */
#include "covered_variants.h"
#include "tap.h"

#include <math.h>

enum { STEPS = 1000, MOST = 32 };

static const double tolerance = 3e-13;      /* of the largest value of the component */

static void judge(const char *name, const char *scheme)
{
	const pl_model *one = variant_of(covered, "%s_exact_0", name)->model,
		*other = variant_of(covered, "%s_%s_0", name, scheme)->model;
	void *a = calloc(1, one->size), *b = calloc(1, other->size);
	double most[MOST] = {0}, difference[MOST] = {0}, worst = 0;
	unsigned seed = 1;
	bool good = one->states == other->states && one->inputs == other->inputs && one->h == other->h;
	one->init(a);
	other->init(b);
	for (int k = 0; k <= STEPS && good; k++) {
		double x[MOST], y[MOST], u[MOST];
		one->get(a, x);
		other->get(b, y);
		for (int i = 0; i < one->states; i++) {
			most[i] = fmax(most[i], fabs(x[i]));
			difference[i] = fabs(x[i] - y[i]) > difference[i] || isnan(y[i])
					? fabs(x[i] - y[i]) : difference[i];
		}
		for (int i = 0; i < one->inputs; i++) {
			seed = seed * 1103515245u + 12345u;
			u[i] = (double)(seed >> 16) / 32768 - 1;
		}
		one->step(a, one->inputs ? u : NULL);
		other->step(b, one->inputs ? u : NULL);
	}
	for (int i = 0; i < one->states; i++) {
		good = close_to(difference[i], 0, tolerance * most[i], "%s: "
			"%s", other->name, one->state_names[i]) && good;
		if (most[i] > 0)
			worst = worse(worst, difference[i] / most[i]);
	}
	ok(good, "%s, %s: `exact` over %d steps (largest difference over the amplitude "
		"%.2g)", name, scheme, STEPS, worst);
	free(a);
	free(b);
}

/* pl is etd1 whose operator has each coordinate's own terms: to the last bit where both leave the same over; to
 * rounding where the coupling is linear, and pl has folded its factor into the tables. */
static void piecewise_laplace(void)
{
	const pl_model *etd1 = variant_of(covered, "scs_max_etd1_0")->model,
		*pl = variant_of(covered, "scs_max_pl_0")->model;
	const pl_model *linear = variant_of(covered, "scs_pl_0")->model;
	void *a = calloc(1, etd1->size), *b = calloc(1, pl->size), *c = calloc(1, linear->size);
	bool same = true, near = true;
	etd1->init(a);
	pl->init(b);
	linear->init(c);
	for (int k = 0; k < STEPS; k++) {
		double x[4], y[4], z[4];
		etd1->step(a, NULL);
		pl->step(b, NULL);
		linear->step(c, NULL);
		etd1->get(a, x);
		pl->get(b, y);
		linear->get(c, z);
		for (int i = 0; i < 4; i++) {
			const double scale = (i < 2 ? 0.01 : 0.2) * exp(0.25 * k * etd1->h); /* it grows at 0.25 1/s */
			same = close_to(y[i], x[i], 0, "step %d, entry %d", k, i) && same;
			near = close_to(z[i], x[i], 1e-13 * scale, "step %d, entry %d", k, i) && near;
		}
	}
	ok(same, "scs_max: pl is etd1 to the last bit");
	ok(near, "scs: pl is etd1 with the coupling left over");
	free(a);
	free(b);
	free(c);
}

int main(void)
{
	piecewise_laplace();
	static const char *const names[] = {"scs", "sdcs", "sdcsf", "quarter_car", "linear2dof", "vector3", "maxwell",
		"resonance", "pulse",
									"held2", "ramped2", "first2", "switched"};
	static const char *const schemes[] = {"etd1", "etdrk2", "etdrk4", "nc2", "nc3", "dq4", "bm3"};
	for (size_t i = 0; i < sizeof names / sizeof *names; i++)
		for (size_t j = 0; j < sizeof schemes / sizeof *schemes; j++)
			judge(names[i], schemes[j]);
	return tap_end();
}
