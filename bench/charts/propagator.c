/* SPDX-License-Identifier: GPL-3.0-or-later
 *
 * Linear problems by what everyone can do with a library: a matrix exponential computed once and multiplied with the
 * state at each step, and modal superposition. Loads are states of their own, so both act on
 *
 *     z = y, 1, cos w t, sin w t        z' = [A b0 b1 b2; 0; 0 0 0 -w; 0 0 w 0] z
 *
 * of which what a problem does not have is left out. A step is unit/k for an integer k; `between` is as exact as a
 * step. The matrix is applied by a loop, by code for its size, by code that has its entries as constants, by a
 * library, and in float.
 */
#include <dlfcn.h>
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_cblas.h>
#include <gsl/gsl_complex_math.h>
#include <gsl/gsl_eigen.h>
#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include "charts.h"

enum { MOST_LOADS = 3 };

struct propagator {
	struct run run;
	int own, size;              /* entries of y, and of z */
	int steps;                  /* in a unit */
	double h;
	long units;                 /* gone since the start */
	bool failed;
	double *generator;          /* size x size, row-major: z' = generator z */
	double *start;              /* z at t = 0 */
	double *z, *spare;
	double *Phi;                /* e^{generator h} */
	double *part, part_length;  /* `between`: the same for a part of a step */
	struct modes *modes;        /* modal superposition, or NULL */
	double *ahead;              /* `between`: z ahead of now */
	void *code;                 /* literals: its object */
	void (*literals)(double *z, long units, double *rows);
	void (*literals_single)(float *z, long units, float *rows);
	float *single;              /* in float, or NULL: Phi, then z, then room for the next z */
	float *row;                 /* rows on their way to double */
	int rows;                   /* room in row */
};

/* ---- the augmented system ---- */

static bool any(int count, const double *x)
{
	for (int i = 0; x && i < count; i++)
		if (x[i] != 0.0)
			return true;
	return false;
}

static bool is_pushed(const struct problem *p)
{
	return any(2 * p->n, p->b0);
}

static bool is_shaken(const struct problem *p)
{
	return p->w != 0.0 && (any(2 * p->n, p->b1) || any(2 * p->n, p->b2));
}

static void set_column(struct propagator *r, int column, const double *b)
{
	for (int i = 0; i < r->own; i++)
		r->generator[i * r->size + column] = b[i];
}

static void augment(struct propagator *r)
{
	const struct problem *p = r->run.problem;
	int next = r->own, size = r->size;
	for (int i = 0; i < r->own; i++)
		memcpy(r->generator + i * size, p->A + i * r->own, (size_t)r->own * sizeof *p->A);
	memcpy(r->start, p->start, (size_t)r->own * sizeof *p->start);
	if (is_pushed(p)) {
		set_column(r, next, p->b0);
		r->start[next++] = 1.0;
	}
	if (is_shaken(p)) {
		set_column(r, next, p->b1);
		set_column(r, next + 1, p->b2);
		r->generator[next * size + next + 1] = -p->w;
		r->generator[(next + 1) * size + next] = p->w;
		r->start[next] = 1.0;
	}
}

static void exponential(int size, const double *generator, double length, double *result)
{
	pade_exponential(size, generator, length, result);
}

/* GSL's own, which loses more in squaring: its Taylor series takes a shorter part than it needs */
static void gsl_exponential(int entries, const double *generator, double length, double *result)
{
	const size_t size = (size_t)entries;
	double *scaled = calloc(size * size, sizeof *scaled);
	for (size_t i = 0; scaled && i < size * size; i++)
		scaled[i] = length * generator[i];
	gsl_matrix_view from = gsl_matrix_view_array(scaled, size, size),
		to = gsl_matrix_view_array(result, size, size);
	if (!scaled || gsl_linalg_exponential_ss(&from.matrix, &to.matrix, GSL_PREC_DOUBLE) != GSL_SUCCESS)
		for (size_t i = 0; i < size * size; i++)
			result[i] = NAN;
	free(scaled);
}

/* ---- a step as a plain loop ---- */

