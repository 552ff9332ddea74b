/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A scheme takes the equations apart into what is solved exactly and what is held over a step, and writes the step as
 * a program over the tables of the exact part. */
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "step/collocation/collocation.h"
#include "cost.h"
#include "step/series/switching.h"
#include "step/series/expansion.h"
#include "step/linear/forms.h"
#include "step/linear/images.h"
#include "step/exponential/normal.h"
#include "step/exponential/recipe.h"
#include "step/regions/regions.h"
#include "step/linear/rows.h"
#include "step/tunable/tuned.h"

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
								a->phi_weights * step->branch->system.force_columns);
	}
	return step->branches == 1 && !loads_change(&step->branch->system) &&
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
	mpfr_init2(step->linear.growth, 53);
	mpfr_set_inf(step->linear.growth, -1);
	for (int i = 0; i < poles; i++)
		mpfr_max(step->linear.growth, step->linear.growth, pole[i].re, MPFR_RNDN);
}

static void make_tables(struct step *step, int count, const struct wanted *wanted)
{
	step->tables = count;
	for (int k = 0; k < step->branches; k++)
		step->branch[k].table =
			tables_of(step->model, step->branch[k].resolvent, &step->branch[k].system, count, wanted);
	step->branch->full = step->branch[0].table[0];
}

static void make_full(void *context)
{
	struct step *step = context;
	struct wanted *full = NEW(struct wanted);
	*full = (struct wanted){ .Phi = true,
				  .two_words = true,
				  .name = "full",
				  .increments = step->form == FORM_DELTA,
				  .mass = step->linear.kicks.mass };
	mpq_init(full->fraction);
	mpq_set_ui(full->fraction, 1, 1);
	make_tables(step, 1, full);
}

static void build_exact(struct step *step)
{
	choose_form(step);
	bool chosen = step->model->request.form == FORM_AUTO && step->form == FORM_KICK_DRIFT_KICK;
	if (chosen && !silent_guard(make_full, step)) {         /* kicks may leave the range where Phi does not */
		step->form = FORM_DELTA;
		step->linear.kicks.mass = NULL;
		step->linear.kicks.momenta = chosen = false;
	}
	if (!chosen)
		make_full(step);
	if (step->model->params.tuning)
		mark_tuned_zeros(step);
	leave_out_lost(step);
	find_carries(step);
	plan_refresh(step);
	step->program = linear_program(step);
	plan_modal(step);
	if (!step->modal)
		plan_forced(step);
	if (step->forced)
		step->program = linear_program(step);
	fill_refresh(step);
}

static void build_with_remainder(struct step *step)
{
	struct recipe *recipe = NEW(struct recipe);
	recipe->step = step;
	recipe->program = step->program = NEW(struct program);
	write_recipe(recipe);
	if (step->layout.powers == PARABOLA) {  /* what NAME_at asks for */
		add_node(recipe, 1, 2);
		add_node(recipe, 1, 1);
	}
	make_tables(step, recipe->tables, recipe->table);
	find_carries(step);
	step->program->reads = ARRAY(bool, step->branch->system.states);
	step->program->uses = ARRAY(bool, step->branch->full->columns);
	step->program->loops = !is_page(step);
	mark_loads(step, step->program);
	count_program(step, step->program);
	count_loads(step->program, step);
}

/* Of tunable models: no Taylor series in the step's own time, but e^{A tau} at any, of every load */
static void place_all_loads(struct step *step)
{
	bool *all = ARRAY(bool, step->branch->system.loads);
	for (int l = 0; l < step->branch->system.loads; l++)
		all[l] = true;
	step->layout = layout_with(&step->branch->system, 0, all);
	step->series.emitted = true;
}

static void build_linear_step(struct step *step)
{
	step->layout = layout_of(&step->branch->system, false);
	build_exact(step);
	if (!step->model->request.again.trial || loads_change(&step->branch->system) || peak_outputs(step->model) > 0)
		series_plan(step);
}

static void build_tuned_step(struct step *step)
{
	place_all_loads(step);
	build_exact(step);
	plan_tuned_blocks(step);
}

