/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scheme takes the equations apart into what is solved exactly and what is held over a step, and writes the step as
 * a program over the tables of the exact part. */
#include "step/step.h"

/* A page that a person reads is unrolled; what is larger, has several operators, or loads that change, loops over its
 * tables. */
static bool is_page(const struct step *step)
{
	enum { TERMS = 320 };
	int terms = 0;
	for (int i = 0; i < step->program->actions; i++) {
		const struct action *a = &step->program->action[i];
		if (a->kind == ACTION_SUM)
			terms += step->branch->system.states * ((a->flow != NONE ? step->branch->system.states : 0) +
								a->kernels * step->branch->system.channels);
	}
	return step->branches == 1 && step->branch->system.segments == 1 &&
	       step->branch->system.states <= LIMIT_UNROLLED_STATES && terms <= TERMS;
}

static void mark_loads(const struct step *step, struct program *program)
{
	const struct linear *system = &step->branch->system;
	for (int l = 0, column = 0; l < system->loads; l++)
		for (int k = 0; k < system->load[l].columns; k++, column++)
			program->uses[column] = load_acts(system, &system->load[l]);
}

/* ---- the whole ---- */

static void find_growth(struct step *step)
{
	struct linear modified = modified_equation(&step->model->system, &step->branch->system, step->model->h);
	struct pole_report *pole;
	int poles = poles_of(step->model, resolvent_of(&modified), &pole);
	mpfr_init2(step->growth, 53);
	mpfr_set_inf(step->growth, -1);
	for (int i = 0; i < poles; i++)
		mpfr_max(step->growth, step->growth, pole[i].re, MPFR_RNDN);
}

/* The ramps of inputs as channels: u', held and as the slope of u */
static struct linear driven_system(const struct linear *region)
{
	struct linear system = *region;
	system.channels = 2 * region->inputs;
	system.channel = ARRAY(mpq_t *, (size_t)system.channels);
	for (int i = 0; i < system.channels; i++)
		system.channel[i] = region->input[i / 2].force[i % 2];
	return system;
}

/* The linear system of each operator, and what of it a step takes */
static void take_operators(struct step *step)
{
	const struct model *model = step->model;
	const struct switching *regions = model->switching;
	bool holds = scheme_row(model->scheme)->holds_coupling;
	step->branches = regions ? regions->systems : model->operators ? model->operators : 1;
	step->branch = ARRAY(struct branch, (size_t)step->branches);
	for (int k = 0; k < step->branches; k++) {
		struct linear system = regions		  ? driven_system(&regions->system[k])
				       : model->operators ? operator_system(model, k)
							  : model->system;
		bool as_written = !regions && !model->operators && model->written == model && !holds;
		step->branch[k].system = holds ? piecewise_laplace(&system) : system;
		step->branch[k].resolvent = as_written ? step->written : resolvent_of(&step->branch[k].system);
		check_pole_size(model, step->branch[k].resolvent);
	}
}

static void make_tables(struct step *step, int count, const struct wanted *wanted)
{
	step->tables = count;
	for (int k = 0; k < step->branches; k++)
		step->branch[k].table =
			tables_of(step->model, step->branch[k].resolvent, &step->branch[k].system, count, wanted);
	step->branch->whole = step->branch[0].table[0];
}

static void make_whole(void *context)
{
	struct step *step = context;
	struct wanted *whole = NEW(struct wanted);
	*whole = (struct wanted){ .Phi = true,
				  .two_words = true,
				  .name = "full",
				  .increments = step->form == FORM_DELTA,
				  .mass = step->mass };
	mpq_init(whole->fraction);
	mpq_set_ui(whole->fraction, 1, 1);
	make_tables(step, 1, whole);
}

static void build_exact(struct step *step)
{
	choose_form(step);
	bool chosen = step->model->asked.form == FORM_AUTO && step->form == FORM_KICK_DRIFT_KICK;
	if (chosen && !silent_guard(make_whole, step)) {        /* kicks may leave the range where Phi does not */
		step->form = FORM_DELTA;
		step->mass = NULL;
		step->momenta = chosen = false;
	}
	if (!chosen)
		make_whole(step);
	if (step->model->tuning)
		mark_tuned_zeros(step);
	leave_out_lost(step);
	find_carries(step);
	plan_anchors(step);
	step->program = linear_program(step);
	plan_modal(step);
	if (!step->modal)
		plan_forced(step);
	if (step->forced)
		step->program = linear_program(step);
	fill_anchors(step);
	plan_rest(step);
}

