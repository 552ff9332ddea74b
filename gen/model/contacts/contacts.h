/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Impacts and dry friction. */
#ifndef PLGEN_MODEL_CONTACTS_H
#define PLGEN_MODEL_CONTACTS_H

#include "model/regions/switching_functions.h"
#include "model/model.h"
#include "model/regions/regions.h"

struct moving_contact {             /* of a velocity: its direction or the mass matrix depends on the state */
	const struct form **gradient; /* per coordinate: factor of its velocity in it */
	const struct form **force;  /* per coordinate: what 1 of its force adds to the left side of its equation */
	const struct form **force_direction;  /* per coordinate: what 1 takes from the highest derivative */
	const struct form *rest;    /* its rate where highest derivatives are 0 */
	int only;                   /* the coordinate whose velocity alone moves it; -1: there are several */
	double *sample;             /* the gradient somewhere: by that it is seen which depend on each other */
};
struct jump {                       /* a state just behind an impact, over states, loads and inputs before it */
	int state;
	struct form *form;
	struct output *row;
};
struct impact_law {                 /* what an impact is in one segment of time */
	struct form *guard, *speed; /* turned so that it rises where it comes true, through 0; its derivative */
	struct form *press;         /* of a bounce: that of the speed; it may have highest derivatives */
	int jumps;
	struct jump *jump;
	mpq_t restitution;          /* of a bounce: e */
	mpq_t gap;                  /* of a stop, as a number */
	mpq_t *direction;           /* d, per coordinate */
	struct moving_contact *moving; /* in its place; there are no jumps then; NULL: d is constant */
	struct jump *still;         /* its jumps if e were 0 */
	struct impact_slope *slope; /* per derivative of the equations */
	struct output *speed_row;
	int function;               /* its guard is a multiple of this one, less a breakpoint, */
	mpq_t at, factor;           /* guard = factor (switching function - at) */
	bool upward;                /* which it passes this way */
};
struct impact_slope {               /* what follows a param of it, over the states and their derivatives */
	struct form *guard, *speed, *press; /* turned as the guard is */
	mpq_t restitution;
	int jumps;
	struct jump *jump;          /* of a `when` */
	struct moving_contact *moving; /* of a stop: its force acts on the derivatives */
};
struct impact {                     /* of `when`, or of a stop */
	const struct when *when;
	/* v -> v - (1 + e) d s, s the speed: a bounce, which may come to rest; else the jump is any other */
	bool bounces;
	bool moves;                 /* d depends on the state */
	struct impact_law *in;      /* per segment of time of the model */
};

/* friction(v, F): v is a switching function less a breakpoint that stands there twice, the interval of sticking between
 * */
struct friction {                   /* in one segment of time */
	const struct atom *atom;
	int segment, function;
	mpq_t at;                   /* that breakpoint */
	mpq_t factor;               /* v = factor (switching function - at) */
	bool negative;              /* F may fall below 0, and counts as 0 there */
	bool low;                   /* S may fall below F, and counts as F there */
};
struct massless_slider { const struct atom *atom; const struct form *slider_force; };
/* Of FN_SLIDE: friction of a massless slider, by the force through it */
struct slider {
	const struct atom *atom;
	bool negative;              /* F may fall below 0 */
};
/* It slides beyond a breakpoint of q - F or of -q - F; F may be another one in each region */
struct slide {
	int way;                    /* 1 or -1 where it slides */
	int function[2];            /* that of either */
	mpq_t at[2];                /* its breakpoint, */
	bool upward[2];             /* which is passed upward where the sliding begins */
};
/* Friction beside what is not piecewise linear, where there are no regions */
struct drag {
	const struct atom *atom;
	const struct form *velocity, *rate; /* v, and its derivative; that has highest derivatives */
	const struct form *force, *rest;    /* F, and up to what it sticks */
	/* Per coordinate and multiplier: the derivative of F by its highest derivative, and by itself; NULL: F reads
	 * none, else it is solved for with them */
	struct form **by;
	bool curved;                /* these depend on multipliers */
	struct moving_contact *moving; /* NULL: what its force does is constant */
	int of;                     /* it is the derivative of this one, by a column; -1: of none */
};
struct hold {                       /* a state that a region gives: of what sticks a velocity follows from the others */
	int state;
	struct form *form;          /* of states, loads and inputs, none of them held */
	struct output *row;
};
struct release {                    /* of what sticks: the interval is left where the form becomes greater than 0 */
	int function;
	bool upward;
	struct form *form;          /* it may have highest derivatives */
	struct output *row;         /* over states, loads and inputs alone */
};

/* ---- impacts.c: state jumps, and what bounces ---- */

void collect_impacts(struct building *b, struct segment_equations *segment_equations); /* in one interval of time */
void gather_impacts(struct building *b);                    /* of all of them */
void build_impacts(struct building *b);                     /* once the masses are known */
bool impacts_change(const struct building *b);              /* from interval to interval */
/* At the start of this segment of time a load takes the guard up, so that it may come true by no crossing. */
bool closes_by_jump(struct building *b, const struct impact *impact, int segment);
void place_impact_loads(struct building *b, const struct switching *s);
void build_impact_rows(struct building *b, struct switching *s);
/* Why a scheme cannot treat friction or impacts */
_Noreturn void report_no_events(const struct building *b, struct place at);

/* ---- moving.c: contacts of mechanisms ---- */

const struct when *curved_guard(const struct building *b);     /* the first that is not linear; NULL: there is none */
bool is_moved_by(const struct impact *impact, int coord);      /* a bounce changes its velocity */

/* ---- events.c: what is held in regions, and what begins there ---- */

bool is_stick(const struct switching_function *e, int interval);    /* between two equal breakpoints */
/* In one segment of time: which begins where a switching function passes a breakpoint this way; -1: none does */
int  impact_at(const struct switching *s, int segment, int function, mpq_srcptr at, bool upward);
int  impact_resting(const struct switching *s, int segment, int function, int interval); /* there; -1: none does */
/* the interval in which it rests; -1: it is no bounce */
int  rest_of(const struct switching *s, int segment, const struct impact *impact);
bool has_contacts(const struct model *model);                /* impacts, friction without regions */
bool gives_motion(const struct model *model);                /* by a series that goes beside contacts, to outputs */
bool has_bounces(const struct model *model);
const char *restitution_text(const struct model *model, const struct impact *impact); /* of a bounce, at all times */
bool has_dry_friction(const struct switching *s);           /* there is friction, with mass or without */
bool has_events(const struct switching *s);                 /* each region has its own: friction, impacts */

/* ---- contacts.c: impacts and friction beside what is not piecewise linear ---- */

const struct node *multiplier_in(const struct node *node);  /* as a text has it, through lets; NULL: there is none */
void find_contacts(struct building *b);                     /* of the equations for all time */
void place_contact_loads(struct building *b);
void check_contact_outputs(struct building *b);             /* says what they cannot read */
/* What a series beside contacts gives outputs: highest derivatives, multipliers, forces of friction; which are read */
bool *motion_read(const struct model *model);
int  motion_of_friction(const struct model *model, const struct atom *atom); /* its place there */

#endif
