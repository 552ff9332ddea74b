/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What a method with a fixed step is made of: a scheme, a row of the table in fixed.c, whose steps fixed_run.c makes a
 * run of. */
#ifndef FIXED_H
#define FIXED_H

#include <string.h>

#include "charts.h"
#include "factors.h"

enum { WORK = 8, MOST_ENTRIES = 256 }; /* vectors of 2n to work in; 2n at most */

/* q+ = q + h v + h^2 ((1/2 - beta) a + beta a+)        v+ = v + h ((1 - gamma) a + gamma a+)
 * (1 - alpha_m) a+ + alpha_m a = acceleration at t + (1 - alpha_f) h, (1 - alpha_f) q+ + alpha_f q,
 *                                (1 - alpha_f) v+ + alpha_f v */
struct newmark { double alpha_m, alpha_f, beta, gamma; };

/* What a step of one length needs */
struct part {
	double h;
	struct newmark c;
	double substep, q0, q1, q2;                     /* of two substeps */
	struct factors first, second;
	double *to_velocity, *to_place, *loads, *before; /* n x n, see explicit_step */
};

struct fixed {
	struct run run;
	struct asked rhs;
	int n;
	int steps;                  /* in a unit */
	double h;
	long units;                 /* gone since the start */
	bool failed, linear;
	/* 3n each: coordinates, velocities, and the accelerations that some methods keep; ahead: of `between` */
	double *state, *ahead;
	double *work[WORK];
	double scale_q, scale_v;    /* Newton: largest |coordinate| and |velocity| so far */
	double *weight;             /* Newton: 1 over the scale of each unknown */
	struct part every, rest;    /* rest: of `between`, so that the run stays as it is */
	double *memory;
	int *rows;
};

/* One step from t; false: it cannot */
typedef bool step_function(struct fixed *f, struct part *p, double t, double *state);
struct way {
	step_function *step;
	bool (*advance)(struct run *run, int units, double *rows);
};
struct scheme {
	struct method method;       /* first: a pointer to it is a pointer to this */
	struct way plain, linear;   /* plain: of any problem, or none */
	bool (*wants_linear)(const struct problem *p); /* NULL: never */
	/* of the linear way */
	void (*prepare)(const struct scheme *scheme, const struct problem *p, struct part *part);
	int unknowns;               /* implicit: 1 for n accelerations, 2 for 2n states; explicit: 0 */
	bool keeps_acceleration;
	struct newmark c;
	/* the spectral radius for large steps; the first of two substeps over h, 0: the best one of rho */
	double rho, substep;
};

INLINE void slope(struct fixed *f, double t, const double *y, double *dydt)
{
	f->run.asked++;
	right_side(&f->rhs, t, y, dydt);
}

static inline const struct scheme *scheme_of(const struct fixed *f)
{
	return (const struct scheme *)f->run.method;
}

/* Inlined into each method's own loop: `step` is then no call */
INLINE bool march(struct run *run, int units, double *rows, step_function *step)
{
	struct fixed *f = (struct fixed *)run;
	const int size = 2 * f->n;
	for (int u = 0; u < units && !f->failed; u++) {
		const double t = (double)f->units * run->problem->unit, h = f->h;
		for (int k = 0; k < f->steps && !f->failed; k++)
			f->failed = !step(f, &f->every, t + k * h, f->state);
		f->units++;
		f->failed = f->failed || !all_finite(size, f->state);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * size, f->state, sizeof *rows * (size_t)size);
	}
	return !f->failed;
}

#define MARCH(NAME) \
	static bool NAME##_march(struct run *run, int units, double *rows) \
	{ \
		return march(run, units, rows, NAME); \
	}

struct run *fixed_open(const struct method *method, const struct problem *problem, double setting);

#endif
