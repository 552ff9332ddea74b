/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear systems of coordinates, their independent blocks, and the augmented state. */
#ifndef PLGEN_MODEL_LINEAR_H
#define PLGEN_MODEL_LINEAR_H

#include "collect/collect.h"
#include "math/math.h"
#include "tape/tape.h"

struct model;
struct output;
struct residual;
struct segment_equations;

/* ---- linear.c: linear systems of coordinates ---- */

struct load {                       /* force on the equations: t^k times one forcing term */
	const struct forcing *forcing;
	int powers;                 /* k = 0 .. powers-1 */
	int columns;                /* t^k, or t^k cos and t^k sin: the load states z */
	mpq_t **force;              /* per column: [segment][equation] */
};
struct input {                      /* a sampled input u */
	const char *name;
	int hold;                   /* degree of the polynomial through samples around; 0: held, 1: a ramp */
	const struct unit *unit;    /* in which it is given; NULL: not known */
	mpq_t *force[2];            /* of u and of u': one rational per equation */
};
struct linear {                     /* M q'' + C q' + K q = force - heldC q'(t_n) - heldK q(t_n) */
	int n, states;              /* states: the coordinates, then the velocities of those of second order */
	int *velocity;              /* per coordinate: the state that is its velocity; -1: of first order */
	int *coord;                 /* per state: its coordinate */
	mpq_t *M, *C, *K;           /* n x n, row-major; a coordinate of first order has no column in M */
	mpq_t *heldC, *heldK;       /* n x n, or NULL where nothing is held */
	int segments;               /* of time, in which the loads have one formula each */
	mpq_t *change;              /* segments - 1 times, rising */
	int loads;
	struct load *load;
	int inputs;
	struct input *input;
	int force_columns;          /* of the remainder: one for each equation that has some */
	mpq_t **force_column;       /* its force on the equations */
};
struct equilibrium {
	mpq_t *state;               /* its coordinates */
	const char *place;          /* as --at takes it */
	int directions;             /* along which nothing holds it: rows over the coordinates, largest entry 1 */
	double *free;
};
enum { DECAY_OF_MISSES = 4 };       /* of eliminated constraints, in a step: a h of (1 + a t) e^{-a t} */
struct equations {                  /* as they are written */
	struct residual *residual;  /* per row of the system, in the first segment of time */
	struct segment_equations *segment_equations; /* per segment */
	/* for all time, conditions and products of time kept; NULL: there is no remainder */
	struct segment_equations *full;
	struct irrationals irrationals;
	int *owner;                 /* per coordinate: the row of its equation */
	bool *reversed;             /* per written row: its sign is changed */
	const struct atoms *atoms;
	const struct node *moving_mass; /* a term by which the mass matrix is not constant; NULL: it is */
	bool indefinite;            /* nothing shows that this one stays regular */
	const struct node *implicit; /* a term that is not linear in highest derivatives or multipliers, or NULL */
	/* Where linear equations of nonlinear ones were asked for, their spec and the point that they are at */
	const char *linearised, *point;
	int directions;             /* of coordinates, along which no equation changes: rows, largest entry 1 */
	double *free;               /* NULL: not known */
	int starts, equilibria;     /* where they were searched for: from so many points, so many were found */
	struct equilibrium *equilibrium;
	/* per state: what has to be taken from it for the constraints to hold, to first order; NULL: there are none */
	const struct form **correction;
	int misses;                 /* poles at -DECAY_OF_MISSES/h, of what misses eliminated constraints */
	/* T and V beside constraints, where their sum stays; NULL: it may change */
	const struct form *conserved[2];
	mpq_ptr motion_end;         /* else when the motion from the initial values is there; NULL: it is known */
	/* per coordinate: its highest derivative as a row, where an output that is not linear reads it */
	struct output **highest;
};
bool loads_change(const struct linear *system);               /* their formula, at some time */
struct linear linear_like(const struct linear *shape);      /* the same coordinates and states, matrices 0, no loads */
struct linear first_order_system(int n, const mpq_t *A);    /* x' = A x */
/* W^-1, n x n; W has the columns of M, and those of C where a coordinate is of first order. False: singular. */
bool leading_inverse(const struct linear *system, mpq_t *inverse, int *column);
mpq_t *inverse_of_leading(const struct linear *system);     /* where it is known to be regular */
int highest_state(const struct linear *system, int coord);  /* whose derivative is the highest of the coordinate */
mpq_t *slopes_by_force(const struct linear *system, const mpq_t *inverse, const mpq_t *force); /* W^-1 force in y' */
/* The loads, inputs and force columns of another system, each force as `map` makes `rows` numbers of it */
typedef void force_map(const void *context, const mpq_t *force, mpq_t *mapped);
void take_forces(struct linear *system, const struct linear *other, int rows, force_map *map, const void *context);
/* Highest derivatives of the coordinates, -W^-1 (C v + K q), n x states; `held`: of the held terms alone */
void highest_derivatives(const struct linear *system, const mpq_t *inverse, bool held, mpq_t *row);
mpq_t *state_matrix(const struct linear *system, bool held); /* A of y' = A y, states x states */
/* [a - A, w; -w, a - A]^-1, of 2m x 2m; w NULL: (a - A)^-1, m x m. NULL: a + i w is a pole */
mpq_t *shifted_inverse(int m, const mpq_t *A, mpq_srcptr a, mpq_srcptr w);
/* What of x' = A x + B z goes with the states z of a load, x = P z; P, columns x m, is B before */
void solve_forced(int m, const mpq_t *shifted, const struct load *load, mpq_t *P);
int load_columns(const struct linear *system);
bool further_samples(const struct linear *system);          /* an input goes through more than two */
int column_of_load(const struct linear *system, int load);  /* its first */
int input_columns(const struct linear *system);
bool is_constant_column(const struct linear *system, int column); /* of the loads: it is 1 */
bool load_acts(const struct linear *system, const struct load *load);
bool any_load_acts(const struct linear *system);
bool is_driven(const struct linear *system);                 /* by a load or an input */

