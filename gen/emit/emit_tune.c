/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear models with tunable params: an instance holds its own factors, of a large model those of independent blocks
 * that params touch, and NAME_retune, of retune.h, computes them anew on the target. Here is what both hold. */
#include "emit/emit.h"

#include <string.h>

static const struct tuned_blocks *blocks_of_step(const struct emitter *e)
{
	return e->step->blocks;
}

/* Columns of a step's factors: states, load states in each segment of time, inputs */
static int step_columns(const struct emitter *e)
{
	return e->model->tuning->x.size;
}

/* Names of the columns as a comment says them: the load states once, lines broken */
static const char *column_list(const struct emitter *e)
{
	enum { WIDTH = 110 };
	const char **name = layout_names(&e->model->tuning->x, e->system, e->model), *list = "", *line = "";
	int states = e->system->states, loads = e->model->tuning->x.loads, segments = e->system->segments;
	for (int i = 0; i < step_columns(e); i++) {
		if (i >= states + loads && i < states + segments * loads)
			continue;
		bool several = segments > 1 && loads, last = several && i == states + loads - 1;
		const char *end = last ? format(") in each of %d segments of time", segments) : "";
		const char *text = format("%s%s%s", several && i == states ? "(" : "", name[i], end);
		bool wide = strlen(line) + strlen(text) > WIDTH;
		list = format("%s%s%s%s", list, i ? "," : "", wide ? "\n *     " : i ? " " : "", text);
		line = wide ? text : format("%s, %s", line, text);
	}
	return list;
}

/* ---- the header ---- */

static int count_touched(const struct emitter *e)
{
	int touched = 0;
	for (int b = 0; b < blocks_of_step(e)->blocks; b++)
		touched += blocks_of_step(e)->block[b].group->tuned;
	return touched;
}

void banner_tuning(const struct emitter *e)
{
	const struct tuned_blocks *p = blocks_of_step(e);
	const int touched = count_touched(e);
	say(e, " * Tunable: %s.", param_list(e));
	if (p->solved)
		say(e, " $n_retune computes the factors of a step from other values and another h on the target;"
		       " of the spec's\n"
		       " * values they are these, correctly rounded. It needs some %d KB of stack.\n", p->kilobytes);
	else
		say(e, "\n"
		       " * They touch %s independent blocks; $n_retune computes the factors of these from other values"
		       "%s,\n"
		       " * of a block whose params are the spec's these, correctly rounded. It needs some %d KB of "
		       "stack.\n",
		    touched == p->blocks ? format("all %d", touched) : format("%d of %d", touched, p->blocks),
		    p->whole ? " and another h" : "", p->kilobytes);
}

static const char *first_state(const struct emitter *e, const struct group *g)
{
	return format("%s%s", e->model->state_name[g->state[0]], g->states * g->blocks > 1 ? ", ..." : "");
}

const char *tuned_table(const struct emitter *e, const struct tuned_block *first)
{
	const char *name = shape_of_group(e, first->group).name;
	return blocks_of_step(e)->solved ? "step" : format("%s%d", name, first->index);
}

void each_tuned_group(const struct emitter *e, void (*print)(const struct emitter *e, const struct tuned_block *first))
{
	const struct tuned_blocks *p = blocks_of_step(e);
	for (int b = 0; b < p->blocks; b += p->block[b].group->blocks)
		if (p->block[b].group->tuned)
			print(e, &p->block[b]);
}

static void emit_members(const struct emitter *e);

void emit_coefficient_struct(const struct emitter *e)
{
	say(e, "enum { $N_PARAMS = %d };  /* tunable: %s */\n"
	       "typedef struct $n_coeffs $n_coeffs;"
	       "  /* what a step multiplies with, at one set of params and one h */\n"
	       "/* z = %s%s */\n"
	       "struct $n_coeffs {\n", e->model->tuning->params, param_list(e), column_list(e),
	    e->ramps ? "; of a ramp its value before the step, then after it" : "");
	declare_members(e, emit_members);
	say(e, "};\n\n");
}