/* spare <- matrix z; nothing acts on the loads but themselves */
static inline void multiply(int own, int size, const double *restrict matrix, const double *restrict z,
                            double *restrict spare)
{
	for (int i = 0; i < own; i++) {
		double sum = 0.0;
		for (int j = 0; j < size; j++)
			sum += matrix[i * size + j] * z[j];
		spare[i] = sum;
	}
	for (int i = own; i < size; i++) {
		double sum = 0.0;
		for (int j = own; j < size; j++)
			sum += matrix[i * size + j] * z[j];
		spare[i] = sum;
	}
}

static void loop_unit(struct propagator *r)
{
	double *z = r->z, *next = r->spare;
	for (int k = 0; k < r->steps; k++) {
		multiply(r->own, r->size, r->Phi, z, next);
		double *before = z;
		z = next;
		next = before;
	}
	r->z = z;
	r->spare = next;
}

/* The size is known when this is compiled, and the loops are unrolled: the matrix stays in reach, the state in
 * registers */
enum { FOUR = 4 };
static inline void fixed_size_step(const double *restrict Phi, double *restrict z)
{
	double next[FOUR];
#pragma GCC unroll 4
	for (int i = 0; i < FOUR; i++) {
		next[i] = Phi[i * FOUR] * z[0];
#pragma GCC unroll 4
		for (int j = 1; j < FOUR; j++)
			next[i] += Phi[i * FOUR + j] * z[j];
	}
#pragma GCC unroll 4
	for (int i = 0; i < FOUR; i++)
		z[i] = next[i];
}

static void dgemv_unit(struct propagator *r)
{
	for (int k = 0; k < r->steps; k++) {
		double *z = r->z;
		cblas_dgemv(CblasRowMajor, CblasNoTrans, r->size, r->size, 1.0, r->Phi, r->size, z, 1, 0.0, r->spare,
		            1);
		r->z = r->spare;
		r->spare = z;
	}
}

/* ---- modal superposition ----
 *
 * y = W x, where W^-1 A W falls into blocks: of a classically damped system a pair of columns (phi; 0), (0; phi) for
 * each real mode phi of M^-1 K, otherwise the real and the imaginary part of each eigenvector of A. A block with its
 * loads is advanced by its own exponential, so a rigid body, critical damping and resonance are nothing special; where
 * eigenvectors are missing (W singular to rounding) what comes out is what nearly dependent columns give. */

enum { ROW = 2 + MOST_LOADS, BLOCK = 2 * ROW };

struct modes {
	int blocks;
	int *first, *order;         /* of a block in x: where, and 1 or 2 */
	double *shapes, *inverse;   /* W, its inverse */
	double *diagonal;           /* W^-1 A W */
	double *loads;              /* W^-1 of their columns: own x loads */
	double *x, *start;
	/* of each block two rows: of its exponential over a step 2 entries, then those of the loads */
	double *table;
	double *part, part_length;  /* `between`: the same for another length */
};

static void times(int n, const double *a, const double *b, double *product)
{
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++) {
			double sum = 0.0;
			for (int k = 0; k < n; k++)
				sum += a[i * n + k] * b[k * n + j];
			product[i * n + j] = sum;
		}
}

/* Eigenvectors of a size x size matrix, which is used up; of real matrices complex ones stand in pairs */
static bool eigen(int size, double *matrix, gsl_vector_complex *values, gsl_matrix_complex *vectors)
{
	gsl_eigen_nonsymmv_workspace *work = gsl_eigen_nonsymmv_alloc((size_t)size);
	gsl_matrix_view view = gsl_matrix_view_array(matrix, (size_t)size, (size_t)size);
	bool good = work && gsl_eigen_nonsymmv(&view.matrix, values, vectors, work) == GSL_SUCCESS;
	gsl_eigen_nonsymmv_free(work);
	return good;
}

static void add_block(struct modes *m, int first, int order)
{
	m->first[m->blocks] = first;
	m->order[m->blocks++] = order;
}

