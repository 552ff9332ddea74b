/* SPDX-License-Identifier: GPL-3.0-or-later */
/* A schedule: linear terms of the remainder that differ from operator to operator, and what all operators leave alike.
 * */
#include "weights.h"

static mpq_srcptr linear_factor(const struct form *form, int coord, int order)
{
	struct basis basis = { .kind = BASIS_COORD, .index = coord, .order = order };
	const struct form_term *term = form_find(form, &basis);
	return term ? term->factor : NULL;
}

static bool differs(const struct model *model, int force_column, int coord, int order)
{
	mpq_srcptr first = linear_factor(model->schedule.operator[0].left[force_column], coord, order);
	for (int k = 1; k < model->schedule.operators; k++) {
		mpq_srcptr other = linear_factor(model->schedule.operator[k].left[force_column], coord, order);
		if (!first != !other || (first && !mpq_equal(first, other)))
			return true;
	}
	return false;
}

static void find_excess(const struct step *step, struct schedule *schedule)
{
	const struct linear *system = &step->branch->system;
	const struct model *model = step->model;
	schedule->excess = ARRAY(struct excess, (size_t)(system->states * model->remainder.force_columns) + 1);
	for (int c = 0; c < model->remainder.force_columns; c++)
		for (int i = 0; i < system->states; i++) {
			struct excess excess = { c, system->coord[i], i >= system->n };
			if (differs(model, c, excess.coord, excess.order))
				schedule->excess[schedule->count++] = excess;
		}
}

static void fill_factors(const struct step *step, struct schedule *schedule)
{
	const struct model *model = step->model;
	schedule->factor = ARRAY(double, (size_t)(model->schedule.operators * schedule->count));
	for (int k = 0; k < model->schedule.operators; k++)
		for (int i = 0; i < schedule->count; i++) {
			const struct excess *excess = &schedule->excess[i];
			const struct form *left = model->schedule.operator[k].left[excess->force_column];
			mpq_srcptr factor = linear_factor(left, excess->coord, excess->order);
			schedule->factor[k * schedule->count + i] = factor ? equation_number(model, factor).value : 0;
		}
}

/* The form without the terms that differ */
static const struct form *common_part(const struct model *model, int force_column)
{
	const struct form *form = model->schedule.operator[0].left[force_column];
	struct form *common = NEW(struct form);
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind != BASIS_COORD || !differs(model, force_column, basis->index, basis->order))
			form_add_basis(common, *basis, form->term[i].factor);
	}
	return common;
}

struct schedule schedule_of(const struct step *step)
{
	struct schedule schedule = { .common = ARRAY(const struct form *, step->model->remainder.force_columns) };
	find_excess(step, &schedule);
	fill_factors(step, &schedule);
	for (int c = 0; c < step->model->remainder.force_columns; c++)
		schedule.common[c] = common_part(step->model, c);
	return schedule;
}
