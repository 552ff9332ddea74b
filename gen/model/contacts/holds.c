/* SPDX-License-Identifier: GPL-3.0-or-later */
/* States of a region that follow from the others, and what lets go of them. */
#include "inner.h"
#include "model/building.h"

/* form without the term of a basis, which `by` gives */
static struct form *replaced(const struct form *form, const struct basis *basis, const struct form *by)
{
	const struct form_term *term = form_find(form, basis);
	struct form *sum = NEW(struct form);
	if (!term)
		return form_alias(form);
	for (int i = 0; i < form->terms; i++)
		if (&form->term[i] != term)
			form_add_basis(sum, form->term[i].basis, form->term[i].factor);
	form_add_to(sum, by, term->factor);
	return sum;
}

const struct form *free_of_holds(const struct holding *h, const struct form *form)
{
	for (int i = 0; i < h->region->holds; i++)
		form = replaced(form, &h->of[i], h->region->hold[i].form);
	return form;
}

void hold_state(struct holding *h, const struct form *v, int at)
{
	struct region *region = h->region;
	struct basis basis = v->term[at].basis;
	RATIONAL factor = ZERO;
	mpq_inv(factor, v->term[at].factor);
	mpq_neg(factor, factor);
	struct form *held = form_scale(replaced(v, &basis, NEW(struct form)), factor);
	for (int i = 0; i < region->holds; i++)
		region->hold[i].form = replaced(region->hold[i].form, &basis, held);
	h->of[region->holds] = basis;
	region->hold[region->holds].state = basis.order ? h->b->model->system.velocity[basis.index] : basis.index;
	region->hold[region->holds++].form = held;
}

int velocity_term(const struct building *b, const struct form *form, bool first_order)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_COORD && !(first_order && basis->order > 0) &&
		    basis->order + 1 == b->model->frame.coord[basis->index]->highest)
			return i;
	}
	return -1;
}

void add_release(struct region *region, int function, bool upward, struct form *form)
{
	*MORE(region->release, region->releases) = (struct release){ function, upward, form, NULL };
}
