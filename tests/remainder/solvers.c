/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_rhs, the equations as written, against equations by hand at random points; and its solution by CVODE against the
 * steps, with inputs too (the solver restarts at each sample). */
#include "solvers_variants.h"
#include "systems.h"
#include "tap.h"
#include "truth.h"

#include <math.h>

enum { POINTS = 1000, MOST = 8 };

static const double rounding = 1e-13;       /* of dydt, over its largest term in size */
static const double relative = 1e-11;       /* tolerance of CVODE */

struct subject {
	const struct variant *of;
	void (*rhs)(double t, const double *y, double *dydt);
	void (*rhs_sampled)(double t, const double *y, const double *u, double *dydt);
	void (*by_hand)(real t, const real *y, const real *u, real *dydt);
	enum solver solver;
	bool ramp;
	/* change: a time at which a load changes; tolerance over the largest value */
	double seconds, change, tolerance;
	double size[MOST];                      /* of random states */
};

static double random_number(void)
{
	static unsigned seed = 1;
	seed = seed * 1103515245u + 12345u;
	return (double)(seed >> 8) / 8388608 - 1;
}

static void slopes_of(const void *subject, double t, const double *y, const double *u, double *dydt)
{
	const struct subject *s = subject;
	if (s->rhs)
		s->rhs(t, y, dydt);
	else
		s->rhs_sampled(t, y, u, dydt);
}

static void as_written(const struct subject *s)
{
	const pl_model *m = s->of->model;
	double worst = 0, most[MOST] = {0};
	bool good = true;
	for (int point = -POINTS; point < POINTS; point++) {       /* the first half only to see sizes */
		double y[MOST], u[MOST], dydt[MOST];
		real wide[MOST], inputs[MOST], expected[MOST];
		const double t = 10 * fabs(random_number());
		for (int i = 0; i < m->states; i++)
			wide[i] = y[i] = s->size[i] * random_number();
		for (int i = 0; i < 2 * m->inputs; i++)
			inputs[i] = u[i] = i < m->inputs || s->ramp ? random_number() : 0;
		slopes_of(s, t, y, u, dydt);
		s->by_hand(t, wide, inputs, expected);
		for (int i = 0; i < m->states; i++) {
			most[i] = fmax(most[i], fabs((double)expected[i]));
			if (point < 0)
				continue;
			good = close_to(dydt[i], (double)expected[i], rounding * most[i], "%s_rhs, d %s/dt", m->name,
				m->state_names[i]) && good;
			worst = worse(worst, fabs(dydt[i] - (double)expected[i]) / most[i]);
		}
	}
	ok(good, "%s_rhs: the equations by hand at %d points (largest difference %.2g)", m->name, POINTS, worst);
}

/* From one time to another, with a restart where a load changes. */
static bool advance(const struct subject *s, struct truth *solver, double from, double to, const double *u, double *y)
{
	const int inputs = s->of->model->inputs;
	if (!(s->change > from && s->change < to))
		return truth_advance(solver, from, to, inputs, u, y);
	return truth_advance(solver, from, nextafter(s->change, 0), inputs, u, y) &&
		truth_advance(solver, s->change, to, inputs, u, y);
}

/* Rows where the two are compared: each sample, or half a second without inputs. */
static void by_solver(const struct subject *s)
{
	const pl_model *m = s->of->model;
	const int every = m->inputs ? 1 : (int)lround(0.5 / m->h), rows = (int)lround(s->seconds / (every * m->h));
	double x[MOST], y[MOST], most[MOST] = {0}, u[2 * MOST] = {0}, before[MOST] = {0}, worst = 0;
	bool good = true;
	void *state = calloc(1, m->size);
	m->init(state);
	m->get(state, y);
	for (int k = 0; k < rows * every; k++) {            /* once for the sizes */
		double zero[MOST] = {0};
		m->get(state, x);
		for (int i = 0; i < m->states; i++)
			most[i] = fmax(most[i], fabs(x[i]));
		m->step(state, m->inputs ? zero : NULL);
	}
	struct truth *solver = truth_new(m->states, slopes_of, s, s->solver, relative, most);
	m->init(state);
	for (int row = 0; row < rows && good; row++) {
		const double from = row * every * m->h, to = (row + 1) * every * m->h;
		double sample[MOST];
		for (int i = 0; i < m->inputs; i++) {
			/* held: anything; a ramp: smooth but for its corners, since the remainder has its cube */
			sample[i] = s->ramp ? sin(2 * to + i) : random_number();
			u[i] = s->ramp ? before[i] : sample[i];
			u[m->inputs + i] = s->ramp ? (sample[i] - before[i]) / m->h : 0;
			before[i] = sample[i];
		}
		if (m->inputs)
			m->step(state, sample);
		else
			m->run(state, (size_t)every, NULL, NULL);
		m->get(state, x);
		good = advance(s, solver, from, to, u, y);
		for (int i = 0; i < m->states; i++) {
			most[i] = fmax(most[i], fabs(x[i]));
			good = close_to(x[i], y[i], s->tolerance * most[i], "%s, t = %g, "
				"%s", m->name, to, m->state_names[i]) &&
				good;
			worst = worse(worst, fabs(x[i] - y[i]) / most[i]);
		}
	}
	ok(good, "%s: CVODE at rtol %.0e agrees within %.0e over %g s (largest difference %.2g)", m->name, relative,
		s->tolerance, s->seconds, worst);
	truth_free(solver);
	free(state);
}

