/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What was derived, for a person or a program to read. */
#ifndef PLGEN_REPORT_H
#define PLGEN_REPORT_H

#include "step/step.h"

/* ---- report.c: poles and polynomials for a reader ---- */

const char *pole_text(const struct pole_report *report);
/* the pole, in so many columns; frequency, damping */
const char *pole_row(const struct pole_report *report, int width);
double growth_rate(const struct step *step);                /* [1/s] */
const char *polynomial_text(int length, const mpq_t *c);    /* in s */
const char *irrationals_text(const struct irrationals *used);

/* ---- reach.c: what a series costs, and how far it reaches ---- */

void person_reach(FILE *to, const struct step *step);
void json_reach(FILE *to, const struct step *step);

/* ---- modes.c: steps in normal modes ---- */

const char *operators_of_modes(const struct step *step);    /* whose modes they are */
const char *exact_in_modes(const struct step *step);
const char *course_of_modes(const struct step *step);       /* which way a step goes */
const char *stability_of_modes(const struct step *step);
int  numbers_of_modes(const struct step *step);             /* in its tables, at most */
void person_normal(FILE *to, const struct step *step);
void json_normal(FILE *to, const struct step *step);         /* a member of an object */
void program_normal(FILE *to, const struct step *step);

/* ---- needs.c: what was chosen for needs, and from what ---- */

const char *alternative_text(const struct alternative *a);  /* float, delta */
const char *need_text(const struct requirement *r);         /* as written */
const char *certified_text(const struct alternative *a, int i); /* of a requirement: the bound and its parts */
const char *margin_text(const struct step *step, int i);    /* of the one taken, with the margin */
void person_needs(FILE *to, const struct step *step);
void json_needs(FILE *to, const struct step *step);          /* members of an object */

/* ---- shortened.c: a model of some modes of another ---- */

const char *mode_numbers(const struct shortening *s, bool kept); /* of those that are kept, or of the others: 1-4, 6 */
int  modes_of_model(const struct shortening *s);            /* how many it has, dropped ones too */
const char *loss_text(const struct model *model, int output); /* tip 3.2e-05: at most, by the start and the loads */
const char *statics_text(const struct model *model);        /* what dropped modes still do */
void person_shortening(FILE *to, const struct model *model);
void json_shortening(FILE *to, const struct model *model);  /* members of an object */

/* ---- program.c, explain.c, solution.c ---- */

void explain_program(FILE *to, const struct step *step);    /* what a step does, before it is C */

void explain_person(FILE *to, const struct step *step);
void explain_json(FILE *to, const struct step *step);
void print_solution(FILE *to, const struct model *model, struct resolvent *written, mpq_srcptr end);

#endif
