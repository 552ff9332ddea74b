/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "systems.h"
#include "quadrant.h"

#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

static const real nowhere[HAND_MOST];

/* The operator by default of a model whose remainder has no linear part at the origin. */
static void at_origin(const struct system *s, int which, real *A)
{
	(void)which;
	jacobian(s, 0, nowhere, A);
}

static void at_start(const struct system *s, int which, real *A)
{
	(void)which;
	jacobian(s, 0, s->start, A);
}

/* ---- models/ ---- */

static void pendulum(real t, const real *y, const real *u, real *dydt)
{
	(void)t, (void)u;
	dydt[0] = y[1];
	dydt[1] = -sin_of(y[0]);
}

/* A bank at x = -1/2, 1/2. */
static void pendulum_bank_linear(const struct system *s, int which, real *A)
{
	const real y[2] = {which == 0 ? -0.5L : 0.5L};
	jacobian(s, 0, y, A);
}

static int pendulum_bank_choose(real t, const real *y)
{
	(void)t;
	return y[0] <= -0.5L ? 0 : 1;
}

static void vanderpol_with(real mu, const real *y, real *dydt)
{
	dydt[0] = y[1];
	dydt[1] = mu * (1 - y[0] * y[0]) * y[1] - y[0];
}

static void vanderpol(real t, const real *y, const real *u, real *dydt)
{
	(void)t, (void)u;
	vanderpol_with(1, y, dydt);
}

static void vanderpol_stiff(real t, const real *y, const real *u, real *dydt)
{
	(void)t, (void)u;
	vanderpol_with(100, y, dydt);
}

static void quad2dof(real t, const real *y, const real *u, real *dydt)
{
	(void)t, (void)u;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = -y[0] - 2 * y[0] * y[1];
	dydt[3] = -y[1] - y[0] * y[0] + y[1] * y[1];
}

static void duffing(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = 0.5L * cos_of(1.4L * t) - 0.2L * y[1] - y[0] - y[0] * y[0] * y[0];
}

static void duffing_loads(real t, real *z)
{
	z[0] = cos_of(1.4L * t);
	z[1] = sin_of(1.4L * t);
}

/* z = cos wt, sin wt behind `states` others */
static void wave_rows(real *A, int states, int size, real w)
{
	A[states * size + states + 1] = -w;
	A[(states + 1) * size + states] = w;
}

static void duffing_linear(const struct system *s, int which, real *A)
{
	at_origin(s, which, A);
	A[1 * 4 + 2] = 0.5L;
	wave_rows(A, 2, 4, 1.4L);
}

static void mathieu(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[1];
	dydt[1] = -0.1L * y[1] - (1 - 0.4L * cos_of(2 * t)) * y[0];
}

/* At t = pi/2; without an operator statement what varies in time is left over. */
static void mathieu_linear(const struct system *s, int which, real *A)
{
	(void)which;
	A[0 * 2 + 1] = 1;
	A[1 * 2 + 0] = strcmp(s->name, "mathieu") == 0 ? -1.4L : -1;
	A[1 * 2 + 1] = -0.1L;
}

/* A bank at t = 0, 1/2, 1, 2. */
static const real mathieu_times[] = {0, 0.5L, 1, 2};

static void mathieu_bank_linear(const struct system *s, int which, real *A)
{
	jacobian(s, mathieu_times[which], nowhere, A);
}

static int mathieu_bank_choose(real t, const real *y)
{
	(void)y;
	return t <= 0 ? 0 : t <= 0.5L ? 1 : t <= 1 ? 2 : 3;
}

/* ---- specs of this folder ---- */

static void held(real t, const real *y, const real *u, real *dydt)
{
	const real x = y[0], q = y[1], v = y[2], p = y[3];
	(void)t;
	dydt[0] = v;
	dydt[1] = p;
	dydt[2] = (2 * u[0] - u[1] - 0.3L * v - 40 * x - 200 * x * x * x + 10 * q) / 1.5L;
	dydt[3] = 3 * u[1] + 0.5L * u[0] + 0.2L * u[0] * q * p - 0.2L * p - 25 * q + 10 * x - 30 * powl(q - x, 3);
}

static void ramped(real t, const real *y, const real *u, real *dydt)
{
	const real x = y[0], q = y[1], v = y[2], p = y[3];
	(void)t;
	dydt[0] = v;
	dydt[1] = p;
	dydt[2] = -(0.3L * (v - u[2]) + 400 * (x - u[0]) + 2000 * powl(x - u[0], 3) + 90 * (x - q)) / 20;
	dydt[3] = 0.5L * u[0] - 0.2L * (p - u[3]) - 25 * (q - u[1]) - 9 * (q - x) - 0.1L * u[2] * q * q;
}

