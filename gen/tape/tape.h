/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Straight-line programs, as of automatic differentiation (Griewank and Walther, Evaluating Derivatives, 2008): a list
 * of nodes in the order of their evaluation, each made once, that read nodes before them. Forms become tapes; tapes
 * are printed as C, run, counted and differentiated. */
#ifndef PLGEN_TAPE_H
#define PLGEN_TAPE_H

#include "collect/collect.h"

/* ---- tape.c: nodes ---- */

enum tape_op {
	/* Operands, which read nothing: what they are called is the reader's matter (struct tape_target) */
	TAPE_CONSTANT,              /* an exact number */
	TAPE_COORD, TAPE_INPUT,     /* coordinate or input `index`, differentiated `part` times */
	TAPE_STATE,                 /* `index`, as the step keeps it */
	TAPE_SAMPLE,                /* column `index` of the inputs' samples that a step reads */
	TAPE_LOAD,                  /* column `part` of load `index` */
	TAPE_PARAM,                 /* tunable param `index` */
	TAPE_TIME,                  /* t; `part` 1: the time at which conditions on time hold as they do */
	TAPE_TABLE,                 /* entry `index` of table `part` of the reader's */
	TAPE_FRICTION,              /* a friction force of the model */
	TAPE_ABOVE,                 /* a choice: switching function `index` is above its breakpoint of rank `part` */
	TAPE_HELD,                  /* a choice: switching function `index` is held in interval `part` */
	TAPE_TRUE, TAPE_FALSE,      /* choices */
	/* of a */
	TAPE_NEG, TAPE_SIGN, TAPE_SIZE, TAPE_CALL, /* -a; -1, 0 or 1; |a|; function `index` of a */
	TAPE_NOT,                   /* a choice, of a choice */
	/* of a and b */
	TAPE_ADD, TAPE_MUL, TAPE_DIV, TAPE_POWER, TAPE_ATAN2,
	TAPE_LESS, TAPE_AT_MOST, TAPE_EQUAL, TAPE_UNEQUAL, /* choices */
	TAPE_SELECT,                /* a ? b : c; b and c are of one type */
	TAPE_ACCUMULATE,            /* a + b + c, c far below b; what rounding takes is kept, `index` of `part` */
	TAPE_OPS
};
typedef int tape_ref;               /* place of a node */
enum { TAPE_NONE = -1 };
struct tape_node {
	enum tape_op op;
	bool choice;                /* its type: a condition, else a number */
	int index, part;
	tape_ref a, b, c;           /* before this node, or TAPE_NONE */
	mpq_srcptr value;           /* of TAPE_CONSTANT */
	const char *name;           /* of the local that holds it; NULL: it needs none */
};
struct tape_out {                   /* target = node; printed in this order */
	const char *target;         /* NULL: `note` is a line of C, which may open or close a block */
	const char *note;           /* NULL: no comment behind it */
	tape_ref ref;
	bool local;                 /* the target is a local of that name, which may be the node's own */
	int indent;                 /* of the lines that a long sum goes on in */
};
struct tape;
struct tape *tape_new(void);
int  tape_length(const struct tape *t);
const struct tape_node *tape_node(const struct tape *t, tape_ref ref);
int  tape_outs(const struct tape *t);
const struct tape_out *tape_out(const struct tape *t, int out);
/* Each is the node that was made alike before, where there is one. */
tape_ref tape_constant(struct tape *t, mpq_srcptr value);
tape_ref tape_number(struct tape *t, long value);
tape_ref tape_double(struct tape *t, double value);
tape_ref tape_pi(struct tape *t);
tape_ref tape_operand(struct tape *t, enum tape_op kind, int index, int part);
tape_ref tape_unary(struct tape *t, enum tape_op op, tape_ref a);
tape_ref tape_call(struct tape *t, enum function function, tape_ref a);
/* a product with 1 is its other factor */
tape_ref tape_binary(struct tape *t, enum tape_op op, tape_ref a, tape_ref b);
tape_ref tape_compare(struct tape *t, enum comparison comparison, tape_ref a, tape_ref b);
tape_ref tape_select(struct tape *t, tape_ref condition, tape_ref a, tape_ref b);
tape_ref tape_accumulate(struct tape *t, tape_ref a, tape_ref b, tape_ref c, int index, int part);
/* factor times ref, from the left to the right; 1 and -1 take no multiplication; ref TAPE_NONE: none */
tape_ref tape_scaled(struct tape *t, double factor, tape_ref ref);
/* (a + b) + (c + d): the shortest chain of dependent additions; of no terms 0 */
tape_ref tape_sum(struct tape *t, int terms, const tape_ref *term);
tape_ref tape_power(struct tape *t, tape_ref a, unsigned n); /* a^n, n >= 1, with few multiplications */
/* before times each factor of a product that has no name, from the left to the right */
tape_ref tape_times_each(struct tape *t, tape_ref before, tape_ref product);
tape_ref tape_power_of_time(struct tape *t, int power);      /* t^power; of 0 TAPE_NONE */
/* y + slope (x - x0) of the piece that x is on: below[p], is it below the end of piece p? */
tape_ref tape_table(struct tape *t, tape_ref x, int pieces, const struct straight *piece, const tape_ref *below);
void tape_name(struct tape *t, tape_ref ref, const char *name); /* unless it is a constant or has one */
void tape_set(struct tape *t, const char *target, tape_ref ref, int indent, const char *note);
void tape_set_local(struct tape *t, const char *name, tape_ref ref);
void tape_statement(struct tape *t, const char *line);     /* between what is set; not where locals are first */
bool tape_is_operand(const struct tape *t, tape_ref ref);
/* The first invariant that is broken: operands before their reader, as many as it has, of the types that it reads;
 * no two nodes alike; NULL: none is. Every pass leaves it NULL. */
