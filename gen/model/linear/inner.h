/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of model/linear have from one another, and nobody else. */
#ifndef PLGEN_MODEL_LINEAR_INNER_H
#define PLGEN_MODEL_LINEAR_INNER_H

#include "relative.h"
#include "modal_truncation.h"

struct relative *relative_new(const struct model *model);    /* without a link */
void complete_relative(struct relative *r);                  /* once it is linked: names, orders and forms */
struct relative *relative_of(const struct model *model);     /* NULL: no rigid-body mode has several coordinates */

/* ---- modes.c, participation.c: the modes of a linear model, and what each of them gives to the outputs ---- */

/* block, right and left; doing it again costs nothing. False: it does not converge, as of a model whose poles lie too
 * close for double precision. */
bool mode_refine(struct modes *modes, int index);

/* ---- what modes.c and participation.c share ---- */

struct mode_basis {
	struct invariants *invariants; /* of A, or of M^-1 K */
	bool moves;                 /* of M^-1 K */
	mpq_t *A;                   /* the matrix that it is of */
	mpq_t *D;                   /* M^-1 C, where modes are coordinates */
	mpq_t *inverse;             /* W^-1 */
};

/* ---- participation.c ---- */

struct participation;
struct participation *participation_of(const struct modes *modes); /* which have a basis */
/* of largest size; needs first, columns, moves, states */
void participation_of_poles(const struct participation *s, struct mode *mode);
/* fills in size, transient, by_input and seen */
void participation_of_mode(const struct participation *s, struct mode *mode);
void participation_free(struct participation *s);

#endif
