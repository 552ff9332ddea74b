/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What scheme pl solves exactly and what it holds over a step, and how that errs. */
#include "step/step.h"

static mpq_t *normalized(int n, int segments, const mpq_t *inverse, const mpq_t *force)
{
	mpq_t *acceleration = rationals((size_t)segments * (size_t)n);
	for (int s = 0; s < segments; s++)
		rational_product(n, n, 1, inverse, force + s * n, acceleration + s * n);
	return acceleration;
}

static void normalize_loads(const struct linear *written, const mpq_t *inverse, struct linear *split)
{
	int n = written->n;
	split->loads = written->loads;
	split->load = ARRAY(struct load, written->loads);
	for (int l = 0; l < written->loads; l++) {
		const struct load *load = &written->load[l];
		split->load[l] = *load;
		split->load[l].force = ARRAY(mpq_t *, load->columns);
		for (int k = 0; k < load->columns; k++)
			split->load[l].force[k] = normalized(n, written->segments, inverse, load->force[k]);
	}
	split->inputs = written->inputs;
	split->input = ARRAY(struct input, written->inputs);
	for (int i = 0; i < written->inputs; i++) {
		split->input[i] = written->input[i];
		for (int k = 0; k < 2; k++)
			split->input[i].force[k] = normalized(n, 1, inverse, written->input[i].force[k]);
	}
}

/* Fang, Wang, Dai, Zhang 2020: after division by the mass matrix the other coordinates and their velocities are held
 * at their value at the step's start; a coordinate's own terms, loads and inputs stay exact. */
struct linear piecewise_laplace(const struct linear *written)
{
	int n = written->n, states = written->states, column;
	struct linear split = linear_like(written);
	mpq_t *inverse = rationals((size_t)(n * n)), *highest = rationals((size_t)(n * states));
	leading_inverse(written, inverse, &column);
	highest_derivatives(written, inverse, false, highest);
	split.heldC = rationals((size_t)(n * n));
	split.heldK = rationals((size_t)(n * n));
	for (int i = 0; i < n; i++) {
		mpq_set_ui((written->velocity[i] >= 0 ? split.M : split.C)[i * n + i], 1, 1);
		for (int j = 0; j < states; j++) {
			bool own = written->coord[j] == i;
			mpq_t *matrix = j < n ? (own ? split.K : split.heldK) : own ? split.C : split.heldC;
			mpq_neg(matrix[i * n + written->coord[j]], highest[i * states + j]);
		}
	}
	normalize_loads(written, inverse, &split);
	split.channels = written->channels;
	split.channel = ARRAY(mpq_t *, written->channels);
	for (int e = 0; e < written->channels; e++)
		split.channel[e] = normalized(n, 1, inverse, written->channel[e]);
	return split;
}

/* The modified equation of y+ = E y + h phi1 R y is y' = L y - (h/2) R L y + O(h^2), L = A + R: what is held lags by
 * half a step. */
struct linear modified_equation(const struct linear *written, const struct linear *split, mpq_srcptr h)
{
	int states = split->states;
	mpq_t *L = state_matrix(written, false), *R = state_matrix(split, true),
	      *RL = rationals((size_t)(states * states));
	rational_product(states, states, states, R, L, RL);
	RATIONAL half = ZERO;
	mpq_div_2exp(half, h, 1);
	for (int i = 0; i < states * states; i++) {
		mpq_mul(RL[i], RL[i], half);
		mpq_sub(L[i], L[i], RL[i]);
	}
	return first_order_system(states, L);
}
