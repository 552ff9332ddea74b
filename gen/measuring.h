/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of needs share: one after the other tried, measured; its neighbours. */
#ifndef PLGEN_MEASURING_H
#define PLGEN_MEASURING_H

#include "command.h"
#include "run/run.h"

struct alternative;

/* Of a need: two references agree to a hundredth, so much is left for the step that is tried. */
#define WITHIN 0.99
enum { MOST_TRIED = 9, MOST_SAMPLES = 2000000, MOST_KEPT = 4000000 };

struct kept_course { double h; int drive; struct course *course; };

struct measuring {
	struct model *model;        /* as it was built at first: its requirements */
	const struct request *request;
	struct request now;         /* of the candidate being built */
	struct step *step;
	bool single;                /* the target's type; a reference is in double */
	double until;               /* [s] the last end of a need */
	double *largest;            /* per need: of the reference's output */
	bool stepped;               /* a reference goes from event to event: it is a scheme's, by its tolerance */
	int drives;                 /* courses of the inputs that are tried; one where there are none */
	struct sampled *drive;        /* NULL: there are none */
	struct solvers solvers;
	double longest;             /* [s] a step is not above this where it is open */
	struct choice *choice;
	double within;              /* up to this excess from the spec's start nothing finer is tried */
	double cheapest;            /* of what was within that; infinite: nothing was */
	int kept;                   /* references from the spec's start */
	struct kept_course *keeps;
	const char *why;            /* no reference; NULL: there is one */
	bool amplitudes_known;
	int amplitudes;             /* params that nothing but loads follows from */
	const struct symbol **amplitude;
};

struct ready {                      /* a step as asked for, and its C */
	struct step *step;          /* NULL: there is none */
	struct running *r;          /* likewise */
	struct request as;
	struct solvers solvers;     /* the reference for its samples */
};

/* ---- trial.c ---- */

struct step *built(struct measuring *m, const struct request *as, const char **why);   /* NULL: *why says why */
struct ready ready_of(struct measuring *m, const struct request *as, const char **why); /* without r: likewise */
struct request request_of(const struct measuring *m, const struct alternative *a);
bool open_reference(struct measuring *m);      /* false: m->why */
/* From this start, with inputs number `drive`, against a reference from there; the largest of error over need; below 0:
 * there is no reference from there. `spec`: it is the spec's, and what is found is kept in the alternative */
double tried_from(struct measuring *m, struct alternative *a, struct ready *ready, const double *start, int drive,
		  bool spec);
bool meets(const struct alternative *a);
bool is_enough(const struct measuring *m, const struct alternative *a);
void try_alternative(struct measuring *m, struct alternative *a);        /* and keeps it */
void sort_by_cost(struct choice *choice);      /* those that there are first */
/* Of those that are known and cost so much at most; NULL: there is none */
const struct alternative *most_exact(const struct choice *choice, double most);

/* ---- neighbours.c ---- */

void try_neighbours(struct measuring *m, struct alternative *a);

#endif