const char *tape_check(const struct tape *t);
/* Conditions, changes of sign and multiples by a number are made anew where they are read, and no locals of their own;
 * what they read counts as often as they do. */
bool tape_is_cheap(const struct tape *t, tape_ref ref);
/* How often each node is read, by live nodes and outs; 0: it is dead */
int *tape_uses(const struct tape *t);
/* Does what is set read such an operand? index, part: any where negative */
bool tape_reads(const struct tape *t, enum tape_op kind, int index, int part);
/* flag[index] = true of each operand of this kind and part that is read */
void tape_mark(const struct tape *t, enum tape_op kind, int part, bool *flag);
struct tape_cost { int multiplications, divisions, additions, calls, accumulations; };
/* Of what is set, each node once, or as often as it is made anew; negations cost nothing */
struct tape_cost tape_cost(const struct tape *t);

/* ---- forms.c: forms as nodes ---- */

struct tape_let { const char *name; const struct form *form; };
struct tape_forms;
/* What a basis is that is no constant and no atom, an operand or a product of some; where an event-driven step chooses
 * formulas, the choice whether left is above right (NULL: their numbers decide); a friction force; do conditions on
 * time alone hold as they do at another time, TAPE_TIME of `part` 1? */
struct tape_reader {
	tape_ref (*leaf)(struct tape *t, const void *context, const struct basis *basis);
	tape_ref (*above)(struct tape_forms *f, const void *context, const struct form *left, const struct form *right);
	tape_ref (*friction)(struct tape *t, const void *context, const struct atom *atom);
	const void *context;
	bool timed;
	bool nominal;               /* tunable params are constants, of the spec's values */
};
/* Forms are counted first: what several terms read is kept apart from their factors. A let's value has its name. */
struct tape_forms *tape_forms_new(struct tape *t, struct tape_reader reader, int count,
				  const struct form *const *form, int lets, const struct tape_let *let);
void tape_count_form(struct tape_forms *f, const struct form *form); /* one more */
struct tape *tape_of_forms(const struct tape_forms *f);
tape_ref tape_form(struct tape_forms *f, const struct form *form);
tape_ref tape_forcing(struct tape *t, const struct basis *basis); /* t^k e^{a t} cos(w t + p), or sin */
tape_ref tape_term(struct tape_forms *f, const struct form_term *term);
/* Of numbers and t: at the time at which conditions on time hold as they do */
tape_ref tape_form_in_time(struct tape *t, const struct form *form);
/* Is `condition` met? As an atom, or where its number is not 0 */
tape_ref tape_condition(struct tape_forms *f, const struct form *condition);
void tape_name_lets(struct tape_forms *f);      /* once all forms are in */

/* More equations than this are solved by lists of the columns in which their factors are not 0. */
enum { LISTED_EQUATIONS = 12 };
/* Of one matrix M, symmetric or not: as many right sides as are known at once. In C matrix_by_M, and solved_by_NUMBER,
 * [n][rights], TAPE_TABLE of `part` `number` more than the reader's */
struct tape_system { int number, matrix, n, rights; bool symmetric, factored; const struct form *const *M; };
struct tape_solver {
	const char *(*solve)(const void *context, const struct tape_system *system); /* the C, once all is set */
	const void *context;
	int table;
};
/* Solutions of many equations in these forms, of those that were counted: from here on they are operands. */
void tape_solve_by_lists(struct tape_forms *f, int count, const struct form *const *form,
			 const struct tape_solver *solver);