/* Events of a recipe are of what has mass: what slides without has no equation that gives its velocity. */
static void check_sliders(const struct step *step)
{
	const struct model *model = step->model;
	bool *seen = ARRAY(bool, (size_t)atoms_count(model->equations.atoms));
	for (int k = 0; k < model->remainder.force_columns; k++) {
		const struct form *left = model->schedule.operator[0].left[k];
		for (const struct form_term **term = terms_within(left, seen); *term; term++) {
			const struct atom *atom = (*term)->basis.atom;
			if (atom && atom->kind == ATOM_CALL && atom->function == FN_SLIDE)
				error(atom->node->start,
				      "with a small mass it does; scheme exact takes it beside "
				      "what is piecewise linear",
				      "scheme %s: friction of what has no mass does not stop at events",
				      scheme_name(model->scheme));
		}
	}
}

static void build_remainder_step(struct step *step)
{
	check_sliders(step);
	step->layout = layout_of(&step->branch->system, scheme_row(step->model->scheme)->holds_remainder ? 1
							: step->is.events == EVENTS_NONE ? PARABOLA : 0);
	build_with_remainder(step);
	series_plan(step);
}

struct reading { struct step *step; unsigned long parts; };    /* h times 0, or 1 */

/* e^{A h}, for readers of the table alone */
static void make_read_table(void *context)
{
	struct reading *reading = context;
	struct recipe *recipe = NEW(struct recipe);
	recipe->step = reading->step;
	add_table(recipe, "full", (long)reading->parts, 1, true);
	make_tables(reading->step, recipe->tables, recipe->table);
}

/* Neither assignments nor actions: all states are read */
static void write_no_list(struct step *step)
{
	int states = step->branch->system.states;
	step->carried.place = ARRAY(int, states);
	step->program = NEW(struct program);
	step->program->reads = ARRAY(bool, states);
	step->program->uses = ARRAY(bool, step->branch->full->columns);
	for (int i = 0; i < states; i++) {
		step->carried.place[i] = -1;
		step->program->reads[i] = true;
	}
}

/* Of this order; 0: of the cheapest */
static void build_series(struct step *step, int order)
{
	write_no_list(step);
	step->program->compensated = true;
	order = order ? order : economical_order(step);
	if (!step->taylor.expansion || step->taylor.expansion->order != order)
		step->taylor.expansion = expansion_of(step, order);
	step->series.emitted = true;
}

static int share(int of_expansion, int of_rows, int over)
{
	return (of_expansion + of_rows + over - 1) / over;
}

/* Of a step: its share of the expansion, and of the values before the last by Horner's rule */
static void share_series(const struct step *step, struct program *program)
{
	int over = step->model->truncation.over, terms = step->branch->system.states * step->taylor.expansion->order;
	int rows = over - 1, sums = step->branch->system.states * (step->taylor.expansion->order + 1);
	program->multiplications = share(program->multiplications, rows * terms, over);
	program->additions = share(program->additions, rows * sums, over);
	program->forcing_multiplications = share(program->forcing_multiplications, 0, over);
	program->forcing_additions = share(program->forcing_additions, 0, over);
	program->calls = share(program->calls, 0, over);
}

static void count_series(struct step *step)
{
	count_expansion(step, step->program);
	step->taylor.expansion->multiplications = step->program->multiplications;
	if (step->program->multiplications > LIMIT_SERIES)
		error(step->model->request.at.scheme, "etdrk4 and the schemes like it loop over tables",
		      "its series of order %d has %d multiplications, more than the limit of %d: compilers take "
		      "minutes",
		      step->taylor.expansion->order, step->program->multiplications, LIMIT_SERIES);
	share_series(step, step->program);
}

/* A step that does not read e^{A h} has a table without it where h is that of rare outputs, and it beyond all range. */
static void read_table_if_there(struct step *step)
{
	if (silent_guard(make_read_table, &(struct reading){ step, 1 }))
		return;
	make_read_table(&(struct reading){ step, 0 });
	step->no.phi = format("e^{A h} is beyond the range of %s", target_name());
}

