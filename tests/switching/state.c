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

static bool same_crossings(int count, const pl_crossing *found, const pl_crossing *expected, int shift, int k)
{
	bool good = true;
	for (int i = 0; i < count; i++) {
		good = close_to(found[i].time, expected[i].time, 1e-10, "step %d: time of crossing %d", k, i) && good;
		good = found[i].expression == expected[i].expression + shift && found[i].upward == expected[i].upward &&
		       found[i].breakpoint == expected[i].breakpoint && good;
	}
	return good;
}

/* Of the crossings of all those of expressions first .. last */
static int picked(int count, const pl_crossing *all, int first, int last, pl_crossing *some)
{
	int found = 0;
	for (int i = 0; i < count; i++)
		if (all[i].expression >= first && all[i].expression <= last)
			some[found++] = all[i];
	return found;
}

/* x has expression 0 of two intervals; y 1 of two, its velocity, and 2 of three; z none */
static void parts(int step)
{
	struct run all = run_new(variant_of(state_table, "parts_%d", step)), one[3];
	double states[6], alone[2], middle[6];
	bool good = true, listed = true, numbered = true, between = true;
	for (int c = 0; c < 3; c++)
		one[c] = run_new(variant_of(state_table, "part_%c_%d", "xyz"[c], step));
	const double h = all.of->model->h;
	for (int k = 0; k < 400; k++) {
		pl_crossing crossing[MOST_EVENTS], own[2][MOST_EVENTS], of_part[MOST_EVENTS];
		const double u[1] = { 0.5 + sample(k) };
		all.of->model->at(all.state, u, 0.37 * h, middle);
		run_step(&all, u);
		run_state(&all, states);
		const int count = all.of->crossings(all.state, crossing);
		for (int c = 0; c < 3; c++) {
			one[c].of->model->at(one[c].state, u, 0.37 * h, alone);
			const double then[2] = { middle[c], middle[3 + c] };
			between = same(all.of->model, then, alone, 2, 1e-10, "at 0.37 h, state", k) && between;
			run_step(&one[c], u);
			run_state(&one[c], alone);
			const double now[2] = { states[c], states[3 + c] };
			good = same(all.of->model, now, alone, 2, 1e-10, "state", k) && good;
			if (c == 2)
				continue;
			const int found = one[c].of->crossings(one[c].state, own[c]);
			const int taken = picked(count, crossing, c, c ? 2 : 0, of_part);
			listed = close_to(taken, found, 0, "step %d: crossings of part %d", k, c) && listed;
			listed = taken == found && same_crossings(found, of_part, own[c], c, k) && listed;
		}
		const int region = one[0].of->region(one[0].state) + 2 * one[1].of->region(one[1].state);
		numbered = close_to(all.of->region(all.state), region, 0, "step %d: region", k) && numbered;
	}
	const uint64_t crossed = one[0].of->crossed(one[0].state) + one[1].of->crossed(one[1].state);
	ok(good, "parts, h = %g: each as one alone", h);
	ok(between, "parts, h = %g: each as one alone between steps", h);
	ok(listed && all.of->crossed(all.state) == crossed, "parts, h = %g: %d crossings, each as of one alone", h,
		(int)crossed);
	ok(numbered, "parts, h = %g: the number of the region from theirs", h);
	const double none[6] = { 0, 0, NAN, 0, 0, 0 };
	run_set(&all, none);
	run_step(&all, (const double[]){ 0 });
	ok(all.of->model->status(all.state) == PL_NOT_FINITE, "parts, h = %g: no number in the linear part is told", h);
	for (int c = 0; c < 3; c++)
		run_free(&one[c]);
	run_free(&all);
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
	for (int step = 0; step < 3; step++) {
		twins(step);
		parts(step);
	}
	for (const struct variant *of = state_table; of->model; of++)
		functions(of);
	return tap_end();
}
