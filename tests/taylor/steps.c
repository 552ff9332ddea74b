/* SPDX-License-Identifier: MIT-0 */
/* What steps by series do: every step and every value between, against the equations by hand in long double; orders;
 * what is the same bit for bit; CVODE; energy; what ends. LONG=1: a million outputs. */
#include "followed.h"
#include "soon_float_pl.h"
#include "steps_variants.h"
#include "swing_float_pl.h"
#include "systems.h"
#include "tap.h"
#include "truth.h"

#include <math.h>

static void sparse(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = -t * t * y[0] * y[0];
}

/* soon; and late, of which time counts from 4194304 */
static void stiffening(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = (t < 0.5L ? -1 : -4) * sinl(y[0]);
}

static void rising(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = t * t * t * t * t - y[0] * y[0] * y[0];
}

static void later(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = (t < 1 ? 0 : (t - 1) * (t - 1) * (t - 1) * (t - 1)) - y[0] * y[0] * y[0];
}

static const struct subject subjects[] = {{.name = "pendulum"}, {.name = "vanderpol"}, {.name = "duffing"},
	{.name = "mathieu"}, {.name = "quad2dof"}, {.name = "held"}, {.name = "ramped"}, {.name = "thermal"},
	{.name = "coupled"}, {.name = "rotor"}, {.name = "growth"}, {.name = "chain"}, {.name = "masses", .f = masses},
	{.name = "sparse", .f = sparse},
	{.name = "timed", .f = timed, .changes = 1, .change = {1.2345678L}},
	{.name = "changing", .f = changing, .changes = 5, .change = {0.37L, 0.55L, 0.62L, 0.81L, 0.9L}}};
enum { SUBJECTS = sizeof subjects / sizeof *subjects };

static const struct subject *subject_of(const char *name)
{
	for (int i = 0; i < SUBJECTS; i++)
		if (strcmp(subjects[i].name, name) == 0)
			return &subjects[i];
	abort();
}

/* ---- every step ---- */

static void follows(const struct subject *s, const pl_model *m, double bound)
{
	const struct found worst = follow(s, m);
	bool good = close_to(worst.step, 0, bound, "%s: states after steps", m->name);
	good = close_to(worst.middle, 0, bound, "%s: states in the middle of steps", m->name) && good;
	/* the same sum in another order */
	good = close_to(worst.end, 0, 1e-15, "%s: NAME_at at the end of steps, beside the step", m->name) && good;
	ok(good, "%s: steps, their middles and ends (%.2g, %.2g, %.2g)", m->name, worst.step, worst.middle, worst.end);
}

/* ---- orders ---- */

/* The largest error at `points` equal times, over the largest start; from rest itself */
static double error_at(const struct subject *s, const pl_model *m, double seconds, int points)
{
	double y[MOST], worst = 0, most = 0;
	real truth[MOST];
	void *state = fresh(m);
	m->get(state, y);
	for (int i = 0; i < m->states; i++) {
		truth[i] = y[i];
		most = fmax(most, fabs(y[i]));
	}
	most = most > 0 ? most : 1;
	for (int k = 0; k < points; k++) {
		m->run(state, (size_t)lround(seconds / points / m->h), NULL, NULL);
		m->get(state, y);
		solve(s, m, (real)seconds * k / points, (real)seconds * (k + 1) / points, NULL, truth);
		for (int i = 0; i < m->states; i++)
			worst = worse(worst, (double)fabsl(y[i] - truth[i]) / most);
	}
	free(state);
	return worst;
}

static void has_order(const char *name, const char *kind, int order, double seconds)
{
	const double margin = order == 4 ? 0.15 : order == 8 ? 0.3 : 1.1;
	const struct subject *s = subject_of(name);
	const pl_model *wide = variant_of(steps, "%s%s_%d_0", name, kind, order)->model;
	const pl_model *narrow = variant_of(steps, "%s%s_%d_1", name, kind, order)->model;
	const int points = (int)lround(seconds / wide->h);
	double coarse = error_at(s, wide, seconds, points), fine = error_at(s, narrow, seconds, points);
	double found = log(coarse / fine) / log(wide->h / narrow->h);
	bool good = close_to(found, order, margin, "%s%s, order %d", name, kind, order);
	ok(good && fine > 1e-15, "%s%s: order %d is %.2f (errors %.3g, %.3g)", name, kind, order, found, coarse, fine);
}

