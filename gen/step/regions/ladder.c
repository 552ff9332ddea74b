/* SPDX-License-Identifier: GPL-3.0-or-later */
/* e^{A d} of a region, over the step and, where its fastest pole turns far in that, over pieces of lengths down to that
 * in which crossings are looked for, so that a step takes few of them. A piece has e^{A d} - I, correctly rounded entry
 * by entry, in the rows of what hardly changes in it: a number near 1 would repeat its rounding in every piece. */
#include "inner.h"
#include "model/regions/regions.h"
#include "plrt.h"

#include <math.h>

/* ---- e^{A d} of a region over x = states, load states, inputs ---- */

static void fill_input_states(const struct step *step, mpq_srcptr d, double *Phi)
{
	const struct layout *layout = &step->layout;
	for (int i = 0; i < step->branch->system.inputs; i++) {
		int at = layout->input[i];
		Phi[at * layout->size + at] = 1;
		if (!step->branch->system.input[i].hold)
			continue;
		Phi[at * layout->size + at + 1] = round_rational(d);
		Phi[(at + 1) * layout->size + at + 1] = 1;
	}
}

/* u, and of a ramp u': held, and as the slope of u */
static void fill_inputs(const struct step *step, const struct table *table, double *Phi)
{
	const struct layout *layout = &step->layout;
	for (int row = 0; row < table->states; row++)
		for (int i = 0; i < step->branch->system.inputs; i++) {
			const struct coefficient *held = &table->phi_weight[0][row * table->force_columns];
			const struct coefficient *ramp = &table->phi_weight[1][row * table->force_columns];
			double *cell = Phi + row * layout->size + layout->input[i];
			cell[0] = held[2 * i].value;
			if (step->branch->system.input[i].hold)
				cell[1] = ramp[2 * i].value + held[2 * i + 1].value;
		}
}

static void fill_state_rows(const struct step *step, const struct table *table, double *Phi)
{
	const struct layout *layout = &step->layout;
	const struct linear *system = &step->branch->system;
	for (int i = 0; i < table->states; i++) {
		double *row = Phi + i * layout->size;
		for (int j = 0; j < table->states; j++)
			row[j] = table->Phi[i * table->states + j].value;
		for (int l = 0, column = 0; l < system->loads; column += system->load[l++].columns)
			for (int k = 0; k < system->load[l].columns && layout->load[l] >= 0; k++)
				row[layout->load[l] + k] = table->load[i * table->columns + column + k].value;
	}
}

/* Over h 2^-halvings, from its table */
double *Phi_over(const struct step *step, const struct table *table, int halvings)
{
	double *Phi = ARRAY(double, (size_t)step->layout.size * (size_t)step->layout.size);
	RATIONAL d = ZERO;
	mpq_div_2exp(d, step->model->h, (mp_bitcnt_t)halvings);
	fill_state_rows(step, table, Phi);
	fill_inputs(step, table, Phi);
	growth_of_loads(step, d, Phi, NULL);
	fill_input_states(step, d, Phi);
	return Phi;
}

/* ---- which lengths ---- */

int room_for_rungs(const struct step *step)
{
	int most = 0;
	for (int k = 0; k < step->branches; k++)
		most = step->branch[k].halvings > most ? step->branch[k].halvings : most;
	return 2 + most / 4;
}

bool has_ladder(const struct step *step)
{
	bool any = step->model->params.retuned && step->model->switching->functions > 0;
	for (int k = 0; k < step->branches; k++)
		any = any || step->branch[k].rungs > 0;
	return any;
}

int rung_halvings(const struct branch *branch, int rung)
{
	return branch->halvings - rung * branch->spacing;
}

/* Every fourth of a length; an instance has room for some, whatever its params make of the poles. */
void plan_ladder(struct step *step, int branch)
{
	struct branch *b = &step->branch[branch];
	int room = step->model->params.retuned ? room_for_rungs(step) : b->halvings;
	b->spacing = b->halvings > room ? (b->halvings + room - 1) / room : 1;
	if (!step->model->params.retuned && b->halvings > 1)
		b->spacing = 2;
	b->rungs = step->model->switching->cached ? 0 : b->halvings > 0 ? (b->halvings - 1) / b->spacing + 1 : 0;
}

/* ---- their pieces ---- */

static double *rung_of(const struct step *step, const struct table *table, int halvings)
{
	int size = step->layout.size, states = table->states;
	if (step->is.two_words)
		return gain_of(step, table, halvings);
	SCRATCH double *Phi = Phi_over(step, table, halvings);
	double *rung = ARRAY(double, (size_t)(size + 1) * (size_t)size);
	for (int i = 0; i < size * size; i++)
		rung[i] = Phi[i];
	for (int i = 0; i < states; i++)
		if (Phi[i * (size + 1)] > 0.5) {
			rung[i * (size + 1)] = table->increment[i * (states + 1)].value;
			rung[size * size + i] = 1;
		}
	return rung;
}

double **rungs_of(const struct step *step, int branch)
{
	const struct branch *b = &step->branch[branch];
	double **rung = ARRAY(double *, b->rungs);
	for (int r = 0; r < b->rungs; r++)
		rung[r] = rung_of(step, b->table[1 + r], rung_halvings(b, r));
	return rung;
}

/* ---- bounds ---- */

double *reach_of_rows(const struct step *step, int branch, const double *A, int rows, const double *row)
{
	const struct branch *b = &step->branch[branch];
	int size = step->layout.size, cells = rows * b->rungs * size;
	SCRATCH double *work = ARRAY(double, (size_t)PL_REACH_WORK(size, rows));
	double *reach = ARRAY(double, cells);
	if (b->rungs > 0)
		pl_region_reach(size, round_rational(step->model->h), b->halvings, b->spacing, A, rows, row, reach,
				work);
	for (int i = 0; i < cells && step->model->request.single; i++)
		reach[i] *= 1 + ldexp(1, -22);          /* still a bound when it is printed as a float */
	return reach;
}
