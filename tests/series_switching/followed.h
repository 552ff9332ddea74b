/* SPDX-License-Identifier: MIT-0 */
/* The models of these tests followed in long double, and what programs of theirs make of them */
#ifndef DIVIDED_FOLLOWED_H
#define DIVIDED_FOLLOWED_H

#include "systems.h"
#include "variant.h"

enum { SECONDS = 6, PARTS = 2, SAMPLES = SECONDS * PARTS, ROOM = 400 };

struct truth {
	real y[SAMPLES + 1][MOST_OF_STATES], crossed[ROOM];
	int count;
	double most;
};

struct found {
	double error, time;                 /* largest of a state, over the largest state; of a crossing's time */
	int count, status;
};

struct truth truth_of(const struct switched_system *s);
/* Over all samples; count -1: those that were listed are not as many as were counted */
struct found follow(const struct variant *v, const struct switched_system *s, const struct truth *truth);
/* NULL: there is none in the table */
const struct variant *variant_in(const struct variant *table, const char *name);

#endif
