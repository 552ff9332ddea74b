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

struct massless_slider;
struct drag;
struct impact;
struct switching;
struct tuning;

/* ---- model.c: the equations of motion, exact ---- */

struct model_names {
	const char **coord;
	const char **state;         /* x1, x2, x1', x2' */
};
struct model_contacts {             /* of regions and of other schemes: gen/model/contacts */
	int massless_sliders;
	struct massless_slider *massless_slider; /* friction without mass, by what it bears */
	int impacts;                /* in the order in which they act at one instant */
	struct impact *impact;
	int drags;                  /* friction that a Taylor series goes beside */
	struct drag *drag;
	int masses;                 /* mass matrices of the state: the equations that each couples */
	const struct linear_system **mass;
	struct form *const *multiplier; /* solved for, without what holds */
};
struct model_params {               /* tunable ones: gen/model/tunable */
	const struct tuning *tuning; /* and how linear equations follow from them; NULL: there are none */
	/* the instance has them: the remainder and outputs read them, or they act like held inputs */
	bool kept;
	struct leads leads;         /* what the instance has behind them */
	const struct tuning *held;  /* those that the instance has in such a way: no more than a list */
	const struct param_range **range; /* per given one; NULL: it may have any value */
	const struct form **derived; /* spec->tuned.derived: over the params that are given */
	const bool *factor;         /* per param: regions have it as a number, in their matrices; NULL: none */
	const struct tuning *retuned; /* held, and how these follow from it; NULL: no param is such */
};
struct model {
	struct spec *spec;
	struct request request;
	const char *name;           /* prefix of everything generated */
	int n;                      /* coordinates */
	struct model_names names;
	struct frame frame;         /* the coordinates, and how the written ones follow from them */
	struct linear system;       /* as written */
	struct equations equations;
	mpq_t *initial;             /* one per state */
	mpq_t h;
	enum scheme scheme;
	int most_events;            /* in a step; 0: not given */
	struct truncation truncation; /* of a scheme that expands or collocates; else all 0 */
	struct operator_schedule schedule;
	struct remainder remainder;
	struct model_contacts contacts;
	struct switching *switching; /* exact: the regions of a piecewise-linear model; NULL: it has one */
	struct nonlinear nonlinear;
	struct model_params params;
	int outputs;
	struct output *output;
	bool declared_outputs;
	struct needs needs;
	const struct delays *delays;
	const struct model *written; /* itself; of a reduced model: the one that it was made of */
	struct reduction reduction;
	struct wanted_modes modes;
	int ranges;                 /* of the written model's states */
	struct state_range *range;
	/* the model is over other coordinates than the written ones; NULL: over those */
	const struct relative *relative;
};

const struct unit *unit_of_state(const struct model *model, int state); /* as it is kept; NULL: not known */
struct model *model_build(struct spec *spec, const struct request *request);
struct model *model_copy(const struct model *model);         /* to change what is asked of it */
void argument_value(struct model *model, const char *text, mpq_ptr value); /* of --solution; may use params */

/* ---- stepped.c: the model that a step is built of ---- */

struct model *stepped_model(struct model *model, struct spec *spec, const struct request *request); /* NULL: said why */

/* ---- delays.c: what users see of a model, which with delayed inputs is around it ---- */

const char *outer_name(const struct model *model);
void output_rows(const struct linear *system, int force_columns, struct output *output);    /* of zeros: outputs.c */
int outer_inputs(const struct model *model);
mpq_srcptr outer_step(const struct model *model);            /* [s] */

#endif
