/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * Instances of models with tunable params beside code that plgen made with these values in the first place (tuned.sh:
 * there, plain): after a change of params and step, mid-run changes and back, copies, two instances, refused values,
 * the descriptor.
 */
#include "../emitted/tap.h"
#include "tuned.h"

#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

enum { STEPS = 1000, ROOM = 16384, STATES = 16, INPUTS = 2, OUTPUTS = 8, PARAMS = 16, BOUND = 500 };

/* An instance of anything; aligned */
typedef union instance {
	double align;
	uint64_t word;
	char byte[ROOM];
} instance;

/* Bit for bit what a caller can see of two instances */
static bool same_instance(const real_model *a, const void *s, const void *t)
{
	real y[STATES] = {0}, z[STATES] = {0}, out[OUTPUTS] = {0}, other[OUTPUTS] = {0};
	const real p = a->time(s), q = a->time(t);
	a->get(s, y);
	a->get(t, z);
	a->out(s, out);
	a->out(t, other);
	return memcmp(y, z, sizeof y) == 0 && memcmp(out, other, sizeof out) == 0 && memcmp(&p, &q, sizeof p) == 0;
}

/* The same of coefficients, member by member: what is between them has no meaning. */
static bool same_coeffs(const struct tuned *m, const void *a, const void *b)
{
	const size_t row = (size_t)m->columns * sizeof(real), word = sizeof(real) == 8 ? 16 : 8;
	const struct {
		size_t at, length;
	} member[] = {{m->h, sizeof(real)}, {m->params, (size_t)m->model->params * sizeof(real)},
		{m->step, (size_t)m->step_entries * row},
				  {m->out, (size_t)m->out_entries * row},
						{m->phase_step, (size_t)m->phase_step_entries * word},
					  {m->envelope_step, (size_t)m->envelope_step_entries * word}};
	for (size_t i = 0; i < sizeof member / sizeof *member; i++)
		if (memcmp((const char *)a + member[i].at, (const char *)b + member[i].at, member[i].length) != 0)
			return false;
	return true;
}

/* ---- values of `there` ---- */

static double fraction(const char *text)
{
	char *rest;
	const double value = strtod(text, &rest);
	return *rest == '/' ? value / strtod(rest + 1, NULL) : value;
}

/* "-D k=3 -D m=1/2 --step 1/100" */
static void values_there(const struct tuned *m, real *params, real *h)
{
	for (int k = 0; k < m->model->params; k++) {
		char name[64];
		snprintf(name, sizeof name, "-D %s=", m->model->param_names[k]);
		const char *at = strstr(m->options, name);
		params[k] = at ? (real)fraction(at + strlen(name)) : m->model->param_values[k];
	}
	*h = (real)fraction(strstr(m->options, "--step ") + strlen("--step "));
}

/* ---- samples ---- */

static real sample(int step, int input)
{
	uint32_t bits = (uint32_t)(step * INPUTS + input) * 2654435761u + 12345u;
	bits ^= bits >> 15;
	bits *= 2246822519u;
	bits ^= bits >> 13;
	return (real)(bits % 4096) / 1024 - 2;
}

static const real *samples(const real_model *model, int step)
{
	static real u[INPUTS];
	for (int i = 0; i < model->inputs; i++)
		u[i] = sample(step, i);
	return model->inputs ? u : NULL;
}

/* ---- two instances side by side ---- */

/* Differences are measured against the largest of each number in the run. */
struct run {
	double size[STATES + OUTPUTS], off[STATES + OUTPUTS];
	int between;                        /* at tau, so many compared */
	double time;                        /* largest difference of times, in epsilons of the time */
};

static void take(struct run *r, int at, real found, real expected)
{
	const double difference = fabs((double)found - (double)expected);
	r->size[at] = fmax(r->size[at], fabs((double)expected));
	if (!(difference <= r->off[at]))
		r->off[at] = difference;
}