static bool real_shapes(struct propagator *r, gsl_vector_complex *values, gsl_matrix_complex *vectors, double *matrix)
{
	const int n = r->run.problem->n, own = r->own;
	struct modes *m = r->modes;
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			matrix[i * n + j] = -r->run.problem->A[(n + i) * own + j];
	if (!eigen(n, matrix, values, vectors))
		return false;
	m->blocks = 0;
	memset(m->shapes, 0, (size_t)(own * own) * sizeof *m->shapes);
	for (int j = 0; j < n; j++) {
		if (GSL_IMAG(gsl_vector_complex_get(values, (size_t)j)) != 0.0)
			return false;
		add_block(m, 2 * j, 2);
		for (int i = 0; i < n; i++)
			m->shapes[i * own + 2 * j] = m->shapes[(n + i) * own + 2 * j +
			                                       1] = GSL_REAL(gsl_matrix_complex_get(vectors, (size_t)i,
			                                       (size_t)j));
	}
	return true;
}

static bool complex_shapes(struct propagator *r, gsl_vector_complex *values, gsl_matrix_complex *vectors,
                           double *matrix)
{
	const int own = r->own;
	struct modes *m = r->modes;
	memcpy(matrix, r->run.problem->A, (size_t)(own * own) * sizeof *matrix);
	if (!eigen(own, matrix, values, vectors))
		return false;
	m->blocks = 0;
	for (int j = 0, order; j < own; j += order) {
		order = GSL_IMAG(gsl_vector_complex_get(values, (size_t)j)) != 0.0 ? 2 : 1;
		add_block(m, j, order);
		for (int i = 0; i < own; i++) {
			gsl_complex entry = gsl_matrix_complex_get(vectors, (size_t)i, (size_t)j);
			m->shapes[i * own + j] = GSL_REAL(entry);
			if (order == 2)
				m->shapes[i * own + j + 1] = GSL_IMAG(entry);
		}
	}
	return true;
}

static bool invert(struct propagator *r, double *matrix)
{
	const size_t own = (size_t)r->own;
	gsl_permutation *order = gsl_permutation_alloc(own);
	gsl_matrix_view shapes = gsl_matrix_view_array(matrix, own, own),
		inverse = gsl_matrix_view_array(r->modes->inverse, own, own);
	int sign;
	memcpy(matrix, r->modes->shapes, own * own * sizeof *matrix);
	bool good = order && gsl_linalg_LU_decomp(&shapes.matrix, order, &sign) == GSL_SUCCESS &&
	            gsl_linalg_LU_invert(&shapes.matrix, order, &inverse.matrix) == GSL_SUCCESS;
	gsl_permutation_free(order);
	return good;
}

/* W^-1 A W; returns how large its entries outside the blocks are, relative to the largest */
static double diagonalise(struct propagator *r, double *matrix)
{
	struct modes *m = r->modes;
	const int own = r->own;
	double inside = 0.0, outside = 0.0;
	times(own, m->inverse, r->run.problem->A, matrix);
	times(own, matrix, m->shapes, m->diagonal);
	for (int i = 0; i < own * own; i++)
		inside = fmax(inside, fabs(m->diagonal[i]));
	for (int k = 0; k < m->blocks; k++)
		for (int i = m->first[k]; i < m->first[k] + m->order[k]; i++)
			for (int j = 0; j < own; j++)
				if (j < m->first[k] || j >= m->first[k] + m->order[k])
					outside = fmax(outside, fabs(m->diagonal[i * own + j]));
	return outside / inside;
}

static bool find_shapes(struct propagator *r)
{
	const size_t own = (size_t)r->own, n = own / 2;
	double *matrix = calloc(own * own, sizeof *matrix);
	gsl_vector_complex *values = gsl_vector_complex_alloc(own), *half = gsl_vector_complex_alloc(n);
	gsl_matrix_complex *vectors = gsl_matrix_complex_alloc(own, own), *quarter = gsl_matrix_complex_alloc(n, n);
	bool good = matrix && values && half && vectors && quarter;
	if (good && !(real_shapes(r, half, quarter, matrix) && invert(r, matrix) && diagonalise(r, matrix) < 1e-11))
		good = complex_shapes(r, values, vectors, matrix) && invert(r, matrix) &&
		       isfinite(diagonalise(r, matrix));
	gsl_vector_complex_free(values);
	gsl_vector_complex_free(half);
	gsl_matrix_complex_free(vectors);
	gsl_matrix_complex_free(quarter);
	free(matrix);
	return good;
}

