/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The most that a step by a Taylor series does: an expansion, and where the state chooses formulas one more for each
 * event and each look at where a state that was set is; with a tolerance one for each internal step, also one that is
 * too long, of which the spec says how many there are. */
#include "cost.h"
#include "model/checks.h"
#include "model/building.h"
#include "model/capability.h"
#include "step/regions/guards.h"
#include "step/series/expansion.h"
#include "step/series/switching.h"

#include <math.h>
#include <string.h>

const char *unbounded_series(const struct step *step)
{
	const struct model *model = step->model;
	const struct expansion *x = step->taylor.expansion;
	return step->collocation	 ? "Newton's method takes as many iterations as it needs"
	       : !x			 ? "linear steps, those of regions and series of fixed order alone have one"
	       : step->taylor.slopes	 ? "a series is halved until it has the slopes of the equations further on"
	       : x->lines		 ? "a long series goes by loops over its coefficients"
	       : x->contacts		 ? "what is held beside a series is put back by iterations"
	       : mpq_sgn(model->truncation.tolerance) && !model->truncation.adaptive
		       ? "each step measures its error"
	       : model->equations.full && model->equations.full->masses > 0
		       ? "it is looked at where the mass matrix turns singular"
	       : model->equations.correction	? "constraints are met by iterations"
	       : model->equations.conserved[0]	? "the energy is kept by iterations"
						: NULL;
}

/* Of the runtime's own functions the most instructions, by target, 6 % above the longest of 15,000 arguments; of those
 * of <math.h> and of others of the runtime nothing is known. */
static const struct { enum function function; double takes[3]; } own[] = {
	{ FN_SIN, { 12980, 3130, 940 } }, { FN_COS, { 12980, 3130, 940 } }, { FN_TAN, { 13640, 3730, 945 } },
	{ FN_EXP, { 9850, 2530, 705 } }, { FN_SINH, { 11450, 7310, 720 } }, { FN_COSH, { 10670, 3220, 710 } },
	{ FN_SQRT, { 5830, 2460, 1790 } }
};

/* One expansion, and the sizes of what is watched */
static struct tape *tape_of_expansion(const struct step *step)
{
	const struct expansion *x = step->taylor.expansion;
	const int states = step->branch->system.states;
	struct recurrences *r = recurrences_new(step, x, (struct series_names){ .name = NULL });
	struct tape *t = tape_of_recurrences(r);
	for (int k = 0; k <= x->order; k++)
		for (int i = 0; i < states + x->columns; i++)
			if (i < states || k <= x->column_top[i - states])
				recurrence_set(r, "", i < states ? i : x->column[i - states], k);
	for (int i = 0; i < x->functions; i++)
		tape_set(t, "", recurrence_size(r, x->function[i].sequence), 0, NULL);
	return t;
}

double worst_of_calls(const struct step *step, int target)
{
	struct tape *t = tape_of_expansion(step);
	SCRATCH int *uses = tape_uses(t);
	double sum = 0;
	int known = 0;
	for (int i = 0; i < tape_length(t); i++)
		for (size_t k = 0; k < sizeof own / sizeof *own; k++) {
			const struct tape_node *n = tape_node(t, i);
			const bool is_it = uses[i] > 0 && n->op == TAPE_CALL && n->index == (int)own[k].function;
			sum += is_it ? own[k].takes[target] : 0;
			known += is_it;
		}
	const int calls = tape_cost(t).calls;
	return calls == 0 || (step->model->request.own_math && known == calls) ? sum : NONE;
}

/* Are the coefficients locals of the step, no array? */
static bool is_straight(const struct step *step)
{
	enum { MOST = 1000 };
	const struct expansion *x = step->taylor.expansion;
	const struct linear *system = &step->branch->system;
	bool ramps = false;
	for (int i = 0; i < system->inputs; i++)
		ramps = ramps || system->input[i].hold;
	return !step->taylor.switching && !x->choices && !ramps && step->model->truncation.over == 1 &&
	       !step->model->truncation.adaptive && x->multiplications <= MOST;
}

