/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Breakpoints of regions on which nothing changes: they go, so that regions are no more than they have to be. */
#include "inner.h"
#include "model/contacts/friction.h"

/* Whether all regions below it have the equations of those above it */
static bool changes_nothing(const struct switching *s, int expression, int at)
{
	for (int r = 0; r < s->regions; r++) {
		const struct region *low = &s->region[r], *high = low + s->expression[expression].stride;
		if (interval_of(s, r, expression) == at && low->possible && high->possible &&
		    (low->system != high->system || !same_friction(low, high)))
			return false;
	}
	return true;
}

/* Without breakpoint `at` of one expression: each region above it falls to the one below. The last breakpoint of all
 * stays. */
static void remove_break(struct switching *s, int expression, int at)
{
	struct switching old = *s;
	struct expression *e = &s->expression[expression];
	old.expression = ARRAY(struct expression, s->expressions);
	for (int i = 0; i < s->expressions; i++)
		old.expression[i] = s->expression[i];
	e->at = rationals(e->breaks);
	for (int i = 0, k = 0; i < e->breaks; i++)
		if (i != at)
			mpq_set(e->at[k++], old.expression[expression].at[i]);
	e->breaks--;
	s->regions = count_candidates(s) * s->segments;
	s->region = ARRAY(struct region, s->regions);
	for (int r = 0; r < old.regions; r++) {
		int merged = segment_of_region(&old, r) * regions_at_once(s);
		for (int i = 0; i < s->expressions; i++) {
			int interval = interval_of(&old, r, i);
			merged += (interval - (i == expression && interval > at)) * s->expression[i].stride;
		}
		if (old.region[r].possible)
			s->region[merged] = old.region[r];
	}
}

static bool has_impact(const struct switching *s, int expression, int at)
{
	mpq_srcptr value = s->expression[expression].at[at];
	bool acted = false;
	for (int k = 0; k < s->segments; k++)
		acted = acted || impact_at(s, k, expression, value, true) >= 0 ||
			 impact_at(s, k, expression, value, false) >= 0;
	return acted;
}

int breaks_of_all(const struct switching *s)
{
	int count = 0;
	for (int e = 0; e < s->expressions; e++)
		count += s->expression[e].breaks;
	return count;
}

static void drop_from_slides(struct switching *s, int expression)
{
	for (int r = 0; r < s->regions; r++)
		for (int i = 0; i < 2 * s->sliders && s->region[r].slide; i++) {
			int *of = &s->region[r].slide[s->slider[i / 2].atom->index].expression[i % 2];
			*of -= *of > expression;
		}
}

static void drop_expression(struct switching *s, int expression)
{
	for (int e = expression; e + 1 < s->expressions; e++)
		s->expression[e] = s->expression[e + 1];
	for (int i = 0; i < s->frictions; i++)
		s->friction[i].expression -= s->friction[i].expression > expression;
	drop_from_slides(s, expression);
	for (int i = 0; i < s->impacts; i++)
		for (int k = 0; k < s->segments; k++)
			s->impact[i].in[k].expression -= s->impact[i].in[k].expression > expression;
	for (int r = 0; r < s->regions; r++)
		for (int k = 0; k < s->region[r].releases; k++)
			s->region[r].release[k].expression -= s->region[r].release[k].expression > expression;
	s->expressions--;
	count_candidates(s);
}

void remove_idle_breaks(struct switching *s)
{
	for (int e = s->expressions - 1; e >= 0; e--) {
		for (int at = s->expression[e].breaks - 1; at >= 0; at--)
			if (breaks_of_all(s) > 1 && !is_stick(&s->expression[e], at) &&
			    !is_stick(&s->expression[e], at + 1) && !has_impact(s, e, at) && changes_nothing(s, e, at))
				remove_break(s, e, at);
		if (s->expression[e].breaks == 0)
			drop_expression(s, e);
	}
}