void emit_tuning_declarations(const struct emitter *e)
{
	const bool one = !blocks_of_step(e)->whole;
	say(e, "\n/* Computes c anew from params (%s) and h [s]%s. 0, or c is as it was and\n"
	       " *     PL_NO_STEP     h is not %s\n"
	       " *     PL_SINGULAR    the mass matrix has no inverse, or a divisor is 0\n", param_list(e),
	    one ? ", the spec's" : "", one ? spell(e, "$N_H") : "above 0");
	if (e->model->tuning->frequencies)
		say(e, " *     PL_NO_RATE     a frequency of a load is below 0\n");
	say(e, " *     PL_NOT_FINITE  a number of it is infinite, or not a number\n"
	       " * c may be that of an instance as long as h stays. */\n"
	       "int    $n_retune($n_coeffs *c, const double params[$N_PARAMS], double h);\n"
	       "\n"
	       "/* From now on with c. State and time stay%s. */\n"
	       "void   $n_use($n *s, const $n_coeffs *c);\n"
	       "\n"
	       "/* Of the spec's values, correctly rounded: what $n_init starts with */\n"
	       "extern const $n_coeffs $n_nominal;\n"
	       "\n", e->phases ? "; phases of loads go on from where they are" : "");
}

/* ---- all of them: declared, or the generator's own ---- */

static void emit_outputs(const struct emitter *e)
{
	const struct tuning *t = e->model->tuning;
	const char **name = ARRAY(const char *, (size_t)t->outputs);
	for (int o = 0; o < e->model->outputs; o++)
		if (t->output[o] >= 0)
			name[t->output[o] - e->model->n] = e->model->output[o].name;
	open_member(e, "double", "out", format("[%d][%d]", t->outputs, t->x.size),
		    format("out z, where outputs depend on params%s",
			   e->ramps ? "; of a ramp its value and its slope" : ""));
	emit_number_rows(e, t->outputs, t->x.size, nominal_outputs(e->step), name);
	close_member(e);
}

/* What of each load moves on in a step: its phase, or its growth */
static void emit_loads(const struct emitter *e, const char *type, const char *name, int count, const int *index,
		       const char *(*step_text)(const struct emitter *, int))
{
	if (count == 0)
		return;
	open_member(e, type, name, format("[%d]", count), "of the loads, in one step");
	for (int l = 0; l < e->system->loads; l++)
		if (index[l] >= 0)
			say(e, "    %s,  /* %s */\n", step_text(e, l), column_text(&e->system->load[l], 0));
	close_member(e);
}

static void emit_group(const struct emitter *e, const struct tuned_block *first)
{
	const struct group_shape shape = shape_of_group(e, first->group);
	const char *whole = e->step->form == FORM_DELTA ? "y += step z" : "y = step z";
	if (shape.rows) {
		open_member(e, "double", tuned_table(e, first), format("[%d][%d]", shape.rows, shape.columns),
			    blocks_of_step(e)->solved ? whole : format("%s: %s", first_state(e, first->group),
								       group_note(e, first->group)));
		emit_group_numbers(e, first->group, false);
		close_member(e);
	}
	if (shape.changing) {
		open_member(e, "double", format("loads%d", first->index),
			    format("[%d][%d][%d]", e->system->segments, shape.changing, shape.columns),
			    "in each segment of time");
		emit_group_numbers(e, first->group, true);
		close_member(e);
	}
}

static void emit_members(const struct emitter *e)
{
	number_member(e, "h", spell(e, "$N_H"), "[s]");
	if (e->system->segments > 1)
		number_member(e, "h_low", low_text(e->model->h), "of the spec's step: what h leaves out; else 0");
	emit_nominal_params(e);
	each_tuned_group(e, emit_group);
	if (e->model->tuning->outputs)
		emit_outputs(e);
	emit_nominal_peaks(e);
	emit_loads(e, "pl_turn", "phase_step", e->phases, e->phase, phase_step_text);
	if (e->phases && e->model->tuning->frequencies) {
		open_member(e, "pl_rate", "phase_rate", format("[%d]", e->phases), "in turns per second");
		emit_phase_rates(e);
		close_member(e);
	}
	emit_loads(e, "pl_growth", "growth_step", e->growths, e->growth, growth_step_text);
}

void emit_nominal(const struct emitter *e)
{
	emit_nominal_of(e, emit_members);
}
