/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Momenta that nothing changes. Where no force from outside acts on a block of masses, a sum of its velocities stays what it is. A step
 * that rounds each velocity by itself loses that at random; so one of them is not stepped at all: it has lost what the others have
 * gained since the state was set. That of the heaviest mass: then nothing is magnified. */
#include "plgen.h"

/* w with w A = 0, A n x columns, up to a factor; false: there is none, or more than one. By elimination of the columns of A: the
 * equations sum over i of w_i A_ij = 0, solved for all but one. */
static bool left_null(int n, int columns, const mpq_t *A, mpq_t *w)
{
	mpq_t *row = rationals((size_t)(columns * n)), factor, product;
	int *pivot = ARRAY(int, (size_t)n), rank = 0, free = -1;
	mpq_inits(factor, product, NULL);
	for (int j = 0; j < columns; j++)
		for (int i = 0; i < n; i++)
			mpq_set(row[j * n + i], A[i * columns + j]);
	for (int i = 0; i < n; i++) {
		int found = rank;
		while (found < columns && mpq_sgn(row[found * n + i]) == 0)
			found++;
		pivot[i] = found < columns ? rank : -1;
		if (found == columns)
			continue;
		for (int k = 0; k < n; k++)
			mpq_swap(row[found * n + k], row[rank * n + k]);
		mpq_inv(factor, row[rank * n + i]);
		for (int k = 0; k < n; k++)
			mpq_mul(row[rank * n + k], row[rank * n + k], factor);
		for (int j = 0; j < columns; j++) {
			if (j == rank)
				continue;
			mpq_set(factor, row[j * n + i]);
			for (int k = 0; k < n; k++) {
				mpq_mul(product, factor, row[rank * n + k]);
				mpq_sub(row[j * n + k], row[j * n + k], product);
			}
		}
		rank++;
	}
	for (int i = 0; i < n; i++)
		free = pivot[i] < 0 ? i : free;
	for (int i = 0; i < n && free >= 0; i++)
		if (pivot[i] >= 0)
			mpq_neg(w[i], row[pivot[i] * n + free]);
		else
			mpq_set_ui(w[i], 1, 1);
	mpq_clears(factor, product, NULL);
	return rank == n - 1;
}

struct search {
	const mpq_t *inverse, *w;
	int n;
	bool outside;
};

static void look_outside(struct search *s, const mpq_t *force)
{
	mpq_t *a = rationals((size_t)s->n), sum, product;
	mpq_inits(sum, product, NULL);
	rational_product(s->n, s->n, 1, s->inverse, force, a);
	for (int i = 0; i < s->n; i++) {
		mpq_mul(product, s->w[i], a[i]);
		mpq_add(sum, sum, product);
	}
	s->outside = s->outside || mpq_sgn(sum) != 0;
	mpq_clears(sum, product, NULL);
}

/* Does a load or an input change the sum? */
static bool is_driven(const struct linear *system, const mpq_t *inverse, const mpq_t *w)
{
	struct search s = { inverse, w, system->n, false };
	for (int l = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++)
			for (int t = 0; t < system->segments; t++)
				look_outside(&s, (const mpq_t *)system->load[l].force[k] + t * system->n);
	for (int i = 0; i < system->inputs; i++)
		for (int k = 0; k < 2; k++)
			look_outside(&s, (const mpq_t *)system->input[i].force[k]);
	return s.outside;
}

static bool larger(mpq_srcptr a, mpq_srcptr b)
{
	mpq_t x, y;
	mpq_inits(x, y, NULL);
	mpq_abs(x, a);
	mpq_abs(y, b);
	bool larger = mpq_cmp(x, y) > 0;
	mpq_clears(x, y, NULL);
	return larger;
}

/* A velocity that stays by itself: then there is nothing to give it from, and its own row steps it exactly. */
static bool is_alone(const mpq_t *w, int n)
{
	int parts = 0;
	for (int i = 0; i < n; i++)
		parts += mpq_sgn(w[i]) != 0;
	return parts == 1;
}

/* Weights of the velocities in a sum that stays, the largest 1; false: none stays */
static bool steady_sum(const struct linear *system, mpq_t *w, int *heaviest)
{
	int n = system->n, states = system->states, column;
	mpq_t *inverse = rationals((size_t)(n * n)), *highest = rationals((size_t)(n * states)), unit;
	if (n < 2 || states != 2 * n)
		return false;
	leading_inverse(system, inverse, &column);
	highest_derivatives(system, (const mpq_t *)inverse, false, highest);
	if (!left_null(n, states, (const mpq_t *)highest, w) || is_alone((const mpq_t *)w, n) || is_driven(system, (const mpq_t *)inverse, (const mpq_t *)w))
		return false;
	*heaviest = 0;
	mpq_init(unit);
	for (int i = 0; i < n; i++)
		if (larger(w[i], w[*heaviest]))
			*heaviest = i;
	mpq_set(unit, w[*heaviest]);
	for (int i = 0; i < n; i++)
		mpq_div(w[i], w[i], unit);
	mpq_clear(unit);
	return true;
}

/* Kicks act on masses times velocities: there every weight is 1. */
static bool divide_by_masses(const struct step *step, const struct block *block, mpq_t *w, int heaviest)
{
	for (int i = 0; i < block->system.n; i++) {
		mpq_div(w[i], w[i], step->mass[block->coord[i]]);
		mpq_mul(w[i], w[i], step->mass[block->coord[heaviest]]);
		if (mpq_cmp_ui(w[i], 1, 1) != 0)
			return false;
	}
	return true;
}

static struct coefficient in_two_words(mpq_srcptr q)
{
	struct coefficient c = { .value = round_rational(q) };
	mpq_t rest;
	mpq_init(rest);
	mpq_set_d(rest, c.value);
	mpq_sub(rest, q, rest);
	c.low = round_rational(rest);
	mpq_clear(rest);
	return c;
}

static void add_keeper(struct step *step, const struct block *block, const mpq_t *w, int heaviest)
{
	ENLARGE(step->keeper, (size_t)step->keepers + 1);
	struct keeper *keeper = &step->keeper[step->keepers];
	*keeper = (struct keeper){ .first = step->keepers ? keeper[-1].first + keeper[-1].parts : 0, .state = step->system.velocity[block->coord[heaviest]], .part = ARRAY(struct product, (size_t)block->system.n) };
	step->keepers++;
	for (int i = 0; i < block->system.n; i++) {
		if (i == heaviest || mpq_sgn(w[i]) == 0)
			continue;
		struct coefficient *weight = NEW(struct coefficient);
		*weight = in_two_words(w[i]);
		keeper->part[keeper->parts++] = (struct product){ weight, { OPERAND_STATE, step->system.velocity[block->coord[i]], 0 } };
	}
}

void find_keepers(struct step *step)
{
	struct block *block;
	step->keepers = 0;
	if (step->form == FORM_DIRECT || step->system.states > LIMIT_UNROLLED_STATES || step->system.heldK || step->model->tuning)
		return;
	int blocks = blocks_of(&step->system, &block);
	for (int b = 0; b < blocks; b++) {
		mpq_t *w = rationals((size_t)block[b].system.n);
		int heaviest;
		if (steady_sum(&block[b].system, w, &heaviest) && (step->form != FORM_KICK_DRIFT_KICK || divide_by_masses(step, &block[b], w, heaviest)))
			add_keeper(step, &block[b], (const mpq_t *)w, heaviest);
	}
}

const struct keeper *keeper_of(const struct step *step, int state)
{
	for (int k = 0; k < step->keepers; k++)
		if (step->keeper[k].state == state)
			return &step->keeper[k];
	return NULL;
}
