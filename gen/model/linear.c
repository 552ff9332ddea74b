/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Rational matrices, and linear systems of coordinates of first and second order. */
#include "plgen.h"

/* ---- rational matrices ---- */

void rational_product(int rows, int inner, int columns, const mpq_t *A, const mpq_t *B, mpq_t *AB)
{
	mpq_t product;
	mpq_init(product);
	for (int i = 0; i < rows * columns; i++)
		mpq_set_ui(AB[i], 0, 1);
	for (int i = 0; i < rows; i++)
		for (int k = 0; k < inner; k++)         /* by rows: most factors of large matrices are 0 */
			for (int j = 0; j < columns && mpq_sgn(A[i * inner + k]) != 0; j++) {
				if (mpq_sgn(B[k * columns + j]) == 0)
					continue;
				mpq_mul(product, A[i * inner + k], B[k * columns + j]);
				mpq_add(AB[i * columns + j], AB[i * columns + j], product);
			}
	mpq_clear(product);
}

void rational_subtract_row(int n, mpq_t *target, const mpq_t *row, mpq_srcptr factor)
{
	mpq_t product;
	mpq_init(product);
	for (int j = 0; j < n; j++) {
		if (mpq_sgn(row[j]) == 0)
			continue;
		mpq_mul(product, row[j], factor);
		mpq_sub(target[j], target[j], product);
	}
	mpq_clear(product);
}

/* Gauss and Jordan on [A | I]. */
bool rational_inverse(int n, const mpq_t *A, mpq_t *inverse, int *column)
{
	int width = 2 * n;
	mpq_t *W = rationals((size_t)(n * width)), pivot;
	mpq_init(pivot);
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++)
			mpq_set(W[i * width + j], A[i * n + j]);
		mpq_set_ui(W[i * width + n + i], 1, 1);
	}
	for (int k = 0; k < n; k++) {
		int row = k;
		while (row < n && mpq_sgn(W[row * width + k]) == 0)
			row++;
		if (row == n) {
			*column = k;
			mpq_clear(pivot);
			rationals_free(W, (size_t)(n * width));
			return false;
		}
		for (int j = 0; j < width; j++)
			mpq_swap(W[row * width + j], W[k * width + j]);
		mpq_inv(pivot, W[k * width + k]);
		for (int j = 0; j < width; j++)
			mpq_mul(W[k * width + j], W[k * width + j], pivot);
		for (int i = 0; i < n; i++) {
			mpq_set(pivot, W[i * width + k]);
			if (i != k && mpq_sgn(pivot) != 0)
				rational_subtract_row(width, W + i * width, (const mpq_t *)W + k * width, pivot);
		}
	}
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			mpq_set(inverse[i * n + j], W[i * width + n + j]);
	mpq_clear(pivot);
	rationals_free(W, (size_t)(n * width));
	return true;
}

/* ---- systems ---- */

struct linear linear_like(const struct linear *shape)
{
	struct linear system = *shape;
	size_t cells = (size_t)shape->n * (size_t)shape->n;
	system.M = rationals(cells);
	system.C = rationals(cells);
	system.K = rationals(cells);
	system.heldC = system.heldK = NULL;
	system.loads = 0;
	system.inputs = 0;
	system.load = NULL;
	system.channels = 0;
	return system;
}

/* x' = A x as coordinates of first order */
struct linear first_order_system(int n, const mpq_t *A)
{
	struct linear shape = { .n = n, .states = n, .segments = 1, .velocity = ARRAY(int, (size_t)n), .coord = ARRAY(int, (size_t)n) };
	for (int i = 0; i < n; i++) {
		shape.velocity[i] = -1;
		shape.coord[i] = i;
	}
	struct linear system = linear_like(&shape);
	for (int i = 0; i < n; i++) {
		mpq_set_ui(system.C[i * n + i], 1, 1);
		for (int j = 0; j < n; j++)
			mpq_neg(system.K[i * n + j], A[i * n + j]);
	}
	return system;
}

bool leading_inverse(const struct linear *system, mpq_t *inverse, int *column)
{
	int n = system->n;
	mpq_t *W = rationals((size_t)n * (size_t)n);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < n; j++)
			mpq_set(W[i * n + j], (system->velocity[j] >= 0 ? system->M : system->C)[i * n + j]);
	bool regular = rational_inverse(n, (const mpq_t *)W, inverse, column);
	rationals_free(W, (size_t)n * (size_t)n);
	return regular;
}

/* What multiplies a state in the equations; with the held terms of a scheme, or only those. */
static mpq_srcptr factor_of_state(const struct linear *system, int row, int state, bool held)
{
	const mpq_t *K = held ? system->heldK : system->K, *C = held ? system->heldC : system->C;
	return (state < system->n ? K : C)[row * system->n + system->coord[state]];
}

void highest_derivatives(const struct linear *system, const mpq_t *inverse, bool held, mpq_t *row)
{
	int n = system->n, states = system->states;
	mpq_t *lower = rationals((size_t)n * (size_t)states);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < states; j++)
			mpq_neg(lower[i * states + j], factor_of_state(system, i, j, held));
	rational_product(n, n, states, inverse, (const mpq_t *)lower, row);
	rationals_free(lower, (size_t)n * (size_t)states);
}

/* x' = A x over the states (held terms: those that a scheme holds, alone) */
mpq_t *state_matrix(const struct linear *system, bool held)
{
	int n = system->n, states = system->states, column;
	mpq_t *A = rationals((size_t)states * (size_t)states), *inverse = rationals((size_t)n * (size_t)n);
	mpq_t *highest = rationals((size_t)n * (size_t)states);
	leading_inverse(system, inverse, &column);
	highest_derivatives(system, (const mpq_t *)inverse, held, highest);
	for (int i = 0; i < n; i++) {
		int state = system->velocity[i] >= 0 ? system->velocity[i] : i;
		for (int j = 0; j < states; j++)
			mpq_set(A[state * states + j], highest[i * states + j]);
		if (system->velocity[i] >= 0 && !held)
			mpq_set_ui(A[i * states + system->velocity[i]], 1, 1);
	}
	rationals_free(inverse, (size_t)n * (size_t)n);
	rationals_free(highest, (size_t)n * (size_t)states);
	return A;
}