static void compare_now(struct run *r, const real_model *a, const void *s, const real_model *b, const void *t)
{
	real y[STATES], z[STATES];
	a->get(s, y);
	b->get(t, z);
	for (int i = 0; i < a->states; i++)
		take(r, i, y[i], z[i]);
	a->out(s, y);
	b->out(t, z);
	for (int i = 0; i < a->outputs; i++)
		take(r, STATES + i, y[i], z[i]);
	const double p = (double)a->time(s), q = (double)b->time(t);
	r->time = worse(r->time, p == q ? 0 : fabs(p - q) / (EPSILON * fabs(q)));
}

static void compare_between(struct run *r, const real_model *a, const void *s, const real_model *b, const void *t,
	const real *u, real h)
{
	static const double part[] = {0, 1e-9, 0.125, 0.3, 0.5, 0.77, 1};
	real y[STATES], z[STATES];
	if (!b->at)
		return;
	for (size_t k = 0; k < sizeof part / sizeof *part; k++) {
		a->at(s, u, (real)part[k] * h, y);
		b->at(t, u, (real)part[k] * h, z);
		for (int i = 0; i < a->states; i++)
			take(r, i, y[i], z[i]);
		r->between++;
	}
}

static void step_both(struct run *r, const real_model *a, void *s, const real_model *b, void *t, int first, int steps,
	real h)
{
	for (int k = first; k < first + steps; k++) {
		const real *u = samples(a, k);
		if (k % 23 == 0 || k < first + 3)
			compare_between(r, a, s, b, t, u, h);
		a->step(s, u);
		b->step(t, u);
		compare_now(r, a, s, b, t);
	}
}

static void judge(const struct run *r, const struct tuned *m, int steps, const char *what)
{
	double worst = 0;
	int at = 0;
	for (int i = 0; i < STATES + OUTPUTS; i++) {
		const double error = r->off[i] == 0 ? 0 : r->off[i] / (r->size[i] * EPSILON);
		if (!(error <= worst)) {
			worst = error;
			at = i;
		}
	}
	if (!ok(worst <= BOUND && r->time <= 4 && r->between >= 7, TYPE ", %s: %s, %d steps", m->name, what, steps) ||
		getenv("NOTES"))
		note("off by %.3g epsilons of the largest (%s %d: %.17g of %.17g); times %.3g epsilons; %d times "
			"between steps",
			worst,
			 at < STATES ? "state" : "output", at < STATES ? at : at - STATES, r->off[at], r->size[at],
					r->time,
				 r->between);
}

/* t as s is: state, time, and of ramps the sample before and the slope of the last step, which steps leave there */
static void follow(const real_model *a, const void *s, real h, const real_model *b, void *t, int last)
{
	real y[STATES], u[INPUTS];
	b->init(t);
	if (b->inputs) {
		for (int i = 0; i < b->inputs; i++)
			u[i] = sample(last, i) - (sample(last, i) - sample(last - 1, i)) * (b->h / h);
		b->step(t, u);
		b->step(t, samples(b, last));
	}
	a->get(s, y);
	b->set(t, a->time(s), y);
}

static void check_there(const struct tuned *m)
{
	static instance s, t, coeffs;
	struct run r = {{0}, {0}, 0, 0};
	real params[PARAMS], h;
	values_there(m, params, &h);
	m->model->init(&s);
	m->there->init(&t);
	const int status = m->retune(&coeffs, params, h);
	ok(status == 0 && (double)h == (double)m->there->h,
		TYPE ", %s: retune, status %d, h %.17g as in code made with it, %.17g", m->name, status, (double)h,
	   (double)m->there->h);
	m->use(&s, &coeffs);
	compare_now(&r, m->model, &s, m->there, &t);
	step_both(&r, m->model, &s, m->there, &t, 0, STEPS, h);
	judge(&r, m, STEPS, "other params and step from the start");
}

