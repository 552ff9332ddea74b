/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A subject's run, and what goes along with its steps: CVODE, a neighbour, the model by eighths, another scheme. */
#include "driving.h"
#include "truth.h"
#include "../emitted/worse.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

/* ---- a run ---- */

struct row row[STEPS + 1];
double worst_truth;

static void record(const void *s, struct row *r)
{
	r->t = model_time(s);
	model_get(s, r->y);
	model_out(s, r->out);
	if (of->region && !(of->region(s) >= 0 && of->region(s) < of->regions))
		complain("region %d of %g, t = %.17g", of->region(s), of->regions, r->t);
}

static int output_of(const char *name)
{
	int i = outputs - 1;
	while (i >= 0 && !is(output_name(i), name))
		i--;
	return i;
}

/* The largest size of `wave`, which is a + b/2, by NAME_at at many times of a step from here; 0: there is no such */
static double top_inside(const void *s, const double *u)
{
	double y[MOST], most = 0;
	for (int k = 1; k < INSIDE && output_of("top") >= 0 && whole() && model_at(s, u, h * k / INSIDE, y); k++)
		most = fmax(most, fabs(y[place_of("a")] + y[place_of("b")] / 2));
	return most;
}

/* The largest size of `wave`, another output, so far: no less than at the ends of steps and inside, and hardly more,
 * its fastest part being of 7 rad/s; at impacts it has kinks. */
static void judge_peaks(void)
{
	const int top = output_of("top"), wave = output_of("wave");
	const double more = *of->impact || row[0].top <= 0 ? 1e-3 : in_float ? 1e-5 : 1e-6;
	double most = 0;
	for (int k = 0; k <= STEPS && top >= 0 && wave >= 0; k++) {
		const double slack = (in_float ? 2e-6 : 1e-12) * size;
		most = fmax(most, fabs(row[k].out[wave]));
		near(row[k].out[top], most + more * size / 2, more * size / 2 + slack, "a peak", row[k].t, "top");
		most = fmax(most, row[k].top);
	}
}

/* From here on the model by eighths of what it steps at once, or no longer */
void by_eighths(bool now)
{
	static struct subject finer;
	static const struct subject *coarse;
	if (now) {
		coarse = of;
		finer = *of;
		finer.model = of->fine;
		finer.modelf = of->finef;
	}
	of = now ? &finer : coarse;
}

/* For good: h too is that of these, and other params are not known with it. */
static void judge_eighths(void)
{
	const bool alone = of->whole == of->model;
	static struct subject eighth;
	by_eighths(true);
	eighth = *of;
	eighth.fine = NULL, eighth.finef = NULL, eighth.tuned = NULL;
	eighth.whole = alone ? eighth.model : eighth.whole;
	of = &eighth;
	h = of->model ? of->model->h : (double)of->modelf->h;
}

void run_steps(void)
{
	void *const s = fresh();
	double u[MOST];
	size = out_size = 0;
	model_init(s);
	for (int k = 0;; k++) {
		record(s, &row[k]);
		for (int i = 0; i < states; i++)
			size = fmax(size, fabs(row[k].y[i]));
		for (int i = 0; i < outputs; i++)
			out_size = worse(out_size, fabs(row[k].out[i]));
		if (!(size <= 1e30) || !(out_size <= 1e30))
			complain("a state or an output is not finite, t = %.17g", row[k].t);
		near(row[k].t, k * h, in_float ? 4e-7 * (k + 1) * h : 1e-13, "time", k * h, "t");
		if (k == STEPS)
			break;
		samples(k, u);
		row[k].top = top_inside(s, u);
		model_step(s, u);
	}
	for (int i = 0; i < outputs; i++) {
		own[i] = 1;
		for (int k = 0; k <= STEPS; k++)
			own[i] = fmax(own[i], fabs(row[k].out[i]));
		/* of a model reduced, states are derivatives of each other, and outputs what is left of their sum */
		if (strncmp(output_name(i), "inner", 5) != 0 || !whole())
			own[i] = fmax(out_size, size);
	}
	judge_peaks();
	const int status = model_status(s);
	free(s);
	if (status == PL_TOO_MANY_STEPS && (of->fine || of->finef) && of->tolerance > 0) {
		judge_eighths();
		run_steps();
	} else if (status & ~of->may)
		complain("status %d after %d steps", status, STEPS);
}

/* How far the truth takes a neighbour away: as far it takes errors of steps that are behind. Distances are those of
 * each state over its largest value; of a vibration that neither grows nor decays they grow up to 1.42 times. */
struct neighbour {
	struct truth *solver;
	double y[MOST], scale[MOST], spread;
};

static void begin_beside(struct neighbour *n, const double *y)
{
	*n = (struct neighbour){ .solver = new_truth(), .spread = 1 };
	for (int i = 0; i < states; i++) {
		for (int k = 0; k <= STEPS; k++)
			n->scale[i] = fmax(n->scale[i], 1e-4 * fabs(row[k].y[i]));
		n->y[i] = y[i] + n->scale[i];
	}
}

