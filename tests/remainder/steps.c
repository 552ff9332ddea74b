/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Each step of the emitted code against the same scheme by hand, from the same state: every scheme, every kind of
 * model. */
#include "steps_variants.h"
#include "systems.h"
#include "tap.h"

#include <math.h>

enum { STEPS = 400 };

static const double tolerance = 1e-14;      /* of one step, over the largest value of the component */
static const char *const schemes[] = {"etd1", "etdrk2", "etdrk4", "nc2", "nc3", "dq4", "bm3"};

static double random_sample(unsigned *seed)
{
	*seed = *seed * 1103515245u + 12345u;
	return (double)(*seed >> 16) / 32768 - 1;
}

/* Samples of the inputs: row k holds during step k, or a ramp ends at it. */
static void samples(int inputs, double u[STEPS][HAND_MOST])
{
	unsigned seed = 1;
	for (int k = 0; k < STEPS; k++)
		for (int i = 0; i < inputs; i++)
			u[k][i] = random_sample(&seed);
}

/* The inputs during the step from row k, then their slopes; a ramp begins at 0. */
static void inputs_of(const struct system *s, bool ramp, double h, double u[STEPS][HAND_MOST], int k, real *w)
{
	for (int i = 0; i < s->inputs; i++) {
		const real before = k > 0 ? u[k - 1][i] : 0;
		w[i] = ramp ? before : (real)u[k][i];
		w[s->inputs + i] = ramp ? (u[k][i] - before) / (real)h : 0;
	}
}

/* The models whose inputs are ramps. */
static bool is_ramped(const struct system *s)
{
	return strncmp(s->name, "ramped", 6) == 0 || strncmp(s->name, "chain", 5) == 0;
}

static bool is_pl(const struct system *s)
{
	const size_t length = strlen(s->name);
	return length > 3 && strcmp(s->name + length - 3, "_pl") == 0;
}

struct subject {
	const struct system *system;
	const char *scheme;
	const pl_model *m;
	bool ramp;
	real h;
	double most[HAND_MOST], worst;          /* largest values; largest difference of a step over them */
};

/* Outputs are states, or accelerations ax and ay; the inputs are those at the end of the last step. */
static bool outputs(const struct subject *a, const void *state, real t, const real *y, const real *w)
{
	const struct system *s = a->system;
	const pl_model *m = a->m;
	double out[HAND_MOST];
	real dydt[HAND_MOST];
	bool good = true;
	m->out(state, out);
	s->equations(t, y, w, dydt);
	for (int i = 0; i < m->outputs; i++) {
		const char *name = m->output_names[i];
		const bool acceleration = strcmp(name, "ax") == 0 || strcmp(name, "ay") == 0;
		if (strcmp(name, m->state_names[i % m->states]) == 0 && i < m->states)
			good = close_to(out[i], (double)y[i], 0, "%s, t = %g, output %s", m->name, (double)t, name) &&
					good;
		else if (acceleration)
			good = close_to(out[i], (double)dydt[name[1] == 'x' ? 2 : 3],
				1e-12 * (1 + (double)(fabsl(dydt[2]) + fabsl(dydt[3]))),
							"%s, t = %g, output %s", m->name, (double)t, name) && good;
	}
	return good;
}

