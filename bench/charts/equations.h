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

/* A model of one coordinate: its acceleration, and that by x and by v */
#define ONE(NAME, ACCELERATION, BY_X, BY_V) \
enum { NAME##_coordinates = 1 }; \
INLINE void NAME##_slopes(NUMBER t, const NUMBER *y, NUMBER *f) \
{ \
	const NUMBER x = y[0], v = y[1]; \
	(void)t, (void)x, (void)v; \
	f[0] = y[1]; \
	f[1] = ACCELERATION; \
} \
INLINE void NAME##_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv) \
{ \
	const NUMBER x = y[0], v = y[1]; \
	(void)t, (void)x, (void)v; \
	Jq[0] = BY_X; \
	Jv[0] = BY_V; \
}
/* Of two, x and z with velocities v and w: what both accelerations share, as statements; these; what their derivatives
 * share beside; Jq, Jv */
#define TWO(NAME, SHARED, ONE_IS, OTHER_IS, SHARED_BY, XX, XZ, ZX, ZZ, VV, VW, WV, WW) \
enum { NAME##_coordinates = 2 }; \
INLINE void NAME##_slopes(NUMBER t, const NUMBER *y, NUMBER *f) \
{ \
	const NUMBER x = y[0], z = y[1], v = y[2], w = y[3]; \
	(void)t, (void)x, (void)z, (void)v, (void)w; \
	SHARED \
	f[0] = v; \
	f[1] = w; \
	f[2] = ONE_IS; \
	f[3] = OTHER_IS; \
} \
INLINE void NAME##_jacobian(NUMBER t, const NUMBER *y, NUMBER *Jq, NUMBER *Jv) \
{ \
	const NUMBER x = y[0], z = y[1], v = y[2], w = y[3]; \
	(void)t, (void)x, (void)z, (void)v, (void)w; \
	SHARED_BY \
	Jq[0] = XX, Jq[1] = XZ, Jq[2] = ZX, Jq[3] = ZZ; \
	Jv[0] = VV, Jv[1] = VW, Jv[2] = WV, Jv[3] = WW; \
}
#define LET const NUMBER

ONE(pendulum, -sin(x), -cos(x), 0.0)
#define RELAXATION(NAME, MU) ONE(NAME, MU * (1.0 - x * x) * v - x, -2.0 * MU * x * v - 1.0, MU * (1.0 - x * x))
RELAXATION(vanderpol, 1.0)
RELAXATION(vanderpol_stiff, 100.0)
RELAXATION(vanderpol_stiffer, 1000.0)
ONE(rayleigh, (1.0 - v * v) * v - x, -1.0, 1.0 - 3.0 * v * v)
ONE(duffing, EXACTLY(0.5) * cos(EXACTLY(1.4) * t) - EXACTLY(0.2) * v - x * (1.0 + x * x), -1.0 - 3.0 * x * x,
    -EXACTLY(0.2))
ONE(mathieu, -EXACTLY(0.1) * v - (1.0 - EXACTLY(0.4) * cos(2.0 * t)) * x, EXACTLY(0.4) * cos(2.0 * t) - 1.0,
    -EXACTLY(0.1))

#define OF_HENON_HEILES(NAME) TWO(NAME, , -x - 2.0 * x * z, -z - x * x + z * z, \
    , -1.0 - 2.0 * z, -2.0 * x, -2.0 * x, -1.0 + 2.0 * z, 0.0, 0.0, 0.0, 0.0)
OF_HENON_HEILES(henon_heiles)
OF_HENON_HEILES(quad2dof)
TWO(coupled_vanderpol, LET pull = EXACTLY(0.3) * (z - x);,
    (1.0 - x * x) * v - x + pull, (1.0 - z * z) * w - EXACTLY(1.2) * z - pull,
    , -2.0 * x * v - 1.3, EXACTLY(0.3), EXACTLY(0.3), -2.0 * z * w - 1.5, 1.0 - x * x, 0.0, 0.0, 1.0 - z * z)
#define DRAG(V) EXACTLY(0.1) * V * sqrt(V * V + EXACTLY(0.01))
#define DRAG_BY(V) -EXACTLY(0.1) * (2.0 * (V * V) + EXACTLY(0.01)) / sqrt(V * V + EXACTLY(0.01))
TWO(duffing_pair, LET pull = EXACTLY(0.5) * (z - x);,
    EXACTLY(0.5) * cos(EXACTLY(1.2) * t) + pull - DRAG(v) - x * (1.0 + x * x), -pull - DRAG(w) - z * (1.0 + z * z),
    , -1.5 - 3.0 * x * x, EXACTLY(0.5), EXACTLY(0.5), -1.5 - 3.0 * z * z, DRAG_BY(v), 0.0, 0.0, DRAG_BY(w))
TWO(spherical_pendulum, LET s = sin(x); LET c = cos(x);, s * (c * w * w - 1.0), -2.0 * v * w * c / s,
    LET s = sin(x); LET c = cos(x);, (c * c - s * s) * w * w - c, 0.0, 2.0 * v * w / (s * s), 0.0,
    0.0, 2.0 * s * c * w, -2.0 * w * c / s, -2.0 * v * c / s)

/* Two angles' functions are enough: those of their difference are products. turn, by_x, by_z: what the difference does
 * in what stands over `mass` and in `mass` itself */
#define TURNED LET sx = sin(x); LET cx = cos(x); LET sz = sin(z); LET cz = cos(z); \
	LET s = sx * cz - cx * sz; LET c = cx * cz + sx * sz; LET mass = 1.0 / (2.0 - c * c);
TWO(double_pendulum, TURNED LET push = s * w * w + 2.0 * sx; LET pull = s * v * v - sz;,
    -(push + c * pull) * mass, (2.0 * pull + c * push) * mass,
    TURNED LET v2 = v * v; LET w2 = w * w; LET push = s * w2 + 2.0 * sx; LET pull = s * v2 - sz;
    LET turn = 2.0 * s * c * mass;
    LET by_x = -(c * w2 - s * pull + c * c * v2) * mass + (push + c * pull) * mass * turn;
    LET by_z = (2.0 * c * v2 - s * push + c * c * w2) * mass - (2.0 * pull + c * push) * mass * turn;,
    by_x - 2.0 * cx * mass, -by_x + c * cz * mass, by_z + 2.0 * c * cx * mass, -by_z - 2.0 * cz * mass,
    -2.0 * c * s * v * mass, -2.0 * s * w * mass, 4.0 * s * v * mass, 2.0 * c * s * w * mass)

#endif
