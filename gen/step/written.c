/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The equations as written, for NAME_rhs: residuals without the highest derivatives, and how those follow from them. */
#include "tapes.h"

const struct form *without_highest(const struct model *model, const struct form *form)
{
	struct form *rest = NEW(struct form);
	for (int i = 0; i < form->terms; i++)
		if (!is_highest(&model->written->frame, &form->term[i].basis))
			form_add_basis(rest, form->term[i].basis, form->term[i].factor);
	return rest;
}

struct coefficient *derivatives_of_residuals(const struct model *model)
{
	const struct linear *written = &model->written->system;
	int n = written->n;
	RATIONALS *inverse = inverse_of_leading(written);
	struct coefficient *factor = ARRAY(struct coefficient, (size_t)(n * n));
	for (int i = 0; i < n * n; i++) {
		mpq_neg(inverse[i], inverse[i]);
		factor[i] = equation_number(model, inverse[i]);
	}
	return factor;
}