/* One expansion over several steps knows what acts in all of them, and is of one formula. */
static void need_all_known(struct step *step)
{
	const struct linear *system = &step->branch->system;
	const struct model *model = step->model;
	const char *why = system->inputs > 0 ? format("the samples of %s to come are not known", system->input[0].name)
			  : loads_change(system) ? "a load or a condition on t changes its formula inside"
			  : step->taylor.switching ? format("it ends where %s passes a breakpoint",
						   form_text(model, step->taylor.switching->function[0].form))
					  : NULL;
	if (model->truncation.over < 2 || !why)
		return;
	stand_aside(model->request.series.over->start, format("over %d", model->truncation.over), why);
	step->plain = model_copy(model);
	step->plain->truncation.over = 1;
	abandon();
}

/* The slopes of all states from a state alone, by which a series is judged */
static void find_slopes(struct step *step)
{
	int states = step->branch->system.states, *column = ARRAY(int, states);
	for (int i = 0; i < states; i++)
		column[i] = i;
	if (step->taylor.unresolved && step->taylor.unresolved->looks)
		step->taylor.slopes = part_of_expansion(step, step->taylor.expansion, 1, states, column);
}

static void divide_step(struct step *step)
{
	step->taylor.switching = step->taylor.expansion->functions > 0 ? step->taylor.expansion : NULL;
	check_series_switching(step);
	const struct expansion *x = step->taylor.expansion;
	if (x->motion)
		step->taylor.motion = motion_of_expansion(step, x);
	step->taylor.unresolved = x->unresolved_functions > 0 || x->looks || x->crowded > 0 ? x : NULL;
}

static void build_expanded_step(struct step *step)
{
	step->layout = layout_of(&step->branch->system, false);
	read_table_if_there(step);
	build_series(step, 0);
	divide_step(step);
	need_all_known(step);
	find_slopes(step);
	count_series(step);
}

/* What has no series, a step of this kind cannot do either: beside a series it is that, else one to find it out. */
static void build_collocated_step(struct step *step)
{
	enum { AT_EVENTS = 4 };         /* derivatives that say what holds, slips or flies there */
	bool switches = scheme_row(step->model->scheme)->switches;
	int coords = step->model->n;
	if (coords > LIMIT_COLLOCATED)
		error(step->model->request.at.scheme, "etdrk4 and the schemes like it loop over tables",
		      "scheme %s is built for up to %d coordinates, whose matrices stand on the stack: the model has "
		      "%d",
		      scheme_name(step->model->scheme), LIMIT_COLLOCATED, coords);
	step->layout = layout_of(&step->branch->system, false);
	read_table_if_there(step);
	build_series(step, has_contacts(step->model) && !switches ? AT_EVENTS : 0);
	divide_step(step);
	step->collocation = collocation_of(step);
	step->collocation->motion = motion_of(step);
	if (switches) {
		find_slopes(step);
		count_series(step);
	} else {
		step->taylor.expansion = NULL;
	}
	count_collocation(step);
}

/* Times in a step at which forces are evaluated are those of a step by collocation. */
static void build_normal_step(struct step *step)
{
	step->layout = layout_of(&step->branch->system, false);
	make_read_table(&(struct reading){ step, 1 });
	write_no_list(step);
	const struct normal *normal = normal_of(step);
	step->program->nodes = normal->collocation.stages + 1;
	step->program->node = normal->collocation.node;
	count_normal(step, step->program);
	step->series.emitted = normal->within.angle <= LIMIT_WITHIN;
}

/* The flow's own step, and what is cut of it */
static void build_flow(struct step *step)
{
	static void (*const build_of[])(struct step *) = {
		[FLOW_LINEAR] = build_linear_step, [FLOW_RECIPE] = build_remainder_step,
		[FLOW_SERIES] = build_expanded_step, [FLOW_COLLOCATION] = build_collocated_step,
		[FLOW_NORMAL] = build_normal_step
	};
	if (step->is.events == EVENTS_OF_REGIONS)
		(step->is.apart ? build_parts_step : build_regions_step)(step);
	else
		(step->is.tuned ? build_tuned_step : build_of[step->is.flow])(step);
	if (step->is.events == EVENTS_SPLIT)
		plan_event_split(step);
	plan_flush(step);
}