static void advance_beside(struct neighbour *n, double from, double to, const double *u, const double *y)
{
	advance(n->solver, from, to, u, n->y);
	for (int i = 0; i < states; i++)
		if (n->scale[i] > 0)
			n->spread = fmax(n->spread, fabs(n->y[i] - y[i]) / (1.42 * n->scale[i]));
}

struct beside begin(void)
{
	struct beside b = { .model = fresh(), .whole = malloc(of->whole->size) };
	if (!b.whole)
		exit(3);
	model_init(b.model);
	of->whole->init(b.whole);
	if (of->fine || of->finef) {
		by_eighths(true);
		b.fine = fresh();
		model_init(b.fine);
		by_eighths(false);
	}
	return b;
}

enum { PARTS = 8 };

/* The first `count` of them */
static void step_eighths(struct beside *b, const double *u, int count)
{
	by_eighths(true);
	const int parts = (int)lround(h / (of->model ? of->model->h : (double)of->modelf->h));
	for (int part = 1; part <= parts * count / PARTS; part++) {
		double now[MOST];
		for (int i = 0; i < inputs; i++)
			now[i] = ramps[i] ? b->before[i] + (u[i] - b->before[i]) * part / parts : u[i];
		model_step(b->fine, now);
	}
	by_eighths(false);
}

void step_by_eighths(struct beside *b, const double *u)
{
	step_eighths(b, u, PARTS);
	memcpy(b->before, u, sizeof *u * MOST);
}

void get_eighths(const struct beside *b, double *y, void (*get)(const void *, double *))
{
	by_eighths(true);
	get(b->fine, y);
	by_eighths(false);
}

void step_beside(struct beside *b, int k)
{
	double u[MOST];
	samples(k, u);
	model_step(b->model, u);
	of->whole->step(b->whole, inputs ? u : NULL);
	if (b->fine)
		step_by_eighths(b, u);
}

void set_beside(struct beside *b, double t, const double *y)
{
	model_set(b->model, t, y);
	of->whole->set(b->whole, t, y);
	if (b->fine) {
		by_eighths(true);
		model_set(b->fine, t, y);
		by_eighths(false);
	}
}

void end_beside(struct beside *b)
{
	free(b->model), free(b->whole), free(b->fine);
}

/* The model by eighths alone, after steps with the samples of `from` ones, from a state on; nothing where it is not
 * asked for. */
struct beside begin_eighths(int from, double t, const double *y)
{
	struct beside b = { .model = NULL };
	double u[MOST];
	if (of->order == 0)
		return b;
	by_eighths(true);
	b.fine = fresh();
	model_init(b.fine);
	by_eighths(false);
	for (int k = 0; k < from; k++) {
		samples(k, u);
		step_by_eighths(&b, u);
	}
	by_eighths(true);
	if (from > 0)
		model_set(b.fine, t, y);
	by_eighths(false);
	return b;
}

/* States after the first `count` eighths of a step from others on, by what has gone along until there */
void get_inside(struct beside *b, double t, const double *from, const double *u, int count, double *y)
{
	by_eighths(true);
	void *const kept = fresh();
	const size_t size_of_kept = bytes();
	memcpy(kept, b->fine, size_of_kept);
	model_set(b->fine, t, from);
	by_eighths(false);
	step_eighths(b, u, count);
	get_eighths(b, y, model_get);
	memcpy(b->fine, kept, size_of_kept);
	free(kept);
}

/* A number of a model s, and by eighths of its steps, within a bound of the truth; or as much nearer to it by eighths
 * as its order is, where it is not much further away than that or the status tells of it. */
bool in_order(const void *s, double found, double by_eighths_found, double expected, double most,
	const char *what, double t, const char *which)
{
	const double error = fabs(found - expected), left = fabs(by_eighths_found - expected);
	const bool told = model_status(s) & PL_INACCURATE;
	const double floor = most / (in_float ? 8 : 1000);
	if (of->order > 0 && error > most && (error <= 100 * most || told) &&
	    left <= fmax(4 * error / pow(8, of->order), floor))
		return true;
	return near(found, expected, most, what, t, which);
}

