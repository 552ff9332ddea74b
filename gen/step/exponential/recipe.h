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
/* added to that */
void add_phi_part(struct recipe *r, int table, int kernel, long p, unsigned long q, int powers, const long *c);
int  add_weighted(struct recipe *r, int table, const char *name, long p, unsigned long q, long weight,
		 unsigned long over); /* e^{A h p/q} h weight/over */
int  add_node(struct recipe *r, long p, unsigned long q);   /* a time at which leftovers are evaluated */
void need_loads_at(struct recipe *r, int node);
int  new_stage(struct recipe *r);
/* valid until the next is added, as that of add_sum is */
struct action *add_action(struct recipe *r, struct action action);
int  add_leftover(struct recipe *r, int node, int stage);
int  add_combination(struct recipe *r, int plus, int minus, bool added);
struct action *add_sum(struct recipe *r, int stage, int flow, int plain, const char *note);
void times_left(struct recipe *r, struct action *sum, int table, int kernel, int left); /* one term more of the sum */

#endif
