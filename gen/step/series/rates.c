/* SPDX-License-Identifier: GPL-3.0-or-later */
/* Second derivatives in time of sines as shifted sequences, in the equations that highest derivatives are solved from:
 * cos(u) u'' - sin(u) u'^2 is the derivative of p = cos(u) u', whose sequence the recurrence of sin(u) has already, so
 * that its k-th is (k+1) p_{k+1}, where the others take four products of sequences. And sin(u)^2 + cos(u)^2 is 1. */
#include "inner.h"

enum { FACTORS = 4 };
struct factors { int count, of[FACTORS + 1]; };      /* count FACTORS + 1: more than are looked for */

static const struct sequence *at(const struct sequencing *w, int sequence)
{
	return &w->x->sequence[sequence];
}

static const struct sequence_term *only_term(const struct sequence *s, enum term_kind kind)
{
	return s->terms == 1 && s->term->kind == kind ? s->term : NULL;
}

static void add_factor(const struct sequencing *w, struct factors *f, int sequence)
{
	const struct sequence *s = at(w, sequence);
	const struct sequence_term *product = s->kind == SEQUENCE_SUM ? only_term(s, TERM_PRODUCT) : NULL;
	if (f->count > FACTORS)
		return;
	if (product && product->factor[0] == 1) {
		add_factor(w, f, product->a);
		add_factor(w, f, product->b);
	} else if (f->count++ < FACTORS) {
		f->of[f->count - 1] = sequence;
	}
}

static struct factors factors_of(const struct sequencing *w, const struct key *key)
{
	struct factors f = { 0 };
	if (key->kind == TERM_PRODUCT || key->kind == TERM_SEQUENCE)
		add_factor(w, &f, key->a);
	if (key->kind == TERM_PRODUCT)
		add_factor(w, &f, key->b);
	return f;
}

/* The place of one of them from `from` on; NONE */
static int factor_place(const struct factors *f, int from, int sequence)
{
	for (int i = from; i < f->count && f->count <= FACTORS; i++)
		if (f->of[i] == sequence)
			return i;
	return NONE;
}

static void drop(struct factors *f, int place)
{
	f->of[place] = f->of[--f->count];
}

static bool same_factors(struct factors a, const struct factors *b)
{
	for (int i = 0; i < b->count && a.count <= FACTORS; i++) {
		const int place = factor_place(&a, 0, b->of[i]);
		if (place == NONE)
			return false;
		drop(&a, place);
	}
	return a.count == 0;
}

/* The key with these factors that is not 0; NULL: there is none */
static struct key *key_with(const struct sequencing *w, const struct sum *sum, const struct factors *wanted)
{
	for (int i = 0; i < sum->keys && wanted->count > 0; i++) {
		const struct factors f = factors_of(w, &sum->key[i]);
		if (mpq_sgn(sum->key[i].factor) != 0 && same_factors(f, wanted))
			return &sum->key[i];
	}
	return NULL;
}

/* ---- sines ---- */

static bool is_function(const struct sequence *s, enum function function)
{
	return s->kind == SEQUENCE_INTEGRAL && s->state == NONE && s->function == function;
}

static bool is_sine(const struct sequence *s)
{
	return is_function(s, FN_SIN) || is_function(s, FN_COS);
}

/* Of a sine the cosine, and the other way round: they stand side by side */
static int partner_of(const struct sequencing *w, int sine)
{
	return is_function(at(w, sine), FN_SIN) ? sine + 1 : sine - 1;
}

/* u' of sin(u), where it is a velocity or a sum of velocities; else NONE */
static int rate_of(const struct sequencing *w, int sine)
{
	const struct sequence *s = at(w, partner_of(w, sine));
	const struct sequence_term *product = only_term(s, TERM_PRODUCT);
	if (!product && only_term(s, TERM_SEQUENCE))
		product = only_term(at(w, s->term->a), TERM_PRODUCT);
	const int rate = !product ? NONE : product->a == sine ? product->b : product->a;
	return rate != NONE && (at(w, rate)->state != NONE || at(w, rate)->kind == SEQUENCE_SUM) ? rate : NONE;
}

/* Of a velocity the highest derivative that is solved for; NONE */
static int solved_of(const struct sequencing *w, int velocity)
{
	for (int i = 0; i < w->system->n; i++)
		if (w->system->velocity[i] == velocity)
			return w->highest[i];
	return NONE;
}

