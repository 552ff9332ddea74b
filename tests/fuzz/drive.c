/* SPDX-License-Identifier: GPL-3.0-or-later */
/* drive NAME: one of the subjects, by every function that its descriptor has, against CVODE on NAME_rhs, the closed
 * form, and the spec's second writing. Prints what differs, both values, and ends with 1; else a line of the largest
 * differences.
 *
 * Bounds, over the largest value of any state in the run (of an output: of any output, or state):
 * states against CVODE, rtol 1e-10 or 1e-13: exact 1e-6; a smooth remainder 1e-4, 3e-3 and 5e-2 in order 4,
 *                                        2 and 1; with kinks 1e-2, in order 1 5e-2, and as much more as neighbours
 *                                        spread
 *     further from CVODE a smooth model of a fixed order may be up to 100 bounds, or as far as its status tells,
 *                                        if by eighths of a step it is nearer by 8 to the order, or by 1000 bounds
 *     the closed form                    1e-12 per step; of an output named inner... over its own largest value, or 1
 *     rhs, outputs against the second writing    1e-10, of the largest slope or output
 *     jump, set, retune                  1e-12 per step; at(h): 1e-12; at(0): get, to the last bit
 *     another scheme                     1e-6, and what the model's own steps make: as it differs from its eighths
 *     retune, by steps to a tolerance    twice the tolerance more, per step
 *     run                                2 units in the last place per step, and what outputs make of those of states;
 *                                        restore: to the last bit
 *     a batch                            1e-12 per step of one that steps alone
 * selftest 100 units in the last place; 1000 at velocities that damping wears down slowly from 100,
 *                                        where all steps round alike, and where breakpoints are passed, each of
 *                                        which spreads what rounding has made of the state; so much more as
 *                                        differences 10*x - y are larger than the states that they are made of;
 *                                        20 more per what loads sustain over the states, of 0.5 or more, that are
 *                                        kept less that
 * In float 2e-5 per step for what is 1e-12 in double, and at least 2e-3 beside CVODE. */
#include "drive.h"
#include "truth.h"
#include "../emitted/worse.h"

#include <math.h>
#include <stdarg.h>
#include <stdbool.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { MOST = 80, STEPS = 32, LATER = 12, DELAY = 2, INSIDE = 32 };

static const struct subject *of;
static int states, inputs, outputs, complaints;
static double h, size, out_size;        /* step; of the largest state and output in the run */
/* of an output that is judged by itself, at least 1; else of any output or state */
static double own[MOST];
static bool in_float;
static double worst_truth, worst_solution;

__attribute__((format(printf, 1, 2))) static void complain(const char *form, ...)
{
	va_list arguments;
	if (complaints++ > 5)
		return;
	va_start(arguments, form);
	printf("%s: ", of->name);
	vprintf(form, arguments);
	putchar('\n');
	va_end(arguments);
}

static bool near(double found, double expected, double tolerance, const char *what, double t, const char *which)
{
	if (fabs(found - expected) <= tolerance)
		return true;
        complain("%s, t = %.17g, %s: found %.17g, expected %.17g, difference %.3g, tolerance %.3g", what, t, which,
                 found, expected, found - expected, tolerance);
        return false;
}

/* ---- a model in double or float, seen alike ---- */

static void *fresh(void)
{
	void *s = malloc(of->model ? of->model->size : of->modelf->size);
	if (!s)
		exit(3);
	memset(s, 0x5a, of->model ? of->model->size : of->modelf->size);
	return s;
}

static size_t bytes(void)
{
	return of->model ? of->model->size : of->modelf->size;
}

static void narrow(const double *from, float *to, int n)
{
	for (int i = 0; i < n; i++)
		to[i] = (float)from[i];
}

static void widen(const float *from, double *to, int n)
{
	for (int i = 0; i < n; i++)
		to[i] = (double)from[i];
}

static void model_init(void *s)
{
	if (of->model)
		of->model->init(s);
	else
		of->modelf->init(s);
}

static void model_set(void *s, double t, const double *y)
{
	float narrowed[MOST];
	narrow(y, narrowed, states);
	if (of->model)
		of->model->set(s, t, y);
	else
		of->modelf->set(s, (float)t, narrowed);
}

static void model_get(const void *s, double *y)
{
	float narrowed[MOST];
	if (of->model) {
		of->model->get(s, y);
		return;
	}
	of->modelf->get(s, narrowed);
	widen(narrowed, y, states);
}

static double model_time(const void *s)
{
	return of->model ? of->model->time(s) : (double)of->modelf->time(s);
}

