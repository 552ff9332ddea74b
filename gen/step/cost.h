/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a step costs. */
#ifndef PLGEN_STEP_COST_H
#define PLGEN_STEP_COST_H

#include "plrt.h"           /* the cost of its routines */
#include "step.h"

/* ---- cost.c: what a step costs ---- */

void count_program(const struct step *step, struct program *program); /* of a step with a remainder, not its loads */
int  multiplications_of_series(const struct expansion *x);   /* as far as its sequences are read */
void count_expansion(const struct step *step, struct program *program); /* of one series, and its sum */
/* of a collocated step an iteration of Newton's method; where there is no series, that is what its program costs */
void count_collocation(struct step *step);
void count_normal(const struct step *step, struct program *program); /* of a multistep step in normal modes */
/* what the load states of the columns in use cost; where there are refreshes, at each of them */
void count_loads(struct program *program, const struct step *step);
/* ... and to turn them into those of now */
void count_rotated_loads(struct program *program, const struct step *step);
/* of a step of regions: its sums, and the load states of all of them */
void count_regions(struct step *step, int multiplications, int additions);
/* a step, and its outputs where they are linear: instructions; without a target operations, those of double twice */
double cost_of_step(const struct step *step, const struct target *target);
/* as they were counted; calls: of <math.h>; forcings: of pl_cossin, whose sums and products are among the others;
 * waits: for a change of loads; pieces of a step that were searched; events in them, terms of their polynomials */
struct operations { double multiplications, additions, calls, forcings, waits, pieces, events, terms; };
double instructions_of(const struct step *step, struct operations of); /* of a Cortex-M4 */
double instructions_of_program(const struct step *step);     /* by its program, without refreshes */
void count_peaks(struct step *step);                        /* after its program and layout */

/* ---- worst.c: the most instructions of a step, while no number is subnormal ---- */

const char *unbounded_text(const struct step *step);         /* why there is no bound; NULL: there is one */
const char *worst_target(int target);                        /* its name; NULL: there are no more */
double worst_of_step(const struct step *step, int target, bool single);
const char *worst_text(const struct step *step);             /* 4934 on cortex-m0, ... */
void check_worst(const struct step *step);                   /* leaves the statement where a budget is not met */

/* ---- worst_counts.c: the most that a step by a series, a collocation, with peaks, changes or events does ---- */

/* Of its expansions products, sums, quotients, coefficients that are kept; functions of loads; of a search for events
 * terms of polynomials that are looked at, rows of these, parts; expansions; with a tolerance columns that are
 * measured, halvings, terms of what these may hide */
enum { WORST_PRODUCTS, WORST_SUMS, WORST_QUOTIENTS, WORST_KEPT, WORST_FORCED, WORST_LOOKED, WORST_ROWS, WORST_PIECES,
       WORST_EXPANSIONS, WORST_MEASURED, WORST_HALVED, WORST_SHOWN, WORST_SERIES };
const char *unbounded_series(const struct step *step);       /* as unbounded_text */
double worst_of_calls(const struct step *step, int target);  /* in an expansion; NONE: it is not known */
void count_worst_series(const struct step *step, double part[WORST_SERIES]);
/* Of a collocation: of all iterations products, sums, unknowns and states; functions of loads; terms of polynomials;
 * internal steps */
enum { NEWTON_PRODUCTS, NEWTON_SUMS, NEWTON_ITERATIONS, NEWTON_FORCED, NEWTON_FINISHED, NEWTON_TRIES,
       WORST_COLLOCATION };
void count_worst_collocation(const struct step *step, double part[WORST_COLLOCATION]);

/* Of a step in which they change (changes.h): products of its series, their rows, changes, entries of A */
enum { CHANGE_PRODUCTS, CHANGE_ROWS, CHANGES, CHANGE_ENTRIES, CHANGE };
void count_changes(const struct step *step, double part[CHANGE]);

/* Of a look inside a step for larger values (peak.c): products of its polynomials' terms; terms, of all entries; terms
 * of polynomials that are looked at; entries of A and of x; peaks */
enum { PEAK_PRODUCTS, PEAK_TERMS, PEAK_LOOKED, PEAK_LISTED, PEAKS, PEAK };
void count_peak_looks(const struct step *step, bool single, double part[PEAK]);

/* Of a step with events, by the limits of the runtime: functions of loads; the step without an event; moves by Taylor
 * polynomials from event to event, their terms, entries of A and of x; terms of switching functions or guards; looks at
 * these for roots; moves before the search; rows over x; what rests, tried in all combinations; products with matrices;
 * impacts; a step; stops, until what touches is at rest */
enum { SEARCH_FORCED, SEARCH_CLEAR, SEARCH_MOVED, SEARCH_SUMMED, SEARCH_FOLLOWED, SEARCH_LOOKED, SEARCH_CHECKED,
       SEARCH_ROWS, SEARCH_RESTING, SEARCH_SQUARES, SEARCH_IMPACTS, SEARCH_STEP, SEARCH_SWEPT, SEARCH };
void count_search(const struct step *step, bool single, double part[SEARCH]); /* but for functions of loads */

#endif
