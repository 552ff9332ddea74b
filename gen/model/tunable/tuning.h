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
/* Rows over x, exactly, for all values of the params */
struct tuned_equations {
	int rows, columns;          /* columns: entries of x */
	int entries;
	struct tuned_entry *entry;
};
enum retuned_kind {                 /* of rows: */
	RETUNED_SYSTEM,             /* of system: a row of A, x' = A x */
	RETUNED_OUTPUT,             /* of linear models */
	RETUNED_FUNCTION,           /* of segment of time: expression */
	RETUNED_BREAK,              /* of expression: breakpoint; a number, in column 0, as those below are */
	RETUNED_HOLD, RETUNED_RELEASE, RETUNED_FRICTION, /* of region: one of its holds, releases; friction */
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
struct tuning {
	int params, given;          /* given: in the statements `tunable`; the others follow from these */
	const struct tunable *param;
	mpq_t *nominal;             /* the spec's values */
	/* what follows is not there where an instance has no more than the params */
	struct layout x;            /* states, load states (linear: of each segment of time), inputs: of ramps u, u' */
	int rows;
	struct retuned_row *row;
	struct tuned_equations all; /* rows that params change, but those of systems */
	struct tuned_equations *system; /* A of each; of regions no entries where params do not change it */
	int outputs, frequencies;   /* of a linear model that params change */
	int *output;                /* per output: its row, or -1: no param changes it */
	bool *frequency;            /* per load: params change it */
	bool *acts;                 /* rows x columns of `all`: whether it is anything but 0 for some values */
	int numbers;                /* how entries follow from params: base/traced.c */
	const struct traced *number;
	const struct model *other;  /* at values that are related by nothing: what holds there holds for all */
};
/* model->tuning, or held and retuned, where something is tunable; NULL: it was said why not */
struct model *find_tuning(struct model *model, const struct request *request);
/* Of the record: which of it some equations are made of; how many of these are no params */
bool *numbers_behind(const struct tuning *t, int count, const struct tuned_equations *const *list);
int  operations_behind(const struct tuning *t, int count, const struct tuned_equations *const *list);
int  retuned_place(const struct tuning *t, enum retuned_kind kind, int of, int index);
/* Of a load the entry of A that is its frequency, in its first segment of time */
struct tuned_entry tuned_frequency(const struct tuning *t, int load);

/* ---- derived.c: what is computed from tunable params as if it were one ---- */

/* Puts names of further params, spec->derived of them, in the place of functions and conditions. Again it finds
 * nothing. */
void derive_params(struct spec *spec);

/* ---- params.c: tunable params that the instance has ---- */

/* NULL: it is not tunable, or none was given */
const struct param_range *range_of_param(const struct model *model, const struct symbol *param);
void spread_tuned(const struct spec *spec);     /* to params, matrices and lets that are made of tunable ones */
void refuse_what_stays(const struct spec *spec); /* of the spec's values, where tunable params are other ones */
/* the first name in it that is tunable, or made of what is; NULL: there is none */
const struct node *first_tuned(const struct node *node);
int  param_of_input(const struct spec *spec, int input);   /* -1: it is an input of the spec */
const struct tuning *tunables_of(const struct model *model); /* of either kind; NULL: nothing is */
/* at values related by nothing; NULL: no param is tunable in this way */
const struct model *model_elsewhere(const struct model *model);

#endif