static void model_step(void *s, const double *u)
{
	float narrowed[MOST];
	narrow(u, narrowed, inputs);
	if (of->model)
		of->model->step(s, inputs ? u : NULL);
	else
		of->modelf->step(s, inputs ? narrowed : NULL);
}

static void model_out(const void *s, double *out)
{
	float narrowed[MOST];
	if (of->model) {
		of->model->out(s, out);
		return;
	}
	of->modelf->out(s, narrowed);
	widen(narrowed, out, outputs);
}

static bool model_at(const void *s, const double *u, double tau, double *y)
{
	float narrowed[MOST], found[MOST];
	if (of->model ? !of->model->at : !of->modelf->at)
		return false;
	narrow(u, narrowed, inputs);
	if (of->model) {
		of->model->at(s, inputs ? u : NULL, tau, y);
		return true;
	}
	of->modelf->at(s, inputs ? narrowed : NULL, (float)tau, found);
	widen(found, y, states);
	return true;
}

static int model_status(const void *s)
{
	if (of->model)
		return of->model->status ? of->model->status(s) : 0;
	return of->modelf->status ? of->modelf->status(s) : 0;
}

static const char *state_name(int i)
{
	return of->model ? of->model->state_names[i] : of->modelf->state_names[i];
}

static const char *output_name(int i)
{
	return of->model ? of->model->output_names[i] : of->modelf->output_names[i];
}

/* ---- bounds ---- */

static double rounding(int steps)
{
	return (in_float ? 2e-5 : 1e-12) * (steps + 1);
}

static bool is(const char *text, const char *word)
{
	return strcmp(text, word) == 0;
}

static bool of_first_order(void)
{
	return is(of->scheme, "etd1") || is(of->scheme, "pl");
}

/* Of states against CVODE */
static double bound(void)
{
	const bool first = of_first_order(), second = is(of->scheme, "etdrk2");
	double b = first ? 5e-2 : second ? 3e-3 : 1e-4;
	if (is(of->class, "sticking"))
		b = 1e-3;
	else if (is(of->scheme, "exact"))
		b = 1e-6;
	else if (!is(of->class, "smooth") && !is(of->class, "linear") && !first)
		b = 1e-2;
	return in_float ? fmax(b, 2e-3) : b;
}

/* ---- samples of the inputs: numbers that a float holds ---- */

static double sample(int step, int which)
{
	return (double)((step * 37 + which * 23 + 11) % 61 - 30) / 32;
}

static void samples(int step, double *u)
{
	for (int i = 0; i < inputs; i++)
		u[i] = sample(step, i);
}

/* Of all inputs of `whole`: what the model delays is another input of that. */
static void whole_samples(int step, double *u)
{
	samples(step, u);
	for (int i = inputs; i < of->whole->inputs; i++)
		u[i] = step < DELAY ? 0 : sample(step - DELAY, 0);
}

/* What an output loses with modes that are dropped, from the start and under loads; what inputs drive in them is said
 * of outputs with a need alone. */
static double loss_of(const char *name)
{
	const size_t length = strlen(name);
	for (const char *p = of->lost; (p = strstr(p, name)); p++)
		if (p[-1] == ' ' && p[length] == ' ' && strtod(p + length, NULL) > 0)
			return inputs ? INFINITY : strtod(p + length, NULL);
	return 0;
}

/* Which inputs ramp: find_ramps asks the model. */
static bool ramps[MOST];

/* Inputs over a step as NAME_rhs takes them: at its start, then slopes. */
static void over_step(const double *before, const double *sampled, double step, double *u)
{
	for (int i = 0, all = of->whole->inputs; i < all; i++) {
		u[i] = ramps[i] ? before[i] : sampled[i];
		u[all + i] = ramps[i] ? (sampled[i] - before[i]) / step : 0;
	}
}

/* ---- the truth ---- */

static void slopes_of(const void *nothing, double t, const double *y, const double *u, double *dydt)
{
	(void)nothing;
	of->slopes(t, y, u, dydt);
}

/* Where positions are large, what is between them is as small beside them as it must be known better. Behind a force
 * that jumps a step by 1e-10 was 2e-6 off: its estimate is of a derivative that is not there. */
static struct truth *new_truth(void)
{
	const bool closer = size > 1e3 || is(of->class, "piecewise") || is(of->class, "kinked");
	double scale[MOST];
	for (int i = 0; i < of->whole->states; i++)
		scale[i] = 1;
	return truth_new(of->whole->states, slopes_of, NULL, CVODE_ADAMS, closer ? 1e-13 : 1e-10, scale);
}

