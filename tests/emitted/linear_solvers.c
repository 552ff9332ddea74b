/* SPDX-License-Identifier: GPL-3.0-or-later */
/* NAME_rhs of every linear model, by CVODE at rtol 1e-10, against the steps: within 1e-7 of the largest value so far,
 * over 30 s. The solver restarts where the loads change their formula, and where inputs get a new sample. */
#include "../cvode.h"
#include "linear.h"
#include "tap.h"

#include "first2_pl.h"
#include "held2_pl.h"
#include "ramped2_pl.h"
#include "switched_pl.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { SECONDS = 30, MOST_STATES = 32 };

static const double tolerance = 1e-7, relative = 1e-10;

struct subject {
	const pl_model *model;
	void (*rhs)(double t, const double *y, double *dydt);
	void (*rhs_sampled)(double t, const double *y, const double *u, double *dydt);
	bool ramp[2];
	double u[4], start[2], t0;              /* inputs at the time t0, then their slopes */
	const double *change;
	int changes;
	struct cvode cvode;
	double limit;                           /* of the formula: at this time the next one holds */
};

static int slope(realtype t, N_Vector y, N_Vector dydt, void *from)
{
	const struct subject *s = from;
	if (t >= s->limit)
		t = nextafter(s->limit, -1);
	if (s->rhs) {
		s->rhs(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dydt));
	} else {
		double u[4];
		for (int i = 0; i < 2; i++) {
			u[2 + i] = s->u[2 + i];
			u[i] = s->u[i] + s->u[2 + i] * (t - s->t0);
		}
		s->rhs_sampled(t, N_VGetArrayPointer(y), u, N_VGetArrayPointer(dydt));
	}
	return 0;
}

/* From one time to another, stopping at the changes between; past a change the solver starts anew just behind it. */
static bool advance(struct subject *s, double from, double to)
{
	bool good = true;
	while (from < to && good) {
		double goal = to;
		for (int i = s->changes - 1; i >= 0; i--)
			if (s->change[i] > from && s->change[i] < goal)
				goal = s->change[i];
		s->limit = goal;
		bool at_change = !s->rhs;
		for (int i = 0; i < s->changes; i++)
			at_change = at_change || s->change[i] == from;
		if (at_change)
			good = CVodeReInit(s->cvode.memory, from, s->cvode.y) == CV_SUCCESS;
		good = good && cvode_until(&s->cvode, goal);
		from = goal;
	}
	return good;
}

static void judge(struct subject *s)
{
	const pl_model *m = s->model;
	const int every = (int)lround(0.5 / m->h), rows = 2 * SECONDS;
	double y[MOST_STATES], most[MOST_STATES] = {0}, worst = 0;
	double scale = 0;
	void *state = calloc(1, m->size);
	m->init(state);
	m->get(state, y);
	for (int i = 0; i < m->states; i++)
		scale = fmax(scale, fabs(y[i]));
	bool good = cvode_open(&s->cvode, CV_ADAMS, m->states, y, slope, s, relative,
		relative * 1e-2 * (scale > 0 ? scale : 1), NULL);
	unsigned seed = 1;
	for (int row = 0; row < rows && good; row++) {
		/* a ramp over the whole stretch: each step's sample lies on it */
		double target[2];
		s->t0 = row * every * m->h;
		for (int i = 0; i < 2; i++) {
			seed = seed * 1103515245u + 12345u;
			target[i] = (double)(seed >> 16) / 32768 - 1;
			s->start[i] = s->ramp[i] ? s->start[i] : target[i];
			s->u[i] = s->start[i];
			s->u[2 + i] = s->ramp[i] ? (target[i] - s->start[i]) / (every * m->h) : 0;
		}
		for (int k = 1; k <= every; k++) {
			double u[2];
			for (int i = 0; i < 2; i++)
				u[i] = s->start[i] + (target[i] - s->start[i]) * k / every;
			m->step(state, m->inputs ? u : NULL);
			m->get(state, y);
			for (int i = 0; i < m->states; i++)
				most[i] = fmax(most[i], fabs(y[i]));
		}
		memcpy(s->start, target, sizeof target);
		good = advance(s, s->t0, (row + 1) * every * m->h);
		for (int i = 0; i < m->states; i++) {
			good = close_to(NV_Ith_S(s->cvode.y, i), y[i], tolerance * most[i], "%s, row %d, %s", m->name,
					row,
				m->state_names[i]) && good;
			if (most[i] > 0)
				worst = worse(worst, fabs(N_VGetArrayPointer(s->cvode.y)[i] - y[i]) / most[i]);
		}
	}
	ok(good, "%s: CVODE at rtol 1e-10 agrees within %g over %d s", m->name, tolerance, SECONDS);
	note("%s: largest difference to CVODE %.3g", m->name, worst);
	cvode_close(&s->cvode);
	free(state);
}

int main(void)
{
	static const double pulse_changes[] = {0.6, 1, 1.003, 1.005, 1.0075};
	static double points_changes[50];
	for (int i = 0, seed = 7; i < 50; i++) {        /* as the spec was made */
		seed = (seed * 131 + 17) % 1009;
		points_changes[i] = (37 * i + seed % 7) / 100.0;
	}
	for (int i = 0; i < LINEARS; i++) {
		if (strcmp(linear[i].model->name, "reduced_small") == 0)
			continue;                   /* its right-hand side is that of the whole model */
		struct subject s = {.model = linear[i].model, .rhs = linear[i].rhs};
		if (strcmp(s.model->name, "pulse") == 0) {
			s.change = pulse_changes;
			s.changes = 5;
		} else if (strcmp(s.model->name, "points") == 0) {
			s.change = points_changes;
			s.changes = 50;
		}
		s.limit = SECONDS;
		judge(&s);
	}
	judge(&(struct subject){.model = &held2_model, .rhs_sampled = held2_rhs});
	judge(&(struct subject){.model = &ramped2_model, .rhs_sampled = ramped2_rhs, .ramp = {true, false}});
	judge(&(struct subject){.model = &first2_model, .rhs_sampled = first2_rhs, .ramp = {true, true}});
	static const double switched_changes[] = {0.305, 1.111, 1.117};
	judge(&(struct subject){.model = &switched_model, .rhs_sampled = switched_rhs, .ramp = {true, false},
		.change = switched_changes, .changes = 3});
	return tap_end();
}