/* Phi over a part of the step, and what inputs add: u held, and u' as the slope of u */
static struct wanted *wanted_piece(const struct step *step, int halvings)
{
	struct recipe *r = NEW(struct recipe);
	r->step = step;
	int piece = add_table(r, "piece", 1, 1ul << halvings, true);
	add_phi(r, piece, "held", 1, 1ul << halvings, 1, (long[]){ 1 });
	int ramp = add_phi(r, piece, "ramp", 1, 1ul << halvings, 2, (long[]){ 0, 1 });
	mpq_set(r->table[piece].kernel[ramp].part[0].power[1], step->model->h);
	return r->table;
}

/* Why a step of regions does not look over the whole of h first; NULL: it does */
static const char *no_swift(const struct step *step)
{
	enum { TERMS = 400, BOUNDS = 1024 };
	const struct switching *s = step->model->switching;
	bool turns = false;
	for (int k = 0; k < step->branches; k++)
		turns = turns || step->branch[k].halvings > 1;
	return step->model->asked.single                 ? "it is smaller, for the target float"
	       : turns                                   ? "the fastest pole turns by more than 2 in a step"
	       : s->regions * s->expressions > BOUNDS     ? "there are too many regions"
	       : step->layout.size * (step->layout.states + s->expressions) > TERMS ? "it would be more than a page"
									      : NULL;
}

/* Tables over the whole of h, of a region that has pieces of half of it */
static void plan_whole(struct step *step, int k)
{
	struct branch *b = &step->branch[k];
	if (b->halvings == 0)
		b->whole = b->table[0];
	else if (b->halvings == 1 && k > 0)
		b->whole = tables_of(step->model, b->resolvent, &b->system, 1, wanted_piece(step, 0))[0];
}

static void plan_swift(struct step *step)
{
	bool any = false;
	step->searches = no_swift(step);
	step->swift = !step->searches;
	for (int k = 0; k < step->branches; k++)
		any = any || step->branch[k].halvings > 0;
	if (!step->swift)
		return;
	int expressions = step->model->switching->expressions;
	int products = (step->layout.states + expressions) * step->layout.size;
	count_regions(step, products, products + 2 * expressions);
	step->swift_degree = any ? series_degree(step, 0, step->branches, 0) : step->series.degree;
}

static void plan_region(struct step *step, int k)
{
	step->branch[k].halvings = series_halvings(step, k);
	if (step->branch[k].halvings > LIMIT_PIECES)
		error(step->model->asked.step_at, "a smaller step would do",
		      "the largest pole times h is above 2^%d: too many pieces of a step to look for crossings in",
		      LIMIT_PIECES);
	struct linear *system = &step->branch[k].system;
	step->branch[k].table = tables_of(step->model, step->branch[k].resolvent, system, 1,
					  wanted_piece(step, step->branch[k].halvings));
	plan_whole(step, k);
	system->channels = 0;
	int degree = series_degree(step, k, k + 1, step->branch[k].halvings);
	step->series.degree = degree > step->series.degree ? degree : step->series.degree;
}

/* A piecewise-linear model: e^{A d} of each region for pieces d of the step, and the series that finds crossings */
static void build_regions_step(struct step *step)
{
	struct branch *first = step->branch;
	int channels = first->system.channels;  /* ramps of inputs, while tables are made */
	need_direct(step);
	step->tables = 1;
	first->whole = tables_of(step->model, first->resolvent, &first->system, 1, wanted_piece(step, 0))[0];
	first->system.channels = 0;
	step->layout = layout_with(&first->system, 0, loads_of_regions(step));
	find_carries(step);
	plan_anchors(step);
	fill_anchors(step);
	step->program = linear_program(step);
	int products = (step->layout.size + 6 * step->model->switching->expressions) * step->layout.size;
	count_regions(step, products, products);
	first->system.channels = channels;
	step->series.degree = 3;
	step->series.emitted = true;
	for (int k = 0; k < step->branches; k++)
		plan_region(step, k);
	plan_swift(step);
}

