/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a scheme steps with, as a program over tables. */
#ifndef PLGEN_STEP_PROGRAM_H
#define PLGEN_STEP_PROGRAM_H

#include "model/model.h"

struct coefficient;
struct recipe;
struct step;

/* ---- program.c: what a scheme steps with, as a program over tables ---- */

enum operand_kind { OPERAND_STATE, OPERAND_LOAD, OPERAND_INPUT };
struct operand {
	enum operand_kind kind;
	int index;                  /* state; or column of the loads, of the inputs */
};
struct product {
	const struct coefficient *factor; /* of a load: in the first segment of time */
	struct operand operand;
};
struct assignment {                 /* target <- sum of products */
	int target;                 /* state */
	bool added;                 /* target <- target + sum of products */
	bool carried;               /* with what rounding takes kept in carry */
	int terms;
	struct product *term;
};
/* Of a step that loops: independent blocks that are stepped in one way */
enum group_kind {
	GROUP_ROWS,                 /* one small block: its assignments */
	GROUP_ALIKE,                /* small ones of one shape, each with factors of its own: one loop over them */
	GROUP_COLUMNS               /* one block: a matrix by its columns */
};
struct group {
	enum group_kind kind;
	int states, blocks;         /* states of a block; how many blocks there are */
	int *state;                 /* [states][blocks]: which it is */
	int loads, *load;           /* columns of loads that act on it, */
	int inputs, *input;         /* and of inputs */
	bool tuned;                 /* tunable params touch its factors: the instance has them */
};
/* A step of a scheme with a remainder is a list of actions on vectors: stages are states (0: the state
 * itself), lefts are remainders. */
enum { STAGE_STATE = 0, NONE = -1, SUM_PHI_WEIGHTS = 4 };
struct action {
	enum { ACTION_REMAINDER, ACTION_COMBINE, ACTION_SUM, ACTION_PREDICT } kind;
	int target;                 /* REMAINDER, COMBINE: a left; SUM, PREDICT: a stage */
	int node, from;             /* REMAINDER: when, and of which stage; PREDICT: when it ends */
	int half;                   /* PREDICT: the node in the middle */
	int plus, minus;            /* COMBINE: lefts; minus NONE: twice `plus`; `added` adds instead */
	bool added;
	int flow;                   /* SUM: table whose Phi, loads and inputs act on the state, or NONE */
	int plain;                  /* SUM: stage added as it is, or NONE */
	int phi_weights;            /* SUM: phi-function weight of table times left, added */
	struct { int table, phi_weight, left; } phi_weight[SUM_PHI_WEIGHTS];
	const char *note;           /* a = F y + q1 r0 */
};
struct program {
	int assignments;            /* of a scheme without remainder */
	struct assignment *assignment;
	/* each assignment reads what those before it have left; else all read the old state */
	bool in_order;
	bool compensated;           /* factors in two words, and what rounding takes from a state is kept */
	bool *reads;                /* per state: whether its old value is read */
	bool *uses;                 /* per column of the loads */
	/* for cos/sin pairs and exponentials: counted below too, or beside it what comes at each refresh */
	int forcing_multiplications, forcing_additions;
	int multiplications, additions, calls; /* calls: of the model's own functions */
	int peak_multiplications, peak_additions; /* beside them: the outputs, and that none passes its peak */
	bool loops;                 /* over tables: a large model */
	/* of a list that loops: how its assignments are done, by blocks */
	int groups;
	struct group *group;
	bool products_added;        /* to the state */
	bool tuned;                 /* factors are read from the instance's coefficients */
	int actions;                /* 0: assignments */
	struct action *action;
	int stages, lefts;          /* vectors, the state not counted */
	int nodes;                  /* times at which remainders are evaluated, as parts of h; the first is 0 */
	mpq_t *node;
	int *node_table;            /* per node: the table of loads and inputs that a predictor adds, or NONE */
	bool predicts;
};

/* ---- check.c: between those who write programs and those who read them ---- */

/* a violation is an internal error, and leaves the statement */
void program_check(const struct step *step);

/* ---- recipes.c: of each scheme ---- */

void write_recipe(struct recipe *r);

#endif
