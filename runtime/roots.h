/* SPDX-License-Identifier: MIT-0 */
/* roots.h: where a polynomial first rises through 0, for the runtime's own use: by crossings.c, guards.c and
 * events.c.  A root is isolated by bounds on derivatives before it is computed, so none is stepped over. */
#ifndef PLRT_ROOTS_H
#define PLRT_ROOTS_H

#include "real.h"

/* SHORT: a length of s, which goes from 0 to 1 over a piece.  SOON: one in which what starts is under way.  REST: what
 * rounding may leave of a step, in parts of it.  SCALE: that of switching functions near the end of the range. */
#ifdef REAL_IS_FLOAT
#define SHORT 0x1p-18f
#define SOON 0x1p-7f
#define REST 5e-6f
#define SCALE 0x1p-48f
#else
#define SHORT 0x1p-40
#define SOON 0x1p-10
#define REST 1e-14
#define SCALE 0x1p-48
#endif

static real magnitude(real a)
{
	return pl_magnitude(a);
}

static real larger(real a, real b)
{
	return a > b ? a : b;
}

static real smaller(real a, real b)
{
	return a < b ? a : b;
}

/* sum |a_j b_j| */
static real sizes(int n, const real *a, const real *b)
{
	real sum = 0;
	int j;
	for (j = 0; j < n; j++) {
		sum += magnitude(a[j] * b[j]);
	}
	return sum;
}

static inline real polynomial_slope(int degree, const real *e, real s)
{
	real slope = 0;
	for (; degree > 0; degree--) {
		slope = slope * s + (real)degree * e[degree];
	}
	return slope;
}

/* Whether sign times a polynomial rises at 0 and falls at 1: *at, where it turns back between them; *value: its own */
static inline int turns_back(int degree, const real *e, real sign, real *at, real *value)
{
	real low = 0, high = 1;
	int i;
	if (!(sign * polynomial_slope(degree, e, low) > 0 && sign * polynomial_slope(degree, e, high) < 0)) {
		return 0;
	}
	for (i = 0; i < 40; i++) {
		const real middle = (low + high) / 2;
		*(sign * polynomial_slope(degree, e, middle) > 0 ? &low : &high) = middle;
	}
	*at = low;
	*value = 0;
	for (i = degree; i >= 0; i--) {
		*value = *value * low + e[i];
	}
	return 1;
}

/* What rounding may have done to a sum of terms of this size */
static real noise_of(real terms)
{
	return 8 * REAL_EPSILON * terms;
}

/* next = A y and |A| terms, in the entries that `row` reads, or in the others */
static inline void turn_entries(int n, const real *A, const real *row, int others, const real *y, const real *terms,
								real *next, real *next_terms)
{
	int i;
	for (i = 0; i < n; i++) {
		const int is_read = row[i] < 0 || row[i] > 0;
		if (is_read != others) {
			next[i] = dot_product(n, A + i * n, y);
			next_terms[i] = sizes(n, A + i * n, terms);
		} else if (!others) {
			next[i] = next_terms[i] = 0;
		}
	}
}

/* 1, -1 or 0: the sign of the first of e', e'', e''' that is not zero but for rounding.  work: 4 n */
static inline int heading(int n, const real *A, const real *row, const real *x, real *work)
{
	real *y = work, *next = work + n, *terms = work + 2 * n, *next_terms = work + 3 * n, e, noise;
	int order, i;
	for (i = 0; i < n; i++) {
		y[i] = terms[i] = x[i];
	}
	for (order = 1; order <= 3; order++) {
		turn_entries(n, A, row, 0, y, terms, next, next_terms);
		e = dot_product(n, row, next);
		noise = noise_of(sizes(n, row, next_terms));
		if (e > noise || e < -noise) {
			return e > 0 ? 1 : -1;
		}
		turn_entries(n, A, row, 1, y, terms, next, next_terms);
		for (i = 0; i < n; i++) {
			y[i] = next[i];
			terms[i] = next_terms[i];
		}
	}
	return 0;
}

/* What is not 0 in a matrix, row by row: few sums are as long as its rows. */
typedef struct sparse {
	unsigned short end[16], column[64];
} sparse;

/* Whether there is room for it */
static inline int fill_sparse(int n, const real *A, sparse *of)
{
	enum { ROWS = sizeof of->end / sizeof *of->end, MOST_SPARSE = sizeof of->column / sizeof *of->column };
	int i, j, count = 0;
	for (i = 0; i < n && n <= ROWS; i++) {
		for (j = 0; j < n && count < MOST_SPARSE; j++) {
			of->column[count] = (unsigned short)j;
			count += A[i * n + j] < 0 || A[i * n + j] > 0;
		}
		of->end[i] = (unsigned short)count;
	}
	return n <= ROWS && count < MOST_SPARSE;
}

