/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The smooth models' equations as functions that a peer compiles together with its stepper, as plgen's step is: what a
 * user of that method writes by hand. Each file that includes this has its own copies. A peer is instantiated for every
 * name of EQUATIONS, and goes through NAME_rhs for a problem that is not in it. tests/charts/peers.c holds them and
 * their derivatives against NAME_rhs; truth.c has them in long double.
 *
 *     NAME_slopes(t, y, f)           f = y' at y = n coordinates, n velocities
 *     NAME_jacobian(t, y, Jq, Jv)    derivatives of the accelerations, n x n, row-major */
#ifndef EQUATIONS_H
#define EQUATIONS_H

#include <math.h>

#define INLINE static inline __attribute__((always_inline))
/* double, or what includes this has defined before; and a constant of it */
#ifndef NUMBER
#define NUMBER double
#define EXACTLY(x) (x)
#else
#include <tgmath.h>
#define EXACTLY(x) x##L
#endif

/* name, coordinates */
#define EQUATIONS(X) \
	X(pendulum, 1) X(vanderpol, 1) X(vanderpol_stiff, 1) X(vanderpol_stiffer, 1) X(quad2dof, 2) \
	X(duffing, 1) X(mathieu, 1) X(henon_heiles, 2) X(coupled_vanderpol, 2) X(double_pendulum, 2) \
	X(rayleigh, 1) X(duffing_pair, 2) X(spherical_pendulum, 2)
/* Those of them whose accelerations depend on time and coordinates alone */
#define EQUATIONS_WITHOUT_VELOCITY(X) X(pendulum, 1) X(quad2dof, 2) X(henon_heiles, 2)

INLINE void pendulum_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	(void)t;
	f[0] = y[1];
	f[1] = -sin(y[0]);
}

INLINE void pendulum_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)t;
	Jq[0] = -cos(y[0]);
	Jv[0] = 0.0;
}

INLINE void relaxation(NUMBER mu, const NUMBER *y, NUMBER *f)
{
	f[0] = y[1];
	f[1] = mu * (1.0 - y[0] * y[0]) * y[1] - y[0];
}

INLINE void relaxation_jacobian(NUMBER mu, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	Jq[0] = -2.0 * mu * y[0] * y[1] - 1.0;
	Jv[0] = mu * (1.0 - y[0] * y[0]);
}

INLINE void vanderpol_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	(void)t;
	relaxation(1.0, y, f);
}

INLINE void vanderpol_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)t;
	relaxation_jacobian(1.0, y, Jq, Jv);
}

INLINE void vanderpol_stiff_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	(void)t;
	relaxation(100.0, y, f);
}

INLINE void vanderpol_stiff_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)t;
	relaxation_jacobian(100.0, y, Jq, Jv);
}

INLINE void vanderpol_stiffer_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	(void)t;
	relaxation(1000.0, y, f);
}

INLINE void vanderpol_stiffer_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)t;
	relaxation_jacobian(1000.0, y, Jq, Jv);
}

INLINE void henon_heiles_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	(void)t;
	f[0] = y[2];
	f[1] = y[3];
	f[2] = -y[0] - 2.0 * y[0] * y[1];
	f[3] = -y[1] - y[0] * y[0] + y[1] * y[1];
}

INLINE void henon_heiles_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)t;
	Jq[0] = -1.0 - 2.0 * y[1];
	Jq[1] = Jq[2] = -2.0 * y[0];
	Jq[3] = -1.0 + 2.0 * y[1];
	Jv[0] = Jv[1] = Jv[2] = Jv[3] = 0.0;
}

INLINE void quad2dof_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	henon_heiles_slopes(t, y, f);
}

INLINE void quad2dof_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	henon_heiles_jacobian(t, y, Jq, Jv);
}

INLINE void duffing_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	f[0] = y[1];
	f[1] = EXACTLY(0.5) * cos(EXACTLY(1.4) * t) - EXACTLY(0.2) * y[1] - y[0] * (1.0 + y[0] * y[0]);
}

INLINE void duffing_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)t;
	Jq[0] = -1.0 - 3.0 * y[0] * y[0];
	Jv[0] = -EXACTLY(0.2);
}

INLINE void mathieu_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	f[0] = y[1];
	f[1] = -EXACTLY(0.1) * y[1] - (1.0 - EXACTLY(0.4) * cos(2.0 * t)) * y[0];
}

INLINE void mathieu_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)y;
	Jq[0] = EXACTLY(0.4) * cos(2.0 * t) - 1.0;
	Jv[0] = -EXACTLY(0.1);
}

INLINE void coupled_vanderpol_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	const NUMBER pull = EXACTLY(0.3) * (y[1] - y[0]);
	(void)t;
	f[0] = y[2];
	f[1] = y[3];
	f[2] = (1.0 - y[0] * y[0]) * y[2] - y[0] + pull;
	f[3] = (1.0 - y[1] * y[1]) * y[3] - EXACTLY(1.2) * y[1] - pull;
}

