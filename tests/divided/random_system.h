/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random masses with cubic springs, stops, contacts between each other, quadratic damping, forces that jump with a
 * position: the same system as a spec and by hand. */
#ifndef DIVIDED_RANDOM_H
#define DIVIDED_RANDOM_H

#include "systems.h"

#include <stdio.h>

/* By hand; the equations are those of the last one that was made. */
struct divided_system random_divided(unsigned seed);
void print_divided(FILE *to, unsigned seed);

#endif
