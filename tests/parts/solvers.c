/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The models of parts against CVODE at rtol 1e-11, on their equations written here: within 1e-8 of each state's largest
 * value so far. The solver restarts where a formula changes and at each sample of a record. */
#include "../cvode.h"
#include "../emitted/tap.h"

#include "plrt.h"

#include <math.h>
#include <stdlib.h>

enum { MOST_STATES = 40, RESTARTS = 3 };

static const double tolerance = 1e-8, relative = 1e-11, pi = 3.14159265358979323846;

extern const pl_model half_car_model, drivetrain_model, street_model;

static double sample, ramp, since;              /* a record at its last sample: value and slope; when that was */
static int piece;                               /* how many changes of formula are behind */

/* Heave and pitch of the body, wheels; front and rear axles 1.1 and 1.5 m from the centre, 10 m/s, bump of 0.6 m */
static void half_car(double t, const double *y, double *dydt)
{
	const double length = 0.6, v = 10, top[2] = {y[0] - 1.1 * y[1], y[0] + 1.5 * y[1]};
	const double top_speed[2] = {y[4] - 1.1 * y[5], y[4] + 1.5 * y[5]}, stiffness[2] = {18000, 20000};
	double force[2];
	for (int i = 0; i < 2; i++) {
		const bool over = piece == 2 * i;
		const double late = i ? 2.6 / v : 0;
		const double road = over ? 0.05 * sin(pi * v * (t - late) / length) : 0;
		force[i] = stiffness[i] * (top[i] - y[2 + i]) + 1200 * (top_speed[i] - y[6 + i]);
		dydt[2 + i] = y[6 + i];
		dydt[6 + i] = (force[i] + 180000 * (road - y[2 + i])) / 40;
	}
	dydt[0] = y[4];
	dydt[1] = y[5];
	dydt[4] = -(force[0] + force[1]) / 600;
	dydt[5] = (1.1 * force[0] - 1.5 * force[1]) / 900;
}

static void drivetrain(double t, const double *y, double *dydt)
{
	static const double J[6] = {0.18, 0.12, 0.02, 0.01, 0.04, 6}, bearing[6] = {0.05, 0, 0.03, 0.01, 0.04, 0.6};
	static const double k[5] = {60000, 1500, 18000, 9000, 2500}, d[5] = {0, 3, 0, 0, 1};
	const double *speed = y + 6;
	double torque[6];
	for (int i = 0; i < 6; i++)
		torque[i] = -bearing[i] * speed[i];
	torque[0] += 120 + 150 * sin(2 * 2 * pi * 1500 / 60 * t);
	for (int i = 0; i < 5; i++) {
		const double shaft = k[i] * (y[i] - y[i + 1]) + d[i] * (speed[i] - speed[i + 1]);
		torque[i] -= shaft;
		torque[i + 1] += shaft;
	}
	for (int i = 0; i < 6; i++) {
		dydt[i] = speed[i];
		dydt[6 + i] = torque[i] / J[i];
	}
}

static void street(double t, const double *y, double *dydt)
{
	static const double stiffness[10] = {14e6, 14e6, 12e6, 11e6, 9e6, 8e6, 6e6, 6e6, 5e6, 3e6};
	static const double mass[10] = {20e3, 20e3, 20e3, 24e3, 20e3, 15e3, 20e3, 20e3, 20e3, 25e3};
	const double quake = sample + ramp * (t - since), wall = 5e5 * (y[6] - y[8]);
	for (int i = 0; i < 10; i++) {
		const double *x = y + 2 * i, *v = y + 20 + 2 * i, a = i == 8 ? 0.6 : 0.3;
		const double shear = stiffness[i] * (x[0] + 1e-3 * v[0]);
		const double above = stiffness[i] * (x[1] - x[0] + 1e-3 * (v[1] - v[0]));
		const double pull = i == 3 ? -wall : i == 4 ? wall : 0;
		for (int k = 0; k < 2; k++)
			dydt[2 * i + k] = v[k];
		dydt[20 + 2 * i] = (above - shear + pull) / mass[i] - quake - a * v[0];
		dydt[21 + 2 * i] = -above / mass[i] - quake - a * v[1];
	}
}

struct subject {
	const pl_model *model;
	void (*rhs)(double t, const double *y, double *dydt);
	double seconds;
	double change[RESTARTS];                    /* of formula; 0: none */
};

static int slope(realtype t, N_Vector y, N_Vector dydt, void *from)
{
	const struct subject *s = from;
	s->rhs(t, N_VGetArrayPointer(y), N_VGetArrayPointer(dydt));
	return 0;
}

/* From one time to the next, which is a change of formula at most at its end */
static bool advance(struct cvode *c, double from, double to, bool restart)
{
	return !(restart && CVodeReInit(c->memory, from, c->y) != CV_SUCCESS) && cvode_until(c, to);
}

static bool follow(const struct subject *s, struct cvode *c, void *state)
{
	const pl_model *m = s->model;
	const int steps = (int)lround(s->seconds / m->h);
	double most[MOST_STATES] = {0}, now[MOST_STATES], worst = 0;
	unsigned seed = 1;
	bool good = true;
	piece = 0;
	sample = ramp = since = 0;
	for (int k = 0; k < steps && good; k++) {
		double next = 0;
		bool changed = m->inputs || k == 0;
		if (m->inputs) {
			seed = seed * 1103515245u + 12345u;
			next = (double)(seed >> 16) / 32768 - 1;
			since = k * m->h;
			ramp = (next - sample) / m->h;
		}
		for (int i = 0; i < RESTARTS; i++)
			if (s->change[i] > 0 && lround(s->change[i] / m->h) == k) {
				piece++;
				changed = true;
			}
		m->step(state, m->inputs ? &next : NULL);
		m->get(state, now);
		good = advance(c, k * m->h, (k + 1) * m->h, changed);
		for (int i = 0; i < m->states && good; i++) {
			const double error = fabs(N_VGetArrayPointer(c->y)[i] - now[i]);
			most[i] = fmax(most[i], fabs(now[i]));
			good = close_to(NV_Ith_S(c->y, i), now[i], tolerance * most[i] + 1e-15, "%s, step %d, %s",
					m->name,
				k, m->state_names[i]);
			if (most[i] > 1e-6 && !(error <= worst * most[i]))
				worst = error / most[i];
		}
		sample = next;
	}
	note("%s: largest difference to CVODE %.3g", m->name, worst);
	return good;
}

static void judge(const struct subject *s)
{
	const pl_model *m = s->model;
	void *state = calloc(1, m->size);
	double y[MOST_STATES];
	struct cvode c;
	m->init(state);
	m->get(state, y);
	const bool good = cvode_open(&c, CV_ADAMS, m->states, y, slope, (void *)s, relative, 1e-14, NULL) &&
		follow(s, &c, state);
	ok(good, "%s: CVODE on its equations agrees within %g over %g s", m->name, tolerance, s->seconds);
	cvode_close(&c);
	free(state);
}

int main(void)
{
	judge(&(struct subject){.model = &half_car_model, .rhs = half_car, .seconds = 3, .change = {0.06, 0.26, 0.32}});
	judge(&(struct subject){.model = &drivetrain_model, .rhs = drivetrain, .seconds = 1});
	judge(&(struct subject){.model = &street_model, .rhs = street, .seconds = 20});
	return tap_end();
}
