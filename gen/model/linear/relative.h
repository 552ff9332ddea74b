/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coordinates in which rigid-body modes are parted from relative motion. */
#ifndef PLGEN_MODEL_RELATIVE_H
#define PLGEN_MODEL_RELATIVE_H

#include "model/model.h"

/* ---- relative.c: coordinates in which rigid-body modes are parted from relative motion ---- */

struct link {                       /* of a written coordinate x: what is kept in its place */
	/* x itself; its distance from another; the centre of its group */
	enum { LINK_NONE, LINK_PARENT, LINK_CENTRE } kind;
	int from;                   /* LINK_PARENT: the other, x_p */
	mpq_t ratio;                /* x - ratio x_p is kept, */
	bool reversed;              /* or ratio x_p - x */
	/* LINK_CENTRE, per coordinate: X = sum of weight x; x = X + sum of shift times what is kept */
	mpq_t *weight, *shift;
	/* LINK_PARENT, x of second order, x_p of first: x_p' over written coordinates, so that x' - ratio x_p' is
	 * kept, */
	struct form *rate;
	/* or else the kept coordinate that is x', of first order; -1: that of what is kept */
	int velocity;
};
struct relative {
	const struct model *written;
	/* coordinates kept: in the place of each written one, then velocities that stand alone */
	int n;
	const char **name;
	int *order;
	struct link *link;          /* per written coordinate */
	int links, *sequence;       /* those of LINK_PARENT, each after the one that it is measured from */
	struct form **form[3];      /* per derivative and written coordinate: over what is kept */
	struct form **extra;        /* equations r' = v - ... of velocities that stand alone, after all others */
	/* per written coordinate: what its equation is divided by, so that equations are combined as coordinates
	 * are; */
	mpq_t *solved;
	                            /* NULL: equations stay as written */
};
/* What is kept at a coordinate, from the written coordinates, or their velocities, that it takes */
void relative_value(const struct relative *r, int coord, mpq_t *const *value, mpq_ptr kept);
/* that of what is kept there */
struct form *combined_equation(const struct relative *r, int coord, struct form *const *equation);
void relative_values(const struct model *model, mpq_t *written, mpq_t *kept); /* of all states */
/* Of each written state its factors over those kept, then what is added */
mpq_t *relative_rows(const struct model *model);
int  relative_place(const struct model *model, int written); /* the kept state that is a written one; -1: none is */

#endif
