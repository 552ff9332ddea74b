/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What time does to a linear step: slopes, loads, samples, series, powers of it. */
#ifndef PLGEN_STEP_SLOPES_H
#define PLGEN_STEP_SLOPES_H

#include "model/model.h"
#include "step/linear/tables.h"

struct series {                     /* of e^{A tau} x: the Taylor series behind NAME_at, and the pieces of regions */
	bool emitted;               /* max|pole| h <= 8 */
	int degree, halvings;
};

/* ---- series.c: the Taylor series behind NAME_at ---- */

void series_plan(struct step *step);                        /* degree, halvings */
double largest_pole_angle(const struct step *step);         /* max|pole| h, rounded up */
int  series_halvings(const struct step *step, int operator); /* of the time h, so that |pole| tau <= 1 */
/* for these operators, over h 2^-halvings */
int  series_degree(const struct step *step, int first, int last, int halvings);

/* Phases and growths of loads e^{at} cos(wt + p) in fixed point: 128 bits; for the target float 64, in `low` */
struct fixed_point { uint64_t high, low; };
struct advance {                    /* over some time tau; 0 where there is no w, no a */
	struct fixed_point turn;          /* w tau / 2 pi in units of 2^-128 (2^-64), wrapped */
	struct fixed_point growth;        /* a tau / ln 2 in units of 2^-112 (2^-48), two's complement; saturated */
};
struct rate {                       /* word[0] word[1] word[2] 2^exponent, as one number of 64 bits a word [1/s] */
	int words;                  /* 3; for float 2 */
	uint64_t word[3];
	long exponent;
};
struct load_phase {                 /* of one load */
	struct fixed_point start;         /* p / 2 pi, as a turn */
	struct advance step, *node; /* over the step; from its start to each node of the program */
	struct rate turns, growth;  /* |w| / 2 pi, |a| / ln 2 */
};

/* ---- phases.c: phases and growths of loads in fixed point ---- */

int  phase_bits(const struct step *step);                    /* 128, or 64, all behind the point */
int  growth_bits(const struct step *step);                   /* 112, or 48: those behind the point */
void plan_phases(struct step *step);                        /* step->phase; after the program, for its nodes */

/* ---- slopes.c: A of x' = A x, rounded; x as in struct layout ---- */

struct load_slopes {                /* the columns of A that change from segment to segment of time */
	int first, columns;         /* of x; first -1: no load acts */
	double **segment;           /* states x columns [x/s]; 0 of loads that the step leaves out */
};
_Noreturn void report_range(const struct step *step);        /* an error at the step: a number overflows */
/* size x size [x/s], loads as in the first segment, and the second words of the same; */
double *slopes_of(const struct step *step, int branch);
							     /* infinite beyond the range */
struct load_slopes load_slopes_of(const struct step *step);
struct coefficient *held_forces_of(const struct step *step); /* n x states: what a scheme holds, as forces */

/* ---- leap.c: the step as one matrix, for powers of it ---- */

struct leap {                       /* x(t+h) = matrix x; x = states, then the load states that the step reads */
	int size;
	int *load;                  /* index of the first state of each load; -1: the step does not read it */
};
struct leap_entry {                 /* in a segment of time, in two words */
	int segment, row, column;
	struct coefficient value;
};
struct leap leap_of(const struct step *step);
/* Beyond Phi, what is not 0; returns how many */
int leap_entries_of(const struct step *step, const struct leap *leap, struct leap_entry **entry);

/* ---- hold.c: what inputs do between samples ---- */

void sample_weight(int hold, int power, int sample, mpq_ptr weight); /* of (s/h)^power in that of a sample */
void sample_derivative(int hold, int power, int sample, mpq_srcptr h, mpq_ptr derivative); /* at the step's start */
/* what |d^power u / d s^power| h^power at the step's start is at most where no sample is above 1 */
double sample_reach(int hold, int power);
void sample_slope(int hold, int sample, mpq_ptr slope);      /* h u' at the step's end, per sample */
int samples_ahead(int hold);                                 /* that an input has had when the first step comes */
void check_holds(const struct step *step);                   /* leaves the statement where one cannot be */

#endif
