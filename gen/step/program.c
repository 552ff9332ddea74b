/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The program of a step. */
#include "model/contacts/contacts.h"
#include "model/reads.h"
#include "step/linear/forms.h"

struct descriptor descriptor_of(const struct model *model)
{
	const struct switching *regions = model->switching;
	return (struct descriptor){
		.flow = flow_of(model),
		.events = regions ? EVENTS_OF_REGIONS : follows_crossings(model) ? EVENTS_SPLIT : EVENTS_NONE,
		.tuned = !regions && model->params.tuning, .two_words = model->request.compensated,
		.many = model->request.many.batch, .apart = regions && regions->parts
	};
}

bool is_linear_alone(const struct step *step)
{
	return step->is.flow == FLOW_LINEAR && step->is.events == EVENTS_NONE;
}

bool is_refreshed(const struct step *step, int load)
{
	return step->refresh && step->refresh->load[load];
}

int load_of_column(const struct linear *system, int column, int *first)
{
	int l = 0;
	for (*first = 0; column >= *first + system->load[l].columns; l++)
		*first += system->load[l].columns;
	return l;
}

const char *text_of_column(const struct linear *system, int column)
{
	int first, load = load_of_column(system, column, &first);
	return column_text(&system->load[load], column - first);
}

bool is_forced(const struct step *step, int column)
{
	int first;
	return step->forced && step->forced->load[load_of_column(&step->branch->system, column, &first)];
}

/* What is held there, and what releases it */
static void mark_loads_of_region(const struct region *region, int transmitted_forces, int load, size_t columns,
				 bool *needed)
{
	for (int k = 0; k < region->holds && region->possible; k++)
		*needed = *needed || !rationals_zero(columns, region->hold[k].row->load[load]);
	for (int k = 0; k < region->releases && region->possible; k++)
		*needed = *needed || !rationals_zero(columns, region->release[k].row->load[load]);
	for (int k = 0; k < transmitted_forces && region->friction_force; k++)
		*needed = *needed ||
			(region->friction_force[k] && !rationals_zero(columns, region->friction_force[k]->load[load]));
}

/* Where states jump to, and the speed of what bounces */
static void mark_loads_of_impacts(const struct switching *s, int load, size_t columns, bool *needed)
{
	for (int i = 0; i < s->impacts; i++)
		for (int segment = 0; segment < s->segments; segment++) {
			const struct impact_law *impact_law = &s->impact[i].in[segment];
			for (int k = 0; k < impact_law->jumps; k++)
				*needed = *needed || !rationals_zero(columns, impact_law->jump[k].row->load[load]);
			if (s->impact[i].bounces)
				*needed = *needed || !rationals_zero(columns, impact_law->speed_row->load[load]);
		}
}

static void mark_loads_of(const struct switching *s, int segments, bool *needed)
{
	for (int l = 0; l < s->system->loads; l++) {
		const size_t columns = (size_t)(s->system->load[l].columns * segments);
		for (int k = 0; k < s->systems; k++)
			needed[l] = needed[l] || load_acts(&s->system[k], &s->system[k].load[l]);
		for (int e = 0; e < s->functions; e++)
			needed[l] = needed[l] || !rationals_zero(columns, s->function[e].row->load[l]);
		for (int k = 0; k < s->regions; k++)
			mark_loads_of_region(&s->region[k], s->transmitted_forces, l, columns, &needed[l]);
		mark_loads_of_impacts(s, l, columns, &needed[l]);
	}
}

bool *loads_of_regions(const struct step *step)
{
	const struct switching *s = step->model->switching;
	bool *needed = ARRAY(bool, (size_t)step->branch->system.loads);
	int segments = step->shown->model->system.segments;
	for (int l = 0; l < step->branch->system.loads && step->model->params.retuned; l++)
		needed[l] = true;               /* at other values others act */
	for (int p = 0; p < s->parts; p++)
		mark_loads_of(s->part[p].model->switching, segments, needed);
	if (s->parts == 0)
		mark_loads_of(s, segments, needed);
	return needed;
}
