/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the builders of a model share, and what they do. */
#ifndef PLGEN_MODEL_BUILDING_H
#define PLGEN_MODEL_BUILDING_H

#include "collect/collect.h"
#include "model.h"

struct switching_function;
struct impact_law;

/* ---- the builders of a model share ---- */

struct residual {                   /* left side minus right side of one scalar equation */
	struct form *form;
	struct place at, end;
};
struct building {                   /* what the builders share */
	struct spec *spec;
	struct model *model;
	struct collector collector;
	const struct request *request;
	const struct forcing *polynomial; /* the forcing term of t^k alone */
	struct segment_equations *segment_equations; /* per interval between changes of formula in time */
	struct segment_equations *full; /* the same for all time, with atoms; NULL: there is no remainder */
	/* with the spec's values, where `segment_equations` has tunable params; else NULL */
	struct segment_equations *nominal;
	int nominals;               /* its intervals */
	bool crowded;               /* its regions, if it has some, are too many */
	bool eliminates;            /* constraints, as linear as all equations are: these are solved in rationals */
	const bool *factor;         /* per tunable param: a number of regions, and no input; NULL: none is */
	struct point *values;       /* nothing fixed but tunable params; made on first use */
	/* [segment][row]: the residual's part that depends on time alone, as the linear core carries it */
	struct form **load;
	struct form **time_left;    /* per row: what depends on time alone and it cannot carry */
	int *owner;                 /* per coordinate: its residual */
	bool *reversed;             /* per residual: its sign is changed before elements add to it */
};
struct constraint {
	const struct energy *statement;
	/* by[0]: what is 0, by[1], by[2]: its derivatives in time; of one on velocities by[0] is NULL, by[1] is 0 */
	const struct form *by[3];
};
struct moving_mass {
	const struct node *node;
	struct linear_system system;
	struct linear_system plain; /* without what is not linear in highest derivatives */
	mpq_t *start;               /* its M there */
};
struct segment_equations {          /* the equations and outputs in one interval of time */
	int residuals, written;     /* all; those of written equations come first */
	struct residual *residual;
	struct form **element;      /* per element of the network: its force */
	struct value **output;      /* per output statement; NULL: not linear */
	struct impact_law **impact_law; /* per `when` and stop; NULL: its error was reported */
	int masses;                 /* blocks of equations in which the mass matrix moves */
	struct moving_mass *mass;
	struct constraint *constraint; /* one per multiplier */
	const struct form *energy[2]; /* T and V of all statements; NULL: there is none */
	bool negative_kinetic;      /* nothing shows that no T of energies is below 0 */
	struct form **multiplier;   /* solved for */
	/* beside eliminated constraints, per derivative: coordinates as outputs read them; NULL: as they are */
	struct form **form[3];
};

/* ---- equations.c: equations and sketches to residuals ---- */

void collect_equations(struct building *b, struct segment_equations *segment_equations);
static inline const struct segment_equations *equations_of(const struct building *b)   /* with atoms, where any are */
{
	return b->full ? b->full : b->segment_equations;
}
void give_states_in_units(struct building *b);
void collect_outputs(struct building *b, struct segment_equations *segment_equations);
int  find_order(const struct spec *spec, int coord);
void build_outputs(struct building *b);
/* of states, loads and inputs; no highest derivatives */
struct output *row_of_function(struct building *b, const struct switching *of, const struct switching_function *e);
struct output *row_of_form(struct building *b, struct form *form);
/* the same with the highest derivatives that a system gives */
struct output *row_in_system(struct building *b, const struct linear *system, struct form *form);
struct output *row_of_highest(struct building *b, const struct linear *system, int coordinate);
void collect_full(struct building *b);                      /* the equations for all time, atoms kept: b->whole */
bool assign_equations(struct building *b);                  /* false: it was said which is missing or too many */
void add_elements(struct building *b, struct segment_equations *s); /* the network's forces to the residuals */
void check_mass(const struct building *b);

/* ---- delays.c: inputs as they were some time ago ---- */

void find_delays(struct building *b);                       /* model->delays; after the step is known */

/* ---- tunable/params.c ---- */

void part_factors(struct building *b);             /* params that regions have as numbers, not inputs */

/* ---- system.c: residuals to M, C, K, loads and inputs ---- */

void fill_states(struct building *b, const struct segment_equations *rows); /* M, C, K, inputs */
/* Tunable params that the instance has, at the spec's values: what is linear there belongs to the linear core, and the
 * difference is in the remainder. Itself, where it reads none. */
const struct form *nominal_form(struct building *b, const struct form *form);
/* Whether what params multiply is parted so for inputs and loads too: a series puts both together again */
bool parts_params(const struct building *b);
void fill_loads(struct building *b, int segment, int row, const struct form *residual);
void place_loads(struct building *b, const struct form *form); /* every load of the form gets load states */
void place_loads_within(struct building *b, const struct form *form); /* of what is in its atoms too */
void spread_loads(struct building *b, const struct form *form,
		  void (*spread)(void *context, int load, int column, mpq_srcptr factor), void *context);
/* one row of everything */
void fill_system(struct building *b, struct linear *system, int row, const struct form *residual);
/* the model's coordinates, loads and inputs; no factors yet */
struct linear empty_system(const struct model *model);

/* ---- scheme_choice.c: which scheme the equations allow ---- */

bool is_linear(const struct building *b);                   /* with constant coefficients, loads in time excepted */
/* of equations that were collected, whichever coordinates they belong to: a scheme is for them that leaves something */
bool leaves_over(const struct building *b);
void go_by_regions_where_tuned(struct building *b);
bool needs_regions(const struct building *b);                    /* scheme exact has regions for them */
void build_system(struct building *b);                      /* M, C, K, loads, inputs */
/* whose coordinates or inputs do not have the factors of the first segment; NULL: none */
const struct node *changing_factor(struct building *b, int segment);

/* ---- nonlinear.c: what is not in M, C and K ---- */

void find_nonlinear(void *building);                        /* each with its place and its text */

#endif
