/* SPDX-License-Identifier: MIT-0 */
/* ladder.h: by which lengths a step of regions goes, for the runtime's own use: by crossings.c and guards.c.  Beside a
 * pole that turns far in h the shortest piece, in which crossings are looked for, is a small part of the step; longer
 * ones are taken where a bound shows that nothing is crossed. */
#ifndef PLRT_LADDER_H
#define PLRT_LADDER_H

#include "compensated.h"

enum { TOP = 32, PATIENCE = 16 }; /* TOP: above every rung */
enum { GO_ON, SEARCH_NO_MORE, STAY }; /* behind an event: STAY, x is held there for the rest of the step */

typedef struct climb {
	int rung, rungs;  /* where it is; rungs: that of h */
	int steady, wait; /* event-free pieces, of those that it takes before a longer one is tried */
	int tried;        /* this one is */
	int bent;         /* x'' is known */
	int rested;       /* what rounding has taken from x is known */
} climb;

static const climb at_top = {TOP, 0, 0, 1, 0, 0, 0};

/* What an event leaves may move as fast as any pole. */
static void to_the_ground(climb *at)
{
	at->rung = at->steady = at->tried = at->bent = 0;
	at->wait = 1;
}

static real length_of(const pl_ladder *l, const int *halvings, int matrix, int rung, real h)
{
	const int down = halvings[matrix] - rung * l->spacing[matrix];
	return h / (real)((uint32_t)1 << (down > 0 ? down : 0));
}

static void clear_low(int n, real *x_low)
{
	int i;
	for (i = 0; i < n; i++) {
		x_low[i] = 0;
	}
}

/* The length of the piece to be tried, at most `left` unless it is the shortest */
static inline real stand(climb *at, const pl_ladder *l, const int *halvings, int matrix, real h, real left, int n,
						 real *x_low)
{
	real length;
	if (halvings[matrix] == 0) {
		at->rung = at->rungs = 0;
		return h;
	}
	if (!at->rested) {
		clear_low(n, x_low);
		at->rested = 1;
	}
	at->rungs = (halvings[matrix] - 1) / l->spacing[matrix] + 1;
	at->rung = at->rung < at->rungs ? at->rung : at->rungs;
	length = length_of(l, halvings, matrix, at->rung, h);
	while (at->rung > 0 && left <= length * (1 - REST)) {
		length = length_of(l, halvings, matrix, --at->rung, h);
		at->tried = 0;
	}
	return length;
}

/* y: x a piece on.  x_low: 2 n */
static inline void take_piece(int n, const climb *at, const pl_ladder *l, const real *Phi, int matrix, const real *x,
							  real *y, real *x_low)
{
	int i;
	if (at->rung < at->rungs) {
		rung_piece(n, l->pieces, l->first[matrix] + at->rung, x, y, x_low);
		return;
	}
	full_piece(n, Phi, matrix, x, y);
	for (i = 0; i < n && at->rungs > 0; i++) {
		x_low[n + i] = 0;
	}
}

static inline void keep_piece(int n, const climb *at, const real *y, real *x, real *x_low)
{
	int i;
	for (i = 0; i < WORDS * n; i++) {
		x[i] = y[i];
	}
	for (i = 0; i < n && at->rungs > 0; i++) {
		x_low[i] = x_low[n + i];
	}
}

/* It was event-free: a longer one is tried, or after as many as it takes where the last trial was in vain. */
static inline void rise(climb *at)
{
	at->bent = 0;
	if (at->rungs == 0) {
		return;
	}
	at->wait = at->tried ? 1 : at->wait;
	at->tried = ++at->steady >= at->wait && at->rung < at->rungs;
	if (at->tried) {
		at->rung++;
		at->steady = 0;
	}
}

/* It may not have: whether there is a shorter one to try */
static inline int fall(climb *at)
{
	if (at->rung == 0) {
		return 0;
	}
	if (at->tried && at->wait < PATIENCE) {
		at->wait *= 2;
	}
	at->rung--;
	at->steady = at->tried = 0;
	return 1;
}

/* What has overflowed stays so, and is not followed through a million pieces. */
static int is_lost(const climb *at, int n, const real *x)
{
	return at->rungs > 0 && pl_not_finite(x, n);
}

/* |x''| and what rounding may have hidden of it, entry by entry, once for each x.  work: 2 n */
static void look_at_bend(climb *at, int n, const real *A, const real *x, real *bend, real *work)
{
	real *slope = work, *terms = slope + n;
	int i;
	if (at->bent) {
		return;
	}
	pl_multiply(n, n, A, x, slope);
	pl_multiply(n, n, A, slope, bend);
	for (i = 0; i < n; i++) {
		terms[i] = sizes(n, A + (ptrdiff_t)i * n, x);
	}
	for (i = 0; i < n; i++) {
		bend[i] = magnitude(bend[i]) + (real)n * noise_of(sizes(n, A + (ptrdiff_t)i * n, terms));
	}
	at->bent = 1;
}

#endif
