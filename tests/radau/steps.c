/* SPDX-License-Identifier: MIT-0 */
/* What steps by collocation do, alone and beside a series: every step and every value between, against the equations by
 * hand in long double; what is stiff, by as many explicit steps as it takes; orders; random starts; bits; what ends. */
#include "followed.h"
#include "relax_float_pl.h"
#include "steps_variants.h"
#include "systems.h"
#include "tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

static void relax_at(real mu, const real *y, real *dydt)
{
	dydt[0] = y[1];
	dydt[1] = mu * (1 - y[0] * y[0]) * y[1] - y[0];
}

static void relax(real t, const real *y, const real *u, real *dydt)
{
	(void)t;
	(void)u;
	relax_at(100, y, dydt);
}

static void fold(real t, const real *y, const real *u, real *dydt)
{
	(void)t;
	(void)u;
	relax_at(1000, y, dydt);
}

static void robertson(real t, const real *y, const real *u, real *dydt)
{
	const real slow = 0.04L * y[0], middle = 1e4L * y[1] * y[2], fast = 3e7L * y[1] * y[1];
	(void)t;
	(void)u;
	dydt[0] = middle - slow;
	dydt[1] = slow - middle - fast;
	dydt[2] = fast;
}

static void damped(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	for (int i = 0; i < 6; i++) {
		const real own = i < 5 ? 2 : 1, *v = y + 6;
		const real x_sides = (i > 0 ? y[i - 1] : 0) + (i < 5 ? y[i + 1] : 0);
		const real v_sides = (i > 0 ? v[i - 1] : 0) + (i < 5 ? v[i + 1] : 0);
		dydt[i] = v[i];
		dydt[6 + i] = -100 * (own * y[i] - x_sides) - 40 * v[i] * v[i] * v[i] - 300 * (own * v[i] - v_sides) +
			(i == 5 ? 5 * cosl(3 * t) : 0);
	}
}

static void couple(real t, const real *y, const real *u, real *dydt)
{
	(void)t;
	(void)u;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = 100 * (1 - y[0] * y[0]) * y[2] - y[0] - (y[0] - y[1]) / 2;
	dydt[3] = 50 * (1 - y[1] * y[1]) * y[3] - y[1] - (y[1] - y[0]) / 2;
}

static void pushed(real t, const real *y, const real *u, real *dydt)
{
	(void)t;
	dydt[0] = y[2];
	dydt[1] = y[0] * y[0] / 2 - y[1];
	dydt[2] = u[0] - 0.2L * y[2] - sinl(y[0]) - 0.3L * y[0] * y[1];
}

/* At a jump of a relaxation oscillation its time counts, which any error before it moves. */
static const struct subject subjects[] = {{.name = "pendulum"}, {.name = "duffing"}, {.name = "mathieu"},
	{.name = "quad2dof"}, {.name = "held"}, {.name = "ramped"}, {.name = "thermal"}, {.name = "coupled"},
	{.name = "rotor"}, {.name = "growth"}, {.name = "chain"}, {.name = "masses", .f = masses},
	{.name = "timed", .f = timed, .changes = 1, .change = {1.2345678L}},
	{.name = "changing", .f = changing, .changes = 5, .change = {0.37L, 0.55L, 0.62L, 0.81L, 0.9L}},
	{.name = "relax", .f = relax, .piece = 0.005L, .steps = 900, .bound = 5e-9, .between = 5e-9},
	{.name = "fold", .f = fold, .piece = 0.0005L, .bound = 1e-9, .between = 1e-9},
	{.name = "robertson", .f = robertson, .piece = 0.0005L, .steps = 20, .bound = 1e-10, .between = 1e-10},
	{.name = "damped", .f = damped, .piece = 0.002L, .bound = 1e-9, .between = 1e-9},
	{.name = "couple", .f = couple, .piece = 0.005L, .steps = 450, .bound = 5e-7, .between = 5e-7}};
enum { SUBJECTS = sizeof subjects / sizeof *subjects };

/* ---- every step ---- */

static void follows(const struct subject *s, const pl_model *m)
{
	const struct found worst = follow(s, m);
	const double bound = s->bound > 0 ? s->bound : 5e-11;
	bool good = close_to(worst.step, 0, bound, "%s: states after steps", m->name);
	good = close_to(worst.middle, 0, s->between > 0 ? s->between : 1e-10, "%s: in the middle of "
									  "steps", m->name) && good;
	good = close_to(worst.end, 0, 1e-13, "%s: NAME_at at the end of steps, beside the step", m->name) && good;
	ok(good, "%s: steps, their middles and ends (%.2g, %.2g, %.2g)", m->name, worst.step, worst.middle, worst.end);
}

/* ---- orders ---- */

/* The largest error at the end of six seconds, steps being h but for the first few */
static double error_of(const pl_model *m)
{
	const struct subject s = {.name = "pushed", .f = pushed};
	enum { SECONDS = 30 };
	const real u[2] = {0.25L, 0};
	const double sample = 0.25;
	double y[MOST], worst = 0;
	real truth[MOST];
	void *state = fresh(m);
	m->get(state, y);
	for (int i = 0; i < m->states; i++)
		truth[i] = y[i];
	for (int k = 0; k < lround(SECONDS / m->h); k++)
		m->step(state, &sample);
	m->get(state, y);
	solve(&s, m, 0, roundl(SECONDS / (real)m->h) * (real)m->h, u, truth);
	for (int i = 0; i < m->states; i++)
		worst = worse(worst, (double)fabsl(y[i] - truth[i]));
	free(state);
	return worst;
}

