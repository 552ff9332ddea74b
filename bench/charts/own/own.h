/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * What the chart of any spec is made of. own.sh compiles own.c for one model, with STATES, INPUTS and two texts in
 * its folder, so that a peer has the equations inlined into its steps as plgen's step has:
 *
 *     rhs_double.h      NAME_rhs, static inline
 *     rhs_long.h        the same in long double, of what is true
 *
 * SECOND_ORDER: whether the states are coordinates and then their velocities. A peer goes through the whole history and
 * writes a row of all states at each output. To add one: a function in peers.h, and a line in `peers` of own.c; those
 * of the kept charts, whose files are compiled with the equations once more, stand in files of their own. */
#ifndef OWN_H
#define OWN_H

#include <math.h>
#include <setjmp.h>
#include <stdbool.h>
#include <stdint.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#include "plrt.h"

#define INLINE static inline __attribute__((always_inline))
typedef long double quad;               /* what is true is found in: 64 bits */
/* A model may have a name that <complex.h> makes a macro of */
#include "rhs_double.h"
#include <tgmath.h>
#undef I
#undef complex
typedef long double quad_of_truth;
#include "rhs_long.h"

enum { N = STATES, ROOM = INPUTS > 0 ? 2 * INPUTS : 1 };

/* ---- the history ---- */

struct history {
	double every;                   /* [s] between outputs */
	int units;                      /* outputs */
	double start[N];
	double scale[N];                /* largest coordinate, or velocity, of the history */
	double *sample;                 /* inputs: rows 0 to units, at the outputs */
	double *ends;                   /* as NAME_run takes them where a step is an output; NULL: no inputs */
	float *single_ends, *single;    /* the same in float; room for rows in float */
	bool ramp[ROOM];                /* of each input; else held */
	int unit;                       /* that inputs are asked in; peers set it */
	long evaluations, most;         /* of the right-hand side; beyond `most` a peer has given up */
	jmp_buf gave_up;
};
extern struct history history;

/* Inputs, then their slopes */
INLINE void inputs_at(double t, double *u)
{
	const double *now = history.sample + (size_t)history.unit * INPUTS, *next = now + INPUTS;
	for (int i = 0; i < INPUTS; i++) {
		const double slope = history.ramp[i] ? (next[i] - now[i]) / history.every : 0.0;
		u[i] = now[i] + slope * (t - history.unit * history.every);
		u[INPUTS + i] = slope;
	}
}

INLINE void slope(double t, const double *y, double *f)
{
	if (++history.evaluations > history.most)
		longjmp(history.gave_up, 1);
#if INPUTS > 0
	double u[ROOM];
	inputs_at(t, u);
	rhs_double(t, y, u, f);
#else
	rhs_double(t, y, f);
#endif
}

INLINE bool own_finite(const double *y)
{
	double zero = 0.0;
	for (int i = 0; i < N; i++)
		zero += 0.0 * y[i];
	return zero == 0.0;
}

struct peer {
	const char *name;
	bool tolerance;                 /* the setting is a relative tolerance, else steps in an output */
	/* false: it failed */
	bool (*run)(double setting, double *rows);
	const char *settings;
	/* to this model, whose scales are known; NULL: to every one */
	bool (*applies)(void);
	bool once;                      /* its step is an output */
	const int *digits;              /* tolerances of its own; NULL: those of all */
};

/* Of the kept charts: kept_solvers.c, kept_dop853.c, kept_radau.c, kept_regions.c. Absolute tolerances
 * are the relative one times the largest coordinate, or velocity, of the history. */
bool own_dormand(double setting, double *rows);
bool own_rk8pd(double setting, double *rows);
bool own_adams(double setting, double *rows);
bool own_bdf(double setting, double *rows);
bool own_dop853(double setting, double *rows);
bool own_radau5(double setting, double *rows);
bool own_radau9(double setting, double *rows);
bool own_radau13(double setting, double *rows);
bool has_regions(void);
bool own_regions(double setting, double *rows);
void rounded_exponential(int size, const double *generator, double length, double *result);
/* Phi: own + 1 rows and columns, the last entry of a state is 1: literals.c's `advance` for it, NULL where there is
 * none */
void *own_literals(int own, const double *Phi);

#endif
