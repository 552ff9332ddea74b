/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The nonlinear remainder as a function of the state: what it reads, how it is called, its text. */
#include "inner.h"
#include "emit/steps.h"
#include "emit/tunable/tunable.h"
#include "model/reads.h"
#include "model/regions/regions.h"
#include "step/exponential/weights.h"

/* ---- what the remainder reads, and how it is called ---- */

bool many_operators(const struct emitter *e)
{
	return e->model->schedule.operators > 1;
}

bool any_of(const bool *flag, int count)
{
	for (int i = 0; i < count; i++)
		if (flag[i])
			return true;
	return false;
}

/* The value of a ramp, which differs from one time in a step to another */
static bool reads_ramp(const struct emitter *e, const struct reads *r)
{
	for (int i = 0; i < e->system->inputs; i++)
		if (e->system->input[i].hold && r->input[i])
			return true;
	return false;
}

bool is_row_of_regions(const struct model *model, int coord)
{
	return model->switching && model->switching->highest && model->switching->highest[coord] >= 0;
}

static bool reads_force_column(const struct model *model, int force_column)
{
	bool any = false;
	for (int i = 0; i < model->outputs; i++)
		any = any || (!model->output[i].left && mpq_sgn(model->output[i].force_column[force_column]) != 0);
	for (int k = 0; k < model->n; k++)
		any = any || (model->equations.highest[k] && !is_row_of_regions(model, k) &&
			      mpq_sgn(model->equations.highest[k]->force_column[force_column]) != 0);
	return any;
}

bool reads_force_columns(const struct model *model)
{
	bool any = false;
	for (int c = 0; c < model->remainder.force_columns; c++)
		any = any || reads_force_column(model, c);
	return any;
}

/* Beside friction outputs alone ask the remainder, and of equations that have none: its force is no formula. */
static bool is_read(const struct emitter *e, int force_column)
{
	return e->model->contacts.drags == 0 || reads_force_column(e->model, force_column);
}

static struct reads reads_of_remainder(const struct emitter *e)
{
	int force_columns = e->model->remainder.force_columns, all = force_columns * e->model->schedule.operators,
		requested = 0;
	const struct form **form = ARRAY(const struct form *, (size_t)all + 1);
	for (int k = 0; k < e->model->schedule.operators; k++)
		for (int c = 0; c < force_columns; c++)
			if (is_read(e, c))
				form[requested++] = e->model->schedule.operator[k].left[c];
	return reads_of(e->model, requested, form);
}

static bool needs_node(const struct emitter *e, const struct reads *r)
{
	if (e->step->normal)            /* outputs alone call it */
		return false;
	return e->step->program->nodes > 1 && (r->time || any_of(r->load, e->system->loads) || reads_ramp(e, r));
}

const char *samples_of_step(const struct emitter *e)
{
	return e->ramps ? "start, slope" : given_inputs(e) ? "u, NULL" : "NULL, NULL";
}

const char *remainder_of_step(const struct emitter *e, int node, const char *state, const char *remainder)
{
	return spell(e, "$n_remainder(s, %s, %d, %s, %s, %s);", many_operators(e) ? "which" : "0", node,
		     samples_of_step(e), state, remainder);
}

const char *remainder_of_outputs(const struct emitter *e)
{
	return spell(e, "$n_remainder(s, 0, 0, %s, %s, %s, remainder);", given_inputs(e) ? "s->u" : "NULL",
		     e->ramps ? "s->slope" : "NULL", e->step->normal ? "now" : "s->y");
}

/* ---- a schedule: linear terms that differ from operator to operator ---- */

static void emit_excess(const struct emitter *e, const struct schedule *schedule)
{
	const int size[] = { e->model->schedule.operators, schedule->count };
	const char **note = ARRAY(const char *, (size_t)e->model->schedule.operators);
	for (int k = 0; k < e->model->schedule.operators; k++)
		note[k] = e->model->schedule.operator[k].text;
	emit_array(e, "What the linear terms of the equations exceed those of each operator by", "excess", 2, size,
		   schedule->factor, note);
}

/* A force column's form, and what the operator that serves does not have of its linear terms */
static tape_ref with_excess(struct formulas *f, int force_column, tape_ref form, const struct schedule *schedule)
{
	struct tape *t = formulas_tape(f);
	tape_ref *term = ARRAY(tape_ref, (size_t)schedule->count + 1);
	int terms = 0;
	for (int i = 0; i < schedule->count; i++) {
		const struct excess *excess = &schedule->excess[i];
		if (excess->force_column == force_column)
			term[terms++] = tape_binary(t, TAPE_MUL, tape_operand(t, TAPE_TABLE, i, TABLE_EXCESS),
						    tape_operand(t, TAPE_COORD, excess->coord, excess->order));
	}
	if (terms == 0)
		return form;
	tape_ref sum = tape_sum(t, terms, term);
	return form == tape_number(t, 0) ? sum : tape_binary(t, TAPE_ADD, form, sum);
}

