/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model of modes against the whole model, both as C: project times a state of the whole is the state of the one
 * that is smaller, at any time and from any start, under loads and inputs; expand gives back what starts in the kept
 * modes; and outputs. -DALL: nothing is dropped, outputs are the same. -DSETTLES=T: after T what is dropped is at rest,
 * and outputs are the same, an input being held. -DDROPPED: a model of what outputs lose. -DLOST={...}: outputs differ
 * by no more, inputs 0. */
#include "part.h"
#include "whole.h"
#include "worse.h"

#include <math.h>
#include <stdio.h>

enum { N = WHOLE_STATES, K = PART_STATES, OUTPUTS = WHOLE_OUTPUTS, STEPS = 1200 };
#ifdef INPUTS
static double amplitude;
#endif
static whole a, other;
static part b;
static int failed;

static void judge(double error, double largest, double tolerance, const char *what, int which)
{
	if (error <= tolerance * largest)
		return;
	printf("%s %d: off by %.3g, largest value %.17g\n", what, which, error, largest);
	failed = 1;
}

static void project(const double *x, double *y)
{
	int i, j;
	for (i = 0; i < K; i++) {
		y[i] = 0;
		for (j = 0; j < N; j++)
			y[i] += part_project[i][j] * x[j];
	}
}

static void restore(const double *y, double *x)
{
	int i, j;
	for (i = 0; i < N; i++) {
		x[i] = 0;
		for (j = 0; j < K; j++)
			x[i] += part_expand[i][j] * y[j];
	}
}

#ifdef INPUTS
static const double *input_at(int n)
{
	static double u[8];
	int i;
	for (i = 0; i < 8; i++)
		u[i] = amplitude * (n < 400 ? cos(0.37 * n + i) : 1);
	return u;
}
#endif

static void advance_whole(whole *s, int n)
{
#ifdef INPUTS
	whole_step(s, input_at(n));
#else
	(void)n;
	whole_step(s);
#endif
}

static void advance_part(part *s, int n)
{
#ifdef INPUTS
	part_step(s, input_at(n));
#else
	(void)n;
	part_step(s);
#endif
}

/* project times the whole's state, step by step */
static void same_states(void)
{
	double x[N], y[K], z[K], worst[K] = {0}, size = 0;
	int n, i;
	for (i = 0; i < N; i++)
		x[i] = sin(3.0 * i + 1);
	project(x, y);
	whole_init(&a);
	part_init(&b);
	whole_set(&a, 0.0, x);
	part_set(&b, 0.0, y);
	for (n = 0; n < STEPS; n++) {
		whole_get(&a, x);
		part_get(&b, z);
		project(x, y);
		for (i = 0; i < K; i++) {
			worst[i] = worse(worst[i], fabs(y[i] - z[i]));
			size = fmax(size, fabs(z[i]));
		}
		advance_whole(&a, n);
		advance_part(&b, n);
	}
	for (i = 0; i < K; i++)
		judge(worst[i], size, 1e-12, "state", i);
}

/* What starts in the kept modes, less what starts at rest: the whole and the smaller model move alike. */
static void same_motion(void)
{
	double y[K], x[N], rest[N], back[N], zero[N] = {0}, none[K] = {0}, now[K], now_rest[K], size = 0, worst = 0;
	static part still;
	int n, i;
	for (i = 0; i < K; i++)
		y[i] = cos(2.0 * i);
	restore(y, x);
	whole_init(&a);
	whole_init(&other);
	part_init(&b);
	part_init(&still);
	whole_set(&a, 0.0, x);
	whole_set(&other, 0.0, zero);
	part_set(&b, 0.0, y);
	part_set(&still, 0.0, none);
	for (n = 0; n < STEPS; n++) {
		whole_get(&a, x);
		whole_get(&other, rest);
		part_get(&b, now);
		part_get(&still, now_rest);
		for (i = 0; i < K; i++)
			now[i] -= now_rest[i];
		restore(now, back);
		for (i = 0; i < N; i++) {
			worst = worse(worst, fabs(x[i] - rest[i] - back[i]));
			size = fmax(size, fmax(fabs(back[i]), fabs(rest[i])));
		}
		advance_whole(&a, n);
		advance_whole(&other, n);
		advance_part(&b, n);
		advance_part(&still, n);
	}
	judge(worst, size, 1e-12, "motion, largest state", 0);
}

/* Largest difference of outputs from step `from` on */
static void same_outputs(int from, const double *most, double tolerance)
{
	double worst[OUTPUTS] = {0}, size[OUTPUTS] = {0}, p[OUTPUTS], q[OUTPUTS];
	int n, i;
	whole_init(&a);
	part_init(&b);
	for (n = 0; n < from + STEPS; n++) {
		whole_out(&a, p);
		part_out(&b, q);
		for (i = 0; i < OUTPUTS; i++) {
			if (n >= from)
				worst[i] = worse(worst[i], fabs(p[i] - q[i]));
			size[i] = fmax(size[i], fabs(p[i]));
		}
		advance_whole(&a, n);
		advance_part(&b, n);
	}
	for (i = 0; i < OUTPUTS; i++)
		judge(worst[i], most ? most[i] + 1e-13 * size[i] : size[i], tolerance, "output", i);
}

#ifdef DROPPED
#include "dropped.h"

/* What is lost, as a model of its own */
static void lost_outputs(void)
{
	static dropped lost;
	double worst[OUTPUTS] = {0}, size[OUTPUTS] = {0}, p[OUTPUTS], q[OUTPUTS], e[OUTPUTS];
	int n, i;
	whole_init(&a);
	part_init(&b);
	dropped_init(&lost);
	for (n = 0; n < STEPS; n++) {
		whole_out(&a, p);
		part_out(&b, q);
		dropped_out(&lost, e);
		for (i = 0; i < OUTPUTS; i++) {
			worst[i] = worse(worst[i], fabs(p[i] - q[i] - e[i]));
			size[i] = fmax(size[i], fabs(p[i]));
		}
		advance_whole(&a, n);
		advance_part(&b, n);
#ifdef INPUTS
		dropped_step(&lost, input_at(n));
#else
		dropped_step(&lost);
#endif
	}
	for (i = 0; i < OUTPUTS; i++)
		judge(worst[i], size[i], 1e-13, "what output loses", i);
}
#endif

static void inverse_matrices(void)
{
	int i, j, k;
	for (i = 0; i < K; i++)
		for (j = 0; j < K; j++) {
			double sum = 0, size = 0;
			for (k = 0; k < N; k++) {
				sum += part_project[i][k] * part_expand[k][j];
				size += fabs(part_project[i][k] * part_expand[k][j]);
			}
			judge(fabs(sum - (i == j)), fmax(size, 1), 1e-14, "project expand, row", i);
		}
}

int main(void)
{
	inverse_matrices();
#ifdef LOST
	{
		static const double most[OUTPUTS] = LOST;
		same_outputs(0, most, 1);
	}
#endif
#ifdef INPUTS
	amplitude = 1;
#endif
	same_states();
	same_motion();
#ifdef DROPPED
	lost_outputs();
#endif
#ifdef ALL
	same_outputs(0, 0, 1e-13);
#endif
#ifdef SETTLES
	same_outputs((int)(SETTLES / WHOLE_H), 0, 1e-12);
#endif
	return failed;
}
