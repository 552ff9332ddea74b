/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Integrators that choose their steps, each configured as its manual advises: the Dormand-Prince pair written plainly,
 * GSL's odeiv2, SUNDIALS' CVODE and ARKODE. The setting is the relative tolerance e. The absolute tolerance of
 * every coordinate is e times the largest coordinate of the history, of every velocity e times the largest velocity:
 * what a user who knows the problem would give, and here taken from what is true (truth_of; hard.c: its closed forms).
 * So the weight of an error is between e and 2 e of the scale for everyone, and no work is lost where something passes
 * through zero.
 *
 * Where an integrator has an interpolant it walks as it likes and output is read from it; one that has none (GSL), or
 * whose own is too coarse for its order, is stopped at each output time. The first kind looks ahead for `between`; for
 * the second a fresh solution at the same tolerance goes there from the end of the last unit. Neither changes the run.
 */
#ifndef ADAPTIVE_H
#define ADAPTIVE_H

#include <gsl/gsl_odeiv2.h>

#include "charts.h"

enum { MOST_STEPS = 200000 };       /* of its own, in a unit: then it has failed */
#define TOLERANCES "rtol = setting, atol = rtol times largest coordinate, velocity; "

struct adaptive {
	struct run run;
	struct asked rhs;
	int n, size;
	double *scale;              /* size: largest coordinate, or velocity, of the history */
	long units;                 /* gone since the start */
	bool failed;
	double *now;                /* at the end of the last unit */
	struct adaptive *aside;     /* `between`: a second one, made when it is first wanted */
	/* NULL, or set by make: `reach` unit after unit, compiled with the right-hand side inside */
	bool (*walk)(struct adaptive *a, int units, double *rows);
};

/* What each integrator does in its own way */
struct solver {
	size_t bytes;               /* of its struct, which begins with a struct adaptive */
	bool (*make)(struct adaptive *a);
	bool (*begin)(struct adaptive *a, double t, const double *y);
	/* the solution at `end`, not before what was asked last */
	bool (*reach)(struct adaptive *a, double end, double *y);
	/* `reach` may be asked for a time inside a unit, and the run goes on as if it had not been */
	bool looks_ahead;
	void (*discard)(struct adaptive *a);            /* NULL: nothing is to be */
};

struct kind {
	struct method method;       /* first: a pointer to it is a pointer to this */
	const struct solver *solver;
	const gsl_odeiv2_step_type *const *gsl;     /* GSL: which */
	int formula;                /* CVODE: CV_ADAMS, CV_BDF; DIRK: its order; Radau IIA: stages */
};

static inline const struct kind *kind_of(const struct adaptive *a)
{
	return (const struct kind *)a->run.method;
}

static inline void slope(struct adaptive *a, double t, const double *y, double *dydt)
{
	a->run.asked++;
#ifdef INLINED_SLOPE            /* of the chart of any spec */
	INLINED_SLOPE(t, y, dydt);
#else
	right_side(&a->rhs, t, y, dydt);
#endif
}

/* Without a call, as fmax and fmin are at -O2; of what is not a number b is taken, and from larger(1, nan) comes nan */
static inline double larger(double a, double b)
{
	return a > b ? a : b;
}

static inline double smaller(double a, double b)
{
	return a < b ? a : b;
}

/* Of x at y, by the tolerance: the weighted size of explicit pairs */
static inline double weighted(const struct adaptive *a, const double *y, const double *x)
{
	double sum = 0.0;
	for (int i = 0; i < a->size; i++) {
		const double share = x[i] / (a->run.setting * (a->scale[i] + fabs(y[i])));
		sum += share * share;
	}
	return sqrt(sum / a->size);
}

/* Of such a pair: Hairer, Norsett, Wanner I, II.4 (4.14); f: the slope at (t, y) */
static inline double first_step(struct adaptive *a, int order, double t, const double *y, const double *f)
{
	const double unit = a->run.problem->unit, size0 = weighted(a, y, y), size1 = weighted(a, y, f);
	const double guess = size0 < 1e-5 || size1 < 1e-5 ? 1e-6 * unit : 0.01 * size0 / size1;
	double next[a->size], bend[a->size];
	for (int i = 0; i < a->size; i++)
		next[i] = y[i] + guess * f[i];
	slope(a, t + guess, next, bend);
	for (int i = 0; i < a->size; i++)
		bend[i] -= f[i];
	const double most = fmax(size1, weighted(a, y, bend) / guess);
	const double h = most <= 1e-15 ? fmax(1e-6 * unit, 1e-3 * guess) : pow(0.01 / most, 1.0 / order);
	return fmin(100.0 * guess, h);
}

/* `walk` by what `reach` does, compiled into it */
typedef bool reach_function(struct adaptive *a, double end, double *y);
static inline __attribute__((always_inline)) bool walk_by(struct adaptive *a, int units, double *rows, const int size,
                                                          reach_function *reach)
{
	const double unit = a->run.problem->unit;
	long at = a->units;
	for (int u = 0; u < units; u++) {
		double *row = rows ? rows + (ptrdiff_t)u * size : a->now;
		if (!reach(a, (double)++at * unit, row))
			return false;
		if (rows && u == units - 1)
			memcpy(a->now, row, (size_t)size * sizeof *row);
	}
	a->units = at;
	return all_finite(size, a->now);
}

struct run *adaptive_open(const struct method *method, const struct problem *problem, double setting);

#define BY_TOLERANCE(NAME, ORDER, SETTINGS) \
	{.name = NAME, .family = ADAPTIVE, .tolerance = true, .order = ORDER, .settings = TOLERANCES SETTINGS, \
	 .open = adaptive_open}

extern const struct solver dormand_solver;                       /* dormand.c */
extern const struct solver gsl_solver, gsl_fixed_solver;        /* solvers_gsl.c */
extern const struct solver cvode_solver, arkode_solver, dirk_solver;         /* solvers_sundials.c */
/* Kinds that stand in files of their own */
extern const struct kind dop853;                                 /* dop853.c */
extern const struct kind radau5, radau9, radau13;               /* radau.c */
/* Its nodes, and A, s x s, row-major: s = 3, 5 or 7. For tests */
void radau_numbers(int s, double *c, double *A);

#endif
