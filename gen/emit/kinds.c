/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the C of each kind of step has: a row for each of what it has of its own, functions and words. */
#include "emit/emit.h"

/* ---- linear ---- */

static const char *far_pole(const struct step *step)
{
	return step->series.emitted ? NULL : "the largest |pole| times h is above 8";
}

static void emit_pass_of_changes(const struct emitter *e)
{
	if (e->system->segments > 1)
		emit_passing(e);
}

static const struct kind linear = {
	.banner = banner_linear,
	.no_at = far_pole,
	.status_note = "0, or PL_NOT_FINITE: a state is infinite or not a number",
	.pass = emit_pass_of_changes,
	.step = emit_step,
	.at = emit_at
};

/* ---- tuned: a linear step whose factors the instance has, of a large model those of blocks that params touch ---- */

static const char *far_block(const struct step *step)
{
	return step->series.emitted ? NULL
			: format("an independent block has more than %d states, load states and inputs",
						     LIMIT_TUNED_BLOCK);
}

static bool any_load(const struct emitter *e, int load)
{
	(void)e;
	(void)load;
	return true;
}

static const struct kind tuned = {
	.banner = banner_linear,
	.no_jump = "retuned coefficients have one word",
	.no_at = far_block,
	.status_note = "0, or PL_NOT_FINITE: a state is infinite or not a number",
	.own_factors = true,
	.reads_load = any_load,
	.step = emit_step,
	.at = emit_tuned_at
};

/* ---- regions ---- */

static bool any_place(const struct emitter *e)
{
	(void)e;
	return true;
}

static bool regions_read_load(const struct emitter *e, int load)
{
	return loads_of_regions(e->step)[load];
}

static void emit_event_limit(const struct emitter *e)
{
	say(e, "enum { $N_MAX_EVENTS = %d };  /* crossings in a step */\n", max_events(e->model));
}

static void emit_region_tables(const struct emitter *e)
{
	emit_regions(e);
	emit_region_start(e);
}

static void emit_regions_step(const struct emitter *e)
{
	if (reads_channels(e->model))
		emit_leftover_functions(e);
	emit_region_step(e);
}

static const struct kind regions = {
	.banner = banner_regions,
	.step_note = " * A step that stays clear of every breakpoint, at most:\n",
	.no_jump = "crossings are found step by step",
	.no_at = far_pole,
	.constants = emit_event_limit,
	.members = emit_region_members,
	.keeps_status = true,
	.status_note = "0, or bits: PL_NOT_FINITE, PL_TOO_MANY_EVENTS",
	.declare_state = emit_crossing_declarations,
	.places = any_place,
	.reads_load = regions_read_load,
	.tables = emit_region_tables,
	.step = emit_regions_step,
	.at = emit_region_at
};

/* ---- regions of independent parts ---- */

static bool parts_read_load(const struct emitter *e, int load)
{
	return e->step->layout.load[load] >= 0;
}

static void emit_event_limit_of_parts(const struct emitter *e)
{
	int parts = 0;
	for (int p = 0; p < e->step->parts; p++)
		parts += e->step->part[p]->model->switching->expressions > 0;
	say(e, "enum { $N_MAX_EVENTS = %d };  /* crossings in a step, %d of each part */\n", parts * MAX_EVENTS,
	    MAX_EVENTS);
}

static void emit_tables_of_parts(const struct emitter *e)
{
	emit_part_tables(e);
	emit_part_start(e);
}

static void emit_step_of_parts(const struct emitter *e)
{
	if (reads_channels(e->model))
		emit_leftover_functions(e);
	emit_parts_step(e);
}

static const struct kind parts = {
	.banner = banner_parts,
	.step_note = " * A step that stays clear of every breakpoint, at most:\n",
	.no_jump = "crossings are found step by step",
	.no_at = far_pole,
	.constants = emit_event_limit_of_parts,
	.members = emit_part_members,
	.keeps_status = true,
	.status_note = "0, or bits: PL_NOT_FINITE, PL_TOO_MANY_EVENTS",
	.declare_state = emit_crossing_declarations,
	.places = any_place,
	.reads_load = parts_read_load,
	.tables = emit_tables_of_parts,
	.step = emit_step_of_parts,
	.at = emit_parts_at
};

/* ---- leftover: a list of actions ---- */

static bool flows_whole(const struct step *step)
{
	const struct program *program = step->program;
	bool whole = false;
	for (int i = 0; i < program->actions; i++)
		whole = whole || program->action[i].flow == 0;
	return whole && program->loops;
}

static const char *no_values_between(const struct step *step)
{
	return step->layout.powers ? far_pole(step) : "between its steps the scheme has no values of its order";
}