static void build_with_leftover(struct step *step)
{
	struct recipe *recipe = NEW(struct recipe);
	recipe->step = step;
	recipe->program = step->program = NEW(struct program);
	write_recipe(recipe);
	make_tables(step, recipe->tables, recipe->table);
	find_carries(step);
	step->program->reads = ARRAY(bool, (size_t)step->branch->system.states);
	step->program->uses = ARRAY(bool, (size_t)step->branch->whole->columns);
	step->program->loops = !is_page(step);
	mark_loads(step, step->program);
	count_program(step, step->program);
	count_loads(step->program, step);
}

/* Of tunable models: no Taylor series in the step's own time, but e^{A tau} at any, of every load */
static void place_all_loads(struct step *step)
{
	bool *all = ARRAY(bool, (size_t)step->branch->system.loads);
	for (int l = 0; l < step->branch->system.loads; l++)
		all[l] = true;
	step->layout = layout_with(&step->branch->system, 0, all);
	step->series.emitted = true;
}

static void build_linear_step(struct step *step)
{
	step->layout = layout_of(&step->branch->system, false);
	build_exact(step);
	series_plan(step);
}

static void build_tuned_step(struct step *step)
{
	place_all_loads(step);
	build_exact(step);
}

static void build_leftover_step(struct step *step)
{
	need_direct(step);
	step->layout = layout_of(&step->branch->system, scheme_row(step->model->scheme)->holds_leftover);
	build_with_leftover(step);
	series_plan(step);
}

/* e^{A h} is for readers of the table alone. */
static void build_expanded_step(struct step *step)
{
	struct recipe *recipe = NEW(struct recipe);
	int states = step->branch->system.states;
	recipe->step = step;
	need_direct(step);
	step->layout = layout_of(&step->branch->system, false);
	add_table(recipe, "full", 1, 1, true);
	make_tables(step, recipe->tables, recipe->table);
	step->carry = ARRAY(int, (size_t)states);
	step->program = NEW(struct program);
	step->program->compensated = true;
	step->program->reads = ARRAY(bool, (size_t)states);
	step->program->uses = ARRAY(bool, (size_t)step->branch->whole->columns);
	for (int i = 0; i < states; i++) {
		step->carry[i] = -1;
		step->program->reads[i] = true;
	}
	step->expansion = expansion_of(step);
	step->series.emitted = true;
	count_expansion(step, step->program);
	if (step->program->multiplications > LIMIT_SERIES)
		error(step->model->asked.scheme_at, "etdrk4 and the schemes like it loop over tables",
		      "its series of order %d has %d multiplications, more than the limit of %d: compilers take minutes",
		      step->expansion->order, step->program->multiplications, LIMIT_SERIES);
}

static void build(void *context)
{
	static void (*const build_kind[KINDS])(struct step *) = {
		[KIND_LINEAR] = build_linear_step, [KIND_TUNED] = build_tuned_step,
		[KIND_REGIONS] = build_regions_step, [KIND_LEFTOVER] = build_leftover_step,
		[KIND_EXPANDED] = build_expanded_step
	};
	struct step *step = context;
	const struct model *model = step->model;
	step->kind = kind_of_step(model);
	step->form = FORM_DIRECT;
	step->written = resolvent_of(&model->written->system);
	check_pole_size(model, step->written);
	check_holds(step);
	take_operators(step);
	if (scheme_row(model->scheme)->holds_coupling)
		find_growth(step);
	check_anchors(step);
	build_kind[step->kind](step);
	if (model->asked.selftest)
		need_closed_form(step);
	if (model->asked.batch)
		need_batch(step);
	check_peaks(step);
	count_peaks(step);
	program_check(step);
	plan_phases(step);
	plan_rows(step);
}

struct step *step_build(const struct model *model)
{
	struct step *step = NEW(struct step);
	step->model = model;
	step->shown = step;
	if (!statement_guard(build, step))
		return NULL;
	if (!model->relative)
		return step;
	struct model *plain = NEW(struct model);
	*plain = *model->written;
	plain->asked.form = FORM_DIRECT;
	plain->asked.compensated = plain->asked.selftest = plain->asked.batch = false;
	plain->asked.anchors = plain->asked.rows = 1;
	step->shown = step_build(plain);
	return step->shown ? step : NULL;
}
