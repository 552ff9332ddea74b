/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Variants of piecewise-linear models, as variants.sh lists them, and how the tests drive them. */
#ifndef VARIANT_H
#define VARIANT_H

#include "plrt.h"

enum { MOST_EVENTS = 128, MOST_STATES = 16 };    /* NAME_MAX_EVENTS, states: of the largest model here */

struct variant {
	const pl_model *model;
	int (*region)(const void *s);
	uint64_t (*crossed)(const void *s);
	int (*crossings)(const void *s, pl_crossing *crossing);
};

#endif