/* ---- one expansion over several steps ---- */

/* Every `times`-th state of one is the next of the other, bit for bit */
static void same_states(const char *name, const char *other, int times)
{
	const pl_model *m = variant_of(steps, "%s", name)->model, *wide = variant_of(steps, "%s", other)->model;
	void *state = fresh(m), *wide_state = fresh(wide);
	double y[MOST] = {0}, expected[MOST] = {0}, worst = 0;
	bool good = true;
	for (int k = 0; k < STEPS; k++) {
		for (int i = 0; i < times; i++)
			m->step(state, NULL);
		wide->step(wide_state, NULL);
		m->get(state, y);
		wide->get(wide_state, expected);
		good = good && memcmp(y, expected, sizeof y) == 0;
		for (int i = 0; i < m->states; i++)
			worst = worse(worst, fabs(y[i] - expected[i]));
	}
	ok(good && m->status(state) == 0, "%s: %d steps are one of %s, bit for bit (%.2g)", name, times, other, worst);
	free(state);
	free(wide_state);
}

/* Rows from wherever an expansion stands: so many steps, then so many by NAME_run, with rows or without */
static void rows_from_inside(const char *name, int over)
{
	const pl_model *m = variant_of(steps, "%s", name)->model;
	const size_t outputs = (size_t)m->outputs;
	double *all = calloc(STEPS * outputs, sizeof *all), *rows = calloc(STEPS * outputs, sizeof *rows);
	bool good = true;
	void *state = fresh(m);
	for (size_t k = 0; k < STEPS; k++) {
		m->step(state, NULL);
		m->out(state, all + k * outputs);
	}
	for (int before = 0; before <= over; before++)
		for (int n = 1; n <= 3 * over; n++)
			for (int written = 0; written < 2; written++) {
				m->init(state);
				m->run(state, (size_t)before, NULL, NULL);
				m->run(state, (size_t)n, NULL, written ? rows : NULL);
				if (!written)
					m->out(state, rows + (size_t)(n - 1) * outputs);
				size_t from = written ? 0 : (size_t)n - 1;
				good = good && memcmp(rows + from * outputs, all + ((size_t)before + from) * outputs,
					((size_t)n - from) * outputs * sizeof *rows) == 0;
			}
	ok(good, "%s: rows from inside an expansion", name);
	free(all);
	free(rows);
	free(state);
}

static void over_several(void)
{
	static const char *const names[] = {"pendulum", "vanderpol", "duffing", "mathieu", "quad2dof", "rotor",
			"masses",
		"growth"};
	static const char *const measured[] = {"pendulum", "duffing", "mathieu"};
	char name[40];
	for (size_t i = 0; i < sizeof names / sizeof *names; i++) {
		const pl_model *m = variant_of(steps, "%s_over_0", names[i])->model;
		follows(subject_of(names[i]), m, 1e-14);
		same_bits(m);
		snprintf(name, sizeof name, "%s_over_0", names[i]);
		rows_from_inside(name, strcmp(names[i], "mathieu") == 0 ? 3 : 4);
	}
	same_states("pendulum_over_single_0", "pendulum_single_0", 1);
	same_states("masses_over_single_0", "masses_single_0", 1);
	same_states("rotor_over_single_0", "rotor_single_0", 1);
	same_states("pendulum_over_fifth_0", "pendulum_single_0", 5);
	same_states("rotor_over_fifth_0", "rotor_single_0", 5);
	for (size_t i = 0; i < sizeof measured / sizeof *measured; i++)
		for (int order = 4; order <= 8; order += 4)
			has_order(measured[i], "_over", order, 2);
}

/* ---- CVODE ---- */

static void beside_cvode(void)
{
	const struct system *s = system_of("quad2dof");
	const pl_model *m = variant_of(steps, "quad2dof_taylor_0")->model;
	const double scale[] = {0.1, 0.1, 0.1, 0.1};
	struct truth *solver = truth_new(4, system_slopes, s, CVODE_ADAMS, 1e-12, scale);
	void *state = fresh(m);
	double y[4], truth[4], worst = 0;
	m->get(state, truth);
	bool good = true;
	for (int k = 1; k <= 40; k++) {
		good = truth_advance(solver, (k - 1) * m->h, k * m->h, 0, NULL, truth) && good;
		m->step(state, NULL);
		m->get(state, y);
		for (int i = 0; i < 4; i++)
			worst = worse(worst, fabs(y[i] - truth[i]));
	}
	truth_free(solver);
	free(state);
	ok(close_to(worst, 0, 1e-10, "quad2dof beside CVODE") && good, "quad2dof beside CVODE at 1e-12 (%.2g)", worst);
}

