/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Steps of piecewise-linear models: e^{A d} of each region for pieces d of the step; of parts that are independent, a
 * step each. */
#include "inner.h"
#include "model/contacts/contacts.h"
#include "step/cost.h"
#include "step/regions/guards.h"
#include "step/linear/forms.h"
#include "step/exponential/recipe.h"

#include <math.h>

/* Phi over a part of the step, and what inputs add: u held, and u' as the slope of u */
static struct wanted *wanted_piece(const struct step *step, int halvings)
{
	struct recipe *r = NEW(struct recipe);
	r->step = step;
	int piece = add_table(r, "piece", 1, 1ul << halvings, true);
	r->table[piece].two_words = step->is.two_words;
	r->table[piece].increments = step->is.two_words || halvings > 0;
	add_phi(r, piece, "held", 1, 1ul << halvings, 1, (long[]){ 1 });
	int ramp = add_phi(r, piece, "ramp", 1, 1ul << halvings, 2, (long[]){ 0, 1 });
	mpq_set(r->table[piece].phi_weight[ramp].part[0].power[1], step->model->h);
	return r->table;
}

/* Why a step of regions does not look over the whole of h first; NULL: it does */
static const char *no_check(const struct step *step)
{
	enum { TERMS = 400, BOUNDS = 1024 };
	const struct switching *s = step->model->switching;
	const bool events = has_events(s);
	bool turns = false;
	for (int k = 0; k < step->branches; k++)
		turns = turns || step->branch[k].halvings > !events;
	int matrices = 3 * step->branches * step->layout.size * step->layout.size;
	return s->cached ? "matrices are made when their regions are met"
	       : step->model->request.single                 ? "it is smaller, for the target float"
	       : s->segments > 1                         ? "loads change their formula in time"
	       : events && step->model->params.retuned          ? "what sticks, slips and bounces has tunable params"
	       : events && step->is.two_words ? "what sticks, slips and bounces is kept in two words"
	       : turns ? format("the fastest pole turns by more than %d in a step", events ? 1 : 2)
	       : s->regions * s->functions > BOUNDS     ? "there are too many regions"
	       : step->layout.size * (step->layout.states + s->functions) > TERMS ? "it would be more than a page"
	       : step->model->params.retuned && matrices > LIMIT_TUNED_NUMBERS
		       ? "an instance would have too many numbers, for tunable params"
		       : NULL;
}

bool is_checked_by_tables(const struct step *step)
{
	enum { TERMS = 200 };
	return possible_regions(step->model->switching) * step->layout.states * step->layout.size > TERMS;
}

/* ... but by numbers of each region, which lanes can; of guards search.h has the same limits */
static bool is_checked_by_region(const struct step *step)
{
	enum { REGIONS = 16, NUMBERS = 64 };
	const struct switching *s = step->model->switching;
	return has_events(s) ? s->regions <= REGIONS && s->regions * step->layout.size <= NUMBERS
			     : !is_checked_by_tables(step);
}

/* Over h or a shorter piece */
static struct table *table_over(const struct step *step, struct branch *b, int halvings)
{
	return tables_of(step->model, b->resolvent, &b->system, 1, wanted_piece(step, halvings))[0];
}

/* How often an entry of e^{A d} is multiplied: of two words the first with x and with its rest, the second with x */
static int products_of_words(const struct step *step)
{
	return step->is.two_words ? 3 : 1;
}

int products_of_piece(const struct step *step)
{
	bool ladder = false;
	for (int k = 0; k < step->branches; k++)
		ladder = ladder || step->branch[k].rungs > 0;
	int size = step->layout.size, functions = step->model->switching->functions;
	return size * (products_of_words(step) * size + (ladder ? 4 * size + 3 * functions + 1 : 6 * functions));
}

/* Where guards end regions: x on, what is held at both ends, each guard there and between; of the region with most */
long products_of_unmet(const struct step *step)
{
	const struct switching *s = step->model->switching;
	int most = 0;
	for (int r = 0; r < s->regions; r++) {
		int guards = s->region[r].releases;
		for (int e = 0; e < s->functions; e++) {
			const int interval = interval_of(s, r, e);
			if (!is_stick(&s->function[e], interval))
				guards += (interval > 0) + (interval < s->function[e].breaks);
		}
		const int rows = 2 * s->region[r].holds + 3 * guards;
		most = s->region[r].possible && rows > most ? rows : most;
	}
	return (long)(step->layout.size + most) * step->layout.size;
}

