/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A run that leaves the finite numbers: the status says so, stays, and is cleared by init and set; nothing traps. */
#include "status_variants.h"
#include "tap.h"

#include <math.h>

static const char *const schemes[] = {"etd1", "etdrk2", "etdrk4", "nc2", "nc3", "dq4", "bm3"};

static void same(int found, int expected, const char *scheme, const char *when)
{
	ok(close_to(found, expected, 0, "%s, %s: status", scheme, when), "%s: status %s", scheme, when);
}

static bool finite_state(const pl_model *m, const void *state)
{
	double y[8];
	bool finite = true;
	m->get(state, y);
	for (int i = 0; i < m->states; i++)
		finite = finite && isfinite(y[i]);
	return finite;
}

static void blows_up(const char *scheme)
{
	static const double rest[4];
	const pl_model *m = variant_of(status, "blowup_%s_0", scheme)->model;
	void *state = calloc(1, m->size), *saved = calloc(1, m->size);
	int steps = 0;
	if (!ok(m->status != NULL, "%s: a model with a remainder has a status", scheme))
		return;
	m->init(state);
	same(m->status(state), 0, scheme, "after init");
	while (finite_state(m, state) && steps < 1000) {
		same(m->status(state), 0, scheme, "while all is finite");
		memcpy(saved, state, m->size);
		m->step(state, NULL);
		steps++;
	}
	ok(steps < 1000, "%s: it does leave the finite numbers (after %d steps)", scheme, steps);
	same(m->status(state), PL_NOT_FINITE, scheme, "then");
	for (int k = 0; k < 10; k++)
		m->step(state, NULL);
	same(m->status(state), PL_NOT_FINITE, scheme, "ten steps later");
	memcpy(state, saved, m->size);
	same(m->status(state), 0, scheme, "of what was saved before");
	m->run(state, 10, NULL, NULL);
	same(m->status(state), PL_NOT_FINITE, scheme, "after run");
	m->set(state, 3, rest);
	same(m->status(state), 0, scheme, "after set");
	m->run(state, 10, NULL, NULL);
	same(m->status(state), 0, scheme, "of a run from there");
	ok(close_to(m->time(state), 4, 1e-15 * 4, "time"), "%s: set has set the time too", scheme);
	m->init(state);
	m->run(state, 1000, NULL, NULL);
	same(m->status(state), PL_NOT_FINITE, scheme, "of the whole run again");
	m->init(state);
	same(m->status(state), 0, scheme, "after init again");
	free(state);
	free(saved);
}

/* Finite again by the caller's own hand, but not set: the status stays. */
static void sticky(void)
{
	blowup_etdrk4_0 s;
	blowup_etdrk4_0_init(&s);
	blowup_etdrk4_0_run(&s, 100, NULL);
	same(blowup_etdrk4_0_status(&s), PL_NOT_FINITE, "etdrk4", "after 100 steps");
	for (int i = 0; i < BLOWUP_ETDRK4_0_STATES; i++)
		s.y[i] = 0;
	blowup_etdrk4_0_step(&s);
	ok(isfinite(s.y[0]) && s.y[0] == 0, "the state is finite again");
	same(blowup_etdrk4_0_status(&s), PL_NOT_FINITE, "etdrk4", "although the state is finite again");
}

static void in_range(const char *scheme)
{
	const pl_model *m = variant_of(status, "pendulum_%s_0", scheme)->model;
	void *state = calloc(1, m->size);
	static const double bad[] = {NAN, 1};
	m->init(state);
	m->run(state, 10000, NULL, NULL);
	same(m->status ? m->status(state) : -1, 0, scheme, "of a pendulum after 10,000 steps");
	m->set(state, 0, bad);
	m->step(state, NULL);
	same(m->status ? m->status(state) : -1, PL_NOT_FINITE, scheme, "of a step from what is no number");
	m->init(state);
	same(m->status ? m->status(state) : -1, 0, scheme, "of the pendulum after init");
	free(state);
}

static void by_input(const char *scheme)
{
	const pl_model *m = variant_of(status, "held_%s_0", scheme)->model;
	void *state = calloc(1, m->size);
	m->init(state);
	m->step(state, (double[]){1, -1});
	same(m->status ? m->status(state) : -1, 0, scheme, "with inputs");
	m->step(state, (double[]){INFINITY, 0});
	same(m->status ? m->status(state) : -1, PL_NOT_FINITE, scheme, "of a step with an infinite sample");
	free(state);
}

int main(void)
{
	for (size_t i = 0; i < sizeof schemes / sizeof *schemes; i++) {
		blows_up(schemes[i]);
		in_range(schemes[i]);
	}
	sticky();
	by_input("etdrk4");
	by_input("bm3");
	ok(variant_of(status, "scs_exact_0")->model->status != NULL, "a linear model has one too");
	return tap_end();
}