/* Whether a sequence is a rate, or with `solved` what that has as derivative */
static bool is_of_rate(const struct sequencing *w, int sequence, int rate, bool solved)
{
	const struct sequence *s = at(w, sequence), *v = at(w, rate);
	if (v->state != NONE)
		return sequence == (solved ? solved_of(w, rate) : rate);
	bool same = s->kind == SEQUENCE_SUM && s->terms == v->terms;
	for (int i = 0; i < v->terms && same; i++) {
		bool found = false;
		for (int k = 0; k < s->terms && v->term[i].kind == TERM_SEQUENCE; k++)
			found = found || (s->term[k].kind == TERM_SEQUENCE &&
					  s->term[k].factor[0] == v->term[i].factor[0] &&
					  is_of_rate(w, s->term[k].a, v->term[i].a, solved));
		same = found;
	}
	return same;
}

/* u' times it, which is what its partner's recurrence adds up */
static int slope_of(struct sequencing *w, int sine)
{
	const int rate = rate_of(w, sine), partner = partner_of(w, sine);
	struct sequence *s = &w->x->sequence[partner];
	if (!only_term(s, TERM_PRODUCT))
		return s->term->a;
	const int made = product_sequence(w, sine, rate);
	s = &w->x->sequence[partner];
	s->term->kind = TERM_SEQUENCE;
	s->term->a = made;
	s->term->b = 0;
	return made;
}

/* The key of a sine times u''; NULL */
static struct key *key_of_solved(const struct sequencing *w, const struct sum *sum, int sine, int rate)
{
	for (int i = 0; i < sum->keys; i++) {
		struct factors f = factors_of(w, &sum->key[i]);
		const int place = f.count == 2 ? factor_place(&f, 0, sine) : NONE;
		if (place != NONE && mpq_sgn(sum->key[i].factor) != 0 && is_of_rate(w, f.of[1 - place], rate, true))
			return &sum->key[i];
	}
	return NULL;
}

/* The sine of a product sin(u) u'^2; NONE: it is none */
static int sine_of_key(const struct sequencing *w, const struct key *key)
{
	const struct factors f = factors_of(w, key);
	for (int i = 0; i < f.count && f.count == 3; i++) {
		const int rate = is_sine(at(w, f.of[i])) ? rate_of(w, f.of[i]) : NONE;
		if (rate != NONE && is_of_rate(w, f.of[(i + 1) % 3], rate, false) &&
		    is_of_rate(w, f.of[(i + 2) % 3], rate, false))
			return f.of[i];
	}
	return NONE;
}

/* c sin(u) u'^2 - c cos(u) u'' to -c (cos(u) u')', and with a sine and a cosine exchanged to c (sin(u) u')' */
static void shift_key(struct sequencing *w, struct sum *sum, int index, struct sum *slopes)
{
	const int sine = sine_of_key(w, &sum->key[index]), partner = sine == NONE ? NONE : partner_of(w, sine);
	struct key *other = sine == NONE ? NULL : key_of_solved(w, sum, partner, rate_of(w, sine));
	RATIONAL factor = ZERO;
	if (!other)
		return;
	mpq_set(factor, sum->key[index].factor);
	mpq_set_ui(sum->key[index].factor, 0, 1);
	if (is_function(at(w, sine), FN_COS))
		mpq_neg(factor, factor);
	mpq_add(other->factor, other->factor, factor);
	mpq_neg(factor, factor);
	sum_add(slopes, TERM_SEQUENCE, slope_of(w, partner), 0, factor);
}

/* ---- squares ---- */

static void add_factors(struct sum *sum, const struct factors *f, mpq_srcptr factor)
{
	const int a = f->count == 2 && f->of[0] > f->of[1], b = f->count == 2 ? 1 - a : 0;
	if (f->count == 0)
		sum_add(sum, TERM_TIME, 0, 0, factor);
	else
		sum_add(sum, f->count == 1 ? TERM_SEQUENCE : TERM_PRODUCT, f->of[a],
			f->count == 1 ? 0 : f->of[b], factor);
}

/* c r sin(u)^2 + c r cos(u)^2 to c r, of up to two factors r */
static void square_key(struct sequencing *w, struct sum *sum, int index)
{
	struct factors f = factors_of(w, &sum->key[index]), squares = f;
	int sine = NONE;
	for (int i = 0; i < f.count && f.count <= FACTORS; i++)
		sine = is_function(at(w, f.of[i]), FN_SIN) && factor_place(&f, i + 1, f.of[i]) != NONE ? f.of[i] : sine;
	for (int i = 0; i < 2 && sine != NONE; i++) {
		drop(&f, factor_place(&f, 0, sine));
		squares.of[factor_place(&squares, 0, sine)] = sine + 1;
	}
	struct key *other = sine == NONE ? NULL : key_with(w, sum, &squares);
	if (!other || mpq_equal(other->factor, sum->key[index].factor) == 0)
		return;
	RATIONAL factor = ZERO;
	mpq_set(factor, other->factor);
	mpq_set_ui(other->factor, 0, 1);
	mpq_set_ui(sum->key[index].factor, 0, 1);
	add_factors(sum, &f, factor);
}

