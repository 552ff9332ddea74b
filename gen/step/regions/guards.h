/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Events of regions with impacts and dry friction. */
#ifndef PLGEN_STEP_GUARDS_H
#define PLGEN_STEP_GUARDS_H

#include "model/tunable/tuning.h"
#include "step/step.h"

struct pieces;

/* ---- guards.c: events of regions with dry friction ---- */

struct guard {                      /* row . x must not become greater than the limit */
	int row, function, breakpoint;
	bool upward;
	int leads;                  /* to the region of this number, less that where it stands */
	double limit;
	int impact;                 /* that begins there; -1: none */
	int release;                /* of its region; -1: it is a switching function that is met */
};
struct impact_row {                 /* an impact */
	int function, breakpoint;
	bool upward;
	int rest;                   /* the interval in which it rests; -1: it is no bounce */
	int jump, still;            /* sets of assignments: its jump; that of a bounce without restitution */
	double *speed;              /* of its guard, as a row over x */
	double *back; /* over x: so much times how far the switching function is beyond, and it is on its guard */
	double restitution, amplitude; /* amplitude: the sizes of its speed's factors of cos and sin */
};
struct held_state {                 /* x[state] = value . x */
	int state;
	double *value;              /* size; of a state that is kept in two words size more, the second ones */
	enum retuned_kind kind;     /* where it comes from: a row of the regions */
	int of, index;
};
/* up or down; switching function -1: a release */
struct guard_key { int function, region, release, segment; bool upward; };
struct guards {
	bool apart;                 /* rows that are equal may become others: params are tunable */
	int *first;                 /* per region, and one more: its guards, of those of all */
	int guards;
	struct guard *guard;
	int rows, *branch;          /* of each row: whose it is, */
	struct guard_key *guard_row;    /* and what */
	/* rows x size; of a step that is checked for events over h `second` has what rounding may hide where it begins,
	 * too */
	double *row, *slope, *second, *fourth;
	int reaches, *reach_at;     /* of each row: where it begins in reach, reaches x size, as in pl_ladder */
	double *reach;
	/* per segment of time and switching function, per row: the sizes of its factors of cos and sin */
	double *amplitude, *row_amplitude;
	int sets, *set;             /* per set, and one more: the first of its assignments */
	int *hold;                  /* per region: the set that holds its states; -1: none */
	int assignments;
	struct held_state *assignment;
	int impacts;
	struct impact_row *impact;  /* per segment of time and impact */
};
struct guards guards_of(const struct step *step, const struct pieces *pieces);
/* of a region whose matrix the target makes, at most: its guards, and assignments */
void most_in_region(const struct step *step, int *guards, int *holds);
/* of one step: MAX_EVENTS and MAX_SPLITS, and room for the bounces before a contact rests */
int max_events(const struct model *model);
int max_splits(const struct model *model);
int fast_path_events(const struct model *model);             /* those that few.h follows */
int event_checks(const struct model *model);                 /* parts of a step that few.h looks at */
int most_in_step(const struct model *model);                 /* listed or not, with friction and impacts */
/* what friction carries that outputs read: regions x felts x size */
double *friction_forces_of(const struct step *step);

#endif
