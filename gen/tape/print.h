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

#endif
