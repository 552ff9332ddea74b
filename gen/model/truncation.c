/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of a series and the stages of a collocation, from what a step may add. */
#include "model/model.h"

#include <math.h>

/* 8, 12, 16, 18 for 3, 6, 9, 12 digits: best within a third on smooth models, so much so that nobody needs to choose */
static int order_for(mpq_srcptr tolerance)
{
	double digits = -log10(mpq_get_d(tolerance));
	int order = (int)ceil(digits <= 9.001 ? 4 + 4 * (digits - 0.001) / 3 : 16 + 2 * (digits - 9.001) / 3);
	return order < LEAST_ORDER ? LEAST_ORDER : order;
}

/* 3, 5, 7, 9 for 3, 6, 9, 12 digits; beside them a series of about as many digits a step */
static void choose_stages(struct truncation *truncation, bool switches)
{
	static const int order_beside[MOST_STAGES + 1] = { [3] = 10, [5] = 16, [7] = 20, [9] = 24 };
	double digits = -log10(mpq_get_d(truncation->tolerance));
	if (!truncation->stages)
		truncation->stages = digits < 3.001 ? 3 : digits < 6.001 ? 5 : digits < 9.001 ? 7 : MOST_STAGES;
	truncation->order = switches ? order_beside[truncation->stages] : 2 * truncation->stages - 1;
}

void choose_order(struct model *model, bool single)
{
	struct truncation *truncation = &model->truncation;
	if (!scheme_row(model->scheme)->expands || truncation->order)
		return;
	truncation->adaptive = true;
	if (mpq_sgn(truncation->tolerance) == 0)
		mpq_set_ui(truncation->tolerance, 1, single ? 100000 : 1000000000);
	if (scheme_row(model->scheme)->collocates)
		choose_stages(truncation, scheme_row(model->scheme)->switches);
	else
		truncation->order = order_for(truncation->tolerance);
}

void unit_of_expansion(const struct model *model, mpq_ptr unit)
{
	mpq_set_si(unit, model->truncation.over, 1);
	mpq_mul(unit, unit, model->h);
}
