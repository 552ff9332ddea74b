/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The most that a step by a Taylor series does: an expansion, and where the state chooses formulas one more for each
 * event and each look at where a state that was set is; with a tolerance one for each internal step, also one that is
 * too long, of which the spec says how many there are. Of a collocation all iterations of Newton's method in each. */
#include "cost.h"
#include "model/checks.h"
#include "model/contacts/contacts.h"
#include "model/building.h"
#include "step/collocation/collocation.h"
#include "step/linear/rows.h"
#include "step/regions/guards.h"
#include "step/regions/regions.h"
#include "step/series/expansion.h"
#include "step/series/switching.h"

#include <math.h>
#include <string.h>

static const char *unbounded_collocation(const struct step *step)
{
	const struct collocation *c = step->collocation;
	return step->taylor.switching || has_contacts(step->model)
		       ? "events on the way of a collocation are found by iterations"
	       : step->taylor.unresolved	  ? "what may hide between the nodes of a collocation is looked for"
	       : step->model->equations.correction ? "constraints are met by iterations"
	       : loads_change(&step->model->system) ? "loads change their formula beside a collocation"
	       : c->motion->differences	  ? "slopes are differences"
	       : c->iteration.calls > 0	  ? "Newton's method calls functions"
	       : step->taylor.expansion && step->taylor.expansion->lines
		       ? "a long series goes by loops over its coefficients"
		       : NULL;
}