INLINE void coupled_vanderpol_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)t;
	Jq[0] = -2.0 * y[0] * y[2] - 1.3;
	Jq[1] = Jq[2] = EXACTLY(0.3);
	Jq[3] = -2.0 * y[1] * y[3] - 1.5;
	Jv[0] = 1.0 - y[0] * y[0];
	Jv[1] = Jv[2] = 0.0;
	Jv[3] = 1.0 - y[1] * y[1];
}

/* Two angles' functions are enough: those of their difference are products */
INLINE void double_pendulum_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	const NUMBER sa = sin(y[0]), ca = cos(y[0]), sb = sin(y[1]), cb = cos(y[1]);
	const NUMBER s = sa * cb - ca * sb, c = ca * cb + sa * sb;
	const NUMBER push = s * y[3] * y[3] + 2.0 * sa, pull = s * y[2] * y[2] - sb, mass = 1.0 / (2.0 - c * c);
	(void)t;
	f[0] = y[2];
	f[1] = y[3];
	f[2] = -(push + c * pull) * mass;
	f[3] = (2.0 * pull + c * push) * mass;
}

INLINE void double_pendulum_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	const NUMBER sa = sin(y[0]), ca = cos(y[0]), sb = sin(y[1]), cb = cos(y[1]);
	const NUMBER s = sa * cb - ca * sb, c = ca * cb + sa * sb, mass = 1.0 / (2.0 - c * c);
	const NUMBER v2 = y[2] * y[2], w2 = y[3] * y[3], push = s * w2 + 2.0 * sa, pull = s * v2 - sb;
	const NUMBER a = -(push + c * pull) * mass, b = (2.0 * pull + c * push) * mass;
	/* of the difference of the angles, in what stands over `mass` and in `mass` itself */
	const NUMBER turn = 2.0 * s * c * mass, a_d = -(c * w2 - s * pull + c * c * v2) * mass - a * turn,
		b_d = (2.0 * c * v2 - s * push + c * c * w2) * mass - b * turn;
	(void)t;
	Jq[0] = a_d - 2.0 * ca * mass;
	Jq[1] = -a_d + c * cb * mass;
	Jq[2] = b_d + 2.0 * c * ca * mass;
	Jq[3] = -b_d - 2.0 * cb * mass;
	Jv[0] = -2.0 * c * s * y[2] * mass;
	Jv[1] = -2.0 * s * y[3] * mass;
	Jv[2] = 4.0 * s * y[2] * mass;
	Jv[3] = 2.0 * c * s * y[3] * mass;
}

INLINE void rayleigh_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	(void)t;
	f[0] = y[1];
	f[1] = (1.0 - y[1] * y[1]) * y[1] - y[0];
}

INLINE void rayleigh_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)t;
	Jq[0] = -1.0;
	Jv[0] = 1.0 - 3.0 * y[1] * y[1];
}

INLINE void duffing_pair_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	const NUMBER pull = EXACTLY(0.5) * (y[1] - y[0]);
	f[0] = y[2];
	f[1] = y[3];
	f[2] = EXACTLY(0.5) * cos(EXACTLY(1.2) * t) + pull - EXACTLY(0.1) * y[2] * sqrt(y[2] * y[2] + EXACTLY(0.01)) -
	       y[0] * (1.0 + y[0] * y[0]);
	f[3] = -pull - EXACTLY(0.1) * y[3] * sqrt(y[3] * y[3] + EXACTLY(0.01)) - y[1] * (1.0 + y[1] * y[1]);
}

INLINE void duffing_pair_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	(void)t;
	for (int i = 0; i < 2; i++) {
		const NUMBER v2 = y[2 + i] * y[2 + i];
		Jq[3 * i] = -1.5 - 3.0 * y[i] * y[i];
		Jv[3 * i] = -EXACTLY(0.1) * (2.0 * v2 + EXACTLY(0.01)) / sqrt(v2 + EXACTLY(0.01));
	}
	Jq[1] = Jq[2] = EXACTLY(0.5);
	Jv[1] = Jv[2] = 0.0;
}

INLINE void spherical_pendulum_slopes(NUMBER t, const NUMBER *y, NUMBER *f)
{
	const NUMBER s = sin(y[0]), c = cos(y[0]);
	(void)t;
	f[0] = y[2];
	f[1] = y[3];
	f[2] = s * (c * y[3] * y[3] - 1.0);
	f[3] = -2.0 * y[2] * y[3] * c / s;
}

INLINE void spherical_pendulum_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv)
{
	const NUMBER s = sin(y[0]), c = cos(y[0]);
	(void)t;
	Jq[0] = (c * c - s * s) * y[3] * y[3] - c;
	Jq[1] = Jq[3] = 0.0;
	Jq[2] = 2.0 * y[2] * y[3] / (s * s);
	Jv[0] = 0.0;
	Jv[1] = 2.0 * s * c * y[3];
	Jv[2] = -2.0 * y[3] * c / s;
	Jv[3] = -2.0 * y[2] * c / s;
}

#endif
