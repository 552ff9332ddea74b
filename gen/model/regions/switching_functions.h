/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is compared with breakpoints. */
#ifndef PLGEN_MODEL_SWITCHING_FUNCTIONS_H
#define PLGEN_MODEL_SWITCHING_FUNCTIONS_H

#include "model/model.h"

struct switching_function {                 /* what is compared with breakpoints: linear in states, loads and inputs */
	struct form *form;          /* without constant; sign and scale as first written */
	/* in each segment of time it is in + shift: its loads may have other formulas */
	int segments;
	struct form **in;
	mpq_t *shift;
	int terms;
	struct comparing *term;     /* that compare it: switching_functions.c */
	struct output *row;         /* the same as a row */
	int breaks;
	mpq_t *at;                  /* rising */
	const struct node *node;    /* where it comes from */
	int stride;                 /* of its interval in the index of a region */
	int met;                    /* rises in the order in which the equations show switching functions */
};

/* ---- switching_functions.c: what is compared with breakpoints ---- */

struct compared {                   /* form + constant with 0 */
	const struct node *node;    /* by this term */
	struct form *form;          /* without constant */
	mpq_srcptr constant;
	int met;                    /* of struct switching_function, where it is one */
};
/* what breakpoints divide, in a segment of time */
struct form *form_in(const struct switching_function *e, int segment);
const char *text_of_function(const struct model *model, int index);   /* x - t; from t = 2 on x - 1 */

#endif