static void project(struct propagator *r)
{
	struct modes *m = r->modes;
	const int own = r->own, loads = r->size - own;
	for (int i = 0; i < own; i++)
		for (int j = 0; j < own; j++) {
			m->start[i] += m->inverse[i * own + j] * r->start[j];
			for (int k = 0; k < loads; k++)
				m->loads[i * loads + k] += m->inverse[i * own + j] * r->generator[j * r->size + own +
					k];
		}
}

/* e^{B length} of a block of two in closed form, as textbooks have the oscillator's: with the mean m of its poles, C =
 * B - m I and C^2 = -w^2 I it is e^{m length} (cos(w length) I + sin(w length)/w C); without oscillation cosh and
 * sinh */
static void pair_exponential(const double b[4], double length, double *rows)
{
	const double mean = 0.5 * (b[0] + b[3]), half = 0.5 * (b[0] - b[3]), square = -half * half - b[1] * b[2];
	const double w = sqrt(fabs(square)), x = w * length, size = exp(mean * length);
	const double even = square > 0.0 ? cos(x) : cosh(x);
	const double odd = x < 1e-8 ? length : (square > 0.0 ? sin(x) : sinh(x)) / w;
	rows[0] = size * (even + odd * half);
	rows[1] = size * odd * b[1];
	rows[ROW] = size * odd * b[2];
	rows[ROW + 1] = size * (even - odd * half);
}

static void block_exponential(const struct propagator *r, int block, double length, double *rows)
{
	const struct modes *m = r->modes;
	const int order = m->order[block], first = m->first[block], loads = r->size - r->own, size = order + loads;
	double generator[ROW * ROW] = {0}, result[ROW * ROW];
	for (int i = 0; i < order; i++) {
		for (int j = 0; j < order; j++)
			generator[i * size + j] = m->diagonal[(first + i) * r->own + first + j];
		for (int j = 0; j < loads; j++)
			generator[i * size + order + j] = m->loads[(first + i) * loads + j];
	}
	for (int i = 0; i < loads; i++)
		for (int j = 0; j < loads; j++)
			generator[(order + i) * size + order + j] = r->generator[(r->own + i) * r->size + r->own + j];
	exponential(size, generator, length, result);
	for (int i = 0; i < order; i++) {
		memcpy(rows + i * ROW, result + i * size, (size_t)order * sizeof *rows);
		memcpy(rows + i * ROW + 2, result + i * size + order, (size_t)loads * sizeof *rows);
	}
	if (order == 2)
		pair_exponential((double[]){generator[0], generator[1], generator[size], generator[size + 1]}, length,
		                 rows);
}

static void fill_table(const struct propagator *r, double length, double *table)
{
	for (int k = 0; k < r->modes->blocks; k++)
		block_exponential(r, k, length, table + k * BLOCK);
}

static bool allot_modes(struct propagator *r)
{
	const size_t own = (size_t)r->own;
	struct modes *m = r->modes = calloc(1, sizeof *m);
	double *next = m ? calloc(3 * own * own + own * MOST_LOADS + 2 * own + 2 * own * BLOCK, sizeof *next) : NULL;
	if (!next)
		return false;
	m->shapes = next;
	m->inverse = next += own * own;
	m->diagonal = next += own * own;
	m->loads = next += own * own;
	m->x = next += own * MOST_LOADS;
	m->start = next += own;
	m->table = next += own;
	m->part = next + own * BLOCK;
	m->part_length = NAN;
	m->first = calloc(2 * own, sizeof *m->first);
	m->order = m->first + own;
	return m->first != NULL;
}

static void discard_modes(struct modes *m)
{
	if (m) {
		free(m->shapes);
		free(m->first);
	}
	free(m);
}

static bool find_modes(struct propagator *r)
{
	if (!allot_modes(r) || !find_shapes(r))
		return false;
	project(r);
	fill_table(r, r->h, r->modes->table);
	return true;
}