/* Spec's values, then others, then the spec's again: each time a reference that starts there */
static void check_midway(const struct tuned *m)
{
	enum { PART = 137 };
	static instance s, t, coeffs;
	struct run first = {{0}, {0}, 0, 0}, second = first, third = first;
	real params[PARAMS], h;
	values_there(m, params, &h);
	m->model->init(&s);
	m->plain->init(&t);
	step_both(&first, m->model, &s, m->plain, &t, 0, PART, m->model->h);
	judge(&first, m, PART, "as the spec has it");

	const real before = m->model->time(&s);
	m->retune(&coeffs, params, h);
	m->use(&s, &coeffs);
	ok(before == m->model->time(&s), TYPE ", %s: time stays: %.17g before, %.17g after", m->name, (double)before,
		(double)m->model->time(&s));
	follow(m->model, &s, m->model->h, m->there, &t, PART - 1);
	compare_now(&second, m->model, &s, m->there, &t);
	step_both(&second, m->model, &s, m->there, &t, PART, PART, h);
	judge(&second, m, PART, "other params and step midway");

	m->use(&s, m->nominal);
	follow(m->model, &s, h, m->plain, &t, 2 * PART - 1);
	compare_now(&third, m->model, &s, m->plain, &t);
	step_both(&third, m->model, &s, m->plain, &t, 2 * PART, PART, m->model->h);
	judge(&third, m, PART, "the spec's again");
}

static void step_alike(const real_model *model, instance *s, instance *t, int from, int to)
{
	for (int k = from; k < to; k++) {
		model->step(s, samples(model, k));
		model->step(t, samples(model, k));
	}
}

/* Other params and the same step, computed in the place of an instance's own */
static void check_in_place(const struct tuned *m)
{
	static instance s, t, coeffs;
	real params[PARAMS], h;
	values_there(m, params, &h);
	m->model->init(&s);
	m->model->init(&t);
	m->retune(&coeffs, params, m->model->h);
	m->use(&t, &coeffs);
	m->retune(s.byte + m->place, params, m->model->h);
	step_alike(m->model, &s, &t, 0, 50);
	ok(same_instance(m->model, &s, &t), TYPE ", %s: retuned in an instance, the same step", m->name);
}

/* Instances with other coefficients do not know of each other; a copy goes on as what it was copied from. */
static void check_instances(const struct tuned *m)
{
	static instance one, two, alone, copy, coeffs;
	real params[PARAMS], h;
	values_there(m, params, &h);
	m->retune(&coeffs, params, h);
	m->model->init(&one);
	m->model->init(&two);
	m->model->init(&alone);
	m->use(&two, &coeffs);
	m->use(&alone, &coeffs);
	for (int k = 0; k < 60; k++) {
		m->model->step(&one, samples(m->model, k + 5));
		m->model->step(&two, samples(m->model, k));
		if (k == 30)
			memcpy(&copy, &two, m->model->size);
		if (k > 30)
			m->model->step(&copy, samples(m->model, k));
	}
	for (int k = 0; k < 60; k++)
		m->model->step(&alone, samples(m->model, k));
	ok(same_instance(m->model, &two, &alone), TYPE ", %s: beside another instance as alone", m->name);
	ok(same_instance(m->model, &two, &copy), TYPE ", %s: a copy goes on", m->name);
	ok(!same_instance(m->model, &one, &two), TYPE ", %s: the other one has others", m->name);
}

/* ---- refused ---- */