static bool fly_anew(double from, double to, const double *u, double *y)
{
	struct truth *const solver = new_truth();
	const bool good = to <= from || truth_advance(solver, from, to, of->whole->inputs, u, y);
	truth_free(solver);
	return good;
}

static int place_of(const char *name)
{
	int i = 0;
	while (i < of->whole->states - 1 && !is(of->whole->state_names[i], name))
		i++;
	return i;
}

/* From impact to impact, in parts of which none holds two */
static bool fly(struct truth *solver, double from, double to, const double *u, double *y)
{
	char *end;
	const double gap = strtod(of->impact, &end), restitution = strtod(end, NULL);
	const int x = place_of("b"), v = place_of("b'");
	if (!*of->impact)
		return truth_advance(solver, from, to, of->whole->inputs, u, y);
	for (int part = 0; part < 8; part++) {
		const double start = from + part * (to - from) / 8, stop = part == 7 ? to : start + (to - from) / 8;
		double moved[2 * MOST] = {0}, before[MOST], low = start, high = stop;
		const int all = of->whole->inputs;
		memcpy(before, y, sizeof before);
		for (int i = 0; i < 2 * all; i++)
			moved[i] = u[i] + (i < all ? (start - from) * u[all + i] : 0);
		if (!fly_anew(start, stop, moved, y))
			return false;
		if (!(before[x] < gap && y[x] >= gap))
			continue;
		while (high - low > 1e-13) {
			const double middle = low + (high - low) / 2;
			memcpy(y, before, sizeof before);
			if (!fly_anew(start, middle, moved, y))
				return false;
			*(y[x] >= gap ? &high : &low) = middle;
			if (middle - start < 1e-13 || stop - middle < 1e-13)
				break;
		}
		y[x] = nextafter(gap, -1);
		y[v] *= -restitution;
		for (int i = 0; i < all; i++)
			moved[i] += (low - start) * moved[all + i];
		if (!fly_anew(low, stop, moved, y))
			return false;
	}
	return true;
}

/* Over a step, with a stop where a load changes, behind which the truth starts anew: past slopes would be of another
 * formula. A change at the step's start, but for rounding, has been; of one at its end the step has none. */
static bool advance(struct truth *solver, double from, double to, const double *u, double *y)
{
	const char *p = of->changes;
	double now = from, moved[2 * MOST];
	memcpy(moved, u, sizeof *u * 2 * (size_t)of->whole->inputs);
	for (;;) {
		double next = to;
		bool changes = false;
		const char *list = p;
		char *end;
		for (double change = strtod(list, &end); end != list; list = end, change = strtod(list, &end))
			if (change > now && change <= now + 1e-14)
				now = change;           /* the first slope is already that of the next formula */
			else if (change > now + 1e-14 && change < next + 1e-14)
				next = fmin(change, to), changes = true;
		for (int i = 0; i < of->whole->inputs; i++)
			moved[i] = u[i] + (now - from) * u[of->whole->inputs + i];
		if (!fly(solver, now, changes ? nextafter(next, 0) : to, moved, y))
			return false;
		if (next > to - 1e-14)
			return true;
		now = next;
	}
}

/* The model's states of the whole one's, where all are there; or a model with fewer says only its outputs. */
static bool whole(void)
{
	bool all = of->whole->states == states;
	for (int i = 0; i < states && all; i++)
		all = is(state_name(i), of->whole->state_names[i]);
	return all;
}

/* ---- the spec's second writing ---- */

/* Highest derivatives, by elimination: the residual is linear in them. */
static bool highest(double t, const double *y, const double *u, double *top)
{
	const int n = of->coords[0];
	double M[MOST][MOST], r0[MOST], r[MOST];
	memset(top, 0, sizeof *top * (size_t)n);
	of->residual(t, y, u, top, r0);
	for (int j = 0; j < n; j++) {
		top[j] = 1;
		of->residual(t, y, u, top, r);
		top[j] = 0;
		for (int i = 0; i < n; i++)
			M[i][j] = r[i] - r0[i];
	}
	for (int j = 0; j < n; j++) {
		int p = j;
		for (int i = j; i < n; i++)
			if (fabs(M[i][j]) > fabs(M[p][j]))
				p = i;
		if (M[p][j] == 0)
			return false;
		for (int k = 0; k < n; k++) {
			const double swap = M[p][k];
			M[p][k] = M[j][k];
			M[j][k] = swap;
		}
		const double swap = r0[p];
		r0[p] = r0[j];
		r0[j] = swap;
		for (int i = j + 1; i < n; i++) {
			const double f = M[i][j] / M[j][j];
			for (int k = j; k < n; k++)
				M[i][k] -= f * M[j][k];
			r0[i] -= f * r0[j];
		}
	}
	for (int j = n - 1; j >= 0; j--) {
		top[j] = -r0[j];
		for (int k = j + 1; k < n; k++)
			top[j] -= M[j][k] * top[k];
		top[j] /= M[j][j];
	}
	return true;
}

