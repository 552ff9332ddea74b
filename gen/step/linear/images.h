/* SPDX-License-Identifier: GPL-3.0-or-later */
/* det (M s^2 + C s + K), transfer functions and natural frequencies; outputs in closed form. */
#ifndef PLGEN_STEP_IMAGES_H
#define PLGEN_STEP_IMAGES_H

#include "step/step.h"

/* ---- resolvent.c: P(s) = M s^2 + C s + K ---- */

struct resolvent;                   /* adj P and B of one system */
struct resolvent *resolvent_of(const struct linear *system);
/* B(s) = det P, as many as its degree + 1 */
void characteristic_polynomial(const struct resolvent *r, mpq_t *coefficient);
const struct poly *resolvent_determinant(const struct resolvent *r);           /* B(s) times the scales of the rows */

struct transfer_function { mpq_t scale; struct poly N, D; };    /* scale N/D, coprime */
/* of a row over states to a force on the equations, and to what it adds directly: [power of s][equation], [power][0] */
struct transfer_function transfer_function_of(struct resolvent *r, const mpq_t *row, int powers,
					      const mpq_t *const *force, const mpq_t *const *direct);

/* ---- loads.c ---- */

/* what its unit force gives the states' derivatives */
mpq_t *impulse_of_force_column(const struct linear *system, int force_column);
/* its value, rational or the nearest of 256 bits */
void load_state(const struct load *load, int column, mpq_srcptr t, mpq_ptr z);
void load_enclosed(const struct load *load, int column, mpq_srcptr t, mpfi_ptr z);
struct output state_as_output(const struct linear *system, int state); /* read alone */

/* ---- closed_form.c: outputs of a linear model at times that rise ---- */

struct closed_form;
/* Mostly at multiples of the distance; inputs 0, or where driven u = 1 - t/distance, held u = 1 */
struct closed_form *closed_form_new(struct place at, const struct linear *system, const mpq_t *initial,
				    mpq_srcptr distance, bool driven);
/* Rounded, infinite beyond the range; `what` names it where it cannot be decided, which is an error */
struct coefficient closed_form_value(struct closed_form *c, const struct output *output, mpq_srcptr t, bool two_words,
				     const char *what);

/* ---- frequencies.c: natural frequencies and damping ratios ---- */

struct pole_report {                /* sorted by |p|, then by real part */
	mpfr_t re, im;              /* rounded from 256 bits */
	mpfr_t hertz, damping_ratio;
	int multiplicity;
	bool pair;                  /* stands for itself and its conjugate */
};
/* an error at the step where they are not told apart */
int poles_of(const struct model *model, const struct resolvent *resolvent, struct pole_report **report);

#endif
