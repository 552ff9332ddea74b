/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Tunable params, and how equations, outputs and regions follow from them. */
#ifndef PLGEN_MODEL_TUNING_H
#define PLGEN_MODEL_TUNING_H

#include "model/model.h"

/* ---- retuned.c: how equations, outputs and regions follow from tunable params that are no inputs of them ---- */

struct tuned_entry {
	int row, column;
	struct traced_part value;   /* of the record of struct tuning */
	unsigned params;            /* the given ones that it follows from, a bit each */
};
/* W a = R x, exactly, for all values of the params */
struct tuned_equations {
	int rows, columns;          /* entries of a, of x */
	bool solves;                /* there is a W, columns behind those of R; else it is the unit matrix */
	int entries;
	struct tuned_entry *entry;
	int operations;             /* by which these follow from params */
};
enum retuned_kind {                 /* of rows: */
	RETUNED_SLOPE,              /* of system: coordinate's highest derivative over x, */
	/* which is that of W a = R x: of R, and of W over highest derivatives; likewise of what reads these */
	RETUNED_R, RETUNED_W,
	RETUNED_OUTPUT, RETUNED_OUTPUT_R, RETUNED_OUTPUT_W, RETUNED_FREQUENCY, /* of linear models; load, a number */
	RETUNED_FUNCTION,           /* of segment of time: expression */
	RETUNED_BREAK,              /* of expression: breakpoint; a number, in column 0, as those below are */
	RETUNED_HOLD, RETUNED_RELEASE, RETUNED_FRICTION, /* of region: one of its holds, releases; friction */
	RETUNED_RELEASE_R, RETUNED_RELEASE_W, RETUNED_FRICTION_R, RETUNED_FRICTION_W,
	RETUNED_JUMP, RETUNED_STILL, /* of impact: one of its jumps, of those without restitution */
	RETUNED_SPEED, RETUNED_BACK, RETUNED_RESTITUTION, /* of impact; restitution is a number */
	RETUNED_LEAST,              /* a number that is at least 0: a force of friction, the gap of a stop */
	RETUNED_SIGN                /* a number that stays above, or below, 0 */
};
struct retuned_row {
	enum retuned_kind kind;
	int of, index, place;       /* place: row of what the target evaluates; -1: no param changes it */
	bool positive;
};
struct retuned_block {              /* a system that the target solves, and what reads its highest derivatives */
	struct tuned_equations all;
	int place;                  /* of its first row */
};
struct tuning {
	int params, given;          /* given: in the statements `tunable`; the others follow from these */
	const struct tunable *param;
	mpq_t *nominal;             /* the spec's values */
	/* what follows is not there where an instance has no more than the params */
	struct layout x;            /* states, load states (linear: of each segment of time), inputs: of ramps u, u' */
	int rows;
	struct retuned_row *row;
	/* Of a linear model the highest derivatives of the coordinates, then the outputs that depend on params, then
	 * frequencies of loads that do (in column 0). Of regions all rows, of which blocks have terms of their own. */
	struct tuned_equations all;
	int blocks;
	struct retuned_block *block;
	int outputs, frequencies;   /* of a linear model: of its rows, behind those of coordinates */
	int *output, *frequency;    /* per output, per load: its row, or -1: no param changes it */
	bool *acts;                 /* rows x columns, solved: whether it is anything but 0 for some values */
	int numbers;                /* how entries follow from params: base/traced.c */
	const struct traced *number;
	const struct model *other;  /* at values that are related by nothing: what holds there holds for all */
};
/* model->tuning, or held and retuned, where something is tunable; NULL: it was said why not */
struct model *find_tuning(struct model *model, const struct request *request);
void count_operations(const struct tuning *t, struct tuned_equations *all);
/* Of the record: which these are made of */
bool *numbers_behind(const struct tuning *t, const struct tuned_equations *all);
int  retuned_place(const struct tuning *t, enum retuned_kind kind, int of, int index);

/* ---- derived.c: what is computed from tunable params as if it were one ---- */

/* Puts names of further params, spec->derived of them, in the place of functions and conditions. Again it finds
 * nothing. */
void derive_params(struct spec *spec);

/* ---- params.c: tunable params that the instance has ---- */

void spread_tuned(const struct spec *spec);     /* to params, matrices and lets that are made of tunable ones */
/* the first name in it that is tunable, or made of what is; NULL: there is none */
const struct node *first_tuned(const struct node *node);
int  param_of_input(const struct spec *spec, int input);   /* -1: it is an input of the spec */
const struct tuning *tunables_of(const struct model *model); /* of either kind; NULL: nothing is */
/* at values related by nothing; NULL: no param is tunable in this way */
const struct model *model_elsewhere(const struct model *model);

#endif
