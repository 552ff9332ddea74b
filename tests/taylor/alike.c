/* SPDX-License-Identifier: MIT-0 */
#include "alike.h"
#include "tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 60, HALF = STEPS / 2, MOST = 40 };

double random_number(void)
{
	static unsigned seed = 1;
	seed = seed * 1103515245u + 12345u;
	return (double)(seed >> 8) / 8388608 - 1;
}

void *fresh(const pl_model *m)
{
	void *state = calloc(1, m->size);
	m->init(state);
	return state;
}

void same_bits(const pl_model *m)
{
	const size_t inputs = (size_t)m->inputs, outputs = (size_t)m->outputs;
	double *u = calloc(STEPS * inputs + 1, sizeof *u), *out = calloc(STEPS * outputs, sizeof *out);
	double *again = calloc(STEPS * outputs, sizeof *again), y[MOST], back[MOST];
	void *state = fresh(m), *saved = calloc(1, m->size), *other = fresh(m);
	for (size_t i = 0; i < STEPS * inputs; i++)
		u[i] = random_number();
	m->run(state, STEPS, u, out);
	m->init(state);                                             /* renews what the run left */
	if (m->hold)
		m->hold(state, (const double[MOST]){0});
	for (size_t k = 0; k < STEPS; k++) {
		if (m->at)
			m->at(state, u + k * inputs, 0.3 * m->h, y);
		m->step(state, u + k * inputs);
		m->out(state, again + k * outputs);
		if (k + 1 == HALF)
			memcpy(saved, state, m->size);
	}
	ok(memcmp(out, again, STEPS * outputs * sizeof *out) == 0, "%s: run and step, init after a run", m->name);
	memset(again, 0, STEPS * outputs * sizeof *again);
	memcpy(state, saved, m->size);
	m->run(state, HALF, u + HALF * inputs, again);
	ok(memcmp(out + HALF * outputs, again, HALF * outputs * sizeof *out) == 0, "%s: a copy restores", m->name);
	m->get(saved, y);                                           /* of what was before set nothing is left */
	void *const set[] = {state, saved, other};
	bool good = true;
	for (int i = 0; i < 3; i++) {
		m->set(set[i], 0.25, y);
		m->get(set[i], back);
		good = good && memcmp(y, back, (size_t)m->states * sizeof *y) == 0;
		if (m->hold)
			m->hold(set[i], u);
	}
	ok(good, "%s: get gives what was set", m->name);
	m->run(state, HALF, u, out);
	good = true;
	for (int i = 1; i < 3; i++) {
		m->run(set[i], HALF, u, again);
		good = good && memcmp(out, again, HALF * outputs * sizeof *out) == 0;
	}
	ok(good, "%s: set renews", m->name);
	free(u);
	free(out);
	free(again);
	free(state);
	free(saved);
	free(other);
}

void ends(const pl_model *m, int bit, double from, double to, bool same)
{
	enum { MORE = 3 };
	void *state = fresh(m);
	double y[MOST], last[MOST];
	bool good = true;
	m->get(state, y);
	for (int k = 0; m->status(state) == 0 && k < 1000; k++) {
		memcpy(last, y, sizeof last);
		m->step(state, NULL);
		m->get(state, y);
	}
	const double when = m->time(state);
	const int status = m->status(state);
	good = close_to(when, (from + to) / 2, (to - from) / 2, "%s: the time at which it ends", m->name);
	for (int k = 0; k <= MORE; k++) {
		bool finite = true;
		for (int i = 0; i < m->states; i++)
			finite = finite && isfinite(y[i]) && (!same || y[i] == last[i]);
		if (!finite)
			note("%s, %d steps later: state %g %g, before %g %g", m->name, k, y[0], y[m->states - 1],
				last[0], last[m->states - 1]);
		good = good && finite;
		m->step(state, NULL);
		m->get(state, y);
	}
	if (status != bit)
		note("%s: status %d, expected %d", m->name, status, bit);
	good = good && status == bit;
	m->init(state);
	ok(good && m->status(state) == 0, "%s: status %d, at %g s, and none after init", m->name, bit, when);
	free(state);
}
