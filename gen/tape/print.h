/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What print.c, roll.c and text.c have from one another, and nobody else. */
#ifndef PLGEN_TAPE_PRINT_H
#define PLGEN_TAPE_PRINT_H

#include "tape/tape.h"

/* What the place of a text binds by: a choice stands in brackets everywhere */
enum level { CHOICE, COMPARISON, SUM, PRODUCT, PRIMARY };

struct printing {
	const struct tape *t;
	const struct tape_target *to;
	FILE *out;
	int *uses, parts;           /* locals so far that have no name of their own */
	int indent;
	const char **local;         /* per node: what holds it; NULL: nothing yet */
	bool *wide;                 /* per node: is it lanes? NULL: none is */
	struct roll *roll;          /* NULL: there are straight lines alone */
	/* In the place of an operand or a local; NULL: it is neither. While this is set no local is made. */
	const char *(*leaf)(struct printing *p, tape_ref ref);
};

/* ---- text.c ---- */

const char *tape_text(struct printing *p, tape_ref ref, enum level level, int indent);
const char *tape_bare_text(struct printing *p, tape_ref ref, int indent);       /* no local for itself */
const char *tape_widened(const struct printing *p, tape_ref ref, const char *text);     /* lanes, where others are */
void tape_set_text(const struct printing *p, const struct tape_out *set, const char *text);

/* ---- roll.c: a long run of statements as loops ---- */

/* NULL: no run is long; else what the loops need is declared. */
struct roll *roll_new(struct printing *p);
/* The outs from this one up to the next line of C, whose place it returns; TAPE_NONE: that run is not long. */
int roll_run(struct printing *p, int out);

/* ---- loops.c: statements of it ---- */

#define VALUES_PLACE "values_by_0[%d]"
enum { PLACES = 4 };
/* An operand or a value where a statement reads it, or what it sets: a pattern with # for each number in brackets; of a
 * constant "#", and its text */
struct leaf { const char *pattern, *number; int place[PLACES]; };

struct statement {
	const char *shape;          /* C, leaf k as @k. */
	int leaves;
	struct leaf *leaf;          /* the first is what it sets: */
	tape_ref value;             /* TAPE_NONE: out `out` */
	int out;
};


struct group { int count; const struct statement **member; };   /* all of one shape */
struct blocks {                     /* not printed yet */
	int count;
	struct block *block;
	int places;                 /* of values so far */
	const bool *far;            /* per node: another run reads it */
};
/* They set and read what those that were added before set; the list is emptied. */
void loops_add(struct printing *p, struct blocks *all, struct group *g);
void loops_print(struct printing *p, struct blocks *all);

#endif
