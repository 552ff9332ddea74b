/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is certified of a model: states and crossings in closed form, for the self-test, and enclosed. */
#ifndef PLGEN_STEP_CERTIFY_H
#define PLGEN_STEP_CERTIFY_H

#include "step/step.h"

struct region_part;

/* ---- trajectory.c: a piecewise-linear model through its crossings, enclosed ---- */

struct passed {                     /* a breakpoint, by its switching function */
	int function, breakpoint;
	bool upward;
	bool jumped;                /* by a load that jumps, not by crossing */
	bool faint;                 /* it begins with speed and acceleration 0: what rested is let go */
	bool stands;                /* it rests as impacts have left it with speed 0 where it would bounce */
	mpfi_t at;                  /* when [s] */
	double speed;               /* of the switching function there [its unit/s] */
	double size;                /* of what it is summed from there [its unit] */
};
struct trajectory;
/* From t = 0 on in so many bits. NULL: of the whole model, which then has no parts; `initial` has its states. Inputs
 * follow u = 1 - t/h; held, u = 1; those that stand for params have the spec's values. */
struct trajectory *trajectory_start(const struct model *model, const struct region_part *part, const mpq_t *initial,
			      int precision);
bool trajectory_reach(struct trajectory *t, mpq_srcptr time); /* false: it is not decided what comes before */
const char *trajectory_undecided(const struct trajectory *t); /* why */
void trajectory_value(const struct trajectory *t, const struct output *output, mpfi_ptr value);
int  trajectory_passed(const struct trajectory *t, const struct passed **list); /* so far, in order */
void trajectory_free(struct trajectory *t);

/* ---- closed.c: states in closed form for the self-test ---- */

struct reference {                  /* from t = 0 on; inputs follow u = 1 - t/h; held, u = 1 */
	int states, rows;           /* rows: fewer where the states leave the range */
	const unsigned long *steps; /* per row: how many have been taken */
	double *start, *value;      /* [states]; [row][states] */
	double *between;            /* [states] at h/2, where NAME_at is there */
	double *unit;               /* [states]: one in the last place of the largest value */
	/* of a piecewise-linear model the crossings up to the last row: when, and how much of that is rounding */
	int crossings;
	struct { unsigned long step; double after, unit; } *crossing;  /* steps before it, and [s] */
};
struct reference reference_of(const struct step *step);

#endif
