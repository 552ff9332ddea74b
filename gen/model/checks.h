/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is looked at before a model is done: bounds, orders, the Jacobian, warnings, needs. */
#ifndef PLGEN_MODEL_CHECKS_H
#define PLGEN_MODEL_CHECKS_H

#include "model.h"

struct segment_equations;

/* ---- bounds.c: what a spec says of single states ---- */

void evaluate_absolutes(struct building *b);                /* into truncation.absolute */
void evaluate_param_ranges(struct building *b);
void evaluate_ranges(struct building *b);                   /* behind the initial values, which have to be in them */

/* ---- truncation.c: where a series ends ---- */

enum { MOST_OVER = 32 };            /* steps of one expansion of fixed order: as many as one by tolerance serves */
/* h times those of one expansion: the unit of time of its coefficients */
void unit_of_expansion(const struct model *model, mpq_ptr unit);

enum { LEAST_ORDER = 4, MOST_ORDER = 30 };
enum { LEAST_STAGES = 3, MOST_STAGES = 9 };
void evaluate_events(void *context);                        /* of a building: the most in a step */
void evaluate_truncation(void *context);                    /* of a building: order of a series, its most substeps */
void evaluate_modes(void *context);                         /* likewise: the modes that are kept */
int  whole_number(struct building *b, struct node *node, int low, int high, const char *what); /* else it is refused */
/* from its tolerance, which is the default where it is 0; of what is no series, none */
void choose_order(struct model *model, bool single);
/* An argument of the command line, then *at is where it stands; else what the spec has */
struct node *requested_or_written(struct building *b, const char *requested, struct node *written, struct place *at);

/* ---- jacobian.c: of the equations for all time, where states and time are fixed ---- */

struct jacobian {
	struct building *b;
	/* [coordinate][row]: of the equations for all time, by velocity and by coordinate */
	struct form ***C, ***K;
	struct linear at;           /* evaluated */
	bool damped;                /* C too */
	const mpq_t *state;         /* where the states are fixed */
	mpq_t t;
};
void jacobian_forms(void *jacobian);                        /* C, K and what `at` has of the system */
/* K, and C where it is wanted, at j->t and j->state; leaves the statement where they are not defined */
void jacobian_evaluate(void *jacobian);
int  jacobian_point(const struct jacobian *j, struct fixing *fixing); /* states + 1, which it fixes */
struct point *point_at_state(struct building *b, const mpq_t *state, mpq_srcptr t); /* as values; t NULL: at 0 */
/* The left side minus the right side of an equation, not solved for its highest derivatives */
const struct form *residual_as_written(const struct segment_equations *s, const int *owner, int row);
void jacobian_of_motion(void *jacobian);                    /* a struct jacobian, of M^-1 f as numbers alone */
/* [1/s^2] of the coordinates' stiffness alone, eigenvalues of W^-1 K, rising; false: not found */
bool squared_frequencies(const struct linear *system, double *value);
double fastest_pole(const struct linear *system);           /* its size [1/s]; 0: not found */
double fastest_decay(const struct linear *system);          /* the largest -Re of a pole [1/s], at least 0 */

/* ---- linearise.c: the linear equations at a point, as a spec ---- */

void find_symmetries(void *building);                       /* fills in model->equations.free */
void linearise(void *building);                             /* fills in model->equations.linearised */

/* ---- lint.c: what is no mistake of language, and yet seldom meant ---- */

void lint(struct building *b);

/* ---- warnings.c: what a spec may say but is better warned of ---- */

void warn(struct building *b);

/* ---- needs.c: how exact outputs have to be ---- */

struct target {                     /* a processor: what it takes of instructions */
	const char *name;
	struct { double multiplication, addition, forcing, step; } cost[2]; /* in double, in float */
};
/* of the model that is stepped: its requirements, its target; false: it was said what stands in the way */
bool find_requirements(struct model *model);

/* ---- amplitudes.c ---- */

bool differ_in_loads(const struct model *a, const struct model *b); /* in nothing but how large their loads are */

#endif
