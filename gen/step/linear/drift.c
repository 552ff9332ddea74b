/* SPDX-License-Identifier: GPL-3.0-or-later */
/* What the rounding of its constants alone does to a linear step over many steps: the eigenvalues z of the map that the
 * program makes with the constants as they are emitted, beside e^{p h} of the poles p. The map is made by running the
 * program on unit states in rationals, so that it is that of any form; its eigenvalues are enclosed like poles. */
#include "forms.h"
#include "inner.h"

enum { DRIFT_BITS = 256 };

static void add_product(mpq_ptr sum, const struct product *p, bool second_word, const mpq_t *state)
{
	RATIONAL factor = ZERO, value = ZERO;
	mpq_set_d(factor, p->factor->value);
	if (second_word) {
		mpq_set_d(value, p->factor->low);
		mpq_add(factor, factor, value);
	}
	mpq_set(value, state[p->operand.index]);
	mpq_mul(value, value, factor);
	mpq_add(sum, sum, value);
}

/* One step from `state`, loads and inputs left out */
static void run_program(const struct step *step, mpq_t *state)
{
	const struct program *program = step->program;
	int n = step->branch->system.states;
	mpq_t *old = rationals(n);
	RATIONAL sum = ZERO;
	for (int i = 0; i < n; i++)
		mpq_set(old[i], state[i]);
	for (int i = 0; i < program->assignments; i++) {
		const struct assignment *a = &program->assignment[i];
		const mpq_t *from = (program->in_order ? state : old);
		mpq_set_ui(sum, 0, 1);
		for (int k = 0; k < a->terms; k++)
			if (a->term[k].operand.kind == OPERAND_STATE)
				add_product(sum, &a->term[k], program->compensated, from);
		if (a->added)
			mpq_add(sum, sum, from[a->target]);
		mpq_set(state[a->target], sum);
	}
}

/* det(z D - D E), D the common denominator of the entries of E: powers of 2, since they are sums of products of
 * floating-point numbers */
static struct poly characteristic(const struct step *step)
{
	int n = step->branch->system.states;
	struct polymat P = { n, ARRAY(struct poly, (size_t)(n * n)) };
	mpq_t *E = rationals((size_t)(n * n)), *column = rationals(n);
	INTEGER common = INTEGER_ZERO;
	mpz_set_ui(common, 1);
	INTEGER content = INTEGER_ZERO;
	for (int j = 0; j < n; j++) {
		for (int i = 0; i < n; i++)
			mpq_set_ui(column[i], i == j, 1);
		run_program(step, column);
		for (int i = 0; i < n; i++) {
			mpq_set(E[i * n + j], column[i]);
			mpz_lcm(common, common, mpq_denref(column[i]));
		}
	}
	for (int i = 0; i < n * n; i++) {
		struct poly *p = &P.cell[i];
		*p = poly_new(2);
		mpz_divexact(p->c[0], common, mpq_denref(E[i]));
		mpz_mul(p->c[0], p->c[0], mpq_numref(E[i]));
		mpz_neg(p->c[0], p->c[0]);
		if (i % n == i / n)
			mpz_set(p->c[1], common);
		poly_trim(p);
	}
	struct poly det;
	polymat_adjugate(P, &det, NULL);
	det = poly_primitive(det, content);
	return det;
}

struct ringing { mpfr_t size, angle; };    /* ln|z|, arg z; of a pole: Re p h, |Im p| h, turns taken out */

static struct ringing mode_new(void)
{
	struct ringing m;
	mpfr_inits2(DRIFT_BITS, m.size, m.angle, NULL);
	return m;
}

static struct ringing mode_of_eigenvalue(const struct rectangle *z)
{
	struct ringing m = mode_new();
	REAL re = WITH_BITS(DRIFT_BITS), im = WITH_BITS(DRIFT_BITS);
	mpfi_mid(re, z->re);
	mpfi_mid(im, z->im);
	mpfr_atan2(m.angle, im, re, MPFR_RNDN);
	mpfr_abs(m.angle, m.angle, MPFR_RNDN);
	mpfr_hypot(m.size, re, im, MPFR_RNDN);
	mpfr_log(m.size, m.size, MPFR_RNDN);
	return m;
}

