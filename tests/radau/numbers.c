/* SPDX-License-Identifier: MIT-0 */
/* The tables of the collocations with 3, 5, 7 and 9 stages, by the conditions that they have to keep, in long double: a
 * wrong last bit of any number shows. Each is in a file of its own as NAME is. */
#include "tap.h"

#include <float.h>
#include <math.h>

/* numbers_S.c, made by plgen, with static tables */
#include NUMBERS

typedef long double wide;
#define NAMED_(prefix, table) prefix##table
#define NAMED(prefix, table) NAMED_(prefix, table)
#define c NAMED(PREFIX, _node)
#define A NAMED(PREFIX, _once)
#define B NAMED(PREFIX, _twice)
#define W NAMED(PREFIX, _monomial)
#define z NAMED(PREFIX, _mode)
#define u NAMED(PREFIX, _to_mode)
#define v NAMED(PREFIX, _from_mode)
enum { S = sizeof c / sizeof *c, MODES = (S + 1) / 2 };

static wide power(wide x, int n)
{
	wide product = 1;
	for (int i = 0; i < n; i++)
		product *= x;
	return product;
}

/* |found - expected| in units of what rounding the numbers of a sum makes of it */
static double worst;
static void compare(wide found, wide expected, wide size)
{
	worst = worse(worst, (double)(fabsl(found - expected) / (size * (DBL_EPSILON / 2))));
}

static void says(const char *what)
{
	ok(close_to(worst, 0, 1, "%d stages: %s", S, what), "%d stages: %s, within %.2g of the bound of rounding", S,
			what,
		worst);
	worst = 0;
}

/* P_s - P_{s-1} at 2 x - 1 by the recurrence, and its slope, which says how far off x is */
static void nodes(void)
{
	for (int i = 0; i < S; i++) {
		const wide x = 2 * (wide)c[i] - 1;
		wide before = 1, now = x, slope_before = 0, slope = 1;
		for (int n = 1; n < S - 1; n++) {
			const wide next = ((2 * n + 1) * x * now - n * before) / (n + 1);
			const wide next_slope = ((2 * n + 1) * (now + x * slope) - n * slope_before) / (n + 1);
			before = now, now = next, slope_before = slope, slope = next_slope;
		}
		const wide last = ((2 * S - 1) * x * now - (S - 1) * before) / S;
		const wide last_slope = ((2 * S - 1) * (now + x * slope) - (S - 1) * slope_before) / S;
		compare(c[i] - (last - now) / (2 * (last_slope - slope)), c[i], c[i]);
	}
	worst = c[S - 1] == 1 ? worst : INFINITY;
	says("nodes are zeros of the Radau polynomial");
}

/* A c^{k-1} = c^k / k up to k = S; b c^{k-1} = 1/k up to 2 S - 1; A^2 likewise, c^{k+1} / (k (k+1)) */
static void integrals(void)
{
	for (int i = 0; i < S; i++)
		for (int k = 1; k <= (i == S - 1 ? 2 * S - 1 : S); k++) {
			wide once = 0, twice = 0, size = 0, size_twice = 0;
			for (int j = 0; j < S; j++) {
				/* the node's own rounding counts too */
				const wide p = power(c[j], k - 1);
				once += A[i][j] * p;
				twice += B[i][j] * p;
				size += fabsl(A[i][j] * p) * k;
				size_twice += fabsl(B[i][j] * p) * k;
			}
			compare(once, power(c[i], k) / k, size + power(c[i], k));
			if (k < S)
				compare(twice, power(c[i], k + 1) / (k * (k + 1)), size_twice + power(c[i], k + 1));
		}
	says("A and A^2 integrate powers of time, the last row up to order 2 s - 1");
	for (int i = 0; i < S; i++)
		for (int j = 0; j < S; j++) {
			wide sum = 0, size = 0;
			for (int k = 0; k < S; k++) {
				sum += (wide)A[i][k] * A[k][j];
				size += fabsl((wide)A[i][k] * A[k][j]);
			}
			compare(B[i][j], sum, 2 * size);
		}
	says("A^2 is the square of A");
}

/* sum over m of W_mj c_i^m is 1 where i = j, else 0 */
static void monomials(void)
{
	for (int i = 0; i < S; i++)
		for (int j = 0; j < S; j++) {
			wide sum = 0, size = 0;
			for (int m = 0; m < S; m++) {
				sum += W[m][j] * power(c[i], m);
				size += fabsl(W[m][j] * power(c[i], m)) * (m + 1);
			}
			compare(sum, i == j, size);
		}
	says("polynomials are 1 at one node");
}

struct complex { wide re, im; };

static struct complex times(const double *a, const double *b)
{
	return (struct complex){(wide)a[0] * b[0] - (wide)a[1] * b[1], (wide)a[0] * b[1] + (wide)a[1] * b[0]};
}

/* A v = z v, u A = z u, u v = 1, of a pair 2 */
static void modes(void)
{
	for (int k = 0; k < MODES; k++) {
		wide re = 0, im = 0, size = 0;
		for (int i = 0; i < S; i++) {
			const struct complex right = times(z[k], v[k][i]), left = times(z[k], u[k][i]);
			const struct complex one = times(u[k][i], v[k][i]);
			wide vre = 0, vim = 0, vsize = hypotl(right.re, right.im);
			wide ure = 0, uim = 0, usize = hypotl(left.re, left.im);
			for (int j = 0; j < S; j++) {
				vre += (wide)A[i][j] * v[k][j][0];
				vim += (wide)A[i][j] * v[k][j][1];
				vsize += fabsl(A[i][j]) * hypotl(v[k][j][0], v[k][j][1]);
				ure += (wide)A[j][i] * u[k][j][0];
				uim += (wide)A[j][i] * u[k][j][1];
				usize += fabsl(A[j][i]) * hypotl(u[k][j][0], u[k][j][1]);
			}
			compare(vre, right.re, 2 * vsize);
			compare(vim, right.im, 2 * vsize);
			compare(ure, left.re, 2 * usize);
			compare(uim, left.im, 2 * usize);
			re += one.re;
			im += one.im;
			size += hypotl(one.re, one.im);
		}
		compare(re, k ? 2 : 1, 2 * size);
		compare(im, 0, 2 * size);
	}
	says("modes: A v = z v, u A = z u, u v = 1");
}

int main(void)
{
	nodes();
	integrals();
	monomials();
	modes();
	return tap_end();
}
