/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of model/regions have from one another, and nobody else. */
#ifndef PLGEN_MODEL_REGIONS_INNER_H
#define PLGEN_MODEL_REGIONS_INNER_H

#include "switching_functions.h"
#include "regions.h"

/* ---- switching_functions.c: what is compared with breakpoints ---- */

/* The switching function that form is a multiple of in this segment of time; met for the first time it is one, with the
 * sign and scale in which it was written, and form is its own. form + constant = of (e - at) */
int  find_switching_function(struct switching *s, int segment, const struct compared *what, mpq_ptr of, mpq_ptr at);
/* In segments where nothing depends on it, it is as in the one before, or after. */
void complete_switching_functions(struct switching *s);
bool share_function(const struct switching *a, const struct switching *b);
int  count_candidates(struct switching *s);                 /* in one segment of time; strides of switching functions */

/* ---- regions.c: piecewise-linear equations as regions with linear ones ---- */

/* of these rows of the equations; leaves the statement where they are too many, or with dry friction */
struct switching *regions_of_rows(struct building *b, int rows, int *row);
void remove_idle_breaks(struct switching *s);
void check_sum(const struct building *b, const struct switching *s);  /* of regions that are cached; refuses others */
bool same_equations(const struct linear *a, const struct linear *b, int row, int rows); /* from a row on: possible.c */
void mark_possible(const struct building *b, struct switching *s); /* which may be: possible.c */
void check_jumps(struct building *b, const struct switching *s); /* forces that jump with a velocity are refused */
_Noreturn void too_many(struct building *b, const struct switching *s);
_Noreturn void too_many_in_time(const struct switching *s);
/* A region's matrix is no sum over switching functions, at this node */
_Noreturn void refuse_cache(const struct building *b, const struct switching *s, const struct node *node,
			    const char *why);

/* ---- sides.c: surfaces where a form is 0 that something decides on, and the equations on either side ---- */

struct side {
	struct collector *c;
	const struct form *g;
	int sign;                   /* of g there; 0: on it */
	int count;
	/* per atom: whether it decides on g, or what it is made of does; 0 not known yet, else -1 or 1 */
	signed char *touched;
	struct form **known;        /* per atom that does */
};

struct form *form_on_side(struct side *s, const struct form *form);

#endif
