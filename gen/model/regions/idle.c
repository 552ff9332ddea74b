/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Breakpoints of regions on which nothing changes: they go, so that regions are no more than they have to be. */
#include "inner.h"
#include "model/contacts/friction.h"

/* What sticks is held and released alike. */
static bool same_friction(const struct region *a, const struct region *b)
{
	bool same = a->holds == b->holds && a->releases == b->releases;
	for (int k = 0; k < a->holds && same; k++)
		same = a->hold[k].state == b->hold[k].state && same_form(a->hold[k].form, b->hold[k].form);
	for (int k = 0; k < a->releases && same; k++)
		same = same_form(a->release[k].form, b->release[k].form);
	return same;
}

/* Whether all regions below it have the equations of those above it */
static bool changes_nothing(const struct switching *s, int function, int at)
{
	for (int r = 0; r < s->regions; r++) {
		const struct region *low = &s->region[r], *high = low + s->function[function].stride;
		if (interval_of(s, r, function) == at && low->possible && high->possible &&
		    (low->system != high->system || !same_friction(low, high)))
			return false;
	}
	return true;
}

/* Without breakpoint `at` of one switching function: each region above it falls to the one below. The last breakpoint
 * of all stays. */
static void remove_break(struct switching *s, int function, int at)
{
	struct switching old = *s;
	struct switching_function *e = &s->function[function];
	old.function = ARRAY(struct switching_function, s->functions);
	for (int i = 0; i < s->functions; i++)
		old.function[i] = s->function[i];
	e->at = rationals(e->breaks);
	for (int i = 0, k = 0; i < e->breaks; i++)
		if (i != at)
			mpq_set(e->at[k++], old.function[function].at[i]);
	e->breaks--;
	s->regions = count_candidates(s) * s->segments;
	s->region = ARRAY(struct region, s->regions);
	for (int r = 0; r < old.regions; r++) {
		int merged = segment_of_region(&old, r) * regions_at_once(s);
		for (int i = 0; i < s->functions; i++) {
			int interval = interval_of(&old, r, i);
			merged += (interval - (i == function && interval > at)) * s->function[i].stride;
		}
		if (old.region[r].possible)
			s->region[merged] = old.region[r];
	}
}

static bool has_impact(const struct switching *s, int function, int at)
{
	mpq_srcptr value = s->function[function].at[at];
	bool acted = false;
	for (int k = 0; k < s->segments; k++)
		acted = acted || impact_at(s, k, function, value, true) >= 0 ||
			 impact_at(s, k, function, value, false) >= 0;
	return acted;
}

static void drop_from_slides(struct switching *s, int function)
{
	for (int r = 0; r < s->regions; r++)
		for (int i = 0; i < 2 * s->sliders && s->region[r].slide; i++) {
			int *of = &s->region[r].slide[s->slider[i / 2].atom->index].function[i % 2];
			*of -= *of > function;
		}
}

static void drop_function(struct switching *s, int function)
{
	for (int e = function; e + 1 < s->functions; e++)
		s->function[e] = s->function[e + 1];
	for (int i = 0; i < s->frictions; i++)
		s->friction[i].function -= s->friction[i].function > function;
	drop_from_slides(s, function);
	for (int i = 0; i < s->impacts; i++)
		for (int k = 0; k < s->segments; k++)
			s->impact[i].in[k].function -= s->impact[i].in[k].function > function;
	for (int r = 0; r < s->regions; r++)
		for (int k = 0; k < s->region[r].releases; k++)
			s->region[r].release[k].function -= s->region[r].release[k].function > function;
	s->functions--;
	count_candidates(s);
}

void remove_idle_breaks(struct switching *s)
{
	for (int e = s->functions - 1; e >= 0 && !s->cached; e--) {
		for (int at = s->function[e].breaks - 1; at >= 0; at--)
			if (breaks_of_all(s) > 1 && !is_stick(&s->function[e], at) &&
			    !is_stick(&s->function[e], at + 1) && !has_impact(s, e, at) && changes_nothing(s, e, at))
				remove_break(s, e, at);
		if (s->function[e].breaks == 0)
			drop_function(s, e);
	}
}
