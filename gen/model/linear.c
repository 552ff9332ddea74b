/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear systems of coordinates of first and second order. */
#include "model/model.h"

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
	struct linear shape = { .n = n,
				.states = n,
				.segments = 1,
				.velocity = ARRAY(int, n),
				.coord = ARRAY(int, n) };
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

static mpq_t *leading_matrix(const struct linear *system)
{
	size_t n = (size_t)system->n;
	mpq_t *W = rationals(n * n);
	for (size_t i = 0; i < n * n; i++)
		mpq_set(W[i], (system->velocity[i % n] >= 0 ? system->M : system->C)[i]);
	return W;
}

/* The last one is kept: most stages ask for that of the same masses. */
bool leading_inverse(const struct linear *system, mpq_t *inverse, int *column)
{
	static struct { int n; mpq_t *W, *inverse; } last;
	size_t cells = (size_t)system->n * (size_t)system->n;
	mpq_t *W = leading_matrix(system);
	bool known = last.n == system->n && rationals_equal(cells, last.W, W);
	if (!known && !rational_inverse(system->n, W, inverse, column)) {
		rationals_free(W, cells);
		return false;
	}
	if (known) {
		for (size_t i = 0; i < cells; i++)
			mpq_set(inverse[i], last.inverse[i]);
		rationals_free(W, cells);
		return true;
	}
	if (last.n > 0) {
		rationals_free(last.W, (size_t)last.n * (size_t)last.n);
		rationals_free(last.inverse, (size_t)last.n * (size_t)last.n);
	}
	last.n = system->n;
	last.W = W;
	last.inverse = rationals_copied(cells, inverse);
	return true;
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
	RATIONALS *lower = rationals((size_t)n * (size_t)states);
	for (int i = 0; i < n; i++)
		for (int j = 0; j < states; j++)
			mpq_neg(lower[i * states + j], factor_of_state(system, i, j, held));
	rational_product(n, n, states, inverse, lower, row);
}

/* x' = A x over the states (held terms: those that a scheme holds, alone) */
mpq_t *state_matrix(const struct linear *system, bool held)
{
	int n = system->n, states = system->states, column;
	RATIONALS *inverse = rationals((size_t)n * (size_t)n);
	mpq_t *A = rationals((size_t)states * (size_t)states);
	RATIONALS *highest = rationals((size_t)n * (size_t)states);
	leading_inverse(system, inverse, &column);
	highest_derivatives(system, inverse, held, highest);
	for (int i = 0; i < n; i++) {
		int state = system->velocity[i] >= 0 ? system->velocity[i] : i;
		for (int j = 0; j < states; j++)
			mpq_set(A[state * states + j], highest[i * states + j]);
		if (system->velocity[i] >= 0 && !held)
			mpq_set_ui(A[i * states + system->velocity[i]], 1, 1);
	}
	return A;
}

int load_columns(const struct linear *system)
{
	int columns = 0;
	for (int l = 0; l < system->loads; l++)
		columns += system->load[l].columns;
	return columns;
}

int input_columns(const struct linear *system)
{
	int columns = 0;
	for (int i = 0; i < system->inputs; i++)
		columns += system->input[i].hold + 1;
	return columns;
}

bool load_acts(const struct linear *system, const struct load *load)
{
	for (int k = 0; k < load->columns; k++)
		for (int i = 0; i < system->segments * system->n; i++)
			if (mpq_sgn(load->force[k][i]) != 0)
				return true;
	return false;
}

bool is_constant_column(const struct linear *system, int column)
{
	for (int l = 0; l < system->loads && column >= 0; column -= system->load[l++].columns)
		if (column == 0 && is_polynomial(system->load[l].wave))
			return true;
	return false;
}
