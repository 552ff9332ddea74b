/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dimensions of a spec that has units: what has no unit gets the one that its equations give it, and terms that differ
 * are reported.  A dimension is linear in those of names that are not known yet; each group of terms that have to be
 * alike is a linear equation over the rationals, which binds one of them. */
#ifndef PLGEN_COLLECT_DIMENSIONS_H
#define PLGEN_COLLECT_DIMENSIONS_H

#include "collect/collect.h"

enum { SECOND = 2 };                /* among the base units */

struct part { int variable; mpq_t factor; };
struct dimension {
	enum {
		NUMBERS,            /* of literals: takes any dimension where it is a term, none where it is a factor */
		SILENT,             /* of matrices without a unit: says nothing */
		GIVEN
	} kind;
	bool known;                 /* of a solution: nothing in it is free; it stays so */
	bool bare;                  /* t, or a function's value: with a literal factor it is NUMBERS */
	int parts;
	struct part *part;          /* of variables that are not bound */
	mpq_t *base;
};

struct term {
	const struct node *node;
	const char *text;           /* as it is shown; NULL: the node's */
	struct place at;
	struct dimension dimension;
};
struct group {                      /* terms of one dimension */
	const char *what;           /* the equation, the sum, ... */
	const void *statement;
	bool done, defines;         /* defines: of a name and its value */
	int depth, place;           /* how deep inside its statement; in the order of the text */
	int terms;
	struct term *term;
};
struct assertion { const struct node *node; struct dimension dimension; };
struct dimensions {
	const struct spec *spec;
	int variables;
	struct dimension *solution; /* [variable]; base NULL: it is free */
	int *first;                 /* [symbol number]: its variable, of a vector that of the first component */
	int groups;
	struct group *group;
	int assertions;
	struct assertion *assertion;
	int depth;
	int statements;
	const void **failed;        /* an error was reported of them */
	const void *statement;      /* that is looked at */
};

/* ---- dimension.c: dimensions as vectors, and those of expressions ---- */

struct dimension dimension_in(const mpq_t *base);                  /* NULL: of a plain number */
struct dimension dimension_without(int kind);
struct dimension dimension_of_time(void);
struct dimension dimension_difference(const struct dimensions *w, const struct dimension *a, const struct dimension *b);
/* with what is bound put in */
struct dimension dimension_resolved(const struct dimensions *w, const struct dimension *d);
/* d += factor * other, with what is bound put in */
void add_dimension(const struct dimensions *w, struct dimension *d, const struct dimension *other, mpq_srcptr factor);
bool is_number_dimension(const struct dimension *d);
int  count_variables(const struct symbol *s);
struct dimension of_variable(int variable);
struct dimension of_symbol(const struct dimensions *w, const struct symbol *s, int component);
struct dimension of_name(const struct dimensions *w, const struct node *node);
int  new_group(struct dimensions *w, const char *what);     /* its index */
void add_term(struct group *group, const struct node *node, const char *text, struct place at,
	      struct dimension dimension);
void add_terms(struct dimensions *w, int group, const struct node *node); /* of a sum, those of brackets in it too */
void need_number(struct dimensions *w, const char *what, const struct node *node, struct dimension d);
struct dimension dimension_of(struct dimensions *w, const struct node *node);
const struct energy *first_energy(const struct dimensions *w);     /* T, V or D, the first; NULL: there is none */
struct dimension of_written_energy(struct dimensions *w);          /* of energy, as that one says */
struct dimension of_element(struct dimensions *w, const struct element *e); /* its force, by where it acts */
struct dimension of_energies(struct dimensions *w);                /* of energy, as that one or an element says */

#endif
