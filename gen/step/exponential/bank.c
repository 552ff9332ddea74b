/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A bank: linear terms of the remainder that differ from operator to operator, and what all operators leave alike. */
#include "weights.h"

static mpq_srcptr linear_factor(const struct form *form, int coord, int order)
{
	struct basis basis = { .kind = BASIS_COORD, .index = coord, .order = order };
	const struct form_term *term = form_find(form, &basis);
	return term ? term->factor : NULL;
}

static bool differs(const struct model *model, int channel, int coord, int order)
{
	mpq_srcptr first = linear_factor(model->schedule.operator[0].left[channel], coord, order);
	for (int k = 1; k < model->schedule.operators; k++) {
		mpq_srcptr other = linear_factor(model->schedule.operator[k].left[channel], coord, order);
		if (!first != !other || (first && !mpq_equal(first, other)))
			return true;
	}
	return false;
}

static void find_excess(const struct step *step, struct bank *bank)
{
	const struct linear *system = &step->branch->system;
	const struct model *model = step->model;
	bank->excess = ARRAY(struct excess, (size_t)(system->states * model->remainder.channels) + 1);
	for (int c = 0; c < model->remainder.channels; c++)
		for (int i = 0; i < system->states; i++) {
			struct excess excess = { c, system->coord[i], i >= system->n };
			if (differs(model, c, excess.coord, excess.order))
				bank->excess[bank->count++] = excess;
		}
}

static void fill_factors(const struct step *step, struct bank *bank)
{
	const struct model *model = step->model;
	bank->factor = ARRAY(double, (size_t)(model->schedule.operators * bank->count));
	for (int k = 0; k < model->schedule.operators; k++)
		for (int i = 0; i < bank->count; i++) {
			const struct excess *excess = &bank->excess[i];
			const struct form *left = model->schedule.operator[k].left[excess->channel];
			mpq_srcptr factor = linear_factor(left, excess->coord, excess->order);
			bank->factor[k * bank->count + i] = factor ? equation_number(model, factor).value : 0;
		}
}

/* The form without the terms that differ */
static const struct form *common_part(const struct model *model, int channel)
{
	const struct form *form = model->schedule.operator[0].left[channel];
	struct form *common = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind != BASIS_COORD || !differs(model, channel, basis->index, basis->order))
			form_add_basis(common, *basis, form->term[i].factor);
	}
	return common;
}

struct bank bank_of(const struct step *step)
{
	struct bank bank = { .common = ARRAY(const struct form *, step->model->remainder.channels) };
	find_excess(step, &bank);
	fill_factors(step, &bank);
	for (int c = 0; c < step->model->remainder.channels; c++)
		bank.common[c] = common_part(step->model, c);
	return bank;
}
