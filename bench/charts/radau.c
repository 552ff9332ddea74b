/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Radau IIA of variable step: RADAU5 with 3 stages, order 5, and its sisters of order 9 and 13 (Hairer and Wanner,
 * Solving Ordinary Differential Equations II, IV.8; Journal of Computational and Applied Mathematics 111, 1999), with
 * their splitting by the eigenvalues of A, their simplified Newton, error and step control. Unknowns are the
 * accelerations at the stages, which for y'' = g(t, y, y') is the same method with systems of half the size. Outputs
 * are read from the collocation polynomial. Smooth models have an instance each with right-hand side and Jacobian
 * compiled in; the beams' Jacobian is theirs, that of linear models their matrix, any other by differences.
 *
 * All numbers of the method are computed here, in long double: nodes, A, error weights; eigenvalues and eigenvectors,
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

#include <gsl/gsl_complex.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_matrix.h>

#include "adaptive.h"

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

/* ---- systems of equations: Gauss elimination with partial pivoting; the diagonal keeps reciprocals ---- */

#define ELIMINATION(KIND, number, size_of) \
INLINE void factor_##KIND(const int n, number *a, int *row) \
{ \
	for (int i = 0; i < n; i++) \
		row[i] = i; \
	for (int k = 0; k < n; k++) { \
		int pivot = k; \
		for (int i = k + 1; i < n; i++) \
			if (size_of(a[i * n + k]) > size_of(a[pivot * n + k])) \
				pivot = i; \
		for (int j = 0; j < n && pivot != k; j++) { \
			const number entry = a[k * n + j]; \
			a[k * n + j] = a[pivot * n + j]; \
			a[pivot * n + j] = entry; \
		} \
		const int kept = row[k]; \
		row[k] = row[pivot]; \
		row[pivot] = kept; \
		a[k * n + k] = 1.0 / a[k * n + k]; \
		for (int i = k + 1; i < n; i++) { \
			const number multiple = a[i * n + k] *= a[k * n + k]; \
			for (int j = k + 1; j < n; j++) \
				a[i * n + j] -= multiple * a[k * n + j]; \
		} \
	} \
} \
/* x: the right side, then the solution */ \
INLINE void solve_##KIND(const int n, const number *a, const int *row, number *x) \
{ \
	number z[n > 2 ? MOST_COORDINATES : 2]; \
	_Pragma("GCC unroll 4") for (int i = 0; i < n; i++) { \
		number sum = x[n == 1 ? 0 : row[i]]; \
		for (int j = 0; j < i; j++) \
			sum -= a[i * n + j] * z[j]; \
		z[i] = sum; \
	} \
	_Pragma("GCC unroll 4") for (int i = n - 1; i >= 0; i--) { \
		number sum = z[i]; \
		for (int j = i + 1; j < n; j++) \
			sum -= a[i * n + j] * x[j]; \
		x[i] = sum * a[i * n + i]; \
	} \
}
#define LARGER_PART(z) (fabs(creal(z)) + fabs(cimag(z)))
ELIMINATION(real, double, fabs)
ELIMINATION(complex, double complex, LARGER_PART)

/* ---- the method's numbers ---- */

/* P_s(2 x - 1) - P_{s-1}(2 x - 1), whose zeros are the nodes; 1 is one of them */
static long double node_function(int s, long double x)
{
	const long double z = 2 * x - 1;
	long double before = 1, now = z;
	for (int k = 1; k < s; k++) {
		const long double next = ((2 * k + 1) * z * now - k * before) / (k + 1);
		before = now;
		now = next;
	}
	return now - before;
}

static void find_nodes(int s, long double *c)
{
	enum { PARTS = 1000 };
	int found = 0;
	for (int k = 0; k < PARTS && found < s - 1; k++) {
		long double low = (k + 0.5L) / PARTS * 0.999L, high = (k + 1.5L) / PARTS * 0.999L;
		if ((node_function(s, low) > 0) == (node_function(s, high) > 0))
			continue;
		for (int turn = 0; turn < 80; turn++) {
			const long double middle = (low + high) / 2;
			if ((node_function(s, low) > 0) == (node_function(s, middle) > 0))
				low = middle;
			else
				high = middle;
		}
		c[found++] = (low + high) / 2;
	}
	c[s - 1] = 1;
}

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
	double complex a[RADAU_MOST * RADAU_MOST], x[MOST_COORDINATES];
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
			x[k] = k == i;
		solve_complex(s, a, row, x);
		t->real_left[i] = creal(x[0]);
		for (int k = 0; k < s / 2; k++)
			t->left[k][i] = x[1 + 2 * k];
	}
}

