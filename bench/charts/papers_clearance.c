/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Source 002: piecewise full decoupling of piecewise-linear systems (Kranjcevic, Stegic and Vrankovic, PAMM 2003):
 * exact inside each region, crossings found in time. Here the states and numbers of crossings at known times, steady
 * motion beside the balance of one harmonic, and what a crossing costs. */
#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "papers.h"

static const char source[] = "002";
static const char chosen[] = "h = 0.1 s; all numbers of the model are chosen";

typedef uint64_t crossed_function(const void *state);

static crossed_function *crossed_of(const struct problem *p)
{
	void *symbol = dlsym(p->handle, "subject_crossed");
	crossed_function *crossed;
	memcpy(&crossed, &symbol, sizeof crossed);
	return crossed;
}

/* ---- known states ---- */

static const struct known {
	const char *variant, *model;
	double seconds;
	int states;
	const char *state[4], *crossings;
} known[] = {
	{ "gear1_8", "gear1, eta = 0.8", 50, 2, { "1.3462716421777", "0.0182023595639939" }, "12" },
	{ "gear1_10", "gear1, eta = 1", 50, 2, { "0.9044965191187", "0.0052437460534" }, "15" },
	{ "gear2", "gear2", 20, 4, { "1.255478222291", "0.278107931790", "-0.141334496941", "-0.146319581244" }, "2" },
};

static void compare_states(const struct papers *papers, FILE *table, const struct known *k)
{
	struct problem *p = papers_problem(papers, k->variant, k->model, k->seconds, 1, -1);
	const pl_model *m = p->model;
	void *state = calloc(1, m->size);
	double y[4];
	m->init(state);
	m->run(state, (size_t)lround(k->seconds / m->h), NULL, NULL);
	m->get(state, y);
	for (int i = 0; i < k->states; i++)
		put_row(table, k->model, "exact", text("%s at t = %g s", m->state_names[i], k->seconds), NULL,
			k->state[i], text("%.13g", y[i]), chosen);
	put_row(table, k->model, "exact", text("changes of region until t = %g s", k->seconds), NULL, k->crossings,
		text("%ju", (uintmax_t)crossed_of(p)(state)), chosen);
	free(state);
	problem_free(p);
}

/* ---- steady motion ---- */

static const double zeta = 0.05, mean_load = 0.1, load = 0.05, clearance = 1; /* as in models/gear1.spec */

struct swing { double amplitude, mean; };

static double dead_zone(double x)
{
	return x > clearance ? x - clearance : x < -clearance ? x + clearance : 0;
}

/* For x = mean + amplitude cos(phi): average force, and its first harmonic */
static void harmonics(struct swing x, double *force, double *harmonic)
{
	enum { POINTS = 3600 };
	*force = *harmonic = 0;
	for (int i = 0; i < POINTS; i++) {
		const double phi = 2 * M_PI * i / POINTS, g = dead_zone(x.mean + x.amplitude * cos(phi));
		*force += g / POINTS;
		*harmonic += 2 * g * cos(phi) / POINTS;
	}
}

/* The square of the load that a motion of this amplitude asks for, less that there is; its mean balances the mean
 * load, and the average force rises with it. */
static double lacks(double eta, struct swing *x)
{
	double low = 0, high = 4, force, harmonic;
	for (int halving = 0; halving < 50; halving++) {
		x->mean = (low + high) / 2;
		harmonics(*x, &force, &harmonic);
		if (force < mean_load)
			low = x->mean;
		else
			high = x->mean;
	}
	const double in_phase = harmonic - eta * eta * x->amplitude, across = 2 * zeta * eta * x->amplitude;
	return in_phase * in_phase + across * across - load * load;
}

/* All motions that balance up to an amplitude of 2, the smallest first; how many */
static int balance(double eta, int most, struct swing *found)
{
	const double apart = 0.02;
	int count = 0;
	struct swing x = { 0, 0 };
	for (double from = apart / 2, before = (x.amplitude = from, lacks(eta, &x)); from < 2 && count < most;
	     from += apart) {
		double low = from, high = from + apart;
		x.amplitude = high;
		const double after = lacks(eta, &x);
		if ((before < 0) != (after < 0)) {
			while (high - low > 1e-9) {
				x.amplitude = (low + high) / 2;
				if ((lacks(eta, &x) < 0) == (before < 0))
					low = x.amplitude;
				else
					high = x.amplitude;
			}
			found[count++] = x;
		}
		before = after;
	}
	return count;
}

/* Half the range and the average over one period, after 600 s, when what was at the start has decayed by e^-30 */
static struct swing simulate(const struct problem *p, double eta)
{
	enum { POINTS = 4096 };
	const pl_model *m = p->model;
	const double period = 2 * M_PI / eta;
	double low = INFINITY, high = -INFINITY, sum = 0, y[2];
	void *state = calloc(1, m->size);
	m->init(state);
	m->run(state, (size_t)lround(600 / m->h), NULL, NULL);
	const double begun = m->time(state);
	for (int i = 0; i < POINTS; i++) {
		const double t = begun + period * i / POINTS;
		while (m->time(state) + m->h < t)
			m->step(state, NULL);
		m->at(state, NULL, t - m->time(state), y);
		low = fmin(low, y[0]);
		high = fmax(high, y[0]);
		sum += y[0];
	}
	free(state);
	return (struct swing){ (high - low) / 2, sum / POINTS };
}