/* What is refused leaves all as it is, of an instance values other than the spec's. */
static void refuse(const struct tuned *m, const real *params, real h, int expected, const char *what)
{
	static instance coeffs, kept, s, before;
	real there[PARAMS], h_there;
	values_there(m, there, &h_there);
	m->retune(&coeffs, there, h_there);
	m->model->init(&s);
	m->use(&s, &coeffs);
	memcpy(&coeffs, m->nominal, m->size);
	memcpy(&kept, &coeffs, m->size);
	const int status = m->retune(&coeffs, params, h);
	ok(status == expected && same_coeffs(m, &coeffs, &kept), TYPE ", %s, %s: status %d, expected %d, coefficients "
		"%s",
		m->name, what, status, expected,
	   same_coeffs(m, &coeffs, &kept) ? "as they were" : "changed");
	m->model->step(&s, samples(m->model, 3));
	memcpy(&before, &s, sizeof s);
	const int other = m->model->retune(&s, params, h);
	ok(other == expected && same_instance(m->model, &s, &before) &&
		same_coeffs(m, s.byte + m->place, before.byte + m->place),
		TYPE ", %s, %s: the descriptor's: status %d, expected %d, instance %s", m->name, what, other,
	   expected, same_instance(m->model, &s, &before) ? "as it was" : "changed");
}

static void check_refused(const struct tuned *m)
{
	real params[PARAMS];
	const real h = m->model->h, *nominal = m->model->param_values;
	refuse(m, nominal, 0, PL_NO_STEP, "h = 0");
	refuse(m, nominal, -h, PL_NO_STEP, "h < 0");
	refuse(m, nominal, (real)NAN, PL_NO_STEP, "h not a number");
	refuse(m, nominal, (real)INFINITY, PL_NOT_FINITE, "h infinite");
	for (int k = 0; k < m->model->params; k++)
		for (int which = 0; which < 3; which++) {
			char what[64];
			memcpy(params, nominal, (size_t)m->model->params * sizeof *params);
			params[k] = (real)(which == 0 ? NAN : which == 1 ? INFINITY : -INFINITY);
			snprintf(what, sizeof what, "%s = %g", m->model->param_names[k], (double)params[k]);
			if (which == 0 || k == 0)
				refuse(m, params, h, PL_NOT_FINITE, what);
		}
}

static int index_of(const struct tuned *m, const char *name)
{
	for (int k = 0; k < m->model->params; k++)
		if (strcmp(m->model->param_names[k], name) == 0)
			return k;
	ok(false, "%s has no param %s", m->name, name);
	return 0;
}

/* No inverse of the mass matrix: where the target solves, and where the generator has done so, which then divides by
 * 0 */
static void check_singular(const struct tuned *m)
{
	real params[PARAMS];
	memcpy(params, m->model->param_values, (size_t)m->model->params * sizeof *params);
	if (strcmp(m->name, "coupled") == 0) {
		params[index_of(m, "m1")] = params[index_of(m, "m2")] = params[index_of(m, "m3")] = 0;
		refuse(m, params, m->model->h, PL_SINGULAR, "no masses");
		params[index_of(m, "m1")] = 1;
		params[index_of(m, "m2")] = -1;
		params[index_of(m, "m3")] = 2;
		refuse(m, params, m->model->h, PL_SINGULAR, "m1 + m2 = 0");
	}
	if (strcmp(m->name, "sweep") == 0) {
		params[index_of(m, "f")] = -1;
		refuse(m, params, m->model->h, PL_NO_RATE, "f < 0");
	}
	if (strcmp(m->name, "pair") == 0) {
		params[index_of(m, "m1")] = 0;
		refuse(m, params, m->model->h, PL_SINGULAR, "m1 = 0");
	}
}

/* ---- the rest ---- */

/* An entry of a member of coefficients */
static const real *entry(const struct tuned *m, const void *coeffs, size_t member, int row)
{
	return (const real *)(const void *)((const char *)coeffs + member) + row * m->columns;
}

