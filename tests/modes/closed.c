/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models of modes against sums over modes in closed form, in long double: chain.spec, and -DBLOCKS: blocks.spec.
 * KEPT: bit i is mode i + 1; the others give what loads force, or -DWITHOUT: nothing. */
#include "m.h"
#include "worse.h"

#include <complex.h>
#include <math.h>
#include <stdbool.h>
#include <stdio.h>

enum { STEPS = 1500 };
typedef long double complex number;
static const long double pi = 3.14159265358979323846264338327950288L;

static bool is_kept(int mode)
{
	return (KEPT >> mode) & 1;
}

static bool gives(int mode)
{
#ifdef WITHOUT
	return is_kept(mode);
#else
	(void)mode;
	return true;
#endif
}

#ifdef BLOCKS
/* Rows 1 and 6 of S, S^-1 times the start, a pole each; real modes 1 and 4, pairs 2 and 3: w = z + i z_next */
static const long double one[6] = {1, 1, -1, 0, 0, -1}, six[6] = {0, 2, -1, -3, -4, 0};
static const long double start[6] = {-91, 54.5L, -47.5L, 25.5L, 20, 10};

/* w of w' = p w + f cos 2 t */
static number pair(number p, number f, number w, int mode, long double t)
{
	const number up = f / (2 * I - p) / 2, down = f / (-2 * I - p) / 2;
	return (gives(mode) ? up * cexpl(2 * I * t) + down * cexpl(-2 * I * t) : 0) +
		   (is_kept(mode) ? (w - up - down) * cexpl(p * t) : 0);
}

static void expect(long double t, long double out[2])
{
	const number p = pair(-1 - 6 * I, 1, start[2] + start[3] * I, 1, t);
	const number q = pair(-2 - 25 * I, I, start[4] + start[5] * I, 2, t);
	const long double z[6] = {
		(gives(0) ? 2.0L / 3 : 0) + (is_kept(0) ? (start[0] - 2.0L / 3) * expl(-3 * t) : 0),
		is_kept(3) ? start[1] * expl(-40 * t) : 0, creall(p), cimagl(p), creall(q), cimagl(q)};
	int i;
	out[0] = out[1] = 0;
	for (i = 0; i < 6; i++) {
		out[0] += one[i] * z[i];
		out[1] += six[i] * z[i];
	}
}
#else
/* v_i = sin(i (2 j - 1) pi/(2 n + 1)), lambda = 2 k (1 - cos ...), v.v = (2 n + 1)/4 */
static void expect(long double t, long double out[2])
{
	const int n = 6;
	int j;
	out[0] = out[1] = 0;
	for (j = 0; j < n; j++) {
		const long double angle = (2 * j + 1) * pi / (2 * n + 1), size = (2 * n + 1) / 4.0L;
		const long double lambda = 800 * (1 - cosl(angle)), c = 0.3L + 0.002L * lambda;
		const long double first = sinl(angle), third = sinl(3 * angle), last = sinl(n * angle);
		const number p = -c / 2 + I * sqrtl(lambda - c * c / 4),
				force = 30 * last / size / (lambda - 49 + 7 * I * c);
		const long double x = 0.02L * first / size - creall(force);
		const long double v = 0.5L * last / size - creall(7 * I * force);
		/* Re(a e^{p t}) with Re a = x, Re(p a) = v */
		const number a = x + I * (creall(p) * x - v) / cimagl(p);
		const number forced = gives(j) ? force * cexpl(7 * I * t) : 0, own = is_kept(j) ? a * cexpl(p * t) : 0;
		out[0] += last * creall(forced + own);
		out[1] += third * creall(7 * I * forced + p * own);
	}
}
#endif

int main(void)
{
	static m s;
	double worst[2] = {0, 0};
	long double largest[2] = {0, 0};
	int n, i, failed = 0;
	m_init(&s);
	for (n = 0; n <= STEPS; n++) {
		double out[M_OUTPUTS];
		long double expected[2];
		m_out(&s, out);
		expect(n * (long double)M_H, expected);
		for (i = 0; i < 2; i++) {
			const long double error = fabsl((long double)out[i] - expected[i]);
			worst[i] = worse(worst[i], (double)error);
			largest[i] = fmaxl(largest[i], fabsl(expected[i]));
		}
		m_step(&s);
	}
	for (i = 0; i < 2; i++)
		if (!(worst[i] <= 2e-13 * (double)largest[i])) {
			printf("output %d: off by %.3g, largest value %.17Lg\n", i, worst[i], largest[i]);
			failed = 1;
		}
	return failed;
}
