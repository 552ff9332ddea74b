/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The C of a model, run inside the generator: what it does is measured before it is published. */
#ifndef PLGEN_RUN_H
#define PLGEN_RUN_H

#include "emit/printed.h"

/* ---- count.c: C that counts what it does ---- */

rewriter print_counts;                                      /* for what stands behind counts.h */

/* ---- symbols.c: what the C of a model calls ---- */

struct runtime_symbol { const char *name; const void *at; };
extern const struct runtime_symbol runtime_symbols[];       /* the last has no name */
extern const char math_prototypes[], math_counts[];         /* C: of <math.h>; that counts its calls */

/* ---- native.c: compiled into memory ---- */

enum running_with { WITH_RHS = 1, WITH_COUNTS = 2 };        /* NAME_rhs; counts of what is done */
/* What has run so far, as step/cost.c counts it: quotients are products, a call is one of <math.h>, a forcing term is
 * cos and sin of the runtime, whose sums and products are counted too. Of what the runtime does with arrays it is an
 * estimate. */
struct counted { uint64_t multiplications, additions, calls, forcings, waits, pieces, events, terms; };
struct native {
	const void *model, *rhs;    /* the descriptor; NULL: without */
	const struct counted *counted;
};
/* `at`: the place of whoever wants it run, for an error, which leaves the statement */
struct native native_of(struct place at, const struct step *step, enum running_with with);

/* ---- running.c: an instance ---- */

struct running;
/* The target's type is that of the step behind it. NULL: *why */
struct running *running_new(struct place at, const struct step *step, enum running_with with, const char **why);
const struct step *running_step_of(const struct running *r);
struct counted running_counted(const struct running *r);     /* of all instances of this code; 0 without counts */
void   running_start(struct running *r, double t, const double *y);  /* any state; y NULL: the spec's, at 0 */
void   running_step(struct running *r, const double *u);     /* by h */
void   running_state(struct running *r, double *y);
bool   running_at(struct running *r, const double *u, double tau, double *y);   /* false: there is no NAME_at */
double running_time(struct running *r);
void   running_outputs(struct running *r, double *out);
void   running_needed(struct running *r, double *value);     /* per need: its output */
int    running_status(struct running *r);
void   running_rhs(struct running *r, double t, const double *y, const double *u, double *slope);

struct board_cost board_cost_of(struct place at, const struct step *step);
/* From the spec's initial values by so many steps, inputs 0: the states then; NULL, or why there are none */
const char *motion_to(struct place at, const struct step *step, long steps, double *y);

/* ---- drive.c: inputs that are tried ---- */

struct sampled {                      /* samples at t = 0, h, 2 h, ... */
	int inputs;
	double h;                   /* [s] */
	long samples;               /* there are two more, for the ends of ramps */
	bool *ramps;                /* per input: straight between samples; else a sample holds until the next */
	double *sample;             /* [sample][input] */
};
/* One of drive_kinds(count): within `most`, by the frequencies w [rad/s], in rising order */
struct sampled drive_of(const struct linear *system, int kind, const double *w, int count, double h, long samples,
		      const mpq_t *most);
int  drive_kinds(int count);
void drive_step(const struct sampled *d, long k, double *u);           /* what step k is given */
void drive_at(const struct sampled *d, long k, double t, double *u);   /* at t in step k: inputs, then their slopes */
void running_drive(struct running *r, const struct sampled *d, long k); /* as if k steps were done; a start follows */

/* ---- reference.c: the equations as written, by two independent methods ---- */

struct course {                     /* what needs are of, at t = 0, h, 2 h, ... */
	long samples, *end;         /* after the first: all, and of each need */
	int needs;
	double *value, *low;        /* [sample][need]; of an exact one its second word, else NULL */
	bool kept;                  /* for another one to be tried */
};
double longest_need(const struct model *model);              /* [s] when the last ends */
struct course *course_of(const struct model *model, double h); /* up to there, its values not known yet */
enum { SOLVERS = 2 };
struct solvers {                    /* of NAME_rhs: two methods that have nothing in common but it */
	struct running *r;          /* in double */
	double h, until;            /* [s] */
	int changes;                /* of formula in time, at which a method starts anew */
	const double *change;
	uint64_t most;              /* operations that one may take */
	bool stiff;                 /* the implicit pair */
	double tolerance;           /* of a step, relative to the largest of each state */
	double *size;               /* that; NULL: not known yet */
	const struct sampled *drive;  /* with these inputs; NULL: there are none */
};
/* From these states (NULL: the spec's) by the first solver or the second; NULL: *why */
struct course *solved_course(struct solvers *solvers, int which, const double *start, const char **why);
/* The steps of solvers->r themselves, of a scheme by its tolerance; NULL: *why */
struct course *stepped_course(const struct solvers *solvers, const double *start, const char **why);
/* at samples up to a need's end: the largest difference in its output, NaN where there is one; its largest size */
double apart(const struct course *a, const struct course *b, int need);
double largest_of(const struct course *a, int need);
void course_free(struct course *course);

/* ---- replay.c: states for the self-test ---- */

/* step->replayed, where the self-test has no closed form; false: it was said why there is none */
bool find_replayed(struct step *step);

/* ---- exact.c: closed forms of a linear model ---- */

/* Of the equations of `full` for the needs of `stepped`; NULL: there are inputs, or it would take too long */
struct course *exact_course_of(const struct model *full, const struct model *stepped);

/* ---- measure.c: how far the outputs of a step are off ---- */

enum { LIMIT_MEASURED = 400000000 };   /* operations of one solver, or of one step that is tried */
struct trial {                      /* of a step, against a reference */
	double multiplications, additions, calls; /* of a step and its outputs, on average */
	double until;               /* [s] when it ended; to ask for it is counted as a part of a step */
	const char *why;            /* it came to no end; NULL: it did */
	double *error;              /* per need: the largest, at every sample up to its end */
};
struct trial trial_of(struct running *r, const struct course *reference, const double *start,
		      const struct sampled *drive);

#endif
