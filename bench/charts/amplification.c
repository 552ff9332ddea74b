/* SPDX-License-Identifier: GPL-3.0-or-later */
#include "amplification.h"

#include <gsl/gsl_eigen.h>
#include <gsl/gsl_linalg.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

/* ---- a free motion as a problem ---- */

static void slope(const void *of, double t, const double y[], double dydt[])
{
	const struct free_motion *m = of;
	const int n = m->problem.n, size = 2 * n;
	for (int i = 0; i < size; i++) {
		double sum = 0;
		for (int j = 0; j < size; j++)
			sum += m->A[i * size + j] * y[j];
		dydt[i] = sum;
	}
	if (m->blow >= 0 && t <= 0)
		dydt[n + m->blow] += 1;
}

void free_motion_of(struct free_motion *m, const char *name, int n, const double *A)
{
	memset(m, 0, sizeof *m);
	memcpy(m->A, A, sizeof *A * (size_t)(4 * n * n));
	m->blow = -1;
	m->problem = (struct problem){.name = name, .n = n, .rhs_of = slope, .of = m, .start = m->start, .units = 1,
	                              .linear = true,
	                              .A = m->A, .b0 = m->none, .b1 = m->none, .b2 = m->none};
}

void free_oscillator(struct free_motion *m, double w, double zeta)
{
	const double A[] = {0, 1, -w * w, -2 * zeta * w};
	free_motion_of(m, "oscillator", 1, A);
}

/* ---- eigenvalues ---- */

static int by_modulus(const void *a, const void *b)
{
	const double x = cabs(*(const double complex *)a), y = cabs(*(const double complex *)b);
	return (x < y) - (x > y);
}

/* Of a 2 x 2 matrix without losing the smaller of two real ones, or the modulus of a pair */
static void of_two(const double *a, double complex *eigenvalue)
{
	const double half = (a[0] + a[3]) / 2, apart = (a[0] - a[3]) / 2;
	const double determinant = a[0] * a[3] - a[1] * a[2], below = apart * apart + a[1] * a[2];
	if (below < 0) {
		eigenvalue[0] = half + sqrt(-below) * I;
		eigenvalue[0] *= sqrt(determinant) / cabs(eigenvalue[0]);
		eigenvalue[1] = conj(eigenvalue[0]);
		return;
	}
	eigenvalue[0] = half + copysign(sqrt(below), half);
	eigenvalue[1] = eigenvalue[0] == 0 ? 0 : determinant / eigenvalue[0];
}

static void of_many(int size, const double *matrix, double complex *eigenvalue)
{
	const size_t n = (size_t)size;
	gsl_matrix *a = gsl_matrix_alloc(n, n);
	gsl_vector_complex *values = gsl_vector_complex_alloc(n);
	gsl_eigen_nonsymm_workspace *work = gsl_eigen_nonsymm_alloc(n);
	memcpy(a->data, matrix, n * n * sizeof *matrix);
	/* balanced: coordinates and velocities are of different sizes */
	gsl_eigen_nonsymm_params(0, 1, work);
	const bool good = gsl_eigen_nonsymm(a, values, work) == 0;
	for (size_t i = 0; i < n; i++) {
		const gsl_complex z = gsl_vector_complex_get(values, i);
		eigenvalue[i] = good ? GSL_REAL(z) + GSL_IMAG(z) * I : NAN;
	}
	gsl_eigen_nonsymm_free(work);
	gsl_vector_complex_free(values);
	gsl_matrix_free(a);
}

int eigenvalues_of(int size, const double *matrix, double complex *eigenvalue)
{
	for (int i = 0; i < size * size; i++)
		if (!isfinite(matrix[i]))
			return 0;
	if (size == 2)
		of_two(matrix, eigenvalue);
	else
		of_many(size, matrix, eigenvalue);
	for (int i = 0; i < size; i++)
		if (!isfinite(cabs(eigenvalue[i])))
			return 0;
	qsort(eigenvalue, (size_t)size, sizeof *eigenvalue, by_modulus);
	return size;
}