static void find_eigenvectors(struct radau_table *t)
{
	const size_t s = (size_t)t->s;
	gsl_matrix *A = gsl_matrix_alloc(s, s);
	gsl_vector_complex *value = gsl_vector_complex_alloc(s);
	gsl_matrix_complex *vector = gsl_matrix_complex_alloc(s, s);
	gsl_eigen_nonsymmv_workspace *work = gsl_eigen_nonsymmv_alloc(s);
	for (size_t i = 0; i < s; i++)
		for (size_t j = 0; j < s; j++)
			gsl_matrix_set(A, i, j, t->A[i][j]);
	gsl_eigen_nonsymmv(A, value, vector, work);
	int pairs = 0;
	for (size_t k = 0; k < s; k++) {
		const gsl_complex z = gsl_vector_complex_get(value, k);
		if (GSL_IMAG(z) < 0)
			continue;
		const bool is_real = !(GSL_IMAG(z) > 1e-8);
		for (size_t i = 0; i < s; i++) {
			const gsl_complex x = gsl_matrix_complex_get(vector, i, k);
			if (is_real)
				t->real_right[i] = GSL_REAL(x);
			else
				t->right[pairs][i] = GSL_REAL(x) + GSL_IMAG(x) * I;
		}
		if (is_real)
			t->real = GSL_REAL(z);
		else
			t->pair[pairs++] = GSL_REAL(z) + GSL_IMAG(z) * I;
	}
	gsl_eigen_nonsymmv_free(work);
	gsl_matrix_complex_free(vector);
	gsl_vector_complex_free(value);
	gsl_matrix_free(A);
	find_left(t);
}

static void make_table(struct radau_table *t, int s)
{
	long double c[RADAU_MOST], W[RADAU_MOST][RADAU_MOST], A[RADAU_MOST][RADAU_MOST];
	t->s = s;
	find_nodes(s, c);
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

/* In closed form, or by differences */
static void other_jacobian(struct radau *d)
{
	struct adaptive *a = &d->adaptive;
	const struct problem *p = a->run.problem;
	const int n = a->n;
	double moved[2 * MOST_COORDINATES], f[2 * MOST_COORDINATES];
	jacobian_function *jacobian = jacobian_of(p);
	if (jacobian) {
		jacobian(p, d->t, d->y, d->Jq, d->Jv);
		return;
	}
	memcpy(moved, d->y, (size_t)a->size * sizeof *moved);
	for (int j = 0; j < a->size; j++) {
		volatile double sum = d->y[j] + sqrt(DBL_EPSILON) * (a->scale[j] + fabs(d->y[j]));
		moved[j] = sum;
		slope(a, d->t, moved, f);
		for (int i = 0; i < n; i++)
			(j < n ? d->Jq : d->Jv)[i * n + j % n] = (f[n + i] - d->slope[n + i]) / (sum - d->y[j]);
		moved[j] = d->y[j];
	}
}

#define COORDINATES d->adaptive.n
#define EXTENT MOST_COORDINATES
#define SLOPES(t, y, f) ask(&d->adaptive, t, y, f)
#define JACOBIAN(t, y, Jq, Jv) other_jacobian(d)
#define ROWS_OF(ROW) EQUATIONS(ROW) ROW(beam4, BEAM_N) ROW(beam15, BEAM_N)
#endif

#define INSTANCE(part) other_##part
#include "radau_step.h"

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