static void thermal(real t, const real *y, const real *u, real *dydt)
{
	const real x = y[0], f = y[1], T = y[2], v = y[3];
	(void)u;
	dydt[0] = v;
	dydt[1] = 50 * (v - f / 4 - 0.05L * f * f * f);
	dydt[2] = 0.2L + 0.1L * f * f - 0.5L * T;
	dydt[3] = (3 * cos_of(4 * t) - 30 * x - f) / 2;
}

static void thermal_loads(real t, real *z)
{
	z[0] = cos_of(4 * t);
	z[1] = sin_of(4 * t);
	z[2] = 1;
}

static void thermal_linear(const struct system *s, int which, real *A)
{
	at_origin(s, which, A);
	A[3 * 7 + 4] = 1.5L;
	A[2 * 7 + 6] = 0.2L;
	wave_rows(A, 4, 7, 4);
}

static void coupled(real t, const real *y, const real *u, real *dydt)
{
	const real x = y[0], q = y[1], v = y[2], p = y[3];
	(void)u;
	const real spring = 5 * powl(x - q, 3), damper = 0.4L * powl(v - p, 3);
	const real a = sin_of(3 * t) - (0.1L * v + damper + 30 * x + spring),
		b = damper + spring - 0.2L * p - 20 * q - 0.3L * x * p;
	dydt[0] = v;
	dydt[1] = p;
	dydt[2] = (a - 0.5L * b) / 1.75L;                   /* the inverse of [2, 0.5; 0.5, 1] */
	dydt[3] = (2 * b - 0.5L * a) / 1.75L;
}

static void coupled_loads(real t, real *z)
{
	z[0] = cos_of(3 * t);
	z[1] = sin_of(3 * t);
}

static void coupled_columns(real *A)
{
	A[2 * 6 + 5] = 1 / 1.75L;
	A[3 * 6 + 5] = -0.5L / 1.75L;
	wave_rows(A, 4, 6, 3);
}

static void coupled_linear(const struct system *s, int which, real *A)
{
	at_origin(s, which, A);
	coupled_columns(A);
}

static void coupled_at_linear(const struct system *s, int which, real *A)
{
	at_start(s, which, A);
	coupled_columns(A);
}

/* Only x fixed, at 1/2: of what the other names enter only the constant part of each entry of the Jacobian counts. */
static void coupled_part_linear(const struct system *s, int which, real *A)
{
	at_origin(s, which, A);
	coupled_columns(A);
	/* 5 (x - y)^3: 15 (x - y)^2 = 15/4 - 15 y + 15 y^2; 0.3 x y': 0.15 */
	A[2 * 6 + 0] -= 3.75L * 1.5L / 1.75L;
	A[2 * 6 + 1] += 3.75L * 1.5L / 1.75L;
	A[3 * 6 + 0] += 3.75L * 2.5L / 1.75L;
	A[3 * 6 + 1] -= 3.75L * 2.5L / 1.75L;
	A[2 * 6 + 3] += 0.5L * 0.15L / 1.75L;
	A[3 * 6 + 3] -= 2 * 0.15L / 1.75L;
}

/* ---- a mass in a rotating frame that spins up ---- */

static void rotor_at(real w, real a, real t, const real *y, real *dydt)
{
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = -0.1L * y[2] - (40 - w * w) * y[0] + 2 * w * y[3] + a * y[1];
	dydt[3] = 3 * cos_of(2 * t) - 0.1L * y[3] - (60 - w * w) * y[1] - 2 * w * y[2] - a * y[0];
}

static void rotor(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	rotor_at(6 * (1 - expl(-t)), 6 * expl(-t), t, y, dydt);
}

static const real rotor_speeds[] = {0, 2, 4, 5};

static int rotor_choose(real t, const real *y)
{
	(void)y;
	for (int i = 0; i < 3; i++)
		if (rotor_speeds[i] >= 6 * (1 - expl(-t)))
			return i;
	return 3;
}

static void rotor_loads(real t, real *z)
{
	z[0] = cos_of(2 * t);
	z[1] = sin_of(2 * t);
}