double largest(int count, const double complex *eigenvalue)
{
	return count > 0 ? cabs(eigenvalue[0]) : NAN;
}

double complex oscillation(int count, const double complex *eigenvalue, double wh)
{
	double complex best = NAN;
	for (int i = 0; i < count; i++)
		if (cimag(eigenvalue[i]) > 0 && !(cabs(best - cexp(I * wh)) <= cabs(eigenvalue[i] - cexp(I * wh))))
			best = eigenvalue[i];
	return best;
}

const char *const remainder_schemes[] = {"etd1", "etdrk2", "etdrk4", "nc2", "nc3", "dq4", "bm3"};

/* ---- of a method ---- */

enum { ASKED = 3, MOST_STARTS = MOST_EIGENVALUES };

struct answers {
	int size, starts;
	double y[ASKED + 1][MOST_STATES * MOST_STARTS];  /* after 0 .. 3 steps: size x starts */
};

/* From each unit state; then from rest with each unit blow, which a method that keeps accelerations starts with */
static bool ask(struct free_motion *m, const struct method *method, double h, bool blows, struct answers *a)
{
	const int n = m->problem.n, size = 2 * n, starts = blows ? 3 * n : size;
	bool good = true;
	m->problem.unit = h;
	struct run *run = method->open(method, &m->problem, h);
	*a = (struct answers){.size = size, .starts = starts};
	for (int j = 0; j < starts && run && good; j++) {
		double rows[ASKED * MOST_STATES];
		memset(m->start, 0, sizeof m->start);
		m->blow = j < size ? -1 : j - size;
		if (j < size)
			m->start[j] = 1;
		run->restart(run);
		good = run->advance(run, ASKED, rows);
		for (int i = 0; i < size; i++) {
			a->y[0][i * starts + j] = m->start[i];
			for (int k = 0; k < ASKED; k++)
				a->y[k + 1][i * starts + j] = rows[k * size + i];
		}
	}
	m->blow = -1;
	if (run)
		run->close(run);
	return run && good;
}

/* Is the state all that goes from one step to the next?  Then two steps are the square of one. */
static bool is_all(const struct answers *a)
{
	const int size = a->size;
	double most = 0, off = 0;
	for (int i = 0; i < size; i++)
		for (int j = 0; j < size; j++) {
			double sum = 0, sizes = 0;
			for (int k = 0; k < size; k++) {
				const double term = a->y[1][i * size + k] * a->y[1][k * size + j];
				sum += term;
				sizes += fabs(term);
			}
			off = fmax(off, fabs(sum - a->y[2][i * size + j]));
			most = fmax(most, sizes);
		}
	return off <= 1e-11 * most;
}

/* What goes on is the state and accelerations, z, of which only the states are seen: Y_k = (I 0) P^k Z.  H0 = (Y_0;
 * Y_1) and H1 = (Y_1; Y_2) are one matrix of observation times Z and P Z, so P is similar to the least squares
 * solution of H0 P = H1 (the realization of Ho and Kalman, 1966). */
static int with_accelerations(const struct answers *a, double complex *eigenvalue)
{
	const size_t rows = 2 * (size_t)a->size, columns = (size_t)a->starts, half = (size_t)a->size * columns;
	double P[MOST_EIGENVALUES * MOST_EIGENVALUES];
	gsl_matrix *H0 = gsl_matrix_alloc(rows, columns);
	gsl_vector *tau = gsl_vector_alloc(columns), *x = gsl_vector_alloc(columns), *b = gsl_vector_alloc(rows),
		*rest = gsl_vector_alloc(rows);
	memcpy(H0->data, a->y[0], half * sizeof *H0->data);
	memcpy(H0->data + half, a->y[1], half * sizeof *H0->data);
	gsl_linalg_QR_decomp(H0, tau);
	for (size_t j = 0; j < columns; j++) {
		for (size_t i = 0; i < rows; i++)
			gsl_vector_set(b, i, i < rows / 2 ? a->y[1][i * columns + j]
			               : a->y[2][(i - rows / 2) * columns + j]);
		gsl_linalg_QR_lssolve(H0, tau, b, x, rest);
		for (size_t i = 0; i < columns; i++)
			P[i * columns + j] = gsl_vector_get(x, i);
	}
	gsl_vector_free(rest);
	gsl_vector_free(b);
	gsl_vector_free(x);
	gsl_vector_free(tau);
	gsl_matrix_free(H0);
	return eigenvalues_of(a->starts, P, eigenvalue);
}

