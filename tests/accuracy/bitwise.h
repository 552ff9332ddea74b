/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the parts of bitwise share: bitwise_step.c has the numbers of a step, bitwise_solution.c those of the
 * closed-form solution. */
#ifndef BITWISE_H
#define BITWISE_H

#include <stdio.h>                      /* before gmp.h, which then declares gmp_fscanf */

#include "algebra.h"
#include "cases.h"
#include "random_spec.h"
#include "rationals.h"
#include "model/linear/modal_truncation.h"
#include "report/report.h"
#include "step/linear/images.h"
#include "step/linear/inner.h"

#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- bitwise.c ---- */

/* One case: what is compared now, and what went wrong so far */
extern struct tried {
	const char *spec, *scheme, *time;   /* text of the spec; time: the step, or t of a solution */
	int compared, failed, beyond;       /* beyond: times at which the judge gave up */
} trial;

void complain(const char *what, const char *message);
void compare(const char *what, double found, double expected);

/* ---- bitwise_step.c ---- */

/* y = states, [held states,] loads, inputs (with their slopes); y' = A y in one segment of time, and e^{A h} X has the
 * factors of one step in its first rows: of the states, of the load columns, of the input columns */
struct augmented {
	size_t states, loads, inputs;       /* columns of X of each kind */
	size_t first_load, size, columns;   /* of A and of X */
	mpq_t *A, *X;
};

enum { LEVELS = 6 };                    /* 512, 1024, ... 16384 bits */

struct enclosures {
	const struct augmented *a;
	mpq_srcptr h;
	evaluator_enclosure *level[LEVELS];
	bool given_up[LEVELS];
};

struct augmented augment(const struct linear *system, int segment, bool pl, mpq_srcptr h);
bool rounded(mpfi_ptr x, double *d);
void compare_low(const char *what, struct enclosures *e, size_t i, size_t j, const struct coefficient *found);
const char *entry_name(const struct model *model, size_t i, size_t j);
void compare_scheme(const struct model *model, bool both_roads);

/* ---- bitwise_solution.c ---- */

void compare_solution(struct model *model, mpq_srcptr written_step);

#endif