static void rotor_linear(const struct system *s, int which, real *A)
{
	(void)s;
	for (int j = 0; j < 4; j++) {
		real y[4] = {0}, f[4];
		y[j] = 1;
		rotor_at(rotor_speeds[which], 0, 0, y, f);
		f[3] -= 3;
		for (int i = 0; i < 4; i++)
			A[i * 6 + j] = f[i];
	}
	A[3 * 6 + 4] = 3;
	wave_rows(A, 4, 6, 2);
}

/* ---- loads of every kind ---- */

static void growth(real t, const real *y, const real *u, real *dydt)
{
	(void)u;
	dydt[0] = y[2];
	dydt[1] = y[3];
	dydt[2] = 0.3L * t * expl(-0.2L * t) * cos_of(2 * t) + 0.1L * t - 0.1L * y[2] - 4 * y[0] - y[0] * y[0] * y[0];
	dydt[3] = expl(0.1L * t) - 1.5L - 3 * y[1] - 0.2L * y[2] * y[1] * y[1];
}

/* e^{-t/5} (cos 2t, sin 2t), the same times t, 1, t, e^{t/10} */
static void growth_loads(real t, real *z)
{
	const real size = expl(-0.2L * t);
	z[0] = size * cos_of(2 * t);
	z[1] = size * sin_of(2 * t);
	z[2] = t * z[0];
	z[3] = t * z[1];
	z[4] = 1;
	z[5] = t;
	z[6] = expl(0.1L * t);
}

static void growth_linear(const struct system *s, int which, real *A)
{
	enum { SIZE = 11, Z = 4 };
	static const struct { int row, column; real value; } entries[] = {
		{2, Z + 2, 0.3L}, {2, Z + 5, 0.1L}, {3, Z + 6, 1}, {3, Z + 4, -1.5L},
		{Z, Z, -0.2L}, {Z, Z + 1, -2}, {Z + 1, Z, 2}, {Z + 1, Z + 1, -0.2L},
		{Z + 2, Z, 1}, {Z + 2, Z + 2, -0.2L}, {Z + 2, Z + 3, -2}, {Z + 3, Z + 1, 1}, {Z + 3, Z + 2, 2},
			{Z + 3, Z + 3, -0.2L},
		{Z + 5, Z + 4, 1}, {Z + 6, Z + 6, 0.1L}};
	at_origin(s, which, A);
	for (size_t i = 0; i < sizeof entries / sizeof *entries; i++)
		A[entries[i].row * SIZE + entries[i].column] = entries[i].value;
}

/* ---- eight masses ---- */

enum { MASSES = 8 };

/* x <- M^-1 x; M has blocks of two at most */
static void chain_inverse(real *x)
{
	/* a, b, d of [a, b; b, d] */
	static const real block[4][3] = {{2, 0.3L, 1.5L}, {1, 0.2L, 1}, {1, 0, 1.2L}, {0.8L, 0.1L, 1}};
	for (int i = 0; i < 4; i++) {
		const real a = block[i][0], b = block[i][1], d = block[i][2], det = a * d - b * b, p = x[2 * i],
			q = x[2 * i + 1];
		x[2 * i] = (d * p - b * q) / det;
		x[2 * i + 1] = (a * q - b * p) / det;
	}
}

static real chain_K(const real *x, int i)
{
	static const real own[MASSES] = {90, 80, 80, 80, 80, 80, 80, 60};
	return own[i] * x[i] - 40 * ((i > 0 ? x[i - 1] : 0) + (i < MASSES - 1 ? x[i + 1] : 0));
}

static const real chain_f[MASSES] = {1, 0, 0, -2, 0, 0, 0, 0.5L}, chain_b[MASSES] = {0, 0, 3, 0, 0, -1, 0, 0};

static void chain(real t, const real *y, const real *u, real *dydt)
{
	const real *v = y + MASSES;
	real *a = dydt + MASSES;
	for (int i = 0; i < MASSES; i++) {
		dydt[i] = v[i];
		a[i] = chain_f[i] * (cos_of(3 * t) + 0.5L * v[1] * y[0]) + chain_b[i] * u[0] - 0.001L * chain_K(v, i) -
			   chain_K(y, i) - 30 * (y[i] - sin_of(y[i])) - t * y[i];
	}
	chain_inverse(a);
	for (int i = 0; i < MASSES; i++)
		a[i] -= 0.2L * v[i];
}

static void chain_loads(real t, real *z)
{
	z[0] = cos_of(3 * t);
	z[1] = sin_of(3 * t);
}

/* 30 q is a linear term as written; w = t/2 */
static const real chain_speeds[] = {0, 1, 2};

