/* SPDX-License-Identifier: MIT-0 */
/* What steps of every scheme do alike, whatever the model: the same bits however they are taken, and how they end. */
#ifndef ALIKE_H
#define ALIKE_H

#include "plrt.h"

#include <stdbool.h>

double random_number(void);             /* from -1 up to 1, the same in each run */
void *fresh(const pl_model *m);         /* an instance at its start; to be freed */

/* A run and its steps have the same bits, also behind an init, from a copy, and behind a set; NAME_at leaves no trace;
 * NAME_get gives what was set */
void same_bits(const pl_model *m);

/* After the last good step, between these times, the status is `bit`. The state is finite then and stays so; where
 * `same`, it is that of the last good step. */
void ends(const pl_model *m, int bit, double from, double to, bool same);

#endif
