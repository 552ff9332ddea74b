/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of step/exponential have from one another, and nobody else. */
#ifndef PLGEN_STEP_EXPONENTIAL_INNER_H
#define PLGEN_STEP_EXPONENTIAL_INNER_H

#include "normal.h"
#include "recipe.h"
#include "weights.h"

/* ---- normal_left.c: the remainder, in modes ---- */

double round_real(mpfr_srcptr x);
mpq_t *by_coordinates(const struct model *model, const mpq_t *matrix); /* rows as those of the coordinates' equations */
void find_transforms(struct normal_work *w);
void find_turns(struct normal_work *w);
void find_matrices(struct normal_work *w);
void find_forces(struct normal_work *w);

/* ---- within.c: states inside a step in normal modes ---- */

void find_within(struct normal_work *w);

/* ---- frozen.c: stability of multistep methods in normal modes ---- */

struct stability stability_of(const struct step *step, bool twice);

/* added to that */
void add_phi_part(struct recipe *r, int table, int phi_weight, long p, unsigned long q, int powers, const long *c);
int  add_weighted(struct recipe *r, int table, const char *name, long p, unsigned long q, long weight,
		 unsigned long over); /* e^{A h p/q} h weight/over */
void need_loads_at(struct recipe *r, int node);
int  new_stage(struct recipe *r);
/* valid until the next is added, as that of add_sum is */
struct action *add_action(struct recipe *r, struct action action);
int  add_remainder(struct recipe *r, int node, int stage);
int  add_combination(struct recipe *r, int plus, int minus, bool added);
struct action *add_sum(struct recipe *r, int stage, int flow, int plain, const char *note);
/* one term more of the sum */
void times_left(struct recipe *r, struct action *sum, int table, int phi_weight, int left);

/* ---- weights.c: what a force that is a polynomial over a step gives a mode ---- */

struct lagrange lagrange_of(int nodes, const mpq_t *node);
void lagrange_at(const struct lagrange *l, mpq_srcptr sigma, mpfr_t *value); /* each at s = sigma h */
mpq_t *past_nodes(int count);                               /* 0, -1, ...: the last force first */
struct mode_flow mode_flow_of(const struct normal_mode *mode, mpq_srcptr h, mpq_srcptr theta, const struct lagrange *l);
void mode_flow_free(struct mode_flow *flow);

/* ---- forcings.c: known loads, to which modes respond exactly ---- */

void check_turns(const struct step *step);
void find_forcings(struct normal_work *w);
/* of all operators; see struct normal_stage */
double *forcings_of_stage(const struct normal_work *w, mpq_srcptr theta);

/* ---- steady.c: a step once all functions of time are constant ---- */

/* Over [omega eta, eta', 1, cos and sin of each forcing term] of these modes, one omega each, above 0: of that size. M,
 * C and K: of the first operator, rows by coordinates */
mpfr_t *steady_matrix(const struct model *model, const mpq_t *M, const mpq_t *C, const mpq_t *K,
		       const struct eigenpairs *pairs, mpfr_t *omega);

#endif
