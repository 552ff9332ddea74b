/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The solution as a Taylor series. */
#ifndef PLGEN_STEP_EXPANSION_H
#define PLGEN_STEP_EXPANSION_H

#include "sequences.h"
#include "step/step.h"
#include "tape/tape.h"

struct contacts;
struct series_switching;
struct unresolved;

struct expansion {
	int order;                  /* of the series in its unit of time, h or several of them */
	int count;                  /* sequences; the first are the states */
	struct sequence *sequence;
	int equations;              /* systems of linear equations that are solved for each k */
	int slots;                  /* factors that change from segment to segment: */
	double *changing;           /* [slot][segment][k] */
	bool *load;                 /* per load: read */
	bool *input, *slope;        /* per input: read */
	bool time, choices;         /* t is read; formulas are chosen by it */
	int functions;              /* what chooses formulas by the state: an event where one passes a breakpoint */
	struct series_switching *function;
	int kinks;                  /* of what equations are solved for by Newton's method */
	struct kink *kink;
	int columns, *column;       /* beside the states: sequences whose coefficients are kept for them, */
	int *column_top;            /* up to these */
	int measured;               /* the first of them: their last terms count as those of states do */
	int unresolved_functions;   /* what bounds how far a series serves beside its last terms */
	struct unresolved *unresolved;
	bool looks;                 /* at slopes further on */
	double crowded;             /* 1/s, of loads that may cancel the highest frequency */
	struct contacts *contacts;  /* NULL: there are none */
	/* per force column: the remainder, as a sequence; NULL: it stands in the states' sums */
	int *force, *held;          /* held: with what holds beside it */
	int *motion;                /* beside contacts, what outputs read of it; NULL: nothing */
	bool alone;                 /* the states' own coefficients are not wanted */
	struct lines *lines;        /* NULL: it is short, and straight code */
	int multiplications;        /* of one expansion, that of its end and of the loads with it */
};

/* ---- recurrences.c: the coefficients as nodes of a tape ---- */

/* Operands: TAPE_STATE, TAPE_LOAD, TAPE_INPUT, TAPE_PARAM, TAPE_TIME, TAPE_TABLE of slot `index` at the k
 * `part`; what the state chooses TAPE_ABOVE and TAPE_HELD. */
struct series_names {               /* of a sequence's nodes, x of x_3; NULL: they have none */
	const char *(*name)(const void *context, int sequence);
	const void *context;
	bool by_numbers;            /* the state chooses by its numbers, else by intervals */
	bool looped;                /* as a loop over k where the expansion is long */
	const char *turn;           /* C at the head of each turn of a loop with rows side by side; NULL: none */
	/* C that factors the matrix of a system, or solves it; NULL: there is none */
	const char *(*solver)(const void *context, const struct linear_equations *e, bool factors);
};
struct recurrences;
struct recurrences *recurrences_new(const struct step *step, const struct expansion *x, struct series_names names);
struct tape *tape_of_recurrences(const struct recurrences *r);
tape_ref recurrence_number(struct recurrences *r, int sequence, int k); /* 0 has a node too */
void recurrence_set(struct recurrences *r, const char *target, int sequence, int k); /* target: its k-th */
tape_ref recurrence_size(struct recurrences *r, int sequence);       /* of its first: the sum of its terms' sizes */
tape_ref recurrence_full_size(struct recurrences *r, int sequence); /* ... of the terms that those are summed from */

/* ---- lines.c: a long series as a loop over k ---- */

