/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A linear step in its forms: direct, delta, kick-drift-kick, modal, by blocks, with refreshes. */
#ifndef PLGEN_STEP_FORMS_H
#define PLGEN_STEP_FORMS_H

#include "step/step.h"

/* part times the load states solves the equations: what some loads sustain by themselves */
struct forced {
	bool *load;                 /* per load: one of them; then the step is without it */
	int rows, written;          /* the states as they are kept, and those as written from this row on */
	struct coefficient *part;   /* [segment of time][row][load column] */
	mpq_t *exact;               /* the same */
	/* [segment of time][state][load column]: what the state that is kept gains from there to the next */
	struct coefficient *change;
	bool changes;               /* any of it */
	int multiplications, additions; /* to add it */
};

/* ---- forced.c: what rounding does to a step with loads ---- */

/* its rounding; its forced part, where the bound is the better for it */
void plan_forced(struct step *step);
const char *rounding_text(const struct step *step);

enum { MOST_REFRESHED = 256 };      /* steps from one refresh to the next */
struct refreshed_term { int state, column; };
struct refresh {                    /* load states at a refresh, and tables for the steps to the next */
	int steps;                  /* from one to the next */
	bool *load;                 /* per load: a refresh keeps its states */
	bool rotated;               /* the step turns them into those of now, and has no terms */
	int terms;                  /* of a step: by state, then by column of a load */
	struct refreshed_term *term;
	struct coefficient *factor; /* [steps since the refresh][term]: of the load state there */
	double *turn;               /* [load][steps since][2]: e^{a l h} cos(w l h) and sin */
};

/* ---- refresh.c: functions of loads every so many steps, tables between ---- */

void check_refresh(struct step *step);                      /* says where they are asked for in vain */
void plan_refresh(struct step *step);                       /* after its table */
int refresh_numbers(const struct step *step);               /* in the table for the steps between */
void fill_refresh(struct step *step);                       /* after its forced part is chosen */
int refreshed_term(const struct step *step, int state, int column);  /* its index; -1: it is none */

/* ---- stepform.c: a linear step as direct, delta or kick-drift-kick ---- */

const char *step_form_text(const struct step *step);          /* delta, compensated */
void choose_form(struct step *step);                        /* leaves the statement where the one asked for cannot be */
void check_step_form(struct step *step);                         /* before the step: leaves what its kind has not */
void choose_form_of_regions(struct step *step);             /* the same of a piecewise-linear model */
/* before its program; none where all of the state is compensated */
void find_carries(struct step *step);
struct program *linear_program(const struct step *step);    /* from its table */
/* in the code: loads that change have none */

/* ---- large.c: a large step by its independent blocks ---- */

/* of a block's row; a state is one of the block */
const struct coefficient *group_factor(const struct step *step, const struct group *g, int row, int block,
				       const struct operand *operand, int segment);
/* In some segment of time, of some block: else it leaves no trace. */
bool group_acts(const struct step *step, const struct group *g, int row, const struct operand *operand);

/* ---- drift.c: what the rounding of its constants does to a linear step ---- */

struct drift {                      /* per step, of the mode where it is largest */
	double amplitude;           /* ln|z| - Re p h */
	double phase;               /* |arg z - Im p h| [rad] */
	bool known;                 /* there is no remainder, and the step does not loop over Phi */
};
struct drift drift_of(const struct step *step);
const char *drift_text(const struct drift *drift, mpq_srcptr h);    /* over one hour of steps of h [s] */

/* ---- modal.c: a step of modes instead of states ---- */

struct modal {                      /* modal states: the real parts of the pairs, their imaginary parts, what is real */
	int states, pairs, reals, loads, inputs;
	double *turn;               /* e^{p h}, as the modal states stand */
	double *to, *from;          /* modal states from states, and back; states x states */
	double *load, *input;       /* what a step adds; states x columns */
	double *output;             /* outputs x states: what of them is linear; NULL: they are the states */
	struct drift drift;
	double condition;           /* what rounding gains that goes through both, 1 at best */
};

/* ---- by_modes.c: whether it is taken ---- */

void plan_modal(struct step *step);                          /* where it is asked for, or cheaper and as exact */

/* ---- denormal_flush.c: what is too small to count ---- */

struct denormal_flush {                       /* parts of the state that nothing but themselves moves */
	int parts, decaying;        /* the first of them decay */
	bool beside;                /* states are compared with others of their part, too */
	int *part;                  /* per state as it is kept */
};
void leave_out_lost(struct step *step);                      /* factors; before the program */
void plan_flush(struct step *step);                          /* step->linear.flush */

#endif
