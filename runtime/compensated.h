/* SPDX-License-Identifier: MIT-0 */
/* compensated.h: x on over a piece of a step, for the runtime's own use: by crossings.c and guards.c, and with what
 * rounding takes from x kept by crossings_compensated.c and guards_compensated.c, which define STATE_IS_COMPENSATED and
 * include them.  There x is `size` entries and then their low parts, so that x + low part is the value; breakpoints and
 * guards see x, from which it differs by rounding. */
#ifndef PLRT_COMPENSATED_H
#define PLRT_COMPENSATED_H

#include "roots.h"

/* row . x of one row, from many places */
static PL_APART real dot(int n, const real *row, const real *x)
{
	return dot_product(n, row, x);
}

#ifdef STATE_IS_COMPENSATED

#include "two.h"

enum { WORDS = 2 }; /* of an entry of x, of A */

/* y = e^{A h} x.  Phi: of each matrix e^{A h} - I in two words, n x n first ones and then n x n second ones */
static void full_piece(int n, const real *Phi, int matrix, const real *x, real *y)
{
	const real *gain = Phi + 2 * (ptrdiff_t)matrix * n * n, *second = gain + (ptrdiff_t)n * n;
	real *left = y + n;
	int i;
	pl_multiply(n, n, gain, x, y);
	pl_multiply(n, n, second, x, left);
	pl_multiply_add(n, n, gain, x + n, left);
	for (i = 0; i < n; i++) {
		const real small = left[i];
		left[i] = x[n + i];
		y[i] = pl_accumulate(x[i], y[i], small, &left[i]);
	}
}

/* y = e^{A d} x by a rung's e^{A d} - I in two words.  x_low: not used */
static void rung_piece(int n, const real *pieces, int rung, const real *x, real *y, real *x_low)
{
	(void)x_low;
	full_piece(n, pieces, rung, x, y);
}

/* row . x + small in two words */
static pl_two row_times(int n, const real *row, const real *x, real small)
{
	real sum = 0, x_low = 0;
	int j;
	for (j = 0; j < n; j++) {
		if (row[j] < 0 || row[j] > 0) {
			const pl_two product = two_product(row[j], x[j]);
			sum = pl_accumulate(sum, product.hi, product.lo, &x_low);
		}
	}
	return two_sum(sum, x_low + small);
}

/* The coefficients of x(s), and the second words of the first derivatives: where x begins on a breakpoint, forces that
 * balance there would leave their rounding, in one and the same direction each time.  A: n x n first words, then as
 * many second ones */
static void expand_piece(int n, int degree, const real *A, real dt, const real *x, real *coefficients, real *low)
{
	int i;
	expand(n, degree, A, dt, x, coefficients);
	pl_multiply(n, n, A + n * n, x, low);
	pl_multiply_add(n, n, A, x + n, low);
	for (i = 0; i < n; i++) {
		const pl_two slope = row_times(n, A + i * n, x, low[i]), gain = two_product(dt, slope.hi);
		coefficients[n + i] = gain.hi;
		low[i] = gain.lo + dt * slope.lo;
	}
}

/* x from where the polynomial starts on to s.  An entry that its gain takes away but for the gain's own rounding is 0:
 * what is on a breakpoint at 0 has no other size there that what remains could be held against. */
static void part_of_piece(int n, int degree, const real *coefficients, const real *low, real s, real *x, real *x_low)
{
	int i, k;
	(void)x_low;
	for (i = 0; i < n; i++) {
		real gain = 0;
		for (k = degree; k > 0; k--) {
			gain = (gain + coefficients[k * n + i]) * s;
		}
		x[i] = pl_accumulate(x[i], gain, low[i] * s, &x[n + i]);
		if (magnitude(x[i]) <= 4 * REAL_EPSILON * magnitude(gain)) {
			x[i] = x[n + i] = 0;
		}
	}
}

/* value . x of a jump, which is linear in the state, so that the low part goes along.  all: rows of n first words and n
 * second ones; value: two words */
static inline void value_of(int n, const real *all, int row, const real *x, real *value)
{
	const real *first = all + 2 * (ptrdiff_t)row * n, *second = first + n;
	real small;
	pl_two product;
	pl_multiply(1, n, second, x, &small);
	pl_multiply_add(1, n, first, x + n, &small);
	product = row_times(n, first, x, small);
	value[0] = product.hi;
	value[1] = product.lo;
}

static inline void put_value(int n, int state, const real *value, real *x)
{
	x[state] = value[0];
	x[n + state] = value[1];
}

/* What is put on a guard has no x_low: it is there. */
static inline void take_from(int n, int state, real what, real *x)
{
	if (what < 0 || what > 0) {
		x[state] -= what;
		x[n + state] = 0;
	}
}

#else

enum { WORDS = 1 };

/* y = Phi x.  Phi: e^{A h} of each matrix, n x n. */
static void full_piece(int n, const real *Phi, int matrix, const real *x, real *y)
{
	pl_multiply(n, n, Phi + (ptrdiff_t)matrix * n * n, x, y);
}

/* x + gain + *rest, and *left what rounding takes from that, where x is the largest */
static real plus_gain(real x, real gain, real x_low, real *left)
{
	const real more = gain + x_low, sum = x + more;
	*left = more - (sum - x);
	return sum;
}

/* y = e^{A d} x; what keeps most of itself is moved by its change, so that many short pieces do not repeat the rounding
 * of a number near 1.  x_low: what rounding has taken from x in pieces before, and behind it of y; n each */
static void rung_piece(int n, const real *pieces, int rung, const real *x, real *y, real *x_low)
{
	const real *rows = pieces + (ptrdiff_t)rung * (n + 1) * n, *stays = rows + n * n;
	int i;
	pl_multiply(n, n, rows, x, y);
	for (i = 0; i < n; i++) {
		x_low[n + i] = 0;
		if (stays[i] > 0) {
			y[i] = plus_gain(x[i], y[i], x_low[i], &x_low[n + i]);
		}
	}
}

static void expand_piece(int n, int degree, const real *A, real dt, const real *x, real *coefficients, real *low)
{
	(void)low;
	expand(n, degree, A, dt, x, coefficients);
}

/* x_low: as for rung_piece, of x alone; NULL where pieces are not many */
static void part_of_piece(int n, int degree, const real *coefficients, const real *low, real s, real *x, real *x_low)
{
	int i, k;
	(void)low;
	if (!x_low) {
		sum_up(n, degree, coefficients, s, x);
		return;
	}
	for (i = 0; i < n; i++) {
		real gain = 0;
		for (k = degree; k > 0; k--) {
			gain = (gain + coefficients[k * n + i]) * s;
		}
		x[i] = plus_gain(x[i], gain, x_low[i], &x_low[i]);
	}
}

static inline void value_of(int n, const real *all, int row, const real *x, real *value)
{
	value[0] = dot(n, all + (ptrdiff_t)row * n, x);
}

static inline void put_value(int n, int state, const real *value, real *x)
{
	(void)n;
	x[state] = value[0];
}

static inline void take_from(int n, int state, real what, real *x)
{
	(void)n;
	x[state] -= what;
}

#endif

#endif