/* x <- what it is a step on, under loads as they are now */
static inline void move_modes(const struct propagator *r, const double *restrict table, const double *x,
                              const double *restrict load, double *after)
{
	const struct modes *m = r->modes;
	const int loads = r->size - r->own;
	for (int k = 0; k < m->blocks; k++, table += BLOCK) {
		const int i = m->first[k];
		double first, second = 0.0;
		if (m->order[k] == 2) {
			first = table[0] * x[i] + table[1] * x[i + 1];
			second = table[ROW] * x[i] + table[ROW + 1] * x[i + 1];
		} else {
			first = table[0] * x[i];
		}
		for (int j = 0; j < loads; j++) {
			first += table[2 + j] * load[j];
			second += table[ROW + 2 + j] * load[j];
		}
		after[i] = first;
		if (m->order[k] == 2)
			after[i + 1] = second;
	}
}

static inline void superpose(const struct propagator *r, const double *restrict x, double *restrict y)
{
	for (int i = 0; i < r->own; i++) {
		double sum = 0.0;
		for (int j = 0; j < r->own; j++)
			sum += r->modes->shapes[i * r->own + j] * x[j];
		y[i] = sum;
	}
}

static inline void move_loads(const struct propagator *r, double *load)
{
	const int loads = r->size - r->own;
	double next[MOST_LOADS];
	for (int i = 0; i < loads; i++) {
		next[i] = 0.0;
		for (int j = 0; j < loads; j++)
			next[i] += r->Phi[(r->own + i) * r->size + r->own + j] * load[j];
	}
	for (int i = 0; i < loads; i++)
		load[i] = next[i];
}

static void modal_unit(struct propagator *r)
{
	double *x = r->modes->x, *load = r->z + r->own;
	for (int k = 0; k < r->steps; k++) {
		move_modes(r, r->modes->table, x, load, x);
		move_loads(r, load);
	}
	superpose(r, x, r->z);
}

/* ---- the run as charts.h has it ---- */

static void propagator_restart(struct run *run)
{
	struct propagator *r = (struct propagator *)run;
	memcpy(r->z, r->start, (size_t)r->size * sizeof *r->z);
	if (r->modes)
		memcpy(r->modes->x, r->modes->start, (size_t)r->own * sizeof(double));
	r->units = 0;
	r->failed = false;
}

static bool all_finite(int size, const double *y)
{
	double zero = 0.0;
	for (int i = 0; i < size; i++)
		zero += 0.0 * y[i];
	return zero == 0.0;
}

static inline __attribute__((always_inline)) bool march(struct run *run, int units, double *rows,
                                                        void (*unit)(struct propagator *r))
{
	struct propagator *r = (struct propagator *)run;
	for (int u = 0; u < units && !r->failed; u++) {
		unit(r);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * r->own, r->z, (size_t)r->own * sizeof *rows);
	}
	r->units += units;
	r->failed = r->failed || !all_finite(r->own, r->z); /* what is not finite stays so: looked at once is enough */
	return !r->failed;
}

static bool loop_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, loop_unit);
}

/* The state stays in registers from one output to the next */
static bool fixed_size_advance(struct run *run, int units, double *rows)
{
	struct propagator *r = (struct propagator *)run;
	const int steps = r->steps;
	double z[FOUR];
	memcpy(z, r->z, sizeof z);
	for (int u = 0; u < units; u++) {
		for (int k = 0; k < steps; k++)
			fixed_size_step(r->Phi, z);
		if (rows)
			memcpy(rows + (ptrdiff_t)u * FOUR, z, sizeof z);
	}
	memcpy(r->z, z, sizeof z);
	r->units += units;
	r->failed = r->failed || !all_finite(FOUR, z);
	return !r->failed;
}

static bool dgemv_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, dgemv_unit);
}

static bool modal_advance(struct run *run, int units, double *rows)
{
	return march(run, units, rows, modal_unit);
}

static bool literals_advance(struct run *run, int units, double *rows)
{
	struct propagator *r = (struct propagator *)run;
	r->literals(r->z, units, rows);
	r->units += units;
	r->failed = r->failed || !all_finite(r->own, r->z);
	return !r->failed;
}

/* ---- in float: the matrix, the state and the rows ---- */

static float *single_state(const struct propagator *r)
{
	return r->single + r->size * r->size;
}

