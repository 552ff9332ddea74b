/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_at of steps in normal modes, against the equations by hand in long double: its order inside a step, the first
 * ones and those after changes too; it meets the steps; what is exact once nothing changes; the rotating beam. */
#include "alike.h"
#include "frames.h"
#include "spun_float_pl.h"
#include "steps_variants.h"
#include "tap.h"

#include <math.h>

enum { FRACTIONS = 3 };
static const double fraction[FRACTIONS] = {0.21, 0.5, 0.83};

static const pl_model *model_of(const char *name, int step)
{
	return variant_of(steps, "%s_%d", name, step)->model;
}

/* The larger; not a number stays */
static double larger(double worst, double error)
{
	return error <= worst ? worst : error;
}

/* Of coordinates, and of velocities over a frequency [rad/s], beside the largest coordinate */
struct found { double worst, most, frequency; };

static void compare(struct found *found, const real *truth, const double *y, int states)
{
	for (int i = 0; i < states; i++) {
		double error = (double)fabsl(y[i] - truth[i]);
		found->worst = larger(found->worst, i < states / 2 ? error : error / found->frequency);
		found->most = i < states / 2 ? larger(found->most, (double)fabsl(truth[i])) : found->most;
	}
}

/* Inside each of the steps `from` and up, to `to` */
static double error_inside(const struct subject *s, const pl_model *m, double from, double to, double frequency)
{
	struct found found = {0, 0, frequency};
	double y[MOST];
	real truth[MOST], inside[MOST];
	void *state = fresh(m);
	m->get(state, y);
	for (int i = 0; i < m->states; i++)
		truth[i] = y[i];
	long first = lround(from / m->h), last = lround(to / m->h);
	m->run(state, (size_t)first, NULL, NULL);
	solve(s, 0, first * (real)m->h, truth);
	for (long k = first; k < last; k++) {
		real t = k * (real)m->h, now = t;
		for (int i = 0; i < m->states; i++)
			inside[i] = truth[i];
		for (int j = 0; j < FRACTIONS; j++) {
			m->at(state, NULL, fraction[j] * m->h, y);
			solve(s, now, t + (real)fraction[j] * (real)m->h, inside);
			now = t + (real)fraction[j] * (real)m->h;
			compare(&found, inside, y, m->states);
		}
		m->step(state, NULL);
		solve(s, t, t + (real)m->h, truth);
	}
	free(state);
	return found.worst / found.most;
}

static void has_order_inside(const struct subject *s, const char *name, double from, double to, double least)
{
	double coarse = error_inside(s, model_of(name, 0), from, to, 10);
	double fine = error_inside(s, model_of(name, 1), from, to, 10), found = log2(coarse / fine);
	bool good = close_to(fmin(found, least), least, 0, "%s: least order inside", name);
	ok(good && fine > 1e-16 && fine < 1e-4, "%s, inside steps from %g s to %g s: order %.2f, at least %.1f (%.2g)",
		name, from, to, found, least, fine);
}

/* At both ends of each step, of all coordinates and velocities; where sweeps end, to what they leave */
static void meets_steps(const char *name, double bound)
{
	const pl_model *m = model_of(name, 0);
	struct found start = {0, 0, 10}, end = start;
	double y[MOST];
	real now[MOST];
	bool same = true;
	void *state = fresh(m), *saved = calloc(1, m->size);
	for (int k = 0; k < 90; k++) {
		m->get(state, y);
		for (int i = 0; i < m->states; i++)
			now[i] = y[i];
		memcpy(saved, state, m->size);
		m->at(state, NULL, 0, y);
		compare(&start, now, y, m->states);
		m->at(state, NULL, m->h, y);
		same = same && memcmp(saved, state, m->size) == 0;
		m->step(state, NULL);
		double after[MOST];
		m->get(state, after);
		for (int i = 0; i < m->states; i++)
			now[i] = after[i];
		compare(&end, now, y, m->states);
	}
	bool good = close_to(start.worst / start.most, 0, 2e-15, "%s: at 0", name) &&
		close_to(end.worst / end.most, 0, bound, "%s: at h", name);
	ok(good && same, "%s: at 0 the state (%.2g), at h that after the step (%.2g), which a look %s", name,
		start.worst / start.most, end.worst / end.most, same ? "leaves as it is" : "CHANGES");
	free(state);
	free(saved);
}

