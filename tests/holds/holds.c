/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Inputs between samples against closed forms. A record that is a polynomial of the hold's degree has a response that
 * is one too, if the motion starts on it: q = w^2 p + 2 zeta w p' + p'' gives p from q, from the highest power down.
 * Step, at between steps and run; -DTUNED: by retuned coefficients, and the order in h for a sine, d + 1, by halves of
 * the step. -DCHAIN: all inputs are the ramp's polynomial. */
#include "m.h"
#include "../emitted/worse.h"

#include <math.h>
#include <stdio.h>

enum { STEPS = 150, DEGREES = 8, INPUTS = 4 };
static const int ahead[INPUTS] = {2, 3, 4, 1};
#ifdef CHAIN
static const int degree[INPUTS] = {1, 1, 1, 1};
static const double rate[INPUTS] = {0.3, 0.3, 0.3, 0.3};
#else
static const int degree[INPUTS] = {3, 5, 7, 1};
static const double rate[INPUTS] = {0, 0, 0.1, 0.3};       /* factor of u' */
#endif
static double w = 3, zeta = 0.1, h = M_H;
static double u_of[INPUTS][DEGREES], x_of[INPUTS][DEGREES];
static int failed;

static double value(const double *c, double t, int derivative)
{
	double sum = 0;
	int m, k;
	for (m = DEGREES - 1; m >= derivative; m--) {
		double factor = c[m];
		for (k = 0; k < derivative; k++)
			factor *= m - k;
		sum = sum * t + factor;
	}
	return sum;
}

static void make_polynomials(void)
{
	int i, m;
	for (i = 0; i < INPUTS; i++) {
		double r[DEGREES + 2] = {0}, *x = x_of[i];
		for (m = 0; m <= degree[i]; m++)
			u_of[i][m] = (m % 2 ? -1.0 : 1.0) * (1 + m) * pow(4.0, -m);
		for (m = DEGREES - 1; m >= 0; m--) {
			double up = m + 1 < DEGREES ? (m + 1) * u_of[i][m + 1] : 0, one = 0, two = 0;
			if (m + 1 < DEGREES)
				one = (m + 1) * x[m + 1];
			if (m + 2 < DEGREES)
				two = (m + 2) * (m + 1) * x[m + 2];
			r[m] = u_of[i][m] + rate[i] * up;
			x[m] = (r[m] - 2 * zeta * w * one - two) / (w * w);
		}
	}
}

/* What step n, n = 0, 1, ..., is given, and before the first, n = -1, -2, ... */
static void sample(double *u, int n, double (*of)(int i, double t))
{
	int i;
	for (i = 0; i < INPUTS; i++)
		u[i] = of(i, (n + ahead[i]) * h);
}

static double polynomial(int i, double t) { return value(u_of[i], t, 0); }

static void start(m *s, double (*of)(int i, double t), double (*x)(int i, double t, int derivative))
{
	double y[M_STATES], u[INPUTS];
	int i, n;
	for (i = 0; i < M_STATES; i++)
		y[i] = x((i % (M_STATES / 2)) % INPUTS, 0, i >= M_STATES / 2);
	m_set(s, 0, y);
	for (n = -7; n < 0; n++) {
		sample(u, n, of);
		m_hold(s, u);
	}
}

static double response(int i, double t, int derivative) { return value(x_of[i], t, derivative); }

static void judge(const char *what, double off, double bound)
{
	failed |= !(off <= bound);
	printf("%sok - %s: %.3g, at most %g\n", off <= bound ? "" : "not ", what, off, bound);
}

static double deviation(const double *y, double t)
{
	double worst = 0;
	int i;
	for (i = 0; i < M_STATES; i++) {
		int which = (i % (M_STATES / 2)) % INPUTS;
		double exact = value(x_of[which], t, i >= M_STATES / 2), size = 0;
		int m;
		for (m = 0; m < DEGREES; m++)
			size += fabs(x_of[which][m]) * pow(STEPS * h, m) * (i >= M_STATES / 2 ? w : 1);
		worst = worse(worst, fabs(y[i] - exact) / size);
	}
	return worst;
}

static void follow(m *s, const char *what, double bound)
{
	double u[INPUTS], y[M_STATES], worst = 0, between = 0, outputs = 0;
	int n;
	start(s, polynomial, response);
	for (n = 0; n < STEPS; n++) {
		sample(u, n, polynomial);
		m_at(s, u, 0.37 * h, y);
		between = worse(between, deviation(y, (n + 0.37) * h));
		m_step(s, u);
		m_get(s, y);
		worst = worse(worst, deviation(y, (n + 1) * h));
#ifndef CHAIN
		{
			double out[M_OUTPUTS];
			m_out(s, out);
			outputs = worse(outputs,
							fabs(out[4] - value(u_of[2], (n + 1) * h,
							1)) / fabs(value(u_of[2], STEPS * h, 1)));
			outputs = worse(outputs,
							fabs(out[5] - value(u_of[1], (n + 1) * h,
							0)) / fabs(value(u_of[1], STEPS * h, 0)));
		}
#endif
	}
	printf("# %s\n", what);
	judge("states at steps", worst, bound);
	judge("states between them", between, bound);
	judge("an input and a slope as outputs", outputs, 1e-11);
}

#ifdef TUNED
/* x'' + 2 zeta w x' + w^2 x = u + rate u' for u = sin(v t): x = Im(H e^{i v t}) */
static const int hold[INPUTS] = {3, 5, 7, 1};
static const double v = 7;
static double sine(int i, double t) { (void)i; return sin(v * t); }
static double steady(int i, double t, int derivative)
{
	double re = w * w - v * v, im = 2 * zeta * w * v, d = re * re + im * im, f = rate[i] * v;
	double hr = (re + f * im) / d, hi = (f * re - im) / d, c = cos(v * t), s = sin(v * t);
	return derivative ? v * (hr * c - hi * s) : hr * s + hi * c;
}

static void errors(m *s, double *error)
{
	double params[M_PARAMS] = {w, zeta}, u[INPUTS], y[M_STATES];
	m_coeffs c;
	int i, n;
	if (m_retune(&c, params, h) != 0)
		failed = 1;
	m_use(s, &c);
	start(s, sine, steady);
	for (n = 0; n < (int)(2 / h + 0.5); n++) {
		sample(u, n, sine);
		m_step(s, u);
	}
	m_get(s, y);
	for (i = 0; i < INPUTS; i++)
		error[i] = fabs(y[i] - steady(i, 2, 0));
}

static void orders(m *s)
{
	double error[2][INPUTS];
	int i;
	h = 0.05;
	errors(s, error[0]);
	h = 0.025;
	errors(s, error[1]);
	for (i = 0; i < INPUTS; i++) {
		double order = log2(error[0][i] / error[1][i]);
		printf("# hold of degree %d: %.3g, %.3g at half the step\n", hold[i], error[0][i], error[1][i]);
		judge("the order less that expected", fabs(order - (hold[i] + 1)), 0.4);
	}
}
#endif

int main(void)
{
	static m s;
	m_init(&s);
	make_polynomials();
	follow(&s, "with the spec's values", 1e-13);
#ifdef TUNED
	{
		double params[M_PARAMS] = {4.5, 0.02};
		m_coeffs c;
		w = params[0];
		zeta = params[1];
		h = 0.03;
		failed |= m_retune(&c, params, h) != 0;
		m_use(&s, &c);
		make_polynomials();
		follow(&s, "retuned", 1e-13);
		orders(&s);
	}
#endif
	return failed;
}
