/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What is certified of a step: how far outputs of the emitted program may be off, and what is chosen by that; states
 * and crossings in closed form, for the self-test, and enclosed. */
#ifndef PLGEN_STEP_CERTIFY_H
#define PLGEN_STEP_CERTIFY_H

#include "step/step.h"

struct modes;
struct region_part;

/* ---- rounding.c: how far an output of the emitted program may be off ---- */

struct certificate {                /* of one requirement, in the output's unit */
	bool known;
	const char *why;            /* it is not */
	/* at every sample up to the end: bounds of what rounds, of what modes are missed; of one that is measured the
	 * whole error, and 0 */
	double rounding, dropped;
	double needed;
	/* its C has run beside the exact outputs: the error itself, where each product and each sum is rounded as it is
	 * written; the bounds above hold where a compiler contracts them too */
	bool walked;
	double error;
};
double error_reported(const struct certificate *c);         /* as walked, or bounded */
/* `exact`: the same step with the numbers of double */
struct certificate certificate_of(const struct step *step, const struct step *exact, const struct requirement *r);
double needed_error(const struct requirement *r, double largest);       /* of the output */
/* what it surely reaches; `exact` in double; 0: it is not known */
double largest_of_output(const struct step *exact, const struct requirement *r);
/* [modes + 1]: what the output loses at most where the first so many of the order are kept. HUGE_VAL: not known.
 * To be called with the target double */
double *truncation_errors_of(struct modes *modes, const int *order, bool static_correction,
			     const struct requirement *r);

struct alternative {                /* one way to step a model with needs */
	bool single, compensated;
	enum step_form form;
	struct model *model;        /* that is stepped: of all modes, or of some */
	/* of one that is measured: what was left open and is tried, else NULL; its scheme; what its step costs, and
	 * `cost` is that over the step, [1/s]; how many neighbouring starts were tried, the largest of error over need
	 * there, and where */
	bool measured;
	const char *scheme, *step, *tolerance, *name;
	double step_cost;
	int neighbours;
	double worst_neighbour;
	const char *worst_name, *neighbour_names;
	int inputs_tried, worst_input; /* how many courses of the inputs; with which the error was largest */
	const char *refused;        /* why there is no such step; NULL: there is */
	double cost;                /* of a step and its outputs, as cost_of_step counts */
	const char *why;            /* its error is not known; NULL: it is */
	double error_ratio;         /* the largest of error over need; at most 1: all needs are met */
	/* so whatever a compiler contracts; else the C refuses one that does, where it has to: `as_written` */
	double bound_error_ratio;
	bool as_written;
	struct certificate *certificate; /* per requirement */
	struct step *made;          /* as it was tried */
};
struct choice {
	int alternatives, taken;
	struct alternative *alternative; /* those that there are come first, the cheapest before others */
};

/* ---- trajectory.c: a piecewise-linear model through its crossings, enclosed ---- */

struct passed {                     /* a breakpoint, by its switching function */
	int function, breakpoint;
	bool upward;
	bool jumped;                /* by a load that jumps, not by crossing */
	bool faint;                 /* it begins with speed and acceleration 0: what rested is let go */
	bool stands;                /* it rests as impacts have left it with speed 0 where it would bounce */
	mpfi_t at;                  /* when [s] */
	double speed;               /* of the switching function there [its unit/s] */
	double size;                /* of what it is summed from there [its unit] */
};
struct trajectory;
/* From t = 0 on in so many bits. NULL: of the whole model, which then has no parts; `initial` has its states. Inputs
 * follow u = 1 - t/h; held, u = 1; those that stand for params have the spec's values. */
struct trajectory *trajectory_start(const struct model *model, const struct region_part *part, const mpq_t *initial,
			      int precision);
bool trajectory_reach(struct trajectory *t, mpq_srcptr time); /* false: it is not decided what comes before */
const char *trajectory_undecided(const struct trajectory *t); /* why */
void trajectory_value(const struct trajectory *t, const struct output *output, mpfi_ptr value);
int  trajectory_passed(const struct trajectory *t, const struct passed **list); /* so far, in order */
void trajectory_free(struct trajectory *t);

/* ---- passing.c, closed.c: states that the self-test compares with ---- */

enum { REFERENCE_ROWS = 11, FEW_ROWS = 8 };       /* few: where no crossing is waited for */
struct reference {                  /* from t = 0 on; inputs follow u = 1 - t/h; held, u = 1 */
	int states, rows;           /* rows: fewer where the states leave the range */
	const unsigned long *steps; /* per row: how many have been taken */
	double *start, *value;      /* [states]; [row][states] */
	double *between;            /* [states] at h/2, where NAME_at is there */
	double *unit;               /* [states]: one in the last place of the largest value */
	/* of a piecewise-linear model the crossings up to the last row: when, and how much of that is rounding */
	int crossings;
	struct { unsigned long step; double after, unit; } *crossing;  /* steps before it, and [s] */
};
void reference_units(struct reference *r, bool single);
bool has_closed_form(const struct step *step);
struct reference new_reference(int states);                 /* room for its rows */
struct reference reference_of(const struct step *step);     /* in closed form */

#endif
