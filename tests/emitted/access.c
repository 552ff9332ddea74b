/* SPDX-License-Identifier: GPL-3.0-or-later */
/* init, set, get and time; saving and restoring by copy; the descriptor and its void* functions. */
#include "equations.h"
#include "models.h"
#include "tap.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

enum { STATES = 16, OUTPUTS = 16 };

static void *need(size_t size)
{
	void *memory = calloc(size, 1);
	if (!memory)
		abort();
	return memory;
}

static bool same(const double *found, const double *expected, int count, double tolerance, const char *what, int k)
{
	bool good = true;
	for (int i = 0; i < count; i++)
		good = close_to(found[i], expected[i], tolerance * fabs(expected[i]), "%s, step %d, entry "
			"%d", what, k, i) &&
			good;
	return good;
}

/* ---- the descriptor ---- */

static bool names_are(const char *const *found, const char *const *expected, int count)
{
	bool good = true;
	for (int i = 0; i < count; i++)
		if (strcmp(found[i], expected[i]) != 0) {
			note("name %d: found %s, expected %s", i, found[i], expected[i]);
			good = false;
		}
	return good;
}

static void descriptor(const pl_model *m, const struct equations *e)
{
	ok(m->states == e->states && m->inputs == 0 && m->outputs == e->outputs, "%s: numbers of states, inputs, "
		"outputs",
		m->name);
	ok(close_to(m->h, nearest_double(e->h), 0, "h"), "%s: h is the double nearest to the spec's step", m->name);
	ok(names_are(m->state_names, e->state_names, e->states)
			&& names_are(m->output_names, e->output_names, e->outputs),
	   "%s: names of states and outputs", m->name);
	ok(m->init && m->set && m->get && m->time && m->step && m->out && m->run && m->at && m->jump,
		"%s: no function is missing", m->name);
}

/* ---- init, get, set ---- */

static void initial(const pl_model *m, const struct equations *e)
{
	void *state = need(m->size);
	double y[STATES], expected[STATES];
	for (int i = 0; i < e->states; i++)
		expected[i] = nearest_double(e->initial[i]);
	memset(state, 0xA5, m->size);       /* init must not lean on what was there */
	m->init(state);
	m->get(state, y);
	ok(same(y, expected, m->states, 0, "init", 0) && m->time(state) == 0,
		"%s: init gives t = 0 and the spec's initial values", m->name);
	free(state);
}

static void get_what_was_set(const pl_model *m)
{
	void *state = need(m->size);
	double y[STATES], set[STATES];
	for (int i = 0; i < m->states; i++)
		set[i] = ldexp(1 + i, -40 * i) / 3;
	m->init(state);
	m->run(state, 3, NULL, NULL);
	m->set(state, 12.34, set);
	m->get(state, y);
	ok(same(y, set, m->states, 0, "get after set", 0) && m->time(state) == 12.34, "%s: get and time give what was "
		"set",
		m->name);
	free(state);
}

/* Set to where another instance stands: both go the same way.  The time that is set is the double nearest to k h, so a
 * load's phase is off by half a unit in its last place; without loads nothing is. */
static void set_and_step(const pl_model *m, const struct equations *e)
{
	enum { BEFORE = 137, AFTER = 400 };
	void *walked = need(m->size), *placed = need(m->size);
	double y[STATES], z[STATES], largest[STATES] = {0}, worst = 0;
	bool good = true;
	memset(placed, 0x5A, m->size);
	m->init(walked);
	m->run(walked, BEFORE, NULL, NULL);
	m->get(walked, y);
	m->set(placed, m->time(walked), y);
	for (int k = 0; k < AFTER; k++) {
		m->step(walked, NULL);
		m->step(placed, NULL);
		m->get(walked, y);
		m->get(placed, z);
		for (int i = 0; i < m->states; i++) {
			largest[i] = fmax(largest[i], fabs(y[i]));
			good = close_to(z[i], y[i], e->load == WAVE ? 1e-14 * largest[i] : 0, "after set, step %d, "
				"%s", k,
				m->state_names[i]) && good;
			worst = worse(worst, fabs(z[i] - y[i]) / fmax(largest[i], 1e-300));
		}
		good = close_to(m->time(placed), m->time(walked), 4e-16 * m->time(walked), "time after set, step "
			"%d", k) &&
			good;
	}
	note("%s: largest difference after set %.3g", m->name, worst);
	ok(good, "%s: set to another instance's time and state, it goes the same way", m->name);
	free(walked);
	free(placed);
}

/* A dyadic time is exact, whatever its size or sign: a load shifted by its whole periods looks the same. */
static void set_far_away(const pl_model *m, const struct equations *e)
{
	if (e->load == WAVE)
		return;
	void *now = need(m->size), *later = need(m->size);
	static const double times[] = {-3.5, 1e6, -1e15};
	double y[STATES], z[STATES], start[STATES] = {0};
	bool good = true;
	start[0] = 1;
	for (int i = 0; i < 3; i++) {
		m->set(now, 0, start);
		m->set(later, times[i], start);
		m->run(now, 50, NULL, NULL);
		m->run(later, 50, NULL, NULL);
		m->get(now, y);
		m->get(later, z);
		good = same(z, y, m->states, 0, "set far away", 50) && good;
	}
	ok(good, "%s: without loads the time set does not matter to the states", m->name);
	free(now);
	free(later);
}

/* ---- time ---- */

