/* SPDX-License-Identifier: MIT-0 */
/* columns.h: switching functions beside a Taylor series, as columns of its coefficients, for the runtime's own use: by
 * crossings.c and events.c. */
#ifndef PLRT_COLUMNS_H
#define PLRT_COLUMNS_H

#include "roots.h"

/* Below it all is 0, as what impacts have halved for ever without a force: sweeps that leave 7/8 of a speed take it
 * there before there are too many. */
#ifdef REAL_IS_FLOAT
#define TINY 0x1p-96f
#else
#define TINY 0x1p-192
#endif

typedef struct column { /* of the coefficients of a series: those of one switching function */
	const pl_series_switching *m;
	const real *first;
	real terms; /* the size of what its value at the start is summed from */
} column;

static real column_at(const column *e, int k)
{
	return e->first[(ptrdiff_t)k * e->m->columns];
}

/* e - b at the start, and what rounding may have done to it: a gap that counts while speeds of its size are none
 * would be flown through for ever */
static real off_start(const column *e, real b, real *noise)
{
	*noise = noise_of(e->terms + magnitude(b) + magnitude(column_at(e, 1))) + TINY;
	return column_at(e, 0) - b;
}

/* Whether e is above b, or there and about to be: the first derivative that is not 0 but for rounding */
static int starts_above(const column *e, real b)
{
	real noise, largest = 0;
	const real off = off_start(e, b, &noise);
	int k;
	if (off > noise || off < -noise) {
		return off > 0;
	}
	for (k = 1; k <= e->m->degree; k++) {
		largest = larger(largest, magnitude(column_at(e, k)));
	}
	for (k = 1; k <= e->m->degree; k++) {
		if (magnitude(column_at(e, k)) > noise_of(largest)) {
			return column_at(e, k) > 0;
		}
	}
	return 0;
}

static column column_of(const pl_series_switching *m, const real *c, const real *terms, int expression)
{
	column e;
	e.m = m;
	e.first = c + m->column[expression];
	e.terms = terms[expression];
	return e;
}

/* The coefficients of e in s, 0 <= s <= 1 up to `end`; at least to the third, which bounds read */
static void rescale(const column *e, real end, real *coefficient)
{
	real power = 1;
	int k;
	for (k = 0; k <= e->m->degree; k++, power *= end) {
		coefficient[k] = column_at(e, k) * power;
	}
	for (; k < 4; k++) {
		coefficient[k] = 0;
	}
}

#endif