/* ---- sums of slopes, shifted: of a chain the rows differ by sums that differ by one ---- */

static void drop_zeros(struct sum *sum)
{
	int count = 0;
	for (int i = 0; i < sum->keys; i++)
		if (mpq_sgn(sum->key[i].factor) != 0)
			sum->key[count++] = sum->key[i];
	sum->keys = count;
}

/* The factor of a sequence; NULL: it is not there */
static mpq_srcptr factor_in(const struct sum *sum, int sequence)
{
	for (int i = 0; i < sum->keys; i++)
		if (sum->key[i].a == sequence)
			return sum->key[i].factor;
	return NULL;
}

/* How many terms has what is to be added to another to have it? */
static int terms_between(const struct sum *sum, const struct sum *other)
{
	int terms = 0;
	for (int i = 0; i < sum->keys; i++) {
		mpq_srcptr factor = factor_in(other, sum->key[i].a);
		terms += factor ? !mpq_equal(sum->key[i].factor, factor) : mpq_sgn(sum->key[i].factor) != 0;
	}
	for (int i = 0; i < other->keys; i++)
		terms += mpq_sgn(other->key[i].factor) != 0 && !factor_in(sum, other->key[i].a);
	return terms;
}

static struct sum difference(const struct sum *sum, const struct sum *other)
{
	RATIONAL minus = ZERO;
	struct sum rest = { 0 };
	for (int i = 0; i < sum->keys; i++)
		sum_add(&rest, TERM_SEQUENCE, sum->key[i].a, 0, sum->key[i].factor);
	for (int i = 0; i < other->keys; i++) {
		mpq_neg(minus, other->key[i].factor);
		sum_add(&rest, TERM_SEQUENCE, other->key[i].a, 0, minus);
	}
	drop_zeros(&rest);
	return rest;
}

static int shared_sum(struct sequencing *w, const struct sum *sum)
{
	RATIONAL one = RATIO(1, 1);
	struct sum made = { 0 }, all = difference(sum, &made);
	int best = NONE, least = all.keys - 1;
	for (int i = 0; i < w->shared; i++) {
		const int terms = terms_between(sum, &w->share[i].sum);
		best = terms < least ? i : best;
		least = terms < least ? terms : least;
	}
	if (best != NONE && least == 0)
		return w->share[best].sequence;
	if (best != NONE) {
		const struct sum rest = difference(sum, &w->share[best].sum);
		sum_add(&made, TERM_SEQUENCE, shared_sum(w, &rest), 0, one);
		sum_add(&made, TERM_SEQUENCE, w->share[best].sequence, 0, one);
	}
	const int sequence = sum_sequence(w, best == NONE ? &all : &made);
	ENLARGE(w->share, (size_t)w->shared + 1);
	w->share[w->shared].sum = all;
	w->share[w->shared++].sequence = sequence;
	return sequence;
}

/* Its derivative in time */
static int shifted(struct sequencing *w, int sequence)
{
	RATIONAL scale = RATIO(1, 1);
	mpq_div(scale, scale, w->unit);
	for (int i = 0; i < w->x->count; i++)
		if (at(w, i)->shifts && at(w, i)->a == sequence)
			return i;
	return new_sequence(w, (struct sequence){ .kind = SEQUENCE_RATE, .state = NONE, .a = sequence, .b = NONE,
						  .shifts = true,
						  .exponent = equation_number(w->step->model, scale).value });
}

void shift_rates(struct sequencing *w, struct sum *sum)
{
	RATIONAL one = RATIO(1, 1);
	struct sum slopes = { 0 };
	for (int i = 0; i < sum->keys && w->solving; i++)
		if (mpq_sgn(sum->key[i].factor) != 0)
			shift_key(w, sum, i, &slopes);
	if (slopes.keys)
		sum_add(sum, TERM_SEQUENCE, shifted(w, shared_sum(w, &slopes)), 0, one);
	for (int i = 0; i < sum->keys && w->solving; i++)
		if (mpq_sgn(sum->key[i].factor) != 0)
			square_key(w, sum, i);
	drop_zeros(sum);
}
