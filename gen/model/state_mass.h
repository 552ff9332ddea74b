/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Highest derivatives that have factors of the state. */
#ifndef PLGEN_MODEL_STATE_MASS_H
#define PLGEN_MODEL_STATE_MASS_H

#include <stdbool.h>
#include <gmp.h>

struct atom;
struct building;
struct form;
struct linear_system;
struct segment_equations;

/* The first atom in which a highest derivative stands; NULL: there is none */
const struct atom *atom_of_highest(const struct form *form);
/* Whether the highest derivative of a coordinate stands in it, or inside of an atom */
bool has_highest(const struct building *b, const struct form *form, int coord);
/* Residuals q'' - (M^-1 f) in the place of those that M(q) couples; what is not linear in q'' is an error there */
void solve_for_highest(struct building *b, struct segment_equations *s);
/* The row of M, n x n in rows of `width`, by which T of energies is below 0, and the first T; -1: none */
struct energy;
int  negative_mass(const struct building *b, int n, int width, mpq_t *M, const struct energy **kinetic, bool *definite);
void report_negative_mass(const struct building *b, const struct energy *kinetic, int coord);
void check_mass_at_start(struct building *b);               /* that M is regular there */
bool is_symmetric_mass(const struct linear_system *e);
/* Whether the equation of its highest derivative has a factor of the state */
bool has_moving_mass(const struct segment_equations *s, int coord);
/* The first coordinate on whose equation a force acts and whose mass matrix is not symmetric; NULL: there is none.
 * force: per coordinate */
const char *unsymmetric_mass(const struct building *b, const struct form *const *force);
struct form *form_at_rest(struct building *b, const struct form *form); /* highest derivatives are 0 there */
/* Of highest derivatives that have constant factors, as the equations have them; n x n */
mpq_t *inverse_masses(const struct building *b, const struct segment_equations *s);
/* M^-1 force (per residual) per coordinate: what it adds to the highest derivatives */
const struct form **accelerations_by(struct building *b, const struct form *const *force);
/* Per coordinate, the force on its equation that makes them, by M(q); none on equations that M(q) does not couple */
const struct form **forces_of_accelerations(struct building *b, const mpq_t *acceleration);

/* ---- newton.c: equations that are not linear in highest derivatives or multipliers ---- */

struct basis;
struct node;
struct nonlinear_terms {            /* N of n equations, and its derivatives by all n unknowns */
	const struct form **N, **slope;
	int rows, *row, columns, *column; /* where there are some: newton_system finds them */
};
/* Jumps of highest derivatives and multipliers, or by them, are errors. */
void refuse_jumps_of_solved(const struct building *b, const struct form *form);
/* What residuals F, whose derivatives are J, hold that is not linear; NULL: nothing. It is taken out of them. */
struct nonlinear_terms *take_nonlinear_terms(struct building *b, const struct node *node, int n,
					     const struct basis *unknown, const struct form *const *J,
					     const struct form **F);
/* Solved for u of M u + N(u) = f, where M u = f is `linear` */
struct linear_system newton_system(struct building *b, const struct node *node, const struct linear_system *linear,
				   struct nonlinear_terms *terms);
/* Kinks that leave no solution at the start, or two, are errors. */
struct point;
struct written_system;
void check_kinks_at_start(struct building *b, struct point *start, const struct written_system *written);

/* ---- elimination.c ---- */

/* Coordinates that linear constraints give out of all residuals, and out of multipliers; they follow the others. */
void eliminate_dependent(struct building *b, struct segment_equations *s);

/* ---- constraints.c ---- */

/* What brings a state back onto them: model->equations.correction; initial values that meet them */
void keep_constraints(struct building *b);
void find_conserved(void *building);                      /* model->equations.conserved */

/* ---- meeting.c ---- */

void meet_constraints(struct building *b);                /* the initial values, and derivatives of them */
/* Moves a state onto them, first what is not named (per state; NULL: nothing is). At t; NULL: loads are left out.
 * Where none is found that meets them it leaves the statement. */
void meet_constraints_near(struct building *b, mpq_t *state, const bool *named, mpq_srcptr t);

#endif
