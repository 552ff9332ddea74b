/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A number of a step before it is rounded. Of numbers.c and coefficients.c. */
#ifndef PLGEN_NUMBERS_H
#define PLGEN_NUMBERS_H

#include "base/base.h"

struct coefficient;
struct model;

enum { FIRST_PRECISION = 128 };     /* doubled while a number is not decided */

/* Sums of responses at a time, or combinations of entries of e^{A tau} */
struct entry {                      /* weight e^{A tau}[row][column] */
	struct taylor *taylor;
	int column;
	mpq_t weight;
};
struct number {
	int count;
	const struct started *list; /* responses, each from its own start to t */
	mpq_srcptr t;
	const struct entry *entry;  /* or, if not NULL, entries of one row */
	int row;
	mpq_srcptr scale;           /* of the sum, then */
	mpq_srcptr less;            /* is subtracted; NULL: 1 and 0 */
};

/* In so many bits; false: that is beyond the method's limits */
bool enclose_number(const struct number *n, int precision, mpfi_ptr sum);
/* Once, correctly, and in two words where wanted; false: not decided, *isolated says whether the poles were */
bool round_number(const struct number *n, bool two_words, int limit, struct coefficient *c, bool *isolated);

_Noreturn void undecided(struct place at, const char *what, bool isolated);
/* Refuses what is beyond the range of the target, with the pole that it comes from. list: responses, `count` of them */
void check_range(const struct model *model, const struct coefficient *c, int count, const struct started *list,
		 const char *what);

#endif
