/* SPDX-License-Identifier: GPL-3.0-or-later */
/*
 * The map of the emitted step itself: its code compiled with a type of 113 bits, in which products and sums of its
 * constants are exact or nearly so, and run on unit vectors. Its eigenvalues are set against e^{p h} of the poles,
 * known by hand.
 */
#include "tap.h"

#include <float.h>
#include <math.h>
#include <stdint.h>
#include <stdio.h>
#include <string.h>

#if defined __SIZEOF_FLOAT128__ || LDBL_MANT_DIG == 113

#ifdef __SIZEOF_FLOAT128__
typedef __float128 wide;
#else
typedef long double wide;
#endif

struct map {
	const char *name;
	void (*step)(wide *y);
	double amplitude, phase;            /* of --explain=json: per step, where they are largest */
};

/* What is accumulated in two words has room enough in one of these. */
static wide wide_accumulate(wide sum, wide term, wide small, wide *rest)
{
	*rest = 0;
	return sum + (term + small);
}

#include "map_steps.h"

enum { N = 4, MAPS = sizeof maps / sizeof *maps };

/* ---- complex numbers of this type ---- */

struct complex { wide re, im; };

static struct complex plus(struct complex a, struct complex b)
{
	return (struct complex){ a.re + b.re, a.im + b.im };
}

static struct complex times(struct complex a, struct complex b)
{
	return (struct complex){ a.re * b.re - a.im * b.im, a.re * b.im + a.im * b.re };
}

static struct complex over(struct complex a, struct complex b)
{
	const wide size = b.re * b.re + b.im * b.im;
	return (struct complex){ (a.re * b.re + a.im * b.im) / size, (a.im * b.re - a.re * b.im) / size };
}

/* e^z - 1, |z| below 13 */
static struct complex exponential(struct complex z)
{
	struct complex sum = { 0, 0 }, term = { 1, 0 };
	for (int k = 1; k < 90; k++) {
		term = times(term, (struct complex){ z.re / k, z.im / k });
		sum = plus(sum, term);
	}
	return sum;
}

/* ln(1 + z), |z| tiny */
static struct complex logarithm(struct complex z)
{
	struct complex sum = { 0, 0 }, power = { -1, 0 };
	for (int k = 1; k < 8; k++) {
		power = times(power, (struct complex){ -z.re, -z.im });
		sum = plus(sum, (struct complex){ power.re / k, power.im / k });
	}
	return sum;
}

static wide root(wide x)
{
	wide y = sqrt((double)x);
	for (int k = 0; k < 4; k++)
		y = (y + x / y) / 2;
	return y;
}

/* ---- the map, less 1, and its characteristic polynomial by Faddeev and LeVerrier ---- */

static void increment_of(const struct map *map, wide D[N][N])
{
	for (int j = 0; j < N; j++) {
		wide y[N] = { 0 };
		y[j] = 1;
		map->step(y);
		for (int i = 0; i < N; i++)
			D[i][j] = y[i] - (i == j);
	}
}

static void polynomial_of(wide D[N][N], wide c[N + 1])
{
	wide B[N][N] = { { 0 } };
	c[N] = 1;
	for (int k = 1; k <= N; k++) {
		wide next[N][N], trace = 0;
		for (int i = 0; i < N; i++)
			B[i][i] += c[N - k + 1];
		for (int i = 0; i < N; i++)
			for (int j = 0; j < N; j++) {
				next[i][j] = 0;
				for (int l = 0; l < N; l++)
					next[i][j] += D[i][l] * B[l][j];
			}
		for (int i = 0; i < N; i++)
			trace += next[i][i];
		c[N - k] = -trace / k;
		memcpy(B, next, sizeof B);
	}
}

static struct complex eigenvalue_near(const wide c[N + 1], struct complex z)
{
	for (int k = 0; k < 30; k++) {
		struct complex value = { 0, 0 }, slope = { 0, 0 };
		for (int i = N; i >= 0; i--) {
			slope = plus(times(slope, z), value);
			value = plus(times(value, z), (struct complex){ c[i], 0 });
		}
		const struct complex change = over(value, slope);
		z = plus(z, (struct complex){ -change.re, -change.im });
	}
	return z;
}

/* ---- the models ---- */

static wide step_of(const char *name)
{
	if (strstr(name, "turned"))
		return (wide)1 / 4;
	if (strstr(name, "twice"))
		return (wide)7 / 10;
	return (wide)1 / (strstr(name, "float") ? 10000 : 100);
}

/* The pole of a mode, in the upper half plane */
static struct complex pole_of(const char *name, int mode)
{
	if (strstr(name, "pair"))
		return (struct complex){ 0, root((wide)120 * 10 / 15 + (wide)120 * 10 / 7) };
	const wide c = strstr(name, "light") ? (wide)(2 * mode + 1) / 2000000 : 0;
	return (struct complex){ -c, root((mode ? 300 : 100) - c * c) };
}

