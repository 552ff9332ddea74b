/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps in normal modes. */
#ifndef PLGEN_STEP_NORMAL_H
#define PLGEN_STEP_NORMAL_H

#include "step/step.h"

struct normal_mode;

/* ---- normal.c: normal modes of the operators of a schedule, and the remainder in them ---- */

enum { NORMAL_BITS = 192 };         /* of modes and weights, before they are rounded */
struct mode_block {                 /* modes that no entry of M and K couples with others */
	int modes, *coord;          /* as many coordinates as modes */
	int place, rows;            /* in vectors of modes: where they stand; with what makes their number even */
};
struct normal_matrix {              /* a matrix of forces on the modes: times a sum of vectors of modes */
	double *value;              /* [schedule][mode i][mode j]; nothing below 2^-160 of the largest */
	int terms;
	/* factor[schedule] times function times eta, eta' */
	struct normal_term { int function; bool velocity; double *factor; } *term;
};
struct normal_stage {               /* modes at a time after the step's start, from it and from forces */
	int points;
	double *flow;               /* [schedule][e, s, de, ds][place] */
	double *weight;             /* [schedule][point][eta, eta'][place] */
	double *forcing;            /* [schedule][forcing term][of cos, of sin at the step's start][eta, eta'][place] */
};
struct stability {                  /* of a multistep method, functions of time frozen */
	double span;                /* [s] over which they are looked at */
	double radius;              /* the largest spectral radius of a step; */
	int schedule;               /* where that is: the operator, */
	double time;                /* the time [s] */
	double growth;              /* ln of what all steps of the span together let grow at most; */
	double growth_factor;       /* that itself */
};
struct within {                     /* a step: states inside it, by Taylor series over its parts */
	double angle; /* by which a mode or a forcing term turns or decays in a step at most: in as many parts */
	int terms;
	double *stiffness, *damping; /* [schedule][place] lambda, 2 delta; no damping: NULL */
	/* Of the force's polynomial, the factors of what forces exceed that at the step's start by,
	 * [power - 1][node - 1]: through past forces and the new one (NULL: of a method of one step); through those
	 * at all nodes */
	double *past, *nodes;
};
struct normal_multistep {
	int points;                 /* 0: each step is by collocation */
	bool twice;                 /* predict, evaluate, correct, evaluate; else the last is left out */
	struct normal_stage step;   /* the predictor: points past forces, the last first */
	double *correct;            /* [schedule][eta, eta'][place]: of the force's excess over its extrapolation */
	double *extrapolate;        /* [point] */
};
struct normal_collocation {
	int stages;
	/* its sweeps, from forces extrapolated from the step before; where there is none, all equal at first */
	int sweeps, first_sweeps;
	double *ahead;              /* [stage][node]: forces extrapolated to this step's nodes from those of the last */
	struct normal_stage *stage;
	mpq_t *node;                /* stages + 1, from 0 to 1 */
};
struct normal_steady {              /* once all functions of time are constant */
	/* over [omega eta, eta', 1, forcing terms], by columns: [size][2 width]; NULL: they never are */
	double *flow, *omega, *period; /* omega and 1/omega: [place] */
	int schedule;               /* the operator whose modes they are */
};
struct normal {
	int modes, width;           /* n; length of a vector of modes */
	int operators, blocks;
	struct mode_block *block;
	int *place;                 /* per mode: in a vector */
	double *to, *from;          /* [schedule][mode][coordinate] V^T M; [schedule][coordinate][mode] V */
	double *turn; /* [schedule but the last][place][place] V^T M V - I, from its modes to the next's */
	double *frequency, *ratio;  /* [schedule][mode]: sqrt(lambda), 0 below 0; delta over it */
	int matrices;
	struct normal_matrix *matrix;
	double **force;             /* per function: [schedule][place]; NULL: none */
	double *forcing;            /* forces of forcing terms: [schedule][forcing term][cos, sin][place] */
	struct normal_multistep multistep;
	struct normal_collocation collocation;
	int kept;                   /* forces that are kept between steps: points, or stages + 1 */
	struct normal_steady steady;
	struct stability stability; /* of a multistep method */
	struct within within;
};
struct place scheme_place(const struct step *step);   /* where it is asked for, else the model's name */
struct normal *normal_of(struct step *step);                /* leaves the statement where there is none */
struct normal_work {                /* what its builders share */
	struct step *step;
	const struct model *model;
	struct normal *normal;
	mpq_t *M;                   /* rows are those of the equations of the coordinates */
	struct eigenpairs *pairs;   /* per schedule */
	struct normal_mode *mode;          /* per schedule and mode */
};

#endif
