/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear systems of coordinates of first and second order. */
#include "linear.h"

bool loads_change(const struct linear *system)
{
	return system->segments > 1;
}

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
	system.force_columns = 0;
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

/* Most stages ask for that of the same masses. */
bool leading_inverse(const struct linear *system, mpq_t *inverse, int *column)
{
	static struct last_inverse last;
	RATIONALS *W = leading_matrix(system);
	const bool regular = inverse_kept(&last, system->n, W, column);
	for (int i = 0; i < system->n * system->n && regular; i++)
		mpq_set(inverse[i], last.inverse[i]);
	return regular;
}

mpq_t *inverse_of_leading(const struct linear *system)
{
	int column;
	mpq_t *inverse = rationals((size_t)system->n * (size_t)system->n);
	leading_inverse(system, inverse, &column);
	return inverse;
}

int highest_state(const struct linear *system, int coord)
{
	return system->velocity[coord] >= 0 ? system->velocity[coord] : coord;
}

mpq_t *slopes_by_force(const struct linear *system, const mpq_t *inverse, const mpq_t *force)
{
	RATIONALS *highest = rationals(system->n);
	mpq_t *slopes = rationals(system->states);
	rational_product(system->n, system->n, 1, inverse, force, highest);
	for (int i = 0; i < system->n; i++)
		mpq_swap(slopes[highest_state(system, i)], highest[i]);
	return slopes;
}

/* ---- forces ---- */

struct forces {                     /* of another system, to be mapped */
	const struct linear *other;
	int rows;
	force_map *map;
	const void *context;
};

static mpq_t *mapped(const struct forces *f, int segments, const mpq_t *force)
{
	mpq_t *to = rationals((size_t)segments * (size_t)f->rows);
	for (int s = 0; s < segments; s++)
		f->map(f->context, force + s * f->other->n, to + s * f->rows);
	return to;
}

void take_forces(struct linear *system, const struct linear *other, int rows, force_map *map, const void *context)
{
	const struct forces f = { other, rows, map, context };
	system->segments = other->segments;
	system->change = other->change;
	system->loads = other->loads;
	system->load = ARRAY(struct load, other->loads);
	for (int l = 0; l < other->loads; l++) {
		system->load[l] = other->load[l];
		system->load[l].force = ARRAY(mpq_t *, other->load[l].columns);
		for (int k = 0; k < other->load[l].columns; k++)
			system->load[l].force[k] = mapped(&f, other->segments, other->load[l].force[k]);
	}
	system->inputs = other->inputs;
	system->input = ARRAY(struct input, other->inputs);
	for (int i = 0; i < other->inputs; i++) {
		system->input[i] = other->input[i];
		for (int k = 0; k < 2; k++)
			system->input[i].force[k] = mapped(&f, 1, other->input[i].force[k]);
	}
	system->force_columns = other->force_columns;
	system->force_column = ARRAY(mpq_t *, other->force_columns);
	for (int e = 0; e < other->force_columns; e++)
		system->force_column[e] = mapped(&f, 1, other->force_column[e]);
}

/* ---- states ---- */

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
	int n = system->n, states = system->states;
	RATIONALS *inverse = inverse_of_leading(system), *highest = rationals((size_t)n * (size_t)states);
	mpq_t *A = rationals((size_t)states * (size_t)states);
	highest_derivatives(system, inverse, held, highest);
	for (int i = 0; i < n; i++) {
		int state = highest_state(system, i);
		for (int j = 0; j < states; j++)
			mpq_set(A[state * states + j], highest[i * states + j]);
		if (system->velocity[i] >= 0 && !held)
			mpq_set_ui(A[i * states + system->velocity[i]], 1, 1);
	}
	return A;
}

int column_of_load(const struct linear *system, int load)
{
	int column = 0;
	for (int l = 0; l < load; l++)
		column += system->load[l].columns;
	return column;
}

bool further_samples(const struct linear *system)
{
	bool any = false;
	for (int i = 0; i < system->inputs; i++)
		any = any || system->input[i].hold > 1;
	return any;
}

int load_columns(const struct linear *system)
{
	return column_of_load(system, system->loads);
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
		if (!rationals_zero((size_t)(system->segments * system->n), load->force[k]))
			return true;
	return false;
}

bool any_load_acts(const struct linear *system)
{
	bool acts = false;
	for (int l = 0; l < system->loads; l++)
		acts = acts || load_acts(system, &system->load[l]);
	return acts;
}

bool is_driven(const struct linear *system)
{
	return system->inputs > 0 || any_load_acts(system);
}

bool is_constant_column(const struct linear *system, int column)
{
	for (int l = 0; l < system->loads && column >= 0; column -= system->load[l++].columns)
		if (column == 0 && is_polynomial(system->load[l].forcing))
			return true;
	return false;
}

/* ---- what goes with a load ---- */

mpq_t *shifted_inverse(int m, const mpq_t *A, mpq_srcptr a, mpq_srcptr w)
{
	const int size = w ? 2 * m : m;
	int column;
	RATIONALS *shifted = rationals((size_t)size * (size_t)size);
	mpq_t *inverse = rationals((size_t)size * (size_t)size);
	for (int i = 0; i < size; i++) {
		mpq_t *row = shifted + i * size, *own = row + i / m * m;
		for (int j = 0; j < m; j++)
			mpq_neg(own[j], A[i % m * m + j]);
		mpq_add(own[i % m], own[i % m], a);
		if (w)
			(i < m ? mpq_set : mpq_neg)(row[(i + m) % size], w);
	}
	return rational_inverse(size, shifted, inverse, &column) ? inverse : NULL;
}

/* Of t^k from the highest k down: (a - A) P_k + w P_k' = B_k - (k + 1) P_{k+1} */
void solve_forced(int m, const mpq_t *shifted, const struct load *load, mpq_t *P)
{
	const int size = load->columns / load->powers * m;
	RATIONALS *right = rationals(size);
	RATIONAL above = ZERO;
	for (int k = load->powers - 1; k >= 0; k--) {
		mpq_t *here = P + k * size;
		mpq_set_si(above, k + 1, 1);
		for (int i = 0; i < size && k + 1 < load->powers; i++)
			rational_submul(here[i], above, here[size + i]);
		for (int i = 0; i < size; i++)
			mpq_swap(right[i], here[i]);
		rational_product(size, size, 1, shifted, right, here);
	}
}
