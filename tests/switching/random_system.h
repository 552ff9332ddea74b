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

/* Of those beside it: 0 .. n - 1 (a generator of Knuth, the high bits); a number of three decimals, which is what the
 * spec says, to the last bit of a long double */
void seed_with(unsigned seed);
int below(int n);
real number(double low, double high);

/* And parts of its spec: the model and its start; " + 0.5*x1' ..."; how much stop j pushes, of d{j} in a form, or in a
 * condition with `beyond`, > or >=, where it is damped or has none; equation i as far as its '=' */
void print_head(FILE *to, const char *name, const struct hand_system *s);
void print_linear(FILE *to, const struct hand_system *s, const real *row, const char *prime);
void print_push(FILE *to, const struct hand_system *s, int j, const char *form, const char *beyond);
void print_left(FILE *to, const struct hand_system *s, int i);

#endif