/* ---- the function ---- */

static void emit_nodes(const struct emitter *e, const struct reads *r)
{
	if (r->time || reads_ramp(e, r))
		emit_node_times(e);
	if (any_of(r->load, e->system->loads))
		emit_node_phases(e, r->load);
}

static void emit_remainder_locals(const struct emitter *e, const struct reads *r, const char *vector, bool node)
{
	emit_locals_of(e, r->state, vector);
	emit_param_locals(e, r->param);
	if (r->time)
		say(e, "    const double t = $n_time(s)%s;\n", node ? format(" + %s_node[node]", e->name) : "");
	for (int i = 0; i < e->system->inputs; i++) {
		bool ramp = node && e->system->input[i].hold;
		const char *more = ramp ? format(" + %s_node[node] * slope[%d]", e->name, i) : "";
		if (r->input[i])
			say(e, "    const double %s = %s%s;\n", input_name(e, i, 0), sample_now(e, i), more);
		if (r->input[e->system->inputs + i])
			say(e, "    const double %s = slope[%d];\n", input_name(e, i, 1), i);
	}
	struct emitter here = *e;
	here.at_node = node;
	emit_load_states(&here, r->load, true);
}

static const char *name_of_force_column(const struct emitter *e, int force_column)
{
	return e->model->names.coord[coordinate_of_row(e->model, e->model->remainder.row[force_column])];
}

static void emit_lefts(const struct emitter *e, const struct schedule *schedule)
{
	struct formulas *f =
		formulas_new(e, (struct reading){ 0 }, e->model->remainder.force_columns, schedule->common);
	struct tape *t = formulas_tape(f);
	for (int c = 0; c < e->model->remainder.force_columns; c++) {
		tape_ref form = is_read(e, c) ? formula(f, schedule->common[c]) : tape_number(t, 0);
		tape_set(t, format("remainder[%d]", c), with_excess(f, c, form, schedule), 15,
			 name_of_force_column(e, c));
	}
	emit_formulas(f, 4);
}

/* ---- a schedule: which of its operators serves now ---- */

static void emit_selection(const struct emitter *e)
{
	const struct form *selector = e->model->schedule.selector;
	const struct operator *operator = e->model->schedule.operator;
	struct reads r = reads_of(e->model, 1, &selector);
	int last = e->model->schedule.operators - 1;
	open_function(e, "The first operator whose value is not below the current one",
		      "static int $n_operator(const $n *s, const double u[], const double slope[])");
	emit_remainder_locals(e, &r, "s->y", false);
	struct formulas *f = formulas_new(e, (struct reading){ 0 }, 1, &selector);
	tape_set(formulas_tape(f), "const double now", formula(f, selector), 8, NULL);
	emit_formulas(f, 4);
	say(e, "    (void)s;\n"
	       "    (void)u;\n"
	       "    (void)slope;\n"
	       "    return ");
	for (int k = 0; k < last; k++)
		say(e, "now <= %s ? %d : ", shortest(equation_number(e->model, operator[k].at).value), k);
	say(e, "%d;\n"
	       "}\n", last);
}

const char *selection_call(const struct emitter *e)
{
	return spell(e, "$n_operator(s, %s)", samples_of_step(e));
}

void emit_remainder(const struct emitter *e)
{
	struct reads r = reads_of_remainder(e);
	struct schedule schedule = schedule_of(e->step);
	bool node = needs_node(e, &r);
	if (node)
		emit_nodes(e, &r);
	if (schedule.count)
		emit_excess(e, &schedule);
	open_function(e, "Nonlinear remainder at state y: a force on each equation that has one",
		      "static void $n_remainder(const $n *s, int which, int node, const double u[],\n"
		      "    const double slope[], const double y[$N_STATES], double remainder[%d])",
		      e->model->remainder.force_columns);
	emit_remainder_locals(e, &r, "y", node);
	if (schedule.count)
		say(e, "    const double *const excess = $n_excess[which];\n");
	emit_lefts(e, &schedule);
	close_function(e, "s which node u slope y");
	if (many_operators(e) && !e->step->normal)
		emit_selection(e);
}
