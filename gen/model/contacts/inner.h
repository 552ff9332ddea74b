/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of model/contacts have from one another, and nobody else. */
#ifndef PLGEN_MODEL_CONTACTS_INNER_H
#define PLGEN_MODEL_CONTACTS_INNER_H

#include "friction.h"

/* ---- friction.c ---- */

_Noreturn void report_no_equation(const struct atom *friction); /* which has this friction of an output */

/* ---- holds.c: states of a region that follow from the others ---- */

const struct form *free_of_holds(const struct holding *h, const struct form *form);     /* without what is held */
void hold_state(struct holding *h, const struct form *v, int at);   /* v = 0, solved for the state of its term `at` */
/* The place among a form's terms of a state whose rate is a highest derivative, of a coordinate of first order where
 * that is asked for; -1: there is none */
int velocity_term(const struct building *b, const struct form *form, bool first_order);
void add_release(struct region *region, int function, bool upward, struct form *form);

/* ---- slider.c: friction of what has no mass ---- */

/* in a region: the equations of what slides, where that ends, and the places that follow from the force through it */
void slide_sliders(struct building *b, const struct switching *s, int region);
void hold_sliders(struct holding *h, const struct switching *s);
/* where it slides, of the slider that is written there; NULL: it sticks */
struct form *slide_velocity(const struct switching *s, const struct region *region, const struct node *node);

/* ---- moving.c: contacts of mechanisms ---- */

bool keeps_smooth(const struct building *b, const struct form *form); /* atoms that a stop may have: smooth ones */
/* The derivative of its guard in time; a velocity in that is an error */
struct form *speed_that_moves(struct building *b, const struct when *when, const struct form *guard);
/* a = ratio b + rest, rest constant; b has terms that are not */
bool is_along(struct building *b, const struct form *a, const struct form *along, mpq_ptr ratio, mpq_ptr rest);
void find_bounce_with_slopes(struct building *b, struct impact *impact); /* of a `when` */
struct form *rate_with_atoms(struct building *b, const struct form *form);
/* Whether what a stop of this guard does to velocities depends on the state */
bool contact_moves(const struct building *b, const struct form *guard);
_Noreturn void report_velocity(const struct building *b, const struct when *when, int coord); /* in a stop */
_Noreturn void report_no_mass(const struct building *b, struct place at, int coord); /* of what an impact moves */
void find_masses(struct building *b);                        /* model->contacts.mass */
void find_moving_impact(struct building *b, struct impact *impact);
void find_moving_drag(struct building *b, struct drag *drag); /* where it moves */

#endif