int amplification(struct free_motion *m, const struct method *method, double h, double complex *eigenvalue)
{
	struct answers a;
	if (!ask(m, method, h, false, &a))
		return 0;
	if (is_all(&a))
		return eigenvalues_of(a.size, a.y[1], eigenvalue);
	return ask(m, method, h, true, &a) ? with_accelerations(&a, eigenvalue) : 0;
}

/* ---- of ours ---- */

/* Of the linear system that is asked for */
static struct { int size; real A[MOST_STATES * MOST_STATES], exact[MOST_STATES * MOST_STATES]; } by_hand;

static void linear_equations(real t, const real *y, const real *u, real *dydt)
{
	(void)t, (void)u;
	for (int i = 0; i < by_hand.size; i++) {
		dydt[i] = 0;
		for (int j = 0; j < by_hand.size; j++)
			dydt[i] += by_hand.A[i * by_hand.size + j] * y[j];
	}
}

static void linear_operator(const struct system *s, int which, real *A)
{
	(void)which;
	memcpy(A, by_hand.exact, sizeof *A * (size_t)(s->states * s->states));
}

int amplification_by_hand(int size, const real *A, const real *exact, const char *scheme, double h,
						  double complex *eigenvalue)
{
	const bool flow = strcmp(scheme, "flow") == 0, pl = strcmp(scheme, "pl") == 0;
	const struct system system = {.name = scheme, .states = size, .equations = linear_equations,
	                              .linear = linear_operator}, *s = &system;
	double matrix[MOST_STATES * MOST_STATES];
	by_hand.size = size;
	for (int i = 0; i < size * size; i++) {
		by_hand.A[i] = A[i];
		by_hand.exact[i] = pl && i / size % (size / 2) != i % (size / 2) ? 0 : exact[i];
	}
	struct hand *hand = hand_new(s, flow || pl ? "etd1" : scheme, (real)h);
	for (int j = 0; j < size; j++) {
		real y[HAND_MOST] = {0};
		y[j] = 1;
		if (!flow)
			hand_step(hand, 0, NULL, y);
		for (int i = 0; i < size; i++)
			matrix[i * size + j] = (double)(flow ? hand_flow(hand, 0)[i * size_of(s) + j] : y[i]);
	}
	hand_free(hand);
	return eigenvalues_of(size, matrix, eigenvalue);
}

int amplification_of_model(const pl_model *model, double size, double complex *eigenvalue)
{
	const int states = model->states;
	double matrix[MOST_STATES * MOST_STATES], at_rest[MOST_STATES], y[MOST_STATES];
	void *state = calloc(1, model->size);
	if (!state || states > MOST_STATES)
		abort();
	for (int j = -1; j < states; j++) {                     /* -1: what loads do alone */
		for (int i = 0; i < states; i++)
			y[i] = i == j ? size : 0;
		model->set(state, 0, y);
		model->step(state, NULL);
		model->get(state, j < 0 ? at_rest : y);
		for (int i = 0; i < states && j >= 0; i++)
			matrix[i * states + j] = (y[i] - at_rest[i]) / size;
	}
	free(state);
	return eigenvalues_of(states, matrix, eigenvalue);
}

/* ---- where stability ends ---- */

double boundary_between(growth_function *growth, const void *of, double from, double to, double limit)
{
	const bool stable = growth(of, from) <= limit;
	for (int i = 0; i < 60 && to - from > 1e-9 * from; i++) {
		const double middle = sqrt(from * to);
		if ((growth(of, middle) <= limit) == stable)
			from = middle;
		else
			to = middle;
	}
	return stable ? from : to;
}

