/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of constants.c have from one another: the numbers of the emitted C in their order, and specs. */
#ifndef CONSTANTS_H
#define CONSTANTS_H

#include <mpfr.h>
#include <stdbool.h>
#include <stdint.h>

void complain(const char *what);

/* ---- constants_read.c ---- */

struct list {
	int count, room;
	double *value;
	const char **what;
};

void append(struct list *list, double value, const char *what);
void numbers_of_step(const char *code, const char *name, bool single, struct list *list);
/* NAME_table[...]... = { ... }; */
void numbers_of_table(const char *code, const char *name, const char *table, bool single, struct list *list);

/* ---- constants_specs.c ---- */

/* Masses in a row, further springs between any two of them, some rows without a ground; masses equal or not; in some,
 * loads and inputs where masses are equal.  |pole| h is between 1e-6 and 2.4 by Gershgorin's bound. */
char *undamped_spec(uint64_t seed);

/* h such that an entry is just beyond the middle of two floats, closer to it than doubles are: T = (1/2 + 2^-25)(1 +
 * 2^-60) */
struct twice {
	const char *name, *equation;
	int (*angle)(mpfr_ptr, mpfr_srcptr, mpfr_rnd_t);    /* h from T */
	int times;
};
enum { TWICE = 7 };
extern const struct twice twice[TWICE];
char *twice_spec(const struct twice *t);

#endif
