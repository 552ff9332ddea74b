/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sequences of Taylor coefficients, each made from those before it. */
#ifndef PLGEN_STEP_SEQUENCES_H
#define PLGEN_STEP_SEQUENCES_H

#include "step/step.h"

/* ---- sequences of Taylor coefficients, each made from those before it ---- */

/* Of a quantity a(t) the k-th number is D^k a^(k)/k!, D = h. What stands in a sum at k is factor[k] times: the constant
 * 1, a power of t, an entry of a load's states, an input's value at the start or its slope, the k-th number of another
 * sequence, or sum over j = 0..k of a_j b_{k-j} (Moore; Griewank and Walther 2008, chapter 13). */
enum term_kind { TERM_TIME, TERM_LOAD, TERM_INPUT, TERM_SLOPE, TERM_PARAM, TERM_SEQUENCE, TERM_PRODUCT };
struct sequence_term {
	enum term_kind kind;
	int a, b;                   /* which; the power of t; the load's column; the two sequences */
	double *factor;             /* per k */
	/* of a load that changes its formula: its place in the table of factors; -1: factor[] holds in all segments */
	int slot;
};
enum sequence_kind {
	SEQUENCE_SUM,               /* c_k = sum at k */
	SEQUENCE_INTEGRAL,          /* c_0 = function of a_0, or a state; c_{k+1} = sum at k, 1/(k+1) in its factors */
	SEQUENCE_QUOTIENT,          /* c = a/b; a NONE: 1/b */
	SEQUENCE_ROOT,              /* c^2 = a */
	SEQUENCE_POWER,             /* c = a^exponent, which is constant */
	SEQUENCE_RATE,              /* c_k = (k+1) a_{k+1}, of what shifts over the unit of time */
	SEQUENCE_CHOICE,            /* a where the condition holds, else b */
	SEQUENCE_SOLUTION           /* one component of x, of equations that are linear in it */
};
/* By which a choice is made: two forms linear in t that are compared, a switching function of the state above a
 * breakpoint, or another sequence that is not 0 and changes with such choices alone */
/* or whether a switching function is held between two breakpoints, this and its twin */
enum choice_kind { CHOICE_BY_TIME, CHOICE_BY_STATE, CHOICE_BY_HOLD, CHOICE_BY_SEQUENCE };
/* M x = f, each entry a sequence, NONE where it is 0. At k >= 1 they are read off the residuals F = M x - f, as these
 * are written: with the k-th of x set to 0 F has the k-th -M_0 x_k. */
struct linear_equations {
	int n, number;              /* rows; which of the expansion's */
	int *matrix, *right, *residual, first; /* first: x_0, which the other components follow */
};
struct sequence {
	enum sequence_kind kind;
	const struct linear_equations *equations;
	int component;
	int state;                  /* of an integral that is one; NONE */
	enum function function;     /* of another: its value from a (and b) */
	int a, b;
	double exponent;
	enum choice_kind choice;
	const struct form *left, *right; /* what the condition compares, linear in t */
	enum comparison comparison;
	/* or which it is above; of the switching function's, in order of their first appearance */
	int switching, breakpoint;
	int test;                   /* or the sequence */
	int terms;
	struct sequence_term *term;
	int top;                    /* the last that something reads and that is not 0; -1: none is read */
	bool known;                 /* it depends on time and inputs alone */
	bool solved;                /* its k-th depends on the k-th of a solution */
	bool behind;                /* its k-th depends on the (k+1)-th of a solution: a rate, what is made of one */
	bool shifts;                /* a rate of what is ahead, of which a solution is made */
	bool ahead;                 /* such a rate reads it: its (k+1)-th depends on the k-th of a solution */
	/* The k-th, of an integral the (k+1)-th, is for k >= 1 an early part + sum over these of factors times their
	 * k-th */
	int gains;                  /* 0: not made so */
	int *gain;
	bool split;                 /* others read its early part and gains */
};

/* ---- sums.c: what is added up exactly, and its factors as numbers ---- */

struct key {                        /* of a sum, before its factors are numbers; kind, a and b as in sequence_term */
	enum term_kind kind;
	int a, b;
	mpq_t factor;
};
struct sum {
	int keys;
	struct key *key;
};
struct sequencing {                 /* what the makers of sequences share */
	const struct step *step;
	const struct linear *system;
	struct expansion *x;
	struct layout layout;       /* states, loads, inputs, force columns */
	mpq_t **slopes;             /* per segment: x' = slopes x */
	mpq_t pi;
	mpq_t unit;                 /* of time: D, h or several of them */
	int *uses;                  /* per atom */
	int *atom;                  /* per atom: its sequence; NONE: not made yet */
	bool solving;               /* residuals are made */
	int shared;                 /* sums that are shifted, of which others are made */
	struct { struct sum sum; int sequence; } *share;
	int solutions;
	struct { const struct atom *atom; int first; } *solution;
	int *highest;               /* per coordinate: the solution that its highest derivative is; NONE */
	int operands;               /* forms that are no single atom, each made once */
	struct { const struct form *form; int sequence; } *operand;
};
void sum_add(struct sum *sum, enum term_kind kind, int a, int b, mpq_srcptr factor);
mpq_t *plain_scale(const struct sequencing *w);             /* 1 */
/* of a state, whose force changes from segment to segment: in a table */
void add_changing_loads(struct sequencing *w, struct sequence *s, int state, const mpq_t *scale);

int  new_sequence(struct sequencing *w, struct sequence sequence);
int  sum_sequence(struct sequencing *w, const struct sum *sum);
int  minus_sequence(struct sequencing *w, int a);

/* ---- sequences.c: forms to sums, atoms to recurrences ---- */

int  sequence_of_sum(struct sequencing *w, struct sum *sum);  /* of a single one itself */
int  sequence_of_form(struct sequencing *w, const struct form *form);
int  positive_sequence(struct sequencing *w, const struct form *form, int a);  /* or else 0: the state chooses */
/* sum += scale form; leaves the statement at what has no series */
void sum_add_form(struct sequencing *w, struct sum *sum, const struct form *form, mpq_srcptr scale);

#endif
