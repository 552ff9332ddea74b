/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Loads in time: the forms of t^k e^{at} cos(wt+p) and sin, and their products. */
#include "collect/collect.h"

#include <math.h>

enum { BUCKETS = 1024 };

struct forcings {
	int count, varying;         /* varying: but the one of 1, t, t^2, ..., which every model has */
	struct forcing *forcing[BUCKETS]; /* by hash */
};

static size_t forcing_hash(mpq_srcptr a, mpq_srcptr w, mpq_srcptr p)
{
	mpq_srcptr part[] = { a, w, p };
	size_t hash = 0;
	for (int i = 0; i < 3; i++) {
		hash = (hash ^ mpz_get_ui(mpq_numref(part[i]))) * 0x9e3779b97f4a7c15u;
		hash = (hash ^ mpz_get_ui(mpq_denref(part[i]))) * 0x9e3779b97f4a7c15u + (mpq_sgn(part[i]) < 0);
	}
	return (hash >> 20) % BUCKETS;
}

struct forcing *forcing_of(struct collector *c, mpq_srcptr a, mpq_srcptr w, mpq_srcptr p)
{
	if (!c->forcings)
		c->forcings = NEW(struct forcings);
	struct forcing **link = &c->forcings->forcing[forcing_hash(a, w, p)];
	for (; *link; link = &(*link)->next)
		if (mpq_equal((*link)->a, a) && mpq_equal((*link)->w, w) && mpq_equal((*link)->p, p))
			return *link;
	const bool varies = mpq_sgn(a) != 0 || mpq_sgn(w) != 0;
	if (varies && c->forcings->varying == LIMIT_FORCINGS)
		error(c->term->start, NULL, "more loads of different frequency, phase or growth than the limit of %d",
		      LIMIT_FORCINGS);
	mpq_srcptr part[] = { a, w, p };
	for (int i = 0; i < 3; i++)
		if (!isfinite(nearest_double(part[i])))
			error(c->term->start, NULL, "the %s of a load is beyond the range of double",
			      (const char *[]){ "growth", "frequency", "phase" }[i]);
	struct forcing *forcing = *link = NEW(struct forcing);
	mpq_inits(forcing->a, forcing->w, forcing->p, NULL);
	mpq_set(forcing->a, a);
	mpq_set(forcing->w, w);
	mpq_set(forcing->p, p);
	c->forcings->varying += varies;
	forcing->index = c->forcings->count++;
	forcing->kept = NEW(struct kept_response *);
	return forcing;
}

/* The number of quarter turns in `phase` = turns * pi, if it is nothing else. */
static bool quarter_turns(const struct form *phase, int *quarters)
{
	*quarters = 0;
	if (phase->terms == 0)
		return true;
	mpq_srcptr pi = factor_of(phase, BASIS_PI);
	if (phase->terms != 1 || !pi || mpz_cmp_ui(mpq_denref(pi), 2) > 0)
		return false;
	unsigned long halves = mpz_fdiv_ui(mpq_numref(pi), 4);
	*quarters = (int)(mpz_cmp_ui(mpq_denref(pi), 1) == 0 ? 2 * halves % 4 : halves);
	return true;
}

/* t^k, e^{a t} */
struct form *plain_forcing(struct collector *c, int power, mpq_srcptr a)
{
	RATIONAL zero = ZERO;
	return form_unit(
   (struct basis){ .kind = BASIS_FORCING, .forcing = forcing_of(c, a ? a : zero, zero, zero), .power = power });
}

/* factor t^power e^{a t} cos or sin of (w t + p), with w > 0 or a number in its place */
static struct form *any_forcing(struct collector *c, mpq_srcptr factor, int power, mpq_srcptr a, mpq_srcptr frequency,
			     mpq_srcptr phase, bool sine)
{
	RATIONAL w = ZERO, p = ZERO, scale = ZERO;
	mpq_set(scale, factor);
	mpq_set(w, frequency);
	mpq_set(p, phase);
	if (mpq_sgn(w) < 0 || (mpq_sgn(w) == 0 && mpq_sgn(p) < 0)) {
		mpq_neg(w, w);
		mpq_neg(p, p);
		if (sine)
			mpq_neg(scale, scale);
	}
	if (mpq_sgn(w) == 0) {                  /* a beat of two equal frequencies */
		struct place nowhere = { 0 };
		enum function function = sine ? FN_SIN : FN_COS;
		if (!constant_function(nowhere, function, p, p))
			met_irrational(c, &c->irrationals.used[function]);
		mpq_mul(scale, scale, p);
		mpq_set_ui(p, 0, 1);
		sine = false;
		if (power == 0 && mpq_sgn(a) == 0)
			return form_constant(scale);
	}
	return form_single((struct basis){ .kind = BASIS_FORCING,
					   .forcing = forcing_of(c, a, w, p),
					   .power = power,
					   .sine = sine },
			   scale);
}

