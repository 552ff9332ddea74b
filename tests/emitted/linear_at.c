/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_at and NAME_set of models with every kind of load, and across changes of the loads, against the reference by
 * hand:
 *
 * |error_i| <= 16 eps sum_j max |E_ij| |x_j|, max over 0 .. h and over the formulas met, x = y and the loads, eps =
 * 2^-52, no time on to the last bit
 *
 * and steps from any time: past the changes, between them, before 0. */
#include "equations.h"
#include "linear.h"
#include "reference.h"
#include "tap.h"

#include "../accuracy/rationals.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 12, SIZE = 12 };

static const double bound = 16;

struct subject {
	const pl_model *model;
	struct reference *r;
	double most[SIZE * SIZE];
	double worst;
	int points;
};

static void prepare(struct subject *s)
{
	const int n = s->r->size;
	mpfr_t *E = new_floats(n * n);
	mpq_t tau;
	mpq_init(tau);
	for (int segment = 0; segment < s->r->segments; segment++)
		for (int p = 0; p <= POINTS; p++) {
			mpq_set_d(tau, s->model->h * p / POINTS);
			reference_matrix(s->r, segment, tau, E);
			for (int i = 0; i < n * n; i++)
				s->most[i] = fmax(s->most[i], fabs(mpfr_get_d(E[i], MPFR_RNDN)));
		}
	mpq_clear(tau);
	free_floats(E, n * n);
}

/* The state is that of the time t, exactly. */
static bool from_state(struct subject *s, const void *state, const mpq_t t)
{
	const int n = s->r->size;
	double y[SIZE], found[SIZE];
	mpfr_t *x = new_floats(n);
	mpq_t *end = new_rationals(1);
	bool good = true;
	s->model->get(state, y);
	for (int p = 0; p <= POINTS; p++) {
		const double tau = p == POINTS ? s->model->h : s->model->h * p / POINTS;
		reference_start(s->r, t, y, x);
		double scale[SIZE] = {0};
		for (int i = 0; i < s->r->states; i++)
			for (int j = 0; j < n; j++)
				scale[i] += s->most[i * n + j] * fabs(mpfr_get_d(x[j], MPFR_RNDN));
		mpq_set_d(end[0], tau);
		mpq_add(end[0], end[0], t);
		reference_advance(s->r, t, end[0], x);
		s->model->at(state, NULL, tau, found);
		good = (p > 0 || memcmp(found, y, (size_t)s->r->states * sizeof *y) == 0) && good;
		for (int i = 0; i < s->r->states; i++) {
			const double expected = mpfr_get_d(x[i], MPFR_RNDN);
			good = close_to(found[i], expected, bound * DBL_EPSILON * scale[i],
					"%s, t = %g, tau = h %d/%d, %s",
				s->model->name, mpq_get_d(t), p,
							POINTS, s->model->state_names[i]) && good;
			if (scale[i] > 0)
				s->worst = worse(s->worst, fabs(found[i] - expected) / (DBL_EPSILON * scale[i]));
			s->points++;
		}
	}
	free_rationals(end, 1);
	free_floats(x, n);
	return good;
}

static void judge_at(const char *name, const char *h)
{
	static const int stops[] = {0, 1, 2, 5, 17, 59, 60, 61, 99, 100, 101, 150, 1000};
	static const double times[] = {0, 1.25, 1.00390625, 100.0625, -3.5};
	struct subject s = {.model = linear_model(name), .r = reference_of(name)};
	mpq_t *t = new_rationals(2);
	rational_parse(t[1], h);
	void *state = calloc(1, s.model->size);
	prepare(&s);
	bool good = s.model->at != NULL && s.r->states == s.model->states && s.model->h == nearest_double(t[1]);
	s.model->init(state);
	for (int i = 0, k = 0; i < (int)(sizeof stops / sizeof *stops) && good; i++) {
		for (; k < stops[i]; k++)
			s.model->step(state, NULL);
		mpq_set_ui(t[0], (unsigned long)k, 1);
		mpq_mul(t[0], t[0], t[1]);
		good = from_state(&s, state, t[0]) && good;
	}
	ok(good, "%s: at, from states of the run, within %g eps", name, bound);
	good = s.model->at != NULL;
	for (int i = 0; i < (int)(sizeof times / sizeof *times) && good; i++)
		for (int j = 0; j <= s.model->states; j++) {
			double y[SIZE] = {0};
			y[j] = j < s.model->states;
			s.model->set(state, times[i], y);
			mpq_set_d(t[0], times[i]);
			good = from_state(&s, state, t[0]) && good;
		}
	ok(good, "%s: at, from unit vectors and from rest, within %g eps", name, bound);
	note("%s: worst error %.3g eps sum_j max|E_ij| |x_j| in %d values", name, s.worst, s.points);
	free(state);
	free_rationals(t, 2);
	reference_free(s.r);
}

/* set to the time `from`, `n` steps: within 1e-13 of the largest value on the way */
static void judge_set(const char *name, const char *h, double from, int n)
{
	struct reference *r = reference_of(name);
	const pl_model *model = linear_model(name);
	double y[SIZE] = {0.3, -0.7}, found[SIZE], most[SIZE] = {0}, worst = 0;
	mpfr_t *x = new_floats(r->size);
	mpq_t *t = new_rationals(4);
	void *state = calloc(1, model->size);
	bool good = true;
	rational_parse(t[1], h);
	mpq_set_d(t[3], from);
	mpq_set(t[0], t[3]);
	reference_start(r, t[0], y, x);
	model->set(state, from, y);
	for (int k = 1; k <= n; k++) {
		mpq_set_ui(t[2], (unsigned long)k, 1);
		mpq_mul(t[2], t[2], t[1]);
		mpq_add(t[2], t[2], t[3]);
		reference_advance(r, t[0], t[2], x);
		mpq_set(t[0], t[2]);
		model->step(state, NULL);
		model->get(state, found);
		for (int i = 0; i < r->states; i++) {
			const double expected = mpfr_get_d(x[i], MPFR_RNDN);
			most[i] = fmax(most[i], fabs(expected));
			good = close_to(found[i], expected, 1e-13 * most[i], "%s set to %g, step %d, %s", name, from, k,
				model->state_names[i]) && good;
			worst = worse(worst, fabs(found[i] - expected) / most[i]);
		}
		good = close_to(model->time(state), nearest_double(t[0]),
			2 * DBL_EPSILON * fmax(fabs(from), fabs(mpq_get_d(t[0]))), "time") && good;
	}
	ok(good, "%s set to %.17g, %d steps, within 1e-13 of the largest value", name, from, n);
	note("%s set to %g: largest difference %.3g", name, from, worst);
	free(state);
	free_floats(x, r->size);
	free_rationals(t, 4);
	reference_free(r);
}

int main(void)
{
	judge_at("maxwell", "1/50");
	judge_at("vector3", "1/50");
	judge_at("resonance", "1/50");
	judge_at("growing", "1/20");
	judge_at("ramps", "1/20");
	judge_at("pulse", "1/100");
	static const double times[] = {0, 0.595, 0.6, 0.59999999999999998 + 1e-9, 0.999, 1, 1.001, 1.003, 1.004,
			1.0074999,
		1.0075, 2, 1000, -0.005, -3.7};
	for (int i = 0; i < (int)(sizeof times / sizeof *times); i++)
		judge_set("pulse", "1/100", times[i], times[i] < -1 ? 600 : 150);
	judge_set("growing", "1/20", -10, 300);
	judge_set("resonance", "1/50", -2, 300);
	judge_set("ramps", "1/20", -7.3, 300);
	return tap_end();
}
