/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The Laplace images of what a step is made of, and natural frequencies. */
#ifndef PLGEN_STEP_IMAGES_H
#define PLGEN_STEP_IMAGES_H

#include "step/step.h"

/* ---- resolvent.c: the Laplace images of what a step needs ---- */

/* acts from tau = 0 on: sum over m of tau^m e^{a tau} times cos(w tau) and sin(w tau) */
struct excitation {
	mpq_srcptr a, w;
	int powers;                 /* m = 0 .. powers-1; where w = 0 there is no sine */
	mpq_t *force;               /* [m][cos, sin][equation]: on the equations */
	mpq_t *direct;              /* [m][cos, sin]: added to the result itself */
};
struct excitation excitation_new(int n, mpq_srcptr a, mpq_srcptr w, int powers); /* all 0; a, w NULL: 0 */
struct question {                   /* row . y(tau) */
	const mpq_t *initial;       /* y(0), one per state; NULL: 0 */
	int excitations;
	struct excitation *excitation;
	const mpq_t *row;           /* one per state */
};
struct resolvent;                   /* adj P and B of one system */
struct resolvent *resolvent_of(const struct linear *system);
struct response *image_of(struct resolvent *r, const struct question *question);

/* ---- loads.c: loads, inputs and held terms as excitations of a step ---- */

struct response *response_of_input(struct resolvent *r, const struct linear *system, int i, int input, int column,
				   mpq_srcptr h);
/* of one load: z_to(t+tau) from z_from(t), at this tau alone */
struct response *response_of_load_state(const struct load *load, int to, int from, mpq_srcptr tau);
/* what its unit force gives the states' derivatives */
mpq_t *impulse_of_force_column(const struct linear *system, int force_column);
struct started {                    /* a response that starts at a time of its own */
	struct response *response;
	mpq_t start;
	struct response *transient; /* in its place behind `end`, from where on a load acts no more; NULL: never */
	mpq_srcptr end;
};
/* output(t) from t = 0 as a sum of responses; returns how many */
int responses_of_output(struct resolvent *r, const struct linear *system, const mpq_t *initial,
			const struct output *output, struct started **list);
struct output state_as_output(const struct linear *system, int state); /* read alone */
struct response *output_of_input(struct resolvent *r, const struct linear *system, const struct output *output,
				 int input, mpq_srcptr value, mpq_srcptr slope);
/* its value, rational or the nearest of 256 bits */
void load_state(const struct load *load, int column, mpq_srcptr t, mpq_ptr z);

/* ---- frequencies.c: natural frequencies and damping ratios ---- */

struct pole_report {                /* sorted by |p|, then by real part */
	mpfr_t re, im;              /* rounded from 256 bits */
	mpfr_t hertz, damping_ratio;
	int multiplicity;
	bool pair;                  /* stands for itself and its conjugate */
};
/* Both without the poles of what misses eliminated constraints, which are of the step alone: B(s) = det P, its
 * degree + 1; poles, an error at the step where they are not told apart */
int characteristic_of(const struct model *model, const struct resolvent *resolvent, mpq_t **B);
int poles_of(const struct model *model, const struct resolvent *resolvent, struct pole_report **report);

#endif
