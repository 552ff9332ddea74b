/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Of a region whose fastest pole turns far in a step: pieces of lengths between that in which crossings are looked for
 * and the step, so that a step takes few of them. Each is e^{A d} - I, correctly rounded entry by entry, in the rows of
 * what hardly changes in it: a number near 1 would repeat its rounding in every piece. */
#include "step/step.h"

#include "plrt.h"

#include <math.h>

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
	bool any = step->model->retuned && step->model->switching->expressions > 0;
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
	int room = step->model->retuned ? room_for_rungs(step) : b->halvings;
	b->spacing = b->halvings > room ? (b->halvings + room - 1) / room : 1;
	if (!step->model->retuned && b->halvings > 1)
		b->spacing = 2;
	b->rungs = b->halvings > 0 ? (b->halvings - 1) / b->spacing + 1 : 0;
}

/* ---- pieces ---- */

static double *rung_of(const struct step *step, const struct table *table, int halvings)
{
	int size = step->layout.size, states = table->states;
	if (step->model->asked.compensated)
		return gain_of(step, table, halvings);
	double *rung = ARRAY(double, (size_t)(size + 1) * (size_t)size), *Phi = Phi_over(step, table, halvings);
	for (int i = 0; i < size * size; i++)
		rung[i] = Phi[i];
	for (int i = 0; i < states; i++)
		if (Phi[i * (size + 1)] > 0.5) {
			rung[i * (size + 1)] = table->increment[i * (states + 1)].value;
			rung[size * size + i] = 1;
		}
	discard(Phi);
	return rung;
}

double **rungs_of(const struct step *step, int branch)
{
	const struct branch *b = &step->branch[branch];
	double **rung = ARRAY(double *, (size_t)b->rungs);
	for (int r = 0; r < b->rungs; r++)
		rung[r] = rung_of(step, b->table[1 + r], rung_halvings(b, r));
	return rung;
}

/* ---- bounds ---- */

double *reach_of_rows(const struct step *step, int branch, const double *A, int rows, const double *row)
{
	const struct branch *b = &step->branch[branch];
	int size = step->layout.size, cells = rows * b->rungs * size;
	double *reach = ARRAY(double, (size_t)cells), *work = ARRAY(double, (size_t)PL_REACH_WORK(size, rows));
	if (b->rungs > 0)
		pl_region_reach(size, round_rational(step->model->h), b->halvings, b->spacing, A, rows, row, reach, work);
	for (int i = 0; i < cells && step->model->asked.single; i++)
		reach[i] *= 1 + ldexp(1, -22);          /* still a bound when it is printed as a float */
	discard(work);
	return reach;
}
