/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts, contacts at rest and friction beside a series. */
#ifndef PLGEN_STEP_SERIES_CONTACTS_H
#define PLGEN_STEP_SERIES_CONTACTS_H

#include "step/series/sequences.h"
#include "step/step.h"

struct entry { mpq_t number; int sequence; }; /* a factor: the number, or the sequence where that is not NONE */
/* Impacts and what is held beside a series. Beside dividing switching functions the search watches other sequences. */
struct watch {
	int sequence, column;
	bool full;                  /* all coefficients are read, else the first two */
};
struct series_hold {                /* a velocity that is kept at 0: by friction that sticks, by a contact at rest */
	int function, breakpoint; /* held between this and its twin */
	bool above;                 /* the velocity of friction, or the guard, rises with the switching function */
	int impact;                 /* whose contact rests; NONE: it is friction */
	int velocity, pull[2];      /* watches; beyond 0 it is let go to the interval below, above; NONE: it is not */
	double *back;               /* per state: what is taken from it for a velocity of 1, */
	int *back_watch;            /* or the watch of that; NONE: the number */
	int force, only;            /* a sequence; the only state of the velocity, or NONE */
	int drag;                   /* whose friction it is; NONE */
	struct entry *force_direction; /* per state: what that force, 1, adds to its slope */
	struct entry *gives;        /* per force column: likewise */
};
struct series_impact {                     /* an impact */
	int function, breakpoint;
	bool upward;
	int hold;                   /* in which its contact rests; NONE: it is no bounce */
	int *slope;                 /* per derivative of the equations: a watch, of the guard's */
	int place, speed;           /* watches: how far its guard is beyond 0; its rate */
	int jump, still, jumps;     /* assignments, so many from each on */
	double *back;               /* per state: what is taken from it for a guard of 1, */
	int *back_watch;            /* or the watch of that; NONE: the number */
	double restitution;
	double per;                 /* the switching function's for a guard of 1 */
};
struct conflict {                   /* holds that cannot be all at once */
	uint64_t set;          /* as bits */
	int hold, side;             /* friction of what a contact holds: 1 or -1, where it slips then; NONE: others */
	int watch;                  /* of which the side has the sign; NONE: it is the same everywhere */
};
struct series_jump { int state, watch; }; /* a state takes the value of what is watched */
struct contacts {
	bool moves;                 /* some of it is what is watched, and no number */
	int none, *bare;            /* sequences: 0; per state its slope without what holds, NONE: not made */
	bool *solved;               /* per state: that is solved for, with what holds */
	int holds, forces;          /* forces: with those of derivatives, which stand behind the others, */
	int columns;                /* so many of each */
	struct series_hold *hold;
	int series_impacts;
	struct series_impact *series_impact;
	int assignments;
	struct series_jump *assignment;
	int conflicts;
	struct conflict *conflict;
	int watches, ways;          /* ways: of so many, the first, more than the value at the start is looked at */
	struct watch *watch;
};

/* ---- contacts.c: impacts and friction beside a series ---- */

void hold_contacts(struct sequencing *w);                    /* before the states have their slopes */
bool is_bare(const struct sequencing *w, int state);         /* its slope without what holds is a sequence of its own */
/* y' with what holds; where its velocity alone is held that is 0, exactly */
struct sum held_slope(struct sequencing *w, int state);
/* of a force column: the slope that is solved for, with what holds, less what A has of it; NONE: it is not */
int  solved_force(struct sequencing *w, int force_column);
int  held_force(struct sequencing *w, int force_column);    /* the remainder, with what holds: a sequence */
/* Of what outputs read: the sequence, of a highest derivative that of its state; NULL: they read nothing of it */
int *motion_sequences(struct sequencing *w);

/* switching.c: those whose way counts stand first */
void sort_watches(struct contacts *c, int states);

#endif
