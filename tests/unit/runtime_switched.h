/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Models with crossings, as the tests of runtime/crossings.c build them: runtime_switched.c. */
#ifndef RUNTIME_SWITCHED_H
#define RUNTIME_SWITCHED_H

#include "runtime.h"

/* Tolerances below are those for doubles; a float's are COARSER times as large. */
#define COARSER ((double)REAL_EPSILON / DBL_EPSILON)

/* What is near enough to level, to a breakpoint or to another crossing to be hard, and yet above rounding */
#ifdef REAL_IS_FLOAT
enum { LEAST_GRAZING = 4, FIRST_APART = 1, LAST_APART = 2, LEAST_HIDDEN = 2 }; /* powers of 1/10 */
enum { DEGREE = 14 };
#define JUST 1e-5
#define NEAR 1e-4
#define ALIKE 1e-3
#define NARROW 1e-4
#define LARGE 1e30
#define LARGEST -1e38
#else
enum { LEAST_GRAZING = 10, FIRST_APART = 3, LAST_APART = 6, LEAST_HIDDEN = 10 };
enum { DEGREE = 21 };
#define JUST 1e-12
#define NEAR 1e-8
#define ALIKE 1e-9
#define NARROW 1e-9
#define LARGE 1e300
#define LARGEST -1e308
#endif

enum { N = 10, S = 3, B = 2, R = 27, RUNGS = 16, LARGEST_DEGREE = 24, EVENTS = 64, SPLITS = 4000 };

/* A model as the generator would emit it.  A of a region is base plus what each switch adds in its interval. */
typedef struct model {
    pl_switching m;
    double base[N * N], add[S][B + 1][N * N];
    real row[S * N], at[S * B], *A, *Phi, *tangent, *chord_error, *cubic_error, *rungs, *reach;
    int states, breaks[S], matrix[R], halvings[R], rung[R], spacing[R]; /* states: the model's own, coordinates first */
    int regions;
    real x[N], *work;
    pl_contact c;
    pl_crossing *crossing;
} model;

double uniform(double lo, double hi);
int below(int n);
model *new_model(int states, int size, int switches);
void free_model(model *s);
void exponential(int n, const real *A, long double tau, int absolute, long double *E);
void build(model *s, double h);
void start_here(model *s);
void start(model *s, const double *x);
void step(model *s);
void steps(model *s, int n);
void assert_near(double found, double expected, double tolerance, const char *what, double h);
void assert_count(const model *s, uint64_t expected, const char *what, double at);
model *oscillator(int dof, int switches, double w);
void couple(model *s, int column, int i, int j, double value);
void spring(model *s, int i, int interval, int j, double k, double b);
model *single(double k, double c, double force, double w, double shaken, int breaks, double lo, double hi);

/* runtime_crossings.c */
enum { SEVERAL = 4 };
extern const double several_steps[SEVERAL];
model *one_stop(double h);

/* The cases of runtime_chatter.c */
void chatter(void **state);
void held_behind_the_last(void **state);
void overflow_is_not_chatter(void **state);
void bounds_hold(void **state);
void random_systems(void **state);
void parts_of_a_step(void **state);

#endif
