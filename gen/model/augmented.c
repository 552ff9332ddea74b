/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The augmented state x, of which x' = A x: states, what a scheme holds, load states, inputs, channels. */
#include "model/model.h"

void series_place(struct series *series, const struct linear *system, int powers)
{
	bool *acting = ARRAY(bool, (size_t)system->loads);
	for (int l = 0; l < system->loads; l++)
		acting[l] = load_acts(system, &system->load[l]);
	series_place_loads(series, system, powers, acting);
}

void series_place_loads(struct series *series, const struct linear *system, int powers, const bool *needed)
{
	series->size = system->states;
	series->held = -1;
	if (system->heldK) {
		series->held = series->size;
		series->size += system->n;
	}
	series->load = ARRAY(int, (size_t)system->loads);
	for (int l = 0; l < system->loads; l++) {
		series->load[l] = needed[l] ? series->size : -1;
		series->size += needed[l] ? system->load[l].columns : 0;
	}
	series->input = ARRAY(int, (size_t)system->inputs);
	for (int i = 0; i < system->inputs; i++) {
		series->input[i] = series->size;
		series->size += system->input[i].first_order ? 2 : 1;
	}
	series->channel = series->size;
	series->powers = powers;
	series->size += system->channels * powers;
}

/* (t^k e^{at} cos)' = k t^{k-1} e^{at} cos + a t^k e^{at} cos - w t^k e^{at} sin, and so for sin */
static void fill_load_rows(mpq_t *A, int size, int at, const struct load *load)
{
	int trig = oscillates(load->wave) ? 2 : 1;
	for (int column = 0; column < load->columns; column++) {
		mpq_t *row = A + (at + column) * size + at;
		mpq_set(row[column], load->wave->a);
		if (column >= trig)
			mpq_set_si(row[column - trig], column / trig, 1);
		if (trig == 2 && column % 2 == 0)
			mpq_neg(row[column + 1], load->wave->w);
		if (trig == 2 && column % 2 == 1)
			mpq_set(row[column - 1], load->wave->w);
	}
}

/* column `at` of the rows of the highest derivatives = W^-1 force */
static void fill_force(mpq_t *A, int size, int at, const struct linear *system, const mpq_t *inverse,
		       const mpq_t *force)
{
	int n = system->n;
	mpq_t *product = rationals((size_t)n);
	rational_product(n, n, 1, inverse, force, product);
	for (int i = 0; i < n; i++) {
		int state = system->velocity[i] >= 0 ? system->velocity[i] : i;
		mpq_set(A[state * size + at], product[i]);
	}
}

mpq_t *series_matrix(const struct series *series, const struct linear *system, int segment)
{
	int n = system->n, size = series->size, states = system->states, column;
	mpq_t *A = rationals((size_t)size * (size_t)size), *inverse = rationals((size_t)(n * n)),
	      *unit = rationals((size_t)n);
	mpq_t *own = state_matrix(system, false);
	leading_inverse(system, inverse, &column);
	for (int i = 0; i < states; i++)
		for (int j = 0; j < states; j++)
			mpq_set(A[i * size + j], own[i * states + j]);
	rationals_free(own, (size_t)states * (size_t)states);
	for (int i = 0; i < n && series->held >= 0; i++) {
		mpq_set_ui(unit[i], 1, 1);
		fill_force(A, size, series->held + i, system, (const mpq_t *)inverse, (const mpq_t *)unit);
		mpq_set_ui(unit[i], 0, 1);
	}
	for (int l = 0; l < system->loads; l++) {
		if (series->load[l] < 0)
			continue;
		for (int k = 0; k < system->load[l].columns; k++)
			fill_force(A, size, series->load[l] + k, system, (const mpq_t *)inverse,
				   (const mpq_t *)system->load[l].force[k] + segment * n);
		fill_load_rows(A, size, series->load[l], &system->load[l]);
	}
	for (int i = 0; i < system->inputs; i++) {
		int at = series->input[i];
		fill_force(A, size, at, system, (const mpq_t *)inverse, (const mpq_t *)system->input[i].force[0]);
		if (!system->input[i].first_order)
			continue;
		fill_force(A, size, at + 1, system, (const mpq_t *)inverse, (const mpq_t *)system->input[i].force[1]);
		mpq_set_ui(A[at * size + at + 1], 1, 1);
	}
	for (int e = 0; e < system->channels && series->powers > 0; e++) {
		int at = series->channel + e * series->powers;
		fill_force(A, size, at, system, (const mpq_t *)inverse, (const mpq_t *)system->channel[e]);
		for (int m = 1; m < series->powers; m++)
			mpq_set_ui(A[(at + m - 1) * size + at + m], 1, 1);
	}
	rationals_free(inverse, (size_t)(n * n));
	return A;
}
