/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Formulas that the state chooses, beside a series and from crossing to crossing. */
#ifndef PLGEN_STEP_SERIES_SWITCHING_H
#define PLGEN_STEP_SERIES_SWITCHING_H

#include "step/step.h"

struct sequencing;

struct series_switching { /* a switching function of the state that breakpoints divide, smooth between events */
	const struct form *form;    /* without constant; sign and scale as first written */
	int sequence, column;       /* its coefficients: the place behind those of the states, or of one that it is */
	int breaks;
	mpq_t *at;                  /* in order of their first appearance */
	int *rank;                  /* of each of them, how many are below it; the twin of one is above it */
};

/* ---- switching.c: formulas that the state chooses ---- */

struct division {                   /* the sign of a difference */
	int function, breakpoint; /* it changes where that passes this; NONE: it is constant, */
	bool above;                 /* and this its sign; else: is it positive above the breakpoint? */
};
/* The same of what is known by then; false: it is not */
bool find_division(const struct expansion *x, const struct form *a, const struct form *b, struct division *division);
/* Of the state, by 0: factor times its switching function less the breakpoint; with its sequence */
struct division divide_form(struct sequencing *w, const struct form *form, mpq_ptr factor);
void add_twin(struct series_switching *d, int breakpoint);            /* a second breakpoint there */
/* of two alike that of the upper: what is held between them counts as below */
int  upper_rank(const struct expansion *x, int function, int breakpoint);
mpq_t *rising_breakpoints(const struct series_switching *d);
const char *series_switching_text(const struct step *step, int function); /* over the written coordinates */
/* Of intervals, until those of a state that was set are found */
int  most_changes(const struct expansion *x);
/* The number of a region is its switching functions' intervals in mixed radix; 0: too many for an int */
int  regions_of_series(const struct expansion *x);
/* Leaves the statement where what is chosen by the state is not treated */
void check_series_switching(const struct step *step);

/* ---- event_split.c: a scheme with a remainder, from crossing to crossing ---- */

struct event_split {
	struct expansion *event_check; /* of the solution, as far as where it is heading */
	struct expansion *ends;     /* of it the switching functions' values and slopes, */
	struct expansion *forces;   /* and the remainder, with the formulas of given intervals */
	struct layout layout;       /* of x, each force with its derivatives: see pl_event_split */
	double **slopes;            /* per segment of time: A of x' = A x, size x size [1/s] */
	int multiplications, additions, calls; /* of the looks in a step */
	double fastest;             /* above the poles of the sizes |A| [1/s] */
	double certain;             /* so much of a step that no pole turns by more than 1; 1: cubics hold over it */
	int kilobytes;              /* of stack for tables */
};
void plan_event_split(struct step *step);                   /* step->cut */

#endif