static void compare_motion(const struct papers *papers, FILE *table, int tenths, const char *const recovered[4])
{
	char model[40];
	snprintf(model, sizeof model, "gear1, eta = %g", tenths / 10.0);
	struct problem *p = papers_problem(papers, text("gear1_%d", tenths), model, 1, 1, -1);
	struct swing balanced[9] = { { NAN, NAN } };
	const struct swing found = simulate(p, tenths / 10.0);
	const int count = balance(tenths / 10.0, 9, balanced);
	int nearest = 0;
	for (int i = 1; i < count; i++)
		if (fabs(balanced[i].amplitude - found.amplitude) < fabs(balanced[nearest].amplitude - found.amplitude))
			nearest = i;
	const char *simulated = "half the range and the average over one period after 600 s";
	const char *one = count == 1 ? "mean and one harmonic: an approximation; its only solution" :
		text("mean and one harmonic: an approximation; the nearest of its %d solutions", count);
	put_row(table, model, "exact", "steady amplitude", NULL, recovered[0], text("%.4f", found.amplitude),
		simulated);
	put_row(table, model, "harmonic balance", "steady amplitude", NULL, recovered[2],
		text("%.4f", balanced[nearest].amplitude), one);
	put_row(table, model, "exact", "steady mean", NULL, recovered[1], text("%.4f", found.mean), simulated);
	put_row(table, model, "harmonic balance", "steady mean", NULL, recovered[3],
		text("%.4f", balanced[nearest].mean), one);
	problem_free(p);
}

/* ---- cost of a step ---- */

enum { SAMPLES = 201, STEPS = 20, LOOKED_AT = 200000 };

/* Steps one after the other, from a kept state */
static double onward(const pl_model *m, void *state, const void *kept)
{
	memcpy(state, kept, m->size);
	const double start = now_ns();
	for (int k = 0; k < STEPS; k++)
		m->step(state, NULL);
	return (now_ns() - start) / STEPS;
}

/* The same step again and again from a kept state; without one: what putting it back costs */
static double again(const pl_model *m, void *state, const void *kept, bool step)
{
	const double start = now_ns();
	for (int k = 0; k < STEPS; k++) {
		memcpy(state, kept, m->size);
		__asm__ volatile("" : : "r"(state) : "memory");
		if (step)
			m->step(state, NULL);
	}
	return (now_ns() - start) / STEPS;
}

/* A state whose next `steps` steps cross so many breakpoints */
static bool find(const struct problem *p, int steps, uint64_t crossings, void *kept)
{
	crossed_function *crossed = crossed_of(p);
	const pl_model *m = p->model;
	void *state = calloc(1, m->size), *ahead = calloc(1, m->size);
	bool found = false;
	m->init(state);
	for (int k = 0; k < LOOKED_AT && !found; k++) {
		memcpy(kept, state, m->size);
		memcpy(ahead, state, m->size);
		m->run(ahead, (size_t)steps, NULL, NULL);
		found = crossed(ahead) - crossed(state) == crossings;
		m->step(state, NULL);
	}
	free(state);
	free(ahead);
	return found;
}

static void time_crossings(const struct papers *papers, const char *variant, const char *model)
{
	static const char *const quantity[3] = { "step without a clearance", "step without a crossing",
	                                         "step with one crossing" };
	static const char *const settings[3] = { "20 steps onward; h = 0.1 s; -O2", "20 steps onward; h = 0.1 s; -O2",
		"the same step again and again, less what putting the state back costs; h = 0.1 s; -O2" };
	struct problem *plain = papers_problem(papers, text("%s_plain", model), model, 1, 1, -1),
		*stops = papers_problem(papers, variant, model, 1, 1, -1);
	const pl_model *of[3] = { plain->model, stops->model, stops->model };
	void *kept[3], *state = calloc(1, stops->model->size + plain->model->size);
	double ns[3][SAMPLES];
	for (int i = 0; i < 3; i++)
		kept[i] = calloc(1, of[i]->size);
	plain->model->init(kept[0]);
	bool found = find(stops, STEPS, 0, kept[1]);
	found = find(stops, 1, 1, kept[2]) && found;
	for (int k = 0; k < SAMPLES && found; k++) {
		ns[0][k] = onward(of[0], state, kept[0]);
		ns[1][k] = onward(of[1], state, kept[1]);
		ns[2][k] = again(of[2], state, kept[2], true);
		ns[2][k] = fmax(0, ns[2][k] - again(of[2], state, kept[2], false));
	}
	struct samples time[3];
	for (int i = 0; i < 3; i++)
		time[i] = sample_summary(found ? SAMPLES : 0, ns[i]);
	for (int i = 0; i < 3; i++) {
		put_time(papers, model, "exact", text("%s, over one without a clearance", quantity[i]), NULL,
			found ? text("%.3g", time[i].median / time[0].median) : "failed", settings[i], time[i]);
		free(kept[i]);
	}
	free(state);
	problem_free(plain);
	problem_free(stops);
}

void clearances(struct papers *papers)
{
	static const char *const recovered[3][4] = { { "0.3248", "0.9935", "0.3129", "1.0008" },
	                                             { "0.1870", "1.0733", "0.1839", "1.0734" },
		{ "0.1071", "1.0997", "0.1071", "1.0994" } };
	FILE *table = table_begin(papers, "papers_002.csv");
	say_progress("papers: 002, clearances");
	for (size_t i = 0; i < sizeof known / sizeof *known; i++)
		compare_states(papers, table, &known[i]);
	for (int i = 0; i < 3; i++)
		compare_motion(papers, table, 8 + 2 * i, recovered[i]);
	table_close(table, "papers");
}

void clearance_times(const struct papers *papers)
{
	time_crossings(papers, "gear1_8", "gear1");
	time_crossings(papers, "gear2", "gear2");
}
