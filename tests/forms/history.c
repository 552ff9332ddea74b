/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * history MODEL STEPS.csv PARTS.csv: a model in each of its forms, over 1000 steps, against its closed form; and what
 * the functions of one model owe each other. STEPS.csv has the states at every step, PARTS.csv at every quarter of the
 * first 100.
 *
 * Tolerances.  u is half a unit in the last place of 1, W_i the largest |y_i| of the closed form, n the states, a the
 * largest |pole| h. A step of the form direct rounds n products and their sum, each within u of what a state is made
 * of: (n + 4) u W a step.  The others round the sum with the old state, u W, and increments that are a W in size: (1 +
 * (n + 4) a) u W. Compensated, what the sum loses is kept: (n + 4) a u W. Errors of steps add up, at worst, and one of
 * u W is there at the start.
 */
#include VARIANTS_H
#include "tap.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 1000, PARTS = 4, PARTED = 100, LARGEST = 20, ROOM = 1024 };

static const char *const forms[] = { "direct", "delta", "compensated", "kick", "kick_compensated" };
enum { FORMS = sizeof forms / sizeof *forms };

union object {                          /* one of any model */
	double align;
	uint64_t count;
	unsigned char byte[ROOM];
};

static const char *name;                /* of the model */
static const real_model *m;
static double steps[STEPS + 1][LARGEST], parts[PARTED * PARTS + 1][LARGEST], widest[LARGEST], angle;
static bool compensated, direct, momenta, carried;

/* ---- the closed form ---- */

static void read_rows(const char *path, int rows, double (*row)[LARGEST])
{
	char line[4096];
	FILE *f = fopen(path, "r");
	if (!f || !fgets(line, sizeof line, f)) {
		printf("Bail out! cannot read %s\n", path);
		exit(99);
	}
	for (int k = 0; k < rows; k++) {
		char *at = fgets(line, sizeof line, f);
		if (!at) {
			printf("Bail out! %s ends at row %d\n", path, k);
			exit(99);
		}
		strtod(at, &at);                /* t */
		for (int i = 0; i < LARGEST && *at == ','; i++)
			row[k][i] = strtod(at + 1, &at);
	}
	fclose(f);
}

/* ---- inputs: what the lines #closed of the specs say ---- */

static const real *sample(int k)        /* of step k */
{
	static real u[1];
	const double h = 0.01;
	if (strstr(name, "_held"))
		u[0] = k < 500 ? (real)1.5 : (real)-0.75;
	else
		u[0] = (real)(k + 1 < 500 ? 0.3 * (k + 1) * h : 2.5 - 0.2 * (k + 1) * h);
	return u;
}

static double tolerance(int state, double k)
{
	const double one = direct ? m->states + 4 : (compensated ? 0 : 1) + (m->states + 4) * angle;
	return EPSILON / 2 * widest[state] * (3 + k * one + m->inputs * k * angle);
}

/* ---- what is compared ---- */

static bool same_state(const union object *a, const union object *b)
{
	real y[2][LARGEST];
	m->get(a, y[0]);
	m->get(b, y[1]);
	return memcmp(y[0], y[1], (size_t)m->states * sizeof(real)) == 0;
}

static bool close_states(const real *y, const double *expected, double k, const char *what)
{
	bool good = true;
	for (int i = 0; i < m->states; i++)
		good = close_to((double)y[i], expected[i], tolerance(i, k), "%s, %s, step %g", what, m->state_names[i],
				k) &&
			good;
	return good;
}

static void try_history(void)
{
	union object s;
	real y[LARGEST];
	bool good = true;
	double worst = 0;
	m->init(&s);
	for (int k = 0; k <= STEPS; k++) {
		m->get(&s, y);
		good = close_states(y, steps[k], k, "history") && good;
		for (int i = 0; i < m->states; i++)
			worst = worse(worst, fabs((double)y[i] - steps[k][i]) / tolerance(i, k));
		if (k < STEPS)
			m->step(&s, sample(k));
	}
	ok(good, "%s: %d steps against the closed form, %.2f of the tolerance", m->name, STEPS, worst);
}

static void try_at(void)
{
	union object s;
	real y[LARGEST];
	bool good = true;
	if (!m->at) {
		ok(angle > 8, "%s: no `at`, since |p| h is above 8", m->name);
		return;
	}
	m->init(&s);
	for (int k = 0; k < PARTED; k++) {
		for (int p = 0; p <= PARTS; p++) {
			m->at(&s, sample(k), m->h * (real)p / PARTS, y);
			/* one more rounding of all that a series adds up */
			good = close_states(y, parts[k * PARTS + p],
				k + 1 + m->states * (1 + angle) / (direct ? m->states : 1 + angle), "at") && good;
		}
		m->step(&s, sample(k));
	}
	ok(good, "%s: at, against the closed form", m->name);
}