static void plan_check(struct step *step)
{
	bool any = false;
	step->regions.event_check.searches = no_check(step);
	step->regions.event_check.is_made = !step->regions.event_check.searches;
	step->regions.event_check.by_region = step->regions.event_check.is_made && is_checked_by_region(step);
	/* crossings go by tables of fixed numbers */
	step->regions.event_check.fast_path = step->regions.event_check.is_made && !step->model->params.retuned &&
				   !has_events(step->model->switching);
	for (int k = 0; k < step->branches; k++)
		any = any || step->branch[k].halvings > 0;
	if (!step->regions.event_check.is_made)
		return;
	int functions = step->model->switching->functions;
	step->program->multiplications =
		has_events(step->model->switching)
			? (int)products_of_unmet(step)
			: (products_of_words(step) * step->layout.states + functions) * step->layout.size;
	step->program->additions = step->program->multiplications + 2 * functions;
	step->regions.event_check.degree = any ? series_degree(step, 0, step->branches, 0) : step->series.degree;
}

/* ---- regions whose matrices the target makes ---- */

/* Above the size of every entry of A of any region */
static void add_sizes(const struct step *step, pl_two *most)
{
	const struct switching *s = step->model->switching;
	const int cells = step->layout.size * step->layout.size, in_one = regions_at_once(s);
	RATIONAL size = ZERO;
	for (int r = 0; r < s->regions; r++) {
		const int first = r / in_one * in_one;
		SCRATCH double *sum = ARRAY(double, cells);
		const mpq_t *A = augmented_matrix(&step->layout, &s->system[s->region[r].system], 0);
		const mpq_t *A0 = augmented_matrix(&step->layout, &s->system[s->region[first].system], 0);
		for (int i = 0; i < cells; i++) {
			mpq_abs(size, A[i]);
			if (r > first)
				mpq_sub(size, A[i], A0[i]);
			most[i].hi += fabs(round_rational(size)) * (1 + 1e-9);
		}
	}
}

/* So many that no region's fastest pole turns far in the shortest piece, whichever region it is */
static int halvings_of_all(const struct step *step)
{
	const int size = step->layout.size;
	SCRATCH pl_two *most = ARRAY(pl_two, (size_t)(size * size));
	SCRATCH double *work = ARRAY(double, 2 * (size_t)size);
	int halvings, spacing;
	add_sizes(step, most);
	if (pl_region_halvings(size, most, round_rational(step->model->h), LIMIT_PIECES, 1, &halvings, &spacing, work,
			       work + size) == PL_NOT_FINITE)
		report_range(step);
	return halvings;
}

int slots_of(const struct step *step)
{
	enum { BYTES = 1 << 20, LEAST = 8, MOST = 64 };
	const struct switching *s = step->model->switching;
	const long bytes = bytes_of_slot(step);
	const long fit = BYTES / bytes;
	/* so many that none goes while it is compared with what would stick and slip beside it */
	if (s->slots)
		return has_events(s) && s->slots < LEAST ? LEAST : s->slots;
	return fit < LEAST ? LEAST : fit > MOST ? MOST : (int)fit;
}

long bytes_of_slot(const struct step *step)
{
	const struct switching *s = step->model->switching;
	const long size = step->layout.size, rungs = room_for_rungs(step), real = step->model->request.single ? 4 : 8;
	int guards, holds;
	if (!has_events(s))
		return 16 + real * size * (2 * size + rungs * (size + 1 + s->functions) + 3 * s->functions);
	most_in_region(step, &guards, &holds);
	return 28 + real * size * (2 * size + rungs * (size + 1 + guards) + s->functions + 4 * guards + holds) +
	       (24 + 2 * real) * guards + 4 * holds;
}

static void halve_region(struct step *step, int k)
{
	const bool cached = step->model->switching->cached;
	step->branch[k].halvings = cached ? halvings_of_all(step) : series_halvings(step, k);
	if (step->branch[k].halvings > LIMIT_PIECES)
		error(step->model->request.at.step, "a smaller step would do",
		      "the largest pole times h is above 2^%d: too short pieces of a step to look for crossings in",
		      LIMIT_PIECES);
}

