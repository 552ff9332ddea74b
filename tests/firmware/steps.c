/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps every variant from its initial values and prints its bits on the way: states, time, outputs.  Then between two
 * steps, after a jump, and what its selftest says, as far as it has these.  What has tunable params is retuned on the
 * way, and its coefficients printed. Compiled once for double and once, with REAL_FLOAT, for float; steps_main.c
 * calls both. */
#include "variant.h"

#include "port.h"

#include <string.h>

static void put_reals(const real *x, int n)
{
	int i;
	for (i = 0; i < n; i++) {
		real_bits bits;
		memcpy(&bits, &x[i], sizeof bits);
		put(" ");
		put_bits(bits, 2 * (int)sizeof bits);
	}
}

static void put_state(const real_model *m, const void *s, uint32_t k)
{
	real x[16];
	put(m->name);
	put(" ");
	put_count(k);
	m->get(s, x);
	put_reals(x, m->states);
	x[0] = m->time(s);
	put_reals(x, 1);
	m->out(s, x);
	put_reals(x, m->outputs);
	if (m->status) {
		put(" status ");
		put_count((uint32_t)m->status(s));
	}
	put("\n");
}

static void put_line(const real_model *m, const char *what, const real *x, int n)
{
	put(m->name);
	put(what);
	put_reals(x, n);
	put("\n");
}

/* Samples for models with inputs: steps of 1/16, up to 1/8 */
static const real *sample(uint32_t k)
{
	static real u[4];
	u[0] = (real)(k / 50 * 37 % 3) / 16;
	u[1] = u[2] = u[3] = u[0];
	return u;
}

/* Factors on params and step.  Of retuned (m2, k2, c1) the first put two real poles 9e-8/s apart, of 12/s (7e-3/s in
 * float); the second make its largest |pole| h 5, so that A h is taken in two words; the third do both; the fourth
 * make |pole| h 70. */
enum { PARAMS = 3, TUNINGS = 5 };
static const struct {
	real param[PARAMS], h;
} tunings[TUNINGS] = {
	{{(real)1, (real)1, (real)51.8930225932327}, (real)1},
	{{(real)1.5, (real)0.75, (real)0.5}, (real)30},
	{{(real)0.5, (real)0.3, (real)44.0266941691418}, (real)25},
	{{(real)1.25, (real)1.25, (real)2}, (real)400},
	{{(real)0.875, (real)1.125, (real)1.5}, (real)1.25},
};

static uint64_t coeffs[64];

static void retune(const struct variant *v, void *state, int number)
{
	const real_model *const m = v->model;
	const char name[2] = {(char)('0' + number), '\0'};
	real params[PARAMS];
	int i;
	for (i = 0; i < PARAMS; i++)
		params[i] = m->param_values[i] * tunings[number].param[i];
	if (v->tuning->retune(coeffs, params, m->h * tunings[number].h) != 0)
		stop(4);
	put(m->name);
	put(" retune");
	put(name);
	put_reals((const real *)(const void *)coeffs, v->tuning->reals);
	put("\n");
	v->tuning->use(state, coeffs);
}

/* What is refused: no step, no mass, a mass that is infinite, a step of infinitely many. No refusal may change the
 * coefficients. */
static void refuse(const struct variant *v)
{
	const real_model *const m = v->model;
	uint64_t before[sizeof coeffs / 8];
	real params[PARAMS], infinite = 1;
	int i, status;
	for (i = 0; i < 12; i++)
		infinite *= (real)1e30;
	memcpy(before, coeffs, sizeof before);
	put(m->name);
	put(" refused");
	for (i = 0; i < 4; i++) {
		memcpy(params, m->param_values, sizeof params);
		params[0] = i == 1 ? 0 : i == 2 ? infinite : params[0];
		status = v->tuning->retune(coeffs, params, i == 0 ? 0 : i == 3 ? infinite : m->h);
		put(" ");
		put_count((uint32_t)status);
		if (status == 0)
			stop(4);
	}
	put("\n");
	for (i = 0; i < (int)(sizeof coeffs / 8); i++)
		if (before[i] != coeffs[i])
			stop(4);
}

/* strstr, which on a small board would take too much room */
static int has_text(const char *name, const char *text)
{
	for (; *name; name++) {
		int i = 0;
		while (text[i] && text[i] == name[i])
			i++;
		if (!text[i])
			return 1;
	}
	return 0;
}

void OF_REAL(steps)(uint32_t last)
{
	static uint64_t state[256];
	const struct variant *v;
	for (v = OF_REAL(variants); v->model; v++) {
		const real_model *const m = v->model;
		uint32_t k = 0, next = 1;
		real x[16];
		int number = 0;
		if (!has_text(m->name, wanted))
			continue;
		if (m->size > sizeof state || m->states > 16 || m->outputs > 16 || m->inputs > 4)
			stop(3);
		if (v->tuning && (v->tuning->size > sizeof coeffs || m->params != PARAMS))
			stop(3);
		m->init(state);
		while (k < last) {
			for (; k < next; k++)
				m->step(state, sample(k));
			put_state(m, state, k);
			next = 10 * next < last ? 10 * next : last;
			if (v->tuning && k < last && number < TUNINGS)
				retune(v, state, number++);
		}
		if (m->at) {
			m->at(state, sample(k), m->h / 3, x);
			put_line(m, " between", x, m->states);
		}
		if (m->jump) {
			m->jump(state, 1000003);
			put_state(m, state, k + 1000003);
		}
		if (v->tuning) {
			refuse(v);
			if (m->retune(state, m->param_values, m->h) != 0) /* the same as seen from outside */
				stop(4);
			m->step(state, sample(k));
			put_state(m, state, k + 1);
		}
		if (v->selftest) {
			x[0] = v->selftest();
			put_line(m, " selftest", x, 1);
		}
	}
}
