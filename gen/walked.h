/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The run of a step with known loads, bit by bit, beside the exact one. */
#ifndef PLGEN_WALKED_H
#define PLGEN_WALKED_H

#include "command.h"
#include "run/run.h"

struct exact_run;                       /* outputs that needs are of, at every sample up to their ends */
/* Of the equations of `full` for the requirements of `stepped`; NULL: there are inputs, or it would take too long */
struct exact_run *exact_run_of(const struct model *full, const struct model *stepped);
double exact_samples(const struct exact_run *run);                     /* after the first */
double exact_largest(const struct exact_run *run, int requirement);    /* what the output reaches at samples */
/* Per requirement: its error as walked; false: it cannot be walked, or leaves the finite numbers */
bool walk_beside(const struct exact_run *run, const struct step *step, struct certificate *found);

#endif