static void single_steps(struct propagator *r, int steps)
{
	const int own = r->own, size = r->size;
	const float *restrict Phi = r->single;
	float *restrict z = single_state(r), *restrict next = z + size;
	for (int k = 0; k < steps; k++) {
		for (int i = 0; i < size; i++) {
			float sum = 0;
			for (int j = i < own ? 0 : own; j < size; j++)
				sum += Phi[i * size + j] * z[j];
			next[i] = sum;
		}
		memcpy(z, next, (size_t)size * sizeof *z);
	}
}

/* Rows stay as the user of a float has them; the state goes to z, where the rest of this file looks for it */
static bool single_timed(struct run *run, int units)
{
	struct propagator *r = (struct propagator *)run;
	float *z = single_state(r);
	if (units > r->rows) {
		free(r->row);
		r->rows = units;
		r->row = calloc((size_t)units * (size_t)r->own, sizeof *r->row);
		if (!r->row)
			exit(1);
	}
	if (r->literals_single)
		r->literals_single(z, units, r->row);
	else
		for (int u = 0; u < units; u++) {
			single_steps(r, r->steps);
			memcpy(r->row + (ptrdiff_t)u * r->own, z, (size_t)r->own * sizeof *z);
		}
	for (int i = 0; i < r->size; i++)
		r->z[i] = z[i];
	r->units += units;
	r->failed = r->failed || !all_finite(r->own, r->z);
	return !r->failed;
}

static bool single_advance(struct run *run, int units, double *rows)
{
	enum { CHUNK = 1000 };
	struct propagator *r = (struct propagator *)run;
	for (int k = 0; k < units; k += CHUNK) {
		const int some = units - k < CHUNK ? units - k : CHUNK;
		single_timed(run, some);
		for (int i = 0; rows && i < some * r->own; i++)
			rows[k * r->own + i] = r->row[i];
	}
	return !r->failed;
}

static void single_restart(struct run *run)
{
	struct propagator *r = (struct propagator *)run;
	float *z = single_state(r);
	propagator_restart(run);
	for (int i = 0; i < r->size; i++)
		r->z[i] = z[i] = (float)r->start[i];
}

/* Whole steps, and the exponential of the rest (in double); what it needs for that is its own, or spare */
static void propagator_between(struct run *run, double fraction, double *y)
{
	struct propagator *r = (struct propagator *)run;
	const int whole = (int)floor(fraction * r->steps + 1e-9);
	const double rest = fraction * run->problem->unit - whole * r->h;
	const size_t bytes = (size_t)r->size * sizeof(double);
	double *ahead = r->ahead, *next = r->spare;
	if (rest != r->part_length)
		exponential(r->size, r->generator, r->part_length = rest, r->part);
	memcpy(ahead, r->z, bytes);
	for (int k = 0; k < whole; k++) {
		multiply(r->own, r->size, r->Phi, ahead, next);
		memcpy(ahead, next, bytes);
	}
	multiply(r->own, r->size, r->part, ahead, next);
	memcpy(y, next, (size_t)r->own * sizeof *y);
}

static void modal_between(struct run *run, double fraction, double *y)
{
	struct propagator *r = (struct propagator *)run;
	struct modes *m = r->modes;
	const double length = fraction * run->problem->unit;
	if (length != m->part_length)
		fill_table(r, m->part_length = length, m->part);
	move_modes(r, m->part, m->x, r->z + r->own, r->ahead);
	superpose(r, r->ahead, y);
}

static void propagator_get(const struct run *run, double *y)
{
	const struct propagator *r = (const struct propagator *)run;
	memcpy(y, r->z, (size_t)r->own * sizeof *y);
}

static long no_evaluations(const struct run *run)
{
	(void)run;
	return -1;
}

static void propagator_close(struct run *run)
{
	struct propagator *r = (struct propagator *)run;
	free(r->generator);
	free(r->start);
	free(r->z);
	free(r->spare);
	free(r->Phi);
	free(r->part);
	free(r->ahead);
	discard_modes(r->modes);
	free(r->single);
	free(r->row);
	if (r->code)
		dlclose(r->code);
	free(r);
}

