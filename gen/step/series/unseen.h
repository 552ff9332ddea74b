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
/* *looks: there is what no argument bounds, or what is steep: the slope inside and at the end is looked at too */
struct unseen *unseen_of(const struct model *model, int *count, bool *looks);
double crowded_frequency(const struct linear *system);      /* 1/s: the highest of loads that may cancel; 0: of few */

#endif
