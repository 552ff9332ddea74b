/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Invariant subspaces as double precision finds them. Of math/ alone. */
#ifndef PLGEN_INVARIANT_H
#define PLGEN_INVARIANT_H

#include "math/math.h"

struct cell { int row, column; };
struct invariants {
	int n;
	double *scale;              /* D */
	double *re, *im;            /* eigenvalues */
	/* n x n, balanced: eigenvectors as columns of V, of a subspace of several an orthonormal basis; W = V^-1 */
	double *V_re, *V_im, *W_re, *W_im;
	int parts;
	struct invariant *part;
	int *member;                /* eigenvalues, part by part; those of the lower half plane are nobody's */
	int cells;                  /* of A that are not 0 */
	struct cell *cell;
	const mpq_t *A;
	mpfr_t *value;              /* of the cells, of `precision` bits; NULL: not yet */
	int precision;
	double size;                /* of A, balanced: its largest row */
	int leading;                /* entries, of which the largest of a basis of one vector is 1 */
};

#endif