static int chain_choose(real t, const real *y)
{
	(void)y;
	return t / 2 <= 0 ? 0 : t / 2 <= 1 ? 1 : 2;
}

static void chain_linear(const struct system *s, int which, real *A)
{
	enum { STATES = 2 * MASSES, SIZE = STATES + 4 };
	at_origin(s, which, A);
	for (int j = 0; j <= MASSES; j++) {
		real x[MASSES] = {0};
		if (j < MASSES)
			x[j] = -30 - 2 * chain_speeds[which];
		else
			memcpy(x, chain_f, sizeof x);
		chain_inverse(x);
		for (int i = 0; i < MASSES; i++)
			A[(MASSES + i) * SIZE + (j < MASSES ? j : STATES)] += x[i];
	}
	wave_rows(A, STATES, SIZE, 3);
}

/* ---- every function ---- */

static real deadzone(real x, real lo, real hi)
{
	return x < lo ? x - lo : x > hi ? x - hi : 0;
}

static real table_of_spec(real x)
{
	return x < 0 ? 0.5L * x + 0.5L : 1.5L * x + 0.5L;
}

static real sign(real x)
{
	return (x > 0) - (x < 0);
}

static void functions(real t, const real *y, const real *u, real *dydt)
{
	const real a = y[0], b = y[1], c = y[2], da = y[3];
	(void)t, (void)u;
	dydt[0] = y[3];
	dydt[1] = y[4];
	dydt[2] = y[5];
	dydt[3] = -(4 * a + 0.3L * sin_of(b) * cos_of(a) + 0.1L * tanl(b / 2) + 0.2L * expl(-a * a) - logl(2 + b) +
		0.1L * fabsl(da) * da +
				0.1L * powl(2 + a, 1.5L));
	dydt[4] = -(9 * b + sqrtl(2 + a) + 0.3L * fabsl(b + 3) * a + 0.2L * sign(b - 3) + sinhl(0.3L * a) -
		coshl(0.2L * b) + tanhl(c) +
				(a > b ? a * a : a * b) + 1 / (1 + a * a));
	dydt[5] = -(c + asinl(0.2L * a) + 0.2L * acosl(0.1L * b) + atanl(c) / 5 + 0.3L * atan2l(a + 3,
		b + 2) + 0.2L * fminl(a, b) * c - 0.2L * fmaxl(b, c) * a +
				deadzone(c, -0.5L, 0.5L) * a + 0.3L * fminl(0.4L,
				fmaxl(-0.3L, a)) * b + 0.1L * table_of_spec(b) * c +
					0.1L * powl(2, a));
}

static void functions_linear(const struct system *s, int which, real *A)
{
	(void)s, (void)which;
	for (int i = 0; i < 3; i++)
		A[i * 6 + 3 + i] = 1;
	A[3 * 6 + 0] = -4;
	A[4 * 6 + 1] = -9;
	A[5 * 6 + 2] = -1;
}

/* ---- the Piecewise-Laplace method: etd1 whose operator has only each coordinate's own terms ---- */

static void own_terms(const struct system *s, const int *coordinate, real *A)
{
	for (int i = 0; i < s->states; i++)
		for (int j = 0; j < s->states; j++)
			if (coordinate[i] != coordinate[j])
				A[i * size_of(s) + j] = 0;
}

static void held_own(const struct system *s, int which, real *A)
{
	at_origin(s, which, A);
	own_terms(s, (const int[]){0, 1, 0, 1}, A);
}

static void coupled_own(const struct system *s, int which, real *A)
{
	coupled_linear(s, which, A);
	own_terms(s, (const int[]){0, 1, 0, 1}, A);
}

static void thermal_own(const struct system *s, int which, real *A)
{
	thermal_linear(s, which, A);
	own_terms(s, (const int[]){0, 1, 2, 0}, A);
}

/* ---- the table ---- */