static void has_order(int stages, int wide, int narrow, double margin)
{
	const pl_model *a = variant_of(steps, "pushed_%d_radau_%d", stages, wide)->model;
	const pl_model *b = variant_of(steps, "pushed_%d_radau_%d", stages, narrow)->model;
	const double coarse = error_of(a), fine = error_of(b), found = log(coarse / fine) / log(a->h / b->h);
	const bool good = close_to(found, 2 * stages - 1, margin, "order of %d stages", stages);
	ok(good && fine > 1e-14, "%d stages: order %.2f (errors %.3g, %.3g)", stages, found, coarse, fine);
}

/* ---- random starts ---- */

enum { SECONDS = 20, MOST_STARTS = 200 };

/* The same for all, with the solutions by as many explicit steps as it takes, at whole seconds */
static struct start {
	double y[2];
	real truth[SECONDS][2];
} drawn[MOST_STARTS];

static void draw_starts(int count)
{
	const struct subject s = {.name = "relax", .f = relax, .piece = 0.002L};
	const pl_model *m = variant_of(steps, "relax_auto_0")->model;
	for (struct start *d = drawn; d < drawn + count; d++) {
		for (int i = 0; i < 2; i++)
			d->y[i] = (i ? 300 : 4) * random_number();
		real truth[2] = {d->y[0], d->y[1]};
		for (int second = 0; second < SECONDS; second++) {
			solve(&s, m, second, second + 1, NULL, truth);
			memcpy(d->truth[second], truth, sizeof truth);
		}
	}
}

/* None fails; errors over the tolerance in the mean */
static void starts(const char *name, int count, double tolerance, double mean_bound)
{
	const pl_model *m = variant_of(steps, "%s", name)->model;
	double sum = 0, worst = 0;
	int failed = 0;
	for (const struct start *d = drawn; d < drawn + count; d++) {
		double y[2], most[2] = {fabs(d->y[0]), fabs(d->y[1])}, error = 0;
		void *state = fresh(m);
		m->set(state, 0, d->y);
		for (int second = 0; second < SECONDS; second++) {
			m->run(state, (size_t)lround(1 / m->h), NULL, NULL);
			m->get(state, y);
			for (int i = 0; i < 2; i++) {
				most[i] = fmax(most[i], fabs((double)d->truth[second][i]));
				error = worse(error, (double)fabsl(y[i] - d->truth[second][i]) / most[i]);
			}
		}
		failed += m->status(state) != 0 || !isfinite(y[0]);
		sum += log(fmax(error, 1e-18) / tolerance);
		worst = worse(worst, error / tolerance);
		free(state);
	}
	const double mean = exp(sum / count);
	ok(close_to(mean, 0, mean_bound, "%s: error over tolerance", name) && failed == 0,
		"%s: %d random starts, %d failed; error over tolerance %.2g in the mean, at most %.2g", name, count,
		failed,
		mean, worst);
}

/* ---- float ---- */

static void in_float(void)
{
	const struct subject s = {.name = "relax", .f = relax, .piece = 0.005L};
	const pl_model *m = variant_of(steps, "relax_auto_0")->model;
	relax_float single;
	real truth[2];
	double worst = 0, between = 0;
	float y[2], at[2];
	relax_float_init(&single);
	relax_float_get(&single, y);
	for (int i = 0; i < 2; i++)
		truth[i] = y[i];
	for (int k = 0; k < 500; k++) {
		relax_float_at(&single, 0.05f, at);
		relax_float_step(&single);
		relax_float_get(&single, y);
		solve(&s, m, k * 0.1L, (k + 0.5L) * 0.1L, NULL, truth);
		between = worse(between, (double)fabsl(at[0] - truth[0]));
		solve(&s, m, (k + 0.5L) * 0.1L, (k + 1) * 0.1L, NULL, truth);
		worst = worse(worst, (double)fabsl(y[0] - truth[0]));
	}
	bool good = close_to(worst, 0, 2e-4, "states in float") && close_to(between, 0, 2e-4, "between steps");
	ok(good && relax_float_status(&single) == 0, "float, tolerance 1e-5: %.2g, between %.2g", worst, between);
}

/* ---- what ends ---- */

static void ends_of(const char *name, int bit, double from, double to)
{
	ends(variant_of(steps, "%s", name)->model, bit, from, to, false);
}

int main(void)
{
	for (int i = 0; i < SUBJECTS; i++)
		for (int scheme = 0; scheme < 2; scheme++) {
			const pl_model *m = variant_of(steps, "%s_%s_0", subjects[i].name, scheme ? "auto"
					: "radau")->model;
			follows(&subjects[i], m);
			same_bits(m);
		}
	has_order(3, 2, 3, 0.4);
	has_order(5, 1, 2, 0.7);
	has_order(7, 0, 1, 2.2);         /* within, they are of order stages + 1 */
	has_order(9, 0, 1, 2.5);
	const int count = getenv("LONG") ? MOST_STARTS : 25;
	draw_starts(count);
	starts("relax_e6_radau_0", count, 1e-6, 1);
	starts("relax_e6_auto_0", count, 1e-6, 1);
	starts("relax_e12_radau_0", count, 1e-12, 1);
	starts("relax_e12_auto_0", count, 1e-12, 1);
	in_float();
	ends_of("pole_radau_0", PL_NOT_FINITE, 0.55, 0.65);
	ends_of("pole_auto_0", PL_NOT_FINITE, 0.55, 0.65);
	ends_of("root_radau_0", PL_NOT_FINITE, 1.05, 1.15);
	ends_of("root_auto_0", PL_NOT_FINITE, 1.05, 1.15);
	ends_of("hurried_radau_0", PL_TOO_MANY_STEPS, 79, 91);
	ends_of("hurried_auto_0", PL_TOO_MANY_STEPS, 79, 91);
	return tap_end();
}