static void time_of_steps(const pl_model *m, const struct equations *e)
{
	enum { STEPS = 20000 };
	void *state = need(m->size);
	bool good = true;
	mpq_t t;
	mpq_init(t);
	m->init(state);
	for (int k = 0; k <= STEPS; k++, m->step(state, NULL)) {
		equations_time(e, (unsigned long)k, t);
		good = close_to(m->time(state), nearest_double(t), 0, "time, step %d", k) && good;
	}
	static const unsigned long far[] = {1000003, 123456789, 999999999999};
	for (int i = 0; i < 3; i++) {
		m->init(state);
		m->jump(state, far[i]);
		equations_time(e, far[i], t);
		good = close_to(m->time(state), nearest_double(t), 0, "time after a jump of %lu", far[i]) && good;
	}
	mpq_clear(t);
	ok(good, "%s: time after k steps is the double nearest to k h", m->name);
	free(state);
}

/* ---- saving and restoring ---- */

static void copy(const pl_model *m)
{
	void *state = need(m->size), *saved = need(m->size);
	double y[40][STATES], z[STATES];
	bool good = true;
	m->init(state);
	m->run(state, 77, NULL, NULL);
	memcpy(saved, state, m->size);
	const double time = m->time(state);
	for (int k = 0; k < 40; k++) {
		m->step(state, NULL);
		m->get(state, y[k]);
	}
	memcpy(state, saved, m->size);
	good = close_to(m->time(state), time, 0, "time restored") && good;
	for (int k = 0; k < 40; k++) {
		m->step(state, NULL);
		m->get(state, z);
		good = same(z, y[k], m->states, 0, "restored", k) && good;
	}
	ok(good, "%s: copying saves, copying back restores, to the last bit", m->name);
	free(state);
	free(saved);
}

/* Two instances do not know of each other. */
static void instances(const pl_model *m)
{
	void *alone = need(m->size), *a = need(m->size), *b = need(m->size);
	double y[STATES], z[STATES], start[STATES] = {0};
	bool good = true;
	start[1] = -2;
	m->init(alone);
	m->init(a);
	m->set(b, 5, start);
	for (int k = 0; k < 50; k++) {
		m->step(alone, NULL);
		m->step(a, NULL);
		m->run(b, 3, NULL, NULL);
		m->jump(b, 2);
		m->get(alone, y);
		m->get(a, z);
		good = same(z, y, m->states, 0, "beside another", k) && good;
	}
	ok(good, "%s: an instance is not disturbed by another", m->name);
	free(alone);
	free(a);
	free(b);
}

/* The functions by name and those of the descriptor. */
#define BY_NAME(type)                                                                                           \
	static void by_name_##type(void)                                                                            \
	{                                                                                                           \
		const pl_model *m = &type##_model;                                                                     \
		type own, saved, any;                                                                                  \
		double y[STATES], z[STATES], out[OUTPUTS], any_out[OUTPUTS];                                           \
		double rows[5 * OUTPUTS], any_rows[5 * OUTPUTS];                                                       \
		bool good = m->size == sizeof(type);                                                                   \
		type##_init(&own);                                                                                     \
		m->init(&any);                                                                                         \
		type##_step(&own);                                                                                     \
		m->step(&any, NULL);                                                                                   \
		type##_run(&own, 5, rows);                                                                             \
		m->run(&any, 5, NULL, any_rows);                                                                       \
		good = same(any_rows, rows, 5 * m->outputs, 0, "run", 5) && good;                                      \
		type##_jump(&own, 9);                                                                                  \
		m->jump(&any, 9);                                                                                      \
		type##_get(&own, y);                                                                                   \
		m->get(&any, z);                                                                                       \
		good = same(z, y, m->states, 0, "get", 15) && good;                                                    \
		type##_out(&own, out);                                                                                 \
		m->out(&any, any_out);                                                                                 \
		good = same(any_out, out, m->outputs, 0, "out", 15) && good;                                           \
		type##_at(&own, m->h / 2, y);                                                                          \
		m->at(&any, NULL, m->h / 2, z);                                                                        \
		good = same(z, y, m->states, 0, "at", 15) && good && type##_time(&own) == m->time(&any);               \
		saved = own;                                                                                           \
		type##_set(&own, 3.25, y);                                                                             \
		m->set(&any, 3.25, y);                                                                                 \
		type##_step(&own);                                                                                     \
		m->step(&any, NULL);                                                                                   \
		type##_get(&own, y);                                                                                   \
		m->get(&any, z);                                                                                       \
		good = same(z, y, m->states, 0, "set", 1) && good;                                                     \
		own = saved;                                                                                           \
		type##_out(&own, any_out);                                                                             \
		good = same(any_out, out, m->outputs, 0, "assignment", 15) && good;                                    \
		ok(good, "%s: by name and by descriptor the same; assignment restores", m->name);                      \
	}

EACH_MODEL(BY_NAME)

int main(void)
{
	for (int i = 0; i < MODELS; i++) {
		const pl_model *m = emitted[i].model;
		struct equations *e = equations_of(m->name);
		if (!ok(e != NULL, "%s: its equations are written in equations.c", m->name))
			continue;
		descriptor(m, e);
		initial(m, e);
		get_what_was_set(m);
		set_and_step(m, e);
		set_far_away(m, e);
		time_of_steps(m, e);
		copy(m);
		instances(m);
		equations_free(e);
	}
#define CALL(type) by_name_##type();
	EACH_MODEL(CALL)
	return tap_end();
}
