/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of step/certify have from one another, and nobody else. */
#ifndef PLGEN_STEP_CERTIFY_INNER_H
#define PLGEN_STEP_CERTIFY_INNER_H

#include "certify.h"
#include "step_map.h"

/* ---- rounding.c: how far an output of the emitted program may be off ---- */

long samples_until(const struct requirement *r, mpq_srcptr h); /* below 0: too many */

/* ---- kept.c ---- */

double kept_mass(const struct step *step, int state);       /* momenta: of the coordinate; else 1 */
bool   is_load_forced(const struct step *step, int column);
double load_value(const struct forcing_of_column *p, double t); /* at t [s] */
/* what the step of the errors keeps, by the numbers of `exact` */
struct step_map *step_map_of(const struct errors *e, const struct step *exact);
/* from the start, inputs 0; the output is added to `trace`, where there is one, at each sample */
struct extent walk_loads(long steps, double h, const struct spread *spread, struct step_map *k, double *trace);
/* what samples of an input within its bound do to the output at most; it is attained */
double sum_of_input(const struct linear *system, long steps, const struct step_map *k, int input, int first,
		    double *trace);
/* what reads slopes of inputs is bounded, not attained */
double slopes_of_inputs(const struct linear *system, const struct step_map *k, double h);
struct extent extent_of_step_map(const struct step *step, long steps, const struct spread *spread, struct step_map *k);

/* ---- lasting.c: bounds of the same, of so many samples that they are not walked through ---- */

bool is_lasting(const struct step_map *k, long steps);
double lasting_output(const struct step_map *k, const struct spread *spread, double h); /* inputs 0: its largest size */
void lasting_sizes(const struct spread *spread, struct step_map *k, double h);      /* of the states */
/* what samples of an input in its bound do to the output at most; columns from `first` on are its samples */
double lasting_input(const struct linear *system, const struct spread *spread, const struct step_map *k, int input,
		     int first);

/* ---- rounding.c ---- */

const char *certificate_objection(const struct errors *e);   /* NULL: there is none */
struct errors errors_of(const struct step *step, const struct requirement *r);

/* ---- trajectory.c: a piecewise-linear model through its crossings, enclosed ---- */

void trajectory_state(const struct trajectory *t, int state, mpfi_ptr value);  /* where it has got to */
void trajectory_widen(struct trajectory *t, int state, mpfr_srcptr off); /* which may be so much another one */
void trajectory_limit(struct trajectory *t, int most);      /* crossings; what comes behind them is not decided */

/* ---- passing.c: the same through crossings ---- */

double ulp_of(double value, bool single);
void reference_start(int state, mpq_ptr value);              /* a start that has nothing special */
struct reference reference_of_trajectory(const struct step *step); /* leaves the statement where nothing is known */

#endif
