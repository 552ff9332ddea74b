/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The augmented state x, of which x' = A x: states, what a scheme holds, load states, inputs, force columns. */
#include "model/reads.h"

static struct layout place(const struct linear *system, int powers, const bool *needed, int segments, bool held)
{
	struct layout x = { .size = system->states, .states = system->states, .held = -1, .segments = segments,
			    .powers = powers };
	if (held) {
		x.held = x.size;
		x.size += system->n;
	}
	x.first_load = x.size;
	x.load = ARRAY(int, system->loads);
	for (int l = 0; l < system->loads; l++) {
		x.load[l] = needed[l] ? x.first_load + x.loads : -1;
		x.loads += needed[l] ? system->load[l].columns : 0;
	}
	x.size += segments * x.loads;
	x.input = ARRAY(int, system->inputs);
	for (int i = 0; i < system->inputs; i++) {
		x.input[i] = x.size;
		x.size += system->input[i].hold + 1;
	}
	x.force_column = x.size;
	x.size += system->force_columns * powers;
	return x;
}

struct layout layout_of(const struct linear *system, int powers)
{
	bool *acting = ARRAY(bool, system->loads);
	for (int l = 0; l < system->loads; l++)
		acting[l] = load_acts(system, &system->load[l]);
	return place(system, powers, acting, 1, system->heldK);
}

struct layout layout_of_segments(const struct linear *system, int powers)
{
	struct layout one = layout_of(system, powers);
	if (system->segments * one.loads > one.size)
		return one;
	bool *acting = ARRAY(bool, system->loads);
	for (int l = 0; l < system->loads; l++)
		acting[l] = one.load[l] >= 0;
	return place(system, powers, acting, system->segments, system->heldK);
}

struct layout layout_with(const struct linear *system, int powers, const bool *needed)
{
	return place(system, powers, needed, 1, system->heldK);
}

struct layout layout_of_columns(const struct linear *system)
{
	bool *all = ARRAY(bool, system->loads);
	for (int l = 0; l < system->loads; l++)
		all[l] = true;
	return place(system, 0, all, system->segments, false);
}

static void name_loads(const struct layout *x, const struct linear *system, const char **name)
{
	for (int s = 0; s < x->segments; s++)
		for (int l = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns && x->load[l] >= 0; k++)
				name[x->load[l] + s * x->loads + k] =
					format("%s%s", column_text(&system->load[l], k),
					       s ? format(" (segment %d)", s) : "");
}

const char **layout_names(const struct layout *x, const struct linear *system, const struct model *model)
{
	const char **name = ARRAY(const char *, x->size);
	for (int i = 0; i < system->states; i++)
		name[i] = model->names.state[i];
	for (int i = 0; i < system->n && x->held >= 0; i++)
		name[x->held + i] = format("held for %s", model->names.coord[i]);
	name_loads(x, system, name);
	for (int i = 0; i < system->inputs; i++) {
		name[x->input[i]] = system->input[i].name;
		for (int m = 1; m <= system->input[i].hold; m++)
			name[x->input[i] + m] = format("%s'", name[x->input[i] + m - 1]);
	}
	for (int c = 0; c < system->force_columns * x->powers; c++)
		name[x->force_column + c] = format("remainder %d", c + 1);
	return name;
}

/* (t^k e^{at} cos)' = k t^{k-1} e^{at} cos + a t^k e^{at} cos - w t^k e^{at} sin, and so for sin */
static void fill_load_rows(mpq_t *A, int size, int at, const struct load *load)
{
	int trig = oscillates(load->forcing) ? 2 : 1;
	for (int column = 0; column < load->columns; column++) {
		mpq_t *row = A + (at + column) * size + at;
		mpq_set(row[column], load->forcing->a);
		if (column >= trig)
			mpq_set_si(row[column - trig], column / trig, 1);
		if (trig == 2 && column % 2 == 0)
			mpq_neg(row[column + 1], load->forcing->w);
		if (trig == 2 && column % 2 == 1)
			mpq_set(row[column - 1], load->forcing->w);
	}
}

/* column `at` of the rows of states */
static void fill_force(mpq_t *A, int size, int at, const struct linear *system, const mpq_t *inverse,
		       const mpq_t *force)
{
	RATIONALS *slopes = slopes_by_force(system, inverse, force);
	for (int i = 0; i < system->states; i++)
		mpq_swap(A[i * size + at], slopes[i]);
}

static void fill_load(mpq_t *A, const struct layout *x, const struct linear *system, const mpq_t *inverse, int load,
		      int at, int segment)
{
	for (int k = 0; k < system->load[load].columns; k++)
		fill_force(A, x->size, at + k, system, inverse, system->load[load].force[k] + segment * system->n);
	fill_load_rows(A, x->size, at, &system->load[load]);
}

mpq_t *augmented_matrix(const struct layout *x, const struct linear *system, int segment)
{
	int n = system->n, size = x->size, states = system->states;
	RATIONALS *inverse = inverse_of_leading(system);
	mpq_t *A = rationals((size_t)size * (size_t)size), *unit = rationals(n);
	RATIONALS *own = state_matrix(system, false);
	for (int i = 0; i < states; i++)
		for (int j = 0; j < states; j++)
			mpq_set(A[i * size + j], own[i * states + j]);
	for (int i = 0; i < n && x->held >= 0; i++) {
		mpq_set_ui(unit[i], 1, 1);
		fill_force(A, size, x->held + i, system, inverse, unit);
		mpq_set_ui(unit[i], 0, 1);
	}
	for (int l = 0; l < system->loads; l++)
		for (int s = 0; s < x->segments && x->load[l] >= 0; s++)
			fill_load(A, x, system, inverse, l, x->load[l] + s * x->loads, x->segments > 1 ? s : segment);
	for (int i = 0; i < system->inputs; i++) {
		int at = x->input[i];
		fill_force(A, size, at, system, inverse, system->input[i].force[0]);
		if (!system->input[i].hold)
			continue;
		fill_force(A, size, at + 1, system, inverse, system->input[i].force[1]);
		for (int m = 0; m < system->input[i].hold; m++)
			mpq_set_ui(A[(at + m) * size + at + m + 1], 1, 1);
	}
	for (int e = 0; e < system->force_columns && x->powers > 0; e++) {
		int at = x->force_column + e * x->powers;
		fill_force(A, size, at, system, inverse, system->force_column[e]);
		for (int m = 1; m < x->powers; m++)
			mpq_set_ui(A[(at + m - 1) * size + at + m], 1, 1);
	}
	return A;
}
