/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What acts during a step: the states of loads at a time, what a force gives at once. */
#include "inner.h"

mpq_t *impulse_of_force_column(const struct linear *system, int force_column)
{
	RATIONALS *inverse = inverse_of_leading(system);
	return slopes_by_force(system, inverse, system->force_column[force_column]);
}

/* z = t^j e^{a t} cos or sin(w t + p); the functions are irrational unless their argument is 0, then rationals of 256
 * bits. */
void load_state(const struct load *load, int column, mpq_srcptr t, mpq_ptr z)
{
	struct place nowhere = { 0 };
	const struct forcing *forcing = load->forcing;
	bool turns = oscillates(forcing);
	RATIONAL factor = ZERO;
	mpq_mul(factor, forcing->a, t);
	constant_function(nowhere, FN_EXP, factor, z);
	for (int k = 0; k < (turns ? column / 2 : column); k++)
		mpq_mul(z, z, t);
	if (turns) {
		mpq_mul(factor, forcing->w, t);
		mpq_add(factor, factor, forcing->p);
		constant_function(nowhere, column % 2 ? FN_SIN : FN_COS, factor, factor);
		mpq_mul(z, z, factor);
	}
}

void load_enclosed(const struct load *load, int column, mpq_srcptr t, mpfi_ptr z)
{
	const struct forcing *forcing = load->forcing;
	bool turns = oscillates(forcing);
	RATIONAL argument = ZERO;
	INTERVAL factor = OVER_BITS(mpfi_get_prec(z));
	mpq_mul(argument, forcing->a, t);
	mpfi_set_q(factor, argument);
	mpfi_exp(z, factor);
	for (int k = 0; k < (turns ? column / 2 : column); k++)
		mpfi_mul_q(z, z, t);
	if (turns) {
		mpq_mul(argument, forcing->w, t);
		mpq_add(argument, argument, forcing->p);
		mpfi_set_q(factor, argument);
		if (mpq_sgn(argument) == 0)
			mpfi_set_ui(factor, column % 2 == 0);
		else
			(column % 2 ? mpfi_sin : mpfi_cos)(factor, factor);
		mpfi_mul(z, z, factor);
	}
}

struct output state_as_output(const struct linear *system, int state)
{
	struct output output = { .state = rationals(system->states) };
	output.load = ARRAY(mpq_t *, system->loads);
	for (int l = 0; l < system->loads; l++)
		output.load[l] = rationals((size_t)system->load[l].columns * (size_t)system->segments);
	for (int k = 0; k < 2; k++)
		output.input[k] = rationals(system->inputs);
	mpq_set_ui(output.state[state], 1, 1);
	return output;
}
