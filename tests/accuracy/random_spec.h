/* SPDX-License-Identifier: GPL-3.0-or-later */
#ifndef RANDOM_SPEC_H
#define RANDOM_SPEC_H

#include <stdint.h>

/* A linear model of 1 to 4 coordinates as the text of a spec: chains and dense matrices, damped or not, coordinates of
 * first order, elements of a sketch, with and without loads (also such that change in time) and inputs, numbers of 1 to
 * 17 digits and mixed magnitude.  The same text for the same seed, everywhere; lives until the program ends. */
char *random_spec(uint64_t seed);

/* One with states that its outputs cannot see: symmetric chains, equal blocks, sums of all, blocks that are only
 * driven. */
char *random_symmetric_spec(uint64_t seed);

#endif
