/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the constraints miss, for the runtime's constraints.h, and mass matrices of the state, for its masses.h. */
#include "steps.h"
#include "model/building.h"
#include "model/reads.h"
#include "model/state_mass.h"

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

/* ---- M of the state, which is looked at where a step fails or may pass a singular place ---- */

static const struct form **entries(const struct segment_equations *s, int *count)
{
	const struct form **entry = NULL;
	*count = 0;
	for (int i = 0; i < s->masses; i++)
		for (int k = 0; k < s->mass[i].plain.n * s->mass[i].plain.n; k++)
			*MORE(entry, *count) = s->mass[i].plain.M[k];
	return entry;
}

bool steps_may_fail(const struct emitter *e)
{
	return e->step->taylor.expansion || e->step->collocation;
}

/* Whether steps have to look for a singular M: nothing shows that it stays regular, or it may touch 0, where without a
 * tolerance no step fails */
static bool looks_at_masses(const struct emitter *e)
{
	return e->model->equations.indefinite || !tells_tolerance(e);
}

/* Rows of all blocks, where they are looked at; 0: none depends on the state, or they read inputs, or M at the start is
 * not known */
int moving_masses(const struct emitter *e)
{
	const struct segment_equations *s = e->model->equations.full;
	int count, rows = 0;
	for (int i = 0; s && i < s->masses; rows += s->mass[i++].plain.n)
		if (!s->mass[i].start)
			return 0;
	if (rows == 0 || e->model->relative || !(steps_may_fail(e) || looks_at_masses(e)))
		return 0;
	const struct form **entry = entries(s, &count);
	bool moves = false;
	for (int i = 0; i < count; i++)
		moves = moves || !is_constant(entry[i]);
	const struct reads r = reads_of(e->model, count, entry);
	return !moves || any_of(r.input, 2 * e->system->inputs) ? 0 : rows;
}

bool may_be_singular(const struct emitter *e)
{
	return moving_masses(e) > 0 && looks_at_masses(e);
}

static struct formulas *mass_entries(const struct emitter *e)
{
	const struct segment_equations *s = e->model->equations.full;
	int count, first = 0;
	const struct form **entry = entries(s, &count);
	struct formulas *f = formulas_new(e, (struct reading){ .written = true }, count, entry);
	for (int b = 0; b < s->masses; first += s->mass[b++].plain.n)
		for (int n = s->mass[b].plain.n, k = 0; k < n * n; k++)
			if (s->mass[b].plain.M[k]->terms)
				tape_set(formulas_tape(f), format("mass[%d][%d]", first + k / n, first + k % n),
					 formula(f, s->mass[b].plain.M[k]), 14, NULL);
	return f;
}

/* Per state the one that is its slope; -1: none is */
static int *rates_of_states(const struct emitter *e)
{
	int *rate = ARRAY(int, e->system->states);
	for (int i = 0; i < e->system->states; i++)
		rate[i] = i < e->system->n ? e->system->velocity[i] : -1;
	return rate;
}

static void emit_mass_tables(const struct emitter *e, int rows)
{
	const struct segment_equations *s = e->model->equations.full;
	double *value = ARRAY(double, rows);
	int *block = ARRAY(int, rows), row = 0;
	for (int b = 0; b < s->masses; b++) {
		const int n = s->mass[b].plain.n;
		for (int i = 0; i < n; i++)
			value[row++] = fabs(finite_number(e, s->mass[b].start[i * n + i]));
		block[row - 1] = is_symmetric_mass(&s->mass[b].plain) ? 1 : 2;
	}
	emit_array(e, "Sizes of the diagonal of the mass matrix at the start", "mass_at_start", 1, &rows, value, NULL);
	if (!may_be_singular(e))
		return;
	emit_int_list(e, "mass_block", rows, block);
	emit_int_list(e, "rate_of", e->system->states, rates_of_states(e));
}

void emit_mass_matrix(const struct emitter *e)
{
	const int rows = moving_masses(e);
	if (rows == 0)
		return;
	emit_mass_tables(e, rows);
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
	if (may_be_singular(e))
		say(e, "\nstatic void $n_stay_regular($n *s);\n");
}

void emit_mass_members(const struct emitter *e)
{
	if (holds_energy(e))
		say(e, "    double energy;        /* of the state that was set, which stays */\n");
	if (may_be_singular(e))
		say(e, "    double pivot[%d];%*s/* of the mass matrix now: their signs say if it turns singular */\n"
		       "    double regular[$N_STATES];  /* the last state at which it was not */\n",
		    moving_masses(e), moving_masses(e) < 10 ? 6 : 5, "");
}

/* Where the error of a series is so small that the drift by rounding is seen */
bool holds_energy(const struct emitter *e)
{
	const struct truncation *t = truncation_of(e);
	return e->model->equations.conserved[0] && e->step->taylor.expansion && !e->step->collocation &&
	       mpq_cmp_ui(t->tolerance, 1, 1000000000000) <= 0;
}

void emit_energies(const struct emitter *e)
{
	const struct form *const *energy = e->model->equations.conserved;
	if (!holds_energy(e))
		return;
	struct formulas *f = formulas_new(e, (struct reading){ .written = true }, 2, (const struct form **)energy);
	for (int k = 0; k < 2; k++)
		tape_set(formulas_tape(f), format("conserved[%d]", k), formula(f, energy[k]), 14, k ? "V" : "T");
	const struct reads r = reads_of_formulas(f);
	open_function(e, "Energies at y, whose sum stays",
		      "static void $n_energies(const $n *s, const double y[$N_STATES], double conserved[2])");
	emit_param_locals(e, r.param);
	emit_formulas(f, 4);
	close_function(e, "s y");
}

void emit_constraints(const struct emitter *e)
{
	if (corrections(e))
		emit_misses(e);
}
