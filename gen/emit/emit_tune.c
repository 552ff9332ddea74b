/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Linear models with tunable params: an instance holds its own factors, of a large model those of independent blocks
 * that params touch, and NAME_retune, of retune.h, computes them anew on the target. Here is what both hold. */
#include "emit/emit.h"

static const struct tuned_blocks *blocks_of_step(const struct emitter *e)
{
	return e->step->blocks;
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

void emit_tuned_members(const struct emitter *e)
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
