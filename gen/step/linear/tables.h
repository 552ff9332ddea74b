/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of a step, each rounded once. */
#ifndef PLGEN_STEP_TABLES_H
#define PLGEN_STEP_TABLES_H

#include "model/model.h"

struct started;
struct step;
struct resolvent;

/* ---- numbers.c, coefficients.c: numbers of the step, each rounded once ---- */

struct coefficient {
	/* of the target's type; value + low is the number in two words (low only where asked for) */
	double value, low;
	bool zero;                  /* exactly: no trace in the code */
};
/* What multiplies a remainder, as a sum of parts: at tau = fraction h, B the force of its force column,
 *     impulse e^{A tau} B + integral over 0..tau of e^{A (tau - s)} B (power[0] + power[1] s/h + power[2] (s/h)^2) ds
 * so h phi_k(A h) B is power k-1 over (k-1)!. The sum is rounded once. */
enum { PART_POWERS = 3, PHI_WEIGHT_PARTS = 2, TABLE_PHI_WEIGHTS = 4 };
struct phi_weight_part {
	mpq_t fraction, impulse, power[PART_POWERS];
	int powers;
};
struct phi_weight {
	const char *name;           /* b1 */
	int parts;
	struct phi_weight_part part[PHI_WEIGHT_PARTS];
};
struct wanted {                     /* of one table */
	mpq_t fraction;             /* its time, as a part of h */
	bool Phi, two_words;
	bool increments;            /* Phi - I */
	const mpq_t *mass;          /* kicks and drifts; one per coordinate, in units of the first; NULL: not wanted */
	const char *name;           /* full, half */
	int phi_weights;
	struct phi_weight phi_weight[TABLE_PHI_WEIGHTS];
};
struct table {                      /* of one time: y(tau) = Phi y + sum of columns */
	const struct wanted *wanted;
	int states, columns, inputs, force_columns;
	struct coefficient *Phi;    /* states x states, or NULL */
	struct coefficient *increment; /* Phi - I, each entry rounded as it is; or NULL */
	/* coordinates x coordinates, symmetric: S = Phi_12 M^-1 and X = S^-1 (Phi_11 - I); or NULL */
	struct coefficient *drift, *kick;
	struct coefficient *load;   /* [segment of time][states x columns]: of the loads in order */
	struct coefficient *input;  /* states x inputs: u held; or its value before the step and after it */
	struct coefficient **phi_weight; /* per phi-function weight: states x force columns */
};
/* leaves the statement where |p| h is hopeless */
void check_pole_size(const struct model *model, const struct resolvent *resolvent);
/* Rounded, infinite beyond the range; `at` and `what` name it where it cannot be decided. */
/* their sum */
struct coefficient started_value(int count, const struct started *list, mpq_srcptr t, bool two_words, struct place at,
				 const char *what);
struct coefficient response_value(struct response *response, mpq_srcptr tau, bool two_words, struct place at,
				  const char *what);
/* Block by block; by residues, beyond LIMIT_RESIDUE_STATES states by Taylor series. `resolvent`: of the whole */
struct table **tables_of(const struct model *model, struct resolvent *resolvent, const struct linear *system, int count,
			 const struct wanted *wanted);

/* ---- exact.c: exact numbers of the equations that stand in the code as they are, each rounded once ---- */

/* An error at the step where it is beyond the range */
struct coefficient equation_number(const struct model *model, mpq_srcptr q);
double time_in_step(const struct model *model, mpq_srcptr fraction);      /* a part of h [s] */
struct slopes {                     /* y' = A y + B r: r is the remainder, or another force on the force columns */
	struct coefficient *A, *B;  /* states x states; states x force columns */
};
struct slopes state_slopes(const struct step *step, int operator);

/* an operator of a scheme, a region of a piecewise-linear model, or the linear model */
struct branch {
	struct linear system;       /* with what the scheme holds taken out of C and K */
	struct resolvent *resolvent; /* of `system` */
	struct table **table;       /* of regions: of the step, then of the rungs of its ladder */
	struct table *full;         /* of the whole step: the first */
	int halvings;               /* of a region: log2 of the pieces of a step in which crossings are looked for */
	int rungs, spacing;         /* lengths of pieces below h: from those on, so many halvings apart */
};

/* ---- branches.c: the linear systems that a step is made of ---- */

void take_operators(struct step *step);
/* of scheme pl: what holding terms over a step does */
struct linear modified_equation(const struct linear *written, const struct linear *split, mpq_srcptr h);

#endif