/* ---- solve.c: linear equations ---- */

/* n x n, where entries or those across the diagonal are not 0, becomes where the factors are not; first[n + 1]: where
 * the columns before row i begin in the list that is returned */
int *factor_columns(int n, bool *filled, int *first);

struct tape_factors;
/* Of M, n x n, row by row; TAPE_NONE: the entry is 0 for all states. Rows are eliminated in their order. */
struct tape_factors *tape_factors_new(struct tape *t, int n, const tape_ref *M);
void tape_solve(const struct tape_factors *f, const tape_ref *right, tape_ref *x);

/* ---- nodes.c: expressions as they are written ---- */

/* Operands: TAPE_COORD and TAPE_INPUT by the place of a component, TAPE_PARAM by the symbol's number, TAPE_TIME. A
 * highest derivative is one too if `highest`, else it counts as 0. */
struct tape_expressions;
struct tape_expressions *tape_expressions_new(struct tape *t, int symbols, bool highest,
					      const char *(*let_name)(const void *context, const struct symbol *let),
					      const void *context);
tape_ref tape_expression(struct tape_expressions *x, const struct node *node);

/* ---- print.c: a tape as C ---- */

/* Lanes: vectors of numbers of instances side by side, where what is read of each is its own. Numbers that all share
 * are widened only where they are set, or accumulated. */
struct tape_lanes {
	const char *type, *widen;   /* the function that makes lanes of a number */
	const char *function;       /* before the name of a function of lanes that is one of <math.h> of each */
	bool (*varies)(const void *context, const struct tape_node *node); /* an operand */
};
/* Statements: gcc takes seconds for a few thousand straight lines; of like elements side by side */
enum { LONG_RUN = 1500, RUN_ALIKE = 16 };
struct tape_target {
	const char *real;           /* the type of a number */
	const char *(*number)(const void *context, mpq_srcptr value); /* NULL: rounded, as short as reads back */
	const char *(*operand)(const void *context, const struct tape_node *node);
	const char *size;           /* the function that TAPE_SIZE is, */
	const char *accumulate;     /* and TAPE_ACCUMULATE: of a, b, c, and the address of the place, an operand */
	const void *context;
	int indent;
	bool locals_first;          /* before the first target is set, which what they read may be part of */
	/* So many statements with no line between them are loops over tables, 0: never; none reads what others set. */
	int rolls;
	/* Above 0, as many as lanes have at most: a loop over k of like elements, which <lanes.h> is there for. Only
	 * TAPE_TABLE of `part` below 0 changes in it. */
	int across;
	const struct tape_lanes *lanes; /* NULL: there are none */
	bool rows_alike;            /* negative factors are added: rows that differ in numbers alone go side by side */
};
/* Locals for what is read more than once or has a name, outs in their order */
void tape_print(const struct tape *t, const struct tape_target *to, FILE *out);

/* ---- run.c: its numbers ---- */

struct tape_values {                /* what operands are; NULL where the tape has none of that kind */
	void (*operand)(const void *context, const struct tape_node *node, mpfr_ptr value);
	const void *context;
};
/* value: one a node. Where a condition is undefined so is what it chooses; only what is chosen has to be defined. */
void tape_run_mpfr(const struct tape *t, const struct tape_values *from, mpfr_t *value);

/* of one node, once what it reads has its value */
void tape_node_mpfr(const struct tape_node *n, const struct tape_values *from, mpfr_t *value, mpfr_ptr result);

/* ---- sample.c: forms as numbers at points ---- */

struct sample;                      /* `leaf` says what a coordinate or an input is there */
struct sample *sample_new(int precision, void (*leaf)(void *context, const struct basis *basis, mpfr_ptr value),
			  void *context);
long sample_work(const struct sample *sample);             /* products and calls so far */
void sample_at(struct sample *sample, mpfr_srcptr t);       /* a new point: what was found at the last is forgotten */
/* NaN where it is not defined. A form stays as it is once it was asked for. */
void sample_form(struct sample *sample, const struct form *form, mpfr_ptr value);

/* ---- slopes.c: derivatives, as further nodes ---- */

/* d ref / d that operand; 0 where it is not read. Of SIGN and of conditions they are 0. */
tape_ref tape_forward(struct tape *t, tape_ref ref, enum tape_op kind, int index, int part);
/* ... with respect to all operands of this kind, by one sweep backwards: slope[index] */
void tape_reverse(struct tape *t, tape_ref ref, enum tape_op kind, int count, tape_ref *slope);

#endif
