/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Radau IIA, and the highest derivatives that it solves for. */
#ifndef PLGEN_STEP_COLLOCATION_H
#define PLGEN_STEP_COLLOCATION_H

#include "step/step.h"

/* ---- collocation.c: Radau IIA ---- */

struct stage_mode {                 /* of A: A v = z v, u A = z u, u v = 1 */
	bool pair;                  /* it stands for itself and its conjugate; else it is real */
	double re, im;              /* z */
	double *left, *right;       /* [stage][re, im]: u; v, of a pair twice that */
};
struct collocation {
	int stages;
	double *node;               /* c, rising, parts of the step; the last is 1 */
	double *once, *twice;       /* A and A^2, [stage][stage] */
	double *monomial;           /* [power][stage]: polynomials that are 1 at one node, 0 at the others */
	int modes;                  /* of A */
	struct stage_mode *mode;    /* the real one first */
	struct motion *motion;
	struct { int multiplications, additions, calls; } iteration; /* of Newton's method: what one costs */
};
mpq_t *lobatto_nodes(int stages);                           /* stages + 1 of them, 0 and 1 among them; to 256 bits */
struct collocation *collocation_of(const struct step *step);

/* ---- motion.c: the highest derivatives of the coordinates ---- */

struct motion_entry {               /* of the Jacobian, where it is not 0 */
	int coord, of;              /* row; the coordinate by which, or by whose velocity, it is derived */
	bool twice;                 /* by the coordinate, and that is of second order */
	const struct form *slope;
};
struct motion {
	int coords, solved;         /* the first of them, of which the Jacobian is wanted */
	/* so many that stages are solved by their modes, and the Jacobian is that of the step's start */
	bool apart;
	/* per coordinate: without what depends on time alone in the linear part, which there is where it is driven;
	 * beside contacts there are no forms, of slopes neither: set_motion says them */
	const struct form **force;
	bool listed;                /* many equations give them: solved by lists */
	/* ... beside contacts, or by Newton's method: the Jacobian is full, of differences */
	bool differences;
	bool *driven;
	int columns;                /* of the loads */
	double *load, *input;       /* [segment][coordinate][column]; [coordinate][input][value, slope] */
	int entries;
	struct motion_entry *entry;
};
struct motion *motion_of(const struct step *step);
/* left[] of the coordinates, slope[] of the entries: beside contacts, from what the series of their events has */
struct recurrences *motion_recurrences(const struct step *step);
void set_motion(const struct step *step, struct recurrences *r, bool slopes);

#endif
