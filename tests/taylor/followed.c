/* SPDX-License-Identifier: MIT-0 */
#include "followed.h"
#include "quadrant.h"
#include "systems.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- equations ---- */

void timed(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = -4 * y[0] - (t < 1.2345678L ? 8 : 2) * y[0] * y[0] * y[0];
}

void changing(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = (t < 0.37L ? 2 * cos_of(3 * t) : t < 0.81L ? t * t : expl(-t)) - 0.1L * y[1] -
		(t < 0.55L ? 1 : 2) * sin_of(y[0]) - 0.5L * y[0] * y[0] * y[0] - 0.6L * fabsl(t - 0.62L) * y[0] * y[0] -
		fminl(t, 0.9L) * y[0] * y[1];
}

void masses(real t, const real *y, const real *u, real *dydt)
{
	const real force = 3 * sin_of(y[1] - y[0] - 1.5L), drag = 0.1L * (y[3] - y[2]);
	(void)u;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = (drag + force) / 2;
	dydt[3] = 0.2L * cos_of(2 * t) - drag - force;
}

equations *field(const struct subject *s)
{
	return s->f ? s->f : system_of(s->name)->equations;
}

void solve(const struct subject *s, const pl_model *m, real from, real to, const real *u, real *y)
{
	const real piece = s->piece > 0 ? s->piece : 0.05L;
	for (int i = 0; i < s->changes; i++)
		if (from < s->change[i] && s->change[i] <= to) {
			gragg(field(s), m->states, from, s->change[i] - 1e-17L, piece, 0, NULL, y);
			from = s->change[i];
		}
	gragg(field(s), m->states, from, to, piece, m->inputs, u, y);
}

/* ---- steps ---- */

void look(double *worst, const pl_model *m, const double *found, const real *expected, const double *most)
{
	for (int i = 0; i < m->states; i++)
		if (!(most[i] > 0 && (double)fabsl(found[i] - expected[i]) / most[i] <= *worst))
			*worst = most[i] > 0 ? (double)fabsl(found[i] - expected[i]) / most[i] : *worst;
}

static void sample_step(const pl_model *m, real h, double *before, double *sample, real *u)
{
	for (int i = 0; i < m->inputs; i++) {
		sample[i] = random_number();
		u[i] = m->hold ? before[i] : sample[i];
		u[m->inputs + i] = m->hold ? (sample[i] - (real)before[i]) / h : 0;
		before[i] = sample[i];
	}
}

struct found follow(const struct subject *s, const pl_model *m)
{
	struct found worst = {0, 0, 0};
	double y[MOST], middle[MOST], end[MOST], most[MOST] = {0}, sample[MOST], before[MOST] = {0};
	const real h = 1 / roundl(1 / (real)m->h);
	real truth[MOST], half[MOST], u[MOST];
	void *state = fresh(m);
	m->get(state, y);
	for (int i = 0; i < m->states; i++) {
		truth[i] = y[i];
		most[i] = fabs(y[i]);
	}
	for (int k = 0; k < (s->steps ? s->steps : STEPS); k++) {
		sample_step(m, h, before, sample, u);
		m->at(state, sample, m->h / 2, middle);
		m->at(state, sample, m->h, end);
		m->step(state, sample);
		m->get(state, y);
		solve(s, m, k * h, (k + 0.5L) * h, u, truth);
		memcpy(half, truth, sizeof half);
		for (int i = 0; i < m->inputs; i++)
			u[i] += h / 2 * u[m->inputs + i];
		solve(s, m, (k + 0.5L) * h, (k + 1) * h, u, truth);
		for (int i = 0; i < m->states; i++)
			most[i] = fmax(most[i], fabs((double)truth[i]));
		look(&worst.middle, m, middle, half, most);
		look(&worst.step, m, y, truth, most);
		for (int i = 0; i < m->states; i++)
			half[i] = y[i];
		look(&worst.end, m, end, half, most);
	}
	if (m->status(state) != 0)
		worst.step = INFINITY;
	free(state);
	return worst;
}
