/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exact numbers of the equations that stand in the code as they are: the border where each is rounded, once. */
#include "step/linear/images.h"
#include "tapes.h"

struct coefficient equation_number(const struct model *model, mpq_srcptr q)
{
	if (beyond_range(q))
		error(model->request.at.step, NULL, "a number of the equations is beyond the range of %s",
		      target_name());
	return (struct coefficient){ .value = round_rational(q), .low = rounding_rest(q), .zero = mpq_sgn(q) == 0 };
}

double time_in_step(const struct model *model, mpq_srcptr fraction)
{
	RATIONAL tau = ZERO;
	mpq_mul(tau, fraction, model->h);
	return round_rational(tau);
}

struct slopes state_slopes(const struct step *step, int operator)
{
	const struct linear *system = &step->branch[operator].system;
	int states = system->states, force_columns = system->force_columns;
	struct slopes slopes = { ARRAY(struct coefficient, (size_t)(states * states)),
				 ARRAY(struct coefficient, (size_t)(states * force_columns)) };
	RATIONALS *A = state_matrix(system, false);
	for (int i = 0; i < states * states; i++)
		slopes.A[i] = equation_number(step->model, A[i]);
	for (int c = 0; c < force_columns; c++) {
		RATIONALS *force = impulse_of_force_column(system, c);
		for (int i = 0; i < states; i++)
			slopes.B[i * force_columns + c] = equation_number(step->model, force[i]);
	}
	return slopes;
}

/* ---- the equations as written, for NAME_rhs: residuals without the highest derivatives, how those follow ---- */

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
