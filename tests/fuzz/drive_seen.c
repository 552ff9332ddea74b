/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The subject of `drive` as its judges see it, in double or float alike; its bounds, of which drive.c tells; its
 * samples. */
#include "driving.h"

#include <math.h>
#include <stdarg.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

const struct subject *of;
int states, inputs, outputs, complaints;
double h, size, out_size, own[MOST];
bool in_float, ramps[MOST], undriven;

void complain(const char *form, ...)
{
	va_list arguments;
	if (complaints++ > 5)
		return;
	va_start(arguments, form);
	printf("%s: ", of->name);
	vprintf(form, arguments);
	putchar('\n');
	va_end(arguments);
}

bool near(double found, double expected, double tolerance, const char *what, double t, const char *which)
{
	if (fabs(found - expected) <= tolerance)
		return true;
	complain("%s, t = %.17g, %s: found %.17g, expected %.17g, difference %.3g, tolerance %.3g", what, t, which,
		 found, expected, found - expected, tolerance);
	return false;
}

/* ---- a model in double or float, seen alike ---- */

void *fresh(void)
{
	void *s = malloc(of->model ? of->model->size : of->modelf->size);
	if (!s)
		exit(3);
	memset(s, 0x5a, of->model ? of->model->size : of->modelf->size);
	return s;
}

size_t bytes(void)
{
	return of->model ? of->model->size : of->modelf->size;
}

void narrow(const double *from, float *to, int n)
{
	for (int i = 0; i < n; i++)
		to[i] = (float)from[i];
}

void widen(const float *from, double *to, int n)
{
	for (int i = 0; i < n; i++)
		to[i] = (double)from[i];
}

void model_init(void *s)
{
	if (of->model)
		of->model->init(s);
	else
		of->modelf->init(s);
}

void model_set(void *s, double t, const double *y)
{
	float narrowed[MOST];
	narrow(y, narrowed, states);
	if (of->model)
		of->model->set(s, t, y);
	else
		of->modelf->set(s, (float)t, narrowed);
}

void model_get(const void *s, double *y)
{
	float narrowed[MOST];
	if (of->model) {
		of->model->get(s, y);
		return;
	}
	of->modelf->get(s, narrowed);
	widen(narrowed, y, states);
}

double model_time(const void *s)
{
	return of->model ? of->model->time(s) : (double)of->modelf->time(s);
}

void model_step(void *s, const double *u)
{
	float narrowed[MOST];
	narrow(u, narrowed, inputs);
	if (of->model)
		of->model->step(s, inputs ? u : NULL);
	else
		of->modelf->step(s, inputs ? narrowed : NULL);
}

void model_out(const void *s, double *out)
{
	float narrowed[MOST];
	if (of->model) {
		of->model->out(s, out);
		return;
	}
	of->modelf->out(s, narrowed);
	widen(narrowed, out, outputs);
}

bool model_at(const void *s, const double *u, double tau, double *y)
{
	float narrowed[MOST], found[MOST];
	if (of->model ? !of->model->at : !of->modelf->at)
		return false;
	narrow(u, narrowed, inputs);
	if (of->model) {
		of->model->at(s, inputs ? u : NULL, tau, y);
		return true;
	}
	of->modelf->at(s, inputs ? narrowed : NULL, (float)tau, found);
	widen(found, y, states);
	return true;
}

int model_status(const void *s)
{
	if (of->model)
		return of->model->status ? of->model->status(s) : 0;
	return of->modelf->status ? of->modelf->status(s) : 0;
}

const char *state_name(int i)
{
	return of->model ? of->model->state_names[i] : of->modelf->state_names[i];
}

const char *output_name(int i)
{
	return of->model ? of->model->output_names[i] : of->modelf->output_names[i];
}

/* false: there is none */
bool model_jump(void *s, int steps)
{
	if (of->model ? !of->model->jump : !of->modelf->jump)
		return false;
	if (of->model)
		of->model->jump(s, (uint64_t)steps);
	else
		of->modelf->jump(s, (uint64_t)steps);
	return true;
}

/* ---- bounds ---- */

