/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * A method with a fixed step turns the state of a linear system at the start of a step into that at its end by a
 * matrix, its amplification matrix (Bathe, Finite Element Procedures, section 9.4; Hughes, The Finite Element Method,
 * section 9.1). Its eigenvalues say all there is to say of a free motion: the largest modulus is the growth per step,
 * the argument the frequency that is seen. Here it is found by asking the method, the same one that other charts time.
 */
#ifndef AMPLIFICATION_H
#define AMPLIFICATION_H

#include "charts.h"
#include "hand.h"

#include <complex.h>

/* 2n of the systems looked at here, and 3n of a method that keeps accelerations: 12 */
enum { MOST_STATES = 8 };
enum { MOST_EIGENVALUES = 12 };
#define NOT_GROWING 1e-12               /* growth per step below 1 + this counts as none: rounding makes as much */

/* y' = A y, A 2n x 2n of a system of second order */
struct free_motion {
	struct problem problem;
	double A[MOST_STATES * MOST_STATES], start[MOST_STATES], none[MOST_STATES];
	int blow;                       /* a unit acceleration of this coordinate, at t = 0 alone; -1: none */
};
void free_motion_of(struct free_motion *m, const char *name, int n, const double *A);
void free_oscillator(struct free_motion *m, double w, double zeta);     /* x'' + 2 zeta w x' + w^2 x = 0 */
/* The schemes that have one */
enum { REMAINDER_SCHEMES = 7 };
extern const char *const remainder_schemes[REMAINDER_SCHEMES];

/* Both return how many eigenvalues there are, of falling modulus; 0: the method could not, or what it gave is not
 * finite. */
int eigenvalues_of(int size, const double *matrix, double complex *eigenvalue);
int amplification(struct free_motion *m, const struct method *method, double h, double complex *eigenvalue);
/* The same of the schemes by hand on y' = A y, of which the operator `exact` is exact and the rest the remainder;
 * scheme "flow": e^{exact h}; pl: etd1, exact but for what couples coordinates */
int amplification_by_hand(int size, const real *A, const real *exact, const char *scheme, double h,
						  double complex *eigenvalue);
/* And of generated code, whose step is linear or nearly so about 0: from unit states times `size` */
int amplification_of_model(const pl_model *model, double size, double complex *eigenvalue);
double largest(int count, const double complex *eigenvalue);            /* modulus; NAN where there is none */
/* The oscillation: of those above the real axis the one nearest to e^{i wh}, NAN where there is none */
double complex oscillation(int count, const double complex *eigenvalue, double wh);

/* The ends of stability between two settings `from` and `to`, from stable to unstable or back; bisection, settings on
 * a log scale */
typedef double growth_function(const void *of, double setting);         /* per step */
double boundary_between(growth_function *growth, const void *of, double from, double to, double limit);

/* The first of them from a setting up, looked for at settings by a factor `apart`; 0: not even there; infinite: none */
double first_end(growth_function *growth, const void *of, double from, double to, double apart, double limit);

/* What is charted of x'' + 2 zeta x' + x = 0: a method; or, where that is NULL, by hand `flow`, which is exact, or a
 * scheme whose operator has the frequency `ratio`, without damping */
struct subject {
	const char *name;
	const struct method *method;
	const char *scheme;
	double zeta, ratio;
};
int oscillator_eigenvalues(const struct subject *s, double wh, double complex *eigenvalue);
double growth_of(const void *subject, double wh);
/* A row of a map: the growth at `steps` w h from 0.01 to 10^decades times that, and where it passes 1; `across` is what
 * the rows are over. periods: growth is that within a true period, and an end is none where weak growth has only come
 * in sight. Branches of the ends are counted where they are not. */
struct map { FILE *csv, *ends; int steps; double decades; bool periods; };
void map_row(const struct map *map, const char *name, growth_function *growth, const void *of, double across);

/* what is charted, from i = 0: fixed_methods, dormand_prince_fixed and rk8pd at a fixed step; NULL at the end */
const struct method *charted_method(int i);

/* The k-th of these; then exact; then scheme pl in the two modes of equal masses with k2/k1 = 0.1, where it is etd1
 * with an operator of own frequency sqrt(k1 + k2) beside the true sqrt(k1) (in phase) and sqrt(k1 + 2 k2) (out of
 * phase). false: none */
bool subject_at(int k, struct subject *s);
struct subject subject_named(const char *name, double zeta);

#endif
