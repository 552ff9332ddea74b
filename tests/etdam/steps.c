/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What steps in normal modes do, against the equations by hand in long double: orders, of the first steps too; banks;
 * changes of formula; steps that are exact once nothing changes; the rotating beam; what is the same bit for bit. */
#include "alike.h"
#include "cantilever.h"
#include "frames.h"
#include "spun_float_pl.h"
#include "steps_variants.h"
#include "tap.h"

#include <math.h>

/* ---- errors ---- */

/* The largest at `points` equal times, over the largest coordinate; a run that is not well is infinitely wrong */
static double error_over(const struct subject *s, const pl_model *m, double seconds, int points)
{
	double y[MOST], worst = 0, most = 0;
	real truth[MOST];
	void *state = fresh(m);
	m->get(state, y);
	for (int i = 0; i < m->states; i++)
		truth[i] = y[i];
	for (int k = 0; k < points; k++) {
		m->run(state, (size_t)lround(seconds / points / m->h), NULL, NULL);
		m->get(state, y);
		solve(s, (real)seconds * k / points, (real)seconds * (k + 1) / points, truth);
		for (int i = 0; i < m->states / 2; i++) {
			worst = worse(worst, (double)fabsl(y[i] - truth[i]));
			most = fmax(most, (double)fabsl(truth[i]));
		}
	}
	if (m->status(state) != 0)
		worst = INFINITY;
	free(state);
	return worst / most;
}

static const pl_model *model_of(const char *name, int step)
{
	return variant_of(steps, "%s_%d", name, step)->model;
}

/* Errors at steps that are halved, one after the other; `least` is what the worst pair may show of the order */
static void has_order(const struct subject *s, const char *name, int steps_made, double least, double seconds)
{
	double before = error_over(s, model_of(name, 0), seconds, 40), worst = INFINITY, error = before;
	for (int k = 1; k < steps_made; k++) {
		error = error_over(s, model_of(name, k), seconds, 40);
		worst = fmin(worst, log2(before / error));
		before = error;
	}
	bool good = close_to(fmin(worst, least), least, 0, "%s: least order found", name);
	ok(good && error > 1e-15 && error < 1e-5, "%s: order %.2f, at least %.2f (last error %.3g)", name, worst, least,
		error);
}

/* Of the first steps alone, which have no past: what they lose would stay */
static void starts_well(const char *name, int count, double least)
{
	const pl_model *wide = model_of(name, 0), *narrow = model_of(name, 1);
	double coarse = error_over(&gyro_frame, wide, count * wide->h, count);
	double fine = error_over(&gyro_frame, narrow, count * narrow->h, count), found = log2(coarse / fine);
	bool good = close_to(fmin(found, least), least, 0, "%s: least order of the first steps", name);
	ok(good && fine > 1e-16, "%s: the first %d steps fall with h^%.2f, at least %.1f (%.3g, %.3g)", name, count,
			found,
		least, coarse, fine);
}

/* ---- once nothing changes ---- */

/* From the state at 2 s on, beside the equations; at least: of what only approximates them */
static void stays_exact(const struct subject *s, const char *name, double least, double bound)
{
	const pl_model *m = model_of(name, 0);
	void *state = fresh(m);
	double y[4], worst = 0, most = 0;
	real truth[4];
	m->run(state, (size_t)lround(2 / m->h), NULL, NULL);
	m->get(state, y);
	for (int i = 0; i < 4; i++)
		truth[i] = y[i];
	for (int second = 2; second < 42; second++) {
		m->run(state, (size_t)lround(1 / m->h), NULL, NULL);
		m->get(state, y);
		gragg(s->f, 4, second, second + 1, s->piece, 0, NULL, truth);
		for (int i = 0; i < 4; i++) {
			worst = worse(worst, (double)fabsl(y[i] - truth[i]));
			most = fmax(most, (double)fabsl(truth[i]));
		}
	}
	free(state);
	ok(worst / most >= least && close_to(worst / most, 0, bound, "%s", name),
		"%s: 40 s after the last change, from the state there: %.2g", name, worst / most);
}

/* ---- loads that turn many times in a step ---- */