double rounding(int steps)
{
	return (in_float ? 2e-5 : 1e-12) * (steps + 1);
}

bool is(const char *text, const char *word)
{
	return strcmp(text, word) == 0;
}

bool of_first_order(void)
{
	return is(of->scheme, "etd1") || is(of->scheme, "pl");
}

/* Of states against CVODE */
double bound(void)
{
	const bool first = of_first_order(), second = is(of->scheme, "etdrk2");
	double b = first ? 5e-2 : second ? 3e-3 : 1e-4;
	if (is(of->class, "sticking"))
		b = 1e-3;
	else if (is(of->scheme, "exact"))
		b = 1e-6;
	else if (!is(of->class, "smooth") && !is(of->class, "linear") && !first)
		b = 1e-2;
	return in_float ? fmax(b, 2e-3) : b;
}

/* ---- samples of the inputs: numbers that a float holds ---- */

static double sample(int step, int which)
{
	return undriven ? 0 : (double)((step * 37 + which * 23 + 11) % 61 - 30) / 32;
}

void samples(int step, double *u)
{
	for (int i = 0; i < inputs; i++)
		u[i] = sample(step, i);
}

/* Of all inputs of `whole`: what the model delays is another input of that. */
void whole_samples(int step, double *u)
{
	samples(step, u);
	for (int i = inputs; i < of->whole->inputs; i++)
		u[i] = step < DELAY ? 0 : sample(step - DELAY, 0);
}

/* What an output loses with modes that are dropped, from the start and under loads; what inputs drive in them is said
 * of outputs with a need alone. */
double loss_of(const char *name)
{
	const size_t length = strlen(name);
	for (const char *p = of->lost; (p = strstr(p, name)); p++)
		if (p[-1] == ' ' && p[length] == ' ' && strtod(p + length, NULL) > 0)
			return inputs && !undriven ? INFINITY : strtod(p + length, NULL);
	return 0;
}

/* Inputs over a step as NAME_rhs takes them: at its start, then slopes. */
void over_step(const double *before, const double *sampled, double step, double *u)
{
	for (int i = 0, all = of->whole->inputs; i < all; i++) {
		u[i] = ramps[i] ? before[i] : sampled[i];
		u[all + i] = ramps[i] ? (sampled[i] - before[i]) / step : 0;
	}
}

/* Of a ramp the sample before acts: after another first sample the same second one gives other states or outputs, by
 * more than what rounding makes of a step that begins in another region. From here, or from so far away, where what
 * sticks slips, and the larger of two is the other one; above 0 or below it, for the same reason. */
static bool ramps_from(int input, double far, double sign)
{
	double u[MOST] = {0}, seen[2][2 * MOST], start[MOST];
	void *const s = malloc(of->whole->size);
	bool ramp = false;
	if (!s)
		exit(3);
	for (int j = 0; j < of->whole->states; j++)
		start[j] = far != 0 ? (j % 2 ? -far : far) + j * 0.3 : 0.25 + j * 0.01;
	for (int round = 0; round < 2; round++) {       /* the same state and time, the sample before differs */
		of->whole->init(s);
		u[input] = round ? sign : 0;
		of->whole->step(s, u);
		of->whole->set(s, 0, start);
		u[input] = 0.5 * sign;
		of->whole->step(s, u);
		of->whole->get(s, seen[round]);
		of->whole->out(s, seen[round] + of->whole->states);
	}
	for (int j = 0; j < of->whole->states + of->whole->outputs; j++)
		ramp = ramp || fabs(seen[0][j] - seen[1][j]) > 1e-10 * fmax(1, fabs(seen[0][j]));
	free(s);
	return ramp;
}

/* Where no such state shows it, the descriptor tells. */
void find_ramps(void)
{
	for (int i = 0; i < of->whole->inputs; i++) {
		for (int k = 0; k < 6 && !ramps[i]; k++)
			ramps[i] = ramps_from(i, 2 * (k / 2 - 1), k % 2 ? -1 : 1);
		ramps[i] = ramps[i] || of->whole->start_samples[i] == 1;
	}
}
