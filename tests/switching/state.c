/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a caller may rely on beside the values: the same from step, run and at, from a saved state, and from a state set
 * at a later time; crossings in order and counted; simultaneous crossings. */
#include "drive.h"
#include "state_variants.h"
#include "tap.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 300, MOST_OUTPUTS = 16 };

static double sample(int k)
{
	return sin(0.7 * k) + 0.3 * cos(3.1 * k);
}

static bool same(const pl_model *m, const double *found, const double *expected, int n, double tolerance,
    const char *what, int k)
{
	bool good = true;
	for (int i = 0; i < n; i++) {
            /* what is summed in another order is off by rounding, which is more where the state has grown large */
            const double rounding = 4 * DBL_EPSILON * fabs(expected[i]);
            good = close_to(found[i], expected[i], fmax(tolerance, rounding), "%s, h = %g, after %d steps: %s %d",
                            m->name, m->h, k, what, i) &&
                   good;
        }
        return good;
}

/* step against run in pieces, and at over a whole step and over two parts of it */
static void functions(const struct variant *of)
{
	const pl_model *m = of->model;
	void *one = calloc(1, m->size), *many = calloc(1, m->size), *saved = calloc(1, m->size);
	static double u[STEPS], out[STEPS * MOST_OUTPUTS];
	double x[MOST_STATES], y[MOST_STATES], rows[MOST_OUTPUTS];
	bool runs = true, ats = true, parts = true, listed = true, copies = true;
	uint64_t total = 0;
	for (int k = 0; k < STEPS; k++)
		u[k] = sample(k);
	m->init(one);
	m->init(many);
	m->run(many, 100, m->inputs ? u : NULL, out);
	m->run(many, STEPS - 100, m->inputs ? u + 100 : NULL, out + 100 * m->outputs);
	for (int k = 0; k < STEPS; k++) {
		const double *now = m->inputs ? &u[k] : NULL;
		pl_crossing crossing[MOST_EVENTS];
		memcpy(saved, one, m->size);
		m->at(one, now, m->h, x);
		m->at(one, now, 0.37 * m->h, y);
		copies = memcmp(saved, one, m->size) == 0 && copies;            /* at has changed nothing */
		m->step(one, now);
		m->out(one, rows);
		runs = same(m, out + k * m->outputs, rows, m->outputs, 1e-12, "output of run", k) && runs;
		const int found = of->crossings(one, crossing);
		total += (uint64_t)found;
		for (int i = 0; i < found; i++)
                    listed = crossing[i].time >= (i ? crossing[i - 1].time : 0) && crossing[i].time <= m->h && listed;
                listed = close_to((double)of->crossed(one), (double)total, 0, "%s, h = %g: crossings listed so far",
                                  m->name, m->h) &&
                         listed;
                double after[MOST_STATES];
		m->get(one, after);
		ats = same(m, x, after, m->states, 1e-13, "at h, state", k) && ats;
		if (m->inputs)
			continue;
		/* from the state at 0.37 h set at its time, a step; against one from the same time by two at */
		void *begun = calloc(1, m->size);
		m->set(begun, m->time(saved) + 0.37 * m->h, y);
		m->at(begun, NULL, 0.63 * m->h, x);
		parts = same(m, x, after, m->states, 1e-12, "in two parts, state", k) && parts;
		free(begun);
	}
	ok(runs, "%s, h = %g: run as step", m->name, m->h);
	ok(ats, "%s, h = %g: at h as a step", m->name, m->h);
	ok(copies, "%s, h = %g: at changes nothing", m->name, m->h);
	ok(listed, "%s, h = %g: %d crossings, listed in order", m->name, m->h, (int)total);
	ok(parts, "%s, h = %g: set in the middle of a step", m->name, m->h);
	ok(of->crossed(many) == of->crossed(one) && of->region(many) == of->region(one),
		"%s, h = %g: region and count of run", m->name, m->h);
	/* back to what was saved, and on again */
	double again[MOST_STATES];
	memcpy(many, saved, m->size);
	m->step(many, m->inputs ? &u[STEPS - 1] : NULL);
	m->get(many, again);
	m->get(one, x);
	ok(memcmp(again, x, (size_t)m->states * sizeof *x) == 0 && of->crossed(many) == of->crossed(one),
		"%s, h = %g: restored by assignment", m->name, m->h);
	/* what is not finite */
	for (int i = 0; i < m->states; i++)
		again[i] = 0;
	again[0] = NAN;
	m->set(many, 0, again);
	m->step(many, m->inputs ? u : NULL);
	ok(m->status(many) == PL_NOT_FINITE, "%s, h = %g: no number, and the status says so", m->name, m->h);
	again[0] = INFINITY;
	m->set(many, 0, again);
	m->step(many, m->inputs ? u : NULL);
	ok(m->status(many) == PL_NOT_FINITE, "%s, h = %g: an infinite state, and the status says so", m->name, m->h);
	m->init(many);
	ok(m->status(many) == 0, "%s, h = %g: cleared by init", m->name, m->h);
	free(one);
	free(many);
	free(saved);
}

static void twins(int step)
{
	struct run two = run_new(variant_of(state_table, "twins_%d", step)),
		one = run_new(variant_of(state_table, "twin_%d", step));
	double x[4], y[2];
	bool good = true;
	while (one.steps * one.of->model->h < 30) {
		run_step(&two, NULL);
		run_step(&one, NULL);
		run_state(&two, x);
		run_state(&one, y);
		const double expected[4] = { y[0], y[0], y[1], y[1] };
		good = same(two.of->model, x, expected, 4, 1e-12, "state", (int)one.steps) && good;
	}
	ok(good, "twins, h = %g: as one alone", one.of->model->h);
	ok(two.of->model->status(two.state) == 0, "twins, h = %g: status 0", one.of->model->h);
	note("twins, h = %g: %d crossings, one alone %d", one.of->model->h, (int)two.of->crossed(two.state),
		(int)one.of->crossed(one.state));
	run_free(&two);
	run_free(&one);
}

/* x - w rises through 0.1 and comes back: the direction is that of x - w, as written */
static void bump(void)
{
	struct run r = run_new(variant_of(state_table, "bump_0"));
	const double w[1] = { 0.2 };
	pl_crossing crossing[MOST_EVENTS];
	int passed[2] = { 0, 0 };
	bool good = true;
	for (int k = 0; k < 40; k++) {
		double before[4], after[4];
		run_state(&r, before);
		run_step(&r, w);
		run_state(&r, after);
		const int found = r.of->crossings(r.state, crossing);
		for (int i = 0; i < found; i++) {
			if (crossing[i].expression != 0)
				continue;
                        const double at = crossing[i].breakpoint ? 0.2
                                                                 : 0.1; /* of x - w: the second is 2 w - 2 x at -0.4 */
                        const bool up = before[0] - w[0] < at;
                        good = close_to(crossing[i].upward, up, 0,
                                        "bump, step %d: x - w from %g to %g through %g, upward", k, before[0] - w[0],
                                        after[0] - w[0], at) &&
                               good;
                        passed[crossing[i].upward]++;
		}
	}
        ok(good && passed[0] > 0 && passed[1] > 0,
           "bump: x - w passes 0.1 and 0.2 %d times upward, %d times downward, each told so", passed[1], passed[0]);
        run_free(&r);
}

int main(void)
{
	bump();
	for (int step = 0; step < 3; step++)
		twins(step);
	for (const struct variant *of = state_table; of->model; of++)
		functions(of);
	return tap_end();
}