/* Of the mass that nothing but these moves, at steps' ends and inside; beside it the same left to the quadrature */
static void follows_loads(const char *name, double least, double bound)
{
	const pl_model *m = model_of(name, 0);
	void *state = fresh(m);
	double y[4], inside[4], worst = 0;
	real truth[4];
	m->get(state, y);
	for (int i = 0; i < 4; i++)
		truth[i] = y[i];
	for (int k = 0; k < 200; k++) {
		real t = k * (real)m->h, half = t + (real)m->h / 2;
		m->at(state, NULL, m->h / 2, inside);
		solve(&rotor_frame, t, half, truth);
		worst = fmax(worst, (double)fabsl(inside[0] - truth[0]) + (double)fabsl(inside[2] - truth[2]) / 300);
		m->step(state, NULL);
		m->get(state, y);
		solve(&rotor_frame, half, t + (real)m->h, truth);
		worst = fmax(worst, (double)fabsl(y[0] - truth[0]) + (double)fabsl(y[2] - truth[2]) / 300);
	}
	ok(worst >= least && close_to(worst, 0, bound, "%s", name) && m->status(state) == 0,
		"%s: a mass under loads of 15 rad in a step is off by %.2g", name, worst);
	free(state);
}

/* ---- the beam ---- */

static void turns_beam(const char *name, double bound)
{
	double error = error_over(&turning_beam, model_of(name, 0), 3, 3);
	ok(close_to(error, 0, bound, "%s", name), "%s: over 3 s of the spin-up %.2g of the largest deflection", name,
		error);
}

/* Two runs of the beam, `rows` tenths of a second long: how far states from `first` to `last` are apart at most, and
 * the largest of them */
struct apart { double worst, most; };

static struct apart run_beside(const char *one, const char *other, int rows, int first, int last)
{
	const pl_model *a = model_of(one, 0), *b = model_of(other, 0);
	void *s = fresh(a), *t = fresh(b);
	struct apart found = {0, 0};
	double y[30], z[30];
	for (int k = 1; k <= rows; k++) {
		a->run(s, (size_t)lround(0.1 / a->h), NULL, NULL);
		b->run(t, (size_t)lround(0.1 / b->h), NULL, NULL);
		a->get(s, y);
		b->get(t, z);
		for (int i = first; i <= last; i++) {
			found.worst = worse(found.worst, fabs(y[i] - z[i]));
			found.most = fmax(found.most, fabs(z[i]));
		}
	}
	free(s);
	free(t);
	return found;
}

/* Through all operators to the end of the spin-up: two methods of other kinds, at other steps */
static void agrees_over_spin_up(double bound)
{
	const struct apart tip = run_beside("beam_etdam6", "beam_nodes", 200, CANTILEVER_TIP, CANTILEVER_TIP);
	const double part = tip.worst / tip.most;
	ok(close_to(tip.most, 1.3736, 0.00005, "largest deflection") && close_to(part, 0, bound, "difference"),
		"beam over 20 s: largest deflection %.5f m, known 1.3736 m; etdam6 beside etdcol %.2g", tip.most, part);
}

/* Velocities of two methods over all changes of operator: what these lose in fast modes would ring on */
static void rings_little(double bound)
{
	const struct apart speeds = run_beside("rings", "rings_less", 150, 15, 29);
	const double part = speeds.worst / speeds.most;
	ok(speeds.most > 0.1 && close_to(part, 0, bound, "difference"),
		"beam over nine operators: velocities of two methods differ by %.2g of the largest", part);
}

/* ---- changes inside a step, of another start than 0 ---- */

static void tells_change(const char *name, bool on_grid)
{
	const pl_model *m = model_of(name, 0);
	void *state = fresh(m);
	double y[4] = {0.5, 0, 0, 1};
	m->set(state, on_grid ? 0.25 : 0.2625, y);
	m->run(state, (size_t)lround(1 / m->h), NULL, NULL);
	ok(m->status(state) == (on_grid ? 0 : PL_INACCURATE), "%s, set at %g s: status %d", name, on_grid ? 0.25
			: 0.2625,
		m->status(state));
	free(state);
}

/* ---- accelerations, float ---- */

