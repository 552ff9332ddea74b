/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of step/linear have from one another, and nobody else. */
#ifndef PLGEN_STEP_LINEAR_INNER_H
#define PLGEN_STEP_LINEAR_INNER_H

#include "forms.h"
#include "images.h"

/* ---- refresh.c: functions of loads every so many steps, tables between ---- */

void leave_out_refresh(struct step *step, const char *why);

/* ---- stepform.c: a linear step as direct, delta or kick-drift-kick ---- */

/* The step is built again in another form; where forms are tried in turn, this one is refused. */
_Noreturn void leave_form(struct step *step, const char *why);

/* ---- large.c: a large step by its independent blocks ---- */

void find_groups(struct program *program, const struct step *step);     /* and what they cost */

/* ---- modal.c: a step of modes instead of states ---- */

struct modal *modal_of(const struct step *step);             /* NULL: a number is not decided */

/* ---- resolvent.c ---- */

struct spectrum *resolvent_spectrum(const struct resolvent *r);                /* of B(s) */

/* ---- numbers.c: a number of a step before it is rounded ---- */

struct coefficient;

enum { FIRST_PRECISION = 128 };     /* doubled while a number is not decided */

/* A sum of entries of e^{A tau}, each with its weight */
struct entry { struct taylor *taylor; struct taylor_place place; };
struct number {
	int count;
	const struct entry *entry;
	mpq_srcptr scale;           /* of the sum, then */
	mpq_srcptr less;            /* is subtracted; NULL: 1 and 0 */
};

/* In so many bits; false: that is beyond the method's limits */
bool enclose_number(const struct number *n, int precision, mpfi_ptr sum);
/* Once, correctly, and in two words where wanted; false: not decided */
bool round_number(const struct number *n, bool two_words, struct coefficient *c);

_Noreturn void undecided(struct place at, const char *what);
/* Refuses what is beyond the range of the target, with the pole that it comes from */
void check_range(const struct model *model, const struct coefficient *c, const struct resolvent *resolvent,
		 const char *what);
#endif