static bool allot(struct propagator *r)
{
	const size_t size = (size_t)r->size;
	r->generator = calloc(size * size, sizeof(double));
	r->Phi = calloc(size * size, sizeof(double));
	r->part = calloc(size * size, sizeof(double));
	r->start = calloc(size, sizeof(double));
	r->z = calloc(size, sizeof(double));
	r->spare = calloc(size, sizeof(double));
	r->ahead = calloc(size, sizeof(double));
	return r->generator && r->Phi && r->part && r->start && r->z && r->spare && r->ahead;
}

typedef bool advance_function(struct run *run, int units, double *rows);

static struct run *propagator_open(const struct method *method, const struct problem *p, double setting,
                                   advance_function *advance)
{
	const double steps = round(p->unit / setting);
	if (!p->linear || !p->A || !(setting > 0.0) || !(steps >= 1.0 && steps <= 1e9) ||
	    setting > p->unit * (1.0 + 1e-9))
		return NULL;
	struct propagator *r = calloc(1, sizeof *r);
	if (!r)
		return NULL;
	gsl_set_error_handler_off();
	r->run = (struct run){.method = method, .problem = p, .setting = p->unit / steps, .restart = propagator_restart,
	                      .advance = advance,
	                      .between = propagator_between, .get = propagator_get, .evaluations = no_evaluations,
	                      .close = propagator_close};
	r->own = 2 * p->n;
	r->size = r->own + is_pushed(p) + 2 * is_shaken(p);
	r->steps = (int)steps;
	r->h = r->run.setting;
	r->part_length = NAN;
	if (!allot(r)) {
		propagator_close(&r->run);
		return NULL;
	}
	augment(r);
	exponential(r->size, r->generator, r->h, r->Phi);
	propagator_restart(&r->run);
	return &r->run;
}

static struct run *loop_open(const struct method *method, const struct problem *problem, double setting)
{
	return propagator_open(method, problem, setting, loop_advance);
}

static struct run *rounded_open(const struct method *method, const struct problem *problem, double setting)
{
	struct run *run = propagator_open(method, problem, setting, loop_advance);
	struct propagator *r = (struct propagator *)run;
	if (run)
		rounded_exponential(r->size, r->generator, r->h, r->Phi);
	return run;
}

static struct run *gsl_open(const struct method *method, const struct problem *problem, double setting)
{
	struct run *run = propagator_open(method, problem, setting, loop_advance);
	struct propagator *r = (struct propagator *)run;
	if (run)
		gsl_exponential(r->size, r->generator, r->h, r->Phi);
	return run;
}

static struct run *fixed_size_open(const struct method *method, const struct problem *problem, double setting)
{
	const bool four = 2 * problem->n == FOUR && !is_pushed(problem) && !is_shaken(problem);
	return four ? propagator_open(method, problem, setting, fixed_size_advance) : NULL;
}

static struct run *dgemv_open(const struct method *method, const struct problem *problem, double setting)
{
	return propagator_open(method, problem, setting, dgemv_advance);
}

/* Its matrix as it then is, as code; NULL, and closed, where that cannot be */
static struct run *with_literals(struct run *run)
{
	struct propagator *r = (struct propagator *)run;
	if (!run)
		return NULL;
	const struct literals l = { .own = r->own, .size = r->size, .steps = r->steps, .single = r->single != NULL,
	                            .Phi = r->Phi };
	r->code = literals_load(&l);
	void *advance = r->code ? dlsym(r->code, "advance") : NULL;
	if (!advance) {
		propagator_close(run);
		return NULL;
	}
	if (r->single)
		memcpy(&r->literals_single, &advance, sizeof advance);
	else
		memcpy(&r->literals, &advance, sizeof advance);
	return run;
}

static struct run *literals_open(const struct method *method, const struct problem *problem, double setting)
{
	return with_literals(propagator_open(method, problem, setting, literals_advance));
}

static struct run *rounded_literals_open(const struct method *method, const struct problem *problem, double setting)
{
	struct run *run = rounded_open(method, problem, setting);
	if (run)
		run->advance = literals_advance;
	return with_literals(run);
}