const char *unbounded_series(const struct step *step)
{
	const struct model *model = step->model;
	const struct expansion *x = step->taylor.expansion;
	return step->collocation	 ? unbounded_collocation(step)
	       : !x			 ? "linear steps, those of regions and series of fixed order alone have one"
	       : step->taylor.slopes	 ? "a series is halved until it has the slopes of the equations further on"
	       : loads_change(&model->system)	 ? "loads change their formula beside a series"
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

/* ---- a collocation ---- */

/* As many internal steps as the spec lets it try, each with all iterations; after four that were in vain each may begin
 * from 0 once more (radau.h, newton.h). Beside a series that takes turns with it each looks at rates, too. */
void count_worst_collocation(const struct step *step, double part[WORST_COLLOCATION])
{
	enum { ITERATIONS = 9, ONCE = 4, TERMS = 2 };
	const struct collocation *c = step->collocation;
	const struct linear *system = &step->branch->system;
	const double tries = step->model->truncation.substeps, solves = tries + fmax(tries - ONCE, 0);
	const double iterations = ITERATIONS * solves, stages = c->stages, states = system->states;
	double functions = 0;
	for (int l = 0; l < system->loads; l++)
		functions += oscillates(system->load[l].forcing) + (mpq_sgn(system->load[l].forcing->a) != 0);
	part[NEWTON_PRODUCTS] = iterations * c->iteration.multiplications;
	part[NEWTON_SUMS] = iterations * c->iteration.additions;
	part[NEWTON_ITERATIONS] = iterations * (stages * system->n + states);
	part[NEWTON_FORCED] = (solves * stages + tries) * functions;
	part[NEWTON_FINISHED] = tries * stages * (stages + TERMS) * states;
	part[NEWTON_TRIES] = tries;
}

/* ---- changes of loads ---- */

/* The most times in a step at which loads change their formula */
static int most_changes_of_loads(const struct step *step)
{
	const struct linear *system = &step->model->system;
	RATIONAL apart = ZERO;
	int most = 0;
	for (int i = 0; i < system->segments - 1; i++)
		for (int k = i; k < system->segments - 1; k++) {
			mpq_sub(apart, system->change[k], system->change[i]);
			most = mpq_cmp(apart, step->model->h) <= 0 && k - i + 1 > most ? k - i + 1 : most;
		}
	return most;
}

void count_changes(const struct step *step, double part[CHANGE])
{
	const double count = most_changes_of_loads(step), size = step->layout.size;
	const double pieces = count > 0 ? (count + 1) * (1 << step->series.halvings) : 0;
	part[CHANGE_ROWS] = pieces * step->series.degree * size;
	part[CHANGE_PRODUCTS] = part[CHANGE_ROWS] * size;
	part[CHANGES] = count;
	part[CHANGE_ENTRIES] = count > 0 ? size * size : 0;
}

/* ---- contacts that act on each other ---- */

enum { MOST_SWEEPS = 1000 };            /* of contacts.h */
struct bouncing {                       /* impacts; coordinates */
	int count, n;
	double *speed, *stops;          /* rows over velocities; what 1 of the speed of k takes from i where k stops */
};

static struct bouncing bouncing_of(const struct step *step)
{
	const struct switching *s = step->model->switching;
	struct bouncing b = { s->impacts, step->model->system.n, ARRAY(double, (size_t)(s->impacts * step->model->n)),
			      ARRAY(double, (size_t)(s->impacts * s->impacts)) };
	double *row = ARRAY(double, (size_t)step->layout.size);
	for (int i = 0; i < b.count; i++) {
		if (!s->impact[i].bounces)
			continue;
		row_over_x(step, s->impact[i].in->speed_row, 0, row);
		for (int q = 0; q < b.n; q++) {
			const int velocity = step->model->system.velocity[q];
			b.speed[i * b.n + q] = velocity >= 0 ? row[velocity] : 0;
		}
		for (int k = 0; k < b.count; k++)
			for (int q = 0; q < b.n && s->impact[k].bounces; q++)
				b.stops[i * b.count + k] +=
					b.speed[i * b.n + q] * mpq_get_d(s->impact[k].in->direction[q]);
	}
	return b;
}

/* left <- projection onto what speeds of a set can be when their turns come, by Gram and Schmidt: a column for each
 * velocity */
static void project_on_speeds(const struct bouncing *b, unsigned set, double *left)
{
	const int count = b->count;
	SCRATCH double *turn = ARRAY(double, (size_t)count);
	SCRATCH double *off = ARRAY(double, (size_t)count);
	memset(left, 0, (size_t)(count * count) * sizeof *left);
	for (int q = 0; q < b->n; q++) {
		double size = 0, rest = 0;
		for (int k = 0; k < count; k++) {
			turn[k] = set >> k & 1 ? b->speed[k * b->n + q] : 0;
			for (int i = 0; i < k && set >> k & 1; i++)
				turn[k] -= b->stops[k * count + i] * turn[i];
		}
		for (int k = 0; k < count; k++)
			size += turn[k] * turn[k];
		pl_multiply(count, count, left, turn, off);
		for (int k = 0; k < count; k++)
			turn[k] -= off[k];
		for (int k = 0; k < count; k++)
			rest += turn[k] * turn[k];
		for (int k = 0; k < count * count && rest > 1e-20 * size; k++)
			left[k] += turn[k / count] * turn[k % count] / rest;
	}
}

/* After how many sweeps bounces of a set are at rest (stop_all of contacts.h): the speed that each has when its turn
 * comes is what those of others since its last turn have made of it. */
static int sweeps_of_set(const struct bouncing *b, unsigned set, bool single, double *left)
{
	const double calm = single ? 0x1p-40 : 0x1p-96; /* CALM, squared */
	const int count = b->count;
	double largest = 1;
	int sweeps = 1;
	project_on_speeds(b, set, left);
	for (; largest > calm && sweeps < MOST_SWEEPS; sweeps++) {
		largest = 0;
		for (int k = 0; k < count; k++) {
			double *row = left + k * count, sum = 0;
			memset(row, 0, (size_t)count * sizeof *row);
			for (int i = 0; i < count * count && set >> k & 1; i++)
				row[i % count] -= i / count != k ? b->stops[k * count + i / count] * left[i] : 0;
			for (int j = 0; j < count; j++)
				sum += fabs(row[j]);
			largest = fmax(largest, sum);
		}
	}
	return sweeps;
}

/* Of all sets, the most stops that bring one to rest; of more bounces than these those of MOST_SWEEPS are said */
static double most_stops(const struct step *step, bool single)
{
	enum { MOST_IN_SETS = 8 };
	const struct switching *s = step->model->switching;
	double most = 0;
	if (s->impacts > MOST_IN_SETS)
		return (double)s->impacts * MOST_SWEEPS;
	const struct bouncing b = bouncing_of(step);
	SCRATCH double *left = ARRAY(double, (size_t)(b.count * b.count) + 1);
	for (unsigned set = 1; set < 1u << b.count; set++) {
		int members = 0, bounces = 0;
		for (int i = 0; i < b.count; i++) {
			members += set >> i & 1;
			bounces += set >> i & 1 && s->impact[i].bounces;
		}
		if (bounces == members && members > 1)
			most = fmax(most, members * sweeps_of_set(&b, set, single, left));
	}
	return most;
}

/* ---- a search ---- */

/* Entries that are not 0, of the linear system that has most */
static int most_entries(const struct step *step)
{
	int most = 0;
	for (int k = 0; k < step->branches; k++) {
		SCRATCH double *A = slopes_of(step, k);
		int count = 0;
		for (int i = 0; i < step->layout.size * step->layout.size; i++)
			count += A[i] != 0;
		most = count > most ? count : most;
	}
	return most;
}

/* Of a step that goes in pieces beside a fast pole */
static double most_pieces(const struct step *step)
{
	int halvings = 0;
	for (int k = 0; k < step->branches; k++)
		halvings = step->branch[k].halvings > halvings ? step->branch[k].halvings : halvings;
	return halvings > 0 ? ldexp(1, halvings) : 0;
}

void count_search(const struct step *step, bool single, double part[SEARCH])
{
	enum { MOST_RESTING = 6, RUNG = 6 };    /* MOST of impacts.h; products to look whether a longer piece will do */
	const struct switching *s = step->model->switching;
	const struct program *p = step->program;
	const bool guards = has_events(s), few = step->regions.event_check.fast_path && !single;
	const double size = step->layout.size, degree = step->series.degree, entries = most_entries(step);
	const double stretches = 1 + most_changes_of_loads(step), pieces = most_pieces(step);
	const double events = max_events(step->model) * (guards ? stretches : 1);
	const double moves = events + 3 * stretches + pieces, rows = s->functions * (guards ? 2 : 1);
	part[SEARCH_CLEAR] = p->multiplications + p->additions;
	part[SEARCH_MOVED] = moves * degree * entries;
	part[SEARCH_SUMMED] = moves * degree * size;
	part[SEARCH_FOLLOWED] = moves * rows * degree;
	part[SEARCH_LOOKED] = (stretches * max_splits(step->model) + moves * rows) * degree;
	part[SEARCH_CHECKED] = few ? event_checks(step->model) * degree * entries : 0;
	part[SEARCH_ROWS] = (moves + s->impacts * events) * rows * size;
	part[SEARCH_RESTING] =
		guards ? (events + stretches) * pow(3, fmin(s->functions, MOST_RESTING)) * size * size : 0;
	part[SEARCH_SQUARES] = (moves + RUNG * pieces) * size * size;
	part[SEARCH_IMPACTS] = (events + stretches) * s->impacts;
	part[SEARCH_STEP] = stretches;
	/* what comes to rest is let go by an event, but for those that come first */
	part[SEARCH_SWEPT] = (events + s->impacts) * most_stops(step, single) * size;
}

/* ---- peaks ---- */

/* Terms until what is left of e^z is but rounding, twice */
static int terms_of(double z, bool single)
{
	enum { BESIDE = 4 };
	const double least = single ? 0x1p-26 : 0x1p-55;
	double term = 1;
	int terms = 0;
	for (; term > least || terms < z; terms++)
		term *= z / (terms + 1);
	return terms + BESIDE;
}

void count_peak_looks(const struct step *step, bool single, double part[PEAK])
{
	enum { LOOKS_A_TERM = 24, MOST_TERMS = 48 };    /* of peak.c */
	const double size = step->layout.size, peaks = peak_outputs(step->model);
	const double angle = peaks > 0 ? largest_pole_angle(step) : 0;
	double parts = 1, terms = 0;
	/* of the step, then of its halves, until each has no more terms than that */
	for (; terms_of(angle / parts, single) > MOST_TERMS; parts *= 2)
		terms += parts * MOST_TERMS;
	const double last = terms_of(angle / parts, single);
	terms += parts * last;
	part[PEAK_PRODUCTS] = peaks > 0 ? peaks * terms * most_entries(step) : 0;
	part[PEAK_TERMS] = peaks * terms * size;
	part[PEAK_LOOKED] = peaks * parts * LOOKS_A_TERM * last * (last + 1);
	part[PEAK_LISTED] = peaks * size * size;
	part[PEAKS] = peaks;
}
