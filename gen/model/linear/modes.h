/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What modes.c and survey.c share. Of model/ alone. */
#ifndef PLGEN_MODES_H
#define PLGEN_MODES_H

#include "base/base.h"

struct modes;
struct mode;

struct mode_basis {
	struct invariants *invariants; /* of A, or of M^-1 K */
	bool moves;                 /* of M^-1 K */
	mpq_t *A;                   /* the matrix that it is of */
	mpq_t *D;                   /* M^-1 C, where modes are coordinates */
	mpq_t *inverse;             /* W^-1 */
};

/* ---- survey.c ---- */

struct survey;
struct survey *survey_of(const struct modes *modes);        /* which have a basis */
void survey_poles(const struct survey *s, struct mode *mode); /* of largest size; needs first, columns, moves, states */
void survey_mode(const struct survey *s, struct mode *mode); /* fills in size, transient, by_input and seen */
void survey_free(struct survey *s);

#endif