/* ---- float ---- */

static void in_float(void)
{
	const struct subject *s = subject_of("pendulum");
	swing_float single;
	const pl_model *m = variant_of(steps, "pendulum_taylor_0")->model;
	real truth[2];
	double worst = 0, between = 0;
	float y[2], at[2];
	swing_float_init(&single);
	swing_float_get(&single, y);
	for (int i = 0; i < 2; i++)
		truth[i] = y[i];
	for (int k = 0; k < 100; k++) {
		real half[2] = {truth[0], truth[1]};
		swing_float_at(&single, 0.05f, at);
		swing_float_step(&single);
		swing_float_get(&single, y);
		solve(s, m, k * 0.1L, (k + 0.5L) * 0.1L, NULL, half);
		solve(s, m, k * 0.1L, (k + 1) * 0.1L, NULL, truth);
		for (int i = 0; i < 2; i++) {
			worst = worse(worst, (double)fabsl(y[i] - truth[i]));
			between = worse(between, (double)fabsl(at[i] - half[i]));
		}
	}
	bool good = close_to(worst, 0, 2e-5, "states in float") && close_to(between, 0, 2e-5, "between steps");
	ok(good && swing_float_status(&single) == 0, "float, tolerance 1e-5: %.2g, between %.2g", worst, between);
}

/* ---- a condition on t that changes at a step ---- */

enum { LATE = 4194304, LATE_STEPS = 16 };

/* Both to the same truth, of which time counts from the start */
static void late_changes(void)
{
	const struct subject soon = {.name = "soon", .f = stiffening, .changes = 1, .change = {0.5L}};
	const pl_model *m = variant_of(steps, "late_taylor_0")->model;
	const double start[2] = {1, 0};
	double worst = 0, worst_float = 0, y[2];
	float single[2];
	real truth[2] = {1, 0};
	soon_float s;
	void *state = fresh(m);
	soon_float_init(&s);
	m->set(state, LATE, start);
	for (int k = 0; k < LATE_STEPS; k++) {
		m->step(state, NULL);
		m->get(state, y);
		soon_float_step(&s);
		soon_float_get(&s, single);
		solve(&soon, m, k * 0.125L, (k + 1) * 0.125L, NULL, truth);
		for (int i = 0; i < 2; i++) {
			worst = worse(worst, (double)fabsl(y[i] - truth[i]));
			worst_float = worse(worst_float, (double)fabsl(single[i] - truth[i]));
		}
	}
	bool good = close_to(worst, 0, 2e-11, "states beside a change at %g s", LATE + 0.5);
	ok(good && m->status(state) == 0, "late: a change at a step, at %g s (%.2g)", LATE + 0.5, worst);
	good = close_to(worst_float, 0, 2e-5, "states in float beside a change at 0.5 s");
	ok(good && soon_float_status(&s) == 0, "soon: a change at a step, in float (%.2g)", worst_float);
	free(state);
}

/* ---- energy ---- */

static real swing_energy(const double *y) { return (real)y[1] * y[1] / 2 + 1 - cosl(y[0]); }
static real spring_energy(const double *y)
{
	real x = y[0];
	return (real)y[1] * y[1] / 2 + x * x / 2 + x * x * x * x / 4;
}

/* The series of swing without rounding, by their rule: of order 20, as long as the last two terms are below 1e-15 of
 * the largest value of each state where one began, twice as long as the one before at most. What they leave out goes
 * one way. c: of the angle, in powers of time over h */
enum { SWING_ORDER = 20 };
struct swinging {
	real angle, speed, largest[2], c[SWING_ORDER + 2];
	int most, serves, served;
};

static void expand_swing(struct swinging *p)
{
	const real h = 0.1L;
	real sine[SWING_ORDER + 1] = {sinl(p->angle)}, cosine[SWING_ORDER + 1] = {cosl(p->angle)};
	p->c[0] = p->angle;
	p->c[1] = p->speed * h;
	for (int k = 1; k <= SWING_ORDER; k++) {
		for (int j = 1; j <= k; j++) {
			sine[k] += j * p->c[j] * cosine[k - j] / k;
			cosine[k] -= j * p->c[j] * sine[k - j] / k;
		}
		p->c[k + 1] = -h * h * sine[k - 1] / (k * (k + 1));
	}
}

