/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_at, between two steps, against e^{A tau} of the equations written by hand:
 *
 *     |error_i| <= 16 eps sum_j max |E_ij| |x_j|,  max over 0 .. h, x = y and what acts on it, eps = 2^-52
 */
#include "equations.h"
#include "models.h"
#include "quarter_car_coarse_pl.h"
#include "scs_weak_coarse_pl.h"
#include "sdcsf_pl_pl.h"
#include "scs_pl_100_pl.h"
#include "tap.h"
#include "tuned_floor_coarse_pl.h"

#include "../accuracy/evaluator.h"

#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { POINTS = 20, SIZE = 12 };

static const double bound = 16;

struct subject {
	const pl_model *model;
	struct equations *e;
	double tau[POINTS];
	double most[SIZE * SIZE];           /* max |E_ij| over the points */
	double worst;                       /* error over eps sum_j most_ij |x_j| */
	int points, exact;
};

static void *need(size_t size)
{
	void *memory = calloc(size, 1);
	if (!memory)
		abort();
	return memory;
}

/* 0 .. h in 19 equal parts */
static bool prepare(struct subject *s)
{
	const struct equations *e = s->e;
	double E[SIZE * SIZE];
	bool good = true;
	mpq_t tau;
	mpq_init(tau);
	for (int p = 0; p < POINTS; p++) {
		s->tau[p] = p == POINTS - 1 ? s->model->h : s->model->h * p / (POINTS - 1);
		mpq_set_d(tau, s->tau[p]);
		good = evaluator_exponential((size_t)e->size, (const mpq_t *)e->A, tau, E) == 0 && good;
		for (int i = 0; i < e->size * e->size; i++)
			s->most[i] = fmax(s->most[i], fabs(E[i]));
	}
	mpq_clear(tau);
	return good;
}

/* at from the state whose exact vector is x */
static bool state_agrees(struct subject *s, const void *state, const mpq_t *x, const char *which, int k)
{
	const struct equations *e = s->e;
	double expected[SIZE], found[SIZE];
	bool good = true;
	mpq_t tau;
	mpq_init(tau);
	for (int p = 0; p < POINTS; p++) {
		mpq_set_d(tau, s->tau[p]);
		if (evaluator_apply((size_t)e->size, (const mpq_t *)e->A, tau, x, expected) != 0) {
			note("%s: the evaluator gave up", s->model->name);
			good = false;
			break;
		}
		s->model->at(state, NULL, s->tau[p], found);
		for (int i = 0; i < e->states; i++) {
			double scale = 0;
			for (int j = 0; j < e->size; j++)
				scale += s->most[i * e->size + j] * fabs(mpq_get_d(x[j]));
			good = close_to(found[i], expected[i], bound * DBL_EPSILON * scale,
					"%s from %s %d, tau = h %d/%d, %s",
				s->model->name, which, k,
							p, POINTS - 1, s->model->state_names[i]) && good;
			if (scale > 0)
				s->worst = worse(s->worst, fabs(found[i] - expected[i]) / (DBL_EPSILON * scale));
			s->points++;
			s->exact += found[i] == expected[i];
		}
	}
	mpq_clear(tau);
	return good;
}

/* What pl holds, the last entries of x: the other coordinate's terms at the start of the step. */
static void set_held(const struct subject *s, mpq_t *x)
{
	const struct equations *e = s->e;
	mpq_t other, damping;
	mpq_inits(other, damping, NULL);
	for (int i = 0; i < 2; i++) {
		mpq_set_ui(other, 100, 1);
		mpq_mul(other, other, x[1 - i]);
		mpq_set_ui(damping, e->load == WAVE ? 1 : 0, 2);
		mpq_canonicalize(damping);
		mpq_mul(damping, damping, x[3 - i]);
		mpq_add(x[e->size - 2 + i], other, damping);
	}
	mpq_clears(other, damping, NULL);
}

static bool from_state(struct subject *s, const void *state, const mpq_t t, bool held, const char *which, int k)
{
	double y[SIZE];
	mpq_t *x = new_rationals(s->e->size);
	s->model->get(state, y);
	equations_vector(s->e, y, t, x);
	if (held)
		set_held(s, x);
	const bool good = state_agrees(s, state, (const mpq_t *)x, which, k);
	free_rationals(x, s->e->size);
	return good;
}

