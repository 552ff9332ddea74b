/* SPDX-License-Identifier: MIT-0 */
/* unresolved.h: the time over which a Taylor polynomial follows functions that are almost constant over most of their
 * range, which its coefficients may not show; part of what a model's file includes for its steps.  The polynomial of a
 * function's argument bounds where the argument goes: in that time it may come nearer to where the function bends by no
 * more than the order resolves, and then the last terms show what follows. */
#include "numbers.h"

#ifndef PLRT_UNRESOLVED_H
#define PLRT_UNRESOLVED_H
/* exp; sinh, cosh; tanh; high powers of sin and cos; atan; what is divided by, and of log */
enum { PL_UNRESOLVED_RISE, PL_UNRESOLVED_SPREAD, PL_UNRESOLVED_TURN, PL_UNRESOLVED_TEETH, PL_UNRESOLVED_ARC,
	  PL_UNRESOLVED_DIVISOR };
#endif

#if PL_SINGLE
#define PL_FLAT 10      /* beyond it tanh is 1 to the last digit; */
#define PL_GONE (-30)   /* below it exp is nothing beside whatever it stands with */
#else
#define PL_FLAT 20
#define PL_GONE (-60)
#endif

/* A bound on how far a polynomial of this degree moves over `size`; its coefficients stand `stride` apart. */
static real PL(moves)(const real *c, int stride, int degree, real size)
{
	real sum = 0;
	int k;
	for (k = degree * stride; k > 0; k -= stride) {
		sum = (sum + pl_magnitude(c[k])) * size;
	}
	return sum;
}

/* Bounds of its values over `size` from its start: of a quartic by its Bezier points, and what later terms add at
 * most */
static void PL(bounds)(const real *c, int stride, int degree, real size, real bound[2])
{
	real p[5] = {0, 0, 0, 0, 0}, b[4], power = 1, rest = 0;
	int k;
	for (k = 0; k <= degree; k++) {
		const real term = c[k * stride] * power;
		if (k < 5) {
			p[k] = term;
		} else {
			rest += pl_magnitude(term);
		}
		power *= size;
	}
	b[0] = p[0] + p[1] / 4;
	b[1] = p[0] + (p[1] / 2 + p[2] * ((real)1 / 6));
	b[2] = p[0] + ((real)0.75 * p[1] + p[2] / 2 + p[3] / 4);
	b[3] = p[0] + (p[1] + p[2] + p[3] + p[4]);
	bound[0] = bound[1] = p[0];
	for (k = 0; k < 4; k++) {
		bound[0] = b[k] < bound[0] ? b[k] : bound[0];
		bound[1] = b[k] > bound[1] ? b[k] : bound[1];
	}
	bound[0] -= rest;
	bound[1] += rest;
}

/* Whether a function of this kind is followed over `size`, whose argument has these coefficients: `rise` is what an
 * exponent may gain, e^rise is `factor` */
static int PL(follows)(const real *c, int stride, int degree, real size, int kind, real rise, real factor)
{
	const real start = pl_magnitude(c[0]), moves = PL(moves)(c, stride, degree, size);
	real bound[2], near, far;
	if (kind == PL_UNRESOLVED_TEETH) {
		return moves <= rise;
	}
	if (moves <= (kind < PL_UNRESOLVED_ARC ? rise / 2 : (real)0.75 * start)) {
		return 1;
	}
	PL(bounds)(c, stride, degree, size, bound);
	near = bound[0] > 0 ? bound[0] : bound[1] < 0 ? -bound[1] : 0;
	far = bound[1] > -bound[0] ? bound[1] : -bound[0];
	switch (kind) {
	case PL_UNRESOLVED_RISE:
		return bound[1] <= PL_GONE || bound[1] <= c[0] + rise;
	case PL_UNRESOLVED_SPREAD:
		return far <= start + rise;
	case PL_UNRESOLVED_TURN:
		return near >= PL_FLAT || near >= start - rise / 2;
	case PL_UNRESOLVED_ARC:
		return 1 + start * start <= factor * (1 + near * near);
	default:
		return start <= factor * near;
	}
}
