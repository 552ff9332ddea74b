/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Jumps of 10^3, 10^9 and 10^12 steps against the reference by hand: within 1e-13 of the largest component, velocities
 * over w, while |Re p| n h <= 5; and the phase of a cosine load after 10^9 steps, within 1e-12. */
#include "equations.h"
#include "linear.h"
#include "reference.h"
#include "tap.h"

#include <math.h>
#include <stdint.h>
#include <stdlib.h>

static void jump(const char *name, uint64_t n)
{
	const pl_model *model = linear_model(name);
	struct reference *r = reference_of(name);
	mpq_t *t = new_rationals(2);
	mpfr_t *x = new_floats(r->size);
	void *state = calloc(1, model->size);
	double y[4], expected[4];
	const double w = sqrt(300);
	mpq_set_ui(t[1], (unsigned long)n, 100);
	mpq_canonicalize(t[1]);
	model->init(state);
	model->get(state, y);
	reference_start(r, t[0], y, x);
	reference_advance(r, t[0], t[1], x);
	model->jump(state, n);
	model->get(state, y);
	double largest = 0, worst = 0;
	for (int i = 0; i < 4; i++) {
		expected[i] = mpfr_get_d(x[i], MPFR_RNDN);
		largest = fmax(largest, fabs(expected[i]) / (i < 2 ? 1 : w));
	}
	bool good = true;
	for (int i = 0; i < 4; i++) {
		const double scale = largest * (i < 2 ? 1 : w);
		good = close_to(y[i], expected[i], 1e-13 * scale, "%s, jump of %.0e, %s", name, (double)n,
			model->state_names[i]) && good;
		worst = worse(worst, fabs(y[i] - expected[i]) / scale);
	}
	good = close_to(model->time(state), nearest_double(t[1]), 0, "time") && good;
	ok(good, "%s: a jump of %.0e steps, within 1e-13", name, (double)n);
	note("%s, %.0e steps: largest difference %.3g of %.3g", name, (double)n, worst, largest);
	free(state);
	free_floats(x, r->size);
	free_rationals(t, 2);
	reference_free(r);
}

static bool phase_right(const void *state, const mpq_t t, const char *how)
{
	const pl_model *model = linear_model("far_wave");
	struct reference *r = reference_of("far_wave");
	mpfr_t *x = new_floats(r->size);
	double out[4], y[4] = {0};
	reference_start(r, t, y, x);
	model->out(state, out);
	bool good = true;
	double worst = 0;
	for (int i = 0; i < 2; i++) {
		const double expected = mpfr_get_d(x[4 + i], MPFR_RNDN);
		good = close_to(out[2 + i], expected, 1e-12, "%s, %s", how, i ? "sine" : "cosine") && good;
		worst = worse(worst, fabs(out[2 + i] - expected));
	}
	note("phase %s: difference %.3g", how, worst);
	free_floats(x, r->size);
	reference_free(r);
	return good;
}

int main(void)
{
	static const uint64_t far[] = {1000, 1000000000, 1000000000000};
	static const char *const names[] = {"far_free", "far_wave", "far_damped"};
	for (int m = 0; m < 3; m++)
		for (int i = 0; i < 3; i++)
			jump(names[m], far[i]);
	const pl_model *model = linear_model("far_wave");
	void *state = calloc(1, model->size);
	double y[4] = {0};
	mpq_t *t = new_rationals(1);
	mpq_set_ui(t[0], 10000000, 1);
	model->init(state);
	model->jump(state, 1000000000);
	ok(phase_right(state, t[0], "by jump"), "the phase after a jump of 10^9 steps, within 1e-12");
	model->set(state, 1e7, y);
	ok(phase_right(state, t[0], "by set"), "the phase after set to 10^7 s, within 1e-12");
	model->set(state, 5e6, y);
	model->jump(state, 500000000);
	ok(phase_right(state, t[0], "by set and jump"), "the phase after set to 5 10^6 s and a jump, within 1e-12");
	model->jump(state, 0);
	model->step(state, NULL);
	mpq_set_ui(t[0], 1000000001, 100);
	mpq_canonicalize(t[0]);
	ok(phase_right(state, t[0], "one step on"), "the phase one step on, within 1e-12");
	free_rationals(t, 1);
	free(state);
	return tap_end();
}
