/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the files of `drive` have from one another: the subject, what is true of it, its run */
#ifndef DRIVING_H
#define DRIVING_H

#include "drive.h"

#include <stdbool.h>

enum { MOST = 80, STEPS = 32, LATER = 12, DELAY = 2, INSIDE = 32 };

/* ---- drive_seen.c: the subject, in double or float alike; its bounds, its samples ---- */

extern const struct subject *of;
extern int states, inputs, outputs, complaints;
extern double h, size, out_size;        /* step; of the largest state and output in the run */
/* of an output that is judged by itself, at least 1; else of any output or state */
extern double own[MOST];
extern bool in_float;
extern bool ramps[MOST];                /* which inputs ramp: find_ramps asks the model */
extern bool undriven;                   /* inputs stay 0 */

__attribute__((format(printf, 1, 2))) void complain(const char *form, ...);
bool near(double found, double expected, double tolerance, const char *what, double t, const char *which);
bool is(const char *text, const char *word);
void *fresh(void);
size_t bytes(void);
void narrow(const double *from, float *to, int n);
void widen(const float *from, double *to, int n);
void model_init(void *s);
void model_set(void *s, double t, const double *y);
void model_get(const void *s, double *y);
double model_time(const void *s);
void model_step(void *s, const double *u);
void model_out(const void *s, double *out);
bool model_at(const void *s, const double *u, double tau, double *y);
bool model_jump(void *s, int steps);
int model_status(const void *s);
const char *state_name(int i);
const char *output_name(int i);
double rounding(int steps);
bool of_first_order(void);
double bound(void);
void samples(int step, double *u);
void whole_samples(int step, double *u);
double loss_of(const char *name);
void over_step(const double *before, const double *sampled, double step, double *u);
void find_ramps(void);

/* ---- drive_truth.c: CVODE on NAME_rhs, and the spec's second writing ---- */

struct truth *new_truth(void);
int place_of(const char *name);
bool advance(struct truth *solver, double from, double to, const double *u, double *y);
bool whole(void);
bool highest(double t, const double *y, const double *u, double *top);
bool at_a_change(double t);
void judge_rhs(void);

/* ---- drive_steps.c: its run, and what goes along with its steps ---- */

struct row {
	double t, y[MOST], out[MOST], truth[MOST], u[2 * MOST];
	double top;             /* the largest size of a + b/2 in the step that begins here, where NAME_at tells it */
};
extern struct row row[STEPS + 1];
extern double worst_truth;

/* The model; `whole` beside it; and the model by eighths of what it steps at once, where its steps make an error */
struct beside {
	void *model, *whole, *fine;
	double before[MOST];
};

void run_steps(void);
struct beside begin(void);
void by_eighths(bool now);
void get_eighths(const struct beside *b, double *y, void (*get)(const void *, double *));
void step_by_eighths(struct beside *b, const double *u);
void step_beside(struct beside *b, int k);
void set_beside(struct beside *b, double t, const double *y);
void end_beside(struct beside *b);
struct beside begin_eighths(int from, double t, const double *y);
void get_inside(struct beside *b, double t, const double *from, const double *u, int count, double *y);
bool in_order(const void *s, double found, double by_eighths_found, double expected, double most,
	const char *what, double t, const char *which);
void judge_steps(void *s, int from, int steps, double step, struct row *first, const char *what);
void judge_beside(struct beside *b, int from, int steps, const char *what);

/* ---- drive_derivatives.c: its derivatives against differences ---- */

void judge_derivatives(void);

#endif
