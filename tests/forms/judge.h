/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the constants of a step ought to be, form by form, from M, C, K and the forces alone: e^{A h} by the evaluator
 * of
 * ../accuracy, in intervals.  Kicks come from half a step, X = M Phi_11(h/2)^-1 Phi_21(h/2), which no other program
 * here uses. */
#ifndef JUDGE_H
#define JUDGE_H

#include "emit/emit.h"
#include "model/tunable/tuning.h"
#include "step/linear/forms.h"
#include "step/linear/tables.h"


/* A number in intervals, and whether it is 0: no path leads from its column to its row, or 4096 bits show nothing
 * there. */
struct judged_number {
	mpfi_t x;
	bool zero;
};
struct judge {
	const struct linear *system;
	mpq_srcptr h;
	int states, loads, inputs, columns;     /* columns = states + loads + inputs */
	bool undamped;                          /* kick-drift-kick may be asked for */
	int *block;                             /* per coordinate */
	struct judged_number *step;                    /* [segment][states x columns] */
	struct judged_number *increment;               /* states x states */
	struct judged_number *drift, *kick;            /* coordinates x coordinates, where undamped */
	/* [steps][states x loads]: what a load adds in the step so many steps after; NULL: nothing, or it changes */
	struct judged_number *turned;
};
enum { JUDGED_TURNS = 32 };
struct judge *judge_of(const struct linear *system, mpq_srcptr h);

/* Correctly rounded, and what is left of it correctly rounded; a double holds both.  false: the judge cannot decide. */
bool judge_words(const struct judged_number *number, bool single, double *value, double *low);

#endif