double first_end(growth_function *growth, const void *of, double from, double to, double apart, double limit)
{
	if (!(growth(of, from) <= limit))
		return 0;
	for (double h = from; h < to; h *= apart)
		if (!(growth(of, h * apart) <= limit))
			return boundary_between(growth, of, h, h * apart, limit);
	return INFINITY;
}

/* ---- what is charted ---- */

int oscillator_eigenvalues(const struct subject *s, double wh, double complex *eigenvalue)
{
	struct free_motion m;
	if (!s->method) {
		const real ratio = strcmp(s->scheme, "flow") == 0 ? 1 : (real)s->ratio, damping = -2 * (real)s->zeta;
		return amplification_by_hand(2, (real[]){0, 1, -1, damping}, (real[]){0, 1, -ratio * ratio, damping},
		                             s->scheme, wh, eigenvalue);
	}
	free_oscillator(&m, 1, s->zeta);
	return amplification(&m, s->method, wh, eigenvalue);
}

double growth_of(const void *subject, double wh)
{
	double complex eigenvalue[MOST_EIGENVALUES];
	return largest(oscillator_eigenvalues(subject, wh, eigenvalue), eigenvalue);
}

/* From the growth per step */
static double change_of(double rho, double wh, bool periods)
{
	return fabs(rho - 1) <= NOT_GROWING ? 0 : periods ? expm1(2 * M_PI / wh * log(rho)) : rho - 1;
}

void map_row(const struct map *map, const char *name, growth_function *growth, const void *of, double across)
{
	const double limit = 1 + NOT_GROWING;
	double before = 0, wh_before = 0;
	int branch = 0;
	for (int i = 0; i < map->steps; i++) {
		const double wh = pow(10, -2 + map->decades * i / (map->steps - 1)), rho = growth(of, wh);
		if (isfinite(rho))
			fprintf(map->csv, "%s,%.6g,%.6g,%.6g,%.4g\n", name, wh, across, rho,
			        change_of(rho, wh, map->periods));
		else
			fprintf(map->csv, "%s,%.6g,%.6g,failed,failed\n", name, wh, across);
		const bool in_sight = !map->periods || fmin(before, rho) < 1 - NOT_GROWING;
		if (i > 0 && in_sight && (before <= limit) != (rho <= limit)) {
			fprintf(map->ends, map->periods ? "%s," : "%s,%d,", name, ++branch);
			fprintf(map->ends, "%.6g,%.6g\n", boundary_between(growth, of, wh_before, wh, limit), across);
		}
		before = rho;
		wh_before = wh;
	}
}

const struct method *charted_method(int i)
{
	static const char *const names[] = {"explicit Euler", "explicit trapezoid", "RK4", "central difference",
	                                    "implicit trapezoid", "Newmark", "generalized-alpha"};
	enum { NAMES = sizeof names / sizeof *names };
	return i == NAMES ? dormand_prince_fixed
	       : i <= NAMES + 1 ? method_find(i < NAMES ? names[i] : "GSL rk8pd (fixed step)") : NULL;
}

bool subject_at(int k, struct subject *s)
{
	const struct subject ours[] = {{"exact", NULL, "flow", 0, 0}, {"pl 0.1 in phase", NULL, "etd1", 0, sqrt(1.1)},
	                               {"pl 0.1 out of phase", NULL, "etd1", 0, sqrt(1.1 / 1.2)}};
	int methods = 0;
	while (methods <= k && charted_method(methods))
		methods++;
	*s = methods > k ? (struct subject){.name = charted_method(k)->name, .method = charted_method(k)}
		: ours[k - methods < 3 ? k - methods : 0];
	return k - methods < 3;
}

struct subject subject_named(const char *name, double zeta)
{
	struct subject s;
	for (int k = 0; subject_at(k, &s) && strcmp(s.name, name) != 0; k++)
		continue;
	s.zeta = zeta;
	return s;
}
