/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Modal superposition: y = W x, where W^-1 A W falls into blocks: of a classically damped system a pair of columns
 * (phi; 0), (0; phi) for each real mode phi of M^-1 K, otherwise the real and the imaginary part of each eigenvector
 * of A. A block with its loads is advanced by its own exponential, so a rigid body, critical damping and resonance are
 * nothing special; where eigenvectors are missing (W singular to rounding) what comes out is what nearly dependent
 * columns give. */
#include <math.h>
#include <stdlib.h>
#include <string.h>

#include <gsl/gsl_errno.h>
#include <gsl/gsl_linalg.h>

#include "eigen.h"
#include "propagator.h"

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

static void add_block(struct modes *m, int first, int order)
{
	m->first[m->blocks] = first;
	m->order[m->blocks++] = order;
}

static bool real_shapes(struct propagator *r, double *matrix)
{
	const int n = r->run.problem->n, own = r->own;
	struct modes *m = r->modes;
	double complex value[n], vector[n * n];
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			matrix[i * n + j] = -r->run.problem->A[(n + i) * own + j];
	if (!eigenvectors(n, matrix, value, vector))
		return false;
	m->blocks = 0;
	memset(m->shapes, 0, (size_t)(own * own) * sizeof *m->shapes);
	for (int j = 0; j < n; j++) {
		if (cimag(value[j]) != 0.0)
			return false;
		add_block(m, 2 * j, 2);
		for (int i = 0; i < n; i++)
			m->shapes[i * own + 2 * j] = m->shapes[(n + i) * own + 2 * j + 1] = creal(vector[i * n + j]);
	}
	return true;
}

static bool complex_shapes(struct propagator *r, double *matrix)
{
	const int own = r->own;
	struct modes *m = r->modes;
	double complex value[own], vector[own * own];
	memcpy(matrix, r->run.problem->A, (size_t)(own * own) * sizeof *matrix);
	if (!eigenvectors(own, matrix, value, vector))
		return false;
	m->blocks = 0;
	for (int j = 0, order; j < own; j += order) {
		order = cimag(value[j]) != 0.0 ? 2 : 1;
		add_block(m, j, order);
		for (int i = 0; i < own; i++) {
			m->shapes[i * own + j] = creal(vector[i * own + j]);
			if (order == 2)
				m->shapes[i * own + j + 1] = cimag(vector[i * own + j]);
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
	matrix_product(own, m->inverse, r->run.problem->A, matrix);
	matrix_product(own, matrix, m->shapes, m->diagonal);
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
	double matrix[r->own * r->own];
	return (real_shapes(r, matrix) && invert(r, matrix) && diagonalise(r, matrix) < 1e-11) ||
	       (complex_shapes(r, matrix) && invert(r, matrix) && isfinite(diagonalise(r, matrix)));
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
	pade_exponential(size, generator, length, result);
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

void modes_discard(struct modes *m)
{
	if (m) {
		free(m->shapes);
		free(m->first);
	}
	free(m);
}

bool modes_find(struct propagator *r)
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

void modal_unit(struct propagator *r)
{
	double *x = r->modes->x, *load = r->z + r->own;
	for (int k = 0; k < r->steps; k++) {
		move_modes(r, r->modes->table, x, load, x);
		move_loads(r, load);
	}
	superpose(r, x, r->z);
}

void modes_restart(struct propagator *r)
{
	memcpy(r->modes->x, r->modes->start, (size_t)r->own * sizeof(double));
}

void modal_between(struct run *run, double fraction, double *y)
{
	struct propagator *r = (struct propagator *)run;
	struct modes *m = r->modes;
	const double length = fraction * run->problem->unit;
	if (length != m->part_length)
		fill_table(r, m->part_length = length, m->part);
	move_modes(r, m->part, m->x, r->z + r->own, r->ahead);
	superpose(r, r->ahead, y);
}
