/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models of fewer states with the same outputs, or nearly the same. */
#ifndef PLGEN_MODEL_MODAL_TRUNCATION_H
#define PLGEN_MODEL_MODAL_TRUNCATION_H

#include "model/model.h"

/* ---- reduce.c: the smallest model with the same outputs ---- */

struct model *model_reduce(struct model *model);             /* itself where nothing can go, or shall */
/* Are the states of both the same combinations of the same written ones? */
bool same_reduction(const struct model *a, const struct model *b);

/* ---- modes.c, participation.c: the modes of a linear model, and what each of them gives to the outputs ---- */

/* A mode is an invariant part of y' = A y that is real and as small as it can be: z = left y, z' = block z + left b u,
 * and right z is its share of y; left right = 1. It has the two states of a pair of poles, or the one of a real pole;
 * more where poles coincide or nearly do, as those of repeated frequencies and of rigid-body modes. Where M^-1 K
 * and M^-1 C share their modes (proportional damping, none) z is a coordinate and its velocity, z = (m, m'). */
struct mode {
	int number;                 /* by rising size of its poles, from 1; of several coordinates: the first's */
	int states;                 /* of z */
	int weight;                 /* how many it counts for: its pairs of poles and real poles; two poles 0 as one */
	bool moves;                 /* z = (m, m') */
	bool rigid;                 /* a pole is 0 */
	bool seen;                  /* some output reads it, and a load, an input or the start reaches it */
	double re, im;              /* its pole [1/s], im >= 0; where there are several: their middle */
	/* In units of the output: the largest size it can ever have in it by the start and the loads, the same of what
	 * is left once the forced part of loads is kept, and per input the largest that a step of height 1 gives;
	 * HUGE_VAL: no bound. In double precision: to choose by, and to report. */
	double *size;               /* [output] */
	double *transient;          /* [output] */
	double *by_input;           /* [output * inputs + input] */
	double share;               /* the largest part of the sum over all modes, in any output by any of these */
	/* Known once mode_refine was called; each number to 2^-MODE_BITS of the largest in its row */
	mpq_t *block;               /* states x states */
	mpq_t *right, *left;        /* states of the model x states; states x states of the model */
	int first, columns;         /* of the basis: modes.c; coordinates, where it moves */
};
struct modes {
	const struct model *model;
	int count;
	struct mode *mode;          /* by number */
	struct mode_basis *basis;   /* modes.c */
};
struct modal_truncation {           /* of a model of modes */
	const struct modes *modes;
	const bool *kept;           /* per mode */
	bool static_correction;     /* what is dropped still follows loads and inputs at once */
	/* z = to y of the whole model's states y, and from z is what is kept of y: states x the whole's, and back */
	mpq_t *to, *from;
};
/* Of a linear model with declared outputs. NULL: `*why` says what stands against it ("a param is tunable"). */
struct modes *modes_of(const struct model *model, const char **why);
/* by falling share, rigid ones that are seen before all others: indices into `mode` */
int *modes_by_share(const struct modes *modes);

/* ---- modal_truncation.c: the model of some of its modes ---- */

/*
 * To try subsets of modes, and to go on with one:
 *
 *     struct modes *modes = modes_of(model, &why);
 *     bool *kept = ARRAY(bool, (size_t)modes->count);
 *     ... kept[i] = true ...                  modes->mode[i].size, transient, by_input say what each would add
 *     struct model *error = modes_dropped(modes, kept, true);     what would be lost, exactly
 *     struct model *shorter = modes_kept(modes, kept, true);      what is stepped: step_build(shorter)
 *
 * Both are ordinary rational linear models with an own block of `system` for each mode, so their B(s) have degree 2 and
 * residues are cheap: output i of `modes_dropped` is e_i(t) = output i of the model less that of `modes_kept`, under
 * the same loads (rows `load` of its outputs), inputs (rows `input`) and from its own `initial`. With r = c e^{block t}
 * of a mode, e(t) = sum over dropped modes of r (z(0) - P q(0)) where the forced parts P q(t) of loads q are kept, and
 * for inputs h_e = r left b, less the static gain. `written` of both is the model.
 *
 * `statics`: what is dropped still follows its loads and inputs at once: the outputs get the forced part of what is
 * dropped for each load, and its static gain for each input (rows `load` and `input` of struct output; no states).
 * What is dropped has rigid modes, or a load has a pole of it: that part is not kept.
 * NULL: a mode is not found (mode_refine), or, of modes_dropped, none is dropped.
 */
struct model *modes_kept(struct modes *modes, const bool *kept, bool static_correction);
struct model *modes_dropped(struct modes *modes, const bool *kept, bool static_correction);
/* The largest that output can lose by what is dropped, from the start and by loads, at any time; HUGE_VAL: no bound.
 * In double precision. */
double truncation_of_modes(const struct modes *modes, const bool *kept, bool static_correction, int output);
/* What the statement `modes` or --modes asks for; the model itself where neither does. NULL: it was said why not */
struct model *model_truncate(struct model *model);

#endif