/* y = factor A x */
static inline void multiply_sparse(int n, const sparse *of, const real *A, real factor, const real *x, real *y)
{
	int i, k = 0;
	for (i = 0; i < n; i++, A += n) {
		const int end = of->end[i];
		real sum = 0;
		for (; k < end; k++) {
			const int j = of->column[k];
			sum += A[j] * x[j];
		}
		y[i] = sum * factor;
	}
}

/* The coefficients of x(s) = e^{A dt s} x */
static inline void expand(int n, int degree, const real *A, real dt, const real *x, real *coefficients)
{
	sparse of;
	const int few = fill_sparse(n, A, &of);
	int i, k;
	for (i = 0; i < n; i++) {
		coefficients[i] = x[i];
	}
	for (k = 1; k <= degree; k++, coefficients += n) {
		const real factor = dt / (real)k;
		if (few) {
			multiply_sparse(n, &of, A, factor, coefficients, coefficients + n);
			continue;
		}
		pl_multiply(n, n, A, coefficients, coefficients + n);
		for (i = 0; i < n; i++) {
			coefficients[n + i] *= factor;
		}
	}
}

/* e(s) = row . x(s), by its coefficients */
static inline void expand_row(int n, int terms, const real *row, const real *coefficients, real *e)
{
	int j, k;
	for (k = 0; k < terms; k++) {
		e[k] = 0;
	}
	for (j = 0; j < n; j++) {
		for (k = 0; k < terms && (row[j] < 0 || row[j] > 0); k++) {
			e[k] += row[j] * coefficients[k * n + j];
		}
	}
}

static inline void sum_up(int n, int degree, const real *coefficients, real s, real *x)
{
	const real *row = coefficients + degree * n;
	int i, k;
	for (i = 0; i < n; i++) {
		x[i] = row[i];
	}
	for (k = degree; k > 0; k--) {
		row -= n;
		for (i = 0; i < n; i++) {
			x[i] = x[i] * s + row[i];
		}
	}
}

/* How far a switching function is beyond a breakpoint: g(s), 0 <= s <= 1 over the piece, negative inside */
typedef struct beyond {
	int degree;
	real *coefficient;
	real noise;                /* of g */
	real reach, fourth, fifth; /* bounds of |g - g(0)| and of the fourth and fifth derivative */
} beyond;

typedef struct point {
	real s, g, slope, second, third; /* g and its derivatives */
} point;

static point point_of(const beyond *f, real s)
{
	point p;
	int k;
	p.s = s;
	p.g = p.slope = p.second = p.third = 0;
	for (k = f->degree; k >= 0; k--) { /* four chains side by side take no longer than one */
		p.third = p.third * s + p.second;
		p.second = p.second * s + p.slope;
		p.slope = p.slope * s + p.g;
		p.g = p.g * s + f->coefficient[k];
	}
	p.second *= 2;
	p.third *= 6;
	return p;
}

/* g = sign (e - b) from the coefficients of e, whose terms have this size at s = 0; both are scaled by a power of 2
 * where the derivatives of g could overflow and g does not.  0: by these sizes alone g does not rise through 0, as
 * first_root would find, and f is not made. */
static int look_beyond(beyond *f, const real *e, real sign, real b, real terms)
{
	real reach = 0;
	int k;
	for (k = 1; k <= f->degree; k++) {
		reach += magnitude(e[k]);
	}
	if (reach + terms > REAL_LARGE) {
		sign *= SCALE;
		terms *= SCALE;
	} else if (sign * (e[0] - b) + reach <= noise_of(terms + magnitude(b) + reach)) {
		return 0;
	}
	f->coefficient[0] = sign * (e[0] - b);
	f->reach = f->fourth = f->fifth = 0;
	for (k = 1; k <= f->degree; k++) {
		const real a = magnitude(sign * e[k]), fourths = (real)(k * (k - 1) * (k - 2) * (k - 3));
		f->coefficient[k] = sign * e[k];
		f->fourth += fourths * a;
		f->fifth += fourths * (real)(k - 4) * a;
		f->reach += a;
	}
	f->noise = noise_of(terms + magnitude(sign * b) + f->reach);
	return 1;
}

/* What has left its guard at the start comes back where g(s)/s rises through 0: that is known to more digits. */
static inline int look_behind(beyond *f, const real *e, real terms)
{
	int rises;
	f->degree--;
	rises = look_beyond(f, e + 1, 1, 0, terms);
	f->coefficient[++f->degree] = 0;
	return rises;
}

/* One more look at a polynomial, of those that a step has; 0: they are used up */
static int has_look(int *splits)
{
	return --*splits >= 0;
}

/* The root between a, where g < 0, and z, where g > 0, the only one.  Newton's method, kept safe by halving; -1: there
 * are no looks left */
