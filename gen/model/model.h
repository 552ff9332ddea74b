/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The equations of motion, exact: M, C, K, loads, operators, regions, outputs. */
#ifndef PLGEN_MODEL_MODEL_H
#define PLGEN_MODEL_MODEL_H

#include "collect/collect.h"
#include "math/math.h"
#include "model/series/remainder.h"
#include "model/linear/linear.h"
#include "request.h"
#include "tape/tape.h"

struct bearing;
struct drag;
struct impact;
struct residual;
struct shortening;
struct snapshot;
struct switching;
struct target;
struct tuning;

/* ---- model.c: the equations of motion, exact ---- */

struct model {
	struct spec *spec;
	struct request asked;
	const char *name;           /* prefix of everything generated */
	int n;                      /* coordinates */
	const char **coord_name;
	const char **state_name;    /* x1, x2, x1', x2' */
	struct frame frame;         /* the coordinates, and how the written ones follow from them */
	struct linear system;       /* as written */
	struct residual *residual;  /* per row of the system, in the first segment of time */
	struct snapshot *snapshot;  /* per segment */
	struct snapshot *whole;     /* for all time, conditions and products of time kept; NULL: nothing is left over */
	struct irrationals irrationals;
	mpq_t *initial;             /* one per state */
	mpq_t h;
	enum scheme scheme;
	struct truncation truncation; /* of a scheme that expands; else all 0 */
	bool loads_left;            /* known loads are left to the scheme */
	int stages;                 /* of collocation: nodes after the step's start; 0: another scheme */
	int operators;              /* 0: exact, or nothing is left over */
	struct operator *operator;
	int *owner;                 /* per coordinate: the row of its equation */
	int channels;               /* of what is left over, of each operator: one for each equation that has some */
	int *channel_row;           /* its equation */
	struct form **left_slope;   /* of a scheme that collocates: [channel][state], the remainder's derivative */
	const struct atoms *atoms;
	int bearings;
	struct bearing *bearing;    /* friction without mass, by what it bears */
	struct switching *switching; /* exact: the regions of a piecewise-linear model; NULL: it has one */
	int impacts;                /* in the order in which they act at one instant */
	struct impact *impact;
	int drags;                  /* friction that a Taylor series goes beside */
	struct drag *drag;
	struct smoothness smooth;
	const struct node *obstacle; /* the first term that stood in the way of exact, where no scheme was asked for; */
	const char *obstacle_text;  /* why it did, and the way out if there is one */
	int nonlinears;             /* terms that no M, C and K have, by place */
	struct nonlinear *nonlinear;
	struct splitting *split;    /* of a scheme in normal modes; else NULL */
	const struct form *selector; /* of a bank: what is compared with `at`; NULL: one operator */
	const struct tuning *tuning; /* tunable params, and how the equations follow from them; NULL: there are none */
	/* the instance has tunable params: what is left over and outputs read them, or they act like held inputs */
	bool keeps_params;
	struct leads leads;         /* what the instance has behind them */
	const struct tuning *held;  /* those that the instance has in such a way: no more than a list */
	const struct form **derived; /* spec->derived: over the params that are given */
	const bool *factor;         /* per param: regions have it as a number, in their matrices; NULL: none */
	const struct tuning *retuned; /* held, and how these follow from it; NULL: no param is such */
	int outputs;
	struct output *output;
	bool declared_outputs;
	/* per coordinate: its highest derivative as a row, where an output that is not linear reads it */
	struct output **highest;
	int requirements;           /* needs; the target of a budget, its instructions a step; 0: there is none */
	struct requirement *requirement;
	const struct target *target;
	double budget;
	const struct delays *delays;
	const struct model *written; /* itself; of a reduced model: the one that it was made of */
	struct reduction reduction;
	struct wanted_modes modes;
	int ranges;                 /* of the written model's states */
	struct state_range *range;
	/* the model is over other coordinates than the written ones; NULL: over those */
	const struct relative *relative;
	const struct shortening *shortened; /* it is of some modes of another; NULL: it is not */
};

struct model *model_build(struct spec *spec, const struct request *request);
struct model *model_copy(const struct model *model);         /* to change what is asked of it */
void argument_value(struct model *model, const char *text, mpq_ptr value); /* of --solution; may use params */

/* ---- stepped.c: the model that a step is built of ---- */

struct model *stepped_model(struct model *model, struct spec *spec, const struct request *request); /* NULL: said why */

#endif
