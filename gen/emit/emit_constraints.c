/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the constraints miss, and mass matrices of the state, for the runtime's constraints.h. */
#include "steps.h"
#include "model/building.h"
#include "model/reads.h"

#include <math.h>

static const struct form **corrections(const struct emitter *e)
{
	return e->model->equations.correction;
}

static struct formulas *misses(const struct emitter *e)
{
	const int states = e->system->states;
	struct formulas *f = formulas_new(e, (struct reading){ .written = true }, states, corrections(e));
	for (int i = 0; i < states; i++)
		tape_set(formulas_tape(f), format("miss[%d]", i), formula(f, corrections(e)[i]), 14,
			 e->model->names.state[i]);
	return f;
}

bool constraints_need_math(const struct emitter *e)
{
	return corrections(e) && tape_cost(formulas_tape(misses(e))).calls > 0;
}

static void emit_misses(const struct emitter *e)
{
	struct formulas *f = misses(e);
	const struct reads r = reads_of_formulas(f);
	open_function(e, "What has to be taken from y, tau after now, for the constraints to hold, to first order",
		      "static void $n_misses(const $n *s, double tau, const double y[$N_STATES], "
		      "double miss[$N_STATES])");
	emit_param_locals(e, r.param);
	if (r.time)
		say(e, "    const double t = $n_time(s) + tau;\n");
	emit_formulas(f, 4);
	close_function(e, "s tau y");
}

/* ---- M of the state, which is looked at where a step fails ---- */

static const struct form **entries(const struct segment_equations *s, int *count)
{
	const struct form **entry = NULL;
	*count = 0;
	for (int i = 0; i < s->masses; i++)
		for (int k = 0; k < s->mass[i].system.n * s->mass[i].system.n; k++)
			*MORE(entry, *count) = s->mass[i].system.M[k];
	return entry;
}

/* Rows of all blocks; 0: none depends on the state, or they read inputs, or M at the start is not known */
int moving_masses(const struct emitter *e)
{
	const struct segment_equations *s = e->model->equations.full;
	int count, rows = 0;
	for (int i = 0; s && i < s->masses; rows += s->mass[i++].system.n)
		if (!s->mass[i].start)
			return 0;
	if (rows == 0 || e->model->relative)
		return 0;
	const struct form **entry = entries(s, &count);
	const struct reads r = reads_of(e->model, count, entry);
	return any_of(r.input, 2 * e->system->inputs) ? 0 : rows;
}

static struct formulas *mass_entries(const struct emitter *e)
{
	const struct segment_equations *s = e->model->equations.full;
	int count, first = 0;
	const struct form **entry = entries(s, &count);
	struct formulas *f = formulas_new(e, (struct reading){ .written = true }, count, entry);
	for (int b = 0; b < s->masses; first += s->mass[b++].system.n)
		for (int n = s->mass[b].system.n, k = 0; k < n * n; k++)
			if (s->mass[b].system.M[k]->terms)
				tape_set(formulas_tape(f), format("mass[%d][%d]", first + k / n, first + k % n),
					 formula(f, s->mass[b].system.M[k]), 14, NULL);
	return f;
}

static void emit_masses_at_start(const struct emitter *e, int rows)
{
	const struct segment_equations *s = e->model->equations.full;
	double *value = ARRAY(double, rows);
	int row = 0;
	for (int b = 0; b < s->masses; b++)
		for (int n = s->mass[b].system.n, i = 0; i < n; i++)
			value[row++] = fabs(finite_number(e, s->mass[b].start[i * n + i]));
	emit_array(e, "Sizes of the diagonal of the mass matrix at the start", "mass_at_start", 1, &rows, value, NULL);
}

static void emit_masses(const struct emitter *e, int rows)
{
	emit_masses_at_start(e, rows);
	struct formulas *f = mass_entries(e);
	const struct reads r = reads_of_formulas(f);
	open_function(e, "Entries of the mass matrix that are not 0, at y, tau after now",
		      "static void $n_masses(const $n *s, double tau, const double y[$N_STATES], double mass[%d][%d])",
		      rows, rows);
	emit_param_locals(e, r.param);
	if (r.time)
		say(e, "    const double t = $n_time(s) + tau;\n");
	emit_formulas(f, 4);
	close_function(e, "s tau y");
}

void emit_constraints(const struct emitter *e)
{
	const int rows = moving_masses(e);
	if (corrections(e))
		emit_misses(e);
	if (rows)
		emit_masses(e, rows);
}
