/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What an input does between samples: a polynomial of an odd degree d through the d + 1 samples around the step, its
 * samples, at the times (c - (d - 1)/2) h from the step's start, c = 0 .. d. A ramp is that of degree 1. Held is degree
 * 0. */
#include "step/step.h"

/* The factor of (s/h)^power in Lagrange's polynomial of a sample: 1 there, 0 at the others */
void sample_weight(int hold, int power, int sample, mpq_ptr weight)
{
	int before = hold > 0 ? (hold - 1) / 2 : 0;
	RATIONALS *factor = rationals(hold + 2);
	RATIONAL lower = ZERO;
	mpq_set_ui(factor[0], 1, 1);
	for (int c = 0, degree = 0; c <= hold; c++) {
		if (c == sample)
			continue;
		for (int m = ++degree; m >= 0; m--) {   /* times (s/h - node)/(own node - node) */
			mpq_set_si(lower, before - c, 1);
			mpq_mul(factor[m], factor[m], lower);
			if (m > 0)
				mpq_add(factor[m], factor[m], factor[m - 1]);
			mpq_set_si(lower, sample - c, 1);
			mpq_div(factor[m], factor[m], lower);
		}
	}
	mpq_set(weight, factor[power]);
}

/* d^power u / d s^power at the step's start, per sample: power! h^-power times its factor */
void sample_derivative(int hold, int power, int sample, mpq_srcptr h, mpq_ptr derivative)
{
	RATIONAL times = ZERO;
	sample_weight(hold, power, sample, derivative);
	for (int k = 1; k <= power; k++) {
		mpq_set_si(times, k, 1);
		mpq_mul(derivative, derivative, times);
		mpq_div(derivative, derivative, h);
	}
}

/* What |d^power u / d s^power| h^power at the step's start is at most where no sample is above 1 */
double sample_reach(int hold, int power)
{
	RATIONAL one = RATIO(1, 1), derivative = ZERO, sum = ZERO;
	for (int c = 0; c <= hold; c++) {
		sample_derivative(hold, power, c, one, derivative);
		mpq_abs(derivative, derivative);
		mpq_add(sum, sum, derivative);
	}
	return round_rational(sum);
}

/* h u' at the step's end, per sample */
void sample_slope(int hold, int sample, mpq_ptr slope)
{
	RATIONAL weight = ZERO, times = ZERO;
	mpq_set_ui(slope, 0, 1);
	for (int m = 1; m <= hold; m++) {
		sample_weight(hold, m, sample, weight);
		mpq_set_si(times, m, 1);
		mpq_mul(weight, weight, times);
		mpq_add(slope, slope, weight);
	}
}

/* first, third, ... */
static const char *hold_name(int hold)
{
	static const char *const name[] = { [1] = "first", [3] = "third", [5] = "fifth", [7] = "seventh" };
	return name[hold];
}

int samples_ahead(int hold)
{
	return (hold + 1) / 2;
}

void check_holds(const struct step *step)
{
	const char *why = step_objection(step, CAN_FURTHER);
	for (const struct symbol *s = step->model->spec->first; s && why; s = s->next)
		if (s->kind == SYMBOL_INPUT && s->hold > 1)
			error(s->at, "'hold first' would do", "input '%s' cannot be hold %s here: %s", s->name,
			      hold_name(s->hold), why);
}
