/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the recipes of schemes are written in. */
#ifndef PLGEN_STEP_RECIPE_H
#define PLGEN_STEP_RECIPE_H

#include "step/step.h"

/* ---- recipe.c: what recipes are written in; one that asks for more than there is room for is refused ---- */

enum { RECIPE_TABLES = 8 };
struct recipe {                     /* of one scheme, being written */
	const struct step *step;
	struct program *program;
	int tables;
	struct wanted table[RECIPE_TABLES];
};
_Noreturn void internal_error(const struct step *step, const char *what); /* a fault of this program's own */
int  add_table(struct recipe *r, const char *name, long p, unsigned long q, bool Phi); /* at p/q of the step */
/* h (c0 phi1 + c1 phi2 + 2 c2 phi3) of A h as the response to c0 + c1 s/h + c2 (s/h)^2, over p/q of the step */
int  add_phi(struct recipe *r, int table, const char *name, long p, unsigned long q, int powers, const long *c);
int  add_node(struct recipe *r, long p, unsigned long q);   /* a time at which remainders are evaluated */

#endif