static bool from_run(struct subject *s, bool held)
{
	static const int stops[] = {0, 1, 2, 5, 17, 60, 150};
	void *state = need(s->model->size);
	bool good = true;
	mpq_t t;
	mpq_init(t);
	s->model->init(state);
	for (int i = 0, k = 0; i < (int)(sizeof stops / sizeof *stops); i++) {
		for (; k < stops[i]; k++)
			s->model->step(state, NULL);
		equations_time(s->e, (unsigned long)k, t);
		good = from_state(s, state, t, held, "step", k) && good;
	}
	mpq_clear(t);
	free(state);
	return good;
}

static bool from_units(struct subject *s, bool held)
{
	static const double times[] = {0, 1.25, 1000.0625};
	void *state = need(s->model->size);
	bool good = true;
	mpq_t t;
	mpq_init(t);
	for (int i = 0; i < (int)(sizeof times / sizeof *times); i++)
		for (int j = 0; j < s->model->states; j++) {
			double y[SIZE] = {0};
			y[j] = 1;
			s->model->set(state, times[i], y);
			mpq_set_d(t, times[i]);
			good = from_state(s, state, t, held, "unit vector", j) && good;
		}
	mpq_clear(t);
	free(state);
	return good;
}

/* at must leave the state alone: its argument is const */
static bool changes_nothing(const struct subject *s)
{
	void *state = need(s->model->size), *before = need(s->model->size);
	double y[SIZE];
	s->model->init(state);
	s->model->step(state, NULL);
	memcpy(before, state, s->model->size);
	s->model->at(state, NULL, s->model->h / 3, y);
	const bool good = memcmp(state, before, s->model->size) == 0;
	free(state);
	free(before);
	return good;
}

static void judge(const pl_model *model, struct equations *e, bool held)
{
	struct subject s = {.model = model, .e = e};
	if (!ok(e && model->at, "%s: there are equations by hand, and an `at`", model->name))
		return;
	ok(prepare(&s), "%s: the evaluator decides", model->name);
	ok(from_run(&s, held), "%s: at, from states of the run, within %g eps", model->name, bound);
	ok(from_units(&s, held), "%s: at, from unit vectors, within %g eps", model->name, bound);
	ok(changes_nothing(&s), "%s: at changes nothing", model->name);
	note("%s: worst error %.3g eps sum_j max|E_ij| |x_j|; %d of %d values correctly rounded", model->name, s.worst,
		s.exact, s.points);
	equations_free(e);
}

static struct equations *with_step(struct equations *e, unsigned long p, unsigned long q)
{
	mpq_set_ui(e->h, p, q);
	mpq_canonicalize(e->h);
	return e;
}

/* Scheme pl over one step: x_i'' = its own terms + held_i, held_i' = 0. */
static struct equations *with_held(struct equations *e)
{
	const int n = e->size, m = n + 2;
	mpq_t *A = new_rationals(m * m);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			if (!(i >= 2 && i < 4 && (j == 3 - i || j == 5 - i)))
				mpq_set(A[i * m + j], e->A[i * n + j]);
	for (int i = 0; i < 2; i++)
		mpq_set_ui(A[(2 + i) * m + n + i], 1, 1);
	free_rationals(e->A, n * n);
	e->A = A;
	e->size = m;
	return e;
}

int main(void)
{
	for (int i = 0; i < MODELS; i++)
		judge(emitted[i].model, equations_of(emitted[i].model->name), false);
	judge(&scs_weak_coarse_model, with_step(equations_of("scs_weak"), 3, 25), false);
	judge(&quarter_car_coarse_model, with_step(equations_of("quarter_car"), 1, 10), false);
	judge(&tuned_floor_coarse_model, with_step(equations_of("tuned_floor"), 1, 2), false);
	judge(&scs_pl_100_model, with_held(equations_of("scs")), true);
	judge(&sdcsf_pl_model, with_held(equations_of("sdcsf")), true);
	return tap_end();
}