/* cos or sin of w t + phase; whole quarter turns leave no phase behind. */
struct form *collect_forcing(struct collector *c, bool sine, mpq_srcptr frequency, const struct form *phase)
{
	RATIONAL zero = ZERO, p = ZERO, sign = RATIO(1, 1);
	int quarters;
	/* cos(x + q pi/2): cos, -sin, -cos, sin; sin(x + ...) is one quarter behind */
	if (quarter_turns(phase, &quarters)) {
		int turn = (quarters + (sine ? 3 : 0)) % 4;
		sine = turn % 2 == 1;
		mpq_set_si(sign, turn == 1 || turn == 2 ? -1 : 1, 1);
	} else {
		constant_value(c, phase, p);
	}
	return any_forcing(c, sign, 0, zero, frequency, p, sine);
}

/* factor times the product of two forcing terms: cos x cos y = (cos(x-y) + cos(x+y))/2, sin x cos y = (sin(x-y) +
 * sin(x+y))/2, sin x sin y = (cos(x-y) - cos(x+y))/2 */
static struct form *forcing_product(struct collector *c, const struct basis *x, const struct basis *y,
				    mpq_srcptr factor)
{
	if (!x->sine && y->sine)
		return forcing_product(c, y, x, factor);
	if (x->power + y->power > LIMIT_LOAD_POWER)
		error(c->term->start, NULL, "power of a load beyond the limit of %d", LIMIT_LOAD_POWER);
	RATIONAL a = ZERO, w = ZERO, p = ZERO, half = RATIO(1, 2);
	mpq_add(a, x->forcing->a, y->forcing->a);
	mpq_mul(half, half, factor);
	mpq_sub(w, x->forcing->w, y->forcing->w);
	mpq_sub(p, x->forcing->p, y->forcing->p);
	bool sine = x->sine && !y->sine;
	struct form *difference = any_forcing(c, half, x->power + y->power, a, w, p, sine);
	mpq_add(w, x->forcing->w, y->forcing->w);
	mpq_add(p, x->forcing->p, y->forcing->p);
	if (x->sine && y->sine)
		mpq_neg(half, half);
	struct form *sum = any_forcing(c, half, x->power + y->power, a, w, p, sine);
	form_add_to(sum, difference, NULL);
	form_free(difference);
	return sum;
}

/* Products of loads, term by term. */
struct form *load_product(struct collector *c, const struct form *a, const struct form *b)
{
	struct form *sum = NEW(struct form);
	RATIONAL factor = ZERO;
	for (int i = 0; i < a->terms; i++)
		for (int j = 0; j < b->terms; j++) {
			const struct form_term *x = &a->term[i], *y = &b->term[j];
			if (x->basis.kind == BASIS_FORCING && y->basis.kind == BASIS_FORCING) {
				mpq_mul(factor, x->factor, y->factor);
				struct form *product = forcing_product(c, &x->basis, &y->basis, factor);
				form_add_to(sum, product, NULL);
				form_free(product);
			} else {
				struct form *p = form_product(c, form_single(x->basis, x->factor),
							      form_single(y->basis, y->factor));
				form_add_to(sum, p, NULL);
			}
		}
	return sum;
}

/* The parts of factor * t + phase; false if the form is anything else. */
bool linear_in_time(const struct form *x, mpq_srcptr *factor, struct form *phase)
{
	*phase = (struct form){ 0, x->term, 0 };
	while (phase->terms < x->terms && x->term[phase->terms].basis.kind <= BASIS_PI)
		phase->terms++;
	if (phase->terms + 1 != x->terms)
		return false;
	const struct form_term *last = &x->term[phase->terms];
	*factor = last->factor;
	return last->basis.kind == BASIS_FORCING && is_polynomial(last->basis.forcing) && last->basis.power == 1;
}

bool is_polynomial(const struct forcing *forcing)
{
	return mpq_sgn(forcing->a) == 0 && mpq_sgn(forcing->w) == 0;
}

bool is_linear_in_time(const struct form *form)
{
	for (int i = 0; i < form->terms; i++) {
		const struct basis *basis = &form->term[i].basis;
		bool time = basis->kind == BASIS_FORCING && is_polynomial(basis->forcing) && basis->power <= 1;
		if (!time && basis->kind > BASIS_PI)
			return false;
	}
	return true;
}

bool oscillates(const struct forcing *forcing)
{
	return mpq_sgn(forcing->w) != 0;
}
