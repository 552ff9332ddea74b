/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random values of params: families of pair.spec, and what lies around those of any spec. */
#include "families.h"
#include "drawn.h"

#include <math.h>

/* ---- random values ---- */

static double uniform(void)
{
	return ((double)below(1u << 30) + 0.5) / 0x1p30;
}

/* 10^a to 10^b, evenly in its logarithm; now and then with few bits, as one would write it */
static real spread(double a, double b)
{
	const double x = pow(10, a + (b - a) * uniform());
	int exponent;
	const double fraction = frexp(x, &exponent);
	return below(3) ? (real)x : (real)ldexp(ceil(fraction * 16) / 16, exponent);
}

/* ---- families of pair.spec: m1, m2, k1, k2, k3, c1, c2, c3, F ---- */

enum { M1, M2, K1, K2, K3, C1, C2, C3, F };

static void any_pair(real *p)
{
	for (int i = M1; i <= M2; i++)
		p[i] = spread(-2, 2);
	for (int i = K1; i <= K3; i++)
		p[i] = spread(-1, 4);
	for (int i = C1; i <= C3; i++)
		p[i] = spread(-3, 1);
	p[F] = spread(-2, 3) * (below(2) ? 1 : -1);
}

/* Largest frequency, roughly */
static double frequency(const real *p)
{
	return sqrt(fmax(((double)p[K1] + (double)p[K2]) / (double)p[M1],
			((double)p[K2] + (double)p[K3]) / (double)p[M2]));
}

/* Largest decay */
static double decay(const real *p)
{
	return fmax(((double)p[C1] + (double)p[C2]) / (double)p[M1], ((double)p[C2] + (double)p[C3]) / (double)p[M2]);
}

/* |p| h from 10^a to 10^b */
static real step_for(const real *p, double a, double b)
{
	const double rate = fmax(frequency(p), decay(p));
	return (real)((double)spread(a, b) / (rate > 0 ? rate : 1));
}

static real family_general(real *p)
{
	any_pair(p);
	return step_for(p, -4, 1.8);
}

static real family_undamped(real *p)
{
	any_pair(p);
	p[C1] = p[C2] = p[C3] = 0;
	return step_for(p, -4, 1.8);
}

static real family_overdamped(real *p)
{
	any_pair(p);
	for (int i = C1; i <= C3; i++)
		p[i] = (real)(2 * frequency(p) * (double)p[M1 + i % 2] * (double)spread(0, 2));
	return step_for(p, -4, 1.5);
}

/* 2^-n with n such that it is between about 1e-8 and 1e-15, for floats 1e-3 and 1e-7; now and then 0; either sign */
static real little(void)
{
	const int n = BITS == 53 ? 26 + (int)below(26) : 10 + (int)below(13);
	return below(8) == 0 ? 0 : (real)(below(2) ? ldexp(1, -n) : -ldexp(1, -n));
}

/* Masses that are equal and hardly coupled, each mode damped nearly critically: c^2 = 4 k m (1 + little)^2 */
static real family_critical(real *p)
{
	const double w = (double)(1 + below(64)) / 4;
	any_pair(p);
	p[M1] = (real)(1 + below(32)) / 8;
	p[M2] = below(2) ? p[M1] : (real)(1 + below(32)) / 8;
	p[K1] = (real)((double)p[M1] * w * w);
	p[K3] = (real)((double)p[M2] * w * w);
	p[C1] = (real)(2 * (double)p[M1] * w) * (1 + little());
	p[C3] = (real)(2 * (double)p[M2] * w) * (1 + little());
	p[K2] = below(2) ? 0 : (real)fabs((double)little()) * p[K1];
	p[C2] = below(2) ? 0 : (real)fabs((double)little()) * p[C1];
	return (real)((double)spread(-4, 1.7) / w);
}

/* Equal modes, light damping */
static real family_equal(real *p)
{
	any_pair(p);
	p[M2] = p[M1] * (1 + little());
	p[K3] = p[K1] * (1 + little());
	p[C3] = p[C1];
	p[K2] = p[K1] * (real)fabs((double)little());
	p[C2] = 0;
	return step_for(p, -4, 1.8);
}

/* No spring and no damper to the ground */
static real family_rigid(real *p)
{
	any_pair(p);
	p[K1] = p[K3] = p[C1] = p[C3] = 0;
	if (below(3) == 0)
		p[C2] = 0;
	return step_for(p, -4, 1.8);
}

/* No spring at all */
static real family_free(real *p)
{
	any_pair(p);
	p[K1] = p[K2] = p[K3] = 0;
	for (int i = C1; i <= C3; i++)
		if (below(3) == 0)
			p[i] = 0;
	return step_for(p, -4, 1.5);
}

static real family_long_steps(real *p)
{
	any_pair(p);
	return step_for(p, 1, 2);
}

static real family_short_steps(real *p)
{
	any_pair(p);
	return step_for(p, -6, -2);
}

/* Very different springs and masses */
static real family_stiff(real *p)
{
	any_pair(p);
	p[K1 + below(3)] = spread(6, 9);
	p[M1 + below(2)] = spread(-4, 3);
	return step_for(p, -2, 1.7);
}

/* Other units of mass and of time */
static real family_units(real *p)
{
	const int mass = (int)below(2 * BITS) - BITS, rate = (int)below(BITS) - BITS / 2;
	any_pair(p);
	const real h = step_for(p, -4, 1.8);
	for (int i = M1; i <= C3; i++)
		p[i] = (real)ldexp((double)p[i], mass + (i < K1 ? 0 : i < C1 ? 2 * rate : rate));
	return (real)ldexp((double)h, -rate);
}

const struct family families[] = {{"general", family_general},
				{"undamped", family_undamped},
				{"overdamped", family_overdamped},
				{"near critical damping", family_critical},
				{"nearly equal modes", family_equal},
				{"a rigid body", family_rigid},
				{"without springs", family_free},
				{"|p| h 10 to 100", family_long_steps},
				{"|p| h below 0.01", family_short_steps},
				{"stiff", family_stiff},
				{"other units", family_units}};
const int family_count = sizeof families / sizeof *families;

/* Of any model: each param within a factor of 8 of the spec's value; h up to 40 times the spec's, or up to that and
 * some signs changed */
real draw_near(const struct tuned *m, real *p)
{
	const bool odd = below(4) == 0;
	for (int k = 0; k < m->model->params; k++)
		p[k] = m->model->param_values[k] * spread(-0.9, 0.9) * (odd && below(3) == 0 ? -1 : 1);
	return m->model->h * spread(-3, odd ? 0 : below(4) ? 1 : 1.6);
}