static void knock(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = (t < 0.605L ? 10 * sinl(3.14159265358979323846264338327950288L * t / 0.605L) : 0) - 0.2L * y[1] -
		4 * y[0] - y[0] * y[0] * y[0];
}

static void gated(real t, const real *y, const real *u, real *dydt)
{
	dydt[0] = y[1];
	dydt[1] = (t < 0.3L ? 1 : 0.5L * u[0]) - y[0] - y[0] * y[0] * y[0];
}

static void mixed(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = (t < 0.305L ? 1 : 0) - 3 * y[0] - sinl(t * t);
}

static void judge(const char *name, struct subject s)
{
	s.of = variant_of(solvers, "%s_0", name);
	for (int i = 0; i < MOST && s.size[0] == 0; i++)
		s.size[i] = 1.5;
	if (!s.by_hand)
		s.by_hand = system_of(name)->equations;
	as_written(&s);
	by_solver(&s);
}

int main(void)
{
	judge("pendulum", (struct subject){.rhs = pendulum_0_rhs, .solver = CVODE_ADAMS, .seconds = 30,
			.tolerance = 1e-8});
	judge("vanderpol", (struct subject){.rhs = vanderpol_0_rhs, .solver = CVODE_ADAMS, .seconds = 30,
		.tolerance = 1e-7});
	judge("vanderpol_stiff", (struct subject){.rhs = vanderpol_stiff_0_rhs, .solver = CVODE_BDF, .seconds = 75,
		.tolerance = 1e-7});
	judge("quad2dof", (struct subject){.rhs = quad2dof_0_rhs, .solver = CVODE_ADAMS, .seconds = 30,
			.tolerance = 1e-7});
	judge("duffing", (struct subject){.rhs = duffing_0_rhs, .solver = CVODE_ADAMS, .seconds = 30,
			.tolerance = 1e-7});
	judge("mathieu", (struct subject){.rhs = mathieu_0_rhs, .solver = CVODE_ADAMS, .seconds = 30,
			.tolerance = 1e-7});
	judge("held", (struct subject){.rhs_sampled = held_0_rhs, .solver = CVODE_ADAMS, .seconds = 5,
			.tolerance = 1e-6});
	judge("ramped", (struct subject){.rhs_sampled = ramped_0_rhs, .solver = CVODE_ADAMS, .ramp = true, .seconds = 5,
		.tolerance = 1e-6});
	judge("thermal", (struct subject){.rhs = thermal_0_rhs, .solver = CVODE_ADAMS, .seconds = 10,
			.tolerance = 1e-6});
	judge("coupled", (struct subject){.rhs = coupled_0_rhs, .solver = CVODE_ADAMS, .seconds = 10,
			.tolerance = 1e-6});
	judge("rotor", (struct subject){.rhs = rotor_0_rhs, .solver = CVODE_ADAMS, .seconds = 10, .tolerance = 1e-6});
	judge("functions", (struct subject){.rhs = functions_0_rhs, .solver = CVODE_ADAMS, .seconds = 5,
		.tolerance = 1e-5});
	static const struct { const char *name; double tolerance; } knocks[] = {{"knock_etd1", 0.05},
		{"knock_etdrk2", 2e-4}, {"knock_etdrk4", 1e-7},
		{"knock_nc2", 1e-7}, {"knock_nc3", 1e-7}, {"knock_dq4", 1e-7}, {"knock_bm3", 1e-7}};
	for (size_t i = 0; i < sizeof knocks / sizeof *knocks; i++)
		judge(knocks[i].name, (struct subject){.rhs = knock_etdrk4_0_rhs, .by_hand = knock,
				.solver = CVODE_ADAMS,
			.seconds = 10,
								   .change = 0.605, .tolerance = knocks[i].tolerance});
	/* what the input's gate lets through is left over, so a step at the gate sees both sides of the jump: h/6 of it
	 * */
	static const char *const guard_rows[] = {"gated_etdrk4", "gated_bm3"};
	for (int i = 0; i < 2; i++)
		judge(guard_rows[i],
			  (struct subject){.rhs_sampled = gated_etdrk4_0_rhs, .by_hand = gated, .solver = CVODE_ADAMS,
			.seconds = 5,
										 .tolerance = 5e-3});
	static const char *const mixtures[] = {"mixed_etdrk4", "mixed_bm3"};
	for (int i = 0; i < 2; i++)
		judge(mixtures[i], (struct subject){.rhs = mixed_etdrk4_0_rhs, .by_hand = mixed, .solver = CVODE_ADAMS,
			.seconds = 3, .change = 0.305,
											.tolerance = 1e-6});
	return tap_end();
}