/* Steps from a state and a time on; the truth beside them.  `steps` rows; the samples are those of step `from` on. */
void judge_steps(void *s, int from, int steps, double step, struct row *first, const char *what)
{
	const bool all = whole();
	double y[MOST], u[2 * MOST], before[MOST], sampled[MOST];
	void *const w = malloc(of->whole->size);
	struct truth *const solver = new_truth();
	if (!w)
		exit(3);
	of->whole->init(w);
	if (all)
		model_get(s, y);
	else
		of->whole->get(w, y);
	double t = model_time(s);
	struct neighbour beside = { .spread = 1 };
	struct beside eighths = begin_eighths(from, t, y);
	if (all && of_first_order())
		begin_beside(&beside, y);
	memset(before, 0, sizeof before);
	if (from > 0)
		whole_samples(from - 1, before);
	for (int k = 0; k < steps; k++, t += step) {
		double found[MOST], seen[MOST], expected[MOST], top[MOST], finer[MOST] = {0}, finer_seen[MOST] = {0};
		whole_samples(from + k, sampled);
		over_step(before, sampled, step, u);
		memcpy(before, sampled, sizeof before);
		of->whole->step(w, inputs ? sampled : NULL); /* for its samples alone: its state is set anew below */
		if (!advance(solver, t, t + step, u, y)) {
			complain("%s: CVODE gives up at t = %.17g", what, t);
			break;
		}
		model_step(s, sampled);
		model_get(s, found);
		model_out(s, seen);
		if (eighths.fine) {
			step_by_eighths(&eighths, sampled);
			get_eighths(&eighths, finer, model_get);
			get_eighths(&eighths, finer_seen, model_out);
		}
		if (first)
			memcpy(first[k + 1].truth, y, sizeof y);
		if (beside.solver)
			advance_beside(&beside, t, t + step, u, y);
		bool good = true;
		for (int i = 0; i < states && all; i++) {
			good = in_order(s, found[i], finer[i], y[i], bound() * beside.spread * size, what, t + step,
				state_name(i)) && good;
			worst_truth = worse(worst_truth, fabs(found[i] - y[i]) / size);
		}
		for (int i = 0; i < inputs; i++)
			u[i] = ramps[i] ? sampled[i] : u[i];
		if (all && of->wanted && !at_a_change(t + step) && !(in_float && size > 1e3) &&
		    highest(t + step, found, u, top)) {
		    /* at the model's own states: of large ones a float tells no differences */
		    of->wanted(model_time(s), found, u, top, expected);
		    for (int i = 0; i < outputs; i++)
			good = near(seen[i], expected[i], (in_float ? 1e-4 : 1e-10) * fmax(out_size, size),
				    "output of these states", t + step, output_name(i)) &&
			       good;
		}
		if (all && first && of->wanted && !at_a_change(t + step) && highest(t + step, y, u, top)) {
			of->wanted(t + step, y, u, top, expected);              /* at CVODE's */
			for (int i = 0; i < outputs; i++)
				if (strncmp(output_name(i), "inner", 5) == 0 && !is(of->scheme, "pl"))
				    good = in_order(s, seen[i], finer_seen[i], expected[i],
						fmax(10 * bound(), 1e-4) * own[i] +
						(of->written ? rounding(k) * size : 0),
						"output against CVODE", t + step, output_name(i)) &&
					   good;
		} else if (!all && !at_a_change(t + step)) {
			of->whole->set(w, t + step, y);
			of->whole->out(w, expected);
			for (int i = 0; i < outputs; i++)       /* a set starts peaks anew */
			    good = (is(output_name(i), "top") ||
				    in_order(s, seen[i], finer_seen[i], expected[i],
					 fmax(bound(), 1e-5) * fmax(out_size, size) + loss_of(output_name(i)),
					 "output, of a model reduced", t + step, output_name(i))) &&
				   good;
		}
		if (!good)
			break;
	}
	if (beside.solver)
		truth_free(beside.solver);
	truth_free(solver);
	free(w), free(eighths.fine);
}

/* An error of steps, of first order at least, is at most 8/7 of what lies between steps and their eighths, in `found`
 * of `count` states or outputs; twice that, since kinks are elsewhere in each. What is wrong whatever the step is not
 * between them. */
static double of_steps(const struct beside *b, const double *found, int count, void (*get)(const void *, double *))
{
	double y[MOST], most = 0;
	if (!b->fine)
		return 0;
	get_eighths(b, y, get);
	for (int i = 0; i < count; i++)
		most = fmax(most, 16. / 7 * fabs(found[i] - y[i]));
	return most;
}

/* The same by steps of the other model, from the same state on: of those states and outputs that both have. */
void judge_beside(struct beside *b, int from, int steps, const char *what)
{
	const double most = in_float ? 2e-3 : 1e-6;
	const bool all = whole(), seen = of->whole->outputs == outputs;
	double state_error = 0, output_error = 0;
	bool good = true;
	for (int k = from; k < from + steps && good; k++) {
		double found[MOST], expected[MOST];
		step_beside(b, k);
		const double t = model_time(b->model);
		model_get(b->model, found);
		of->whole->get(b->whole, expected);
		state_error = fmax(state_error, of_steps(b, found, states, model_get));
		for (int i = 0; i < states && all; i++) {
			good = near(found[i], expected[i], most * size + state_error, what, t, state_name(i)) && good;
			worst_truth = worse(worst_truth, fabs(found[i] - expected[i]) / size);
		}
		if (of->region && of->whole_region && !in_float && of->region(b->model) != of->whole_region(b->whole)) {
			complain("%s, t = %.17g: region %d, expected %d", what, t, of->region(b->model),
			    of->whole_region(b->whole));
			good = false;
		}
		model_out(b->model, found);
		of->whole->out(b->whole, expected);
		output_error = fmax(output_error, of_steps(b, found, outputs, model_out));
		for (int i = 0; i < outputs && seen; i++)
			good = near(found[i], expected[i], most * fmax(out_size, size) + output_error, what, t,
			    output_name(i)) && good;
	}
}
