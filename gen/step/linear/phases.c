/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads on the target: phases as turns, growths as exponents of 2, in fixed point, so that they add up without error
 * however long a run is. Quotients by pi and ln 2 are irrational: each is enclosed ever more tightly until both ends
 * round to the same bits (Ziv). */
#include "step/step.h"

enum { GUARD_BITS = 64, GROWTH_INTEGER_BITS = 16 };  /* of a growth, its sign among them */
enum phase_unit { TURN, OCTAVE };         /* 2 pi, ln 2: what an angle is divided by, and the logarithm of a growth */

/* q / unit, enclosed with x's precision */
static void divide_by_unit(mpq_srcptr q, enum phase_unit unit, mpfi_ptr x)
{
	INTERVAL divisor = OVER_BITS(mpfi_get_prec(x));
	if (unit == TURN)
		mpfi_const_pi(divisor);
	else
		mpfi_const_log2(divisor);
	if (unit == TURN)
		mpfi_mul_2ui(divisor, divisor, 1);
	mpfi_set_q(x, q);
	mpfi_div(x, x, divisor);
}

static _Noreturn void undecided(const struct step *step, mpq_srcptr q, enum phase_unit unit, long precision)
{
	error(step->model->request.at.step, NULL, "%s / %s is not decided with %ld bits", readable_text(q),
	      unit == TURN ? "(2*pi)" : "ln 2", precision);
}

/* The integer nearest to 2^fraction q / unit */
static void nearest_multiple(const struct step *step, mpq_srcptr q, enum phase_unit unit, int fraction, mpz_ptr nearest)
{
	long above = rational_bits(q) + 1, precision = fraction + (above > 0 ? above : 0) + GUARD_BITS;
	long limit = 2 * precision + LIMIT_PRECISION;
	bool decided = false;
	INTERVAL x = OVER_BITS(precision);
	for (; !decided && precision <= limit; precision *= 2) {
		mpfi_set_prec(x, precision);
		divide_by_unit(q, unit, x);
		mpfi_mul_2ui(x, x, (unsigned long)fraction);
		decided = round_integer(x, nearest);
	}
	if (!decided)
		undecided(step, q, unit, limit);
}

/* An exponent beyond any number of the target is saturated, not wrapped. */
static void saturate(mpz_ptr n, int bits)
{
	INTEGER most = INTEGER_ZERO;
	mpz_ui_pow_ui(most, 2, (unsigned long)bits - 1);
	mpz_sub_ui(most, most, 1);
	if (mpz_cmpabs(n, most) > 0)
		mpz_mul_si(n, most, mpz_sgn(n));
}

/* q / unit as so many bits with `fraction` of them behind the point, wrapped */
static struct fixed_point fixed_from(const struct step *step, mpq_srcptr q, enum phase_unit unit, int bits,
				     int fraction)
{
	struct fixed_point x;
	INTEGER full = INTEGER_ZERO, part = INTEGER_ZERO;
	nearest_multiple(step, q, unit, fraction, full);
	if (unit == OCTAVE)
		saturate(full, bits);
	mpz_fdiv_r_2exp(full, full, (mp_bitcnt_t)bits);
	mpz_fdiv_r_2exp(part, full, 64);
	x.low = mpz_getlimbn(part, 0);
	mpz_fdiv_q_2exp(part, full, 64);
	x.high = mpz_getlimbn(part, 0);
	return x;
}

int phase_bits(const struct step *step)
{
	return step->model->request.single ? 64 : 128;
}

int growth_bits(const struct step *step)
{
	return phase_bits(step) - GROWTH_INTEGER_BITS;
}

static struct fixed_point turn_of(const struct step *step, mpq_srcptr angle)
{
	return fixed_from(step, angle, TURN, phase_bits(step), phase_bits(step));
}

static struct advance advance_over(const struct step *step, const struct forcing *forcing, mpq_srcptr seconds)
{
	struct advance advance = { 0 };
	RATIONAL product = ZERO;
	if (oscillates(forcing)) {
		mpq_mul(product, forcing->w, seconds);
		advance.turn = turn_of(step, product);
	}
	if (mpq_sgn(forcing->a) != 0) {
		mpq_mul(product, forcing->a, seconds);
		advance.growth = fixed_from(step, product, OCTAVE, phase_bits(step), growth_bits(step));
	}
	return advance;
}

static struct rate rate_of(const struct step *step, mpq_srcptr q, enum phase_unit unit)
{
	struct rate rate = { .words = phase_bits(step) == 64 ? 2 : 3 };
	int bits = 64 * rate.words;
	long precision = bits + GUARD_BITS, limit = 2 * precision + LIMIT_PRECISION;
	bool decided = false;
	INTEGER word = INTEGER_ZERO, digits = INTEGER_ZERO;
	INTERVAL x = OVER_BITS(precision);
	for (; !decided && precision <= limit; precision *= 2) {
		mpfi_set_prec(x, precision);
		divide_by_unit(q, unit, x);
		mpfi_abs(x, x);
		decided = round_bits(x, bits, digits, &rate.exponent);
	}
	if (!decided)
		undecided(step, q, unit, limit);
	for (int k = 0; k < rate.words; k++) {
		mpz_fdiv_q_2exp(word, digits, (mp_bitcnt_t)(rate.words - 1 - k) * 64);
		mpz_fdiv_r_2exp(word, word, 64);
		rate.word[k] = mpz_getlimbn(word, 0);
	}
	return rate;
}

static struct load_phase phase_of(const struct step *step, const struct forcing *forcing)
{
	struct load_phase phase = { .step = advance_over(step, forcing, step->model->h) };
	if (oscillates(forcing)) {
		phase.start = turn_of(step, forcing->p);
		phase.turns = rate_of(step, forcing->w, TURN);
	}
	if (mpq_sgn(forcing->a) != 0)
		phase.growth = rate_of(step, forcing->a, OCTAVE);
	RATIONAL seconds = ZERO;
	phase.node = ARRAY(struct advance, step->program->nodes);
	for (int i = 0; i < step->program->nodes; i++) {
		mpq_mul(seconds, step->program->node[i], step->model->h);
		phase.node[i] = advance_over(step, forcing, seconds);
	}
	return phase;
}

void plan_phases(struct step *step)
{
	const struct linear *system = &step->branch->system;
	step->linear.phase = ARRAY(struct load_phase, system->loads);
	for (int l = 0; l < system->loads; l++)
		step->linear.phase[l] = phase_of(step, system->load[l].forcing);
}
