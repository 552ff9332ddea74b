/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The sign of a friction force or an energy, as far as it is seen: it is at 0 or above as long as a sum of powers,
 * exponentials and forcing terms of time is, beside what never is below 0. */
#include "friction.h"

#include <math.h>

/* max(5*y + 1, 0), abs(x), x^2, x^2/cosh(y), t < 1 ? 1 : 2 */
static bool is_never_negative(const struct atom *a)
{
	static const double lowest[] = {
#define REAL_FUNCTION(NAME, name, argument, value, low, high) [FN_##NAME] = low,
#include "read/functions.def"
#undef REAL_FUNCTION
		[FN_ATAN2] = -1
	};
	if (a->kind == ATOM_CHOOSE)
		return never_falls_below(a->operand[1]) && never_falls_below(a->operand[2]);
	bool never = a->kind == ATOM_CALL &&
		     (a->function == FN_ABS || (a->function < FN_ATAN2 && lowest[a->function] >= 0));
	for (int i = 0; i < a->operands && a->kind == ATOM_CALL && a->function == FN_MAX; i++)
		never = never || (is_constant(a->operand[i]) && never_falls_below(a->operand[i]));
	if (a->kind == ATOM_PRODUCT || a->kind == ATOM_RECIPROCAL) {
		never = true;
		for (int i = 0; i < a->operands && never; i++)
			never = (a->exponent && a->exponent[i] % 2 == 0) || never_falls_below(a->operand[i]);
	}
	return never;
}

/* A sum of powers, exponentials and forcing terms of time; what else never is below 0 is left out. False: there is
 * more. */
static bool sum_of_time(const struct form *force, bool minus, struct summand *sum, int *summands, mpq_t *number)
{
	*summands = 0;
	mpq_set_ui(number[0], 0, 1);
	for (int i = 0; i < force->terms; i++) {
		const struct form_term *term = &force->term[i];
		const struct basis *basis = &term->basis;
		if (basis->kind == BASIS_ATOM && mpq_sgn(term->factor) == (minus ? -1 : 1) &&
		    is_never_negative(basis->atom))
			continue;
		if (basis->kind > BASIS_FORCING)
			return false;
		mpq_ptr factor = number[1 + i];
		mpq_set(factor, term->factor);
		if (basis->kind == BASIS_PI) {
			constant_pi(factor);
			mpq_mul(factor, factor, term->factor);
		}
		if (minus)
			mpq_neg(factor, factor);
		bool forcings = basis->kind == BASIS_FORCING;
		sum[(*summands)++] = (struct summand){ factor, forcings ? basis->forcing->a : number[0],
						       forcings ? basis->forcing->w : number[0],
						       forcings ? basis->forcing->p : number[0],
						       forcings ? basis->power : 0,
						       forcings && basis->sine };
	}
	return true;
}

static bool stays_positive(const struct form *force, bool minus, mpq_srcptr from, mpq_srcptr to)
{
	struct summand *sum = ARRAY(struct summand, force->terms + 1);
	mpq_t *number = rationals(force->terms + 1);
	int summands;
	return sum_of_time(force, minus, sum, &summands, number) && sum_stays_positive(summands, sum, from, to);
}

bool stays_above_zero(const struct form *force, mpq_srcptr from, mpq_srcptr to)
{
	return stays_positive(force, false, from, to);
}

bool never_falls_below(const struct form *force)
{
	RATIONAL start = ZERO;
	return stays_above_zero(force, start, NULL);
}

void report_drives(const struct node *friction)
{
	error(friction->at, "on the left side it stands with the sign of a damper: + friction(x', F)",
	      "this friction drives what slides instead of holding it");
}

void report_unheld(struct place at)
{
	error(at, "its force has to act on its own sliding velocity", "friction cannot hold what slides there");
}

void check_force(const struct node *node, const struct form *force, mpq_srcptr from, mpq_srcptr to)
{
	if (force->terms > 0 && stays_positive(force, true, from, to))
		refuse_force_below(node);
}
