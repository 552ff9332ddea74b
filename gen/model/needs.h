/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How exact outputs have to be, and what that is decided by. */
#ifndef PLGEN_MODEL_NEEDS_H
#define PLGEN_MODEL_NEEDS_H

#include "model/model.h"

/* ---- needs.c: how exact outputs have to be ---- */

struct target {                     /* a processor: what it takes of instructions */
	const char *name;
	struct { double multiplication, addition, wave, step; } cost[2]; /* in double, in float */
};
/* of the model that is stepped: its requirements, its target; false: it was said what stands in the way */
bool find_requirements(struct model *model);
bool steps_exactly(const struct model *model);              /* by scheme exact, or by one that nothing is left to */
bool is_measured(const struct model *model);                /* no bound is known: it is not linear, or in pieces */

/* ---- amplitudes.c ---- */

bool differ_in_loads(const struct model *a, const struct model *b); /* in nothing but how large their loads are */

#endif
