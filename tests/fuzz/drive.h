/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One model that drive.c holds against other roads; grammar.sh writes a table of them. */
#ifndef DRIVE_H
#define DRIVE_H

#include "plrt.h"

struct subject {
	const char *name;
	const pl_model *model;      /* or */
	const pl_modelf *modelf;    /* of one in float */
	/* the same spec in double, no state left out; of inputs more, the first one delayed */
	const pl_model *whole;
	/* NAME_rhs of `whole`; NULL: its steps are what those of the model are held against */
	void (*slopes)(double t, const double *y, const double *u, double *dydt);
	const char *scheme, *class; /* class: linear, piecewise, sticking (dry friction, of which `whole` has a steep
				     * damper up to the force), smooth, kinked; "": unknown */
	const char *changes;        /* times at which a load changes its formula */
	const char *solution;       /* file of --solution, or NULL */
	double (*selftest)(void);   /* or NULL */
	const int *coords;          /* of the spec's second writing: NULL where there is none */
	void (*residual)(double t, const double *y, const double *u, const double *top, double *r);
	void (*wanted)(double t, const double *y, const double *u, const double *top, double *out);
	const pl_model *tuned;      /* the spec with other params and step; NULL: nothing is tunable */
	const char *retune;         /* these values: NAME=VALUE ... */
	double (*lanes)(void);      /* of NAME_batch, lanes.h; or NULL */
	const char *impact;         /* GAP RESTITUTION: b' = -RESTITUTION b' where b comes up to GAP; "": none */
	int adds;                   /* how often a step adds to a state: 3 of the form kick-drift-kick, else 1 */
	int (*region)(const void *s);   /* NAME_region, or NULL */
	double regions;             /* how many there may be */
	int (*whole_region)(const void *s);     /* that of `whole`, where it has the same expressions; or NULL */
	double ratio;               /* what is kept of coordinates that move as a whole may be so much larger */
	double tolerance;           /* to which lengths of steps are chosen; 0: they are not */
	const pl_model *fine;       /* by eighths of what it steps at once: of a fixed order held against steps to a */
	const pl_modelf *finef;     /* tolerance, or beyond a bound, or of few stages that may want too many internal
				     * steps; or NULL */
	const char *lost;           /* by output, with modes that are dropped: " NAME VALUE, ..." */
	int written;                /* positions that may move as a whole stay as written: differences round as they */
	int may;                    /* what NAME_status may tell: of a fixed order, that it misses the tolerance */
	int order;                  /* in h: what is beyond a bound has to be of it, by `fine`; 0: nothing may be */
	double (*sustained)(void);  /* the largest part of a state that is not kept in it, lanes.h; or NULL */
};

extern const struct subject subjects[];     /* up to one without a name */

#endif