/* ---- blocks.c: coordinates that do not influence each other ---- */

struct block {
	struct linear system;
	int *equation, *coord;      /* of the whole system, per equation and coordinate of the block */
	int *state;                 /* likewise per state */
};
/* M regular, so that a block has as many equations as coordinates */
int blocks_of(const struct linear *system, struct block **blocks);
/* Components of a graph whose nodes are n equations and then n coordinates, by their parents */
struct block block_at(const struct linear *system, int *parent, int coord);  /* the component of that coordinate */
bool is_seen_before(int n, int *parent, int coord);          /* an earlier coordinate is of the same one */

/* ---- augmented.c: the augmented state ---- */

/* x = [states, held terms, load states, inputs, force columns]; every column of a table or of tuned equations has its
 * place here too */
struct layout {
	int size, states;
	int held;                   /* index of the first held term, one per coordinate; -1: none */
	int first_load, loads;      /* index of the load states; how many, in one segment of time */
	int segments;               /* of time that have load states of their own: 1, or all */
	int *load;                  /* per load: index of its first state, in the first of them; -1: it has none */
	int *input;                 /* index of each input (then of its slope, if of first order) */
	/* index of the first remainder; each is a chain of so many integrators, its force the first */
	int force_column, powers;
};
enum { PARABOLA = 3 };              /* powers of a remainder: its value and two derivatives */
struct layout layout_of(const struct linear *system, int powers);   /* of loads those that act */
/* the same, in all segments of time where that is at most twice as large */
struct layout layout_of_segments(const struct linear *system, int powers);
struct layout layout_with(const struct linear *system, int powers, const bool *needed); /* of loads those needed */
/* states, all load states of all segments, inputs */
struct layout layout_of_columns(const struct linear *system);
const char **layout_names(const struct layout *layout, const struct linear *system, const struct model *model);
/* A of x' = A x; `segment` where the layout is of one */
mpq_t *augmented_matrix(const struct layout *layout, const struct linear *system, int segment);

#endif
