/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Outputs, a scheme's operators, and their nonlinear remainder. */
#ifndef PLGEN_MODEL_REMAINDER_H
#define PLGEN_MODEL_REMAINDER_H

#include "collect/collect.h"
#include "math/math.h"
#include "tape/tape.h"

struct building;
struct model;

struct output_slope {               /* of an output along something: a state or its highest derivative, an input */
	struct basis along;         /* of kind BASIS_ONE: what it has by a column itself, that of `index` */
	const struct form *form;
};
struct output {
	const char *name;
	const struct unit *unit;    /* in which it is given; NULL: not known */
	struct node *value;         /* as written */
	/* the largest size so far is asked for; reads what friction without mass bears */
	bool peak, reads_slider_force;
	int statement, cell;        /* which output statement, and which cell of its value */
	struct form *form;          /* in the first segment of time; NULL where it is not linear in states and loads */
	struct form *left;          /* then: for all time, with atoms; highest derivatives stand for themselves */
	mpq_t *state;               /* factors of y, one per state, accelerations replaced */
	mpq_t **load;               /* per load: factors of its columns, [column][segment] */
	mpq_t *input[2];            /* per input: factors of u and u' */
	mpq_t *force_column;        /* factors of the remainder, where an acceleration is read */
	int slopes;                 /* where derivatives are asked for beside regions: those of what is no row in all */
	struct output_slope *slope;
};
struct operator {                   /* A of y' = A y + loads + inputs + r(t, y); its M is that of the equations */
	mpq_t *C, *K;
	struct form **left;         /* per force column: the remainder, a force on its equation */
	mpq_t at;                   /* of a schedule: the value up to which it serves */
	const char *text;           /* x = 2, x' = 0 */
};
struct operator_schedule {          /* of operators */
	int operators;              /* 0: exact, or there is no remainder */
	struct operator *operator;
	const struct form *selector; /* of a schedule: what is compared with `at`; NULL: one operator */
};
struct time_function {              /* what stands with it in the remainder of the first operator */
	const struct form *form;    /* of time alone */
	/* n x n: force on the equation of coordinate i of coordinate j, of its velocity; NULL: none */
	mpq_t *position, *velocity;
	mpq_t *force;               /* on the equation of each coordinate; NULL: none */
	mpq_t last;                 /* its value in the last segment of time, where it is constant there */
};
struct rest_force {                 /* on the equation of a coordinate: a function of time times one of the states */
	int coord, function;
	struct form *form;
};
struct forcing_force { /* of a forcing term alone, of its cos and its sin: on the equation of each coordinate */
	struct forcing *forcing;
	mpq_t *force[2];
};
struct splitting {                  /* the remainder, sorted: see split.c */
	int functions;
	struct time_function *function; /* the first is 1 */
	int rests;                  /* forces that are neither */
	struct rest_force *rest;
	int forcings;               /* known loads to which modes respond exactly; none: the remainder has loads */
	struct forcing_force *forcing;
	const struct node *mixed;   /* time and states in one function: none of this; NULL: there is none such */
	bool ends_steady;           /* there is a last segment of time, in which all functions are constant */
	const struct atom *unknown; /* changes its formula in time, it is not known when; NULL: none does */
	int selector; /* function that a schedule is chosen by; -1: there is no schedule, or it is by states */
};
struct smoothness {                 /* of the remainder, else of the equations; where nothing is found all is 0 */
	int tenths;                 /* of the order that no scheme exceeds here: 10 at a jump, 20 at a kink */
	enum { SMOOTH_ALL, SMOOTH_KINK, SMOOTH_JUMP } kind;
	const struct node *node;    /* what jumps or has the kink */
	const char *where;          /* x passes 0.5 */
	bool piecewise;             /* exact could treat it alone */
	bool timed;                 /* it lies at a time */
	/* a formula that ends there, as abs(x)^1.5, whose derivatives are not finite, and where; NULL: none does */
	const struct node *singular;
	const char *singular_where;
};
/* Stages of so many coordinates are solved together: beyond, that costs more than exact slopes save. */
enum { MOST_TOGETHER = 4 };
struct remainder {                  /* the remainder, of each operator */
	int force_columns;          /* one for each equation that has some */
	int *row;                   /* its equation */
	/* of a scheme that collocates: [force column][state], its derivative; NULL: of more than MOST_TOGETHER
	 * coordinates that Newton's method solves for */
	struct form **slope;
	bool loads;                 /* known loads are left to the scheme */
	struct splitting *split;    /* of a scheme in normal modes; else NULL */
	struct smoothness smooth;
};

/* ---- operator.c: the linear operator of a scheme, and its nonlinear remainder ---- */

void build_operators(struct building *b);
/* the model's, with the operator's C and K and the force columns */
struct linear operator_system(const struct model *model, int k);
/* What A, loads and inputs have of the equation of this force column, on its left side */
struct form *carried_form(const struct model *model, int force_column);
/* Every form that the remainders and the selector are made of, once, operands before what they make. */
void visit_remainders(const struct model *model, void (*visit)(void *context, const struct form *form), void *context);

/* ---- split.c: the remainder as matrices times functions of time, and the rest ---- */

void split_remainder(struct building *b);                    /* model->split; after the operators */

/* ---- smooth.c: how smooth the equations are, and what order that leaves to a scheme ---- */

/* model->smooth; says where dry friction stands in the remainder */
void judge_smoothness(struct building *b);
const char *jump_with_state(struct building *b, const struct form *form);      /* "x passes 0.5"; NULL: none is sure */
/* or a coordinate of first order, which is one */
bool reads_velocity(const struct model *model, const struct form *form);
_Noreturn void report_friction(const struct node *node, const char *where);
int  order_of_scheme(const struct model *model);            /* where all is smooth; 0: of exact */
bool loses_order(const struct model *model);                /* to what is not smooth */
int  order_that_holds(const struct model *model);           /* rounded down; 0: there is no remainder */
/* A scheme of the etd family goes from crossing to crossing here: what the state chooses is compared with
 * breakpoints. */
bool follows_crossings(const struct model *model);
const char *order_text(const struct model *model);          /* that is left: 2, 2.5 */
const char *smoothness_text(const struct model *model);     /* max(x - 0.5, 0) has a kink where x passes 0.5 */

#endif