static struct ringing mode_of_pole(const struct rectangle *p, mpq_srcptr h)
{
	struct ringing m = mode_new();
	REAL turn = WITH_BITS(DRIFT_BITS);
	mpfi_mid(m.size, p->re);
	mpfi_mid(m.angle, p->im);
	mpfr_mul_q(m.size, m.size, h, MPFR_RNDN);
	mpfr_mul_q(m.angle, m.angle, h, MPFR_RNDN);
	mpfr_const_pi(turn, MPFR_RNDN);
	mpfr_mul_2ui(turn, turn, 1, MPFR_RNDN);
	mpfr_remainder(m.angle, m.angle, turn, MPFR_RNDN);
	mpfr_abs(m.angle, m.angle, MPFR_RNDN);
	return m;
}

static int poles_in(const struct spectrum *spectrum)
{
	int count = spectrum->zero > 0;
	for (int f = 0; f < spectrum->factors; f++)
		count += spectrum->poles[f];
	return count;
}

static int ringing_of(const struct spectrum *spectrum, mpq_srcptr h, struct ringing **list)
{
	int count = 0;
	*list = ARRAY(struct ringing, poles_in(spectrum));
	if (spectrum->zero && h) {                      /* the pole 0; an eigenvalue 0 has no logarithm */
		struct ringing m = mode_new();
		mpfr_set_zero(m.size, 1);
		mpfr_set_zero(m.angle, 1);
		(*list)[count++] = m;
	}
	for (int f = 0; f < spectrum->factors; f++)
		for (int i = 0; i < spectrum->poles[f]; i++)
			(*list)[count++] = h ? mode_of_pole(&spectrum->pole[f][i].at, h)
					     : mode_of_eigenvalue(&spectrum->pole[f][i].at);
	return count;
}

static void compare(const struct ringing *z, int poles, const struct ringing *pole, struct drift *drift)
{
	double nearest = -1, size = 0, angle = 0;
	REAL difference = WITH_BITS(DRIFT_BITS);
	for (int i = 0; i < poles; i++) {
		mpfr_sub(difference, z->size, pole[i].size, MPFR_RNDN);
		double d_size = mpfr_get_d(difference, MPFR_RNDN);
		mpfr_sub(difference, z->angle, pole[i].angle, MPFR_RNDN);
		double d_angle = mpfr_get_d(difference, MPFR_RNDN), distance = d_size * d_size + d_angle * d_angle;
		if (nearest >= 0 && distance >= nearest)
			continue;
		nearest = distance;
		size = d_size;
		angle = d_angle < 0 ? -d_angle : d_angle;
	}
	size = size > 1e-60 || size < -1e-60 ? size : 0;        /* what an enclosure of 256 bits leaves */
	if ((size < 0 ? -size : size) > (drift->amplitude < 0 ? -drift->amplitude : drift->amplitude))
		drift->amplitude = size;
	drift->phase = angle > drift->phase && angle > 1e-60 ? angle : drift->phase;
}

struct drift drift_of(const struct step *step)
{
	struct drift drift = { 0, 0, false };
	struct ringing *eigenvalue, *pole;
	if (step->modal)
		return step->modal->drift;
	if (step->program->loops || has_remainder(step) || step->model->switching ||
	    scheme_row(step->model->scheme)->holds_coupling)
		return drift;
	struct spectrum *map = spectrum_of(characteristic(step));
	INTEGER content = INTEGER_ZERO;
	struct spectrum *exact = spectrum_of(poly_primitive(*resolvent_determinant(step->branch->resolvent), content));
	if (!spectrum_refine(map, DRIFT_BITS) || !spectrum_refine(exact, DRIFT_BITS))
		return drift;
	int eigenvalues = ringing_of(map, NULL, &eigenvalue), poles = ringing_of(exact, step->model->h, &pole);
	for (int i = 0; i < eigenvalues; i++)
		compare(&eigenvalue[i], poles, pole, &drift);
	drift.known = map->zero == 0;                   /* an eigenvalue 0: a mode that has died within one step */
	return drift;
}

const char *drift_text(const struct drift *drift, mpq_srcptr h)
{
	const double steps = 3600 / nearest_double(h);
	double amplitude = steps * drift->amplitude, size = amplitude < 0 ? -amplitude : amplitude;
	const char *change = amplitude == 0 ? "no amplitude"
			     : size < 0.1   ? format("amplitudes by at most %.2g of themselves", size)
					    : format("an amplitude by a factor of e^%.3g", amplitude);
	return format("In one hour (%.3g steps) the rounding of its constants changes %s, phases by at most %.2g rad",
		      steps, change, steps * drift->phase);
}