static void outputs_of(const char *name)
{
	const pl_model *m = model_of(name, 1);
	void *state = fresh(m);
	double y[4], out[4], worst = 0;
	real wide[4], dydt[4];
	for (int k = 0; k < 50; k++) {
		m->step(state, NULL);
		m->get(state, y);
		m->out(state, out);
		for (int i = 0; i < 4; i++)
			wide[i] = y[i];
		gyro_frame.f((k + 1) * (real)m->h, wide, NULL, dydt);
		for (int i = 0; i < 2; i++) {
			worst = worse(worst, fabs(out[i] - y[i]));
			worst = worse(worst, (double)fabsl(out[2 + i] - dydt[2 + i]) / 40);
		}
	}
	free(state);
	ok(close_to(worst, 0, 1e-14, "%s", name), "%s: outputs, accelerations among them (%.2g)", name, worst);
}

static void in_float(void)
{
	spun_float s;
	float y[4];
	real truth[4] = {0.5L, 0, 0, 1};
	double worst = 0;
	spun_float_init(&s);
	for (int k = 0; k < 30; k++) {
		for (int i = 0; i < 4; i++)
			spun_float_step(&s);
		spun_float_get(&s, y);
		solve(&spun_frame, k * 0.1L, (k + 1) * 0.1L, truth);
		for (int i = 0; i < 2; i++)
			worst = worse(worst, (double)fabsl(y[i] - truth[i]));
	}
	ok(close_to(worst, 0, 1e-5, "spun in float") && spun_float_status(&s) == 0, "spun in float, etdam5 (%.2g)",
			worst);
}

int main(void)
{
	has_order(&gyro_frame, "gyro_etdam4", 3, 4.8, 8);
	has_order(&gyro_frame, "gyro_etdam5", 3, 5.8, 8);
	has_order(&gyro_frame, "gyro_etdam6", 2, 6.7, 8);
	has_order(&gyro_frame, "banked_etdam4", 3, 4.5, 8);
	has_order(&gyro_frame, "banked_etdam5", 2, 5.4, 8);
	has_order(&gyro_frame, "banked_etdam6", 2, 6.3, 8);
	has_order(&gyro_frame, "nodes_3", 2, 4, 8);
	has_order(&gyro_frame, "nodes_4", 2, 5, 8);
	has_order(&gyro_frame, "nodes_5", 2, 6, 8);
	starts_well("first_etdam4", 3, 6);
	starts_well("first_etdam5", 4, 7);
	has_order(&spun_frame, "spun_etdam4", 2, 4.3, 4);
	has_order(&spun_frame, "spun_etdam6", 2, 6, 4);
	has_order(&spun_frame, "spun_nodes", 2, 6, 4);
	has_order(&bent_frame, "bent_etdam4", 2, 4.6, 4);
	has_order(&bent_frame, "bent_etdam6", 2, 6.3, 4);
	has_order(&bent_frame, "bent_nodes", 2, 5, 4);
	has_order(&turned_frame, "turned_etdam5", 2, 4.5, 4);
	stays_exact(&spun_frame, "spun_etdam4", 0, 1e-14);
	stays_exact(&spun_frame, "spun_nodes", 0, 1e-14);
	stays_exact(&turned_frame, "turned_etdam5", 0, 1e-14);
	stays_exact(&turned_frame, "turned_nodes", 0, 1e-14);
	stays_exact(&spun_frame, "ended_etd1", 0, 1e-13);
	stays_exact(&spun_frame, "ended_etdrk2", 0, 1e-13);
	stays_exact(&spun_frame, "ended_etdrk4", 0, 1e-13);
	stays_exact(&spun_frame, "ended_nc2", 0, 1e-13);
	stays_exact(&spun_frame, "unended_etdrk2", 1e-5, 1);
	follows_loads("rotor_etdam4", 0, 5e-14);
	follows_loads("rotor_nodes", 0, 5e-14);
	follows_loads("rotor_left_etdam4", 1e-3, 10);
	turns_beam("beam_etdam4", 1e-7);
	turns_beam("beam_etdam6", 1e-11);
	turns_beam("beam_nodes", 1e-12);
	agrees_over_spin_up(2e-11);
	rings_little(4e-13);
	same_bits(model_of("gyro_etdam4", 0));
	same_bits(model_of("banked_etdam5", 0));
	same_bits(model_of("spun_etdam6", 0));
	same_bits(model_of("nodes_4", 0));
	same_bits(model_of("bent_etdam4", 0));
	tells_change("spun_etdam4", true);
	tells_change("spun_etdam4", false);
	tells_change("spun_nodes", false);
	outputs_of("gyro_etdam5");
	outputs_of("banked_etdam4");
	in_float();
	return tap_end();
}
