/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Everything that is emitted for one model: its step. */
#ifndef PLGEN_STEP_STEP_H
#define PLGEN_STEP_STEP_H

#include "model/capability.h"
#include "program.h"
#include "slopes.h"

struct refresh;
struct choice;

struct board_cost {                 /* of a step on a Cortex-M4, whose FPU has float alone */
	double mean, most;          /* instructions, an estimate by the operations that steps have done */
	int steps;                  /* from the initial values on, inputs 0 */
	long bytes;                 /* of an instance */
	const char *why;            /* there is none; NULL: there is */
};
struct collocation;
struct event_split;
struct expansion;
struct forced;
struct modal;
struct varied_model;
struct normal;
struct denormal_flush;
struct derivatives;
struct reference;
struct rows;
struct tuned_blocks;

struct rounding {                   /* a bound over the first steps from the initial values, inputs 0 */
	bool known;
	int steps;
	const char *state;          /* as written or as it is kept: where it is largest */
	double relative;            /* to the state's largest value */
	bool tiny;                  /* there are states too small for the target's range, which it leaves out */
};

struct absent {                     /* why it is not there, where a reader would ask; NULL: it is, or nobody would */
	const char *modal;          /* though it would be cheaper */
	const char *lanes;          /* instances of a batch step each by itself */
	const char *refresh;        /* of loads that have functions */
	const char *rows;           /* NAME_run goes step by step */
	const char *phi;            /* e^{A h}, which a collocated step does not need */
};
struct event_check {                /* of regions: whether a step is first checked for events over the whole of h, */
	bool is_made, fast_path;    /* and for few crossings, by Taylor polynomials of this degree */
	bool by_region;             /* by numbers of each region, not by tables of all */
	int degree;
	const char *searches;       /* why a step is not checked, and goes by the search */
};
struct kicks {                      /* of kick-drift-kick */
	const mpq_t *mass;          /* per coordinate; in units of the first */
	bool momenta;               /* NAME keeps mass times velocity, since not all masses are equal */
};
struct carried {                    /* states that nothing leads back from, which only add up */
	int count, *place;          /* of what rounding takes from each; -1: of others */
};
struct linear_step {                /* what steps of linear models alone have */
	struct kicks kicks;
	struct denormal_flush *flush;          /* of decayed states; NULL: none */
	struct load_phase *phase;   /* per load */
	mpfr_t growth;              /* pl: 1/s, largest real part of the modified equation's poles (report only) */
};
struct region_step {                /* steps of piecewise-linear ones */
	struct event_check event_check;
	int parts;                  /* that are independent, each with a step of its own */
	struct step **part;
};
struct taylor_step {                /* what goes by Taylor series; else all NULL */
	struct expansion *expansion;
	struct expansion *switching;  /* whose expressions choose formulas by the state; NULL: none does */
	const struct expansion *unresolved; /* what polynomials may not show of it bounds them; NULL: nothing does */
	struct expansion *slopes;   /* of the states, where such a series is looked at further on; else NULL */
	struct expansion *motion;   /* what outputs read beside contacts; else NULL */
};
struct step {                       /* everything that is emitted for one model */
	const struct model *model;
	struct model *plain;        /* without an option that stands aside: to be built in its place; or NULL */
	struct descriptor is;
	struct resolvent *written;  /* of the model as written: the report's poles, the closed form */
	/* what users see of tables: over the states as written; itself, where those are stepped */
	const struct step *shown;
	int branches;               /* 1 where there is no remainder */
	struct branch *branch;
	int tables;                 /* of each; 1 where there is no remainder */
	struct program *program;
	enum step_form form;        /* any but FORM_AUTO */
	struct linear_step linear;
	struct modal *modal;        /* NAME keeps modal states; NULL: of another form */
	struct carried carried;
	struct absent no;
	struct refresh *refresh;    /* NULL: functions of loads in every step */
	struct forced *forced;      /* NAME keeps the state less this; NULL: as it is */
	struct rounding rounding;
	const struct board_cost *board; /* NULL: it was not measured */
	struct choice *choice;      /* what it was chosen from; NULL: there are no needs */
	struct tuned_blocks *blocks; /* NULL: no linear step with tunable params */
	struct layout layout;       /* of x */
	struct series series;
	struct region_step regions;
	struct taylor_step taylor;
	struct event_split *event_split; /* of a step of this kind; else NULL */
	struct collocation *collocation; /* of a collocated step; else NULL */
	struct normal *normal;      /* of a step in normal modes; else NULL */
	const struct reference *replayed; /* what its own steps come to, for the self-test; NULL: a closed form does */
	struct derivatives *derivatives; /* by params and the like; NULL: none are asked for */
	struct rows *rows;          /* NAME_run in blocks of rows; NULL: step by step */
};
struct descriptor descriptor_of(const struct model *model);
bool is_linear_alone(const struct step *step);                /* without regions, tunable params or none */
bool is_refreshed(const struct step *step, int load);       /* its functions are evaluated at refreshes only */
const char *text_of_column(const struct linear *system, int column);
int load_of_column(const struct linear *system, int column, int *first); /* *first: the first column of that load */
bool is_forced(const struct step *step, int column);         /* is this load state's load left out of the step? */
/* those that a system or an expression reads */
bool *loads_of_regions(const struct step *step);

/* ---- facts.c: what is so of a step, and what stands against what is asked of it ---- */

struct facts facts_of_step(const struct step *step);
const char *step_objection(const struct step *step, enum capability requested); /* NULL: nothing does */
bool has_remainder(const struct step *step);

/* ---- derivatives.c: derivatives by params, initial values and along inputs ---- */

/* Some columns, whose model has the coordinates of the model itself first, then those of each column; so its outputs */
struct derivative_block {
	int first, columns;
	const struct step *step;
};
struct derivatives {
	int columns;
	const struct sensitivity *column;
	bool seeded;                /* some are along inputs */
	double *late;               /* per column and delayed input: of t - d; NULL: no delay moves */
	bool apart;                 /* each block goes the way of its own step, beside the model */
	int blocks;
	struct derivative_block *block;
	struct varied_model *varied; /* per column, of a model that goes by regions, which has no blocks; else NULL */
	struct step *regions;       /* of these, where the step of the model itself is none of regions; else NULL */
};
/* step->derivatives, where the spec or the request asks for some; false: it was said why there are none */
bool find_derivatives(struct step *step);
int  load_alike(const struct linear *system, const struct load *load); /* of the same time function; NONE: none */
bool derivatives_read_load(const struct step *step, int load);

/* ---- scheme.c: the step of a model ---- */

struct step *step_build(const struct model *model);         /* NULL: it was said why */

#endif
