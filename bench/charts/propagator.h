/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A linear problem's run by the matrix of a step (propagator.c), or mode by mode (modal.c). */
#ifndef PROPAGATOR_H
#define PROPAGATOR_H

#include "charts.h"

enum { MOST_LOADS = 3 };

struct propagator {
	struct run run;
	int own, size;              /* entries of y, and of z */
	int steps;                  /* in a unit */
	double h;
	bool failed;
	double *generator;          /* size x size, row-major: z' = generator z */
	double *start;              /* z at t = 0 */
	double *z, *spare;
	double *Phi;                /* e^{generator h} */
	double *part, part_length;  /* `between`: the same for a part of a step */
	struct modes *modes;        /* modal superposition, or NULL */
	double *ahead;              /* `between`: z ahead of now */
	void *code;                 /* literals: its object */
	void (*literals)(double *z, long units, double *rows);
	void (*literals_single)(float *z, long units, float *rows);
	float *single;              /* in float, or NULL: Phi, then z, then room for the next z */
	float *row;                 /* rows on their way to double */
	int rows;                   /* room in row */
};

void naive_exponential(int size, const double *generator, double length, double *result);  /* residues_naive.c */
bool modes_find(struct propagator *r);          /* and its table for a step; false: there are none */
void modes_discard(struct modes *m);
void modes_restart(struct propagator *r);
void modal_unit(struct propagator *r);
void modal_between(struct run *run, double fraction, double *y);

#endif
