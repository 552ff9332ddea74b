/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a sweep through a piecewise-linear model is made of: movers, which are its independent parts, or the whole. */
#ifndef PLGEN_PERIOD_H
#define PLGEN_PERIOD_H

#include "report/report.h"

enum { WORK = 7 };
struct mover {
	const struct switching *of;     /* its regions */
	const int *place;               /* per state: of the model's; NULL: the same */
	int states, size;               /* of z = [y, a cos(w t), a sin(w t), 1] */
	int systems;
	double **A, **at, **E;          /* per system, of z: all but w; at w; e^{A h} of it, where known */
	bool *known;
	double **row, **row_at, **limit; /* per expression: over z, likewise at w; its breakpoints */
	double rate;                    /* largest modulus of a pole in any region [1/s] */
	double amplitude, w, period;    /* a; [rad/s]; [s] */
	int samples;                    /* in a period, between which crossings are looked for */
	/* of the last period: crossings; per state the integral of y e^{-iwt}, real and imaginary */
	int crossings;
	double *integral[2];
	double *work[WORK], *square[3], *piece;
};
/* of a model with `switching`; returns how many. The excitation is a cos(w t) in the place of what drives; other loads
 * that are constant act, and nothing else does */
void mover_multiply(int n, const double *a, const double *b, double *to); /* n x n */
int  movers_of(const struct model *model, const struct drive *drive, struct mover **list);
void mover_tune(struct mover *m, double w);
/* y becomes that a period later. M, states x states, how it follows from y, and scale, per state the largest size on
 * the way, where they are not NULL; scale is only enlarged; without it the integrals are left at 0 */
void mover_period(struct mover *m, double *y, double *M, double *scale);
/* of an output over [y, a cos(w t), u'/w of it, 1], as it is written: states and OVER */
double *output_over(const struct model *model, int output, const struct drive *drive);

#endif