/* Coefficient k of the angle, or of the speed */
static real swing_coefficient(const struct swinging *p, int state, int k)
{
	return state ? (k + 1) * p->c[k + 1] / 0.1L : p->c[k];
}

static bool swing_serves(const struct swinging *p, int m)
{
	const real power = powl(m, SWING_ORDER - 1);
	bool good = true;
	for (int state = 0; state < 2; state++)
		for (int k = 0; k < 2; k++)
			good = good && fabsl(swing_coefficient(p, state, SWING_ORDER - k)) * (k ? power : m * power) <=
				1e-15L * p->largest[state];
	return good;
}

/* The energy a step later */
static real swing_left(struct swinging *p)
{
	real sum[2] = {0, 0};
	if (p->served == p->serves) {
		expand_swing(p);
		p->largest[0] = fmaxl(p->largest[0], fabsl(p->angle));
		p->largest[1] = fmaxl(p->largest[1], fabsl(p->speed));
		for (p->serves = 1; p->serves < p->most && swing_serves(p, p->serves + 1); p->serves++)
			;
		p->most = p->most ? 2 * p->serves : 1;      /* the first one is held against what follows */
		p->served = 0;
	}
	p->served++;
	for (int k = SWING_ORDER; k >= 0; k--)
		for (int state = 0; state < 2; state++)
			sum[state] = sum[state] * p->served + swing_coefficient(p, state, k);
	if (p->served == p->serves) {
		p->angle = sum[0];
		p->speed = sum[1];
	}
	return sum[1] * sum[1] / 2 + 1 - cosl(sum[0]);
}

/* bounds: over 1e4 outputs, over 1e6; beside the same series without rounding, NULL: beside the energy at the start */
static void holds_energy(const char *name, real (*energy)(const double *y), struct swinging *series, double soon,
	double late)
{
	const pl_model *m = variant_of(steps, "%s", name)->model;
	const long outputs = getenv("LONG") ? 1000000 : 10000;
	void *state = fresh(m);
	double y[2], worst = 0;
	m->get(state, y);
	const real start = energy(y);
	for (long k = 0; k < outputs; k++) {
		m->step(state, NULL);
		m->get(state, y);
		worst = worse(worst, (double)fabsl((energy(y) - (series ? swing_left(series) : start)) / start));
	}
	bool good = close_to(worst, 0, getenv("LONG") ? late : soon, "%s: energy", name);
	ok(good && m->status(state) == 0, "%s: energy over %ld outputs within %.2g", name, outputs, worst);
	free(state);
}

/* ---- what ends ---- */

static void ends_of(const char *name, int bit, double from, double to, bool same)
{
	ends(variant_of(steps, "%s", name)->model, bit, from, to, same);
}

static void endings(void)
{
	ends_of("pole_taylor_0", PL_NOT_FINITE, 0.55, 0.65, false);
	ends_of("pole_fixed_0", PL_INACCURATE, 0.25, 0.55, false);
	ends_of("pole_over_0", PL_INACCURATE, 0.05, 0.55, false);
	ends_of("root_over_0", PL_NOT_FINITE, 1.05, 1.35, true);
	ends_of("burst_over_0", PL_NOT_FINITE, 0.85, 1.65, true);
	ends_of("burst_over_watched_0", PL_INACCURATE, 0.65, 1.05, false);
	ends_of("stuck_over_0", PL_NOT_FINITE, 0.05, 0.15, true);
	ends_of("stuck_over_watched_0", PL_NOT_FINITE | PL_INACCURATE, 0.05, 0.15, true);
	ends_of("root_taylor_0", PL_NOT_FINITE, 1.05, 1.15, false);
	ends_of("root_fixed_0", PL_NOT_FINITE, 1.05, 1.25, true);
	ends_of("falling_taylor_0", PL_NOT_FINITE, 1.05, 1.15, false);
	ends_of("falling_fixed_0", PL_NOT_FINITE, 1.05, 1.25, true);
	ends_of("origin_taylor_0", PL_NOT_FINITE, 0.05, 0.15, true);
	ends_of("origin_fixed_0", PL_NOT_FINITE, 0.05, 0.15, true);
	ends_of("stuck_taylor_0", PL_NOT_FINITE, 0.05, 0.15, true);
	ends_of("stuck_fixed_0", PL_NOT_FINITE, 0.05, 0.15, true);
	ends_of("stuck_watched_0", PL_NOT_FINITE | PL_INACCURATE, 0.05, 0.15, true);
	ends_of("burst_taylor_0", PL_NOT_FINITE, 0.95, 1.15, false);
	ends_of("burst_fixed_0", PL_NOT_FINITE, 0.95, 1.65, true);
	ends_of("burst_watched_0", PL_INACCURATE, 0.85, 1.05, false);
	ends_of("flood_taylor_0", PL_NOT_FINITE, 11.75, 11.95, false);
	ends_of("flood_fixed_0", PL_NOT_FINITE, 11.75, 11.95, true);
	ends_of("stiff_taylor_0", PL_TOO_MANY_STEPS, 0.05, 0.15, false);
	ends_of("coarse_0", PL_INACCURATE, 0.45, 0.55, false);
	ends_of("coarser_0", PL_INACCURATE, 0.45, 0.55, false);
}

