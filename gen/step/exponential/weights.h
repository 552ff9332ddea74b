/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What forces and forcing terms give a mode in a step. */
#ifndef PLGEN_STEP_WEIGHTS_H
#define PLGEN_STEP_WEIGHTS_H

#include "step/step.h"

/* ---- weights.c: what a force that is a polynomial over a step gives a mode ---- */

struct normal_mode { mpfr_t lambda, delta; };      /* eta'' + 2 delta eta' + lambda eta = F [1/s^2, 1/s] */
struct lagrange {                   /* polynomials of s/h, each 1 at one of the nodes and 0 at all others */
	int nodes;
	mpfr_t *node;
	mpfr_t *factor;             /* nodes x nodes: of polynomial i that of (s/h)^j */
};
struct mode_flow {                  /* of one mode over theta h */
	/* eta = e eta0 + s eta0' + ..., eta' = de eta0 + ds eta0' + ... */
	mpfr_t e, s, de, ds;
	mpfr_t *position, *rate;    /* ... + what a force of each polynomial adds to eta, to eta' */
};

/* ---- steady.c: a step once all functions of time are constant ---- */

int steady_size(const struct model *model);                 /* 2n + 1, and 2 for each forcing term */

/* ---- bank.c: what the remainders of a schedule's operators have in common ---- */

struct excess { /* a linear term in which they differ: a coordinate or its velocity, on a force column */
	int force_column, coord, order;
};
struct schedule {                   /* the remainder of an operator = common + sum of factor times term */
	int count;                  /* 0: of one operator */
	struct excess *excess;
	double *factor;             /* [operator][excess] */
	const struct form **common; /* per force column */
};
struct schedule schedule_of(const struct step *step);

#endif