static void plan_region(struct step *step, int k)
{
	struct branch *b = &step->branch[k];
	plan_ladder(step, k);
	b->table = ARRAY(struct table *, b->rungs + 1);
	b->table[0] = b->full = k == 0 ? b->full : table_over(step, b, 0);
	for (int r = 0; r < b->rungs; r++)
		b->table[1 + r] = table_over(step, b, rung_halvings(b, r));
	b->system.force_columns = 0;
	int degree = series_degree(step, k, k + 1, b->halvings);
	step->series.degree = degree > step->series.degree ? degree : step->series.degree;
}

/* At other values the same |pole| d of 1 at most, but no more is known of the terms. */
static void plan_retuned(struct step *step)
{
	int least = step->model->request.single ? 10 : 18, size = step->layout.size;
	least += (size < 16 ? size : 16) / 2;
	step->series.degree = least > step->series.degree ? least : step->series.degree;
}

/* e^{A d} of each region for pieces d of the step, and the series that finds crossings. What is counted is without the
 * load states. */
static void build_switched(struct step *step)
{
	struct branch *first = step->branch;
	int force_columns = first->system.force_columns; /* ramps of inputs, while tables are made */
	choose_form_of_regions(step);
	step->tables = 1;
	first->full = table_over(step, first, 0);
	first->system.force_columns = 0;
	step->layout = layout_with(&first->system, 0, loads_of_regions(step));
	find_carries(step);
	plan_refresh(step);
	fill_refresh(step);
	step->program = linear_program(step);
	first->system.force_columns = force_columns;
	step->series.degree = 3;
	step->series.emitted = true;
	for (int k = 0; k < step->branches; k++)
		halve_region(step, k);
	for (int k = 0; k < step->branches; k++)
		plan_region(step, k);
	if (step->model->params.retuned || step->model->switching->cached)
		plan_retuned(step);
	step->program->additions = step->program->multiplications = products_of_piece(step);
	plan_check(step);
}

void build_regions_step(struct step *step)
{
	build_switched(step);
	count_regions(step, step->program->multiplications, step->program->additions);
}

/* ---- independent parts ---- */

/* Of the part's own model, as if it were alone */
static struct step *step_of_part(const struct step *full, const struct region_part *part)
{
	struct step *step = NEW(struct step);
	step->model = part->model;
	step->shown = full;
	step->is = full->is;
	step->is.apart = false;
	step->no.refresh = "a part is given its load states";
	take_operators(step);
	step->written = step->branch->resolvent;
	build_switched(step);
	return step;
}

static void carry_of_parts(struct step *step)
{
	const struct switching *s = step->model->switching;
	int states = step->branch->system.states;
	step->carried.place = ARRAY(int, states);
	for (int i = 0; i < states; i++)
		step->carried.place[i] = -1;
	for (int p = 0; p < step->regions.parts; p++)
		for (int i = 0; i < step->regions.part[p]->layout.states; i++)
			if (step->regions.part[p]->carried.place[i] >= 0)
				step->carried.place[s->part[p].state[i]] = step->carried.count++;
}

/* The load states are those of all. */
static void count_parts(struct step *step)
{
	int multiplications = 0, additions = 0;
	step->program = linear_program(step);
	for (int p = 0; p < step->regions.parts; p++) {
		const struct step *part = step->regions.part[p];
		multiplications += part->program->multiplications;
		additions += part->program->additions;
		step->series.degree =
			part->series.degree > step->series.degree ? part->series.degree : step->series.degree;
	}
	step->series.emitted = true;
	count_regions(step, multiplications, additions);
}

/* The table of the whole is that of the first regions, for NAME_Phi and the report. */
void build_parts_step(struct step *step)
{
	const struct switching *s = step->model->switching;
	struct branch *first = step->branch;
	choose_form_of_regions(step);
	step->tables = 1;
	first->table = tables_of(step->model, first->resolvent, &first->system, 1, wanted_piece(step, 0));
	first->full = first->table[0];
	first->system.force_columns = 0;
	step->regions.parts = s->parts;
	step->regions.part = ARRAY(struct step *, s->parts);
	for (int p = 0; p < s->parts; p++)
		step->regions.part[p] = step_of_part(step, &s->part[p]);
	step->layout = layout_with(&first->system, 0, loads_of_regions(step));
	carry_of_parts(step);
	plan_refresh(step);
	fill_refresh(step);
	count_parts(step);
}