static real root_between(const beyond *f, point a, point z, int *splits)
{
	const real enough = SHORT; /* the step after that would be below rounding */
	real s = a.s + (z.s - a.s) * (a.g / (a.g - z.g));
	int i, k;
	for (i = 0; i < 64; i++) {
		real g = 0, slope = 0, newton;
		if (!has_look(splits)) {
			return -1;
		}
		for (k = f->degree; k >= 0; k--) {
			slope = slope * s + g;
			g = g * s + f->coefficient[k];
		}
		newton = s - g / slope;
		*(g > 0 ? &z.s : &a.s) = s;
		if (magnitude(newton - s) <= enough && newton >= a.s && newton <= z.s) {
			return newton;
		}
		s = newton > a.s && newton < z.s ? newton : (a.s + z.s) / 2;
	}
	return s;
}

enum { NO_CROSSING, RISES, BENDS, UNKNOWN }; /* what is known of g between two points; BENDS: it has a top there */

static int between(const beyond *f, point a, point z)
{
	const real w = (z.s - a.s) * (z.s - a.s) / 8; /* a chord is off by at most w times the second derivative */
	const real second = larger(magnitude(a.second), magnitude(z.second)) + w * f->fourth;
	const real third = larger(magnitude(a.third), magnitude(z.third)) + w * f->fifth;
	if (larger(a.g, z.g) + w * second <= f->noise) {
		return NO_CROSSING;
	}
	if (larger(a.slope, z.slope) + w * third < 0) {
		return NO_CROSSING;
	}
	if (smaller(a.slope, z.slope) - w * third > 0) {
		return RISES;
	}
	if (smaller(a.second, z.second) - w * f->fourth > 0) { /* below its chord: one root at most from g < 0 */
		return z.g <= f->noise ? NO_CROSSING : a.g < 0 ? RISES : UNKNOWN;
	}
	if (larger(a.second, z.second) + w * f->fourth < 0) {
		return !(a.slope > 0) ? NO_CROSSING : z.slope < 0 ? BENDS : RISES;
	}
	return UNKNOWN;
}

/* Where g is below its tangents, between a, where it rises, and *z, where it falls: whether it comes above its noise,
 * by a tangent near its top.  Newton's method on its slope, from the chord of that.  RISES: *z is moved there. */
static int look_at_top(const beyond *f, point a, point *z, int *splits)
{
	const real from = a.s, to = z->s;
	point b = *z;
	real s = a.s + (b.s - a.s) * (a.slope / (a.slope - b.slope));
	int i;
	for (i = 0; i < 8 && has_look(splits); i++) {
		const point p = point_of(f, s);
		if (p.g > f->noise) {
			*z = p;
			return RISES;
		}
		if (p.g + magnitude(p.slope) * larger(p.s - from, to - p.s) <= f->noise) {
			return NO_CROSSING;
		}
		*(p.slope > 0 ? &a : &b) = p;
		s = p.s - p.slope / p.second;
		s = s > a.s && s < b.s ? s : (a.s + b.s) / 2;
	}
	return UNKNOWN;
}

/* f with bounds of its derivatives up to `to`: where it begins flat they are far smaller */
static beyond up_to(const beyond *f, real to)
{
	beyond part = *f;
	int k;
	part.fourth = part.fifth = 0;
	for (k = f->degree; k >= 4; k--) {
		const real fourths = (real)(k * (k - 1) * (k - 2) * (k - 3)) * magnitude(f->coefficient[k]);
		part.fourth = part.fourth * to + fourths;
		part.fifth = k > 4 ? part.fifth * to + (real)(k - 4) * fourths : part.fifth;
	}
	return part;
}

/* Where g first rises through 0 before `end`, or -1.  Walks from the left, by intervals that are halved until it is
 * known what g does in them, and doubled again after that. */
static real first_root(const beyond *f, real end, int *splits)
{
	enum { FEW = 16 };
	const real shortest = SHORT; /* what g does in less is below its noise */
	const int looks = *splits;
	real width = end;
	int first = 1;
	point a, inside; /* inside: the last point where g < 0, so that what noise hides loses no time */
	if (f->coefficient[0] + f->reach <= f->noise) {
		return -1;
	}
	a.s = 0;
	a.g = f->coefficient[0];
	a.slope = f->coefficient[1];
	a.second = 2 * f->coefficient[2];
	a.third = 6 * f->coefficient[3];
	inside = a;
	for (; a.s < end && (first || has_look(splits)); first = 0) {
		point z = point_of(f, a.s + width < end ? a.s + width : end);
		const beyond part = looks - *splits > FEW ? up_to(f, z.s) : *f;
		int known = between(&part, a, z);
		if (known == BENDS) {
			known = look_at_top(f, a, &z, splits);
		}
		if (known != NO_CROSSING && z.g > f->noise && (known != UNKNOWN || width <= shortest)) {
			return inside.g < 0 ? root_between(f, inside, z, splits) : inside.s;
		}
		if (known == UNKNOWN && width > shortest) {
			width /= 2;
			continue;
		}
		if (z.g < 0 || inside.g >= 0) {
			inside = z;
		}
		a = z;
		width *= 2;
	}
	return -1;
}

#endif
