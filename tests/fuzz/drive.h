/* SPDX-License-Identifier: GPL-3.0-or-later */
/* One model that drive.c holds against other roads; grammar.sh writes a table of them. */
#ifndef DRIVE_H
#define DRIVE_H

#include "plrt.h"

#include <math.h>

struct subject {
	const char *name;
	const pl_model *model;      /* or */
	const pl_modelf *modelf;    /* of one in float */
	/* the same spec in double, no state left out; of inputs more, the first one delayed */
	const pl_model *whole;
	/* NAME_rhs of `whole`; NULL: its steps are what those of the model are held against */
	void (*slopes)(double t, const double *y, const double *u, double *dydt);
	const char *scheme, *class; /* class: linear, piecewise, sticking (dry friction, of which `whole` has a steep
				     * damper up to the force), smooth, kinked; "": unknown */
	const char *changes;        /* times at which a load changes its formula */
	const char *solution;       /* file of --solution, or NULL */
	double (*selftest)(void);   /* or NULL */
	const int *coords;          /* of the spec's second writing: NULL where there is none */
	void (*residual)(double t, const double *y, const double *u, const double *top, double *r);
	void (*wanted)(double t, const double *y, const double *u, const double *top, double *out);
	const pl_model *tuned;      /* the spec with other params and step; NULL: nothing is tunable */
	const char *retune;         /* these values: NAME=VALUE ... */
	double (*lanes)(void);      /* of NAME_batch, by LANES; or NULL */
	const char *impact;         /* GAP RESTITUTION: b' = -RESTITUTION b' where b comes up to GAP; "": none */
	int adds;                   /* how often a step adds to a state: 3 of the form kick-drift-kick, else 1 */
	int (*region)(const void *s);   /* NAME_region, or NULL */
	double regions;             /* how many there may be */
	int (*whole_region)(const void *s);     /* that of `whole`, where it has the same expressions; or NULL */
	double ratio;               /* what is kept of coordinates that move as a whole may be so much larger */
	double tolerance;           /* to which lengths of steps are chosen; 0: they are not */
	const pl_model *fine;       /* by eighths of what it steps at once: of a fixed order held against steps to a */
	const pl_modelf *finef;     /* tolerance, or beyond a bound, or of few stages that may want too many internal
				     * steps; or NULL */
	const char *lost;           /* by output, with modes that are dropped: " NAME VALUE, ..." */
	int written;                /* positions that may move as a whole stay as written: differences round as they */
	int may;                    /* what NAME_status may tell: of a fixed order, that it misses the tolerance */
	int order;                  /* in h: what is beyond a bound has to be of it, by `fine`; 0: nothing may be */
	double (*sustained)(void);  /* the largest part of a state that is not kept in it, by SUSTAINED; or NULL */
	const pl_derivatives *varied;   /* by k and by the initial value of a; or */
	const pl_derivativesf *variedf; /* of one in float; NULL: none are asked for */
	const pl_model *beside[3];  /* the spec with k = 11.9988, 12 and 12.0012, in double, of the same scheme */
	int held;                   /* constraints hold the state: it is set to states of its run only */
};

extern const struct subject subjects[];     /* up to one without a name */

/* LANES(id, ID, real, with): id_lanes(), how far instances of ID_batch are off one that steps alone, in states
 * and in their last outputs, over the largest of these or 1; with: `u COMMA`, or nothing where there are no inputs.
 * SUSTAINED(id, ID, real): id_sustained(), what loads sustain of a state at the start at most, where it is kept less
 * that. */
#define COMMA ,
#define LANES(id, ID, real, with)                                                                                     \
	static double id##_lanes(void)                                                                                 \
	{                                                                                                              \
		enum { COUNT = 5, ROWS = 12, OUT = ID##_OUTPUTS };                                                     \
		static real y[ID##_BATCH_ROWS * COUNT], peak[OUT * COUNT], out[ROWS * OUT * COUNT];                    \
		static real u[ROWS * (ID##_INPUTS + 1)], expected[OUT];                                                \
		real now[ID##_STATES], state[ID##_STATES];                                                             \
		double most = 0, size = 1;                                                                             \
		id##_instances b = {0};                                                                                \
		id one;                                                                                                \
		for (int k = 0; k < ROWS * (ID##_INPUTS + 1); k++)                                                     \
			u[k] = (real)((k * 37 + 11) % 61 - 30) / 32;                                                   \
		b.count = COUNT;                                                                                       \
		b.y = y;                                                                                               \
		b.peak = peak;                                                                                         \
		id##_batch_init(&b);                                                                                   \
		id##_batch(&b, ROWS, with out);                                                                        \
		id##_init(&one);                                                                                       \
		for (int k = 0; k < ROWS; k++)                                                                         \
			id##_model.step(&one, ID##_INPUTS ? u + k * ID##_INPUTS : NULL);                               \
		id##_get(&one, state);                                                                                 \
		id##_out(&one, expected);                                                                              \
		for (size_t j = 0; j < COUNT; j++) {                                                                   \
			id##_batch_get(&b, j, now);                                                                    \
			for (int i = 0; i < ID##_STATES; i++) {                                                        \
				size = fmax(size, fabs((double)state[i]));                                             \
				most = fmax(most, fabs((double)now[i] - (double)state[i]));                            \
			}                                                                                              \
			for (int i = 0; i < OUT; i++) {                                                                \
				double found = (double)out[((ROWS - 1) * OUT + i) * COUNT + (int)j];                   \
				size = fmax(size, fabs((double)expected[i]));                                          \
				most = fmax(most, fabs(found - (double)expected[i]));                                  \
			}                                                                                              \
		}                                                                                                      \
		return most / size;                                                                                    \
	}

#define SUSTAINED(id, ID, real)                                                                                       \
	static double id##_sustained(void)                                                                             \
	{                                                                                                              \
		real state[ID##_STATES];                                                                               \
		double most = 0;                                                                                       \
		id one;                                                                                                \
		id##_init(&one);                                                                                       \
		id##_get(&one, state);                                                                                 \
		for (int i = 0; i < ID##_STATES; i++)                                                                  \
			most = fmax(most, fabs((double)state[i] - (double)one.y[i]));                                  \
		return most;                                                                                           \
	}

#endif
