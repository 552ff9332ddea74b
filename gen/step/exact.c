/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Exact numbers of the equations that stand in the code as they are: the border where each is rounded, once. */
#include "step/step.h"

struct coefficient equation_number(const struct model *model, mpq_srcptr q)
{
	if (beyond_range(q))
		error(model->asked.step_at, NULL, "a number of the equations is beyond the range of %s", target_name());
	return (struct coefficient){ .value = round_rational(q), .low = rounding_rest(q), .zero = mpq_sgn(q) == 0 };
}

double time_in_step(const struct model *model, mpq_srcptr fraction)
{
	mpq_t tau;
	mpq_init(tau);
	mpq_mul(tau, fraction, model->h);
	double seconds = round_rational(tau);
	mpq_clear(tau);
	return seconds;
}

struct slopes state_slopes(const struct step *step, int operator)
{
	const struct linear *system = &step->branch[operator].system;
	int states = system->states, channels = system->channels;
	struct slopes slopes = { ARRAY(struct coefficient, (size_t)(states * states)),
				 ARRAY(struct coefficient, (size_t)(states * channels)) };
	mpq_t *A = state_matrix(system, false);
	for (int i = 0; i < states * states; i++)
		slopes.A[i] = equation_number(step->model, A[i]);
	rationals_free(A, (size_t)(states * states));
	for (int c = 0; c < channels; c++) {
		mpq_t *force = impulse_of_channel(system, c);
		for (int i = 0; i < states; i++)
			slopes.B[i * channels + c] = equation_number(step->model, force[i]);
		rationals_free(force, (size_t)states);
	}
	return slopes;
}