static bool at_a_change(double t)
{
	char *end;
	const char *p = of->changes;
	for (double change = strtod(p, &end); end != p; p = end, change = strtod(p, &end))
		if (fabs(t - change) < 1e-6)
			return true;
	return false;
}

static void judge_rhs(void)
{
	unsigned seed = 1;
	if (!of->residual || !of->slopes)
		return;
	for (int point = 0; point < 40; point++) {
		double y[MOST], u[2 * MOST], top[MOST], found[MOST], largest = 1;
		for (int i = 0; i < of->whole->states; i++)
			seed = seed * 1103515245u + 12345u, y[i] = (double)(seed >> 8) / 8388608 - 1;
		for (int i = 0; i < 2 * inputs; i++)
			seed = seed * 1103515245u + 12345u, u[i] = i < inputs || ramps[i - inputs] ?
				(double)(seed >> 8) / 8388608 - 1 : 0;
		seed = seed * 1103515245u + 12345u;
		const double t = (double)(seed >> 8) / 33554432;
		if (at_a_change(t))
			continue;
		if (!highest(t, y, u, top)) {
			complain("the second writing has a singular mass matrix");
			return;
		}
		of->slopes(t, y, u, found);
		for (int i = 0; i < of->whole->states; i++)
			largest = fmax(largest, fabs(found[i]));
		for (int i = 0, velocity = of->coords[0]; i < of->coords[0]; i++)
                    near(found[of->coords[i + 1] == 2 ? velocity++ : i], top[i], 1e-10 * largest,
                         "rhs against the second writing", t, of->whole->state_names[i]);
        }
}

/* ---- a run ---- */

struct row {
	double t, y[MOST], out[MOST], truth[MOST], u[2 * MOST];
	double top;             /* the largest size of a + b/2 in the step that begins here, where NAME_at tells it */
};

static struct row row[STEPS + 1];

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
static void by_eighths(bool now)
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
	const bool own = of->whole == of->model;
	static struct subject eighth;
	by_eighths(true);
	eighth = *of;
	eighth.fine = NULL, eighth.finef = NULL, eighth.tuned = NULL;
	eighth.whole = own ? eighth.model : eighth.whole;
	of = &eighth;
	h = of->model ? of->model->h : (double)of->modelf->h;
}

static void run_steps(void)
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

/* Of a ramp the sample before acts: after another first sample the same second one gives other states or outputs, by
 * more than what rounding makes of a step that begins in another region. From here, or from so far away, where what
 * sticks slips, and the larger of two is the other one; above 0 or below it, for the same reason. */
static bool ramps_from(int input, double far, double sign)
{
	double u[MOST] = {0}, seen[2][2 * MOST], start[MOST];
	void *const s = malloc(of->whole->size);
	bool ramp = false;
	if (!s)
		exit(3);
	for (int j = 0; j < of->whole->states; j++)
		start[j] = far != 0 ? (j % 2 ? -far : far) + j * 0.3 : 0.25 + j * 0.01;
	for (int round = 0; round < 2; round++) {       /* the same state and time, the sample before differs */
		of->whole->init(s);
		u[input] = round ? sign : 0;
		of->whole->step(s, u);
		of->whole->set(s, 0, start);
		u[input] = 0.5 * sign;
		of->whole->step(s, u);
		of->whole->get(s, seen[round]);
		of->whole->out(s, seen[round] + of->whole->states);
	}
	for (int j = 0; j < of->whole->states + of->whole->outputs; j++)
		ramp = ramp || fabs(seen[0][j] - seen[1][j]) > 1e-10 * fmax(1, fabs(seen[0][j]));
	free(s);
	return ramp;
}

