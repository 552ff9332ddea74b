/* SPDX-License-Identifier: GPL-3.0-or-later */
/* output NAME = peak(x) against the largest |x| that NAME_at sees between steps: first among many times, then around
 * the largest of these by parabolas, which are off by the fourth power of their width. */
#include "m.h"

#include <math.h>
#include <stdio.h>

#ifndef STEPS
#define STEPS 400
#endif
enum { TIMES = 64, PEAKS = 4, INPUTS = 3 };
#ifdef PLAIN                            /* outputs are x, y - 0.3 x, x', y' of a model without inputs */
static double h = M_H;
static void plain_step(m *s, const double *u)
{
	(void)u;
	m_step(s);
}
static void plain_at(const m *s, const double *u, double tau, double *y)
{
	(void)u;
	m_at(s, tau, y);
}
#define m_step plain_step
#define m_at plain_at
#define m_hold(s, u) (void)(u)
#else
static double c = 3, k = 900, h = M_H;
#endif

static double draw(void)                /* -1 .. 1 */
{
	static uint32_t state = 3;
	state = state * 1664525u + 1013904223u;
	return (double)state / 2147483648.0 - 1.0;
}

/* The polynomial of degree d through samples at -(d-1)/2 .. (d+1)/2 steps, by Neville's scheme */
static double between(const double *sample, int degree, double s)
{
	double p[8];
	int i, j;
	for (i = 0; i <= degree; i++)
		p[i] = sample[i];
	for (j = 1; j <= degree; j++)
		for (i = 0; i + j <= degree; i++) {
			double a = i - (degree - 1) / 2, b = a + j;
			p[i] = ((s - b) * p[i] - (s - a) * p[i + 1]) / (a - b);
		}
	return p[0];
}

/* What outputs are made of, tau after the start of a step, without the model's own outputs */
static void values(const m *s, const double *u, const double *sample, double tau, double *value)
{
	double y[M_STATES];
#ifndef PLAIN
	double t = m_time(s) + tau, now = between(sample, 3, tau / h), load = 20 * cos(11 * t) + exp(-t);
#endif
	m_at(s, u, tau, y);
	value[0] = y[0];
	value[1] = y[1] - 0.3 * y[0];
	value[2] = y[2];
#ifdef PLAIN
	value[3] = y[3];
	(void)sample;
#else
	value[3] = now + load - c * y[2] - k * y[0] + 200 * y[1] + 0.2 * now;
#endif
}

/* Higher than at both ends: the top of the parabola through three times, again and again */
static double top(const m *s, const double *u, const double *sample, int which, double middle, double width)
{
	double best = 0;
	int i, j;
	for (i = 0; i < 12; i++) {
		double v[3], value[PEAKS], bend, move;
		for (j = 0; j < 3; j++) {
			values(s, u, sample, middle + (j - 1) * width, value);
			v[j] = value[which];
			best = fmax(best, fabs(v[j]));
		}
		bend = v[0] - 2 * v[1] + v[2];
		move = bend == 0 ? 0 : width * (v[0] - v[2]) / (2 * bend);
		middle += fmax(fmin(move, width), -width);
		width /= 3;
		middle = fmin(fmax(middle, width), h - width);
	}
	return best;
}

static double largest[PEAKS];
static void look(const m *s, const double *u, const double *sample)
{
	double seen[TIMES + 1][PEAKS];
	int i, p;
	for (i = 0; i <= TIMES; i++)
		values(s, u, sample, h * i / TIMES, seen[i]);
	for (p = 0; p < PEAKS; p++)
		for (i = 0; i <= TIMES; i++) {
			double size = fabs(seen[i][p]);
			int high = (i == 0 || size >= fabs(seen[i - 1][p])) &&
					(i == TIMES || size >= fabs(seen[i + 1][p]));
			double middle = h / TIMES * fmin(fmax(i, 1), TIMES - 1);
			if (high && size > 0.95 * largest[p])
				size = fmax(size, top(s, u, sample, p, middle, h / TIMES));
			largest[p] = fmax(largest[p], size);
		}
}

static int failed;
static void judge(const char *what, int n, const double *peak)
{
	int p;
	for (p = 0; p < PEAKS; p++)
		if (!(fabs(peak[p] - largest[p]) <= 2e-11 * largest[p])) {
			printf("# %s, peak %d after %d steps: %.17g, expected %.17g within 2e-11\n", what, p, n,
					peak[p],
				   largest[p]);
			failed = 1;
		}
}

static void follow(m *s, const char *what)
{
	double sample[4] = {0}, y[M_STATES] = {0.02, 0, 0, -1}, out[M_OUTPUTS], before[3] = {0};
	int n, i, inside = 0, changes = 0;
	m_set(s, 0, y);
	m_hold(s, before);                  /* what was held is forgotten: zeros */
	m_hold(s, before);
	m_hold(s, before);
	for (i = 0; i < PEAKS; i++)
		largest[i] = 0;
	for (n = 0; n < STEPS; n++) {
		double u[INPUTS] = {30 * draw(), 10 * draw(), draw()}, old[PEAKS];
		for (i = 0; i < 3; i++)
			sample[i] = sample[i + 1];
		sample[3] = u[0];
		m_out(s, out);
		for (i = 0; i < PEAKS; i++)
			old[i] = out[i];
		look(s, u, sample);
		m_step(s, u);
		m_out(s, out);
		judge(what, n + 1, out);
		for (i = 0; i < PEAKS; i++) {
			changes += out[i] > old[i];
			inside += out[i] > old[i] && out[i] > fabs(out[PEAKS + i]);
		}
		if (n == STEPS / 2) {           /* the peaks start anew */
			m_get(s, y);
			m_set(s, m_time(s), y);
			for (i = 0; i < PEAKS; i++)
				largest[i] = 0;
		}
	}
	printf("# %s: %d changes of peaks, %d of them inside steps\n", what, changes, inside);
	failed |= inside < 10;
}

int main(void)
{
	static m s;
	m_init(&s);
	follow(&s, "spec's values");
#ifdef TUNED
	{
		double params[M_PARAMS] = {2500, 0.3};
		m_coeffs fresh;
		k = params[0];
		c = params[1];
		h = 0.08;
		failed |= m_retune(&fresh, params, h) != 0;
		m_use(&s, &fresh);
		follow(&s, "retuned");
	}
#endif
	return failed;
}
