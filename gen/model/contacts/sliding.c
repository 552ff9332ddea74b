/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Sliders without mass in regions: where they slide, their equations there, the places that follow. */
#include "inner.h"
#include "model/building.h"

bool is_repeated_slider(const struct switching *s, int index)
{
	bool repeated = false;
	for (int i = 0; i < index; i++)
		repeated = repeated || s->slider[i].atom->node == s->slider[index].atom->node;
	return repeated;
}

struct form *slide_velocity(const struct switching *s, const struct region *region, const struct node *node)
{
	for (int i = 0; i < s->sliders; i++)
		if (s->slider[i].atom->node == node && region->slide[s->slider[i].atom->index].way != 0)
			return region->carried[s->slider[i].atom->index];
	return NULL;
}

static bool same_slide(const struct slide *a, const struct slide *b)
{
	bool same = true;
	for (int i = 0; i < 2; i++)
		same = same && a->function[i] == b->function[i] && a->upward[i] == b->upward[i] &&
		       mpq_equal(a->at[i], b->at[i]);
	return same;
}

int slides_of(const struct switching *s, int index, const struct slide ***slide)
{
	const struct atom *atom = s->slider[index].atom;
	int count = 0;
	*slide = NULL;
	for (int r = 0; r < s->regions; r++) {
		const struct slide *here = s->region[r].slide ? &s->region[r].slide[atom->index] : NULL;
		bool known = !here || !s->region[r].possible || !s->region[r].rest[atom->index];
		for (int k = 0; k < count && !known; k++)
			known = same_slide((*slide)[k], here);
		if (known)
			continue;
		*MORE(*slide, count) = here;
	}
	return count;
}

const char *slider_text(const struct switching *s, int index)
{
	const struct node *node = s->slider[index].atom->node;
	const struct slide **slide;
	int slides = slides_of(s, index, &slide);
	const char *text = format("%s; slides", text_between(node->start, node->end));
	for (int k = 0; k < slides; k++) {
		const char *where[2];
		for (int i = 0; i < 2; i++)
			where[i] = format("switching function %d is %s %s", slide[k]->function[i],
					  slide[k]->upward[i] ? "above" : "below", readable_text(slide[k]->at[i]));
		text = format("%s%s where %s, or %s", text, k ? "; in other regions" : "", where[0], where[1]);
	}
	return text;
}

bool is_released(const struct region *region, int function, bool upward)
{
	bool any = false;
	for (int k = 0; k < region->releases; k++)
		any = any || (region->release[k].function == function && region->release[k].upward == upward);
	return any;
}

/* q - F or q + F, which is 0 while it slides */
static struct form *place_of(const struct region *region, const struct slider *slider)
{
	int at = slider->atom->index;
	return form_sum(region->rest[at], region->force[at], region->slide[at].way > 0);
}

static int row_of_slider(const struct building *b, const struct switching *s, int segment, const struct slider *slider)
{
	struct basis basis = { .kind = BASIS_ATOM, .index = slider->atom->index, .atom = slider->atom };
	for (int k = 0; k < s->rows; k++)
		if (form_find(b->segment_equations[segment].residual[s->row[k]].form, &basis))
			return s->row[k];
	return -1;
}

void slide_sliders(struct building *b, const struct switching *s, int index)
{
	struct region *region = &s->region[index];
	for (int i = 0; i < s->sliders; i++) {
		const struct slider *slider = &s->slider[i];
		const struct slide *slide = &region->slide[slider->atom->index];
		int way = slide->way, side = way < 0;
		int row = row_of_slider(b, s, segment_of_region(s, index), slider);
		if (way == 0 || row < 0)
			continue;
		struct form *velocity = region->residual[row];
		region->carried[slider->atom->index] = velocity;
		add_release(region, slide->function[side], !slide->upward[side],
			    way > 0 ? form_difference(NEW(struct form), velocity) : velocity);
		region->residual[row] = rate_of_form(b, place_of(region, slider));
	}
}

void hold_sliders(struct holding *h, const struct switching *s)
{
	for (int i = 0; i < s->sliders; i++) {
		const struct slider *slider = &s->slider[i];
		if (h->region->slide[slider->atom->index].way == 0)
			continue;
		const struct form *place = free_of_holds(h, place_of(h->region, slider));
		int at = velocity_term(h->b, place, true);
		if (at < 0)
			error(slider->atom->node->at, "a spring between it and what moves, k*(x - z)",
			      "the force through this slider does not depend on its place");
		hold_state(h, place, at);
	}
}
