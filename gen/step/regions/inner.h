/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of step/regions have from one another, and nobody else. */
#ifndef PLGEN_STEP_REGIONS_INNER_H
#define PLGEN_STEP_REGIONS_INNER_H

#include "regions.h"

/* ---- pieces.c: what a piecewise-linear model finds its crossings with ---- */

/* Sum of the sizes of a row's factors of loads that are never above 1 */
double size_of_bounded(const struct step *step, const double *row);
/* Of rows over x in one branch's system: d/3 times the slope, and bounds as in struct region_piece; rows x size each */
void bounds_of_rows(const struct step *step, const struct pieces *pieces, int branch, int rows, const double *row,
		    double *slope, double *second, double *fourth);
/* gains.c: e^{A d} - I over d = h 2^-halvings, from its table: 2 size x size, first words, then second ones; NULL: the
 * state has one word */
double *gain_of(const struct step *step, const struct table *table, int halvings);
/* e^{A d} of load states among themselves, to Phi, size x size; low: the second words, NULL: none */
void growth_of_loads(const struct step *step, mpq_srcptr d, double *Phi, double *low);
/* ladder.c: e^{A d} over h 2^-halvings; the rungs of a branch, as pl_ladder has them; what is off its chord in them, of
 * rows over x: so many for each row as it has rungs; whether any has some, and how many each has room for where an
 * instance has its tables */
void plan_ladder(struct step *step, int branch);
double **rungs_of(const struct step *step, int branch);
double *reach_of_rows(const struct step *step, int branch, const double *A, int rows, const double *row);
int rung_halvings(const struct branch *branch, int rung);   /* of h, to its length */
/* the same in two words: 2 x size */
void row_in_words(const struct step *step, const struct output *output, int segment, double *row);

/* ---- folded.c: what stays of x, in the tables of an instance ---- */

/* Of a step that is checked for events over h and has no fast path: `added` and `still` of each piece, `edge` */
void gather(const struct step *step, struct pieces *pieces);

#endif