/* Within 2 units in the last place per step of what step gives, of the largest value: a row is a sum of products of the
 * state's size, whatever they leave at first */
static void try_run(void)
{
	enum { RUN = 300 };
	union object s, r;
	real u[RUN], all[RUN * LARGEST], out[LARGEST];
	double largest[LARGEST] = {0};
	bool good = true;
	m->init(&s);
	m->init(&r);
	for (int k = 0; k < RUN; k++)
		u[k] = *sample(k);
	m->run(&r, RUN, u, all);
	for (int k = 0; k < RUN * m->outputs; k++)
		largest[k % m->outputs] = fmax(largest[k % m->outputs], fabs((double)all[k]));
	for (int k = 0; k < RUN; k++) {
		m->step(&s, sample(k));
		m->out(&s, out);
		for (int i = 0; i < m->outputs; i++)
			good = close_to((double)all[k * m->outputs + i], (double)out[i],
					2 * EPSILON * (k + 1) * largest[i],
				"run, %s, step %d", m->output_names[i], k + 1) && good;
	}
	ok(good && m->time(&s) == m->time(&r), "%s: run against step", m->name);
	for (int k = 0; k < 7; k++)
		m->step(&s, sample(RUN + k));
	for (int k = 0; k < 7; k++)
		u[k] = *sample(RUN + k);
	m->run(&r, 7, u, NULL);
	real y[2][LARGEST];
	m->get(&s, y[0]);
	m->get(&r, y[1]);
	good = true;
	for (int i = 0; i < m->states; i++)
		good = close_to((double)y[1][i], (double)y[0][i], 2 * EPSILON * (RUN + 7) * widest[i],
				"run without rows, %s",
			m->state_names[i]) && good;
	ok(good, "%s: run without rows goes on from there", m->name);
}

static void try_jump(void)
{
	static const int leaps[] = { 0, 1, 2, 3, 64, 500, 998 };
	if (!m->jump) {
		ok(m->inputs > 0, "%s: no jump, since there are inputs", m->name);
		return;
	}
	bool good = true;
	for (size_t l = 0; l < sizeof leaps / sizeof *leaps; l++) {
		union object s, stepped;
		real y[LARGEST], z[LARGEST];
		m->init(&s);
		m->init(&stepped);
		m->step(&s, NULL);
		m->step(&stepped, NULL);
		m->jump(&s, (uint64_t)leaps[l]);
		for (int k = 0; k < leaps[l]; k++)
			m->step(&stepped, NULL);
		m->get(&s, y);
		m->get(&stepped, z);
		/* the jump itself is right to one rounding; steps are within the history's tolerance */
		good = close_states(y, steps[1 + leaps[l]], 3, "jump") && good;
		for (int i = 0; i < m->states; i++)
			good = close_to((double)y[i], (double)z[i], tolerance(i, 3) + tolerance(i, leaps[l] + 1),
				"jump against %d steps, %s", leaps[l], m->state_names[i]) && good;
		good = good && m->time(&s) == m->time(&stepped);
		m->step(&s, NULL);              /* and on from there */
		m->get(&s, y);
		good = close_states(y, steps[2 + leaps[l]], 5, "a step after the jump") && good;
	}
	ok(good, "%s: jump", m->name);
}

/* Without loads what rounding took of the first state goes on beside it: many jumps of a step are one over as many. */
static void try_short_jumps(void)
{
	union object s, once;
	bool good = true;
	m->init(&s);
	m->step(&s, NULL);
	for (int k = 1; k < STEPS; k++) {
		real y[LARGEST], z[LARGEST];
		m->init(&once);
		m->step(&once, NULL);
		m->jump(&s, 1);
		m->jump(&once, (uint64_t)k);
		m->get(&s, y);
		m->get(&once, z);
		good = close_to((double)y[0], (double)z[0], 2 * EPSILON * fabs((double)z[0]), "%d jumps of a step",
				k) && good;
	}
	ok(good, "%s: jumps of a step, as one over all", m->name);
}

/* ---- get, set, copies ---- */

static uint64_t seed = 1;

static real some_number(void)
{
	seed = seed * UINT64_C(6364136223846793005) + UINT64_C(1442695040888963407);
	const double sign = seed >> 63 ? -1 : 1, fraction = 1 + (double)(seed >> 20 & 0xfffffffff) / 0x1p36;
	return (real)(sign * ldexp(fraction, (int)(seed >> 56 & 63) - 32));
}

