/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the C of each kind of step has of its own. */
#ifndef PLGEN_EMIT_KINDS_H
#define PLGEN_EMIT_KINDS_H

#include "state.h"
#include "step/step.h"

/* ---- kinds.c: what the C of a step has that depends on its kind, in the order of the C ---- */

struct kind {                           /* NULL: none of its own */
	/* The comment at the top: what is approximated; before what a step costs */
	void (*banner)(const struct emitter *e);
	const char *step_note;
	/* The header: constants; types before that of the state; at its end; functions */
	void (*constants)(const struct emitter *e);
	void (*types)(const struct emitter *e);
	void (*members)(const struct emitter *e);
	bool keeps_status;                              /* else NAME_status looks at the state when it is asked */
	const char *status_note;
	void (*declare_state)(const struct emitter *e); /* of what else the state has */
	/* The state */
	bool own_factors;                               /* what depends on h is in s->coeffs; else in tables */
	bool (*places)(const struct emitter *e);        /* NAME_place(s) finds what follows from a state that was set */
	/* Tables and functions */
	bool (*reads_phi)(const struct step *step);     /* of what is kept, in a loop */
	void (*tables)(const struct emitter *e);
	void (*pass)(const struct emitter *e);          /* over what changes at a time */
	void (*step)(const struct emitter *e);
	void (*held)(const struct emitter *e);          /* in at: what is held over the step */
	void (*at)(const struct emitter *e);
};
const struct kind *row_of_kind(enum step_kind kind);

#endif
