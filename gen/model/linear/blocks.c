/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Coordinates that do not influence each other, in either direction, are separate systems: each has its own B(s), and
 * the factors between them are exactly 0. */
#include "linear.h"

/* Equations 0 .. n-1 and coordinates n .. 2n-1 as nodes of one graph; parent pointers of its components. */
static int *components(const struct linear *system)
{
	int n = system->n, *parent = numbers_up_to(2 * n);
	const mpq_t *matrix[] = { system->M, system->C, system->K, system->heldC, system->heldK };
	for (int k = 0; k < 5; k++)
		for (int cell = 0; matrix[k] && cell < n * n; cell++)
			if (mpq_sgn(matrix[k][cell]) != 0)
				join_nodes(parent, cell / n, n + cell % n);
	return parent;
}

static mpq_t *submatrix(const mpq_t *A, int n, const struct block *b)
{
	mpq_t *part = A ? rationals((size_t)b->system.n * (size_t)b->system.n) : NULL;
	for (int i = 0; A && i < b->system.n; i++)
		for (int j = 0; j < b->system.n; j++)
			mpq_set(part[i * b->system.n + j], A[b->equation[i] * n + b->coord[j]]);
	return part;
}

static void pick_equations(const void *context, const mpq_t *force, mpq_t *part)
{
	const struct block *b = context;
	for (int i = 0; i < b->system.n; i++)
		mpq_set(part[i], force[b->equation[i]]);
}

static void number_states(const struct linear *full, struct block *b)
{
	struct linear *system = &b->system;
	size_t n = (size_t)system->n;
	system->velocity = ARRAY(int, n);
	system->coord = ARRAY(int, 2 * n);
	b->state = ARRAY(int, 2 * n);
	system->states = system->n;
	for (int j = 0; j < system->n; j++) {
		system->coord[j] = j;
		b->state[j] = b->coord[j];
		system->velocity[j] = -1;
	}
	for (int j = 0; j < system->n; j++) {
		if (full->velocity[b->coord[j]] < 0)
			continue;
		system->velocity[j] = system->states;
		system->coord[system->states] = j;
		b->state[system->states++] = full->velocity[b->coord[j]];
	}
}

static void restrict_system(const struct linear *full, struct block *b)
{
	struct linear *system = &b->system;
	int n = full->n;
	number_states(full, b);
	system->M = submatrix(full->M, n, b);
	system->C = submatrix(full->C, n, b);
	system->K = submatrix(full->K, n, b);
	system->heldC = submatrix(full->heldC, n, b);
	system->heldK = submatrix(full->heldK, n, b);
	take_forces(system, full, system->n, pick_equations, b);
}

struct block block_at(const struct linear *system, int *parent, int coord)
{
	int n = system->n, equations = 0, of = root_of_node(parent, n + coord);
	struct block b = { .system = *system, .equation = ARRAY(int, n), .coord = ARRAY(int, n) };
	b.system.n = 0;
	for (int i = 0; i < n; i++) {
		if (root_of_node(parent, n + i) == of)
			b.coord[b.system.n++] = i;
		if (root_of_node(parent, i) == of)
			b.equation[equations++] = i;
	}
	restrict_system(system, &b);
	return b;
}

/* Does a coordinate before it belong to the same component? */
bool is_seen_before(int n, int *parent, int coord)
{
	bool seen = false;
	for (int earlier = 0; earlier < coord; earlier++)
		seen = seen || root_of_node(parent, n + earlier) == root_of_node(parent, n + coord);
	return seen;
}

int blocks_of(const struct linear *system, struct block **blocks)
{
	int n = system->n, count = 0, *parent = components(system);
	*blocks = ARRAY(struct block, n);
	/* a block for each component, in the order of their first coordinates */
	for (int j = 0; j < n; j++)
		if (!is_seen_before(n, parent, j))
			(*blocks)[count++] = block_at(system, parent, j);
	return count;
}