/* Where no such state shows it, the descriptor tells. */
static void find_ramps(void)
{
	for (int i = 0; i < of->whole->inputs; i++) {
		for (int k = 0; k < 6 && !ramps[i]; k++)
			ramps[i] = ramps_from(i, 2 * (k / 2 - 1), k % 2 ? -1 : 1);
		ramps[i] = ramps[i] || of->whole->start_samples[i] == 1;
	}
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

/* The model; `whole` beside it; and the model by eighths of what it steps at once, where its steps make an error */
struct beside {
	void *model, *whole, *fine;
	double before[MOST];
};

static struct beside begin(void)
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

static void step_by_eighths(struct beside *b, const double *u)
{
	step_eighths(b, u, PARTS);
	memcpy(b->before, u, sizeof *u * MOST);
}

static void get_eighths(const struct beside *b, double *y, void (*get)(const void *, double *))
{
	by_eighths(true);
	get(b->fine, y);
	by_eighths(false);
}

static void step_beside(struct beside *b, int k)
{
	double u[MOST];
	samples(k, u);
	model_step(b->model, u);
	of->whole->step(b->whole, inputs ? u : NULL);
	if (b->fine)
		step_by_eighths(b, u);
}

static void set_beside(struct beside *b, double t, const double *y)
{
	model_set(b->model, t, y);
	of->whole->set(b->whole, t, y);
	if (b->fine) {
		by_eighths(true);
		model_set(b->fine, t, y);
		by_eighths(false);
	}
}

static void end_beside(struct beside *b)
{
	free(b->model), free(b->whole), free(b->fine);
}

/* The model by eighths alone, after steps with the samples of `from` ones, from a state on; nothing where it is not
 * asked for. */
static struct beside begin_eighths(int from, double t, const double *y)
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
static void get_inside(struct beside *b, double t, const double *from, const double *u, int count, double *y)
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
static bool in_order(const void *s, double found, double by_eighths_found, double expected, double most,
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
static void judge_steps(void *s, int from, int steps, double step, struct row *first, const char *what)
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
static void judge_beside(struct beside *b, int from, int steps, const char *what)
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

static void judge_truth(void)
{
	struct beside b = begin();
	if (of->slopes)
		judge_steps(b.model, 0, STEPS, h, row, "steps against CVODE");
	else
		judge_beside(&b, 0, STEPS, "steps against another scheme");
	end_beside(&b);
}

static void judge_solution(void)
{
	FILE *const file = of->solution ? fopen(of->solution, "r") : NULL;
	char line[1 << 14];
	if (!file)
		return;
	if (!fgets(line, sizeof line, file))
		complain("the solution has no first line");
	for (int k = 0; k <= STEPS; k++) {
		char *p = line;
		if (!fgets(line, sizeof line, file)) {
			complain("the solution has %d rows, expected %d", k, STEPS + 1);
			break;
		}
		const double t = strtod(p, &p);
		bool good = near(row[k].t, t, in_float ? 1e-6 : 1e-13, "time", t, "t");
		for (int i = 0; i < outputs; i++) {
			const double expected = strtod(p + 1, &p);
			good = near(row[k].out[i], expected, rounding(k) * own[i] + loss_of(output_name(i)),
				"output against the closed form", t,
				output_name(i)) && good;
			worst_solution = worse(worst_solution, fabs(row[k].out[i] - expected) / own[i]);
		}
		if (!good)
			break;
	}
	fclose(file);
}

static bool same_bits(const double *a, const double *b, int n)
{
	for (int i = 0; i < n; i++)
		if (!(a[i] == b[i]))
			return false;
	return true;
}

/* What one unit in the state may make in each output: a difference of large positions, many */
static void find_gains(double *gain)
{
	void *const s = fresh();
	double y[MOST], still[MOST], moved[MOST];
	memcpy(y, row[STEPS].y, sizeof y);
	memset(gain, 0, sizeof *gain * MOST);
	for (int j = -1; j < states; j++) {
		const double from = j < 0 ? 0 : y[j];
		if (j >= 0)
			y[j] += 1e-3 * size;
		model_init(s);
		model_set(s, row[STEPS].t, y);
		model_out(s, j < 0 ? still : moved);
		if (j >= 0)
			y[j] = from;
		for (int i = 0; i < outputs && j >= 0; i++)
			gain[i] += fabs(moved[i] - still[i]) / (1e-3 * size);
	}
	free(s);
}

static void judge_run(void)
{
	void *const s = fresh();
	double *const out = malloc(sizeof *out * (size_t)(STEPS * outputs + 1));
	double *const u = malloc(sizeof *u * (size_t)(STEPS * inputs + 1)), y[MOST];
	float *const outf = malloc(sizeof *outf * (size_t)(STEPS * outputs + 1));
	float *const uf = malloc(sizeof *uf * (size_t)(STEPS * inputs + 1));
	const double ulps = 2 * of->adds * (in_float ? 0x1p-23 : 0x1p-52);
	double gain[MOST];
	find_gains(gain);
	if (!out || !u || !outf || !uf)
		exit(3);
	for (int k = 0; k < STEPS; k++)
		samples(k, u + k * inputs);
	narrow(u, uf, STEPS * inputs);
	for (int rows = 0; rows < 2; rows++) {
		model_init(s);
		if (of->model) {
			of->model->run(s, STEPS, inputs ? u : NULL, rows ? out : NULL);
		} else {
			of->modelf->run(s, STEPS, inputs ? uf : NULL, rows ? outf : NULL);
			if (rows)
				widen(outf, out, STEPS * outputs);
		}
		model_get(s, y);
		for (int i = 0; i < states; i++)
			near(y[i], row[STEPS].y[i], STEPS * ulps * size, rows ? "run with rows" : "run",
			     STEPS * h, state_name(i));
		for (int k = 0; k < STEPS && rows; k++)
			for (int i = 0; i < outputs; i++)
				near(out[k * outputs + i], row[k + 1].out[i],
				     (k + 1) * ulps * fmax(out_size, fmax(gain[i], 1) * size), "run, a row",
				     (k + 1) * h, output_name(i));
        }
	free(s), free(out), free(u), free(outf), free(uf);
}

/* Saved at a third of the run, and gone on with in another place. */
static void judge_restore(void)
{
	void *const s = fresh(), *const saved = fresh();
	double u[MOST], y[MOST];
	model_init(s);
	for (int k = 0; k < STEPS; k++) {
		if (k == STEPS / 3) {
			memcpy(saved, s, bytes());
			memset(s, 0, bytes());
			memcpy(s, saved, bytes());
		}
		samples(k, u);
		model_step(s, u);
	}
	model_get(s, y);
	if (!same_bits(y, row[STEPS].y, states))
		complain("a restored state goes on otherwise: %.17g, expected %.17g", y[0], row[STEPS].y[0]);
	free(s), free(saved);
}

/* false: there is none */
static bool model_jump(void *s, int steps)
{
	if (of->model ? !of->model->jump : !of->modelf->jump)
		return false;
	if (of->model)
		of->model->jump(s, (uint64_t)steps);
	else
		of->modelf->jump(s, (uint64_t)steps);
	return true;
}

static void judge_jump(void)
{
	static const int lengths[] = { 0, 1, 7, STEPS };
	void *const s = fresh();
	double y[MOST];
	for (int i = 0; i < 4; i++) {
		model_init(s);
		if (!model_jump(s, lengths[i]))
			break;
		model_get(s, y);
                near(model_time(s), row[lengths[i]].t, in_float ? 1e-6 : 1e-14, "time after a jump", lengths[i] * h,
                     "t");
                for (int j = 0; j < states; j++)
                    near(y[j], row[lengths[i]].y[j], rounding(lengths[i]) * size, "jump against steps", lengths[i] * h,
                         state_name(j));
        }
	free(s);
}

static void judge_at(void)
{
	const bool plain = is(of->scheme, "exact") && *of->changes == 0 && !is(of->class, "piecewise") &&
			   !is(of->class, "sticking");
	void *const s = fresh(), *const before = fresh();
	struct truth *solver = new_truth();
	struct beside eighths = begin_eighths(0, 0, NULL);
	double u[MOST], y[MOST], now[MOST], past[MOST] = {0}, finer[MOST] = {0};
	const bool all = whole() && of->slopes;
	model_init(s);
	for (int k = 0; k < STEPS; k++) {
		whole_samples(k, u);
		if (k % 5 == 2) {
			memcpy(before, s, bytes());
			if (!model_at(s, u, 0, y))
				break;
			for (int i = 0; i < states; i++)
				near(y[i], row[k].y[i], 0, "at(0) against get", row[k].t, state_name(i));
			model_at(s, u, of->model ? of->model->h : (double)of->modelf->h, y);
			for (int i = 0; i < states; i++)
				near(y[i], row[k + 1].y[i], (plain ? rounding(4) : bound()) * size, "at(h)",
					row[k].t, state_name(i));
			model_at(s, u, 0.375 * h, y);
			if (memcmp(before, s, bytes()) != 0)
				complain("at changes the state, t = %.17g", row[k].t);
			if (all) {
				double moved[2 * MOST];
				if (eighths.fine)
					get_inside(&eighths, row[k].t, row[k].y, u, 3, finer);
				over_step(past, u, h, moved);
				memcpy(now, row[k].y, sizeof now);
				if (advance(solver, k * h, (k + 0.375) * h, moved, now))
					for (int i = 0; i < states; i++)
						in_order(s, y[i], finer[i], now[i], bound() * size,
							"at(3/8 h) against CVODE", row[k].t, state_name(i));
                                truth_free(solver);
				solver = new_truth();
			}
		}
		memcpy(past, u, sizeof past);
		model_step(s, u);
		if (eighths.fine)
			step_by_eighths(&eighths, u);
	}
	truth_free(solver);
	free(s), free(before), free(eighths.fine);
}

/* At an odd time, and where it is already. */
static void judge_set(void)
{
	void *const s = fresh();
	double u[MOST], y[MOST];
	model_init(s);
	for (int k = 0; k < STEPS; k++) {
		samples(k, u);
		if (k == 9)
			model_set(s, row[k].t, row[k].y);
		model_step(s, u);
	}
	model_get(s, y);
	const bool exact = is(of->scheme, "exact") && !is(of->class, "piecewise") && !is(of->class, "sticking");
	for (int i = 0; i < states; i++)
            near(y[i], row[STEPS].y[i],
                 (exact          ? 4 * rounding(STEPS)
                  : in_float     ? 2e-3
                  : *of->changes ? bound()
                  : is(of->scheme, "radau") ? 1e-6      /* the step that it had found goes with set */
                  /* what earlier steps have left goes: where slopes jump both are off the truth, each by as much */
                  : !strncmp(of->scheme, "etdam", 5) && (is(of->class, "kinked") || is(of->class, "piecewise"))
                      ? 2 * bound()
                                            : 1e-7) *
                     size,
                 "steps after set to where it is", STEPS * h, state_name(i));
        if (!whole() || (of->model ? of->model->params : of->modelf->params) > 8) {
		free(s);
		return;
	}
	for (int k = 0; k < 3; k++) {
		samples(k, u);
		model_step(s, u);
	}
	for (int i = 0; i < states; i++)
		y[i] = (double)((i * 29 + 7) % 41 - 20) / 64;
	model_set(s, 0.3515625, y);
	model_get(s, u);
	if (!same_bits(u, y, states))
		complain("get after set: %.17g, expected %.17g", u[0], y[0]);
	const double kept = size;
	size = fmax(size, 0.5);
	if (of->slopes) {
		judge_steps(s, 3, LATER, h, NULL, "steps after set against CVODE");
	} else {
		struct beside b = begin();
		for (int k = 0; k < 3; k++)
			step_beside(&b, k);
		set_beside(&b, 0.3515625, y);
		judge_beside(&b, 3, LATER, "steps after set against another scheme");
		end_beside(&b);
	}
	size = kept;
	free(s);
}

/* ---- other params ---- */

static bool retuned(void *s, const char *values, double *step)
{
	const int count = of->model ? of->model->params : of->modelf->params;
	double value[MOST];
	float narrowed[MOST];
	*step = h;
	for (int i = 0; i < count; i++) {
		const char *const name = of->model ? of->model->param_names[i] : of->modelf->param_names[i];
		value[i] = of->model ? of->model->param_values[i] : (double)of->modelf->param_values[i];
		for (const char *p = values; (p = strstr(p, name)); p++)
			if ((p == values || p[-1] == ' ') && p[strlen(name)] == '=')
				value[i] = strtod(p + strlen(name) + 1, NULL);
	}
	const char *const p = strstr(values, "step=");
	if (p)
		*step = strtod(p + 5, NULL);
	narrow(value, narrowed, count);
        const int status = of->model ? of->model->retune(s, value, *step)
                                     : of->modelf->retune(s, narrowed, (float)*step);
        if (status)
		complain("retune to %s: status %d", *values ? values : "the spec's own values", status);
	return status == 0;
}

/* With the values written the operator is another one, where a scheme leaves what differs to a quadrature: both are off
 * the truth, each by as much as a scheme may. A series and a collocation have none; where they step to a tolerance, an
 * expression that rounds otherwise may choose other lengths of steps, and each run is off by a tolerance a step. */
static double retuned_bound(int steps)
{
	static const char *const of_equations[] = { "taylor", "radau", "auto", "etdcol" };
	bool equations = strstr(of->retune, "step=") != NULL;
	for (size_t i = 0; i < sizeof of_equations / sizeof *of_equations; i++)
		equations = equations || strncmp(of->scheme, of_equations[i], strlen(of_equations[i])) == 0;
	return equations ? 10 * rounding(steps) + 2 * (steps + 1) * of->tolerance : 2 * bound();
}

/* With other params too: `stepped` is behind STEPS of their steps, and so far from 0 at most */
static void judge_tuned_jump(const void *stepped, double largest)
{
	void *const s = fresh();
	double y[MOST], expected[MOST], step;
	model_init(s);
	if (retuned(s, of->retune, &step) && model_jump(s, STEPS)) {
		model_get(s, y);
		model_get(stepped, expected);
		near(model_time(s), model_time(stepped), in_float ? 1e-6 : 1e-13, "time after a jump, retuned",
		     STEPS * step, "t");
		for (int i = 0; i < states; i++)
			near(y[i], expected[i], 2 * rounding(STEPS) * largest, "jump against steps, retuned",
			     STEPS * step, state_name(i));
	}
	free(s);
}

static void judge_retune(void)
{
	void *const s = fresh(), *const w = of->tuned ? malloc(of->tuned->size) : NULL;
	double y[MOST], expected[MOST], u[MOST], step, largest = 0;
	if (of->model ? !of->model->retune : !of->modelf->retune) {
		free(s), free(w);
		return;
	}
	model_init(s);
	if (retuned(s, "", &step)) {
		for (int k = 0; k < STEPS; k++) {
			samples(k, u);
			model_step(s, u);
		}
		model_get(s, y);
		for (int i = 0; i < states; i++)
                    near(y[i], row[STEPS].y[i], 10 * rounding(STEPS) * size, "retuned to the spec's own values",
                         STEPS * h, state_name(i));
        }
	if (w) {
		model_init(s);
		of->tuned->init(w);
		model_get(s, y);
		of->tuned->set(w, 0, y);
		if (retuned(s, of->retune, &step))
			for (int k = 0; k < STEPS; k++) {
				bool good = true;
				samples(k, u);
				model_step(s, u);
				of->tuned->step(w, inputs ? u : NULL);
				model_get(s, y);
				of->tuned->get(w, expected);
				for (int i = 0; i < states; i++)
					largest = fmax(largest, fabs(expected[i]));
				for (int i = 0; i < states; i++)
                                    good = near(y[i], expected[i], retuned_bound(k) * largest,
                                                "retuned, against the spec with these values", (k + 1) * step,
                                                state_name(i)) &&
                                           good;
                                model_out(s, y);
				of->tuned->out(w, expected);
				for (int i = 0; i < outputs; i++)
					out_size = worse(out_size, fabs(expected[i]));
				for (int i = 0; i < outputs && !(in_float && largest > 1e3); i++)
                                    good = near(y[i], expected[i], retuned_bound(k) * fmax(largest, out_size),
                                                "retuned, outputs", (k + 1) * step, output_name(i)) &&
                                           good;
				if (!good)
					break;
				if (k == STEPS - 1)
					judge_tuned_jump(s, largest);
			}
	}
	free(s), free(w);
}

int main(int argc, char **argv)
{
	for (of = subjects; of->name && (argc < 2 || !is(of->name, argv[1]));)
		of++;
	if (!of->name) {
		fprintf(stderr, "usage: drive NAME\n");
		return 2;
	}
	in_float = !of->model;
	states = in_float ? of->modelf->states : of->model->states;
	inputs = in_float ? of->modelf->inputs : of->model->inputs;
	outputs = in_float ? of->modelf->outputs : of->model->outputs;
	h = of->whole->h;
	if (states > MOST || outputs > MOST || of->whole->states > MOST || inputs > 4) {
		complain("%d states, %d inputs and %d outputs are too many for this program", states, inputs, outputs);
		return 1;
	}
	find_ramps();
	judge_rhs();
	run_steps();
	if (complaints == 0) {
		judge_truth();
		judge_solution();
		judge_run();
		judge_restore();
		judge_jump();
		judge_at();
		judge_set();
		judge_retune();
	}
	if (of->selftest) {
		const double ulps = of->selftest();
		const bool crosses = is(of->class, "piecewise") || is(of->class, "sticking");
		const double apart = of->sustained ? of->sustained() / 0.5 : 0;
		const double most = (size > 1e3 || crosses ? 1000 : 100) * of->ratio + 20 * apart;
		if (!(ulps <= most))
			complain("selftest: %.17g units in the last place, at most %g", ulps, most);
	}
	if (of->lanes) {
		const double off = of->lanes();
		if (!(off <= rounding(12)))
			complain("instances of the batch are off one alone by %.3g, tolerance %.3g", off, rounding(12));
	}
	if (complaints == 0)
		printf("%s: %s, CVODE %.1e, closed form %.1e\n", of->name, of->scheme, worst_truth, worst_solution);
	return complaints != 0;
}