/* Steps from t0 on, each by hand from the same state. */
static bool run(struct subject *a, double t0, int count, const double *from)
{
	const struct system *s = a->system;
	const pl_model *m = a->m;
	static double u[STEPS][HAND_MOST], history[STEPS + 1][HAND_MOST];
	struct hand *p = hand_new(s, a->scheme, a->h);
	void *state = calloc(1, m->size);
	bool good = true;
	samples(s->inputs, u);
	m->init(state);
	if (from)
		m->set(state, t0, from);
	for (int k = 0; k <= count; k++) {
		m->get(state, history[k]);
		for (int i = 0; i < s->states; i++)
			a->most[i] = fmax(a->most[i], fabs(history[k][i]));
		if (k < count)
			m->step(state, s->inputs ? u[k] : NULL);
	}
	m->init(state);
	if (from)
		m->set(state, t0, from);
	for (int k = 0; k < count && good; k++) {
		real y[HAND_MOST], w[2 * HAND_MOST];
		for (int i = 0; i < s->states; i++)
			y[i] = history[k][i];
		inputs_of(s, a->ramp, m->h, u, k, w);
		hand_step(p, t0 + k * a->h, w, y);
		for (int i = 0; i < s->states; i++) {
			good = close_to(history[k + 1][i], (double)y[i], tolerance * a->most[i], "%s, step %d, %s",
					m->name, k + 1,
				m->state_names[i]) && good;
			a->worst = worse(a->worst, fabs(history[k + 1][i] - (double)y[i]) / a->most[i]);
		}
		m->run(state, 1, s->inputs ? u[k] : NULL, NULL);
		for (int i = 0; i < s->states; i++)
			y[i] = history[k + 1][i];
		for (int i = 0; i < s->inputs && a->ramp; i++)
			w[i] = u[k][i];
		good = outputs(a, state, t0 + (k + 1) * a->h, y, w) && good;
	}
	good = close_to(m->time(state), t0 + count * (double)a->h, 4e-16 * (t0 + count * m->h), "%s: time", m->name) &&
		good;
	free(state);
	hand_free(p);
	return good;
}

/* These go from crossing to crossing by exponential time differencing: tests/series_switching. */
static bool is_event_split(const struct system *s, const char *scheme)
{
	return strncmp(s->name, "functions", 9) == 0 && strncmp(scheme, "etd", 3) == 0;
}

static void judge(const struct system *s, const char *scheme)
{
	const pl_model *m = (is_pl(s) ? variant_of(steps, "%s_0", s->name) : variant_of(steps, "%s_%s_0", s->name,
		scheme))->model;
	/* a step such as 0.1 is exactly this decimal */
	struct subject a = {.system = s, .scheme = scheme, .m = m, .ramp = is_ramped(s),
			.h = 1 / roundl(1 / (real)m->h)};
	double y[HAND_MOST], other[HAND_MOST];
	if (!ok(m->states == s->states && m->inputs == s->inputs && !m->jump && m->status && m->at,
			"%s: states, inputs, and which functions there are", m->name))
		return;
	void *state = calloc(1, m->size);
	m->init(state);
	m->get(state, y);
	bool good = true;
	for (int i = 0; i < s->states; i++) {
		good = close_to(y[i], (double)s->start[i], 0, "%s: initial %s", m->name, m->state_names[i]) && good;
		other[i] = 0.9 * y[i] + 0.01;
	}
	free(state);
	good = run(&a, 0, STEPS, NULL) && good;
	ok(good && a.worst <= tolerance, "%s: %d steps as by hand, each within %.0e (largest difference %.2g)", m->name,
		STEPS, tolerance, a.worst);
	a.worst = 0;
	good = run(&a, 3.75, 20, other);
	ok(good, "%s: so from another state at 3.75 s (largest difference %.2g)", m->name, a.worst);
}