/* What the loop reads of its k, k + offset where it is a coefficient: */
enum stage_kind {
	STAGE_COEFFICIENT,          /* of a */
	STAGE_FACTOR,               /* of table a */
	STAGE_FORCE,                /* of loads that change their formula: slot a */
	STAGE_NUMBER,               /* k itself */
	STAGE_INNER,                /* a_1 b_{k-1} + ... + a_{k-1} b_1 */
	STAGE_SQUARE,               /* the same of a and a */
	STAGE_QUOTIENT,             /* the same of a, which is made of b by division */
	STAGE_POWER,                /* sum of (e (k-j) - j)/k a_{k-j} b_j, b is a^e */
	STAGE_SOLVED                /* component b of the solution of system a */
};
struct stage_value { enum stage_kind kind; int a, b, offset; double exponent; };
/* Sums of products of rows a and b, a + 1 and b + 1, ..., as of stage value `value` */
struct product_run { int a, b, offset, count, value; };
enum { STAGED = -1 };               /* TAPE_TABLE of this `part` is stage value `index` */
struct lines {
	int *offset;                /* per sequence: the loop at k makes its coefficient k + offset */
	int *row;                   /* per sequence: of the table of coefficients; NONE: only the loop reads it */
	int rows, width;            /* of that table */
	int last;                   /* k of the loop; the first is `first` */
	int first;
	int values;
	struct stage_value *value;
	int factors;
	double **factor;            /* [table][k], width numbers each */
	bool across;                /* the table is [k][row]: like elements side by side, */
	int runs, inners;           /* of which a turn begins with these sums */
	struct product_run *run;
	int *place;                 /* per value: which of them it is; NONE: it is made where it is read */
};
/* All rows of the table, and the loop: in C table_by_0[row][k], k_by_0, and matrix_by_N[], solved_by_N[] of equations
 * that are solved by lists */
void set_lines(struct recurrences *r, const struct expansion *x);
const char *stage_index(int offset);        /* C: k + offset */
const char *line_place(const struct lines *l, int sequence, const char *k);     /* C: the k-th of a row */
void find_runs(struct lines *l);            /* once all values are known */
bool is_listed(const struct linear_equations *e);
bool is_symmetric_system(const struct linear_equations *e);
int *system_columns(const struct linear_equations *e, int *first); /* as factor_columns */

/* ---- slope.c: the derivative of a state ---- */

struct sum slope_of_state(struct sequencing *w, int state);  /* without friction and contacts */

/* ---- expansion.c: the solution as a Taylor series ---- */

struct expansion *expansion_of(const struct step *step, int order);
/* the same with the remainder as sequences of their own; and some of its sequences alone, up to a lower order */
struct expansion *expansion_with_forces(const struct step *step, int order);
struct expansion *part_of_expansion(const struct step *step, const struct expansion *full, int order, int columns,
				    int *column);

struct expansion *motion_of_expansion(const struct step *step, const struct expansion *full);

/* ---- order.c: the order of a series ---- */

/* The one that was asked for, or that of the tolerance, or a lower one that is cheaper. Leaves step->expansion. */
int economical_order(struct step *step);
/* In h, of its scheme where all is smooth */
int order_of_step(const struct step *step);

/* ---- radius.c: how far a series reaches from the start ---- */

enum { EXPANSION_SERVES = 32 };     /* most steps that one expansion serves */
struct reach {                      /* estimates, at t = 0 from the initial values, inputs 0 */
	bool known, left_out;       /* every coefficient is finite; accelerations choose the formulas */
	double radius;              /* of convergence [s]; infinite: no singularity is seen */
	double served;              /* by tolerance: steps that one series serves, below 1 the part of one; else 0 */
};
struct reach reach_of_series(const struct step *step);

/* ---- unresolved.c: what coefficients at one time may not show ---- */

enum unresolved_kind {              /* what of the argument a series has to follow: */
	UNRESOLVED_RISE,            /* exp: how far it rises, */
	UNRESOLVED_SPREAD,          /* sinh, cosh: how far it goes off 0, */
	UNRESOLVED_TURN,            /* tanh: how near it comes to 0, */
	UNRESOLVED_TEETH,           /* high powers of sin and cos: how far it goes, */
	UNRESOLVED_ARC,             /* atan: likewise, */
	UNRESOLVED_DIVISOR          /* log, and what is divided by: by which factor it falls */
};
struct unresolved {
	const struct form *form;
	enum unresolved_kind kind;
	int power;                  /* of TEETH */
	int column;                 /* as of a switching function */
};

#endif