const struct system systems[] = {
	{.name = "pendulum", .states = 2, .start = {1.0472L}, .equations = pendulum, .linear = at_origin},
	{.name = "pendulum_bank", .states = 2, .start = {1.0472L}, .equations = pendulum,
			.linear = pendulum_bank_linear,
		.operators = 2,
	 .choose = pendulum_bank_choose},
	{.name = "vanderpol", .states = 2, .start = {2}, .equations = vanderpol, .linear = at_origin},
	{.name = "vanderpol_stiff", .states = 2, .start = {2}, .equations = vanderpol_stiff, .linear = at_start},
	{.name = "quad2dof", .states = 4, .start = {0.1L, 0.1L}, .equations = quad2dof, .linear = at_origin},
	{.name = "duffing", .states = 2, .loads = 2, .start = {1}, .equations = duffing, .loads_at = duffing_loads,
		.linear = duffing_linear},
	{.name = "duffing_left", .states = 2, .start = {1}, .equations = duffing, .linear = at_origin},
	{.name = "mathieu", .states = 2, .start = {1}, .equations = mathieu, .linear = mathieu_linear},
	{.name = "mathieu_default", .states = 2, .start = {1}, .equations = mathieu, .linear = mathieu_linear},
	{.name = "mathieu_bank", .states = 2, .start = {1}, .equations = mathieu, .linear = mathieu_bank_linear,
		.operators = 4,
	 .choose = mathieu_bank_choose},
	{.name = "held", .states = 4, .inputs = 2, .start = {0.3L, 0, 0, -0.2L}, .equations = held,
			.linear = at_origin},
	{.name = "ramped", .states = 4, .inputs = 2, .start = {0.1L, 0, 0, -0.2L}, .equations = ramped,
		.linear = at_origin},
	{.name = "thermal", .states = 4, .loads = 3, .start = {0.1L, 0.5L, 0.3L, 0}, .equations = thermal,
		.loads_at = thermal_loads,
	 .linear = thermal_linear},
	{.name = "coupled", .states = 4, .loads = 2, .start = {0.5L, -0.2L, 1, 0}, .equations = coupled,
		.loads_at = coupled_loads,
	 .linear = coupled_linear},
	{.name = "coupled_at", .states = 4, .loads = 2, .start = {0.5L, -0.2L, 1, 0}, .equations = coupled,
		.loads_at = coupled_loads,
	 .linear = coupled_at_linear},
	{.name = "coupled_part", .states = 4, .loads = 2, .start = {0.5L, -0.2L, 1, 0}, .equations = coupled,
		.loads_at = coupled_loads,
	 .linear = coupled_part_linear},
	{.name = "rotor", .states = 4, .loads = 2, .start = {0.3L, -0.1L, 0, 0.5L}, .equations = rotor,
		.loads_at = rotor_loads,
	 .linear = rotor_linear, .operators = 4, .choose = rotor_choose},
	{.name = "held_pl", .states = 4, .inputs = 2, .start = {0.3L, 0, 0, -0.2L}, .equations = held,
			.linear = held_own},
	{.name = "ramped_pl", .states = 4, .inputs = 2, .start = {0.1L, 0, 0, -0.2L}, .equations = ramped,
		.linear = held_own},
	{.name = "coupled_pl", .states = 4, .loads = 2, .start = {0.5L, -0.2L, 1, 0}, .equations = coupled,
		.loads_at = coupled_loads,
	 .linear = coupled_own},
	{.name = "thermal_pl", .states = 4, .loads = 3, .start = {0.1L, 0.5L, 0.3L, 0}, .equations = thermal,
		.loads_at = thermal_loads,
	 .linear = thermal_own},
	{.name = "growth", .states = 4, .loads = 7, .start = {0.2L, 0, 0, 0.3L}, .equations = growth,
		.loads_at = growth_loads,
	 .linear = growth_linear},
	{.name = "growth_left", .states = 4, .start = {0.2L, 0, 0, 0.3L}, .equations = growth, .linear = at_origin},
	{.name = "chain", .states = 16, .loads = 2, .inputs = 1,
		.start = {0.3L, 0, 0, 0, -0.2L, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1}, .equations = chain,
	 .loads_at = chain_loads, .linear = chain_linear},
	{.name = "chain_bank", .states = 16, .loads = 2, .inputs = 1,
		.start = {0.3L, 0, 0, 0, -0.2L, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 1},
	 .equations = chain, .loads_at = chain_loads, .linear = chain_linear, .operators = 3, .choose = chain_choose},
	{.name = "functions", .states = 6, .start = {0.1L, 0.2L, 0.3L, 0.2L, 0, 0.1L}, .equations = functions,
		.linear = functions_linear},
	{.name = "functions_at", .states = 6, .start = {0.1L, 0.2L, 0.3L, 0.2L, 0, 0.1L}, .equations = functions,
		.linear = at_start},
};

const int systems_count = sizeof systems / sizeof *systems;

const struct system *system_of(const char *name)
{
	for (int i = 0; i < systems_count; i++)
		if (strcmp(systems[i].name, name) == 0)
			return &systems[i];
	fprintf(stderr, "no equations for %s\n", name);
	abort();
}