static void pushed(real t, const real *y, const real *u, real *dydt)
{
	(void)t;
	dydt[0] = y[1];
	dydt[1] = u[0] - y[0] * y[0] * y[0] * y[0] * y[0];
}

/* An input that begins while the model is at rest */
static void from_a_push(void)
{
	const pl_model *m = variant_of(steps, "pushed_taylor_0")->model;
	const double none = 0, push = 1;
	const real u[2] = {push, 0};
	real truth[HAND_MOST] = {0};
	double y[2], error = 0;
	void *state = fresh(m);
	for (int k = 0; k < 3; k++)
		m->step(state, &none);
	m->step(state, &push);
	m->get(state, y);
	gragg(pushed, 2, 0, 2, 0.01L, 1, u, truth);
	for (int i = 0; i < 2; i++)
		error = worse(error, (double)fabsl(y[i] - truth[i]));
	ok(close_to(error, 0, 1e-8, "pushed") && m->status(state) == 0, "pushed: a step after rest (%.2g)", error);
	free(state);
}

static void sparser(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = -t * t * t * t * t * t * y[0] * y[0];
}

/* What the first series says nothing of, and the second little */
static void from_rest(void)
{
	static const struct subject thin[] = {{.name = "sparser", .f = sparser}, {.name = "rising", .f = rising},
		{.name = "later", .f = later, .changes = 1, .change = {1}}};
	for (int k = 0; k < 6; k++) {
		const struct subject *s = &thin[k / 2];
		const pl_model *m = variant_of(steps, "%s_taylor_%d", s->name, k % 2)->model;
		double error = error_at(s, m, 4, m->h >= 1 ? (int)lround(4 / m->h) : 8);
		ok(close_to(error, 0, 1e-8, "%s", m->name), "%s: four seconds from where it stands (%.2g)", m->name,
				error);
	}
}

int main(void)
{
	static const char *const measured[] = {"pendulum", "vanderpol", "duffing", "mathieu", "timed", "changing"};
	for (int i = 0; i < SUBJECTS; i++) {
		const struct subject *s = &subjects[i];
		const pl_model *adaptive = variant_of(steps, "%s_taylor_0", s->name)->model;
		const pl_model *fixed = variant_of(steps, "%s_fixed_0", s->name)->model;
		follows(s, adaptive, strcmp(s->name, "sparse") == 0 ? 2e-10 : 2e-11);        /* twice the tolerance */
		follows(s, fixed, strcmp(s->name, "ramped") == 0 ? 2e-11 : strcmp(s->name, "timed") == 0 ? 2e-13
				: 3e-15);
		same_bits(adaptive);
		same_bits(fixed);
	}
	for (size_t i = 0; i < sizeof measured / sizeof *measured; i++)
		for (int order = 4; order <= 12; order += 4)
			has_order(measured[i], "", order, 2);
	over_several();
	from_rest();
	from_a_push();
	beside_cvode();
	in_float();
	late_changes();
	holds_energy("swing_taylor_0", swing_energy, &(struct swinging){.angle = 1.0472L}, 6e-15, 5e-13);
	holds_energy("swing_fixed_0", swing_energy, NULL, 4e-15, 1e-13);
	holds_energy("spring_taylor_0", spring_energy, NULL, 4e-15, 1e-13);
	holds_energy("spring_fixed_0", spring_energy, NULL, 4e-15, 1e-13);
	endings();
	return tap_end();
}
