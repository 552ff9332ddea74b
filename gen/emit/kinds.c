/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the C of each kind of step has: a row for each of what it has of its own, functions and words. */
#include "declarations.h"
#include "kinds.h"
#include "emit/regions/regions.h"
#include "emit/series/series.h"
#include "steps.h"
#include "emit/tunable/tunable.h"
#include "model/regions/regions.h"
#include "step/regions/guards.h"

/* ---- linear ---- */

static void emit_pass_of_changes(const struct emitter *e)
{
	if (e->system->segments > 1)
		emit_passing(e);
}

static const struct kind linear = {
	.banner = banner_linear,
	.status_note = "0, or PL_NOT_FINITE: a state is infinite or not a number",
	.pass = emit_pass_of_changes,
	.step = emit_step,
	.at = emit_at
};

/* ---- tuned: a linear step whose factors the instance has, of a large model those of blocks that params touch ---- */

static const struct kind tuned = {
	.banner = banner_linear,
	.status_note = "0, or PL_NOT_FINITE: a state is infinite or not a number",
	.own_factors = true,
	.step = emit_step,
	.at = emit_tuned_at
};

/* ---- regions ---- */

static bool always(const struct emitter *e)
{
	(void)e;
	return true;
}

/* Of independent parts each has as many as a model by itself. */
static void emit_event_limit(const struct emitter *e)
{
	int parts = 0;
	for (int p = 0; p < e->step->parts; p++)
		parts += e->step->part[p]->model->switching->expressions > 0;
	say(e, "enum { $N_MAX_EVENTS = %d };  /* crossings in a step%s */\n",
	    parts ? parts * MAX_EVENTS : max_events(e->model), parts ? format(", %d of each part", MAX_EVENTS) : "");
}

static void emit_region_tables(const struct emitter *e)
{
	emit_regions(e);
	emit_region_start(e);
}

/* What both kinds of regions have */
#define OF_REGIONS \
	.step_note = " * A step that stays clear of every breakpoint, at most:\n", \
	.constants = emit_event_limit, .keeps_status = true, \
	.status_note = "0, or bits: PL_NOT_FINITE, PL_TOO_MANY_EVENTS", .declare_state = emit_crossing_declarations, \
	.places = always

static const struct kind regions = {
	.banner = banner_regions,
	OF_REGIONS,
	.members = emit_region_members,
	.tables = emit_region_tables,
	.step = emit_region_step,
	.at = emit_region_at
};

/* ---- regions of independent parts ---- */

static void emit_tables_of_parts(const struct emitter *e)
{
	emit_part_tables(e);
	emit_part_start(e);
}

static const struct kind parts = {
	.banner = banner_parts,
	OF_REGIONS,
	.members = emit_part_members,
	.tables = emit_tables_of_parts,
	.step = emit_parts_step,
	.at = emit_parts_at
};

/* ---- remainder: a list of actions ---- */

static bool flows_whole(const struct step *step)
{
	const struct program *program = step->program;
	bool whole = false;
	for (int i = 0; i < program->actions; i++)
		whole = whole || program->action[i].flow == 0;
	return whole && program->loops;
}

static const struct kind with_remainder = {
	.banner = banner_remainder,
	.keeps_status = true,
	.status_note = "0, or PL_NOT_FINITE once a step has left the finite numbers",
	.reads_phi = flows_whole,
	.pass = emit_pass_of_changes,
	.step = emit_remainder_step,
	.held = emit_held_remainder,
	.at = emit_at
};

/* ---- cut: the same, from crossing to crossing ---- */

static void emit_expansion_constants(const struct emitter *e)
{
	if (is_divided(e))
		emit_event_limit(e);
}

/* What all have whose state may choose formulas */
#define OF_SERIES \
	.constants = emit_expansion_constants, \
	.types = emit_divided_types, .keeps_status = true, .status_note = "0, or PL_... bits (plrt.h)", \
	.declare_state = emit_divided_declarations

static const struct kind cut = {
	.banner = banner_cut,
	OF_SERIES,
	.members = emit_cut_members,
	.places = always,
	.reads_phi = flows_whole,
	.tables = emit_cut_place,
	.step = emit_cut_step,
	.at = emit_expansion_at
};

/* ---- expanded: the Taylor series of the solution ---- */

static const struct kind expanded = {
	.banner = banner_expanded,
	OF_SERIES,
	.members = emit_expansion_members,
	.places = expansion_places,
	.tables = emit_expansion_place,
	.step = emit_expansion_step,
	.at = emit_expansion_at
};

/* ---- collocated: polynomials that solve the equations at nodes ---- */

static const struct kind collocated = {
	.banner = banner_collocated,
	OF_SERIES,
	.members = emit_collocation_members,
	.places = always,
	.tables = emit_collocation_place,
	.step = emit_collocation_step,
	.at = emit_collocation_at
};

/* ---- normal modes ---- */

static const struct kind normal_modes = {
	.banner = banner_normal,
	.members = emit_normal_members,
	.keeps_status = true,
	.status_note = "0, or PL_NOT_FINITE once a step has left the finite numbers",
	.places = always,
	.tables = emit_normal_tables
};

const struct kind *row_of_kind(enum step_kind kind)
{
	static const struct kind *const row[KINDS] = {
		[KIND_LINEAR] = &linear, [KIND_TUNED] = &tuned,
		[KIND_REGIONS] = &regions,
		[KIND_PARTS] = &parts, [KIND_REMAINDER] = &with_remainder, [KIND_CUT] = &cut,
		[KIND_EXPANDED] = &expanded, [KIND_COLLOCATED] = &collocated,
		[KIND_NORMAL] = &normal_modes
	};
	return row[kind];
}
