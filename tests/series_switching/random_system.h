/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random masses with cubic springs, stops, contacts between each other, quadratic damping, forces that jump with a
 * position: the same system as a spec and by hand. */
#ifndef DIVIDED_RANDOM_H
#define DIVIDED_RANDOM_H

#include "systems.h"

#include <stdio.h>

/* By hand; the equations are those of the last one that was made. */
struct switched_system random_switched(unsigned seed);
void print_switched(FILE *to, unsigned seed);

#endif
