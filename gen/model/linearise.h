/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model at a point, where it is linearised. */
#ifndef PLGEN_MODEL_LINEARISE_H
#define PLGEN_MODEL_LINEARISE_H

#include "building.h"

struct linearising {
	struct building *b;
	int n, states, inputs;
	int held, rows;             /* constraints; with equations: as many as coordinates and multipliers */
	const struct symbol **input;
	int fixings;
	/* states, highest derivatives, multipliers, inputs and their slopes, t */
	struct fixing *fixing;
	mpq_t *state;               /* the point */
	/* per row: F as written, behind them what constraints hold: positions, or velocities */
	const struct form **residual;
	mpq_t *F;
	struct form ***by;          /* [fixing][row]: derivatives of residuals; NULL: not needed yet */
	struct form ***slope;       /* [unknown][row]: of the residuals, where an equilibrium is sought */
	struct form ***mass;        /* [unknown][row]: by highest derivatives and multipliers, of what accelerates */
	struct tangent *tangent;    /* what constraints leave, at the point; NULL: there are none */
	bool rest;                  /* an equilibrium was asked for */
	bool stays;                 /* nothing accelerates at the point */
	bool timed;                 /* loads are as at t; else F is without them */
	struct point *always;       /* at which slopes are looked at for what depends on time; NULL: they are not yet */
	bool varies;                /* some does */
	double scale;               /* largest residual at the starts of a search */
	double fall;                /* how far it moves where nothing holds it, doubled each time */
};

/* ---- point.c: the point, the equations and their derivatives there ---- */

void list_fixings(struct linearising *l);
void check_unit(const struct linearising *l, const struct node *node, int state);  /* number `states`: of t */
void list_residuals(struct linearising *l);
const struct constraint *constraint_of(const struct linearising *l, int row);
/* d form / d what `fixing` fixes, of `count` forms at the point; form NULL: of the residuals */
void slopes_at(struct linearising *l, int count, const struct form *const *form, int fixing, mpq_t *slope);
void look_for_time(struct linearising *l);                  /* in slopes at the point, from now on */
struct point *point_of(struct linearising *l);
/* A coordinate, or a multiplier behind them */
mpq_ptr unknown_of(struct linearising *l, int k);
void value_at(struct linearising *l, struct point *point, const struct form *form, mpq_ptr value);
void find_residuals(struct linearising *l);                 /* F, where the highest derivatives are 0 */
bool is_equilibrium(const struct linearising *l);           /* F is 0 */
struct form **residuals_by(struct linearising *l, int fixing); /* derivatives of all, made once */
/* Highest derivatives and multipliers there, into their fixings; false: the equations do not determine them */
bool solve_highest(struct linearising *l, bool roughly);
/* The same for outputs, which may be functions of them; what is not determined is an error */
void find_highest(struct linearising *l);
/* Slopes a hair beside the point, on both sides of it in each state, have to be those of the point. */
void check_kinks(struct linearising *l);

/* ---- equilibrium.c ---- */

/* From the point on, without velocities; leaves the statement where none is found */
void find_equilibrium(struct linearising *l);
void find_equilibria(struct linearising *l);                /* from many points, into the model's equations */
void find_free_directions(struct linearising *l);           /* along which no equation changes; of the equations */

/* ---- tangent.c: the motions that constraints leave, near the point ---- */

struct tangent_row {                /* of an equation, an output, or what a dependent one follows from */
	mpq_t *slope;               /* per fixing; NULL: there is no such row */
	struct form *load;          /* functions of time alone */
};
enum { LEVELS_HELD = 3 };           /* positions, velocities, accelerations */
struct tangent {
	/* Per coordinate and level: it depends on others and time, = slopes + load, none of which depends itself;
	 * slope NULL: it is independent. Of a velocity constraint the position is a state of first order. */
	struct tangent_row *follows[LEVELS_HELD];
	struct tangent_row *row;    /* per equation; slope NULL: it determines a multiplier */
	struct tangent_row *multiplier; /* per constraint: likewise; NULL: not yet */
};
/* Slopes and loads of forms at the point; form NULL: of the equations */
struct tangent_row *rows_at(struct linearising *l, int count, const struct form *const *form);
struct tangent *tangent_of(struct linearising *l);          /* NULL: there are no constraints */
void put_dependent(const struct linearising *l, const struct tangent *t, struct tangent_row *row);

#endif
