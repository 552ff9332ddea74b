/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the C of a step has by its flow and events, functions and words. */
#include "emit/regions/regions.h"
#include "emit/series/series.h"
#include "steps.h"
#include "emit/tunable/tunable.h"
#include "model/contacts/contacts.h"
#include "step/regions/guards.h"
#include "step/regions/regions.h"

/* ---- linear ---- */

static void emit_pass_of_changes(const struct emitter *e)
{
	if (loads_change(e->system) && !e->step->is.tuned)
		emit_passing(e);
}

static void emit_linear_at(const struct emitter *e)
{
	(e->step->is.tuned ? emit_tuned_at : emit_at)(e);
}

static const struct printers linear = {
	.status_note = "0, or PL_NOT_FINITE: a state is infinite or not a number",
	.pass = emit_pass_of_changes,
	.step = emit_step,
	.at = emit_linear_at
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
	for (int p = 0; p < e->step->regions.parts; p++)
		parts += e->step->regions.part[p]->model->switching->functions > 0;
	say(e, "enum { $N_MAX_EVENTS = %d };  /* crossings in a step%s */\n",
	    (parts ? parts : 1) * max_events(e->model), parts ? format(", %d of each part", max_events(e->model)) : "");
}

/* Whether the step stands before the tables: it does not read them by itself */
static bool starts_with_step(const struct emitter *e)
{
	const bool reads = e->step->regions.event_check.is_made && !has_events(e->model->switching) &&
			   is_checked_by_tables(e->step);
	return !reads && !e->model->params.retuned && !has_peaks(e) && !has_ranges(e) && e->system->segments == 1 &&
	       !e->step->carried.count;
}

static void emit_region_tables(const struct emitter *e)
{
	if (starts_with_step(e)) {
		declare_region_search(e);
		emit_region_step(e);
	}
	emit_regions(e);
	emit_region_start(e);
}

static void emit_later_region_step(const struct emitter *e)
{
	if (!starts_with_step(e))
		emit_region_step(e);
}

/* What both kinds of regions have */
#define OF_REGIONS \
	.step_note = ", without events: at most ", \
	.constants = emit_event_limit, \
	.status_note = "0, or bits: PL_NOT_FINITE, PL_TOO_MANY_EVENTS", .declare_state = emit_crossing_declarations, \
	.places = always

static const struct printers regions = {
	OF_REGIONS,
	.events = emit_event_note,
	.members = emit_region_members,
	.tables = emit_region_tables,
	.step = emit_later_region_step,
	.at = emit_region_at
};

/* ---- regions of independent parts ---- */

static void emit_tables_of_parts(const struct emitter *e)
{
	emit_part_tables(e);
	emit_part_start(e);
}

static const struct printers parts = {
	OF_REGIONS,
	.events = emit_event_note_of_parts,
	.members = emit_part_members,
	.tables = emit_tables_of_parts,
	.step = emit_parts_step,
	.at = emit_parts_at
};

/* ---- remainder: a list of actions ---- */

static const struct printers with_remainder = {
	.status_note = "0, or PL_NOT_FINITE once a step has left the finite numbers",
	.pass = emit_pass_of_changes,
	.step = emit_remainder_step,
	.held = emit_held_remainder,
	.at = emit_at
};

/* ---- event-split: the same, from crossing to crossing ---- */

static void emit_expansion_constants(const struct emitter *e)
{
	if (has_switching(e))
		emit_event_limit(e);
}

/* What all have whose state may choose formulas */
#define OF_SERIES \
	.constants = emit_expansion_constants, \
	.types = emit_switching_types, .status_note = "0, or PL_... bits (plrt.h)", \
	.declare_state = emit_switching_declarations

static const struct printers event_split = {
	OF_SERIES,
	.members = emit_event_split_members,
	.places = always,
	.tables = emit_event_split_place,
	.step = emit_event_split_step,
	.at = emit_expansion_at
};

/* ---- expanded: the Taylor series of the solution ---- */

static const struct printers expanded = {
	OF_SERIES,
	.members = emit_expansion_members,
	.places = expansion_places,
	.tables = emit_expansion_place,
	.step = emit_expansion_step,
	.at = emit_expansion_at
};

/* ---- collocated: polynomials that solve the equations at nodes ---- */

static const struct printers collocated = {
	OF_SERIES,
	.members = emit_collocation_members,
	.places = always,
	.tables = emit_collocation_place,
	.step = emit_collocation_step,
	.at = emit_collocation_at
};

/* ---- normal modes ---- */

static const struct printers normal_modes = {
	.members = emit_normal_members,
	.status_note = "0, or PL_NOT_FINITE once a step has left the finite numbers",
	.places = always,
	.tables = emit_normal_tables
};

const struct printers *printers_of(const struct step *step)
{
	static const struct printers *const of[] = {
		[FLOW_LINEAR] = &linear, [FLOW_RECIPE] = &with_remainder, [FLOW_SERIES] = &expanded,
		[FLOW_COLLOCATION] = &collocated, [FLOW_NORMAL] = &normal_modes
	};
	if (step->is.events == EVENTS_OF_REGIONS)
		return step->is.apart ? &parts : &regions;
	return step->is.events == EVENTS_SPLIT ? &event_split : of[step->is.flow];
}
