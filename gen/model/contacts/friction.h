/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Dry friction in regions, with mass and without. */
#ifndef PLGEN_MODEL_FRICTION_H
#define PLGEN_MODEL_FRICTION_H

#include "contacts.h"
#include "model/model.h"

/* ---- force_sign.c: whether a friction force may fall below 0 ---- */

/* At 0 or above, at 0 or below, from `from` to `to` (NULL: for good), as far as that is seen of what time alone
 * moves */
bool stays_above_zero(const struct form *force, mpq_srcptr from, mpq_srcptr to);
bool never_falls_below(const struct form *force);           /* below 0, from t = 0 on, as far as it is seen */
/* that it is above 0 at some time between; `node`: where it stands */
void check_force(const struct node *node, const struct form *force, mpq_srcptr from, mpq_srcptr to);
_Noreturn void report_drives(const struct node *friction);  /* its force has the wrong sign */
_Noreturn void report_unheld(struct place at);              /* its force does not reach its own velocity */

/* ---- friction.c: dry friction in regions, where it slips and where it sticks ---- */

bool holds_friction(const struct building *b);              /* somewhere in the equations */
const struct atom *friction_in(const struct form *form, bool *seen); /* NULL: there is none */
_Noreturn void report_no_friction(const struct building *b); /* why a scheme cannot treat it */
/* What is held exceeds the force of what slides by this, where the velocity is 0 */
struct form *less_in_velocity(const struct form *rest, const struct form *force, const struct form *velocity);
int  input_hold(const struct building *b, int index);      /* the degree of what goes through its samples */
struct form *rate_of_form(struct building *b, const struct form *form); /* its derivative with respect to time */
int  stick_of(const struct switching *s, const struct friction *f); /* the interval in which it sticks */
/* puts in the forces of what slips, and the constraints of what sticks */
/* its index; -1: no equation has it in this segment of time */
int  friction_of(const struct switching *s, int segment, const struct atom *a);
int  transmitted_of(const struct switching *s, const struct atom *a); /* among those that outputs read */
bool is_repeated(const struct switching *s, int friction);  /* as written it stands there for an earlier segment too */
void resolve_friction(struct building *b, struct switching *s);
void build_friction(struct building *b, struct switching *s); /* rows of holds and releases; after all systems */
struct holding {                    /* states of a region that follow from the others, as they are found */
	const struct building *b;
	struct region *region;
	struct basis *of;
};

/* ---- slider.c: friction of what has no mass ---- */

/* Whether friction stands in the form whose velocity is of a coordinate of first order: this one; -1: any */
bool has_slider(const struct building *b, const struct form *form, int coord);
/* its equation gives the force that it bears */
void resolve_sliders(struct building *b, struct segment_equations *segment_equations);
/* Whether a guard of its own stands where the interval of a switching function ends: what lets go a slider without mass
 * */
bool is_released(const struct region *region, int function, bool upward);
struct form *borne_form(const struct building *b, const struct form *form); /* of an output: transmitted forces */
bool is_repeated_slider(const struct switching *s, int index);      /* it stands there for an earlier segment too */
/* Where it slides: as many as its force differs in regions */
int slides_of(const struct switching *s, int index, const struct slide ***slide);
const char *slider_text(const struct switching *s, int index);      /* the same for a reader */

#endif