/* Where a model is stepped in several ways, that of the equations as written is made once. */
static struct resolvent *resolvent_of_written(const struct model *model)
{
	static const struct model *last;
	static struct resolvent *made;
	const struct model *written = model->reduction.truncated ? model : model->written;
	if (written != last || !made)
		made = resolvent_of(&written->system);
	last = written;
	return made;
}

/* Friction and impacts are events inside steps. */
static void check_event_splits(const struct model *model)
{
	if (has_contacts(model) && !scheme_row(model->scheme)->expands)
		refuse(CAN_SPLIT, model, model->request.at.scheme);
}

/* States of the largest block of damped equations that act on each other */
static int most_coupled(const struct linear *system)
{
	const int n = system->n;
	SCRATCH bool *filled = ARRAY(bool, (size_t)n * (size_t)n), *damped = ARRAY(bool, (size_t)n + 1);
	int *block = ARRAY(int, 2 * (size_t)n), *states = ARRAY(int, (size_t)n + 1), most = 0;
	for (int i = 0; i < n * n; i++)
		filled[i] = mpq_sgn(system->M[i]) || mpq_sgn(system->C[i]) || mpq_sgn(system->K[i]);
	const int blocks = matrix_blocks(n, filled, block);
	for (int i = 0; i < n * n; i++)
		damped[block[n + i % n]] |= mpq_sgn(system->C[i]) != 0;
	for (int i = 0; i < n; i++)
		states[block[n + i]] += mpq_sgn(system->M[i * n + i]) != 0 ? 2 : 0;
	for (int k = 0; k < blocks; k++)
		most = damped[k] && states[k] > most ? states[k] : most;
	return most;
}

/* Before B(s), which takes long where e^{A h} then finds no room: that of 320 states takes 430 MB */
static void check_coupled(const struct model *model)
{
	enum { MOST = 384 };
	const int coupled = flow_of(model) == FLOW_LINEAR ? most_coupled(&model->system) : 0;
	if (coupled > MOST)
		error(model->spec->name_at,
		      "declare the outputs, and 'modes N' or a 'need' keeps the modes that they take",
		      "%d states of damped coordinates act on each other: e^{A h} of more than %d takes more memory "
		      "than the limit of %d bytes", coupled, MOST, LIMIT_BYTES);
}

static void build(void *context)
{
	struct step *step = context;
	const struct model *model = step->model;
	check_event_splits(model);
	step->is = descriptor_of(model);
	step->form = FORM_DIRECT;
	check_coupled(model);
	step->written = resolvent_of_written(model);
	check_pole_size(model, step->written);
	check_holds(step);
	if (step->is.flow == FLOW_NORMAL)
		refuse(CAN_NORMAL, model, scheme_place(step));
	if (step->is.two_words)
		refuse(CAN_COMPENSATED, model, model->request.at.compensated);
	take_operators(step);
	if (scheme_row(model->scheme)->holds_coupling)
		find_growth(step);
	check_step_form(step);
	check_refresh(step);
	build_flow(step);
	if (step->is.many)
		step->no.lanes = step_objection(step, CAN_LANES);
	check_peaks(step);
	count_peaks(step);
	program_check(step);
	plan_phases(step);
	if (!model->request.again.trial)
		plan_rows(step);
}

struct step *step_build(const struct model *model)
{
	struct step *step = NEW(struct step);
	step->model = model;
	step->shown = step;
	if (!statement_guard(build, step))
		return step->plain ? step_build(step->plain) : NULL;
	if (!model->relative)
		return step;
	struct model *plain = NEW(struct model);
	*plain = *model->written;
	plain->request.form = FORM_DIRECT;
	plain->request.compensated = plain->request.selftest = plain->request.many.batch = false;
	plain->request.refresh = plain->request.rows = 1;
	step->shown = step_build(plain);
	return step->shown ? step : NULL;
}
