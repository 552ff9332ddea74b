/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What coefficients at one time may not show. */
#ifndef PLGEN_STEP_UNSEEN_H
#define PLGEN_STEP_UNSEEN_H

#include "step/step.h"

/* ---- unseen.c: what coefficients at one time may not show ---- */

enum unseen_kind {                  /* what of the argument a series has to follow: */
	UNSEEN_RISE,                /* exp: how far it rises, */
	UNSEEN_SPREAD,              /* sinh, cosh: how far it goes off 0, */
	UNSEEN_TURN,                /* tanh: how near it comes to 0, */
	UNSEEN_TEETH,               /* high powers of sin and cos: how far it goes, */
	UNSEEN_ARC,                 /* atan: likewise, */
	UNSEEN_DIVISOR              /* log, and what is divided by: by which factor it falls */
};
struct unseen {
	const struct form *form;
	enum unseen_kind kind;
	int power;                  /* of TEETH */
	int column;                 /* as of an expression */
};

#endif