static real unit_of(real x)             /* in the last place */
{
#ifdef REAL_FLOAT
	return nextafterf(ABSOLUTE(x), INFINITY) - ABSOLUTE(x);
#else
	return nextafter(ABSOLUTE(x), INFINITY) - ABSOLUTE(x);
#endif
}

static void try_get_after_set(void)
{
	bool good = true;
	int other = 0;
	for (int trial = 0; trial < 2000; trial++) {
		union object s;
		real y[LARGEST], z[LARGEST];
		for (int i = 0; i < m->states; i++)
			y[i] = trial % 10 == 0 ? (real)((int)(some_number() * 1) % 100) : some_number();
		m->init(&s);
		m->set(&s, (real)0.25, y);
		m->get(&s, z);
		for (int i = 0; i < m->states; i++) {
			const bool velocity = i >= m->states / 2;
			other += memcmp(&y[i], &z[i], sizeof(real)) != 0;
			if (momenta && velocity)
				good = close_to((double)z[i], (double)y[i], (double)unit_of(y[i]), "get after set, %s",
					m->state_names[i]) && good;
			else
				good = close_to((double)z[i], (double)y[i], memcmp(&y[i], &z[i], sizeof(real)) ? -1 : 0,
					"get after set, %s", m->state_names[i]) && good;
		}
	}
	ok(good, "%s: get after set gives the same%s (%d of %d others)", m->name,
		momenta ? " within 1 unit in the last place" : "", other, 2000 * m->states);
}

/* A copy is the whole state. */
static void try_copy(void)
{
	union object s, copy;
	bool good = true;
	memset(&s, 0xa5, sizeof s);
	m->init(&s);
	for (int k = 0; k < 333; k++)
		m->step(&s, sample(k));
	memset(&copy, 0x5a, sizeof copy);
	memcpy(&copy, &s, m->size);
	for (int k = 333; k < 700; k++) {
		m->step(&s, sample(k));
		m->step(&copy, sample(k));
		good = good && same_state(&s, &copy) && m->time(&s) == m->time(&copy);
	}
	ok(good && m->size <= sizeof s, "%s: a copy goes on with the same bits", m->name);
}

/* After set, whatever was before, everything goes on as in a new object. */
static void try_set_clears(void)
{
	union object used, fresh;
	real y[LARGEST], next[2][LARGEST];
	bool good = true, memory = false;
	memset(&used, 0xa5, sizeof used);
	memset(&fresh, 0x5a, sizeof fresh);
	m->init(&used);
	for (int k = 0; k < 333; k++)
		m->step(&used, sample(k));
	m->get(&used, y);
	union object as_it_was = used;
	const bool rests = m->inputs == 0;  /* an input's last sample is kept by set */
	m->set(&used, (real)0, y);
	m->init(&fresh);
	m->set(&fresh, (real)0, y);
	good = good && same_state(&used, &fresh) && m->time(&used) == m->time(&fresh);
	for (int k = 0; k < 300 && rests; k++) {
		m->step(&used, NULL);
		m->step(&fresh, NULL);
		m->step(&as_it_was, NULL);
		m->get(&used, next[0]);
		m->get(&as_it_was, next[1]);
		good = good && same_state(&used, &fresh);
		memory = memory || memcmp(next[0], next[1], (size_t)m->states * sizeof(real)) != 0;
	}
	ok(good, "%s: set clears what was", m->name);
	if (compensated && rests)
		ok(memory, "%s: there was something to clear", m->name);
}

int main(int argc, char **argv)
{
	bool any = false;
	if (argc != 5)
		return 99;
	name = argv[1];
	angle = strtod(argv[2], NULL);
	read_rows(argv[3], STEPS + 1, steps);
	read_rows(argv[4], PARTED * PARTS + 1, parts);
	for (int k = 0; k <= STEPS; k++)
		for (int i = 0; i < LARGEST; i++)
			widest[i] = fmax(widest[i], fabs(steps[k][i]));
	for (int f = 0; f < FORMS; f++) {
		const struct variant *v = variant_of(VARIANTS, name, forms[f]);
		if (!v)
			continue;
		any = true;
		m = v->model;
		direct = f == 0;
		compensated = strstr(forms[f], "compensated") != NULL;
		carried = f < 3 && (strcmp(name, "carried") == 0 || strcmp(name, "integrated") == 0 ||
			(compensated && strcmp(name, "masses") == 0));
		/* or a sum of velocities */
		momenta = !direct && (strcmp(name, "loose") == 0 ||
				(strstr(forms[f], "kick") && strcmp(name, "masses") == 0));
		try_history();
		try_at();
		try_run();
		try_jump();
		if (carried)
			try_short_jumps();
		try_get_after_set();
		try_copy();
		try_set_clears();
	}
	ok(any, "%s: there are forms of it in " TYPE, name);
	return tap_end();
}