/* From the state at a step's start, once nothing changes */
static void is_exact_inside(const struct subject *s, const char *name, double bound)
{
	const pl_model *m = model_of(name, 0);
	struct found found = {0, 0, 10};
	double y[MOST];
	void *state = fresh(m);
	m->run(state, (size_t)lround(2 / m->h), NULL, NULL);
	for (int k = 0; k < 100; k++) {
		for (int j = 0; j < FRACTIONS; j++) {
			real truth[MOST];
			m->get(state, y);
			for (int i = 0; i < 4; i++)
				truth[i] = y[i];
			gragg(s->f, 4, m->time(state), m->time(state) + (real)fraction[j] * (real)m->h, s->piece, 0,
					NULL, truth);
			m->at(state, NULL, fraction[j] * m->h, y);
			compare(&found, truth, y, 4);
		}
		m->step(state, NULL);
	}
	free(state);
	ok(close_to(found.worst / found.most, 0, bound, "%s", name), "%s: inside steps after the last change %.2g",
			name,
		found.worst / found.most);
}

/* Its fastest modes ring: velocities over their frequency */
static void turns_inside(const char *name, double bound)
{
	double error = error_inside(&turning_beam, model_of(name, 0), 2.9, 3, 1000);
	ok(close_to(error, 0, bound, "%s", name), "%s: inside steps %.2g of the largest deflection", name, error);
}

static void in_float(void)
{
	spun_float s;
	struct found found = {0, 0, 10};
	float y[4];
	spun_float_init(&s);
	for (int k = 0; k < 120; k++) {
		real truth[4] = {0.5L, 0, 0, 1};
		double wide[4];
		solve(&spun_frame, 0, k * 0.025L + 0.0125L, truth);
		spun_float_at(&s, 0.0125f, y);
		for (int i = 0; i < 4; i++)
			wide[i] = (double)y[i];
		compare(&found, truth, wide, 4);
		spun_float_step(&s);
	}
	ok(close_to(found.worst / found.most, 0, 1e-5, "float"), "spun in float: inside steps %.2g",
		found.worst / found.most);
}

int main(void)
{
	has_order_inside(&gyro_frame, "gyro_etdam4", 0, 4, 4.8);
	has_order_inside(&gyro_frame, "gyro_etdam5", 0, 4, 5.6);
	has_order_inside(&gyro_frame, "gyro_etdam6", 0, 4, 6.5);
	has_order_inside(&gyro_frame, "banked_etdam4", 0, 4, 4.5);
	has_order_inside(&gyro_frame, "nodes_3", 0, 4, 4);
	has_order_inside(&gyro_frame, "nodes_5", 0, 4, 5.5);
	has_order_inside(&gyro_frame, "first_etdam5", 0, 0.1, 5.8);
	has_order_inside(&spun_frame, "spun_etdam6", 0, 2, 6);
	has_order_inside(&spun_frame, "spun_nodes", 0, 2, 5);
	has_order_inside(&turned_frame, "turned_etdam5", 0, 2, 4.5);
	has_order_inside(&bent_frame, "bent_etdam4", 0, 2, 4.5);
	has_order_inside(&bent_frame, "bent_etdam6", 0, 2, 6);
	meets_steps("gyro_etdam5", 1e-14);
	meets_steps("spun_etdam6", 1e-14);
	meets_steps("banked_etdam4", 1e-14);
	meets_steps("bent_etdam4", 1e-14);
	meets_steps("nodes_5", 1e-4);
	meets_steps("spun_nodes", 1e-10);
	meets_steps("turned_etdam5", 1e-14);
	is_exact_inside(&spun_frame, "spun_etdam4", 1e-14);
	is_exact_inside(&spun_frame, "spun_nodes", 1e-14);
	is_exact_inside(&turned_frame, "turned_etdam5", 1e-14);
	is_exact_inside(&turned_frame, "turned_nodes", 1e-14);
	turns_inside("beam_etdam4", 1e-7);
	turns_inside("beam_etdam6", 1e-11);
	turns_inside("beam_nodes", 1e-12);
	in_float();
	return tap_end();
}
