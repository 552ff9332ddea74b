/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A model at a point, where it is linearised. */
#ifndef PLGEN_MODEL_LINEARISE_H
#define PLGEN_MODEL_LINEARISE_H

#include "building.h"

struct linearising {
	struct building *b;
	int n, states, inputs;
	const struct symbol **input;
	int fixings;
	struct fixing *fixing;      /* states, highest derivatives, inputs and their slopes, t */
	mpq_t *state;               /* the point */
	const struct form **residual; /* per row: F */
	mpq_t *F;
	struct form ***slope;       /* of the residuals by each coordinate, where an equilibrium is sought */
	bool rest;                  /* an equilibrium was asked for */
	bool timed;                 /* loads are as at t; else F is without them */
	bool looks, varies;         /* slopes are looked at for what depends on time; some does */
	double scale;               /* largest residual at the starts of a search */
	double fall;                /* how far it moves where nothing holds it, doubled each time */
};

/* ---- equilibrium.c: the point, the equations and their derivatives there ---- */

void list_fixings(struct linearising *l);
/* d form / d what `fixing` fixes, of `count` forms at the point */
void slopes_at(struct linearising *l, int count, const struct form *const *form, int fixing, mpq_t *slope);
struct point *point_of(struct linearising *l);
void value_at(struct linearising *l, struct point *point, const struct form *form, mpq_ptr value);
void find_residuals(struct linearising *l);                 /* F, where the highest derivatives are 0 */
bool is_equilibrium(const struct linearising *l);           /* F is 0 */
/* From the point on, without velocities; leaves the statement where none is found */
void find_equilibrium(struct linearising *l);
void find_equilibria(struct linearising *l);                /* from many points, into the model's equations */
void find_free_directions(struct linearising *l);           /* along which no equation changes; of the equations */
/* Highest derivatives at the point, of which outputs may be functions: W^-1 (-F) */
void find_highest(struct linearising *l);
/* Slopes a hair beside the point, on both sides of it in each state, have to be those of the point. */
void check_kinks(struct linearising *l);

#endif
