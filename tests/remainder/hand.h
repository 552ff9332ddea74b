/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The schemes with a remainder a second time, by hand: in long double, on equations written by hand.  Loads and inputs
 * are carried as further entries of w, so that e^{A tau} w is their exact response too. */
#ifndef HAND_H
#define HAND_H

typedef long double real;

enum { HAND_MOST = 40 };                    /* entries of w: states, load states, inputs, slopes of the inputs */

struct system {
	const char *name;
	int states, loads, inputs;
	real start[HAND_MOST];                  /* the spec's initial state */
	/* as written; u: inputs, then their slopes */
	void (*equations)(real t, const real *y, const real *u, real *dydt);
	void (*loads_at)(real t, real *z);      /* load states; NULL where there are none */
	/* size x size, zeroed before: operator, columns and rows of the loads */
	void (*linear)(const struct system *s, int which, real *A);
	int operators;                          /* of a bank; 0 counts as 1 */
	int (*choose)(real t, const real *y);   /* which of them a step from there takes; NULL: the first */
};

/* Entries of w. */
int size_of(const struct system *s);

/* d(dydt)/d(y, u) by central differences of order 8; into the rows of the states of A, at the state y and inputs 0. */
void jacobian(const struct system *s, real t, const real *y, real *A);

struct hand;

struct hand *hand_new(const struct system *s, const char *scheme, real h);
void hand_free(struct hand *p);

/* y <- the state h after t.  u: the inputs at t, then their slopes over the step. */
void hand_step(const struct hand *p, real t, const real *u, real *y);

/* e^{A h} of the operator `which`, row-major, size x size. */
const real *hand_flow(const struct hand *p, int which);

/* phi[k] <- phi_k(A tau), k = 0 .. 3; n x n each. */
void phi_functions(int n, const real *A, real tau, real *phi[4]);

#endif