static void try_eigenvalues(const struct map *map, const wide c[N + 1])
{
	const wide h = step_of(map->name);
	double amplitude = 0, phase = 0;
	bool rates = true;
	for (int mode = 0; mode < (strstr(map->name, "pair") ? 1 : 2); mode++) {
		const struct complex p = pole_of(map->name, mode),
				exact = exponential((struct complex){ p.re * h, p.im * h });
		const struct complex found = eigenvalue_near(c, exact), one = { 1, 0 };
		struct complex ratio = over((struct complex){ found.re - exact.re, found.im - exact.im },
				plus(exact, one));
		ratio = logarithm(ratio);
		if (fabs((double)ratio.re) > fabs(amplitude))
			amplitude = (double)ratio.re;
		phase = worse(phase, fabs((double)ratio.im));
		if (p.re != 0 && !strstr(map->name, "direct"))  /* the issue's */
			rates = close_to((double)(p.re + ratio.re / h), (double)p.re, 0.01 * fabs((double)p.re),
				"%s: decay rate of mode %d", map->name, mode + 1) && rates;
	}
	if (strstr(map->name, "light") && !strstr(map->name, "direct"))
		ok(rates, "%s: the map's decay rates are within 1 %% (%.2g of them)", map->name,
			fabs(amplitude / (double)(pole_of(map->name, 0).re * h)));
	if (strstr(map->name, "kick"))
		ok(close_to(amplitude, 0, 1e-28, "%s: amplitude", map->name), "%s: the map's eigenvalues are of size 1",
			map->name);
	if (isnan(map->amplitude)) {
		note("%s: --explain=json says nothing of drift; amplitude %.3g, phase %.3g per step", map->name,
				amplitude,
			phase);
		return;
	}
	if (strstr(map->name, "pair") && strstr(map->name, "direct"))
		return;                         /* there the rigid mode may drift most, which is not looked at here */
	const bool good = close_to(map->amplitude, amplitude, 1e-6 * fabs(amplitude) + 1e-28, "%s: amplitude",
			map->name);
	ok(close_to(map->phase, phase, 1e-6 * phase + 1e-28, "%s: phase", map->name) && good,
	   "%s: --explain=json has the drift, amplitude %.3g, phase %.3g per step", map->name, amplitude, phase);
}

/* E^T J E = J: areas are kept, whatever the rounding of the constants */
static void try_symplectic(const struct map *map, wide D[N][N])
{
	bool good = true;
	for (int a = 0; a < N; a++)
		for (int b = 0; b < N; b++) {
			wide area = 0;
			for (int i = 0; i < N / 2; i++)
				area += (D[i][a] + (i == a)) * (D[i + N / 2][b] + (i + N / 2 == b)) -
					(D[i + N / 2][a] + (i + N / 2 == a)) * (D[i][b] + (i == b));
			const double expected = b == a + N / 2 ? 1 : a == b + N / 2 ? -1 : 0;
			good = close_to((double)(area - expected), 0, 1e-30, "%s: area %d, %d", map->name, a, b)
					&& good;
		}
	ok(good, "%s: the map is symplectic", map->name);
}

/* Of pair the centre and the distance are kept, then their rates: a displacement of both, and what they move with, meet
 * no force; nothing acts on the centre's velocity, and nothing of the centre on the distance. */
static void try_rigid(const struct map *map, wide D[N][N])
{
	bool good = true;
	for (int i = 0; i < N; i++)
		good = close_to((double)D[i][0], 0, 0, "%s: what a displacement of both does to state %d", map->name,
				i) &&
			good;
	good = close_to((double)D[1][2], 0, 0, "%s: what the centre's velocity does to the distance", map->name)
			&& good;
	good = close_to((double)D[3][2], 0, 0, "%s: what the centre's velocity does to the rate of the distance",
		map->name) && good;
	ok(good, "%s: a displacement of both stays as it is", map->name);
	good = true;
	for (int j = 0; j < N; j++)
		good = close_to((double)D[2][j], 0, 0, "%s: momentum from state %d", map->name, j) && good;
	ok(good, "%s: the map keeps the momentum", map->name);
}

int main(void)
{
	for (int k = 0; k < MAPS; k++) {
		wide D[N][N], c[N + 1];
		increment_of(&maps[k], D);
		polynomial_of(D, c);
		try_eigenvalues(&maps[k], c);
		if (strstr(maps[k].name, "pair") && !strstr(maps[k].name, "direct"))
			try_rigid(&maps[k], D);
		if (strstr(maps[k].name, "kick"))
			try_symplectic(&maps[k], D);
	}
	return tap_end();
}

#else

int main(void)
{
	puts("1..1\nok 1 - maps # SKIP no type of 113 bits");
	return 0;
}

#endif
