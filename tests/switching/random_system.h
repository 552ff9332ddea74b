/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random masses, springs, dampers, loads and stops: the same system as a spec and by hand. */
#ifndef RANDOM_SYSTEM_H
#define RANDOM_SYSTEM_H

#include "hand.h"

#include <stdio.h>

struct hand_system random_system(unsigned seed);

/* Two crossings close together in one step: a stop that is reached and left within a fraction of a step, at a seed's
 * depth */
struct hand_system adversarial_system(unsigned seed);

/* The system as a spec, in a form of the stops that the seed chooses */
void print_spec(FILE *to, const char *name, const struct hand_system *s, unsigned seed);

#endif
