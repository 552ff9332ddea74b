/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Surfaces where a form is 0 that something decides on, and the equations on either side; for smooth.c. */
#ifndef PLGEN_SIDES_H
#define PLGEN_SIDES_H

struct atom;

struct side {
	struct collector *c;
	const struct form *g;
	int sign;                   /* of g there; 0: on it */
	int count;
	/* per atom: whether it decides on g, or what it is made of does; 0 not known yet, else -1 or 1 */
	signed char *touched;
	struct form **known;        /* per atom that does */
};

/* What a decision on the sign of `d` makes of it: a product is decided by its factors of odd power. */
void visit_surfaces(const struct form *d, void (*visit)(void *context, const struct form *g), void *context);
/* All forms on whose signs an atom decides itself */
void visit_decisions(const struct atom *a, void (*visit)(void *context, const struct form *d), void *context);
struct form *form_on_side(struct side *s, const struct form *form);

#endif
