/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Forms as numbers at a point, in MPFR at any precision: what only looks at a model needs no exact value. Where a
 * form is not defined its number is NaN. */
#include "collect/collect.h"

enum { KEPT_WAVES = 64 };

struct kept_wave {
	const struct wave *wave;    /* NULL: none yet */
	int power;
	bool sine;
	unsigned time;              /* at which its value was found */
	mpfr_t value;
};

struct sample {
	void (*leaf)(void *context, const struct basis *basis, mpfr_ptr value);
	void *context;
	mpfr_t t;
	mpfr_prec_t precision;
	long work;                  /* terms so far */
	int atoms;
	mpfr_t *value;              /* per atom */
	unsigned *age, now;         /* at which point its value was found; the point */
	unsigned time;              /* counts the times that differ */
	struct kept_wave wave[KEPT_WAVES];
};

struct sample *sample_new(int precision, void (*leaf)(void *context, const struct basis *basis, mpfr_ptr value),
			  void *context)
{
	struct sample *s = NEW(struct sample);
	*s = (struct sample){ .leaf = leaf, .context = context, .precision = precision };
	mpfr_init2(s->t, precision);
	return s;
}

long sample_work(const struct sample *s)
{
	return s->work;
}

void sample_at(struct sample *s, mpfr_srcptr t)
{
	if (!mpfr_equal_p(s->t, t))
		s->time++;
	mpfr_set(s->t, t, MPFR_RNDN);
	s->now++;
}

/* t^k e^{a t} times cos or sin(w t + p) */
static void wave_value(struct sample *s, const struct basis *basis, mpfr_ptr value)
{
	const struct wave *wave = basis->wave;
	mpfr_t part;
	mpfr_init2(part, s->precision);
	mpfr_pow_ui(value, s->t, (unsigned long)basis->power, MPFR_RNDN);
	mpfr_mul_q(part, s->t, wave->a, MPFR_RNDN);
	mpfr_exp(part, part, MPFR_RNDN);
	mpfr_mul(value, value, part, MPFR_RNDN);
	if (oscillates(wave)) {
		mpfr_mul_q(part, s->t, wave->w, MPFR_RNDN);
		mpfr_add_q(part, part, wave->p, MPFR_RNDN);
		(basis->sine ? mpfr_sin : mpfr_cos)(part, part, MPFR_RNDN);
		mpfr_mul(value, value, part, MPFR_RNDN);
	}
	mpfr_clear(part);
}

/* Most forms of a model read the same few waves. */
static void kept_wave_value(struct sample *s, const struct basis *basis, mpfr_ptr value)
{
	uintptr_t hash = (uintptr_t)basis->wave / 16 + 2 * (uintptr_t)basis->power + basis->sine;
	struct kept_wave *kept = &s->wave[hash % KEPT_WAVES];
	bool same = kept->wave == basis->wave && kept->power == basis->power && kept->sine == basis->sine;
	if (!same || kept->time != s->time) {
		if (!kept->wave)
			mpfr_init2(kept->value, s->precision);
		wave_value(s, basis, kept->value);
		kept->wave = basis->wave;
		kept->power = basis->power;
		kept->sine = basis->sine;
		kept->time = s->time;
	}
	mpfr_set(value, kept->value, MPFR_RNDN);
}

static void product_value(struct sample *s, const struct atom *a, mpfr_ptr value)
{
	mpfr_t factor;
	mpfr_init2(factor, s->precision);
	mpfr_set_ui(value, 1, MPFR_RNDN);
	for (int i = 0; i < a->operands; i++) {
		sample_form(s, a->operand[i], factor);
		mpfr_pow_ui(factor, factor, a->exponent[i], MPFR_RNDN);
		mpfr_mul(value, value, factor, MPFR_RNDN);
	}
	mpfr_clear(factor);
}

/* y0 + slope (x - x0) on the piece that holds x */
static void table_value(int points, mpfr_t *x, mpfr_ptr value)
{
	int left = 1;
	for (int k = 3; k + 2 < points; k += 2)
		left = mpfr_cmp(x[0], x[k]) > 0 ? k : left;
	mpfr_sub(value, x[left + 3], x[left + 1], MPFR_RNDN);
	mpfr_sub(x[left + 2], x[left + 2], x[left], MPFR_RNDN);
	mpfr_div(value, value, x[left + 2], MPFR_RNDN);
	mpfr_sub(x[0], x[0], x[left], MPFR_RNDN);
	mpfr_mul(value, value, x[0], MPFR_RNDN);
	mpfr_add(value, value, x[left + 1], MPFR_RNDN);
}