static void check_start(const struct tuned *m)
{
	static instance s;
	m->model->init(&s);
	ok(same_coeffs(m, s.byte + m->place, m->nominal), TYPE ", %s: init takes the nominal coefficients", m->name);
	ok(m->model->size <= ROOM && m->model->h == m->plain->h && m->model->states == m->plain->states &&
		m->model->states <= STATES && m->model->outputs <= OUTPUTS
	   && m->model->inputs <= INPUTS && m->model->params <= PARAMS && !m->plain->retune && m->plain->params == 0,
	   TYPE ", %s: the descriptor, and that of the spec without tunable", m->name);
	ok(memcmp((const char *)m->nominal + m->params, m->model->param_values,
		(size_t)m->model->params * sizeof(real)) == 0
	   && memcmp((const char *)m->nominal + m->h, &m->model->h, sizeof(real)) == 0,
		   TYPE ", %s: nominal params and h are those of the descriptor", m->name);
}

/* The descriptor's retune does what retune and use do. */
static void check_descriptor(const struct tuned *m)
{
	static instance s, t, coeffs;
	real params[PARAMS], h;
	values_there(m, params, &h);
	m->model->init(&s);
	m->model->init(&t);
	step_alike(m->model, &s, &t, 0, 10);
	const int status = m->model->retune(&s, params, h);
	m->retune(&coeffs, params, h);
	m->use(&t, &coeffs);
	step_alike(m->model, &s, &t, 10, 20);
	ok(status == 0 && same_instance(m->model, &s, &t),
		TYPE ", %s: the descriptor's retune as retune and use, status %d", m->name, status);
}

/* A load that the params take away leaves exact zeros. */
static void check_no_load(const struct tuned *m)
{
	static instance coeffs;
	real params[PARAMS];
	double most = 0;
	if (strcmp(m->name, "pair") != 0)
		return;
	memcpy(params, m->model->param_values, (size_t)m->model->params * sizeof *params);
	params[index_of(m, "F")] = 0;
	const int status = m->retune(&coeffs, params, m->model->h);
	for (int i = 0; i < m->step_entries; i++)
		for (int j = m->model->states; j < m->columns; j++)
			most = fmax(most, fabs((double)entry(m, &coeffs, m->step, i)[j]));
	ok(status == 0 && most == 0, TYPE ", %s: F = 0: status %d, largest factor of the load "
		"%g", m->name, status, most);
}

/* Phases go on from where they are. Those of sweep all belong to f, so at time t they are those of its double at
 * t/2. */
static void check_sweep(const struct tuned *m)
{
	enum { PART = 200 };
	static instance s, t, coeffs;
	struct run r = {{0}, {0}, 0, 0};
	real params[PARAMS], y[STATES], z[STATES], h;
	if (!m->there || !strstr(m->name, "sweep"))
		return;
	values_there(m, params, &h);
	m->retune(&coeffs, params, h);
	m->model->init(&s);
	for (int k = 0; k < PART; k++)
		m->model->step(&s, NULL);
	m->use(&s, &coeffs);
	m->model->get(&s, y);
	m->there->init(&t);
	m->there->set(&t, m->model->time(&s) / 2, y);
	for (int k = 0; k < PART; k++) {
		m->model->step(&s, NULL);
		m->there->step(&t, NULL);
		m->model->get(&s, y);
		m->there->get(&t, z);
		for (int i = 0; i < m->model->states; i++)
			take(&r, i, y[i], z[i]);
	}
	m->model->out(&s, y);
	m->there->out(&t, z);
	for (int i = 0; i < m->model->outputs; i++)
		take(&r, STATES + i, y[i], z[i]);
	r.between = 7;                      /* at() is looked at elsewhere */
	judge(&r, m, PART, "another frequency midway, phases go on");
}

int main(void)
{
	for (const struct tuned *m = tuned; m->name; m++) {
		check_start(m);
		check_there(m);
		/* there the phases at a time depend on what was before */
		if (!strstr(m->name, "sweep") && !strstr(m->name, "drive"))
			check_midway(m);
		check_sweep(m);
		check_in_place(m);
		check_instances(m);
		check_descriptor(m);
		check_refused(m);
		check_singular(m);
		check_no_load(m);
	}
	return tap_end();
}
