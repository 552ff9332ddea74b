/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of model/tunable have from one another, and nobody else. */
#ifndef PLGEN_MODEL_TUNABLE_INNER_H
#define PLGEN_MODEL_TUNABLE_INNER_H

#include "elsewhere.h"
#include "tuning.h"

/* ---- elsewhere.c: a model at other values of its tunable params, and how its entries follow from these ---- */

/* Waves, their order, times at which they change; any_rate: frequencies may differ */
bool same_loads(const struct linear *a, const struct linear *b, bool any_rate);
_Noreturn void report_difference(struct elsewhere *s, const struct difference *difference);
void look_elsewhere(struct elsewhere *s);
mpq_srcptr entry_seen(const struct elsewhere *s, int place, ptrdiff_t index);
bool entry_stays(const struct elsewhere *s, ptrdiff_t index);
/* into the equations, as it was recorded; what is 0 is left out */
void add_tuned_entry(struct elsewhere *s, ptrdiff_t index, struct tuned_equations *all, int row, int column);

/* ---- derived.c: what is computed from tunable params as if it were one ---- */

void warn_of_unread(const struct model *model);
void check_tuned(const struct model *model);    /* what is left of it leaves the statement */

/* ---- params.c: tunable params that the instance has ---- */

unsigned params_read(const struct node *node);  /* the given ones it follows from, a bit each */
unsigned params_of_tunable(const struct spec *spec, int tunable);
struct tuning *list_tunables(const struct model *model);

#endif
