/* SPDX-License-Identifier: GPL-3.0-or-later */
/* How far outputs of the emitted program may be off, and what is chosen by that. */
#ifndef PLGEN_STEP_CERTIFICATES_H
#define PLGEN_STEP_CERTIFICATES_H

#include "step/step.h"

struct modes;

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
double error_told(const struct certificate *c);             /* as walked, or bounded */
/* `exact`: the same step with the numbers of double */
struct certificate certificate_of(const struct step *step, const struct step *exact, const struct requirement *r);
double needed_error(const struct requirement *r, double largest);       /* of the output */
/* what it surely reaches; `exact` in double; 0: it is not known */
double largest_of_output(const struct step *exact, const struct requirement *r);
/* [modes + 1]: what the output loses at most where the first so many of the order are kept. HUGE_VAL: not known.
 * To be called with the target double */
double *losses_of(struct modes *modes, const int *order, bool statics, const struct requirement *r);

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
	double excess;              /* the largest of error over need; at most 1: all needs are met */
	/* so whatever a compiler contracts; else the C refuses one that does, where it has to: `as_written` */
	double bound_excess;
	bool as_written;
	struct certificate *certificate; /* per requirement */
	struct step *made;          /* as it was tried */
};
struct choice {
	int alternatives, taken;
	struct alternative *alternative; /* those that there are come first, the cheapest before others */
};

#endif
