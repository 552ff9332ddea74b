/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The linear models of this folder, their equations written a second time by hand: x' = A x in rationals, x = states,
 * then loads and inputs; A may change in time.  Carried on with e^{A tau} of the second evaluator, 300 bits. */
#ifndef REFERENCE_H
#define REFERENCE_H

#include <gmp.h>
#include <mpfr.h>

enum { REFERENCE_MOST_SEGMENTS = 8, REFERENCE_BITS = 300, REFERENCE_PRECISION = 400 };

struct reference {
	const char *name;
	int states, size, segments;
	mpq_t change[REFERENCE_MOST_SEGMENTS];      /* A[i] until change[i] */
	mpq_t *A[REFERENCE_MOST_SEGMENTS];          /* size x size */
	const struct reference_table *table;
};

struct reference *reference_of(const char *name);       /* aborts where nobody has written them */
void reference_free(struct reference *r);

mpfr_t *new_floats(int count);
void free_floats(mpfr_t *x, int count);

/* x (size) <- y exactly, and the loads at t; inputs and slopes <- 0 */
void reference_start(const struct reference *r, const mpq_t t, const double *y, mpfr_t *x);
int reference_segment(const struct reference *r, const mpq_t t);
void reference_advance(const struct reference *r, const mpq_t from, const mpq_t to, mpfr_t *x);

void reference_matrix(const struct reference *r, int segment, const mpq_t tau, mpfr_t *E);
void reference_apply(const struct reference *r, mpfr_t *E, mpfr_t *x);
void reference_row(const struct reference *r, int segment, int row, mpfr_t *x, mpfr_t result);  /* x'[row] */

#endif
