/* SPDX-License-Identifier: GPL-3.0-or-later */
/* e^{A tau} as taylor.c encloses it and polynomial.c knows parts of it exactly. Of math/ alone. */
#ifndef PLGEN_TAYLOR_H
#define PLGEN_TAYLOR_H

#include "math/balls.h"

enum { LARGEST_BLOCK = 32 };            /* powers of B kept */

struct taylor {
	int n;
	struct taylor *half;        /* the same A at half the time: this is its square; NULL: a series */
	mpq_t *B;                   /* A tau */
	mpq_t *A, tau;
	struct magnitude *B_size;
	int *distance;              /* n x n: length of the shortest path in B; -1: none */
	long *scale;                /* log2 d_i */
	struct magnitude norm;      /* ||D^-1 |A tau| D|| */
	int depth;                  /* largest distance */
	/* per distance: log2 of the least entry of D^-1 |A tau|^k/k! D first reached there */
	long *least;
	int64_t density[LARGEST_BLOCK + 1]; /* nonzeros of B^q */
	int64_t filled;             /* and of e^B */
	int precision;              /* what `value` is known to; 0: nothing */
	long loss;                  /* bits lost on the way, as far as known */
	struct balls value;
	bool *cyclic;               /* taylor_exact: per state, whether a cycle leads through it; NULL: not yet found */
	bool *survivor;             /* n x n: (A^k)_ij = 0 for n <= k < 2n modulo a prime; NULL: not yet found */
	struct exact_row *row;      /* the last one proved, or NULL */
};

#endif