/* The matrix as it then is, rounded to float, and a state in float */
static struct run *in_float(struct run *run)
{
	struct propagator *r = (struct propagator *)run;
	if (!run)
		return NULL;
	const size_t size = (size_t)r->size;
	r->single = calloc(size * size + 2 * size, sizeof *r->single);
	if (!r->single) {
		propagator_close(run);
		return NULL;
	}
	for (size_t i = 0; i < size * size; i++)
		r->Phi[i] = r->single[i] = (float)r->Phi[i];
	run->restart = single_restart;
	run->advance = single_advance;
	run->timed = single_timed;
	single_restart(run);
	return run;
}

static struct run *loop_float_open(const struct method *method, const struct problem *problem, double setting)
{
	return in_float(loop_open(method, problem, setting));
}

static struct run *literals_float_open(const struct method *method, const struct problem *problem, double setting)
{
	return with_literals(in_float(rounded_open(method, problem, setting)));
}

static struct run *modal_open(const struct method *method, const struct problem *problem, double setting)
{
	struct run *run = propagator_open(method, problem, setting, modal_advance);
	if (!run)
		return NULL;
	run->between = modal_between;
	if (!find_modes((struct propagator *)run)) {
		propagator_close(run);
		return NULL;
	}
	run->restart(run);
	return run;
}

/* ---- the list ---- */

#define EXPONENTIAL \
	"e^{Ah} once by Pade's approximant of degree 13, scaling and squaring (Higham 2005), loads as states; "
#define ROUNDED "e^{Ah} once in long double, each entry then rounded to double"
#define AS_CODE "printed as C whose entries are constants, zeros left out; compiled as plgen's code is"
#define PROPAGATOR_METHOD(NAME, SETTINGS, OPEN) \
	{.name = NAME, .family = PROPAGATOR, .linear_only = true, .settings = SETTINGS, .open = OPEN}

static const struct method loop = PROPAGATOR_METHOD("exp(A h), loop",
                                                    EXPONENTIAL "applied by a double loop, size known at run time",
                                                    loop_open);
static const struct method by_gsl =
	PROPAGATOR_METHOD("exp(A h) by GSL, loop",
	                  "e^{Ah} once by gsl_linalg_exponential_ss, GSL_PREC_DOUBLE, loads as states; applied by a "
	                  "double loop, size known at run time", gsl_open);
static const struct method rounded =
	PROPAGATOR_METHOD("exp(A h) rounded, loop", ROUNDED "; applied by a double loop, size known at run time",
	                  rounded_open);
static const struct method fixed_size =
	PROPAGATOR_METHOD("exp(A h), fixed size",
	                  EXPONENTIAL "applied by a double loop, unrolled, size 4 known at compile time",
	                  fixed_size_open);
static const struct method literals =
	PROPAGATOR_METHOD("exp(A h), literals", EXPONENTIAL AS_CODE, literals_open);
static const struct method rounded_literals =
	PROPAGATOR_METHOD("exp(A h) rounded, literals", ROUNDED "; " AS_CODE, rounded_literals_open);
static const struct method dgemv =
	PROPAGATOR_METHOD("exp(A h), CBLAS",
	                  EXPONENTIAL "applied by cblas_dgemv of gslcblas, the CBLAS that comes with GSL", dgemv_open);
static const struct method modal =
	PROPAGATOR_METHOD("modal superposition",
	                  "gsl_eigen_nonsymmv: real modes where damping is classical, else complex; each advanced by "
	                  "its own exponential in closed form, loads by the exponential of the mode with "
	                  "them; output by the matrix of shapes", modal_open);

static const struct method loop_float =
	PROPAGATOR_METHOD("exp(A h), loop, float",
	                  EXPONENTIAL "each entry rounded to float; applied by a double loop in float, size known at "
	                              "run time",
	                  loop_float_open);
static const struct method literals_float =
	PROPAGATOR_METHOD("exp(A h) rounded, literals, float", ROUNDED " and to float; " AS_CODE, literals_float_open);

const struct method *const propagator_methods[] = {
	&loop, &by_gsl, &rounded, &fixed_size, &literals, &rounded_literals, &dgemv, &modal, &loop_float,
	&literals_float, NULL,
};