/* Between two steps of etd1 and pl the remainder is held, so NAME_at is etd1 over a part of the step. */
static void between(const struct system *s)
{
	const pl_model *m = (is_pl(s) ? variant_of(steps, "%s_0", s->name) : variant_of(steps, "%s_etd1_0",
		s->name))->model;
	const real h = 1 / roundl(1 / (real)m->h);
	const bool ramp = is_ramped(s);
	enum { PARTS = 4, FEW = 40 };
	static double u[STEPS][HAND_MOST];
	struct hand *p[PARTS + 1];
	double most[HAND_MOST] = {0}, worst = 0;
	void *state = calloc(1, m->size);
	bool good = true;
	for (int part = 0; part <= PARTS; part++)
		p[part] = hand_new(s, "etd1", h * part / PARTS);
	samples(s->inputs, u);
	m->init(state);
	for (int k = 0; k < FEW; k++) {
		double y[HAND_MOST], found[HAND_MOST], next[HAND_MOST];
		real w[2 * HAND_MOST];
		m->get(state, y);
		inputs_of(s, ramp, m->h, u, k, w);
		for (int part = 0; part <= PARTS; part++) {
			real expected[HAND_MOST];
			for (int i = 0; i < s->states; i++)
				expected[i] = y[i];
			hand_step(p[part], k * h, w, expected);
			m->at(state, s->inputs ? u[k] : NULL, (double)(h * part / PARTS), found);
			for (int i = 0; i < s->states; i++) {
				most[i] = fmax(most[i], fabs((double)expected[i]));
				good = close_to(found[i], (double)expected[i], 1e-14 * most[i] + 1e-17,
					"%s, step %d, %d parts of four, %s", m->name, k, part,
								m->state_names[i]) && good;
				worst = worse(worst, fabs(found[i] - (double)expected[i]) / fmax(most[i], 1e-3));
			}
		}
		m->step(state, s->inputs ? u[k] : NULL);
		m->get(state, next);
		for (int i = 0; i < s->states; i++)
			good = close_to(found[i], next[i], 1e-14 * most[i] + 1e-17,
					"%s, step %d, h against the step, %s", m->name,
				k, m->state_names[i]) && good;
	}
	ok(good, "%s: between steps as by hand (largest difference %.2g)", m->name, worst);
	for (int part = 0; part <= PARTS; part++)
		hand_free(p[part]);
	free(state);
}

/* The previous sample of a ramp, set by the caller. */
static void previous_sample(void)
{
	const struct system *s = system_of("ramped");
	struct hand *p = hand_new(s, "etdrk4", 0.01L);
	const double before[] = {0.7, -0.4}, after[] = {0.3, 0.6};
	real y[HAND_MOST], w[] = {0.7, -0.4, -40, 100};
	bool good = true;
	ramped_etdrk4_0 state;
	ramped_etdrk4_0_init(&state);
	ramped_etdrk4_0_hold(&state, before);
	ramped_etdrk4_0_step(&state, after);
	memcpy(y, s->start, sizeof y);
	hand_step(p, 0, w, y);
	for (int i = 0; i < s->states; i++)
		good = close_to(state.y[i], (double)y[i], 1e-14, "after hold, entry %d", i) && good;
	ok(good, "ramped: hold sets the previous sample");
	hand_free(p);
}

/* NAME_Phi is e^{Ah}: of a bank, of its first. */
static void transfer(const struct system *s)
{
	const struct variant *v = variant_of(steps, "%s_etdrk4_0", s->name);
	const int n = s->states, size = size_of(s);
	struct hand *p = hand_new(s, "etdrk4", 1 / roundl(1 / (real)v->model->h));
	bool good = v->model->states == n;
	for (int i = 0; i < n && good; i++) {
		for (int j = 0; j < n; j++) {
			const double entry = (double)hand_flow(p, 0)[i * size + j];
			good = close_to(v->Phi[i * n + j], entry, 1e-14 * fabs(entry) + 1e-17, "%s: Phi[%d][%d]",
					s->name, i, j) &&
				good;
		}
	}
	ok(good, "%s: Phi is e^{Ah}", s->name);
	hand_free(p);
}

int main(void)
{
	for (int i = 0; i < systems_count; i++) {
		if (!is_event_split(&systems[i], "etd1"))
			between(&systems[i]);
		if (is_pl(&systems[i])) {
			judge(&systems[i], "etd1");
			continue;
		}
		transfer(&systems[i]);
		for (size_t j = 0; j < sizeof schemes / sizeof *schemes; j++)
			if (!is_event_split(&systems[i], schemes[j]))
				judge(&systems[i], schemes[j]);
	}
	previous_sample();
	return tap_end();
}