/* How often a series is shortened to a half at most: what may be a number falls below the tolerance, by the order less
 * those of the terms that stand in for its last ones, and what is none ends the step */
static double most_halvings(const struct step *step)
{
	enum { MOST = 60, STAND_IN = 5 };
	const int order = step->taylor.expansion->order, over = order > STAND_IN ? order - STAND_IN : 1;
	const double range = step->model->request.single ? 127 : 1023;
	const double size = -log2(mpq_get_d(step->model->truncation.tolerance)) + log2(order);
	return fmin(MOST, ceil((range + size) / over));
}

/* With a tolerance: how long the series of each internal step is, and the next, where nothing is known of it yet */
static void count_tolerance(const struct step *step, double steps, double events, double part[WORST_SERIES])
{
	/* Halvings of one that nothing is known of, PL_LEAST_PART; what a look at a function takes beside its terms */
	enum { LONG = 31, LOOK = 7 };
	const struct expansion *x = step->taylor.expansion;
	const double states = step->branch->system.states, halvings = steps * most_halvings(step);
	const double fresh = 1 + events + fmin(step->model->truncation.substeps, LONG * (1 + events));
	const double shown = step->taylor.unresolved ? halvings * x->unresolved_functions * (x->order + LOOK) : 0;
	part[WORST_MEASURED] = (steps + 1) * (states + x->measured);
	part[WORST_HALVED] = halvings;
	part[WORST_SHOWN] = shown;
	part[WORST_PRODUCTS] += 2 * fresh * states * x->order;
	part[WORST_SUMS] += fresh * states * x->order;
}

void count_worst_series(const struct step *step, double part[WORST_SERIES])
{
	enum { TWO_SUM = 8, ROW = 2 };
	const struct expansion *x = step->taylor.expansion;
	const struct truncation *t = &step->model->truncation;
	const struct tape_cost cost = tape_cost(tape_of_expansion(step));
	const bool searched = step->taylor.switching != NULL;
	const struct linear *system = &step->branch->system;
	const double states = system->states, terms = fmax(x->order, 3) + 1;
	const double events = searched ? max_events(step->model) : 0, steps = t->adaptive ? t->substeps : 1;
	const double pieces = events + steps, looks = searched ? most_changes(x) + 1 : 0;
	/* of a tolerance: the first, which is of all that is known, and one more where nothing is */
	const double served = pieces + (t->adaptive ? 2 + events : 0), expansions = looks + served;
	const double rows = served * x->functions, ends = served * states * x->order;
	const bool over = t->over > 1;  /* then the first step has a value within, too */
	memset(part, 0, WORST_SERIES * sizeof *part);
	part[WORST_PRODUCTS] = expansions * cost.multiplications + (searched || over || t->adaptive ? ends : 0);
	part[WORST_SUMS] = expansions * cost.additions + (over ? 2 : 1) * ends + served * states * TWO_SUM;
	part[WORST_QUOTIENTS] = expansions * cost.divisions;
	part[WORST_KEPT] = is_straight(step) ? 0 : expansions * (states + x->columns) * (x->order + 1);
	part[WORST_LOOKED] = searched ? ((1 + t->adaptive) * max_splits(step->model) + ROW * rows) * terms : 0;
	part[WORST_ROWS] = searched ? rows * terms : 0;
	part[WORST_PIECES] = searched || t->adaptive ? pieces : 0;
	part[WORST_EXPANSIONS] = expansions;
	if (t->adaptive)
		count_tolerance(step, pieces, events, part);
	for (int l = 0; l < system->loads; l++) {
		const struct forcing *f = system->load[l].forcing;
		part[WORST_FORCED] += x->load[l] * expansions * (oscillates(f) + (mpq_sgn(f->a) != 0));
	}
}
