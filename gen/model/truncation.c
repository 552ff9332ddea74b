/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The order of a series, from what a step may add. */
#include "model/model.h"

#include <math.h>

/* 8, 12, 16, 18 for 3, 6, 9, 12 digits: best within a third on smooth models, so much so that nobody needs to choose */
static int order_for(mpq_srcptr tolerance)
{
	double digits = -log10(mpq_get_d(tolerance));
	int order = (int)ceil(digits <= 9.001 ? 4 + 4 * (digits - 0.001) / 3 : 16 + 2 * (digits - 9.001) / 3);
	return order < LEAST_ORDER ? LEAST_ORDER : order;
}

void choose_order(struct model *model, bool single)
{
	struct truncation *truncation = &model->truncation;
	if (!scheme_row(model->scheme)->expands || truncation->order)
		return;
	truncation->adaptive = true;
	if (mpq_sgn(truncation->tolerance) == 0)
		mpq_set_ui(truncation->tolerance, 1, single ? 100000 : 1000000000);
	truncation->order = order_for(truncation->tolerance);
}
