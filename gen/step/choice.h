/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the step of a model with needs was chosen from. */
#ifndef PLGEN_STEP_CHOICE_H
#define PLGEN_STEP_CHOICE_H

#include "step.h"

struct error_found {                /* of one requirement, in the output's unit, at every sample up to the end */
	bool known;
	bool exact;                 /* against enclosed exact outputs: the error itself, of this C as it is written */
	double error;               /* `dropped` and what was measured beside it; else of all that was tried */
	double dropped;             /* what is lost with modes, for all inputs within their bounds */
	double needed;
};

struct alternative {                /* one way to step a model with needs */
	bool single, compensated;
	enum step_form form;
	struct model *model;        /* that is stepped: of all modes, or of some */
	/* of a model that is not linear, or piecewise linear: what was left open and is tried, else NULL; its scheme;
	 * what its step costs, and `cost` is that over the step, [1/s]; how many neighbouring starts were tried, the
	 * largest of error over need there, and where */
	bool measured;
	const char *scheme, *step, *tolerance, *name;
	double step_cost;
	int neighbours;
	double worst_neighbour;
	const char *worst_name, *neighbour_names, *ends; /* ends of tunable params' ranges; NULL: there are none */
	int inputs_tried, worst_input; /* how many courses of the inputs; with which the error was largest */
	const char *refused;        /* why there is no such step; NULL: there is */
	double cost;                /* of a step and its outputs, as cost_of_step counts */
	const char *why;            /* its error is not known; NULL: it is */
	double error_ratio;         /* the largest of error over need; at most 1: all needs are met */
	bool as_written;            /* a compiler that contracts products could miss a need, and is refused */
	struct error_found *found;  /* per requirement */
};
struct choice {
	int alternatives, taken;
	struct alternative *alternative; /* those that there are come first, the cheapest before others */
};

#endif
