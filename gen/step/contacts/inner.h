/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of step/contacts have from one another, and nobody else. */
#ifndef PLGEN_STEP_CONTACTS_INNER_H
#define PLGEN_STEP_CONTACTS_INNER_H

#include "series_contacts.h"

/* ---- forces.c: who holds, how each acts on the others, and the forces of those that hold together ---- */

struct moving_contact;

struct constraint {
	int impact, drag;           /* one of them NONE */
	int of, column;             /* it is the derivative of this one, by a column; NONE: of none */
	const struct moving_contact *moving; /* NULL: its factors are numbers */
	const struct form *velocity, *rate;
	const struct node *node;    /* of friction */
	/* per state: what its force, 1, adds to the slope; that of a contact presses off */
	struct entry *force_direction;
	struct entry *slope_direction; /* the same but for slopes that are solved for with it */
	struct entry *row;          /* per state: the factor of its slope in the rate, */
	double *sample;             /* and that as a number somewhere */
	struct entry *gives;        /* per force column: what its force, 1, adds */
	struct entry *delassus;     /* per constraint: what the force of that adds to the rate of the velocity here */
	bool solved;                /* its force is solved for, with the equations of a mechanism */
	int bare;                   /* sequences: the rate without any of these forces; with all where `solved`, */
	int slips, force;           /* the force while it slips, NONE: there is none; now */
	int group;
};
struct constraints {
	struct sequencing *w;
	int constraints, own;       /* own: those that are no derivatives come first */
	struct constraint *constraint;
	struct contacts *c;
	int none;                   /* a sequence: 0 */
};
void find_constraints(struct constraints *all);
int  bare_rate(struct sequencing *w, const struct constraint *h); /* without what holds: a sequence */
int  force_sequence(struct sequencing *w, const struct form *force, const struct form *of);
int  held_by(const struct constraints *all, int index);     /* what holds it: itself, or what it is the derivative of */
bool is_number_entry(const struct entry *e);
void sum_add_entry(struct sum *sum, int sequence, const struct entry *entry, mpq_srcptr factor);
int  entry_sequence(struct sequencing *w, const struct entry *entry);
int  quotient_by_entry(struct sequencing *w, int a, const struct entry *below);
struct entry *entries_new(int count);
bool is_zero_entry(const struct entry *e);
void set_entry(struct sequencing *w, const struct form *form, struct entry *entry);
void sum_add_product(struct sum *sum, int a, int b, mpq_srcptr factor);
/* entry += the products of `count` pairs */
void dot_entries(struct sequencing *w, int count, const struct entry *a, const struct entry *b, struct entry *entry);
int  bare_slope(struct sequencing *w, int state);           /* without what holds, once */
int  rate_state(const struct sequencing *w, const struct basis *basis); /* whose slope it is; NONE */

/* ---- group.c: forces of those that act on each other ---- */

struct place place_of(const struct constraints *all, int index);
int  own_of(const struct constraints *all, int members, const int *member);
void note_conflict(const struct constraints *all, int count, const int *which);
void note_conflicts(const struct constraints *all, int members, const int *member);
int  along_sliding(struct sequencing *w, const struct series_hold *hold, int force); /* with the velocity's sign */
int  hold_choice(struct sequencing *w, const struct series_hold *hold, int held, int other);
void solve_group(const struct constraints *all, int members, int *member);

/* ---- slopes.c: what is watched, and impacts with their derivatives ---- */

int  watch(struct sequencing *w, int sequence, bool full);   /* full: more than its value */
int  only_state(const struct sequencing *w, const struct constraint *h);
void assign_with_slopes(struct constraints *all, int hold, bool still);

#endif
