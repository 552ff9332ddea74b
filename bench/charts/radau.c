/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Radau IIA of variable step: RADAU5 with 3 stages, order 5, and its sisters of order 9 and 13 (Hairer and Wanner,
 * Solving Ordinary Differential Equations II, IV.8; Journal of Computational and Applied Mathematics 111, 1999), with
 * their splitting by the eigenvalues of A, their simplified Newton, error and step control. Unknowns are the
 * accelerations at the stages, which for y'' = g(t, y, y') is the same method with systems of half the size. Outputs
 * are read from the collocation polynomial. Smooth models have an instance each with right-hand side and Jacobian
 * compiled in; the beams' Jacobian is theirs, that of linear models their matrix, any other by differences.
 *
 * All numbers of the method but its nodes are computed here, in long double: A, error weights; eigenvectors,
 * which only steer Newton, by GSL. The chart of any spec (own/kept.h) includes this file for one model, with ONE_MODEL
 * and what an instance is made of. */
#if defined __GNUC__ && !defined __clang__ && !defined ONE_MODEL
#pragma GCC optimize("cx-limited-range")        /* complex products without tests for infinity */
#endif
#include <complex.h>
#include <float.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include "adaptive.h"
#include "eigen.h"
#include "factors.h"

enum { RADAU_MOST = 7 };
#ifndef ONE_MODEL
#include "equations.h"
#include "jacobian.h"
#include "quad_beam.h"
enum { MOST_COORDINATES = 32 };
#endif

struct radau_table {
	int s;
	double c[RADAU_MOST], A[RADAU_MOST][RADAU_MOST], A2[RADAU_MOST][RADAU_MOST];    /* A2 = A A */
	double W[RADAU_MOST][RADAU_MOST];               /* values at the nodes to coefficients of theta^k */
	double error[RADAU_MOST];                       /* weights of the stages' slopes; that of the start: real */
	/* A = right diag(eigenvalues) left: the real one, and of each pair the one above */
	double real, real_left[RADAU_MOST], real_right[RADAU_MOST];
	double complex pair[RADAU_MOST / 2], left[RADAU_MOST / 2][RADAU_MOST], right[RADAU_MOST / 2][RADAU_MOST];
};

struct radau {
	struct adaptive adaptive;
	const struct radau_table *table;
	bool (*reach)(struct adaptive *a, double end, double *row);
	double tolerance, newton_tolerance;
	double t, h;                                    /* the end of the last step, and the step to try next */
	double from, last;                              /* where the last step began, and its length */
	double start[2 * MOST_COORDINATES];             /* the state there */
	double poly[RADAU_MOST][MOST_COORDINATES];      /* accelerations of the last step, coefficients of theta^k */
	double y[2 * MOST_COORDINATES], slope[2 * MOST_COORDINATES];            /* at t */
	double factored;                                /* the step of the factors; 0: none */
	bool jacobian_is_new, keeps_jacobian, first, rejected;
	double accepted_h, accepted_error, contraction, factor_of_contraction;
	double Jq[MOST_COORDINATES * MOST_COORDINATES], Jv[MOST_COORDINATES * MOST_COORDINATES];
	double matrix[MOST_COORDINATES * MOST_COORDINATES];
	double complex complex_matrix[RADAU_MOST / 2][MOST_COORDINATES * MOST_COORDINATES];
	int row[MOST_COORDINATES], complex_row[RADAU_MOST / 2][MOST_COORDINATES];
};

#define LARGER_PART(z) (fabs(creal(z)) + fabs(cimag(z)))
ELIMINATION(complex, double complex, LARGER_PART)

/* ---- the method's numbers ---- */

/* The zeros of P_s(2 x - 1) - P_{s-1}(2 x - 1), s = 3, 5, 7 */
static const long double nodes[3][RADAU_MOST] = {
	{ 0.155051025721682190199L, 0.644948974278317809839L, 1 },
	{ 0.0571041961145176821859L, 0.276843013638123827691L, 0.583590432368916820047L, 0.860240135656219447871L, 1 },
	{ 0.0293164271597848919744L, 0.148078599668484291863L, 0.336984690281154299096L, 0.55867151877155013203L,
	  0.769233862030054500888L, 0.926945671319741114889L, 1 },
};

/* The inverse of the Vandermonde matrix c_i^k: coefficients of Lagrange's polynomials */
static void invert_vandermonde(int s, const long double *c, long double W[][RADAU_MOST])
{
	for (int i = 0; i < s; i++) {
		long double poly[RADAU_MOST] = { 1 }, scale = 1;
		int degree = 0;
		for (int j = 0; j < s; j++) {
			if (j == i)
				continue;
			for (int k = ++degree; k >= 0; k--)
				poly[k] = (k > 0 ? poly[k - 1] : 0) - c[j] * (k < degree ? poly[k] : 0);
			scale *= c[i] - c[j];
		}
		for (int k = 0; k < s; k++)
			W[k][i] = poly[k] / scale;
	}
}

/* left: rows of the inverse of the matrix of all eigenvectors */
static void find_left(struct radau_table *t)
{
	const int s = t->s;
	double complex a[RADAU_MOST * RADAU_MOST], x[RADAU_MOST], unit[RADAU_MOST];
	int row[RADAU_MOST];
	for (int i = 0; i < s; i++) {
		a[i * s] = t->real_right[i];
		for (int k = 0; k < s / 2; k++) {
			a[i * s + 1 + 2 * k] = t->right[k][i];
			a[i * s + 2 + 2 * k] = conj(t->right[k][i]);
		}
	}
	factor_complex(s, a, row);
	for (int i = 0; i < s; i++) {
		for (int k = 0; k < s; k++)
			unit[k] = k == i;
		solve_complex(s, a, row, unit, x);
		t->real_left[i] = creal(x[0]);
		for (int k = 0; k < s / 2; k++)
			t->left[k][i] = x[1 + 2 * k];
	}
}

static void find_eigenvectors(struct radau_table *t)
{
	const int s = t->s;
	double A[RADAU_MOST * RADAU_MOST];
	double complex value[RADAU_MOST], vector[RADAU_MOST * RADAU_MOST];
	int pairs = 0;
	for (int i = 0; i < s * s; i++)
		A[i] = t->A[i / s][i % s];
	eigenvectors(s, A, value, vector);
	for (int k = 0; k < s; k++) {
		const bool is_real = fabs(cimag(value[k])) <= 1e-8;
		if (!is_real && cimag(value[k]) < 0)
			continue;
		for (int i = 0; i < s; i++)
			if (is_real)
				t->real_right[i] = creal(vector[i * s + k]);
			else
				t->right[pairs][i] = vector[i * s + k];
		if (is_real)
			t->real = creal(value[k]);
		else
			t->pair[pairs++] = value[k];
	}
	find_left(t);
}

static void make_table(struct radau_table *t, int s)
{
	const long double *const c = nodes[(s - 3) / 2];
	long double W[RADAU_MOST][RADAU_MOST], A[RADAU_MOST][RADAU_MOST];
	t->s = s;
	invert_vandermonde(s, c, W);
	for (int i = 0; i < s; i++) {
		t->c[i] = (double)c[i];
		for (int j = 0; j < s; j++) {
			long double power = 1;
			A[i][j] = 0;
			for (int k = 0; k < s; k++) {
				power *= c[i];
				A[i][j] += power * W[k][j] / (k + 1);
			}
			t->A[i][j] = (double)A[i][j];
			t->W[i][j] = (double)W[i][j];
		}
	}
	for (int i = 0; i < s; i++)
		for (int j = 0; j < s; j++) {
			long double sum = 0;
			for (int k = 0; k < s; k++)
				sum += A[i][k] * A[k][j];
			t->A2[i][j] = (double)sum;
		}
	find_eigenvectors(t);
	/* with `real` on the slope at the start, nothing is left of polynomials below degree s: IV.8 (8.17) */
	for (int i = 0; i < s; i++)
		t->error[i] = (double)-W[0][i] * t->real;
}

static const struct radau_table *table_of(int s)
{
	static struct radau_table tables[3];
	struct radau_table *t = &tables[(s - 3) / 2];
	if (t->s == 0)
		make_table(t, s);
	return t;
}

void radau_numbers(int s, double *c, double *A)
{
	const struct radau_table *t = table_of(s);
	for (int i = 0; i < s; i++) {
		c[i] = t->c[i];
		for (int j = 0; j < s; j++)
			A[i * s + j] = t->A[i][j];
	}
}

/* ---- the instances ---- */

#ifdef ONE_MODEL
#define ROWS_OF(ROW)
#else
#define STEPPER "radau_step.h"
#include "instances.h"

static inline void ask(struct adaptive *a, double t, const double *y, double *f)
{
	slope(a, t, y, f);
	a->run.asked--;               /* counted by the stepper */
}

#define INSTANCE(part) beam4_##part
#define COORDINATES BEAM_N
#define EXTENT BEAM_N
#define SLOPES(t, y, f) ask(&d->adaptive, t, y, f)
#define JACOBIAN(t, y, Jq, Jv) beam_jacobian(4.0, t, Jq, Jv)
#include "radau_step.h"

#define INSTANCE(part) beam15_##part
#define COORDINATES BEAM_N
#define EXTENT BEAM_N
#define SLOPES(t, y, f) ask(&d->adaptive, t, y, f)
#define JACOBIAN(t, y, Jq, Jv) beam_jacobian(15.0, t, Jq, Jv)
#include "radau_step.h"

static void other_jacobian(struct radau *d);
#define COORDINATES d->adaptive.n
#define EXTENT MOST_COORDINATES
#define SLOPES(t, y, f) ask(&d->adaptive, t, y, f)
#define JACOBIAN(t, y, Jq, Jv) other_jacobian(d)
#define ROWS_OF(ROW) EQUATIONS(ROW) ROW(beam4, BEAM_N) ROW(beam15, BEAM_N)
#endif

#define INSTANCE(part) other_##part
#include "radau_step.h"

#ifndef ONE_MODEL
/* In closed form, or by differences */
static void other_jacobian(struct radau *d)
{
	const struct problem *p = d->adaptive.run.problem;
	jacobian_function *jacobian = jacobian_of(p);
	if (jacobian)
		jacobian(p, d->t, d->y, d->Jq, d->Jv);
	else
		other_differences(d, 0);
}
#endif

struct instance {
	const char *name;
	bool (*reach[3])(struct adaptive *a, double end, double *y);
	bool (*walk[3])(struct adaptive *a, int units, double *rows);
};
#define ROW(NAME, COORDINATES) { #NAME, { NAME##_reach3, NAME##_reach5, NAME##_reach7 }, \
	                         { NAME##_walk3, NAME##_walk5, NAME##_walk7 } },
static const struct instance instances[] = {
	ROWS_OF(ROW)
	{ NULL, { other_reach3, other_reach5, other_reach7 }, { other_walk3, other_walk5, other_walk7 } }
};

/* ---- as adaptive.h has it ---- */

static bool radau_make(struct adaptive *a)
{
	struct radau *d = (struct radau *)a;
	const int s = kind_of(a)->formula;
	const struct problem *p = a->run.problem;
	const struct instance *i = instances;
	if (a->n > MOST_COORDINATES)
		return false;
	while (i->name && (p->rhs_of || strcmp(i->name, p->name) != 0))
		i++;
	d->table = table_of(s);
	d->reach = i->reach[(s - 3) / 2];
	a->walk = i->walk[(s - 3) / 2];
	/* The error that is seen is of order s, that of the solution of order 2 s - 1: as RADAU takes tolerances */
	d->tolerance = 0.1 * pow(a->run.setting, (s + 1) / (2.0 * s));
	d->newton_tolerance = fmax(10.0 * DBL_EPSILON / d->tolerance,
	                           fmin(0.03, pow(d->tolerance, 2.0 * s / (s + 1) - 1.0)));
	return true;
}

static bool radau_begin(struct adaptive *a, double t, const double *y)
{
	struct radau *d = (struct radau *)a;
	memcpy(d->y, y, (size_t)a->size * sizeof *y);
	memcpy(d->start, y, (size_t)a->size * sizeof *y);
	d->t = d->from = t;
	d->last = d->factored = 0.0;
	d->first = true;
	d->rejected = d->jacobian_is_new = d->keeps_jacobian = false;
	d->factor_of_contraction = 1.0;
	slope(a, t, d->y, d->slope);
	d->h = 1e-3 * a->run.problem->unit;
	return all_finite(a->size, d->slope);
}

static bool radau_reach(struct adaptive *a, double end, double *y)
{
	struct radau *d = (struct radau *)a;
	return end >= d->from && d->reach(a, end, y);
}

static const struct solver radau_solver = {
	.bytes = sizeof(struct radau), .make = radau_make, .begin = radau_begin, .reach = radau_reach,
	.looks_ahead = true,
};

#define RADAU_SETTINGS \
	"Hairer and Wanner's splitting by eigenvalues, Newton, error and step control, in the accelerations; exact " \
	"Jacobian of smooth models, beams and linear models, else differences; output from the collocation polynomial"
const struct kind radau5 = {
	.method = BY_TOLERANCE("RADAU5", 5, "Radau IIA, 3 stages; " RADAU_SETTINGS), .solver = &radau_solver,
	.formula = 3,
};
const struct kind radau9 = {
	.method = BY_TOLERANCE("RADAU9", 9, "Radau IIA, 5 stages; " RADAU_SETTINGS), .solver = &radau_solver,
	.formula = 5,
};
const struct kind radau13 = {
	.method = BY_TOLERANCE("RADAU13", 13, "Radau IIA, 7 stages; " RADAU_SETTINGS), .solver = &radau_solver,
	.formula = 7,
};