static void emit_actions_step(const struct emitter *e)
{
	emit_leftover_functions(e);
	emit_leftover_step(e);
}

static const struct kind leftover = {
	.banner = banner_leftover,
	.no_jump = "what is left over is not linear in the state",
	.no_at = no_values_between,
	.keeps_status = true,
	.status_note = "0, or PL_NOT_FINITE once a step has left the finite numbers",
	.reads_phi = flows_whole,
	.pass = emit_pass_of_changes,
	.step = emit_actions_step,
	.held = emit_held_leftover,
	.at = emit_at
};

/* ---- cut: the same, from crossing to crossing ---- */

static bool look_reads_load(const struct emitter *e, int load)
{
	return e->step->cut->look->load[load];
}

static void emit_cut_types(const struct emitter *e)
{
	emit_divided_types(looking(e));
}

static void emit_cut_declarations(const struct emitter *e)
{
	emit_divided_declarations(looking(e));
}

static const struct kind cut = {
	.banner = banner_cut,
	.no_jump = "what is left over is not linear in the state",
	.constants = emit_event_limit,
	.types = emit_cut_types,
	.members = emit_cut_members,
	.keeps_status = true,
	.status_note = "0, or bits: PL_NOT_FINITE, PL_TOO_MANY_EVENTS",
	.declare_state = emit_cut_declarations,
	.places = any_place,
	.reads_load = look_reads_load,
	.reads_phi = flows_whole,
	.tables = emit_cut_place,
	.step = emit_cut_step,
	.at = emit_expansion_at
};

/* ---- expanded: the Taylor series of the solution ---- */

static bool expansion_reads_load(const struct emitter *e, int load)
{
	return e->step->expansion->load[load];
}

static void emit_expansion_constants(const struct emitter *e)
{
	if (is_divided(e))
		emit_event_limit(e);
}

static const struct kind expanded = {
	.banner = banner_expanded,
	.no_jump = "what is left over is not linear in the state",
	.constants = emit_expansion_constants,
	.types = emit_divided_types,
	.members = emit_expansion_members,
	.keeps_status = true,
	.status_note = "0, or PL_... bits (plrt.h)",
	.declare_state = emit_divided_declarations,
	.places = expansion_places,
	.reads_load = expansion_reads_load,
	.tables = emit_expansion_place,
	.step = emit_expansion_step,
	.at = emit_expansion_at
};

/* ---- collocated: polynomials that solve the equations at nodes ---- */

static bool collocation_reads_load(const struct emitter *e, int load)
{
	return motion_reads_load(e, load) || (e->step->expansion && e->step->expansion->load[load]);
}

static const struct kind collocated = {
	.banner = banner_collocated,
	.no_jump = "what is left over is not linear in the state",
	.constants = emit_expansion_constants,
	.types = emit_divided_types,
	.members = emit_collocation_members,
	.keeps_status = true,
	.status_note = "0, or PL_... bits (plrt.h)",
	.declare_state = emit_divided_declarations,
	.places = collocation_places,
	.reads_load = collocation_reads_load,
	.tables = emit_collocation_place,
	.step = emit_collocation_step,
	.at = emit_collocation_at
};

/* ---- normal modes ---- */

static const char *too_many_turns(const struct step *step)
{
	return step->series.emitted ? NULL : format("in a step a mode turns or decays by more than %d", LIMIT_WITHIN);
}

static bool reads_wave(const struct emitter *e, int load)
{
	const struct splitting *split = e->model->split;
	bool found = false;
	for (int k = 0; k < split->waves && !found; k++)
		found = split->wave[k].wave == e->system->load[load].wave;
	return found;
}

static const struct kind normal_modes = {
	.banner = banner_normal,
	.no_jump = "what is left over changes in time",
	.no_at = too_many_turns,
	.members = emit_normal_members,
	.keeps_status = true,
	.status_note = "0, or PL_NOT_FINITE once a step has left the finite numbers",
	.places = any_place,
	.reads_load = reads_wave,
	.tables = emit_normal_tables,
	.step = emit_normal_step
};

const struct kind *row_of_kind(enum step_kind kind)
{
	static const struct kind *const row[KINDS] = {
		[KIND_LINEAR] = &linear, [KIND_TUNED] = &tuned,
		[KIND_REGIONS] = &regions,
		[KIND_PARTS] = &parts, [KIND_LEFTOVER] = &leftover, [KIND_CUT] = &cut, [KIND_EXPANDED] = &expanded,
		[KIND_COLLOCATED] = &collocated,
		[KIND_NORMAL] = &normal_modes
	};
	return row[kind];
}
