/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of a way through crossings share. */
#ifndef PLGEN_THROUGH_H
#define PLGEN_THROUGH_H

#include "step/step.h"

enum { THROUGH_SLOTS = 64 };
struct near {                       /* x in double, and how far off it may be */
	double *x, *off;
};
struct gate {                       /* a row over x that must not become greater than its limit */
	int expression, breakpoint, leads;
	bool upward;
	mpq_t *row, *slope;         /* slope: of its derivative with respect to time */
	mpq_t limit;
	/* the same in double; fourth . |x| bounds the fourth derivative */
	double *near_row, *near_slope, *fourth, near_limit;
};
struct area {                       /* a region as it is met */
	int system;
	mpq_t *A;                   /* x' = A x */
	struct stream *flow;          /* NULL: it was not met yet */
	double *growth;             /* e^{|A| piece} */
	int gates;
	struct gate *gate;
};
struct through {
	const struct model *whole, *model;
	const struct region_part *part; /* NULL: both are one */
	const struct switching *s;
	const struct linear *system; /* the first: coordinates, loads and inputs are those of all */
	int precision, n;           /* bits; entries of x */
	struct layout layout;
	int segments, segment;      /* of time */
	const mpq_t *change;
	mpq_t **A;                  /* per system */
	struct stream **flow;
	double **growth;
	struct area *area, *at;     /* per region; where it is */
	int region;
	bool *resting;              /* per expression: it stands on a breakpoint, exactly, while the region stays */
	mpq_t base;                 /* [s] */
	mpfi_t *x, *y;              /* x at that time, in the equations of `at` */
	mpq_t *exact;               /* x at the start; NULL: it is not rational */
	/* on the grid of pieces, from where it was met: x after so many, by the lowest one of their number */
	bool gridded;
	unsigned long pieces;
	mpfi_t *slot[THROUGH_SLOTS + 1];
	struct series_room room;
	int terms;
	mpfi_t *value, *slope;      /* polynomials */
	mpfr_t one;
	struct near near[2];
	double *most;
	int at_once;
	int passed;
	struct passed *list;
	const char *undecided;
};

#endif