static void call_value(const struct atom *a, mpfr_t *x, mpfr_ptr value)
{
	switch (a->function) {
	case FN_ABS:   mpfr_abs(value, x[0], MPFR_RNDN); break;
	case FN_SGN:   mpfr_set_si(value, mpfr_sgn(x[0]), MPFR_RNDN); break;
	case FN_ATAN2: mpfr_atan2(value, x[0], x[1], MPFR_RNDN); break;
	case FN_TABLE: table_value(a->operands, x, value); break;
	case FN_MIN:
	case FN_MAX:
		mpfr_set(value, x[0], MPFR_RNDN);
		for (int i = 1; i < a->operands; i++)
			(a->function == FN_MIN ? mpfr_min : mpfr_max)(value, value, x[i], MPFR_RNDN);
		break;
	case FN_CLIP:
	case FN_DEADZONE:
		mpfr_max(value, x[0], x[1], MPFR_RNDN);
		mpfr_min(value, value, x[2], MPFR_RNDN);
		if (a->function == FN_DEADZONE)
			mpfr_sub(value, x[0], value, MPFR_RNDN);
		break;
	default:
		mpfr_set(value, x[0], MPFR_RNDN);
		wide_value(a->function, value);
	}
}

/* Only the branch that is taken has to be defined. */
static void choice_value(struct sample *s, const struct atom *a, mpfr_ptr value)
{
	sample_form(s, a->operand[0], value);
	if (!mpfr_nan_p(value))
		sample_form(s, a->operand[mpfr_zero_p(value) ? 2 : 1], value);
}

static void operands_value(struct sample *s, const struct atom *a, mpfr_ptr value)
{
	mpfr_t *x = ARRAY(mpfr_t, (size_t)a->operands);
	bool defined = true;
	for (int i = 0; i < a->operands; i++) {
		mpfr_init2(x[i], s->precision);
		sample_form(s, a->operand[i], x[i]);
		defined = defined && !mpfr_nan_p(x[i]);
	}
	if (!defined)
		mpfr_set_nan(value);
	else if (a->kind == ATOM_COMPARE)
		mpfr_set_ui(value, compare_values(a->comparison, mpfr_cmp(x[0], x[1])), MPFR_RNDN);
	else if (a->kind == ATOM_POWER)
		mpfr_pow(value, x[0], x[1], MPFR_RNDN);
	else if (a->kind == ATOM_RECIPROCAL)
		mpfr_ui_div(value, 1, x[0], MPFR_RNDN);
	else
		call_value(a, x, value);
	for (int i = 0; i < a->operands; i++)
		mpfr_clear(x[i]);
}

static void nominal_value(struct sample *s, const struct atom *a, mpfr_ptr value)
{
	mpq_t nominal;
	(void)s;
	mpq_init(nominal);
	param_value(a->param, nominal);
	mpfr_set_q(value, nominal, MPFR_RNDN);
	mpq_clear(nominal);
}

static mpfr_srcptr atom_value(struct sample *s, const struct atom *a)
{
	if (a->index >= s->atoms) {
		int room = 2 * a->index + 16;
		ENLARGE(s->value, (size_t)room);
		ENLARGE(s->age, (size_t)room);
		for (; s->atoms < room; s->atoms++) {
			mpfr_init2(s->value[s->atoms], s->precision);
			s->age[s->atoms] = 0;
		}
	}
	if (s->age[a->index] == s->now)
		return s->value[a->index];
	mpfr_t value;
	mpfr_init2(value, s->precision);
	(a->kind == ATOM_PRODUCT  ? product_value
	 : a->kind == ATOM_CHOOSE ? choice_value
	 : a->kind == ATOM_PARAM  ? nominal_value
				  : operands_value)(s, a, value);
	mpfr_set(s->value[a->index], value, MPFR_RNDN);         /* the table may have moved on the way */
	mpfr_clear(value);
	s->age[a->index] = s->now;
	return s->value[a->index];
}

void sample_form(struct sample *s, const struct form *form, mpfr_ptr total)
{
	mpfr_t sum, term;
	mpfr_inits2(s->precision, sum, term, NULL);
	mpfr_set_zero(sum, 1);
	s->work += form->terms;
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		if (basis->kind == BASIS_ONE)
			mpfr_set_ui(term, 1, MPFR_RNDN);
		else if (basis->kind == BASIS_PI)
			mpfr_const_pi(term, MPFR_RNDN);
		else if (basis->kind == BASIS_WAVE)
			kept_wave_value(s, basis, term);
		else if (basis->kind == BASIS_ATOM)
			mpfr_set(term, atom_value(s, basis->atom), MPFR_RNDN);
		else
			s->leaf(s->context, basis, term);
		mpfr_mul_q(term, term, form->term[i].factor, MPFR_RNDN);
		mpfr_add(sum, sum, term, MPFR_RNDN);
	}
	mpfr_set(total, sum, MPFR_RNDN);
	mpfr_clears(sum, term, NULL);
}
