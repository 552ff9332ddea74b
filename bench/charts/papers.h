/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * What the four sources report, and what is measured here: one function and one table a source.
 *     reported   by the source itself; empty where its figures did not survive
 *     recovered  by an independent computation when its lost formulas were deduced
 *     measured   now
 */
#ifndef PAPERS_H
#define PAPERS_H

#include "charts.h"

struct papers {
	const char *variants, *folder; /* what variants.sh made; where the tables go */
	FILE *times;                /* of all sources: the only figures that change from run to run */
	bool quick;
};
void coupled_systems(struct papers *papers);        /* 000, papers_coupled.c */
void precise_integration(struct papers *papers);    /* 001, papers_integration.c */
void clearances(struct papers *papers);             /* 002, papers_clearance.c */
void rotating_beam(struct papers *papers);          /* 004, papers_beam.c */
/* Their times, beside none of the above */
void coupled_times(const struct papers *papers);
void integration_times(const struct papers *papers);
void clearance_times(const struct papers *papers);
void beam_times(const struct papers *papers);

/* ---- papers.c ---- */

FILE *table_begin(const struct papers *papers, const char *name);
/* `reported` NULL: not stated (in what is left of the source); the others NULL: empty. `source`: of the file */
void row_of(FILE *table, const char *source, const char *model, const char *method, const char *quantity,
            const char *reported, const char *recovered, const char *measured, const char *settings);
void time_of(const struct papers *papers, const char *source, const char *model, const char *method,
             const char *quantity, const char *reported, const char *measured, const char *settings, struct samples ns);
/* Of runs that take turns for `seconds`, their steps' times over that of the first; closes them. reported NULL: none */
void times_of(const struct papers *papers, const char *source, const char *model, const char *quantity, int count,
              struct run *const *run, double seconds, const char *const *reported, const char *settings);
/* What a row is judged by, closed then: 2n at the ends of units; the caller frees it */
double *rows_of(struct run *run);
#define put_row(table, ...) row_of(table, source, __VA_ARGS__)
#define put_time(papers, ...) time_of(papers, source, __VA_ARGS__)
#define put_times(papers, ...) times_of(papers, source, __VA_ARGS__)
const char *percent(double part);
/* frequency: of a linear model's load, 0 where it has none; below 0: the model is not linear */
struct problem *papers_problem(const struct papers *papers, const char *variant, const char *name, double unit,
                               int units, double frequency);
struct run *papers_run(const struct papers *papers, const struct method *method, const struct problem *p,
                       const char *variant);

/* Errors of several methods, from the smallest up: "A < B < C" */
struct placing { const char *method; double error; };
const char *ordering(int count, struct placing *placing);   /* sorts */

#endif
