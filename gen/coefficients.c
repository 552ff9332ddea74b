/* SPDX-License-Identifier: GPL-3.0-or-later */
/* The numbers of a step. Each is decided exactly to be rational, or enclosed ever more tightly until both ends of the
 * enclosure round to the same double (Ziv); so each is rounded once, correctly. */
#include "plgen.h"

#include <math.h>

enum { FIRST_PRECISION = 128 };

/* log2 |p| of the largest pole is at least the largest log2 |c_i/c_d| / (d-i), less log2 d (Cauchy's bound, reversed).
 * An angle |p| h of more bits than an enclosure may have could never be reduced to a turn. */
void check_pole_size(const struct model *model, const struct resolvent *resolvent)
{
	struct poly B = *resolvent_determinant(resolvent);
	long lead = (long)mpz_sizeinbase(B.c[B.length - 1], 2), largest = 0;
	for (int i = 0; i < B.length - 1; i++) {
		long bits = (long)mpz_sizeinbase(B.c[i], 2) - lead - B.length;
		if (mpz_sgn(B.c[i]) != 0 && bits / (B.length - 1 - i) > largest)
			largest = bits / (B.length - 1 - i);
	}
	long step = (long)mpz_sizeinbase(mpq_numref(model->h), 2) - (long)mpz_sizeinbase(mpq_denref(model->h), 2);
	if (largest + step > LIMIT_PRECISION)
		error(model->step_at, NULL, "the largest pole, about 2^%ld 1/s, times the step is beyond the limit of 2^%d", largest, LIMIT_PRECISION);
}

/* The pole that grows fastest: what an overflow comes from. */
static const char *dominant_pole(const struct response *response)
{
	const struct spectrum *spectrum = response->spectrum;
	double re = spectrum->zero ? 0 : -INFINITY, im = 0;
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++) {
			double real = mpfi_get_d(spectrum->pole[f][i].at.re);
			if (real > re) {
				re = real;
				im = mpfi_get_d(spectrum->pole[f][i].at.im);
			}
		}
	return im == 0 ? format("%.6g 1/s", re) : format("%.6g +- %.6g i 1/s", re, im);
}

static _Noreturn void undecided(struct place at, const char *what, bool isolated)
{
	const char *note = isolated ? NULL : "two poles cannot be told apart; do two parameters differ by less than their rounding?";
	error(at, note, "%s is not decided with %d bits", what, LIMIT_PRECISION);
}

/* value - subtract, rounded */
static double rounded_difference(struct response *response, mpq_srcptr tau, double subtract, struct place at, const char *what)
{
	mpfi_t enclosure;
	mpfi_init2(enclosure, FIRST_PRECISION);
	double value = 0;
	bool decided = false, isolated = true;
	for (int precision = FIRST_PRECISION; precision <= LIMIT_PRECISION && !decided; precision *= 2) {
		isolated = response_enclose(response, tau, precision, enclosure);
		if (!isolated)
			break;
		mpfi_sub_d(enclosure, enclosure, subtract);
		decided = round_enclosure(enclosure, &value);
	}
	mpfi_clear(enclosure);
	if (!decided)
		undecided(at, what, isolated);
	return value;
}

struct coefficient response_value(struct response *response, mpq_srcptr tau, bool two_words, struct place at, const char *what)
{
	struct coefficient c = { 0 };
	mpq_t exact, low;
	mpq_inits(exact, low, NULL);
	if (response_exact(response, tau, exact)) {
		c.zero = mpq_sgn(exact) == 0;
		c.value = round_rational(exact);
		if (two_words && isfinite(c.value)) {
			mpq_set_d(low, c.value);
			mpq_sub(low, exact, low);
			c.low = round_rational(low);
		}
	} else {
		c.value = rounded_difference(response, tau, 0, at, what);
		if (two_words && isfinite(c.value))
			c.low = rounded_difference(response, tau, c.value, at, what);
	}
	mpq_clears(exact, low, NULL);
	return c;
}

struct coefficient coefficient_of_rational(mpq_srcptr q)
{
	return (struct coefficient){ .value = round_rational(q), .zero = mpq_sgn(q) == 0 };
}

static void check_range(const struct model *model, const struct coefficient *c, const struct response *response, const char *what)
{
	if (!isfinite(c->value))
		error(model->step_at, "a smaller step would do", "%s is beyond the range of double: pole %s, h = %s s", what,
		      dominant_pole(response), readable_text(model->h));
}

struct table *table_of(const struct model *model, struct resolvent *resolvent, const struct linear *system, bool two_words)
{
	int n = 2 * system->n, columns = load_columns(system);
	struct table *table = NEW(struct table);
	*table = (struct table){ n, columns, ARRAY(struct coefficient, (size_t)(n * n)), ARRAY(struct coefficient, (size_t)(n * columns)) };
	for (int i = 0; i < n; i++) {
		for (int j = 0; j < n; j++) {
			const char *what = format("the factor of %s in the step of %s", model->state_name[j], model->state_name[i]);
			struct response *response = image_of_state(resolvent, i, j);
			table->Phi[i * n + j] = response_value(response, model->h, two_words, model->step_at, what);
			check_range(model, &table->Phi[i * n + j], response, what);
		}
		for (int l = 0, column = 0; l < system->loads; l++)
			for (int k = 0; k < system->load[l].columns; k++, column++) {
				const char *what = format("the factor of a load in the step of %s", model->state_name[i]);
				struct response *response = image_of_load(resolvent, i, l, k);
				table->load[i * columns + column] = response_value(response, model->h, two_words, model->step_at, what);
				check_range(model, &table->load[i * columns + column], response, what);
			}
	}
	return table;
}

void rotation_of(const struct model *model, const struct wave *wave, struct coefficient *cosine, struct coefficient *sine)
{
	cosine[0] = response_value(image_of_wave(wave, false), model->h, true, model->step_at, "cos(w h)");
	sine[0] = response_value(image_of_wave(wave, true), model->h, true, model->step_at, "sin(w h)");
}
