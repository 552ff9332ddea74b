/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Random expressions as trees, whose values MPFR has directly, and as the forms that are made of them: trees.c. */
#ifndef TREES_H
#define TREES_H

#include "draw.h"
#include "tape/tape.h"

#include <math.h>
#include <string.h>

enum { CASES = 600, COORDS = 2, LEAVES = 2 * COORDS + 1, MOST = 7, BITS = 500 };

enum kind { NUMBER, TIME, WAVE, STATE, SUM, DIFFERENCE, PRODUCT, QUOTIENT, POWER, RAISED, CALL, CHOICE };

struct tree {
	enum kind kind;
	mpq_t number;               /* NUMBER; of WAVE its frequency */
	int index, order;           /* STATE */
	unsigned exponent;          /* POWER */
	enum function function;     /* CALL */
	enum comparison comparison; /* CHOICE: x0 ? x1 then x2 else x3 */
	int children;
	struct tree *child[MOST];
};

struct at { mpq_t state[COORDS][2], t; };

/* What may fail for good reasons, as where a constant divides by 0 */
struct attempt {
	const struct tree *tree;
	struct form *form, **slope;
	int coord, order;
	struct point *point;
};

extern bool constants_only;         /* no state and no time in what is drawn */
extern struct collector collector;
extern struct frame frame;
extern struct node node;

struct tree *new_tree(enum kind kind, int children);
struct tree *number_tree(long value);
struct tree *draw_leaf(void);
struct tree *draw_tree(int depth);
const char *tree_text(const struct tree *tree);
void draw_point(struct at *at);
bool is_plain(mpfr_srcptr x);
void value_of(const struct tree *tree, const struct at *at, mpfr_ptr value);
void new_collector(void);
struct form *state_form(int index, int order);
struct form *form_of(const struct tree *tree);
void sampled(const struct form *form, struct at *at, mpfr_ptr value);
void make_form(void *context);
void make_slope(void *context);
void make_placed(void *context);
void assert_close(const char *what, int n, const struct tree *tree, mpfr_srcptr found, mpfr_srcptr expected, int bits);
void at_init(struct at *at);

#endif
